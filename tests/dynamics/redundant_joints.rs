//! Redundant joints: redundant rows are left out and named, and the motion is that without them.
//! Singular positions and joints that do not fit are distinguished from redundancy.

use crate::reference;
use crate::reference::documents::{benchmark, final_positions, problem};

use flexbody_driver::{check, simulate};
use flexbody_mechanics::integrate::IntegrationFailure;
use flexbody_mechanics::system::observe::Reaction;
use flexbody_problem::{Override, Problem};
use reference::models::Numbers;
use serde_json::Value;
use std::path::Path;

fn left_out(problem: &Problem) -> Vec<(&str, usize)> {
    let all = problem.redundant.iter();
    all.map(|r| (r.joint.as_str(), r.left_out)).collect()
}

/// A door on hinges about the y axis at these heights, with an initial velocity.
fn door(hinges: &[f64]) -> Value {
    let hinge = |y: &f64| {
        (
            format!("hinge at {y}"),
            json!({"revolute": {"between": ["door", "ground"], "at": [0, y, 0], "axis": [0, 1, 0]}}),
        )
    };
    json!({
        "version": 1, "name": "door",
        "bodies": {"door": {"shape": {"box": {"size": [1, 2, 0.04]}}, "mass": 30,
                            "place": {"at": [0.5, 0, 0]},
                            "velocity": {"linear": [0, 0, -1], "angular": [0, 2, 0]}}},
        "joints": hinges.iter().map(hinge).collect::<serde_json::Map<_, _>>(),
        "loads": {"closer": {"force": {"body": "door", "direction": [0, 0, 1], "axes": "body",
                                       "magnitude": {"harmonic": {"amplitude": 3,
                                                                  "frequency": 1}}}}},
        "simulation": {"duration": 1, "steps": 200},
        "functions": {"turn": {"final": {"rotation": {"body": "door", "axis": [0, 1, 0]}}}},
        "variables": {"mass": {"path": "/bodies/door/mass", "lower": 1}}
    })
}

#[test]
fn a_door_on_three_hinges_moves_as_on_one() {
    let (three, one) = (problem(&door(&[-0.8, 0.8, 0.1])), problem(&door(&[0.2])));
    assert_eq!(left_out(&one), []);
    assert_eq!(left_out(&three), [("hinge at 0.8", 5), ("hinge at 0.1", 5)]);
    assert_eq!(
        three.redundant[0].to_string(),
        "joint \"hinge at 0.8\": 5 of 5 rows follow from the others to 1e-11 and are left out; its \
         reactions are not unique"
    );
    let [a, b] = [&three, &one].map(|p| simulate(p, &p.start()).expect("runs"));
    assert!((a.at.function(0).value - b.at.function(0).value).abs() < 1e-12);
    assert!(a.constraint_drift().0 < 1e-12);
    for derivative in check(&three, &three.start()).expect("runs") {
        assert!(derivative.relative_difference() <= 1e-12, "{derivative:?}");
    }
}

/// The smallest reactions over all rows share the weight equally. Together they equal those of a
/// single hinge.
#[test]
fn reactions_of_a_door_on_two_hinges_are_shared() {
    let (two, one) = (problem(&door(&[-0.8, 0.8])), problem(&door(&[0.0])));
    let [a, b] = [&two, &one].map(|p| simulate(p, &p.start()).expect("runs"));
    for k in [0, 57, 200] {
        let (shared, whole) = (a.reactions(k), b.reactions(k)[0]);
        let force = shared[0].force_ground + shared[1].force_ground;
        assert!((force - whole.force_ground).amax() < 1e-8 * whole.force_ground.norm());
        let lever =
            |y: f64, f: nalgebra::Vector3<f64>| nalgebra::Vector3::new(0.0, y, 0.0).cross(&f);
        let torque = shared[0].torque_ground
            + shared[1].torque_ground
            + lever(-0.8, shared[0].force_ground)
            + lever(0.8, shared[1].force_ground);
        assert!((torque - whole.torque_ground).amax() < 1e-8 * whole.torque_ground.norm());
        // 30 kg · 9.81 m/s² in equal parts.
        for reaction in &shared {
            assert!((reaction.force_ground.y - 147.15).abs() < 1e-8);
        }
    }
}

