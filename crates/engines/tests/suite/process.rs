//! Monitored programs.

use std::process::Command;
use std::thread;
use std::time::Duration;

use pinwheel_engines::process::{End, Piece, run};

/// A program that floods an unread pipe has to wait, and its buffer stays small.
#[test]
fn hard_what_is_not_heard_yet_is_bounded() {
    let (mut bytes, mut ends) = (0, false);
    let mut listener = |piece: Option<&Piece>| {
        if let Some(piece) = piece {
            bytes += piece.bytes.len();
            thread::sleep(Duration::from_millis(if ends { 0 } else { 500 }));
            ends = true;
        }
        ends.then(|| End::Stopped(String::new()))
    };
    let flood = ["-c", "exec cat /dev/zero >&2"];
    run(Command::new("sh").args(flood), None, &mut listener).unwrap();
    assert!(bytes < 64 << 20, "{bytes} bytes");
}
