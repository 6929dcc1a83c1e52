//! The tests of this crate as one program: linking is most of what a small test costs.

mod balances;
mod channels;
mod common;
mod derivatives;
mod deviations;
mod exponential;
mod floating;
mod guard;
mod kernels;
mod native_forms;
mod published_energy;
mod published_statics;
mod published_stiffness;
mod resolve;
mod rosenbrock;
mod sliding;
