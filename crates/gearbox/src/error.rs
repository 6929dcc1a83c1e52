//! Errors of scenes that cannot be modelled.

use pinwheel_scene::Fault;

/// Reason why a checked scene cannot be modelled.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GearboxError {
    /// Curve or channel that does not exist, or contacts that the detection cannot compute.
    #[error("{0}")]
    Geometry(String),
    /// Name of a contact law that does not exist.
    #[error("no contact law `{0}`")]
    UnknownLaw(String),
    /// Too few points for the pits.
    #[error(
        "contact.wheel_points = {wheel_points} is too coarse for the pits of this profile: the circle through three \
         neighbouring points is smaller than the pin; use more points"
    )]
    TooFewPoints {
        /// Value in the scene.
        wheel_points: usize,
    },
    /// The mechanism cannot be solved.
    #[error(transparent)]
    Mechanism(#[from] pinwheel_mbs::MechanismError),
    /// No output angle balances the load.
    #[error(
        "the load of {load_n_m} N m is more than the teeth carry before they jump; use less load or a stiffer contact"
    )]
    NoEquilibrium {
        /// Load torque, N m.
        load_n_m: f64,
    },
    /// Balance that was lost on the way from a heavier load.
    #[error(
        "no balance was found under {load_n_m} N m: the teeth carry {from_n_m} N m at this input angle, and on the way to the lighter load \
         the balance was lost, as parts that carry little rest anywhere in their clearance; take a heavier load or less clearance"
    )]
    Lost {
        /// Load torque, N m.
        load_n_m: f64,
        /// Last load with a balance, N m.
        from_n_m: f64,
    },
    /// No balance with friction, because the gear locks itself or parts stick.
    #[error("no balance with friction was found; the gear may lock itself")]
    Sticks,
    /// Change that the scene's checks refuse.
    #[error(transparent)]
    Refused(#[from] Fault),
    /// Changes of a speed that an importer prescribes.
    #[error(
        "drive.speed_changes changes the speed of the input, which the importer prescribes; leave it out and change the input speed there"
    )]
    SpeedChanges,
    /// Name of an integrator that does not exist.
    #[error("no integrator `{0}`")]
    UnknownIntegrator(String),
}
