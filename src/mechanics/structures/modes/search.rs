//! The lowest eigenvalues of a pair of sparse symmetric matrices: Lanczos, the count of what it found, and a
//! last step of inverse iteration.

use nalgebra::{Cholesky, DMatrix, SymmetricEigen};

use super::lanczos::{Basis, Found, Operator, largest};
use super::{ModalWork, Modes};
use crate::linalg::cholesky::{NotPositiveDefinite, SparseCholesky, SymmetricPattern};

/// Relative distance of eigenvalues below which they count as one cluster.
const CLUSTER: f64 = 1e-6;
/// Shift of a structure with rigid motions, relative to its largest eigenvalues.
const SHIFT: f64 = 1e-9;
/// Searches for what the count says is missing.
const SEARCHES: u64 = 6;

/// (K + s M)⁻¹ M.
struct Shifted<'a> {
    pattern: &'a SymmetricPattern,
    mass: &'a [f64],
    matrix: &'a [f64],
    solver: &'a mut SparseCholesky,
}

impl Operator for Shifted<'_> {
    fn order(&self) -> usize {
        self.pattern.order()
    }

    fn mass(&self, x: &[f64], y: &mut [f64]) {
        self.pattern.multiply(self.mass, x, y);
    }

    fn solve(&mut self, b: &mut [f64]) {
        self.solver.solve(b);
    }
}

impl Shifted<'_> {
    /// Solves (K + s M) x = b with a step of iterative refinement.
    fn solve_refined(&mut self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.solver.solve(&mut x);
        let mut rest = vec![0.0; b.len()];
        self.pattern.multiply(self.matrix, &x, &mut rest);
        for (r, b) in rest.iter_mut().zip(b) {
            *r = b - *r;
        }
        self.solver.solve(&mut rest);
        x.iter_mut().zip(&rest).for_each(|(x, d)| *x += d);
        x
    }
}

/// Eigenvalues of K z = λ M z in rising order, and their vectors with zᵀ M z = 1; `None` if M is not positive.
pub fn dense_pencil(
    stiffness: &DMatrix<f64>,
    mass: DMatrix<f64>,
) -> Option<(Vec<f64>, DMatrix<f64>)> {
    let lower = Cholesky::new(mass)?.l();
    let half = lower.solve_lower_triangular(stiffness)?;
    let reduced = lower.solve_lower_triangular(&half.transpose())?;
    let eigen = SymmetricEigen::new((&reduced + reduced.transpose()) * 0.5);
    let mut order: Vec<usize> = (0..eigen.eigenvalues.len()).collect();
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    let vectors = eigen.eigenvectors.select_columns(&order);
    let parts = lower.transpose().solve_upper_triangular(&vectors)?;
    Some((order.iter().map(|&k| eigen.eigenvalues[k]).collect(), parts))
}

/// Why a pair of matrices has no such modes.
#[derive(Clone, Debug, PartialEq)]
pub enum PencilFailure {
    /// K + sM has no factors.
    NotDefinite(NotPositiveDefinite),
    /// Nothing has mass.
    NoMass,
    /// There are fewer modes than requested.
    TooMany {
        /// Requested number.
        asked: usize,
        /// Existing number.
        there: usize,
    },
    /// The iteration did not converge.
    NoConvergence {
        /// Requested number.
        asked: usize,
        /// Number found.
        found: usize,
    },
}

/// Stiffness and mass in one pattern, ready for their modes.
pub struct Pencil {
    pub pattern: SymmetricPattern,
    /// K.
    pub stiffness: Vec<f64>,
    /// M.
    pub mass: Vec<f64>,
    /// K + s M, or K − μ M.
    shifted: Vec<f64>,
    solver: SparseCholesky,
}

impl Pencil {
    /// Analyses a pattern; the matrices are zero.
    pub fn new(pattern: SymmetricPattern) -> Self {
        let values = vec![0.0; pattern.entries()];
        Self {
            solver: SparseCholesky::new(&pattern),
            stiffness: values.clone(),
            mass: values.clone(),
            shifted: values,
            pattern,
        }
    }

