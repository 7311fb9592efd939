//! `optimize-mpi`: the command over processes that MPI starts, called ranks.
//!
//! Rank 0 reads, writes and reports, as the command does alone. The others ask it for work: starts of an optimisation from
//! its queue, cases of one design, or shares of one motion. No rank but 0 opens a file for writing.

mod crew;
mod hub;
mod letters;
mod post;
mod tree;
mod worker;

use crate::cli;
use hub::Hub;
use mpi::Threading;
use mpi::environment::Universe;
use mpi::topology::{Communicator, SimpleCommunicator};
use post::Post;
use std::ffi::OsString;
use std::process::ExitCode;

/// Exit code of a rank that panics, as without MPI.
const PANICKED: i32 = 101;

/// MPI, from its start to its end.
pub struct Session {
    universe: Universe,
    post: Post,
}

impl Session {
    /// Starts MPI. From now on a panic of one of several ranks ends all of them: unwinding would wait in MPI_Finalize for
    /// ranks that wait for this one.
    ///
    /// # Panics
    /// If MPI was started before.
    pub fn start() -> Self {
        let started = mpi::initialize_with_threading(Threading::Serialized);
        let (universe, _) = started.expect("MPI is started once");
        let post = Post::new();
        if post.ranks() > 1 {
            let usual = std::panic::take_hook();
            let (rank, ranks) = (post.rank(), post.ranks());
            std::panic::set_hook(Box::new(move |panic| {
                usual(panic);
                eprintln!("optimize-mpi: rank {rank} of {ranks} panicked, all end");
                SimpleCommunicator::world().abort(PANICKED);
            }));
        }
        Self { universe, post }
    }

    /// The number of this rank, from 0.
    pub fn rank(&self) -> usize {
        self.post.rank()
    }
}

/// Runs the command with the given arguments, of which the first is the program's name, over all ranks.
pub fn run(arguments: impl Iterator<Item = OsString>) -> ExitCode {
    let Session { universe, post } = Session::start();
    let (rank, ranks) = (post.rank(), post.ranks());
    let code = match (rank, ranks) {
        (0, 1) => cli::run_over(arguments, None),
        (0, _) => {
            let hub = Hub::new(post);
            let code = cli::run_over(arguments, Some(&hub));
            if !hub.dismiss() {
                // A rank does not answer: MPI ends it.
                SimpleCommunicator::world().abort(i32::from(code));
            }
            code
        }
        _ => {
            worker::work(&post);
            0
        }
    };
    drop(universe);
    ExitCode::from(code)
}
