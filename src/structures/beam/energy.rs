//! Strain energy of a beam, its derivatives by everything, and its tangent.

use super::BEAM_NODES;
use super::element::{Beam, BeamMotion};
use super::frame::{Axes, add_sum_transpose, shape, strain_points, sum};
use super::line::{Line, LineCotangent};
use super::section::SectionValues;
use crate::math::{Scalar, Vec3};
use crate::structures::shell::{ElementMatrix, MOST_UNKNOWNS};

/// Motion at a point: w,r, θ and θ,r.
struct AtPoint<S> {
    w: Vec3<S>,
    turn: Vec3<S>,
    turn_by: Vec3<S>,
}

/// (ε, γ2, γ3, κ1, κ2, κ3) at a point, with the slopes e2·w,s and e3·w,s.
struct Strain<S> {
    values: [S; 6],
    slopes: [S; 2],
}

impl<S: Scalar> Strain<S> {
    fn new(axes: &Axes<S>, at: &AtPoint<S>, von_karman: bool) -> Self {
        let per = |x: S| x / axes.speed;
        let slopes = [axes.e2, axes.e3].map(|e| per(e.dot(&at.w)));
        let mut axial = per(axes.t.dot(&at.w));
        if von_karman {
            axial += (slopes[0] * slopes[0] + slopes[1] * slopes[1]) * 0.5;
        }
        Self {
            values: [
                axial,
                slopes[0] - axes.e3.dot(&at.turn),
                slopes[1] + axes.e2.dot(&at.turn),
                per(axes.t.dot(&at.turn_by)),
                per(axes.e2.dot(&at.turn_by)),
                per(axes.e3.dot(&at.turn_by)),
            ],
            slopes,
        }
    }

    /// Derivative of strain `k` by the motion.
    fn gradient(&self, axes: &Axes<S>, at: &AtPoint<S>, von_karman: bool, k: usize) -> AtPoint<S> {
        let mut unit = [S::zero(); 6];
        unit[k] = S::one();
        let mut gradient = AtPoint {
            w: Vec3::zeros(),
            turn: Vec3::zeros(),
            turn_by: Vec3::zeros(),
        };
        let unused = &mut Axes::zeros();
        self.add_transpose(axes, at, von_karman, &unit, unused, &mut gradient);
        gradient
    }

    /// Transpose of the derivative of [`Strain::new`], added to the cotangents of axes and motion.
    fn add_transpose(
        &self,
        axes: &Axes<S>,
        at: &AtPoint<S>,
        von_karman: bool,
        bar: &[S; 6],
        axes_to: &mut Axes<S>,
        to: &mut AtPoint<S>,
    ) {
        let per = S::one() / axes.speed;
        let [axial, g2, g3, k1, k2, k3] = *bar;
        let mut s2 = g2;
        let mut s3 = g3;
        if von_karman {
            s2 += axial * self.slopes[0];
            s3 += axial * self.slopes[1];
        }
        axes_to.t += (at.w * axial + at.turn_by * k1) * per;
        axes_to.e2 += (at.w * s2 + at.turn_by * k2) * per + at.turn * g3;
        axes_to.e3 += (at.w * s3 + at.turn_by * k3) * per - at.turn * g2;
        to.w += (axes.t * axial + axes.e2 * s2 + axes.e3 * s3) * per;
        to.turn += axes.e2 * g3 - axes.e3 * g2;
        to.turn_by += (axes.t * k1 + axes.e2 * k2 + axes.e3 * k3) * per;
        let linear = axes.t.dot(&at.w) * per;
        let curved = k1 * self.values[3] + k2 * self.values[4] + k3 * self.values[5];
        let stretched = axial * linear + s2 * self.slopes[0] + s3 * self.slopes[1];
        axes_to.speed -= (stretched + curved) * per;
    }
}

