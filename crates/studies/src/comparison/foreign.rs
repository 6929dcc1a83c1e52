//! Foreign data (another program's export, a test rig) as a participant of a comparison.

use std::collections::BTreeSet;
use std::fmt::Display;
use std::fs::File;
use std::path::{Path, PathBuf};

use pinwheel_compare::limits::fits;
use pinwheel_compare::windows::{SETTLING_S, windows};
use pinwheel_compare::{
    Cost, DataUncertainty, Metric, Participant, SharedModel, StatedLimit, Status, WindowKind,
};
use pinwheel_files::read_text;
use pinwheel_gearbox::Gearbox;
use pinwheel_scene::channels::{Channels, FAMILIES};
use pinwheel_scene::{Scene, did_you_mean};
use pinwheel_timeseries::foreign::{self, ForeignError, Map, Offset, Resampled, Twice};
use pinwheel_timeseries::{TimeSeries, TimeSeriesError, columns, group_of};

use super::context::context;
use crate::StudyError;

/// Largest number of bad rows in a note.
const MOST_NAMED: usize = 20;

/// Foreign file that has been read.
#[derive(Debug, Clone)]
pub struct Data {
    path: PathBuf,
    map_path: PathBuf,
    name: String,
    map: Map,
    foreign: foreign::Foreign,
    limits: Vec<StatedLimit>,
}

impl Data {
    /// Returns the name among the participants of a comparison.
    pub fn name(&self) -> &str {
        &self.name
    }
}

/// Reads foreign files, each with the map of its columns.
///
/// # Errors
/// First fault of a file or a map, or two files of one name, with place and remedy.
pub fn open<'a>(
    files: impl IntoIterator<Item = (&'a Path, &'a Path)>,
) -> Result<Vec<Data>, StudyError> {
    let mut list: Vec<Data> = Vec::new();
    for (path, map_path) in files {
        let data = read(path, map_path)?;
        if list.iter().any(|other| other.name == data.name) {
            return Err(StudyError::Input(format!(
                "two foreign files are called `{}`; give each a `name` of its own in its map",
                data.name
            )));
        }
        list.push(data);
    }
    Ok(list)
}

/// Reads foreign files with one map for each file, or one for all.
///
/// # Errors
/// Errors of [`open`]; several maps, but not as many as files.
pub fn open_all(files: &[PathBuf], maps: &[PathBuf]) -> Result<Vec<Data>, StudyError> {
    if files.len() != maps.len() && maps.len() > 1 {
        return Err(StudyError::Input(format!(
            "{} files and {} maps; give one map for each file, or one for all",
            files.len(),
            maps.len()
        )));
    }
    let files = files.iter().map(PathBuf::as_path);
    open(files.zip(maps.iter().cycle().map(PathBuf::as_path)))
}

/// Returns an error about a file.
fn fault(path: &Path, what: impl Display) -> StudyError {
    StudyError::Input(format!("{}: {what}", path.display()))
}

fn read(path: &Path, map_path: &Path) -> Result<Data, StudyError> {
    let map = read_text(map_path, "give a TOML file that says what the columns are")
        .and_then(|text| Map::from_toml(&text, &map_path.display().to_string()))
        .map_err(|error| StudyError::Input(error.to_string()))?;
    let file = File::open(path).map_err(|error| fault(path, ForeignError::unreadable(error)))?;
    let foreign = foreign::read(file, &map).map_err(|error| fault(path, error))?;
    let columns = foreign.time_series.channels().iter();
    let quantities: BTreeSet<&str> = columns.map(|c| group_of(&c.name).0).collect();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    let own = map.name.clone();
    let name = own.unwrap_or_else(|| stem.replace(|c: char| !plain(c), "-"));
    let name = match name.trim_start_matches('.') {
        "" => "data",
        name => name,
    };
    if foreign::is_reserved(name) {
        let what = format!(
            "`{name}` is the name of a file of the report; give the data another `name` in {}",
            map_path.display()
        );
        return Err(fault(path, what));
    }
    let limits = limits(name, &map, &quantities).map_err(|error| fault(map_path, error))?;
    Ok(Data {
        path: path.to_owned(),
        map_path: map_path.to_owned(),
        name: name.to_owned(),
        map,
        foreign,
        limits,
    })
}

