//! The free flight of a projectile: range and height over a barrier, with their derivatives.

use super::instant::{Gate, GateSide, Projectile};
use crate::math::scalar::length;
use crate::math::{Scalar, Vec3};
use crate::system::BodyMotion;
use crate::system::marker::{self, MarkerCotangent, MarkerKinematics};

/// State of a projectile in its plane of flight, and gravity.
#[derive(Clone, Copy, Debug)]
pub struct Flight<S> {
    /// Distance along the direction of flight \[m\].
    pub x: S,
    /// Height above the origin \[m\].
    pub y: S,
    /// Velocity along the direction of flight \[m/s\].
    pub vx: S,
    /// Velocity upwards \[m/s\].
    pub vy: S,
    /// Gravitational acceleration g > 0 \[m/s²\].
    pub g: S,
}

impl<S: Scalar> Flight<S> {
    /// The flight that starts from the present motion of the projectile's body.
    pub fn new(projectile: &Projectile<S>, motion: &BodyMotion<S>, gravity: &Vec3<S>) -> Self {
        let g = length(gravity);
        let up = gravity * (S::from(-1.0) / g);
        let jet = MarkerKinematics::point(motion, &projectile.point);
        Self {
            x: projectile.direction.dot(&jet.x),
            y: up.dot(&jet.x),
            vx: projectile.direction.dot(&jet.rate),
            vy: up.dot(&jet.rate),
            g,
        }
    }

    /// The numbers (x, y, v_x, v_y, g).
    pub fn to_array(self) -> [S; 5] {
        [self.x, self.y, self.vx, self.vy, self.g]
    }

    /// The flight with these numbers; see [`Flight::to_array`].
    pub fn from_array([x, y, vx, vy, g]: [S; 5]) -> Self {
        Self { x, y, vx, vy, g }
    }

    /// Range \[m\] on the ground at height y_g, if the path reaches it:
    /// R = x + (v_x/g)(v_y + √s0), s0 = v_y² + 2 g (y − y_g). Otherwise R is the distance
    /// x + v_x v_y/g of the path's highest point. `smooth_root` joins both.
    pub fn range(&self, ground: S) -> S {
        let [s0, scale] = self.reach(ground);
        self.x + self.vx / self.g * (self.vy + smooth_root(s0, scale))
    }

    /// s0 = v_y² + 2 g (y − y_g), the square of the upward speed at the ground, and the size of its
    /// terms, √(v_y⁴ + (2 g (y − y_g))² + δ⁴ v_x⁴) \[m²/s²\]. If the ground is below, s0 exceeds
    /// the first two terms, so the path reaches it. The third term keeps a slide along the ground
    /// regular.
    fn reach(&self, ground: S) -> [S; 2] {
        let rise = self.vy * self.vy;
        let fall = self.g * (self.y - ground) * 2.0;
        let slide = self.vx * self.vx * (SLIDE * SLIDE);
        let square = rise * rise + fall * fall + slide * slide;
        // At rest on the ground the range does not depend on the scale to first order.
        let scale = if square.re() > 0.0 {
            square.sqrt()
        } else {
            S::zero()
        };
        [rise + fall, scale]
    }

    /// Height of the path above `top` at the distance x_b \[m\],
    /// y + v_y T − ½ g T² − h_b with T = (x_b − x)/v_x.
    pub fn clearance(&self, distance: S, top: S) -> S {
        let t = (distance - self.x) / self.vx;
        self.y + self.vy * t - self.g * t * t * 0.5 - top
    }
}

/// Fraction ε of the scale below which the root of s0 is smoothed, and slope v_y/v_x = δ that
/// counts as zero.
const GRAZING: f64 = 1e-3;
const SLIDE: f64 = 1e-6;

/// √s0 for s0 ≥ ε w with w the `scale`, zero for s0 ≤ −ε w, and in between
/// √(ε w) z³ (11 − 14 z + 5 z²)/2 with z = (1 + s0/(ε w))/2. It has two continuous derivatives. The
/// derivative of the root itself is infinite at zero.
fn smooth_root<S: Scalar>(s0: S, scale: S) -> S {
    let band = scale * GRAZING;
    if band.re() <= 0.0 || s0.re() <= -band.re() {
        S::zero()
    } else if s0.re() >= band.re() {
        s0.sqrt()
    } else {
        let z = (s0 / band + 1.0) * 0.5;
        band.sqrt() * (z * z * z * (z * (z * 5.0 - 14.0) + 11.0)) * 0.5
    }
}

/// Derivatives of [`smooth_root`] in s0 and in the scale.
fn smooth_root_derivative(s0: f64, scale: f64) -> [f64; 2] {
    let band = scale * GRAZING;
    if band <= 0.0 || s0 <= -band {
        [0.0, 0.0]
    } else if s0 >= band {
        [0.5 / s0.sqrt(), 0.0]
    } else {
        let t = s0 / band;
        let z = 0.5 * (t + 1.0);
        let value = 0.5 * z * z * z * (z * (z * 5.0 - 14.0) + 11.0);
        let slope = 0.25 * z * z * (z * (z * 25.0 - 56.0) + 33.0);
        let root = band.sqrt();
        [slope / root, (0.5 * value - slope * t) * GRAZING / root]
    }
}

