//! What an inexact Newton step of shells would cost by GMRES with the factors of an earlier step as right
//! preconditioner (FGMRES with a constant preconditioner, Saad 1993), beside new factors of the same matrix.

use crate::reference;

use flexbody_mathematics::linalg::gmres::gmres;
use flexbody_mathematics::linalg::{SparseLu, SparseMatrix};
use flexbody_mathematics::math::Vec3;
use flexbody_mathematics::math::slices::dot;
use flexbody_mechanics::integrate::implicit::ggl::{Equations, StepState};
use flexbody_mechanics::model::{Form, Model};
use flexbody_mechanics::system::{Numbering, placement};
use reference::models::{Numbers, alone};
use reference::shells::aluminium_plate;
use std::time::Instant;

/// A free plate of aluminium of 1 m × 0.25 m × 5 mm, clamped to its frame.
fn plate(along: usize) -> Model<f64> {
    let elements = aluminium_plate([along, along / 4], 5e-3);
    let mut frame = Numbers(1).body("plate");
    (frame.mass, frame.inertia) = elements.rigid();
    let mut model = alone(frame);
    let still = vec![0.0; elements.mesh.coordinates];
    model.add_flexible(0, (&still, &still), Form::Finite(elements));
    model
}

/// The plate bent like x², its tip by this deflection \[m\], as positions of the model.
fn bent(model: &Model<f64>, numbering: &Numbering, deflection: f64) -> Vec<f64> {
    let (mut q, _) = placement::guess(model);
    let Form::Finite(elements) = &model.flexible[0].form else {
        return q;
    };
    let places: Vec<(usize, usize)> = model.flexible[0].places().collect();
    let mut set = |coordinate: Option<usize>, value: f64| {
        if let Some(i) = coordinate {
            q[numbering.position(places[i].0) + places[i].1] = value;
        }
    };
    for element in &elements.mesh.elements {
        for (coordinate, (point, along)) in element.coordinates.iter().zip(&element.moves) {
            let x = element.points[point % 9].x;
            // Positions by the deflection, directors by its slope.
            let target = match point / 9 {
                0 => Vec3::new(0.0, 0.0, deflection * x * x),
                _ => Vec3::new(-2.0 * deflection * x, 0.0, 0.0),
            };
            set(*coordinate, along.dot(&target) / along.norm_squared());
        }
    }
    q
}

/// GMRES without restart, with factors on the right: products until the residual is `tolerance` of its start.
fn iterations(
    matrix: &SparseMatrix<f64>,
    factors: &mut SparseLu<f64>,
    b: &[f64],
    tolerance: f64,
) -> usize {
    let mut products = 0;
    let product = |v: &[f64]| {
        products += 1;
        let mut z = v.to_vec();
        factors.solve(&mut z);
        matrix.multiply(&z)
    };
    gmres(product, b, tolerance, 60);
    products
}

/// `cargo test --release --lib -- --ignored --nocapture newton_krylov` prints the table. The plate is bent by 5 mm in
/// the factors and by 6, 10 and 20 mm in the matrix; steps of 1 ms by BDF2.
#[test]
#[ignore = "a table of times"]
fn a_krylov_step_beside_new_factors() {
    println!(
        "elements unknowns  factors[s]  solve[s] product[s]  iterations to 1e-2 and 1e-6 from 6, 10, 20 mm"
    );
    for along in [16, 32, 64, 96] {
        let model = plate(along);
        let numbering = Numbering::new(&model);
        let (_, v) = placement::guess(&model);
        let matrix = |deflection: f64| {
            let q = bent(&model, &numbering, deflection);
            let (qdot, vdot) = (vec![0.0; q.len()], vec![0.0; v.len()]);
            let mut equations = Equations::new(&model, &numbering);
            let at = StepState {
                q: &q,
                v: &v,
                lambda: &[],
                mu: &[],
                qdot: &qdot,
                vdot: &vdot,
                time: 0.0,
            };
            let mut matrix = SparseMatrix::new(equations.pattern(&at));
            matrix.assemble(|emit| equations.jacobian(&at, 1e-3, 2.0 / 3.0, emit));
            matrix
        };
        let lagged = matrix(5e-3);
        let mut factors = SparseLu::new(&lagged.pattern);
        factors.factorise(&lagged).expect("regular");
        let start = Instant::now();
        factors.factorise(&lagged).expect("regular");
        let factorising = start.elapsed().as_secs_f64();
        let b = Numbers(3).list(lagged.pattern.order());
        let start = Instant::now();
        let mut x = b.clone();
        factors.solve(&mut x);
        let solving = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let image = lagged.multiply(&x);
        let product = start.elapsed().as_secs_f64();
        let off: f64 = image.iter().zip(&b).map(|(x, b)| (x - b).powi(2)).sum();
        assert!(off.sqrt() < 1e-6 * dot(&b, &b).sqrt());
        let counts = [6e-3, 1e-2, 2e-2].map(|deflection| {
            let now = matrix(deflection);
            [1e-2, 1e-6].map(|tolerance| iterations(&now, &mut factors, &b, tolerance))
        });
        println!(
            "{along:4} x {:2} {:8} {factorising:10.4} {solving:9.5} {product:10.5}  {counts:?}",
            along / 4,
            lagged.pattern.order()
        );
    }
}
