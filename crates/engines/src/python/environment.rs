//! Virtual environment of the Python engines: made at first use and reused.
//!
//! It is in the user's [cache folder](crate::cache); its name depends on the interpreter and every pinned package, so a
//! change of either makes another one.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use super::interpreter::{ENVIRONMENT, Interpreter, interpreter, no_interpreter};
use crate::cache::{self, Note, call, fingerprint, storage, unless_stopped};
use crate::engine::{Ending, Halt};
use crate::env::variable;

/// Variable with a folder of wheels for installation without a network.
pub const WHEELS: &str = "PINWHEEL_WHEELS";

/// File with the requirements, written last into an environment.
pub const MARKER: &str = "pinwheel-requirements.txt";

/// Pinned packages with hashes.
#[derive(Debug, Clone, Copy)]
pub struct Requirements {
    /// Short name, part of the environment's name.
    pub name: &'static str,
    /// Path of the requirements file in the repository, for installation by hand.
    pub file: &'static str,
    /// Text of the requirements file, with hashes.
    pub text: &'static str,
    /// True if only listed packages are installed, without their other dependencies, which are never imported.
    pub only_listed: bool,
}

impl Requirements {
    /// Returns pip's arguments for the packages.
    fn arguments(&self, list: &Path) -> Vec<OsString> {
        let mut arguments: Vec<OsString> = vec!["--require-hashes".into()];
        if self.only_listed {
            arguments.push("--no-deps".into());
        }
        arguments.extend(["-r".into(), list.into()]);
        arguments
    }
}

/// Packages that the engines need.
pub const ENGINES: Requirements = Requirements {
    name: "engines",
    file: "python/requirements.txt",
    only_listed: false,
    text: include_str!(concat!(
        env!("PINWHEEL_SHIPPED"),
        "/python/requirements.txt"
    )),
};

/// Environment ready for use.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Environment {
    /// Folder of the environment.
    pub folder: PathBuf,
    /// Python interpreter.
    pub python: PathBuf,
    /// Folder of the packages.
    pub packages: PathBuf,
}

impl Requirements {
    /// Returns the packages that are missing on this machine, without installing any; `None` if all are present.
    pub(crate) fn needs(self) -> Option<String> {
        let why = |halt: Halt| Some(halt.to_string());
        let interpreter = match interpreter() {
            Ok(interpreter) => interpreter,
            Err(halt) => return why(halt),
        };
        if let Some(folder) = variable(ENVIRONMENT) {
            let named = named(Path::new(&folder), &interpreter, &AtomicBool::new(false));
            return named.err().and_then(why);
        }
        let folder = cache::folder().map(|cache| cache.join(name_of(self, &interpreter)));
        match folder {
            Err(halt) => why(halt),
            Ok(folder) if folder.join(MARKER).is_file() => None,
            Ok(_) => Some("pip installs the packages at the first use".to_owned()),
        }
    }
}

/// The environment with the given packages, made if need be; `ENVIRONMENT` and `WHEELS` are heeded.
///
/// # Errors
/// The reason for the failure with the remedy; a stop.
pub fn environment(requirements: Requirements, cancel: &AtomicBool) -> Result<Environment, Halt> {
    let interpreter = interpreter()?;
    if let Some(folder) = variable(ENVIRONMENT) {
        return named(Path::new(&folder), &interpreter, cancel);
    }
    let wheels = variable(WHEELS).map(PathBuf::from);
    ensure(
        requirements,
        &interpreter,
        &cache::folder()?,
        wheels.as_deref(),
        cancel,
    )
}

/// Returns the environment named by the user.
pub fn named(
    folder: &Path,
    interpreter: &Interpreter,
    cancel: &AtomicBool,
) -> Result<Environment, Halt> {
    let refuse = |reason: String| -> Halt {
        Ending::absent(format!(
            "{ENVIRONMENT} = {}: {reason}; name an environment made with `python3 -m venv` and filled with `pip install -r \
             python/requirements.txt`, or unset {ENVIRONMENT}",
            folder.display()
        ))
        .into()
    };
    let (environment, version, _) =
        probe(folder, cancel).map_err(|reason| unless_stopped(cancel, refuse(reason)))?;
    let minor = |version: &str| version.rsplit_once('.').map(|(minor, _)| minor.to_owned());
    if minor(&version) != minor(&interpreter.version) {
        return Err(refuse(format!(
            "it is of Python {version}, and this program embeds {}",
            interpreter.version
        )));
    }
    Ok(environment)
}

