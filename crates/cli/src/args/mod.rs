//! Definition of the command line; it calls no command.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::error::ErrorKind;
use clap::{Args, FromArgMatches as _, Parser, Subcommand};
use pinwheel::gearbox::Gearbox;
use pinwheel::scene::{Override, Scene, preset};
use pinwheel::studies::output::file_name;

use crate::failure::Failure;
use crate::{screen, words};

mod baseline;
mod bench;
mod design;
mod explore;
mod fmu;
pub(crate) mod manner;
mod named;
mod paper;
mod solver;
mod stability;
mod sweep;

pub(crate) use baseline::{Action, BaselineArgs, CheckArgs, RecordBaselineArgs, Which};
pub(crate) use bench::BenchArgs;
pub(crate) use design::{DesignArgs, InitArgs};
pub(crate) use explore::ExploreArgs;
pub(crate) use fmu::FmuArgs;
use manner::Manner;
pub(crate) use paper::PaperArgs;
pub(crate) use solver::{SolverAction, SolverArgs, Solvers};
pub(crate) use stability::StabilityArgs;
pub(crate) use sweep::SweepArgs;

const EXAMPLES: &str = include_str!("../../help/pinwheel.txt");

/// Cross-validation of cycloidal gearbox dynamics: one scene, several engines, one report.
#[derive(Debug, Parser)]
#[command(name = "pinwheel", version, after_help = EXAMPLES, max_term_width = 80)]
#[command(
    arg_required_else_help = true,
    disable_help_subcommand = true,
    disable_help_flag = true
)]
struct Program {
    /// Print help.
    #[arg(long, short, global = true, hide = true, action = clap::ArgAction::HelpShort)]
    help: Option<bool>,
    #[command(subcommand)]
    command: Command,
    #[command(flatten)]
    manner: Manner,
}

/// Command to run.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run one engine: time series, peaks, numerical error.
    Run(RunArgs),
    /// Compare several engines, or two designs.
    Compare(CompareArgs),
    /// Measure the cost of accuracy: error against time of methods.
    Bench(BenchArgs),
    /// Store time series of Python engines, for builds without them.
    Record(RecordArgs),
    /// Explain a scene: model, omissions, expected figures.
    Explain(ExplainArgs),
    /// Make a scene from catalogue data, with suggestions.
    Init(InitArgs),
    /// Compute lost motion, stiffness, transmission error, forces.
    Design(DesignArgs),
    /// Move a gear's keys in the browser; motion and figures follow.
    Explore(ExploreArgs),
    /// Make a co-simulation unit for Simulink, Modelica, Adams.
    Fmu(FmuArgs),
    /// Run lists, ranges or tolerances of keys, over all cores.
    Sweep(SweepArgs),
    /// List the engines of this build.
    #[command(after_help = include_str!("../../help/engines.txt"))]
    Engines(JsonArgs),
    /// Find the stable steps of each method on hard scenes.
    Stability(StabilityArgs),
    /// List the contact laws: source, domain, slow impacts.
    #[command(after_help = include_str!("../../help/laws.txt").trim_ascii_end())]
    Laws(JsonArgs),
    /// Print the JSON schema of scenes, for editors.
    #[command(after_help = include_str!("../../help/schema.txt"))]
    Schema {
        /// The schema of job files (scene.json) for external solvers.
        #[arg(long)]
        job: bool,
    },
    /// Recompute every figure and claim of the paper.
    Paper(PaperArgs),
    /// Write, check and serve your own solver.
    Solver(SolverArgs),
    /// Store accepted results, and report changes.
    Baseline(BaselineArgs),
    /// Open the newest page, or that of a folder, in the browser.
    Open(OpenArgs),
    /// Print the completions of a shell.
    #[command(after_help = include_str!("../../help/completions.txt").trim_ascii_end())]
    Completions {
        /// Which shell.
        shell: clap_complete::Shell,
    },
}

