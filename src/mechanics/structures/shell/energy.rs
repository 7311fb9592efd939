//! Strain energy of an element, and its derivatives by everything.
//!
//! ```text
//! U = ½ ∫ [h eᵀCe + h³/12 κᵀCκ + 5/6 G h |γ|²] dA + ½ ∫ α G h (θ·n − ½(e2·u,1 − e1·u,2))² dA
//! ```
//!
//! The last term, the drilling stiffness with α = 1e-3, is there for elements all of whose nodes have
//! three rotations. The derivative by the motion is the internal force; evaluated with dual numbers,
//! whose infinitesimal part is a second motion ψ, the derivatives by geometry, thickness and
//! material are those of ψ·f: what an adjoint needs.

use super::basis::{Basis, GAUSS_POINTS, NODES};
use super::field::{Field, add_interpolate_transpose, add_sum_transpose, interpolate, sum};
use super::frame;
use super::strain::{Curvature, ElementStrain, Strain, Terms};
use crate::math::{Scalar, Vec3};
use crate::model::shell_kind::ShellKind;
use crate::structures::material::Material;

/// Shear correction factor.
pub const SHEAR_FACTOR: f64 = 5.0 / 6.0;
/// Drilling stiffness as a fraction of G h.
pub const DRILLING: f64 = 1e-3;

/// The numbers of an element.
#[derive(Clone, Copy, Debug)]
pub struct Shell<S> {
    /// The kind of element.
    pub kind: ShellKind,
    /// Nodes X_a \[m\] and directors D_a [-].
    pub geometry: Field<S>,
    /// Thickness h \[m\].
    pub thickness: S,
    /// The material.
    pub material: Material<S>,
    /// Non-structural mass per area [kg/m²].
    pub surface_mass: S,
    /// If all nodes have three rotations, so that the drilling stiffness is needed.
    pub drilling: bool,
}

/// Derivatives of a function by all numbers of an element.
#[derive(Clone, Copy, Debug)]
pub struct ShellCotangent<S> {
    /// By X_a and D_a.
    pub geometry: Field<S>,
    /// By h.
    pub thickness: S,
    /// By E, ν, ρ and the yield stress.
    pub material: Material<S>,
    /// By the non-structural mass per area.
    pub surface_mass: S,
}

impl<S: Scalar> ShellCotangent<S> {
    /// Zero.
    pub fn zeros() -> Self {
        Self {
            geometry: Field::zeros(),
            thickness: S::zero(),
            material: Material::zeros(),
            surface_mass: S::zero(),
        }
    }
}

/// Displacements u_a \[m\] and rotations θ_a \[rad\] of the nodes, in global axes; or forces \[N\] and
/// moments [N m]. Zero beyond the nodes of the element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<S> {
    /// u_a.
    pub displacement: [Vec3<S>; NODES],
    /// θ_a.
    pub rotation: [Vec3<S>; NODES],
}

impl<S: Scalar> Motion<S> {
    /// No motion.
    pub fn zeros() -> Self {
        let zero = [Vec3::zeros(); NODES];
        Self {
            displacement: zero,
            rotation: zero,
        }
    }

    /// The motion (u_a, q_a) of points and directors, q_a = θ_a × D_a.
    pub fn field(&self, geometry: &Field<S>) -> Field<S> {
        Field {
            points: self.displacement,
            directors: std::array::from_fn(|a| self.rotation[a].cross(&geometry.directors[a])),
        }
    }

    /// Transpose of the derivative of [`Motion::field`].
    pub fn add_field_transpose(
        &self,
        geometry: &Field<S>,
        bar: &Field<S>,
        to: &mut Self,
        geometry_to: &mut Field<S>,
    ) {
        for a in 0..NODES {
            to.displacement[a] += bar.points[a];
            to.rotation[a] += geometry.directors[a].cross(&bar.directors[a]);
            geometry_to.directors[a] += bar.directors[a].cross(&self.rotation[a]);
        }
    }
}

