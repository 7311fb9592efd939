//! Motions that several processes compute together. Here threads stand for the processes: each has its own problem, and numbers
//! go between them alone.

use crate::reference::documents::{plates, problem};
use crate::reference::gradients::{gradients_are_exact, thick_and_soft};
use flexbody_driver::Evaluated;
use flexbody_mathematics::math::{Gather, Team};
use flexbody_mechanics::integrate::IntegrationFailure;
use flexbody_problem::Problem;
use serde_json::Value;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Barrier, Mutex};

/// A table on which every rank lays its numbers.
#[derive(Debug)]
struct Table {
    given: Vec<Mutex<Vec<f64>>>,
    all_are_here: Barrier,
    calls: AtomicUsize,
    /// The call at which all learn that they must end.
    end_at: usize,
}

#[derive(Debug)]
struct Rank {
    number: usize,
    table: Arc<Table>,
    over: Arc<AtomicBool>,
}

impl Gather for Rank {
    fn rank(&self) -> usize {
        self.number
    }

    fn ranks(&self) -> usize {
        self.table.given.len()
    }

    fn gather(&self, own: &[f64]) -> Vec<f64> {
        let table = &self.table;
        let place = |k: usize| table.given[k].lock().expect("no rank panicked");
        *place(self.number) = own.to_vec();
        if self.number == 0 {
            table.calls.fetch_add(1, Ordering::Relaxed);
        }
        table.all_are_here.wait();
        let all: Vec<f64> = (0..self.ranks()).flat_map(|k| place(k).clone()).collect();
        if table.calls.load(Ordering::Relaxed) >= table.end_at {
            self.over.store(true, Ordering::Relaxed);
        }
        table.all_are_here.wait();
        all
    }
}

/// What each rank makes of a problem, and how often they gave each other numbers.
fn over<T: Send>(
    (ranks, end_at): (usize, usize),
    file: &Value,
    work: impl Fn(&Problem) -> T + Sync,
) -> (Vec<T>, usize) {
    let table = Arc::new(Table {
        given: (0..ranks).map(|_| Mutex::default()).collect(),
        all_are_here: Barrier::new(ranks),
        calls: AtomicUsize::new(0),
        end_at,
    });
    let of_rank = |number: usize| {
        let over = Arc::new(AtomicBool::new(false));
        let rank = Rank {
            number,
            table: table.clone(),
            over: over.clone(),
        };
        let own = problem(file).together(&Team::of(Arc::new(rank)), (&over, 1 << 28));
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build();
        pool.expect("a thread").install(|| work(&own))
    };
    let all = std::thread::scope(|scope| {
        let all: Vec<_> = (0..ranks)
            .map(|number| scope.spawn(move || of_rank(number)))
            .collect();
        all.into_iter()
            .map(|own| own.join().expect("no panic"))
            .collect()
    });
    let calls = table.calls.load(Ordering::Relaxed);
    (all, calls)
}

/// Bits of all values and derivatives.
fn bits(problem: &Problem) -> Vec<u64> {
    let at = Evaluated::new(problem, &problem.start()).expect("a motion");
    let which: Vec<usize> = (0..problem.function_names.len()).collect();
    let (rows, _) = at.gradients(problem, &which).expect("gradients");
    let values = which.iter().map(|&f| at.value(f));
    let all = values.chain(rows.into_iter().flatten());
    all.map(f64::to_bits).collect()
}

/// By formulas and by Radau IIA: elements, branches of the factors and right-hand sides go to one to four ranks.
#[test]
fn the_bits_do_not_depend_on_the_number_of_ranks() {
    let methods = [
        (json!({"bdf": {"order": 2}}), [16, 4], 4),
        (json!({"radau": {"stages": 3}}), [16, 2], 2),
    ];
    for (method, elements, steps) in methods {
        let file = plates(elements, 0.02, steps, &method);
        assert!(problem(&file).can_be_shared());
        let alone = bits(&problem(&file));
        let mut calls = Vec::new();
        for ranks in 1..=4 {
            let (all, count) = over((ranks, usize::MAX), &file, bits);
            assert!(
                all.iter().all(|own| *own == alone),
                "{ranks} ranks, {method}"
            );
            calls.push(count);
        }
        assert_eq!(calls[0], 0, "one rank has nobody to tell");
        assert!(calls[1] > 100 && calls[1..] == [calls[1]; 3], "{calls:?}");
    }
}

/// The complex step over ranks, against the adjoint over ranks.
#[test]
fn gradients_over_ranks_are_exact() {
    let mut file = plates([16, 2], 0.02, 3, &json!({"bdf": {"order": 2}}));
    thick_and_soft(&mut file);
    let (_, calls) = over((3, usize::MAX), &file, |own| {
        gradients_are_exact(own, &json!("3 ranks"))
    });
    assert!(calls > 100, "{calls}");
}

/// The wish of one rank to end goes along with the numbers: all end at the same step.
#[test]
fn all_ranks_end_together() {
    let file = plates([16, 2], 0.1, 50, &json!({"bdf": {"order": 2}}));
    let end_at = 77;
    let (all, calls) = over((3, end_at), &file, |own| {
        Evaluated::new(own, &own.start()).map(drop)
    });
    for end in all {
        assert_eq!(end, Err(IntegrationFailure::Interrupted));
    }
    assert!((end_at..end_at + 200).contains(&calls), "{calls}");
}

/// Each rank keeps its share of the steps for the adjoint, besides the start of the motion.
#[test]
fn the_tape_is_spread() {
    let steps = 8;
    let file = plates([16, 4], 0.02, steps, &json!({"bdf": {"order": 2}}));
    let bytes = |own: &Problem| {
        let at = Evaluated::new(own, &own.start()).expect("a motion");
        at.run.bytes()[1]
    };
    let alone = bytes(&problem(&file));
    let of_ranks = |ranks| over((ranks, usize::MAX), &file, bytes).0;
    // Two ranks have the start twice.
    let start = of_ranks(2).iter().sum::<usize>() - alone;
    assert!(0 < start && start < alone / steps, "{start} {alone}");
    for ranks in 2..=4 {
        let all = of_ranks(ranks);
        assert_eq!(all.iter().sum::<usize>(), alone + (ranks - 1) * start);
        let most = start + (alone - start) / ranks + 8 * 2 * steps;
        assert!(all.iter().all(|&own| own <= most), "{all:?} {alone}");
    }
}
