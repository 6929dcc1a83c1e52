//! Claims about the backlash (Figs. 12 to 18).

use pinwheel_courses::columns;
use std::f64::consts::TAU;

use super::Verdict;
use super::runs::{
    EXTERNAL, Figure, Go, INTERNAL, STEADY, compile, course, forces, largest, mean, points, range,
    run, scene, torque, verdict,
};

use pinwheel_gearbox::contacts::PairContact;
use pinwheel_gearbox::native::{NativeError, NativeRun};
use pinwheel_gearbox::statics::Statics;
use pinwheel_scene::{Scene, Sleeve, free_play};

fn with_backlash(backlash: f64, go: Go<'_>) -> Result<NativeRun, NativeError> {
    run(&scene(|s| s.gear.backlash_m = backlash), go)
}

/// The start-up transient once its first swings are over: what is left in the time the paper draws.
const DYING: (f64, f64) = (0.06, 0.15);

/// What 0.6 mm of backlash make of a figure: steady, while the start dies, and steady with the paper's 4000 and
/// 600 points; without and with backlash, in pairs.
fn pairs(
    go: Go<'_>,
    measure: impl Fn(&NativeRun, (f64, f64)) -> f64,
) -> Result<Vec<f64>, NativeError> {
    let mut numbers = Vec::new();
    let exact = [with_backlash(0.0, go)?, with_backlash(6e-4, go)?];
    for window in [STEADY, DYING] {
        numbers.extend(exact.iter().map(|run| measure(run, window)));
    }
    for count in [4000, 600] {
        for backlash in [0.0, 6e-4] {
            let mut scene = points(Some(count));
            scene.gear.backlash_m = backlash;
            numbers.push(measure(&run(&scene, go)?, STEADY));
        }
    }
    Ok(numbers)
}

/// Growth of each pair.
fn growths(numbers: &[f64]) -> Vec<f64> {
    numbers
        .chunks(2)
        .map(|pair| pair[1] / pair[0] - 1.0)
        .collect()
}

pub(super) fn backlash_50(go: Go<'_>) -> Result<Figure, NativeError> {
    let [none, high] = [with_backlash(0.0, go)?, with_backlash(6e-4, go)?]
        .map(|r| largest(&r.courses, EXTERNAL, STEADY));
    let growth = high / none - 1.0;
    let figure = format!(
        "{none:.1} N without, {high:.1} N with 0.6 mm: {:+.0} %",
        100.0 * growth
    );
    let holds = (0.4..0.6).contains(&growth);
    Ok((figure, vec![none, high, growth], verdict(holds)))
}

pub(super) fn internal_25(go: Go<'_>) -> Result<Figure, NativeError> {
    let n = pairs(go, |run, window| largest(&run.courses, INTERNAL, window))?;
    let g = growths(&n);
    let figure = format!(
        "steady {:.1} N without, {:.1} N with 0.6 mm: {:+.1} %; {:+.0} % from 0.06 to 0.15 s; steady with 4000 points \
         {:+.0} %, with 600 {:+.0} %",
        n[0],
        n[1],
        100.0 * g[0],
        100.0 * g[1],
        100.0 * g[2],
        100.0 * g[3]
    );
    let like = |growth: f64| (0.15..0.35).contains(&growth);
    Ok((figure, n, conditional(like(g[0]), like(g[1]))))
}

pub(super) fn contact_time(go: Go<'_>) -> Result<Figure, NativeError> {
    let mut numbers = Vec::new();
    for backlash in [0.0, 3e-4, 6e-4] {
        // One wheel with half the load: with two, a sleeve goes from one to the other without a pause.
        let run = run(
            &scene(|s| {
                s.gear.backlash_m = backlash;
                s.gear.wheels = 1;
                s.drive.output_torque_n_m = 11.0;
            }),
            go,
        )?;
        let (mut loaded, mut all) = (0_u64, 0_u64);
        for force in forces(&run.courses, EXTERNAL, STEADY).flatten() {
            loaded += u64::from(*force > 0.0);
            all += 1;
        }
        numbers.push(loaded as f64 / all.max(1) as f64);
    }
    let figure = format!(
        "one wheel loads an external sleeve {:.0} %, {:.0} %, {:.0} % of the time at 0, 0.3, 0.6 mm",
        100.0 * numbers[0],
        100.0 * numbers[1],
        100.0 * numbers[2]
    );
    let holds = numbers.windows(2).all(|w| w[1] < w[0]);
    Ok((figure, numbers, verdict(holds)))
}

