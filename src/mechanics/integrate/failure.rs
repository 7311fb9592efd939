//! Failures of a simulation.

use crate::math::{Parameters, Scalar};
use crate::model::Model;
use crate::system::dead_points;
use crate::system::failure::AssemblyFailure;

/// The reason why a simulation did not reach its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum IntegrationFailure {
    /// There is no consistent start.
    #[error(transparent)]
    Assembly(#[from] AssemblyFailure),
    /// Newton's method did not converge.
    #[error(
        "Newton's method stalled at t = {time:.6e} s (step {step}) after {iterations} iterations: \
         {}, worst in {worst} \
         (smaller steps may help: more \"steps\", or a \"tolerance\")",
        size(*residual)
    )]
    NewtonStalled {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// Iterations spent.
        iterations: usize,
        /// Largest scaled residual.
        residual: f64,
        /// The equation, and its body or joint.
        worst: String,
    },
    /// The iteration matrix is singular.
    #[error(
        "the equations became singular at t = {time:.6e} s (step {step}), at {place}: the mechanism is at a \
         singular position, or the step is too large"
    )]
    Singular {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// The unknown without a pivot, by body or joint.
        place: String,
    },
    /// The positions could not be brought back onto the constraints.
    #[error(
        "the joints could not be closed again at t = {time:.6e} s (step {step}): the step is too \
         large for the motion, or the mechanism is at a singular position"
    )]
    Projection {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// A step ends too close to a singular position for its motion to be known to the accuracy.
    #[error(
        "the mechanism is at a singular position at t = {time:.6e} s (step {step}){drive}, where the joints do \
         not determine its motion: a step that ends there is not accurate"
    )]
    SingularPosition {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// The drive that is at a dead point there, as text; empty if none is.
        drive: String,
    },
    /// The motion inside a step leaves the joints.
    #[error(
        "the joints open inside the step that ends at t = {time:.6e} s (step {step}), by more than the \
         accuracy allows: the step is too large for the motion, or passes a singular position"
    )]
    Opened {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// The estimated error of a given step is as large as the motion.
    #[error(
        "the explicit steps are too large at t = {time:.6e} s (step {step}): the estimated error of the \
         step is {error:.1e} of the scene's lengths and speeds; take more steps, a tolerance, or a radau \
         method"
    )]
    Unstable {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// Estimated error, relative to the scene's lengths and speeds.
        error: f64,
    },
    /// A given step passes over a contact.
    #[error(
        "the step that ends at t = {time:.6e} s (step {step}) passes over a contact of load \"{load}\", which \
         comes and goes within it; take more \"steps\", or a \"tolerance\""
    )]
    MissedContact {
        /// The load.
        load: String,
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// Stability, not accuracy, bounds the steps of an explicit method.
    #[error(
        "the scene is stiff at t = {time:.6e} s (step {step}): an explicit method needs steps far \
         smaller than the accuracy asks for; use a radau method"
    )]
    Stiff {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// Work of an implicit method relative to that of the explicit one, if it was measured.
        share: Option<f64>,
    },
    /// The tolerance requires steps that are too small.
    #[error(
        "the tolerance cannot be kept at t = {time:.6e} s (step {step}): the steps became too small"
    )]
    StepTooSmall {
        /// Time reached \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// Too many steps in a row were rejected.
    #[error(
        "the tolerance cannot be kept at t = {time:.6e} s (step {step}): {in_a_row} steps in a row were \
         rejected, as smaller ones err as much; the tolerance may be below what rounding allows, or \
         the motion may jump"
    )]
    Rejected {
        /// Time reached \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// Number of these steps.
        in_a_row: usize,
    },
    /// The steps are so small that the motion makes no headway.
    #[error(
        "the motion makes no headway at t = {time:.6e} s of {duration} s (step {step}): the latest \
         {tries} steps that were tried, {rejected} of them rejected, advanced it by {advance:.1e} s; \
         such small steps are needed where a mechanism is nearly locked, a load is very stiff or very \
         fast, or the tolerance is below what rounding allows, and where a small tolerance follows the fast \
         vibrations of flexible bodies; with \"seconds\" in \"simulation\" it \
         may take that long"
    )]
    NoHeadway {
        /// Time reached \[s\].
        time: f64,
        /// Time to be reached \[s\].
        duration: f64,
        /// Step number, from 1.
        step: usize,
        /// Latest steps that were tried.
        tries: usize,
        /// Number of rejected ones among them.
        rejected: usize,
        /// Time by which they advanced the motion \[s\].
        advance: f64,
    },
    /// All simulations must end.
    #[error("the simulation was interrupted")]
    Interrupted,
    /// The simulation exceeded its time limit.
    #[error(
        "the simulation exceeds its time limit of {seconds} s at t = {time:.6e} s of {duration} s \
         (step {step})"
    )]
    TimeLimit {
        /// The limit \[s\].
        seconds: f64,
        /// Time reached \[s\].
        time: f64,
        /// Time to be reached \[s\].
        duration: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// A value overflowed or became NaN.
    #[error(
        "the motion is not finite at t = {time:.6e} s (step {step}), in {worst}: the step may be too large"
    )]
    NotFinite {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// The equation, and its body or joint.
        worst: String,
    },
    /// A row that was redundant at the start is no longer redundant.
    #[error(
        "joint \"{joint}\" opens by {gap:.3e} at t = {time:.6e} s (step {step}): a row of it was left \
         out, as it followed from the other joints at the start, and does not follow any more"
    )]
    RedundancyLost {
        /// The joint.
        joint: String,
        /// |Φ| of the row \[m or 1\].
        gap: f64,
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// A driven joint is half a turn off its drive.
    #[error(
        "joint \"{joint}\" is half a turn off its drive at t = {time:.6e} s (step {step}): the steps \
         are too large for it"
    )]
    Turned {
        /// The joint.
        joint: String,
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
    },
    /// The energy of a conservative motion has changed.
    #[error(
        "energy is not conserved: at t = {time:.6e} s it is off by {drift:.3e} J, and {exchanged:.3e} J are \
         exchanged on the way; nothing in the scene dissipates or drives, and the errors of the steps do \
         not explain it: this is not its motion; take a smaller tolerance, or another method"
    )]
    EnergyLost {
        /// Time at which it was found \[s\].
        time: f64,
        /// |E(time) − E(0)| \[J\].
        drift: f64,
        /// Largest kinetic energy or change of potential energy \[J\].
        exchanged: f64,
    },
    /// The motion gains energy that nothing supplies.
    #[error(
        "at t = {time:.6e} s (step {step}) the motion has gained {gained:.3e} J that no load supplied \
         ({available:.3e} J were available): the explicit steps are unstable for a fast vibration; take a \
         radau method, or a smaller tolerance"
    )]
    EnergyGained {
        /// Time of the step's end \[s\].
        time: f64,
        /// Step number, from 1.
        step: usize,
        /// Energy above that of the start \[J\].
        gained: f64,
        /// Energy at the start, of gravity, and supplied by loads and drives \[J\].
        available: f64,
    },
    /// Mass and inertia of a body are not those of a solid.
    #[error(
        "body \"{body}\" has no mass and inertia of a solid: mass and principal moments are \
         not negative, and no moment exceeds the sum of the others"
    )]
    Unphysical {
        /// The body.
        body: String,
    },
    /// A number of the scene is not defined.
    #[error("{what}")]
    Undefined {
        /// Which, and its value.
        what: String,
    },
    /// The section of a beam cannot be built.
    #[error("body \"{body}\" has a section with {fault}")]
    Section {
        /// The body.
        body: String,
        /// The size and its limit.
        fault: String,
    },
    /// The event that ends the run does not occur, or not where it occurred for earlier designs.
    #[error(
        "the {quantity} of the event does not reach {value} within {waited} s: the smallest \
         difference from it is {nearest:.3e}"
    )]
    NotReached {
        /// The quantity.
        quantity: String,
        /// Its value at the event.
        value: f64,
        /// Smallest distance from it.
        nearest: f64,
        /// Waiting time \[s\].
        waited: f64,
    },
    /// The quantity that ends the run touches its value and turns back.
    #[error(
        "the {quantity} of the event only touches {value} at t = {time:.6e} s and turns back: the \
         time of such an event has no derivative, and at some designs nearby there is no event; choose \
         a value that it crosses"
    )]
    Touches {
        /// The quantity.
        quantity: String,
        /// Its value at the event.
        value: f64,
        /// The time \[s\].
        time: f64,
    },
    /// A flexible body passes through itself.
    #[error(
        "\"{body}\" is turned inside out at t = {time:.6e} s ({place}): it is loaded beyond what it can bear, \
         or its steps are too large"
    )]
    InsideOut {
        /// The body.
        body: String,
        /// The first such part.
        place: String,
        /// Time \[s\].
        time: f64,
    },
    /// The motion needs more memory than is available.
    #[error(
        "the motion takes {needed} of memory, and {available} are available: {samples} samples of \
         {bodies} bodies take {of_samples}; ask for fewer in /simulation/samples, or give \
         /simulation/tolerance instead of steps{hint}"
    )]
    Memory {
        /// Needed memory, as text.
        needed: String,
        /// Available memory, as text.
        available: String,
        /// Number of samples.
        samples: usize,
        /// Number of bodies.
        bodies: usize,
        /// Memory of the samples, as text.
        of_samples: String,
        /// Further advice.
        hint: &'static str,
    },
    /// The duration is zero, negative or not finite.
    #[error("the duration {duration} s is not positive")]
    Duration {
        /// The duration \[s\].
        duration: f64,
    },
}

