//! The map from a design to its scene, compiled once for each scalar.

use super::{Problem, StaticScene, Statics, phases, scene};
use crate::functions::{Function, Scene};
use crate::math::{Complex64, Dual, Scalar};
use crate::system::flexible;

/// Scalars in which a scene can be built: `f64` for values, `Complex64` for the complex step, `Dual` for
/// derivatives by a variable. Other crates call these instances instead of compiling their own.
pub trait SceneScalar: Scalar {
    /// See [`Problem::unlowered_scene`].
    fn unlowered_scene(problem: &Problem, x: &[Self]) -> Scene<Self>;
    /// See [`Problem::lower`].
    fn lower(problem: &Problem, scene: &mut Scene<Self>) -> bool;
    /// See [`Problem::static_scene`].
    fn static_scene(problem: &Problem, statics: &Statics, x: &[Self]) -> StaticScene<Self>;
}

macro_rules! scene_scalar {
    ($scalar:ty) => {
        impl SceneScalar for $scalar {
            fn unlowered_scene(problem: &Problem, x: &[Self]) -> Scene<Self> {
                unlowered_scene(problem, x)
            }

            fn lower(problem: &Problem, scene: &mut Scene<Self>) -> bool {
                let lowering = problem.lowering.as_ref();
                lowering.is_none_or(|lowering| lowering.apply(scene))
            }

            fn static_scene(problem: &Problem, statics: &Statics, x: &[Self]) -> StaticScene<Self> {
                statics.scene(&problem.written, &problem.extended(x))
            }
        }
    };
}
scene_scalar!(f64);
scene_scalar!(Complex64);
scene_scalar!(Dual);

fn unlowered_scene<S: Scalar>(problem: &Problem, x: &[S]) -> Scene<S> {
    let (x, state) = problem.split(x);
    let mut scene = scene::scene(&problem.written, &problem.order, &problem.extended(x));
    flexible::set_team(&mut scene.model, &problem.team);
    phases::begin(&problem.written, &mut scene, state);
    for (joint, left_out) in scene.model.joints.iter_mut().zip(&problem.left_out) {
        let (rows, fit) = left_out;
        joint.redundant.clone_from(rows);
        joint.fit = *fit;
    }
    phases::leave_out(&problem.written, &mut scene.model, state);
    if problem.nearest_to.is_some() {
        let distance = problem.distance_from_start(x);
        scene.functions.push(Function::OfDesign {
            unit: "1",
            value: distance,
        });
    }
    if let Some(focus) = &problem.focus {
        focus.seen.apply(&mut scene);
    }
    scene
}
