//! Paths of the libraries that C programs load: `libpinwheel_law` and `libpinwheel_fmu`.

use std::path::PathBuf;

/// Returns the library of the contact law: the file named by `PINWHEEL_LAW`, or the one beside the program.
///
/// # Errors
/// No library; the error is one line with the remedy.
pub fn law_library() -> Result<PathBuf, String> {
    library("law", "PINWHEEL_LAW")
}

/// Returns the library of co-simulation units: the file named by `PINWHEEL_FMU`, or the one beside the program.
///
/// # Errors
/// Errors of [`law_library`].
pub fn fmu_library() -> Result<PathBuf, String> {
    library("fmu", "PINWHEEL_FMU")
}

/// Returns `libpinwheel_WHAT`: the file named by the environment variable, or the one beside the program.
fn library(what: &str, variable: &str) -> Result<PathBuf, String> {
    let name = format!(
        "{}pinwheel_{what}{}",
        std::env::consts::DLL_PREFIX,
        std::env::consts::DLL_SUFFIX
    );
    if let Some(named) = crate::env::variable(variable) {
        let path = PathBuf::from(named);
        let library = path
            .is_file()
            .then(|| std::path::absolute(&path).unwrap_or(path.clone()));
        return library.ok_or_else(|| {
            format!(
                "{variable} names {}, which is no file; name {name}, or unset it",
                path.display()
            )
        });
    }
    let program = std::env::current_exe().and_then(std::fs::canonicalize).ok();
    let beside = program.as_deref().and_then(std::path::Path::parent);
    // Cargo keeps libraries of dependencies in `deps`; packages keep them in `lib`.
    let places = [".", "deps", "../lib"];
    let mut library = places.iter().filter_map(|place| {
        let path = beside?.join(place).join(&name);
        path.is_file()
            .then(|| std::fs::canonicalize(&path).unwrap_or(path))
    });
    library.next().ok_or_else(|| {
        format!(
            "{name} is not beside the program; build it in Pinwheel's folder with `cargo build --release -p pinwheel-{what}` \
             and name it by {variable}=target/release/{name}"
        )
    })
}
