//! Package of a unit: a zip archive of description, library and scene. Equal scene, library and imprint give equal bytes.

use std::f64::consts::PI;
use std::io::{Cursor, Read as _, Write as _};
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use pinwheel_files::output::escape;
use pinwheel_gearbox::Gearbox;
use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, DateTime, ZipArchive, ZipWriter};

use crate::instance::{Instance, Refusal};
use crate::model::{Model, SCENE_FILE, Variable, What};

/// Channels of every unit besides those of the scene.
const CHANNELS: [&str; 6] = [
    "efficiency",
    "input_power_w",
    "output_power_w",
    "damping_loss_w",
    "friction_loss_w",
    "transmission_error_arcmin",
];

/// Number of bytes that contain the head of a description, including notes of the scene.
const HEAD: u64 = 1 << 16;

/// Reason for a missing unit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub enum PackageError {
    /// Faulty scene or other input.
    Given(String),
    /// Fault of the library, the first step, or the archive.
    Unit(String),
}

/// Origin that a unit states.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Imprint {
    /// Author of the model.
    pub author: String,
    /// Date of the unit.
    pub date: SystemTime,
}

impl Imprint {
    /// Returns the imprint for the present time, or for that of `SOURCE_DATE_EPOCH` [reproducible-builds.org]; the default
    /// author is Pinwheel's authors.
    ///
    /// # Errors
    /// `SOURCE_DATE_EPOCH` is no time.
    #[expect(clippy::disallowed_methods, reason = "a day, no duration")]
    pub fn here(author: Option<&str>) -> Result<Self, PackageError> {
        // End of the year 9999; later dates have another form.
        const LAST_S: u64 = 253_402_300_799;
        let date = match std::env::var("SOURCE_DATE_EPOCH") {
            Err(_) => SystemTime::now(),
            Ok(text) => {
                let seconds = text.parse().ok().filter(|seconds| *seconds <= LAST_S);
                let seconds = seconds.ok_or_else(|| {
                    PackageError::Given(format!(
                        "SOURCE_DATE_EPOCH is `{text}`; it counts whole seconds since 1970, such as 1767225600"
                    ))
                })?;
                SystemTime::UNIX_EPOCH + Duration::from_secs(seconds)
            }
        };
        Ok(Self {
            author: author.unwrap_or(env!("CARGO_PKG_AUTHORS")).to_owned(),
            date,
        })
    }
}

/// Unit of FMI, as in `UnitDefinitions`.
pub struct Unit {
    /// Ending of the names of variables with this unit.
    ending: &'static str,
    /// Name of the unit in descriptions.
    pub name: &'static str,
    /// Exponents of kg, m, s, rad; 0 where they are not integers.
    base: [i32; 4],
    factor: f64,
    /// Display unit, and the number of display units in one of this unit.
    shown: Option<(&'static str, f64)>,
}

const fn unit(ending: &'static str, name: &'static str, base: [i32; 4]) -> Unit {
    Unit {
        ending,
        name,
        base,
        factor: 1.0,
        shown: None,
    }
}

const fn shown(unit: Unit, name: &'static str, factor: f64) -> Unit {
    Unit {
        shown: Some((name, factor)),
        ..unit
    }
}

/// Units by ending, longer endings first.
const UNITS: [Unit; 18] = [
    unit("stiffness_n_m", "N/m", [1, 0, -2, 0]),
    unit("spring_n_m", "N/m", [1, 0, -2, 0]),
    unit("_kg_m3", "kg/m3", [1, -3, 0, 0]),
    unit("_n_m15", "N/m1.5", [0; 4]),
    Unit {
        factor: PI / 10_800.0,
        ..unit("_arcmin", "arcmin", [0, 0, 0, 1])
    },
    unit("_n_s_m", "N.s/m", [1, 0, -1, 0]),
    unit("_kg_m2", "kg.m2", [1, 2, 0, 0]),
    unit("_w_m2", "W/m2", [1, 0, -3, 0]),
    shown(unit("_rad_s", "rad/s", [0, 0, -1, 1]), "rpm", 30.0 / PI),
    unit("_n_m", "N.m", [1, 2, -2, 0]),
    unit("_m_s", "m/s", [0, 1, -1, 0]),
    shown(unit("_rad", "rad", [0, 0, 0, 1]), "deg", 180.0 / PI),
    unit("_kg", "kg", [1, 0, 0, 0]),
    unit("_pa", "Pa", [1, -1, -2, 0]),
    unit("_n", "N", [1, 1, -2, 0]),
    unit("_w", "W", [1, 2, -3, 0]),
    shown(unit("_m", "m", [0, 1, 0, 0]), "mm", 1e3),
    unit("_s", "s", [0, 0, 1, 0]),
];

impl Unit {
    /// Returns the unit of a variable, by its name; `None` for a number without unit.
    pub fn of(name: &str) -> Option<&'static Self> {
        let name = name.split_once('[').map_or(name, |(array, _)| array);
        let numbered = name.trim_end_matches(|c: char| c.is_ascii_digit());
        // Strips the number of a pin or disc, but not the 2 of m2.
        let bare = numbered.strip_suffix('_').unwrap_or(name);
        UNITS.iter().find(|unit| bare.ends_with(unit.ending))
    }

