//! Cases: analyses of one machine with some values of its file replaced.
//!
//! A case is a problem of its own: the file with the values of the case, and the functions of the machine that are wanted
//! there. The problem of all cases has the functions of each, "FUNCTION in CASE", in the order of cases, then those that
//! expressions give: functions over cases are expressions of them. So values and derivatives follow from those of the cases
//! by [`Composition`](super::Composition).

use super::composing::{Composing, value_in_case};
use super::division::{Case, Cases, Division};
use super::events;
use super::fault::Faults;
use super::finding::Finding;
use super::overrides::Override;
use super::pointer::join;
use super::read::{self, NEAREST};
use super::source::Source;
use super::stated_cases::Stated;
use super::{Constraint, Objective, Problem, Sense};
use crate::schema::cases::Case as WrittenCase;
use crate::schema::functions::Function;
use crate::schema::{self, Analysis};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::collections::HashMap;
use std::sync::Arc;

/// The problem of all cases; `base` is that of the file without them, `source` the text and the places of its entries.
///
/// # Errors
/// The faults of a case, or of functions over cases.
pub(super) fn complete(
    mut base: Problem,
    stated: Stated,
    source: &Source,
    (file, overrides): (&str, &[Override]),
) -> Result<Problem, Faults> {
    let stated_cases: Vec<_> = stated.cases().collect();
    let read = |&(name, case): &(&String, &WrittenCase)| {
        let found = of_case(&base, &stated, (name, case), source, (file, overrides));
        let problem = found.map_err(|faults| {
            let sets: Vec<String> = case.set.keys().cloned().collect();
            faults.in_case(name, &sets, (file, source))
        })?;
        let name = name.clone();
        Ok(Case { name, problem })
    };
    // All are read, so that the first fault in the order of the file is told.
    let list: Vec<Result<Case, Faults>> = stated_cases.par_iter().map(read).collect();
    let mut list: Vec<Case> = list.into_iter().collect::<Result<_, _>>()?;
    let mut places = Vec::new();
    let mut written = base.written.clone();
    written.functions.clear();
    let mut units = HashMap::new();
    for (c, case) in list.iter().enumerate() {
        for (f, name) in case.problem.function_names.iter().enumerate() {
            let name = value_in_case(name, &case.name);
            units.insert(name.clone(), case.problem.function_unit(f));
            // Expressions of a case are functions like others here.
            let own = case
                .problem
                .written
                .functions
                .get(&case.problem.function_names[f]);
            let own = own.cloned().unwrap_or(Function::Duration);
            written.functions.insert(name, own);
            places.push((c, f));
        }
    }
    let names: Vec<(&str, &[String])> = list
        .iter()
        .map(|case| (case.name.as_str(), &case.problem.function_names[..]))
        .collect();
    stated.state(&mut written, &names);
    let parameters = base.document["parameters"].as_object().cloned();
    let located = |findings| Faults::locate(findings, file, source, overrides);
    let composing = Composing::read(&written, (parameters.as_ref(), source), &Default::default());
    let composing = composing.map_err(located)?;
    let first = places.len();
    base.function_names = written.functions.keys().cloned().collect();
    base.function_names.truncate(first);
    base.function_names.extend(composing.names().cloned());
    let names = (&base.function_names[..], first);
    let mut composition = composing.composition(names, parameters.as_ref(), &base.derived);
    let known = |name: &str| units.get(name).cloned();
    let units = composing.units(known, source).map_err(located)?;
    for (own, unit) in composition.list.iter_mut().zip(units) {
        own.unit = unit;
    }
    let number = |of: &schema::functions::WhichFunction| {
        let name = composing.name(of);
        let place = base.function_names.iter().position(|own| own == name);
        place.expect("names are checked before")
    };
    base.objective = written.objective.as_ref().map(|own| match own {
        schema::Objective::Minimise(of) => Objective {
            function: number(of),
            sense: Sense::Minimise,
        },
        schema::Objective::Maximise(of) => Objective {
            function: number(of),
            sense: Sense::Maximise,
        },
    });
    base.constraints = (written.constraints.iter())
        .map(|(name, own)| Constraint {
            name: name.clone(),
            function: number(&own.function),
            lower: own.lower.unwrap_or(f64::NEG_INFINITY),
            upper: own.upper.unwrap_or(f64::INFINITY),
        })
        .collect();
    for own in &base.constraints {
        if let Some(&(case, function)) = places.get(own.function) {
            // Its pictures show its limits.
            let own = Constraint {
                function,
                ..own.clone()
            };
            list[case].problem.constraints.push(own);
        }
    }
    if base.objective.is_none() && !base.constraints.is_empty() && !base.variables.is_empty() {
        let mut name = NEAREST.to_owned();
        while base.function_names.contains(&name) {
            name.push('\'');
        }
        base.objective = Some(Objective {
            function: base.function_names.len(),
            sense: Sense::Minimise,
        });
        base.function_names.push(name);
        composition
            .list
            .push(super::composed::distance_from_start(&base.variables));
        base.nearest_to = Some(base.start());
    }
    base.composition = Arc::new(composition);
    base.hash = read::hash_of(
        list.iter()
            .fold(base.hash.clone(), |all, case| all + &case.problem.hash),
    );
    (base.statics, base.lowering) = (None, None);
    base.cases = Some(Arc::new(Cases {
        list,
        division: Division::Cases,
        places,
    }));
    Ok(base)
}

