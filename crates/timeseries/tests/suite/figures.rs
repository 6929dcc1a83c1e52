//! The list of figures.

use std::collections::BTreeSet;

use pinwheel_timeseries::figure::definitions::all;

/// The table of `docs/glossary.md` is that of the definitions, and no two have one key.
#[test]
fn figures_are_in_the_glossary() {
    let rows = all().map(|def| {
        format!(
            "| `{}` | {} | {} | {} |\n",
            def.key, def.label, def.unit, def.how
        )
    });
    let table: String = rows.collect();
    let place = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/glossary.md");
    let glossary = std::fs::read_to_string(place).unwrap();
    assert!(
        glossary.contains(&format!("|---|---|---|---|\n{table}\n")),
        "docs/glossary.md: the table of figures should be\n{table}"
    );
    let keys: BTreeSet<&str> = all().map(|def| &*def.key).collect();
    assert_eq!(keys.len(), all().count());
}
