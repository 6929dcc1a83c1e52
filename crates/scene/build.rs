//! Locates the presets: in the repository, or in a package beside the sources.

use std::env;
use std::path::Path;

fn main() {
    let here = env::var("CARGO_MANIFEST_DIR").unwrap_or_default();
    // Packages have copies of the links' targets. A checkout without links (Windows) has small files instead.
    let shipped = format!("{here}/shipped");
    let shipped = if Path::new(&shipped).join("reference/scenes").is_dir() {
        shipped
    } else {
        format!("{here}/../..")
    };
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-env=PINWHEEL_SHIPPED={shipped}");
}
