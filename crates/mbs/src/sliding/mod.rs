//! Implicit friction of contacts as a convex minimisation.
//!
//! For given normal forces and positions, implicit Euler for regularised Coulomb friction is the optimality condition of a
//! strictly convex function of the velocities. Newton's method converges to its only solution from any start. The stiffness of
//! the friction (1e6 1/s and more on a light pin) does not limit the step.

mod arrowhead;
mod contact;
mod problem;
mod stage;

pub use arrowhead::Arrowhead;
pub use contact::{Contact, Row};
pub use problem::{SlidingProblem, Slip};
pub use stage::SlidingStage;
