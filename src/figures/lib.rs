//! What is drawn and written of a motion or of structures: figures, the page of a result, fields and
//! tables.
//!
//! | File | Content |
//! |---|---|
//! | [`of_simulation`], [`of_phases`], [`of_optimisation`] | the figures of a run |
//! | [`report_page`] | the page of a run, `report.html` |
//! | [`shell_fields`], [`statics`] | fields for ParaView, figures of structures |
//! | [`tables`] | a motion at every instant, as comma separated values |
//! | [`plots`] | figures as SVG, pure functions of plain data |
//! | [`page`] | a page of HTML, a pure function of plain data |
//! | [`vtu`] | a file of fields, a pure function of plain data |

mod connectors;
mod constraints;
mod detail;
pub mod elastic_figures;
mod error;
mod files;
mod fits;
mod flight;
mod forces;
mod machine_modes;
mod outlines;
pub mod page;
mod phases;
pub mod plots;
pub mod report_page;
mod shapes;
pub mod shell_fields;
mod shells;
pub mod statics;
pub mod tables;
pub mod traces;
pub mod vtu;

use flexbody_driver as driver;
use flexbody_mathematics::math;
use flexbody_mechanics::{functions, integrate, model, structures, system};
use flexbody_problem as problem;
use flexbody_report as report;

pub use error::FigureError;
pub use files::{NAMES, NamedFile, of_designs, of_ends, of_optimisation, of_phases, of_simulation};
