//! Malformed beams, and what is measured of joints, springs and sections.

use super::expect;

faults! {
    a_beam_of_no_length:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 0, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    a_beam_without_a_section:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    a_beam_without_functions:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}, "modes": {"bending_y": 0, "bending_z": 0, "torsion": 0, "stretch": 0}}}, "con_rod": {"##;
    a_beam_without_material:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}}}, "con_rod": {"##;
    a_beam_without_density:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11}}}, "con_rod": {"##;
    a_beam_of_negative_stiffness:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": -2e11, "density": 7800}}}, "con_rod": {"##;
    a_beam_of_negative_damping:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}, "damping": {"ratio": -0.02}}}, "con_rod": {"##;
    a_tube_of_more_wall_than_radius:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.2}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    an_i_filled_by_its_flanges:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"i": {"width": 0.1, "height": 0.1, "flange": 0.06, "web": 0.2}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    a_given_section_of_half_its_stiffnesses:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"given": {"mass": 1, "inertia_y": 0, "inertia_z": 0, "ea": 1e6, "ei_z": 100}}}}, "con_rod": {"##;
    sines_with_large_strains:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}, "functions": "sine"}}, "con_rod": {"##;
    a_station_beyond_the_end:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}, "stations": {"far": 1.5}}}, "con_rod": {"##;
    a_beam_start_of_three_coordinates:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}, "start": {"coordinates": [0, 1, 2]}}}, "con_rod": {"##;
    a_joint_start_beside_a_bent_beam:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}, "modes": {"bending_y": 1, "bending_z": 0, "torsion": 0, "stretch": 0}, "start": {"coordinates": [0.1]}}}, "con_rod": {"##,
        r#""at": "rod.tip", "axis": [0, 0, 1]"# => r##""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"angle": 1}}"##;
    a_beam_beside_a_mass:
        r#""con_rod": {"# => r##""bar": {"mass": 3, "beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    a_torque_on_a_beam_as_a_whole:
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##,
        r#""joints": {"# => r##""loads": {"load": {"torque": {"body": "bar", "direction": [0, 0, 1], "magnitude": 5}}}, "joints": {"##;
    a_torque_at_a_point_of_a_rigid_body:
        r#""joints": {"# => r##""loads": {"load": {"torque": {"body": "rod", "point": "tip", "direction": [0, 0, 1], "magnitude": 5}}}, "joints": {"##;
    a_stress_of_a_rigid_body:
        r#""functions": {"# => r##""functions": {"own": {"final": {"fibre_stress": {"body": "rod", "station": "end", "fibre": [1, 0]}}},"##;
    stresses_of_one_section:
        r#""functions": {"# => r##""functions": {"own": {"final": {"largest_fibre_stress": {"body": "bar", "stations": 1, "rho": 1e-6}}},"##,
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    stresses_of_no_section:
        r#""functions": {"# => r##""functions": {"own": {"final": {"largest_fibre_stress": {"body": "bar", "stations": [], "fibres": [], "rho": 1e-6}}},"##,
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    stresses_beyond_the_end:
        r#""functions": {"# => r##""functions": {"own": {"final": {"largest_fibre_stress": {"body": "bar", "stations": [0, 2, "midle"], "fibres": [[1, 0], [0, 3]], "rho": 1e-6}}},"##,
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    forces_without_sharpness:
        r#""functions": {"# => r##""functions": {"own": {"final": {"largest_section_force": {"body": "bar", "stations": 5, "component": "axial", "rho": 0}}},"##,
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    a_force_of_an_unknown_component:
        r#""functions": {"# => r##""functions": {"own": {"final": {"largest_section_force": {"body": "bar", "stations": 5, "component": "bendng_y", "rho": 1}}},"##,
        r#""con_rod": {"# => r##""bar": {"beam": {"length": 1, "section": {"tube": {"radius": 0.1, "wall": 0.01}}, "material": {"young": 2e11, "density": 7800}}}, "con_rod": {"##;
    a_reaction_of_an_unknown_joint:
        r#""functions": {"# => r##""functions": {"own": {"final": {"joint_force": {"joint": "crnk", "direction": [1, 0, 0]}}},"##;
    a_reaction_on_another_body:
        r#""functions": {"# => r##""functions": {"own": {"final": {"joint_moment": {"joint": "pin", "on": "con_rod", "direction": [1, 0, 0]}}},"##;
    a_reaction_without_direction:
        r#""functions": {"# => r##""functions": {"own": {"final": {"joint_moment": {"joint": "pin", "direction": [0, 0, 0]}}},"##;
    a_reaction_in_the_axes_of_a_body:
        r#""functions": {"# => r##""functions": {"own": {"final": {"joint_force": {"joint": "pin", "direction": [1, 0, 0], "axes": "rod"}}},"##;
    a_slide_of_a_hinge:
        r#""functions": {"# => r##""functions": {"own": {"final": {"slide": {"joint": "crank"}}},"##;
    a_length_of_no_spring:
        r#""functions": {"# => r##""functions": {"own": {"final": {"spring_length": {"load": "sping"}}},"##;
    an_angular_momentum_without_direction:
        r#""functions": {"# => r##""functions": {"own": {"final": {"angular_momentum": {"direction": [0, 0, 0]}}},"##;
}
