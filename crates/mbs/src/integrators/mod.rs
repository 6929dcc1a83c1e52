//! Integrators of y' = f(t, y). Each method is one file and one row of the table below, which [`METHODS`] and [`start`]
//! are made of.
//!
//! All methods hand out the state at any time inside the last step, so that samples never cut
//! steps: a run takes the same steps whatever is recorded. Multistep methods, whose steps cost no more than a sample, end
//! steps at samples instead ([`Stepper::set_stop_time`]).
//!
//! Any y' = f(t, y) can be integrated. Here y' = -y, to 1e-8 a step:
//!
//! ```
//! use pinwheel_mbs::OdeSystem;
//! use pinwheel_mbs::integrators::{StepSettings, start};
//!
//! struct Decay;
//! impl OdeSystem for Decay {
//!     fn dimension(&self) -> usize {
//!         1
//!     }
//!     fn derivative(&mut self, _t: f64, y: &[f64], dydt: &mut [f64]) {
//!         dydt[0] = -y[0];
//!     }
//! }
//!
//! let settings = StepSettings { step: 1e-2, tolerance: 1e-8 };
//! let mut stepper = start("dop853", settings, 0.0, &[1.0]).ok_or("no such method")?;
//! loop {
//!     stepper.step(&mut Decay)?;
//!     if stepper.time() > 1.0 {
//!         break;
//!     }
//! }
//! let mut y = [0.0];
//! stepper.interpolate(&mut Decay, 1.0, &mut y);
//! assert!((y[0] - (-1.0_f64).exp()).abs() < 1e-7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod clock;
mod dop853;
mod dop853_coefficients;
mod dopri5;
pub(crate) mod etd_adams;
mod explicit;
mod heun;
mod imex;
mod imex_adaptive;
mod rk4;
mod rodas5p;
pub(crate) mod rodas5p_coefficients;
mod segments;
mod weighted;

pub use dop853::Dop853;
pub use dopri5::Dopri5;
pub use etd_adams::EtdAdams;
pub use explicit::{FixedStep, Tableau};
pub use imex::ImexFixed;
pub use imex_adaptive::ImexAdaptive;
pub use rodas5p::Rodas5p;
pub use segments::Segments;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::OdeSystem;

/// Settings a method may use.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepSettings {
    /// Step of fixed-step methods; first step of adaptive ones, s.
    pub step: f64,
    /// Relative error a step of adaptive methods.
    pub tolerance: f64,
}

/// Work of a run of steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct StepCounts {
    /// Accepted steps.
    pub steps: u64,
    /// Rejected steps.
    pub rejected: u64,
    /// Evaluations of f, those for differences included.
    pub evaluations: u64,
    /// Jacobians, whether the system's own or by differences.
    pub jacobians: u64,
}

impl std::ops::Add for StepCounts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            rejected: self.rejected + other.rejected,
            evaluations: self.evaluations + other.evaluations,
            jacobians: self.jacobians + other.jacobians,
        }
    }
}

/// Why no further step can be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The state or its derivative is not finite.
    #[error("the state is no longer finite at t = {time} s")]
    NotFinite {
        /// Where, s.
        time: f64,
    },
    /// An adaptive method cannot meet its tolerance.
    #[error("the step fell below rounding at t = {time} s: the tolerance cannot be met")]
    StepTooSmall {
        /// Where, s.
        time: f64,
    },
}

/// Refuses numbers that are not finite, at `time`, s.
fn check_finite(parts: &[&[f64]], time: f64) -> Result<(), StepError> {
    // All of them: without a way out early the check takes several at a time.
    let finite = |part: &&[f64]| part.iter().fold(true, |all, x| all & x.is_finite());
    if parts.iter().all(finite) {
        Ok(())
    } else {
        Err(StepError::NotFinite { time })
    }
}

/// A method in the course of a run.
pub trait Stepper: Send {
    /// One accepted step.
    ///
    /// # Errors
    /// See [`StepError`]; the state stays the last accepted one.
    fn step(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError>;
    /// End of the last accepted step, s.
    fn time(&self) -> f64;
    /// State there.
    fn state(&self) -> &[f64];
    /// Length of the next step to try, s.
    fn next_step(&self) -> f64;
    /// Lets the next step be no longer than `longest`, s, where the method chooses it; else nothing happens.
    fn shorten(&mut self, _longest: f64) {}
    /// The state at `time` (s) will be asked for next. Methods whose step takes a single evaluation end one there: the sample
    /// needs an evaluation anyway, and both share it. All others go on as they would.
    fn set_stop_time(&mut self, _time: f64) {}
    /// Writes the state at `t`, which lies inside the last accepted step.
    fn interpolate(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]);
    /// The state at the end of the last accepted step, if f was evaluated of it last
    /// ([`OdeSystem::derivative_at_end`]).
    fn evaluated_state(&self) -> Option<&[f64]> {
        None
    }
    /// Counts so far.
    fn counts(&self) -> StepCounts;
    /// Everything that the next steps depend on, to the bit. Made for the same program; no format to keep.
    fn save(&self) -> Vec<u8>;
    /// Goes back to what was [saved](Self::save) of a run of the same method, settings and system. False: these bytes are of
    /// something else, and nothing has changed.
    fn restore(&mut self, bytes: &[u8]) -> bool;
}

