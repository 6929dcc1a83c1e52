//! Scenes from catalogue data, with suggestions for dimensions that a data sheet lacks.
//!
//! ```text
//!  catalogue ─> dimensions, each given or suggested ─> text of a scene with comments ─> checked like any other scene
//! ```
//!
//! Suggestions follow three rules. The shortening coefficient e zk/R is 0.65, less if the pins would undercut the disc:
//! high values carry more and bend the profile sharply. Pins leave a third of their pitch free. Holes leave walls of a
//! tenth of their radius, and of 3 % of the pin circle's diameter between them, and the largest pins that fit are taken.
//! They are a start for a design, not its result.

use std::f64::consts::PI;
use std::fmt::Write as _;
use std::ops::RangeInclusive;

use crate::as_built::{self, Basis, NEEDLE, Process, UNCERTAIN, needles, section};
use crate::checked::CheckedScene;
use crate::error::{Fault, SceneError};
use crate::model::{Gear, Scene};
#[doc(hidden)]
pub use crate::number::rounded_down;
use crate::number::{short, written};
use crate::profile::Profile;

pub use crate::materials::{MATERIALS, Material, material};

/// Catalogue data. Lengths are diameters, as in catalogues; `None` is replaced by a suggestion.
#[derive(Debug, Clone, PartialEq)]
pub struct Catalogue {
    /// Name of the scene.
    pub name: String,
    /// Input turns per output turn with a fixed housing: the number of lobes, and of an RV gear 1 + zk planet/sun, in the
    /// digits of its catalogue.
    pub ratio: f64,
    /// Number of cranks of an RV gear; `None`: one eccentric and output pins.
    pub cranks: Option<usize>,
    /// Diameter of the ring pins' circle, m.
    pub pin_circle_diameter_m: f64,
    /// Outer diameter that the circle was suggested by ([`pin_circle_of_m`]), m; `None`: the circle is given.
    pub outer_diameter_m: Option<f64>,
    /// Rated torque of the output, N m.
    pub torque_n_m: f64,
    /// Rated speed of the input, rad/s.
    pub speed_rad_s: f64,
    /// Material of the discs; its density gives all masses.
    pub material: Material,
    /// Material of the pins; `None`: steel, or of an ideal gear the material of the discs.
    pub pin_material: Option<Material>,
    /// Process by which discs are made; `None`: the usual one for the material.
    pub process: Option<&'static Process>,
    /// True for no suggestions of clearances, bearings, friction and bending.
    pub ideal: bool,
    /// Diameter of a ring pin, m.
    pub pin_diameter_m: Option<f64>,
    /// Eccentricity, m.
    pub eccentricity_m: Option<f64>,
    /// Number of discs.
    pub wheels: Option<usize>,
    /// Number of output pins.
    pub output_pins: Option<usize>,
    /// Diameter of an output pin, m.
    pub output_pin_diameter_m: Option<f64>,
    /// Diameter of the output pins' circle, m.
    pub output_circle_diameter_m: Option<f64>,
    /// Thickness of a disc, m.
    pub face_width_m: Option<f64>,
    /// Radial backlash at the pins, m.
    pub backlash_m: Option<f64>,
    /// Coefficient of friction.
    pub friction_coefficient: Option<f64>,
}

/// Scene drafted from catalogue data.
#[derive(Debug, Clone)]
pub struct Draft {
    /// Text of the scene file, with a comment for every line.
    pub text: String,
    /// Checked scene of the text.
    pub scene: CheckedScene,
    /// Keys with suggested values.
    pub suggested: Vec<String>,
    /// Toleranced keys, one a line; empty for an ideal gear.
    pub toleranced: String,
}

impl Draft {
    /// Returns a study of the draft's tolerances for the scene file `scene`; `None` for an ideal gear.
    pub fn study(&self, scene: &str) -> Option<String> {
        (!self.toleranced.is_empty()).then(|| {
            format!(
                "# Balances at rest of gears whose fits are drawn at random, each evenly over its interval.\n\
                 scene = {scene:?}\nengines = [\"statics\"]\n\n[sample]\npoints = {STUDY}\nmethod = \"sobol\"\n{}\n\
                 # [specification]                            # limits, of which the yield is told\n\
                 # lost_motion_arcmin = {{ most = 5.0 }}\n",
                self.toleranced
            )
        })
    }
}

