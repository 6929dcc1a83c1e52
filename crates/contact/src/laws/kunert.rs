//! Line contact after Kunert: `F_n = max(0, K_L delta^(1/0.925) + S(delta) C v)`; see [`super::line_contact`].
//!
//! delta = 4.05e-5 F^0.925/L^0.85 with delta and L in mm and F in N, for steel rollers with relieved ends, which press evenly
//! along their length. So `K_L = H (1000/4.05e-5)^(1/0.925) L^(0.85/0.925)`, for all radii.

use super::{LawInfo, LawParameters, LineContact, line_contact};

pub(super) fn new(parameters: &LawParameters) -> LineContact {
    LineContact::fitted(4.05e-5, 1.0 / 0.925, 0.85 / 0.925, parameters)
}

pub(super) const INFO: LawInfo = LawInfo {
    name: "kunert",
    summary: "profiled rollers on a line after Kunert, exponent 1/0.925, with the paper's damping",
    formula: "max(0, K_L delta^(1/0.925) + S(delta) C v), K_L = H (1000/4.05e-5)^(1/0.925) L_mm^(0.85/0.925)",
    source: "K. Kunert, 1961: delta = 4.05e-5 F^0.925/L^0.85 (mm, N), as in R. Teutsch, B. Sauer, J. Tribology 126 (2004) 436, Table 1",
    domain: "steel rollers of the best profile for their load on a half space; the radii do not enter",
    materials: "steel: fitted to it",
    ..line_contact::INFO
};
