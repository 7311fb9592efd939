//! A frame with two axes for curves, and legends outside frames.

use super::axis::{Axis, Scale};
use super::canvas::{Anchor, Canvas, GRID, INK, Pixel, text_width};
use super::colours::colour;
use plotters::style::RGBColor;

/// A frame at a place of the picture \[px\] with its axes.
pub(super) struct Panel {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: Axis,
    pub y: Axis,
}

/// Room below a panel for numbers and label of the x axis \[px\].
pub(super) const BELOW: f64 = 42.0;

/// Room left of a panel for numbers and label of its y axis \[px\].
pub(super) fn room_left<'a>(axes: impl IntoIterator<Item = &'a Axis>) -> f64 {
    axes.into_iter().map(Axis::widest).fold(0.0, f64::max) + 32.0
}

impl Panel {
    /// The place of a value in the picture.
    pub fn pixel(&self, x: f64, y: f64) -> Pixel {
        (
            self.left + self.x.fraction(x) * self.width,
            self.top + (1.0 - self.y.fraction(y)) * self.height,
        )
    }

    /// Frame, grid, ticks and labels. Numbers and label of the x axis are left out if another
    /// panel below shows them.
    pub fn draw(&self, canvas: &mut Canvas, number_x: bool, number_y: bool) {
        let (left, top) = (self.left, self.top);
        let (right, bottom) = (left + self.width, top + self.height);
        for (value, text) in &self.x.ticks {
            let x = self.pixel(*value, self.y.low).0;
            canvas.path(&[(x, top), (x, bottom)], GRID, 0.7, 1.0);
            canvas.path(&[(x, bottom), (x, bottom + 4.0)], INK, 1.0, 1.0);
            if number_x {
                canvas.text((x, bottom + 13.0), text, Anchor::Centre);
            }
        }
        for (value, text) in &self.y.ticks {
            let y = self.pixel(self.x.low, *value).1;
            canvas.path(&[(left, y), (right, y)], GRID, 0.7, 1.0);
            canvas.path(&[(left - 4.0, y), (left, y)], INK, 1.0, 1.0);
            if number_y {
                canvas.text((left - 7.0, y), text, Anchor::Right);
            }
        }
        let frame = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        canvas.path(&frame, INK, 1.0, 1.0);
        if number_x {
            let middle = (left + self.width / 2.0, bottom + 31.0);
            canvas.text(
                middle,
                &fitted_label(&self.x.label, self.width),
                Anchor::Centre,
            );
        }
        if number_y {
            let x = left - room_left([&self.y]) + 12.0;
            let label = fitted_label(&self.y.label, self.height + 10.0);
            canvas.text((x, top + self.height / 2.0), &label, Anchor::Upwards);
        }
    }

    /// Marks events at these places of the x axis.
    pub fn mark(&self, canvas: &mut Canvas, marks: &[f64]) {
        for &x in marks {
            let line = [self.y.low, self.y.high].map(|y| self.pixel(x, y));
            canvas.dashes(&line, INK, 1.0);
        }
    }

    /// The parts of a curve that lie within the frame. Values that are not finite interrupt it;
    /// on a logarithmic axis, values below its floor are drawn on the floor.
    pub fn within(&self, points: impl Iterator<Item = (f64, f64)>) -> Vec<Vec<Pixel>> {
        let mut parts: Vec<Vec<Pixel>> = vec![Vec::new()];
        let mut last: Option<Pixel> = None;
        for (x, y) in points {
            let y = match self.y.scale {
                Scale::Logarithmic if y < self.y.low => self.y.low,
                _ => y,
            };
            if !(x.is_finite() && y.is_finite()) {
                last = None;
                parts.push(Vec::new());
                continue;
            }
            let here = self.pixel(x, y);
            match last {
                None => parts.push(if self.contains(here) {
                    vec![here]
                } else {
                    Vec::new()
                }),
                Some(from) => {
                    if let Some((a, b)) = self.clipped(from, here) {
                        let part = parts.last_mut().expect("there is always a part");
                        if part.last() != Some(&a) {
                            parts.push(vec![a, b]);
                        } else {
                            part.push(b);
                        }
                    }
                }
            }
            last = Some(here);
        }
        parts.retain(|part| !part.is_empty());
        parts
    }

    fn contains(&self, (x, y): Pixel) -> bool {
        (self.left..=self.left + self.width).contains(&x)
            && (self.top..=self.top + self.height).contains(&y)
    }

    /// The part of a line within the frame (Liang and Barsky, 1984).
    fn clipped(&self, a: Pixel, b: Pixel) -> Option<(Pixel, Pixel)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (along, room) in [
            (-dx, a.0 - self.left),
            (dx, self.left + self.width - a.0),
            (-dy, a.1 - self.top),
            (dy, self.top + self.height - a.1),
        ] {
            if along == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if along < 0.0 {
                enter = enter.max(room / along);
            } else {
                leave = leave.min(room / along);
            }
        }
        // The ends themselves are kept exactly, so that parts can be joined.
        let at = |t: f64| match t {
            0.0 => a,
            1.0 => b,
            _ => (a.0 + t * dx, a.1 + t * dy),
        };
        (enter <= leave).then(|| (at(enter), at(leave)))
    }
}

