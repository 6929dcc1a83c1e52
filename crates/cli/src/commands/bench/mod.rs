//! `pinwheel bench`: what accuracy costs in every engine, integrator and step.

mod args;
mod bar;
mod figures;
mod page;
mod page_mechanisms;
mod page_scaling;
mod page_scene;

pub(crate) use args::BenchArgs;

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;

use pinwheel_engines::{Engine, Track, by_name, registry};
use pinwheel_scene::{Scene, did_you_mean};
use pinwheel_studies::precision::mechanisms::{self, MechanismStudy};
use pinwheel_studies::precision::scaling::{self, Scaling};
use pinwheel_studies::precision::{self, CostAt, Options, Ranking, WorkPrecision};
use pinwheel_studies::{Control, StudyError};
use serde::Serialize;

use crate::args::quoted;
use crate::engines;
use crate::failure::{ENGINE, Failure, STOPPED};
use crate::folder::Folder;
use crate::interrupt;
use crate::machine::Machine;
use crate::record;
use crate::screen::{self, QUIET, TITLE, styled};
use crate::table::{Cell, lines};
use args::Part;
use bar::Bar;

/// `summary.json`.
#[derive(Serialize)]
struct Summary<'a> {
    pinwheel_version: &'static str,
    command: &'a str,
    /// False if the user stopped the measurement.
    complete: bool,
    scene: &'a Scene,
    #[serde(skip_serializing_if = "Option::is_none")]
    work_precision: Option<&'a WorkPrecision>,
    /// What errors cost, window by window.
    rankings: &'a [Ranking],
    #[serde(skip_serializing_if = "Option::is_none")]
    scaling: Option<&'a Scaling>,
    #[serde(skip_serializing_if = "Option::is_none")]
    mechanisms: Option<&'a [MechanismStudy]>,
    machine: &'a Machine,
}

/// Everything measured.
pub(crate) struct Measured {
    command: String,
    scene: Scene,
    study: Option<WorkPrecision>,
    scaling: Option<Scaling>,
    mechanisms: Option<Vec<MechanismStudy>>,
    /// What each engine of the study is unlike.
    unequal: Vec<(String, String)>,
    machine: Machine,
}

impl Measured {
    /// Rankings of all windows at the target, then of the whole run at ten times and a tenth of it.
    fn rankings(&self) -> Vec<Ranking> {
        let Some(study) = &self.study else {
            return Vec::new();
        };
        let target = study.options.target;
        let mut rankings: Vec<Ranking> = (0..study.windows.len())
            .map(|window| study.ranking(window, target))
            .collect();
        rankings.extend([10.0 * target, target / 10.0].map(|error| study.ranking(0, error)));
        rankings
    }
}

pub(crate) fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    let (scene, _) = args.scene.load()?;
    let options = options(args)?;
    let engines = chosen(args, &scene)?;
    let folder = Folder::prepare(&args.out.folder(&scene.name, "bench"), args.out.force)?;

    let mut measured = Measured {
        command: typed(args),
        scene: scene.into_scene(),
        study: None,
        scaling: None,
        mechanisms: None,
        unequal: engines
            .iter()
            .map(|engine| (engine.name().to_owned(), engine.differences().to_owned()))
            .collect(),
        machine: Machine::here(),
    };
    let asked = |part: Part| args.parts.contains(&part);
    if asked(Part::Scene) {
        let found = watched("scene", |control| {
            precision::run(&measured.scene, &engines, &options, control)
        })?;
        measured.study = Some(found);
    }
    if asked(Part::Mechanisms) && interrupt::check().is_ok() {
        measured.mechanisms = Some(watched("mechanisms", mechanisms::run)?);
    }
    if asked(Part::Scaling) && interrupt::check().is_ok() {
        match watched("scaling", scaling::run) {
            Ok(found) => measured.scaling = Some(found),
            // What was measured before is worth keeping.
            Err(failure) if failure.code == STOPPED => {}
            Err(failure) => return Err(failure),
        }
    }
    let complete = interrupt::check().is_ok();
    if !complete && measured.study.is_none() && measured.mechanisms.is_none() {
        return Err(Failure::stopped());
    }

    let rankings = measured.rankings();
    write(folder.path(), &measured, &rankings, complete)?;
    let out = if complete {
        folder.publish()?
    } else {
        folder.publish_unfinished()?
    };
    screen::show(&shown(&measured, &rankings, &out))?;
    if !complete {
        screen::complain("stopped; what had been measured until then was written");
        return Ok(STOPPED);
    }
    Ok(ended(args, &measured))
}