/// Queries an environment's interpreter for the folder of its packages, its version, and the packages (`name==version`)
/// with unchanged files. A file is unchanged if its length is; a file newer than the [`MARKER`] must also have pip's
/// recorded hash. Hashing every file would read 130 MB at every start.
fn probe(folder: &Path, cancel: &AtomicBool) -> Result<(Environment, String, Vec<String>), String> {
    let python = python_of(folder);
    if !python.exists() {
        return Err(format!("there is no {}", python.display()));
    }
    let ask = "import base64, hashlib, os, sys, sysconfig, importlib.metadata as m
print('%d.%d.%d' % sys.version_info[:3])
print(p := sysconfig.get_path('purelib'))
touched = lambda s: max(s.st_ctime_ns, s.st_mtime_ns)
try: made = touched(os.stat(os.path.join(sys.prefix, sys.argv[1])))
except OSError: made = float('inf')
def same(f):
    if f.size is None: return True
    try:
        s = os.stat(f.locate())
        if s.st_size != f.size: return False
        if f.hash is None or touched(s) <= made: return True
        with open(f.locate(), 'rb') as o: h = hashlib.new(f.hash.mode, o.read()).digest()
    except OSError: return False
    return base64.urlsafe_b64encode(h).decode().rstrip('=') == f.hash.value
for d in m.distributions(path=[p]):
    if all(map(same, d.files or [])): print('%s==%s' % (d.name, d.version))";
    let answer = call(&python, ["-I", "-c", ask, MARKER], None, cancel)?;
    let mut lines = answer.lines();
    match (lines.next(), lines.next()) {
        (Some(version), Some(packages)) => Ok((
            Environment {
                folder: folder.to_owned(),
                python,
                packages: PathBuf::from(packages),
            },
            version.to_owned(),
            lines.map(plain).collect(),
        )),
        _ => Err(format!("{} does not answer", python.display())),
    }
}

/// Returns a requirement `name==version` with the name normalised by the packaging standard.
fn plain(pin: &str) -> String {
    pin.to_lowercase().replace(['_', '.'], "-")
}

/// Returns the environment from the cache, or makes it under a lock.
pub fn ensure(
    requirements: Requirements,
    interpreter: &Interpreter,
    cache: &Path,
    wheels: Option<&Path>,
    cancel: &AtomicBool,
) -> Result<Environment, Halt> {
    let made = cache::CachedBuild {
        name: &name_of(requirements, interpreter),
        title: "Python packages (once)",
        read: &|folder: &Path| complete(folder, requirements, cancel),
        build: &|draft: &Path, note: &Note| {
            let executable = executable(interpreter, cancel)?;
            make(draft, &executable, requirements, wheels, note, cancel)
        },
    };
    made.once(cache, cancel)
}

/// Returns the folder name of an environment, specific to interpreter and packages.
pub fn name_of(requirements: Requirements, interpreter: &Interpreter) -> String {
    let key = fingerprint(&[
        requirements.text,
        &interpreter.version,
        // Two installations of one version may have different libraries.
        &interpreter
            .candidates
            .first()
            .map_or_else(String::new, |path| path.display().to_string()),
    ]);
    format!(
        "python-{}-{}-{key:016x}",
        interpreter.version, requirements.name
    )
}

/// Returns a complete environment, or `None`: the marker shows that pip succeeded, and every package must still be there.
pub fn complete(
    folder: &Path,
    requirements: Requirements,
    cancel: &AtomicBool,
) -> Option<Environment> {
    let marker = fs::read_to_string(folder.join(MARKER)).ok()?;
    if marker != requirements.text {
        return None;
    }
    let (environment, _, installed) = probe(folder, cancel).ok()?;
    let words = requirements
        .text
        .lines()
        .filter_map(|line| line.split_whitespace().next());
    let mut pins = words.filter(|word| word.contains("==") && !word.starts_with(['#', '-']));
    pins.all(|pin| installed.contains(&plain(pin)))
        .then_some(environment)
}

