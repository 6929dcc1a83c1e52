//! Kills at random moments, over all commands that write: no torn file, no lost data, and remains are reported.
//!
//! `PINWHEEL_KILLS=20` sets the number of kills of every command (2), `PINWHEEL_KILLS_SEED` the moments, and
//! `PINWHEEL_KILLS_ONLY=init` a single command.
#![cfg(unix)]

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use pinwheel::studies::rng::Rng;
use pinwheel_tests::{names_in, pinwheel};

/// Number of kills of every command in an ordinary run.
const KILLS: u64 = 2;
const SIGNALS: [&str; 3] = ["KILL", "TERM", "INT"];

/// Command that writes `out`.
struct Writer {
    /// Words after `pinwheel`.
    words: &'static str,
    /// Output below the working folder: a folder or a single file.
    out: &'static str,
    /// Files of `out` that are equal after every complete run, with kills and resumes or without.
    same: &'static [&'static str],
    /// Command that continues after a kill.
    resume: Option<&'static str>,
    /// True if it takes many seconds: only with more than [`KILLS`] kills, as the weekly workflow has them.
    dear: bool,
}

const SWEEP: &str = "name = \"s\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.02\n\
    [vary]\ngear.backlash_m = { from = 0.0, to = 3.0e-4, points = 12 }\n";

static WRITERS: [Writer; 14] = [
    writer(
        "run paper --set solver.duration_s=0.1 --out out",
        "out",
        &["courses.csv"],
    ),
    writer(
        "compare paper --engines native,rapier-shared-law --longest 1 --set solver.duration_s=0.004 --out out",
        "out",
        &[],
    ),
    writer(
        "bench paper --engines native-reduced --methods rk4 --repeats 1 --set solver.duration_s=0.004 --out out",
        "out",
        &[],
    ),
    writer(
        "stability mine.toml one-wheel --quick --jobs 1 --out out",
        "out",
        &[],
    )
    .resumed(),
    writer(
        "sweep s.toml --jobs 1 --out out",
        "out",
        &["results.csv", "sweep.toml"],
    )
    .resumed(),
    writer("paper --figures 9 --out out", "out", &[]).dear(),
    writer(
        "record mine.toml --engines rapier-shared-law --out out",
        "out/mine",
        &["rapier-shared-law.csv"],
    ),
    writer(
        "baseline check --dir bl --only flores --out out",
        "out",
        &[],
    ),
    writer(
        "compare paper one-wheel --set solver.duration_s=0.004 --out out",
        "out",
        &[],
    ),
    writer(
        "compare paper --engines native-reduced,native-resolved --longest 1 --set solver.duration_s=0.004 --junit verdicts.xml --force --out out",
        "verdicts.xml",
        &[],
    ),
    writer(
        "design mine.toml --out out",
        "out",
        &["torsion.csv", "hysteresis.csv", "disc_0.dxf"],
    ),
    writer(
        "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500 --force",
        "gear.toml",
        &["gear.toml"],
    ),
    writer("fmu mine.toml --out gear.fmu", "gear.fmu", &["gear.fmu"]),
    writer("baseline record --dir out new", "out/new", &[]).dear(),
];

const fn writer(words: &'static str, out: &'static str, same: &'static [&'static str]) -> Writer {
    Writer {
        words,
        out,
        same,
        resume: None,
        dear: false,
    }
}

impl Writer {
    /// Returns the command with the option to continue.
    const fn resumed(self) -> Self {
        Self {
            resume: Some("--resume"),
            ..self
        }
    }

    const fn dear(self) -> Self {
        Self { dear: true, ..self }
    }

    fn words(&self) -> Vec<&'static str> {
        self.words.split(' ').collect()
    }
}

/// Returns every file below a folder with its content, or the single file; without the manifest and without drafts, which a
/// kill leaves.
fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let (mut files, mut open) = (BTreeMap::new(), vec![folder.to_owned()]);
    if folder.is_file() {
        let name = folder.file_name().unwrap().into();
        return BTreeMap::from([(name, fs::read(folder).unwrap())]);
    }
    while let Some(place) = open.pop() {
        for name in names_in(&place) {
            let path = place.join(name);
            if is_hidden(&path) {
            } else if path.is_dir() {
                open.push(path);
            } else {
                files.insert(
                    path.strip_prefix(folder).unwrap().to_owned(),
                    fs::read(&path).unwrap(),
                );
            }
        }
    }
    files
}

