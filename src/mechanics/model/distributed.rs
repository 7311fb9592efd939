//! Loads that are spread over the elements of a flexible body.
//!
//! Node a stands at x_a in the axes of the frame and has the shape function N_a. With a magnitude m(t) and a direction
//! n it takes the force
//!
//! ```text
//! pressure     f_a = m ∫ N_a x,r × x,s dr ds                x the deformed surface: the pressure follows it
//! dead load    f_a = m s_a n,     s_a = ∫ N_a dl or ∫ N_a dA of the undeformed body
//! air          f_a = −m ∫ N_a g(u) (c u + c_n n (n·u)) dA,   u the velocity and n the normal of the deformed surface,
//!              g = uᵀu / √(uᵀu + w²)
//! ```
//!
//! n is fixed in ground axes or in those of the frame. Forces and their derivatives are in `system::loads`.

use super::axes::Axes;
use super::time_function::TimeFunction;
use crate::math::{Vec3, parameters};
use std::sync::Arc;

/// A load that is spread over the elements of a flexible body.
#[derive(Clone, Debug)]
pub struct DistributedLoad<S> {
    /// The body that is the frame of the flexible body.
    pub body: usize,
    /// How it is spread.
    pub spread: Spread<S>,
    /// m(t) \[Pa, or N/m along a line\].
    pub magnitude: TimeFunction<S>,
}

/// How a load is spread over elements.
#[derive(Clone, Debug)]
pub enum Spread<S> {
    /// Along the normals of the deformed shells.
    Pressure {
        /// The shells.
        shells: Arc<[usize]>,
    },
    /// In a fixed direction.
    Dead {
        /// Nodes, and s_a \[m or m²\].
        shares: Arc<[(usize, f64)]>,
        /// n; it is not normalised.
        direction: Vec3<S>,
        /// Axes of n.
        axes: Axes,
    },
    /// By the air at rest through which the shells move.
    Air {
        /// The shells.
        shells: Arc<[usize]>,
        /// The air.
        air: Air<S>,
    },
}

/// Drag and lift for each area of a surface that moves through air at rest.
#[derive(Clone, Debug)]
pub struct Air<S> {
    /// c, of the force against the velocity \[N s²/m⁴\].
    pub coefficient: S,
    /// c_n, of that along the normal \[N s²/m⁴\].
    pub normal_coefficient: S,
    /// Speed w, well above which the force is quadratic \[m/s\].
    pub width: S,
}

parameters!(struct DistributedLoad { body; spread, magnitude });

parameters!(enum Spread { Pressure { shells; }, Dead { shares, axes; direction }, Air { shells; air } });

parameters!(struct Air {; coefficient, normal_coefficient, width });

impl<S> Spread<S> {
    /// Whether the load may supply energy.
    pub fn supplies(&self) -> bool {
        match self {
            Self::Pressure { .. } | Self::Dead { .. } => true,
            Self::Air { .. } => false,
        }
    }
}
