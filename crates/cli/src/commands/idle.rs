//! Settings on the command line without effect, reported on stderr after the results.

use pinwheel::gearbox::Gearbox;
use pinwheel::studies::effect::Settings;
use pinwheel::studies::{Control, StudyError};

use crate::args::{self, SceneArgs};
use crate::failure::{Failure, STOPPED};
use crate::progress::watched;
use crate::screen;

/// Reports the settings of `args` without effect: `find` returns those without which results `of` the scene are equal to
/// the bit.
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