/// A parallelogram of rods of 1 m and 1 kg, N cells wide, at `angle` from upright. Its upper nodes
/// move to the right at 1 m/s (MBS benchmark library, A02).
fn parallelograms(n: usize, angle: f64) -> Value {
    let (mut bodies, mut joints) = (serde_json::Map::new(), serde_json::Map::new());
    let half = std::f64::consts::FRAC_PI_2;
    let hinge = |a: &str, b: &str, at: Value| json!({"revolute": {"between": [a, b], "at": at, "axis": [0, 0, 1]}});
    let rod = |place: Value, velocity: Value| {
        json!({"shape": {"box": {"size": [1, 0.05, 0.05]}}, "mass": 1,
               "points": {"from": [-0.5, 0, 0], "to": [0.5, 0, 0]},
               "place": place, "velocity": velocity})
    };
    let (s, c) = angle.sin_cos();
    for i in 0..=n {
        let name = format!("bar {i}");
        let place = json!({"put": "from", "at": [i, 0, 0],
                           "turn": {"axis": [0, 0, 1], "angle": half - angle}});
        let velocity = json!({"linear": [0.5 * c, -0.5 * s, 0], "angular": [0, 0, -1]});
        bodies.insert(name.clone(), rod(place, velocity));
        joints.insert(format!("A{i}"), hinge(&name, "ground", json!([i, 0, 0])));
    }
    for i in 0..n {
        let (left, right) = (format!("bar {i}"), format!("bar {}", i + 1));
        let name = format!("coupler {i}");
        let place = json!({"put": "from", "at": format!("{left}.to")});
        bodies.insert(name.clone(), rod(place, json!({"linear": [c, -s, 0]})));
        joints.insert(
            format!("B{i}"),
            hinge(&name, &left, json!(format!("{left}.to"))),
        );
        joints.insert(
            format!("C{i}"),
            hinge(&name, &right, json!(format!("{right}.to"))),
        );
    }
    let x = json!({"position": {"body": "bar 0", "point": "to", "direction": [1, 0, 0]}});
    json!({
        "version": 1, "name": "parallelograms", "bodies": bodies, "joints": joints,
        "simulation": {"duration": 0.6, "steps": 2400},
        "functions": {"x": {"final": x}},
        "variables": {
            "mass": {"path": "/bodies/coupler 0/mass", "lower": 0.1},
            "tilt": {"path": "/joints/C0/revolute/axis/0"}
        }
    })
}

/// θ(t) of [(N + 1)/3 + N] θ̈ = [(N + 1)/2 + N] g sin θ, θ(0) = 0, θ̇(0) = 1, by the classical
/// Runge–Kutta method; the rods' thickness adds 0.05²/12 to (N + 1)/3.
fn angle_of(n: usize, time: f64) -> f64 {
    let n = n as f64;
    let inertia = (n + 1.0) * (1.0 / 3.0 + 0.0025 / 12.0) + n;
    let k = ((n + 1.0) / 2.0 + n) * 9.81 / inertia;
    let steps = 20_000;
    let h = time / f64::from(steps);
    let (mut x, mut v) = (0.0_f64, 1.0_f64);
    for _ in 0..steps {
        let (a1, b1) = (v, k * x.sin());
        let (a2, b2) = (v + 0.5 * h * b1, k * (x + 0.5 * h * a1).sin());
        let (a3, b3) = (v + 0.5 * h * b2, k * (x + 0.5 * h * a2).sin());
        let (a4, b4) = (v + h * b3, k * (x + h * a3).sin());
        x += h * (a1 + 2.0 * a2 + 2.0 * a3 + a4) / 6.0;
        v += h * (b1 + 2.0 * b2 + 2.0 * b3 + b4) / 6.0;
    }
    x
}

