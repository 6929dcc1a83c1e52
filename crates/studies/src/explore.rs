//! Interactive states of a scene: sliders of its keys, and results of a quick run and balances.
//!
//! `pinwheel explore` serves the page: the page sends the values of a state, and [`motion`] and [`figures`] compute it.

use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::sync::atomic::AtomicBool;

use pinwheel_engines::Cancelled;
use pinwheel_gearbox::{Gearbox, auto};
use pinwheel_scene::bearings::BearingLaw;
use pinwheel_scene::keys::{self, longest_first};
use pinwheel_scene::quantity::{in_units, short};
use pinwheel_scene::{
    CheckedScene, Formulation, Override, Scene, SceneError, edited, preset, scales,
};
use pinwheel_timeseries::figure::Figure;
use serde_json::{Value, json};

use crate::control::compile;
use crate::design::Limits;
use crate::motion::Motion;
use crate::rng::Rng;
use crate::sampling::hypercube;
use crate::sweep::tolerance::clopper_pearson;
use crate::{Control, StudyError, band, design};

/// Key with a slider.
struct Slider {
    key: &'static str,
    label: &'static str,
    /// Unit of the slider, and its number in one unit of the key.
    unit: (&'static str, f64),
    /// Ends as shares of the scene's value.
    shares: [f64; 2],
    /// Ends in the slider's unit, for a scene's value of 0.
    ends: [f64; 2],
}

const MM: (&str, f64) = ("mm", 1e3);
const UM: (&str, f64) = ("\u{b5}m", 1e6);
const N_UM: (&str, f64) = ("N/\u{b5}m", 1e-6);
const RPM: (&str, f64) = ("rpm", 30.0 / PI);
/// Unit of a number of parts.
const COUNT: (&str, f64) = ("", 1.0);

macro_rules! sliders {
    ($($key:tt, $label:literal, $unit:expr, $shares:expr, $ends:expr;)*) => {
        const SLIDERS: &[Slider] = &[
            $(Slider { key: $key, label: $label, unit: $unit, shares: $shares, ends: $ends },)*
        ];
    };
}

sliders! {
    "gear.eccentricity_m", "Eccentricity", MM, [0.5, 1.5], [0.1, 5.0];
    "gear.external_sleeve_radius_m", "Pin radius", MM, [0.4, 1.8], [0.5, 20.0];
    "gear.backlash_m", "Backlash", UM, [0.0, 3.0], [0.0, 300.0];
    "gear.modification.equidistant_m", "Profile cut by", UM, [0.0, 4.0], [0.0, 50.0];
    "gear.modification.radial_m", "Generating circle larger by", UM, [0.0, 4.0], [-50.0, 50.0];
    "drive.output_torque_n_m", "Load", ("N m", 1.0), [0.1, 2.0], [0.0, 100.0];
    "drive.input_speed_rad_s", "Input speed", RPM, [0.2, 2.0], [10.0, 3000.0];
    "cranks.circle_radius_m", "Circle of the cranks", MM, [0.7, 1.3], [10.0, 100.0];
    "cranks.support_stiffness_n_m", "Stiffness of a crank's support", N_UM, [0.1, 4.0], [100.0, 2000.0];
    CLEARANCE, "Eccentric bearing's clearance", UM, [0.0, 4.0], [0.0, 20.0];
    "gear.hole_radius_m", "Hole radius", MM, [1.0, 1.02], [1.0, 50.0];
    FACE_WIDTH, "Face width", MM, [0.4, 2.0], [1.0, 50.0];
    "gear.external_sleeves", "Ring pins", COUNT, [0.6, 1.4], [3.0, 60.0];
    "gear.internal_sleeves", "Output pins", COUNT, [0.5, 1.5], [2.0, 20.0];
    "gear.wheels", "Discs", COUNT, [0.5, 2.0], [1.0, 4.0];
    "contact.friction_coefficient", "Friction", ("\u{b5}", 1.0), [0.0, 3.0], [0.0, 0.15];
}
const FACE_WIDTH: &str = "gear.face_width_m";
const CLEARANCE: &str = "bearings.eccentric.clearance_m";
/// Stiffness of the eccentric bearing. Its slider counts decades and ends at a rigid bearing, for which the key is absent.
const STIFFNESS: &str = "bearings.eccentric.stiffness_n_m";
/// Table of that bearing, and the keys that a stated stiffness replaces.
const BEARING: &str = "bearings.eccentric";
const ROLLERS: [&str; 2] = [
    "bearings.eccentric.rollers",
    "bearings.eccentric.roller_length_m",
];
const EXPONENT: &str = "bearings.eccentric.exponent";
/// Text for the stiffness of a rigid bearing.
pub const RIGID: &str = "rigid";
/// Ends of the stiffness slider, N/m.
const STIFFNESSES: [f64; 2] = [1e7, 1e10];
/// Key with a choice instead of a slider.
const LAW: &str = "contact.law";
/// Target error of the forces for the planned method, and factor on its step. Measured on five gears, with and without
/// play: forces are off by up to 4e-4 of the largest, the driver's torque by 4e-3 on bearings and 4e-4 without.
const ERROR: f64 = 0.1;
const STRIDE: f64 = 2.0;
/// Number of samples of a state.
const SAMPLES: f64 = 120.0;
/// Override that starts in static balance, so that a state has no start-up.
const START: &str = "drive.start=equilibrium";

/// Values of a state: keys with the sliders' values, in the form of `--set`.
pub type Values = [(String, String)];

/// Returns the scene of a state.
///
/// # Errors
/// The reason for an invalid scene, with the keys.
pub fn scene(spec: &str, sets: &[Override], values: &Values) -> Result<CheckedScene, String> {
    let mut all = sets.to_vec();
    for (key, value) in values {
        let known = SLIDERS.iter().any(|slider| slider.key == key) || key == LAW;
        if known && key != CLEARANCE {
            let set = format!("{key}={value}").parse::<Override>();
            all.push(set.map_err(|error| error.to_string())?);
        }
    }
    let scene = Scene::load(spec, &all).map_err(|error| match error {
        SceneError::Key {
            key, what, remedy, ..
        } if !values.is_empty() => in_words(&key, &what, &remedy),
        error => error.to_string(),
    })?;
    let value = |key: &str| values.iter().find(|(of, _)| of == key);
    if value(STIFFNESS).is_none() && value(CLEARANCE).is_none() {
        return Ok(scene);
    }
    let mut changed = Scene::clone(&scene);
    let bearing = &mut changed.bearings.eccentric;
    match value(STIFFNESS).map(|(_, value)| value.as_str()) {
        None => {}
        Some(RIGID) => *bearing = None,
        Some(value) => {
            let exponent = BearingLaw::of(&scene).map(|law| law.exponent);
            let bearing = bearing.get_or_insert_default();
            // A stated stiffness replaces the rollers; their exponent stays.
            (bearing.rollers, bearing.roller_length_m) = (None, None);
            bearing.exponent = exponent.filter(|p| *p != 1.0);
            bearing.stiffness_n_m = Some(value.parse().unwrap_or(f64::NAN));
        }
    }
    if let Some((_, value)) = value(CLEARANCE) {
        let clearance = value.parse().unwrap_or(f64::NAN);
        bearing.get_or_insert_default().clearance_m = Some(clearance);
    }
    changed.check().map_err(|fault| {
        let key = fault.keys.first().map_or("scene", AsRef::as_ref);
        in_words(key, &fault.what, &fault.remedy)
    })
}

/// Returns the words of a key, with the unit in which it is shown and its number in one unit of the key.
fn spoken(key: &str) -> (String, (&'static str, f64)) {
    if let Some(slider) = SLIDERS.iter().find(|slider| slider.key == key) {
        return (slider.label.to_lowercase(), slider.unit);
    }
    let Some(row) = keys::key(key) else {
        return (key.to_owned(), COUNT);
    };
    let shown = UNITS.iter().find(|(unit, _)| *unit == row.unit());
    let shown = shown.map_or((row.unit(), 1.0), |(_, shown)| *shown);
    (row.words(), shown)
}

/// Units of scenes with those shown instead.
const UNITS: [(&str, (&str, f64)); 4] = [
    ("m", MM),
    ("rad/s", RPM),
    ("N/m", N_UM),
    ("Pa", ("MPa", 1e-6)),
];

/// Returns a fault in the words and units of the page: keys are words, and numbers with a unit of a scene are in the unit that is
/// shown, lengths in that of the key at fault.
fn in_words(key: &str, what: &str, remedy: &str) -> String {
    let own = spoken(key);
    let mut units = UNITS;
    if own.1 == UM {
        units[0].1 = UM;
    }
    // The hint of a key is in the scene's unit.
    let hint = keys::key(key).filter(|row| !row.unit().is_empty() && row.hint == remedy);
    let remedy = hint.map_or_else(|| format!("; {remedy}"), |_| String::new());
    let text = format!("{} {what}{remedy}", own.0);
    let text = longest_first().fold(text, |text, row| {
        let key = row.name;
        let (label, (unit, factor)) = spoken(key);
        let text = text.replace(&format!("`{key}`"), key);
        let text = match text.split_once(&format!("{key} = ")) {
            Some((head, tail)) => {
                let (value, rest) = tail.split_at(tail.find([',', ';', ' ']).unwrap_or(tail.len()));
                let value = value
                    .parse()
                    .map_or(value.to_owned(), |value: f64| short(factor * value));
                let value = format!("{value} {unit}");
                format!("{head}{label} = {}{rest}", value.trim_end())
            }
            None => text,
        };
        text.replace(key, &label)
    });
    let text = in_units(&text, &units);
    let (first, rest) = text.split_at(text.chars().next().map_or(0, char::len_utf8));
    first.to_uppercase() + rest
}

/// Returns name and scene file of a state, for the working folder. The file is the user's with the keys of `sets` and the moved
/// keys changed, or one with a preset (or a file of JSON) as its base. Reading it gives the displayed scene.
///
/// # Errors
/// A state without a valid scene or file.
pub fn file(spec: &str, sets: &[Override], values: &Values) -> Result<(String, String), String> {
    let shown = scene(spec, sets, values)?;
    let (mut moved, mut removed) = (sets.to_vec(), Vec::new());
    for (key, value) in values {
        match (key.as_str(), value.as_str()) {
            (STIFFNESS, RIGID) => removed = vec![BEARING],
            (STIFFNESS, _) => {
                removed = ROLLERS.to_vec();
                let bearing = shown.bearings.eccentric.as_ref();
                match bearing.and_then(|own| own.exponent) {
                    Some(exponent) => moved.push(Override::new(EXPONENT, exponent.to_string())),
                    None => removed.push(EXPONENT),
                }
                moved.push(Override::new(key, value));
            }
            (LAW, _) => moved.push(Override::new(key, value)),
            _ if SLIDERS.iter().any(|slider| slider.key == key) => {
                moved.push(Override::new(key, value));
            }
            _ => {}
        }
    }
    let on_base = format!("base = {}\n", json!(spec));
    let texts = match preset(spec) {
        // A key of a base can be changed but not removed.
        Some(text) => [on_base, text.to_owned()],
        None => [
            std::fs::read_to_string(spec).map_err(|error| format!("{spec}: {error}"))?,
            on_base,
        ],
    };
    let beside = Path::new(spec).parent().unwrap_or(Path::new(""));
    for (text, beside) in texts.iter().zip([beside, Path::new("")]) {
        let Some(text) = edited(text, &moved, &removed, beside) else {
            continue;
        };
        let read = Scene::from_toml(&text, "explored.toml", &[]).map(CheckedScene::into_scene);
        let same = |mut read: Scene| {
            read.name.clone_from(&shown.name);
            read.description.clone_from(&shown.description);
            read == *shown
        };
        if read.is_ok_and(same) {
            return Ok((shown.name.clone(), text));
        }
    }
    Err(format!(
        "not saved: `{BEARING}` stands in the base of {spec}, and a file on it cannot take that away; write the base's keys into \
         {spec}, or give the bearing a stiffness"
    ))
}

/// Returns the duration of a state, s: an input turn of the unchanged scene, equal for both states.
pub fn span_s(scene: &Scene) -> f64 {
    (TAU / scene.drive.input_speed_rad_s.abs().max(1e-9)).min(scene.solver.duration_s)
}

/// Returns the gear of a state for display.
///
/// # Errors
/// The reason for an invalid scene, with the keys.
pub fn gearbox(spec: &str, sets: &[Override], values: &Values) -> Result<Gearbox, String> {
    quick(&scene(spec, sets, values)?)
}

/// Returns the gear of a scene for quick runs. The depth of its discs is stated, because otherwise every evaluation computes
/// the wall. Errors of its method are invisible in a chart. Steps are long, because a start in balance excites little
/// vibration.
///
/// # Errors
/// The reason for an invalid scene, with the keys.
pub fn quick(scene: &CheckedScene) -> Result<Gearbox, String> {
    let mut stated = Scene::clone(scene);
    scales::state_depth(&mut stated);
    stated.solver.formulation = Formulation::Reduced;
    let plan = auto::plan(&stated, ERROR);
    plan.integrator.clone_into(&mut stated.solver.integrator);
    stated.solver.tolerance = plan.tolerance;
    stated.solver.step_s = (STRIDE * plan.step_s).min(stated.solver.duration_s);
    let stated = stated.check().unwrap_or_else(|_| scene.clone());
    Gearbox::new(&stated).map_err(|error| error.to_string())
}

/// Computes the motion of a state by a run; `None` if the run diverges at once.
///
/// # Errors
/// Stopped by `control`, to which the run reports.
pub fn motion(
    gearbox: &Gearbox,
    span_s: f64,
    control: &Control<'_>,
) -> Result<Option<Motion>, Cancelled> {
    let (span, step) = ((0.0, span_s), span_s / SAMPLES);
    Motion::over(gearbox, "", span, step, control)
}

/// Returns the figures of a state's balances; with `laws` also their bands and limits, which take longer.
///
/// # Errors
/// A gear without load or balance; `cancel` was set.
pub fn figures(
    gearbox: &Gearbox,
    laws: bool,
    cancel: &AtomicBool,
) -> Result<(Vec<Figure>, Option<Limits>), StudyError> {
    let mut figures = design::few_figures(gearbox, cancel)?;
    if !laws {
        return Ok((figures, None));
    }
    let bands = band::of(gearbox, &Control::silent(cancel))?;
    if let Some(bands) = &bands {
        bands.bound_all(&mut figures);
    }
    let limits = Limits::of_gear(gearbox, bands.as_ref(), cancel)?;
    Ok((figures, limits))
}

/// Gears of the sample of tolerances.
pub const GEARS: usize = 40;
const SEED: u64 = 1;

/// Returns the share of gears that can be assembled and bear their load, as far as that is judged, and the ends of its interval
/// of 95 % confidence. The gears are a fixed sample, uniform within the tolerances of a scene (`[uncertain]`). `None` without
/// tolerances or limits.
///
/// # Errors
/// Cancelled.
pub fn sample(gearbox: &Gearbox, cancel: &AtomicBool) -> Result<Option<[f64; 3]>, StudyError> {
    let scene = &gearbox.scene;
    let intervals = band::intervals(scene);
    let own = Limits::of_gear(gearbox, None, cancel)?;
    if intervals.is_empty() || own.is_none_or(|own| own.margin.is_none()) {
        return Ok(None);
    }
    let mut rng = Rng::new(SEED);
    let places: Vec<Vec<f64>> = intervals
        .iter()
        .map(|_| hypercube(&mut rng, GEARS))
        .collect();
    let mut kept = 0;
    for number in 0..GEARS {
        let mut moved = intervals.iter().zip(&places);
        let gear = moved.try_fold(scene.clone(), |gear, ((key, value, half), places)| {
            gear.with_number(key, value + (2.0 * places[number] - 1.0) * half)
        });
        if let Some(gear) = gear.ok().and_then(|gear| compile(&gear).ok()) {
            let limits = Limits::of_gear(&gear, None, cancel)?;
            let margin = limits.and_then(|limits| limits.margin);
            kept += usize::from(margin.is_some_and(|margin| margin >= 1.0));
        }
    }
    let [low, high] = clopper_pearson(kept, GEARS);
    Ok(Some([kept as f64 / GEARS as f64, low, high]))
}

/// Returns the overrides of a state: a start in balance, if its load is constant.
pub fn settled(spec: &str, sets: &[Override]) -> Vec<Override> {
    let mut settled = sets.to_vec();
    let start = START.parse::<Override>();
    settled.extend(start.ok().filter(|start| {
        let tried = [sets, std::slice::from_ref(start)].concat();
        Scene::load(spec, &tried).is_ok()
    }));
    settled
}

/// Returns the sliders of a scene for the page's script.
pub fn sliders(scene: &Scene) -> Vec<Value> {
    let keys = scene.to_json();
    // Sliders of the cranks exist only for an RV gear, whose cranks are its output pins.
    let there = |one: &&Slider| match one.key {
        "gear.internal_sleeves" => scene.cranks.is_none(),
        key => !key.starts_with("cranks.") || scene.cranks.is_some(),
    };
    let list = SLIDERS.iter().filter(there).map(|one| {
        let path = format!("/{}", one.key.replace('.', "/"));
        let (unit, factor) = one.unit;
        let line_m = (one.key == FACE_WIDTH).then_some(scene.contact.line_length_m);
        let value = keys.pointer(&path).and_then(Value::as_f64).or(line_m);
        let value = value.unwrap_or(0.0) * factor;
        let mut ends = match value {
            0.0 => one.ends,
            value if value < 0.0 => [one.shares[1] * value, one.shares[0] * value],
            value => one.shares.map(|share| share * value),
        };
        let is_whole = unit == COUNT.0;
        if is_whole {
            ends = ends.map(f64::ceil);
        }
        json!({
            "key": one.key, "label": one.label, "unit": unit, "factor": factor, "value": value, "from": ends[0], "to": ends[1],
            "whole": is_whole,
        })
    });
    let mut list: Vec<Value> = list.collect();
    let bearing = BearingLaw::of(scene);
    let (unit, factor) = match bearing.map_or(1.0, |law| law.exponent) {
        1.0 => (N_UM.0.to_owned(), N_UM.1),
        exponent => (format!("N/m^{exponent:.3}"), 1.0),
    };
    let value = bearing.map(|law| factor * law.stiffness);
    let [from, to] = STIFFNESSES.map(|stiffness| (factor * stiffness).log10());
    let [from, to] = value.map_or([from, to], |own| {
        [from.min(own.log10()), to.max(own.log10() + 1.0)]
    });
    let value = value.map_or_else(|| json!(RIGID), |own| json!(own));
    // The stiffness comes before the clearance.
    let place = list.iter().position(|one| one["key"] == CLEARANCE);
    list.insert(place.unwrap_or_default(), json!({
        "key": STIFFNESS, "label": "Eccentric bearing's stiffness", "unit": unit, "factor": factor, "value": value, "from": from,
        "to": to, "decades": true,
    }));
    list
}
