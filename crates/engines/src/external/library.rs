//! Where `libpinwheel_law` is.

use std::path::PathBuf;

/// The variable that names it.
const VARIABLE: &str = "PINWHEEL_LAW";

/// The library: as `PINWHEEL_LAW` names it, or beside the program, where a build of the program puts it.
///
/// # Errors
/// It is nowhere: what to do, on one line.
pub fn law_library() -> Result<PathBuf, String> {
    let name = format!(
        "{}pinwheel_law{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    if let Some(named) = std::env::var_os(VARIABLE).filter(|value| !value.is_empty()) {
        let path = PathBuf::from(named);
        let found = path
            .is_file()
            .then(|| std::path::absolute(&path).unwrap_or(path.clone()));
        return found.ok_or_else(|| {
            format!(
                "{VARIABLE} names {}, which is no file; name {name}, or unset it",
                path.display()
            )
        });
    }
    let program = std::env::current_exe().and_then(std::fs::canonicalize).ok();
    let beside = program.as_deref().and_then(std::path::Path::parent);
    // Cargo keeps libraries of dependencies in `deps`; packages keep them in `lib`.
    let places = [".", "deps", "../lib"];
    let mut found = places.iter().filter_map(|place| {
        let path = beside?.join(place).join(&name);
        path.is_file()
            .then(|| std::fs::canonicalize(&path).unwrap_or(path))
    });
    found.next().ok_or_else(|| {
        format!(
            "{name} is not beside the program; build it in Pinwheel's folder with `cargo build --release -p pinwheel-law` \
             and name it by {VARIABLE}=target/release/{name}"
        )
    })
}
