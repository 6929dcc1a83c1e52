//! One run of a foreign program: started in a process group of its own, watched, and ended with everything it started.
//!
//! ```text
//!  stdout, stderr ──threads, bounded──> log, @t progress, @note
//!  cancel, timeout, folder too large, log too long ──> SIGTERM to the group, 0.3 s later SIGKILL
//!  its end ──> SIGKILL to what is left of the group, CPU time, status
//! ```
//! A program that leaves its group on purpose escapes; nothing short of a container would hold it.

use std::ffi::OsString;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

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
/// How long one waits for news before looking around.
const PATIENCE: Duration = Duration::from_millis(10);
/// How often sizes are looked at.
const LOOK: Duration = Duration::from_millis(100);
/// How long a program has to end itself when asked to.
const GRACE: Duration = Duration::from_millis(300);
/// Files looked at in a folder, and levels.
const FILES: usize = 10_000;
const LEVELS: usize = 8;

/// How it came to its end.
#[derive(Debug)]
pub(super) enum End {
    /// By itself.
    Status(ExitStatus),
    /// The user stopped it.
    Cancelled,
    /// We did, and why.
    Stopped(String),
    /// We did, because it took longer than it may, in words.
    TooLong(String),
}

/// What is left of a run.
#[derive(Debug)]
pub(super) struct Ran {
    pub(super) end: End,
    pub(super) wall_s: f64,
    /// Of the program and what it waited for, where the system tells.
    pub(super) cpu_s: Option<f64>,
    /// Time it said to have reached, s.
    pub(super) reached_s: Option<f64>,
    pub(super) notes: Vec<String>,
    /// What else it wrote, cut in the middle where it is long.
    pub(super) log: String,
}

/// The programs that run now, and their folders: for a signal that ends ours at once.
static RUNNING: Mutex<Vec<(u32, PathBuf)>> = Mutex::new(Vec::new());

/// Ends all solvers at once and removes their folders. For a signal handler that ends the program.
pub fn end_all() {
    let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    for (pid, folder) in running.drain(..) {
        signal(pid, Signal::Kill);
        let _ = std::fs::remove_dir_all(folder);
    }
}

/// A program's place among those that run.
struct Registered(u32);

impl Registered {
    fn new(pid: u32, folder: &Path) -> Self {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        running.push((pid, folder.to_owned()));
        Self(pid)
    }
}

impl Drop for Registered {
    fn drop(&mut self) {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        running.retain(|(pid, _)| *pid != self.0);
    }
}

/// Where it runs.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// Its job folder.
    pub(super) folder: &'a Path,
    /// The law library, which it finds by its name.
    pub(super) library: Option<&'a Path>,
}

/// The variable that leads programs to libraries, and what leads them to `library` first.
fn library_path(library: &Path) -> Option<(&'static str, OsString)> {
    let variable = if cfg!(windows) {
        "PATH"
    } else if cfg!(target_os = "macos") {
        "DYLD_LIBRARY_PATH"
    } else {
        "LD_LIBRARY_PATH"
    };
    let before = std::env::var_os(variable).unwrap_or_default();
    let others: Vec<PathBuf> = std::env::split_paths(&before)
        .filter(|path| !path.as_os_str().is_empty())
        .collect();
    let paths = std::iter::once(library.parent()?.to_owned()).chain(others);
    Some((variable, std::env::join_paths(paths).ok()?))
}

