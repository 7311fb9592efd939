//! The check of gradients: adjoint against complex step.

use super::composed::infinitesimal;
use super::evaluate::Evaluated;
use super::event;
use super::frozen::{Stored, complex_design, complex_motion};
use super::integration::Integration;
use crate::functions::seen::SeenPart;
use crate::functions::series::Series;
use crate::functions::snapshot::Snapshot;
use crate::functions::{Function, Instant, Operation, Quantity, Reduction, VibrationPart};
use crate::integrate::{IntegrationFailure, Settings, Trajectory};
use crate::math::Complex64;
use crate::math::scalar::COMPLEX_STEP;
use crate::model::flexible::Quadratic;
use crate::model::{DegreeOfFreedom, ForceTable, LoadKind};
use crate::problem::Problem;
use crate::system::loads::measured::LoadPart;
use crate::system::measures::WrenchPart;
use crate::system::placement::length_scale;
use rayon::prelude::*;

/// A derivative below this part of its terms has lost digits by cancellation.
const SMALL: f64 = 1e-3;
/// Relative noise of a derivative up to which it counts as exact.
const LITTLE: f64 = 1e-8;
/// A derivative below this part of its terms is zero if it is uncertain by more than that part of it.
const NOTHING: f64 = 1e-10;
const UNCERTAIN: f64 = 1e-2;
/// Largest part of its terms by which round-off of the motion may change a small derivative, and how many times the change
/// between two motions that is.
const MOVED: f64 = 1e-12;
const SEVERAL: f64 = 8.0;

/// One derivative, computed twice.
#[derive(Clone, Debug, PartialEq)]
pub struct CheckedDerivative {
    /// Function, by index.
    pub function: usize,
    /// Variable, by index.
    pub variable: usize,
    /// By the discrete adjoint, on the motion of the complex step.
    pub adjoint: f64,
    /// By the complex step.
    pub complex_step: f64,
    /// Sum of the sizes of the terms of the adjoint's derivative. Or, if larger, the function's
    /// largest derivative (each variable in its scale), or the function's own size for a typical
    /// change of the variable.
    pub terms: f64,
    /// By the discrete adjoint, on the motion that an optimisation would see. The two motions
    /// differ by round-off, which a sensitive motion magnifies.
    pub in_use: f64,
}

/// How the two values of a derivative compare.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Both are zero but for round-off.
    Nothing,
    /// They agree to the tolerance.
    Agree,
    /// They differ by round-off of larger terms, and the derivative itself is small.
    RoundOff,
    /// They differ by what Newton's method leaves.
    Noise,
    /// They differ.
    Differ,
}

impl CheckedDerivative {
    /// How its values compare, by a relative tolerance.
    pub fn verdict(&self, tolerance: f64) -> Verdict {
        if self.is_round_off() {
            Verdict::Nothing
        } else if self.relative_difference() <= tolerance {
            Verdict::Agree
        } else if self.differs_by_round_off() {
            Verdict::RoundOff
        } else if self.differs_by_noise() {
            Verdict::Noise
        } else {
            Verdict::Differ
        }
    }

    /// |adjoint − complex step| relative to the complex step; absolute if that is zero.
    pub fn relative_difference(&self) -> f64 {
        relative(self.adjoint, self.complex_step)
    }

    /// Whether the derivative is only the round-off of cancelling terms: both values are below 64 ε
    /// times the terms. Or they are below 1e-10 of these, and motions that differ by round-off change more than a hundredth
    /// of the derivative, or the adjoint is zero on both motions, as of one that drives and welds determine.
    pub fn is_round_off(&self) -> bool {
        // Comparisons with NaN are false.
        let below = |most: f64| self.adjoint.abs() <= most && self.complex_step.abs() <= most;
        let moved = (self.in_use - self.adjoint).abs();
        let nothing = self.adjoint == 0.0 && self.in_use == 0.0;
        below(self.round_off())
            || below(NOTHING * self.terms) && (nothing || below(moved / UNCERTAIN))
    }

    /// Whether the derivative is below 1e-3 of its terms and its two values differ by at most their
    /// round-off: 64 ε times the terms, and what round-off of the motion changes, up to 1e-12 of the terms.
    pub fn differs_by_round_off(&self) -> bool {
        let small = self.complex_step.abs() <= SMALL * self.terms;
        let moved = (self.in_use - self.adjoint).abs();
        let most = self.round_off() + (SEVERAL * moved).min(MOVED * self.terms);
        small && (self.adjoint - self.complex_step).abs() <= most
    }

