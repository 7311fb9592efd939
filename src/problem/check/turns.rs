//! Rotations in their forms, and points between others.

use super::Checker;
use crate::finding::Finding;
use crate::pointer::join;
use crate::schema::mechanics::{Between, Body, BodyPoint, InDegrees, Turn};
use crate::turns::{ROUNDED, axes, of_rows};

/// The forms of a turn.
const FORMS: &str = "\"axis\" with \"angle\" or \"degrees\", one of \"x\", \"y\" and \"z\", \"sequence\" with \
                     \"angles\" or \"degrees\", \"quaternion\", or \"matrix\"";

impl Checker<'_> {
    /// Checks that a turn has one form, and that this is a rotation.
    pub(super) fn turn(&mut self, pointer: &str, turn: &Turn) {
        let all = [
            ("axis", turn.axis.is_some()),
            ("angle", turn.angle.is_some()),
            ("degrees", turn.degrees.is_some()),
            ("x", turn.x.is_some()),
            ("y", turn.y.is_some()),
            ("z", turn.z.is_some()),
            ("sequence", turn.sequence.is_some()),
            ("angles", turn.angles.is_some()),
            ("quaternion", turn.quaternion.is_some()),
            ("matrix", turn.matrix.is_some()),
        ];
        let given = all.into_iter().filter(|(_, given)| *given);
        let given: Vec<&str> = given.map(|(key, _)| key).collect();
        let three = matches!(turn.degrees, Some(InDegrees::Three(_)));
        let is_form = match &given[..] {
            ["axis", "angle"]
            | ["x"]
            | ["y"]
            | ["z"]
            | ["sequence", "angles"]
            | ["quaternion"]
            | ["matrix"] => true,
            ["axis", "degrees"] => !three,
            ["degrees", "sequence"] => three,
            _ => false,
        };
        if !is_form {
            let found = match &given[..] {
                [] => "a turn without keys".to_owned(),
                ["axis", "degrees"] => "three angles about one axis".to_owned(),
                ["degrees", "sequence"] => "one angle of three".to_owned(),
                keys => format!("a turn with {}", keys.join(", ")),
            };
            let several = given.iter().filter(|key| key.len() == 1).count() > 1;
            let hint = "write a turn for each in a list, in the order of the rotations";
            let finding = Finding::new(pointer, found, FORMS).of_key();
            self.fault(finding.hint(several.then(|| hint.to_owned())));
            return;
        }
        if let Some(axis) = &turn.axis {
            self.direction(&join(pointer, "axis"), axis);
        }
        if let Some(sequence) = turn.sequence.as_ref().filter(|own| axes(own).is_none()) {
            let found = format!("\"{sequence}\"");
            let expected = "three of x, y and z, the same not twice in a row, such as \"zyx\"";
            self.fault(Finding::new(join(pointer, "sequence"), found, expected));
        }
        if let Some(quaternion) = &turn.quaternion {
            let squares = quaternion.iter().map(|own| own.value * own.value);
            let length = squares.sum::<f64>().sqrt();
            if !((length - 1.0).abs() <= ROUNDED) {
                let found = format!("a quaternion of length {length}");
                let expected = format!("one of length 1 to within {ROUNDED}");
                let hint = "the order is w, x, y, z: the cosine of half the angle first";
                let finding = Finding::new(join(pointer, "quaternion"), found, expected);
                self.fault(finding.hint(Some(hint.to_owned())));
            }
        }
        if let Some(rows) = &turn.matrix {
            let matrix = of_rows(rows);
            let miss = (matrix.transpose() * matrix)
                .map_with_location(|i, j, own: f64| (own - f64::from(u8::from(i == j))).abs());
            let expected = format!("rows of length 1 at right angles, to within {ROUNDED}");
            let place = join(pointer, "matrix");
            if !(miss.max() <= ROUNDED) {
                let found = format!("rows that miss those of a rotation by {:.3e}", miss.max());
                self.fault(Finding::new(place, found, expected));
            } else if matrix.determinant() < 0.0 {
                let expected = "a rotation, whose determinant is 1";
                let hint = "a left-handed matrix mirrors the body";
                let finding = Finding::new(place, "a matrix of determinant -1", expected);
                self.fault(finding.hint(Some(hint.to_owned())));
            }
        }
    }

    /// Checks the points of a body that lie between others.
    pub(super) fn points(&mut self, pointer: &str, body: &Body) {
        for (name, point) in &body.points {
            let BodyPoint::Between(Between { between, .. }) = point else {
                continue;
            };
            let place = join(&join(pointer, name), "between");
            for (k, end) in between.iter().enumerate() {
                self.named_point(&join(&place, k), body, end, end);
            }
            if depends_on(body, name, between) {
                let found = format!("a circle through \"{name}\"");
                let expected = "points that do not depend on themselves";
                self.fault(Finding::new(place, found, expected));
            }
        }
    }
}

/// Whether a point lies between points that depend on it.
fn depends_on(body: &Body, name: &str, between: &[String; 2]) -> bool {
    let mut open: Vec<&String> = between.iter().collect();
    let mut seen: Vec<&String> = Vec::new();
    while let Some(end) = open.pop() {
        if end == name {
            return true;
        }
        if seen.contains(&end) {
            continue;
        }
        seen.push(end);
        if let Some(BodyPoint::Between(on)) = body.points.get(end) {
            open.extend(&on.between);
        }
    }
    false
}
