//! Figs. 5, 6, 17 and 18: one contact of a wheel with an external sleeve, without and with backlash.

use std::ops::Range;
use std::rc::Rc;

use pinwheel_courses::Courses;

use super::backlash::{BACKLASHES, words};
use super::figure::{Curve, Figure, Number, Plot, number, verdict};
use super::read::{STEADY, largest, range, roughness};
use super::runs::{Model, Run, Runs};
use crate::StudyError;

/// Distance of samples, s: sixteen in a swing of a wheel on its contacts (1.2 kHz).
const SAMPLE: f64 = 5e-5;
/// Where the paper's contact begins, s (it speaks of 0.24 to 0.246 s).
const BEGINS: f64 = 0.24;
/// The beginning of a contact, s: as long as the paper's.
const ONSET: f64 = 0.006;
/// Samples to both sides of the running mean: 0.5 ms.
const HALF: usize = 10;

const PENETRATION: &str = "wheel_0_external_penetration_m";
const STIFFNESS: &str = "wheel_0_external_stiffness_n_m15";
const NORMAL: &str = "wheel_0_external_normal_velocity_m_s";
const TANGENTIAL: &str = "wheel_0_external_tangential_velocity_m_s";

/// One contact: the sleeve and the samples in which it touches.
#[derive(Debug, Clone)]
struct Contact {
    sleeve: usize,
    samples: Range<usize>,
}

/// Wheel 0 and all external sleeves.
fn run(runs: &Runs<'_>, model: Model, backlash: f64) -> Result<Rc<Run>, StudyError> {
    runs.get(model, |s| {
        s.gear.backlash_m = backlash;
        s.solver.sample_s = SAMPLE;
        s.output.channels = [PENETRATION, STIFFNESS, NORMAL, TANGENTIAL]
            .map(|name| format!("{name}_*"))
            .to_vec();
    })
}

fn course<'a>(courses: &'a Courses, name: &str, contact: &Contact) -> &'a [f64] {
    courses
        .channel(&format!("{name}_{}", contact.sleeve))
        .and_then(|values| values.get(contact.samples.clone()))
        .unwrap_or(&[])
}

/// All contacts of wheel 0 that begin after `from` and have ended in the run. Gaps of a few samples, a sleeve
/// bouncing at its start, do not end a contact.
fn contacts(courses: &Courses, from: f64) -> Vec<Contact> {
    let start = courses.time_s().partition_point(|t| *t < from);
    let bridged = 40; // 2 ms
    let mut found = Vec::new();
    for (sleeve, depth) in courses.group(PENETRATION).into_iter().enumerate() {
        let mut open: Option<Range<usize>> = None;
        for (k, delta) in depth.iter().enumerate() {
            if *delta > 0.0 {
                match &mut open {
                    Some(samples) => samples.end = k + 1,
                    None => open = Some(k..k + 1),
                }
            } else if let Some(samples) = &open
                && k > samples.end + bridged
            {
                if samples.start > start {
                    found.push(Contact {
                        sleeve,
                        samples: samples.clone(),
                    });
                }
                open = None;
            }
        }
    }
    found.sort_by_key(|contact| contact.samples.start);
    found
}

/// The longest of the contacts that begin nearest to the paper's: touches of a sample or two are left out.
fn nearest(courses: &Courses, sleeve: Option<usize>) -> Option<Contact> {
    let all = contacts(courses, 0.12);
    let longest = all.iter().map(|c| c.samples.len()).max()?;
    let begins = |c: &Contact| courses.time_s()[c.samples.start];
    all.into_iter()
        .filter(|c| 2 * c.samples.len() > longest && sleeve.is_none_or(|s| s == c.sleeve))
        .min_by(|a, b| {
            (begins(a) - BEGINS)
                .abs()
                .total_cmp(&(begins(b) - BEGINS).abs())
        })
}

/// Mean duration of the steady contacts, s.
fn duration(courses: &Courses) -> f64 {
    let all = contacts(courses, STEADY.0 - 0.1);
    let longest = all.iter().map(|c| c.samples.len()).max().unwrap_or(0);
    let whole: Vec<f64> = all
        .iter()
        .map(|c| c.samples.len())
        .filter(|n| 2 * n > longest)
        .map(|n| n as f64 * SAMPLE)
        .collect();
    super::read::mean(&whole)
}

