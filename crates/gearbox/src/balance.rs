//! Energy check that separates runs with spurious energy from runs whose contact law adds a little.
//!
//! ```text
//! |sum of remainders| <= MOST (E + sum of |work of the driver| + |work of the load|, sample by sample)
//! ```
//! E is the kinetic energy at the start plus the load times the elastic twist under it. Without E rounding would exceed the
//! limit for a gear at rest, whose works are zero.
//!
//! An explicit method that does not resolve friction makes pin spins jump back and forth. Forces may look right while the
//! account loses a hundred times the work done. Angles stay near the ideal mesh, so only the energy reveals the fault.

use pinwheel_mbs::BodyState;

use crate::Gearbox;
use crate::energy::EnergyAudit;
use crate::load_profile;

/// Largest remainder, relative to the turnover. Over all presets with `rk2`, `rk4` and `imex2` at 1e-5 s, correct runs stay
/// below 0.16 (the first 0.1 ms of steel, whose 5.6 kHz the account's entries barely resolve; 0.03 later). Faulty runs reach 36
/// and more.
const MOST: f64 = 2.0;

/// Sums of the energy account so far.
#[derive(Debug, Clone)]
pub struct Balance {
    /// Sum of the remainders, J.
    pub remainder_j: f64,
    /// Energy at the start and works, J.
    pub turnover_j: f64,
}

impl Balance {
    /// Creates the balance with E as the turnover.
    pub(crate) fn new(gearbox: &Gearbox) -> Self {
        let mechanism = gearbox.mechanism();
        let starts: Vec<BodyState> = mechanism.bodies.iter().map(|body| body.start).collect();
        Self {
            remainder_j: 0.0,
            turnover_j: mechanism.kinetic_j(&starts) + elastic_j(gearbox),
        }
    }

    /// Adds the account from one sample to the next.
    ///
    /// # Errors
    /// A message with the remainder that exceeds the limit.
    #[inline]
    pub fn add(&mut self, audit: &EnergyAudit) -> Result<(), String> {
        self.remainder_j += audit.remainder_j;
        self.turnover_j += audit.driver_j.abs() + audit.load_j.abs();
        // The guard of the states detects a NaN.
        if self.remainder_j.abs() > MOST * self.turnover_j {
            return Err(format!(
                "{:.3e} J of energy are unaccounted for, with {:.3e} J turned over: the method does not follow the \
                 forces at this step",
                self.remainder_j, self.turnover_j
            ));
        }
        Ok(())
    }
}

/// Returns the approximate elastic energy of the contacts under the load, J.
pub fn elastic_j(gearbox: &Gearbox) -> f64 {
    let scales = gearbox.error_scales();
    // Without load the scales follow from the least force.
    let least = gearbox.least_force_n() * scales.length / scales.angle;
    load_profile::largest(&gearbox.scene.drive).max(least) * scales.angle
}
