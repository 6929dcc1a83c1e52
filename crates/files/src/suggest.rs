//! Name suggestions for mistyped names, and patterns of names.

/// Returns the known name nearest to `typed`, if it is near enough to be the intended one.
///
/// Near enough: at most a third of the longer name, or of a name's first word (`mujoco` of `mujoco-shared-law`), has to change
/// (Damerau-Levenshtein distance, adjacent swaps counting once); or one contains the other.
pub fn nearest<'a>(typed: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // The cost of the distance is the product of both lengths; no key is that long.
    const LONGEST: usize = 80;
    if typed.is_empty() || typed.len() > LONGEST {
        return None;
    }
    let typed = typed.to_lowercase();
    let near = known.into_iter().filter_map(|name| {
        let lower = name.to_lowercase();
        let first = lower.split('-').next().unwrap_or_default();
        let near = |name: &str| {
            let distance = strsim::osa_distance(&typed, name);
            let longer = typed.chars().count().max(name.chars().count());
            (distance, 3 * distance <= longer)
        };
        let nearer = |a: (usize, bool), b| std::cmp::min_by_key(a, b, |(d, close)| (!close, *d));
        let (distance, close) = nearer(near(&lower), near(first));
        let contained =
            typed.len() >= 4 && (lower.contains(&typed) || typed.contains(lower.as_str()));
        (close || contained).then_some((distance, name))
    });
    let best = near.min_by_key(|(distance, _)| *distance);
    best.map(|(_, name)| name)
}

/// Returns `did you mean X?`, or the list of known names.
pub fn did_you_mean(typed: &str, known: &[&str]) -> String {
    match nearest(typed, known.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => format!("write one of: {}", known.join(", ")),
    }
}

/// True if `text` fits `pattern`, in which `*` stands for any characters.
pub fn fits(pattern: &str, text: &str) -> bool {
    // A single fallback position, so that a pattern of many `*` takes no longer than others.
    let (pattern, text) = (pattern.as_bytes(), text.as_bytes());
    let (mut p, mut t) = (0, 0);
    let mut star: Option<(usize, usize)> = None;
    while t < text.len() {
        match (pattern.get(p), &mut star) {
            (Some(b'*'), _) => {
                star = Some((p, t));
                p += 1;
            }
            (Some(c), _) if *c == text[t] => (p, t) = (p + 1, t + 1),
            (_, Some((at, from))) => {
                *from += 1;
                (p, t) = (*at + 1, *from);
            }
            (_, None) => return false,
        }
    }
    pattern[p..].iter().all(|&c| c == b'*')
}
