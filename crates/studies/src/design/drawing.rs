//! The discs as drawings: DXF in millimetres for CAD, CSV in metres for programs.
//!
//! The DXF is AutoCAD's of release 12, ASCII, which everything reads: a closed polyline on the layer `edge`, circles on `holes`.
//! Source of the group codes: Autodesk, DXF Reference, sections POLYLINE, VERTEX, CIRCLE.

use std::fmt::Write as _;
use std::path::Path;

use pinwheel_scene::{CheckedScene, Outline};
use pinwheel_timeseries::table::Table;
use serde::Serialize;

use crate::StudyError;
use crate::output::{OutputError, write_text, write_with};

/// Largest distance of the drawn edge from the true one, m.
pub const CHORD_M: f64 = 1e-6;

/// Drawing of one disc.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Drawing {
    /// Corners of the edge.
    pub corners: usize,
    /// Largest distance of the edge from its chords that was found, m.
    pub chord_error_m: f64,
    #[serde(skip)]
    outline: Outline,
}

/// Draws every disc.
///
/// # Errors
/// A disc so large that the chord error is next to nothing.
pub fn discs(scene: &CheckedScene) -> Result<Vec<Drawing>, StudyError> {
    let gear = &scene.gear;
    // Of a large gear, what a micrometre is to the paper's.
    let chord_m = CHORD_M.max(1e-6 * gear.pitch_radius_m());
    let disc = |wheel| {
        let outline = gear.outline(wheel, chord_m);
        let outline = outline.map_err(|fault| StudyError::Input(fault.to_string()))?;
        Ok(Drawing {
            corners: outline.edge_m.len(),
            chord_error_m: outline.chord_error_m,
            outline,
        })
    };
    (0..gear.wheels).map(disc).collect()
}

impl Drawing {
    /// Writes `disc_<number>.dxf` and `disc_<number>.csv`.
    pub(super) fn write(&self, dir: &Path, number: usize) -> Result<(), OutputError> {
        write_text(&dir.join(format!("disc_{number}.dxf")), &self.dxf())?;
        let edge = self.outline.edge_m.iter().map(|at| ("edge", at, None));
        let holes = self.outline.holes_m.iter();
        let holes = holes.map(|(at, radius)| ("hole", at, Some(*radius)));
        let table = Table::of("", edge.chain(holes))
            .text("part", "", |part| part.0)
            .number("x_m", "", |part| part.1[0])
            .number("y_m", "", |part| part.1[1])
            .number("radius_m", "", |part| part.2)
            .done();
        write_with(dir, &format!("disc_{number}.csv"), |sink| {
            table.write_csv(sink)
        })
    }

    /// As a drawing in DXF, lengths in millimetres.
    #[must_use]
    pub fn dxf(&self) -> String {
        let mut text = String::new();
        let mut put = |code: u32, value: &str| {
            let _ = writeln!(text, "{code:>3}\n{value}");
        };
        // A picometre: digits below are noise.
        let mm = |metres: f64| format!("{:.9}", 1e3 * metres);
        put(
            999,
            &format!(
                "cycloidal disc, millimetres, chord error {:.1e} mm",
                1e3 * self.chord_error_m
            ),
        );
        put(0, "SECTION");
        put(2, "ENTITIES");
        put(0, "POLYLINE");
        put(8, "edge");
        put(66, "1");
        put(70, "1");
        for code in [10, 20, 30] {
            put(code, "0.0");
        }
        for &[x, y] in &self.outline.edge_m {
            put(0, "VERTEX");
            put(8, "edge");
            put(10, &mm(x));
            put(20, &mm(y));
            put(30, "0.0");
        }
        put(0, "SEQEND");
        for &([x, y], radius) in &self.outline.holes_m {
            put(0, "CIRCLE");
            put(8, "holes");
            put(10, &mm(x));
            put(20, &mm(y));
            put(30, "0.0");
            put(40, &mm(radius));
        }
        put(0, "ENDSEC");
        put(0, "EOF");
        text
    }
}
