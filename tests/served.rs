//! Running `pinwheel explore`, and its end.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};

/// Running program and the address that it printed; killed on drop.
#[derive(Debug)]
pub struct Served(pub Child, pub String);

impl Served {
    /// Serves a scene in the folder `dir` with flags of the command.
    ///
    /// # Panics
    /// If the program does not start or prints no address.
    #[must_use]
    pub fn with(dir: &Path, scene: &str, flags: &[&str]) -> Self {
        Self::in_path(dir, scene, flags, None)
    }

    /// Serves a scene with programs from `path`.
    ///
    /// # Panics
    /// If the program does not start or prints no address.
    #[must_use]
    pub fn in_path(dir: &Path, scene: &str, flags: &[&str], path: Option<&str>) -> Self {
        let started = crate::pinwheel()
            .envs(path.map(|path| ("PATH", path)))
            .current_dir(dir)
            .args(["explore", scene])
            .args(flags)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn();
        let mut child = started.unwrap_or_else(|error| panic!("{error}"));
        let mut line = String::new();
        let read = child
            .stdout
            .take()
            .map(|stdout| BufReader::new(stdout).read_line(&mut line));
        match line.trim().strip_prefix("page: ") {
            Some(address) => {
                let address = address.to_owned();
                Self(child, address)
            }
            None => panic!("no address: {line} {read:?}"),
        }
    }

    /// Serves a scene on a port, 0 for a free one.
    ///
    /// # Panics
    /// If the program does not start or prints no address.
    #[must_use]
    pub fn of(dir: &Path, scene: &str, port: &str) -> Self {
        Self::with(dir, scene, &["--print", "--port", port])
    }

    /// Returns the port of its address.
    #[must_use]
    pub fn port(&self) -> &str {
        self.1.split([':', '/']).nth(4).unwrap_or_default()
    }

    /// Sends an interrupt and waits; returns the exit status and the time to the end.
    ///
    /// # Panics
    /// If the signal cannot be sent.
    #[cfg(unix)]
    pub fn interrupt(&mut self) -> (Option<i32>, std::time::Duration) {
        let begin = std::time::Instant::now();
        let id = self.0.id().to_string();
        let kill = std::process::Command::new("kill")
            .args(["-INT", &id])
            .status();
        assert!(kill.is_ok_and(|status| status.success()), "kill {id}");
        let code = self.0.wait().ok().and_then(|status| status.code());
        (code, begin.elapsed())
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}
