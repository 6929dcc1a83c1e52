//! Bands of other contact laws, as text and as a table.

use crate::figure::{interval, rounded};
use crate::format::{joined, significant};
use crate::study::Block;
use pinwheel_contact::laws::law_info;
use pinwheel_studies::band::{Bands, Fits, ROLLERS};
use pinwheel_timeseries::figure::{FigureDef, definitions as defs};
use pinwheel_timeseries::table::Table;

/// Figures of the table of bands.
static TOLD: [&FigureDef; 4] = [
    &defs::EXTERNAL_FORCE,
    &defs::INTERNAL_FORCE,
    &defs::STIFFNESS,
    &defs::LOST_MOTION,
];

/// Returns a sentence with the remedy if the figures of the scene's law are outside of the bands.
pub(crate) fn outside(bands: &Bands) -> Option<String> {
    if bands.holds_own() {
        return None;
    }
    let of = law_info(&bands.own).map_or("", |law| law.shape.words());
    Some(format!(
        "{} ({of}) lies outside of the band for these rollers: --set contact.law={ROLLERS}, or say why not",
        bands.own
    ))
}

/// Returns a sentence on the laws of the bands.
pub(crate) fn about(bands: &Bands) -> String {
    if let Some(why) = bands.declined {
        return format!("no band: {why}");
    }
    if bands.laws.is_empty() {
        return format!("no band: {ROLLERS} carries this load in no position of the gear");
    }
    format!(
        "least and largest by {}; a spread of models, not validated by measurement",
        bands.laws.join("; ")
    )
}

/// Returns a sentence on the varied sizes and the number of gears behind the intervals by fit.
fn tried(fits: &Fits) -> String {
    format!(
        "{} toleranced sizes (`[uncertain]`), each alone at both ends and all together where that moves lost motion, stiffness or a force most: \
         {} gears; between these ends a figure may go further; the wider of both intervals leads, and stands first",
        fits.keys.len(),
        fits.gears
    )
}

/// Returns sentences on the size with the largest effect, for lost motion and for stiffness.
fn tighten(fits: &Fits) -> Vec<String> {
    let sentence = |def: &&FigureDef| {
        let first = fits.first(def)?;
        let [least, largest] = first.values(def)?.map(|value| significant(value, 3));
        let FigureDef { label, unit, .. } = def;
        let (key, half) = (&first.key, significant(first.plus_minus, 2));
        Some(format!(
            "{key} +- {half}: alone it moves the {label} from {least} to {largest} {unit}"
        ))
    };
    let figures = [&defs::LOST_MOTION, &defs::STIFFNESS];
    figures.iter().filter_map(sentence).collect()
}

/// Returns the effect of fits on the largest external force: of toleranced sizes, or of profile cuts.
pub(crate) fn fit(bands: &Bands) -> Option<String> {
    if let Some(fits) = &bands.tolerances {
        let figure = bands.get(&defs::EXTERNAL_FORCE)?;
        let [label, unit] = [&figure.def.label, &figure.def.unit];
        return Some(format!(
            "{label} {} {unit} by fit: {}",
            interval(figure.by_fit?),
            tried(fits)
        ));
    }
    let FigureDef { label, unit, .. } = &defs::EXTERNAL_FORCE;
    let fitted = bands.fitted(&defs::EXTERNAL_FORCE).into_iter();
    let cut = |(cut, value)| format!("{:.0} \u{b5}m: {} {unit}", 1e6 * cut, significant(value, 3));
    let forces = joined(", by ", fitted.map(cut));
    (!forces.is_empty()).then(|| format!("{label}; profile cut by {forces}"))
}

/// Label for a scene's law outside of the bands.
pub(crate) const OUTSIDE: &str = "law";

/// Returns rows for a terminal.
pub(crate) fn rows(bands: &Bands) -> Vec<(&'static str, String)> {
    let mut rows = vec![("by contact law", about(bands))];
    rows.extend(outside(bands).map(|text| (OUTSIDE, text)));
    let Some(fits) = &bands.tolerances else {
        rows.extend(fit(bands).map(|text| ("fit", text)));
        return rows;
    };
    rows.push(("by fit", tried(fits)));
    let first = tighten(fits).into_iter();
    rows.extend(first.map(|text| ("tighten this first", text)));
    let refused = fits.refused.iter();
    let refused = refused.map(|text| format!("cannot be assembled or balanced: {text}"));
    rows.extend(refused.map(|text| ("no gear", text)));
    rows
}

/// Returns blocks for a page.
pub(crate) fn blocks(bands: &Bands) -> Vec<Block> {
    let rows = TOLD.into_iter().filter_map(|def| bands.get(def));
    let rows = rows.filter_map(|one| Some((one, one.value?, one.by_contact_law?)));
    let fits = bands.tolerances.as_ref().map(tolerances);
    let mut table = Table::of(format!("By contact law, statics: {}", about(bands)), rows)
        .text("", "Figure", |(one, ..)| &*one.def.label)
        .text("", "Unit", |(one, ..)| &*one.def.unit)
        .text("", &bands.own, |(_, own, band)| rounded(*own, *band))
        .text("", "Band", |(.., band)| interval(*band));
    for (place, fit) in bands.fits.iter().enumerate() {
        let cut = format!("cut by {:.0} \u{b5}m", 1e6 * fit.cut_m);
        table = table.text("", &cut, |(one, ..)| {
            let fitted = bands.fitted(&one.def).into_iter().nth(place);
            fitted.map_or_else(String::new, |(_, value)| significant(value, 3))
        });
    }
    let text = outside(bands).map(Block::Text);
    let table = bands.declined.is_none().then(|| table.done().into());
    let tables = table.into_iter().chain(fits);
    text.into_iter().chain(tables).collect()
}

/// Returns a table of the effect of each toleranced size alone.
fn tolerances(fits: &Fits) -> Block {
    let caption = format!("By fit, statics: {}", tried(fits));
    let mut table = Table::of(caption, &fits.keys)
        .text("", "Toleranced", |key| key.key.clone())
        .text("", "+-", |key| significant(key.plus_minus, 2));
    for def in TOLD {
        if fits.first(def).is_some() {
            let name = format!("{}, {}", def.label, def.unit);
            table = table.text("", &name, |key| {
                let ends = key
                    .values(def)
                    .map(|ends| ends.map(|end| significant(end, 3)));
                ends.map_or_else(String::new, |ends| ends.join(" to "))
            });
        }
    }
    table.done().into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_law_is_no_band() {
        let none = Bands {
            laws: Vec::new(),
            declined: None,
            own: "paper".to_owned(),
            figures: Vec::new(),
            fits: Vec::new(),
            tolerances: None,
        };
        assert!(about(&none).starts_with("no band: line-hertz "));
    }
}
