//! A primal–dual point of the barrier problem and the quantities derived from it.

use nalgebra::{Cholesky, DVector, Dyn};

use crate::constants::{DENSE, SMALL_PART};
use crate::linear::jacobian::Jacobian;
use crate::linear::kkt_sparse::SparseKkt;
use crate::linear::quasi_newton::Separable;
use crate::program::{Derivatives, Point, Program};

/// Rows, slacks and bounds of the barrier problem.
///
/// The vector w = (x, s) holds the variables and one slack for each row that is not an equality.
pub(crate) struct Layout {
    pub n: usize,
    /// Rows that have a slack.
    pub slack_rows: Vec<usize>,
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
    /// Right-hand side of equality rows.
    target: DVector<f64>,
}

/// Primal–dual point.
#[derive(Clone, Debug)]
pub(crate) struct Iterate {
    pub point: Point,
    pub slopes: Derivatives,
    /// Slacks, of the length of [`Layout::slack_rows`].
    pub s: DVector<f64>,
    /// Multipliers of the rows.
    pub y: DVector<f64>,
    /// Multipliers of the bounds of w.
    pub zl: DVector<f64>,
    pub zu: DVector<f64>,
}

impl Layout {
    pub(crate) fn new(program: &Program<'_>) -> Layout {
        let (n, m) = (program.lower.len(), program.row_lower.len());
        let slack_rows: Vec<usize> = (0..m)
            .filter(|&j| program.row_lower[j] < program.row_upper[j])
            .collect();
        let join = |x: &DVector<f64>, rows: &DVector<f64>| {
            let slacks = slack_rows.iter().map(|&j| rows[j]);
            DVector::from_iterator(n + slack_rows.len(), x.iter().copied().chain(slacks))
        };
        Layout {
            n,
            lower: join(&program.lower, &program.row_lower),
            upper: join(&program.upper, &program.row_upper),
            target: program.row_lower.clone(),
            slack_rows,
        }
    }

    /// Number of entries of w.
    pub(crate) fn len(&self) -> usize {
        self.lower.len()
    }

    /// Row of entry `i` of w, if it is a slack.
    pub(crate) fn row_of(&self, i: usize) -> Option<usize> {
        (i >= self.n).then(|| self.slack_rows[i - self.n])
    }

    /// Distances of w from its bounds; infinite where there is none.
    pub(crate) fn distances(
        &self,
        x: &DVector<f64>,
        s: &DVector<f64>,
    ) -> (DVector<f64>, DVector<f64>) {
        let value = |i: usize| if i < self.n { x[i] } else { s[i - self.n] };
        let below = DVector::from_fn(self.len(), |i, _| value(i) - self.lower[i]);
        let above = DVector::from_fn(self.len(), |i, _| self.upper[i] - value(i));
        (below, above)
    }

    /// Residuals c(x) − s, or c(x) − target in equality rows.
    pub(crate) fn residual(&self, c: &DVector<f64>, s: &DVector<f64>) -> DVector<f64> {
        let mut r = c - &self.target;
        for (k, &j) in self.slack_rows.iter().enumerate() {
            r[j] = c[j] - s[k];
        }
        r
    }

    /// Barrier function φ = f − μ Σ ln(distance).
    pub(crate) fn barrier_function(
        &self,
        f: f64,
        x: &DVector<f64>,
        s: &DVector<f64>,
        mu: f64,
    ) -> f64 {
        let (below, above) = self.distances(x, s);
        let logarithm = |d: &f64| if d.is_finite() { d.ln() } else { 0.0 };
        f - mu * below.iter().chain(above.iter()).map(logarithm).sum::<f64>()
    }

    /// Moves `value` of slack `i` of w into the interior of its bounds.
    pub(crate) fn push_inside(&self, i: usize, value: f64, push: f64) -> f64 {
        let (l, u) = (self.lower[i], self.upper[i]);
        let width = u - l;
        let margin = |bound: f64| margin(bound, width, push);
        let mut inside = value;
        if l.is_finite() {
            inside = inside.max(l + margin(l));
        }
        if u.is_finite() {
            inside = inside.min(u - margin(u));
        }
        inside
    }
}

