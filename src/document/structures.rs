//! Structures of shells and beams as they are written in a file.

use super::flexible::Damping;
use crate::length_unit::LengthUnit;
use crate::names::Names;
use crate::quantity::{Quantity, Vector};
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::shell::ShellKind;
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;
use std::sync::Arc;

/// A structure: a mesh, of what it is made, and how it is supported.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Structure {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// The mesh, by a generator or from a file.
    pub mesh: Mesh,
    /// The element of shells, default mitc9. Numbers of elements count these.
    pub element: Option<ShellElement>,
    /// Name of the material.
    pub material: String,
    /// Origin of the mesh, default [0, 0, 0].
    #[schemars(extend("unit" = "m"))]
    pub at: Option<Vector>,
    /// Thickness of shells: one number, or one of its own for each element, band, patch or group.
    pub thickness: Option<Thickness>,
    /// Cross section of all beams.
    pub section: Option<Section>,
    /// Cross sections by elements or groups, instead of `section`.
    pub sections: Option<VariedSection>,
    /// Non-structural mass per area of shells, default 0.
    #[schemars(extend("unit" = "kg/m²", "minimum" = 0))]
    pub surface_mass: Option<Quantity>,
    /// Non-structural mass per length of beams, default 0.
    #[schemars(extend("unit" = "kg/m", "minimum" = 0))]
    pub line_mass: Option<Quantity>,
    /// Offset of the centre of the section from the nodes of beams, along its axes 2 and 3, default
    /// 0.
    #[schemars(extend("unit" = "m"))]
    pub offset: Option<[Quantity; 2]>,
    /// Sets of nodes or elements by name, besides those that the generator names.
    #[serde(default)]
    pub sets: IndexMap<String, Set>,
    /// Supports by name.
    #[serde(default)]
    pub supports: IndexMap<String, Support>,
    /// Masses at nodes, by name.
    #[serde(default)]
    pub masses: IndexMap<String, Mass>,
    /// Damping, which only a motion has: a structure that does not move has none.
    pub damping: Option<Damping>,
}

/// Elements of shells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ShellElement {
    /// Nine nodes: MITC9 of Bucalem and Bathe (1993).
    #[default]
    Mitc9,
    /// Four nodes: MITC4 of Dvorkin and Bathe (1984). Each costs less, and more of them are needed.
    Mitc4,
}

/// A generator of a mesh. x runs along the first direction of a panel, y along the second. A panel names
/// its edges x0, x1, y0, y1, its corners x0y0 … x1y1, and all. A line of beams names its ends start and
/// end, and all.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Mesh {
    /// A rectangular plate in the plane z = 0, from the origin to (length, width).
    Plate {
        /// Length along x.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        length: Quantity,
        /// Width along y.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        width: Quantity,
        /// Numbers of elements along x and y.
        #[schemars(extend(
            "minimum" = 1,
            "design_variable" = "a number of elements is a count, not a physical number"
        ))]
        elements: [usize; 2],
    },
    /// A panel through control points: 4 corners (bilinear), or 9 points (biquadratic), row by row along x.
    Panel {
        /// The points.
        #[schemars(extend("unit" = "m"))]
        points: Vec<Vector>,
        /// Numbers of elements along x and y.
        #[schemars(extend(
            "minimum" = 1,
            "design_variable" = "a number of elements is a count, not a physical number"
        ))]
        elements: [usize; 2],
    },
    /// A piece of a cylinder about the z axis: x along the arc, y along the axis. Normals point outwards.
    CurvedPanel {
        /// Radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
        /// Length along the axis.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        length: Quantity,
        /// Angles from the x axis where the arc begins and ends.
        #[schemars(extend("unit" = "rad"))]
        angles: [Quantity; 2],
        /// Numbers of elements along the arc and the axis.
        #[schemars(extend(
            "minimum" = 1,
            "design_variable" = "a number of elements is a count, not a physical number"
        ))]
        elements: [usize; 2],
    },
    /// A whole cylinder about the z axis; its ends are the edges y0 and y1.
    Cylinder {
        /// Radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
        /// Length along the axis.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        length: Quantity,
        /// Numbers of elements around (at least 3) and along the axis.
        #[schemars(extend(
            "minimum" = 1,
            "design_variable" = "a number of elements is a count, not a physical number"
        ))]
        elements: [usize; 2],
    },
    /// A straight line of beams.
    StraightBeam {
        /// Where it starts.
        #[schemars(extend("unit" = "m"))]
        from: Vector,
        /// Where it ends.
        #[schemars(extend("unit" = "m"))]
        to: Vector,
        /// A vector in the plane of the beam and axis 2 of its section.
        #[schemars(extend("unit" = "1"))]
        orientation: Vector,
        /// Number of elements.
        #[schemars(extend(
            "minimum" = 1,
            "maximum" = 1_000_000,
            "design_variable" = "a number of elements is a count, not a physical number"
        ))]
        elements: usize,
    },
    /// An arc of beams in the plane z = 0 about the origin. Axis 2 of the section is the z axis.
    CurvedBeam {
        /// Radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
        /// Angles from the x axis where the arc begins and ends.
        #[schemars(extend("unit" = "rad"))]
        angles: [Quantity; 2],
        /// Number of elements.
        #[schemars(extend(
            "minimum" = 1,
            "maximum" = 1_000_000,
            "design_variable" = "a number of elements is a count, not a physical number"
        ))]
        elements: usize,
    },
    /// A frame of straight members that are joined rigidly at points. A point is the set of nodes of its name,
    /// a member the set of beams of its name.
    Frame {
        /// The points by name.
        #[schemars(extend("unit" = "m"))]
        points: IndexMap<String, Vector>,
        /// The members by name.
        members: IndexMap<String, Member>,
    },
    /// A mesh from a file of Gmsh.
    Gmsh(GmshMesh),
}

