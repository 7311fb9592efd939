//! The equations of small motions y e^{st} of a machine about its rest, or about steady rotation:
//!
//! ```text
//! [K + s D + s² M, Gᵀ; G, 0] [y; μ] = 0,     K = ∂B/∂q,   D = ∂B/∂v,   B = M v̇ − f(q, v) + Gᵀ λ,
//! ```
//!
//! where v and v̇ change as [`super::turning`] says; or about the state of a motion at an instant, with the matrices that
//! it has there.

use super::equations::{Layout, State};
use super::turning::{Frames, Steady, Turning, Weights};
use crate::linalg::{
    Emit, KnownPivots, Pattern, SingularMatrix, SolveScalar, SparseLu, SparseMatrix,
};
use crate::math::{Complex64, Scalar};
use crate::model::Model;
use crate::system::bodies::BodyMotion;
use crate::system::emit_bodies::{Rates, emit_force_balance};
use crate::system::flexible::{self, StrainForces};
use crate::system::in_motion::InMotion;
use crate::system::joints;
use crate::system::kkt::{emit_gradients, emit_reaction_jacobian, emit_transposed_gradients};
use crate::system::loads::{self, LoadEntries};
use crate::system::numbering::Numbering;
use crate::system::reduce::{self, emit_reduced};
use crate::system::redundant_rows::RedundantRows;

/// A model at a state, about which motions are small.
#[derive(Clone, Copy)]
pub(super) struct At<'a, S> {
    pub model: &'a Model<S>,
    pub numbering: &'a Numbering,
    pub left_out: &'a RedundantRows,
    pub q: &'a [S],
    pub lambda: &'a [S],
    pub moves: Moves<'a, S>,
}

/// How a machine moves.
#[derive(Clone, Copy)]
pub(super) enum Moves<'a, S> {
    /// It is at rest.
    Not,
    /// It turns steadily.
    Steadily(&'a Turning<S>),
    /// It has these velocities and accelerations, in velocity numbering, at a time.
    AtInstant { v: &'a [S], a: &'a [S], time: S },
}

impl<'a, S: Scalar> At<'a, S> {
    /// A model at rest, also in a turning frame.
    pub(super) fn rest(
        layout: &'a Layout,
        model: &'a Model<S>,
        x: &'a State<S>,
        turning: Option<&'a Turning<S>>,
    ) -> Self {
        Self {
            model,
            numbering: layout.numbering,
            left_out: layout.left_out,
            q: &x.q,
            lambda: &x.lambda,
            moves: turning.map_or(Moves::Not, Moves::Steadily),
        }
    }

    /// Number of independent motions that the joints allow.
    pub(super) fn freedom(&self) -> usize {
        let rows = self.numbering.constraints() - self.left_out.numbers().count();
        self.numbering.unknowns().saturating_sub(rows)
    }

    /// Velocities and accelerations of all bodies, and the time.
    pub(super) fn motion(&self) -> ([Vec<S>; 2], S) {
        match self.moves {
            Moves::Not => {
                let still = vec![S::zero(); self.numbering.velocities()];
                ([still.clone(), still], S::zero())
            }
            Moves::Steadily(turning) => (
                turning.velocities(self.model, self.numbering, self.q),
                S::zero(),
            ),
            Moves::AtInstant { v, a, time } => ([v.to_vec(), a.to_vec()], time),
        }
    }

    /// The frames in which small motions are seen, unless they are at rest.
    fn frames(&self) -> Option<Frames<S>> {
        let of = (self.model, self.numbering, self.q);
        match self.moves {
            Moves::Not => None,
            Moves::Steadily(turning) => Some(Frames::turning(of, turning)),
            Moves::AtInstant { v, a, .. } => Some(Frames::of_bodies(of, v, a)),
        }
    }
}

/// Emits K, D and M, each with its weight, and the rows of constraints with that of K. Columns and rows are those of unknowns
/// of velocity and of constraints.
pub(super) fn emit_pencil<S: Scalar>(at: At<S>, weights: Weights<S>, emit: &mut dyn Emit<S>) {
    emit_reduced(at.numbering, 1, emit, |emit| {
        emit_at(at, weights, at.numbering.velocities(), emit);
    });
}

