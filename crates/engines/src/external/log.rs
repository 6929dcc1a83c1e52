//! Output and resources of a running solver: commands on stderr, final message, limits on files.

use std::path::Path;
use std::time::{Duration, Instant};

use crate::process::{End, Piece};

/// Limits of a solver's output and time.
#[derive(Debug, Clone, Copy)]
pub struct Limits {
    /// Longest wall time.
    pub longest: Duration,
    /// Largest total size of files in its folder, bytes.
    pub folder_bytes: u64,
    /// Largest total size of stdout and stderr, bytes.
    pub log_bytes: u64,
}

/// Longest line, bytes; longer ones are cut.
pub const LINE: usize = 4096;
/// Largest number of stored notes.
const NOTES: usize = 20;
/// Longest foreign text in a message.
pub const WORDS: usize = 300;
/// Interval between checks of sizes.
const LOOK: Duration = Duration::from_millis(100);
/// Largest number of files to check in a folder, and of levels of subfolders.
const FILES: usize = 10_000;
const LEVELS: usize = 8;

impl Limits {
    /// Returns the limit that a solver exceeded, `None` within all limits. The solver began at `begun`; `looked` is the time of
    /// the last check of its folder.
    pub fn passed(
        &self,
        log: &SolverLog,
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
        if log.bytes > self.log_bytes {
            return Some(End::Stopped(format!(
                "it wrote more than {} MB to stdout and stderr; reduce its output",
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

/// Returns the total size of files in a folder, bytes, without following links; more than `most` for more than `files` files.
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

/// Beginnings of the lines that a language's runtime writes after the reason of an end, as gfortran does.
const BACKTRACE: [&str; 3] = ["#", "at /", "Error termination. Backtrace"];

/// Collected output of a solver.
#[derive(Default)]
pub struct SolverLog {
    pub bytes: u64,
    /// Incomplete lines of stdout and of stderr.
    pub lines: [Vec<u8>; 2],
    /// Time that the solver reported, s.
    pub reached_s: Option<f64>,
    pub notes: Vec<String>,
    /// Last line that is neither a progress line, empty, nor of a backtrace.
    last: Vec<u8>,
}

impl SolverLog {
    pub fn take(&mut self, piece: &Piece) {
        self.bytes += piece.bytes.len() as u64;
        let mut bytes = piece.bytes.as_slice();
        // Only the last line of stdout may be used, so a flood of output is cut to one line.
        if !piece.stderr && bytes.len() > LINE {
            bytes = &bytes[bytes.len() - LINE..];
            self.lines[0].clear();
        }
        for &byte in bytes {
            let line = &mut self.lines[usize::from(piece.stderr)];
            if byte == b'\n' {
                self.understand(piece.stderr);
            } else if line.len() < LINE {
                line.push(byte);
            }
        }
    }

    /// Interprets the completed line; only stderr may have commands.
    fn understand(&mut self, stderr: bool) {
        let line = std::mem::take(&mut self.lines[usize::from(stderr)]);
        let text = String::from_utf8_lossy(&line);
        let text = text.trim();
        if let Some(time) = text.strip_prefix("@t ").filter(|_| stderr) {
            let time = time.trim().parse().ok();
            let time = time.filter(|time: &f64| time.is_finite());
            self.reached_s = time.or(self.reached_s);
        } else if let Some(note) = text.strip_prefix("@note ").filter(|_| stderr) {
            if self.notes.len() < NOTES {
                self.notes.push(plain(note, WORDS));
            }
        } else if !text.is_empty() && !BACKTRACE.iter().any(|start| text.starts_with(start)) {
            self.last = line;
        }
    }

    /// Returns the final message of a program that has ended.
    pub fn last(&mut self) -> Option<String> {
        self.understand(false);
        self.understand(true);
        let last = plain(&String::from_utf8_lossy(&self.last), WORDS);
        Some(last).filter(|last| !last.is_empty())
    }
}

/// Converts a foreign text for terminal and page: one line, no control characters, limited length.
pub fn plain(text: &str, most: usize) -> String {
    let shown = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    let cut: String = shown.take(most).collect();
    cut.trim().to_owned()
}
