//! Charts of a study: curves or points over any axis, linear or logarithmic.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;
use serde_json::{Value, json};

/// Chart of a study.
///
/// ```
/// use pinwheel_report::study::{Axis, Chart, Section, Series, Study, Style, render};
///
/// let errors = Series::line("dopri5", [1e-5, 1e-4], [3e-9, 3e-4]).styled(Style::Both);
/// let (x, y) = (Axis::log("Step (s)"), Axis::log("Relative L2 of the forces"));
/// let chart = Chart::new("Error against step", x, y, vec![errors]);
/// let section = Section::new("order", "Order").with(vec![chart]);
/// let page = render(&Study { title: "mine".into(), sections: vec![section], ..Study::default() });
/// assert!(page.contains("Error against step"));
/// ```
#[derive(Debug, Clone, Default)]
pub struct Chart {
    /// Heading.
    pub title: String,
    /// Horizontal axis.
    pub x: Axis,
    /// Vertical axis.
    pub y: Axis,
    /// Curves; their order sets colour and dash.
    pub series: Vec<Series>,
    /// Sentence below the chart; may be empty.
    pub note: String,
}

impl Chart {
    /// Creates a chart without a note.
    pub fn new(title: impl Into<String>, x: Axis, y: Axis, series: Vec<Series>) -> Self {
        Self {
            title: title.into(),
            x,
            y,
            series,
            note: String::new(),
        }
    }
}

/// Axis of a [`Chart`].
#[derive(Debug, Clone, Default, Serialize)]
pub struct Axis {
    /// Name and unit, e.g. `Time (s)`.
    pub label: String,
    /// True for a logarithmic axis, which omits values that are not positive.
    pub log: bool,
}

impl Axis {
    /// Creates a linear axis.
    pub fn linear(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            log: false,
        }
    }

    /// Creates a logarithmic axis.
    pub fn log(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            log: true,
        }
    }
}

/// Curve of a chart. Non-finite values are gaps. `x` of a [`Style::Line`] must increase; points may come in any order.
#[derive(Debug, Clone, Default)]
pub struct Series {
    /// Name in the legend.
    pub label: String,
    /// Style of the curve.
    pub style: Style,
    /// Horizontal values.
    pub x: Vec<f64>,
    /// Vertical values, of the same number.
    pub y: Vec<f64>,
    /// Labels of the points under the cursor (e.g. the step); empty, or one for each value.
    pub tags: Vec<String>,
    /// Number of colour and dash, if not by the order of curves: related curves in several charts share a colour.
    pub colour: Option<usize>,
}

impl Series {
    /// Creates a line.
    pub fn line(label: impl Into<String>, x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Self {
        Self {
            label: label.into(),
            x: x.into(),
            y: y.into(),
            ..Self::default()
        }
    }

    /// Sets another style.
    #[must_use]
    pub fn styled(self, style: Style) -> Self {
        Self { style, ..self }
    }
}

/// Style of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Style {
    /// Line.
    #[default]
    Line,
    /// Points.
    Points,
    /// Points joined by a line.
    Both,
    /// Thin dashed line: a limit, a slope, a prediction.
    Dashed,
}

/// Returns a chart for the page's script: `grids` are the distinct horizontal values, base64 of little-endian 32-bit
/// floats.
pub(super) fn json(chart: &Chart) -> Value {
    let mut grids: Vec<String> = Vec::new();
    let series = chart.series.iter().enumerate().map(|(place, series)| {
        let (x, y, tags) = ordered(series);
        let encoded = encode(&x);
        let grid = grids.iter().position(|g| *g == encoded);
        let grid = grid.unwrap_or_else(|| {
            grids.push(encoded);
            grids.len() - 1
        });
        let mut json = json!({
            "label": series.label,
            "style": series.style,
            "colour": series.colour.unwrap_or(place),
            "grid": grid,
            "y": encode(&y),
        });
        if !tags.is_empty() {
            json["tags"] = tags.into();
        }
        json
    });
    let series: Vec<Value> = series.collect();
    json!({ "title": chart.title, "x": chart.x, "y": chart.y, "grids": grids, "series": series })
}

/// Returns the points of a curve with increasing `x`, as required by the plotting library. Points without a finite `x` are
/// omitted.
fn ordered(series: &Series) -> (Vec<f64>, Vec<f64>, Vec<&str>) {
    let count = series.x.len().min(series.y.len());
    let mut order: Vec<usize> = (0..count).filter(|&k| series.x[k].is_finite()).collect();
    order.sort_by(|&a, &b| series.x[a].total_cmp(&series.x[b]));
    let of = |values: &[f64]| order.iter().map(|&k| values[k]).collect();
    let tags = order
        .iter()
        .filter_map(|&k| series.tags.get(k))
        .map(String::as_str);
    let tags = tags.filter(|_| series.tags.len() >= count).collect();
    (of(&series.x), of(&series.y), tags)
}

fn encode(values: &[f64]) -> String {
    let bytes = values.iter().flat_map(|&v| (v as f32).to_le_bytes());
    STANDARD.encode(bytes.collect::<Vec<u8>>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_in_any_order_are_sent_rising_with_their_tags() {
        let chart = Chart {
            series: vec![
                Series {
                    x: vec![2.0, 1.0, f64::NAN],
                    y: vec![20.0, 10.0, 0.0],
                    tags: vec!["b".into(), "a".into(), "none".into()],
                    ..Series::default()
                },
                Series {
                    x: vec![1.0, 2.0],
                    y: vec![f64::NAN, 3.0],
                    colour: Some(5),
                    ..Series::default()
                },
            ],
            ..Chart::default()
        };
        let json = json(&chart);
        assert_eq!(
            json["grids"].as_array().unwrap().len(),
            1,
            "both series share one grid"
        );
        assert_eq!(json["series"][0]["tags"], json!(["a", "b"]));
        assert_eq!(json["series"][0]["y"], encode(&[10.0, 20.0]));
        assert_eq!(json["series"][1]["colour"], 5);
    }
}
