//! Checking the solver as it is now against an accepted baseline.

use pinwheel_gearbox::auto;
use pinwheel_mbs::integrators::method;
use serde::Serialize;

use super::Options;
use super::cases::{SceneCase, Way};
use super::file::{Baseline, CaseSnapshot, Made, SceneSnapshot};
use super::judge::{self, CostCheck, QuantityCheck, Verdict};
use super::record::plain_job;
use super::runner::{Finished, RunResult, run_all};
use crate::StudyError;
use crate::control::Control;

/// One scene by one solver.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CaseCheck {
    /// Name of the scene.
    pub scene: String,
    /// Name of the solver choice.
    pub choice: String,
    /// One a quantity; empty if there is nothing to compare.
    pub quantities: Vec<QuantityCheck>,
    /// Counts; less is better.
    pub costs: Vec<CostCheck>,
    /// Hash of every bit of the new run; 0 where there is none.
    #[serde(skip)]
    pub bits: u64,
    /// What keeps it from being compared: diverged, not in the baseline, gone from the set.
    pub trouble: Option<String>,
    /// What it comes to.
    pub verdict: Verdict,
}

/// The whole check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// What made the baseline.
    pub before: Made,
    /// What made the new runs.
    pub after: Made,
    /// One a scene and solver, in the order of the set.
    pub cases: Vec<CaseCheck>,
    /// What it comes to: the most urgent of all.
    pub verdict: Verdict,
}

/// Runs the set and judges it against `baseline`; `here` says what makes the new runs.
///
/// # Errors
/// Stopped, or a scene of the set cannot be modelled. A run that diverges is a result.
pub fn check(
    baseline: &Baseline,
    here: Made,
    options: &Options,
    control: &Control<'_>,
) -> Result<Check, StudyError> {
    if baseline.solvers != options.solvers {
        return Err(StudyError::Input(match baseline.solvers.as_slice() {
            [] => "this baseline was made by Pinwheel's own solver; leave out --solver, or record one under another name"
                .to_owned(),
            recorded => format!(
                "this baseline was made by {}; name the same by --solver, in this order",
                recorded.join(", ")
            ),
        }));
    }
    let mut options = options.clone();
    if options.only.is_empty() && !options.solvers.is_empty() {
        // What a solver of the user's was recorded on.
        let recorded = baseline.scenes.iter().map(|scene| scene.name.clone());
        options.only = recorded.collect();
    }
    let mut pairs: Vec<(&'static SceneCase, Way<'_>)> = Vec::new();
    for case in options.scenes()? {
        pairs.extend(options.ways(case)?.into_iter().map(|way| (case, way)));
    }
    let mut jobs = Vec::new();
    for (case, choice) in &pairs {
        jobs.push(plain_job(case, choice, &options)?);
    }
    let results = run_all(&jobs, options.threads, control)?;
    let mut cases = Vec::new();
    for (((case, choice), job), result) in pairs.iter().zip(&jobs).zip(results) {
        let mut scenes = baseline.scenes.iter();
        let scene = scenes.find(|scene| scene.name == case.name);
        let accepted = scene.and_then(|scene| {
            let found = scene.cases.iter().find(|c| c.choice == choice.name);
            found.map(|accepted| (scene, accepted))
        });
        let integrator = auto::integrator(&job.scene).0;
        // The counts of a solver from outside may follow from roundings as an adaptive method's do.
        let adaptive = job.solver.is_some() || method(&integrator).is_some_and(|m| m.adaptive);
        let mut found = CaseCheck::new(&case.name, choice.name);
        found.judge(accepted, result, adaptive);
        cases.push(found);
    }
    // Cases of the baseline that the set no longer has: what is not run cannot be called unchanged.
    let every = options.only.is_empty();
    for scene in baseline.scenes.iter().filter(|_| every) {
        for accepted in &scene.cases {
            let is = |case: &CaseCheck| case.scene == scene.name && case.choice == accepted.choice;
            if !cases.iter().any(is) {
                cases.push(CaseCheck {
                    trouble: Some("in the baseline, but no longer in the set".to_owned()),
                    verdict: Verdict::Worse,
                    ..CaseCheck::new(&scene.name, &accepted.choice)
                });
            }
        }
    }
    let verdict = cases.iter().map(|case| case.verdict).max();
    Ok(Check {
        before: baseline.made.clone(),
        after: here,
        verdict: verdict.unwrap_or(Verdict::New),
        cases,
    })
}

impl CaseCheck {
    /// Nothing moved, as nothing was looked at.
    fn new(scene: &str, choice: &str) -> Self {
        Self {
            scene: scene.to_owned(),
            choice: choice.to_owned(),
            ..Self::default()
        }
    }

    fn judge(
        &mut self,
        accepted: Option<(&SceneSnapshot, &CaseSnapshot)>,
        result: RunResult,
        adaptive: bool,
    ) {
        let run = match result {
            Ok(run) => run,
            Err(reason) => {
                (self.trouble, self.verdict) = (Some(reason), Verdict::Worse);
                return;
            }
        };
        self.bits = run.bits;
        let Some((scene, accepted)) = accepted else {
            let trouble = "not in the baseline yet; record it to watch it".to_owned();
            (self.trouble, self.verdict) = (Some(trouble), Verdict::New);
            return;
        };
        self.quantities = self.quantities(&run, scene, accepted);
        self.costs = judge::costs(accepted, &run.costs, adaptive);
        let verdicts = self.quantities.iter().map(|q| q.verdict);
        let verdicts = verdicts.chain(self.costs.iter().map(|c| c.verdict));
        // Without a number nothing is the same.
        self.verdict = verdicts.max().unwrap_or(Verdict::New).max(self.verdict);
    }

    fn quantities(
        &mut self,
        run: &Finished,
        scene: &SceneSnapshot,
        accepted: &CaseSnapshot,
    ) -> Vec<QuantityCheck> {
        let mut found = Vec::new();
        for (&quantity, before) in &accepted.quantity {
            let after = run.statistics.get(&quantity);
            let known = after.zip(scene.converged.get(&quantity));
            let judge = |(after, truth)| judge::quantity(quantity, after, before, truth);
            match known.and_then(judge) {
                Some(check) => found.push(check),
                None => self.unlike(quantity.label()),
            }
        }
        let mut known = run.statistics.keys();
        if let Some(new) = known.find(|quantity| !accepted.quantity.contains_key(quantity)) {
            self.unlike(new.label());
        }
        found
    }

    /// A quantity that cannot be compared is worse than any other.
    fn unlike(&mut self, label: &str) {
        let trouble = format!("{label}: the run and the baseline hold different figures of it");
        (self.trouble, self.verdict) = (Some(trouble), Verdict::Worse);
    }

    /// The quantity that moved most in units of its rounding limit, if any is compared.
    #[must_use]
    pub fn moved_most(&self) -> Option<&QuantityCheck> {
        self.quantities.iter().max_by(|a, b| {
            let by_verdict = a.verdict.cmp(&b.verdict);
            by_verdict.then(a.change.total_cmp(&b.change))
        })
    }
}
