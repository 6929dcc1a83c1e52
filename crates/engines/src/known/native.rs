//! Facts of the native solver's three engines.

use pinwheel_timeseries::SharedModel;

use crate::info::{EngineInfo, Form};

/// Engines of the family, in the order of reports.
pub(super) static ALL: &[&EngineInfo<'static>] = &[&REDUCED, &LAGRANGE, &RESOLVED];

pub(crate) static REDUCED: EngineInfo<'static> = EngineInfo {
    summary: "own solver, centre-pinned bodies eliminated exactly",
    short: "reduced",
    colour: Some(0),
    form: Some(Form::Reduced),
    usual_s: 0.3,
    differences: "One equation per angle that forces can change: discs, output, and with friction the pins. \
        Translations of centre-pinned bodies are eliminated exactly, so there are no joints to drift.",
    ..EngineInfo::own("native-reduced", SharedModel::Native)
};

pub(crate) static LAGRANGE: EngineInfo<'static> = EngineInfo {
    summary: "own solver, every body and joint by multipliers (Eq. 2)",
    short: "lagrange",
    colour: Some(1),
    form: Some(Form::Lagrange),
    usual_s: 0.6,
    differences: "Three coordinates per body and multipliers for every joint, as the paper writes it. The saddle-point \
        system is factored along the joints; positions are put back onto the constraints at every stage \
        unless the scene says otherwise.",
    ..EngineInfo::own("native-lagrange", SharedModel::Native)
};

pub(crate) static RESOLVED: EngineInfo<'static> = EngineInfo {
    summary: "own solver, reduced form, integrated until the step no longer matters",
    short: "resolved",
    colour: Some(2),
    form: Some(Form::Resolved),
    usual_s: 0.2,
    differences: "The equations of native-reduced without the scene's integrator and step: method and steps come from the \
        scene's frequencies and are refined until two runs show the forces to be within 1e-7 (with friction or points \
        1e-5) of the exact solution; the notes say what was reached. Its distance from native-reduced is the error of the \
        scene's own integrator.",
    ..EngineInfo::own("native-resolved", SharedModel::Native)
};
