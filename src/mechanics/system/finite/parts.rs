//! Beams and lumped masses among the elements of a body: each is a body of shapes with few coordinates (see
//! [`crate::system::flexing`] and [`crate::system::strains`]), which are coordinates of the whole.

use crate::linalg::Emit;
use crate::math::{Mat3, Scalar, Vec3};
use crate::model::finite::{FiniteElements, Part};
use crate::model::shapes::Quadratic;
use crate::system::flexing::{
    self, Block, Flexing, FlexingCotangent, Generalised, Moving, static_moment,
};
use crate::system::strains;

/// The coordinates of a part.
pub(super) fn gather<S: Scalar>(coordinates: &[usize], q: &[S]) -> Vec<S> {
    coordinates.iter().map(|&i| q[i]).collect()
}

/// Transpose of [`gather`].
pub(super) fn scatter<S: Scalar>(coordinates: &[usize], x: &[S], out: &mut [S]) {
    for (&i, &x) in coordinates.iter().zip(x) {
        out[i] += x;
    }
}

/// The parts with their coordinates.
pub(super) fn all<S: Scalar>(
    finite: &FiniteElements<S>,
) -> impl Iterator<Item = (&Part<S>, &[usize])> {
    let coordinates = finite.mesh.parts.iter().map(Vec::as_slice);
    finite.parts.iter().zip(coordinates)
}

/// A value of each strain of the beams along their axes, by the strain and the coordinates of its part.
pub fn of_axial_strains<S: Scalar, T>(
    finite: &FiniteElements<S>,
    q: &[S],
    of: impl Fn(&Quadratic<S>, &[S]) -> T,
) -> Vec<T> {
    let mut out = Vec::new();
    for (part, coordinates) in all(finite) {
        let own = gather(coordinates, q);
        let along = part.stiffness.strains.iter().filter(|own| own.axial);
        out.extend(along.map(|along| of(&along.strain, &own)));
    }
    out
}

/// The motion of a part.
fn own_motion<S: Scalar>(coordinates: &[usize], at: &Flexing<S>) -> Flexing<S> {
    Flexing {
        q: gather(coordinates, &at.q),
        rate: gather(coordinates, &at.rate),
        acceleration: gather(coordinates, &at.acceleration),
        ..*at
    }
}

/// Adds the inertial forces.
pub(super) fn add_inertial<S: Scalar>(
    finite: &FiniteElements<S>,
    at: &Flexing<S>,
    out: &mut Generalised<S>,
) {
    for (part, coordinates) in all(finite) {
        let forces = flexing::inertial(&part.inertia, &own_motion(coordinates, at));
        out.linear += forces.linear;
        out.angular += forces.angular;
        scatter(coordinates, &forces.elastic, &mut out.elastic);
    }
}

/// Adds the pull-back of a cotangent of the inertial forces through the parts.
pub(super) fn pull_back(
    finite: &FiniteElements<f64>,
    at: &Flexing<f64>,
    psi: &Generalised<f64>,
    cot: &mut FiniteElements<f64>,
    out: &mut FlexingCotangent<f64>,
) {
    for ((part, coordinates), cot) in all(finite).zip(&mut cot.parts) {
        let own = Generalised {
            linear: psi.linear,
            angular: psi.angular,
            elastic: gather(coordinates, &psi.elastic),
        };
        let at = own_motion(coordinates, at);
        let by = flexing::pull_back(&part.inertia, &at, &own, &mut cot.inertia);
        add_cotangent(coordinates, &by, out);
    }
}

fn add_cotangent(
    coordinates: &[usize],
    by: &FlexingCotangent<f64>,
    out: &mut FlexingCotangent<f64>,
) {
    out.theta += by.theta;
    out.omega += by.omega;
    out.gravity += by.gravity;
    scatter(coordinates, &by.q, &mut out.q);
    scatter(coordinates, &by.rate, &mut out.rate);
}

