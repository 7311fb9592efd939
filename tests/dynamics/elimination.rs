//! The elimination by the tree of joints, loops last, agrees with sparse LU of the same matrix.

use flexbody_mathematics::linalg::SolveScalar;
use flexbody_mathematics::math::Complex64;
use flexbody_mechanics::model::Model;
use flexbody_mechanics::system::accelerations::Accelerations;
use flexbody_mechanics::system::initial::mass;
use flexbody_mechanics::system::kkt::{Metric, SaddlePoint};
use flexbody_mechanics::system::{BodyMotion, InMotion, Numbering};
use flexbody_problem::Problem;
use std::path::Path;

/// Problems, and the number of joints of each that close loops.
const SCENES: [(&str, usize); 9] = [
    ("trebuchet", 0),
    ("triple_pendulum", 0),
    ("benchmarks/andrews_squeezer", 3),
    ("benchmarks/balanced_slider_crank", 1),
    ("benchmarks/bricard", 1),
    ("benchmarks/four_bars_1", 1),
    ("benchmarks/four_bars_2", 2),
    ("benchmarks/four_bars_10", 10),
    ("benchmarks/four_bars_40", 40),
];

fn load(name: &str) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
    Problem::load(&path, &[]).unwrap_or_else(|faults| panic!("{faults}"))
}

/// Numbers between −1 and 1 without a pattern.
fn spread(count: usize) -> Vec<f64> {
    let golden = 0.618_033_988_749_895;
    (1..=count)
        .map(|k| 2.0 * (golden * k as f64).fract() - 1.0)
        .collect()
}

/// Largest differences of the solutions by tree and by sparse LU, relative to the largest entry: of
/// their values and of their derivatives, if any.
fn differences<S: SolveScalar>(name: &str, model: &Model<S>, closing: usize) -> [f64; 2] {
    let numbering = Numbering::new(model);
    let (mut q, mut motions) = (Vec::new(), Vec::new());
    for body in &model.bodies {
        q.extend(body.position.iter().copied());
        q.extend(body.orientation.iter().copied());
    }
    let v = vec![S::zero(); numbering.velocities()];
    let mut field = Accelerations::new(model, &numbering);
    field.set_state(&q, &v, S::zero());
    field.factorise().expect("regular");
    let how = field.elimination();
    let moving = model
        .bodies
        .iter()
        .filter(|body| body.mobility.unknowns() > 0);
    assert_eq!(
        how.bodies.map(|bodies| bodies.len()),
        Some(moving.count()),
        "{name}"
    );
    assert_eq!(how.closing.len(), closing, "{name}");
    let mut saddle = SaddlePoint::new(model, &numbering);
    BodyMotion::all(&numbering, &q, &v, &mut motions);
    let zeros = vec![S::zero(); numbering.constraints()];
    let at = InMotion::new(model, &numbering, &motions, S::zero());
    saddle
        .factorise(&at, &zeros, mass(model), Metric::Mass)
        .expect("regular");
    let mut right: Vec<S> = spread(v.len() + zeros.len())
        .into_iter()
        .map(S::from)
        .collect();
    // Neither system contains what the mobilities do not admit.
    flexbody_mechanics::system::reduce::project(&numbering, &mut right);
    let (mut by_tree, mut by_lu) = (right.clone(), right);
    field.solve(&mut by_tree);
    saddle.solve(&mut by_lu);
    let apart: Vec<S> = by_tree.iter().zip(&by_lu).map(|(&a, &b)| a - b).collect();
    let parts: [fn(S) -> f64; 2] = [S::re, S::infinitesimal];
    parts.map(|part| {
        let size = |x: &[S]| x.iter().fold(0.0_f64, |m, &x| m.max(part(x).abs()));
        size(&apart) / size(&by_lu).max(1e-200)
    })
}

#[test]
fn the_tree_solves_what_sparse_lu_solves() {
    for (name, closing) in SCENES {
        let problem = load(name);
        let start = problem.start();
        let real = differences(name, &problem.scene::<f64>(&start).model, closing);
        // The derivative along a step in all variables.
        let seeded: Vec<Complex64> = start.iter().map(|&x| Complex64::new(x, 1e-30)).collect();
        let complex = differences(name, &problem.scene(&seeded).model, closing);
        println!("{name}: {real:?} {complex:?}");
        for error in real.into_iter().chain(complex) {
            assert!(error <= 1e-11, "{name}: {real:?}, {complex:?}");
        }
    }
}
