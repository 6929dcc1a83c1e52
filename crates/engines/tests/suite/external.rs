//! Programs with the faults of bad solvers. Each ends in one clear line and leaves no process.

use std::os::unix::fs::PermissionsExt;
use std::path::Path;
use std::process::Command;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use pinwheel_scene::{CheckedScene, Scene};
use tempfile::TempDir;

use pinwheel_engines::external::*;
use pinwheel_engines::*;

fn scene() -> CheckedScene {
    let sets = ["solver.duration_s=0.02".parse().expect("one")];
    Scene::load("paper", &sets).expect("preset")
}

/// Folder with a solver as a shell script, and `good.csv`, its correct output.
struct Script {
    folder: TempDir,
    solver: Solver,
}

impl Script {
    fn new(body: &str) -> Self {
        let folder = tempfile::tempdir().expect("folder");
        let at = |name: &str| folder.path().join(name);
        let good = Native::REDUCED
            .run(&scene(), &Control::quiet())
            .expect("native");
        good.time_series.save_csv(&at("good.csv")).expect("written");
        #[cfg(feature = "parquet")]
        pinwheel_timeseries::save_time_series(&good.time_series, &at("good.parquet"))
            .expect("written");
        std::fs::write(at("solver.sh"), format!("#!/bin/sh\nset -u\n{body}\n")).expect("written");
        std::fs::set_permissions(at("solver.sh"), PermissionsExt::from_mode(0o755)).expect("set");
        let manifest = r#"
            protocol = 1
            name = "script"
            version = "1"
            track = "own-contact"
            summary = "a script"
            command = ["{here}/solver.sh", "{job}", "{here}"]
            timeout_s = 20
        "#;
        std::fs::write(at("solver.toml"), manifest).expect("written");
        let solver = Solver::open(&at("solver.toml")).expect("manifest");
        Self { folder, solver }
    }

    fn run(&self) -> Result<Run, Ending> {
        let run = self.solver.run(&scene(), &Control::quiet());
        run.expect("nobody stops it").finished()
    }

    fn fails(&self) -> String {
        let error = self.run().expect_err("it fails").to_string();
        assert!(!error.contains('\n') && error.len() < 800, "{error}");
        error
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.folder.path().join(name)).unwrap_or_default()
    }
}

/// True if the process whose number is in a file exists.
fn lives(pid: &str) -> bool {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", pid.trim()));
    stat.is_ok_and(|stat| !stat.contains(") Z "))
}

const COPY: &str = "cp \"$2/good.csv\" \"$1/courses.csv\"";

#[test]
fn a_run_with_everything_it_may_tell() {
    let script = Script::new(&format!(
        r#"{COPY}
        echo '@t 0.01' >&2; echo '@note a remark' >&2; echo 'something else' >&2; echo '@note of stdout'; echo '@t 0.015'
        echo '{{"steps": 7, "right_hand_sides": 14, "settings": "own", "notes": ["another"], "unknown": 1}}' > "$1/result.json"
        grep -q '"protocol": 1' "$1/scene.json" || exit 9
        echo junk > "$1/more.txt""#
    ));
    let times = Mutex::new(Vec::new());
    let progress = |at: Progress<'_>| {
        let [t, _] = at.simulated_s.expect("a run");
        times.lock().expect("lock").push(t);
    };
    let never = AtomicBool::new(false);
    let control = Control::new(&never, &progress);
    let run = script.solver.run(&scene(), &control).expect("it runs");
    assert_eq!(run.time_series.len(), 201);
    assert_eq!(
        (run.stats.steps, run.stats.rhs_calls, run.stats.bodies),
        (7, 14, 28)
    );
    assert_eq!(run.stats.notes, ["a remark", "another"]);
    // Only stderr may have commands.
    let times = times.into_inner().expect("lock");
    assert!(times.contains(&0.01) && !times.contains(&0.015));
    assert!(run.stats.cpu_s < 5.0 && run.stats.wall_s > 0.0);
}

