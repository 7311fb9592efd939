//! Steps that resolve the tangent.
//!
//! A derivative of the motion obeys the linearised equations
//!
//! ```text
//! δv̇ = A δy + B δv + …,      A = ∂a/∂y,   B = ∂a/∂v
//! ```
//!
//! A body at rest, or one whose mode is not excited, says nothing of A and B: the error of the
//! state allows steps that amplify the tangent, and the exact adjoint of these steps is the exact
//! derivative of a wrong number. So if derivatives are wanted, the spectral radii of A and B are
//! estimated by power iterations on differences of the accelerations, renewed every few steps, and
//! bound the step by h ρ ≤ z, where the method errs by about the tolerance for each radian of an
//! oscillation of angular frequency ρ.

use super::record::NodeView;
use super::tableau::ORDER;
use crate::integrate::scale::{Scale, Speeds};
use crate::integrate::singular::irregular;
use crate::linalg::SolveScalar;
use crate::model::Model;
use crate::system::accelerations::Accelerations;
use crate::system::{Numbering, RedundantRows, bodies, flexible};

/// h ρ at the tolerance `AT`: the error of an oscillation is then 7e-8 for each radian. It changes
/// as the tolerance to the power 1/8 and stays below a third of the border of stability.
const RESOLVED: f64 = 1.0;
const AT: f64 = 1e-9;
const MOST: f64 = 2.0;
/// Part of the radius of B that counts: damping must be stable, not accurate.
const OF_DAMPING: f64 = 1.0 / 3.0;
/// Largest number of iterations at the start.
const FIRST: usize = 8;
/// They end where the rate of both grows by less than this part.
const GROWS: f64 = 0.1;
/// Numbers of steps after which the radii of A and of B are renewed.
const EVERY: [usize; 2] = [8, 32];
/// Size of the differences, relative to the scene's length and speed.
const DIFFERENCE: f64 = 1e-7;
/// Above this magnification near a singular position, differences say nothing.
const NEAR_SINGULAR: f64 = 10.0;

/// What a power iteration changes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum By {
    Positions,
    Velocities,
}

/// The power iterations of A or B.
struct Iteration {
    /// The direction, of size one in the metric of the mass.
    along: Vec<f64>,
    /// The spectral radius \[1/s² or 1/s\].
    radius: f64,
}

/// Estimates the largest step that resolves the tangent.
pub struct Tangent<'a, S> {
    field: Accelerations<'a, S>,
    /// h ρ of the largest step.
    most: f64,
    iterations: [Iteration; 2],
    state: (Vec<S>, Vec<S>),
    moved: Vec<S>,
    a: Vec<S>,
    lambda: Vec<S>,
    delta: Vec<S>,
    sigma: Vec<S>,
    /// Number of evaluations of the accelerations so far.
    pub evaluations: usize,
}

impl<'a, S: SolveScalar> Tangent<'a, S> {
    /// Estimates at the start, in the state `node`, for steps with this tolerance.
    pub fn new(
        (model, numbering): (&'a Model<S>, &'a Numbering),
        scale: &Scale,
        node: NodeView<S>,
        left_out: &RedundantRows,
        tolerance: f64,
    ) -> Self {
        let zeros = |n: usize| vec![S::zero(); n];
        let (nq, nv) = (numbering.positions(), numbering.velocities());
        let nc = numbering.constraints();
        let most = RESOLVED * (tolerance / AT).powf(1.0 / ORDER as f64);
        let still = || Iteration {
            along: vec![0.0; nv],
            radius: 0.0,
        };
        let mut own = Self {
            field: Accelerations::new(model, numbering),
            most: most.min(MOST),
            iterations: [still(), still()],
            state: (zeros(nq), zeros(nv)),
            moved: zeros(nq),
            a: zeros(nv),
            lambda: zeros(nc),
            delta: zeros(nv),
            sigma: zeros(nc),
            evaluations: 0,
        };
        own.field.leave_out(left_out);
        let zero = S::zero();
        own.field.set_state(node.q, node.v, zero);
        if own.field.factorise().is_err() {
            return own;
        }
        for by in [By::Positions, By::Velocities] {
            own.begin(node, scale, by);
            for _ in 0..FIRST {
                let before = own.rate();
                own.iterate((node, zero), scale, by);
                if own.rate() <= (1.0 + GROWS) * before {
                    break;
                }
            }
        }
        own
    }

