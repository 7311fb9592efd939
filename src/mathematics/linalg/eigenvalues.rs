//! Eigenvalues of dense matrices.

use crate::math::Complex64;
use faer::MatRef;
use nalgebra::DMatrix;

/// What is zero beside its neighbours, and most iterations of the second method.
const ZEROS: [f64; 3] = [f64::EPSILON, 1e-10, 1e-6];
const SWEEPS: usize = 10_000;

/// All eigenvalues of a square matrix; `None` if an entry is not finite, or they do not converge. Those of a conjugate pair have
/// exactly opposite imaginary parts, and that of a real one is zero.
pub fn eigenvalues(matrix: &DMatrix<f64>) -> Option<Vec<Complex64>> {
    let order = matrix.nrows();
    if matrix.iter().any(|x| !x.is_finite()) {
        return None;
    }
    if order == 0 {
        return Some(Vec::new());
    }
    let entries = MatRef::from_column_major_slice(matrix.as_slice(), order, order);
    entries.eigenvalues().ok().or_else(|| by_schur(matrix))
}

/// [`eigenvalues`] of a complex matrix.
pub fn complex_eigenvalues(matrix: &DMatrix<Complex64>) -> Option<Vec<Complex64>> {
    let order = matrix.nrows();
    if matrix
        .iter()
        .any(|x| !(x.re.is_finite() && x.im.is_finite()))
    {
        return None;
    }
    let entries = MatRef::from_column_major_slice(matrix.as_slice(), order, order);
    entries.eigenvalues().ok()
}

/// The same by nalgebra's Schur form, which converges for others.
fn by_schur(matrix: &DMatrix<f64>) -> Option<Vec<Complex64>> {
    let form = |&zero: &f64| matrix.clone().try_schur(zero, SWEEPS);
    let values = ZEROS.iter().find_map(form)?.complex_eigenvalues();
    let one = |x: &nalgebra::Complex<f64>| Complex64::new(x.re, x.im);
    Some(values.iter().map(one).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sorted(mut all: Vec<Complex64>) -> Vec<Complex64> {
        all.sort_by(|a, b| a.re.total_cmp(&b.re).then(a.im.total_cmp(&b.im)));
        all
    }

    #[test]
    fn pairs_are_conjugate_and_real_ones_are_real() {
        let matrix =
            DMatrix::from_row_slice(3, 3, &[0.0, -2.0, 0.0, 2.0, 0.0, 0.0, 0.5, 0.25, 3.0]);
        let all = sorted(eigenvalues(&matrix).expect("converge"));
        assert_eq!(all[0], all[1].conj());
        assert_eq!(all[2].im, 0.0);
        assert!((all[1] - Complex64::new(0.0, 2.0)).norm() < 1e-14);
        assert!((all[2].re - 3.0).abs() < 1e-14);
    }

    /// Entries and eigenvalues that fall over fourteen decades, with a part that is round-off.
    #[test]
    fn graded_matrices_converge() {
        for n in [5_usize, 40, 160] {
            let size = |i: usize| 10.0_f64.powf(-14.0 * i as f64 / n as f64);
            let entry = |i: usize, j: usize| match i.cmp(&(j + 1)) {
                std::cmp::Ordering::Greater => 0.0,
                _ => size(i.max(j)) * (1.0 + ((3 * i + 7 * j) as f64).sin()),
            };
            let matrix = DMatrix::from_fn(n, n, entry);
            let all = eigenvalues(&matrix).expect("converge");
            let sum: Complex64 = all.iter().sum();
            assert_eq!(all.len(), n);
            assert!((sum.re - matrix.trace()).abs() < 1e-12 * matrix.norm());
            assert_eq!(sum.im, 0.0);
        }
    }

    /// Two eigenvalues that are equal but for noise.
    #[test]
    fn equal_complex_eigenvalues_converge() {
        let mean = Complex64::new(-1e-12, 3e-9);
        for k in 0..2000 {
            let noise = |i: usize| 1e-16 * ((7 * k + 3 * i) as f64).sin();
            let entry = |i: usize, j: usize| {
                let own = Complex64::new(noise(i + 2 * j), noise(i + 2 * j + 9));
                if i == j { mean + own } else { own }
            };
            let matrix = DMatrix::from_fn(2, 2, entry);
            let all = complex_eigenvalues(&matrix).expect("converge");
            assert!((all[0] + all[1] - matrix.trace()).norm() < 1e-22);
            assert!(all.iter().all(|x| (x - mean).norm() < 1e-15));
        }
        assert!(complex_eigenvalues(&DMatrix::from_element(2, 2, mean * f64::NAN)).is_none());
    }

    #[test]
    fn what_is_not_finite_has_none() {
        assert!(eigenvalues(&DMatrix::from_element(2, 2, f64::NAN)).is_none());
        assert_eq!(eigenvalues(&DMatrix::zeros(0, 0)), Some(Vec::new()));
    }
}
