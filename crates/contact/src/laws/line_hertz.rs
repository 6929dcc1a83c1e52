//! Line contact of two elastic bodies: a roller after Johnson on a disc after Weber and Banaschek, with the paper's damping.
//!
//! Each body is indented by delta_i = B_i F (g_i - ln a^2), B = (1 - nu^2)/(pi E L), with a^2 = 4 F R beta the square of half
//! the contact's width (Hertz), beta = B_p + B_d and R = R_c R_p/(R_c + R_p). A plane half space has no finite approach, so
//! that a size of the body enters: the roller's radius R_p, and the depth h of the disc behind the contact:
//!
//! ```text
//! g_p = 2 ln(4 R_p) - 1,   g_d = 2 ln(2 h) - nu_d/(1 - nu_d)
//! delta = beta F (c - ln F),   c = (B_p g_p + B_d g_d)/beta - ln(4 R beta)
//! L = c + ln(beta/delta),   w - ln w = L,   F = delta/(beta w)                   (w = -W(-e^-L), lower branch of Lambert's W)
//! slope = 1/(beta (w - 1)),   U = F delta/2 - beta F^2/4
//! along the profile: dU/dR dR/ds = beta F^2/(2 R) dR/ds
//! F_n = max(0, F + S(delta) C v)
//! ```
//! The force at rest starts with slope 0, so that only the damping has a ramp. R and R_p enter through K of Hertz's point
//! contact, which grows with the root of R ([`HertzStiffness`](crate::HertzStiffness)). H makes both bodies stiffer.

use pinwheel_faults::{Fault, factor};

use super::{LawInfo, LawParameters, NormalLaw, Ramp, Shape};
use crate::{HertzStiffness, Real};

/// Smallest L; usual contacts have 4 or more. Deeper contacts are a linear spring, so that their force stays finite.
const LEAST_LEVEL: f64 = 2.5;

/// Line-contact law of this module.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineHertz {
    /// Compliance beta, m/N.
    compliance: f64,
    /// Constant L + ln(K^2 delta).
    level: f64,
    damping: f64,
    ramp: Ramp,
}

impl LineHertz {
    /// Returns w at a penetration: the first terms of its series, then Newton's series about them.
    #[inline(always)]
    fn w<R: Real>(&self, stiffness: R, penetration: R) -> R {
        let c = |x: f64| penetration.like(x);
        let level = c(self.level) - (stiffness * stiffness * penetration).ln();
        let level = level.max(c(LEAST_LEVEL));
        let (log, over) = (level.ln(), c(1.0) / level);
        let bent = (c(1.0) - log * c(0.5)) * over;
        let start = (log * over).mul_add(bent + c(1.0), level + log);
        // x of w = start (1 + x): (start - 1) x + x^2/2 - x^3/3 + x^4/4 = level + ln start - start, by its inverse series.
        let a = c(1.0) / (start - c(1.0));
        let s = (level + start.ln() - start) * a;
        let fourth = a.mul_add(a.mul_add(a * c(0.625), a * c(5.0 / 6.0)), a * c(0.25));
        let third = a.mul_add(a * c(0.5), a * c(1.0 / 3.0)) - s * fourth;
        let x = s - s * s * (a * c(0.5) - s * third);
        x.mul_add(start, start)
    }

    #[inline(always)]
    fn elastic_of<R: Real>(&self, w: R, penetration: R) -> R {
        penetration / (w * w.like(self.compliance))
    }

    #[inline(always)]
    fn damped<R: Real>(&self, elastic: R, penetration: R, rate: R) -> R {
        let c = |x: f64| rate.like(x);
        let damping = self.ramp.at(penetration) * c(self.damping);
        damping.mul_add(rate, elastic).max(c(0.0))
    }

    #[inline(always)]
    fn energy<R: Real>(&self, elastic: R, penetration: R) -> R {
        let c = |x: f64| penetration.like(x);
        c(0.5) * elastic * (penetration - c(0.5 * self.compliance) * elastic)
    }
}

impl NormalLaw for LineHertz {
    #[inline(always)]
    fn force<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> R {
        let w = self.w(stiffness, penetration);
        self.damped(self.elastic_of(w, penetration), penetration, rate)
    }

