//! Efficiency with and without what the contact law itself creates.

use pinwheel_timeseries::figure::FigureDef;
use pinwheel_timeseries::figure::definitions::FRICTION;
use pinwheel_timeseries::{CREATED, NO_LOSS, efficiency};
use serde::{Deserialize, Serialize};

use crate::energy::EnergyAudit;

/// The efficiency of a window of a run.
///
/// The paper's law creates energy ([`crate::energy`]), so that what leaves a gear over what enters it can be above 1, and
/// with light friction hides half of the loss. What contacts lose is in the account apart from that, and tells the efficiency
/// that the gear has: `1 - lost/supplied`, with `supplied = delivered + lost`. Storage over the window is left out of both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Efficiency {
    /// Work delivered over work taken in, as the time series have it: with the energy that the law creates, the run's own error and
    /// storage at the ends of the window.
    pub measured: f64,
    /// Work delivered over work delivered and lost: with all of that taken out. Never above 1 where contacts only lose.
    pub of_losses: f64,
    /// The account's remainder as a share of the work taken in: what the law (and the run) created, negative if destroyed.
    /// Its size is the half-truth of `measured`: their difference, but for storage.
    pub created_share: f64,
    /// Losses in contacts, as a share of the work delivered and lost.
    pub lost_share: f64,
    /// How far `created_share` may be off by what lies between the account's entries.
    pub created_off: f64,
    /// Possible error of `lost_share` and of `of_losses` due to the course between the account's entries.
    pub lost_off: f64,
    /// Losses of contacts, bearings, sleeves on their pins and seals by friction, as shares of the work delivered and
    /// lost; `None` where nothing rubs so.
    #[serde(skip)]
    by_cause: [Option<f64>; 4],
    /// True if anything rubs, so that the loss is more than that of the contacts' damping.
    pub rubs: bool,
}

impl Efficiency {
    /// From an account; `None` where no work passes from one shaft to the other, or more is stored than passes.
    #[must_use]
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

    /// The efficiency by what is lost, at most 1.
    ///
    /// # Errors
    /// Why there is none, in words: the law creates or destroys power, or nothing is lost because nothing rubs.
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

    /// Shares that friction loses, each with its definition: those of what rubs.
    pub fn by_cause(&self) -> impl Iterator<Item = (&'static FigureDef, f64)> {
        let shares = FRICTION.into_iter().zip(self.by_cause);
        shares.filter_map(|(def, share)| Some((def, share?)))
    }

    /// Below and above: what to show where one figure would mislead.
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        [
            self.measured.min(self.of_losses),
            self.measured.max(self.of_losses),
        ]
    }
}
