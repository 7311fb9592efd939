//! Binomial checkpointing: which steps of a run are stored for its adjoint, and which are repeated
//! (Griewank & Walther 2000, ACM TOMS 26(1), Algorithm 799).
//!
//! The last steps of a run are stored with all data for the adjoint. The steps before them are
//! divided into blocks. A march can continue from a checkpoint. With s checkpoints, including the
//! start, and at most r repetitions of every block,
//!
//! ```text
//! β(s, r) = (s + r)! / (s! r!)                 blocks can be reversed at most
//! t(l, s) = r l − β(s + 1, r − 1)              advances reverse l blocks,  β(s, r−1) < l ≤ β(s, r)
//! ```
//!
//! The run itself makes l − 1 of these advances. Every block but the last is repeated once more to
//! be stored. So a gradient repeats t(l, s) blocks.

/// Memory of the parts of a tape \[bytes\].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryOfBlock {
    /// A stored step.
    pub step: usize,
    /// A checkpoint.
    pub checkpoint: usize,
}

/// Which steps of a run are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Schedule {
    steps: usize,
    /// Number of steps before the stored ones.
    head: usize,
    /// Number of steps per block of the head.
    block: usize,
    /// Largest number of simultaneous checkpoints, including the start.
    checkpoints: usize,
}

/// Ratio of consecutive numbers of checkpoints that are tried.
const FINENESS: f64 = 1.1;
/// Largest number of repetitions of a step for a gradient. The memory for this is used in any case.
const MOST_TIMES: usize = 20;

/// The least memory that a run of `steps` steps uses for a gradient \[bytes\]: two steps, and
/// enough checkpoints for at most twenty repetitions of every step.
pub fn least(steps: usize, room: MemoryOfBlock) -> usize {
    let mut checkpoints = 1;
    while repetitions(steps, checkpoints) > MOST_TIMES {
        checkpoints += 1;
    }
    2 * (room.step + checkpoints * room.checkpoint)
}

impl Schedule {
    /// The schedule of a run of `steps` steps with the fewest repetitions in `memory` bytes, or in
    /// the [`least`] memory if there would be too many. Without memory it stores only the start,
    /// and one step at a time.
    pub fn new(steps: usize, memory: usize, room: MemoryOfBlock) -> Self {
        let own = Self::within(steps, memory, room);
        match memory > 0 && own.recomputed() > steps.saturating_mul(MOST_TIMES) {
            true => Self::within(steps, least(steps, room), room),
            false => own,
        }
    }

    fn within(steps: usize, memory: usize, room: MemoryOfBlock) -> Self {
        let whole = Self {
            steps,
            head: 0,
            block: 1,
            checkpoints: 1,
        };
        if steps.saturating_mul(room.step) <= memory {
            return whole;
        }
        let mut best: Option<(usize, Self)> = None;
        let mut checkpoints = 1;
        while checkpoints <= steps {
            // Checkpoints of the run coexist with those of the backward march.
            let rest = memory.saturating_sub(2 * checkpoints * room.checkpoint);
            let kept = (rest / room.step).min(steps);
            if kept < 2 {
                break;
            }
            // As many blocks as checkpoints: each is repeated once.
            let once = match checkpoints {
                1 => kept,
                _ => (steps - kept).div_ceil(checkpoints - 1),
            };
            let block = once.clamp(1, kept / 2);
            let own = Self {
                steps,
                head: steps - (kept - block),
                block,
                checkpoints,
            };
            let again = own.recomputed();
            if best.is_none_or(|(least, _)| again < least) {
                best = Some((again, own));
            }
            checkpoints = (checkpoints as f64 * FINENESS) as usize + 1;
        }
        best.map_or(
            Self {
                head: steps - 1,
                ..whole
            },
            |(_, own)| own,
        )
    }

    /// Whether all steps are stored.
    pub fn keeps_all(&self) -> bool {
        self.head == 0
    }

    /// Number of steps before the stored ones.
    pub fn head(&self) -> usize {
        self.head
    }

    /// Largest number of steps of a repeated block.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Largest number of simultaneous checkpoints.
    pub fn checkpoints(&self) -> usize {
        self.checkpoints
    }

    /// Number of blocks before the stored steps.
    fn blocks(&self) -> usize {
        self.head.div_ceil(self.block)
    }

    /// Step after which block i starts; the stored steps are the last block. The first block takes
    /// the remainder, because it is repeated most.
    fn start(&self, i: usize) -> usize {
        match i {
            0 => 0,
            _ => self.head - (self.blocks() - i) * self.block,
        }
    }

