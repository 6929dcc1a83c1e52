//! Tests of engines, in one program.

#[cfg(feature = "rapier")]
mod colliders;
#[cfg(feature = "rapier")]
mod contact_hook;
mod control;
#[cfg(feature = "crossval")]
mod environment;
#[cfg(unix)]
mod external;
#[cfg(feature = "python")]
#[allow(unsafe_code, reason = "called as C programs call it")]
mod ffi;
mod kept;
mod known;
mod log;
mod manifest;
#[cfg(feature = "rapier")]
mod march;
mod native;
#[cfg(feature = "rapier")]
mod outlines;
#[cfg(unix)]
mod process;
mod recorded;
mod spring;
#[cfg(feature = "rapier")]
mod sums;
#[cfg(feature = "rapier")]
mod world;
