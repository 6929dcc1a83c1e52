//! Text on a scene's model, its assumptions and its expected figures.

use crate::figure::number;
use crate::terminal::{TITLE, list, pairs, paragraph, styled};
use pinwheel_scene::{Line, Scene};
use pinwheel_studies::explained::Explanation;

/// Returns the text for a terminal.
pub fn text(explanation: &Explanation<'_>) -> String {
    let title = paragraph(&crate::pages::title(explanation.scene));
    let mut text = format!("{}\n", styled(TITLE, &title));
    let mut section = |title: &str, rows: String| {
        if !rows.is_empty() {
            text.push_str(&format!("\n{}\n{rows}", styled(TITLE, title)));
        }
    };
    section("Gear", pairs(gear(explanation.scene)));
    section("To be expected", list(expected(explanation)));
    let model = &explanation.model;
    for (title, facts) in [("Modelled", &model.modelled), ("Left out", &model.left_out)] {
        section(title, pairs(facts.iter().map(|s| (&s.what, &s.why))));
    }
    let sizes = list(figures(explanation, false));
    section("What follows from the dimensions", sizes);
    let frequencies = explanation.derived.frequencies.iter().map(|of| {
        let order = format!("order {:.4} of the input", of.order);
        [of.what.to_owned(), format!("{:.3} Hz", of.hertz), order]
    });
    section("Frequencies", list(frequencies));
    let assumptions = explanation.assumptions.iter();
    let assumptions = assumptions.map(|a| [&a.key, &a.value, &a.reason].map(|x| x.to_string()));
    section("Assumptions", list(assumptions));
    text
}

/// Describes the gear and its load as a data sheet does.
fn gear(scene: &Scene) -> [(&'static str, String); 3] {
    let (gear, drive) = (&scene.gear, &scene.drive);
    let inner = match &scene.cranks {
        Some(cranks) => format!("{} cranks", cranks.count),
        None => format!("{} output pins", gear.internal_sleeves),
    };
    let discs = if gear.wheels == 1 { "disc" } else { "discs" };
    let rpm = 30.0 * drive.input_speed_rad_s / std::f64::consts::PI;
    let (count, radius_mm) = (gear.external_sleeves, number(1e3 * gear.pitch_radius_m()));
    let pins = format!("{count} ring pins on a radius of {radius_mm} mm");
    let (rpm, load) = (number(rpm), drive.output_torque_n_m);
    [
        ("ratio", format!("{} : 1", scene.ratio())),
        ("parts", format!("{} {discs}, {pins}, {inner}", gear.wheels)),
        ("drive", format!("input at {rpm} rpm, load of {load} N m")),
    ]
}

/// Formats a figure in its customary unit.
fn shown(line: &Line) -> String {
    match line.unit {
        "m" => format!("{:.4} mm", 1e3 * line.value),
        "rad" => format!("{:.4} mrad", 1e3 * line.value),
        "N m" => format!("{:.4} N m", line.value),
        "N" => format!("{:.1} N", line.value),
        _ => format!("{} : 1", line.value),
    }
}

/// Returns figures of lengths and angles, or of forces.
fn figures(explanation: &Explanation<'_>, forces: bool) -> Vec<[String; 3]> {
    let lines = explanation.derived.lines(explanation.scene);
    let of = |line: &&Line| line.unit.starts_with('N') == forces;
    // Without backlash the play is 0, and its line is omitted.
    let there = |line: &&Line| line.unit != "rad" || line.value != 0.0;
    let row = |line: &Line| [line.what.to_owned(), shown(line), line.how.to_owned()];
    lines.iter().filter(of).filter(there).map(row).collect()
}

fn expected(explanation: &Explanation<'_>) -> Vec<[String; 3]> {
    let of = &explanation.derived;
    let mut rows = figures(explanation, true);
    for (what, in_phase) in [
        ("discs at the ring pins", of.external_ripple_in_phase),
        ("discs at the output pins", of.internal_ripple_in_phase),
    ] {
        let how = match in_phase {
            true => "in phase: no ripple cancels",
            false => "out of phase: ripple partly cancels",
        };
        rows.push([what, "", how].map(str::to_owned));
    }
    rows
}
