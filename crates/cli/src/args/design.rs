//! Arguments of `pinwheel init` and `pinwheel design`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use pinwheel::scene::as_built::{PROCESSES, process};
use pinwheel::scene::catalogue::{self, Catalogue, MATERIALS, Material, pin_circle_of_m};
use pinwheel::scene::quantity;

use super::{OutArgs, SceneArgs};
use crate::failure::Failure;

/// `pinwheel init`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/init.txt").trim_ascii_end())]
// clap does not wrap its own usage line.
#[command(override_usage = "pinwheel init <FILE> --ratio <RATIO>\n       \
    <--pin-circle-diameter-mm <MM>|--outer-diameter-mm <MM>>\n       --torque-n-m <NM> --speed-rpm <RPM> [OPTIONS]")]
pub(crate) struct InitArgs {
    /// Scene file to write; `-` for standard output.
    pub(crate) file: PathBuf,
    /// Input turns per output turn, the housing fixed: the number of lobes, and of an RV gear such as 118.5.
    #[arg(long, value_parser = ratio)]
    ratio: f64,
    /// `cycloidal`: one eccentric and output pins; `rv`: a sun, planets and cranks, ratio 1 + pins planet/sun.
    #[arg(long, default_value = "cycloidal", value_parser = ["cycloidal", "rv"])]
    kind: String,
    /// Cranks, with `--kind rv` [default: 2, or 3 from a pin circle of 200 mm on].
    #[arg(long, value_parser = clap::value_parser!(u16).range(2..=12))]
    cranks: Option<u16>,
    /// Diameter of the circle on which the pins stand.
    #[arg(long, value_name = "MM", value_parser = millimetres, required_unless_present = "outer_diameter_mm")]
    pin_circle_diameter_mm: Option<f64>,
    /// Outer diameter of a catalogue, by which the circle of the pins is suggested.
    #[arg(long, value_name = "MM", value_parser = millimetres, conflicts_with = "pin_circle_diameter_mm")]
    outer_diameter_mm: Option<f64>,
    /// Rated torque of the output.
    #[arg(long, value_name = "NM", value_parser = newton_metres)]
    torque_n_m: f64,
    /// Rated speed of the input.
    #[arg(long, value_name = "RPM", value_parser = turns_a_minute)]
    speed_rpm: f64,
    /// Diameter of a pin with its sleeve.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    pin_diameter_mm: Option<f64>,
    /// Eccentricity.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    eccentricity_mm: Option<f64>,
    /// Number of cycloidal discs.
    #[arg(long, visible_alias = "discs", value_parser = clap::value_parser!(u16).range(1..=64))]
    wheels: Option<u16>,
    /// Number of output pins.
    #[arg(long, value_parser = clap::value_parser!(u16).range(3..=1000))]
    output_pins: Option<u16>,
    /// Diameter of an output pin with its pin; holes are larger by twice the eccentricity.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    output_pin_diameter_mm: Option<f64>,
    /// Diameter of the circle on which the output pins stand.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    output_circle_diameter_mm: Option<f64>,
    /// Thickness of a disc.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    face_width_mm: Option<f64>,
    /// Radial backlash at the pins.
    #[arg(long, value_name = "MM", value_parser = millimetres)]
    backlash_mm: Option<f64>,
    /// Coefficient of friction, of contacts and of sleeves on their pins.
    #[arg(long, value_name = "MU")]
    friction: Option<f64>,
    /// Material of the discs.
    #[arg(long, default_value = "steel", value_parser = materials())]
    material: Material,
    /// Material of the pins [default: steel; with --ideal that of the discs].
    #[arg(long, value_parser = materials())]
    pin_material: Option<Material>,
    /// Process by which discs are made, for the fits [default: ground; printed if of pla or nylon, milled if of pom].
    #[arg(long, value_parser = PROCESSES.iter().map(|process| process.name).collect::<Vec<_>>(), conflicts_with = "ideal")]
    process: Option<String>,
    /// Leave out clearances, bearings, friction and bending.
    #[arg(long)]
    ideal: bool,
    /// Replace an existing file.
    #[arg(long)]
    pub(crate) force: bool,
}

