//! The Krylov solver of steps of finite elements gives the answers of the direct one.

use crate::reference::documents::plates;
use crate::reference::documents::problem as parsed;
use crate::reference::gradients::{scaled_gradients_are_exact, thick_and_soft};
use flexbody::Analysis;
use flexbody_mathematics::math::{Vec3, rotation};
use flexbody_mechanics::adjoint::gradients;
use flexbody_mechanics::integrate::{
    LinearSolver, MEMORY, Method, Settings, Start, StepSolver, WorkCounts, simulate,
};
use serde_json::Value;
use std::f64::consts::FRAC_PI_2;

/// The same file with the Krylov solver.
fn by_krylov(file: &Value) -> Value {
    let mut file = file.clone();
    file["simulation"]["linear_solver"] = json!("krylov");
    file
}

/// Values of all functions, gradients if asked, and the work of both.
fn found(file: &Value, with_gradients: bool) -> (Vec<f64>, Vec<Vec<f64>>, [WorkCounts; 2]) {
    let problem = parsed(file);
    let at = Analysis::new(&problem).at(&problem.start());
    let at = at.unwrap_or_else(|failure| panic!("{failure}"));
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let (rows, work) = match with_gradients {
        true => at
            .gradients_and_work(&which)
            .unwrap_or_else(|failure| panic!("{failure}")),
        false => (Vec::new(), WorkCounts::default()),
    };
    (at.values(), rows, [at.work(), work])
}

fn bdf(order: usize) -> Value {
    json!({"bdf": {"order": order}})
}

fn methods() -> [Value; 3] {
    [
        bdf(2),
        json!({"bdf": {"order": 3, "start": "rising_order"}}),
        json!({"generalised_alpha": {"radius": 0.8}}),
    ]
}

/// The double plate, turned as one, in units of 1 / `length` metres and 1 / `mass` kilograms. It is seen at the
/// hinge and at its tip.
fn seen_from(turn: &[f64; 4], [length, mass]: [f64; 2], method: &Value) -> Value {
    let mut file = plates([4, 1], 0.04, 40, method);
    let matrix = rotation::matrix(turn);
    let turned = |x: f64, y: f64, z: f64| json!((matrix * Vec3::new(x, y, z)).as_slice());
    file["gravity"] = turned(0.0, -9.81 * length, 0.0);
    for (name, speed) in [("first", 0.0), ("second", 8.0)] {
        let body = &mut file["bodies"][name];
        let mesh = &mut body["elements"]["structure"];
        mesh["mesh"]["plate"]["length"] = json!(length);
        mesh["mesh"]["plate"]["width"] = json!(0.25 * length);
        mesh["thickness"] = json!(0.005 * length);
        body["place"]["turn"] = json!([
            {"axis": [1, 0, 0], "angle": FRAC_PI_2},
            {"axis": turn[1..], "angle": 2.0 * turn[0].acos()}
        ]);
        body["velocity"] = json!({
            "linear": turned(0.0, speed * length, 0.0),
            "angular": turned(0.0, 0.0, 8.0)
        });
    }
    let material = &mut file["materials"]["aluminium"];
    material["young"] = json!(70e9 * mass / length);
    material["density"] = json!(2700.0 * mass / length.powi(3));
    for joint in ["root", "hinge"] {
        file["joints"][joint]["revolute"]["axis"] = turned(0.0, 0.0, 1.0);
    }
    let position = |body: &str, point: &str, x: f64| {
        let direction = turned(x, 1.0 - x, 0.0);
        json!({"final": {"position": {"body": body, "point": point, "direction": direction}}})
    };
    file["functions"] = json!({
        "hinge x": position("first", "hinge", 1.0),
        "hinge y": position("first", "hinge", 0.0),
        "tip x": position("second", "tip", 1.0),
        "tip y": position("second", "tip", 0.0),
    });
    file.as_object_mut().expect("an object").remove("variables");
    file
}

/// Turned scenes and other units: the answers of the direct solver, and similar work in all of them.
#[test]
fn answers_are_those_of_the_direct_solver() {
    let turns = [
        [0.6, 0.0, 0.0, 0.8],
        [0.8, 0.36, -0.48, 0.0],
        [0.1, 0.7, 0.5, 0.5],
    ];
    for method in methods() {
        let mut products = Vec::new();
        for (turn, units) in [
            (&turns[0], [1.0, 1.0]),
            (&turns[1], [1.0, 1.0]),
            (&turns[2], [1e3, 1e-3]),
            (&turns[0], [1e-3, 1e3]),
        ] {
            let file = seen_from(turn, units, &method);
            let (direct, _, [of_direct, _]) = found(&file, false);
            let (krylov, _, [work, _]) = found(&by_krylov(&file), false);
            for (a, b) in direct.iter().zip(&krylov) {
                let off = (a - b).abs() / units[0];
                assert!(off < 1e-11, "{method} {units:?}: {direct:?} {krylov:?}");
            }
            assert_eq!(of_direct.products, 0);
            assert!(2 * work.factorisations < work.steps, "{work:?}");
            let iterations = [of_direct, work].map(|work| work.newton_iterations);
            assert!(4 * iterations[1] < 3 * iterations[0], "{iterations:?}");
            products.push(work.products);
        }
        let [least, most] = [products.iter().min(), products.iter().max()];
        let (least, most) = (*least.expect("some"), *most.expect("some"));
        // The round-off at which iterations end depends a little on the unit of length: it takes the largest
        // coordinate of nodes, of which some are angles.
        assert!(
            least > 0 && 10 * most <= 16 * least,
            "{method} {products:?}"
        );
    }
}

