//! The smallest system that moves as a scene does: what is left out of it before anything is
//! integrated, and why nothing more is.
//!
//! A reduction is made only if it changes nothing but round-off, at every design: it is examined at
//! the start, at both bounds and at designs between them, and by dual numbers in its derivative by
//! every variable. The same examination, in values, is repeated wherever a scene is made.

mod examine;
pub mod fixed;
mod in_plane;
mod normal;
pub mod planar;
pub mod point;
mod tilt;

pub use examine::Obstacle;
pub use fixed::Fixed;
pub use planar::Plane;

use crate::functions::Scene;
use crate::math::{Dual, Scalar};
use crate::model::{ConstraintRow, Mobility};
use crate::system::redundancy;

/// Whether something may be left out, or what stands against it.
type Verdict = Result<(), Obstacle>;

/// A design variable, as far as it matters here.
#[derive(Clone, Debug)]
pub struct Range {
    /// Name.
    pub name: String,
    /// Where the design starts.
    pub start: f64,
    /// Bounds, infinite if there are none.
    pub bounds: [f64; 2],
    /// A typical change.
    pub scale: f64,
}

/// What is left out of the scenes of a problem.
#[derive(Clone, Debug)]
pub struct Lowering {
    /// The plane that all motion stays in, or what leaves every plane.
    pub plane: Result<Plane, Obstacle>,
    /// Bodies whose rotation nothing turns or looks at.
    pub points: Vec<usize>,
    /// Bodies that nothing can move.
    pub fixed: Fixed,
    /// Rows that follow from others once these are ground, by joint.
    left_out: Vec<Vec<ConstraintRow>>,
}

/// Designs between the bounds at which a reduction is examined.
const BETWEEN: usize = 4;

impl Lowering {
    /// Finds what can be left out of the scenes that `real` and `dual` make of a design.
    pub fn find(
        real: &dyn Fn(&[f64]) -> Scene<f64>,
        dual: &dyn Fn(&[Dual]) -> Scene<Dual>,
        variables: &[Range],
    ) -> Self {
        let start: Vec<f64> = variables.iter().map(|variable| variable.start).collect();
        let first = real(&start);
        let others: Vec<Scene<f64>> = designs(variables).iter().map(|x| real(x)).collect();
        let seed = |i: usize| -> Vec<Dual> {
            let part = |j: usize| if i == j { 1.0 } else { 0.0 };
            start
                .iter()
                .enumerate()
                .map(|(j, &x)| Dual::new(x, part(j)))
                .collect()
        };
        let derived = variables.iter().enumerate();
        let derived: Vec<(&Range, Scene<Dual>)> = derived
            .map(|(i, variable)| (variable, dual(&seed(i))))
            .collect();
        // Asks a question of all designs and of all derivatives.
        let everywhere = |at: &dyn Fn(&Scene<f64>) -> Result<(), Obstacle>,
                          by: &dyn Fn(&Scene<Dual>, f64) -> Verdict| {
            for (variable, scene) in &derived {
                // How finely the optimiser scales it says nothing of what it can break.
                let change = variable.scale.max(variable.start.abs()).max(1.0);
                by(scene, change).map_err(|obstacle| Obstacle {
                    variable: Some(variable.name.clone()),
                    ..obstacle
                })?;
            }
            others.iter().try_for_each(at).map_err(|obstacle| Obstacle {
                elsewhere: true,
                ..obstacle
            })
        };
        let plane = Plane::find(&first.model).and_then(|plane| {
            everywhere(&|scene| plane.holds(&scene.model, 0.0), &|scene, change| {
                plane.holds(&scene.model, change)
            })?;
            Ok(plane)
        });
        let points = match &plane {
            // A body in the plane has three unknowns already.
            Ok(_) => Vec::new(),
            Err(_) => (0..first.model.bodies.len())
                .filter(|&body| {
                    let here = point::holds(&first, body, 0.0);
                    here.is_ok()
                        && everywhere(&|scene| point::holds(scene, body, 0.0), &|scene, change| {
                            point::holds(scene, body, change)
                        })
                        .is_ok()
                })
                .collect(),
        };
        let fixed = Fixed::find(&first.model);
        let stays = everywhere(&|scene| fixed.holds(&scene.model, 0.0), &|scene, change| {
            fixed.holds(&scene.model, change)
        });
        let mut found = Self {
            plane,
            points,
            fixed: match stays {
                Ok(()) => fixed,
                Err(_) => Fixed::default(),
            },
            left_out: Vec::new(),
        };
        if !found.fixed.is_empty() {
            let mut lowered = first.clone();
            found.apply(&mut lowered);
            redundancy::leave_out(&mut lowered.model);
            let joints = lowered.model.joints.into_iter();
            found.left_out = joints.map(|joint| joint.left_out).collect();
        }
        found
    }

    /// Every reduction, with what it leaves or what stands against it.
    pub fn reductions(&self) -> Vec<(&'static str, Result<String, Obstacle>)> {
        let plane = match &self.plane {
            Ok(plane) => {
                let [x, y, z] = [plane.normal.x, plane.normal.y, plane.normal.z];
                Ok(format!(
                    "the scene moves in the plane across ({x:.6}, {y:.6}, {z:.6}); three unknowns \
                     a body"
                ))
            }
            Err(obstacle) => Err(obstacle.clone()),
        };
        vec![("motion out of a plane", plane)]
    }

    /// Leaves out of `scene` what can be; false if its design does not admit some of it, which is
    /// then left in.
    pub fn apply<S: Scalar>(&self, scene: &mut Scene<S>) -> bool {
        let mut all = true;
        if let Ok(plane) = &self.plane {
            match plane.holds(&scene.model, 0.0) {
                Ok(()) => plane.apply(&mut scene.model),
                Err(_) => all = false,
            }
        }
        for &body in &self.points {
            match point::holds(scene, body, 0.0) {
                Ok(()) => scene.model.bodies[body].mobility = Mobility::Point,
                Err(_) => all = false,
            }
        }
        if !all || self.fixed.holds(&scene.model, 0.0).is_err() {
            return false;
        }
        self.fixed.apply(&mut scene.model);
        for (joint, left_out) in scene.model.joints.iter_mut().zip(&self.left_out) {
            joint.left_out.clone_from(left_out);
        }
        true
    }
}

/// Both corners of the bounds, and designs spread between them in a fixed way.
fn designs(variables: &[Range]) -> Vec<Vec<f64>> {
    if variables.is_empty() {
        return Vec::new();
    }
    let ends = |variable: &Range| {
        let [lower, upper] = variable.bounds;
        let finite = |bound: f64, otherwise: f64| match bound.is_finite() {
            true => bound,
            false => otherwise,
        };
        let (start, scale) = (variable.start, variable.scale);
        [finite(lower, start - scale), finite(upper, start + scale)]
    };
    let at = |part: &dyn Fn(usize) -> f64| {
        let value = |(i, variable): (usize, &Range)| {
            let [lower, upper] = ends(variable);
            lower + part(i) * (upper - lower)
        };
        variables.iter().enumerate().map(value).collect()
    };
    let mut all = vec![at(&|_| 0.0), at(&|_| 1.0)];
    for k in 1..=BETWEEN {
        // Fractional parts of multiples of an irrational number.
        all.push(at(&|i| {
            (0.618_033_988_749_895 * (k + 7 * i + 1) as f64).fract()
        }));
    }
    all
}
