//! Selection of columns by a scene's patterns.

use pinwheel_files::fits;

use super::catalogue::{Chosen, FAMILIES, Family, always_there};
use crate::error::Fault;
use crate::layout::Layout;
use crate::nearest;

/// Largest number of entries of `output.channels`.
pub const MOST_PATTERNS: usize = 200;
/// Largest length of an entry, characters; the longest name has about 50.
const LONGEST: usize = 80;

/// Makes the fault of `output.channels` with a pattern that selects no channel.
fn fault(what: String, remedy: impl Into<String>) -> Fault {
    Fault::new(&["output.channels"], what, remedy)
}

/// Returns the columns that the patterns select, each once, in the order of the catalogue.
///
/// # Errors
/// The first pattern that matches no column.
pub fn select(patterns: &[String], layout: Layout) -> Result<Vec<Chosen>, Fault> {
    if patterns.is_empty() {
        return Ok(Vec::new());
    }
    if patterns.len() > MOST_PATTERNS || patterns.iter().any(|p| p.len() > LONGEST) {
        return Err(fault(
            format!(
                "has more than {MOST_PATTERNS} entries, or one of more than {LONGEST} characters"
            ),
            "use `*` for any characters: \"wheel_0_external_*\"",
        ));
    }
    let mut used = vec![false; patterns.len()];
    let mut chosen = Vec::new();
    // Most families end here, before their members exist.
    let digit = |c: char| c.is_ascii_digit();
    let general: Vec<String> = (patterns.iter().map(|p| p.trim().replace(digit, "*"))).collect();
    let may = |family: &&Family| {
        let some = family.pattern.replace('*', "0");
        general.iter().any(|pattern| fits(pattern, &some))
    };
    let families = FAMILIES.iter().filter(may);
    for member in families.flat_map(|family| family.members(layout)) {
        let mut wanted = false;
        for (pattern, used) in patterns.iter().zip(&mut used) {
            if fits(pattern.trim(), &member.name) {
                (*used, wanted) = (true, true);
            }
        }
        if wanted {
            chosen.push(member);
        }
    }
    let unused = patterns
        .iter()
        .zip(used)
        .find(|(pattern, used)| !used && !always_there(pattern.trim(), layout));
    match unused {
        Some((pattern, _)) => Err(unknown(pattern.trim(), layout)),
        None => Ok(chosen),
    }
}

/// Returns a fault with suggested names: numbers out of range, then the nearest family.
fn unknown(typed: &str, layout: Layout) -> Fault {
    let numeric =
        |part: &str| part == "*" || (!part.is_empty() && part.bytes().all(|b| b.is_ascii_digit()));
    let parts: Vec<&str> = typed.split('_').collect();
    let numbers: Vec<&str> = parts.iter().copied().filter(|part| numeric(part)).collect();
    let general: Vec<&str> = parts
        .iter()
        .map(|part| if numeric(part) { "*" } else { part })
        .collect();
    let general = general.join("_");
    if FAMILIES.iter().any(|family| family.pattern == general)
        || general.ends_with("_sleeve_force_n_*")
    {
        let last = |count: usize| count.saturating_sub(1);
        let (wheels, external) = (last(layout.wheels), last(layout.external_sleeves));
        let internal = last(layout.internal_sleeves);
        return fault(
            format!("has no `{typed}`: no such disc or pin"),
            format!(
                "discs are 0 to {wheels}, ring pins 0 to {external}, output pins 0 to {internal}"
            ),
        );
    }
    let remedy = match nearest(&general, FAMILIES.iter().map(|family| family.pattern)) {
        Some(near) => {
            let mut name = near.to_owned();
            if near.matches('*').count() == numbers.len() {
                for number in numbers {
                    // A `*` that stays would match again, so it is marked.
                    name = name.replacen('*', if number == "*" { "\0" } else { number }, 1);
                }
            }
            format!("did you mean `{}`?", name.replace('\0', "*"))
        }
        None => "`pinwheel explain SCENE --json` lists them under channels_available; for example \
             \"wheel_0_external_penetration_m_3\" or \"wheel_0_external_*\""
            .to_owned(),
    };
    fault(format!("has no `{typed}`"), remedy)
}
