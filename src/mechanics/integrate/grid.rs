//! Ends of steps and positions of samples, as fractions of the duration.

use super::parts::{NEAR, parts, shared};
use super::quadrature::{Intervals, Step, is_same};
use crate::math::Scalar;
use crate::system::RedundantRows;

/// Ends of the steps as fractions τ_0 = 0 < τ_1 < … < τ_N of the duration T. τ_N is 1, or larger if
/// the motion ends too close to a singular position for a step to end there.
///
/// Let κ T be the time of the last kink of loads and drives (κ = 0 without). Kinks have fixed times,
/// so only the steps after it move with the duration:
///
/// ```text
/// dt/dT = 0 for τ ≤ κ,     dt/dT = (τ − κ)/(1 − κ) for τ > κ
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    ends: Vec<f64>,
    /// Kinks at which steps end: ascending fractions. They divide the motion into parts.
    kinks: Vec<f64>,
    /// Whether steps end at all kinks. Equal steps of a duration that never changes need not.
    holds_kinks: bool,
    /// Numbers of steps of the parts if these are given and equal in each part; else empty.
    equal: Vec<usize>,
    /// Halvings of the steps that were given.
    halvings: u32,
    /// Number of cells of each step for sums over the motion (see
    /// [`quadrature`](super::quadrature)); one per step if empty.
    cells: Vec<u32>,
    /// Redundant rows that are left out, each from a given step on.
    left_out: Vec<(usize, RedundantRows)>,
}

impl Grid {
    /// `steps` steps of equal size.
    pub fn uniform(steps: usize) -> Self {
        Self {
            ends: (0..=steps).map(|k| k as f64 / steps as f64).collect(),
            equal: vec![steps],
            holds_kinks: false,
            ..Self::growing()
        }
    }

    /// `steps` steps, equal between the `kinks`; at least one between two of them.
    pub fn between(steps: usize, kinks: &[f64]) -> Self {
        if kinks.is_empty() {
            return Self {
                holds_kinks: true,
                ..Self::uniform(steps)
            };
        }
        let parts = parts(kinks);
        let widths: Vec<f64> = parts.iter().map(|[from, end]| end - from).collect();
        let equal = shared(steps, &widths);
        let mut ends = vec![0.0];
        for (&[from, end], &count) in parts.iter().zip(&equal) {
            let inner = (1..count).map(|i| from + (end - from) * (i as f64 / count as f64));
            ends.extend(inner.chain([end]));
        }
        Self {
            ends,
            equal,
            kinks: kinks.to_vec(),
            ..Self::growing()
        }
    }

