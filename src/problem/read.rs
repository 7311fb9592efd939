//! Reads the text of a problem file: a problem, or all of its faults.

use super::aggregates;
use super::centres;
use super::check::check;
use super::composing::{Composing, strip};
use super::derived::{Derived, Expressions};
use super::elements;
use super::expansion;
use super::fault::Faults;
use super::file_text::{self, Unread};
use super::finding::Finding;
use super::first_scene::{
    collapsed, driven_twice, miscoupled, oblique, too_many, unassembled, unstarted, without_inertia,
};
use super::gmsh;
use super::holds;
use super::measurements;
use super::modal;
use super::overrides::Override;
use super::placement::placement_order;
use super::pointer::join;
use super::points;
use super::prune::prune;
use super::quantity_units::{mismatched, name_units, name_units_of_joints};
use super::source::Source;
use super::stated_cases::Stated;
use super::statics::expand::expand;
use super::statics::per_thickness;
use super::statics::{Asked, Statics};
use super::structure::walk;
use super::surfaces;
use super::text;
use super::variables::{bind, variables};
use super::{Constraint, Objective, OptimiserSettings, Problem, Sense, Simulation};
use crate::integrate::{self, Spacing, Start};
use crate::lower::{self, Lowering};
use crate::math::{Dual, Team};
use crate::model::Model;
use crate::optimiser::Method;
use crate::schema::functions::WhichFunction;
use crate::schema::{self, Document};
use crate::structures::quality::MeshFault;
use crate::system::redundancy;
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

/// Default error per step, if the file gives neither steps nor a tolerance.
const TOLERANCE: f64 = 1e-9;
/// That with other elastic bodies: their functions are then accurate to about 1e-3 … 1e-8 of themselves, for a fifth to a
/// thirtieth of the steps (docs/flexible.md).
const TOLERANCE_OF_FLEXIBLE: f64 = 1e-6;
/// That with finite elements of all nodes, whose fast vibrations would set the steps. Positions are then accurate to about 1e-9.
const TOLERANCE_OF_ELEMENTS: f64 = 1e-5;

/// Name of the objective if the nearest feasible design is sought.
pub(super) const NEAREST: &str = "squared distance from the start";

/// The text of a problem file, and its name in faults.
pub(super) fn text_of(path: &Path) -> Result<(String, String), Faults> {
    let file = path.display().to_string();
    let text = file_text::read(path).map_err(|unread| match unread {
        Unread::Missing(found) => Faults::unreadable(&file, &found, "a problem file"),
        Unread::Faulty(faults) => faults,
    })?;
    Ok((text, file))
}

/// The document of a text with its changes, the places of its entries, and what is wrong so far.
pub(super) fn document(
    written: &str,
    file: &str,
    overrides: &[Override],
) -> Result<(Value, Source, Vec<Finding>), Faults> {
    // A text may begin with a byte order mark, JSON may not.
    let written = written.strip_prefix('\u{feff}').unwrap_or(written);
    let mut document = file_text::json(written, file)?;
    let mut source = Source::index(written);
    let mut findings: Vec<Finding> = source.duplicates.iter().map(expansion::twice).collect();
    expansion::read(&mut document, file, &mut source)?;
    for change in overrides {
        findings.extend(change.apply(&mut document).err());
    }
    Ok((document, source, findings))
}

