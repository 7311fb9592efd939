//! Ends of steps and positions of samples, as fractions of the duration.

use super::quadrature::{Step, is_same};
use crate::system::RedundantRows;

/// Ends of the steps as fractions τ_0 = 0 < τ_1 < … < τ_N of the duration T, so that t_k = τ_k T
/// depends only on the duration. τ_N is 1, or larger if the motion ends too close to a singular
/// position for a step to end there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    ends: Vec<f64>,
    /// Width of every step if all are equal, without the round-off of their ends.
    equal: Option<f64>,
    /// Number of cells of each step for sums over the motion (see
    /// [`quadrature`](super::quadrature)); one per step if empty.
    cells: Vec<u32>,
    /// Redundant rows that are left out, each from a given step on.
    left_out: Vec<(usize, RedundantRows)>,
}

impl Grid {
    /// `steps` steps of equal size.
    pub(crate) fn uniform(steps: usize) -> Self {
        Self {
            ends: (0..=steps).map(|k| k as f64 / steps as f64).collect(),
            equal: Some(1.0 / steps as f64),
            cells: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// A grid that grows step by step from 0.
    pub(crate) fn growing() -> Self {
        Self::growing_from(0.0)
    }

    /// An empty grid that grows from the fraction `start`, for a part of a motion.
    pub(crate) fn growing_from(start: f64) -> Self {
        Self {
            ends: vec![start],
            equal: None,
            cells: Vec::new(),
            left_out: Vec::new(),
        }
    }

    /// An empty grid that will grow to this one.
    pub(crate) fn to_grow(&self) -> Self {
        Self {
            ends: vec![0.0],
            equal: self.equal,
            cells: self.cells.clone(),
            left_out: Vec::new(),
        }
    }

    /// The grid with these ends; `None` unless they ascend from 0 and only the last is 1 or more.
    pub(crate) fn from_ends(ends: Vec<f64>) -> Option<Self> {
        let rises = ends.windows(2).all(|pair| pair[0] < pair[1]);
        let whole = match &ends[..] {
            [first, .., before, last] => *first == 0.0 && *before < 1.0 && *last >= 1.0,
            [first, last] => *first == 0.0 && *last >= 1.0,
            _ => false,
        };
        let finite = ends.iter().all(|end| end.is_finite());
        (rises && whole && finite).then_some(Self {
            ends,
            equal: None,
            cells: Vec::new(),
            left_out: Vec::new(),
        })
    }

    /// Ends τ_0 … τ_N.
    pub(crate) fn ends(&self) -> &[f64] {
        &self.ends
    }

    /// Reserves memory for more steps.
    pub(crate) fn reserve(&mut self, steps: usize) {
        self.ends.reserve(steps);
    }

    /// Adds a step that ends at `end`.
    pub(crate) fn push(&mut self, end: f64) {
        self.ends.push(end);
    }

    /// Redundant rows that are left out in step k = 1 … N; `None` if they were not recorded, or if
    /// there are none.
    pub(crate) fn left_out(&self, k: usize) -> Option<&RedundantRows> {
        let from = self.left_out.iter().rev().find(|(from, _)| *from <= k);
        from.map(|(_, rows)| rows)
    }

    /// All changes of the redundant rows: first step, and rows.
    pub(crate) fn choices(&self) -> &[(usize, RedundantRows)] {
        &self.left_out
    }

    /// Records the redundant rows from the next step on, if they change.
    pub(crate) fn leave_out(&mut self, rows: &RedundantRows) {
        self.leave_out_from(self.steps() + 1, rows);
    }

    /// Records the redundant rows from step k on, in ascending order, if they change.
    pub(crate) fn leave_out_from(&mut self, k: usize, rows: &RedundantRows) {
        let known = self.left_out.last().map(|(_, rows)| rows);
        if !rows.is_empty() && known != Some(rows) {
            self.left_out.push((k, rows.clone()));
        }
    }

    /// Number of steps N.
    pub(crate) fn steps(&self) -> usize {
        self.ends.len() - 1
    }

    /// Length of step k = 1 … N.
    pub(crate) fn width(&self, k: usize) -> f64 {
        self.equal
            .unwrap_or_else(|| self.ends[k] - self.ends[k - 1])
    }

    /// The grid with these numbers of cells.
    pub(crate) fn with_cells(mut self, cells: Vec<u32>) -> Self {
        self.cells = cells;
        self
    }

    /// Number of cells of every step; empty if each step has one.
    pub(crate) fn all_cells(&self) -> &[u32] {
        &self.cells
    }

    /// Number of cells of step k = 1 … N.
    pub(crate) fn cells(&self, k: usize) -> usize {
        self.cells.get(k - 1).map_or(1, |&cells| cells as usize)
    }

    /// Step k = 1 … N with its cells, up to the end of the motion.
    pub(crate) fn step(&self, k: usize) -> Step {
        Step {
            from: self.ends[k - 1],
            end: self.ends[k].min(1.0),
            cells: self.cells(k),
        }
    }

    /// The same steps with twice as many cells.
    pub(crate) fn with_double_cells(&self) -> Self {
        let cells = (1..=self.steps()).map(|k| 2 * self.cells(k) as u32);
        self.clone().with_cells(cells.collect())
    }

    /// The grid with every step halved; each half has as many cells.
    pub(crate) fn halved(&self) -> Self {
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
            equal: self.equal.map(|width| 0.5 * width),
            cells,
            left_out: (self.left_out.iter())
                .map(|(step, rows)| (2 * step - 1, rows.clone()))
                .collect(),
        }
    }

    /// The grid with every two steps in one, which has the cells of both; `None` if there is but one
    /// step, or if redundant rows change.
    pub(crate) fn doubled(&self) -> Option<Self> {
        let steps = self.steps();
        if steps < 2 || self.left_out.len() > 1 {
            return None;
        }
        let last = self.ends[steps];
        let mut ends: Vec<f64> = self.ends.iter().copied().step_by(2).collect();
        if !steps.is_multiple_of(2) {
            ends.push(last);
        }
        let pairs = self.cells.chunks(2).map(|pair| pair.iter().sum::<u32>());
        Some(Self {
            ends,
            equal: self
                .equal
                .filter(|_| steps.is_multiple_of(2))
                .map(|width| 2.0 * width),
            cells: pairs.collect(),
            left_out: self.left_out.clone(),
        })
    }

    /// The last end so far.
    pub(crate) fn reached(&self) -> f64 {
        self.ends[self.ends.len() - 1]
    }
}

/// Position of a sample relative to the steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SamplePlace {
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
    pub(crate) fn step(&self) -> usize {
        match *self {
            SamplePlace::Node(step) | SamplePlace::Inside { step, .. } => step,
        }
    }
}

/// Position of the fraction `at` in (τ_{k−1}, τ_k], in step k of the grid.
pub(crate) fn place(grid: &Grid, k: usize, at: f64) -> SamplePlace {
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
