//! Flexible bodies: a frame that moves as a body does, and elastic coordinates q that deform the
//! body beside it.
//!
//! A point X of the body is at x = X + Σ_I q_I X_I(X) in the axes of the frame; X_I is the shape of
//! mode I. The motion depends on integrals of the shapes over the mass (Shabana 2013, *Dynamics of
//! Multibody Systems*, ch. 5), with mode 0 the undeformed position X, of which mass and inertia are
//! those of the frame:
//!
//! ```text
//! p_I = ∫ X_I dm                              (3)
//! S_IJ = ∫ X_I X_Jᵀ dm + ∫ T_I T_Jᵀ di        (3 × 3; T_I turns the section's directors, di its inertia)
//! U = ½ qᵀ K q + ½ Σ_p k_p e_p²,     e_p = b_p · q + ½ Σ_s c_ps (g_ps · q)²
//! ```
//!
//! e_p are von Karman's strains at points with weights, so U is a quartic polynomial.
//!
//! The elastic coordinates are in the states as positions of *carriers*: bodies without mass that
//! are listed in [`super::Model::bodies`], cannot turn, and have three coordinates or one each. So
//! states, steps and their adjoints have one layout for all bodies. A point of the deformed body
//! that carries joints, loads or functions is a body without mass as well, its *interface*, held by
//! a joint of kind `Attachment` (see [`Modes`]).

use super::TimeFunction;
use super::finite::FiniteElements;
use super::reduced::ReducedShells;
pub use super::shapes::{ModalInertia, ModalStiffness, Quadratic, Strain};
use crate::math::{Scalar, Vec3, parameters};
use std::sync::Arc;

/// A flexible body.
#[derive(Clone, Debug)]
pub struct FlexibleBody<S> {
    /// Name in the problem file.
    pub name: String,
    /// The body that is the floating frame: its position is the frame's origin; its mass is ∫dm, and its
    /// inertia that of the undeformed body about the origin.
    pub frame: usize,
    /// The first of the carriers of the elastic coordinates, which are consecutive.
    pub carriers: usize,
    /// Kind of its inertia.
    pub inertia: Inertia,
    /// Kind of its coordinates.
    pub form: Form<S>,
}

/// Which inertia a flexible body has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Inertia {
    /// That of the deformed body.
    Full,
    /// That of a kinetic energy without products of places and deformations (Kennedy & Boopathy 2016, equations 10,
    /// 13, 14), which depends on the velocity of the observer.
    Paper,
}

/// What the coordinates of a flexible body are.
#[derive(Clone, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "a scene has few flexible bodies, and each owns far more"
)]
pub enum Form<S> {
    /// Factors of shapes of the whole body.
    Modal(Modal<S>),
    /// Displacements and rotations of the nodes of finite elements.
    Finite(FiniteElements<S>),
}

/// A body whose coordinates are factors of shapes. Coordinates I = 1 … m have the index I − 1.
#[derive(Clone, Debug)]
pub struct Modal<S> {
    /// Integrals of the shapes.
    pub inertia: ModalInertia<S>,
    /// Strain energy U.
    pub stiffness: ModalStiffness<S>,
    /// Damping D: the force D q̇ acts against the coordinates; symmetric, m × m by rows.
    pub damping: Vec<S>,
    /// β of a beam whose strains are damped in proportion to their stiffness \[s\]; `None` of others.
    pub viscosity: Option<S>,
    /// Further numbers of a body of shells in a reduced basis.
    pub shells: Option<ReducedShells<S>>,
    /// Sections of a beam, which show how far it is turned; none of other bodies.
    pub sections: Arc<[BeamSection]>,
}

impl<S: Scalar> Modal<S> {
    /// β of strains that are damped in proportion to their stiffness, of a beam or of shells \[s\]; `None` without.
    pub fn strain_damping(&self) -> Option<S> {
        let of_shells = self.shells.as_ref().and_then(|own| own.elements.damping);
        of_shells.map(|[_, beta]| beta).or(self.viscosity)
    }
}

