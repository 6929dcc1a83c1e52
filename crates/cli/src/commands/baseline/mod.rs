//! `pinwheel baseline`: what the solver gave when it was last accepted, and what moved since.

mod args;
mod page;
mod source;

use std::fs;
use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};

use indicatif::{ProgressBar, ProgressStyle};
use pinwheel_studies::baseline::{
    self, Acceptance, Baseline, BaselineError, Check, HEAD, Head, Made, Options, Verdict, table,
};
use pinwheel_studies::{Control, Progress, StudyError};
use serde::Serialize;

pub(crate) use args::BaselineArgs;
use args::{Action, CheckArgs, ListArgs, RecordArgs, Which};

use crate::args::quoted;
use crate::failure::{EXCEEDED, Failure};
use crate::folder::Folder;
use crate::interrupt;
use crate::machine::Machine;
use crate::record;
use crate::screen::{self, BAD, GOOD, QUIET, TITLE, styled};
use crate::table::{Cell, lines};

pub(crate) fn baseline(args: &BaselineArgs) -> Result<u8, Failure> {
    match &args.action {
        Action::Record(args) => record_baseline(args),
        Action::Check(args) => check(args),
        Action::List(args) => list(args),
    }
}

impl Which {
    /// The baseline's folder.
    fn folder(&self) -> Result<PathBuf, Failure> {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if self.name.is_empty() || self.name.starts_with('.') || !self.name.chars().all(plain) {
            return Err(Failure::input(format!(
                "`{}` is no name for a baseline; use letters, digits, `-`, `_` and `.`",
                self.name
            )));
        }
        Ok(self.dir.join(&self.name))
    }

    /// The baseline itself.
    fn read(&self) -> Result<Baseline, Failure> {
        let folder = self.folder()?;
        if !folder.join(HEAD).is_file() {
            let known = Baseline::names(&self.dir);
            let remedy = if known.is_empty() {
                "run in the project's folder, name --dir, or record one with `pinwheel baseline record`".to_owned()
            } else {
                format!("there are {}", known.join(", "))
            };
            return Err(Failure::input(format!(
                "no baseline `{}` in {}; {remedy}",
                self.name,
                self.dir.display()
            )));
        }
        Ok(Baseline::read(&folder)?)
    }
}

impl From<BaselineError> for Failure {
    fn from(error: BaselineError) -> Self {
        match error {
            BaselineError::Study(StudyError::Cancelled) => Self::stopped(),
            BaselineError::Study(_) | BaselineError::DoesNotHold { .. } => {
                Self::engine(format!("{error}; nothing was written"))
            }
            BaselineError::NoScene(_) => {
                let names: Vec<&str> = baseline::SCENES.iter().map(|case| case.name).collect();
                Self::input(format!("{error}; there are {}", names.join(", ")))
            }
            BaselineError::Spoiled { .. } => Self::input(format!(
                "{error}; restore the file or record the baseline anew"
            )),
            _ => Self::input(format!("{error}; choose another --dir or restore the file")),
        }
    }
}

/// Runs with a bar on the terminal.
fn with_progress<T>(
    work: impl FnOnce(&Control<'_>) -> Result<T, BaselineError>,
) -> Result<T, Failure> {
    interrupt::check()?;
    let bar = if std::io::stderr().is_terminal() {
        ProgressBar::new(0)
    } else {
        ProgressBar::hidden()
    };
    if let Ok(style) =
        ProgressStyle::with_template("baseline [{bar:30}] {pos}/{len} {msg}, {eta} left")
    {
        bar.set_style(style.progress_chars("=> "));
    }
    let report = |progress: Progress<'_>| {
        bar.set_length(progress.total as u64);
        bar.set_position(progress.done as u64);
        bar.set_message(progress.piece.to_owned());
    };
    let result = work(&Control {
        cancel: interrupt::flag(),
        progress: &report,
    });
    bar.finish_and_clear();
    Ok(result?)
}

fn record_baseline(args: &RecordArgs) -> Result<u8, Failure> {
    let target = args.which.folder()?;
    let exists = target.join(HEAD).is_file();
    let reason = args.accept.as_deref().map(str::trim);
    if exists && reason.is_none_or(str::is_empty) {
        return Err(Failure::input(format!(
            "{} exists; say why its results may change: --accept \"reason\", or choose another name",
            target.display()
        )));
    }
    let mut accepted = if exists {
        args.which.read()?.head.accepted
    } else {
        Vec::new()
    };
    let folder = Folder::prepare(&target, exists)?;
    let made = source::made(&args.which.dir);
    accepted.push(Acceptance {
        date: made.date.clone(),
        commit: made.commit.clone(),
        reason: reason.unwrap_or("first record").to_owned(),
    });
    let options = Options {
        threads: args.running.threads.into(),
        repeats: REPEATS,
        ..Options::default()
    };
    let recorded = with_progress(|control| baseline::record(made, accepted, &options, control))?;
    recorded.write(folder.path())?;
    let out = folder.publish()?;
    let cases: usize = recorded.scenes.iter().map(|scene| scene.cases.len()).sum();
    screen::show(&format!(
        "{} scenes, {cases} cases, {} kB in {}\nlook at the diff before you commit it",
        recorded.scenes.len(),
        size(&out) / 1000,
        out.display()
    ))?;
    Ok(0)
}

