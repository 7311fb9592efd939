//! Von Karman statics against closed forms, and loads that a structure cannot carry.

use super::sample::ALUMINIUM;
use flexbody_mathematics::math::Vec3;
use flexbody_mechanics::structures::generate::{Generated, panel, plate};
use flexbody_mechanics::structures::loads::Load;
use flexbody_mechanics::structures::statics::{Critical, StaticFailure, StaticProblem};
use flexbody_mechanics::structures::structure::Structure;
use flexbody_mechanics::structures::supports::{NodeUnknowns, Support};
use flexbody_mechanics::structures::von_karman::LoadSteps;

const NONE: [bool; 3] = [false; 3];
const LENGTH: f64 = 1.0;
const WIDTH: f64 = 0.1;

/// Cylindrical bending: a long plate between fixed edges (Timoshenko & Woinowsky-Krieger 1959, ch.
/// 1), with transverse shear. x is measured from the middle, κ = θ', S is the membrane force:
///
/// ```text
/// D (1 + S/kGh) κ'' − S κ = −q,  κ = q/S + A cosh μx,  w' = D κ'/kGh − θ,
/// S L (1 − ν²)/(E h) = ½ ∫ w'² dx
/// ```
///
/// A follows from κ = 0 (hinged) or θ = 0 (clamped) at the edge. Returns w in the middle.
fn cylindrical_bending(thickness: f64, q: f64, clamped: bool) -> f64 {
    let nu = ALUMINIUM.poisson;
    let plane = ALUMINIUM.young / (1.0 - nu * nu);
    let bending = plane * thickness.powi(3) / 12.0;
    let shear = 5.0 / 6.0 * ALUMINIUM.shear_modulus() * thickness;
    let edge = LENGTH / 2.0;
    // w' at x for a membrane force. Both factors of A are divided by cosh(μ edge).
    let slope = |s: f64, x: f64| {
        let mu = (s / (bending * (1.0 + s / shear))).sqrt();
        let (top, sinh) = ((mu * edge).cosh(), |x: f64| (mu * x).sinh());
        let a = if clamped {
            -q / s * edge * mu / sinh(edge)
        } else {
            -q / s / top
        };
        let theta = q / s * x + a * sinh(x) / mu;
        bending / shear * a * mu * sinh(x) - theta
    };
    let simpson = |f: &dyn Fn(f64) -> f64| {
        let n = 2000;
        let h = edge / f64::from(n);
        let weight = |k: i32| match k {
            0 => 1.0,
            k if k == n => 1.0,
            k => 2.0 + 2.0 * f64::from(k % 2),
        };
        (0..=n)
            .map(|k| weight(k) * f(h * f64::from(k)))
            .sum::<f64>()
            * h
            / 3.0
    };
    // ½ ∫ w'² decreases with S, the left side increases.
    let excess = |s: f64| simpson(&|x| slope(s, x).powi(2)) - s * LENGTH / (plane * thickness);
    let (mut low, mut high) = (1e-6 * bending, 1e6 * bending);
    for _ in 0..200 {
        let middle = (low * high).sqrt();
        if excess(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    // The normal points along +z, and so does the pressure.
    -simpson(&|x| slope(low, x))
}

#[test]
fn a_plate_under_pressure_deflects_as_its_closed_form() {
    let plane_strain = Support::of("all", [false, true, false], [true, false, false]);
    for thickness in [0.02, 0.004] {
        for clamped in [false, true] {
            for reduced in [2.0, 30.0, 400.0, 5000.0] {
                let q = reduced * ALUMINIUM.young * (thickness / LENGTH).powi(4);
                let Generated { mesh, nodes } = plate([LENGTH, WIDTH], [16, 1]);
                let middle = mesh.node_sets["y0"][16];
                let structure =
                    Structure::uniform(mesh, nodes, thickness, ALUMINIUM).expect("sound");
                let edge = |nodes| Support::of(nodes, [true; 3], [false, clamped, false]);
                let supports = [plane_strain.clone(), edge("x0"), edge("x1")];
                let mut problem =
                    StaticProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
                let case = [Load::Pressure {
                    faces: "all".into(),
                    pressure: q,
                }];
                let found = problem
                    .solve_von_karman(&structure, &case, &LoadSteps::default())
                    .expect("an equilibrium");
                let w = problem.motion(&structure, &found.x).displacement[middle].z;
                let expected = cylindrical_bending(thickness, q, clamped);
                println!(
                    "h {thickness}, clamped {clamped}: w/h = {:.5}, {:.1e} off, {:?}",
                    w / thickness,
                    w / expected - 1.0,
                    found.work
                );
                assert!(
                    (w / expected - 1.0).abs() < 2e-4,
                    "{w}, {expected} expected"
                );
                assert_eq!(found.work.repeated, 0, "{:?}", found.work);
                assert!(
                    found.work.tangents <= 12 * found.work.steps,
                    "{:?}",
                    found.work
                );
            }
        }
    }
}

/// A strip of `n` elements with a set of nodes for each row across, `row0` and so on, with
/// Poisson's ratio zero. Its rise is a sine.
fn strip(n: usize, rise: f64, thickness: f64) -> Structure<f64> {
    let Generated { mut mesh, nodes } = panel([n, 1], false, |x, y| {
        let z = rise * (std::f64::consts::PI * x).sin();
        Vec3::new(LENGTH * x, WIDTH * y, z)
    });
    let columns = 2 * n + 1;
    for row in 0..columns {
        for (side, line) in ["a", "b", "c"].iter().zip(0..) {
            let set = vec![row + line * columns];
            mesh.node_sets.insert(format!("row{row}{side}"), set);
        }
    }
    let mut material = ALUMINIUM;
    material.poisson = 0.0;
    Structure::uniform(mesh, nodes, thickness, material).expect("sound")
}

/// A shallow sine arch between hinges under a sine load q(x) = p sin(πx/L) downwards, a force per
/// length (Timoshenko & Gere 1961, 7.7): with b = a − w
///
/// ```text
/// p = EI (π/L)⁴ w + ¼ EA (π/L)⁴ (a² − b²) b
/// ```
///
/// Its maximum is a limit point. An arch with a > 4.69 r, r² = I/A, swings sideways before it, at
/// the bifurcation where the thrust is 4π²EI/L², that is b² = a² − 16 r².
#[test]
fn a_shallow_arch_snaps_or_swings_where_it_should() {
    let (thickness, n) = (0.01, 16);
    let pi = std::f64::consts::PI;
    for rise in [1.1, 1.25, 1.5, 1.8].map(|ratio| ratio * thickness) {
        let (area, inertia) = (WIDTH * thickness, WIDTH * thickness.powi(3) / 12.0);
        let load = |w: f64| {
            let b = rise - w;
            let axial = 0.25 * area * (rise * rise - b * b) * b;
            ALUMINIUM.young * (pi / LENGTH).powi(4) * (inertia * w + axial)
        };
        let radius = thickness / 12.0_f64.sqrt();
        let (limit, kind_expected) = if rise > 4.69 * radius {
            let b = (rise * rise - 16.0 * radius * radius).sqrt();
            (load(rise - b), Critical::Bifurcation)
        } else {
            let all = (0..10_000).map(|k| load(rise * f64::from(k) / 1e4));
            (all.fold(0.0, f64::max), Critical::LimitPoint)
        };
        let structure = strip(n, rise, thickness);
        let case = |size: f64| -> Vec<Load<f64>> {
            // Nodal loads of three-node elements, shared across by Simpson's weights.
            let mut rows = vec![0.0; 2 * n + 1];
            for element in 0..n {
                for (xi, weight) in [(-0.6_f64.sqrt(), 5.0), (0.0, 8.0), (0.6_f64.sqrt(), 5.0)] {
                    let shape = [0.5 * xi * (xi - 1.0), 1.0 - xi * xi, 0.5 * xi * (xi + 1.0)];
                    let x = (element as f64 + 0.5 * (xi + 1.0)) / n as f64;
                    for (k, shape) in shape.iter().enumerate() {
                        let share = shape * weight / 18.0 / n as f64 * LENGTH;
                        rows[2 * element + k] += size * (pi * x).sin() * share;
                    }
                }
            }
            let mut all = Vec::new();
            for (row, force) in rows.iter().enumerate() {
                for (side, share) in [("a", 1.0), ("b", 4.0), ("c", 1.0)] {
                    all.push(Load::Point {
                        nodes: format!("row{row}{side}"),
                        force: Vec3::new(0.0, 0.0, -force * share / 6.0),
                        moment: Vec3::zeros(),
                    });
                }
            }
            all
        };
        let supports = [
            Support::of("x0", [true; 3], NONE),
            Support::of("x1", [true; 3], NONE),
            Support::of("all", [false, true, false], [true, false, false]),
        ];
        let mut problem =
            StaticProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
        let failure = problem
            .solve_von_karman(&structure, &case(2.0 * limit), &LoadSteps::default())
            .err();
        println!("{failure:?}");
        let Some(StaticFailure::Critical {
            kind, factor, dof, ..
        }) = failure
        else {
            panic!("{failure:?}");
        };
        assert_eq!((kind, dof), (kind_expected, "displacement z"));
        assert!((2.0 * factor - 1.0).abs() < 0.01, "{factor}");
        // Below it the deflection is that of the formula.
        let below = 0.8 * limit;
        let found = problem
            .solve_von_karman(&structure, &case(below), &LoadSteps::default())
            .expect("an equilibrium");
        let node = structure.topology.mesh.node_sets[&format!("row{n}b")][0];
        let w = -problem.motion(&structure, &found.x).displacement[node].z;
        assert!((load(w) / below - 1.0).abs() < 0.01, "{w}");
    }
}

/// Euler's column with one end free to move along its axis: π²EI/L² is a bifurcation, because the
/// straight path does no work with the buckling mode.
#[test]
fn a_compressed_strip_buckles_at_a_bifurcation() {
    let thickness = 0.005;
    let structure = strip(8, 0.0, thickness);
    let inertia = WIDTH * thickness.powi(3) / 12.0;
    let euler = (std::f64::consts::PI / LENGTH).powi(2) * ALUMINIUM.young * inertia;
    let supports = [
        Support::of("x0", [true; 3], NONE),
        Support::of("x1", [false, true, true], NONE),
        Support::of("all", [false, true, false], [true, false, false]),
    ];
    let mut problem =
        StaticProblem::new(&structure, &supports, NodeUnknowns::Natural).expect("sets");
    for factor in [1.6, 3.0] {
        let case = [Load::Edge {
            edges: "x1".into(),
            force: Vec3::new(-factor * euler / WIDTH, 0.0, 0.0),
        }];
        let failure = problem
            .solve_von_karman(&structure, &case, &LoadSteps::default())
            .err();
        let Some(StaticFailure::Critical {
            kind,
            factor: reached,
            dof,
            node,
            ..
        }) = failure
        else {
            panic!("{failure:?}");
        };
        println!("{}", failure.expect("told"));
        assert_eq!((kind, dof), (Critical::Bifurcation, "displacement z"));
        assert!((reached * factor - 1.0).abs() < 2e-3, "{reached}");
        let place = structure.nodes[node].x;
        assert!(
            (place - LENGTH / 2.0).abs() < 0.1,
            "the middle gives way, not {place}"
        );
    }
}
