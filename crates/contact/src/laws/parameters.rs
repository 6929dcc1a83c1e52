//! What a law reads of its scene.

/// The parameters of all laws, SI; each reads what its [`keys`](super::LawInfo::keys) name. The default is the paper's
/// gear, and for laws that are not the paper's what a scene has that says nothing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LawParameters {
    /// C, N s/m; `contact.damping_n_s_m`.
    pub damping: f64,
    /// Penetration at which damping and force are ramped in, m; `contact.ramp_m`.
    pub ramp: f64,
    /// K of laws with one stiffness for all contacts, N/m^1.5; `contact.constant_stiffness_n_m15`.
    pub constant_stiffness: f64,
    /// H, factor on the stiffness of laws that do not take Hertz's; `contact.stiffness_multiplier`.
    pub stiffness_multiplier: f64,
    /// Length of the line of a line contact, m; `contact.line_length_m`.
    pub line_length: f64,
    /// c of the hysteresis laws, 0 < c <= 1; `contact.restitution`.
    pub restitution: f64,
    /// v0 of the hysteresis laws, m/s; `contact.impact_speed_m_s`.
    pub impact_speed: f64,
}

impl Default for LawParameters {
    fn default() -> Self {
        Self {
            damping: 8.0,
            ramp: 1e-5,
            constant_stiffness: 1e8,
            stiffness_multiplier: 0.01,
            line_length: 0.01,
            restitution: 0.9,
            impact_speed: 0.01,
        }
    }
}
