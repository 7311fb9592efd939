//! The linear obstacle course of shells (MacNeal & Harder 1985; Belytschko et al. 1985): one
//! symmetric part each, n × n elements, six unknowns per node. Expected values are those of an
//! independent prototype of the same element, to the given digits.

use flexbody::math::Vec3;
use flexbody::structures::generate::{Generated, curved_panel, panel};
use flexbody::structures::loads::Load;
use flexbody::structures::material::Material;
use flexbody::structures::statics::StaticProblem;
use flexbody::structures::structure::Structure;
use flexbody::structures::supports::{NodeUnknowns, Support};

const NONE: [bool; 3] = [false; 3];

fn material(young: f64, poisson: f64) -> Material<f64> {
    Material {
        young,
        poisson,
        density: 1.0,
        yield_stress: 1.0,
    }
}

/// Mirror plane across an axis: no displacement along it, no rotation about the other axes.
fn mirror(nodes: &str, axis: usize) -> Support {
    let across = [0, 1, 2].map(|k| k == axis);
    Support::of(nodes, across, across.map(|x| !x))
}

/// Displacement of the node of a corner.
fn displacement(
    generated: Generated<f64>,
    thickness: f64,
    material: Material<f64>,
    supports: &[Support],
    load: Load<f64>,
    corner: &str,
) -> Vec3<f64> {
    let node = generated.mesh.node_set(corner).expect("a corner")[0];
    let Generated { mesh, nodes } = generated;
    let structure = Structure::uniform(mesh, nodes, thickness, material).expect("a sound mesh");
    let mut problem =
        StaticProblem::new(&structure, supports, NodeUnknowns::Six).expect("known sets");
    problem.factorise(&structure).expect("supported");
    let x = problem
        .solve_linear(&structure, &[load])
        .expect("known sets");
    problem.motion(&structure, &x).displacement[node]
}

/// Scordelis–Lo roof: a quarter, from the crown (angle 90°) down to the free edge.
fn scordelis_lo(n: usize) -> f64 {
    let angle = |degrees: f64| degrees.to_radians();
    let roof = curved_panel(25.0, 25.0, [angle(90.0), angle(50.0)], [n, n]);
    let weight = Load::Area {
        faces: "all".into(),
        force: Vec3::new(0.0, -90.0, 0.0),
    };
    let supports = [
        mirror("x0", 0),
        mirror("y0", 2),
        Support::of("y1", [true, true, false], NONE),
    ];
    let down = displacement(roof, 0.25, material(4.32e8, 0.0), &supports, weight, "x1y0");
    -down.y / 0.3024
}

/// Pinched cylinder with diaphragms: an eighth.
fn pinched_cylinder(n: usize) -> f64 {
    let part = curved_panel(300.0, 300.0, [0.0, std::f64::consts::FRAC_PI_2], [n, n]);
    let load = Load::Point {
        nodes: "x0y0".into(),
        force: Vec3::new(-0.25, 0.0, 0.0),
        moment: Vec3::zeros(),
    };
    let supports = [
        mirror("x0", 1),
        mirror("x1", 0),
        mirror("y0", 2),
        Support::of("y1", [true, true, false], NONE),
    ];
    let moved = displacement(part, 3.0, material(3e6, 0.3), &supports, load, "x0y0");
    -moved.x / 1.8248e-5
}

/// Pinched hemisphere with a hole of 18°: a quarter.
fn hemisphere(n: usize) -> f64 {
    let quarter = std::f64::consts::FRAC_PI_2;
    // From the equator up to 72°.
    let mut part = panel([n, n], false, |x, y| {
        let ((sp, cp), (st, ct)) = ((x * quarter).sin_cos(), (y * 0.8 * quarter).sin_cos());
        Vec3::new(ct * cp, ct * sp, st) * 10.0
    });
    // One point keeps its height. The loads act at both ends of the equator.
    let corner = part.mesh.node_sets["x0y0"].clone();
    let other = part.mesh.node_sets["x1y0"].clone();
    part.mesh.node_sets.insert("pull".into(), corner.clone());
    part.mesh.node_sets.insert("height".into(), corner);
    let node = other[0];
    let Generated { mesh, nodes } = part;
    let structure =
        Structure::uniform(mesh, nodes, 0.04, material(6.825e7, 0.3)).expect("a sound mesh");
    let supports = [
        mirror("x0", 1),
        mirror("x1", 0),
        Support::of("height", [false, false, true], NONE),
    ];
    let point = |nodes: &str, force| Load::Point {
        nodes: nodes.into(),
        force,
        moment: Vec3::zeros(),
    };
    let loads = [
        point("pull", Vec3::new(1.0, 0.0, 0.0)),
        point("x1y0", Vec3::new(0.0, -1.0, 0.0)),
    ];
    let mut problem =
        StaticProblem::new(&structure, &supports, NodeUnknowns::Six).expect("known sets");
    problem.factorise(&structure).expect("supported");
    let x = problem
        .solve_linear(&structure, &loads)
        .expect("known sets");
    -problem.motion(&structure, &x).displacement[node].y / 0.0940
}

fn assert_series(name: &str, f: fn(usize) -> f64, expected: [f64; 3]) {
    let found = [4, 8, 16].map(f);
    println!("{name}: {found:.5?}");
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            (found - expected).abs() <= 1.5e-5,
            "{name}: {found:.6}, {expected} expected"
        );
    }
}

#[test]
fn the_scordelis_lo_roof_sinks_as_expected() {
    assert_series("Scordelis-Lo", scordelis_lo, [0.99255, 0.99518, 0.99631]);
}

#[test]
fn the_pinched_cylinder_gives_way_as_expected() {
    assert_series("cylinder", pinched_cylinder, [0.96452, 1.00040, 1.01013]);
}

#[test]
fn the_pinched_hemisphere_opens_as_expected() {
    assert_series("hemisphere", hemisphere, [0.98465, 0.99006, 0.99447]);
}
