//! Protection of the user's files, and no unchecked input: attacks on the program, each refused or harmless.

use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use pinwheel_tests::{Outcome, names_in, pinwheel, repository, run_in, words};

const SHORT: [&str; 2] = ["--set", "solver.duration_s=0.002"];

/// A command that takes many seconds and writes into the folder named after it.
const LONG: [&str; 6] = [
    "run",
    "paper",
    "--unchecked",
    "--set",
    "solver.duration_s=20",
    "--out",
];

/// A sweep of eight runs, each of `duration` seconds.
fn sweep_file(dir: &Path, duration: &str) {
    let text = format!(
        "name = \"s\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = {duration}\n\
         [vary]\ngear.backlash_m = {{ from = 0.0, to = 3.0e-4, points = 8 }}\n"
    );
    fs::write(dir.join("s.toml"), text).unwrap();
}

/// Waits for the child to end by itself; ends it after `seconds`.
fn within(mut child: Child, seconds: f64) -> Outcome {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() && start.elapsed().as_secs_f64() < seconds {
        std::thread::sleep(Duration::from_millis(5));
    }
    let _ = child.kill();
    child.wait_with_output().unwrap().into()
}

fn start(dir: &Path, words: &[&str]) -> Child {
    let mut command = pinwheel();
    command.current_dir(dir).args(words).stdin(Stdio::null());
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

fn assert_refused(outcome: &Outcome, part: &str) {
    assert_eq!(outcome.code, Some(2), "{part}: {outcome:?}");
    assert!(outcome.stderr.contains(part), "{part}: {}", outcome.stderr);
    assert_eq!(outcome.stderr.lines().count(), 1, "{}", outcome.stderr);
}

fn interrupt(child: &Child) {
    let mut sent = Command::new("kill");
    let sent = sent.args(["-INT", &child.id().to_string()]);
    assert!(sent.status().unwrap().success());
}

/// Waits for `there`, at most a minute.
fn until(there: impl Fn() -> bool) {
    let start = Instant::now();
    while !there() {
        assert!(start.elapsed() < Duration::from_secs(60), "nothing happens");
        std::thread::sleep(Duration::from_millis(2));
    }
}

#[test]
fn regress_a_scenes_name_is_no_path() {
    let dir = tempfile::tempdir().unwrap();
    let place = dir.path().join("place");
    fs::create_dir(&place).unwrap();
    for name in [
        "../../escaped",
        "..",
        &dir.path().join("abs").display().to_string(),
    ] {
        let text = format!("base = \"paper\"\nname = {name:?}\n[solver]\nduration_s = 0.002\n");
        fs::write(place.join("mine.toml"), text).unwrap();
        let words = words("record mine.toml --engines rapier-shared-law --out rec");
        let outcome = run_in(&place, words);
        assert!(outcome.code.is_some(), "{outcome:?}");
        let outcome = run_in(&place, ["run", "mine.toml", "--force"]);
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        assert_eq!(names_in(dir.path()), ["place"], "{name}");
        for below in names_in(&place.join("rec")) {
            assert!(
                !below.starts_with('.') && place.join("rec").join(&below).is_dir(),
                "{below}"
            );
        }
        assert!(
            names_in(&place)
                .iter()
                .all(|n| ["mine.toml", "out", "rec"].contains(&n.as_str()))
        );
    }
}

#[test]
fn regress_a_baselines_folder_keeps_foreign_files() {
    let dir = tempfile::tempdir().unwrap();
    let place = dir.path().join("bl/accepted");
    fs::create_dir_all(&place).unwrap();
    let accepted = repository("reference/baselines/accepted");
    for name in names_in(&accepted) {
        fs::copy(accepted.join(&name), place.join(&name)).unwrap();
    }
    fs::write(place.join("notes.txt"), "precious").unwrap();
    let words = words("baseline record --dir bl --accept why --only flores");
    let outcome = run_in(dir.path(), words);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    assert_eq!(names_in(&place), ["baseline.toml", "notes.txt"]);
    let recorded = fs::read_to_string(place.join("baseline.toml")).unwrap();
    assert!(recorded.contains("reason = \"why (only flores)\""));
}

#[test]
fn regress_a_foreign_folder_named_unfinished_stays() {
    let dir = tempfile::tempdir().unwrap();
    sweep_file(dir.path(), "0.002");
    let place = dir.path().join("o.unfinished");
    fs::create_dir(&place).unwrap();
    fs::write(place.join("thesis.tex"), "precious").unwrap();
    for flag in ["--force", "--resume"] {
        let outcome = run_in(dir.path(), ["sweep", "s.toml", "--out", "o", flag]);
        assert_refused(&outcome, "o.unfinished");
        assert_eq!(
            fs::read_to_string(place.join("thesis.tex")).unwrap(),
            "precious"
        );
    }
    assert_eq!(names_in(dir.path()), ["o.unfinished", "s.toml"]);
}

#[cfg(unix)]
#[test]
fn regress_folders_of_the_user_are_never_replaced() {
    let dir = tempfile::tempdir().unwrap();
    let [real, link, work] = ["real", "link", "work"].map(|name| dir.path().join(name));
    fs::create_dir(&real).unwrap();
    fs::create_dir_all(work.join("data")).unwrap();
    fs::write(real.join("letter"), "precious").unwrap();
    std::os::unix::fs::symlink(&real, &link).unwrap();
    fs::write(
        work.join("data/mine.toml"),
        "base = \"paper\"\n[solver]\nduration_s = 0.002\n",
    )
    .unwrap();
    let run = |words: &[&str]| {
        let mut command = pinwheel();
        command.current_dir(&work).env("HOME", &link).args(words);
        Outcome::from(command.stdin(Stdio::null()).output().unwrap())
    };
    let (at_real, at_link) = (real.display().to_string(), link.display().to_string());
    for (out, part) in [
        (at_real.as_str(), "`letter`"),
        (&at_link, "is a link"),
        ("..", "working in"),
        ("/", "working in"),
    ] {
        assert_refused(&run(&["run", "paper", "--force", "--out", out]), part);
    }
    let outcome = run(&["run", "data/mine.toml", "--force", "--out", "data"]);
    assert_refused(&outcome, "data/mine.toml");
    let outcome = run(&["run", "data/../data/mine.toml", "--force", "--out=data"]);
    assert_refused(&outcome, "mine.toml");
    assert_eq!(names_in(&real), ["letter"]);
    assert_eq!(names_in(&work.join("data")), ["mine.toml"]);
    // A link to nothing, and an invalid file name: reported before any computation.
    std::os::unix::fs::symlink("nowhere", work.join("dangling")).unwrap();
    assert_refused(
        &run(&["run", "paper", "--out", "dangling"]),
        "link to nothing",
    );
    let long = "x".repeat(300);
    assert_refused(&run(&["run", "paper", "--out", &long]), "--out");
}

#[test]
fn regress_file_names_make_no_output_ours() {
    let dir = tempfile::tempdir().unwrap();
    let other = dir.path().join("other");
    fs::create_dir(&other).unwrap();
    for name in ["summary.json", "index.html"] {
        fs::write(other.join(name), "another tool's").unwrap();
    }
    let other_words = ["run", "paper", "--out", "other"];
    assert_refused(
        &run_in(dir.path(), other_words.iter().chain(&SHORT)),
        "`index.html`",
    );
    assert_eq!(
        fs::read_to_string(other.join("index.html")).unwrap(),
        "another tool's"
    );

    // An output that contains the data of a comparison is not replaced, with or without --force.
    let ours = ["run", "paper", "--out", "ours"];
    assert_eq!(run_in(dir.path(), ours.iter().chain(&SHORT)).code, Some(0));
    fs::write(
        dir.path().join("map.toml"),
        "[columns]\ninput_torque_n_m = \"input_torque_n_m\"\n",
    )
    .unwrap();
    for force in [&[][..], &["--force"]] {
        let compare = "compare paper --engines native-reduced --against ours/courses.csv";
        let more = ["--map", "map.toml", "--out", "ours"];
        let outcome = run_in(
            dir.path(),
            words(compare)
                .iter()
                .chain(&more)
                .chain(&SHORT)
                .chain(force),
        );
        assert_refused(&outcome, "ours/courses.csv");
    }
    assert!(dir.path().join("ours/courses.csv").is_file());
    // An additional file in an output stops the program, which names it.
    fs::write(dir.path().join("ours/notes.txt"), "precious").unwrap();
    let words = ["run", "paper", "--out", "ours"];
    assert_refused(
        &run_in(dir.path(), words.iter().chain(&SHORT)),
        "`notes.txt`",
    );
}

#[cfg(unix)]
#[test]
fn regress_a_partial_measurement_replaces_no_complete_one() {
    let dir = tempfile::tempdir().unwrap();
    let words = words("bench paper --engines native-reduced --out b --repeats");
    let short = [&words[..], &["1", "--methods", "rk4"], &SHORT].concat();
    assert_eq!(run_in(dir.path(), &short).code, Some(0));
    let before = fs::read_to_string(dir.path().join("b/summary.json")).unwrap();
    // Far longer than any wait.
    let long = [&words[..], &["1000", "--set", "solver.duration_s=0.02"]].concat();
    // A stop before any measurement writes nothing, so later stops follow, on any machine.
    for doubled in 0..10 {
        let child = start(dir.path(), &long);
        std::thread::sleep(Duration::from_millis(250 << doubled));
        interrupt(&child);
        let outcome = within(child, 60.0);
        assert_eq!(outcome.code, Some(130), "{outcome:?}");
        let now = fs::read_to_string(dir.path().join("b/summary.json")).unwrap();
        assert_eq!(now, before);
        if dir.path().join("b.partial").exists() {
            break;
        }
    }
    let partial = fs::read_to_string(dir.path().join("b.partial/summary.json")).unwrap();
    assert!(partial.contains("\"complete\": false"));
}

#[test]
fn regress_reserved_names_are_refused_before_the_run() {
    let dir = tempfile::tempdir().unwrap();
    let map = "name = \"Index.html\"\n[columns]\ninput_torque_n_m = \"a\"\n";
    fs::write(dir.path().join("map.toml"), map).unwrap();
    let mut csv = "time_s,a\n".to_owned();
    (0..20).for_each(|k| csv.push_str(&format!("{},1\n", 1e-4 * f64::from(k))));
    fs::write(dir.path().join("d.csv"), csv).unwrap();
    let compare = "compare paper --map map.toml --against";
    let against = |file: &str| {
        let words = words(compare).into_iter().chain([file]).chain(SHORT);
        run_in(dir.path(), words)
    };
    assert_refused(&against("d.csv"), "`name`");
    // Without a name in the map, the data set has that of its file, which clashes too.
    fs::write(dir.path().join("map.toml"), &map[map.find('[').unwrap()..]).unwrap();
    fs::rename(
        dir.path().join("d.csv"),
        dir.path().join("Summary.JSON.csv"),
    )
    .unwrap();
    assert_refused(&against("Summary.JSON.csv"), "`name`");
    assert!(!dir.path().join("out").exists());
}

#[cfg(unix)]
#[test]
fn regress_what_a_kill_leaves_is_named_and_stays() {
    let dir = tempfile::tempdir().unwrap();
    let hidden = || {
        let mut names = names_in(dir.path());
        names.retain(|name| name.starts_with(".pinwheel-"));
        names
    };
    // Finished outputs, links and pipes with the name of a draft are not reported as leftovers.
    let victim = dir.path().join("victim");
    for out in ["victim/results", ".pinwheel-mine"] {
        let words = ["run", "paper", "--out", out];
        assert_eq!(run_in(dir.path(), words.iter().chain(&SHORT)).code, Some(0));
    }
    fs::write(dir.path().join(".pinwheel-mine/thesis.txt"), "precious").unwrap();
    std::os::unix::fs::symlink(victim.join("results"), dir.path().join(".pinwheel-a")).unwrap();
    fs::create_dir(dir.path().join(".pinwheel-b")).unwrap();
    let pipe = dir.path().join(".pinwheel-b/.pinwheel");
    assert!(Command::new("mkfifo").arg(pipe).status().unwrap().success());
    let others = hidden();

    let mut child = start(dir.path(), &[&LONG[..], &["o"]].concat());
    until(|| hidden().len() == 4);
    child.kill().unwrap();
    child.wait().unwrap();
    let left = hidden();
    let new = left.iter().find(|name| !others.contains(name)).unwrap();
    // The draft of a running program is not reported as a leftover.
    let alive = start(dir.path(), &[&LONG[..], &["p"]].concat());
    until(|| hidden().len() == 5);
    let remedy = format!("note: a command that was killed left what `rm -r {new}` removes\n");
    let init =
        "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    for words in ["run paper --set solver.duration_s=0.002 --out o", init] {
        let outcome = within(
            start(dir.path(), &words.split(' ').collect::<Vec<_>>()),
            60.0,
        );
        assert_eq!(
            (outcome.code, &outcome.stderr),
            (Some(0), &remedy),
            "{words}"
        );
        assert_eq!(hidden().len(), 5, "{words}");
    }
    drop(within(alive, 0.0));
    assert_eq!(
        names_in(&victim.join("results")),
        ["courses.csv", "index.html", "run.json"]
    );
    assert!(names_in(&dir.path().join(".pinwheel-mine")).contains(&"thesis.txt".to_owned()));
}

