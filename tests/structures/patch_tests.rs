//! Patch tests on distorted meshes, and plates without locking.

use super::sample::{ALUMINIUM, KINDS, Numbers};
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::generate::{Generated, plate, plate_of};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::shell::ShellKind;
use flexbody_mechanics::structures::statics::{StaticFailure, StaticProblem};
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};

/// A flat plate whose inner corner nodes are displaced at random. Middle nodes are in the middle of
/// straight edges.
fn distorted_plate(kind: ShellKind, n: usize, seed: u64, strength: f64) -> Generated<f64> {
    let mut generated = plate_of(kind, [1.2, 0.8], [n, n]);
    let mut numbers = Numbers::new(seed);
    let order = kind.order();
    let row = order * n + 1;
    for j in (order..order * n).step_by(order) {
        for i in (order..order * n).step_by(order) {
            let move_ = numbers.vector(strength / n as f64);
            generated.nodes[j * row + i] += Vec3::new(move_.x, move_.y, 0.0);
        }
    }
    let corners = generated.nodes.clone();
    let at = |i: usize, j: usize| corners[j * row + i];
    for j in 0..row {
        for i in 0..row {
            let (low_i, low_j) = (i - i % order, j - j % order);
            let (high_i, high_j) = (i + i % order, j + j % order);
            let sum = at(low_i, low_j) + at(high_i, low_j) + at(low_i, high_j) + at(high_i, high_j);
            generated.nodes[j * row + i] = sum / 4.0;
        }
    }
    generated
}

/// A motion of constant strain, prescribed on the boundary, is the solution inside: the forces at
/// the inner nodes vanish. For both kinds of unknowns; the energy is that of the constant strain.
#[test]
fn constant_membrane_strain_bending_and_shear_pass_the_patch_test() {
    let thickness = 0.1;
    // u, v, w and rotations θ (u_z,x = θ-free parts so that γ is constant in the third).
    type Place = Vec3<f64>;
    let membrane = |x: &Place| {
        let u = Vec3::new(1e-3 * x.x + 5e-4 * x.y, 2e-4 * x.x - 7e-4 * x.y, 0.0);
        (u, Vec3::zeros())
    };
    // w = ½(a x² + b y²) + c x y; q = −∇w, θ = (w,y, −w,x, 0).
    let bending = |x: &Place| {
        let (a, b, c) = (0.02, -0.01, 0.015);
        let w = 0.5 * (a * x.x * x.x + b * x.y * x.y) + c * x.x * x.y;
        let (wx, wy) = (a * x.x + c * x.y, b * x.y + c * x.x);
        (Vec3::new(0.0, 0.0, w), Vec3::new(wy, -wx, 0.0))
    };
    let shear = |x: &Place| (Vec3::new(0.0, 0.0, 0.01 * x.x + 0.02 * x.y), Vec3::zeros());
    type State<'a> = &'a dyn Fn(&Place) -> (Place, Place);
    let states: [(&str, State); 3] = [
        ("membrane", &membrane),
        ("bending", &bending),
        ("shear", &shear),
    ];
    for (seed, kind) in [11, 12]
        .into_iter()
        .flat_map(|seed| KINDS.map(|kind| (seed, kind)))
    {
        let n = 4;
        let Generated { mesh, nodes } = distorted_plate(kind, n, seed, 0.25);
        let structure = Structure::uniform(mesh, nodes, thickness, ALUMINIUM).expect("sound");
        for (name, state) in states {
            let motion: Vec<(Place, Place)> = structure.nodes.iter().map(state).collect();
            let (forces, largest, energy) = nodal_forces(&structure, &motion);
            // Shear without bending needs moments: only its energy is checked.
            if name == "shear" {
                let shear = ALUMINIUM.shear_modulus() * thickness * 5.0 / 6.0;
                let expected = 0.5 * shear * (0.01_f64.powi(2) + 0.02_f64.powi(2)) * 1.2 * 0.8;
                let ratio = energy / expected;
                assert!(
                    (ratio - 1.0).abs() < 1e-12,
                    "{name}: energy {ratio} times the exact"
                );
                continue;
            }
            let row = kind.order() * n + 1;
            let inner =
                |k: usize| (1..row - 1).contains(&(k % row)) && (1..row - 1).contains(&(k / row));
            for (node, force) in forces.iter().enumerate().filter(|&(k, _)| inner(k)) {
                assert!(
                    force.amax() <= 1e-12 * largest,
                    "{name}: force {:e} beside {largest:e} at node {node}",
                    force.amax()
                );
            }
        }
    }
}

