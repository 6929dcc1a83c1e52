//! `pinwheel laws`: the contact laws a scene can name.

use pinwheel_contact::laws::{LAWS, LawInfo};
use serde_json::json;

use crate::args::LawsArgs;
use crate::failure::Failure;
use crate::screen::{self, TITLE, styled};

pub(crate) fn laws(args: &LawsArgs) -> Result<u8, Failure> {
    let text = if args.json {
        let list: Vec<_> = LAWS.iter().map(as_json).collect();
        format!("{:#}", json!(list))
    } else {
        LAWS.iter().map(in_words).collect::<Vec<_>>().join("\n")
    };
    screen::show(&text)?;
    Ok(0)
}

fn as_json(law: &LawInfo) -> serde_json::Value {
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