/// Single files: an earlier one of the program is replaced and keeps its mode; any other stays, above all an input of the
/// run.
#[cfg(unix)]
#[test]
fn bad_input_single_files_replace_only_their_like() {
    use std::os::unix::fs::PermissionsExt as _;
    let dir = tempfile::tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    let scene = "base = \"paper\"\n[solver]\nduration_s = 0.002\n";
    fs::write(at("s.toml"), scene).unwrap();
    let init =
        "init f.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    let junit =
        "compare s.toml --engines native-reduced,native-resolved --longest 1 --out o --junit";
    let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    for (words, file, more) in [
        (format!("{junit} f.xml"), "f.xml", ""),
        ("fmu s.toml --out f.fmu".to_owned(), "f.fmu", ""),
        (init.to_owned(), "f.toml", " --force"),
    ] {
        let run = |more: &str| run_in(dir.path(), format!("{words}{more}").split(' '));
        assert_eq!(run("").code, Some(0), "{words}: {:?}", run(""));
        fs::set_permissions(at(file), fs::Permissions::from_mode(0o600)).unwrap();
        assert_eq!(run(more).code, Some(0), "{words}: again");
        assert_eq!(mode(&at(file)), 0o600, "{words}");
        fs::set_permissions(at(file), fs::Permissions::from_mode(0o400)).unwrap();
        assert_refused(&run(more), "only be read");
        fs::remove_file(at(file)).unwrap();
        fs::write(at(file), "thesis").unwrap();
        assert_refused(&run(more), "name another file");
        assert_eq!(fs::read_to_string(at(file)).unwrap(), "thesis", "{words}");
    }
    for (words, part) in [
        (format!("{junit} s.toml"), "s.toml"),
        (format!("{junit} o/verdicts.xml"), "in the output folder"),
    ] {
        assert_refused(&run_in(dir.path(), words.split(' ')), part);
    }
    assert_eq!(fs::read_to_string(at("s.toml")).unwrap(), scene);
}

