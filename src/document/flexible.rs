//! Bodies with elastic coordinates as they are written in a file.

use crate::quantity::{Quantity, nothing};
use indexmap::IndexMap;
use schemars::JsonSchema;
use serde::Deserialize;

/// A straight uniform beam with elastic coordinates. Its axes: origin at its start, x along it.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Beam {
    /// Length along x.
    #[schemars(extend("unit" = "m", "exclusiveMinimum" = 0))]
    pub length: Quantity,
    /// Cross section.
    pub section: BeamSection,
    /// Material; given stiffnesses need none, but for stresses.
    pub material: Option<BeamMaterial>,
    /// What holds the axes, default "chord".
    #[serde(default)]
    pub frame: Frame,
    /// How many functions of each kind.
    #[serde(default)]
    pub modes: Modes,
    /// Functions of bending, default "polynomial".
    #[serde(default)]
    pub functions: Functions,
    /// Strain of the line of centres, default "von_karman".
    #[serde(default)]
    pub strain: Strain,
    /// Whether sections shear, default true. Given stiffnesses shear if they have ga_y and ga_z.
    pub shear: Option<bool>,
    /// Damping, default none.
    pub damping: Option<Damping>,
    /// Named points on the line of centres, as fractions of the length; "start" and "end" are there
    /// anyway.
    #[serde(default)]
    #[schemars(extend("unit" = "1"))]
    pub stations: IndexMap<String, Quantity>,
    /// Deformation at the start, default none.
    pub start: Option<Deformation>,
}

impl Beam {
    /// Where a named point on the line of centres is, as a fraction of the length.
    pub fn station(&self, name: &str) -> Option<Quantity> {
        let given = self.stations.get(name).copied();
        given.or(match name {
            "start" => Some(Quantity::fixed(0.0)),
            "end" => Some(Quantity::fixed(1.0)),
            _ => None,
        })
    }

    /// Names of the points on the line of centres.
    pub fn station_names(&self) -> impl Iterator<Item = &str> {
        let given = self.stations.keys().map(String::as_str);
        given.chain(["start", "end"])
    }
}

/// A cross section.
pub type BeamSection = super::section::Section<Box<GivenSection>>;

/// Stiffnesses and masses of a section.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct GivenSection {
    /// EA.
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0))]
    pub ea: Quantity,
    /// Stiffness of bending along y: EI about z. Needed if there are such functions.
    #[schemars(extend("unit" = "N m²", "exclusiveMinimum" = 0))]
    pub ei_y: Option<Quantity>,
    /// Stiffness of bending along z: EI about y. Needed if there are such functions.
    #[schemars(extend("unit" = "N m²", "exclusiveMinimum" = 0))]
    pub ei_z: Option<Quantity>,
    /// GJ. Needed if there are functions of torsion.
    #[schemars(extend("unit" = "N m²", "exclusiveMinimum" = 0))]
    pub gj: Option<Quantity>,
    /// Shear stiffness along y with its factor; default: no shear.
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0))]
    pub ga_y: Option<Quantity>,
    /// Shear stiffness along z with its factor; default: no shear.
    #[schemars(extend("unit" = "N", "exclusiveMinimum" = 0))]
    pub ga_z: Option<Quantity>,
    /// Mass per length ρA.
    #[schemars(extend("unit" = "kg/m", "exclusiveMinimum" = 0))]
    pub mass_per_length: Quantity,
    /// Inertia per length of sections that turn with bending along y, ∫ρ y² dA; default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "kg m", "minimum" = 0))]
    pub inertia_y: Quantity,
    /// Inertia per length of sections that turn with bending along z, ∫ρ z² dA; default 0.
    #[serde(default = "nothing")]
    #[schemars(extend("unit" = "kg m", "minimum" = 0))]
    pub inertia_z: Quantity,
}

/// An isotropic material.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BeamMaterial {
    /// Young's modulus.
    #[schemars(extend("unit" = "Pa", "exclusiveMinimum" = 0))]
    pub young: Quantity,
    /// Poisson's ratio, default 0.3.
    #[schemars(extend("unit" = "1", "exclusiveMinimum" = -1, "maximum" = 0.5))]
    pub poisson: Option<Quantity>,
    /// Density. Given masses per length need none.
    #[schemars(extend("unit" = "kg/m³", "exclusiveMinimum" = 0))]
    pub density: Option<Quantity>,
}

/// What holds the axes of a beam.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Frame {
    /// x runs through both ends, and the start does not turn about it.
    #[default]
    Chord,
    /// The section at the start.
    Clamped,
}

/// Functions of bending.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Functions {
    /// Polynomials.
    #[default]
    Polynomial,
    /// Sines, the modes of a beam on hinges. They have no companions, so the strain must be linear.
    Sine,
}

/// Strain of the line of centres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Strain {
    /// u' + ½ v'² + ½ w'²: the beam stiffens when it is stretched.
    #[default]
    VonKarman,
    /// u': it does not.
    Linear,
}

/// How many functions a beam has of each kind.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Modes {
    /// Bending along y, default 4.
    #[schemars(extend(
        "maximum" = 12,
        "design_variable" = "a number of functions is a count, not a physical number"
    ))]
    pub bending_y: Option<u32>,
    /// Bending along z, default 4.
    #[schemars(extend(
        "maximum" = 12,
        "design_variable" = "a number of functions is a count, not a physical number"
    ))]
    pub bending_z: Option<u32>,
    /// Torsion, default 2.
    #[schemars(extend(
        "maximum" = 12,
        "design_variable" = "a number of functions is a count, not a physical number"
    ))]
    pub torsion: Option<u32>,
    /// Stretch, default twice the larger number of bending and one: a bent beam then shortens without
    /// strain. 2 if the strain is linear.
    #[schemars(extend(
        "maximum" = 25,
        "design_variable" = "a number of functions is a count, not a physical number"
    ))]
    pub stretch: Option<u32>,
}

/// Damping of the elastic coordinates: a part of critical damping for each mode of the body while its
/// axes are held, plus α M + β K.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Damping {
    /// Part of critical damping of all modes, default 0.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub ratio: Option<Quantity>,
    /// That of torsion, default `ratio`.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub torsion_ratio: Option<Quantity>,
    /// That of stretch, default `ratio`.
    #[schemars(extend("unit" = "1", "minimum" = 0))]
    pub stretch_ratio: Option<Quantity>,
    /// α, of the mass, default 0.
    #[schemars(extend("unit" = "1/s", "minimum" = 0))]
    pub mass: Option<Quantity>,
    /// β, of the stiffness, default 0.
    #[schemars(extend("unit" = "s", "minimum" = 0))]
    pub stiffness: Option<Quantity>,
}

/// Elastic coordinates at the start, in the order bending along y, along z, torsion, stretch.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Deformation {
    /// The coordinates, default 0.
    #[schemars(extend("unit" = "m"))]
    pub coordinates: Option<Vec<Quantity>>,
    /// Their rates, default 0.
    #[schemars(extend("unit" = "m/s"))]
    pub rates: Option<Vec<Quantity>>,
}

/// Deformations of flexible bodies at the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Start {
    /// Those that the bodies give, else none.
    #[default]
    Given,
    /// Those at which elastic coordinates neither move nor accelerate: static equilibrium under gravity, loads and the
    /// inertia of the motions that the joints allow.
    Equilibrium,
    /// As placed before equilibrium is sought; not in files.
    #[serde(skip)]
    Placed,
}