/// The same in velocity numbering, with the multipliers from `lambda` on.
pub(super) fn emit_at<S: Scalar>(
    at: At<S>,
    weights: Weights<S>,
    lambda: usize,
    emit: &mut dyn Emit<S>,
) {
    let At {
        model, numbering, ..
    } = at;
    let (nv, nc) = (numbering.velocities(), numbering.constraints());
    let (y, v) = (0, lambda + nc);
    let a = v + nv;
    let ([speeds, accelerations], time) = at.motion();
    let (mut motions, mut gradients) = (Vec::new(), Vec::new());
    BodyMotion::all(numbering, at.q, &speeds, &mut motions);
    let here = InMotion::new(model, numbering, &motions, time);
    joints::gradients(&here, &mut gradients);
    at.left_out.clear_gradients(&mut gradients);
    let of = (model, numbering);
    let k = weights.stiffness;
    let columns = (weights, [v, a]);
    let mut steady = Steady::new(at.frames(), columns, emit);
    let rates = Rates {
        by_state: S::zero(),
        h: S::one(),
    };
    emit_force_balance(&here, (y, v), rates, &mut steady);
    let moving = (&motions[..], &accelerations[..]);
    flexible::emit_force_balances(of, moving, (y, y, v), (k, S::one()), &mut steady);
    let to = LoadEntries {
        row: y,
        y,
        v,
        by_y: -k,
        by_v: -S::one(),
    };
    loads::emit_jacobian(&here, &to, &mut steady);
    for (i, body) in model.bodies.iter().enumerate() {
        let o = numbering.velocity(i);
        steady.add_identity(y + o, a + o, body.mass);
        steady.add_block(y + o + 3, a + o + 3, &body.inertia);
    }
    flexible::emit_mass(of, &motions, (y, a), S::one(), &mut steady);
    emit_reaction_jacobian(&here, at.lambda, (y, y), k, &mut steady);
    emit_transposed_gradients(model, numbering, &gradients, (y, lambda), k, &mut steady);
    let mut scaled = Scaled {
        by: k,
        emit: &mut steady,
    };
    emit_gradients(model, numbering, &gradients, (lambda, y), &mut scaled);
    for row in at.left_out.numbers() {
        scaled.add(lambda + row, lambda + row, S::one());
    }
}

/// Emits every entry times a factor.
struct Scaled<'a, S> {
    by: S,
    emit: &'a mut dyn Emit<S>,
}

impl<S: Scalar> Emit<S> for Scaled<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        self.emit.add(row, column, value * self.by);
    }
}

/// K, D and M at a real state, with the rows of constraints in K.
pub(super) struct Matrices {
    /// Number of unknowns of velocity.
    pub unknowns: usize,
    pub stiffness: SparseMatrix<f64>,
    pub damping: SparseMatrix<f64>,
    pub mass: SparseMatrix<f64>,
    /// Motions that are left out of all products, and their products with the inertia, of which each has 1 with its motion.
    pub left_out: Vec<[Vec<f64>; 2]>,
    pattern: Pattern,
    /// K and D without the strain energies of finite elements, and these.
    by_strains: Option<ByStrains>,
}

/// K and D with less round-off than by their entries.
struct ByStrains {
    stiffness: SparseMatrix<f64>,
    damping: SparseMatrix<f64>,
    forces: StrainForces,
    numbering: Numbering,
}

/// A matrix of the pencil.
fn assembled(at: At<f64>, weights: Weights<f64>, pattern: &Pattern) -> SparseMatrix<f64> {
    let mut matrix = SparseMatrix::new(pattern.clone());
    matrix.assemble(|to| emit_pencil(at, weights, to));
    matrix
}

impl ByStrains {
    /// Those at a state; `None` if it has no finite elements, or some that are damped move.
    fn new(at: At<f64>, pattern: &Pattern, damped: bool) -> Option<Self> {
        let without = flexible::without_strains(at.model)?;
        let rest = At {
            model: &without,
            ..at
        };
        let ([speeds, _], _) = at.motion();
        let mut motions = Vec::new();
        BodyMotion::all(at.numbering, at.q, &speeds, &mut motions);
        let weights = |stiffness: f64, damping: f64| Weights {
            stiffness,
            damping,
            mass: 0.0,
        };
        Some(Self {
            forces: StrainForces::new((at.model, at.numbering), &motions, damped)?,
            stiffness: assembled(rest, weights(1.0, 0.0), pattern),
            damping: assembled(rest, weights(0.0, f64::from(u8::from(damped))), pattern),
            numbering: at.numbering.clone(),
        })
    }

    /// The shares of strains in K x and D x.
    fn of_strains(&self, x: &[f64]) -> [Vec<f64>; 2] {
        let numbering = &self.numbering;
        let along = reduce::expanded(numbering, x[..numbering.unknowns()].to_vec());
        let mut both = [0, 1].map(|_| vec![0.0; along.len()]);
        self.forces.add_products(&along, &mut both);
        both.map(|own| reduce::compressed(numbering, own))
    }

    fn products(&self, x: &[Complex64], transposed: bool) -> [Vec<Complex64>; 2] {
        let mut out = [&self.stiffness, &self.damping].map(|own| product(own, x, transposed));
        let re: Vec<f64> = x.iter().map(|x| x.re).collect();
        let im: Vec<f64> = x.iter().map(|x| x.im).collect();
        let units = [(1.0, 0.0), (0.0, 1.0)].map(|(re, im)| Complex64::new(re, im));
        for (along, unit) in [re, im].into_iter().zip(units) {
            for (out, own) in out.iter_mut().zip(self.of_strains(&along)) {
                (out.iter_mut().zip(own)).for_each(|(out, x)| *out += unit * x);
            }
        }
        out
    }
}