/// Two gears never share a default folder: it has the name of the scene's file, and stores its origin.
#[test]
fn bad_input_default_folders_are_of_one_scene() {
    let dir = tempfile::tempdir().unwrap();
    for file in ["mine.toml", "mine-explored.toml", "other/mine.toml"] {
        let text = "base = \"paper\"\nname = \"mine\"\n[solver]\nduration_s = 0.002\n";
        let file = dir.path().join(file);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, text).unwrap();
    }
    let run = |words: &str| run_in(dir.path(), words.split(' '));
    for words in ["run mine.toml", "run mine-explored.toml", "run ./mine.toml"] {
        assert_eq!(run(words).code, Some(0), "{words}");
    }
    assert_refused(
        &run("run other/mine.toml"),
        "holds the results of mine.toml",
    );
    assert_eq!(run("run other/mine.toml --force").code, Some(0));
    assert_refused(
        &run("run mine.toml"),
        "holds the results of other/mine.toml",
    );
    assert_eq!(
        names_in(&dir.path().join("out")),
        ["mine-explored-run", "mine-run"]
    );
}

#[test]
fn regress_two_sweeps_on_one_output() {
    let dir = tempfile::tempdir().unwrap();
    sweep_file(dir.path(), "2.0"); // long enough to be interrupted
    let first = start(
        dir.path(),
        &["sweep", "s.toml", "--jobs", "1", "--out", "o"],
    );
    until(|| !names_in(&dir.path().join("o.unfinished")).is_empty());
    std::thread::sleep(Duration::from_millis(200));
    for flag in ["--resume", "--force"] {
        let second = start(dir.path(), &["sweep", "s.toml", "--out", "o", flag]);
        let outcome = within(second, 20.0);
        assert_refused(&outcome, &format!("process {}", first.id()));
    }
    drop(within(first, 0.0));
}

