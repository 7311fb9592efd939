//! What is in files: problems, records, figures, documents, and the layers of the source.

#[path = "../reference/mod.rs"]
mod reference;

mod benchmarks;
mod circles;
mod faults;
mod layers;
mod problems_check;
mod readme;
mod report_plots;
mod report_records;
mod stability;
mod trebuchets;
