//! Parameters that a law reads from its scene.

use crate::{HertzStiffness, Material};

/// Parameters of all laws, SI; each law reads those of its [`keys`](super::LawInfo::keys). Default values are those of the
/// paper's gear; for other laws those of a scene without the keys.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawParameters {
    /// Damping C, N s/m; `contact.damping_n_s_m`.
    pub damping: f64,
    /// Penetration at which the ramp of damping and force ends, m; `contact.ramp_m`.
    pub ramp: f64,
    /// K of laws with one stiffness for all contacts, N/m^1.5; `contact.constant_stiffness_n_m15`.
    pub constant_stiffness: f64,
    /// Factor H on the stiffness of laws that do not take Hertz's; `contact.stiffness_multiplier`.
    pub stiffness_multiplier: f64,
    /// Factor H in holes; `contact.internal_stiffness_multiplier`.
    pub internal_multiplier: f64,
    /// Spring constants of external and internal contacts, N/m; `contact.external_spring_n_m`, `contact.internal_spring_n_m`.
    pub springs: [f64; 2],
    /// Length of the line of a line contact, m; `contact.line_length_m`.
    pub line_length: f64,
    /// Material of pins; `contact.pin_young_pa`, `contact.pin_poisson`.
    pub pin: Material,
    /// Material of discs; `contact.young_pa`, `contact.poisson`.
    pub disc: Material,
    /// Depth of a disc behind a contact, m; `contact.disc_depth_m`.
    pub disc_depth: f64,
    /// Radius of the ring pins, m; `gear.external_sleeve_radius_m`.
    pub sleeve_radius: f64,
    /// Restitution c of the hysteresis laws, 0 < c <= 1; `contact.restitution`.
    pub restitution: f64,
    /// Reference speed v0 of the hysteresis laws, m/s; `contact.impact_speed_m_s`.
    pub impact_speed: f64,
}

impl LawParameters {
    /// Returns K of the materials, in the form that the law called `name` uses.
    pub fn hertz(&self, name: &str) -> HertzStiffness {
        let hertz = HertzStiffness::new(self.pin, self.disc, self.stiffness_multiplier)
            .with_internal(self.internal_multiplier / self.stiffness_multiplier);
        match super::law_info(name).and_then(|law| law.stiffness) {
            Some(stiffness) => stiffness(hertz, self),
            None => hertz,
        }
    }
}

impl Default for LawParameters {
    fn default() -> Self {
        let steel = Material {
            young: 2e11,
            poisson: 0.3,
        };
        Self {
            damping: 8.0,
            ramp: 1e-5,
            constant_stiffness: 1e8,
            stiffness_multiplier: 0.01,
            internal_multiplier: 0.01,
            springs: [1e8; 2],
            line_length: 0.01,
            pin: steel,
            disc: steel,
            disc_depth: 0.01,
            sleeve_radius: 0.006,
            restitution: 0.9,
            impact_speed: 0.01,
        }
    }
}
