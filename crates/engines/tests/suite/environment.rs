//! Environments that are interrupted, refused, requested twice at once, or impossible.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use std::{fs, thread};

use pinwheel_engines::Halt;
use pinwheel_engines::cache::{call, fingerprint, kept_away, lock};
use pinwheel_engines::python::embedded::unusable;
use pinwheel_engines::python::environment::*;
use pinwheel_engines::python::interpreter::{self, ENVIRONMENT, Interpreter};

static GO: AtomicBool = AtomicBool::new(false);

/// No packages: the test covers everything except their download.
const NOTHING: Requirements = Requirements {
    name: "nothing",
    file: "nothing.txt",
    only_listed: false,
    text: "# none\n",
};

fn interpreter() -> Interpreter {
    interpreter::interpreter().unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<String> = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn two_at_once_make_one_and_leftovers_go() {
    let cache = tempfile::tempdir().unwrap();
    let here = Arc::new(cache.path().to_owned());
    // Remains of an interrupted build: a draft, and a folder without a marker.
    let name = name_of(NOTHING, &interpreter());
    fs::create_dir(here.join(&name)).unwrap();
    fs::write(here.join(&name).join("half"), "").unwrap();
    fs::create_dir(here.join(format!(".{name}.1.part"))).unwrap();
    let makers: Vec<_> = (0..2)
        .map(|_| {
            let here = Arc::clone(&here);
            thread::spawn(move || ensure(NOTHING, &interpreter(), &here, None, &GO).unwrap())
        })
        .collect();
    let made: Vec<Environment> = makers.into_iter().map(|m| m.join().unwrap()).collect();
    assert_eq!(made[0], made[1]);
    assert_eq!(made[0].folder, here.join(&name));
    assert!(made[0].packages.starts_with(&made[0].folder), "{made:?}");
    assert!(
        !made[0].folder.join("half").exists(),
        "a half environment was used"
    );
    assert_eq!(names(&here), [name.clone(), format!("{name}.lock")]);
    // A named environment is used unchanged.
    assert_eq!(
        named(&made[0].folder, &interpreter(), &GO).unwrap(),
        made[0]
    );
    let other = Interpreter {
        version: "3.99.0".to_owned(),
        candidates: Vec::new(),
    };
    let refused = named(&made[0].folder, &other, &GO).unwrap_err().to_string();
    assert!(
        refused.contains("embeds 3.99.0") && refused.contains(ENVIRONMENT),
        "{refused}"
    );
}

#[test]
fn packages_that_cannot_be_had_leave_nothing_behind() {
    let cache = tempfile::tempdir().unwrap();
    let wheels = tempfile::tempdir().unwrap();
    let absent = Requirements {
        name: "absent",
        file: "python/absent.txt",
        only_listed: true,
        text: "no-such-package==1.0 --hash=sha256:0000000000000000000000000000000000000000000000000000000000000000\n",
    };
    let error = ensure(
        absent,
        &interpreter(),
        cache.path(),
        Some(wheels.path()),
        &GO,
    )
    .unwrap_err();
    let text = error.to_string();
    let by_hand = "pip download --require-hashes --no-deps -r python/absent.txt";
    for word in [
        "cannot be installed",
        "no-such-package",
        by_hand,
        WHEELS,
        ENVIRONMENT,
    ] {
        assert!(text.contains(word), "{text}");
    }
    let left = names(cache.path());
    assert!(left.iter().all(|name| name.ends_with(".lock")), "{left:?}");
}

#[test]
fn an_environment_without_its_packages_is_incomplete() {
    let cache = tempfile::tempdir().unwrap();
    let made = ensure(NOTHING, &interpreter(), cache.path(), None, &GO).unwrap();
    assert!(complete(&made.folder, NOTHING, &GO).is_some());
    let more = Requirements {
        text: "# list\nno_such.package==1.0 --hash=sha256:00\n",
        ..NOTHING
    };
    let marker = made.folder.join(MARKER);
    fs::write(marker, more.text).unwrap();
    assert!(
        complete(&made.folder, more, &GO).is_none(),
        "the marker alone decides nothing"
    );
    let info = made.packages.join("No_Such_Package-1.0.dist-info");
    fs::create_dir(&info).unwrap();
    fs::write(
        info.join("METADATA"),
        "Name: No.Such-Package\nVersion: 1.0\n",
    )
    .unwrap();
    assert!(complete(&made.folder, more, &GO).is_some());
    // In pip's record of files: a package truncated by a full disk or a crash is missing, and the environment is rebuilt.
    let record = "no_such/core.so,sha256=WZRHGrsBESr8wYFZ9sx0tPURuZgG2lmzyvWpwXPKz8U,5\n";
    fs::write(info.join("RECORD"), record).unwrap();
    assert!(
        complete(&made.folder, more, &GO).is_none(),
        "a file is missing"
    );
    let file = made.packages.join("no_such").join("core.so");
    fs::create_dir(file.parent().unwrap()).unwrap();
    fs::write(&file, "12345").unwrap();
    assert!(complete(&made.folder, more, &GO).is_some());
    fs::write(&file, "12").unwrap();
    assert!(
        complete(&made.folder, more, &GO).is_none(),
        "a file is cut off"
    );
    fs::write(&file, "12346").unwrap();
    assert!(
        complete(&made.folder, more, &GO).is_none(),
        "a file has another byte"
    );
    fs::write(&file, "12345").unwrap();
    assert!(complete(&made.folder, more, &GO).is_some());
}

#[test]
fn a_call_ends_with_the_users_stop() {
    let python = interpreter().candidates.remove(0);
    let cancel = AtomicBool::new(false);
    let start = std::time::Instant::now();
    let output = thread::scope(|scope| {
        let sleep = ["-I", "-c", "import time; time.sleep(60)"];
        let (python, cancel) = (&python, &cancel);
        let called = scope.spawn(move || call(python, sleep, None, cancel));
        thread::sleep(Duration::from_millis(300));
        cancel.store(true, Ordering::Relaxed);
        called.join().unwrap()
    });
    assert_eq!(output, Err("stopped".to_owned()));
    assert!(start.elapsed() < Duration::from_secs(20));
}

#[test]
fn pip_installs_into_the_given_folder() {
    for away in [
        "PIP_TARGET",
        "PIP_DRY_RUN",
        "PIP_PREFIX",
        "PIP_USER",
        "PIP_REQUIRE_VIRTUALENV",
    ] {
        assert!(kept_away(away), "{away}");
    }
    for let_through in ["PIP_INDEX_URL", "PIP_PROXY", "PATH", "HOME"] {
        assert!(!kept_away(let_through), "{let_through}");
    }
}

#[test]
fn an_environment_of_the_user_is_not_to_be_removed() {
    let message = |named| unusable(Path::new("/home/me/env"), named, "why").to_string();
    assert!(message(false).contains("remove /home/me/env"));
    assert!(!message(true).contains("remove") && message(true).contains("pip install"));
}

#[test]
fn who_waits_for_the_lock_can_be_stopped() {
    let cache = tempfile::tempdir().unwrap();
    let path = cache.path().join("x.lock");
    let held = lock(&path, &GO).unwrap();
    let stopped = lock(&path, &AtomicBool::new(true));
    assert!(matches!(stopped, Err(Halt::Cancelled(_))));
    drop(held);
    assert!(lock(&path, &AtomicBool::new(true)).is_ok());
}

#[test]
fn faults_name_the_remedy() {
    let nowhere = named(Path::new("/nowhere"), &interpreter(), &GO).unwrap_err();
    assert!(nowhere.to_string().contains(ENVIRONMENT), "{nowhere}");
    let cache = tempfile::tempdir().unwrap();
    let none = Interpreter {
        version: "3.99.0".to_owned(),
        candidates: interpreter().candidates,
    };
    let error = ensure(NOTHING, &none, cache.path(), None, &GO).unwrap_err();
    assert!(
        error.to_string().contains("no Python 3.99.0 interpreter"),
        "{error}"
    );
    let file = cache.path().join("file");
    fs::write(&file, "").unwrap();
    let error = ensure(NOTHING, &interpreter(), &file, None, &GO).unwrap_err();
    assert!(error.to_string().contains("PINWHEEL_CACHE"), "{error}");
}

#[test]
fn fingerprints_tell_texts_apart() {
    assert_eq!(fingerprint(&[]), 0xcbf2_9ce4_8422_2325);
    assert_ne!(fingerprint(&["ab", "c"]), fingerprint(&["a", "bc"]));
}
