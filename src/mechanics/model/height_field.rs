//! Heights over a rectangular grid, as a natural bicubic spline.
//!
//! In each direction the curve through the values has two continuous derivatives and no curvature at the ends (de Boor 1978,
//! *A Practical Guide to Splines*, chapters IV and XVII). Beyond the ends it goes on straight. One row of heights is the same
//! everywhere across.

use crate::math::Scalar;

/// A surface h(u, v).
#[derive(Clone, Debug, PartialEq)]
pub struct HeightField {
    along: Vec<f64>,
    across: Vec<f64>,
    /// Of each point, by rows: h, ∂h/∂u, ∂h/∂v and ∂²h/∂u∂v.
    points: Vec<[f64; 4]>,
    /// No height between the points is larger.
    bound: f64,
}

/// The height and its derivatives at a place.
pub struct Height<S> {
    /// h \[m\].
    pub value: S,
    /// ∂h/∂u and ∂h/∂v.
    pub slope: [S; 2],
    /// ∂²h/∂u², ∂²h/∂u∂v and ∂²h/∂v² \[1/m\].
    pub curvature: [S; 3],
}

/// Factors of the values and slopes at two points of a list: of the curve and of its two derivatives.
type Weights<S> = [[[S; 2]; 2]; 3];

/// Slopes of the natural cubic spline through values at increasing places.
fn slopes(x: &[f64], y: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 2 {
        return vec![0.0; n];
    }
    // Rows h₁ s₀ + 2 (h₀ + h₁) s₁ + h₀ s₂ = 3 (h₁ d₀ + h₀ d₁); at the ends 2 s₀ + s₁ = 3 d₀.
    let step = |k: usize| x[k + 1] - x[k];
    let quotient = |k: usize| (y[k + 1] - y[k]) / step(k);
    let row = |k: usize| match k {
        0 => (0.0, 2.0, 1.0, 3.0 * quotient(0)),
        k if k == n - 1 => (1.0, 2.0, 0.0, 3.0 * quotient(n - 2)),
        k => {
            let (a, b) = (step(k - 1), step(k));
            let right = 3.0 * (b * quotient(k - 1) + a * quotient(k));
            (b, 2.0 * (a + b), a, right)
        }
    };
    let (mut upper, mut right) = (Vec::with_capacity(n), Vec::with_capacity(n));
    for k in 0..n {
        let (low, diagonal, high, own) = row(k);
        let (before, known) = match k {
            0 => (0.0, 0.0),
            k => (upper[k - 1], right[k - 1]),
        };
        let pivot: f64 = diagonal - low * before;
        upper.push(high / pivot);
        right.push((own - low * known) / pivot);
    }
    for k in (0..n - 1).rev() {
        right[k] -= upper[k] * right[k + 1];
    }
    right
}

/// The points next to a place in a list, and their weights there.
fn weights<S: Scalar>(x: &[f64], at: S) -> ([usize; 2], Weights<S>) {
    let (zero, one) = (S::zero(), S::one());
    let last = x.len() - 1;
    if last == 0 {
        let mut only = [[[zero; 2]; 2]; 3];
        only[0][0][0] = one;
        return ([0, 0], only);
    }
    let beyond = |k: usize| {
        let straight = [[one, at - x[k]], [zero; 2]];
        ([k, k], [straight, [[zero, one], [zero; 2]], [[zero; 2]; 2]])
    };
    if at.re() <= x[0] {
        return beyond(0);
    }
    if at.re() >= x[last] {
        return beyond(last);
    }
    // A place that is not a number has a height that is none.
    let k = x.partition_point(|own| *own <= at.re()).max(1) - 1;
    let h = x[k + 1] - x[k];
    let s = (at - x[k]) / h;
    let (s2, s3) = (s * s, s * s * s);
    let rise = s2 * 3.0 - s3 * 2.0;
    let value = [[one - rise, (s3 - s2 * 2.0 + s) * h], [rise, (s3 - s2) * h]];
    let rate = (s - s2) * (6.0 / h);
    let by = [
        [-rate, s2 * 3.0 - s * 4.0 + 1.0],
        [rate, s2 * 3.0 - s * 2.0],
    ];
    let bend = (one - s * 2.0) * (6.0 / (h * h));
    let second = [[-bend, (s * 6.0 - 4.0) / h], [bend, (s * 6.0 - 2.0) / h]];
    ([k, k + 1], [value, by, second])
}