    /// Returns the unit's definition in the model description.
    pub fn definition(&self) -> String {
        if self.base == [0; 4] {
            return format!("    <Unit name=\"{}\"/>\n", self.name);
        }
        let powers = ["kg", "m", "s", "rad"].into_iter().zip(self.base);
        let powers = powers.filter(|(_, power)| *power != 0);
        let attribute = |(name, power): (&str, i32)| format!(" {name}=\"{power}\"");
        let mut attributes: String = powers.map(attribute).collect();
        if self.factor != 1.0 {
            attributes += &format!(" factor=\"{:e}\"", self.factor);
        }
        let shown = self.shown.map_or_else(String::new, |(name, factor)| {
            format!("<DisplayUnit name=\"{name}\" factor=\"{factor:e}\"/>")
        });
        format!(
            "    <Unit name=\"{}\"><BaseUnit{attributes}/>{shown}</Unit>\n",
            self.name
        )
    }
}

/// Variable with its entry in the description.
struct Row<'a> {
    reference: usize,
    of: &'a Variable,
    causality: &'static str,
    variability: &'static str,
    unit: Option<&'static Unit>,
    nominal: Option<String>,
    start: Option<String>,
}

impl<'a> Row<'a> {
    fn new(reference: usize, of: &'a Variable, gearbox: &Gearbox) -> Self {
        let (causality, variability) = match of.what {
            What::Input(_) => ("input", "continuous"),
            What::Shaft(_) | What::Column(_) => ("output", "continuous"),
            What::Key | What::Tolerance | What::Flag(_) => ("parameter", "fixed"),
        };
        let start = match of.what {
            What::Shaft(_) | What::Column(_) => None,
            What::Flag(_) => Some((of.start != 0.0).to_string()),
            _ => Some(format!("{:e}", of.start)),
        };
        Self {
            reference,
            of,
            causality,
            variability,
            unit: Unit::of(&of.name),
            nominal: of.nominal(gearbox).map(|size| format!("{size:e}")),
            start,
        }
    }

    /// Returns the variable's element in the model description.
    fn variable(&self) -> String {
        let kind = match self.of.is_boolean() {
            true => "Boolean",
            false => "Real",
        };
        let number = |value: f64| value.is_finite().then(|| format!("{value:e}"));
        let [low, high] = self.of.limits().map(number);
        let shown = self.unit.and_then(|unit| unit.shown);
        let attributes = [
            ("unit", self.unit.map(|unit| unit.name)),
            ("displayUnit", shown.map(|(name, _)| name)),
            ("min", low.as_deref()),
            ("max", high.as_deref()),
            ("nominal", self.nominal.as_deref()),
            ("start", self.start.as_deref()),
        ];
        let attributes = attributes.map(|(name, value)| match value {
            Some(value) => format!(" {name}=\"{value}\""),
            None => String::new(),
        });
        format!(
            "    <ScalarVariable name=\"{}\" valueReference=\"{}\" causality=\"{}\" variability=\"{}\" \
             description=\"{}\"><{kind}{}/></ScalarVariable>\n",
            escape(&self.of.name),
            self.reference,
            self.causality,
            self.variability,
            escape(&self.of.about),
            attributes.concat()
        )
    }

