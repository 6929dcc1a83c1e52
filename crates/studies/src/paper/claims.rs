//! The paper's claims, each with our figure and a verdict.
//!
//! What is claimed, how it is judged and the explanation stand in `reference/published/paper.toml`; figures are
//! computed here from short runs, verdicts follow from the figures by the rules below and from nothing else.

mod backlash;
mod figures;
mod runs;

use serde::{Deserialize, Serialize};

use pinwheel_gearbox::native::NativeError;

/// What a claim is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// Our figures say the same.
    Holds,
    /// True under a condition the paper does not make; the remark names it.
    Conditional,
    /// Our figures say otherwise.
    DoesNotHold,
    /// The claim has no meaning that could be computed.
    Meaningless,
}

/// One claim as listed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// Key.
    pub id: String,
    /// What the paper says.
    pub claim: String,
    /// Where.
    pub place: String,
    /// How it is judged.
    pub judged_by: String,
    /// Why the verdict is what it is.
    pub remark: String,
}

/// A claim with our figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// The claim.
    pub claim: Claim,
    /// Our figure, in words with units.
    pub figure: String,
    /// The numbers in that figure, in its order.
    pub numbers: Vec<f64>,
    /// The verdict.
    pub verdict: Verdict,
}

/// The file, as it is written.
#[derive(Deserialize)]
struct File {
    claim: Vec<Claim>,
}

/// All claims, in the order of the file.
///
/// # Errors
/// The embedded file cannot be read; a test makes sure that it can.
pub fn claims() -> Result<Vec<Claim>, toml::de::Error> {
    let text = include_str!(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../reference/published/paper.toml"
    ));
    toml::from_str::<File>(text).map(|file| file.claim)
}

/// Computes figure and verdict of one claim; up to a few seconds. `None`: no such claim is known here.
///
/// # Errors
/// A run failed that the claim does not expect to fail.
pub fn judge(claim: &Claim) -> Result<Option<Judgement>, NativeError> {
    judge_while(claim, &|| true)
}

/// [`judge`] as long as `go` says so; it is asked at every sample of every run.
///
/// # Errors
/// As [`judge`], and [`NativeError::Stopped`] once `go` is false.
pub fn judge_while(claim: &Claim, go: &dyn Fn() -> bool) -> Result<Option<Judgement>, NativeError> {
    let Some((figure, numbers, verdict)) = figures::of(&claim.id, go)? else {
        return Ok(None);
    };
    Ok(Some(Judgement {
        claim: claim.clone(),
        figure,
        numbers,
        verdict,
    }))
}
