//! Main figures: forces, driver torque and efficiency of the representative engine.

use pinwheel_compare::comparison::EngineSummary;
use pinwheel_compare::uncertainty::Norm;
use pinwheel_compare::{Comparison, Quantity, SharedModel, WindowKind, quantities};
use pinwheel_engines::{Form, info};
use pinwheel_studies::comparison::Outcome;
use pinwheel_timeseries::figure::{Figure, FigureDef};

/// Returns the window of the figures: the steady one, else the complete run, whose largest force may come after the
/// start-up.
pub(super) fn window(comparison: &Comparison) -> Option<WindowKind> {
    let windows = comparison.windows.iter().map(|window| window.kind);
    windows.min_by_key(|kind| *kind == WindowKind::Transient)
}

/// Returns the representative engine and the window of its figures. Candidates share the contact law, or are all engines if
/// none does. Live runs precede recordings, known uncertainties precede unknown ones, and the resolved form precedes
/// others; the smallest uncertainty decides among the rest.
pub(super) fn best(comparison: &Comparison) -> Option<(&EngineSummary, WindowKind)> {
    let window = window(comparison)?;
    let is_sharing =
        |e: &&EngineSummary| matches!(e.track, SharedModel::Native | SharedModel::SharedLaw);
    let engines = || {
        let engines = comparison.engines.iter();
        engines.filter(|e| e.status.is_finished())
    };
    let some_share = engines().any(|e| is_sharing(&e));
    let engines = engines().filter(|e| !some_share || is_sharing(e));
    let engines = engines.filter(|e| e.figures_in(window).is_some());
    let rank = |e: &EngineSummary| {
        let off = numerical(comparison, e, window).unwrap_or(f64::INFINITY);
        let is_resolved = info(&e.name).and_then(|info| info.form) == Some(Form::Resolved);
        let last = [e.cost.recorded.is_some(), off.is_infinite(), !is_resolved];
        (last, off)
    };
    let best = engines.min_by(|a, b| {
        let (a, b) = (rank(a), rank(b));
        a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
    });
    Some((best?, window))
}

/// Returns the largest relative uncertainty of an engine's torques and forces for its own equations.
pub(super) fn numerical(
    comparison: &Comparison,
    engine: &EngineSummary,
    window: WindowKind,
) -> Option<f64> {
    let known = comparison.quantities.iter().filter(|q| q.is_load());
    let shares = known.filter_map(|q| {
        let size = engine.figures_in(window)?.quantities.get(&q.name)?.rms;
        Some(engine.u(&q.name, window, Norm::L2)? / size)
    });
    shares.reduce(f64::max)
}

/// Returns forces, driver torque and efficiency.
pub(super) fn figures(outcome: &Outcome) -> Vec<Figure> {
    let Some((best, window)) = best(&outcome.comparison) else {
        return Vec::new();
    };
    let loads = outcome.comparison.quantities.iter();
    let loads = loads.filter(|q| q.is_load() && q.name != quantities::OUTPUT_TORQUE);
    let loads = loads.filter_map(|quantity| load(outcome, best, window, quantity));
    let mut figures: Vec<Figure> = loads.collect();
    // Forces come first: they name the loaded parts.
    figures.sort_by_key(|figure| figure.def.unit != "N");
    figures.extend(efficiency(best, window));
    figures
}

/// Returns the mean of a torque, or the largest force.
fn load(
    outcome: &Outcome,
    best: &EngineSummary,
    window: WindowKind,
    of: &Quantity,
) -> Option<Figure> {
    let own = best.figures_in(window)?.quantities.get(&of.name)?;
    let scales = outcome.comparison.context.scales;
    let (value, kind, norm, scale) = match of.is_torque() {
        true => (own.mean, "mean", Norm::Mean, scales.torque_n_m),
        false => (own.max, "largest", Norm::Peak, scales.force_n),
    };
    let off = best.u(&of.name, window, norm);
    // A load within rounding is 0 with that uncertainty.
    let rounding = ROUNDING * scale.unwrap_or(0.0);
    let off = match value.abs() <= rounding {
        true => Some(off.map_or(rounding, |off| off.max(rounding))),
        false => off,
    };
    let key = format!("{kind}_{}", of.name);
    let label = format!("{}, {kind}", of.label);
    let mut figure = FigureDef::named(key, label, of.unit.clone()).of(value, off);
    if let Some(bands) = &outcome.bands {
        bands.bound_load(&mut figure, &of.name);
    }
    Some(figure)
}

/// Relative accuracy of sums of many terms in double precision.
const ROUNDING: f64 = 1e-12;

/// Returns the efficiency, or the reason for a missing one.
fn efficiency(best: &EngineSummary, window: WindowKind) -> Option<Figure> {
    let figures = best.figures_in(window)?;
    // Powers in the efficiency are those of the mean torques.
    let share = |name: &str| {
        let mean = figures.quantities.get(name)?.mean.abs();
        let share = best.u(name, window, Norm::Mean)? / mean;
        Some(share).filter(|share| share.is_finite())
    };
    let def = FigureDef::named("efficiency_percent", "Efficiency", "%");
    let Some(value) = figures.efficiency else {
        let reason = figures.efficiency_reason.clone()?;
        return Some(def.of(None, None).withheld(reason));
    };
    let [driver, load] = [quantities::INPUT_TORQUE, quantities::OUTPUT_TORQUE].map(share);
    let off = driver.zip(load).map(|(driver, load)| driver + load);
    let percent = 100.0 * value;
    Some(def.of(percent, off.map(|off| off * percent)))
}
