//! Accelerations and multipliers of a state, from the index-1 equations
//!
//! ```text
//! M v̇ + G(q)ᵀ λ = f(q, v, t),        G(q) v̇ = γ(q, v)
//! ```
//!
//! and the projections that use the same matrix [M Gᵀ; G 0].

mod pull_back;

use crate::linalg::{Pivots, SingularMatrix, SolveScalar};
use crate::math::Vec3;
use crate::model::Model;
use crate::system::bodies::{self, BodyMotion, all_force_balances, velocities_of};
use crate::system::constraint::RowGradient;
use crate::system::flexible::{self};
use crate::system::in_motion::InMotion;
use crate::system::initial::mass;
use crate::system::joints::{self};
use crate::system::kkt::{EliminationSummary, Metric, SaddlePoint};
use crate::system::loads::{self};
use crate::system::numbering::Numbering;
use crate::system::planar::PlanarJoints;
use crate::system::reduce;
use crate::system::redundant_rows::{RedundantRows, RowWeights};
use crate::system::tree::{self, Tree};
use std::sync::Arc;

/// Solver of the index-1 equations at consecutive states.
pub struct Accelerations<'a, S> {
    /// The model.
    pub model: &'a Model<S>,
    /// Its numbering.
    pub numbering: &'a Numbering,
    /// Motions of the bodies in the present state.
    pub motions: Vec<BodyMotion<S>>,
    gradients: Vec<RowGradient<S>>,
    /// Redundant rows, which are not imposed.
    left_out: RedundantRows,
    weighing: RowWeights<S>,
    /// The joints, if the scene is planar.
    planar: Option<PlanarJoints<S>>,
    /// Motions with accelerations and virtual velocities, for pull-backs.
    moving: Vec<BodyMotion<S>>,
    /// Time of the present state \[s\].
    time: S,
    solver: Solver<S>,
    left_to_sparse: Option<FallbackReason>,
    /// Whether the joints close loops.
    loops: bool,
    rhs: Vec<S>,
    /// Number of factorisations so far.
    pub factorisations: usize,
    /// Number of solutions so far.
    pub solves: usize,
}

/// Elimination by the tree of joints, or by sparse LU if they close many loops or a body lacks
/// inertia.
enum Solver<S> {
    Tree(Box<Tree<S>>),
    Sparse(Box<SaddlePoint<S>>, Vec<S>),
}

/// Data that determine the factors, besides the state. A solver with the same memory gives the same
/// numbers to the last bit.
#[derive(Clone, Debug, Default)]
pub struct Memory {
    left_to_sparse: Option<FallbackReason>,
    pivots: Option<Arc<Pivots>>,
}

/// Summary of the elimination of a model's matrix in the state (q, v), if it has one, and the reason why
/// sparse LU is used, if it is.
pub fn elimination(
    model: &Model<f64>,
    numbering: &Numbering,
    q: &[f64],
    v: &[f64],
) -> (Option<EliminationSummary>, Option<FallbackReason>) {
    let mut field = Accelerations::new(model, numbering);
    field.set_state(q, v, 0.0);
    let found = field.factorise().ok().map(|()| field.elimination());
    (found, field.left_to_sparse())
}

/// The reason why sparse LU replaces the tree of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FallbackReason {
    /// Loops of joints are so long and overlap so much that sparse LU costs less.
    Loops,
    /// A body is flexible: its mass matrix couples it with its carriers.
    Flexible,
    /// Joints are coupled: their rows have coordinates in common.
    Coupled,
    /// A body, with the bodies that it carries, has a motion without inertia, or with an inertia
    /// that loses five digits relative to the others.
    Body(usize),
    /// The same for the rows of a joint and the inertias of its bodies.
    Joint(usize),
}

impl<'a, S: SolveScalar> Accelerations<'a, S> {
    /// Plans the solver.
    pub fn new(model: &'a Model<S>, numbering: &'a Numbering) -> Self {
        let (solver, left_to_sparse) = match Tree::plan(model, numbering) {
            Some(tree) => (Solver::Tree(Box::new(tree)), None),
            None => {
                let why = match model.flexible.is_empty() {
                    true if model.is_coupled() => FallbackReason::Coupled,
                    true => FallbackReason::Loops,
                    false => FallbackReason::Flexible,
                };
                (Self::sparse(model, numbering), Some(why))
            }
        };
        Self {
            model,
            numbering,
            motions: Vec::new(),
            gradients: Vec::new(),
            left_out: RedundantRows::of(model, numbering),
            weighing: RowWeights::default(),
            planar: PlanarJoints::of(model),
            moving: Vec::new(),
            time: S::zero(),
            solver,
            left_to_sparse,
            loops: tree::closes_loops(model, numbering),
            rhs: vec![S::zero(); numbering.velocities() + numbering.constraints()],
            factorisations: 0,
            solves: 0,
        }
    }

