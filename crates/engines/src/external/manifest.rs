//! Manifest of a solver (`solver.toml`): identity, start command and capabilities.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use pinwheel_files::{Broken, FileError, fits, read_text, require};
use pinwheel_scene::{JOB_PROTOCOL, Scene, names};
use pinwheel_timeseries::SharedModel;
use serde::Deserialize;

use crate::env::variable;
use crate::info::{EngineInfo, Refinement, family};
use crate::known::{info, known};

/// Longest time limit in a manifest, s.
const LONGEST_S: f64 = 86_400.0;
/// Placeholders in a command for values that are known only when the command runs.
pub(super) const PLACES: [&str; 4] = ["here", "job", "law", "python"];

/// Content of a manifest.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Manifest {
    /// Version of the protocol (job files and exit statuses) of the solver.
    pub protocol: u64,
    /// Name as users type it: small letters, digits and `-`.
    pub name: String,
    /// Version of the solver.
    pub version: String,
    /// `shared-law`: contact forces from Pinwheel's library; `own-contact`: its own.
    pub track: SharedModel,
    /// Description in one line.
    pub summary: String,
    /// Differences from the native solver, in plain words, for the report.
    #[serde(default)]
    pub differences: String,
    /// Program and arguments, without a shell. `{here}`, `{job}`, `{law}` and `{python}` are replaced.
    pub command: Vec<String>,
    /// Command that builds the program, for the message if it is missing.
    #[serde(default)]
    pub build: Option<String>,
    /// Wall time limit of a run, s.
    #[serde(default = "five_minutes")]
    pub timeout_s: f64,
    /// Capabilities of the solver.
    #[serde(default)]
    pub honours: Honours,
    /// Setting that controls the solver's accuracy.
    #[serde(default)]
    pub refine: Option<Refinement>,
    /// Known difference between the solver's model and the native one, per quantity.
    #[serde(default)]
    pub model: BTreeMap<String, Stated>,
}

/// Capabilities of a solver; a scene that needs more is refused before the start.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Honours {
    /// Names of contact laws, in which `*` stands for any characters.
    pub laws: Vec<String>,
    /// Support of friction coefficients above 0.
    pub friction: bool,
    /// Support of load changes during the run.
    pub load_changes: bool,
    /// Support of input speed changes during the run.
    pub speed_changes: bool,
    /// Support of discs on elastic bearings: bodies whose carrier is -2.
    pub free_wheels: bool,
    /// Support of `[structure]` in series with the contacts and of `[temperature]`, which forces of the law's library contain.
    pub structure: bool,
    /// Support of a ring that is the output: ring pins whose carrier is 1, output pins whose carrier is -1.
    pub ring: bool,
}

impl Default for Honours {
    fn default() -> Self {
        Self {
            laws: vec!["*".to_owned()],
            friction: false,
            load_changes: false,
            speed_changes: false,
            free_wheels: false,
            structure: false,
            ring: false,
        }
    }
}

/// Known difference of the model, stated by its author.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stated {
    /// Relative tolerance.
    pub tolerance: f64,
    /// Reason of the difference.
    pub reason: String,
}

fn five_minutes() -> f64 {
    300.0
}

/// Place of a working example.
const FORM: &str = "`pinwheel solver new --language c NAME` writes one that works";

