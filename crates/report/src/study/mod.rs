//! Pages of studies: one shell for every page that is not a comparison of engines on one scene.
//!
//! A [`Study`] is data: sections of text, tables and charts. [`render`] turns it into one
//! self-contained page with the comparison page's look: it opens without a network, reads without
//! a script (but for the charts), and works on a phone, in the dark and on paper.
//!
//! ```
//! use pinwheel_report::study::{Block, Cell, Column, Section, Study, Table, render};
//!
//! let table = Table {
//!     caption: "Driver torque".into(),
//!     columns: vec![Column::text("engine"), Column::number("N m")],
//!     rows: vec![vec![Cell::text("native"), Cell::number("1.4529", 1.4529)]],
//! };
//! let section = Section { id: "torque".into(), title: "Torque".into(), blocks: vec![Block::Table(table)] };
//! let page = render(&Study { title: "mine".into(), sections: vec![section], ..Study::default() })?;
//! assert!(page.contains("Torque") && page.contains("1.4529"));
//! # Ok::<(), pinwheel_report::ReportError>(())
//! ```

mod chart;
mod grid;
mod page;

pub use chart::{Axis, Chart, Series, Style};
pub use grid::{Grid, GridAxis, GridFigure};

use pinwheel_compare::{Comparison, Participant};
pub use pinwheel_timeseries::table::Mark;
use pinwheel_timeseries::table::Table as Data;

use crate::ReportError;
use crate::chart_data::ChartData;

/// Everything on one study's page. Strings may hold any characters: all are escaped, except
/// [`Block::Html`]; `` `backticks` `` in running text become code.
#[derive(Debug, Clone, Default)]
pub struct Study {
    /// Heading and title of the page, e.g. `paper`.
    pub title: String,
    /// Small line above the heading: what kind of study this is.
    pub eyebrow: String,
    /// One or two sentences below the heading.
    pub lead: String,
    /// The answer in one line, if the study has one.
    pub verdict: Option<Verdict>,
    /// What stands between the answer and the figures.
    pub top: Vec<Block>,
    /// What the figures are of; may be empty.
    pub tiles_title: String,
    /// The few figures that matter most.
    pub tiles: Vec<Tile>,
    /// What stands below the figures.
    pub below: Vec<Block>,
    /// What stands beside all that, if there is something to look at.
    pub aside: Option<Vec<Block>>,
    /// The study itself, in order; each has a link in the top bar.
    pub sections: Vec<Section>,
    /// The command that repeats this study.
    pub command: String,
    /// What stands below the command and the versions.
    pub appendix: Vec<Block>,
    /// When it was made, for the foot of the page; `None` keeps the page the same byte for byte.
    pub made: Option<String>,
    /// Versions of the program and its parts, e.g. (`pinwheel`, `0.1.0`).
    pub versions: Vec<(String, String)>,
    /// The machine, e.g. (`processor`, ...), (`operating system`, ...).
    pub machine: Vec<(String, String)>,
}

/// The answer of a study in one line.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// Whether everything the study asks for holds.
    pub tone: Tone,
    /// The answer.
    pub headline: String,
    /// What it rests on.
    pub detail: String,
}

/// How an answer is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// All that is asked for holds.
    Good,
    /// Something does not.
    Bad,
    /// Nothing was to hold: a finding.
    Neutral,
    /// Nothing was shown.
    Open,
}

impl Tone {
    /// Good or bad.
    #[must_use]
    pub fn of(good: bool) -> Self {
        if good { Self::Good } else { Self::Bad }
    }
}

/// One figure in large type.
#[derive(Debug, Clone, Default)]
pub struct Tile {
    /// What it is.
    pub label: String,
    /// The figure, formatted (see [`crate::format`]).
    pub value: String,
    /// Its unit, or empty.
    pub unit: String,
    /// How it was found, or what it compares with.
    pub detail: String,
}

impl Tile {
    /// A figure without a unit.
    pub fn new(
        label: impl Into<String>,
        value: impl Into<String>,
        detail: impl Into<String>,
    ) -> Self {
        Self {
            label: label.into(),
            value: value.into(),
            unit: String::new(),
            detail: detail.into(),
        }
    }

    /// The same in a unit.
    #[must_use]
    pub fn unit(self, unit: impl Into<String>) -> Self {
        Self {
            unit: unit.into(),
            ..self
        }
    }
}

/// A part of the page with a heading.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Anchor: lower-case letters, digits and `-`; unique on the page. Not `top`, `main` or
    /// `reproduce`.
    pub id: String,
    /// Heading; also the link's text in the top bar, so short.
    pub title: String,
    /// What stands under it. [`Block::Details`] alone folds the whole section behind its title; print leaves it out.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section of blocks.
    pub fn new(
        id: impl Into<String>,
        title: impl Into<String>,
        blocks: impl Into<Vec<Block>>,
    ) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            blocks: blocks.into(),
        }
    }

    /// The same behind its title, with `beside` next to it.
    #[must_use]
    pub fn folded(self, beside: impl Into<String>) -> Self {
        let fold = Block::Details {
            summary: beside.into(),
            blocks: self.blocks,
        };
        Self {
            blocks: vec![fold],
            ..self
        }
    }
}

