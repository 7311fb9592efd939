//! The choice of the integration method of a scene, and warnings about methods.

use super::explicit::stiffness::{UNSTABLE, Watch};
use super::settings::{Method, Settings, Spacing};
use super::trajectory::Trajectory;
use super::work::Measured;
use super::{Integrated, IntegrationFailure};
use crate::math::{Scalar, Vec3};
use crate::model::load::LoadKind;
use crate::model::{FlexibleBody, ForceTable, Load, Model, RigidBody};
use crate::system::flexible;

/// The method for scenes that are not stiff.
pub const NON_STIFF: Method = Method::Dop853;
/// The method for stiff scenes.
pub const STIFF: Method = Method::Radau { stages: 3 };

/// Ranges of ωh in which BDF of order 3, 4, 5, 6 amplifies undamped vibration.
const AMPLIFIED: [(f64, f64); 4] = [(0.0, 1.94), (0.0, 4.71), (0.71, 9.39), (0.84, 17.6)];

/// A vibration is stable above this damping ratio. Below this ωh it grows too slowly to matter.
const DAMPED: f64 = 0.3;
const SLOW: f64 = 0.2;

/// A run by the given method, or by the method that suits the scene.
#[derive(Clone, Debug)]
pub struct Chosen<S: Scalar> {
    /// The motion.
    pub run: Trajectory<S>,
    /// Method and steps of the run; adaptive steps are frozen.
    pub settings: Settings,
    /// The reason for the method.
    pub reason: String,
}

/// Simulates by `method` or, without one, by the explicit method. Changes to Radau IIA if that is
/// cheaper (see [`stiffness`](super::explicit::stiffness)), if explicit steps of equal size fail,
/// or if adaptive ones make no headway.
///
/// # Errors
/// As `simulate`.
pub fn simulate_by<S: Integrated>(
    model: &Model<S>,
    duration: S,
    method: Option<Method>,
    settings: &Settings,
) -> Result<Chosen<S>, IntegrationFailure> {
    let watch = match method {
        Some(_) => Watch::Stability,
        None => Watch::Cost,
    };
    let with = |method: Method, why: Option<String>| {
        let mut settings = Settings {
            method,
            ..settings.clone()
        };
        let run = S::simulate(model, duration, &settings, watch)?;
        match settings.spacing {
            Spacing::Tolerance(_) => settings.spacing = Spacing::Frozen(run.grid.clone()),
            // Given steps that end at kinks.
            Spacing::Frozen(_) if settings.spacing.is_equal() => {
                settings.spacing = Spacing::Frozen(run.grid.clone());
            }
            Spacing::Steps(_) | Spacing::Frozen(_) => {}
        }
        let reason = why.unwrap_or_else(|| measured(run.stiffness));
        Ok(Chosen {
            run,
            settings,
            reason,
        })
    };
    if let Some(method) = method {
        return with(method, Some(reason(true, method).into()));
    }
    match with(NON_STIFF, None) {
        Err(IntegrationFailure::Stiff {
            share: None, time, ..
        }) => {
            let general = reason(false, STIFF);
            let reason = format!("{general}, h |lambda| = {UNSTABLE} before t = {time:.4} s");
            with(STIFF, Some(reason))
        }
        Err(IntegrationFailure::Stiff {
            share: Some(share),
            time,
            ..
        }) => {
            let (stiff, other) = (STIFF.name(), NON_STIFF.name());
            let reason = format!(
                "the scene is stiff: from t = {time:.4} s on, {stiff} takes {share:.2} of the work of {other}"
            );
            with(STIFF, Some(reason))
        }
        Err(IntegrationFailure::EnergyGained { time, gained, .. }) => {
            let reason = format!(
                "the scene is stiff: at t = {time:.4} s {} had gained {gained:.1e} J that no load supplied",
                NON_STIFF.name()
            );
            with(STIFF, Some(reason))
        }
        Err(
            IntegrationFailure::NotFinite { time, .. }
            | IntegrationFailure::Projection { time, .. }
            | IntegrationFailure::SingularPosition { time, .. }
            | IntegrationFailure::Opened { time, .. }
            | IntegrationFailure::Unstable { time, .. }
            | IntegrationFailure::Singular { time, .. },
        ) if settings.spacing.is_equal() => {
            let reason = format!("explicit steps of this size fail at t = {time:.4} s");
            with(STIFF, Some(reason))
        }
        Err(failure @ IntegrationFailure::NoHeadway { time, .. }) => {
            let reason = format!("explicit steps make no headway at t = {time:.4} s");
            with(STIFF, Some(reason)).map_err(|_| failure)
        }
        found => found,
    }
}

/// The reason for a method: the problem gives it, or the stiffness of the scene.
pub fn reason(given: bool, method: Method) -> &'static str {
    match method {
        _ if given => "as the problem says",
        Method::Dop853 => "the scene is not stiff",
        _ => "the scene is stiff: stability, not accuracy, bounds explicit steps",
    }
}