impl Iterate {
    /// Complementarity products' right-hand sides: gradient of the barrier terms over w.
    pub(crate) fn barrier_slope(&self, layout: &Layout, mu: f64) -> DVector<f64> {
        let (below, above) = layout.distances(&self.point.x, &self.s);
        DVector::from_fn(layout.len(), |i, _| {
            let f = if i < layout.n { self.slopes.g[i] } else { 0.0 };
            f - mu / below[i] + mu / above[i]
        })
    }

    /// Jᵀ y over w: Aᵀ y for the variables, −y for the slacks.
    pub(crate) fn row_force(&self, layout: &Layout) -> DVector<f64> {
        let x = self.slopes.a.tr_mul(&self.y);
        DVector::from_fn(layout.len(), |i, _| match layout.row_of(i) {
            None => x[i],
            Some(j) => -self.y[j],
        })
    }

    /// Σ = z_L/(w − l) + z_U/(u − w).
    pub(crate) fn sigma(&self, layout: &Layout) -> DVector<f64> {
        let (below, above) = layout.distances(&self.point.x, &self.s);
        DVector::from_fn(layout.len(), |i, _| {
            self.zl[i] / below[i] + self.zu[i] / above[i]
        })
    }

    /// Gradient of the Lagrangian over w.
    pub(crate) fn lagrangian_slope(&self, layout: &Layout) -> DVector<f64> {
        let mut slope = self.row_force(layout) - &self.zl + &self.zu;
        for i in 0..layout.n {
            slope[i] += self.slopes.g[i];
        }
        slope
    }

    /// Products of multipliers and distances, one per finite bound.
    pub(crate) fn products(&self, layout: &Layout) -> Vec<f64> {
        let (below, above) = layout.distances(&self.point.x, &self.s);
        let lower = (0..layout.len()).map(|i| (below[i], self.zl[i]));
        let upper = (0..layout.len()).map(|i| (above[i], self.zu[i]));
        lower
            .chain(upper)
            .filter(|(d, _)| d.is_finite())
            .map(|(d, z)| d * z)
            .collect()
    }

    /// Largest residual of the conditions perturbed by `mu`, scaled by the size of the multipliers
    /// (Wächter & Biegler 2006, eq. 5).
    pub(crate) fn residual(&self, layout: &Layout, mu: f64) -> f64 {
        let products = self.products(layout);
        let bounds: f64 = self.zl.lp_norm(1) + self.zu.lp_norm(1);
        let size = (self.y.len() + products.len()).max(1) as f64;
        let scale_s = ((self.y.lp_norm(1) + bounds) / size).max(100.0) / 100.0;
        let scale_c = (bounds / products.len().max(1) as f64).max(100.0) / 100.0;
        let stationarity = self.lagrangian_slope(layout).amax() / scale_s;
        let violation = layout.residual(&self.point.c, &self.s).amax();
        let complementarity = products.iter().map(|p| (p - mu).abs()).fold(0.0, f64::max);
        stationarity.max(violation).max(complementarity / scale_c)
    }

    /// Multipliers of the rows that minimise the norm of the gradient of the Lagrangian, or `None`
    /// if their system cannot be solved.
    pub(crate) fn least_squares_multipliers(&self, layout: &Layout) -> Option<DVector<f64>> {
        let a = &self.slopes.a;
        let (m, _) = a.shape();
        let force = |i: usize| self.zu[i] - self.zl[i];
        let x = DVector::from_fn(layout.n, |i, _| self.slopes.g[i] + force(i));
        let factor = NormalEquations::factor(layout, a)?;
        // Iterative refinement removes the errors of the squared condition number and of the small
        // shift.
        let mut y = DVector::zeros(m);
        for _ in 0..3 {
            let rest = &x + a.tr_mul(&y);
            let mut rhs = -(a * &rest);
            for (k, &j) in layout.slack_rows.iter().enumerate() {
                rhs[j] += force(layout.n + k) - y[j];
            }
            y += factor.solve(a, &rhs);
        }
        y.iter().all(|v| v.is_finite()).then_some(y)
    }
}

/// Multipliers of bounds stay within this factor of μ/distance (Wächter & Biegler 2006, eq. 16). Without
/// this the bed takes 1 % more evaluations and loses HS18.
const MULTIPLIER_BAND: f64 = 1e10;