#[test]
fn regress_undefined_numbers_are_empty_cells() {
    let dir = tempfile::tempdir().unwrap();
    let text = "name = \"s\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.01\n\
        drive.output_torque_n_m = 0.0\n[vary]\ndrive.input_speed_rad_s = [0.0, 1e-9, 157.0]\n";
    fs::write(dir.path().join("s.toml"), text).unwrap();
    let outcome = run_in(dir.path(), ["sweep", "s.toml", "--out", "o"]);
    assert_eq!(outcome.code, Some(0), "{outcome:?}");
    let csv = fs::read_to_string(dir.path().join("o/results.csv")).unwrap();
    let rows: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    let column = |name: &str| rows[0].iter().position(|n| *n == name).unwrap();
    for row in &rows[1..] {
        assert!(
            row.iter()
                .all(|cell| !["inf", "-inf", "NaN"].contains(cell)),
            "{row:?}"
        );
        let cell = row[column("efficiency")];
        assert!(
            cell.is_empty() || cell.parse::<f64>().unwrap().abs() <= 2.0,
            "{cell}"
        );
        assert!(
            !cell.is_empty() || row[column("reason")].contains("efficiency"),
            "{row:?}"
        );
    }
    let again = run_in(dir.path(), ["sweep", "s.toml", "--out", "o", "--resume"]);
    assert_eq!(again.code, Some(0), "{again:?}");
    assert_eq!(
        fs::read_to_string(dir.path().join("o/results.csv")).unwrap(),
        csv
    );
}

