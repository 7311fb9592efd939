//! Solutions with the factors of a multifrontal elimination, for several right-hand sides: each front is read once.

use super::branches::Branch;
use super::elimination::SolveScalar;
use super::front::System;
use super::multifrontal::Multifrontal;
use super::workspace::Workspace;
use rayon::prelude::*;

impl<S: SolveScalar> Multifrontal<S> {
    /// Solves in place.
    pub(super) fn solve<T: AsMut<[S]>>(&mut self, system: System, b: &mut [T]) {
        let before = match system {
            System::Plain => &self.scaling.rows,
            System::Transposed => &self.scaling.columns,
        };
        b.iter_mut().for_each(|b| scale(b.as_mut(), before));
        let n = self.plan.rows.len();
        self.of_trunk.resize(b.len(), (n, self.plan.short.len()));
        for (i, b) in b.iter_mut().enumerate() {
            self.enter(system, b.as_mut(), i);
        }
        self.forward(system);
        self.backward(system);
        for (i, b) in b.iter_mut().enumerate() {
            self.leave(system, b.as_mut(), i);
        }
        let after = match system {
            System::Plain => &self.scaling.columns,
            System::Transposed => &self.scaling.rows,
        };
        b.iter_mut().for_each(|b| scale(b.as_mut(), after));
    }

    /// Eliminates the short rows beside the unknowns of right-hand side i.
    fn enter(&mut self, system: System, b: &mut [S], i: usize) {
        let (plan, space) = (&self.plan, &mut self.of_trunk);
        let (x, t) = (&mut space.x[i], &mut space.short[i]);
        let by = (&self.inverse[..], &self.beside[..]);
        plan.short.eliminate(system, by, (&mut *b, &mut *t));
        let places = match system {
            System::Plain => &plan.rows,
            System::Transposed => &plan.columns,
        };
        for (x, &place) in x.iter_mut().zip(places) {
            *x = b[place];
        }
        if system == System::Plain {
            let own = &plan.trunk_short;
            plan.short.subtract_below(own, &self.scaled, t, x);
        }
    }

    fn forward(&mut self, system: System) {
        let (plan, done, scaled) = (&self.plan, &self.done, &self.scaled);
        let owners = &self.owners;
        let trunk = &mut self.of_trunk;
        let start = |branch: &Branch, space: &mut Workspace<S>, trunk: &Workspace<S>| {
            space.resize(trunk.x.len(), (branch.order(), 0));
            for ((x, all), t) in space.x.iter_mut().zip(&trunk.x).zip(&trunk.short) {
                let (own, outside) = x.split_at_mut(branch.own.len());
                own.copy_from_slice(&all[branch.own.clone()]);
                outside.fill(S::zero());
                if system == System::Plain {
                    plan.short.subtract_below(&branch.short, scaled, t, x);
                }
            }
            for k in branch.fronts.clone() {
                for x in &mut space.x {
                    done[k].forward(system, &plan.fronts[k], x, &mut space.beside);
                }
            }
        };
        if !plan.branches.is_empty() {
            let trunk = &*trunk;
            let all = plan.branches.par_iter().zip(&mut self.of_branches);
            let all = all.with_max_len(1).enumerate();
            all.filter(|(b, _)| owners.owns(*b))
                .for_each(|(_, (branch, space))| start(branch, space, trunk));
            let outside = |branch: &Branch| branch.own.len()..branch.order();
            owners.exchange_parts(&plan.branches, &mut self.of_branches, outside);
        }
        for (branch, space) in plan.branches.iter().zip(&self.of_branches) {
            for (x, own) in trunk.x.iter_mut().zip(&space.x) {
                for (&i, &own) in branch.outside.iter().zip(&own[branch.own.len()..]) {
                    x[i] += own;
                }
            }
        }
        for &k in &plan.trunk {
            for x in &mut trunk.x {
                done[k].forward(system, &plan.fronts[k], x, &mut trunk.beside);
            }
        }
    }

    fn backward(&mut self, system: System) {
        let (plan, done, owners) = (&self.plan, &self.done, &self.owners);
        let trunk = &mut self.of_trunk;
        if let Some(border) = &mut self.border {
            let first = plan.first_of_border();
            for x in &mut trunk.x {
                border.solve(system, &mut x[first..]);
            }
        }
        for &k in plan.trunk.iter().rev() {
            for x in &mut trunk.x {
                done[k].backward(system, &plan.fronts[k], x, &mut trunk.beside);
            }
        }
        let finish = |branch: &Branch, space: &mut Workspace<S>, trunk: &Workspace<S>| {
            for (x, all) in space.x.iter_mut().zip(&trunk.x) {
                for (x, &i) in x[branch.own.len()..].iter_mut().zip(&branch.outside) {
                    *x = all[i];
                }
            }
            for k in branch.fronts.clone().rev() {
                for x in &mut space.x {
                    done[k].backward(system, &plan.fronts[k], x, &mut space.beside);
                }
            }
        };
        if !plan.branches.is_empty() {
            let trunk = &*trunk;
            let all = plan.branches.par_iter().zip(&mut self.of_branches);
            let all = all.with_max_len(1).enumerate();
            all.filter(|(b, _)| owners.owns(*b))
                .for_each(|(_, (branch, space))| finish(branch, space, trunk));
            let own = |branch: &Branch| 0..branch.own.len();
            owners.exchange_parts(&plan.branches, &mut self.of_branches, own);
        }
        for (branch, space) in plan.branches.iter().zip(&self.of_branches) {
            for (all, own) in trunk.x.iter_mut().zip(&space.x) {
                all[branch.own.clone()].copy_from_slice(&own[..branch.own.len()]);
            }
        }
    }

    /// Writes solution i, with the unknowns of the short rows.
    fn leave(&mut self, system: System, b: &mut [S], i: usize) {
        let (plan, space) = (&self.plan, &mut self.of_trunk);
        let places = match system {
            System::Plain => &plan.columns,
            System::Transposed => &plan.rows,
        };
        for (&x, &place) in space.x[i].iter().zip(places) {
            b[place] = x;
        }
        let t = &mut space.short[i];
        if system == System::Transposed {
            let by = (&self.inverse[..], &self.scaled[..]);
            plan.short.subtract_sums(by, b, t);
        }
        plan.short.substitute_back(system, &self.beside, t, b);
    }
}

fn scale<S: SolveScalar>(b: &mut [S], by: &[f64]) {
    for (b, &by) in b.iter_mut().zip(by) {
        *b = *b * by;
    }
}