/// Three of the conditions out of the plane of each cell are redundant. The motion is that of the
/// single coordinate, to the error of BDF2 (2e-6 m), and its gradient is exact.
#[test]
fn parallelograms_move_in_their_plane() {
    for n in [1, 2, 5] {
        let problem = problem(&parallelograms(n, 0.0));
        let rows: usize = problem.redundant.iter().map(|r| r.left_out).sum();
        assert_eq!(rows, 3 * n, "{:?}", problem.redundant);
        let motion = simulate(&problem, &problem.start()).expect("runs");
        let error = (motion.at.function(0).value - angle_of(n, 0.6).sin()).abs();
        assert!(error < 2e-6, "{n}: {error:e}");
        assert!(motion.constraint_drift().0 < 1e-11);
    }
    let mut file = parallelograms(2, 0.0);
    file["simulation"]["steps"] = json!(300);
    file["variables"] = json!({"mass": {"path": "/bodies/coupler 0/mass", "lower": 0.1}});
    let problem = problem(&file);
    for derivative in check(&problem, &problem.start()).expect("runs") {
        assert!(derivative.relative_difference() <= 1e-12, "{derivative:?}");
    }
}

/// A design at which the redundant rows become independent fails with an error.
#[test]
fn a_design_that_breaks_the_redundancy_is_refused_by_name() {
    let mut file = parallelograms(1, 0.3);
    file["simulation"] = json!({"duration": 0.3, "steps": 300});
    let problem = problem(&file);
    let start = simulate(&problem, &[1.0, 0.0]);
    assert!(start.is_ok(), "{:?}", start.err());
    match simulate(&problem, &[1.0, 0.2]) {
        Err(failure @ IntegrationFailure::RedundancyLost { .. }) => {
            assert!(
                failure.to_string().contains("does not follow any more"),
                "{failure}"
            );
        }
        other => panic!("{:?}", other.map(|run| run.constraint_drift())),
    }
}

/// With all rods in a line one more row is dependent, only there: no redundancy.
#[test]
fn a_singular_position_is_no_redundancy() {
    let half = std::f64::consts::FRAC_PI_2;
    let file = parallelograms(1, half);
    let fault = Problem::parse(&file.to_string(), "redundant.json", &[])
        .expect_err("a singular position")
        .to_string();
    assert!(
        fault.contains("the placement is a singular position"),
        "{fault}"
    );
    assert!(fault.contains("straight or folded positions"), "{fault}");
    let beside = problem(&parallelograms(1, half - 1e-3));
    let rows: usize = beside.redundant.iter().map(|r| r.left_out).sum();
    assert_eq!(rows, 3);
}

#[test]
fn joints_that_contradict_each_other_are_no_redundancy() {
    let mut file = door(&[-0.8, 0.8]);
    file["joints"]["hinge at 0.8"]["revolute"]["axis"] = json!({"body": "door", "axis": [0, 1, 0]});
    assert_eq!(left_out(&problem(&file)), [("hinge at 0.8", 5)]);
    file["joints"]["hinge at 0.8"]["revolute"]["at"] =
        json!({"a": [-0.5, 0.8, 0], "b": [0, 0.9, 0]});
    let fault = Problem::parse(&file.to_string(), "redundant.json", &[])
        .expect_err("joints that do not fit")
        .to_string();
    assert!(fault.contains("cannot be assembled"), "{fault}");
}