/// 3 if an engine that was asked for by name gave no point at all.
fn ended(args: &BenchArgs, measured: &Measured) -> u8 {
    let series = measured.study.iter().flat_map(|study| &study.series);
    let silent = series.into_iter().find_map(|series| {
        let reason = figures::failure(series)?;
        Some((series.label(), reason))
    });
    match silent {
        Some((label, reason)) if !args.engines.is_empty() => {
            screen::complain(&format!(
                "{label} gave no result: {reason}; leave it out with --engines, or change the scene"
            ));
            ENGINE
        }
        _ => 0,
    }
}

/// Runs a part of the study under a progress bar.
fn watched<T>(
    part: &str,
    study: impl FnOnce(&Control<'_>) -> Result<T, StudyError>,
) -> Result<T, Failure> {
    let bar = Bar::new(part);
    let report = |progress: pinwheel_studies::Progress<'_>| bar.at(progress);
    let control = Control {
        cancel: interrupt::flag(),
        progress: &report,
    };
    let found = study(&control);
    bar.finish();
    found.map_err(|error| match error {
        StudyError::Cancelled => Failure::stopped(),
        StudyError::Load(_) | StudyError::Scene { .. } => Failure::input(error.to_string()),
        other => Failure::engine(other.to_string()),
    })
}

fn options(args: &BenchArgs) -> Result<Options, Failure> {
    let positive = |name: &str, value: f64| {
        if value > 0.0 && value.is_finite() {
            Ok(value)
        } else {
            Err(Failure::input(format!(
                "--{name} {value} is not a positive number; leave it out for the default"
            )))
        }
    };
    let known = precision::method_names();
    for name in &args.methods {
        if !known.contains(&name.as_str()) {
            return Err(Failure::input(format!(
                "there is no integrator `{name}`; {}",
                did_you_mean(name, &known)
            )));
        }
    }
    if args.repeats == 0 {
        return Err(Failure::input(
            "--repeats 0 measures nothing; use 1 or more",
        ));
    }
    let longest_s = positive("longest", args.longest)?;
    Ok(Options {
        target: positive("target", args.target)?,
        repeats: args.repeats,
        longest_s,
        longest_native_s: 0.1 * longest_s,
        methods: args.methods.clone(),
        ..Options::default()
    })
}

/// The engines named, or both native forms and the peers that solve the same equations.
fn chosen(args: &BenchArgs, scene: &Scene) -> Result<Vec<Box<dyn Engine>>, Failure> {
    let native = ["native-reduced", "native-lagrange"];
    if args.engines.is_empty() {
        let friction = scene.contact.friction_coefficient > 0.0;
        return Ok(registry()
            .into_iter()
            .filter(|engine| match engine.track() {
                Track::Native => native.contains(&engine.name()),
                Track::SharedLaw => true,
                Track::OwnContact => friction,
            })
            .collect());
    }
    let mut engines: Vec<Box<dyn Engine>> = Vec::new();
    let mut add = |engine: Box<dyn Engine>| {
        if engine.track() == Track::Native && !native.contains(&engine.name()) {
            return Err(Failure::input(format!(
                "{} chooses its own integrator and step, which is what is varied here; name native, native-reduced \
                 or native-lagrange",
                engine.name()
            )));
        }
        if engines.iter().all(|other| other.name() != engine.name()) {
            engines.push(engine);
        }
        Ok(())
    };
    for name in &args.engines {
        if name.trim() == "native" {
            for engine in native.iter().filter_map(|form| by_name(form, scene)) {
                add(engine)?;
            }
        } else {
            add(engines::find(name.trim(), scene)?)?;
        }
    }
    Ok(engines)
}

/// The command that repeats this measurement.
fn typed(args: &BenchArgs) -> String {
    let mut command = format!("pinwheel bench {}", args.scene.typed());
    for (name, list) in [("engines", &args.engines), ("methods", &args.methods)] {
        if !list.is_empty() {
            command.push_str(&format!(" --{name} {}", quoted(&list.join(","))));
        }
    }
    let default = Options::default();
    if args.target != default.target {
        command.push_str(&format!(" --target {:e}", args.target));
    }
    if args.longest != default.longest_s {
        command.push_str(&format!(" --longest {}", args.longest));
    }
    if args.repeats != default.repeats {
        command.push_str(&format!(" --repeats {}", args.repeats));
    }
    if args.parts.len() < Part::ALL.len() {
        let parts: Vec<String> = args.parts.iter().map(Part::to_string).collect();
        command.push_str(&format!(" --parts {}", parts.join(",")));
    }
    command
}

fn write(
    folder: &Path,
    measured: &Measured,
    rankings: &[Ranking],
    complete: bool,
) -> Result<(), Failure> {
    let page = pinwheel_report::study::render(&page::page(measured, rankings, complete))
        .map_err(|error| Failure::engine(format!("the page cannot be made: {error}")))?;
    record::write_text(&folder.join("index.html"), &page)?;
    let sink = |name: &str| {
        let path = folder.join(name);
        File::create(&path)
            .map(BufWriter::new)
            .map_err(|error| Failure::unwritable(&path, &error))
    };
    let table = |name: &str, outcome: Result<(), StudyError>| {
        outcome.map_err(|error| Failure::unwritable(&folder.join(name), &error))
    };
    if let Some(study) = &measured.study {
        let name = "bench.csv";
        table(name, precision::write_csv(study, sink(name)?))?;
    }
    if let Some(found) = &measured.scaling {
        let name = "scaling.csv";
        table(name, scaling::write_csv(found, sink(name)?))?;
    }
    if let Some(found) = &measured.mechanisms {
        let name = "mechanisms.csv";
        table(name, mechanisms::write_csv(found, sink(name)?))?;
    }
    record::write_json(
        &folder.join("summary.json"),
        &Summary {
            pinwheel_version: env!("CARGO_PKG_VERSION"),
            command: &measured.command,
            complete,
            scene: &measured.scene,
            work_precision: measured.study.as_ref(),
            rankings,
            scaling: measured.scaling.as_ref(),
            mechanisms: measured.mechanisms.as_deref(),
            machine: &measured.machine,
        },
    )
}

/// The table on stdout.
fn shown(measured: &Measured, rankings: &[Ranking], out: &Path) -> String {
    let mut text = String::new();
    if let (Some(study), Some(ranking)) = (&measured.study, rankings.first()) {
        let title = |text: &str| Cell::text(text).styled(TITLE);
        let right = |text: &str| Cell::figure(text).styled(TITLE);
        let mut rows = vec![vec![
            title("engine"),
            right("CPU"),
            right("right-hand sides"),
            title(""),
        ]];
        for (series, entry) in study.series.iter().zip(&ranking.entries) {
            rows.push(vec![
                Cell::text(entry.label.clone()),
                Cell::figure(entry.cpu_s.map_or("-".into(), figures::plain_seconds)),
                Cell::figure(entry.rhs_calls.map_or("-".into(), figures::plain_count)),
                Cell::text(note(series, entry.cpu_s)).styled(QUIET),
            ]);
        }
        text.push_str(&format!(
            "{}\n{}",
            styled(
                TITLE,
                &format!(
                    "{}: cost of a relative L2 force error of {:e} over {} s",
                    study.scene, ranking.error, study.duration_s
                )
            ),
            lines(&rows)
        ));
        text.push_str(&format!(
            "reference: {} against {}, apart {:.1e}\n",
            study.reference.solution.method,
            study.reference.second.method,
            study.reference.error(0).force_l2
        ));
        if let Some(lead) = &ranking.advantage {
            text.push_str(&format!(
                "native ({}) is {}{:.0} times faster than {}\n",
                lead.native,
                if lead.at_least { "at least " } else { "" },
                lead.ratio,
                lead.peer
            ));
        }
    }
    if let Some(fit) = measured.scaling.as_ref().and_then(|s| s.reduced_fit) {
        text.push_str(&format!(
            "cost of a call grows with (wheels x sleeves)^{:.2}\n",
            fit.exponent
        ));
    }
    text.push_str(&format!("report: {}\n", out.join("index.html").display()));
    text
}

fn note(series: &precision::Series, cost: Option<CostAt>) -> String {
    match cost {
        Some(cost) if cost.reached() => String::new(),
        _ => figures::failure(series).unwrap_or_else(|| series.stopped.words().to_owned()),
    }
}
