//! Runs of `optimize-mpi` under `mpirun`, and the problems of the tests.

#[path = "../reference/directory.rs"]
mod directory;

pub use directory::files;
use serde_json::{Value, json};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

pub const TREBUCHET: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/trebuchet.json");
const CRANE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/problems/crane.json");
const PLATES: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/problems/flexible/double_plate_mass.json"
);
const RELEASE_ANGLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/problems/trebuchet_release_angle.json"
);

/// Result of a run.
#[derive(Debug)]
pub struct Ran {
    pub code: i32,
    pub out: String,
    pub err: String,
}

/// `mpirun` of so many ranks, each with one thread. It is killed if it does not end in two minutes.
pub fn mpirun(ranks: usize) -> Command {
    let mut command = Command::new("timeout");
    command
        .args(["-k", "5", "120", "mpirun", "--oversubscribe"])
        .args(["--bind-to", "none", "-n", &ranks.to_string()])
        .env("OMPI_ALLOW_RUN_AS_ROOT", "1")
        .env("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
        .env("RAYON_NUM_THREADS", "1");
    command
}

/// Runs `optimize-mpi` over so many ranks.
pub fn over(ranks: usize, at: &Path, arguments: &[&str]) -> Ran {
    let mut command = mpirun(ranks);
    command.arg(env!("CARGO_BIN_EXE_optimize-mpi"));
    ended(command.args(arguments).current_dir(at))
}

/// Runs `optimize`.
pub fn alone(at: &Path, arguments: &[&str]) -> Ran {
    let mut command = Command::new(env!("CARGO_BIN_EXE_optimize"));
    ended(command.args(arguments).current_dir(at))
}

pub fn ended(command: &mut Command) -> Ran {
    let done = command.output().expect("the program runs");
    Ran {
        code: done.status.code().expect("ended by itself"),
        out: String::from_utf8_lossy(&done.stdout).into_owned(),
        err: String::from_utf8_lossy(&done.stderr).into_owned(),
    }
}

/// Starts `optimize-mpi` over so many ranks.
pub fn start(ranks: usize, at: &Path, arguments: &[&str]) -> Child {
    let mut command = mpirun(ranks);
    command.arg(env!("CARGO_BIN_EXE_optimize-mpi"));
    command.args(arguments).current_dir(at);
    let quiet = command.stdout(Stdio::null()).stderr(Stdio::null());
    quiet.spawn().expect("the program runs")
}

/// Processes of `optimize-mpi` that write into this directory. Another test may have one of the same name elsewhere.
pub fn processes(directory: &Path) -> Vec<u32> {
    let name = directory.file_name().expect("a name").as_encoded_bytes();
    let at = directory.parent().expect("a directory").canonicalize();
    let at = at.expect("is there");
    let entries = std::fs::read_dir("/proc").expect("Linux");
    let number = |name: &str| name.parse::<u32>().ok();
    let all = entries.flatten();
    let all = all.filter_map(|entry| number(&entry.file_name().to_string_lossy()));
    let is_one = |process: &u32| {
        let line = std::fs::read(format!("/proc/{process}/cmdline")).unwrap_or_default();
        let words: Vec<&[u8]> = line.split(|byte| *byte == 0).collect();
        let program = words.first().copied().unwrap_or_default();
        let works_at = || std::fs::read_link(format!("/proc/{process}/cwd"));
        program.ends_with(b"optimize-mpi")
            && words.contains(&name)
            && works_at().is_ok_and(|own| own == at)
    };
    all.filter(is_one).collect()
}

/// Waits for the end of a run; its exit code, and how long it took.
pub fn end_of(run: &mut Child) -> (Option<i32>, Duration) {
    let since = Instant::now();
    let status = run.wait().expect("ends");
    (status.code(), since.elapsed())
}

/// Asserts that no rank of a run is left.
pub fn no_orphans(directory: &Path) {
    let since = Instant::now();
    while !processes(directory).is_empty() {
        assert!(
            since.elapsed() < Duration::from_secs(10),
            "{}: ranks are left",
            directory.display()
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Asserts that two directories have the same files, byte for byte.
pub fn same_files(a: &Path, b: &Path) {
    let (one, other) = (files(a), files(b));
    assert_eq!(
        one.keys().collect::<Vec<_>>(),
        other.keys().collect::<Vec<_>>(),
        "{} {}",
        a.display(),
        b.display()
    );
    for (name, bytes) in &one {
        assert!(*bytes == other[name], "{name} of {} differs", b.display());
    }
}

pub fn optimum(directory: &Path) -> Value {
    read(&directory.join("optimum.json"))
}

fn read(path: &Path) -> Value {
    let text = std::fs::read_to_string(path).expect("a text");
    serde_json::from_str(&text).expect("JSON")
}

fn written(at: &Path, name: &str, document: &Value) -> String {
    std::fs::write(at.join(name), document.to_string()).expect("is written");
    name.to_owned()
}

/// The crane at rest in twelve positions.
pub fn crane_of_twelve(at: &Path) -> String {
    let mut document = read(Path::new(CRANE));
    let case = |k: i32| {
        let set = json!({
            "/bodies/jib/place/turn/degrees": 15 + 5 * k,
            "/loads/payload/force/magnitude": 10000 + 200 * k * k
        });
        (format!("position {k}"), json!({"set": set}))
    };
    let cases: serde_json::Map<String, Value> = (0..12).map(case).collect();
    document["cases"] = cases.into();
    written(at, "crane.json", &document)
}

/// Two plates of so many elements each, whose mass is optimised for a while in coarse steps.
pub fn two_plates(at: &Path, elements: [usize; 2], iterations: usize) -> String {
    let mut document = read(Path::new(PLATES));
    for body in ["first", "second"] {
        document["bodies"][body]["elements"]["structure"]["mesh"]["plate"]["elements"] =
            json!(elements);
    }
    document["simulation"]["duration"] = json!(0.05);
    document["simulation"]["steps"] = json!(12);
    document["optimiser"] = json!({"iterations": iterations});
    written(at, "plates.json", &document)
}

/// A rigid trebuchet that ends at an event, with five gravities, in steps that are chosen by a tolerance.
pub fn trebuchet_of_five(at: &Path) -> String {
    let mut document = read(Path::new(RELEASE_ANGLE));
    let case = |k: i32| {
        let gravity = -9.81 + 0.1 * f64::from(k);
        (
            format!("gravity {k}"),
            json!({"set": {"/gravity/1": gravity}}),
        )
    };
    let cases: serde_json::Map<String, Value> = (0..5).map(case).collect();
    document["gravity"] = json!([0, -9.81, 0]);
    document["cases"] = cases.into();
    document["functions"]["worst range"] =
        json!({"over_cases": {"function": "range", "by": "mean"}});
    document["objective"] = json!({"maximise": "worst range"});
    document["optimiser"] = json!({"iterations": 12});
    written(at, "trebuchets.json", &document)
}