impl IntegrationFailure {
    /// The time that a motion reached which cannot be continued; steps that are too large for a method fail otherwise
    /// \[s\].
    pub fn time(&self) -> Option<f64> {
        match self {
            Self::NewtonStalled { time, .. }
            | Self::Singular { time, .. }
            | Self::Projection { time, .. }
            | Self::SingularPosition { time, .. }
            | Self::Opened { time, .. }
            | Self::StepTooSmall { time, .. }
            | Self::Rejected { time, .. }
            | Self::NoHeadway { time, .. }
            | Self::NotFinite { time, .. }
            | Self::RedundancyLost { time, .. }
            | Self::Turned { time, .. }
            | Self::InsideOut { time, .. } => Some(*time),
            _ => None,
        }
    }

    /// The same failure with the drive at a dead point, if it is a singular position of one; q are positions near it.
    pub fn with_drive<S: Scalar>(mut self, model: &Model<S>, q: &[S]) -> Self {
        if let Self::SingularPosition { time, drive, .. } = &mut self {
            let model = model.map(&mut |x| x.re());
            let q: Vec<f64> = q.iter().map(|x| x.re()).collect();
            if let Some(joint) = dead_points::driven_to_dead_point(&model, &q, *time) {
                *drive = format!(", a dead point of the drive of joint \"{joint}\"");
            }
        }
        self
    }
}

/// The size of a residual in a message.
fn size(residual: f64) -> String {
    match residual.is_finite() {
        true => format!("scaled residual {residual:.3e}"),
        false => "residual not finite".into(),
    }
}
