//! The cases of the stress suite.

use super::case::{Case, Judge, SceneFile, Steps, Way, equal, usual};
use super::exact::Exact;
use crate::integrate::Method;
use std::f64::consts::{FRAC_PI_2, TAU};

macro_rules! scene {
    ($name:literal) => {
        SceneFile {
            name: concat!($name, ".json"),
            text: include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/problems/extreme/",
                $name,
                ".json"
            )),
        }
    };
}

const DOUBLE_PENDULUM: SceneFile = scene!("double_pendulum");
const SPRING_PENDULUM: SceneFile = scene!("spring_pendulum");
const OSCILLATOR: SceneFile = scene!("damped_oscillator");
const PENDULUM: SceneFile = scene!("pendulum");
const TOP: SceneFile = scene!("tumbling_top");
const WHEEL: SceneFile = scene!("wheel");
const AGGREGATE: SceneFile = scene!("aggregate");
const DOOR: SceneFile = scene!("door");
const DUMBBELL: SceneFile = scene!("dumbbell");
const OPEN_JOINT: SceneFile = scene!("open_joint");
const LOCKING: SceneFile = scene!("locking_linkage");
const UNBOUNDED: SceneFile = scene!("unbounded_throw");
const INFEASIBLE: SceneFile = scene!("infeasible_throw");

/// The families with what they try.
pub(super) const FAMILIES: [(&str, &str); 14] = [
    (
        "mass-ratio",
        "Two hinged rods swing for 2 s; the lower one has this many times the mass of the upper one.",
    ),
    (
        "stiffness",
        "A bob swings on a spring without damping, started without vibration; this is ω h of the \
         spring at steps of 1 ms.",
    ),
    (
        "damping",
        "A block on a spring of 10 rad/s with this damping ratio, released 0.1 m off, for 1 s.",
    ),
    (
        "step-size",
        "Two hinged rods swing for 1 s by equal steps of this size (s).",
    ),
    (
        "many-steps",
        "A rod swings for 100 s by this many equal steps.",
    ),
    (
        "turns",
        "A box turns about a horizontal axis so many times, its pitch through 90 degrees twice a \
         turn; a free cylinder cones about a horizontal axis so many times.",
    ),
    (
        "hinge-distance",
        "A door of 1 m by 2 m on two ball joints this far (m) apart, its centre far beside both.",
    ),
    (
        "no-inertia",
        "A rod without inertia about its own axis, or next to none, on a hinge or on a ball joint.",
    ),
    (
        "open-start",
        "A rod beside its hinge by this gap (m), its centre pushed across at this speed (m/s).",
    ),
    (
        "length",
        "Two hinged rods of this length (m) swing for the same number of their own periods.",
    ),
    (
        "rho",
        "The Kreisselmeier–Steinhauser function of a point that circles once, with this ρ (1/m).",
    ),
    (
        "speed",
        "Two hinged rods fly at this speed (m/s) and turn at 3 rad/s; a box whose end turns at this \
         speed.",
    ),
    (
        "locking",
        "A four-bar linkage whose coupler is at its longest 2.1 m; this is its length (m).",
    ),
    (
        "optimum",
        "Optimisations that have no optimum, or run into designs at which the mechanism locks.",
    ),
];

/// Steps by tolerance, unless said otherwise.
const TOLERANCE: f64 = 1e-9;

/// A number for the table.
fn decade(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        x if (0.1..1000.0).contains(&x) => format!("{x}"),
        x => format!("{x:e}"),
    }
}

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
    ];
    families.concat()
}

fn mass_ratios() -> Vec<Case> {
    let mut all = Vec::new();
    for ratio in [1e-8, 1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4, 1e6, 1e8] {
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
            all.push(case.set("/loads/spring/spring/stiffness", stiffness));
        }
    }
    all
}

