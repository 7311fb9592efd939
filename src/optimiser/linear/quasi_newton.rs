//! Positive definite approximation of the Hessian of the Lagrangian.

use std::borrow::Cow;

use nalgebra::{Cholesky, DMatrix, DVector};
use serde::{Deserialize, Serialize};

use crate::constants::{DENSE, HALF_OF_DIGITS, ROUND_OFF};
use crate::linear::compact::Compact;
use crate::linear::curvature::Curvature;

/// Factor of the scale σ when pairs without positive curvature clear the memory. Without this, five problems
/// of the bed are lost, seven by the trust region.
const FLATTER: f64 = 0.1;

/// Share of a change of the gradient that a separable model may leave unexplained.
const FORETOLD: f64 = 0.2;

/// BFGS matrix B, built from pairs s = x₊ − x and y = ∇L(x₊) − ∇L(x).
///
/// B starts from (sᵀy/sᵀs) I of the newest pair, to which all kept pairs are applied in order
/// (Nocedal & Wright 2006, eqs. 6.19, 6.20 and 7.24). A pair without positive curvature is skipped;
/// two in succession clear the memory.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct QuasiNewton {
    n: usize,
    dense: bool,
    /// Whether the limited memory starts from a diagonal.
    #[serde(default)]
    diagonal: bool,
    memory: usize,
    sigma: f64,
    /// Diagonal that takes the place of σ I; empty if there is none.
    #[serde(default)]
    base: Vec<f64>,
    /// Diagonal by a model of the program, which takes the place of `base`; empty if `base`
    /// predicted the newest pair better.
    #[serde(default)]
    model: Vec<f64>,
    /// Whether the model foretells so much that the pairs add only the rest.
    #[serde(default)]
    structured: bool,
    pairs: Vec<Pair>,
    skipped: usize,
    /// Second derivatives at the present point, where the program gives them. They take the place of
    /// all pairs.
    #[serde(skip)]
    exact: Option<Curvature>,
    #[serde(skip)]
    cached: Cached,
}

/// What follows from the pairs and is computed once.
#[derive(Clone, Debug, Default)]
struct Cached {
    dense: Option<DMatrix<f64>>,
    compact: Option<Compact>,
    exact_diagonal: Option<DVector<f64>>,
}

/// Two matrices of the same pairs are equal, whatever is cached.
impl PartialEq for Cached {
    fn eq(&self, _: &Cached) -> bool {
        true
    }
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Pair {
    #[serde(with = "as_list")]
    s: DVector<f64>,
    #[serde(with = "as_list")]
    y: DVector<f64>,
    /// The part of y that the separable model foretold; empty without a model.
    #[serde(with = "as_list", default = "empty")]
    foretold: DVector<f64>,
}

fn empty() -> DVector<f64> {
    DVector::zeros(0)
}

/// A separable model of the Lagrangian: its second derivatives at the newest point, and the change
/// of its gradient over the newest step.
pub(crate) struct Separable {
    pub curvature: Vec<f64>,
    pub change: DVector<f64>,
}

/// B = σ I + W diag(λ − σ) Wᵀ with orthonormal columns W.
pub(crate) struct Spectrum {
    pub sigma: f64,
    pub vectors: DMatrix<f64>,
    /// λ, positive.
    pub values: DVector<f64>,
}

impl QuasiNewton {
    /// The identity, of order `n`, kept dense up to `dense_limit`.
    pub(crate) fn new(n: usize, dense_limit: usize, memory: usize) -> QuasiNewton {
        let dense = n <= dense_limit;
        let memory = if dense { DENSE } else { memory.max(1) };
        let pairs = Vec::new();
        QuasiNewton {
            n,
            dense,
            diagonal: false,
            memory,
            sigma: 1.0,
            base: Vec::new(),
            model: Vec::new(),
            structured: false,
            pairs,
            skipped: 0,
            exact: None,
            cached: Cached::default(),
        }
    }

    /// Sets the second derivatives at the present point.
    pub(crate) fn set_exact(&mut self, exact: Option<Curvature>) {
        self.cached.exact_diagonal = exact.as_ref().map(Curvature::least_diagonal);
        self.exact = exact;
    }

    /// The second derivatives at the present point, if they are known.
    pub(crate) fn exact(&self) -> Option<&Curvature> {
        self.exact.as_ref()
    }

    /// The matrix without cached values.
    pub(crate) fn stored(&self) -> QuasiNewton {
        QuasiNewton {
            cached: Cached::default(),
            exact: None,
            pairs: self.pairs.clone(),
            base: self.base.clone(),
            model: self.model.clone(),
            ..*self
        }
    }

    /// Sets the scale σ that B has without pairs.
    pub(crate) fn set_scale(&mut self, sigma: f64) {
        self.sigma = sigma;
        self.base.clear();
        self.model.clear();
        self.structured = false;
        self.cached = Cached::default();
    }

