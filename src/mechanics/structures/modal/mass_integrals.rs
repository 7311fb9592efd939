//! Integrals of shapes over the mass, from a mass matrix of finite elements.
//!
//! With φ_I the nodal values of shape I and R the six rigid motions, M gives these without approximation:
//!
//! ```text
//! RᵀMR: ∫dm, p_0 = ∫X dm, J;     RᵀMφ_I: p_I = ∫X_I dm, ∫X × X_I dm;     φ_IᵀMφ_J = tr S_IJ
//! ```
//!
//! They are all that a slow rotation needs. The rest of S_IJ = ∫ X_I X_Jᵀ dm is that of sums Σ m_ab x_aI x_bJᵀ over
//! pairs of nodes, in which m_ab is the mean of the three translational entries of M, changed by
//! [`super::second_moments`] to agree with the exact integrals. The sums are exact for lumped masses and for elements
//! that interpolate all displacements alike. Cubic beams and rotary inertia make errors that fall with the square of
//! the size of elements.

use super::free_body::FreeBody;
use super::imported::ImportedBody;
use super::second_moments::{Known, SecondMoments};
use crate::math::slices::dot;
use crate::math::{Mat3, Vec3};
use nalgebra::DMatrix;

/// Pairs of nodes with their mass m_ab, each ordered pair once or in parts.
fn nodal_masses(body: &FreeBody) -> Vec<(usize, usize, f64)> {
    let mut all = Vec::new();
    for (j, column) in body
        .unknowns
        .iter()
        .enumerate()
        .filter(|u| u.1.component < 3)
    {
        for (at, i) in body.pattern.column(j) {
            let row = body.unknowns[i];
            let mass = body.mass[at] / 3.0;
            if row.component != column.component || mass == 0.0 {
                continue;
            }
            all.push((row.node, column.node, mass));
            if i != j {
                all.push((column.node, row.node, mass));
            }
        }
    }
    all.sort_unstable_by_key(|&(a, b, _)| (a, b));
    all.dedup_by(|next, kept| {
        let same = (next.0, next.1) == (kept.0, kept.1);
        if same {
            kept.2 += next.2;
        }
        same
    });
    all
}

/// The body with these shapes; its stiffness is still zero, and it has no points.
pub fn integrals(body: &FreeBody, shapes: &[Vec<f64>]) -> ImportedBody {
    let m = shapes.len();
    let product = |x: &Vec<f64>| {
        let mut y = vec![0.0; x.len()];
        body.pattern.multiply(&body.mass, x, &mut y);
        y
    };
    let rigid = body.rigid_motions(&Vec3::zeros());
    let by_rigid = rigid.each_ref().map(product);
    let t =
        |i: usize, j: usize| 0.5 * (dot(&rigid[i], &by_rigid[j]) + dot(&rigid[j], &by_rigid[i]));
    let by_shape: Vec<Vec<f64>> = shapes.iter().map(product).collect();
    let nodal = nodal_masses(body);
    let positions = |shape: &Vec<f64>| {
        let mut all = vec![Vec3::zeros(); body.nodes.len()];
        for (unknown, x) in body.unknowns.iter().zip(shape) {
            if unknown.component < 3 {
                all[unknown.node][unknown.component] = *x;
            }
        }
        all
    };
    let moved: Vec<Vec<Vec3<f64>>> = shapes.iter().map(positions).collect();
    let weighted = |all: &[Vec3<f64>]| {
        let mut sums = vec![Vec3::zeros(); all.len()];
        for &(a, b, mass) in &nodal {
            sums[a] += all[b] * mass;
        }
        sums
    };
    let outer = |left: &[Vec3<f64>], right: &[Vec3<f64>]| {
        let pairs = left.iter().zip(right);
        pairs.fold(Mat3::zeros(), |sum: Mat3<f64>, (a, b)| {
            sum + a * b.transpose()
        })
    };
    let along = |x: &[f64], of: std::ops::Range<usize>| {
        let first = of.start;
        Vec3::from_fn(|k, _| dot(&rigid[first + k], x))
    };
    let mass = (t(0, 0) + t(1, 1) + t(2, 2)) / 3.0;
    let centre = Vec3::new(
        0.5 * (t(5, 1) - t(4, 2)),
        0.5 * (t(3, 2) - t(5, 0)),
        0.5 * (t(4, 0) - t(3, 1)),
    );
    let inertia = Mat3::from_fn(|i, j| t(3 + i, 3 + j));
    let moments: Vec<Vec3<f64>> = by_shape.iter().map(|x| along(x, 0..3)).collect();
    // Sums over pairs of nodes, about the means by these sums.
    let total: f64 = nodal.iter().map(|pair| pair.2).sum();
    let total = total.max(f64::MIN_POSITIVE);
    let mean = |sums: &[Vec3<f64>]| sums.iter().sum::<Vec3<f64>>();
    let by_places = weighted(&body.nodes);
    let by_moved: Vec<Vec<Vec3<f64>>> = moved.iter().map(|x| weighted(x)).collect();
    let about = |sums: &[Vec3<f64>], x: &[Vec3<f64>], means: [Vec3<f64>; 2]| {
        outer(sums, x) - means[0] * means[1].transpose() / total
    };
    let at_rest = mean(&by_places);
    let means: Vec<Vec3<f64>> = by_moved.iter().map(|sums| mean(sums)).collect();
    let pairs = (0..m * m).map(|at| {
        let (i, j) = (at / m, at % m);
        about(&by_moved[i], &moved[j], [means[i], means[j]])
    });
    let sums = SecondMoments {
        places: about(&by_places, &body.nodes, [at_rest; 2]),
        with_places: (0..m)
            .map(|i| about(&by_places, &moved[i], [at_rest, means[i]]))
            .collect(),
        shapes: pairs.collect(),
    };
    let known = Known {
        inertia: inertia
            - (Mat3::from_diagonal_element(centre.norm_squared()) - centre * centre.transpose())
                / mass,
        turning: (by_shape.iter().zip(&moments))
            .map(|(x, p)| along(x, 3..6) - centre.cross(p) / mass)
            .collect(),
        mass: DMatrix::from_fn(m, m, |i, j| {
            let both = dot(&shapes[i], &by_shape[j]) + dot(&shapes[j], &by_shape[i]);
            0.5 * both - moments[i].dot(&moments[j]) / mass
        }),
    };
    let fitted = sums.fitted(&known);
    let upper = (0..m).flat_map(|i| (i..m).map(move |j| (i, j)));
    ImportedBody {
        with_position: (fitted.with_places.iter().zip(&moments))
            .map(|(s, p)| s + centre * p.transpose() / mass)
            .collect(),
        products: upper
            .map(|(i, j)| fitted.shapes[i * m + j] + moments[i] * moments[j].transpose() / mass)
            .collect(),
        mass,
        centre,
        inertia,
        static_moments: moments,
        stiffness: vec![0.0; m * m],
        damping: vec![0.0; m * m],
        points: Vec::new(),
    }
}
