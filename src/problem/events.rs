//! The problem of a motion that events divide: a problem for each phase, and functions of the whole motion as expressions of
//! those of the phases.
//!
//! ```text
//! final        that of the last phase
//! integral     Σ F_p
//! mean         Σ T_p m_p / Σ T_p
//! ks           (1/ρ) ln Σ (T_p/T) e^{ρ K_p}, from above (1/ρ) ln Σ e^{ρ K_p}
//! duration     Σ T_p
//! ```

use super::Problem;
use super::composed::{Composed, Composition, Term, distance_from_start};
use super::division::{Case, Cases, Division};
use super::expression::{Call, Expression, Operator};
use super::fault::Faults;
use super::finding::Finding;
use super::overrides::Override;
use super::phases::quantity_of;
use super::pointer::join;
use super::read;
use super::source::Source;
use crate::functions::{Function, Reduction, Release};
use crate::math::soft_max::Bound;
use crate::schema::events::When;
use serde_json::{Value, json};
use std::sync::Arc;

/// The function of the duration of a phase.
const DURATION: &str = "duration of the phase";

type OfFunctions = Expression<Term>;

/// The problem of the whole motion; `base` is that of its first phase, with the functions of the file.
///
/// # Errors
/// The faults of a phase, or a function that has no value over several.
pub(super) fn complete(
    mut base: Problem,
    source: &Source,
    (file, overrides): (&str, &[Override]),
) -> Result<Problem, Faults> {
    let located = |findings| Faults::locate(findings, file, source, overrides);
    let names = phase_names(&base);
    let mut list = Vec::new();
    for (phase, name) in names.iter().enumerate() {
        let mut document = of_phase(&base);
        document["name"] = Value::from(format!("{} {name}", base.name));
        let source = source.clone();
        let problem = read::single(document, source, Vec::new(), (file, overrides), Some(phase))?.0;
        list.push(Case {
            name: name.clone(),
            problem,
        });
    }
    // Functions of the file in each phase, then the durations.
    let of_scene = base.written.functions.len();
    let own: Vec<&String> = list[0].problem.function_names.iter().collect();
    let wanted: Vec<usize> = (0..own.len())
        .filter(|&f| f < of_scene || own[f] == DURATION)
        .collect();
    let (mut places, mut function_names) = (Vec::new(), Vec::new());
    for (phase, name) in names.iter().enumerate() {
        for &f in &wanted {
            places.push((phase, f));
            function_names.push(format!("{} {name}", own[f]));
        }
    }
    let taken = base
        .function_names
        .iter()
        .find(|name| function_names.contains(name));
    if let Some(name) = taken {
        let found = "the name of a function in a phase of the motion";
        let finding = Finding::new(join("/functions", name), found, "another name").of_key();
        return Err(located(vec![finding]));
    }
    let first = places.len();
    let values = Values {
        places: &places,
        phases: [0, base.written.events.len()],
        duration: wanted.last().copied().unwrap_or_default(),
    };
    let scene = base.unlowered_scene::<f64>(&base.start());
    let (mut composed, mut findings) = (Vec::new(), Vec::new());
    for (f, name) in base.written.functions.keys().enumerate() {
        let values = Values {
            phases: base.written.phases_of(&base.written.functions[f]),
            ..values
        };
        match values.over_phases(f, &scene.functions[f]) {
            Ok(expression) => composed.push(Composed {
                expression,
                unit: scene.functions[f].unit(),
            }),
            Err(found) => {
                let expected = "a final value, an integral, a mean, ks or the duration, of the whole motion or between \
                                events";
                findings.push(Finding::new(join("/functions", name), found, expected));
            }
        }
    }
    if !findings.is_empty() {
        return Err(located(findings));
    }
    if base.nearest_to.is_some() {
        composed.push(distance_from_start(&base.variables));
    }
    for own in &base.composition.list {
        let moved = |term: &Term| match *term {
            Term::Function(f) => Ok::<Term, ()>(Term::Function(first + f)),
            other => Ok(other),
        };
        if let Ok(expression) = own.expression.named(&mut |term| moved(term)) {
            let unit = own.unit.clone();
            composed.push(Composed { expression, unit });
        }
    }
    function_names.append(&mut base.function_names);
    base.function_names = function_names;
    base.composition = Arc::new(Composition {
        first,
        list: composed,
        derived: base.derived.clone(),
    });
    if let Some(objective) = &mut base.objective {
        objective.function += first;
    }
    for own in &mut base.constraints {
        own.function += first;
    }
    (base.statics, base.lowering, base.written.phase) = (None, None, None);
    base.cases = Some(Arc::new(Cases {
        list,
        division: Division::Events,
        places,
    }));
    Ok(base)
}

