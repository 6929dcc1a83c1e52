//! Trusted solvers that come through the protocol, as a user's own would: Simbody and SUNDIALS IDA.
//!
//! Their programs are in the folder `solvers/` and embedded here. At the first use Simbody's is compiled by the system's C++
//! compiler and IDA gets a Python environment of its own; both are kept in the user's cache folder.

mod ida;
mod ready;
mod shipped;
mod simbody;

pub(crate) use ida::REQUIREMENTS as IDA;
pub(crate) use shipped::engine;
pub(crate) use simbody::needs as simbody_needs;
