//! The text of a scene file.

use std::fs::File;
use std::io::Read as _;
use std::path::Path;

use crate::error::SceneError;
use crate::presets::PRESETS;
use crate::suggest::nearest;

/// Bytes of a scene file at most; a full one with comments has about 5000.
pub const MOST_BYTES: usize = 1 << 20;

/// The text of a scene file.
pub(crate) fn read(spec: &str) -> Result<String, SceneError> {
    let path = Path::new(spec);
    let unreadable = |source| SceneError::Unreadable {
        path: path.to_owned(),
        source,
    };
    let file = match File::open(path) {
        Ok(file) => file,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Err(not_found(spec)),
        Err(error) => return Err(unreadable(error)),
    };
    // The size is not asked for in advance: a pipe or a device has none and may never end.
    let mut bytes = Vec::new();
    file.take(MOST_BYTES as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() > MOST_BYTES {
        return Err(SceneError::TooLong {
            source_name: spec.to_owned(),
            limit: MOST_BYTES,
        });
    }
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let head = String::from_utf8_lossy(&error.as_bytes()[..valid]);
        SceneError::NotText {
            source_name: spec.to_owned(),
            line: line_of(&head, head.len()),
        }
    })
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

/// Line number of a byte offset, the first being 1.
pub(crate) fn line_of(text: &str, offset: usize) -> usize {
    let offset = offset.min(text.len());
    1 + text.as_bytes()[..offset]
        .iter()
        .filter(|&&byte| byte == b'\n')
        .count()
}
