//! Impossible starts of joints.

use super::expect;

faults! {
    a_start_without_motion:
        r#""at": "rod.tip", "axis": [0, 0, 1]"# => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {}"#;
    a_start_of_a_turn_without_angle_or_rate:
        r#""at": "rod.tip", "axis": [0, 0, 1]"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {}}"#;
    a_start_of_a_slide_that_the_joint_bars:
        r#""at": "rod.tip", "axis": [0, 0, 1]"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"slide": {"rate": 2}}"#;
    a_start_of_a_turn_that_the_joint_bars:
        r#"{"revolute":"# => r#"{"prismatic":"#,
        r#""at": "rod.tip", "axis": [0, 0, 1]"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"rate": 2}}"#;
    a_start_of_a_driven_joint:
        r#""at": "rod.tip", "axis": [0, 0, 1]}}
  },"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"rate": 2}}}}
  },
  "drives": {"motor": {"joint": "crank", "turn": {"rate": 3}}},"#;
    a_start_of_a_ball_joint:
        r#""at": "rod.pin"}}"# => r#""at": "rod.pin", "start": {"turn": {"rate": 2}}}}"#;
    a_start_of_words:
        r#""at": "rod.tip", "axis": [0, 0, 1]"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"rate": "2 rad/s"}}"#;
    a_start_that_is_not_finite:
        r#""at": "rod.tip", "axis": [0, 0, 1]"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"rate": 1e60}}"#;
    a_displacement_of_a_turn:
        r#""at": "rod.tip", "axis": [0, 0, 1]"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"displacement": 1}}"#;
    two_starts_of_one_freedom:
        r#""at": "rod.tip", "axis": [0, 0, 1]}}"#
        => r#""at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"angle": 1}}}},
    "hinge": {"revolute": {"between": ["con_rod", "rod"], "at": "rod.tip", "axis": [0, 0, 1], "start": {"turn": {"angle": 2}}}}"#;
}
