//! The cases of the stability suite.

use super::case::{Case, Judge, Steps, TOLERANCE, Way, decade, equal, usual};
use super::exact::Exact;
use super::flexible;
use super::loops;
use super::scenes::{
    AGGREGATE, DOOR, DOUBLE_PENDULUM, DUMBBELL, INFEASIBLE, LOCKING, OPEN_JOINT, OSCILLATOR,
    PENDULUM, SPRING_PENDULUM, TOP, UNBOUNDED, WHEEL,
};
use super::shells;
use crate::integrate::Method;
use std::f64::consts::{FRAC_PI_2, TAU};

/// All cases in the order of the table.
pub(super) fn all() -> Vec<Case> {
    let families = [
        mass_ratios(),
        stiffness(),
        damping(),
        step_sizes(),
        many_steps(),
        turns(),
        hinge_distances(),
        no_inertia(),
        open_starts(),
        lengths(),
        aggregates(),
        speeds(),
        locking(),
        optima(),
        loops::passages(),
        loops::tolerances(),
        loops::orders(),
        loops::rotations(),
        loops::units(),
        flexible::all(),
        shells::all(),
    ];
    families.concat()
}

fn mass_ratios() -> Vec<Case> {
    let mut all = Vec::new();
    for ratio in [1e-8, 1e-4, 1.0, 1e4, 1e8] {
        for way in usual(TOLERANCE, 4000) {
            let exact = Exact::DoublePendulum {
                masses: [1.0, ratio],
                length: 1.0,
                time: 2.0,
            };
            let name = ("mass-ratio", decade(ratio));
            let case = Case::known(name, DOUBLE_PENDULUM, (way, 2.0), exact);
            all.push(case.set("/bodies/lower/mass", ratio));
        }
    }
    all
}

fn stiffness() -> Vec<Case> {
    let step = 1e-3;
    let mut all = Vec::new();
    for decade_of in -2..=6 {
        let z = 10.0_f64.powi(decade_of);
        let omega = z / step;
        let chosen = Way {
            method: None,
            steps: Steps::Tolerance(TOLERANCE),
        };
        for way in std::iter::once(chosen).chain(equal(1000)) {
            let exact = Exact::SpringPendulum { omega, time: 1.0 };
            let name = ("stiffness", decade(z));
            let case = Case::known(name, SPRING_PENDULUM, (way, 1.0), exact);
            let stiffness = format!("{:e}", omega * omega);
            all.push(Case {
                slow: z > 1e3,
                ..case.set("/loads/spring/spring/stiffness", stiffness)
            });
        }
    }
    all
}

fn damping() -> Vec<Case> {
    let mut all = Vec::new();
    for ratio in [0.0, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4] {
        let explicit = Way {
            method: Some(Method::Dop853),
            steps: Steps::Tolerance(TOLERANCE),
        };
        for way in std::iter::once(explicit).chain(usual(TOLERANCE, 2000)) {
            let exact = Exact::Oscillator { ratio, time: 1.0 };
            let name = ("damping", decade(ratio));
            let case = Case::known(name, OSCILLATOR, (way, 1.0), exact);
            all.push(Case {
                conservative: ratio == 0.0,
                ..case.set("/loads/spring/spring/damping", 20.0 * ratio)
            });
        }
    }
    all
}

fn step_sizes() -> Vec<Case> {
    let mut all = Vec::new();
    for (size, steps) in [
        ("1", 2),
        ("0.1", 20),
        ("1e-2", 200),
        ("1e-3", 2000),
        ("1e-4", 20_000),
        ("1e-5", 200_000),
    ] {
        for way in equal(steps) {
            let exact = Exact::DoublePendulum {
                masses: [1.0, 1.0],
                length: 1.0,
                time: 2.0,
            };
            let name = ("step-size", size.into());
            all.push(Case {
                slow: steps > 2000,
                ..Case::known(name, DOUBLE_PENDULUM, (way, 2.0), exact)
            });
        }
    }
    all
}

fn many_steps() -> Vec<Case> {
    let steps = 1_000_000;
    let case = |way| {
        let exact = Exact::Pendulum {
            radius: 0.0,
            start: 1.0,
            spin: 0.0,
            time: 100.0,
        };
        let name = ("many-steps", "1e6".into());
        Case {
            slow: true,
            ..Case::known(name, PENDULUM, (way, 100.0), exact)
        }
    };
    let mut ways = equal(steps);
    ways.retain(|way| way.method != Some(Method::Radau { stages: 2 }));
    ways.into_iter().map(case).collect()
}

