//! Processes that compute one motion together, called ranks.
//!
//! Every rank makes the same calls with the same numbers. What is dear is divided: each rank does its share and gives the
//! result to all, which go on with the same bits, whatever their number.

use super::packed::Packed;
use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

/// A way between ranks.
pub trait Gather: Debug + Send + Sync {
    /// The number of this rank, from 0.
    fn rank(&self) -> usize;

    /// How many there are.
    fn ranks(&self) -> usize;

    /// Gives numbers to all ranks and returns those of all, in the order of ranks. All ranks make the same calls in the
    /// same order.
    fn gather(&self, own: &[f64]) -> Vec<f64>;
}

/// The ranks of a motion; by default one process alone.
#[derive(Clone, Debug, Default)]
pub struct Team(Option<Arc<dyn Gather>>);

impl Team {
    /// The ranks of a way between them.
    pub fn of(way: Arc<dyn Gather>) -> Self {
        Self(Some(way).filter(|way| way.ranks() > 1))
    }

    /// Whether there is one process alone.
    pub fn is_alone(&self) -> bool {
        self.0.is_none()
    }

    /// How many ranks there are.
    pub fn ranks(&self) -> usize {
        self.0.as_ref().map_or(1, |way| way.ranks())
    }

    /// The number of this rank.
    pub fn rank(&self) -> usize {
        self.0.as_ref().map_or(0, |way| way.rank())
    }

    /// The share of this rank in some work of equal parts.
    pub fn share(&self, parts: Range<usize>) -> Range<usize> {
        let (rank, ranks) = (self.rank(), self.ranks());
        let at = |rank: usize| parts.start + parts.len() * rank / ranks;
        at(rank)..at(rank + 1)
    }

    /// Gives what this rank has made to all, and returns what all have made, in the order of ranks.
    pub fn gather<T: Packed>(&self, own: impl IntoIterator<Item = T>) -> Vec<T> {
        let Some(way) = &self.0 else {
            return own.into_iter().collect();
        };
        let mut numbers = Vec::new();
        own.into_iter().for_each(|own| own.pack(&mut numbers));
        let all = way.gather(&numbers);
        let (mut rest, mut out) = (&all[..], Vec::new());
        while !rest.is_empty() {
            out.push(T::unpack(&mut rest));
        }
        out
    }

    /// Two pieces of work, side by side on the threads of one process. Several ranks exchange numbers in both, so one comes
    /// after the other.
    pub fn join<A: Send, B: Send>(
        &self,
        one: impl FnOnce() -> A + Send,
        other: impl FnOnce() -> B + Send,
    ) -> (A, B) {
        match self.is_alone() {
            true => rayon::join(one, other),
            false => (one(), other()),
        }
    }
}
