//! Stored runs: returned to the bit, and only for equal inputs.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use pinwheel_engines::kept::{Store, internals};
use pinwheel_engines::{
    Ending, Engine, EngineInfo, Halt, Prepared, Run, RunStats, SharedModel, by_name,
};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_timeseries::{TimeSeries, columns};

/// Engine that is not run.
struct Fake {
    version: &'static str,
    brought: bool,
}

impl Engine for Fake {
    fn info(&self) -> EngineInfo<'_> {
        EngineInfo {
            brought: self.brought,
            ..EngineInfo::own("fake", SharedModel::SharedLaw)
        }
    }

    fn version(&self) -> String {
        self.version.to_owned()
    }

    fn prepare<'a>(&'a self, _: &Gearbox) -> Result<Prepared<'a>, Halt> {
        Err(Ending::unsupported("nobody runs it").into())
    }
}

fn gearbox(sets: &[(&str, &str)]) -> Gearbox {
    let sets = sets.iter().map(|&(key, value)| Override::new(key, value));
    Gearbox::new(&Scene::load("paper", &sets.collect::<Vec<_>>()).unwrap()).unwrap()
}

fn run() -> Run {
    let mut series = TimeSeries::new(vec![0.0, 0.1 + 0.2, 1.0]).unwrap();
    series
        .push(columns::INPUT_TORQUE, vec![-0.0, 1e-300, 1.0 / 3.0])
        .unwrap();
    let stats = RunStats {
        cpu_s: 3.5,
        notes: vec!["a \"note\"\nof two lines".to_owned()],
        ..RunStats::default()
    };
    Run::new(series, stats)
}

/// Returns the engine of a version with a store in `folder` that is opened now.
fn opened(folder: &Path, fresh: bool, version: &'static str) -> (Arc<Store>, Box<dyn Engine>) {
    let made = ("a machine".to_owned(), "2026-01-31".to_owned());
    let store = Arc::new(Store::open(folder, fresh, "program", made).unwrap());
    let brought = false;
    let mut engines = store.around(vec![Box::new(Fake { version, brought })]);
    (store, engines.remove(0))
}

fn bits(run: &Run) -> Vec<u64> {
    let series = &run.time_series;
    let channels = series.channels().iter().flat_map(|one| &one.values);
    series
        .time_s()
        .iter()
        .chain(channels)
        .map(|value| value.to_bits())
        .collect()
}

/// Waits until file times increase.
fn later() {
    std::thread::sleep(Duration::from_millis(30));
}

#[test]
fn a_kept_run_is_the_run() {
    let dir = tempfile::tempdir().unwrap();
    let (store, engine) = opened(dir.path(), false, "1");
    let scene = gearbox(&[]);
    assert!(engine.kept(&scene, None).is_none());
    engine.keep(&scene, &run(), None);
    let now = engine.kept(&scene, None).unwrap();
    assert_eq!(bits(&now), bits(&run()));
    assert_eq!(now.stats, run().stats);
    assert_eq!(store.added(), 1);
    later();
    let (store, engine) = opened(dir.path(), false, "1");
    // Names do not affect a run.
    let named = gearbox(&[("name", "\"other\"")]);
    let read = engine.kept(&named, None).unwrap();
    assert_eq!(read.stats.kept.as_deref(), Some("2026-01-31 on a machine"));
    assert_eq!(bits(&read), bits(&run()));
    assert_eq!(
        (store.added(), store.cost_s("fake", &scene.scene)),
        (0, Some(3.5))
    );
    assert!(store.messages().is_empty());
}

#[test]
fn another_run_is_none() {
    let dir = tempfile::tempdir().unwrap();
    let (_, engine) = opened(dir.path(), false, "1");
    let scene = gearbox(&[]);
    engine.keep(&scene, &run(), None);
    for sets in [
        ("solver.step_s", "2e-5"),
        ("solver.duration_s", "0.3"),
        ("gear.backlash_m", "1e-9"),
    ] {
        assert!(engine.kept(&gearbox(&[sets]), None).is_none(), "{sets:?}");
    }
    later();
    assert!(
        opened(dir.path(), false, "2")
            .1
            .kept(&scene, None)
            .is_none()
    );
    let (_, fresh) = opened(dir.path(), true, "1");
    assert!(fresh.kept(&scene, None).is_none());
    fresh.keep(&scene, &run(), None);
    let anew = fresh.kept(&scene, None).unwrap();
    assert_eq!(anew.stats.kept, None);
    // Native runs are fast, and a user's solver may have changed.
    let native = by_name("native-reduced", &scene.scene).unwrap();
    let own = Fake {
        version: "1",
        brought: true,
    };
    let (store, _) = opened(dir.path(), false, "1");
    for engine in store.around(vec![native, Box::new(own)]) {
        engine.keep(&scene, &run(), None);
        assert!(engine.kept(&scene, None).is_none());
    }
}

