//! Cases of shells.

use super::case::{Case, Judge, Steps, Way, decade, order_two};
use super::elastic::{Elastic, cover, force, force_of, inward_young, moment, sideways, squeeze};
use super::exact::Exact;
use super::scenes::{
    CANTILEVER_PLATE, COVERED_PLATE, FALLING_PLATES_10, FALLING_PLATES_100, FALLING_PLATES_1000,
    INWARD_PLATE, SWINGING_PLATE, TUMBLING_PLATE, TURNING_PLATE,
};
use crate::integrate::Method;

/// Thickness of the plate that swings \[m\].
const HEIGHT: f64 = 0.05;
/// Radau IIA of order 3 is not among the methods of most families.
const ORDER_THREE: Method = Method::Radau { stages: 2 };

/// All cases in the order of the table.
pub(super) fn all() -> Vec<Case> {
    let families = [
        thicknesses(),
        loads(),
        bends(),
        covers(),
        squeezes(),
        across(),
        sides(),
        stiffnesses(),
        long_times(),
        spins(),
        buckles(),
        chains(),
    ];
    families.concat()
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

/// Radau IIA of order 5 and the methods of order 2 with equal steps.
fn some(steps: usize) -> Vec<Way> {
    let mut all = implicit(steps);
    all.retain(|way| way.method != Some(ORDER_THREE));
    all
}

fn thicknesses() -> Vec<Case> {
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

fn loads() -> Vec<Case> {
    let mut all = Vec::new();
    for load in [1e-3, 1e-2, 0.1, 0.3, 1.0, 10.0, 1e3, 1e6, 1e9] {
        for way in some(10) {
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

fn bends() -> Vec<Case> {
    let mut all = Vec::new();
    for angle in [1e-3, 1e-2, 0.1, 0.15, 0.3, 1.0, 3.0, 6.0, 10.0, 100.0] {
        for way in some(10) {
            let exact = Exact::Elastic(Elastic::Arc { angle });
            let name = ("bend", decade(angle));
            let moment = moment(angle);
            let torque = format!(
                r#"{{"torque":{{"body":"plate","point":"end","direction":[0,-1,0],"magnitude":{moment:e}}}}}"#
            );
            let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), exact);
            // As of the family of loads.
            all.push(Case {
                bound: 2e-3,
                conservative: false,
                ..case.set("/loads/push", torque)
            });
        }
    }
    all
}

fn covers() -> Vec<Case> {
    let mut all = Vec::new();
    for load in [1e-3, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0] {
        for way in some(10) {
            let exact = Exact::Elastic(Elastic::Covered { load });
            let name = ("cover", decade(load));
            let case = Case::known(name, COVERED_PLATE, (way, 0.1), exact);
            all.push(Case {
                bound: 2e-3,
                conservative: false,
                ..case.set("/loads/push/area/magnitude", cover(load))
            });
        }
    }
    all
}

fn squeezes() -> Vec<Case> {
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

fn across() -> Vec<Case> {
    let mut all = Vec::new();
    for strain in [1e-6, 1e-3, 0.03, 0.3, 0.9, 1.1, 10.0, 1e3] {
        for way in some(10) {
            let exact = Exact::Elastic(Elastic::Across { strain });
            let name = ("across", decade(strain));
            let points = r#"{"root":{"edge":"y0"},"end":{"edge":"y1"}}"#;
            let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), exact)
                .set("/bodies/plate/elements/structure/thickness", 1)
                .set("/bodies/plate/elements/frame/clamped", "y0")
                .set("/bodies/plate/elements/points", points)
                .set("/loads/push/force/direction", "[0, -1, 0]")
                .set(
                    "/loads/push/force/magnitude",
                    format!("{:e}", 4.0 * squeeze(strain)),
                )
                .set(
                    "/functions/deflection/final/elastic_displacement/direction",
                    "[0, -1, 0]",
                );
            all.push(Case {
                bound: strain.max(1e-6),
                conservative: false,
                ..case
            });
        }
    }
    all
}

fn sides() -> Vec<Case> {
    let mut all = Vec::new();
    for deflection in [1e-6, 1e-3, 1e-2, 0.1, 1.0, 10.0] {
        for way in some(10) {
            let exact = Exact::Elastic(Elastic::Sideways { deflection });
            let name = ("sideways", decade(deflection));
            let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), exact)
                .set("/bodies/plate/elements/structure/thickness", 1)
                // For shear, which is quadratic across the plate.
                .set("/bodies/plate/elements/structure/mesh/plate/elements/1", 3)
                .set("/loads/push/force/direction", "[0, 1, 0]")
                .set(
                    "/loads/push/force/magnitude",
                    format!("{:e}", sideways(deflection)),
                )
                .set(
                    "/functions/deflection/final/elastic_displacement/direction",
                    "[0, 1, 0]",
                );
            // The clamped edge does not warp, and slopes count by their square.
            all.push(Case {
                bound: 2e-3,
                conservative: false,
                ..case
            });
        }
    }
    all
}

