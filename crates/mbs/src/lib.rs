//! Planar multibody systems: bodies, revolutes, drivers, the saddle-point system and
//! integrators. Knows nothing of gears.
//!
//! ```text
//!                        ┌─> Lagrange  all coordinates, multipliers (saddle point) ─┐
//!  Mechanism + Forces ───┤                                                          ├─> OdeSystem ─> integrators
//!                        └─> Reduced   centre-pinned bodies eliminated exactly ─────┘   f, Jacobian    steps, legs
//! ```
//!
//! A [`Mechanism`] is data. [`Lagrange`] and [`Reduced`] turn it into an [`OdeSystem`] under
//! applied [`Forces`]; the [`integrators`] advance any such system.

pub mod benchmarks;
mod differences;
pub mod elements;
mod forces;
pub mod integrators;
mod jacobian;
mod lagrange;
mod lu;
mod mechanism;
mod ode;
mod reduced;
mod saddle;
pub mod sliding;
mod state;
mod tree;

pub use forces::Forces;
pub use jacobian::{Arrow, Jacobian, Structure};
pub use lagrange::{Lagrange, Stabilisation};
pub use mechanism::{Body, Driver, Mechanism, MechanismError, Motion, Revolute};
pub use ode::{ErrorScales, Formulation, Observation, OdeSystem};
pub use reduced::Reduced;
pub use saddle::SaddlePoint;
pub use state::{BodyId, BodyState, ContactEnergy, Wrench};
