//! Attacks on outputs and single files: each is refused or harmless, and no foreign file is lost.

use std::collections::BTreeMap;
use std::fs::{self, Permissions};
use std::os::unix::fs::{PermissionsExt as _, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;

use pinwheel_files::file::{check, replace, replace_all};
use pinwheel_files::folder::{Folder, FolderError, Request, leftovers};
use pinwheel_files::{Lock, MANIFEST, Manifest};
use tempfile::{TempDir, tempdir};

/// Lists everything below a folder with its mode and the beginning of its content; links with their targets.
fn tree(place: &Path) -> BTreeMap<PathBuf, String> {
    let (mut all, mut open) = (BTreeMap::new(), vec![place.to_owned()]);
    while let Some(path) = open.pop() {
        let at = fs::symlink_metadata(&path).unwrap();
        let content = if at.is_symlink() {
            fs::read_link(&path).unwrap().display().to_string()
        } else if at.is_dir() {
            open.extend(fs::read_dir(&path).unwrap().map(|one| one.unwrap().path()));
            "folder".to_owned()
        } else if at.is_file() && at.len() < 1 << 20 {
            fs::read_to_string(&path).unwrap()
        } else {
            "special".to_owned()
        };
        all.insert(path, format!("{:o} {content}", at.permissions().mode()));
    }
    all
}

fn ask(out: &Path, force: bool) -> Result<Folder, FolderError> {
    let request = Request {
        force,
        ..Request::default()
    };
    Folder::prepare(out, request)
}

/// Writes an output with these files into `out`.
fn output(out: &Path, files: &[&str]) -> PathBuf {
    let folder = ask(out, false).unwrap();
    for file in files {
        let file = folder.path().join(file);
        fs::create_dir_all(file.parent().unwrap()).unwrap();
        fs::write(file, "ours").unwrap();
    }
    folder.publish().unwrap()
}

/// Makes a folder with an output `x` and a foreign output.
fn place() -> (TempDir, PathBuf, PathBuf) {
    let dir = tempdir().unwrap();
    let [x, victim] = ["x", "victim"].map(|name| dir.path().join(name));
    output(&x, &["courses.csv", "runs/run.json"]);
    output(&victim, &["results.csv"]);
    (dir, x, victim)
}

fn fifo(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status().unwrap();
    assert!(made.success());
}

/// Treatment of an earlier output: replaced, kept without `--force`, or always kept.
#[derive(Debug, PartialEq)]
enum Met {
    Replaced,
    Kept,
    Refused,
}

#[test]
fn bad_input_only_our_own_unchanged_files_are_replaced() {
    type Attack = fn(&Path, &Path);
    let attacks: [(&str, Met, Attack); 15] = [
        ("", Met::Replaced, |_, _| {}),
        ("", Met::Replaced, |x, _| {
            fs::remove_file(x.join("courses.csv")).unwrap()
        }),
        ("", Met::Replaced, |x, _| {
            fs::remove_dir_all(x).unwrap();
            fs::create_dir(x).unwrap();
        }),
        ("courses.csv", Met::Kept, |x, _| {
            fs::write(x.join("courses.csv"), "outs").unwrap()
        }),
        ("runs/run.json", Met::Kept, |x, _| {
            fs::write(x.join("runs/run.json"), "").unwrap()
        }),
        ("thesis.txt", Met::Refused, |x, _| {
            fs::write(x.join("thesis.txt"), "").unwrap()
        }),
        (".git/HEAD", Met::Refused, |x, _| {
            fs::create_dir(x.join(".git")).unwrap();
            fs::write(x.join(".git/HEAD"), "").unwrap();
        }),
        ("runs/notes/", Met::Refused, |x, _| {
            fs::create_dir(x.join("runs/notes")).unwrap()
        }),
        ("courses.csv", Met::Refused, |x, victim| {
            fs::remove_file(x.join("courses.csv")).unwrap();
            symlink(victim.join("results.csv"), x.join("courses.csv")).unwrap();
        }),
        ("runs", Met::Refused, |x, victim| {
            fs::remove_dir_all(x.join("runs")).unwrap();
            symlink(victim, x.join("runs")).unwrap();
        }),
        (MANIFEST, Met::Refused, |x, _| {
            fs::write(x.join(MANIFEST), "{}").unwrap()
        }),
        (MANIFEST, Met::Refused, |x, _| {
            fs::remove_file(x.join(MANIFEST)).unwrap();
            fifo(&x.join(MANIFEST));
        }),
        (MANIFEST, Met::Refused, |x, _| {
            let sparse = fs::File::create(x.join(MANIFEST)).unwrap();
            sparse.set_len(3 << 30).unwrap();
        }),
        ("is a link", Met::Refused, |x, victim| {
            fs::remove_dir_all(x).unwrap();
            symlink(victim, x).unwrap();
        }),
        ("may only be read", Met::Refused, |x, _| {
            fs::set_permissions(x, Permissions::from_mode(0o555)).unwrap();
        }),
    ];
    for (number, (part, expected, attack)) in attacks.into_iter().enumerate() {
        for force in [false, true] {
            let (dir, x, victim) = place();
            attack(&x, &victim);
            let before = tree(dir.path());
            let met = ask(&x, force).and_then(|folder| {
                fs::write(folder.path().join("run.json"), "new").unwrap();
                folder.publish()
            });
            let kind = match &met {
                Ok(_) => Met::Replaced,
                Err(FolderError::Kept { .. }) => Met::Kept,
                Err(_) => Met::Refused,
            };
            let what = format!("{number}, force {force}: {met:?}");
            let expected = match expected {
                Met::Kept if force => &Met::Replaced,
                ref other => other,
            };
            assert_eq!(&kind, expected, "{what}");
            assert_eq!(tree(&victim).len(), 3, "{what}");
            match met {
                Ok(_) => assert_eq!(fs::read_dir(&x).unwrap().count(), 2, "{what}"),
                Err(error) => {
                    assert!(error.to_string().contains(part), "{what}");
                    assert_eq!(tree(dir.path()), before, "{what}");
                }
            }
            assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2, "{what}");
        }
    }
}

