//! The free flight of a projectile: range and height over a barrier, with their derivatives.

use super::instant::{Gate, Projectile, Side};
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::system::Motion;
use crate::system::marker::{self, Jet, MarkerCotangent};

/// State of a projectile in its plane of flight, and the gravity that it flies in.
#[derive(Clone, Copy, Debug)]
pub struct Flight<S> {
    /// Distance along the direction of flight (m).
    pub x: S,
    /// Height above the origin (m).
    pub y: S,
    /// Velocity along the direction of flight (m/s).
    pub vx: S,
    /// Velocity upwards (m/s).
    pub vy: S,
    /// Gravitational acceleration g > 0 (m/s²).
    pub g: S,
}

impl<S: Scalar> Flight<S> {
    /// The flight that starts from the present motion of the projectile's body.
    pub fn new(projectile: &Projectile<S>, motion: &Motion<S>, gravity: &Vec3<S>) -> Self {
        let g = length(gravity);
        let up = gravity * (S::from(-1.0) / g);
        let jet = Jet::point(motion, &projectile.point);
        Self {
            x: projectile.direction.dot(&jet.x),
            y: up.dot(&jet.x),
            vx: projectile.direction.dot(&jet.rate),
            vy: up.dot(&jet.rate),
            g,
        }
    }

    /// The flight's five numbers.
    pub fn to_array(self) -> [S; 5] {
        [self.x, self.y, self.vx, self.vy, self.g]
    }

    /// The flight of five numbers in the order of [`Flight::to_array`].
    pub fn from_array([x, y, vx, vy, g]: [S; 5]) -> Self {
        Self { x, y, vx, vy, g }
    }

    /// Range to the ground at height y_g,
    /// R = x + (v_x/g)(v_y + √s), s = ½ (s0 + √(s0² + 1)), s0 = v_y² + 2 g (y − y_g) (m).
    /// The smoothing (1 m²/s²) keeps it analytic where the ground is out of reach.
    pub fn range(&self, ground: S) -> S {
        let s0 = self.vy * self.vy + self.g * (self.y - ground) * 2.0;
        self.x + self.vx / self.g * (self.vy + smooth_positive(s0).sqrt())
    }

    /// Height of the path above `top` at the distance x_b,
    /// y + v_y T − ½ g T² − h_b with T = (x_b − x)/v_x (m).
    pub fn clearance(&self, distance: S, top: S) -> S {
        let t = (distance - self.x) / self.vx;
        self.y + self.vy * t - self.g * t * t * 0.5 - top
    }
}

/// ½ (s0 + √(s0² + 1)), without cancellation where s0 is large and negative.
fn smooth_positive<S: Scalar>(s0: S) -> S {
    let root = (s0 * s0 + 1.0).sqrt();
    if s0.re() >= 0.0 {
        (s0 + root) * 0.5
    } else {
        S::from(0.5) / (root - s0)
    }
}

impl Flight<f64> {
    /// Derivatives of [`Flight::range`] in (x, y, v_x, v_y, g) and in the ground's height.
    pub fn range_derivative(&self, ground: f64) -> ([f64; 5], f64) {
        let Flight { y, vx, vy, g, .. } = *self;
        let s0 = vy * vy + 2.0 * g * (y - ground);
        let s = smooth_positive(s0);
        // ds/ds0 = s / √(s0² + 1), so d√s/ds0 = ½ √s / √(s0² + 1).
        let by_s0 = 0.5 * s.sqrt() / (s0 * s0 + 1.0).sqrt();
        let speed = vy + s.sqrt();
        let by_y = vx / g * by_s0 * 2.0 * g;
        let by = [
            1.0,
            by_y,
            speed / g,
            vx / g * (1.0 + by_s0 * 2.0 * vy),
            -vx / (g * g) * speed + vx / g * by_s0 * 2.0 * (y - ground),
        ];
        (by, -by_y)
    }

    /// Derivatives of [`Flight::clearance`] in (x, y, v_x, v_y, g) and in (distance, top).
    pub fn clearance_derivative(&self, distance: f64) -> ([f64; 5], [f64; 2]) {
        let t = (distance - self.x) / self.vx;
        let by_t = self.vy - self.g * t;
        let by_x = -by_t / self.vx;
        ([by_x, 1.0, by_x * t, t, -0.5 * t * t], [-by_x, -1.0])
    }
}

/// Where the cotangent of a flight goes.
pub struct FlightCotangent {
    /// By the position of the centre of mass.
    pub position: Vec3<f64>,
    /// By its velocity.
    pub velocity: Vec3<f64>,
    /// By rotation and angular velocity of the body, and by the point.
    pub marker: MarkerCotangent<f64>,
    /// By the direction of flight.
    pub direction: Vec3<f64>,
    /// By gravity.
    pub gravity: Vec3<f64>,
}

