//! What a solver says and takes while it runs: orders on stderr, a log that is bounded, files that are not too large.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::process::{End, Piece};

/// What a solver may write and take.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits {
    /// Wall time.
    pub(super) longest: Duration,
    /// Bytes of all files in its folder.
    pub(super) folder_bytes: u64,
    /// Bytes of stdout and stderr together.
    pub(super) log_bytes: u64,
}

/// Bytes of the log that are kept.
const LOG_KEPT: usize = 1 << 18;
/// Longest line that is understood; what is longer is cut.
const LINE: usize = 4096;
/// Notes that are kept, and the longest of them.
const NOTES: usize = 20;
const NOTE: usize = 300;
/// How often sizes are looked at.
const LOOK: Duration = Duration::from_millis(100);
/// Files looked at in a folder, and levels.
const FILES: usize = 10_000;
const LEVELS: usize = 8;

impl Limits {
    /// Which of them a solver passed that began at `begun`; its folder was `looked` at last.
    pub(super) fn passed(
        &self,
        heard: &Heard,
        folder: &Path,
        begun: Instant,
        looked: &mut Instant,
    ) -> Option<End> {
        if begun.elapsed() > self.longest {
            return Some(End::TooLong(format!(
                "it took longer than {} s; give it more by `timeout_s` in its manifest",
                self.longest.as_secs_f64()
            )));
        }
        if heard.bytes > self.log_bytes {
            return Some(End::Stopped(format!(
                "it wrote more than {} MB to stdout and stderr; let it say less",
                self.log_bytes >> 20
            )));
        }
        if looked.elapsed() > LOOK {
            *looked = Instant::now();
            let mut files = FILES;
            if size(folder, self.folder_bytes, LEVELS, &mut files) > self.folder_bytes {
                return Some(End::Stopped(format!(
                    "its files are larger than {} MB, or too many; let it write courses.csv alone",
                    self.folder_bytes >> 20
                )));
            }
        }
        None
    }
}

/// Bytes of the files in a folder, links not followed; more than `most` where there are more files than `files`.
fn size(folder: &Path, most: u64, levels: usize, files: &mut usize) -> u64 {
    let mut sum = 0;
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        if *files == 0 || levels == 0 {
            return most.saturating_add(1);
        }
        *files -= 1;
        let Ok(data) = entry.metadata() else { continue };
        sum += if data.is_dir() {
            size(&entry.path(), most, levels - 1, files)
        } else {
            data.len()
        };
        if sum > most {
            break;
        }
    }
    sum
}

/// What it said.
#[derive(Default)]
pub(super) struct Heard {
    bytes: u64,
    /// The line under way on stderr.
    line: Vec<u8>,
    /// Time it said to have reached, s.
    pub(super) reached_s: Option<f64>,
    pub(super) notes: Vec<String>,
    head: Vec<u8>,
    tail: std::collections::VecDeque<u8>,
    lost: bool,
}

impl Heard {
    pub(super) fn take(&mut self, piece: &Piece) {
        self.bytes += piece.bytes.len() as u64;
        // Orders are understood on stderr alone.
        if !piece.stderr {
            self.keep(&piece.bytes);
            return;
        }
        for &byte in &piece.bytes {
            if byte == b'\n' {
                self.understand();
            } else if self.line.len() < LINE {
                self.line.push(byte);
            }
        }
    }

    fn understand(&mut self) {
        let mut line = std::mem::take(&mut self.line);
        let text = String::from_utf8_lossy(&line);
        let text = text.trim();
        if let Some(time) = text.strip_prefix("@t ") {
            if let Ok(time) = time.trim().parse::<f64>()
                && time.is_finite()
            {
                self.reached_s = Some(time);
            }
        } else if let Some(note) = text.strip_prefix("@note ") {
            if self.notes.len() < NOTES {
                self.notes.push(plain(note, NOTE));
            }
        } else {
            line.push(b'\n');
            self.keep(&line);
        }
    }

    /// The first half of the log and its end.
    fn keep(&mut self, bytes: &[u8]) {
        let room = (LOG_KEPT / 2)
            .saturating_sub(self.head.len())
            .min(bytes.len());
        self.head.extend_from_slice(&bytes[..room]);
        self.tail.extend(&bytes[room..]);
        while self.tail.len() > LOG_KEPT / 2 {
            self.tail.pop_front();
            self.lost = true;
        }
    }

    /// What else it wrote, cut in the middle where it is long.
    pub(super) fn log(&mut self) -> String {
        if !self.line.is_empty() {
            self.understand();
        }
        let (head, tail) = (&self.head, self.tail.make_contiguous());
        let between = if self.lost { "\n[...]\n" } else { "" };
        let joined = [head.as_slice(), between.as_bytes(), tail].concat();
        String::from_utf8_lossy(&joined).into_owned()
    }
}

/// Foreign text for a terminal and a page: one line, no control characters, not too long.
pub(super) fn plain(text: &str, most: usize) -> String {
    let shown = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let cut: String = shown.take(most).collect();
    cut.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a program says without end takes no memory without end.
    #[test]
    fn hard_long_lines_and_logs_are_cut() {
        let mut heard = Heard::default();
        for _ in 0..100 {
            let bytes = vec![b'x'; 1 << 14];
            let stderr = true;
            heard.take(&Piece { bytes, stderr });
            let (bytes, stderr) = (vec![b'y'; 1 << 14], false);
            heard.take(&Piece { bytes, stderr });
        }
        assert_eq!(heard.bytes, 200 << 14);
        assert_eq!(heard.line.len(), LINE);
        assert!(heard.head.len() + heard.tail.len() <= LOG_KEPT);
        assert!(heard.log().contains("[...]"));
    }
}
