//! Which faults a comparison tells: an engine that runs a slightly wrong gear beside one that runs the right one.
//!
//! For every gear, engine and kind of fault: the engine runs the right gear (it must agree), then one whose fault has the
//! size that is asked for, then ones of other sizes until the smallest that is told is known to a factor of
//! [`CLOSE`]. Differences grow with the fault, so each run tells where to look next.

use pinwheel_compare::comparison::Pair;
use pinwheel_compare::uncertainty::Source;
use pinwheel_compare::{Context, Evidence, Participant, Rules, Verdict, compare};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::{CheckedScene, Scene};
use serde::Serialize;

use crate::StudyError;
use crate::choice;
use crate::comparison::{Effort, context, refine};
use crate::control::{Control, Progress};
use crate::output::OutputError;
use crate::provenance::{Provenance, Summary};

/// How closely the smallest fault is known, as a factor.
pub const CLOSE: f64 = 1.5;
/// Runs of one fault at most.
const MOST_RUNS: usize = 6;

/// A kind of fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Young's modulus, and the stiffness of laws that have one of their own, too large by this share.
    Stiffness,
    /// The damping too large by this share.
    Damping,
    /// The eccentricity too small by this share, on the same pin circle.
    Eccentricity,
    /// The radius of one external sleeve too small by this length, m.
    Sleeve,
    /// The last wheel out of phase by this angle, rad.
    Phase,
    /// The law without this share of its damping; 1: without any.
    MissingDamping,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 6] = [
        Self::Stiffness,
        Self::Damping,
        Self::Eccentricity,
        Self::Sleeve,
        Self::Phase,
        Self::MissingDamping,
    ];

    /// In words, with the size that every comparison is to tell.
    #[must_use]
    pub fn label(self) -> &'static str {
        match self {
            Self::Stiffness => "stiffness 0.1 % larger",
            Self::Damping => "damping 10 % larger",
            Self::Eccentricity => "eccentricity 0.1 % smaller",
            Self::Sleeve => "one sleeve 1 um smaller",
            Self::Phase => "a wheel 0.1 mrad out of phase",
            Self::MissingDamping => "no damping",
        }
    }

    /// That size.
    #[must_use]
    pub fn asked(self) -> f64 {
        match self {
            Self::Stiffness | Self::Eccentricity => 1e-3,
            Self::Damping => 0.1,
            Self::Sleeve => 1e-6,
            Self::Phase => 1e-4,
            Self::MissingDamping => 1.0,
        }
    }

    /// A size in words.
    #[must_use]
    pub fn size(self, size: f64) -> String {
        match self {
            Self::Sleeve => format!("{:.2} um", 1e6 * size),
            Self::Phase => format!("{:.4} mrad", 1e3 * size),
            _ => format!("{:.1e} %", 100.0 * size),
        }
    }

    /// The gear with a fault of this size.
    fn applied(self, gearbox: &Gearbox, size: f64) -> Result<Gearbox, StudyError> {
        let change = |scene: &mut Scene| match self {
            Self::Stiffness => {
                scene.contact.young_pa *= 1.0 + size;
                scene.contact.constant_stiffness_n_m15 *= 1.0 + size;
            }
            Self::Damping => scene.contact.damping_n_s_m *= 1.0 + size,
            Self::MissingDamping => scene.contact.damping_n_s_m *= 1.0 - size,
            Self::Eccentricity => {
                scene.gear.eccentricity_m *= 1.0 - size;
                scene.gear.shortening *= 1.0 - size;
            }
            Self::Sleeve | Self::Phase => {}
        };
        let named = |source| StudyError::Scene {
            scene: gearbox.scene.name.clone(),
            source,
        };
        let scene = gearbox.scene.changed(change);
        let scene = scene.map_err(|fault| named(fault.into()))?;
        let mut faulty = Gearbox::new(&scene).map_err(named)?;
        match self {
            Self::Sleeve => faulty.geometry.external_radii_m[0] -= size,
            Self::Phase => {
                if let Some(last) = faulty.geometry.wheel_phases.last_mut() {
                    *last += size;
                }
            }
            _ => {}
        }
        Ok(faulty)
    }
}

