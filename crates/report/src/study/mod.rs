//! Pages of studies: one shell for every page.
//!
//! A [`Study`] is data: sections of text, tables and charts. [`render`] turns it into one
//! self-contained page: it opens without a network, reads without a script (but for the charts),
//! and works on a phone, in the dark and on paper.
//!
//! ```
//! use pinwheel_report::study::{Section, Study, render};
//! use pinwheel_timeseries::table::{Table, TableOf};
//!
//! let table = Table::of("Driver torque", [("native", 1.4529)])
//!     .text("", "engine", |row| row.0)
//!     .number("", "torque", |row| row.1)
//!     .unit("N m");
//! let section = Section::new("torque", "Torque").with(table);
//! let page = render(&Study { title: "mine".into(), sections: vec![section], ..Study::default() });
//! assert!(page.contains("Torque") && page.contains("1.4529"));
//! ```

mod chart;
mod grid;
mod page;

pub use chart::{Axis, Chart, Series, Style};
pub use grid::{Grid, GridAxis, GridFigure};
pub use page::render;

pub use pinwheel_files::output::escape;
pub use pinwheel_timeseries::table::Mark;
use pinwheel_timeseries::table::{Table, TableOf};

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
    /// Answers to the questions of a decision ([`Question`]), as far as the study has them.
    pub decision: Decision,
    /// Blocks between the answer and the figures.
    pub top: Vec<Block>,
    /// Title of the figures; may be empty.
    pub tiles_title: String,
    /// The few figures that matter most.
    pub tiles: Vec<Tile>,
    /// Blocks below the figures.
    pub below: Vec<Block>,
    /// Blocks beside answer and figures, if there is something to look at.
    pub aside: Vec<Block>,
    /// The study itself, in order; each has a link in the top bar.
    pub sections: Vec<Section>,
    /// The command that repeats this study.
    pub command: String,
    /// Blocks below the command and the versions.
    pub appendix: Vec<Block>,
    /// Time at which the page was made, for its foot; `None` keeps the page the same byte for byte.
    pub made: Option<String>,
    /// Versions of the program and its parts, e.g. (`pinwheel`, `0.1.0`).
    pub versions: Vec<(String, String)>,
    /// The machine, e.g. (`processor`, ...), (`operating system`, ...).
    pub machine: Vec<(String, String)>,
}

/// The answer of a study in one line.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// Tone that shows whether all requirements of the study hold.
    pub tone: Tone,
    /// The answer.
    pub headline: String,
    /// Reasons for the verdict.
    pub detail: String,
}

/// Tone of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// All that is asked for holds.
    Good,
    /// Something that is asked for does not hold.
    Bad,
    /// A finding: there was no condition to meet.
    Neutral,
    /// No conclusion: the study showed nothing either way.
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
    /// Name of the figure.
    pub label: String,
    /// The figure, formatted (see [`crate::format`]).
    pub value: String,
    /// Unit of the figure, or empty.
    pub unit: String,
    /// Bounds of the figure, or the value that it is compared with.
    pub detail: String,
    /// Mark of the figure.
    pub mark: Mark,
}

/// Answers to the four questions of a decision.
pub type Decision = [Option<Tile>; 4];

/// Questions of who has to decide, answered by every first screen in this order; a study that cannot answer one leaves it out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Do independent computations agree?
    Right,
    /// Are loads within limits?
    Bears,
    /// How wide are the bounds of law, fit and numerics?
    Sure,
    /// Which command comes next, for the same scene?
    Next,
}

impl Question {
    /// The tile of an answer: a word or two, or a command in backticks, and its reason.
    #[must_use]
    pub fn answered(self, mark: Mark, value: impl Into<String>, detail: impl Into<String>) -> Tile {
        let label = match self {
            Self::Right => "Is it right?",
            Self::Bears => "Will it bear?",
            Self::Sure => "How sure?",
            Self::Next => "What next?",
        };
        Tile {
            mark,
            ..Tile::new(label, value, detail)
        }
    }
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
            detail: detail.into(),
            ..Self::default()
        }
    }

    /// Sets the unit.
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
    /// Content of the section. [`Block::Details`] alone folds all of the section behind its title; print leaves it out.
    pub blocks: Vec<Block>,
}

