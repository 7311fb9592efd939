//! What the interior point does when its line search finds no step.

use nalgebra::DVector;

use crate::doubts::degenerate_row;
use crate::interior_point::iterate::Layout;
use crate::interior_point::iteration::InteriorPoint;
use crate::interior_point::line_search::{GAIN, infeasibility};
use crate::program::{EarlyExit, Point, Program};
use crate::status::Status;
use crate::trust_region::steering::{Goal, TrustRegion};

impl InteriorPoint {
    /// Handles a line search without a step: forgets the quasi-Newton matrix at a feasible point,
    /// restores feasibility at another.
    pub(crate) fn recover(
        &mut self,
        program: &mut Program<'_>,
        failures: usize,
    ) -> Result<Option<Status>, EarlyExit> {
        let theta = self.theta();
        let small = 1e-2 * program.options.tolerance.min(program.least_allowed());
        if theta <= small && failures == 1 && !self.b.is_empty() {
            self.b.reset();
            self.filter.clear();
            return Ok(None);
        }
        if theta <= small || failures > 6 {
            return Ok(Some(Status::Stalled));
        }
        self.restore(program, theta)
    }

    /// Handles short steps: forgets the matrix near feasible points, restores feasibility elsewhere.
    pub(crate) fn leave_crawl(
        &mut self,
        program: &mut Program<'_>,
    ) -> Result<Option<Status>, EarlyExit> {
        if self.short_steps == 2 {
            self.b.reset();
            self.doubt_gradients(program)?;
            let z = self.multipliers(program);
            if let Some(j) = degenerate_row(program, &self.at.point, &self.at.slopes, &z) {
                let constraint = program.constraint_name(j);
                return Ok(Some(Status::Degenerate { constraint }));
            }
        }
        let theta = self.theta();
        if self.short_steps == 4 {
            self.short_steps = 0;
            if theta > self.theta_small {
                return self.restore(program, theta);
            }
        }
        Ok(None)
    }

    /// Reduces the violation by a tenth or more, until the filter accepts the point.
    pub(crate) fn restore(
        &mut self,
        program: &mut Program<'_>,
        theta: f64,
    ) -> Result<Option<Status>, EarlyExit> {
        let phi = self.layout.barrier_function(
            self.at.point.f,
            &self.at.point.x,
            &self.at.s,
            self.barrier.mu,
        );
        self.filter.add(theta, phi);
        let (point, slopes) = (self.at.point.clone(), self.at.slopes.clone());
        let mut search = TrustRegion::new(program, point, slopes, Goal::Feasibility);
        let (layout, filter, mu) = (&self.layout, &self.filter, self.barrier.mu);
        let accepted = |_: &Program<'_>, p: &Point| {
            let s = slacks(layout, p);
            let theta_new = infeasibility(&layout.residual(&p.c, &s), &p.c);
            let phi = layout.barrier_function(p.f, &p.x, &s, mu);
            theta_new <= GAIN * theta && filter.accepts(theta_new, phi)
        };
        let ending = search.iterate(program, accepted)?;
        let before = self.theta();
        self.at.s = slacks(&self.layout, &search.point);
        self.at.point = search.point;
        self.at.slopes = search.slopes;
        let after = self.theta();
        self.at
            .keep_multipliers_in_band(&self.layout, self.barrier.mu);
        self.at.estimate_multipliers(&self.layout);
        match ending {
            Status::Converged => Ok(None),
            Status::Infeasible { .. } => Ok(Some(ending)),
            _ if after < 0.5 * before => {
                self.filter.clear();
                Ok(None)
            }
            _ => Ok(Some(ending)),
        }
    }
}

/// Slacks nearest to the values of the rows that keep a small distance from the bounds.
fn slacks(layout: &Layout, point: &Point) -> DVector<f64> {
    let inside = |(k, &j): (usize, &usize)| layout.push_inside(layout.n + k, point.c[j], 1e-6);
    let slacks = layout.slack_rows.iter().enumerate().map(inside);
    DVector::from_iterator(layout.slack_rows.len(), slacks)
}
