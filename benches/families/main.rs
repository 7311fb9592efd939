//! Random families of scenes, each held against the same question asked otherwise.
//!
//! `cargo bench --bench families` runs all with 200 scenes each and prints their table (kept in
//! `results/families/table.md`) and every scene that is not right. `-- turned units` runs families whose names
//! begin so, `--scenes 20` so many scenes, `--first 17` from this one on, `--keep DIR` leaves the files of the
//! scenes in a directory.
//!
//! | family | question | asked otherwise |
//! |---|---|---|
//! | derivatives | gradient by default | differences of fourth order with steps to 1e-13 |
//! | rest | the same of chains that hang at rest | |
//! | lowered | by default | `--no-lowering` |
//! | turned, units, order, sides | by default | the scene turned, in other units, reordered, joints from the other side |
//! | methods | DOP853 | Radau IIA with three and two stages |
//! | estimates | the estimated errors of `--error` | true errors, by steps to 1e-13 |
//! | frames | flexible bodies in clamped axes | in chord axes |
//! | structures | structures at rest | turned |

mod command;
mod flexible;
mod judge;
mod numbers;
mod rigid;

use command::{Answer, Estimate, simulate};
use judge::{Tally, Verdict, agreement, ratios};
use numbers::{Numbers, Turn};
use rigid::{Kind, Scene, View};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Steps that give the truth.
const TRUTH: f64 = 1e-13;

/// Verdict over a scene, and true by estimated errors.
type Judged = (Verdict, Vec<(String, f64)>);

/// A family: its name, and how the scene with a number is judged.
struct Family {
    name: &'static str,
    judge: fn(&Path, usize) -> Judged,
}

const FAMILIES: [Family; 18] = [
    Family {
        name: "derivatives-space",
        judge: |d, i| derivatives(d, i, Kind::Space),
    },
    Family {
        name: "derivatives-plane",
        judge: |d, i| derivatives(d, i, Kind::Plane),
    },
    Family {
        name: "rest",
        judge: |d, i| derivatives(d, i, Kind::Rest),
    },
    Family {
        name: "lowered-space",
        judge: |d, i| lowered(d, i, Kind::Space),
    },
    Family {
        name: "lowered-plane",
        judge: |d, i| lowered(d, i, Kind::Plane),
    },
    Family {
        name: "turned-space",
        judge: |d, i| viewed(d, i, Kind::Space, turned),
    },
    Family {
        name: "turned-plane",
        judge: |d, i| viewed(d, i, Kind::Plane, turned),
    },
    Family {
        name: "units",
        judge: |d, i| viewed(d, i, Kind::Space, units),
    },
    Family {
        name: "order",
        judge: |d, i| viewed(d, i, Kind::Space, order),
    },
    Family {
        name: "sides",
        judge: |d, i| viewed(d, i, Kind::Plane, sides),
    },
    Family {
        name: "methods-space",
        judge: |d, i| methods(d, i, Kind::Space),
    },
    Family {
        name: "methods-plane",
        judge: |d, i| methods(d, i, Kind::Plane),
    },
    Family {
        name: "estimates-tolerance",
        judge: |d, i| estimates(d, i, &tolerances),
    },
    Family {
        name: "estimates-steps",
        judge: |d, i| estimates(d, i, &steps),
    },
    Family {
        name: "frames",
        judge: flexible::frames,
    },
    Family {
        name: "estimates-flexible",
        judge: flexible::estimates,
    },
    Family {
        name: "structures-turned",
        judge: flexible::turned,
    },
    Family {
        name: "structures-order",
        judge: flexible::reordered,
    },
];

fn scene(number: usize, kind: Kind) -> (Scene, Numbers) {
    let mut numbers = Numbers(0x5eed + 7919 * number as u64 + kind as u64);
    (Scene::random(&mut numbers, kind), numbers)
}

