//! Functions of histories: their cotangents, pulled back through the motion, are exact derivatives.

use super::gradients_match_complex_step::{explicit, functions, implicit};
use crate::reference;
use flexbody_mathematics::math::scalar::COMPLEX_STEP;
use flexbody_mathematics::math::{Complex64, Parameters};
use flexbody_mechanics::adjoint::{Target, WeightedHistories, gradients, gradients_of};
use flexbody_mechanics::functions::histories::{Readings, history};
use flexbody_mechanics::functions::{Function, Reduction, Scene};
use flexbody_mechanics::integrate::{Method, Samples, Settings, Trajectory, simulate};
use flexbody_mechanics::model::Model;

/// All quantities of the model, as integrals over the motion.
fn scene(model: &Model<f64>, duration: f64) -> Scene<f64> {
    let last = model.bodies.len() - 1;
    let all = functions(last, last.saturating_sub(1)).into_iter();
    let integrals = all.filter_map(|function| match function {
        Function::Reduced { of, .. } => Some(Function::Reduced {
            of,
            during: None,
            reduction: Reduction::Integral,
        }),
        _ => None,
    });
    Scene {
        model: model.clone(),
        duration,
        until: None,
        functions: integrals.collect(),
        unstarted: None,
    }
}

/// Numbers in [−½, ½) without a pattern: multiples of the golden ratio.
fn weights(count: usize, from: usize) -> Vec<f64> {
    let place = |k: usize| ((k + from + 1) as f64 * 0.618_033_988_749_895).fract();
    (0..count).map(|k| place(k) - 0.5).collect()
}

/// Σ w_k g_f(t_k) + Σ u_k t_k over every function f and instant t_k of a run.
fn weighted(functions: usize, run: &Trajectory<f64>) -> WeightedHistories {
    let count = run.last() + 1;
    WeightedHistories {
        functions: (0..functions).map(|f| (f, weights(count, 7 * f))).collect(),
        times: weights(count, 1000),
    }
}

/// The derivative of [`weighted`] in the direction by the complex step, and the motion. An integral with other
/// weights of its samples is the sum that is sought, times the duration.
fn by_complex_step(
    scene: &Scene<f64>,
    settings: &Settings,
    direction: &[f64],
) -> (f64, Trajectory<f64>) {
    let mut i = 0;
    let moved: Scene<Complex64> = scene.map(&mut |x| {
        i += 1;
        Complex64::new(x, COMPLEX_STEP * direction[i - 1])
    });
    let mut run = simulate(&moved.model, moved.duration, settings).expect("runs");
    let motion = run.real();
    let given = weighted(moved.functions.len(), &motion);
    let times = given.times.iter().enumerate();
    let mut sum: Complex64 = times.map(|(k, weight)| run.time(k) * weight).sum();
    let duration = run.time(run.last());
    for (f, weights) in given.functions {
        run.weights.clone_from(&weights);
        run.moving = weights;
        sum += moved.functions[f].evaluate(&moved.model, &run).value / duration;
    }
    (sum.im / COMPLEX_STEP, motion)
}

fn check(model: &Model<f64>, duration: f64, settings: &Settings) {
    let scene = scene(model, duration);
    let parameters = scene.parameters();
    for direction in 0..3 {
        let sizes = parameters.iter().map(|p| p.abs().max(0.1));
        let direction: Vec<f64> = (weights(parameters.len(), 31 * direction).iter().zip(sizes))
            .map(|(w, size)| w * size)
            .collect();
        // Adjoint and complex step differentiate the same motion.
        let (exact, run) = by_complex_step(&scene, settings, &direction);
        let target = Target::Histories(weighted(scene.functions.len(), &run));
        let found = gradients_of(&scene, &run, &[target]).expect("differentiates");
        let gradient = found.gradients[0].parameters();
        let terms = gradient.iter().zip(&direction);
        let sum: f64 = terms.clone().map(|(g, d)| g * d).sum();
        let size: f64 = terms.map(|(g, d)| (g * d).abs()).sum();
        let error = (sum - exact).abs() / size.max(exact.abs());
        assert!(
            error <= 1e-12,
            "{}: {sum} against {exact}, off by {error:e}",
            settings.method.name()
        );
    }
}

