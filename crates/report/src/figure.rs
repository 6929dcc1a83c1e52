//! Figures as text, with significant digits and bounds. A bound is the numerical uncertainty, or the band of contact laws
//! that may apply.

use pinwheel_timeseries::figure::definitions::DIGITS;
use pinwheel_timeseries::figure::{Figure, OverMesh};
use pinwheel_timeseries::table::Table;

use crate::format::{NONE, bounded, joined, significant};
use crate::study::Tile;

/// Formats a number of a design.
pub fn number(value: f64) -> String {
    significant(value, usize::from(DIGITS))
}

/// Returns a figure with its bounds for the first screen, or the reason for a missing value.
pub fn tile(one: &Figure) -> Tile {
    let (value, bounds) = shown(one);
    let tile = Tile::new(&*one.def.label, value, bounds);
    match one.value {
        Some(_) => tile.unit(&*one.def.unit),
        None => tile,
    }
}

/// Returns a value and its bounds, `310 to 322 by contact law; ± 0.2 numerical`, or the reason for a missing value.
pub fn shown(one: &Figure) -> (String, String) {
    let Some(value) = one.value else {
        return (NONE.to_owned(), one.withheld.clone().unwrap_or_default());
    };
    let (shown, off) = known(value, one.uncertainty, one.def.digits);
    let bands = one.bands().into_iter();
    let bands = bands.map(|(cause, band)| format!("{} by {cause}", interval(band)));
    let by_sampling = one.is_off_by_sampling();
    let cause = if by_sampling {
        "by sampling"
    } else {
        "numerical"
    };
    let off = (!off.is_empty()).then(|| format!("{off} {cause}"));
    let shown = narrowest(one).map_or(shown, |band| rounded(value, band));
    (shown, joined("; ", bands.chain(off)))
}

/// Returns the narrowest band of a figure. It sets the digits of the value, so that the rounded value lies in every rounded
/// band.
fn narrowest(one: &Figure) -> Option<[f64; 2]> {
    one.bands().last().map(|(_, band)| *band)
}

/// Returns a value for a table, with the digits that its narrowest band permits, and its numerical uncertainty.
pub fn cell(one: &Figure) -> String {
    let Some(value) = one.value else {
        return NONE.to_owned();
    };
    let (shown, off) = match narrowest(one) {
        None => known(value, one.uncertainty, one.def.digits),
        Some(band) => {
            let shown = rounded(value, band);
            // The uncertainty is omitted beside a value rounded by more.
            let moved = shown.parse::<f64>();
            let moved = moved.map_or(0.0, |shown| (shown - value).abs());
            let off = one.uncertainty.filter(|u| *u > 0.0 && *u >= moved);
            let off = off.map_or_else(String::new, |u| format!("\u{b1} {}", significant(u, 1)));
            (shown, off)
        }
    };
    let sampling = match one.is_off_by_sampling() && !off.is_empty() {
        true => " (sampling)",
        false => "",
    };
    let off = off.replace('\u{202f}', " ");
    format!("{shown} {off}{sampling}").trim_end().to_owned()
}

/// Returns a value with its unit for a sentence: `479.1 ± 0.2 N`, `310 N (310 to 322 by contact law)`.
pub fn sentence(one: &Figure) -> String {
    let unit = &one.def.unit;
    match one.band() {
        None => format!("{} {unit}", cell(one)),
        Some(_) => {
            let (value, bounds) = shown(one);
            format!("{value} {unit} ({bounds})").replace('\u{202f}', " ")
        }
    }
}

/// Returns the definition of a figure, its values over the mesh, and the reason for a missing value.
pub fn how(one: &Figure) -> String {
    let mesh = one.over_mesh.map(|mesh| over_mesh(one, &mesh));
    let parts = [Some(one.def.how.to_owned()), mesh, one.withheld.clone()];
    joined("; ", parts.into_iter().flatten())
}

