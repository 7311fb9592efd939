//! Pressures, dead loads and drag on the elements of flexible bodies.
//!
//! With virtual velocities φ of the frame (its axes), t its angular and e_a those of the nodes, node a has the virtual
//! velocity w_a = φ + t × x_a + e_a, and a load the power Σ w_a · f_a ([`crate::model::distributed`]). A pressure is
//! integrated at the Gauss points of the shells, and so is [`air`], which depends on the velocities of the nodes too. `patch.rs` has the
//! forces of a piece of the body and their derivatives, `jacobian.rs` their matrix. In a reduced basis the nodes stand where the coordinates put them, and
//! the forces on the coordinates are those of the nodes through the basis.

mod air;
mod jacobian;
mod patch;

use super::LoadCotangent;
use crate::math::{Mat3, Scalar, Vec3, scalar::lift3};
use crate::model::LoadKind;
use crate::model::distributed::{DistributedLoad, Spread};
use crate::model::finite::{ElementMesh, FiniteElements};
use crate::model::flexible::FlexibleBody;
use crate::model::reduced::NodalBasis;
use crate::system::flexible::{add_coordinates, add_unknown, basis_of, coordinates, unknown_of};
use crate::system::in_motion::InMotion;
use patch::{Virtual, pressed};

pub(super) use jacobian::emit_jacobian;

/// A load on a flexible body at an instant.
struct Acting<'a, S> {
    load: &'a DistributedLoad<S>,
    body: &'a FlexibleBody<S>,
    finite: &'a FiniteElements<S>,
    /// The vectors of a reduced basis.
    basis: Option<&'a NodalBasis>,
    /// From the axes of the frame to ground.
    rotation: Mat3<S>,
    q: Vec<S>,
    /// The velocities of the body, if the load depends on them.
    moving: Option<Generalised<S>>,
    /// m(t).
    size: S,
}

/// Load `i` as it acts; `None` if it is not spread over elements.
fn acting<'a, S: Scalar>(here: &InMotion<'a, S>, i: usize) -> Option<Acting<'a, S>> {
    let LoadKind::Distributed(load) = &here.model.loads[i].kind else {
        return None;
    };
    let mut bodies = here.model.flexible.iter();
    let body = bodies.find(|own| own.frame == load.body);
    let found = body.and_then(|body| Some((body, body.form.shells()?)));
    let (body, finite) = found.expect("a distributed load acts on a body of elements");
    let moving = match load.spread {
        Spread::Air { .. } => Some(velocities(here, body)),
        Spread::Pressure { .. } | Spread::Dead { .. } => None,
    };
    Some(Acting {
        moving,
        load,
        body,
        finite,
        basis: basis_of(body),
        rotation: here.motions[load.body].rotation,
        q: coordinates(body, here.motions),
        size: load.magnitude.value(here.time),
    })
}

/// Calls `visit(number of the load, the load)` for every distributed load.
fn for_each<S: Scalar>(here: &InMotion<S>, mut visit: impl FnMut(usize, &Acting<S>)) {
    for i in 0..here.model.loads.len() {
        if let Some(acting) = acting(here, i) {
            visit(i, &acting);
        }
    }
}

/// ∫ N_a x,r × x,s dr ds of the nodes of undeformed shells \[m²\].
pub fn normal_shares(mesh: &ElementMesh, shells: &[usize]) -> Vec<(usize, Vec3<f64>)> {
    let mut all = Vec::new();
    for &shell in shells {
        let nodes = &mesh.elements[shell].nodes;
        let places = nodes.iter().map(|&node| mesh.nodes[node]);
        let unit = pressed(nodes, places.collect()).unit;
        all.extend(nodes.iter().copied().zip(unit));
    }
    all
}

