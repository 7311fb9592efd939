//! Figures as SVG texts, pure functions of data.
//!
//! Pictures are white. Their colours are distinct for any colour vision, legends are outside the
//! data. The same data give the same bytes.

mod axis;
mod canvas;
mod colours;
mod connectors;
mod convergence;
mod energy;
mod histories;
mod lapse;
mod mesh_precision;
mod motion;
mod panel;
mod structure;
mod sweep;
mod work_precision;

pub(crate) use connectors::{Connector, ConnectorKind};
pub(crate) use convergence::convergence;
pub(crate) use energy::{EnergyRun, energy};
pub(crate) use histories::{History, Limit, histories};
pub(crate) use lapse::{BodyMotion, Coloured, Flight, Motion, Patch};
pub(crate) use mesh_precision::mesh_precision;
pub(crate) use motion::{Barrier, Scenery, motion};
pub(crate) use structure::{Camera, StructureView, structure};
pub(crate) use sweep::sweep;
pub(crate) use work_precision::work_precision;