/// The problem of a document without its cases, and what it states of these, if it has some. `findings` are known already;
/// of a motion with events it is that of a phase.
pub(super) fn single(
    mut document: Value,
    mut source: Source,
    mut findings: Vec<Finding>,
    (file, overrides): (&str, &[Override]),
    phase: Option<usize>,
) -> Result<(Problem, Option<Stated>), Faults> {
    findings.extend(text::faults(&document));
    let mut original = None;
    if expansion::is_needed(&document) {
        original = Some(document.clone());
        if let Err(wrong) = expansion::expand(&mut document, &mut source) {
            findings.extend(wrong);
            return Err(Faults::locate(findings, file, &source, overrides));
        }
    }
    let mut structure = walk(&document, schema::schema());
    let faults = |findings| Err(Faults::locate(findings, file, &source, overrides));
    let mut expressions = Expressions::default();
    let original = match structure.expressions.is_empty() {
        true => original,
        false => {
            let whole = original.unwrap_or_else(|| document.clone());
            expressions = match Expressions::evaluate(&document, &structure, &source) {
                Ok(expressions) => expressions,
                Err(wrong) => {
                    findings.extend(structure.findings);
                    findings.extend(wrong);
                    return faults(findings);
                }
            };
            expressions.replace(&mut document);
            structure = walk(&document, schema::schema());
            Some(whole)
        }
    };
    // Whether a simulation is missing is only known with the analysis.
    if structure
        .findings
        .iter()
        .any(|own| own.pointer == "/analysis")
    {
        let missing = |own: &Finding| own.pointer.is_empty() && own.found == "no \"simulation\"";
        structure.findings.retain(|own| !missing(own));
    }
    source.origins.name_units(&mut structure.numbers);
    findings.extend(structure.findings.iter().cloned());
    let mut sound = document.clone();
    let Value::Object(entries) = &mut sound else {
        return faults(findings);
    };
    let damage = prune(entries, &structure.findings);
    let mut written = match deserialise(&sound) {
        Ok(written) => written,
        Err(finding) => {
            findings.push(finding);
            return faults(findings);
        }
    };
    written.phase = phase;
    // Other files are read only if the document has no faults.
    let content = match structure.findings.is_empty() {
        true => {
            let content = modal::load(&mut written, (file, &source))?;
            content
                + &surfaces::load(&mut written, (file, &source))?
                + &measurements::load(&mut written, (file, &source))?
                + &gmsh::load(&mut written, (file, &source))?
        }
        false => String::new(),
    };
    let stated = Stated::read(&written);
    if let Some(stated) = &stated {
        if damage.is_empty() {
            findings.extend(stated.faults(&written));
        }
        stated.prepare(&mut written);
    }
    findings.extend(check(&written, &damage));
    if let Some(stated) = &stated {
        stated.strip(&mut written);
    }
    let parameters = document["parameters"].as_object().cloned();
    let composing = match Composing::read(&written, (parameters.as_ref(), &source), &damage) {
        Ok(composing) => composing,
        Err(wrong) => {
            findings.extend(wrong);
            Composing::default()
        }
    };
    strip(&mut written);
    let (variables, wrong) = variables(&written, (&document, &structure), &|path| {
        expressions.gives(path)
    });
    findings.extend(wrong);
    if !findings.is_empty() {
        return faults(findings);
    }
    let shells = written.bodies.values().any(|body| body.elements.is_some());
    let mut variables = match written.structures.is_empty() && !shells {
        true => variables,
        false => match per_thickness::expand(&written, &mut sound)
            .and_then(|()| expand(&written, &mut sound, variables))
        {
            Ok(variables) => variables,
            Err(finding) => return faults(vec![finding]),
        },
    };
    let derived = match expressions.bind(&mut sound, &mut variables, &structure) {
        Ok(derived) => derived,
        Err(findings) => return faults(findings),
    };
    bind(&mut sound, &variables);
    let order = placement_order(&written).expect("a checked document has no circle of places");
    match deserialise(&sound) {
        Ok(mut bound) => {
            bound.phase = phase;
            if let Some(stated) = &stated {
                stated.prepare(&mut bound);
                stated.strip(&mut bound);
            }
            strip(&mut bound);
            modal::share(&written, &mut bound);
            surfaces::share(&written, &mut bound);
            measurements::share(&written, &mut bound);
            gmsh::share(&written, &mut bound);
            elements::share(&written, &mut bound);
            let document = original.unwrap_or(document);
            let mut problem = problem(document, (bound, &content), order, variables, &composing);
            problem.derived = derived;
            let first = problem.function_names.len() - composing.names().count();
            let names = (&problem.function_names[..], first);
            let own = composing.composition(names, parameters.as_ref(), &problem.derived);
            problem.composition = Arc::new(own);
            let finding = measurements::without_residuals(&problem);
            let finding = finding.or_else(|| aggregates::without_rho(&problem.document));
            if let Some(finding) = finding {
                return faults(vec![finding]);
            }
            if !problem.written.structures.is_empty() {
                let done = of_structures(&mut problem);
                return match done.and_then(|()| give_units(&mut problem, &composing, &source)) {
                    Ok(()) => Ok((problem, stated)),
                    Err(findings) => faults(findings),
                };
            }
            let scene = problem.unlowered_scene(&problem.start());
            name_units(&mut problem.variables, &problem.function_names, &scene);
            name_units_of_joints(&mut problem.variables, &scene);
            let mut model = scene.model;
            leave_out(&mut problem, &mut model);
            let finding = points::moved_meshes(&problem)
                .or_else(|| too_many(&problem))
                .or_else(|| unstarted(&problem))
                .or_else(|| collapsed(&problem))
                .or_else(|| oblique(&problem))
                .or_else(|| miscoupled(&problem))
                .or_else(|| points::beside(&problem))
                .or_else(|| points::off_beams(&problem))
                .or_else(|| points::off_points(&problem))
                .or_else(|| points::off_interfaces(&problem))
                .or_else(|| points::moved_places(&problem))
                .or_else(|| driven_twice(&problem))
                .or_else(|| unassembled(&problem))
                .or_else(|| mismatched(&problem));
            match finding {
                Some(finding) => faults(vec![finding]),
                None => {
                    problem.lowering = Some(lowering(&problem));
                    match without_inertia(&problem) {
                        Some(finding) => faults(vec![finding]),
                        None => match give_units(&mut problem, &composing, &source) {
                            Ok(()) => Ok((problem, stated)),
                            Err(findings) => faults(findings),
                        },
                    }
                }
            }
        }
        Err(finding) => faults(vec![finding]),
    }
}