/// The problem of a case.
fn of_case(
    base: &Problem,
    stated: &Stated,
    (name, case): (&String, &WrittenCase),
    source: &Source,
    (file, overrides): (&str, &[Override]),
) -> Result<Problem, Faults> {
    let located = |finding| Faults::locate(vec![finding], file, source, overrides);
    let mut document = base.document.clone();
    stated.keep(&mut document, name);
    change(&mut document, (name, case)).map_err(located)?;
    document["name"] = Value::from(value_in_case(&base.name, name));
    let phase = (!base.written.events.is_empty()).then_some(0);
    let at = (file, overrides);
    let found = read::single(document, source.clone(), Vec::new(), at, phase)?.0;
    let names = |problem: &Problem| -> Vec<String> {
        problem
            .variables
            .iter()
            .map(|own| own.name.clone())
            .collect()
    };
    if names(&found) != names(base) {
        let expected = "the same design variables as without the case";
        let pointer = join("/cases", name);
        let finding = Finding::new(pointer, "a set of other thicknesses or sections", expected);
        return Err(located(finding.of_key()));
    }
    match phase {
        Some(_) => events::complete(found, source, at),
        None => Ok(found),
    }
}

/// Removes the velocities of bodies and the rates of joints at the start.
fn stop(document: &mut Value) {
    for body in values(document.get_mut("bodies")) {
        if let Value::Object(body) = body {
            body.shift_remove("velocity");
        }
    }
    for joint in values(document.get_mut("joints")).flat_map(|joint| values(Some(joint))) {
        for motion in values(joint.get_mut("start")) {
            if let Value::Object(motion) = motion {
                motion.retain(|key, _| !["rate", "degrees_per_second"].contains(&key.as_str()));
            }
        }
    }
}

/// The values of an object.
fn values(of: Option<&mut Value>) -> impl Iterator<Item = &mut Value> {
    let all = of.and_then(Value::as_object_mut);
    all.into_iter().flat_map(|all| all.values_mut())
}

/// Replaces the values of a document by those of a case.
fn change(document: &mut Value, (name, case): (&str, &WrittenCase)) -> Result<(), Finding> {
    if let Some(analysis) = case.analysis {
        // What belongs to other analyses.
        const OF_MOTION: [&str; 3] = ["simulation", "start", "initial_velocity"];
        const OF_MODES: [&str; 2] = ["modes", "turning"];
        let (name, others) = match analysis {
            Analysis::Motion => ("motion", OF_MODES.to_vec()),
            Analysis::Rest => ("rest", [&OF_MOTION[..], &OF_MODES].concat()),
            Analysis::Modes => ("modes", OF_MOTION.to_vec()),
        };
        document["analysis"] = json!(name);
        if let Value::Object(entries) = &mut *document {
            for key in others {
                entries.shift_remove(key);
            }
        }
        if analysis != Analysis::Motion {
            stop(document);
        }
    }
    for (path, value) in &case.set {
        let change = Override {
            path: path.clone(),
            value: value.clone(),
        };
        change.apply(document).map_err(|finding| Finding {
            pointer: join(&join(&join("/cases", name), "set"), path),
            found: format!("{} ({path})", finding.found),
            ..finding
        })?;
    }
    Ok(())
}
