//! Figures as SVG texts, pure functions of data.
//!
//! Pictures are white. Their colours are distinct for any colour vision, legends are outside the
//! data. The same data give the same bytes.

mod axis;
mod campbell;
mod canvas;
mod colours;
mod connectors;
mod convergence;
mod energy;
mod fit;
mod histories;
mod lapse;
mod mesh_precision;
mod motion;
mod panel;
mod structure;
mod sweep;
mod work_precision;

pub use campbell::{CampbellPoint, Sense, campbell};
pub use connectors::{Connector, ConnectorKind};
pub use convergence::convergence;
pub use energy::{EnergyRun, energy};
pub use fit::{FittedCurve, fit};
pub use histories::{History, Limit, histories};
pub use lapse::{BodyMotion, Coloured, Flight, Lapse, Motion, Patch};
pub use mesh_precision::mesh_precision;
pub use motion::{Barrier, Scenery, motion};
pub use structure::{Camera, StructureView, structure};
pub use sweep::sweep;
pub use work_precision::work_precision;
