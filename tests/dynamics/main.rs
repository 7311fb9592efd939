//! Equations of motion, their integration and their derivatives.

#[macro_use]
#[path = "../reference/json.rs"]
mod json;
#[path = "../reference/numbers.rs"]
mod numbers;
#[path = "../reference/mod.rs"]
mod reference;

mod aerodynamics;
mod allocations;
mod bearings;
mod boxes_and_wheels;
mod bushings;
mod cables;
mod cams;
mod capsules;
mod checkpoints;
mod closing_joints;
mod conserves;
mod constraint_derivatives;
mod contacts;
mod counted_turns;
mod couplings;
mod dead_points;
mod distributed_loads;
mod drive_gradients;
mod drives_that_hit;
mod drops;
mod element_parts;
mod elimination;
mod ends_that_meet;
mod energy_is_kept;
mod error_estimate;
mod events;
mod finite_elements;
mod flexible_derivatives;
mod flexible_gradients;
mod flexible_motion;
mod force_tables;
mod gradients_converge_to_references;
mod gradients_match_complex_step;
mod height_fields;
mod histories;
mod initial_conditions;
mod joint_starts;
mod joint_starts_in_loops;
mod joints_and_drives;
mod kinks;
mod krylov_solver;
mod limits_of_rounding;
mod load_derivatives;
mod loads;
mod lowering;
mod many_contacts;
mod massless;
mod methods_match_references;
mod newton_krylov;
mod node_kinematics;
mod phases;
mod phases_of_machines;
mod planar_joints;
mod reaction_functions;
mod reactions_carry_weight;
mod reduced_shells;
mod redundant_joints;
mod resampling;
mod rotating_plates;
mod rounded_joints;
mod side_by_side;
mod singular_positions;
mod steps_in_use;
mod stops;
mod stribeck;
mod turned_factors;
mod windows;
mod work_of_gradients;