/// Gives expressions of functions their units.
fn give_units(
    problem: &mut Problem,
    composing: &Composing,
    source: &Source,
) -> Result<(), Vec<Finding>> {
    if problem.composition.list.is_empty() {
        return Ok(());
    }
    let names = problem.function_names[..problem.composition.first].iter();
    let own = names.zip(problem.units_of_scene());
    let known: HashMap<&str, String> = (own.map(|(name, unit)| (name.as_str(), unit))).collect();
    let units = composing.units(|name| known.get(name).cloned(), source)?;
    let composition = Arc::make_mut(&mut problem.composition);
    for (own, unit) in composition.list.iter_mut().zip(units) {
        own.unit = unit;
    }
    Ok(())
}

/// Completes a problem of structures, or reports the faults of their meshes and supports.
fn of_structures(problem: &mut Problem) -> Result<(), Vec<Finding>> {
    let start = problem.start_numbers();
    let mut statics = Statics::new(&problem.written, &start, 1).map_err(|found| {
        let of = |(name, fault): &(String, MeshFault)| {
            let pointer = join(&join("/structures", name), "mesh");
            let expected = "a mesh of sound elements";
            Finding::new(pointer, fault.to_string(), expected).of_key()
        };
        found
            .iter()
            .take(MOST_MESH_FAULTS)
            .map(of)
            .collect::<Vec<_>>()
    })?;
    if problem.nearest_to.is_some() {
        statics.functions.push(Asked::DistanceFromStart);
    }
    let unsupported: Vec<Finding> = (statics.unsupported().into_iter())
        .map(|f| {
            let pointer = join("/functions", &problem.function_names[f]);
            let found = "the reaction of nodes that no support holds in this direction";
            Finding::new(pointer, found, "nodes that a support holds")
        })
        .collect();
    if !unsupported.is_empty() {
        return Err(unsupported);
    }
    if let Some((case, load, at)) = statics.moment_along_normal(&problem.written, &start) {
        let cases = &problem.written.load_cases;
        let named = cases.get_index(case).and_then(|(name, loads)| {
            let (load, _) = loads.get_index(load)?;
            Some(join(&join("/load_cases", name), load))
        });
        let pointer = join(&join(&named.unwrap_or_default(), "point"), "moment");
        let found = format!(
            "a moment with a part along the normal of the shell at ({:.4}, {:.4}, {:.4}) m",
            at.x, at.y, at.z
        );
        let expected = "moments about tangents, as nodes have no rotation about the normal";
        let hint =
            "\"statics\": {\"node_unknowns\": \"six\"} gives them one, with a small stiffness";
        return Err(vec![
            Finding::new(pointer, found, expected).hint(Some(hint.into())),
        ]);
    }
    if let Some((name, failure)) = statics.mechanism(&problem.written, &start) {
        let pointer = join("/structures", &name);
        let expected = "supports that hold every part of it";
        let finding = Finding::new(pointer, failure.to_string(), expected);
        return Err(vec![finding.of_key()]);
    }
    problem.statics = Some(Arc::new(statics));
    Ok(())
}

