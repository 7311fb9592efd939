//! Expressions of numbers and functions, such as `L/2 + 3*deg`: their grammar and values in any scalar.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = sign { ("*" | "/") sign }
//! sign    = ["-" | "+"] sign | power
//! power   = atom ["^" sign]
//! atom    = number | name | name "(" sum { "," sum } ")" | "(" sum ")"
//! name    = word | "'" text "'" | "`" text "`"
//! ```

use crate::math::Scalar;
use crate::math::soft_max::SoftMax;
use std::f64::consts::PI;
use std::ops::Range;

/// Mark at the beginning of an expression in a file.
pub const MARK: char = '=';
/// Deepest nesting of parentheses, signs and powers.
const DEEPEST: usize = 50;
/// Largest whole exponent that multiplies; others take exp(b ln a).
const LARGEST_POWER: f64 = 64.0;

/// Marks around names that are no words.
const QUOTES: [char; 2] = ['\'', '`'];

/// Names of constants, and their values.
const CONSTANTS: [(&str, f64); 2] = [("pi", PI), ("deg", PI / 180.0)];

/// An expression, with names of kind `N`.
#[derive(Clone, Debug, PartialEq)]
pub enum Expression<N> {
    /// A number.
    Number(f64),
    /// What a name stands for.
    Name(N),
    /// Minus an expression.
    Minus(Box<Self>),
    /// Two expressions and what joins them.
    Binary(Operator, Box<[Self; 2]>),
    /// A function of an expression.
    Call(Call, Box<Self>),
    /// The angle of the point (second, first).
    Angle(Box<[Self; 2]>),
    /// (1/ρ) ln Σ e^{ρ f}, a smooth bound of the largest; of infinite ρ the largest itself. No grammar: functions over cases
    /// are of this kind.
    Ks(f64, Vec<Self>),
}

/// What joins two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operator {
    Plus,
    Minus,
    Times,
    Over,
    Power,
}

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Call {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Sqrt,
    Exp,
    Log,
}

/// Functions of one number by name.
const CALLS: [(&str, Call); 9] = [
    ("sin", Call::Sin),
    ("cos", Call::Cos),
    ("tan", Call::Tan),
    ("asin", Call::Asin),
    ("acos", Call::Acos),
    ("atan", Call::Atan),
    ("sqrt", Call::Sqrt),
    ("exp", Call::Exp),
    ("log", Call::Log),
];
/// The function of two numbers.
const ANGLE: &str = "atan2";

/// Names that parameters cannot have.
pub fn reserved() -> impl Iterator<Item = &'static str> {
    let constants = CONSTANTS.iter().map(|(name, _)| *name);
    let calls = CALLS.iter().map(|(name, _)| *name);
    constants.chain(calls).chain([ANGLE])
}

/// Whether a text can be a name in an expression.
pub fn is_name(text: &str) -> bool {
    let mut letters = text.chars();
    letters
        .next()
        .is_some_and(|c| c.is_alphabetic() || c == '_')
        && letters.all(|c| c.is_alphanumeric() || c == '_')
}

/// Why a text is no expression.
#[derive(Clone, Debug, PartialEq)]
pub struct ExpressionFault {
    /// Bytes of the text.
    pub at: Range<usize>,
    /// What is there, in words.
    pub found: String,
    /// What should be.
    pub expected: &'static str,
}

/// A name with its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Placed {
    /// The name, without quotation marks.
    pub name: String,
    /// Its bytes of the text, quotation marks included.
    pub at: Range<usize>,
}

impl Expression<String> {
    /// Reads an expression.
    ///
    /// # Errors
    /// The place that does not follow the grammar.
    pub fn parse(text: &str) -> Result<Self, ExpressionFault> {
        Expression::parse_placed(text)?.named(&mut |own| Ok(own.name.clone()))
    }
}

impl Expression<Placed> {
    /// Reads an expression and keeps the places of its names.
    ///
    /// # Errors
    /// The place that does not follow the grammar.
    pub fn parse_placed(text: &str) -> Result<Self, ExpressionFault> {
        let mut parser = Parser {
            text,
            at: 0,
            depth: 0,
        };
        let found = parser.sum()?;
        match parser.peek() {
            None => Ok(found),
            Some(_) => Err(parser.fault("an operator or the end")),
        }
    }
}

