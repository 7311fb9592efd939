//! Motions and deflections of flexible bodies that are known independently of the program.

use super::reference::integrate;
use std::f64::consts::{FRAC_PI_2, SQRT_2};

/// Young's modulus \[Pa\], width and length \[m\] of the plate of `cantilever_plate.json`.
const YOUNG: f64 = 1e9;
const WIDTH: f64 = 0.25;
/// Thickness of the plate that is bent far \[m\].
pub(super) const THIN: f64 = 0.01;
/// Deflection of the plates of different thickness \[m\].
pub(super) const DEFLECTION: f64 = 1e-3;
/// Points of the quadrature of the elastica.
const POINTS: usize = 20_000;
/// Strain from which on stress is not proportional to it.
const HOOKE: f64 = 0.1;
/// ρ A Ω² L⁴ / EI at which a plate that points inward buckles.
const BUCKLING: f64 = 32.201_906_99;
/// From this load on the elastica is asymptotic to 1e-6.
const ASYMPTOTIC: f64 = 200.0;

/// A known state of a flexible body.
#[derive(Clone, Copy, Debug)]
pub(super) enum Elastic {
    /// A cantilever plate of 1 m and this thickness \[m\] whose end a force deflects by `DEFLECTION`.
    Plate { thickness: f64 },
    /// A thin cantilever with the load P L² / EI at its end.
    Elastica { load: f64 },
    /// The thin cantilever, bent by a moment at its end to an arc of this angle \[rad\].
    Arc { angle: f64 },
    /// The thin cantilever with the load q L³ / EI along its length.
    Covered { load: f64 },
    /// A plate of 1 m that is shortened by this part; small strains only.
    Squeezed { strain: f64 },
    /// The same of its width.
    Across { strain: f64 },
    /// A plate of 1 m and 1 m thickness that a force bends in its plane by this; small deflections only.
    Sideways { deflection: f64 },
    /// A free plate of 1 × 0.25 × 0.02 m that is thrown with 1 m/s along z and (1, 4, 2) rad/s.
    Tumbling,
    /// A bar of 1 m that turns about its end with 10 rad/s = `turn` √(E/ρ) / L. It has a steady
    /// state below π/2 only.
    Bar { turn: f64, time: f64 },
    /// A plate of 1 m that points from a ring of radius 1 m to its axis and is compressed by turning with `turn` times
    /// the angular velocity at which it buckles, under a small weight.
    Inward { turn: f64 },
    /// The end of a chain of this many bodies of 1 m that falls with the velocity (1, 2) m/s.
    Chain { bodies: usize, time: f64 },
}

impl Elastic {
    /// Description for the table.
    pub(super) fn source(self) -> &'static str {
        match self {
            Elastic::Plate { .. } | Elastic::Sideways { .. } => "Timoshenko's beam",
            Elastic::Elastica { .. } => "the elastica by quadrature",
            Elastic::Arc { .. } => "an arc",
            Elastic::Covered { .. } => "the elastica by extrapolation",
            Elastic::Squeezed { .. } | Elastic::Across { .. } => "Hooke's law",
            Elastic::Tumbling => "energy and momenta of the start",
            Elastic::Inward { .. } => "the beam-column by extrapolation",
            Elastic::Bar { .. } | Elastic::Chain { .. } => "closed form",
        }
    }

    /// Values of the functions, and their sizes.
    pub(super) fn numbers(self) -> (Vec<f64>, Vec<f64>) {
        match self {
            Elastic::Plate { thickness } => {
                let (force, stiffness) = (force(thickness), bending(thickness));
                let shear = 5.0 / 6.0 * 0.5 * YOUNG * WIDTH * thickness;
                let deflection = force / (3.0 * stiffness) + force / shear;
                (
                    vec![deflection, 0.0],
                    vec![deflection, 0.5 * force * deflection],
                )
            }
            Elastic::Elastica { load } => {
                let energy = 0.5 * load * bending(THIN);
                (vec![elastica(load), 0.0], vec![1.0, energy])
            }
            Elastic::Arc { angle } => {
                let energy = 0.5 * angle * bending(THIN);
                (vec![(1.0 - angle.cos()) / angle, 0.0], vec![1.0, energy])
            }
            Elastic::Covered { load } => {
                let work = 0.5 * load * bending(THIN);
                (vec![covered(load) * bending(THIN), 0.0], vec![work; 2])
            }
            Elastic::Squeezed { strain } | Elastic::Across { strain } if strain >= HOOKE => {
                (vec![f64::NAN; 2], vec![1.0; 2])
            }
            Elastic::Squeezed { strain } => {
                let energy = 0.5 * strain * squeeze(strain);
                (vec![strain, 0.0], vec![strain, energy])
            }
            Elastic::Across { strain } => {
                let energy = 0.5 * strain * squeeze(strain);
                (vec![WIDTH * strain, 0.0], vec![WIDTH * strain, energy])
            }
            Elastic::Sideways { deflection } if deflection > HOOKE => {
                (vec![f64::NAN; 2], vec![1.0; 2])
            }
            Elastic::Sideways { deflection } => {
                let energy = 0.5 * deflection * sideways(deflection);
                (vec![deflection, 0.0], vec![deflection, energy])
            }
            Elastic::Tumbling => tumbling(),
            Elastic::Bar { turn, .. } if turn >= FRAC_PI_2 => (vec![f64::NAN; 2], vec![1.0; 2]),
            Elastic::Bar { turn, time } => {
                let (length, angle) = (turn.tan() / turn, 10.0 * time);
                let values = vec![length * angle.cos(), length * angle.sin()];
                (values, vec![length.abs(); 2])
            }
            Elastic::Inward { turn } => {
                let load = BUCKLING * turn * turn;
                // q L³ / EI, of the weight 2e-5 N/kg at 10 rad/s.
                let tip = -2e-7 * load * inward(load);
                (
                    vec![if turn < 1.0 { tip } else { f64::NAN }],
                    vec![tip.abs()],
                )
            }
            Elastic::Chain { bodies, time } => {
                let fall = -0.5 * 9.81 * time * time;
                (vec![bodies as f64 + time, 2.0 * time + fall], vec![1.0; 2])
            }
        }
    }
}