/// A weld and a rod hold two swinging bodies together. Their shares of the load follow from the
/// forces, for any drift of the joints and with any reductions.
#[test]
fn shares_of_redundant_joints_are_smooth() {
    let solid = json!({"box": {"size": [1, 0.2, 0.3]}});
    let body = |at: f64| json!({"shape": solid, "mass": 1, "place": {"put": [-0.5, 0, 0], "at": [at, 0, 0]}});
    let both = ["a", "b"];
    let file = json!({
        "version": 1, "name": "held twice", "gravity": [0, -9.81, 1],
        "bodies": {"a": body(0.0), "b": body(1.0), "c": body(2.0), "d": body(3.0)},
        "joints": {
            "pin": {"spherical": {"between": ["a", "ground"], "at": [0, 0, 0]}},
            "seam": {"weld": {"between": both, "at": [1, 0, 0]}},
            "rod": {"rod": {"between": both, "at": [[0.5, 0.1, 0], [1.5, 0.1, 0.1]]}},
            "holder": {"spherical": {"between": ["c", "b"], "at": [2, 0, 0]}},
            "clamp": {"weld": {"between": ["c", "d"], "at": [3, 0, 0]}}
        },
        "simulation": {"duration": 1, "tolerance": 1e-12, "samples": 200}
    });
    let mut written = problem(&file);
    let lowered = written.clone();
    assert!(
        lowered
            .lowering
            .as_ref()
            .is_some_and(|own| !own.welded.is_empty())
    );
    written.lowering = None;
    let [lowered, written] = [&lowered, &written].map(|p| simulate(p, &p.start()).expect("runs"));
    let last = lowered.motion().last();
    let [lowered, written] = [&lowered, &written].map(|run| run.reactions_at(0..=last));
    let apart =
        |a: &Reaction, b: &Reaction| (a.force - b.force).norm() + (a.torque - b.torque).norm();
    let mut share = 0.0_f64;
    for (k, (a, b)) in lowered.iter().zip(&written).enumerate() {
        let size = b.iter().map(|own| own.force.norm() + own.torque.norm());
        let size = size.fold(0.0, f64::max);
        for (j, (a, b)) in a.iter().zip(b).enumerate() {
            let off = apart(a, b);
            assert!(
                off <= 1e-6 * size,
                "joint {j}, instant {k}: {off:e} of {size}"
            );
        }
        share = share.max(b[2].force.norm() / size);
        if k >= 2 {
            for j in 0..a.len() {
                let (before, now) = (&lowered[k - 1][j], &a[j]);
                let off = apart(now, before);
                assert!(off <= 0.2 * size, "joint {j}, instant {k}: {off} of {size}");
            }
        }
    }
    assert!(share > 1e-3, "{share}");
}

/// A tree of bodies has no redundant rows.
#[test]
fn trees_are_not_searched() {
    for name in ["trebuchet", "trebuchet_release_time", "triple_pendulum"] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("problems/{name}.json"));
        let problem = Problem::load(&path, &[]).expect("no faults");
        assert_eq!(problem.redundant, []);
    }
}

/// Positions of P3 agree to 1e-8 m with an independent integration of the loop's single coordinate
/// to 1e-10 (its energy error is 6e-14 J).
#[test]
fn bricards_mechanism() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/benchmarks/bricard.json");
    for (duration, exact) in [
        (1, [0.510_501_461_2, -1.649_167_599_4, 0.140_123_114_6]),
        (2, [-0.969_340_344_8, -1.221_246_895_0, 0.754_278_010_8]),
        (10, [0.999_999_963_8, -1.000_269_012_7, 0.999_730_951_1]),
    ] {
        let change = format!("/simulation/duration={duration}");
        let change = Override::parse(&change).expect("an override");
        let problem = Problem::load(&path, &[change]).expect("no faults");
        let rows: usize = problem.redundant.iter().map(|r| r.left_out).sum();
        assert_eq!(rows, 1, "{:?}", problem.redundant);
        let motion = simulate(&problem, &[]).expect("runs");
        for (f, exact) in exact.iter().enumerate() {
            let found = motion.at.function(f).value;
            assert!(
                (found - exact).abs() <= 1e-8,
                "{duration} s: {found} against {exact}"
            );
        }
        assert!(motion.constraint_drift().0 < 1e-8);
    }
}

/// Rows of linkages pass singular positions (MBS benchmark library, A02) by the explicit method
/// with a tolerance of 1e-9: ten passages in 10 s, to 1e-6 of the exact motion of the single
/// coordinate.
#[test]
fn linkages_pass_singular_positions_on_their_branch() {
    for (n, exact) in [
        (1, [0.478_385_057_8, 0.878_150_178_8]),
        (2, [0.328_458_111_5, 0.944_518_538_2]),
        (10, [0.204_353_561, 0.978_897_145_8]),
        (40, [0.180_512_226_7, 0.983_572_740_6]),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = path.join(format!("problems/benchmarks/four_bars_{n}.json"));
        let problem = Problem::load(&path, &[]).expect("no faults");
        let rows: usize = problem.redundant.iter().map(|r| r.left_out).sum();
        assert_eq!(rows, 3 * n);
        let motion = simulate(&problem, &[]).expect("runs");
        for (f, exact) in exact.iter().enumerate() {
            let found = motion.at.function(f).value;
            assert!(
                (found - exact).abs() <= 1e-6,
                "{n}: {found} against {exact}"
            );
        }
    }
}

