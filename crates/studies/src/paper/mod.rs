//! Reproduction of the paper, figure by figure: Pinwheel's curves in its axes, its statements, and the verdicts.

pub(crate) mod backlash;
mod contact;
mod damping;
pub(crate) mod figure;
mod peer;
mod points;
pub(crate) mod read;
mod runs;
pub(crate) mod spectrum;
pub(crate) mod statements;
mod torque;
pub(crate) mod write;

use std::time::Instant;

use pinwheel_engines::Cancelled;
use pinwheel_scene::Scene;
use serde::Serialize;

pub use figure::{Claim, ClaimVerdict, Curve, JudgedClaim, PaperFigure, Plot};
pub use peer::peer;
pub use runs::Peer;

use crate::StudyError;
use crate::control::{Control, Progress};
use crate::motion::{Motion, sampled};
use crate::pool;
use figure::{Measured, number};
use runs::{Model, Runs};
use statements::Statements;

/// Result of the study.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PaperResult {
    /// Figures in the paper's order, then results without a figure in the paper.
    pub figures: Vec<PaperFigure>,
    /// Claims of the paper, each judged by the numbers of one of the figures.
    pub claims: Vec<JudgedClaim>,
    /// Costs of the runs.
    pub costs: Vec<Cost>,
    /// Number of distinct runs behind the figures.
    pub runs: usize,
    /// Wall time of the study, s.
    pub wall_s: f64,
    /// Motion of the gearbox without and with backlash, over the input turn of most figures, for a page.
    #[serde(skip)]
    pub motion: Vec<Motion>,
}

/// Cost of 0.6 s of the gearbox.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// Name of the analysis.
    pub what: String,
    /// The paper's time, s; `None` if not stated.
    pub paper_s: Option<f64>,
    /// Pinwheel's wall time, s.
    pub ours_s: f64,
}

/// Returns the name of a figure given as `9`, `09` or `fig-9`.
///
/// # Errors
/// List of the available names.
pub fn named(word: &str) -> Result<String, String> {
    let word = word.trim();
    let name = word.trim_start_matches("fig-").trim_start_matches('0');
    let names = GROUPS.map(|(names, ..)| names).concat();
    if names.contains(&name) {
        return Ok(name.to_owned());
    }
    let names = names.join(", ");
    Err(format!("there is no figure `{word}`; name some of {names}"))
}

/// Choices of figures and engines.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Names from [`named`]; empty for all.
    pub figures: Vec<String>,
    /// Run in place of Adams in Fig. 10.
    pub peer: Option<Peer>,
}

/// Computes the gearbox's motion without and with backlash.
fn motion(control: &Control<'_>) -> Result<Vec<Motion>, Cancelled> {
    const TURN: (f64, f64) = (0.24, 0.36);
    let paper = Scene::paper();
    let (step, _) = sampled(&paper);
    let mut wide = paper.clone();
    wide.gear.backlash_m = 6e-4;
    let (Ok(paper), Ok(wide)) = (paper.check(), wide.check()) else {
        return Ok(Vec::new());
    };
    let both = [("without backlash", &paper), ("0.6 mm of backlash", &wide)];
    Motion::beside(both, TURN, step, control)
}

type Make = fn(&Runs<'_>) -> Result<Vec<Measured>, StudyError>;

/// Figures in groups that share their runs, in the paper's order.
const GROUPS: [(&[&str], &str, Make); 9] = [
    (&["5", "6"], "Figs. 5 and 6", contact::one_contact),
    (&["7", "8"], "Figs. 7 and 8", damping::figures),
    (&["9"], "Fig. 9", points::figure),
    (&["10"], "Fig. 10", peer::figure),
    (&["11", "12", "13"], "Figs. 11 to 13", backlash::figures),
    (&["14", "15", "16"], "Figs. 14 to 16", torque::figures),
    (&["17", "18"], "Figs. 17 and 18", contact::with_backlash),
    (&["spectra"], "spectra", spectrum::figure),
    (&["damping"], "dampings above 8 N s/m", damping::above),
];

/// Computes the figures and judges the claims based on them.
///
/// # Errors
/// Cancelled, or a required run failed.
pub fn run(options: &Options, control: &Control<'_>) -> Result<PaperResult, StudyError> {
    let start = Instant::now();
    let stated = Statements::read().map_err(|error| StudyError::Reference {
        scene: "the list of claims".to_owned(),
        reason: format!("cannot be read: {error}"),
    })?;
    let wanted =
        |name: &str| options.figures.is_empty() || options.figures.iter().any(|f| f == name);
    let groups = GROUPS.iter();
    let groups = groups.filter(|(names, ..)| names.iter().any(|name| wanted(name)));
    let groups: Vec<_> = groups.collect();
    let runs = Runs::new(*control, options.peer.as_ref());
    let step = |done: usize, piece: &str| -> Result<(), StudyError> {
        (control.progress)(Progress::new(done, 1 + groups.len(), piece));
        Ok(control.check()?)
    };
    step(0, "cost of a run")?;
    let (mut costs, cost) = costs(&runs)?;
    costs.extend(options.peer.iter().filter_map(|peer| {
        Some(Cost {
            what: format!("{} in Adams' place", peer.name),
            paper_s: Some(3600.0),
            ours_s: peer.wall_s?,
        })
    }));
    let mut measured = vec![cost];
    // The last groups take longest, and begin first, so that no thread is left alone with one.
    let draw = |(): &mut (), k: usize| -> Result<Vec<Measured>, StudyError> {
        let (names, piece, make) = groups[groups.len() - 1 - k];
        step(k + 1, piece)?;
        let drawn = make(&runs)?.into_iter().zip(*names);
        let drawn = drawn.filter(|(_, name)| wanted(name));
        Ok(drawn.map(|(one, _)| one).collect())
    };
    // Timed runs are complete, so all threads may be used.
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let (drawn, fault) = pool::map(threads, groups.len(), || (), draw);
    if let Some(fault) = fault {
        return Err(fault);
    }
    measured.extend(drawn.into_iter().rev().flatten().flatten());
    let claims = stated.claim.iter().filter_map(|claim| {
        let one = measured.iter().find(|one| one.id == claim.figure)?;
        Some(claim.claim(one))
    });
    let claims = claims.collect();
    let figures = measured.into_iter().filter_map(|one| {
        let figure = stated.figure.iter().find(|figure| figure.id == one.id)?;
        Some(figure.figure(one))
    });
    Ok(PaperResult {
        figures: figures.collect(),
        claims,
        costs,
        runs: runs.count(),
        wall_s: start.elapsed().as_secs_f64(),
        motion: motion(control)?,
    })
}

/// Runs the paper's analyses by its own method and by Pinwheel's, and returns their costs, also as numbers for a claim.
fn costs(runs: &Runs<'_>) -> Result<(Vec<Cost>, Measured), StudyError> {
    let mut costs = Vec::new();
    let mut numbers = Measured::new("cost", Vec::new(), Vec::new());
    let (rough, fine) = (Model::ROUGH, Model::FINE);
    for (what, name, paper_s, model) in [
        ("600 points on a disc", "600_points", Some(240.0), rough),
        ("4000 points on a disc", "4000_points", Some(1500.0), fine),
        ("exact profile", "exact", None, Model::Ours),
    ] {
        let run = runs.get(model, |s| "rk2".clone_into(&mut s.solver.integrator))?;
        let name = format!("wall_{name}");
        numbers.numbers.push(number(name, run.wall_s, "s"));
        costs.push(Cost {
            what: what.to_owned(),
            paper_s,
            ours_s: run.wall_s,
        });
    }
    Ok((costs, numbers))
}
