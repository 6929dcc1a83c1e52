//! Evidence for each item that a user brought: a solver, a record, a limit; without any, for the engines together.
//!
//! Exit status 0 requires it: a comparison without evidence for an item has not passed.

use serde::Serialize;

/// Kind of the item of a [`Finding`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Solver of the user's.
    Solver,
    /// Record: another program's export, a test rig's log.
    Record,
    /// Limit in a record's map.
    Limit,
    /// All engines together, where the user brought no data or engine.
    Engines,
}

/// Outcome of a [`Finding`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Shown {
    /// Agreement with another participant in the quantities listed.
    Agrees,
    /// Difference in the quantity listed.
    Differs,
    /// Neither agreement nor difference in any deciding quantity.
    Nothing,
}

/// Item that the user brought, with the evidence for or against it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Finding {
    /// Name of the participant, or of the limit.
    pub name: String,
    /// Kind of the item.
    pub kind: Kind,
    /// Outcome.
    pub shown: Shown,
    /// Names of the quantities that agree, or of the one that differs most.
    pub quantities: Vec<String>,
    /// Relative bound that all agreeing quantities respect; `None` where nothing agrees.
    pub agrees_to: Option<f64>,
    /// Contribution to the program's exit status: 0, 1 or 4.
    pub status: u8,
    /// Sentence for readers, which begins with the name.
    pub line: String,
}

/// Name and kind of the item of a finding.
pub(crate) struct Named<'a> {
    pub(crate) name: &'a str,
    pub(crate) kind: Kind,
}

impl Named<'_> {
    fn finding(&self, shown: Shown, words: &str, status: u8) -> Finding {
        Finding {
            name: self.name.to_owned(),
            kind: self.kind,
            shown,
            quantities: Vec::new(),
            agrees_to: None,
            status,
            line: format!("{}: {words}", self.name),
        }
    }

    pub(crate) fn agrees(
        &self,
        quantities: Vec<String>,
        bound: f64,
        what: &str,
        status: u8,
    ) -> Finding {
        let words = format!("agrees to {bound:.1e} ({what})");
        Finding {
            quantities,
            agrees_to: Some(bound),
            ..self.finding(Shown::Agrees, &words, status)
        }
    }

    pub(crate) fn differs(&self, quantities: Vec<String>, what: &str, status: u8) -> Finding {
        Finding {
            quantities,
            ..self.finding(Shown::Differs, &format!("differs ({what})"), status)
        }
    }

    pub(crate) fn nothing(&self, why: &str) -> Finding {
        self.finding(Shown::Nothing, &format!("nothing shown: {why}"), 4)
    }
}
