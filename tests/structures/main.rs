//! Structures of shells and beams: elements, statics, modes, functions and their derivatives.

mod beam_derivatives;
mod beams;
mod beams_in_structures;
mod course;
mod craig_bampton;
mod function_gradients;
mod lateral_buckling;
mod lateral_modal;
mod mesh_faults;
mod modal_beams;
mod mode_gradients;
mod modes;
mod obstacle_course;
mod patch_tests;
mod plate_stress;
mod reactions;
mod sample;
mod shell_derivatives;
mod shell_element;
mod shell_plate;
mod sizes;
mod supports;
mod turned;
mod von_karman;
