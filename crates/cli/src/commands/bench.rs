//! `pinwheel bench`: cost of accuracy for every engine, integrator and step.

use pinwheel::pages;
use pinwheel::studies::bench::{self, Options, Series};
use pinwheel::studies::folder::PAGE;

use crate::args::BenchArgs;
use crate::failure::{Failure, STOPPED};
use crate::folder::Folder;
use crate::progress::watched;
use crate::screen;

pub(crate) fn bench(args: &BenchArgs) -> Result<(), Failure> {
    let scene = args.scene.load()?.scene;
    let (repeats, methods) = (args.repeats.into(), args.methods.clone());
    let options = Options::asked(args.target, repeats, args.longest, methods)?;
    let engines = bench::engines(&args.solvers.join_named(&args.engines)?, &scene)?;
    let folder = Folder::of_scenes(&args.out, &[&args.scene.scene], "bench")?;
    let measured = watched(|control| bench::run(&scene, &engines, &options, control))?;

    let origin = folder.write(|dir, origin| measured.write(dir, origin))?;
    let page = pages::bench::page(&measured, &origin);
    let text = pages::bench::text(&measured);
    if !measured.complete {
        let out = folder.publish_partial(&page)?;
        screen::show_with_page(&text, &out.join(PAGE))?;
        let stopped = "stopped; what had been measured until then is in";
        let message = format!("{stopped} {}", out.display());
        return Err(Failure::new(STOPPED, message));
    }
    folder.show(&page, &text)?;
    // A named engine without any point.
    let failed = |series: &Series| Some((series.label(), pages::bench::failure(series)?));
    match measured.series.iter().find_map(failed) {
        Some((label, reason)) if !args.engines.is_empty() => Err(Failure::engine(format!(
            "{label} gave no result: {reason}; leave it out with --engines, or change the scene"
        ))),
        _ => Ok(()),
    }
}
