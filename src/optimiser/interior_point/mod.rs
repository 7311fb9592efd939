//! Primal–dual interior point (Wächter & Biegler 2006).

pub(crate) mod barrier;
pub(crate) mod direction;
pub(crate) mod filter;
pub(crate) mod iterate;
pub(crate) mod iteration;
pub(crate) mod line_search;
pub(crate) mod restoration;
pub(crate) mod run;
pub(crate) mod verdict;
