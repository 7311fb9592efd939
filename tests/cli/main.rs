//! The program `optimize`, as a user runs it.

mod before_work;
mod beyond_one_run;
mod cases;
mod commands;
mod gallery;
mod installation;
mod memory;
mod modes;
mod names;
mod parameters;
mod program;
mod report;
mod restart;
mod results_are_kept;
mod several_starts;
mod stability;
mod starters;
mod statics;
mod tutorials;
mod verdicts;
mod work_precision;