/// Largest number of reported faults of meshes.
const MOST_MESH_FAULTS: usize = 5;

/// Leaves out redundant rows of the joints of a problem, whose start is `model`.
fn leave_out(problem: &mut Problem, model: &mut Model<f64>) {
    problem.redundant = redundancy::leave_out(model);
    let rows = model
        .joints
        .iter()
        .map(|joint| (joint.redundant.clone(), joint.fit));
    problem.left_out = rows.collect();
}

/// The problem with other bodies in its document.
pub(super) fn remade(problem: &Problem, written: Document) -> Problem {
    let mut out = Problem {
        written,
        left_out: Vec::new(),
        ..problem.clone()
    };
    let mut model = out.unlowered_scene(&out.start()).model;
    leave_out(&mut out, &mut model);
    if problem.lowering.is_some() {
        out.lowering = Some(lowering(&out));
    }
    out
}

/// The reductions of the scenes of a problem.
pub(super) fn lowering(problem: &Problem) -> Lowering {
    let variables: Vec<lower::Range> = problem
        .variables
        .iter()
        .map(|variable| lower::Range {
            name: variable.name.clone(),
            start: variable.start,
            bounds: [variable.lower, variable.upper],
            scale: variable.scale,
        })
        .collect();
    // Equilibrium is sought at the start alone: what is in a plane as placed, with all of its loads, stays there, and where it
    // buckles out of it the scene of that design is not reduced.
    let placed = problem.without_equilibrium();
    let placed = placed.as_ref().unwrap_or(problem);
    let start = problem.unlowered_scene::<f64>(&problem.start());
    let real = |x: &[f64]| placed.unlowered_scene(x);
    let dual = |x: &[Dual]| placed.unlowered_scene(x);
    match problem.is_phase() {
        true => Lowering::of_plane(start, (&real, &dual), &variables),
        false => Lowering::find(start, (&real, &dual), &variables),
    }
}

/// Deserialises a document.
fn deserialise(document: &Value) -> Result<Document, Finding> {
    let mut written = schema::read(document).map_err(|(path, found)| {
        let pointer: String = path.iter().map(|segment| join("", segment)).collect();
        Finding::new(pointer, found, "what the schema says")
    })?;
    holds::find_welds(&mut written);
    centres::fill(&mut written)?;
    Ok(written)
}

