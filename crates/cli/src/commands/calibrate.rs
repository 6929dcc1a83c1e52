//! `pinwheel calibrate`: what verdicts are worth.

use std::time::Duration;

use pinwheel::pages;
use pinwheel::scene::Scene;
use pinwheel::studies::Provenance;
use pinwheel::studies::calibration::{self, chosen};
use pinwheel::studies::comparison::Effort;

use crate::args::{self, CalibrateArgs};
use crate::failure::{DIFFER, Failure};
use crate::folder::{Folder, all_or};
use crate::progress::watched;
use crate::screen::{self, SUMMARY};

pub(crate) fn calibrate(args: &CalibrateArgs) -> Result<u8, Failure> {
    let longest = Duration::try_from_secs_f64(args.longest)
        .map_err(|_| Failure::input("--longest: give seconds, 0 or more"))?;
    let named = args.scenes.iter().map(|name| Scene::load(name, &[]));
    let mut scenes = named.collect::<Result<Vec<_>, _>>()?;
    if args.scenes.is_empty() {
        scenes = chosen::presets(&calibration::PRESETS)?;
        scenes.extend(chosen::random(args.gears.clone())?);
    }
    let folder = Folder::of(&args.out, "verdicts-calibrate", &all_or(&args.scenes))?;
    let made = Provenance::here(args::typed());
    let input = calibration::Input {
        scenes,
        engines: chosen::engines(&args.engines)?,
        effort: Effort {
            longest,
            obey: false,
            resolution: 0.01,
        },
    };
    let found = watched("calibrate", |control| calibration::run(&input, control))?;
    found.write(&input, folder.path(), &made)?;
    let out = folder.publish()?;
    screen::show_found(&pages::calibration::text(&found), &out, SUMMARY)?;
    if !screen::manner().json {
        screen::show(&format!("cases: {}", out.join(SUMMARY).display()))?;
    }
    Ok(if found.is_honest() { 0 } else { DIFFER })
}