    /// Whether its two values differ by no more than what Newton's method leaves, and that is little.
    fn differs_by_noise(&self) -> bool {
        let noise = self.noise();
        self.complex_step != 0.0 && self.relative_difference() <= noise && noise <= LITTLE
    }

    fn round_off(&self) -> f64 {
        64.0 * f64::EPSILON * self.terms
    }

    /// Relative change of the derivative by round-off in the motion.
    pub fn noise(&self) -> f64 {
        relative(self.in_use, self.adjoint)
    }
}

fn relative(x: f64, exact: f64) -> f64 {
    let difference = (x - exact).abs();
    if difference == 0.0 || exact == 0.0 {
        difference
    } else {
        difference / exact.abs()
    }
}

/// Derivatives of every function in every variable at the design `x`, function by function. The
/// complex steps, one simulation a variable, run in parallel.
///
/// # Errors
/// If a simulation fails.
pub fn check(problem: &Problem, x: &[f64]) -> Result<Vec<CheckedDerivative>, IntegrationFailure> {
    let scene = problem.scene(x);
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let mut integration = Integration::new(problem, &scene, Some(&which), true);
    let (in_use, _) = Evaluated::with(&mut integration, problem, x)?;
    let Some((settings, _)) = integration.chosen() else {
        return Ok(Vec::new());
    };
    let duration = in_use.run.duration;
    let rate = match &in_use.scene.until {
        Some(_) => event::rate(&in_use.scene, settings, duration)?,
        None => f64::NAN,
    };
    // The adjoint follows the first of these motions.
    let steps: Vec<ComplexStep> = (0..x.len())
        .into_par_iter()
        .map(|i| {
            let unit = |j: usize| if i == j { 1.0 } else { 0.0 };
            let direction: Vec<f64> = (0..x.len()).map(unit).collect();
            let stored = match i {
                0 => Stored::Steps,
                _ => Stored::Motion,
            };
            complex_step(problem, (settings, stored), (duration, rate), x, &direction)
        })
        .collect::<Result<_, _>>()?;
    let Some(first) = steps.first() else {
        return Ok(Vec::new());
    };
    let same = in_use.with_run(in_use.scene.clone(), first.run.clone());
    let (adjoint, _) = same.derivatives(problem, &which)?;
    let (in_use, _) = in_use.gradients(problem, &which)?;
    let scale_of = |i: usize| problem.variables[i].scale;
    let own: Vec<f64> = which.iter().map(|&f| own_size(&same, f)).collect();
    // Round-off of the motion reaches small derivatives from the large ones. Round-off of the
    // function reaches all.
    let terms = |function: usize, variable: usize| {
        let change = scale_of(variable).max(x[variable].abs());
        let sizes =
            (adjoint[function].iter().enumerate()).map(|(i, d)| d.value.abs() * scale_of(i));
        let largest = sizes.fold(0.0, f64::max) / scale_of(variable);
        let terms = adjoint[function][variable].terms.max(largest);
        terms.max(own[function] / change)
    };
    let pairs = which
        .iter()
        .flat_map(|&f| (0..x.len()).map(move |i| (f, i)));
    Ok(pairs
        .map(|(function, variable)| CheckedDerivative {
            function,
            variable,
            adjoint: adjoint[function][variable].value,
            terms: terms(function, variable),
            complex_step: steps[variable].derivatives[function],
            in_use: in_use[function][variable],
        })
        .collect())
}

/// The size of function f that determines its round-off: its value, or the size of its kind in a
/// scene of this length L and duration T, as a value may be a difference.
pub(super) fn own_size(at: &Evaluated, f: usize) -> f64 {
    if at.composition.gives(f) {
        let terms = at.partials(f).by_function.into_iter();
        let terms = terms.filter(|(_, by)| *by != 0.0);
        let sizes = terms.map(|(g, by)| by.abs() * own_size(at, g));
        return sizes.sum::<f64>().max(at.value(f).abs());
    }
    let (length, time) = (length_scale(&at.scene.model), at.run.duration);
    let (of, reduction) = match &at.scene.functions[f] {
        Function::Reduced { of, reduction, .. } => (of, *reduction),
        Function::Clearance { .. } => return length.max(at.function(f).value.abs()),
        // Its terms are squares of distances in standard deviations, whose last digits are those of the values.
        Function::Misfit { series } => {
            let value = at.function(f).value.abs();
            return value.max(largest_datum(series) * value.sqrt());
        }
        Function::Duration => return time,
        Function::LowestFrequency { .. } => return at.function(f).value.abs(),
        Function::OfDesign { value, .. } => return value.abs().max(1.0),
    };
    let size = match reduction {
        Reduction::Integral => size_of(at, of) * time,
        // A sum of terms of one sign.
        Reduction::Damage { .. } => 0.0,
        Reduction::Final
        | Reduction::Mean
        | Reduction::Ks { .. }
        | Reduction::InducedExponential { .. } => size_of(at, of),
    };
    size.max(at.function(f).value.abs())
}

