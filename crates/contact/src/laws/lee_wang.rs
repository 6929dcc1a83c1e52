//! Lee and Wang: `chi = 3 (1 - c)/4`; see [`super::hysteresis`].

use super::{Hysteresis, LawInfo, LawParameters, hunt_crossley};

/// Returns chi for the restitution `c`.
fn factor(c: f64) -> f64 {
    0.75 * (1.0 - c)
}

pub(super) fn new(parameters: &LawParameters) -> Hysteresis {
    Hysteresis::new(factor(parameters.restitution), parameters.impact_speed)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "lee-wang",
    summary: "Lee and Wang's hysteresis damping for a given restitution c",
    formula: "max(0, K delta^1.5 (1 + chi v/v0)), chi = 3 (1 - c)/4",
    source: "T. W. Lee, A. C. Wang, On the dynamics of intermittent-motion mechanisms, Part 1, J. Mech. Transm. Autom. Des. 105 (1983) 534-540",
    domain: "none but c = 1: half of Hunt and Crossley's damping, so that 0.9 comes out as 0.952, 0.5 as 0.80",
    restitution_factor: Some(factor),
    ..hunt_crossley::INFO
};