/// Complete outputs, links and foreign drafts beside an output stay under any name; drafts of ended processes are listed.
#[test]
fn bad_input_nothing_beside_an_output_is_touched() {
    let (dir, x, victim) = place();
    let at = |name: &str| dir.path().join(name);
    output(&at(".pinwheel-mine"), &["run.json"]);
    fs::write(at(".pinwheel-mine/thesis.txt"), "precious").unwrap();
    symlink(&victim, at(".pinwheel-a")).unwrap();
    fs::create_dir(at(".pinwheel-b")).unwrap();
    fifo(&at(".pinwheel-b").join(MANIFEST));
    let mut dead = Command::new("true").spawn().unwrap();
    dead.wait().unwrap();
    let [dead, alive] =
        [dead.id(), std::process::id()].map(|id| at(&format!(".pinwheel-{id}-Ab1")));
    fs::create_dir(&dead).unwrap();
    fs::create_dir(&alive).unwrap();
    let before = tree(dir.path());
    output(&x, &["courses.csv", "runs/run.json"]);
    replace(&at("new.xml"), b"", &|_| false).unwrap();
    fs::remove_file(at("new.xml")).unwrap();
    assert_eq!(tree(dir.path()), before);
    assert_eq!(leftovers(dir.path()), [dead]);
}

#[test]
fn bad_input_a_file_that_comes_during_the_run_stays() {
    let (dir, x, _) = place();
    let folder = ask(&x, true).unwrap();
    fs::write(x.join("thesis.txt"), "precious").unwrap();
    let before = tree(&x);
    let error = folder.publish().unwrap_err();
    assert!(error.to_string().contains("thesis.txt"), "{error}");
    assert_eq!(tree(&x), before);
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
}

#[test]
fn regress_an_output_appears_complete_with_the_usual_mode() {
    let dir = tempdir().unwrap();
    let usual = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
    let plain = dir.path().join("plain");
    fs::create_dir(&plain).unwrap();
    let out = dir.path().join("a/b");
    let folder = ask(&out, false).unwrap();
    assert_eq!(usual(folder.draft()), 0o700, "nobody else gets in");
    fs::write(folder.path().join("run.json"), "{}").unwrap();
    assert!(
        !dir.path().join("a").exists(),
        "parents come with the result"
    );
    drop(ask(&out, false).unwrap());
    folder.publish().unwrap();
    assert_eq!(usual(&out), usual(&plain));
    assert!(Manifest::of(&out).is_some_and(|manifest| manifest.complete));
    assert_eq!(fs::read_dir(dir.path()).unwrap().count(), 2);
}

#[test]
fn regress_a_part_never_replaces_a_complete_output() {
    let dir = tempdir().unwrap();
    let x = dir.path().join("x");
    let one = |complete: bool| {
        let folder = ask(&x, false).unwrap();
        fs::write(folder.path().join("summary.json"), "{}").unwrap();
        let place = match complete {
            true => folder.publish(),
            false => folder.publish_partial(),
        };
        place
            .unwrap()
            .file_name()
            .unwrap()
            .to_string_lossy()
            .into_owned()
    };
    let names = [false, false, true, false, false].map(one);
    assert_eq!(names, ["x", "x", "x", "x.partial", "x.partial"]);
    // Foreign files in its place stay without loss of the output.
    fs::write(dir.path().join("x.partial/notes.txt"), "precious").unwrap();
    symlink("nowhere", dir.path().join("x.partial-2")).unwrap();
    assert_eq!(one(false), "x.partial-3");
}

/// Default places record the subject of their results.
#[test]
fn bad_input_results_of_another_scene_are_kept() {
    let dir = tempdir().unwrap();
    let x = dir.path().join("x");
    let ask = |of: &str, only_of: bool, force: bool| {
        let request = Request {
            of: of.to_owned(),
            only_of,
            force,
            ..Request::default()
        };
        Folder::prepare(&x, request).and_then(Folder::publish)
    };
    ask("a/mine.toml", true, false).unwrap();
    ask("a/mine.toml", true, false).unwrap();
    let error = ask("b/mine.toml", true, false).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("holds the results of a/mine.toml"),
        "{error}"
    );
    ask("b/mine.toml", true, true).unwrap();
    ask("c/mine.toml", false, false).unwrap();
}

