//! What fitted numbers are worth: covariance, standard deviations, correlations, and what the data do not determine.

use nalgebra::{DMatrix, DVector};

use crate::constants::{HALF_OF_DIGITS, ROUND_OFF, SMALL_PART};

/// Where the covariance gets its scale from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variance {
    /// The residuals are divided by their standard deviations: s² = 1.
    Given,
    /// s² = rᵀr/(N − p), with p fitted directions.
    Estimated,
}

/// A fit at its end.
#[derive(Clone, Debug)]
pub struct Fit<'a> {
    /// Residuals r, each divided by the standard deviation of its datum.
    pub residuals: &'a [f64],
    /// ∂r/∂x, one row per residual.
    pub jacobian: &'a [Vec<f64>],
    /// Factor φ of each residual in the sum of the squares (φ r)².
    pub factors: &'a [f64],
    /// Typical sizes of the variables, in which their influence is compared.
    pub scales: &'a [f64],
    /// Variables that a bound holds.
    pub held: &'a [bool],
    /// Derivatives of the constraints that hold with equality here, one row each.
    pub rows: &'a [Vec<f64>],
    /// The scale of the covariance.
    pub variance: Variance,
}

/// What the fitted numbers are worth. With the fitted directions Z (the variables that no bound holds,
/// along the active constraints), the covariance is s² Z (ZᵀJᵀJZ)⁻¹Zᵀ (Seber & Wild 2003, *Nonlinear
/// Regression*, section 2.1.2). If the sum gives residuals other factors φ than their standard deviations do,
/// x moves by (ZᵀJᵀφ²JZ)⁻¹ZᵀJᵀφ² with the noise, and the covariance is that of this map.
#[derive(Clone, Debug, PartialEq)]
pub struct Statistics {
    /// N − p: residuals less determined directions.
    pub freedom: usize,
    /// rᵀr/(N − p), near one if the standard deviations of the data are right; `None` if p ≥ N.
    pub reduced_chi_square: Option<f64>,
    /// The covariance of the variables in their units. Entries of variables that are not determined are
    /// zero, as those of held ones.
    pub covariance: Vec<Vec<f64>>,
    /// Standard deviation of every variable; zero for held ones, `None` for those that the data do not determine or
    /// if there are no more residuals than directions.
    pub deviations: Vec<Option<f64>>,
    /// Directions that the data do not determine: pairs (variable, change in its scale) of the largest
    /// size one.
    pub undetermined: Vec<Vec<(usize, f64)>>,
}

impl Statistics {
    /// Correlation of two variables; `None` where a standard deviation is missing or zero.
    pub fn correlation(&self, i: usize, j: usize) -> Option<f64> {
        let positive = |i: usize| self.deviations[i].filter(|s| *s > 0.0);
        let found = self.covariance[i][j] / (positive(i)? * positive(j)?);
        Some(found.clamp(-1.0, 1.0))
    }
}

