//! Bodies of shells in floating frames: panels of any form, soft enough that their derivatives are of one
//! size.

use super::flexible::add_loads;
use super::models::{Numbers, axes_along, joint};
use flexbody_mathematics::math::{Mat3, Team, Vec3};
use flexbody_mechanics::integrate::Trajectory;
use flexbody_mechanics::model::finite::FiniteElements;
use flexbody_mechanics::model::{
    Air, Axes, DistributedLoad, Form, Interpolation, JointKind, Load, LoadKind, Model, Smoothness,
    Spread, TimeFunction,
};
use flexbody_mechanics::structures::beam::{Beam, Section, SectionValues};
use flexbody_mechanics::structures::floating::{FrameNodes, PointMotion, Surface, element_mesh};
use flexbody_mechanics::structures::generate::{panel, panel_of as mesh_of};
use flexbody_mechanics::structures::lumped_mass::LumpedMass;
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::mesh::{Edge, Mesh};
use flexbody_mechanics::structures::parts::{coordinates, of_beam, of_mass};
use flexbody_mechanics::structures::shell::ShellKind;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::system::reduction::{ProjectedShells, project};
use std::sync::Arc;

/// Shells of a body, and how their nodes move.
pub struct Shells {
    pub structure: Structure<f64>,
    pub elements: FiniteElements<f64>,
    pub surface: Surface,
    pub mesh: Mesh,
}

/// A plate of aluminium of 1 m × 0.25 m with this thickness \[m\], clamped to its frame at x = 0.
pub fn aluminium_plate(elements: [usize; 2], thickness: f64) -> FiniteElements<f64> {
    let made = panel(elements, false, |x, y| Vec3::new(x, 0.25 * y, 0.0));
    let material = Material {
        young: 70e9,
        poisson: 0.3,
        density: 2700.0,
        yield_stress: 2e8,
    };
    let structure = Structure::uniform(made.mesh.clone(), made.nodes, thickness, material);
    let structure = structure.expect("a sound mesh");
    let frame = FrameNodes::Clamped(nodes_of(&made.mesh.edge_sets["x0"]));
    let (mesh, _) = element_mesh(&structure, &frame).expect("has its sets");
    let count = mesh.elements.len();
    FiniteElements {
        thickness: vec![thickness; count],
        young: vec![70e9; count],
        density: vec![2700.0; count],
        surface_mass: vec![0.0; count],
        parts: Vec::new(),
        damping: None,
        mesh: Arc::new(mesh),
        team: Team::default(),
    }
}

/// Elastic coordinates of flexible body 0 at the end of a run.
pub fn elastic_at_end(model: &Model<f64>, run: &Trajectory<f64>) -> Vec<f64> {
    let q = run.q(run.last());
    let places = model.flexible[0].places();
    places
        .map(|(b, k)| q[run.numbering.position(b) + k])
        .collect()
}

/// The nodes of edges.
pub fn nodes_of(edges: &[Edge]) -> Vec<usize> {
    edges.iter().flatten().copied().collect()
}

/// Beams along the nodes of edges, each along one edge of three nodes or two of two.
pub fn beams_along(edges: &[Edge]) -> Vec<[usize; 3]> {
    let mut nodes = nodes_of(edges);
    nodes.dedup();
    let starts = (0..nodes.len() - 1).step_by(2);
    starts
        .map(|k| [nodes[k], nodes[k + 1], nodes[k + 2]])
        .collect()
}

/// A curved and distorted panel whose elements differ in thickness and material.
pub fn shells(numbers: &mut Numbers, elements: [usize; 2], clamped: bool) -> Shells {
    shells_of(ShellKind::Mitc9, numbers, elements, clamped)
}

/// The same of shells of this kind.
pub fn shells_of(
    kind: ShellKind,
    numbers: &mut Numbers,
    elements: [usize; 2],
    clamped: bool,
) -> Shells {
    panel_of((kind, elements), numbers, clamped, false)
}

/// The same with beams along an edge, which have an offset, masses with inertia at three nodes, and damping.
pub fn stiffened(numbers: &mut Numbers, elements: [usize; 2], clamped: bool) -> Shells {
    panel_of((ShellKind::Mitc9, elements), numbers, clamped, true)
}

/// Any beam between three nodes, soft as the shells.
pub fn any_beam(
    numbers: &mut Numbers,
    points: [Vec3<f64>; 3],
    orientation: Vec3<f64>,
) -> Beam<f64> {
    let mut near = |size: f64| size * (1.0 + 0.3 * numbers.next());
    Beam {
        points,
        orientation,
        section: Section::Rectangle {
            width: near(0.15),
            height: near(0.1),
        },
        offset: [near(0.06), near(-0.04)],
        material: Material {
            young: near(90.0),
            poisson: 0.3,
            density: near(3.0),
            yield_stress: 20.0,
        },
        line_mass: near(0.05),
    }
}

