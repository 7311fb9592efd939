//! Estimated errors by large rotations against exact deflections of bars that bend and do not stretch.

use super::sample::ALUMINIUM;
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::Terms;
use flexbody_mechanics::structures::beam::Section;
use flexbody_mechanics::structures::generate::{Generated, GeneratedBeams, plate, straight_beam};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::statics::StaticProblem;
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use flexbody_mechanics::structures::turned::turned;
use flexbody_mechanics::structures::von_karman::LoadSteps;

const LENGTH: f64 = 1.0;
const WIDTH: f64 = 0.2;
const THICKNESS: f64 = 0.004;

/// A strip of shells; a beam that bends about axis 2 or axis 3.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Shells,
    Beams(usize),
}

/// The bar with its stiffness EI, clamped at "root", and the direction in which it bends.
fn bar(kind: Kind) -> (Structure<f64>, f64, Vec3<f64>) {
    let stiffness = ALUMINIUM.young * WIDTH * THICKNESS.powi(3) / 12.0;
    let rename =
        |sets: &mut std::collections::BTreeMap<String, Vec<usize>>, from: &str, to: &str| {
            let own = sets[from].clone();
            sets.insert(to.into(), own);
        };
    match kind {
        Kind::Shells => {
            let Generated { mut mesh, nodes } = plate([LENGTH, WIDTH], [12, 2]);
            rename(&mut mesh.node_sets, "x0", "root");
            rename(&mut mesh.node_sets, "x1", "tip");
            let mut material = ALUMINIUM;
            material.poisson = 0.0;
            let own = Structure::uniform(mesh, nodes, THICKNESS, material).expect("sound");
            (own, stiffness, Vec3::z())
        }
        Kind::Beams(axis) => {
            let GeneratedBeams {
                mut mesh,
                nodes,
                orientations,
            } = straight_beam([Vec3::zeros(), Vec3::x() * LENGTH], Vec3::y(), 12);
            rename(&mut mesh.node_sets, "start", "root");
            rename(&mut mesh.node_sets, "end", "tip");
            let (width, height, along) = match axis {
                2 => (WIDTH, THICKNESS, Vec3::z()),
                _ => (THICKNESS, WIDTH, Vec3::y()),
            };
            let section = Section::Rectangle { width, height };
            let own = Structure::with_beams(mesh, nodes, 0.0, section, orientations, ALUMINIUM);
            (own.expect("sound"), stiffness, along)
        }
    }
}

/// The estimate for a load on the tip: a force, or a moment about an axis across the bar.
fn estimate(kind: Kind, von_karman: bool, load: impl Fn(f64, Vec3<f64>, f64) -> Load<f64>) -> f64 {
    let (structure, stiffness, along) = bar(kind);
    let supports = [Support::clamp("root")];
    let mut problem =
        StaticProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
    let nodes = structure.topology.mesh.node_sets["tip"].len() as f64;
    let case = [load(stiffness, along, nodes)];
    let (x, terms) = if von_karman {
        let found = problem.solve_von_karman(&structure, &case, &LoadSteps::default());
        (found.expect("an equilibrium").x, Terms::VON_KARMAN)
    } else {
        problem.factorise(&structure).expect("supported");
        (
            problem.solve_linear(&structure, &case).expect("sets"),
            Terms::LINEAR,
        )
    };
    let force = problem.load_vector(&structure, &case).expect("sets");
    let found = turned(&problem, &structure, (&x, &force), terms);
    found.error(&found)
}

const KINDS: [Kind; 3] = [Kind::Shells, Kind::Beams(2), Kind::Beams(3)];

/// A force P across the end: deflections of the elastica by L at P L²/EI (Mattiasson 1981), beside (1/3) P L²/EI.
#[test]
fn cantilevers_under_a_force_err_as_estimated() {
    let elastica = [
        (0.2, 0.06636),
        (0.4, 0.13098),
        (0.6, 0.19235),
        (1.0, 0.30172),
        (2.0, 0.49346),
    ];
    for (alpha, exact) in elastica {
        let error = alpha / 3.0 / exact - 1.0;
        for kind in KINDS {
            for von_karman in [false, true] {
                let found = estimate(kind, von_karman, |stiffness, along, nodes| {
                    let force = along * (alpha * stiffness / LENGTH.powi(2));
                    match kind {
                        Kind::Shells => Load::Edge {
                            edges: "x1".into(),
                            force: force / WIDTH,
                        },
                        Kind::Beams(_) => Load::Point {
                            nodes: "tip".into(),
                            force: force / nodes,
                            moment: Vec3::zeros(),
                        },
                    }
                });
                println!("{alpha} {kind:?} {von_karman}: {found} {error}");
                let ratio = found / error;
                let most = if alpha > 1.0 { 1.4 } else { 1.15 };
                assert!(
                    (0.9..most).contains(&ratio),
                    "{alpha} {kind:?}: {found} {error}"
                );
            }
        }
    }
}

/// A moment M at the end: (1 − cos α) / α beside α / 2 with α = M L / EI. The energy is exact.
#[test]
fn bars_bent_by_a_moment_err_as_estimated() {
    for alpha in [0.3, 0.6_f64, 1.0] {
        let error = 0.5 * alpha / ((1.0 - alpha.cos()) / alpha) - 1.0;
        for axis in [2, 3] {
            let found = estimate(Kind::Beams(axis), true, |stiffness, along, _| Load::Point {
                nodes: "tip".into(),
                force: Vec3::zeros(),
                moment: Vec3::x().cross(&along) * (alpha * stiffness / LENGTH),
            });
            println!("{alpha}: {found} {error}");
            assert!((0.8..1.3).contains(&(found / error)), "{found} {error}");
        }
    }
}

/// A bar that is twisted alone has no error, however far.
#[test]
fn twist_alone_has_no_error() {
    let found = estimate(Kind::Beams(2), true, |stiffness, _, _| Load::Point {
        nodes: "tip".into(),
        force: Vec3::zeros(),
        moment: Vec3::x() * stiffness,
    });
    assert!(found < 1e-12, "{found}");
}