    /// The fault of a matrix that was read, for a program of at most `variables` free variables.
    pub(crate) fn fault(&self, variables: usize) -> Option<String> {
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
    pub(crate) fn order(&self) -> usize {
        self.n
    }

    /// Whether no pair is kept.
    pub(crate) fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Forgets all pairs; the scale of B remains.
    pub(crate) fn reset(&mut self) {
        self.pairs.clear();
        self.base.clear();
        self.model.clear();
        self.structured = false;
        self.skipped = 0;
        self.cached = Cached::default();
    }

    /// Lets the limited memory start from a diagonal that keeps the curvature of all pairs.
    pub(crate) fn with_diagonal(mut self) -> QuasiNewton {
        self.diagonal = !self.dense;
        self
    }

    /// The diagonal of the BFGS update of D (Gilbert & Lemaréchal 1989, section 4).
    fn update_base(&mut self, s: &DVector<f64>, y: &DVector<f64>) {
        let sy = s.dot(y);
        if self.base.is_empty() {
            self.base = vec![self.sigma; self.n];
        }
        let base = &mut self.base;
        let sds: f64 = (0..s.len()).map(|i| s[i] * s[i] * base[i]).sum();
        for i in 0..s.len() {
            let d = base[i];
            let updated = d - (d * s[i]).powi(2) / sds + y[i] * y[i] / sy;
            base[i] = updated.max(f64::EPSILON * d);
        }
    }

    /// Adds a pair.
    pub(crate) fn update(&mut self, s: DVector<f64>, y: DVector<f64>) {
        self.update_with(s, y, None);
    }

    /// Adds a pair. With a separable model D that foretells most of y, B starts from D, and the
    /// pairs give it only what D does not foretell: y = D s + (y − foretold), with D at the present
    /// point (structured secant method, Dennis, Martínez & Tapia 1989).
    pub(crate) fn update_with(
        &mut self,
        s: DVector<f64>,
        y: DVector<f64>,
        model: Option<Separable>,
    ) {
        let (sy, ss, yy) = (s.dot(&y), s.norm_squared(), y.norm_squared());
        if !(sy.is_finite() && ss.is_finite() && yy.is_finite()) || ss == 0.0 {
            return;
        }
        // The cosine of step and gradient difference. How small it may be does not decide.
        if sy <= HALF_OF_DIGITS * (ss * yy).sqrt() {
            self.skipped += 1;
            if self.skipped >= 2 {
                self.reset();
                self.sigma = (FLATTER * self.sigma).max(f64::MIN_POSITIVE);
            }
            return;
        }
        self.skipped = 0;
        self.sigma = (sy / ss).clamp(1e-8, 1e8);
        self.model.clear();
        self.structured = false;
        let mut foretold = empty();
        if let Some(model) = model {
            self.structured = (&y - &model.change).norm_squared() <= FORETOLD * FORETOLD * yy;
            if self.structured {
                self.model = model.curvature;
            } else {
                self.choose_base(&s, &y, &model.curvature);
            }
            foretold = model.change;
        }
        if self.diagonal {
            self.update_base(&s, &y);
        }
        self.pairs.push(Pair { s, y, foretold });
        if self.pairs.len() > self.memory {
            self.pairs.remove(0);
        }
        self.cached = Cached::default();
    }

    /// Takes `model` as diagonal if it predicts the pair better than the kept one. A diagonal D
    /// predicts it well if D s is nearly a multiple of y. The factor of `model` is the geometric
    /// mean of those that the pair demands of D and of D⁻¹.
    fn choose_base(&mut self, s: &DVector<f64>, y: &DVector<f64>, model: &[f64]) {
        let fit = |d: &dyn Fn(usize) -> f64| {
            let all = 0..s.len();
            let (sds, ydy) = all.fold((0.0, 0.0), |(a, b), i| {
                (a + s[i] * s[i] * d(i), b + y[i] * y[i] / d(i))
            });
            (sds * ydy, (ydy / sds).sqrt())
        };
        let kept = &self.base;
        let (misfit, _) = fit(&|i| kept.get(i).copied().unwrap_or(1.0));
        let (of_model, factor) = fit(&|i| model[i]);
        if !self.dense && of_model < misfit {
            self.model = model.iter().map(|d| d * factor).collect();
        }
    }

    /// The steps and changes of the gradient that B satisfies one after the other.
    fn secants(&self) -> Vec<(&DVector<f64>, Cow<'_, DVector<f64>>)> {
        let pairs = self.pairs.iter();
        pairs.map(|pair| (&pair.s, self.change(pair))).collect()
    }

    /// The change y, or with a model D that foretells most of it D s + (y − foretold).
    fn change<'p>(&self, pair: &'p Pair) -> Cow<'p, DVector<f64>> {
        let (s, y) = (&pair.s, &pair.y);
        if !self.structured {
            return Cow::Borrowed(y);
        }
        let of_model = DVector::from_fn(self.n, |i, _| self.model[i] * s[i]);
        if pair.foretold.len() == self.n {
            let whole = &of_model + y - &pair.foretold;
            if s.dot(&whole) > HALF_OF_DIGITS.sqrt() * s.norm() * whole.norm() {
                return Cow::Owned(whole);
            }
        }
        Cow::Owned(of_model)
    }

