//! The sparse matrix of the quasi-static start, without derivatives of M and G in the rows of rigid motions; and that of
//! rest, [K + σ M̃, Gᵀ; G, 0] with the metric M̃ of [`RigidMetric`].

use super::equations::{Layout, State};
use super::pencil::{At, emit_at};
use super::turning::Weights;
use crate::linalg::{Emit, KnownPivots, Pattern, SingularMatrix, SparseLu, SparseMatrix};
use crate::math::Scalar;
use crate::model::{Model, RigidBody, Role};
use crate::system::bodies::BodyMotion;
use crate::system::emit_bodies::{Rates, emit_force_balance};
use crate::system::flexible;
use crate::system::in_motion::InMotion;
use crate::system::joints;
use crate::system::kkt::{emit_gradients, emit_reaction_jacobian, emit_transposed_gradients};
use crate::system::loads::{self, LoadEntries};
use crate::system::placement::extent;
use crate::system::reduce::emit_reduced;

/// Parts of rows and columns in velocity numbering: positions, accelerations, velocities.
const PARTS: usize = 3;

/// The matrix with its factors.
pub(super) struct Factors {
    places: Vec<Option<usize>>,
    matrix: SparseMatrix<f64>,
    factors: SparseLu<f64>,
}

impl Factors {
    /// Plans the factors of the equations at any state; `x` is one.
    pub(super) fn plan(layout: &Layout, model: &Model<f64>, x: &State<f64>) -> Self {
        let places = places(layout);
        let nodal = flexible::nodal_unknowns(model, layout.numbering);
        let pattern = Pattern::record(layout.order(), |emit: &mut dyn Emit<f64>| {
            emit_chosen(&places, layout, (model, x, 0.0), emit);
        });
        let pattern = pattern.with_pivots(KnownPivots {
            short: Vec::new(),
            inner: nodal.into_iter().map(|i| (i, i)).collect(),
        });
        Self {
            factors: SparseLu::new(&pattern),
            matrix: SparseMatrix::new(pattern),
            places,
        }
    }

    /// Makes the factors at a state. The layout is that of the plan. At rest, `shift` is σ \[1/s²\].
    ///
    /// # Errors
    /// A singular matrix.
    pub(super) fn make(
        &mut self,
        layout: &Layout,
        model: &Model<f64>,
        (x, shift): (&State<f64>, f64),
    ) -> Result<(), SingularMatrix> {
        let places = &self.places;
        (self.matrix).assemble(|emit| emit_chosen(places, layout, (model, x, shift), emit));
        self.factors.factorise(&self.matrix)
    }

    /// Solves in place.
    pub(super) fn solve(&mut self, b: &mut [f64]) {
        self.factors.solve(b);
    }

    /// Solves with the transpose in place.
    pub(super) fn solve_transposed(&mut self, b: &mut [f64]) {
        self.factors.solve_transposed(b);
    }
}

impl std::fmt::Debug for Factors {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "factors of order {}", self.places.len())
    }
}

/// A metric of motions: that of the mass, regular where bodies have no mass or inertia.
pub(super) struct RigidMetric {
    mass: f64,
    inertia: f64,
}

impl RigidMetric {
    /// Part of the mean mass, and of its moment of inertia at the extent of the machine, that a body has at least.
    const LEAST: f64 = 1e-6;

    pub(super) fn of(model: &Model<f64>) -> Self {
        let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
        let mean = mass / model.bodies.len().max(1) as f64;
        let length = extent(model);
        Self {
            mass: Self::LEAST * mean,
            inertia: Self::LEAST * mean * length * length,
        }
    }

    /// Mass \[kg\] of a body, and the moment of inertia \[kg m²\] that it has in addition. The coordinate of a coupling is an
    /// angle in most cases, and its mass an inertia. Elastic coordinates have their own mass alone: they are displacements and angles,
    /// and stiffness makes their matrices regular.
    pub(super) fn of_body(&self, body: &RigidBody<f64>) -> [f64; 2] {
        match body.role {
            Role::Elastic => [body.mass, 0.0],
            role if role.is_angle() => [body.mass + self.inertia, self.inertia],
            _ => [body.mass + self.mass, self.inertia],
        }
    }
}

fn emit_chosen(
    places: &[Option<usize>],
    layout: &Layout,
    at: (&Model<f64>, &State<f64>, f64),
    emit: &mut dyn Emit<f64>,
) {
    let mut chosen = Chosen { places, emit };
    emit_reduced(layout.numbering, PARTS, &mut chosen, |emit| {
        emit_matrix(layout, at, emit);
    });
}

/// The place of each reduced row or column among the unknowns; `None` of those that are no
/// unknowns.
fn places(layout: &Layout) -> Vec<Option<usize>> {
    let (nu, nc) = (layout.numbering.unknowns(), layout.numbering.constraints());
    let [y, a, v, lambda, sigma, tau] = layout.groups();
    let mut out = vec![None; PARTS * (nu + nc)];
    let mut set = |from: usize, to: usize| out[from] = Some(to);
    for i in 0..nu {
        set(i, y.start + i);
    }
    for (i, &unknown) in layout.rigid.iter().enumerate() {
        set(nu + unknown, a.start + i);
        set(2 * nu + unknown, v.start + i);
    }
    let rows = PARTS * nu;
    for i in 0..nc {
        set(rows + i, lambda.start + i);
    }
    for (i, &row) in layout.kept.iter().enumerate() {
        set(rows + nc + row, sigma.start + i);
        set(rows + 2 * nc + row, tau.start + i);
    }
    out
}

