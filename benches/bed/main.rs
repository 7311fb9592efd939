//! The bed of the optimiser: problems × methods, judged from outside.
//!
//! `cargo bench --bench bed` runs all of them, prints a summary and how it differs from the table
//! `benches/bed/table.csv`, for all and for two halves. `-- --write` renews the table, `-- --only TEXT` runs the problems whose
//! names contain it, `-- --trace` prints their iterations, `-- --null K` scales the objectives by a factor that differs
//! from one by K × 1e-7: what it changes is chance.

mod case;
mod ends;
#[path = "../../tests/optimiser/problems/mod.rs"]
#[allow(dead_code)]
mod problems;
mod rows;
mod smooth;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::ops::ControlFlow;
use std::path::Path;

use case::{Case, Grade, case, known};
use flexbody::optimiser::{Method, Observer, Options, Row, Silent, Status, solve};

const METHODS: [Method; 3] = [Method::InteriorPoint, Method::TrustRegion, Method::Auto];

fn cases() -> Vec<Case> {
    let mut all: Vec<Case> = Vec::new();
    for problem in problems::hock_schittkowski() {
        // The optimum of problem 13 has no multipliers.
        let truth = match problem.name {
            "HS13" => case::Truth::WithoutMultipliers(problem.best),
            _ => case::Truth::Optimum(problem.best),
        };
        all.push(known("HS", truth, problem));
    }
    let collected = problems::collected::collected();
    all.extend(collected.into_iter().map(|p| case("collected", p)));
    let squares = problems::least_squares::least_squares();
    all.extend(squares.into_iter().map(|p| case("squares", p)));
    all.extend(smooth::cases());
    all.extend(rows::cases());
    all.extend(ends::cases());
    all.extend([(5, 3), (6, 3)].map(|(columns, rows)| case::Case {
        group: "truss",
        name: format!("truss of {columns} by {rows} nodes"),
        truth: case::Truth::Stationary,
        nlp: Box::new(problems::truss::Truss::new(columns, rows)),
    }));
    for units in problems::sized_truss::UNITS {
        all.extend(
            problems::sized_truss::trusses()
                .into_iter()
                .map(|truss| case::Case {
                    group: "sizing",
                    name: format!("{} in {}", truss.name, units.name),
                    truth: case::Truth::Stationary,
                    nlp: Box::new(truss.in_units(units)),
                }),
        );
    }
    all
}

/// One line of the table.
struct Run {
    problem: String,
    method: String,
    grade: Grade,
    status: String,
    evaluations: usize,
    gradients: usize,
    objective: f64,
    own: f64,
}

struct Trace;

impl Observer for Trace {
    fn iteration(&mut self, r: &Row<'_>) -> ControlFlow<()> {
        let step = r.primal_step;
        eprintln!(
            "{:4} f {:<15.8e} viol {:.1e} opt {:.1e} mu {:.1e} |d| {:.1e} alpha {:.1e} reg {:.0e} trials {:2} evals {:4} {:?}",
            r.iteration,
            r.objective,
            r.infeasibility,
            r.optimality,
            r.barrier,
            r.step,
            step,
            r.regularisation,
            r.trials,
            r.evaluations,
            r.phase
        );
        ControlFlow::Continue(())
    }
}

fn run(case: &mut Case, method: Method, null: f64, trace: bool) -> Run {
    let mut options = Options {
        method,
        ..Options::default()
    };
    options.scaling_gradient *= 1.0 + 1e-7 * null;
    let observer: &mut dyn Observer = if trace { &mut Trace } else { &mut Silent };
    let outcome = solve(case.nlp.as_mut(), &options, observer);
    if trace {
        eprintln!("{:?} {:?} {:?}", outcome.status, outcome.kkt, outcome.x);
    }
    let counts = &outcome.counts;
    Run {
        problem: case.name.clone(),
        method: format!("{method:?}"),
        status: name_of(&outcome.status),
        evaluations: counts.evaluations,
        gradients: counts.gradients,
        objective: outcome.objective,
        own: counts.seconds - counts.evaluation_seconds,
        grade: case.grade(&outcome),
    }
}

