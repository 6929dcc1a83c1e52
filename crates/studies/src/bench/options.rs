//! Choices of a bench.

use pinwheel_engines::SharedModel;
use pinwheel_mbs::integrators::METHODS;
use pinwheel_scene::did_you_mean;
use serde::Serialize;

use crate::StudyError;

/// Choices of a bench.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Options {
    /// Relative L2 force error over the entire run at which engines are ranked.
    pub target: f64,
    /// Largest number of runs of one setting; the cost is their minimum and median.
    pub repeats: usize,
    /// CPU time above which a setting is not repeated, s.
    pub repeat_s: f64,
    /// CPU time limit of a single run of a foreign engine, s.
    pub longest_s: f64,
    /// CPU time limit of a single native run, s; the native solver has many more series.
    pub longest_native_s: f64,
    /// Integrators of the native solver; empty for all.
    pub methods: Vec<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            target: 1e-4,
            repeats: 5,
            repeat_s: 1.0,
            longest_s: 20.0,
            longest_native_s: 2.0,
            methods: Vec::new(),
        }
    }
}

impl Options {
    /// Makes options from a user's choices: error of the ranking, runs of a setting, CPU seconds of a peer's run (a tenth for
    /// the native solver), and integrators.
    ///
    /// # Errors
    /// A number out of range, or an unknown integrator.
    pub fn asked(
        target: f64,
        repeats: usize,
        longest_s: f64,
        methods: Vec<String>,
    ) -> Result<Self, StudyError> {
        for (name, value) in [("target", target), ("longest", longest_s)] {
            if !(value > 0.0 && value.is_finite()) {
                return Err(StudyError::Input(format!(
                    "{name}: {value} is not a positive number; leave it out for the default"
                )));
            }
        }
        if repeats == 0 {
            return Err(StudyError::Input(
                "repeats: 0 measures nothing; use 1 or more".to_owned(),
            ));
        }
        let known: Vec<&str> = METHODS.iter().map(|method| method.name).collect();
        if let Some(name) = methods.iter().find(|name| !known.contains(&name.as_str())) {
            let remedy = did_you_mean(name, &known);
            let what = format!("there is no integrator `{name}`; {remedy}");
            return Err(StudyError::Input(what));
        }
        Ok(Self {
            target,
            repeats,
            longest_s,
            longest_native_s: 0.1 * longest_s,
            methods,
            ..Self::default()
        })
    }

    /// Returns the CPU time limit of a single run of an engine, s.
    pub fn longest(&self, track: SharedModel) -> f64 {
        match track {
            SharedModel::Native => self.longest_native_s,
            _ => self.longest_s,
        }
    }
}
