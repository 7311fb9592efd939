//! Inertia of a beam: kinetic energy, mass matrix, moments of its mass, distributed forces.
//!
//! ```text
//! T = ½ ∫ [m ẇ·ẇ + ρ(I2 + I3)(ω·t)² + ρI2 (ω·e2)² + ρI3 (ω·e3)²] ds,   m = ρA + μ
//! ```

use super::BEAM_NODES;
use super::element::{Beam, BeamMotion};
use super::energy::add_square;
use super::frame::{Axes, add_sum_transpose, mass_points, shape, sum};
use super::line::{Line, LineCotangent};
use super::section::SectionValues;
use crate::math::{Scalar, Vec3};
use crate::structures::shell::{ElementMatrix, MOST_UNKNOWNS, MassMoments};

/// Masses of a beam between its positions and axes at the nodes.
pub struct BeamMasses<S> {
    /// ∫ N_a N_b ds.
    pub shares: [[S; BEAM_NODES]; BEAM_NODES],
    /// e2 and e3 at each node.
    pub axes: [[Vec3<S>; 2]; BEAM_NODES],
    /// Masses per length.
    pub per_length: [[S; 3]; 3],
}

impl<S: Scalar> Beam<S> {
    /// Mass per length m [kg/m], and rotary inertia about t, e2 and e3 [kg m].
    fn per_length(&self) -> [S; 4] {
        let [mass, m2, m3] = self.section.values(&self.material).inertia;
        [mass + self.line_mass, m2 + m3, m2, m3]
    }

    /// ∫ N_a N_b ds \[m\], the axes e2 and e3 at the nodes, and the masses per length between the position of a node and
    /// its e2 and e3: with the offset o the centres move by ẋ + o2 ė2 + o3 ė3, sections by ρI3 ė2 and ρI2 ė3.
    pub fn masses(&self) -> BeamMasses<S> {
        let line = Line::new(self);
        let mut shares = [[S::zero(); BEAM_NODES]; BEAM_NODES];
        for (r, weight) in mass_points() {
            let length = self.axes_at(&line, r).speed * weight;
            let n = shape(r).0;
            for (row, &a) in shares.iter_mut().zip(&n) {
                for (share, &b) in row.iter_mut().zip(&n) {
                    *share += length * (a * b);
                }
            }
        }
        let [m, _, i2, i3] = self.per_length();
        let [o2, o3] = self.offset;
        BeamMasses {
            shares,
            axes: line.axes(),
            per_length: [
                [m, m * o2, m * o3],
                [m * o2, m * o2 * o2 + i3, m * o2 * o3],
                [m * o3, m * o2 * o3, m * o3 * o3 + i2],
            ],
        }
    }

    /// Transpose of the derivative of [`Beam::per_length`].
    fn add_per_length_transpose(&self, [m, m1, m2, m3]: [S; 4], to: &mut Self) {
        to.line_mass += m;
        let mut bar = SectionValues::zeros();
        bar.inertia = [m, m1 + m2, m1 + m3];
        self.section
            .add_values_transpose(&self.material, &bar, &mut to.section, &mut to.material);
    }

    fn axes_at(&self, line: &Line<S>, r: f64) -> Axes<S> {
        Axes::of(&sum(&shape(r).1, &line.points), &self.orientation)
    }

    /// Adds the contributions of the axes at a point to the cotangents of the line.
    fn add_axes_transpose(
        &self,
        axes: &Axes<S>,
        r: f64,
        axes_bar: &Axes<S>,
        bar: &mut LineCotangent<S>,
    ) {
        let mut tangent = Vec3::zeros();
        axes.add_of_transpose(
            axes_bar,
            &self.orientation,
            &mut tangent,
            &mut bar.orientation,
        );
        add_sum_transpose(&shape(r).1, &tangent, &mut bar.points);
    }

    /// Kinetic energy of nodal velocities \[J\], in the place of displacements and rotations.
    pub fn kinetic_energy(&self, rates: &BeamMotion<S>) -> S {
        let line = Line::new(self);
        let rates = line.motion(rates);
        let [m, m1, m2, m3] = self.per_length();
        mass_points()
            .iter()
            .fold(S::zero(), |energy, &(r, weight)| {
                let axes = self.axes_at(&line, r);
                let (w, turn) = (
                    sum(&shape(r).0, &rates.displacement),
                    sum(&shape(r).0, &rates.rotation),
                );
                let [a, b, c] = [axes.t, axes.e2, axes.e3].map(|e| e.dot(&turn));
                let density = m * w.dot(&w) + m1 * a * a + m2 * b * b + m3 * c * c;
                energy + density * axes.speed * (0.5 * weight)
            })
    }

