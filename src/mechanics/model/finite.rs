//! Shells of a flexible body as finite elements: its coordinates are displacements and rotations of nodes.
//!
//! A point is the position x_a = X_a + u_a of a node or its director t_a = D_a + θ_a × D_a, in the axes of
//! the frame. Points have scalar masses between the nodes of an element,
//!
//! ```text
//! T = ½ Σ m_ab ẋ_a·ẋ_b + ½ Σ i_ab ṫ_a·ṫ_b,   m_ab = (ρh + μ) A_ab,   i_ab = ρh³/12 A_ab,   A_ab = ∫ N_a N_b dA
//! U = ½ E h eᵀ P e + ½ E h³ vᵀ K_b v + ½ E h vᵀ K_s v,   e_p = b_p·u + ½ (r_p·u)(s_p·u)
//! ```
//!
//! with the unknowns v of an element, of which u are the displacements. A, P, K_b, K_s, b, r and s are
//! those of the mesh and of Poisson's ratio, and no design changes them.
//!
//! Beams and lumped masses are parts with few unknowns each: a part has the numbers of a body of shapes, the shapes
//! being those of its unknowns. Damping is that of Rayleigh for small motions, with forces that rigid motions do not
//! have: −α M_ee q̇ and −β Σ k_p ∇e_p ė_p, e_p all strains.

pub use super::element_operators::UNKNOWNS;
use super::element_operators::{Columns, Symmetric};
use super::shapes::{ModalInertia, ModalStiffness};
use super::shell_kind::{SHELL_NODES, ShellKind, ShellNodes};
use crate::math::{Mat3, Team, Vec3, parameters};
use std::sync::{Arc, OnceLock};

/// Nodes of an element, at most.
pub const NODES: usize = SHELL_NODES;
/// Points of an element at most: the positions of its nodes, then from [`NODES`] on their directors. Those that an
/// element does not have are zero.
pub const POINTS: usize = 2 * NODES;
/// Displacements of the nodes of an element, at most.
pub const DISPLACEMENTS: usize = 3 * NODES;
/// Membrane strains of an element, with the three of the patch correction; those that its kind does not have are zero.
pub const STRAINS: usize = 19;
/// Those with von Karman's term.
pub const QUADRATIC: usize = 16;
/// Those of them whose slopes r_p and s_p are one, which come first.
pub const SQUARES: usize = 12;
/// Slopes of an element: r_p, then the s_p that are others.
pub const SLOPES: usize = 2 * QUADRATIC - SQUARES;
/// Numbers of its shear strains, at most.
pub const SHEARS: usize = 12;
/// Strains or curvatures at its Gauss points, three each.
pub const AT_GAUSS_POINTS: usize = 27;

/// Where s_p stands among the slopes.
pub fn other_slope(p: usize) -> usize {
    if p < SQUARES {
        p
    } else {
        p + QUADRATIC - SQUARES
    }
}

/// Shells of a flexible body: the mesh, and what a design can change of each element.
#[derive(Clone, Debug)]
pub struct FiniteElements<S> {
    /// The mesh.
    pub mesh: Arc<ElementMesh>,
    /// Thickness h \[m\].
    pub thickness: Vec<S>,
    /// Young's modulus E \[Pa\].
    pub young: Vec<S>,
    /// Density ρ \[kg/m³\].
    pub density: Vec<S>,
    /// Non-structural mass per area μ \[kg/m²\].
    pub surface_mass: Vec<S>,
    /// Beams, then lumped masses, in the order of the mesh.
    pub parts: Vec<Part<S>>,
    /// α \[1/s\] and β \[s\]; none if nothing is damped.
    pub damping: Option<[S; 2]>,
    /// The ranks that divide the elements among them.
    pub team: Team,
}

parameters!(struct FiniteElements { mesh, team; thickness, young, density, surface_mass, parts, damping });

