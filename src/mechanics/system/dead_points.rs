//! Dead points of drives: positions in which a driven joint cannot move at first, however the others move, so that the drive
//! does not determine the motion.

use super::loop_rows::{Row, Rows};
use super::placement::{guess, length_scale};
use super::redundant_rows::RedundantRows;
use crate::model::{Joint, Model};

/// A row takes part in a combination of unit rows above this weight.
const TAKES_PART: f64 = 0.01;

/// Whether a joint that is driven cannot move at the placement, however the others move, but can near it: a dead point.
pub fn is_at_dead_point(model: &Model<f64>, joint: &str) -> bool {
    let mut free = model.clone();
    let named = |own: &&mut Joint<f64>| own.name == joint;
    (free.joints.iter_mut().filter(named)).for_each(|own| own.drives.clear());
    let all: Vec<usize> = (0..model.joints.len()).collect();
    let length = length_scale(model);
    let (with, without) = (
        Rows::new(model, &all, length),
        Rows::new(&free, &all, length),
    );
    let Some(placed) = without.close(guess(model).0, None) else {
        return false;
    };
    let Some(beside) = without.nearby(&placed) else {
        return false;
    };
    let rank = |rows: &Rows, q: &[f64]| rows.order(q).len();
    rank(&with, &placed) == rank(&without, &placed)
        && rank(&with, &beside) > rank(&without, &beside)
}

/// The driven joint whose row is part of the combination of rows that is nearest to zero at q: the drive is at a dead
/// point, if this is a singular position.
pub fn driven_to_dead_point<'a>(model: &'a Model<f64>, q: &[f64], time: f64) -> Option<&'a str> {
    let all: Vec<usize> = (0..model.joints.len()).collect();
    let mut rows = Rows::new(model, &all, length_scale(model));
    rows.time = time;
    let left_out = RedundantRows::of(model, &rows.numbering);
    let imposed: Vec<usize> = (0..rows.list.len())
        .filter(|&i| !left_out.contains(rows.list[i].number))
        .collect();
    let svd = rows
        .gradients(q)
        .transposed()
        .select_columns(&imposed)
        .svd(false, true);
    let (least, _) = svd.singular_values.argmin();
    let combination = svd.v_t.as_ref()?.row(least).clone_owned();
    let part = |(k, &i): (usize, &usize)| {
        let Row { joint, row, .. } = rows.list[i];
        let joint = &model.joints[joint];
        let driven = joint
            .drives
            .iter()
            .any(|drive| drive.dof.driven_row() == row);
        (driven && combination[k].abs() > TAKES_PART).then_some(joint.name.as_str())
    };
    imposed.iter().enumerate().find_map(part)
}
