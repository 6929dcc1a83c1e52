//! The contact laws a scene can name.

use pinwheel_contact::laws::{LAWS, LawInfo};
use pinwheel_report::terminal::{TITLE, styled};
use serde_json::json;

/// All laws, one after the other.
#[must_use]
pub fn text() -> String {
    LAWS.iter().map(in_words).collect::<Vec<_>>().join("\n")
}

/// The same for programs.
#[must_use]
pub fn json() -> serde_json::Value {
    let each = LAWS.iter().map(|law| {
        json!({
            "name": law.name,
            "summary": law.summary,
            "formula": law.formula,
            "source": law.source,
            "domain": law.domain,
            "slow_impact": law.slow_impact,
            "keys": law.keys,
            "conservative": law.conservative,
        })
    });
    each.collect()
}

fn in_words(law: &LawInfo) -> String {
    let potential = if law.conservative {
        "has a potential without damping"
    } else {
        "has no potential on a profile of varying curvature"
    };
    let keys = if law.keys.is_empty() {
        String::new()
    } else {
        format!("\n  keys    {}", law.keys.join(", "))
    };
    format!(
        "{}: {}\n  force   {}\n  source  {}\n  domain  {}\n  slow    {}\n  energy  {potential}{keys}\n",
        styled(TITLE, law.name),
        law.summary,
        law.formula,
        law.source,
        law.domain,
        law.slow_impact,
    )
}