/// Swing of the normal velocity (largest less smallest of it less its running mean) at the beginning of a contact and later.
fn swings(normal: &[f64]) -> [f64; 2] {
    let first = ((ONSET / SAMPLE) as usize).min(normal.len());
    let (onset, later) = normal.split_at(first);
    [onset, later].map(|part| roughness(part, HALF))
}

fn missing() -> StudyError {
    StudyError::Reference {
        scene: "paper".to_owned(),
        reason: "has no contact of wheel 0 with an external sleeve near 0.24 s".to_owned(),
    }
}

fn plot(
    key: &str,
    title: String,
    y_label: &str,
    x: Vec<f64>,
    curves: Vec<Curve>,
    note: &str,
) -> Plot {
    Plot {
        key: key.into(),
        title,
        x_label: "Time (s)".into(),
        y_label: y_label.into(),
        y_log: false,
        x,
        curves,
        note: note.into(),
    }
}

/// A course on the samples of `shown`, not a number where the contact is not.
fn spread(values: &[f64], samples: &Range<usize>, shown: &Range<usize>) -> Vec<f64> {
    shown
        .clone()
        .map(|k| {
            if samples.contains(&k) {
                values.get(k - samples.start).copied().unwrap_or(f64::NAN)
            } else {
                f64::NAN
            }
        })
        .collect()
}

pub(super) fn one_contact(runs: &Runs<'_>) -> Result<Vec<Figure>, StudyError> {
    let models = [Model::Ours, Model::Points(4000), Model::Points(600)];
    let exact = run(runs, Model::Ours, 0.0)?;
    let sleeve = nearest(&exact.courses, None).ok_or_else(missing)?.sleeve;
    let mut found = Vec::new();
    for model in models {
        let run = run(runs, model, 0.0)?;
        let contact = nearest(&run.courses, Some(sleeve)).ok_or_else(missing)?;
        found.push((model, run, contact));
    }
    let shown = found.iter().map(|f| f.2.samples.start).min().unwrap_or(0)
        ..found.iter().map(|f| f.2.samples.end).max().unwrap_or(0);
    let x = exact.courses.time_s()[shown.clone()].to_vec();
    let curves = |name: &str| -> Vec<Curve> {
        let of = |(model, run, contact): &(Model, Rc<Run>, Contact)| {
            Curve::line(
                model.words(),
                spread(
                    course(&run.courses, name, contact),
                    &contact.samples,
                    &shown,
                ),
            )
        };
        found.iter().map(of).collect()
    };
    let values = |k: usize, name: &str| course(&found[k].1.courses, name, &found[k].2);
    let stiffness = values(0, STIFFNESS);
    let (low, high) = (
        stiffness.iter().copied().fold(f64::INFINITY, f64::min),
        largest(stiffness),
    );
    let rough: Vec<f64> = (0..3)
        .map(|k| roughness(values(k, STIFFNESS), HALF) / (high - low))
        .collect();
    let swing: Vec<[f64; 2]> = (0..3).map(|k| swings(values(k, NORMAL))).collect();
    let begins = exact.courses.time_s()[found[0].2.samples.start];
    let ends = exact.courses.time_s()[found[0].2.samples.end];
    let titled = |what: &str| format!("{what}, wheel 0 with external sleeve {sleeve}");
    let mm = |v: f64| 1e3 * v;
    let tangential = values(0, TANGENTIAL);
    Ok(vec![
        Figure {
            id: "fig-05".into(),
            name: "Fig. 5".into(),
            title: "Contact stiffness while a wheel touches an external sleeve".into(),
            says: "The stiffness changes along the contact; it oscillates at the beginning and where the curvature changes fast (0.265 to 0.28 s), \
                   which the discretisation adds to."
                .into(),
            found: format!(
                "The contact nearest to the paper's lasts from {begins:.4} to {ends:.4} s; its stiffness runs from {low:.3e} to {high:.3e} N/m^1.5, {:.2} times. \
                 It oscillates by {:.2} % of that range (RMS) with the exact profile, {:.2} % with 4000 and {:.2} % with 600 points.",
                high / low,
                100.0 * rough[0],
                100.0 * rough[1],
                100.0 * rough[2]
            ),
            why: "K follows the curvature at the contact point, which the exact profile gives without a step; the circle through three \
                  neighbouring points changes at every point. The oscillation of the published curve is the discretisation's."
                .into(),
            numbers: vec![
                number("begins", begins, "s"),
                number("ends", ends, "s"),
                number("stiffness_smallest", low, "N/m^1.5"),
                number("stiffness_largest", high, "N/m^1.5"),
                number("oscillation_exact", rough[0], ""),
                number("oscillation_4000_points", rough[1], ""),
                number("oscillation_600_points", rough[2], ""),
            ],
            // Varies, and oscillates by more than a hundredth of its range: always, or only with points.
            verdict: verdict(high / low > 1.1 && rough[0] > 0.01, high / low > 1.1 && rough[2] > 2.0 * rough[0]),
            plots: vec![plot("fig-05", titled("Contact stiffness"), "Contact stiffness (N/m^1.5)", x.clone(), curves(STIFFNESS), "")],
        },
        Figure {
            id: "fig-06".into(),
            name: "Fig. 6".into(),
            title: "Relative velocity of the contact points".into(),
            says: "The relative velocity changes along the contact and fluctuates in its first 6 ms (0.24 to 0.246 s).".into(),
            found: format!(
                "In the first 6 ms the normal velocity oscillates by {:.3} mm/s RMS, later by {:.3} mm/s; with 4000 points by {:.3} and {:.3} mm/s, with 600 by {:.2} and {:.2} mm/s. \
                 The tangential velocity runs over {:.0} mm/s.",
                mm(swing[0][0]),
                mm(swing[0][1]),
                mm(swing[1][0]),
                mm(swing[1][1]),
                mm(swing[2][0]),
                mm(swing[2][1]),
                mm(range(tangential))
            ),
            why: "The exact profile enters the contact smoothly. Points make the velocity jump at every vertex, in the first 6 ms as all along the contact, \
                  most where the curvature changes fast.".into(),
            numbers: swing
                .iter()
                .zip(["exact", "4000_points", "600_points"])
                .flat_map(|(s, name)| {
                    [number(format!("onset_{name}"), mm(s[0]), "mm/s"), number(format!("later_{name}"), mm(s[1]), "mm/s")]
                })
                .collect(),
            verdict: verdict(swing[0][0] > 2.0 * swing[0][1], swing[1][0] > 5.0 * swing[0][0]),
            plots: vec![
                plot("fig-06a", titled("Normal velocity"), "Normal velocity (m/s)", x.clone(), curves(NORMAL), "Positive while the penetration grows."),
                plot("fig-06b", titled("Tangential velocity"), "Tangential velocity (m/s)", x, curves(TANGENTIAL), ""),
            ],
        },
    ])
}

