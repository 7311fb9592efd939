//! Volume, centre and inertia of the solid inside a closed surface of triangles.
//!
//! By the divergence theorem the integral over the solid is the sum over the tetrahedra of a point and the
//! triangles, with their sign: of the volume V = a·(b × c)/6, the first moments V (a + b + c)/4, and the second
//! moments V/20 (Σ v vᵀ + s sᵀ), s = a + b + c. They are exact
//! (Mirtich 1996, *J. Graphics Tools* 1(2), 31; Eberly 2002, *Polyhedral Mass Properties*).

use super::stl::{Refused, Triangle};
use crate::math::{Mat3, Vec3};
use crate::schema::mechanics::Solid;
use std::collections::HashMap;

/// Volume, relative to that of the box around it, below which a surface has no inside.
const FLAT: f64 = 1e-12;

/// The number of a vertex among those that differ.
type Number = usize;

/// The solid inside a surface, whose unit of length is `unit` \[m\].
pub fn inside(triangles: &[Triangle], unit: f64) -> Result<Solid, Refused> {
    closed(triangles)?;
    let all = triangles.iter().flatten();
    let (low, high) = all.clone().fold(
        (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
        |(low, high): (Vec3<f64>, Vec3<f64>), own| (low.inf(own), high.sup(own)),
    );
    // About the middle, where the tetrahedra are small.
    let middle = (low + high) * 0.5;
    let (mut volume, mut first, mut second) = (0.0, Vec3::zeros(), Mat3::zeros());
    for triangle in triangles {
        let [a, b, c] = triangle.map(|own| (own - middle) * unit);
        let own = a.dot(&b.cross(&c)) / 6.0;
        let s = a + b + c;
        volume += own;
        first += s * (own / 4.0);
        let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
        second += (squares + s * s.transpose()) * (own / 20.0);
    }
    let inwards = volume < 0.0;
    if inwards {
        (volume, first, second) = (-volume, -first, -second);
    }
    let around: f64 = ((high - low) * unit).iter().product();
    if !(volume > FLAT * around) || !volume.is_normal() {
        let found = format!("a surface around a volume of {volume:e} m³");
        return Err((found, "a surface with an inside"));
    }
    let centre = first / volume;
    let second = second - centre * centre.transpose() * volume;
    Ok(Solid {
        volume,
        centre: middle * unit + centre,
        inertia: Mat3::from_diagonal_element(second.trace()) - second,
        outermost: outermost(triangles, unit),
        inwards,
    })
}

/// The vertices that lie farthest along several directions.
fn outermost(triangles: &[Triangle], unit: f64) -> Vec<Vec3<f64>> {
    let steps = [-2.0, -1.0, 0.0, 1.0, 2.0];
    let directions = steps.iter().flat_map(|&x| {
        let planes = steps
            .iter()
            .flat_map(move |&y| steps.map(|z| Vec3::new(x, y, z)));
        planes.filter(|own| own.amax() == 2.0)
    });
    let mut found: Vec<Vec3<f64>> = Vec::new();
    for direction in directions {
        let farthest = triangles
            .iter()
            .flatten()
            .fold(None, |best: Option<Vec3<f64>>, own| match best {
                Some(best) if best.dot(&direction) >= own.dot(&direction) => Some(best),
                _ => Some(*own),
            });
        let point = farthest.map(|own| own * unit);
        found.extend(point.filter(|own| !found.contains(own)));
    }
    found
}

/// Checks that each edge is run through as often in one direction as in the other: then the triangles are the
/// boundary of a solid, and all seen from outside or all from inside.
fn closed(triangles: &[Triangle]) -> Result<(), Refused> {
    let mut numbers: HashMap<[u64; 3], Number> = HashMap::new();
    let mut number = |vertex: &Vec3<f64>| {
        // Both zeros are one place.
        let key = <[f64; 3]>::from(*vertex).map(|own| (own + 0.0).to_bits());
        let next = numbers.len();
        *numbers.entry(key).or_insert(next)
    };
    let corners: Vec<[Number; 3]> = triangles
        .iter()
        .map(|own| own.each_ref().map(&mut number))
        .collect();
    let mut edges: HashMap<[Number; 2], Vec<usize>> = HashMap::new();
    let around = |corners: &[Number; 3]| [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
    for (t, corners) in corners.iter().enumerate() {
        for edge in around(corners) {
            edges.entry(edge).or_default().push(t);
        }
    }
    let along = |edge: [Number; 2]| edges.get(&edge).map_or(&[][..], |own| &own[..]);
    for (t, corners) in corners.iter().enumerate() {
        for (k, [a, b]) in around(corners).into_iter().enumerate() {
            let (same, other) = (along([a, b]), along([b, a]));
            if a == b || same.len() == other.len() {
                continue;
            }
            let [from, to] = [triangles[t][k], triangles[t][(k + 1) % 3]]
                .map(|own| format!("({}, {}, {})", own.x, own.y, own.z));
            let edge = format!("the edge from {from} to {to} of triangle {}", t + 1);
            let second = same.iter().find(|own| **own != t);
            return Err(match second.filter(|_| other.is_empty()) {
                Some(second) => (
                    format!(
                        "{edge}, which triangle {} has in the same direction",
                        second + 1
                    ),
                    "triangles whose vertices all go round as seen from outside",
                ),
                None => (
                    format!("{edge}, where the surface is open"),
                    "a closed surface, in which another triangle has each edge in the other direction",
                ),
            });
        }
    }
    Ok(())
}
