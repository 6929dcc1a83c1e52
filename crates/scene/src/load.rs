//! The text of a scene file.

use std::path::Path;

use pinwheel_files::{nearest, read_text};

use crate::error::SceneError;
use crate::presets::PRESETS;

/// The text of a scene file.
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
    let names = || PRESETS.iter().map(|preset| preset.name);
    let remedy = match nearest(spec, names()) {
        Some(name) => format!("did you mean the preset `{name}`?"),
        None => {
            let all: Vec<&str> = names().collect();
            format!(
                "give the path of a scene file or a preset: {}",
                all.join(", ")
            )
        }
    };
    SceneError::NotFound {
        spec: spec.to_owned(),
        remedy,
    }
}
