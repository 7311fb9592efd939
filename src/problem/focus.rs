//! A problem without the parts of its scene that the functions asked for cannot see.

use super::{Constraint, Objective, Problem, read};
use crate::lower::{Lowering, Seen};

/// What is left of a problem's scenes.
#[derive(Clone, Debug)]
pub(crate) struct Focus {
    /// Bodies and functions that are kept.
    pub seen: Seen,
    /// What is left out of the whole scenes before they are integrated.
    whole: Option<Lowering>,
}

impl Problem {
    /// The problem of the functions `asked` and of the bodies that these or the event can see. Its
    /// functions are numbered anew; objective and constraints that are not asked for are dropped. `None`
    /// if nothing can be left out, nothing is asked for, or nothing shall be left out.
    pub(crate) fn focused(&self, asked: &[usize]) -> Option<Self> {
        if asked.is_empty() || self.lowering.is_none() || self.focus.is_some() {
            return None;
        }
        let scene = self.unlowered_scene::<f64>(&self.start());
        let seen = Seen::find(&scene, asked);
        let all_bodies = seen.keeps_all(&scene.model);
        if all_bodies && seen.functions.len() == scene.functions.len() {
            return None;
        }
        let number = |old: usize| seen.functions.binary_search(&old).ok();
        let names = seen
            .functions
            .iter()
            .map(|&f| self.function_names[f].clone());
        let objective = self.objective.and_then(|objective| {
            number(objective.function).map(|function| Objective {
                function,
                ..objective
            })
        });
        let constraints = self.constraints.iter().filter_map(|constraint| {
            number(constraint.function).map(|function| Constraint {
                function,
                ..constraint.clone()
            })
        });
        let mut focused = Self {
            function_names: names.collect(),
            objective,
            constraints: constraints.collect(),
            ..self.clone()
        };
        focused.focus = Some(Focus {
            seen,
            whole: self.lowering.clone(),
        });
        if !all_bodies {
            focused.lowering = Some(read::lowering(&focused));
        }
        Some(focused)
    }

    /// The problem of the objective and the constraints alone, as [`Problem::focused`].
    pub(crate) fn for_optimisation(&self) -> Option<Self> {
        let objective = self.objective?.function;
        let constraints = self.constraints.iter().map(|own| own.function);
        let asked: Vec<usize> = constraints.chain([objective]).collect();
        self.focused(&asked)
    }

    /// The problem with all bodies again, if some were left out; its functions are those asked for.
    pub(crate) fn whole(&self) -> Option<Self> {
        let focus = self.focus.as_ref()?;
        let bodies = self.order.len();
        if focus.seen.bodies.len() == bodies {
            return None;
        }
        let mut whole = self.clone();
        whole.lowering.clone_from(&focus.whole);
        whole.focus = Some(Focus {
            seen: focus.seen.all_bodies(bodies),
            whole: focus.whole.clone(),
        });
        Some(whole)
    }
}
