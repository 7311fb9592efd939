//! Structures of shells and beams as finite elements, with exact derivatives; nothing moves here. How the pieces fit:
//! docs/structures.md.

pub mod assembly;
pub mod beam;
pub mod beam_sections;
mod beams;
pub mod damping;
mod fields;
pub mod floating;
pub mod functions;
pub mod generate;
pub mod gradient;
pub mod inertia;
pub mod lifted;
pub mod loads;
pub mod lumped_mass;
pub mod material;
pub mod mesh;
pub mod modal;
pub mod modes;
pub mod normal_moment;
pub mod parts;
pub mod properties;
pub mod quality;
mod reactions;
pub mod refined;
pub mod resultants;
mod sheets;
pub mod shell;
pub mod state;
pub mod statics;
pub mod structure;
pub mod supports;
pub mod turned;
pub mod von_karman;

pub use beam::{Section, SectionFault, SectionValues};
pub use shell::Terms;
