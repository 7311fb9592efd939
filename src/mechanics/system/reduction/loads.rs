//! Loads under which shells are solved for: the forces of their lowest vibrations, held and free.

use super::matrices::Matrices;
use super::subspace::Subspace;
use crate::math::slices::add_scaled;
use crate::math::{Mat3, Vec3};
use crate::system::finite::{first_moment, inertial};
use crate::system::flexing::Flexing;
use nalgebra::{DMatrix, SymmetricEigen};

/// The static solutions of the loads: the `count` lowest vibrations with the axes held, and as many of the free
/// body, of a space whose vectors are vibrations of these frequencies \[rad/s\].
pub(super) fn patterns(
    matrices: &Matrices,
    space: &Subspace,
    frequencies: &[f64],
    count: usize,
) -> Vec<Vec<f64>> {
    let held = space.vectors.iter().take(count).cloned();
    held.chain(free(matrices, space, frequencies, count))
        .collect()
}

/// The lowest vibrations of the free body: K y = ω² (1 − M_erᵀ M_rr⁻¹ M_re) y.
fn free(matrices: &Matrices, space: &Subspace, frequencies: &[f64], count: usize) -> Vec<Vec<f64>> {
    let (n, shells) = (space.vectors.len(), matrices.shells);
    let still = vec![0.0; shells.mesh.coordinates];
    let (mass, inertia) = shells.rigid();
    let cross = first_moment(shells, &still).cross_matrix();
    let mut rigid = DMatrix::zeros(6, 6);
    rigid.fixed_view_mut::<3, 3>(0, 0).fill_diagonal(mass);
    rigid.fixed_view_mut::<3, 3>(0, 3).copy_from(&-cross);
    rigid.fixed_view_mut::<3, 3>(3, 0).copy_from(&cross);
    rigid.fixed_view_mut::<3, 3>(3, 3).copy_from(&inertia);
    let mut coupling = DMatrix::zeros(6, n);
    for (i, vector) in space.vectors.iter().enumerate() {
        let at = Flexing {
            rotation: Mat3::identity(),
            gamma: Vec3::zeros(),
            omega: Vec3::zeros(),
            alpha: Vec3::zeros(),
            q: still.clone(),
            rate: still.clone(),
            acceleration: vector.clone(),
        };
        let forces = inertial(shells, &at);
        coupling
            .fixed_view_mut::<3, 1>(0, i)
            .copy_from(&forces.linear);
        coupling
            .fixed_view_mut::<3, 1>(3, i)
            .copy_from(&forces.angular);
    }
    let Some(factors) = rigid.cholesky() else {
        return Vec::new();
    };
    let effective = DMatrix::identity(n, n) - coupling.transpose() * factors.solve(&coupling);
    let scaled = DMatrix::from_fn(n, n, |i, j| {
        effective[(i, j)] / (frequencies[i] * frequencies[j])
    });
    let eigen = SymmetricEigen::new((&scaled + scaled.transpose()) * 0.5);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let vector = |i: usize| {
        let mut sum = still.clone();
        for (j, own) in space.vectors.iter().enumerate() {
            add_scaled(&mut sum, eigen.eigenvectors[(j, i)] / frequencies[j], own);
        }
        sum
    };
    order.into_iter().take(count).map(vector).collect()
}