/// Gears at rest, without load or without contact: no figure of any page, table or file is infinite, NaN or larger than
/// physically possible.
#[test]
fn regress_no_number_where_there_is_none() {
    let dir = tempfile::tempdir().unwrap();
    let still = ["drive.output_torque_n_m=0", "drive.input_speed_rad_s=0"];
    let loose = ["drive.output_torque_n_m=0", "gear.backlash_m=0.0006"];
    let compare = words("compare paper --engines native,rapier-shared-law --longest 1");
    let bench = words(
        "bench paper --engines native-reduced,rapier-shared-law --methods rk4 --repeats \
         1",
    );
    for (words, sets) in [
        (&["run", "paper"][..], still),
        (&["run", "paper"], loose),
        (&compare, still),
        (&bench, loose),
    ] {
        let sets = sets.iter().flat_map(|set| ["--set", *set]);
        let out = ["--set", "solver.duration_s=0.004", "--out", "o", "--force"];
        let outcome = run_in(dir.path(), words.iter().copied().chain(sets).chain(out));
        assert!(
            outcome.code.is_some_and(|code| code < 2 || code == 4),
            "{words:?}: {outcome:?}"
        );
        let mut shown = vec![outcome.stdout];
        let mut open = vec![dir.path().join("o")];
        while let Some(place) = open.pop() {
            for path in names_in(&place).iter().map(|name| place.join(name)) {
                if path.is_dir() {
                    open.push(path);
                } else {
                    shown.push(visible(&fs::read_to_string(path).unwrap()));
                }
            }
        }
        let words = |text: &str| {
            let cut = |c: char| !(c.is_alphanumeric() || "+-.".contains(c));
            text.split(cut).map(str::to_owned).collect::<Vec<_>>()
        };
        for word in shown.iter().flat_map(|text| words(text)) {
            let number = word.parse::<f64>().unwrap_or(0.0);
            assert!(number.abs() < 1e13, "{word}");
        }
    }
}

/// Returns the visible text of a page, without scripts and styles; other files unchanged.
fn visible(text: &str) -> String {
    if !text.trim_start().to_lowercase().starts_with("<!doctype") {
        return text.to_owned();
    }
    let mut text = text.to_owned();
    for (from, to) in [("<script", "</script>"), ("<style", "</style>"), ("<", ">")] {
        let mut kept = String::new();
        let mut rest = text.as_str();
        while let Some(start) = rest.find(from) {
            kept.push_str(&rest[..start]);
            kept.push(' ');
            let end = rest[start..]
                .find(to)
                .map_or(rest.len(), |end| start + end + to.len());
            rest = &rest[end..];
        }
        kept.push_str(rest);
        text = kept;
    }
    text
}

