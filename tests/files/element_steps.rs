//! Steps by tolerance of bodies of elements: the error follows the tolerance, and the mesh does not set the steps.

use crate::reference::documents::plates;
use crate::reference::documents::problem as parsed;
use flexbody_driver::simulate;

/// Place of the tip \[m\] and number of steps of the double plate of 5 mm by Radau IIA with a tolerance.
fn tip(elements: [usize; 2], tolerance: f64) -> ([f64; 2], usize) {
    let method = json!({"radau": {"stages": 3}});
    let mut document = plates(elements, 0.05, 1, &method);
    document["simulation"] = json!({"duration": 0.05, "tolerance": tolerance, "method": method});
    let problem = parsed(&document);
    let found = simulate(&problem, &problem.start()).unwrap_or_else(|failure| panic!("{failure}"));
    let value = |name: &str| {
        let index = problem.function_names.iter().position(|own| own == name);
        found.at.function(index.expect("a function")).value
    };
    (
        [value("tip x"), value("tip y")],
        found.motion().grid.steps(),
    )
}

/// The error is far below the tolerance, that of the reference.
#[test]
fn the_error_follows_the_tolerance() {
    let (exact, _) = tip([2, 1], 1e-6);
    let mut before = usize::MAX;
    for tolerance in [1e-5, 1e-4, 1e-3] {
        let (found, steps) = tip([2, 1], tolerance);
        let error = (found[0] - exact[0]).hypot(found[1] - exact[1]);
        assert!(error < tolerance, "{tolerance:e}: {error:e} m");
        assert!(steps < before);
        before = steps;
    }
}

/// 69, 129 and 219 coordinates a plate. The highest frequencies of a mesh grow at least as 1/h (stretch; bending as 1/h²),
/// so that of 4 × 2 elements are at least twice those of 2 × 1: steps that the mesh set would double. With 8 × 2 elements, 419
/// coordinates, there are no more steps than with 4 × 2.
#[test]
fn the_mesh_does_not_set_the_steps() {
    let counts = [[2, 1], [4, 1], [4, 2]].map(|elements| tip(elements, 1e-4).1);
    let most = counts.iter().max().expect("some");
    let least = counts.iter().min().expect("some");
    assert!(*most < 2 * least, "{counts:?}");
}
