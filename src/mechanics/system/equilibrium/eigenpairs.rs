//! Eigenvectors of small motions, right ones r = (y, μ) and left ones l, from good eigenvalues.
//!
//! Inverse iteration with the factors of Q(σ) = K + σ D + σ² M at a complex σ near an eigenvalue, for the pairs of
//! [`super::krylov`] and their transpose,
//!
//! ```text
//! Q r = −(D + 2 σ M) y − M w,  w ← y;     Qᵀ l = a,  a ← b − (D + 2 σ M)ᵀ l,  b ← −Mᵀ l
//! ```
//!
//! has the eigenvectors themselves as limits. Eigenvalues that are nearly equal have a common space, whose bases are made
//! such that l_iᵀ (D + 2 s M) y_j = δ_ij.

use super::contracted::Between;
use super::pencil::{Matrices, product};
use crate::linalg::{SparseLu, complex_eigenvalues};
use crate::math::Complex64;
use crate::system::failure::AssemblyFailure;
use nalgebra::DMatrix;

/// Inverse iterations, and steps that refine a single pair.
const ITERATIONS: usize = 8;
const REFINEMENTS: usize = 2;
/// Distance of σ from the eigenvalue, relative to it.
const ASIDE: f64 = 1e-9;
/// Relative distance up to which an eigenvector is that of the eigenvalue from which it is sought.
const NEAR: f64 = 1e-3;
/// Relative distance of eigenvalues that form a cluster.
const CLUSTER: f64 = 1e-6;

/// Eigenvalues that are equal, but for a part of about 1e-6, with bases of their spaces.
#[derive(Clone, Debug)]
pub(super) struct Cluster {
    pub values: Vec<Complex64>,
    /// Right vectors with multipliers.
    pub right: Vec<Vec<Complex64>>,
    /// Left vectors with multipliers, not conjugated, biorthonormal to the right ones.
    pub left: Vec<Vec<Complex64>>,
}

impl Cluster {
    /// The pairs whose sum is −w lᵀ (dK + s dD + s² dM) r, as a mean over the cluster, with its mean rate s; dD counts by
    /// `damping`.
    pub(super) fn change(&self, weight: Complex64, damping: f64) -> Vec<Between<'_>> {
        let count = self.values.len() as f64;
        let mean = self.values.iter().sum::<Complex64>() / count;
        let part = -weight / count;
        let pairs = self.left.iter().zip(&self.right);
        pairs
            .map(|(left, right)| Between {
                left,
                right,
                factors: [part, part * mean * damping, part * mean * mean],
            })
            .collect()
    }
}

type Vector = Vec<Complex64>;

fn dot(a: &[Complex64], b: &[Complex64]) -> Complex64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Makes pairs orthonormal, both halves alike.
fn orthonormalise(all: &mut [[Vector; 2]]) -> Option<()> {
    for i in 0..all.len() {
        for _ in 0..2 {
            for j in 0..i {
                let (before, rest) = all.split_at_mut(i);
                let (own, other) = (&mut rest[0], &before[j]);
                let along: Complex64 = (own.iter().zip(other))
                    .flat_map(|(own, other)| own.iter().zip(other))
                    .map(|(own, other)| own * other.conj())
                    .sum();
                for (own, other) in own.iter_mut().zip(other) {
                    own.iter_mut()
                        .zip(other)
                        .for_each(|(own, other)| *own -= along * other);
                }
            }
        }
        let square: f64 = all[i].iter().flatten().map(|x| x.norm_sqr()).sum();
        let size = square.sqrt();
        if !(size > 0.0 && size.is_finite()) {
            return None;
        }
        all[i].iter_mut().flatten().for_each(|x| *x /= size);
    }
    Some(())
}

/// Q(s) x = (K + s D + s² M) x, or its transpose.
fn whole(matrices: &Matrices, x: &[Complex64], s: Complex64, transposed: bool) -> Vector {
    let [mut out, damped] = matrices.products(x, transposed);
    let heavy = product(&matrices.mass, x, transposed);
    for (out, (d, m)) in out.iter_mut().zip(damped.iter().zip(&heavy)) {
        *out += s * (d + s * m);
    }
    out
}

