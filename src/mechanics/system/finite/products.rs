//! Products lᵀ A r of the second derivatives of the strain energy of a body, and of what damping adds to them, by elements.
//!
//! A thin shell moves much more than it deforms. The entries of its matrices multiply the motion, and leave round-off of
//! (length / thickness)² in such a product; strains multiply the deformation.

use super::element::Deformed;
use super::parts;
use super::stiffness::{Strained, factors, linear_products, stresses};
use crate::math::Scalar;
use crate::math::slices::dot;
use crate::model::finite::FiniteElements;

/// lᵀ A r, where A are the derivatives of elastic and viscous forces by coordinates, and by their rates.
pub fn strain_products<S: Scalar>(
    finite: &FiniteElements<S>,
    (q, rate): (&[S], &[S]),
    [l, r]: [&[S]; 2],
) -> [S; 2] {
    let mut sums = [S::zero(); 2];
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let [x, left, right] = [q, l, r].map(|x| Deformed::of(element, x));
        let strained = Strained::of(element, &x);
        let [along, other] = [&left, &right].map(|y| strained.along(element, y));
        let curved = Strained::curvature(element, &left, &right);
        let stress = stresses(element, &strained.strain);
        let [thin, thick] = factors(finite, i);
        let [bending, shear] = linear_products(element, &left, &right);
        let linear = (dot(&stresses(element, &along), &other) + shear) * thin + bending * thick;
        sums[0] += linear + dot(&stress, &curved) * thin;
        if let Some([_, beta]) = finite.damping {
            let moving = Deformed::of(element, rate);
            let speed = stresses(element, &strained.along(element, &moving));
            let turned = Strained::curvature(element, &moving, &right);
            let by_place = dot(&stresses(element, &along), &turned) + dot(&speed, &curved);
            sums[0] += by_place * (beta * thin);
            sums[1] += linear * beta;
        }
    }
    let of_parts = parts::strain_products(finite, (q, rate), [l, r]);
    [sums[0] + of_parts[0], sums[1] + of_parts[1]]
}

/// A body without strain energy.
pub fn without_strains<S: Scalar>(finite: &FiniteElements<S>) -> FiniteElements<S> {
    let mut out = finite.clone();
    out.young.fill(S::zero());
    for part in &mut out.parts {
        part.stiffness.linear.fill(S::zero());
        part.stiffness.strains.clear();
    }
    out
}
