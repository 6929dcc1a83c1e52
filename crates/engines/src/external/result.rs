//! Results of a solver in its folder: read without trust, checked, and converted to a run.

use std::fs::File;
use std::io::{self, Read, Seek as _};
use std::path::Path;

use pinwheel_files::fits;
use pinwheel_gearbox::{Gearbox, guard};
use pinwheel_law::{CALLS_FILE, job};
use pinwheel_scene::channels::FAMILIES;
use pinwheel_scene::speed_profile;
use pinwheel_timeseries::{TimeSeries, columns};
use serde::Deserialize;

/// Largest size of `result.json` and of the counts, bytes.
const SMALL: u64 = 1 << 20;
/// Generous size of a number in a CSV file, bytes.
const NUMBER: u64 = 64;

/// Facts of its run that a solver may provide.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[serde(default)]
pub(super) struct Reply {
    pub(super) steps: u64,
    pub(super) rejected_steps: u64,
    /// Number of evaluations of the contact forces; the library's own count takes precedence.
    pub(super) right_hand_sides: u64,
    pub(super) degrees_of_freedom: usize,
    pub(super) joint_drift_m: Option<f64>,
    pub(super) cpu_s: Option<f64>,
    pub(super) settings: String,
    pub(super) notes: Vec<String>,
}

/// Time series, with the reason of an early end.
#[derive(Debug, Default)]
pub(super) struct Series {
    pub(super) time_series: TimeSeries,
    /// Time and quantity of the divergence.
    pub(super) diverged: Option<(f64, String)>,
    pub(super) notes: Vec<String>,
}

/// Job folder opened before the solver's start, so that a later replacement has no effect.
pub(super) struct JobFolder {
    #[cfg(unix)]
    handle: std::os::fd::OwnedFd,
    #[cfg(not(unix))]
    path: std::path::PathBuf,
}

impl JobFolder {
    #[cfg(unix)]
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        use rustix::fs::{Mode, OFlags, open};
        let how = OFlags::DIRECTORY | OFlags::RDONLY | OFlags::CLOEXEC | OFlags::NOFOLLOW;
        let handle = open(path, how, Mode::empty())?;
        Ok(Self { handle })
    }

    #[cfg(not(unix))]
    pub(super) fn open(path: &Path) -> io::Result<Self> {
        Ok(Self {
            path: path.to_owned(),
        })
    }

    /// Opens a file in the folder itself: no link, pipe or device, and at most `most` bytes.
    fn file(&self, name: &str, most: u64) -> Result<Option<File>, String> {
        let file = match self.open_file(name) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(_) => {
                return Err(format!(
                    "{name} is a link, or cannot be read; write a plain file"
                ));
            }
        };
        let data = file
            .metadata()
            .map_err(|error| format!("{name}: {error}"))?;
        if !data.is_file() {
            return Err(format!(
                "{name} is a folder, a pipe or a device; write a plain file"
            ));
        }
        #[cfg(unix)]
        if std::os::unix::fs::MetadataExt::nlink(&data) > 1 {
            return Err(format!(
                "{name} is also a file elsewhere (a hard link); write a file of its own"
            ));
        }
        if data.len() > most {
            return Err(format!(
                "{name} is larger than {} kB, which this scene's cannot be",
                most >> 10
            ));
        }
        Ok(Some(file))
    }

    #[cfg(unix)]
    fn open_file(&self, name: &str) -> io::Result<File> {
        use rustix::fs::{Mode, OFlags, openat};
        // Opening a pipe without a writer would block.
        let how = OFlags::RDONLY | OFlags::CLOEXEC | OFlags::NOFOLLOW | OFlags::NONBLOCK;
        Ok(File::from(openat(&self.handle, name, how, Mode::empty())?))
    }

    #[cfg(not(unix))]
    fn open_file(&self, name: &str) -> io::Result<File> {
        let path = self.path.join(name);
        if !std::fs::symlink_metadata(&path)?.is_file() {
            return Err(io::ErrorKind::InvalidInput.into());
        }
        File::open(path)
    }

    fn text(&self, name: &str, most: u64) -> Result<Option<String>, String> {
        let Some(file) = self.file(name, most)? else {
            return Ok(None);
        };
        let mut bytes = Vec::new();
        file.take(most)
            .read_to_end(&mut bytes)
            .map_err(|error| format!("{name}: {error}"))?;
        let text = String::from_utf8(bytes);
        text.map(Some)
            .map_err(|_| format!("{name} is not UTF-8 text"))
    }

    /// Returns the facts provided by the solver; defaults if there are none.
    pub(super) fn reply(&self) -> Result<Reply, String> {
        let Some(text) = self.text(job::RESULT_FILE, SMALL)? else {
            return Ok(Reply::default());
        };
        let mut reply: Reply = serde_json::from_str(&text)
            .map_err(|error| format!("{} is not as documented: {error}", job::RESULT_FILE))?;
        let sound = |x: &f64| x.is_finite() && *x >= 0.0;
        reply.joint_drift_m = reply.joint_drift_m.filter(sound);
        reply.cpu_s = reply.cpu_s.filter(sound);
        Ok(reply)
    }

    /// Returns the number of force evaluations counted by the library, if the solver closed it.
    pub(super) fn law_calls(&self) -> Option<u64> {
        let text = self.text(CALLS_FILE, SMALL).ok()??;
        let mut sum: u64 = 0;
        for line in text.lines() {
            sum = sum.saturating_add(line.trim().parse().ok()?);
        }
        Some(sum)
    }

    /// Reads and checks the time series. `complete`: the solver reported success.
    pub(super) fn time_series(&self, gearbox: &Gearbox, complete: bool) -> Result<Series, String> {
        let samples = gearbox.scene.solver.sample_times_s();
        let required = job::required(gearbox);
        let channels = gearbox.channels.len();
        let most = NUMBER * (samples.len() as u64 + 2) * (required.len() + channels + 64) as u64;
        let most = most.max(SMALL);
        let [csv, parquet] =
            [job::COURSES_FILE, job::PARQUET_FILE].map(|name| self.file(name, most));
        let (name, read) = match (csv?, parquet?) {
            (None, None) => {
                return Err(format!(
                    "it wrote no {} into its job folder",
                    job::COURSES_FILE
                ));
            }
            (Some(_), Some(_)) => {
                return Err(format!(
                    "it wrote {} and {}; write one of them",
                    job::COURSES_FILE,
                    job::PARQUET_FILE
                ));
            }
            (Some(mut file), None) => {
                let ended = !complete || ends_its_lines(&mut file);
                let read = TimeSeries::read_csv(io::BufReader::new(file.take(most)));
                let read = read.map_err(|error| error.to_string());
                let cut = "its last line has no end, so that its last number may be cut; end every line, the last one too";
                (
                    job::COURSES_FILE,
                    read.and_then(|read| ended.then_some(read).ok_or_else(|| cut.to_owned())),
                )
            }
            (None, Some(file)) => (job::PARQUET_FILE, parquet_of(file, samples.len())),
        };
        let named = |what: String| format!("{name}: {what}");
        checked(gearbox, &read.map_err(named)?, &samples, complete).map_err(named)
    }
}

