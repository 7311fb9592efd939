//! Motions of the scenes in `problems/extreme` that are known independently of the program: in
//! closed form, or from equations in minimal coordinates.

use super::elastic::Elastic;
use super::reference::{integrate, jacobi};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Gravity of the scenes \[m/s²\].
const G: f64 = 9.81;
/// Above this angular frequency the expansion of a slow manifold in 1/ω² is exact to round-off.
const SLOW: f64 = 2e3;

/// A known motion.
#[derive(Clone, Copy, Debug)]
pub(super) enum Exact {
    /// Two rods of `length` \[m\] with these masses \[kg\] after `time` \[s\].
    DoublePendulum {
        masses: [f64; 2],
        length: f64,
        time: f64,
    },
    /// A bob on a spring of 1 m with √(k/m) = `omega` \[rad/s\], from rest at the horizontal.
    SpringPendulum { omega: f64, time: f64 },
    /// A block on a slide with a spring of 10 rad/s and this damping ratio.
    Oscillator { ratio: f64, time: f64 },
    /// A rod of 1 m on a hinge, at an angle from hanging \[rad\], rotating at `spin` \[rad/s\].
    Pendulum {
        radius: f64,
        start: f64,
        spin: f64,
        time: f64,
    },
    /// A free cylinder with this angular velocity about its axis and across it \[rad/s\].
    Top { spin: f64, coning: f64, time: f64 },
    /// A box of 1 m that rotates steadily about y.
    Wheel { spin: f64, time: f64 },
    /// The Kreisselmeier–Steinhauser function of 0.5 cos(2π t) over one turn.
    Aggregate { rho: f64 },
    /// A plate of 1 m on a horizontal line of hinges, released at rest from the horizontal.
    Door { time: f64 },
    /// Rods in one line that fly at a speed \[m/s\] and rotate at 3 rad/s.
    Dumbbell { speed: f64, time: f64 },
    /// A parallelogram that has rotated by an angle \[rad\] at a speed \[rad/s\].
    Parallelogram { speed: f64, angle: f64 },
    /// This many parallelograms in a row (MBS benchmark library, A02).
    FourBars { cells: usize, time: f64 },
    /// Bricard's mechanism (A04) after 10 s.
    Bricard,
    /// A flexible body.
    Elastic(Elastic),
}

/// Correct values of the functions of a scene, and the sizes to which errors are relative.
pub(super) struct Numbers {
    pub values: Vec<f64>,
    pub sizes: Vec<f64>,
}

impl Exact {
    /// Description for the table.
    pub fn source(self) -> &'static str {
        match self {
            Exact::DoublePendulum { .. } => "minimal coordinates by extrapolation",
            Exact::SpringPendulum { omega, .. } if omega < SLOW => {
                "Cartesian coordinates by extrapolation"
            }
            Exact::SpringPendulum { .. } => "slow manifold to 1/ω² by extrapolation",
            Exact::FourBars { .. } => "minimal coordinate by extrapolation",
            Exact::Elastic(own) => own.source(),
            Exact::Bricard => "an integration of its one coordinate to 1e-10",
            Exact::Pendulum { spin, .. } if spin != 0.0 => "minimal coordinate by extrapolation",
            Exact::Pendulum { .. } | Exact::Door { .. } => "elliptic functions",
            Exact::Aggregate { .. } => "quadrature of the closed form",
            Exact::Oscillator { .. }
            | Exact::Top { .. }
            | Exact::Wheel { .. }
            | Exact::Parallelogram { .. }
            | Exact::Dumbbell { .. } => "closed form",
        }
    }

    /// The correct values, in the order of the functions of the scene.
    pub fn numbers(self) -> Numbers {
        let (values, size) = match self {
            Exact::DoublePendulum {
                masses,
                length,
                time,
            } => (double_pendulum(masses, length, time), length),
            Exact::SpringPendulum { omega, time } if omega < SLOW => {
                (spring_pendulum(omega, time), 1.0)
            }
            Exact::SpringPendulum { omega, time } => (slow_spring_pendulum(omega, time), 1.0),
            Exact::Oscillator { ratio, time } => (vec![1.0 + oscillator(ratio, time)], 0.1),
            Exact::Pendulum {
                radius,
                start,
                spin,
                time,
            } => {
                let about_hinge = 1.0 / 3.0 + 0.25 * radius * radius;
                let angle = pendulum(0.5 * G / about_hinge, start, spin, time);
                (vec![angle.sin(), -angle.cos()], 1.0)
            }
            Exact::Top { spin, coning, time } => (top(spin, coning, time), 0.1),
            Exact::Wheel { spin, time } => {
                let angle = spin * time;
                let values = vec![0.5 * angle.cos(), -0.5 * angle.sin(), angle];
                let sizes = vec![0.5, 0.5, angle];
                return Numbers { values, sizes };
            }
            Exact::Aggregate { rho } => (vec![aggregate(rho)], 0.5),
            Exact::Door { time } => {
                let (width, depth) = (1.0_f64, 0.05_f64);
                let about_hinges = (width * width + depth * depth) / 12.0 + 0.25 * width * width;
                let angle = pendulum(0.5 * width * G / about_hinges, FRAC_PI_2, 0.0, time);
                (vec![0.5 * angle.sin(), -0.5 * angle.cos(), -0.9], 1.0)
            }
            Exact::Dumbbell { speed, time } => {
                let angle = 3.0 * time;
                (vec![angle.cos(), speed * time + angle.sin()], 1.0)
            }
            Exact::Parallelogram { speed, angle } => {
                // ∫ T dt of two rods about their ends, 0.02 m thick, and the coupler.
                let energy = (1.0 / 3.0 + 0.25 * 0.02 * 0.02 + 0.5) * speed * angle;
                let square = speed * speed;
                let values = vec![angle, angle, energy, speed, -square * angle.cos()];
                let sizes = vec![angle, angle, energy, speed, square];
                return Numbers { values, sizes };
            }
            Exact::FourBars { cells, time } => {
                let n = cells as f64;
                let stiffness = (0.5 * (n + 1.0) + n) * G / ((n + 1.0) / 3.0 + n);
                let angle = pendulum(stiffness, PI, 1.0, time);
                (vec![-angle.sin(), -angle.cos()], 1.0)
            }
            Exact::Elastic(own) => {
                let (values, sizes) = own.numbers();
                return Numbers { values, sizes };
            }
            Exact::Bricard => (
                vec![0.999_999_963_8, -1.000_269_012_7, 0.999_730_951_1],
                1.0,
            ),
        };
        let sizes = vec![size; values.len()];
        Numbers { values, sizes }
    }
}

