//! What a law reads of its scene.

use super::{Law, law_info};

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

/// Why there is no such law.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LawError {
    /// No law has this name.
    #[error("no contact law `{0}`")]
    UnknownLaw(String),
    /// No law reads this key.
    #[error("no contact law reads `{0}`")]
    UnknownKey(String),
    /// The law needs this key and it was not given.
    #[error("the contact law `{law}` needs `{key}`")]
    MissingKey {
        /// Name of the law.
        law: &'static str,
        /// The key.
        key: &'static str,
    },
    /// A value outside of its range.
    #[error("{key} = {value}, but must be {allowed}")]
    OutOfRange {
        /// The key.
        key: &'static str,
        /// What was given.
        value: f64,
        /// The range in words.
        allowed: &'static str,
    },
}

/// Name of the key in scenes, its place, its range in words and as a test of finite values.
struct Key {
    name: &'static str,
    place: fn(&mut LawParameters) -> &mut f64,
    allowed: &'static str,
    holds: fn(f64) -> bool,
}

const POSITIVE: (&str, fn(f64) -> bool) = ("above 0", |x| x > 0.0);
const FROM_ZERO: (&str, fn(f64) -> bool) = ("0 or above", |x| x >= 0.0);
const SHARE: (&str, fn(f64) -> bool) = ("above 0 and at most 1", |x| x > 0.0 && x <= 1.0);

const fn key(
    name: &'static str,
    place: fn(&mut LawParameters) -> &mut f64,
    (allowed, holds): (&'static str, fn(f64) -> bool),
) -> Key {
    Key {
        name,
        place,
        allowed,
        holds,
    }
}

const MULTIPLIER: &str = "contact.stiffness_multiplier";

const KEYS: [Key; 7] = [
    key("contact.damping_n_s_m", |p| &mut p.damping, FROM_ZERO),
    key("contact.ramp_m", |p| &mut p.ramp, POSITIVE),
    key(
        "contact.constant_stiffness_n_m15",
        |p| &mut p.constant_stiffness,
        POSITIVE,
    ),
    key(MULTIPLIER, |p| &mut p.stiffness_multiplier, POSITIVE),
    key("contact.line_length_m", |p| &mut p.line_length, POSITIVE),
    key("contact.restitution", |p| &mut p.restitution, SHARE),
    key(
        "contact.impact_speed_m_s",
        |p| &mut p.impact_speed,
        POSITIVE,
    ),
];

impl Law {
    /// The law called `name` from values by the keys of scenes, with or without `contact.` in front. Every key that the
    /// law [reads](super::LawInfo::keys) must be given; `stiffness_multiplier` is 1 if not; other laws' keys may be there.
    ///
    /// # Errors
    /// An unknown law or key, a missing key, or a value out of range.
    pub fn from_values(name: &str, values: &[(&str, f64)]) -> Result<Self, LawError> {
        let info = law_info(name).ok_or_else(|| LawError::UnknownLaw(name.to_owned()))?;
        let mut parameters = LawParameters {
            stiffness_multiplier: 1.0,
            ..LawParameters::default()
        };
        let mut given = Vec::with_capacity(values.len());
        for &(name, value) in values {
            let key = KEYS
                .iter()
                .find(|key| {
                    key.name.trim_start_matches("contact.") == name.trim_start_matches("contact.")
                })
                .ok_or_else(|| LawError::UnknownKey(name.to_owned()))?;
            if !(value.is_finite() && (key.holds)(value)) {
                return Err(LawError::OutOfRange {
                    key: key.name,
                    value,
                    allowed: key.allowed,
                });
            }
            *(key.place)(&mut parameters) = value;
            given.push(key.name);
        }
        if let Some(key) = info.keys.iter().find(|key| !given.contains(key)) {
            return Err(LawError::MissingKey {
                law: info.name,
                key,
            });
        }
        Self::named(name, &parameters).ok_or_else(|| LawError::UnknownLaw(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::LAWS;

    #[test]
    fn bad_input_is_named() {
        let law = |name: &str, values: &[(&str, f64)]| Law::from_values(name, values);
        let complete = [("damping_n_s_m", 8.0), ("contact.ramp_m", 1e-5)];
        assert!(law("paper", &complete).is_ok());
        for (result, words) in [
            (law("papre", &complete), "no contact law `papre`"),
            (law("paper", &complete[..1]), "needs `contact.ramp_m`"),
            (law("paper", &[("rampe_m", 1.0)]), "reads `rampe_m`"),
            (
                law("paper", &[("ramp_m", 0.0)]),
                "contact.ramp_m = 0, but must be above 0",
            ),
            (
                law("paper", &[("ramp_m", f64::NAN)]),
                "contact.ramp_m = NaN",
            ),
            (law("flores", &[("restitution", 1.01)]), "at most 1"),
        ] {
            let message = result.unwrap_err().to_string();
            assert!(message.contains(words), "{message}");
        }
    }

    /// Every key that a law names can be given, and gives what a scene's parameters give.
    #[test]
    fn values_by_key_are_the_parameters() {
        for info in LAWS {
            let mut parameters = LawParameters {
                stiffness_multiplier: 1.0,
                ..LawParameters::default()
            };
            let values: Vec<(&str, f64)> = info
                .keys
                .iter()
                .map(|&name| {
                    let key = KEYS.iter().find(|key| key.name == name).expect(name);
                    let place = (key.place)(&mut parameters);
                    *place *= 0.5;
                    (name, *place)
                })
                .collect();
            let named = Law::named(info.name, &parameters);
            assert_eq!(Law::from_values(info.name, &values).ok(), named);
        }
    }
}