/// Gradients against differences of values.
fn derivatives(directory: &Path, number: usize, kind: Kind) -> Judged {
    let (scene, mut numbers) = scene(number, kind);
    let document = scene.document(&View::PLAIN, &json!({}));
    let by_default = simulate(directory, "default", &document, &["--error"]);
    let (Answer::Numbers { table, .. }, variables) = (&by_default, scene.variables()) else {
        return (
            agreement(&by_default, &by_default, |_| 1.0, 0.0),
            Vec::new(),
        );
    };
    let (name, path, _) = variables[numbers.below(variables.len())];
    let exact = scene.document(&View::PLAIN, &json!({"tolerance": TRUTH}));
    let start = exact.pointer(path).and_then(Value::as_f64).unwrap_or(0.0);
    let step = 2e-5 * start.abs().max(0.1);
    let at = |shift: f64| {
        let mut moved = exact.clone();
        if let Some(entry) = moved.pointer_mut(path) {
            *entry = json!(start + shift * step);
        }
        simulate(directory, "moved", &moved, &[])
    };
    // Four points are exact for polynomials of degree four; twice their distance tells the error.
    let near = [
        (-2.0, 1.0 / 12.0),
        (-1.0, -2.0 / 3.0),
        (1.0, 2.0 / 3.0),
        (2.0, -1.0 / 12.0),
    ];
    let far = near.map(|(shift, weight)| (2.0 * shift, 0.5 * weight));
    let mut slopes = std::collections::BTreeMap::new();
    let largest = judge::largest_value(table);
    for shift in [-4.0, -2.0, -1.0, 1.0, 2.0, 4.0] {
        let Answer::Numbers { table: values, .. } = at(shift) else {
            return (
                Verdict::Told("no values beside the design".into()),
                Vec::new(),
            );
        };
        let weight = |rows: &[(f64, f64)]| {
            let own = rows.iter().filter(|row| row.0 == shift);
            own.map(|row| row.1).sum::<f64>() / step
        };
        for (function, value) in values.iter().filter(|(name, _)| !name.contains(" / ")) {
            let (slope, coarse, round_off): &mut (f64, f64, f64) = slopes
                .entry(format!("{function} / {name}"))
                .or_insert((0.0, 0.0, 0.0));
            *slope += weight(&near) * value.value;
            *coarse += weight(&far) * value.value;
            *round_off += (2e-13 * value.value.abs() + 1e-14 * largest) / step;
        }
    }
    let sizes = judge::sizes(table);
    let slope = |(name, (slope, coarse, round_off)): (String, (f64, f64, f64))| {
        let size = sizes.get(&judge::group(&name)).copied().unwrap_or(0.0);
        let error = (slope - coarse).abs() + round_off + 1e-7 * size;
        let value = slope;
        (name, Estimate { value, error })
    };
    let slopes: std::collections::BTreeMap<String, Estimate> =
        slopes.into_iter().map(slope).collect();
    // The other derivatives are not in question.
    let mut asked = table.clone();
    asked.retain(|name, _| slopes.contains_key(name));
    let warned = matches!(by_default, Answer::Numbers { warned: true, .. });
    let by_default = Answer::Numbers {
        table: asked,
        warned,
    };
    let differences = Answer::Numbers {
        table: slopes,
        warned: false,
    };
    (
        agreement(&differences, &by_default, |_| 1.0, 1e-9),
        Vec::new(),
    )
}

fn lowered(directory: &Path, number: usize, kind: Kind) -> Judged {
    let (scene, _) = scene(number, kind);
    let document = scene.document(&View::PLAIN, &json!({}));
    let one = simulate(directory, "lowered", &document, &["--error"]);
    let other = simulate(
        directory,
        "written",
        &document,
        &["--error", "--no-lowering"],
    );
    (agreement(&one, &other, |_| 1.0, 1e-8), Vec::new())
}

fn turned(numbers: &mut Numbers) -> View {
    let turn = Turn {
        axis: numbers.direction(),
        angle: numbers.between(-3.0, 3.0),
    };
    View {
        turn,
        ..View::PLAIN
    }
}

