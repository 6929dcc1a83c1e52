//! Sweeps as a whole: threads, interruptions, divergence, what is kept.

use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use pinwheel_courses::{Courses, Ending};
use pinwheel_studies::sweep::{
    Column, Journal, Plan, RunRecord, Sweep, SweepError, execute, results,
};
use pinwheel_studies::{Control, Progress};

const SWEEP: &str = "\
scene = \"paper\"
engines = [\"native-reduced\", \"native-lagrange\"]
[set]
solver.duration_s = 0.004
output.channels = [\"efficiency\"]
[vary]
gear.backlash_m = { from = 0.0, to = 2.0e-4, points = 3 }
contact.damping_n_s_m = [8.0, 16.0]
";

fn plan(text: &str) -> Plan {
    Plan::new(Sweep::from_toml(text, Path::new("mine.toml")).unwrap(), &[]).unwrap()
}

fn run(plan: &Plan, journal: &Journal, jobs: usize) -> Vec<RunRecord> {
    execute(plan, journal, jobs, &Control::quiet()).unwrap()
}

fn csv(plan: &Plan, records: &[RunRecord]) -> String {
    let mut bytes = Vec::new();
    results(plan, records).write_csv(&mut bytes).unwrap();
    String::from_utf8(bytes).unwrap()
}

fn numbers(column: Option<&Column>) -> Vec<f64> {
    match column {
        Some(Column::Number(values)) => values.iter().map(|value| value.unwrap()).collect(),
        other => panic!("no numbers: {other:?}"),
    }
}

#[test]
fn the_same_numbers_whatever_the_threads() {
    let (plan, folder) = (plan(SWEEP), tempfile::tempdir().unwrap());
    let table = |jobs: usize| {
        let journal = Journal::open(&folder.path().join(jobs.to_string()), None, "a test").unwrap();
        let records = run(&plan, &journal, jobs);
        assert_eq!(journal.len(), 12);
        #[cfg(feature = "parquet")]
        {
            let mut bytes = Vec::new();
            results(&plan, &records).write_parquet(&mut bytes).unwrap();
            std::fs::write(folder.path().join(format!("{jobs}.parquet")), bytes).unwrap();
        }
        csv(&plan, &records)
    };
    let one = table(1);
    assert_eq!(one, table(3));
    assert_eq!(one, table(50));
    #[cfg(feature = "parquet")]
    {
        let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
        assert_eq!(read("1.parquet"), read("3.parquet"));
        let file = std::fs::File::open(folder.path().join("1.parquet")).unwrap();
        let columns = pinwheel_courses::read_table(file).unwrap();
        let header: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(header.join(","), one.lines().next().unwrap());
    }
    assert_eq!(one.lines().count(), 13);
    let first: Vec<&str> = one.lines().nth(1).unwrap().split(',').collect();
    assert_eq!(&first[..5], ["1", "native-reduced", "0", "8", "finished"]);
    assert!(
        one.starts_with("run,engine,gear.backlash_m,contact.damping_n_s_m,status,diverged_at_s,")
    );
}

/// The figures are those of the run itself.
#[test]
fn figures_are_the_courses() {
    let text = format!("courses = \"csv\"\nwindow_s = [0.001, 0.003]\n{SWEEP}");
    let (plan, folder) = (plan(&text), tempfile::tempdir().unwrap());
    let journal = Journal::open(folder.path(), None, "a test").unwrap();
    let records = run(&plan, &journal, 2);
    let table = results(&plan, &records);
    let peaks = numbers(table.column("peak_external_sleeve_force_n"));
    let means = numbers(table.column("mean_input_torque_n_m"));
    let out = tempfile::tempdir().unwrap();
    for (k, record) in records.iter().enumerate() {
        journal.copy(record, k + 1, out.path()).unwrap();
        let courses = Courses::load_csv(&out.path().join(format!("run-{:04}.csv", k + 1))).unwrap();
        let window = courses.window(0.001, 0.003);
        assert_eq!(window.len(), 21);
        let forces = courses.group("external_sleeve_force_n");
        let peak = forces
            .iter()
            .flat_map(|f| &f[window.clone()])
            .fold(0.0, |a: f64, b| a.max(*b));
        assert_eq!(peaks[k], peak);
        let torque = &courses.channel("input_torque_n_m").unwrap()[window];
        assert!((means[k] - torque.iter().sum::<f64>() / 21.0).abs() < 1e-14);
        assert!(courses.channel("efficiency").is_some());
    }
}

/// The paper's law creates 0.95 % of the work: the efficiency by means is above 1, said so, and given without.
#[test]
fn regress_efficiencies_above_one_are_told() {
    let text = "scene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.1\n\
                [vary]\ncontact.law = [\"paper\", \"paper-conservative\"]\n";
    let (plan, folder) = (plan(text), tempfile::tempdir().unwrap());
    let journal = Journal::open(folder.path(), None, "a test").unwrap();
    let records = run(&plan, &journal, 2);
    for record in &records {
        let plain = record.efficiency.unwrap();
        let accounted = record.efficiency_accounted.unwrap();
        assert!(accounted <= 1.0 + 1e-9, "{accounted}");
        assert_eq!(
            plain > 1.0,
            record.reason().contains("efficiency above 1"),
            "{record:?}"
        );
        assert!(
            plain <= 1.0 || (plain - accounted) > 0.0,
            "{plain} {accounted}"
        );
    }
    assert!(records[0].efficiency.unwrap() > 1.005, "{records:?}");
}

/// Stopped at any moment, a sweep goes on with the runs that are missing, and ends as if it had not been.
#[test]
fn goes_on_where_it_stopped() {
    let (plan, folder) = (plan(SWEEP), tempfile::tempdir().unwrap());
    let whole = csv(
        &plan,
        &run(
            &plan,
            &Journal::open(&folder.path().join("whole"), None, "a test").unwrap(),
            2,
        ),
    );
    let place = folder.path().join("stopped");
    let cancel = AtomicBool::new(false);
    let stop_after = |p: Progress<'_>| cancel.store(p.done >= 5, Ordering::Relaxed);
    let control = Control {
        cancel: &cancel,
        progress: &stop_after,
    };
    let journal = Journal::open(&place, None, "a test").unwrap();
    let stopped = execute(&plan, &journal, 2, &control).unwrap_err();
    let SweepError::Stopped { finished, runs } = stopped else {
        panic!("{stopped}");
    };
    assert!((5..=6).contains(&finished) && runs == 12, "{finished}");
    // A kill leaves files that were being written, and perhaps a torn record from elsewhere.
    std::fs::write(place.join(".unfinished-x"), "{").unwrap();
    std::fs::write(place.join("run-torn.json"), "{\"engine\":").unwrap();
    drop(journal);
    let journal = Journal::open(&place, None, "a test").unwrap();
    assert_eq!(journal.len(), finished);
    assert!(!place.join(".unfinished-x").exists());
    let records = run(&plan, &journal, 2);
    assert_eq!(journal.len(), 12);
    assert_eq!(csv(&plan, &records), whole);
    drop(journal);
    // A third time nothing is run: the times, which no two runs share, stay.
    let again = run(&plan, &Journal::open(&place, None, "a test").unwrap(), 1);
    assert!(
        again
            .iter()
            .zip(&records)
            .all(|(a, b)| a.cpu_s.to_bits() == b.cpu_s.to_bits())
    );
}

/// A longer list finds the runs of a shorter one; another window does not.
#[test]
fn a_changed_sweep_keeps_what_still_fits() {
    let folder = tempfile::tempdir().unwrap();
    let short =
        "scene = \"paper\"\n[set]\nsolver.duration_s = 0.002\n[vary]\ngear.backlash_m = [1e-4]\n";
    let journal = Journal::open(folder.path(), None, "a test").unwrap();
    let first = run(&plan(short), &journal, 1);
    let longer = plan(&short.replace("[1e-4]", "[0.0, 1e-4]"));
    let elsewhere = tempfile::tempdir().unwrap();
    let journal = Journal::open(elsewhere.path(), Some(folder.path()), "a test").unwrap();
    let second = run(&longer, &journal, 1);
    assert_eq!(second[1], first[0]);
    let window = plan(&format!("window_s = [0.0, 0.001]\n{short}"));
    let third = run(&window, &journal, 1);
    assert!(third[0].cpu_s != first[0].cpu_s && third[0].figures != first[0].figures);
}

#[test]
fn divergence_and_refusal_are_results() {
    let text = "scene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.02\n[vary]\nsolver.step_s = [1e-5, 1e-4]\n";
    let (plan, folder) = (plan(text), tempfile::tempdir().unwrap());
    let records = run(
        &plan,
        &Journal::open(folder.path(), None, "a test").unwrap(),
        2,
    );
    assert_eq!(records[0].ending, Ending::Finished);
    // Heun at 1e-4 s is beyond its limit of stability (docs/physics.md) and blows up.
    assert!(matches!(records[1].ending, Ending::Diverged { time_s, .. } if time_s < 0.02));
    let table = csv(&plan, &records);
    let second: Vec<&str> = table.lines().nth(2).unwrap().split(',').collect();
    assert_eq!(&second[..4], ["2", "native-reduced", "0.0001", "diverged"]);
    assert_eq!(
        Journal::open(folder.path(), None, "a test").unwrap().len(),
        2
    );
}