/// Radau IIA with equal steps passes two singular positions, in which all rods are in line, with
/// the accuracy of its order, or reports where it cannot.
#[test]
fn implicit_steps_pass_singular_positions_rightly_or_name_them() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("problems/benchmarks/four_bars_2.json");
    for steps in [80, 100, 160, 300] {
        let steps = format!(
            r#"/simulation={{"duration": 1, "steps": {steps}, "method": {{"radau": {{"stages": 3}}}}}}"#
        );
        let changed = Override::parse(&steps).expect("an override");
        let problem = Problem::load(&path, &[changed]).expect("no faults");
        match simulate(&problem, &[]) {
            Ok(done) => {
                let found = [0, 1].map(|f| done.at.function(f).value);
                // The exact equation of its single coordinate, at 1 s.
                let apart = (found[0] + 0.1950203019).hypot(found[1] + 0.9807992057);
                assert!(apart < 1e-5, "{steps}: {found:?}");
            }
            Err(failure) => {
                let told = failure.to_string();
                let named =
                    told.contains("nearly singular there") || told.contains("singular position");
                assert!(named, "{steps}: {told}");
            }
        }
    }
}

/// A parallelogram of rods of 1 m that starts upright and rotates at this speed [rad/s] without
/// gravity. Its speed is constant. After quarter turns it is in line, where its rods could fold.
fn turning_parallelogram(speed: f64, simulation: &Value) -> Value {
    let half = std::f64::consts::FRAC_PI_2;
    let rod = |place: Value, linear: f64, angular: f64| {
        json!({"shape": {"rod": {"length": 1, "radius": 0.02}}, "mass": 1,
               "points": {"a": [-0.5, 0, 0], "b": [0.5, 0, 0]}, "place": place,
               "velocity": {"linear": [linear, 0, 0], "angular": [0, 0, angular]}})
    };
    let upright =
        |at: f64| json!({"put": "a", "at": [at, 0, 0], "turn": {"axis": [0, 0, 1], "angle": half}});
    let hinge = |a: &str, b: &str, at: Value| json!({"revolute": {"between": [a, b], "at": at, "axis": [0, 0, 1]}});
    let rotation = |body: &str| json!({"final": {"rotation": {"body": body, "axis": [0, 0, 1]}}});
    json!({
        "version": 1, "name": "turning parallelogram", "gravity": [0, 0, 0],
        "bodies": {"in": rod(upright(0.0), -0.5 * speed, speed),
                   "coupler": rod(json!({"put": "a", "at": "in.b"}), -speed, 0.0),
                   "out": rod(upright(1.0), -0.5 * speed, speed)},
        "joints": {"A": hinge("in", "ground", json!([0, 0, 0])),
                   "B": hinge("coupler", "in", json!("in.b")),
                   "C": hinge("coupler", "out", json!("coupler.b")),
                   "D": hinge("out", "ground", json!([1, 0, 0]))},
        "simulation": simulation,
        "functions": {"in": rotation("in"), "out": rotation("out"),
                      "energy": {"integral": {"energy": "kinetic"}},
                      "acceleration": {"final": {"acceleration": {"body": "coupler", "direction": [0, 1, 0]}}}},
        "variables": {"mass": {"path": "/bodies/out/mass", "lower": 0.1},
                      "speed": {"path": "/bodies/in/velocity/angular/2", "lower": 0.1}}
    })
}