impl Flight<f64> {
    /// Derivatives of [`Flight::range`] in (x, y, v_x, v_y, g) and in the ground's height.
    pub fn range_derivative(&self, ground: f64) -> ([f64; 5], f64) {
        let Flight { y, vx, vy, g, .. } = *self;
        let [s0, scale] = self.reach(ground);
        let [by_s0, by_scale] = smooth_root_derivative(s0, scale);
        let speed = vy + smooth_root(s0, scale);
        let height = y - ground;
        // Derivatives of the scale w in v_x, v_y and the fall 2 g (y − y_g).
        let by_term = |term: f64| {
            if by_scale == 0.0 {
                0.0
            } else {
                by_scale * term / scale
            }
        };
        let by_vx = by_term(2.0 * SLIDE.powi(4) * vx.powi(3));
        let by_vy = by_s0 * 2.0 * vy + by_term(2.0 * vy.powi(3));
        let by_fall = by_s0 + by_term(2.0 * g * height);
        let by_y = vx * by_fall * 2.0;
        let by = [
            1.0,
            by_y,
            speed / g + vx / g * by_vx,
            vx / g * (1.0 + by_vy),
            -vx / (g * g) * speed + vx / g * by_fall * 2.0 * height,
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

/// Derivatives of a flight in its data.
pub struct FlightCotangent {
    /// In the position of the centre of mass.
    pub position: Vec3<f64>,
    /// In its velocity.
    pub velocity: Vec3<f64>,
    /// In rotation and angular velocity of the body, and in the point.
    pub marker: MarkerCotangent<f64>,
    /// In the direction of flight.
    pub direction: Vec3<f64>,
    /// In gravity.
    pub gravity: Vec3<f64>,
}

/// Pulls the cotangent of a flight back: the transposed derivative of [`Flight::new`].
pub fn pull_back(
    projectile: &Projectile<f64>,
    motion: &BodyMotion<f64>,
    gravity: &Vec3<f64>,
    [x, y, vx, vy, g]: [f64; 5],
) -> FlightCotangent {
    let size = gravity.norm();
    let up = gravity / -size;
    let jet = MarkerKinematics::point(motion, &projectile.point);
    let direction = &projectile.direction;
    let position = direction * x + up * y;
    let velocity = direction * vx + up * vy;
    let by_up = jet.x * y + jet.rate * vy;
    let cot = MarkerKinematics {
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

impl<P: Scalar> Gate<P> {
    /// Openness σ(±(θ − θ_c)/w), in [0, 1], at the rotation θ.
    pub fn openness<S: Scalar>(&self, rotation: S) -> S {
        let z = (rotation - self.limit) * (self.sign() / self.width);
        // Both forms are the same function. The exponent is never positive.
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
            GateSide::Above => GateSide::Below,
            GateSide::Below => GateSide::Above,
        };
        open * closed.openness(rotation) * self.sign() / self.width
    }

    fn sign(&self) -> f64 {
        match self.open {
            GateSide::Above => 1.0,
            GateSide::Below => -1.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::functions::Rotation;
    use crate::math::Complex64;
    use crate::math::scalar::COMPLEX_STEP;

    /// Complex-step derivative of f in component i of a flight.
    fn derivative(at: &Flight<f64>, i: usize, f: impl Fn(Flight<Complex64>) -> Complex64) -> f64 {
        let mut z = at.to_array().map(Complex64::from);
        z[i].im = COMPLEX_STEP;
        f(Flight::from_array(z)).im / COMPLEX_STEP
    }

    /// Flights at every scale: the ground is far below, level, above within reach, just within,
    /// just out of reach, and far out of reach.
    fn flights() -> Vec<(Flight<f64>, f64)> {
        let mut all = Vec::new();
        for size in [1e-3, 1.0, 1e3] {
            for speed in [1e-3, 1.1, 30.0, 1e3] {
                for (vx, vy) in [
                    (0.6, 0.8),
                    (1.0, 1e-3),
                    (1.0, 0.0),
                    (-0.8, 0.6),
                    (0.1, -1.0),
                ] {
                    for g in [1.62, 9.81] {
                        let (vx, vy, g) = (vx * speed * size, vy * speed * size, g * size);
                        let apex = 0.5 * vy * vy / g;
                        for up in [-3.0, -0.5, 0.5, 0.99, 0.9995, 1.0, 1.0005, 1.5, 30.0] {
                            let (x, y) = (2.0 * size, 0.7 * size);
                            all.push((Flight { x, y, vx, vy, g }, y + up * apex));
                        }
                        let (x, y) = (-size, 0.1 * size);
                        all.push((Flight { x, y, vx, vy, g }, 0.0));
                    }
                }
            }
        }
        all
    }

    #[test]
    fn derivatives_of_range_and_clearance_are_exact() {
        for (at, ground) in flights() {
            // The complex step must be small relative to the scale of s0.
            if at.reach(ground)[1] * GRAZING < 1e-18 {
                continue;
            }
            let (range, by_ground) = at.range_derivative(ground);
            let (clearance, _) = at.clearance_derivative(60.0);
            // The error is relative to the largest term of each sum.
            let speed = at.vx.hypot(at.vy);
            let moved = |i: usize| match i {
                0 | 1 => 1.0,
                4 => speed * speed / (at.g * at.g),
                _ => speed / at.g,
            };
            for i in 0..5 {
                let exact = derivative(&at, i, |f| f.range(Complex64::from(ground)));
                let size = exact.abs() + moved(i);
                assert!(
                    (range[i] - exact).abs() <= 1e-11 * size,
                    "{at:?} {ground}: {i}"
                );
                let exact = derivative(&at, i, |f| f.clearance(60.0.into(), 70.0.into()));
                let size = 1.0 + exact.abs();
                assert!((clearance[i] - exact).abs() <= 1e-12 * size, "over {i}");
            }
            let lifted = Flight::from_array(at.to_array().map(Complex64::from));
            let exact = lifted.range(Complex64::new(ground, COMPLEX_STEP)).im / COMPLEX_STEP;
            assert!((by_ground - exact).abs() <= 1e-11 * (1.0 + exact.abs()));
        }
    }

    #[test]
    fn range_is_that_of_a_parabola_wherever_it_comes_down() {
        let mut found = 0;
        for (at, ground) in flights() {
            let s0 = at.vy * at.vy + 2.0 * at.g * (at.y - ground);
            let terms = at.vy * at.vy + 2.0 * at.g * (at.y - ground).abs();
            if s0 < 1e-3 * terms || terms == 0.0 {
                continue;
            }
            found += 1;
            let t = (at.vy + s0.sqrt()) / at.g;
            // s0 is exact up to the round-off of its terms.
            let size = at.x.abs() + (at.vx / at.g).abs() * (at.vy.abs() + terms / s0.sqrt());
            let away = at.range(ground) - (at.x + at.vx * t);
            assert!(away.abs() <= 4e-16 * size, "{at:?} {ground}");
        }
        assert!(found > 400, "{found}");
    }

    #[test]
    fn range_does_not_depend_on_the_unit_of_length() {
        for (at, ground) in flights() {
            for unit in [1e-3, 1e3] {
                let scaled = Flight::from_array(at.to_array().map(|z| z * unit));
                let (range, same) = (at.range(ground), scaled.range(ground * unit) / unit);
                // At the border of reach the heights cancel.
                let size = range.abs() + at.x.abs() + (at.vx * at.vy / at.g).abs();
                assert!((range - same).abs() <= 1e-11 * size, "{at:?} {ground}");
            }
        }
    }

    #[test]
    fn range_is_smooth_where_the_ground_comes_out_of_reach() {
        let range = |ground: f64| {
            let (x, y, vx, vy, g) = (0.0, 0.0, 3.0, 4.0, 9.81);
            let at = Flight { x, y, vx, vy, g };
            (at.range(ground), at.range_derivative(ground).1)
        };
        let apex = 8.0 / 9.81;
        let steps = 4000;
        let step = 8e-3 * apex / f64::from(steps);
        let grounds = (0..=steps).map(|i| apex * (1.0 - 4e-3) + step * f64::from(i));
        let values: Vec<(f64, f64)> = grounds.map(range).collect();
        let mut bend = 0.0_f64;
        for pair in values.windows(2) {
            assert!(pair[1].0 <= pair[0].0, "falls as the ground rises");
            bend = bend.max((pair[1].1 - pair[0].1).abs());
        }
        let steepest = values.iter().fold(0.0_f64, |m, v| m.max(v.1.abs()));
        assert!(bend < 2e-2 * steepest, "{bend:e} of {steepest:e}");
        assert_eq!(
            values[values.len() - 1],
            (12.0 / 9.81, 0.0),
            "the highest point"
        );
    }

    #[test]
    fn a_stone_at_rest_on_the_ground_has_a_range_and_no_infinite_derivative() {
        for vx in [0.0, 2.0] {
            let at = Flight {
                x: 1.0,
                y: 0.0,
                vx,
                vy: 0.0,
                g: 9.81,
            };
            let (by, by_ground) = at.range_derivative(0.0);
            assert!(by.into_iter().chain([by_ground]).all(f64::is_finite));
            assert!((at.range(0.0) - 1.0).abs() < 1e-8 * (1.0 + vx * vx));
        }
    }

    #[test]
    fn a_gate_never_overflows_and_has_its_exact_derivative() {
        let rotation = Rotation::<f64> {
            body: 0,
            relative_to: None,
            axis: Vec3::z(),
            placed: None,
            first: None,
            joint: None,
        };
        for open in [GateSide::Above, GateSide::Below] {
            let gate = Gate {
                rotation,
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