/// Passes entries of the unknowns on.
struct Chosen<'a, S> {
    places: &'a [Option<usize>],
    emit: &'a mut dyn Emit<S>,
}

impl<S: Scalar> Emit<S> for Chosen<'_, S> {
    fn add(&mut self, row: usize, column: usize, value: S) {
        if let (Some(row), Some(column)) = (self.places[row], self.places[column]) {
            self.emit.add(row, column, value);
        }
    }
}

/// Passes the columns of rigid bodies on.
struct OfRigid<'a> {
    elastic: &'a [bool],
    emit: &'a mut dyn Emit<f64>,
}

impl Emit<f64> for OfRigid<'_> {
    fn add(&mut self, row: usize, column: usize, value: f64) {
        if !self.elastic[column] {
            self.emit.add(row, column, value);
        }
    }
}

/// The rows of the balance and of the constraints.
fn emit_balance<S: Scalar>(
    layout: &Layout,
    (model, x): (&Model<S>, &State<S>),
    emit: &mut dyn Emit<S>,
) {
    let numbering = layout.numbering;
    let nv = numbering.velocities();
    let (y, v, lambda) = (0, 2 * nv, 3 * nv);
    let (mut motions, mut gradients) = (Vec::new(), Vec::new());
    let speeds = layout.of_rigid(&x.v);
    BodyMotion::all(numbering, &x.q, &speeds, &mut motions);
    let here = InMotion::new(model, numbering, &motions, S::zero());
    joints::gradients(&here, &mut gradients);
    layout.left_out.clear_gradients(&mut gradients);
    let rates = Rates {
        by_state: S::zero(),
        h: S::one(),
    };
    emit_force_balance(&here, (y, v), rates, emit);
    let accelerations = layout.of_rigid(&x.a);
    let at = (&motions[..], &accelerations[..]);
    let whole = (S::one(), S::one());
    flexible::emit_force_balances((model, numbering), at, (y, y, v), whole, emit);
    let to = LoadEntries {
        row: y,
        y,
        v,
        by_y: -S::one(),
        by_v: -S::one(),
    };
    loads::emit_jacobian(&here, &to, emit);
    emit_reaction_jacobian(&here, &x.lambda, (y, y), S::one(), emit);
    emit_transposed_gradients(model, numbering, &gradients, (y, lambda), S::one(), emit);
    emit_gradients(model, numbering, &gradients, (lambda, y), emit);
    for row in layout.left_out.numbers() {
        emit.add(lambda + row, lambda + row, S::one());
    }
}

fn emit_matrix(
    layout: &Layout,
    (model, x, shift): (&Model<f64>, &State<f64>, f64),
    emit: &mut dyn Emit<f64>,
) {
    let numbering = layout.numbering;
    match &layout.turning {
        Some(turning) => {
            let at = At::rest(layout, model, x, Some(turning));
            let lambda = PARTS * numbering.velocities();
            emit_at(at, Weights::stiffness(), lambda, emit);
        }
        None => emit_balance(layout, (model, x), emit),
    }
    let (nv, nc) = (numbering.velocities(), numbering.constraints());
    let (y, a, v, lambda) = (0, nv, 2 * nv, 3 * nv);
    let (sigma, tau) = (lambda + nc, lambda + 2 * nc);
    let (mut motions, mut gradients) = (Vec::new(), Vec::new());
    let speeds = layout.of_rigid(&x.v);
    BodyMotion::all(numbering, &x.q, &speeds, &mut motions);
    let of = (model, numbering);
    if layout.is_rest() {
        let metric = RigidMetric::of(model);
        for (i, body) in model.bodies.iter().enumerate() {
            let (o, [mass, inertia]) = (numbering.velocity(i), metric.of_body(body));
            emit.add_identity(y + o, y + o, shift * mass);
            emit.add_block(y + o + 3, y + o + 3, &(body.inertia * shift));
            emit.add_identity(y + o + 3, y + o + 3, shift * inertia);
        }
        flexible::emit_mass(of, &motions, (y, y), shift, emit);
        return;
    }

    let here = InMotion::new(model, numbering, &motions, 0.0);
    joints::gradients(&here, &mut gradients);
    layout.left_out.clear_gradients(&mut gradients);
    let mut elastic = vec![false; 3 * nv];
    for (carrier, k) in model.flexible.iter().flat_map(|body| body.places()) {
        let at = numbering.velocity(carrier) + k;
        for start in [y, a, v] {
            elastic[start + at] = true;
        }
    }
    let parts = [
        (y, a, None),
        (a, y, Some((&x.sigma, sigma))),
        (v, v, Some((&x.tau, tau))),
    ];
    for (row, column, multipliers) in parts {
        let mut of_rigid = OfRigid {
            elastic: &elastic,
            emit: &mut *emit,
        };
        for (i, body) in model.bodies.iter().enumerate() {
            let o = numbering.velocity(i);
            of_rigid.add_identity(row + o, column + o, body.mass);
            of_rigid.add_block(row + o + 3, column + o + 3, &body.inertia);
        }
        flexible::emit_mass(of, &motions, (row, column), 1.0, &mut of_rigid);
        if let Some((values, column)) = multipliers {
            let values = layout.of_kept(values);
            emit_reaction_jacobian(&here, &values, (row, y), 1.0, emit);
            emit_transposed_gradients(model, numbering, &gradients, (row, column), 1.0, emit);
        }
    }
    emit_gradients(model, numbering, &gradients, (sigma, a), emit);
    emit_gradients(model, numbering, &gradients, (tau, v), emit);
}
