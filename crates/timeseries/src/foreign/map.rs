//! Map of a foreign file (TOML): the meaning of its columns.
//!
//! ```toml
//! name = "adams"
//! [file]
//! separator = ";"
//! decimal = ","
//! [time]
//! column = "TIME"
//! unit = "ms"
//! offset_s = 0.0        # added: the file's 0 is this time of the run
//! [columns]
//! input_torque_n_m = { column = "Motor torque", unit = "N mm", factor = -1.0 }
//! "external_sleeve_force_n_*" = { column = "SLEEVE_*", first = 1, unit = "N" }
//! external_sleeve_force_n_3 = { magnitude_of = ["FX_4", "FY_4"] }
//! output_angle_rad = { column = "ENCODER", unit = "deg", unwrap = true }
//! transmission_error_arcmin = { sum_of = { OUT = 1.0, IN = 0.0667 }, unit = "deg" }
//! ```

use std::collections::BTreeMap;

use pinwheel_files::{Broken, FileError, require};
use serde::Deserialize;

use crate::units;

/// Largest number of lines that a map skips, and largest number in it.
const MOST_LINES: usize = 1_000_000;
/// Files beside the participants' folders in an output, compared without case, as on some file systems.
const RESERVED: [&str; 3] = ["index.html", "summary.json", ".pinwheel"];

/// True if a participant of that name would overwrite a file of the report.
pub fn is_reserved(name: &str) -> bool {
    let mut taken = RESERVED.iter();
    taken.any(|taken| name.eq_ignore_ascii_case(taken))
}

/// Map of a foreign file.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Map {
    /// Name in the comparison: letters, digits, `-`, `_` and `.`; default: the file's name.
    pub name: Option<String>,
    /// Version of the program or rig behind the data.
    pub version: String,
    /// One-line description of the data.
    pub summary: String,
    /// Differences from the scene, in plain words.
    pub differences: String,
    /// Format of the file.
    pub file: FileFormat,
    /// Time column.
    pub time: TimeColumn,
    /// Pinwheel's columns with their sources. A name may contain one `*` for a number.
    pub columns: BTreeMap<String, Source>,
    /// Treatment of rows that cannot be read.
    pub rows: Rows,
    /// Interpolation to the run's sample times.
    pub resample: Resampling,
    /// Limits for this set; without limits it is not judged.
    pub limits: Vec<StatedLimit>,
}

/// Format of the file.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FileFormat {
    /// `,`, `;`, `tab`, `|` or `space` (any number of blanks).
    pub separator: String,
    /// `.` or `,`.
    pub decimal: String,
    /// Separator of thousands: `,`, `.`, `'` or a blank; nothing if left out.
    pub thousands: Option<String>,
    /// Lines before the header.
    pub skip_lines: usize,
    /// True if a row names the columns; otherwise they have numbers.
    pub header: bool,
    /// Rows between the header and the data, for example of units.
    pub lines_after_header: usize,
    /// Character that begins comment lines.
    pub comment: Option<String>,
}

impl Default for FileFormat {
    fn default() -> Self {
        Self {
            separator: ",".to_owned(),
            decimal: ".".to_owned(),
            thousands: None,
            skip_lines: 0,
            header: true,
            lines_after_header: 0,
            comment: None,
        }
    }
}

/// Reference to a column by name, or by number from 1.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub enum ColumnRef {
    /// Name in the header, without surrounding blanks.
    Name(String),
    /// Column number: 1, 2, ...
    Number(usize),
}

impl std::fmt::Display for ColumnRef {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Name(name) => f.write_str(name),
            Self::Number(number) => number.fmt(f),
        }
    }
}

/// Time column: `factor * unit * value + offset_s`; a factor below 0 for an angle that falls.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct TimeColumn {
    /// Column of the time.
    pub column: ColumnRef,
    /// Unit of the time.
    pub unit: String,
    /// Additional factor.
    pub factor: f64,
    /// Offset to be added.
    pub offset_s: Offset,
}

/// Offset added to the times of a file.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "offset_s is neither a number of seconds nor \"align\""
)]
pub enum Offset {
    /// Offset in seconds.
    Seconds(f64),
    /// Offset that fits the run best.
    Word(Word),
}

/// Keyword instead of a number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Word {
    /// `"align"`
    Align,
}

impl Offset {
    /// Returns the offset known before the run, s; 0 for alignment.
    pub fn seconds(self) -> f64 {
        match self {
            Self::Seconds(seconds) => seconds,
            Self::Word(Word::Align) => 0.0,
        }
    }
}