impl<N> Expression<N> {
    /// The same expression of other names.
    ///
    /// # Errors
    /// The first of `of`.
    pub fn named<M, E>(&self, of: &mut impl FnMut(&N) -> Result<M, E>) -> Result<Expression<M>, E> {
        let mut both = |pair: &[Self; 2]| -> Result<Box<[Expression<M>; 2]>, E> {
            Ok(Box::new([pair[0].named(of)?, pair[1].named(of)?]))
        };
        Ok(match self {
            Self::Number(number) => Expression::Number(*number),
            Self::Binary(operator, pair) => Expression::Binary(*operator, both(pair)?),
            Self::Angle(pair) => Expression::Angle(both(pair)?),
            Self::Name(name) => Expression::Name(of(name)?),
            Self::Minus(inner) => Expression::Minus(Box::new(inner.named(of)?)),
            Self::Call(call, inner) => Expression::Call(*call, Box::new(inner.named(of)?)),
            Self::Ks(rho, all) => {
                let all = all.iter().map(|own| own.named(of));
                Expression::Ks(*rho, all.collect::<Result<_, _>>()?)
            }
        })
    }

    /// All names, in their order.
    pub fn names(&self) -> Vec<&N> {
        match self {
            Self::Number(_) => Vec::new(),
            Self::Name(name) => vec![name],
            Self::Minus(inner) | Self::Call(_, inner) => inner.names(),
            Self::Binary(_, pair) | Self::Angle(pair) => {
                pair.iter().flat_map(Self::names).collect()
            }
            Self::Ks(_, all) => all.iter().flat_map(Self::names).collect(),
        }
    }

    /// Its value, with that of each name. It is not finite where the expression is not defined.
    pub fn value<S: Scalar>(&self, of: &impl Fn(&N) -> S) -> S {
        match self {
            Self::Number(number) => S::from(*number),
            Self::Name(name) => of(name),
            Self::Minus(inner) => -inner.value(of),
            Self::Call(call, inner) => call.value(inner.value(of)),
            Self::Angle(pair) => pair[0].value(of).atan2(pair[1].value(of)),
            Self::Ks(rho, all) => {
                let values: Vec<S> = all.iter().map(|own| own.value(of)).collect();
                match rho.is_infinite() {
                    true => { values.into_iter() }.fold(S::from(f64::NEG_INFINITY), |most, own| {
                        if own.re() > most.re() { own } else { most }
                    }),
                    false => SoftMax::new(&values, |_| S::one(), *rho).ks,
                }
            }
            Self::Binary(operator, pair) => {
                let (a, b) = (pair[0].value(of), pair[1].value(of));
                match operator {
                    Operator::Plus => a + b,
                    Operator::Minus => a - b,
                    Operator::Times => a * b,
                    Operator::Over => a / b,
                    Operator::Power => match pair[1].constant() {
                        Some(b) => power(a, b),
                        None => (a.ln() * b).exp(),
                    },
                }
            }
        }
    }

    /// What it stands for: smooth bounds of a largest value are the largest value.
    pub fn sharp(&self) -> Self
    where
        N: Clone,
    {
        let both = |pair: &[Self; 2]| Box::new([pair[0].sharp(), pair[1].sharp()]);
        match self {
            Self::Number(_) | Self::Name(_) => self.clone(),
            Self::Minus(inner) => Self::Minus(Box::new(inner.sharp())),
            Self::Call(call, inner) => Self::Call(*call, Box::new(inner.sharp())),
            Self::Binary(operator, pair) => Self::Binary(*operator, both(pair)),
            Self::Angle(pair) => Self::Angle(both(pair)),
            Self::Ks(_, all) => Self::Ks(f64::INFINITY, all.iter().map(Self::sharp).collect()),
        }
    }

    /// Whether something in it is smoothed.
    pub fn is_smoothed(&self) -> bool {
        match self {
            Self::Number(_) | Self::Name(_) => false,
            Self::Minus(inner) | Self::Call(_, inner) => inner.is_smoothed(),
            Self::Binary(_, pair) | Self::Angle(pair) => pair.iter().any(Self::is_smoothed),
            Self::Ks(..) => true,
        }
    }

    /// Its value, if it is a number with or without a sign.
    pub fn constant(&self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(*number),
            Self::Minus(inner) => inner.constant().map(|number| -number),
            _ => None,
        }
    }
}

/// aᵇ, by multiplication for whole exponents.
fn power<S: Scalar>(a: S, b: f64) -> S {
    if b.fract() == 0.0 && b.abs() <= LARGEST_POWER {
        let positive = (0..b.abs() as u32).fold(S::one(), |product, _| product * a);
        return match b < 0.0 {
            true => S::one() / positive,
            false => positive,
        };
    }
    match b {
        0.5 => a.sqrt(),
        _ => (a.ln() * b).exp(),
    }
}

