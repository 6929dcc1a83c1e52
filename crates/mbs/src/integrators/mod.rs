//! Integrators of y' = f(t, y). Each method is one file and one row of the table below, from which [`METHODS`] and [`start`]
//! are made.
//!
//! All methods provide the state at any time inside the last step, so that samples never cut steps: the steps of a run do not
//! depend on what is recorded. Multistep methods, whose steps cost no more than a sample, end steps at samples instead
//! ([`Stepper::set_stop_time`]).
//!
//! Any y' = f(t, y) can be integrated, e.g. y' = -y with an error of 1e-8 per step:
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
mod imex_run;
mod rk4;
mod rodas5p;
pub(crate) mod rodas5p_coefficients;
mod segments;
mod weighted;

pub use dop853::Dop853;
pub use dopri5::Dopri5;
pub use etd_adams::EtdAdams;
pub use explicit::{FixedStep, Tableau};
pub use imex_run::Imex;
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
    /// Relative error per step of adaptive methods.
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

/// Reason why no further step can be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum StepError {
    /// The state or its derivative is not finite.
    #[error("the state is no longer finite at t = {time:.6} s")]
    NotFinite {
        /// Time, s.
        time: f64,
    },
    /// An adaptive method cannot meet its tolerance.
    #[error("the step fell below rounding at t = {time:.6} s: the tolerance cannot be met")]
    StepTooSmall {
        /// Time, s.
        time: f64,
    },
}

/// Returns an error if a number is not finite, at `time`, s.
fn check_finite(parts: &[&[f64]], time: f64) -> Result<(), StepError> {
    // All numbers are checked, because without an early exit the check processes several at a time.
    let finite = |part: &&[f64]| part.iter().fold(true, |all, x| all & x.is_finite());
    if parts.iter().all(finite) {
        Ok(())
    } else {
        Err(StepError::NotFinite { time })
    }
}

/// State of a method during a run.
pub trait Stepper: Send {
    /// Makes one accepted step.
    ///
    /// # Errors
    /// See [`StepError`]; the state stays the last accepted one.
    fn step(&mut self, system: &mut dyn OdeSystem) -> Result<(), StepError>;
    /// Returns the end of the last accepted step, s.
    fn time(&self) -> f64;
    /// Returns the state at the end of the last accepted step.
    fn state(&self) -> &[f64];
    /// Returns the length of the next step to try, s.
    fn next_step(&self) -> f64;
    /// Bounds the next step by `longest`, s, where the method chooses its steps; no effect on others.
    fn shorten(&mut self, _longest: f64) {}
    /// Announces the time (s) of the next requested state. Methods whose step takes a single evaluation end a step there, so that
    /// step and sample share it. Other methods ignore it.
    fn set_stop_time(&mut self, _time: f64) {}
    /// Writes the state at `t`, which lies inside the last accepted step.
    fn interpolate(&mut self, system: &mut dyn OdeSystem, t: f64, y: &mut [f64]);
    /// Returns the state at the end of the last accepted step, if it is the last at which f was evaluated
    /// ([`OdeSystem::derivative_at_end`]).
    fn evaluated_state(&self) -> Option<&[f64]> {
        None
    }
    /// Returns the counts so far.
    fn counts(&self) -> StepCounts;
    /// Returns all data that the next steps depend on, to the bit. The bytes are for the same program; their format may change.
    fn save(&self) -> Vec<u8>;
    /// Restores [saved](Self::save) data of a run of the same method, settings and system. Returns false, without a change, if
    /// the bytes do not belong to it.
    fn restore(&mut self, bytes: &[u8]) -> bool;
}

/// Returns all fields of a method as bytes that can be read back.
fn saved(method: &impl Serialize) -> Vec<u8> {
    postcard::to_allocvec(method).unwrap_or_default()
}

fn restored<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    postcard::from_bytes(bytes).ok()
}

/// Way in which a method uses f.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// Evaluates f only.
    Explicit,
    /// Treats the stiff part of [`OdeSystem::split_stage`], friction, implicitly.
    SplitImplicit,
    /// Solves with the Jacobian of f.
    Rosenbrock,
    /// Integrates the linear part of f exactly, by the Jacobian.
    Exponential,
}

/// Data of a method, for users and for step control.
#[derive(Debug, Clone, Copy)]
pub struct MethodInfo {
    /// Name in scenes.
    pub name: &'static str,
    /// Summary in one line.
    pub summary: &'static str,
    /// Classical order.
    pub order: u32,
    /// Way in which the method uses f.
    pub family: Family,
    /// True if the step follows from a tolerance.
    pub adaptive: bool,
    /// Error that runs at different tolerances may share, so that their differences do not reveal it: relative error of a
    /// quantity over the finest tolerance. 0 for a fixed step.
    pub shared_error: f64,
    /// Exponent with which steps grow with the tolerance.
    pub step_power: f64,
    /// Tolerance suitable as a first choice for any scene.
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
/// Near rest stability bounds the step at any tolerance, and all runs have equal errors: 5e-10 at a tolerance of 5e-7, where
/// their differences were 1.5e-10.
const ADAPTIVE: MethodInfo = MethodInfo {
    adaptive: true,
    shared_error: UNSEEN,
    step_power: 0.2,
    ..FIXED
};

/// [`MethodInfo::shared_error`] of methods with error control.
pub const UNSEEN: f64 = 2e-3;

/// Returns the method with the name `name`.
pub fn method(name: &str) -> Option<&'static MethodInfo> {
    METHODS.iter().find(|method| method.name == name)
}

/// Table of all methods. A row has a module with its `INFO`, the facts for users, and the constructor of a run.
macro_rules! methods {
    (|$settings:ident, $t:ident, $y:ident| $($module:ident => $begin:expr,)*) => {
        /// All methods.
        pub const METHODS: &[MethodInfo] = &[$($module::INFO),*];

        /// Starts the method `name` at (t, y); `None` if there is no such method.
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
    imex => Imex::fixed(settings.step, t, y),
    imex_adaptive => Imex::adaptive(settings.step, settings.tolerance, t, y),
    rodas5p => Rodas5p::new(settings.step, settings.tolerance, t, y),
}

/// Truncates a step to its first seven binary digits, by less than 1.6 %.
///
/// An error estimate is a difference of nearly equal numbers, with a relative rounding error of 1e-8 instead of 1e-16. Steps
/// computed from it to the last digit differ between processors. Each contact that opens or closes within a step amplifies the
/// difference, and after some hundred steps two runs differ by a large part of their error. Truncation absorbs the rounding, so
/// that all processors take equal steps.
pub(crate) fn short_step(h: f64) -> f64 {
    f64::from_bits(h.to_bits() & !((1 << 46) - 1))
}
