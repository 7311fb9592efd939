//! The GGL-stabilised equations at one instant: residual, iteration matrix and pull-back.
//!
//! ```text
//! F1 = P(q) q̇ − v + Gᵀ μ            P(q) q̇ = (ṙ, 2 L(p) ṗ) per body
//! F2 = M v̇ − f(q, v, t) + Gᵀ λ
//! F3 = Φ(q, t)
//! F4 = G(q, t) v + Φ_t
//! ```
//!
//! (Gear, Leimkuhler & Gupta 1985.) The unknowns are the tangent positions y, v, λ and μ, in this
//! order. The method gives q̇ and v̇ as functions of q and v, with ∂q̇/∂q = ∂v̇/∂v = c. The
//! equations are scaled so that the condition depends neither on the step h nor on the unit of
//! mass: rows are multiplied by h, h²/m, 1, h, columns v, λ, μ divided by h, h²/m, h, with the mean
//! mass m.

mod pull_back;

use crate::linalg::{Emit, KnownPivots, Pattern};
use crate::math::{Mat3, Scalar};
use crate::model::Model;
use crate::system::attachment::by_coordinates;
use crate::system::bodies::{self, BodyMotion, all_force_balances, velocity_of_rates};
use crate::system::constraint::RowGradient;
use crate::system::emit_bodies::{Rates, emit_force_balance, emit_kinematics};
use crate::system::flexible;
use crate::system::in_motion::InMotion;
use crate::system::joints;
use crate::system::kkt::{
    emit_gradients, emit_left_out, emit_reaction_jacobian, emit_transposed_gradients,
};
use crate::system::loads::{self, LoadEntries};
use crate::system::reduce;
use crate::system::redundant_rows::RedundantRows;
use crate::system::side::sides;
use crate::system::{Numbering, joints::rates_by_position};

/// Number of parts of a residual in velocity numbering: positions and velocities.
const PARTS: usize = 2;

/// Unknowns and rates at one instant.
#[derive(Clone, Copy, Debug)]
pub struct StepState<'a, S> {
    /// Positions.
    pub q: &'a [S],
    /// Velocities.
    pub v: &'a [S],
    /// Multipliers λ.
    pub lambda: &'a [S],
    /// Multipliers μ.
    pub mu: &'a [S],
    /// Rates q̇ of the positions.
    pub qdot: &'a [S],
    /// Rates v̇ of the velocities.
    pub vdot: &'a [S],
    /// Time \[s\].
    pub time: S,
}

/// The equations of one model, with workspace.
pub struct Equations<'a, S> {
    model: &'a Model<S>,
    numbering: &'a Numbering,
    motions: Vec<BodyMotion<S>>,
    gradients: Vec<RowGradient<S>>,
    /// Redundant rows, which are not imposed: λ_i = 0 and μ_i = 0 replace them.
    left_out: RedundantRows,
    loads: Vec<S>,
    /// Motions with virtual velocities, for pull-backs.
    moving: Vec<BodyMotion<S>>,
    /// Tangent positions that are held in the placement, for pull-backs.
    placed: Vec<S>,
    /// Mass by which the dynamics are divided, and the unit of the multipliers λ \[kg\].
    mass: f64,
}

/// Multiplies emitted entries by a number.
struct Times<'a, S>(&'a mut dyn Emit<S>, S);

impl<S: Scalar> Emit<S> for Times<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        self.0.add(row, column, value * self.1);
    }

    fn add_dense(&mut self, rows: &[usize], columns: &[usize], scale: S, block: &[S]) {
        self.0.add_dense(rows, columns, scale * self.1, block);
    }
}

impl<'a, S: Scalar> Equations<'a, S> {
    /// The equations of `model`.
    pub fn new(model: &'a Model<S>, numbering: &'a Numbering) -> Self {
        Self {
            model,
            numbering,
            motions: Vec::new(),
            gradients: Vec::new(),
            left_out: RedundantRows::of(model, numbering),
            loads: vec![S::zero(); numbering.velocities()],
            moving: Vec::new(),
            placed: Vec::new(),
            mass: typical_mass(model),
        }
    }

    /// Sets the redundant rows that are left out; returns whether they change.
    pub fn leave_out(&mut self, left_out: &RedundantRows) -> bool {
        let changes = self.left_out != *left_out;
        if changes {
            self.left_out.clone_from(left_out);
        }
        changes
    }

    /// The redundant rows that are left out.
    pub fn left_out(&self) -> &RedundantRows {
        &self.left_out
    }

    /// Mass by which the dynamics are divided \[kg\].
    pub fn mass(&self) -> f64 {
        self.mass
    }

