//! Figures of a gear under other contact laws, and with a fit, by statics.
//!
//! Several laws may be right for rollers of a pair of materials, and no published data validate one of them. The same balances are
//! therefore solved under each law, at the same few poses and without friction. The envelope of the results is the band of a
//! figure. The band is a spread of models: an interval, not a distribution, and never added to the numerical uncertainty.
//!
//! | materials | laws |
//! |---|---|
//! | steel on steel | `line-hertz` with a third, one and three times the disc's depth; `line-contact` (Palmgren), `kunert`, `lundberg` |
//! | others | `line-hertz` with these depths |
//!
//! `contact.band_laws` selects others.
//!
//! A uniform profile cut for play changes forces more than all of these, so two cuts are also computed. A gear with stated
//! fits (`[uncertain]`) has an interval *by fit* instead: balances with each toleranced key alone at either end, and with
//! all of them at the ends that together raise or lower one of the `LEADING` figures. Values between the ends may exceed
//! the interval. Ends without a valid gear are listed ([`Fits::refused`]).

use std::sync::atomic::AtomicBool;

use pinwheel_contact::Material;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{CheckedScene, Scene, scales};
use pinwheel_timeseries::columns;
use pinwheel_timeseries::figure::definitions::{
    CRANK_FORCE, EXTERNAL_FORCE, INTERNAL_FORCE, LOST_MOTION, STIFFNESS,
};
use pinwheel_timeseries::figure::{Figure, FigureDef};
use serde::Serialize;

use crate::balances::solve::few_figures_by;
use crate::control::{compile, of_scene};
use crate::{Control, Progress, StudyError};

/// Depths of the disc relative to the scene's.
const DEPTHS: [f64; 3] = [1.0 / 3.0, 1.0, 3.0];
/// Cuts of the profile, m.
const CUTS: [f64; 2] = [5e-6, 10e-6];
/// Law for rollers of any materials.
pub const ROLLERS: &str = "line-hertz";
/// Other common laws for steel rollers.
const STEEL_ROLLERS: [&str; 3] = ["line-contact", "kunert", "lundberg"];
/// Figures that select the combined ends of toleranced keys.
static LEADING: [&FigureDef; 5] = [
    &LOST_MOTION,
    &STIFFNESS,
    &EXTERNAL_FORCE,
    &INTERNAL_FORCE,
    &CRANK_FORCE,
];
/// Tolerance for a figure inside its band, relative: rounding of balances.
const ROUNDING: f64 = 1e-6;

/// Figures with their bands.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bands {
    /// Names and settings of the laws compared.
    pub laws: Vec<String>,
    /// Reason why the scene requires no laws ([`declined`]); its figures then have intervals by fit only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub declined: Option<&'static str>,
    /// The scene's law.
    pub own: String,
    /// Figures under the scene's law with their bands, at the few poses for the comparison of laws.
    pub figures: Vec<Figure>,
    /// Figures with a uniform profile cut; empty for a gear with toleranced keys.
    pub fits: Vec<Fit>,
    /// Results over the toleranced keys; `None` without any.
    pub tolerances: Option<Fits>,
}

/// Results over the toleranced keys of a scene.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Fits {
    /// Keys in the order of the scene.
    pub keys: Vec<Toleranced>,
    /// Number of balanced gears besides the scene's.
    pub gears: usize,
    /// Ends without a valid gear, each with its reason.
    pub refused: Vec<String>,
}

/// Toleranced key.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Toleranced {
    /// Name of the key.
    pub key: String,
    /// Half-width of its interval, in its unit.
    pub plus_minus: f64,
    /// Figures with this key alone at its least and at its largest; empty without a valid gear.
    pub ends: [Vec<Figure>; 2],
}

impl Toleranced {
    /// Returns the values of a figure with the key at its least and its largest.
    pub fn values(&self, def: &FigureDef) -> Option<[f64; 2]> {
        let value = |end: &Vec<Figure>| end.iter().find(|figure| figure.is(def))?.value;
        Some([value(&self.ends[0])?, value(&self.ends[1])?])
    }

