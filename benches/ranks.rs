//! One iteration of flexible scenes, two values and gradients, by 1, 2 and 4 ranks that compute every motion together, beside
//! threads.
//!
//! `cargo bench --features mpi --bench ranks` prints wall times of simulation and gradient, of two runs the faster, and
//! checks that all optima are the same to the byte. It needs `mpirun`.

use serde_json::{Map, Value, json};
use std::path::Path;
use std::process::Command;
use std::time::Instant;

/// A chain of plates, hinged to the ground and to each other, that starts level with a speed.
fn chain(plates: usize, elements: [usize; 2], steps: usize) -> Value {
    let (mut bodies, mut joints) = (Map::new(), Map::new());
    for k in 0..plates {
        let name = format!("plate {k}");
        let (put, at, before) = match k {
            0 => ("root", json!([0, 0, 0]), "ground".to_owned()),
            _ => {
                let before = format!("plate {}", k - 1);
                ("root", json!(format!("{before}.tip")), before)
            }
        };
        let body = json!({
            "elements": {
                "structure": {
                    "mesh": {"plate": {"length": 1, "width": 0.25, "elements": elements}},
                    "material": "aluminium",
                    "thickness": 0.004,
                    "sets": {"start": {"node": {"at": [0, 0.5]}}, "end": {"node": {"at": [1, 0.5]}}}
                },
                "frame": {"chord": ["start", "end", "x0y0"]},
                "points": {"root": {"edge": "x0"}, "tip": {"edge": "x1"}}
            },
            "place": {"put": put, "at": at, "turn": {"axis": [1, 0, 0], "degrees": 90}}
        });
        bodies.insert(name.clone(), body);
        let hinge = json!({"revolute": {
            "between": [name, before], "at": format!("plate {k}.root"), "axis": [0, 0, 1]
        }});
        joints.insert(format!("hinge {k}"), hinge);
    }
    let last = format!("plate {}", plates - 1);
    json!({
        "version": 1, "name": "chain", "bodies": bodies, "joints": joints,
        "materials": {"aluminium": {"young": 70e9, "poisson": 0.3, "density": 2700}},
        // So short steps that gradients are resolved.
        "simulation": {"duration": 1.25e-5 * steps as f64, "steps": steps, "method": {"bdf": {"order": 2}}},
        "functions": {
            "height": {"final": {"position": {"body": last, "point": "tip", "direction": [0, 1, 0]}}}
        },
        "variables": {
            "thickness": {"path": "/bodies/plate 0/elements/structure/thickness", "lower": 0.001, "upper": 0.01}
        },
        "objective": {"maximise": "height"},
        "optimiser": {"iterations": 1}
    })
}

/// Seconds of a run by so many ranks and threads, as the evaluation log has them, and its record.
fn run(at: &Path, ranks: usize, threads: usize) -> (f64, Vec<u8>) {
    let output = at.join(format!("over_{ranks}_{threads}"));
    let program = env!("CARGO_BIN_EXE_optimize-mpi");
    let mut command = match ranks {
        1 => Command::new(program),
        _ => {
            let mut command = Command::new("mpirun");
            command.args(["--oversubscribe", "--bind-to", "none", "-n"]);
            command.args([&ranks.to_string(), program]);
            command
        }
    };
    command
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("RAYON_NUM_THREADS", threads.to_string())
        .current_dir(at)
        .args([
            "chain.json",
            "--share-bodies",
            "--no-certificate",
            "--output",
        ])
        .arg(&output);
    let begun = Instant::now();
    let done = command.output().expect("mpirun runs");
    let whole = begun.elapsed().as_secs_f64();
    let said =
        String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    let own = said.split("simulations and gradients ").nth(1);
    let own = own.and_then(|rest| rest.split(' ').next()?.parse().ok());
    let record = std::fs::read(output.join("optimum.json")).unwrap_or_default();
    (own.unwrap_or(whole), record)
}

fn main() {
    let at = tempfile::tempdir().expect("a directory");
    println!("scene | 1 rank | 1 rank, 2 threads | 2 ranks | 4 ranks");
    let scenes = [
        ("2 plates of 16 x 4", chain(2, [16, 4], 40)),
        ("2 plates of 32 x 8", chain(2, [32, 8], 20)),
        ("2 plates of 64 x 16", chain(2, [64, 16], 8)),
        ("4 plates of 32 x 8", chain(4, [32, 8], 20)),
        ("32 plates of 8 x 4", chain(32, [8, 4], 10)),
    ];
    for (name, scene) in scenes {
        std::fs::write(at.path().join("chain.json"), scene.to_string()).expect("is written");
        let mut row = vec![name.to_owned()];
        let mut records = Vec::new();
        for (ranks, threads) in [(1, 1), (1, 2), (2, 1), (4, 1)] {
            let mut fastest = f64::INFINITY;
            for _ in 0..2 {
                let (seconds, record) = run(at.path(), ranks, threads);
                fastest = fastest.min(seconds);
                records.push(record);
            }
            row.push(format!("{fastest:.2} s"));
        }
        let same = !records[0].is_empty() && records.iter().all(|own| *own == records[0]);
        println!(
            "{}{}",
            row.join(" | "),
            if same { "" } else { " | NOT THE SAME" }
        );
    }
}