/// Returns the limits of a map, each of which applies to at least one of the mapped `quantities`.
fn limits(name: &str, map: &Map, quantities: &BTreeSet<&str>) -> Result<Vec<StatedLimit>, String> {
    fn find<T: Copy>(
        known: impl IntoIterator<Item = T>,
        word: fn(T) -> &'static str,
        key: &str,
        typed: &str,
    ) -> Result<T, String> {
        let known: Vec<T> = known.into_iter().collect();
        let row = known.iter().find(|one| word(**one) == typed);
        row.copied().ok_or_else(|| {
            let words: Vec<&str> = known.into_iter().map(word).collect();
            format!(
                "limits: `{typed}` is no {key}; {}",
                did_you_mean(typed, &words)
            )
        })
    }
    let windows = [WindowKind::Steady, WindowKind::Transient, WindowKind::Whole];
    let one = |limit: &foreign::StatedLimit| {
        if !quantities.iter().any(|known| fits(&limit.quantity, known)) {
            let known: Vec<String> = quantities.iter().map(|&known| known.to_owned()).collect();
            return Err(format!(
                "limits: `{}` fits no mapped column, so it can never be judged; write one of {}",
                limit.quantity,
                foreign::first_of(&known, MOST_NAMED, ", ")
            ));
        }
        Ok(StatedLimit {
            engine: name.to_owned(),
            window: find(windows, WindowKind::word, "window", &limit.window)?,
            quantity: limit.quantity.clone(),
            metric: find(Metric::of_pairs(), Metric::key, "metric", &limit.metric)?,
            limit: limit.limit,
            reason: or(&limit.reason, "Stated in the map."),
        })
    };
    map.limits.iter().map(one).collect()
}

/// Returns the gearbox with the channels for comparison with foreign columns.
///
/// # Errors
/// A mapped column that no engine records, because its name is mistyped.
pub fn with_channels(list: &[Data], gearbox: Gearbox) -> Result<Gearbox, StudyError> {
    let own = &gearbox.scene.output.channels;
    let mut channels = own.clone();
    let mut everything = gearbox.scene.clone().into_scene();
    everything.output.channels = vec!["*".to_owned()];
    let all = Channels::of(&everything).map_err(StudyError::Input)?;
    let contract = pinwheel_gearbox::Recorder::contract(&gearbox);
    for data in list {
        for channel in data.foreign.time_series.channels() {
            let name = channel.name.as_str();
            if contract.iter().any(|known| known == name) {
                continue;
            }
            if !all.names().any(|known| known == name) {
                let known = contract.iter().map(String::as_str).chain(all.names());
                let near = did_you_mean(name, &known.collect::<Vec<_>>());
                let remedy = if near.starts_with("did you mean") {
                    near
                } else {
                    "see docs/glossary.md for their names".to_owned()
                };
                let what = format!("`{name}` is no column of this gearbox; {remedy}");
                return Err(fault(&data.map_path, what));
            }
            if !gearbox.channels.names().any(|known| known == name) {
                channels.push(name.to_owned());
            }
        }
    }
    if channels.len() == own.len() {
        return Ok(gearbox);
    }
    // Hundreds of names become one pattern for each family, because scenes have a limited number of patterns.
    let recording = gearbox.with_channels(patterns(&channels));
    recording.map_err(|error| StudyError::Input(error.to_string()))
}

/// Returns the names; above 50 of them a pattern for each family.
fn patterns(names: &[String]) -> Vec<String> {
    if names.len() <= 50 {
        return names.to_vec();
    }
    let mut list: Vec<String> = Vec::new();
    for name in names {
        let mut families = FAMILIES.iter();
        let family = families.find(|family| fits(family.pattern, name));
        let pattern = family.map_or(name.as_str(), |family| family.pattern);
        if !list.iter().any(|known| known == pattern) {
            list.push(pattern.to_owned());
        }
    }
    list
}

fn or(text: &str, otherwise: &str) -> String {
    let text = if text.is_empty() { otherwise } else { text };
    text.to_owned()
}

