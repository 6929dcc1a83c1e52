//! Maps of the atlas: a shaded table of scenes and methods for every question, with its figure in every cell.

use crate::format::{self, joined};
use crate::study::Section;
use pinwheel_studies::stability::{Atlas, Cell, Failure, SceneRow};
use pinwheel_timeseries::table::{Mark, Table};

/// Limits of the shading of steps, s.
const STEPS: [f64; 2] = [2e-7, 1e-3];
/// Limits of the shading of errors.
const ERRORS: [f64; 2] = [1e-6, 1.0];
/// Words for a run that was ended as too dear.
pub(super) const DEAR: &str = "not run to the end";
/// Energy remainders above this share are marked: ten times the work created by the paper's law.
const REMAINDER: f64 = 0.1;

/// Returns the position of `value` between `low` and `high` on a logarithmic scale.
fn share(value: f64, [low, high]: [f64; 2]) -> f64 {
    ((value.max(f64::MIN_POSITIVE) / low).ln() / (high / low).ln()).clamp(0.0, 1.0)
}

/// Returns the largest step, or the error of a method that chooses its steps.
fn shown_step(cell: &Cell) -> String {
    match (&cell.failure, cell.largest_step_s) {
        (_, Some(step)) if cell.never_failed => format!("> {}", format::seconds(step)),
        (_, Some(step)) => format::seconds(step),
        (Some(failure), None) => failure.word().to_owned(),
        (None, None) => match cell.error {
            Some(error) => format!("ok, {}", format::relative(error.forces)),
            None => "ok".to_owned(),
        },
    }
}

/// Cell of a map for one scene and method.
#[derive(Default)]
struct Place {
    text: String,
    /// Sort key of the cell.
    key: Option<f64>,
    shade: Option<f64>,
    mark: Mark,
}

impl Place {
    fn marked(text: impl Into<String>, mark: Mark) -> Self {
        Self {
            text: text.into(),
            mark,
            ..Self::default()
        }
    }
}

fn step(cell: &Cell) -> Place {
    let mark = match (&cell.failure, cell.largest_step_s) {
        (Some(_), None) => Mark::Bad,
        (Some(_), Some(_)) => Mark::Warn,
        (None, None) => Mark::Good,
        (None, Some(_)) => Mark::None,
    };
    Place {
        key: cell.largest_step_s,
        shade: cell.largest_step_s.map(|step| 1.0 - share(step, STEPS)),
        ..Place::marked(shown_step(cell), mark)
    }
}

fn error(cell: &Cell) -> Place {
    let failed = cell.failure.as_ref().map(Failure::word);
    let mark = Mark::bad(failed.is_some());
    let Some(error) = cell.error else {
        return match failed {
            Some(word) => Place {
                shade: Some(1.0),
                ..Place::marked(word, mark)
            },
            None => Place::marked("no forces", Mark::Muted),
        };
    };
    let [forces, driver] = [error.forces, error.driver_torque].map(format::relative);
    let both = format!("{forces} / {driver}");
    let words = joined(", ", [both.as_str()].into_iter().chain(failed));
    Place {
        key: Some(error.forces),
        shade: Some(share(error.forces, ERRORS)),
        ..Place::marked(words, mark)
    }
}

fn first(cell: &Cell) -> Place {
    match (&cell.fails_first, &cell.failure) {
        (Some(first), _) => Place::marked(first.short(), Mark::None),
        (None, Some(failure)) => Place::marked(failure.short(), Mark::Bad),
        (None, None) if cell.never_failed => Place::marked("nothing did", Mark::Good),
        (None, None) => Place::marked("chooses its steps", Mark::Muted),
    }
}

fn energy(cell: &Cell) -> Place {
    // Without work a share is undefined.
    let share = cell.energy_remainder_share.filter(|_| cell.error.is_some());
    let Some(share) = share else {
        return Place::marked(format::NONE, Mark::Muted);
    };
    let mark = Mark::warn(share.abs() > REMAINDER);
    Place {
        key: Some(share),
        ..Place::marked(format!("{:+.2} %", 100.0 * share), mark)
    }
}

/// Returns a table of scenes and methods.
fn map(atlas: &Atlas, caption: &str, shown: fn(&Cell) -> Place) -> Table {
    let rows: Vec<_> = atlas.done().collect();
    let mut table = Table::of(caption, &rows).text("", "Scene", |row| &row.scene);
    for (k, method) in atlas.options.methods.iter().enumerate() {
        // The first cell of a refused scene shows the reason.
        let place = |row: &&&SceneRow| match (row.cells.get(k), &row.refused) {
            (Some(cell), _) if cell.dearer_than.is_some() => Place::marked(DEAR, Mark::Muted),
            (Some(cell), _) => shown(cell),
            (None, Some(reason)) if k == 0 => Place::marked(reason, Mark::Bad),
            (None, _) => Place::default(),
        };
        table = table
            .number("", &method.name(), |row| place(row).key)
            .display(|row| place(row).text)
            .shaded(|row| place(row).shade)
            .marked(|row| place(row).mark);
    }
    table.done()
}

/// Returns the bound on evaluations as a sentence.
pub(super) fn dear(atlas: &Atlas) -> Option<String> {
    let most = atlas.options.most_evaluations?;
    Some(format!(
        "A run by a tolerance that is dearer than {most} evaluations is {DEAR}."
    ))
}

/// Returns the largest step of every method.
pub(super) fn steps(atlas: &Atlas) -> Table {
    map(atlas, "Largest step with the right picture", step)
}

/// Returns the four maps.
pub(super) fn sections(atlas: &Atlas) -> Vec<Section> {
    let options = &atlas.options;
    let step_s = format::seconds(options.step_s);
    let dear = dear(atlas).unwrap_or_default();
    // The first map is unfolded, the others folded.
    let section = |id: &str, title: &str, text: String, table: Table| {
        let section = Section::new(id, title).with(text).with(table);
        match id {
            "map" => section,
            _ => section.folded("of every scene with every method"),
        }
    };
    vec![
        section(
            "map",
            "Largest step",
            format!(
                "The largest step with which a method still gives the right picture over the first {} s at most: it ends, \
                 its largest force is at most 1.5 times the converged one, its mean driver torque is within 10 %, its \
                 joints hold, its forces are within 50 %. Found by bisection to 10 %, between {} and {}. Darker is smaller. \
                 Marked: fails at {step_s} itself. Methods with a tolerance choose their steps; theirs is the error. {dear}",
                options.longest_s,
                format::seconds(options.steps_s[0]),
                format::seconds(options.steps_s[1]),
            ),
            steps(atlas),
        ),
        section(
            "errors",
            "Errors",
            format!(
                "At a step of {step_s} (or the tolerance), against the converged run: forces of all pins / driver torque, \
                 relative L2 over the whole run, start-up included. Darker is worse."
            ),
            map(atlas, &format!("Errors at {step_s}, forces / driver torque"), error),
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
            "Unaccounted energy as a share of the larger of the two works. The paper's law creates about 1 % itself, \
             because its stiffness varies along the profile; with Hertzian stiffness of real steel less."
                .to_owned(),
            map(atlas, "Unaccounted energy", energy),
        ),
    ]
}
