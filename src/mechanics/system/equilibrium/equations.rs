//! The equations of the quasi-static start, and products with their derivative.

use super::turning::Turning;
use super::{Given, Sought};
use crate::math::slices::{add_scaled, dot};
use crate::math::{Dual, Parameters, Scalar};
use crate::model::Model;
use crate::system::bodies::{self, BodyMotion};
use crate::system::flexible;
use crate::system::in_motion::InMotion;
use crate::system::joints;
use crate::system::loads;
use crate::system::numbering::Numbering;
use crate::system::placement::reach;
use crate::system::reduce;
use crate::system::redundant_rows::RedundantRows;
use std::ops::Range;

/// Part of a row that is independent of the rows before, relative to it, above which it counts.
const INDEPENDENT: f64 = 1e-8;
/// Smallest scale of a group of unknowns, relative to the largest.
const LEAST_SCALE: f64 = 1e-30;
/// Part of the size that the other groups give to a group, below which it is round-off.
const NEGLIGIBLE: f64 = 1e-6;

/// Positions; accelerations and velocities of the rigid unknowns; reactions; multipliers of placement and velocities.
#[derive(Clone, Debug)]
pub(super) struct State<S> {
    pub q: Vec<S>,
    pub a: Vec<S>,
    pub v: Vec<S>,
    pub lambda: Vec<S>,
    pub sigma: Vec<S>,
    pub tau: Vec<S>,
    /// Of rest: whether the way there led through positions that are not stable, and the rate \[1/s²\] of the placement.
    pub snapped: bool,
    pub rate: f64,
}

impl State<f64> {
    pub(super) fn map<T>(&self, of: impl Fn(f64) -> T) -> State<T> {
        let all = |x: &[f64]| x.iter().map(|&x| of(x)).collect();
        State {
            q: all(&self.q),
            a: all(&self.a),
            v: all(&self.v),
            lambda: all(&self.lambda),
            sigma: all(&self.sigma),
            tau: all(&self.tau),
            snapped: self.snapped,
            rate: self.rate,
        }
    }
}

/// The unknowns and rows. Unknowns have the order (positions, a, v, λ, σ, τ), rows as (balance,
/// placement, velocities, Φ, accelerations of constraints, rates of constraints), so that each
/// group has the length of its unknowns.
pub(super) struct Layout<'a> {
    pub numbering: &'a Numbering,
    pub left_out: &'a RedundantRows,
    /// Unknowns of velocity without the elastic coordinates.
    pub rigid: Vec<usize>,
    /// Rows of constraints that are independent while elastic coordinates are at rest.
    pub kept: Vec<usize>,
    /// Steady rotation of a machine whose rest in the turning frame is sought.
    pub turning: Option<Turning<f64>>,
    /// By body: whether its position is an angle.
    pub angles: Vec<bool>,
}

fn picked<S: Scalar>(indices: &[usize], x: &[S]) -> Vec<S> {
    indices.iter().map(|&i| x[i]).collect()
}

impl<'a> Layout<'a> {
    /// That of a model at its placement. At rest nothing moves, and positions and reactions are the only unknowns.
    pub(super) fn new(
        model: &Model<f64>,
        numbering: &'a Numbering,
        left_out: &'a RedundantRows,
        (given, sought): (&Given<f64>, Sought),
    ) -> Self {
        let mut moves = vec![sought == Sought::Start; numbering.unknowns()];
        for (carrier, k) in model.flexible.iter().flat_map(|body| body.places()) {
            moves[numbering.unknown(carrier) + k] = false;
        }
        let mut layout = Self {
            numbering,
            left_out,
            rigid: (0..moves.len()).filter(|&u| moves[u]).collect(),
            kept: Vec::new(),
            turning: given.turning.clone(),
            angles: model
                .bodies
                .iter()
                .map(|body| body.role.is_angle())
                .collect(),
        };
        layout.keep_independent(model, &given.q);
        layout
    }

    /// The groups of unknowns and of rows.
    pub(super) fn groups(&self) -> [Range<usize>; 6] {
        let (nr, nk) = (self.rigid.len(), self.kept.len());
        let lengths = [
            self.numbering.unknowns(),
            nr,
            nr,
            self.numbering.constraints(),
            nk,
            nk,
        ];
        let mut at = 0;
        lengths.map(|length| {
            at += length;
            at - length..at
        })
    }

    /// Whether all bodies are at rest.
    pub(super) fn is_rest(&self) -> bool {
        self.rigid.is_empty()
    }

    /// Number of unknowns.
    pub(super) fn order(&self) -> usize {
        self.groups()[5].end
    }

    /// The placement with its velocities.
    pub(super) fn start(&self, given: &Given<f64>) -> State<f64> {
        State {
            q: given.q.clone(),
            a: vec![0.0; self.rigid.len()],
            v: picked(&self.rigid, &self.compressed(given.v.clone())),
            lambda: vec![0.0; self.numbering.constraints()],
            sigma: vec![0.0; self.kept.len()],
            tau: vec![0.0; self.kept.len()],
            snapped: false,
            rate: 0.0,
        }
    }

