//! Presets: the files of `reference/scenes`, embedded in the program.

/// Embedded scene.
#[derive(Debug, Clone, Copy)]
pub struct Preset {
    /// Name, `paper` for `reference/scenes/paper.toml`.
    pub name: &'static str,
    /// Text of the file.
    pub text: &'static str,
}

macro_rules! presets {
    ($($name:literal),* $(,)?) => {
        &[$(Preset {
            name: $name,
            text: include_str!(concat!(
                env!("PINWHEEL_SHIPPED"), "/reference/scenes/", $name, ".toml"
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
    "modified",
    "toleranced",
    "pins-removed",
    "paper-bearings",
    "printed-drive",
    "needle-bearings",
    "rv-320",
    "rv-40e-like",
    "rv-80e-like",
    "rv-160n-like",
    // Hard cases for integrators; the description of each gives the reason.
    "hard-adhesive",
    "hard-all-open",
    "hard-backlash-0.1",
    "hard-backlash-1",
    "hard-bearing-clearance",
    "hard-damping-0",
    "hard-damping-1",
    "hard-damping-512",
    "hard-damping-64",
    "hard-feather-sleeves",
    "hard-forty-sleeves",
    "hard-friction-light-sleeves",
    "hard-friction-narrow",
    "hard-friction-wide",
    "hard-load-doubled",
    "hard-load-removed",
    "hard-load-reversal",
    "hard-load-reversed",
    "hard-load-step",
    "hard-long-run",
    "hard-one-sleeve",
    "hard-points-120",
    "hard-points-16000",
    "hard-points-600",
    "hard-ramp-1e-7",
    "hard-ramp-1e-9",
    "hard-rpm-20",
    "hard-rpm-6000",
    "hard-rv-crank-loose",
    "hard-rv-crank-phase",
    "hard-rv-reversal",
    "hard-steel",
    "hard-steel-damped",
    "hard-stiffness-0.1",
    "hard-stiffness-0.1-damped",
    "hard-zero-load",
    "hard-zero-load-friction",
];

/// Returns the text of a preset.
pub fn preset(name: &str) -> Option<&'static str> {
    let mut all = PRESETS.iter();
    Some(all.find(|preset| preset.name == name)?.text)
}