/// The largest ordinate of Bernstein's polynomials of all patches: no place between the points is higher.
fn bound([along, across]: [&[f64]; 2], points: &[[f64; 4]]) -> f64 {
    let thirds = |x: &[f64], k: usize| {
        let before = k.checked_sub(1).map(|i| (x[i] - x[k]) / 3.0);
        let after = x.get(k + 1).map(|next| (next - x[k]) / 3.0);
        [Some(0.0), before, after]
            .into_iter()
            .flatten()
            .collect::<Vec<f64>>()
    };
    let mut most = f64::MIN;
    for (k, [h, hu, hv, huv]) in points.iter().enumerate() {
        let (i, j) = (k % along.len(), k / along.len());
        for du in thirds(along, i) {
            for dv in thirds(across, j) {
                most = most.max(h + hu * du + hv * dv + huv * du * dv);
            }
        }
    }
    most
}

impl HeightField {
    /// The surface through `heights`, a row of those `along` for each place `across`. The places increase, and there are as many.
    pub fn new(along: Vec<f64>, across: Vec<f64>, heights: &[Vec<f64>]) -> Self {
        let columns = along.len();
        let column = |of: &dyn Fn(usize) -> f64| {
            let values: Vec<f64> = (0..across.len()).map(of).collect();
            slopes(&across, &values)
        };
        let by_along: Vec<Vec<f64>> = heights.iter().map(|row| slopes(&along, row)).collect();
        let mut points = vec![[0.0; 4]; columns * across.len()];
        for i in 0..columns {
            let by_across = column(&|j| heights[j][i]);
            let twist = column(&|j| by_along[j][i]);
            for j in 0..across.len() {
                points[j * columns + i] = [heights[j][i], by_along[j][i], by_across[j], twist[j]];
            }
        }
        Self {
            bound: bound([&along, &across], &points),
            along,
            across,
            points,
        }
    }

    /// The height at (u, v).
    pub fn at<S: Scalar>(&self, u: S, v: S) -> Height<S> {
        let (columns, by_u) = weights(&self.along, u);
        let (rows, by_v) = weights(&self.across, v);
        let count = self.along.len();
        let sum = |a: usize, b: usize| {
            let mut sum = S::zero();
            for (row, [value_v, slope_v]) in rows.into_iter().zip(by_v[b]) {
                for (column, [value_u, slope_u]) in columns.into_iter().zip(by_u[a]) {
                    let [h, hu, hv, huv] = self.points[row * count + column];
                    sum += (value_u * h + slope_u * hu) * value_v;
                    sum += (value_u * hv + slope_u * huv) * slope_v;
                }
            }
            sum
        };
        Height {
            value: sum(0, 0),
            slope: [sum(1, 0), sum(0, 1)],
            curvature: [sum(2, 0), sum(1, 1), sum(0, 2)],
        }
    }

    /// A height that is not exceeded between the points \[m\].
    pub fn bound(&self) -> f64 {
        self.bound
    }

    /// The places of the points along and across \[m\].
    pub fn places(&self) -> [&[f64]; 2] {
        [&self.along, &self.across]
    }

