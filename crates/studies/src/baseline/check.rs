//! Check of the present solver against an accepted baseline.

use pinwheel_gearbox::auto;
use pinwheel_mbs::integrators::method;
use serde::Serialize;

use super::Options;
use super::file::{Baseline, CaseSnapshot, Made, SceneSnapshot};
use super::judge::{self, CostCheck, QuantityCheck, Verdict};
use super::moved;
use super::runner::{RunResult, run_all};
use super::snapshot::Quantity;
use crate::StudyError;
use crate::control::Control;

/// Check of one scene by one solver.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct CaseCheck {
    /// Name of the scene.
    pub scene: String,
    /// Name of the solver choice.
    pub choice: String,
    /// Checks by quantity; empty without a comparison.
    pub quantities: Vec<QuantityCheck>,
    /// Checks of counts; less is better.
    pub costs: Vec<CostCheck>,
    /// Hash of all bits of the new run; 0 without one.
    #[serde(skip)]
    pub bits: u64,
    /// Reason why the case cannot be compared: diverged, not in the baseline, gone from the set.
    pub trouble: Option<String>,
    /// Verdict on the case.
    pub verdict: Verdict,
    /// Changed stage with the likely cause, for the first cases with an increased error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stage: Option<String>,
}

/// Complete check.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Check {
    /// Program and machine that made the baseline.
    pub before: Made,
    /// Program and machine that made the new runs.
    pub after: Made,
    /// Solvers that joined; empty: the native one.
    pub solvers: Vec<String>,
    /// Checks by scene and solver, in the order of the set.
    pub cases: Vec<CaseCheck>,
    /// Most urgent verdict of all cases.
    pub verdict: Verdict,
}

/// Answer in one line for a solver or a baseline.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Answer {
    /// Name of the solver, or of the baseline for the native solver.
    pub name: String,
    /// Most urgent verdict.
    pub verdict: Verdict,
    /// Counts by verdict, and cases that need attention.
    pub text: String,
}

/// Largest number of cases named in a line.
const NAMED: usize = 3;
/// Largest number of cases with a located stage.
const LOCATED: usize = 1;

impl Check {
    /// Returns one line for each solver that joined, or for the baseline `name`.
    pub fn answers(&self, name: &str) -> Vec<Answer> {
        let brought = |solver: &String| {
            let own = self.cases.iter().filter(|case| case.choice == *solver);
            answer(solver, own.collect())
        };
        match self.solvers.as_slice() {
            [] => vec![answer(name, self.cases.iter().collect())],
            solvers => solvers.iter().map(brought).collect(),
        }
    }
}

fn answer(name: &str, mut cases: Vec<&CaseCheck>) -> Answer {
    cases.sort_by_key(|case| std::cmp::Reverse(case.verdict));
    let verdict = cases.first().map_or(Verdict::New, |case| case.verdict);
    let mut parts = Vec::new();
    for group in cases.chunk_by(|a, b| a.verdict == b.verdict) {
        let asks = group[0].verdict >= Verdict::Traded;
        let named = group.iter().take(if asks { NAMED } else { 0 });
        let mut named: Vec<String> = named.map(|case| case.label(name)).collect();
        if asks && group.len() > NAMED {
            named.push("...".to_owned());
        }
        let colon = if asks { ": " } else { "" };
        let (count, label) = (group.len(), group[0].verdict.label());
        parts.push(format!("{count} {label}{colon}{}", named.join(", ")));
    }
    let text = match verdict {
        _ if cases.is_empty() => "nothing shown: no case was compared".to_owned(),
        Verdict::New => format!("nothing shown: {}", parts.join("; ")),
        _ => parts.join("; "),
    };
    Answer {
        name: name.to_owned(),
        verdict,
        text: format!("{name}: {text}"),
    }
}