/// Selected scene.
#[derive(Debug, Args)]
pub(crate) struct SceneArgs {
    /// Scene file (TOML) or preset name.
    pub(crate) scene: String,
    /// Override a key, e.g. gear.backlash_m=0.0006; repeatable.
    #[arg(long, value_name = "KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

/// Output folder and form of the results.
#[derive(Debug, Args)]
pub(crate) struct OutArgs {
    /// Output folder, replaced as a whole [default: one in out/].
    #[arg(long, short, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Replace an output that was changed, or of another scene.
    #[arg(long)]
    pub(crate) force: bool,
    /// Results as JSON on stdout.
    #[arg(long, conflicts_with = "quiet")]
    json: bool,
}

/// `pinwheel run`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/run.txt").trim_ascii_end())]
pub(crate) struct RunArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// Engine, see `pinwheel engines`; `native` takes the formulation that the scene asks for [default: native].
    #[arg(long, value_name = "NAME")]
    pub(crate) engine: Option<String>,
    #[command(flatten)]
    pub(crate) solvers: Solvers,
    /// Do not repeat the run at twice its step to check that the step resolves the scene (native engines).
    #[arg(long)]
    pub(crate) unchecked: bool,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

/// `pinwheel compare`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/compare.txt").trim_ascii_end())]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    /// A second scene: two designs by one engine instead of one by several [default engine: native].
    #[arg(conflicts_with_all = ["junit", "against", "jobs", "fresh"])]
    pub(crate) other: Option<String>,
    /// Engines to compare, separated by commas [default: all that can run the scene].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// CPU seconds permitted to all runs of one engine; no further refinement beyond.
    #[arg(long, value_name = "SECONDS", default_value_t = 30.0)]
    pub(crate) longest: f64,
    /// Required resolution: the largest relative U of a resolved pair.
    #[arg(long, value_name = "SHARE", default_value_t = 0.01)]
    pub(crate) resolution: f64,
    #[command(flatten)]
    pub(crate) solvers: Solvers,
    /// Engines that run at a time [default: as many as there are cores].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) jobs: Option<u16>,
    /// Run every engine anew, also those with stored runs.
    #[arg(long)]
    pub(crate) fresh: bool,
    /// Internal: store the runs of an engine, given by name and divergence, and end.
    #[arg(long, hide = true)]
    pub(crate) ahead: Option<String>,
    /// Write the verdicts as a JUnit file, too, for CI systems.
    #[arg(long, value_name = "FILE")]
    pub(crate) junit: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) foreign: ForeignArgs,
    #[command(flatten)]
    pub(crate) out: OutArgs,
}

/// Foreign data.
#[derive(Debug, Args)]
pub(crate) struct ForeignArgs {
    /// A foreign CSV (Adams, RecurDyn, a test rig) to compare with; may be repeated. Needs --map.
    #[arg(long, value_name = "FILE", requires = "map")]
    pub(crate) against: Vec<PathBuf>,
    /// Map of its columns (TOML, see docs/foreign-data.md): one for each --against, or one for all.
    #[arg(long, value_name = "MAP.toml", requires = "against")]
    pub(crate) map: Vec<PathBuf>,
}

/// `pinwheel record`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/record.txt").trim_ascii_end())]
pub(crate) struct RecordArgs {
    /// Presets or scene files [default: all recorded scenes].
    pub(crate) scenes: Vec<String>,
    /// Engines to record, separated by commas [default: all Python engines of this build].
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    pub(crate) engines: Vec<String>,
    /// Folder of recordings.
    #[arg(long, short, value_name = "DIR", default_value = "reference/recorded")]
    pub(crate) out: PathBuf,
}

/// Choice of text or JSON.
#[derive(Debug, Args)]
pub(crate) struct JsonArgs {
    /// Write JSON, for programs.
    #[arg(long)]
    pub(crate) json: bool,
}

/// `pinwheel explain`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/explain.txt").trim_ascii_end())]
pub(crate) struct ExplainArgs {
    #[command(flatten)]
    pub(crate) scene: SceneArgs,
    #[command(flatten)]
    pub(crate) out: JsonArgs,
}

/// `pinwheel open`.
#[derive(Debug, Args)]
#[command(after_help = include_str!("../../help/open.txt").trim_ascii_end())]
pub(crate) struct OpenArgs {
    /// Output folder or page [default: the newest output in out/].
    pub(crate) place: Option<PathBuf>,
    /// Only print the page's path, without a browser.
    #[arg(long)]
    pub(crate) print: bool,
}

/// Meaning of the exit status, in the words of `pinwheel --help`, the README and docs/verdicts.md.
pub(crate) const STATUS: &str = "\
Exit status: 0 done, and something was shown of each thing that you brought (a
solver, a record, a limit, a baseline; without any, a pair of engines agrees),
1 something differs or is worse, 2 wrong input, 3 an engine is missing, diverged
or failed, 4 nothing was shown of something, or it is inconclusive and a setting
of yours would settle it, 130 interrupted.";

/// Commands by purpose.
const GROUPS: [(&str, &str); 4] = [
    ("Design a gear", "init explain design explore fmu"),
    ("Run and compare", "run compare open"),
    ("Study", "sweep bench stability paper"),
    (
        "Tools",
        "engines laws solver record baseline schema completions",
    ),
];