/// Returns the executable of the embedded interpreter.
fn executable(interpreter: &Interpreter, cancel: &AtomicBool) -> Result<PathBuf, Halt> {
    let ask = "import sys; print('%d.%d.%d' % sys.version_info[:3])";
    interpreter
        .candidates
        .iter()
        .find(|path| {
            call(path, ["-I", "-c", ask], None, cancel)
                .is_ok_and(|answer| answer.trim() == interpreter.version)
        })
        .cloned()
        .ok_or_else(|| {
            let tried = interpreter.candidates.iter();
            let tried: Vec<String> = tried.map(|path| path.display().to_string()).collect();
            no_interpreter(&interpreter.version, &tried.join(", "))
        })
}

/// Returns the script that runs an interpreter's pip in another one; `None` if it has none.
fn pip_of(executable: &Path, cancel: &AtomicBool) -> Option<PathBuf> {
    let ask =
        "import os, pip; print(os.path.join(os.path.dirname(pip.__file__), '__pip-runner__.py'))";
    let answer = call(executable, ["-I", "-c", ask], None, cancel).ok()?;
    Some(PathBuf::from(answer.trim())).filter(|script| script.is_file())
}

/// Creates and fills an environment by the interpreter's pip, whose copy would take most of the time; the marker comes last.
fn make(
    draft: &Path,
    executable: &Path,
    requirements: Requirements,
    wheels: Option<&Path>,
    note: &Note,
    cancel: &AtomicBool,
) -> Result<(), Halt> {
    note.say("making a virtual environment");
    let pip = pip_of(executable, cancel);
    let venv = ["-I", "-m", "venv"].map(OsStr::new).into_iter();
    let without = pip.iter().map(|_| "--without-pip".as_ref());
    let arguments = venv.chain(without).chain([draft.as_os_str()]);
    call(executable, arguments, Some(note), cancel).map_err(|reason| {
        Ending::absent(format!(
            "no virtual environment can be made with {}: {reason}; install its module venv (Debian: apt install \
             python3-venv), or name an environment with {ENVIRONMENT}",
            executable.display()
        ))
    })?;
    let list = draft.join("requirements.txt");
    fs::write(&list, requirements.text).map_err(|error| storage(&list, error))?;
    let install = "install --disable-pip-version-check --no-input --progress-bar off --only-binary :all: --retries 2";
    let mut arguments: Vec<&OsStr> = match &pip {
        Some(script) => vec!["-I".as_ref(), script.as_ref()],
        None => ["-I", "-m", "pip"].map(OsStr::new).to_vec(),
    };
    arguments.extend(install.split(' ').map(OsStr::new));
    let named = requirements.arguments(&list);
    if let Some(wheels) = wheels {
        arguments.extend([
            OsStr::new("--no-index"),
            "--find-links".as_ref(),
            wheels.as_ref(),
        ]);
    }
    arguments.extend(named.iter().map(OsString::as_os_str));
    call(&python_of(draft), arguments, Some(note), cancel).map_err(|reason| {
        let by_hand = requirements.arguments(Path::new(requirements.file));
        let packages = by_hand.join(OsStr::new(" "));
        Ending::absent(format!(
            "the Python packages cannot be installed: {reason}; without a network fill a folder with `pip download {} \
             -d FOLDER` elsewhere and set {WHEELS}=FOLDER, or name an environment that has them with {ENVIRONMENT}",
            packages.display()
        ))
    })?;
    let marker = draft.join(MARKER);
    fs::write(&marker, requirements.text).map_err(|error| storage(&marker, error))
}

/// Returns the interpreter of an environment.
fn python_of(folder: &Path) -> PathBuf {
    if cfg!(windows) {
        folder.join("Scripts").join("python.exe")
    } else {
        folder.join("bin").join("python")
    }
}
