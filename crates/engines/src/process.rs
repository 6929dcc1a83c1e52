//! Child programs: each in its own process group, monitored, and ended with all processes that it started.
//!
//! ```text
//!  stdout, stderr ──threads──> pieces ──> listener
//!  request to stop ──> SIGTERM to the group, 0.3 s later SIGKILL
//!  end ──> SIGKILL to the rest of the group and to processes that left it, CPU time, status
//! ```
//! Processes that leave the group (`setsid`) are recognised by an environment variable, on Linux. A process that clears it
//! escapes; only a container could prevent that.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

/// Longest wait for output before the limits are checked.
const PATIENCE: Duration = Duration::from_millis(10);
/// Time between the request to end and the kill.
const GRACE: Duration = Duration::from_millis(300);
/// Largest number of unread pieces of output: a program that writes more has to wait, and takes no memory.
const PIECES: usize = 16;
/// Largest number of searches for processes that left the process group.
#[cfg(target_os = "linux")]
const ROUNDS: usize = 20;
/// Time between two searches without a result.
#[cfg(target_os = "linux")]
const BETWEEN: Duration = Duration::from_millis(2);

/// Cause of the end of a program.
#[derive(Debug)]
pub enum End {
    /// Exit of the program, with its status.
    Status(ExitStatus),
    /// Stop by the user.
    Cancelled,
    /// End by this program, with the reason.
    Stopped(String),
    /// End by a time limit, in words.
    TooLong(String),
}

/// Program that has ended.
#[derive(Debug)]
pub struct Ended {
    pub end: End,
    pub wall_s: f64,
    /// CPU time of the program and of the children that it waited for, s, if the system provides it.
    pub cpu_s: Option<f64>,
}

/// Receiver of every piece of output, and of `None` every few milliseconds during the run; returns the reason if the program
/// must end.
pub type Listener<'a> = &'a mut dyn FnMut(Option<&Piece>) -> Option<End>;

/// Running program.
struct Running {
    pid: u32,
    /// Name of a variable in the environment of the program and of all that it starts.
    mark: String,
    folder: Option<PathBuf>,
}

/// Running programs, for a signal that ends this program at once.
static RUNNING: Mutex<Vec<Running>> = Mutex::new(Vec::new());

