//! Rows of cells of a foreign file, and its header.

use std::collections::HashMap;
use std::io::{self, BufRead, BufReader, Cursor, Read};

use super::error::{ForeignError, first_of, short};
use super::map::{ColumnRef, FileFormat};

/// Largest number of columns of a file without a header.
const MOST_COLUMNS: usize = 10_000;

/// Rows of cells with their line numbers.
pub(super) struct Lines<'a> {
    reader: csv::Reader<Box<dyn BufRead + 'a>>,
    record: csv::ByteRecord,
    /// Number of lines before the reader's first.
    skipped: usize,
    /// True if blanks separate the cells; comments may then be indented.
    pub(super) blanks: bool,
    comment: Option<u8>,
}

/// First bytes of files that are not text, with their type.
const NO_TEXT: [(&[u8], &str); 6] = [
    (
        b"PK\x03\x04",
        "a zip archive or a workbook of a spreadsheet",
    ),
    (b"MATLAB 5", "a MAT-file"),
    (b"\x89HDF", "an HDF5 file"),
    (b"TDSm", "a TDMS file"),
    (b"MDF  ", "an MDF file"),
    (b"PAR1", "a Parquet file"),
];

/// Returns the text as UTF-8 without its byte order mark; its first bytes reveal UTF-16, which spreadsheets and loggers write.
fn decoded<'a>(source: impl Read + 'a) -> io::Result<Box<dyn BufRead + 'a>> {
    let mut source = BufReader::new(source);
    let start = source.fill_buf()?;
    let mut kinds = NO_TEXT.iter();
    if let Some((_, kind)) = kinds.find(|(first, _)| start.starts_with(first)) {
        return Err(io::Error::other(format!("it is {kind}")));
    }
    let pair = match start {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        // Without a byte order mark the first letter reveals the byte order.
        [first, 0, ..] if *first > 0 => u16::from_le_bytes,
        [0, second, ..] if *second > 0 => u16::from_be_bytes,
        start => {
            let mark = 3 * usize::from(start.starts_with("\u{feff}".as_bytes()));
            source.consume(mark);
            return Ok(Box::new(source));
        }
    };
    let mut bytes = Vec::new();
    source.read_to_end(&mut bytes)?;
    let (pairs, _) = bytes.as_chunks::<2>();
    let units: Vec<u16> = pairs.iter().map(|&bytes| pair(bytes)).collect();
    let text = String::from_utf16_lossy(&units);
    let text = text.trim_start_matches('\u{feff}').to_owned();
    Ok(Box::new(Cursor::new(text.into_bytes())))
}

impl<'a> Lines<'a> {
    pub(super) fn new(source: impl Read + 'a, format: &FileFormat) -> Result<Self, ForeignError> {
        let mut source = decoded(source).map_err(ForeignError::unreadable)?;
        for _ in 0..format.skip_lines {
            source.skip_until(b'\n').map_err(ForeignError::unreadable)?;
        }
        let comment = format.comment.as_ref().and_then(|text| text.bytes().next());
        let separator = format.separator_byte();
        let reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .delimiter(separator.unwrap_or(b' '))
            .quoting(separator.is_some())
            .comment(comment)
            .from_reader(source);
        Ok(Self {
            reader,
            record: csv::ByteRecord::new(),
            skipped: format.skip_lines,
            blanks: separator.is_none(),
            comment,
        })
    }

    /// Returns the next row that is not empty.
    pub(super) fn next(&mut self) -> Result<Option<(usize, Vec<String>)>, ForeignError> {
        let unreadable = ForeignError::unreadable;
        while (self.reader.read_byte_record(&mut self.record)).map_err(unreadable)? {
            let mut cells = Vec::new();
            for cell in &self.record {
                // Old exports are Latin-1: names and units may contain invalid UTF-8.
                let cell = String::from_utf8_lossy(cell);
                if self.blanks {
                    cells.extend(cell.split_whitespace().map(str::to_owned));
                } else {
                    cells.push(cell.into_owned());
                }
            }
            let first = cells.first().and_then(|cell| cell.bytes().next());
            let is_comment = self.blanks && first.is_some() && first == self.comment;
            if !cells.is_empty() && !is_comment {
                let line = self.record.position().map_or(0, csv::Position::line);
                return Ok(Some((line as usize + self.skipped, cells)));
            }
        }
        Ok(None)
    }

    pub(super) fn header(&mut self, format: &FileFormat) -> Result<Header, ForeignError> {
        if !format.header {
            return Ok(Header {
                names: (1..=MOST_COLUMNS)
                    .map(|number| number.to_string())
                    .collect(),
                places: HashMap::new(),
            });
        }
        let (_, cells) = self.next()?.unwrap_or_default();
        for _ in 0..format.lines_after_header {
            self.next()?;
        }
        let clean = |name: &String| {
            let name = name.trim().trim_matches('"');
            name.trim().to_owned()
        };
        let names: Vec<String> = cells.iter().map(clean).collect();
        let mut places: HashMap<String, (usize, Option<usize>)> = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            let known = places.entry(name.clone());
            let place = known.and_modify(|(_, second)| {
                second.get_or_insert(index);
            });
            place.or_insert((index, None));
        }
        Ok(Header { names, places })
    }
}

/// Names of the file's columns.
pub(super) struct Header {
    pub(super) names: Vec<String>,
    /// Index of each name's first column and of its second; empty without a header, where columns have numbers only.
    places: HashMap<String, (usize, Option<usize>)>,
}

impl Header {
    pub(super) fn name(&self, index: usize) -> String {
        let name = self.names.get(index).cloned();
        name.unwrap_or_else(|| (index + 1).to_string())
    }

    /// Returns the index of a column; `None` if missing.
    pub(super) fn find(
        &self,
        key: &str,
        column: &ColumnRef,
    ) -> Result<Option<usize>, ForeignError> {
        match column {
            ColumnRef::Name(name) => match self.places.get(name.trim()) {
                Some((first, Some(second))) => Err(ForeignError(format!(
                    "`{key}`: the columns {} and {} are both called `{}`; write the number of the one that is meant in the place of \
                     its name",
                    first + 1,
                    second + 1,
                    short(name)
                ))),
                known => Ok(known.map(|(first, _)| *first)),
            },
            ColumnRef::Number(number) => {
                let index = number.checked_sub(1);
                Ok(index.filter(|index| *index < self.names.len()))
            }
        }
    }

    pub(super) fn place(&self, key: &str, column: &ColumnRef) -> Result<usize, ForeignError> {
        self.find(key, column)?.ok_or_else(|| {
            let names = self.names.iter().map(|name| format!("`{}`", short(name)));
            let there = match names.collect::<Vec<_>>() {
                none if none.is_empty() => "none: check file.separator".to_owned(),
                names => first_of(&names, 12, ", "),
            };
            ForeignError(format!(
                "`{key}`: the file has no column `{column}`; it has {there}"
            ))
        })
    }

    /// Returns the first numbered column of a pattern whose number is outside of `numbers`.
    pub(super) fn outside(
        &self,
        pattern: &ColumnRef,
        numbers: &std::ops::Range<usize>,
    ) -> Option<&str> {
        let ColumnRef::Name(pattern) = pattern else {
            return None;
        };
        let (head, tail) = pattern.trim().split_once('*')?;
        let number = |name: &str| {
            let digits = name.strip_prefix(head)?.strip_suffix(tail)?;
            let number: usize = digits.parse().ok()?;
            (number.to_string() == digits).then_some(number)
        };
        let mut names = self.names.iter().map(String::as_str);
        names.find(|name| number(name).is_some_and(|number| !numbers.contains(&number)))
    }
}
