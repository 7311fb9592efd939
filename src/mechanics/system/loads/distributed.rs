//! Pressures and dead loads on the elements of flexible bodies.
//!
//! With virtual velocities φ of the frame (its axes), t its angular and e_a those of the nodes, node a has the virtual
//! velocity w_a = φ + t × x_a + e_a, and a load the power Σ w_a · f_a ([`crate::model::distributed`]). A pressure is
//! integrated at the Gauss points of the shells. In a reduced basis the nodes stand where the coordinates put them, and
//! the forces on the coordinates are those of the nodes through the basis.

use super::{LoadCotangent, LoadEntries};
use crate::linalg::Emit;
use crate::math::{Mat3, Scalar, Vec3, scalar::lift3};
use crate::model::distributed::{DistributedLoad, Spread};
use crate::model::finite::{ElementMesh, FiniteElements};
use crate::model::flexible::FlexibleBody;
use crate::model::reduced::NodalBasis;
use crate::model::{Axes, LoadKind};
use crate::structures::shell::basis::{GAUSS_POINTS, Tables};
use crate::structures::shell::{ShellKind, ShellNodes};
use crate::system::flexible::{add_coordinates, add_unknown, basis_of, coordinates, unknown_of};
use crate::system::in_motion::InMotion;

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
    /// m(t).
    size: S,
}

/// Nodes that carry a part of a load together: those of a shell, or one.
struct Patch<'a, S> {
    nodes: &'a [usize],
    /// Their places in the axes of the frame.
    x: Vec<Vec3<S>>,
    /// Forces on them at m = 1, axes of the frame.
    unit: Vec<Vec3<S>>,
    /// x,r and x,s at the Gauss points, of a pressure.
    tangents: Option<Tangents<S>>,
    /// s_a of a dead load.
    share: f64,
}

/// x,r and x,s at the Gauss points of a shell, and the shape functions there.
type Tangents<S> = ([[Vec3<S>; 2]; GAUSS_POINTS], &'static Tables);

/// Virtual velocities in the axes of the frame.
struct Virtual<'a, S> {
    linear: Vec3<S>,
    angular: Vec3<S>,
    nodes: &'a [Vec3<S>],
}

