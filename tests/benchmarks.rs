//! The rigid benchmarks under `problems/benchmarks` against their references.
//!
//! BDF2 errs by c₂h² + O(h³), so what is compared is the value that two runs with h and h/2
//! extrapolate to, (4 f(h/2) − f(h)) / 3, to the tolerance stated at each test; the error of the finer
//! run itself is bounded too. References: Andrews' squeezer from the test set for IVP solvers
//! (Mazzia & Magherini 2008, solved by PSIDE); the simple pendulum from elliptic functions; the
//! governor from an independent integration of its three coordinates to 1e-11 (Radau).

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

fn run(name: &str, duration: f64, steps: usize) -> Simulation {
    let changes = [
        format!("/simulation/duration={duration}"),
        format!("/simulation/steps={steps}"),
    ];
    let problem = load(name, &changes);
    simulate(&problem, &problem.start()).expect("runs")
}

fn values(motion: &Simulation) -> Vec<f64> {
    let count = motion.at.scene.functions.len();
    (0..count).map(|f| motion.at.function(f).value).collect()
}

/// Asserts what `read` finds in runs with `steps` and twice as many: extrapolated to `tolerance`
/// and in the finer run to `finer`, both relative to the largest of the expected values.
fn assert_extrapolated(
    (name, duration, steps): (&str, f64, usize),
    read: impl Fn(&Simulation) -> Vec<f64>,
    expected: &[f64],
    (tolerance, finer): (f64, f64),
) {
    let [coarse, fine] = [steps, 2 * steps].map(|steps| read(&run(name, duration, steps)));
    let size = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (i, expected) in expected.iter().enumerate() {
        let limit = (4.0 * fine[i] - coarse[i]) / 3.0;
        let errors = [limit - expected, fine[i] - expected].map(|e| e.abs() / size);
        assert!(
            errors[0] <= tolerance && errors[1] <= finer,
            "{name} {i}: {limit} against {expected}, {errors:?}"
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
        let steps = (2000.0 * duration) as usize;
        let case = ("simple_pendulum", duration, steps);
        assert_extrapolated(case, values, &exact, (1e-6, 1e-4));
    }
}

/// A03: angles at 0.03 s.
#[test]
fn andrews_squeezer_angles() {
    let angles = [
        15.810_771_196_299_04,
        15.810_771_196_299_04 - 15.756_371_059_842_98,
        0.040_822_240_130_731_01,
        -0.534_730_116_322_694_8 + 0.524_409_965_880_530_4,
        0.524_409_965_880_530_4,
        0.534_730_116_322_694_8 + 1.048_080_741_042_263,
        1.048_080_741_042_263,
    ];
    let read = |motion: &Simulation| values(motion)[..7].to_vec();
    let case = ("andrews_squeezer", 0.03, 30_000);
    assert_extrapolated(case, read, &angles, (1e-9, 1e-7));
}

/// A03: angular velocities (rad/s) and multipliers (N, forces in the joints at E) at 0.03 s.
#[test]
fn andrews_squeezer_velocities_and_multipliers() {
    let [beta, theta, gamma, phi, delta, omega, epsilon] = [
        1_139.920_302_151_208,
        -1_424.379_294_994_111,
        11.032_912_219_371_34,
        19.293_374_644_213_85,
        0.573_569_928_479_080_8,
        -19.293_374_644_213_85,
        0.323_179_165_802_695_5,
    ];
    let rates = [
        beta,
        beta + theta,
        gamma,
        delta,
        phi + delta,
        epsilon,
        omega + epsilon,
    ];
    let read = |motion: &Simulation| {
        let run = &motion.at.run;
        let v = run.v(run.last());
        v.chunks(6).map(|six| six[5]).collect()
    };
    let case = ("andrews_squeezer", 0.03, 30_000);
    assert_extrapolated(case, read, &rates, (1e-8, 1e-6));
    let multipliers = [
        199.175_333_373_191,
        -29.755_312_280_150_52,
        23.066_541_190_983_99,
        31.452_713_654_759_27,
        22.642_492_320_827_39,
        11.617_407_000_196_73,
    ];
    let read = |motion: &Simulation| {
        let model = &motion.at.scene.model;
        let reactions = motion.reactions(motion.at.run.last());
        let at_e = model.joints.iter().zip(&reactions);
        let at_e = at_e.filter(|(joint, _)| joint.name.starts_with('E'));
        at_e.flat_map(|(_, reaction)| [-reaction.force_ground.x, -reaction.force_ground.y])
            .collect()
    };
    assert_extrapolated(case, read, &multipliers, (1e-7, 1e-5));
}

/// A05: height of the slider.
#[test]
fn flyball_governor() {
    for (duration, height) in [
        (0.5, 0.743_249_424_8),
        (1.0, 0.501_420_922_4),
        (5.0, 0.535_563_103_7),
        (10.0, 0.619_622_917_1),
    ] {
        let steps = (2000.0 * duration) as usize;
        let read = |motion: &Simulation| vec![values(motion)[0]];
        let case = ("flyball_governor", duration, steps);
        assert_extrapolated(case, read, &[height], (1e-6, 1e-4));
    }
}

/// A spring of 1e5 rad/s without damping, ω h = 100 and 50, against an integration that resolves
/// it: the slow swing is met to the order of the formula, and nothing fast is excited.
#[test]
fn stiff_pendulum() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"));
    let path = path.join("tests/data/stiff_pendulum_reference.json");
    let text = std::fs::read_to_string(path).expect("a reference");
    let file: Value = serde_json::from_str(&text).expect("valid JSON");
    let rows = file["trajectory"].as_array().expect("rows");
    let row = |value: &Value| -> Vec<f64> { serde_json::from_value(value.clone()).expect("row") };
    let [coarse, fine] = [3000, 6000].map(|steps| run("stiff_pendulum", 3.0, steps));
    let (mut worst, mut limit) = (0.0_f64, 0.0_f64);
    for row in rows.iter().map(row).skip(1) {
        let at = |motion: &Simulation, i: usize| {
            let run = &motion.at.run;
            let k = (row[0] / run.duration * run.last() as f64).round() as usize;
            if i < 2 { run.q(k)[i] } else { run.v(k)[i - 2] }
        };
        for i in 0..4 {
            let [c, f] = [&coarse, &fine].map(|motion| at(motion, i));
            worst = worst.max((f - row[1 + i]).abs());
            limit = limit.max(((4.0 * f - c) / 3.0 - row[1 + i]).abs());
        }
    }
    assert!(
        worst <= 3e-4 && limit <= 3e-6,
        "{worst:e}, extrapolated {limit:e}"
    );
}

/// The shaking force vanishes where s1 = −L1 (m2 + m3) / m1 = −0.075 m and
/// s2 = −L2 m3 / m2 = −0.15 m: found by gradient from 0.075 m and 0.3 m away, with an error of h²
/// (7e-5 m at 0.5 ms) as the frame moves a little under steps of finite size.
#[test]
fn balanced_slider_crank() {
    let found = [1000, 2000].map(|steps| {
        let problem = load(
            "balanced_slider_crank",
            &[format!("/simulation/steps={steps}")],
        );
        let go_on = &mut |_: &_| ControlFlow::Continue(());
        let done = optimise(&problem, "", None, Journal::default(), go_on).expect("an objective");
        done.history.rows.last().expect("iterations").design.clone()
    });
    for (i, exact) in [-0.075, -0.15].into_iter().enumerate() {
        let limit = (4.0 * found[1][i] - found[0][i]) / 3.0;
        assert!(
            (limit - exact).abs() <= 1e-6,
            "{i}: {limit} against {exact}"
        );
    }
}
