//! Trials of a solver that joins.

use pinwheel_scene::{Override, Scene};
use pinwheel_studies::internals::TRIALS;

#[test]
fn the_trials_can_be_read() {
    let judged = TRIALS.iter().filter(|trial| trial.what.is_empty());
    assert_eq!((judged.count(), TRIALS.len()), (6, 11));
    for held in TRIALS.iter().flat_map(|trial| &trial.scenes) {
        let keys = held.set.iter().map(|key| key.parse().unwrap());
        Scene::load("paper", &keys.collect::<Vec<Override>>()).unwrap();
    }
}
