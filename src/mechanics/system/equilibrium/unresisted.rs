//! Motions that nothing resists at any speed of a steady rotation, as a free spin or slide along the axis:
//!
//! ```text
//! K_0 y = 0,   N y = 0      but for reactions of joints,     K(Ω) = K_0 + Ω² N
//! ```
//!
//! They belong to no speed. With round-off for both products any speed would do, and the others have it in their vectors.

use super::pencil::Matrices;
use crate::linalg::SparseLu;
use crate::math::slices::{add_scaled, any_vector, dot};
use crate::system::failure::AssemblyFailure;
use nalgebra::DMatrix;

/// Most motions that are looked for, and inverse iterations: each makes what is stiff smaller by at least a thousand.
const MOST: usize = 8;
const ITERATIONS: usize = 5;
/// The product with N is zero below this part of that with the inertia.
const ZERO: f64 = 1e-8;
/// What is left of a vector along others is round-off below this part.
const DEPENDENT: f64 = 1e-9;
/// A stiffness above this number of times its round-off is none.
const FIRM: f64 = 1e4;

/// What has little stiffness at speed zero.
pub(super) struct Unresisted {
    /// The motions that nothing resists at any speed, with their products with the inertia.
    pub motions: Vec<[Vec<f64>; 2]>,
    /// The least stiffness below the limit, by the inertia, that is no round-off.
    pub softest: Option<f64>,
}

/// The motions with a stiffness below `free` in `matrices`, which has that at speed zero and `least` of the inertia, and none by
/// N, of which `by_speed` are the entries. The joints allow `allowed` independent motions.
///
/// # Errors
/// Singular equations.
pub(super) fn unresisted(
    matrices: &Matrices,
    by_speed: &[f64],
    (rate, free, least): (f64, f64, f64),
    allowed: usize,
) -> Result<Unresisted, AssemblyFailure> {
    let n = matrices.unknowns;
    let factors = |s: f64| matrices.factors(s).map_err(|_| AssemblyFailure::Singular);
    let padded = |y: &[f64]| {
        let mut padded = y.to_vec();
        padded.resize(matrices.order(), 0.0);
        padded
    };
    let heavy = |y: &[f64]| {
        let mut out = matrices.mass.multiply(&padded(y));
        out.truncate(n);
        out
    };
    let solved = |factors: &mut SparseLu<f64>, right: &[f64]| {
        let mut out = padded(right);
        factors.solve(&mut out);
        out.truncate(n);
        out
    };
    let any = |k: usize| any_vector(n, 3.7 + k as f64);
    let mut soft = factors(0.0)?;
    let mut space: Vec<Vec<f64>> = (0..allowed.min(MOST)).map(any).collect();
    for _ in 0..ITERATIONS {
        let mut next: Vec<Vec<f64>> = Vec::new();
        for own in &space {
            let mut y = solved(&mut soft, &heavy(own));
            let before = dot(&y, &heavy(&y)).sqrt();
            for _ in 0..2 {
                for other in &next {
                    let along = dot(other, &heavy(&y));
                    add_scaled(&mut y, -along, other);
                }
            }
            let size = dot(&y, &heavy(&y)).sqrt();
            if size > DEPENDENT * before {
                y.iter_mut().for_each(|x| *x /= size);
                next.push(y);
            }
        }
        space = next;
    }
    // The stiffness of motions that the joints allow has no part of the reactions.
    let stiff = |y: &Vec<f64>| {
        let mut out = matrices.stiffness.multiply(&padded(y));
        out.truncate(n);
        out
    };
    let products: Vec<Vec<f64>> = space.iter().map(stiff).collect();
    let count = space.len();
    let ritz = DMatrix::from_fn(count, count, |i, j| dot(&space[i], &products[j]));
    space = rotated(space, ritz, free);
    if space.is_empty() {
        return Ok(Unresisted {
            motions: Vec::new(),
            softest: None,
        });
    }
    let sizes = matrices.stiffness.sizes();
    let firm = space.iter().filter_map(|y| {
        let size: Vec<f64> = y.iter().map(|y| y.abs()).collect();
        let round_off = f64::EPSILON * dot(&sizes.multiply(&padded(&size))[..n], &size);
        let stiffness = dot(&stiff(y), y) - least;
        (stiffness > FIRM * round_off).then_some(stiffness)
    });
    let softest = firm.reduce(f64::min);
    let mut turned = matrices.mass.clone();
    turned.values = by_speed.to_vec();
    let mut firm = factors(rate.sqrt())?;
    let response = |y: &Vec<f64>| {
        let mut right = turned.multiply(&padded(y));
        right.truncate(n);
        let mut out = solved(&mut firm, &right);
        out.iter_mut().for_each(|x| *x *= rate);
        out
    };
    let responses: Vec<Vec<f64>> = space.iter().map(response).collect();
    let count = space.len();
    let gram = DMatrix::from_fn(count, count, |i, j| {
        dot(&responses[i], &heavy(&responses[j]))
    });
    let space = rotated(space, gram, ZERO * ZERO);
    let with_inertia = |y: Vec<f64>| {
        let m = heavy(&y);
        [y, m]
    };
    Ok(Unresisted {
        motions: space.into_iter().map(with_inertia).collect(),
        softest,
    })
}

/// The combinations of vectors for the eigenvalues of a symmetric matrix below a limit.
fn rotated(space: Vec<Vec<f64>>, matrix: DMatrix<f64>, limit: f64) -> Vec<Vec<f64>> {
    let symmetric = (&matrix + matrix.transpose()) * 0.5;
    let own = symmetric.symmetric_eigen();
    let small = (0..space.len()).filter(|&k| own.eigenvalues[k].abs() <= limit);
    let combined = small.map(|k| {
        let mut out = vec![0.0; space[0].len()];
        for (i, y) in space.iter().enumerate() {
            add_scaled(&mut out, own.eigenvectors[(i, k)], y);
        }
        out
    });
    combined.collect()
}
