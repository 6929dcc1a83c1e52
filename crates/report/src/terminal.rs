//! Text for terminals: styles, and plain tables aligned by characters and styled after alignment.

use anstyle::{AnsiColor, Style};

/// Titles.
pub const TITLE: Style = Style::new().bold();
/// Verdicts that hold.
pub const GOOD: Style = AnsiColor::Green.on_default();
/// Verdicts that do not.
pub const BAD: Style = AnsiColor::Red.on_default().bold();
/// What is there but not judged.
pub const QUIET: Style = Style::new().dimmed();

/// The text in a style, by escape sequences that a terminal's writer takes out where nobody sees colours.
#[must_use]
pub fn styled(style: Style, text: &str) -> String {
    format!("{style}{text}{style:#}")
}

/// The text without styles, for files and pipes.
#[must_use]
pub fn plain(text: &str) -> String {
    anstream::adapter::strip_str(text).to_string()
}

/// One cell.
#[derive(Debug, Clone, Default)]
pub struct Cell {
    text: String,
    style: Style,
    right: bool,
}

impl Cell {
    /// Text, left-aligned.
    pub fn text(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            ..Self::default()
        }
    }

    /// A figure, right-aligned.
    pub fn figure(text: impl Into<String>) -> Self {
        Self {
            text: text.into(),
            right: true,
            ..Self::default()
        }
    }

    /// In a style.
    #[must_use]
    pub fn styled(mut self, style: Style) -> Self {
        self.style = style;
        self
    }
}

/// Characters of a line, beyond which the text in a row's last cell goes on below its beginning.
const LINE: usize = 110;
/// Characters the last cell gets at least, however wide the others are.
const LAST: usize = 40;

/// Rows of cells as lines, two spaces between columns; shorter rows are allowed.
#[must_use]
pub fn lines(rows: &[Vec<Cell>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells
            .map(|cell| cell.text.chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let mut line = String::new();
        let mut indent = 0;
        for (column, cell) in row.iter().enumerate() {
            let padding = " ".repeat(widths[column].saturating_sub(cell.text.chars().count()));
            let last = column + 1 == row.len();
            if cell.right {
                line.push_str(&format!("{padding}{}", styled(cell.style, &cell.text)));
            } else if last {
                let parts = wrapped(&cell.text, LINE.saturating_sub(indent).max(LAST));
                let parts: Vec<String> =
                    parts.iter().map(|part| styled(cell.style, part)).collect();
                line.push_str(&parts.join(&format!("\n{}", " ".repeat(indent))));
            } else {
                line.push_str(&format!("{}{padding}", styled(cell.style, &cell.text)));
            }
            if !last {
                line.push_str("  ");
            }
            indent += widths[column] + 2;
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// The text in parts of at most `width` characters, broken at spaces where there are any.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut parts = vec![String::new()];
    for word in text.split(' ') {
        let used = parts.last().map_or(0, |part| part.chars().count());
        match parts.last_mut() {
            Some(part) if used == 0 => part.push_str(word),
            Some(part) if used + 1 + word.chars().count() <= width => {
                part.push(' ');
                part.push_str(word);
            }
            _ => parts.push(word.to_owned()),
        }
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_text_has_no_escapes() {
        assert_eq!(plain(&styled(BAD, "worse")), "worse");
        assert_ne!(styled(BAD, "worse"), "worse");
    }

    #[test]
    fn columns_line_up() {
        let rows = [
            vec![Cell::text("engine"), Cell::figure("N m")],
            vec![Cell::text("a"), Cell::figure("1.4529")],
        ];
        assert_eq!(lines(&rows), "engine     N m\na       1.4529\n");
    }

    #[test]
    fn long_text_goes_on_below_its_beginning() {
        let rows = [vec![
            Cell::text("key"),
            Cell::text("word ".repeat(50).trim_end()),
        ]];
        let text = lines(&rows);
        assert!(text.lines().count() > 1);
        for line in text.lines().skip(1) {
            assert!(
                line.starts_with("     word") && line.len() <= LINE,
                "{line:?}"
            );
        }
        assert_eq!(text.matches("word").count(), 50);
    }
}
