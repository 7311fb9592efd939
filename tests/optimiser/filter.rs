//! The tests that the line search puts to a point, against their definitions in Wächter & Biegler
//! (2006).

use flexbody_optimiser::{Filter, Measure};

/// Margin γ, share η of the predicted decrease, and exponents of the switching condition.
const GAMMA: f64 = 1e-5;
const ETA: f64 = 1e-4;
const POWERS: (f64, f64) = (2.3, 1.1);

/// Numbers in (0, 1) that look random.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) + 1;
    move || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn a_filter_refuses_what_any_earlier_point_dominates() {
    let (mut accepted, mut refused) = (0, 0);
    for seed in 0..200 {
        let mut next = numbers(seed);
        let largest = 0.5 + next();
        let mut filter = Filter::new(largest);
        let mut all: Vec<(f64, f64)> = Vec::new();
        for _ in 0..30 {
            let (theta, phi) = (next(), 2.0 * next() - 1.0);
            // Every entry is kept here; the filter drops those that others dominate.
            let free = theta <= largest
                && all
                    .iter()
                    .all(|&(t, p)| theta < (1.0 - GAMMA) * t || phi < p - GAMMA * t);
            assert_eq!(filter.accepts(theta, phi), free, "{all:?}: {theta}, {phi}");
            if free {
                accepted += 1;
                filter.add(theta, phi);
                all.push((theta, phi));
                assert!(!filter.accepts(theta, phi), "a point dominates itself");
            } else {
                refused += 1;
            }
        }
        filter.clear();
        assert!(
            filter.accepts(0.4, f64::MAX),
            "a cleared filter has no entries"
        );
    }
    assert!(accepted > 500 && refused > 500, "{accepted}, {refused}");
}

#[test]
fn a_cleared_filter_still_refuses_the_largest_violation() {
    let mut filter = Filter::new(50.0);
    filter.add(1.0, 0.0);
    assert!(!filter.accepts(50.0, 0.0));
    filter.clear();
    assert!(filter.accepts(50.0, 0.0));
    assert!(!filter.accepts(50.001, -1.0));
}

#[test]
fn the_objective_decides_where_the_switching_condition_holds() {
    let mut seen = [[0; 2]; 2];
    for seed in 0..2000 {
        let mut next = numbers(seed);
        let mut power = |low: f64, high: f64| 10_f64.powf(low + (high - low) * next());
        let (theta, alpha) = (power(-8.0, 0.0), power(-6.0, 0.0));
        let (slope, theta_small) = (-power(-4.0, 1.0), power(-6.0, 0.0));
        let (new, fall) = (power(-8.0, 0.0), power(-10.0, 0.0));
        let here = Measure {
            theta,
            phi: 0.0,
            slope,
            theta_small,
        };
        let switches =
            theta <= theta_small && alpha * (-slope).powf(POWERS.0) > theta.powf(POWERS.1);
        assert_eq!(here.decides_by_objective(alpha), switches, "seed {seed}");
        let accepts = if switches {
            -fall <= ETA * alpha * slope
        } else {
            new <= (1.0 - GAMMA) * theta || -fall <= -GAMMA * theta
        };
        assert_eq!(here.accepts(new, -fall, alpha), accepts, "seed {seed}");
        seen[usize::from(switches)][usize::from(accepts)] += 1;
        // The filter gets the point if and only if the objective did not decide.
        let mut filter = Filter::new(f64::INFINITY);
        filter.leave(&here, alpha);
        assert_eq!(filter.accepts(theta, 0.0), switches, "seed {seed}");
    }
    assert!(seen.iter().flatten().all(|count| *count > 20), "{seen:?}");
}
