//! Entries that a body of finite elements has in mass and iteration matrices. `slots` are the places of
//! the body's coordinates among the velocities: six of the frame, then the elastic ones.

use super::element::{Points, gather, lift, motion, per_area, points, second, weigh};
use super::inertia::rotating;
use super::stiffness::tangent;
use crate::linalg::Emit;
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::finite::{FiniteElements, NODES, ShellElement, UNKNOWNS};
use crate::system::flexing::{Flexing, axial};

/// Columns and rows that couple the frame with the coordinates, each a vector of three, and the block of
/// the frame itself.
struct Frame<S> {
    /// Columns of the coordinates in the rows of force and of torque.
    columns: [Vec<Vec3<S>>; 2],
    /// Rows of the coordinates in the columns of position and of rotation.
    rows: [Vec<Vec3<S>>; 2],
    block: [[Mat3<S>; 2]; 2],
}

impl<S: Scalar> Frame<S> {
    fn zero(count: usize) -> Self {
        let none = || [vec![Vec3::zeros(); count], vec![Vec3::zeros(); count]];
        Self {
            columns: none(),
            rows: none(),
            block: [[Mat3::zeros(); 2]; 2],
        }
    }

    fn emit(
        &self,
        slots: &[usize],
        (row, column): (usize, usize),
        scale: S,
        emit: &mut dyn Emit<S>,
    ) {
        for i in 0..2 {
            let own = slots[3 * i];
            for j in 0..2 {
                emit.add_block(
                    row + own,
                    column + slots[3 * j],
                    &(self.block[i][j] * scale),
                );
            }
            for (slot, x) in slots[6..].iter().zip(&self.columns[i]) {
                emit.add_column(row + own, column + slot, &(x * scale));
            }
            for (slot, x) in slots[6..].iter().zip(&self.rows[i]) {
                emit.add_row(row + slot, column + own, &(x * scale));
            }
        }
    }
}

/// Emits a matrix of an element; `entry` gives what stands at a row and column, if anything.
fn emit_element<S: Scalar>(
    element: &ShellElement,
    slots: &[usize],
    (row, column): (usize, usize),
    scale: S,
    entry: impl Fn(usize, usize) -> Option<S>,
    emit: &mut dyn Emit<S>,
) {
    for (k, i) in element.coordinates.iter().enumerate() {
        let Some(i) = i else { continue };
        let at = row + slots[6 + i];
        for (l, j) in element.coordinates.iter().enumerate() {
            let Some(j) = j else { continue };
            if let Some(x) = entry(k, l) {
                emit.add(at, column + slots[6 + j], x * scale);
            }
        }
    }
}

/// Whether the directions of two unknowns can have an inner product.
fn couples(element: &ShellElement, k: usize, l: usize) -> bool {
    let (a, b) = (element.moves[k].0, element.moves[l].0);
    a / NODES == b / NODES && (a >= NODES || k % 3 == l % 3)
}

/// Share of two unknowns' points.
fn shared(element: &ShellElement, k: usize, l: usize) -> f64 {
    element.shares[element.moves[k].0 % NODES][element.moves[l].0 % NODES]
}

/// Emits the mass matrix without mass and undeformed inertia, times `scale`.
pub(crate) fn emit_mass<S: Scalar>(
    finite: &FiniteElements<S>,
    (rotation, q): (&Mat3<S>, &[S]),
    slots: &[usize],
    at: (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    let mut frame = Frame::zero(q.len());
    let (mut first, mut moments) = (Vec3::zeros(), Mat3::zeros());
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let weights = per_area(finite, i);
        let place = points(element, &gather(element, q));
        let weighed = weigh(element, weights, &place);
        for (k, (p, w)) in place.iter().zip(&weighed).enumerate() {
            moments += p * w.transpose();
            if k < NODES {
                first += w;
            }
        }
        moments -= second(element, weights);
        for (coordinate, (point, along)) in element.coordinates.iter().zip(&element.moves) {
            let Some(j) = coordinate else { continue };
            let c = lift::<S>(along);
            if *point < NODES {
                let sum: f64 = element.shares[*point].iter().sum();
                frame.columns[0][*j] += rotation * (c * (weights[0] * sum));
            }
            frame.columns[1][*j] += weighed[*point].cross(&c);
        }
        let entry = |k: usize, l: usize| {
            couples(element, k, l).then(|| {
                let along = element.moves[k].1.dot(&element.moves[l].1);
                weights[element.moves[k].0 / NODES] * (shared(element, k, l) * along)
            })
        };
        emit_element(element, slots, at, scale, entry, emit);
    }
    frame.rows = frame.columns.clone();
    let coupled = rotation * skew(&first);
    frame.block[0][1] = -coupled;
    frame.block[1][0] = -coupled.transpose();
    frame.block[1][1] = Mat3::identity() * moments.trace() - moments;
    frame.emit(slots, at, scale, emit);
}

/// Emits the diagonal of [`super::weights`], in the order of the mass matrix.
pub(crate) fn emit_weights<S: Scalar>(
    finite: &FiniteElements<S>,
    slots: &[usize],
    emit: &mut dyn Emit<S>,
) {
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let weights = per_area(finite, i);
        let entry = |k: usize, l: usize| {
            couples(element, k, l).then(|| {
                let own = if k == l {
                    element.moves[k].1.norm_squared()
                } else {
                    0.0
                };
                weights[element.moves[k].0 / NODES] * (shared(element, k, l) * own)
            })
        };
        emit_element(element, slots, (0, 0), S::one(), entry, emit);
    }
    Frame::zero(finite.mesh.coordinates).emit(slots, (0, 0), S::one(), emit);
}