impl Section {
    /// A section without blocks.
    pub fn new(id: impl Into<String>, title: impl Into<String>) -> Self {
        Self {
            id: id.into(),
            title: title.into(),
            blocks: Vec::new(),
        }
    }

    /// Appends a block, or several.
    #[must_use]
    pub fn with(mut self, blocks: impl Into<Blocks>) -> Self {
        self.blocks.extend(blocks.into().0);
        self
    }

    /// Folds the section behind its title, with `beside` next to it.
    #[must_use]
    pub fn folded(self, beside: impl Into<String>) -> Self {
        Self {
            blocks: vec![Block::folded(beside, self.blocks)],
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
    /// Questions with their answers.
    Facts(Vec<Fact>),
    /// Questions with their answers, side by side.
    Columns(Vec<Fact>),
    /// A table that can be sorted.
    Table(Table),
    /// Charts, side by side where there is room.
    Charts(Vec<Chart>),
    /// Figures over parameters, with a choice of axes.
    Grid(Grid),
    /// Blocks behind a line that opens them.
    Details {
        /// The line.
        summary: String,
        /// Blocks behind the line.
        blocks: Vec<Block>,
    },
    /// Entry of a list that folds.
    Item(Item),
    /// Table that the page's script makes once its line is opened, because few readers open every table.
    Later {
        /// The line.
        summary: String,
        /// Table behind the line.
        table: Table,
    },
    /// Text as a terminal or a file shows it.
    Code(String),
    /// Markup that scripts fill, with the plotting library at hand.
    Live {
        /// The markup, placed as it is.
        markup: String,
        /// Elements with its data and code, for the end of the page (see [`crate::script`]).
        scripts: String,
        /// True if the scripts ask the program that serves the page.
        asks: bool,
    },
    /// Markup written by this program; placed as it is. Inline styles and scripts are allowed,
    /// anything from elsewhere is not.
    Html(String),
}

/// A question in a word or two, its answer in a sentence, and how that is marked.
#[derive(Debug, Clone)]
pub struct Fact {
    /// The question.
    pub label: String,
    /// The answer.
    pub text: String,
    /// Mark of the answer.
    pub mark: Mark,
}

impl Fact {
    /// A fact.
    pub fn new(label: impl Into<String>, mark: Mark, text: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            text: text.into(),
            mark,
        }
    }
}

/// Entry of a list that folds: its name, its verdict, and the details behind it.
#[derive(Debug, Clone, Default)]
pub struct Item {
    /// Anchor.
    pub id: String,
    /// Name.
    pub name: String,
    /// Mark of the verdict.
    pub mark: Mark,
    /// Verdict in words.
    pub said: String,
    /// Place of the verdict: its quantity and window.
    pub beside: String,
    /// True if the item is unfolded at first.
    pub open: bool,
    /// Blocks behind the item's line.
    pub blocks: Vec<Block>,
}

impl Block {
    /// A heading inside a section.
    pub fn heading(text: impl Into<String>) -> Self {
        Self::Heading(text.into())
    }

    /// Blocks behind a line that opens them.
    pub fn folded(summary: impl Into<String>, blocks: impl Into<Blocks>) -> Self {
        Self::Details {
            summary: summary.into(),
            blocks: blocks.into().0,
        }
    }
}

/// A block or several; strings are paragraphs.
#[derive(Debug, Clone, Default)]
pub struct Blocks(pub Vec<Block>);

impl<B: Into<Block>> From<B> for Blocks {
    fn from(block: B) -> Self {
        Self(vec![block.into()])
    }
}

impl<const N: usize> From<[Block; N]> for Blocks {
    fn from(blocks: [Block; N]) -> Self {
        Self(blocks.into())
    }
}

impl From<Vec<Block>> for Blocks {
    fn from(blocks: Vec<Block>) -> Self {
        Self(blocks)
    }
}

impl From<&str> for Block {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Block {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<Vec<Fact>> for Block {
    fn from(facts: Vec<Fact>) -> Self {
        Self::Facts(facts)
    }
}

impl From<Vec<Chart>> for Block {
    fn from(charts: Vec<Chart>) -> Self {
        Self::Charts(charts)
    }
}

impl<R> From<TableOf<R>> for Block {
    fn from(table: TableOf<R>) -> Self {
        Self::Table(table.done())
    }
}

impl From<Table> for Block {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}