/// Returns the template of the program's own help: commands in groups, one a line.
fn by_groups(program: &clap::Command) -> String {
    let mut text = "{about}\n\n{usage-heading} {usage}\n".to_owned();
    for (group, names) in GROUPS {
        let _ = writeln!(text, "\n{group}:");
        for name in names.split(' ') {
            let about = program
                .find_subcommand(name)
                .and_then(|one| one.get_about());
            let about = about.map_or_else(String::new, ToString::to_string);
            let _ = writeln!(text, "  {name:<13}{about}");
        }
    }
    text.trim_end().to_owned() + "\n\n{before-help}{after-help}"
}

/// Options of every command and the exit status, as the help of one command has them.
const COMMON: &str = "\
Every command: -q, --quiet; -v, --verbose; --color auto, always or never; -h.
Status: 0 done, 1 differs, 2 input, 3 engine, 4 not shown: `pinwheel --help`.";

/// Options of every command, in place of a paragraph for each in every help.
const EVERYWHERE: &str = "\
Every command: -q, --quiet (no progress); -v, --verbose (files written, figures
of every engine); --color auto, always or never; -h, --help;
`pinwheel --version`.";

/// Puts the examples of a command before its options, and the rest of its text behind them.
fn examples_first(command: clap::Command) -> clap::Command {
    let text = command.get_after_help().map(ToString::to_string);
    let text = text.unwrap_or_default();
    let (examples, rest) = text.split_once("\n\n").unwrap_or((&text, ""));
    let mut rest = rest.trim_end().to_owned();
    let before = match examples {
        "" => "",
        _ => "{before-help}",
    };
    let parts = match command.get_name() {
        "pinwheel" => [EVERYWHERE, STATUS].as_slice(),
        _ => &[COMMON],
    };
    for part in parts {
        let gap = if rest.is_empty() { "" } else { "\n\n" };
        let _ = write!(rest, "{gap}{part}");
    }
    // A negative number is a wrong value, and no unknown option.
    let with_negative = |arg: clap::Arg| {
        let takes = arg.get_action().takes_values() && !arg.is_positional();
        arg.allow_negative_numbers(takes)
    };
    command
        .mut_args(with_negative)
        .mut_subcommands(examples_first)
        .before_help(examples.trim_end().to_owned())
        .help_template(format!(
            "{{about}}\n\n{{usage-heading}} {{usage}}\n\n{before}{{all-args}}{{after-help}}"
        ))
        .after_help(rest)
}

/// Returns the definition of the command line.
pub(crate) fn definition() -> clap::Command {
    let program = examples_first(<Program as clap::CommandFactory>::command());
    let help = by_groups(&program);
    program.help_template(help)
}

/// Returns the command to run; `None` after showing help or version.
pub(crate) fn parse() -> Result<Option<Command>, Failure> {
    let matches = definition().try_get_matches_from(words::all());
    let json = matches.as_ref().is_ok_and(wants_json);
    let typed = matches
        .as_ref()
        .ok()
        .and_then(|typed| typed.subcommand_name());
    let mut names = GROUPS.iter().flat_map(|(_, names)| names.split(' '));
    let command = names.find(|name| typed == Some(name)).unwrap_or_default();
    match matches.and_then(|matches| Program::from_arg_matches(&matches)) {
        Ok(program) => {
            screen::speak(Manner {
                json,
                command,
                ..program.manner
            });
            Ok(Some(program.command))
        }
        Err(error) => match error.kind() {
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion => {
                screen::show(&error.render().ansi().to_string())?;
                Ok(None)
            }
            ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand => {
                screen::show_on_stderr(&error.render().ansi().to_string());
                Err(Failure::input("no command given; see the examples above"))
            }
            _ => {
                let words = words::all().iter().filter_map(|word| word.to_str());
                let message = error.render().to_string();
                Err(Failure::input(on_one_line(&message, &asked(words))))
            }
        },
    }
}

/// True if the typed command has `--json`.
fn wants_json(matches: &clap::ArgMatches) -> bool {
    let own = matches.try_get_one::<bool>("json");
    let own = own.ok().flatten().copied().unwrap_or(false);
    let command = matches.subcommand();
    own || command.is_some_and(|(_, matches)| wants_json(matches))
}

/// Returns the program's name with the typed command, if that exists.
fn asked<'a>(words: impl Iterator<Item = &'a str>) -> String {
    let of = definition();
    let is_command = |word: &&str| of.find_subcommand(word).is_some();
    let mut asked = vec!["pinwheel"];
    asked.extend(words.skip(1).find(is_command));
    asked.join(" ")
}

