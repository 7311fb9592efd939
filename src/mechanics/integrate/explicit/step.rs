//! One step of DOP853: stages, projection, error. Its adjoint: adjoint/explicit/mod.rs.

use super::record::{Node, NodeView, StepData, add_rows};
use super::tableau::{A, ALL, B, C, E3, E5, END, STAGES};
use crate::integrate::touches::Missed;
use crate::integrate::{has_kinks, stage_time};
use crate::linalg::{SingularMatrix, SolveScalar};
use crate::math::{Vec3, rotation};
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::bodies::{self, add6, positions_of};
use crate::system::{Numbering, flexible, placement, turns};
use std::ops::Range;

/// Largest number of iterations of the position projection.
const ITERATIONS: usize = 12;
/// Largest change of the last iteration, relative to the length scale.
const REMAINDER: f64 = 1e-16;

/// A constraint is satisfied up to this |Φ| relative to the length scale: round-off.
const CLOSED: f64 = 2e-15;

/// Reason for the failure of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum StepFailure {
    /// The index-1 equations are singular.
    Singular(SingularMatrix),
    /// The positions could not be projected onto the constraints.
    Projection,
    /// The step ends too close to a singular position, expected at this fraction of the duration.
    Close(f64),
    /// The motion inside the step violates the constraints.
    Open,
    /// The step's estimated error is as large as the motion.
    Inaccurate(f64),
    /// The step passes over a contact.
    Missed(Missed),
    /// A value is not finite.
    NotFinite,
}

impl From<SingularMatrix> for StepFailure {
    fn from(singular: SingularMatrix) -> Self {
        Self::Singular(singular)
    }
}

/// Makes steps of one model.
pub struct Stepper<'a, S> {
    /// The index-1 equations.
    pub field: Accelerations<'a, S>,
    /// The results of the last step.
    pub data: StepData<Vec<S>>,
    length: f64,
    /// Coordinates of couplings, which count by the bodies that follow them.
    followed: Range<usize>,
    /// Whether loads or drives have kinks.
    kinks: bool,
    residual: Vec<S>,
    moved: Vec<S>,
    /// Workspace: positions, and two vectors of velocities.
    scratch: (Vec<S>, Vec<S>, Vec<S>),
}

impl<'a, S: SolveScalar> Stepper<'a, S> {
    /// Plans the steps of a model.
    pub fn new(model: &'a Model<S>, numbering: &'a Numbering) -> Self {
        Self {
            field: Accelerations::new(model, numbering),
            data: StepData::new(numbering),
            length: placement::length_scale(model),
            followed: model.coordinates(),
            kinks: has_kinks(model),
            residual: vec![S::zero(); numbering.velocities() + numbering.constraints()],
            moved: vec![S::zero(); numbering.positions()],
            scratch: (
                vec![S::zero(); numbering.positions()],
                vec![S::zero(); numbering.velocities()],
                vec![S::zero(); numbering.velocities()],
            ),
        }
    }

    /// Computes stages 0 … 11 of a step of size `h` from `node` at the time `start`, and the state
    /// at its end before the projection. The matrix of the last stage remains factorised.
    ///
    /// # Errors
    /// [`StepFailure`].
    pub fn stages(&mut self, node: NodeView<S>, (start, h): (S, S)) -> Result<(), StepFailure> {
        self.data.dense = false;
        self.put_node(node, 0);
        for i in 1..STAGES {
            self.stage(node, i, (start, h))?;
        }
        let data = &mut self.data;
        data.q_raw.copy_from_slice(node.q);
        data.v_raw.copy_from_slice(node.v);
        let (nq, nv) = (node.q.len(), node.v.len());
        add_rows(&mut data.q_raw, h, B, &data.qdot, (nq, 0));
        add_rows(&mut data.v_raw, h, B, &data.a, (nv, 0));
        let finite = |x: &[S]| x.iter().all(|x| x.is_finite());
        if finite(&data.q_raw) && finite(&data.v_raw) {
            Ok(())
        } else {
            Err(StepFailure::NotFinite)
        }
    }