/// Adds kinetic energy and momenta.
pub(super) fn add_moving<S: Scalar>(
    finite: &FiniteElements<S>,
    at: &Flexing<S>,
    nu: &Vec3<S>,
    out: &mut Moving<S>,
) {
    for (part, coordinates) in all(finite) {
        let own = flexing::moving(&part.inertia, &own_motion(coordinates, at), nu);
        out.kinetic += own.kinetic;
        out.momentum += own.momentum;
        out.spin += own.spin;
    }
}

/// Adds the pull-back of a cotangent `scale` of the kinetic energy through the parts; returns that
/// by the velocity of the frame's origin.
pub(super) fn pull_kinetic(
    finite: &FiniteElements<f64>,
    at: &Flexing<f64>,
    (nu, scale): (&Vec3<f64>, f64),
    cot: &mut FiniteElements<f64>,
    out: &mut FlexingCotangent<f64>,
) -> Vec3<f64> {
    let mut velocity = Vec3::zeros();
    for ((part, coordinates), cot) in all(finite).zip(&mut cot.parts) {
        let at = own_motion(coordinates, at);
        let (by, own) = flexing::pull_kinetic(&part.inertia, &at, nu, scale, &mut cot.inertia);
        add_cotangent(coordinates, &by, out);
        velocity += own;
    }
    velocity
}

/// The static moment of the deformed parts \[kg m\].
pub(super) fn first_moment<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> Vec3<S> {
    all(finite).fold(Vec3::zeros(), |sum, (part, coordinates)| {
        sum + static_moment(&part.inertia, S::one(), &gather(coordinates, q))
    })
}

/// Pulls w · [`first_moment`] back, of the deformed places if `placed`, else of displacements `q` alone.
pub(super) fn pull_first_moment(
    finite: &FiniteElements<f64>,
    (q, placed): (&[f64], bool),
    w: &Vec3<f64>,
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    for ((part, coordinates), cot) in all(finite).zip(&mut cot.parts) {
        if placed {
            cot.inertia.centre += w;
        }
        let moments = part.inertia.static_moments.iter();
        let both = moments.zip(&mut cot.inertia.static_moments);
        for ((p, by_p), &i) in both.zip(coordinates) {
            by_q[i] += w.dot(p);
            *by_p += w * q[i];
        }
    }
}

/// Adds the diagonal of the mass matrix of the coordinates.
pub(super) fn add_weights<S: Scalar>(finite: &FiniteElements<S>, out: &mut [S]) {
    for (part, coordinates) in all(finite) {
        scatter(coordinates, &own_weights(part), out);
    }
}

fn own_weights<S: Scalar>(part: &Part<S>) -> Vec<S> {
    let inertia = &part.inertia;
    let trace = |i: usize| inertia.products[inertia.place(i, i).0].trace();
    (0..inertia.static_moments.len()).map(trace).collect()
}

/// Adds the strain energy \[J\].
pub(super) fn energy<S: Scalar>(finite: &FiniteElements<S>, q: &[S]) -> S {
    all(finite).fold(S::zero(), |sum, (part, coordinates)| {
        sum + strains::energy(&part.stiffness, &gather(coordinates, q))
    })
}

/// Adds the cotangents of the strain energy by the parameters, times `scale`.
pub(super) fn pull_energy(
    finite: &FiniteElements<f64>,
    (q, scale): (&[f64], f64),
    cot: &mut FiniteElements<f64>,
) {
    for ((part, coordinates), cot) in all(finite).zip(&mut cot.parts) {
        let own = gather(coordinates, q);
        let mut unused = vec![0.0; own.len()];
        strains::pull_energy(
            &part.stiffness,
            &own,
            scale,
            &mut unused,
            &mut cot.stiffness,
        );
    }
}

/// Adds ∂U/∂q.
pub(super) fn add_forces<S: Scalar>(finite: &FiniteElements<S>, q: &[S], out: &mut [S]) {
    for (part, coordinates) in all(finite) {
        let own = gather(coordinates, q);
        let mut force = vec![S::zero(); own.len()];
        strains::add_forces(&part.stiffness, &own, &mut force);
        scatter(coordinates, &force, out);
    }
}

