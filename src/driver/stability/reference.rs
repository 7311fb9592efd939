//! An independent integrator for the references of the stability suite: extrapolation of the
//! modified midpoint rule (Gragg, Bulirsch & Stoer; Hairer, Nørsett & Wanner 1993, section II.9) on
//! equations in minimal coordinates. It shares no code with the tested methods.

/// Substeps of the midpoint rule in the columns of the extrapolation.
const SUBSTEPS: [usize; 8] = [2, 4, 6, 8, 10, 12, 14, 16];
/// Largest error of a step, relative to the largest component.
const TOLERANCE: f64 = 1e-14;

/// y(`end`) of ẏ = f(y) with y(0) = `start`.
pub(super) fn integrate<const N: usize>(
    f: impl Fn(&[f64; N]) -> [f64; N],
    start: [f64; N],
    end: f64,
) -> [f64; N] {
    let (mut t, mut y, mut h) = (0.0, start, 1e-3 * end);
    while t < end {
        h = f64::min(h, end - t);
        let last = end - t <= h;
        let (next, error) = step(&f, &y, h);
        let size = largest(&y).max(largest(&next));
        let relative = error / (TOLERANCE * size);
        if relative <= 1.0 || h <= 1e-12 * end {
            t = if last { end } else { t + h };
            y = next;
        }
        let order = (2 * SUBSTEPS.len() - 1) as f64;
        h *= (0.9 * relative.max(1e-30).powf(-1.0 / order)).clamp(0.2, 3.0);
    }
    y
}

/// One step and its estimated error.
fn step<const N: usize>(
    f: &impl Fn(&[f64; N]) -> [f64; N],
    y: &[f64; N],
    h: f64,
) -> ([f64; N], f64) {
    let mut row: Vec<[f64; N]> = Vec::new();
    let mut error = f64::INFINITY;
    for (k, &n) in SUBSTEPS.iter().enumerate() {
        let mut value = midpoint(f, y, h, n);
        for j in 0..k {
            let ratio = (n as f64 / SUBSTEPS[k - 1 - j] as f64).powi(2);
            let before = row[j];
            row[j] = value;
            value = std::array::from_fn(|i| value[i] + (value[i] - before[i]) / (ratio - 1.0));
        }
        if let Some(best) = row.last() {
            let change: [f64; N] = std::array::from_fn(|i| value[i] - best[i]);
            error = largest(&change);
        }
        row.push(value);
    }
    (row[SUBSTEPS.len() - 1], error)
}

/// The modified midpoint rule with n substeps, smoothed.
fn midpoint<const N: usize>(
    f: &impl Fn(&[f64; N]) -> [f64; N],
    y: &[f64; N],
    h: f64,
    n: usize,
) -> [f64; N] {
    let h = h / n as f64;
    let rate = f(y);
    let mut before = *y;
    let mut now: [f64; N] = std::array::from_fn(|i| y[i] + h * rate[i]);
    for _ in 1..n {
        let rate = f(&now);
        let next = std::array::from_fn(|i| before[i] + 2.0 * h * rate[i]);
        (before, now) = (now, next);
    }
    let rate = f(&now);
    std::array::from_fn(|i| 0.5 * (now[i] + before[i] + h * rate[i]))
}

fn largest<const N: usize>(y: &[f64; N]) -> f64 {
    y.iter().fold(0.0, |m: f64, y| m.max(y.abs()))
}

/// Jacobi's elliptic functions sn, cn and dn of modulus `k` < 1 by the descending Landen
/// transformation (Abramowitz & Stegun 1964, section 16.4).
pub(super) fn jacobi(u: f64, k: f64) -> [f64; 3] {
    let (mut a, mut c) = (vec![1.0], vec![k]);
    let mut b = (1.0 - k * k).sqrt();
    while c[c.len() - 1].abs() > 1e-16 && a.len() < 20 {
        let last = a[a.len() - 1];
        a.push(0.5 * (last + b));
        c.push(0.5 * (last - b));
        b = (last * b).sqrt();
    }
    let n = a.len() - 1;
    // Whole periods 4 K = 2 π / a_N are subtracted first, so that 2^N a_N u keeps its digits.
    let period = 2.0 * std::f64::consts::PI / a[n];
    let mut phi = 2.0_f64.powi(n as i32) * a[n] * (u % period);
    let mut first = phi;
    for i in (1..=n).rev() {
        first = phi;
        phi = 0.5 * (phi + (c[i] / a[i] * phi.sin()).asin());
    }
    let dn = if n == 0 {
        1.0
    } else {
        phi.cos() / (first - phi).cos()
    };
    [phi.sin(), phi.cos(), dn]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extrapolation_meets_a_circle_and_a_pendulum() {
        let circle = integrate(|y: &[f64; 2]| [y[1], -y[0]], [1.0, 0.0], 20.0);
        assert!((circle[0] - 20.0_f64.cos()).abs() < 1e-12, "{circle:?}");
        // θ̈ = −sin θ from rest: sin(θ/2) = k cn/dn.
        let end = integrate(|y: &[f64; 2]| [y[1], -y[0].sin()], [1.0, 0.0], 7.0);
        let k = 0.5_f64.sin();
        let [_, cn, dn] = jacobi(7.0, k);
        let angle = 2.0 * (k * cn / dn).asin();
        assert!((end[0] - angle).abs() < 1e-12, "{} {angle}", end[0]);
    }

    #[test]
    fn elliptic_functions_have_their_values() {
        // Abramowitz & Stegun, table 16.1 by way of sn(K/2) = 1/√(1 + k'), and identities.
        let k: f64 = 0.8;
        let [sn, cn, dn] = jacobi(0.3, k);
        assert!((sn * sn + cn * cn - 1.0).abs() < 1e-15);
        assert!((dn * dn + k * k * sn * sn - 1.0).abs() < 1e-14);
        // K(0.8) = 1.995 302 777 664 729 4.
        let [sn, ..] = jacobi(0.5 * 1.995_302_777_664_729_4, k);
        assert!((sn - 1.0 / 1.6_f64.sqrt()).abs() < 1e-14, "{sn}");
    }
}
