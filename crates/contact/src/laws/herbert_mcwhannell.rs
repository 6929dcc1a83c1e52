//! Herbert and McWhannell: `chi = 6 (1 - c)/((2 c - 1)^2 + 3)`; see [`super::hysteresis`].

use super::{Hysteresis, LawInfo, LawParameters, hunt_crossley};

/// Returns chi for the restitution `c`.
fn factor(c: f64) -> f64 {
    6.0 * (1.0 - c) / ((2.0 * c - 1.0).powi(2) + 3.0)
}

pub(super) fn new(parameters: &LawParameters) -> Hysteresis {
    Hysteresis::new(factor(parameters.restitution), parameters.impact_speed)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "herbert-mcwhannell",
    summary: "Herbert and McWhannell's hysteresis damping for a given restitution c",
    formula: "max(0, K delta^1.5 (1 + chi v/v0)), chi = 6 (1 - c)/((2 c - 1)^2 + 3)",
    source: "R. G. Herbert, D. C. McWhannell, Shape and frequency composition of pulses from an impact pair, J. Eng. Ind. 99 (1977) 513-518",
    domain: "c near 1: 0.9 comes out as 0.901, 0.5 as 0.59",
    restitution_factor: Some(factor),
    ..hunt_crossley::INFO
};