fn over_mesh(one: &Figure, mesh: &OverMesh) -> String {
    let with_off = |value: f64, off: f64| cell(&one.def.of(value, off));
    let mean = (one.value != Some(mesh.mean)).then_some(mesh.mean);
    let [least, largest] = mesh.ends;
    // The variation has more significant digits than the value.
    if let Some(value) = one.value.filter(|_| one.band().is_some()) {
        let percent = |length: f64| 100.0 * length / value.abs();
        let off: f64 = mesh.uncertainty.iter().sum();
        let varies = with_off(percent(largest - least), percent(off));
        let mean = mean.map_or_else(String::new, |mean| {
            let less = significant(100.0 * (1.0 - mean / value).abs(), 2);
            format!(", {less} % less on average")
        });
        return format!("varies by {varies} % over the mesh{mean}");
    }
    let [least, largest] = [0, 1].map(|end| with_off(mesh.ends[end], mesh.uncertainty[end]));
    let mean = mean.map_or_else(String::new, |mean| format!(", {} on average", number(mean)));
    format!("{least} to {largest} over the mesh{mean}")
}

/// Returns a table of figures with their bounds; `how`: their definitions.
pub fn table(caption: &str, figures: &[Figure], how: impl Fn(&Figure) -> String) -> Table {
    let mut table = Table::of(caption, figures)
        .text("", "Figure", |one| &*one.def.label)
        .number("", "Value", |one| one.value)
        .display(|one| cell(one));
    for (cause, label) in [("contact law", "By contact law"), ("fit", "By fit")] {
        let band = |one: &&Figure| {
            let bands = one.bands();
            let own = bands.iter().find(|(known, _)| *known == cause);
            own.map_or_else(String::new, |(_, band)| interval(*band))
        };
        if figures.iter().any(|one| !band(&one).is_empty()) {
            table = table.text("", label, band);
        }
    }
    table
        .text("", "Unit", |one| &*one.def.unit)
        .text("", "How", |one| how(one))
        .done()
}

/// Returns a value and its uncertainty, which may be empty, with at most `digits` significant digits.
fn known(value: f64, uncertainty: Option<f64>, digits: u8) -> (String, String) {
    let (shown, off) = bounded(value, uncertainty);
    let least = 10_f64.powi(-i32::from(digits)) * value.abs();
    match uncertainty {
        Some(u) if u > least => (shown, off),
        _ => (significant(value, usize::from(digits)), off),
    }
}

/// Returns a value with the digits that a band permits: no digit below a fifth of the band's width.
pub fn rounded(value: f64, [low, high]: [f64; 2]) -> String {
    let width = high - low;
    if !(width > 0.0 && value.is_finite()) {
        return significant(value, 4);
    }
    let digit = (0.2 * width).log10().floor();
    if digit < -6.0 {
        let digits = value.abs().max(width).log10().floor() - digit + 1.0;
        return significant(value, digits.clamp(1.0, 4.0) as usize);
    }
    let unit = 10.0_f64.powf(digit);
    let decimals = (-digit).max(0.0) as usize;
    format!("{:.decimals$}", (value / unit).round() * unit)
}

/// Formats an interval, `310 to 322`.
pub fn interval(band: [f64; 2]) -> String {
    let [low, high] = band.map(|end| rounded(end, band));
    format!("{low} to {high}")
}

#[cfg(test)]
mod tests {
    use pinwheel_timeseries::figure::FigureDef;

    use super::*;

    #[test]
    fn a_value_lies_in_each_of_its_intervals_as_shown() {
        let def = FigureDef::named("a", "a", "N");
        let one = Figure {
            by_contact_law: Some([5.2321, 5.2634]),
            by_fit: Some([2.13, 8.27]),
            ..def.of(5.2479, Some(1e-3))
        };
        assert_eq!(cell(&one), "5.248 \u{b1} 0.001");
        let (value, bounds) = shown(&one);
        assert_eq!(value, "5.248");
        assert!(
            bounds.starts_with("2 to 8 by fit; 5.232 to 5.263 by contact law"),
            "{bounds}"
        );
    }

    #[test]
    fn digits_are_those_that_the_band_leaves() {
        assert_eq!(rounded(319.71, [310.2, 322.4]), "320");
        assert_eq!(interval([310.2, 322.4]), "310 to 322");
        assert_eq!(rounded(358.3, [226.0, 430.0]), "360");
        assert_eq!(rounded(0.05312, [0.048, 0.073]), "0.053");
        assert_eq!(rounded(5.0, [5.0, 5.0]), "5.000");
        assert_eq!(
            interval([2.19e-7, 5.72e-7]),
            "2.2\u{b7}10\u{207b}\u{2077} to 5.7\u{b7}10\u{207b}\u{2077}"
        );
    }
}
