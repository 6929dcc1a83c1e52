//! `pinwheel paper`: every figure and every claim of the paper, computed again, on one page.

mod args;
mod page;
mod stand_in;
mod words;

use std::fs;
use std::io::IsTerminal as _;
use std::path::Path;

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel_studies::paper::{self, Options, Paper, Plot};
use pinwheel_studies::{Control, Progress, StudyError};
use serde::Serialize;

pub(crate) use args::PaperArgs;

use crate::failure::Failure;
use crate::folder::Folder;
use crate::interrupt;
use crate::machine::Machine;
use crate::record;
use crate::screen::{self, BAD, GOOD, TITLE, styled};
use crate::table::{Cell, lines};

/// `summary.json`.
#[derive(Serialize)]
struct Summary<'a> {
    pinwheel_version: &'static str,
    command: &'a str,
    /// What stood in Adams' place.
    against: Option<&'a str>,
    #[serde(flatten)]
    paper: &'a Paper,
    machine: &'a Machine,
}

pub(crate) fn paper(args: &PaperArgs) -> Result<u8, Failure> {
    let figures = args.wanted()?;
    let folder = Folder::prepare(&args.out, args.force)?;
    let peer = if figures.is_empty() || figures.iter().any(|f| f == "10") {
        stand_in::peer(args.against.as_deref())?
    } else {
        None
    };
    let options = Options { figures, peer };
    let found = work(&options)?;

    let (command, machine) = (args.typed(), Machine::here());
    let against = options.peer.as_ref().map(|peer| peer.name.as_str());
    let page = page::page(&found, &command, &machine)?;
    record::write_text(&folder.path().join("index.html"), &page)?;
    for plot in found.figures.iter().flat_map(|figure| &figure.plots) {
        let place = folder.path().join(&plot.key);
        fs::create_dir_all(&place).map_err(|error| Failure::unwritable(&place, &error))?;
        let place = place.join("courses.csv");
        record::write_text(&place, &csv(plot))?;
    }
    record::write_json(
        &folder.path().join("summary.json"),
        &Summary {
            pinwheel_version: env!("CARGO_PKG_VERSION"),
            command: &command,
            against,
            paper: &found,
            machine: &machine,
        },
    )?;
    let out = folder.publish()?;
    screen::show(&shown(&found, &out.join("index.html")))?;
    Ok(0)
}

/// The study, with a bar on a terminal.
fn work(options: &Options) -> Result<Paper, Failure> {
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new(1)
    } else {
        ProgressBar::hidden()
    };
    if let Ok(style) =
        ProgressStyle::with_template("paper [{bar:30}] {pos} of {len}, {elapsed}, {msg}")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    let progress = |at: Progress<'_>| {
        bar.set_length(at.total as u64);
        bar.set_position(at.done as u64);
        bar.set_message(at.piece.to_owned());
    };
    let control = Control {
        cancel: interrupt::flag(),
        progress: &progress,
    };
    let found = paper::run(options, &control);
    bar.finish_and_clear();
    interrupt::check()?;
    found.map_err(|error| match error {
        StudyError::Cancelled => Failure::stopped(),
        error => Failure::engine(format!(
            "the paper's figures cannot be computed: {error}; leave the figure out with --figures"
        )),
    })
}

/// A plot's curves as CSV: the first column is the horizontal axis, empty where a curve has no value.
fn csv(plot: &Plot) -> String {
    let column = |label: &str| {
        if label.contains([',', '"']) {
            format!("\"{}\"", label.replace('"', "\"\""))
        } else {
            label.to_owned()
        }
    };
    let time = plot.x_label == "Time (s)";
    let mut text = if time {
        "time_s".to_owned()
    } else {
        column(&plot.x_label)
    };
    for curve in &plot.curves {
        text.push(',');
        text.push_str(&column(&format!("{}: {}", plot.y_label, curve.label)));
    }
    text.push('\n');
    for (k, x) in plot.x.iter().enumerate() {
        text.push_str(&x.to_string());
        for curve in &plot.curves {
            text.push(',');
            if let Some(y) = curve.y.get(k).filter(|y| y.is_finite()) {
                text.push_str(&y.to_string());
            }
        }
        text.push('\n');
    }
    text
}

/// The verdicts on the terminal.
fn shown(found: &Paper, page: &Path) -> String {
    let marked = |verdict, word: &str| {
        let cell = Cell::text(word);
        match words::good(verdict) {
            Some(true) => cell.styled(GOOD),
            Some(false) => cell.styled(BAD),
            None => cell,
        }
    };
    let figures = found.figures.iter().map(|figure| {
        let verdict = marked(figure.verdict, words::figure(figure.verdict));
        vec![Cell::text(&figure.name), verdict, Cell::text(&figure.title)]
    });
    let claims = found.claims.iter().map(|judged| {
        let verdict = marked(judged.verdict, words::claim(judged.verdict));
        vec![
            Cell::text("claim"),
            verdict,
            Cell::text(&judged.claim.claim),
        ]
    });
    let rows: Vec<Vec<Cell>> = figures.chain(claims).collect();
    format!(
        "{}\n{}\n{} runs in {:.0} s; page: {}",
        styled(TITLE, "the paper, computed again"),
        lines(&rows),
        found.runs,
        found.wall_s,
        page.display()
    )
}

#[cfg(test)]
mod tests {
    use pinwheel_studies::paper::Curve;

    use super::*;

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
        assert_eq!(
            csv(&plot),
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