fn units(numbers: &mut Numbers) -> View {
    let unit = |numbers: &mut Numbers| 10_f64.powi(numbers.below(9) as i32 - 4);
    View {
        units: [unit(numbers), unit(numbers), unit(numbers)],
        ..View::PLAIN
    }
}

fn order(numbers: &mut Numbers) -> View {
    View {
        order: Some(numbers.below(1000) as u64),
        ..View::PLAIN
    }
}

fn sides(_: &mut Numbers) -> View {
    View {
        swapped: true,
        ..View::PLAIN
    }
}

fn viewed(directory: &Path, number: usize, kind: Kind, view: fn(&mut Numbers) -> View) -> Judged {
    let (scene, mut numbers) = scene(number, kind);
    let view = view(&mut numbers);
    let one = simulate(
        directory,
        "plain",
        &scene.document(&View::PLAIN, &json!({})),
        &["--error"],
    );
    let other = simulate(
        directory,
        "viewed",
        &scene.document(&view, &json!({})),
        &["--error"],
    );
    (
        agreement(&one, &other, |name| scene.factor(&view, name), 1e-8),
        Vec::new(),
    )
}

fn methods(directory: &Path, number: usize, kind: Kind) -> Judged {
    let (scene, _) = scene(number, kind);
    let by = |name: &str, simulation: Value| {
        simulate(
            directory,
            name,
            &scene.document(&View::PLAIN, &simulation),
            &["--error"],
        )
    };
    let one = by("dop853", json!({"method": "dop853"}));
    for (stages, tolerance) in [(3, 1e-9), (2, 1e-7)] {
        let name = format!("radau{stages}");
        let other = by(
            &name,
            json!({"method": {"radau": {"stages": stages}}, "tolerance": tolerance}),
        );
        match agreement(&one, &other, |_| 1.0, 1e-8) {
            Verdict::Right => {}
            Verdict::Told(words) => return (Verdict::Told(format!("{name}: {words}")), Vec::new()),
            Verdict::Wrong(words) => {
                return (Verdict::Wrong(format!("{name}: {words}")), Vec::new());
            }
            broke => return (broke, Vec::new()),
        }
    }
    (Verdict::Right, Vec::new())
}

fn tolerances(numbers: &mut Numbers) -> Value {
    let tolerance = 10_f64.powi(-4 - numbers.below(6) as i32);
    match numbers.below(3) {
        0 => json!({"tolerance": tolerance}),
        1 => json!({"tolerance": tolerance, "method": {"radau": {"stages": 3}}}),
        _ => json!({"tolerance": tolerance.max(1e-7), "method": {"radau": {"stages": 2}}}),
    }
}

fn steps(numbers: &mut Numbers) -> Value {
    let steps = 100 << numbers.below(3);
    match numbers.below(6) {
        0 => json!({"steps": steps, "method": "dop853"}),
        1 => json!({"steps": steps, "method": {"radau": {"stages": 3}}}),
        2 => json!({"steps": steps, "method": {"radau": {"stages": 2}}}),
        3 => json!({"steps": 4 * steps, "method": {"generalised_alpha": {"radius": 0.8}}}),
        order => json!({"steps": 4 * steps, "method": {"bdf": {"order": order - 2}}}),
    }
}

/// Estimated against true errors.
fn estimates(
    directory: &Path,
    number: usize,
    simulation: &dyn Fn(&mut Numbers) -> Value,
) -> Judged {
    let kind = if number.is_multiple_of(2) {
        Kind::Space
    } else {
        Kind::Plane
    };
    let (scene, mut numbers) = scene(number, kind);
    let simulation = simulation(&mut numbers);
    let claimed = simulate(
        directory,
        "claimed",
        &scene.document(&View::PLAIN, &simulation),
        &["--error"],
    );
    // Kept steps have no dense samples: sums over the motion take the instants of the steps.
    let truth = simulate(
        directory,
        "truth",
        &scene.document(&View::PLAIN, &json!({"tolerance": TRUTH})),
        &["--error"],
    );
    judge_estimates(&truth, &claimed, 1e-10)
}

