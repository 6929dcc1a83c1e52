//! Figs. 11 to 13: backlash, and its effect on pin forces.

use pinwheel_contact::{Complex, bisect};
use pinwheel_gearbox::Geometry;
use pinwheel_scene::{Scene, free_play};

use super::figure::{Curve, Measured, number};
use super::read::{DRAWN, DYING, EXTERNAL, INTERNAL, STEADY, peak};
use super::runs::{Cases, Model, Runs};
use crate::StudyError;
use crate::control::of_scene;

/// Returns the smallest rotation of a disc from its ideal mesh to the first touch, rad, solved on the curve.
pub fn turn_to_touch(scene: &Scene) -> Result<f64, StudyError> {
    let gear = &scene.gear;
    let geometry = Geometry::new(scene).map_err(|source| of_scene(scene, source))?;
    let centre = Complex::new(gear.eccentricity_m, 0.0);
    let circle = geometry.curve.pitch_radius() + gear.backlash_m;
    let gap = |turn: f64| {
        let back = Complex::unit(-(geometry.ideal_wheel_angle(0, 0.0) + turn));
        let at = |direction: &Complex| (direction.scale(circle) - centre) * back;
        let sleeves = geometry.external_directions.iter().map(at);
        let gaps = sleeves.map(|sleeve| geometry.curve.closest(sleeve).distance);
        gaps.fold(f64::INFINITY, f64::min)
    };
    // The gap falls steadily from d, and the closed form is its tangent: at three times that angle the pin is well inside.
    let [low, high] = bisect([0.0, 3.0 * free_play(gear)], |turn| gap(turn) > 0.0);
    Ok(0.5 * (low + high))
}

pub(super) fn figures(runs: &Runs<'_>) -> Result<Vec<Measured>, StudyError> {
    let exact = runs.backlashes(Model::Ours)?;
    let fine = runs.backlashes(Model::FINE)?;
    let coarse = runs.backlashes(Model::ROUGH)?;
    let growth = |name: &str, cases: &Cases, group: &str, window| {
        let peaks = cases.each(|run| peak(run, group, window));
        number(name, peaks[2] / peaks[0] - 1.0, "")
    };
    let mut twelve = exact.peaks("external_peak", EXTERNAL, STEADY);
    twelve.extend([
        growth("growth", &exact, EXTERNAL, STEADY),
        growth("growth_4000_points", &fine, EXTERNAL, STEADY),
    ]);
    let mut thirteen = exact.peaks("internal_peak", INTERNAL, STEADY);
    thirteen.extend(exact.peaks("internal_peak_start", INTERNAL, DYING));
    thirteen.extend([
        growth("growth_steady", &exact, INTERNAL, STEADY),
        growth("growth_0.06_to_0.15_s", &exact, INTERNAL, DYING),
        growth("growth_steady_4000_points", &fine, INTERNAL, STEADY),
        growth("growth_steady_600_points", &coarse, INTERNAL, STEADY),
    ]);
    let external = vec![
        exact.plot("fig-12a", EXTERNAL, DRAWN),
        fine.plot("fig-12b", EXTERNAL, DRAWN),
    ];
    let internal = vec![
        exact.plot("fig-13a", INTERNAL, DRAWN),
        exact.plot("fig-13b", INTERNAL, (0.0, 0.24)),
    ];
    Ok(vec![
        eleven()?,
        Measured::new("fig-12", twelve, external),
        Measured::new("fig-13", thirteen, internal),
    ])
}

fn eleven() -> Result<Measured, StudyError> {
    let x: Vec<f64> = (1..=12).map(|k| f64::from(k) * 0.05).collect();
    let (mut play, mut closed) = (Vec::new(), Vec::new());
    for d_mm in &x {
        let mut scene = Scene::paper();
        scene.gear.backlash_m = 1e-3 * d_mm;
        play.push(1e3 * turn_to_touch(&scene)?);
        closed.push(1e3 * free_play(&scene.gear));
    }
    let last = x.len() - 1;
    let numbers = vec![
        number("free_play_found_mrad", play[last], "mrad"),
        number("free_play_closed_form_mrad", closed[last], "mrad"),
        number("apart", play[last] / closed[last] - 1.0, ""),
    ];
    let curves = vec![
        Curve::points("first touch on the curve", play),
        Curve::line("closed form", closed),
    ];
    let plot = ("fig-11".to_owned(), x, curves);
    Ok(Measured::new("fig-11", numbers, vec![plot]))
}
