//! Stiffness and mass of shells as sparse matrices of the unknowns of their nodes, and static solutions.

use crate::linalg::cholesky::SymmetricPattern;
use crate::math::slices::dot;
use crate::model::finite::{FiniteElements, NODES, UNKNOWNS};
use crate::structures::modes::{Pencil, PencilFailure};
use crate::system::finite::{add_forces, energy, gather, part_tangent, per_area, tangent};

/// Newton iterations of a static solution.
const ITERATIONS: usize = 60;
/// Halvings of a Newton step.
const HALVINGS: usize = 12;
/// Residual, relative to the load, at which a static solution has converged.
const TOLERANCE: f64 = 1e-8;

/// Stiffness that holds a rigid edge together while vectors are made, relative to that of its nodes.
const TIED: f64 = 1e5;

/// Rows over the unknowns that vanish where an edge moves as a rigid body.
pub type Tie = Vec<Vec<(usize, f64)>>;

/// Shells with the matrices of their unknowns.
pub(super) struct Matrices<'a> {
    pub shells: &'a FiniteElements<f64>,
    /// K and M of small motions.
    pub linear: Pencil,
    /// A tangent stiffness.
    tangent: Pencil,
    /// Rows that vanish but for their stiffness.
    ties: Vec<(f64, Vec<(usize, f64)>)>,
}

impl<'a> Matrices<'a> {
    /// Assembles and factorises the matrices.
    ///
    /// # Errors
    /// [`PencilFailure`]: K is singular.
    pub(super) fn new(
        shells: &'a FiniteElements<f64>,
        ties: &[Tie],
    ) -> Result<Self, PencilFailure> {
        let count = shells.mesh.coordinates;
        let mut columns: Vec<Vec<usize>> = (0..count).map(|j| vec![j]).collect();
        let elements = shells.mesh.elements.iter();
        let elements = elements.map(|e| e.coordinates.iter().flatten().copied().collect());
        let tied = ties.iter().map(|tie| {
            let mut all: Vec<usize> = tie.iter().flatten().map(|&(i, _)| i).collect();
            all.sort_unstable();
            all.dedup();
            all
        });
        for all in elements
            .chain(shells.mesh.parts.iter().cloned())
            .chain(tied)
        {
            let all: Vec<usize> = all;
            for &j in &all {
                columns[j].extend(all.iter().filter(|&&i| i > j));
            }
        }
        for column in &mut columns {
            column.sort_unstable();
            column.dedup();
        }
        let pattern = SymmetricPattern::new(&columns);
        let mut linear = Pencil::new(pattern.clone());
        add_tangent(
            shells,
            &vec![0.0; count],
            &linear.pattern,
            &mut linear.stiffness,
        );
        // The least of K_ii / b_i² is that of the unknown that follows, in any units.
        let stiffness = |row: &[(usize, f64)]| {
            let all = row.iter().filter_map(|&(i, b)| {
                let slot = linear.pattern.slot(i, i)?;
                Some(linear.stiffness[slot] / (b * b))
            });
            TIED * all.reduce(f64::min).unwrap_or(0.0)
        };
        let rows = ties.iter().flatten();
        let ties: Vec<_> = rows.map(|row| (stiffness(row), row.clone())).collect();
        add_ties(&ties, &linear.pattern, &mut linear.stiffness);
        add_mass(shells, &linear.pattern, &mut linear.mass);
        linear.factorise_stiffness()?;
        Ok(Self {
            shells,
            linear,
            tangent: Pencil::new(pattern),
            ties,
        })
    }

    /// K x.
    pub(super) fn stiff(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        self.linear
            .pattern
            .multiply(&self.linear.stiffness, x, &mut y);
        y
    }

    /// M x.
    pub(super) fn heavy(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        self.linear.pattern.multiply(&self.linear.mass, x, &mut y);
        y
    }

    /// K⁻¹ x, with a step of refinement.
    pub(super) fn solve(&mut self, x: &[f64]) -> Vec<f64> {
        let mut y = x.to_vec();
        self.linear.solve(&mut y);
        let mut rest = self.stiff(&y);
        rest.iter_mut().zip(x).for_each(|(r, x)| *r = x - *r);
        self.linear.solve(&mut rest);
        y.iter_mut().zip(&rest).for_each(|(y, r)| *y += r);
        y
    }

