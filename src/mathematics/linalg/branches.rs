//! Branches of an elimination tree: parts that are eliminated side by side before the rest, the trunk.

use super::front::{Front, Short};
use std::ops::Range;

/// Operations of an elimination from which on it is divided.
const WORTH_DIVIDING: usize = 4_000_000;
/// Most branches.
const MOST: usize = 16;
/// A trunk has at most this part of all operations beside those of the last front.
const TRUNK: usize = 8;
/// A branch has at least this part of all operations.
const LEAST: usize = 64;

/// Fronts that are eliminated side by side with those of other branches. They number their unknowns anew: their own,
/// then those outside.
#[derive(Debug)]
pub(super) struct Branch {
    /// Its fronts.
    pub fronts: Range<usize>,
    /// Its own unknowns.
    pub own: Range<usize>,
    /// The later unknowns that it touches.
    pub outside: Vec<usize>,
    /// The short rows whose columns stand in it.
    pub short: Vec<usize>,
}

impl Branch {
    /// Number of unknowns that it knows.
    pub(super) fn order(&self) -> usize {
        self.own.len() + self.outside.len()
    }

    /// The number of an unknown in the branch.
    fn number(&self, unknown: usize) -> usize {
        match self.own.contains(&unknown) {
            true => unknown - self.own.start,
            false => {
                let found = self.outside.binary_search(&unknown);
                self.own.len() + found.expect("a branch knows what its unknowns touch")
            }
        }
    }
}

/// Operations of the elimination of a front.
pub(super) fn work(front: &Front) -> usize {
    let (p, r) = (front.pivots.len(), front.rest.len());
    p * p * p * 2 / 3 + 2 * p * p * r + 2 * p * r * r
}

/// Divides fronts whose subtrees stand together. Their unknowns, and the rows below the short ones, get the numbers
/// of their branch. The choice depends on the sizes of fronts alone.
pub(super) fn divide(fronts: &mut [Front], short: &mut [Short]) -> Vec<Branch> {
    let mut branches = choose(fronts);
    for branch in &branches {
        for front in &mut fronts[branch.fronts.clone()] {
            let all = front.rest.iter().map(|&i| branch.number(i));
            front.rest = all.collect();
            let at = branch.own.start;
            front.pivots = front.pivots.start - at..front.pivots.end - at;
        }
    }
    for (k, short) in short.iter_mut().enumerate() {
        let holds = |branch: &&mut Branch| branch.own.contains(&short.first);
        let Some(branch) = branches.iter_mut().find(holds) else {
            continue;
        };
        branch.short.push(k);
        for [row, _] in &mut short.below {
            *row = branch.number(*row as usize) as u32;
        }
    }
    branches
}

fn choose(fronts: &[Front]) -> Vec<Branch> {
    let own: Vec<usize> = fronts.iter().map(work).collect();
    let all: usize = own.iter().sum();
    let Some(last) = fronts.len().checked_sub(1) else {
        return Vec::new();
    };
    if all < WORTH_DIVIDING {
        return Vec::new();
    }
    // Work of each subtree, and its first front.
    let (mut subtree, mut first) = (own.clone(), (0..fronts.len()).collect::<Vec<usize>>());
    for (k, front) in fronts.iter().enumerate() {
        for child in &front.children {
            subtree[k] += subtree[child.front];
            first[k] = first[k].min(first[child.front]);
        }
    }
    let children = |k: usize| fronts[k].children.iter().map(|child| child.front);
    let mut roots: Vec<usize> = children(last).collect();
    let mut trunk = 0;
    while roots.len() < MOST {
        let Some(&heaviest) = roots.iter().max_by_key(|&&k| subtree[k]) else {
            break;
        };
        let divided = children(heaviest).any(|k| subtree[k] >= all / LEAST);
        if !divided || trunk + own[heaviest] > all / TRUNK || subtree[heaviest] * MOST < all {
            break;
        }
        trunk += own[heaviest];
        roots.retain(|&k| k != heaviest);
        roots.extend(children(heaviest));
    }
    roots.retain(|&k| subtree[k] >= all / LEAST);
    if roots.len() < 2 {
        return Vec::new();
    }
    roots.sort_unstable();
    let branch = |&k: &usize| {
        let fronts = &fronts[first[k]..=k];
        Branch {
            fronts: first[k]..k + 1,
            own: fronts[0].pivots.start..fronts[fronts.len() - 1].pivots.end,
            outside: fronts[fronts.len() - 1].rest.clone(),
            short: Vec::new(),
        }
    };
    roots.iter().map(branch).collect()
}

/// The order of the nodes of an elimination tree in which every subtree stands together. `later` are the later
/// unknowns that each touches.
pub(super) fn postorder(later: &[Vec<usize>]) -> Vec<usize> {
    let n = later.len();
    let mut earlier = vec![Vec::new(); n];
    for (low, all) in later.iter().enumerate() {
        all.iter()
            .filter(|&&high| high < n)
            .for_each(|&high| earlier[high].push(low));
    }
    // The tree by its paths (Liu 1990).
    let (mut parent, mut ancestor) = (vec![usize::MAX; n], vec![usize::MAX; n]);
    for (high, own) in earlier.iter_mut().enumerate() {
        own.sort_unstable();
        own.dedup();
        for &low in &*own {
            let mut i = low;
            while i != usize::MAX && i != high {
                let next = std::mem::replace(&mut ancestor[i], high);
                if next == usize::MAX {
                    parent[i] = high;
                }
                i = next;
            }
        }
    }
    let mut children = vec![Vec::new(); n];
    let mut stack = Vec::new();
    for (i, &parent) in parent.iter().enumerate().rev() {
        match parent {
            usize::MAX => stack.push((i, false)),
            _ => children[parent].push(i),
        }
    }
    let mut order = Vec::with_capacity(n);
    while let Some((i, done)) = stack.pop() {
        if done {
            order.push(i);
        } else {
            stack.push((i, true));
            stack.extend(children[i].iter().map(|&child| (child, false)));
        }
    }
    order
}
