//! Failures of the start of a model.

/// The reason why a model has no consistent initial conditions.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AssemblyFailure {
    /// The joints cannot be closed near the given placement.
    #[error(
        "joint \"{joint}\" cannot be assembled: its {row} stays open by {gap:.3e} at iteration \
         {iterations}"
    )]
    Open {
        /// Joint with the largest gap.
        joint: String,
        /// The row with the gap.
        row: String,
        /// The gap \[m or 1\].
        gap: f64,
        /// Number of iterations.
        iterations: usize,
    },
    /// The joint's axes coincide only after half a turn.
    #[error("joint \"{joint}\" was assembled with its axes turned by 180 degrees")]
    Turned {
        /// The joint.
        joint: String,
    },
    /// The start of a joint is determined by others.
    #[error(
        "the start of joint \"{joint}\" cannot be chosen: the other joints, their starts and drives \
         determine it"
    )]
    Determined {
        /// The joint.
        joint: String,
    },
    /// Constraints are redundant.
    #[error(
        "{redundant} of {constraints} constraints are redundant; joints that repeat each other: \
         {joints}"
    )]
    Redundant {
        /// Number of redundant constraints.
        redundant: usize,
        /// Number of all constraints.
        constraints: usize,
        /// Names of their joints.
        joints: String,
    },
    /// Constraints are dependent at this placement, but not near it.
    #[error(
        "the placement is a singular position, in which the joints do not determine how the bodies \
         move on: {joints}"
    )]
    SingularPosition {
        /// Names of the joints with dependent constraints.
        joints: String,
    },
    /// A motion that the joints allow has no inertia.
    #[error("bodies that can move without inertia: {bodies}")]
    WithoutInertia {
        /// Names of the bodies.
        bodies: String,
        /// Whether none of them has mass.
        without_mass: bool,
    },
    /// Newton's method finds no quasi-static start.
    #[error(
        "no start in equilibrium: Newton's method for the deformations under gravity and loads does not \
         converge, stopped at iteration {iterations}"
    )]
    NoEquilibrium {
        /// Number of iterations.
        iterations: usize,
    },
    /// Places on a flexible body that are the same at a design, but move apart with a variable.
    #[error(
        "no derivative: two places on \"{body}\" are the same at this design, and a variable moves them apart"
    )]
    MovedApart {
        /// The body.
        body: String,
    },
    /// Nothing holds bodies in a position of rest.
    #[error("the machine does not come to rest: nothing holds {bodies} against gravity and loads")]
    NotHeld {
        /// Names of the bodies that can move without stiffness.
        bodies: String,
    },
    /// The damped motion finds no rest.
    #[error("no position of rest is found near the placement, stopped at iteration {iterations}")]
    NoRest {
        /// Number of iterations.
        iterations: usize,
    },
    /// A machine cannot turn steadily about an axis.
    #[error(
        "no steady rotation: the machine is not the same after it has turned about the axis; {why}"
    )]
    NotAlike {
        /// What is not.
        why: String,
    },
    /// The motor of a controller whose integral holds a joint at rest.
    #[error(
        "at rest \"{load}\" would need an effort of {effort:.6e}, which the limits of its motor do not allow"
    )]
    TooWeak {
        /// Name of the controller.
        load: String,
        /// The effort \[N or N m\].
        effort: f64,
    },
    /// Rest has no such modes of vibration.
    #[error("no natural frequencies about rest: {why}")]
    NoModes {
        /// The reason.
        why: String,
    },
    /// The equations are singular or not finite for another reason.
    #[error(
        "the equations of motion are singular to working precision at this placement, though joints \
         and inertia determine the motion: lengths, masses or times differ too much from one"
    )]
    Singular,
}