/// (D + 2 s M) x, or its transpose, of D x.
fn slope(
    matrices: &Matrices,
    (x, mut damped): (&[Complex64], Vector),
    s: Complex64,
    transposed: bool,
) -> Vector {
    let heavy = product(&matrices.mass, x, transposed);
    (damped.iter_mut().zip(&heavy)).for_each(|(a, b)| *a += s * 2.0 * b);
    damped
}

struct Shifted<'a> {
    matrices: &'a Matrices,
    factors: SparseLu<Complex64>,
    shift: Complex64,
}

impl Shifted<'_> {
    /// (D + 2 σ M) x, or its transpose.
    fn slope(&self, x: &[Complex64], transposed: bool) -> Vector {
        let damped = product(&self.matrices.damping, x, transposed);
        slope(self.matrices, (x, damped), self.shift, transposed)
    }

    /// Refines a single pair by its residuals Q(s) r and Qᵀ(s) l: iterations leave round-off of the largest entries in
    /// all of a vector, and the growth of a mode with little damping is a small part of its rate.
    fn refine(&mut self, pair: &mut Cluster) {
        let ([s], [right], [left]) = (
            &mut pair.values[..],
            &mut pair.right[..],
            &mut pair.left[..],
        ) else {
            return;
        };
        for _ in 0..REFINEMENTS {
            for (x, transposed) in [(&mut *right, false), (&mut *left, true)] {
                let mut change = whole(self.matrices, x, *s, transposed);
                match transposed {
                    false => self.factors.solve(&mut change),
                    true => self.factors.solve_transposed(&mut change),
                }
                self.matrices.leave_out(&mut change);
                let along = |y: &[Complex64]| -> Complex64 {
                    x.iter().zip(y).map(|(x, y)| x.conj() * y).sum()
                };
                let part = along(&change) / along(x);
                for (x, change) in x.iter_mut().zip(&change) {
                    *x += part * *x - change;
                }
            }
            // D by strains, as in the residual.
            let [_, damped] = self.matrices.products(right, false);
            let rate = dot(left, &slope(self.matrices, (right, damped), *s, false));
            *s -= dot(left, &whole(self.matrices, right, *s, false)) / rate;
            left.iter_mut().for_each(|x| *x /= rate);
        }
    }

    fn right(&mut self, [y, w]: &[Vector; 2]) -> [Vector; 2] {
        let mut right = self.slope(y, false);
        let heavy = product(&self.matrices.mass, w, false);
        right
            .iter_mut()
            .zip(&heavy)
            .for_each(|(a, b)| *a = -(*a + b));
        self.factors.solve(&mut right);
        self.matrices.leave_out(&mut right);
        // The multipliers are those of the solution, and have no part in products.
        [right, y.clone()]
    }

    /// The next (a, b), and l.
    fn left(&mut self, [a, b]: &[Vector; 2]) -> ([Vector; 2], Vector) {
        let mut l = a.clone();
        self.factors.solve_transposed(&mut l);
        self.matrices.leave_out(&mut l);
        let mut next = self.slope(&l, true);
        next.iter_mut().zip(b).for_each(|(x, b)| *x = b - *x);
        let mut last = product(&self.matrices.mass, &l, true);
        last.iter_mut().for_each(|x| *x = -*x);
        ([next, last], l)
    }
}

/// Eigenvalues by clusters, in the order of the first of each.
pub(super) fn groups(values: &[Complex64]) -> Vec<Vec<Complex64>> {
    let mut all: Vec<Vec<Complex64>> = Vec::new();
    for &value in values {
        let near = |own: &&mut Vec<Complex64>| (value - own[0]).norm() <= CLUSTER * own[0].norm();
        match all.iter_mut().find(near) {
            Some(own) => own.push(value),
            None => all.push(vec![value]),
        }
    }
    all
}

/// The eigenvectors of some eigenvalues, by clusters.
///
/// # Errors
/// Singular equations, or values that are no eigenvalues.
pub(super) fn clusters(
    matrices: &Matrices,
    values: &[Complex64],
) -> Result<Vec<Cluster>, AssemblyFailure> {
    let all = groups(values).into_iter();
    all.map(|own| cluster(matrices, &own)).collect()
}

