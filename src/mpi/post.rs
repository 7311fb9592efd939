//! Typed messages between ranks.
//!
//! A message is CBOR, which keeps every bit of a number, also where it is not finite. Waiting sleeps between looks: MPI's
//! own waiting keeps a core busy, which other ranks or threads on the same machine could use.

use crate::cli::interrupt;
use crate::driver::shared::Lost;
use mpi::datatype::Equivalence;
use mpi::point_to_point::{Destination, Source};
use mpi::topology::{Communicator, SimpleCommunicator};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::time::{Duration, Instant};

/// How long a rank waits for the others after an interrupt: all get the signal, unless one has died.
const AFTER_INTERRUPT: Duration = Duration::from_millis(300);
/// Looks before the first sleep, and before that of a rank that waits for a share of a motion: these come thousands of times a
/// second, and a sleep takes longer than most of them.
const LOOKS: u32 = 50;
const LOOKS_FOR_SHARES: u32 = 20_000;
/// Shortest and longest sleep between two looks for numbers that are due.
const SHORTEST: Duration = Duration::from_micros(20);
const LONGEST: Duration = Duration::from_micros(200);
/// Longest sleep of a rank without work.
const IDLE: Duration = Duration::from_millis(3);

/// What a message is about.
#[derive(Clone, Copy)]
pub(super) enum Tag {
    /// A rank asks rank 0.
    Letter = 1,
    /// Rank 0 answers.
    Reply = 2,
    /// What ranks that share an optimisation tell each other at a design.
    Messages = 3,
    /// Shares of a motion.
    Numbers = 4,
}

/// The messages of this rank.
#[derive(Clone, Copy, Debug)]
pub(super) struct Post {
    rank: usize,
    ranks: usize,
}

/// Sleeps that become longer.
pub(super) struct Pause {
    looks: u32,
    before: u32,
    next: Duration,
    longest: Duration,
}

impl Pause {
    pub fn up_to(longest: Duration) -> Self {
        let (looks, next) = (0, SHORTEST);
        Self {
            looks,
            before: LOOKS,
            next,
            longest,
        }
    }

    pub fn idle() -> Self {
        Self::up_to(IDLE)
    }

    pub fn sleep(&mut self) {
        self.looks += 1;
        if self.looks < self.before {
            return std::thread::yield_now();
        }
        std::thread::sleep(self.next);
        self.next = (self.next * 3 / 2).min(self.longest);
    }
}

impl Post {
    /// That of all ranks. MPI must have been started.
    pub fn new() -> Self {
        let world = SimpleCommunicator::world();
        Self {
            rank: usize::try_from(world.rank()).unwrap_or(0),
            ranks: usize::try_from(world.size()).unwrap_or(1),
        }
    }

    pub fn rank(&self) -> usize {
        self.rank
    }

    pub fn ranks(&self) -> usize {
        self.ranks
    }

    /// Sends a message to a rank that waits for it, or will.
    pub fn send(&self, to: usize, tag: Tag, message: &impl Serialize) {
        let mut bytes = Vec::new();
        ciborium::into_writer(message, &mut bytes).expect("memory takes every message");
        let world = SimpleCommunicator::world();
        let to = world.process_at_rank(to as i32);
        to.send_with_tag(&bytes[..], tag as i32);
    }

    /// A message that has arrived, from a rank or from any, with its sender.
    pub fn look<T: DeserializeOwned>(&self, from: Option<usize>, tag: Tag) -> Option<(usize, T)> {
        let world = SimpleCommunicator::world();
        let found = match from {
            Some(rank) => {
                let from = world.process_at_rank(rank as i32);
                from.immediate_matched_probe_with_tag(tag as i32)
            }
            None => (world.any_process()).immediate_matched_probe_with_tag(tag as i32),
        };
        let (message, status) = found?;
        let mut bytes = vec![0u8; status.count(u8::equivalent_datatype()) as usize];
        message.matched_receive_into(&mut bytes[..]);
        let read = ciborium::from_reader(&bytes[..]);
        Some((
            status.source_rank() as usize,
            read.expect("ranks run the same program"),
        ))
    }

    /// Waits for a message from a rank.
    ///
    /// # Errors
    /// An interrupt came, and no message soon after it.
    pub fn wait<T: DeserializeOwned>(&self, from: usize, tag: Tag) -> Result<T, Lost> {
        let mut pause = Pause::up_to(LONGEST);
        let mut asked: Option<Instant> = None;
        loop {
            if let Some((_, message)) = self.look(Some(from), tag) {
                return Ok(message);
            }
            if interrupt::asked() {
                let since = *asked.get_or_insert_with(Instant::now);
                if since.elapsed() > AFTER_INTERRUPT {
                    return Err(Lost);
                }
            }
            pause.sleep();
        }
    }

    /// Sends numbers to a rank that waits for them, or will.
    pub fn send_numbers(&self, to: usize, numbers: &[f64]) {
        let world = SimpleCommunicator::world();
        let to = world.process_at_rank(to as i32);
        to.send_with_tag(numbers, Tag::Numbers as i32);
    }

    /// Waits for numbers from a rank that computes its share of a motion.
    pub fn wait_for_numbers(&self, from: usize) -> Vec<f64> {
        let world = SimpleCommunicator::world();
        let from = world.process_at_rank(from as i32);
        let mut pause = Pause {
            before: LOOKS_FOR_SHARES,
            ..Pause::up_to(LONGEST)
        };
        loop {
            let found = from.immediate_matched_probe_with_tag(Tag::Numbers as i32);
            if let Some((message, status)) = found {
                let mut all = vec![0.0; status.count(f64::equivalent_datatype()) as usize];
                message.matched_receive_into(&mut all[..]);
                return all;
            }
            pause.sleep();
        }
    }

    /// Waits for a message from a rank without work of one's own.
    pub fn wait_idle<T: DeserializeOwned>(&self, from: usize, tag: Tag) -> T {
        let mut pause = Pause::idle();
        loop {
            if let Some((_, message)) = self.look(Some(from), tag) {
                return message;
            }
            pause.sleep();
        }
    }
}
