//! Tables of forces: of springs over their stretch x, and of dampers over its rate.
//!
//! ```text
//! F(x)   interpolation between (x_i, F_i), see [`super::table`]; straight beyond both ends
//! V(x) = ∫ F from x_r to x,   x_r the point of the least force
//! ```
//!
//! The straight lines have the quotients of the first and the last interval, and so has the curve at the ends of the table.
//! Pieces of F are polynomials of degree 5 at most, which three points of Gauss integrate exactly.

use super::table::{
    Bracket, Interpolation, Neighbours, Smoothness, around, by_points, interpolate, interval,
};
use crate::math::scalar::Dual;
use crate::math::{Scalar, parameters};

/// A force \[N\] or torque \[N m\] over a stretch \[m or rad\] or its rate \[m/s or rad/s\].
#[derive(Clone, Debug, PartialEq)]
pub struct ForceTable<S> {
    /// Interpolation between the forces.
    pub interpolation: Interpolation,
    /// x_i, increasing; at least two.
    pub places: Vec<S>,
    /// F_i; length of `places`.
    pub forces: Vec<S>,
}

parameters!(struct ForceTable { interpolation; places, forces });

/// Points of Gauss in (0, 1), and their weights.
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];

/// A part of the curve within interval k.
#[derive(Clone, Copy)]
struct Piece {
    k: usize,
    interpolation: Interpolation,
}

/// An end of an integral: the start or the end of the interval, or x.
#[derive(Clone, Copy)]
enum End {
    Start,
    Finish,
    X,
}

impl Piece {
    /// Force and slope at x from the points around the interval.
    fn at<S: Scalar>(self, places: &Neighbours<S>, forces: &Neighbours<S>, x: S) -> [S; 2] {
        let kind = (self.interpolation, Smoothness::Magnitude);
        let [force, slope, ..] = interpolate(kind, &continued(places), &continued(forces), x);
        [force, slope]
    }

    /// The integral from one end to the other.
    fn integral<S: Scalar>(
        self,
        places: &Neighbours<S>,
        forces: &Neighbours<S>,
        ends: [End; 2],
        x: S,
    ) -> S {
        let [from, to] = ends.map(|end| match end {
            End::Start => places[1].unwrap_or(x),
            End::Finish => places[2].unwrap_or(x),
            End::X => x,
        });
        let width = to - from;
        let one = |(part, weight)| self.at(places, forces, from + width * part)[0] * weight;
        width * GAUSS.into_iter().map(one).fold(S::zero(), |a, b| a + b)
    }
}

/// The points with one more on the straight line beyond each end of the table.
fn continued<S: Scalar>(list: &Neighbours<S>) -> Neighbours<S> {
    let beyond =
        |own: Option<S>, near: Option<S>, far: Option<S>| own.or_else(|| Some(near? * 2.0 - far?));
    let [before, start, end, after] = *list;
    [
        beyond(before, start, end),
        start,
        end,
        beyond(after, end, start),
    ]
}

impl<S: Scalar> ForceTable<S> {
    /// The piece of x.
    fn piece(&self, x: f64) -> Piece {
        let (k, interpolation) = match interval(&self.places, x) {
            Bracket::Before => (0, Interpolation::Linear),
            Bracket::Inside(k) => (k, self.interpolation),
            Bracket::After => (self.places.len() - 2, Interpolation::Linear),
        };
        Piece { k, interpolation }
    }

    fn around(&self, k: usize) -> [Neighbours<S>; 2] {
        [around(&self.places, k), around(&self.forces, k)]
    }

    /// The force and its slope at x.
    pub fn force(&self, x: S) -> [S; 2] {
        let piece = self.piece(x.re());
        let [places, forces] = self.around(piece.k);
        piece.at(&places, &forces, x)
    }

    /// Calls `visit` with the pieces between the point of the least force and x, and the ends of their integrals.
    fn way(&self, x: f64, mut visit: impl FnMut(Piece, [End; 2])) {
        let order = |&a: &usize, &b: &usize| {
            let size = |i: usize| self.forces[i].re().abs();
            size(a).total_cmp(&size(b))
        };
        let rest = (0..self.forces.len()).min_by(order).unwrap_or(0);
        let whole = |k: usize| Piece {
            k,
            interpolation: self.interpolation,
        };
        let last = self.piece(x);
        match interval(&self.places, x) {
            Bracket::Before => {
                (0..rest).for_each(|k| visit(whole(k), [End::Finish, End::Start]));
                visit(last, [End::Start, End::X]);
            }
            Bracket::Inside(k) if k < rest => {
                (k + 1..rest).for_each(|k| visit(whole(k), [End::Finish, End::Start]));
                visit(last, [End::Finish, End::X]);
            }
            Bracket::Inside(k) => {
                (rest..k).for_each(|k| visit(whole(k), [End::Start, End::Finish]));
                visit(last, [End::Start, End::X]);
            }
            Bracket::After => {
                let intervals = self.places.len() - 1;
                (rest..intervals).for_each(|k| visit(whole(k), [End::Start, End::Finish]));
                visit(last, [End::Finish, End::X]);
            }
        }
    }

    /// The energy V at x; its slope is the force.
    pub fn energy(&self, x: S) -> S {
        let mut sum = S::zero();
        self.way(x.re(), |piece, ends| {
            let [places, forces] = self.around(piece.k);
            sum += piece.integral(&places, &forces, ends, x);
        });
        sum
    }

