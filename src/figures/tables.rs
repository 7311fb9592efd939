//! Results of a simulation at every instant, as comma separated values of full precision.

use super::NamedFile;
use crate::driver::Simulation;
use crate::functions::Function;
use crate::functions::snapshot::Snapshot;
use crate::math::Vec3;
use crate::model::{FlexibleBody, Form};
use crate::problem::Problem;
use crate::report::csv_table;
use crate::system::observe::Reaction;

/// The axes of joint reactions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReactionAxes {
    /// Those of ground.
    Ground,
    /// Those of the joint on its first body; e3 is the joint's axis.
    Joint,
}

/// `simulation.csv`, `motion.csv` and, if there are functions, `functions.csv`.
pub fn of_simulation(
    problem: &Problem,
    simulation: &Simulation,
    axes: ReactionAxes,
) -> Vec<NamedFile> {
    let mut all = vec![
        ("simulation.csv", observations(simulation, axes)),
        ("motion.csv", motion(simulation)),
    ];
    if !problem.function_names.is_empty() {
        all.push(("functions.csv", functions(problem, simulation)));
    }
    let bytes = |(name, text): (&'static str, String)| (name, text.into_bytes());
    all.into_iter().map(bytes).collect()
}

/// The same of a motion that events divide, from its phases.
pub fn of_phases(phases: &[(&Problem, &Simulation)], axes: ReactionAxes) -> Vec<NamedFile> {
    let mut all: Vec<NamedFile> = Vec::new();
    for (problem, simulation) in phases {
        let own = of_simulation(problem, simulation, axes);
        if all.is_empty() {
            all = own;
            continue;
        }
        for ((_, bytes), (_, more)) in all.iter_mut().zip(own) {
            // Without the heading.
            let rows = more.iter().position(|byte| *byte == b'\n');
            bytes.extend_from_slice(&more[rows.map_or(0, |end| end + 1)..]);
        }
    }
    all
}

/// Headings of the three components of a vector.
fn components(what: &str, unit: &str) -> [String; 3] {
    ["x", "y", "z"].map(|axis| format!("{what} {axis} [{unit}]"))
}

/// Energy, momentum, drift and the force and torque of every joint on its first body (the one that
/// is not ground), at the joint's point.
fn observations(simulation: &Simulation, axes: ReactionAxes) -> String {
    let mut header = vec![
        "time [s]".to_owned(),
        "kinetic energy [J]".to_owned(),
        "potential energy [J]".to_owned(),
    ];
    header.extend(components("momentum", "kg m/s"));
    header.extend(components("angular momentum", "kg m^2/s"));
    header.extend(["position drift".to_owned(), "velocity drift".to_owned()]);
    for joint in &simulation.written.model.joints {
        for (what, unit) in [("force", "N"), ("torque", "N m")] {
            let what = format!("{}: {what}", joint.name);
            header.extend(match axes {
                ReactionAxes::Ground => components(&what, unit),
                ReactionAxes::Joint => [1, 2, 3].map(|k| format!("{what} e{k} [{unit}]")),
            });
        }
    }
    let shown = simulation.motion().shown();
    let reactions = simulation.reactions_at(shown.iter().copied());
    let both = |reaction: &Reaction| match axes {
        ReactionAxes::Ground => [reaction.force_ground, reaction.torque_ground],
        ReactionAxes::Joint => [reaction.force, reaction.torque],
    };
    let rows = shown.into_iter().zip(&reactions).map(|(k, reactions)| {
        let seen = &simulation.observations[k];
        let mut row = vec![simulation.time(k), seen.kinetic, seen.potential];
        row.extend(seen.momentum.iter().chain(seen.angular_momentum.iter()));
        row.extend([seen.position_drift, seen.velocity_drift]);
        let vectors: Vec<Vec3<f64>> = reactions.iter().flat_map(both).collect();
        row.extend(vectors.iter().flat_map(|v| v.iter().copied()));
        row
    });
    csv_table(&header, rows)
}

/// Position of the centre of mass, Euler parameters (body axes to ground, p0 first), velocity and
/// angular velocity of every body, all in ground axes; of a flexible body those of its frame. Then the
/// elastic coordinates of each flexible body and their rates.
fn motion(simulation: &Simulation) -> String {
    let (model, run) = (&simulation.written.model, simulation.motion());
    let all = 0..model.bodies.len();
    let bodies: Vec<usize> = all.filter(|&body| !model.is_internal(body)).collect();
    let mut header = vec!["time [s]".to_owned()];
    for &body in &bodies {
        let named = |what: &str| format!("{}: {what}", model.bodies[body].name);
        header.extend(components(&named("position"), "m"));
        header.extend([0, 1, 2, 3].map(|k| named(&format!("p{k}"))));
        header.extend(components(&named("velocity"), "m/s"));
        header.extend(components(&named("angular velocity"), "rad/s"));
    }
    // Nodes of finite elements are too many for a table.
    let modal = |flexible: &&FlexibleBody<f64>| match flexible.form {
        Form::Modal(_) => true,
        Form::Finite(_) => false,
    };
    for flexible in model.flexible.iter().filter(modal) {
        let named = |what: &str, unit: &str, i: usize| {
            format!("{}: elastic {what} {i} [{unit}]", flexible.name)
        };
        let modes = 1..=flexible.modes();
        header.extend(modes.clone().map(|i| named("coordinate", "m", i)));
        header.extend(modes.map(|i| named("rate", "m/s", i)));
    }
    let rows = run.shown().into_iter().map(|k| {
        let at = Snapshot::of(model, run, k);
        let mut row = vec![simulation.time(k)];
        for &body in &bodies {
            let motion = at.motion(body);
            row.extend(motion.position.iter());
            row.extend(motion.orientation);
            row.extend(motion.velocity.iter());
            row.extend((motion.rotation * motion.omega).iter());
        }
        for flexible in model.flexible.iter().filter(modal) {
            row.extend((flexible.places()).map(|(carrier, i)| at.motion(carrier).position[i]));
            row.extend((flexible.places()).map(|(carrier, i)| at.motion(carrier).velocity[i]));
        }
        row
    });
    csv_table(&header, rows)
}

/// The quantity of every function, and of the event, at every instant. For a clearance: that of a
/// release at this instant. A value that is not finite is left empty.
fn functions(problem: &Problem, simulation: &Simulation) -> String {
    let (scene, run) = (&simulation.written, simulation.motion());
    let model = &scene.model;
    let named = problem.function_names.iter().map(String::as_str);
    let all = named.zip(&scene.functions);
    let event = scene.until.iter().map(|until| ("until", &until.measure));
    let mut header = vec!["time [s]".to_owned()];
    let mut columns: Vec<Vec<f64>> = vec![(0..=run.last()).map(|k| simulation.time(k)).collect()];
    for (name, function) in all.chain(event) {
        let (what, unit, values) = match function {
            Function::Reduced { of, .. } => (of.describe(), of.unit(), of.sample(model, run)),
            Function::Clearance {
                projectile,
                distance,
                top,
                ..
            } => {
                let at = |k| {
                    let flight = Snapshot::of(model, run, k).flight(projectile);
                    flight.clearance(*distance, *top)
                };
                (
                    "clearance".to_owned(),
                    "m".to_owned(),
                    (0..=run.last()).map(at).collect(),
                )
            }
            Function::Misfit { series } => {
                for own in series {
                    let (series, what, unit) = (&own.data.name, own.of.describe(), own.of.unit());
                    header.push(format!("{name}, {series}: {what} [{unit}]"));
                    columns.push(own.of.sample(model, run));
                }
                continue;
            }
            Function::Duration | Function::LowestFrequency { .. } | Function::OfDesign { .. } => {
                continue;
            }
        };
        header.push(format!("{name}: {what} [{unit}]"));
        columns.push(values);
    }
    let shown = run.shown().into_iter();
    let rows = shown.map(|k| columns.iter().map(|column| column[k]).collect());
    csv_table(&header, rows)
}
