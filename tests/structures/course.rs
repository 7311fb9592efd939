//! The linear obstacle course of shells (MacNeal & Harder 1985; Belytschko et al. 1985; Morley 1963), six
//! unknowns a node. Each function gives the displacement on a mesh of size n as a part of the published one.

use flexbody_mechanics::structures::generate::{Generated, curved_panel_of, panel_of, plate_of};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::shell::ShellKind;
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use nalgebra::Vector3 as Vec3;

const NONE: [bool; 3] = [false; 3];

fn material(young: f64, poisson: f64) -> Material<f64> {
    Material {
        young,
        poisson,
        density: 1.0,
        yield_stress: 1.0,
    }
}

/// Mirror plane across an axis: no displacement along it, no rotation about the other axes.
fn mirror(nodes: &str, axis: usize) -> Support {
    let across = [0, 1, 2].map(|k| k == axis);
    Support::of(nodes, across, across.map(|x| !x))
}

/// Displacement of the one node of a set.
fn displacement(
    generated: Generated<f64>,
    thickness: f64,
    material: Material<f64>,
    supports: &[Support],
    load: Load<f64>,
    set: &str,
) -> Vec3<f64> {
    let node = generated.mesh.node_set(set).expect("a set")[0];
    let Generated { mesh, nodes } = generated;
    let structure = Structure::uniform(mesh, nodes, thickness, material).expect("a sound mesh");
    let mut problem =
        StaticProblem::new(&structure, supports, NodeUnknowns::Six).expect("known sets");
    problem.factorise(&structure).expect("supported");
    let x = problem
        .solve_linear(&structure, &[load])
        .expect("known sets");
    problem.motion(&structure, &x).displacement[node]
}

/// Scordelis–Lo roof: a quarter, n × n elements, from the crown (angle 90°) down to the free edge.
pub(crate) fn scordelis_lo(kind: ShellKind, n: usize) -> f64 {
    let angle = |degrees: f64| degrees.to_radians();
    let roof = curved_panel_of(kind, (25.0, 25.0, [angle(90.0), angle(50.0)]), [n, n]);
    let weight = Load::Area {
        faces: "all".into(),
        force: Vec3::new(0.0, -90.0, 0.0),
    };
    let supports = [
        mirror("x0", 0),
        mirror("y0", 2),
        Support::of("y1", [true, true, false], NONE),
    ];
    let down = displacement(roof, 0.25, material(4.32e8, 0.0), &supports, weight, "x1y0");
    -down.y / 0.3024
}

/// Pinched cylinder with diaphragms: an eighth, n × n elements.
pub(crate) fn pinched_cylinder(kind: ShellKind, n: usize) -> f64 {
    let quarter = std::f64::consts::FRAC_PI_2;
    let part = curved_panel_of(kind, (300.0, 300.0, [0.0, quarter]), [n, n]);
    let load = Load::Point {
        nodes: "x0y0".into(),
        force: Vec3::new(-0.25, 0.0, 0.0),
        moment: Vec3::zeros(),
    };
    let supports = [
        mirror("x0", 1),
        mirror("x1", 0),
        mirror("y0", 2),
        Support::of("y1", [true, true, false], NONE),
    ];
    let moved = displacement(part, 3.0, material(3e6, 0.3), &supports, load, "x0y0");
    -moved.x / 1.8248e-5
}

/// Pinched hemisphere with a hole of 18°: a quarter, n × n elements.
pub(crate) fn hemisphere(kind: ShellKind, n: usize) -> f64 {
    let quarter = std::f64::consts::FRAC_PI_2;
    // From the equator up to 72°.
    let mut part = panel_of(kind, [n, n], false, |x, y| {
        let ((sp, cp), (st, ct)) = ((x * quarter).sin_cos(), (y * 0.8 * quarter).sin_cos());
        Vec3::new(ct * cp, ct * sp, st) * 10.0
    });
    // One point keeps its height. The loads act at both ends of the equator.
    let corner = part.mesh.node_sets["x0y0"].clone();
    let other = part.mesh.node_sets["x1y0"].clone();
    part.mesh.node_sets.insert("pull".into(), corner.clone());
    part.mesh.node_sets.insert("height".into(), corner);
    let node = other[0];
    let Generated { mesh, nodes } = part;
    let structure =
        Structure::uniform(mesh, nodes, 0.04, material(6.825e7, 0.3)).expect("a sound mesh");
    let supports = [
        mirror("x0", 1),
        mirror("x1", 0),
        Support::of("height", [false, false, true], NONE),
    ];
    let point = |nodes: &str, force| Load::Point {
        nodes: nodes.into(),
        force,
        moment: Vec3::zeros(),
    };
    let loads = [
        point("pull", Vec3::new(1.0, 0.0, 0.0)),
        point("x1y0", Vec3::new(0.0, -1.0, 0.0)),
    ];
    let mut problem =
        StaticProblem::new(&structure, &supports, NodeUnknowns::Six).expect("known sets");
    problem.factorise(&structure).expect("supported");
    let x = problem
        .solve_linear(&structure, &loads)
        .expect("known sets");
    -problem.motion(&structure, &x).displacement[node].y / 0.0940
}

