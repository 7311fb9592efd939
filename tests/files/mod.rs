//! Contents of files: problems, records, figures, documents, and the layers of the source.

mod beam_scenes;
mod beams;
mod benchmarks;
mod circles;
mod element_parts;
mod equilibrium;
mod faults;
mod finite_elements;
mod flexible_families;
mod flexible_scenes;
mod layers;
mod modal;
mod modal_faults;
mod modal_scenes;
mod problems_check;
mod readme;
mod reduced_shells;
mod report_plots;
mod report_records;
mod second_order;
mod shell_pictures;
mod stability;
mod static_faults;
mod statics;
mod thickness_sheet;
mod trebuchets;
