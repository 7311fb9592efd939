//! A contact of a sphere, point, wheel or capsule of body A with a surface of body B: its parameters.
//!
//! Let p be the centre of the sphere, R_A its radius, n the normal of the surface at its nearest point, which points to the
//! sphere, and d the distance of p from the surface's plane, centre, axis, box or heights:
//!
//! ```text
//! δ = R_A − d (plane, heights),   δ = R_A + R_B − d (sphere, capsule, box)
//! F = N(δ, δ̇) n − μ N v_t / √(v_tᵀ v_t + w²)        on body A at the place of contact, the opposite on body B
//! μ = μ_k + (μ_s − μ_k) exp(−v_tᵀ v_t / v_s²)
//! ```
//!
//! N is the [`NormalLaw`], v_t the tangential velocity of A against B there and w the width of the friction
//! (Vigué et al. 2017); μ falls from μ_s to μ_k as slip sets in (Stribeck; Bo & Pavelescu 1982). The place of contact divides the line
//! between the centres by the radii; on planes and heights, it is the point of the sphere that is deepest. A wheel is a torus: spheres
//! whose centres lie on a circle about an axis of A, of which the lowest touches. A capsule touches planes and heights by n spheres
//! along its axis, each with 2/n of the stiffness, and other surfaces where its axis is nearest. Within a box d is negative: that to the nearest face. Formulas and derivatives are
//! in `system::loads::contact`.

use super::height_field::HeightField;
use super::normal_law::NormalLaw;
use crate::math::{Scalar, Vec3, parameters};
use std::sync::Arc;

/// A contact.
#[derive(Clone, Debug)]
pub struct Contact<S> {
    /// Body A, which has the shape.
    pub body_a: usize,
    /// Body B, which has the surface; `None` is ground.
    pub body_b: Option<usize>,
    /// Centre of the shape on A, from the centre of mass in body axes \[m\].
    pub point_a: Vec3<S>,
    /// Radius of its spheres; zero for a point \[m\].
    pub radius: S,
    /// Where the centres of its spheres are.
    pub shape: Shape<S>,
    /// A point of the plane on B, the centre of the sphere, capsule or box, or the origin of the height field, from the centre of
    /// mass in body axes (on ground: from the origin) \[m\].
    pub point_b: Vec3<S>,
    /// The surface of B.
    pub surface: Surface<S>,
    /// The normal law.
    pub law: NormalLaw<S>,
    /// Friction.
    pub friction: Friction<S>,
}

/// Centres of the spheres that a body touches with.
#[derive(Clone, Debug)]
pub enum Shape<S> {
    /// One sphere.
    Sphere,
    /// A circle about the centre.
    Wheel {
        /// Its unit axis, in axes of body A.
        axis: Vec3<S>,
        /// Its radius \[m\].
        radius: S,
    },
    /// A line about the centre.
    Capsule {
        /// From its centre to one end, in axes of body A \[m\].
        half: Vec3<S>,
        /// How many spheres along it touch planes and heights, two or more.
        spheres: usize,
    },
}

/// Friction of a contact.
#[derive(Clone, Debug)]
pub struct Friction<S> {
    /// Coefficient μ_k.
    pub coefficient: S,
    /// Tangential velocity w at which 71 % of the friction acts \[m/s\].
    pub width: S,
    /// What μ adds at slow slip.
    pub stribeck: Option<Stribeck<S>>,
}

/// Friction that is larger at slow slip.
#[derive(Clone, Debug)]
pub struct Stribeck<S> {
    /// Coefficient μ_s without slip.
    pub coefficient: S,
    /// Velocity v_s at which 63 % of the difference is gone \[m/s\].
    pub speed: S,
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
    /// Heights over a plane.
    Field {
        /// Unit axes along and across the field and of its heights, in body axes.
        axes: [Vec3<S>; 3],
        /// The heights.
        heights: Arc<HeightField>,
    },
}

parameters!(enum Shape { Sphere, Wheel {; axis, radius }, Capsule { spheres; half } });

parameters!(struct Stribeck {; coefficient, speed });

parameters!(struct Friction {; coefficient, width, stribeck });

parameters!(struct Contact { body_a, body_b; point_a, radius, shape, point_b, surface, law, friction });

parameters!(enum Surface {
    Plane {; normal },
    Sphere {; radius },
    Capsule {; half, radius },
    Box {; halves, radius },
    Field { heights; axes },
});

impl<S: Scalar> Friction<S> {
    /// Whether there is no friction.
    pub fn is_none(&self) -> bool {
        self.coefficient.is_zero() && self.stribeck.is_none()
    }
}

impl<S> Shape<S> {
    /// The direction that the shape has, in axes of body A: the axis of a wheel, or half of a capsule.
    pub fn direction(&self) -> Option<&Vec3<S>> {
        match self {
            Self::Sphere => None,
            Self::Wheel { axis: own, .. } | Self::Capsule { half: own, .. } => Some(own),
        }
    }

    /// The same to be changed.
    pub fn direction_mut(&mut self) -> Option<&mut Vec3<S>> {
        match self {
            Self::Sphere => None,
            Self::Wheel { axis: own, .. } | Self::Capsule { half: own, .. } => Some(own),
        }
    }
}

impl<S> Surface<S> {
    /// Replaces the directions that the surface has.
    pub fn turn(&mut self, turned: impl Fn(&Vec3<S>) -> Vec3<S>) {
        match self {
            Surface::Plane { normal: own } | Surface::Capsule { half: own, .. } => {
                *own = turned(own);
            }
            Surface::Sphere { .. } => {}
            Surface::Box { halves: all, .. } | Surface::Field { axes: all, .. } => {
                all.iter_mut().for_each(|own| *own = turned(own));
            }
        }
    }

    /// The directions that the surface has, in body axes: a normal, an axis, or three.
    pub fn directions(&self) -> &[Vec3<S>] {
        match self {
            Surface::Plane { normal: own } | Surface::Capsule { half: own, .. } => {
                std::slice::from_ref(own)
            }
            Surface::Sphere { .. } => &[],
            Surface::Box { halves: all, .. } | Surface::Field { axes: all, .. } => all,
        }
    }
}

impl<S> Contact<S> {
    /// What each place of contact has of the stiffness: the spheres of a capsule together have that of two.
    pub fn share(&self) -> f64 {
        match (&self.shape, self.spheres()) {
            (Shape::Capsule { spheres, .. }, Some(_)) => 2.0 / *spheres as f64,
            _ => 1.0,
        }
    }

    /// Half of a capsule that touches by spheres along its axis, and the parts of it at which they are: 1 and −1 for the ends.
    pub fn spheres(&self) -> Option<(&Vec3<S>, impl Iterator<Item = f64> + use<S>)> {
        match (&self.shape, &self.surface) {
            (Shape::Capsule { half, spheres }, Surface::Plane { .. } | Surface::Field { .. }) => {
                let intervals = (spheres - 1) as f64;
                let part = move |k: usize| 1.0 - 2.0 * k as f64 / intervals;
                Some((half, (0..*spheres).map(part)))
            }
            _ => None,
        }
    }
}
