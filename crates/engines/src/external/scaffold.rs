//! Small working solvers as templates: the examples of `examples/solvers` with another name.

use std::path::Path;
use std::{fs, io};

/// Example in a language.
#[derive(Debug, Clone, Copy)]
pub struct Language {
    /// Name of the example and its folder.
    example: &'static str,
    manifest: &'static str,
    /// Name of the file, and its text.
    source: [&'static str; 2],
    /// True if the source includes the header of the law library.
    header: bool,
}

macro_rules! languages {
    ($($typed:literal $about:literal: $folder:literal $source:literal, $header:literal;)*) => {
        [$(($typed, $about, Language {
            example: $folder,
            manifest: include_str!(concat!(env!("PINWHEEL_SHIPPED"), "/examples/solvers/", $folder, "/solver.toml")),
            source: [$source, include_str!(concat!(env!("PINWHEEL_SHIPPED"), "/examples/solvers/", $folder, "/", $source))],
            header: $header,
        })),*]
    };
}

/// Languages with an example: name on the command line, description, example.
pub static LANGUAGES: [(&str, &str, Language); 5] = languages! {
    "c" "C, Runge-Kutta 4": "c-rk4" "solver.c", true;
    "cpp" "C++, Runge-Kutta 4": "cpp-rk4" "solver.cpp", true;
    "fortran" "Fortran, Heun": "fortran-heun" "solver.f90", false;
    "python" "Python, Heun": "python-heun" "solver.py", false;
    "numpy" "Python with numpy, Runge-Kutta 4, contacts of its own": "numpy-contacts" "solver.py", false;
};

/// Header of the law library.
pub(crate) const HEADER: &str = include_str!(concat!(
    env!("PINWHEEL_SHIPPED"),
    "/crates/law/include/pinwheel_law.h"
));

impl Language {
    /// Returns names and texts of the files of a solver named `name`.
    pub fn files(self, name: &str) -> Vec<(&'static str, String)> {
        let example = format!("\"{}\"", self.example);
        let manifest = self.manifest.replace(&example, &format!("{name:?}"));
        let [source, text] = self.source;
        let mut files = vec![("solver.toml", manifest), (source, text.to_owned())];
        if self.header {
            files.push(("pinwheel_law.h", HEADER.to_owned()));
        }
        files
    }

    /// Writes the files of a solver named `name` into an existing folder; returns their names.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(self, folder: &Path, name: &str) -> io::Result<Vec<&'static str>> {
        let each = self.files(name).into_iter().map(|(file, text)| {
            fs::write(folder.join(file), text)?;
            Ok(file)
        });
        each.collect()
    }
}