impl Call {
    fn value<S: Scalar>(self, a: S) -> S {
        let rest = || (S::one() - a * a).sqrt();
        match self {
            Self::Sin => a.sin_cos().0,
            Self::Cos => a.sin_cos().1,
            Self::Tan => {
                let (sin, cos) = a.sin_cos();
                sin / cos
            }
            Self::Asin => a.atan2(rest()),
            Self::Acos => rest().atan2(a),
            Self::Atan => a.atan2(S::one()),
            Self::Sqrt => a.sqrt(),
            Self::Exp => a.exp(),
            Self::Log => a.ln(),
        }
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
}

type Parsed = Result<Expression<Placed>, ExpressionFault>;

impl<'a> Parser<'a> {
    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        let rest = &self.text[self.at..];
        self.at += rest.len() - rest.trim_start().len();
        self.text[self.at..].chars().next()
    }

    fn take(&mut self, mark: char) -> bool {
        let found = self.peek() == Some(mark);
        self.at += usize::from(found) * mark.len_utf8();
        found
    }

    /// A fault at the next character.
    fn fault(&mut self, expected: &'static str) -> ExpressionFault {
        let next = self.peek();
        let width = next.map_or(0, char::len_utf8);
        ExpressionFault {
            at: self.at..self.at + width,
            found: next.map_or("the end of the expression".to_owned(), |c| format!("'{c}'")),
            expected,
        }
    }

    fn sum(&mut self) -> Parsed {
        let mut sum = self.product()?;
        loop {
            let operator = match () {
                () if self.take('+') => Operator::Plus,
                () if self.take('-') => Operator::Minus,
                () => return Ok(sum),
            };
            sum = Expression::Binary(operator, Box::new([sum, self.product()?]));
        }
    }

    fn product(&mut self) -> Parsed {
        let mut product = self.sign()?;
        loop {
            let operator = match () {
                () if self.take('*') => Operator::Times,
                () if self.take('/') => Operator::Over,
                () => return Ok(product),
            };
            product = Expression::Binary(operator, Box::new([product, self.sign()?]));
        }
    }

