//! The problem files of the stability suite, and the families of its cases.

use super::case::SceneFile;

macro_rules! scene {
    ($name:literal) => {
        scene!("extreme", $name)
    };
    ($folder:literal, $name:literal) => {
        SceneFile {
            folder: $folder,
            name: concat!($name, ".json"),
            text: include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"),
                "/../../problems/",
                $folder,
                "/",
                $name,
                ".json"
            )),
        }
    };
}

pub(super) const DOUBLE_PENDULUM: SceneFile = scene!("double_pendulum");
pub(super) const SPRING_PENDULUM: SceneFile = scene!("spring_pendulum");
pub(super) const OSCILLATOR: SceneFile = scene!("damped_oscillator");
pub(super) const PENDULUM: SceneFile = scene!("pendulum");
pub(super) const TOP: SceneFile = scene!("tumbling_top");
pub(super) const WHEEL: SceneFile = scene!("wheel");
pub(super) const AGGREGATE: SceneFile = scene!("aggregate");
pub(super) const DOOR: SceneFile = scene!("door");
pub(super) const DUMBBELL: SceneFile = scene!("dumbbell");
pub(super) const OPEN_JOINT: SceneFile = scene!("open_joint");
pub(super) const LOCKING: SceneFile = scene!("locking_linkage");
pub(super) const UNBOUNDED: SceneFile = scene!("unbounded_throw");
pub(super) const INFEASIBLE: SceneFile = scene!("infeasible_throw");
pub(super) const CANTILEVER_PLATE: SceneFile = scene!("cantilever_plate");
pub(super) const FLEXIBLE_PENDULUM: SceneFile = scene!("flexible_pendulum");
pub(super) const TURNING_BAR: SceneFile = scene!("turning_bar");
pub(super) const FALLING_CHAIN_10: SceneFile = scene!("falling_chain_10");
pub(super) const FALLING_CHAIN_100: SceneFile = scene!("falling_chain_100");
pub(super) const FALLING_CHAIN_1000: SceneFile = scene!("falling_chain_1000");
pub(super) const COVERED_PLATE: SceneFile = scene!("covered_plate");
pub(super) const SWINGING_PLATE: SceneFile = scene!("swinging_plate");
pub(super) const TUMBLING_PLATE: SceneFile = scene!("tumbling_plate");
pub(super) const TURNING_PLATE: SceneFile = scene!("turning_plate");
pub(super) const INWARD_PLATE: SceneFile = scene!("inward_plate");
pub(super) const FALLING_PLATES_10: SceneFile = scene!("falling_plates_10");
pub(super) const FALLING_PLATES_100: SceneFile = scene!("falling_plates_100");
pub(super) const FALLING_PLATES_1000: SceneFile = scene!("falling_plates_1000");
pub(super) const PARALLELOGRAM: SceneFile = scene!("parallelogram");
pub(super) const FOUR_BARS_1: SceneFile = scene!("benchmarks", "four_bars_1");
pub(super) const FOUR_BARS_2: SceneFile = scene!("benchmarks", "four_bars_2");
pub(super) const FOUR_BARS_10: SceneFile = scene!("benchmarks", "four_bars_10");
pub(super) const BRICARD: SceneFile = scene!("benchmarks", "bricard");
pub(super) const SQUEEZER: SceneFile = scene!("benchmarks", "andrews_squeezer");
pub(super) const SLIDER_CRANK: SceneFile = scene!("benchmarks", "balanced_slider_crank");
pub(super) const GOVERNOR: SceneFile = scene!("benchmarks", "flyball_governor");

