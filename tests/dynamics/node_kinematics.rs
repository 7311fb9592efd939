//! The kinematics q̇ = v of nodes, which solutions leave out where they hold.

use crate::reference;

use flexbody_mechanics::integrate::implicit::ggl::{Equations, StepState};
use flexbody_mechanics::model::Form;
use flexbody_mechanics::system::{Numbering, placement};
use reference::models::{Numbers, alone};
use reference::shells::aluminium_plate;

/// Velocities of all nodes but for some units of round-off, then with one node off by more, of any size.
#[test]
fn round_off_of_kinematics_is_zero_and_nothing_else() {
    let elements = aluminium_plate([4, 2], 5e-3);
    let mut frame = Numbers(1).body("plate");
    (frame.mass, frame.inertia) = elements.rigid();
    let mut model = alone(frame);
    let still = vec![0.0; elements.mesh.coordinates];
    model.add_flexible(0, (&still, &still), Form::Finite(elements));
    let numbering = Numbering::new(&model);
    let (q, mut v) = placement::guess(&model);
    let (mut qdot, vdot) = (vec![0.0; q.len()], vec![0.0; v.len()]);
    let places: Vec<[usize; 2]> = (model.flexible[0].places())
        .map(|(carrier, k)| {
            [
                numbering.position(carrier) + k,
                numbering.velocity(carrier) + k,
            ]
        })
        .collect();
    let numbers = Numbers(7).list(places.len());
    let mut equations = Equations::new(&model, &numbering);
    let mut residual = vec![0.0; equations.length()];
    for size in [1e-9, 1.0, 1e6] {
        for (&[position, velocity], x) in places.iter().zip(&numbers) {
            v[velocity] = size * x;
            qdot[position] = size * x * (1.0 + f64::EPSILON);
        }
        for off in [0.0, 1e-14, 1e-10, -0.5] {
            let [position, own] = places[5];
            qdot[position] = v[own] + off * size;
            let at = StepState {
                q: &q,
                v: &v,
                lambda: &[],
                mu: &[],
                qdot: &qdot,
                vdot: &vdot,
                time: 0.0,
            };
            equations.residual(&at, 0.5, &mut residual);
            for &[_, velocity] in &places {
                let expected = if velocity == own {
                    0.5 * off * size
                } else {
                    0.0
                };
                let found = residual[velocity];
                assert!(
                    (found - expected).abs() <= 1e-15 * size,
                    "{size} {off}: {found}"
                );
                assert!(expected != 0.0 || found == 0.0, "{size} {off}: {found}");
            }
        }
    }
}