    /// Adds the derivatives of `factor` times the kinetic energy: by the rates (the momenta) to
    /// `momentum`, by everything else to `to`.
    pub fn add_kinetic_energy_transpose(
        &self,
        rates: &BeamMotion<S>,
        factor: S,
        momentum: &mut BeamMotion<S>,
        to: &mut Self,
    ) {
        let line = Line::new(self);
        let moved = line.motion(rates);
        let [m, m1, m2, m3] = self.per_length();
        let mut bar = LineCotangent::zeros();
        let mut density_bar = [S::zero(); 4];
        for (r, weight) in mass_points() {
            let axes = self.axes_at(&line, r);
            let n = shape(r).0;
            let (w, turn) = (sum(&n, &moved.displacement), sum(&n, &moved.rotation));
            let [a, b, c] = [axes.t, axes.e2, axes.e3].map(|e| e.dot(&turn));
            let length = factor * axes.speed * weight;
            let squares = [w.dot(&w), a * a, b * b, c * c];
            for (bar, square) in density_bar.iter_mut().zip(squares) {
                *bar += length * square * 0.5;
            }
            let density = m * squares[0] + m1 * squares[1] + m2 * squares[2] + m3 * squares[3];
            let mut axes_bar = Axes::zeros();
            axes_bar.speed = density * factor * (0.5 * weight);
            axes_bar.t = turn * (m1 * a * length);
            axes_bar.e2 = turn * (m2 * b * length);
            axes_bar.e3 = turn * (m3 * c * length);
            let turn_bar = axes.t * (m1 * a) + axes.e2 * (m2 * b) + axes.e3 * (m3 * c);
            add_sum_transpose(&n, &(w * (m * length)), &mut bar.displacement);
            add_sum_transpose(&n, &(turn_bar * length), &mut bar.rotation);
            self.add_axes_transpose(&axes, r, &axes_bar, &mut bar);
        }
        line.add_transpose(self, rates, &bar, momentum, to);
        self.add_per_length_transpose(density_bar, to);
    }

    /// Writes the mass matrix, lower part, into `matrix`, in the order of [`Beam::tangent`].
    pub fn mass_matrix(&self, matrix: &mut ElementMatrix<S>) {
        let line = Line::new(self);
        let [m, m1, m2, m3] = self.per_length();
        matrix.clear(6 * BEAM_NODES);
        for (r, weight) in mass_points() {
            let axes = self.axes_at(&line, r);
            let (n, length) = (shape(r).0, axes.speed * weight);
            for i in 0..3 {
                let e = Vec3::from_fn(|k, _| if k == i { S::one() } else { S::zero() });
                let mut row = [S::zero(); MOST_UNKNOWNS];
                for a in 0..BEAM_NODES {
                    let w = e * S::from(n[a]);
                    let turn = line.arms[a].cross(&w);
                    for k in 0..3 {
                        row[3 * a + k] = w[k];
                        row[3 * (BEAM_NODES + a) + k] = turn[k];
                    }
                }
                add_square(matrix, &row, m * length);
            }
            for (e, inertia) in [(axes.t, m1), (axes.e2, m2), (axes.e3, m3)] {
                let mut row = [S::zero(); MOST_UNKNOWNS];
                for a in 0..BEAM_NODES {
                    for k in 0..3 {
                        row[3 * (BEAM_NODES + a) + k] = e[k] * n[a];
                    }
                }
                add_square(matrix, &row, inertia * length);
            }
        }
    }

    /// Mass, first and second moments of the mass of the line of centres.
    pub fn mass_moments(&self) -> MassMoments<S> {
        let line = Line::new(self);
        let mass = self.per_length()[0];
        let mut all = MassMoments::zeros();
        for (r, weight) in mass_points() {
            let length = self.axes_at(&line, r).speed * weight;
            all.add(mass * length, &sum(&shape(r).0, &line.points));
        }
        all
    }

    /// Transpose of the derivative of [`Beam::mass_moments`].
    pub fn add_mass_moments_transpose(&self, moments: &MassMoments<S>, to: &mut Self) {
        let line = Line::new(self);
        let mass = self.per_length()[0];
        let (mut bar, mut mass_bar) = (LineCotangent::zeros(), S::zero());
        for (r, weight) in mass_points() {
            let axes = self.axes_at(&line, r);
            let length = axes.speed * weight;
            let (by_mass, by_place) =
                moments.add_transpose(mass * length, &sum(&shape(r).0, &line.points));
            mass_bar += by_mass * length;
            add_sum_transpose(&shape(r).0, &by_place, &mut bar.points);
            let mut axes_bar = Axes::zeros();
            axes_bar.speed = by_mass * mass * weight;
            self.add_axes_transpose(&axes, r, &axes_bar, &mut bar);
        }
        let rest = BeamMotion::zeros();
        line.add_transpose(self, &rest, &bar, &mut BeamMotion::zeros(), to);
        self.add_per_length_transpose([mass_bar, S::zero(), S::zero(), S::zero()], to);
    }

    /// Adds the derivatives of the work ∫ f·w ds of a force per length [N/m], or with `of_mass` of
    /// ∫ m f·w ds with f an acceleration: by the motion to `force`, by the beam to `to`; gives that by f.
    pub fn add_line_work_transpose(
        &self,
        f: &Vec3<S>,
        of_mass: bool,
        motion: &BeamMotion<S>,
        force: &mut BeamMotion<S>,
        to: &mut Self,
    ) -> Vec3<S> {
        let line = Line::new(self);
        let moved = line.motion(motion);
        let density = if of_mass {
            self.per_length()[0]
        } else {
            S::one()
        };
        let (mut bar, mut by_density) = (LineCotangent::zeros(), S::zero());
        let mut by_f = Vec3::zeros();
        for (r, weight) in mass_points() {
            let axes = self.axes_at(&line, r);
            let n = shape(r).0;
            let w = sum(&n, &moved.displacement);
            let length = axes.speed * weight;
            by_f += w * (density * length);
            by_density += f.dot(&w) * length;
            add_sum_transpose(&n, &(f * (density * length)), &mut bar.displacement);
            let mut axes_bar = Axes::zeros();
            axes_bar.speed = f.dot(&w) * density * weight;
            self.add_axes_transpose(&axes, r, &axes_bar, &mut bar);
        }
        line.add_transpose(self, motion, &bar, force, to);
        if of_mass {
            self.add_per_length_transpose([by_density, S::zero(), S::zero(), S::zero()], to);
        }
        by_f
    }
}
