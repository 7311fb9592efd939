//! All ranks end together, soon, with the right exit code, and what was done is kept.

use crate::program::{
    TREBUCHET, alone, end_of, ended, files, mpirun, no_orphans, optimum, over, processes, start,
    two_plates,
};
use flexbody::mpi::Session;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// All ranks must have ended so long after one. Ranks that hang would go on for two minutes. It is 1 to 2 s where no other
/// test takes the cores, and has been 7 s beside the others on two cores.
const SOON: Duration = Duration::from_secs(20);

fn send(signal: &str, process: u32) {
    // The process may have ended by itself.
    let sent = Command::new("kill")
        .args([signal, &process.to_string()])
        .output();
    sent.expect("kill runs");
}

/// The ranks of a run, once all have started.
fn ranks_of(directory: &Path, count: usize) -> Vec<u32> {
    let since = Instant::now();
    loop {
        let found = processes(directory);
        if found.len() == count || since.elapsed() > Duration::from_secs(20) {
            return found;
        }
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Moments at which a rank is killed; more by the variable `FLEXBODY_KILLS`.
const KILLS: u32 = 6;

/// Kills a rank at moments spread over the run. All end within seconds, and a run over another number of ranks
/// goes on to the same optimum without repeating what the logs have.
#[test]
fn a_killed_rank_ends_all_and_the_run_resumes() {
    let at = tempfile::tempdir().expect("a directory");
    let arguments = [
        TREBUCHET,
        "--starts",
        "6",
        "--no-certificate",
        "--set",
        "/optimiser={\"iterations\": 15}",
    ];
    let with = |how: &[&'static str]| [&arguments[..], how].concat();
    let whole = over(3, at.path(), &with(&["--output", "whole"]));
    let all = logged(&at.path().join("whole"));
    assert!(all > 100, "{all} evaluations");
    let expected = optimum(&at.path().join("whole"));
    let mut in_the_midst = 0;
    let kills = std::env::var("FLEXBODY_KILLS").ok();
    let kills = kills.and_then(|n| n.parse().ok()).unwrap_or(KILLS);
    for k in 0..kills {
        let output = format!("killed_{k}");
        let words = [&arguments[..], &["--output", &output]].concat();
        let mut run = start(3, at.path(), &words);
        let directory = at.path().join(&output);
        let ranks = ranks_of(&directory, 3);
        // Multiples of the golden ratio are spread without a pattern.
        let moment = (f64::from(k) * 0.618_033_988_749_895).fract();
        wait_for(&directory, (moment * all as f64) as usize);
        let killed = ranks[k as usize % 3];
        let was_running = processes(&directory).contains(&killed);
        send("-9", killed);
        let (code, time) = end_of(&mut run);
        assert!(time < SOON, "kill {k}: {time:?}");
        no_orphans(&directory);
        if was_running {
            in_the_midst += 1;
            assert!(code.is_none_or(|code| code != 0), "kill {k}: {code:?}");
        }
        let has_log = files_if_any(&directory).any(|name| name.starts_with("evaluations"));
        let how = if has_log { "--resume" } else { "--output" };
        let ranks = [2, 4, 1][k as usize % 3];
        let ran = over(
            ranks,
            at.path(),
            &[&arguments[..], &[how, &output]].concat(),
        );
        assert_eq!(ran.code, whole.code, "kill {k}: {}", ran.err);
        assert_eq!(optimum(&directory), expected, "kill {k}");
    }
    assert!(2 * in_the_midst > kills, "{in_the_midst} of {kills}");
}

/// How many evaluations the logs in a directory have. Files may go while it is read.
fn logged(directory: &Path) -> usize {
    let entries = std::fs::read_dir(directory).into_iter().flatten().flatten();
    let logs = entries.filter(|entry| {
        entry
            .file_name()
            .to_string_lossy()
            .starts_with("evaluations")
    });
    let texts = logs.filter_map(|entry| std::fs::read_to_string(entry.path()).ok());
    texts.map(|text| text.lines().count()).sum()
}

/// Waits until a run has logged so many evaluations, or has ended. Time would not do: how fast a run is depends on what else runs.
fn wait_for(directory: &Path, evaluations: usize) {
    while logged(directory) < evaluations && !processes(directory).is_empty() {
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn files_if_any(directory: &Path) -> impl Iterator<Item = String> {
    let all = match directory.is_dir() {
        true => files(directory),
        false => Default::default(),
    };
    all.into_keys()
}

/// Ctrl-C reaches `mpirun`, which ends its ranks.
#[test]
fn an_interrupt_ends_all_and_keeps_the_log() {
    let at = tempfile::tempdir().expect("a directory");
    let arguments = [TREBUCHET, "--starts", "64", "--output", "interrupted"];
    let mut run = start(2, at.path(), &arguments);
    let ranks = ranks_of(&at.path().join("interrupted"), 2);
    std::thread::sleep(Duration::from_secs(2));
    let parent = std::fs::read_to_string(format!("/proc/{}/stat", ranks[0])).expect("runs");
    let (_, rest) = parent.rsplit_once(')').expect("a name in brackets");
    let mpirun = rest
        .split_whitespace()
        .nth(1)
        .and_then(|word| word.parse().ok());
    send("-INT", mpirun.expect("a process"));
    let (code, time) = end_of(&mut run);
    assert!(time < SOON, "{time:?}");
    assert!(code.is_none_or(|code| code != 0), "{code:?}");
    no_orphans(&at.path().join("interrupted"));
    let names: Vec<String> = files_if_any(&at.path().join("interrupted")).collect();
    assert!(
        names.iter().any(|name| name.starts_with("evaluations")),
        "{names:?}"
    );
}

/// Sends a signal to the first of two ranks that run `arguments`, and to the last of two others, after `wait` with the directory
/// of the output: all end soon, and the best design is written.
fn a_signal_ends_all(at: &Path, arguments: &[&str], wait: impl Fn(&Path)) {
    for (k, signalled) in ["first", "last"].into_iter().enumerate() {
        let mut run = start(2, at, &[arguments, &["--output", signalled]].concat());
        let directory = at.join(signalled);
        let mut ranks = ranks_of(&directory, 2);
        ranks.sort_unstable();
        wait(&directory);
        send("-INT", ranks[k]);
        let (code, time) = end_of(&mut run);
        assert!(time < SOON, "{time:?}");
        assert_eq!(code, Some(130));
        no_orphans(&directory);
        assert!(directory.join("optimum.json").exists());
    }
}

#[test]
fn a_signal_to_one_rank_ends_all() {
    let at = tempfile::tempdir().expect("a directory");
    let wait = |_: &Path| std::thread::sleep(Duration::from_secs(2));
    a_signal_ends_all(at.path(), &[TREBUCHET, "--starts", "200"], wait);
}

/// The same where all ranks compute every motion together: none waits for another that has ended.
#[test]
fn a_signal_to_one_rank_ends_motions_of_all() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = two_plates(at.path(), [8, 2], 1000);
    // So many steps that the run takes much longer than three evaluations and a signal.
    let steps = ["--set", "/simulation/steps=120"];
    let arguments = [&problem, "--share-bodies", "--no-certificate"];
    let arguments = [&arguments[..], &steps].concat();
    let wait = |directory: &Path| wait_for(directory, 3);
    a_signal_ends_all(at.path(), &arguments, wait);
}

/// A rank that dies amid a motion that all compute ends all, and the run goes on in one process.
#[test]
fn a_killed_rank_ends_motions_of_all() {
    let at = tempfile::tempdir().expect("a directory");
    let problem = two_plates(at.path(), [8, 2], 4);
    let whole = alone(
        at.path(),
        &[&problem, "--no-certificate", "--output", "whole"],
    );
    for k in 0..2 {
        let output = format!("killed_{k}");
        let mut run = start(
            2,
            at.path(),
            &[
                &problem,
                "--share-bodies",
                "--no-certificate",
                "--output",
                &output,
            ],
        );
        let directory = at.path().join(&output);
        let ranks = ranks_of(&directory, 2);
        wait_for(&directory, 2 + k);
        send("-9", ranks[k]);
        let (code, time) = end_of(&mut run);
        assert!(time < SOON, "{time:?}");
        assert!(code.is_none_or(|code| code != 0), "{code:?}");
        no_orphans(&directory);
        let ran = over(
            3,
            at.path(),
            &[
                &problem,
                "--share-bodies",
                "--no-certificate",
                "--resume",
                &output,
            ],
        );
        assert_eq!(ran.code, whole.code, "{}", ran.err);
        let of = |name: &str| optimum(&at.path().join(name));
        assert_eq!(of(&output), of("whole"));
    }
}

/// A fault of the input is told once, by rank 0.
#[test]
fn a_fault_of_the_input_is_told_once() {
    let at = tempfile::tempdir().expect("a directory");
    let typo = ["--set", "/bodies/stone/mas=1", "--output", "faulty"];
    let arguments = [&[TREBUCHET, "--starts", "4"], &typo[..]].concat();
    let one = alone(at.path(), &arguments);
    assert_eq!(one.code, 2, "{}", one.err);
    let ran = over(4, at.path(), &arguments);
    assert_eq!(ran.code, 2, "{}", ran.err);
    assert_eq!(
        ran.err.matches(one.err.trim_end()).count(),
        1,
        "{}",
        ran.err
    );
    assert!(!at.path().join("faulty").exists());
    no_orphans(&at.path().join("faulty"));
}

/// A log that cannot grow, as on a full disk, ends the run with exit code 4.
#[test]
fn a_full_disk_ends_all() {
    let at = tempfile::tempdir().expect("a directory");
    let mut command = mpirun(3);
    // Files of this size cannot grow. MPI must not keep its messages in files then.
    let limited = "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\"";
    command
        .env("OMPI_MCA_btl", "self,tcp")
        .args([
            "sh",
            "-c",
            limited,
            env!("CARGO_BIN_EXE_optimize-mpi"),
            TREBUCHET,
        ])
        .args(["--starts", "32", "--output", "full"])
        .current_dir(at.path());
    let since = Instant::now();
    let ran = ended(&mut command);
    assert_eq!(ran.code, 4, "{}", ran.err);
    assert!(ran.err.contains("evaluations.start_"), "{}", ran.err);
    assert!(since.elapsed() < Duration::from_secs(60));
    no_orphans(&at.path().join("full"));
}

/// One rank panics while the others wait for it: its exit code is that of all.
#[test]
fn a_panic_ends_all() {
    let mut command = mpirun(3);
    let own = std::env::current_exe().expect("a path");
    command.arg(own).args([
        "--ignored",
        "--exact",
        "ends::a_rank_that_panics",
        "--nocapture",
    ]);
    let since = Instant::now();
    let ran = ended(&mut command);
    assert_eq!(ran.code, 101, "{}", ran.err);
    assert!(ran.err.contains("rank 1 of 3 panicked"), "{}", ran.err);
    assert!(since.elapsed() < Duration::from_secs(20));
}

/// What a rank of the test above does.
#[test]
#[ignore = "a rank of another test"]
fn a_rank_that_panics() {
    let session = Session::start();
    assert!(session.rank() != 1, "as meant");
    std::thread::sleep(Duration::from_secs(60));
}