/// The text, cut where it would be longer than the given length \[px\].
fn fitted(text: &str, length: f64) -> String {
    if text_width(text) <= length {
        return text.to_owned();
    }
    let mut kept = String::new();
    for character in text.chars() {
        if text_width(&kept) + text_width("mm…") > length {
            break;
        }
        kept.push(character);
    }
    kept + "…"
}

/// A label, whose name is cut where it would be longer than the given length \[px\]; its unit is kept.
fn fitted_label(label: &str, length: f64) -> String {
    match label.rfind(" [") {
        Some(at) if text_width(label) > length => {
            let (name, unit) = label.split_at(at);
            fitted(name, length - text_width(unit)) + unit
        }
        _ => fitted(label, length),
    }
}

/// How an entry of a legend is shown.
#[derive(Clone, Copy)]
pub(super) enum Key {
    Line(RGBColor),
    Dashes(RGBColor),
    /// A line of the pattern of this number.
    Pattern(RGBColor, usize),
    Area(RGBColor),
    Disc(RGBColor),
    Below(RGBColor),
    /// The colours of values from low to high.
    Scale,
    /// Text only.
    Note,
}

/// Width of a scale of colours \[px\].
const SCALE: f64 = 90.0;

/// Height of a row of a legend \[px\].
const ROW: f64 = 20.0;

/// A legend in rows above a panel, so that it covers no data.
pub(super) struct Legend {
    rows: Vec<Vec<(Key, String, f64)>>,
}

impl Legend {
    /// Fills rows of the given width \[px\].
    pub fn new(entries: Vec<(Key, String)>, width: f64) -> Legend {
        let mut rows: Vec<Vec<(Key, String, f64)>> = Vec::new();
        let mut x = f64::INFINITY;
        for (key, text) in entries {
            let shown = match key {
                Key::Note => 0.0,
                Key::Disc(_) | Key::Below(_) | Key::Area(_) => 18.0,
                Key::Line(_) | Key::Dashes(_) | Key::Pattern(..) => 32.0,
                Key::Scale => SCALE + 6.0,
            };
            let text = fitted(&text, width - shown);
            let needed = shown + text_width(&text) + 16.0;
            if x + needed - 16.0 > width {
                rows.push(Vec::new());
                x = 0.0;
            }
            let row = rows.last_mut().expect("the first entry opens a row");
            row.push((key, text, x));
            x += needed;
        }
        Legend { rows }
    }

    /// Height of all rows \[px\].
    pub fn height(&self) -> f64 {
        ROW * self.rows.len() as f64
    }

    /// Draws the rows downwards from `top`.
    pub fn draw(&self, canvas: &mut Canvas, left: f64, top: f64) {
        for (i, row) in self.rows.iter().enumerate() {
            let y = top + ROW * (i as f64 + 0.5);
            for (key, text, x) in row {
                let x = left + x;
                let line = [(x, y), (x + 26.0, y)];
                let shown = match *key {
                    Key::Line(color) => {
                        canvas.path(&line, color, 2.0, 1.0);
                        32.0
                    }
                    Key::Dashes(color) => {
                        canvas.dashes(&line, color, 2.0);
                        32.0
                    }
                    Key::Pattern(color, number) => {
                        canvas.pattern(&line, color, 2.0, number);
                        32.0
                    }
                    Key::Area(color) => {
                        let (a, b) = (y - 6.0, y + 6.0);
                        let square = [(x, a), (x + 12.0, a), (x + 12.0, b), (x, b)];
                        canvas.area(&square, color, 0.75);
                        18.0
                    }
                    Key::Disc(color) => {
                        canvas.disc((x + 6.0, y), 4.0, color);
                        18.0
                    }
                    Key::Below(color) => {
                        canvas.below_mark((x + 6.0, y + 4.0), color);
                        18.0
                    }
                    Key::Scale => {
                        const STEPS: usize = 40;
                        let step = SCALE / STEPS as f64;
                        for k in 0..STEPS {
                            let (a, b) = (x + step * k as f64, x + step * (k + 1) as f64 + 0.3);
                            let part = (k as f64 + 0.5) / STEPS as f64;
                            let (low, high) = (y + 6.0, y - 6.0);
                            let strip = [(a, low), (b, low), (b, high), (a, high)];
                            canvas.area(&strip, colour(part, [0.0, 1.0]), 1.0);
                        }
                        SCALE + 6.0
                    }
                    Key::Note => 0.0,
                };
                canvas.text((x + shown, y), text, Anchor::Left);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_that_are_cut_keep_their_unit() {
        let label = "the displacement of a point of a body against its axes [m]";
        let cut = fitted_label(label, 150.0);
        assert!(cut.ends_with("… [m]") && text_width(&cut) <= 150.0, "{cut}");
        assert!(cut.starts_with("the displace"), "{cut}");
        assert_eq!(fitted_label(label, 1000.0), label);
        assert_eq!(fitted_label("energy [J]", 100.0), "energy [J]");
    }
}