/// Writes the inputs of all commands.
fn inputs(dir: &Path) {
    fs::write(dir.join("s.toml"), SWEEP).unwrap();
    fs::write(
        dir.join("mine.toml"),
        "base = \"paper\"\n[solver]\nduration_s = 0.02\n",
    )
    .unwrap();
    let (from, to) = (
        pinwheel_tests::repository("reference/baselines/accepted"),
        dir.join("bl/accepted"),
    );
    fs::create_dir_all(&to).unwrap();
    for name in names_in(&from) {
        fs::copy(from.join(&name), to.join(&name)).unwrap();
    }
}

/// Returns the drafts below a folder.
fn hidden(dir: &Path) -> Vec<PathBuf> {
    let below = |name: String| {
        let path = dir.join(name);
        match is_hidden(&path) {
            true => vec![path],
            false => hidden(&path),
        }
    };
    names_in(dir).into_iter().flat_map(below).collect()
}

fn is_hidden(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().starts_with(".pinwheel-")
}

fn start(dir: &Path, words: &[&str]) -> Child {
    let mut command = pinwheel();
    command.env("SOURCE_DATE_EPOCH", "0"); // units contain the time of their creation
    command
        .current_dir(dir)
        .args(words)
        .stdin(Stdio::null())
        .stdout(Stdio::null());
    command
        .stderr(fs::File::create(dir.join("log")).unwrap())
        .spawn()
        .unwrap()
}

