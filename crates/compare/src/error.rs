//! Errors that make a comparison impossible.

/// Faults of [`compare`](crate::compare). Participants that cannot be judged are no error: they get a verdict with its reason.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// Two engines' sample times differ. Time series are never interpolated: that fakes errors of 1e-3.
    #[error(
        "sample {row} of `{b}` is at {time_b} s, of `{a}` at {time_a} s: write both on one grid"
    )]
    Grid {
        /// First engine.
        a: String,
        /// Second engine.
        b: String,
        /// Sample number, the first being 0.
        row: usize,
        /// Time of the first engine's sample, s.
        time_a: f64,
        /// Time of the second engine's sample, s.
        time_b: f64,
    },
    /// Two engines have a different number of samples on an otherwise equal grid.
    #[error(
        "`{a}` has {samples_a} samples and `{b}` {samples_b}; they differ after {time_s} s: write both on one grid"
    )]
    Samples {
        /// First engine.
        a: String,
        /// Second engine.
        b: String,
        /// Samples of the first engine.
        samples_a: usize,
        /// Samples of the second engine.
        samples_b: usize,
        /// Last time both have, s (-infinity if there is none).
        time_s: f64,
    },
    /// Two participants of one name.
    #[error("engine `{0}` appears twice: name each engine once")]
    Duplicate(String),
    /// Evidence for an unknown participant, or two for one.
    #[error("evidence is given for `{0}`, which does not take part or has evidence already")]
    Evidence(String),
    /// Stated limit without a matching comparison.
    #[error(
        "the limit on `{quantity}` in the {window} window of `{engine}` matches nothing; there are {available}"
    )]
    Unmatched {
        /// Participant to which the limit applies.
        engine: String,
        /// Window of the limit.
        window: &'static str,
        /// Quantity of the limit, a pattern.
        quantity: String,
        /// Available windows and quantities, in words.
        available: String,
    },
    /// No participant.
    #[error("no engine to compare: name at least one")]
    Empty,
}