pub(super) fn backlash_torque(go: Go<'_>) -> Result<Figure, NativeError> {
    let n = pairs(go, |run, window| range(torque(&run.courses, window)))?;
    let g = growths(&n);
    let figure = format!(
        "the input torque ranges over {:.4} N m without, {:.4} N m with 0.6 mm; {:.2} and {:.2} N m from 0.06 to 0.15 s; \
         steady with 4000 points {:.2} and {:.2} N m, with 600 {:.2} and {:.2} N m",
        n[0], n[1], n[2], n[3], n[4], n[5], n[6], n[7]
    );
    // "Considerably": by half at least.
    Ok((figure, n, conditional(g[0] > 0.5, g[1] > 0.5)))
}

fn conditional(always: bool, sometimes: bool) -> Verdict {
    match (always, sometimes) {
        (true, _) => Verdict::Holds,
        (false, true) => Verdict::Conditional,
        _ => Verdict::DoesNotHold,
    }
}

/// Samples in one common period (15/16 of an input turn).
const SAMPLES: usize = 2000;

/// How far the last common period of the input torque differs from the one before, relative to its own variation.
fn unlike_before(mut scene: Scene, go: Go<'_>) -> Result<f64, NativeError> {
    let period = TAU * 15.0 / 16.0 / scene.drive.input_speed_rad_s;
    scene.gear.backlash_m = 6e-4;
    scene.solver.sample_s = period / SAMPLES as f64;
    scene.solver.duration_s = 8.0 * period;
    let run = run(&scene, go)?;
    let torque = course(&run.courses, columns::INPUT_TORQUE);
    let last = torque.len().saturating_sub(SAMPLES);
    let (now, before) = (&torque[last..], &torque[last.saturating_sub(SAMPLES)..last]);
    let middle = mean(now);
    let off: f64 = now.iter().zip(before).map(|(a, b)| (a - b) * (a - b)).sum();
    let own: f64 = now.iter().map(|a| (a - middle) * (a - middle)).sum();
    Ok((off / own).sqrt())
}

pub(super) fn random_torque(go: Go<'_>) -> Result<Figure, NativeError> {
    let numbers = vec![
        unlike_before(scene(|_| {}), go)?,
        unlike_before(points(Some(600)), go)?,
        unlike_before(points(Some(4000)), go)?,
    ];
    let figure = format!(
        "one period differs from the one before by {:.1e} of its own variation; with 600 points {:.1e}, with 4000 {:.2}",
        numbers[0], numbers[1], numbers[2]
    );
    // A periodic motion repeats to a few per cent of its own ripple; a random one differs by about 140 %.
    let random = |share: f64| share > 0.5;
    let verdict = conditional(random(numbers[0]), numbers.iter().copied().any(random));
    Ok((figure, numbers, verdict))
}

/// Approach speed at first touch along the equilibria: the closing rate of a sleeve of nearly no penetration.
fn onset_speed(backlash: f64) -> Result<f64, NativeError> {
    let mut scene = scene(|s| s.gear.backlash_m = backlash);
    scene.contact.damping_n_s_m = 0.0;
    let gearbox = compile(&scene)?;
    let mut statics = Statics::new(&gearbox)?;
    let speed = scene.drive.input_speed_rad_s;
    let steps = 400;
    let h = TAU * 15.0 / 16.0 / 16.0 / f64::from(steps);
    let mut before: Option<Vec<PairContact>> = None;
    let mut fastest: f64 = 0.0;
    // Two steps into a contact its depth grows at the rate of the approach.
    for k in 0..=steps {
        let found = statics.solve(h * f64::from(k), scene.drive.output_torque_n_m)?;
        let now = statics.touching(&found);
        if let Some(before) = &before {
            for pair in now
                .iter()
                .filter(|p| matches!(p.sleeve, Sleeve::External(_)))
            {
                let same = |p: &&PairContact| p.wheel == pair.wheel && p.sleeve == pair.sleeve;
                if let Some(old) = before.iter().find(same)
                    && old.penetration_m < 2.0 * (pair.penetration_m - old.penetration_m)
                {
                    fastest = fastest.max((pair.penetration_m - old.penetration_m) * speed / h);
                }
            }
        }
        before = Some(now);
    }
    Ok(fastest)
}

pub(super) fn onset() -> Result<Figure, NativeError> {
    let numbers = vec![onset_speed(0.0)?, onset_speed(6e-4)?];
    let mut gear = Scene::paper().gear;
    gear.backlash_m = 6e-4;
    let figure = format!(
        "contacts begin at up to {:.2} mm/s without and {:.2} mm/s with 0.6 mm (free play {:.2} mrad)",
        1e3 * numbers[0],
        1e3 * numbers[1],
        1e3 * free_play(&gear)
    );
    let holds = numbers[1] > 1.2 * numbers[0];
    Ok((figure, numbers, verdict(holds)))
}
