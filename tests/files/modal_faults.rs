//! Faults of bodies from files, with their places.

use super::modal::{beam, data, modal, pendulum};
use flexbody_problem::Problem;
use serde_json::Value;
use std::path::PathBuf;

/// A directory with copies of the files, in which one is changed.
fn changed(file: &str, change: impl Fn(&str) -> String) -> (tempfile::TempDir, PathBuf) {
    let directory = tempfile::tempdir().expect("a directory");
    for name in ["beam.nodes", "beam_k.mtx", "beam_m.mtx"] {
        let text = std::fs::read_to_string(data(name)).expect("a file");
        let text = if name == file { change(&text) } else { text };
        std::fs::write(directory.path().join(name), text).expect("written");
    }
    let path = directory.path().join("problem.json");
    let mut body = modal(json!({"clamped": "start"}));
    body["source"] = json!({"matrix_market": {"nodes": "beam.nodes", "stiffness": "beam_k.mtx", "mass": "beam_m.mtx"}});
    let text = serde_json::to_string_pretty(&pendulum("modal", body)).expect("text");
    std::fs::write(&path, text).expect("written");
    (directory, path)
}

/// The line of a text, replaced.
fn line(number: usize, with: &'static str) -> impl Fn(&str) -> String {
    move |text| {
        let lines = text.lines().enumerate();
        let lines = lines.map(|(k, line)| if k + 1 == number { with } else { line });
        lines.collect::<Vec<_>>().join("\n") + "\n"
    }
}

/// What each fault says: file, line, column, and words.
#[test]
fn faults_of_matrices_are_told_with_their_place() {
    type Change = Box<dyn Fn(&str) -> String>;
    let cases: Vec<(&str, Change, &str, &str)> = vec![
        (
            "beam_k.mtx",
            Box::new(line(1, "%%MatrixMarket matrix array real symmetric")),
            "1:23",
            "coordinate",
        ),
        (
            "beam_k.mtx",
            Box::new(line(
                1,
                "%%MatrixMarket matrix coordinate complex symmetric",
            )),
            "1:34",
            "real",
        ),
        (
            "beam_k.mtx",
            Box::new(line(1, "126 126 330")),
            "1:1",
            "a header as",
        ),
        (
            "beam_k.mtx",
            Box::new(line(3, "125 125 330")),
            "3:1",
            "63 or 126",
        ),
        (
            "beam_k.mtx",
            Box::new(line(3, "126 125 330")),
            "3:5",
            "a square matrix",
        ),
        (
            "beam_k.mtx",
            Box::new(line(3, "126 126")),
            "3:1",
            "numbers of rows",
        ),
        (
            "beam_k.mtx",
            Box::new(line(3, "126 126 331")),
            "333:",
            "the 331 that the file announces",
        ),
        (
            "beam_k.mtx",
            Box::new(line(3, "126 126 329")),
            "333:1",
            "the end of the file",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 1 fast")),
            "4:5",
            "a finite number",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 1 nan")),
            "4:5",
            "a finite number",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 1 1e999")),
            "4:5",
            "a finite number",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "0 1 1")),
            "4:1",
            "a row from 1 to 126",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 127 1")),
            "4:3",
            "a column from 1 to 126",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 1")),
            "4:1",
            "row, column and value",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 2 1")),
            "4:1",
            "above the diagonal",
        ),
        (
            "beam_k.mtx",
            Box::new(line(5, "1 1 1")),
            "5:1",
            "a second time",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 1 -5")),
            "json:",
            "on the diagonal of node 1, displacement along x",
        ),
        (
            "beam_k.mtx",
            Box::new(line(4, "1 1 9e8")),
            "json:",
            "resists a rigid displacement along x",
        ),
        (
            "beam_m.mtx",
            Box::new(line(4, "1 1 9")),
            "json:",
            "kg along x, y and z",
        ),
        (
            "beam.nodes",
            Box::new(line(2, "1 0 0")),
            "2:1",
            "a node: its number, x, y, z",
        ),
        (
            "beam.nodes",
            Box::new(line(2, "0 0 0 0")),
            "2:1",
            "the number of a node",
        ),
        (
            "beam.nodes",
            Box::new(line(3, "1 0 0 0")),
            "3:1",
            "each node once",
        ),
        (
            "beam.nodes",
            Box::new(line(3, "2 0.05 0 0 123")),
            "3:1",
            "those of all nodes",
        ),
        (
            "beam.nodes",
            Box::new(line(2, "1 0 0 0 127")),
            "2:9",
            "digits from 1 to 6",
        ),
        (
            "beam.nodes",
            Box::new(line(2, "99 0 0 0")),
            "json:",
            "node 1",
        ),
        (
            "beam.nodes",
            Box::new(|_: &str| "# none\n".into()),
            "1:1",
            "no node",
        ),
        (
            "beam.nodes",
            Box::new(line(2, "1 0 0.5 0")),
            "json:",
            "resists a rigid rotation",
        ),
        (
            "beam_m.mtx",
            Box::new(|_: &str| String::new()),
            ":",
            "a header as",
        ),
    ];
    for (file, change, place, words) in cases {
        let (_directory, path) = changed(file, change);
        let faults = Problem::load(&path, &[]).expect_err(words);
        let text = faults.to_string();
        let named = match place {
            "json:" => "problem.json:".to_owned(),
            place => format!("{file}:{place}").replace("::", ":"),
        };
        assert!(text.contains(words), "{words:?} is missing in {text}");
        assert!(
            text.contains(named.trim_end_matches(':')),
            "{named:?} is missing in {text}"
        );
    }
    let (_directory, path) = changed("", str::to_owned);
    Problem::load(&path, &[]).expect("no fault");
    std::fs::remove_file(path.with_file_name("beam_m.mtx")).expect("removed");
    let text = Problem::load(&path, &[]).expect_err("no file").to_string();
    assert!(
        text.contains("no file") && text.contains("/source/matrix_market/mass"),
        "{text}"
    );
    std::fs::write(path.with_file_name("beam_m.mtx"), [b'%', 0xff]).expect("written");
    let text = Problem::load(&path, &[]).expect_err("no text").to_string();
    assert!(
        text.contains("beam_m.mtx:1:2") && text.contains("UTF-8"),
        "{text}"
    );
}