/// Lower end of two rods, angles a and b from the horizontal.
fn double_pendulum([upper, lower]: [f64; 2], length: f64, time: f64) -> Vec<f64> {
    // In units of the length of a rod, √(l/g) and the mass of the upper rod.
    let ratio = lower / upper;
    let (a11, a12) = (1.0 / 3.0 + ratio, 0.5 * ratio);
    let rates = |y: &[f64; 4]| {
        let [a, b, u, v] = *y;
        let (sin, cos) = (a - b).sin_cos();
        let first = -a12 * sin * v * v - (0.5 + ratio) * a.cos();
        let second = a12 * sin * u * u - 0.5 * ratio * b.cos();
        // The second equation, divided by the ratio, has terms of order one.
        let (b12, b22, second) = (0.5 * cos, 1.0 / 3.0, second / ratio);
        let det = a11 * b22 - a12 * cos * b12;
        [
            u,
            v,
            (first * b22 - a12 * cos * second) / det,
            (a11 * second - b12 * first) / det,
        ]
    };
    let [a, b, ..] = integrate(rates, [-0.9, -1.2, 0.0, 0.0], time * (G / length).sqrt());
    vec![length * (a.cos() + b.cos()), length * (a.sin() + b.sin())]
}

fn spring_pendulum(omega: f64, time: f64) -> Vec<f64> {
    let rates = |y: &[f64; 4]| {
        let [x, z, u, v] = *y;
        let length = x.hypot(z);
        let pull = -omega * omega * (length - 1.0) / length;
        [u, v, pull * x, pull * z - G]
    };
    let [x, z, ..] = integrate(rates, [1.0, 0.0, 0.0, 0.0], time);
    vec![x, z]
}

/// The motion without vibration, r = 1 + (θ̇² − g sin θ)/ω² + O(1/ω⁴).
fn slow_spring_pendulum(omega: f64, time: f64) -> Vec<f64> {
    let soft = 1.0 / (omega * omega);
    let length = |a: f64, u: f64| 1.0 + soft * (u * u - G * a.sin());
    let rates = |y: &[f64; 2]| {
        let [a, u] = *y;
        let along = -G * a.cos();
        let stretching = soft * (2.0 * u * along - G * a.cos() * u);
        [u, (along - 2.0 * stretching * u) / length(a, u)]
    };
    let [a, u] = integrate(rates, [0.0, 0.0], time);
    let r = length(a, u);
    vec![r * a.cos(), r * a.sin()]
}

