//! Second moments of the mass about its centre that agree with a mass matrix and belong to a body that can exist.
//!
//! With the places Y of the undeformed body and its shapes Y_I, each less its mean over the mass, the inertia of the
//! deformed body has S_00 = ∫ Y Yᵀ dm, S_0I = ∫ Y Y_Iᵀ dm and S_IJ = ∫ Y_I Y_Jᵀ dm. A mass matrix M gives these of
//! them without approximation:
//!
//! ```text
//! J = tr S_00 1 − S_00,     h_I = ∫ Y × Y_I dm,     M_IJ = tr S_IJ
//! ```
//!
//! The rest comes from sums over pairs of nodes, which are the moments of some fields. These fields are changed until
//! their J, h and M are right: first the places, Y' = B Y. Then the shapes by their parts along and across rigid
//! rotations,
//!
//! ```text
//! Y_I = Ω_I × Y' + Z_I,   ∫ Y' × Z_I dm = 0:     Ω_I' = J⁻¹ h_I,   Z_I' = Σ_J C_IJ Z_J
//! ```
//!
//! B and C make what is too large smaller; what is missing is added as displacements alike in all directions that
//! depend on nothing else. So all moments remain those of fields: the kinetic energy is positive however far the body
//! is deformed. Differences of single entries would not keep it so.

use crate::math::{Mat3, Vec3};
use nalgebra::{DMatrix, SymmetricEigen};

/// An eigenvalue below this part of the largest is zero.
const NOTHING: f64 = 1e-14;

/// Second moments about the centre.
pub(super) struct SecondMoments {
    /// S_00.
    pub places: Mat3<f64>,
    /// S_0I.
    pub with_places: Vec<Mat3<f64>>,
    /// S_IJ by rows, all pairs.
    pub shapes: Vec<Mat3<f64>>,
}

/// What is known of them.
pub(super) struct Known {
    /// J.
    pub inertia: Mat3<f64>,
    /// h_I.
    pub turning: Vec<Vec3<f64>>,
    /// tr S_IJ.
    pub mass: DMatrix<f64>,
}

/// The vector of the antisymmetric part of ∫ a bᵀ dm: ∫ a × b dm.
pub(super) fn turning(s: &Mat3<f64>) -> Vec3<f64> {
    Vec3::new(
        s[(1, 2)] - s[(2, 1)],
        s[(2, 0)] - s[(0, 2)],
        s[(0, 1)] - s[(1, 0)],
    )
}

impl SecondMoments {
    /// The moments with these known parts.
    pub(super) fn fitted(self, known: &Known) -> Self {
        let m = known.turning.len();
        let exact = Mat3::from_diagonal_element(0.5 * known.inertia.trace()) - known.inertia;
        let dense = |a: &Mat3<f64>| DMatrix::from_fn(3, 3, |i, j| a[(i, j)]);
        let (b, _) = fit(&dense(&self.places), &dense(&exact));
        let b = Mat3::from_fn(|i, j| b[(i, j)]);
        let inverse = pseudo_inverse(&known.inertia);
        let rotation = |h: Vec3<f64>| (inverse * h).cross_matrix();
        let with: Vec<Mat3<f64>> = self.with_places.iter().map(|s| b * s).collect();
        // The parts across rotations.
        let along: Vec<Mat3<f64>> = with.iter().map(|s| rotation(turning(s))).collect();
        let across: Vec<Mat3<f64>> = (with.iter().zip(&along))
            .map(|(s, w)| s - exact * w.transpose())
            .collect();
        let pair = |at: usize| {
            let (i, j) = (at / m, at % m);
            let (wi, wj) = (along[i], along[j].transpose());
            self.shapes[at] - wi * with[j] - with[i].transpose() * wj + wi * exact * wj
        };
        let pairs: Vec<Mat3<f64>> = (0..m * m).map(pair).collect();
        let mass = DMatrix::from_fn(m, m, |i, j| {
            known.mass[(i, j)] - known.turning[i].dot(&(inverse * known.turning[j]))
        });
        let (c, added) = fit(
            &DMatrix::from_fn(m, m, |i, j| pairs[i * m + j].trace()),
            &mass,
        );
        let across = mixed(&c, |j| across[j]);
        let rows: Vec<Vec<Mat3<f64>>> = (0..m).map(|j| mixed(&c, |i| pairs[i * m + j])).collect();
        let columns: Vec<Vec<Mat3<f64>>> = (0..m).map(|i| mixed(&c, |j| rows[j][i])).collect();
        let along: Vec<Mat3<f64>> = known.turning.iter().map(|h| rotation(*h)).collect();
        let with_places = (across.iter().zip(&along))
            .map(|(s, w)| s + exact * w.transpose())
            .collect();
        let shape = |at: usize| {
            let (i, j) = (at / m, at % m);
            let (wi, wj) = (along[i], along[j].transpose());
            let rest = Mat3::from_diagonal_element(added[(i, j)] / 3.0);
            columns[i][j] + rest + wi * across[j] + across[i].transpose() * wj + wi * exact * wj
        };
        Self {
            places: exact,
            with_places,
            shapes: (0..m * m).map(shape).collect(),
        }
    }
}

