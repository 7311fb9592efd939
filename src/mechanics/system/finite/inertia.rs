//! Inertial forces of a body of finite elements, energy and momenta, and their derivatives.
//!
//! With the accelerations a_k = γ + B P_k + 2 ω̃ Ṗ_k + P̈_k of the points less gravity (γ at positions only),
//! the forces on them are F_k = Σ_l m_kl a_l. The frame takes Σ F_k and Σ P_k × F_k, the coordinates their
//! parts of F_k. Terms of the mass alone and of the undeformed inertia are those of a rigid body; they are
//! in [`crate::system::bodies`] and left out here, as in [`crate::system::flexing`].

use super::each::each_over;
use super::element::{
    Points, gather, motion, motion_transpose, per_area, points, pull_per_area, scatter, second,
    share, weigh,
};
use super::parts;
use crate::math::scalar::skew;
use crate::math::{Mat3, Packed, Scalar, Vec3};
use crate::model::finite::{FiniteElements, NODES, POINTS, ShellElement};
use crate::system::flexing::{Flexing, FlexingCotangent, Generalised, Moving, axial};

/// Points of an element in motion.
struct Moved<S> {
    place: Points<S>,
    rate: Points<S>,
}

impl<S: Scalar> Moved<S> {
    fn of(element: &ShellElement, at: &Flexing<S>) -> Self {
        Self {
            place: points(element, &gather(element, &at.q)),
            rate: motion(element, &gather(element, &at.rate)),
        }
    }
}

/// B = ω̃ ω̃ + ω̇~ and 2 ω̃.
pub(super) fn rotating<S: Scalar>(at: &Flexing<S>) -> (Mat3<S>, Mat3<S>) {
    let spin = skew(&at.omega);
    (spin * spin + skew(&at.alpha), spin * S::from(2.0))
}

/// Accelerations of the points less gravity.
fn accelerations<S: Scalar>(
    element: &ShellElement,
    moved: &Moved<S>,
    (b, twice): &(Mat3<S>, Mat3<S>),
    at: &Flexing<S>,
) -> Points<S> {
    let mut all = motion(element, &gather(element, &at.acceleration));
    for (k, a) in all.iter_mut().enumerate() {
        *a += b * moved.place[k] + twice * moved.rate[k];
        if k < NODES {
            *a += at.gamma;
        }
    }
    all
}

/// Inertial forces without those of mass and undeformed inertia.
pub fn inertial<S: Scalar>(finite: &FiniteElements<S>, at: &Flexing<S>) -> Generalised<S> {
    let by_rotation = rotating(at);
    let mut out = Generalised {
        linear: Vec3::zeros(),
        angular: Vec3::zeros(),
        elastic: vec![S::zero(); at.q.len()],
    };
    let elements = &finite.mesh.elements;
    let work = |i: usize| {
        let (element, weights) = (&elements[i], per_area(finite, i));
        let moved = Moved::of(element, at);
        let a = accelerations(element, &moved, &by_rotation, at);
        let forces = weigh(element, weights, &a);
        let (mut linear, mut angular) = (Vec3::zeros(), Vec3::zeros());
        for (k, (place, force)) in moved.place.iter().zip(&forces).enumerate() {
            if k < NODES {
                linear += force;
            }
            angular += place.cross(force);
        }
        linear -= at.gamma * (weights[0] * element.area);
        angular -= axial(&(by_rotation.0 * second(element, weights)));
        (linear, angular, motion_transpose(element, &forces))
    };
    each_over(
        &finite.team,
        elements.len(),
        work,
        |i, (linear, angular, forces)| {
            out.linear += linear;
            out.angular += angular;
            scatter(&elements[i], &forces, &mut out.elastic);
        },
    );
    out.linear = at.rotation * out.linear;
    parts::add_inertial(finite, at, &mut out);
    out
}

/// What an element adds to the cotangents of B, γ, ω and the masses per area, and its force on the frame.
struct OfElement {
    b: Mat3<f64>,
    gamma: Vec3<f64>,
    force: Vec3<f64>,
    omega: Vec3<f64>,
    weight: [f64; 2],
}

impl Packed for OfElement {
    fn pack(&self, out: &mut Vec<f64>) {
        self.b.pack(out);
        [self.gamma, self.force, self.omega].pack(out);
        self.weight.pack(out);
    }

    fn unpack(from: &mut &[f64]) -> Self {
        let b = Packed::unpack(from);
        let [gamma, force, omega] = Packed::unpack(from);
        Self {
            b,
            gamma,
            force,
            omega,
            weight: Packed::unpack(from),
        }
    }
}

