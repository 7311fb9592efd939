//! Eigenvalues s of small motions by Arnoldi's method, shifted and inverted: with s = σ + τ, θ = 1 / τ and w = τ y / σ,
//!
//! ```text
//! θ y = −Q⁻¹ ((D + 2 σ M) y + σ M w),     θ w = y / σ,     Q = K + σ D + σ² M with the rows of constraints
//! ```
//!
//! Several vectors start, so that copies of an eigenvalue are found, and where a space is exhausted another one follows. A
//! small machine has its whole space, and all eigenvalues of it.

use super::pencil::Matrices;
use crate::linalg::{SparseLu, eigenvalues};
use crate::math::Complex64;
use crate::math::slices::{add_scaled, dot};
use crate::system::failure::AssemblyFailure;
use nalgebra::DMatrix;
use std::ops::Range;

/// Vectors that start.
const STARTS: usize = 4;
/// A vector lies in the space of those before if this part of it is left.
const DEPENDENT: f64 = 1e-11;
/// First dimension for each eigenvalue, its growth, and its limit.
const DIMENSION: usize = 10;
const GROWTH: usize = 2;
const LARGEST: usize = 800;
/// Relative change of eigenvalues from one dimension to the next by which they have converged.
const CONVERGED: f64 = 1e-6;
/// Vibrations whose imaginary part is a smaller part of their rate are round-off of equal real rates.
const OSCILLATES: f64 = 1e-4;
/// σ, as a part of the largest eigenvalue that is wanted; and eigenvalues that count, relative to it.
const PART: f64 = 0.25;
const FREE: f64 = 1e-5;
/// Most searches by a shift of the vibrations found before; and the part of their reach below which another one follows.
const SEARCHES: usize = 4;
const NEARER: f64 = 0.1;
/// A search that fails is repeated by σ times this: an eigenvalue at σ leaves no factors.
const ASIDE: f64 = 1.3;
/// Part of |s| by which a vibration may grow by round-off.
pub(super) const GROWS: f64 = 1e-6;

/// Eigenvalues with positive imaginary part by size |s|.
pub(super) struct Found {
    pub values: Vec<Complex64>,
    /// Real positive ones by size. Some may be round-off, or have not converged.
    pub diverging: Vec<f64>,
    /// Whether there are no others.
    pub all: bool,
}

/// The space, with the operator in it.
struct Space<'a> {
    matrices: &'a Matrices,
    factors: SparseLu<f64>,
    shift: f64,
    /// Orthonormal pairs (y, w).
    basis: Vec<Vec<f64>>,
    /// Products of the first of them in the basis.
    columns: Vec<Vec<f64>>,
    /// Number of vectors that were drawn.
    drawn: usize,
    /// Largest dimension.
    most: usize,
}

impl<'a> Space<'a> {
    /// An empty space of a machine whose joints allow `allowed` independent motions.
    fn new(matrices: &'a Matrices, shift: f64, allowed: usize) -> Result<Self, AssemblyFailure> {
        let factors = (matrices.factors(shift)).map_err(|_| AssemblyFailure::Singular)?;
        Ok(Self {
            matrices,
            factors,
            shift,
            basis: Vec::new(),
            columns: Vec::new(),
            drawn: 0,
            most: 2 * allowed,
        })
    }

    fn product(&mut self, pair: &[f64]) -> Vec<f64> {
        let (n, order) = (self.matrices.unknowns, self.matrices.order());
        let padded = |x: &[f64]| {
            let mut x = x.to_vec();
            x.resize(order, 0.0);
            x
        };
        let (y, w) = (padded(&pair[..n]), padded(&pair[n..]));
        let mut right = self.matrices.damping.multiply(&y);
        let fast: Vec<f64> = (y.iter().zip(&w))
            .map(|(y, w)| self.shift * (2.0 * y + w))
            .collect();
        add_scaled(&mut right, 1.0, &self.matrices.mass.multiply(&fast));
        right.iter_mut().for_each(|x| *x = -*x);
        self.factors.solve(&mut right);
        right.truncate(n);
        self.matrices.leave_out(&mut right);
        right.extend(y[..n].iter().map(|y| y / self.shift));
        right
    }

    /// Removes the parts along the basis, which it gives. The rest is zero if it is round-off.
    fn orthogonalise(&self, x: &mut [f64]) -> (Vec<f64>, f64) {
        let before = dot(x, x).sqrt();
        let mut parts = vec![0.0; self.basis.len()];
        // Twice, so that round-off of the first pass goes.
        for _ in 0..2 {
            for (part, own) in parts.iter_mut().zip(&self.basis) {
                let along = dot(own, x);
                *part += along;
                add_scaled(x, -along, own);
            }
        }
        let rest = dot(x, x).sqrt();
        let counts = rest > DEPENDENT * before && self.basis.len() < self.most;
        (parts, if counts { rest } else { 0.0 })
    }

    /// Adds a vector that the joints allow; false if there is none.
    fn draw(&mut self) -> bool {
        for _ in 0..STARTS {
            self.drawn += 1;
            let seed = (self.drawn as f64).sqrt();
            let any: Vec<f64> = (0..2 * self.matrices.unknowns)
                .map(|i| ((1.0 + i as f64).sqrt() * seed * 7.31).fract() - 0.5)
                .collect();
            // The second product leaves out what has neither inertia nor damping.
            let once = self.product(&any);
            let mut x = self.product(&once);
            let (_, rest) = self.orthogonalise(&mut x);
            if rest > 0.0 && rest.is_finite() {
                x.iter_mut().for_each(|x| *x /= rest);
                self.basis.push(x);
                return true;
            }
        }
        false
    }

