//! Colour and dash of each engine, equal on all pages.

use std::collections::BTreeMap;

use crate::COLOURS as COUNT;
use pinwheel_engines::info;

/// Returns the style of each name: fixed for known engines, otherwise derived from the name. Names on a page share a colour
/// only beyond [`COUNT`] of them, and then have different dashes.
pub(crate) fn styles(names: &[&str]) -> Vec<usize> {
    let known = |name: &str| info(name).and_then(|info| info.colour);
    let mut taken: Vec<usize> = names.iter().filter_map(|n| known(n)).collect();
    names
        .iter()
        .map(|name| {
            known(name).unwrap_or_else(|| {
                let first = place(name);
                let free = (0..COUNT).map(|k| (first + k) % COUNT);
                let style = free.clone().find(|style| !taken.contains(style));
                // Beyond all colours they repeat with other dashes.
                let style = style.unwrap_or(first + COUNT * (taken.len() / COUNT));
                taken.push(style);
                style
            })
        })
        .collect()
}

/// Returns the style of each name by the name.
pub(crate) fn by_name<'a>(names: impl IntoIterator<Item = &'a str>) -> BTreeMap<&'a str, usize> {
    let names: Vec<&str> = names.into_iter().collect();
    let styles = styles(&names);
    names.into_iter().zip(styles).collect()
}

/// Returns a number derived from the name alone (FNV-1a).
fn place(name: &str) -> usize {
    let hash = pinwheel_files::fnv(name.bytes());
    (hash % COUNT as u64) as usize
}

#[cfg(test)]
mod tests {
    use pinwheel_engines::known;

    use super::*;

    #[test]
    fn an_engine_keeps_its_colour() {
        let few = styles(&["my-solver", "native-reduced"]);
        let more = styles(&["exudyn-own-contact", "native-reduced", "my-solver", "rig"]);
        assert_eq!((few[0], few[1]), (more[2], more[1]));
        assert_eq!(styles(&["native-resolved"]), [2]);
    }

    #[test]
    fn no_two_of_one_page_share_a_colour() {
        let own: Vec<String> = (0..40).map(|k| format!("solver-{k}")).collect();
        let mut names: Vec<&str> = known().map(|info| info.name).collect();
        names.extend(own.iter().take(COUNT - names.len()).map(String::as_str));
        let mut assigned = styles(&names);
        assigned.sort_unstable();
        assert_eq!(assigned, (0..COUNT).collect::<Vec<_>>());
        let names: Vec<&str> = own.iter().map(String::as_str).collect();
        let mut assigned = styles(&names[..COUNT]);
        assigned.sort_unstable();
        assigned.dedup();
        assert_eq!(assigned.len(), COUNT);
        assert!(styles(&names)[COUNT..].iter().all(|s| *s >= COUNT));
    }
}