/// The largest of measured values, in standard deviations.
pub(super) fn largest_datum(series: &[Series<f64>]) -> f64 {
    let largest = |own: &Series<f64>| {
        let data = own.data.values.iter().zip(&own.data.weights);
        data.map(|(d, weight)| (d * weight).abs())
            .fold(0.0, f64::max)
    };
    series.iter().map(largest).fold(0.0, f64::max)
}

/// The size of a quantity in a scene.
fn size_of(at: &Evaluated, of: &Quantity<f64>) -> f64 {
    match of {
        Quantity::Of(instant) => size_of_instant(at, instant),
        Quantity::Combined { operation, of } => {
            let all: Vec<f64> = of.iter().map(|own| size_of(at, own)).collect();
            match operation {
                Operation::Sum | Operation::Difference => all.iter().fold(0.0, |a, &b| a.max(b)),
                Operation::Product => all.iter().product(),
                Operation::Quotient => all[0] / all[1],
                Operation::Square => all[0] * all[0],
                Operation::Absolute { .. } => all[0],
                Operation::Rate => all[0] / at.run.duration,
            }
        }
    }
}

fn size_of_instant(at: &Evaluated, instant: &Instant<f64>) -> f64 {
    let model = &at.scene.model;
    let (length, time) = (length_scale(model), at.run.duration);
    match instant {
        Instant::Position { .. } | Instant::Range { .. } => length,
        Instant::Velocity { .. } | Instant::Speed { .. } => length / time,
        Instant::Acceleration { .. } => length / (time * time),
        Instant::SpeedSquared { .. } => length * length / (time * time),
        Instant::Rotation(_) => 1.0,
        Instant::AngularVelocity { .. } => 1.0 / time,
        Instant::Momentum { .. } => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            mass * length / time
        }
        Instant::ShellStress { .. } => 1.0,
        Instant::Vibration(of) => match of.part {
            VibrationPart::Frequency => 1.0 / time,
            VibrationPart::DampingRatio => 1.0,
        },
        Instant::AngularMomentum(_) => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            mass * length * length / time
        }
        Instant::Deformation {
            flexible,
            unknowns,
            form,
            ..
        } => form_size(form, &largest_of(at, *flexible, unknowns.as_deref())),
        Instant::LargestDeformation {
            flexible,
            unknowns,
            largest,
            ..
        } => {
            let most = largest_of(at, *flexible, unknowns.as_deref());
            let sizes = largest.forms.iter().map(|form| form_size(form, &most));
            sizes.fold(0.0, f64::max)
        }
        Instant::Slide(_) => length,
        Instant::Felt { .. } => length / (time * time),
        Instant::Seen(seen) => match seen.part {
            SeenPart::Position | SeenPart::Distance => length,
            SeenPart::Velocity => length / time,
        },
        Instant::JointRate { dof, .. } => match dof {
            DegreeOfFreedom::Rotation => 1.0 / time,
            DegreeOfFreedom::Translation => length / time,
        },
        Instant::Power(_) => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            mass * (model.gravity.norm() + length / (time * time)) * length / time
        }
        Instant::Reaction(_) | Instant::Energy(_) | Instant::StrainEnergy(_) => {
            let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
            let force = mass * (model.gravity.norm() + length / (time * time));
            match instant {
                Instant::Reaction(wrench) if wrench.part == WrenchPart::Force => force,
                _ => force * length,
            }
        }
        Instant::Load(measure) => match (measure.part, &model.loads[measure.load].kind) {
            (
                LoadPart::Tension,
                LoadKind::Spring {
                    stiffness, tables, ..
                },
            ) => (stiffness + steepest(tables)) * length,
            (
                LoadPart::Torque,
                LoadKind::TorsionSpring {
                    stiffness, tables, ..
                },
            ) => stiffness + steepest(tables),
            (LoadPart::PenetrationAngle | LoadPart::ErrorAngle, _) => 1.0,
            (LoadPart::EffortForce | LoadPart::EffortTorque, _) => {
                let mass: f64 = model.bodies.iter().map(|body| body.mass).sum();
                let force = mass * (model.gravity.norm() + length / (time * time));
                match measure.part {
                    LoadPart::EffortForce => force,
                    _ => force * length,
                }
            }
            (LoadPart::Tension, LoadKind::Cable(own)) => own.law.stiffness * length,
            (LoadPart::NormalForce, LoadKind::JointStop { law, .. })
            | (LoadPart::NormalForce, LoadKind::DistanceStop { law, .. }) => law.stiffness * length,
            (LoadPart::NormalForce, LoadKind::Contact(own)) => own.law.stiffness * length,
            (LoadPart::Friction, LoadKind::Contact(own)) => {
                own.friction.coefficient * own.law.stiffness * length
            }
            (LoadPart::SlipPower, LoadKind::Contact(own)) => {
                own.friction.coefficient * own.law.stiffness * length * length / time
            }
            (LoadPart::NormalTorque, LoadKind::JointStop { law, .. }) => law.stiffness,
            _ => length,
        },
    }
}

