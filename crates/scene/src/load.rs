//! Text of a scene file.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use pinwheel_files::{nearest, one_line, read_text};

use crate::error::SceneError;
use crate::presets::PRESETS;

/// Reads the text of a scene file.
pub(crate) fn read(spec: &str) -> Result<String, SceneError> {
    let path = Path::new(spec);
    match path.try_exists() {
        Ok(false) => Err(not_found(spec)),
        _ => Ok(read_text(
            path,
            "give a scene file (TOML) that you may read",
        )?),
    }
}

fn not_found(spec: &str) -> SceneError {
    let path = Path::new(spec);
    let folder = path.parent().filter(|folder| *folder != Path::new(""));
    let entries = std::fs::read_dir(folder.unwrap_or(Path::new(".")));
    let beside = entries
        .into_iter()
        .flatten()
        .flatten()
        .map(|entry| entry.path());
    let is_scene = |file: &PathBuf| {
        let end = file.extension().and_then(OsStr::to_str);
        matches!(end, Some("toml" | "json")) && file.is_file()
    };
    let files = beside.filter(is_scene).filter_map(|file| {
        let name = Path::new(file.file_name()?);
        Some(
            folder
                .map_or(name.to_owned(), |folder| folder.join(name))
                .display()
                .to_string(),
        )
    });
    let mut files: Vec<String> = files.collect();
    files.sort();
    let presets = || PRESETS.iter().map(|preset| preset.name);
    let known = presets().chain(files.iter().map(String::as_str));
    let remedy = match nearest(spec, known) {
        Some(name) if files.iter().any(|file| file == name) => {
            format!("did you mean the file `{}`?", one_line(name))
        }
        Some(name) => format!("did you mean the preset `{name}`?"),
        None => {
            let hard = |name: &&str| name.starts_with("hard-");
            let usual: Vec<&str> = presets().filter(|name| !hard(name)).collect();
            format!(
                "give the path of a scene file or a preset: {}, or one of {} that begin with hard-",
                usual.join(", "),
                presets().filter(hard).count()
            )
        }
    };
    SceneError::NotFound {
        spec: spec.to_owned(),
        remedy,
    }
}
