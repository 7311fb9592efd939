//! Malformed bodies from files of other codes. Their files lie in `tests/data/modal`.

use super::expect;

faults! {
    a_modal_body_without_interfaces:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}}}, "con_rod": {"##;
    a_modal_body_of_an_unknown_frame:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1, "end": 21}, "frame": {"clamped": "strat"}}}, "con_rod": {"##;
    a_modal_body_held_by_a_line:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1, "middle": 12, "end": 21}, "frame": {"chord": ["start", "middle", "end"]}}}, "con_rod": {"##;
    a_modal_body_of_an_unknown_node:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1, "end": 210}}}, "con_rod": {"##;
    a_modal_body_of_a_node_in_two_interfaces:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1, "end": [21, 1]}}}, "con_rod": {"##;
    a_modal_body_of_no_file:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"dmig": {"nodes": "tests/data/modal/beam.nodes", "file": "tests/data/modal/beam.pch"}}, "interfaces": {"start": 1}}}, "con_rod": {"##;
    a_modal_body_of_a_file_of_another_kind:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"dmig": {"nodes": "tests/data/modal/beam.nodes", "file": "tests/data/modal/beam_k.mtx"}}, "interfaces": {"start": 1}}}, "con_rod": {"##;
    a_modal_body_of_too_few_rows:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/two.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1}}}, "con_rod": {"##;
    a_modal_body_of_exchanged_matrices:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_m.mtx", "mass": "tests/data/modal/beam_k.mtx"}}, "interfaces": {"start": 1}}}, "con_rod": {"##;
    a_modal_body_beside_a_shape:
        r#""con_rod": {"# => r##""bar": {"shape": {"box": {"size": [1, 1, 1]}}, "modal": {"source": {"standard_input": "bar.json"}, "modes": 3}}, "con_rod": {"##;
    a_torque_on_a_modal_body_as_a_whole:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1, "end": 21}}}, "con_rod": {"##,
        r#""joints": {"# => r##""loads": {"load": {"torque": {"body": "bar", "direction": [0, 0, 1], "magnitude": 5}}}, "joints": {"##;
    a_joint_start_beside_a_bent_modal_body:
        r#""con_rod": {"# => r##""bar": {"modal": {"source": {"matrix_market": {"nodes": "tests/data/modal/beam.nodes", "stiffness": "tests/data/modal/beam_k.mtx", "mass": "tests/data/modal/beam_m.mtx"}}, "interfaces": {"start": 1, "end": 21}, "modes": 0, "start": {"coordinates": [1, 0, 0, 0, 0, 0]}}}, "con_rod": {"##,
        r#""at": "rod.tip", "axis": [0, 0, 1]"# => r##""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"angle": 1}}"##;
}