/// A piece of a section.
#[derive(Debug, Clone)]
pub enum Block {
    /// A heading inside the section.
    Heading(String),
    /// A paragraph.
    Text(String),
    /// Points, one sentence or two each.
    List(Vec<String>),
    /// A table that can be sorted.
    Table(Table),
    /// A table that can be sorted, of columns with their type.
    Data(Data),
    /// Charts, side by side where there is room.
    Charts(Vec<Chart>),
    /// Figures over parameters, with a choice of axes.
    Grid(Grid),
    /// Time series of several runs, one quantity at a time. One on a page at most.
    TimeSeries(TimeSeries),
    /// Blocks behind a line that opens them.
    Details {
        /// The line.
        summary: String,
        /// What it opens.
        blocks: Vec<Block>,
    },
    /// One of a list, folded.
    Item(Item),
    /// A table that the page's script makes when its line is opened: nobody reads all of them.
    Later {
        /// The line.
        summary: String,
        /// What it opens.
        table: Data,
    },
    /// Text as a terminal or a file shows it.
    Code(String),
    /// Markup written by this program; placed as it is. Inline styles and scripts are allowed,
    /// anything from elsewhere is not.
    Html(String),
}

/// One of a list: its name, what it amounts to, and behind that all the rest.
#[derive(Debug, Clone, Default)]
pub struct Item {
    /// Anchor.
    pub id: String,
    /// Name.
    pub name: String,
    /// How it is marked.
    pub mark: Mark,
    /// What it amounts to.
    pub said: String,
    /// What that is of.
    pub beside: String,
    /// Whether it is unfolded at first.
    pub open: bool,
    /// What it opens.
    pub blocks: Vec<Block>,
}

impl Block {
    /// Blocks behind a line that opens them.
    pub fn folded(summary: impl Into<String>, blocks: impl Into<Vec<Self>>) -> Self {
        Self::Details {
            summary: summary.into(),
            blocks: blocks.into(),
        }
    }

    /// A paragraph.
    pub fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }
}

impl From<Data> for Block {
    fn from(table: Data) -> Self {
        Self::Data(table)
    }
}

/// Time series as a comparison's page draws them: values, and differences to any of the runs.
#[derive(Debug, Clone)]
pub struct TimeSeries(ChartData);

impl TimeSeries {
    /// Those of the participants of a comparison, which are no engines and have their colours in order; `None` if nobody has
    /// any.
    #[must_use]
    pub fn of(comparison: &Comparison, participants: &[Participant]) -> Option<Self> {
        let data = ChartData::of(comparison, participants)?;
        Some(Self(data.with_colours_in_order(participants)))
    }

    /// Those of engines, each with the colour that it has on every page; `None` if nobody has any.
    #[must_use]
    pub fn of_engines(comparison: &Comparison, participants: &[Participant]) -> Option<Self> {
        let mut data = ChartData::of(comparison, participants)?;
        data.notes.push(
            "Samples of recordings are marks. No engine is the truth: differences can be taken to any.".to_owned(),
        );
        Some(Self(data))
    }
}

/// A table.
#[derive(Debug, Clone, Default)]
pub struct Table {
    /// What the table shows; read first by a screen reader.
    pub caption: String,
    /// Columns, left to right. The first names the row.
    pub columns: Vec<Column>,
    /// Rows of as many cells as there are columns; missing ones are empty.
    pub rows: Vec<Vec<Cell>>,
}

/// A column of a [`Table`].
#[derive(Debug, Clone, Default)]
pub struct Column {
    /// Heading, with the unit.
    pub label: String,
    /// Whether figures stand in it: they are set to the right.
    pub numeric: bool,
}

impl Column {
    /// A column of words.
    pub fn text(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            numeric: false,
        }
    }

    /// A column of figures.
    pub fn number(label: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            numeric: true,
        }
    }
}

/// A cell of a [`Table`].
#[derive(Debug, Clone, Default)]
pub struct Cell {
    /// What stands in it.
    pub text: String,
    /// How it is marked, by sign and colour.
    pub mark: Mark,
    /// Shade of the ground from 0 (none) to 1 (full), for maps; `None` for plain cells.
    pub heat: Option<f64>,
    /// What the table is sorted by, where the text is not a plain number.
    pub key: Option<f64>,
}

impl Cell {
    /// A cell of words.
    pub fn text(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }

    /// A figure: `text` is shown, `key` sorts.
    pub fn number(text: impl Into<String>, key: f64) -> Self {
        Self {
            text: text.into(),
            key: Some(key),
            ..Self::default()
        }
    }

    /// The same cell with a mark.
    #[must_use]
    pub fn marked(self, mark: Mark) -> Self {
        Self { mark, ..self }
    }

    /// The same cell with a shaded ground, 0 to 1.
    #[must_use]
    pub fn heated(self, heat: f64) -> Self {
        Self {
            heat: Some(heat),
            ..self
        }
    }
}

impl<T: Into<String>> From<T> for Cell {
    fn from(text: T) -> Self {
        Self::text(text)
    }
}

/// Fills in a study's page. The page depends on the study alone.
///
/// # Errors
/// Never in practice: the template or the charts' data cannot be written.
pub fn render(study: &Study) -> Result<String, ReportError> {
    page::render(study)
}