/// What is asked.
#[derive(Debug, Clone)]
pub struct Input {
    /// Gears.
    pub scenes: Vec<CheckedScene>,
    /// The engine that runs the right gear.
    pub right: String,
    /// Those that run the wrong ones.
    pub engines: Vec<String>,
    /// How sharp the statements are to be: what `pinwheel compare --resolution` sets.
    pub effort: Effort,
    /// Whether the smallest fault that is told is looked for, or only those of the size asked for.
    pub smallest: bool,
}

/// The gears of the study, each with the duration that is enough of it, s.
pub const GEARS: [(&str, f64); 3] = [("paper", 0.02), ("one-wheel", 0.02), ("forty-pins", 0.01)];

/// Resolution of the study: a tenth of the faults.
pub const RESOLUTION: f64 = 1e-4;

/// What was told of one kind of fault.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Found {
    /// The gear.
    pub scene: String,
    /// The engine that ran the wrong gear.
    pub engine: String,
    /// The kind.
    pub kind: Kind,
    /// Whether a fault of the size asked for is told: *differ*.
    pub told: bool,
    /// By how many of the uncertainties the two then differ: the largest D/U.
    pub uncertainties: f64,
    /// The smallest fault that was told; `None` where none was.
    pub smallest: Option<f64>,
}

/// The result.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct Outcome {
    /// Every gear, engine and kind.
    pub found: Vec<Found>,
    /// Right gears that were said to differ, with the quantity: false alarms.
    pub false_alarms: Vec<String>,
    /// What was left out, with the reason.
    pub left_out: Vec<String>,
}

impl Outcome {
    /// Writes `summary.json` into the folder `dir`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, dir: &std::path::Path, made: &Provenance) -> Result<(), OutputError> {
        Summary::new(made, self).write(dir)
    }
}

/// Makes every fault in every engine on every gear.
///
/// # Errors
/// Cancelled; a name that is no engine's; a scene that cannot be modelled, or not with the fault.
pub fn run(input: &Input, control: &Control<'_>) -> Result<Outcome, StudyError> {
    let mut outcome = Outcome::default();
    let total = input.scenes.len() * input.engines.len() * Kind::ALL.len();
    let mut done = 0;
    for scene in &input.scenes {
        let gearbox = Gearbox::new(scene).map_err(|source| StudyError::Scene {
            scene: scene.name.clone(),
            source,
        })?;
        let context = context(scene);
        let study = Study {
            input,
            context: &context,
            control,
        };
        let at = Progress::new(done, total, &scene.name);
        let right = study.refine(&input.right, &gearbox, input.effort, at)?;
        for name in &input.engines {
            let at = Progress::new(done, total, name);
            let base = study.refine(name, &gearbox, input.effort, at)?;
            if !base.0.status.is_finished() {
                let reason = base.0.status.reason().unwrap_or_default();
                outcome
                    .left_out
                    .push(format!("{} on {name}: {reason}", scene.name));
                done += Kind::ALL.len();
                continue;
            }
            let (alarm, _) = study.judge(&right, &base)?;
            if let Some(quantity) = alarm {
                outcome
                    .false_alarms
                    .push(format!("{} on {name}: {quantity}", scene.name));
            }
            let (settled, effort) = study.settled(&gearbox, &base.1);
            for kind in Kind::ALL {
                let at = Progress::new(done, total, name);
                done += 1;
                let tell = |size: f64| -> Result<(bool, f64), StudyError> {
                    let faulty = kind.applied(&settled, size)?;
                    let wrong = study.refine(name, &faulty, effort, at)?;
                    let (told, ratio) = study.judge(&right, &wrong)?;
                    Ok((told.is_some(), ratio))
                };
                let most = if input.smallest { MOST_RUNS } else { 1 };
                let (told, uncertainties, smallest) = smallest(kind, most, tell)?;
                outcome.found.push(Found {
                    scene: scene.name.clone(),
                    engine: name.clone(),
                    kind,
                    told,
                    uncertainties,
                    smallest,
                });
            }
        }
    }
    Ok(outcome)
}

