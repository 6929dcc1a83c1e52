//! The presets: the files of `reference/scenes`, embedded so that they travel with the program.

/// One embedded scene.
#[derive(Debug, Clone, Copy)]
pub struct Preset {
    /// Bare name, `paper` for `reference/scenes/paper.toml`.
    pub name: &'static str,
    /// The file's text.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        &[$(Preset {
            name: $name,
            text: include_str!(concat!(
                env!("CARGO_MANIFEST_DIR"), "/../../reference/scenes/", $name, ".toml"
            )),
        }),*]
    };
}

/// All presets, the paper's first.
pub const PRESETS: &[Preset] = presets![
    "paper",
    "paper-2019",
    "paper-friction",
    "paper-rough",
    "paper-refined",
    "paper-geometric",
    "backlash-0.6",
    "steel",
    "one-wheel",
    "eleven-pins",
    "forty-pins",
];

/// Text of the preset called `name`.
#[must_use]
pub fn preset(name: &str) -> Option<&'static str> {
    PRESETS
        .iter()
        .find(|preset| preset.name == name)
        .map(|preset| preset.text)
}