/// The families with their descriptions.
pub(super) const FAMILIES: [(&str, &str); 35] = [
    (
        "mass-ratio",
        "Two hinged rods swing for 2 s; the lower one has this many times the mass of the upper one.",
    ),
    (
        "stiffness",
        "A bob swings on a spring without damping, started without vibration; this is ω h of the \
         spring at steps of 1 ms.",
    ),
    (
        "damping",
        "A block on a spring of 10 rad/s with this damping ratio, released 0.1 m off, for 1 s.",
    ),
    (
        "step-size",
        "Two hinged rods swing for 2 s by equal steps of this size [s].",
    ),
    (
        "many-steps",
        "A rod swings for 100 s by this many equal steps.",
    ),
    (
        "turns",
        "A box turns about a horizontal axis so many times, its pitch through 90 degrees twice a \
         turn; a free cylinder cones about a horizontal axis so many times.",
    ),
    (
        "hinge-distance",
        "A door of 1 m by 2 m on two ball joints at this distance [m]; its centre is far from both.",
    ),
    (
        "no-inertia",
        "A rod without inertia about its own axis, or next to none, on a hinge or on a ball joint.",
    ),
    (
        "open-start",
        "A rod at this distance [m] from its hinge; its centre is pushed across at this speed [m/s].",
    ),
    (
        "length",
        "Two hinged rods of this length [m] swing for the same number of their own periods.",
    ),
    (
        "rho",
        "The Kreisselmeier–Steinhauser function of a point that circles once, with this ρ [1/m].",
    ),
    (
        "speed",
        "Two hinged cylinders fly at this speed [m/s] and turn at 3 rad/s; a box whose end turns at this \
         speed.",
    ),
    (
        "locking",
        "A four-bar linkage whose coupler is at its longest 2.1 m; this is its length [m].",
    ),
    (
        "optimum",
        "Optimisations that have no optimum, or run into designs at which the mechanism locks.",
    ),
    (
        "passage",
        "A parallelogram of rods turns without gravity, ends so far [rad] from one of the positions in \
         which all rods lie in a line, and passes four of them at this speed [rad/s].",
    ),
    (
        "tolerance",
        "One, two and ten parallelograms in a row, which pass ten singular positions in 10 s, by steps to \
         this tolerance.",
    ),
    (
        "order",
        "Scenes with closed loops, their joints and the two bodies of each in random order.",
    ),
    (
        "rotation",
        "Scenes with closed loops, turned as a whole about a random axis by a random angle.",
    ),
    (
        "units",
        "Scenes with closed loops, lengths and masses multiplied by these numbers.",
    ),
    (
        "elasticity",
        "A beam on a hinge swings for 1 s; this is its Young's modulus [Pa].",
    ),
    (
        "undamped",
        "A beam on a hinge swings for so long [s] without damping.",
    ),
    (
        "spin",
        "A beam on a hinge turns steadily and is stretched; this is its angular velocity by √(E/ρ) / L. At π/2 \
         it has no steady state.",
    ),
    (
        "chain",
        "A straight chain of this many hinged beams that falls freely.",
    ),
    (
        "thickness",
        "A cantilever plate of shells of 1 m with this thickness [m], in equilibrium with a force that deflects \
         it by 1 mm.",
    ),
    (
        "load",
        "A cantilever plate of shells of 10 mm, in equilibrium with this load P L² / EI at its end.",
    ),
    (
        "bend",
        "A cantilever plate of shells of 10 mm, bent by a moment at its end to an arc of this angle [rad].",
    ),
    (
        "cover",
        "A cantilever plate of shells of 10 mm, in equilibrium with this load q L³ / EI along its length. No point \
         but its root is observed.",
    ),
    (
        "squeeze",
        "A cantilever plate of shells of 1 m that a force shortens by this part of its length. Its elements are \
         inverted above 1.",
    ),
    (
        "across",
        "The same, shortened by this part of its width of 0.25 m.",
    ),
    (
        "sideways",
        "The same, bent in its own plane by this deflection [m].",
    ),
    (
        "shell-elasticity",
        "A plate of shells on a hinge swings for 1 s; this is its Young's modulus [Pa].",
    ),
    (
        "shell-undamped",
        "A free plate of shells tumbles and vibrates for so long [s] without damping.",
    ),
    (
        "shell-spin",
        "A plate of shells turns with a drive and is stretched; this is its angular velocity by √(E/ρ) / L. At π/2 \
         it has no steady state.",
    ),
    (
        "shell-buckling",
        "A plate of shells points from a turning ring to its axis and is compressed; this is its angular velocity by \
         that at which it buckles.",
    ),
    (
        "shell-chain",
        "A straight chain of this many hinged plates of one or two shells that falls freely.",
    ),
];