    /// The block of step n = 1 … N.
    fn block_of(&self, n: usize) -> usize {
        match self.head.checked_sub(n) {
            None => self.blocks(),
            Some(after) => self.blocks() - 1 - after / self.block,
        }
    }

    /// Steps after which the run sets checkpoints, without the start.
    pub fn of_run(&self) -> Vec<usize> {
        let (mut first, mut left) = (0, self.checkpoints);
        let mut all = Vec::new();
        while first < self.blocks() && left > 1 {
            first += split(self.blocks() + 1 - first, left);
            left -= 1;
            // Stored steps need no checkpoint.
            if first < self.blocks() {
                all.push(self.start(first));
            }
        }
        all
    }

    /// The next action for step n, with `left` more checkpoints and the last one after step `from`:
    /// the step to advance to for a new checkpoint, or `None` if the steps from there on are to be
    /// stored.
    pub fn next(&self, from: usize, n: usize, left: usize) -> Option<usize> {
        let first = self.block_of(from + 1);
        let length = self.block_of(n) + 1 - first;
        (length > 1).then(|| self.start(first + split(length, left + 1)))
    }

    /// Number of steps that a gradient repeats, for a function that depends on the end of the
    /// motion.
    pub fn recomputed(&self) -> usize {
        if self.keeps_all() {
            return 0;
        }
        let (length, s) = (self.blocks() + 1, self.checkpoints);
        // Every split of the blocks from the start advances over the first block.
        let (mut splits, mut rest) = (0, length);
        while rest > 1 {
            rest = split(rest, s);
            splits += 1;
        }
        let first = self.head - (self.blocks() - 1) * self.block;
        (self.block.saturating_mul(advances(length, s)))
            .saturating_sub((self.block - first) * splits)
    }

    /// Largest memory \[bytes\].
    pub fn bytes(&self, room: MemoryOfBlock) -> usize {
        if self.keeps_all() {
            return self.steps * room.step;
        }
        let kept = self.steps - self.head + self.block;
        kept * room.step + 2 * self.checkpoints * room.checkpoint
    }
}

/// β(s, r): largest number of blocks that s checkpoints reverse with at most r advances over each.
fn most(s: usize, r: usize) -> usize {
    let (few, many) = (s.min(r) as u128, s.max(r) as u128);
    let mut found = 1_u128;
    for k in 1..=few {
        found = found.saturating_mul(many + k) / k;
        if found > u128::from(u64::MAX) {
            return usize::MAX;
        }
    }
    usize::try_from(found).unwrap_or(usize::MAX)
}

/// The least r with l ≤ β(s, r).
fn repetitions(l: usize, s: usize) -> usize {
    let (mut r, mut range) = (0, 1_u128);
    while range < l as u128 {
        r += 1;
        range = range * (s + r) as u128 / r as u128;
    }
    r
}

/// t(l, s): advances over a block that reverse l blocks with s checkpoints.
pub fn advances(l: usize, s: usize) -> usize {
    match repetitions(l, s) {
        0 => 0,
        r => (r.saturating_mul(l)).saturating_sub(most(s + 1, r - 1)),
    }
}

