//! Lankarani and Nikravesh: `chi = 3 (1 - c^2)/4`; see [`super::hysteresis`].

use super::{Hysteresis, LawInfo, LawParameters, hunt_crossley};

/// Returns chi for the restitution `c`.
fn factor(c: f64) -> f64 {
    0.75 * (1.0 - c * c)
}

pub(super) fn new(parameters: &LawParameters) -> Hysteresis {
    Hysteresis::new(factor(parameters.restitution), parameters.impact_speed)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "lankarani-nikravesh",
    summary: "Lankarani and Nikravesh's hysteresis damping for a given restitution c",
    formula: "max(0, K delta^1.5 (1 + chi v/v0)), chi = 3 (1 - c^2)/4",
    source: "H. M. Lankarani, P. E. Nikravesh, A contact force model with hysteresis damping for impact analysis of multibody systems, J. Mech. Des. 112 (1990) 369-376",
    domain: "c near 1, derived for small losses: 0.9 comes out as 0.913, 0.5 as 0.73",
    restitution_factor: Some(factor),
    ..hunt_crossley::INFO
};
