//! Settings of a command line that do nothing, named on stderr once the results are out.

use pinwheel::gearbox::Gearbox;
use pinwheel::studies::effect::Settings;
use pinwheel::studies::{Control, StudyError};

use crate::args::{self, SceneArgs};
use crate::failure::{Failure, STOPPED};
use crate::progress::watched;
use crate::screen;

/// Names the settings of `args`, whose scene is `gearbox`, without which `of` are equal to the bit by `find`.
pub(super) fn name(
    args: &SceneArgs,
    gearbox: &Gearbox,
    of: &str,
    find: impl FnOnce(Settings<'_>, &Control<'_>) -> Result<Vec<usize>, StudyError>,
) -> Result<(), Failure> {
    if args.set.is_empty() {
        return Ok(());
    }
    let settings = Settings {
        spec: &args.scene,
        sets: &args::overrides(&args.set)?,
        gearbox,
    };
    let idle = watched(|control| find(settings, control)).map_err(|error| match error {
        StudyError::Cancelled => Failure::new(STOPPED, "stopped; the results are complete"),
        error => error.into(),
    })?;
    for set in idle.iter().map(|place| &args.set[*place]) {
        screen::show_on_stderr(&format!(
            "note: --set {set} has no effect on {of}: without it they are equal to the bit"
        ));
    }
    Ok(())
}
