//! From the coordinates of a body to the unknowns and points of an element, and back.

use crate::math::{Mat3, Scalar, Vec3};
use crate::model::finite::{FiniteElements, NODES, POINTS, ShellElement, UNKNOWNS};
use crate::model::shell_kind::ShellKind;

/// Unknowns of an element, or forces on them.
pub type Local<S> = [S; UNKNOWNS];
/// A vector for each point of an element.
pub(super) type Points<S> = [Vec3<S>; POINTS];

/// The node in the middle, or of four nodes the first.
fn middle(element: &ShellElement) -> usize {
    match element.kind() {
        ShellKind::Mitc9 => 4,
        ShellKind::Mitc4 => 0,
    }
}

/// A constant vector in another scalar.
pub fn lift<S: Scalar>(v: &Vec3<f64>) -> Vec3<S> {
    v.map(S::from)
}

/// The unknowns of an element.
pub fn gather<S: Scalar>(element: &ShellElement, q: &[S]) -> Local<S> {
    let mut out = [S::zero(); UNKNOWNS];
    for (out, coordinate) in out.iter_mut().zip(&element.coordinates) {
        if let Some(i) = coordinate {
            *out = q[*i];
        }
    }
    out
}

/// The unknowns of an element, or their rates, with what deforms the element.
pub(super) struct Deformed<S> {
    /// All of the motion.
    pub all: Local<S>,
    /// It without the rigid motion of the node in the middle (of four nodes, of the first); without its translation alone if not all nodes can turn.
    ///
    /// Matrices that no rigid motion stresses have the same products with both. The round-off with this is smaller,
    /// because it is relative to what deforms the element.
    pub deformation: Local<S>,
}

impl<S: Scalar> Deformed<S> {
    pub(super) fn new(element: &ShellElement, all: Local<S>) -> Self {
        Self {
            deformation: deformation(element, &all),
            all,
        }
    }

    /// That of the coordinates of a body.
    pub(super) fn of(element: &ShellElement, q: &[S]) -> Self {
        Self::new(element, gather(element, q))
    }
}

fn deformation<S: Scalar>(element: &ShellElement, x: &Local<S>) -> Local<S> {
    let (middle, count) = (middle(element), element.displacements());
    let mut theta = Vec3::<S>::zeros();
    for (turn, &x) in element.turns.iter().zip(&x[count..]) {
        if turn.node == middle {
            (0..3).for_each(|k| theta[k] += x * turn.axis[k]);
        }
    }
    let mut out = *x;
    for (a, place) in element.points[..element.nodes.len()].iter().enumerate() {
        let arm = place - element.points[middle];
        let moved = [
            theta[1] * arm[2] - theta[2] * arm[1],
            theta[2] * arm[0] - theta[0] * arm[2],
            theta[0] * arm[1] - theta[1] * arm[0],
        ];
        for (k, moved) in moved.into_iter().enumerate() {
            out[3 * a + k] = (x[3 * a + k] - x[3 * middle + k]) - moved;
        }
    }
    for (turn, out) in element.turns.iter().zip(&mut out[count..]) {
        let by = &turn.inverse;
        *out -= theta[0] * by[0] + theta[1] * by[1] + theta[2] * by[2];
    }
    out
}

/// Transpose of [`gather`].
pub(super) fn scatter<S: Scalar>(element: &ShellElement, x: &Local<S>, out: &mut [S]) {
    for (&x, coordinate) in x.iter().zip(&element.coordinates) {
        if let Some(i) = coordinate {
            out[*i] += x;
        }
    }
}

/// How unknowns, or their rates, move the points.
pub fn motion<S: Scalar>(element: &ShellElement, x: &Local<S>) -> Points<S> {
    let mut out = [Vec3::zeros(); POINTS];
    let count = element.displacements();
    for (l, &x) in x.iter().enumerate().take(count) {
        out[l / 3][l % 3] = x;
    }
    for (&x, (point, along)) in x.iter().zip(&element.moves).skip(count) {
        for k in 0..3 {
            out[*point][k] += x * along[k];
        }
    }
    out
}

/// Transpose of [`motion`].
pub(super) fn motion_transpose<S: Scalar>(element: &ShellElement, by: &Points<S>) -> Local<S> {
    let mut out = [S::zero(); UNKNOWNS];
    let count = element.displacements();
    for (l, out) in out.iter_mut().enumerate().take(count) {
        *out = by[l / 3][l % 3];
    }
    for (out, (point, along)) in out.iter_mut().zip(&element.moves).skip(count) {
        let by = &by[*point];
        *out = by[0] * along[0] + by[1] * along[1] + by[2] * along[2];
    }
    out
}

/// Where the points are.
pub(super) fn points<S: Scalar>(element: &ShellElement, x: &Local<S>) -> Points<S> {
    let mut out = motion(element, x);
    for (out, point) in out.iter_mut().zip(&element.points) {
        for k in 0..3 {
            out[k] += S::from(point[k]);
        }
    }
    out
}

/// Mass and rotary inertia per area of an element.
pub fn per_area<S: Scalar>(finite: &FiniteElements<S>, i: usize) -> [S; 2] {
    let (h, rho) = (finite.thickness[i], finite.density[i]);
    [
        rho * h + finite.surface_mass[i],
        rho * h * h * h * (1.0 / 12.0),
    ]
}

/// Transpose of the derivative of [`per_area`].
pub(super) fn pull_per_area(
    finite: &FiniteElements<f64>,
    i: usize,
    by: [f64; 2],
    cot: &mut FiniteElements<f64>,
) {
    let (h, rho) = (finite.thickness[i], finite.density[i]);
    cot.surface_mass[i] += by[0];
    cot.density[i] += by[0] * h + by[1] * h * h * h / 12.0;
    cot.thickness[i] += by[0] * rho + by[1] * rho * h * h / 4.0;
}

/// Σ_l A_kl x_l: positions with positions, directors with directors.
pub(super) fn share<S: Scalar>(element: &ShellElement, x: &Points<S>) -> Points<S> {
    match element.kind() {
        ShellKind::Mitc9 => share_of::<S, NODES>(element, x),
        ShellKind::Mitc4 => share_of::<S, 4>(element, x),
    }
}

/// [`share`] of N nodes.
fn share_of<S: Scalar, const N: usize>(element: &ShellElement, x: &Points<S>) -> Points<S> {
    let mut out = [Vec3::zeros(); POINTS];
    for kind in [0, NODES] {
        for a in 0..N {
            let (row, out) = (&element.shares[a], &mut out[kind + a]);
            for b in 0..N {
                let x = &x[kind + b];
                for k in 0..3 {
                    out[k] += x[k] * row[b];
                }
            }
        }
    }
    out
}

/// The products of [`share`] times the masses per area.
pub(super) fn weigh<S: Scalar>(
    element: &ShellElement,
    per_area: [S; 2],
    x: &Points<S>,
) -> Points<S> {
    let mut out = share(element, x);
    for (k, out) in out.iter_mut().enumerate() {
        *out *= per_area[k / NODES];
    }
    out
}

/// Second moment of the undeformed element, which the rigid body has.
pub(super) fn second<S: Scalar>(element: &ShellElement, per_area: [S; 2]) -> Mat3<S> {
    element.second[0].map(S::from) * per_area[0] + element.second[1].map(S::from) * per_area[1]
}
