//! The spanning forest of the joints: the body below each joint, and the remaining joints, which
//! close loops.

use crate::model::Model;
use crate::system::numbering::Numbering;

/// A body and the joint that connects it to its parent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    pub body: usize,
    /// Joint, whether the body is on its side A, and the parent (`None` for ground).
    pub joint: Option<(usize, bool, Option<usize>)>,
}

/// A spanning forest of the moving bodies.
pub(super) struct Forest {
    /// Leaves first.
    pub links: Vec<Link>,
    /// Joints with rows that close loops, in the order of the model.
    pub closing: Vec<usize>,
}

/// The forest, breadth first from ground. Bodies without unknowns count as ground; joints without
/// rows do not count.
pub(super) fn forest<S>(model: &Model<S>, numbering: &Numbering) -> Forest {
    let bodies = model.bodies.len();
    let mut parent: Vec<Option<(usize, bool, Option<usize>)>> = vec![None; bodies];
    let mut used = vec![false; model.joints.len()];
    let mut closing = Vec::new();
    // Bodies in the order of the search from ground or a free root.
    let mut reached: Vec<usize> = Vec::with_capacity(bodies);
    let mut seen = vec![false; bodies];
    let moves = |body: usize| numbering.unknowns_of(body) > 0;
    let ends = |j: usize| {
        let joint = &model.joints[j];
        let a = Some(joint.body_a).filter(|&a| moves(a));
        let b = joint.body_b.filter(|&b| moves(b));
        if numbering.rows(j).is_empty() {
            (None, None)
        } else {
            (a, b)
        }
    };
    let mut adjacent = vec![Vec::new(); bodies];
    for j in 0..model.joints.len() {
        let (body, is_a) = match ends(j) {
            (Some(a), None) => (a, true),
            (None, Some(b)) => (b, false),
            (None, None) => continue,
            (Some(a), Some(b)) => {
                adjacent[a].push((j, b, false));
                adjacent[b].push((j, a, true));
                continue;
            }
        };
        if std::mem::replace(&mut seen[body], true) {
            closing.push(j);
            continue;
        }
        parent[body] = Some((j, is_a, None));
        reached.push(body);
    }
    let mut next = 0;
    for root in 0..=bodies {
        while next < reached.len() {
            let from = reached[next];
            next += 1;
            for &(j, to, is_a) in &adjacent[from] {
                if std::mem::replace(&mut used[j], true) {
                    continue;
                }
                if std::mem::replace(&mut seen[to], true) {
                    closing.push(j);
                    continue;
                }
                parent[to] = Some((j, is_a, Some(from)));
                reached.push(to);
            }
        }
        if root < bodies && moves(root) && !std::mem::replace(&mut seen[root], true) {
            reached.push(root);
        }
    }
    closing.sort_unstable();
    let link = |&body: &usize| Link {
        body,
        joint: parent[body],
    };
    Forest {
        links: reached.iter().rev().map(link).collect(),
        closing,
    }
}
