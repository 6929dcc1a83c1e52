//! `pinwheel calibrate`: what verdicts are worth.

use std::time::Duration;

use pinwheel::engines::family;
use pinwheel::pages;
use pinwheel::scene::Scene;
use pinwheel::studies::Provenance;
use pinwheel::studies::calibration::{self, chosen, power};
use pinwheel::studies::comparison::Effort;

use crate::args::{self, CalibrateArgs};
use crate::failure::{DIFFER, Failure};
use crate::folder::Folder;
use crate::progress::watched;
use crate::screen;

pub(crate) fn calibrate(args: &CalibrateArgs) -> Result<u8, Failure> {
    let longest = Duration::try_from_secs_f64(args.longest)
        .map_err(|_| Failure::input("--longest: give seconds, 0 or more"))?;
    let named = args.scenes.iter().map(|name| Scene::load(name, &[]));
    let mut scenes = named.collect::<Result<Vec<_>, _>>()?;
    if args.scenes.is_empty() {
        scenes = chosen::presets(if args.power {
            &power::GEARS
        } else {
            &calibration::PRESETS
        })?;
        if !args.power {
            scenes.extend(chosen::random(args.gears.clone())?);
        }
    }
    let effort = |resolution| Effort {
        longest,
        obey: false,
        resolution,
    };
    let folder = Folder::prepare(&args.out.folder("verdicts", "calibrate"), args.out.force)?;
    let made = Provenance::here(args::typed());
    let (text, good) = if args.power {
        let input = power::Input {
            scenes,
            right: "native-reduced".to_owned(),
            engines: chosen::engines(&args.engines, |name| family(name) != "native")?,
            effort: effort(power::RESOLUTION),
            smallest: true,
        };
        let found = watched("calibrate", |control| power::run(&input, control))?;
        found.write(folder.path(), &made)?;
        let told = found.found.iter().all(|one| one.told) && found.false_alarms.is_empty();
        (pages::calibration::power(&found), told)
    } else {
        let input = calibration::Input {
            scenes,
            engines: chosen::engines(&args.engines, |_| true)?,
            effort: effort(0.01),
        };
        let found = watched("calibrate", |control| calibration::run(&input, control))?;
        found.write(&input, folder.path(), &made)?;
        (pages::calibration::text(&found), found.is_honest())
    };
    let out = folder.publish()?;
    screen::show(&format!(
        "{text}\ncases: {}",
        out.join("summary.json").display()
    ))?;
    Ok(if good { 0 } else { DIFFER })
}