    /// Grows to a dimension; false if the whole space is smaller or not larger.
    fn grow(&mut self, dimension: usize) -> bool {
        while self.basis.len() < STARTS {
            if !self.draw() {
                break;
            }
        }
        while self.columns.len() < dimension {
            let Some(own) = self.basis.get(self.columns.len()).cloned() else {
                if self.draw() {
                    continue;
                }
                return false;
            };
            let mut next = self.product(&own);
            let (mut parts, rest) = self.orthogonalise(&mut next);
            if rest > 0.0 {
                next.iter_mut().for_each(|x| *x /= rest);
                self.basis.push(next);
                parts.push(rest);
            }
            self.columns.push(parts);
        }
        self.columns.len() < self.most
    }

    /// The eigenvalues s in the present space.
    fn rates(&self) -> Option<Vec<Complex64>> {
        let k = self.columns.len();
        let entry = |i: usize, j: usize| self.columns[j].get(i).copied().unwrap_or(0.0);
        let h = DMatrix::from_fn(k, k, entry);
        let largest = h.norm();
        let values = eigenvalues(&h)?;
        // Zero: what has no inertia.
        let values = (values.iter()).filter(|x| x.norm() > f64::EPSILON * largest);
        let rates = values.map(|x| {
            let reciprocal = 1.0 / x;
            let im = if x.im == 0.0 { 0.0 } else { reciprocal.im };
            Complex64::new(self.shift + reciprocal.re, im)
        });
        Some(rates.collect())
    }

    /// Those with positive imaginary part, by size, and the positive ones without.
    fn values(&self, sizes: &Range<f64>) -> Option<(Vec<Complex64>, Vec<f64>)> {
        let mut all = self.rates()?;
        all.retain(|s| s.norm() > sizes.start && s.norm() < sizes.end);
        let positive = all.iter().filter(|s| s.im == 0.0 && s.re > 0.0);
        let mut diverging: Vec<f64> = positive.map(|s| s.re).collect();
        diverging.sort_by(f64::total_cmp);
        all.retain(|s| s.im > OSCILLATES * s.norm());
        all.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        Some((all, diverging))
    }
}

/// The eigenvalues of least size within `sizes` with positive imaginary part, at least `count` of them if there are as many.
/// The joints allow `allowed` independent motions.
///
/// # Errors
/// Singular equations, or no convergence.
pub(super) fn lowest(
    matrices: &Matrices,
    (shift, sizes): (f64, Range<f64>),
    (count, allowed): (usize, usize),
) -> Result<Found, AssemblyFailure> {
    if allowed == 0 {
        return Ok(Found {
            values: Vec::new(),
            diverging: Vec::new(),
            all: true,
        });
    }
    let reach = |found: &Found| {
        let sizes = found.values.iter().take(count).map(|s| s.norm());
        sizes.fold(0.0, f64::max)
    };
    let search = |shift: f64, sizes: &Range<f64>| {
        let by = |shift: f64| search(matrices, (shift, sizes), (count, allowed));
        by(shift).or_else(|_| by(ASIDE * shift))
    };
    let mut found = search(shift, &sizes)?;
    let mut before = f64::INFINITY;
    // A shift that is far from the vibrations leaves round-off in them, and a far too large reach leaves out low ones.
    for _ in 0..SEARCHES {
        let now = reach(&found);
        if now >= NEARER * before {
            break;
        }
        // Free motions have s = 0 twice, which round-off divides by much where σ is too small for the stiffness.
        let counted = sizes.start.max(FREE * now)..sizes.end;
        let nearer = (PART * now).max(shift);
        found = search(nearer, &counted)?;
        before = now;
    }
    Ok(found)
}

/// The same by one shift.
fn search(
    matrices: &Matrices,
    (shift, sizes): (f64, &Range<f64>),
    (count, allowed): (usize, usize),
) -> Result<Found, AssemblyFailure> {
    let mut space = Space::new(matrices, shift, allowed)?;
    let mut dimension = DIMENSION * (count + STARTS);
    let mut before: Vec<Complex64> = Vec::new();
    loop {
        let more = space.grow(dimension.min(2 * allowed));
        let (values, diverging) = space.values(sizes).ok_or(AssemblyFailure::Singular)?;
        if !more {
            return Ok(Found {
                values,
                diverging,
                all: true,
            });
        }
        let near = |(a, b): (&Complex64, &Complex64)| (a - b).norm() <= CONVERGED * b.norm();
        let stays = values.len() >= count
            && before.len() >= count
            && before.iter().zip(&values).take(count).all(near);
        if stays {
            return Ok(Found {
                values: values[..count].to_vec(),
                diverging,
                all: false,
            });
        }
        if dimension > LARGEST {
            let why = format!("{count} modes do not converge");
            return Err(AssemblyFailure::NoModes { why });
        }
        before = values;
        dimension *= GROWTH;
    }
}

/// The rates of motions that grow, by size, without the conjugate ones: those above `least`, of all motions that the joints allow
/// or of those of least size if there are very many.
///
/// # Errors
/// Singular equations.
pub(super) fn growing(
    matrices: &Matrices,
    (shift, least): (f64, f64),
    allowed: usize,
) -> Result<Vec<Complex64>, AssemblyFailure> {
    let rates = |shift: f64| {
        let mut space = Space::new(matrices, shift, allowed)?;
        space.grow((2 * allowed).min(LARGEST));
        space.rates().ok_or(AssemblyFailure::Singular)
    };
    let mut all = rates(shift).or_else(|_| rates(ASIDE * shift))?;
    all.retain(|s| s.norm() > least && s.im >= 0.0 && s.re > GROWS * s.norm());
    all.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    Ok(all)
}