/// Reads a number, converted to this unit if typed with another one.
fn number(typed: &str, unit: &str, words: &str) -> Result<f64, String> {
    let number = quantity::read(typed, unit).filter(|number| number.is_finite());
    match number {
        Some(number) if typed.contains(',') => Err(format!("write a decimal point: {number}")),
        Some(number) => Ok(number),
        None => Err(format!("write a number of {words}, such as 104")),
    }
}

fn millimetres(typed: &str) -> Result<f64, String> {
    number(typed, "mm", "millimetres")
}

fn newton_metres(typed: &str) -> Result<f64, String> {
    let torque = number(typed, "n_m", "newton metres")?;
    match torque == 0.0 {
        true => Err("write the rated torque, such as 104".to_owned()),
        false => Ok(torque),
    }
}

fn turns_a_minute(typed: &str) -> Result<f64, String> {
    number(typed, "rpm", "turns a minute")
}

/// Reads a ratio: `39`, `39:1` or `118.5`.
fn ratio(typed: &str) -> Result<f64, String> {
    let number = typed.trim().strip_suffix(":1").unwrap_or(typed).trim();
    let ratio = number.parse().ok();
    let ratio = ratio.filter(|ratio| (2.0..=999.0).contains(ratio));
    ratio.ok_or_else(|| "write a number from 2 to 999: 39 is 39:1; make each of two stages in one housing a scene".to_owned())
}

/// Returns a parser of a material by its name; the help lists the names.
fn materials() -> impl TypedValueParser<Value = Material> {
    let names = MATERIALS.iter().map(|material| material.name);
    PossibleValuesParser::new(names)
        .try_map(|name| catalogue::material(&name).copied().ok_or("unknown"))
}

impl InitArgs {
    pub(crate) fn catalogue(&self, name: String) -> Result<Catalogue, Failure> {
        let mm = |length: f64| 1e-3 * length;
        if self.kind != "rv" && self.cranks.is_some() {
            let text = "--cranks belongs to an RV gear; add --kind rv, or leave it out";
            return Err(Failure::input(text));
        }
        let is_rv = self.kind == "rv";
        let outer = self.outer_diameter_mm.map(mm);
        let circle = self.pin_circle_diameter_mm.map(mm);
        let circle = circle.or(outer.map(|outer| pin_circle_of_m(outer, is_rv)));
        let circle = circle.unwrap_or_default();
        Ok(Catalogue {
            name,
            ratio: self.ratio,
            cranks: is_rv.then(|| {
                let usual = if circle < 0.2 { 2 } else { 3 };
                self.cranks.map_or(usual, usize::from)
            }),
            pin_circle_diameter_m: circle,
            outer_diameter_m: outer,
            torque_n_m: self.torque_n_m,
            speed_rad_s: self.speed_rpm * std::f64::consts::PI / 30.0,
            material: self.material,
            pin_material: self.pin_material,
            process: self.process.as_deref().and_then(process),
            ideal: self.ideal,
            pin_diameter_m: self.pin_diameter_mm.map(mm),
            eccentricity_m: self.eccentricity_mm.map(mm),
            wheels: self.wheels.map(usize::from),
            output_pins: self.output_pins.map(usize::from),
            output_pin_diameter_m: self.output_pin_diameter_mm.map(mm),
            output_circle_diameter_m: self.output_circle_diameter_mm.map(mm),
            face_width_m: self.face_width_mm.map(mm),
            backlash_m: self.backlash_mm.map(mm),
            friction_coefficient: self.friction,
        })
    }
}

/// `pinwheel design`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/design.txt").trim_ascii_end())]
pub(crate) struct DesignArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Fit all that the scene leaves rigid to a stiffness that a catalogue or a measurement states.
    #[arg(long, value_name = "NM")]
    pub(crate) stated_stiffness_n_m_arcmin: Option<f64>,
    /// Omit figures that need runs: hysteresis and efficiency.
    #[arg(long)]
    pub(crate) statics: bool,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}