    /// The `count` lowest modes besides the rigid `motions`, and those that form a cluster with the
    /// last.
    ///
    /// # Errors
    /// [`PencilFailure`] if K is singular for other motions, or there is no mass or fewer modes.
    pub fn lowest(&mut self, motions: Vec<Vec<f64>>, count: usize) -> Result<Modes, PencilFailure> {
        if self.mass.iter().all(|&m| m == 0.0) {
            return Err(PencilFailure::NoMass);
        }
        let shift = if motions.is_empty() {
            0.0
        } else {
            self.shift()
        };
        self.combine(shift);
        let mut work = ModalWork {
            factorisations: 1,
            solves: 0,
        };
        self.factorise()?;
        let mut locked = Basis::default();
        for motion in motions {
            let operator = self.operator();
            let mut w = motion;
            locked.orthogonalise(&mut w);
            if locked.push(&operator, w, 0.0).is_none() {
                return Err(PencilFailure::NoMass);
            }
        }
        let rigid = locked.len();
        let (mut wanted, mut exhausted) = (count + 2, false);
        for seed in 0..SEARCHES {
            let found = self.search(&mut locked, rigid, wanted, 7 + 1000 * seed, &mut work)?;
            exhausted |= found;
            let values = self.refine(&mut locked, rigid, &mut work)?;
            let Some((whole, gap)) = last_gap(&values, count, exhausted) else {
                if exhausted {
                    let there = values.len();
                    return Err(PencilFailure::TooMany {
                        asked: count,
                        there,
                    });
                }
                wanted = values.len() + 4;
                continue;
            };
            let below = self.count_below(gap, shift, &mut work)?;
            if below == rigid + whole {
                let vectors = locked.vectors.drain(rigid..rigid + whole).collect();
                return Ok(Modes {
                    rigid,
                    eigenvalues: values[..whole].to_vec(),
                    vectors,
                    all: exhausted && whole == values.len(),
                    work,
                });
            }
            // Some copies were missed: search orthogonally to the known ones.
            wanted = values.len() + below.saturating_sub(rigid + whole).max(1);
            exhausted = false;
        }
        let found = locked.len() - rigid;
        Err(PencilFailure::NoConvergence {
            asked: count,
            found,
        })
    }

    fn factorise(&mut self) -> Result<(), PencilFailure> {
        let factors = self.solver.factorise(&self.pattern, &self.shifted);
        factors.map_err(PencilFailure::NotDefinite)
    }

    /// Factorises K alone.
    ///
    /// # Errors
    /// [`PencilFailure::NotDefinite`].
    pub fn factorise_stiffness(&mut self) -> Result<(), PencilFailure> {
        self.combine(0.0);
        self.factorise()
    }

    /// Solves K x = b in place by the factors of K.
    pub fn solve(&mut self, b: &mut [f64]) {
        self.solver.solve(b);
    }

