//! Bands of other contact laws, in words and as a table.

use crate::format::{joined, significant};
use crate::study::Block;
use pinwheel_contact::laws::law_info;
use pinwheel_studies::band::{Band, Bands, ROLLERS};
use pinwheel_timeseries::columns;
use pinwheel_timeseries::table::Table;

use crate::pages::figure::{interval, rounded};

/// Figures of the table of bands: key, name, unit.
const TOLD: [(&str, &str, &str); 4] = [
    ("external_force_n", "largest pin force, external", "N"),
    ("internal_force_n", "largest pin force, internal", "N"),
    (
        "torsional_stiffness_n_m_per_arcmin",
        "stiffness of the contacts",
        "N m/arcmin",
    ),
    (
        "lost_motion_arcmin",
        "lost motion of the contacts",
        "arcmin",
    ),
];

/// Key of the band that bounds the peak of a quantity of runs.
pub(crate) fn key_of_peak(quantity: &str) -> Option<&'static str> {
    match quantity {
        columns::EXTERNAL_FORCE => Some("external_force_n"),
        columns::INTERNAL_FORCE => Some("internal_force_n"),
        _ => None,
    }
}

fn ends(band: &Band) -> [f64; 2] {
    band.of_own_law.map(|share| share * band.own)
}

/// Sentence on a scene whose own law lies outside of what is defensible, with the remedy.
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

/// Sentence on the laws from which the bands are.
pub(crate) fn about(bands: &Bands) -> String {
    if bands.laws.is_empty() {
        return format!("no band: {ROLLERS} carries this load in no position of the gear");
    }
    format!(
        "least and largest by {}; a spread of models, not validated by measurement",
        bands.laws.join("; ")
    )
}

/// Effect of cuts of the profile on the largest external force.
pub(crate) fn fit(bands: &Bands) -> Option<String> {
    let (key, name, unit) = TOLD[0];
    let own = bands.get(key)?.own;
    let fitted = bands.fitted(key, own).into_iter();
    let cut = |(cut, value)| format!("{:.0} \u{b5}m: {} {unit}", 1e6 * cut, significant(value, 3));
    let told = joined(", by ", fitted.map(cut));
    (!told.is_empty()).then(|| format!("{name}; profile cut by {told}"))
}

/// Label of a figure for which the scene's own law lies outside of the band.
pub(crate) const OUTSIDE: &str = "law";

/// Rows of a terminal.
pub(crate) fn rows(bands: &Bands) -> Vec<(&'static str, String)> {
    let mut rows = vec![("by contact law", about(bands))];
    rows.extend(outside(bands).map(|said| (OUTSIDE, said)));
    rows.extend(fit(bands).map(|said| ("fit", said)));
    rows
}

/// Blocks of a page.
pub(crate) fn blocks(bands: &Bands) -> Vec<Block> {
    let rows = TOLD.iter().filter_map(|row| Some((row, bands.get(row.0)?)));
    let fitted = |key: &str, own: f64, place: usize| {
        let found = bands.fitted(key, own);
        found
            .get(place)
            .map_or_else(String::new, |(_, value)| significant(*value, 3))
    };
    let mut table = Table::of(format!("By contact law, statics: {}", about(bands)), rows)
        .text("", "Figure", |((_, name, _), _)| *name)
        .text("", "Unit", |((.., unit), _)| *unit)
        .text("", &bands.own, |(_, band)| rounded(band.own, ends(band)))
        .text("", "Band", |(_, band)| interval(ends(band)));
    for (place, fit) in bands.fits.iter().enumerate() {
        let cut = format!("cut by {:.0} \u{b5}m", 1e6 * fit.cut_m);
        table = table.text("", &cut, move |((key, ..), band)| {
            fitted(key, band.own, place)
        });
    }
    let said = outside(bands).map(Block::Text);
    said.into_iter().chain([table.done().into()]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_law_is_no_band() {
        let none = Bands {
            laws: Vec::new(),
            own: "paper".to_owned(),
            figures: Vec::new(),
            fits: Vec::new(),
        };
        assert!(about(&none).starts_with("no band: line-hertz "));
    }
}
