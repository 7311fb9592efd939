//! A quadratic model by its eigenvalues, and its least value in a ball.

use nalgebra::{DMatrix, DVector};

use crate::constants::{MOST_STEPS, SMALL_PART};

/// The model gᵀt + ½ tᵀH t in the eigenvectors of H.
pub(crate) struct Spectrum {
    pub vectors: DMatrix<f64>,
    /// Eigenvalues of H.
    pub values: DVector<f64>,
    /// g by the eigenvectors.
    pub force: DVector<f64>,
}

impl Spectrum {
    /// Of the model ‖r + J t‖², H = 2 JᵀJ and g = 2 Jᵀr, without squaring the condition of J.
    /// Directions that J does not see beyond round-off get no force.
    pub(crate) fn of_squares(j: &DMatrix<f64>, r: &DVector<f64>) -> Option<Spectrum> {
        let n = j.ncols();
        // A wide matrix has directions without singular values.
        let tall = match j.nrows() < n {
            true => j.clone().resize_vertically(n, 0.0),
            false => j.clone(),
        };
        let r = match r.len() < n {
            true => r.clone().resize_vertically(n, 0.0),
            false => r.clone(),
        };
        let (rows, svd) = (tall.nrows(), tall.try_svd(true, true, f64::EPSILON, 0)?);
        let (u, v) = (svd.u?, svd.v_t?);
        let sigma = svd.singular_values;
        let seen = sigma.amax() * f64::EPSILON * rows as f64;
        let along = u.tr_mul(&r);
        let force = DVector::from_fn(n, |i, _| match sigma[i] > seen {
            true => 2.0 * sigma[i] * along[i],
            false => 0.0,
        });
        Some(Spectrum {
            vectors: v.transpose(),
            values: sigma.map(|s| 2.0 * s * s),
            force,
        })
    }

    /// Of a symmetric matrix.
    pub(crate) fn of_matrix(h: &DMatrix<f64>, g: &DVector<f64>) -> Option<Spectrum> {
        let eigen = h.clone().try_symmetric_eigen(f64::EPSILON, 0)?;
        Some(Spectrum {
            force: eigen.eigenvectors.tr_mul(g),
            vectors: eigen.eigenvectors,
            values: eigen.eigenvalues,
        })
    }

    /// The nearest matrix without negative eigenvalues.
    pub(crate) fn convex(&self) -> DMatrix<f64> {
        let values = self.values.map(|v| v.max(0.0));
        &self.vectors * DMatrix::from_diagonal(&values) * self.vectors.transpose()
    }

    /// The step t of length at most `radius` with the least model: (H + λ I) t = −g with λ ≥ 0 (Moré &
    /// Sorensen 1983). Of many such steps the shortest.
    pub(crate) fn step(&self, radius: f64) -> DVector<f64> {
        let least = self.values.min();
        let step = |lambda: f64| {
            DVector::from_fn(self.values.len(), |i, _| match self.force[i] == 0.0 {
                true => 0.0,
                false => -self.force[i] / (self.values[i] + lambda),
            })
        };
        let lowest = (-least).max(0.0);
        if least >= 0.0 {
            let free = step(0.0);
            if free.norm() <= radius && free.iter().all(|v| v.is_finite()) {
                return &self.vectors * free;
            }
        }
        // Newton's method for 1/‖t‖ = 1/Δ between bounds on λ.
        let (mut below, mut above) = (lowest, lowest + self.force.norm() / radius);
        let mut lambda = match lowest > 0.0 {
            true => 0.5 * (below + above),
            false => 1e-3 * above,
        };
        for _ in 0..MOST_STEPS {
            let t = step(lambda);
            let length = t.norm();
            if (length - radius).abs() <= SMALL_PART * radius {
                break;
            }
            match length > radius {
                true => below = lambda,
                false => above = lambda,
            }
            let slope: f64 = (0..t.len())
                .filter(|&i| t[i] != 0.0)
                .map(|i| t[i] * t[i] / (self.values[i] + lambda))
                .sum();
            let newton = lambda + length * length / slope * (length / radius - 1.0);
            lambda = match newton > below && newton < above {
                true => newton,
                false => 0.5 * (below + above),
            };
        }
        let t = step(lambda);
        // The hard case has no force along the lowest curvature; a shorter step will do.
        let length = t.norm();
        let t = match length > radius {
            true => t * (radius / length),
            false => t,
        };
        &self.vectors * t
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Inside a large ball the step solves the normal equations; in a small one it is as long as the
    /// radius and (H + λ I) t = −g holds with one λ ≥ 0 for all entries.
    #[test]
    fn the_step_is_that_of_the_least_model_in_the_ball() {
        let j = DMatrix::from_row_slice(4, 2, &[1.0, 2.0, 0.5, -1.0, 3.0, 0.1, 0.0, 1.0]);
        let r = DVector::from_vec(vec![1.0, -2.0, 0.3, 0.7]);
        let (h, g) = (2.0 * j.tr_mul(&j), 2.0 * j.tr_mul(&r));
        let model = Spectrum::of_squares(&j, &r).expect("a spectrum");
        let free = h.clone().lu().solve(&-&g).expect("regular");
        assert!((model.step(10.0) - &free).norm() < 1e-12);
        let radius = 0.3 * free.norm();
        let short = model.step(radius);
        assert!((short.norm() / radius - 1.0).abs() < 1e-5);
        let left = -(&h * &short + &g);
        let lambda = left.dot(&short) / short.norm_squared();
        assert!(lambda > 0.0 && (left - &short * lambda).norm() < 1e-10);
        let indefinite = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 0.0, -2.0]);
        let model = Spectrum::of_matrix(&indefinite, &DVector::from_vec(vec![1.0, 0.5]));
        let step = model.expect("a spectrum").step(1.0);
        let lambda = -0.5 / step[1] + 2.0;
        assert!(
            lambda >= 2.0 && ((1.0 + lambda) * step[0] + 1.0).abs() < 1e-5,
            "{step}"
        );
        // A direction that the residuals do not see stays.
        let blind = DMatrix::from_row_slice(3, 2, &[1.0, 1.0, 2.0, 2.0, -1.0, -1.0]);
        let model = Spectrum::of_squares(&blind, &DVector::from_vec(vec![1.0, 0.0, 0.0]));
        let step = model.expect("a spectrum").step(10.0);
        assert!((step[0] - step[1]).abs() < 1e-14 && step[0] < 0.0);
    }
}
