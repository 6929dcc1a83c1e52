//! Hunt and Crossley: `chi = 3 (1 - c)/2`; see [`super::hysteresis`].

use super::{Hysteresis, LawInfo, LawParameters, Shape};

/// Returns chi for the restitution `c`.
fn factor(c: f64) -> f64 {
    1.5 * (1.0 - c)
}

pub(super) fn new(parameters: &LawParameters) -> Hysteresis {
    Hysteresis::new(factor(parameters.restitution), parameters.impact_speed)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "hunt-crossley",
    summary: "Hunt and Crossley's hysteresis damping for a given restitution c",
    formula: "max(0, K delta^1.5 (1 + chi v/v0)), chi = 3 (1 - c)/2",
    source: "K. H. Hunt, F. R. E. Crossley, Coefficient of restitution interpreted as damping in vibroimpact, J. Appl. Mech. 42 (1975) 440-445",
    domain: "c near 1, derived for small losses: 0.9 comes out as 0.909, 0.5 as 0.66",
    slow_impact: "singular with the true impact speed: the damping grows as 1/v0 and a smooth entry has v0 = 0; \
     here contact.impact_speed_m_s stands for v0 in every contact, which bounds it, and slower impacts lose less",
    keys: &["contact.restitution", "contact.impact_speed_m_s"],
    restitution_factor: Some(factor),
    conservative: false,
    shape: Shape::Sphere,
    materials: "any elastic one, by modulus and Poisson's ratio",
    stiffness: None,
};