/// A request without a match is an error that lists the alternatives; nothing passes without a number.
#[test]
fn regress_what_matches_nothing_does_not_pass() {
    let dir = tempfile::tempdir().unwrap();
    let text = "scene = \"paper\"\nengines = [\"native-reduced\"]\nmeasure = [\"*_torque_n_m\", \"nonsense*\"]\n[set]\n\
        solver.duration_s = 0.002\n[vary]\ngear.backlash_m = [0.0]\n";
    fs::write(dir.path().join("s.toml"), text).unwrap();
    let outcome = run_in(dir.path(), ["sweep", "s.toml", "--out", "o"]);
    assert_refused(&outcome, "`nonsense*` fits no quantity");
    assert!(
        outcome.stderr.contains("external_sleeve_force_n"),
        "{outcome:?}"
    );
    let mut rows = "time_s,a\n".to_owned();
    (0..21).for_each(|k| rows.push_str(&format!("{},1\n", 1e-4 * f64::from(k))));
    fs::write(dir.path().join("d.csv"), rows).unwrap();
    let map = "[columns]\ninput_torque_n_m = \"a\"\n[[limits]]\nquantity = \"nothing_n\"\nwindow = \"transient\"\n\
        metric = \"mean\"\nlimit = 0.1\nreason = \"x\"\n";
    fs::write(dir.path().join("m.toml"), map).unwrap();
    let words = words("compare paper --engines native-reduced --longest 1");
    let against = ["--against", "d.csv", "--map", "m.toml"];
    let outcome = run_in(dir.path(), words.iter().chain(&against).chain(&SHORT));
    assert_refused(&outcome, "can never be judged");
    let accepted = repository("reference/baselines/accepted/baseline.toml");
    let head = fs::read_to_string(accepted).unwrap();
    fs::create_dir_all(dir.path().join("bl/empty")).unwrap();
    let head = &head[..head.find("[[scene]]").unwrap()];
    fs::write(dir.path().join("bl/empty/baseline.toml"), head).unwrap();
    let words = ["baseline", "check", "empty", "--dir", "bl"];
    assert_refused(&run_in(dir.path(), words), "holds no scenes");
}

/// A scene from a pipe without a writer: the first Ctrl-C ends the wait.
#[cfg(unix)]
#[test]
fn regress_a_pipe_that_never_comes_can_be_stopped() {
    let dir = tempfile::tempdir().unwrap();
    let made = Command::new("mkfifo").arg(dir.path().join("pipe")).status();
    assert!(made.unwrap().success());
    let child = start(dir.path(), &["run", "pipe"]);
    std::thread::sleep(Duration::from_millis(300));
    interrupt(&child);
    let outcome = within(child, 20.0);
    assert_eq!(outcome.code, Some(130), "{outcome:?}");
    assert_eq!(names_in(dir.path()), ["pipe"]);
}

#[test]
fn regress_maps_are_bounded() {
    let dir = tempfile::tempdir().unwrap();
    let mut csv = "time_s,a\n".to_owned();
    (0..20).for_each(|k| csv.push_str(&format!("{},1e300\n", 1e-4 * f64::from(k))));
    fs::write(dir.path().join("d.csv"), csv).unwrap();
    for (map, part) in [
        (
            "[file]\nskip_lines = 9000000000000000000\n[columns]\ninput_torque_n_m = \"a\"\n",
            "skip_lines",
        ),
        (
            "[file]\nlines_after_header = 9000000000000000000\n[columns]\ninput_torque_n_m = \"a\"\n",
            "lines_after_header",
        ),
        (
            "[columns]\ninput_torque_n_m = { column = \"a\", factor = 1e10 }\n",
            "too large",
        ),
        (
            "[columns]\ninput_torque_n_m = { magnitude_of = [\"a\", \"a\"] }\n",
            "too large",
        ),
    ] {
        fs::write(dir.path().join("map.toml"), map).unwrap();
        let words = words("compare paper --engines native-reduced --against d.csv --map map.toml");
        let outcome = within(start(dir.path(), &[&words[..], &SHORT].concat()), 20.0);
        assert_refused(&outcome, part);
    }
}

