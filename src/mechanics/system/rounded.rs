//! Loops whose numbers are rounded: rows that follow from the others within the tolerance of the input,
//! but not exactly. Imposed, they would lock the loop or keep it from closing.
//!
//! Each network of loops is examined alone and without drives, since its size is the measure: a row whose
//! part across the others is below the tolerance τ, with angles as arcs at the size of the network, moves
//! a body by less than τ times that size. Such rows are left out if the others close, if they stay
//! redundant in a position beside (otherwise the placement is singular), and if in both positions the rows
//! left out are open by at most τ. A network that closes and moves as it is written loses rows only if they
//! are apart from the others by three digits: large networks have small rows by nature.

use super::blocks::{Block, Blocks};
use super::loop_rows::{DependentRow, Rows};
use super::placement::guess;
use crate::math::{Vec3, rotation};
use crate::model::{Mobility, Model};

/// The smallest part of a kept row above the largest of those left out, in a network that moves as written.
const APART: f64 = 1e3;
/// A row of a network is exactly redundant below this misfit.
const EXACT: f64 = 1e-12;

/// The rows that are redundant within the tolerance alone, in networks that have such rows.
pub(super) fn rows(model: &Model<f64>, tolerance: f64) -> Vec<DependentRow> {
    let mut still = model.clone();
    still
        .joints
        .iter_mut()
        .for_each(|joint| joint.drives.clear());
    let blocks = Blocks::of(&still).list;
    let loops = blocks.iter().filter(|block| block.joints.len() > 1);
    let found = loops.filter_map(|block| of_network(&still, block, tolerance));
    found.flatten().collect()
}

fn of_network(model: &Model<f64>, block: &Block, tolerance: f64) -> Option<Vec<DependentRow>> {
    // Flexible bodies deform until the joints fit.
    if block.bodies.iter().any(|&body| model.is_of_flexible(body)) {
        return None;
    }
    let mut part = model.clone();
    for (i, body) in part.bodies.iter_mut().enumerate() {
        if !block.bodies.contains(&i) {
            body.mobility = Mobility::fixed();
        }
    }
    let rows = Rows::new(&part, &block.joints, size(&part, block));
    let (q, _) = guess(&part);
    let near = rows.close(q, Some(tolerance))?;
    let order = rows.order(&near);
    let count = |order: &[(usize, f64)]| order.iter().take_while(|own| own.1 > tolerance).count();
    let strong = count(&order);
    if strong == rows.list.len() {
        return None;
    }
    let unknowns: usize = (block.bodies.iter())
        .map(|&body| part.bodies[body].mobility.unknowns())
        .sum();
    let moves = order.len() < unknowns && rows.close(near.clone(), None).is_some();
    let apart = match order.get(strong) {
        Some((_, weak)) => strong > 0 && order[strong - 1].1 >= APART * weak,
        None => false,
    };
    if moves && !apart {
        return None;
    }
    let mut kept = rows.clone();
    let mut numbers: Vec<usize> = order[..strong].iter().map(|own| own.0).collect();
    numbers.sort_unstable();
    kept.list = numbers.iter().map(|&i| rows.list[i]).collect();
    let placed = kept.close(near, None)?;
    let mut misfits = rows.misfits(&placed);
    if count(&rows.order(&placed)) != strong {
        return None;
    }
    if let Some(beside) = kept.nearby(&placed) {
        if count(&rows.order(&beside)) > strong {
            return None;
        }
        for (misfit, there) in misfits.iter_mut().zip(rows.misfits(&beside)) {
            *misfit = misfit.max(there);
        }
    }
    let out = (0..rows.list.len()).filter(|i| numbers.binary_search(i).is_err());
    // In a long motion rows open by about their part across the others.
    let weak = order.get(strong).map_or(0.0, |own| own.1);
    let misfit = |i: usize| match misfits[i] <= EXACT {
        true => 0.0,
        false => misfits[i].max(weak),
    };
    let out: Vec<DependentRow> = out
        .map(|i| DependentRow {
            joint: rows.list[i].joint,
            row: rows.list[i].row,
            misfit: misfit(i),
        })
        .collect();
    let fits = out.iter().all(|own| own.misfit <= tolerance);
    let is_rounded = out.iter().any(|own| own.misfit > 0.0);
    (fits && is_rounded).then_some(out)
}

/// Size of a network \[m\]: the largest distance of its joints' points; that of the scene if all meet.
fn size(model: &Model<f64>, block: &Block) -> f64 {
    let point = |&j: &usize| -> Vec3<f64> {
        let joint = &model.joints[j];
        let body = &model.bodies[joint.body_a];
        body.position + rotation::matrix(&body.orientation) * joint.frame_a.point
    };
    let points: Vec<Vec3<f64>> = block.joints.iter().map(point).collect();
    let distances = points.iter().map(|point| (point - points[0]).norm());
    let lengths = block.joints.iter().map(|&j| model.joints[j].frame_a.length);
    let size = distances.chain(lengths).fold(0.0, f64::max);
    let scene = super::placement::length_scale(model);
    if size > EXACT * scene { size } else { scene }
}
