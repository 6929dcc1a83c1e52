//! Facts of engines.

use pinwheel_engines::known;

#[test]
fn every_statement_has_a_reason() {
    for row in known().flat_map(|info| info.model) {
        assert!(row.tolerance >= 0.0 && row.reason.ends_with('.'), "{row:?}");
    }
}
