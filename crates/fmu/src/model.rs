//! Content of a unit: a scene, and the variables that follow from it.

use std::path::Path;

use pinwheel_files::fits;
use pinwheel_gearbox::cosimulation::{CoSimulation, Prescribed, Setup};
use pinwheel_gearbox::{Gearbox, Recorder};
use pinwheel_scene::channels::FAMILIES;
use pinwheel_scene::keys::{Key, Kind, Range, key};
use pinwheel_scene::scales::{Scales, internal_force};
use pinwheel_scene::{CheckedScene, KEYS, Override, Scene};

/// Name of the scene's file among the resources.
pub(crate) const SCENE_FILE: &str = "scene.toml";
/// Tables of a scene whose numbers are parameters.
const TUNED: [&str; 3] = ["gear.", "contact.", "mass."];

/// Quantity of a variable.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum What {
    /// Number of the scene, by its key: a fixed parameter.
    Key,
    /// Tolerance, the relative error per step: a fixed parameter.
    Tolerance,
    /// Drive and load of the gear: a fixed Boolean parameter.
    Flag(Flag),
    /// Input variable.
    Input(Input),
    /// Output variable of the shafts.
    Shaft(Shaft),
    /// Column of a run, by its number: an output.
    Column(usize),
}

/// Boolean parameters, see [`FLAGS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Flag {
    /// Free input shaft, driven by a torque.
    DriveByTorque,
    /// Prescribed speed of the output shaft.
    LoadBySpeed,
    /// Scene's load in addition.
    SceneLoad,
}

/// Inputs, see [`SHAFTS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Input {
    /// Speed of the input shaft, rad/s.
    DriveSpeed,
    /// Torque on the input shaft, N m.
    DriveTorque,
    /// Torque on the output shaft, N m.
    LoadTorque,
    /// Speed of the output shaft, rad/s.
    LoadSpeed,
}

impl Input {
    /// Returns the key of a scene for the same quantity, with its range.
    pub(crate) fn key(self) -> Option<&'static Key> {
        key(match self {
            Self::DriveSpeed | Self::LoadSpeed => "drive.input_speed_rad_s",
            Self::DriveTorque | Self::LoadTorque => "drive.output_torque_n_m",
        })
    }
}

/// Outputs of the shafts, see [`SHAFTS`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shaft {
    /// Angle of the input, rad.
    InputAngle,
    /// Speed of the input, rad/s.
    InputSpeed,
    /// Speed of the output, rad/s.
    OutputSpeed,
    /// External torque on the output, N m.
    Load,
    /// Largest force on a pin, N.
    LargestForce,
}

/// Tables of variables: name, quantity, description with sign.
macro_rules! rows {
    ($($name:literal $what:expr, $about:literal;)*) => {
        &[$(($name, $what, $about)),*]
    };
}

/// Inputs, then outputs of the shafts.
const SHAFTS: &[(&str, What, &str)] = rows! {
    "drive_speed_rad_s" What::Input(Input::DriveSpeed), "speed of the input shaft, counter-clockwise";
    "drive_torque_n_m" What::Input(Input::DriveTorque), "torque on the input shaft, counter-clockwise; counts with drive_by_torque";
    "load_torque_n_m" What::Input(Input::LoadTorque), "torque on the output shaft, counter-clockwise: above 0 it opposes the motion of a positive input speed";
    "load_speed_rad_s" What::Input(Input::LoadSpeed), "speed of the output shaft, counter-clockwise; counts with load_by_speed";
    "input_angle_rad" What::Shaft(Shaft::InputAngle), "angle of the input shaft, counter-clockwise";
    "input_speed_rad_s" What::Shaft(Shaft::InputSpeed), "speed of the input shaft, counter-clockwise";
    "output_speed_rad_s" What::Shaft(Shaft::OutputSpeed), "speed of the output shaft, counter-clockwise";
    "total_load_n_m" What::Shaft(Shaft::Load), "torque from outside on the output shaft, the scene's load included, counter-clockwise";
    "largest_sleeve_force_n" What::Shaft(Shaft::LargestForce), "largest of all pin forces";
};