fn ended(child: &mut Child, seconds: f64) -> ExitStatus {
    let start = Instant::now();
    loop {
        if let Some(status) = child.try_wait().unwrap() {
            return status;
        }
        assert!(start.elapsed().as_secs_f64() < seconds, "it does not end");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Checks that an output is complete, listed by its marker, with readable JSON.
fn assert_complete(writer: &Writer, out: &Path) {
    let what = writer.words;
    let files = content(out);
    assert!(!files.is_empty(), "{what}: an empty output");
    for (name, bytes) in &files {
        assert!(!bytes.is_empty(), "{what}: {} is empty", name.display());
        if name.extension().is_some_and(|ending| ending == "json") {
            let read: Result<serde_json::Value, _> = serde_json::from_slice(bytes);
            assert!(read.is_ok(), "{what}: {} is torn", name.display());
        }
        if name.extension().is_some_and(|ending| ending == "toml") {
            let read: Result<toml::Table, _> = toml::from_str(std::str::from_utf8(bytes).unwrap());
            assert!(read.is_ok(), "{what}: {} is torn", name.display());
        }
        if name.extension().is_some_and(|ending| ending == "html") {
            assert!(
                bytes.trim_ascii_end().ends_with(b"</html>"),
                "{what}: {} is torn",
                name.display()
            );
        }
    }
    let Ok(mark) = fs::read_to_string(out.join(".pinwheel")) else {
        return;
    };
    let mark: serde_json::Value = serde_json::from_str(&mark).unwrap();
    let listed: Vec<&String> = mark["files"].as_object().unwrap().keys().collect();
    let there: Vec<String> = files
        .keys()
        .map(|name| name.display().to_string())
        .collect();
    assert!(listed.into_iter().eq(&there), "{what}: its list");
}

/// Runs a writer once to its end, then kills it repeatedly; returns the number of kills of a running program.
fn kill(writer: &Writer, kills: usize, random: &mut Rng) -> usize {
    let dir = tempfile::tempdir().unwrap();
    let dir = dir.path();
    inputs(dir);
    let what = writer.words;
    let out = dir.join(writer.out);
    let kept: Vec<String> = names_in(dir);
    let before = content(dir);
    let begin = Instant::now();
    let status = ended(&mut start(dir, &writer.words()), 300.0);
    let lasted = begin.elapsed().as_secs_f64();
    let log = fs::read_to_string(dir.join("log")).unwrap();
    assert!(
        status.code().is_some_and(|code| code < 2),
        "{what}: {status}, {log}"
    );
    assert_complete(writer, &out);
    let undisturbed = content(&out);
    // Half of the kills occur with an earlier output in place, half without.
    let mut met = 0;
    for number in 0..kills {
        let fresh = number % 2 == 1;
        if fresh {
            let place = dir.join(writer.words_out());
            fs::remove_file(&place)
                .or_else(|_| fs::remove_dir_all(&place))
                .unwrap_or_default();
        }
        let earlier = fresh.then(BTreeMap::new).unwrap_or_else(|| content(&out));
        let signal = SIGNALS[(3.0 * random.share()) as usize];
        let mut words = writer.words();
        // An interrupted sweep needs an option.
        let begun = dir.join("out.unfinished").exists();
        if writer.goes_on(&out) && (begun || number % 2 == 1) {
            words.extend(writer.resume);
        }
        if writer.out == "out/new" && !earlier.is_empty() {
            words.extend(["--accept", "killed"]);
        }
        let left = hidden(dir);
        let mut child = start(dir, &words);
        std::thread::sleep(Duration::from_secs_f64(1.1 * lasted * random.share()));
        let alive = child.try_wait().unwrap().is_none();
        let sent = Command::new("kill")
            .args([&format!("-{signal}"), &child.id().to_string()])
            .stderr(Stdio::null())
            .status();
        assert!(!alive || sent.unwrap().success());
        met += usize::from(alive);
        let status = ended(&mut child, 60.0);
        let log = fs::read_to_string(dir.join("log")).unwrap();
        let case = format!("{what}: {signal}, {status}, {log}");
        assert!(!log.contains("panicked"), "{case}");
        let by_signal = signal == "KILL" && status.signal() == Some(9);
        // A signal before the handler is installed ends the program at once.
        let early = status.signal().is_some() && !log.contains("error");
        assert!(
            by_signal || early || [Some(0), Some(1), Some(130)].contains(&status.code()),
            "{case}"
        );
        // The output is the earlier one or a complete new one.
        let now = content(&out);
        if now != earlier {
            assert_complete(writer, &out);
        }
        // No run removes earlier drafts, and a program that ends by itself leaves none.
        let now = hidden(dir);
        assert!(left.iter().all(|draft| now.contains(draft)), "{case}");
        assert!(
            now.len() == left.len() || status.signal().is_some(),
            "{case}: {now:?}"
        );
        for name in ["s.toml", "mine.toml"] {
            assert_eq!(
                fs::read(dir.join(name)).ok(),
                before.get(Path::new(name)).cloned(),
                "{case}: an input"
            );
        }
    }
    // A final run to its end: equal results, and a command that removes all drafts.
    let mut words = writer.words();
    if writer.goes_on(&out) {
        words.extend(writer.resume);
    }
    if writer.out == "out/new" && out.exists() {
        words.extend(["--accept", "killed"]);
    }
    let status = ended(&mut start(dir, &words), 300.0);
    let log = fs::read_to_string(dir.join("log")).unwrap();
    assert!(
        status.code().is_some_and(|code| code < 2),
        "{what}: {status}, {log}"
    );
    assert_complete(writer, &out);
    for command in log.split('`').filter(|text| text.starts_with("rm -r ")) {
        let removed = Command::new("sh")
            .current_dir(dir)
            .args(["-c", command])
            .status();
        assert!(removed.unwrap().success(), "{what}: {command}");
    }
    assert_eq!(hidden(dir), Vec::<PathBuf>::new(), "{what}: {log}");
    let now = content(&out);
    for name in writer.same {
        let name = Path::new(name);
        assert!(
            undisturbed.contains_key(name),
            "{what}: no {}",
            name.display()
        );
        assert!(
            now.get(name) == undisturbed.get(name),
            "{what}: {} differs",
            name.display()
        );
    }
    let names: Vec<&str> = now.keys().filter_map(|name| name.to_str()).collect();
    let known: Vec<&str> = undisturbed
        .keys()
        .filter_map(|name| name.to_str())
        .collect();
    assert_eq!(names, known, "{what}");
    let mut left = names_in(dir);
    // Partial results of a stopped study, and the tolerances and the schema of a gear, remain beside the output on purpose.
    left.retain(|name| {
        let known = [
            "out",
            "log",
            "out.partial",
            "gear.tolerances.toml",
            "scene.schema.json",
            writer.words_out(),
        ];
        !kept.contains(name) && !known.contains(&name.as_str())
    });
    assert!(left.is_empty(), "{what} leaves {left:?}");
    met
}

impl Writer {
    /// True if it continues: a sweep with its journal beside the output, others with their output of the stop.
    fn goes_on(&self, out: &Path) -> bool {
        self.resume.is_some() && (self.words()[0] == "sweep" || out.exists())
    }

    /// Returns the name in the working folder: that of `--out` or `--dir`, or its parent.
    fn words_out(&self) -> &str {
        self.out.split('/').next().unwrap_or(self.out)
    }
}

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).map_or(otherwise, |text| text.parse().expect("a number"))
}

