//! The least compliance of a sheet by the thickness of each element: a convex program of many variables.

use super::statics::{assert_gradients, shipped, solve, solved_at};

/// Along and across.
const ELEMENTS: [usize; 2] = [20, 10];

fn coarse() -> String {
    let [along, across] = ELEMENTS;
    format!("/structures/sheet/mesh/plate/elements=[{along},{across}]")
}

#[test]
fn the_gradients_of_a_sheet_agree_with_the_complex_step() {
    let few = "/structures/sheet/mesh/plate/elements=[6,3]";
    assert_gradients("thickness_sheet", &shipped("thickness_sheet", &[few]));
}

/// Where the thickness is free, a unit of mass saves the same compliance in every element. The design is
/// as symmetric as the load.
#[test]
fn every_free_element_of_a_sheet_saves_the_same_compliance() {
    let [along, across] = ELEMENTS;
    let problem = shipped("thickness_sheet", &[&coarse()]);
    let done = solve(&problem);
    let optimum = &done.optimum;
    assert_eq!(optimum.status, "converged", "{}", optimum.message);
    assert!(optimum.counts.function_evaluations < 40);
    let design: Vec<f64> = optimum.design.values().map(|d| d.value).collect();
    let (lower, upper) = (problem.variables[0].lower, problem.variables[0].upper);
    let at = solved_at(&problem, &design);
    let (found, _) = at.derivatives(&problem, &[0, 1]).expect("derivatives");
    let saved = |e: usize| -found[1][e].value / found[0][e].value;
    let multiplier = optimum.constraints["material"].multiplier.abs();
    let room = 1e-4 * (upper - lower);
    let mut free = 0;
    for e in 0..along * across {
        let ratio = saved(e) / multiplier;
        if design[e] < lower + room {
            assert!(ratio < 1.0 + 1e-3, "element {e}: {ratio}");
        } else if design[e] > upper - room {
            assert!(ratio > 1.0 - 1e-3, "element {e}: {ratio}");
        } else {
            free += 1;
            assert!((ratio - 1.0).abs() < 1e-4, "element {e}: {ratio}");
        }
        let mirrored = e % along + along * (across - 1 - e / along);
        let difference = (design[e] - design[mirrored]).abs();
        assert!(difference < 1e-3 * upper, "element {e}: {difference:e}");
    }
    assert!(free > 50, "{free}");
}