    /// A grid that grows step by step from 0.
    pub fn growing() -> Self {
        Self {
            ends: vec![0.0],
            kinks: Vec::new(),
            holds_kinks: true,
            equal: Vec::new(),
            halvings: 0,
            cells: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// A grid that grows, with steps that will end at `kinks`.
    pub fn growing_to(kinks: &[f64]) -> Self {
        Self {
            kinks: kinks.to_vec(),
            ..Self::growing()
        }
    }

    /// This empty grid from the fraction `start` on.
    pub fn from(self, start: f64) -> Self {
        Self {
            ends: vec![start],
            ..self
        }
    }

    /// An empty grid that will grow to this one.
    pub fn to_grow(&self) -> Self {
        Self {
            ends: vec![0.0],
            left_out: Vec::new(),
            ..self.clone()
        }
    }

    /// The grid with these kinks, and equal steps in between if `equal`; `None` if they are no ends of
    /// steps.
    pub fn with_kinks(mut self, kinks: Vec<f64>, equal: bool) -> Option<Self> {
        let inner = &self.ends[1..self.steps()];
        let is_end = |kink: &f64| inner.iter().any(|end| (end - kink).abs() <= NEAR);
        if !(kinks.iter().all(is_end) && kinks.windows(2).all(|pair| pair[0] < pair[1])) {
            return None;
        }
        if equal {
            let at = |kink: &f64| self.ends.partition_point(|end| *end < kink - NEAR);
            let marks: Vec<usize> = kinks.iter().map(at).chain([self.steps()]).collect();
            let before = std::iter::once(0).chain(marks.iter().copied());
            self.equal = marks
                .iter()
                .zip(before)
                .map(|(end, from)| end - from)
                .collect();
        }
        self.kinks = kinks;
        Some(self)
    }

    /// The steps for a duration at which the kinks are at these fractions. Each part keeps its steps,
    /// stretched. If the number of kinks changes, given steps are distributed anew. Other steps are
    /// left out with their parts, or a new part gets as many as the last one has.
    pub fn fitted(&self, kinks: &[f64]) -> Self {
        if kinks == self.kinks || !self.holds_kinks {
            return self.clone();
        }
        if self.is_equal() && kinks.len() != self.kinks.len() {
            let steps: usize = self.equal.iter().sum();
            let mut grid = Self::between(steps >> self.halvings, kinks);
            (0..self.halvings).for_each(|_| grid = grid.halved());
            return grid;
        }
        let (old, new) = (parts(&self.kinks), parts(kinks));
        let mut grid = Self {
            ends: vec![0.0],
            kinks: kinks.to_vec(),
            cells: Vec::new(),
            ..self.clone()
        };
        let mut k = 1;
        for (i, &[from, end]) in new.iter().enumerate() {
            let Some(&[before, after]) = old.get(i) else {
                let count = self.in_part(self.steps());
                let inner = (1..count).map(|j| from + (end - from) * (j as f64 / count as f64));
                grid.ends.extend(inner.chain([end]));
                continue;
            };
            let scale = (end - from) / (after - before);
            while k <= self.steps() && self.ends[k] < after - NEAR {
                grid.ends.push(from + (self.ends[k] - before) * scale);
                k += 1;
            }
            let last = i + 1 == new.len();
            grid.ends.push(match self.ends.get(k) {
                Some(&beyond) if last && beyond > 1.0 => from + (beyond - before) * scale,
                _ => end,
            });
            k += 1;
        }
        let steps = grid.steps();
        if !self.cells.is_empty() {
            grid.cells = (1..=steps).map(|k| self.cells(k) as u32).collect();
        }
        grid.left_out.retain(|(from, _)| *from <= steps);
        grid
    }

    /// Kinks at which steps end.
    pub fn kinks(&self) -> &[f64] {
        &self.kinks
    }

    /// Whether the steps are given: equal between kinks, at which they end.
    pub fn is_equal(&self) -> bool {
        self.holds_kinks && !self.equal.is_empty()
    }

    /// Fraction of the last kink: until then the steps have fixed times.
    /// The fraction of the last kink; zero without.
    pub fn fixed(&self) -> f64 {
        self.kinks.last().copied().unwrap_or(0.0)
    }

    /// Index of the part of a step from the fraction `start`.
    pub fn part(&self, start: f64) -> usize {
        self.kinks.partition_point(|kink| *kink <= start + NEAR)
    }

    /// Number of step k in its part, from 1.
    pub fn in_part(&self, k: usize) -> usize {
        match self.part(self.ends[k - 1]) {
            0 => k,
            part => {
                let kink = self.kinks[part - 1];
                k - self.ends.partition_point(|end| *end < kink - NEAR)
            }
        }
    }

    /// dt/dT at the fraction `at`.
    pub fn rate(&self, at: f64) -> f64 {
        let fixed = self.fixed();
        match at <= fixed {
            true => 0.0,
            false => (at - fixed) / (1.0 - fixed),
        }
    }

    /// dh/dT of a step from the fraction `start`, relative to its width.
    pub fn growth(&self, start: f64) -> f64 {
        match self.part(start) == self.kinks.len() {
            true => 1.0 / (1.0 - self.fixed()),
            false => 0.0,
        }
    }

    /// Time at the fraction `at`, if the motion lasts `duration` \[s\].
    pub fn time<S: Scalar>(&self, duration: S, at: f64) -> S {
        moved(duration, at, self.rate(at))
    }

    /// Size of a step of `width` from the fraction `start` \[s\].
    pub fn size<S: Scalar>(&self, duration: S, width: f64, start: f64) -> S {
        moved(duration, width, width * self.growth(start))
    }

    /// `count` intervals of equal size; with given steps equal between kinks, so that each end of one
    /// stays in its step.
    pub fn intervals(&self, count: usize) -> Intervals {
        if self.kinks.is_empty() || !self.is_equal() || count < self.equal.len() {
            return Intervals::equal(count);
        }
        let steps: usize = self.equal.iter().sum();
        let shares: Vec<f64> = self
            .equal
            .iter()
            .map(|&n| n as f64 / steps as f64)
            .collect();
        let counts = shared(count >> self.halvings, &shares).into_iter();
        let counts = counts.map(|few| few << self.halvings);
        Intervals::between(parts(&self.kinks).into_iter().zip(counts).collect())
    }

    /// The grid with these ends; `None` unless they ascend from 0 and only the last is 1 or more.
    pub fn from_ends(ends: Vec<f64>) -> Option<Self> {
        let rises = ends.windows(2).all(|pair| pair[0] < pair[1]);
        let whole = match &ends[..] {
            [first, .., before, last] => *first == 0.0 && *before < 1.0 && *last >= 1.0,
            [first, last] => *first == 0.0 && *last >= 1.0,
            _ => false,
        };
        let finite = ends.iter().all(|end| end.is_finite());
        (rises && whole && finite).then_some(Self {
            ends,
            ..Self::growing()
        })
    }

    /// Ends τ_0 … τ_N.
    pub fn ends(&self) -> &[f64] {
        &self.ends
    }

    /// Reserves memory for more steps.
    pub fn reserve(&mut self, steps: usize) {
        self.ends.reserve(steps);
    }

    /// Adds a step that ends at `end`.
    pub fn push(&mut self, end: f64) {
        self.ends.push(end);
    }

    /// Redundant rows that are left out in step k = 1 … N; `None` if they were not recorded, or if
    /// there are none.
    pub fn left_out(&self, k: usize) -> Option<&RedundantRows> {
        let from = self.left_out.iter().rev().find(|(from, _)| *from <= k);
        from.map(|(_, rows)| rows)
    }

    /// All changes of the redundant rows: first step, and rows.
    pub fn choices(&self) -> &[(usize, RedundantRows)] {
        &self.left_out
    }

    /// Records the redundant rows from the next step on, if they change.
    pub fn leave_out(&mut self, rows: &RedundantRows) {
        self.leave_out_from(self.steps() + 1, rows);
    }

    /// Records the redundant rows from step k on, in ascending order, if they change.
    pub fn leave_out_from(&mut self, k: usize, rows: &RedundantRows) {
        let known = self.left_out.last().map(|(_, rows)| rows);
        if !rows.is_empty() && known != Some(rows) {
            self.left_out.push((k, rows.clone()));
        }
    }

    /// Number of steps N.
    pub fn steps(&self) -> usize {
        self.ends.len() - 1
    }

    /// Length of step k = 1 … N.
    pub fn width(&self, k: usize) -> f64 {
        let part = self.part(self.ends[k - 1]);
        let Some(&count) = self.equal.get(part) else {
            return self.ends[k] - self.ends[k - 1];
        };
        let from = part.checked_sub(1).map_or(0.0, |before| self.kinks[before]);
        let end = self.kinks.get(part).copied().unwrap_or(1.0);
        (end - from) / count as f64
    }

    /// The grid with these numbers of cells.
    pub fn with_cells(mut self, cells: Vec<u32>) -> Self {
        self.cells = cells;
        self
    }

    /// Number of cells of every step; empty if each step has one.
    pub fn all_cells(&self) -> &[u32] {
        &self.cells
    }

    /// Number of cells of step k = 1 … N.
    pub fn cells(&self, k: usize) -> usize {
        self.cells.get(k - 1).map_or(1, |&cells| cells as usize)
    }

    /// Step k = 1 … N with its cells, up to the end of the motion.
    pub fn step(&self, k: usize) -> Step {
        Step {
            from: self.ends[k - 1],
            end: self.ends[k].min(1.0),
            cells: self.cells(k),
        }
    }

    /// The same steps with twice as many cells.
    pub fn with_double_cells(&self) -> Self {
        let cells = (1..=self.steps()).map(|k| 2 * self.cells(k) as u32);
        self.clone().with_cells(cells.collect())
    }

    /// The grid with every step halved; each half has as many cells.
    pub fn halved(&self) -> Self {
        if self.steps() == 0 {
            return self.clone();
        }
        let mut ends = vec![0.0];
        for pair in self.ends.windows(2) {
            ends.extend([0.5 * (pair[0] + pair[1]), pair[1]]);
        }
        let mut cells: Vec<u32> = self.cells.iter().flat_map(|&cells| [cells; 2]).collect();
        // A half that begins after the end of the motion is not needed.
        if ends[ends.len() - 2] >= 1.0 {
            ends.pop();
            cells.truncate(ends.len() - 1);
        }
        Self {
            ends,
            kinks: self.kinks.clone(),
            holds_kinks: self.holds_kinks,
            equal: self.equal.iter().map(|count| 2 * count).collect(),
            halvings: self.halvings + 1,
            cells,
            left_out: (self.left_out.iter())
                .map(|(step, rows)| (2 * step - 1, rows.clone()))
                .collect(),
        }
    }

    /// Steps of twice the size, each with the cells of both, if all have one size and their number is even.
    pub fn paired(&self) -> Option<Self> {
        let even = self.equal.len() == 1 && self.steps().is_multiple_of(2);
        even.then(|| self.doubled()).flatten()
    }

    /// The grid with every two steps in one, which has the cells of both; `None` if there is but one
    /// step, if steps end at kinks, or if redundant rows change.
    pub fn doubled(&self) -> Option<Self> {
        let steps = self.steps();
        if steps < 2 || !self.kinks.is_empty() || self.left_out.len() > 1 {
            return None;
        }
        let mut ends: Vec<f64> = self.ends.iter().copied().step_by(2).collect();
        let even = steps.is_multiple_of(2);
        if !even {
            ends.push(self.ends[steps]);
        }
        let pairs = self.cells.chunks(2).map(|pair| pair.iter().sum::<u32>());
        let halves = self.equal.iter().filter(|_| even).map(|count| count / 2);
        Some(Self {
            ends,
            equal: halves.collect(),
            halvings: 0,
            cells: pairs.collect(),
            ..self.clone()
        })
    }

    /// The last end so far.
    pub fn reached(&self) -> f64 {
        self.ends[self.ends.len() - 1]
    }
}

/// The part `part` of a duration T, which moves with it by `rate`.
fn moved<S: Scalar>(duration: S, part: f64, rate: f64) -> S {
    let real = duration.re();
    S::from(real * part) + (duration - S::from(real)) * rate
}

/// Position of a sample relative to the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SamplePlace {
    /// The end of step k (the start for k = 0).
    Node(usize),
    /// Inside step `step` ≥ 1 at the fraction θ of it.
    Inside {
        /// The step.
        step: usize,
        /// 0 < θ < 1.
        theta: f64,
    },
}

impl SamplePlace {
    /// The step that contains the sample, inside or at its end; 0 for the start.
    pub fn step(&self) -> usize {
        match *self {
            SamplePlace::Node(step) | SamplePlace::Inside { step, .. } => step,
        }
    }
}

/// Position of the fraction `at` in (τ_{k−1}, τ_k], in step k of the grid.
pub fn place(grid: &Grid, k: usize, at: f64) -> SamplePlace {
    let (start, end) = (grid.ends[k - 1], grid.ends[k]);
    if is_same(end, at) {
        SamplePlace::Node(k)
    } else {
        SamplePlace::Inside {
            step: k,
            theta: (at - start) / (end - start),
        }
    }
}
