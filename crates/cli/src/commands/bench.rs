//! `pinwheel bench`: what accuracy costs in every engine, integrator and step.

use pinwheel::pages;
use pinwheel::scene::did_you_mean;
use pinwheel::studies::Provenance;
use pinwheel::studies::bench::{self, Outcome};
use pinwheel::studies::precision::{self, Options};

use crate::args::{self, BenchArgs};
use crate::failure::{ENGINE, Failure, STOPPED};
use crate::folder::{self, Folder};
use crate::progress::watched;
use crate::screen;

pub(crate) fn bench(args: &BenchArgs) -> Result<u8, Failure> {
    let scene = args.scene.load()?.scene;
    let options = options(args)?;
    let engines = bench::engines(&args.solvers.join_named(&args.engines)?, &scene)?;
    let folder = Folder::prepare(&args.out.folder(&scene.name, "bench"), args.out.force)?;
    let parts: Vec<_> = args.parts.iter().map(|&part| part.into()).collect();
    let measured = watched("bench", |control| {
        bench::run(&scene, &engines, &options, &parts, control)
    })?;

    let made = Provenance::here(args::typed());
    measured.write(folder.path(), &made)?;
    let page = pages::bench::page(&measured, &made)?;
    folder.write_page(&page)?;
    let out = if measured.complete {
        folder.publish()?
    } else {
        folder.publish_partial()?
    };
    screen::show_with_page(&pages::bench::text(&measured), &folder::page(&out))?;
    if !measured.complete {
        screen::complain(&format!(
            "stopped; what had been measured until then is in {}",
            out.display()
        ));
        return Ok(STOPPED);
    }
    Ok(ended(args, &measured))
}

/// 3 if an engine that was asked for by name gave no point at all.
fn ended(args: &BenchArgs, measured: &Outcome) -> u8 {
    let series = measured.study.iter().flat_map(|study| &study.series);
    let silent = series.into_iter().find_map(|series| {
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

fn options(args: &BenchArgs) -> Result<Options, Failure> {
    let positive = |name: &str, value: f64| {
        if value > 0.0 && value.is_finite() {
            Ok(value)
        } else {
            Err(Failure::input(format!(
                "--{name} {value} is not a positive number; leave it out for the default"
            )))
        }
    };
    let known = precision::method_names();
    for name in &args.methods {
        if !known.contains(&name.as_str()) {
            return Err(Failure::input(format!(
                "there is no integrator `{name}`; {}",
                did_you_mean(name, &known)
            )));
        }
    }
    if args.repeats == 0 {
        return Err(Failure::input(
            "--repeats 0 measures nothing; use 1 or more",
        ));
    }
    let longest_s = positive("longest", args.longest)?;
    Ok(Options {
        target: positive("target", args.target)?,
        repeats: args.repeats,
        longest_s,
        longest_native_s: 0.1 * longest_s,
        methods: args.methods.clone(),
        ..Options::default()
    })
}
