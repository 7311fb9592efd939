//! The tutorials: every command runs, in order, and prints the lines that stand below it.

use crate::program::{optimize, read, scratch};
use std::path::{Path, PathBuf};

/// A block of a tutorial: its kind and its lines.
type Block = (String, Vec<String>);

fn blocks(text: &str) -> Vec<Block> {
    let mut all: Vec<Block> = Vec::new();
    let mut open = false;
    for line in text.lines() {
        match (line.strip_prefix("```"), open) {
            (Some(kind), false) => {
                all.push((kind.to_owned(), Vec::new()));
                open = true;
            }
            (Some(_), true) => open = false,
            (None, true) => all.last_mut().expect("a block").1.push(line.to_owned()),
            (None, false) => {}
        }
    }
    all
}

/// Whether a printed line has these words in this order, one after the other, numbers to 1e-5.
fn has(printed: &str, wanted: &str) -> bool {
    let words = |text: &str| {
        text.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let (printed, wanted) = (words(printed), words(wanted));
    let same = |(a, b): (&String, &String)| match (a.parse::<f64>(), b.parse::<f64>()) {
        (Ok(a), Ok(b)) => (a - b).abs() <= 1e-5 * b.abs(),
        _ => a.trim_end_matches([',', ';', ':']) == b.trim_end_matches([',', ';', ':']),
    };
    let mut places = printed.windows(wanted.len());
    places.any(|place| place.iter().zip(&wanted).all(same))
}

/// Runs a tutorial in a new folder; gives the number of its commands and of its lines.
fn followed(file: &Path) -> (usize, usize) {
    let at = scratch();
    let (mut commands, mut lines) = (0, 0);
    let mut printed = String::new();
    for (kind, block) in blocks(&read(file)) {
        match kind.as_str() {
            "sh" => {
                printed.clear();
                for command in block {
                    let words: Vec<&str> = command.split_whitespace().collect();
                    let ["optimize", arguments @ ..] = words.as_slice() else {
                        panic!("{}: {command}", file.display());
                    };
                    let ran = optimize(at.path(), arguments);
                    let differs = arguments[0] == "compare";
                    assert_eq!(ran.code, i32::from(differs), "{command}: {}", ran.err);
                    printed += &(ran.out + &ran.err);
                    commands += 1;
                }
            }
            "text" => {
                for line in block {
                    assert!(
                        printed.lines().any(|own| has(own, &line)),
                        "{}: \"{line}\" is not in\n{printed}",
                        file.display()
                    );
                    lines += 1;
                }
            }
            _ => {}
        }
    }
    (commands, lines)
}

fn tutorial(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/tutorials");
    folder.join(name)
}

#[test]
fn the_mechanism_leads_to_its_numbers() {
    assert_eq!(followed(&tutorial("mechanism.md")), (5, 12));
}

#[test]
fn the_arm_leads_to_its_numbers() {
    assert_eq!(followed(&tutorial("arm.md")), (5, 22));
}

#[test]
fn the_plate_leads_to_its_numbers() {
    assert_eq!(followed(&tutorial("plate.md")), (5, 14));
}
