//! Colours of values.

use plotters::style::RGBColor;

/// Colours from dark to light that people with any colour vision can order (viridis).
const COLOURS: [(u8, u8, u8); 9] = [
    (68, 1, 84),
    (71, 44, 122),
    (59, 81, 139),
    (44, 113, 142),
    (33, 144, 141),
    (39, 173, 129),
    (92, 200, 99),
    (170, 220, 50),
    (253, 231, 37),
];

/// The colour of a value between the lowest and the highest.
pub(super) fn colour(value: f64, [low, high]: [f64; 2]) -> RGBColor {
    let part = if high > low {
        (value - low) / (high - low)
    } else {
        0.5
    };
    let place = part.clamp(0.0, 1.0) * (COLOURS.len() - 1) as f64;
    let k = (place as usize).min(COLOURS.len() - 2);
    let (a, b, t) = (COLOURS[k], COLOURS[k + 1], place - k as f64);
    let mix = |a: u8, b: u8| (f64::from(a) + t * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}
