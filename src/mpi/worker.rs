//! A rank that works for rank 0.

use super::crew::Crew;
use super::letters::{Description, Letter, Reply, SharedProblem, Unread};
use super::post::{Pause, Post, Tag};
use super::tree::shared;
use crate::cli::{interrupt, progress::progress};
use crate::driver::KnownEvaluations;
use crate::driver::optimise::solve_over;
use crate::problem::Problem;
use mpi::topology::{Communicator, SimpleCommunicator};
use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Exit code of bad input, here of a file that a node lacks.
const BAD_INPUT: i32 = 2;
/// A rank with work asks rank 0 at least so often whether it shall end.
const OFTEN: Duration = Duration::from_millis(200);

/// Works until there is no more work.
pub(super) fn work(post: &Post) {
    interrupt::listen();
    let mut crew = Crew::new();
    let (mut announced, mut problems) = (0, Vec::new());
    let mut has_more = false;
    loop {
        let events = match has_more {
            true => crew.events(),
            false => wait_for_news(&mut crew),
        };
        has_more = false;
        let letter = Letter {
            events,
            free: crew.free(),
            running: crew.running(),
            announced,
            interrupted: interrupt::asked(),
        };
        post.send(0, Tag::Letter, &letter);
        match post.wait_idle(0, Tag::Reply) {
            Reply::Problems(number, descriptions) => {
                announced = number;
                problems = descriptions.into_iter().map(Announced::New).collect();
            }
            Reply::Tasks(tasks, stop) => {
                if stop {
                    crew.stop();
                    progress().end_by(Instant::now());
                }
                interrupt::heed();
                // A rank gets one start at a time, so that all get some.
                has_more = !tasks.is_empty() && crew.free() > 1;
                for task in tasks {
                    crew.begin(problems[task.of].problem(post), task);
                }
            }
            Reply::Shared(of) => share(post, *of),
            Reply::End => return,
        }
    }
}

/// Waits until something happens in the starts that run, but not too long.
fn wait_for_news(crew: &mut Crew) -> Vec<super::letters::Event> {
    let since = Instant::now();
    let mut pause = Pause::idle();
    loop {
        let events = crew.events();
        let due = crew.running() == 0 || since.elapsed() > OFTEN;
        if !events.is_empty() || due || interrupt::asked() {
            return events;
        }
        pause.sleep();
    }
}

/// An announced problem, which is read when its first start comes.
enum Announced {
    New(Description),
    Read(Arc<Problem>),
}

impl Announced {
    fn problem(&mut self, post: &Post) -> Arc<Problem> {
        if let Self::New(description) = self {
            *self = Self::Read(Arc::new(read(description, post)));
        }
        match self {
            Self::Read(problem) => Arc::clone(problem),
            Self::New(_) => unreachable!("it was read"),
        }
    }
}

/// A problem that rank 0 has read without faults. If it has some here, all ranks end.
fn read(description: &Description, post: &Post) -> Problem {
    let fault: Unread = match description.problem() {
        Ok(problem) => return problem,
        Err(fault) => fault,
    };
    eprintln!("rank {}: {fault}", post.rank());
    SimpleCommunicator::world().abort(BAD_INPUT);
}

/// Optimises as rank 0 does, with the cases of this rank or its shares of all motions.
fn share(post: &Post, of: SharedProblem) {
    interrupt::heed();
    let mut problem = read(&of.description, post);
    problem.restart(&of.start);
    let ranks = shared(*post, of.ranks, of.together);
    let log = KnownEvaluations::new(of.earlier, |_| {});
    let mut go_on = |_: &_| ControlFlow::Continue(());
    // Rank 0 has the same result.
    let _ = solve_over(&problem, of.state.as_ref(), log, Some(ranks), &mut go_on);
}
