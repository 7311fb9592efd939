//! What moves on a page: bodies, joints and paths in ground axes at some instants.

use serde::Serialize;

/// A machine in motion, a structure under load, or a mode.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stage {
    /// What it is, such as `optimal design`.
    pub title: String,
    /// Instants \[s\]; of structures the part of the load, 0 and 1.
    pub times: Vec<f64>,
    /// Whether it swings about its first frame with the difference to its second: a mode.
    pub swings: bool,
    /// What `times` counts, such as `t [s]`.
    pub clock: &'static str,
    /// The bodies.
    pub bodies: Vec<Body>,
    /// Joints, rods, springs and arms.
    pub links: Vec<Link>,
    /// Forces, drawn on request.
    pub arrows: Vec<Arrow>,
    /// Paths of points \[m\].
    pub paths: Vec<Vec<[f64; 3]>>,
    /// Directions to the right and up of the first view.
    pub view: [[f64; 3]; 2],
    /// Height along `up` of the ground on which a projectile lands \[m\].
    pub ground: Option<f64>,
    /// Position and height of a barrier \[m\].
    pub barrier: Option<[f64; 2]>,
    /// Flight of the projectile along the directions of the view, until it lands \[m\]; empty without one.
    pub flight: Vec<[f64; 2]>,
    /// Least and largest value of the colours, if some are shown.
    pub range: Option<[f64; 2]>,
    /// What the colours mean.
    pub label: String,
}

/// A body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Body {
    /// Its name.
    pub name: String,
    /// Its shape.
    pub shape: Shape,
}

/// The shape of a body. The pose of a rigid one at an instant: its origin \[m\], then the first and the second axis.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
pub enum Shape {
    /// The convex hull of points.
    Hull {
        /// The points in body axes \[m\].
        points: Vec<[f64; 3]>,
        /// The pose at each instant.
        poses: Vec<[f64; 9]>,
    },
    /// A sphere about the origin.
    Sphere {
        /// Its radius \[m\].
        radius: f64,
        /// The pose at each instant.
        poses: Vec<[f64; 9]>,
    },
    /// Lines from the origin.
    Spokes {
        /// Their ends in body axes \[m\].
        points: Vec<[f64; 3]>,
        /// The pose at each instant.
        poses: Vec<[f64; 9]>,
    },
    /// Faces that deform by a few shapes: of a point `points + Σ coordinates · basis` in body axes.
    Modal {
        /// The points of each face.
        faces: Vec<Vec<usize>>,
        /// The undeformed points in body axes \[m\].
        points: Vec<[f64; 3]>,
        /// Displacement of every point for one unit of each coordinate, x y z one after the other.
        basis: Vec<Vec<f64>>,
        /// The pose at each instant.
        poses: Vec<[f64; 9]>,
        /// The elastic coordinates at each instant.
        coordinates: Vec<Vec<f64>>,
        /// The value of each face at each instant; empty without colours.
        values: Vec<Vec<f64>>,
    },
    /// Faces and lines whose points move freely.
    Mesh {
        /// The points of each face, or the two of a line.
        faces: Vec<Vec<usize>>,
        /// The points in ground axes at each instant, x y z one after the other \[m\].
        places: Vec<Vec<f64>>,
        /// The value of each face at each instant; empty without colours.
        values: Vec<Vec<f64>>,
    },
}

/// A force at a point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Arrow {
    /// The joint with the body that it acts on, or the load.
    pub name: String,
    /// Whether a load applies it; else a joint exerts it.
    pub applied: bool,
    /// Point \[m\] and force \[N\] in ground axes at each instant.
    pub forces: Vec<[f64; 6]>,
}

/// A joint, rod, spring or arm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Link {
    /// `hinge`, `slider`, `rod`, `spring` or `arm`.
    pub kind: &'static str,
    /// The number of the body whose arm it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body: Option<usize>,
    /// Whether it joins a body to ground.
    pub grounded: bool,
    /// Its two points at each instant \[m\]; the second of a slider is a point of its line.
    pub ends: Vec<[f64; 6]>,
}
