//! Shells in a reduced basis: the projection against the shells themselves.

use crate::reference;

use flexbody_mathematics::math::{Mat3, Vec3};
use flexbody_mechanics::model::finite::FiniteElements;
use flexbody_mechanics::model::flexible::Modal;
use flexbody_mechanics::model::{Form, Model};
use flexbody_mechanics::structures::shell::ShellKind;
use flexbody_mechanics::system::bodies::{BodyMotion, all_force_balances};
use flexbody_mechanics::system::reduction::{
    ModeChoice, ReducedBasis, Request, project, reduced_basis,
};
use flexbody_mechanics::system::{Numbering, flexible, placement};
use nalgebra::{DMatrix, DVector};
use reference::flexible::totals;
use reference::models::Numbers;
use reference::shells::{aluminium_plate, projected, shells_of};

/// A free body in this form, with the motion of its frame and coordinates, and its accelerations.
fn free(numbers: &Numbers, form: Form<f64>, start: [&[f64]; 3]) -> (Model<f64>, Vec<f64>) {
    let mut numbers = Numbers(numbers.0);
    let mut frame = numbers.body("panel");
    (frame.mass, frame.inertia) = (7.0, Mat3::identity());
    let mut model = Model {
        gravity: Vec3::new(1.0, -9.0, 2.0),
        bodies: vec![frame],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
    model.add_flexible(0, (start[0], start[1]), form);
    let numbering = Numbering::new(&model);
    let mut a = vec![0.0; numbering.velocities()];
    a[..6].copy_from_slice(&numbers.list(6));
    for ((carrier, k), &second) in model.flexible[0].places().zip(start[2]) {
        a[numbering.velocity(carrier) + k] = second;
    }
    (model, a)
}

/// The force balance of the frame, that of the coordinates, and energies and momenta.
fn balance((model, a): &(Model<f64>, Vec<f64>)) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let numbering = Numbering::new(model);
    let (q, v) = placement::guess(model);
    let mut motions = Vec::new();
    BodyMotion::all(&numbering, &q, &v, &mut motions);
    let mut out = vec![0.0; v.len()];
    all_force_balances(model, &numbering, &motions, a, &mut out);
    flexible::add_force_balances(model, &numbering, &motions, a, &mut out);
    let places = model.flexible[0].places();
    let elastic = places.map(|(carrier, k)| out[numbering.velocity(carrier) + k]);
    let (kinetic, potential, momentum, angular) = totals(model, &motions);
    let mut kept = vec![kinetic, potential];
    kept.extend(momentum.iter().chain(angular.iter()));
    let stress = flexible::stress_ratios(&model.flexible[0], &motions, &[0]);
    kept.extend(stress);
    (out[..6].to_vec(), elastic.collect(), kept)
}