/// What the coordinates of a beam do to a section, by rows, for estimates.
#[derive(Clone, Debug)]
pub struct BeamSection {
    /// The length that it stands for \[m\].
    pub size: f64,
    /// Whether slopes stretch it.
    pub von_karman: bool,
    /// Of a beam that would buckle laterally if its twist and bending coupled: which of the stiffnesses is that of
    /// bending about the strong axis, and the uniform moment that buckles it between hinges, π √(EI GJ)/L [N m].
    pub lateral: Option<(usize, f64)>,
    /// EA, GJ, EI2, EI3.
    pub stiffness: [f64; 4],
    /// v' and w'.
    pub slopes: [Vec<f64>; 2],
    /// φ.
    pub twist: Vec<f64>,
    /// u', twist and curvatures, in the order of the stiffnesses.
    pub strains: [Vec<f64>; 4],
}

/// How an attachment's frame moves with the elastic coordinates: in the axes of the body, its point at
/// s = X + Σ q_I N_I, and its axes at e + Σ q_I Θ_I × e. X and e are the joint's frame A.
///
/// Of a coupled joint N_I and Θ_I are along e3, in the axes of its frame B, which they shift along e3 and turn about it
/// by any angle (see [`super::coupling`]).
#[derive(Clone, Debug)]
pub struct Modes<S> {
    /// The body that carries each coordinate that moves it, and the component of its position.
    pub places: Vec<(usize, usize)>,
    /// N_I.
    pub displacement: Vec<Vec3<S>>,
    /// Θ_I.
    pub rotation: Vec<Vec3<S>>,
    /// The profile f of a cam: a coupled frame shifts or turns by f(Σ q_I N_I) or f(Σ q_I Θ_I).
    pub profile: Option<TimeFunction<S>>,
}

/// How many carriers have three coordinates; the others have one.
fn triples(count: usize) -> usize {
    count / 3
}

/// The carriers of `count` elastic coordinates: how many coordinates each has.
pub fn carriers(count: usize) -> impl Iterator<Item = usize> {
    let full = std::iter::repeat_n(3, triples(count));
    full.chain(std::iter::repeat_n(1, count % 3))
}

/// The body that carries each of `count` coordinates whose first carrier is `first`, and the component
/// of its position.
pub fn places(first: usize, count: usize) -> impl Iterator<Item = (usize, usize)> + Clone {
    let full = triples(count);
    (0..count).map(move |i| match i / 3 < full {
        true => (first + i / 3, i % 3),
        false => (first + full + (i - 3 * full), 0),
    })
}

impl<S: Scalar> Form<S> {
    /// The shells of a body that has some, by all nodes or in a reduced basis.
    pub fn shells(&self) -> Option<&FiniteElements<S>> {
        match self {
            Self::Modal(modal) => modal.shells.as_ref().map(|own| &own.elements),
            Self::Finite(finite) => Some(finite),
        }
    }

    /// The unknowns of the nodes of shells at the coordinates `q`; `q` of other bodies.
    pub fn unknowns(&self, q: Vec<S>) -> Vec<S> {
        match self {
            Self::Modal(modal) => match &modal.shells {
                Some(own) => own.unknowns(&q),
                None => q,
            },
            Self::Finite(_) => q,
        }
    }
}

impl<S: Scalar> FlexibleBody<S> {
    /// Number m of elastic coordinates.
    pub fn modes(&self) -> usize {
        match &self.form {
            Form::Modal(modal) => modal.inertia.static_moments.len(),
            Form::Finite(finite) => finite.mesh.coordinates,
        }
    }

    /// The bodies that carry the coordinates.
    pub fn carriers(&self) -> std::ops::Range<usize> {
        self.carriers..self.carriers + carriers(self.modes()).count()
    }

    /// The body that carries each coordinate, and the component of its position.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + Clone + use<S> {
        places(self.carriers, self.modes())
    }
}

parameters!(struct FlexibleBody {
    name, frame, carriers, inertia;
    form
});

parameters!(enum Form { Modal(; modal), Finite(; finite) });

parameters!(struct Modal { sections; inertia, stiffness, damping, viscosity, shells });

parameters!(struct Modes { places; displacement, rotation, profile });
