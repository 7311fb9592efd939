//! Data of a run for its adjoint, and the replay of steps that were not stored.

use super::IntegrationFailure;
use super::schedule::{MemoryOfBlock, Schedule};
use super::settings::MEMORY;
use std::borrow::Cow;
use std::fmt::Debug;
use std::ops::Range;

/// Consecutive steps with all data that the adjoint needs.
pub trait Block {
    /// A state from which a march can continue.
    type State: Clone + Debug;
    /// Data that its solver keeps from step to step. With it a replay repeats every bit.
    type Solver: Clone + Debug;

    /// Empties the block. Its next step is the one after step `first`.
    fn restart(&mut self, first: usize);

    /// Reserves memory for this many steps.
    fn reserve(&mut self, steps: usize);

    /// Numbers of its steps, from 1.
    fn steps(&self) -> Range<usize>;

    /// Number of stored numbers.
    fn numbers(&self) -> usize;

    /// An empty block of the same system.
    fn empty(&self) -> Self;
}

/// A march that repeats the steps of a run.
pub trait March {
    /// The block that it fills.
    type Block: Block;

    /// The present state.
    fn state(&self) -> <Self::Block as Block>::State;

    /// The data of its solver.
    fn solver(&mut self) -> <Self::Block as Block>::Solver;

    /// Returns to a state.
    fn restore(&mut self, state: &<Self::Block as Block>::State);

    /// Restores the data of a solver.
    fn restore_solver(&mut self, solver: &<Self::Block as Block>::Solver);

    /// Makes step k, the next one, and adds it to `block`, if any.
    ///
    /// # Errors
    /// The step fails. It did not fail in the run.
    fn step(&mut self, k: usize, block: Option<&mut Self::Block>)
    -> Result<(), IntegrationFailure>;
}

/// A state from which a march can continue, with the data of its solver.
pub type Checkpoint<B> = (<B as Block>::State, <B as Block>::Solver);

/// Stored data of a run.
#[derive(Clone, Debug)]
pub struct Tape<B: Block> {
    /// The last steps; empty if the memory did not suffice for adaptive steps.
    pub block: B,
    /// The schedule, if the number of steps is known in advance.
    schedule: Option<Schedule>,
    /// Checkpoints with the number of the step before them, ascending, without the start.
    checkpoints: Vec<(usize, Checkpoint<B>)>,
    /// Steps after which checkpoints are still due; the next one is last.
    due: Vec<usize>,
    /// Data of the solver at steps that were made after a rejected one.
    retried: Vec<(usize, B::Solver)>,
    /// Memory limit \[bytes\], and whether it was too small for the steps so far.
    memory: usize,
    full: bool,
    room: MemoryOfBlock,
}

impl<B: Block> Tape<B> {
    /// A tape that may use `memory` bytes; `steps` is the number of steps, if known. Without memory
    /// nothing is stored, and a gradient must repeat the motion.
    pub fn new(mut block: B, (memory, room): (usize, MemoryOfBlock), steps: Option<usize>) -> Self {
        let known = steps.filter(|_| memory > 0);
        let schedule = known.map(|steps| Schedule::new(steps, memory, room));
        let mut due = Vec::new();
        if let (Some(schedule), Some(steps)) = (&schedule, known) {
            block.restart(schedule.head());
            block.reserve(steps - schedule.head());
            due = schedule.of_run();
            due.reverse();
        }
        Self {
            block,
            schedule,
            checkpoints: Vec::with_capacity(due.len()),
            due,
            retried: Vec::new(),
            memory,
            full: memory == 0,
            room,
        }
    }

    /// Whether to store step k, the next one.
    pub fn keeps(&mut self, k: usize) -> bool {
        if let Some(schedule) = &self.schedule {
            return k > schedule.head();
        }
        if !self.full && k.saturating_mul(self.room.step) > self.memory {
            self.full = true;
            self.block = self.block.empty();
        }
        !self.full
    }

    /// Whether a checkpoint is due after step k.
    pub fn is_due(&mut self, k: usize) -> bool {
        self.due.pop_if(|due| *due == k).is_some()
    }

    /// Adds a checkpoint after step k.
    pub fn leave(&mut self, k: usize, checkpoint: Checkpoint<B>) {
        self.checkpoints.push((k, checkpoint));
    }

    /// Records the data of the solver when it tries step k again.
    pub fn retry(&mut self, k: usize, solver: B::Solver) {
        self.retried.pop_if(|(step, _)| *step == k);
        self.retried.push((k, solver));
    }

    /// Frees the memory of its steps.
    pub fn forget(&mut self) {
        self.full = true;
        self.block = self.block.empty();
        self.schedule = None;
        self.checkpoints.clear();
    }