/// Largest error of a run of the rotating parallelogram for `duration`, each relative to its scale.
fn error_of_turning(speed: f64, duration: f64, more: &Value) -> Result<f64, IntegrationFailure> {
    let mut simulation = json!({"duration": duration});
    for (key, value) in more.as_object().expect("settings") {
        simulation[key] = value.clone();
    }
    let problem = problem(&turning_parallelogram(speed, &simulation));
    let run = simulate(&problem, &problem.start())?;
    let angle = std::f64::consts::FRAC_PI_2 + speed * duration;
    // Two rods about their ends, with a radius of 0.02 m, and the coupler.
    let energy = 0.5 * (2.0 * (1.0 / 3.0 + 0.02 * 0.02 / 4.0) + 1.0) * speed * speed;
    let exact = [
        (angle, angle),
        (angle, angle),
        (energy * duration, energy * duration),
        (-speed * speed * angle.sin(), speed * speed),
    ];
    let errors = exact.iter().enumerate().map(|(f, (exact, scale))| {
        let error = (run.at.function(f).value - exact) / scale.max(1.0);
        assert!(error.is_finite());
        error.abs()
    });
    let (open, slips) = run.constraint_drift();
    let all = errors.chain([open, slips / speed.max(1.0)]);
    Ok(all.fold(0.0, f64::max))
}

/// Distances from a singular position, on both sides.
fn distances(count: i32) -> impl Iterator<Item = f64> {
    (0..count).flat_map(move |k| {
        let d = 10.0_f64.powf(-13.0 * f64::from(k) / f64::from(count - 1)) * 0.3;
        [d, -d]
    })
}

/// Runs that end at any distance from a singular position are as accurate as others: the last step
/// leaps over it.
#[test]
fn runs_end_at_singular_positions() {
    let half = std::f64::consts::FRAC_PI_2;
    for d in distances(30).chain([0.0]) {
        let error = error_of_turning(1.0, half + d, &json!({}));
        assert!(error.as_ref().is_ok_and(|&e| e < 3e-8), "{d:e}: {error:?}");
    }
    for d in distances(4).chain([0.0]) {
        for tolerance in [1e-5, 1e-7, 1e-11, 1e-13] {
            let more = json!({"tolerance": tolerance, "samples": 100});
            let error = error_of_turning(1.0, 3.0 * half + d, &more);
            let most = 300.0 * tolerance + 3e-9;
            assert!(
                error.as_ref().is_ok_and(|&e| e < most),
                "{d:e}, {tolerance:e}: {error:?}"
            );
        }
    }
}

/// The same for speeds at which the same duration ends there, after some passages.
#[test]
fn any_speed_passes_singular_positions() {
    let half = std::f64::consts::FRAC_PI_2;
    for (k, d) in distances(30).enumerate() {
        let speed = (half * (1 + 2 * (k % 4)) as f64 + d) / 1.5;
        let error = error_of_turning(speed, 1.5, &json!({}));
        assert!(
            error.as_ref().is_ok_and(|&e| e < 3e-7),
            "{speed}, {d:e}: {error:?}"
        );
    }
}

/// Equal steps cannot avoid singular positions. They are accurate or rejected.
#[test]
fn given_steps_are_accurate_or_refused_at_singular_positions() {
    let half = std::f64::consts::FRAC_PI_2;
    let methods = [
        (json!("dop853"), 1e-6),
        (json!({"radau": {"stages": 3}}), 1e-5),
        (json!({"radau": {"stages": 2}}), 1e-4),
        (json!({"bdf": {"order": 2}}), 3e-2),
        (json!({"generalised_alpha": {"radius": 0.8}}), 3e-2),
    ];
    let (mut accurate, mut refused) = (0, 0);
    for (method, most) in &methods {
        for d in distances(5).chain([0.0]) {
            for steps in [30, 200] {
                let more = json!({"method": method, "steps": steps});
                match error_of_turning(1.0, half + d, &more) {
                    Ok(error) => {
                        assert!(error < *most, "{method}, {steps} steps, {d:e}: {error:e}");
                        accurate += 1;
                    }
                    Err(_) => refused += 1,
                }
            }
        }
    }
    assert!(accurate >= 30 && refused >= 10, "{accurate}, {refused}");
}

