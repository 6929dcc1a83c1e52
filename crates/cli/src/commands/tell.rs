//! `pinwheel explain`, `engines`, `laws` and `schema`: information without a run.

use pinwheel::studies::{choice, explained};
use pinwheel::{engines::external, pages, scene};

use super::idle;
use crate::args::ExplainArgs;
use crate::failure::Failure;
use crate::screen;

/// Shows a scene's model, its assumptions and its expected figures.
pub(crate) fn explain(args: &ExplainArgs) -> Result<(), Failure> {
    let gearbox = args.scene.load()?;
    let explained = explained::explain(&gearbox);
    screen::show_or_json(&explained, || pages::explain::text(&explained))?;
    let engine = choice::find("native", &gearbox.scene)?;
    let of = "the native time series of this scene";
    idle::name(&args.scene, &gearbox, of, |settings, control| {
        settings.idle_in_explanation(engine.as_ref(), control)
    })
}

/// Shows the engines that this build can compare.
pub(crate) fn engines() -> Result<(), Failure> {
    let listed = choice::listed();
    screen::show_or_json(&listed, || pages::engines::text(&listed))
}

/// Shows the available contact laws.
pub(crate) fn laws() -> Result<(), Failure> {
    screen::show_or_json(&pages::laws::json(), pages::laws::text)
}

/// Shows the schema of scenes for editors, or of job files for external solvers.
pub(crate) fn schema(job: bool) -> Result<(), Failure> {
    screen::show_json(&match job {
        true => external::job_schema(),
        false => scene::schema::schema(),
    })
}
