//! Supports of rotations: a structure that is turned with its supports is the same, what is held in addition makes
//! it no softer, and five and six unknowns a node agree.

use super::sample::{ALUMINIUM, KINDS, Numbers};
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::functions::{Function, Solved};
use flexbody_mechanics::structures::generate::{Generated, curved_panel_of, plate};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::modes::ModalProblem;
use flexbody_mechanics::structures::shell::Terms;
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};

const BOTH: [NodeUnknowns; 2] = [NodeUnknowns::Natural, NodeUnknowns::Six];
const ALL: [bool; 3] = [true; 3];

/// A rotation about an axis of length one.
fn turned(v: &Vec3<f64>, axis: &Vec3<f64>, angle: f64) -> Vec3<f64> {
    let (s, c) = angle.sin_cos();
    v * c + axis.cross(v) * s + axis * (axis.dot(v) * (1.0 - c))
}

/// A plate with its nodes moved by `place`.
fn moved(n: usize, place: impl Fn(&Vec3<f64>) -> Vec3<f64>) -> Structure<f64> {
    let mut generated = plate([1.0, 0.7], [n, n]);
    generated.nodes = generated.nodes.iter().map(place).collect();
    sound(generated)
}

fn sound(generated: Generated<f64>) -> Structure<f64> {
    Structure::uniform(generated.mesh, generated.nodes, 0.02, ALUMINIUM).expect("sound")
}

/// Work of a pressure of 1 kPa.
fn compliance(structure: &Structure<f64>, supports: &[Support], unknowns: NodeUnknowns) -> f64 {
    let pressure = Load::Pressure {
        faces: "all".into(),
        pressure: 1e3,
    };
    loaded(
        structure,
        supports,
        unknowns,
        pressure,
        Function::Compliance { case: 0 },
    )
}

fn loaded(
    structure: &Structure<f64>,
    supports: &[Support],
    unknowns: NodeUnknowns,
    load: Load<f64>,
    function: Function,
) -> f64 {
    let cases = [vec![load]];
    let mut problem = StaticProblem::new(structure, supports, unknowns).expect("sets");
    problem.factorise(structure).expect("no mechanism");
    let x = problem.solve_linear(structure, &cases[0]).expect("sets");
    let solved = Solved {
        problem: &problem,
        structure,
        cases: &cases,
        solutions: &[x],
        terms: Terms::LINEAR,
    };
    solved.value(&function).expect("sets")
}

fn near(a: f64, b: f64, tolerance: f64, what: &str) {
    assert!((a / b - 1.0).abs() < tolerance, "{what}: {a:e}, {b:e}");
}

fn rotations(set: u8) -> [bool; 3] {
    [0, 1, 2].map(|k| set & (1 << k) != 0)
}

/// In any place two held rotations and three clamp an edge, since their axes have two independent projections on
/// the tangent plane: the plate is that of a clamped edge in its own axes. Six unknowns have the drilling
/// stiffness more, which is 1e-3 G h.
#[test]
fn two_oblique_rotations_clamp_an_edge() {
    let flat = moved(4, |x| *x);
    let clamped = BOTH.map(|u| compliance(&flat, &[Support::clamp("x0")], u));
    near(clamped[0], clamped[1], 1e-4, "five and six");
    let mut numbers = Numbers::new(71);
    for _ in 0..4 {
        let (axis, angle) = (numbers.vector(1.0).normalize(), 3.0 * numbers.next());
        let plate = moved(4, |x| turned(x, &axis, angle));
        for set in [3, 5, 6, 7] {
            let supports = [Support::of("x0", ALL, rotations(set))];
            for (unknowns, clamped) in BOTH.into_iter().zip(clamped) {
                let found = compliance(&plate, &supports, unknowns);
                near(found, clamped, 1e-6, &format!("{set} {axis} {angle}"));
            }
        }
    }
}