    /// The largest size of the slope of a straight line between two points.
    pub fn steepest(&self) -> f64 {
        let pairs = self.places.windows(2).zip(self.forces.windows(2));
        let slopes = pairs.map(|(x, f)| ((f[1] - f[0]) / (x[1] - x[0])).re().abs());
        slopes.fold(0.0, f64::max)
    }
}

impl ForceTable<f64> {
    /// Adds the derivatives of `by_force` F(x) + `by_energy` V(x) in places and forces to `own`.
    pub fn pull_back(&self, x: f64, [by_force, by_energy]: [f64; 2], own: &mut Self) {
        let lists = (&self.places[..], &self.forces[..]);
        let now = Dual::from(x);
        if by_force != 0.0 {
            let piece = self.piece(x);
            let to = (&mut own.places[..], &mut own.forces[..]);
            by_points(piece.k, lists, to, |places, forces| {
                by_force * piece.at(places, forces, now)[0].du
            });
        }
        if by_energy != 0.0 {
            self.way(x, |piece, ends| {
                let to = (&mut own.places[..], &mut own.forces[..]);
                by_points(piece.k, lists, to, |places, forces| {
                    by_energy * piece.integral(places, forces, ends, now).du
                });
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Parameters;
    use crate::math::scalar::{COMPLEX_STEP, Complex64};

    const ALL: [Interpolation; 3] = [
        Interpolation::Linear,
        Interpolation::Monotone,
        Interpolation::Spline,
    ];

    /// A table whose least force is inside.
    fn table(interpolation: Interpolation) -> ForceTable<f64> {
        ForceTable {
            interpolation,
            places: vec![-0.4, -0.1, 0.05, 0.3, 0.7],
            forces: vec![-9.0, -2.0, 0.1, 2.5, 11.0],
        }
    }

    const PLACES: [f64; 8] = [-0.9, -0.35, -0.02, 0.049, 0.06, 0.29, 0.55, 1.3];

    #[test]
    fn meets_its_points_and_goes_on_straight() {
        for own in ALL.map(table) {
            for (&x, &f) in own.places.iter().zip(&own.forces) {
                assert!((own.force(x)[0] - f).abs() < 1e-13);
            }
            let (first, last) = (7.0 / 0.3, 8.5 / 0.4);
            for (x, f, slope) in [
                (-0.9, -9.0 - 0.5 * first, first),
                (1.3, 11.0 + 0.6 * last, last),
            ] {
                let [force, own] = own.force(x);
                assert!((force - f).abs() < 1e-12 && (own - slope).abs() < 1e-12);
            }
            // The slope is continuous there, but for straight lines everywhere.
            for (end, slope) in [(-0.4, first), (0.7, last)] {
                for side in [-1e-9, 1e-9] {
                    assert!((own.force(end + side)[1] - slope).abs() < 1e-5);
                }
            }
        }
    }

    /// On values of a parabola a spline is the parabola, away from the ends.
    #[test]
    fn a_spline_of_a_parabola_has_its_energy() {
        let places: Vec<f64> = (0..9).map(|i| 0.1 * f64::from(i) - 0.3).collect();
        let own = ForceTable {
            interpolation: Interpolation::Spline,
            forces: places.iter().map(|x| 2.0 * x + 5.0 * x * x).collect(),
            places,
        };
        for x in [-0.15_f64, 0.07, 0.26] {
            let energy = x * x + 5.0 / 3.0 * x.powi(3);
            assert!((own.energy(x) - energy).abs() < 1e-14, "{x}");
        }
    }

    #[test]
    fn the_force_is_the_slope_of_the_energy_and_has_its_slope() {
        for own in ALL.map(table) {
            let complex = own.map(&mut Complex64::from);
            for x in PLACES {
                let moved = Complex64::new(x, COMPLEX_STEP);
                let [force, slope] = own.force(x);
                let by_x = complex.force(moved)[0].im / COMPLEX_STEP;
                let of_energy = complex.energy(moved).im / COMPLEX_STEP;
                assert!((by_x - slope).abs() <= 1e-12 * slope.abs());
                assert!(
                    (of_energy - force).abs() <= 1e-12 * (force.abs() + 1.0),
                    "{x}"
                );
            }
        }
    }

    #[test]
    fn derivatives_in_the_points_match_the_complex_step() {
        for own in ALL.map(table) {
            for x in PLACES {
                let mut by = own.map(&mut |_| 0.0);
                own.pull_back(x, [0.7, -1.3], &mut by);
                let given: Vec<f64> = by.places.iter().chain(&by.forces).copied().collect();
                let size = given.iter().fold(0.0_f64, |a, b| a.max(b.abs()));
                for (j, given) in given.iter().enumerate() {
                    let mut at = 0;
                    let moved = own.map(&mut |x| {
                        at += 1;
                        Complex64::new(x, if at == j + 1 { COMPLEX_STEP } else { 0.0 })
                    });
                    let x = Complex64::from(x);
                    let sum = moved.force(x)[0] * 0.7 - moved.energy(x) * 1.3;
                    let exact = sum.im / COMPLEX_STEP;
                    assert!((exact - given).abs() <= 1e-12 * size, "{own:?} {x:?} {j}");
                }
            }
        }
    }
}