    /// The part of the elastic forces that is quadratic in the unknowns, at x.
    pub(super) fn quadratic(&self, x: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; x.len()];
        add_forces(self.shells, x, &mut out);
        let back: Vec<f64> = x.iter().map(|x| -x).collect();
        add_forces(self.shells, &back, &mut out);
        out.iter_mut().for_each(|f| *f *= 0.5);
        out
    }

    /// The static solution under a load, by Newton's method from `x`; `None` if it does not converge.
    pub(super) fn statics(&mut self, load: &[f64], mut x: Vec<f64>) -> Option<Vec<f64>> {
        let size = dot(load, load).sqrt();
        let residual = |x: &[f64]| {
            let mut r: Vec<f64> = load.iter().map(|f| -f).collect();
            add_forces(self.shells, x, &mut r);
            for (k, row) in &self.ties {
                let force = k * along(row, x);
                row.iter().for_each(|&(i, b)| r[i] += b * force);
            }
            r
        };
        let potential = |x: &[f64]| {
            let tied = self.ties.iter();
            let tied = tied.map(|(k, row)| 0.5 * k * along(row, x).powi(2));
            energy(self.shells, x) + tied.sum::<f64>() - dot(load, x)
        };
        for _ in 0..ITERATIONS {
            let r = residual(&x);
            if dot(&r, &r).sqrt() <= TOLERANCE * size {
                return Some(x);
            }
            self.tangent.stiffness.fill(0.0);
            let Pencil {
                pattern, stiffness, ..
            } = &mut self.tangent;
            add_tangent(self.shells, &x, pattern, stiffness);
            add_ties(&self.ties, pattern, stiffness);
            self.tangent.factorise_stiffness().ok()?;
            let mut step = r.clone();
            self.tangent.solve(&mut step);
            let (before, along) = (potential(&x), dot(&r, &step));
            let mut part = 1.0;
            let moved = |part: f64| -> Vec<f64> {
                x.iter().zip(&step).map(|(x, s)| x - part * s).collect()
            };
            for _ in 0..HALVINGS {
                if potential(&moved(part)) <= before - 1e-4 * part * along + 1e-12 * before.abs() {
                    break;
                }
                part *= 0.5;
            }
            x = moved(part);
        }
        None
    }
}

/// A row times the unknowns.
fn along(row: &[(usize, f64)], x: &[f64]) -> f64 {
    row.iter().map(|&(i, b)| b * x[i]).sum()
}

/// Adds Σ k bᵀb of rows b.
fn add_ties(ties: &[(f64, Vec<(usize, f64)>)], pattern: &SymmetricPattern, values: &mut [f64]) {
    for (k, row) in ties {
        for &(i, a) in row {
            for &(j, b) in row.iter().filter(|(j, _)| *j <= i) {
                if let Some(slot) = pattern.slot(i, j) {
                    values[slot] += k * a * b;
                }
            }
        }
    }
}

fn add_tangent(
    shells: &FiniteElements<f64>,
    x: &[f64],
    pattern: &SymmetricPattern,
    values: &mut [f64],
) {
    let mut matrix = vec![0.0; UNKNOWNS * UNKNOWNS];
    for (i, element) in shells.mesh.elements.iter().enumerate() {
        tangent(shells, i, &gather(element, x), &mut matrix);
        let n = element.coordinates.len();
        let all = element.coordinates.iter().enumerate();
        for (k, row) in all.clone().filter_map(|(k, c)| Some((k, (*c)?))) {
            for (l, column) in all
                .clone()
                .take(k + 1)
                .filter_map(|(l, c)| Some((l, (*c)?)))
            {
                if let Some(slot) = pattern.slot(row.max(column), row.min(column)) {
                    values[slot] += matrix[k * n + l];
                }
            }
        }
    }
    for (part, coordinates) in shells.parts.iter().zip(&shells.mesh.parts) {
        let own: Vec<f64> = coordinates.iter().map(|&i| x[i]).collect();
        let matrix = part_tangent(part, &own);
        add_of_part(coordinates, pattern, values, |k, l| {
            matrix[k * coordinates.len() + l]
        });
    }
}

/// Adds the lower triangle of a matrix of the coordinates of a part.
fn add_of_part(
    coordinates: &[usize],
    pattern: &SymmetricPattern,
    values: &mut [f64],
    entry: impl Fn(usize, usize) -> f64,
) {
    for (k, &row) in coordinates.iter().enumerate() {
        for (l, &column) in coordinates[..=k].iter().enumerate() {
            if let Some(slot) = pattern.slot(row.max(column), row.min(column)) {
                values[slot] += entry(k, l);
            }
        }
    }
}

fn add_mass(shells: &FiniteElements<f64>, pattern: &SymmetricPattern, values: &mut [f64]) {
    for (i, element) in shells.mesh.elements.iter().enumerate() {
        let weights = per_area(shells, i);
        let all = element.coordinates.iter().zip(&element.moves);
        let all: Vec<_> = all.filter_map(|(c, m)| Some(((*c)?, m))).collect();
        for (k, (row, (a, along))) in all.iter().enumerate() {
            for (column, (b, other)) in &all[..=k] {
                if a / NODES == b / NODES
                    && let Some(slot) = pattern.slot(*row.max(column), *row.min(column))
                {
                    let share = element.shares[a % NODES][b % NODES];
                    values[slot] += weights[a / NODES] * share * along.dot(other);
                }
            }
        }
    }
    for (part, coordinates) in shells.parts.iter().zip(&shells.mesh.parts) {
        let inertia = &part.inertia;
        add_of_part(coordinates, pattern, values, |k, l| {
            inertia.products[inertia.place(k, l).0].trace()
        });
    }
}
