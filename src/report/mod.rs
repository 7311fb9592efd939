//! What a run leaves behind: records, their comparison, figures and the text at the end.
//!
//! Everything here is a pure function of plain `f64` data, so that the figures can be redrawn
//! from the record; only [`files`], [`evaluations`] and [`HistoryLog`] touch the disk.
//!
//! | File | Content |
//! |---|---|
//! | [`files`] | files written whole or not at all |
//! | [`evaluations`] | every evaluation, `evaluations.jsonl` |
//! | [`explain`] | what is left out of a scene and what is left |
//! | [`history`] | the iterations of an optimisation, `history.csv` |
//! | [`optima`] | the distinct optima of several starts, `optima.csv` |
//! | [`optimum`] | the end of an optimisation, `optimum.json` |
//! | [`certificate`] | the check of the gradients that an optimisation went by |
//! | [`mod@compare`] | an optimum against a committed baseline |
//! | [`mod@summary`] | the text that a person reads at the end |
//! | [`positions`] | tables of reference positions |
//! | [`work_precision`] | error against run time, `work_precision.csv` and `orders.csv` |
//! | [`stability`] | the stability table, `stability.md` and `stability.csv` |
//! | [`plots`] | figures as SVG |

pub mod certificate;
pub mod compare;
mod csv;
mod error;
pub mod evaluations;
pub mod explain;
pub mod files;
pub mod history;
mod number;
pub mod optima;
pub mod optimum;
pub mod plots;
pub mod positions;
pub mod stability;
pub mod summary;
mod table;
pub mod work_precision;

pub use compare::{Tolerances, compare};
pub use csv::csv_table;
pub use error::ReportError;
pub use explain::{Explanation, FunctionUse, IntegrationUse, SystemSize, size};
pub use files::{atomic_write, prepare_directory, read_text, write_all};
pub use history::{History, HistoryLog, HistoryRow};
pub use optima::{FoundOptimum, optima_csv};
pub use optimum::Optimum;
pub use stability::{StabilityFamily, StabilityOutcome, StabilityRow, StabilityTable};
pub use summary::summary;
pub use work_precision::{PrecisionRow, WorkPrecision};