    /// Memory in use \[bytes\]; `number` is the size of a number.
    pub fn bytes(&self, number: usize) -> usize {
        self.block.numbers() * number + self.checkpoints.len() * self.room.checkpoint
    }

    /// The schedule of a run of `steps` steps.
    pub fn schedule(&self, steps: usize) -> Schedule {
        self.schedule
            .unwrap_or_else(|| self.checkpoint_plan(steps).0)
    }

    /// The schedule of a run of `steps` steps, and its memory \[bytes\].
    pub fn checkpoint_plan(&self, steps: usize) -> (Schedule, usize) {
        let memory = match self.memory {
            0 => MEMORY,
            memory => memory,
        };
        let schedule = Schedule::new(steps, memory, self.room);
        (schedule, schedule.bytes(self.room))
    }

    /// The tape with another block, without checkpoints.
    pub fn with<C: Block>(&self, block: C) -> Tape<C> {
        Tape {
            block,
            schedule: self.schedule,
            checkpoints: Vec::new(),
            due: Vec::new(),
            retried: Vec::new(),
            memory: self.memory,
            full: self.full,
            room: self.room,
        }
    }
}

/// The steps of a run from the last to the first: from its tape, or repeated.
pub struct Replay<'t, M: March, F> {
    tape: &'t Tape<M::Block>,
    schedule: Schedule,
    /// Creates the march at the start.
    make: F,
    /// The march and its present step, once steps are repeated.
    march: Option<(M, usize)>,
    stack: Vec<(usize, Cow<'t, Checkpoint<M::Block>>)>,
    block: M::Block,
    /// Number of repeated steps so far.
    pub again: usize,
}

impl<'t, M: March, F: Fn() -> M> Replay<'t, M, F> {
    /// The steps of a run of `steps` steps.
    pub fn new(tape: &'t Tape<M::Block>, steps: usize, make: F) -> Self {
        Self {
            tape,
            schedule: tape.schedule(steps),
            make,
            march: None,
            stack: Vec::new(),
            block: tape.block.empty(),
            again: 0,
        }
    }

    /// The march that repeats steps, if any were repeated.
    pub fn march(&self) -> Option<&M> {
        self.march.as_ref().map(|(march, _)| march)
    }

    /// A block that holds step n. Calls must have descending n.
    ///
    /// # Errors
    /// A repeated step fails.
    pub fn block(&mut self, n: usize) -> Result<&M::Block, IntegrationFailure> {
        if self.tape.block.steps().contains(&n) {
            return Ok(&self.tape.block);
        }
        if !self.block.steps().contains(&n) {
            self.make_again(n)?;
        }
        Ok(&self.block)
    }

    /// Repeats a block of steps up to step n.
    fn make_again(&mut self, n: usize) -> Result<(), IntegrationFailure> {
        if self.march.is_none() {
            let mut march = (self.make)();
            let start = (march.state(), march.solver());
            self.march = Some((march, 0));
            self.stack.push((0, Cow::Owned(start)));
            let left = self.tape.checkpoints.iter();
            self.stack
                .extend(left.map(|(k, own)| (*k, Cow::Borrowed(own))));
        }
        loop {
            while self.stack.last().is_some_and(|(at, _)| *at >= n) {
                self.stack.pop();
            }
            let left = (self.schedule.checkpoints()).saturating_sub(self.stack.len());
            let Some((march, at)) = &mut self.march else {
                unreachable!("the march was made above");
            };
            let Some((from, checkpoint)) = self.stack.last() else {
                unreachable!("the start is before every step");
            };
            if at != from {
                march.restore(&checkpoint.0);
                march.restore_solver(&checkpoint.1);
                *at = *from;
            }
            let next = self.schedule.next(*from, n, left);
            if let Some(next) = next {
                self.advance(next, false)?;
                if left > 0 {
                    let Some((march, at)) = &mut self.march else {
                        unreachable!("the march was made above");
                    };
                    let checkpoint = (march.state(), march.solver());
                    self.stack.push((*at, Cow::Owned(checkpoint)));
                    continue;
                }
            }
            return self.advance(n, true);
        }
    }

    /// Advances to step n, and stores the steps if `keep`.
    fn advance(&mut self, n: usize, keep: bool) -> Result<(), IntegrationFailure> {
        let Some((march, at)) = &mut self.march else {
            unreachable!("no march to go on with");
        };
        if keep {
            self.block.restart(*at);
        }
        for k in *at + 1..=n {
            let retried = self
                .tape
                .retried
                .binary_search_by_key(&k, |(step, _)| *step);
            if let Ok(i) = retried {
                march.restore_solver(&self.tape.retried[i].1);
            }
            march.step(k, keep.then_some(&mut self.block))?;
            *at = k;
            self.again += 1;
        }
        Ok(())
    }
}