const FLAGS: &[(&str, What, &str)] = rows! {
    "drive_by_torque" What::Flag(Flag::DriveByTorque), "true: the input shaft turns under drive_torque_n_m with its own inertia, from drive_speed_rad_s on; false: its speed is drive_speed_rad_s";
    "load_by_speed" What::Flag(Flag::LoadBySpeed), "true: the output shaft's speed is load_speed_rad_s; false: load_torque_n_m acts on it";
    "scene_load" What::Flag(Flag::SceneLoad), "true: the scene's load, with its ramp and changes, acts on the output shaft beside load_torque_n_m; false: that alone";
};

/// Columns of every run; as variables they are numbered by position.
const COLUMNS: &[(&str, (), &str)] = rows! {
    "input_torque_n_m" (), "torque of the drive on the input shaft, counter-clockwise";
    "output_torque_n_m" (), "all torques on the output shaft except its load, counter-clockwise";
    "output_angle_rad" (), "angle of the output shaft, counter-clockwise";
    "external_sleeve_force_n_*" (), "force of all discs on the ring pin";
    "internal_sleeve_force_n_*" (), "force of all discs on the output pin";
};

/// Variable; its value reference is its index in the list.
#[derive(Debug, Clone, PartialEq)]
pub struct Variable {
    /// Name with its unit at the end; keys of the scene are unchanged.
    pub name: String,
    /// Meaning of the variable, with sign.
    pub about: String,
    /// Quantity of the variable.
    pub what: What,
    /// Initial value; 0 or 1 of Booleans, unused for outputs.
    pub start: f64,
}

impl Variable {
    /// True if the variable is a Boolean.
    pub fn is_boolean(&self) -> bool {
        matches!(self.what, What::Flag(_))
    }

    /// Returns least and largest value; infinite without a bound.
    pub fn limits(&self) -> [f64; 2] {
        let key = match self.what {
            What::Key => key(&self.name),
            What::Input(input) => input.key(),
            _ => None,
        };
        match key.map(|key| key.kind) {
            Some(Kind::Number(Range::From(low, high) | Range::Between(low, high))) => [low, high],
            _ if self.name.contains("sleeve_force_n") => [0.0, f64::INFINITY],
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }

    /// Returns the typical size in the scene: the value itself for parameters and speeds, else a size by the load; `None` if
    /// unknown.
    pub fn nominal(&self, gearbox: &Gearbox) -> Option<f64> {
        let (scene, scales) = (&*gearbox.scene, Scales::of(&gearbox.scene));
        let torque = scales.wheel_torque_n_m * scene.gear.wheels as f64;
        let speed = scene.drive.input_speed_rad_s;
        let slower = gearbox.geometry.ideal_output_angle(1.0).abs();
        let outward = ["output_", "load_", "total_load_"];
        let outward = outward.iter().any(|part| self.name.starts_with(part));
        let name = self.name.split('[').next().unwrap_or_default();
        let size = match self.what {
            What::Flag(_) | What::Tolerance => return None,
            What::Key => self.start,
            _ if name.ends_with("_rad_s") => speed * if outward { slower } else { 1.0 },
            _ if name.ends_with("_n_m") => torque * if outward { 1.0 } else { slower },
            _ if name.ends_with("internal_sleeve_force_n") => {
                internal_force(&scene.gear, scales.wheel_torque_n_m)
            }
            _ if name.ends_with("_force_n") => scales.external_force_n,
            _ if name.ends_with("_w") => torque * slower * speed,
            _ => return None,
        };
        Some(size.abs()).filter(|size| *size > 0.0)
    }

    /// True for an output.
    pub fn is_output(&self) -> bool {
        matches!(self.what, What::Shaft(_) | What::Column(_))
    }
}

/// Scene with its variables.
#[derive(Debug, Clone)]
pub struct Model {
    text: String,
    gearbox: Gearbox,
    variables: Vec<Variable>,
    guid: String,
}

impl Model {
    /// Reads the model from a unit's resources.
    ///
    /// # Errors
    /// Missing or wrong part.
    pub fn read(resources: &Path) -> Result<Self, String> {
        let path = resources.join(SCENE_FILE);
        let text = std::fs::read_to_string(&path)
            .map_err(|error| format!("{} cannot be read: {error}", path.display()))?;
        let gearbox = compiled(&text, &[])?;
        Self::new(text, gearbox)
    }