    /// Returns the variable's entry in the documentation.
    fn documentation(&self) -> String {
        let [name, about] = [&*self.of.name, &*self.of.about].map(escape);
        format!(
            "<tr><td>{name}</td><td>{}</td><td>{}</td><td>{}</td><td>{about}</td></tr>\n",
            self.causality,
            self.unit.map_or("", |unit| unit.name),
            self.start.as_deref().unwrap_or_default()
        )
    }
}

/// Unit, ready to be written.
#[derive(Debug, Clone)]
pub struct Package {
    model: Arc<Model>,
    identifier: String,
    method: String,
    library: Vec<u8>,
    imprint: Imprint,
}

impl Package {
    /// True for the bytes of a unit of any version of this program.
    pub fn is_ours(bytes: &[u8]) -> bool {
        let head = || -> ZipResult<String> {
            let mut archive = ZipArchive::new(Cursor::new(bytes))?;
            let mut head = String::new();
            let description = archive.by_name("modelDescription.xml")?;
            description.take(HEAD).read_to_string(&mut head)?;
            Ok(head)
        };
        head().is_ok_and(|head| head.contains("generationTool=\"Pinwheel "))
    }

    /// Builds the unit and tries its first step.
    ///
    /// # Errors
    /// The scene cannot become a unit, or the library cannot be read.
    pub fn new(gearbox: &Gearbox, library: &Path, imprint: Imprint) -> Result<Self, PackageError> {
        let mut channels = gearbox.scene.output.channels.clone();
        for channel in CHANNELS {
            if !gearbox.channels.names().any(|name| name == channel) {
                channels.push(channel.to_owned());
            }
        }
        let gearbox = gearbox.with_channels(channels);
        let gearbox = gearbox.map_err(|error| PackageError::Given(error.to_string()))?;
        let model = Arc::new(Model::of(&gearbox).map_err(PackageError::Given)?);
        let mut trial = Instance::new(Arc::clone(&model));
        let mut first = || -> Result<String, Refusal> {
            trial.enter_initialization()?;
            trial.exit_initialization()?;
            trial.step(0.0, model.scene().solver.sample_s)?;
            Ok(trial.method())
        };
        let method = first().map_err(|Refusal(what)| PackageError::Unit(what))?;
        if platform().is_none() {
            let (system, processor) = (std::env::consts::OS, std::env::consts::ARCH);
            return Err(PackageError::Unit(format!(
                "FMI 2.0 has no place for libraries of {system} on {processor}; build the unit on another machine"
            )));
        }
        let unread =
            |error: std::io::Error| format!("{} cannot be read: {error}", library.display());
        let bytes = std::fs::read(library).map_err(|error| PackageError::Unit(unread(error)))?;
        Ok(Self {
            identifier: identifier(&model.scene().name),
            model,
            method,
            library: bytes,
            imprint,
        })
    }

    /// Returns the identifier of the unit.
    pub fn guid(&self) -> &str {
        self.model.guid()
    }

    /// Returns the initial method and tolerance in words.
    pub fn method(&self) -> &str {
        &self.method
    }

    /// Returns the number of variables.
    pub fn variables(&self) -> usize {
        self.model.variables().len()
    }

