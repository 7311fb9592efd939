//! Bodies of shells as finite elements: forces and energies against the elements of statics and against sums
//! over points, and the motion of free bodies.

use crate::reference;

use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::integrate::{Method, Settings, Trajectory, simulate};
use flexbody_mechanics::model::{Form, Inertia, Model};
use flexbody_mechanics::structures::shell::{Field, Motion, NODES, ShellKind, Terms};
use flexbody_mechanics::structures::state::Configuration;
use flexbody_mechanics::structures::supports::{AtNode, NodeUnknowns, Rotations, Unknowns};
use flexbody_mechanics::system::bodies::{BodyMotion, all_force_balances};
use flexbody_mechanics::system::marker::{MarkerKinematics, RelativeMotion};
use flexbody_mechanics::system::{Numbering, finite, flexible, placement};
use reference::flexible::totals;
use reference::models::Numbers;
use reference::shells::{Shells, elastic_at_end, shells_of};

/// Elements of nine and of four nodes on the same nodes.
const KINDS: [(ShellKind, usize); 2] = [(ShellKind::Mitc9, 1), (ShellKind::Mitc4, 2)];

/// A free body of shells of nine nodes at a random state.
fn free(seed: u64, elements: [usize; 2], clamped: bool, size: f64) -> (Model<f64>, Shells) {
    free_of(ShellKind::Mitc9, seed, elements, clamped, size)
}

