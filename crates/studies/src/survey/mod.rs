//! The whole survey: atlas, divergence, long-run drift and the published model's choices, piece by piece.
//!
//! Pieces do not depend on each other, so they run side by side, and a survey that was stopped goes on from
//! the pieces it has.

pub mod judged;
mod table;
mod write;

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use pinwheel_gearbox::Gearbox;
use pinwheel_scene::Scene;
use serde::{Deserialize, Serialize};

use crate::StudyError;
use crate::control::{self, Control, Progress};
use crate::divergence::{self, Horizon};
use crate::drift::{self, Drift};
use crate::pool;
use crate::published::{self, DAMPINGS, Entry, LIMITED, Limit, Switch};
use crate::stability::{self, Options, Row};

/// What to do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// The atlas.
    pub atlas: Options,
    /// Scenes whose divergence is measured.
    pub diverging: Vec<String>,
    /// Their runs are cut to this length, s.
    pub divergence_longest_s: f64,
    /// Length of the long run, s; `None`: none.
    pub drift_s: Option<f64>,
    /// Dampings at which the published choices are tried, N s/m.
    pub dampings: Vec<f64>,
    /// Length of these runs, s.
    pub published_s: f64,
    /// Choices and steps (s) for which the largest damping is looked for.
    pub limits: Vec<(Switch, f64)>,
}

/// Scenes beside the hard ones whose divergence is measured: those that comparisons are made of.
const COMPARED: [&str; 4] = ["paper", "paper-friction", "backlash-0.6", "steel"];
/// Length of the runs in which the largest damping is looked for, s.
const LIMIT_RUN: f64 = 0.05;

impl Plan {
    /// Everything: some minutes.
    #[must_use]
    pub fn full() -> Self {
        let atlas = Options::default();
        let limits = [1e-5, 5e-6]
            .into_iter()
            .flat_map(|step| LIMITED.map(|switch| (switch, step)));
        Self {
            diverging: all_diverging(&atlas),
            atlas,
            divergence_longest_s: 0.6,
            drift_s: Some(10.0),
            dampings: DAMPINGS.to_vec(),
            published_s: 0.3,
            limits: limits.collect(),
        }
    }

    /// The same on short runs: about a minute.
    #[must_use]
    pub fn quick() -> Self {
        let atlas = Options::quick();
        Self {
            diverging: all_diverging(&atlas),
            atlas,
            divergence_longest_s: 0.05,
            drift_s: Some(0.5),
            dampings: vec![8.0, 64.0],
            published_s: 0.1,
            limits: LIMITED.map(|switch| (switch, 1e-5)).to_vec(),
        }
    }

    /// Atlas and divergence of these scenes alone; without names the plan as it is.
    ///
    /// # Errors
    /// A scene that is named twice, that cannot be read, or that cannot be modelled.
    pub fn of(self, scenes: &[String]) -> Result<Self, StudyError> {
        if scenes.is_empty() {
            return Ok(self);
        }
        for (k, name) in scenes.iter().enumerate() {
            if scenes[..k].contains(name) {
                let what = format!("{name} is named twice; name each scene once");
                return Err(StudyError::Input(what));
            }
            Gearbox::new(&Scene::load(name, &[])?).map_err(|source| StudyError::Scene {
                scene: name.clone(),
                source,
            })?;
        }
        Ok(Self {
            atlas: Options {
                scenes: scenes.to_vec(),
                ..self.atlas
            },
            diverging: scenes.to_vec(),
            drift_s: None,
            dampings: Vec::new(),
            limits: Vec::new(),
            ..self
        })
    }
}

fn all_diverging(atlas: &Options) -> Vec<String> {
    let compared = COMPARED.map(str::to_owned);
    compared.into_iter().chain(atlas.scenes.clone()).collect()
}

/// What was found; `None` for pieces that are not done. Lists are as long as those of the plan.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Survey {
    /// What was to be done.
    pub plan: Plan,
    /// One a scene of the atlas.
    pub rows: Vec<Option<Row>>,
    /// One a scene.
    pub horizons: Vec<Option<Horizon>>,
    /// One a stabilisation.
    pub drift: Option<Vec<Drift>>,
    /// One a damping.
    pub published: Vec<Option<Vec<Entry>>>,
    /// One a choice and step.
    pub limits: Vec<Option<Limit>>,
}

/// A piece of the survey, by its place in the plan.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Piece {
    Row(usize),
    Horizon(usize),
    Drift,
    Published(usize),
    Limit(usize),
}

/// What a piece found.
enum Found {
    Row(Row),
    Horizon(Horizon),
    Drift(Vec<Drift>),
    Published(Vec<Entry>),
    Limit(Limit),
}

impl Survey {
    /// Nothing done yet.
    #[must_use]
    pub fn new(plan: Plan) -> Self {
        Self {
            rows: vec![None; plan.atlas.scenes.len()],
            horizons: vec![None; plan.diverging.len()],
            drift: None,
            published: vec![None; plan.dampings.len()],
            limits: vec![None; plan.limits.len()],
            plan,
        }
    }

    /// Pieces done and in all.
    #[must_use]
    pub fn done(&self) -> (usize, usize) {
        let all = self.pieces(|_| true).len();
        (all - self.open().len(), all)
    }