    fn moves(&self, def: &FigureDef) -> f64 {
        self.values(def)
            .map_or(0.0, |[least, largest]| largest - least)
    }
}

impl Fits {
    /// Returns the key whose interval changes a figure most, if any.
    pub fn first(&self, def: &FigureDef) -> Option<&Toleranced> {
        let size = |key: &&Toleranced| key.moves(def).abs();
        let keys = self.keys.iter().filter(|key| size(key) > 0.0);
        keys.max_by(|a, b| size(a).total_cmp(&size(b)))
    }
}

/// Uniform profile cut beyond the scene's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// Depth of the cut, m.
    pub cut_m: f64,
    /// Figures with the cut, at the same poses.
    pub figures: Vec<Figure>,
}

/// Returns the ends of a band over the value of its figure.
fn shares(figure: &Figure, band: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let own = figure.value?;
    Some(band?.map(|end| end / own))
}

impl Bands {
    /// Returns the figure of a definition under the scene's law.
    pub fn get(&self, def: &FigureDef) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.is(def))
    }

    /// Sets the bands of a figure from the definition's figure, in proportion to its value.
    pub fn bound(&self, figure: &mut Figure, def: &FigureDef) {
        let Some((value, own)) = figure.value.zip(self.get(def)) else {
            return;
        };
        let scaled = |band| Some(shares(own, band)?.map(|share| share * value));
        figure.by_contact_law = scaled(own.by_contact_law);
        figure.by_fit = scaled(own.by_fit);
    }

    /// Sets the bands of every figure of statics, see [`bound`](Self::bound).
    pub fn bound_all(&self, figures: &mut [Figure]) {
        for figure in figures {
            let def = figure.def.clone();
            self.bound(figure, &def);
        }
    }

    /// Sets the bands of a load of runs over all channels of a quantity, see [`bound`](Self::bound).
    pub fn bound_load(&self, figure: &mut Figure, quantity: &str) {
        match quantity {
            columns::EXTERNAL_FORCE => self.bound(figure, &EXTERNAL_FORCE),
            columns::INTERNAL_FORCE => self.bound(figure, &INTERNAL_FORCE),
            _ => (),
        }
    }

    /// True if the figures under the scene's law are within their bands.
    pub fn holds_own(&self) -> bool {
        let holds = |[low, high]: [f64; 2]| low <= 1.0 + ROUNDING && high >= 1.0 - ROUNDING;
        let figures = self.figures.iter();
        let mut laws = figures.filter_map(|figure| shares(figure, figure.by_contact_law));
        laws.all(holds)
    }

    /// Returns cuts, m, and the values of a figure.
    pub fn fitted(&self, def: &FigureDef) -> Vec<(f64, f64)> {
        let of = |fit: &Fit| {
            let figure = fit.figures.iter().find(|figure| figure.is(def))?;
            Some((fit.cut_m, figure.value?))
        };
        self.fits.iter().filter_map(of).collect()
    }
}

/// True for the elastic constants of steel.
fn is_steel(material: Material) -> bool {
    (1.9e11..=2.2e11).contains(&material.young) && (0.26..=0.32).contains(&material.poisson)
}

/// Returns the laws that may apply to a scene's rollers, or the laws named by the scene: a label, and the scene with each.
fn laws(scene: &Scene) -> Vec<(String, Scene)> {
    let with = |law: &str, change: &dyn Fn(&mut Scene)| {
        let mut scene = scene.clone();
        law.clone_into(&mut scene.contact.law);
        change(&mut scene);
        scene
    };
    let rollers = with(ROLLERS, &|_| ());
    let parameters = scales::law_parameters(&rollers);
    let named = scene.contact.band_laws.as_deref();
    let named: Vec<&str> = named.map_or_else(
        || match is_steel(parameters.pin) && is_steel(parameters.disc) {
            true => [&[ROLLERS][..], &STEEL_ROLLERS].concat(),
            false => vec![ROLLERS],
        },
        |named| named.iter().map(String::as_str).collect(),
    );
    let mut scenes = Vec::new();
    for law in named {
        if law != ROLLERS {
            scenes.push((law.to_owned(), with(law, &|_| ())));
            continue;
        }
        // The depth of a disc behind a contact is the law's own uncertainty.
        scenes.extend(DEPTHS.iter().map(|share| {
            let depth = share * parameters.disc_depth;
            let label = format!("{ROLLERS}, disc {:.1} mm deep", 1e3 * depth);
            let set = |scene: &mut Scene| scene.contact.disc_depth_m = Some(depth);
            (label, with(ROLLERS, &set))
        }));
    }
    scenes
}

