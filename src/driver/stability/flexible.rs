//! Cases of beams.

use super::case::{Case, Judge, SceneFile, Steps, TOLERANCE, Way, decade, each, order_two, usual};
use super::elastic::Elastic;
use super::exact::Exact;
use super::scenes::{
    FALLING_CHAIN_10, FALLING_CHAIN_100, FALLING_CHAIN_1000, FLEXIBLE_PENDULUM, TURNING_BAR,
};
use crate::integrate::Method;

/// Height of the section of the pendulum, and thickness of the plate that swings \[m\].
const HEIGHT: f64 = 0.05;

/// All cases in the order of the table.
pub(super) fn all() -> Vec<Case> {
    [stiffnesses(), long_times(), spins(), chains()].concat()
}

/// The chosen method, Radau IIA of order 5 by tolerance, and BDF2 with equal steps.
fn three(steps: usize) -> Vec<Way> {
    let mut all = usual(TOLERANCE, steps);
    let [bdf, _] = order_two();
    let radau = Method::Radau { stages: 3 };
    all.retain(|way| [None, Some(radau), Some(bdf)].contains(&way.method));
    all
}

fn stiffnesses() -> Vec<Case> {
    let decades: Vec<i32> = (6..=16).collect();
    each(&decades, &three(2000), |decade_of, way| {
        let soft = match decade_of {
            ..=7 => Judge::OtherMethod { kept: 1, size: 1.0 },
            // Stiff for an explicit method.
            _ => Judge::SmallSteps { size: 1.0 },
        };
        let path = "/bodies/rod/beam/material/young";
        swinging(
            "elasticity",
            FLEXIBLE_PENDULUM,
            (path, decade_of),
            way,
            soft,
        )
    })
}

/// A body of 1 m and 50 mm that swings, whose modulus at `path` is a power of ten \[Pa\]. From 1e9 Pa on it is as stiff as
/// a rigid one, to 1/E; `soft` judges it below.
pub(super) fn swinging(
    family: &'static str,
    scene: SceneFile,
    (path, decade_of): (&str, i32),
    way: Way,
    soft: Judge,
) -> Case {
    let young = 10.0_f64.powi(decade_of);
    let rigid = Exact::Pendulum {
        radius: HEIGHT / 3.0_f64.sqrt(),
        start: 1.0,
        spin: 0.0,
        time: 1.0,
    };
    let (judge, least) = match young < 1e9 {
        true => (soft, 0.0),
        false => (rigid.into(), 1e6 / young),
    };
    let case = Case::known((family, decade(young)), scene, (way, 1.0), judge);
    let bound = case.bound.max(least);
    Case {
        bound,
        conservative: true,
        slow: young != 1e12,
        ..case.set(path, format!("{young:e}"))
    }
}

fn long_times() -> Vec<Case> {
    let mut all = Vec::new();
    for time in [1.0, 10.0] {
        let mut ways = three((1000.0 * time) as usize);
        ways.retain(|way| way.method != Some(Method::Radau { stages: 3 }));
        for way in ways {
            let judge = Judge::OtherMethod { kept: 1, size: 1.0 };
            let name = ("undamped", decade(time));
            let case = Case::known(name, FLEXIBLE_PENDULUM, (way, time), judge);
            all.push(Case {
                conservative: true,
                slow: true,
                ..case.set("/bodies/rod/beam/material/young", "1e7")
            });
        }
    }
    all
}

fn spins() -> Vec<Case> {
    let turns = [1e-3, 1e-2, 0.1, 0.3, 1.0, 1.3, 1.5, 1.6, 3.0];
    each(&turns, &three(1000), |turn, way| {
        let exact = Exact::Elastic(Elastic::Bar { turn, time: 1.0 });
        let case = Case::known(("spin", decade(turn)), TURNING_BAR, (way, 1.0), exact);
        case.set("/bodies/bar/beam/material/young", 1e5 / (turn * turn))
    })
}

fn chains() -> Vec<Case> {
    let scenes = [
        (10, FALLING_CHAIN_10, 10),
        (100, FALLING_CHAIN_100, 10),
        (1000, FALLING_CHAIN_1000, 10),
    ];
    falling("chain", scenes)
}

/// Chains of so many bodies that fall, in so many steps; of 1000 by BDF alone.
pub(super) fn falling(family: &'static str, scenes: [(usize, SceneFile, usize); 3]) -> Vec<Case> {
    let [bdf, alpha] = order_two();
    let mut all = Vec::new();
    for (bodies, scene, steps) in scenes {
        let methods = match bodies {
            1000 => vec![bdf],
            _ => vec![bdf, alpha, Method::Radau { stages: 3 }],
        };
        for method in methods {
            let way = Way {
                method: Some(method),
                steps: Steps::Equal(steps),
            };
            let exact = Exact::Elastic(Elastic::Chain { bodies, time: 0.1 });
            let name = (family, format!("{bodies}"));
            all.push(Case {
                slow: bodies > 10,
                ..Case::known(name, scene, (way, 0.1), exact)
            });
        }
    }
    all
}