/// Gradients are those of the complex step, by kept factors of later steps.
#[test]
fn gradients_are_exact() {
    for method in methods() {
        let mut file = plates([2, 1], 0.02, 12, &method);
        thick_and_soft(&mut file);
        let krylov = by_krylov(&file);
        let problem = parsed(&krylov);
        scaled_gradients_are_exact(&problem, &problem.start(), &method);
        let scales: Vec<f64> = problem.variables.iter().map(|v| v.scale).collect();
        let (_, direct, [_, work]) = found(&file, true);
        let (_, gradients, [_, of_krylov]) = found(&krylov, true);
        assert!(
            work.products == 0 && of_krylov.products > 0,
            "{of_krylov:?}"
        );
        assert!(
            of_krylov.factorisations < work.factorisations,
            "{of_krylov:?}"
        );
        for (a, b) in direct.iter().zip(&gradients) {
            let parts = || a.iter().zip(b).zip(&scales);
            let size = parts().fold(0.0_f64, |size, ((a, _), s)| size.hypot(a * s));
            let off = parts().fold(0.0_f64, |off, ((a, b), s)| off.max(((a - b) * s).abs()));
            assert!(off <= 1e-11 * size, "{method}: {a:?} {b:?}");
        }
    }
}

/// Plates at rest, which a drive sets in motion: the round-off at rest does not end iterations of the motion.
#[test]
fn a_drive_that_starts_late_moves_plates_as_with_the_krylov_solver() {
    for gravity in [9.81, 1e-6] {
        let mut file = plates([4, 1], 0.03, 30, &bdf(2));
        file["gravity"] = json!([gravity, 0, 0]);
        for body in ["first", "second"] {
            file["bodies"][body]["velocity"] = json!({"linear": [0, 0, 0], "angular": [0, 0, 0]});
        }
        file.as_object_mut().expect("an object").remove("variables");
        let turn = json!({"table": {"times": [0, 0.02, 0.04], "values": [0, 0, 0.1]}});
        file["drives"] = json!({"motor": {"joint": "root", "turn": turn}});
        let (direct, _, _) = found(&file, false);
        let (krylov, _, _) = found(&by_krylov(&file), false);
        let off = direct.iter().zip(&krylov).map(|(a, b)| (a - b).abs());
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-11, "{gravity}: {off} {direct:?} {krylov:?}");
    }
}

/// Steps that a gradient repeats because memory is limited are the same to the last bit. Iterations of thin plates
/// end by the round-off of earlier steps, which a checkpoint has, too.
#[test]
fn checkpoints_give_the_same_bits() {
    for (solver, thick) in [
        (LinearSolver::Krylov, true),
        (LinearSolver::Direct, true),
        (LinearSolver::Direct, false),
    ] {
        checkpoints_give_the_same_bits_by(solver, thick);
    }
}

fn checkpoints_give_the_same_bits_by(solver: LinearSolver, thick: bool) {
    let mut file = plates([4, 1], 0.06, 60, &bdf(2));
    if thick {
        thick_and_soft(&mut file);
    }
    let problem = parsed(&file);
    let scene = problem.scene::<f64>(&problem.start());
    let method = Method::Bdf {
        order: 2,
        start: Start::Radau,
    };
    let of = |memory: usize| {
        let settings = Settings {
            solver: StepSolver {
                linear: solver,
                ..StepSolver::default()
            },
            memory,
            ..Settings::steps(method, 60)
        };
        let run = simulate(&scene.model, scene.duration, &settings).expect("runs");
        let which: Vec<usize> = (0..scene.functions.len()).collect();
        let adjoint = gradients(&scene, &run, &which).expect("differentiates");
        let all = adjoint
            .gradients
            .iter()
            .flat_map(|found| found.parameters());
        let bits: Vec<u64> = all.map(f64::to_bits).collect();
        (bits, adjoint.counts.recomputed)
    };
    let (whole, none) = of(MEMORY);
    let mut all = 0;
    for memory in [1, 500_000, 1_000_000] {
        let (again, recomputed) = of(memory);
        assert!(whole == again, "{solver:?}, thick: {thick}, {memory}");
        all += recomputed;
    }
    assert!(none == 0 && all > 60, "{none} {all}");
}