impl Motion<f64> {
    /// The work of forces in the motion.
    pub fn dot(&self, force: &Self) -> f64 {
        let dot = |moves: &[Vec3<f64>; NODES], forces: &[Vec3<f64>; NODES]| -> f64 {
            moves.iter().zip(forces).map(|(v, f)| v.dot(f)).sum()
        };
        dot(&self.displacement, &force.displacement) + dot(&self.rotation, &force.rotation)
    }
}

/// Strain energy by its parts \[J\].
#[derive(Clone, Copy, Debug)]
pub struct EnergyParts<S> {
    /// Of the membrane strains.
    pub membrane: S,
    /// Of the curvatures.
    pub bending: S,
    /// Of the transverse shear.
    pub shear: S,
    /// Of the drilling stiffness.
    pub drilling: S,
}

impl<S: Scalar> EnergyParts<S> {
    /// Their sum \[J\].
    pub fn total(&self) -> S {
        self.membrane + self.bending + self.shear + self.drilling
    }
}

fn dot<S: Scalar, const N: usize>(a: &[S; N], b: &[S; N]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (&a, &b)| sum + a * b)
}

impl<S: Scalar> Shell<S> {
    /// The strain energy of a motion, by its parts \[J\].
    pub fn energy(&self, motion: &Motion<S>, terms: Terms) -> EnergyParts<S> {
        let field = motion.field(&self.geometry);
        let strain = self.strain(&field, terms, Curvature::Tied);
        let (h, material) = (self.thickness, &self.material);
        let mut parts = EnergyParts {
            membrane: S::zero(),
            bending: S::zero(),
            shear: S::zero(),
            drilling: S::zero(),
        };
        for point in strain.points() {
            let work = |e: &[S; 3]| dot(e, &material.plane_stress(e)) * point.area * 0.5;
            parts.membrane += h * work(&point.membrane);
            parts.bending += h * h * h / 12.0 * work(&point.bending);
            let shear = material.shear_modulus() * h * point.area * (0.5 * SHEAR_FACTOR);
            parts.shear += shear * dot(&point.shear, &point.shear);
        }
        if self.drilling {
            for point in self.points() {
                let turn = Drilling::new(self, motion, point.0);
                let stiffness = self.drilling_stiffness(&turn, point.1);
                parts.drilling += stiffness * turn.angle * turn.angle * 0.5;
            }
        }
        parts
    }

    /// Strains of a motion of points and directors.
    pub(super) fn strain<'a>(
        &'a self,
        motion: &'a Field<S>,
        terms: Terms,
        curvature: Curvature,
    ) -> ElementStrain<'a, S> {
        ElementStrain::new(self.kind, (&self.geometry, motion), terms, curvature)
    }

    /// The shape functions at the Gauss points, and the weights of these.
    pub(super) fn points(&self) -> impl Iterator<Item = (&'static Basis, f64)> {
        let tables = self.kind.tables();
        tables.gauss.iter().zip(tables.weights.iter().copied())
    }

    /// α G h dA of a Gauss point.
    fn drilling_stiffness(&self, turn: &Drilling<S>, weight: f64) -> S {
        self.material.shear_modulus() * self.thickness * turn.area * (DRILLING * weight)
    }

    /// Adds the derivatives of the strain energy: by the motion (the internal force [N, N m]) to
    /// `force`, by everything else to `to`.
    pub fn add_energy_transpose(
        &self,
        motion: &Motion<S>,
        terms: Terms,
        force: &mut Motion<S>,
        to: &mut ShellCotangent<S>,
    ) {
        let field = motion.field(&self.geometry);
        let strain = self.strain(&field, terms, Curvature::Tied);
        let (h, material) = (self.thickness, &self.material);
        let cube = h * h * h / 12.0;
        let shear_modulus = material.shear_modulus();
        let mut bar = [Strain::zeros(); GAUSS_POINTS];
        for (bar, point) in bar.iter_mut().zip(strain.points()) {
            let area = point.area;
            let (m, b) = (
                material.plane_stress(&point.membrane),
                material.plane_stress(&point.bending),
            );
            let shear = shear_modulus * h * SHEAR_FACTOR;
            bar.membrane = m.map(|x| x * h * area);
            bar.bending = b.map(|x| x * cube * area);
            bar.shear = point.shear.map(|x| x * shear * area);
            let (m, b) = (dot(&m, &point.membrane), dot(&b, &point.bending));
            let s = dot(&point.shear, &point.shear) * SHEAR_FACTOR;
            bar.area = (h * m + cube * b + shear_modulus * h * s) * 0.5;
            let half = area * 0.5;
            to.thickness += half * (m + h * h * b / 4.0 + shear_modulus * s);
            // Each stress is linear in E, and half its work is the energy.
            for (strain, factor) in [(&point.membrane, h), (&point.bending, cube)] {
                let weighted = strain.map(|x| x * half * factor);
                material.add_plane_stress_transpose(strain, &weighted, &mut to.material);
            }
            material.add_shear_modulus_transpose(half * h * s, &mut to.material);
        }
        let mut motion_bar = Field::zeros();
        strain.add_transpose(&bar, &mut to.geometry, &mut motion_bar);
        motion.add_field_transpose(&self.geometry, &motion_bar, force, &mut to.geometry);
        if self.drilling {
            for point in self.points() {
                self.add_drilling_transpose(motion, point, force, to);
            }
        }
    }

    fn add_drilling_transpose(
        &self,
        motion: &Motion<S>,
        (basis, weight): (&Basis, f64),
        force: &mut Motion<S>,
        to: &mut ShellCotangent<S>,
    ) {
        let turn = Drilling::new(self, motion, basis);
        let stiffness = self.drilling_stiffness(&turn, weight);
        let half = turn.angle * turn.angle * 0.5;
        to.thickness += stiffness * half / self.thickness;
        let modulus = stiffness * half / self.material.shear_modulus();
        self.material
            .add_shear_modulus_transpose(modulus, &mut to.material);
        let area = stiffness * half / turn.area;
        turn.add_transpose(stiffness * turn.angle, area, basis, force, &mut to.geometry);
    }
}

