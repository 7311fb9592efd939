//! Beams, lumped masses and damping of bodies of elements: energies against the elements of statics and against sums
//! over points, momenta, and what damping leaves alone.

use crate::reference;

use flexbody_mathematics::math::{Mat3, Team, Vec3};
use flexbody_mechanics::integrate::{Method, Settings, Trajectory, simulate};
use flexbody_mechanics::model::finite::FiniteElements;
use flexbody_mechanics::model::{Form, Model};
use flexbody_mechanics::structures::beam::{BeamMotion, Section, SectionValues};
use flexbody_mechanics::structures::floating::{FrameNodes, Surface, element_mesh};
use flexbody_mechanics::structures::generate::straight_beam;
use flexbody_mechanics::structures::lumped_mass::LumpedMass;
use flexbody_mechanics::structures::material::Material;
use flexbody_mechanics::structures::parts::{coordinates, of_beam, of_mass};
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::system::bodies::BodyMotion;
use flexbody_mechanics::system::{Numbering, finite, placement};
use reference::flexible::totals;
use reference::models::{Numbers, alone};
use reference::shells::{any_beam, elastic_at_end, stiffened};
use std::sync::Arc;

/// A straight beam of one element with an offset, clamped at its start, and a mass at its end; the unknowns of its
/// nodes.
fn cantilever(
    numbers: &mut Numbers,
) -> (FiniteElements<f64>, Surface, [usize; 3], LumpedMass<f64>) {
    let ends = [Vec3::new(0.1, -0.2, 0.3), Vec3::new(1.2, 0.4, 0.1)];
    let v = Vec3::new(0.3, 0.1, 1.0);
    let line = straight_beam(ends, v, 1);
    let material = Material {
        young: 90.0,
        poisson: 0.3,
        density: 3.0,
        yield_stress: 20.0,
    };
    let none = Section::Given(SectionValues::zeros());
    let structure = Structure::with_beams(
        line.mesh,
        line.nodes,
        0.1,
        none,
        line.orientations,
        material,
    );
    let structure = structure.expect("a sound mesh");
    let nodes = structure.topology.mesh.beams[0];
    let frame = FrameNodes::Clamped(vec![nodes[0]]);
    let (mut mesh, surface) = element_mesh(&structure, &frame).expect("has its sets");
    let own = nodes.map(|node| surface.unknowns(node));
    let beam = any_beam(numbers, own.each_ref().map(|node| node.place), v);
    let mass = LumpedMass {
        mass: 0.4,
        inertia: [0.03, 0.04, 0.05, 0.004, -0.003, 0.002],
    };
    let last = surface.unknowns(nodes[2]);
    let parts = vec![of_beam(&own, &beam), of_mass(&last, &mass)];
    mesh.parts = vec![coordinates(&own), coordinates(&[last])];
    let finite = FiniteElements {
        thickness: Vec::new(),
        young: Vec::new(),
        density: Vec::new(),
        surface_mass: Vec::new(),
        parts,
        damping: None,
        mesh: Arc::new(mesh),
        team: Team::default(),
    };
    (finite, surface, nodes, mass)
}

/// The motion of the nodes of the beam at coordinates `q`.
fn nodal(surface: &Surface, nodes: &[usize; 3], q: &[f64]) -> BeamMotion<f64> {
    let mut motion = BeamMotion::zeros();
    for (a, &node) in nodes.iter().enumerate() {
        let own = surface.unknowns(node);
        for k in 0..3 {
            motion.displacement[a][k] = own.displacements[k].map_or(0.0, |i| q[i]);
        }
        for (i, axis) in &own.rotations {
            motion.rotation[a] += axis * q[*i];
        }
    }
    motion
}

/// Strain energy, kinetic energy, mass and first moment of a beam are those of the beams of statics; those of a lumped
/// mass are m v² / 2 and ωᵀ J ω / 2.
#[test]
fn energies_are_those_of_statics() {
    for seed in 1..4 {
        let mut numbers = Numbers(seed);
        let (finite, surface, nodes, mass) = cantilever(&mut numbers);
        let mut numbers = Numbers(seed);
        let places = nodes.map(|node| surface.unknowns(node).place);
        let beam = any_beam(&mut numbers, places, Vec3::new(0.3, 0.1, 1.0));
        let q = numbers.list(finite.mesh.coordinates);
        let rate = numbers.list(finite.mesh.coordinates);
        let exact = beam.energy(&nodal(&surface, &nodes, &q), true);
        let found = finite::energy(&finite, &q);
        assert!((found - exact).abs() < 1e-12 * exact, "{found} {exact}");
        // At rest as a whole: no terms of the frame.
        let mut frame = numbers.body("beam");
        (frame.velocity, frame.angular_velocity) = (Vec3::zeros(), Vec3::zeros());
        let (total, inertia) = finite.rigid();
        (frame.mass, frame.inertia) = (total, inertia);
        let mut model = alone(frame);
        let still = vec![0.0; rate.len()];
        model.add_flexible(0, (&still, &rate), Form::Finite(finite.clone()));
        let numbering = Numbering::new(&model);
        let (places, v) = placement::guess(&model);
        let mut motions = Vec::new();
        BodyMotion::all(&numbering, &places, &v, &mut motions);
        let (kinetic, _, _, _) = totals(&model, &motions);
        let moved = nodal(&surface, &nodes, &rate);
        let (u, w) = (moved.displacement[2], moved.rotation[2]);
        let exact = beam.kinetic_energy(&moved)
            + 0.5 * mass.mass * u.norm_squared()
            + 0.5 * mass.momentum(&w).dot(&w);
        assert!((kinetic - exact).abs() < 1e-12 * exact, "{kinetic} {exact}");
        let moments = beam.mass_moments();
        assert!((total - moments.mass - mass.mass).abs() < 1e-13 * total);
        let first = finite::first_moment(&finite, &still);
        let end = surface.unknowns(nodes[2]).place;
        assert!((first - moments.first - end * mass.mass).norm() < 1e-12);
    }
}