#[test]
fn regress_control_characters_never_reach_the_terminal() {
    let dir = tempfile::tempdir().unwrap();
    for words in [
        &["run", "\u{1b}]0;owned\u{7}"][..],
        &["run", "paper", "--set", "contact.law=a\u{1b}[2Jb"],
        &["run", "paper", "--out", "a\u{1b}[2Jb/../x"],
        &["baseline", "check", "--dir", "a\u{1b}[2Jb"],
        &["run", "paper", "--set", "gear.\u{9b}2J=1"],
        &["\u{1b}[2J"],
    ] {
        let mut command = pinwheel();
        // Forces colours as on a terminal; elsewhere all escape sequences are omitted.
        command.env("CLICOLOR_FORCE", "1").current_dir(dir.path());
        let outcome = Outcome::from(command.args(words).stdin(Stdio::null()).output().unwrap());
        assert_eq!(outcome.code, Some(2));
        let colours = ["\u{1b}[1m", "\u{1b}[31m", "\u{1b}[0m", "\n"];
        let line = colours
            .iter()
            .fold(outcome.stderr, |line, colour| line.replace(colour, ""));
        assert!(!line.chars().any(char::is_control), "{line:?}");
    }
    let sweep = |keys: u32| {
        let keys: String = (0..keys).map(|k| format!("k{k}=[1]\n")).collect();
        fs::write(
            dir.path().join("s.toml"),
            format!("scene = \"paper\"\n[vary]\n{keys}"),
        )
        .unwrap();
        let begun = Instant::now();
        let outcome = within(start(dir.path(), &["sweep", "s.toml"]), 20.0);
        assert_eq!(outcome.code, Some(2), "{:.300}", outcome.stderr);
        (outcome.stderr.len(), begun.elapsed())
    };
    let (bytes, _) = sweep(900);
    assert!(bytes < 2000, "{bytes} bytes are no line of a screen");
    let (bytes, time) = sweep(60_000);
    assert!(
        bytes < 2000 && time < Duration::from_secs(2),
        "{bytes} {time:?}"
    );
}

/// An output folder with a file that a named file refers to is not replaced.
#[test]
fn regress_inputs_of_inputs_are_inputs() {
    let dir = tempfile::tempdir().unwrap();
    fs::create_dir(dir.path().join("o")).unwrap();
    fs::write(dir.path().join("o/base.toml"), "base = \"paper\"\n").unwrap();
    fs::write(dir.path().join("mine.toml"), "base = \"o/base.toml\"\n").unwrap();
    fs::write(dir.path().join("s.toml"), "scene = \"mine.toml\"\n").unwrap();
    for words in [["run", "mine.toml"], ["sweep", "s.toml"]] {
        let words = words.iter().chain(&["--force", "--out", "o"]).chain(&SHORT);
        assert_refused(&run_in(dir.path(), words), "base.toml");
    }
    assert_eq!(names_in(&dir.path().join("o")), ["base.toml"]);
}

/// A megabyte is read, or refused, within two seconds: no work is repeated for each value.
#[test]
fn regress_a_megabyte_is_read_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let change = |k: u32| format!("{{ time_s = {k}e-3, output_torque_n_m = 1.0 }},\n");
    let changes: String = (1..22_000).map(change).collect();
    let text = format!("base = \"paper\"\ndrive.load_changes = [\n{changes}]\n");
    assert!((900_000..1 << 20).contains(&text.len()), "{}", text.len());
    fs::write(dir.path().join("m.toml"), text).unwrap();
    let begun = Instant::now();
    let outcome = within(start(dir.path(), &["explain", "m.toml"]), 20.0);
    assert_refused(&outcome, "more than 1000");
    // 0.1 s; 22 s if lines were counted again for every value.
    assert!(
        begun.elapsed() < Duration::from_secs(4),
        "{:?}",
        begun.elapsed()
    );

    // One column of 75 000 rows under 80 000 names: 12 GB, if read that often.
    let rows: String = (0..75_000)
        .map(|k| format!("{:.5},1.25\n", 1e-5 * f64::from(k)))
        .collect();
    fs::write(dir.path().join("d.csv"), format!("time_s,a\n{rows}")).unwrap();
    let names: String = (0..80_000).map(|k| format!("q{k} = \"a\"\n")).collect();
    fs::write(dir.path().join("map.toml"), format!("[columns]\n{names}")).unwrap();
    let against = ["--against", "d.csv", "--map", "map.toml"];
    let words = [
        &["compare", "paper", "--engines", "native-reduced"][..],
        &against,
        &SHORT,
    ];
    let begun = Instant::now();
    let outcome = within(start(dir.path(), &words.concat()), 20.0);
    assert_refused(&outcome, "feeds more than");
    assert!(
        begun.elapsed() < Duration::from_secs(8),
        "{:?}",
        begun.elapsed()
    );

    // 90 000 patterns, each compared with all before it: 9 s.
    let patterns: Vec<String> = (0..90_000).map(|k| format!("\"*{k}*\"")).collect();
    let text = format!("scene = \"paper\"\nmeasure = [{}]\n", patterns.join(","));
    fs::write(dir.path().join("s.toml"), text).unwrap();
    let begun = Instant::now();
    let outcome = within(start(dir.path(), &["sweep", "s.toml", "--list"]), 20.0);
    assert_refused(&outcome, "names more than 1000");
    assert!(
        begun.elapsed() < Duration::from_secs(8),
        "{:?}",
        begun.elapsed()
    );
}

