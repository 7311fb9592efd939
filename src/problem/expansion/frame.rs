//! The axes of a used part: its place and rotation, as formulas of parameters.

use super::algebra::{Formula, call, difference, dot, product, quotient, sum};
use crate::expression::Call;
use crate::math::rotation::matrix;
use crate::pointer::join;
use crate::schema::mechanics::Turn;
use crate::turns;
use serde_json::Value;

/// Three formulas.
pub type Triple = [Formula; 3];

/// The axes of a used part.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    /// Place of the origin \[m\]; none at that of ground.
    pub place: Option<Triple>,
    /// Rows of the rotation from axes of the part to those of ground; none if they are the same.
    pub rotation: Option<[Triple; 3]>,
    /// Rotations of the use in order, each with its pointer in the file.
    pub turns: Vec<(Value, String)>,
}

impl Frame {
    /// A direction in ground axes.
    pub fn direction(&self, own: Triple) -> Triple {
        match &self.rotation {
            None => own,
            Some(rows) => rows.clone().map(|row| dot(row, own.clone())),
        }
    }

    /// A point in ground axes.
    pub fn point(&self, own: Triple) -> Triple {
        let turned = self.direction(own);
        match self.place.clone() {
            None => turned,
            Some(place) => plus(turned, place),
        }
    }

    /// Whether its axes are those of ground, at their origin.
    pub fn is_ground(&self) -> bool {
        self.place.is_none() && self.rotation.is_none()
    }
}

fn plus(a: Triple, b: Triple) -> Triple {
    let [a0, a1, a2] = a;
    let [b0, b1, b2] = b;
    [sum(a0, b0), sum(a1, b1), sum(a2, b2)]
}

/// The product of two matrices of rows.
pub fn composed(second: &[Triple; 3], first: &[Triple; 3]) -> [Triple; 3] {
    let column = |j: usize| [0, 1, 2].map(|i: usize| first[i][j].clone());
    second
        .each_ref()
        .map(|row| [0, 1, 2].map(|j| dot(row.clone(), column(j))))
}

/// A number as a formula.
fn of(number: f64) -> Formula {
    Formula::Number(number)
}

/// The rows of the rotation by the angle φ about the axis n of any length, R = cos φ I + (1 − cos φ) n nᵀ + sin φ ñ.
fn about(axis: Triple, angle: Formula) -> [Triple; 3] {
    let length = call(Call::Sqrt, dot(axis.clone(), axis.clone()));
    let n = axis.map(|own| quotient(own, length.clone()));
    let (sin, cos) = (call(Call::Sin, angle.clone()), call(Call::Cos, angle));
    let rest = difference(of(1.0), cos.clone());
    let entry = |i: usize, j: usize| {
        let square = product(rest.clone(), product(n[i].clone(), n[j].clone()));
        match (3 + j - i) % 3 {
            0 => sum(cos.clone(), square),
            1 => difference(square, product(sin.clone(), n[3 - i - j].clone())),
            _ => sum(square, product(sin.clone(), n[3 - i - j].clone())),
        }
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// The rows of the rotation of a quaternion of any length.
fn of_quaternion(q: [Formula; 4]) -> [Triple; 3] {
    let size = call(Call::Sqrt, dot(q.clone(), q.clone()));
    let q = q.map(|own| quotient(own, size.clone()));
    let two = |i: usize, j: usize| product(of(2.0), product(q[i].clone(), q[j].clone()));
    let entry = |i: usize, j: usize| {
        let twist = two(0, (6 - i - j) % 3 + 1);
        match (3 + j - i) % 3 {
            0 => {
                let [a, b] = [(i + 1) % 3 + 1, (i + 2) % 3 + 1];
                difference(difference(of(1.0), two(a, a)), two(b, b))
            }
            1 => difference(two(i + 1, j + 1), twist),
            _ => sum(two(i + 1, j + 1), twist),
        }
    };
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

/// The rows of a rotation of the file; `number` gives the formula of the number at a pointer. None if a form is not
/// complete, which is found elsewhere.
pub fn rotation(
    turn: &Value,
    pointer: &str,
    number: &mut dyn FnMut(&Value, &str) -> Option<Formula>,
) -> Option<[Triple; 3]> {
    const DEGREE: f64 = std::f64::consts::PI / 180.0;
    let mut list = |key: &str| -> Option<Vec<Formula>> {
        let items = turn[key].as_array()?.iter().enumerate();
        let at = join(pointer, key);
        items.map(|(k, own)| number(own, &join(&at, k))).collect()
    };
    let three = |list: Option<Vec<Formula>>| -> Option<Triple> { list?.try_into().ok() };
    let (axis, quaternion) = (three(list("axis")), list("quaternion"));
    let in_degrees = three(list("degrees")).map(|all| all.map(|own| product(own, of(DEGREE))));
    let angles = three(list("angles")).or(in_degrees);
    let mut one = |key: &str| number(turn.get(key)?, &join(pointer, key));
    let radians = match turn.get("degrees") {
        Some(Value::Array(_)) | None => one("angle"),
        Some(_) => one("degrees").map(|own| product(own, of(DEGREE))),
    };
    let along = |k: usize| [0, 1, 2].map(|i| of(f64::from(u8::from(i == k))));
    let named = ["x", "y", "z"].iter().enumerate().find_map(|(k, key)| {
        let angle = product(one(key)?, of(DEGREE));
        Some(about(along(k), angle))
    });
    let sequence = turn["sequence"].as_str().and_then(turns::axes);
    let formulas = match (axis, radians, sequence, angles) {
        (Some(axis), Some(angle), ..) => Some(about(axis, angle)),
        (.., Some(axes), Some(angles)) => {
            let each = axes.into_iter().zip(angles);
            let each = each.map(|(axis, angle)| about(along(axis.imax()), angle));
            each.reduce(|before, own| composed(&before, &own))
        }
        _ => named.or_else(|| Some(of_quaternion(quaternion?.try_into().ok()?))),
    };
    let fixed = |rows: &[Triple; 3]| {
        let mut all = rows.iter().flatten();
        all.all(|own| matches!(own, Formula::Number(_)))
    };
    match formulas {
        Some(rows) if !fixed(&rows) => Some(rows),
        // Numbers are turned as bodies are.
        _ => numeric(turn),
    }
}

/// The rows of a rotation by numbers alone.
fn numeric(turn: &Value) -> Option<[Triple; 3]> {
    let turn: Turn = serde_json::from_value(turn.clone()).ok()?;
    let rotation = matrix(&turns::rotation::<f64>(&turn, &[]));
    Some([0, 1, 2].map(|i| [0, 1, 2].map(|j| of(rotation[(i, j)]))))
}
