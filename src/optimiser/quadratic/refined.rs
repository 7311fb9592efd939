//! Solution of a subproblem to the last digits, after an interior-point solver has found the active
//! set.

use nalgebra::{DMatrix, DVector};

use crate::constants::{AGREE, ROUND_OFF, SMALL_PART};
use crate::quadratic::data::{Hessian, QpData, QpStep};

/// Solves the conditions for the active set of `found` as equations,
///
/// B d + Aᵀ y = −g for the variables inside the box, a_jᵀ d = room_j for the active rows;
///
/// `None` if a row stays violated, the equations are singular, another bound would be violated, or
/// a multiplier would get the wrong sign.
pub(crate) fn refine(data: &QpData<'_>, found: &QpStep) -> Option<QpStep> {
    let Hessian::Dense(b) = data.b else {
        return None;
    };
    let (n, m) = (found.d.len(), found.y.len());
    let radius = data.upper.amax().max(data.lower.amax());
    let force = data.g.amax().max(radius * data.b.amax());
    let mut d = DVector::zeros(n);
    let mut inside = Vec::new();
    for i in 0..n {
        if found.d[i] - data.lower[i] <= SMALL_PART * radius {
            d[i] = data.lower[i];
        } else if data.upper[i] - found.d[i] <= SMALL_PART * radius {
            d[i] = data.upper[i];
        } else {
            inside.push(i);
        }
    }
    let reached = data.a * &found.d;
    let mut rows: Vec<(usize, f64)> = Vec::new();
    for j in 0..m {
        let (above, below) = (data.above[j] - reached[j], data.below[j] + reached[j]);
        let y = found.y[j];
        let norm = data.a.row_amax(j).max(1e-100);
        let pushes =
            |room: f64| y.abs() * norm * norm * radius > room * force.max(f64::MIN_POSITIVE);
        if y.abs() >= (1.0 - SMALL_PART) * data.penalty[j] {
            return None;
        } else if data.above[j] == -data.below[j] || (y > 0.0 && pushes(above)) {
            rows.push((j, data.above[j]));
        } else if y < 0.0 && pushes(below) {
            rows.push((j, -data.below[j]));
        }
    }
    let (p, q) = (inside.len(), rows.len());
    if p < q || p == 0 {
        return None;
    }
    // Scales rows and forces to entries of the same size.
    let unit = b.amax().max(f64::MIN_POSITIVE);
    let norm = |j: usize| data.a.row_amax(j).max(1e-100);
    let fixed_force = data.g + b.as_ref() * &d;
    let fixed_rows = data.a * &d;
    let matrix = DMatrix::from_fn(p + q, p + q, |r, c| match (r < p, c < p) {
        (true, true) => b[(inside[r], inside[c])] / unit,
        (true, false) => data.a[(rows[c - p].0, inside[r])] / norm(rows[c - p].0),
        (false, true) => data.a[(rows[r - p].0, inside[c])] / norm(rows[r - p].0),
        (false, false) => 0.0,
    });
    let rhs = DVector::from_fn(p + q, |r, _| {
        if r < p {
            -fixed_force[inside[r]] / unit
        } else {
            let (j, room) = rows[r - p];
            (room - fixed_rows[j]) / norm(j)
        }
    });
    let factor = matrix.clone().lu();
    let mut solution = factor.solve(&rhs)?;
    solution += factor.solve(&(&rhs - &matrix * &solution))?;
    for (k, &i) in inside.iter().enumerate() {
        d[i] = solution[k];
    }
    let mut y = DVector::zeros(m);
    for (k, &(j, _)) in rows.iter().enumerate() {
        y[j] = solution[p + k] * unit / norm(j);
    }
    let refined = QpStep { d, y };
    is_valid(data, found, &refined, radius, force).then_some(refined)
}

/// Whether `refined` is near `found` and in the box, satisfies all rows, and has multipliers of the
/// right signs.
fn is_valid(data: &QpData<'_>, found: &QpStep, refined: &QpStep, radius: f64, force: f64) -> bool {
    let QpStep { d, y } = refined;
    let residual = data.g + data.b.multiply(d) + data.a.tr_mul(y);
    let reached = data.a * d;
    let (small, weak) = (ROUND_OFF * radius, ROUND_OFF * force);
    let near = (d - &found.d).amax() <= AGREE * radius;
    let in_box = (0..d.len()).all(|i| {
        let push = residual[i];
        d[i] >= data.lower[i]
            && d[i] <= data.upper[i]
            && (d[i] == data.lower[i] || push <= weak)
            && (d[i] == data.upper[i] || push >= -weak)
    });
    let rows = (0..y.len()).all(|j| {
        let slack = small * data.a.row_amax(j);
        let equality = data.above[j] == -data.below[j];
        let found = found.y[j];
        reached[j] <= data.above[j] + slack
            && -reached[j] <= data.below[j] + slack
            && y[j].abs() <= data.penalty[j]
            && (equality || y[j] * found >= 0.0)
    });
    near && in_box && rows
}