/// True if the text ends with a line break; the file is rewound afterwards.
fn ends_its_lines(file: &mut File) -> bool {
    let mut last = [0];
    let read = file
        .seek(io::SeekFrom::End(-1))
        .and_then(|_| file.read_exact(&mut last));
    read.is_ok() && file.rewind().is_ok() && matches!(last, [b'\n' | b'\r'])
}

/// Reads time series of as many rows as samples, and one more to detect surplus rows.
#[cfg(feature = "parquet")]
fn parquet_of(file: File, samples: usize) -> Result<TimeSeries, String> {
    let read = pinwheel_timeseries::read_time_series(file, samples + 1);
    // Python's Parquet writers compress by default.
    read.map_err(|error| format!("{error}; write doubles, without compression"))
}

#[cfg(not(feature = "parquet"))]
fn parquet_of(_: File, _: usize) -> Result<TimeSeries, String> {
    let name = job::COURSES_FILE;
    Err(format!(
        "this build reads no Parquet; write {name}, or build with --features parquet"
    ))
}

/// Largest deviation of a time, as a share of the sampling step.
const OFF: f64 = 1e-6;

/// Checks columns, times, finiteness and signs.
fn checked(
    gearbox: &Gearbox,
    read: &TimeSeries,
    samples: &[f64],
    complete: bool,
) -> Result<Series, String> {
    let required = job::required(gearbox);
    let missing: Vec<&str> = required[1..]
        .iter()
        .map(String::as_str)
        .filter(|name| read.channel(name).is_none())
        .collect();
    if let Some(first) = missing.first() {
        let more = match missing.len() {
            1 => String::new(),
            n => format!(" and {} more", n - 1),
        };
        return Err(format!(
            "has no column `{first}`{more}; `columns` of the job lists them"
        ));
    }
    let step = gearbox.scene.solver.sample_s;
    for (row, (is, should)) in read.time_s().iter().zip(samples).enumerate() {
        if (is - should).abs() > OFF * step {
            return Err(format!(
                "row {} is at {is} s, but sample {row} is at {should} s; write a row at each of `samples_s`",
                row + 1
            ));
        }
    }
    if read.len() > samples.len() || (complete && read.len() < samples.len()) {
        return Err(format!(
            "has {} rows, but there are {} samples, from 0 to {} s",
            read.len(),
            samples.len(),
            samples.last().copied().unwrap_or_default()
        ));
    }
    let channels: Vec<&str> = gearbox.channels.names().collect();
    let wanted =
        |name: &str| required.iter().any(|known| known == name) || channels.contains(&name);
    let kept: Vec<_> = read.channels().iter().filter(|c| wanted(&c.name)).collect();
    // States are permitted columns.
    let is_state = |name: &str| {
        FAMILIES
            .iter()
            .any(|family| family.is_state() && fits(family.pattern, name))
    };
    let others = read.channels().iter().map(|channel| channel.name.as_str());
    let others = others
        .filter(|name| !wanted(name) && !is_state(name))
        .count();
    let mut notes = Vec::new();
    if others > 0 {
        notes.push(format!(
            "{others} columns that were not requested were left out."
        ));
    }
    // Divergence: the first row that is not finite, or with the output off its mesh; earlier rows are kept.
    let mut diverged: Option<(usize, String)> = None;
    let mut ends_at = |row: usize, what: String| {
        if diverged.as_ref().is_none_or(|(first, _)| row < *first) {
            diverged = Some((row, what));
        }
    };
    for channel in &kept {
        if let Some(row) = channel.values.iter().position(|x| !x.is_finite()) {
            ends_at(row, format!("{} is not finite", channel.name));
        }
    }
    let angle = read.channel(columns::OUTPUT_ANGLE).unwrap_or_default();
    let drive = &gearbox.scene.drive;
    let input = |t: f64| drive.input_speed_rad_s * t + speed_profile::lead_rad(drive, t);
    for (row, (&angle, &time)) in angle.iter().zip(samples).enumerate() {
        if let Err(what) = guard::check_output(gearbox, input(time), angle) {
            ends_at(row, what);
            break;
        }
    }
    let rows = diverged.as_ref().map_or(read.len(), |(row, _)| *row);
    if diverged.as_ref().is_some_and(|(row, _)| *row == 0) {
        let (_, what) = diverged.unwrap_or_default();
        return Err(format!(
            "the first row is wrong already: {what}; all start from `start` of the bodies"
        ));
    }
    let mut time_series = TimeSeries::new(samples[..rows].to_vec()).map_err(|e| e.to_string())?;
    for channel in kept {
        let values = channel.values[..rows].to_vec();
        let force = channel.name.starts_with(columns::EXTERNAL_FORCE)
            || channel.name.starts_with(columns::INTERNAL_FORCE);
        if force && let Some(row) = values.iter().position(|x| *x < 0.0) {
            return Err(format!(
                "{} is {} N in row {}, but is the magnitude of a force",
                channel.name,
                values[row],
                row + 1
            ));
        }
        time_series
            .push(channel.name.clone(), values)
            .map_err(|error| error.to_string())?;
    }
    signs(gearbox, &time_series)?;
    Ok(Series {
        diverged: diverged.map(|(row, what)| (samples[row], what)),
        time_series,
        notes,
    })
}

/// Checks the sign of the mean output torque against the mean load over the second half of the samples, if both are clear.
fn signs(gearbox: &Gearbox, time_series: &TimeSeries) -> Result<(), String> {
    let times = time_series.time_s();
    let half = times.len() / 2;
    let Some(torque) = time_series.channel(columns::OUTPUT_TORQUE) else {
        return Ok(());
    };
    let count = (times.len() - half).max(1) as f64;
    let mean = torque[half..].iter().sum::<f64>() / count;
    let load = times[half..]
        .iter()
        .map(|&t| gearbox.load_torque(t))
        .sum::<f64>()
        / count;
    // A transient may oscillate by twice the load; a wrong sign persists over many oscillations.
    let clear = times.len() > 100 && mean.abs() > 0.7 * load.abs() && load != 0.0;
    if clear && mean * load > 0.0 && (mean / load - 1.0).abs() < 0.3 {
        return Err(format!(
            "{} has the sign of the load (mean {mean:.3} N m, load {load:.3} N m); it is the moment of the contact forces \
             on the output shaft, which balances the load",
            columns::OUTPUT_TORQUE
        ));
    }
    Ok(())
}