    /// Whether B is kept as a dense matrix.
    pub(crate) fn is_dense(&self) -> bool {
        self.dense
    }

    /// B by the eigenvalues that differ from σ, and their eigenvectors.
    pub(crate) fn spectrum(&mut self) -> Spectrum {
        let sigma = self.sigma;
        let n = self.n;
        let none = Spectrum {
            sigma,
            vectors: DMatrix::zeros(n, 0),
            values: DVector::zeros(0),
        };
        let Some(compact) = self.compact() else {
            return none;
        };
        let (q, r) = compact.u.clone().qr().unpack();
        let Some(inner) = compact.factors.solve(&r.transpose()) else {
            return none;
        };
        let mut core = -(r * inner);
        for i in 0..core.nrows() {
            core[(i, i)] += sigma;
        }
        let eigen = ((&core + core.transpose()) * 0.5).symmetric_eigen();
        let least = ROUND_OFF * sigma;
        Spectrum {
            sigma,
            vectors: q * eigen.eigenvectors,
            values: eigen.eigenvalues.map(|v| v.max(least)),
        }
    }

    /// B as a dense matrix.
    pub(crate) fn dense(&mut self) -> &DMatrix<f64> {
        let b = match self.cached.dense.take() {
            Some(b) => b,
            None => self.assembled(),
        };
        self.cached.dense.insert(b)
    }

    fn assembled(&self) -> DMatrix<f64> {
        let mut b = DMatrix::from_diagonal(&self.base());
        for (s, y) in self.secants() {
            let bs = &b * s;
            b.ger(-1.0 / s.dot(&bs), &bs, &bs, 1.0);
            b.ger(1.0 / y.dot(s), &y, &y, 1.0);
        }
        b
    }

    /// Product B v.
    pub(crate) fn multiply(&mut self, v: &DVector<f64>) -> DVector<f64> {
        if self.dense {
            return self.dense() * v;
        }
        let sigma = self.sigma;
        match self.compact() {
            Some(compact) => compact.multiply(v),
            None => v * sigma,
        }
    }

    /// Diagonal entry `i` of B.
    pub(crate) fn diagonal(&mut self, i: usize) -> f64 {
        if let Some(diagonal) = &self.cached.exact_diagonal {
            return diagonal[i];
        }
        if self.dense {
            return self.dense()[(i, i)];
        }
        let sigma = self.sigma;
        match self.compact() {
            Some(compact) => {
                let row = compact.u.row(i).transpose();
                let inner = compact.factors.solve(&row);
                compact.base[i] - inner.map_or(0.0, |inner| row.dot(&inner))
            }
            None => sigma,
        }
    }

    /// The diagonal D of the compact form.
    pub(crate) fn base(&self) -> DVector<f64> {
        if !self.model.is_empty() {
            DVector::from_column_slice(&self.model)
        } else if self.base.is_empty() {
            DVector::from_element(self.n, self.sigma)
        } else {
            DVector::from_column_slice(&self.base)
        }
    }

    /// B in its compact form; `None` without pairs.
    pub(crate) fn compact(&mut self) -> Option<&Compact> {
        if self.pairs.is_empty() {
            return None;
        }
        if self.cached.compact.is_none() {
            let secants = self.secants();
            let pairs = secants.iter().map(|(s, y)| (*s, y.as_ref()));
            self.cached.compact = Some(Compact::new(self.base(), pairs));
        }
        self.cached.compact.as_ref()
    }

    /// B + diag(`d`) as a matrix.
    pub(crate) fn dense_plus(&mut self, d: &DVector<f64>) -> DMatrix<f64> {
        let mut h = self.dense().clone();
        for i in 0..self.n {
            h[(i, i)] += d[i];
        }
        h
    }

    /// B⁻¹ `force`; `None` if rounding has destroyed the definiteness of B.
    pub(crate) fn newton_step(&mut self, force: &DVector<f64>) -> Option<DVector<f64>> {
        if self.dense {
            return Cholesky::new(self.dense().clone()).map(|factor| factor.solve(force));
        }
        let sigma = self.sigma;
        let Some(compact) = self.compact() else {
            return Some(force / sigma);
        };
        compact.solve(force)
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
