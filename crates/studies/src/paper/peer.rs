//! Fig. 10: another engine in Adams' place, and what could make spikes.

use pinwheel_courses::Courses;
use pinwheel_scene::{Detection, Scene};

use super::figure::{Curve, Figure, Plot, number, verdict};
use super::read::{DRAWN, EXTERNAL, INTERNAL, STEADY, all, largest, part, quantile, times};
use super::runs::{Model, Runs};
use crate::StudyError;

/// Courses of an engine that detects and resolves contact itself, on the paper's scene and sample times.
#[derive(Debug, Clone)]
pub struct Peer {
    /// Name, with its version.
    pub name: String,
    /// Computed now, or recorded earlier.
    pub live: bool,
    /// How it differs from the native solver.
    pub differences: String,
    /// Why no nearer relative of Adams was taken, if so.
    pub note: String,
    /// Its courses.
    pub courses: Courses,
    /// Wall time, s, if known.
    pub wall_s: Option<f64>,
}

/// A course's largest value over the level that 1 % of its loaded samples exceed: near 1 for a smooth course,
/// 2 or more with spikes.
fn spikes(values: &[f64]) -> f64 {
    let loaded: Vec<f64> = values.iter().copied().filter(|f| *f > 1.0).collect();
    largest(&loaded) / quantile(&loaded, 0.99).max(f64::MIN_POSITIVE)
}

/// A course at the times `x`; not a number where it has no sample (recordings are thinned).
fn on_grid(courses: &Courses, name: &str, x: &[f64]) -> Vec<f64> {
    let values = courses.channel(name).unwrap_or(&[]);
    let at = |t: &f64| {
        let k = courses.time_s().partition_point(|s| *s < t - 1e-9);
        let here = courses
            .time_s()
            .get(k)
            .is_some_and(|s| (s - t).abs() < 1e-8);
        values.get(k).copied().filter(|_| here).unwrap_or(f64::NAN)
    };
    x.iter().map(at).collect()
}