fn figures_of(scene: &Scene, cancel: &AtomicBool) -> Result<Vec<Figure>, StudyError> {
    let gearbox = compile(scene)?;
    let mut statics = Statics::new(&gearbox).map_err(|source| of_scene(scene, source))?;
    few_figures_by(&mut statics, false, cancel)
}

/// Returns the figures of a scene; `None` if it cannot be balanced.
fn figures(scene: &Scene, cancel: &AtomicBool) -> Result<Option<Vec<Figure>>, StudyError> {
    balanced(figures_of(scene, cancel))
}

/// Returns `None` for a gear without a balance.
pub(crate) fn balanced<T>(solved: Result<T, StudyError>) -> Result<Option<T>, StudyError> {
    match solved {
        Ok(solved) => Ok(Some(solved)),
        Err(StudyError::Cancelled) => Err(StudyError::Cancelled),
        Err(_) => Ok(None),
    }
}

/// Returns the reason why a scene gets no bands: it names no laws, or its contacts were made softer or stiffer without naming laws.
pub fn declined(scene: &Scene) -> Option<&'static str> {
    match scene.contact.band_laws.as_deref() {
        Some([]) => Some("contact.band_laws is empty"),
        None if scene.contact.stiffness_multiplier != 1.0 => {
            Some("contact.stiffness_multiplier is not 1")
        }
        _ => None,
    }
}

/// True if a scene requires no laws and has no fits that statics can compare.
fn is_alone(scene: &Scene) -> bool {
    declined(scene).is_some() && scene.uncertain.is_empty()
}

/// Returns the bands of a gear's figures under its largest load. `None` for a gear without load, without a balance, or without
/// toleranced keys and laws ([`declined`]).
///
/// # Errors
/// Cancelled.
pub fn of(gearbox: &Gearbox, control: &Control<'_>) -> Result<Option<Bands>, StudyError> {
    if is_alone(&gearbox.scene) {
        return Ok(None);
    }
    let statics = Statics::new(gearbox).map_err(|source| of_scene(&gearbox.scene, source))?;
    of_known(statics, control)
}

/// Computes the bands like [`of`], with a solver that may have stored balances.
pub(crate) fn of_known(
    mut known: Statics<'_>,
    control: &Control<'_>,
) -> Result<Option<Bands>, StudyError> {
    let scene: &Scene = &known.gearbox().scene;
    if is_alone(scene) {
        return Ok(None);
    }
    let Some(mut own) = balanced(few_figures_by(&mut known, false, control.cancel))? else {
        return Ok(None);
    };
    let mut names = Vec::new();
    let declined = declined(scene);
    let laws = declined.map_or_else(|| laws(scene), |_| Vec::new());
    let tolerances = over_fits(known.gearbox(), &mut own, control)?;
    let cuts = CUTS
        .iter()
        .filter(|_| declined.is_none() && tolerances.is_none());
    let total = laws.len() + cuts.clone().count();
    let report = |done, what: &str| (control.progress)(Progress::new(done, total, what));
    for (done, (label, scene)) in laws.into_iter().enumerate() {
        control.check()?;
        report(done, &format!("under {label}"));
        let Some(figures) = figures(&scene, control.cancel)? else {
            continue;
        };
        names.push(label);
        widen(&mut own, &figures, |figure| &mut figure.by_contact_law);
    }
    let mut fits = Vec::new();
    for &cut_m in cuts {
        control.check()?;
        report(names.len(), "cut for play");
        let mut cut = scene.clone();
        cut.gear.modification.equidistant_m += cut_m;
        if let Some(figures) = figures(&cut, control.cancel)? {
            fits.push(Fit { cut_m, figures });
        }
    }
    own.retain(|figure| figure.by_contact_law.or(figure.by_fit).is_some());
    Ok(Some(Bands {
        laws: names,
        declined,
        own: scene.contact.law.clone(),
        figures: own,
        fits,
        tolerances,
    }))
}

