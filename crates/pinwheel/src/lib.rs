//! Dynamics of cycloidal gearboxes, computed by several engines and compared.
//!
//! A cycloidal gearbox turns an eccentric input into a slow output: discs with lobes roll inside a ring
//! of rollers (*ring pins*), and rollers in the discs' holes (*output pins*) carry the load to the output.
//! A [`Scene`] states gear, load, contact law and solver; an *engine* turns it into [`TimeSeries`], time series of
//! forces, torques and angles. All values are SI; names of keys and columns end in their unit.
//!
//! # Run a gear
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use pinwheel::time_series::norms::{Statistics, View};
//!
//! let paper = pinwheel::load("paper", &["solver.duration_s = 0.02"])?;
//! let loose = paper.changed(|scene| scene.gear.backlash_m = 6e-4)?;
//! let outcome = pinwheel::run(&loose, "native")?;
//! let torque = outcome.run.time_series.channel("input_torque_n_m").ok_or("no such column")?;
//! let driver = Statistics::of(&View::new(vec![torque])).ok_or("no samples")?;
//! println!("driver torque {:.3} N m in the mean, {:.3} at most", driver.mean, driver.peak);
//! # assert!((0.5..3.0).contains(&driver.mean), "{}", driver.mean);
//! # Ok(())
//! # }
//! ```
//!
//! # Compare engines
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # let paper = pinwheel::load("paper", &["solver.duration_s = 0.02"])?;
//! let names = ["native-reduced", "native-lagrange", "native-resolved"];
//! let outcome = pinwheel::compare(&paper, &names)?;
//! println!("{}", pinwheel::pages::comparison::text(&paper, &outcome));
//! # assert_eq!(outcome.comparison.pairs.len(), 3);
//! # assert!(outcome.participants.iter().all(|p| p.status.is_finished()));
//! # Ok(())
//! # }
//! ```
//!
//! [`studies::choice::listed`] names the engines of a build. Of foreign ones the `shared-law` engines take contact
//! forces from Pinwheel's law and check the multibody side to many digits; the `own-contact` engines find contact
//! themselves and check geometry and law to a few per cent.
//!
//! # What else there is
//!
//! | for | see |
//! |---|---|
//! | keys, presets, checks | [`scene`] |
//! | contact laws and the profile's geometry | [`contact`] |
//! | the gearbox as bodies and contacts, statics, energy | [`gearbox`] |
//! | columns, CSV, foreign data | [`time_series`], [`studies::comparison::foreign`] |
//! | solvers behind one trait, and one of your own | [`engines`] |
//! | metrics, limits and verdicts | [`mod@compare`] |
//! | sweeps, baselines, cost of accuracy, stability, the paper's figures | [`studies`] |
//! | a scene as a co-simulation unit | [`fmu`] |
//! | pages and text of results | [`pages`] |
//!
//! # Optimise it in debug builds too
//!
//! ```toml
//! [profile.dev.package."*"]
//! opt-level = 2
//! ```
//!
//! Contacts are computed in vector lanes. Not optimised, on processors with AVX-512, one of those loops takes 10 MB of stack,
//! more than a main thread has.
//!
//! `examples/` has five programs, each a little longer than the last: `run_a_gear`, `compare_engines`, `own_law`,
//! `own_study`, `read_courses`. The program `pinwheel` is a shell around this library.

pub use pinwheel_compare as compare;
pub use pinwheel_contact as contact;
pub use pinwheel_engines as engines;
pub use pinwheel_fmu as fmu;
pub use pinwheel_gearbox as gearbox;
pub use pinwheel_mbs as mbs;
pub use pinwheel_report as report;
pub use pinwheel_report::pages;
pub use pinwheel_scene as scene;
pub use pinwheel_studies as studies;
pub use pinwheel_timeseries as time_series;

pub use pinwheel_gearbox::Gearbox;
pub use pinwheel_scene::{CheckedScene, Scene};
pub use pinwheel_studies::{Control, Progress, Provenance, StudyError};
pub use pinwheel_timeseries::TimeSeries;

use pinwheel_scene::Override;
use pinwheel_studies::{choice, comparison, single};

/// Loads the scene of a preset or a file, with keys set as in `"gear.backlash_m = 6e-4"`; spaces are optional.
///
/// # Errors
/// An unknown scene or key, or an invalid value; with the remedy.
pub fn load(name: &str, set: &[&str]) -> Result<CheckedScene, StudyError> {
    let parsed = set.iter().map(|text| text.parse::<Override>());
    Ok(Scene::load(name, &parsed.collect::<Result<Vec<_>, _>>()?)?)
}

/// Runs a scene on one engine. `"native"` is Pinwheel's solver in the formulation that the scene states.
///
/// A native run is repeated at twice its step: [`resolution`](studies::single::Outcome::resolution) states whether the step
/// resolves the scene. The outcome of a run that diverges has its time series until then.
///
/// # Errors
/// The engine does not exist, cannot run the scene, or failed.
pub fn run(scene: &CheckedScene, engine: &str) -> Result<single::Outcome, StudyError> {
    let engine = choice::find(engine, scene)?;
    single::run(&compile(scene)?, engine.as_ref(), true, &Control::quiet())
}

/// Runs a scene on several engines and compares them pair by pair; without names on all engines of this build.
///
/// # Errors
/// An unknown engine, or a scene that cannot be modelled. A failure of an engine is its status in the outcome.
pub fn compare(scene: &CheckedScene, engines: &[&str]) -> Result<comparison::Outcome, StudyError> {
    let input = comparison::Input {
        gearbox: &compile(scene)?,
        engines: &choice::engines(engines, scene)?,
        data: &[],
    };
    comparison::run(&input, &Control::quiet())
}

/// Compiles a scene to its gearbox, which all engines and runs share.
///
/// # Errors
/// A scene that cannot be modelled.
pub fn compile(scene: &CheckedScene) -> Result<Gearbox, StudyError> {
    Gearbox::new(scene).map_err(|source| StudyError::Scene {
        scene: scene.name.clone(),
        source,
    })
}
