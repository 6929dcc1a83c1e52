//! Figures of a gear under other contact laws, and with a fit: by statics.
//!
//! Several laws may be right for rollers of a pair of materials, and nothing here tells which is. So the same balances are
//! made under each of them, at the same few poses. The envelope of what comes out is the band of a figure: an interval, not a
//! distribution, and never added to the numerical uncertainty. It is a spread of models; data that would validate one of them
//! are not known.
//!
//! | materials | laws |
//! |---|---|
//! | steel on steel | `line-hertz` with a third, the whole and three times the disc's depth; `line-contact` (Palmgren), `kunert`, `lundberg` |
//! | others | `line-hertz` with these depths |
//!
//! `contact.band_laws` names others.
//!
//! A profile that is cut all round for play moves forces more than all of these, so two such cuts are told beside them.

use std::sync::atomic::AtomicBool;

use pinwheel_contact::Material;
use pinwheel_gearbox::Gearbox;
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{OutputPart, Scene, scales};
use pinwheel_timeseries::columns;
use pinwheel_timeseries::figure::definitions::{EXTERNAL_FORCE, INTERNAL_FORCE};
use pinwheel_timeseries::figure::{Figure, FigureDef};
use serde::Serialize;

use crate::balances::solve::{few_figures, few_figures_by};
use crate::control::{compile, of_scene};
use crate::{Control, Progress, StudyError};

/// Depths of the disc, of the scene's own.
const DEPTHS: [f64; 3] = [1.0 / 3.0, 1.0, 3.0];
/// Cuts of the profile, m.
const CUTS: [f64; 2] = [5e-6, 10e-6];
/// The law of rollers of any materials.
pub const ROLLERS: &str = "line-hertz";
/// Laws that others take for steel rollers.
const STEEL_ROLLERS: [&str; 3] = ["line-contact", "kunert", "lundberg"];
/// By how much a figure may lie outside of its band and be called inside: rounding of balances.
const ROUNDING: f64 = 1e-6;

/// See the module.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bands {
    /// Names and settings of the laws compared.
    pub laws: Vec<String>,
    /// The scene's law.
    pub own: String,
    /// Figures under the scene's own law with their bands, at the few poses that laws are compared at.
    pub figures: Vec<Figure>,
    /// Figures with a profile cut all round.
    pub fits: Vec<Fit>,
}

/// A profile cut all round beyond the scene's.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Fit {
    /// By how much, m.
    pub cut_m: f64,
    /// Figures with the cut, at the same poses.
    pub figures: Vec<Figure>,
}

/// Ends of a band over the figure under the scene's own law.
fn shares(figure: &Figure) -> Option<[f64; 2]> {
    let own = figure.value?;
    Some(figure.by_contact_law?.map(|end| end / own))
}

impl Bands {
    /// The figure of that definition under the scene's own law.
    #[must_use]
    pub fn get(&self, def: &FigureDef) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.is(def))
    }

    /// Least and largest of a figure of that definition that is `value` under the scene's own law.
    #[must_use]
    pub fn around(&self, def: &FigureDef, value: impl Into<Option<f64>>) -> Option<[f64; 2]> {
        let value = value.into()?;
        Some(shares(self.get(def)?)?.map(|share| share * value))
    }

    /// Least and largest of a load of runs over all channels of a quantity that is `value` under the scene's own law.
    #[must_use]
    pub fn around_load(&self, quantity: &str, value: f64) -> Option<[f64; 2]> {
        match quantity {
            columns::EXTERNAL_FORCE => self.around(&EXTERNAL_FORCE, value),
            columns::INTERNAL_FORCE => self.around(&INTERNAL_FORCE, value),
            _ => None,
        }
    }

    /// True if the scene's own law gives figures within the bands.
    #[must_use]
    pub fn holds_own(&self) -> bool {
        let holds = |[low, high]: [f64; 2]| low <= 1.0 + ROUNDING && high >= 1.0 - ROUNDING;
        self.figures.iter().filter_map(shares).all(holds)
    }

    /// Values of a figure by each cut, m.
    #[must_use]
    pub fn fitted(&self, def: &FigureDef) -> Vec<(f64, f64)> {
        let of = |fit: &Fit| {
            let figure = fit.figures.iter().find(|figure| figure.is(def))?;
            Some((fit.cut_m, figure.value?))
        };
        self.fits.iter().filter_map(of).collect()
    }
}

