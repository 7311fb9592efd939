//! Trust-region sequential quadratic programming.

pub(crate) mod iteration;
pub(crate) mod run;
pub(crate) mod steering;