    /// Returns FMI's name of the library's platform.
    pub fn platform(&self) -> &'static str {
        platform().unwrap_or_default()
    }

    /// Returns the archive.
    ///
    /// # Errors
    /// Internal fault: an archive that cannot be written to memory.
    pub fn bytes(&self) -> Result<Vec<u8>, PackageError> {
        self.archive()
            .map_err(|what| PackageError::Unit(format!("the unit cannot be written: {what}")))
    }

    fn archive(&self) -> ZipResult<Vec<u8>> {
        let scene = self.model.scene();
        let all = self.model.variables().iter().enumerate();
        let rows = all.map(|(k, variable)| Row::new(k, variable, self.model.gearbox()));
        let rows: Vec<Row<'_>> = rows.collect();
        let used = |unit: &&Unit| {
            let names = rows.iter().filter_map(|row| row.unit);
            names.into_iter().any(|other| other.name == unit.name)
        };
        let units = UNITS.iter().filter(used);
        let tolerances = self.model.variables().iter();
        let tolerance = tolerances.filter(|variable| variable.what == What::Tolerance);
        let tolerance = tolerance.map(|variable| format!(" tolerance=\"{:e}\"", variable.start));
        let version = env!("CARGO_PKG_VERSION");
        let (name, about) = (escape(&scene.name), escape(&scene.description));
        let author = escape(&self.imprint.author);
        let date = humantime::format_rfc3339_seconds(self.imprint.date);
        let outputs = rows.iter().filter(|row| row.of.is_output());
        let outputs =
            outputs.map(|row| format!("      <Unknown index=\"{}\"/>\n", row.reference + 1));
        let description = format!(
            include_str!("../templates/modelDescription.xml"),
            name = name,
            identifier = self.identifier,
            about = about,
            guid = self.model.guid(),
            author = author,
            license = env!("CARGO_PKG_LICENSE"),
            version = version,
            date = date,
            stop_s = format_args!("{:e}", scene.solver.duration_s),
            tolerance = tolerance.collect::<String>(),
            step_s = format_args!("{:e}", scene.solver.sample_s),
            units = units.map(Unit::definition).collect::<String>(),
            variables = rows.iter().map(Row::variable).collect::<String>(),
            outputs = outputs.collect::<String>(),
        );
        let documentation = format!(
            include_str!("../templates/documentation.html"),
            name = name,
            about = about,
            version = version,
            date = date,
            author = author,
            method = escape(&self.method),
            rows = rows.iter().map(Row::documentation).collect::<String>(),
        );
        let name = format!("{}{}", self.identifier, std::env::consts::DLL_SUFFIX);
        let library = format!("binaries/{}/{name}", self.platform());
        let scene = format!("resources/{SCENE_FILE}");
        let files: [(&str, u32, &[u8]); 4] = [
            ("modelDescription.xml", 0o644, description.as_bytes()),
            (&library, 0o755, &self.library),
            (&scene, 0o644, self.model.text().as_bytes()),
            ("documentation/index.html", 0o644, documentation.as_bytes()),
        ];
        let mut archive = ZipWriter::new(Cursor::new(Vec::new()));
        for (name, mode, bytes) in files {
            let options = SimpleFileOptions::default()
                .compression_method(CompressionMethod::Deflated)
                .last_modified_time(DateTime::default())
                .unix_permissions(mode);
            archive.start_file(name, options)?;
            archive.write_all(bytes)?;
        }
        Ok(archive.finish()?.into_inner())
    }
}

/// Returns FMI's name of the platform of this build.
fn platform() -> Option<&'static str> {
    match (std::env::consts::OS, std::env::consts::ARCH) {
        ("linux", "x86_64") => Some("linux64"),
        ("windows", "x86_64") => Some("win64"),
        ("macos", _) => Some("darwin64"),
        _ => None,
    }
}

/// Converts a name to an identifier of C.
pub fn identifier(name: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
    let text: String = name.chars().map(plain).take(64).collect();
    if text.starts_with(|c: char| c.is_ascii_alphabetic()) {
        text
    } else {
        format!("gear_{text}")
    }
}