#[test]
fn hard_what_it_does_wrong_is_one_line() {
    for (body, words) in [
        ("exit 0", "it wrote no courses.csv"),
        ("exit 7", "it ended with status 7"),
        (
            "echo 'no licence' >&2; exit 1",
            "it ended with status 1: no licence",
        ),
        ("kill -SEGV $$", "signal 11 (segmentation fault)"),
        (
            "echo 'points only' >&2; exit 4",
            "cannot run this scene: points only",
        ),
        (
            "printf 'a\\000b\\033[31m\\n' >&2; exit 4",
            "cannot run this scene: a b [31m",
        ),
        (
            "head -c 3000 /dev/urandom > \"$1/courses.csv\"",
            "courses.csv",
        ),
        (
            "mkdir \"$1/courses.csv\"",
            "is a folder, a pipe or a device",
        ),
        (
            "mkfifo \"$1/courses.csv\"",
            "is a folder, a pipe or a device",
        ),
        ("ln -s \"$2/good.csv\" \"$1/courses.csv\"", "is a link"),
        ("ln -s /dev/zero \"$1/courses.csv\"", "is a link"),
        ("ln \"$2/good.csv\" \"$1/courses.csv\"", "a hard link"),
        (
            "head -c 60000000 /dev/zero > \"$1/courses.csv\"",
            "is larger than",
        ),
        (
            "head -c -1 \"$2/good.csv\" > \"$1/courses.csv\"",
            "its last line has no end",
        ),
        (
            "head -c -3 \"$2/good.csv\" > \"$1/courses.csv\"",
            "its last line has no end",
        ),
        (
            "cut -d, -f1-20 \"$2/good.csv\" > \"$1/courses.csv\"",
            "has no column `internal_sleeve_force_n_0` and 7 more",
        ),
        (
            "head -n 100 \"$2/good.csv\" > \"$1/courses.csv\"",
            "has 99 rows, but there are 201 samples",
        ),
        (
            "sed '3d' \"$2/good.csv\" > \"$1/courses.csv\"",
            "sample 1 is at 0.0001 s",
        ),
        (
            "awk -F, -v OFS=, 'NR > 1 { $6 = -$6 - 1 } { print }' \"$2/good.csv\" > \"$1/courses.csv\"",
            "is the magnitude of a force",
        ),
        (
            "awk -F, -v OFS=, 'NR > 1 { $3 = -$3 } { print }' \"$2/good.csv\" > \"$1/courses.csv\"",
            "has the sign of the load",
        ),
        (
            "awk -F, -v OFS=, 'NR > 1 { $4 = -$4 } { print }' \"$2/good.csv\" > \"$1/courses.csv\"",
            "off its ideal mesh",
        ),
        (
            "awk -F, -v OFS=, 'NR == 52 { $3 = \"NaN\" } { print }' \"$2/good.csv\" > \"$1/courses.csv\"",
            "diverged at t = 0.005000 s: output_torque_n_m is not finite",
        ),
        (
            "head -n 102 \"$2/good.csv\" > \"$1/courses.csv\"; echo 'step too small' >&2; exit 3",
            "diverged at t = 0.010000 s: step too small",
        ),
        ("exit 3", "diverged at t = 0.000000 s: it says so itself"),
        (
            &*format!("{COPY}; echo '{{' > \"$1/result.json\""),
            "result.json is not as documented",
        ),
        (
            &*format!("{COPY}; ln -s /etc/passwd \"$1/result.json\""),
            "result.json is a link",
        ),
    ] {
        let error = Script::new(body).fails();
        assert!(error.contains(words), "{body}\n{error}");
    }
}

