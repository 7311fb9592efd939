//! Silhouettes of bodies in the plane of a picture, and what stands around them.

use super::detail::Detail;
use super::elastic_figures::displaced;
use super::shells;
use crate::math::Vec3;
use crate::plots::{Barrier, Scenery};
use crate::problem::{Drawing, Outline};

/// The ground and the barrier of a drawing, and the names of its directions.
pub(super) fn scenery(drawing: &Drawing) -> Scenery {
    // An oblique view shows a sum of coordinates.
    let label = |axis: &Vec3<f64>| {
        const NAMES: [&str; 3] = ["x", "y", "z"];
        let main = axis.iamax();
        let others = (0..3).filter(|&i| i != main && axis[i] != 0.0);
        let other = |i: usize| {
            let sign = if axis[i] < 0.0 { "−" } else { "+" };
            format!(" {sign} {} {}", axis[i].abs(), NAMES[i])
        };
        format!(
            "{}{} [m]",
            NAMES[main],
            others.map(other).collect::<String>()
        )
    };
    Scenery {
        ground: drawing.ground,
        barrier: drawing.barrier.map(|b| Barrier {
            distance: b.distance,
            top: b.top,
        }),
        horizontal: label(&drawing.right),
        vertical: label(&drawing.up),
    }
}

/// The silhouette of a body with elastic coordinates `q` whose points are shown by `place`.
pub(super) fn outline(
    outline: &Outline,
    q: &[f64],
    detail: &Detail,
    place: impl Fn(&Vec3<f64>) -> [f64; 2],
) -> Vec<[f64; 2]> {
    match outline {
        Outline::Deformed(line) => (detail.sides(line.points.len()).into_iter())
            .map(|k| {
                let (point, modes) = &line.points[k];
                place(&displaced(point, modes, q))
            })
            .collect(),
        Outline::Shells(line) => {
            let nodes = shells::places(&line.mesh, q);
            line.nodes.iter().map(|&node| place(&nodes[node])).collect()
        }
        Outline::Hull(corners) => hull(corners.iter().map(place).collect()),
        Outline::Sphere(radius) => {
            let [x, y] = place(&Vec3::zeros());
            let corner = |i: usize| {
                let (s, c) = (std::f64::consts::TAU * i as f64 / 32.0).sin_cos();
                [x + radius * c, y + radius * s]
            };
            (0..32).map(corner).collect()
        }
        Outline::Spokes(ends) => {
            let centre = place(&Vec3::zeros());
            ends.iter()
                .flat_map(|end| [centre, place(end), centre])
                .collect()
        }
    }
}

/// Convex hull, counter-clockwise (Andrew's monotone chain).
fn hull(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let mut chain: Vec<[f64; 2]> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && (b[0] - a[0]) * (p[1] - a[1]) <= (b[1] - a[1]) * (p[0] - a[0])
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut all = half(&mut points.iter().copied());
    all.extend(half(&mut points.iter().rev().copied()));
    if all.is_empty() { points } else { all }
}