/// All fields of a method; nothing that could not be read back.
fn saved(method: &impl Serialize) -> Vec<u8> {
    postcard::to_allocvec(method).unwrap_or_default()
}

fn restored<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    postcard::from_bytes(bytes).ok()
}

/// Way in which a method uses f.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Evaluates it.
    Explicit,
    /// Treats what [`OdeSystem::split_stage`] knows, friction, implicitly.
    SplitImplicit,
    /// Solves with its Jacobian.
    Rosenbrock,
    /// Is exact for its linear part, by the Jacobian.
    Exponential,
}

/// A method as listed for users, with all that others need to know of it.
#[derive(Debug, Clone, Copy)]
pub struct MethodInfo {
    /// Name in scenes.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// Classical order.
    pub order: u32,
    /// Way in which the method uses f.
    pub family: Family,
    /// True if the step follows from a tolerance.
    pub adaptive: bool,
    /// Error that runs at different tolerances may share, so that their differences do not show it: a share of the finest
    /// tolerance, relative to the quantity. 0 for a fixed step.
    pub shared_error: f64,
    /// Steps from a tolerance grow with this power of it.
    pub step_power: f64,
    /// A tolerance that any scene can be tried with.
    pub usual_tolerance: f64,
}

/// Common facts of methods with a fixed step.
const FIXED: MethodInfo = MethodInfo {
    name: "",
    summary: "",
    order: 1,
    family: Family::Explicit,
    adaptive: false,
    shared_error: 0.0,
    step_power: 0.0,
    usual_tolerance: 1e-6,
};

/// Common facts of methods whose steps follow from the tolerance of a step.
///
/// Near rest the step is bounded by stability, whatever the tolerance, and all runs err alike: by 5e-10 at 5e-7 where their
/// differences said 1.5e-10.
const ADAPTIVE: MethodInfo = MethodInfo {
    adaptive: true,
    shared_error: UNSEEN,
    step_power: 0.2,
    ..FIXED
};

/// [`MethodInfo::shared_error`] of error control.
pub const UNSEEN: f64 = 2e-3;

/// The method of this name.
#[must_use]
pub fn method(name: &str) -> Option<&'static MethodInfo> {
    METHODS.iter().find(|method| method.name == name)
}

/// Table of all methods. A row is a module with its `INFO`, the facts for users, and the constructor of a run.
macro_rules! methods {
    (|$settings:ident, $t:ident, $y:ident| $($module:ident => $begin:expr,)*) => {
        /// All methods.
        pub const METHODS: &[MethodInfo] = &[$($module::INFO),*];

        /// Starts the method `name` at (t, y). `None`: no such method.
        #[must_use]
        pub fn start(
            name: &str,
            $settings: StepSettings,
            $t: f64,
            $y: &[f64],
        ) -> Option<Box<dyn Stepper>> {
            $(if name == $module::INFO.name {
                return Some(Box::new($begin));
            })*
            None
        }
    };
}

methods! { |settings, t, y|
    heun => FixedStep::new(&heun::TABLEAU, settings.step, t, y),
    rk4 => FixedStep::new(&rk4::TABLEAU, settings.step, t, y),
    dopri5 => Dopri5::new(settings.step, settings.tolerance, t, y),
    dop853 => Dop853::new(settings.step, settings.tolerance, t, y),
    etd_adams => EtdAdams::new(settings.step, settings.tolerance, t, y),
    imex => ImexFixed::new(settings.step, t, y),
    imex_adaptive => ImexAdaptive::new(settings.step, settings.tolerance, t, y),
    rodas5p => Rodas5p::new(settings.step, settings.tolerance, t, y),
}

/// A step cut to its first seven binary digits, by less than 1.6 %.
///
/// An error estimate is a difference of nearly equal numbers: its roundings are not 1e-16 but 1e-8 of it. Steps
/// computed from it to the last digit differ from one processor to the next, each contact that opens or closes
/// within a step amplifies the difference, and after some hundred steps two runs differ by a good part of their
/// error. Short steps absorb these roundings, so that all processors take the same ones.
pub(crate) fn short_step(h: f64) -> f64 {
    f64::from_bits(h.to_bits() & !((1 << 46) - 1))
}
