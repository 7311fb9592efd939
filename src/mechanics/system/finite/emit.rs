//! Entries that a body of finite elements has in mass and iteration matrices. `slots` are the places of
//! the body's coordinates among the velocities: six of the frame, then the elastic ones.

use super::damping;
use super::each::each;
use super::element::{Points, gather, lift, motion, per_area, points, second, weigh};
use super::inertia::rotating;
use super::parts;
use super::stiffness::tangent;
use crate::linalg::Emit;
use crate::math::scalar::skew;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::finite::{FiniteElements, NODES, ShellElement};
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

/// Emits a matrix of some unknowns of an element, by rows. Those that the frame holds are left out.
fn emit_element<S: Scalar>(
    (element, slots): (&ShellElement, &[usize]),
    unknowns: &[usize],
    (row, column): (usize, usize),
    scale: S,
    block: &[S],
    emit: &mut dyn Emit<S>,
) {
    let place = |&k: &usize| element.coordinates[k].map(|i| slots[6 + i]);
    let places: Vec<usize> = unknowns.iter().filter_map(place).collect();
    let rows: Vec<usize> = places.iter().map(|i| row + i).collect();
    let columns: Vec<usize> = places.iter().map(|i| column + i).collect();
    if places.len() == unknowns.len() {
        return emit.add_dense(&rows, &columns, scale, block);
    }
    let moves: Vec<bool> = unknowns.iter().map(|k| place(k).is_some()).collect();
    let moving = block.chunks_exact(unknowns.len()).zip(&moves);
    let kept: Vec<S> = moving
        .filter(|(_, moves)| **moves)
        .flat_map(|(row, _)| row.iter().zip(&moves).filter(|(_, moves)| **moves))
        .map(|(&x, _)| x)
        .collect();
    emit.add_dense(&rows, &columns, scale, &kept);
}

/// Emits a mass matrix of an element: `positions` for each axis of the positions, `directors` for the
/// directors.
fn emit_masses<S: Scalar>(
    (element, slots): (&ShellElement, &[usize]),
    at: (usize, usize),
    scale: S,
    (positions, directors): (&[S], &[S]),
    emit: &mut dyn Emit<S>,
) {
    for axis in 0..3 {
        let along: Vec<usize> = (0..element.nodes.len()).map(|a| 3 * a + axis).collect();
        emit_element((element, slots), &along, at, scale, positions, emit);
    }
    let turning: Vec<usize> = (element.displacements()..element.moves.len()).collect();
    emit_element((element, slots), &turning, at, scale, directors, emit);
}

/// Emits the part of a matrix of an element that couples positions with positions, and directors with
/// directors.
fn emit_parts<S: Scalar>(
    (element, slots): (&ShellElement, &[usize]),
    at: (usize, usize),
    scale: S,
    (positions, directors): (&[S], &[S]),
    emit: &mut dyn Emit<S>,
) {
    let moving: Vec<usize> = (0..element.displacements()).collect();
    emit_element((element, slots), &moving, at, scale, positions, emit);
    let turning: Vec<usize> = (element.displacements()..element.moves.len()).collect();
    emit_element((element, slots), &turning, at, scale, directors, emit);
}

/// The matrix w A_ab a_k · (M a_l) of directors, a_k how unknown k moves its director.
fn of_directors<S: Scalar>(
    element: &ShellElement,
    weight: S,
    turn: impl Fn(&Vec3<f64>) -> Vec3<S>,
) -> Vec<S> {
    let moves = &element.moves[element.displacements()..];
    let turned: Vec<Vec3<S>> = moves.iter().map(|(_, along)| turn(along)).collect();
    let mut out = Vec::with_capacity(moves.len() * moves.len());
    for (a, along) in moves {
        let shares = &element.shares[a - NODES];
        for ((b, _), by) in moves.iter().zip(&turned) {
            let inner = by[0] * along[0] + by[1] * along[1] + by[2] * along[2];
            out.push(weight * inner * shares[b - NODES]);
        }
    }
    out
}