/// A plan of many runs creates many scenes: the first Ctrl-C ends that, too.
#[cfg(unix)]
#[test]
fn regress_planning_can_be_stopped() {
    let dir = tempfile::tempdir().unwrap();
    let axis = |key: &str, to: f64| format!("{key} = {{ from = 0.0, to = {to}, points = 300 }}\n");
    let text = format!(
        "scene = \"paper\"\n[vary]\n{}{}",
        axis("gear.backlash_m", 3e-4),
        axis("drive.output_torque_n_m", 11.0)
    );
    fs::write(dir.path().join("s.toml"), text).unwrap();
    let child = start(dir.path(), &["sweep", "s.toml", "--list"]);
    std::thread::sleep(Duration::from_millis(300));
    let asked = Instant::now();
    interrupt(&child);
    let outcome = within(child, 30.0);
    assert_eq!(outcome.code, Some(130), "{:.300}", outcome.stderr);
    assert!(
        asked.elapsed() < Duration::from_secs(1),
        "{:?}",
        asked.elapsed()
    );
    assert_eq!(outcome.stdout, "");
}

#[cfg(target_os = "linux")]
#[test]
fn regress_a_full_disk_is_called_so() {
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = pinwheel().arg("laws").stdout(full).output().unwrap();
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(2) && stderr.contains("disk is full"),
        "{stderr}"
    );
}

/// Runs of another build of the program are run again.
#[test]
fn regress_a_rebuilt_program_reuses_no_runs() {
    let dir = tempfile::tempdir().unwrap();
    sweep_file(dir.path(), "0.002");
    let words = ["sweep", "s.toml", "--out", "o", "--resume"];
    let times = || fs::read_to_string(dir.path().join("o/costs.csv")).unwrap();
    assert_eq!(run_in(dir.path(), words).code, Some(0));
    let first = times();
    assert_eq!(run_in(dir.path(), words).code, Some(0));
    assert_eq!(times(), first, "the same program goes on");
    // Records of another build: runs are identified by the sources of their program.
    for entry in fs::read_dir(dir.path().join("o/runs")).unwrap() {
        let path = entry.unwrap().path();
        let text = fs::read_to_string(&path).unwrap();
        let mut record: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert!(record["program"].is_string());
        record["program"] = "another".into();
        fs::write(&path, record.to_string()).unwrap();
    }
    let again = words.iter().chain(&["--force"]);
    assert_eq!(run_in(dir.path(), again).code, Some(0));
    assert_ne!(times(), first);
}

/// Runs of an external solver whose program changed under one version are also repeated.
#[cfg(unix)]
#[test]
fn regress_a_rebuilt_solver_reuses_no_runs() {
    use std::os::unix::fs::PermissionsExt as _;
    let dir = tempfile::tempdir().unwrap();
    let words = ["run", "paper", "--out", "own"];
    assert_eq!(run_in(dir.path(), words.iter().chain(&SHORT)).code, Some(0));
    let build = |remark: &str| {
        let path = dir.path().join("solver.sh");
        let text = format!(
            "#!/bin/sh\n# {remark}\necho ran >> '{0}/ran'\ncp '{0}/own/courses.csv' \"$1/courses.csv\"\n",
            dir.path().display()
        );
        fs::write(&path, text).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    };
    let manifest = "protocol = 1\nname = \"script\"\nversion = \"1\"\ntrack = \"own-contact\"\nsummary = \"copies\"\n\
        command = [\"{here}/solver.sh\", \"{job}\"]\n";
    fs::write(dir.path().join("solver.toml"), manifest).unwrap();
    let text = "scene = \"paper\"\nengines = [\"script\"]\n[set]\nsolver.duration_s = 0.002\n[vary]\n\
        gear.backlash_m = [0.0]\n";
    fs::write(dir.path().join("s.toml"), text).unwrap();
    let runs_after = |remark: &str| {
        build(remark);
        let words = ["sweep", "s.toml", "--solver", "solver.toml"];
        let more = ["--out", "o", "--resume"];
        let outcome = run_in(dir.path(), words.iter().chain(&more));
        assert_eq!(outcome.code, Some(0), "{outcome:?}");
        let ran = fs::read_to_string(dir.path().join("ran")).unwrap();
        ran.lines().count()
    };
    assert_eq!(runs_after("first"), 1);
    assert_eq!(runs_after("first"), 1);
    assert_eq!(runs_after("second"), 2);
}
