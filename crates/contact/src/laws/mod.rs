//! Normal contact laws: force as a function of stiffness, penetration and its rate.
//!
//! One file a law; each opens with its equation and source. [`LAWS`] lists them all with their domain of
//! validity and what they do when bodies meet slowly, which is where most of them fail.

mod adams_impact;
mod constant;
mod flores;
mod herbert_mcwhannell;
mod hunt_crossley;
mod hysteresis;
mod lankarani_nikravesh;
mod lee_wang;
mod line_contact;
mod paper;
mod paper_conservative;
mod paper_printed;

pub use adams_impact::AdamsImpact;
pub use constant::ConstantStiffness;
pub use hysteresis::{Hysteresis, restitution_of};
pub use line_contact::LineContact;
pub use paper::PaperLaw;
pub use paper_conservative::PaperConservative;
pub use paper_printed::PaperPrinted;

/// A penalty law F_n(K, delta, d(delta)/dt) for delta > 0.
///
/// Laws are small copyable values; the contact loop is compiled for each of them. They know no
/// history: what depends on the speed of an impact takes a reference speed from its settings.
pub trait NormalLaw: Copy + Send + Sync + 'static {
    /// Normal force, N, never negative. `stiffness` K in N/m^1.5, `penetration` in m (> 0), `rate` in m/s.
    fn force(&self, stiffness: f64, penetration: f64, rate: f64) -> f64;

    /// Stored energy of a pair, J: the integral of the force at rate 0 over the penetration.
    fn stored(&self, stiffness: f64, penetration: f64) -> f64;

    /// Force against an increase of K along the profile, per unit of its slope: dU/dK for laws whose force
    /// is the whole gradient of U(K, delta), 0 for those that are normal only.
    #[inline]
    fn along(&self, _penetration: f64) -> f64 {
        0.0
    }

    /// True if [`along`](Self::along) is not 0 everywhere.
    const HAS_ALONG: bool = false;

    /// The stiffness the law works with where Hertz's is `hertz`; its own unit where the exponent is not 1.5.
    #[inline]
    fn stiffness(&self, hertz: f64) -> f64 {
        hertz
    }
}

// Lane by lane is enough for these.
impl crate::LanesLaw for AdamsImpact {}
impl crate::LanesLaw for ConstantStiffness {}
impl crate::LanesLaw for Hysteresis {}
impl crate::LanesLaw for LineContact {}
impl crate::LanesLaw for PaperPrinted {}

/// A law as listed for users.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LawInfo {
    /// Name in scenes.
    pub name: &'static str,
    /// One line.
    pub summary: &'static str,
    /// The force.
    pub formula: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// Where it may be used.
    pub domain: &'static str,
    /// What happens as the impact speed tends to 0.
    pub slow_impact: &'static str,
    /// Scene keys it reads, besides those every law shares.
    pub keys: &'static [&'static str],
    /// True if the undamped force has a potential on a profile of varying stiffness.
    pub conservative: bool,
}

/// All laws.
pub const LAWS: &[LawInfo] = &[
    paper::INFO,
    paper_conservative::INFO,
    constant::INFO,
    hunt_crossley::INFO,
    lee_wang::INFO,
    herbert_mcwhannell::INFO,
    lankarani_nikravesh::INFO,
    flores::INFO,
    adams_impact::INFO,
    line_contact::INFO,
    paper_printed::INFO,
];

/// The law called `name`.
#[must_use]
pub fn law_info(name: &str) -> Option<&'static LawInfo> {
    LAWS.iter().find(|law| law.name == name)
}

/// The hysteresis factor chi of a law of that family for the restitution c in (0, 1]; `None` for other laws.
#[must_use]
pub fn hysteresis_factor(name: &str, restitution: f64) -> Option<f64> {
    let chi = match name {
        "hunt-crossley" => hunt_crossley::factor,
        "lee-wang" => lee_wang::factor,
        "herbert-mcwhannell" => herbert_mcwhannell::factor,
        "lankarani-nikravesh" => lankarani_nikravesh::factor,
        "flores" => flores::factor,
        _ => return None,
    };
    Some(chi(restitution))
}

