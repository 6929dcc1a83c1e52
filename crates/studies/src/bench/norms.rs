//! How far a run lies from the reference, window by window.
//!
//! ```text
//! L2   = sqrt(sum (a - b)^2 / sum b^2)      over all sleeves and all samples of the window
//! Linf = max |a - b| / max |b|
//! ```
//! Where b is next to nothing, [`Least`] stands in for it.

use pinwheel_compare::windows::{SETTLING_S, windows};
use pinwheel_courses::{Courses, columns};
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::load_course;
use pinwheel_scene::{Scene, Start};
use serde::Serialize;

/// A part of the run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Span {
    /// `whole`, `transient` or `steady`.
    pub name: String,
    /// Start, s, included.
    pub from_s: f64,
    /// End, s, included.
    pub to_s: f64,
}

/// Relative errors in one window; dimensionless.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// L2, all sleeve forces together.
    pub force_l2: f64,
    /// Linf, all sleeve forces together.
    pub force_max: f64,
    /// L2, driver torque.
    pub torque_l2: f64,
    /// Linf, driver torque.
    pub torque_max: f64,
}

impl Errors {
    /// The larger of each.
    #[must_use]
    pub fn or_worse(self, other: Self) -> Self {
        Self {
            force_l2: self.force_l2.max(other.force_l2),
            force_max: self.force_max.max(other.force_max),
            torque_l2: self.torque_l2.max(other.torque_l2),
            torque_max: self.torque_max.max(other.torque_max),
        }
    }
}

/// The whole run first, then its transient and its steady part, where it is long enough to have them.
pub(super) fn spans(scene: &Scene, courses: &Courses) -> Vec<Span> {
    let settling = if scene.drive.start == Start::Equilibrium {
        0.0
    } else {
        SETTLING_S
    };
    let end = courses.time_s().last().copied().unwrap_or(0.0);
    let mut spans = vec![Span {
        name: "whole".to_owned(),
        from_s: 0.0,
        to_s: end,
    }];
    let (mut parts, _) = windows(courses, settling, &load_course::breaks(&scene.drive));
    parts.retain(|window| window.to_s - window.from_s < end);
    parts.sort_by(|a, b| a.from_s.total_cmp(&b.from_s));
    spans.extend(parts.into_iter().map(|window| Span {
        name: window.kind.word().to_owned(),
        from_s: window.from_s,
        to_s: window.to_s,
    }));
    spans
}

/// Loads that a gear does not notice; errors are shares of no less.
#[derive(Debug, Clone, Copy)]
pub(super) struct Least {
    pub(super) force_n: f64,
    pub(super) torque_n_m: f64,
}

impl Least {
    pub(super) fn of(gearbox: &Gearbox) -> Self {
        let force_n = gearbox.least_force_n();
        Self {
            force_n,
            torque_n_m: force_n * gearbox.scene.gear.eccentricity_m,
        }
    }
}

/// Errors of `a` against `b` in a window. Both hold the same samples.
pub(super) fn errors(a: &Courses, b: &Courses, span: &Span, least: Least) -> Errors {
    let (mut force, mut torque) = (Sums::default(), Sums::default());
    let range = b.window(span.from_s, span.to_s);
    for prefix in [columns::EXTERNAL_FORCE, columns::INTERNAL_FORCE] {
        for (x, y) in a.group(prefix).iter().zip(b.group(prefix)) {
            force.add(&x[range.clone()], &y[range.clone()]);
        }
    }
    let name = columns::INPUT_TORQUE;
    if let (Some(x), Some(y)) = (a.channel(name), b.channel(name)) {
        torque.add(&x[range.clone()], &y[range]);
    }
    Errors {
        force_l2: force.l2(least.force_n),
        force_max: force.most / force.largest.max(least.force_n),
        torque_l2: torque.l2(least.torque_n_m),
        torque_max: torque.most / torque.largest.max(least.torque_n_m),
    }
}

#[derive(Default)]
struct Sums {
    samples: usize,
    square: f64,
    size: f64,
    most: f64,
    largest: f64,
}

impl Sums {
    /// `least` in one of the channels at every sample.
    fn l2(&self, least: f64) -> f64 {
        (self.square / self.size.max(least * least * self.samples as f64)).sqrt()
    }

    fn add(&mut self, a: &[f64], b: &[f64]) {
        self.samples = a.len();
        for (a, b) in a.iter().zip(b) {
            let difference = (a - b).abs();
            self.square += difference * difference;
            self.size += b * b;
            self.most = self.most.max(difference);
            self.largest = self.largest.max(b.abs());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn courses(force: [f64; 3]) -> Courses {
        let mut courses = Courses::new(vec![0.0, 1.0, 2.0]).unwrap();
        courses
            .push("external_sleeve_force_n_0", force.to_vec())
            .unwrap();
        courses
            .push("internal_sleeve_force_n_0", vec![0.0; 3])
            .unwrap();
        courses.push("input_torque_n_m", vec![1.0; 3]).unwrap();
        courses
    }

    #[test]
    fn norms_by_hand() {
        let span = |from_s, to_s| Span {
            name: String::new(),
            from_s,
            to_s,
        };
        let (a, b) = (courses([3.0, 4.0, 1.0]), courses([3.0, 4.0, 0.0]));
        let least = Least {
            force_n: 0.5,
            torque_n_m: 1e-3,
        };
        let errors = |a: &Courses, b: &Courses, span: &Span| errors(a, b, span, least);
        let whole = errors(&a, &b, &span(0.0, 2.0));
        assert_eq!((whole.force_l2, whole.force_max), (0.2, 0.25));
        assert_eq!((whole.torque_l2, whole.torque_max), (0.0, 0.0));
        let early = errors(&a, &b, &span(0.0, 1.0));
        assert_eq!((early.force_l2, early.force_max), (0.0, 0.0));
        let late = errors(&a, &b, &span(2.0, 2.0));
        assert_eq!(
            (late.force_l2, late.force_max),
            (2.0, 2.0),
            "of the least force"
        );
    }
}