/// A rotation of all by quarter turns exchanges the axes, and the supports with them: here (x, y, z) → (z, x, y)
/// and (x, y, z) → (y, −x, z), of a plate in an oblique place.
#[test]
fn supports_turn_with_the_structure() {
    let axis = Vec3::new(0.3, -0.7, 0.5).normalize();
    let place = |x: &Vec3<f64>| turned(x, &axis, 0.8);
    let cyclic = |x: &Vec3<f64>| Vec3::new(x.z, x.x, x.y);
    let quarter = |x: &Vec3<f64>| Vec3::new(x.y, -x.x, x.z);
    for (displacements, rotations) in [
        (ALL, [true, false, false]),
        (ALL, [false, true, true]),
        ([true, false, true], [false, false, true]),
        ([false, true, true], [true, false, true]),
    ] {
        for unknowns in BOTH {
            let of = |turn: &dyn Fn(&Vec3<f64>) -> Vec3<f64>, order: [usize; 3]| {
                let supports = [
                    Support::of(
                        "x0",
                        order.map(|k| displacements[k]),
                        order.map(|k| rotations[k]),
                    ),
                    Support::of("x1", ALL, [false; 3]),
                ];
                compliance(&moved(3, |x| turn(&place(x))), &supports, unknowns)
            };
            let given = of(&|x: &Vec3<f64>| *x, [0, 1, 2]);
            near(of(&cyclic, [2, 0, 1]), given, 1e-9, "cyclic");
            near(of(&quarter, [1, 0, 2]), given, 1e-9, "quarter");
        }
    }
}

/// A held rotation more lowers no frequency and raises no compliance, in random places: on a flat plate, and on a curved
/// one but for the error of its directors, by which a third axis counts as a tangent.
#[test]
fn holding_more_makes_nothing_softer() {
    let mut numbers = Numbers::new(72);
    for (bend, rounding) in [(0.0, 1e-9), (0.0, 1e-9), (1.0, 1e-4), (1.0, 1e-4)] {
        let (axis, angle) = (numbers.vector(1.0).normalize(), 3.0 * numbers.next());
        let plate = moved(3, |x| {
            let height = bend * (0.3 * x.x * x.x - 0.2 * x.x * x.y);
            let curved = Vec3::new(x.x, x.y, height);
            turned(&curved, &axis, angle)
        });
        for unknowns in BOTH {
            let of = |set: u8| {
                let supports = [
                    Support::of("x0", ALL, rotations(set)),
                    Support::of("x1", ALL, [false; 3]),
                ];
                let mut modes = ModalProblem::new(&plate, &supports, unknowns).expect("sets");
                let found = modes.solve(&plate, 1).expect("modes");
                (
                    compliance(&plate, &supports, unknowns),
                    found.eigenvalues[0],
                )
            };
            let all: Vec<(f64, f64)> = (0..8).map(of).collect();
            for (less, more) in (0_u8..8).flat_map(|a| (0_u8..8).map(move |b| (a, b))) {
                if less & more != less {
                    continue;
                }
                let ((c, f), (d, g)) = (all[usize::from(less)], all[usize::from(more)]);
                assert!(
                    d <= c * (1.0 + rounding),
                    "{less} {more}: compliance {c:e} {d:e}"
                );
                assert!(
                    g >= f * (1.0 - 10.0 * rounding),
                    "{less} {more}: eigenvalue {f} {g}"
                );
            }
        }
    }
}

/// A plate that is tilted about its held edge, along y. With the rotation about y held it is the same in all
/// tilts, with those about x and y clamped in all tilts up to a right angle, beside 0.1 rad from each as well.
#[test]
fn nothing_jumps_where_a_normal_leaves_an_axis() {
    let of = |tilt: f64, rotations: [bool; 3], unknowns: NodeUnknowns| {
        let plate = moved(3, |x| turned(x, &Vec3::new(0.0, 1.0, 0.0), tilt));
        compliance(&plate, &[Support::of("x0", ALL, rotations)], unknowns)
    };
    for unknowns in BOTH {
        let about_y = [false, true, false];
        let (clamped, about) = (of(0.0, ALL, unknowns), of(0.0, about_y, unknowns));
        for tilt in [0.05, 0.0999, 0.1001, 0.2, 1.0, 1.4707, 1.4709, 1.5] {
            near(
                of(tilt, [true, true, false], unknowns),
                clamped,
                1e-6,
                "x and y",
            );
            near(of(tilt, about_y, unknowns), about, 1e-6, "y");
        }
    }
}

