//! Text for terminals: styles, and plain tables that fit the width, aligned by characters and styled after alignment.

use anstyle::{AnsiColor, Style};
use pinwheel_timeseries::table::{Column, Mark, Table};

use crate::study::Fact;
use crate::table;

/// Style of titles.
pub const TITLE: Style = Style::new().bold();
/// Style of passed verdicts.
pub const GOOD: Style = AnsiColor::Green.on_default();
/// Style of failed verdicts.
pub const BAD: Style = AnsiColor::Red.on_default().bold();
/// Style of unconfirmed verdicts.
pub const OPEN: Style = AnsiColor::Yellow.on_default().bold();
/// Style of a part that is not judged.
pub const QUIET: Style = Style::new().dimmed();

/// Returns the text in a style, with escape sequences that the output removes without a terminal.
pub fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

/// Joins parts below a title.
pub fn titled<const N: usize>(title: &str, parts: [String; N]) -> String {
    format!("{}\n{}", styled(TITLE, title), parts.concat())
}

/// Returns the text without styles, for files and pipes.
pub fn plain(text: &str) -> String {
    anstream::adapter::strip_str(text).to_string()
}

/// Cell; figures are aligned right.
#[derive(Debug, Clone)]
struct Cell {
    text: String,
    style: Style,
    right: bool,
}

impl Cell {
    /// Makes a cell of words; backticks, which mark code on a page, are left out.
    fn words(text: &str, style: Style) -> Self {
        Self {
            text: text.replace('`', ""),
            style,
            right: false,
        }
    }
}

/// Line length without a screen, characters.
const USUAL: usize = 80;
/// Widths of a table: narrower ones cut words, wider ones are hard to read.
const WIDTHS: std::ops::RangeInclusive<usize> = 60..=120;
/// Least width of a column of text, if its text is as long, characters.
const LEAST: usize = 12;

/// Returns the line length of the terminal at stdout, stdin or stderr; 80 without one.
pub fn width() -> usize {
    let size = terminal_size::terminal_size();
    let columns = size.map_or(USUAL, |(columns, _)| usize::from(columns.0));
    columns.clamp(*WIDTHS.start(), *WIDTHS.end())
}

/// Returns rows of cells as lines that fit the terminal, two spaces between columns; shorter rows are allowed. Long text
/// continues below its start.
fn lines(rows: &[Vec<Cell>]) -> String {
    lines_within(rows, width())
}

/// Like [`lines`], with at most `room` characters.
fn lines_within(rows: &[Vec<Cell>], room: usize) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let of = |column: usize| rows.iter().filter_map(move |row| row.get(column));
    let longest = |column: usize| of(column).map(|c| c.text.chars().count()).max();
    let mut widths: Vec<usize> = (0..columns).map(|k| longest(k).unwrap_or(0)).collect();
    // Order of shrinking: text at the end of rows first, then the widest column; names last.
    let word = |column: usize| {
        let words = of(column).flat_map(|cell| cell.text.split(' '));
        words.map(|word| word.chars().count()).max().unwrap_or(0)
    };
    let figures = |column: usize| of(column).any(|cell| cell.right);
    let last = columns.saturating_sub(1);
    for only_last in [true, false] {
        let gives_way = |k: usize| match only_last {
            true => k == last,
            false => !figures(k),
        };
        let most = |k: usize| if gives_way(k) { LEAST } else { usize::MAX };
        let least = (0..columns).map(|k| word(k).min(most(k)));
        let least: Vec<usize> = least.collect();
        while widths.iter().sum::<usize>() + 2 * last > room {
            let wide = (0..columns).filter(|&k| widths[k] > least[k]);
            let prose = |k: usize| k == last && widths[k] > 2 * LEAST && !figures(k);
            let Some(widest) = wide.max_by_key(|&k| (prose(k), widths[k])) else {
                break;
            };
            widths[widest] -= 1;
        }
    }
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().zip(&widths);
        let cells = cells.map(|(cell, width)| wrapped(&cell.text, *width));
        let cells: Vec<Vec<String>> = cells.collect();
        let high = cells.iter().map(Vec::len).max().unwrap_or(0);
        for line in 0..high {
            let mut joined = String::new();
            for ((cell, parts), width) in row.iter().zip(&cells).zip(&widths) {
                let part = parts.get(line).map_or("", String::as_str);
                let padding = " ".repeat(width.saturating_sub(part.chars().count()));
                let part = match part {
                    "" => String::new(),
                    part => styled(cell.style, part),
                };
                joined += &match cell.right {
                    true => format!("{padding}{part}  "),
                    false => format!("{part}{padding}  "),
                };
            }
            text.push_str(joined.trim_end());
            text.push('\n');
        }
    }
    text
}

/// Returns a table with its headings; marks become styles.
pub fn table(table: &Table) -> String {
    let aligned = |column: &Column, text: String, style| Cell {
        right: column.values.is_numeric(),
        ..Cell::words(&text.replace('\u{202f}', " "), style)
    };
    let head = table::shown(table);
    let head = head.map(|column| aligned(column, table::heading(column), TITLE));
    let mut rows = vec![head.collect::<Vec<_>>()];
    rows.extend((0..table.len()).map(|row| {
        let cell = |column| {
            let style = style(table::mark(column, row));
            aligned(column, table::words(column, row), style)
        };
        table::shown(table).map(cell).collect()
    }));
    lines(&rows)
}

