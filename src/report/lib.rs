//! Results of a run: records, their comparison and the final text.
//!
//! All contents are pure functions of plain `f64` data. Only [`files`], [`evaluations`] and [`HistoryLog`] access the disk.
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
//! | [`stability`] | the stability table, `stability.md` and `stability.csv` |

pub mod certificate;
pub mod compare;
mod csv;
mod error;
pub mod evaluations;
pub mod explain;
pub mod files;
pub mod fit;
mod fit_text;
pub mod history;
mod history_log;
pub mod mesh_precision;
pub mod number;
pub mod optima;
pub mod optimum;
pub mod positions;
pub mod stability;
pub mod summary;
pub mod sweep;
mod table;
pub mod work_precision;

use flexbody_mechanics::{integrate, system};
use flexbody_problem as problem;

pub use compare::{Tolerances, compare};
pub use csv::csv_table;
pub use error::ReportError;
pub use explain::{Explanation, FunctionUse, IntegrationUse, LinearUse, SystemSize, size};
pub use files::{atomic_write, path_between, prepare_directory, read_text, write_all};
pub use history::{History, HistoryRow};
pub use history_log::HistoryLog;
pub use mesh_precision::{MeshRow, PrecisionOfMesh};
pub use number::with_space;
pub use optima::{FoundOptimum, optima_csv};
pub use optimum::Optimum;
pub use stability::{StabilityFamily, StabilityOutcome, StabilityRow, StabilityTable};
pub use summary::summary;
pub use sweep::{Sweep, SweptOptimum};
pub use work_precision::{PrecisionRow, WorkPrecision};