    /// The model.
    pub fn model(&self) -> &'a Model<S> {
        self.model
    }

    /// Length of a residual or of a vector of unknowns: 2 (n_v + n_c).
    pub fn length(&self) -> usize {
        2 * (self.numbering.velocities() + self.numbering.constraints())
    }

    /// Order of the iteration matrix, in the unknowns of the bodies: 2 (n_u + n_c).
    pub fn order(&self) -> usize {
        2 * (self.numbering.unknowns() + self.numbering.constraints())
    }

    /// Applies `solve` in place to the reduced form of a residual.
    pub fn through<T: Scalar>(&self, x: &mut [T], solve: impl FnOnce(&mut [T])) {
        reduce::through(self.numbering, PARTS, x, solve);
    }

    /// Reduces a residual to its first [`Equations::order`] entries.
    pub fn compress<T: Scalar>(&self, x: &mut [T]) {
        reduce::compress(self.numbering, PARTS, x);
    }

    /// The inverse of [`Equations::compress`].
    pub fn expand<T: Scalar>(&self, x: &mut [T]) {
        reduce::expand(self.numbering, PARTS, x);
    }

    /// First indices of F1 … F4, and of y, v, λ, μ.
    fn starts(&self) -> [usize; 4] {
        let (nv, nc) = (self.numbering.velocities(), self.numbering.constraints());
        [0, nv, 2 * nv, 2 * nv + nc]
    }

    fn visit(&mut self, at: &StepState<S>) {
        BodyMotion::all(self.numbering, at.q, at.v, &mut self.motions);
        let here = InMotion::new(self.model, self.numbering, &self.motions, at.time);
        joints::gradients(&here, &mut self.gradients);
        self.left_out.clear_gradients(&mut self.gradients);
    }

    /// Residual in the scaling of step h; `out` has [`Equations::length`] entries.
    pub fn residual(&mut self, at: &StepState<S>, h: S, out: &mut [S]) {
        self.visit(at);
        let (model, numbering) = (self.model, self.numbering);
        let [_, f2, f3, f4] = self.starts();
        let (upper, lower) = out.split_at_mut(f3);
        let (out1, out2) = upper.split_at_mut(f2);
        let (out3, out4) = lower.split_at_mut(f4 - f3);
        velocity_of_rates(numbering, at.q, at.qdot, out1);
        for (f, &v) in out1.iter_mut().zip(at.v) {
            *f -= v;
        }
        joints::add_reactions(model, numbering, &self.gradients, at.mu, out1);
        flexible::clear_kinematics(model, numbering, at.v, out1);
        all_force_balances(model, numbering, &self.motions, at.vdot, out2);
        flexible::add_force_balances(model, numbering, &self.motions, at.vdot, out2);
        joints::add_reactions(model, numbering, &self.gradients, at.lambda, out2);
        self.loads.fill(S::zero());
        let here = InMotion::new(model, numbering, &self.motions, at.time);
        loads::add_forces(&here, &mut self.loads);
        for (f, &load) in out2.iter_mut().zip(&self.loads) {
            *f -= load;
        }
        joints::values(&here, out3);
        joints::rates_from_gradients(model, numbering, &self.gradients, at.v, out4);
        joints::add_driven_rates(&here, out4);
        for i in self.left_out.numbers() {
            out3[i] = at.lambda[i] * (h * h / self.mass);
            out4[i] = at.mu[i];
        }
        let scaled: [(&mut [S], S); 3] = [(out1, h), (out2, h * h / self.mass), (out4, h)];
        for (rows, scale) in scaled {
            for f in rows {
                *f *= scale;
            }
        }
    }

    /// Records the pattern of the iteration matrix, in the unknowns of the bodies.
    pub fn pattern(&mut self, at: &StepState<S>) -> Pattern {
        self.visit(at);
        let this = &*self;
        let pattern = this.record(|emit| {
            this.emit(at, S::one(), S::one(), emit);
            this.emit_mass(S::one(), emit);
        });
        let pattern = pattern.with_pivots(this.known_pivots());
        pattern.with_team(flexible::team(this.model))
    }

    /// The pattern of the iteration matrix for the assembly of [`Equations::held_jacobian`].
    pub fn pattern_of_held(&mut self, whole: &Pattern, at: &StepState<S>) -> Pattern {
        self.visit(at);
        let this = &*self;
        let assemble = |emit: &mut dyn Emit<S>| this.emit(at, S::one(), S::zero(), emit);
        match this.numbering.is_reduced() {
            true => whole.for_reduced(|i| reduce::shares(this.numbering, PARTS, i), assemble),
            false => whole.for_assembly(assemble),
        }
    }

    /// Pivots of the nodes of finite elements: their velocities by the kinematics, their positions by
    /// the dynamics.
    fn known_pivots(&self) -> KnownPivots {
        let n = self.numbering.unknowns();
        let all = flexible::nodal_unknowns(self.model, self.numbering);
        KnownPivots {
            short: all.iter().map(|&i| (i, n + i)).collect(),
            inner: all.iter().map(|&i| (n + i, i)).collect(),
        }
    }

    /// Records the pattern of [`Equations::emit_rates`].
    pub fn pattern_of_rates(&self, q: &[S]) -> Pattern {
        self.record(|emit| self.emit_own_rates(q, emit))
    }

    fn record(&self, assemble: impl FnOnce(&mut dyn Emit<S>)) -> Pattern {
        if self.numbering.is_reduced() {
            let shares = |place| reduce::shares(self.numbering, PARTS, place);
            Pattern::record_reduced(self.order(), shares, assemble)
        } else {
            Pattern::record(self.order(), assemble)
        }
    }

    /// Emits the scaled iteration matrix for ∂q̇/∂q = ∂v̇/∂v = c, in velocity numbering.
    pub fn jacobian(&mut self, at: &StepState<S>, h: S, c: S, emit: &mut dyn Emit<S>) {
        self.visit(at);
        self.emit(at, h, c, emit);
        self.emit_mass(c * h, emit);
    }

    /// As [`Equations::jacobian`] with rates that do not change, c = 0: without the masses of flexible bodies.
    pub fn held_jacobian(&mut self, at: &StepState<S>, h: S, emit: &mut dyn Emit<S>) {
        self.visit(at);
        self.emit(at, h, S::zero(), emit);
    }

    /// Emits the masses of flexible bodies, times c h.
    fn emit_mass(&self, ch: S, emit: &mut dyn Emit<S>) {
        let [_, v, ..] = self.starts();
        let by_mass = &mut Times(emit, S::from(1.0 / self.mass));
        let of = (self.model, self.numbering);
        flexible::emit_mass(of, &self.motions, (v, v), ch, by_mass);
    }

    /// Emits all but the masses of flexible bodies.
    fn emit(&self, at: &StepState<S>, h: S, c: S, emit: &mut dyn Emit<S>) {
        let (model, numbering, motions) = (self.model, self.numbering, &self.motions);
        let [y, v, lambda, mu] = self.starts();
        let (f1, f2, f3, f4) = (y, v, lambda, mu);
        let here = InMotion::new(model, numbering, motions, at.time);
        let rates = Rates { by_state: c, h };
        emit_kinematics(&here, at.qdot, (f1, y, v), rates, emit);
        emit_reaction_jacobian(&here, at.mu, (f1, y), h, emit);
        let by_mass = &mut Times(emit, S::from(1.0 / self.mass));
        emit_force_balance(&here, (f2, v), rates, by_mass);
        let of = (model, numbering);
        let (here_at, by) = ((&motions[..], at.vdot), (h * h, h));
        flexible::emit_force_balances(of, here_at, (f2, y, v), by, by_mass);
        let to = LoadEntries {
            row: f2,
            y,
            v,
            by_y: -(h * h),
            by_v: -h,
        };
        loads::emit_jacobian(&here, &to, by_mass);
        emit_reaction_jacobian(&here, at.lambda, (f2, y), h * h, by_mass);
        let one = S::one();
        emit_transposed_gradients(model, numbering, &self.gradients, (f1, mu), one, emit);
        emit_transposed_gradients(model, numbering, &self.gradients, (f2, lambda), one, emit);
        emit_gradients(model, numbering, &self.gradients, (f3, y), emit);
        emit_gradients(model, numbering, &self.gradients, (f4, v), emit);
        let places = [(f3, lambda), (f4, mu)];
        emit_left_out(numbering, &self.left_out, &places, emit);
        // Derivative of F4 in y.
        let ground = BodyMotion::ground();
        for (j, joint) in model.joints.iter().enumerate() {
            let (a, b) = sides(joint, motions, &ground, at.time);
            let curved = joints::curvature(joint, &here);
            let mut numbers = numbering.rows(j);
            rates_by_position(joint, (&a, &b), |row, by_a, by_b| {
                let Some(i) = numbers.next() else { return };
                let of_frame = by_a.frame;
                // Zeros are emitted, because the pattern serves every choice of rows.
                let h = if self.left_out.contains(i) {
                    S::zero()
                } else {
                    h
                };
                for (body, by) in [(Some(joint.body_a), by_a), (joint.body_b, by_b)] {
                    let Some(body) = body else { continue };
                    let column = y + numbering.velocity(body);
                    if row.depends_on_distance() {
                        emit.add_row(f4 + i, column, &(by.position * h));
                    }
                    emit.add_row(f4 + i, column + 3, &(by.theta * h));
                }
                if let Some((slot, x)) = curved {
                    emit.add(f4 + i, y + slot, x * at.v[slot] * h);
                }
                // The rate of other coupled joints does not depend on their coordinates where they are closed.
                let modes = joint.modes.as_ref().filter(|_| !joint.is_coupled());
                let Some(modes) = modes else { return };
                for (slot, x) in by_coordinates(joint, modes, numbering, &of_frame) {
                    emit.add(f4 + i, y + slot, x * h);
                }
            });
        }
    }

    /// Emits the scaled derivative of F in the unknowns of another stage with positions `other`,
    /// through h times the rates at the positions `q`: (P(q) T(q'), M).
    pub fn emit_rates(&self, q: &[S], other: &[S], emit: &mut dyn Emit<S>) {
        self.emit_rates_turned(q, emit, |i| {
            let o = self.numbering.position(i);
            bodies::turn_between(&q[o..], &other[o..])
        });
    }

    /// As [`Equations::emit_rates`] for the stage itself: (1, M(q)).
    pub fn emit_own_rates(&self, q: &[S], emit: &mut dyn Emit<S>) {
        self.emit_rates_turned(q, emit, |_| Mat3::identity());
    }

    /// Whether M depends on the positions.
    pub fn mass_varies(&self) -> bool {
        !self.model.flexible.is_empty()
    }

    fn emit_rates_turned(
        &self,
        q: &[S],
        emit: &mut dyn Emit<S>,
        turned: impl Fn(usize) -> Mat3<S>,
    ) {
        let [y, v, ..] = self.starts();
        let by_mass = S::from(1.0 / self.mass);
        for (i, body) in self.model.bodies.iter().enumerate() {
            let u = self.numbering.velocity(i);
            emit.add_identity(y + u, y + u, S::one());
            emit.add_block(y + u + 3, y + u + 3, &turned(i));
            emit.add_identity(v + u, v + u, body.mass * by_mass);
            emit.add_block(v + u + 3, v + u + 3, &(body.inertia * by_mass));
        }
        let of = (self.model, self.numbering);
        flexible::emit_mass_at(of, q, (v, v), by_mass, emit);
    }

    /// Multiplies an unscaled cotangent of the unknowns by the column scaling.
    pub fn scale_columns(&self, h: f64, b: &mut [f64]) {
        let [_, v, lambda, mu] = self.starts();
        let by_lambda = self.mass / (h * h);
        scale_parts(b, &[(v, 1.0 / h), (lambda, by_lambda), (mu, 1.0 / h)]);
    }

    /// The inverse of [`Equations::scale_columns`].
    pub fn unscale_columns(&self, h: f64, b: &mut [f64]) {
        let [_, v, lambda, mu] = self.starts();
        scale_parts(b, &[(v, h), (lambda, h * h / self.mass), (mu, h)]);
    }

    /// Multiplies the solution of the scaled transposed system by the row scaling.
    pub fn scale_rows(&self, h: f64, psi: &mut [f64]) {
        let [_, f2, f3, f4] = self.starts();
        for x in &mut psi[..f2] {
            *x *= h;
        }
        scale_parts(psi, &[(f2, h * h / self.mass), (f3, 1.0), (f4, h)]);
    }

    /// Name of the body or joint of a row or column of the iteration matrix, for messages.
    pub fn describe_reduced(&self, row: usize) -> String {
        self.describe(reduce::unreduced(self.numbering, PARTS, row))
    }

    /// Name of the body or joint of an equation or unknown, for messages.
    pub fn describe(&self, row: usize) -> String {
        let [_, f2, f3, f4] = self.starts();
        let body = |i: usize| &self.model.bodies[self.numbering.body_of_velocity(i)].name;
        let joint = |i: usize| &self.model.joints[self.numbering.joint_of_row(i)].name;
        match row {
            i if i < f2 => format!("the kinematics of body \"{}\"", body(i)),
            i if i < f3 => format!("the dynamics of body \"{}\"", body(i - f2)),
            i if i < f4 => format!("the position constraint of joint \"{}\"", joint(i - f3)),
            i => format!("the velocity constraint of joint \"{}\"", joint(i - f4)),
        }
    }
}

/// Geometric mean of the bodies' masses \[kg\]; 1 if there are none.
fn typical_mass<S: Scalar>(model: &Model<S>) -> f64 {
    let masses = model.bodies.iter().map(|body| body.mass.re());
    let logs: Vec<f64> = masses.filter(|m| *m > 0.0).map(f64::ln).collect();
    match logs.len() {
        0 => 1.0,
        count => (logs.iter().sum::<f64>() / count as f64).exp(),
    }
}

fn scale_parts(x: &mut [f64], parts: &[(usize, f64)]) {
    for (k, &(start, scale)) in parts.iter().enumerate() {
        let end = parts.get(k + 1).map_or(x.len(), |next| next.0);
        for x in &mut x[start..end] {
            *x *= scale;
        }
    }
}
