//! Free play on the curve itself.

use pinwheel_scene::Scene;
use pinwheel_studies::internals::turn_to_touch;

/// The geometry gives d psi/d d = 17.003 rad/m; curvature makes the computed play deviate slightly for large d.
#[test]
fn free_play_is_computed_on_the_curve() {
    let mut scene = Scene::paper();
    scene.gear.backlash_m = 1e-5;
    let turn = turn_to_touch(&scene).unwrap();
    assert!((turn / 1e-5 - 17.003).abs() < 0.02, "{}", turn / 1e-5);
}
