//! The spaces of a basis: vectors that bend and vectors that stretch a flat shell, or one space for
//! other shells.

use super::matrices::Matrices;
use super::subspace::{Subspace, principal};
use crate::math::slices::dot;
use crate::model::finite::FiniteElements;

/// Largest entry that couples in-plane and out-of-plane unknowns of a flat shell, relative to the
/// largest of all.
const FLAT: f64 = 1e-12;
/// A vector whose part of one kind is smaller, beside the whole, has none of it.
const ROUND_OFF: f64 = 1e-7;

/// The unknowns that bend a flat shell, if the others stretch it alone; `None` of other shells.
pub(super) fn bending_unknowns(shells: &FiniteElements<f64>) -> Option<Vec<bool>> {
    // Beams beside shells bend and stretch at once.
    if shells
        .parts
        .iter()
        .any(|part| !part.stiffness.strains.is_empty())
    {
        return None;
    }
    let mut bends = vec![false; shells.mesh.coordinates];
    let elements = &shells.mesh.elements;
    let largest = |k: usize| {
        let own = elements.iter().map(|e| e.slopes.largest(|i| i % 3 == k));
        own.fold(0.0, f64::max)
    };
    let sizes = [0, 1, 2].map(largest);
    let normal = (0..3).max_by(|&a, &b| sizes[a].total_cmp(&sizes[b]))?;
    if (0..3).any(|k| k != normal && sizes[k] > FLAT * sizes[normal]) {
        return None;
    }
    for element in elements {
        let out = |i: usize| i >= element.displacements() || i % 3 == normal;
        for linear in &element.linear {
            let most = linear
                .entries()
                .fold(0.0_f64, |most, (_, x)| most.max(x.abs()));
            let mut all = linear.entries();
            if all.any(|([i, j], x)| out(i) != out(j) && x.abs() > FLAT * most) {
                return None;
            }
        }
        let sizes = [true, false].map(|out| element.membrane.largest(|i| (i % 3 == normal) == out));
        if sizes[0] > FLAT * sizes[1] {
            return None;
        }
        for (i, coordinate) in element.coordinates.iter().enumerate() {
            if let Some(at) = coordinate {
                bends[*at] = out(i);
            }
        }
    }
    Some(bends)
}

/// The two spaces of a flat shell; one of another.
pub(super) struct Spaces {
    pub bends: Option<Vec<bool>>,
    /// Vectors that bend, or all.
    pub bending: Subspace,
    /// Vectors that stretch a flat shell.
    pub membrane: Subspace,
}

impl Spaces {
    pub(super) fn of(shells: &FiniteElements<f64>) -> Self {
        Self {
            bends: bending_unknowns(shells),
            bending: Subspace::default(),
            membrane: Subspace::default(),
        }
    }

    /// Parts of x that bend and that stretch.
    fn parts(&self, x: &[f64]) -> (Vec<f64>, Option<Vec<f64>>) {
        let Some(bends) = &self.bends else {
            return (x.to_vec(), None);
        };
        let part = |wanted: bool| {
            let all = x.iter().zip(bends);
            all.map(|(&x, &own)| if own == wanted { x } else { 0.0 })
                .collect()
        };
        (part(true), Some(part(false)))
    }

    pub(super) fn add(&mut self, matrices: &Matrices, x: &[f64]) {
        let (bending, membrane) = self.parts(x);
        let size = |x: &[f64]| dot(&matrices.heavy(x), x);
        let noise = ROUND_OFF * ROUND_OFF * size(x);
        if size(&bending) > noise {
            self.bending.add(matrices, bending);
        }
        if let Some(membrane) = membrane
            && size(&membrane) > noise
        {
            self.membrane.add(matrices, membrane);
        }
    }

    pub(super) fn count(&self) -> usize {
        self.bending.vectors.len() + self.membrane.vectors.len()
    }

    /// Adds the combinations of largest energy of the vectors, without their parts in the space.
    pub(super) fn add_principal(
        &mut self,
        matrices: &Matrices,
        list: Vec<Vec<f64>>,
        tolerance: f64,
    ) {
        let energy = |x: &[f64]| dot(&matrices.stiff(x), x);
        let mut kinds = [Vec::new(), Vec::new()];
        let mut noise = 0.0_f64;
        for x in list {
            noise = noise.max(ROUND_OFF * ROUND_OFF * energy(&x));
            let (bending, membrane) = self.parts(&x);
            kinds[0].push(bending);
            kinds[1].extend(membrane);
        }
        for (own, space) in kinds
            .into_iter()
            .zip([&mut self.bending, &mut self.membrane])
        {
            let most = own.iter().map(|x| energy(x)).fold(0.0, f64::max);
            if most <= noise {
                continue;
            }
            let rest = own.into_iter().map(|mut x| {
                space.remove(&mut x);
                x.iter_mut().for_each(|x| *x /= most.sqrt());
                x
            });
            let rest: Vec<Vec<f64>> = rest.collect();
            for x in principal(matrices, &rest, tolerance * tolerance) {
                space.add(matrices, x);
            }
        }
    }
}