fn any_mass(numbers: &mut Numbers) -> LumpedMass<f64> {
    let second = Mat3::from_fn(|_, _| 0.1 * numbers.next());
    let second = second * second.transpose();
    let inertia = Mat3::identity() * second.trace() - second;
    let at = |i: usize, j: usize| inertia[(i, j)];
    LumpedMass {
        mass: 0.2 + 0.1 * numbers.next(),
        inertia: [at(0, 0), at(1, 1), at(2, 2), at(0, 1), at(1, 2), at(2, 0)],
    }
}

fn panel_of(
    (kind, elements): (ShellKind, [usize; 2]),
    numbers: &mut Numbers,
    clamped: bool,
    more: bool,
) -> Shells {
    let bend = numbers.vector() * 0.2;
    let made = mesh_of(kind, elements, false, |x, y| {
        let z = 0.2 + bend.x * x * x + bend.y * x * y + bend.z * y * y;
        Vec3::new(1.2 * x + 0.1 * y * y + 0.3, 0.8 * y + 0.1 * x * y - 0.2, z)
    });
    let material = Material {
        young: 90.0,
        poisson: 0.3,
        density: 3.0,
        yield_stress: 20.0,
    };
    let mut mesh = made.mesh.clone();
    if more {
        mesh.beams = beams_along(&mesh.edge_sets["y0"]);
    }
    let orientations = vec![Vec3::new(0.2, 0.3, 1.0); mesh.beams.len()];
    let none = Section::Given(SectionValues::zeros());
    let structure =
        Structure::with_beams(mesh, made.nodes, 0.2, none, orientations.clone(), material);
    let structure = structure.expect("a sound mesh");
    let last = structure.nodes.len() - 1;
    let frame = match clamped {
        true => FrameNodes::Clamped(nodes_of(&made.mesh.edge_sets["x0"])),
        false => FrameNodes::Chord([0, last, kind.order() * elements[0]]),
    };
    let (mut mesh, surface) = element_mesh(&structure, &frame).expect("has its sets");
    let count = mesh.elements.len();
    let mut any = |size: f64| {
        (0..count)
            .map(|_| size * (1.0 + 0.3 * numbers.next()))
            .collect()
    };
    let (thickness, young) = (any(0.2), any(90.0));
    let (density, surface_mass) = (any(3.0), any(0.1));
    let mut parts = Vec::new();
    for (nodes, orientation) in mesh.beams.iter().zip(&orientations) {
        let own = nodes.map(|node| surface.unknowns(node));
        let points = own.each_ref().map(|node| node.place);
        parts.push((
            of_beam(&own, &any_beam(numbers, points, *orientation)),
            coordinates(&own),
        ));
    }
    for node in [0, last / 2, last] {
        if more {
            let own = surface.unknowns(node);
            parts.push((of_mass(&own, &any_mass(numbers)), coordinates(&[own])));
        }
    }
    let (parts, own) = parts.into_iter().unzip();
    mesh.parts = own;
    let elements = FiniteElements {
        thickness,
        young,
        density,
        surface_mass,
        parts,
        damping: more.then_some([0.3, 0.02]),
        mesh: Arc::new(mesh),
        team: Team::default(),
    };
    Shells {
        structure,
        elements,
        surface,
        mesh: made.mesh,
    }
}

/// The interface of a point of body `flexible`.
pub fn attach(model: &mut Model<f64>, flexible: usize, name: &str, motion: PointMotion) -> usize {
    let shapes = (motion.displacement, motion.rotation);
    let indices = Some(&motion.coordinates[..]);
    model.attach(flexible, name, motion.place, shapes, indices)
}

/// A panel on a revolute joint along its first edge; a rigid body on a revolute joint at a corner; a spring
/// and a force at its points. Joints are closed at the start.
pub fn shell_swing(seed: u64, elements: [usize; 2]) -> Model<f64> {
    swing(seed, (ShellKind::Mitc9, elements), None, false)
}

/// The same of a panel with beams, masses and damping.
pub fn stiffened_swing(seed: u64, elements: [usize; 2], vectors: Option<usize>) -> Model<f64> {
    swing(seed, (ShellKind::Mitc9, elements), vectors, true)
}

/// The same of shells of four nodes.
pub fn four_node_swing(seed: u64, elements: [usize; 2], vectors: Option<usize>) -> Model<f64> {
    swing(seed, (ShellKind::Mitc4, elements), vectors, true)
}

/// The same with this many coordinates: factors of any vectors.
pub fn reduced_swing(seed: u64, elements: [usize; 2], vectors: usize) -> Model<f64> {
    swing(seed, (ShellKind::Mitc9, elements), Some(vectors), false)
}

