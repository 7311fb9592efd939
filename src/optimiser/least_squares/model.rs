//! The quadratic model of a sum of squares: of Gauss and Newton, or with second derivatives from secants where these
//! foretell more (Dennis, Gay & Welsch 1981, *An adaptive nonlinear least-squares algorithm*, ACM TOMS 7).

use nalgebra::{DMatrix, DVector};

use super::spectrum::Spectrum;

/// How much worse a model must foretell than the other one to be replaced.
const WORSE: f64 = 1.5;

/// The model f(x + d) ≈ ‖r + J d‖² + ½ dᵀS d, S only where `with_second`.
#[derive(Clone)]
pub(crate) struct SquaresModel {
    r: DVector<f64>,
    j: DMatrix<f64>,
    /// The largest norms of the columns of J so far: units of the variables in which the region of
    /// trust is a ball (Moré 1978).
    sizes: DVector<f64>,
    second: DMatrix<f64>,
    with_second: bool,
}

impl SquaresModel {
    /// From the residuals at the first point.
    pub(crate) fn new(r: DVector<f64>, j: DMatrix<f64>) -> SquaresModel {
        let n = j.ncols();
        let mut model = SquaresModel {
            sizes: DVector::zeros(n),
            second: DMatrix::zeros(n, n),
            with_second: false,
            r,
            j,
        };
        model.measure();
        model
    }

    fn measure(&mut self) {
        for i in 0..self.sizes.len() {
            self.sizes[i] = self.sizes[i].max(self.j.column(i).norm());
        }
    }

    /// One unit of each variable of the ball in the program's; those without influence keep theirs.
    pub(crate) fn units(&self) -> DVector<f64> {
        let unit = |size: f64| if size > 0.0 { 1.0 / size } else { 1.0 };
        self.sizes.map(unit)
    }

    /// Length of a step in the units of the ball.
    pub(crate) fn length(&self, d: &DVector<f64>) -> f64 {
        d.component_div(&self.units()).norm()
    }

    /// First radius: the size of the point or, at the origin, that of the residuals.
    pub(crate) fn first_radius(&self, x: &DVector<f64>) -> f64 {
        let size = self.length(x);
        if size > 0.0 {
            size
        } else {
            self.r.norm().max(f64::MIN_POSITIVE)
        }
    }

    /// The Hessian of the model.
    pub(crate) fn hessian(&self) -> DMatrix<f64> {
        let h = 2.0 * self.j.tr_mul(&self.j);
        if self.with_second {
            h + &self.second
        } else {
            h
        }
    }

    /// The model in the units of the ball; `None` if its eigenvalues do not converge.
    pub(crate) fn spectrum(&self, g: &DVector<f64>) -> Option<Spectrum> {
        let units = self.units();
        let mut j = self.j.clone();
        for (i, mut column) in j.column_iter_mut().enumerate() {
            column *= units[i];
        }
        if !self.with_second {
            return Spectrum::of_squares(&j, &self.r);
        }
        let second = DMatrix::from_fn(units.len(), units.len(), |a, b| {
            self.second[(a, b)] * units[a] * units[b]
        });
        let h = 2.0 * j.tr_mul(&j) + second;
        Spectrum::of_matrix(&h, &g.component_mul(&units))
    }

    /// Whether the angle of the residuals to each column of J is right to the tolerance, if `force` is left of the
    /// gradient.
    pub(crate) fn is_orthogonal(&self, force: &DVector<f64>, tolerance: f64) -> bool {
        let size = 2.0 * self.r.norm();
        let columns = self.j.column_iter().zip(force.iter());
        { columns }.all(|(column, force)| force.abs() <= tolerance * size * column.norm())
    }

    /// Forgets the second derivatives.
    pub(crate) fn reset(&mut self) {
        self.second.fill(0.0);
        self.with_second = false;
    }

    /// Chooses the model that foretold better by how much the step `d` changes the objective, which has the
    /// gradient `g` here.
    pub(crate) fn judge(&mut self, g: &DVector<f64>, d: &DVector<f64>, change: f64) {
        let plain = g.dot(d) + (&self.j * d).norm_squared();
        let rest = 0.5 * d.dot(&(&self.second * d));
        let (of_plain, of_both) = ((change - plain).abs(), (change - plain - rest).abs());
        self.with_second = match self.with_second {
            true => of_both <= WORSE * of_plain,
            false => rest != 0.0 && of_plain > WORSE * of_both,
        };
    }

    /// Moves to the point after the step `d`, at which the residuals are `r` and their derivatives `j`. The
    /// gradient of the objective changed by `y`, that of the rows' part of the Lagrangian by `of_rows`.
    pub(crate) fn advance(
        &mut self,
        (r, j): (DVector<f64>, DMatrix<f64>),
        d: &DVector<f64>,
        (y, of_rows): (&DVector<f64>, &DVector<f64>),
    ) {
        let wanted = 2.0 * (j.tr_mul(&r) - self.j.tr_mul(&r)) + of_rows;
        let known = &self.second * d;
        // Large second derivatives of an earlier point must not outlive small residuals.
        let (asked, has) = (d.dot(&wanted).abs(), d.dot(&known).abs());
        let shrink = if asked < has { asked / has } else { 1.0 };
        self.second *= shrink;
        let w = wanted - known * shrink;
        let yd = y.dot(d);
        if yd > f64::EPSILON.sqrt() * y.norm() * d.norm() {
            self.second.ger(1.0 / yd, &w, y, 1.0);
            self.second.ger(1.0 / yd, y, &w, 1.0);
            self.second.ger(-w.dot(d) / (yd * yd), y, y, 1.0);
        }
        (self.r, self.j) = (r, j);
        self.measure();
    }
}
