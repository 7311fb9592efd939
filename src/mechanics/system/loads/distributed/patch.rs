//! Pieces of a body that carry a load together: their forces and the derivatives of their power.

use super::{Acting, air};
use crate::math::{Scalar, Vec3};
use crate::model::Axes;
use crate::model::distributed::{Air, Spread};
use crate::structures::shell::basis::{GAUSS_POINTS, Tables};
use crate::structures::shell::{ShellKind, ShellNodes};

/// Nodes that carry a part of a load together: those of a shell, or one.
pub(super) struct Patch<'a, S> {
    pub nodes: &'a [usize],
    /// Their places in the axes of the frame.
    pub x: Vec<Vec3<S>>,
    /// Their velocities as seen from ground, in the axes of the frame, if the load depends on them.
    rates: Vec<Vec3<S>>,
    /// Forces on them at m = 1, axes of the frame.
    pub unit: Vec<Vec3<S>>,
    /// x,r and x,s at the Gauss points, of a pressure or of air.
    tangents: Option<Tangents<S>>,
    /// s_a of a dead load.
    share: f64,
}

/// x,r and x,s at the Gauss points of a shell, and the shape functions there.
type Tangents<S> = ([[Vec3<S>; 2]; GAUSS_POINTS], &'static Tables);

/// Virtual velocities in the axes of the frame.
pub(super) struct Virtual<'a, S> {
    pub linear: Vec3<S>,
    pub angular: Vec3<S>,
    pub nodes: &'a [Vec3<S>],
}

/// Derivatives of the power of a patch.
pub(super) struct Pulled<S> {
    /// In the rotation of the frame.
    pub theta: Vec3<S>,
    /// In the places of the nodes.
    pub nodes: Vec<Vec3<S>>,
    /// In the velocity of the frame, in its axes, and in its angular velocity.
    pub linear: Vec3<S>,
    pub angular: Vec3<S>,
    /// In the velocities of the nodes in the frame; none if the load does not depend on them.
    pub rates: Vec<Vec3<S>>,
    /// In m and in n.
    pub magnitude: S,
    pub direction: Vec3<S>,
    /// In the parameters of the air.
    pub air: [S; 3],
}

/// A shell under a pressure of one, whose nodes are at `x`.
pub(super) fn pressed<S: Scalar>(nodes: &ShellNodes, x: Vec<Vec3<S>>) -> Patch<'_, S> {
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
        rates: Vec::new(),
        unit,
        tangents: Some((tangents, tables)),
        share: 0.0,
    }
}

/// A shell whose nodes move with these velocities through the air.
fn blown<'a, S: Scalar>(
    air: &Air<S>,
    mut patch: Patch<'a, S>,
    rates: Vec<Vec3<S>>,
) -> Patch<'a, S> {
    patch.unit.iter_mut().for_each(|unit| *unit = Vec3::zeros());
    if let Some((tangents, tables)) = &patch.tangents {
        for (g, ([along_r, along_s], basis)) in tangents.iter().zip(&tables.gauss).enumerate() {
            let u = interpolated(&rates, &basis.n);
            let force = air::force(air, &along_r.cross(along_s), &u) * S::from(tables.weights[g]);
            for (unit, &n) in patch.unit.iter_mut().zip(&basis.n) {
                *unit += force * S::from(n);
            }
        }
    }
    patch.rates = rates;
    patch
}

/// Σ N_a x_a.
fn interpolated<S: Scalar>(nodes: &[Vec3<S>], shapes: &[f64]) -> Vec3<S> {
    let mut sum = Vec3::zeros();
    for (own, &n) in nodes.iter().zip(shapes) {
        sum += own * S::from(n);
    }
    sum
}

impl<S: Scalar> Acting<'_, S> {
    /// Calls `visit` for every patch of the load.
    pub(super) fn for_each_patch(&self, mut visit: impl FnMut(&Patch<S>)) {
        match &self.load.spread {
            Spread::Pressure { shells } => {
                for &shell in shells.iter() {
                    let nodes = &self.finite.mesh.elements[shell].nodes;
                    let places = nodes.iter().map(|&node| self.place(node));
                    visit(&pressed(nodes, places.collect()));
                }
            }
            Spread::Air { shells, air } => {
                for &shell in shells.iter() {
                    let nodes = &self.finite.mesh.elements[shell].nodes;
                    let x: Vec<Vec3<S>> = nodes.iter().map(|&node| self.place(node)).collect();
                    let rates = nodes.iter().zip(&x);
                    let rates = rates.map(|(&node, x)| self.velocity(node, x)).collect();
                    visit(&blown(air, pressed(nodes, x), rates));
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
                        rates: Vec::new(),
                        unit: vec![along * S::from(*share)],
                        tangents: None,
                        share: *share,
                    });
                }
            }
        }
    }

    /// Derivatives of the power of a patch, the virtual velocities held.
    pub(super) fn pull(&self, patch: &Patch<S>, psi: &Virtual<S>) -> Pulled<S> {
        let (size, t) = (self.size, &psi.angular);
        let mut out = Pulled {
            theta: Vec3::zeros(),
            nodes: Vec::with_capacity(patch.nodes.len()),
            linear: Vec3::zeros(),
            angular: Vec3::zeros(),
            rates: vec![Vec3::zeros(); patch.rates.len()],
            magnitude: S::zero(),
            direction: Vec3::zeros(),
            air: [S::zero(); 3],
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
                Spread::Pressure { .. } | Spread::Air { .. } => {
                    out.theta += force.cross(&psi.linear);
                }
            }
            velocities.push(w);
        }
        let Some((tangents, tables)) = &patch.tangents else {
            return out;
        };
        for (g, ([along_r, along_s], basis)) in tangents.iter().zip(&tables.gauss).enumerate() {
            let w = interpolated(&velocities, &basis.n);
            let weight = size * tables.weights[g];
            let by_normal = match &self.load.spread {
                Spread::Air { air, .. } => {
                    let area = along_r.cross(along_s);
                    let u = interpolated(&patch.rates, &basis.n);
                    let by = air::pull(air, (&area, &u), &w);
                    for (sum, own) in out.air.iter_mut().zip(by.air) {
                        *sum += own * weight;
                    }
                    for (rate, &n) in out.rates.iter_mut().zip(&basis.n) {
                        *rate += by.velocity * (weight * n);
                    }
                    by.area * weight
                }
                Spread::Pressure { .. } | Spread::Dead { .. } => w * weight,
            };
            let by = [along_s.cross(&by_normal), by_normal.cross(along_r)];
            for (a, node) in out.nodes.iter_mut().enumerate() {
                *node += by[0] * S::from(basis.by[0][a]) + by[1] * S::from(basis.by[1][a]);
            }
        }
        if let Some(moving) = &self.moving {
            // u = Rᵀ v + ω × x + ė.
            let linear = self.rotation.tr_mul(&moving.linear);
            for ((node, by), x) in out.nodes.iter_mut().zip(&out.rates).zip(&patch.x) {
                out.linear += by;
                out.angular += x.cross(by);
                out.theta += by.cross(&linear);
                *node += by.cross(&moving.angular);
            }
        }
        out
    }
}
