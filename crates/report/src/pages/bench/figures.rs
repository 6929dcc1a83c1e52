//! Costs and errors as text, for the terminal and the page.

use crate::format::{seconds, significant};
use pinwheel_studies::bench::{Advantage, CostAt, Series, Stopped};
use pinwheel_timeseries::Ending;
use pinwheel_timeseries::table::{Mark, TableOf};

/// Returns the sign of a bound, or nothing.
fn sign(cost: CostAt) -> &'static str {
    match cost {
        CostAt::Interpolated(_) => "",
        CostAt::AtMost(_) => "\u{2264}\u{202f}",
        CostAt::MoreThan(_) => ">\u{202f}",
    }
}

/// Returns the sign of a lead that is a bound, or nothing.
pub(super) fn at_least(lead: &Advantage) -> &'static str {
    match lead.at_least {
        true => "\u{2265}\u{202f}",
        false => "",
    }
}

/// Formats a CPU time with its bound's sign.
pub(super) fn cpu(cost: CostAt) -> String {
    format!("{}{}", sign(cost), seconds(cost.value()))
}

/// Formats a count with its bound's sign.
pub(super) fn count(cost: CostAt) -> String {
    format!("{}{}", sign(cost), calls(cost.value()))
}

/// Formats a number of calls: `950`, `22.6 k`, `1.2 M`.
pub(super) fn calls(value: f64) -> String {
    if value >= 1e6 {
        format!("{}\u{202f}M", significant(value / 1e6, 3))
    } else if value >= 1e3 {
        format!("{}\u{202f}k", significant(value / 1e3, 3))
    } else {
        format!("{value:.0}")
    }
}

/// Adds a column of costs to a ranking; bounds are muted.
pub(super) fn column<R>(
    table: TableOf<R>,
    label: &str,
    words: fn(CostAt) -> String,
    of: impl Fn(&R) -> Option<CostAt>,
) -> TableOf<R> {
    table
        .number("", label, |row| of(row).map(CostAt::value))
        .display(|row| of(row).map(words))
        .marked(|row| match of(row) {
            Some(cost) if cost.reached() => Mark::None,
            _ => Mark::Muted,
        })
}

/// Returns the reason for a series without a finished point; `None` if it has one.
pub fn failure(series: &Series) -> Option<String> {
    if series.points.iter().any(|of| of.ending == Ending::Finished) {
        return None;
    }
    let last = series.points.last().map(|point| &point.ending);
    Some(match last {
        Some(Ending::Diverged { time_s, quantity }) => {
            format!("diverges at every step; at the finest at {time_s:.4} s: {quantity}")
        }
        Some(Ending::TimedOut { time_s, .. }) => {
            format!("takes too long: {time_s:.4} s simulated when it was given up")
        }
        Some(
            Ending::Failed { reason } | Ending::Unsupported { reason } | Ending::Absent { reason },
        ) => reason.clone(),
        Some(Ending::Finished) | None => match series.stopped {
            Stopped::Interrupted => "stopped by the user".to_owned(),
            other => other.words().to_owned(),
        },
    })
}

/// Returns the reason for the end of a series.
pub(super) fn end(series: &Series) -> String {
    failure(series).unwrap_or_else(|| series.stopped.words().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_in_words() {
        assert_eq!(cpu(CostAt::Interpolated(0.0213)), "21.3\u{202f}ms");
        assert_eq!(cpu(CostAt::MoreThan(20.0)), ">\u{202f}20\u{202f}s");
        assert_eq!(
            count(CostAt::AtMost(22_579.0)),
            "\u{2264}\u{202f}22.6\u{202f}k"
        );
        assert_eq!(count(CostAt::Interpolated(1.234e6)), "1.23\u{202f}M");
    }
}
