//! Fuzzing of all readers of foreign input.
//!
//! A target ([`targets`]) takes any bytes and panics if the reader does, or if it accepts unsound input. Targets
//! run in two ways:
//!
//! * `cargo test -p pinwheel-fuzz` needs nothing else: inputs are mutated from the files of `reference/` and `fuzz/corpus/`
//!   by fixed seeds, for a few seconds or as long as `PINWHEEL_FUZZ_S` says.
//! * `cargo +nightly fuzz run scene --features libfuzzer fuzz/corpus/scene reference/scenes` follows coverage.

pub mod corpus;
#[allow(
    dead_code,
    reason = "a file of the program, of which only the reader is asked here"
)]
#[path = "../../crates/cli/src/loopback.rs"]
mod loopback;
pub mod mutate;
pub mod targets;

/// A reader under test.
pub struct Target {
    /// Name, as of its file in `fuzz_targets`.
    pub name: &'static str,
    /// Takes any bytes and returns true if they were accepted. Panics on a finding.
    pub run: fn(&[u8]) -> bool,
    /// Returns the seeds.
    pub seeds: fn() -> Vec<Vec<u8>>,
}

/// All readers under test.
pub const TARGETS: &[Target] = &[
    Target {
        name: "scene",
        run: targets::scene,
        seeds: corpus::scenes,
    },
    Target {
        name: "settings",
        run: targets::settings,
        seeds: corpus::settings,
    },
    Target {
        name: "first_steps",
        run: targets::first_steps,
        seeds: corpus::scenes,
    },
    Target {
        name: "map",
        run: targets::map,
        seeds: corpus::maps,
    },
    Target {
        name: "foreign",
        run: targets::foreign,
        seeds: corpus::foreign,
    },
    Target {
        name: "sweep",
        run: targets::sweep,
        seeds: corpus::sweeps,
    },
    Target {
        name: "baseline",
        run: targets::baseline,
        seeds: corpus::baselines,
    },
    Target {
        name: "recording",
        run: targets::recording,
        seeds: corpus::recordings,
    },
    Target {
        name: "kept",
        run: targets::kept,
        seeds: corpus::kept,
    },
    Target {
        name: "courses",
        run: targets::time_series,
        seeds: corpus::time_series,
    },
    Target {
        name: "manifest",
        run: targets::manifest,
        seeds: corpus::manifests,
    },
    #[cfg(feature = "parquet")]
    Target {
        name: "parquet",
        run: targets::parquet,
        seeds: corpus::parquet,
    },
    Target {
        name: "requests",
        run: targets::requests,
        seeds: corpus::requests,
    },
];