/// Derivatives of the power of a patch.
struct Pulled<S> {
    /// In the rotation of the frame.
    theta: Vec3<S>,
    /// In the places of the nodes.
    nodes: Vec<Vec3<S>>,
    /// In m and in n.
    magnitude: S,
    direction: Vec3<S>,
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
    Some(Acting {
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

/// A shell under a pressure of one, whose nodes are at `x`.
fn pressed<S: Scalar>(nodes: &ShellNodes, x: Vec<Vec3<S>>) -> Patch<'_, S> {
    let tables = ShellKind::of(nodes).tables();
    let mut unit = vec![Vec3::zeros(); nodes.len()];
    let mut tangents = [[Vec3::zeros(); 2]; GAUSS_POINTS];
    for (g, (basis, own)) in tables.gauss.iter().zip(&mut tangents).enumerate() {
        for (along, by) in own.iter_mut().zip(&basis.by) {
            for (x, &slope) in x.iter().zip(by) {
                *along += x * S::from(slope);
            }
        }
        let normal = own[0].cross(&own[1]) * S::from(tables.weights[g]);
        for (unit, &n) in unit.iter_mut().zip(&basis.n) {
            *unit += normal * S::from(n);
        }
    }
    Patch {
        nodes,
        x,
        unit,
        tangents: Some((tangents, tables)),
        share: 0.0,
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
    /// Component `k` of the displacement of a node.
    fn displacement(&self, node: usize, k: usize) -> S {
        let Some(unknown) = self.finite.mesh.displacements[node][k] else {
            return S::zero();
        };
        unknown_of(self.basis, unknown, &self.q)
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
        let own = lift3::<S>(&self.finite.mesh.nodes[node]);
        own + Vec3::from_fn(|k, _| self.displacement(node, k))
    }

    /// Calls `visit` for every patch of the load.
    fn for_each_patch(&self, mut visit: impl FnMut(&Patch<S>)) {
        match &self.load.spread {
            Spread::Pressure { shells } => {
                for &shell in shells.iter() {
                    let nodes = &self.finite.mesh.elements[shell].nodes;
                    let places = nodes.iter().map(|&node| self.place(node));
                    visit(&pressed(nodes, places.collect()));
                }
            }
            Spread::Dead {
                shares,
                direction,
                axes,
            } => {
                let along = match axes {
                    Axes::Ground => self.rotation.tr_mul(direction),
                    Axes::Body => *direction,
                };
                for (node, share) in shares.iter() {
                    visit(&Patch {
                        nodes: std::slice::from_ref(node),
                        x: vec![self.place(*node)],
                        unit: vec![along * S::from(*share)],
                        tangents: None,
                        share: *share,
                    });
                }
            }
        }
    }

    /// Derivatives of the power of a patch, the virtual velocities held.
    fn pull(&self, patch: &Patch<S>, psi: &Virtual<S>) -> Pulled<S> {
        let (size, t) = (self.size, &psi.angular);
        let mut out = Pulled {
            theta: Vec3::zeros(),
            nodes: Vec::with_capacity(patch.nodes.len()),
            magnitude: S::zero(),
            direction: Vec3::zeros(),
        };
        let mut velocities = Vec::with_capacity(patch.nodes.len());
        for ((x, unit), e) in patch.x.iter().zip(&patch.unit).zip(psi.nodes) {
            let (force, own) = (unit * size, t.cross(x) + e);
            let w = psi.linear + own;
            out.magnitude += w.dot(unit);
            out.nodes.push(force.cross(t));
            let share = size * patch.share;
            match &self.load.spread {
                Spread::Dead {
                    axes: Axes::Ground, ..
                } => {
                    out.theta += own.cross(&force);
                    out.direction += self.rotation * w * share;
                }
                Spread::Dead {
                    axes: Axes::Body, ..
                } => {
                    out.theta += force.cross(&psi.linear);
                    out.direction += w * share;
                }
                Spread::Pressure { .. } => out.theta += force.cross(&psi.linear),
            }
            velocities.push(w);
        }
        let Some((tangents, tables)) = &patch.tangents else {
            return out;
        };
        for (g, ([along_r, along_s], basis)) in tangents.iter().zip(&tables.gauss).enumerate() {
            let mut w = Vec3::zeros();
            for (own, &n) in velocities.iter().zip(&basis.n) {
                w += own * S::from(n);
            }
            let by_normal = w * (size * tables.weights[g]);
            let by = [along_s.cross(&by_normal), by_normal.cross(along_r)];
            for (a, node) in out.nodes.iter_mut().enumerate() {
                *node += by[0] * S::from(basis.by[0][a]) + by[1] * S::from(basis.by[1][a]);
            }
        }
        out
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

    /// The velocities of the body.
    fn velocities(&self, here: &InMotion<S>) -> Generalised<S> {
        let frame = &here.motions[self.body.frame];
        let rates = self.body.places();
        Generalised {
            linear: frame.velocity,
            angular: frame.omega,
            elastic: rates
                .map(|(carrier, k)| here.motions[carrier].velocity[k])
                .collect(),
        }
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

/// Adds the forces on frames (force in ground axes, torque in body axes about the origin) and on elastic coordinates.
pub(super) fn add_forces<S: Scalar>(here: &InMotion<S>, out: &mut [S]) {
    for_each(here, |_, acting| {
        acting.forces().add_to(here, acting.body, out)
    });
}

/// The power of a load; `None` if it is not spread over elements.
pub(super) fn power<S: Scalar>(here: &InMotion<S>, load: usize) -> Option<S> {
    let acting = acting(here, load)?;
    Some(acting.forces().dot(&acting.velocities(here)))
}

/// Adds `weight` times the derivative of [`power`] to tangent positions, velocities, time and parameters.
pub(super) fn pull_power(here: &InMotion<f64>, load: usize, weight: f64, out: &mut LoadCotangent) {
    let Some(acting) = acting(here, load) else {
        return;
    };
    // The power is linear in the velocities that the forces are weighed with.
    acting.pull_forces(here, load, acting.velocities(here).times(weight), out);
    if let Some(v) = out.v.as_deref_mut() {
        acting.forces().times(weight).add_to(here, acting.body, v);
    }
}

/// Emits the derivatives of [`add_forces`] in tangent positions; those in velocities vanish.
pub(super) fn emit_jacobian<S: Scalar>(
    here: &InMotion<S>,
    to: &LoadEntries<S>,
    emit: &mut dyn Emit<S>,
) {
    for_each(here, |_, acting| {
        let frame = here.numbering.velocity(acting.body.frame);
        let elastic = acting.body.places();
        let elastic = elastic.map(|(carrier, k)| here.numbering.velocity(carrier) + k);
        let slots: Vec<usize> = (frame..frame + 6).chain(elastic).collect();
        let columns: Vec<usize> = slots[3..].iter().map(|slot| to.y + slot).collect();
        let m = acting.q.len();
        let mut of_basis = acting.basis.map(|_| vec![S::zero(); (6 + m) * (3 + m)]);
        acting.for_each_patch(|patch| {
            let still = vec![Vec3::zeros(); patch.nodes.len()];
            for row in 0..6 + 3 * patch.nodes.len() {
                let (mut parts, mut nodes) = ([Vec3::zeros(); 2], still.clone());
                match row.checked_sub(6) {
                    None => parts[row / 3][row % 3] = S::one(),
                    Some(own) => nodes[own / 3][own % 3] = S::one(),
                }
                let psi = Virtual {
                    linear: acting.rotation.tr_mul(&parts[0]),
                    angular: parts[1],
                    nodes: &nodes,
                };
                let by = acting.pull(patch, &psi);
                let unknown =
                    |own: usize| acting.finite.mesh.displacements[patch.nodes[own / 3]][own % 3];
                match &mut of_basis {
                    None => {
                        let slot = match row.checked_sub(6) {
                            None => Some(slots[row]),
                            Some(own) => unknown(own).map(|i| slots[6 + i]),
                        };
                        let Some(slot) = slot else { continue };
                        for k in 0..3 {
                            emit.add(to.row + slot, columns[k], by.theta[k] * to.by_y);
                        }
                        for (own, x) in by.nodes.iter().flat_map(|x| x.iter()).enumerate() {
                            if let Some(i) = unknown(own) {
                                emit.add(to.row + slot, columns[3 + i], *x * to.by_y);
                            }
                        }
                    }
                    Some(sum) => {
                        let mut of_row: Vec<S> = by.theta.iter().copied().collect();
                        of_row.resize(3 + m, S::zero());
                        for (&node, x) in patch.nodes.iter().zip(&by.nodes) {
                            acting.add_force(node, x, &mut of_row[3..]);
                        }
                        let mut add = |i: usize, factor: S| {
                            let to = &mut sum[i * (3 + m)..(i + 1) * (3 + m)];
                            crate::math::slices::add_scaled(to, factor, &of_row);
                        };
                        match row.checked_sub(6) {
                            None => add(row, S::one()),
                            Some(own) => {
                                let vectors = acting.basis.into_iter();
                                let vectors = vectors.flat_map(|basis| &basis.vectors);
                                if let Some(unknown) = unknown(own) {
                                    for (i, vector) in vectors.enumerate() {
                                        add(6 + i, vector[unknown].into());
                                    }
                                }
                            }
                        }
                    }
                }
            }
        });
        if let Some(sum) = of_basis {
            let rows: Vec<usize> = slots.iter().map(|slot| to.row + slot).collect();
            emit.add_dense(&rows, &columns, to.by_y, &sum);
        }
    });
}

/// Pulls the cotangent ψ of [`add_forces`] back to tangent positions, time and parameters.
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
    /// Pulls the cotangent ψ of the forces of load `i` back to tangent positions, time and parameters.
    fn pull_forces(
        &self,
        here: &InMotion<f64>,
        i: usize,
        psi: Generalised<f64>,
        out: &mut LoadCotangent,
    ) {
        // The virtual displacements of the nodes are those of the coordinates ψ.
        let virtually = Acting {
            q: psi.elastic,
            ..*self
        };
        let mut by_q = vec![0.0; self.q.len()];
        let (mut theta, mut by_size, mut by_direction) = (Vec3::zeros(), 0.0, Vec3::zeros());
        self.for_each_patch(|patch| {
            let of = |&node: &usize| Vec3::from_fn(|k, _| virtually.displacement(node, k));
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
        let LoadKind::Distributed(own) = &mut out.model.loads[i].kind else {
            unreachable!("a cotangent has the kind of its load");
        };
        match &mut own.spread {
            Spread::Pressure { .. } => {}
            Spread::Dead { direction, .. } => *direction += by_direction,
        }
        let magnitude = &self.load.magnitude;
        *out.time += magnitude.pull_back(here.time, [by_size, 0.0, 0.0], &mut own.magnitude);
    }
}
