//! Quadratic subproblem with elastic constraints, solved by Clarabel.

use std::time::Instant;

use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus};
use nalgebra::DVector;

use crate::constants::HALF_OF_DIGITS;
use crate::linear::jacobian::Jacobian;
use crate::outcome::Counts;
use crate::quadratic::data::{Hessian, QpData, QpStep, settings};
use crate::quadratic::refined::refine;
use crate::quadratic::split;

/// The subproblem
///
/// ```text
/// minimise    gᵀd + ½ dᵀB d + Σ ν_j e_j
/// subject to  c_L − e ≤ c + A d ≤ c_U + e,   e ≥ 0,   d_L ≤ d ≤ d_U
/// ```
///
/// It always has a solution. It is solved in t = d/Δ, so that the absolute tolerances of Clarabel
/// are relative to the size Δ of the box.
pub(crate) struct ElasticQp {
    n: usize,
    has_lower: Vec<bool>,
    has_upper: Vec<bool>,
    solver: Option<DefaultSolver<f64>>,
    /// The Jacobian of the last subproblem, for its pattern.
    last: Option<Jacobian>,
}

impl ElasticQp {
    /// A solver for `n` variables and rows with the given sets of finite bounds.
    pub(crate) fn new(n: usize, row_lower: &DVector<f64>, row_upper: &DVector<f64>) -> ElasticQp {
        let finite = |v: &DVector<f64>| v.iter().map(|b| b.is_finite()).collect();
        ElasticQp {
            n,
            has_lower: finite(row_lower),
            has_upper: finite(row_upper),
            solver: None,
            last: None,
        }
    }

    /// Solves the subproblem, then the equations of its active set or, if these do not hold for a short
    /// step, the subproblem in a smaller box. `None` if Clarabel fails or its answer violates the optimality
    /// conditions.
    pub(crate) fn solve(&mut self, data: &QpData<'_>, counts: &mut Counts) -> Option<QpStep> {
        let found = self.solve_once(data, counts)?;
        if let Some(refined) = refine(data, &found) {
            return Some(refined);
        }
        let size = found.d.amax();
        let radius = data.upper.amax().max(data.lower.amax());
        if size == 0.0 || size > HALF_OF_DIGITS.sqrt() * radius {
            return Some(found);
        }
        let (lower, upper) = (
            data.lower.map(|v| v.max(-10.0 * size)),
            data.upper.map(|v| v.min(10.0 * size)),
        );
        let near = QpData {
            lower: &lower,
            upper: &upper,
            ..*data
        };
        Some(self.solve_once(&near, counts).unwrap_or(found))
    }

    fn solve_once(&mut self, data: &QpData<'_>, counts: &mut Counts) -> Option<QpStep> {
        let clock = Instant::now();
        let step = self.solve_scaled(data);
        counts.quadratic_programs += 1;
        counts.quadratic_program_seconds += clock.elapsed().as_secs_f64();
        step
    }