/// Runs the set and compares it with `baseline`; `here` describes the new runs. Cases missing in the baseline are not run.
///
/// # Errors
/// Stopped, or a scene of the set cannot be modelled. A diverged run is a result.
pub fn check(
    baseline: &Baseline,
    here: Made,
    options: &Options,
    control: &Control<'_>,
) -> Result<Check, StudyError> {
    baseline.made_by(&options.solvers)?;
    let every = options.only.is_empty();
    let mut cases = Vec::new();
    let (mut jobs, mut known) = (Vec::new(), Vec::new());
    for case in options.scenes()? {
        let scene = baseline.scenes.iter().find(|scene| scene.name == case.name);
        // The native solver's baseline has all scenes of the set; a user's solver may have fewer.
        if every && scene.is_none() && !options.solvers.is_empty() {
            continue;
        }
        for plan in options.planned(case)? {
            let accepted = scene.and_then(|scene| {
                let accepted = scene.cases.iter().find(|c| c.choice == plan.name);
                accepted.map(|accepted| (scene, accepted))
            });
            let mut checked = CaseCheck::new(&case.name, plan.name);
            match (accepted, plan.refused) {
                (Some(accepted), None) => {
                    jobs.push(plan.job);
                    known.push((cases.len(), accepted));
                }
                (None, Some(_)) if every => continue,
                (accepted, refused) => {
                    let remedy = || format!("`baseline record --only {}` adds it", case.name);
                    let refused = refused.map(|reason| format!("refused: {reason}"));
                    checked.trouble = Some(refused.unwrap_or_else(remedy));
                    checked.verdict = accepted.map_or(Verdict::New, |_| Verdict::Worse);
                }
            }
            cases.push(checked);
        }
    }
    let results = run_all(&jobs, options.threads, control)?;
    let mut located: Vec<(&str, String)> = Vec::new();
    for (((place, accepted), job), result) in known.into_iter().zip(&jobs).zip(results) {
        let integrator = auto::integrator(&job.scene).0;
        // Counts of an external solver may depend on rounding like those of an adaptive method.
        let adaptive = job.solver.is_some() || method(&integrator).is_some_and(|m| m.adaptive);
        let case = &mut cases[place];
        case.judge(accepted, result, adaptive);
        let most = case.moved_most();
        let is_sought = |most: &&QuantityCheck| options.stages && most.verdict == Verdict::Worse;
        let Some(most) = most.filter(is_sought) else {
            continue;
        };
        let drifts = most.quantity == Quantity::JointDrift;
        // A change of the model affects all solvers of a scene.
        let scene = accepted.0.name.as_str();
        let same = located.iter().find(|(name, _)| *name == scene);
        case.stage = same.map(|(_, stage)| stage.clone());
        if case.stage.is_none() && located.len() < LOCATED {
            let (stage, is_of_model) = moved::stage(accepted.0, job, drifts, control)?;
            located.push((if is_of_model { scene } else { "" }, stage.clone()));
            case.stage = Some(stage);
        }
    }
    // Cases of the baseline that are no longer in the set: without a run they cannot be called unchanged.
    let asked = |scene: &&SceneSnapshot| every || options.only.contains(&scene.name);
    for scene in baseline.scenes.iter().filter(asked) {
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
        solvers: options.solvers.clone(),
        verdict: verdict.unwrap_or(Verdict::New),
        cases,
    })
}

impl CaseCheck {
    /// Creates an unchanged check without comparisons.
    fn new(scene: &str, choice: &str) -> Self {
        Self {
            scene: scene.to_owned(),
            choice: choice.to_owned(),
            ..Self::default()
        }
    }

    fn judge(
        &mut self,
        (scene, accepted): (&SceneSnapshot, &CaseSnapshot),
        result: RunResult,
        adaptive: bool,
    ) {
        let run = match result {
            Ok(run) => run,
            Err(ending) => {
                (self.trouble, self.verdict) = (Some(ending.to_string()), Verdict::Worse);
                return;
            }
        };
        self.bits = run.bits;
        // A quantity that cannot be compared is worse than any other.
        let mut unlike = None;
        for (&quantity, before) in &accepted.quantity {
            let after = run.statistics.get(&quantity);
            let known = after.zip(scene.converged.get(&quantity));
            let judge = |(after, truth)| judge::quantity(quantity, after, before, truth);
            match known.and_then(judge) {
                Some(check) => self.quantities.push(check),
                None => unlike = Some(quantity),
            }
        }
        let mut known = run.statistics.keys().copied();
        let new = known.find(|quantity| !accepted.quantity.contains_key(quantity));
        self.costs = judge::costs(accepted, &run.costs, adaptive);
        self.verdict = judge::case(&self.quantities, &self.costs);
        if let Some(quantity) = new.or(unlike) {
            let label = quantity.label();
            let trouble = format!("{label}: the run and the baseline hold different figures of it");
            (self.trouble, self.verdict) = (Some(trouble), Verdict::Worse);
        }
    }

    /// Returns the scene, with the choice unless it is `by`, the line's solver.
    fn label(&self, by: &str) -> String {
        let case = match self.choice == by {
            true => self.scene.clone(),
            false => format!("{} by {}", self.scene, self.choice),
        };
        match &self.trouble {
            Some(trouble) => format!("{case} ({trouble})"),
            None => case,
        }
    }

    /// Returns the quantity with the largest change relative to its rounding limit, if any is compared.
    pub fn moved_most(&self) -> Option<&QuantityCheck> {
        self.quantities.iter().max_by(|a, b| {
            let by_verdict = a.verdict.cmp(&b.verdict);
            by_verdict.then(a.change.total_cmp(&b.change))
        })
    }
}
