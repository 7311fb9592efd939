//! Scenes at the limits of round-off. They run if their motion is determined; otherwise they stop
//! after a bounded number of tries.

use crate::reference::models::Numbers;
use flexbody_driver::simulate;
use flexbody_mechanics::integrate::control::Controller;
use flexbody_mechanics::integrate::headway::Stop;
use flexbody_mechanics::integrate::scale::Scale;
use flexbody_mechanics::integrate::{Method, Settings, Spacing};
use flexbody_problem::{Override, Problem};
use serde_json::Value;
use std::path::Path;

fn extreme(name: &str, changes: &[String]) -> Problem {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/extreme/{name}.json"));
    let parse = |text: &String| Override::parse(text).expect("an override");
    let changes: Vec<Override> = changes.iter().map(parse).collect();
    Problem::load(&path, &changes).unwrap_or_else(|faults| panic!("{faults}"))
}

fn values(problem: &Problem) -> Vec<f64> {
    let seen = simulate(problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let count = problem.function_names.len();
    (0..count).map(|f| seen.at.function(f).value).collect()
}

/// Two ball joints close to each other are a hinge. Their line is known to 1e-16 m over their
/// distance, so a matrix is nearly singular. The number of steps is that of the hinge, up to a
/// small factor.
#[test]
fn ball_joints_close_to_each_other_are_a_hinge() {
    let radau = |stages: usize| json!({"radau": {"stages": stages}});
    hinges(&[
        (1e-6, 1.1, (0.2, 1e-9), Value::Null),
        (1e-6, 1.1, (0.4, 1e-9), Value::Null),
        (1e-6, 1.1, (0.8, 1e-9), Value::Null),
        (1e-6, 1.1, (1.6, 1e-9), Value::Null),
        (3e-7, 0.9, (0.8, 1e-8), Value::Null),
        (3e-6, 1.3, (0.8, 1e-8), radau(3)),
        (1e-5, 1.0, (0.8, 1e-9), radau(3)),
        (1e-6, 0.7, (0.8, 1e-9), radau(3)),
        (1e-6, 1.6, (0.8, 1e-7), radau(2)),
    ]);
}

/// By distance, width of the door, duration and tolerance, and method.
fn hinges(cases: &[(f64, f64, (f64, f64), Value)]) {
    let hinge = r#"/joints={"hinge":{"revolute":{"between":["door","ground"],"at":"door.first","axis":[0,0,1]}}}"#;
    for &(distance, width, (duration, tolerance), ref method) in cases {
        let mut simulation = json!({"duration": duration, "tolerance": tolerance});
        if !method.is_null() {
            simulation["method"] = method.clone();
        }
        let size = format!("/bodies/door/shape/box/size/0={width}");
        let exact = [
            size.clone(),
            hinge.into(),
            format!(r#"/simulation={{"duration":{duration},"tolerance":1e-12}}"#),
        ];
        let exact = values(&extreme("door", &exact));
        let close = [
            size,
            format!("/bodies/door/points/second/2={}", 0.9 + distance),
            format!("/simulation={simulation}"),
        ];
        let problem = extreme("door", &close);
        let seen =
            simulate(&problem, &problem.start()).unwrap_or_else(|e| panic!("{distance}: {e}"));
        for (f, exact) in exact.iter().enumerate() {
            let off = (seen.at.function(f).value - exact).abs();
            assert!(off < 100.0 * tolerance, "{distance:e}, {method}: {off:e}");
        }
        let steps = seen.at.run.grid.steps();
        assert!(steps < 3000, "{distance:e}, {method}: {steps}");
    }
}

/// A spring is so stiff that explicit steps make no headway. Radau IIA takes over, and the bob
/// moves as on a rod, to 1/ω².
#[test]
fn where_explicit_steps_make_no_headway_radau_takes_over() {
    for (stiffness, duration) in [(1e14, 1.0), (4e13, 0.6)] {
        let changes = [
            format!("/loads/spring/spring/stiffness={stiffness:e}"),
            format!("/simulation={{\"duration\":{duration},\"tolerance\":1e-9}}"),
        ];
        let problem = extreme("spring_pendulum", &changes);
        let seen = simulate(&problem, &problem.start()).expect("runs");
        assert_eq!(seen.at.run.method, Method::Radau { stages: 3 });
        assert!(seen.at.run.grid.steps() < 100_000);
        let [x, y] = [0, 1].map(|f| seen.at.function(f).value);
        assert!((x.hypot(y) - 1.0).abs() < 1e-9);
        let drift = seen.energy_drift();
        assert!(drift < 1e-6, "{drift:e}");
    }
}

/// Errors that do not decrease with the step end the run after a hundred tries. Errors that
/// decrease never do.
#[test]
fn rejections_in_a_row_are_bounded() {
    let problem = extreme("door", &[]);
    let scene = problem.scene(&problem.start());
    let scale = Scale {
        length: 1.0,
        floor: [1.0, 1.0],
        elastic: Default::default(),
        states: Vec::new(),
    };
    let mut numbers = Numbers(7);
    for tolerance in [1e-4, 1e-9, 1e-13] {
        for order in [3, 4, 8] {
            let mut settings = Settings::steps(Method::Dop853, 1);
            settings.spacing = Spacing::Tolerance(tolerance);
            let new = || Controller::new(&settings, order, &scale, (&scene.model, 1.0));
            // Just too large, irregular, and growing as steps shrink.
            for law in 0..3 {
                let mut controller = new();
                let (mut tries, mut before) = (0, 0.0);
                while let Some(width) = controller.next(0.0) {
                    tries += 1;
                    before = match law {
                        0 => 1.0001,
                        1 => 1.15 + 0.1 * numbers.next(),
                        _ => (1.0 + 1e-4 / width.sqrt()).min(1.2),
                    };
                    assert!(!controller.judge(before * tolerance), "{width:e}");
                }
                assert_eq!(tries, 100, "law {law}, {tolerance:e}, order {order}");
                assert_eq!(
                    controller.stopped(),
                    Some(Stop::Rejected { in_a_row: 100 }),
                    "{before}"
                );
            }
            // Two of three are too large.
            let mut controller = new();
            let (mut reached, mut tries) = (0.0, 0);
            while let Some(width) = controller.next(reached) {
                tries += 1;
                let end = controller.end(reached, width);
                let wanted = if tries % 3 == 0 { 0.5 } else { 1.5 };
                if controller.judge(wanted * tolerance) {
                    controller.accept();
                    reached = end;
                }
                if tries == 3000 {
                    break;
                }
            }
            let stop = controller.stopped();
            assert!(!matches!(stop, Some(Stop::Rejected { .. })), "{stop:?}");
        }
    }
}