/// The force that shortens a plate of 1 m thickness by this part \[N\].
pub(super) fn squeeze(strain: f64) -> f64 {
    strain * YOUNG * WIDTH
}

/// Bending stiffness of the plate \[N m²\].
fn bending(thickness: f64) -> f64 {
    YOUNG * WIDTH * thickness.powi(3) / 12.0
}

/// The force that bends a plate by `DEFLECTION` \[N\].
pub(super) fn force(thickness: f64) -> f64 {
    3.0 * bending(thickness) * DEFLECTION
}

/// The force of the load P L² / EI of the elastica \[N\].
pub(super) fn force_of(load: f64) -> f64 {
    load * bending(THIN)
}

/// The moment that bends the plate to an arc of this angle \[N m\].
pub(super) fn moment(angle: f64) -> f64 {
    angle * bending(THIN)
}

/// The load on each area for the load q L³ / EI \[Pa\].
pub(super) fn cover(load: f64) -> f64 {
    load * bending(THIN) / WIDTH
}

/// The force that bends a plate of 1 m thickness in its plane by this deflection \[N\].
pub(super) fn sideways(deflection: f64) -> f64 {
    let stiffness = YOUNG * WIDTH.powi(3) / 12.0;
    let shear = 5.0 / 6.0 * 0.5 * YOUNG * WIDTH;
    deflection / (1.0 / (3.0 * stiffness) + 1.0 / shear)
}

/// Energy, momentum along z and angular momenta of the free plate, and their sizes.
fn tumbling() -> (Vec<f64>, Vec<f64>) {
    let (mass, sides, speed, spin) = (5.0, [1.0_f64, 0.25, 0.02], 1.0, [1.0, 4.0, 2.0]);
    let squares: f64 = sides.iter().map(|side| side * side).sum();
    let inertia = sides.map(|side| mass / 12.0 * (squares - side * side));
    let angular: [f64; 3] = std::array::from_fn(|k| inertia[k] * spin[k]);
    let turning: f64 = (0..3).map(|k| 0.5 * angular[k] * spin[k]).sum();
    let energy = 0.5 * mass * speed * speed + turning;
    let size = angular.iter().map(|x| x * x).sum::<f64>().sqrt();
    let values = [vec![energy, mass * speed], angular.to_vec()].concat();
    (values, vec![energy, mass * speed, size, size, size])
}

/// Strain energy of a cantilever without stretch under a load along its length, by EI / L: θ'' = −p (1 − s) cos θ,
/// θ(0) = θ'(1) = 0.
fn covered(p: f64) -> f64 {
    // θ, θ', energy and s at the end, for a curvature at the root.
    let shot = |curvature: f64| {
        let f = |y: &[f64; 4]| [y[1], -p * (1.0 - y[3]) * y[0].cos(), 0.5 * y[1] * y[1], 1.0];
        integrate(f, [0.0, curvature, 0.0, 0.0], 1.0)
    };
    // The end turns by less than a right angle, so the curvature at the end grows with that at the root.
    let (mut low, mut high) = (0.0, 0.5 * p);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match shot(middle)[1] < 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    shot(0.5 * (low + high))[2]
}

