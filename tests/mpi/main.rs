//! `optimize-mpi` over several ranks: the same results as those of one process, and the end of all if one ends.
//!
//! `cargo test --release --features mpi --test mpi` needs `mpirun` of Open MPI. The ranks share the cores of this machine.

mod ends;
mod program;
mod same_results;
