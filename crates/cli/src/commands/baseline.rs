//! `pinwheel baseline`: what the solver gave when it was last accepted, and what moved since.

use std::fs;
use std::path::{Path, PathBuf};

use pinwheel::pages;
use pinwheel::report::terminal::{Cell, TITLE, lines, styled};
use pinwheel::studies::Provenance;
use pinwheel::studies::baseline::{
    self, Acceptance, Baseline, HEAD, Head, Made, Options, Verdict, made,
};
use pinwheel::studies::output::write_text;
use serde::Serialize;

use crate::args::{self, Action, BaselineArgs, CheckArgs, ListArgs, RecordBaselineArgs, Which};
use crate::failure::{EXCEEDED, Failure};
use crate::folder::{self, Folder};
use crate::progress::watched;
use crate::{interrupt, screen};

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

fn record_baseline(args: &RecordBaselineArgs) -> Result<u8, Failure> {
    let target = args.which.folder()?;
    let exists = target.join(HEAD).is_file();
    let reason = args.accept.as_deref().map(str::trim);
    if exists && reason.is_none_or(str::is_empty) {
        return Err(Failure::input(format!(
            "{} exists; say why its results may change: --accept \"reason\", or choose another name",
            target.display()
        )));
    }
    let earlier = exists.then(|| args.which.read()).transpose()?;
    let known = earlier.as_ref().map_or_else(Vec::new, Baseline::files);
    let mut accepted = earlier.map_or_else(Vec::new, |earlier| earlier.head.accepted);
    interrupt::check()?;
    let folder = Folder::prepare_known(&target, known)?;
    let here = made(&args.which.dir);
    accepted.push(Acceptance {
        date: here.date.clone(),
        commit: here.commit.clone(),
        reason: reason.unwrap_or("first record").to_owned(),
    });
    let options = Options {
        threads: args.running.threads.into(),
        repeats: REPEATS,
        ..Options::default()
    };
    let recorded = watched("baseline", |control| {
        baseline::record(here, accepted, &options, control)
    })?;
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

fn check(args: &CheckArgs) -> Result<u8, Failure> {
    let accepted = args.which.read()?;
    let name = &args.which.name;
    let out = args
        .out
        .clone()
        .unwrap_or_else(|| PathBuf::from(format!("out/baseline-{name}")));
    folder::protect(&out, &[&args.which.dir])?;
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
        ..made(&args.which.dir)
    };
    let found = watched("baseline", |control| {
        baseline::check(&accepted, here, &options, control)
    })?;

    let made = Provenance::here(args::typed());
    baseline::write(&found, &accepted.head, folder.path(), &made)?;
    let page = pages::baseline::page(name, &accepted.head, &found, &made)?;
    write_text(&folder.path().join("index.html"), &page)?;
    let out = folder.publish()?;
    screen::show(&format!(
        "{}\n{}",
        pages::baseline::text(&found),
        out.join("index.html").display()
    ))?;
    Ok(if found.verdict == Verdict::Worse {
        EXCEEDED
    } else {
        0
    })
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
