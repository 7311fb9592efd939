//! Events in a file that change the machine during its motion.

use super::functions::Function;
use super::quantity::Quantity;
use super::windows::Edge;
use super::{Document, TerminalEvent};
use schemars::JsonSchema;
use serde::Deserialize;

/// An event that changes the machine. The bodies keep their positions; their velocities jump as by the impulses of the joints
/// that close, and the motion goes on.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Event {
    /// Remark for readers of the file.
    #[serde(rename = "description")]
    pub _description: Option<String>,
    /// When it comes, after the event before it.
    pub when: When,
    /// Names of joints, loads and drives that go off. A joint opens with its drives and the loads that act through it.
    #[serde(default)]
    pub off: Vec<String>,
    /// Names of joints, loads and drives that go on. They are off before, from the start or by an event. A joint closes where
    /// its bodies are then: its frame on its second body becomes that on its first one, and a rod keeps the distance of its
    /// ends. A drive goes on from where its joint is then.
    #[serde(default)]
    pub on: Vec<String>,
}

/// When an event comes.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum When {
    /// A quantity reaches a value.
    Reaches(Box<TerminalEvent>),
    /// At a time.
    At(At),
}

/// A time of the motion.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct At {
    /// Time since the start of the motion.
    #[schemars(extend("unit" = "s", "exclusiveMinimum" = 0))]
    pub time: Quantity,
}

impl Document {
    /// Whether a joint, load or drive is on in a phase of the motion, with `phase` events before it. What an event first puts
    /// on is off before.
    pub fn is_on(&self, name: &str, phase: usize) -> bool {
        let changes = |event: &Event| {
            let is_in = |all: &[String]| all.iter().any(|own| own == name);
            match (is_in(&event.on), is_in(&event.off)) {
                (true, _) => Some(true),
                (false, true) => Some(false),
                (false, false) => None,
            }
        };
        let mut before = self.events.values().take(phase).rev();
        let mut after = self.events.values().skip(phase);
        before
            .find_map(changes)
            .unwrap_or_else(|| after.find_map(changes) != Some(true))
    }

    /// Whether an event puts a joint, load or drive on or off.
    pub fn is_switched(&self, name: &str) -> bool {
        let mut all = self
            .events
            .values()
            .flat_map(|event| event.on.iter().chain(&event.off));
        all.any(|own| own == name)
    }

    /// The phase since which what an event has put on is on in `phase`.
    pub fn on_since(&self, name: &str, phase: usize) -> Option<usize> {
        let comes = |event: &Event| event.on.iter().any(|own| own == name);
        let mut before = self.events.values().take(phase);
        let last = before.rposition(comes).filter(|_| self.is_on(name, phase));
        last.map(|event| event + 1)
    }

    /// The phases of a motion with events, over which a function goes: from the first to the last.
    pub fn phases_of(&self, function: &Function) -> [usize; 2] {
        if let Function::EventTime(event) = function {
            return [0, self.events.get_index_of(event).unwrap_or_default()];
        }
        let [from, to] = function.window();
        let event = |edge: Option<&Edge>| self.events.get_index_of(edge?.event()?);
        [
            event(from).map_or(0, |event| event + 1),
            event(to).unwrap_or(self.events.len()),
        ]
    }

    /// The event that ends its phase; `None` if it is the last one, or no event divides the motion.
    pub fn next_event(&self) -> Option<(&String, &Event)> {
        self.events.get_index(self.phase?)
    }
}
