//! Progress in words.

use pinwheel_engines::Progress;

#[test]
fn pieces_are_counted_and_fit() {
    let piece = Progress::new(1, 4, "atlas of steel");
    assert_eq!(piece.sentence(), "2 of 4, atlas of steel");
    let run = |left| Progress {
        simulated_s: Some([0.3, 0.6]),
        left_s: left,
        ..Progress::new(6, 12, "rapier-own-contact-colliders")
    };
    let line = run(Some(12.0)).sentence();
    assert_eq!(line, "7 of 12, rapier-own-contact-colliders, 12 s left");
    // The line follows `stability [========] 00:59:59: `.
    assert!(line.len() + 31 <= 80);
    assert!(run(Some(6100.0)).sentence().ends_with(", 1.7 h left"));
    // The pace of one run among many does not predict the others.
    assert!(run(None).sentence().ends_with("colliders"));
}
