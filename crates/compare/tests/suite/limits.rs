//! Patterns of limits.

use pinwheel_compare::limits::fits;

#[test]
fn patterns() {
    for (pattern, text, wanted) in [
        ("native", "native-reduced", false),
        ("rapier*hook*", "rapier-contact-hook", true),
        ("rapier*hook*", "rapier-shared-law", false),
        ("a|b*", "bc", true),
        ("a|b*", "ab", false),
        ("", "a", false),
    ] {
        assert_eq!(fits(pattern, text), wanted, "{pattern} {text}");
    }
}
