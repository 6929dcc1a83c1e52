//! What a scene models, assumes and lets one expect.

use pinwheel_report::terminal::{Cell, TITLE, lines, paragraph, styled};
use pinwheel_scene::{Derived, Line};
use pinwheel_studies::explained::Explanation;

/// The whole text.
#[must_use]
pub fn text(explanation: &Explanation<'_>) -> String {
    let title = paragraph(&crate::title(explanation.scene));
    let mut text = format!("{}\n", styled(TITLE, &title));
    let mut section = |title: &str, rows: Vec<Vec<Cell>>| {
        if !rows.is_empty() {
            text.push_str(&format!("\n{}\n{}", styled(TITLE, title), lines(&rows)));
        }
    };
    let two = |what: &str, why: &str| vec![Cell::text(what), Cell::text(why)];
    let statements = |list: &[pinwheel_gearbox::Statement]| {
        list.iter()
            .map(|s| two(&s.what, &s.why))
            .collect::<Vec<_>>()
    };
    section("Modelled", statements(&explanation.model.modelled));
    section("Left out", statements(&explanation.model.left_out));
    section(
        "What follows from the dimensions",
        figures(explanation, false),
    );
    section("To be expected", expected(explanation));
    section("Frequencies", frequencies(&explanation.derived));
    section(
        "Assumptions",
        explanation
            .assumptions
            .iter()
            .map(|a| {
                vec![
                    Cell::text(&a.key),
                    Cell::text(&a.value),
                    Cell::text(&a.reason),
                ]
            })
            .collect(),
    );
    text
}

/// A figure in the unit that people use for it.
fn shown(line: &Line) -> String {
    match line.unit {
        "m" => format!("{:.4} mm", 1e3 * line.value),
        "rad" => format!("{:.4} mrad", 1e3 * line.value),
        "N m" => format!("{:.4} N m", line.value),
        "N" => format!("{:.1} N", line.value),
        _ => format!("{} : 1", line.value),
    }
}

/// Lengths and angles, or forces.
fn figures(explanation: &Explanation<'_>, forces: bool) -> Vec<Vec<Cell>> {
    let lines = explanation.derived.lines(explanation.scene);
    let of = |line: &&Line| line.unit.starts_with('N') == forces;
    // Without backlash there is no play to speak of.
    let there = |line: &&Line| line.unit != "rad" || line.value != 0.0;
    let row = |line: &Line| {
        vec![
            Cell::text(line.what),
            Cell::figure(shown(line)),
            Cell::text(line.how),
        ]
    };
    lines.iter().filter(of).filter(there).map(row).collect()
}

fn expected(explanation: &Explanation<'_>) -> Vec<Vec<Cell>> {
    let phase = |what: &str, same: bool| {
        let how = if same {
            "in phase: no ripple cancels"
        } else {
            "out of phase: ripple partly cancels"
        };
        vec![Cell::text(what), Cell::figure(""), Cell::text(how)]
    };
    let of = &explanation.derived;
    let mut rows = figures(explanation, true);
    rows.push(phase(
        "wheels at the external sleeves",
        of.external_ripple_in_phase,
    ));
    rows.push(phase(
        "wheels at the internal sleeves",
        of.internal_ripple_in_phase,
    ));
    rows
}

fn frequencies(figures: &Derived) -> Vec<Vec<Cell>> {
    figures
        .frequencies
        .iter()
        .map(|frequency| {
            vec![
                Cell::text(frequency.what),
                Cell::figure(format!("{:.3} Hz", frequency.hertz)),
                Cell::text(format!("order {:.4} of the input", frequency.order)),
            ]
        })
        .collect()
}
