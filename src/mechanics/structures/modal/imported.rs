//! A body by numbers that are known: integrals of its shapes, stiffness, damping, and points.
//!
//! They are scaled by factors of Young's modulus and density, and by a factor s of all lengths, thickness
//! included: a similar body. With displacements of the shapes at similar points unchanged and rotations
//! divided by s,
//!
//! ```text
//! m, p_I, S_IJ ∝ ρ s³,   p_0, S_0I ∝ ρ s⁴,   J ∝ ρ s⁵,   K ∝ E s,   given damping ∝ s
//! ```

use super::damping::ratio_damping;
use super::{ModalNumbers, PointModes};
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::flexible::{ModalInertia, ModalStiffness};
use crate::structures::damping::RayleighDamping;

/// A body with elastic coordinates.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedBody {
    /// ∫ dm \[kg\].
    pub mass: f64,
    /// p_0 = ∫ X dm \[kg m\].
    pub centre: Vec3<f64>,
    /// Inertia of the undeformed body about the origin of its axes [kg m²].
    pub inertia: Mat3<f64>,
    /// p_I.
    pub static_moments: Vec<Vec3<f64>>,
    /// S_0I.
    pub with_position: Vec<Mat3<f64>>,
    /// S_IJ for J ≥ I, by rows of the upper triangle.
    pub products: Vec<Mat3<f64>>,
    /// K by rows.
    pub stiffness: Vec<f64>,
    /// Damping by rows.
    pub damping: Vec<f64>,
    /// Points that joints, loads and functions can hold.
    pub points: Vec<ImportedPoint>,
}

/// A point of the body.
#[derive(Clone, Debug, PartialEq)]
pub struct ImportedPoint {
    /// Its name.
    pub name: String,
    /// Where it is in the undeformed body \[m\].
    pub position: Vec3<f64>,
    /// N_I.
    pub displacement: Vec<Vec3<f64>>,
    /// Θ_I.
    pub rotation: Vec<Vec3<f64>>,
    /// Whether its rotation is known.
    pub turns: bool,
}

/// Factors of the numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors<S> {
    /// Of Young's modulus.
    pub young: S,
    /// Of the density.
    pub density: S,
    /// Of all lengths.
    pub length: S,
}

/// Damping in addition to that of the file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImportedDamping<S> {
    /// Ratio ζ of critical damping for all modes.
    pub ratio: S,
    /// α M + β K.
    pub rayleigh: RayleighDamping<S>,
}

impl ImportedBody {
    /// Number of elastic coordinates.
    pub fn modes(&self) -> usize {
        self.static_moments.len()
    }

    /// Mass of the elastic coordinates with the axes at rest, by rows.
    pub fn elastic_mass(&self) -> Vec<f64> {
        let factors = Factors {
            young: 1.0,
            density: 1.0,
            length: 1.0,
        };
        let damping = ImportedDamping {
            ratio: 0.0,
            rayleigh: RayleighDamping {
                mass: 0.0,
                stiffness: 0.0,
            },
        };
        self.numbers(&factors, &damping).elastic_mass()
    }

    /// The numbers of the body.
    pub fn numbers<S: Scalar>(
        &self,
        factors: &Factors<S>,
        damping: &ImportedDamping<S>,
    ) -> ModalNumbers<S> {
        let Factors {
            young,
            density,
            length,
        } = *factors;
        let third = density * length * length * length;
        let fourth = third * length;
        let scaled = |all: &[f64], by: S| all.iter().map(|&x| by * x).collect::<Vec<S>>();
        let vector = |v: &Vec3<f64>, by: S| v.map(|x| by * x);
        let matrix = |a: &Mat3<f64>, by: S| a.map(|x| by * x);
        let stiffness = scaled(&self.stiffness, young * length);
        let mut numbers = ModalNumbers {
            mass: third * self.mass,
            inertia: matrix(&self.inertia, fourth * length),
            shapes: ModalInertia {
                centre: vector(&self.centre, fourth),
                static_moments: self
                    .static_moments
                    .iter()
                    .map(|p| vector(p, third))
                    .collect(),
                with_position: self
                    .with_position
                    .iter()
                    .map(|s| matrix(s, fourth))
                    .collect(),
                products: self.products.iter().map(|s| matrix(s, third)).collect(),
            },
            stiffness: ModalStiffness {
                linear: stiffness,
                strains: Vec::new(),
            },
            damping: scaled(&self.damping, length),
            viscosity: None,
        };
        let mass = numbers.elastic_mass();
        let stiffness = &numbers.stiffness.linear;
        let rayleigh = mass.iter().zip(stiffness);
        for (d, (&m, &k)) in numbers.damping.iter_mut().zip(rayleigh) {
            *d += m * damping.rayleigh.mass + k * damping.rayleigh.stiffness;
        }
        if damping.ratio != S::zero() {
            let of_ratio = ratio_damping(&mass, stiffness, damping.ratio);
            for (d, x) in numbers.damping.iter_mut().zip(of_ratio) {
                *d += x;
            }
        }
        numbers
    }

    /// The point nearest to a place in the undeformed body of this size.
    pub fn nearest(&self, place: &Vec3<f64>, length: f64) -> Option<&ImportedPoint> {
        let distance = |point: &&ImportedPoint| (point.position * length - place).norm();
        let by_distance =
            |a: &&ImportedPoint, b: &&ImportedPoint| distance(a).total_cmp(&distance(b));
        self.points.iter().min_by(by_distance)
    }

    /// Largest distance between the points, or from the origin \[m\]: the scale of distances.
    pub fn size(&self) -> f64 {
        let far = self.points.iter().map(|point| point.position.norm());
        let gyration = (self.inertia.trace() / self.mass.max(f64::MIN_POSITIVE)).sqrt();
        far.fold(gyration, f64::max)
    }

    /// How a place moves that is joined to the nearest point by a rigid arm.
    pub fn point<S: Scalar>(&self, place: &Vec3<S>, length: S) -> PointModes<S> {
        let lift = |v: &Vec3<f64>| v.map(S::from);
        let Some(nearest) = self.nearest(&place.map(|x| x.re()), length.re()) else {
            let still = vec![Vec3::zeros(); self.modes()];
            return PointModes {
                position: *place,
                displacement: still.clone(),
                rotation: still,
            };
        };
        let arm = place - lift(&nearest.position) * length;
        let rotation: Vec<Vec3<S>> = (nearest.rotation.iter())
            .map(|turn| lift(turn).map(|x| x / length))
            .collect();
        let moved = nearest.displacement.iter().zip(&rotation);
        PointModes {
            position: *place,
            displacement: moved.map(|(n, turn)| lift(n) + turn.cross(&arm)).collect(),
            rotation,
        }
    }
}
