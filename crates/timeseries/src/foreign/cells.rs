//! Cells of a foreign file as numbers and clock times.

use super::error::short;
use super::map::FileFormat;

/// Parses a number in the file's format, or returns the reason why it is none.
pub(super) fn number(text: &str, format: &FileFormat) -> Result<f64, String> {
    let comma = format.decimal == ",";
    let parsed = |text: &str| text.parse::<f64>().ok().filter(|value| value.is_finite());
    if let Some(value) = parsed(text).filter(|_| !comma) {
        return Ok(value);
    }
    let decimal = if comma { ',' } else { '.' };
    let shown = short(text);
    let plain = match format.thousands.as_deref() {
        None if comma && text.contains('.') => {
            return Err(format!(
                "`{shown}` has a point where file.decimal is a comma: write thousands = \".\" or decimal = \".\" under [file]"
            ));
        }
        None => text.to_owned(),
        Some(mark) => {
            let is_mark = |c: char| match mark {
                " " => c.is_whitespace(),
                "'" => ['\'', '\u{2019}'].contains(&c),
                _ => mark.contains(c),
            };
            let (number, rest) = text.split_at(text.find(decimal).unwrap_or(text.len()));
            let first = number.find(is_mark).unwrap_or_default();
            let mut groups = number.split(is_mark).skip(1);
            let first = number[..first].trim_start_matches(['+', '-']).len();
            if rest.contains(is_mark) || first > 3 || !groups.all(|group| group.len() == 3) {
                return Err(format!("`{shown}` has marks of thousands elsewhere"));
            }
            number.replace(is_mark, "") + rest
        }
    };
    // Fortran writes 1.5D-03 for a double, and some spreadsheets a minus sign that is no hyphen.
    let plain = plain.replace(decimal, ".").replace(['D', 'd'], "E");
    let plain = plain.replace('\u{2212}', "-");
    parsed(&plain).ok_or_else(|| {
        if text.contains(':') {
            format!("`{shown}` is no clock time as it is read: write hh:mm:ss.fff, or seconds")
        } else if parsed(&text.replace(',', "")).is_some() {
            format!(
                "`{shown}` has a comma where file.decimal is a point: write decimal = \",\" or thousands = \",\" under [file]"
            )
        } else {
            format!("`{shown}` is not a number")
        }
    })
}

/// Returns the seconds since midnight of a clock time `hh:mm:ss.fff`, optionally after a date.
pub(super) fn clock(text: &str) -> Option<f64> {
    let text = text.strip_suffix('Z').unwrap_or(text);
    let (_, time) = text.rsplit_once([' ', 'T']).unwrap_or(("", text));
    let mut parts = time.split(':');
    let (hours, minutes, seconds) = (parts.next()?, parts.next()?, parts.next()?);
    let number = |text: &str| text.parse::<u16>().ok().map(f64::from);
    let (hours, minutes) = (number(hours)?, number(minutes)?);
    let seconds: f64 = seconds.replace(',', ".").parse().ok()?;
    let sound = parts.next().is_none() && minutes < 60.0 && (0.0..61.0).contains(&seconds);
    sound.then_some(3600.0 * hours + 60.0 * minutes + seconds)
}
