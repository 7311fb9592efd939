//! Positive definite approximation of the Hessian of the Lagrangian.

use nalgebra::{Cholesky, DMatrix, DVector, Dyn, LU};
use serde::{Deserialize, Serialize};

/// Least cosine of step and gradient difference for which a pair is used.
const CURVATURE: f64 = 1.5e-8;

/// Factor of the scale σ when pairs without positive curvature clear the memory.
const FLATTER: f64 = 0.1;

/// Least scale. It allows steps of 1e20 gradients in an unbounded program.
const FLATTEST: f64 = 1e-20;

/// Largest number of pairs from which a dense matrix is rebuilt.
const DENSE_PAIRS: usize = 200;

/// BFGS matrix B, built from pairs s = x₊ − x and y = ∇L(x₊) − ∇L(x).
///
/// B starts from (sᵀy/sᵀs) I of the newest pair, to which all kept pairs are applied in order
/// (Nocedal & Wright 2006, eqs. 6.19, 6.20 and 7.24). A pair without positive curvature is skipped;
/// two in succession clear the memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuasiNewton {
    n: usize,
    dense: bool,
    memory: usize,
    sigma: f64,
    pairs: Vec<Pair>,
    skipped: usize,
    #[serde(skip)]
    matrix: Option<DMatrix<f64>>,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Pair {
    #[serde(with = "as_list")]
    s: DVector<f64>,
    #[serde(with = "as_list")]
    y: DVector<f64>,
}

/// B = σ I + W diag(λ − σ) Wᵀ with orthonormal columns W.
pub(super) struct Spectrum {
    pub sigma: f64,
    pub vectors: DMatrix<f64>,
    /// λ, positive.
    pub values: DVector<f64>,
}

/// Least eigenvalue kept, relative to σ.
const LEAST_EIGENVALUE: f64 = 1e-10;

/// B + diag(d), ready to be solved with.
pub(super) enum Factor {
    Dense(Cholesky<f64, Dyn>),
    LowRank {
        diagonal: DVector<f64>,
        u: DMatrix<f64>,
        inner: LU<f64, Dyn, Dyn>,
    },
    Diagonal(DVector<f64>),
}

impl QuasiNewton {
    /// The identity, of order `n`, kept dense up to `dense_limit`.
    pub(super) fn new(n: usize, dense_limit: usize, memory: usize) -> QuasiNewton {
        let dense = n <= dense_limit;
        let memory = if dense { DENSE_PAIRS } else { memory.max(1) };
        let pairs = Vec::new();
        QuasiNewton {
            n,
            dense,
            memory,
            sigma: 1.0,
            pairs,
            skipped: 0,
            matrix: None,
        }
    }

    /// The matrix without cached values.
    pub(super) fn stored(&self) -> QuasiNewton {
        QuasiNewton {
            matrix: None,
            pairs: self.pairs.clone(),
            ..*self
        }
    }

    /// `factor` B.
    pub(super) fn times(&self, factor: f64) -> QuasiNewton {
        let mut b = self.stored();
        b.sigma *= factor;
        for pair in &mut b.pairs {
            pair.y *= factor;
        }
        b
    }

    /// Curvature sᵀy/sᵀs of the newest pair, if there is one.
    pub(super) fn newest_curvature(&self) -> Option<f64> {
        let pair = self.pairs.last()?;
        Some(pair.s.dot(&pair.y) / pair.s.norm_squared())
    }

    /// Sets the scale σ that B has without pairs.
    pub(super) fn set_scale(&mut self, sigma: f64) {
        self.sigma = sigma;
        self.matrix = None;
    }

