//! Simbody: a C++ program, compiled by the system's compiler at first use and stored in the cache folder.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::{env, fs};

use pinwheel_files::Fnv;

use super::ready::Ready;
use crate::cache::{self, CachedBuild, Note, call, fingerprint, storage, unless_stopped};
use crate::engine::{Ending, Halt};
use crate::external::scaffold::HEADER;

/// Manifests for scenes without and with friction: an explicit method, and one for stiff equations.
pub(super) const MANIFESTS: [&str; 2] = ["merson.toml", "cpodes.toml"];

/// Files of the folder `solvers/simbody`: names and texts.
macro_rules! files {
    ($($name:literal)*) => {
        [$(($name, include_str!(concat!(env!("PINWHEEL_SHIPPED"), "/solvers/simbody/", $name))),)*
            ("pinwheel_law.h", HEADER)]
    };
}

/// Files of the solver's folder besides the program.
static FILES: [(&str, &str); 4] = files! { "simbody.cpp" "merson.toml" "cpodes.toml" };

/// Folders of the headers, for systems without pkg-config.
const HEADERS: [&str; 2] = ["/usr/include/simbody", "/usr/local/include/simbody"];

const REMEDY: &str = "Debian: apt install libsimbody-dev g++";

/// File with the hash of all files at the time of compilation.
const SEAL: &str = "whole";

/// Returns the hash of the files of a folder; `None` if one cannot be read.
fn sum(folder: &Path) -> Option<String> {
    let names = FILES.iter().map(|(name, _)| *name).chain(["simbody"]);
    let mut hash = Fnv::default();
    for name in names {
        hash.add_part(&fs::read(folder.join(name)).ok()?);
    }
    Some(format!("{:016x}", hash.value()))
}

/// Installed Simbody.
struct Installed {
    /// Version such as `3.7`, if the system states it.
    version: Option<String>,
    /// Compiler arguments.
    flags: Vec<String>,
}

/// Looks up the installed Simbody.
fn installed() -> Option<Installed> {
    static NEVER: AtomicBool = AtomicBool::new(false);
    let ask = |arguments: &[&str]| call(Path::new("pkg-config"), arguments, None, &NEVER).ok();
    if let Some(version) = ask(&["--modversion", "simbody"]) {
        let flags = ask(&["--cflags", "--libs", "simbody"])?;
        // Its own language standard is older than the program's.
        let words = flags
            .split_whitespace()
            .filter(|word| !word.starts_with("-std="));
        return Some(Installed {
            version: Some(version.trim().to_owned()),
            flags: words.map(str::to_owned).collect(),
        });
    }
    let headers = HEADERS.iter().find(|folder| Path::new(folder).is_dir())?;
    let libraries = ["-lSimTKsimbody", "-lSimTKmath", "-lSimTKcommon"];
    Some(Installed {
        version: None,
        flags: std::iter::once(format!("-I{headers}"))
            .chain(libraries.map(str::to_owned))
            .collect(),
    })
}

/// Returns name and version of the installed Simbody.
pub(super) fn version() -> String {
    match installed().and_then(|package| package.version) {
        Some(version) => format!("Simbody {version}"),
        None => "Simbody".to_owned(),
    }
}

/// Returns the missing parts and how to install them.
pub(super) fn needs() -> Option<String> {
    let missing = || format!("Simbody is not installed; install it ({REMEDY})");
    installed().is_none().then(missing)
}

/// Compiles its program if need be.
pub(super) fn ready(cancel: &AtomicBool) -> Result<Ready, Halt> {
    let not_installed = || Ending::absent(needs().unwrap_or_default());
    let installed = installed().ok_or_else(not_installed)?;
    let compiler = PathBuf::from(env::var_os("CXX").unwrap_or_else(|| "c++".into()));
    let described = call(&compiler, ["--version"], None, cancel).map_err(|reason| {
        let absent = Ending::absent(format!(
            "its program is compiled at the first use, and the C++ compiler does not answer ({reason}); install one \
             ({REMEDY}), or name it with CXX"
        ));
        unless_stopped(cancel, absent.into())
    })?;
    let flags = installed.flags.join(" ");
    let version = installed.version.unwrap_or_default();
    let mut key: Vec<&str> = FILES.iter().map(|&(_, text)| text).collect();
    key.extend([described.as_str(), flags.as_str(), version.as_str()]);
    let compile = |draft: &Path, note: &Note| -> Result<(), Halt> {
        note.say("compiling");
        for (name, text) in &FILES {
            let path = draft.join(name);
            fs::write(&path, text).map_err(|error| storage(&path, error))?;
        }
        let (program, source) = (draft.join("simbody"), draft.join("simbody.cpp"));
        let own = ["-std=c++17", "-O2", "-w", "-o"].map(OsStr::new);
        let files = [program.as_os_str(), source.as_os_str()];
        let libraries = installed.flags.iter().map(OsStr::new);
        let arguments = own.into_iter().chain(files).chain(libraries);
        let arguments = arguments.chain([OsStr::new("-ldl")]);
        call(&compiler, arguments, None, cancel).map_err(|reason| {
            Ending::absent(format!(
                "its program cannot be compiled ({reason}); install all of Simbody ({REMEDY})"
            ))
        })?;
        let seal = draft.join(SEAL);
        fs::write(&seal, sum(draft).unwrap_or_default()).map_err(|error| storage(&seal, error))
    };
    // A build damaged by a full disk or a fault would fail at every run.
    let read = |folder: &Path| {
        let seal = fs::read_to_string(folder.join(SEAL)).ok()?;
        (sum(folder)? == seal).then(|| folder.to_owned())
    };
    let build = CachedBuild {
        name: &format!("simbody-{:016x}", fingerprint(&key)),
        title: "Simbody's program (once)",
        read: &read,
        build: &compile,
    };
    Ok(Ready {
        here: build.once(&cache::folder()?, cancel)?,
        python: None,
    })
}