/// A beam or a lumped mass among the elements of a body.
#[derive(Clone, Debug)]
pub struct Part<S> {
    /// Mass \[kg\].
    pub mass: S,
    /// Σ m_kl X_k X_lᵀ of the undeformed part \[kg m²\].
    pub second: Mat3<S>,
    /// Integrals of the shapes of its unknowns.
    pub inertia: ModalInertia<S>,
    /// Strain energy; none of a lumped mass.
    pub stiffness: ModalStiffness<S>,
}

parameters!(struct Part {; mass, second, inertia, stiffness });

/// What no design changes of the shells of a body.
#[derive(Clone, Debug)]
pub struct ElementMesh {
    /// Number of coordinates.
    pub coordinates: usize,
    /// The elements.
    pub elements: Vec<ShellElement>,
    /// Place of each node \[m\].
    pub nodes: Vec<Vec3<f64>>,
    /// Coordinates of the displacements of each node; none where the frame holds them.
    pub displacements: Vec<[Option<usize>; 3]>,
    /// Coordinates of the unknowns of each part, without those that the frame holds.
    pub parts: Vec<Vec<usize>>,
    /// Nodes of the beams, which are the first parts: an end, the middle, the other end.
    pub beams: Vec<[usize; 3]>,
}

/// A shell of nine or four nodes.
#[derive(Clone, Debug)]
pub struct ShellElement {
    /// Its nodes.
    pub nodes: ShellNodes,
    /// The coordinate of each unknown; none where the frame holds it. Displacements come first.
    pub coordinates: Vec<Option<usize>>,
    /// X_a \[m\], then D_a.
    pub points: [Vec3<f64>; POINTS],
    /// The point that each unknown moves, and how: displacements along the axes, node by node, then rotations.
    pub moves: Vec<(usize, Vec3<f64>)>,
    /// The rotations among them; none if the nodes cannot follow any rotation of the element.
    pub turns: Vec<Rotation>,
    /// A_ab \[m²\].
    pub shares: [[f64; NODES]; NODES],
    /// ∫ dA \[m²\].
    pub area: f64,
    /// Σ A_ab X_a X_bᵀ \[m⁴\], and that of the directors \[m²\].
    pub second: [Mat3<f64>; 2],
    /// b_p of the displacements.
    pub membrane: Columns<STRAINS>,
    /// r_p and s_p of the displacements.
    pub slopes: Columns<SLOPES>,
    /// P for E = h = 1.
    pub plane: [[f64; STRAINS]; STRAINS],
    /// K_b and K_s for E = h = 1.
    pub linear: [Symmetric; 2],
    /// S with K_s = Sᵀ S. Its products have less round-off than those of K_s, which is much stiffer than K_b where h is small.
    pub shear: Columns<SHEARS>,
    /// What stresses need; made for the first of them.
    pub stress: OnceLock<Box<StressOperator>>,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Yield stress \[Pa\].
    pub yield_stress: f64,
}

impl ShellElement {
    /// Its kind.
    pub fn kind(&self) -> ShellKind {
        ShellKind::of(&self.nodes)
    }

    /// Displacements of its nodes, which are the first unknowns.
    pub fn displacements(&self) -> usize {
        3 * self.nodes.len()
    }
}

/// An unknown rotation of a node. The axes of a node are orthogonal. If they are two, they are tangents.
#[derive(Clone, Copy, Debug)]
pub struct Rotation {
    /// The node of the element.
    pub node: usize,
    /// θ for an unknown of one.
    pub axis: Vec3<f64>,
    /// The unknown is its product with θ.
    pub inverse: Vec3<f64>,
}

/// Strains and curvatures at the Gauss points of an element, in the frames there.
#[derive(Clone, Debug)]
pub struct StressOperator {
    /// Strains of the middle surface by the e_p.
    pub membrane: Columns<AT_GAUSS_POINTS>,
    /// Curvatures by the unknowns \[1/m\].
    pub curvature: Columns<AT_GAUSS_POINTS>,
}
