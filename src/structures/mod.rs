//! Structures of shells and beams as finite elements, with exact derivatives; nothing moves here. How the pieces fit:
//! docs/structures.md.

pub(crate) mod assembly;
pub(crate) mod beam;
pub(crate) mod beam_sections;
mod beams;
pub mod damping;
mod fields;
pub(crate) mod floating;
pub mod functions;
pub mod generate;
pub mod gradient;
pub mod inertia;
pub(crate) mod lifted;
pub mod loads;
pub mod lumped_mass;
pub mod material;
pub mod mesh;
pub(crate) mod modal;
pub mod modes;
pub(crate) mod normal_moment;
pub(crate) mod parts;
pub mod properties;
pub mod quality;
mod reactions;
mod sheets;
pub(crate) mod shell;
pub(crate) mod state;
pub mod statics;
pub mod structure;
pub mod supports;
pub(crate) mod turned;
pub mod von_karman;

pub use beam::{Section, SectionFault, SectionValues};
pub use shell::Terms;