/// Forces (and moments, for bending about axes in the plane) of a motion at the nodes; the largest
/// force of displacements or rotations alone in one element (they cancel in bending without shear);
/// and the energy.
fn nodal_forces(
    structure: &Structure<f64>,
    motion: &[(Vec3<f64>, Vec3<f64>)],
) -> (Vec<nalgebra::Vector6<f64>>, f64, f64) {
    use flexbody_mechanics::structures::shell::{
        Field, Motion, NODES, Shell, ShellCotangent, Terms,
    };
    let mut total = vec![nalgebra::Vector6::zeros(); structure.nodes.len()];
    let (mut largest, mut energy): (f64, f64) = (0.0, 0.0);
    for element in &structure.topology.mesh.shells {
        let shell = Shell {
            kind: ShellKind::of(element),
            geometry: Field {
                points: element.gather(Vec3::zeros(), |k| structure.nodes[k]),
                directors: [Vec3::z(); NODES],
            },
            thickness: structure.thickness[0],
            material: structure.materials[0],
            surface_mass: 0.0,
            drilling: false,
        };
        let v = Motion {
            displacement: element.gather(Vec3::zeros(), |k| motion[k].0),
            rotation: element.gather(Vec3::zeros(), |k| motion[k].1),
        };
        energy += shell.energy(&v, Terms::LINEAR).total();
        let force_of = |v: &Motion<f64>| {
            let mut force = Motion::zeros();
            shell.add_energy_transpose(v, Terms::LINEAR, &mut force, &mut ShellCotangent::zeros());
            force
        };
        let (mut moved, mut turned) = (v, v);
        moved.rotation = [Vec3::zeros(); NODES];
        turned.displacement = [Vec3::zeros(); NODES];
        for part in [force_of(&moved), force_of(&turned)] {
            for a in 0..NODES {
                largest = largest
                    .max(part.displacement[a].amax())
                    .max(part.rotation[a].amax());
            }
        }
        let force = force_of(&v);
        for (a, &node) in element.iter().enumerate() {
            let (f, m) = (force.displacement[a], force.rotation[a]);
            total[node] += nalgebra::Vector6::new(f.x, f.y, f.z, m.x, m.y, m.z);
        }
    }
    (total, largest, energy)
}

/// A cantilever strip under a tip load keeps its deflection, relative to the thin limit, from t/L =
/// 1e-2 to 1e-4, with four nodes to 1e-6: to 0.1 % on a regular mesh, to 2 % on one of 6 × 6 whose corners are displaced by
/// up to an eighth of the width of an element.
#[test]
fn thin_plates_do_not_lock() {
    let all = [(None, 1e-3), (Some(21), 0.02)].into_iter();
    for (kind, (seed, tolerance)) in all.flat_map(|own| KINDS.map(|kind| (kind, own))) {
        let thinnest = match kind {
            ShellKind::Mitc9 => 1e-4,
            ShellKind::Mitc4 => 1e-6,
        };
        let ratios = [1e-2, 1e-3, thinnest].map(|slenderness| {
            let n = 6;
            let generated = seed.map_or_else(
                || plate_of(kind, [1.2, 0.8], [n, n]),
                |s| distorted_plate(kind, n, s, 0.1),
            );
            let Generated { mesh, nodes } = generated;
            let node = mesh.node_set("x1y0").expect("a corner")[0];
            let structure =
                Structure::uniform(mesh, nodes, 1.2 * slenderness, ALUMINIUM).expect("sound");
            let supports = [Support::clamp("x0")];
            let mut problem =
                StaticProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
            problem.factorise(&structure).expect("supported");
            let load = Load::Edge {
                edges: "x1".into(),
                force: Vec3::new(0.0, 0.0, slenderness.powi(3)),
            };
            let x = problem.solve_linear(&structure, &[load]).expect("sets");
            problem.motion(&structure, &x).displacement[node].z
        });
        println!("{kind:?}: {ratios:?}");
        for ratio in ratios {
            assert!((ratio / ratios[2] - 1.0).abs() < tolerance, "{ratios:?}");
        }
    }
}

#[test]
fn a_plate_that_is_not_held_is_a_mechanism_with_a_place() {
    let Generated { mesh, nodes } = plate([1.0, 1.0], [3, 3]);
    let structure = Structure::uniform(mesh, nodes, 0.01, ALUMINIUM).expect("sound");
    let held = Support::of("all", [true, true, false], [false; 3]);
    let mut problem = StaticProblem::new(&structure, &[held], NodeUnknowns::Natural).expect("sets");
    let failure = problem.factorise(&structure);
    let Err(StaticFailure::Mechanism { dof, .. }) = failure else {
        panic!("{failure:?}");
    };
    assert_eq!(dof, "displacement z");
    let failure = StaticProblem::new(&structure, &[Support::clamp("left")], NodeUnknowns::Six);
    let message = failure.err().map(|failure| failure.to_string());
    assert_eq!(
        message.as_deref(),
        Some(
            "no set of nodes of the name \"left\"; there are: all, x0, x0y0, x0y1, x1, x1y0, x1y1, \
             y0, y1"
        )
    );
}