/// Shells in a basis of any vectors.
pub fn projected(numbers: &mut Numbers, shells: &Shells, vectors: usize) -> ProjectedShells {
    let mesh = &shells.elements.mesh;
    let each: Vec<usize> = (0..mesh.elements.len()).collect();
    let basis = (0..vectors)
        .map(|_| numbers.list(mesh.coordinates))
        .collect();
    let bending = (0..vectors).filter(|i| i % 3 < 2).collect();
    project(mesh, &each, basis, bending)
}

/// Adds loads to the shells of flexible body 0: a pressure that varies, and dead loads in both kinds of axes.
pub fn press(model: &mut Model<f64>) {
    let body = model.flexible[0].frame;
    let shells = model.flexible[0].form.shells().expect("shells");
    let mesh = &shells.mesh;
    let shares = |every: usize| -> Vec<(usize, f64)> {
        let nodes = (0..mesh.nodes.len()).step_by(every);
        nodes.map(|node| (node, 0.1 + 0.01 * node as f64)).collect()
    };
    let dead = |every: usize, axes: Axes, direction: Vec3<f64>| Spread::Dead {
        shares: shares(every).into(),
        direction,
        axes,
    };
    let table = TimeFunction::Table {
        interpolation: Interpolation::Monotone,
        smoothness: Smoothness::Magnitude,
        times: vec![0.0, 0.2, 0.5],
        values: vec![1.0, 2.0, 4.0],
    };
    let harmonic = TimeFunction::Harmonic {
        mean: 2.0,
        amplitude: 3.0,
        frequency: 0.8,
        phase: 0.3,
    };
    let pressure = Spread::Pressure {
        shells: (0..mesh.elements.len()).collect(),
    };
    let air = Spread::Air {
        shells: (0..mesh.elements.len()).step_by(2).collect(),
        air: Air {
            coefficient: 0.4,
            normal_coefficient: 1.3,
            width: 0.6,
        },
    };
    let all = [
        (air, TimeFunction::constant(1.0)),
        (pressure, harmonic),
        (dead(2, Axes::Ground, Vec3::new(0.3, -0.7, 0.5)), table),
        (
            dead(3, Axes::Body, Vec3::new(-0.2, 0.4, 0.9)),
            TimeFunction::constant(1.5),
        ),
    ];
    for (spread, magnitude) in all {
        let load = DistributedLoad {
            body,
            spread,
            magnitude,
        };
        model.loads.push(Load {
            name: "spread".into(),
            kind: LoadKind::Distributed(load),
        });
    }
}

fn swing(
    seed: u64,
    mesh: (ShellKind, [usize; 2]),
    vectors: Option<usize>,
    more: bool,
) -> Model<f64> {
    let mut numbers = Numbers(seed);
    let shells = panel_of(mesh, &mut numbers, false, more);
    let projected = vectors.map(|count| projected(&mut numbers, &shells, count));
    let mut frame = numbers.body("panel");
    (frame.mass, frame.inertia) = shells.elements.rigid();
    let load = numbers.body("load");
    let mut model = Model {
        gravity: Vec3::new(1.0, -9.0, 2.0),
        bodies: vec![frame, load],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let count = vectors.unwrap_or(shells.elements.mesh.coordinates);
    let small = |x: Vec<f64>, by: f64| -> Vec<f64> { x.iter().map(|x| x * by).collect() };
    let start = (
        small(numbers.list(count), 0.02),
        small(numbers.list(count), 0.1),
    );
    let form = match &projected {
        None => Form::Finite(shells.elements),
        Some(projected) => Form::Modal(projected.modal(shells.elements)),
    };
    model.add_flexible(0, (&start.0, &start.1), form);
    let motion = |point: PointMotion| match &projected {
        None => point,
        Some(projected) => projected.point(&point),
    };
    let corner = *nodes_of(&shells.mesh.edge_sets["x1"])
        .last()
        .expect("an edge");
    let root = attach(
        &mut model,
        0,
        "root",
        motion(shells.surface.edge(&shells.mesh.edge_sets["y0"])),
    );
    let tip = attach(&mut model, 0, "tip", motion(shells.surface.node(corner)));
    let side = attach(
        &mut model,
        0,
        "side",
        motion(shells.surface.edge(&shells.mesh.edge_sets["x1"])),
    );
    for (name, between) in [("root", (root, None)), ("hinge", (1, Some(tip)))] {
        let at = between.1.unwrap_or(root);
        let place = model.bodies[at].position;
        let axis = axes_along(&numbers.vector())[2];
        let kind = (name, JointKind::Revolute);
        let made = joint(&model.bodies, kind, between, &place, &axis);
        model.joints.push(made);
    }
    add_loads(&mut model, side, tip);
    model
}