/// Pulls the cotangent of a flight back: the transposed derivative of [`Flight::new`].
pub fn pull_back(
    projectile: &Projectile<f64>,
    motion: &Motion<f64>,
    gravity: &Vec3<f64>,
    [x, y, vx, vy, g]: [f64; 5],
) -> FlightCotangent {
    let size = gravity.norm();
    let up = gravity / -size;
    let jet = Jet::point(motion, &projectile.point);
    let direction = &projectile.direction;
    let position = direction * x + up * y;
    let velocity = direction * vx + up * vy;
    let by_up = jet.x * y + jet.rate * vy;
    let cot = Jet {
        x: position,
        rate: velocity,
        acceleration: Vec3::zeros(),
        virtual_rate: Vec3::zeros(),
    };
    FlightCotangent {
        position,
        velocity,
        marker: marker::pull_back(motion, &projectile.point, &cot),
        direction: jet.x * x + jet.rate * vx,
        gravity: -(by_up - up * up.dot(&by_up)) / size - up * g,
    }
}

impl Gate {
    /// Openness σ(±(θ − θ_c)/w) in [0, 1] at the rotation θ.
    pub fn openness<S: Scalar>(&self, rotation: S) -> S {
        let z = (rotation - self.limit) * (self.sign() / self.width);
        // Either form is the same function; the exponent stays negative.
        if z.re() >= 0.0 {
            S::one() / ((-z).exp() + 1.0)
        } else {
            let e = z.exp();
            e / (e + 1.0)
        }
    }

    /// Derivative of [`Gate::openness`].
    pub fn openness_derivative(&self, rotation: f64) -> f64 {
        let open = self.openness(rotation);
        // 1 − σ(z) = σ(−z), without cancellation.
        let mut closed = *self;
        closed.open = match self.open {
            Side::Above => Side::Below,
            Side::Below => Side::Above,
        };
        open * closed.openness(rotation) * self.sign() / self.width
    }

    fn sign(&self) -> f64 {
        match self.open {
            Side::Above => 1.0,
            Side::Below => -1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Complex64;
    use crate::math::scalar::COMPLEX_STEP;

    /// Complex-step derivative of f in component i of a flight.
    fn derivative(at: &Flight<f64>, i: usize, f: impl Fn(Flight<Complex64>) -> Complex64) -> f64 {
        let mut z = at.to_array().map(Complex64::from);
        z[i].im = COMPLEX_STEP;
        f(Flight::from_array(z)).im / COMPLEX_STEP
    }

    #[test]
    fn derivatives_of_range_and_clearance_are_exact() {
        for z in [
            [-3.0, 12.0, 40.0, 55.0, 9.81],
            [5.0, -300.0, 30.0, -20.0, 9.81],
        ] {
            let at = Flight::from_array(z);
            let (range, _) = at.range_derivative(-10.0);
            let (clearance, _) = at.clearance_derivative(60.0);
            for i in 0..5 {
                let exact = derivative(&at, i, |f| f.range(Complex64::from(-10.0)));
                assert!(
                    (range[i] - exact).abs() <= 1e-13 * (1.0 + exact.abs()),
                    "range {i}"
                );
                let exact = derivative(&at, i, |f| f.clearance(60.0.into(), 70.0.into()));
                assert!(
                    (clearance[i] - exact).abs() <= 1e-13 * (1.0 + exact.abs()),
                    "over {i}"
                );
            }
        }
    }

    #[test]
    fn range_is_that_of_a_parabola() {
        let at = Flight {
            x: 2.0,
            y: 7.0,
            vx: 30.0,
            vy: 40.0,
            g: 9.81,
        };
        let range = at.range(-10.0);
        let t = (range - at.x) / at.vx;
        // The smoothing shortens √s by less than 1/(8 s^{3/2}).
        assert!((at.y + at.vy * t - 0.5 * at.g * t * t + 10.0).abs() < 1e-3);
    }

    #[test]
    fn a_gate_never_overflows_and_has_its_exact_derivative() {
        let axis = Vec3::z();
        for open in [Side::Above, Side::Below] {
            let gate = Gate {
                body: 0,
                axis,
                limit: -3.6,
                width: 0.15,
                open,
            };
            for theta in [-400.0, -3.9, -3.6, 1.5, 300.0] {
                let z = gate.openness(Complex64::new(theta, COMPLEX_STEP));
                assert!(z.is_finite() && (0.0..=1.0).contains(&z.re));
                let exact = z.im / COMPLEX_STEP;
                let given = gate.openness_derivative(theta);
                assert!((given - exact).abs() <= 1e-13 * exact.abs() + 1e-300);
            }
        }
    }
}