/// Number of gears in the study of tolerances.
const STUDY: usize = 64;

/// Keys and the names of their catalogue data on the command line, in the units of catalogues.
pub const ARGUMENTS: &[(&str, &str)] = &[
    ("gear.pin_circle_radius_m", "pin_circle_diameter_mm"),
    ("gear.shortening", "pin_circle_diameter_mm"),
    ("gear.external_sleeves", "ratio"),
    ("gear.external_sleeve_radius_m", "pin_diameter_mm"),
    ("gear.eccentricity_m", "eccentricity_mm"),
    ("gear.internal_sleeves", "output_pins"),
    ("gear.internal_sleeve_radius_m", "output_pin_diameter_mm"),
    ("gear.hole_radius_m", "output_pin_diameter_mm"),
    ("gear.internal_circle_radius_m", "output_circle_diameter_mm"),
    ("gear.face_width_m", "face_width_mm"),
    ("contact.line_length_m", "face_width_mm"),
    ("gear.backlash_m", "backlash_mm"),
    ("drive.input_speed_rad_s", "speed_rpm"),
    ("drive.output_torque_n_m", "torque_n_m"),
    ("contact.friction_coefficient", "friction"),
];

/// Young's modulus below which a disc is of plastic, Pa.
const PLASTIC_PA: f64 = 2e10;
/// Lower bound of a pin circle, m; smaller values were probably typed in metres instead of millimetres.
const IN_METRES: f64 = 3e-3;
/// Suggested shortening coefficient, and the least one.
const SHORTENING: [f64; 2] = [0.65, 0.35];
/// Largest ring pin over half the pitch, and over the radius that undercuts the disc.
const PIN: [f64; 2] = [0.65, 0.8];
/// Least wall beside a hole over its radius, and between two holes over R.
const WALL: f64 = 0.1;
const BETWEEN: f64 = 0.06;
/// Circle of the output pins over the pits' radius, first trial.
const CIRCLE: f64 = 0.62;
/// Largest hole over its circle, which leaves room for the eccentric's bearing.
const INWARDS: f64 = 0.45;
/// Ratio of one stage above which the file notes that the gear has only one.
pub const MANY: f64 = 60.0;
/// Numbers of output pins in the order they are tried.
const OUTPUT_PINS: [usize; 5] = [8, 6, 10, 5, 4];
/// Face width over R.
const FACE: f64 = 0.15;
/// Numbers for RV gears. Pins: first trial, least and most; then the teeth of a sun; then planet over sun.
const RV_PINS: [usize; 3] = [40, 20, 80];
const SUN: RangeInclusive<usize> = 12..=30;
const TEETH: RangeInclusive<usize> = 1..=6;
/// Keys of an RV gear's cranks that are always suggested.
const OF_CRANKS: [&str; 6] = [
    "cranks.bore_radius_m",
    "cranks.sun_teeth",
    "cranks.planet_teeth",
    "bearings.eccentric.rollers",
    "bearings.eccentric.roller_length_m",
    "bearings.eccentric.roller_diameter_m",
];
/// Diameter of the pin circle over the outer diameter: suggested, least and largest of known gears.
///
/// One eccentric: 0.769, 0.783, 0.800 (printed drives of 10:1, 15:1 and 29:1 whose authors state both). RV gears: 0.674, 0.698, 0.735
/// (the rings of `rv-40e-like`, `rv-80e-like` and `rv-320` in catalogue sizes of 190, 222 and 325 mm, from memory).
const OF_OUTER: [f64; 3] = [0.78, 0.76, 0.80];
const OF_OUTER_RV: [f64; 3] = [0.70, 0.67, 0.74];
/// Largest bore for a crank over the cranks' circle.
const BORE: f64 = 0.3;

const LEFT_OUT: &str = "# Left out: torsion of carrier, case and flanges, discs that bend, main bearings, backlash of the first stage. They make\n\
                        # most of a real RV gear's compliance; `pinwheel design --stated-stiffness-n-m-arcmin` says how much is missing.\n";

fn of_outer(is_rv: bool) -> [f64; 3] {
    if is_rv { OF_OUTER_RV } else { OF_OUTER }
}

