//! Messages.

use pinwheel_files::{FileError, one_line, quoted};

#[test]
fn messages_stay_on_one_line() {
    let error = FileError::new("a\nb.toml", "is\r\nwrong\u{7}", "mend it").in_line(3);
    assert_eq!(
        error.to_string(),
        "a b.toml, line 3: is  wrong\\u{7}; mend it"
    );
    assert!(one_line(&"x".repeat(10_000)).len() < 500);
    assert_eq!(quoted("ab"), "\"ab\"");
    assert!(quoted(&"é".repeat(100)).ends_with("...\""));
}
