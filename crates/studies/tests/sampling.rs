//! A figure and its +- do not hang on how often a run is sampled, nor on which of its mirror images or sizes it is.
//!
//! `PINWHEEL_GEARS=200` looks at that many random gears.

#![allow(
    clippy::print_stdout,
    reason = "the shares of figures outside of their uncertainty are what one looks at"
)]

use pinwheel_compare::quantities::derive;
use pinwheel_engines::{Engine, Native};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{Override, Scene};
use pinwheel_studies::calibration::gears;
use pinwheel_studies::{Control, single};
use pinwheel_timeseries::columns;
use pinwheel_timeseries::norms::{Statistics, View};

/// Gears of an ordinary test run.
const GEARS: u64 = 10;

/// A figure with its uncertainty, and what both were when figures were those of samples.
#[derive(Debug, Clone)]
struct Known {
    name: String,
    from_s: f64,
    now: [f64; 2],
    then: [f64; 2],
}

/// All figures of a run that says how far they may be off; nothing of one that does not.
fn figures(scene: Scene, engine: &dyn Engine) -> Vec<Known> {
    let Ok(gearbox) = scene
        .check()
        .map_err(drop)
        .and_then(|s| Gearbox::new(&s).map_err(drop))
    else {
        return Vec::new();
    };
    let Ok(found) = single::run(&gearbox, engine, true, &Control::quiet()) else {
        return Vec::new();
    };
    let resolved = found
        .run
        .uncertainty
        .as_ref()
        .is_some_and(|u| u.is_resolved());
    if !resolved {
        return Vec::new();
    }
    let (results, run) = (found.results(), &found.run.time_series);
    let window = run.window(results.from_s, f64::INFINITY);
    let quantities = derive([run]);
    let known = results.figures.iter().filter_map(|figure| {
        let (which, quantity) = figure.name.split_once('_')?;
        let channels = &quantities.iter().find(|q| q.name == quantity)?.channels;
        let of = Statistics::of(&View::of(run, channels, window.clone())?)?;
        let value = match which {
            "mean" => of.mean,
            "min" => of.min,
            "max" => of.max,
            _ => of.peak,
        };
        let all = figure.uncertainty?;
        Some(Known {
            name: figure.name.clone(),
            from_s: results.from_s,
            now: [figure.value, all],
            then: [value, all - figure.sampling.unwrap_or(0.0)],
        })
    });
    known.collect()
}

/// The same motion of a gear whose stiffness, masses and loads are so many times as large.
fn scaled(scene: &Scene, factor: f64) -> Scene {
    let mut scene = scene.clone();
    let contact = &mut scene.contact;
    contact.young_pa *= factor;
    contact.damping_n_s_m *= factor;
    contact.constant_stiffness_n_m15 *= factor;
    let mass = &mut scene.mass;
    mass.density_kg_m3 = mass.density_kg_m3.map(|density| factor * density);
    for body in [
        &mut mass.input_shaft,
        &mut mass.output_shaft,
        &mut mass.wheel,
        &mut mass.internal_sleeve,
        &mut mass.external_sleeve,
    ] {
        body.mass_kg *= factor;
        body.moment_kg_m2 *= factor;
    }
    scene.drive.output_torque_n_m *= factor;
    for change in &mut scene.drive.load_changes {
        change.output_torque_n_m *= factor;
    }
    scene
}

/// The gear in a mirror.
fn mirrored(scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.drive.input_speed_rad_s *= -1.0;
    scene.drive.output_torque_n_m *= -1.0;
    for change in &mut scene.drive.load_changes {
        change.output_torque_n_m *= -1.0;
    }
    scene
}

/// A torque in a mirror has the other sign, and its minimum is a maximum.
fn back(mut known: Known) -> Known {
    if known.name.ends_with(columns::INPUT_TORQUE) {
        (known.now[0], known.then[0]) = (-known.now[0], -known.then[0]);
        known.name = match known.name.split_once('_') {
            Some(("min", rest)) => format!("max_{rest}"),
            Some(("max", rest)) => format!("min_{rest}"),
            _ => known.name,
        };
    }
    known
}