/// Returns the suggested diameter of the pin circle of a gear with this outer diameter, m, in whole millimetres from 20 mm on.
pub fn pin_circle_of_m(outer_diameter_m: f64, is_rv: bool) -> f64 {
    let circle = of_outer(is_rv)[0] * outer_diameter_m;
    let unit = if circle < 0.02 { 1e-4 } else { 1e-3 };
    (circle / unit).round() * unit
}

/// Numbers of pins and of teeth of sun and planet.
type FirstStage = [usize; 3];

/// Returns the first stage of an RV gear of a ratio, with nearly the usual number of pins; `None` if there is none. A ratio
/// with decimals is met within one unit of the last: catalogues round 1347/7 to 192.42.
#[doc(hidden)]
pub fn first_stage(ratio: f64) -> Option<FirstStage> {
    let digits = ratio.to_string();
    let decimals = digits.split_once('.').map_or(0, |(_, after)| after.len());
    let slack = if decimals == 0 {
        1e-9
    } else {
        0.1_f64.powi(decimals as i32)
    };
    let [usual, least, most] = RV_PINS;
    let mut pins: Vec<usize> = (least..=most).step_by(2).collect();
    pins.sort_by_key(|pins| pins.abs_diff(usual));
    let stages = pins.into_iter().flat_map(|pins| {
        SUN.map(move |sun| {
            let planet = ((ratio - 1.0) * sun as f64 / pins as f64).round() as usize;
            let made = 1.0 + (pins * planet) as f64 / sun as f64;
            ([pins, sun, planet], (made - ratio).abs())
        })
    });
    let fits = |([_, sun, planet], off): &(FirstStage, f64)| {
        *off <= slack && TEETH.contains(&(planet / sun))
    };
    let rounding = |off: f64| (off * 1e9).round();
    let best = stages
        .filter(fits)
        .min_by(|a, b| rounding(a.1).total_cmp(&rounding(b.1)));
    best.map(|(stage, _)| stage)
}

impl Catalogue {
    /// Drafts a scene from the catalogue data, with suggestions for missing dimensions.
    ///
    /// # Errors
    /// Dimensions that cannot be built, or leave no room for suggested ones; the message names the dimension.
    pub fn draft(&self) -> Result<Draft, Fault> {
        if self.cranks.is_some() && self.output_pins.is_some() {
            return Err(Fault::new(
                &["gear.internal_sleeves"],
                "belongs to a gear of one eccentric: cranks carry the output of an RV gear",
                "leave it out, or give the number of cranks",
            ));
        }
        self.attempt().map_err(|fault| self.blamed(fault))
    }

    /// Converts a fault to one of the given dimension, or the two, without which the draft succeeds.
    fn blamed(&self, fault: Fault) -> Fault {
        let metres = Self {
            pin_circle_diameter_m: 1e3 * self.pin_circle_diameter_m,
            ..self.clone()
        };
        if self.pin_circle_diameter_m < IN_METRES && metres.attempt().is_ok() {
            let [typed, meant] =
                [self.pin_circle_diameter_m, metres.pin_circle_diameter_m].map(millimetres);
            return Fault::new(
                &["gear.pin_circle_radius_m"],
                format!("belongs to a circle of {typed} mm"),
                format!("did you type metres? {meant}"),
            );
        }
        let lighter = Self {
            torque_n_m: 1e-3 * self.torque_n_m,
            ..self.clone()
        };
        let is_load = fault
            .keys
            .first()
            .is_some_and(|key| key == "contact.ramp_m");
        if is_load && lighter.attempt().is_ok() {
            return Fault::new(
                &["drive.output_torque_n_m"],
                format!("is {} N m, more than such a gear carries", self.torque_n_m),
                format!("did you type N mm? {}", lighter.torque_n_m),
            );
        }
        let first = fault.keys.first().map_or("the gear", AsRef::as_ref);
        let all = self.without_one();
        for (key, given, without) in &all {
            let Ok(draft) = without.attempt() else {
                continue;
            };
            let gear = &draft.scene.gear;
            let suggested = match *key {
                "gear.eccentricity_m" => gear.eccentricity_m,
                "gear.external_sleeve_radius_m" => 2.0 * gear.external_sleeve_radius_m,
                "gear.internal_sleeve_radius_m" => 2.0 * gear.internal_sleeve_radius_m,
                "gear.internal_circle_radius_m" => 2.0 * gear.internal_circle_radius_m,
                "gear.backlash_m" => gear.backlash_m,
                _ => 1e-3 * gear.internal_sleeves as f64,
            };
            let [given, suggested] = [*given, suggested].map(millimetres);
            return Fault::new(
                &[key],
                format!(
                    "does not go with the rest: {given} is given, and `{first}` {}",
                    fault.what
                ),
                format!("leave it out, or give {suggested}, which would be suggested"),
            );
        }
        for (key, _, without) in &all {
            let rest = without.without_one().into_iter();
            let mut rest = rest.filter(|(_, _, without)| without.attempt().is_ok());
            if let Some((other, ..)) = rest.next() {
                return Fault::new(
                    &[key, other],
                    format!(
                        "and `{other}` do not go with the rest: `{first}` {}",
                        fault.what
                    ),
                    "leave both out",
                );
            }
        }
        fault
    }