    /// The size of each unknown in a change, by groups; `mass` is that of all bodies.
    ///
    /// A group may be round-off of the others, such as accelerations where the joints allow none. It counts by their
    /// sizes then: accelerations by λ / m, velocities by the root of accelerations times positions, multipliers by
    /// the mass.
    pub(super) fn scales(&self, change: &[f64], mass: f64) -> Vec<f64> {
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let floor = LEAST_SCALE * largest(change);
        let [y, a, v, lambda, sigma, tau] = self.groups().map(|group| largest(&change[group]));
        let acceleration = a.max(lambda / mass);
        let speed = v.max((acceleration * y).sqrt());
        let a = a.max(NEGLIGIBLE * acceleration);
        let v = v.max(NEGLIGIBLE * speed);
        let lambda = lambda.max(NEGLIGIBLE * mass * acceleration);
        let sigma = sigma.max(NEGLIGIBLE * mass * y);
        let tau = tau.max(NEGLIGIBLE * mass * speed);
        let mut out = vec![1.0; change.len()];
        for (group, size) in self.groups().into_iter().zip([y, a, v, lambda, sigma, tau]) {
            let size = size.max(floor);
            if size > 0.0 && size.is_finite() {
                out[group].fill(size);
            }
        }
        out
    }

    /// Change of the position of body i, of its six components of y: a rotation in radians, or a displacement relative to the
    /// length `scale`.
    pub(super) fn moved_of(&self, i: usize, six: &[f64], scale: f64) -> f64 {
        let part = |x: &[f64]| dot(x, x).sqrt();
        let of_place = if self.angles[i] { 1.0 } else { scale };
        (part(&six[..3]) / of_place).max(part(&six[3..]))
    }

    pub(super) fn compressed<S: Scalar>(&self, x: Vec<S>) -> Vec<S> {
        reduce::compressed(self.numbering, x)
    }

    pub(super) fn expanded<S: Scalar>(&self, u: Vec<S>) -> Vec<S> {
        reduce::expanded(self.numbering, u)
    }

    /// Velocities of rigid unknowns.
    pub(super) fn of_rigid<S: Scalar>(&self, values: &[S]) -> Vec<S> {
        let mut u = vec![S::zero(); self.numbering.unknowns()];
        for (&at, &x) in self.rigid.iter().zip(values) {
            u[at] = x;
        }
        self.expanded(u)
    }

    /// Rows of constraints with values of the kept ones.
    pub(super) fn of_kept<S: Scalar>(&self, values: &[S]) -> Vec<S> {
        let mut rows = vec![S::zero(); self.numbering.constraints()];
        for (&at, &x) in self.kept.iter().zip(values) {
            rows[at] = x;
        }
        rows
    }

    /// Changes a state.
    pub(super) fn advance<S: Scalar>(&self, x: &mut State<S>, change: &[S]) {
        let [y, a, v, lambda, sigma, tau] = self.groups();
        let y = self.expanded(change[y].to_vec());
        let mut increment = vec![S::zero(); x.q.len()];
        bodies::advance(self.numbering, &mut x.q, &mut increment, &y);
        let others = [
            (&mut x.a, a),
            (&mut x.v, v),
            (&mut x.lambda, lambda),
            (&mut x.sigma, sigma),
            (&mut x.tau, tau),
        ];
        for (x, group) in others {
            add_scaled(x, S::one(), &change[group]);
        }
    }

    /// The rows, with λ = 0 in place of constraints that are left out.
    pub(super) fn residual<S: Scalar>(
        &self,
        model: &Model<S>,
        given: &Given<S>,
        x: &State<S>,
    ) -> Vec<S> {
        let numbering = self.numbering;
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        let still = vec![S::zero(); nv];
        let (mut motions, mut gradients) = (Vec::new(), Vec::new());
        let [v, a] = match &given.turning {
            Some(turning) => turning.velocities(model, numbering, &x.q),
            None => [self.of_rigid(&x.v), self.of_rigid(&x.a)],
        };
        BodyMotion::all(numbering, &x.q, &v, &mut motions);
        let at = InMotion::new(model, numbering, &motions, given.time);
        joints::gradients(&at, &mut gradients);
        self.left_out.clear_gradients(&mut gradients);

        let mut balance = still.clone();
        bodies::all_force_balances(model, numbering, &motions, &a, &mut balance);
        flexible::add_force_balances(model, numbering, &motions, &a, &mut balance);
        let mut forces = still.clone();
        loads::add_forces(&at, &mut forces);
        balance.iter_mut().zip(&forces).for_each(|(b, &f)| *b -= f);
        joints::add_reactions(model, numbering, &gradients, &x.lambda, &mut balance);
        let mut out = self.compressed(balance);

        let mut metric = |by: &[S], multipliers: &[S]| {
            let mut moved = mass_product(model, numbering, &motions, by);
            let rows = self.of_kept(multipliers);
            joints::add_reactions(model, numbering, &gradients, &rows, &mut moved);
            out.extend(picked(&self.rigid, &self.compressed(moved)));
        };
        let away = self.compressed(flexible::distance(numbering, &x.q, &given.q));
        metric(&self.of_rigid(&picked(&self.rigid, &away)), &x.sigma);
        let faster: Vec<S> = v.iter().zip(&given.v).map(|(&v, &g)| v - g).collect();
        metric(&faster, &x.tau);

        let mut rows = vec![S::zero(); nc];
        joints::values(&at, &mut rows);
        for row in self.left_out.numbers() {
            rows[row] = x.lambda[row];
        }
        out.extend(&rows);
        let mut bias = rows.clone();
        joints::accelerations(&at, &mut bias);
        joints::rates_from_gradients(model, numbering, &gradients, &a, &mut rows);
        add_scaled(&mut rows, S::one(), &bias);
        out.extend(picked(&self.kept, &rows));
        joints::rates(&at, &mut rows);
        out.extend(picked(&self.kept, &rows));
        out
    }