#[cfg(feature = "parquet")]
#[test]
fn hard_results_in_parquet() {
    let copy = "cp \"$2/good.parquet\" \"$1/courses.parquet\"";
    let [binary, text] =
        [copy, COPY].map(|body| Script::new(body).run().expect("runs").time_series);
    assert_eq!(binary, text);
    for (body, words) in [
        (
            format!("{copy}; {COPY}"),
            "it wrote courses.csv and courses.parquet; write one of them",
        ),
        (
            "head -c 3000 /dev/urandom > \"$1/courses.parquet\"".to_owned(),
            "courses.parquet: Parquet: ",
        ),
        (
            "head -c 3000 \"$2/good.parquet\" > \"$1/courses.parquet\"".to_owned(),
            "courses.parquet: Parquet: ",
        ),
        (
            "ln -s \"$2/good.parquet\" \"$1/courses.parquet\"".to_owned(),
            "courses.parquet is a link",
        ),
    ] {
        let error = Script::new(&body).fails();
        assert!(error.contains(words), "{body}\n{error}");
    }
}

#[test]
fn hard_a_divergence_keeps_what_there_is() {
    let script = Script::new("head -n 102 \"$2/good.csv\" > \"$1/courses.csv\"; exit 3");
    let run = script.solver.run(&scene(), &Control::quiet()).expect("ran");
    assert!(matches!(run.ending, Ending::Diverged { .. }));
    assert_eq!(run.time_series.len(), 101);
}

#[test]
fn hard_a_hang_is_ended_with_all_it_started() {
    let script = Script::new(
        "trap '' TERM\n\
         sh -c 'echo $$ > \"$0/grandchild\"; exec sleep 1000' \"$2\" &\necho $$ > \"$2/own\"\nwhile :; do sleep 1; done",
    );
    let solver = script.solver.clone().within(Duration::from_millis(500));
    let begun = Instant::now();
    let run = solver.run(&scene(), &Control::quiet()).expect("ran");
    let Ending::TimedOut { reason, .. } = run.ending else {
        panic!("it hangs");
    };
    assert!(reason.contains("it took longer than 0.5 s"), "{reason}");
    assert!(begun.elapsed() < Duration::from_secs(10));
    for name in ["own", "grandchild"] {
        let pid = script.read(name);
        assert!(!pid.is_empty() && !lives(&pid), "{name} {pid} still runs");
    }
}

#[test]
fn hard_what_it_leaves_behind_is_ended() {
    let script = Script::new(&format!(
        "{COPY}\nsh -c 'echo $$ > \"$0/left\"; exec sleep 1000' \"$2\" &\nwhile [ ! -s \"$2/left\" ]; do :; done"
    ));
    let begun = Instant::now();
    assert!(script.run().is_ok());
    assert!(begun.elapsed() < Duration::from_secs(10));
    let pid = script.read("left");
    assert!(!pid.is_empty() && !lives(&pid), "{pid} still runs");
}

/// Children in their own sessions, also of an ended parent, after a timeout and after a normal end.
#[cfg(target_os = "linux")]
#[test]
fn hard_who_leaves_the_group_is_ended_too() {
    let leave = "setsid sh -c 'echo $$ > \"$0/session\"; exec sleep 1000' \"$2\" &\n\
                 setsid sh -c \"(setsid sh -c 'echo \\$\\$ > \\\"\\$0/orphan\\\"; exec sleep 1000' '$2' &)\"\n\
                 while [ ! -s \"$2/session\" ] || [ ! -s \"$2/orphan\" ]; do :; done";
    for (end, finishes) in [(COPY, true), ("sleep 1000", false)] {
        let script = Script::new(&format!("{leave}\n{end}"));
        let solver = script.solver.clone().within(Duration::from_secs(2));
        let run = solver.run(&scene(), &Control::quiet()).expect("ran");
        assert_eq!(run.ending.is_finished(), finishes, "{}", run.ending);
        let pids = ["session", "orphan"].map(|name| script.read(name));
        let left: Vec<&String> = pids.iter().filter(|pid| lives(pid)).collect();
        for pid in &left {
            let _ = Command::new("kill").args(["-KILL", pid.trim()]).status();
        }
        assert!(
            pids.iter().all(|pid| !pid.is_empty()) && left.is_empty(),
            "{left:?}"
        );
    }
}

