//! The rigid benchmarks under `problems/benchmarks` as they are shipped, against their references:
//! Andrews' squeezer from the test set for IVP solvers (Mazzia & Magherini 2008, solved by PSIDE); the
//! simple pendulum from elliptic functions; the governor from an independent integration of its
//! three coordinates to 1e-11 (Radau).

use flexbody::driver::{Journal, Simulation, optimise, simulate};
use flexbody::problem::{Override, Problem};
use serde_json::Value;
use std::ops::ControlFlow;
use std::path::Path;

fn load(name: &str, changes: &[String]) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join(format!("problems/benchmarks/{name}.json"));
    let parse = |text: &String| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path, &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

fn run(name: &str, duration: f64) -> Simulation {
    let problem = load(name, &[format!("/simulation/duration={duration}")]);
    simulate(&problem, &problem.start()).expect("runs")
}

fn values(motion: &Simulation) -> Vec<f64> {
    let count = motion.at.scene.functions.len();
    (0..count).map(|f| motion.at.function(f).value).collect()
}

/// Asserts a list of values to `tolerance` of the largest.
fn agree(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        let error = (found - expected).abs() / size;
        assert!(
            error <= tolerance,
            "{what}: {found} against {expected}: {error:e}"
        );
    }
}

/// A01: positions after 1, 2, 5 and 10 s.
#[test]
fn simple_pendulum() {
    for (duration, exact) in [
        (1.0, [0.986_291_751_131_875, -0.165_010_853_125_541]),
        (2.0, [-0.793_566_195_343_322, -0.608_483_930_443_792]),
        (5.0, [-0.942_305_435_043_757, -0.334_754_338_414_001]),
        (10.0, [-0.275_087_462_576_117, -0.961_419_205_099_125]),
    ] {
        agree(
            "A01",
            &values(&run("simple_pendulum", duration)),
            &exact,
            1e-9,
        );
    }
}

/// A03 at 0.03 s: angles to 1e-9, angular velocities to 1e-8, multipliers (forces in the joints at
/// E) to 1e-7 of the largest.
#[test]
fn andrews_squeezer() {
    let motion = run("andrews_squeezer", 0.03);
    let [beta, theta, gamma, phi, delta, omega, epsilon] = [
        15.810_771_196_299_04,
        -15.756_371_059_842_98,
        0.040_822_240_130_731_01,
        -0.534_730_116_322_694_8,
        0.524_409_965_880_530_4,
        0.534_730_116_322_694_8,
        1.048_080_741_042_263,
    ];
    let angles = [
        beta,
        beta + theta,
        gamma,
        phi + delta,
        delta,
        omega + epsilon,
        epsilon,
    ];
    agree("A03 angles", &values(&motion), &angles, 1e-9);
    let [beta, theta, gamma, phi, delta, omega, epsilon] = [
        1_139.920_302_151_208,
        -1_424.379_294_994_111,
        11.032_912_219_371_34,
        19.293_374_644_213_85,
        0.573_569_928_479_080_8,
        -19.293_374_644_213_85,
        0.323_179_165_802_695_5,
    ];
    // In the order of the bodies.
    let rates = [
        beta,
        beta + theta,
        gamma,
        delta,
        phi + delta,
        epsilon,
        omega + epsilon,
    ];
    let run = &motion.at.run;
    let v = run.v(run.last());
    let found: Vec<f64> = v.chunks(6).map(|six| six[5]).collect();
    agree("A03 rates", &found, &rates, 1e-8);
    let multipliers = [
        199.175_333_373_191,
        -29.755_312_280_150_52,
        23.066_541_190_983_99,
        31.452_713_654_759_27,
        22.642_492_320_827_39,
        11.617_407_000_196_73,
    ];
    let reactions = motion.reactions(run.last());
    let joints = motion.at.scene.model.joints.iter().zip(&reactions);
    let at_e = joints.filter(|(joint, _)| joint.name.starts_with('E'));
    let found: Vec<f64> = at_e
        .flat_map(|(_, at)| [-at.force_ground.x, -at.force_ground.y])
        .collect();
    assert_eq!(found.len(), multipliers.len());
    agree("A03 multipliers", &found, &multipliers, 1e-7);
}

/// A05: height of the slider, given to ten digits.
#[test]
fn flyball_governor() {
    for (duration, height) in [
        (0.5, 0.743_249_424_8),
        (1.0, 0.501_420_922_4),
        (5.0, 0.535_563_103_7),
        (10.0, 0.619_622_917_1),
    ] {
        let found = values(&run("flyball_governor", duration))[0];
        assert!(
            (found - height).abs() <= 1e-8,
            "{duration}: {found} against {height}"
        );
    }
}

/// A spring of 1e5 rad/s without damping, at ω h = 100 by Radau IIA with three stages, against an
/// integration that resolves it: the slow swing is met to 1e-8 m and 1e-7 m/s throughout, and nothing
/// fast is excited.
#[test]
fn stiff_pendulum() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join("tests/data/stiff_pendulum_reference.json");
    let text = std::fs::read_to_string(path).expect("a reference");
    let file: Value = serde_json::from_str(&text).expect("valid JSON");
    let rows: Vec<Vec<f64>> =
        serde_json::from_value(file["trajectory"].clone()).expect("rows of numbers");
    let motion = run("stiff_pendulum", 3.0);
    let run = &motion.at.run;
    for row in &rows[1..] {
        let k = (row[0] / 3.0 * run.last() as f64).round() as usize;
        for i in 0..2 {
            let (x, v) = (run.q(k)[i] - row[1 + i], run.v(k)[i] - row[3 + i]);
            assert!(
                x.abs() <= 1e-8 && v.abs() <= 1e-7,
                "{} s: {x:e}, {v:e}",
                row[0]
            );
        }
    }
}

/// The shaking force vanishes where s1 = −L1 (m2 + m3) / m1 = −0.075 m and
/// s2 = −L2 m3 / m2 = −0.15 m: found by gradient from 0.075 m and 0.3 m away, and from the other side.
#[test]
fn balanced_slider_crank() {
    for start in [[0.0, 0.15], [-0.1, -0.2]] {
        let paths = ["crank", "rod"].map(|body| format!("/bodies/{body}/centre_of_mass/0"));
        let changes = [0, 1].map(|i| format!("{}={}", paths[i], start[i]));
        let problem = load("balanced_slider_crank", &changes);
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        let done = optimise(&problem, "", None, Journal::default(), go_on).expect("an objective");
        let design = &done.history.rows.last().expect("iterations").design;
        agree("balance", design, &[-0.075, -0.15], 1e-6);
    }
}