/// The angle θ·n − ½(e2·u,1 − e1·u,2) between the rotation of the nodes and that of the surface
/// about its normal, at a Gauss point.
///
/// With n̂ = a_r × a_s = J n, p a_r = e1 and u,1 = p u_r, u,2 = b u_r + c u_s it is
/// (θ·n̂ + ½(a_r·u_s − a_s·u_r)) / J: the frame drops out.
pub struct Drilling<S> {
    pub area: S,
    pub angle: S,
    tangents: [Vec3<S>; 2],
    by: [Vec3<S>; 2],
    rotation: Vec3<S>,
}

impl<S: Scalar> Drilling<S> {
    fn new(shell: &Shell<S>, motion: &Motion<S>, basis: &Basis) -> Self {
        let tangents = interpolate(basis, &shell.geometry).by;
        let by = [0, 1].map(|k| sum(&basis.by[k], &motion.displacement));
        let rotation = sum(&basis.n, &motion.rotation);
        let area = frame::area(&tangents);
        let [ar, as_] = &tangents;
        let turned = (ar.dot(&by[1]) - as_.dot(&by[0])) * 0.5;
        Self {
            angle: (rotation.dot(&ar.cross(as_)) + turned) / area,
            area,
            tangents,
            by,
            rotation,
        }
    }

    /// Transpose of the derivative of angle and area.
    fn add_transpose(
        &self,
        angle: S,
        area: S,
        basis: &Basis,
        motion: &mut Motion<S>,
        geometry: &mut Field<S>,
    ) {
        let [ar, as_] = &self.tangents;
        let bar = angle / self.area;
        let half = bar * 0.5;
        add_sum_transpose(&basis.n, &(ar.cross(as_) * bar), &mut motion.rotation);
        add_sum_transpose(&basis.by[0], &(*as_ * -half), &mut motion.displacement);
        add_sum_transpose(&basis.by[1], &(*ar * half), &mut motion.displacement);
        let mut at = super::field::AtPoint::zeros();
        at.by[0] = as_.cross(&self.rotation) * bar + self.by[1] * half;
        at.by[1] = self.rotation.cross(ar) * bar - self.by[0] * half;
        let bar = area - bar * self.angle;
        frame::add_area_transpose(&self.tangents, bar, &mut at.by);
        add_interpolate_transpose(basis, &at, geometry);
    }
}
