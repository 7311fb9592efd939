//! Curved rows and valleys: the steps are short, but all methods arrive.

use flexbody_optimiser::{
    Functions, Jacobian, Method, Nlp, Options, Outcome, Silent, Status, solve,
};

use crate::problems::hard;
use crate::problems::sized_truss::trusses;

fn run(nlp: &mut dyn Nlp, method: Method) -> Outcome {
    let options = Options {
        method,
        ..Options::default()
    };
    solve(nlp, &options, &mut Silent)
}

/// Far from the optimum four curved rows need penalties a hundred times their multipliers there. Were these kept,
/// the trust region would follow the rows so closely that it ends at the limit of iterations.
#[test]
fn a_swing_up_by_many_nodes_is_found() {
    for (method, most) in [
        (Method::InteriorPoint, 120),
        (Method::TrustRegion, 450),
        (Method::Auto, 120),
    ] {
        let mut problem = hard::cart_pole();
        let best = problem.best;
        let outcome = run(&mut problem, method);
        let context = format!("{method:?}: {:?} {:?}", outcome.status, outcome.counts);
        assert!(outcome.converged(), "{context}");
        assert!((outcome.objective / best - 1.0).abs() <= 1e-6, "{context}");
        assert!(outcome.counts.evaluations <= most, "{context}");
    }
}

/// w (y − x²)² + (1 − x)²: the number of steps grows with the root of the root of w at least.
#[test]
fn stiff_valleys_are_followed_to_their_end() {
    for (w, most) in [(1e2, 80), (1e4, 300), (1e5, 600)] {
        let mut valley = Functions::new(&[-1.2, 1.0], |x| {
            let (a, b) = (x[1] - x[0] * x[0], 1.0 - x[0]);
            let slopes = vec![-4.0 * w * a * x[0] - 2.0 * b, 2.0 * w * a];
            (w * a * a + b * b, slopes)
        });
        let outcome = run(&mut valley, Method::InteriorPoint);
        let context = format!("{w:e}: {:?} {:?}", outcome.status, outcome.counts);
        assert!(
            outcome.converged() && outcome.objective <= 1e-9,
            "{context}"
        );
        assert!(outcome.counts.evaluations <= most, "{context}");
    }
}

/// Minimise −x on the parabola y = x².
#[test]
fn a_fall_along_a_parabola_is_no_convergence() {
    for method in [Method::InteriorPoint, Method::TrustRegion, Method::Auto] {
        let mut nlp =
            Functions::new(&[1.0, 1.0], |x| (-x[0], vec![-1.0, 0.0])).rows(&[0.0], &[0.0], |x| {
                let slopes = Jacobian::dense(1, 2, vec![-2.0 * x[0], 1.0]);
                (vec![x[1] - x[0] * x[0]], slopes)
            });
        let outcome = run(&mut nlp, method);
        let context = format!("{method:?}: {:?} {:?}", outcome.status, outcome.counts);
        assert_eq!(outcome.status, Status::Unbounded, "{context}");
        assert!(outcome.counts.evaluations <= 600, "{context}");
    }
}

/// The work of the trust region beside the simulations of 200 bars is that of its quadratic programs.
#[test]
fn the_trust_region_sizes_200_bars_with_few_quadratic_programs() {
    let mut truss = trusses().pop().expect("a list of trusses");
    assert!(truss.name.contains("200"), "{}", truss.name);
    let outcome = run(&mut truss, Method::TrustRegion);
    let context = format!("{:?} {:?}", outcome.status, outcome.counts);
    assert!(outcome.converged(), "{context}");
    assert!(outcome.counts.evaluations <= 60, "{context}");
    assert!(outcome.counts.quadratic_programs <= 200, "{context}");
}
