//! The atlas as maps: a table of scenes and methods for every question, shaded and with its figure in every cell.

use pinwheel_report::format;
use pinwheel_report::study::{Block, Cell, Column, Mark, Section, Table};
use pinwheel_studies::stability::{self, Atlas};

/// Steps at the ends of the shading, s.
const STEPS: [f64; 2] = [2e-7, 1e-3];
/// Errors at the ends of the shading.
const ERRORS: [f64; 2] = [1e-6, 1.0];
/// Remainders of the energy account above this are marked: ten times what the paper's law creates.
const REMAINDER: f64 = 0.1;

/// Where `value` lies between `low` and `high`, by its logarithm.
fn share(value: f64, [low, high]: [f64; 2]) -> f64 {
    ((value.max(f64::MIN_POSITIVE) / low).ln() / (high / low).ln()).clamp(0.0, 1.0)
}

/// The largest step, or the error of a method that chooses its steps.
pub(super) fn shown_step(cell: &stability::Cell) -> String {
    match (&cell.failure, cell.largest_step_s) {
        (_, Some(step)) if cell.never_failed => format!("> {}", format::seconds(step)),
        (_, Some(step)) => format::seconds(step),
        (Some(failure), None) => failure.word().to_owned(),
        (None, None) => cell.error.map_or_else(
            || "ok".to_owned(),
            |error| format!("ok, {}", format::relative(error.forces)),
        ),
    }
}

fn step(cell: &stability::Cell) -> Cell {
    let text = shown_step(cell);
    let mark = match (&cell.failure, cell.largest_step_s) {
        (Some(_), None) => Mark::Bad,
        (Some(_), Some(_)) => Mark::Warn,
        (None, None) => Mark::Good,
        (None, Some(_)) => Mark::None,
    };
    match cell.largest_step_s {
        Some(step) => Cell::number(text, step).heated(1.0 - share(step, STEPS)),
        None => Cell::text(text),
    }
    .marked(mark)
}

fn error(cell: &stability::Cell) -> Cell {
    match (&cell.failure, cell.error) {
        (Some(failure), None) => Cell::text(failure.word()).heated(1.0).marked(Mark::Bad),
        (failure, Some(error)) => {
            let both = format!(
                "{} / {}",
                format::relative(error.forces),
                format::relative(error.driver_torque)
            );
            let text = failure
                .as_ref()
                .map_or(both.clone(), |f| format!("{both}, {}", f.word()));
            let cell = Cell::number(text, error.forces).heated(share(error.forces, ERRORS));
            if failure.is_some() {
                cell.marked(Mark::Bad)
            } else {
                cell
            }
        }
        (None, None) => Cell::text("no forces").marked(Mark::Muted),
    }
}

fn first(cell: &stability::Cell) -> Cell {
    match (&cell.fails_first, &cell.failure) {
        (Some(first), _) => Cell::text(first.short()),
        (None, Some(failure)) => Cell::text(failure.short()).marked(Mark::Bad),
        (None, None) if cell.never_failed => Cell::text("nothing did").marked(Mark::Good),
        (None, None) => Cell::text("chooses its steps").marked(Mark::Muted),
    }
}

fn energy(cell: &stability::Cell) -> Cell {
    match cell.energy_remainder_share {
        // Without work there is nothing to take a share of.
        _ if cell.error.is_none() => Cell::text("-").marked(Mark::Muted),
        Some(share) => {
            let mark = if share.abs() > REMAINDER {
                Mark::Warn
            } else {
                Mark::None
            };
            Cell::number(format!("{:+.2} %", 100.0 * share), share).marked(mark)
        }
        None => Cell::text("-").marked(Mark::Muted),
    }
}

fn map(atlas: &Atlas, caption: &str, shown: fn(&stability::Cell) -> Cell) -> Block {
    let mut columns = vec![Column::text("Scene")];
    let methods = &atlas.options.methods;
    columns.extend(methods.iter().map(|m| Column::number(m.name())));
    let rows = atlas.done().map(|row| {
        let mut line = vec![Cell::text(&row.scene)];
        match &row.refused {
            Some(reason) => line.push(Cell::text(reason).marked(Mark::Bad)),
            None => line.extend(row.cells.iter().map(shown)),
        }
        line
    });
    Block::Table(Table {
        caption: caption.to_owned(),
        columns,
        rows: rows.collect(),
    })
}

/// The four maps.
pub(super) fn sections(atlas: &Atlas) -> Vec<Section> {
    let options = &atlas.options;
    let step_s = format::seconds(options.step_s);
    let section = |id: &str, title: &str, text: String, block: Block| Section {
        id: id.to_owned(),
        title: title.to_owned(),
        // The first map answers; the others are looked up.
        blocks: if id == "map" {
            vec![Block::Text(text), block]
        } else {
            vec![Block::Details {
                summary: "of every scene with every method".to_owned(),
                blocks: vec![Block::Text(text), block],
            }]
        },
    };
    vec![
        section(
            "map",
            "Largest step",
            format!(
                "The largest step with which a method still gives the right picture over the first {} s at most: it ends, \
                 its largest force is at most 1.5 times the converged one, its mean driver torque is within 10 %, its \
                 joints hold, its forces are within 50 %. Found by bisection to 10 %, between {} and {}. Darker is smaller. \
                 Marked: fails at {step_s} itself. Methods with a tolerance choose their steps; theirs is the error.",
                options.longest_s,
                format::seconds(options.steps_s[0]),
                format::seconds(options.steps_s[1]),
            ),
            map(atlas, "Largest step with the right picture", step),
        ),
        section(
            "errors",
            "Errors",
            format!(
                "At a step of {step_s} (or the tolerance), against the converged run: forces of all sleeves / driver torque, \
                 relative L2 over the whole run, start-up included. Darker is worse."
            ),
            map(
                atlas,
                &format!("Errors at {step_s}, forces / driver torque"),
                error,
            ),
        ),
        section(
            "failures",
            "What fails first",
            "Above the largest step: blow-up (the run stops with an error that says when and which), chatter (forces far \
             too high), wrong mean, drift of the joints, or a wrong course (right sizes, lost phases). Only a blow-up is loud by itself; \
             `pinwheel run` finds the others by repeating a run at twice its step. The errors in full are in stability.csv."
                .to_owned(),
            map(atlas, "What fails first above the largest step", first),
        ),
        section(
            "energy",
            "Energy",
            "What nothing accounts for, as a share of the larger of the two works. The paper's law creates about 1 % itself, \
             because its stiffness varies along the profile; with Hertzian stiffness of real steel less."
                .to_owned(),
            map(atlas, "Energy that nothing accounts for", energy),
        ),
    ]
}
