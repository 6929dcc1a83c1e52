//! Checking the solver as it is now against an accepted baseline.

use pinwheel_gearbox::auto;
use pinwheel_mbs::integrators::method;
use serde::Serialize;

use super::Options;
use super::cases::{SceneCase, Way};
use super::error::BaselineError;
use super::file::{Baseline, CaseRecord, Made, ReferenceRecord};
use super::judge::{self, CostCheck, QuantityCheck, Verdict};
use super::limits;
use super::record::plain_job;
use super::runner::{Finished, Outcome, run_all};
use crate::control::Control;

/// One scene by one solver.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CaseCheck {
    /// Name of the scene.
    pub scene: String,
    /// Name of the solver choice.
    pub choice: String,
    /// One a quantity; empty if there is nothing to compare.
    pub quantities: Vec<QuantityCheck>,
    /// Counts; less is better.
    pub costs: Vec<CostCheck>,
    /// Times over the yardstick's, accepted and new, where both were measured.
    pub time_ratio: Option<[f64; 2]>,
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
    /// Time over all cases in yardsticks, where both were measured by the same build.
    pub time: Option<CostCheck>,
    /// Whether the time counts for the verdict.
    pub time_is_judged: bool,
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
) -> Result<Check, BaselineError> {
    let recorded = &baseline.head.solvers;
    if *recorded != options.solvers {
        return Err(BaselineError::OtherSolvers {
            recorded: recorded.clone(),
        });
    }
    // What a solver of the user's was recorded on.
    let recorded_on = Options {
        only: baseline.head.scenes.clone(),
        ..options.clone()
    };
    let options = match options.only.is_empty() && !options.solvers.is_empty() {
        true => &recorded_on,
        false => options,
    };
    let mut pairs: Vec<(&SceneCase, Way<'_>)> = Vec::new();
    for case in options.scenes()? {
        pairs.extend(options.ways(case)?.into_iter().map(|way| (case, way)));
    }
    let mut jobs = Vec::new();
    for (case, choice) in &pairs {
        jobs.push(plain_job(case, choice, options)?);
    }
    let outcomes = run_all(&jobs, options.threads, control)?;
    let made = &baseline.head.made;
    let same_build = made.build == here.build;
    let comparable = same_build && made.vectors == here.vectors && made.processor == here.processor;
    let mut cases = Vec::new();
    for (((case, choice), job), outcome) in pairs.iter().zip(&jobs).zip(outcomes) {
        let record = baseline
            .scenes
            .iter()
            .find(|record| record.scene == case.name);
        let accepted = record.and_then(|record| {
            let found = record.cases.iter().find(|c| c.choice == choice.name);
            found.map(|accepted| (&record.reference, accepted))
        });
        let integrator = auto::integrator(&job.scene).integrator;
        let adaptive = match &job.solver {
            // Its counts may follow from roundings as an adaptive method's do.
            Some(_) => true,
            None => method(&integrator).is_some_and(|m| m.adaptive),
        };
        let mut found = CaseCheck {
            scene: case.name.to_owned(),
            choice: choice.name.to_owned(),
            quantities: Vec::new(),
            costs: Vec::new(),
            time_ratio: None,
            trouble: None,
            verdict: Verdict::Same,
        };
        found.judge(accepted, outcome, adaptive, comparable);
        cases.push(found);
    }
    cases.extend(gone(baseline, options, &pairs));
    let time = time(&cases).filter(|_| same_build);
    let judged = time
        .iter()
        .filter(|_| options.judge_time)
        .map(|time| time.verdict);
    let verdict = cases.iter().map(|case| case.verdict).chain(judged).max();
    Ok(Check {
        before: made.clone(),
        after: here,
        time,
        time_is_judged: options.judge_time,
        verdict: verdict.unwrap_or(Verdict::New),
        cases,
    })
}

/// Cases of the baseline that the set no longer has: what is not run cannot be called unchanged.
fn gone(baseline: &Baseline, options: &Options, pairs: &[(&SceneCase, Way<'_>)]) -> Vec<CaseCheck> {
    let mut found = Vec::new();
    for record in &baseline.scenes {
        for accepted in &record.cases {
            let mut run = pairs.iter();
            let known =
                run.any(|(case, way)| case.name == record.scene && way.name == accepted.choice);
            if !known && options.only.is_empty() {
                found.push(CaseCheck {
                    scene: record.scene.clone(),
                    choice: accepted.choice.clone(),
                    quantities: Vec::new(),
                    costs: Vec::new(),
                    time_ratio: None,
                    trouble: Some("in the baseline, but no longer in the set".to_owned()),
                    verdict: Verdict::Worse,
                });
            }
        }
    }
    found
}

impl CaseCheck {
    fn judge(
        &mut self,
        accepted: Option<(&ReferenceRecord, &CaseRecord)>,
        outcome: Outcome,
        adaptive: bool,
        comparable: bool,
    ) {
        let run = match outcome {
            Ok(run) => run,
            Err(reason) => {
                (self.trouble, self.verdict) = (Some(reason), Verdict::Worse);
                return;
            }
        };
        let Some((reference, accepted)) = accepted else {
            let trouble = "not in the baseline yet; record it to watch it".to_owned();
            (self.trouble, self.verdict) = (Some(trouble), Verdict::New);
            return;
        };
        self.quantities = self.quantities(&run, reference, accepted);
        self.costs = judge::costs(accepted, &run.costs, adaptive, comparable);
        self.time_ratio = accepted
            .costs
            .time_ratio
            .zip(run.costs.time_ratio)
            .map(|(a, b)| [a, b]);
        let verdicts = self.quantities.iter().map(|q| q.verdict);
        let verdicts = verdicts.chain(self.costs.iter().map(|c| c.verdict));
        // Without a number nothing is the same.
        self.verdict = verdicts.max().unwrap_or(Verdict::New).max(self.verdict);
    }

    fn quantities(
        &mut self,
        run: &Finished,
        reference: &ReferenceRecord,
        accepted: &CaseRecord,
    ) -> Vec<QuantityCheck> {
        let mut found = Vec::new();
        for values in &run.values {
            let key = values.quantity.key;
            let before = accepted.quantities.iter().find(|q| q.key == key);
            let judged = before
                .zip(reference.quantity(key))
                .and_then(|(before, reference)| {
                    judge::quantity(values, &run.time_s, before, reference)
                });
            match judged {
                Some(check) => found.push(check),
                None => {
                    let label = values.quantity.label;
                    self.trouble = Some(format!(
                        "{label}: the scene has other samples or channels than when recorded"
                    ));
                    self.verdict = Verdict::Worse;
                }
            }
        }
        found
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

/// All cases with both times.
fn time(cases: &[CaseCheck]) -> Option<CostCheck> {
    let ratios: Vec<[f64; 2]> = cases.iter().filter_map(|case| case.time_ratio).collect();
    let sum = |side: usize| ratios.iter().map(|ratio| ratio[side]).sum();
    (!ratios.is_empty()).then(|| {
        judge::cost(
            "time in yardsticks",
            sum(0),
            sum(1),
            limits::TIME_SHARE,
            0.0,
        )
    })
}
