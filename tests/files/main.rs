//! Contents of files: problems, records, figures, documents, and the layers of the source.

#[macro_use]
#[path = "../reference/json.rs"]
mod json;
#[path = "../reference/mod.rs"]
mod reference;

mod aggregates;
mod at_rest;
mod axes_of_beams;
mod beam_scenes;
mod beams;
mod benchmarks;
mod buckling;
mod cases;
mod circles;
mod committed_problems;
mod damped_modes;
mod distributed_loads;
pub mod element_parts;
mod element_sections;
mod element_starts;
mod element_steps;
mod equilibrium;
mod expressions;
mod fatigue;
mod faults;
pub mod finite_elements;
mod fits;
mod fixed_steps;
mod flexible_families;
mod flexible_scenes;
mod four_nodes;
mod function_expressions;
mod gmsh;
mod held_edges;
mod last_modes;
mod lateral;
mod layers;
mod machines_at_rest;
mod modal;
mod modal_faults;
mod modal_scenes;
mod orientations;
mod parts;
mod problems_check;
mod readme;
mod reduced_shells;
mod relative_equilibrium;
mod report_plots;
mod report_records;
mod second_order;
mod shell_hinges;
mod shell_pictures;
mod smoothed;
mod stability;
mod static_faults;
mod statics;
mod stationary;
mod steady_rotation;
mod stl;
mod stress_per_thickness;
mod stress_pictures;
mod thickness_sheet;
mod trebuchets;
mod unfollowed;
mod vibrations_at_rest;
mod windows;