    fn operator(&mut self) -> Shifted<'_> {
        Shifted {
            pattern: &self.pattern,
            mass: &self.mass,
            matrix: &self.shifted,
            solver: &mut self.solver,
        }
    }

    /// A shift that is small relative to the large eigenvalues.
    fn shift(&self) -> f64 {
        let pattern = &self.pattern;
        let slots = (0..pattern.order()).filter_map(|j| pattern.slot(j, j));
        let ratios = slots
            .filter(|&at| self.mass[at] > 0.0)
            .map(|at| self.stiffness[at] / self.mass[at]);
        SHIFT * ratios.fold(f64::INFINITY, f64::min)
    }

    /// Writes K + s M.
    fn combine(&mut self, shift: f64) {
        let pairs = self.stiffness.iter().zip(&self.mass);
        for (to, (k, m)) in self.shifted.iter_mut().zip(pairs) {
            *to = k + shift * m;
        }
    }

    /// Adds modes to those that are known until there are `wanted`; true if there are no more.
    fn search(
        &mut self,
        locked: &mut Basis,
        rigid: usize,
        wanted: usize,
        seed: u64,
        work: &mut ModalWork,
    ) -> Result<bool, PencilFailure> {
        let missing = wanted.saturating_sub(locked.len() - rigid);
        let mut operator = self.operator();
        let Found {
            vectors,
            solves,
            exhausted,
            ..
        } = largest(&mut operator, locked, missing, seed);
        work.solves += solves;
        if vectors.len() < missing && !exhausted {
            return Err(PencilFailure::NoConvergence {
                asked: wanted,
                found: locked.len() - rigid + vectors.len(),
            });
        }
        for mut w in vectors {
            locked.orthogonalise(&mut w);
            locked.push(&operator, w, 0.0);
        }
        Ok(exhausted)
    }

    /// A step of inverse iteration, refined, and Rayleigh's quotients in the space of the modes, which
    /// come in ascending order then.
    fn refine(
        &mut self,
        locked: &mut Basis,
        rigid: usize,
        work: &mut ModalWork,
    ) -> Result<Vec<f64>, PencilFailure> {
        let known: Vec<Vec<f64>> = locked.products.drain(rigid..).collect();
        locked.vectors.truncate(rigid);
        let (count, n) = (known.len(), self.pattern.order());
        work.solves += 2 * count;
        let mut y: Vec<Vec<f64>> = Vec::with_capacity(count);
        for product in known {
            let mut w = self.operator().solve_refined(&product);
            locked.orthogonalise(&mut w);
            y.push(w);
        }
        let pattern = &self.pattern;
        let products = |values: &[f64]| -> Vec<Vec<f64>> {
            let one = |y: &Vec<f64>| {
                let mut product = vec![0.0; n];
                pattern.multiply(values, y, &mut product);
                product
            };
            y.iter().map(one).collect()
        };
        let (by_k, by_m) = (products(&self.stiffness), products(&self.mass));
        let gram = |list: &[Vec<f64>]| {
            DMatrix::from_fn(count, count, |i, j| {
                let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
                0.5 * (dot(&y[i], &list[j]) + dot(&y[j], &list[i]))
            })
        };
        let (k, m) = (gram(&by_k), gram(&by_m));
        // Vectors of very different frequencies have very different lengths.
        let scale: Vec<f64> = (0..count).map(|i| 1.0 / m[(i, i)].sqrt()).collect();
        let scaled = |a: &DMatrix<f64>| {
            DMatrix::from_fn(count, count, |i, j| a[(i, j)] * scale[i] * scale[j])
        };
        let (k, m) = (scaled(&k), scaled(&m));
        let failure = PencilFailure::NoConvergence {
            asked: count,
            found: 0,
        };
        if count == 0 {
            return Err(failure);
        }
        let (values, mix) = dense_pencil(&k, m).ok_or(failure)?;
        for i in 0..count {
            let combine = |list: &[Vec<f64>]| {
                let mut sum = vec![0.0; n];
                for (j, v) in list.iter().enumerate() {
                    let factor = mix[(j, i)] * scale[j];
                    sum.iter_mut().zip(v).for_each(|(s, v)| *s += factor * v);
                }
                sum
            };
            locked.vectors.push(combine(&y));
            locked.products.push(combine(&by_m));
        }
        Ok(values)
    }

    /// How many eigenvalues, rigid motions among them, lie below a gap. Leaves the factors of K + s M.
    fn count_below(
        &mut self,
        [low, high]: [f64; 2],
        shift: f64,
        work: &mut ModalWork,
    ) -> Result<usize, PencilFailure> {
        let mut below = None;
        // Another place in the gap, should rounding spoil the pivots at one.
        for part in [0.5, 0.37, 0.61, 0.29] {
            self.combine(-(low + part * (high - low)));
            work.factorisations += 1;
            let pattern = &self.pattern;
            below = self.solver.negative_eigenvalues(pattern, &self.shifted);
            if below.is_some() {
                break;
            }
        }
        self.combine(shift);
        work.factorisations += 1;
        self.factorise()?;
        below.ok_or(PencilFailure::NoConvergence { asked: 0, found: 0 })
    }
}

/// How many of the eigenvalues make whole clusters, `count` at least, and the gap above them.
fn last_gap(values: &[f64], count: usize, exhausted: bool) -> Option<(usize, [f64; 2])> {
    for whole in count.max(1)..=values.len() {
        match values.get(whole) {
            Some(next) if next - values[whole - 1] > CLUSTER * next => {
                return Some((whole, [values[whole - 1], *next]));
            }
            Some(_) => {}
            None if exhausted => return Some((whole, [1.5, 3.0].map(|x| x * values[whole - 1]))),
            None => return None,
        }
    }
    None
}