    /// Makes the model of a compiled scene.
    ///
    /// # Errors
    /// Reason why the native solver cannot run the scene.
    pub fn of(gearbox: &Gearbox) -> Result<Self, String> {
        Self::new(gearbox.scene.to_toml(), gearbox.clone())
    }

    fn new(text: String, gearbox: Gearbox) -> Result<Self, String> {
        let variables = variables(&gearbox)?;
        let guid = guid(&text, &variables);
        Ok(Self {
            text,
            gearbox,
            variables,
            guid,
        })
    }

    /// Returns the compiled scene.
    pub fn gearbox(&self) -> &Gearbox {
        &self.gearbox
    }

    /// Returns the scene.
    pub fn scene(&self) -> &CheckedScene {
        &self.gearbox.scene
    }

    /// Returns the scene as text, as among the resources.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns every variable, by value reference.
    pub fn variables(&self) -> &[Variable] {
        &self.variables
    }

    /// Returns the identifier of the unit: a hash of the scene, its variables and the version.
    pub fn guid(&self) -> &str {
        &self.guid
    }

    /// Starts the gear under these values of all variables.
    pub(crate) fn begin(
        &self,
        values: &[f64],
        tolerance: Option<f64>,
    ) -> Result<CoSimulation, String> {
        let changed = |what: What| {
            let all = self.variables.iter().zip(values);
            all.filter(move |(v, value)| v.what == what && v.start != **value)
        };
        let set = |(v, value): (&Variable, &f64)| Override::new(&v.name, format!("{value:e}"));
        let sets: Vec<Override> = changed(What::Key).map(set).collect();
        let gearbox = match sets.is_empty() {
            true => self.gearbox.clone(),
            false => compiled(&self.text, &sets)?,
        };
        let own = changed(What::Tolerance).map(|(_, value)| *value).next();
        let input = |input| values[self.place(What::Input(input))];
        let by_torque = |torque| match torque {
            true => Prescribed::ByTorque,
            false => Prescribed::BySpeed,
        };
        let setup = Setup {
            input: by_torque(self.flag(values, Flag::DriveByTorque)),
            output: by_torque(!self.flag(values, Flag::LoadBySpeed)),
            speeds_rad_s: [Input::DriveSpeed, Input::LoadSpeed].map(input),
            torque_n_m: input(Input::LoadTorque),
            scene_load: self.flag(values, Flag::SceneLoad),
            tolerance: tolerance.or(own),
        };
        CoSimulation::new(&gearbox, setup).map_err(|error| error.to_string())
    }

    /// Returns the indices of the variables that prescribe input and output.
    pub(crate) fn holders(&self, values: &[f64]) -> [usize; 2] {
        let drive = match self.flag(values, Flag::DriveByTorque) {
            true => Input::DriveTorque,
            false => Input::DriveSpeed,
        };
        let load = match self.flag(values, Flag::LoadBySpeed) {
            true => Input::LoadSpeed,
            false => Input::LoadTorque,
        };
        [drive, load].map(|input| self.place(What::Input(input)))
    }

    /// Returns the index of the variable `what`; all flags and inputs have one.
    fn place(&self, what: What) -> usize {
        let place = self.variables.iter().position(|v| v.what == what);
        place.unwrap_or(0)
    }