/// A scene is wrong where a true error is more than ten times its estimate.
pub fn judge_estimates(truth: &Answer, claimed: &Answer, round_off: f64) -> Judged {
    let warned = match (truth, claimed) {
        (Answer::Numbers { .. }, Answer::Numbers { warned, .. }) => *warned,
        _ => return (agreement(truth, claimed, |_| 1.0, 0.0), Vec::new()),
    };
    let ratios = ratios(truth, claimed, round_off);
    let worst = ratios.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let verdict = match worst {
        Some((name, ratio)) if ratio.is_nan() || *ratio > 10.0 => {
            let words = format!("{name}: the true error is {ratio:.1} times the estimated one");
            if warned {
                Verdict::Told(words)
            } else {
                Verdict::Wrong(words)
            }
        }
        _ => Verdict::Right,
    };
    // What is warned of is no claim.
    (verdict, if warned { Vec::new() } else { ratios })
}

/// What the command line asks for.
struct Wanted {
    families: Vec<String>,
    scenes: usize,
    first: usize,
    keep: Option<PathBuf>,
}

fn wanted() -> Wanted {
    let mut wanted = Wanted {
        families: Vec::new(),
        scenes: 200,
        first: 0,
        keep: None,
    };
    let mut words = std::env::args().skip(1);
    while let Some(word) = words.next() {
        let mut number = |default| words.next().and_then(|w| w.parse().ok()).unwrap_or(default);
        match word.as_str() {
            "--scenes" => wanted.scenes = number(200),
            "--first" => wanted.first = number(0),
            "--keep" => wanted.keep = words.next().map(PathBuf::from),
            "--bench" => {}
            _ => wanted.families.push(word),
        }
    }
    wanted
}

fn run(family: &Family, wanted: &Wanted, directory: &Path) -> Tally {
    let tally = Mutex::new(Tally::default());
    let next = AtomicUsize::new(wanted.first);
    let end = wanted.first + wanted.scenes;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= end {
                        break;
                    }
                    let place = directory.join(family.name).join(number.to_string());
                    if std::fs::create_dir_all(&place).is_err() {
                        eprintln!("{} cannot be made", place.display());
                        break;
                    }
                    let (verdict, ratios) = (family.judge)(&place, number);
                    if let Ok(mut tally) = tally.lock() {
                        tally.verdicts.push((number, verdict));
                        tally.ratios.extend(ratios.into_iter().map(|r| r.1));
                    }
                }
            });
        }
    });
    let mut tally = tally.into_inner().unwrap_or_default();
    tally.verdicts.sort_by_key(|v| v.0);
    tally
}

fn main() -> ExitCode {
    let wanted = wanted();
    let Ok(temporary) = tempfile::tempdir() else {
        eprintln!("there is no directory for temporary files");
        return ExitCode::FAILURE;
    };
    let directory = wanted
        .keep
        .clone()
        .unwrap_or_else(|| temporary.path().to_owned());
    println!(
        "| family | scenes | right | told | wrong | broken | estimates | within 3 | within 10 | largest ratio |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let is_wanted = |name: &str| {
        wanted.families.is_empty()
            || wanted
                .families
                .iter()
                .any(|start| name.starts_with(start.as_str()))
    };
    let mut right = true;
    for family in FAMILIES.iter().filter(|family| is_wanted(family.name)) {
        let tally = run(family, &wanted, &directory);
        println!("{}", tally.row(family.name));
        for (number, verdict) in &tally.verdicts {
            match verdict {
                Verdict::Right => {}
                Verdict::Told(words) => eprintln!("{} {number} told: {}", family.name, line(words)),
                Verdict::Wrong(words) => {
                    eprintln!("{} {number} WRONG: {}", family.name, line(words))
                }
                Verdict::Broke(words) => {
                    eprintln!("{} {number} BROKE: {}", family.name, line(words))
                }
            }
            right &= !matches!(verdict, Verdict::Wrong(_) | Verdict::Broke(_));
        }
    }
    if right {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}

/// The first 200 characters on one line.
fn line(words: &str) -> String {
    words.replace('\n', " ").chars().take(200).collect()
}