fn style(mark: Mark) -> Style {
    match mark {
        Mark::None => Style::new(),
        Mark::Good => GOOD,
        Mark::Bad => BAD,
        Mark::Warn => TITLE,
        Mark::Muted => QUIET,
    }
}

/// Returns labels with their texts, one pair a line.
pub fn pairs<L: Into<String>, T: Into<String>>(rows: impl IntoIterator<Item = (L, T)>) -> String {
    let rows = rows.into_iter();
    list(rows.map(|(label, text)| [label.into(), text.into()]))
}

/// Returns questions with their answers, in the style of the answer's mark.
pub fn facts(facts: &[Fact]) -> String {
    let rows = facts.iter().map(|fact| {
        let label = Cell::words(&format!("{:12}", fact.label), Style::new());
        vec![label, Cell::words(&fact.text, style(fact.mark))]
    });
    lines(&rows.collect::<Vec<_>>())
}

/// Returns rows of words in columns, without headings.
pub fn list<const N: usize>(rows: impl IntoIterator<Item = [String; N]>) -> String {
    let cell = |text| Cell {
        text,
        style: Style::new(),
        right: false,
    };
    let rows = rows.into_iter().map(|row| row.map(cell).to_vec());
    lines(&rows.collect::<Vec<_>>())
}

/// Returns a paragraph that fits the terminal.
pub fn paragraph(text: &str) -> String {
    wrapped(text, width()).join("\n")
}

/// Returns paragraphs that fit the terminal, each with its line end.
pub fn paragraphs<T: AsRef<str>>(texts: impl IntoIterator<Item = T>) -> String {
    let texts = texts.into_iter();
    texts.map(|text| paragraph(text.as_ref()) + "\n").collect()
}

/// Returns the text in parts of at most `width` characters: broken at spaces, a longer word after a hyphen or a slash, else
/// anywhere.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let width = width.max(1);
    let (mut parts, mut part) = (Vec::new(), String::new());
    for word in text.split(' ') {
        let used = part.chars().count();
        if used > 0 && used + 1 + word.chars().count() <= width {
            part = part + " " + word;
            continue;
        }
        if used > 0 {
            parts.push(std::mem::take(&mut part));
        }
        let mut rest = word;
        while let Some((end, _)) = rest.char_indices().nth(width) {
            let joint = rest[..end].rfind(['-', '/', ',']).map(|k| k + 1);
            let cut = joint.filter(|k| *k > 1).unwrap_or(end);
            parts.push(rest[..cut].to_owned());
            rest = &rest[cut..];
        }
        part = rest.to_owned();
    }
    parts.push(part);
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(text: &str, right: bool) -> Cell {
        Cell {
            text: text.to_owned(),
            style: Style::new(),
            right,
        }
    }

    #[test]
    fn plain_text_has_no_escapes() {
        assert_eq!(plain(&styled(BAD, "worse")), "worse");
        assert_ne!(styled(BAD, "worse"), "worse");
    }

    #[test]
    fn columns_line_up() {
        let rows = [
            vec![cell("engine", false), cell("N m", true)],
            vec![cell("a", false), cell("1.4529", true)],
        ];
        assert_eq!(lines(&rows), "engine     N m\na       1.4529\n");
    }

    #[test]
    fn long_text_goes_on_below_its_beginning() {
        let rows = [vec![
            cell("key", false),
            cell("word ".repeat(50).trim_end(), false),
        ]];
        let text = lines_within(&rows, 80);
        assert!(text.lines().count() > 1);
        for line in text.lines().skip(1) {
            assert!(
                line.starts_with("     word") && line.len() <= 80,
                "{line:?}"
            );
        }
        assert_eq!(text.matches("word").count(), 50);
    }

    #[test]
    fn tables_fit_their_room() {
        let row = |name: &str, note: &str| {
            vec![
                cell(name, false),
                cell("-1.4529e-12", true),
                cell("100.36", true),
                cell(note, false),
            ]
        };
        let rows = [
            row("exudyn-shared-law-constrained", "load balance within"),
            row("x", &"z".repeat(90)),
        ];
        for room in [60, 72, 80, 100] {
            let text = lines_within(&rows, room);
            for line in text.lines() {
                assert!(line.chars().count() <= room, "{room}: {line:?}");
            }
            let squeezed: String = text.split_whitespace().collect();
            assert_eq!(squeezed.matches('z').count(), 90);
            assert!(text.contains("-1.4529e-12"), "{text}");
        }
        assert_eq!(
            wrapped("exudyn-shared-law", 8),
            ["exudyn-", "shared-", "law"]
        );
        assert_eq!(wrapped("\u{e9}\u{e9}\u{e9}", 2), ["\u{e9}\u{e9}", "\u{e9}"]);
    }
}
