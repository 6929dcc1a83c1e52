//! Runs whose ladders do not settle: chaos, floors of iterations, bounces that coarser runs miss.

use crate::common::courses;
use crate::{FORCE, anywhere, compared, engine, entry, native, off};
use pinwheel_compare::uncertainty::{Basis, Source};
use pinwheel_compare::{Context, Divergence, Track, Verdict};
use pinwheel_courses::Courses;

/// A scene that amplifies roundings decides by itself how sharp its figures are: stated and no failure, and no pass.
#[test]
fn hard_chaos_is_stated() {
    let chaotic = Context {
        divergence: Some(Divergence {
            horizon_s: Some(0.0),
            largest_share: 1.0,
            told: String::new(),
        }),
        ..anywhere()
    };
    let peer = || {
        engine(
            "native-lagrange",
            Track::Native,
            &courses(1.0),
            0.3,
            2.0,
            &[2.0, 4.0],
        )
    };
    let found = compared(&chaotic, vec![native(0.3), peer()]);
    assert!(
        found.counts.stated > 0 && found.counts.not_resolved == 0,
        "{:?}",
        found.counts
    );
    assert_eq!(found.outcome.exit_status(), 0);
    // The same before the horizon is a failure.
    let found = compared(&anywhere(), vec![native(0.3), peer()]);
    assert!(
        found.counts.stated == 0 && found.counts.not_resolved > 0,
        "{:?}",
        found.counts
    );
}

/// What an engine's own iterations leave no step takes off: it bounds how sharp a statement may be.
#[test]
fn regress_iterations_leave_a_floor() {
    let offset = |floor: f64| {
        let base = off(&courses(1.0), 1e-9);
        let steps = [2.0, 4.0];
        let (peer, evidence) = engine("implicit", Track::Native, &base, 1e-12, 2.0, &steps);
        compared(
            &anywhere(),
            vec![native(1e-12), (peer, evidence.with_floor(floor))],
        )
    };
    assert!(matches!(
        entry(&offset(0.0), FORCE).verdict,
        Verdict::Differ { .. }
    ));
    assert!(matches!(
        entry(&offset(1e-8), FORCE).verdict,
        Verdict::Agree { .. }
    ));
}

/// A bounce that one run of the ladder has and another has not. Two rungs that both miss it cannot know.
#[test]
fn hard_a_bounce_that_coarser_runs_miss() {
    let bounce = |base: Courses| {
        let mut courses = Courses::new(base.time_s().to_vec()).unwrap();
        for channel in base.channels() {
            let mut values = channel.values.clone();
            if channel.name.starts_with(FORCE) {
                values[450] = 0.0;
                values[451] = 300.0;
            }
            courses.push(channel.name.clone(), values).unwrap();
        }
        courses
    };
    let exact = engine(
        "exact",
        Track::Native,
        &bounce(courses(1.0)),
        1e-6,
        2.0,
        &[2.0, 4.0],
    );
    let (mut seeing, mut ladder) = native(1e-6);
    seeing.courses = bounce(seeing.courses);
    let found = compared(
        &anywhere(),
        vec![exact.clone(), (seeing.clone(), ladder.clone())],
    );
    assert!(
        matches!(&entry(&found, FORCE).verdict, Verdict::NotResolved { participant, .. } if participant == "native"),
        "only the finest has it"
    );
    if let Source::Ladder(ladder) = &mut ladder.source {
        let fine = ladder.coarser[0].run.clone().unwrap();
        ladder.coarser[0].run = Ok(bounce(fine));
    }
    let found = compared(&anywhere(), vec![exact, (seeing, ladder)]);
    // The coarsest misses it: super-convergence by accident, which costs sharpness and no more.
    let estimate = *found.engines[1]
        .uncertainty
        .iter()
        .find(|u| u.quantity == FORCE)
        .unwrap()
        .l2
        .estimate()
        .unwrap();
    assert_eq!(estimate.basis, Basis::Unconfirmed);
    assert!(!matches!(
        entry(&found, FORCE).verdict,
        Verdict::Differ { .. }
    ));
}
