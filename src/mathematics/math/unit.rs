//! SI units of products and quotients of quantities.

use std::fmt;

/// Base units, in the order of their exponents.
const BASES: [&str; 5] = ["kg", "m", "s", "rad", "K"];
/// Derived units that texts may use, with their exponents.
const DERIVED: [(&str, [i8; 5]); 5] = [
    ("N", [1, 1, -2, 0, 0]),
    ("J", [1, 2, -2, 0, 0]),
    ("W", [1, 2, -3, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0]),
    ("Hz", [0, 0, -1, 0, 0]),
];
/// Texts of dimensions that have a usual one beside the product of bases.
const USUAL: [(&str, [i8; 5]); 9] = [
    ("N", [1, 1, -2, 0, 0]),
    ("J", [1, 2, -2, 0, 0]),
    ("W", [1, 2, -3, 0, 0]),
    ("Pa", [1, -1, -2, 0, 0]),
    ("N/m", [1, 0, -2, 0, 0]),
    ("J s", [1, 2, -1, 0, 0]),
    ("N²", [2, 2, -4, 0, 0]),
    ("N² m²", [2, 4, -4, 0, 0]),
    ("Pa²", [2, -2, -4, 0, 0]),
];

/// A product of powers of base units.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unit {
    /// Exponents of the base units; `None` if it is not known.
    exponents: Option<[i8; 5]>,
    /// The text it was made from, which stays as long as it is not combined.
    text: Option<String>,
}

impl Unit {
    /// That of a number.
    pub fn one() -> Self {
        Self::of([0; 5])
    }

    /// That of time.
    pub fn second() -> Self {
        Self::of([0, 0, 1, 0, 0])
    }

    /// A unit that is not known.
    pub fn unknown() -> Self {
        Self {
            exponents: None,
            text: None,
        }
    }

    fn of(exponents: [i8; 5]) -> Self {
        Self {
            exponents: Some(exponents),
            text: None,
        }
    }

    /// Reads a text such as "kg m²/s²", "N m/rad" or "1/(m s)".
    pub fn parse(text: &str) -> Self {
        Self {
            exponents: exponents(text),
            text: Some(text.to_owned()),
        }
    }

    /// Whether it is known.
    pub fn is_known(&self) -> bool {
        self.exponents.is_some()
    }

    /// Whether both are known and of the same dimension. Angles are numbers.
    pub fn is_like(&self, other: &Self) -> bool {
        let plain = |own: &Self| own.exponents.map(|[kg, m, s, _, k]| [kg, m, s, k]);
        self.is_known() && plain(self) == plain(other)
    }

    /// Its product with a power of another unit.
    pub fn times(&self, other: &Self, power: i8) -> Self {
        let both = self.exponents.zip(other.exponents);
        Self {
            exponents: both.map(|(own, by)| std::array::from_fn(|i| own[i] + power * by[i])),
            text: None,
        }
    }
}

/// The exponents of a text; `None` if it has other symbols.
fn exponents(text: &str) -> Option<[i8; 5]> {
    let mut all = [0; 5];
    let mut sign = 1;
    let mut symbol = String::new();
    let mut power = String::new();
    let mut brackets = 0;
    for c in text.chars().chain([' ']) {
        match c {
            '¹' | '²' | '³' | '⁴' | '⁵' | '⁶' => power.push(c),
            ' ' | '/' | '(' | ')' => {
                add(&mut all, &symbol, &power, sign)?;
                symbol.clear();
                power.clear();
                match c {
                    '/' => sign = -1,
                    '(' => brackets += 1,
                    ')' => {
                        brackets -= 1;
                        sign = 1;
                    }
                    _ => {}
                }
            }
            _ if !power.is_empty() => {
                add(&mut all, &symbol, &power, sign)?;
                symbol = c.to_string();
                power.clear();
            }
            _ => symbol.push(c),
        }
    }
    (brackets == 0).then_some(all)
}

/// Adds the power of a symbol.
fn add(all: &mut [i8; 5], symbol: &str, power: &str, sign: i8) -> Option<()> {
    if symbol.is_empty() || symbol == "1" {
        return Some(());
    }
    let power = match power.chars().next() {
        None => 1,
        Some(c) => "¹²³⁴⁵⁶".chars().position(|own| own == c)? as i8 + 1,
    };
    let base = BASES.iter().position(|base| *base == symbol);
    let derived = DERIVED.iter().find(|(name, _)| *name == symbol);
    match (base, derived) {
        (Some(base), _) => all[base] += sign * power,
        (None, Some((_, own))) => {
            for (sum, own) in all.iter_mut().zip(own) {
                *sum += sign * power * own;
            }
        }
        (None, None) => return None,
    }
    Some(())
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        if let Some(text) = &self.text {
            return f.write_str(text);
        }
        let Some(mut own) = self.exponents else {
            return f.write_str("?");
        };
        // An angle is a number beside other units; alone it is told.
        if own[..2].iter().any(|&power| power != 0) {
            own[3] = 0;
        }
        if let Some((text, _)) = USUAL.iter().find(|(_, usual)| *usual == own) {
            return f.write_str(text);
        }
        let part = |sign: i8| -> Vec<String> {
            let named = BASES.iter().zip(own).filter(|(_, power)| power * sign > 0);
            let text = named.map(|(name, power)| match power * sign {
                1 => (*name).to_owned(),
                power => format!("{name}{}", superscript(power)),
            });
            text.collect()
        };
        let (above, below) = (part(1), part(-1));
        let above = match above.is_empty() {
            true => "1".to_owned(),
            false => above.join(" "),
        };
        match &below[..] {
            [] => f.write_str(&above),
            [only] => write!(f, "{above}/{only}"),
            many => write!(f, "{above}/({})", many.join(" ")),
        }
    }
}

fn superscript(power: i8) -> String {
    let digit = |c: char| "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().nth(c as usize - '0' as usize);
    power.to_string().chars().filter_map(digit).collect()
}

#[cfg(test)]
mod tests {
    use super::Unit;

    #[test]
    fn products_have_their_usual_names() {
        let cases = [
            ("N", "m/s", 1, "W"),
            ("N m", "rad/s", 1, "W"),
            ("N m", "N m", 1, "N² m²"),
            ("m", "m", 1, "m²"),
            ("m", "m", -1, "1"),
            ("rad", "s", -1, "rad/s"),
            ("J", "s", -1, "W"),
            ("m/s²", "s", -1, "m/s³"),
            ("kg m²/s", "kg m²", -1, "1/s"),
            ("W", "kg m", -1, "m/s³"),
            ("Pa", "m²", 1, "N"),
            ("1", "m s", -1, "1/(m s)"),
        ];
        for (a, b, power, product) in cases {
            let found = Unit::parse(a).times(&Unit::parse(b), power).to_string();
            assert_eq!(found, product, "{a} and {b}");
        }
    }

    #[test]
    fn texts_stay_as_they_are_and_unknown_units_are_told() {
        assert_eq!(Unit::parse("N m s/rad").to_string(), "N m s/rad");
        assert!(Unit::parse("N m").is_like(&Unit::parse("J")));
        assert!(Unit::parse("rad/s").is_like(&Unit::parse("Hz")));
        assert!(!Unit::parse("N").is_like(&Unit::parse("J")));
        assert!(!Unit::parse("apples").is_known());
        assert!(!Unit::unknown().is_like(&Unit::unknown()));
        let product = Unit::parse("apples").times(&Unit::one(), 1);
        assert_eq!(product.to_string(), "?");
    }
}
