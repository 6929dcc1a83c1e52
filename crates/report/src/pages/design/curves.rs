//! Curves of designs, common to all parts of their page.

use crate::COLOURS;
use crate::study::{Axis, Chart, Series};
use pinwheel_studies::design::DesignResult;

/// Returns a curve labelled by its design.
pub(crate) fn line(x: &[f64], y: &[f64]) -> Series {
    Series::line("", x, y)
}

/// Returns a chart of curves over linear axes.
pub(crate) fn chart(title: &str, x: &str, y: &str, series: Vec<Series>) -> Chart {
    Chart::new(title, Axis::linear(x), Axis::linear(y), series)
}

/// Designs of one chart with their names, which may be empty for a single one.
pub(crate) type Drawn<'a> = [(&'a str, &'a DesignResult)];

/// Returns a line of a design. With several designs it has the design's name and colour, and its dash shows the variant.
pub(crate) fn of_design(
    designs: &Drawn<'_>,
    design: usize,
    (variant, what): (usize, &str),
    line: Series,
) -> Series {
    if designs.len() < 2 {
        return Series {
            label: what.to_owned(),
            ..line
        };
    }
    Series {
        label: format!("{}: {what}", designs[design].0),
        colour: Some(design + COLOURS * variant),
        ..line
    }
}

pub(crate) fn degrees(angles_rad: &[f64]) -> Vec<f64> {
    angles_rad.iter().map(|angle| angle.to_degrees()).collect()
}
