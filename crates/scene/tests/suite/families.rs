//! Families of channels.

use pinwheel_files::fits;
use pinwheel_scene::Layout;
use pinwheel_scene::channels::{Chosen, FAMILIES, always_there};

const LAYOUT: Layout = Layout {
    wheels: 2,
    external_sleeves: 11,
    internal_sleeves: 3,
};

/// Every family's pattern selects exactly its own members, and column names are unique.
#[test]
fn a_family_is_its_pattern() {
    let all: Vec<Chosen> = FAMILIES.iter().flat_map(|f| f.members(LAYOUT)).collect();
    for family in FAMILIES {
        let own: Vec<Chosen> = family.members(LAYOUT).collect();
        let matches = all.iter().filter(|c| fits(family.pattern, &c.name));
        assert!(matches.eq(own.iter()), "{}", family.pattern);
        assert!(!own.is_empty() && own.iter().all(|c| !c.name.contains('*')));
    }
    let mut names: Vec<&str> = all.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), all.len());
}

#[test]
fn contract_columns_are_known() {
    assert!(always_there("output_*", LAYOUT));
    assert!(always_there("external_sleeve_force_n_10", LAYOUT));
    assert!(!always_there("external_sleeve_force_n_11", LAYOUT));
}
