//! Settings of a command line that do nothing, named on stderr.

use pinwheel::gearbox::Gearbox;
use pinwheel::studies::effect::Settings;
use pinwheel::studies::{Control, StudyError};

use crate::args::{self, SceneArgs};
use crate::failure::Failure;
use crate::progress::watched;
use crate::screen;

/// Finds the settings of `args`, whose scene is `gearbox`, that do nothing by `find`, under the progress of the command `label`.
pub(super) fn find(
    label: &str,
    args: &SceneArgs,
    gearbox: &Gearbox,
    find: impl FnOnce(Settings<'_>, &Control<'_>) -> Result<Vec<usize>, StudyError>,
) -> Result<Vec<usize>, Failure> {
    let settings = Settings {
        spec: &args.scene,
        sets: &args::overrides(&args.set)?,
        gearbox,
    };
    Ok(watched(label, |control| find(settings, control))?)
}

/// Names those at the places `idle`, without which `of` are equal to the bit.
pub(super) fn name(args: &SceneArgs, idle: &[usize], of: &str) {
    for set in idle.iter().map(|place| &args.set[*place]) {
        screen::show_on_stderr(&format!(
            "note: --set {set} has no effect on {of}: without it they are equal to the bit"
        ));
    }
}
