//! Numbers for people.

/// `value` with at most `digits` significant digits and no trailing zeros: plain from 1e-3 to
/// 1e6 in magnitude, otherwise `1.5e-7`.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return value.to_string();
    }
    // Rust rounds the decimal expansion correctly, so the exponent is taken after rounding.
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    let (mantissa, exponent) = scientific.split_once('e').expect("`e` formats an exponent");
    let exponent: i32 = exponent.parse().expect("`e` formats a whole exponent");
    if (-3..6).contains(&exponent) {
        let decimals = usize::try_from(digits as i32 - 1 - exponent).unwrap_or(0);
        trim_zeros(&format!("{value:.decimals$}")).to_owned()
    } else {
        format!("{}e{exponent}", trim_zeros(mantissa))
    }
}

fn trim_zeros(number: &str) -> &str {
    if number.contains('.') {
        number.trim_end_matches('0').trim_end_matches('.')
    } else {
        number
    }
}

/// A count with spaces between groups of three digits.
pub fn grouped(count: u64) -> String {
    let digits = count.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(' ');
        }
        out.push(digit);
    }
    out
}

/// A unit after its number; nothing for numbers without one.
pub fn with_space(unit: Option<&str>) -> String {
    let unit = unit.filter(|unit| !["", "1"].contains(unit));
    unit.map(|unit| format!(" {unit}")).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_their_significant_digits() {
        let cases = [
            (856.58952, 6, "856.59"),
            (-0.0078616, 4, "-0.007862"),
            (0.001, 3, "0.001"),
            (9.996e-4, 3, "0.001"),
            (1.5e-7, 4, "1.5e-7"),
            (999_999.9, 6, "1e6"),
            (400.0, 2, "400"),
            (-12_345.0, 3, "-12345"),
            (0.0, 3, "0"),
            (f64::NAN, 3, "NaN"),
        ];
        for (value, digits, text) in cases {
            assert_eq!(significant(value, digits), text);
        }
    }

    #[test]
    fn counts_are_grouped() {
        assert_eq!(grouped(0), "0");
        assert_eq!(grouped(999), "999");
        assert_eq!(grouped(1_234_567), "1 234 567");
    }
}