/// Names of the phases: before the first event, and after each.
fn phase_names(base: &Problem) -> Vec<String> {
    let events = base.written.events.keys();
    let first = events.clone().next().map(|name| format!("before {name}"));
    let others = events.map(|name| format!("after {name}"));
    first.into_iter().chain(others).collect()
}

/// The file with the functions that all phases have: those of the motion, the quantities of events, and the duration.
fn of_phase(base: &Problem) -> Value {
    let mut document = base.document.clone();
    if let Value::Object(entries) = &mut document {
        for key in ["objective", "constraints"] {
            entries.shift_remove(key);
        }
        let functions = entries.entry("functions").or_insert_with(|| json!({}));
        if let Value::Object(functions) = functions {
            functions.retain(|name, _| base.written.functions.contains_key(name));
        }
    }
    for (name, event) in &base.written.events {
        if let When::Reaches(_) = event.when {
            let measure = document["events"][name]["when"]["measure"].clone();
            document["functions"][quantity_of(name)] = json!({"final": measure});
        }
    }
    document["functions"][DURATION] = json!("duration");
    document
}

fn both(operator: Operator, a: OfFunctions, b: OfFunctions) -> OfFunctions {
    Expression::Binary(operator, Box::new([a, b]))
}

fn sum(terms: impl Iterator<Item = OfFunctions>) -> OfFunctions {
    let sum = terms.reduce(|sum, term| both(Operator::Plus, sum, term));
    sum.unwrap_or(Expression::Number(0.0))
}

/// The values of functions in some phases of a motion.
#[derive(Clone, Copy)]
struct Values<'a> {
    places: &'a [(usize, usize)],
    /// The first and the last of them.
    phases: [usize; 2],
    /// The function of the duration.
    duration: usize,
}

impl Values<'_> {
    fn of(&self, function: usize, phase: usize) -> OfFunctions {
        let place = self.places.iter().position(|own| *own == (phase, function));
        Expression::Name(Term::Function(
            place.expect("phases have the same functions"),
        ))
    }

    fn each(&self, function: usize) -> impl Iterator<Item = OfFunctions> {
        (self.phases[0]..=self.phases[1]).map(move |phase| self.of(function, phase))
    }

    /// T_p / T.
    fn parts(&self) -> impl Iterator<Item = OfFunctions> {
        let whole = sum(self.each(self.duration));
        let own = self.each(self.duration);
        own.map(move |own| both(Operator::Over, own, whole.clone()))
    }

    /// The value over all phases of function `f`, which is `function` in each; or what it is, if it has none.
    fn over_phases(&self, f: usize, function: &Function<f64>) -> Result<OfFunctions, &'static str> {
        let last = || self.of(f, self.phases[1]);
        let reduction = match function {
            Function::Reduced {
                during: Some(_), ..
            } => return Err("a window of time of a motion with events"),
            Function::Reduced { reduction, .. } => *reduction,
            Function::Clearance {
                release: Release::Final,
                ..
            } => return Ok(last()),
            Function::Duration => return Ok(sum(self.each(f))),
            Function::OfDesign { .. } => return Ok(self.of(f, 0)),
            Function::Clearance { .. } => return Err("the best release of a motion with events"),
            Function::Misfit { .. } => return Err("a misfit of a motion with events"),
            Function::LowestFrequency { .. } => return Err("frequencies of a motion with events"),
        };
        Ok(match reduction {
            Reduction::Final => last(),
            Reduction::Integral => sum(self.each(f)),
            Reduction::Mean => {
                let terms = self.parts().zip(self.each(f));
                sum(terms.map(|(part, own)| both(Operator::Times, part, own)))
            }
            Reduction::Ks {
                rho,
                bound: Bound::Above,
            } => Expression::Ks(rho, self.each(f).collect()),
            Reduction::Ks {
                rho,
                bound: Bound::Below,
            } => {
                let weighted = |(part, own)| {
                    let log = Expression::Call(Call::Log, Box::new(part));
                    let shift = both(Operator::Over, log, Expression::Number(rho));
                    both(Operator::Plus, own, shift)
                };
                let terms = self.parts().zip(self.each(f));
                Expression::Ks(rho, terms.map(weighted).collect())
            }
            Reduction::InducedExponential { .. } => {
                return Err("an induced exponential of a motion with events");
            }
            Reduction::Damage { .. } => return Err("fatigue damage of a motion with events"),
        })
    }
}