/// With six unknowns a rotation that is held obliquely to the surface holds as well on every mesh: a cantilever
/// plate with its edge along t = (1, 0, 1)/√2 and the rotation about x held is clamped.
#[test]
fn an_oblique_rotation_holds_on_every_mesh() {
    let place = |x: &Vec3<f64>| {
        let c = 0.5_f64.sqrt();
        Vec3::new(c * x.y, x.x, c * x.y)
    };
    for n in [2, 4, 8] {
        let plate = moved(n, place);
        let clamped = compliance(&plate, &[Support::clamp("x0")], NodeUnknowns::Natural);
        for unknowns in BOTH {
            let held = [Support::of("x0", ALL, [true, false, false])];
            near(
                compliance(&plate, &held, unknowns),
                clamped,
                5e-3,
                &format!("{n}"),
            );
        }
    }
}

/// Half of a cylindrical panel with supports of symmetry is the whole one, on meshes so coarse that the directors
/// leave the plane of symmetry: clamps on the straight edges, a pressure inside, elements of 0.6 and 0.3 rad.
#[test]
fn a_plane_of_symmetry_holds_on_coarse_curved_meshes() {
    for (kind, coarse) in KINDS.into_iter().flat_map(|kind| [2, 4].map(|n| (kind, n))) {
        for unknowns in BOTH {
            let times = 2 / kind.order();
            let panel = |angles: [f64; 2], n: usize| {
                sound(curved_panel_of(
                    kind,
                    (1.0, 1.0, angles),
                    [n * times, 2 * times],
                ))
            };
            let n = coarse;
            let (whole, half) = (panel([-1.2, 1.2], 2 * n), panel([0.0, 1.2], n));
            // The normal of the plane of symmetry is along the arc at angle 0.
            let middle = &half.topology.mesh.node_sets["x0"];
            let along = half.nodes[half.topology.mesh.shells[0][1]] - half.nodes[middle[0]];
            let normal = along.map(f64::abs).imax();
            let symmetric = Support::of(
                "x0",
                [0, 1, 2].map(|k| k == normal),
                [0, 1, 2].map(|k| k != normal),
            );
            let of_half = compliance(&half, &[symmetric, Support::clamp("x1")], unknowns);
            let clamps = [Support::clamp("x0"), Support::clamp("x1")];
            let of_whole = compliance(&whole, &clamps, unknowns);
            println!("{kind:?} {n}: {}", 2.0 * of_half / of_whole);
            near(2.0 * of_half, of_whole, 2e-2, &format!("{n}"));
        }
    }
}

/// A moment along the normal of a node is in balance with the supports, and turns the surface: with five unknowns a
/// node as with six up to the drilling stiffness, in any place. The moment is M = 7 N m at a corner.
#[test]
fn moments_along_normals_are_carried() {
    let mut numbers = Numbers::new(73);
    for _ in 0..3 {
        let (axis, angle) = (numbers.vector(1.0).normalize(), 3.0 * numbers.next());
        let normal = turned(&Vec3::new(0.0, 0.0, 1.0), &axis, angle);
        let plate = moved(3, |x| {
            turned(&Vec3::new(x.x, x.y, 0.1 * x.x * x.y), &axis, angle)
        });
        let about = numbers.vector(2.0);
        for unknowns in BOTH {
            let moment = |k: usize| {
                let load = Load::Point {
                    nodes: "x1y0".into(),
                    force: Vec3::zeros(),
                    moment: normal * 7.0,
                };
                let reaction = Function::ReactionMoment {
                    case: 0,
                    nodes: "x0".into(),
                    axis: Vec3::ith(k, 1.0),
                    about,
                };
                loaded(&plate, &[Support::clamp("x0")], unknowns, load, reaction)
            };
            let found = Vec3::new(moment(0), moment(1), moment(2));
            assert!((found + normal * 7.0).norm() < 1e-7, "{found} {normal}");
        }
    }
}