const RADAU: Method = Method::Radau { stages: 3 };

/// A free panel with beams, masses and damping.
fn free(seed: u64, damping: Option<[f64; 2]>) -> Model<f64> {
    let mut numbers = Numbers(seed);
    let mut shells = stiffened(&mut numbers, [2, 1], false);
    shells.elements.damping = damping;
    let mut frame = numbers.body("panel");
    (frame.mass, frame.inertia) = shells.elements.rigid();
    let mut model = alone(frame);
    let count = shells.elements.mesh.coordinates;
    let mut start = |by: f64| -> Vec<f64> { numbers.list(count).iter().map(|x| x * by).collect() };
    let (q, rate) = (start(0.02), start(0.1));
    model.add_flexible(0, (&q, &rate), Form::Finite(shells.elements));
    model
}

fn run(model: &Model<f64>, steps: usize) -> Trajectory<f64> {
    simulate(model, 0.2, &Settings::steps(RADAU, steps)).expect("runs")
}

fn held(model: &Model<f64>, run: &Trajectory<f64>, k: usize) -> (f64, Vec3<f64>, Vec3<f64>) {
    let mut motions = Vec::new();
    BodyMotion::all(&run.numbering, run.q(k), run.v(k), &mut motions);
    let (kinetic, potential, momentum, angular) = totals(model, &motions);
    (kinetic + potential, momentum, angular)
}

/// A free body keeps its momenta, damped or not; undamped, its energy to the order of the method. Damping takes energy.
/// A velocity that is added to all of it changes nothing of its deformation.
#[test]
fn a_free_body_moves_as_it_must() {
    for damping in [None, Some([0.3, 0.02])] {
        let model = free(31, damping);
        let drift = |steps: usize| {
            let run = run(&model, steps);
            let (first, last) = (held(&model, &run, 0), held(&model, &run, run.last()));
            let (linear, angular) = ((first.1 - last.1).norm(), (first.2 - last.2).norm());
            ([first.0 - last.0, linear, angular], run)
        };
        let (coarse, fine) = (drift(40), drift(80));
        for (k, (coarse, fine)) in coarse.0.into_iter().zip(fine.0).enumerate() {
            match (k, damping) {
                (0, Some(_)) => assert!(fine > 1e-3 && (coarse / fine - 1.0).abs() < 1e-3),
                _ => assert!(
                    (coarse / fine).abs() > 8.0 && fine.abs() < 1e-5,
                    "{coarse:e} {fine:e}"
                ),
            }
        }
        let mut faster = model.clone();
        faster.bodies[0].velocity += Vec3::new(6.0, -8.0, 3.0);
        let (own, other) = (fine.1, run(&faster, 80));
        let at_end = |run: &Trajectory<f64>| elastic_at_end(&model, run);
        for (x, y) in at_end(&own).iter().zip(at_end(&other)) {
            assert!((x - y).abs() < 1e-10, "{x} {y}");
        }
    }
}

/// Forces of damping are those of strain rates: none where strains are constant. The derivative of the strain energy
/// along the rates is the power of the forces; damping's power is what it takes.
#[test]
fn damping_takes_energy_and_leaves_still_strains_alone() {
    let mut numbers = Numbers(41);
    let shells = stiffened(&mut numbers, [2, 1], false);
    let mut own = shells.elements;
    let q: Vec<f64> = numbers.list(own.mesh.coordinates);
    let rate = numbers.list(own.mesh.coordinates);
    let forces = |own: &FiniteElements<f64>, rate: &[f64]| {
        let mut out = vec![0.0; q.len()];
        finite::add_damping(own, (&q, rate), &mut out);
        out
    };
    own.damping = Some([0.0; 2]);
    assert!(forces(&own, &rate).iter().all(|f| *f == 0.0));
    for damping in [[1.0, 0.0], [0.0, 1.0]] {
        own.damping = Some(damping);
        let power: f64 = forces(&own, &rate)
            .iter()
            .zip(&rate)
            .map(|(f, r)| f * r)
            .sum();
        assert!(power > 0.0);
        let none = vec![0.0; rate.len()];
        assert!(forces(&own, &none).iter().all(|f| *f == 0.0));
    }
    // The forces of small motions are β times the stiffness: those of the strain energy at small rates.
    own.damping = Some([0.0, 0.7]);
    let small: Vec<f64> = rate.iter().map(|x| 1e-9 * x).collect();
    let mut elastic = vec![0.0; q.len()];
    finite::add_forces(&own, &small, &mut elastic);
    let mut damped = vec![0.0; q.len()];
    finite::add_damping(&own, (&vec![0.0; q.len()], &small), &mut damped);
    let size = elastic.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
    for (f, d) in elastic.iter().zip(&damped) {
        assert!((0.7 * f - d).abs() < 1e-7 * size);
    }
}

/// A mass without size is a point: its second moment is that of the place.
#[test]
fn a_point_mass_has_the_inertia_of_a_point() {
    let mut numbers = Numbers(51);
    let (_, surface, nodes, _) = cantilever(&mut numbers);
    let node = surface.unknowns(nodes[1]);
    let part = of_mass(&node, &LumpedMass::point(2.0));
    let exact: Mat3<f64> = node.place * node.place.transpose() * 2.0;
    assert!((part.second - exact).norm() < 1e-14);
    assert!((part.inertia.centre - node.place * 2.0).norm() < 1e-15);
}