    #[inline(always)]
    fn stored<R: Real>(&self, stiffness: R, penetration: R) -> R {
        let w = self.w(stiffness, penetration);
        self.energy(self.elastic_of(w, penetration), penetration)
    }

    #[inline(always)]
    fn along<R: Real>(&self, stiffness: R, penetration: R) -> Option<R> {
        let force = self.elastic_of(self.w(stiffness, penetration), penetration);
        Some(force * force * force.like(self.compliance) / stiffness)
    }

    #[inline(always)]
    fn observed<R: Real>(&self, stiffness: R, penetration: R, rate: R) -> [R; 3] {
        let elastic = self.elastic_of(self.w(stiffness, penetration), penetration);
        [
            self.damped(elastic, penetration, rate),
            elastic,
            self.energy(elastic, penetration),
        ]
    }

    fn elastic(&self, hertz: f64, depth: f64) -> f64 {
        self.elastic_of(self.w(hertz, depth), depth)
    }

    fn depth(&self, hertz: f64, force: f64) -> f64 {
        // L = c + ln(beta/delta) and w = c - ln F, so that c = level - ln(K^2 beta).
        let c = self.level - (hertz * hertz * self.compliance).ln();
        let w = c - force.ln();
        let least = LEAST_LEVEL + LEAST_LEVEL.ln() + 1.0;
        self.compliance * force * w.max(least)
    }

    fn tangent(&self, hertz: f64, depth: f64) -> f64 {
        1.0 / (self.compliance * (self.w(hertz, depth) - 1.0))
    }
}

impl LineHertz {
    /// Creates the law of bodies with the constants g `of_pin` and `of_disc`.
    pub(super) fn sized(of_pin: f64, of_disc: f64, parameters: &LawParameters) -> Self {
        let LawParameters { pin, disc, .. } = parameters;
        let stiffer = parameters.stiffness_multiplier * factor(Fault::Stiffness, 1.01);
        let line = parameters.line_length * stiffer;
        let (b_pin, b_disc) = (pin.compliance() / line, disc.compliance() / line);
        let compliance = b_pin + b_disc; // beta
        let sizes = (b_pin * of_pin + b_disc * of_disc) / compliance;
        // K = k sqrt(R), so ln(4 R) = ln(4 K^2/k^2), and the remaining terms of L depend on K and delta.
        let hertz = HertzStiffness::new(*pin, *disc, parameters.stiffness_multiplier).coefficient();
        Self {
            compliance,
            level: sizes - (4.0 / (hertz * hertz)).ln(),
            damping: parameters.damping,
            ramp: Ramp::new(parameters.ramp),
        }
    }
}

pub(super) fn new(parameters: &LawParameters) -> LineHertz {
    let poisson = parameters.disc.poisson;
    let of_pin = 2.0 * (4.0 * parameters.sleeve_radius).ln() - 1.0;
    let of_disc = 2.0 * (2.0 * parameters.disc_depth).ln() - poisson / (1.0 - poisson);
    LineHertz::sized(of_pin, of_disc, parameters)
}

/// Returns K with the share of the approach that depends on the roller's radius, B_p/beta.
fn with_pins(hertz: HertzStiffness, parameters: &LawParameters) -> HertzStiffness {
    let (pin, disc) = (parameters.pin.compliance(), parameters.disc.compliance());
    // The factor in holes applies to balls only.
    let hertz = hertz.with_internal(1.0);
    hertz.with_sleeve(parameters.sleeve_radius, pin / (pin + disc))
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "line-hertz",
    summary: "rollers on a line, both bodies elastic, of any material, with the paper's damping",
    formula: "delta = beta F (c - ln F): c from R, the roller's radius and the disc's depth; max(0, F + S(delta) C v)",
    source: "K. L. Johnson, Contact Mechanics, 1985, 5.6 (roller); C. Weber and K. Banaschek, 1953 (disc); solved for F here",
    domain: "cylinders of any elastic material whose contact is narrow beside their radii; whole gradient of an energy",
    slow_impact: "regular: does not depend on the impact speed",
    keys: &[
        "contact.line_length_m",
        "contact.disc_depth_m",
        "contact.damping_n_s_m",
        "contact.ramp_m",
    ],
    restitution_factor: None,
    conservative: true,
    shape: Shape::Line,
    materials: "any elastic ones, pins and discs apart",
    stiffness: Some(with_pins),
};
