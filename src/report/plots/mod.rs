//! Figures as SVG texts, pure functions of data.
//!
//! Pictures are white, their colours can be told apart with any colour vision, legends stand
//! beside the data. The same data give the same bytes.

mod axis;
mod canvas;
mod connectors;
mod convergence;
mod energy;
mod motion;
mod panel;
mod work_precision;

pub use connectors::{Connector, ConnectorKind};
pub use convergence::convergence;
pub use energy::{EnergyRun, energy};
pub use motion::{Barrier, BodyMotion, Flight, Motion, Scenery, motion};
pub use work_precision::work_precision;