impl<S: Scalar> Acting<'_, S> {
    /// What a node has of values of the coordinates: of q its displacement.
    fn at_node(&self, node: usize, coordinates: &[S]) -> Vec3<S> {
        Vec3::from_fn(|k, _| match self.finite.mesh.displacements[node][k] {
            Some(unknown) => unknown_of(self.basis, unknown, coordinates),
            None => S::zero(),
        })
    }

    /// Adds a force on a node to those on the coordinates.
    fn add_force(&self, node: usize, force: &Vec3<S>, out: &mut [S]) {
        for (k, unknown) in self.finite.mesh.displacements[node].iter().enumerate() {
            if let Some(unknown) = *unknown {
                add_unknown(self.basis, unknown, force[k], out);
            }
        }
    }

    /// Where a node is.
    fn place(&self, node: usize) -> Vec3<S> {
        lift3::<S>(&self.finite.mesh.nodes[node]) + self.at_node(node, &self.q)
    }

    /// The velocity of a node at x as seen from ground, in the axes of the frame.
    fn velocity(&self, node: usize, x: &Vec3<S>) -> Vec3<S> {
        let Some(moving) = &self.moving else {
            return Vec3::zeros();
        };
        let own = moving.angular.cross(x) + self.at_node(node, &moving.elastic);
        self.rotation.tr_mul(&moving.linear) + own
    }
}

/// Forces on the frame of a body, force in ground axes and torque in body axes about the origin, and on its
/// coordinates; or velocities that these have.
struct Generalised<S> {
    linear: Vec3<S>,
    angular: Vec3<S>,
    elastic: Vec<S>,
}

impl<S: Scalar> Acting<'_, S> {
    /// The forces of the load.
    fn forces(&self) -> Generalised<S> {
        let (mut force, mut torque) = (Vec3::zeros(), Vec3::zeros());
        let mut elastic = vec![S::zero(); self.q.len()];
        self.for_each_patch(|patch| {
            for ((&node, x), unit) in patch.nodes.iter().zip(&patch.x).zip(&patch.unit) {
                let own = unit * self.size;
                force += own;
                torque += x.cross(&own);
                self.add_force(node, &own, &mut elastic);
            }
        });
        Generalised {
            linear: self.rotation * force,
            angular: torque,
            elastic,
        }
    }
}

/// The velocities of a body.
fn velocities<S: Scalar>(here: &InMotion<S>, body: &FlexibleBody<S>) -> Generalised<S> {
    let frame = &here.motions[body.frame];
    let rates = body.places();
    Generalised {
        linear: frame.velocity,
        angular: frame.omega,
        elastic: rates
            .map(|(carrier, k)| here.motions[carrier].velocity[k])
            .collect(),
    }
}

impl<S: Scalar> Generalised<S> {
    /// Adds these forces to those of the scene.
    fn add_to(&self, here: &InMotion<S>, body: &FlexibleBody<S>, out: &mut [S]) {
        let frame = here.numbering.velocity(body.frame);
        super::add6(&mut out[frame..], &self.linear, &self.angular);
        add_coordinates(here.numbering, body, &self.elastic, out);
    }

    fn dot(&self, other: &Self) -> S {
        let elastic = self.elastic.iter().zip(&other.elastic);
        let rigid = self.linear.dot(&other.linear) + self.angular.dot(&other.angular);
        elastic.fold(rigid, |sum, (x, y)| sum + *x * *y)
    }
}

impl Generalised<f64> {
    fn times(mut self, factor: f64) -> Self {
        self.linear *= factor;
        self.angular *= factor;
        self.elastic.iter_mut().for_each(|x| *x *= factor);
        self
    }
}

/// Adds those of the forces on frames and coordinates that may supply energy: all but those of air.
pub(super) fn add_supplying_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each(here, |_, acting| {
        if acting.load.spread.supplies() {
            acting.forces().add_to(here, acting.body, out);
        }
    });
}

/// Adds the forces on frames (force in ground axes, torque in body axes about the origin) and on elastic coordinates.
pub(super) fn add_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each(here, |_, acting| {
        acting.forces().add_to(here, acting.body, out)
    });
}