/// Pulls the cotangent ψ of [`inertial`] back to the motion, the accelerations held, and to the
/// parameters (added to `cot`).
pub fn pull_back(
    finite: &FiniteElements<f64>,
    at: &Flexing<f64>,
    psi: &Generalised<f64>,
    cot: &mut FiniteElements<f64>,
) -> FlexingCotangent<f64> {
    let by_rotation = rotating(at);
    let (b, twice) = &by_rotation;
    let phi = at.rotation.tr_mul(&psi.linear);
    let t = &psi.angular;
    let turn = skew(t);
    let m = at.q.len();
    let mut out = FlexingCotangent {
        theta: Vec3::zeros(),
        omega: Vec3::zeros(),
        q: vec![0.0; m],
        rate: vec![0.0; m],
        gravity: Vec3::zeros(),
    };
    let (mut by_b, mut by_gamma, mut force) = (Mat3::zeros(), Vec3::zeros(), Vec3::zeros());
    let elements = &finite.mesh.elements;
    let work = |i: usize| {
        let (element, weights) = (&elements[i], per_area(finite, i));
        let moved = Moved::of(element, at);
        let a = accelerations(element, &moved, &by_rotation, at);
        let mut virtually = motion(element, &gather(element, &psi.elastic));
        for (k, v) in virtually.iter_mut().enumerate() {
            *v += t.cross(&moved.place[k]);
            if k < NODES {
                *v += phi;
            }
        }
        let shared = share(element, &virtually);
        let forces = weigh(element, weights, &a);
        let (mut by_place, mut by_rate) = ([Vec3::zeros(); POINTS], [Vec3::zeros(); POINTS]);
        let mut by = OfElement {
            b: -(turn * second(element, weights)),
            gamma: -phi * (weights[0] * element.area),
            force: -at.gamma * (weights[0] * element.area),
            omega: Vec3::zeros(),
            weight: [-phi.dot(&at.gamma) * element.area, 0.0],
        };
        // What the rigid body has.
        for (by, second) in by.weight.iter_mut().zip(&element.second) {
            *by -= t.dot(&axial(&(b * second)));
        }
        for k in 0..POINTS {
            let by_a = shared[k] * weights[k / NODES];
            by.weight[k / NODES] += shared[k].dot(&a[k]);
            by.b += by_a * moved.place[k].transpose();
            by_place[k] = b.tr_mul(&by_a) + forces[k].cross(t);
            by_rate[k] = twice.tr_mul(&by_a);
            by.omega += moved.rate[k].cross(&by_a) * 2.0;
            if k < NODES {
                by.gamma += by_a;
                by.force += forces[k];
            }
        }
        let state = [&by_place, &by_rate].map(|by| motion_transpose(element, by));
        (by, state)
    };
    each_over(
        &finite.team,
        elements.len(),
        work,
        |i, (by, [by_place, by_rate])| {
            by_b += by.b;
            by_gamma += by.gamma;
            force += by.force;
            out.omega += by.omega;
            pull_per_area(finite, i, by.weight, cot);
            scatter(&elements[i], &by_place, &mut out.q);
            scatter(&elements[i], &by_rate, &mut out.rate);
        },
    );
    let spin = skew(&at.omega);
    out.omega -= axial(&(by_b * spin + spin * by_b));
    out.theta = by_gamma.cross(&at.gamma) + force.cross(&phi);
    out.gravity = -(at.rotation * by_gamma);
    parts::pull_back(finite, at, psi, cot, &mut out);
    out
}

/// Velocities of the points, without that of the frame's origin.
fn velocities<S: Scalar>(moved: &Moved<S>, omega: &Vec3<S>) -> Points<S> {
    std::array::from_fn(|k| omega.cross(&moved.place[k]) + moved.rate[k])
}

/// Kinetic energy and momenta at the velocity ν of the frame's origin (axes of the frame), without those
/// of mass and undeformed inertia.
pub fn moving<S: Scalar>(finite: &FiniteElements<S>, at: &Flexing<S>, nu: &Vec3<S>) -> Moving<S> {
    let mut out = Moving {
        kinetic: S::zero(),
        momentum: Vec3::zeros(),
        spin: Vec3::zeros(),
    };
    let spin = skew(&at.omega);
    let mut turning = S::zero();
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let weights = per_area(finite, i);
        let moved = Moved::of(element, at);
        let v = velocities(&moved, &at.omega);
        let momenta = weigh(element, weights, &v);
        let mut first = Vec3::zeros();
        let places = share(element, &moved.place);
        for k in 0..POINTS {
            turning += v[k].dot(&momenta[k]);
            out.spin += moved.place[k].cross(&momenta[k]);
            if k < NODES {
                out.momentum += momenta[k];
                first += places[k] * weights[0];
            }
        }
        out.spin += first.cross(nu);
        let rigid = second(element, weights);
        out.spin -= axial(&(spin * rigid));
        turning += (spin * spin * rigid).trace();
    }
    out.kinetic = nu.dot(&out.momentum) + turning * 0.5;
    parts::add_moving(finite, at, nu, &mut out);
    out
}