/// Formats a time without the rounding of factor and offset.
fn short(time: f64) -> String {
    let text = format!("{time:.9}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

impl Data {
    /// Returns the data at the scene's sample times, with their stated limits.
    pub(super) fn take_part(
        &self,
        scene: &Scene,
        others: &[Participant],
    ) -> Result<(Participant, Vec<StatedLimit>), StudyError> {
        if others.iter().any(|other| other.name == self.name) {
            let (name, map) = (&self.name, self.map_path.display());
            let what = format!("`{name}` is an engine's name; give it another `name` in {map}");
            return Err(fault(&self.path, what));
        }
        let times = scene.solver.sample_times_s();
        let (own, shift_note) = self.placed(others)?;
        let resampled = foreign::resample(&own, &times, self.map.resample);
        let resampled = resampled.map_err(|error| fault(&self.path, error))?;
        self.judgeable(scene, &resampled)
            .map_err(|error| fault(&self.map_path, error))?;
        // Changes of the data come first.
        let mut notes: Vec<String> = shift_note.into_iter().collect();
        notes.extend(self.notes(scene, &own, &resampled));
        let cost = Cost {
            settings: format!("{}, by {}", self.path.display(), self.map_path.display()),
            notes,
            ..Cost::default()
        };
        let unsaid = "Its map does not say how it differs from the scene.";
        let participant = Participant {
            name: self.name.clone(),
            track: SharedModel::Measured,
            version: or(&self.map.version, "unknown"),
            summary: or(&self.map.summary, "data from elsewhere"),
            differences: or(&self.map.differences, unsaid),
            time_series: resampled.time_series,
            cost,
            status: Status::Finished,
        };
        Ok((participant, self.limits.clone()))
    }

    /// Checks that each limit's window is in the run and has data.
    fn judgeable(&self, scene: &Scene, resampled: &Resampled) -> Result<(), String> {
        let context = context(scene);
        let settling = context.settling_s.unwrap_or(SETTLING_S);
        let (windows, absent) = windows(&resampled.time_series, settling, &context.load_changes_s);
        let [from, to] = resampled.covers_s;
        for limit in &self.limits {
            let (quantity, word) = (&limit.quantity, limit.window.word());
            let Some(window) = windows.iter().find(|w| w.kind == limit.window) else {
                let mut absent = absent.iter();
                let why = absent.find(|absent| absent.kind == limit.window);
                let why = why.map_or_else(String::new, |absent| format!(" ({})", absent.reason));
                let words: Vec<&str> = windows.iter().map(|w| w.kind.word()).collect();
                return Err(format!(
                    "limits: `{quantity}` can never be judged in the {word} window, which the run does not have{why}; it has {}",
                    words.join(" and ")
                ));
            };
            if to < window.from_s || from > window.to_s {
                return Err(format!(
                    "limits: `{quantity}` can never be judged in the {word} window, {} to {} s, of which the file has nothing: it \
                     covers {} to {} s; state it for another window, or set time.offset_s",
                    short(window.from_s),
                    short(window.to_s),
                    short(from),
                    short(to)
                ));
            }
        }
        Ok(())
    }

    /// Returns the data at the times of the map, with a note on a better time shift.
    fn placed(&self, others: &[Participant]) -> Result<(TimeSeries, Option<String>), StudyError> {
        let own = &self.foreign.time_series;
        let offset = self.map.time.offset_s;
        let finished = others.iter().filter(|other| other.status.is_finished());
        let run = finished
            .max_by_key(|other| (other.track == SharedModel::Native, other.time_series.len()));
        let resampled = match run {
            Some(run) => foreign::shift(&run.time_series, own).map(|shift| (&run.name, shift)),
            None => Err("no engine finished".to_owned()),
        };
        match (offset, resampled) {
            (Offset::Word(_), Err(why)) => Err(fault(
                &self.path,
                format!(
                    "offset_s = \"align\" finds nothing to align by: {why}; give offset_s in seconds"
                ),
            )),
            (Offset::Word(_), Ok((name, shift))) => {
                let seconds = shift.seconds;
                let times = own.time_s().iter().map(|t| t + seconds).collect();
                let broken = |error: TimeSeriesError| StudyError::Input(error.to_string());
                let mut moved = TimeSeries::new(times).map_err(broken)?;
                for channel in own.channels().iter().cloned() {
                    let pushed = moved.push(channel.name, channel.values);
                    pushed.map_err(broken)?;
                }
                Ok((moved, Some(shift.message(name, offset))))
            }
            (Offset::Seconds(_), resampled) => {
                let better = resampled.ok().filter(|(_, shift)| shift.matters());
                let shift_note = better.map(|(name, shift)| shift.message(name, offset));
                Ok((own.clone(), shift_note))
            }
        }
    }

    /// Returns notes on the changes of the data.
    fn notes(&self, scene: &Scene, own: &TimeSeries, resampled: &Resampled) -> Vec<String> {
        let mut notes = Vec::new();
        let (bad, rows) = (&self.foreign.bad, self.foreign.rows);
        if !bad.is_empty() {
            notes.push(format!(
                "{} of {rows} rows are bad and left out: {}.",
                bad.len(),
                foreign::first_of(bad, MOST_NAMED, "; ")
            ));
        }
        if let Some((count, first)) = self.foreign.twice {
            let row = match self.map.rows.twice {
                Twice::First => "first",
                Twice::Last | Twice::Refuse => "last",
            };
            notes.push(format!(
                "{count} instants are written more than once, the first {} s: the {row} row of each counts (twice under [rows] of \
                 its map).",
                short(first)
            ));
        }
        let times = own.time_s();
        let [first, last] = [times.first(), times.last()].map(|t| short(t.copied().unwrap_or(0.0)));
        let added = match self.map.time.offset_s.seconds() {
            0.0 => String::new(),
            offset => format!(", after {offset} s were added"),
        };
        let rows = times.len();
        notes.push(format!("{rows} rows from {first} to {last} s{added}."));
        let [from, to] = resampled.covers_s;
        if from > 0.0 || to < scene.solver.duration_s {
            let [from, to] = [from, to].map(short);
            notes.push(format!(
                "Compared from {from} to {to} s, which is what it covers of the run's {} s.",
                scene.solver.duration_s
            ));
        }
        if let Some((error, column)) = &resampled.restores {
            notes.push(format!(
                "{} of {} sample times are its own, the others are interpolated ({}). With every second of its rows left \
                 out, this restores them to {error:.1e} (relative L2 of {column}, the worst column); the differences \
                 shown hold up to as much of it.",
                resampled.own,
                resampled.own + resampled.interpolated,
                self.map.resample.method.word()
            ));
        }
        if let Some(gap) = resampled.gaps_s.first() {
            let [from, to] = gap.map(short);
            notes.push(format!(
                "{} gaps are too long to bridge, the first from {from} to {to} s: only the longest stretch without one is compared.",
                resampled.gaps_s.len()
            ));
        }
        let gear = &scene.gear;
        let channels = self.foreign.time_series.channels();
        let count = |prefix: &str| {
            let named = channels.iter().filter(|c| c.name.starts_with(prefix));
            named.count()
        };
        let has = |name: &str| self.foreign.time_series.channel(name).is_some();
        let single = columns::HEAD.into_iter().filter(|name| !has(name));
        let mut missing: Vec<String> = single.map(str::to_owned).collect();
        for (prefix, sleeves) in [
            (columns::EXTERNAL_FORCE, gear.external_sleeves),
            (columns::INTERNAL_FORCE, gear.internal_sleeves),
        ] {
            let there = count(prefix);
            if there < sleeves {
                missing.push(format!("{} of {sleeves} {prefix}", sleeves - there));
            }
        }
        if !missing.is_empty() {
            notes.push(format!("It has no {}.", missing.join(", ")));
        }
        notes
    }

    /// Returns the uncertainties of the map, relative to the measured values (for a group of columns, to their root mean
    /// square). `inputs` is the effect of the scene's uncertain values on each quantity, as a share of its RMS.
    pub(super) fn uncertainties(
        &self,
        measured: &TimeSeries,
        inputs: &[(String, f64)],
    ) -> Vec<DataUncertainty> {
        let mut groups: Vec<(&str, f64, f64)> = Vec::new();
        for channel in measured.channels() {
            let Some(stated) = self.map.uncertainty_of(&channel.name) else {
                continue;
            };
            let known = channel.values.iter().filter(|v| v.is_finite());
            let (count, squares) = known.fold((0.0, 0.0), |(n, sum), v| (n + 1.0, sum + v * v));
            let u = stated.of((squares / f64::max(count, 1.0)).sqrt());
            let name = group_of(&channel.name).0;
            match groups.iter_mut().find(|(known, ..)| *known == name) {
                Some((_, of_all, all)) => {
                    *of_all += u * u * count;
                    *all += squares;
                }
                None => groups.push((name, u * u * count, squares)),
            }
        }
        let relative = |(name, u, squares): (&str, f64, f64)| DataUncertainty {
            engine: self.name.clone(),
            quantity: name.to_owned(),
            data: (u / squares).sqrt(),
            input: inputs
                .iter()
                .find(|(quantity, _)| quantity == name)
                .map_or(0.0, |(_, share)| *share),
        };
        let resampled = groups.into_iter().map(relative);
        resampled.filter(|one| one.data.is_finite()).collect()
    }
}