impl Iterate {
    /// The Lagrangian as if every function were a sum of terms a/x where it falls with x, and of
    /// linear terms elsewhere, after the step `moved`. So are the compliance of a truss and the
    /// stresses in its bars, as functions of the areas, as far as forces stay (Fleury & Braibant
    /// 1986). `None` if nothing falls or a variable is not positive.
    pub(crate) fn reciprocal_model(&self, moved: &DVector<f64>) -> Option<Separable> {
        let x = &self.point.x;
        let before = x - moved;
        if !(x.min() > 0.0 && before.min() > 0.0) {
            return None;
        }
        let mut falling = self.slopes.g.map(|g| (-g).max(0.0));
        for k in 0..self.y.len() {
            for (i, slope) in self.slopes.a.row(k) {
                falling[i] += (-self.y[k] * slope).max(0.0);
            }
        }
        let curvature = |i: usize| 2.0 * falling[i] / x[i];
        let all = DVector::from_fn(x.len(), |i, _| curvature(i));
        let least = SMALL_PART * all.mean();
        if !(least > 0.0 && least.is_finite()) {
            return None;
        }
        let change = |i: usize| falling[i] * ((x[i] / before[i]).powi(2) - 1.0);
        Some(Separable {
            curvature: all.iter().map(|v| v.max(least)).collect(),
            change: DVector::from_fn(x.len(), |i, _| change(i)),
        })
    }

    /// Sets the multipliers of the rows by least squares, where these exist.
    pub(crate) fn estimate_multipliers(&mut self, layout: &Layout) {
        if let Some(y) = self.least_squares_multipliers(layout) {
            self.y = y;
        }
    }

    pub(crate) fn keep_multipliers_in_band(&mut self, layout: &Layout, mu: f64) {
        let (below, above) = layout.distances(&self.point.x, &self.s);
        let clamp = |z: &mut DVector<f64>, distance: &DVector<f64>| {
            for (z, d) in z.iter_mut().zip(distance.iter()) {
                if d.is_finite() {
                    *z = z.clamp(mu / (MULTIPLIER_BAND * d), MULTIPLIER_BAND * mu / d);
                }
            }
        };
        clamp(&mut self.zl, &below);
        clamp(&mut self.zu, &above);
    }
}

/// Factors of A Aᵀ + 1 for each row that has a slack. They are dense for few rows.
enum NormalEquations {
    Dense(Cholesky<f64, Dyn>),
    Sparse(Box<SparseKkt>),
}

impl NormalEquations {
    fn factor(layout: &Layout, a: &Jacobian) -> Option<NormalEquations> {
        let (m, n) = a.shape();
        if m.max(n) > DENSE {
            let mut d = DVector::zeros(m);
            for &j in &layout.slack_rows {
                d[j] = 1.0;
            }
            let factor = SparseKkt::factor(&DVector::from_element(n, 1.0), None, a, &d, None)?;
            return Some(NormalEquations::Sparse(Box::new(factor)));
        }
        let dense = a.to_dense();
        let mut normal = &dense * dense.transpose();
        for &j in &layout.slack_rows {
            normal[(j, j)] += 1.0;
        }
        for j in 0..m {
            normal[(j, j)] += 1e-12 * (1.0 + normal[(j, j)]);
        }
        Cholesky::new(normal).map(NormalEquations::Dense)
    }

    fn solve(&self, a: &Jacobian, r: &DVector<f64>) -> DVector<f64> {
        match self {
            NormalEquations::Dense(factor) => factor.solve(r),
            // [I Aᵀ; A −D] (x, y) = (0, −r) has (A Aᵀ + D) y = r.
            NormalEquations::Sparse(factor) => factor.solve(&DVector::zeros(a.shape().1), &-r).1,
        }
    }
}

/// Distance between `bound` and the start: `push` relative to max(1, |bound|), at most that part of
/// the distance of two bounds.
pub(crate) fn margin(bound: f64, width: f64, push: f64) -> f64 {
    let absolute = push * bound.abs().max(1.0);
    if width.is_finite() {
        absolute.min(push.min(0.49) * width)
    } else {
        absolute
    }
}