/// A mesh from a file of Gmsh, MSH 2.2 or 4.1 in ASCII: shells of its quadrangles or, if it has none, beams of its
/// lines. Physical groups are sets of their names: of points sets of nodes, of lines sets of nodes and of edges (or
/// beams), of surfaces sets of nodes and of faces; a group without a name is point1, line1, surface1 with its number.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GmshMesh {
    /// The file; its path is relative to the problem file.
    pub file: String,
    /// Unit of its coordinates, default m.
    #[serde(default)]
    pub unit: LengthUnit,
    /// Of beams: a vector in the plane of each and axis 2 of its section.
    #[schemars(extend("unit" = "1"))]
    pub orientation: Option<Vector>,
    /// The mesh, once read.
    #[serde(skip)]
    #[schemars(skip)]
    pub read: Option<Arc<ReadMesh>>,
}

/// A mesh that was read, with the places of its nodes \[m\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadMesh {
    /// The mesh with its sets.
    pub mesh: flexbody_mechanics::structures::mesh::Mesh,
    /// Places of the nodes \[m\].
    pub nodes: Vec<Vec3<f64>>,
}

impl Structure {
    /// The kind of its shells.
    pub fn shell_kind(&self) -> ShellKind {
        match self.element.unwrap_or_default() {
            ShellElement::Mitc9 => ShellKind::Mitc9,
            ShellElement::Mitc4 => ShellKind::Mitc4,
        }
    }
}

impl Mesh {
    /// Numbers of elements of a panel; `None` of beams.
    pub fn panel_elements(&self) -> Option<[usize; 2]> {
        match self {
            Self::Plate { elements, .. }
            | Self::Panel { elements, .. }
            | Self::CurvedPanel { elements, .. }
            | Self::Cylinder { elements, .. } => Some(*elements),
            Self::StraightBeam { .. } | Self::CurvedBeam { .. } | Self::Frame { .. } => None,
            Self::Gmsh(_) => None,
        }
    }

    /// Whether it has beams, and not shells.
    pub fn is_of_beams(&self) -> bool {
        match self {
            Self::Gmsh(gmsh) => {
                let read = gmsh.read.as_ref();
                read.is_some_and(|own| own.mesh.shells.is_empty())
            }
            other => other.panel_elements().is_none(),
        }
    }

    /// Whether its file is still to be read.
    pub fn is_unread(&self) -> bool {
        matches!(self, Self::Gmsh(gmsh) if gmsh.read.is_none())
    }
}

/// A member of a frame.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Member {
    /// Names of the points that it joins.
    pub between: [String; 2],
    /// A vector in the plane of the member and axis 2 of its section.
    #[schemars(extend("unit" = "1"))]
    pub orientation: Vector,
    /// Number of elements.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 1_000_000,
        "design_variable" = "a number of elements is a count, not a physical number"
    ))]
    pub elements: usize,
}

/// What shares a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Per {
    /// Each element has its own.
    Element,
    /// Each band across a panel has its own.
    Band,
    /// Each patch of a panel has its own.
    Patch,
    /// Each named set of elements has its own.
    Group,
}

/// A direction of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// The first.
    X,
    /// The second.
    Y,
}

/// Thickness of shells.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Thickness {
    /// One for all.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    Uniform(Quantity),
    /// Several.
    Varied(VariedThickness),
}

