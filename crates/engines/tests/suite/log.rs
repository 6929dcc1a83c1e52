//! Output of solvers.

use pinwheel_engines::external::log::*;
use pinwheel_engines::process::Piece;

/// Endless output on one line takes limited memory.
#[test]
fn hard_long_lines_are_cut() {
    let mut heard = SolverLog::default();
    for _ in 0..100 {
        let bytes = vec![b'x'; 1 << 14];
        let stderr = true;
        heard.take(&Piece { bytes, stderr });
        let (bytes, stderr) = (vec![b'y'; 1 << 14], false);
        heard.take(&Piece { bytes, stderr });
    }
    assert_eq!(heard.bytes, 200 << 14);
    assert!(heard.lines.iter().all(|line| line.len() == LINE));
    let last = heard.last().expect("it logged lines");
    assert_eq!(last, "x".repeat(WORDS));
}
