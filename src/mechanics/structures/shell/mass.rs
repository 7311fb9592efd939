//! Inertia of an element: nodal masses, kinetic energy, and the moments of its mass.
//!
//! ```text
//! m_ab = ∫ (ρh + μ) N_a N_b dA,   i_ab = ∫ ρh³/12 N_a N_b dA
//! T = ½ Σ m_ab u̇_a·u̇_b + ½ Σ i_ab q̇_a·q̇_b
//! ```
//!
//! μ is the non-structural mass per area, in the middle surface.

use super::basis::{Basis, NODES};
use super::energy::{Motion, Shell, ShellCotangent};
use super::field::{AtPoint, Field, add_interpolate_transpose, add_sum_transpose, sum};
use super::frame;
use super::matrix::{ElementMatrix, RotationAxes};
use crate::math::{Scalar, Vec3};

/// Scalar nodal masses of an element.
#[derive(Clone, Debug)]
pub struct NodalMasses<S> {
    /// m_ab \[kg\].
    pub mass: [[S; NODES]; NODES],
    /// i_ab [kg m²].
    pub rotary: [[S; NODES]; NODES],
}

impl<S: Scalar> Shell<S> {
    /// Mass and rotary inertia per area [kg/m², kg].
    fn per_area(&self) -> [S; 2] {
        let (h, rho) = (self.thickness, self.material.density);
        [rho * h + self.surface_mass, rho * h * h * h / 12.0]
    }

    /// Transpose of the derivative of [`Shell::per_area`].
    fn add_per_area_transpose(&self, bar: [S; 2], to: &mut ShellCotangent<S>) {
        let (h, rho) = (self.thickness, self.material.density);
        to.surface_mass += bar[0];
        to.material.density += bar[0] * h + bar[1] * h * h * h / 12.0;
        to.thickness += bar[0] * rho + bar[1] * rho * h * h / 4.0;
    }

    /// Mass per area ρh + μ [kg/m²].
    pub fn mass_per_area(&self) -> S {
        self.per_area()[0]
    }

    /// Transpose of the derivative of [`Shell::mass_per_area`].
    pub fn add_mass_per_area_transpose(&self, bar: S, to: &mut ShellCotangent<S>) {
        self.add_per_area_transpose([bar, S::zero()], to);
    }

    fn tangents(&self, basis: &Basis) -> [Vec3<S>; 2] {
        [0, 1].map(|k| sum(&basis.by[k], &self.geometry.points))
    }

    /// The area that Gauss point `point` stands for, weight times J \[m²\].
    pub fn area(&self, point: usize) -> S {
        let tables = self.kind.tables();
        frame::area(&self.tangents(&tables.gauss[point])) * tables.weights[point]
    }

    /// Transpose of the derivative of [`Shell::area`].
    pub fn add_area_transpose(&self, point: usize, bar: S, to: &mut Field<S>) {
        let tables = self.kind.tables();
        let basis = &tables.gauss[point];
        let mut at = AtPoint::zeros();
        let bar = bar * tables.weights[point];
        frame::add_area_transpose(&self.tangents(basis), bar, &mut at.by);
        add_interpolate_transpose(basis, &at, to);
    }

    /// The Gauss points with their shape functions.
    pub fn gauss(&self) -> impl Iterator<Item = (usize, &'static Basis)> {
        self.kind.tables().gauss.iter().enumerate()
    }

    /// Number of nodes.
    pub(super) fn nodes(&self) -> usize {
        self.kind.tables().nodes.len()
    }

    /// The scalar nodal masses m_ab and i_ab.
    pub fn nodal_masses(&self) -> NodalMasses<S> {
        let zero = [[S::zero(); NODES]; NODES];
        let mut all = NodalMasses {
            mass: zero,
            rotary: zero,
        };
        let [mass, rotary] = self.per_area();
        for (k, basis) in self.gauss() {
            let area = self.area(k);
            for (a, n) in basis.n.iter().enumerate() {
                for (b, other) in basis.n.iter().enumerate() {
                    let share = area * (n * other);
                    all.mass[a][b] += mass * share;
                    all.rotary[a][b] += rotary * share;
                }
            }
        }
        all
    }

    /// Writes the mass matrix, lower part, into `matrix` [kg, kg m, kg m²].
    pub fn mass_matrix(&self, axes: &RotationAxes<S>, matrix: &mut ElementMatrix<S>) {
        let masses = self.nodal_masses();
        let moved: [[Vec3<S>; 3]; NODES] = std::array::from_fn(|a| {
            axes.axes[a].map(|axis| axis.cross(&self.geometry.directors[a]))
        });
        let nodes = self.nodes();
        matrix.clear(3 * nodes + axes.total(nodes));
        for a in 0..nodes {
            for b in 0..=a {
                for i in 0..3 {
                    matrix.rows[3 * a + i][3 * b + i] = masses.mass[a][b];
                }
            }
        }
        let mut row = 3 * nodes;
        for a in 0..nodes {
            for k in 0..axes.count[a] {
                let mut column = 3 * nodes;
                for b in 0..=a {
                    let count = if a == b { k + 1 } else { axes.count[b] };
                    for l in 0..count {
                        let turned = moved[a][k].dot(&moved[b][l]);
                        matrix.rows[row][column + l] = masses.rotary[a][b] * turned;
                    }
                    column += axes.count[b];
                }
                row += 1;
            }
        }
    }