/// With beams, masses and damping too: forces on the frame, energies, momenta and stresses are those of the shells in the motion v = V q; forces on
/// the coordinates are Vᵀ times theirs.
#[test]
fn a_basis_takes_the_mechanics_of_its_shells() {
    // Stiffeners are not among these: a basis leaves out the coupling of twist and bending of beams.
    let (nine, four) = (ShellKind::Mitc9, ShellKind::Mitc4);
    for (seed, kind, elements, clamped, vectors) in [
        (1, nine, [1, 1], false, 2),
        (2, nine, [2, 1], true, 5),
        (3, nine, [2, 2], false, 4),
        (4, four, [3, 2], true, 5),
        (5, four, [2, 3], false, 4),
    ] {
        let mut numbers = Numbers(seed);
        let shells = shells_of(kind, &mut numbers, elements, clamped);
        let mut projected = projected(&mut numbers, &shells, vectors);
        // All of these bend.
        projected = flexbody_mechanics::system::reduction::project(
            &shells.elements.mesh,
            &(0..shells.elements.mesh.elements.len()).collect::<Vec<_>>(),
            projected.basis.vectors.clone(),
            (0..vectors).collect(),
        );
        let start = [0.05, 0.3, 2.0]
            .map(|size| -> Vec<f64> { numbers.list(vectors).iter().map(|x| x * size).collect() });
        let nodal = start.each_ref().map(|q| {
            let mut out = vec![0.0; shells.elements.mesh.coordinates];
            for (vector, q) in projected.basis.vectors.iter().zip(q) {
                out.iter_mut()
                    .zip(vector)
                    .for_each(|(out, v)| *out += q * v);
            }
            out
        });
        let lists = |all: &'_ [Vec<f64>; 3]| [all[0].clone(), all[1].clone(), all[2].clone()];
        let (own, all) = (lists(&start), lists(&nodal));
        let modal = Form::Modal(projected.modal(shells.elements.clone()));
        let reduced = balance(&free(&numbers, modal, own.each_ref().map(|x| &x[..])));
        let finite = Form::Finite(shells.elements.clone());
        let full = balance(&free(&numbers, finite, all.each_ref().map(|x| &x[..])));
        let mut forces = vec![0.0; vectors];
        projected.basis.add_transposed(&full.1, &mut forces);
        let pairs = [
            (&reduced.0, &full.0),
            (&reduced.1, &forces),
            (&reduced.2, &full.2),
        ];
        for (found, exact) in pairs {
            let size = exact.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            assert_eq!(found.len(), exact.len());
            for (found, exact) in found.iter().zip(exact) {
                assert!(
                    (found - exact).abs() <= 1e-12 * size,
                    "{seed}: {found} {exact}"
                );
            }
        }
    }
}

/// Energies of the plate in a basis, of bending and of what stretch remains if all else yields, when the first
/// coordinate moves the tip by 20 mm.
fn bent(shells: &FiniteElements<f64>, basis: &ReducedBasis) -> [f64; 2] {
    let slots = vec![0; shells.mesh.elements.len()];
    let vectors = basis.vectors.clone();
    let modal: Modal<f64> =
        project(&shells.mesh, &slots, vectors, basis.bending.clone()).modal(shells.clone());
    let (m, bending) = (basis.vectors.len(), basis.bending.len());
    let stiffness = DMatrix::from_row_slice(m, m, &modal.stiffness.linear);
    let pairs = &modal.shells.expect("shells").pairs;
    let n = pairs.count();
    let tip = basis.vectors[0]
        .iter()
        .fold(0.0_f64, |most, x| most.max(x.abs()));
    let q = 0.02 / tip;
    // s has the square of the first coordinate first.
    let force = DVector::from_fn(m - bending, |i, _| pairs.cubic[(bending + i) * n] * q * q);
    let stretch = stiffness.view((bending, bending), (m - bending, m - bending));
    let yields = match m - bending {
        0 => 0.0,
        _ => {
            let factors = stretch.into_owned().cholesky().expect("definite");
            0.5 * force.dot(&factors.solve(&force))
        }
    };
    let locked = 0.5 * pairs.quartic[0] * q.powi(4);
    [0.5 * stiffness[(0, 0)] * q * q, locked - yields]
}

/// A plate bends into a cylinder nearly without stretch: its membrane displacements follow. Without companions they
/// cannot, and the plate is hundreds of times too stiff.
#[test]
fn bending_alone_locks() {
    let shells = aluminium_plate([8, 2], 1e-3);
    let of = |companions: bool| {
        let request = Request {
            modes: ModeChoice::Count(6),
            companions,
            deflection: 0.0,
            tolerance: 1e-3,
        };
        let basis = reduced_basis(&shells, &[], &[], &[], &request).expect("a basis");
        assert_eq!(basis.companions > 0, companions);
        let [bending, stretch] = bent(&shells, &basis);
        stretch / bending
    };
    let (with, without) = (of(true), of(false));
    assert!(with < 0.5 && without > 100.0, "{with:e} {without:e}");
}