impl Default for TimeColumn {
    fn default() -> Self {
        Self {
            column: ColumnRef::Name("time_s".to_owned()),
            unit: "s".to_owned(),
            factor: 1.0,
            offset_s: Offset::Seconds(0.0),
        }
    }
}

/// Source of a column's values.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "a column is \"NAME\" or { column = \"NAME\", unit = \"N mm\", factor = 1.0, offset = 0.0, first = 0 } or { magnitude_of = [\"FX\", \"FY\"] } or { sum_of = { OUT = 1.0, IN = 0.0667 }, unwrap = true }"
)]
pub enum Source {
    /// Column in Pinwheel's unit.
    Plain(ColumnRef),
    /// Source with unit, factor or several columns.
    Full(FullSource),
}

/// Column with its unit: `factor * unit * value + offset`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FullSource {
    /// Column; one `*` stands for the number in Pinwheel's name.
    pub column: Option<ColumnRef>,
    /// Components of a force: the value is the root of the sum of squares of these columns.
    pub magnitude_of: Vec<ColumnRef>,
    /// Columns with weights: the value is their weighted sum, `out - in/ratio` for a transmission error.
    pub sum_of: BTreeMap<String, f64>,
    /// Unit of the column; default: Pinwheel's.
    pub unit: Option<String>,
    /// Additional factor, for example -1 to change the sign.
    pub factor: f64,
    /// Offset to be added, in Pinwheel's unit.
    pub offset: f64,
    /// Number in the file that corresponds to Pinwheel's 0.
    pub first: usize,
    /// Unwrapping of an angle that restarts after each turn.
    pub unwrap: Unwrap,
    /// Uncertainty of the values.
    pub uncertainty: Option<ColumnUncertainty>,
}

impl Default for FullSource {
    fn default() -> Self {
        Self {
            column: None,
            magnitude_of: Vec::new(),
            sum_of: BTreeMap::new(),
            unit: None,
            factor: 1.0,
            offset: 0.0,
            first: 0,
            unwrap: Unwrap::Turn(false),
            uncertainty: None,
        }
    }
}

/// Unwrapping of an angle that restarts after each turn.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(
    untagged,
    expecting = "unwrap is neither true nor the number after which the column starts again"
)]
pub enum Unwrap {
    /// After a turn in the column's unit if true; never if false.
    Turn(bool),
    /// After this value, in the column's own numbers.
    After(f64),
}

/// Uncertainty of a column's values: one standard deviation (half of a 95 % bound). The parts are independent and add as
/// squares.
#[derive(Debug, Clone, Copy, PartialEq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct ColumnUncertainty {
    /// Absolute uncertainty, in the unit of Pinwheel's column.
    pub absolute: f64,
    /// Share of the value.
    pub of_reading: f64,
    /// Share of [`range`](Self::range), as in data sheets of load cells.
    pub of_range: f64,
    /// Full range of the cell, in Pinwheel's unit.
    pub range: f64,
}

impl ColumnUncertainty {
    /// Returns the standard uncertainty of values whose root mean square is `rms`, in Pinwheel's unit.
    pub fn of(&self, rms: f64) -> f64 {
        self.absolute
            .hypot(self.of_reading * rms)
            .hypot(self.of_range * self.range)
    }

    fn is_sound(&self) -> bool {
        let parts = [self.absolute, self.of_reading, self.of_range, self.range];
        let range = self.of_range == 0.0 || self.range > 0.0;
        range && parts.iter().all(|part| part.is_finite() && *part >= 0.0) && self.of(1.0) > 0.0
    }
}

/// Treatment of rows that cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Rows {
    /// Treatment of bad rows, see [`BadRows`].
    pub bad: BadRows,
    /// Treatment of repeated times, see [`Twice`].
    pub twice: Twice,
}

/// Choice among rows with equal times, as before and after an event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Twice {
    /// Last row, the state after the event.
    #[default]
    Last,
    /// First row, the state before the event.
    First,
    /// Error that names the first repeated time.
    Refuse,
}

/// Action on a row that cannot be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum BadRows {
    /// Refuses the file, with an error that names the rows.
    #[default]
    Refuse,
    /// Skips the rows and names them in the report.
    Skip,
}

/// Interpolation to the run's sample times.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Resampling {
    /// Interpolation between the samples.
    pub method: Method,
    /// Longest gap to interpolate, in neighbouring spacings; longer gaps only where the signals continue in a straight line.
    pub longest_gap: f64,
}

impl Default for Resampling {
    fn default() -> Self {
        Self {
            method: Method::Cubic,
            longest_gap: 4.0,
        }
    }
}