impl Matrices {
    /// Those at a state; without damping, D is zero.
    pub(super) fn new(at: At<f64>, damped: bool) -> Self {
        let order = at.numbering.unknowns() + at.numbering.constraints();
        let pattern = Pattern::record(order, |to: &mut dyn Emit<f64>| {
            emit_pencil(at, Weights::at(1.0), to);
        });
        let nodal = flexible::nodal_unknowns(at.model, at.numbering);
        let pattern = pattern.with_pivots(KnownPivots {
            short: Vec::new(),
            inner: nodal.into_iter().map(|i| (i, i)).collect(),
        });
        let of = |stiffness: f64, damping: f64, mass: f64| {
            let weights = Weights {
                stiffness,
                damping,
                mass,
            };
            assembled(at, weights, &pattern)
        };
        Self {
            unknowns: at.numbering.unknowns(),
            stiffness: of(1.0, 0.0, 0.0),
            damping: of(0.0, if damped { 1.0 } else { 0.0 }, 0.0),
            mass: of(0.0, 0.0, 1.0),
            left_out: Vec::new(),
            by_strains: None,
            pattern,
        }
    }

    /// With products of K and D that take the strain energies of finite elements by strains.
    pub(super) fn with_strains(mut self, at: At<f64>, damped: bool) -> Self {
        self.by_strains = ByStrains::new(at, &self.pattern, damped);
        self
    }

    /// K x and D x, or those of the transposes.
    pub(super) fn products(&self, x: &[Complex64], transposed: bool) -> [Vec<Complex64>; 2] {
        match &self.by_strains {
            Some(own) => own.products(x, transposed),
            None => [&self.stiffness, &self.damping].map(|own| product(own, x, transposed)),
        }
    }

    /// Whether the machine has finite elements.
    pub(super) fn have_nodes(&self) -> bool {
        self.pattern.known_pivots().is_some()
    }

    /// Number of unknowns and multipliers.
    pub(super) fn order(&self) -> usize {
        self.pattern.order()
    }

    /// The largest k_ii / m_ii \[1/s²\].
    pub(super) fn stiffest(&self) -> f64 {
        let [stiff, heavy] = [&self.stiffness, &self.mass].map(diagonal);
        let rates = stiff.iter().zip(&heavy).map(|(k, m)| k / m);
        rates.filter(|rate| rate.is_finite()).fold(0.0, f64::max)
    }

    /// Removes the motions that are left out from y.
    pub(super) fn leave_out<S: Scalar>(&self, y: &mut [S]) {
        for [motion, heavy] in &self.left_out {
            let products = heavy.iter().zip(y.iter());
            let along = products.fold(S::zero(), |sum, (m, y)| sum + *y * *m);
            (y.iter_mut().zip(motion)).for_each(|(y, own)| *y -= along * *own);
        }
    }

    /// K + s D + s² M.
    fn combined<S: Scalar>(&self, s: S) -> SparseMatrix<S> {
        let mut out = SparseMatrix::new(self.stiffness.pattern.clone());
        let parts = self.stiffness.values.iter().zip(&self.damping.values);
        for (out, ((&k, &d), &m)) in (out.values.iter_mut()).zip(parts.zip(&self.mass.values)) {
            *out = (s * m + d) * s + k;
        }
        out
    }

    /// Factors of K + s D + s² M.
    ///
    /// # Errors
    /// A singular matrix.
    pub(super) fn factors<S: SolveScalar>(&self, s: S) -> Result<SparseLu<S>, SingularMatrix> {
        let matrix = self.combined(s);
        if self.have_nodes() {
            let mut factors = SparseLu::new(&self.pattern);
            if factors.factorise(&matrix).is_ok() && factors.solve_soundly(&matrix) {
                return Ok(factors);
            }
        }
        // Beyond the lowest modes a matrix is not definite: then pivots are searched.
        let mut factors = SparseLu::new(&self.pattern.clone().with_pivots(KnownPivots::default()));
        factors.factorise(&matrix)?;
        Ok(factors)
    }
}

/// The entries a_ii.
fn diagonal(matrix: &SparseMatrix<f64>) -> Vec<f64> {
    let (starts, rows) = (matrix.pattern.column_starts(), matrix.pattern.rows());
    let one = |j: usize| {
        let place = (starts[j]..starts[j + 1]).find(|&k| rows[k] == j);
        place.map_or(0.0, |k| matrix.values[k])
    };
    (0..matrix.pattern.order()).map(one).collect()
}

/// A x for a real matrix and a complex vector; Aᵀ x if `transposed`.
pub(super) fn product(
    matrix: &SparseMatrix<f64>,
    x: &[Complex64],
    transposed: bool,
) -> Vec<Complex64> {
    let mut out = vec![Complex64::new(0.0, 0.0); matrix.pattern.order()];
    let (starts, rows) = (matrix.pattern.column_starts(), matrix.pattern.rows());
    for j in 0..out.len() {
        for k in starts[j]..starts[j + 1] {
            let (to, from) = if transposed {
                (j, rows[k])
            } else {
                (rows[k], j)
            };
            out[to] += x[from] * matrix.values[k];
        }
    }
    out
}