#[test]
fn an_ending_that_may_pass_is_not_kept() {
    let dir = tempfile::tempdir().unwrap();
    let (_, engine) = opened(dir.path(), false, "1");
    let scene = gearbox(&[]);
    for ending in [Ending::absent("x"), Ending::failed("x")] {
        engine.keep(&scene, &run().with_ending(ending), None);
        assert!(engine.kept(&scene, None).is_none());
    }
    let [less, most, more] = [9, 10, 11].map(|s| Some(Duration::from_secs(s)));
    let late = Ending::TimedOut {
        time_s: 0.1,
        reason: "slow".to_owned(),
    };
    engine.keep(&scene, &run().with_ending(late.clone()), most);
    for (allowed, reused) in [(less, true), (most, true), (more, false), (None, false)] {
        let kept = engine.kept(&scene, allowed);
        assert_eq!(
            kept.map(|run| run.ending),
            reused.then(|| late.clone()),
            "{allowed:?}"
        );
    }
}

/// Every byte of a file counts, and so does its end; a message reports damage.
#[test]
fn bad_input_damaged_files_are_made_anew() {
    let dir = tempfile::tempdir().unwrap();
    let (_, engine) = opened(dir.path(), false, "1");
    let scene = gearbox(&[]);
    engine.keep(&scene, &run(), None);
    let [path] = internals::files(dir.path()).try_into().unwrap();
    let file = std::fs::read(&path).unwrap();
    let body = file.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    assert!(internals::reads(&file[body..]) && !internals::reads(&file[body..file.len() - 8]));
    let mut damaged: Vec<Vec<u8>> = vec![Vec::new(), b"foreign".to_vec(), file[..body].to_vec()];
    damaged.push(file[..file.len() - 1].to_vec());
    for at in (0..file.len()).step_by(97) {
        let mut other = file.clone();
        other[at] ^= 1;
        damaged.push(other);
    }
    for bytes in damaged {
        std::fs::write(&path, bytes).unwrap();
        let (store, engine) = opened(dir.path(), false, "1");
        assert!(engine.kept(&scene, None).is_none());
        let [message] = store.messages().try_into().unwrap();
        assert!(
            message.contains("fake") && message.contains("made anew"),
            "{message}"
        );
        engine.keep(&scene, &run(), None);
        assert_eq!(std::fs::read(&path).unwrap(), file);
    }
}

#[test]
fn the_oldest_go() {
    let dir = tempfile::tempdir().unwrap();
    let (store, engine) = opened(dir.path(), false, "1");
    let scenes = ["1e-5", "2e-5", "4e-5"].map(|step| gearbox(&[("solver.step_s", step)]));
    for scene in &scenes {
        engine.keep(scene, &run(), None);
        later();
    }
    let files = internals::files(dir.path());
    let bytes: u64 = files
        .iter()
        .map(|path| path.metadata().unwrap().len())
        .sum();
    internals::trim(&store, bytes - 1);
    let left = scenes
        .each_ref()
        .map(|scene| engine.kept(scene, None).is_some());
    assert_eq!(left, [false, true, true]);
}

/// Threads in place of processes: all write and read one file.
#[test]
fn several_may_use_it_at_once() {
    let dir = tempfile::tempdir().unwrap();
    let scene = gearbox(&[]);
    let worked = std::thread::scope(|scope| {
        let work = || {
            let (store, engine) = opened(dir.path(), false, "1");
            for _ in 0..20 {
                engine.keep(&scene, &run(), None);
                assert_eq!(bits(&engine.kept(&scene, None).unwrap()), bits(&run()));
            }
            store.messages()
        };
        let all: Vec<_> = (0..4).map(|_| scope.spawn(work)).collect();
        all.into_iter()
            .map(|one| one.join().unwrap())
            .collect::<Vec<_>>()
    });
    assert_eq!(worked, vec![Vec::<String>::new(); 4]);
    assert_eq!(internals::files(dir.path()).len(), 1);
}