/// Returns clap's message on one line: fault, tip, and the command with the help, from the message or else `asked`.
fn on_one_line(message: &str, asked: &str) -> String {
    let mut what: Vec<&str> = Vec::new();
    let mut tips: Vec<&str> = Vec::new();
    let mut help = asked.to_owned();
    let lines = message.lines().map(str::trim);
    for line in lines.filter(|line| !line.is_empty()) {
        if let Some(usage) = line.strip_prefix("Usage:") {
            let bare = |word: &&str| word.starts_with(|c: char| c.is_ascii_lowercase());
            let words: Vec<&str> = usage.split_whitespace().take_while(bare).collect();
            help = words.join(" ");
            break;
        }
        if line.starts_with("For more information") {
            break;
        }
        match line.strip_prefix("tip: ") {
            Some(tip) => tips.push(tip),
            None => what.push(line.strip_prefix("error: ").unwrap_or(line)),
        }
    }
    let see = format!("see `{help} --help`");
    tips.push(&see);
    format!("{}; {}", what.join(" "), tips.join("; "))
}

impl SceneArgs {
    /// Loads, checks and compiles the scene.
    pub(crate) fn load(&self) -> Result<Gearbox, Failure> {
        self.load_as(&self.scene)
    }

    /// Loads another scene with the same overrides.
    pub(crate) fn load_as(&self, spec: &str) -> Result<Gearbox, Failure> {
        let overrides = overrides(&self.set)?;
        let scene = Scene::load(spec, &overrides)?;
        Gearbox::new(&scene).map_err(|error| Failure::input(format!("{spec}: {error}")))
    }
}

/// Returns the output name of a scene or sweep: a preset's own, or its file's, because two files may contain one name.
pub(crate) fn label(spec: &str) -> String {
    let stem = || Path::new(spec).file_stem().unwrap_or_default();
    file_name(&preset(spec).map_or_else(|| stem().to_string_lossy(), |_| spec.into()))
}

impl OutArgs {
    /// Returns the requested folder, or `out/<name>`.
    pub(crate) fn or(&self, name: impl AsRef<Path>) -> PathBuf {
        let out = self.out.clone();
        out.unwrap_or_else(|| Path::new("out").join(name))
    }
}

/// Returns the number of available cores.
pub(crate) fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Parses overrides `KEY=VALUE`.
pub(crate) fn overrides(set: &[String]) -> Result<Vec<Override>, Failure> {
    let parsed = set.iter().map(|text| text.parse());
    Ok(parsed.collect::<Result<_, _>>()?)
}

/// Returns the typed command for the same results, without options for output and threads.
pub(crate) fn typed() -> String {
    without_places(words::typed().map(|word| word.to_string_lossy().into_owned()))
}

fn without_places(words: impl IntoIterator<Item = String>) -> String {
    const VALUED: [&str; 4] = ["--out", "-o", "--jobs", "--color"];
    const BARE: &str = "--force --fresh --resume --quiet -q --verbose -v --json";
    let mut command = "pinwheel".to_owned();
    let mut words = words.into_iter();
    while let Some(word) = words.next() {
        if VALUED.contains(&word.as_str()) {
            words.next();
            continue;
        }
        let flag = word.split_once('=').map_or(word.as_str(), |(flag, _)| flag);
        if !VALUED.contains(&flag) && BARE.split(' ').all(|bare| bare != flag) {
            command.push(' ');
            command.push_str(&quoted(&word));
        }
    }
    command
}