    /// The bodies at positions q, without velocity.
    pub(super) fn at_rest<S: Scalar>(&self, q: &[S]) -> Vec<BodyMotion<S>> {
        let mut motions = Vec::new();
        let still = vec![S::zero(); self.numbering.velocities()];
        BodyMotion::all(self.numbering, q, &still, &mut motions);
        motions
    }

    /// M(q) y, both for unknowns of velocity.
    pub(super) fn mass_product<S: Scalar>(
        &self,
        model: &Model<S>,
        motions: &[BodyMotion<S>],
        y: &[S],
    ) -> Vec<S> {
        let y = self.expanded(y.to_vec());
        self.compressed(mass_product(model, self.numbering, motions, &y))
    }

    /// Products with the derivative of the residual.
    pub(super) fn along<'b>(
        &'b self,
        model: &Model<f64>,
        given: &Given<f64>,
        at: &State<f64>,
    ) -> Along<'b> {
        let dual = |x: f64| Dual::new(x, 0.0);
        Along {
            layout: self,
            model: model.map(&mut |x| dual(x)),
            given: given.map(&mut |x| dual(x)),
            at: at.map(|x| x),
        }
    }

    /// Chooses the rows that are independent at the placement while elastic coordinates are at
    /// rest.
    fn keep_independent(&mut self, model: &Model<f64>, placed: &[f64]) {
        let (numbering, left_out) = (self.numbering, self.left_out);
        let (nv, nc) = (numbering.velocities(), numbering.constraints());
        let still = vec![0.0; nv];
        let (mut motions, mut gradients) = (Vec::new(), Vec::new());
        BodyMotion::all(numbering, placed, &still, &mut motions);
        let at = InMotion::new(model, numbering, &motions, 0.0);
        joints::gradients(&at, &mut gradients);
        let scale = reach(model);
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for row in (0..nc).filter(|&row| !left_out.contains(row)) {
            let mut unit = vec![0.0; nc];
            unit[row] = 1.0;
            let mut g = still.clone();
            joints::add_reactions(model, numbering, &gradients, &unit, &mut g);
            // Rotations as displacements at the length scale.
            for (i, six) in g.chunks_exact_mut(6).enumerate() {
                let first = if self.angles[i] { 0 } else { 3 };
                six[first..].iter_mut().for_each(|x| *x /= scale);
            }
            let mut g = picked(&self.rigid, &self.compressed(g));
            let before = dot(&g, &g).sqrt();
            // Twice, so that round-off of the first pass goes.
            for _ in 0..2 {
                for b in &basis {
                    let along = dot(b, &g);
                    add_scaled(&mut g, -along, b);
                }
            }
            let rest = dot(&g, &g).sqrt();
            if rest > INDEPENDENT * before {
                g.iter_mut().for_each(|x| *x /= rest);
                basis.push(g);
                self.kept.push(row);
            }
        }
    }
}

/// The mass matrix times velocities.
fn mass_product<S: Scalar>(
    model: &Model<S>,
    numbering: &Numbering,
    motions: &[BodyMotion<S>],
    by: &[S],
) -> Vec<S> {
    let mut out = vec![S::zero(); numbering.velocities()];
    bodies::mass_product(model, numbering, by, &mut out);
    flexible::add_mass_product(model, numbering, motions, by, &mut out);
    out
}

/// Products with the derivative of the residual at a state, by dual numbers.
pub(super) struct Along<'a> {
    layout: &'a Layout<'a>,
    model: Model<Dual>,
    given: Given<Dual>,
    at: State<f64>,
}

impl Along<'_> {
    pub(super) fn product(&self, x: &[f64]) -> Vec<f64> {
        let mut state = self.at.map(|x| Dual::new(x, 0.0));
        let change: Vec<Dual> = x.iter().map(|&x| Dual::new(0.0, x)).collect();
        self.layout.advance(&mut state, &change);
        let residual = self.layout.residual(&self.model, &self.given, &state);
        residual.iter().map(|x| x.du).collect()
    }
}