/// The worth of the numbers of `fit`; `None` if a singular value decomposition does not converge.
pub fn statistics(fit: &Fit<'_>) -> Option<Statistics> {
    let n = fit.scales.len();
    let free: Vec<usize> = (0..n).filter(|&i| !fit.held[i]).collect();
    let scaled = |rows: &[Vec<f64>]| {
        DMatrix::from_fn(rows.len(), free.len(), |k, c| {
            rows[k][free[c]] * fit.scales[free[c]]
        })
    };
    // Directions along the active constraints.
    let z = kernel(scaled(fit.rows))?;
    let largest = fit.factors.iter().copied().fold(0.0, f64::max);
    let factors: Vec<f64> = fit.factors.iter().map(|own| own / largest).collect();
    let mut j = scaled(fit.jacobian) * &z;
    for (k, &factor) in factors.iter().enumerate() {
        j.row_mut(k).scale_mut(factor);
    }
    let (rows, columns) = j.shape();
    let norms = DVector::from_fn(columns, |c, _| j.column(c).norm());
    let (seen, blind): (Vec<usize>, Vec<usize>) =
        (0..columns).partition(|&c| norms[c] > ROUND_OFF * norms.amax());
    // Unit columns: what matters little may be known well.
    let unit = DMatrix::from_fn(rows, seen.len(), |k, c| j[(k, seen[c])] / norms[seen[c]]);
    let svd = padded(unit).try_svd(false, true, f64::EPSILON, 0)?;
    let (v, sigma) = (svd.v_t?, svd.singular_values);
    let zero = HALF_OF_DIGITS * sigma.amax();
    let direction = |k: usize| {
        let mut inner = DVector::zeros(columns);
        for (c, &column) in seen.iter().enumerate() {
            inner[column] = v[(k, c)] / norms[column];
        }
        inner
    };
    let (determined, combined): (Vec<usize>, Vec<usize>) =
        (0..seen.len()).partition(|&k| sigma[k] > zero);
    let blind = blind.into_iter().map(|c| z.column(c).into_owned());
    let combined = combined.into_iter().map(|k| &z * direction(k));
    let undetermined: Vec<DVector<f64>> = blind.chain(combined).collect();
    let mut open = vec![false; n];
    let named = undetermined.iter().map(|direction| {
        let largest = direction.amax();
        let sign = direction[direction.iamax()].signum();
        let entries = direction.iter().enumerate();
        let parts = entries.filter(|(_, v)| v.abs() > SMALL_PART * largest);
        let parts: Vec<(usize, f64)> = parts.map(|(c, v)| (free[c], sign * v / largest)).collect();
        parts.iter().for_each(|&(i, _)| open[i] = true);
        parts
    });
    let undetermined: Vec<Vec<(usize, f64)>> = named.collect();
    let freedom = rows.saturating_sub(determined.len());
    let squares: f64 = fit.residuals.iter().map(|r| r * r).sum();
    let reduced = (freedom > 0).then(|| squares / freedom as f64);
    let scale = match fit.variance {
        Variance::Given => Some(1.0),
        Variance::Estimated => reduced,
    };
    let mut inverse = DMatrix::zeros(columns, columns);
    for &k in &determined {
        let w = direction(k) / sigma[k];
        inverse.ger(1.0, &w, &w, 1.0);
    }
    if factors.iter().any(|&factor| factor != 1.0) {
        let weighed = DMatrix::from_fn(rows, columns, |k, c| factors[k] * j[(k, c)]);
        let moved = inverse * weighed.transpose();
        inverse = &moved * moved.transpose();
    }
    let inverse = &z * inverse * z.transpose();
    let mut covariance = vec![vec![0.0; n]; n];
    for (a, &i) in free.iter().enumerate() {
        for (b, &j) in free
            .iter()
            .enumerate()
            .filter(|(_, j)| !open[i] && !open[**j])
        {
            covariance[i][j] =
                scale.unwrap_or(0.0) * inverse[(a, b)] * fit.scales[i] * fit.scales[j];
        }
    }
    let deviation = |i: usize| match (fit.held[i], open[i]) {
        (true, _) => Some(0.0),
        (false, true) => None,
        (false, false) => scale.map(|_| covariance[i][i].max(0.0).sqrt()),
    };
    Some(Statistics {
        freedom,
        reduced_chi_square: reduced,
        deviations: (0..n).map(deviation).collect(),
        undetermined,
        covariance,
    })
}

/// An orthonormal basis of the directions in which `rows` do not change.
fn kernel(rows: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let n = rows.ncols();
    if rows.nrows() == 0 || n == 0 {
        return Some(DMatrix::identity(n, n));
    }
    let svd = padded(rows).try_svd(false, true, f64::EPSILON, 0)?;
    let (v, sigma) = (svd.v_t?, svd.singular_values);
    let zero = HALF_OF_DIGITS * sigma.amax();
    let left: Vec<usize> = (0..n).filter(|&k| sigma[k] <= zero).collect();
    Some(DMatrix::from_fn(n, left.len(), |i, c| v[(left[c], i)]))
}