    /// The radius of the tightest hollow at the points: that of the largest sphere that touches the surface at one place \[m\].
    pub fn tightest(&self) -> f64 {
        let mut largest = 0.0_f64;
        for &v in &self.across {
            for &u in &self.along {
                let own = self.at(u, v);
                let ([x, y], [a, b, c]) = (own.slope, own.curvature);
                // The eigenvalues of the second fundamental form against the first.
                let root = (1.0 + x * x + y * y).sqrt();
                let [l, m, n] = [a, b, c].map(|own| own / root);
                let (e, f, g) = (1.0 + x * x, x * y, 1.0 + y * y);
                let area = e * g - f * f;
                let mean = 0.5 * (e * n - 2.0 * f * m + g * l) / area;
                let gauss = (l * n - m * m) / area;
                largest = largest.max(mean + (mean * mean - gauss).max(0.0).sqrt());
            }
        }
        1.0 / largest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Complex64;
    use crate::math::scalar::COMPLEX_STEP;

    fn field() -> HeightField {
        let along = vec![0.0, 0.4, 1.0, 1.3, 2.0];
        let across = vec![-1.0, 0.0, 0.5, 2.0];
        let row = |v: &f64| {
            along
                .iter()
                .map(|u| (3.0 * u + v).sin() * 0.3 + u * v)
                .collect()
        };
        let heights: Vec<Vec<f64>> = across.iter().map(row).collect();
        HeightField::new(along, across, &heights)
    }

    #[test]
    fn no_place_has_no_height() {
        assert!(field().at(f64::NAN, 0.3).value.is_nan());
        assert!(field().at(0.3, f64::NAN).value.is_nan());
    }

    #[test]
    fn goes_through_its_points_and_on_straight() {
        let own = field();
        for (u, v) in [(0.4, 0.0), (1.3, 2.0), (2.0, -1.0), (0.0, 0.5)] {
            let exact = (3.0_f64 * u + v).sin() * 0.3 + u * v;
            assert!((own.at(u, v).value - exact).abs() < 1e-14, "{u} {v}");
        }
        let [a, b, c] = [2.5, 3.0, 3.5].map(|u| own.at(u, 0.3).value);
        assert!((a - 2.0 * b + c).abs() < 1e-12);
        // Planes are planes, also beyond the points, and one row is the same across.
        let plane = HeightField::new(
            vec![0.0, 1.0, 3.0],
            vec![0.0, 2.0],
            &[vec![1.0, 3.0, 7.0], vec![0.0, 2.0, 6.0]],
        );
        assert!((plane.at(5.0, -3.0).value - 12.5).abs() < 1e-12);
        let row = HeightField::new(vec![0.0, 1.0, 2.0], vec![0.0], &[vec![0.0, 1.0, 0.0]]);
        assert_eq!(row.at(0.7, 4.0).value, row.at(0.7, -1.0).value);
        assert_eq!(row.at(0.7, 4.0).slope[1], 0.0);
    }

    #[test]
    fn derivatives_agree_with_the_complex_step_and_are_continuous() {
        let own = field();
        let i = Complex64::new(0.0, COMPLEX_STEP);
        for u in [-0.4, 0.0, 0.2, 0.4, 0.9, 1.0, 1.7, 2.6] {
            for v in [-1.5, -0.4, 0.0, 0.3, 1.9, 2.2] {
                let real = own.at(u, v);
                let by_u = own.at(i + u, Complex64::from(v));
                let by_v = own.at(Complex64::from(u), i + v);
                let [a, b, c] = real.curvature;
                let pairs = [
                    (real.slope[0], by_u.value),
                    (real.slope[1], by_v.value),
                    (a, by_u.slope[0]),
                    (b, by_v.slope[0]),
                    (b, by_u.slope[1]),
                    (c, by_v.slope[1]),
                ];
                for (given, exact) in pairs {
                    assert!((given - exact.im / COMPLEX_STEP).abs() < 1e-12, "{u} {v}");
                }
                let near = own.at(u - 1e-9, v - 1e-9);
                for (a, b) in real.curvature.iter().zip(near.curvature) {
                    assert!((a - b).abs() < 1e-6, "{u} {v}: {a} {b}");
                }
            }
        }
    }

    /// A parabolic valley h = u²/2 has the radius 1 at its lowest line.
    #[test]
    fn the_tightest_hollow() {
        let along: Vec<f64> = (-20..=20).map(|k| 0.1 * f64::from(k)).collect();
        let row = along.iter().map(|u| 0.5 * u * u).collect();
        let own = HeightField::new(along, vec![0.0], &[row]);
        assert!((own.tightest() - 1.0).abs() < 1e-2, "{}", own.tightest());
        let hill = HeightField::new(vec![0.0, 1.0, 2.0], vec![0.0], &[vec![0.0, 1.0, 0.0]]);
        assert!(hill.tightest() > 1e3);
    }
}
