//! Rotations of a file in their forms.

use crate::math::rotation::{Quat, compose, from_axis_angle};
use crate::math::{Mat3, Scalar, Vec3};
use crate::quantity::{Degrees, Quantity, vector};
use crate::schema::mechanics::{InDegrees, Turn};

/// Largest miss of a quaternion or a matrix that is given by rounded numbers.
pub const ROUNDED: f64 = 1e-3;

/// Steps of the iteration to the nearest rotation; it converges quadratically.
const STEPS: usize = 8;

/// The unit vector along an axis of this letter.
fn along(letter: char) -> Option<Vec3<f64>> {
    match letter {
        'x' => Some(Vec3::x()),
        'y' => Some(Vec3::y()),
        'z' => Some(Vec3::z()),
        _ => None,
    }
}

/// The axes of a sequence; none if it is not three of x, y and z without two alike in a row.
pub fn axes(sequence: &str) -> Option<[Vec3<f64>; 3]> {
    let axes: Option<Vec<Vec3<f64>>> = sequence.chars().map(along).collect();
    let axes: [Vec3<f64>; 3] = axes?.try_into().ok()?;
    (axes[0] != axes[1] && axes[1] != axes[2]).then_some(axes)
}

/// The one rotation about an axis of the ground that a turn gives.
pub fn about_ground_axis(turn: &Turn) -> Option<(Vec3<f64>, Quantity)> {
    let given = [('x', turn.x), ('y', turn.y), ('z', turn.z)];
    given
        .into_iter()
        .find_map(|(letter, degrees)| Some((along(letter)?, degrees?.0)))
}

/// The angles of a sequence \[rad\].
pub fn angles(turn: &Turn) -> Option<[Quantity; 3]> {
    let in_degrees = match &turn.degrees {
        Some(InDegrees::Three(angles)) => Some(angles.map(|Degrees(angle)| angle)),
        _ => None,
    };
    turn.angles.or(in_degrees)
}

/// The angle about an axis \[rad\].
pub fn angle(turn: &Turn) -> Option<Quantity> {
    let in_degrees = match &turn.degrees {
        Some(InDegrees::One(Degrees(angle))) => Some(*angle),
        _ => None,
    };
    turn.angle.or(in_degrees)
}

/// The rotation of a checked turn at the design `x`.
pub fn rotation<S: Scalar>(turn: &Turn, x: &[S]) -> Quat<S> {
    let about = |axis: Vec3<f64>, angle: Quantity| {
        from_axis_angle(&axis.map(|own| S::from(own)), angle.get(x))
    };
    let none = [S::one(), S::zero(), S::zero(), S::zero()];
    if let (Some(axis), Some(angle)) = (&turn.axis, angle(turn)) {
        return from_axis_angle(&vector(axis, x), angle.get(x));
    }
    if let Some((axis, angle)) = about_ground_axis(turn) {
        return about(axis, angle);
    }
    if let (Some(axes), Some(angles)) = (turn.sequence.as_deref().and_then(axes), angles(turn)) {
        // Each is about axes that those before it have turned, so a later one multiplies from the right.
        let each = axes.into_iter().zip(angles);
        return each.fold(none, |turned, (axis, angle)| {
            compose(&turned, &about(axis, angle))
        });
    }
    if let Some(quaternion) = &turn.quaternion {
        let all = quaternion.map(|own| own.get(x));
        let size = all
            .iter()
            .fold(S::zero(), |sum, &own| sum + own * own)
            .sqrt();
        return all.map(|own| own / size);
    }
    match &turn.matrix {
        Some(rows) => of_matrix(&nearest(&of_rows(rows))).map(S::from),
        None => none,
    }
}

/// A matrix of rows.
pub fn of_rows(rows: &[[f64; 3]; 3]) -> Mat3<f64> {
    Mat3::from_fn(|i, j| rows[i][j])
}

/// The rotation nearest to a matrix near one: R ← (R + R⁻ᵀ)/2
/// (Higham 1986, *SIAM J. Sci. Stat. Comput.* 7, 1160).
fn nearest(matrix: &Mat3<f64>) -> Mat3<f64> {
    (0..STEPS).fold(*matrix, |own, _| {
        own.try_inverse()
            .map_or(own, |inverse| (own + inverse.transpose()) * 0.5)
    })
}

/// The Euler parameters of a rotation matrix, by its largest of them
/// (Shepperd 1978, *J. Guidance Control* 1, 223).
fn of_matrix(r: &Mat3<f64>) -> Quat<f64> {
    let trace = r.trace();
    let squares = [trace, r[(0, 0)], r[(1, 1)], r[(2, 2)]];
    let largest = (0..4).fold(
        0,
        |best, i| if squares[i] > squares[best] { i } else { best },
    );
    let twist = [
        r[(2, 1)] - r[(1, 2)],
        r[(0, 2)] - r[(2, 0)],
        r[(1, 0)] - r[(0, 1)],
    ];
    let unscaled = match largest {
        0 => [1.0 + trace, twist[0], twist[1], twist[2]],
        own => {
            let i = own - 1;
            let mut all = [twist[i], 0.0, 0.0, 0.0];
            for j in 0..3 {
                all[j + 1] = match i == j {
                    true => 1.0 + 2.0 * r[(i, i)] - trace,
                    false => r[(i, j)] + r[(j, i)],
                };
            }
            all
        }
    };
    let size = unscaled.iter().map(|own| own * own).sum::<f64>().sqrt();
    unscaled.map(|own| own / size)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::rotation::matrix;

    /// Quaternion to matrix and back, for rotations of all kinds.
    #[test]
    fn matrices_are_their_rotations() {
        for quaternion in [
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.6, 0.0, -0.8],
            [0.1, -0.7, 0.5, 0.5],
            [0.5, -0.5, 0.5, 0.5],
        ] {
            let rotation = matrix(&quaternion);
            let found = matrix(&of_matrix(&nearest(&rotation)));
            assert!((found - rotation).norm() < 1e-14, "{quaternion:?}");
        }
    }
}