/// Young's modulus of the plate that points inward \[Pa\].
pub(super) fn inward_young(turn: f64) -> f64 {
    let (density, ratio) = (1000.0, 10.0_f64 / 0.01);
    12.0 * density * ratio.powi(2) / (BUCKLING * turn * turn)
}

/// Deflection of the end of a beam that points from a ring to its axis, by its length and by q L³ / EI, for the load
/// β = ρ A Ω² L⁴ / EI: w'''' + (β ½ (1 − s)² w')' = 1, w(0) = w'(0) = w''(1) = w'''(1) = 0.
fn inward(load: f64) -> f64 {
    // w, w', w'', w''' and s at the end.
    let shot = |curvature: f64, shear: f64, q: f64| {
        let f = |y: &[f64; 5]| {
            let rest = 1.0 - y[4];
            let pressed = load * (0.5 * rest * rest * y[2] - rest * y[1]);
            [y[1], y[2], y[3], q - pressed, 1.0]
        };
        integrate(f, [0.0, 0.0, curvature, shear, 0.0], 1.0)
    };
    let (a, b, own) = (
        shot(1.0, 0.0, 0.0),
        shot(0.0, 1.0, 0.0),
        shot(0.0, 0.0, 1.0),
    );
    let determinant = a[2] * b[3] - a[3] * b[2];
    let by_a = (own[3] * b[2] - own[2] * b[3]) / determinant;
    let by_b = (own[2] * a[3] - own[3] * a[2]) / determinant;
    own[0] + by_a * a[0] + by_b * b[0]
}

/// Deflection of the end of a cantilever without stretch, by its length: θ'' = −p cos θ, θ(0) = θ'(1) = 0.
///
/// With sin θ = (1 − t²) sin θ₁, ds = √(2 sin θ₁ / p) dt / cos θ. For large loads θ₁ is a right angle.
fn elastica(p: f64) -> f64 {
    if p > ASYMPTOTIC {
        return 1.0 - 2.0 * (SQRT_2 - 1.0) / (2.0 * p).sqrt();
    }
    // Length and deflection for an end that turns by θ₁.
    let integrals = |end: f64| {
        let (mut length, mut deflection) = (0.0, 0.0);
        for k in 0..POINTS {
            // More points where cos θ is small.
            let u = (k as f64 + 0.5) / POINTS as f64;
            let (t, weight) = (u.powi(3), 3.0 * u * u / POINTS as f64);
            let sine = (1.0 - t * t) * end.sin();
            // 1 − sin θ without cancellation.
            let less = 2.0 * (0.5 * (FRAC_PI_2 - end)).sin().powi(2) + t * t * end.sin();
            let arc = weight / (less * (1.0 + sine)).sqrt();
            length += arc;
            deflection += sine * arc;
        }
        let factor = (2.0 * end.sin() / p).sqrt();
        [factor * length, factor * deflection]
    };
    let (mut low, mut high) = (0.0, FRAC_PI_2);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match integrals(middle)[0] < 1.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    integrals(0.5 * (low + high))[1]
}

#[cfg(test)]
mod tests {
    use super::{BUCKLING, covered, elastica, inward};

    /// Small loads give p / 3; p = 1 and 10 the tabulated 0.30172 and 0.81061 (Bisshopp & Drucker 1945; Mattiasson 1981).
    #[test]
    fn the_elastica_has_its_known_values() {
        assert!((elastica(1e-3) * 3e3 - 1.0).abs() < 1e-6);
        assert!((elastica(1.0) - 0.30172).abs() < 1e-5);
        assert!((elastica(10.0) - 0.81061).abs() < 1e-5);
        assert!((elastica(199.0) - elastica(201.0)).abs() < 3e-4);
    }

    /// Small loads give p² / 40. The end turns by p / 6 then.
    #[test]
    fn the_elastica_under_a_distributed_load_has_its_known_values() {
        assert!((covered(1e-3) * 4e7 - 1.0).abs() < 1e-6);
        assert!(covered(1.0) < 1.0 / 40.0 && covered(1.0) > 0.95 / 40.0);
        assert!(covered(10.0) < covered(100.0));
    }

    /// Without rotation it is q L⁴ / 8 EI. It has no bound at the buckling load.
    #[test]
    fn the_beam_that_points_inward_buckles_at_its_load() {
        assert!((inward(1e-9) - 0.125).abs() < 1e-9);
        let [below, above] = [-1e-6, 1e-6].map(|part| inward(BUCKLING * (1.0 + part)));
        assert!(below > 1e5 && above < -1e5, "{below} {above}");
    }
}
