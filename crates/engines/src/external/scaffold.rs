//! Small solvers that work, to begin with: the examples of `examples/solvers` under a name of one's own.

use std::path::Path;
use std::{fs, io};

/// A language that there is an example in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Language {
    /// C, Runge-Kutta 4.
    C,
    /// C++, Runge-Kutta 4.
    Cpp,
    /// Fortran, Heun.
    Fortran,
    /// Python, Heun.
    Python,
    /// Julia, Runge-Kutta 4.
    Julia,
}

macro_rules! example {
    ($folder:literal / $source:literal) => {
        (
            $folder,
            include_str!(concat!(
                "../../../../examples/solvers/",
                $folder,
                "/solver.toml"
            )),
            $source,
            include_str!(concat!(
                "../../../../examples/solvers/",
                $folder,
                "/",
                $source
            )),
        )
    };
}

/// The header of the law library.
pub const HEADER: &str = include_str!("../../../law/include/pinwheel_law.h");

impl Language {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::C, Self::Cpp, Self::Fortran, Self::Python, Self::Julia];

    /// The files of a solver called `name`: their names and texts.
    #[must_use]
    pub fn files(self, name: &str) -> Vec<(&'static str, String)> {
        let (example, manifest, source, text) = match self {
            Self::C => example!("c-rk4" / "solver.c"),
            Self::Cpp => example!("cpp-rk4" / "solver.cpp"),
            Self::Fortran => example!("fortran-heun" / "solver.f90"),
            Self::Python => example!("python-heun" / "solver.py"),
            Self::Julia => example!("julia-rk4" / "solver.jl"),
        };
        let named = manifest.replace(&format!("\"{example}\""), &format!("{name:?}"));
        let mut files = vec![("solver.toml", named), (source, text.to_owned())];
        if matches!(self, Self::C | Self::Cpp) {
            files.push(("pinwheel_law.h", HEADER.to_owned()));
        }
        files
    }

    /// Writes the files of a solver called `name` into a folder that is there; gives their names.
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