    /// Returns given values that can be omitted: key, value in metres or a thousandth of a count, and the data without it.
    fn without_one(&self) -> Vec<(&'static str, f64, Self)> {
        let mut all = Vec::new();
        macro_rules! each {
            ($($field:ident $key:literal $value:expr;)*) => {
                $(if let Some(given) = self.$field {
                    let without = Self { $field: None, ..self.clone() };
                    all.push(($key, $value(given), without));
                })*
            };
        }
        each! {
            output_circle_diameter_m "gear.internal_circle_radius_m" |given: f64| given;
            output_pin_diameter_m "gear.internal_sleeve_radius_m" |given: f64| given;
            output_pins "gear.internal_sleeves" |given| 1e-3 * given as f64;
            pin_diameter_m "gear.external_sleeve_radius_m" |given: f64| given;
            eccentricity_m "gear.eccentricity_m" |given: f64| given;
            backlash_m "gear.backlash_m" |given: f64| given;
        }
        all
    }

    fn attempt(&self) -> Result<Draft, Fault> {
        let (gear, suggested) = self.plan()?;
        let as_built = self.as_built(&gear);
        let text = self.write(&gear, &suggested, &as_built);
        let suggested = suggested.into_iter().map(str::to_owned);
        let suggested = suggested.chain(as_built::suggested(&as_built)).collect();
        // No line number: the user does not have the text yet.
        let scene = Scene::from_toml(&text, "draft", &[]).map_err(|error| match error {
            SceneError::Key {
                key, what, remedy, ..
            } => Fault {
                // Scenes state radii in metres, catalogues diameters in millimetres.
                what: format!("gives a scene whose {key} {what}"),
                keys: vec![key.into()],
                remedy,
            },
            other => Fault::new(&["scene"], other.to_string(), "give other dimensions"),
        })?;
        let text = with_what_follows(text, &scene);
        Ok(Draft {
            text,
            scene,
            suggested,
            toleranced: section(&as_built, UNCERTAIN, false),
        })
    }

