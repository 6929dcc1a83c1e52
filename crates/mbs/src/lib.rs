//! Planar multibody systems: bodies, revolutes, drivers, the saddle-point system and
//! integrators. Knows nothing of gears.

mod state;

pub use state::{BodyState, Wrench};
