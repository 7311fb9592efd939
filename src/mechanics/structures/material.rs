//! Isotropic linear elastic materials.

use crate::math::Scalar;

/// An isotropic material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material<S> {
    /// Young's modulus E \[Pa\].
    pub young: S,
    /// Poisson's ratio ν [-].
    pub poisson: S,
    /// Density ρ [kg/m³].
    pub density: S,
    /// Yield stress that stresses are compared with \[Pa\].
    pub yield_stress: S,
}

impl<S: Scalar> Material<S> {
    /// A material of zeros: the initial cotangent of a material.
    pub fn zeros() -> Self {
        let zero = S::zero();
        Self {
            young: zero,
            poisson: zero,
            density: zero,
            yield_stress: zero,
        }
    }

    /// Adds the numbers of another.
    pub fn add(&mut self, other: &Self) {
        self.young += other.young;
        self.poisson += other.poisson;
        self.density += other.density;
        self.yield_stress += other.yield_stress;
    }

    /// The same material in another scalar.
    pub fn map<T>(&self, f: &mut dyn FnMut(S) -> T) -> Material<T> {
        Material {
            young: f(self.young),
            poisson: f(self.poisson),
            density: f(self.density),
            yield_stress: f(self.yield_stress),
        }
    }

    /// Shear modulus G = E / (2 (1 + ν)) \[Pa\].
    pub fn shear_modulus(&self) -> S {
        self.young / ((self.poisson + 1.0) * 2.0)
    }

    /// Transpose of the derivative of [`Material::shear_modulus`].
    pub fn add_shear_modulus_transpose(&self, bar: S, to: &mut Self) {
        let shear = self.shear_modulus();
        to.young += bar * shear / self.young;
        to.poisson -= bar * shear / (self.poisson + 1.0);
    }

    /// Plane stress C e of the strains (e_11, e_22, 2 e_12) \[Pa\],
    /// C = E/(1 − ν²) [[1, ν, 0], [ν, 1, 0], [0, 0, (1 − ν)/2]].
    #[inline]
    pub fn plane_stress(&self, strain: &[S; 3]) -> [S; 3] {
        let nu = self.poisson;
        let factor = self.young / (S::one() - nu * nu);
        let [x, y, xy] = *strain;
        [
            factor * (x + nu * y),
            factor * (nu * x + y),
            factor * (S::one() - nu) * xy * 0.5,
        ]
    }

    /// Transpose of the derivative of [`Material::plane_stress`] in E and ν. In the strains it is
    /// its own transpose.
    pub fn add_plane_stress_transpose(&self, strain: &[S; 3], bar: &[S; 3], to: &mut Self) {
        let nu = self.poisson;
        let scale = S::one() / (S::one() - nu * nu);
        let [x, y, xy] = *strain;
        let stress = self.plane_stress(strain);
        let work = stress[0] * bar[0] + stress[1] * bar[1] + stress[2] * bar[2];
        to.young += work / self.young;
        to.poisson += work * scale * nu * 2.0
            + self.young * scale * (y * bar[0] + x * bar[1] - xy * bar[2] * 0.5);
    }
}