    /// Returns the given process of the discs, or the usual one for the material; `None` for an ideal gear.
    fn process(&self) -> Option<&'static Process> {
        let usual = match self.material.name {
            "pla" | "nylon" => "printed",
            "pom" => "milled",
            _ => "ground",
        };
        let process = self.process.or_else(|| as_built::process(usual));
        process.filter(|_| !self.ideal)
    }

    /// Returns the given material of the pins, or steel; of an ideal gear that of the discs.
    fn pins(&self) -> Material {
        let usual = if self.ideal {
            self.material
        } else {
            MATERIALS[0]
        };
        self.pin_material.unwrap_or(usual)
    }

    /// Returns the lines of a gear as built; empty for an ideal gear.
    fn as_built(&self, gear: &Gear) -> String {
        let basis = self.process().map(|process| Basis {
            process,
            pin_young_pa: self.pins().young_pa,
            is_plastic: self.material.young_pa < PLASTIC_PA,
            friction_coefficient: self.friction_coefficient,
            has_backlash: self.backlash_m.is_some(),
            cranks: self.cranks,
            torque_n_m: self.torque_n_m,
        });
        basis.map_or_else(String::new, |basis| basis.lines(gear))
    }

    fn first_stage(&self) -> Result<FirstStage, Fault> {
        first_stage(self.ratio).ok_or_else(|| {
            let [_, least, most] = RV_PINS;
            let around = |off: u16| [-1.0, 1.0].map(|sign| self.ratio.round() + sign * f64::from(off));
            let mut near = (0..999).flat_map(around);
            let near = near.find(|ratio| first_stage(*ratio).is_some());
            Fault::new(
                &["gear.external_sleeves"],
                format!(
                    "finds no first stage: no even number of pins from {least} to {most} makes 1 + pins planet/sun = {}",
                    self.ratio
                ),
                format!("give a ratio such as {}", near.unwrap_or(121.0)),
            )
        })
    }

    fn plan(&self) -> Result<(Gear, Vec<&'static str>), Fault> {
        let mut suggested = Vec::new();
        let mut take = |given: Option<f64>, key: &'static str, suggest: &dyn Fn() -> f64| {
            given.unwrap_or_else(|| {
                suggested.push(key);
                suggest()
            })
        };
        let pins = match self.cranks {
            Some(_) => self.first_stage()?[0],
            None if self.ratio.fract() != 0.0 => {
                let [below, above] = [self.ratio.floor(), self.ratio.ceil()];
                return Err(Fault::new(
                    &["gear.external_sleeves"],
                    format!(
                        "is {}, but the ratio of one eccentric is a whole number, that of the lobes",
                        self.ratio
                    ),
                    format!(
                        "give {below} or {above}, or the kind `rv`, whose first stage has a ratio of its own; make each of two stages in one housing a scene"
                    ),
                ));
            }
            None => self.ratio as usize + 1,
        };
        let radius = 0.5 * self.pin_circle_diameter_m;
        let half_pitch = radius * (PI / pins as f64).sin();
        let mut gear = Gear {
            external_sleeves: pins,
            wheels: self.wheels.unwrap_or(2),
            backlash_m: self.backlash_m.unwrap_or(0.0),
            ..Scene::paper().gear
        };
        let eccentricity = |shortening: f64| shortening * radius / pins as f64;
        let undercut = |e: f64, gear: &Gear| {
            let gear = Gear {
                eccentricity_m: e,
                shortening: e * pins as f64 / radius,
                ..gear.clone()
            };
            Profile::of(&gear).smallest_convex_radius()
        };
        gear.eccentricity_m = take(self.eccentricity_m, "gear.eccentricity_m", &|| {
            let [most, least] = SHORTENING;
            let fits = |e: &f64| {
                self.pin_diameter_m
                    .is_none_or(|pin| 0.5 * pin <= PIN[1] * undercut(*e, &gear))
            };
            let tried = (0..=12).map(|k| most - (most - least) * f64::from(k) / 12.0);
            let mut tried = tried.map(|m| rounded_down(eccentricity(m)));
            tried
                .find(fits)
                .unwrap_or(rounded_down(eccentricity(least)))
        });
        gear.shortening = gear.eccentricity_m * pins as f64 / radius;
        if gear.shortening >= 1.0 {
            let [e, circle, most] =
                [gear.eccentricity_m, 2.0 * radius, eccentricity(1.0)].map(millimetres);
            return Err(Fault::new(
                &["gear.eccentricity_m"],
                format!(
                    "is {e} mm: {pins} pins on a circle of {circle} mm allow less than {most} mm, or the profile crosses itself"
                ),
                "make it smaller, or leave it out to have one suggested",
            ));
        }
        let pin = take(
            self.pin_diameter_m,
            "gear.external_sleeve_radius_m",
            &|| {
                let most = (PIN[0] * half_pitch).min(PIN[1] * undercut(gear.eccentricity_m, &gear));
                rounded_down(2.0 * most)
            },
        );
        gear.external_sleeve_radius_m = 0.5 * pin;
        self.output_stage(&mut gear, &mut suggested)?;
        gear.face_width_m = self.face_width_m.or_else(|| {
            suggested.push("gear.face_width_m");
            Some(rounded_down(FACE * radius))
        });
        if self.wheels.is_none() {
            suggested.push("gear.wheels");
        }
        if self.outer_diameter_m.is_some() {
            suggested.push("gear.pin_circle_radius_m");
        }
        Ok((gear, suggested))
    }

    /// Sets output pins, their circle and the holes: the given values, else the largest that fit.
    fn output_stage(
        &self,
        gear: &mut Gear,
        suggested: &mut Vec<&'static str>,
    ) -> Result<(), Fault> {
        let pit = Profile::of(gear).pit_radius();
        let radius = 0.5 * self.pin_circle_diameter_m;
        let counts = (self.cranks.or(self.output_pins)).map_or(OUTPUT_PINS.to_vec(), |n| vec![n]);
        let inwards = if self.cranks.is_some() { BORE } else { INWARDS };
        let circles: Vec<f64> = match self.output_circle_diameter_m {
            Some(diameter) => vec![0.5 * diameter],
            // Trials go outwards from the usual value to both sides.
            None => (0..=20)
                .map(|k| {
                    CIRCLE + 0.01 * f64::from((k + 1) / 2) * if k % 2 == 0 { 1.0 } else { -1.0 }
                })
                .map(|share| 0.5 * rounded_down(2.0 * share * pit))
                .collect(),
        };
        let e = gear.eccentricity_m;
        let least = self.output_pin_diameter_m.map_or(0.5 * e, |pin| 0.5 * pin);
        let process = self.process().filter(|_| self.cranks.is_none());
        let play = |hole: f64| process.map_or(0.0, |process| process.fit(2.0 * hole).usual_m);
        let mut best: Option<(usize, f64, f64)> = None;
        'search: for &count in &counts {
            for &circle in &circles {
                let most = ((pit - circle) / (1.0 + WALL))
                    .min(circle * (PI / count as f64).sin() - 0.5 * BETWEEN * radius)
                    .min(inwards * circle);
                let sleeve = match self.output_pin_diameter_m {
                    Some(pin) => 0.5 * pin,
                    None => 0.5 * rounded_down(2.0 * (most - e - play(most))),
                };
                // The scene's checks judge output pins that are given completely.
                let given = self.output_pin_diameter_m.is_some()
                    && self.output_circle_diameter_m.is_some()
                    && self.output_pins.is_some();
                if given || (sleeve >= least && sleeve + e + play(sleeve + e) <= most) {
                    best = Some((count, circle, sleeve));
                    break 'search;
                }
            }
        }
        let Some((count, circle, sleeve)) = best else {
            let room = if pit > 0.0 {
                format!(
                    "leave a radius of {} mm for holes of pin + 2 e and their walls",
                    millimetres(pit)
                )
            } else {
                "reach its centre".to_owned()
            };
            return Err(Fault::new(
                &["gear.internal_sleeve_radius_m"],
                format!("finds no place: the disc's pits {room}"),
                "give smaller or fewer output pins, another circle for them, or a smaller eccentricity",
            ));
        };
        gear.internal_sleeves = count;
        gear.internal_circle_radius_m = circle;
        gear.internal_sleeve_radius_m = sleeve;
        gear.hole_radius_m = sleeve + e + play(sleeve + e);
        if self.cranks.is_some() {
            let circle = self.output_circle_diameter_m.is_none();
            suggested.extend(circle.then_some("cranks.circle_radius_m"));
            suggested.extend(OF_CRANKS);
            return Ok(());
        }
        let mut open = |is_open: bool, key| suggested.extend(is_open.then_some(key));
        let [pin, circle] = [self.output_pin_diameter_m, self.output_circle_diameter_m];
        open(self.output_pins.is_none(), "gear.internal_sleeves");
        open(pin.is_none(), "gear.internal_sleeve_radius_m");
        open(circle.is_none(), "gear.internal_circle_radius_m");
        Ok(())
    }

    /// Returns the text of the scene file.
    fn write(&self, gear: &Gear, suggested: &[&str], as_built: &str) -> String {
        let mut text = format!(
            "# A gear of ratio {} for {} N m at {} rpm of the input, in SI units. Lines marked `suggested` were not given.\n\
             # What a scene leaves out is computed or usual; `pinwheel explain` lists it with its formula.\n",
            self.ratio,
            short(self.torque_n_m),
            short(self.speed_rad_s * 30.0 / PI)
        );
        let _ = writeln!(text, "name = {:?}\n\n[gear]", self.name);
        // The reason of a suggested value follows the bar.
        let mark = |key: &str, about: &str| match (suggested.contains(&key), about.split_once('|'))
        {
            (true, Some((about, why))) => format!("suggested: {about}; {why}"),
            (true, None) => format!("suggested: {about}"),
            (false, parts) => parts.map_or(about, |(about, _)| about).to_owned(),
        };
        let mut line = |key: &'static str, value: String, about: &str| {
            let about = mark(key, about);
            let assignment = format!("{} = {value}", key.rsplit('.').next().unwrap_or(key));
            let _ = writeln!(text, "{assignment:<44} # {about}");
        };
        let m = written;
        let circle_of = self.outer_diameter_m.map(|outer| {
            let [share, least, most] = of_outer(self.cranks.is_some());
            let [from, to] = [least, most].map(|share| short((5e4 * share * outer).round() / 1e2));
            let outer = millimetres(outer);
            format!(
                "R, {share} of half the outer diameter of {outer} mm; known gears {least} to {most}: {from} to {to} mm"
            )
        });
        let circle_of = circle_of.unwrap_or_else(|| "R, circle of the pins".to_owned());
        let shortening = format!("e; shortening coefficient e zk/R = {:.3}", gear.shortening);
        macro_rules! lines {
            ($($key:literal $value:expr, $about:expr;)*) => {
                $(line($key, $value, $about);)*
            };
        }
        lines! {
            "gear.pin_circle_radius_m" m(0.5 * self.pin_circle_diameter_m), &circle_of;
            "gear.external_sleeves" gear.external_sleeves.to_string(), match (self.cranks, self.ratio > MANY) {
                (Some(_), _) => "pins on the housing",
                (None, true) => "pins on the housing: ratio + 1, in one stage; of two stages in one housing make each a scene",
                (None, false) => "pins on the housing: ratio + 1",
            };
            "gear.external_sleeve_radius_m" m(gear.external_sleeve_radius_m), "radius of a pin with its sleeve|0.65 of half the pitch, less if that undercuts";
            "gear.eccentricity_m" m(gear.eccentricity_m), &shortening;
            "gear.wheels" gear.wheels.to_string(), "cycloidal discs, evenly phased|two balance each other";
            "gear.face_width_m" m(gear.face_width_m.unwrap_or_default()), "thickness of a disc; masses follow from it|0.15 R";
        }
        if gear.backlash_m > 0.0 {
            line(
                "gear.backlash_m",
                m(gear.backlash_m),
                "the pins stand on R + this",
            );
        }
        let circle = m(gear.internal_circle_radius_m);
        if self.cranks.is_none() {
            lines! {
                "gear.internal_sleeves" gear.internal_sleeves.to_string(), "output pins|eight, or what leaves walls";
                "gear.internal_sleeve_radius_m" m(gear.internal_sleeve_radius_m), "radius of an output pin with its pin; holes are larger by e|the largest that leaves walls";
                "gear.internal_circle_radius_m" circle, "circle of the output pins|0.62 of the pits' radius, or what leaves walls";
            }
            text.push_str(&section(as_built, "gear", false));
            text.push_str(&section(as_built, "bearings.eccentric", true));
        } else if let Some([pins, sun, planet]) = first_stage(self.ratio) {
            text.push_str(&section(as_built, "gear", false));
            let bore = gear.hole_radius_m;
            let (needles, length) = needles(gear.face_width_m.unwrap_or_default());
            // Parts that an ideal gear omits are a remark.
            let [supports, play] = match as_built.is_empty() {
                true => [
                    "# support_stiffness_n_m = 5e8                # of what holds a crank in the output; rigid as long as it is left out\n",
                    "# clearance_m = 5e-6                         # radial; it makes most of the lost motion\n",
                ]
                .map(str::to_owned),
                false => ["cranks", "bearings.eccentric"].map(|name| section(as_built, name, false)),
            };
            let _ = write!(
                text,
                "\n[cranks]\n\
                 count = {:<36} # cranks, each with a planet; usual are 2, and 3 from a pin circle of 200 mm on\n\
                 circle_radius_m = {circle:<26} # {}\n\
                 bore_radius_m = {:<28} # suggested: a disc's bore for a crank; the largest that leaves walls\n\
                 sun_teeth = {sun:<32} # suggested: 1 + {pins} planet/sun is the ratio\n\
                 planet_teeth = {planet:<29} # suggested: as the sun's, with next to 40 pins\n\
                 {supports}\n[bearings.eccentric]\n\
                 rollers = {needles:<34} # suggested: needles in a bore, 0.85 of the way around\n\
                 roller_length_m = {:<26} # suggested: 0.9 of a disc\n\
                 roller_diameter_m = {:<24} # suggested: for its ratings\n{play}",
                gear.internal_sleeves,
                mark(
                    "cranks.circle_radius_m",
                    "circle they stand on|0.62 of the pits' radius, or what leaves walls"
                ),
                m(bore),
                m(length),
                m(rounded_down(2.0 * NEEDLE * bore)),
            );
        }
        for name in ["gear.modification", "bearings", UNCERTAIN] {
            text.push_str(&section(as_built, name, true));
        }
        if self.cranks.is_some() && !as_built.is_empty() {
            text.push_str(LEFT_OUT);
        }
        let speed = written(self.speed_rad_s);
        // The output of an RV gear turns with the input: a load against the motion is negative.
        let torque = match self.cranks {
            Some(_) => format!(
                "{:<24} # against the motion: the output turns with the input",
                written(-self.torque_n_m.abs())
            ),
            None => written(self.torque_n_m),
        };
        let rpm = short(self.speed_rad_s * 30.0 / PI);
        let Material {
            name,
            young_pa,
            poisson,
            density_kg_m3,
            ..
        } = self.material;
        let young = format!("{young_pa:e}");
        let density = written(density_kg_m3);
        let friction = self.friction_coefficient;
        let friction = friction.map_or_else(
            || section(as_built, "contact", false),
            |mu| format!("friction_coefficient = {mu}\n"),
        );
        let (mut pins, mut masses) = (String::new(), String::new());
        if self.pins() != self.material {
            let given = self.pin_material.map_or("suggested: ", |_| "");
            let Material {
                name,
                young_pa,
                poisson,
                density_kg_m3,
                ..
            } = self.pins();
            pins = format!(
                "pin_material = {name:?}\npin_young_pa = {young_pa:<29e} # {given}pins of {name}\npin_poisson = {poisson}\n"
            );
            let length = gear.wheels as f64 * gear.face_width_m.unwrap_or_default();
            let cylinder = |radius: f64| {
                let mass = density_kg_m3 * PI * radius * radius * length;
                let moment = 0.5 * mass * radius * radius;
                format!("{{ mass_kg = {mass:.3e}, moment_kg_m2 = {moment:.3e} }} # of {name}")
            };
            let [inner, outer] =
                [gear.internal_sleeve_radius_m, gear.external_sleeve_radius_m].map(cylinder);
            masses = format!("internal_sleeve = {inner}\nexternal_sleeve = {outer}\n");
        }
        let _ = write!(
            text,
            "\n[drive]\ninput_speed_rad_s = {speed:<24} # {rpm} rpm\noutput_torque_n_m = {torque}\n\
             \n[contact]\nlaw = \"line-hertz\"                         # rollers on a line; `pinwheel laws` lists others\nmaterial = {:<33} # for its limits\nyoung_pa = {young:<33} # {name}\npoisson = {poisson}\n{pins}{friction}\
             \n[mass]\ndensity_kg_m3 = {density:<28} # {name}\n{masses}",
            format!("{name:?}")
        );
        text
    }
}

/// Returns the text with a final remark on masses, which follow from the shapes, and walls.
fn with_what_follows(mut text: String, scene: &CheckedScene) -> String {
    let mass = &scene.mass;
    let _ = writeln!(
        text,
        "# From the shapes: a disc has {} kg, the input shaft {} kg, the output shaft {} kg without its pins. Real ones differ:\n\
         # state what you know as input_shaft, output_shaft, disc, internal_sleeve, external_sleeve = {{ mass_kg = .., moment_kg_m2 = .. }}",
        short(mass.wheel.mass_kg),
        short(mass.input_shaft.mass_kg),
        short(mass.output_shaft.mass_kg),
    );
    text
}

fn millimetres(length_m: f64) -> String {
    short(1e3 * length_m)
}
