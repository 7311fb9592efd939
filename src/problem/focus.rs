//! A problem without the parts of its scene on which no requested function depends.

use super::{Constraint, Objective, Problem, read};
use crate::lower::{Lowering, Seen};
use std::sync::Arc;

/// The parts of a problem's scenes that are kept.
#[derive(Clone, Debug)]
pub struct Focus {
    /// Kept bodies and functions.
    pub seen: Seen,
    /// Bodies of the whole scenes, those of elastic coordinates among them.
    bodies: usize,
    /// Reductions of the whole scenes.
    whole: Option<Lowering>,
}

impl Problem {
    /// The problem reduced to the functions `asked` and to the bodies on which these or the event
    /// depend. Its functions are renumbered; other functions, also objective and constraints, are
    /// dropped. `None` if nothing is requested, or nothing can or may be removed.
    pub fn focused(&self, asked: &[usize]) -> Option<Self> {
        if asked.is_empty() || self.lowering.is_none() || self.focus.is_some() {
            return None;
        }
        let scene = self.unlowered_scene::<f64>(&self.start());
        let of_scene = self.composition.of_scene(asked);
        if of_scene.is_empty() {
            return None;
        }
        let seen = Seen::find(&scene, &of_scene);
        let all_bodies = seen.keeps_all(&scene.model);
        if all_bodies && seen.functions.len() == scene.functions.len() {
            return None;
        }
        let (composition, expressions) = self.composition.focused(&seen.functions, asked);
        let kept: Vec<usize> = seen.functions.iter().copied().chain(expressions).collect();
        let number = |old: usize| kept.binary_search(&old).ok();
        let names = kept.iter().map(|&f| self.function_names[f].clone());
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
            composition: Arc::new(composition),
            ..self.clone()
        };
        focused.focus = Some(Focus {
            seen,
            bodies: scene.model.bodies.len(),
            whole: self.lowering.clone(),
        });
        if !all_bodies {
            focused.lowering = Some(read::lowering(&focused));
        }
        Some(focused)
    }

    /// The problem reduced to objective and constraints; see [`Problem::focused`].
    pub fn for_optimisation(&self) -> Option<Self> {
        let objective = self.objective?.function;
        let constraints = self.constraints.iter().map(|own| own.function);
        let asked: Vec<usize> = constraints.chain([objective]).collect();
        self.focused(&asked)
    }

    /// The problem with all bodies, if some were removed; it keeps its functions.
    pub fn whole(&self) -> Option<Self> {
        let focus = self.focus.as_ref()?;
        let bodies = focus.bodies;
        if focus.seen.bodies.len() == bodies {
            return None;
        }
        let mut whole = self.clone();
        whole.lowering.clone_from(&focus.whole);
        whole.focus = Some(Focus {
            seen: focus.seen.all_bodies(bodies),
            bodies,
            whole: focus.whole.clone(),
        });
        Some(whole)
    }
}
