//! `pinwheel explain`: what a scene models, assumes and lets one expect, without running it.

use pinwheel::pages;
use pinwheel::studies::explained;

use crate::args::ExplainArgs;
use crate::failure::Failure;
use crate::screen;

pub(crate) fn explain(args: &ExplainArgs) -> Result<u8, Failure> {
    let gearbox = args.scene.load()?;
    let explanation =
        explained::explain(&gearbox).map_err(|error| Failure::input(error.to_string()))?;
    screen::show_or_json(args.out.json, &explanation, || {
        pages::explain::text(&explanation)
    })
    .map(|()| 0)
}