    /// Whether its factors depend on more than the present state.
    pub fn remembers(&self) -> bool {
        matches!(self.solver, Solver::Sparse(..))
    }

    /// The data that determine its factors, besides the state.
    pub fn memory(&mut self) -> Memory {
        Memory {
            left_to_sparse: self.left_to_sparse,
            pivots: match &mut self.solver {
                Solver::Tree(_) => None,
                Solver::Sparse(saddle, _) => saddle.pivots(),
            },
        }
    }

    /// Restores the memory of another solver of the same model.
    pub fn restore(&mut self, memory: &Memory) {
        if self.left_to_sparse != memory.left_to_sparse {
            let tree = || Tree::plan(self.model, self.numbering);
            self.solver = match memory.left_to_sparse.is_none().then(tree).flatten() {
                Some(tree) => Solver::Tree(Box::new(tree)),
                None => Self::sparse(self.model, self.numbering),
            };
            self.left_to_sparse = memory.left_to_sparse;
        }
        if let Solver::Sparse(saddle, _) = &mut self.solver {
            saddle.set_pivots(memory.pivots.as_ref());
        }
    }

    fn sparse(model: &Model<S>, numbering: &Numbering) -> Solver<S> {
        let zeros = vec![S::zero(); numbering.constraints()];
        Solver::Sparse(Box::new(SaddlePoint::new(model, numbering)), zeros)
    }

    /// Whether the joints close loops, or the tree is not used because a body lacks inertia.
    pub fn closes_loops(&self) -> bool {
        self.loops
            || match self.left_to_sparse {
                None
                | Some(
                    FallbackReason::Loops | FallbackReason::Flexible | FallbackReason::Coupled,
                ) => false,
                Some(FallbackReason::Body(_) | FallbackReason::Joint(_)) => true,
            }
    }

    /// Redundant rows, which are not imposed.
    pub fn left_out(&self) -> &RedundantRows {
        &self.left_out
    }

    /// Sets the redundant rows from the next state on.
    pub fn leave_out(&mut self, left_out: &RedundantRows) {
        if self.left_out != *left_out {
            self.left_out.clone_from(left_out);
            if let Solver::Sparse(saddle, _) = &mut self.solver {
                saddle.leave_out(left_out);
            }
        }
    }

    /// Another choice of redundant rows, if one is better (see [`RedundantRows::exchanged`]). The
    /// matrix must be factorised in the present state.
    pub fn exchanged(&mut self, worn: f64) -> Option<RedundantRows> {
        if self.left_out.is_empty() {
            return None;
        }
        let left_out = std::mem::take(&mut self.left_out);
        let motions = std::mem::take(&mut self.motions);
        let mut weighing = std::mem::take(&mut self.weighing);
        let at = InMotion::new(self.model, self.numbering, &motions, self.time);
        let exchanged = left_out.exchanged(&at, worn, &mut weighing, |rhs| {
            self.solve(rhs);
        });
        (self.left_out, self.motions, self.weighing) = (left_out, motions, weighing);
        exchanged
    }

    /// Multipliers that move no body (see [`RedundantRows::undetermined`]); none without redundant rows. The
    /// matrix must be factorised in the present state.
    pub fn undetermined(&mut self) -> Vec<Vec<f64>> {
        if self.left_out.is_empty() {
            return Vec::new();
        }
        let left_out = std::mem::take(&mut self.left_out);
        let motions = std::mem::take(&mut self.motions);
        let at = InMotion::new(self.model, self.numbering, &motions, self.time);
        let all = left_out.undetermined(&at, |rhs| self.solve(rhs));
        (self.left_out, self.motions) = (left_out, motions);
        all
    }

    /// Moves to the state (q, v) at `time` without factorising. The Euler parameters in `q` need
    /// not have unit length.
    pub fn set_state(&mut self, q: &[S], v: &[S], time: S) {
        self.time = time;
        BodyMotion::all_normalised(self.numbering, q, v, &mut self.motions);
        match &mut self.planar {
            Some(planar) => {
                planar.set_state(&self.motions);
                planar.gradients(&mut self.gradients);
            }
            None => {
                let at = InMotion::new(self.model, self.numbering, &self.motions, time);
                joints::gradients(&at, &mut self.gradients);
            }
        }
        self.left_out.clear_gradients(&mut self.gradients);
    }