/// S of Eq. 22: 0 below 0, 1 above `width`, linear between.
#[must_use]
#[inline]
pub fn ramp(x: f64, width: f64) -> f64 {
    (x / width).clamp(0.0, 1.0)
}

/// Integral of S(x) x^1.5 from 0 to `x` >= 0, m^2.5.
#[must_use]
#[inline]
pub(crate) fn ramped_integral(x: f64, width: f64) -> f64 {
    let power = |x: f64| x * x * x.sqrt();
    if x < width {
        power(x) * x / (3.5 * width)
    } else {
        power(width) / 3.5 + (power(x) - power(width)) / 2.5
    }
}

/// STEP of the Adams solver: h0 below x0, h1 above x1, a smooth cubic between.
#[must_use]
#[inline]
pub fn step(x: f64, x0: f64, h0: f64, x1: f64, h1: f64) -> f64 {
    let s = ((x - x0) / (x1 - x0)).clamp(0.0, 1.0);
    h0 + (h1 - h0) * s * s * (3.0 - 2.0 * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn each(mut visit: impl FnMut(&str, &dyn Fn(f64, f64, f64) -> f64, &dyn Fn(f64, f64) -> f64)) {
        macro_rules! law {
            ($name:expr, $law:expr) => {{
                let law = $law;
                visit($name, &move |k, d, v| law.force(k, d, v), &move |k, d| {
                    law.stored(k, d)
                });
            }};
        }
        let (damping, ramp) = (8.0, 1e-5);
        for info in LAWS {
            match info.name {
                "paper" => law!(info.name, PaperLaw { damping, ramp }),
                // Its force may pull: see its own file.
                "paper-printed" => {}
                "paper-conservative" => law!(info.name, PaperConservative { damping, ramp }),
                "constant" => law!(
                    info.name,
                    ConstantStiffness {
                        stiffness: 1e8,
                        damping,
                        ramp
                    }
                ),
                "adams-impact" => law!(
                    info.name,
                    AdamsImpact {
                        stiffness: 1e8,
                        damping,
                        depth: ramp
                    }
                ),
                "line-contact" => law!(info.name, LineContact::new(0.01, 0.01, damping, ramp)),
                name => {
                    let chi = hysteresis_factor(name, 0.9).expect("a hysteresis law");
                    law!(info.name, Hysteresis::new(chi, 0.01));
                }
            }
        }
    }

    #[test]
    fn names_differ_and_texts_are_there() {
        for (k, law) in LAWS.iter().enumerate() {
            assert!(LAWS[..k].iter().all(|other| other.name != law.name));
            for text in [
                law.summary,
                law.formula,
                law.source,
                law.domain,
                law.slow_impact,
            ] {
                assert!(text.len() > 10, "{}: {text}", law.name);
            }
        }
        assert!(law_info("paper").is_some() && law_info("papre").is_none());
    }

    /// No law pulls, none has a jump at first touch when bodies meet at rest, and stored energy is what the
    /// force at rest does.
    #[test]
    fn forces_push_and_store() {
        each(|name, force, stored| {
            for depth in [1e-12, 1e-7, 4e-6, 1e-5, 3e-5, 4e-4] {
                for rate in [-10.0, -0.3, -1e-4, 0.0, 1e-4, 0.3, 10.0] {
                    let f = force(9e7, depth, rate);
                    assert!(f >= 0.0 && f.is_finite(), "{name} {depth} {rate}: {f}");
                }
                let h = 1e-6 * depth;
                let slope = (stored(9e7, depth + h) - stored(9e7, depth - h)) / (2.0 * h);
                let f = force(9e7, depth, 0.0);
                assert!(
                    (slope / f - 1.0).abs() < 1e-6,
                    "{name} {depth}: {slope} {f}"
                );
            }
            assert!(force(9e7, 1e-13, 0.0) < 1e-3, "{name}");
        });
    }

    #[test]
    fn step_is_adams_s() {
        assert_eq!(step(-1.0, 0.0, 2.0, 1.0, 5.0), 2.0);
        assert_eq!(step(0.5, 0.0, 2.0, 1.0, 5.0), 3.5);
        assert_eq!(step(7.0, 0.0, 2.0, 1.0, 5.0), 5.0);
    }
}