/// All methods, all quantities at once and the instants, in directions that change all parameters.
#[test]
fn functions_of_histories_have_exact_derivatives() {
    let (model, _) = reference::load("trebuchet");
    let (pendulum, _) = reference::load("triple_pendulum");
    for (model, duration) in [(&model, 0.5), (&pendulum, 0.4)] {
        for settings in explicit(model, duration, 10)
            .iter()
            .chain(&implicit(model, duration, 40))
        {
            check(model, duration, settings);
        }
    }
}

/// The derivative of the last value is that of the function that is the last value; two targets in one
/// march are the same as one by one, and take no more factorisations.
#[test]
fn histories_and_functions_agree() {
    let (model, _) = reference::load("trebuchet");
    let mut scene = scene(&model, 0.5);
    for function in &mut scene.functions {
        if let Function::Reduced { reduction, .. } = function {
            *reduction = Reduction::Final;
        }
    }
    let settings = &explicit(&model, 0.5, 10)[2];
    let run = simulate(&scene.model, 0.5, settings).expect("runs");
    let which: Vec<usize> = (0..scene.functions.len()).collect();
    let by_functions = gradients(&scene, &run, &which).expect("differentiates");
    let last = |f: usize| {
        let mut weights = vec![0.0; run.last() + 1];
        weights[run.last()] = 1.0;
        Target::Histories(WeightedHistories {
            functions: vec![(f, weights)],
            times: Vec::new(),
        })
    };
    let targets: Vec<Target> = which.iter().map(|&f| last(f)).collect();
    let all = gradients_of(&scene, &run, &targets).expect("differentiates");
    for f in which {
        let expected = by_functions.gradients[f].parameters();
        assert_eq!(all.gradients[f].parameters(), expected, "function {f}");
    }
    assert_eq!(
        all.counts.factorisations,
        by_functions.counts.factorisations
    );
}

/// Between the samples values follow a polynomial of degree five, with an estimate of its error; at the
/// samples they are the samples.
#[test]
fn values_between_samples_and_their_error() {
    let (model, _) = reference::load("triple_pendulum");
    let scene = scene(&model, 0.4);
    let run = |samples: usize| {
        let settings = Settings {
            samples: Samples::Uniform(samples),
            ..Settings::steps(Method::Dop853, 200)
        };
        simulate(&scene.model, 0.4, &settings).expect("runs")
    };
    let (coarse, fine) = (run(40), run(4000));
    let at: Vec<f64> = (0..=400).map(|k| f64::from(k) / 400.0).collect();
    let readings = Readings::at(&coarse, &at);
    for function in &scene.functions {
        let samples = history(function, &model, &coarse).expect("a quantity");
        let exact = history(function, &model, &fine).expect("a quantity");
        let values = readings.values(&samples);
        let scale = exact.iter().fold(0.0_f64, |m, x| m.max(x.abs())).max(1e-3);
        let mut worst = 0.0_f64;
        for (k, value) in values.iter().enumerate() {
            worst = worst.max((value - exact[10 * k]).abs());
            if k % 10 == 0 {
                assert_eq!(*value, samples[k / 10]);
            }
        }
        assert!(worst <= 1e-5 * scale, "off by {worst:e} of {scale:e}");
        let estimate = readings.error(&samples);
        assert!(
            worst <= 2.0 * estimate + 1e-12 * scale,
            "off by {worst:e}, estimated {estimate:e}"
        );
    }
    let shown = Readings::shown(&coarse);
    assert_eq!((shown.count(), readings.count()), (41, 401));
    let spread = readings.spread(&vec![1.0; 401]);
    // The weights of every instant sum to one.
    assert!((spread.iter().sum::<f64>() - 401.0).abs() < 1e-9);
}
