//! List of the available contact laws.

use crate::format::joined;
use crate::terminal::{TITLE, pairs, paragraph, styled};
use pinwheel_contact::laws::{LAWS, LawInfo, Shape};
use serde_json::json;

/// Returns all laws as text.
pub fn text() -> String {
    joined("\n", LAWS.iter().map(in_words))
}

/// Returns all laws as JSON.
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
            "contacts_of": law.shape.name(),
            "face_width_enters": law.shape == Shape::Line,
            "materials": law.materials,
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
    let keys = law.keys.join(", ");
    let facts = [
        ("force", law.formula),
        ("contacts", law.shape.words()),
        ("materials", law.materials),
        ("source", law.source),
        ("domain", law.domain),
        ("slow", law.slow_impact),
        ("energy", potential),
        ("keys", &keys),
    ];
    let facts = facts.into_iter().filter(|(_, text)| !text.is_empty());
    let facts = pairs(facts.map(|(what, text)| (format!("  {what}"), text)));
    let name = paragraph(&format!("{}: {}", law.name, law.summary));
    let name = name.replacen(law.name, &styled(TITLE, law.name), 1);
    format!("{name}\n{facts}")
}