/// Interpolation between two samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Method {
    /// Cubic through the four nearest samples.
    Cubic,
    /// Straight line between two samples.
    Linear,
}

impl Method {
    /// Returns the word in the map.
    pub fn word(self) -> &'static str {
        match self {
            Self::Cubic => "cubic",
            Self::Linear => "linear",
        }
    }
}

/// Limit stated by the user.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StatedLimit {
    /// Pattern of quantities (`*` for any characters).
    pub quantity: String,
    /// `steady`, `transient` or `whole`.
    pub window: String,
    /// `relative-l2`, `relative-linf`, `mean`, `peak`, `rms` or `sprague-geers`.
    pub metric: String,
    /// Largest permitted value of the metric.
    pub limit: f64,
    /// Reason of the limit.
    #[serde(default)]
    pub reason: String,
}

impl Map {
    /// Returns the stated uncertainty of a channel of Pinwheel.
    pub fn uncertainty_of(&self, channel: &str) -> Option<ColumnUncertainty> {
        let fits = |name: &str| match name.split_once('*') {
            None => name == channel,
            Some((head, tail)) => {
                let number = channel
                    .strip_prefix(head)
                    .and_then(|of| of.strip_suffix(tail));
                number.is_some_and(|number| number.parse::<usize>().is_ok())
            }
        };
        let mut sources = self.columns.iter();
        let (_, source) = sources.find(|(name, _)| fits(name))?;
        match source {
            Source::Plain(_) => None,
            Source::Full(full) => full.uncertainty,
        }
    }

    /// Reads a map.
    ///
    /// # Errors
    /// Fault with place and remedy.
    pub fn from_toml(text: &str, source_name: &str) -> Result<Self, FileError> {
        const FORM: &str = "see docs/foreign-data.md for an example";
        let map: Self = pinwheel_files::read(text, source_name, FORM)?;
        map.check()
            .map_err(|(what, remedy)| FileError::new(source_name, what, remedy))?;
        Ok(map)
    }

    /// Checks the map; an error states fault and remedy.
    fn check(&self) -> Result<(), Broken> {
        let Self { file, time, .. } = self;
        require(
            self.name.as_deref().is_none_or(plain),
            "`name` must be letters, digits, `-`, `_` and `.`",
            "write something like \"adams-2020\"",
        )?;
        require(
            !self.name.as_deref().is_some_and(is_reserved),
            "`name` is the name of a file of the report",
            "write something like \"adams-2020\"",
        )?;
        require(
            file.separator_byte().is_some() || file.separator == "space",
            "`file.separator` is not understood",
            "write \",\", \";\", \"|\", \"tab\" or \"space\"",
        )?;
        require(
            [".", ","].contains(&file.decimal.as_str()) && file.decimal != file.separator,
            "`file.decimal` must be \".\" or \",\", and not the separator",
            "set file.separator too",
        )?;
        let thousands = file.thousands.as_deref().unwrap_or("'");
        require(
            [",", ".", "'", " "].contains(&thousands)
                && ![&file.decimal, &file.separator].contains(&&thousands.to_owned())
                && (thousands, &*file.separator) != (" ", "space"),
            "`file.thousands` must be one of `,` `.` `'` and a blank, and neither the decimal mark nor the separator",
            "leave it out where numbers have no groups of digits",
        )?;
        require(
            file.comment.as_ref().is_none_or(|c| c.len() == 1),
            "`file.comment` must be one character",
            "write \"#\"",
        )?;
        require(
            file.skip_lines.max(file.lines_after_header) <= MOST_LINES,
            "`file.skip_lines` or `file.lines_after_header` is more than 1000000",
            "count the lines before the data",
        )?;
        let unit = &time.unit;
        require(
            units::factor("_rad", unit).is_err(),
            format!("`time.unit` = \"{unit}\" is an angle's"),
            "leave it out, and write factor = the seconds in which the shaft turns by one of them (1/(6 rpm) for deg; below 0 for an \
             angle that falls)",
        )?;
        require(
            units::factor("time_s", unit).is_ok(),
            "`time.unit` is no unit of time",
            "write \"s\", \"ms\", \"us\" or \"min\"",
        )?;
        require(
            time.factor != 0.0 && time.factor.is_finite() && time.offset_s.seconds().is_finite(),
            "`time` needs a finite factor that is not 0, and a finite offset",
            "leave out what you do not need",
        )?;
        require(
            !self.columns.is_empty(),
            "`columns` names nothing to compare",
            "map at least one of our columns",
        )?;
        for (name, source) in &self.columns {
            source
                .check(name)
                .map_err(|(what, remedy)| (format!("`{name}` {what}"), remedy))?;
        }
        require(
            self.resample.longest_gap >= 1.0,
            "`resample.longest_gap` must be at least 1",
            "4 bridges three missing rows",
        )?;
        let sound = |limit: &StatedLimit| limit.limit > 0.0 && limit.limit.is_finite();
        require(
            self.limits.iter().all(sound),
            "`limits` has a limit that is not above 0",
            "write limit = 0.05 for 5 %",
        )
    }
}