/// Returns a word for a shell, in single quotes if necessary.
pub(crate) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./=,:+".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory as _;

    use super::*;

    #[test]
    fn the_definition_is_sound() {
        Program::command().debug_assert();
    }

    #[test]
    fn every_command_is_in_one_group_on_a_line() {
        let mut of = definition();
        let grouped = || GROUPS.iter().flat_map(|(_, names)| names.split(' '));
        let known: Vec<&str> = of.get_subcommands().map(clap::Command::get_name).collect();
        for name in &known {
            assert_eq!(grouped().filter(|other| other == name).count(), 1, "{name}");
        }
        assert_eq!(grouped().count(), known.len());
        for line in of.render_help().to_string().lines() {
            assert!(line.chars().count() <= 80, "{line}");
        }
    }

    /// One flag for each meaning, and each default once.
    #[test]
    fn flags_are_the_same_everywhere() {
        fn look(command: &clap::Command) {
            let name = command.get_name();
            for flag in command.get_arguments() {
                if flag.get_id() == "out" {
                    assert_eq!(flag.get_short(), Some('o'), "{name}");
                }
                assert_ne!(flag.get_long(), Some("threads"), "{name}");
                let help = flag.get_help().map(ToString::to_string).unwrap_or_default();
                let stated = help.contains("[default:") && !flag.get_default_values().is_empty();
                assert!(!stated, "{name}: {help}");
            }
            command.get_subcommands().for_each(look);
        }
        look(&definition());
    }

    /// Output options work for every command, and JSON for every command with results.
    #[test]
    fn every_command_speaks_as_it_is_asked() {
        fn look(command: &clap::Command) {
            let name = command.get_name();
            let of = |long: &str| {
                command
                    .get_arguments()
                    .find(|flag| flag.get_long() == Some(long))
            };
            for (long, short) in [
                ("quiet", Some('q')),
                ("verbose", Some('v')),
                ("color", None),
            ] {
                let flag = of(long).unwrap_or_else(|| panic!("{name} has no --{long}"));
                assert_eq!(flag.get_short(), short, "{name}");
            }
            // A results folder also has a file for programs.
            assert!(
                of("force").is_none() || of("json").is_some() || name == "init",
                "{name}"
            );
            command.get_subcommands().for_each(look);
        }
        let mut all = definition();
        all.build();
        let ours = |command: &&clap::Command| command.get_name() != "help";
        all.get_subcommands().filter(ours).for_each(look);
    }

    #[test]
    fn examples_fit_a_screen() {
        fn look(command: &clap::Command) {
            let examples = command.get_after_help().map(ToString::to_string);
            for line in examples.unwrap_or_default().lines() {
                let wide = line.chars().count();
                assert!(wide <= 80, "{}: {wide}: {line}", command.get_name());
            }
            command.get_subcommands().for_each(look);
        }
        look(&definition());
    }

    #[test]
    fn documents_explain_the_status_in_the_words_of_the_help() {
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let status = words(STATUS).replace("Exit status: ", "");
        for document in [
            include_str!("../../../../README.md"),
            include_str!("../../../../docs/verdicts.md"),
        ] {
            assert!(words(document).contains(&status));
        }
    }

    #[test]
    fn every_preset_is_in_the_help() {
        for preset in pinwheel::scene::PRESETS {
            let named = preset.name.starts_with("hard-") || EXAMPLES.contains(preset.name);
            assert!(named, "{}", preset.name);
        }
    }

    #[test]
    fn usage_errors_fit_on_a_line() {
        for (words, help) in [
            (&["pinwheel", "rnu"][..], "see `pinwheel --help`"),
            (&["pinwheel", "run"], "see `pinwheel run --help`"),
            (
                &["pinwheel", "compare", "paper", "--egnines", "x"],
                "see `pinwheel compare --help`",
            ),
            (
                &["pinwheel", "run", "paper", "--set"],
                "see `pinwheel run --help`",
            ),
            (
                &["pinwheel", "init", "mine.toml", "--ratio", "1"],
                "see `pinwheel init --help`",
            ),
            (
                &["pinwheel", "baseline", "check", "more", "and"],
                "see `pinwheel baseline check --help`",
            ),
        ] {
            let error = Program::try_parse_from(words).unwrap_err();
            let asked = asked(words.iter().copied());
            let line = on_one_line(&error.render().to_string(), &asked);
            assert!(!line.contains('\n') && line.ends_with(help), "{line}");
        }
    }

    #[test]
    fn default_folders_stay_inside_out() {
        let out = OutArgs {
            out: None,
            force: false,
            json: false,
        };
        for (spec, folder) in [
            ("paper", "out/paper-run"),
            ("../evil.toml", "out/evil-run"),
            ("a/b c-explored.toml", "out/b-c-explored-run"),
            ("..", "out/unnamed-run"),
        ] {
            let name = format!("{}-run", label(spec));
            assert_eq!(out.or(name), PathBuf::from(folder));
        }
    }

    #[test]
    fn the_command_again() {
        let again = |words: &str| without_places(words.split(' ').map(str::to_owned));
        assert_eq!(
            again("compare paper --out x --set a=b --force"),
            "pinwheel compare paper --set a=b"
        );
        assert_eq!(
            again(
                "sweep it's.toml --out=x --jobs 3 --resume -q --color never --json --engines=a,b"
            ),
            "pinwheel sweep 'it'\\''s.toml' --engines=a,b"
        );
    }
}
