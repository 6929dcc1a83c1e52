//! `pinwheel record`: stored time series of the Python engines for builds and machines without them.

use pinwheel::studies::output::file_name;
use pinwheel::studies::recording::{self, Recorded};

use crate::args::RecordArgs;
use crate::failure::{ENGINE, Failure};
use crate::folder::name_leftovers;
use crate::progress::watched;
use crate::screen;

pub(crate) fn record(args: &RecordArgs) -> Result<u8, Failure> {
    let mut failed = false;
    for scene in &recording::scenes(&args.scenes)? {
        name_leftovers(&args.out.join(file_name(&scene.name)).join("draft"));
        let engines = recording::engines(&args.engines, scene)?;
        if engines.is_empty() {
            return Err(Failure::engine(
                "this build has no engines to record; build with --features crossval",
            ));
        }
        for engine in engines {
            let recorded =
                watched(|control| recording::record(engine.as_ref(), scene, &args.out, control))?;
            failed |= matches!(recorded, Recorded::Broken(_));
            let text = match recorded {
                Recorded::Kept { samples, bytes } => {
                    format!("{samples} samples, {} kB", bytes / 1000)
                }
                Recorded::Left(reason) | Recorded::Broken(reason) => {
                    format!("not recorded: {reason}")
                }
            };
            screen::show(&format!("{} {}: {text}", scene.name, engine.name()))?;
        }
    }
    Ok(if failed { ENGINE } else { 0 })
}
