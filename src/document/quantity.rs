//! A physical number of a problem file: fixed, or a design variable.

use flexbody_mathematics::math::{Scalar, Vec3};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};
use std::borrow::Cow;
use std::fmt;

/// A physical number. A file holds a plain number. Numbers of design variables are bound to them
/// before the document is deserialised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quantity {
    /// Value in the file.
    pub value: f64,
    /// Index of the design variable that replaces it, if any.
    pub variable: Option<usize>,
    /// Factor of the design variable: the value in SI per unit of the file.
    factor: f64,
}

/// Three quantities: the components of a vector.
pub type Vector = [Quantity; 3];

/// Key of the design variable in the form of a bound quantity.
const VARIABLE: &str = "variable";
/// Key of the value in the form of a bound quantity.
const VALUE: &str = "value";
/// A degree in radians.
const DEGREE: f64 = std::f64::consts::PI / 180.0;

impl Quantity {
    /// A number that no design variable changes.
    pub fn fixed(value: f64) -> Self {
        Self {
            value,
            variable: None,
            factor: 1.0,
        }
    }

    /// Its value at the design `x`.
    pub fn get<S: Scalar>(&self, x: &[S]) -> S {
        match self.variable {
            None => S::from(self.value),
            Some(index) if self.factor == 1.0 => x[index],
            Some(index) => x[index] * self.factor,
        }
    }

    /// The number times a factor, also as a function of its design variable.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            value: self.value * factor,
            factor: self.factor * factor,
            ..*self
        }
    }

    /// The form from which a bound [`Quantity`] is deserialised.
    pub fn bound(variable: usize, value: f64) -> serde_json::Value {
        serde_json::json!({ VARIABLE: variable, VALUE: value })
    }
}

/// The quantity 0: a default.
pub fn nothing() -> Quantity {
    Quantity::fixed(0.0)
}

/// Components of a vector at the design `x`.
pub fn vector<S: Scalar>(components: &Vector, x: &[S]) -> Vec3<S> {
    Vec3::from(components.map(|component| component.get(x)))
}

/// Components of a vector in the file.
pub fn values(components: &Vector) -> Vec3<f64> {
    Vec3::from(components.map(|component| component.value))
}

struct QuantityVisitor;

impl<'de> Visitor<'de> for QuantityVisitor {
    type Value = Quantity;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number")
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<Quantity, E> {
        Ok(Quantity::fixed(value))
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<Quantity, E> {
        Ok(Quantity::fixed(value as f64))
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<Quantity, E> {
        Ok(Quantity::fixed(value as f64))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Quantity, A::Error> {
        let (mut variable, mut value) = (None, None);
        while let Some(key) = map.next_key::<String>()? {
            match key.as_str() {
                VARIABLE => variable = Some(map.next_value()?),
                VALUE => value = Some(map.next_value()?),
                other => return Err(A::Error::unknown_field(other, &[VARIABLE, VALUE])),
            }
        }
        let value = value.ok_or_else(|| A::Error::missing_field(VALUE))?;
        Ok(Quantity {
            value,
            variable,
            factor: 1.0,
        })
    }
}

impl<'de> Deserialize<'de> for Quantity {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(QuantityVisitor)
    }
}

impl JsonSchema for Quantity {
    fn schema_name() -> Cow<'static, str> {
        "Quantity".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        json_schema!({ "type": "number", "design_variable": true })
    }
}

/// An angle or its rate that the file gives in degrees; the quantity is in radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Degrees(pub Quantity);

impl<'de> Deserialize<'de> for Degrees {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let written = Quantity::deserialize(deserializer)?;
        Ok(Self(Quantity {
            value: written.value * DEGREE,
            variable: written.variable,
            factor: DEGREE,
        }))
    }
}

impl JsonSchema for Degrees {
    fn schema_name() -> Cow<'static, str> {
        "Degrees".into()
    }

    fn inline_schema() -> bool {
        true
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Quantity::json_schema(generator)
    }
}
