//! A contact of a sphere, point or wheel of body A with a surface of body B: its parameters.
//!
//! Let p be the centre of the sphere, R_A its radius, n the normal of the surface at its nearest point, which points to the
//! sphere, and d the distance of p from the surface's plane, centre, axis or box:
//!
//! ```text
//! δ = R_A − d (plane),   δ = R_A + R_B − d (sphere, capsule, box)
//! F = N(δ, δ̇) n − μ N v_t / √(v_tᵀ v_t + w²)        on body A at the place of contact, the opposite on body B
//! ```
//!
//! N is the [`NormalLaw`], v_t the tangential velocity of A against B there and w the width of the friction
//! (Vigué et al. 2017). The place of contact divides the line between the centres by the radii; on a plane, it is the
//! lowest point of the sphere. A wheel is a torus: spheres whose centres lie on a circle about an axis of A, of which the lowest
//! touches the plane. Within a box d is negative: that to the nearest face. Formulas and derivatives are in `system::loads::contact`.

use super::normal_law::NormalLaw;
use crate::math::{Vec3, parameters};

/// A contact.
#[derive(Clone, Debug)]
pub struct Contact<S> {
    /// Body A, which has the sphere.
    pub body_a: usize,
    /// Body B, which has the surface; `None` is ground.
    pub body_b: Option<usize>,
    /// Centre of the sphere on A, from the centre of mass in body axes \[m\].
    pub point_a: Vec3<S>,
    /// Radius of the sphere; zero for a point \[m\].
    pub radius: S,
    /// The circle of the centres of a wheel, if it is one.
    pub wheel: Option<Wheel<S>>,
    /// A point of the plane on B, or the centre of the sphere or capsule, from the centre of mass in body axes (on
    /// ground: from the origin) \[m\].
    pub point_b: Vec3<S>,
    /// The surface of B.
    pub surface: Surface<S>,
    /// The normal law.
    pub law: NormalLaw<S>,
    /// Coefficient of friction μ.
    pub friction: S,
    /// Tangential velocity w at which 71 % of the friction acts \[m/s\].
    pub slip: S,
}

/// The circle on which the centres of the spheres of a wheel lie, about the point of A.
#[derive(Clone, Debug)]
pub struct Wheel<S> {
    /// Its unit axis, in axes of body A.
    pub axis: Vec3<S>,
    /// Its radius \[m\].
    pub radius: S,
}

/// A surface.
#[derive(Clone, Debug)]
pub enum Surface<S> {
    /// A plane.
    Plane {
        /// Its unit normal to the free side, in body axes.
        normal: Vec3<S>,
    },
    /// A sphere.
    Sphere {
        /// Its radius; zero for a point \[m\].
        radius: S,
    },
    /// A cylinder with round ends.
    Capsule {
        /// From its centre to the centre of one end, in body axes \[m\].
        half: Vec3<S>,
        /// Its radius \[m\].
        radius: S,
    },
    /// A box with round edges.
    Box {
        /// From its centre to the middles of three faces without the rounding, across each other, in body axes \[m\].
        halves: [Vec3<S>; 3],
        /// The radius of its edges; zero if they are sharp \[m\].
        radius: S,
    },
}

parameters!(struct Wheel {; axis, radius });

parameters!(struct Contact { body_a, body_b; point_a, radius, wheel, point_b, surface, law, friction, slip });

parameters!(enum Surface {
    Plane {; normal },
    Sphere {; radius },
    Capsule {; half, radius },
    Box {; halves, radius },
});

impl<S> Surface<S> {
    /// Replaces the directions that the surface has.
    pub fn turn(&mut self, turned: impl Fn(&Vec3<S>) -> Vec3<S>) {
        match self {
            Surface::Plane { normal } => *normal = turned(normal),
            Surface::Sphere { .. } => {}
            Surface::Capsule { half, .. } => *half = turned(half),
            Surface::Box { halves, .. } => halves.iter_mut().for_each(|half| *half = turned(half)),
        }
    }

    /// The directions that the surface has, in body axes: a normal, an axis, or three.
    pub fn directions(&self) -> &[Vec3<S>] {
        match self {
            Surface::Plane { normal } => std::slice::from_ref(normal),
            Surface::Sphere { .. } => &[],
            Surface::Capsule { half, .. } => std::slice::from_ref(half),
            Surface::Box { halves, .. } => halves,
        }
    }
}