/// Extends a band of every figure to the value of the other gear.
fn widen(own: &mut [Figure], other: &[Figure], band: fn(&mut Figure) -> &mut Option<[f64; 2]>) {
    for (figure, other) in own.iter_mut().zip(other) {
        // A figure of 0 has no relative band.
        if let (true, Some(value)) = (figure.value.is_some_and(|own| own != 0.0), other.value) {
            let band = band(figure);
            let [low, high] = band.unwrap_or([value; 2]);
            *band = Some([low.min(value), high.max(value)]);
        }
    }
}

/// Returns the toleranced keys of a scene, each with its value and half of its interval.
pub(crate) fn intervals(scene: &CheckedScene) -> Vec<(&String, f64, f64)> {
    let all = scene.uncertain.iter();
    all.filter_map(|(key, half)| Some((key, scene.number(key)?, half.plus_minus)))
        .collect()
}

/// Solves balances over the toleranced keys of a gear, and extends the band by fit of its figures `own`.
fn over_fits(
    gearbox: &Gearbox,
    own: &mut [Figure],
    control: &Control<'_>,
) -> Result<Option<Fits>, StudyError> {
    let scene = &gearbox.scene;
    let intervals = intervals(scene);
    if intervals.is_empty() {
        return Ok(None);
    }
    let mut fits = Fits::default();
    for figure in own.iter_mut() {
        figure.by_fit = figure.value.map(|value| [value; 2]);
    }
    // Each key at its least (-1), largest (1) or nominal (0) value.
    let mut at = |ends: &[f64], fits: &mut Fits| -> Result<Vec<Figure>, StudyError> {
        control.check()?;
        (control.progress)(Progress::new(0, 1, "other fits"));
        let moved = intervals.iter().zip(ends).filter(|(_, end)| **end != 0.0);
        let moved: Vec<(&str, f64)> = moved
            .map(|((key, value, half), end)| (key.as_str(), value + end * half))
            .collect();
        let gear = moved.iter().try_fold(scene.clone(), |gear, (key, value)| {
            gear.with_number(key, *value)
        });
        let solved = gear.map_err(|fault| StudyError::Input(fault.to_string()));
        match solved.and_then(|gear| figures_of(&gear, control.cancel)) {
            Ok(solved) => {
                fits.gears += 1;
                widen(own, &solved, |figure| &mut figure.by_fit);
                Ok(solved)
            }
            Err(StudyError::Cancelled) => Err(StudyError::Cancelled),
            Err(why) => {
                let ends = moved
                    .iter()
                    .map(|(key, value)| format!("{key} = {value:.9}"));
                fits.refused
                    .push(format!("{}: {why}", ends.collect::<Vec<_>>().join(", ")));
                Ok(Vec::new())
            }
        }
    };
    for (place, (key, _, plus_minus)) in intervals.iter().enumerate() {
        let mut alone = |end: f64| {
            let mut ends = vec![0.0; intervals.len()];
            ends[place] = end;
            at(&ends, &mut fits)
        };
        let ends = [alone(-1.0)?, alone(1.0)?];
        let (key, plus_minus) = ((*key).clone(), *plus_minus);
        fits.keys.push(Toleranced {
            key,
            plus_minus,
            ends,
        });
    }
    let mut together: Vec<Vec<f64>> = Vec::new();
    for def in LEADING.into_iter().filter(|_| intervals.len() > 1) {
        if fits.first(def).is_none() {
            continue;
        }
        let up: Vec<f64> = fits
            .keys
            .iter()
            .map(|key| 1.0_f64.copysign(key.moves(def)))
            .collect();
        let down = up.iter().map(|end| -end).collect();
        for ends in [up, down] {
            if !together.contains(&ends) {
                at(&ends, &mut fits)?;
                together.push(ends);
            }
        }
    }
    Ok(Some(fits))
}
