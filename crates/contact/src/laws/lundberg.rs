//! Line contact after Lundberg: two half spaces under a pressure that is uniform along the line; see [`super::line_hertz`].
//!
//! ```text
//! delta = 2 beta F (1.8864 + ln(L/(2 a)))
//! ```
//! Both bodies therefore have g = 2 (1.8864 + ln(L/2)): the length L of the line enters, and no radius except that of the
//! contact's width.

use super::{LawInfo, LawParameters, LineHertz, line_hertz};
use crate::HertzStiffness;

pub(super) fn new(parameters: &LawParameters) -> LineHertz {
    let size = 2.0 * (1.8864 + (0.5 * parameters.line_length).ln());
    LineHertz::sized(size, size, parameters)
}

/// Returns K of the curvature alone: a roller's own radius does not enter.
fn plain(hertz: HertzStiffness, _: &LawParameters) -> HertzStiffness {
    hertz.with_internal(1.0)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "lundberg",
    summary: "profiled rollers on a line after Lundberg, of any material, with the paper's damping",
    formula: "delta = 2 beta F (1.8864 + ln(L/(2 a))), a^2 = 4 F R beta; max(0, F + S(delta) C v)",
    source: "G. Lundberg, Forsch. Ing.-Wes. 10 (1939) 201, as in R. Teutsch, B. Sauer, J. Tribology 126 (2004) 436, Table 1",
    domain: "rollers of the best profile for their load, as half spaces longer than they are wide",
    keys: &[
        "contact.line_length_m",
        "contact.damping_n_s_m",
        "contact.ramp_m",
    ],
    stiffness: Some(plain),
    ..line_hertz::INFO
};
