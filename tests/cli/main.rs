//! The program `optimize`, run as a user runs it.

mod before_work;
mod beyond_one_run;
mod commands;
mod program;
mod restart;
mod several_starts;