/// Morley's rhombic plate with angles of 30°, simply supported, under pressure, n × n elements: deflection of
/// the centre by 0.408e-3 q L⁴/D (Morley 1963, without shear), at t/L = `slenderness`.
pub(crate) fn skew_plate(kind: ShellKind, n: usize, slenderness: f64) -> f64 {
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let mut plate = panel_of(kind, [n, n], false, |x, y| {
        Vec3::new(x + y * cos, y * sin, 0.0)
    });
    let centre = plate.mesh.nodes / 2;
    plate.mesh.node_sets.insert("centre".into(), vec![centre]);
    let (young, poisson) = (1e7, 0.3);
    let stiffness = young * slenderness.powi(3) / (12.0 * (1.0 - poisson * poisson));
    let load = Load::Pressure {
        faces: "all".into(),
        pressure: stiffness,
    };
    // Nothing moves or turns in the plane; edges do not sink, and turn freely.
    let mut supports = vec![Support::of(
        "all",
        [true, true, false],
        [false, false, true],
    )];
    let edges = ["x0", "x1", "y0", "y1"];
    supports.extend(edges.map(|edge| Support::of(edge, [false, false, true], NONE)));
    let material = material(young, poisson);
    displacement(plate, slenderness, material, &supports, load, "centre").z / 0.408e-3
}

/// Beam twisted by 90°, 6n × n elements, clamped at one end: displacements of the other end by a force along the
/// width there and by one along the thickness there, by 0.005424 and 0.001754 (MacNeal & Harder 1985).
pub(crate) fn twisted_beam(kind: ShellKind, n: usize) -> [f64; 2] {
    let (length, width, thickness) = (12.0, 1.1, 0.32);
    let one = |direction: Vec3<f64>, expected: f64| {
        let mut beam = panel_of(kind, [6 * n, n], false, |x, y| {
            let (sin, cos) = (x * std::f64::consts::FRAC_PI_2).sin_cos();
            let across = width * (y - 0.5);
            Vec3::new(length * x, across * cos, across * sin)
        });
        let edge = &beam.mesh.node_sets["x1"];
        let middle = edge[edge.len() / 2];
        beam.mesh.node_sets.insert("middle".into(), vec![middle]);
        let load = Load::Edge {
            edges: "x1".into(),
            force: direction / width,
        };
        let material = material(29e6, 0.22);
        let supports = [Support::clamp("x0")];
        let moved = displacement(beam, thickness, material, &supports, load, "middle");
        moved.dot(&direction) / expected
    };
    [one(Vec3::z(), 0.005_424), one(Vec3::y(), 0.001_754)]
}

/// A number in (−1, 1) that looks random.
fn next(state: &mut u64) -> f64 {
    *state = (state.wrapping_mul(6364136223846793005)).wrapping_add(1442695040888963407);
    (*state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
}

/// A strip of 1.2 × 0.8 with n × n elements; with a `seed` the inner corners are displaced at random by up to an
/// eighth of an element.
fn strip(kind: ShellKind, n: usize, seed: Option<u64>) -> Generated<f64> {
    let mut strip = plate_of(kind, [1.2, 0.8], [n, n]);
    let Some(mut state) = seed else {
        return strip;
    };
    let order = kind.order();
    let row = order * n + 1;
    for j in (order..order * n).step_by(order) {
        for i in (order..order * n).step_by(order) {
            let moved = Vec3::new(next(&mut state), next(&mut state), 0.0);
            strip.nodes[j * row + i] += moved * (0.1 / n as f64);
        }
    }
    // Other nodes are in the middle of straight edges, or of the element.
    let corners = strip.nodes.clone();
    let at = |i: usize, j: usize| corners[j * row + i];
    for j in 0..row {
        for i in 0..row {
            let [[i0, i1], [j0, j1]] = [i, j].map(|k| [k - k % order, k + k % order]);
            strip.nodes[j * row + i] = (at(i0, j0) + at(i1, j0) + at(i0, j1) + at(i1, j1)) / 4.0;
        }
    }
    strip
}

/// What distorted elements take from the deflection of a clamped strip under a force on its edge: the mean over five
/// meshes of 1 − w / w of the regular mesh, at t/L = `slenderness`.
pub(crate) fn loss_by_distortion(kind: ShellKind, n: usize, slenderness: f64) -> f64 {
    let deflection = |seed: Option<u64>| {
        let load = Load::Edge {
            edges: "x1".into(),
            force: Vec3::new(0.0, 0.0, slenderness.powi(3)),
        };
        let (thickness, held) = (1.2 * slenderness, [Support::clamp("x0")]);
        let steel = material(7e10, 0.3);
        displacement(strip(kind, n, seed), thickness, steel, &held, load, "x1y0").z
    };
    let regular = deflection(None);
    let losses = (1..=5).map(|seed| 1.0 - deflection(Some(seed)) / regular);
    losses.sum::<f64>() / 5.0
}