#[test]
fn bad_input_places_where_no_output_may_go() {
    let dir = tempdir().unwrap();
    let at = |name: &str| dir.path().join(name);
    fs::write(at("file"), "").unwrap();
    symlink("nowhere", at("dangling")).unwrap();
    for (out, part) in [
        (at("file"), "not a folder"),
        (at("file/below"), "cannot be written"),
        (PathBuf::from("."), "working in"),
        (PathBuf::from("/"), "working in"),
        (at("no/../x"), "does not exist"),
        (at("dangling"), "link to nothing"),
        (PathBuf::new(), "empty"),
        #[cfg(target_os = "linux")]
        (PathBuf::from("/proc"), "mount point"),
    ] {
        let error = ask(&out, true).unwrap_err().to_string();
        assert!(error.contains(part), "{}: {error}", out.display());
    }
}

/// Only known files are replaced, without a change of mode or of a link's target.
#[test]
fn bad_input_single_files_of_others_stay() {
    const OURS: &[u8] = b"ours, earlier";
    type Attack = fn(&Path);
    let files: [(&str, Attack); 9] = [
        ("", |_| {}),
        ("", |file| fs::write(file, "").unwrap()),
        ("", |file| {
            fs::write(file, OURS).unwrap();
            fs::set_permissions(file, Permissions::from_mode(0o640)).unwrap();
        }),
        ("not one that", |file| fs::write(file, "precious").unwrap()),
        ("only be read", |file| {
            fs::write(file, OURS).unwrap();
            fs::set_permissions(file, Permissions::from_mode(0o400)).unwrap();
        }),
        ("is a link", |file| {
            fs::write(file.with_file_name("victim"), OURS).unwrap();
            symlink("victim", file).unwrap();
        }),
        ("No such file", |file| symlink("nowhere", file).unwrap()),
        ("no plain file", |file| fs::create_dir(file).unwrap()),
        ("not one that", |file| {
            let sparse = fs::File::create(file).unwrap();
            sparse.set_len(1 << 29).unwrap();
        }),
    ];
    for (number, (part, attack)) in files.into_iter().enumerate() {
        let dir = tempdir().unwrap();
        let file = dir.path().join("f");
        attack(&file);
        let before = tree(dir.path());
        let mode = |path: &Path| fs::metadata(path).map(|at| at.permissions().mode()).ok();
        let earlier = mode(&file);
        let ours = |content: &[u8]| content.starts_with(b"ours");
        let early = check(&file, &ours);
        assert_eq!(tree(dir.path()), before, "{number}: a check leaves nothing");
        let late = replace_all(
            &[(dir.path().join("a/g"), b"g"), (file.clone(), b"n")],
            &ours,
        );
        assert_eq!(early, late, "{number}");
        match late {
            Ok(()) => {
                assert!(part.is_empty(), "{number}");
                assert_eq!(fs::read(&file).unwrap(), b"n");
                assert!(
                    earlier.is_none_or(|earlier| mode(&file) == Some(earlier)),
                    "{number}"
                );
                assert!(dir.path().join("a/g").is_file());
            }
            Err(error) => {
                assert!(
                    !part.is_empty() && error.reason.contains(part),
                    "{number}: {error}"
                );
                assert_eq!(tree(dir.path()), before, "{number}: all or nothing");
            }
        }
    }
    // Simultaneous writers of this program do not refuse each other.
    let dir = tempdir().unwrap();
    let file = dir.path().join("f");
    std::thread::scope(|all| {
        let one = || replace(&file, b"ours", &|earlier| earlier == b"ours");
        let all: Vec<_> = (0..8).map(|_| all.spawn(one)).collect();
        all.into_iter().for_each(|one| one.join().unwrap().unwrap());
    });
    assert!(
        replace(Path::new("/dev/null"), b"n", &|_| false).is_ok(),
        "a stream is written to"
    );
}

#[test]
fn bad_input_a_locked_folder_has_one_writer_and_no_strangers() {
    let dir = tempdir().unwrap();
    let [own, other, link] = ["own", "other", "link"].map(|name| dir.path().join(name));
    fs::create_dir(&own).unwrap();
    let lock = Lock::take(&own, "pinwheel first").unwrap();
    let refused = Lock::take(&own, "pinwheel second").unwrap_err().to_string();
    let id = format!("process {} (`pinwheel first`)", std::process::id());
    assert!(refused.contains(&id), "{refused}");
    drop(lock);
    output(&other, &["run-1.json"]);
    symlink(&own, &link).unwrap();
    for folder in [&other, &link] {
        let before = tree(dir.path());
        assert!(Lock::take(folder, "").is_err());
        assert_eq!(tree(dir.path()), before);
    }
    fs::write(own.join("notes.txt"), "precious").unwrap();
    Lock::take(&own, "").unwrap().remove();
    assert!(own.join("notes.txt").exists());
    fs::remove_file(own.join("notes.txt")).unwrap();
    Lock::take(&own, "").unwrap().remove();
    assert!(!own.exists());
}
