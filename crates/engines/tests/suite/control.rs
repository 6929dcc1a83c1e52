//! Progress in words.

use pinwheel_engines::Progress;

#[test]
fn pieces_are_counted_and_fit() {
    let piece = Progress::new(1, 4, "atlas of steel");
    assert_eq!(piece.sentence(1.0), "2 of 4, atlas of steel");
    let run = |at| Progress {
        simulated_s: Some([at, 0.6]),
        ..Progress::new(6, 12, "rapier-own-contact-colliders")
    };
    let line = run(0.3).sentence(12.0);
    assert_eq!(line, "7 of 12, rapier-own-contact-colliders, 12 s left");
    // The line follows `stability [============] 99m: `.
    assert!(line.len() + 28 <= 80);
    assert!(run(1e-4).sentence(1.0).ends_with(", 1.7 h left"));
    assert!(run(0.0).sentence(1.0).ends_with("colliders"));
}
