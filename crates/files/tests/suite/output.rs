//! Names and texts of outputs.

use std::fs::File;
use std::io::{BufWriter, Write as _};
use std::path::Path;

use pinwheel_files::output::*;

#[test]
fn names_are_one_safe_part_of_a_path() {
    for (name, file) in [
        ("paper", "paper"),
        ("Zahn\u{e4}rztin 2.5", "Zahn\u{e4}rztin-2.5"),
        ("../../etc", "-..-etc"),
        ("/tmp/abs", "-tmp-abs"),
        ("..", "unnamed"),
        ("", "unnamed"),
        ("a\\b:c\u{1b}", "a-b-c-"),
    ] {
        assert_eq!(file_name(name), file, "{name:?}");
    }
    assert_eq!(file_name(&"\u{e4}".repeat(300)).len(), 80);
}

#[test]
fn markup_holds_nothing_that_steers() {
    let evil = "<b a='\"'>&\u{202e}gpj\u{2066}\u{1b}\n\t\u{e4}";
    let safe = "&lt;b a=&#39;&quot;&#39;&gt;&amp;\\u202egpj\\u2066\\u001b\n\t\u{e4}";
    assert_eq!(escape(evil), safe);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_called_so() {
    let full = Path::new("/dev/full");
    assert_eq!(
        write_text(full, "x").unwrap_err().reason,
        "the disk is full"
    );
    let write = |sink: &mut BufWriter<File>| sink.write_all(b"x");
    let error = write_with(Path::new("/dev"), "full", write).unwrap_err();
    assert_eq!(error.reason, "the disk is full");
}