    /// Computes the stages of the dense output for a step from `node` to `end`.
    ///
    /// # Errors
    /// [`StepFailure`].
    pub fn dense_stages(
        &mut self,
        (node, end): (NodeView<S>, NodeView<S>),
        (start, h): (S, S),
    ) -> Result<(), StepFailure> {
        self.put_node(end, END);
        for i in END + 1..ALL {
            self.stage(node, i, (start, h))?;
        }
        self.data.dense = true;
        Ok(())
    }

    fn put_node(&mut self, node: NodeView<S>, i: usize) {
        let numbering = self.field.numbering;
        let data = &mut self.data;
        let (q, v) = (span(node.q, i), span(node.v, i));
        data.q[q.clone()].copy_from_slice(node.q);
        data.v[v.clone()].copy_from_slice(node.v);
        data.a[v].copy_from_slice(node.a);
        data.lambda[span(node.lambda, i)].copy_from_slice(node.lambda);
        bodies::rates(numbering, node.q, node.v, &mut data.qdot[q]);
    }

    fn stage(
        &mut self,
        node: NodeView<S>,
        i: usize,
        (start, h): (S, S),
    ) -> Result<(), StepFailure> {
        let (q, v, c) = (span(node.q, i), span(node.v, i), span(node.lambda, i));
        let data = &mut self.data;
        // The stages before i are stored before it.
        let (_, at_q) = data.q.split_at_mut(q.start);
        let (_, at_v) = data.v.split_at_mut(v.start);
        let (nq, nv) = (node.q.len(), node.v.len());
        let (at_q, at_v) = (&mut at_q[..nq], &mut at_v[..nv]);
        at_q.copy_from_slice(node.q);
        at_v.copy_from_slice(node.v);
        add_rows(at_q, h, A[i], &data.qdot, (nq, 0));
        add_rows(at_v, h, A[i], &data.a, (nv, 0));
        let time = stage_time((start, h), C[i], self.kinks);
        self.field.set_state(at_q, at_v, time);
        self.field.factorise()?;
        bodies::rates(self.field.numbering, at_q, at_v, &mut data.qdot[q]);
        let (a, lambda) = (&mut data.a[v], &mut data.lambda[c]);
        self.field.accelerations(a, lambda);
        Ok(())
    }

    /// Projects the end of the step, at the time `end`, onto the constraints and evaluates the
    /// accelerations there.
    ///
    /// # Errors
    /// [`StepFailure`].
    pub fn finish(&mut self, out: &mut Node<Vec<S>>, end: S) -> Result<(), StepFailure> {
        self.project_positions(&mut out.q, end)?;
        self.field.factorise()?;
        let data = &mut self.data;
        self.field
            .velocity_correction(&data.v_raw, &mut data.delta, &mut data.sigma);
        for (v, (&raw, &d)) in out.v.iter_mut().zip(data.v_raw.iter().zip(&data.delta)) {
            *v = raw + d;
        }
        self.field.set_velocities(&out.v);
        self.field.accelerations(&mut out.a, &mut out.lambda);
        turns::count(self.field.model, self.field.numbering, &mut out.q);
        Ok(())
    }