/// Runs of each case of a record, of which the shortest is its time.
const REPEATS: usize = 3;

/// Bytes of the files in a folder.
fn size(folder: &Path) -> u64 {
    let files = fs::read_dir(folder).into_iter().flatten().flatten();
    files
        .filter_map(|file| file.metadata().ok())
        .map(|data| data.len())
        .sum()
}

/// `summary.json`.
#[derive(Serialize)]
struct Summary<'a> {
    pinwheel_version: &'static str,
    command: &'a str,
    baseline: &'a Head,
    check: &'a Check,
    machine: &'a Machine,
}

fn check(args: &CheckArgs) -> Result<u8, Failure> {
    let accepted = args.which.read()?;
    let name = &args.which.name;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("out/baseline-{name}")));
    let folder = Folder::prepare(&out, args.force)?;
    let options = Options {
        kernel: args.kernel.into(),
        threads: args.running.threads.into(),
        repeats: args.repeats.into(),
        only: args.only.clone(),
        judge_time: args.judge_time,
    };
    let here = Made {
        vectors: options.kernel.vectors().to_owned(),
        ..source::made(&args.which.dir)
    };
    let found = with_progress(|control| baseline::check(&accepted, here, &options, control))?;

    let (command, machine) = (typed(args), Machine::here());
    let html = page::page(name, &accepted.head, &found, &command, &machine)?;
    record::write_text(&folder.path().join("index.html"), &html)?;
    record::write_json(
        &folder.path().join("summary.json"),
        &Summary {
            pinwheel_version: env!("CARGO_PKG_VERSION"),
            command: &command,
            baseline: &accepted.head,
            check: &found,
            machine: &machine,
        },
    )?;
    let out = folder.publish()?;
    screen::show(&in_words(&found, &out.join("index.html")))?;
    Ok(if found.verdict == Verdict::Worse {
        EXCEEDED
    } else {
        0
    })
}

/// The command again, as one would type it.
fn typed(args: &CheckArgs) -> String {
    let mut words = format!("pinwheel baseline check {}", quoted(&args.which.name));
    if !args.only.is_empty() {
        words.push_str(&format!(" --only {}", args.only.join(",")));
    }
    if args.kernel != args::Loop::Best {
        words.push_str(&format!(" --loop {:?}", args.kernel).to_lowercase());
    }
    words
}

fn in_words(found: &Check, page: &Path) -> String {
    let mut rows = vec![
        table::COLUMNS
            .map(|title| Cell::text(title).styled(TITLE))
            .to_vec(),
    ];
    for (verdict, row) in table::rows(found) {
        let style = match verdict {
            Verdict::Worse => BAD,
            Verdict::Better => GOOD,
            Verdict::Changed => TITLE,
            Verdict::Same => QUIET,
        };
        let cells = row
            .into_iter()
            .enumerate()
            .map(|(column, text)| match column {
                2 => Cell::text(text).styled(style),
                4 => Cell::figure(text),
                _ => Cell::text(text),
            });
        rows.push(cells.collect());
    }
    format!(
        "{}\n{}\n{}",
        lines(&rows),
        table::sentence(found),
        page.display()
    )
}

/// One baseline of a list.
#[derive(Serialize)]
struct Listed {
    name: String,
    #[serde(flatten)]
    head: Head,
}

fn list(args: &ListArgs) -> Result<u8, Failure> {
    let mut listed = Vec::new();
    for name in Baseline::names(&args.dir) {
        let which = Which {
            name,
            dir: args.dir.clone(),
        };
        let head = which.read()?.head;
        listed.push(Listed {
            name: which.name,
            head,
        });
    }
    if args.json {
        screen::show_json(&listed)?;
        return Ok(0);
    }
    if listed.is_empty() {
        screen::show(&format!(
            "no baselines in {}; `pinwheel baseline record` makes one",
            args.dir.display()
        ))?;
        return Ok(0);
    }
    let mut text = String::new();
    for Listed { name, head } in &listed {
        let made = &head.made;
        text.push_str(&format!(
            "{}  {} scenes, made {} at commit {}, {} build, {}\n",
            styled(TITLE, name),
            head.scenes.len(),
            made.date,
            made.commit,
            made.build,
            made.vectors
        ));
        let rows: Vec<Vec<Cell>> = head
            .accepted
            .iter()
            .map(|a| {
                vec![
                    Cell::text("  "),
                    Cell::text(&a.date),
                    Cell::text(&a.commit),
                    Cell::text(&a.reason),
                ]
            })
            .collect();
        text.push_str(&lines(&rows));
    }
    screen::show(&text)?;
    Ok(0)
}
