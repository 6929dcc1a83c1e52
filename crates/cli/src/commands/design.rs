//! `pinwheel init` and `pinwheel design`: a scene from catalogue data, and design figures of a scene.

use std::path::Path;
use std::time::Instant;

use pinwheel::pages;
use pinwheel::scene::catalogue::ARGUMENTS;
use pinwheel::scene::keys::longest_first;
use pinwheel::scene::quantity::in_units;
use pinwheel::scene::{Fault, schema};
use pinwheel::studies::design;

use super::idle;
use crate::args::{DesignArgs, InitArgs, quoted};
use crate::failure::{DIFFER, Failure};
use crate::folder::{self, Folder};
use crate::progress::watched;
use crate::screen;

pub(crate) fn init(args: &InitArgs) -> Result<(), Failure> {
    let to_screen = args.file == Path::new("-");
    let stem = args.file.file_stem().filter(|_| !to_screen);
    let name = stem.map_or_else(|| "mine".into(), |stem| stem.to_string_lossy().into_owned());
    let catalogue = args.catalogue(name)?;
    let draft = catalogue.draft().map_err(|fault| by_flag(&fault))?;
    if to_screen {
        return screen::show(&draft.text);
    }
    let name = args.file.file_name().unwrap_or_default().to_string_lossy();
    let study = draft.study(&name);
    let place = args.file.with_extension("tolerances.toml");
    let scene = format!("#:schema ./{SCHEMA}\n{}", draft.text);
    let schema_file = args.file.with_file_name(SCHEMA);
    let schema = screen::as_json(&schema::schema())?;
    let mut files: Vec<(&Path, &str, fn(&[u8]) -> bool)> = vec![(&args.file, &scene, is_scene)];
    files.extend(study.iter().map(|text| (&*place, &**text, is_study as _)));
    for (path, _, ours) in &files {
        folder::check(path, ours)?;
        if path.exists() && !args.force {
            return Err(Failure::input(format!(
                "{} is there already; name another file, or replace it with --force",
                path.display()
            )));
        }
    }
    files.push((&schema_file, &schema, is_schema));
    folder::check(&schema_file, &is_schema)?;
    // The scene comes last, because it refers to the other files.
    for (path, text, ours) in files.iter().rev() {
        folder::replace(path, text.as_bytes(), ours)?;
    }
    let weak = watched(|control| design::Limits::too_weak(&catalogue, control.cancel))?;
    let shown = |path: &Path| quoted(&path.display().to_string());
    let then = study.map_or_else(String::new, |_| {
        format!("\nthen    pinwheel sweep {}", shown(&place))
    });
    screen::show(&format!(
        "{}\nscene   {}\nnext    pinwheel design {}{then}",
        pages::design::draft(&draft, weak),
        args.file.display(),
        shown(&args.file)
    ))
}

/// File beside a scene, by which editors complete and check it.
const SCHEMA: &str = "scene.schema.json";

/// Returns true for a schema of scenes, of this version or another.
fn is_schema(content: &[u8]) -> bool {
    String::from_utf8_lossy(content).contains(schema::TITLE)
}

/// Returns true for the text of a study of tolerances, valid or not.
fn is_study(content: &[u8]) -> bool {
    lines(content).any(|line| line == b"[sample]")
}

/// Returns true for the text of a scene, valid or not.
fn is_scene(content: &[u8]) -> bool {
    lines(content).any(|line| line == b"[gear]" || line.starts_with(b"base = "))
}

fn lines(content: &[u8]) -> impl Iterator<Item = &[u8]> {
    content.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii)
}

/// Converts a fault of keys to one of their flags; keys outside of backticks become words, lengths millimetres.
fn by_flag(fault: &Fault) -> Failure {
    let flag = |name: &str| format!("--{}", name.replace('_', "-"));
    let flagged = |text: String, (key, name): &(&str, &str)| {
        text.replace(&format!("`{key}`"), &format!("`{}`", flag(name)))
    };
    let text = ARGUMENTS.iter().fold(fault.to_string(), flagged);
    let text = longest_first().fold(text, |text, row| text.replace(row.name, &row.words()));
    Failure::input(in_units(&text, &[("m", ("mm", 1e3))]))
}

pub(crate) fn design(args: &DesignArgs) -> Result<u8, Failure> {
    let gearbox = args.scene.load()?;
    let folder = Folder::of_scenes(&args.out, &[&args.scene.scene], "design")?;
    let begun = Instant::now();
    let mut design = watched(|control| design::run(&gearbox, !args.statics, control))?;
    let took = begun.elapsed();
    if let Some(stated) = args.stated_stiffness_n_m_arcmin {
        design.fit_rest(stated)?;
    }
    let origin = folder.write(|dir, origin| design.write(dir, origin))?;
    let html = pages::design::page(&design, &origin);
    let text = pages::design::text(&design, screen::manner().verbose);
    let (answer, why) = pages::design::answer(&design.limits);
    screen::answer(format!("bears its load: {answer}; {why}"));
    folder.show(&html, &text)?;
    let of = "the figures and files of this design";
    idle::name(&args.scene, &gearbox, of, |settings, control| {
        settings.idle_in_design(&design, took, control, |other| {
            pages::design::page(other, &origin) == html
        })
    })?;
    Ok(design.limits.exceeded().map_or(0, |_| DIFFER))
}