/// Steel by its constants.
fn is_steel(material: Material) -> bool {
    (1.9e11..=2.2e11).contains(&material.young) && (0.26..=0.32).contains(&material.poisson)
}

/// The laws that may be right for a scene's rollers, which it may name itself: a label, and the scene with each.
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
    let mut found = Vec::new();
    for law in named {
        if law != ROLLERS {
            found.push((law.to_owned(), with(law, &|_| ())));
            continue;
        }
        // How deep a disc is behind a contact is the law's own doubt.
        found.extend(DEPTHS.iter().map(|share| {
            let depth = share * parameters.disc_depth;
            let label = format!("{ROLLERS}, disc {:.1} mm deep", 1e3 * depth);
            let set = |scene: &mut Scene| scene.contact.disc_depth_m = Some(depth);
            (label, with(ROLLERS, &set))
        }));
    }
    found
}

/// Figures of a scene; `None` where it cannot be balanced.
fn figures(scene: &Scene, cancel: &AtomicBool) -> Result<Option<Vec<Figure>>, StudyError> {
    balanced(compile(scene).and_then(|gearbox| few_figures(&gearbox, cancel)))
}

/// Returns `None` for what cannot be balanced.
fn balanced<T>(found: Result<T, StudyError>) -> Result<Option<T>, StudyError> {
    match found {
        Ok(found) => Ok(Some(found)),
        Err(StudyError::Cancelled) => Err(StudyError::Cancelled),
        Err(_) => Ok(None),
    }
}

/// Why a scene asks for no band: it names no law, or its contacts were made softer or stiffer than their material and it names none.
#[must_use]
pub fn declined(scene: &Scene) -> Option<&'static str> {
    match scene.contact.band_laws.as_deref() {
        _ if scene.drive.output == OutputPart::Ring => Some("drive.output is \"ring\""),
        Some([]) => Some("contact.band_laws is empty"),
        None if scene.contact.stiffness_multiplier != 1.0 => {
            Some("contact.stiffness_multiplier is not 1")
        }
        _ => None,
    }
}

/// The bands of a gear's figures under its largest load; `None` of a gear without load, of one that asks for none ([`declined`]), or
/// that cannot be balanced.
///
/// # Errors
/// Cancelled.
pub fn of(gearbox: &Gearbox, control: &Control<'_>) -> Result<Option<Bands>, StudyError> {
    if declined(&gearbox.scene).is_some() {
        return Ok(None);
    }
    let statics = Statics::new(gearbox).map_err(|source| of_scene(&gearbox.scene, source))?;
    of_known(statics, control)
}

/// [`of`] a gear some of whose balances a solver may know.
pub(crate) fn of_known(
    mut known: Statics<'_>,
    control: &Control<'_>,
) -> Result<Option<Bands>, StudyError> {
    let scene: &Scene = &known.gearbox().scene;
    if declined(scene).is_some() {
        return Ok(None);
    }
    let Some(mut own) = balanced(few_figures_by(&mut known, control.cancel))? else {
        return Ok(None);
    };
    let mut names = Vec::new();
    let laws = laws(scene);
    let total = laws.len() + CUTS.len();
    let report = |done, what: &str| (control.progress)(Progress::new(done, total, what));
    for (done, (label, scene)) in laws.into_iter().enumerate() {
        control.check()?;
        report(done, &format!("under {label}"));
        let Some(found) = figures(&scene, control.cancel)? else {
            continue;
        };
        names.push(label);
        for (own, one) in own.iter_mut().zip(&found) {
            // A figure that is 0 has no share.
            let Some(value) = one
                .value
                .filter(|_| own.value.is_some_and(|own| own != 0.0))
            else {
                continue;
            };
            let [low, high] = own.by_contact_law.unwrap_or([value; 2]);
            own.by_contact_law = Some([low.min(value), high.max(value)]);
        }
    }
    let mut fits = Vec::new();
    for cut_m in CUTS {
        control.check()?;
        report(names.len(), "cut for play");
        let mut cut = scene.clone();
        cut.gear.modification.equidistant_m += cut_m;
        if let Some(figures) = figures(&cut, control.cancel)? {
            fits.push(Fit { cut_m, figures });
        }
    }
    own.retain(|figure| figure.by_contact_law.is_some());
    Ok(Some(Bands {
        laws: names,
        own: scene.contact.law.clone(),
        figures: own,
        fits,
    }))
}
