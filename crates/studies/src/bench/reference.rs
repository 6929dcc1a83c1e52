//! The converged run, and proof that it is: two methods that have nothing in common but the forces.
//!
//! | scene | reference | second method |
//! |---|---|---|
//! | no friction, exact contact | dopri5, tolerance 1e-11 | rk4, fixed step of about 1/1000 period |
//! | friction | dopri5, tolerance 1e-9 | imex2 (friction implicit), a fortieth of the scene's step |
//! | discrete points | rk4, a fortieth of the scene's step | rk2, the same step |
//!
//! The distance between the two is the error of the worse of them, and thus an upper estimate for the
//! reference. What the reference gains from a tolerance ten times (a step two times) coarser is given beside it.

use pinwheel_engines::Knob;
use pinwheel_scene::{Detection, FrictionLaw, Scene};
use pinwheel_timeseries::TimeSeries;
use pinwheel_timeseries::norms::Least;
use serde::Serialize;

use super::norms::{Errors, Span, errors, spans};
use crate::StudyError;
use crate::control::{Control, compile, complete, reduced_by};

/// One converged solution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Solution {
    /// Integrator.
    pub method: String,
    /// What its setting is.
    pub knob: Knob,
    /// Step (s) or tolerance.
    pub setting: f64,
    /// Right-hand-side calls.
    pub rhs_calls: u64,
}

/// What everything is measured against.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// The solution taken.
    pub solution: Solution,
    /// The other one.
    pub second: Solution,
    /// Distance of the second from the first, window by window: an upper estimate of the reference's error.
    pub between_methods: Vec<Errors>,
    /// Distance of a coarser run by the first method.
    pub to_coarser: Vec<Errors>,
    /// Its setting.
    pub coarser_setting: f64,
}

impl Reference {
    /// Upper estimate of the reference's error in window `k`.
    #[must_use]
    pub fn error(&self, k: usize) -> Errors {
        self.between_methods[k]
    }
}

/// Fixed steps of the second method, in radians of the fastest elastic oscillation.
const STEP_RADIANS: f64 = 0.01;
/// Fixed steps where forces jump or friction is stiff, as a share of the scene's.
const DIVISION: f64 = 40.0;

struct MethodSetting {
    method: &'static str,
    setting: f64,
}

impl MethodSetting {
    fn coarser(&self) -> f64 {
        match Knob::of(self.method) {
            Knob::Tolerance => 10.0 * self.setting,
            Knob::Step => 2.0 * self.setting,
        }
    }
}

fn methods(scene: &Scene) -> Result<[MethodSetting; 2], StudyError> {
    let contact = &scene.contact;
    let short = scene.solver.step_s / DIVISION;
    let plan = |method, setting| MethodSetting { method, setting };
    if contact.detection == Detection::Points {
        return Ok([plan("rk4", short), plan("rk2", short)]);
    }
    if contact.friction_coefficient > 0.0 {
        let second = if contact.friction_law == FrictionLaw::Regularised {
            plan("imex2", short)
        } else {
            plan("rk4", short)
        };
        return Ok([plan("dopri5", 1e-9), second]);
    }
    let gearbox = compile(scene)?;
    let step = STEP_RADIANS / gearbox.error_scales().frequency;
    Ok([
        plan("dopri5", 1e-11),
        plan("rk4", step.min(scene.solver.step_s)),
    ])
}

/// Runs both methods and the coarser one; returns the windows, the loads that count as none, and the time series too.
pub(super) fn run(
    scene: &Scene,
    control: &Control<'_>,
    announce: &mut dyn FnMut(&str),
) -> Result<(Reference, Vec<Span>, Least, TimeSeries), StudyError> {
    let [first, second] = methods(scene)?;
    let mut solve = |plan: &MethodSetting, setting: f64| {
        announce(&format!("reference: {}, {setting:.2e}", plan.method));
        let run = complete(&reduced_by(scene, plan.method, setting), control)?;
        let solution = Solution {
            method: plan.method.to_owned(),
            knob: Knob::of(plan.method),
            setting,
            rhs_calls: run.counts.evaluations,
        };
        Ok::<_, StudyError>((solution, run.time_series))
    };
    let (solution, time_series) = solve(&first, first.setting)?;
    let (other, others) = solve(&second, second.setting)?;
    let (_, coarser) = solve(&first, first.coarser())?;
    let spans = spans(scene, &time_series);
    let least = compile(scene)?.least_loads();
    let against = |run: &TimeSeries| {
        let spans = spans.iter();
        spans
            .map(|span| errors(run, &time_series, span, least))
            .collect()
    };
    let reference = Reference {
        solution,
        second: other,
        between_methods: against(&others),
        to_coarser: against(&coarser),
        coarser_setting: first.coarser(),
    };
    Ok((reference, spans, least, time_series))
}
