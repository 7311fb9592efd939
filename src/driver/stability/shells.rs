//! Cases of shells.

use super::case::{Case, Judge, SceneFile, Steps, Way, decade, each, order_two};
use super::elastic::{Elastic, cover, force, force_of, inward_young, moment, sideways, squeeze};
use super::exact::Exact;
use super::flexible::{falling, swinging};
use super::scenes::{
    CANTILEVER_PLATE, COVERED_PLATE, FALLING_PLATES_10, FALLING_PLATES_100, FALLING_PLATES_1000,
    INWARD_PLATE, SWINGING_PLATE, TUMBLING_PLATE, TURNING_PLATE,
};
use crate::integrate::Method;

/// Error of a plate whose sections turn by 0.15 rad, above which a run warns.
const AT_TURNS: f64 = 2e-3;
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

/// The plate that is clamped at its edge, in equilibrium.
fn clamped((family, extreme): (&'static str, f64), way: Way, of: Elastic) -> Case {
    let name = (family, decade(extreme));
    let case = Case::known(name, CANTILEVER_PLATE, (way, 0.1), Exact::Elastic(of));
    case.without_energy()
}

fn thicknesses() -> Vec<Case> {
    let all = [1e-4, 1e-3, 1e-2, 0.1, 1.0];
    each(&all, &implicit(10), |thickness, way| {
        clamped(("thickness", thickness), way, Elastic::Plate { thickness })
            .set("/bodies/plate/elements/structure/thickness", thickness)
            .set("/loads/push/force/magnitude", force(thickness))
            // The error of the mesh.
            .within(1e-3)
    })
}

fn loads() -> Vec<Case> {
    let all = [1e-3, 1e-2, 0.1, 0.3, 1.0, 10.0, 1e3, 1e6, 1e9];
    each(&all, &some(10), |load, way| {
        clamped(("load", load), way, Elastic::Elastica { load })
            .set("/loads/push/force/magnitude", force_of(load))
            .within(AT_TURNS)
    })
}

fn bends() -> Vec<Case> {
    let all = [1e-3, 1e-2, 0.1, 0.15, 0.3, 1.0, 3.0, 6.0, 10.0, 100.0];
    each(&all, &some(10), |angle, way| {
        let moment = moment(angle);
        let torque = format!(
            r#"{{"torque":{{"body":"plate","point":"end","direction":[0,-1,0],"magnitude":{moment:e}}}}}"#
        );
        clamped(("bend", angle), way, Elastic::Arc { angle })
            .set("/loads/push", torque)
            .within(AT_TURNS)
    })
}

fn covers() -> Vec<Case> {
    let all = [1e-3, 0.1, 0.3, 1.0, 3.0, 10.0, 100.0];
    each(&all, &some(10), |load, way| {
        let exact = Exact::Elastic(Elastic::Covered { load });
        Case::known(("cover", decade(load)), COVERED_PLATE, (way, 0.1), exact)
            .set("/loads/push/area/magnitude", cover(load))
            .without_energy()
            .within(AT_TURNS)
    })
}

/// The clamped plate of 1 m thickness, with a force in its plane along which the deflection is measured.
fn pushed(case: Case, direction: &str, force: impl std::fmt::Display) -> Case {
    case.set("/loads/push/force/direction", direction)
        .set("/loads/push/force/magnitude", force)
        .set(
            "/functions/deflection/final/elastic_displacement/direction",
            direction,
        )
}

fn squeezes() -> Vec<Case> {
    let all = [1e-6, 1e-3, 0.03, 0.3, 0.9, 1.1, 2.0, 10.0, 1e3];
    each(&all, &implicit(10), |strain, way| {
        let case = clamped(("squeeze", strain), way, Elastic::Squeezed { strain })
            .set("/bodies/plate/elements/structure/thickness", 1);
        // Measures of strain differ by it.
        pushed(case, "[-1, 0, 0]", squeeze(strain)).within(strain.max(1e-6))
    })
}

fn across() -> Vec<Case> {
    let all = [1e-6, 1e-3, 0.03, 0.3, 0.9, 1.1, 10.0, 1e3];
    each(&all, &some(10), |strain, way| {
        let points = r#"{"root":{"edge":"y0"},"end":{"edge":"y1"}}"#;
        let case = clamped(("across", strain), way, Elastic::Across { strain })
            .set("/bodies/plate/elements/structure/thickness", 1)
            .set("/bodies/plate/elements/frame/clamped", "y0")
            .set("/bodies/plate/elements/points", points);
        let force = format!("{:e}", 4.0 * squeeze(strain));
        pushed(case, "[0, -1, 0]", force).within(strain.max(1e-6))
    })
}

fn sides() -> Vec<Case> {
    let all = [1e-6, 1e-3, 1e-2, 0.1, 1.0, 10.0];
    each(&all, &some(10), |deflection, way| {
        let case = clamped(
            ("sideways", deflection),
            way,
            Elastic::Sideways { deflection },
        )
        .set("/bodies/plate/elements/structure/thickness", 1)
        // For shear, which is quadratic across the plate.
        .set("/bodies/plate/elements/structure/mesh/plate/elements/1", 3);
        let force = format!("{:e}", sideways(deflection));
        // The clamped edge does not warp, and slopes count by their square.
        pushed(case, "[0, 1, 0]", force).within(2e-3)
    })
}

fn stiffnesses() -> Vec<Case> {
    let decades: Vec<i32> = (6..=16).collect();
    each(&decades, &some(500), |decade_of, way| {
        let (path, soft) = ("/materials/elastic/young", Judge::SmallSteps { size: 1.0 });
        swinging(
            "shell-elasticity",
            SWINGING_PLATE,
            (path, decade_of),
            way,
            soft,
        )
    })
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

/// A plate of this modulus \[Pa\] that a drive turns for 1 s.
fn driven(name: (&'static str, f64), scene: SceneFile, way: Way, of: Elastic, young: f64) -> Case {
    let (family, extreme) = name;
    Case::known(
        (family, decade(extreme)),
        scene,
        (way, 1.0),
        Exact::Elastic(of),
    )
    .set("/materials/elastic/young", format!("{young:e}"))
    .without_energy()
}

fn spins() -> Vec<Case> {
    let all = [1e-3, 1e-2, 0.1, 0.3, 1.0, 1.3, 1.5, 1.6, 3.0, 10.0];
    each(&all, &some(200), |turn, way| {
        let (of, young) = (Elastic::Bar { turn, time: 1.0 }, 1e5 / (turn * turn));
        Case {
            slow: turn != 0.1,
            ..driven(("shell-spin", turn), TURNING_PLATE, way, of, young)
        }
    })
}

fn buckles() -> Vec<Case> {
    let all = [0.1, 0.3, 0.9, 0.99, 1.01, 1.1, 1.5, 3.0, 10.0];
    each(&all, &some(200), |turn, way| {
        let (of, young) = (Elastic::Inward { turn }, inward_young(turn));
        Case {
            // An error of the load grows as the deflection.
            bound: 1e-3 / f64::abs(1.0 - turn * turn),
            slow: turn != 0.9,
            ..driven(("shell-buckling", turn), INWARD_PLATE, way, of, young)
        }
    })
}

fn chains() -> Vec<Case> {
    let scenes = [
        (10, FALLING_PLATES_10, 10),
        (100, FALLING_PLATES_100, 10),
        (1000, FALLING_PLATES_1000, 5),
    ];
    falling("shell-chain", scenes)
}
