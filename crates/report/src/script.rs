//! Data and code in a page.

use std::fmt::Write as _;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use pinwheel_files::output::steers;
use serde::Serialize;
use serde_json::json;

/// Level of compression; higher ones take twice the time for 1 % of the size.
const LEVEL: u8 = 8;

/// Returns an element with a script.
pub fn code(code: &str) -> String {
    format!("<script>{code}</script>\n")
}

/// Returns an element with data for scripts, identified by its `id`.
pub fn data(id: &str, value: &impl Serialize) -> String {
    let json = json_text(value);
    format!("<script type=\"application/json\" id=\"{id}\">{json}</script>\n")
}

/// Returns JSON for a script element: no character can end it or begin a comment. Control characters appear as numbers, as
/// in the rest of a page.
pub fn json_text(value: &impl Serialize) -> String {
    let json = json!(value).to_string();
    let mut safe = String::with_capacity(json.len());
    for c in json.chars() {
        let sign = if steers(c) { "\\\\u" } else { "\\u" };
        if steers(c) || matches!(c, '<' | '>' | '&' | '\u{2028}' | '\u{2029}') {
            let _ = write!(safe, "{sign}{:04x}", u32::from(c));
        } else {
            safe.push(c);
        }
    }
    safe
}

/// Returns deflated bytes as base64, for `assets/packed.js`.
pub fn packed(bytes: &[u8]) -> String {
    STANDARD.encode(miniz_oxide::deflate::compress_to_vec(bytes, LEVEL))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_cannot_be_left() {
        let text = "</script><!-- & \u{2028}";
        let json = json_text(&text);
        assert_eq!(json, "\"\\u003c/script\\u003e\\u003c!-- \\u0026 \\u2028\"");
        assert_eq!(json_text(&"\u{202e}x"), "\"\\\\u202ex\"");
        assert_eq!(serde_json::from_str::<String>(&json).unwrap(), text);
    }
}