    /// The fault of a matrix that was read, for a program of at most `variables` free variables.
    pub(super) fn fault(&self, variables: usize) -> Option<String> {
        if self.n > variables {
            let n = self.n;
            return Some(format!(
                "the quasi-Newton matrix is of order {n} instead of {variables}"
            ));
        }
        if !(self.sigma.is_finite() && self.sigma > 0.0) {
            return Some(format!(
                "the scale of the quasi-Newton matrix is {}",
                self.sigma
            ));
        }
        let all_finite = |v: &DVector<f64>| v.len() == self.n && v.iter().all(|x| x.is_finite());
        let bad = |p: &Pair| !(all_finite(&p.s) && all_finite(&p.y) && p.s.dot(&p.y) > 0.0);
        let k = self.pairs.iter().position(bad)?;
        Some(format!(
            "pair {k} of the quasi-Newton matrix has a wrong length, an infinite entry or no curvature"
        ))
    }

    /// Order of the matrix.
    pub(super) fn order(&self) -> usize {
        self.n
    }

    /// Whether no pair is kept.
    pub(super) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Forgets all pairs; the scale of B remains.
    pub(super) fn reset(&mut self) {
        self.pairs.clear();
        self.skipped = 0;
        self.matrix = None;
    }

    /// Adds a pair.
    pub(super) fn update(&mut self, s: DVector<f64>, y: DVector<f64>) {
        let (sy, ss, yy) = (s.dot(&y), s.norm_squared(), y.norm_squared());
        if !(sy.is_finite() && ss.is_finite() && yy.is_finite()) || ss == 0.0 {
            return;
        }
        if sy <= CURVATURE * (ss * yy).sqrt() {
            self.skipped += 1;
            if self.skipped >= 2 {
                self.reset();
                self.sigma = (FLATTER * self.sigma).max(FLATTEST);
            }
            return;
        }
        self.skipped = 0;
        self.sigma = (sy / ss).clamp(1e-8, 1e8);
        self.pairs.push(Pair { s, y });
        if self.pairs.len() > self.memory {
            self.pairs.remove(0);
        }
        self.matrix = None;
    }

    /// Whether B is kept as a dense matrix.
    pub(super) fn is_dense(&self) -> bool {
        self.dense
    }

    /// B by the eigenvalues that differ from σ, and their eigenvectors.
    pub(super) fn spectrum(&self) -> Spectrum {
        let none = Spectrum {
            sigma: self.sigma,
            vectors: DMatrix::zeros(self.n, 0),
            values: DVector::zeros(0),
        };
        if self.pairs.is_empty() {
            return none;
        }
        let (u, middle) = self.compact();
        let (q, r) = u.qr().unpack();
        let Some(inner) = middle.lu().solve(&r.transpose()) else {
            return none;
        };
        let mut core = -(r * inner);
        for i in 0..core.nrows() {
            core[(i, i)] += self.sigma;
        }
        let eigen = ((&core + core.transpose()) * 0.5).symmetric_eigen();
        let least = LEAST_EIGENVALUE * self.sigma;
        Spectrum {
            sigma: self.sigma,
            vectors: q * eigen.eigenvectors,
            values: eigen.eigenvalues.map(|v| v.max(least)),
        }
    }

    /// B as a dense matrix.
    pub(super) fn dense(&mut self) -> &DMatrix<f64> {
        let (n, sigma, pairs) = (self.n, self.sigma, &self.pairs);
        self.matrix.get_or_insert_with(|| {
            let mut b = DMatrix::from_diagonal_element(n, n, sigma);
            for Pair { s, y } in pairs {
                let bs = &b * s;
                b.ger(-1.0 / s.dot(&bs), &bs, &bs, 1.0);
                b.ger(1.0 / y.dot(s), y, y, 1.0);
            }
            b
        })
    }

    /// Product B v.
    pub(super) fn multiply(&mut self, v: &DVector<f64>) -> DVector<f64> {
        if self.dense {
            return self.dense() * v;
        }
        if self.pairs.is_empty() {
            return v * self.sigma;
        }
        let (u, middle) = self.compact();
        match middle.lu().solve(&(u.transpose() * v)) {
            Some(inner) => v * self.sigma - u * inner,
            None => v * self.sigma,
        }
    }