/// The smallest fault that is told, from the one asked for: each run's D/U says where D would be U.
fn smallest(
    kind: Kind,
    most_runs: usize,
    mut tell: impl FnMut(f64) -> Result<(bool, f64), StudyError>,
) -> Result<(bool, f64, Option<f64>), StudyError> {
    let most = match kind {
        Kind::MissingDamping => 1.0,
        _ => 100.0 * kind.asked(),
    };
    let (told, uncertainties) = tell(kind.asked())?;
    let (mut seen, mut unseen) = (
        told.then_some(kind.asked()),
        (!told).then_some(kind.asked()),
    );
    let (mut size, mut ratio) = (kind.asked(), uncertainties);
    for _ in 1..most_runs {
        let near = seen.zip(unseen).is_some_and(|(s, u)| s <= CLOSE * u);
        if near {
            break;
        }
        let wanted = size / ratio.max(1e-6) * if seen == Some(size) { 1.2 } else { 1.4 };
        // Never outside of what is known already.
        let low = unseen.map_or(0.0, |u| 1.1 * u);
        let high = seen.map_or(most, |s| s / 1.1);
        if low >= high {
            break;
        }
        size = wanted.clamp(low, high);
        let (here, by) = tell(size)?;
        ratio = by;
        if here {
            seen = Some(seen.map_or(size, |s| s.min(size)));
        } else {
            unseen = Some(unseen.map_or(size, |u| u.max(size)));
            if size >= most {
                break;
            }
        }
    }
    Ok((told, uncertainties, seen))
}

struct Study<'a> {
    input: &'a Input,
    context: &'a Context,
    control: &'a Control<'a>,
}

/// A run and what it says of its error.
type Ran = (Participant, Evidence);

impl Study<'_> {
    fn refine(
        &self,
        name: &str,
        gearbox: &Gearbox,
        effort: Effort,
        at: Progress<'_>,
    ) -> Result<Ran, StudyError> {
        let engine = choice::find(name, &gearbox.scene)?;
        refine(
            engine.as_ref(),
            gearbox,
            self.context,
            effort,
            at,
            self.control,
        )
    }

    /// The gear at the step that the right run was refined to, which wrong ones then take at once.
    fn settled(&self, gearbox: &Gearbox, evidence: &Evidence) -> (Gearbox, Effort) {
        let Source::Refinement(study) = &evidence.source else {
            return (gearbox.clone(), self.input.effort);
        };
        let method = matches!(
            study.method,
            pinwheel_compare::uncertainty::Method::Step { .. }
        );
        let settled = gearbox.with_solver(|solver| {
            if method {
                solver.step_s = study.finest;
            } else {
                solver.tolerance = study.finest;
            }
        });
        match settled {
            Ok(settled) if method => (
                settled,
                Effort {
                    obey: true,
                    ..self.input.effort
                },
            ),
            _ => (gearbox.clone(), self.input.effort),
        }
    }

    /// The quantity and window that tells the two apart, and the largest D/U.
    fn judge(&self, a: &Ran, b: &Ran) -> Result<(Option<String>, f64), StudyError> {
        let rename = |(participant, evidence): &Ran, name: &str| {
            let participant = Participant {
                name: name.to_owned(),
                ..participant.clone()
            };
            let evidence = Evidence {
                engine: name.to_owned(),
                ..evidence.clone()
            };
            (participant, evidence)
        };
        let (right, of_right) = rename(a, "right");
        let (wrong, of_wrong) = rename(b, "wrong");
        if !wrong.status.is_finished() {
            return Ok((Some("it does not finish".to_owned()), f64::INFINITY));
        }
        let evidence = [of_right, of_wrong];
        let rules = Rules {
            evidence: &evidence,
            resolution: self.input.effort.resolution,
            ..Rules::default()
        };
        let found = compare(self.context, &[right, wrong], &rules)?;
        Ok(found.pairs.first().map_or((None, 0.0), told))
    }
}

/// Where a pair differs most, and the largest D/U of what counts.
fn told(pair: &Pair) -> (Option<String>, f64) {
    let (mut place, mut most) = (None, 0.0_f64);
    for entry in &pair.entries {
        for found in entry.assessments.iter().filter(|one| one.decides) {
            let (Some(distance), Some(bound)) = (found.difference, found.combined()) else {
                continue;
            };
            most = most.max(distance.abs() / bound);
            if found.verdict == Verdict::Differ {
                place = Some(format!("{}, {}", entry.quantity, entry.window.word()));
            }
        }
    }
    (place, most)
}
