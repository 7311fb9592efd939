//! What an inexact Newton step of shells would cost by FGMRES (Saad 1993) with the factors of an earlier step as
//! preconditioner, beside new factors of the same matrix.

use crate::tests::reference;

use flexbody::integrate::implicit::ggl::{Equations, StepState};
use flexbody::linalg::{SparseLu, SparseMatrix};
use flexbody::math::Vec3;
use flexbody::math::slices::{add_scaled, dot};
use flexbody::model::finite::FiniteElements;
use flexbody::model::{Form, Model};
use flexbody::structures::floating::{FrameNodes, element_mesh};
use flexbody::structures::generate::panel;
use flexbody::structures::material::Material;
use flexbody::structures::structure::Structure;
use flexbody::system::{Numbering, placement};
use reference::models::Numbers;
use std::sync::Arc;
use std::time::Instant;

/// A free plate of aluminium of 1 m × 0.25 m × 5 mm, clamped to its frame.
fn plate(along: usize) -> Model<f64> {
    let made = panel([along, along / 4], false, |x, y| {
        Vec3::new(x, 0.25 * y, 0.0)
    });
    let material = Material {
        young: 70e9,
        poisson: 0.3,
        density: 2700.0,
        yield_stress: 2e8,
    };
    let structure = Structure::uniform(made.mesh.clone(), made.nodes, 5e-3, material);
    let structure = structure.expect("a sound mesh");
    let frame = FrameNodes::Clamped(made.mesh.edge_sets["x0"].concat());
    let (mesh, _) = element_mesh(&structure, &frame).expect("has its sets");
    let count = mesh.elements.len();
    let elements = FiniteElements {
        thickness: vec![5e-3; count],
        young: vec![70e9; count],
        density: vec![2700.0; count],
        surface_mass: vec![0.0; count],
        parts: Vec::new(),
        damping: None,
        mesh: Arc::new(mesh),
    };
    let mut frame = Numbers(1).body("plate");
    (frame.mass, frame.inertia) = elements.rigid();
    let mut model = Model {
        gravity: Vec3::zeros(),
        bodies: vec![frame],
        joints: Vec::new(),
        loads: Vec::new(),
        flexible: Vec::new(),
    };
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

/// Flexible GMRES without restart: the number of iterations until the residual is `tolerance` of its start.
fn iterations(
    matrix: &SparseMatrix<f64>,
    factors: &mut SparseLu<f64>,
    b: &[f64],
    tolerance: f64,
) -> usize {
    let size = dot(b, b).sqrt();
    let mut basis = vec![b.iter().map(|x| x / size).collect::<Vec<f64>>()];
    let (mut columns, mut turns): (Vec<Vec<f64>>, Vec<(f64, f64)>) = (Vec::new(), Vec::new());
    let mut rest = size;
    for k in 1..=60 {
        let mut z = basis[k - 1].clone();
        factors.solve(&mut z);
        let mut w = matrix.multiply(&z);
        let mut column: Vec<f64> = Vec::new();
        for v in &basis {
            let h = dot(v, &w);
            add_scaled(&mut w, -h, v);
            column.push(h);
        }
        let norm = dot(&w, &w).sqrt();
        for (i, &(c, s)) in turns.iter().enumerate() {
            let (a, b) = (column[i], column[i + 1]);
            (column[i], column[i + 1]) = (c * a + s * b, c * b - s * a);
        }
        let r = column[k - 1].hypot(norm);
        let turn = (column[k - 1] / r, norm / r);
        rest *= turn.1.abs();
        turns.push(turn);
        columns.push(column);
        if rest <= tolerance * size {
            return k;
        }
        w.iter_mut().for_each(|x| *x /= norm);
        basis.push(w);
    }
    60
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