/// Emits the derivatives of inertial and elastic forces, the accelerations held: in tangent positions
/// times `by_y` at (row, y), in velocities times `by_v` at (row, v).
pub(crate) fn emit_jacobian<S: Scalar>(
    finite: &FiniteElements<S>,
    motion_of: &Flexing<S>,
    slots: &[usize],
    (row, y, v): (usize, usize, usize),
    (by_y, by_v): (S, S),
    emit: &mut dyn Emit<S>,
) {
    let at = motion_of;
    let (b, twice) = rotating(at);
    let spin = skew(&at.omega);
    let rotation = &at.rotation;
    let units: [(Mat3<S>, Mat3<S>); 3] = std::array::from_fn(|k| {
        let mut unit = Vec3::zeros();
        unit[k] = S::one();
        let unit = skew(&unit);
        (unit * spin + spin * unit, unit * S::from(2.0))
    });
    let (mut in_y, mut in_v) = (Frame::zero(at.q.len()), Frame::zero(at.q.len()));
    let (mut first, mut first_rate, mut force) = (Vec3::zeros(), Vec3::zeros(), Vec3::zeros());
    let (mut moments, mut moments_rate) = (Mat3::zeros(), Mat3::zeros());
    let mut stiffness = [[S::zero(); UNKNOWNS]; UNKNOWNS];
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let weights = per_area(finite, i);
        let x = gather(element, &at.q);
        let place = points(element, &x);
        let rate = motion(element, &gather(element, &at.rate));
        let mut a = motion(element, &gather(element, &at.acceleration));
        for (k, a) in a.iter_mut().enumerate() {
            *a += b * place[k] + twice * rate[k];
            if k < NODES {
                *a += at.gamma;
            }
        }
        let (weighed, weighed_rate) = (
            weigh(element, weights, &place),
            weigh(element, weights, &rate),
        );
        let forces = weigh(element, weights, &a);
        add_moments(&place, &weighed, &mut first, &mut moments);
        add_moments(&place, &weighed_rate, &mut first_rate, &mut moments_rate);
        force += forces[..NODES]
            .iter()
            .fold(Vec3::zeros(), |sum: Vec3<S>, f| sum + f);
        force -= at.gamma * (weights[0] * element.area);
        moments -= second(element, weights).transpose();
        let mut turned = [Vec3::zeros(); UNKNOWNS];
        let mut spun = [Vec3::zeros(); UNKNOWNS];
        for (l, (point, along)) in element.moves.iter().enumerate() {
            let c = lift::<S>(along);
            (turned[l], spun[l]) = (b * c, twice * c);
            let Some(j) = element.coordinates[l] else {
                continue;
            };
            if *point < NODES {
                let share = weights[0] * element.shares[*point].iter().sum::<f64>();
                in_y.columns[0][j] += rotation * (turned[l] * share);
                in_v.columns[0][j] += rotation * (spun[l] * share);
                in_y.rows[1][j] += (c * share).cross(&at.gamma);
            }
            let w = &weighed[*point];
            in_y.columns[1][j] += c.cross(&forces[*point]) + w.cross(&turned[l]);
            in_v.columns[1][j] += w.cross(&spun[l]);
            for (k, (square, double)) in units.iter().enumerate() {
                let by = square * w + double * weighed_rate[*point];
                in_v.rows[1][j][k] += c.dot(&by);
            }
        }
        tangent(finite, i, &x, &mut stiffness);
        let rotated = |k: usize, l: usize, turned: &[Vec3<S>; UNKNOWNS]| {
            let (point, along) = &element.moves[k];
            let by = &turned[l];
            let inner = by[0] * along[0] + by[1] * along[1] + by[2] * along[2];
            weights[point / NODES] * inner * shared(element, k, l)
        };
        let same = |k: usize, l: usize| element.moves[k].0 / NODES == element.moves[l].0 / NODES;
        let in_place = |k: usize, l: usize| {
            let own = stiffness[k.max(l)][k.min(l)];
            Some(match same(k, l) {
                true => own + rotated(k, l, &turned),
                false => own,
            })
        };
        emit_element(element, slots, (row, y), by_y, in_place, emit);
        let in_rate = |k: usize, l: usize| same(k, l).then(|| rotated(k, l, &spun));
        emit_element(element, slots, (row, v), by_v, in_rate, emit);
    }
    in_y.block[0][1] = -(rotation * skew(&force));
    in_y.block[1][1] = skew(&first) * skew(&at.gamma);
    for (k, (square, double)) in units.iter().enumerate() {
        let force = square * first + double * first_rate;
        in_v.block[0][1].set_column(k, &(rotation * force));
        let torque = axial(&(square * moments + double * moments_rate));
        in_v.block[1][1].set_column(k, &torque);
    }
    in_y.emit(slots, (row, y), by_y, emit);
    in_v.emit(slots, (row, v), by_v, emit);
}

/// Adds Σ w_k over positions, and Σ w_k p_kᵀ.
fn add_moments<S: Scalar>(
    place: &Points<S>,
    weighed: &Points<S>,
    first: &mut Vec3<S>,
    moments: &mut Mat3<S>,
) {
    for (k, (p, w)) in place.iter().zip(weighed).enumerate() {
        *moments += w * p.transpose();
        if k < NODES {
            *first += w;
        }
    }
}
