//! Whether a machine is the same after it has turned about an axis, as steady rotation needs: with the same forces, and the
//! same equations of small motions.
//!
//! The machine at rest in the turning frame is turned by an angle as a whole. Its equations are compared by one product with
//! a motion of no special kind: where something else than the turned product and reactions of joints comes out, the
//! vibrations in steady rotation have coefficients that change with time.

use super::Solver;
use super::equations::State;
use super::matrix::Factors;
use super::pencil::{At, Matrices};
use crate::math::rotation::{compose, from_axis_angle, matrix};
use crate::math::slices::{any_vector, dot};
use crate::math::{Mat3, Vec3};
use crate::system::bodies::positions_of;
use crate::system::failure::AssemblyFailure;
use crate::system::in_motion::InMotion;
use crate::system::joints;

/// Angle of no special kind \[rad\].
const ANGLE: f64 = 1.0;
/// Relative difference by which machines are the same.
const SAME: f64 = 1e-7;
/// A gap of a joint by which it is closed, relative to the size of the machine.
const CLOSED: f64 = 1e-8;
/// σ of factors, relative to the rate of the machine. Much larger ones would leave the stiffness in their round-off.
const RIGID: f64 = 1e2;

impl Solver<'_> {
    /// Checks that a solution is one at every angle of the rotation, if the machine turns.
    ///
    /// # Errors
    /// [`AssemblyFailure::NotAlike`] names what is not.
    pub(super) fn same_when_turned(&self, found: &State<f64>) -> Result<(), AssemblyFailure> {
        let Some(turning) = &self.given.turning else {
            return Ok(());
        };
        let layout = self.layout;
        let turn = from_axis_angle(&turning.axis, ANGLE);
        let rotation = matrix(&turn);
        let mut other = found.clone();
        for i in (0..self.model.bodies.len()).filter(|&i| !self.model.is_carrier(i)) {
            let o = layout.numbering.position(i);
            let (position, orientation) = positions_of(&found.q[o..]);
            let place = turning.point + rotation * (position - turning.point);
            other.q[o..o + 3].copy_from_slice(place.as_slice());
            other.q[o + 3..o + 7].copy_from_slice(&compose(&turn, &orientation));
        }
        self.joints_turn(&other)?;
        let rate = found.rate;
        let shift = RIGID * rate;
        let factors = |at: &State<f64>| {
            let mut factors = Factors::plan(layout, self.model, at);
            let made = factors.make(layout, self.model, (at, shift));
            made.map(|()| factors)
                .map_err(|_| AssemblyFailure::Singular)
        };
        let (mut here, mut there) = (factors(found)?, factors(&other)?);
        // The reactions there, by which the forces balance.
        let y = layout.groups()[0].clone();
        let mut change = layout.residual(self.model, self.given, &other);
        change.iter_mut().for_each(|x| *x = -*x);
        change[y.end..].fill(0.0);
        there.solve(&mut change);
        let n = y.len();
        if self.moved(&other, &change) * shift > SAME * rate {
            return Err(self.not_alike(&change[..n], "other forces"));
        }
        change[y].fill(0.0);
        layout.advance(&mut other, &change);

        // A motion that the joints allow.
        let mut motion = any_vector(layout.order(), 7.31);
        motion[n..].fill(0.0);
        let metric = self.metric_product(&layout.at_rest(&found.q), &motion[..n]);
        motion[..n].copy_from_slice(&metric);
        here.solve(&mut motion);
        motion.truncate(n);
        let moved = self.turned(&motion, &rotation);
        let product = |at: &State<f64>, y: &[f64]| {
            let matrices = Matrices::new(At::rest(layout, self.model, at, Some(turning)), true);
            let mut padded = y.to_vec();
            padded.resize(matrices.order(), 0.0);
            let mut out = matrices.stiffness.multiply(&padded);
            let s = rate.sqrt();
            for (part, by) in [(&matrices.damping, s), (&matrices.mass, s * s)] {
                let own = part.multiply(&padded);
                out.iter_mut().zip(&own).for_each(|(a, b)| *a += by * b);
            }
            out
        };
        let (w, other_w) = (product(found, &motion), product(&other, &moved));
        let expected = self.turned(&w[..n], &rotation);
        let mut off = other_w;
        off[..n]
            .iter_mut()
            .zip(&expected)
            .for_each(|(a, b)| *a -= b);
        let mut whole = w;
        whole[n..].fill(0.0);
        there.solve(&mut off);
        here.solve(&mut whole);
        let size = dot(&whole[..n], &whole[..n]).sqrt();
        let off_by = dot(&off[..n], &off[..n]).sqrt() / size;
        if off_by > SAME {
            let what = format!("another stiffness, damping or joint, by {off_by:.0e} of it");
            return Err(self.not_alike(&off[..n], &what));
        }
        Ok(())
    }

    /// Forces or motions of bodies, turned with them.
    fn turned(&self, y: &[f64], rotation: &Mat3<f64>) -> Vec<f64> {
        let layout = self.layout;
        let mut all = layout.expanded(y.to_vec());
        for i in (0..self.model.bodies.len()).filter(|&i| !self.model.is_carrier(i)) {
            let o = layout.numbering.velocity(i);
            let turned = rotation * Vec3::new(all[o], all[o + 1], all[o + 2]);
            all[o..o + 3].copy_from_slice(turned.as_slice());
        }
        layout.compressed(all)
    }

    /// Checks that all joints but their drives let the machine turn.
    fn joints_turn(&self, other: &State<f64>) -> Result<(), AssemblyFailure> {
        let layout = self.layout;
        let motions = layout.at_rest(&other.q);
        let mut gaps = vec![0.0; layout.numbering.constraints()];
        let at = InMotion::new(self.model, layout.numbering, &motions, self.given.time);
        joints::values(&at, &mut gaps);
        for (j, joint) in self.model.joints.iter().enumerate() {
            let driven: Vec<_> = (joint.drives.iter())
                .map(|drive| drive.dof.driven_row())
                .collect();
            let open = (layout.numbering.rows(j).zip(joint.rows())).any(|(row, kind)| {
                !driven.contains(&kind) && gaps[row].abs() > CLOSED * self.scale.max(1.0)
            });
            if open {
                let why = format!("joint \"{}\" does not let it turn", joint.name);
                return Err(AssemblyFailure::NotAlike { why });
            }
        }
        Ok(())
    }

    fn not_alike(&self, y: &[f64], what: &str) -> AssemblyFailure {
        let mut names = Vec::new();
        self.name_moving(y, &mut names);
        let why = format!("{} then has {what}", names.join(", "));
        AssemblyFailure::NotAlike { why }
    }
}
