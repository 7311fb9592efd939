//! Tables of the modes of a machine, as text and in the result of `optimize simulate --json`.

use crate::driver::modes::ToldModes;
use crate::driver::start::not_stable;
use crate::system::equilibrium::{MachineMode, MachineModes, Whirl};
use serde_json::{Map, Value, json};
use std::fmt::Write;

fn name(whirl: Whirl) -> &'static str {
    match whirl {
        Whirl::Forward => "forward",
        Whirl::Backward => "backward",
    }
}

/// The modes in lines, with their whirl if the machine turns.
pub(super) fn text(told: &ToldModes) -> String {
    let mut text = String::new();
    let mut table = |title: String, own: &MachineModes, turns: bool| {
        let _ = writeln!(text, "  {title}");
        let fixed = if turns {
            "  whirl     in the fixed frame [Hz]"
        } else {
            ""
        };
        let _ = writeln!(text, "  mode   frequency [Hz]   damping ratio{fixed}");
        for (k, mode) in own.modes.iter().enumerate() {
            let whirl = match mode.whirl {
                Some((whirl, frequency)) => format!("  {:8}  {frequency:.9e}", name(whirl)),
                None => String::new(),
            };
            let _ = writeln!(
                text,
                "  {:>4}  {:>15.9e}  {:>14.6e}{whirl}",
                k + 1,
                mode.frequency,
                damping(mode)
            );
        }
        if let Some(rate) = own.growth {
            let _ = writeln!(text, "  {}", not_stable(rate));
        }
    };
    match told.speed {
        None => table("modes about rest".to_owned(), &told.modes, false),
        Some(speed) => {
            let title = format!("modes at {speed} rad/s, in the turning frame");
            table(title, &told.modes, true);
        }
    }
    for (speed, modes) in &told.diagram {
        table(format!("at {speed} rad/s"), modes, true);
    }
    text
}

/// Round-off of damping ratios.
const ROUND_OFF: f64 = 1e-12;

/// The damping ratio of a mode; zero if it is round-off.
fn damping(mode: &MachineMode) -> f64 {
    if mode.damping_ratio.abs() < ROUND_OFF {
        0.0
    } else {
        mode.damping_ratio
    }
}

/// The same in full precision: keys of the result.
pub(super) fn json(told: &ToldModes) -> Map<String, Value> {
    let one = |mode: &MachineMode| {
        let mut own = json!({"frequency": mode.frequency, "damping_ratio": damping(mode)});
        if let Some((whirl, frequency)) = mode.whirl {
            own["whirl"] = json!(name(whirl));
            own["fixed_frame_frequency"] = json!(frequency);
        }
        own
    };
    let at = |speed: Option<f64>, own: &MachineModes| {
        let mut all = Map::new();
        if let Some(speed) = speed {
            all.insert("speed".to_owned(), json!(speed));
        }
        let list: Vec<Value> = own.modes.iter().map(one).collect();
        all.insert("modes".to_owned(), json!(list));
        if let Some(rate) = own.growth {
            all.insert("growth".to_owned(), json!(rate));
        }
        all
    };
    let mut all = at(told.speed, &told.modes);
    if !told.diagram.is_empty() {
        let diagram = told.diagram.iter();
        let diagram: Vec<Map<String, Value>> = diagram
            .map(|(speed, modes)| at(Some(*speed), modes))
            .collect();
        all.insert("campbell".to_owned(), json!(diagram));
    }
    all
}
