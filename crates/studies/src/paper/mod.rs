//! The paper, figure by figure: our curves in its axes, what it says they show, whether ours do.

mod backlash;
mod damping;
mod figure;
mod peer;
mod points;
mod read;
mod runs;
mod spectrum;
mod torque;

use std::time::Instant;

use pinwheel_gearbox::claims::{self, Judgement};
use pinwheel_gearbox::native::NativeError;
use serde::Serialize;

pub use figure::{Curve, Figure, Number, Plot};
pub use peer::Peer;

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

/// Pieces of the study beside the claims.
const FIGURES: usize = 7;

/// Computes every figure and judges every claim. `peer`: what stands in Adams' place in Fig. 10.
///
/// # Errors
/// Cancelled, or a run failed that had to end.
pub fn run(peer: Option<&Peer>, control: &Control<'_>) -> Result<Paper, StudyError> {
    let start = Instant::now();
    let list = claims::claims().map_err(|error| StudyError::Reference {
        scene: "the list of claims".to_owned(),
        reason: format!("cannot be read: {error}"),
    })?;
    let total = FIGURES + list.len();
    let mut done = 0;
    let mut begin = |piece: &str| {
        (control.progress)(Progress { done, total, piece });
        done += 1;
    };
    let runs = Runs::new(*control);

    begin("cost of a run");
    let costs = costs(&runs)?;
    let mut figures = Vec::new();
    begin("Figs. 7 and 8");
    figures.extend(damping::figures(&runs)?);
    begin("Fig. 9");
    figures.push(points::figure(&runs)?);
    begin("Fig. 10");
    figures.push(peer::figure(&runs, peer)?);
    begin("Figs. 11 to 13");
    figures.extend(backlash::figures(&runs)?);
    begin("Figs. 14 to 16");
    figures.extend(torque::figures(&runs)?);
    begin("spectra");
    let spectra = spectrum::figure(&runs)?;
    figures.push(spectra);

    let mut judged = Vec::new();
    let go = || !control.cancel.load(std::sync::atomic::Ordering::Relaxed);
    for claim in &list {
        begin(&format!("claim `{}`", claim.id));
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