/// Σ_j C_ij X_j for each i.
fn mixed(c: &DMatrix<f64>, of: impl Fn(usize) -> Mat3<f64>) -> Vec<Mat3<f64>> {
    let all: Vec<Mat3<f64>> = (0..c.ncols()).map(of).collect();
    let row = |i: usize| {
        let terms = all.iter().enumerate();
        terms.fold(Mat3::zeros(), |sum: Mat3<f64>, (j, x)| sum + x * c[(i, j)])
    };
    (0..c.nrows()).map(row).collect()
}

/// C and D with C T Cᵀ + D = M for symmetric positive semidefinite T and M. In the directions in which M has less than
/// T, C makes it smaller; in the others D adds what is missing, and C is one.
fn fit(t: &DMatrix<f64>, m: &DMatrix<f64>) -> (DMatrix<f64>, DMatrix<f64>) {
    let n = t.nrows();
    if n == 0 {
        return (DMatrix::zeros(0, 0), DMatrix::zeros(0, 0));
    }
    let sum = (t + t.transpose() + m + m.transpose()) * 0.5;
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = sum.clone().symmetric_eigen();
    let least = NOTHING * eigenvalues.max().max(f64::MIN_POSITIVE);
    let kept: Vec<usize> = (0..n).filter(|&k| eigenvalues[k] > least).collect();
    if kept.is_empty() {
        return (DMatrix::identity(n, n), DMatrix::zeros(n, n));
    }
    let white = DMatrix::from_fn(n, kept.len(), |i, k| {
        eigenvectors[(i, kept[k])] / eigenvalues[kept[k]].sqrt()
    });
    let share = white.transpose() * (t + t.transpose()) * &white * 0.5;
    let SymmetricEigen {
        eigenvectors,
        eigenvalues,
    } = ((&share + share.transpose()) * 0.5).symmetric_eigen();
    let p = white * eigenvectors;
    let q = &sum * &p;
    let diagonal = |of: &dyn Fn(f64) -> f64| DMatrix::from_diagonal(&eigenvalues.map(of));
    // T has the part μ of the sum and M the rest.
    let smaller = diagonal(&|mu| match mu > 0.5 {
        true => ((1.0 - mu).max(0.0) / mu).sqrt(),
        false => 1.0,
    });
    let added = diagonal(&|mu| (1.0 - 2.0 * mu).max(0.0));
    (&q * smaller * p.transpose(), &q * added * q.transpose())
}