    /// Kinetic energy of nodal velocities \[J\], in the place of displacements and rotations.
    pub fn kinetic_energy(&self, rates: &Motion<S>) -> S {
        let field = rates.field(&self.geometry);
        let [mass, rotary] = self.per_area();
        self.gauss().fold(S::zero(), |energy, (k, basis)| {
            let (u, q) = (
                sum(&basis.n, &field.points),
                sum(&basis.n, &field.directors),
            );
            let area = self.area(k);
            energy + area * (mass * u.dot(&u) + rotary * q.dot(&q)) * 0.5
        })
    }

    /// Adds the derivatives of `factor` times the kinetic energy: by the rates (the momenta) to
    /// `momentum`, by everything else to `to`.
    pub fn add_kinetic_energy_transpose(
        &self,
        rates: &Motion<S>,
        factor: S,
        momentum: &mut Motion<S>,
        to: &mut ShellCotangent<S>,
    ) {
        let field = rates.field(&self.geometry);
        let [mass, rotary] = self.per_area();
        let mut bar = Field::zeros();
        for (k, basis) in self.gauss() {
            let (u, q) = (
                sum(&basis.n, &field.points),
                sum(&basis.n, &field.directors),
            );
            let area = self.area(k);
            let weight = factor * area;
            add_sum_transpose(&basis.n, &(u * (weight * mass)), &mut bar.points);
            add_sum_transpose(&basis.n, &(q * (weight * rotary)), &mut bar.directors);
            let (uu, qq) = (u.dot(&u) * 0.5, q.dot(&q) * 0.5);
            self.add_per_area_transpose([weight * uu, weight * qq], to);
            let density = factor * (mass * uu + rotary * qq);
            self.add_area_transpose(k, density, &mut to.geometry);
        }
        rates.add_field_transpose(&self.geometry, &bar, momentum, &mut to.geometry);
    }

    /// Mass, first and second moments of the mass of the middle surface.
    pub fn mass_moments(&self) -> MassMoments<S> {
        let mut all = MassMoments::zeros();
        let mass = self.per_area()[0];
        for (k, basis) in self.gauss() {
            let x = sum(&basis.n, &self.geometry.points);
            all.add(mass * self.area(k), &x);
        }
        all
    }

    /// Transpose of the derivative of [`Shell::mass_moments`].
    pub fn add_mass_moments_transpose(&self, bar: &MassMoments<S>, to: &mut ShellCotangent<S>) {
        let mass = self.per_area()[0];
        for (k, basis) in self.gauss() {
            let x = sum(&basis.n, &self.geometry.points);
            let area = self.area(k);
            let (by_mass, by_place) = bar.add_transpose(mass * area, &x);
            add_sum_transpose(&basis.n, &by_place, &mut to.geometry.points);
            self.add_per_area_transpose([by_mass * area, S::zero()], to);
            self.add_area_transpose(k, by_mass * mass, &mut to.geometry);
        }
    }
}

/// Moments of a mass: ∫ dm \[kg\], ∫ x dm [kg m], and ∫ x xᵀ dm [kg m²] as (xx, yy, zz, xy, yz, zx).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MassMoments<S> {
    /// ∫ dm.
    pub mass: S,
    /// ∫ x dm.
    pub first: Vec3<S>,
    /// ∫ x xᵀ dm.
    pub second: [S; 6],
}

/// Index pairs of the second moments.
pub const SECOND: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [0, 1], [1, 2], [2, 0]];

impl<S: Scalar> MassMoments<S> {
    /// No mass.
    pub fn zeros() -> Self {
        Self {
            mass: S::zero(),
            first: Vec3::zeros(),
            second: [S::zero(); 6],
        }
    }

    /// Adds a mass at a place.
    pub fn add(&mut self, mass: S, x: &Vec3<S>) {
        self.mass += mass;
        self.first += x * mass;
        for (sum, [i, j]) in self.second.iter_mut().zip(SECOND) {
            *sum += mass * x[i] * x[j];
        }
    }

    /// Transpose of the derivative of [`MassMoments::add`], `self` being the cotangent: the
    /// derivatives by the mass and by its place.
    pub fn add_transpose(&self, mass: S, x: &Vec3<S>) -> (S, Vec3<S>) {
        let mut by_mass = self.mass + self.first.dot(x);
        let mut by_place = self.first * mass;
        for (&bar, [i, j]) in self.second.iter().zip(SECOND) {
            by_mass += bar * x[i] * x[j];
            by_place[i] += bar * mass * x[j];
            by_place[j] += bar * mass * x[i];
        }
        (by_mass, by_place)
    }
}