    fn flag(&self, values: &[f64], flag: Flag) -> bool {
        values[self.place(What::Flag(flag))] != 0.0
    }
}

/// Compiles the scene of a unit with other values of keys.
fn compiled(text: &str, sets: &[Override]) -> Result<Gearbox, String> {
    let scene = Scene::from_toml(text, SCENE_FILE, sets).map_err(|error| error.to_string())?;
    Gearbox::new(&scene).map_err(|error| error.to_string())
}

fn variables(gearbox: &Gearbox) -> Result<Vec<Variable>, String> {
    let mut all = Vec::new();
    let mut add = |name: &str, about: &str, what: What, start: f64| {
        all.push(Variable {
            name: name.to_owned(),
            about: about.to_owned(),
            what,
            start,
        });
    };
    let speed = gearbox.scene.drive.input_speed_rad_s;
    for &(name, what, about) in SHAFTS {
        let start = match what {
            What::Input(Input::DriveSpeed) => speed,
            What::Input(Input::LoadSpeed) => gearbox.geometry.ideal_turn_of_output(speed),
            What::Input(_) => 0.0,
            _ => f64::NAN,
        };
        add(name, about, what, start);
    }
    let columns = Recorder::contract(gearbox);
    let channels = gearbox.channels.names().map(str::to_owned);
    for (place, name) in columns.into_iter().chain(channels).enumerate() {
        let families = FAMILIES.iter().map(|family| (family.pattern, family.about));
        let own = COLUMNS.iter().map(|&(pattern, (), about)| (pattern, about));
        let mut known = own.chain(families);
        let about = known.find(|(pattern, _)| fits(pattern, &name));
        let about = about.map_or("", |(_, about)| about);
        let (name, about) = element(&name, about, &gearbox.scene);
        add(&name, &about, What::Column(place), f64::NAN);
    }
    for &(name, what, about) in FLAGS {
        let start = f64::from(u8::from(what == What::Flag(Flag::SceneLoad)));
        add(name, about, what, start);
    }
    let begun = CoSimulation::new(gearbox, Setup::of(&gearbox.scene.drive))
        .map_err(|error| error.to_string())?;
    let about =
        "relative error a step of adaptive methods; a tolerance of the importer takes precedence";
    // A fixed step uses no tolerance.
    if begun.adaptive() {
        add("solver.tolerance", about, What::Tolerance, begun.method().1);
    }
    for key in KEYS {
        let tuned = TUNED.iter().any(|part| key.name.starts_with(part));
        let value = gearbox.scene.number(key.name);
        if let (Kind::Number(_), true, Some(value)) = (key.kind, tuned, value) {
            add(key.name, key.about, What::Key, value);
        }
    }
    Ok(all)
}

/// Returns name and description of a numbered column as an array element, whose indices begin with 1, with its number and the
/// initial position of its pin.
fn element(name: &str, about: &str, scene: &Scene) -> (String, String) {
    let numbered = name.rsplit_once('_');
    let numbered = numbered.and_then(|(array, k)| Some((array, k.parse::<u32>().ok()?)));
    let Some((array, k)) = numbered else {
        return (name.to_owned(), about.to_owned());
    };
    let sleeves = match array {
        _ if array.starts_with("external_sleeve") => Some(scene.gear.external_sleeves),
        _ if array.starts_with("internal_sleeve") => Some(scene.gear.internal_sleeves),
        _ => None,
    };
    let angle_deg = sleeves.map(|count| f64::from(k) * 360.0 / count as f64);
    let place = angle_deg.map(|angle| format!(", at {angle:.4} deg at the start"));
    let about = format!("{about}: number {k}{}", place.unwrap_or_default());
    (format!("{array}[{}]", k + 1), about)
}

/// Returns the FNV-1a hash, 128 bits [Fowler, Noll, Vo 1991], in the form of a GUID.
fn guid(text: &str, variables: &[Variable]) -> String {
    const BASIS: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let names = variables.iter().flat_map(|v| v.name.bytes().chain([0]));
    let version = env!("CARGO_PKG_VERSION").bytes();
    let bytes = version.chain(text.bytes()).chain(names);
    let hash = bytes.fold(BASIS, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(PRIME)
    });
    let digits = format!("{hash:032x}");
    let parts = [0..8, 8..12, 12..16, 16..20, 20..32].map(|part| &digits[part]);
    format!("{{{}}}", parts.join("-"))
}