/// The eigenvectors of a cluster.
///
/// # Errors
/// As [`clusters`].
pub(super) fn cluster(
    matrices: &Matrices,
    values: &[Complex64],
) -> Result<Cluster, AssemblyFailure> {
    let found = iterated(matrices, values).ok_or(AssemblyFailure::Singular)?;
    let near = |value: &Complex64| {
        let mut own = values.iter();
        own.any(|own| (own - value).norm() <= NEAR * own.norm())
    };
    match found.values.iter().all(near) {
        true => Ok(found),
        false => {
            let why = "modes do not converge".into();
            Err(AssemblyFailure::NoModes { why })
        }
    }
}

fn iterated(matrices: &Matrices, values: &[Complex64]) -> Option<Cluster> {
    let p = values.len();
    let mean = values.iter().sum::<Complex64>() / p as f64;
    let shift = mean * Complex64::new(1.0 + ASIDE, ASIDE);
    let factors = matrices.factors(shift).ok()?;
    let mut shifted = Shifted {
        matrices,
        factors,
        shift,
    };
    let order = matrices.order();
    let start = |k: usize| -> [Vector; 2] {
        [0, 1].map(|half| {
            let any = |i: usize| ((1.0 + i as f64).sqrt() * (2.3 + k as f64)).fract() - 0.5;
            let mut x: Vector = (0..order)
                .map(|i| Complex64::new(any(2 * i + half), any(3 * i + 1 + half)))
                .collect();
            x[matrices.unknowns..].fill(Complex64::new(0.0, 0.0));
            x
        })
    };
    let mut rights: Vec<[Vector; 2]> = (0..p).map(start).collect();
    let mut lefts = rights.clone();
    let mut solved = vec![Vec::new(); p];
    for _ in 0..ITERATIONS {
        for own in &mut rights {
            *own = shifted.right(own);
        }
        orthonormalise(&mut rights)?;
        for (own, l) in lefts.iter_mut().zip(&mut solved) {
            (*own, *l) = shifted.left(own);
        }
        orthonormalise(&mut lefts)?;
        for (own, l) in lefts.iter().zip(&mut solved) {
            *l = shifted.left(own).1;
        }
    }
    let mut found = finish(&shifted, (rights, solved))?;
    shifted.refine(&mut found);
    Some(found)
}

/// The eigenvalues in the spaces of right and left vectors.
fn finish(
    shifted: &Shifted,
    (rights, mut left): (Vec<[Vector; 2]>, Vec<Vector>),
) -> Option<Cluster> {
    let p = rights.len();
    let right: Vec<Vector> = rights.into_iter().map(|[y, _]| y).collect();
    let matrices = shifted.matrices;
    for l in &mut left {
        let size = l.iter().map(|x| x.norm_sqr()).sum::<f64>().sqrt();
        l.iter_mut().for_each(|x| *x /= size);
    }
    let between = |of: &dyn Fn(&[Complex64]) -> Vector| {
        let products: Vec<Vector> = right.iter().map(|r| of(r)).collect();
        DMatrix::from_fn(p, p, |i, j| dot(&left[i], &products[j]))
    };
    let heavy = between(&|x| product(&matrices.mass, x, false));
    let slope = between(&|x| shifted.slope(x, false));
    let rest = between(&|x| whole(matrices, x, shifted.shift, false));
    // lᵀ (Q + δ Q' + δ² M) y = 0 with a small δ.
    let inverse = slope.clone().try_inverse()?;
    let mut change = -(&inverse * &rest);
    for _ in 0..3 {
        change = -(&inverse * (&rest + &heavy * &change * &change));
    }
    let values: Vec<Complex64> = match p {
        1 => vec![shifted.shift + change[(0, 0)]],
        _ => {
            let own = complex_eigenvalues(&change)?.into_iter();
            own.map(|x| shifted.shift + x).collect()
        }
    };
    // The slope at the mean of the eigenvalues.
    let mean = change.trace() / Complex64::new(p as f64, 0.0);
    let inverse = (slope + heavy * (mean * 2.0)).try_inverse()?;
    let combined = |i: usize| {
        let mut out = vec![Complex64::new(0.0, 0.0); matrices.order()];
        for (j, l) in left.iter().enumerate() {
            let part = inverse[(i, j)];
            out.iter_mut().zip(l).for_each(|(out, l)| *out += part * l);
        }
        out
    };
    let left: Vec<Vector> = (0..p).map(combined).collect();
    let finite = |x: &Complex64| x.re.is_finite() && x.im.is_finite();
    (values.iter().all(finite)).then_some(Cluster {
        values,
        right,
        left,
    })
}