pub(super) fn with_backlash(runs: &Runs<'_>) -> Result<Vec<Figure>, StudyError> {
    let mut found = Vec::new();
    let mut sleeve = None;
    for backlash in BACKLASHES {
        let run = run(runs, Model::Ours, backlash)?;
        let contact = nearest(&run.courses, sleeve).ok_or_else(missing)?;
        sleeve = Some(contact.sleeve);
        found.push((backlash, run, contact));
    }
    let shown = found.iter().map(|f| f.2.samples.start).min().unwrap_or(0)
        ..found.iter().map(|f| f.2.samples.end).max().unwrap_or(0);
    let x = found[0].1.courses.time_s()[shown.clone()].to_vec();
    let curves = |name: &str| -> Vec<Curve> {
        let of = |(backlash, run, contact): &(f64, Rc<Run>, Contact)| {
            Curve::line(
                words(*backlash),
                spread(
                    course(&run.courses, name, contact),
                    &contact.samples,
                    &shown,
                ),
            )
        };
        found.iter().map(of).collect()
    };
    let begins: Vec<f64> = found
        .iter()
        .map(|f| f.1.courses.time_s()[f.2.samples.start])
        .collect();
    let lasts: Vec<f64> = found.iter().map(|f| duration(&f.1.courses)).collect();
    // Largest approach in the steady contacts' first half millisecond.
    let onset = |courses: &Courses| {
        let first = 10;
        let speeds = contacts(courses, STEADY.0)
            .into_iter()
            .filter(|c| c.samples.len() > 200)
            .map(|c| {
                let all = course(courses, NORMAL, &c);
                largest(&all[..first.min(all.len())])
            });
        largest(&speeds.collect::<Vec<_>>())
    };
    let speed: Vec<f64> = found.iter().map(|f| onset(&f.1.courses)).collect();
    let overlap = |name: &str| {
        // Where all touch, how far the largest backlash's course lies from the one without.
        let (a, b) = (&found[0], &found[found.len() - 1]);
        let both = a.2.samples.start.max(b.2.samples.start)..a.2.samples.end.min(b.2.samples.end);
        let get = |f: &(f64, Rc<Run>, Contact)| {
            spread(course(&f.1.courses, name, &f.2), &f.2.samples, &both)
        };
        let (a, b) = (get(a), get(b));
        let apart: Vec<f64> = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).collect();
        super::read::mean(&apart) / range(&a).max(f64::MIN_POSITIVE)
    };
    let shift = 1e3 * (begins[2] - begins[0]);
    let numbers = |what: &str, values: &[f64], scale: f64, unit: &str| -> Vec<Number> {
        let of = |(v, name): (&f64, &str)| number(format!("{what}_{name}"), scale * v, unit);
        values
            .iter()
            .zip(["0", "0.3_mm", "0.6_mm"])
            .map(of)
            .collect()
    };
    let number_of_sleeve = sleeve.unwrap_or(0);
    let titled = |what: &str| format!("{what}, wheel 0 with external sleeve {number_of_sleeve}");
    let (stiff, slide) = (overlap(STIFFNESS), overlap(TANGENTIAL));
    Ok(vec![
        Figure {
            id: "fig-17".into(),
            name: "Fig. 17".into(),
            title: "Contact stiffness for several backlashes".into(),
            says: "With backlash the courses of the stiffness are shifted in time, by the shorter contact between sleeve and wheel.".into(),
            found: format!(
                "With 0.6 mm the contact begins {shift:.1} ms later; contacts last {:.1}, {:.1}, {:.1} ms at d = 0, 0.3, 0.6 mm. Where both touch, the stiffness \
                 lies {:.0} % of its range from the one without backlash.",
                1e3 * lasts[0],
                1e3 * lasts[1],
                1e3 * lasts[2],
                100.0 * stiff
            ),
            why: "Of the sleeves on the loaded side only those nearest to the largest lever still touch, where the profile's curvature is what it was.".into(),
            numbers: [numbers("contact_lasts", &lasts, 1e3, "ms"), vec![number("shift_0.6_mm", shift, "ms"), number("stiffness_apart", stiff, "")]].concat(),
            verdict: verdict(lasts.windows(2).all(|w| w[1] < w[0]) && shift > 0.5, lasts[2] < lasts[0]),
            plots: vec![plot("fig-17", titled("Contact stiffness"), "Contact stiffness (N/m^1.5)", x.clone(), curves(STIFFNESS), "")],
        },
        Figure {
            id: "fig-18".into(),
            name: "Fig. 18".into(),
            title: "Relative velocity of the contact points for several backlashes".into(),
            says: "Every course starts with oscillations; courses overlap where both touch; with high backlash the contact starts with a higher velocity.".into(),
            found: format!(
                "From 0.3 s on contacts begin at up to {:.2}, {:.2}, {:.2} mm/s (normal) at d = 0, 0.3, 0.6 mm. Where both touch, the tangential velocity lies {:.1} % of its range \
                 from the one without backlash.",
                1e3 * speed[0],
                1e3 * speed[1],
                1e3 * speed[2],
                100.0 * slide
            ),
            why: "At first touch the profile moves towards the sleeve at a speed that the free play sets; what follows is the wheel on its contact springs.".into(),
            numbers: [numbers("begins_at", &speed, 1e3, "mm/s"), vec![number("tangential_apart", slide, "")]].concat(),
            verdict: verdict(speed[2] > 1.2 * speed[0] && slide < 0.2, speed[2] > 1.2 * speed[0]),
            plots: vec![
                plot("fig-18a", titled("Normal velocity"), "Normal velocity (m/s)", x.clone(), curves(NORMAL), ""),
                plot("fig-18b", titled("Tangential velocity"), "Tangential velocity (m/s)", x, curves(TANGENTIAL), ""),
            ],
        },
    ])
}