fn kills() -> u64 {
    number("PINWHEEL_KILLS", KILLS)
}

/// Returns the commands of this run with their numbers.
fn writers() -> impl Iterator<Item = (usize, &'static Writer)> {
    let all = WRITERS.iter().enumerate();
    all.filter(|(_, writer)| !writer.dear || kills() > KILLS)
}

#[test]
fn regress_kills_tear_nothing_and_lose_nothing() {
    let kills = kills() as usize;
    let seed = number("PINWHEEL_KILLS_SEED", 1);
    let only = std::env::var("PINWHEEL_KILLS_ONLY").ok();
    let mut all = (0, 0);
    for (place, writer) in writers() {
        if only.as_ref().is_some_and(|only| writer.words()[0] != only) {
            continue;
        }
        let begin = Instant::now();
        let met = kill(writer, kills, &mut Rng::new(1000 * seed + place as u64));
        println!(
            "{:<60} {met} of {kills} kills met it, {:.1} s",
            writer.words,
            begin.elapsed().as_secs_f64()
        );
        all = (all.0 + met, all.1 + kills);
    }
    println!("{} of {} kills met a command at work", all.0, all.1);
    assert!(all.0 > 0, "no kill met anything");
}

/// A limit on the size of files (`ulimit -f`) is an error like a full disk: a line, and no remains.
#[test]
fn regress_a_limit_of_file_sizes_is_an_error() {
    let mut refused = 0;
    for (place, writer) in writers() {
        let what = writer.words;
        // The first byte is refused to every third command, and to all with more kills.
        let sizes = 1 + usize::from(place % 3 == 0 || kills() > KILLS);
        for blocks in ["20", "0"].into_iter().take(sizes) {
            let dir = tempfile::tempdir().unwrap();
            let dir = dir.path();
            inputs(dir);
            let kept = names_in(dir);
            let limited = format!("ulimit -f {blocks}; exec \"$0\" \"$@\"");
            let outcome = Command::new("sh")
                .current_dir(dir)
                .env("PINWHEEL_RUNS", "")
                .args(["-c", &limited])
                .arg(pinwheel().get_program())
                .args(writer.words())
                .output()
                .unwrap();
            let log = String::from_utf8_lossy(&outcome.stderr);
            let case = format!("{what} within {blocks}: {}, {log}", outcome.status);
            match outcome.status.code() {
                Some(0 | 1) => assert_complete(writer, &dir.join(writer.out)),
                Some(2) => {
                    assert!(log.contains("larger than the system allows"), "{case}");
                    assert_eq!(log.lines().count(), 1, "{case}");
                    let mut left = names_in(dir);
                    let journal = names_in(&dir.join("out.unfinished"));
                    // Finished runs stay for --resume.
                    if journal.iter().any(|name| name.starts_with("run-")) {
                        left.retain(|name| name != "out.unfinished");
                    }
                    assert_eq!(left, kept, "{case}");
                    refused += 1;
                }
                _ => panic!("{case}"),
            }
        }
    }
    assert!(refused > WRITERS.len() / 2, "{refused} were refused");
}
