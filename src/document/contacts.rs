//! Contacts: what touches, what it touches, and how.

use super::joints::Ends;
use crate::quantity::{Quantity, Vector, nothing};
use schemars::JsonSchema;
use serde::Deserialize;

/// A contact of a sphere, point, wheel or capsule of the first body with a surface of the second: the normal force of a stop, and friction
/// μ N v_t / √(v_t² + w²) against the tangential velocity v_t.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Contact {
    /// The body with the sphere or point, and the body with the surface, which may be "ground".
    pub between: [String; 2],
    /// Centre of the sphere on the first; on the second a point of the plane, or the centre of its surface.
    pub at: Ends,
    /// Radius of the sphere, default 0: a point.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "m", "minimum" = 0))]
    pub radius: Quantity,
    /// Of a wheel on a plane or height field: the circle of the centres, about `at`, of the spheres that are its tyre.
    pub wheel: Option<Wheel>,
    /// Of a capsule: from its centre `at` to the centre of the sphere at one end, in ground axes at the start and fixed in the body.
    /// Planes and height fields are touched by spheres along its axis; spheres, capsules and boxes where the axis is nearest.
    #[schemars(extend("unit" = "m"))]
    pub half: Option<Vector>,
    /// How many equal spheres along the axis of a capsule touch a plane or height field; n of them have 2/n of the stiffness each. Default
    /// 2 on a plane, its ends; on a height field so many that they are no further apart than the radius.
    #[schemars(extend(
        "unit" = "1",
        "minimum" = 2,
        "maximum" = 1000,
        "design_variable" = "a number of spheres is a count, not a physical number"
    ))]
    pub spheres: Option<usize>,
    /// Surface of the second body.
    pub surface: Surface,
    /// Names of the materials of the first body and of the second at the contact, in place of the stiffness: that of Hertz, for spheres on
    /// planes and spheres.
    pub materials: Option<[String; 2]>,
    /// Stiffness k: force per penetration, to the power of the exponent if there is one.
    #[schemars(extend("unit" = "N/m", "exclusiveMinimum" = 0))]
    pub stiffness: Option<Quantity>,
    /// Dissipation c: at small speeds v of impact the rebound has 1 − c v of it; default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "s/m", "minimum" = 0))]
    pub dissipation: Quantity,
    /// Width w of the onset, from w/2 before touching to w/2 behind it. A smaller width is sharper and needs finer steps.
    /// Needed with a stiffness; with materials the default is 1e-5 of the radius of Hertz.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub width: Option<Quantity>,
    /// Exponent n of the penetration, default 1, or 1.5 of Hertz with materials.
    #[schemars(extend(
        "unit" = "1",
        "minimum" = 1,
        "design_variable" = "the exponent says which law the numbers of a contact have"
    ))]
    pub exponent: Option<f64>,
    /// Friction, default none.
    pub friction: Option<ContactFriction>,
}

/// A wheel: a torus.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Wheel {
    /// Its axis, of any length but zero, in ground axes at the start and fixed in the body.
    #[schemars(extend("unit" = "1"))]
    pub axis: Vector,
    /// Radius of the circle; that of the whole wheel is larger by the `radius` of the contact.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub radius: Quantity,
}

/// Friction of a contact.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ContactFriction {
    /// Coefficient of friction μ.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub coefficient: Quantity,
    /// Tangential velocity w at which 71 % of it acts. Below it the contact creeps instead of sticking. A smaller width is
    /// sharper and needs finer steps.
    #[schemars(extend("unit" = "m/s", "exclusiveMinimum" = 0))]
    pub width: Quantity,
    /// Friction that is larger at slow slip, default none.
    pub stribeck: Option<Stribeck>,
}

/// Friction that falls from a static to a sliding coefficient: μ + (μ_s − μ) exp(−v_t²/v_s²).
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Stribeck {
    /// Coefficient μ_s without slip.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub coefficient: Quantity,
    /// Velocity v_s at which 63 % of the difference is gone. It should be several times the `width` of the friction.
    #[schemars(extend("unit" = "m/s", "exclusiveMinimum" = 0))]
    pub speed: Quantity,
}

/// Surface of a contact. Directions are in ground axes at the start and fixed in the body.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Surface {
    /// A plane.
    Plane {
        /// Normal to the free side, of any length but zero.
        #[schemars(extend("unit" = "1"))]
        normal: Vector,
    },
    /// A sphere.
    Sphere {
        /// Its radius; 0 is a point.
        #[schemars(extend("unit" = "m", "minimum" = 0))]
        radius: Quantity,
    },
    /// A cylinder with round ends.
    Capsule {
        /// From its centre to the centre of the sphere at one end.
        #[schemars(extend("unit" = "m"))]
        half: Vector,
        /// Its radius.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        radius: Quantity,
    },
    /// A box along the axes of its body, those of ground if it is ground's.
    Box {
        /// Its edges.
        #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
        size: [Quantity; 3],
        /// Radius of its edges, default 0: sharp ones. It is within `size`.
        #[serde(default = "nothing")]
        #[schemars(extend("unit" = "m", "minimum" = 0))]
        radius: Quantity,
    },
    /// Heights over a plane: a natural bicubic spline through the points of a grid, which goes on straight beyond its edges. `at` is the
    /// origin of the grid.
    HeightField(HeightField),
}

/// Heights over a plane.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct HeightField {
    /// Direction of the heights, to the free side, of any length but zero.
    #[schemars(extend("unit" = "1"))]
    pub normal: Vector,
    /// Direction of `along`; what it has along `normal` is left out. The places `across` are along `normal` × `direction`.
    #[schemars(extend("unit" = "1"))]
    pub direction: Vector,
    /// Places of the columns of points, from `at`; they increase.
    #[schemars(extend("unit" = "m", "design_variable" = "the grid is that of the heights"))]
    pub along: Vec<f64>,
    /// Places of the rows; default one row, which is the same everywhere across.
    #[serde(default = "one_row")]
    #[schemars(extend("unit" = "m", "design_variable" = "the grid is that of the heights"))]
    pub across: Vec<f64>,
    /// Heights: of each place across, a row of those along.
    #[schemars(extend("unit" = "m", "design_variable" = "a ground is given"))]
    pub heights: Vec<Vec<f64>>,
}

/// One row of heights.
fn one_row() -> Vec<f64> {
    vec![0.0]
}