/// Displacement \[m\] of ẍ + 2 ζ ω ẋ + ω² x = 0 from rest at 0.1 m, ω = 10 rad/s.
fn oscillator(ratio: f64, time: f64) -> f64 {
    let (omega, start) = (10.0_f64, 0.1);
    let decay = ratio * omega;
    if ratio < 1.0 {
        let turn = omega * (1.0 - ratio * ratio).sqrt();
        let (sin, cos) = (turn * time).sin_cos();
        start * (-decay * time).exp() * (cos + decay / turn * sin)
    } else if ratio == 1.0 {
        start * (-decay * time).exp() * (1.0 + decay * time)
    } else {
        let root = omega * (ratio * ratio - 1.0).sqrt();
        let (fast, slow) = (-(decay + root), -omega * omega / (decay + root));
        start * (fast * (slow * time).exp() - slow * (fast * time).exp()) / (fast - slow)
    }
}

/// Angle from hanging of φ̈ = −`stiffness` sin φ.
fn pendulum(stiffness: f64, start: f64, spin: f64, time: f64) -> f64 {
    if spin != 0.0 {
        let rates = |y: &[f64; 2]| [y[1], -stiffness * y[0].sin()];
        return integrate(rates, [start, spin], time)[0];
    }
    let modulus = (0.5 * start).sin();
    let [_, cn, dn] = jacobi(stiffness.sqrt() * time, modulus);
    2.0 * (modulus * cn / dn).asin()
}

/// Tip and rim of a free cylinder. It cones at |H| / I₁ about its angular momentum H and also
/// rotates about its axis.
fn top(spin: f64, coning: f64, time: f64) -> Vec<f64> {
    let (mass, radius, length) = (2.0_f64, 0.1_f64, 0.5_f64);
    let across = mass * (3.0 * radius * radius + length * length) / 12.0;
    let along = 0.5 * mass * radius * radius;
    // The axis of the cylinder is along x, its own x axis along −z.
    let momentum = [along * spin, across * coning, 0.0];
    let size = momentum[0].hypot(momentum[1]);
    let axis = momentum.map(|x| x / size);
    let own = (1.0 - along / across) * spin * time;
    let (sin, cos) = own.sin_cos();
    // Its own axes in ground axes: e1 = −z, e2 = y, e3 = x.
    let tip = [0.5 * length, 0.0, 0.0];
    let rim = [0.0, radius * sin, -radius * cos];
    let turn = |p: [f64; 3]| turned(p, axis, size / across * time);
    [turn(tip), turn(rim)].concat()
}

/// p rotated about the unit vector n by an angle.
fn turned(p: [f64; 3], n: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = angle.sin_cos();
    let dot = p[0] * n[0] + p[1] * n[1] + p[2] * n[2];
    let cross = [
        n[1] * p[2] - n[2] * p[1],
        n[2] * p[0] - n[0] * p[2],
        n[0] * p[1] - n[1] * p[0],
    ];
    std::array::from_fn(|i| cos * p[i] + sin * cross[i] + (1.0 - cos) * dot * n[i])
}

/// g_m + ln( ∫ exp(ρ (g − g_m)) dt ) / ρ of g = 0.5 cos(2π t), by the trapezoidal rule, which is
/// spectrally accurate for a period.
fn aggregate(rho: f64) -> f64 {
    let n = 1_000_000;
    let term = |k: usize| (rho * 0.5 * ((TAU * k as f64 / n as f64).cos() - 1.0)).exp_m1();
    let mean = (0..n).map(term).sum::<f64>() / n as f64;
    0.5 + mean.ln_1p() / rho
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_references_of_the_spring_pendulum_agree() {
        let (direct, slow) = (spring_pendulum(SLOW, 1.0), slow_spring_pendulum(SLOW, 1.0));
        for (a, b) in direct.iter().zip(&slow) {
            assert!((a - b).abs() < 1e-10, "{a} {b}");
        }
    }

    #[test]
    fn references_conserve_what_they_should() {
        // A double pendulum of equal rods conserves energy at any scale.
        let near = double_pendulum([1.0, 1.0], 1.0, 2.0);
        let far = double_pendulum([3.0, 3.0], 1e6, 2e3);
        for (a, b) in near.iter().zip(&far) {
            assert!((a - b * 1e-6).abs() < 1e-10, "{a} {b}");
        }
        // Points of a rigid body keep their distance.
        let p = top(3.0, 10.0, 0.7);
        let square: f64 = (0..3).map(|i| (p[i] - p[i + 3]).powi(2)).sum();
        assert!((square - (0.0625 + 0.01)).abs() < 1e-15);
    }

    #[test]
    fn the_aggregate_runs_from_the_mean_to_the_maximum() {
        assert!(aggregate(1e-3).abs() < 1e-4);
        assert!((aggregate(1e6) - 0.5).abs() < 1e-4);
    }
}
