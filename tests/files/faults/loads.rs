//! Malformed loads.

use super::expect;

faults! {
    a_load_of_an_unknown_kind:
        r#""joints": {"# =>
        r#""loads": {"load": {"sprng": {}}}, "joints": {"#;
    a_stop_of_nothing:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"upper": 1, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_stop_of_a_joint_and_a_distance:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"joint": "crank", "between": ["rod", "ground"], "upper": 1, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_stop_without_a_limit:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"joint": "crank", "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_stop_with_crossed_limits:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"joint": "crank", "lower": 1, "upper": 0.5, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_stop_of_a_ball:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"joint": "pin", "lower": 1, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_stop_of_no_width:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"joint": "crank", "lower": 1, "stiffness": 5, "width": 0}}}, "joints": {"#;
    a_stop_of_a_root:
        r#""joints": {"# =>
        r#""loads": {"load": {"stop": {"joint": "crank", "lower": 1, "stiffness": 5, "width": 0.1, "exponent": 0.5}}}, "joints": {"#;
    a_contact_of_ground_with_a_body:
        r#""joints": {"# =>
        r#""loads": {"load": {"contact": {"between": ["ground", "rod"], "at": {"a": [0, 0, 0], "b": "tip"}, "radius": 0.1, "surface": {"plane": {"normal": [0, 0, 0]}}, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_contact_of_two_points:
        r#""joints": {"# =>
        r#""loads": {"load": {"contact": {"between": ["rod", "con_rod"], "at": {"a": "tip", "b": [0, 0, 0]}, "surface": {"sphere": {"radius": 0}}, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_contact_with_an_unknown_surface:
        r#""joints": {"# =>
        r#""loads": {"load": {"contact": {"between": ["rod", "con_rod"], "at": {"a": "tip", "b": [0, 0, 0]}, "surface": {"cone": {"radius": 0}}, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_spring_without_strength:
        r#""joints": {"# =>
        r#""loads": {"load": {"spring": {"between": ["rod", "ground"], "at": [[0, 0, 0], [1, 0, 0]], "rest_length": 1}}}, "joints": {"#;
    a_spring_with_a_short_table:
        r#""joints": {"# =>
        r#""loads": {"load": {"spring": {"between": ["rod", "ground"], "at": [[0, 0, 0], [1, 0, 0]], "rest_length": 1, "table": {"places": [0, 1, 1], "forces": [0, 1]}}}}, "joints": {"#;
    a_damper_that_drives:
        r#""joints": {"# =>
        r#""loads": {"load": {"damping": {"joint": "crank", "table": {"places": [-1, 0, 1], "forces": [1, 0, 1]}}}}, "joints": {"#;
    a_damping_table_of_a_ball:
        r#""joints": {"# =>
        r#""loads": {"load": {"damping": {"joint": "pin", "table": {"places": [-1, 1], "forces": [-1, 1]}}}}, "joints": {"#;
    a_cable_of_one_point:
        r#""joints": {"# =>
        r#""loads": {"load": {"cable": {"points": [{"body": "rod"}], "length": 1, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_cable_of_ground:
        r#""joints": {"# =>
        r#""loads": {"load": {"cable": {"points": [{"body": "ground"}, {"body": "ground", "point": [1, 0, 0]}], "length": 1, "stiffness": 5, "width": 0.1}}}, "joints": {"#;
    a_force_on_ground:
        r#""joints": {"# =>
        r#""loads": {"load": {"force": {"body": "ground", "direction": [0, 1, 0], "magnitude": 5}}}, "joints": {"#;
    a_force_without_direction:
        r#""joints": {"# =>
        r#""loads": {"load": {"force": {"body": "rod", "direction": [0, 0, 0], "magnitude": 5}}}, "joints": {"#;
    a_force_at_two_places:
        r#""joints": {"# =>
        r#""loads": {"load": {"force": {"body": "rod", "point": "tip", "at": [0, 0, 0], "direction": [0, 1, 0], "magnitude": 5}}}, "joints": {"#;
    a_force_of_words:
        r#""joints": {"# =>
        r#""loads": {"load": {"force": {"body": "rod", "direction": [0, 1, 0], "magnitude": "5 N"}}}, "joints": {"#;
    a_pressure_on_a_rigid_body:
        r#""joints": {"# =>
        r#""loads": {"load": {"pressure": {"body": "rod", "faces": "all", "pressure": 5}}}, "joints": {"#;
    a_line_load_on_ground_without_direction:
        r#""joints": {"# =>
        r#""loads": {"load": {"line": {"body": "ground", "beams": "all", "direction": [0, 0, 0], "magnitude": 5}}}, "joints": {"#;
    a_torque_of_an_unknown_course:
        r#""joints": {"# =>
        r#""loads": {"load": {"torque": {"body": "rod", "direction": [0, 0, 1], "magnitude": {"sine": 3}}}}, "joints": {"#;
    a_table_out_of_order:
        r#""joints": {"# =>
        r#""loads": {"load": {"torque": {"body": "rod", "direction": [0, 0, 1], "magnitude": {"table": {"times": [0, 2, 1], "values": [0, 1, 2]}}}}}, "joints": {"#;
    a_table_of_unequal_lists:
        r#""joints": {"# =>
        r#""loads": {"load": {"torque": {"body": "rod", "direction": [0, 0, 1], "magnitude": {"table": {"times": [0, 1], "values": [0, 1, 2]}}}}}, "joints": {"#;
    a_spring_of_a_body_to_itself:
        r#""joints": {"# =>
        r#""loads": {"load": {"spring": {"between": ["rod", "rod"], "at": {"a": "pin", "b": "tip"}, "rest_length": 1, "stiffness": 2}}}, "joints": {"#;
    a_spring_at_an_unknown_point:
        r#""joints": {"# =>
        r#""loads": {"load": {"spring": {"between": ["rod", "ground"], "at": {"a": "tap", "b": [0, 5, 0]}, "rest_length": 1, "stiffness": 2}}}, "joints": {"#;
    a_spring_whose_ends_meet:
        r#""joints": {"# =>
        r#""loads": {"load": {"spring": {"between": ["rod", "ground"], "at": {"a": "pin", "b": [0, 0, 0]}, "rest_length": 1, "stiffness": 2}}}, "joints": {"#;
    a_spring_that_pushes_more_the_longer_it_is:
        r#""joints": {"# =>
        r#""loads": {"load": {"spring": {"between": ["rod", "ground"], "at": {"a": "tip", "b": [0, 0, 0]}, "rest_length": 1, "stiffness": -2}}}, "joints": {"#;
    a_damper_in_an_unknown_joint:
        r#""joints": {"# =>
        r#""loads": {"load": {"damping": {"joint": "crnk", "coefficient": 1}}}, "joints": {"#;
    friction_in_a_spherical_joint:
        r#""joints": {"# =>
        r#""loads": {"load": {"friction": {"joint": "pin", "size": 1, "width": 0.1}}}, "joints": {"#;
    friction_without_width:
        r#""joints": {"# =>
        r#""loads": {"load": {"friction": {"joint": "crank", "size": 1, "width": 0}}}, "joints": {"#;
    a_variable_that_is_an_instant_of_a_table:
        r#""joints": {"# =>
        r#""loads": {"load": {"torque": {"body": "rod", "direction": [0, 0, 1], "magnitude": {"table": {"times": [0, 1], "values": [0, 1]}}}}}, "joints": {"#,
        r#""/bodies/rod/mass""# => r#""/loads/load/torque/magnitude/table/times/1""#;
    a_stiffness_without_a_lower_bound:
        r#""joints": {"# =>
        r#""loads": {"load": {"torsion_spring": {"joint": "crank", "stiffness": 3}}}, "joints": {"#,
        r#""/bodies/rod/mass", "lower": 1, "upper": 5"# => r#""/loads/load/torsion_spring/stiffness""#;
}