impl Manifest {
    /// Reads and checks a manifest.
    ///
    /// # Errors
    /// A file that cannot be read, is not TOML, or has invalid values.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        let text = read_text(path, "give the path of a solver's manifest (solver.toml)")?;
        Self::from_toml(&text, &path.display().to_string())
    }

    /// Reads and checks a manifest's text; `path` is its name in messages.
    ///
    /// # Errors
    /// Not TOML, or invalid values.
    pub fn from_toml(text: &str, path: &str) -> Result<Self, FileError> {
        let manifest: Self = pinwheel_files::read(text, path, FORM)?;
        let checked = manifest.check();
        checked.map_err(|(what, remedy)| FileError::new(path, what, remedy))?;
        Ok(manifest)
    }

    /// Checks the name of a solver.
    ///
    /// # Errors
    /// Reason of a refusal, with the remedy.
    pub fn is_name(name: &str) -> Result<(), String> {
        let letters = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-';
        let plain = name.len() <= 60
            && name.starts_with(|c: char| c.is_ascii_lowercase())
            && name.chars().all(letters);
        if !plain {
            return Err(format!(
                "name = {name:?} is no name of an engine; use small letters, digits and `-`, a letter first"
            ));
        }
        let families = || known().map(EngineInfo::family);
        if info(name).is_some() || families().any(|own| own == family(name)) {
            return Err(format!(
                "name = {name:?} is one of Pinwheel's own engines; choose another name"
            ));
        }
        Ok(())
    }

    /// Checks the manifest; an error states fault and remedy.
    fn check(&self) -> Result<(), Broken> {
        require(
            self.protocol == JOB_PROTOCOL,
            format!("protocol = {} is not known here", self.protocol),
            "write protocol = 1",
        )?;
        if let Err(fault) = Self::is_name(&self.name) {
            let (what, remedy) = fault.split_once("; ").unwrap_or((&fault, ""));
            return Err((what.to_owned(), remedy.to_owned()));
        }
        for (key, text, may_be_empty) in [
            ("version", &self.version, false),
            ("summary", &self.summary, false),
            ("differences", &self.differences, true),
        ] {
            let control = |c: char| c.is_control() && c != '\n';
            require(
                text.len() <= 4000 && !text.chars().any(control),
                format!("{key} is too long, or holds control characters"),
                "write plain text",
            )?;
            let empty = text.trim().is_empty() && !may_be_empty;
            require(!empty, format!("{key} is empty"), "reports show it")?;
        }
        require(
            matches!(self.track, SharedModel::SharedLaw | SharedModel::OwnContact),
            format!("track = {:?} is not one of a solver", self.track.as_str()),
            "write \"shared-law\" or \"own-contact\"",
        )?;
        require(
            !self.command.first().is_none_or(String::is_empty),
            "command is empty",
            "write the program and its arguments, [\"{here}/solver\", \"{job}\", \"{law}\"]",
        )?;
        for word in &self.command {
            let plain = !word.contains('\0');
            require(plain, "command holds a zero byte", "write plain text")?;
            let is_place = |after: &str| {
                let closed = |place: &&str| {
                    let after = after.strip_prefix(*place);
                    after.is_some_and(|after| after.starts_with('}'))
                };
                PLACES.iter().any(closed)
            };
            require(
                word.split('{').skip(1).all(is_place),
                format!("{word:?} in command has a `{{` that begins no placeholder"),
                "known are {here}, {job}, {law} and {python}",
            )?;
        }
        require(
            self.timeout_s > 0.0 && self.timeout_s <= LONGEST_S,
            format!("timeout_s = {} is no valid time limit", self.timeout_s),
            "write seconds, at most a day (86400)",
        )?;
        for law in &self.honours.laws {
            require(
                names::laws().iter().any(|known| fits(law, known)),
                format!("honours.laws names {law:?}, which is no contact law"),
                "`pinwheel laws` lists them; `*` stands for any characters",
            )?;
        }
        if let Some(refine) = &self.refine {
            require(
                refine.order > 0.0 && refine.order <= 20.0,
                format!("refine.order = {} is no order", refine.order),
                "write the order of the method, e.g. 4 (of solver.tolerance: 1)",
            )?;
        }
        require(
            self.model.is_empty() || self.track == SharedModel::OwnContact,
            "[model] states differences of an own contact model, but the track is \"shared-law\"",
            "leave [model] out",
        )?;
        for (quantity, stated) in &self.model {
            let sound = stated.tolerance >= 0.0 && stated.tolerance.is_finite();
            require(
                sound && !stated.reason.trim().is_empty(),
                format!("model.{quantity} needs a tolerance, 0 or more, and a reason"),
                "write { tolerance = 0.01, reason = \"...\" }",
            )?;
        }
        Ok(())
    }

    /// True if the solver supports a contact law.
    pub fn honours_law(&self, law: &str) -> bool {
        self.honours.laws.iter().any(|known| fits(known, law))
    }

    /// Returns the reason why the solver does not support a scene.
    pub fn refuses(&self, scene: &Scene) -> Option<String> {
        let law = &scene.contact.law;
        if !self.honours_law(law) {
            return Some(format!(
                "its manifest honours the contact laws {}, not `{law}`",
                self.honours.laws.join(", ")
            ));
        }
        if scene.contact.friction_coefficient > 0.0 && !self.honours.friction {
            return Some("its manifest does not honour friction (honours.friction)".to_owned());
        }
        if !scene.drive.load_changes.is_empty() && !self.honours.load_changes {
            return Some(
                "its manifest does not honour changes of the load (honours.load_changes)"
                    .to_owned(),
            );
        }
        if scene.ring_turns() && !self.honours.ring {
            return Some(
                "its manifest does not honour a ring that is the output (honours.ring)".to_owned(),
            );
        }
        if !scene.drive.speed_changes.is_empty() && !self.honours.speed_changes {
            return Some(
                "its manifest does not honour changes of the speed (honours.speed_changes)"
                    .to_owned(),
            );
        }
        if scene.bearings.eccentric.is_some() && !self.honours.free_wheels {
            return Some(
                "its manifest does not honour discs on elastic bearings (honours.free_wheels)"
                    .to_owned(),
            );
        }
        let behind = structure_at_contacts(scene).filter(|_| !self.honours.structure)?;
        Some(format!(
            "its manifest does not honour what only the law's library knows (honours.structure), as {behind}"
        ))
    }

    /// Returns the command with its placeholders replaced.
    pub fn argv(&self, known: &[(&str, &Path); 4]) -> Vec<std::ffi::OsString> {
        let fill = |word: &String| {
            let mut filled = std::ffi::OsString::new();
            let mut rest = word.as_str();
            // Validated on reading: every brace opens a placeholder.
            while let Some((before, after)) = rest.split_once('{') {
                let (place, after) = after.split_once('}').unwrap_or((after, ""));
                filled.push(before);
                if let Some((_, path)) = known.iter().find(|(name, _)| *name == place) {
                    filled.push(path);
                }
                rest = after;
            }
            filled.push(rest);
            filled
        };
        self.command.iter().map(fill).collect()
    }

    /// True if the command contains a placeholder.
    pub fn wants(&self, place: &str) -> bool {
        let place = format!("{{{place}}}");
        self.command.iter().any(|word| word.contains(&place))
    }
}

/// Returns the interpreter for `{python}`: `PINWHEEL_PYTHON`, else that of the active environment, else `python3`.
pub(super) fn python() -> PathBuf {
    let inside = if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    };
    variable("PINWHEEL_PYTHON")
        .map(PathBuf::from)
        .or_else(|| Some(PathBuf::from(variable("VIRTUAL_ENV")?).join(inside)))
        .unwrap_or_else(|| PathBuf::from(if cfg!(windows) { "python" } else { "python3" }))
}

/// Returns a key of the structure in series with the contacts, or of temperatures, which only the scene's law contains.
pub(crate) fn structure_at_contacts(scene: &Scene) -> Option<&'static str> {
    let structure = &scene.structure;
    let sizes = [
        (
            structure.output_pin_diameter_m,
            "structure.output_pin_diameter_m",
        ),
        (structure.ring_seat_length_m, "structure.ring_seat_length_m"),
        (
            structure.ring_slot_clearance_m,
            "structure.ring_slot_clearance_m",
        ),
        (scene.temperature.map(|warm| warm.disc_k), "[temperature]"),
    ];
    let (_, key) = sizes.into_iter().find(|(size, _)| size.is_some())?;
    Some(key)
}