/// Pulls the kinetic energy of [`moving`], times `scale`, back to the motion, to the velocity of the
/// origin (ground axes, returned) and to the parameters (added to `cot`).
pub fn pull_kinetic(
    finite: &FiniteElements<f64>,
    at: &Flexing<f64>,
    nu: &Vec3<f64>,
    scale: f64,
    cot: &mut FiniteElements<f64>,
) -> (FlexingCotangent<f64>, Vec3<f64>) {
    let m = at.q.len();
    let mut out = FlexingCotangent {
        theta: Vec3::zeros(),
        omega: Vec3::zeros(),
        q: vec![0.0; m],
        rate: vec![0.0; m],
        gravity: Vec3::zeros(),
    };
    let spin = skew(&at.omega);
    let mut momentum = Vec3::zeros();
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let weights = per_area(finite, i);
        let moved = Moved::of(element, at);
        let v = velocities(&moved, &at.omega);
        let mut with_nu = v;
        for v in &mut with_nu[..NODES] {
            *v += nu;
        }
        // ½ Σ (v + ν) A (v + ν) less ½ area ν² and the part of the undeformed inertia.
        let shared = share(element, &with_nu);
        let own = share(element, &v);
        let (mut by_place, mut by_rate) = ([Vec3::zeros(); POINTS], [Vec3::zeros(); POINTS]);
        let mut by_weight = [0.0; 2];
        for k in 0..POINTS {
            let by_v = shared[k] * (weights[k / NODES] * scale);
            by_weight[k / NODES] += 0.5 * scale * shared[k].dot(&with_nu[k]);
            by_rate[k] = by_v;
            by_place[k] = by_v.cross(&at.omega);
            out.omega += moved.place[k].cross(&by_v);
            if k < NODES {
                momentum += own[k] * weights[0];
            }
        }
        by_weight[0] -= 0.5 * scale * element.area * nu.norm_squared();
        for (by, second) in by_weight.iter_mut().zip(&element.second) {
            *by += 0.5 * scale * (spin * spin * second).trace();
        }
        out.omega -= axial(&(spin * second(element, weights))) * scale;
        pull_per_area(finite, i, by_weight, cot);
        scatter(element, &motion_transpose(element, &by_place), &mut out.q);
        scatter(element, &motion_transpose(element, &by_rate), &mut out.rate);
    }
    out.theta = momentum.cross(nu) * scale;
    let of_parts = parts::pull_kinetic(finite, at, (nu, scale), cot, &mut out);
    (out, at.rotation * momentum * scale + of_parts)
}

/// Static moment of the deformed body about the frame's origin, axes of the frame \[kg m\].
pub fn first_moment<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> Vec3<S> {
    let elements = finite.mesh.elements.iter().enumerate();
    elements.fold(parts::first_moment(finite, q), |sum, (i, element)| {
        let places = share(element, &points(element, &gather(element, q)));
        let own = places[..NODES].iter();
        sum + own.fold(Vec3::zeros(), |sum: Vec3<S>, p| sum + p) * per_area(finite, i)[0]
    })
}

/// Pulls w · d/ds Σ (moment) back, with the moment taken at q with the undeformed places if `placed`:
/// derivatives by q are added to `by_q`, by the parameters to `cot`.
pub fn pull_first_moment(
    finite: &FiniteElements<f64>,
    (q, placed): (&[f64], bool),
    w: &Vec3<f64>,
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let local = gather(element, q);
        let at = match placed {
            true => points(element, &local),
            false => motion(element, &local),
        };
        let mut by = [Vec3::zeros(); POINTS];
        by[..NODES].fill(*w);
        let by = share(element, &by);
        let along: f64 = (0..NODES).map(|k| by[k].dot(&at[k])).sum();
        pull_per_area(finite, i, [along, 0.0], cot);
        let weights = per_area(finite, i);
        let mut by = by.map(|by| by * weights[0]);
        by[NODES..].fill(Vec3::zeros());
        scatter(element, &motion_transpose(element, &by), by_q);
    }
    parts::pull_first_moment(finite, (q, placed), w, by_q, cot);
}

/// The diagonal of the mass matrix of the coordinates.
pub fn weights<S: Scalar>(finite: &FiniteElements<S>) -> Vec<S> {
    let mut out = vec![S::zero(); finite.mesh.coordinates];
    for (i, element) in finite.mesh.elements.iter().enumerate() {
        let weights = per_area(finite, i);
        for (coordinate, (point, along)) in element.coordinates.iter().zip(&element.moves) {
            if let Some(j) = coordinate {
                let a = point % NODES;
                let square = along.norm_squared() * element.shares[a][a];
                out[*j] += weights[point / NODES] * square;
            }
        }
    }
    parts::add_weights(finite, &mut out);
    out
}
