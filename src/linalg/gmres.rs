//! Generalised minimal residuals (Saad & Schultz 1986), for a matrix that is given by its products
//! with vectors.

use crate::math::slices::{add_scaled, dot};

/// A vector lies in the space of those before if orthogonalisation leaves less than this part of
/// it.
const DEPENDENT: f64 = 1e-15;

/// The x with the smallest |b − A x| in the Krylov space of at most `most` products.
///
/// It ends when |b − A x| ≤ `tolerance` |b|, or when the space grows no more.
pub(crate) fn gmres(
    mut product: impl FnMut(&[f64]) -> Vec<f64>,
    b: &[f64],
    tolerance: f64,
    most: usize,
) -> Vec<f64> {
    let norm = |x: &[f64]| dot(x, x).sqrt();
    let size = norm(b);
    if size == 0.0 || !size.is_finite() {
        return vec![0.0; b.len()];
    }
    let mut basis = vec![b.iter().map(|x| x / size).collect::<Vec<f64>>()];
    // The columns of R, the rotations that made it, and the right side in their basis.
    let (mut columns, mut rotations): (Vec<Vec<f64>>, Vec<(f64, f64)>) = Default::default();
    let mut rest = vec![size];
    for k in 0..most {
        let mut w = product(&basis[k]);
        let whole = norm(&w);
        let mut column = vec![0.0; k + 1];
        // Twice, so that round-off of the first pass goes.
        for _ in 0..2 {
            for (h, v) in column.iter_mut().zip(&basis) {
                let along = dot(v, &w);
                add_scaled(&mut w, -along, v);
                *h += along;
            }
        }
        let mut last = norm(&w);
        for (i, &(c, s)) in rotations.iter().enumerate() {
            let (x, y) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (c * x + s * y, c * y - s * x);
        }
        let ended = last <= DEPENDENT * whole;
        if ended {
            last = 0.0;
        }
        let length = column[k].hypot(last);
        if length == 0.0 || !length.is_finite() {
            break;
        }
        let (c, s) = (column[k] / length, last / length);
        column[k] = length;
        let left = rest[k];
        rest[k] = c * left;
        rest.push(-s * left);
        rotations.push((c, s));
        columns.push(column);
        if ended || (s * left).abs() <= tolerance * size {
            break;
        }
        basis.push(w.iter().map(|x| x / last).collect());
    }
    let count = columns.len();
    let mut y = rest[..count].to_vec();
    for i in (0..count).rev() {
        for j in i + 1..count {
            y[i] -= columns[j][i] * y[j];
        }
        y[i] /= columns[i][i];
    }
    let mut x = vec![0.0; b.len()];
    for (y, v) in y.iter().zip(&basis) {
        add_scaled(&mut x, *y, v);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::gmres;

    /// A matrix that differs from unity in three rows takes four products.
    #[test]
    fn a_matrix_near_unity_takes_few_products() {
        let n = 40;
        let mut products = 0;
        let apply = |x: &[f64]| -> Vec<f64> {
            let mut y = x.to_vec();
            for (row, factor) in [(3, 2.0), (17, -0.7), (31, 5.0)] {
                y[row] += x
                    .iter()
                    .enumerate()
                    .map(|(j, x)| factor * x / (j + 2) as f64)
                    .sum::<f64>();
            }
            y
        };
        let exact: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let b = apply(&exact);
        let x = gmres(
            |x| {
                products += 1;
                apply(x)
            },
            &b,
            1e-14,
            20,
        );
        assert!(products <= 5, "{products}");
        assert!(x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-13));
    }
}