/// A_ab of the nodes that the element has, by rows.
fn shares(element: &ShellElement) -> impl Iterator<Item = &[f64]> {
    let count = element.nodes.len();
    element.shares[..count].iter().map(move |row| &row[..count])
}

/// The matrix w A_ab M of positions.
fn of_positions<S: Scalar>(element: &ShellElement, weight: S, turn: &Mat3<S>) -> Vec<S> {
    let mut out = Vec::with_capacity(element.displacements() * element.displacements());
    for shares in shares(element) {
        for i in 0..3 {
            for &share in shares {
                let by = weight * share;
                out.extend([0, 1, 2].map(|j| by * turn[(i, j)]));
            }
        }
    }
    out
}

/// Emits the mass matrix without mass and undeformed inertia, times `scale`.
pub fn emit_mass<S: Scalar>(
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
        let positions: Vec<S> = shares(element)
            .flatten()
            .map(|&share| weights[0] * share)
            .collect();
        let directors = of_directors(element, weights[1], lift);
        let masses = (&positions[..], &directors[..]);
        emit_masses((element, slots), at, scale, masses, emit);
    }
    frame.rows = frame.columns.clone();
    let coupled = rotation * skew(&first);
    frame.block[0][1] = -coupled;
    frame.block[1][0] = -coupled.transpose();
    frame.block[1][1] = Mat3::identity() * moments.trace() - moments;
    frame.emit(slots, at, scale, emit);
    parts::emit_mass(finite, (rotation, q), slots, at, scale, emit);
}

/// Emits a diagonal of the coordinates, in the order of the mass matrix. An entry is that of the first element or part
/// that has its coordinate.
pub fn emit_diagonal<S: Scalar>(
    finite: &FiniteElements<S>,
    slots: &[usize],
    mut left: Vec<S>,
    emit: &mut dyn Emit<S>,
) {
    for element in &finite.mesh.elements {
        let mut emit_some = |which: &[usize]| {
            let count = which.len();
            let mut block = vec![S::zero(); count * count];
            for (k, &unknown) in which.iter().enumerate() {
                if let Some(i) = element.coordinates[unknown] {
                    block[k * (count + 1)] = std::mem::replace(&mut left[i], S::zero());
                }
            }
            emit_element((element, slots), which, (0, 0), S::one(), &block, emit);
        };
        for axis in 0..3 {
            let along: Vec<usize> = (0..element.nodes.len()).map(|a| 3 * a + axis).collect();
            emit_some(&along);
        }
        let turning: Vec<usize> = (element.displacements()..element.moves.len()).collect();
        emit_some(&turning);
    }
    Frame::zero(finite.mesh.coordinates).emit(slots, (0, 0), S::one(), emit);
    parts::emit_diagonal(finite, slots, &mut left, emit);
}