    fn solve_scaled(&mut self, data: &QpData<'_>) -> Option<QpStep> {
        let (n, m) = (self.n, self.has_lower.len());
        let radius = data.upper.amax().max(data.lower.amax());
        if radius.partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
            return None;
        }
        // Divide the objective by Δ and by the largest force, the rows by Δ and by their norms.
        let force = data
            .g
            .amax()
            .max(data.penalty.amax())
            .max(radius * data.b.amax())
            .max(1e-100);
        let norms = DVector::from_fn(m, |j, _| data.a.row_amax(j).max(1e-8));
        let rhs = self.right_hand_side(data, &norms, radius);
        let q: Vec<f64> = (data.g.iter().map(|g| g / force))
            .chain((0..m).map(|j| data.penalty[j] * norms[j] / force))
            .collect();
        if self.last.as_ref().is_none_or(|a| !a.has_pattern_of(data.a)) {
            self.solver = None;
            self.last = Some(data.a.clone());
        }
        let values = self.row_values(data.a, &norms);
        let (status, t, z) = match data.b {
            Hessian::Dense(b) => {
                let mut p = Vec::with_capacity(n * (n + 1) / 2 + m);
                for k in 0..n {
                    p.extend((0..=k).map(|i| b[(i, k)] * radius / force));
                }
                let solver = match self.solver.take() {
                    Some(mut solver) => {
                        solver.update_data(&p, &q, &values, &rhs).ok()?;
                        solver
                    }
                    None => self.new_solver(data.a, p, &q, values, &rhs)?,
                };
                let solver = self.solver.insert(solver);
                solver.solve();
                let found = &solver.solution;
                (found.status, found.x.clone(), found.z.clone())
            }
            Hessian::Split(b) => {
                let rows = self.pattern(data.a, values);
                split::solve(&rows, b, radius / force, &q, &rhs)?
            }
        };
        if !matches!(status, SolverStatus::Solved | SolverStatus::AlmostSolved) {
            return None;
        }
        let mut y = DVector::zeros(m);
        let mut row = 0;
        for j in 0..m {
            if self.has_upper[j] {
                y[j] += z[row] * force / norms[j];
                row += 1;
            }
            if self.has_lower[j] {
                y[j] -= z[row] * force / norms[j];
                row += 1;
            }
        }
        let d = DVector::from_fn(n, |i, _| {
            (t[i] * radius).clamp(data.lower[i], data.upper[i])
        });
        let accurate = status == SolverStatus::Solved || is_stationary(data, &d, &y, force);
        (accurate && d.iter().chain(y.iter()).all(|v| v.is_finite())).then_some(QpStep { d, y })
    }

    /// Right-hand sides in the order of the rows: bounds of each row, e ≥ 0, box.
    ///
    /// |A t| is at most the sum of |A|. A larger bound is cut to that, and a larger violation is
    /// subtracted from the elastic variable.
    fn right_hand_side(&self, data: &QpData<'_>, norms: &DVector<f64>, radius: f64) -> Vec<f64> {
        let m = self.has_lower.len();
        let mut rhs = Vec::new();
        for j in 0..m {
            let reach = data.a.row(j).map(|(_, v)| v.abs()).sum::<f64>() / norms[j] + 1.0;
            let above = data.above[j] / (norms[j] * radius);
            let below = data.below[j] / (norms[j] * radius);
            let excess = (-above - reach).max(-below - reach).max(0.0);
            let cut = |room: f64| (room + excess).clamp(-reach, 2.0 * reach);
            if self.has_upper[j] {
                rhs.push(cut(above));
            }
            if self.has_lower[j] {
                rhs.push(cut(below));
            }
        }
        rhs.extend(std::iter::repeat_n(0.0, m));
        for i in 0..self.n {
            rhs.push(data.upper[i] / radius);
            rhs.push(-data.lower[i] / radius);
        }
        rhs
    }

    /// Non-zero values of the constraint matrix, column by column.
    fn row_values(&self, a: &Jacobian, norms: &DVector<f64>) -> Vec<f64> {
        let m = self.has_lower.len();
        let mut values = Vec::new();
        let (starts, places) = a.by_columns();
        for i in 0..self.n {
            for &(j, k) in &places[starts[i]..starts[i + 1]] {
                let v = a.values()[k] / norms[j];
                if self.has_upper[j] {
                    values.push(v);
                }
                if self.has_lower[j] {
                    values.push(-v);
                }
            }
            values.extend([1.0, -1.0]);
        }
        for j in 0..m {
            let sides = usize::from(self.has_upper[j]) + usize::from(self.has_lower[j]);
            values.extend(std::iter::repeat_n(-1.0, sides + 1));
        }
        values
    }

    fn new_solver(
        &self,
        a: &Jacobian,
        p: Vec<f64>,
        q: &[f64],
        values: Vec<f64>,
        rhs: &[f64],
    ) -> Option<DefaultSolver<f64>> {
        let (n, m) = (self.n, self.has_lower.len());
        let mut pointers = vec![0];
        let mut indices = Vec::new();
        for k in 0..n {
            indices.extend(0..=k);
            pointers.push(indices.len());
        }
        pointers.extend(std::iter::repeat_n(indices.len(), m));
        let p = CscMatrix::new(n + m, n + m, pointers, indices, p);
        let a = self.pattern(a, values);
        let cones = [NonnegativeConeT(a.m)];
        DefaultSolver::new(&p, q, &a, rhs, &cones, settings()?).ok()
    }

    /// The constraint matrix with the given values; zeros stay in the pattern.
    fn pattern(&self, a: &Jacobian, values: Vec<f64>) -> CscMatrix<f64> {
        let (n, m) = (self.n, self.has_lower.len());
        let sides = |j: usize| usize::from(self.has_upper[j]) + usize::from(self.has_lower[j]);
        let bounded: usize = (0..m).map(sides).sum();
        let total = bounded + m + 2 * n;
        let mut pointers = vec![0];
        let mut indices = Vec::new();
        let mut firsts = vec![0];
        for j in 0..m {
            firsts.push(firsts[j] + sides(j));
        }
        let (starts, places) = a.by_columns();
        for i in 0..n {
            for &(j, _) in &places[starts[i]..starts[i + 1]] {
                indices.extend(firsts[j]..firsts[j + 1]);
            }
            indices.extend([bounded + m + 2 * i, bounded + m + 2 * i + 1]);
            pointers.push(indices.len());
        }
        for j in 0..m {
            indices.extend(firsts[j]..firsts[j + 1]);
            indices.push(bounded + j);
            pointers.push(indices.len());
        }
        CscMatrix::new(total, n + m, pointers, indices, values)
    }
}

/// Whether the force g + B d + Aᵀy on every variable inside its box is small, 0 ≤ |y| ≤ ν.
fn is_stationary(data: &QpData<'_>, d: &DVector<f64>, y: &DVector<f64>, force: f64) -> bool {
    let residual = data.g + data.b.multiply(d) + data.a.tr_mul(y);
    let size = data.upper.amax().max(data.lower.amax());
    let balanced = (0..d.len()).all(|i| {
        let r = residual[i];
        let room = if r > 0.0 {
            d[i] - data.lower[i]
        } else {
            data.upper[i] - d[i]
        };
        r.abs() * room / size <= 1e-5 * force
    });
    balanced && (0..y.len()).all(|j| y[j].abs() <= (1.0 + 1e-5) * data.penalty[j] + 1e-8 * force)
}