/// An entry beside the diagonal of the mass matrix that is too large: some motion has a negative mass. The fault names
/// the file, for couplings of axial, transverse and rotational unknowns.
#[test]
fn a_mass_matrix_that_is_not_positive_is_a_fault_of_its_file() {
    let text = std::fs::read_to_string(data("beam_m.mtx")).expect("a file");
    let beside: Vec<usize> = (text.lines().enumerate().skip(3))
        .filter(|(_, line)| {
            let mut words = line.split_whitespace();
            let [i, j, value] = [0; 3].map(|_| words.next().expect("an entry"));
            i != j && value.parse() != Ok(0.0)
        })
        .map(|(number, _)| number)
        .collect();
    let mut indefinite = 0;
    for k in [0, 1, 2, 3, 5, 8, 13, beside.len() - 1] {
        let change = |text: &str| {
            let lines = text.lines().enumerate().map(|(number, line)| {
                let mut words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
                if number == beside[k] {
                    let value: f64 = words[2].parse().expect("a number");
                    words[2] = format!("{:e}", 50.0 * value);
                }
                words.join(" ") + "\n"
            });
            lines.collect()
        };
        let (_directory, path) = changed("beam_m.mtx", change);
        // Small couplings leave the mass positive.
        let Err(told) = Problem::load(&path, &[]).map_err(|faults| faults.to_string()) else {
            continue;
        };
        // Some entries change the mass of the whole body first.
        let is_indefinite = told.contains("in beam_m.mtx a mass matrix that is not positive");
        assert!(is_indefinite || told.contains("found masses of"), "{told}");
        assert!(told.contains("/bodies/arm/modal/source"), "{told}");
        indefinite += usize::from(is_indefinite);
    }
    assert!(indefinite >= 2, "{indefinite}");
}

/// DMIG text that is wrong.
#[test]
fn faults_of_punched_matrices_are_told_with_their_place() {
    let directory = tempfile::tempdir().expect("a directory");
    let path = directory.path().join("beam.pch");
    let head = "DMIG    K1             0       6       2\n";
    let column = "DMIG*   K1                             1               1\n";
    let cases = [
        (format!("{head}GRID    1\n"), "2:1", "DMIG entries"),
        (
            format!("{head}DMIG,K1,1,1\n"),
            "2:1",
            "free fields are not read",
        ),
        (column.to_owned(), "1:1", "before its header"),
        (format!("{head}{head}"), "2:1", "a second time"),
        (head.replace("       6", "       9"), "1:32", "the form 6"),
        (
            head.replace("       2", "       3"),
            "1:40",
            "the type 1 or 2",
        ),
        (
            format!("{head}*       1\n").replace("DMIG ", "$MIG "),
            "2:1",
            "a DMIG entry before it",
        ),
        (format!("{head}{column}"), "2:1", "a column without entries"),
        (
            format!("{head}{column}*{:>23}{:>16}{:>16}\n", 1, 1, "x"),
            "3:56",
            "a finite number",
        ),
        (
            format!("{head}{column}*{:>23}{:>16}{:>16}\n", 77, 1, 1),
            "3:23",
            "a node of the table",
        ),
        (
            format!("{head}{column}*{:>23}{:>16}{:>16}\n", 1, 8, 1),
            "3:40",
            "a component from 1 to 6",
        ),
        (
            format!("{head}{column}*{:>23}{:>16}{:>16}\n", 1, 0, 1),
            "3:24",
            "scalar point",
        ),
        (
            format!("{head}{column}*{:>23}{:>16}{:>16}{:>16}\n", 1, 1, 1, 2),
            "3:72",
            "a real matrix",
        ),
        (head.to_owned(), "1:", "no matrix M1"),
    ];
    for (text, place, words) in cases {
        std::fs::write(&path, &text).expect("written");
        let mut body = modal(json!({"clamped": "start"}));
        body["source"] = json!({"dmig": {"nodes": data("beam.nodes"), "file": path, "stiffness": "K1", "mass": "M1"}});
        let document = pendulum("modal", body);
        let faults = Problem::parse(&document.to_string(), "modal", &[]).expect_err(words);
        let told = faults.to_string();
        assert!(told.contains(words), "{words:?} is missing in {told}");
        assert!(
            told.contains(&format!("beam.pch:{place}")),
            "{place} is missing in {told}"
        );
    }
}

