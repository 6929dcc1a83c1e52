//! Planar multibody systems, independent of gears: bodies, revolutes, drivers, the saddle-point system and integrators.
//!
//! ```text
//!                        ┌─> Lagrange  all coordinates, multipliers (saddle point) ─┐
//!  Mechanism + Forces ───┤                                                          ├─> OdeSystem ─> integrators
//!                        └─> Reduced   centre-pinned bodies eliminated exactly ─────┘   f, Jacobian    steps, segments
//! ```
//!
//! A [`Mechanism`] is data. [`Lagrange`] and [`Reduced`] convert it to an [`OdeSystem`] under applied [`Forces`]; the
//! [`integrators`] advance any such system.
//!
//! A rod of 1 m, pinned at its end, falls from the horizontal; at the bottom its rate is sqrt(3 g/l):
//!
//! ```
//! use pinwheel_mbs::integrators::{StepSettings, start};
//! use pinwheel_mbs::{
//!     Body, BodyState, Detail, Forces, Formulation, Lagrange, Mechanism, Revolute, Stabilisation, Wrench,
//! };
//!
//! struct Weight;
//! impl Forces for Weight {
//!     fn apply(&mut self, _time: f64, _bodies: &[BodyState], loads: &mut [Wrench]) {
//!         loads[0].fy -= 3.0 * 9.81;
//!     }
//! }
//!
//! let start_at = BodyState { x: 0.5, ..BodyState::default() };
//! let rod = Body { name: "rod".into(), mass: 3.0, moment: 0.25, start: start_at };
//! let pin = Revolute { parent: None, parent_point: [0.0; 2], child: 0, child_point: [-0.5, 0.0] };
//! let mechanism = Mechanism { bodies: vec![rod], revolutes: vec![pin], drivers: vec![] };
//! let mut system = Lagrange::new(mechanism, Weight, Stabilisation::Projection)?;
//!
//! let settings = StepSettings { step: 1e-3, tolerance: 1e-9 };
//! let mut stepper = start("dopri5", settings, 0.0, &system.initial()).ok_or("no such method")?;
//! let mut fastest = 0.0_f64;
//! for _ in 0..200 {
//!     stepper.step(&mut system)?;
//!     fastest = fastest.max(system.observe(stepper.time(), stepper.state(), Detail::Everything).bodies[0].rate.abs());
//! }
//! assert!((fastest - (3.0_f64 * 9.81).sqrt()).abs() < 1e-2, "{fastest} rad/s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod differences;
mod forces;
pub mod integrators;
mod jacobian;
mod lagrange;
mod lu;
mod mechanism;
mod ode;
mod pinned;
mod reduced;
mod saddle;
pub mod sliding;
mod state;
mod tree;

pub use forces::{Coordinates, Derivatives, Evaluation, Forces, Pose};
pub use jacobian::{Arrow, Jacobian, Structure, Variable};
pub use lagrange::{Lagrange, Stabilisation};
pub use mechanism::{Body, Driver, Mechanism, MechanismError, Motion, Revolute};
pub use ode::{Detail, ErrorScales, Formulation, Observation, OdeSystem};
pub use pinned::PinnedContacts;
pub use reduced::Reduced;
pub use saddle::SaddlePoint;
pub use state::{BodyId, BodyState, ContactEnergy, Wrench, add_pair};

/// Private items for the tests of this crate; not part of the interface.
#[doc(hidden)]
pub mod internals {
    pub use crate::integrators::etd_adams::columns::{Columns, ROWS, padded};
    pub use crate::integrators::etd_adams::history::{step_back, to_differences};
    pub use crate::integrators::etd_adams::propagator::{Linear, Propagator};
    pub use crate::integrators::rodas5p_coefficients::{A, C, D, GAMMA, H, STAGES, TIMES};
    pub use crate::lu::Lu;
    pub use crate::saddle::constraint_inverse;
}
