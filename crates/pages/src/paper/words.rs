//! Verdicts in words and marks.

use pinwheel_report::study::Mark;
use pinwheel_studies::paper::claims::Verdict;

/// Of a figure.
pub(super) fn figure(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "shown",
        Verdict::Conditional => "shown under a condition",
        Verdict::DoesNotHold => "not shown",
        Verdict::Meaningless => "no meaning",
    }
}

/// Of a claim.
pub(super) fn claim(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Holds => "holds",
        Verdict::Conditional => "holds under a condition",
        Verdict::DoesNotHold => "does not hold",
        Verdict::Meaningless => "has no meaning",
    }
}

/// True, false, or neither.
pub(super) fn good(verdict: Verdict) -> Option<bool> {
    match verdict {
        Verdict::Holds => Some(true),
        Verdict::DoesNotHold => Some(false),
        Verdict::Conditional | Verdict::Meaningless => None,
    }
}

pub(super) fn mark(verdict: Verdict) -> Mark {
    match verdict {
        Verdict::Holds => Mark::Good,
        Verdict::DoesNotHold => Mark::Bad,
        Verdict::Conditional => Mark::Warn,
        Verdict::Meaningless => Mark::Muted,
    }
}
