//! Units of expressions of functions.
//!
//! Functions have units, numbers and parameters may carry any. Two terms of a sum whose units are known and differ are a
//! fault. A factor that is a number or a parameter is taken to carry what is missing.

use super::expression::{Call, Expression, Operator, Placed};
use crate::math::unit::Unit;
use std::ops::Range;

/// What is known of the unit of a part of an expression.
#[derive(Clone, Debug)]
pub struct Known {
    /// The unit; `None` if nothing is known.
    pub unit: Option<Unit>,
    /// Whether no number in it can carry a unit.
    pub exact: bool,
}

/// Terms or arguments that do not fit.
pub struct UnitFault {
    /// Bytes of the expression, from the first name to the last.
    pub at: Range<usize>,
    pub found: String,
    pub expected: &'static str,
    pub hint: &'static str,
}

const OF_SUMS: &str = "terms of one unit";
const CARRIES: &str =
    "a factor that is a number is taken to carry the missing unit, as in 1*a + 2*b";
const OF_CALLS: &str = "an argument without unit";
const DIVIDE: &str = "divide it by a number, as in log(a/1)";

/// The unit of an expression, from those of its names.
///
/// # Errors
/// The first part whose units do not fit.
pub fn unit(
    expression: &Expression<Placed>,
    of: &impl Fn(&str) -> Known,
) -> Result<Known, UnitFault> {
    let number = |exact| Known {
        unit: Some(Unit::default()),
        exact,
    };
    Ok(match expression {
        Expression::Number(_) => number(false),
        Expression::Name(own) => of(&own.name),
        Expression::Minus(inner) => unit(inner, of)?,
        Expression::Angle(pair) => {
            sum(expression, pair, of)?;
            Known {
                unit: Unit::read("rad"),
                exact: true,
            }
        }
        // The values of one function.
        Expression::Ks(_, all) => match all.first() {
            Some(first) => unit(first, of)?,
            None => number(false),
        },
        Expression::Call(Call::Sqrt, inner) => {
            let own = unit(inner, of)?;
            Known {
                unit: own.unit.map(|unit| unit.power(0.5)),
                ..own
            }
        }
        Expression::Call(call, inner) => {
            without_unit(inner, of)?;
            match call {
                Call::Asin | Call::Acos | Call::Atan => Known {
                    unit: Unit::read("rad"),
                    exact: true,
                },
                _ => number(true),
            }
        }
        Expression::Binary(operator, pair) => match operator {
            Operator::Plus | Operator::Minus => sum(expression, pair, of)?,
            Operator::Times | Operator::Over => {
                let sign = if *operator == Operator::Times {
                    1.0
                } else {
                    -1.0
                };
                let (a, b) = (unit(&pair[0], of)?, unit(&pair[1], of)?);
                Known {
                    exact: a.exact && b.exact,
                    unit: a.unit.zip(b.unit).map(|(a, b)| a.times(&b, sign)),
                }
            }
            Operator::Power => match pair[1].constant() {
                Some(exponent) => {
                    let own = unit(&pair[0], of)?;
                    Known {
                        unit: own.unit.map(|unit| unit.power(exponent)),
                        ..own
                    }
                }
                None => {
                    without_unit(&pair[1], of)?;
                    without_unit(&pair[0], of)?
                }
            },
        },
    })
}

/// The unit of a sum or difference.
fn sum(
    whole: &Expression<Placed>,
    pair: &[Expression<Placed>; 2],
    of: &impl Fn(&str) -> Known,
) -> Result<Known, UnitFault> {
    let (a, b) = (unit(&pair[0], of)?, unit(&pair[1], of)?);
    // A number has the unit of the other term.
    match [pair[0].names().is_empty(), pair[1].names().is_empty()] {
        [true, _] => return Ok(b),
        [_, true] => return Ok(a),
        [false, false] => {}
    }
    Ok(match (a.exact, b.exact) {
        (true, true) => match (&a.unit, &b.unit) {
            (Some(own), Some(other)) if !own.is_as(other) => {
                return Err(UnitFault {
                    at: span(whole),
                    found: format!("terms in {own} and in {other}"),
                    expected: OF_SUMS,
                    hint: CARRIES,
                });
            }
            _ => a,
        },
        (true, false) => a,
        (false, true) => b,
        (false, false) => Known {
            unit: a
                .unit
                .zip(b.unit)
                .filter(|(a, b)| a.is_as(b))
                .map(|own| own.0),
            exact: false,
        },
    })
}

/// The unit of an argument that must have none.
fn without_unit(
    argument: &Expression<Placed>,
    of: &impl Fn(&str) -> Known,
) -> Result<Known, UnitFault> {
    let known = unit(argument, of)?;
    match &known.unit {
        Some(unit) if known.exact && !unit.is_number() => Err(UnitFault {
            at: span(argument),
            found: format!("an argument in {unit}"),
            expected: OF_CALLS,
            hint: DIVIDE,
        }),
        unit => Ok(Known {
            unit: unit.as_ref().filter(|own| own.is_number()).cloned(),
            exact: known.exact,
        }),
    }
}

/// The bytes from the first name to the last.
fn span(expression: &Expression<Placed>) -> Range<usize> {
    let names = expression.names();
    match (names.first(), names.last()) {
        (Some(first), Some(last)) => first.at.start..last.at.end,
        _ => 0..0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(name: &str) -> Known {
        let text = match name {
            "mass" => "kg",
            "work" => "J",
            "time" => "s",
            "torque" => "N m",
            "speed" => "m/s",
            "ratio" => "1",
            _ => {
                return Known {
                    unit: None,
                    exact: false,
                };
            }
        };
        let unit = Unit::read(text);
        Known { unit, exact: true }
    }

    fn told(text: &str) -> String {
        let Ok(expression) = Expression::parse_placed(text) else {
            panic!("{text}")
        };
        match unit(&expression, &of) {
            Ok(known) => known
                .unit
                .map_or_else(|| "?".to_owned(), |unit| unit.to_string()),
            Err(fault) => format!("{}: {}", &text[fault.at.clone()], fault.found),
        }
    }

    #[test]
    fn units_follow_their_functions() {
        for (text, expected) in [
            ("mass*2.5", "kg"),
            ("work/time", "J/s"),
            ("mass*speed^2", "kg m²/s²"),
            ("sqrt(mass*work)/(time*speed)", "kg^0.5 J^0.5/m"),
            ("work/(mass*time)", "J/(kg s)"),
            ("speed*time", "m"),
            ("mass/mass", "1"),
            ("-mass + 1", "kg"),
            ("mass + 2*work", "kg"),
            ("2*mass + 3*work", "?"),
            ("2*mass + 3*mass", "kg"),
            ("mass*p", "?"),
            ("mass + p", "kg"),
            ("torque + work", "N m"),
            ("work - mass*speed^2/2", "J"),
            ("log(ratio) + ratio", "1"),
            ("atan2(mass, 2*work)", "rad"),
            ("log(mass/1)", "1"),
            ("ratio^p", "1"),
            ("mass + work", "mass + work: terms in kg and in J"),
            (
                "2*(mass - time/ratio)",
                "mass - time/ratio: terms in kg and in s",
            ),
            ("exp(work)", "work: an argument in J"),
            ("mass^p", "mass: an argument in kg"),
        ] {
            assert_eq!(told(text), expected, "{text}");
        }
    }
}
