//! Exchange of folders.

use std::fs;

use pinwheel_files::folder::by_renames;

#[test]
fn renames_exchange_too() {
    let base = tempfile::tempdir().unwrap();
    let [new, old] = ["new", "old"].map(|name| base.path().join(name));
    for (place, text) in [(&new, "1"), (&old, "2")] {
        fs::create_dir(place).unwrap();
        fs::write(place.join("f"), text).unwrap();
    }
    by_renames(&new, &old).unwrap();
    assert_eq!(fs::read_to_string(old.join("f")).unwrap(), "1");
    assert_eq!(fs::read_to_string(new.join("f")).unwrap(), "2");
    assert_eq!(fs::read_dir(base.path()).unwrap().count(), 2);
}
