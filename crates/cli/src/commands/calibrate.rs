//! `pinwheel calibrate`: what verdicts are worth.

use std::ops::Range;
use std::time::Duration;

use pinwheel::pages;
use pinwheel::scene::{CheckedScene, Override, Scene};
use pinwheel::studies::Provenance;
use pinwheel::studies::calibration::{self, gears, power};
use pinwheel::studies::choice;
use pinwheel::studies::comparison::Effort;

use crate::args::{self, CalibrateArgs};
use crate::failure::{EXCEEDED, Failure};
use crate::folder::Folder;
use crate::progress::watched;
use crate::screen;

pub(crate) fn calibrate(args: &CalibrateArgs) -> Result<u8, Failure> {
    let longest = Duration::try_from_secs_f64(args.longest)
        .map_err(|_| Failure::input("--longest: give seconds, 0 or more"))?;
    let (presets, resolution) = if args.power {
        (&power::GEARS[..], power::RESOLUTION)
    } else {
        (&calibration::PRESETS[..], 0.01)
    };
    let effort = Effort {
        longest,
        obey: false,
        resolution,
    };
    let mut scenes = if args.scenes.is_empty() {
        let load = |(name, duration): &(&str, f64)| preset(name, *duration);
        presets.iter().map(load).collect::<Result<Vec<_>, _>>()?
    } else {
        let load = |name: &String| Scene::load(name, &[]).map_err(Failure::from);
        args.scenes
            .iter()
            .map(load)
            .collect::<Result<Vec<_>, _>>()?
    };
    let folder = Folder::prepare(&args.out.folder("verdicts", "calibrate"), args.out.force)?;
    let made = Provenance::here(args::typed());
    let (text, good) = if args.power {
        let input = power::Input {
            scenes,
            right: "native-reduced".to_owned(),
            engines: engines(args, |name| !name.starts_with("native"))?,
            effort,
            smallest: true,
        };
        let found = watched("calibrate", |control| power::run(&input, control))?;
        found.write(folder.path(), &made)?;
        let told = found.found.iter().all(|one| one.told) && found.false_alarms.is_empty();
        (pages::calibration::power(&found), told)
    } else {
        if args.scenes.is_empty() {
            for seed in seeds(&args.gears)? {
                let gear = gears::gear(seed).ok_or_else(|| {
                    Failure::input(format!("--gears: seed {seed} gives no gear; take others"))
                })?;
                let gear = gear.check();
                scenes.push(gear.map_err(|fault| Failure::input(fault.to_string()))?);
            }
        }
        let input = calibration::Input {
            scenes,
            engines: engines(args, |_| true)?,
            effort,
        };
        let found = watched("calibrate", |control| calibration::run(&input, control))?;
        found.write(folder.path(), &made)?;
        (pages::calibration::text(&found), found.is_honest())
    };
    let out = folder.publish()?;
    screen::show(&format!(
        "{text}\ncases: {}",
        out.join("summary.json").display()
    ))?;
    Ok(if good { 0 } else { EXCEEDED })
}

fn preset(name: &str, duration_s: f64) -> Result<CheckedScene, Failure> {
    let duration = Override::new("solver.duration_s", duration_s.to_string());
    Ok(Scene::load(name, &[duration])?)
}

/// The engines asked for, or those of this build that `wanted` takes.
fn engines(args: &CalibrateArgs, wanted: impl Fn(&str) -> bool) -> Result<Vec<String>, Failure> {
    let listed = choice::listed();
    let is_known = |name: &str| listed.iter().any(|engine| engine.name == name);
    if args.engines.is_empty() {
        let of_study = calibration::ENGINES.iter().copied();
        let built = of_study.filter(|name| is_known(name) && wanted(name));
        return Ok(built.map(str::to_owned).collect());
    }
    for name in &args.engines {
        if !calibration::ENGINES.contains(&name.as_str()) {
            return Err(Failure::input(format!(
                "--engines: `{name}` has no ladder to be held against; take some of {}",
                calibration::ENGINES.join(", ")
            )));
        }
        choice::find(name, &Scene::paper()).map_err(|error| Failure::input(error.to_string()))?;
    }
    Ok(args.engines.clone())
}

fn seeds(text: &str) -> Result<Range<u64>, Failure> {
    let ends = text.split_once("..");
    let range = ends.and_then(|(from, to)| Some(from.parse().ok()?..to.parse().ok()?));
    range
        .filter(|range| !range.is_empty() && range.end - range.start <= 10_000)
        .ok_or_else(|| {
            Failure::input(format!(
                "--gears: `{text}` is no range of seeds; write it like 1000..1024"
            ))
        })
}
