//! Branches of an elimination over ranks: each is eliminated by one, which keeps its factors. What is left of a branch goes
//! to all, and so do its parts of solutions. The trunk is eliminated by every rank.

use super::branches::Branch;
use super::elimination::{SingularMatrix, SolveScalar};
use super::fronts::Plan;
use super::workspace::Workspace;
use crate::math::Team;
use std::ops::Range;

/// The rank of each branch.
pub(super) struct Owners {
    team: Team,
    rank_of: Vec<usize>,
}

impl Owners {
    /// The heaviest branch first, each to the rank that has least work so far (Graham 1969).
    pub(super) fn new(team: &Team, plan: &Plan) -> Self {
        let mut rank_of = vec![team.rank(); plan.branches.len()];
        if !team.is_alone() {
            let mut work = vec![0; team.ranks()];
            let mut order: Vec<usize> = (0..plan.branches.len()).collect();
            order.sort_by_key(|&b| (std::cmp::Reverse(plan.work_of(&plan.branches[b])), b));
            for b in order {
                let least = (0..work.len()).min_by_key(|&rank| work[rank]).unwrap_or(0);
                rank_of[b] = least;
                work[least] += plan.work_of(&plan.branches[b]);
            }
        }
        Self {
            team: team.clone(),
            rank_of,
        }
    }

    /// Whether branch b is of this rank.
    pub(super) fn owns(&self, b: usize) -> bool {
        self.rank_of[b] == self.team.rank()
    }

    /// Whether a front is eliminated here.
    pub(super) fn has_front(&self, plan: &Plan, k: usize) -> bool {
        let branch = plan.branches.iter().position(|own| own.fronts.contains(&k));
        branch.is_none_or(|b| self.owns(b))
    }

    /// Gives the remainders of the own branches to all, and takes those of the others. `done` are the branches of this
    /// rank, and how their eliminations ended.
    ///
    /// # Errors
    /// That of the first branch that is singular.
    pub(super) fn exchange_remainders<S: SolveScalar>(
        &self,
        branches: &[Branch],
        done: Vec<(usize, Result<(), SingularMatrix>)>,
        remainders: &mut [Vec<S>],
    ) -> Result<(), SingularMatrix> {
        let last = |b: usize| branches[b].fronts.end - 1;
        let own = done.into_iter().map(|(b, end)| {
            let column = end.err().map(|singular| singular.column);
            (b, column, std::mem::take(&mut remainders[last(b)]))
        });
        let mut singular: Option<(usize, usize)> = None;
        for (b, column, remainder) in self.team.gather(own) {
            remainders[last(b)] = remainder;
            let found = column.map(|column| (b, column));
            singular = singular.into_iter().chain(found).min();
        }
        match singular {
            Some((_, column)) => Err(SingularMatrix { column }),
            None => Ok(()),
        }
    }

    /// Gives parts of the right-hand sides of the own branches to all, and takes those of the others.
    pub(super) fn exchange_parts<S: SolveScalar>(
        &self,
        branches: &[Branch],
        spaces: &mut [Workspace<S>],
        part: impl Fn(&Branch) -> Range<usize>,
    ) {
        if self.team.is_alone() {
            return;
        }
        let own = (0..branches.len()).filter(|&b| self.owns(b)).map(|b| {
            let part = part(&branches[b]);
            let each = spaces[b].x.iter().map(|x| x[part.clone()].to_vec());
            (b, each.collect::<Vec<Vec<S>>>())
        });
        for (b, told) in self.team.gather(own) {
            if self.owns(b) {
                continue;
            }
            let branch = &branches[b];
            spaces[b].resize(told.len(), (branch.order(), 0));
            for (x, told) in spaces[b].x.iter_mut().zip(&told) {
                x[part(branch)].copy_from_slice(told);
            }
        }
    }
}
