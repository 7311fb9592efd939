//! The blocks of the graph of bodies and joints. A block is a joint that lies in no loop, or all
//! joints whose loops share joints (a biconnected component). The root of a block is its body
//! nearest to ground. The blocks form a tree whose root is ground.
//!
//! If no joints lead from ground to some bodies, the first of these takes the place of ground.

use crate::math::Scalar;
use crate::model::Model;

/// A joint that lies in no loop, or a network of loops.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block {
    /// The body nearest to ground; `None` for ground itself.
    pub root: Option<usize>,
    /// The other bodies.
    pub bodies: Vec<usize>,
    /// The joints, in order.
    pub joints: Vec<usize>,
}

/// The blocks of a scene, and its groups of connected bodies.
#[derive(Clone, Debug)]
pub struct Blocks {
    /// From ground outwards: a block comes after the block that holds its root.
    pub list: Vec<Block>,
    /// By body: the first of the bodies that joints connect with it, ground not counted.
    pub group: Vec<usize>,
}

impl Blocks {
    /// The blocks of a model. A coupling is a loop through the bodies of its joints and the carriers of its coordinates.
    pub fn of<S: Scalar>(model: &Model<S>) -> Self {
        let joints = model.joints.iter();
        let mut ends: Vec<_> = joints.map(|joint| (joint.body_a, joint.body_b)).collect();
        for tie in model.ties() {
            // Ground is the least.
            let next = tie.iter().skip(1).chain(&tie[..1]);
            let sides = tie.iter().zip(next).map(|(&a, &b)| (a.max(b), a.min(b)));
            ends.extend(sides.filter_map(|(a, b)| Some((a?, b))));
        }
        let mut blocks = Self::new(model.bodies.len(), &ends);
        for block in &mut blocks.list {
            block.joints.retain(|&joint| joint < model.joints.len());
        }
        blocks
    }

    /// The blocks of `bodies` bodies and of joints with the given `ends`; `None` is ground.
    pub fn new(bodies: usize, ends: &[(usize, Option<usize>)]) -> Self {
        let tree = Tree::new(bodies, ends);
        let mut same: Vec<usize> = (0..ends.len()).collect();
        for (joint, &(a, b)) in ends.iter().enumerate() {
            let mut sides = [a, b.unwrap_or(bodies)];
            // The joints of the loop that this joint closes.
            while sides[0] != sides[1] {
                let deeper = usize::from(tree.depth[sides[0]] < tree.depth[sides[1]]);
                let Some((hung, parent)) = tree.parent[sides[deeper]] else {
                    break;
                };
                unite(&mut same, joint, hung);
                sides[deeper] = parent;
            }
        }
        let mut list: Vec<Block> = Vec::new();
        let mut number = vec![None; ends.len()];
        // The first joint of a block in this order is at its root.
        for &body in &tree.order {
            let Some((joint, parent)) = tree.parent[body] else {
                continue;
            };
            let block = *number[find(&mut same, joint)].get_or_insert_with(|| {
                list.push(Block {
                    root: (parent != bodies).then_some(parent),
                    bodies: Vec::new(),
                    joints: Vec::new(),
                });
                list.len() - 1
            });
            list[block].bodies.push(body);
        }
        for joint in 0..ends.len() {
            if let Some(block) = number[find(&mut same, joint)] {
                list[block].joints.push(joint);
            }
        }
        let mut group: Vec<usize> = (0..bodies).collect();
        for &(a, b) in ends {
            if let Some(b) = b {
                unite(&mut group, a, b);
            }
        }
        let group = (0..bodies).map(|body| find(&mut group, body)).collect();
        Self { list, group }
    }
}

/// A tree of shortest paths from ground. Ground has the number after the last body.
struct Tree {
    /// By body: the joint towards ground, and the node on its other side.
    parent: Vec<Option<(usize, usize)>>,
    depth: Vec<usize>,
    /// Bodies and ground in the order of the search.
    order: Vec<usize>,
}

impl Tree {
    fn new(bodies: usize, ends: &[(usize, Option<usize>)]) -> Self {
        let mut joints = vec![Vec::new(); bodies + 1];
        for (joint, &(a, b)) in ends.iter().enumerate() {
            let b = b.unwrap_or(bodies);
            joints[a].push((joint, b));
            joints[b].push((joint, a));
        }
        let mut tree = Self {
            parent: vec![None; bodies + 1],
            depth: vec![usize::MAX; bodies + 1],
            order: Vec::new(),
        };
        for first in std::iter::once(bodies).chain(0..bodies) {
            if tree.depth[first] != usize::MAX {
                continue;
            }
            tree.depth[first] = 0;
            let mut next = tree.order.len();
            tree.order.push(first);
            while let Some(&at) = tree.order.get(next) {
                next += 1;
                for &(joint, other) in &joints[at] {
                    if tree.depth[other] == usize::MAX {
                        tree.depth[other] = tree.depth[at] + 1;
                        tree.parent[other] = Some((joint, at));
                        tree.order.push(other);
                    }
                }
            }
        }
        tree
    }
}

/// Representative of the set of `i`.
fn find(same: &mut [usize], mut i: usize) -> usize {
    while same[i] != i {
        same[i] = same[same[i]];
        i = same[i];
    }
    i
}

fn unite(same: &mut [usize], i: usize, j: usize) {
    let (i, j) = (find(same, i), find(same, j));
    same[i.max(j)] = i.min(j);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loops_that_share_joints_are_one_block_and_others_are_not() {
        // A four-bar linkage 0 1 2; a pendulum 3 on its coupler 1; two loops 4 5 and 6 7 8 that
        // share no joint, the second on a body of the first.
        let ends = [
            (3, Some(1)),
            (0, None),
            (1, Some(0)),
            (2, Some(1)),
            (2, None),
            (4, None),
            (5, Some(4)),
            (5, None),
            (6, Some(5)),
            (7, Some(6)),
            (5, Some(7)),
            (8, Some(6)),
            (8, Some(7)),
        ];
        let mut blocks = Blocks::new(9, &ends);
        for block in &mut blocks.list {
            block.bodies.sort_unstable();
        }
        let block = |root, bodies: &[usize], joints: &[usize]| Block {
            root,
            bodies: bodies.to_vec(),
            joints: joints.to_vec(),
        };
        let expected = [
            block(None, &[0, 1, 2], &[1, 2, 3, 4]),
            block(Some(1), &[3], &[0]),
            block(None, &[4, 5], &[5, 6, 7]),
            block(Some(5), &[6, 7, 8], &[8, 9, 10, 11, 12]),
        ];
        assert_eq!(blocks.list.len(), expected.len());
        assert!(expected.iter().all(|one| blocks.list.contains(one)));
        assert_eq!(blocks.group, [0, 0, 0, 0, 4, 4, 4, 4, 4]);
        let at = |root: Option<usize>| {
            let inside = |block: &Block| root.is_some_and(|root| block.bodies.contains(&root));
            blocks.list.iter().position(inside)
        };
        for (i, block) in blocks.list.iter().enumerate() {
            assert!(at(block.root).is_none_or(|before| before < i));
        }
    }

    #[test]
    fn two_joints_between_two_bodies_are_a_loop_and_bodies_without_ground_have_a_root() {
        let blocks = Blocks::new(3, &[(1, Some(2)), (2, Some(1)), (0, Some(2))]);
        assert_eq!(blocks.list[0].root, Some(0));
        assert_eq!(blocks.list[0].bodies, [2]);
        assert_eq!(blocks.list[1].joints, [0, 1]);
        assert_eq!(blocks.list[1].root, Some(2));
    }
}