fn free_of(
    kind: ShellKind,
    seed: u64,
    elements: [usize; 2],
    clamped: bool,
    size: f64,
) -> (Model<f64>, Shells) {
    let mut numbers = Numbers(seed);
    let shells = shells_of(kind, &mut numbers, elements, clamped);
    let mut frame = numbers.body("panel");
    (frame.mass, frame.inertia) = shells.elements.rigid();
    let mut model = Model {
        gravity: numbers.vector() * 9.0,
        bodies: vec![frame],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    let count = shells.elements.mesh.coordinates;
    let start = |numbers: &mut Numbers, by: f64| -> Vec<f64> {
        numbers.list(count).iter().map(|x| x * by).collect()
    };
    let (q, rate) = (start(&mut numbers, size), start(&mut numbers, 5.0 * size));
    model.add_flexible(0, (&q, &rate), Form::Finite(shells.elements.clone()));
    (model, shells)
}

/// Coordinates as a motion of the nodes of an element.
fn field(shells: &Shells, index: usize, q: &[f64]) -> Field<f64> {
    let element = &shells.elements.mesh.elements[index];
    let mut field = Field::zeros();
    for (coordinate, (point, along)) in element.coordinates.iter().zip(&element.moves) {
        let Some(i) = coordinate else { continue };
        match point / NODES {
            0 => field.points[*point] += along * q[*i],
            _ => field.directors[point - NODES] += along * q[*i],
        }
    }
    field
}

/// The energy is that of the elements of statics with von Karman's strains; forces are its derivatives.
#[test]
fn elastic_energy_is_that_of_the_shells() {
    let none = AtNode {
        displacements: [None; 3],
        rotations: Rotations::Global([false; 3]),
        first_rotation: 0,
    };
    let all = [(1, [1, 1], false), (2, [2, 1], true), (3, [2, 2], false)];
    for ((seed, elements, clamped), (kind, times)) in all.into_iter().flat_map(with_kinds) {
        let elements = elements.map(|n: usize| n * times);
        let (_, shells) = free_of(kind, seed, elements, clamped, 0.05);
        let own = &shells.elements;
        let q: Vec<f64> = Numbers(seed + 50).list(own.mesh.coordinates);
        let q: Vec<f64> = q.iter().map(|q| q * 0.05).collect();
        let unknowns = Unknowns {
            nodes: vec![none; shells.structure.nodes.len()],
            count: 0,
        };
        let at = Configuration::new(&shells.structure, &unknowns, NodeUnknowns::Natural);
        let mut exact = 0.0;
        for (i, element) in own.mesh.elements.iter().enumerate() {
            let mut shell = at.shell(i);
            shell.thickness = own.thickness[i];
            shell.material.young = own.young[i];
            let field = field(&shells, i, &q);
            // θ × D gives back what moves the director.
            let mut motion = Motion::zeros();
            motion.displacement = field.points;
            for a in 0..element.nodes.len() {
                let d = &element.points[NODES + a];
                motion.rotation[a] = d.cross(&field.directors[a]);
            }
            exact += shell.energy(&motion, Terms::VON_KARMAN).total();
        }
        let energy = finite::energy(own, &q);
        assert!((energy - exact).abs() < 1e-12 * exact, "{energy} {exact}");
        let mut force = vec![0.0; q.len()];
        finite::add_forces(own, &q, &mut force);
        let lifted = flexbody_mathematics::math::Parameters::map(
            own,
            &mut flexbody_mathematics::math::Complex64::from,
        );
        let largest = force.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        for (j, force) in force.iter().enumerate() {
            let mut q: Vec<_> = q
                .iter()
                .map(|&q| flexbody_mathematics::math::Complex64::new(q, 0.0))
                .collect();
            q[j].im = 1e-30;
            let slope = finite::energy(&lifted, &q).im / 1e-30;
            assert!((force - slope).abs() < 1e-12 * largest);
        }
    }
}

/// The virtual power of the forces is the sum over Gauss points of mass times acceleration less gravity, and
/// of rotary inertia times the acceleration of directors; energy and momenta likewise.
#[test]
fn inertia_is_that_of_the_points() {
    let all = [(11, [1, 1], false), (12, [2, 1], true)];
    for ((seed, elements, clamped), (kind, times)) in all.into_iter().flat_map(with_kinds) {
        let elements = elements.map(|n: usize| n * times);
        let (model, shells) = free_of(kind, seed, elements, clamped, 0.1);
        let own = &shells.elements;
        let numbering = Numbering::new(&model);
        let (q, v) = placement::guess(&model);
        let mut numbers = Numbers(seed + 70);
        let (a, w) = (numbers.list(v.len()), numbers.list(v.len()));
        let mut motions = Vec::new();
        BodyMotion::all(&numbering, &q, &v, &mut motions);
        let mut forces = vec![0.0; v.len()];
        all_force_balances(&model, &numbering, &motions, &a, &mut forces);
        flexible::add_force_balances(&model, &numbering, &motions, &a, &mut forces);
        let places: Vec<(usize, usize)> = model.flexible[0].places().collect();
        let elastic = |of: &[f64], start: &dyn Fn(usize) -> usize| -> Vec<f64> {
            places.iter().map(|&(b, k)| of[start(b) + k]).collect()
        };
        let by_v = |b: usize| numbering.velocity(b);
        let (x, xdot) = (elastic(&q, &|b| numbering.position(b)), elastic(&v, &by_v));
        let (xddot, xw) = (elastic(&a, &by_v), elastic(&w, &by_v));
        let mut elastic_power = 0.0;
        let mut stiff = vec![0.0; x.len()];
        finite::add_forces(own, &x, &mut stiff);
        stiff
            .iter()
            .zip(&xw)
            .for_each(|(f, w)| elastic_power += f * w);
        let all = (0..6).chain(places.iter().map(|&(b, k)| by_v(b) + k));
        let power: f64 = all.map(|i| forces[i] * w[i]).sum::<f64>() - elastic_power;
        let motion = motions[0].accelerated(&a).virtually(&w);
        let origin = MarkerKinematics::moving_point(&motion, &Vec3::zeros(), None);
        let (mut exact, mut kinetic) = (0.0, 0.0);
        let (mut linear, mut angular) = (Vec3::zeros(), Vec3::zeros());
        for (i, element) in own.mesh.elements.iter().enumerate() {
            let [u, rate, second, along] = [&x, &xdot, &xddot, &xw].map(|x| field(&shells, i, x));
            let tables = kind.tables();
            for (k, basis) in tables.gauss.iter().enumerate() {
                let nodes = |all: &dyn Fn(usize) -> Vec3<f64>| {
                    let all = (0..basis.n.len()).map(|a| all(a) * basis.n[a]);
                    all.fold(Vec3::zeros(), |sum: Vec3<f64>, x| sum + x)
                };
                let h = own.thickness[i];
                let tangents = [0, 1].map(|d| {
                    let all = (0..basis.n.len()).map(|a| element.points[a] * basis.by[d][a]);
                    all.fold(Vec3::zeros(), |sum: Vec3<f64>, x| sum + x)
                });
                let area = tangents[0].cross(&tangents[1]).norm() * tables.weights[k];
                let masses = [
                    own.density[i] * h + own.surface_mass[i],
                    own.density[i] * h.powi(3) / 12.0,
                ];
                for (kind, mass) in masses.into_iter().enumerate() {
                    let of = |field: &Field<f64>, a: usize| match kind {
                        0 => field.points[a],
                        _ => field.directors[a],
                    };
                    let local = RelativeMotion {
                        rate: nodes(&|a| of(&rate, a)),
                        acceleration: nodes(&|a| of(&second, a)),
                        virtual_rate: nodes(&|a| of(&along, a)),
                    };
                    let place = nodes(&|a| element.points[kind * NODES + a] + of(&u, a));
                    let mut at = MarkerKinematics::moving_point(&motion, &place, Some(&local));
                    let mut gravity = model.gravity;
                    if kind == 1 {
                        at = at.minus(&origin);
                        gravity = Vec3::zeros();
                    } else {
                        linear += at.rate * (mass * area);
                    }
                    exact += mass * area * (at.acceleration - gravity).dot(&at.virtual_rate);
                    kinetic += 0.5 * mass * area * at.rate.norm_squared();
                    angular += at.x.cross(&at.rate) * (mass * area);
                }
            }
        }
        assert!(
            (power - exact).abs() <= 1e-12 * exact.abs().max(10.0),
            "{power} {exact}"
        );
        let (energy, _, momentum, turning) = totals(&model, &motions);
        assert!((energy - kinetic).abs() <= 1e-12 * kinetic.max(1.0));
        assert!((momentum - linear).norm() <= 1e-12 * linear.norm().max(10.0));
        assert!((turning - angular).norm() <= 1e-12 * angular.norm().max(10.0));
    }
}

const RADAU: Method = Method::Radau { stages: 3 };

fn run(model: &Model<f64>, duration: f64, steps: usize) -> Trajectory<f64> {
    simulate(model, duration, &Settings::steps(RADAU, steps)).expect("runs")
}

/// A case with each kind of elements.
fn with_kinds<T: Copy>(case: T) -> [(T, (ShellKind, usize)); 2] {
    KINDS.map(|kind| (case, kind))
}

/// A free body keeps its momenta; its energy is kept to the order of the method; a velocity that is added
/// to all of it changes nothing of its deformation.
#[test]
fn a_free_body_moves_as_it_must() {
    for (kind, times) in KINDS {
        free_motion(free_of(kind, 21, [2, 1].map(|n| n * times), false, 0.02).0);
    }
}

fn free_motion(mut model: Model<f64>) {
    model.gravity.fill(0.0);
    let held = |run: &Trajectory<f64>, k: usize| {
        let mut motions = Vec::new();
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        let (kinetic, potential, momentum, angular) = totals(&model, &motions);
        (kinetic + potential, momentum, angular)
    };
    let drift = |steps: usize| {
        let run = run(&model, 0.2, steps);
        let (first, last) = (held(&run, 0), held(&run, run.last()));
        let (linear, angular) = ((first.1 - last.1).norm(), (first.2 - last.2).norm());
        ([(first.0 - last.0).abs(), linear, angular], run)
    };
    let (coarse, fine) = (drift(40), drift(80));
    for (coarse, fine) in coarse.0.into_iter().zip(fine.0) {
        assert!(coarse / fine > 8.0 && fine < 1e-5, "{coarse:e} {fine:e}");
    }
    let mut faster = model.clone();
    faster.bodies[0].velocity += Vec3::new(6.0, -8.0, 3.0);
    let (own, other) = (fine.1, run(&faster, 0.2, 80));
    let at_end = |run: &Trajectory<f64>| elastic_at_end(&model, run);
    for (x, y) in at_end(&own).iter().zip(at_end(&other)) {
        assert!((x - y).abs() < 1e-10, "{x} {y}");
    }
}

/// The inertia that leaves out deformations keeps its own energy and depends on the velocity of the observer: 10 m/s
/// that are added to a free body change its deformation by much more than the 1e-10 m of the full inertia.
#[test]
fn truncated_inertia_depends_on_the_observer() {
    let (mut model, _) = free(21, [2, 1], false, 0.02);
    model.gravity.fill(0.0);
    model.flexible[0].inertia = Inertia::Paper;
    let energy = |run: &Trajectory<f64>, k: usize| {
        let mut motions = Vec::new();
        BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
        let (kinetic, potential, _, _) = totals(&model, &motions);
        kinetic + potential
    };
    let drift = |steps: usize| {
        let run = run(&model, 0.2, steps);
        ((energy(&run, 0) - energy(&run, run.last())).abs(), run)
    };
    let ((coarse, _), (fine, own)) = (drift(40), drift(80));
    assert!(coarse / fine > 8.0 && fine < 1e-5, "{coarse:e} {fine:e}");
    let mut faster = model.clone();
    faster.bodies[0].velocity += Vec3::new(6.0, -8.0, 3.0);
    let other = run(&faster, 0.2, 80);
    let at_end = |run: &Trajectory<f64>| elastic_at_end(&model, run);
    let (own, other) = (at_end(&own), at_end(&other));
    let apart = own.iter().zip(&other).map(|(x, y)| (x - y).abs());
    let apart = apart.fold(0.0_f64, f64::max);
    assert!(apart > 0.1, "{apart:e}");
}
