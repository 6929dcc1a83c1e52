//! The paper, figure by figure: our curves in its axes, what it says they show, whether ours do.

mod backlash;
pub mod claims;
mod contact;
mod damping;
mod figure;
mod peer;
mod points;
mod read;
mod runs;
mod spectrum;
mod stand_in;
mod torque;
mod write;

use std::time::Instant;

use claims::Judgement;
use pinwheel_gearbox::native::NativeError;
use serde::Serialize;

pub use figure::{Curve, Figure, Number, Plot};
pub use peer::Peer;
pub use stand_in::peer;

use crate::StudyError;
use crate::control::{Control, Progress};
use runs::{Model, Runs};

/// The whole study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Paper {
    /// Figures in the paper's order, then the spectra.
    pub figures: Vec<Figure>,
    /// Its claims with our figures.
    pub claims: Vec<Judgement>,
    /// What runs cost.
    pub costs: Vec<Cost>,
    /// Distinct runs behind the figures.
    pub runs: usize,
    /// Wall time of the whole study, s.
    pub wall_s: f64,
}

/// What 0.6 s of the gearbox cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// Which analysis.
    pub what: String,
    /// The paper's time, s; `None`: it has none.
    pub paper_s: Option<f64>,
    /// Ours, wall, s.
    pub ours_s: f64,
}

/// Names of the figures, as [`Options::figures`] takes them; those of one group are computed together.
pub const NAMES: [&str; 15] = [
    "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15", "16", "17", "18", "spectra",
];

/// A figure by its name, as `9`, `09` or `fig-9`.
///
/// # Errors
/// What there is instead.
pub fn named(word: &str) -> Result<String, String> {
    let word = word.trim();
    let name = word.trim_start_matches("fig-").trim_start_matches('0');
    if NAMES.contains(&name) {
        return Ok(name.to_owned());
    }
    Err(format!(
        "there is no figure `{word}`; name some of {}",
        NAMES.join(", ")
    ))
}

/// What to compute.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Some of [`NAMES`]; none: all, with the claims.
    pub figures: Vec<String>,
    /// What stands in Adams' place in Fig. 10.
    pub peer: Option<Peer>,
}

type Make = fn(&Runs<'_>, &Options) -> Result<Vec<Figure>, StudyError>;

/// The figures in groups that share their runs.
const GROUPS: [(&[&str], &str, Make); 8] = [
    (&["5", "6"], "Figs. 5 and 6", |runs, _| {
        contact::one_contact(runs)
    }),
    (&["7", "8"], "Figs. 7 and 8", |runs, _| {
        damping::figures(runs)
    }),
    (&["9"], "Fig. 9", |runs, _| Ok(vec![points::figure(runs)?])),
    (&["10"], "Fig. 10", |runs, options| {
        Ok(vec![peer::figure(runs, options.peer.as_ref())?])
    }),
    (&["11", "12", "13"], "Figs. 11 to 13", |runs, _| {
        backlash::figures(runs)
    }),
    (&["14", "15", "16"], "Figs. 14 to 16", |runs, _| {
        torque::figures(runs)
    }),
    (&["17", "18"], "Figs. 17 and 18", |runs, _| {
        contact::with_backlash(runs)
    }),
    (&["spectra"], "spectra", |runs, _| {
        Ok(vec![spectrum::figure(runs)?])
    }),
];

/// Computes the figures and judges the claims.
///
/// # Errors
/// Cancelled, or a run failed that had to end.
pub fn run(options: &Options, control: &Control<'_>) -> Result<Paper, StudyError> {
    let start = Instant::now();
    let wanted =
        |name: &str| options.figures.is_empty() || options.figures.iter().any(|f| f == name);
    let groups: Vec<_> = GROUPS
        .iter()
        .filter(|(names, ..)| names.iter().any(|n| wanted(n)))
        .collect();
    let list = if options.figures.is_empty() {
        claims::claims().map_err(|error| StudyError::Reference {
            scene: "the list of claims".to_owned(),
            reason: format!("cannot be read: {error}"),
        })?
    } else {
        Vec::new()
    };
    let total = 1 + groups.len() + list.len();
    let mut done = 0;
    let mut begin = |piece: &str| {
        (control.progress)(Progress::new(done, total, piece));
        done += 1;
    };
    let runs = Runs::new(*control);
    begin("cost of a run");
    let mut costs = costs(&runs)?;
    if let Some(peer) = &options.peer
        && let Some(wall_s) = peer.wall_s
    {
        costs.push(Cost {
            what: format!("{} in Adams' place", peer.name),
            paper_s: Some(3600.0),
            ours_s: wall_s,
        });
    }
    let mut figures = Vec::new();
    for (names, piece, make) in groups {
        begin(piece);
        let made = make(&runs, options)?;
        figures.extend(
            made.into_iter()
                .zip(*names)
                .filter(|(_, name)| wanted(name))
                .map(|(figure, _)| figure),
        );
    }
    let mut judged = Vec::new();
    let go = || !control.cancel.load(std::sync::atomic::Ordering::Relaxed);
    for claim in &list {
        begin(&format!("claim {}", claim.id));
        match claims::judge_while(claim, &go) {
            Ok(found) => judged.extend(found),
            Err(NativeError::Stopped) => return Err(StudyError::Cancelled),
            Err(error) => {
                return Err(StudyError::Reference {
                    scene: claim.id.clone(),
                    reason: error.to_string(),
                });
            }
        }
    }
    Ok(Paper {
        figures,
        claims: judged,
        costs,
        runs: runs.count(),
        wall_s: start.elapsed().as_secs_f64(),
    })
}

/// The paper's runs in its own method, and ours.
fn costs(runs: &Runs<'_>) -> Result<Vec<Cost>, StudyError> {
    let cost = |what: &str, paper_s: Option<f64>, model: Model| -> Result<Cost, StudyError> {
        let run = runs.get(model, |s| "rk2".clone_into(&mut s.solver.integrator))?;
        Ok(Cost {
            what: what.to_owned(),
            paper_s,
            ours_s: run.wall_s,
        })
    };
    Ok(vec![
        cost("600 points on a wheel", Some(240.0), Model::Points(600))?,
        cost("4000 points on a wheel", Some(1500.0), Model::Points(4000))?,
        cost("exact profile", None, Model::Ours)?,
    ])
}