    /// The present state.
    fn here(&self) -> InMotion<'_, S> {
        InMotion::new(self.model, self.numbering, &self.motions, self.time)
    }

    /// Changes the velocities; the positions stay.
    pub fn set_velocities(&mut self, v: &[S]) {
        for (body, motion) in self.motions.iter_mut().enumerate() {
            (motion.velocity, motion.omega) = velocities_of(&v[self.numbering.velocity(body)..]);
        }
        if let Some(planar) = &mut self.planar {
            planar.set_velocities(self.numbering, v);
        }
    }

    /// Factorises [M Gᵀ; G 0] in the present state.
    ///
    /// # Errors
    /// [`SingularMatrix`]: redundant constraints, or a motion without inertia.
    pub fn factorise(&mut self) -> Result<(), SingularMatrix> {
        self.factorisations += 1;
        if let Solver::Tree(tree) = &mut self.solver {
            let Err(at) = tree.factorise(
                self.model,
                self.numbering,
                (&self.gradients, &self.left_out),
            ) else {
                return Ok(());
            };
            let row = at.column.checked_sub(self.numbering.velocities());
            self.left_to_sparse = Some(match row {
                Some(row) => FallbackReason::Joint(self.numbering.joint_of_row(row)),
                None => FallbackReason::Body(self.numbering.body_of_velocity(at.column)),
            });
            // Joints may hold a body without inertia, and sparse LU may find pivots for the rows of
            // a loop.
            self.solver = Self::sparse(self.model, self.numbering);
            if let Solver::Sparse(saddle, _) = &mut self.solver {
                saddle.leave_out(&self.left_out);
            }
        }
        let Solver::Sparse(saddle, zeros) = &mut self.solver else {
            unreachable!("the tree was left above");
        };
        let at = InMotion::new(self.model, self.numbering, &self.motions, self.time);
        saddle.factorise(&at, zeros, mass(self.model), Metric::Mass)
    }

    /// Solves [M Gᵀ; G 0] (x, λ) = (f, g) in place; `rhs` has length n_v + n_c.
    pub fn solve(&mut self, rhs: &mut [S]) {
        self.solves += 1;
        self.left_out.clear(&mut rhs[self.numbering.velocities()..]);
        if let Solver::Sparse(saddle, _) = &mut self.solver {
            return saddle.solve(rhs);
        }
        // The tree treats inertias as symmetric, but their infinitesimal parts may not be.
        let given = S::INFINITESIMAL.then(|| rhs.to_vec());
        self.solve_tree(rhs);
        if let Some(given) = given {
            let mut rest = self.residual(rhs, &given);
            self.solve_tree(&mut rest);
            rhs.iter_mut().zip(&rest).for_each(|(x, &d)| *x += d);
        }
    }

    /// Summary of the elimination of the last factorised matrix.
    pub fn elimination(&mut self) -> EliminationSummary {
        match &mut self.solver {
            Solver::Tree(tree) => tree.elimination(self.numbering),
            Solver::Sparse(saddle, _) => saddle.elimination(),
        }
    }

    /// The reason why sparse LU is used, if it is.
    pub fn left_to_sparse(&self) -> Option<FallbackReason> {
        self.left_to_sparse
    }

    fn solve_tree(&mut self, rhs: &mut [S]) {
        if let Solver::Tree(tree) = &mut self.solver {
            let numbering = self.numbering;
            reduce::through(numbering, 1, rhs, |rhs| tree.solve(numbering, rhs));
        }
    }

    /// The residual rhs − [M Gᵀ; G 0] (x, λ).
    fn residual(&self, x: &[S], rhs: &[S]) -> Vec<S> {
        let nv = self.numbering.velocities();
        let mut out = vec![S::zero(); x.len()];
        let (model, numbering) = (self.model, self.numbering);
        for (i, body) in model.bodies.iter().enumerate() {
            let o = numbering.velocity(i);
            let (linear, angular) = velocities_of(&x[o..]);
            bodies::add6(
                &mut out[o..],
                &(linear * body.mass),
                &(body.inertia * angular),
            );
        }
        joints::add_reactions(model, numbering, &self.gradients, &x[nv..], &mut out);
        let (_, lower) = out.split_at_mut(nv);
        joints::rates_from_gradients(model, numbering, &self.gradients, x, lower);
        out.iter_mut()
            .zip(rhs)
            .for_each(|(out, &b)| *out = b - *out);
        out
    }

    /// Accelerations (length n_v) and multipliers (n_c) in the present, factorised state.
    pub fn accelerations(&mut self, a: &mut [S], lambda: &mut [S]) {
        let mut rhs = std::mem::take(&mut self.rhs);
        let nv = self.numbering.velocities();
        let (upper, lower) = rhs.split_at_mut(nv);
        a.fill(S::zero());
        all_force_balances(self.model, self.numbering, &self.motions, a, upper);
        flexible::add_force_balances(self.model, self.numbering, &self.motions, a, upper);
        match &self.planar {
            Some(planar) => planar.accelerations(self.numbering, lower),
            None => {
                joints::accelerations(&self.here(), lower);
            }
        }
        rhs.iter_mut().for_each(|x| *x = -*x);
        let forces = &mut rhs[..nv];
        loads::add_forces(&self.here(), forces);
        self.solve(&mut rhs);
        a.copy_from_slice(&rhs[..nv]);
        lambda.copy_from_slice(&rhs[nv..]);
        self.rhs = rhs;
    }

    /// The correction δ of the velocities and its multipliers σ, in the metric of the mass:
    /// M δ + Gᵀσ = 0, G (v + δ) + Φ_t = 0.
    pub fn velocity_correction(&mut self, v: &[S], delta: &mut [S], sigma: &mut [S]) {
        let mut rhs = std::mem::take(&mut self.rhs);
        let nv = self.numbering.velocities();
        rhs.fill(S::zero());
        self.rates(v, &mut rhs[nv..]);
        rhs[nv..].iter_mut().for_each(|x| *x = -*x);
        self.solve(&mut rhs);
        delta.copy_from_slice(&rhs[..nv]);
        sigma.copy_from_slice(&rhs[nv..]);
        self.rhs = rhs;
    }

    /// Size of the power that loads and drives supply at the velocities `v` with the multipliers λ,
    /// |f·v| + |λ·Φ_t| and that of winches \[W\].
    pub fn supplied_power(&mut self, v: &[S], lambda: &[S]) -> f64 {
        let mut all = std::mem::take(&mut self.rhs);
        all.fill(S::zero());
        let (forces, rates) = all.split_at_mut(v.len());
        loads::add_supplying_forces(&self.here(), forces);
        joints::add_driven_rates(&self.here(), rates);
        let product = |x: &[S], y: &[S]| -> f64 {
            let terms = x.iter().zip(y).map(|(&x, &y)| (x * y).re());
            terms.sum::<f64>().abs()
        };
        let winches = loads::cable::winch_power(&self.here()).re().abs();
        let power = product(forces, v) + product(rates, lambda) + winches;
        self.rhs = all;
        power
    }

    /// Rates G v + Φ_t of the constraints at the velocities `v` and the present positions; zero for
    /// redundant rows.
    pub fn rates(&self, v: &[S], out: &mut [S]) {
        let (model, numbering) = (self.model, self.numbering);
        joints::rates_from_gradients(model, numbering, &self.gradients, v, out);
        joints::add_driven_rates(&self.here(), out);
        self.left_out.clear(out);
    }

    /// The rates of the constraints where the bodies of each joint that can move do so by numbers of their own, in lengths of
    /// `length` and radians: of the size that the joint gives to such motions, at any lever arm.
    pub fn rates_of_joints(&self, length: f64, number: impl Fn(usize) -> f64, out: &mut [S]) {
        const NUMBERS: usize = 18;
        let moves = |body: usize| self.numbering.unknowns_of(body) > 0;
        for (j, joint) in self.model.joints.iter().enumerate() {
            let three = |k: usize, size: f64| {
                Vec3::from_fn(|i, _| S::from(size * number(NUMBERS * j + 3 * k + i)))
            };
            let side = |k: usize, moves: bool| match moves {
                true => [three(k, length), three(k + 1, 1.0)],
                false => [Vec3::zeros(); 2],
            };
            let a = side(0, moves(joint.body_a));
            let b = side(2, joint.body_b.is_some_and(moves));
            let local = side(4, joint.modes.is_some());
            for i in self.numbering.rows(j) {
                let row = &self.gradients[i];
                out[i] = row.force.dot(&(a[0] - b[0]))
                    + row.torque_a.dot(&a[1])
                    + row.torque_b.dot(&b[1])
                    + row.local_force.dot(&local[0])
                    + row.local_torque.dot(&local[1]);
            }
        }
    }

    /// Whether row i is a length \[m\], not a product of two axes.
    pub fn is_length(&self, i: usize) -> bool {
        self.gradients[i].force.iter().any(|x| x.re() != 0.0)
    }

    /// Constraints Φ in the present state; zero for redundant rows.
    pub fn constraints(&self, out: &mut [S]) {
        joints::values(&self.here(), out);
        self.left_out.clear(out);
    }

    /// Adds Gᵀ λ to `out` (length n_v).
    pub fn add_reactions(&self, lambda: &[S], out: &mut [S]) {
        joints::add_reactions(self.model, self.numbering, &self.gradients, lambda, out);
    }
}