/// Derivatives of a run that ends in a singular position are those of its values and those of the
/// exact motion.
#[test]
fn derivatives_reach_over_singular_positions() {
    let half = std::f64::consts::FRAC_PI_2;
    let at_the_end = |d: f64, only_the_end: bool| {
        let mut file = turning_parallelogram(1.0, &json!({"duration": half + d}));
        if only_the_end {
            let functions = file["functions"].as_object_mut().expect("functions");
            functions.retain(|name, _| name == "acceleration");
        }
        problem(&file)
    };
    for (d, only_the_end) in [(0.0, false), (1e-6, false), (-1e-3, false), (0.0, true)] {
        let problem = at_the_end(d, only_the_end);
        for derivative in check(&problem, &problem.start()).expect("runs") {
            let apart = (derivative.adjoint - derivative.complex_step).abs();
            assert!(apart <= 2e-9, "{d:e}: {derivative:?}");
        }
    }
}

/// Rows of four-bars pass their singular positions with any tolerance, and the error follows it
/// down to round-off.
#[test]
fn every_tolerance_passes_singular_positions() {
    for (n, steps, exact) in [
        (1, 25, [0.478_385_057_8, 0.878_150_178_8]),
        (2, 37, [0.328_458_111_5, 0.944_518_538_2]),
        (10, 7, [0.204_353_561, 0.978_897_145_8]),
    ] {
        let path = Path::new(env!("CARGO_MANIFEST_DIR"));
        let path = path.join(format!("problems/benchmarks/four_bars_{n}.json"));
        for k in 0..steps {
            let tolerance = 10.0_f64.powf(-4.0 - 9.0 * f64::from(k) / f64::from(steps - 1));
            let change = format!("/simulation/tolerance={tolerance:e}");
            let change = Override::parse(&change).expect("an override");
            let problem = Problem::load(&path, &[change]).expect("no faults");
            let run = simulate(&problem, &[]).unwrap_or_else(|e| panic!("{n}, {tolerance:e}: {e}"));
            for (f, exact) in exact.iter().enumerate() {
                let error = (run.at.function(f).value - exact).abs();
                assert!(
                    error <= 500.0 * tolerance + 5e-9,
                    "{n}, {tolerance:e}: {error:e}"
                );
            }
        }
    }
}

/// The problem with its bodies, joints and the two bodies of some joints in another order. Its
/// functions are the final positions of all centres of mass.
fn permuted(file: &Value, numbers: &mut Numbers, settings: &Value) -> Value {
    fn shuffle(object: &mut Value, numbers: &mut Numbers) {
        let map = object.as_object_mut().expect("an object");
        let mut entries: Vec<(String, Value)> = std::mem::take(map).into_iter().collect();
        for last in (1..entries.len()).rev() {
            let other = ((0.5 * numbers.next() + 0.5) * (last + 1) as f64) as usize;
            entries.swap(last, other.min(last));
        }
        map.extend(entries);
    }
    let mut file = final_positions(file, settings.clone());
    shuffle(&mut file["bodies"], numbers);
    shuffle(&mut file["joints"], numbers);
    for joint in file["joints"].as_object_mut().expect("joints").values_mut() {
        let kind = joint.as_object_mut().expect("a joint").values_mut().next();
        let kind = kind.expect("a kind");
        if numbers.next() > 0.0 {
            kind["between"]
                .as_array_mut()
                .expect("two bodies")
                .swap(0, 1);
            if let Some(pair) = kind["at"].as_object_mut() {
                let (a, b) = (pair["a"].clone(), pair["b"].clone());
                (pair["a"], pair["b"]) = (b, a);
            }
        }
    }
    file
}

/// Final positions of the bodies, and the largest gap of their joints.
fn ends(file: &Value) -> (Vec<(String, f64)>, f64) {
    let problem = problem(file);
    let done = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let names = problem.function_names.iter().cloned().enumerate();
    let ends = names.map(|(f, name)| (name, done.at.function(f).value));
    (ends.collect(), done.constraint_drift().0)
}