fn damping() -> Vec<Case> {
    let mut all = Vec::new();
    for ratio in [0.0, 1e-2, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4] {
        for way in usual(TOLERANCE, 2000) {
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
        ("0.1", 10),
        ("1e-2", 100),
        ("1e-3", 1000),
        ("1e-4", 10_000),
        ("1e-5", 100_000),
        ("1e-6", 1_000_000),
    ] {
        for way in equal(steps) {
            let exact = Exact::DoublePendulum {
                masses: [1.0, 1.0],
                length: 1.0,
                time: 1.0,
            };
            let name = ("step-size", size.into());
            all.push(Case {
                slow: steps > 1000,
                ..Case::known(name, DOUBLE_PENDULUM, (way, 1.0), exact)
            });
        }
    }
    all
}

fn many_steps() -> Vec<Case> {
    let steps = 1_000_000;
    let case = |way| {
        let exact = Exact::Pendulum {
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
    equal(steps).into_iter().map(case).collect()
}

fn turns() -> Vec<Case> {
    let mut all = Vec::new();
    for turns in [0.25, 0.5, 1.0, 100.0, 1e3] {
        let spin = TAU * turns;
        let name = format!("{} of a box", decade(turns));
        for way in usual(TOLERANCE, (200.0 * turns).max(1000.0) as usize) {
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
        for way in usual(TOLERANCE, (200.0 * turns).max(1000.0) as usize) {
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
    for distance in [
        1.0, 1e-2, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-12,
    ] {
        for way in usual(TOLERANCE, 1000) {
            let exact = Exact::Door { time: 1.0 };
            let name = ("hinge-distance", decade(distance));
            let case = Case::known(name, DOOR, (way, 1.0), exact);
            all.push(case.set("/bodies/door/points/second/2", 0.9 + distance));
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
    add("none, on a hinge".into(), 0.0, None);
    add("none, on a ball joint".into(), 0.0, Some(ball));
    add("none, on a hinge along itself".into(), 0.0, Some(along));
    for radius in [1e-9, 1e-6, 1e-3] {
        let name = format!("radius {radius:e}, on a ball joint");
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
            // The nearest velocities that the hinge allows: ω (1 + ℓ²) = ℓ v, ℓ = 1/2.
            let exact = Exact::Pendulum {
                start: FRAC_PI_2,
                spin: 0.4 * push,
                time: 0.5,
            };
            let name = ("open-start", format!("{}, {}", decade(gap), decade(push)));
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
            // The mass of a rod of steel a hundredth as thick as long.
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
    for speed in [1.0, 1e3, 1e6, 1e9, 1e12, 1e50] {
        for way in usual(TOLERANCE, 1000) {
            let exact = Exact::Dumbbell { speed, time: 1.0 };
            let name = ("speed", format!("{} of two rods", decade(speed)));
            let case = Case::known(name, DUMBBELL, (way, 1.0), exact);
            all.push(case.set("/initial_velocity/linear/1", format!("{speed:e}")));
        }
    }
    for speed in [1e3, 1e6, 1e9] {
        // Ten turns and a bit.
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
            all.push(Case {
                family: "locking",
                extreme: decade(length),
                scene: LOCKING,
                way: Some(way),
                duration: 0.1,
                changes: vec![format!("/bodies/coupler/points/to/0={}", length - 0.5)],
                judge: Judge::OtherMethod,
                bound: match way.method {
                    Some(Method::Bdf { .. } | Method::GeneralisedAlpha { .. }) => 1e-3,
                    _ => 1e-6,
                },
                conservative: false,
                slow: false,
            });
        }
    }
    all
}

fn optima() -> Vec<Case> {
    let methods = ["interior_point", "trust_region", "auto"];
    let scenes = [
        ("unbounded", UNBOUNDED, f64::NAN),
        ("infeasible", INFEASIBLE, f64::NAN),
        // At its longest the coupler stands in line with crank and rocker.
        ("locks", LOCKING, 1.8),
    ];
    let mut all = Vec::new();
    for (name, scene, optimum) in scenes {
        for method in methods {
            all.push(Case {
                family: "optimum",
                extreme: format!("{name} by {method}"),
                scene,
                way: None,
                duration: 0.0,
                changes: vec![format!("/optimiser/method={method}")],
                judge: Judge::Optimum(optimum),
                bound: 1e-6,
                conservative: false,
                slow: false,
            });
        }
    }
    all
}
