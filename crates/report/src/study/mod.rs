//! Pages of studies with a common layout.
//!
//! A [`Study`] is data: sections of text, tables and charts. [`render`] converts it to one self-contained page, which opens
//! without a network, is readable without a script (except for charts), and works on a phone, in dark mode and on paper.
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

/// Content of a study's page. Strings may have any characters: all are escaped, except [`Block::Html`]; `` `backticks` ``
/// in text become code.
#[derive(Debug, Clone, Default)]
pub struct Study {
    /// Heading and title of the page, e.g. `paper`.
    pub title: String,
    /// Small line above the heading: the kind of study.
    pub eyebrow: String,
    /// Text of one or two sentences below the heading.
    pub lead: String,
    /// Answer in one line, if the study has one.
    pub verdict: Option<Verdict>,
    /// Answers to the questions of a decision ([`Question`]), as far as the study has them.
    pub decision: Decision,
    /// Blocks between the answer and the figures.
    pub top: Vec<Block>,
    /// Title of the figures; may be empty.
    pub tiles_title: String,
    /// Main figures.
    pub tiles: Vec<Tile>,
    /// Blocks below the figures.
    pub below: Vec<Block>,
    /// Blocks beside answer and figures, for example an animation.
    pub aside: Vec<Block>,
    /// Sections in order; each has a link in the top bar.
    pub sections: Vec<Section>,
    /// Command that repeats this study.
    pub command: String,
    /// Blocks below the command and the versions.
    pub appendix: Vec<Block>,
    /// Date for the foot of the page; `None` for pages equal byte for byte.
    pub date: Option<String>,
    /// Versions of the program and its parts, e.g. (`pinwheel`, `0.1.0`).
    pub versions: Vec<(String, String)>,
    /// Description of the machine, e.g. (`processor`, ...), (`operating system`, ...).
    pub machine: Vec<(String, String)>,
}

/// Answer of a study in one line.
#[derive(Debug, Clone)]
pub struct Verdict {
    /// Tone: good if all requirements of the study are met.
    pub tone: Tone,
    /// Text of the answer.
    pub headline: String,
    /// Reasons for the verdict.
    pub detail: String,
}

/// Tone of an answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tone {
    /// All requirements are met.
    Good,
    /// At least one requirement is violated.
    Bad,
    /// Finding without a requirement.
    Neutral,
    /// Inconclusive.
    Open,
}

impl Tone {
    /// Returns good or bad.
    pub fn of(good: bool) -> Self {
        if good { Self::Good } else { Self::Bad }
    }
}

/// Figure in large type.
#[derive(Debug, Clone, Default)]
pub struct Tile {
    /// Name of the figure.
    pub label: String,
    /// Formatted value (see [`crate::format`]).
    pub value: String,
    /// Unit of the figure, or empty.
    pub unit: String,
    /// Bounds of the figure, or a value for comparison.
    pub detail: String,
    /// Mark of the figure.
    pub mark: Mark,
}

/// Answers to the four questions of a decision.
pub type Decision = [Option<Tile>; 4];

/// Question of a decision. Every first screen answers the questions in this order, and omits those that its study cannot
/// answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Question {
    /// Do independent computations agree?
    Right,
    /// Are loads within limits?
    Bears,
    /// Question for the bounds by law, fit and numerics.
    Sure,
    /// Which command comes next, for the same scene?
    Next,
}

impl Question {
    /// Creates the tile of an answer: a word or two, or a command in backticks, and the reason.
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
    /// Creates a figure without a unit.
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

    /// Creates the tile of the next step.
    pub fn next(command: &str, why: &str) -> Self {
        Question::Next.answered(Mark::None, format!("`{command}`"), why)
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

/// Part of the page with a heading.
#[derive(Debug, Clone, Default)]
pub struct Section {
    /// Anchor: lower-case letters, digits and `-`; unique on the page. Not `top`, `main` or
    /// `reproduce`.
    pub id: String,
    /// Heading and text of the link in the top bar, so short.
    pub title: String,
    /// Content of the section. A single [`Block::Details`] folds the section behind its title, and print omits it.
    pub blocks: Vec<Block>,
}

impl Section {
    /// Creates a section without blocks.
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

/// Block of a section.
#[derive(Debug, Clone)]
pub enum Block {
    /// Heading inside the section.
    Heading(String),
    /// Paragraph.
    Text(String),
    /// List of points, one or two sentences each.
    List(Vec<String>),
    /// Questions with their answers.
    Facts(Vec<Fact>),
    /// Questions with their answers, side by side.
    Columns(Vec<Fact>),
    /// Sortable table.
    Table(Table),
    /// Charts, side by side if there is room.
    Charts(Vec<Chart>),
    /// Figures over parameters, with selectable axes.
    Grid(Grid),
    /// Blocks folded behind a line.
    Details {
        /// Text of the line.
        summary: String,
        /// Folded blocks.
        blocks: Vec<Block>,
    },
    /// Entry of a list with details.
    Item(Item),
    /// Folded table, which the page's script makes when opened, because few readers open every table.
    Later {
        /// Text of the line.
        summary: String,
        /// Folded table.
        table: Table,
    },
    /// Text of a terminal or a file.
    Code(String),
    /// Markup that scripts fill, with the plotting library available.
    Live {
        /// Markup, inserted unchanged.
        markup: String,
        /// Elements with its data and code, for the end of the page (see [`crate::script`]).
        scripts: String,
        /// True if the scripts query the program that serves the page.
        asks: bool,
    },
    /// Markup of this program, inserted unchanged. Inline styles and scripts are allowed, external ones are not.
    Html(String),
}

/// Question in a word or two, answer in a sentence, and its mark.
#[derive(Debug, Clone)]
pub struct Fact {
    /// Label of the question.
    pub label: String,
    /// Text of the answer.
    pub text: String,
    /// Mark of the answer.
    pub mark: Mark,
}

impl Fact {
    /// Creates a fact.
    pub fn new(label: impl Into<String>, mark: Mark, text: impl Into<String>) -> Self {
        Self {
            label: label.into(),
            text: text.into(),
            mark,
        }
    }
}

/// Entry of a list: name, verdict, and folded details.
#[derive(Debug, Clone, Default)]
pub struct Item {
    /// Anchor.
    pub id: String,
    /// Name.
    pub name: String,
    /// Mark of the verdict.
    pub mark: Mark,
    /// Text of the verdict.
    pub badge: String,
    /// Quantity and window of the verdict.
    pub beside: String,
    /// True if the item is unfolded at first.
    pub open: bool,
    /// Folded blocks.
    pub blocks: Vec<Block>,
}

impl Block {
    /// Creates a heading inside a section.
    pub fn heading(text: impl Into<String>) -> Self {
        Self::Heading(text.into())
    }

    /// Creates blocks folded behind a line.
    pub fn folded(summary: impl Into<String>, blocks: impl Into<Blocks>) -> Self {
        Self::Details {
            summary: summary.into(),
            blocks: blocks.into().0,
        }
    }
}

/// Blocks of a section; strings are paragraphs.
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
