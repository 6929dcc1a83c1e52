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
pub(super) fn discs(scene: &CheckedScene) -> Result<Vec<Drawing>, StudyError> {
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

#[cfg(test)]
mod tests {
    use pinwheel_contact::{Complex, Epitrochoid};
    use pinwheel_scene::Scene;

    use super::*;

    /// Pairs of code and value.
    fn read(dxf: &str) -> Vec<(u32, &str)> {
        let lines: Vec<&str> = dxf.lines().collect();
        let pairs = lines.as_chunks::<2>().0.iter();
        pairs
            .map(|[code, value]| (code.trim().parse().unwrap(), *value))
            .collect()
    }

    /// Read back from the file: the middle of every chord lies within the stated error of the edge, which the contacts'
    /// closest points know; corners lie on it.
    #[test]
    fn drawings_lie_on_the_edge() {
        for (equidistant_m, radial_m, rotational_rad) in [
            (0.0, 0.0, 0.0),
            (2e-5, -3e-5, 0.0),
            (0.0, 0.0, 1e-3),
            (-1e-5, 0.0, 5e-4),
        ] {
            let mut scene = Scene::paper();
            let modification = &mut scene.gear.modification;
            modification.equidistant_m = equidistant_m;
            modification.radial_m = radial_m;
            modification.rotational_rad = rotational_rad;
            let scene = scene.check().unwrap();
            let drawing = &discs(&scene).unwrap()[1];
            assert!(drawing.chord_error_m <= CHORD_M, "{drawing:?}");
            let gear = &scene.gear;
            let curve = Epitrochoid::new(
                gear.eccentricity_m,
                gear.external_sleeves as u32,
                gear.generating_shortening(),
            )
            .unwrap();
            // Outside of what two turned discs have in common: outside of one of them.
            let outside = |p: Complex| {
                let of = |turn: f64| {
                    curve.closest(p * Complex::unit(turn)).distance + gear.edge_offset_m()
                };
                of(rotational_rad).max(of(-rotational_rad))
            };
            let dxf = drawing.dxf();
            let pairs = read(&dxf);
            let numbers = |wanted: u32, layer: &str| {
                let mut inside = false;
                let mut found = Vec::new();
                for &(code, value) in &pairs {
                    match code {
                        0 => inside = value == if layer == "edge" { "VERTEX" } else { "CIRCLE" },
                        _ if inside && code == wanted => {
                            found.push(1e-3 * value.parse::<f64>().unwrap());
                        }
                        _ => (),
                    }
                }
                found
            };
            let (x, y) = (numbers(10, "edge"), numbers(20, "edge"));
            assert_eq!(x.len(), drawing.corners);
            let corner = |k: usize| Complex::new(x[k % x.len()], y[k % x.len()]);
            let mut worst: f64 = 0.0;
            for k in 0..x.len() {
                let (one, next) = (corner(k), corner(k + 1));
                assert!(outside(one).abs() < 1e-11, "corner {k}: {}", outside(one));
                worst = worst.max(outside((one + next).scale(0.5)).abs());
            }
            assert!(
                worst <= 1.01 * drawing.chord_error_m && worst > 0.1 * drawing.chord_error_m,
                "{worst} of {}",
                drawing.chord_error_m
            );
            let radii = numbers(40, "holes");
            assert_eq!(radii.len(), gear.internal_sleeves);
            assert!((radii[0] - gear.hole_radius_m).abs() < 1e-12);
        }
    }
}