/// A change to a scene, with its name.
type Suspect = (&'static str, fn(&mut Scene));

/// What might make Adams' spikes, each switched on in our own solver.
fn suspects() -> [Suspect; 5] {
    fn impact(scene: &mut Scene) {
        "adams-impact".clone_into(&mut scene.contact.law);
    }
    fn facets(scene: &mut Scene, count: usize) {
        scene.contact.detection = Detection::Points;
        (scene.contact.wheel_points, scene.contact.hole_points) = (count, 20);
    }
    [
        ("one stiffness for all contacts, Adams' IMPACT", impact),
        ("the same with 40 times the stiffness", |s| {
            impact(s);
            s.contact.constant_stiffness_n_m15 *= 40.0;
        }),
        ("a faceted wheel, 600 vertices", |s| facets(s, 600)),
        ("a faceted wheel, 300 vertices", |s| facets(s, 300)),
        (
            "a faceted wheel, 300 vertices, IMPACT of 40 times the stiffness",
            |s| {
                impact(s);
                s.contact.constant_stiffness_n_m15 *= 40.0;
                facets(s, 300);
            },
        ),
    ]
}

pub(super) fn figure(runs: &Runs<'_>, peer: Option<&Peer>) -> Result<Figure, StudyError> {
    let ours = runs.get(Model::Ours, |_| {})?;
    let published = runs.get(Model::Points(4000), |_| {})?;
    let peaks = |courses: &Courses| [EXTERNAL, INTERNAL].map(|g| largest(&all(courses, g, STEADY)));
    let spiky = |courses: &Courses| [EXTERNAL, INTERNAL].map(|g| spikes(&all(courses, g, STEADY)));
    let own = peaks(&ours.courses);
    let mut numbers = vec![
        number("external_peak_ours", own[0], "N"),
        number("internal_peak_ours", own[1], "N"),
    ];
    let mut words = Vec::new();
    for (name, change) in suspects() {
        let seen = runs.get(Model::Ours, |s| {
            change(s);
            s.solver.step_s = 5e-6; // for the stiffest of them
        });
        match seen {
            Ok(run) => {
                let [e, i] = peaks(&run.courses);
                let [se, si] = spiky(&run.courses);
                numbers.push(number(format!("external_peak, {name}"), e, "N"));
                numbers.push(number(format!("internal_peak, {name}"), i, "N"));
                words.push(format!(
                    "{name}: {e:.0} and {i:.0} N (spikes {se:.2}, {si:.2})"
                ));
            }
            Err(StudyError::Reference { reason, .. }) => words.push(format!("{name}: {reason}")),
            Err(other) => return Err(other),
        }
    }
    let mut found = format!(
        "Ours: at most {:.1} N external and {:.1} N internal. ",
        own[0], own[1]
    );
    let mut shown = false;
    let mut why = String::new();
    if let Some(peer) = peer {
        let other = peaks(&peer.courses);
        let [se, si] = spiky(&peer.courses);
        shown = se > 1.5 || si > 1.5;
        numbers.push(number("external_peak_other", other[0], "N"));
        numbers.push(number("internal_peak_other", other[1], "N"));
        numbers.push(number("external_spikes_other", se, ""));
        numbers.push(number("internal_spikes_other", si, ""));
        found.push_str(&format!(
            "{} ({}) in Adams' place: {:.1} N and {:.1} N; its largest values are {se:.2} and {si:.2} times what 1 % of the samples exceed, so {}. ",
            peer.name,
            if peer.live { "computed now" } else { "recorded" },
            other[0],
            other[1],
            if shown { "it has spikes" } else { "it has none" }
        ));
        why.push_str(&format!("{} {} ", peer.differences, peer.note));
    }
    found.push_str(&format!(
        "Tried in our own solver, external and internal peaks: {}.",
        words.join("; ")
    ));
    why.push_str(
        "A smooth wheel has no spikes under either law, nor has a faceted one as soft as this (its corners are impacts, but soft ones). A faceted wheel \
         with a stiffer contact has: each corner is then an impact of the size of Adams' peaks. They are what a tessellated surface makes of a \
         contact, not the gearbox.",
    );
    let plot = |key: &str, title: &str, name: &str| {
        let mut curves = vec![
            Curve::line("ours, exact profile", part(&ours.courses, name, DRAWN)),
            Curve::line("ours, 4000 points", part(&published.courses, name, DRAWN)),
        ];
        if let Some(peer) = peer {
            let x = times(&ours.courses, DRAWN);
            curves.push(Curve::line(
                peer.name.clone(),
                on_grid(&peer.courses, name, &x),
            ));
        }
        Plot {
            key: key.into(),
            title: title.into(),
            x_label: "Time (s)".into(),
            y_label: "Force (N)".into(),
            y_log: false,
            x: times(&ours.courses, DRAWN),
            curves,
            note: String::new(),
        }
    };
    let close = |k: usize| {
        numbers
            .iter()
            .find(|n| n.name == ["external_peak_other", "internal_peak_other"][k])
            .map_or(f64::NAN, |n| n.value / own[k])
    };
    let similar = (0..2).all(|k| (0.6..1.6).contains(&close(k)));
    Ok(Figure {
        id: "fig-10".into(),
        name: "Fig. 10".into(),
        title: "Another engine in Adams' place".into(),
        says: "Both programs give similar forces, below 200 N in the Fortran model; Adams has peaks of 500 N at external and 400 N at internal sleeves.".into(),
        found,
        why,
        numbers,
        verdict: verdict(similar && shown, similar || shown),
        plots: vec![
            plot("fig-10a", "Force on internal sleeve 0", &format!("{INTERNAL}_0")),
            plot("fig-10b", "Force on external sleeve 0", &format!("{EXTERNAL}_0")),
        ],
    })
}
