//! Cost of structures: assembly, factorisation and solution on plates of growing size, on one thread and on
//! all, and the largest memory of the process.
//!
//! `cargo bench --bench structures`. Each time is the best of several.

use std::time::Instant;

use flexbody::structures::generate::{Generated, plate};
use flexbody::structures::loads::Load;
use flexbody::structures::material::Material;
use flexbody::structures::mesh::Mesh;
use flexbody::structures::modes::ModalProblem;
use flexbody::structures::statics::StaticProblem;
use flexbody::structures::structure::Structure;
use flexbody::structures::supports::{NodeUnknowns, Support};

const MATERIAL: Material<f64> = Material {
    young: 70e9,
    poisson: 0.3,
    density: 2700.0,
    yield_stress: 270e6,
};

/// Plates beside each other that do not touch, each clamped at x0.
fn plates(copies: usize, elements: [usize; 2]) -> Structure<f64> {
    let Generated { mesh: one, nodes } = plate([1.0, 1.0], elements);
    let (mut mesh, mut places) = (Mesh::default(), Vec::new());
    for copy in 0..copies {
        let first = places.len();
        places.extend(nodes.iter().map(|x| x.add_scalar(2.0 * copy as f64)));
        let shells = one.shells.iter();
        mesh.shells
            .extend(shells.map(|shell| shell.map(|node| node + first)));
        let edge = one.node_sets["x0"].iter().map(|node| node + first);
        mesh.node_sets.entry("x0".into()).or_default().extend(edge);
    }
    mesh.nodes = places.len();
    mesh.face_sets
        .insert("all".into(), (0..mesh.shells.len()).collect());
    Structure::uniform(mesh, places, 0.01, MATERIAL).expect("sound")
}

/// Best time of several \[s\].
fn best(times: usize, mut f: impl FnMut()) -> f64 {
    let one = |_| {
        let start = Instant::now();
        f();
        start.elapsed().as_secs_f64()
    };
    (0..times).map(one).fold(f64::INFINITY, f64::min)
}

/// Largest resident memory of the process so far [MB], where the system tells.
fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM"))?;
    let kilobytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kilobytes / 1024.0)
}

fn measure(name: &str, copies: usize, elements: [usize; 2], threads: usize) {
    let structure = plates(copies, elements);
    let supports = [Support::clamp("x0")];
    let start = Instant::now();
    let mut problem =
        StaticProblem::new(&structure, &supports, NodeUnknowns::Six).expect("known sets");
    let analysis = start.elapsed().as_secs_f64();
    let times = if structure.thickness.len() > 1000 {
        3
    } else {
        20
    };
    let assembly = best(times, || problem.assemble(&structure));
    let factorisation = best(times, || {
        problem.factorise_assembled(&structure).expect("supported")
    });
    let mut right = vec![1.0; problem.unknowns()];
    let solve = best(times, || problem.solve_once(&mut right));
    let case = [Load::Pressure {
        faces: "all".into(),
        pressure: 1e4,
    }];
    let case_time = best(2, || {
        problem.solve_linear(&structure, &case).expect("known sets");
    });
    println!(
        "{name:<12} {threads:>2} {:>7} {:>8} {:>10} {:>9.2} {:>9.2} {:>9.2} {:>9.3} {:>9.2} {:>8.0}",
        structure.thickness.len(),
        problem.unknowns(),
        problem.factor_entries(),
        1e3 * analysis,
        1e3 * assembly,
        1e3 * factorisation,
        1e3 * solve,
        1e3 * case_time,
        peak_memory().unwrap_or(f64::NAN),
    );
}

fn main() {
    println!("times in ms; memory is the largest of the process so far, in MB");
    println!(
        "{:<12} {:>2} {:>7} {:>8} {:>10} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}",
        "plates",
        "th",
        "shells",
        "unknowns",
        "factor",
        "analysis",
        "assembly",
        "factorise",
        "solve",
        "case",
        "memory"
    );
    let mut counts = vec![1, rayon::current_num_threads()];
    counts.dedup();
    for threads in counts {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().expect("threads");
        pool.install(|| {
            measure("2 x 16 x 4", 2, [16, 4], threads);
            for n in [16, 32, 64] {
                measure(&format!("{n} x {n}"), 1, [n, n], threads);
            }
        });
    }
    // 6 unknowns at (2n + 1)² nodes less a clamped edge.
    measure("64 x 64", 1, [64, 64], rayon::current_num_threads());
    let structure = plates(1, [64, 64]);
    let mut problem = ModalProblem::new(&structure, &[Support::clamp("x0")], NodeUnknowns::Six)
        .expect("known sets");
    let start = Instant::now();
    let modes = problem.solve(&structure, 10).expect("modes");
    println!(
        "10 modes of 64 x 64: {:.2} s, {:?}",
        start.elapsed().as_secs_f64(),
        modes.work
    );
}
