//! Figs. 11 to 13: backlash, and the pin forces it makes.

use pinwheel_contact::Complex;
use pinwheel_gearbox::Geometry;
use pinwheel_scene::{Scene, free_play};

use super::figure::{Curve, Measured, Plot, number, numbers};
use super::read::{DRAWN, DYING, EXTERNAL, INTERNAL, STEADY, peak};
use super::runs::{Cases, Model, Runs};
use crate::StudyError;
use crate::control::of_scene;

/// As numbers name the backlashes.
pub(super) const NAMES: [&str; 3] = ["0", "0.3_mm", "0.6_mm"];

/// The smallest turn of a disc from its ideal mesh to the first touch, rad, found on the curve itself.
fn turn_to_touch(scene: &Scene, backlash: f64) -> Result<f64, StudyError> {
    let mut loose = scene.clone();
    loose.gear.backlash_m = backlash;
    let gear = &loose.gear;
    let geometry = Geometry::new(&loose).map_err(|source| of_scene(scene, source))?;
    let centre = Complex::new(gear.eccentricity_m, 0.0);
    let circle = geometry.curve.pitch_radius() + backlash;
    let gap = |turn: f64| {
        let back = Complex::unit(-(geometry.ideal_wheel_angle(0, 0.0) + turn));
        let at = |direction: &Complex| (direction.scale(circle) - centre) * back;
        let sleeves = geometry.external_directions.iter().map(at);
        let gaps = sleeves.map(|sleeve| geometry.curve.closest(sleeve).distance);
        gaps.fold(f64::INFINITY, f64::min)
    };
    // The gap falls steadily from d, and the closed form is its tangent: three times as far is well inside.
    let (mut low, mut high) = (0.0, 3.0 * free_play(gear));
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if gap(middle) > 0.0 {
            low = middle
        } else {
            high = middle
        }
    }
    Ok(0.5 * (low + high))
}

pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let exact = runs.backlashes(Model::Ours)?;
    let fine = runs.backlashes(Model::FINE)?;
    let coarse = runs.backlashes(Model::ROUGH)?;
    let peaks =
        |cases: &Cases, group, window| cases.each(|time_series| peak(time_series, group, window));
    let external = peaks(&exact, EXTERNAL, STEADY);
    let internal = peaks(&exact, INTERNAL, STEADY);
    let early = peaks(&exact, INTERNAL, DYING);
    let growth = |name: &str, peaks: &[f64]| number(name, peaks[2] / peaks[0] - 1.0, "");
    let plot = |model: Model, [key, title]: [&str; 2], group: &str, window: (f64, f64)| {
        let cases = if model == Model::Ours { &exact } else { &fine };
        let title = format!("{title}, {}", model.words());
        cases.plot([key, &title, "Force (N)"], &format!("{group}_0"), window)
    };
    let (ours, points) = (Model::Ours, Model::FINE);
    let of_external = "Force on ring pin 0";
    let of_internal = "Force on output pin 0";
    let start = "The start: force on output pin 0";
    let mut twelve = numbers("external_peak", &NAMES, &external, "N");
    twelve.extend([
        growth("growth", &external),
        growth("growth_4000_points", &peaks(&fine, EXTERNAL, STEADY)),
    ]);
    let mut thirteen = numbers("internal_peak", &NAMES, &internal, "N");
    thirteen.extend(numbers("internal_peak_start", &NAMES, &early, "N"));
    thirteen.extend([
        growth("growth_steady", &internal),
        growth("growth_0.06_to_0.15_s", &early),
        growth("growth_steady_4000_points", &peaks(&fine, INTERNAL, STEADY)),
        growth(
            "growth_steady_600_points",
            &peaks(&coarse, INTERNAL, STEADY),
        ),
    ]);
    let plots = vec![
        plot(ours, ["fig-12a", of_external], EXTERNAL, DRAWN),
        plot(points, ["fig-12b", of_external], EXTERNAL, DRAWN),
    ];
    let twelve = Measured::new("fig-12", twelve, plots);
    let plots = vec![
        plot(ours, ["fig-13a", of_internal], INTERNAL, DRAWN),
        plot(ours, ["fig-13b", start], INTERNAL, (0.0, 0.24)),
    ];
    let thirteen = Measured::new("fig-13", thirteen, plots);
    Ok(vec![eleven()?, twelve, thirteen])
}

fn eleven() -> Result<Measured, StudyError> {
    let scene = Scene::paper();
    let x: Vec<f64> = (1..=12).map(|k| f64::from(k) * 0.05).collect();
    let mut found = Vec::new();
    let mut closed = Vec::new();
    for d_mm in &x {
        found.push(1e3 * turn_to_touch(&scene, 1e-3 * d_mm)?);
        let mut gear = scene.gear.clone();
        gear.backlash_m = 1e-3 * d_mm;
        closed.push(1e3 * free_play(&gear));
    }
    let last = x.len() - 1;
    let numbers = vec![
        number("free_play_found_mrad", found[last], "mrad"),
        number("free_play_closed_form_mrad", closed[last], "mrad"),
        number("apart", found[last] / closed[last] - 1.0, ""),
    ];
    let curves = vec![
        Curve::points("first touch on the curve", found),
        Curve::line("closed form", closed),
    ];
    let title = "Free turn of an unloaded disc to one side";
    let words = ["fig-11", title, "Tolerance d (mm)", "Free play (mrad)"];
    let plot = Plot::new(words, x, curves);
    Ok(Measured::new("fig-11", numbers, vec![plot]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the geometry, d psi/d d: 17.003 rad per metre; the curve bends away, so the found play is a little off for large d.
    #[test]
    fn free_play_is_found_on_the_curve() {
        let scene = Scene::paper();
        let found = turn_to_touch(&scene, 1e-5).unwrap();
        assert!((found / 1e-5 - 17.003).abs() < 0.02, "{}", found / 1e-5);
    }
}
