//! What a run keeps for its adjoint, and the steps that are made again where it did not keep them.

use super::IntegrationFailure;
use super::schedule::{MemoryOfBlock, Schedule};
use super::settings::MEMORY;
use std::borrow::Cow;
use std::fmt::Debug;
use std::ops::Range;

/// Steps in a row with all that the adjoint needs of them.
pub(crate) trait Block {
    /// A state that a march can go on from.
    type State: Clone + Debug;
    /// What its solver keeps from step to step, so that the same steps come out to the last bit.
    type Solver: Clone + Debug;

    /// Empties it. The next step that it takes is the one after step `first`.
    fn restart(&mut self, first: usize);

    /// Makes room for so many steps.
    fn reserve(&mut self, steps: usize);

    /// Steps that it holds, from 1.
    fn steps(&self) -> Range<usize>;

    /// How many numbers it holds.
    fn numbers(&self) -> usize;

    /// A block without any step, of the same system.
    fn empty(&self) -> Self;
}

/// A march that makes the steps of a run again.
pub(crate) trait March {
    /// What it fills.
    type Block: Block;

    /// The state that it has come to.
    fn state(&self) -> <Self::Block as Block>::State;

    /// What its solver keeps.
    fn solver(&mut self) -> <Self::Block as Block>::Solver;

    /// Goes back to a state.
    fn restore(&mut self, state: &<Self::Block as Block>::State);

    /// Takes what a solver kept.
    fn restore_solver(&mut self, solver: &<Self::Block as Block>::Solver);

    /// Makes step k, the next one, and adds it to `block`.
    ///
    /// # Errors
    /// If the step fails, which it did not in the run.
    fn step(&mut self, k: usize, block: Option<&mut Self::Block>)
    -> Result<(), IntegrationFailure>;
}

/// A state that a march can go on from, with what its solver kept.
pub(crate) type Checkpoint<B> = (<B as Block>::State, <B as Block>::Solver);

/// What is kept of a run.
#[derive(Clone, Debug)]
pub(crate) struct Tape<B: Block> {
    /// The last steps. There are none if memory did not suffice for steps that were chosen on the way.
    pub block: B,
    /// Where the steps are known beforehand.
    schedule: Option<Schedule>,
    /// Steps and what stood after them, in rising order, without the start.
    checkpoints: Vec<(usize, Checkpoint<B>)>,
    /// Steps after which checkpoints are still due, the next one last.
    due: Vec<usize>,
    /// What the solver kept when a step was made after another had been given up.
    retried: Vec<(usize, B::Solver)>,
    /// Bytes that it may take, and whether they were too few for the steps that were chosen so far.
    memory: usize,
    full: bool,
    room: MemoryOfBlock,
}

impl<B: Block> Tape<B> {
    /// A tape that takes `memory` bytes; `steps` is how many there will be, if that is known. Without any
    /// memory nothing is kept: a gradient that is asked for all the same makes the motion again.
    pub(crate) fn new(
        mut block: B,
        (memory, room): (usize, MemoryOfBlock),
        steps: Option<usize>,
    ) -> Self {
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

    /// Whether step k, the next one, is to be kept.
    pub(crate) fn keeps(&mut self, k: usize) -> bool {
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
    pub(crate) fn is_due(&mut self, k: usize) -> bool {
        self.due.pop_if(|due| *due == k).is_some()
    }

    /// Leaves a checkpoint after step k.
    pub(crate) fn leave(&mut self, k: usize, checkpoint: Checkpoint<B>) {
        self.checkpoints.push((k, checkpoint));
    }

    /// Says what the solver keeps when it tries step k once more.
    pub(crate) fn retry(&mut self, k: usize, solver: B::Solver) {
        self.retried.pop_if(|(step, _)| *step == k);
        self.retried.push((k, solver));
    }

    /// Memory that it takes (bytes).
    pub(crate) fn bytes(&self, number: usize) -> usize {
        self.block.numbers() * number + self.checkpoints.len() * self.room.checkpoint
    }

    /// How a run of so many steps is kept.
    pub(crate) fn schedule(&self, steps: usize) -> Schedule {
        self.schedule
            .unwrap_or_else(|| self.checkpoint_plan(steps).0)
    }

    /// How a run of so many steps would be kept, and what that takes (bytes).
    pub(crate) fn checkpoint_plan(&self, steps: usize) -> (Schedule, usize) {
        let memory = match self.memory {
            0 => MEMORY,
            memory => memory,
        };
        let schedule = Schedule::new(steps, memory, self.room);
        (schedule, schedule.bytes(self.room))
    }

    /// The tape with another block, without checkpoints.
    pub(crate) fn with<C: Block>(&self, block: C) -> Tape<C> {
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

/// The steps of a run, from the last to the first: from its tape, or made again.
pub(crate) struct Replay<'t, M: March, F> {
    tape: &'t Tape<M::Block>,
    schedule: Schedule,
    /// Makes the march, which stands at the start.
    make: F,
    /// The march and the step that it stands after, once steps are made again.
    march: Option<(M, usize)>,
    stack: Vec<(usize, Cow<'t, Checkpoint<M::Block>>)>,
    block: M::Block,
    /// Steps made again so far.
    pub again: usize,
}

impl<'t, M: March, F: Fn() -> M> Replay<'t, M, F> {
    /// The steps of a run of `steps` steps.
    pub(crate) fn new(tape: &'t Tape<M::Block>, steps: usize, make: F) -> Self {
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

    /// The march that makes steps again, if any were.
    pub(crate) fn march(&self) -> Option<&M> {
        self.march.as_ref().map(|(march, _)| march)
    }

    /// A block that holds step n. No later step is asked for any more.
    ///
    /// # Errors
    /// If a step that is made again fails.
    pub(crate) fn block(&mut self, n: usize) -> Result<&M::Block, IntegrationFailure> {
        if self.tape.block.steps().contains(&n) {
            return Ok(&self.tape.block);
        }
        if !self.block.steps().contains(&n) {
            self.make_again(n)?;
        }
        Ok(&self.block)
    }

    /// Fills the block with steps up to step n.
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

    /// Goes on to step n, and keeps the steps if `keep`.
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