/// Files with random bytes exchanged, deleted and doubled: a fault or a problem, never a panic.
#[test]
fn damaged_files_end_in_a_fault_or_a_problem() {
    let mut state = 12345_u64;
    let mut next = move |n: usize| {
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (state >> 33) as usize % n
    };
    let mut faults = 0;
    for round in 0..60 {
        let file = ["beam.nodes", "beam_k.mtx", "beam_m.mtx"][round % 3];
        let (_directory, path) = changed("", str::to_owned);
        let mut bytes = std::fs::read(data(file)).expect("a file");
        for _ in 0..1 + next(3) {
            let at = next(bytes.len());
            match next(3) {
                0 => bytes[at] = b"0123456789.-+eE \n%,x\0\xff"[next(22)],
                1 => drop(bytes.remove(at)),
                _ => bytes.truncate(at.max(1)),
            }
        }
        std::fs::write(path.with_file_name(file), &bytes).expect("written");
        if let Err(found) = Problem::load(&path, &[]) {
            assert!(!found.list.is_empty() && !found.to_string().is_empty());
            faults += 1;
        }
    }
    assert!(faults > 20, "{faults}");
}

/// What the document may not say.
#[test]
fn documents_are_told_what_a_body_of_files_cannot_be() {
    let told = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut document = pendulum("modal", modal(json!({"clamped": "start"})));
        change(&mut document);
        let faults = Problem::parse(&document.to_string(), "modal", &[]).err();
        let text = faults.map(|faults| faults.to_string()).unwrap_or_default();
        assert!(
            text.contains(expected),
            "{text:?} says nothing of {expected:?}"
        );
    };
    let own = |document: &mut Value, key: &str, value: Value| {
        document["bodies"]["arm"]["modal"][key] = value;
    };
    told(
        &|d| d["bodies"]["arm"]["mass"] = json!(1),
        "\"mass\" beside \"modal\"",
    );
    told(
        &|d| d["bodies"]["arm"]["beam"] = beam("chord", 1e9),
        "\"modal\" beside \"beam\"",
    );
    told(
        &|d| own(d, "frame", json!({"clamped": "strat"})),
        "\"start\"",
    );
    told(
        &|d| own(d, "frame", json!({"chord": ["start"]})),
        "two or three different interfaces",
    );
    told(
        &|d| own(d, "frame", json!({"chord": ["start", "middle", "end"]})),
        "in one line",
    );
    told(&|d| own(d, "interfaces", json!({})), "without interfaces");
    told(
        &|d| d["bodies"]["arm"]["modal"]["interfaces"]["end"] = json!([]),
        "at least one node",
    );
    told(
        &|d| d["bodies"]["arm"]["modal"]["interfaces"]["end"] = json!(77),
        "node 77",
    );
    told(
        &|d| d["bodies"]["arm"]["modal"]["interfaces"]["end"] = json!([21, 12]),
        "a second time",
    );
    told(
        &|d| own(d, "source", json!({"standard_input": "a.json"})),
        "no file a.json",
    );
    told(&|d| own(d, "modes", json!(1000)), "at most 200");
    told(&|d| own(d, "scale", json!(0)), "above 0");
    told(
        &|d| d["bodies"]["arm"]["points"] = json!({"end": [1, 0, 0]}),
        "a name once",
    );
    told(
        &|d| d["joints"]["root"]["revolute"]["at"] = json!([0.3, 0, 0]),
        "from the interface",
    );
    told(
        &|d| d["loads"]["push"]["force"]["point"] = json!("midle"),
        "middle",
    );
    told(
        &|d| {
            d["functions"]["bend"]["final"] =
                json!({"section_force": {"body": "arm", "station": 0, "component": "axial"}})
        },
        "the name of a beam",
    );
    told(
        &|d| {
            d["loads"]["push"] =
                json!({"torque": {"body": "arm", "direction": [0, 0, 1], "magnitude": 1}})
        },
        "a torque on the body of files",
    );
}
