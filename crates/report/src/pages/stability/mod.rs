//! Stability study: stable methods for every hard scene, and failures of the others.

mod maps;

use crate::format::{self, joined, significant};
use crate::study::{Block, Decision, Question, Section, Study, Tile, Tone, Verdict};
use crate::terminal::{self, paragraphs, titled};
use pinwheel_scene::Formulation;
use pinwheel_studies::Provenance;
use pinwheel_studies::stability::{Atlas, Cell, SERVED, SceneRow};
use pinwheel_timeseries::table::{Mark, Shown, Table};

/// Returns the page.
pub fn page(atlas: &Atlas, origin: &Provenance) -> String {
    let mut sections = maps::sections(atlas);
    sections.insert(0, scenes(atlas));
    let study = Study {
        title: "Stability on hard cases".to_owned(),
        eyebrow: "Pinwheel stability study".to_owned(),
        lead: "Every hard scene with every formulation and integrator: the largest step that works, the error at the paper's step, \
               what fails first, and where the energy goes."
            .to_owned(),
        verdict: Some(verdict(atlas)),
        decision: decision(atlas),
        tiles: tiles(atlas),
        sections,
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

fn verdict(atlas: &Atlas) -> Verdict {
    let (rows, all) = (atlas.done().count(), atlas.rows.len());
    let unserved = atlas.unserved();
    let served = format::limit(SERVED);
    let stopped = match rows < all {
        true => format!(" The study was stopped: {rows} of {all} scenes are done."),
        false => String::new(),
    };
    let detail = format!(
        "Forces against a converged run, at a step of {} or the tolerance in the column's head.{stopped}",
        format::seconds(atlas.options.step_s)
    );
    let headline = match unserved.len() {
        _ if rows == 0 => "No scene of the atlas is done yet".to_owned(),
        0 => format!("Each of the {rows} scenes has a method that gives it within {served}"),
        n => {
            let list = unserved.join(", ");
            format!("{n} of {rows} scenes have no method within {served}: {list}")
        }
    };
    Verdict {
        tone: Tone::of(rows > 0 && rows == all && unserved.is_empty()),
        headline,
        detail,
    }
}

fn decision(atlas: &Atlas) -> Decision {
    // Without loads the forces are rounding.
    let loaded = |row: &&SceneRow| row.cells.iter().any(|cell| cell.error.is_some());
    let references = atlas.done().filter(loaded);
    let references = references.filter_map(|row| Some((&row.scene, row.reference.as_ref()?)));
    let apart = references.map(|(scene, run)| (run.apart.forces, scene));
    let sure = apart
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(apart, scene)| {
            let why = format!("of forces: two converged runs of {scene}, which are furthest apart");
            Question::Sure.answered(Mark::None, format!("to {}", format::relative(apart)), why)
        });
    let why = "every method is of one program; other engines are a comparison";
    let right = Question::Right.answered(Mark::Warn, "one program", why);
    let next = hardest(atlas).map(|(_, scene)| {
        let command = format!("pinwheel compare {scene}");
        Tile::next(&command, "whether other engines agree on the hardest scene")
    });
    [Some(right), None, sure, next]
}

/// Scene whose best method has the largest error of the forces.
fn hardest(atlas: &Atlas) -> Option<(f64, &String)> {
    let bests = atlas.done();
    let bests = bests.filter_map(|row| Some((row.best()?.1, &row.scene)));
    bests.max_by(|a, b| a.0.total_cmp(&b.0))
}

fn tiles(atlas: &Atlas) -> Vec<Tile> {
    let cells = || atlas.done().flat_map(|row| &row.cells);
    let failed = cells().filter(|cell| cell.failure.is_some()).count();
    let dear = cells().filter(|cell| cell.dearer_than.is_some()).count();
    let step = format::seconds(atlas.options.step_s);
    let mut detail = format!("{failed} of them fail at {step}");
    if dear > 0 {
        detail.push_str(&format!(", {dear} {}", maps::DEAR));
    }
    let pairs = Tile::new("Scene and method", cells().count().to_string(), detail);
    let hardest = hardest(atlas).map(|(error, scene)| {
        let detail = format!("{scene}, error of the forces with the best method");
        Tile::new("Hardest scene", format::relative(error), detail)
    });
    [pairs.unit("pairs")].into_iter().chain(hardest).collect()
}

fn scenes(atlas: &Atlas) -> Section {
    let auto = |row: &SceneRow| {
        let mut cells = row.cells.iter();
        let own = cells.find(|cell| {
            cell.method.integrator == row.auto && cell.method.formulation == Formulation::Reduced
        });
        own.and_then(Cell::right_to)
    };
    let with = |name: &str, error: f64| format!("{name}: {}", format::relative(error));
    let served = |error: Option<f64>| match error {
        Some(error) if error <= SERVED => Mark::Good,
        Some(_) => Mark::Warn,
        None => Mark::None,
    };
    let best = |row: &SceneRow| row.best().map(|(_, error)| error);
    let rows: Vec<&SceneRow> = atlas.done().collect();
    let scenes = Table::of(
        "What integrator = auto takes for a hard scene, and what does best, with the errors of the forces",
        &rows,
    )
    .text("", "Scene", |row| &row.scene)
    .text("", "auto", |row| {
        auto(row).map_or_else(|| row.auto.clone(), |error| with(&row.auto, error))
    })
    .marked(|row| served(auto(row)))
    .text("", "Best", |row| match row.best() {
        Some((cell, error)) => with(&cell.method.name(), error),
        None => "none".to_owned(),
    })
    .marked(|row| match best(row) {
        None => Mark::Bad,
        error => served(error),
    });
    let references = Table::of(
        "Method with its step or tolerance, and how far a second run lies from it",
        &rows,
    )
    .text("", "Scene", |row| &row.scene)
    .text("", "Converged run", |row| match &row.reference {
        Some(run) => format!("{} at {:.1e}", run.solution.method, run.solution.setting),
        None => row.refused.clone().unwrap_or_default(),
    })
    .marked(|row| Mark::bad(row.reference.is_none()))
    .number("", "Distance of a second one, forces", |row| {
        row.reference.as_ref().map(|run| run.apart.forces)
    })
    .shown(Shown::Relative)
    .text("", "Why it is hard", |row| &row.why);
    let why = Block::folded(
        "Why each is hard, and the converged run that errors are measured against",
        references,
    );
    Section::new("scenes", "Scenes").with(scenes).with(why)
}

/// Returns the text for a terminal, without the path of the page: number of scenes that each method resolves, and its
/// smallest step or largest error.
pub fn text(atlas: &Atlas) -> String {
    let scenes: Vec<_> = atlas.done().filter(|row| row.refused.is_none()).collect();
    let cells = |place: usize| {
        let cells = scenes.iter();
        cells.filter_map(move |row| Some((row.scene.as_str(), row.cells.get(place)?)))
    };
    let methods = atlas.options.methods.iter().enumerate();
    let table = Table::of("", methods)
        .text("", "method", |(_, method)| method.name())
        .text("", "right", |(k, _)| {
            let count = cells(*k).filter(|(_, cell)| cell.is_right()).count();
            format!("{count} of {}", scenes.len())
        })
        .text("", "smallest step, \u{b5}s", |(k, _)| {
            let step = cells(*k).filter_map(|(scene, cell)| Some((scene, cell.largest_step_s?)));
            let step = step.min_by(|a, b| a.1.total_cmp(&b.1));
            step.map_or_else(String::new, |(scene, step)| {
                format!("{}, {scene}", significant(1e6 * step, 3))
            })
        })
        .text("", "largest error, %", |(k, _)| {
            let error = cells(*k).filter_map(|(scene, cell)| Some((scene, cell.right_to()?)));
            let error = error.max_by(|a, b| a.1.total_cmp(&b.1));
            error.map_or_else(String::new, |(scene, error)| {
                format!("{}, {scene}", significant(100.0 * error, 2))
            })
        })
        .text("", "fails in", |(k, _)| {
            let wrong = |cell: &Cell| !cell.is_right() && cell.dearer_than.is_none();
            let wrong = cells(*k).filter(|(_, cell)| wrong(cell));
            joined(", ", wrong.map(|(scene, _)| scene))
        })
        .marked(|_| Mark::Bad)
        .text("", maps::DEAR, |(k, _)| {
            let dear = cells(*k).filter(|(_, cell)| cell.dearer_than.is_some());
            joined(", ", dear.map(|(scene, _)| scene))
        });
    let refused = atlas
        .done()
        .filter_map(|row| Some((&row.scene, row.refused.as_ref()?)));
    let refused = refused.map(|(scene, why)| format!("{scene}: {why}"));
    let findings = paragraphs(atlas.findings().map(|(line, _)| line));
    let table = terminal::table(&table.done().without_empty());
    let map = "The map of scenes and methods is on the page.".to_owned();
    let notes = paragraphs(refused.chain(maps::dear(atlas)));
    titled("stability", [findings, table, notes, map])
}