/// The usual methods for this number of turns. With many turns Radau IIA of order 3 has a larger
/// tolerance; with still more Radau IIA is omitted.
fn ways_round(turns: f64) -> Vec<Way> {
    let mut all = usual(TOLERANCE, (50.0 * turns).max(1000.0) as usize);
    let slow = Some(Method::Radau { stages: 2 });
    all.retain(|way| turns <= 100.0 || !matches!(way.method, Some(Method::Radau { .. })));
    for way in &mut all {
        if way.method == slow && turns > 1.0 {
            way.steps = Steps::Tolerance(1e-6);
        }
    }
    all
}

fn turns() -> Vec<Case> {
    let mut all = Vec::new();
    for turns in [0.25, 0.5, 1.0, 100.0, 1e3] {
        let spin = TAU * turns;
        let name = format!("{} of a box", decade(turns));
        for way in ways_round(turns) {
            let exact = Exact::Wheel { spin, time: 1.0 };
            let case = Case::known(("turns", name.clone()), WHEEL, (way, 1.0), exact);
            let path = "/bodies/box/velocity/angular/1";
            all.push(Case {
                slow: turns > 100.0,
                ..case.set(path, spin)
            });
        }
    }
    for turns in [1.0, 100.0, 1e3] {
        let (spin, coning) = (3.0, TAU * turns);
        let name = format!("{} of a cylinder", decade(turns));
        for way in ways_round(turns) {
            let exact = Exact::Top {
                spin,
                coning,
                time: 1.0,
            };
            let case = Case::known(("turns", name.clone()), TOP, (way, 1.0), exact);
            let path = "/bodies/top/velocity/angular/1";
            all.push(Case {
                slow: turns > 100.0,
                ..case.set(path, coning)
            });
        }
    }
    all
}

fn hinge_distances() -> Vec<Case> {
    let mut all = Vec::new();
    for distance in [1.0, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-12] {
        for way in usual(TOLERANCE, 1000) {
            let exact = Exact::Door { time: 1.0 };
            let name = ("hinge-distance", decade(distance));
            let case = Case::known(name, DOOR, (way, 1.0), exact);
            all.push(Case {
                slow: (1e-8..1e-5).contains(&distance),
                ..case.set("/bodies/door/points/second/2", 0.9 + distance)
            });
        }
    }
    all
}

fn no_inertia() -> Vec<Case> {
    let ball = r#"{"spherical":{"between":["rod","ground"],"at":"rod.near"}}"#;
    let along = r#"{"revolute":{"between":["rod","ground"],"at":"rod.near","axis":{"body":"rod","axis":[1,0,0]}}}"#;
    let mut all = Vec::new();
    let mut add = |name: String, radius: f64, joint: Option<&str>| {
        for way in usual(TOLERANCE, 4000) {
            let exact = Exact::Pendulum {
                radius,
                start: 1.0,
                spin: 0.0,
                time: 2.0,
            };
            let name = ("no-inertia", name.clone());
            let mut case = Case::known(name, PENDULUM, (way, 2.0), exact);
            case = case.set("/bodies/rod/shape/rod/radius", radius);
            if let Some(joint) = joint {
                case = case.set("/joints/pivot", joint);
            }
            all.push(case);
        }
    };
    add("none on a hinge".into(), 0.0, None);
    add("none on a ball joint".into(), 0.0, Some(ball));
    add("none on a hinge along itself".into(), 0.0, Some(along));
    for radius in [1e-9, 1e-6, 1e-3] {
        let name = format!("radius {radius:e} on a ball joint");
        add(name, radius, Some(ball));
    }
    all
}

fn open_starts() -> Vec<Case> {
    let mut all = Vec::new();
    for (gap, push) in [
        (1e-9, 1.0),
        (1e-3, 1.0),
        (1.0, 1.0),
        (1e3, 1.0),
        (1e6, 1.0),
        (0.0, 1e3),
    ] {
        for way in usual(TOLERANCE, 20_000) {
            // After an impulse of the hinge: ω (ℓ² + L²/12) = ℓ v, ℓ = L/2 = 1/2.
            let exact = Exact::Pendulum {
                radius: 0.0,
                start: FRAC_PI_2,
                spin: 1.5 * push,
                time: 0.5,
            };
            let name = (
                "open-start",
                format!("gap {} push {}", decade(gap), decade(push)),
            );
            let case = Case::known(name, OPEN_JOINT, (way, 0.5), exact);
            let case = case.set("/bodies/rod/place/at/0", gap);
            all.push(case.set("/bodies/rod/velocity/linear/1", push));
        }
    }
    all
}