/// The power of a load; `None` if it is not spread over elements.
pub(super) fn power<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    let acting = acting(here, load)?;
    Some(acting.forces().dot(&velocities(here, acting.body)))
}

/// Adds `weight` times the derivative of [`power`] to tangent positions, velocities, time and parameters.
pub(super) fn pull_power(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    let Some(acting) = acting(here, load) else {
        return;
    };
    // The power is linear in the velocities that the forces are weighed with.
    acting.pull_forces(here, load, velocities(here, acting.body).times(weight), out);
    if let Some(v) = out.v.as_deref_mut() {
        acting.forces().times(weight).add_to(here, acting.body, v);
    }
}

/// Pulls the cotangent ψ of [`add_forces`] back to tangent positions, velocities, time and parameters.
pub(super) fn pull_back(here: &InMotion<f64>, psi: &[f64], out: &mut LoadCotangent) {
    let numbering = here.numbering;
    for_each(here, |i, acting| {
        let (linear, angular) = super::velocities_of(&psi[numbering.velocity(acting.body.frame)..]);
        let places = acting.body.places();
        let psi = Generalised {
            linear,
            angular,
            elastic: places
                .map(|(carrier, k)| psi[numbering.velocity(carrier) + k])
                .collect(),
        };
        acting.pull_forces(here, i, psi, out);
    });
}

impl Acting<'_, f64> {
    /// Pulls the cotangent ψ of the forces of load `i` back to tangent positions, velocities, time and parameters.
    fn pull_forces(
        &self,
        here: &InMotion<f64>,
        i: usize,
        psi: Generalised<f64>,
        out: &mut LoadCotangent,
    ) {
        let mut by_q = vec![0.0; self.q.len()];
        let (mut theta, mut by_size, mut by_direction) = (Vec3::zeros(), 0.0, Vec3::zeros());
        let mut by_air = [0.0; 3];
        let mut by_velocity = Generalised {
            linear: Vec3::zeros(),
            angular: Vec3::zeros(),
            elastic: by_q.clone(),
        };
        self.for_each_patch(|patch| {
            let of = |&node: &usize| self.at_node(node, &psi.elastic);
            let nodes: Vec<Vec3<f64>> = patch.nodes.iter().map(of).collect();
            let psi = Virtual {
                linear: self.rotation.tr_mul(&psi.linear),
                angular: psi.angular,
                nodes: &nodes,
            };
            let by = self.pull(patch, &psi);
            theta += by.theta;
            by_size += by.magnitude;
            by_direction += by.direction;
            for (sum, own) in by_air.iter_mut().zip(by.air) {
                *sum += own;
            }
            by_velocity.linear += self.rotation * by.linear;
            by_velocity.angular += by.angular;
            for (&node, x) in patch.nodes.iter().zip(&by.rates) {
                self.add_force(node, x, &mut by_velocity.elastic);
            }
            for (&node, x) in patch.nodes.iter().zip(&by.nodes) {
                self.add_force(node, x, &mut by_q);
            }
        });
        if let Some(y) = out.y.as_deref_mut() {
            let by = Generalised {
                linear: Vec3::zeros(),
                angular: theta,
                elastic: by_q,
            };
            by.add_to(here, self.body, y);
        }
        if let (Some(v), Some(_)) = (out.v.as_deref_mut(), &self.moving) {
            by_velocity.add_to(here, self.body, v);
        }
        let LoadKind::Distributed(own) = &mut out.model.loads[i].kind else {
            unreachable!("a cotangent has the kind of its load");
        };
        match &mut own.spread {
            Spread::Pressure { .. } => {}
            Spread::Dead { direction, .. } => *direction += by_direction,
            Spread::Air { air, .. } => {
                air.coefficient += by_air[0];
                air.normal_coefficient += by_air[1];
                air.width += by_air[2];
            }
        }
        let magnitude = &self.load.magnitude;
        *out.time += magnitude.pull_back(here.time, [by_size, 0.0, 0.0], &mut own.magnitude);
    }
}
