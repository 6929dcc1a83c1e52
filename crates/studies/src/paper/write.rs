//! The study of the paper as files.

use std::path::Path;

use serde::Serialize;

use super::{Options, Paper, Plot};
use crate::output::{self, OutputError};
use crate::provenance::{Provenance, Summary};

/// Payload of `summary.json`.
#[derive(Serialize)]
struct Found<'a> {
    /// What stood in Adams' place.
    against: Option<&'a str>,
    #[serde(flatten)]
    paper: &'a Paper,
}

impl Paper {
    /// Writes `summary.json` and the curves of every plot, `KEY/courses.csv`, into the folder `dir`.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn write(
        &self,
        dir: &Path,
        options: &Options,
        made: &Provenance,
    ) -> Result<(), OutputError> {
        for plot in self.figures.iter().flat_map(|figure| &figure.plots) {
            let place = output::folder(dir, &plot.key)?;
            output::write_with(&place, "courses.csv", |sink| csv(plot, sink))?;
        }
        let found = Found {
            against: options.peer.as_ref().map(|peer| peer.name.as_str()),
            paper: self,
        };
        Summary::new(made, found).write(dir)
    }
}

/// A plot's curves as CSV: the first column is the horizontal axis, empty where a curve has no value.
fn csv(plot: &Plot, sink: impl std::io::Write) -> Result<(), csv::Error> {
    let mut writer = csv::Writer::from_writer(sink);
    let first = match plot.x_label.as_str() {
        "Time (s)" => "time_s",
        label => label,
    };
    let others = plot
        .curves
        .iter()
        .map(|curve| format!("{}: {}", plot.y_label, curve.label));
    writer.write_record(std::iter::once(first.to_owned()).chain(others))?;
    for (k, x) in plot.x.iter().enumerate() {
        let values = plot.curves.iter().map(|curve| {
            let value = curve.y.get(k).filter(|y| y.is_finite());
            value.map_or_else(String::new, f64::to_string)
        });
        writer.write_record(std::iter::once(x.to_string()).chain(values))?;
    }
    writer.flush().map_err(csv::Error::from)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paper::Curve;

    #[test]
    fn curves_as_csv() {
        let plot = Plot {
            key: "fig".into(),
            title: String::new(),
            x_label: "Time (s)".into(),
            y_label: "Force (N)".into(),
            y_log: false,
            x: vec![0.0, 0.5],
            curves: vec![Curve {
                label: "d = 0, exact".into(),
                points: false,
                y: vec![1.5, f64::NAN],
            }],
            note: String::new(),
        };
        let mut text = Vec::new();
        csv(&plot, &mut text).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "time_s,\"Force (N): d = 0, exact\"\n0,1.5\n0.5,\n"
        );
        assert_eq!(
            pinwheel_courses::Courses::read_csv("time_s\n0\n".as_bytes())
                .map(|c| c.len())
                .ok(),
            Some(1)
        );
    }
}