    /// Finds the positions nearest to `q_raw` in the metric of the masses, by Newton's method with
    /// the factorised matrix. The equations remain evaluated there.
    fn project_positions(&mut self, q: &mut [S], end: S) -> Result<(), StepFailure> {
        let numbering = self.field.numbering;
        let nv = numbering.velocities();
        let Self { field, data, .. } = self;
        q.copy_from_slice(&data.q_raw);
        self.moved.fill(S::zero());
        bodies::normalise(numbering, q, &mut self.moved);
        data.s.fill(S::zero());
        let (mut before, mut contraction) = (f64::INFINITY, 1e-2);
        let mut settled = 0;
        for iteration in 0..ITERATIONS {
            field.set_state(q, &data.v_raw, end);
            // The infinitesimal part converges some iterations after the real part.
            if settled > if S::INFINITESIMAL { 4 } else { 0 } {
                return Ok(());
            }
            let (upper, lower) = self.residual.split_at_mut(nv);
            field.constraints(lower);
            let gap = lower.iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
            upper.fill(S::zero());
            if iteration > 0 {
                metric(field.model, numbering, q, &data.q_raw, upper);
                flexible::add_metric(
                    (field.model, numbering),
                    &field.motions,
                    (q, &data.q_raw),
                    upper,
                );
                field.add_reactions(&data.s, upper);
            }
            self.residual.iter_mut().for_each(|x| *x = -*x);
            field.solve(&mut self.residual);
            let (step, ds) = self.residual.split_at(nv);
            let all = step.chunks_exact(6).enumerate();
            let size = all.fold(0.0_f64, |m, (body, six)| {
                let part = |x: &[S]| x.iter().fold(0.0_f64, |m, x| m.max(x.re().abs()));
                // `f64::max` ignores NaN, so test every component.
                match six.iter().all(|x| x.is_finite()) {
                    true if self.followed.contains(&body) => m,
                    true => m.max(part(&six[..3]) / self.length).max(part(&six[3..])),
                    false => f64::INFINITY,
                }
            });
            if !size.is_finite() {
                return Err(StepFailure::NotFinite);
            }
            bodies::advance(numbering, q, &mut self.moved, step);
            data.s.iter_mut().zip(ds).for_each(|(s, &d)| *s += d);
            if iteration > 0 && before > 0.0 {
                contraction = (size / before).max(1e-3);
            }
            // Near a singular position round-off moves the nearest point along the constraints.
            let closed = iteration >= 3 && gap <= CLOSED * self.length.max(1.0);
            let stagnant = size <= 1e-13 && contraction > 0.3;
            if size * contraction <= REMAINDER || stagnant || closed {
                settled += 1;
            }
            before = size;
        }
        if settled > 0 {
            field.set_state(q, &data.v_raw, end);
            return Ok(());
        }
        Err(StepFailure::Projection)
    }

    /// Violation of the constraints at the fraction θ of the step of size h from `node`, at `time`:
    /// the largest |Φ|, relative to the length scale or 1, and |G v + Φ_t|, relative to these
    /// speeds \[m/s, rad/s\]. The equations remain evaluated there.
    pub fn open(
        &mut self,
        node: NodeView<S>,
        (h, theta): (S, f64),
        time: S,
        speeds: [f64; 2],
    ) -> f64 {
        let (q, v, a) = &mut self.scratch;
        self.data.view().dense(node, h, theta, [q, v, a]);
        bodies::bring_to_unit(self.field.numbering, q);
        self.field.set_state(q, v, time);
        let (_, rows) = self.residual.split_at_mut(v.len());
        let field = &self.field;
        let largest = |rows: &[S], [length, angle]: [f64; 2]| {
            let scaled = rows
                .iter()
                .enumerate()
                .map(|(i, x)| match field.is_length(i) {
                    true => x.re().abs() / length,
                    false => x.re().abs() / angle,
                });
            // `f64::max` ignores NaN.
            scaled.fold(
                0.0,
                |m: f64, x| if x.is_nan() { x } else { m.max(x) + 0.0 * m },
            )
        };
        field.constraints(rows);
        let positions = largest(rows, [self.length, 1.0]);
        field.rates(v, rows);
        positions.max(largest(rows, speeds)) + 0.0 * positions
    }

    /// Estimated errors of positions and velocities of the step of size h, Σ h e_i k_i for the
    /// embedded formulas of order 5 and 3, by the norm `measure`.
    pub fn errors(&mut self, h: S, measure: impl Fn(&[S], &[S]) -> f64) -> [f64; 2] {
        let (q, v, _) = &mut self.scratch;
        let data = &self.data;
        [E5, E3].map(|e| {
            q.fill(S::zero());
            v.fill(S::zero());
            let (nq, nv) = (q.len(), v.len());
            add_rows(q, h, e, &data.qdot, (nq, 0));
            add_rows(v, h, e, &data.a, (nv, 0));
            measure(q, v)
        })
    }

