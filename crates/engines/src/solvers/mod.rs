//! Trusted solvers that use the protocol of users' solvers: Simbody and SUNDIALS IDA.
//!
//! Their programs are in the folder `solvers/` and embedded here. At first use Simbody's is compiled by the system's C++
//! compiler, and IDA gets its own Python environment; both are stored in the user's cache folder.

mod ida;
mod ready;
mod shipped;
mod simbody;

pub(crate) use shipped::{engine, needs};
