//! Why a scene cannot be modelled.

use pinwheel_scene::Fault;

/// Why a checked scene still cannot be modelled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GearboxError {
    /// No such curve or channel, or contacts that the detection cannot give.
    #[error("{0}")]
    Geometry(String),
    /// No such law.
    #[error("no contact law `{0}`")]
    UnknownLaw(String),
    /// Too few points for the pits.
    #[error(
        "contact.wheel_points = {wheel_points} is too coarse for the pits of this profile: the circle through three \
         neighbouring points is smaller than the pin; use more points"
    )]
    TooFewPoints {
        /// The scene's value.
        wheel_points: usize,
    },
    /// The mechanism cannot be solved.
    #[error(transparent)]
    Mechanism(#[from] pinwheel_mbs::MechanismError),
    /// No angle of the output balances the load.
    #[error(
        "the load of {load_n_m} N m is more than the teeth carry before they jump; use less load or a stiffer contact"
    )]
    NoEquilibrium {
        /// The load, N m.
        load_n_m: f64,
    },
    /// A change that the scene's checks refuse.
    #[error(transparent)]
    Refused(#[from] Fault),
    /// No such integrator.
    #[error("no integrator `{0}`")]
    UnknownIntegrator(String),
}