fn stiffnesses() -> Vec<Case> {
    let mut all = Vec::new();
    for decade_of in 6..=16 {
        let young = 10.0_f64.powi(decade_of);
        for way in some(500) {
            // As stiff as a rigid plate, to 1/E.
            let rigid = Exact::Pendulum {
                radius: HEIGHT / 3.0_f64.sqrt(),
                start: 1.0,
                spin: 0.0,
                time: 1.0,
            };
            let soft = young < 1e9;
            let judge = match soft {
                true => Judge::SmallSteps { size: 1.0 },
                false => rigid.into(),
            };
            let name = ("shell-elasticity", decade(young));
            let case = Case::known(name, SWINGING_PLATE, (way, 1.0), judge);
            let bound = case.bound;
            all.push(Case {
                bound: match soft {
                    true => bound,
                    false => bound.max(1e6 / young),
                },
                conservative: true,
                slow: young != 1e12,
                ..case.set("/materials/elastic/young", format!("{young:e}"))
            });
        }
    }
    all
}

fn long_times() -> Vec<Case> {
    let mut all = Vec::new();
    for (time, steps) in [(1.0, 200), (10.0, 2000), (100.0, 5000)] {
        for way in implicit(steps) {
            let exact = Exact::Elastic(Elastic::Tumbling);
            let name = ("shell-undamped", decade(time));
            all.push(Case {
                slow: time > 1.0,
                ..Case::known(name, TUMBLING_PLATE, (way, time), exact)
            });
        }
    }
    all
}

fn spins() -> Vec<Case> {
    let mut all = Vec::new();
    for turn in [1e-3, 1e-2, 0.1, 0.3, 1.0, 1.3, 1.5, 1.6, 3.0, 10.0] {
        for way in some(200) {
            let exact = Exact::Elastic(Elastic::Bar { turn, time: 1.0 });
            let name = ("shell-spin", decade(turn));
            let case = Case::known(name, TURNING_PLATE, (way, 1.0), exact);
            let young = 1e5 / (turn * turn);
            all.push(Case {
                // The drive does work.
                conservative: false,
                slow: turn != 0.1,
                ..case.set("/materials/elastic/young", format!("{young:e}"))
            });
        }
    }
    all
}

fn buckles() -> Vec<Case> {
    let mut all = Vec::new();
    for turn in [0.1, 0.3, 0.9, 0.99, 1.01, 1.1, 1.5, 3.0, 10.0] {
        for way in some(200) {
            let exact = Exact::Elastic(Elastic::Inward { turn });
            let name = ("shell-buckling", decade(turn));
            let case = Case::known(name, INWARD_PLATE, (way, 1.0), exact);
            all.push(Case {
                // An error of the load grows as the deflection.
                bound: 1e-3 / f64::abs(1.0 - turn * turn),
                conservative: false,
                slow: turn != 0.9,
                ..case.set(
                    "/materials/elastic/young",
                    format!("{:e}", inward_young(turn)),
                )
            });
        }
    }
    all
}

fn chains() -> Vec<Case> {
    let mut all = Vec::new();
    let [bdf, alpha] = order_two();
    let methods = [bdf, alpha, Method::Radau { stages: 3 }];
    for (plates, scene, methods, steps) in [
        (10, FALLING_PLATES_10, &methods[..], 10),
        (100, FALLING_PLATES_100, &methods, 10),
        (1000, FALLING_PLATES_1000, &methods[..1], 5),
    ] {
        for &method in methods {
            let way = Way {
                method: Some(method),
                steps: Steps::Equal(steps),
            };
            let exact = Exact::Elastic(Elastic::Chain {
                bodies: plates,
                time: 0.1,
            });
            let name = ("shell-chain", format!("{plates}"));
            all.push(Case {
                slow: plates > 10,
                ..Case::known(name, scene, (way, 0.1), exact)
            });
        }
    }
    all
}
