//! The starts that run on the cores of this rank.

use super::letters::{Event, Task};
use crate::cli::interrupt;
use crate::driver::KnownEvaluations;
use crate::driver::multi_start::{run, started_at};
use crate::problem::Problem;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Starts that run side by side, as many as there are threads, and what happens in them.
pub(super) struct Crew {
    sender: Sender<Event>,
    events: Receiver<Event>,
    stop: Arc<AtomicBool>,
    running: usize,
}

impl Crew {
    pub fn new() -> Self {
        let (sender, events) = channel();
        Self {
            sender,
            events,
            stop: Arc::default(),
            running: 0,
        }
    }

    /// How many starts it could begin.
    pub fn free(&self) -> usize {
        rayon::current_num_threads().saturating_sub(self.running)
    }

    /// How many run.
    pub fn running(&self) -> usize {
        self.running
    }

    /// Makes all starts end after their iteration.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Begins with a start.
    pub fn begin(&mut self, problem: Arc<Problem>, task: Task) {
        self.running += 1;
        let (sender, stop) = (self.sender.clone(), self.stop.clone());
        rayon::spawn(move || {
            let mut problem = started_at(&problem, &task.design);
            problem.optimiser.seconds = task.seconds;
            let stopped = || stop.load(Ordering::Relaxed) || interrupt::asked();
            // Nobody listens to starts that are left behind at the end of the program.
            let tell = |event: Event| drop(sender.send(event));
            let log = KnownEvaluations::new(task.earlier, |record| {
                tell(Event::Record(task.id, Box::new(record)));
            });
            let found = match stopped() {
                true => None,
                false => run(task.start, problem, log, &stopped),
            };
            tell(Event::Done(task.id, found.map(|run| Box::new(run.into()))));
        });
    }

    /// What has happened since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        let events: Vec<Event> = self.events.try_iter().collect();
        let done = |event: &&Event| matches!(event, Event::Done(..));
        self.running -= events.iter().filter(done).count();
        events
    }
}
