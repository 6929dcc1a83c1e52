//! Contact law, geometry, start state and load of a scene, for solvers in other languages.
//!
//! ```text
//!  job folder, scene file, text, preset ──open──> Law ─┬─ bodies, carriers, seats, masses, start
//!                                                      ├─ loads(states)      contact forces, without history
//!                                                      └─ load_torque(time)
//! ```
//! C interface for other languages: header `include/pinwheel_law.h`, library `libpinwheel_law` (`cargo build --release -p
//! pinwheel-law`). Use from Rust:
//!
//! ```
//! use pinwheel_law::Law;
//!
//! let mut law = Law::open("paper")?;
//! let mut loads = vec![0.0; 3 * law.bodies().len()];
//! let states = law.start().to_vec();
//! law.loads(&states, &mut loads)?;
//! assert_eq!((law.bodies().len(), law.calls()), (28, 1));
//! # Ok::<(), pinwheel_law::LawError>(())
//! ```

mod evaluator;
pub mod ffi;
pub mod job;
mod law;

pub use evaluator::{Evaluator, LOAD, STATE, numbers};
pub use law::{Body, CALLS_FILE, Carrier, JOB_FILE, Law, LawError};

/// Version of the C interface; changes when programs compiled against an older header would no longer work.
pub const ABI: u32 = 2;