/// A strain e = b·v + ½ Σ (g_s·v)² of a beam at a point, with its weight in the energy ½ k e².
pub(crate) struct BeamStrain<S> {
    /// k: stiffness times length.
    pub(crate) weight: S,
    /// b.
    pub(crate) linear: [S; MOST_UNKNOWNS],
    /// g_1 and g_2 of the axial strain.
    pub(crate) slopes: Option<[[S; MOST_UNKNOWNS]; 2]>,
}

impl<S: Scalar> Beam<S> {
    /// The beam in another scalar.
    pub(crate) fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Beam<T> {
        Beam {
            points: self.points.map(|x| x.map(&mut f)),
            orientation: self.orientation.map(&mut f),
            section: self.section.map(&mut f),
            offset: self.offset.map(&mut f),
            material: self.material.map(&mut f),
            line_mass: f(self.line_mass),
        }
    }

    /// Zeros in the place of every number.
    pub(crate) fn zeros(&self) -> Self {
        self.map(|_| S::zero())
    }

    /// Axes and motion at a point of the line.
    fn at(&self, line: &Line<S>, motion: &BeamMotion<S>, r: f64) -> (Axes<S>, AtPoint<S>) {
        let (n, slope) = shape(r);
        let at = AtPoint {
            w: sum(&slope, &motion.displacement),
            turn: sum(&n, &motion.rotation),
            turn_by: sum(&slope, &motion.rotation),
        };
        (Axes::of(&sum(&slope, &line.points), &self.orientation), at)
    }

    /// The strain energy of a motion \[J\].
    pub(crate) fn energy(&self, motion: &BeamMotion<S>, von_karman: bool) -> S {
        let line = Line::new(self);
        let motion = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        strain_points()
            .iter()
            .fold(S::zero(), |energy, &(r, weight)| {
                let (axes, at) = self.at(&line, &motion, r);
                let strain = Strain::new(&axes, &at, von_karman).values;
                let pairs = stiffness.iter().zip(&strain);
                let density = pairs.fold(S::zero(), |sum, (&c, &e)| sum + c * e * e);
                energy + density * axes.speed * (0.5 * weight)
            })
    }

    /// Adds the derivatives of the strain energy: by the motion (the internal force) to `force`, by
    /// everything else to `to`.
    pub(crate) fn add_energy_transpose(
        &self,
        motion: &BeamMotion<S>,
        von_karman: bool,
        force: &mut BeamMotion<S>,
        to: &mut Self,
    ) {
        let line = Line::new(self);
        let moved = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        let mut values_bar = SectionValues::zeros();
        let mut bar = LineCotangent::zeros();
        for (r, weight) in strain_points() {
            let (axes, at) = self.at(&line, &moved, r);
            let strain = Strain::new(&axes, &at, von_karman);
            let length = axes.speed * weight;
            let mut axes_bar = Axes::zeros();
            let mut at_bar = AtPoint {
                w: Vec3::zeros(),
                turn: Vec3::zeros(),
                turn_by: Vec3::zeros(),
            };
            let mut strain_bar = [S::zero(); 6];
            for (k, &e) in strain.values.iter().enumerate() {
                strain_bar[k] = stiffness[k] * e * length;
                values_bar.stiffness[k] += e * e * length * 0.5;
                axes_bar.speed += stiffness[k] * e * e * (0.5 * weight);
            }
            strain.add_transpose(
                &axes,
                &at,
                von_karman,
                &strain_bar,
                &mut axes_bar,
                &mut at_bar,
            );
            let (n, slope) = shape(r);
            add_sum_transpose(&slope, &at_bar.w, &mut bar.displacement);
            add_sum_transpose(&n, &at_bar.turn, &mut bar.rotation);
            add_sum_transpose(&slope, &at_bar.turn_by, &mut bar.rotation);
            let mut tangent = Vec3::zeros();
            axes.add_of_transpose(
                &axes_bar,
                &self.orientation,
                &mut tangent,
                &mut bar.orientation,
            );
            add_sum_transpose(&slope, &tangent, &mut bar.points);
        }
        line.add_transpose(self, motion, &bar, force, to);
        self.section.add_values_transpose(
            &self.material,
            &values_bar,
            &mut to.section,
            &mut to.material,
        );
    }

