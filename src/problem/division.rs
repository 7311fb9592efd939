//! A problem that is divided into several: its cases, or the phases of its motion.

use super::Problem;
use std::sync::Arc;

/// A case.
#[derive(Clone, Debug)]
pub struct Case {
    /// Its name.
    pub name: String,
    /// The machine with its values. It has the variables of all cases, no objective and no constraints.
    pub problem: Problem,
}

/// What divides a problem into several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Division {
    /// Cases: machines that move by themselves.
    Cases,
    /// Events: each phase of one motion begins as the one before it ends.
    Events,
}

impl Case {
    /// What is said of it, with its name.
    pub fn tell(&self, what: impl std::fmt::Display) -> String {
        match self.problem.is_phase() {
            true => format!("{}: {what}", self.name),
            false => format!("in the case \"{}\": {what}", self.name),
        }
    }
}

/// The cases of a problem.
#[derive(Clone, Debug)]
pub struct Cases {
    /// In the order of the file.
    pub list: Vec<Case>,
    /// What they are.
    pub division: Division,
    /// By function "FUNCTION in CASE" of the problem: the case, and the function of its problem.
    pub places: Vec<(usize, usize)>,
}

impl Cases {
    /// By case: the functions of its problem that the functions `which` of all cases need. Sorted, each once.
    pub fn wanted(&self, which: &[usize]) -> Vec<Vec<usize>> {
        let mut wanted = vec![Vec::new(); self.list.len()];
        for &(case, function) in which.iter().filter_map(|&f| self.places.get(f)) {
            wanted[case].push(function);
        }
        for own in &mut wanted {
            own.sort_unstable();
            own.dedup();
        }
        wanted
    }

    /// The function of all cases that is function `f` of the problem of a case.
    pub fn number(&self, case: usize, f: usize) -> Option<usize> {
        self.places.iter().position(|own| *own == (case, f))
    }
}

impl Problem {
    /// The case of this name.
    pub fn case(&self, name: &str) -> Option<&Problem> {
        let cases = self.cases.as_ref()?;
        let own = cases.list.iter().find(|case| case.name == name)?;
        Some(&own.problem).filter(|own| !own.is_phase())
    }

    /// Names of its cases; empty if it has none.
    pub fn case_names(&self) -> Vec<&str> {
        let cases = self.cases.iter().flat_map(|cases| &cases.list);
        let alone = cases.filter(|case| !case.problem.is_phase());
        alone.map(|case| case.name.as_str()).collect()
    }

    /// Changes settings of the problem and of each case.
    pub fn change_all(&mut self, change: &dyn Fn(&mut Problem)) {
        change(self);
        if let Some(cases) = &mut self.cases {
            let cases = Arc::make_mut(cases);
            cases
                .list
                .iter_mut()
                .for_each(|case| change(&mut case.problem));
        }
    }
}
