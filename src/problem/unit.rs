//! Units of expressions of functions.
//!
//! Functions have units, numbers and parameters may carry any. Two terms of a sum whose units are known and differ are a
//! fault. A factor that is a number or a parameter is taken to carry what is missing.

use super::expression::{Call, Expression, Operator, Placed};
use std::fmt;
use std::ops::Range;

/// A product of powers of symbols, such as kg m²/s.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Unit {
    /// Each symbol once, with an exponent that is not zero.
    powers: Vec<(String, f64)>,
}

/// Symbols by kilogram, metre and second.
const SYMBOLS: [(&str, [f64; 3]); 9] = [
    ("kg", [1.0, 0.0, 0.0]),
    ("m", [0.0, 1.0, 0.0]),
    ("s", [0.0, 0.0, 1.0]),
    ("rad", [0.0, 0.0, 0.0]),
    ("N", [1.0, 1.0, -2.0]),
    ("J", [1.0, 2.0, -2.0]),
    ("W", [1.0, 2.0, -3.0]),
    ("Pa", [1.0, -1.0, -2.0]),
    ("Hz", [0.0, 0.0, -1.0]),
];
/// Exponents that differ by less are the same.
const SAME: f64 = 1e-9;

impl Unit {
    /// Reads a unit such as "kg m²/s"; `None` if it has other symbols.
    pub fn read(text: &str) -> Option<Self> {
        let mut unit = Self::default();
        for (k, part) in text.split('/').enumerate() {
            let sign = if k == 0 { 1.0 } else { -1.0 };
            for symbol in part.split_whitespace().filter(|own| *own != "1") {
                let (symbol, power) = match symbol.chars().last()? {
                    '²' => (symbol.trim_end_matches('²'), 2.0),
                    '³' => (symbol.trim_end_matches('³'), 3.0),
                    _ => (symbol, 1.0),
                };
                SYMBOLS.iter().find(|(own, _)| *own == symbol)?;
                unit.include(symbol, sign * power);
            }
        }
        Some(unit)
    }

    fn include(&mut self, symbol: &str, power: f64) {
        match self.powers.iter_mut().find(|(own, _)| own == symbol) {
            Some((_, own)) => *own += power,
            None => self.powers.push((symbol.to_owned(), power)),
        }
        self.powers.retain(|(_, power)| power.abs() > SAME);
    }

    fn times(&self, other: &Self, sign: f64) -> Self {
        let mut product = self.clone();
        for (symbol, power) in &other.powers {
            product.include(symbol, sign * power);
        }
        product
    }

    fn power(&self, exponent: f64) -> Self {
        let mut unit = Self::default();
        for (symbol, power) in &self.powers {
            unit.include(symbol, power * exponent);
        }
        unit
    }

    /// Exponents of kilogram, metre and second.
    fn dimension(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (symbol, power) in &self.powers {
            let own = SYMBOLS.iter().find(|(own, _)| own == symbol);
            for (sum, own) in sum.iter_mut().zip(own.map_or([0.0; 3], |own| own.1)) {
                *sum += own * power;
            }
        }
        sum
    }

    fn is_as(&self, other: &Self) -> bool {
        let pairs = self.dimension().into_iter().zip(other.dimension());
        pairs.into_iter().all(|(a, b)| (a - b).abs() <= SAME)
    }

    fn is_number(&self) -> bool {
        self.is_as(&Self::default())
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let one = |(symbol, power): &(String, f64)| match power.abs() {
            1.0 => symbol.clone(),
            2.0 => format!("{symbol}²"),
            3.0 => format!("{symbol}³"),
            other => format!("{symbol}^{other}"),
        };
        let side = |positive: bool| -> Vec<String> {
            let own = self.powers.iter().filter(|own| (own.1 > 0.0) == positive);
            own.map(one).collect()
        };
        let (above, below) = (side(true), side(false));
        match above.is_empty() {
            true => f.write_str("1")?,
            false => f.write_str(&above.join(" "))?,
        }
        match &below[..] {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            all => write!(f, "/({})", all.join(" ")),
        }
    }
}

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
