//! Cases of flexible bodies.

use super::case::{Case, Judge, Steps, TOLERANCE, Way, decade, order_two, usual};
use super::elastic::{Elastic, force, force_of, squeeze};
use super::exact::Exact;
use super::scenes::{
    CANTILEVER_PLATE, FALLING_CHAIN_10, FALLING_CHAIN_100, FALLING_CHAIN_1000, FLEXIBLE_PENDULUM,
    TURNING_BAR,
};
use crate::integrate::Method;

/// Height of the section of the pendulum \[m\].
const HEIGHT: f64 = 0.05;

/// The chosen method, Radau IIA of order 5 by tolerance, and BDF2 with equal steps.
fn three(steps: usize) -> Vec<Way> {
    let mut all = usual(TOLERANCE, steps);
    let [bdf, _] = order_two();
    let radau = Method::Radau { stages: 3 };
    all.retain(|way| [None, Some(radau), Some(bdf)].contains(&way.method));
    all
}

/// Radau IIA and the methods of order 2 with equal steps.
fn implicit(steps: usize) -> Vec<Way> {
    let radau = [2, 3].map(|stages| Method::Radau { stages });
    let way = |method| Way {
        method: Some(method),
        steps: Steps::Equal(steps),
    };
    radau.into_iter().chain(order_two()).map(way).collect()
}

pub(super) fn thicknesses() -> Vec<Case> {
    let mut all = Vec::new();
    for thickness in [1e-4, 1e-3, 1e-2, 0.1, 1.0] {
        for way in implicit(10) {
            let exact = Exact::Elastic(Elastic::Plate { thickness });
            let name = ("thickness", decade(thickness));
            let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), exact)
                .set("/bodies/plate/elements/structure/thickness", thickness)
                .set("/loads/push/force/magnitude", force(thickness));
            // The error of the mesh. Nothing moves, so there is no kinetic energy to compare with.
            all.push(Case {
                bound: 1e-3,
                conservative: false,
                ..case
            });
        }
    }
    all
}

pub(super) fn loads() -> Vec<Case> {
    let mut all = Vec::new();
    for load in [1e-3, 1e-2, 0.1, 0.3, 1.0, 10.0, 1e3, 1e6, 1e9] {
        let mut ways = implicit(10);
        ways.retain(|way| way.method != Some(Method::Radau { stages: 2 }));
        for way in ways {
            let exact = Exact::Elastic(Elastic::Elastica { load });
            let name = ("load", decade(load));
            let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), exact);
            // Error at rotations of 0.15 rad, above which a run warns.
            all.push(Case {
                bound: 2e-3,
                conservative: false,
                ..case.set("/loads/push/force/magnitude", force_of(load))
            });
        }
    }
    all
}

pub(super) fn squeezes() -> Vec<Case> {
    let mut all = Vec::new();
    for strain in [1e-6, 1e-3, 0.03, 0.3, 0.9, 1.1, 2.0, 10.0, 1e3] {
        for way in implicit(10) {
            let exact = Exact::Elastic(Elastic::Squeezed { strain });
            let name = ("squeeze", decade(strain));
            let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), exact)
                .set("/bodies/plate/elements/structure/thickness", 1)
                .set("/loads/push/force/direction", "[-1, 0, 0]")
                .set("/loads/push/force/magnitude", squeeze(strain))
                .set(
                    "/functions/deflection/final/elastic_displacement/direction",
                    "[-1, 0, 0]",
                );
            // Measures of strain differ by this.
            all.push(Case {
                bound: strain.max(1e-6),
                conservative: false,
                ..case
            });
        }
    }
    all
}

pub(super) fn stiffnesses() -> Vec<Case> {
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
            let judge = match young < 1e9 {
                true => Judge::OtherMethod { kept: 1, size: 1.0 },
                false => rigid.into(),
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

pub(super) fn long_times() -> Vec<Case> {
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

pub(super) fn spins() -> Vec<Case> {
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

pub(super) fn chains() -> Vec<Case> {
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
            let exact = Exact::Elastic(Elastic::Chain { beams, time: 0.1 });
            let name = ("chain", format!("{beams}"));
            all.push(Case {
                slow: beams > 10,
                ..Case::known(name, scene, (way, 0.1), exact)
            });
        }
    }
    all
}