/// Thickness by elements, bands, patches or groups. A variable whose path ends at `value` stands for one
/// variable each.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariedThickness {
    /// What has a thickness of its own.
    pub per: Per,
    /// Of bands: the direction in which they follow each other, default y.
    pub along: Option<Direction>,
    /// Of bands: how many, default as many as elements.
    #[schemars(extend(
        "minimum" = 1,
        "maximum" = 100_000,
        "design_variable" = "a number of bands is a count, not a physical number"
    ))]
    pub bands: Option<usize>,
    /// Of patches: how many along x and y.
    #[schemars(extend(
        "minimum" = 1,
        "design_variable" = "a number of patches is a count, not a physical number"
    ))]
    pub patches: Option<[usize; 2]>,
    /// Of groups: their names, which are sets of faces.
    pub groups: Option<Vec<String>>,
    /// The value of all.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub value: Option<Quantity>,
    /// The value of each, instead of `value`: patches and elements row by row along x.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub values: Option<Vec<Quantity>>,
}

/// Cross sections by elements or groups. A variable whose path goes through `value` stands for one variable
/// each.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct VariedSection {
    /// What has a section of its own: element or group.
    pub per: Per,
    /// Of groups: their names, which are sets of beams.
    pub groups: Option<Vec<String>>,
    /// The section of all.
    pub value: Option<Section>,
    /// The section of each, instead of `value`.
    pub values: Option<Vec<Section>>,
}

/// A cross section.
pub type Section = super::section::Section<GivenSection>;

/// Stiffnesses and masses of a section.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenSection {
    /// EA and the shear stiffnesses GA2 and GA3 with their factors.
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0))]
    pub axial_and_shear: [Quantity; 3],
    /// GJ, EI2 (of bending along axis 3) and EI3 (of bending along axis 2).
    #[schemars(extend("unit" = "N m²", "exclusiveMinimum" = 0))]
    pub torsion_and_bending: [Quantity; 3],
    /// Mass per length ρA.
    #[schemars(extend("unit" = "kg/m", "minimum" = 0))]
    pub mass: Quantity,
    /// Moments of the mass per length, ρI2 and ρI3.
    #[schemars(extend("unit" = "kg m", "minimum" = 0))]
    pub inertia: [Quantity; 2],
}

/// A set of nodes or elements, in the directions ξ and η of a panel, which run from 0 to 1; a line of beams
/// has the first only.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Set {
    /// The node nearest to (ξ, η).
    Node {
        /// ξ and η.
        #[schemars(extend(
            "minimum" = 0,
            "design_variable" = "a set is chosen once, for all designs"
        ))]
        at: [f64; 2],
    },
    /// The elements whose middles lie between two corners.
    Elements {
        /// Smallest ξ and η.
        #[schemars(extend("minimum" = 0, "design_variable" = "a set is chosen once, for all designs"))]
        from: [f64; 2],
        /// Largest ξ and η.
        #[schemars(extend("minimum" = 0, "design_variable" = "a set is chosen once, for all designs"))]
        to: [f64; 2],
    },
}

/// What a support holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Held {
    /// Displacement along x.
    X,
    /// Displacement along y.
    Y,
    /// Displacement along z.
    Z,
    /// Rotation about x.
    Rx,
    /// Rotation about y.
    Ry,
    /// Rotation about z.
    Rz,
}

/// A support: what the nodes of some sets cannot do, in ground axes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Support {
    /// The set of nodes, or a list of sets.
    pub nodes: Names,
    /// What is held: displacements x, y, z and rotations rx, ry, rz; default all of them.
    pub held: Option<Vec<Held>>,
}

/// A non-structural mass at each node of a set.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Mass {
    /// Name of the set of nodes.
    pub nodes: String,
    /// Mass at each node.
    #[schemars(extend("unit" = "kg", "minimum" = 0))]
    pub mass: Quantity,
    /// Its inertia about the node, xx, yy, zz, xy, yz, zx in ground axes; default none.
    #[schemars(extend("unit" = "kg m²"))]
    pub inertia: Option<[Quantity; 6]>,
}

/// An isotropic material.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Material {
    /// Young's modulus.
    #[schemars(extend("unit" = "Pa", "exclusiveMinimum" = 0))]
    pub young: Quantity,
    /// Poisson's ratio.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = -1, "maximum" = 0.5))]
    pub poisson: Quantity,
    /// Density; needed for masses, weight and frequencies.
    #[schemars(extend("unit" = "kg/m³", "minimum" = 0))]
    pub density: Option<Quantity>,
    /// Yield stress that stresses are compared with; needed for stress functions.
    #[schemars(extend("unit" = "Pa", "exclusiveMinimum" = 0))]
    pub yield_stress: Option<Quantity>,
}