/// The same with rows of zeros, so that every direction has a singular value.
fn padded(matrix: DMatrix<f64>) -> DMatrix<f64> {
    match matrix.nrows() < matrix.ncols() {
        true => {
            let columns = matrix.ncols();
            matrix.resize_vertically(columns, 0.0)
        }
        false => matrix,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(times: &[f64]) -> Vec<Vec<f64>> {
        times.iter().map(|&t| vec![1.0, t]).collect()
    }

    fn of<'a>(jacobian: &'a [Vec<f64>], residuals: &'a [f64], held: &'a [bool]) -> Fit<'a> {
        Fit {
            residuals,
            jacobian,
            factors: &[1.0; 64][..residuals.len()],
            scales: &[1.0; 3][..held.len()],
            held,
            rows: &[],
            variance: Variance::Estimated,
        }
    }

    /// A straight line: var(slope) = s²/Σ(t − t̄)², var(intercept) = s²(1/N + t̄²/Σ(t − t̄)²), covariance
    /// −s² t̄/Σ(t − t̄)² (Draper & Smith, *Applied Regression Analysis*, section 1.4).
    #[test]
    fn of_a_line_in_closed_form() {
        let times = [0.0, 0.5, 1.1, 2.0, 2.5, 4.0];
        let residuals = [0.1, -0.2, 0.15, 0.05, -0.1, 0.02];
        let mean = times.iter().sum::<f64>() / 6.0;
        let spread: f64 = times.iter().map(|t| (t - mean).powi(2)).sum();
        let squares = residuals.iter().map(|r| r * r).sum::<f64>() / 4.0;
        let jacobian = line(&times);
        let mut fit = of(&jacobian, &residuals, &[false; 2]);
        fit.scales = &[1e-3, 1e5];
        let found = statistics(&fit).expect("converges");
        assert_eq!((found.freedom, found.undetermined.len()), (4, 0));
        assert!((found.reduced_chi_square.expect("enough") / squares - 1.0).abs() < 1e-14);
        let expected = [
            [
                squares * (1.0 / 6.0 + mean * mean / spread),
                -squares * mean / spread,
            ],
            [-squares * mean / spread, squares / spread],
        ];
        for i in 0..2 {
            for j in 0..2 {
                let error = found.covariance[i][j] / expected[i][j] - 1.0;
                assert!(error.abs() < 1e-12, "{i} {j}: {error:e}");
            }
            let own = found.deviations[i].expect("determined");
            assert!((own * own / expected[i][i] - 1.0).abs() < 1e-12);
        }
        let r = -mean / (spread / 6.0 + mean * mean).sqrt();
        assert!((found.correlation(0, 1).expect("both") - r).abs() < 1e-12);
        let given = statistics(&Fit {
            variance: Variance::Given,
            ..fit
        })
        .expect("converges");
        let ratio = given.covariance[1][1] * spread;
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    /// The mean of two values with different factors: x = Σ φ² d / Σ φ² has the variance σ² Σ φ⁴ / (Σ φ²)².
    #[test]
    fn of_factors_in_closed_form() {
        let jacobian = vec![vec![1.0]; 3];
        let residuals = [0.1, -0.2, 0.1];
        let factors = [3.0, 1.0, 0.5];
        let fit = Fit {
            factors: &factors,
            variance: Variance::Given,
            ..of(&jacobian, &residuals, &[false])
        };
        let power = |p: i32| factors.iter().map(|f: &f64| f.powi(p)).sum::<f64>();
        let found = statistics(&fit).expect("converges");
        let expected = power(4) / power(2).powi(2);
        assert!((found.covariance[0][0] / expected - 1.0).abs() < 1e-14);
        let reduced = found.reduced_chi_square.expect("enough data");
        assert!((reduced / 0.03 - 1.0).abs() < 1e-12, "{reduced}");
    }

    /// A held variable has no deviation, and that of the other one is smaller.
    #[test]
    fn a_bound_and_a_constraint_hold_what_they_hold() {
        let jacobian = line(&[0.0, 1.0, 2.0]);
        let residuals = [0.1, -0.2, 0.1];
        let found = statistics(&of(&jacobian, &residuals, &[true, false])).expect("converges");
        assert_eq!((found.freedom, found.deviations[0]), (2, Some(0.0)));
        let expected = 0.06 / 2.0 / 5.0;
        assert!((found.covariance[1][1] / expected - 1.0).abs() < 1e-12);
        assert_eq!(found.correlation(0, 1), None);
        // x₀ + x₁ is prescribed: along (1, −1) the residuals change by 1 − t.
        let rows = [vec![1.0, 1.0]];
        let along = Fit {
            rows: &rows,
            ..of(&jacobian, &residuals, &[false; 2])
        };
        let found = statistics(&along).expect("converges");
        let expected = 0.06 / 2.0 / 2.0;
        assert!((found.covariance[0][0] / expected - 1.0).abs() < 1e-12);
        assert!((found.correlation(0, 1).expect("both") + 1.0).abs() < 1e-12);
    }

    /// A sum that alone matters is named; a number without influence too; the third has its deviation.
    #[test]
    fn what_the_data_do_not_determine_is_named() {
        let row = |t: f64| vec![1.0, 2.0, t];
        let jacobian: Vec<Vec<f64>> = [-1.0, 0.0, 1.0].map(row).to_vec();
        let residuals = [0.1, 0.1, -0.2];
        let found = statistics(&of(&jacobian, &residuals, &[false; 3])).expect("converges");
        assert_eq!(found.undetermined.len(), 1);
        let parts = &found.undetermined[0];
        assert_eq!(parts.iter().map(|p| p.0).collect::<Vec<_>>(), [0, 1]);
        assert!((parts[0].1 - 1.0).abs() < 1e-12 && (parts[1].1 + 0.5).abs() < 1e-12);
        assert_eq!(found.deviations[..2], [None, None]);
        assert!((found.covariance[2][2] / (0.06 / 1.0 / 2.0) - 1.0).abs() < 1e-12);
        let row = |t: f64| vec![1.0, 0.0, t];
        let jacobian: Vec<Vec<f64>> = [-1.0, 0.0, 1.0].map(row).to_vec();
        let found = statistics(&of(&jacobian, &residuals, &[false; 3])).expect("converges");
        assert_eq!(found.undetermined, [vec![(1, 1.0)]]);
        // Fewer data than numbers.
        let jacobian = line(&[2.0]);
        let found = statistics(&of(&jacobian, &[0.0], &[false; 2])).expect("converges");
        assert_eq!((found.freedom, found.reduced_chi_square), (0, None));
        assert_eq!(found.undetermined.len(), 1);
    }

    /// Over 200 draws of noise, the scatter of fitted numbers is their covariance to 10 %.
    #[test]
    fn the_covariance_is_the_scatter_of_many_draws() {
        let times: Vec<f64> = (0..40).map(|k| 0.1 * f64::from(k)).collect();
        let jacobian = line(&times);
        let mut state = 7_u64;
        let mut uniform = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
        };
        let mut normal =
            || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos();
        let a = DMatrix::from_fn(40, 2, |k, i| jacobian[k][i]);
        let inverse = a.tr_mul(&a).try_inverse().expect("regular");
        let (mut sum, mut means) = ([0.0; 2], [0.0; 2]);
        for _ in 0..200 {
            let noise = DVector::from_fn(40, |_, _| 0.3 * normal());
            let x = &inverse * a.tr_mul(&noise);
            let r: Vec<f64> = (&a * &x - noise).iter().copied().collect();
            let found = statistics(&of(&jacobian, &r, &[false; 2])).expect("converges");
            for i in 0..2 {
                sum[i] += x[i] * x[i];
                means[i] += found.covariance[i][i];
            }
        }
        for i in 0..2 {
            let ratio = (means[i] / sum[i]).sqrt();
            assert!((ratio - 1.0).abs() < 0.1, "standard deviation {i}: {ratio}");
        }
    }
}