    /// Does what is open on `jobs` threads.
    ///
    /// # Errors
    /// The first error of a piece, after the others have ended. Pieces that were done stay, also when cancelled.
    pub fn go_on(&mut self, jobs: usize, control: &Control<'_>) -> Result<(), StudyError> {
        let mut open = self.open();
        // The longest first, so that none is left alone at the end.
        open.sort_by_key(|piece| match piece {
            Piece::Drift => 0,
            Piece::Published(_) => 1,
            Piece::Row(_) => 2,
            Piece::Horizon(_) => 3,
            Piece::Limit(_) => 4,
        });
        let (done, total) = self.done();
        let ended = AtomicUsize::new(done);
        let plan = self.plan.clone();
        let (found, fault) = (Mutex::new(Vec::new()), Mutex::new(None));
        let quiet = Control {
            cancel: control.cancel,
            progress: &|_| {},
        };
        pool::each(
            jobs,
            open.len(),
            || (),
            |(), k| {
                let piece = open[k];
                if control.is_cancelled() {
                    return false;
                }
                let (done, piece_title) = (ended.load(Ordering::Relaxed), title(piece, &plan));
                (control.progress)(Progress::new(done, total, &piece_title));
                let outcome = study(piece, &plan, &quiet);
                ended.fetch_add(1, Ordering::Relaxed);
                match outcome {
                    Ok(result) => pool::lock(&found).push((piece, result)),
                    Err(error) => {
                        pool::lock(&fault).get_or_insert(error);
                        return false;
                    }
                }
                true
            },
        );
        for (piece, result) in found.into_inner().unwrap_or_default() {
            self.keep(piece, result);
        }
        match fault.into_inner().ok().flatten() {
            Some(error) => Err(error),
            None if self.open().is_empty() => Ok(()),
            None => Err(StudyError::Cancelled),
        }
    }

    fn keep(&mut self, piece: Piece, found: Found) {
        match (piece, found) {
            (Piece::Row(k), Found::Row(row)) => self.rows[k] = Some(row),
            (Piece::Horizon(k), Found::Horizon(horizon)) => self.horizons[k] = Some(horizon),
            (_, Found::Drift(drift)) => self.drift = Some(drift),
            (Piece::Published(k), Found::Published(entries)) => self.published[k] = Some(entries),
            (Piece::Limit(k), Found::Limit(limit)) => self.limits[k] = Some(limit),
            // A piece finds its own kind.
            _ => {}
        }
    }

    fn open(&self) -> Vec<Piece> {
        self.pieces(|piece| match piece {
            Piece::Row(k) => self.rows[k].is_none(),
            Piece::Horizon(k) => self.horizons[k].is_none(),
            Piece::Drift => self.drift.is_none(),
            Piece::Published(k) => self.published[k].is_none(),
            Piece::Limit(k) => self.limits[k].is_none(),
        })
    }

    fn pieces(&self, keep: impl Fn(Piece) -> bool) -> Vec<Piece> {
        let plan = &self.plan;
        let rows = (0..plan.atlas.scenes.len()).map(Piece::Row);
        let horizons = (0..plan.diverging.len()).map(Piece::Horizon);
        let drift = plan.drift_s.map(|_| Piece::Drift);
        let published = (0..plan.dampings.len()).map(Piece::Published);
        let limits = (0..plan.limits.len()).map(Piece::Limit);
        rows.chain(horizons)
            .chain(drift)
            .chain(published)
            .chain(limits)
            .filter(|&piece| keep(piece))
            .collect()
    }

    /// True when every list is as long as the plan says: what was read back from a file may be anything.
    #[must_use]
    pub fn is_whole(&self) -> bool {
        self.rows.len() == self.plan.atlas.scenes.len()
            && self.horizons.len() == self.plan.diverging.len()
            && self.published.len() == self.plan.dampings.len()
            && self.limits.len() == self.plan.limits.len()
    }
}

fn title(piece: Piece, plan: &Plan) -> String {
    match piece {
        Piece::Row(k) => format!("atlas of {}", plan.atlas.scenes[k]),
        Piece::Horizon(k) => format!("divergence of {}", plan.diverging[k]),
        Piece::Drift => "drift of a long run".to_owned(),
        Piece::Published(k) => format!("published choices at C = {}", plan.dampings[k]),
        Piece::Limit(k) => format!("largest damping, {}", plan.limits[k].0.words()),
    }
}

fn study(piece: Piece, plan: &Plan, control: &Control<'_>) -> Result<Found, StudyError> {
    let preset = |name: &str, duration_s: f64| -> Result<Scene, StudyError> {
        let mut scene = Scene::load(name, &[])?.into_scene();
        scene.solver.duration_s = duration_s;
        Ok(scene)
    };
    Ok(match piece {
        Piece::Row(k) => Found::Row(stability::row(&plan.atlas.scenes[k], &plan.atlas, control)?),
        Piece::Horizon(k) => {
            let mut scene = Scene::load(&plan.diverging[k], &[])?.into_scene();
            let solver = &mut scene.solver;
            solver.duration_s = solver.duration_s.min(plan.divergence_longest_s);
            solver.sample_s = solver.sample_s.min(solver.duration_s);
            let mut watch = |_| control.cancel.load(Ordering::Relaxed);
            let gearbox = control::compile(&scene)?;
            let step = divergence::STEP_RAD;
            Found::Horizon(divergence::horizon(&gearbox, step, &mut watch)?)
        }
        Piece::Drift => {
            let mut scene = preset("paper", plan.drift_s.unwrap_or_default())?;
            scene.solver.sample_s = (1e-3 * scene.solver.duration_s).max(scene.solver.step_s);
            Found::Drift(drift::measure(&scene, control)?)
        }
        Piece::Published(k) => {
            let scene = preset("paper", plan.published_s)?;
            Found::Published(published::run(&scene, &[plan.dampings[k]], control)?)
        }
        Piece::Limit(k) => {
            let (switch, step) = plan.limits[k];
            let scene = preset("paper", LIMIT_RUN)?;
            Found::Limit(published::limit(&scene, switch, step, control)?)
        }
    })
}