    /// Renews the estimates after step number `step`, in the state `node` at `time`, if they are
    /// due. `magnified` tells how far a singular position magnifies errors.
    pub fn renew(
        &mut self,
        (node, time): (NodeView<S>, S),
        scale: &Scale,
        left_out: &RedundantRows,
        (step, magnified): (usize, f64),
    ) {
        if magnified > NEAR_SINGULAR {
            return;
        }
        self.field.leave_out(left_out);
        for (by, every) in [By::Positions, By::Velocities].into_iter().zip(EVERY) {
            if step.is_multiple_of(every) {
                self.iterate((node, time), scale, by);
            }
        }
    }

    /// The largest step \[s\].
    pub fn largest_step(&self) -> f64 {
        self.most / self.rate()
    }

    /// The rate at which the tangent moves \[1/s\].
    fn rate(&self) -> f64 {
        let [a, b] = &self.iterations;
        let b = OF_DAMPING * b.radius;
        0.5 * (b + (b * b + 4.0 * a.radius).sqrt())
    }

    /// Adds the work so far.
    pub fn work(&self) -> [usize; 2] {
        [self.field.factorisations, self.field.solves]
    }

    /// Begins with the accelerations by irregular forces, which move light parts most.
    fn begin(&mut self, node: NodeView<S>, scale: &Scale, by: By) {
        let nv = node.v.len();
        let mut rhs = vec![S::zero(); nv + self.lambda.len()];
        for (i, force) in rhs[..nv].iter_mut().enumerate() {
            let lever = if i % 6 < 3 { 1.0 } else { scale.length };
            *force = S::from(lever * irregular(i));
        }
        self.field.solve(&mut rhs);
        self.take(node.q, by, |i| rhs[i].re());
    }

    /// Takes the direction `x`, brought to size one; returns its size before.
    fn take(&mut self, q: &[S], by: By, x: impl Fn(usize) -> f64) -> f64 {
        let (model, numbering) = (self.field.model, self.field.numbering);
        let own = &mut self.iterations[by as usize].along;
        let before = std::mem::take(own);
        let x: Vec<S> = (0..before.len()).map(|i| S::from(x(i))).collect();
        let mut product = vec![S::zero(); x.len()];
        bodies::mass_product(model, numbering, &x, &mut product);
        flexible::add_mass_product_at(model, numbering, q, &x, &mut product);
        let square = x
            .iter()
            .zip(&product)
            .map(|(x, y)| x.re() * y.re())
            .sum::<f64>();
        let size = square.max(0.0).sqrt();
        let known = size > 0.0 && size.is_finite();
        *own = match known {
            true => x.iter().map(|x| x.re() / size).collect(),
            false => before,
        };
        if known { size } else { 0.0 }
    }

    /// One power iteration.
    fn iterate(&mut self, (node, time): (NodeView<S>, S), scale: &Scale, by: By) {
        let numbering = self.field.numbering;
        let along = &self.iterations[by as usize].along;
        let still = vec![0.0; node.q.len()];
        let speeds = match by {
            By::Positions => [scale.length, 1.0],
            By::Velocities => scale.floor,
        };
        let size = scale
            .square(numbering, &still, along, &Speeds::without_states(speeds))
            .sqrt();
        if size == 0.0 || !size.is_finite() {
            return;
        }
        let difference = DIFFERENCE / size;
        let (q, v) = &mut self.state;
        q.copy_from_slice(node.q);
        v.copy_from_slice(node.v);
        let step: Vec<S> = along.iter().map(|x| S::from(difference * x)).collect();
        match by {
            By::Positions => bodies::advance(numbering, q, &mut self.moved, &step),
            By::Velocities => v.iter_mut().zip(&step).for_each(|(v, &x)| *v += x),
        }
        self.field.set_state(q, v, time);
        self.evaluations += 1;
        if self.field.factorise().is_err() {
            return;
        }
        self.field.accelerations(&mut self.a, &mut self.lambda);
        // Accelerations differ by more than a motion that the joints allow.
        for (a, (&then, &v)) in self.a.iter_mut().zip(node.a.iter().zip(node.v)) {
            *a = (*a - then) * (1.0 / difference) + v;
        }
        let Self {
            field,
            a,
            delta,
            sigma,
            ..
        } = self;
        field.velocity_correction(a, delta, sigma);
        let moves = |i: usize| (a[i] + delta[i] - node.v[i]).re();
        let found: Vec<f64> = (0..node.v.len()).map(moves).collect();
        let radius = self.take(node.q, by, |i| found[i]);
        self.iterations[by as usize].radius = radius;
    }
}