/// Number of l > 1 blocks to advance before the next checkpoint, with s checkpoints including that
/// at the start of the blocks. It minimises the advances, t(l, s) = j + t(j, s) + t(l − j, s − 1).
pub fn split(l: usize, s: usize) -> usize {
    if s <= 1 {
        return l - 1;
    }
    let r = repetitions(l, s);
    let right = l.saturating_sub(most(s - 1, r - 1));
    most(s, r - 1).min(right).clamp(1, l - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Least number of advances, by trying every split.
    fn least(longest: usize, s: usize) -> Vec<Vec<usize>> {
        let mut all = vec![vec![0; longest + 1]; s + 1];
        for s in 1..=s {
            for l in 2..=longest {
                let by = |j: usize| match s {
                    1 => l * (l - 1) / 2,
                    _ => j + all[s][j] + all[s - 1][l - j],
                };
                all[s][l] = (1..l).map(by).min().unwrap_or(0);
            }
        }
        all
    }

    #[test]
    fn advances_are_the_binomial_number_and_the_least() {
        let all = least(80, 9);
        for (s, row) in all.iter().enumerate().skip(1) {
            for (l, &known) in row.iter().enumerate().skip(1) {
                assert_eq!(advances(l, s), known, "{l} blocks, {s} checkpoints");
                if l > 1 && s > 1 {
                    let j = split(l, s);
                    let by = j + advances(j, s) + advances(l - j, s - 1);
                    assert_eq!(by, known, "split {j} of {l}, {s} checkpoints");
                }
            }
        }
        // Griewank & Walther 2000: 10 steps with 3 checkpoints.
        assert_eq!((advances(10, 3), most(3, 2)), (15, 10));
        assert_eq!(advances(1_000_000, 1_000_000), 999_999);
    }

    /// Executes a schedule on numbers: returns the repeated steps and the largest number of stored
    /// ones.
    fn carry_out(schedule: &Schedule, known: bool) -> (usize, usize) {
        let mut stack = vec![0];
        if known {
            stack.extend(schedule.of_run());
        }
        let (mut again, mut most) = (0, stack.len());
        let mut end = if known { schedule.head } else { schedule.steps };
        while end > 0 {
            while stack.last().is_some_and(|&at| at >= end) {
                stack.pop();
            }
            let from = stack[stack.len() - 1];
            let left = schedule.checkpoints - stack.len();
            match schedule.next(from, end, left) {
                Some(next) => {
                    assert!(from < next && next < end);
                    again += next - from;
                    if left > 0 {
                        stack.push(next);
                    } else {
                        // Without another checkpoint the block is made at once.
                        again += end - next;
                        end = next;
                    }
                }
                None => {
                    assert!(end - from <= schedule.block.max(schedule.steps - schedule.head));
                    again += end - from;
                    end = from;
                }
            }
            most = most.max(stack.len());
        }
        (again, most)
    }

    #[test]
    fn a_schedule_makes_as_many_steps_again_as_it_says() {
        let room = MemoryOfBlock {
            step: 1000,
            checkpoint: 70,
        };
        for steps in [1, 2, 3, 10, 97, 1000, 4001] {
            let mut before = usize::MAX;
            for memory in [
                0, 1, 2000, 3000, 5000, 20_000, 100_000, 1_000_000, 4_001_000,
            ] {
                let schedule = Schedule::new(steps, memory, room);
                let (again, most) = carry_out(&schedule, true);
                assert_eq!(again, schedule.recomputed(), "{schedule:?}");
                assert!(most <= schedule.checkpoints, "{schedule:?}");
                assert!(again <= before, "more memory, more work: {schedule:?}");
                before = again;
                if memory > 0 {
                    let admitted = memory.max(super::least(steps, room));
                    assert!(schedule.bytes(room) <= admitted, "{schedule:?} in {memory}");
                    assert!(again <= MOST_TIMES * steps, "{schedule:?}: {again}");
                }
                // For adaptive steps, all steps are repeated once first.
                let (unknown, _) = carry_out(&schedule, false);
                if !schedule.keeps_all() {
                    assert!(unknown <= again + steps, "{schedule:?}: {unknown}");
                }
            }
            assert_eq!(before, 0);
        }
    }

    #[test]
    fn equal_blocks_are_made_again_by_the_binomial_number() {
        for (blocks, block, checkpoints) in [(1, 5, 1), (7, 3, 2), (20, 1, 3), (64, 10, 4)] {
            let schedule = Schedule {
                steps: (blocks + 1) * block,
                head: blocks * block,
                block,
                checkpoints,
            };
            let expected = block * advances(blocks + 1, checkpoints);
            assert_eq!(schedule.recomputed(), expected);
            assert_eq!(carry_out(&schedule, true).0, expected);
        }
    }

    /// With one byte the least memory is used, and it is small.
    #[test]
    fn the_least_memory_bounds_the_work() {
        for (step, checkpoint) in [(1000, 70), (8000, 500), (300, 900)] {
            let room = MemoryOfBlock { step, checkpoint };
            for steps in [2, 30, 1000, 40_000, 3_000_000] {
                let own = Schedule::new(steps, 1, room);
                assert!(own.bytes(room) <= super::least(steps, room), "{own:?}");
                assert!(own.recomputed() <= MOST_TIMES * steps, "{own:?}");
                assert!(super::least(steps, room) <= 2 * step + 24 * checkpoint);
            }
        }
    }

    #[test]
    fn a_thousandth_of_the_memory_costs_one_run_more() {
        let room = MemoryOfBlock {
            step: 8000,
            checkpoint: 500,
        };
        let schedule = Schedule::new(1_000_000, 9_000_000, room);
        assert!(schedule.recomputed() < 1_000_000, "{schedule:?}");
    }
}
