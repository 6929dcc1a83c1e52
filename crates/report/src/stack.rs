//! Shares of a sum as one bar, with name and share of each part.

use std::fmt::Write as _;

use pinwheel_files::output::escape;

use crate::COLOURS;
use crate::format::significant;

/// Returns the markup of the bar. The length of a part is its share. The list below names every part, however short.
pub fn stack(caption: &str, parts: &[(&str, f64)]) -> String {
    let (mut bar, mut names) = (String::new(), String::new());
    for (k, (name, share)) in parts.iter().enumerate() {
        let (name, colour) = (escape(name), k % COLOURS);
        let percent = 100.0 * share.clamp(0.0, 1.0);
        let (shown, part) = (
            significant(100.0 * share, 2),
            format!("--part:var(--line-{colour})"),
        );
        let _ = write!(bar, "<i style=\"flex:{percent:.4};{part}\"></i>");
        let _ = write!(names, "<li style=\"{part}\">{name} <b>{shown} %</b></li>");
    }
    let caption = escape(caption);
    format!(
        "<figure class=\"stack\"><figcaption>{caption}</figcaption><div aria-hidden=\"true\">{bar}</div><ul>{names}</ul></figure>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_as_long_as_their_shares() {
        let markup = stack("a <caption>", &[("one", 0.25), ("two", 0.75)]);
        assert!(markup.contains("a &lt;caption&gt;"));
        assert!(markup.contains("flex:25.0000") && markup.contains("flex:75.0000"));
        assert!(markup.contains("two <b>75 %</b>"), "{markup}");
    }
}