#[test]
fn hard_the_user_stops_it() {
    let script = Script::new("echo $$ > \"$2/own\"; exec sleep 1000");
    let stop = AtomicBool::new(false);
    let own = script.folder.path().join("own");
    // After the start of the program.
    let progress = |_: Progress<'_>| {
        if std::fs::read_to_string(&own).is_ok_and(|pid| !pid.trim().is_empty()) {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let control = Control::new(&stop, &progress);
    let ended = script.solver.run(&scene(), &control);
    assert!(matches!(ended, Err(Cancelled)), "{ended:?}");
    assert!(!lives(&script.read("own")));
}

#[test]
fn hard_huge_output_is_ended() {
    let mut log = Script::new("yes");
    log.solver.limits.log_bytes = 1 << 20;
    assert!(
        log.fails()
            .contains("it wrote more than 1 MB to stdout and stderr")
    );
    let mut files = Script::new("while :; do head -c 1000000 /dev/zero >> \"$1/more\"; done");
    files.solver.limits.folder_bytes = 20 << 20;
    assert!(files.fails().contains("its files are larger than 20 MB"));
    let many = Script::new("i=0; while :; do i=$((i+1)); : > \"$1/$i\"; done");
    assert!(many.fails().contains("or too many"));
    // Long lines and many notes are cut, the first or the last ones.
    let (many, long) = (
        "for i in $(seq 500); do echo \"@note $i\" >&2; done",
        "head -c 3000000 /dev/zero | tr '\\0' 'x' >&2; echo >&2",
    );
    for log in [format!("{many}; {long}"), format!("{long}; {many}")] {
        let talk = Script::new(&format!("{COPY}; {log}"));
        let notes = talk.run().expect("it runs").stats.notes;
        assert_eq!(notes.len(), 20, "{notes:?}");
    }
}

/// A folder replaced by a link is not followed, neither for reading nor for removal.
#[test]
fn hard_a_swapped_folder_is_not_followed() {
    let script = Script::new(
        "mkdir \"$2/elsewhere\"; cp \"$2/good.csv\" \"$2/elsewhere/courses.csv\"; mv \"$1\" \"$2/moved\"; \
         ln -s \"$2/elsewhere\" \"$1\"",
    );
    let error = script.fails();
    assert!(error.contains("it wrote no courses.csv"), "{error}");
    assert!(!script.read("elsewhere/courses.csv").is_empty());
}

#[test]
fn bad_input_a_program_that_is_not_there() {
    let script = Script::new("exit 0");
    std::fs::remove_file(script.folder.path().join("solver.sh")).expect("removed");
    let error = script.fails();
    assert!(
        error.contains("does not start") && error.contains("build it"),
        "{error}"
    );
}

#[test]
fn what_a_manifest_does_not_honour_is_never_started() {
    let script = Script::new("touch \"$2/ran\"; exit 1");
    let sets = ["contact.friction_coefficient=0.1".parse().expect("one")];
    let rubbing = Scene::load("paper", &sets).expect("preset");
    let run = script.solver.run(&rubbing, &Control::quiet()).expect("ran");
    assert!(matches!(run.ending, Ending::Unsupported { .. }), "{run:?}");
    assert!(!script.folder.path().join("ran").exists());
}

#[test]
fn job_folders_do_not_pile_up() {
    let script = Script::new(&format!(
        "{COPY}; echo \"$1\" > \"$2/job\"; mkdir -p \"$1/a/b\"; : > \"$1/a/b/c\""
    ));
    script.run().expect("it runs");
    let job = script.read("job");
    assert!(!job.trim().is_empty() && !Path::new(job.trim()).exists());
}

#[test]
fn written_solvers_have_the_name_they_are_given() {
    for (_, _, language) in scaffold::LANGUAGES {
        let folder = tempfile::tempdir().expect("folder");
        for (name, text) in language.files("my-own") {
            std::fs::write(folder.path().join(name), text).expect("written");
        }
        let solver = Solver::open(&folder.path().join("solver.toml")).expect("sound");
        assert_eq!(solver.name(), "my-own", "{language:?}");
    }
}
