//! Gears a second and core.

use pinwheel_report::format::{limit, relative, seconds, significant};
use pinwheel_report::study::{Block, Cell, Column, Section, Table};
use pinwheel_studies::precision::batch::{Batch, Throughput};

/// The section.
pub(super) fn section(found: &Batch) -> Section {
    Section {
        id: "batch".to_owned(),
        title: "Many gears".to_owned(),
        blocks: vec![
            Block::Text(format!(
                "The scene as in a sweep: {} gears whose stiffness and load differ by a few per cent, each read, built and run once \
                 on one core, at the loosest tolerance that brings the scene itself to a force error of {}. Medians of CPU time.",
                found.gears,
                limit(found.target)
            )),
            Block::Table(Table {
                caption: "Gears a second on one core".to_owned(),
                columns: vec![
                    Column::text("Method"),
                    Column::number("Gears a second"),
                    Column::number("Run"),
                    Column::number("Set-up"),
                    Column::number("Set-up, share of a run"),
                    Column::number("Right-hand sides"),
                    Column::number("Tolerance"),
                    Column::number("Force error"),
                ],
                rows: found.methods.iter().map(row).collect(),
            }),
        ],
    }
}

fn row(method: &Throughput) -> Vec<Cell> {
    let number = |text: String, value: f64| Cell::number(text, value);
    vec![
        Cell::text(method.method.clone()),
        number(significant(method.gears_per_s, 3), method.gears_per_s),
        number(seconds(method.run_s), method.run_s),
        number(seconds(method.set_up_s), method.set_up_s),
        number(
            format!("{:.1}\u{202f}%", 100.0 * method.set_up_share()),
            method.set_up_share(),
        ),
        number(format!("{:.0}", method.rhs_calls), method.rhs_calls),
        number(limit(method.tolerance), method.tolerance),
        number(relative(method.force_l2), method.force_l2),
    ]
}