/// Forty orders of bodies, joints and their two bodies of each benchmark with loops: equal motions,
/// within the tolerance.
#[test]
fn the_order_of_a_file_does_not_matter() {
    let dop853 = |duration: f64, tolerance: f64| json!({"duration": duration, "tolerance": tolerance, "method": "dop853"});
    let radau = json!({"duration": 0.05, "tolerance": 1e-8, "method": {"radau": {"stages": 3}}});
    for (name, settings, bound) in [
        ("bricard", dop853(2.0, 1e-10), 1e-8),
        (
            "bricard",
            json!({"duration": 1, "tolerance": 1e-7, "method": {"radau": {"stages": 3}}}),
            1e-5,
        ),
        ("andrews_squeezer", dop853(0.01, 1e-10), 1e-9),
        ("balanced_slider_crank", dop853(0.2, 1e-9), 1e-8),
        ("four_bars_1", dop853(0.5, 1e-9), 1e-8),
        ("four_bars_2", dop853(0.5, 1e-9), 1e-8),
        ("four_bars_10", dop853(0.1, 1e-9), 1e-8),
        ("flyball_governor", radau, 1e-7),
    ] {
        let file = benchmark(name);
        let mut numbers = Numbers(5);
        let (first, _) = ends(&permuted(&file, &mut numbers, &settings));
        let runs = if settings["method"] == "dop853" {
            40
        } else {
            10
        };
        for run in 1..runs {
            let other = permuted(&file, &mut numbers, &settings);
            let (found, open) = ends(&other);
            // Samples lie inside the steps.
            assert!(open <= bound, "{name}, {run}: {open:e}");
            for ((of, a), (_, b)) in first.iter().zip(&found) {
                assert!(
                    (a - b).abs() <= bound,
                    "{name}, {run}, {of}: {a} and {b}\n{other}"
                );
            }
        }
    }
}

/// P3 of Bricard's mechanism after 10 s (independent integration in minimal coordinates), in forty
/// orders of its file.
#[test]
fn bricards_mechanism_in_any_order() {
    let settings = json!({"duration": 10, "tolerance": 1e-10, "method": "dop853"});
    let file = benchmark("bricard");
    let mut numbers = Numbers(17);
    let exact = [0.9999999638, -1.0002690127, 0.9997309511];
    for run in 0..40 {
        let mut other = permuted(&file, &mut numbers, &settings);
        let function = |direction: [f64; 3]| json!({"final": {"position": {"body": "rod 3", "point": "to", "direction": direction}}});
        other["functions"] = json!({
            "x": function([1.0, 0.0, 0.0]), "y": function([0.0, 1.0, 0.0]),
            "z": function([0.0, 0.0, 1.0]),
        });
        for ((name, found), exact) in ends(&other).0.iter().zip(exact) {
            assert!(
                (found - exact).abs() <= 1e-8,
                "{run}, {name}: {found} for {exact}\n{other}"
            );
        }
    }
}

/// Derivatives over motions in which redundant rows are exchanged, by explicit and implicit steps,
/// in three orders of the file.
#[test]
fn derivatives_are_exact_where_rows_are_exchanged() {
    let file = benchmark("bricard");
    for (method, steps, bound) in [
        (json!("dop853"), json!({"tolerance": 1e-8}), 1e-12),
        (json!({"radau": {"stages": 3}}), json!({"steps": 60}), 1e-11),
        (json!({"bdf": {"order": 2}}), json!({"steps": 100}), 1e-11),
    ] {
        let mut numbers = Numbers(23);
        let mut exchanged = 0;
        for run in 0..3 {
            let mut settings = json!({"duration": 1.5, "method": method.clone()});
            let more = steps.as_object().expect("an object").clone();
            settings.as_object_mut().expect("an object").extend(more);
            let mut other = permuted(&file, &mut numbers, &settings);
            other["variables"] = json!({
                "mass": {"path": "/bodies/rod 3/mass", "lower": 0.1},
                "width": {"path": "/bodies/rod 1/shape/box/size/1", "lower": 0.01},
            });
            let problem = problem(&other);
            let done = simulate(&problem, &problem.start()).expect("runs");
            exchanged += done.at.run.grid.choices().len().saturating_sub(1);
            for derivative in check(&problem, &problem.start()).expect("runs") {
                let none = derivative.is_round_off() || derivative.differs_by_round_off();
                let exact = none || derivative.relative_difference() <= bound;
                assert!(exact, "{method}, {run}: {derivative:?}");
            }
        }
        assert!(exchanged > 0, "{method}: no row was exchanged");
    }
}
