//! `pinwheel laws`: the contact laws a scene can name.

use pinwheel::contact::laws::{LAWS, LawInfo};
use pinwheel::pages;
use serde_json::json;

use crate::args::LawsArgs;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn laws(args: &LawsArgs) -> Result<u8, Failure> {
    let text = if args.json {
        let list: Vec<_> = LAWS.iter().map(as_json).collect();
        format!("{:#}", json!(list))
    } else {
        pages::laws::text()
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