    /// B = σ I − U M⁻¹ Uᵀ with U = [σ S, Y] (Byrd, Nocedal & Schnabel 1994, eq. 2.17).
    fn compact(&self) -> (DMatrix<f64>, DMatrix<f64>) {
        let (n, k) = (self.n, self.pairs.len());
        let mut u = DMatrix::zeros(n, 2 * k);
        for (p, pair) in self.pairs.iter().enumerate() {
            u.column_mut(p).axpy(self.sigma, &pair.s, 0.0);
            u.column_mut(k + p).copy_from(&pair.y);
        }
        let mut middle = DMatrix::zeros(2 * k, 2 * k);
        for i in 0..k {
            for j in 0..k {
                middle[(i, j)] = self.sigma * self.pairs[i].s.dot(&self.pairs[j].s);
                if i > j {
                    let l = self.pairs[i].s.dot(&self.pairs[j].y);
                    middle[(i, k + j)] = l;
                    middle[(k + j, i)] = l;
                }
            }
            middle[(k + i, k + i)] = -self.pairs[i].s.dot(&self.pairs[i].y);
        }
        (u, middle)
    }

    /// B⁻¹ `force`; `None` if rounding has destroyed the definiteness of B.
    pub(super) fn newton_step(&mut self, force: &DVector<f64>) -> Option<DVector<f64>> {
        let mut step = DMatrix::from_column_slice(self.n, 1, force.as_slice());
        self.factor(&DVector::zeros(self.n))?.solve_mut(&mut step);
        Some(step.column(0).into_owned())
    }

    /// Factors B + diag(`d`), d ≥ 0; `None` if rounding has destroyed its definiteness.
    pub(super) fn factor(&mut self, d: &DVector<f64>) -> Option<Factor> {
        if self.dense {
            let mut h = self.dense().clone();
            for i in 0..self.n {
                h[(i, i)] += d[i];
            }
            return Cholesky::new(h).map(Factor::Dense);
        }
        let diagonal = d.map(|v| v + self.sigma);
        if self.pairs.is_empty() {
            return Some(Factor::Diagonal(diagonal));
        }
        let (u, middle) = self.compact();
        let mut scaled = u.clone();
        for i in 0..self.n {
            scaled.row_mut(i).scale_mut(1.0 / diagonal[i]);
        }
        let inner = (middle - u.transpose() * scaled).lu();
        inner
            .is_invertible()
            .then_some(Factor::LowRank { diagonal, u, inner })
    }
}

impl Factor {
    /// Solves (B + diag d) X = `rhs` in place.
    pub(super) fn solve_mut(&self, rhs: &mut DMatrix<f64>) {
        match self {
            Factor::Dense(cholesky) => cholesky.solve_mut(rhs),
            Factor::Diagonal(d) => divide_rows(rhs, d),
            Factor::LowRank { diagonal, u, inner } => {
                divide_rows(rhs, diagonal);
                let mut small = u.transpose() * &*rhs;
                if inner.solve_mut(&mut small) {
                    let mut correction = u * small;
                    divide_rows(&mut correction, diagonal);
                    *rhs += correction;
                }
            }
        }
    }
}

fn divide_rows(m: &mut DMatrix<f64>, d: &DVector<f64>) {
    for mut column in m.column_iter_mut() {
        column.component_div_assign(d);
    }
}

/// Vectors as plain lists of numbers.
mod as_list {
    use nalgebra::DVector;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub(crate) fn serialize<S: Serializer>(
        v: &DVector<f64>,
        serializer: S,
    ) -> Result<S::Ok, S::Error> {
        v.as_slice().serialize(serializer)
    }

    pub(crate) fn deserialize<'de, D: Deserializer<'de>>(
        input: D,
    ) -> Result<DVector<f64>, D::Error> {
        Vec::deserialize(input).map(DVector::from_vec)
    }
}