/// J⁻¹ of the axes about which there is inertia.
fn pseudo_inverse(inertia: &Mat3<f64>) -> Mat3<f64> {
    let eigen = inertia.symmetric_eigen();
    let least = NOTHING * eigen.eigenvalues.max();
    let inverse = |x: f64| if x > least { 1.0 / x } else { 0.0 };
    let v = eigen.eigenvectors;
    v * Mat3::from_diagonal(&eigen.eigenvalues.map(inverse)) * v.transpose()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in (−1, 1).
    fn random(seed: &mut u64) -> f64 {
        *seed ^= *seed << 13;
        *seed ^= *seed >> 7;
        *seed ^= *seed << 17;
        (*seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    /// Moments of fields of some points: places, and m shapes, each with these sizes.
    fn moments(seed: &mut u64, points: usize, sizes: &[[f64; 3]]) -> Vec<Vec<Mat3<f64>>> {
        let fields: Vec<Vec<Vec3<f64>>> = (0..points)
            .map(|_| {
                let one = |size: &[f64; 3]| Vec3::from_fn(|k, _| size[k] * random(seed));
                sizes.iter().map(one).collect()
            })
            .collect();
        let pair = |a: usize, b: usize| {
            fields.iter().fold(Mat3::zeros(), |sum: Mat3<f64>, point| {
                sum + point[a] * point[b].transpose()
            })
        };
        let all = 0..sizes.len();
        all.clone()
            .map(|a| all.clone().map(|b| pair(a, b)).collect())
            .collect()
    }

    fn of_blocks(blocks: &[Vec<Mat3<f64>>]) -> SecondMoments {
        SecondMoments {
            places: blocks[0][0],
            with_places: blocks[0][1..].to_vec(),
            shapes: blocks[1..]
                .iter()
                .flat_map(|row| row[1..].to_vec())
                .collect(),
        }
    }

    fn known(of: &SecondMoments) -> Known {
        let m = of.with_places.len();
        Known {
            inertia: Mat3::from_diagonal_element(of.places.trace()) - of.places,
            turning: of.with_places.iter().map(turning).collect(),
            mass: DMatrix::from_fn(m, m, |i, j| of.shapes[i * m + j].trace()),
        }
    }

    /// Sums of some fields are fitted to the integrals of others: these are met, and the moments are those of a mass,
    /// with no negative value along any field. Places and shapes fill space, a plane or a line, as bars do; a field of
    /// rotations alone has no displacement in the sums.
    #[test]
    fn fitted_moments_have_the_exact_integrals_and_are_positive() {
        let (space, plane, line, still) =
            ([1.0, 0.7, 0.5], [1.0, 0.3, 0.0], [1.0, 0.0, 0.0], [0.0; 3]);
        type Fields<'a> = &'a [[f64; 3]];
        let cases: [(Fields, Fields); 7] = [
            (&[space, space, space], &[space, space, space]),
            (&[space, plane, plane], &[space, space, plane]),
            (&[line, plane, plane, still], &[space, plane, plane, space]),
            (&[line, plane, still], &[line, plane, line]),
            (&[plane, space], &[plane, plane]),
            (&[space, still, still], &[space, space, plane]),
            (&[space], &[plane]),
        ];
        let mut seed = 7;
        for (case, (sums, exact)) in cases.into_iter().enumerate() {
            for points in [3, 9] {
                let sums = of_blocks(&moments(&mut seed, points, sums));
                let exact = of_blocks(&moments(&mut seed, points, exact));
                let known = known(&exact);
                let scale = exact.places.trace() + known.mass.trace();
                let found = sums.fitted(&known);
                let again = super::tests::known(&found);
                let mut gap = (again.inertia - known.inertia).amax();
                for (a, b) in again.turning.iter().zip(&known.turning) {
                    gap = gap.max((a - b).amax());
                }
                if !known.turning.is_empty() {
                    gap = gap.max((again.mass - &known.mass).amax());
                }
                assert!(gap < 1e-10 * scale, "{case} {points}: {gap:e}");
                let m = known.turning.len();
                let whole = DMatrix::from_fn(3 + 3 * m, 3 + 3 * m, |r, c| {
                    let entry = (r % 3, c % 3);
                    match (r / 3, c / 3) {
                        (0, 0) => found.places[entry],
                        (0, j) => found.with_places[j - 1][entry],
                        (i, 0) => found.with_places[i - 1][(entry.1, entry.0)],
                        (i, j) => found.shapes[(i - 1) * m + j - 1][entry],
                    }
                });
                assert!(
                    (&whole - whole.transpose()).amax() < 1e-10 * scale,
                    "{case}"
                );
                let least = SymmetricEigen::new(whole).eigenvalues.min();
                assert!(least > -1e-10 * scale, "{case} {points}: {least:e}");
            }
        }
    }

    /// Moments that have the integrals already stay.
    #[test]
    fn moments_that_agree_stay() {
        let (space, mut seed) = ([1.0, 0.7, 0.5], 3);
        let sums = of_blocks(&moments(&mut seed, 12, &[space; 4]));
        let known = known(&sums);
        let (before, scale) = (sums.shapes.clone(), known.mass.trace());
        let with = sums.with_places.clone();
        let found = sums.fitted(&known);
        let pairs = found.shapes.iter().zip(&before);
        let pairs = pairs.chain(found.with_places.iter().zip(&with));
        for (a, b) in pairs {
            assert!((a - b).amax() < 1e-9 * scale);
        }
    }
}
