//! Removal of control sequences from text for terminals.

use std::fmt::Write as _;

use pinwheel_files::output::steers;

/// Largest number of characters of a message: less than a screen.
const LONGEST: usize = 1600;

/// Returns a message without its middle, if it is longer than a screen: the fault is at the start, the remedy at the end.
pub fn shortened(message: &str) -> String {
    let count = message.chars().count();
    if count <= LONGEST {
        return message.to_owned();
    }
    let head = LONGEST * 3 / 4;
    let tail = LONGEST - head - 50;
    let first: String = message.chars().take(head).collect();
    let last: String = message.chars().skip(count - tail).collect();
    let left_out = count - head - tail;
    format!("{first} [{left_out} characters left out] {last}")
}

/// Returns the text with control characters written out as `\u001b`, which JSON reads back; `laid_out` text keeps its line
/// ends, tabs and colours.
pub fn sanitize(text: &str, laid_out: bool) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let colour = if laid_out { colour(rest) } else { 0 };
        if colour > 0 {
            out.push_str(&rest[..colour]);
            rest = &rest[colour..];
            continue;
        }
        if steers(c) && !(laid_out && matches!(c, '\n' | '\t')) {
            let _ = write!(out, "\\u{:04x}", u32::from(c));
        } else {
            out.push(c);
        }
        rest = &rest[c.len_utf8()..];
    }
    out
}

/// Returns the length of a leading colour sequence (`ESC [ 1 ; 31 m`); 0 without one.
fn colour(text: &str) -> usize {
    let Some(rest) = text.strip_prefix("\u{1b}[") else {
        return 0;
    };
    let is_parameter = |c: char| c.is_ascii_digit() || c == ';';
    let end = rest.trim_start_matches(is_parameter);
    match end.starts_with('m') {
        true => text.len() - end.len() + 1,
        false => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_steers_the_terminal() {
        let evil = "a\u{1b}]0;t\u{7}b\u{9b}2J\u{202e}c\r\nd\u{1b}[2Je";
        let text = sanitize(evil, false);
        assert_eq!(
            text,
            "a\\u001b]0;t\\u0007b\\u009b2J\\u202ec\\u000d\\u000ad\\u001b[2Je"
        );
        assert_eq!(
            sanitize("\u{1b}[1;31mred\u{1b}[0m\n\u{1b}[2J", true),
            "\u{1b}[1;31mred\u{1b}[0m\n\\u001b[2J"
        );
        let json = serde_json::to_string("\u{9b}\u{1b}").unwrap();
        let back: String = serde_json::from_str(&sanitize(&json, true)).unwrap();
        assert_eq!(back, "\u{9b}\u{1b}");
    }

    #[test]
    fn long_messages_lose_their_middle() {
        let long = format!("file: {}; mend it", "x".repeat(100_000));
        let text = shortened(&long);
        assert!(text.chars().count() <= LONGEST && text.ends_with("; mend it"));
        assert!(text.starts_with("file: x"), "{text}");
        assert_eq!(shortened("short"), "short");
    }
}