fn name_of(status: &Status) -> String {
    let text = format!("{status:?}");
    text.split(' ').next().unwrap_or_default().to_string()
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let has = |name: &str| arguments.iter().any(|a| a == name);
    let after = |name: &str| {
        let at = arguments.iter().position(|a| a == name)?;
        arguments.get(at + 1).cloned()
    };
    let only = after("--only");
    let method = after("--method");
    let null = after("--null").map_or(0.0, |k| k.parse().expect("a number"));
    let mut runs = Vec::new();
    for wanted in METHODS {
        if method.as_ref().is_some_and(|m| *m != format!("{wanted:?}")) {
            continue;
        }
        for mut case in cases() {
            if only
                .as_ref()
                .is_none_or(|text| case.name.contains(text.as_str()))
            {
                runs.push((case.group, run(&mut case, wanted, null, has("--trace"))));
            }
        }
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/bed/table.csv");
    let path = after("--table").map_or(path, Into::into);
    if only.is_some() || has("--list") {
        for (_, r) in &runs {
            println!("{}", line(r));
        }
    }
    compare(&path, runs.iter().map(|(_, r)| r));
    summarise(&runs);
    if has("--write") {
        let mut text =
            String::from("problem,method,grade,status,evaluations,gradients,objective\n");
        for (_, r) in &runs {
            let _ = writeln!(text, "{}", line(r));
        }
        fs::write(&path, text).expect("the table can be written");
    }
}

fn line(r: &Run) -> String {
    let counts = format!("{},{}", r.evaluations, r.gradients);
    let name = r.problem.replace(',', ";");
    format!(
        "{name},{},{:?},{},{counts},{:.6e}",
        r.method, r.grade, r.status, r.objective
    )
}

/// Prints the problems whose grade differs from that of the table, and the sums over those that
/// both solved.
fn compare<'a>(path: &Path, runs: impl Iterator<Item = &'a Run>) {
    let text = fs::read_to_string(path).unwrap_or_default();
    let mut known = BTreeMap::new();
    for line in text.lines().skip(1) {
        let parts: Vec<&str> = line.split(',').collect();
        let work = |k: usize| parts[k].parse::<usize>().unwrap_or(0);
        let key = (parts[0].to_string(), parts[1].to_string());
        known.insert(
            key,
            (parts[2].to_string(), work(4), work(5), line.to_string()),
        );
    }
    let mut sums: BTreeMap<(&str, &str), [usize; 3]> = BTreeMap::new();
    for r in runs {
        let key = (r.problem.replace(',', ";"), r.method.clone());
        let Some((grade, f, g, before)) = known.get(&key) else {
            continue;
        };
        let now = format!("{:?}", r.grade);
        if now != *grade {
            println!("was {before}\nnow {}\n", line(r));
        } else if r.grade == Grade::Solved {
            for part in ["all", half(&r.problem)] {
                let sum = sums.entry((r.method.as_str(), part)).or_default();
                sum[0] += 1;
                sum[1] += f + g;
                sum[2] += r.evaluations + r.gradients;
            }
            let (old, new) = (f + g, r.evaluations + r.gradients);
            if new > 2 * old + 10 || old > 2 * new + 10 {
                println!("{} {}: f + g {old} -> {new}", r.problem, r.method);
            }
        }
    }
    for ((method, part), [solved, before, now]) in sums {
        println!("{method}, {part}: {solved} solved before and now, f + g {before} -> {now}");
    }
}

/// One of two halves of the bed, by the name; a problem in several units is in one half. A change that
/// gains in one half alone is tuned to the bed.
fn half(name: &str) -> &'static str {
    let bare = name.split(" in ").next().unwrap_or(name);
    let sum: usize = bare.bytes().map(usize::from).sum();
    ["even half", "odd half"][sum % 2]
}

/// Prints the grades, evaluations and own time of each group and method.
fn summarise(runs: &[(&str, Run)]) {
    println!("group            method         solved other open false  f + g of solved  own time");
    let mut groups: Vec<&str> = Vec::new();
    for (group, _) in runs {
        if !groups.contains(group) {
            groups.push(group);
        }
    }
    groups.push("all");
    for group in groups {
        for method in METHODS {
            let method = format!("{method:?}");
            let mine: Vec<&Run> = runs
                .iter()
                .filter(|(g, r)| (*g == group || group == "all") && r.method == method)
                .map(|(_, r)| r)
                .collect();
            if mine.is_empty() {
                continue;
            }
            let count = |grade| mine.iter().filter(|r| r.grade == grade).count();
            let solved = mine.iter().filter(|r| r.grade == Grade::Solved);
            let work: usize = solved.map(|r| r.evaluations + r.gradients).sum();
            let own: f64 = mine.iter().map(|r| r.own).sum();
            println!(
                "{group:16} {method:14} {:6} {:5} {:4} {:5} {work:16} {own:8.3} s",
                count(Grade::Solved),
                count(Grade::Other),
                count(Grade::Open),
                count(Grade::False)
            );
        }
    }
}
