//! Flores: `chi = 8 (1 - c)/(5 c)`; see [`super::hysteresis`].

use super::{Hysteresis, LawInfo, LawParameters, hunt_crossley};

/// Returns chi for the restitution `c`.
fn factor(c: f64) -> f64 {
    8.0 * (1.0 - c) / (5.0 * c)
}

pub(super) fn new(parameters: &LawParameters) -> Hysteresis {
    Hysteresis::new(factor(parameters.restitution), parameters.impact_speed)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "flores",
    summary: "Flores's hysteresis damping for a given restitution c",
    formula: "max(0, K delta^1.5 (1 + chi v/v0)), chi = 8 (1 - c)/(5 c)",
    source: "P. Flores, M. Machado, M. T. Silva, J. M. Martins, On the continuous contact force models for soft materials in multibody dynamics, Multibody Syst. Dyn. 25 (2011) 357-375",
    domain: "any c above 0, made for soft materials: 0.9 comes out as 0.894, 0.5 as 0.47, 0.1 as 0.07",
    restitution_factor: Some(factor),
    ..hunt_crossley::INFO
};
