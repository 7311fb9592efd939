//! SI units of products, quotients and powers.

use std::fmt;

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
/// Powers from 2 on.
const POWERS: [char; 5] = ['²', '³', '⁴', '⁵', '⁶'];
/// Dimensions with a usual text beside the product of base units.
const USUAL: [(&str, [f64; 3]); 6] = [
    ("N", [1.0, 1.0, -2.0]),
    ("J", [1.0, 2.0, -2.0]),
    ("W", [1.0, 2.0, -3.0]),
    ("Pa", [1.0, -1.0, -2.0]),
    ("N/m", [1.0, 0.0, -2.0]),
    ("J s", [1.0, 2.0, -1.0]),
];
/// Exponents that differ by less are the same.
const SAME: f64 = 1e-9;

impl Unit {
    /// That of time.
    pub fn second() -> Self {
        let powers = vec![("s".to_owned(), 1.0)];
        Self { powers }
    }

    /// Reads a unit such as "kg m²/s" or "1/(m s)"; `None` if it has other symbols.
    pub fn read(text: &str) -> Option<Self> {
        let mut unit = Self::default();
        for (k, part) in text.split('/').enumerate() {
            let sign = if k == 0 { 1.0 } else { -1.0 };
            let part = part.trim_start_matches('(').trim_end_matches(')');
            for symbol in part.split_whitespace().filter(|own| *own != "1") {
                let last = symbol.chars().last()?;
                let (symbol, power) = match POWERS.iter().position(|own| *own == last) {
                    Some(at) => (symbol.trim_end_matches(last), at as f64 + 2.0),
                    None => (symbol, 1.0),
                };
                SYMBOLS.iter().find(|(own, _)| *own == symbol)?;
                unit.include(symbol, sign * power);
            }
        }
        Some(unit)
    }

    /// The usual text of its dimension: W for N m/s, and the product of base units if there is no usual one. An angle is a
    /// number beside other units.
    pub fn usual(&self) -> String {
        let dimension = self.dimension();
        let is_like =
            |own: &[f64; 3]| (own.iter().zip(dimension)).all(|(a, b)| (a - b).abs() <= SAME);
        let angles = self.powers.iter().find(|(own, _)| own == "rad");
        if let Some((text, _)) = USUAL.iter().find(|(_, own)| is_like(own)) {
            return (*text).to_owned();
        }
        let mut bases = Self::default();
        for (name, power) in ["kg", "m", "s"].into_iter().zip(dimension) {
            bases.include(name, power);
        }
        if let (Some((_, power)), true) = (angles, dimension[..2] == [0.0, 0.0]) {
            bases.powers.insert(0, ("rad".to_owned(), *power));
        }
        bases.to_string()
    }

    fn include(&mut self, symbol: &str, power: f64) {
        match self.powers.iter_mut().find(|(own, _)| own == symbol) {
            Some((_, own)) => *own += power,
            None => self.powers.push((symbol.to_owned(), power)),
        }
        self.powers.retain(|(_, power)| power.abs() > SAME);
    }

    /// Its product with another unit to the power ±1.
    pub fn times(&self, other: &Self, sign: f64) -> Self {
        let mut product = self.clone();
        for (symbol, power) in &other.powers {
            product.include(symbol, sign * power);
        }
        product
    }

    /// Its power.
    pub fn power(&self, exponent: f64) -> Self {
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

    /// Whether both have the same dimension. Angles are numbers.
    pub fn is_as(&self, other: &Self) -> bool {
        let pairs = self.dimension().into_iter().zip(other.dimension());
        pairs.into_iter().all(|(a, b)| (a - b).abs() <= SAME)
    }

    /// Whether it is that of a number.
    pub fn is_number(&self) -> bool {
        self.is_as(&Self::default())
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let one = |(symbol, power): &(String, f64)| match power.abs() {
            1.0 => symbol.clone(),
            2.0 | 3.0 | 4.0 | 5.0 | 6.0 => format!("{symbol}{}", POWERS[power.abs() as usize - 2]),
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

#[cfg(test)]
mod tests {
    use super::Unit;

    fn read(text: &str) -> Unit {
        Unit::read(text).expect("a unit")
    }

    #[test]
    fn products_have_their_usual_names() {
        let cases = [
            ("N", "m/s", 1.0, "W"),
            ("N m", "rad/s", 1.0, "W"),
            ("m", "m", 1.0, "m²"),
            ("m", "m", -1.0, "1"),
            ("rad", "s", -1.0, "rad/s"),
            ("J", "s", -1.0, "W"),
            ("m/s²", "s", -1.0, "m/s³"),
            ("kg m²/s", "kg m²", -1.0, "1/s"),
            ("W", "kg m", -1.0, "m/s³"),
            ("Pa", "m²", 1.0, "N"),
            ("1", "m s", -1.0, "1/(m s)"),
        ];
        for (a, b, sign, product) in cases {
            assert_eq!(
                read(a).times(&read(b), sign).usual(),
                product,
                "{a} and {b}"
            );
        }
    }

    #[test]
    fn units_are_compared_by_their_dimension() {
        assert!(read("N m").is_as(&read("J")));
        assert!(read("rad/s").is_as(&read("Hz")));
        assert!(!read("N").is_as(&read("J")));
        assert_eq!(read("1/(m s)").to_string(), "1/(m s)");
        assert_eq!(Unit::read("apples"), None);
    }
}