fn lengths() -> Vec<Case> {
    let mut all = Vec::new();
    for length in [1e-6_f64, 1e-3, 1e3, 1e6] {
        for way in usual(TOLERANCE, 4000) {
            // The mass of a steel rod whose thickness is a hundredth of its length.
            let mass = 0.6 * length.powi(3);
            let time = 2.0 * length.sqrt();
            let exact = Exact::DoublePendulum {
                masses: [mass, mass],
                length,
                time,
            };
            let name = ("length", decade(length));
            let mut case = Case::known(name, DOUBLE_PENDULUM, (way, time), exact);
            for body in ["upper", "lower"] {
                case = case.set(&format!("/bodies/{body}/shape/rod/length"), length);
                case = case.set(&format!("/bodies/{body}/points/near/0"), -0.5 * length);
                case = case.set(&format!("/bodies/{body}/points/far/0"), 0.5 * length);
                case = case.set(&format!("/bodies/{body}/mass"), format!("{mass:e}"));
            }
            all.push(case);
        }
    }
    all
}

fn aggregates() -> Vec<Case> {
    let mut all = Vec::new();
    for decade_of in -3..=6 {
        let rho = 10.0_f64.powi(decade_of);
        for way in usual(TOLERANCE, 4000) {
            let name = ("rho", decade(rho));
            let exact = Exact::Aggregate { rho };
            let case = Case::known(name, AGGREGATE, (way, 1.0), exact);
            all.push(case.set("/functions/reach/ks/rho", rho));
        }
    }
    all
}

fn speeds() -> Vec<Case> {
    let mut all = Vec::new();
    for speed in [1.0, 1e3, 1e6, 1e9, 1e50] {
        for way in usual(TOLERANCE, 1000) {
            let exact = Exact::Dumbbell { speed, time: 1.0 };
            let name = ("speed", format!("{} of two cylinders", decade(speed)));
            let case = Case::known(name, DUMBBELL, (way, 1.0), exact);
            all.push(case.set("/initial_velocity/linear/1", format!("{speed:e}")));
        }
    }
    for speed in [1e3, 1e6, 1e9] {
        // Slightly more than ten turns.
        let (spin, time) = (2.0 * speed, 32.0 / speed);
        for way in usual(TOLERANCE, 4000) {
            let exact = Exact::Wheel { spin, time };
            let name = ("speed", format!("{} of the end of a box", decade(speed)));
            let case = Case::known(name, WHEEL, (way, time), exact);
            all.push(case.set("/bodies/box/velocity/angular/1", spin));
        }
    }
    all
}

fn locking() -> Vec<Case> {
    let mut all = Vec::new();
    for length in [1.0, 2.0, 2.09, 2.0999, 2.1, 2.2, 10.0] {
        for way in usual(TOLERANCE, 1000) {
            let judge = Judge::OtherMethod {
                kept: usize::MAX,
                size: 1.0,
            };
            let name = ("locking", decade(length));
            let case = Case::known(name, LOCKING, (way, 0.1), judge);
            all.push(case.set("/bodies/coupler/points/to/0", length - 0.5));
        }
    }
    all
}

fn optima() -> Vec<Case> {
    // Down to the hanging position, past couplers that cannot close the loop.
    let height = r#"{"final":{"position":{"body":"crank","point":"to","direction":[0,1,0]}}}"#;
    let lowest = [
        "/gravity=[0,0,0]".to_owned(),
        "/loads/motor/torque/magnitude=0".to_owned(),
        format!("/functions/height={height}"),
        "/objective={\"minimise\":\"height\"}".to_owned(),
    ];
    let none = Judge::Optimum {
        value: f64::NAN,
        size: 1.0,
    };
    let locked = Judge::Optimum {
        value: -0.3,
        size: 0.3,
    };
    let scenes = [
        ("unbounded", UNBOUNDED, none, Vec::new()),
        ("infeasible", INFEASIBLE, none, Vec::new()),
        ("into the lock", LOCKING, locked, lowest.to_vec()),
    ];
    let mut all = Vec::new();
    for (name, scene, judge, changes) in scenes {
        for method in ["interior_point", "trust_region", "auto"] {
            let mut changes = changes.clone();
            changes.push(format!("/optimiser/method={method}"));
            all.push(Case {
                family: "optimum",
                extreme: format!("{name} by {method}"),
                scene,
                way: None,
                duration: 0.0,
                changes,
                judge,
                length: 1.0,
                bound: 1e-6,
                conservative: false,
                slow: false,
            });
        }
    }
    all
}
