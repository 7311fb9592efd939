//! Cross sections of beams as they are written in a file.

use crate::quantity::Quantity;
use schemars::JsonSchema;
use serde::Deserialize;

/// A cross section by its sizes, or by given stiffnesses `G`. In structures axis 2 lies in the plane of beam
/// and orientation, and axis 3 is normal to both; in the axes of a moving beam axis 2 is z and axis 3 is y.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Section<G> {
    /// A rectangle.
    Rectangle {
        /// Size along axis 2; z of a moving beam.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        width: Quantity,
        /// Size along axis 3; y of a moving beam.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        height: Quantity,
    },
    /// A round tube; a solid bar if the wall is the radius.
    Tube {
        /// Outer radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
        /// Thickness of the wall, not above the radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        wall: Quantity,
    },
    /// An I of thin walls, the web along axis 3; y of a moving beam.
    I {
        /// Width of the flanges.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        width: Quantity,
        /// Whole height.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        height: Quantity,
        /// Thickness of a flange, not above half the height.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        flange: Quantity,
        /// Thickness of the web, not above the width.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        web: Quantity,
    },
    /// Given stiffnesses and masses; such a beam has no stresses.
    Given(G),
}
