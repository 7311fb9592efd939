//! Windows of time, and reductions over them, in a file.

use super::instants::Instant;
use crate::quantity::Quantity;
use schemars::JsonSchema;
use serde::Deserialize;

/// A quantity, over the whole run or a window of time: the quantity alone, or with `during`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Over {
    /// With a window.
    Within(Box<Within>),
    /// Over the whole run.
    Whole(Box<Instant>),
}

/// A quantity and a window of time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Within {
    /// The quantity.
    pub of: Instant,
    /// The window, default the whole run.
    pub during: Option<During>,
}

impl Over {
    /// The quantity.
    pub fn of(&self) -> &Instant {
        match self {
            Self::Within(within) => &within.of,
            Self::Whole(instant) => instant,
        }
    }

    /// The window, if there is one.
    pub fn during(&self) -> Option<&During> {
        match self {
            Self::Within(within) => within.during.as_ref(),
            Self::Whole(_) => None,
        }
    }
}

/// A smooth mean of absolute values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MeanAbsolute {
    /// Width w of the rounded corner at zero: √(x² + w²) − w instead of |x|, at most w below it.
    #[schemars(extend(
        "unit" = "unit of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "a width says what is asked, not what is built"
    ))]
    pub width: f64,
    /// The quantity.
    pub of: Instant,
    /// The window, default the whole run.
    pub during: Option<During>,
}

/// Damage of a stress over time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FatigueDamage {
    /// Slope m of Basquin's law N = (strength/amplitude)^m: about 3 for welds, 5 to 15 for machined steel.
    #[schemars(extend(
        "unit" = "1",
        "minimum" = 2,
        "maximum" = 50,
        "design_variable" = "a slope says what is asked, not what is built"
    ))]
    pub slope: f64,
    /// Amplitude that one cycle endures: the fatigue strength coefficient, or the amplitude endured N times times N^(1/m).
    #[schemars(extend(
        "unit" = "unit of the quantity",
        "exclusiveMinimum" = 0,
        "design_variable" = "a strength of a law says what is asked, not what is built"
    ))]
    pub strength: f64,
    /// The stress, or another quantity whose cycles do damage.
    pub of: Instant,
    /// The window, default the whole run.
    pub during: Option<During>,
}

/// A quantity at a time.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ValueAt {
    /// The time, the first time at which a quantity reaches a value, or an event.
    pub at: Edge,
    /// The quantity.
    pub of: Instant,
}

/// A window of time: `[start, end]`, or `{"from": …, "to": …}`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum During {
    /// Start and end.
    Times(#[schemars(extend("unit" = "s"))] [Quantity; 2]),
    /// Each end by itself.
    Between(Box<WindowEnds>),
}

/// The ends of a window.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct WindowEnds {
    /// Its start, default the start of the motion.
    pub from: Option<Edge>,
    /// Its end, default the end of the motion.
    pub to: Option<Edge>,
}

/// A time, the first time at which a quantity reaches a value, or an event that changes the machine.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Edge {
    /// A time.
    Time(#[schemars(extend("unit" = "s"))] Quantity),
    /// The first time at which a quantity reaches a value.
    When(Box<Reach>),
    /// When an event comes.
    Event(AtEvent),
}

/// An event of the file. A window ends just before it or starts just after it, and a value is that just before it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AtEvent {
    /// Its name.
    pub event: String,
}

impl Edge {
    /// The event, if it is one.
    pub fn event(&self) -> Option<&str> {
        match self {
            Self::Event(own) => Some(&own.event),
            Self::Time(_) | Self::When(_) => None,
        }
    }
}

/// A quantity reaches a value: give one of `reaches`, `rises_to` and `falls_to`.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reach {
    /// The quantity.
    pub when: Instant,
    /// The value, which the quantity must cross upwards or downwards.
    #[schemars(extend("unit" = "that of the quantity"))]
    pub reaches: Option<Quantity>,
    /// The value, which the quantity must cross upwards.
    #[schemars(extend("unit" = "that of the quantity"))]
    pub rises_to: Option<Quantity>,
    /// The value, which the quantity must cross downwards.
    #[schemars(extend("unit" = "that of the quantity"))]
    pub falls_to: Option<Quantity>,
}

impl Reach {
    /// The values that are given, each with the direction of the crossing.
    pub fn values(&self) -> Vec<(Quantity, Option<bool>)> {
        let all = [
            (self.reaches, None),
            (self.rises_to, Some(true)),
            (self.falls_to, Some(false)),
        ];
        let given = all.into_iter();
        given
            .filter_map(|(value, rises)| Some((value?, rises)))
            .collect()
    }
}
