//! Strain energy of a beam, its derivatives by everything, and its tangent.

use super::BEAM_NODES;
use super::element::{Beam, BeamMotion};
use super::frame::{Axes, add_sum_transpose, shape, strain_points, sum};
use super::line::{Line, LineCotangent};
use super::section::SectionValues;
use super::strain::{AtPoint, LOCAL, STRAINS, Strains, add_local_transpose, gyration, local};
use crate::math::slices::add_scaled;
use crate::math::{Scalar, Vec3};
use crate::structures::shell::{ElementMatrix, MOST_UNKNOWNS};

/// A strain e = b·v + ½ Σ c_s (g_s·v)² of a beam at a point, with its weight in the energy ½ k e².
pub struct BeamStrain<S> {
    /// k: stiffness times length.
    pub weight: S,
    /// Whether it is that along the axis.
    pub axial: bool,
    /// b.
    pub linear: [S; MOST_UNKNOWNS],
    /// (c_s, g_s).
    pub squares: Vec<(S, [S; MOST_UNKNOWNS])>,
}

impl<S: Scalar> Beam<S> {
    /// The beam in another scalar.
    pub fn map<T: Scalar>(&self, mut f: impl FnMut(S) -> T) -> Beam<T> {
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
    pub fn zeros(&self) -> Self {
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
    pub fn energy(&self, motion: &BeamMotion<S>, von_karman: bool) -> S {
        let line = Line::new(self);
        let motion = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        let strains = Strains::new(&stiffness, von_karman);
        strain_points()
            .iter()
            .fold(S::zero(), |energy, &(r, weight)| {
                let (axes, at) = self.at(&line, &motion, r);
                let strain = strains.values(&local(&axes, &at));
                let pairs = stiffness.iter().zip(&strain);
                let density = pairs.fold(S::zero(), |sum, (&c, &e)| sum + c * e * e);
                energy + density * axes.speed * (0.5 * weight)
            })
    }

    /// Adds the derivatives of the strain energy: by the motion (the internal force) to `force`, by
    /// everything else to `to`.
    pub fn add_energy_transpose(
        &self,
        motion: &BeamMotion<S>,
        von_karman: bool,
        force: &mut BeamMotion<S>,
        to: &mut Self,
    ) {
        let line = Line::new(self);
        let moved = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        let strains = Strains::new(&stiffness, von_karman);
        let mut values_bar = SectionValues::zeros();
        let mut gyration_bar = S::zero();
        let mut bar = LineCotangent::zeros();
        for (r, weight) in strain_points() {
            let (axes, at) = self.at(&line, &moved, r);
            let x = local(&axes, &at);
            let gradients = strains.gradients(&x);
            let length = axes.speed * weight;
            let mut axes_bar = Axes::zeros();
            let mut at_bar = AtPoint::zeros();
            let mut x_bar = [S::zero(); LOCAL];
            for (k, e) in strains.values(&x).into_iter().enumerate() {
                let n = stiffness[k] * e;
                add_scaled(&mut x_bar, n * length, &gradients[k]);
                values_bar.stiffness[k] += e * e * length * 0.5;
                axes_bar.speed += n * e * (0.5 * weight);
                if k == 0 && von_karman {
                    gyration_bar += n * length * x[6] * x[6] * 0.5;
                }
            }
            add_local_transpose((&axes, &at, &x), &x_bar, &mut axes_bar, &mut at_bar);
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
        let per = gyration_bar / stiffness[0];
        values_bar.stiffness[0] -= per * gyration(&stiffness);
        values_bar.stiffness[4] += per;
        values_bar.stiffness[5] += per;
        self.section.add_values_transpose(
            &self.material,
            &values_bar,
            &mut to.section,
            &mut to.material,
        );
    }

    /// The strains of von Karman at the points, by rows over the unknowns of [`Beam::tangent`].
    pub fn strains(&self) -> Vec<BeamStrain<S>> {
        let (line, still) = (Line::new(self), BeamMotion::zeros());
        let stiffness = self.section.values(&self.material).stiffness;
        let strains = Strains::new(&stiffness, true);
        let mut all = Vec::with_capacity(STRAINS * strain_points().len());
        for (r, weight) in strain_points() {
            let (axes, _) = self.at(&line, &still, r);
            let rows = local_rows(&line, &axes, r);
            for (k, gradient) in strains.gradients(&[S::zero(); LOCAL]).iter().enumerate() {
                let own = strains.products.iter().filter(|product| product.0 == k);
                all.push(BeamStrain {
                    weight: stiffness[k] * axes.speed * weight,
                    axial: k == 0,
                    linear: combined(&rows, gradient),
                    squares: (own.flat_map(|&(_, i, j, c)| squares(&rows, (i, j, c), axes.speed)))
                        .collect(),
                });
            }
        }
        all
    }

    /// Writes the tangent stiffness at a motion, lower part, into `matrix`: unknowns are all u_a (3a + i),
    /// then all θ_a in global axes.
    pub fn tangent(&self, motion: &BeamMotion<S>, von_karman: bool, matrix: &mut ElementMatrix<S>) {
        let line = Line::new(self);
        let moved = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        let strains = Strains::new(&stiffness, von_karman);
        matrix.clear(6 * BEAM_NODES);
        for (r, weight) in strain_points() {
            let (axes, at) = self.at(&line, &moved, r);
            let x = local(&axes, &at);
            let length = axes.speed * weight;
            let rows = local_rows(&line, &axes, r);
            let (values, gradients) = (strains.values(&x), strains.gradients(&x));
            let mut second = [[S::zero(); LOCAL]; LOCAL];
            let forces: [S; STRAINS] = std::array::from_fn(|k| stiffness[k] * values[k] * length);
            strains.add_curved(&forces, &mut second);
            for (k, gradient) in gradients.iter().enumerate() {
                for (row, &g) in second.iter_mut().zip(gradient) {
                    add_scaled(row, g * stiffness[k] * length, gradient);
                }
            }
            for (row, by) in rows.iter().zip(&second) {
                add_product(matrix, row, &combined(&rows, by));
            }
        }
    }
}

/// The numbers of a motion at a point of the line as rows over the unknowns of the nodes.
fn local_rows<S: Scalar>(line: &Line<S>, axes: &Axes<S>, r: f64) -> [[S; MOST_UNKNOWNS]; LOCAL] {
    let still = AtPoint::zeros();
    std::array::from_fn(|i| {
        let mut bar = [S::zero(); LOCAL];
        bar[i] = S::one();
        let mut gradient = AtPoint::zeros();
        let at = (axes, &still, &[S::zero(); LOCAL]);
        add_local_transpose(at, &bar, &mut Axes::zeros(), &mut gradient);
        line_row(line, r, &gradient)
    })
}

/// Σ_i factor_i row_i.
fn combined<S: Scalar>(
    rows: &[[S; MOST_UNKNOWNS]; LOCAL],
    factors: &[S; LOCAL],
) -> [S; MOST_UNKNOWNS] {
    let mut out = [S::zero(); MOST_UNKNOWNS];
    for (row, &factor) in rows.iter().zip(factors) {
        if factor != S::zero() {
            add_scaled(&mut out, factor, row);
        }
    }
    out
}

/// A product c x_i x_j as half the sum of squares ½ Σ c_s (g_s·v)². A slope by length, number 6 and above, is
/// taken times the length, so that sum and difference with a rotation are of like size.
fn squares<S: Scalar>(
    rows: &[[S; MOST_UNKNOWNS]; LOCAL],
    (i, j, c): (usize, usize, S),
    length: S,
) -> Vec<(S, [S; MOST_UNKNOWNS])> {
    if i == j {
        return vec![(c * 2.0, rows[i])];
    }
    let unit = |k: usize| if k < 6 { S::one() } else { length };
    let own = c * 0.5 / (unit(i) * unit(j));
    let of = |sign: f64| {
        let mut factors = [S::zero(); LOCAL];
        factors[i] = unit(i);
        factors[j] = unit(j) * sign;
        (own * sign, combined(rows, &factors))
    };
    vec![of(1.0), of(-1.0)]
}

/// How a beam is turned at a point, and its energies there.
pub struct TurnedSection<S> {
    /// Length that the point stands for \[m\].
    pub length: S,
    /// Slope of the axis.
    pub slope: S,
    /// Twist \[rad\].
    pub twist: S,
    /// Strain energies of stretch, of bending and shear, and of torsion \[J\].
    pub energies: [S; 3],
}

impl<S: Scalar> Beam<S> {
    /// The turned sections at the points of the strains.
    pub fn turned(&self, motion: &BeamMotion<S>, von_karman: bool) -> [TurnedSection<S>; 2] {
        let line = Line::new(self);
        let motion = line.motion(motion);
        let stiffness = self.section.values(&self.material).stiffness;
        let strains = Strains::new(&stiffness, von_karman);
        strain_points().map(|(r, weight)| {
            let (axes, at) = self.at(&line, &motion, r);
            let (x, length) = (local(&axes, &at), axes.speed * weight);
            let e = strains.values(&x);
            let of = |k: usize| stiffness[k] * e[k] * e[k] * length * 0.5;
            TurnedSection {
                length,
                slope: (x[1] * x[1] + x[2] * x[2]).sqrt(),
                twist: x[3],
                energies: [of(0), of(1) + of(2) + of(4) + of(5), of(3)],
            }
        })
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

/// Adds a bᵀ, a sum of which is symmetric.
fn add_product<S: Scalar>(
    matrix: &mut ElementMatrix<S>,
    a: &[S; MOST_UNKNOWNS],
    b: &[S; MOST_UNKNOWNS],
) {
    for i in 0..6 * BEAM_NODES {
        if a[i] != S::zero() {
            for j in 0..=i {
                matrix.rows[i][j] += a[i] * b[j];
            }
        }
    }
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
