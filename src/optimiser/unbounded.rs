//! Objectives that fall without bound: how a run that went very far shows it.

use nalgebra::DVector;

use crate::constants::{FAR, MOST_STEPS};
use crate::linear::jacobian::Jacobian;
use crate::linear::kkt_sparse::SparseKkt;
use crate::program::{EarlyExit, Point, Program};

impl Program<'_> {
    /// Whether the objective has fallen from the first point to a feasible one by more than any number
    /// that makes sense. A run that goes far is judged sooner ([`Program::falls_on`]).
    pub(crate) fn is_unbounded(&self, point: &Point) -> bool {
        let Some((_, f)) = &self.first else {
            return false;
        };
        let fall = point.f / self.scaling.objective - f;
        fall < self.options.unbounded_below * f.abs().max(1.0) && self.is_feasible(&point.c)
    }

    /// Whether a point of the run that satisfies the rows is so far from the first one that its way should be
    /// followed ([`Program::falls_on`]): again at each multiple `FAR` of the distance.
    pub(crate) fn goes_far(&mut self, point: &Point) -> bool {
        let Some((first, _)) = &self.first else {
            return false;
        };
        let distance = (&point.x - first).amax() / first.amax().max(1.0);
        let goes = distance > FAR * self.followed && self.holds_relatively(point);
        if goes {
            self.followed = distance;
        }
        goes
    }

    /// Whether the objective falls on along points that satisfy the rows, each up to ten times and at least
    /// twice as far from the first point as the last one, until the first distance is lost in
    /// rounding: each time by at least half of the first fall.
    pub(crate) fn falls_on(&mut self, point: &Point) -> Result<bool, EarlyExit> {
        match self.follow(point) {
            Err(EarlyExit::Failed(_)) => Ok(false),
            ending => ending,
        }
    }

    fn follow(&mut self, point: &Point) -> Result<bool, EarlyExit> {
        let Some((first, _)) = self.first.clone() else {
            return Ok(false);
        };
        let distance = |p: &Point| (&p.x - &first).amax();
        let near = FAR * first.amax().max(1.0);
        let mut last = point.clone();
        let mut least = None;
        while distance(&last) * f64::EPSILON < distance(point) {
            let mut way = &last.x - &first;
            // Only the variables that went far go on.
            way.iter_mut()
                .filter(|v| v.abs() <= near)
                .for_each(|v| *v = 0.0);
            let ahead = self.evaluate(&self.within_bounds(&last.x + way * 9.0))?;
            let next = self.restored(ahead, &last.x.map(f64::abs))?;
            let fall = last.f - next.f;
            let unit = last.f.abs().max(self.scaling.objective);
            let least = *least.get_or_insert((0.5 * fall).max(self.options.tolerance * unit));
            let goes_on = fall >= least && distance(&next) >= 2.0 * distance(&last);
            if !goes_on || !self.holds_relatively(&next) {
                return Ok(false);
            }
            last = next;
        }
        Ok(true)
    }

    /// A point that satisfies the rows, by steps of Newton that are shortest where each variable is measured
    /// by its `size`: far out these differ by many orders. The last point if there is none.
    fn restored(&mut self, mut point: Point, size: &DVector<f64>) -> Result<Point, EarlyExit> {
        for _ in 0..MOST_STEPS {
            let mut slopes = self.gradients(&point.x)?;
            if self.holds_relatively(&point) {
                break;
            }
            slopes.a.scale_columns(size);
            let c = &point.c;
            let rest = DVector::from_fn(c.len(), |k, _| {
                (self.row_lower[k] - c[k]).max(0.0) - (c[k] - self.row_upper[k]).max(0.0)
            });
            let violated: Vec<usize> = (0..c.len()).filter(|&k| rest[k] != 0.0).collect();
            let rows = violated.iter().map(|&k| slopes.a.row(k).collect());
            let a = Jacobian::from_rows(size.len(), rows);
            let rest = DVector::from_iterator(violated.len(), violated.iter().map(|&k| rest[k]));
            let ones = DVector::from_element(size.len(), 1.0);
            let none = DVector::zeros(violated.len());
            let Some(system) = SparseKkt::factor(&ones, None, &a, &none, None) else {
                break;
            };
            let step = system.solve(&DVector::zeros(size.len()), &rest).0;
            point = self.evaluate(&self.within_bounds(&point.x + step.component_mul(size)))?;
        }
        Ok(point)
    }

    /// Whether every row holds to the tolerance relative to Σ |∂c/∂x_i x_i| at the newest derivatives: what
    /// rounding leaves of a large row exceeds what a solution may violate.
    fn holds_relatively(&self, point: &Point) -> bool {
        (0..point.c.len()).all(|k| {
            let j = self.rows[k];
            let violation = self.row_violation(&point.c, k) / self.scaling.constraints[j];
            violation <= self.options.constraint_tolerance * self.row_changes[j].max(1.0)
        })
    }
}