/// Pulls the cotangent ψ of [`add_forces`] back.
pub(super) fn pull_forces(
    finite: &FiniteElements<f64>,
    (q, psi): (&[f64], &[f64]),
    by_q: &mut [f64],
    cot: &mut FiniteElements<f64>,
) {
    for ((part, coordinates), cot) in all(finite).zip(&mut cot.parts) {
        let (own, psi) = (gather(coordinates, q), gather(coordinates, psi));
        let mut by = vec![0.0; own.len()];
        strains::pull_forces(&part.stiffness, (&own, &psi), &mut by, &mut cot.stiffness);
        scatter(coordinates, &by, by_q);
    }
}

/// The tangent stiffness of a part, by rows of its coordinates.
pub fn part_tangent<S: Scalar>(part: &Part<S>, q: &[S]) -> Vec<S> {
    let mut block = Block::zero(q.len());
    strains::add_jacobian(&part.stiffness, q, &mut block);
    let rows = block.entries.chunks_exact(block.order).skip(6);
    rows.flat_map(|row| row[6..].iter().copied()).collect()
}

/// lᵀ A r, where A are the derivatives of elastic and viscous forces by coordinates, and by their rates.
pub(super) fn strain_products<S: Scalar>(
    finite: &FiniteElements<S>,
    (q, rate): (&[S], &[S]),
    pair: [&[S]; 2],
) -> [S; 2] {
    let beta = finite.damping.map_or(S::zero(), |[_, beta]| beta);
    let mut sums = [S::zero(); 2];
    for (part, coordinates) in all(finite) {
        let [q, rate] = [q, rate].map(|x| gather(coordinates, x));
        let [l, r] = pair.map(|x| gather(coordinates, x));
        let [elastic, turned, viscous] = strains::products(&part.stiffness, (&q, &rate), [&l, &r]);
        sums[0] += elastic + beta * turned;
        sums[1] += beta * viscous;
    }
    sums
}

/// Places of the frame and of the coordinates of a part.
fn own_slots(slots: &[usize], coordinates: &[usize]) -> Vec<usize> {
    let elastic = coordinates.iter().map(|i| slots[6 + i]);
    slots[..6].iter().copied().chain(elastic).collect()
}

/// Emits the mass matrices.
pub(super) fn emit_mass<S: Scalar>(
    finite: &FiniteElements<S>,
    (rotation, q): (&Mat3<S>, &[S]),
    slots: &[usize],
    at: (usize, usize),
    scale: S,
    emit: &mut dyn Emit<S>,
) {
    for (part, coordinates) in all(finite) {
        let block = flexing::mass(&part.inertia, rotation, &gather(coordinates, q));
        block.emit(&own_slots(slots, coordinates), at, scale, emit);
    }
}

/// Emits the entries of a diagonal that are left, and takes them from it.
pub(super) fn emit_diagonal<S: Scalar>(
    finite: &FiniteElements<S>,
    slots: &[usize],
    left: &mut [S],
    emit: &mut dyn Emit<S>,
) {
    for (_, coordinates) in all(finite) {
        let mut block = Block::zero(coordinates.len());
        for (k, &i) in coordinates.iter().enumerate() {
            block.add(6 + k, 6 + k, std::mem::replace(&mut left[i], S::zero()));
        }
        let slots = own_slots(slots, coordinates);
        block.emit(&slots, (0, 0), S::one(), emit);
    }
}

