//! Drawings of the discs, in millimetres: DXF for CAD, CSV for programs.
//!
//! The DXF is ASCII of AutoCAD release 12, which all programs read: a closed polyline on the layer `edge`, circles on
//! `holes`, `bore` (of the bearing on the eccentric), and, at their places for the input angle 0, `ring_pins` and
//! `output_pins`. Source of the group codes: Autodesk, DXF Reference, sections HEADER, POLYLINE, VERTEX, CIRCLE.
//!
//! Identical discs share a drawing. Disc i of n is the first one with its holes turned by 2 pi i/(n zs) against its lobes.
//! Both are the same part if that is a/zs + b/zi turns for integers a and b: if gcd(zs, zi) divides i zi/n. Two discs are
//! identical if zs is odd and zi even.

use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;
use std::path::Path;

use pinwheel_scene::{CheckedScene, Gear, Outline, bore_radius_m, turned};
use pinwheel_timeseries::table::Table;
use serde::Serialize;

use crate::StudyError;
use crate::output::{OutputError, write_text, write_with};

/// Largest distance of the drawn edge from the true one, m.
pub const CHORD_M: f64 = 1e-6;

/// Distance at which two holes coincide, over their circle's radius.
const SAME: f64 = 1e-9;

/// Circle: centre and radius, m.
type Circle = ([f64; 2], f64);

/// Drawing of one disc.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Drawing {
    /// Numbers of the discs with this drawing.
    pub wheels: Vec<usize>,
    /// Number of corners of the edge.
    pub corners: usize,
    /// Largest computed distance of the edge from its chords, m.
    pub chord_error_m: f64,
    #[serde(skip)]
    outline: Outline,
    /// Circles of layers besides edge and holes.
    #[serde(skip)]
    others: [(&'static str, Vec<Circle>); 3],
}

/// Draws every distinct disc.
///
/// # Errors
/// A disc so large that the relative chord error is too small.
pub fn discs(scene: &CheckedScene) -> Result<Vec<Drawing>, StudyError> {
    let gear = &scene.gear;
    // For a large gear, the same relative error as a micrometre on the paper's.
    let chord_m = CHORD_M.max(1e-6 * gear.pitch_radius_m());
    let mut drawings: Vec<Drawing> = Vec::new();
    for wheel in 0..gear.wheels {
        let outline = gear.outline(wheel, chord_m);
        let outline = outline.map_err(|fault| StudyError::Input(fault.to_string()))?;
        let one_part = |drawing: &&mut Drawing| is_one_part(gear, &drawing.outline, &outline);
        if let Some(drawing) = drawings.iter_mut().find(one_part) {
            drawing.wheels.push(wheel);
            continue;
        }
        drawings.push(Drawing {
            wheels: vec![wheel],
            corners: outline.edge_m.len(),
            chord_error_m: outline.chord_error_m,
            outline,
            others: others(scene, wheel),
        });
    }
    Ok(drawings)
}

/// True if the holes of one disc, turned by some lobes, are those of the other. The edges of all discs are equal.
fn is_one_part(gear: &Gear, one: &Outline, other: &Outline) -> bool {
    let same = SAME * gear.internal_circle_radius_m;
    let lobes = gear.lobes();
    (0..lobes).any(|lobe| {
        let turn = TAU * lobe as f64 / lobes as f64;
        one.holes_m.iter().all(|(at, radius)| {
            let [x, y] = turned(*at, turn);
            other
                .holes_m
                .iter()
                .any(|([u, v], other)| (x - u).hypot(y - v) < same && (radius - other).abs() < same)
        })
    })
}

/// Returns bore, ring pins and output pins of a disc, in its own frame, at the input angle 0; cranks have no output pins.
fn others(scene: &CheckedScene, wheel: usize) -> [(&'static str, Vec<Circle>); 3] {
    let gear = &scene.gear;
    let phase = TAU * wheel as f64 / gear.wheels as f64;
    let start = (PI - phase) / gear.lobes() as f64;
    let [ex, ey] = turned([gear.eccentricity_m, 0.0], phase);
    let turn_back = |[x, y]: [f64; 2]| turned([x - ex, y - ey], -start);
    let ring = |j| {
        (
            turn_back(gear.external_sleeve_m(j)),
            gear.external_sleeve_radius_of_m(j),
        )
    };
    let output = |k| {
        (
            turn_back(gear.internal_sleeve_m(k)),
            gear.internal_sleeve_radius_of_m(k),
        )
    };
    let outputs = if scene.cranks.is_some() {
        0
    } else {
        gear.internal_sleeves
    };
    [
        ("bore", vec![([0.0; 2], bore_radius_m(gear))]),
        ("ring_pins", (0..gear.external_sleeves).map(ring).collect()),
        ("output_pins", (0..outputs).map(output).collect()),
    ]
}

impl Drawing {
    /// Returns the number of the first disc with this drawing, used in the files `disc_<number>.dxf` and `.csv`.
    #[must_use]
    pub fn number(&self) -> usize {
        self.wheels.first().copied().unwrap_or_default()
    }

    /// Returns the circles by layer.
    fn circles(&self) -> impl Iterator<Item = (&'static str, &Circle)> {
        let holes = self.outline.holes_m.iter().map(|circle| ("holes", circle));
        let others = self.others.iter();
        holes.chain(others.flat_map(|(layer, all)| all.iter().map(|circle| (*layer, circle))))
    }

    /// Writes `disc_<number>.dxf` and `disc_<number>.csv`.
    pub(super) fn write(&self, dir: &Path) -> Result<(), OutputError> {
        let number = self.number();
        write_text(&dir.join(format!("disc_{number}.dxf")), &self.dxf())?;
        let edge = self.outline.edge_m.iter().map(|at| ("edge", at, None));
        let circles = self.circles();
        let circles = circles.map(|(layer, (at, radius))| (layer, at, Some(*radius)));
        let table = Table::of("", edge.chain(circles))
            .text("layer", "", |part| part.0)
            .number("x_mm", "", |part| 1e3 * part.1[0])
            .number("y_mm", "", |part| 1e3 * part.1[1])
            .number("radius_mm", "", |part| part.2.map(|radius| 1e3 * radius))
            .done();
        write_with(dir, &format!("disc_{number}.csv"), |sink| {
            table.write_csv(sink)
        })
    }

    /// Returns the drawing in DXF, lengths in millimetres.
    #[must_use]
    pub fn dxf(&self) -> String {
        let mut text = String::new();
        let mut put = |code: u32, value: &str| {
            let _ = writeln!(text, "{code:>3}\n{value}");
        };
        // A resolution of a picometre; further digits are noise.
        let mm = |metres: f64| format!("{:.9}", 1e3 * metres);
        put(
            999,
            &format!(
                "cycloidal disc, millimetres, chord error {:.1e} mm",
                1e3 * self.chord_error_m
            ),
        );
        // Unit 4: millimetres.
        for (code, value) in [
            (0, "SECTION"),
            (2, "HEADER"),
            (9, "$ACADVER"),
            (1, "AC1009"),
            (9, "$INSUNITS"),
            (70, "4"),
            (9, "$MEASUREMENT"),
            (70, "1"),
            (0, "ENDSEC"),
            (0, "SECTION"),
            (2, "ENTITIES"),
        ] {
            put(code, value);
        }
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
        for (layer, &([x, y], radius)) in self.circles() {
            put(0, "CIRCLE");
            put(8, layer);
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
