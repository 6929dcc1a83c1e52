//! Which stage of a solver differs: each judged at the solver's own states, so that no stage inherits an earlier error.
//!
//! ```text
//! law, assembly, driver   F_A(t_n) - F(s_A(t_n))                columns against the native ones at the run's own state
//! equations, integration  d_n = s_A(t_n+1) - Phi(s_A(t_n))      Phi: converged native flow over one interval
//! ```
//! The part of d_n that falls with the run's step is integration, as a second run at a smaller step shows; the rest is equations.
//! A cause is a suspected change p of the model that explains the residual r: least squares of r on dF/dp or dPhi/dp, by
//! Gauss-Newton, and a native run with it. All that explain as much are named.
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