/// Figures seen, those outside of their uncertainty when they were of samples, and now.
#[derive(Debug, Default, Clone, Copy)]
struct Share {
    seen: usize,
    then: usize,
    now: usize,
}

impl Share {
    fn count(&mut self, label: &str, [one, other]: [&[Known]; 2]) {
        let outside = |[a, u]: [f64; 2], [b, v]: [f64; 2]| {
            // Solutions of scaled equations have other roundings.
            (a - b).abs() > u + v + 1e-9 * a.abs().max(b.abs())
        };
        for a in one {
            // A window begins at a sample: other samples may give another window.
            let same = |b: &&Known| b.name == a.name && (b.from_s / a.from_s - 1.0).abs() < 1e-6;
            let Some(b) = other.iter().find(same) else {
                continue;
            };
            self.seen += 1;
            self.then += usize::from(outside(a.then, b.then));
            if outside(a.now, b.now) {
                self.now += 1;
                println!("{label}: {} {:?} {:?}", a.name, a.now, b.now);
            }
        }
    }
}

/// Both commands are of the same run, sampled ten times as often by the second: the first was 8 % off in the peak, with a +- of
/// 0.01 %.
#[test]
fn regress_peaks_do_not_hang_on_samples() {
    let sets = ["solver.integrator=auto", "solver.duration_s=0.02"];
    let steel = |sample_s: &str| {
        let sets = sets.iter().filter_map(|set| set.split_once('='));
        let mut sets: Vec<Override> = sets.map(|(k, v)| Override::new(k, v)).collect();
        sets.push(Override::new("solver.sample_s", sample_s));
        let scene = Scene::load("steel", &sets).unwrap().into_scene();
        figures(scene, &Native::REDUCED)
    };
    let (rare, often) = (steel("1e-4"), steel("1e-5"));
    let mut share = Share::default();
    share.count("steel", [&rare, &often]);
    assert!(
        share.seen >= 7 && share.then > 4 && share.now == 0,
        "{share:?}"
    );
}

/// Of random gears by `native-resolved`: sampled twice and ten times as often, in a mirror, with a thousandth of stiffness, masses
/// and loads, and by the Lagrange form.
#[test]
fn hard_figures_hang_on_nothing_else() {
    let asked = std::env::var("PINWHEEL_GEARS").ok();
    let gears = asked.and_then(|gears| gears.parse().ok()).unwrap_or(GEARS);
    let labels = ["half", "tenth", "mirror", "a thousandth", "lagrange"];
    let mut shares = [Share::default(); 5];
    for seed in 0..gears {
        let mut scene = gears::gear(seed).unwrap();
        scene.solver.integrator = "auto".to_owned();
        let sampled = |parts: f64| {
            let mut scene = scene.clone();
            scene.solver.sample_s /= parts;
            figures(scene, &Native::REDUCED)
        };
        let own = sampled(1.0);
        if own.is_empty() {
            continue;
        }
        let in_mirror = figures(mirrored(&scene), &Native::REDUCED);
        let mut small = figures(scaled(&scene, 1e-3), &Native::REDUCED);
        for known in &mut small {
            known.now = known.now.map(|x| 1000.0 * x);
            known.then = known.then.map(|x| 1000.0 * x);
        }
        let others = [
            sampled(2.0),
            sampled(10.0),
            in_mirror.into_iter().map(back).collect(),
            small,
            figures(scene.clone(), &Native::LAGRANGE),
        ];
        for ((share, label), other) in shares.iter_mut().zip(labels).zip(&others) {
            // Constants of that law have units.
            if label == "a thousandth" && scene.contact.law == "line-contact" {
                continue;
            }
            share.count(
                &format!("{seed}, {label}, {}", scene.contact.law),
                [&own, other],
            );
        }
    }
    let mut all = Share::default();
    for (label, share) in labels.iter().zip(shares) {
        println!(
            "{label}: of {} figures {} outside, {} when they were of samples",
            share.seen, share.now, share.then
        );
        all.seen += share.seen;
        all.now += share.now;
        all.then += share.then;
    }
    println!("all: {all:?}");
    assert!(all.seen > 150 * gears as usize / GEARS as usize);
    assert!(
        all.now * 50 <= all.seen && all.then > 4 * all.now,
        "{all:?}"
    );
}