/// Emits the derivatives of inertial and elastic forces, the accelerations held: in tangent positions
/// times `by_y` at (row, y), in velocities times `by_v` at (row, v).
pub fn emit_jacobian<S: Scalar>(
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
    let elements = &finite.mesh.elements;
    let work = |i: usize| OfElement::of(finite, i, at);
    // It takes longer to send matrices than to make them: every rank makes all.
    each(elements.len(), work, |i, own| {
        let (element, weights) = (&elements[i], per_area(finite, i));
        let OfElement {
            place,
            weighed,
            weighed_rate,
            forces,
            matrices,
        } = own;
        add_moments(&place, &weighed, &mut first, &mut moments);
        add_moments(&place, &weighed_rate, &mut first_rate, &mut moments_rate);
        force += forces[..NODES]
            .iter()
            .fold(Vec3::zeros(), |sum: Vec3<S>, f| sum + f);
        force -= at.gamma * (weights[0] * element.area);
        moments -= second(element, weights).transpose();
        for (l, (point, along)) in element.moves.iter().enumerate() {
            let c = lift::<S>(along);
            let Some(j) = element.coordinates[l] else {
                continue;
            };
            let (turned, spun) = (b * c, twice * c);
            if *point < NODES {
                let share = weights[0] * element.shares[*point].iter().sum::<f64>();
                in_y.columns[0][j] += rotation * (turned * share);
                in_v.columns[0][j] += rotation * (spun * share);
                in_y.rows[1][j] += (c * share).cross(&at.gamma);
            }
            let w = &weighed[*point];
            in_y.columns[1][j] += c.cross(&forces[*point]) + w.cross(&turned);
            in_v.columns[1][j] += w.cross(&spun);
            for (k, (square, double)) in units.iter().enumerate() {
                let by = square * w + double * weighed_rate[*point];
                in_v.rows[1][j][k] += c.dot(&by);
            }
        }
        let all: Vec<usize> = (0..element.moves.len()).collect();
        emit_element(
            (element, slots),
            &all,
            (row, y),
            by_y,
            &matrices.stiffness,
            emit,
        );
        let both = (&matrices.positions[..], &matrices.directors[..]);
        emit_parts((element, slots), (row, v), by_v, both, emit);
        if let Some([in_x, in_r]) = &matrices.damping {
            emit_element((element, slots), &all, (row, y), by_y, in_x, emit);
            emit_element((element, slots), &all, (row, v), by_v, in_r, emit);
        }
    });
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
    parts::emit_jacobian(finite, at, slots, (row, y, v), (by_y, by_v), emit);
}

/// Places, rates and forces of the points of an element, and its matrices.
struct OfElement<S> {
    place: Points<S>,
    weighed: Points<S>,
    weighed_rate: Points<S>,
    forces: Points<S>,
    matrices: Box<Matrices<S>>,
}

/// Derivatives of the forces of an element, without those of the frame.
struct Matrices<S> {
    /// Elastic and centrifugal forces by the unknowns.
    stiffness: Vec<S>,
    /// Coriolis forces of positions by positions, and of directors by directors.
    positions: Vec<S>,
    directors: Vec<S>,
    /// Damping by unknowns and rates.
    damping: Option<[Vec<S>; 2]>,
}

impl<S: Scalar> OfElement<S> {
    fn of(finite: &FiniteElements<S>, i: usize, at: &Flexing<S>) -> Self {
        let (element, weights) = (&finite.mesh.elements[i], per_area(finite, i));
        let (b, twice) = rotating(at);
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
        let n = element.moves.len();
        let mut stiffness = vec![S::zero(); n * n];
        tangent(finite, i, &x, &mut stiffness);
        let turned = of_positions(element, weights[0], &b);
        let of_directors_turned = of_directors(element, weights[1], |along| b * lift::<S>(along));
        let (upper, lower) = stiffness.split_at_mut(element.displacements() * n);
        add_part(upper, &turned, (n, 0));
        add_part(lower, &of_directors_turned, (n, element.displacements()));
        let factors = finite.damping;
        Self {
            weighed: weigh(element, weights, &place),
            weighed_rate: weigh(element, weights, &rate),
            forces: weigh(element, weights, &a),
            place,
            matrices: Box::new(Matrices {
                stiffness,
                positions: of_positions(element, weights[0], &twice),
                directors: of_directors(element, weights[1], |along| twice * lift::<S>(along)),
                damping: factors
                    .map(|factors| damping::matrices(finite, i, factors, (&at.q, &at.rate))),
            }),
        }
    }
}

/// Adds the square matrix `part` to rows of length n, from `column` on.
fn add_part<S: Scalar>(rows: &mut [S], part: &[S], (n, column): (usize, usize)) {
    let width = rows.len() / n;
    for (row, part) in rows.chunks_exact_mut(n).zip(part.chunks_exact(width)) {
        for (x, &by) in row[column..].iter_mut().zip(part) {
            *x += by;
        }
    }
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