/// Runs `argv` in a job folder; `reached` hears of simulated times and says when to stop.
pub(super) fn run(
    argv: &[OsString],
    Place { folder, library }: Place<'_>,
    limits: Limits,
    reached: &dyn Fn(f64) -> bool,
) -> Result<Ran, std::io::Error> {
    let Some((program, arguments)) = argv.split_first() else {
        return Err(std::io::ErrorKind::InvalidInput.into());
    };
    let mut command = Command::new(program);
    command
        .args(arguments)
        .current_dir(folder)
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("PYTHONUNBUFFERED", "1")
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    if let Some((variable, paths)) = library.and_then(library_path) {
        command.env(variable, paths);
    }
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        command.process_group(0);
    }
    let begun = Instant::now();
    let mut child = command.spawn()?;
    let registered = Registered::new(child.id(), folder);
    let (sender, news) = mpsc::channel();
    listen(child.stdout.take(), sender.clone(), false);
    listen(child.stderr.take(), sender, true);
    let mut heard = Heard::default();
    let stopped = watch(
        &mut child, folder, limits, begun, &news, &mut heard, reached,
    );
    if stopped.is_some() {
        end(&mut child, &news, &mut heard);
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let cpu_s = cpu_s(child.id());
    // Whatever it left behind; its number is not given away before it is waited for.
    signal(child.id(), Signal::Kill);
    drop(registered);
    let status = child.wait()?;
    // Its last words are in the pipes; whoever left the group and holds them open is not waited for.
    let patience = Instant::now() + GRACE;
    while Instant::now() < patience {
        match news.recv_timeout(PATIENCE) {
            Ok(piece) => heard.take(&piece),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    // It may have ended before anybody looked.
    if let Some(time) = heard.reached_s {
        reached(time);
    }
    Ok(Ran {
        end: stopped.unwrap_or(End::Status(status)),
        wall_s,
        cpu_s,
        reached_s: heard.reached_s,
        log: heard.log(),
        notes: heard.notes,
    })
}

/// Waits for its end; else why it must end.
fn watch(
    child: &mut Child,
    folder: &Path,
    limits: Limits,
    begun: Instant,
    news: &Receiver<Piece>,
    heard: &mut Heard,
    reached: &dyn Fn(f64) -> bool,
) -> Option<End> {
    let (mut looked, mut open) = (begun, true);
    loop {
        if open {
            match news.recv_timeout(PATIENCE) {
                Ok(piece) => heard.take(&piece),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => open = false,
            }
        } else {
            thread::sleep(PATIENCE);
        }
        if has_ended(child) {
            return None;
        }
        if reached(heard.reached_s.unwrap_or(0.0)) {
            return Some(End::Cancelled);
        }
        if begun.elapsed() > limits.longest {
            return Some(End::TooLong(format!(
                "it took longer than {} s; give it more by `timeout_s` in its manifest",
                limits.longest.as_secs_f64()
            )));
        }
        if heard.bytes > limits.log_bytes {
            return Some(End::Stopped(format!(
                "it wrote more than {} MB to stdout and stderr; let it say less",
                limits.log_bytes >> 20
            )));
        }
        if looked.elapsed() > LOOK {
            looked = Instant::now();
            let mut files = FILES;
            if size(folder, limits.folder_bytes, LEVELS, &mut files) > limits.folder_bytes {
                return Some(End::Stopped(format!(
                    "its files are larger than {} MB, or too many; let it write courses.csv alone",
                    limits.folder_bytes >> 20
                )));
            }
        }
    }
}

/// Asks it to end, then ends it.
fn end(child: &mut Child, news: &Receiver<Piece>, heard: &mut Heard) {
    signal(child.id(), Signal::Terminate);
    let patience = Instant::now() + GRACE;
    while Instant::now() < patience && !has_ended(child) {
        // A full pipe would keep it from ending.
        if let Ok(piece) = news.recv_timeout(PATIENCE) {
            heard.take(&piece);
        }
    }
    signal(child.id(), Signal::Kill);
    if cfg!(not(unix)) {
        let _ = child.kill();
    }
    while !has_ended(child) {
        thread::sleep(PATIENCE);
    }
}

enum Signal {
    Terminate,
    Kill,
}

/// A signal to the group that `pid` leads.
#[cfg(unix)]
fn signal(pid: u32, which: Signal) {
    let which = match which {
        Signal::Terminate => rustix::process::Signal::TERM,
        Signal::Kill => rustix::process::Signal::KILL,
    };
    let pid = i32::try_from(pid)
        .ok()
        .and_then(rustix::process::Pid::from_raw);
    if let Some(pid) = pid {
        // There may be nobody left.
        let _ = rustix::process::kill_process_group(pid, which);
    }
}

#[cfg(not(unix))]
fn signal(_pid: u32, _which: Signal) {}

/// Whether it has ended, without taking its number from it.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> bool {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let Some(pid) = i32::try_from(child.id()).ok().and_then(Pid::from_raw) else {
        return true;
    };
    let how = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    // An error: it is nobody's child any more.
    waitid(WaitId::Pid(pid), how).map_or(true, |status| status.is_some())
}

#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> bool {
    child.try_wait().map_or(true, |status| status.is_some())
}

/// CPU time of a program that has ended and was not waited for, with that of its children, s.
#[cfg(target_os = "linux")]
fn cpu_s(pid: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The second field is its name in brackets, which may hold anything.
    let (_, rest) = stat.rsplit_once(')')?;
    let fields: Vec<&str> = rest.split_whitespace().collect();
    // utime, stime, cutime, cstime: fields 14 to 17, of which the first here is the third.
    let ticks: u64 = fields
        .get(11..15)?
        .iter()
        .filter_map(|t| t.parse::<u64>().ok())
        .sum();
    Some(ticks as f64 / rustix::param::clock_ticks_per_second() as f64)
}

#[cfg(not(target_os = "linux"))]
fn cpu_s(_pid: u32) -> Option<f64> {
    None
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

/// What came through a pipe.
struct Piece {
    bytes: Vec<u8>,
    /// Orders are understood on stderr alone.
    orders: bool,
}

/// Passes on what a pipe brings, until its end.
fn listen(pipe: Option<impl Read + Send + 'static>, to: Sender<Piece>, orders: bool) {
    thread::spawn(move || {
        let Some(mut pipe) = pipe else { return };
        let mut buffer = [0; 1 << 14];
        while let Ok(count) = pipe.read(&mut buffer) {
            if count == 0 {
                break;
            }
            let bytes = buffer[..count].to_vec();
            if to.send(Piece { bytes, orders }).is_err() {
                break;
            }
        }
    });
}

/// What it said.
#[derive(Default)]
struct Heard {
    bytes: u64,
    /// The line under way on stderr.
    line: Vec<u8>,
    reached_s: Option<f64>,
    notes: Vec<String>,
    head: Vec<u8>,
    tail: std::collections::VecDeque<u8>,
    lost: bool,
}

impl Heard {
    fn take(&mut self, piece: &Piece) {
        self.bytes += piece.bytes.len() as u64;
        if !piece.orders {
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

    fn log(&mut self) -> String {
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
            let orders = true;
            heard.take(&Piece { bytes, orders });
            let (bytes, orders) = (vec![b'y'; 1 << 14], false);
            heard.take(&Piece { bytes, orders });
        }
        assert_eq!(heard.bytes, 200 << 14);
        assert_eq!(heard.line.len(), LINE);
        assert!(heard.head.len() + heard.tail.len() <= LOG_KEPT);
        assert!(heard.log().contains("[...]"));
    }
}