/// True if every file system allows the name for a folder.
fn plain(name: &str) -> bool {
    let known = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
    !name.is_empty() && name.len() <= 80 && !name.starts_with('.') && name.chars().all(known)
}

impl FileFormat {
    /// Returns the separator for the CSV reader; `None` for blanks.
    pub(super) fn separator_byte(&self) -> Option<u8> {
        match self.separator.as_str() {
            "," => Some(b','),
            ";" => Some(b';'),
            "|" => Some(b'|'),
            "tab" | "\t" => Some(b'\t'),
            _ => None,
        }
    }
}

impl Source {
    /// Checks the source of Pinwheel's column `name`; an error states fault and remedy.
    fn check(&self, name: &str) -> Result<(), Broken> {
        let full = self.full();
        let stars = |text: &str| text.matches('*').count();
        let alike = |column: &ColumnRef| match column {
            ColumnRef::Name(column) => stars(column) == stars(name),
            ColumnRef::Number(_) => stars(name) == 0,
        };
        let stated = [
            full.column.is_some(),
            !full.magnitude_of.is_empty(),
            !full.sum_of.is_empty(),
        ];
        require(
            stated.into_iter().filter(|stated| *stated).count() == 1,
            "needs one of `column`, `magnitude_of` and `sum_of`",
            "give one of them",
        )?;
        require(
            full.sum_of.values().all(|weight| weight.is_finite()),
            "has a number in `sum_of` that is not finite",
            "write sum_of = { OUT = 1.0, IN = 0.0667 }",
        )?;
        let unwrap = match full.unwrap {
            Unwrap::Turn(turn) => !turn || units::turn(name).is_some(),
            Unwrap::After(period) => period > 0.0 && period.is_finite(),
        };
        require(
            unwrap && (full.magnitude_of.is_empty() || full.unwrap == Unwrap::Turn(false)),
            "is no angle that could be unwrapped",
            "leave unwrap out",
        )?;
        require(
            full.factor.is_finite() && full.factor != 0.0 && full.offset.is_finite(),
            "needs a finite factor that is not 0, and a finite offset",
            "leave out what you do not need",
        )?;
        require(
            full.first <= MOST_LINES,
            "has a `first` above 1000000",
            "write the file's first number",
        )?;
        require(
            stars(name) <= 1,
            "has more than one `*`",
            "it stands for the pin's or disc's number",
        )?;
        require(
            full.columns().iter().all(|(column, _)| alike(column)),
            "and its column must both hold one `*`, or none",
            "write \"force_n_*\" = { column = \"F_*\" }",
        )?;
        require(
            full.uncertainty.is_none_or(|u| u.is_sound()),
            "has an uncertainty without a part above 0, with a negative one, or with a share of a range that is not given",
            "write { of_reading = 0.005 }, { absolute = 0.02 } or { of_range = 0.001, range = 50.0 }",
        )?;
        let unit = full.unit.as_deref().unwrap_or_default();
        match full.unit.as_ref().map(|unit| units::factor(name, unit)) {
            Some(Err(fitting)) => {
                let remedy = match fitting.is_empty() {
                    true => "leave it out and give a factor".to_owned(),
                    false => format!("write one of {}", fitting.join(", ")),
                };
                Err((format!("cannot be in `{unit}`"), remedy))
            }
            _ => Ok(()),
        }
    }

    /// Returns the source in its full form.
    #[doc(hidden)]
    pub fn full(&self) -> FullSource {
        match self {
            Self::Full(full) => full.clone(),
            Self::Plain(column) => FullSource {
                column: Some(column.clone()),
                ..FullSource::default()
            },
        }
    }
}

impl FullSource {
    /// Returns the columns of the source, each with its weight in a sum.
    pub(super) fn columns(&self) -> Vec<(ColumnRef, f64)> {
        let plain = self.column.iter().chain(&self.magnitude_of);
        let sum = self.sum_of.iter();
        (plain.map(|column| (column.clone(), 1.0)))
            .chain(sum.map(|(name, weight)| (ColumnRef::Name(name.clone()), *weight)))
            .collect()
    }
}