    fn sign(&mut self) -> Parsed {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault("fewer parentheses, signs and powers inside each other"));
        }
        let found = match () {
            () if self.take('-') => self.sign().map(|inner| Expression::Minus(Box::new(inner))),
            () if self.take('+') => self.sign(),
            () => self.power(),
        };
        self.depth -= 1;
        found
    }

    fn power(&mut self) -> Parsed {
        let base = self.atom()?;
        match self.take('^') {
            true => Ok(Expression::Binary(
                Operator::Power,
                Box::new([base, self.sign()?]),
            )),
            false => Ok(base),
        }
    }

    fn atom(&mut self) -> Parsed {
        match self.peek() {
            Some('(') => {
                self.at += 1;
                let inner = self.sum()?;
                match self.take(')') {
                    true => Ok(inner),
                    false => Err(self.fault("an operator or ')'")),
                }
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(),
            Some(c) if c.is_alphabetic() || c == '_' => self.name(),
            Some(mark) if QUOTES.contains(&mark) => self.quoted(mark),
            _ => Err(self.fault("a number, a name or '('")),
        }
    }

    /// The bytes from here of characters that satisfy a condition.
    fn run(&self, part: impl Fn(char) -> bool) -> &'a str {
        let rest = &self.text[self.at..];
        &rest[..rest.find(|c| !part(c)).unwrap_or(rest.len())]
    }

    fn number(&mut self) -> Parsed {
        let mut word = self.run(|c| c.is_ascii_digit() || c == '.').to_owned();
        let after = &self.text[self.at + word.len()..];
        if after.starts_with(['e', 'E']) {
            let signed = usize::from(after[1..].starts_with(['+', '-']));
            let digits = after[1 + signed..].chars().take_while(char::is_ascii_digit);
            let digits = digits.count();
            if digits > 0 {
                word.push_str(&after[..1 + signed + digits]);
            }
        }
        let at = self.at..self.at + word.len();
        match word.parse::<f64>() {
            Ok(number) if number.is_finite() => {
                self.at = at.end;
                Ok(Expression::Number(number))
            }
            _ => Err(ExpressionFault {
                at,
                found: word,
                expected: "a number",
            }),
        }
    }

    /// A name between two marks.
    fn quoted(&mut self, mark: char) -> Parsed {
        let start = self.at;
        let rest = &self.text[start + mark.len_utf8()..];
        let Some(length) = rest.find(mark) else {
            return Err(ExpressionFault {
                at: start..self.text.len(),
                found: format!("a name after {mark} without an end"),
                expected: "the same mark at its end",
            });
        };
        self.at = start + length + 2 * mark.len_utf8();
        Ok(Expression::Name(Placed {
            name: rest[..length].to_owned(),
            at: start..self.at,
        }))
    }

    fn name(&mut self) -> Parsed {
        let name = self.run(|c| c.is_alphanumeric() || c == '_');
        let at = self.at..self.at + name.len();
        self.at = at.end;
        if !self.take('(') {
            let constant = CONSTANTS.iter().find(|(own, _)| *own == name);
            return Ok(match constant {
                Some((_, value)) => Expression::Number(*value),
                None => Expression::Name(Placed {
                    name: name.to_owned(),
                    at,
                }),
            });
        }
        let first = self.sum()?;
        let call = CALLS.iter().find(|(own, _)| *own == name);
        let found = match call {
            Some((_, call)) => Expression::Call(*call, Box::new(first)),
            None if name == ANGLE => {
                if !self.take(',') {
                    return Err(self.fault("',' and the second argument"));
                }
                Expression::Angle(Box::new([first, self.sum()?]))
            }
            None => {
                return Err(ExpressionFault {
                    at,
                    found: format!("the function \"{name}\""),
                    expected: "sin, cos, tan, asin, acos, atan, atan2, sqrt, exp or log",
                });
            }
        };
        match self.take(')') {
            true => Ok(found),
            false => Err(self.fault("an operator or ')'")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Complex64, Dual};

    fn value(text: &str) -> f64 {
        let expression = Expression::parse(text).unwrap_or_else(|fault| panic!("{fault:?}"));
        expression.value(&|name: &String| match name.as_str() {
            "a" => 2.0,
            "b_1" => 5.0,
            other => panic!("{other}"),
        })
    }

    /// Precedence and association are those of mathematics: powers before signs, to the right.
    #[test]
    fn values_follow_the_grammar() {
        for (text, expected) in [
            ("1 + 2*3", 7.0),
            ("(1+2) * 3", 9.0),
            ("8/4/2", 1.0),
            ("2-3-4", -5.0),
            ("-2^2", -4.0),
            ("2^3^2", 512.0),
            ("2^-2", 0.25),
            ("(-8)^3", -512.0),
            ("4^0.5", 2.0),
            ("a^b_1", 32.0),
            ("--3", 3.0),
            ("1.5e-3*2E3", 3.0),
            ("2*pi/360 - deg", 0.0),
            ("sqrt(a*8) + exp(0) + log(1)", 5.0),
            ("180/pi*atan2(1, -1)", 135.0),
            ("asin(0.5)/deg + acos(0.5)/deg + atan(1)/deg", 135.0),
            ("tan(45*deg) + sin(30*deg) + cos(60*deg)", 2.0),
        ] {
            let found = value(text);
            assert!((found - expected).abs() < 1e-12, "{text} is {found}");
        }
    }

    /// The derivative of each operation is that of the complex step, and of a difference.
    #[test]
    fn derivatives_are_exact() {
        for text in [
            "a*a/3 - 2/a + a",
            "a^3 - a^-2 + a^0.5 + a^1.7 + 2^a + a^a",
            "sin(a)*cos(a)/tan(a)",
            "asin(a/3) + acos(a/4) + atan(a) + atan2(a, 1 - a)",
            "sqrt(a) * exp(-a) * log(a)",
        ] {
            let expression = Expression::parse(text).expect("an expression");
            let dual = expression.value(&|_: &String| Dual::new(1.3, 1.0));
            let complex = expression.value(&|_: &String| Complex64::new(1.3, 1e-30));
            assert!((dual.du - complex.im / 1e-30).abs() <= 1e-14 * dual.du.abs().max(1.0));
            let at = |x: f64| expression.value(&|_: &String| x);
            let difference = (at(1.3 + 1e-5) - at(1.3 - 1e-5)) / 2e-5;
            assert!((dual.du - difference).abs() < 1e-8, "{text}");
            assert_eq!(dual.re, at(1.3), "{text}");
        }
    }

    #[test]
    fn faults_have_a_place() {
        for (text, at, found) in [
            ("", 0..0, "the end of the expression"),
            ("1 +", 3..3, "the end of the expression"),
            ("1 + 'a b", 4..8, "a name after ' without an end"),
            ("1 + * 2", 4..5, "'*'"),
            ("(1 + 2", 6..6, "the end of the expression"),
            ("2 L", 2..3, "'L'"),
            ("1.2.3", 0..5, "1.2.3"),
            ("sine(2)", 0..4, "the function \"sine\""),
            ("atan2(1)", 7..8, "')'"),
            ("a ? b", 2..3, "'?'"),
        ] {
            let fault = Expression::parse(text).expect_err(text);
            assert_eq!((fault.at, fault.found.as_str()), (at, found), "{text}");
        }
        assert!(Expression::parse(&"(".repeat(1000)).is_err());
        assert!(Expression::parse(&"-".repeat(1000)).is_err());
    }
}