/// Ends all programs at once and removes their folders, for a signal handler that ends this program.
pub fn end_all() {
    let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
    for Running { pid, mark, folder } in running.drain(..) {
        signal(pid, Signal::Kill);
        end_marked(&mark);
        if let Some(folder) = folder {
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

/// Entry of a program among the running ones.
struct Registered(u32);

impl Registered {
    fn new(pid: u32, mark: &str, folder: Option<&Path>) -> Self {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        running.push(Running {
            pid,
            mark: mark.to_owned(),
            folder: folder.map(Path::to_owned),
        });
        Self(pid)
    }
}

impl Drop for Registered {
    fn drop(&mut self) {
        let mut running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
        running.retain(|one| one.pid != self.0);
    }
}

/// Runs a program to its end. `folder` is removed if this program is ended at once.
///
/// # Errors
/// The program does not start.
pub fn run(
    command: &mut Command,
    folder: Option<&Path>,
    listener: Listener<'_>,
) -> Result<Ended, std::io::Error> {
    command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    #[cfg(unix)]
    {
        use std::os::unix::process::CommandExt as _;
        command.process_group(0);
    }
    let mark = mark();
    command.env(&mark, "1");
    let begun = Instant::now();
    let mut child = command.spawn()?;
    let registered = Registered::new(child.id(), &mark, folder);
    let (sender, news) = mpsc::sync_channel(PIECES);
    listen(child.stdout.take(), sender.clone(), false);
    listen(child.stderr.take(), sender, true);
    let stopped = watch(&mut child, &news, listener);
    if stopped.is_some() {
        end(&mut child, &news, listener);
    }
    let wall_s = begun.elapsed().as_secs_f64();
    let cpu_s = cpu_s(child.id());
    // Ends the rest of the group; the process number is not reused before the wait.
    signal(child.id(), Signal::Kill);
    end_marked(&mark);
    drop(registered);
    let status = child.wait()?;
    // The final output is in the pipes; processes that left the group and keep them open are not waited for.
    let patience = Instant::now() + GRACE;
    while Instant::now() < patience {
        match news.recv_timeout(PATIENCE) {
            Ok(piece) => drop(listener(Some(&piece))),
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    Ok(Ended {
        end: stopped.unwrap_or(End::Status(status)),
        wall_s,
        cpu_s,
    })
}

/// Waits for the program's end; returns the reason if it must end.
fn watch(child: &mut Child, news: &Receiver<Piece>, listener: Listener<'_>) -> Option<End> {
    let mut open = true;
    loop {
        if open {
            match news.recv_timeout(PATIENCE) {
                Ok(piece) => drop(listener(Some(&piece))),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => open = false,
            }
        } else {
            thread::sleep(PATIENCE);
        }
        if has_ended(child) {
            return None;
        }
        let must_end = listener(None);
        if must_end.is_some() {
            return must_end;
        }
    }
}

/// Requests the program to end, then kills it.
fn end(child: &mut Child, news: &Receiver<Piece>, listener: Listener<'_>) {
    signal(child.id(), Signal::Terminate);
    let patience = Instant::now() + GRACE;
    while Instant::now() < patience && !has_ended(child) {
        // A full pipe would prevent it from ending.
        if let Ok(piece) = news.recv_timeout(PATIENCE) {
            listener(Some(&piece));
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

/// Returns a variable name that no other program started by Pinwheel has. If a solver starts Pinwheel itself, its mark stays in
/// the environment beside the inner solvers' marks.
#[expect(clippy::disallowed_methods, reason = "a name, no duration")]
fn mark() -> String {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    let nanos = since.unwrap_or_default().as_nanos();
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    format!("PINWHEEL_JOB_{}_{count}_{nanos}", std::process::id())
}

/// Ends all processes whose environment has a variable of this name, repeatedly, because one may start another meanwhile.
#[cfg(target_os = "linux")]
fn end_marked(mark: &str) {
    let begins = format!("{mark}=");
    let is_marked = |environment: &[u8]| {
        let mut variables = environment.split(|byte| *byte == 0);
        variables.any(|variable| variable.starts_with(begins.as_bytes()))
    };
    let mut was_empty = false;
    for _ in 0..ROUNDS {
        let entries = std::fs::read_dir("/proc").into_iter().flatten().flatten();
        let pids = entries.filter_map(|entry| entry.file_name().to_str()?.parse::<i32>().ok());
        // Processes without a readable environment belong to others. A zombie has no environment.
        let marked = pids.filter(|pid| {
            std::fs::read(format!("/proc/{pid}/environ")).is_ok_and(|all| is_marked(&all))
        });
        let marked: Vec<i32> = marked.collect();
        // A process has no environment for a moment while it becomes another program, so one empty search is not enough.
        if marked.is_empty() {
            if was_empty {
                return;
            }
            thread::sleep(BETWEEN);
        }
        was_empty = marked.is_empty();
        for pid in marked {
            if let Some(pid) = rustix::process::Pid::from_raw(pid) {
                let _ = rustix::process::kill_process(pid, rustix::process::Signal::KILL);
            }
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn end_marked(_mark: &str) {}

enum Signal {
    Terminate,
    Kill,
}

/// Sends a signal to the group led by `pid`.
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
        // The group may be empty.
        let _ = rustix::process::kill_process_group(pid, which);
    }
}

#[cfg(not(unix))]
fn signal(_pid: u32, _which: Signal) {}

/// True if the process has ended, without reaping it.
#[cfg(unix)]
fn has_ended(child: &mut Child) -> bool {
    use rustix::process::{Pid, WaitId, WaitIdOptions, waitid};
    let how = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
    // An error means that it is no longer a child.
    waitid(WaitId::Pid(Pid::from_child(child)), how).map_or(true, |status| status.is_some())
}

#[cfg(not(unix))]
fn has_ended(child: &mut Child) -> bool {
    child.try_wait().map_or(true, |status| status.is_some())
}

/// Returns the CPU time of a program that has ended and was not waited for, with that of its children, s.
#[cfg(target_os = "linux")]
fn cpu_s(pid: u32) -> Option<f64> {
    let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The second field is the name in brackets, with any characters.
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

/// Piece of output from a pipe.
pub struct Piece {
    pub bytes: Vec<u8>,
    pub stderr: bool,
}

/// Forwards the output of a pipe until its end.
fn listen(pipe: Option<impl Read + Send + 'static>, to: SyncSender<Piece>, stderr: bool) {
    thread::spawn(move || {
        let Some(mut pipe) = pipe else { return };
        let mut buffer = [0; 1 << 14];
        while let Ok(count) = pipe.read(&mut buffer) {
            if count == 0 {
                break;
            }
            let bytes = buffer[..count].to_vec();
            if to.send(Piece { bytes, stderr }).is_err() {
                break;
            }
        }
    });
}
