//! Trusted solvers that come through the protocol, as a user's own would: Simbody and SUNDIALS IDA.
//!
//! Their programs are in the folder `solvers/` and embedded here. At the first use Simbody's is compiled by the system's C++
//! compiler and IDA gets a Python environment of its own; both are kept in the user's cache folder.

mod cards;
#[cfg(feature = "crossval")]
mod ida;
#[cfg(feature = "crossval")]
mod ready;
#[cfg(feature = "crossval")]
mod shipped;
#[cfg(feature = "crossval")]
mod simbody;

pub(crate) use cards::CARDS;
#[cfg(feature = "crossval")]
pub(crate) use shipped::engines;