/// The reason for the explicit method by what it measured.
fn measured(found: Option<Measured>) -> String {
    let general = reason(false, NON_STIFF);
    match found {
        Some(Measured {
            compared: Some((time, work)),
            ..
        }) => {
            let pays = if work < 1.0 {
                ", too much to start again"
            } else {
                ""
            };
            format!(
                "{general}: from t = {time:.4} s on, {} would take {work:.2} times its work{pays}",
                STIFF.name()
            )
        }
        Some(Measured { largest, .. }) if largest > UNSTABLE => {
            format!(
                "{general}: h |lambda| exceeds {UNSTABLE}, the border of stability, in few steps"
            )
        }
        Some(Measured { largest, .. }) if largest > 0.0 => format!(
            "{general}: h |lambda| of the steps is at most {largest:.1e}, and stable up to {UNSTABLE}"
        ),
        Some(_) | None => general.into(),
    }
}

/// A warning about a method with steps of size h \[s\], if it suits the scene badly: BDF of order 3
/// and more amplifies undamped vibration if ωh is in a range around one.
pub fn warning(model: &Model<f64>, method: Method, h: f64) -> Option<String> {
    let Method::Bdf { order, .. } = method else {
        return None;
    };
    let (low, high) = *AMPLIFIED.get(order.checked_sub(3)?)?;
    let judge = |what: &str, name: &str, (omega, ratio): (f64, f64)| {
        let z = omega * h;
        (ratio < DAMPED && z > low.max(SLOW) && z < high).then(|| {
            format!(
                "bdf of order {order} amplifies undamped vibration with omega h between {low} and \
                 {high}, and {what} \"{name}\" vibrates with omega h = {z:.2} (omega = \
                 {omega:.3e} rad/s); take radau, or bdf of order 2"
            )
        })
    };
    let of_load = |load: &Load<f64>| judge("load", &load.name, vibration(model, &load.kind)?);
    let of_body = |body: &FlexibleBody<f64>| {
        let mut all = vibrations(body);
        all.find_map(|vibration| judge("body", &body.name, vibration))
    };
    let loads = model.loads.iter().find_map(of_load);
    loads.or_else(|| model.flexible.iter().find_map(of_body))
}

/// Angular frequency \[rad/s\] and damping ratio of each elastic coordinate of a body by itself.
fn vibrations(body: &FlexibleBody<f64>) -> impl Iterator<Item = (f64, f64)> + use<> {
    let all = flexible::alone(body).into_iter();
    all.map(|[stiffness, mass, damping]| {
        let omega = (stiffness / mass).sqrt();
        (omega, 0.5 * damping / (mass * omega))
    })
}

/// Largest acceleration of a point of a free body per force at this point \[1/kg\]; 0 of a body without mass, which
/// moves as others do.
fn mobility(body: &RigidBody<f64>, point: &Vec3<f64>) -> f64 {
    if body.mass == 0.0 {
        return 0.0;
    }
    let least = body.inertia.symmetric_eigenvalues().min();
    let turning = point.norm_squared() / least;
    1.0 / body.mass + if turning.is_finite() { turning } else { 0.0 }
}

/// Angular frequency (upper bound) \[rad/s\] and damping ratio of the vibration of bodies on a
/// spring.
fn vibration(model: &Model<f64>, load: &LoadKind<f64>) -> Option<(f64, f64)> {
    // The steepest line of a table, and so an upper bound.
    let elastic = |stiffness: f64, tables: &[Option<ForceTable<f64>>; 2]| {
        stiffness + tables[0].as_ref().map_or(0.0, ForceTable::steepest)
    };
    let (stiffness, damping, inverse) = match *load {
        LoadKind::Spring {
            body_a,
            body_b,
            point_a,
            point_b,
            stiffness,
            damping,
            ref tables,
            ..
        } => {
            let ends = [(Some(body_a), point_a), (body_b, point_b)];
            let inverse = ends.into_iter().map(|(body, point)| match body {
                Some(body) => mobility(&model.bodies[body], &point),
                None => 0.0,
            });
            (elastic(stiffness, tables), damping, inverse.sum())
        }
        LoadKind::TorsionSpring {
            joint,
            stiffness,
            damping,
            ref tables,
            ..
        } => {
            let joint = &model.joints[joint];
            let about = |body: usize, axis: &Vec3<f64>| {
                1.0 / axis.dot(&(model.bodies[body].inertia * axis))
            };
            let a = about(joint.body_a, &joint.frame_a.axes[2]);
            let b = joint.body_b.map(|body| about(body, &joint.frame_b.axes[2]));
            (elastic(stiffness, tables), damping, a + b.unwrap_or(0.0))
        }
        LoadKind::Force { .. }
        | LoadKind::Distributed(_)
        | LoadKind::Controller(_)
        | LoadKind::Torque { .. }
        | LoadKind::Damping { .. }
        | LoadKind::BallDamping { .. }
        | LoadKind::Bushing { .. }
        | LoadKind::Friction { .. }
        | LoadKind::Drag { .. }
        // They vibrate only while they touch, where the error of the steps sees it.
        | LoadKind::JointStop { .. }
        | LoadKind::DistanceStop { .. }
        | LoadKind::Cable(_)
        | LoadKind::Contact(_) => return None,
    };
    let omega = (stiffness * inverse).sqrt();
    (omega > 0.0).then(|| (omega, 0.5 * damping * omega / stiffness))
}
