//! Kept factors of scenes with shells turn with the bodies.

use crate::reference;

use flexbody_mathematics::linalg::SparseMatrix;
use flexbody_mathematics::math::{Mat3, Vec3, rotation};
use flexbody_mechanics::integrate::implicit::ggl::{Equations, StepState};
use flexbody_mechanics::integrate::implicit::turned::Turned;
use flexbody_mechanics::model::Model;
use flexbody_mechanics::system::{Numbering, RedundantRows, placement};
use reference::models::Numbers;
use reference::shells::shell_swing;

/// Positions, velocities, both kinds of multipliers, and the rates of positions and velocities.
struct State {
    model: Model<f64>,
    q: Vec<f64>,
    v: Vec<f64>,
    multipliers: [Vec<f64>; 2],
    qdot: Vec<f64>,
    vdot: Vec<f64>,
}

impl State {
    fn matrix(&self, numbering: &Numbering) -> SparseMatrix<f64> {
        let mut equations = Equations::new(&self.model, numbering);
        let at = StepState {
            q: &self.q,
            v: &self.v,
            lambda: &self.multipliers[0],
            mu: &self.multipliers[1],
            qdot: &self.qdot,
            vdot: &self.vdot,
            time: 0.0,
        };
        let mut matrix = SparseMatrix::new(equations.pattern(&at));
        matrix.assemble(|emit| equations.jacobian(&at, 0.01, 70.0, emit));
        matrix
    }
}

fn turn(by: &Mat3<f64>, x: &mut [f64]) {
    let turned = by * Vec3::new(x[0], x[1], x[2]);
    x[..3].copy_from_slice(turned.as_slice());
}

/// A swing of shells on a ball joint at random, with its joint and gravity turned as one: K' = T K Tᵀ.
#[test]
fn the_matrix_of_a_turned_scene_is_turned() {
    for (seed, elements) in [(31, [1, 1]), (32, [2, 1])] {
        let mut model = shell_swing(seed, elements);
        model.loads.clear();
        let mut numbers = Numbers(seed + 7);
        for body in &mut model.bodies {
            body.velocity += numbers.vector();
        }
        let numbering = Numbering::new(&model);
        let (q, v) = placement::guess(&model);
        let rows = numbering.constraints();
        let first = State {
            multipliers: [numbers.list(rows), numbers.list(rows)],
            qdot: numbers.list(q.len()),
            vdot: numbers.list(v.len()),
            model: model.clone(),
            q,
            v,
        };
        let p = numbers.orientation();
        let by = rotation::matrix(&p);
        let mut other = State {
            model,
            q: first.q.clone(),
            v: first.v.clone(),
            multipliers: first.multipliers.clone(),
            qdot: first.qdot.clone(),
            vdot: first.vdot.clone(),
        };
        other.model.gravity = by * other.model.gravity;
        for body in 0..numbering.bodies() {
            let (o, u) = (numbering.position(body), numbering.velocity(body));
            if !numbering.mobility(body).has_rotation() {
                continue;
            }
            for x in [&mut other.q, &mut other.qdot] {
                turn(&by, &mut x[o..]);
                let own = [x[o + 3], x[o + 4], x[o + 5], x[o + 6]];
                x[o + 3..o + 7].copy_from_slice(&rotation::compose(&p, &own));
            }
            turn(&by, &mut other.v[u..]);
            turn(&by, &mut other.vdot[u..]);
        }
        for (j, joint) in other.model.joints.iter_mut().enumerate() {
            if joint.body_b.is_none() {
                joint.frame_b.point = by * joint.frame_b.point;
                joint.frame_b.axes = joint.frame_b.axes.map(|axis| by * axis);
            }
            let row = numbering.rows(j).start;
            for multipliers in &mut other.multipliers {
                turn(&by, &mut multipliers[row..]);
            }
        }
        let mut turned = Turned::new(&first.model, &numbering);
        let left_out = RedundantRows::of(&first.model, &numbering);
        turned.set(&numbering, (&first.q, &other.q), &left_out);
        let equations = Equations::new(&first.model, &numbering);
        let (before, after) = (first.matrix(&numbering), other.matrix(&numbering));
        let length = equations.length();
        let x = numbers.list(equations.order());
        let through = |x: &[f64], f: &dyn Fn(&mut [f64])| {
            let mut all = x.to_vec();
            all.resize(length, 0.0);
            equations.expand(&mut all);
            f(&mut all);
            equations.compress(&mut all);
            all.truncate(equations.order());
            all
        };
        let turned_first = after.multiply(&through(&x, &|x| turned.forth(x)));
        let turned_last = through(&before.multiply(&x), &|x| turned.forth(x));
        let size = turned_last.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (a, b) in turned_first.iter().zip(&turned_last) {
            assert!((a - b).abs() < 1e-13 * size, "{seed}: {a} {b} of {size}");
        }
        let back = through(&turned_last, &|x| turned.back(x));
        for (a, b) in back.iter().zip(&before.multiply(&x)) {
            assert!((a - b).abs() < 1e-13 * size);
        }
    }
}