/// Emits the derivatives of inertial, elastic and viscous forces.
pub(super) fn emit_jacobian<S: Scalar>(
    finite: &FiniteElements<S>,
    at: &Flexing<S>,
    slots: &[usize],
    (row, y, v): (usize, usize, usize),
    (by_y, by_v): (S, S),
    emit: &mut dyn Emit<S>,
) {
    for (part, coordinates) in all(finite) {
        let at = own_motion(coordinates, at);
        let (mut in_y, mut in_v) = flexing::jacobian(&part.inertia, &at);
        strains::add_jacobian(&part.stiffness, &at.q, &mut in_y);
        if let Some([alpha, beta]) = finite.damping {
            let blocks = (&mut in_y, &mut in_v);
            strains::add_viscous_jacobian(&part.stiffness, (&at.q, &at.rate), beta, blocks);
            let inertia = &part.inertia;
            for i in 0..at.q.len() {
                for j in 0..at.q.len() {
                    let mass = inertia.products[inertia.place(i, j).0].trace();
                    in_v.add(6 + i, 6 + j, alpha * mass);
                }
            }
        }
        let slots = own_slots(slots, coordinates);
        in_y.emit(&slots, (row, y), by_y, emit);
        in_v.emit(&slots, (row, v), by_v, emit);
    }
}

/// Adds α M q̇ of the coordinates of the parts, for α = 1.
pub(super) fn add_heavy<S: Scalar>(finite: &FiniteElements<S>, rate: &[S], out: &mut [S]) {
    for (part, coordinates) in all(finite) {
        let (inertia, rate) = (&part.inertia, gather(coordinates, rate));
        let row = |i: usize| {
            let all = rate.iter().enumerate();
            all.fold(S::zero(), |sum, (j, &x)| {
                sum + inertia.products[inertia.place(i, j).0].trace() * x
            })
        };
        let force: Vec<S> = (0..rate.len()).map(row).collect();
        scatter(coordinates, &force, out);
    }
}

/// Adds the cotangents of `alpha` times ψ · [`add_heavy`] by the parameters.
pub(super) fn pull_heavy(
    finite: &FiniteElements<f64>,
    (rate, psi): (&[f64], &[f64]),
    alpha: f64,
    cot: &mut FiniteElements<f64>,
) {
    for (cot, coordinates) in cot.parts.iter_mut().zip(&finite.mesh.parts) {
        let (rate, psi) = (gather(coordinates, rate), gather(coordinates, psi));
        for (i, psi) in psi.iter().enumerate() {
            for (j, rate) in rate.iter().enumerate() {
                let place = cot.inertia.place(i, j).0;
                for d in 0..3 {
                    cot.inertia.products[place][(d, d)] += alpha * psi * rate;
                }
            }
        }
    }
}

/// Adds K q̇ + Σ k_p ∇e_p ė_p.
pub(super) fn add_viscous<S: Scalar>(
    finite: &FiniteElements<S>,
    (q, rate): (&[S], &[S]),
    out: &mut [S],
) {
    for (part, coordinates) in all(finite) {
        let (q, rate) = (gather(coordinates, q), gather(coordinates, rate));
        let mut force = vec![S::zero(); q.len()];
        strains::add_viscous(&part.stiffness, &q, &rate, &mut force);
        scatter(coordinates, &force, out);
    }
}

/// Pulls `beta` times ψ · [`add_viscous`] back.
pub(super) fn pull_viscous(
    finite: &FiniteElements<f64>,
    (q, rate, psi): (&[f64], &[f64], &[f64]),
    beta: f64,
    (by_q, by_rate): (&mut [f64], &mut [f64]),
    cot: &mut FiniteElements<f64>,
) {
    for ((part, coordinates), cot) in all(finite).zip(&mut cot.parts) {
        let [q, rate, psi] = [q, rate, psi].map(|x| gather(coordinates, x));
        let (mut in_q, mut in_rate) = (vec![0.0; q.len()], vec![0.0; q.len()]);
        let by = (&mut in_q[..], &mut in_rate[..]);
        strains::pull_viscous(
            &part.stiffness,
            (&q, &rate, &psi),
            beta,
            by,
            &mut cot.stiffness,
        );
        scatter(coordinates, &in_q, by_q);
        scatter(coordinates, &in_rate, by_rate);
    }
}