/// The problem of a checked document.
fn problem(
    document: Value,
    (written, content): (Document, &str),
    order: Vec<usize>,
    variables: Vec<super::Variable>,
    composing: &Composing,
) -> Problem {
    let mut function_names: Vec<String> = written.functions.keys().cloned().collect();
    let feasible = written.objective.is_none();
    let feasible = feasible && !written.constraints.is_empty() && !variables.is_empty();
    let nearest_to = feasible.then(|| {
        let mut name = NEAREST.to_owned();
        while function_names
            .iter()
            .chain(composing.names())
            .any(|own| *own == name)
        {
            name.push('\'');
        }
        function_names.push(name);
        variables.iter().map(|variable| variable.start).collect()
    });
    let nearest = nearest_to.as_ref().map(|_| Objective {
        function: function_names.len() - 1,
        sense: Sense::Minimise,
    });
    function_names.extend(composing.names().cloned());
    let numbers: HashMap<&str, usize> = (function_names.iter().enumerate())
        .map(|(f, name)| (name.as_str(), f))
        .collect();
    let function = |of: &WhichFunction| numbers[composing.name(of)];
    let objective = written.objective.as_ref().map(|objective| {
        let (name, sense) = match objective {
            schema::Objective::Minimise(name) => (name, Sense::Minimise),
            schema::Objective::Maximise(name) => (name, Sense::Maximise),
        };
        Objective {
            function: function(name),
            sense,
        }
    });
    let constraints = written
        .constraints
        .iter()
        .map(|(name, constraint)| Constraint {
            name: name.clone(),
            function: function(&constraint.function),
            lower: constraint.lower.unwrap_or(f64::NEG_INFINITY),
            upper: constraint.upper.unwrap_or(f64::INFINITY),
        })
        .collect();
    let hash = hash_of(document.to_string() + content);
    Problem {
        name: written.name.clone(),
        simulation: simulation(written.simulation.as_ref(), usual_tolerance(&written)),
        variables,
        objective: objective.or(nearest),
        nearest_to,
        constraints,
        function_names,
        optimiser: written.optimiser.as_ref().map_or_else(
            OptimiserSettings::default,
            |optimiser| OptimiserSettings {
                method: optimiser.method.map(|method| match method {
                    schema::OptimisationMethod::InteriorPoint => Method::InteriorPoint,
                    schema::OptimisationMethod::TrustRegion => Method::TrustRegion,
                    schema::OptimisationMethod::LeastSquares => Method::LeastSquares,
                    schema::OptimisationMethod::Auto => Method::Auto,
                }),
                tolerance: optimiser.tolerance,
                constraint_tolerance: optimiser.constraint_tolerance,
                iterations: optimiser.iterations,
                evaluations: optimiser.evaluations,
                seconds: optimiser.seconds,
                unbounded_below: optimiser.unbounded_below,
            },
        ),
        hash,
        files: content.to_owned(),
        document,
        written,
        order,
        redundant: Vec::new(),
        left_out: Vec::new(),
        lowering: None,
        derived: Derived::default(),
        composition: Arc::default(),
        focus: None,
        statics: None,
        cases: None,
        team: Team::default(),
    }
}

/// SHA-256 of a text, hexadecimal.
pub(super) fn hash_of(text: String) -> String {
    let hash = Sha256::digest(text);
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// The tolerance of a file that gives none.
fn usual_tolerance(written: &Document) -> f64 {
    if elements::has_all_nodes(written) {
        TOLERANCE_OF_ELEMENTS
    } else if written.bodies.values().any(|body| body.is_flexible()) {
        TOLERANCE_OF_FLEXIBLE
    } else {
        TOLERANCE
    }
}

/// The settings of the integration; `usual` is the tolerance if the file gives neither it nor steps.
fn simulation(written: Option<&schema::Simulation>, usual: f64) -> Simulation {
    let method = written.and_then(|written| written.method.as_ref());
    let method = method.map(|method| match *method {
        schema::Method::Dop853 => integrate::Method::Dop853,
        schema::Method::Radau { stages } => integrate::Method::Radau { stages },
        schema::Method::Bdf { order, start } => integrate::Method::Bdf {
            order,
            start: match start {
                Some(schema::Start::RisingOrder) => Start::RisingOrder,
                Some(schema::Start::Radau) | None => Start::Radau,
            },
        },
        schema::Method::GeneralisedAlpha { radius } => {
            integrate::Method::GeneralisedAlpha { radius }
        }
    });
    let krylov = matches!(
        written.and_then(|written| written.linear_solver),
        Some(schema::LinearSolver::Krylov)
    );
    Simulation {
        method,
        solver: match krylov {
            true => integrate::LinearSolver::Krylov,
            false => integrate::LinearSolver::Direct,
        },
        spacing: match written.map_or((None, None), |written| (written.steps, written.tolerance)) {
            (Some(steps), _) => Spacing::Steps(steps),
            (None, tolerance) => Spacing::Tolerance(tolerance.unwrap_or(usual)),
        },
        memory: None,
        samples: written.and_then(|written| written.samples),
        limits: integrate::Limits {
            steps: None,
            seconds: written.and_then(|written| written.seconds),
            progress: None,
            agreed: None,
        },
    }
}
