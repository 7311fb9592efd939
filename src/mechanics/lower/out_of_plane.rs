//! Groups of bodies that rotate out of a plane only together.
//!
//! Forces in the plane rotate a body out of it if they act at another height than its centre of
//! mass. A joint that holds two axes parallel prevents this relative rotation. Bodies that such
//! joints connect rotate out of the plane as one; if they are connected to ground, they do not.

use crate::model::{ConstraintRow, Joint};

/// Whether the trivially satisfied rows of a joint keep its bodies parallel.
pub(super) fn holds_upright(trivial_rows: &[ConstraintRow]) -> bool {
    let angles = trivial_rows.iter().filter(|row| row.is_angle());
    angles.count() >= 2
}

/// Group of each of `bodies` bodies; `None` for those that ground holds upright.
pub(super) fn groups<S>(
    bodies: usize,
    joints: &[Joint<S>],
    upright: impl Fn(usize) -> bool,
) -> Vec<Option<usize>> {
    let ground = bodies;
    let mut root: Vec<usize> = (0..=bodies).collect();
    fn find(root: &mut [usize], mut i: usize) -> usize {
        while root[i] != i {
            root[i] = root[root[i]];
            i = root[i];
        }
        i
    }
    for (j, joint) in joints.iter().enumerate() {
        if upright(j) {
            let a = find(&mut root, joint.body_a);
            let b = find(&mut root, joint.body_b.unwrap_or(ground));
            root[a] = b;
        }
    }
    let held = find(&mut root, ground);
    (0..bodies)
        .map(|body| Some(find(&mut root, body)).filter(|&own| own != held))
        .collect()
}
