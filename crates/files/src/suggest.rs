//! "Did you mean": the nearest known name to a mistyped one.

/// The known name nearest to `typed`, if it is near enough to be what was meant.
///
/// Near enough: at most a third of the longer name has to change (Damerau-Levenshtein distance,
/// adjacent letters swapped counting once), or one contains the other.
#[must_use]
pub fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // The distance costs the product of both lengths; no key is that long.
    const LONGEST: usize = 80;
    if typed.is_empty() || typed.len() > LONGEST {
        return None;
    }
    let typed = typed.to_lowercase();
    let mut best: Option<(usize, &str)> = None;
    for name in known {
        let lower = name.to_lowercase();
        let distance = strsim::osa_distance(&typed, &lower);
        let longer = typed.chars().count().max(lower.chars().count());
        let contained =
            typed.len() >= 4 && (lower.contains(&typed) || typed.contains(lower.as_str()));
        let near = 3 * distance <= longer || contained;
        if near && best.is_none_or(|(least, _)| distance < least) {
            best = Some((distance, name));
        }
    }
    best.map(|(_, name)| name)
}

/// `did you mean X?`, or the list of what there is.
#[must_use]
pub fn did_you_mean(typed: &str, known: &[&str]) -> String {
    match nearest(typed, known.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("write one of: {}", known.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_was_meant() {
        let known = ["backlash_m", "wheels", "hole_radius_m"];
        assert_eq!(nearest("backlsah_m", known), Some("backlash_m"));
        assert_eq!(nearest("hole_radius", known), Some("hole_radius_m"));
        assert_eq!(nearest("Wheels", known), Some("wheels"));
        assert_eq!(nearest("teeth", known), None);
        assert_eq!(nearest("", known), None);
        assert_eq!(did_you_mean("zzz", &["a", "b"]), "write one of: a, b");
    }
}