/// The largest slope of the table of a spring.
fn steepest(tables: &[Option<ForceTable<f64>>; 2]) -> f64 {
    tables[0].as_ref().map_or(0.0, ForceTable::steepest)
}

/// The largest of each elastic coordinate in the motion, or of each of these unknowns of nodes.
fn largest_of(at: &Evaluated, flexible: usize, unknowns: Option<&[usize]>) -> Vec<f64> {
    let mut most: Vec<f64> = Vec::new();
    for k in 0..=at.run.last() {
        let now = Snapshot::of(&at.scene.model, &at.run, k).unknowns(flexible, unknowns);
        most.resize(now.len(), 0.0);
        for (most, x) in most.iter_mut().zip(now) {
            *most = most.max(x.abs());
        }
    }
    most
}

/// The size of a form by the largest of each coordinate.
fn form_size(form: &Quadratic<f64>, most: &[f64]) -> f64 {
    let terms = form.linear.iter().zip(most).map(|(b, most)| b.abs() * most);
    terms.fold(0.0, f64::max)
}

/// Derivatives of all functions along a direction, and the real part of the motion.
pub(super) struct ComplexStep {
    pub derivatives: Vec<f64>,
    pub run: Trajectory<f64>,
}

/// Im f(x + i h d)/h of every function f; `event` is when the event comes at x, and how fast.
pub(super) fn complex_step(
    problem: &Problem,
    with: (&Settings, Stored),
    event: (f64, f64),
    x: &[f64],
    direction: &[f64],
) -> Result<ComplexStep, IntegrationFailure> {
    let moved = complex_design(x, direction);
    let (scene, run) = complex_motion(problem, with, event, &moved)?;
    let value = |f: &Function<Complex64>| f.evaluate(&scene.model, &run).value;
    let values: Vec<Complex64> = scene.functions.iter().map(value).collect();
    Ok(ComplexStep {
        derivatives: infinitesimal(&problem.composition, &moved, &values, COMPLEX_STEP),
        run: run.real(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A small derivative may differ by the last digits of large ones, and by no more.
    #[test]
    fn a_difference_is_judged_by_the_terms() {
        let pair = |adjoint: f64, complex_step: f64| CheckedDerivative {
            function: 0,
            variable: 0,
            adjoint,
            complex_step,
            terms: 1.0,
            in_use: adjoint,
        };
        let noisy = |in_use: f64| CheckedDerivative {
            in_use,
            ..pair(1.0 + 1e-10, 1.0)
        };
        assert!(noisy(1.0 + 3e-10).differs_by_noise());
        assert!(!noisy(1.0 + 1e-10).differs_by_noise() && !noisy(1.1).differs_by_noise());
        // Less than round-off of the terms could leave, and not the same in two motions.
        let nearly = |in_use: f64| CheckedDerivative {
            in_use,
            ..pair(3e-12, 1e-30)
        };
        assert!(nearly(2e-12).is_round_off());
        assert!(!nearly(3e-12).is_round_off() && nearly(3e-12).verdict(1e-10) == Verdict::Differ);
        for (a, b) in [(f64::NAN, 0.0), (0.0, f64::NAN)] {
            assert_eq!(pair(a, b).verdict(1e-10), Verdict::Differ);
        }
        let of_nothing = CheckedDerivative {
            in_use: 1e-9,
            ..pair(1e-9 + 1e-18, 0.0)
        };
        assert!(!of_nothing.differs_by_noise());
        let small = pair(1e-12 + 5e-15, 1e-12);
        assert!(!small.is_round_off() && small.differs_by_round_off());
        assert!(small.relative_difference() > 1e-3);
        let wrong = pair(1e-12 + 5e-14, 1e-12);
        assert!(!wrong.is_round_off() && !wrong.differs_by_round_off());
        // What two motions differ by is no fault, if little is left of large terms.
        let settled = |difference: f64| CheckedDerivative {
            in_use: 1e-8 + 5e-14,
            ..pair(1e-8 + difference, 1e-8)
        };
        assert!(settled(1e-13).differs_by_round_off() && !settled(2e-12).differs_by_round_off());
        let nothing = pair(1e-15, -1e-15);
        assert!(nothing.is_round_off() && nothing.differs_by_round_off());
        assert!(!pair(f64::NAN, 0.0).differs_by_round_off());
        // A derivative that is not small has all its digits.
        assert!(!pair(0.1 + 5e-15, 0.1).differs_by_round_off());
    }

    /// A zero derivative is compared with the size of the function, for any terms. Examples: the
    /// event's own quantity, and a free fall in its mass.
    #[test]
    fn what_does_not_change_passes() {
        let arm = r#"{"shape": {"box": {"size": [1, 0.2, 0.3]}}, "mass": 1,
                       "place": {"put": [-0.5, 0, 0], "at": [0, 0, 0]}}"#;
        let swing = format!(
            r#"{{"version": 1, "name": "swing", "gravity": [0.3, -9.81, 0],
            "bodies": {{"arm": {arm}, "tip": {arm}}},
            "joints": {{"pin": {{"revolute": {{"between": ["arm", "ground"], "at": [0, 0, 0],
                "axis": [0, 0, 1]}}}},
                "knee": {{"revolute": {{"between": ["tip", "arm"], "at": [0, 0.1, 0], "axis": [0, 0, 1]}}}}}},
            "simulation": {{"duration": 2, "tolerance": 1e-12, "until": {{"reaches": -0.2,
                "measure": {{"rotation": {{"body": "tip", "axis": [0, 0, 1]}}}}}}}},
            "functions": {{"turned": {{"final": {{"rotation": {{"body": "tip", "axis": [0, 0, 1]}}}}}}}},
            "variables": {{"mass": {{"path": "/bodies/tip/mass", "lower": 0.1}},
                "height": {{"path": "/joints/knee/revolute/at/1"}}}}}}"#
        );
        let spin = r#"{"version": 1, "name": "spin", "gravity": [0, -9.81, 1],
            "bodies": {"a": {"shape": {"box": {"size": [1, 0.2, 0.3]}}, "mass": 1, "place": {"at": [1, 0, 0]},
                "velocity": {"angular": [1, 2, 3]}}},
            "joints": {"r": {"rod": {"between": ["a", "ground"], "at": [[1, 0, 0], [0, 0, 0]]}}},
            "simulation": {"duration": 1, "tolerance": 1e-12},
            "functions": {"x": {"final": {"position": {"body": "a", "direction": [1, 0, 0]}}}},
            "variables": {"m": {"path": "/bodies/a/mass", "lower": 0.1}}}"#;
        // The drive alone moves the slider, and the spring is strong.
        let slider = r#"{"version": 1, "name": "slider",
            "bodies": {"b": {"shape": {"sphere": {"radius": 0.1}}, "mass": 2, "points": {"a": [0.1, 0.2, -0.3]},
                "place": {"put": "a", "turn": {"axis": [1, 2, 3], "angle": 0.7}}}},
            "joints": {"p": {"prismatic": {"between": ["b", "ground"], "at": "b.a", "axis": [1, 0.4, -0.3]}}},
            "drives": {"d": {"joint": "p", "slide": {"polynomial": [-0.16, -0.085, -0.127]}}},
            "loads": {"s": {"spring": {"between": ["b", "ground"], "at": {"a": [0, 0, 0.1], "b": [0.5, 1, 0.3]},
                "rest_length": 0.4, "stiffness": 700}}},
            "simulation": {"duration": 0.8, "tolerance": 1e-9},
            "functions": {"f": {"final": {"acceleration": {"body": "b", "direction": [0.3, 0.5, 0.2]}}}},
            "variables": {"x": {"path": "/bodies/b/points/a/0", "lower": -1, "upper": 1},
                "angle": {"path": "/bodies/b/place/turn/angle", "lower": 0, "upper": 1},
                "k": {"path": "/loads/s/spring/stiffness", "lower": 100, "upper": 1000}}}"#;
        for text in [&swing[..], spin, slider] {
            let problem = Problem::parse(text, "nothing.json", &[]);
            let problem = problem.unwrap_or_else(|faults| panic!("{faults}"));
            for d in check(&problem, &problem.start()).expect("a run") {
                assert!(d.is_round_off(), "{d:?}");
                assert!(d.terms < 1e3, "{d:?}");
            }
        }
    }
}
