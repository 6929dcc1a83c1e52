//! Pace at which a run is refused.

use pinwheel_gearbox::internals::{Pace, SPAN};
use pinwheel_scene::Scene;

#[test]
fn only_a_pace_without_end_is_refused() {
    let mut scene = Scene::paper();
    scene.solver.integrator = "dopri5".to_owned();
    let mut pace = Pace::new(&scene, false);
    assert_eq!(pace.look(1e-12, SPAN - 1), Ok(()), "too early to tell");
    assert_eq!(pace.look(0.01, SPAN), Ok(()));
    // A short interval of tiny steps at a switch is over before a check.
    assert_eq!(pace.look(0.02, 2 * SPAN), Ok(()));
    let message = pace.look(0.02 + 1e-6, 3 * SPAN).unwrap_err();
    assert!(
        message.contains("5.0e-11 s") && message.contains("make solver.duration_s 0.021 or less"),
        "{message}"
    );
    // The remedy for friction is an implicit method, unless the method is implicit.
    for (integrator, remedy) in [("dopri5", "\"imex2\""), ("imex2-adaptive", "duration_s")] {
        scene.solver.integrator = integrator.to_owned();
        let message = Pace::new(&scene, true).look(1e-9, SPAN).unwrap_err();
        assert!(message.contains(remedy), "{message}");
    }
}
