//! Cases of beams.

use super::case::{Case, Judge, Steps, TOLERANCE, Way, decade, order_two, usual};
use super::elastic::Elastic;
use super::exact::Exact;
use super::scenes::{
    FALLING_CHAIN_10, FALLING_CHAIN_100, FALLING_CHAIN_1000, FLEXIBLE_PENDULUM, TURNING_BAR,
};
use crate::integrate::Method;

/// Height of the section of the pendulum \[m\].
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
    let mut all = Vec::new();
    for decade_of in 6..=16 {
        let young = 10.0_f64.powi(decade_of);
        for way in three(2000) {
            // As stiff as a rigid rod, to 1/E.
            let rigid = Exact::Pendulum {
                radius: HEIGHT / 3.0_f64.sqrt(),
                start: 1.0,
                spin: 0.0,
                time: 1.0,
            };
            let judge = match decade_of {
                ..=7 => Judge::OtherMethod { kept: 1, size: 1.0 },
                // Stiff for an explicit method.
                8 => Judge::SmallSteps { size: 1.0 },
                _ => rigid.into(),
            };
            let name = ("elasticity", decade(young));
            let case = Case::known(name, FLEXIBLE_PENDULUM, (way, 1.0), judge);
            let bound = case.bound;
            let case = case.set("/bodies/rod/beam/material/young", format!("{young:e}"));
            all.push(Case {
                bound: match young < 1e9 {
                    true => bound,
                    false => bound.max(1e6 / young),
                },
                conservative: true,
                slow: young != 1e12,
                ..case
            });
        }
    }
    all
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
    let mut all = Vec::new();
    for turn in [1e-3, 1e-2, 0.1, 0.3, 1.0, 1.3, 1.5, 1.6, 3.0] {
        for way in three(1000) {
            let exact = Exact::Elastic(Elastic::Bar { turn, time: 1.0 });
            let name = ("spin", decade(turn));
            let case = Case::known(name, TURNING_BAR, (way, 1.0), exact);
            let young = 1e5 / (turn * turn);
            all.push(case.set("/bodies/bar/beam/material/young", young));
        }
    }
    all
}

fn chains() -> Vec<Case> {
    let mut all = Vec::new();
    let [bdf, alpha] = order_two();
    let methods = [bdf, alpha, Method::Radau { stages: 3 }];
    for (beams, scene, methods) in [
        (10, FALLING_CHAIN_10, &methods[..]),
        (100, FALLING_CHAIN_100, &methods),
        (1000, FALLING_CHAIN_1000, &methods[..1]),
    ] {
        for &method in methods {
            let way = Way {
                method: Some(method),
                steps: Steps::Equal(10),
            };
            let exact = Exact::Elastic(Elastic::Chain {
                bodies: beams,
                time: 0.1,
            });
            let name = ("chain", format!("{beams}"));
            all.push(Case {
                slow: beams > 10,
                ..Case::known(name, scene, (way, 0.1), exact)
            });
        }
    }
    all
}
