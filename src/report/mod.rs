//! Results of a run: records, their comparison, figures and the final text.
//!
//! All contents are pure functions of plain `f64` data, so the figures can be redrawn from the
//! record. Only [`files`], [`evaluations`] and [`HistoryLog`] access the disk.
//!
//! | File | Content |
//! |---|---|
//! | [`files`] | files written whole or not at all |
//! | [`evaluations`] | every evaluation, `evaluations.jsonl` |
//! | [`explain`] | the reductions of a scene and the reduced scene |
//! | [`history`] | the iterations of an optimisation, `history.csv` |
//! | [`optima`] | the distinct optima of several starts, `optima.csv` |
//! | [`sweep`] | the optima for several values of a parameter, `sweep.csv` |
//! | [`optimum`] | the end of an optimisation, `optimum.json` |
//! | [`certificate`] | the check of an optimisation's gradients |
//! | [`mod@compare`] | an optimum against a committed baseline |
//! | [`mod@summary`] | the final text for the user |
//! | [`positions`] | tables of reference positions |
//! | [`work_precision`] | error against run time, `work_precision.csv` and `orders.csv` |
//! | [`mesh_precision`] | error of structures against run time and mesh, `work_precision.csv` |
//! | [`vtu`] | fields of structures, `fields.vtu` |
//! | [`stability`] | the stability table, `stability.md` and `stability.csv` |
//! | [`plots`] | figures as SVG |

pub(crate) mod certificate;
pub(crate) mod compare;
mod csv;
mod error;
pub(crate) mod evaluations;
pub(crate) mod explain;
pub(crate) mod files;
pub(crate) mod history;
mod history_log;
pub(crate) mod mesh_precision;
mod number;
pub(crate) mod optima;
pub(crate) mod optimum;
pub(crate) mod page;
pub(crate) mod plots;
pub(crate) mod positions;
pub(crate) mod stability;
pub(crate) mod summary;
pub(crate) mod sweep;
mod table;
pub(crate) mod vtu;
pub(crate) mod work_precision;

pub(crate) use compare::{Tolerances, compare};
pub(crate) use csv::csv_table;
pub(crate) use error::ReportError;
pub(crate) use explain::{Explanation, FunctionUse, IntegrationUse, LinearUse, SystemSize, size};
pub(crate) use files::{atomic_write, path_between, prepare_directory, read_text, write_all};
pub(crate) use history::{History, HistoryRow};
pub(crate) use history_log::HistoryLog;
pub(crate) use mesh_precision::{MeshRow, PrecisionOfMesh};
pub(crate) use number::with_space;
pub(crate) use optima::{FoundOptimum, optima_csv};
pub(crate) use optimum::Optimum;
pub(crate) use stability::{StabilityFamily, StabilityOutcome, StabilityRow, StabilityTable};
pub(crate) use summary::summary;
pub(crate) use sweep::{Sweep, SweptOptimum};
pub(crate) use work_precision::{PrecisionRow, WorkPrecision};