    /// The strains of von Karman at the points, by rows over the unknowns of [`Beam::tangent`].
    pub(crate) fn strains(&self) -> Vec<BeamStrain<S>> {
        let (line, still) = (Line::new(self), BeamMotion::zeros());
        let stiffness = self.section.values(&self.material).stiffness;
        let mut all = Vec::with_capacity(6 * strain_points().len());
        for (r, weight) in strain_points() {
            let (axes, at) = self.at(&line, &still, r);
            let strain = Strain::new(&axes, &at, false);
            for (k, stiffness) in stiffness.iter().enumerate() {
                let gradient = strain.gradient(&axes, &at, false, k);
                let slope = |e: Vec3<S>| AtPoint {
                    w: e / axes.speed,
                    turn: Vec3::zeros(),
                    turn_by: Vec3::zeros(),
                };
                let slopes = [axes.e2, axes.e3].map(|e| line_row(&line, r, &slope(e)));
                all.push(BeamStrain {
                    weight: *stiffness * axes.speed * weight,
                    linear: line_row(&line, r, &gradient),
                    slopes: (k == 0).then_some(slopes),
                });
            }
        }
        all
    }

    /// Writes the tangent stiffness at a motion, lower part, into `matrix`: unknowns are all u_a (3a + i),
    /// then all θ_a in global axes.
    pub(crate) fn tangent(
        &self,
        motion: &BeamMotion<S>,
        von_karman: bool,
        matrix: &mut ElementMatrix<S>,
    ) {
        let line = Line::new(self);
        let moved = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        matrix.clear(6 * BEAM_NODES);
        for (r, weight) in strain_points() {
            let (axes, at) = self.at(&line, &moved, r);
            let strain = Strain::new(&axes, &at, von_karman);
            let length = axes.speed * weight;
            for k in 0..6 {
                let gradient = strain.gradient(&axes, &at, von_karman, k);
                let row = line_row(&line, r, &gradient);
                add_square(matrix, &row, stiffness[k] * length);
            }
            if von_karman {
                let force = stiffness[0] * strain.values[0] * length;
                for e in [axes.e2, axes.e3] {
                    let gradient = AtPoint {
                        w: e / axes.speed,
                        turn: Vec3::zeros(),
                        turn_by: Vec3::zeros(),
                    };
                    add_square(matrix, &line_row(&line, r, &gradient), force);
                }
            }
        }
    }
}

/// The row over the unknowns of the nodes of a gradient by the motion at a point of the line.
fn line_row<S: Scalar>(line: &Line<S>, r: f64, gradient: &AtPoint<S>) -> [S; MOST_UNKNOWNS] {
    let (n, slope) = shape(r);
    let mut row = [S::zero(); MOST_UNKNOWNS];
    for a in 0..BEAM_NODES {
        let w = gradient.w * S::from(slope[a]);
        let turn = gradient.turn * S::from(n[a])
            + gradient.turn_by * S::from(slope[a])
            + line.arms[a].cross(&w);
        for i in 0..3 {
            row[3 * a + i] = w[i];
            row[3 * (BEAM_NODES + a) + i] = turn[i];
        }
    }
    row
}

/// Adds `factor` b bᵀ.
pub(super) fn add_square<S: Scalar>(
    matrix: &mut ElementMatrix<S>,
    row: &[S; MOST_UNKNOWNS],
    factor: S,
) {
    for i in 0..6 * BEAM_NODES {
        let scaled = row[i] * factor;
        for j in 0..=i {
            matrix.rows[i][j] += scaled * row[j];
        }
    }
}
