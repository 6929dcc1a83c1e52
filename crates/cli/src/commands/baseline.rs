//! `pinwheel baseline`: accepted results of the solver, and changes since.

use pinwheel::pages;
use pinwheel::studies::baseline::{self, Baseline, FILE, Options, Verdict, made};
use pinwheel::studies::junit;

use crate::args::{Action, BaselineArgs, CheckArgs, RecordBaselineArgs, Which};
use crate::failure::{DIFFER, Failure, INCONCLUSIVE};
use crate::folder::{Folder, Request, check_junit, name_leftovers};
use crate::progress::watched;
use crate::{interrupt, screen};

pub(crate) fn baseline(args: &BaselineArgs) -> Result<u8, Failure> {
    match &args.action {
        Action::Record(args) => record_baseline(args),
        Action::Check(args) => check(args),
    }
}

fn record_baseline(args: &RecordBaselineArgs) -> Result<u8, Failure> {
    let Which { dir, name } = &args.which;
    let folder = Baseline::folder(dir, name)?;
    let earlier = Baseline::earlier(&folder)?;
    let reason = args.accept.as_deref().map(str::trim);
    if earlier.is_some() && reason.is_none_or(str::is_empty) {
        return Err(Failure::input(format!(
            "{} exists; say why its results may change: --accept \"reason\", or choose another name",
            folder.display()
        )));
    }
    interrupt::check()?;
    Baseline::check_place(&folder)?;
    name_leftovers(&folder.join(FILE));
    let options = args.running.options()?;
    let here = made(options.kernel);
    let reason = reason.unwrap_or("first record");
    let recorded = watched(|control| baseline::record(here, earlier, reason, &options, control))?;
    let text = pages::baseline::recorded(name, &recorded);
    if recorded.scenes.is_empty() {
        let text = text.replace('\n', "; ");
        let message = format!("{text}; name other scenes by --only");
        return Err(Failure::new(INCONCLUSIVE, message));
    }
    interrupt::check()?;
    recorded.baseline.write(&folder)?;
    screen::show(&format!(
        "{text}\nin {}; look at the diff before you commit it",
        folder.display()
    ))?;
    // A named scene that was omitted is not stored.
    let lacks = !(args.running.only.is_empty() || recorded.left_out.is_empty());
    Ok(if lacks { INCONCLUSIVE } else { 0 })
}

fn check(args: &CheckArgs) -> Result<u8, Failure> {
    let Which { dir, name } = &args.which;
    let accepted = Baseline::open(dir, name)?;
    let out = args.out.or(format!("baseline-{name}"));
    let request = Request {
        force: args.out.force,
        inputs: vec![dir.clone()],
        ..Request::default()
    };
    let folder = Folder::asked(&out, request)?;
    check_junit(args.junit.as_deref(), &out)?;
    let options = Options {
        kernel: args.kernel,
        stages: true,
        ..args.running.options()?
    };
    let here = made(options.kernel);
    let check = watched(|control| baseline::check(&accepted, here, &options, control))?;

    let origin = folder.write(|dir, of| baseline::write(name, &check, &accepted, dir, of))?;
    let page = pages::baseline::page(name, &accepted, &check, &origin);
    folder.show(&page, &pages::baseline::text(name, &check))?;
    if let Some(path) = &args.junit {
        let suite = junit::of_baseline(name, &check);
        junit::write(path, "pinwheel baseline", vec![suite])?;
    }
    Ok(match check.verdict {
        Verdict::Worse => DIFFER,
        Verdict::New => INCONCLUSIVE,
        _ => 0,
    })
}