    /// The largest h (a_i − a_1) of the stages without weight, and of those with one, by the norm `measure`.
    pub fn changes(&mut self, h: S, measure: impl Fn(&[S], &[S]) -> f64) -> [f64; 2] {
        let (q, v, _) = &mut self.scratch;
        q.fill(S::zero());
        let n = v.len();
        let mut most = [0.0_f64; 2];
        for stage in 1..STAGES {
            let row = &self.data.a[stage * n..(stage + 1) * n];
            for ((out, &a), &first) in v.iter_mut().zip(row).zip(&self.data.a[..n]) {
                *out = (a - first) * h;
            }
            let weighted = usize::from(B.iter().any(|own| own.0 == stage));
            most[weighted] = most[weighted].max(measure(q, v));
        }
        most
    }

    /// Correction of the velocities by the projection of the last step, by the norm `measure`. It
    /// is zero if the joints form no loop: such scenes have no singular positions.
    pub fn velocity_correction(&mut self, measure: impl Fn(&[S], &[S]) -> f64) -> f64 {
        if !self.field.closes_loops() {
            return 0.0;
        }
        let (q, _, _) = &mut self.scratch;
        q.fill(S::zero());
        measure(q, &self.data.delta)
    }

    /// Distance of the last stage from the end of the step in state and in derivative, by the norm
    /// `measure`.
    pub fn last_stage(&mut self, to: NodeView<S>, measure: impl Fn(&[S], &[S]) -> f64) -> [f64; 2] {
        let (q, v, _) = &mut self.scratch;
        let data = &self.data;
        let last = STAGES - 1;
        let less = |out: &mut [S], rows: &[S]| {
            let n = out.len();
            let row = &rows[last * n..(last + 1) * n];
            out.iter_mut().zip(row).for_each(|(x, &y)| *x -= y);
        };
        q.copy_from_slice(to.q);
        v.copy_from_slice(to.v);
        less(q, &data.q);
        less(v, &data.v);
        let state = measure(q, v);
        bodies::rates(self.field.numbering, to.q, to.v, q);
        v.copy_from_slice(to.a);
        less(q, &data.qdot);
        less(v, &data.a);
        [state, measure(q, v)]
    }

    /// The motion inside the step of size h from `node`, at its fraction θ: positions, velocities
    /// and accelerations.
    pub fn inside(&mut self, node: NodeView<S>, h: S, theta: f64) -> [&[S]; 3] {
        let (q, v, a) = &mut self.scratch;
        self.data.view().dense(node, h, theta, [q, v, a]);
        bodies::bring_to_unit(self.field.numbering, q);
        [q, v, a]
    }
}

fn span<T>(row: &[T], i: usize) -> std::ops::Range<usize> {
    i * row.len()..(i + 1) * row.len()
}

/// Adds M T(q)⁺ (q − q_raw): per body (m (r − r'), 2 J L(p) (p − p')).
fn metric<S: SolveScalar>(
    model: &Model<S>,
    numbering: &Numbering,
    q: &[S],
    q_raw: &[S],
    out: &mut [S],
) {
    for (i, body) in model.bodies.iter().enumerate() {
        let o = numbering.position(i);
        let (r, p) = positions_of(&q[o..]);
        let (r_raw, p_raw) = positions_of(&q_raw[o..]);
        let away = std::array::from_fn(|k| p[k] - p_raw[k]);
        let turned: Vec3<S> = rotation::angular_velocity(&p, &away);
        add6(
            &mut out[numbering.velocity(i)..],
            &((r - r_raw) * body.mass),
            &(body.inertia * turned),
        );
    }
}
