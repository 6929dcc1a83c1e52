//! `pinwheel bench`: what accuracy costs in every engine, integrator and step.

use pinwheel::pages;
use pinwheel::studies::bench::{self, Options, WorkPrecision};
use pinwheel::studies::folder::PAGE;

use crate::args::BenchArgs;
use crate::failure::{ENGINE, Failure, STOPPED};
use crate::folder::Folder;
use crate::progress::watched;
use crate::screen;

pub(crate) fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    let scene = args.scene.load()?.scene;
    let options = Options::asked(
        args.target,
        args.repeats.into(),
        args.longest,
        args.methods.clone(),
    )?;
    let engines = bench::engines(&args.solvers.join_named(&args.engines)?, &scene)?;
    let folder = Folder::of_scenes(&args.out, &[&args.scene.scene], "bench")?;
    let measured = watched(|control| bench::run(&scene, &engines, &options, control))?;

    let made = folder.write(|dir, made| measured.write(dir, made))?;
    let page = pages::bench::page(&measured, &made);
    let text = pages::bench::text(&measured);
    if measured.complete {
        folder.show(&page, &text)?;
        return Ok(ended(args, &measured));
    }
    let out = folder.publish_partial(&page)?;
    screen::show_with_page(&text, &out.join(PAGE))?;
    screen::complain(&format!(
        "stopped; what had been measured until then is in {}",
        out.display()
    ));
    Ok(STOPPED)
}

/// 3 if an engine that was asked for by name gave no point at all.
fn ended(args: &BenchArgs, measured: &WorkPrecision) -> u8 {
    let silent = measured.series.iter().find_map(|series| {
        let reason = pages::bench::failure(series)?;
        Some((series.label(), reason))
    });
    match silent {
        Some((label, reason)) if !args.engines.is_empty() => {
            screen::complain(&format!(
                "{label} gave no result: {reason}; leave it out with --engines, or change the scene"
            ));
            ENGINE
        }
        _ => 0,
    }
}
