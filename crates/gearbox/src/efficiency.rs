//! Efficiency with and without the energy that the contact law creates.

use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::figure::definitions::FRICTION;
use pinwheel_timeseries::{CREATED, NO_LOSS, efficiency};
use serde::{Deserialize, Serialize};

use crate::energy::EnergyAudit;

/// Efficiency of a window of a run.
///
/// The paper's law creates energy ([`crate::energy`]). The ratio of output to input work can therefore exceed 1, and with light
/// friction the law hides half of the loss. The account lists the losses separately, which give the actual efficiency of the
/// gear: `1 - lost/supplied`, with `supplied = delivered + lost`. Both exclude storage over the window.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Efficiency {
    /// Ratio of delivered to supplied work, from the time series: it includes the energy that the law creates, the run's own
    /// error, and storage at the ends of the window.
    pub measured: f64,
    /// Ratio of the work delivered to the work delivered and lost, without created energy, errors and storage; never above 1
    /// for dissipative contacts.
    pub of_losses: f64,
    /// Remainder of the account, relative to the supplied work: energy that the law (and the run) created, negative if
    /// destroyed. It is the error of `measured`, except for storage.
    pub created_share: f64,
    /// Losses in contacts, relative to the work delivered and lost.
    pub lost_share: f64,
    /// Uncertainty of `created_share` from the variation between the account's entries.
    pub created_off: f64,
    /// Uncertainty of `lost_share` and of `of_losses` from the variation between the account's entries.
    pub lost_off: f64,
    /// Friction losses of contacts, bearings, sleeves on their pins and seals, relative to the work delivered and lost; `None`
    /// for parts without friction.
    #[serde(skip)]
    by_cause: [Option<f64>; 4],
    /// True if any part has friction, so that the loss exceeds that of the contacts' damping.
    pub rubs: bool,
}

impl Efficiency {
    /// Computes the efficiency of an account; `None` if no work passes between the shafts, or more is stored than passes.
    pub fn of(audit: &EnergyAudit) -> Option<Self> {
        // Either shaft may drive.
        let (taken, delivered) = if audit.driver_j > 0.0 {
            (audit.driver_j, -audit.load_j)
        } else {
            (audit.load_j, -audit.driver_j)
        };
        if audit.remainder_share.is_none() || !(delivered > 0.0) {
            return None;
        }
        let lost = audit.damping_j + audit.friction_j;
        Some(Self {
            measured: efficiency(taken, delivered).ok()?,
            of_losses: delivered / (delivered + lost),
            created_share: audit.remainder_j / taken,
            lost_share: lost / (delivered + lost),
            created_off: audit.remainder_off_j / taken,
            lost_off: audit.lost_off_j / (delivered + lost),
            by_cause: [
                audit.contact_friction_j,
                audit.bearing_friction_j,
                audit.sleeve_friction_j,
                audit.seal_friction_j,
            ]
            .map(|lost_j| Some(lost_j? / (delivered + lost))),
            rubs: audit.friction_j != 0.0,
        })
    }

    /// Returns the efficiency from the losses, at most 1.
    ///
    /// # Errors
    /// Reason for a missing efficiency: the law creates or destroys power, or nothing has friction.
    pub fn defined(&self) -> Result<f64, String> {
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        if self.created_share.abs() > CREATED {
            let does = if self.created_share > 0.0 {
                "creates"
            } else {
                "destroys"
            };
            return Err(format!(
                "not defined under this contact law, which {does} {} of the power; contacts lose {}",
                percent(self.created_share.abs()),
                percent(self.lost_share)
            ));
        }
        if !self.rubs {
            return Err(NO_LOSS.to_owned());
        }
        Ok(self.of_losses.min(1.0))
    }

    /// Returns the shares lost by friction with their definitions, for the parts that have friction.
    pub fn by_cause(&self) -> impl Iterator<Item = (&'static FigureDef, f64)> {
        let shares = FRICTION.into_iter().zip(self.by_cause);
        shares.filter_map(|(def, share)| Some((def, share?)))
    }

    /// Returns a lower and an upper value, for display where one figure would mislead.
    pub fn interval(&self) -> [f64; 2] {
        [
            self.measured.min(self.of_losses),
            self.measured.max(self.of_losses),
        ]
    }
}
