//! First stage of a solver that differs from the native one.
//!
//! Each stage is judged at the solver's own states, so that it inherits no error of an earlier stage.
//!
//! ```text
//! law, assembly, driver   F_A(t_n) - F(s_A(t_n))                columns against the native ones at the run's own state
//! equations, integration  d_n = s_A(t_n+1) - Phi(s_A(t_n))      Phi: converged native flow over one interval
//! ```
//! The part of d_n that falls with the step of a second run is the integration error; the rest is an error of the equations.
//! A cause is a suspected change p of the model that explains the residual r: least squares of r on dF/dp or dPhi/dp by
//! Gauss-Newton, confirmed by a native run with p. All equally good causes are named.
//!
//! Sources: defect of one step, Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, 1993, II.3; defect
//! correction, Stetter, Numer. Math. 29 (1978) 425.

mod cause;
mod designs;
mod engine;
mod fit;
mod forces;
mod judged;
mod kept;
mod locate;
mod model;
mod motion;
mod pairs;
mod pictures;
mod states;
mod suspects;

pub use cause::{Cause, Part};
pub use designs::{Course, between};
pub use engine::of_engine;
pub use judged::{Judged, Stage};
pub(crate) use kept::{Kept, of_kept};
pub use locate::{Located, Runs, locate};
pub use pairs::of_comparison;
pub use pictures::{Over, Picture};
