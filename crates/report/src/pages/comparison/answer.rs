//! Answers to a reader's questions on a comparison: force, confidence, differing engines with the cause, next step. Page
//! and terminal have equal content.

use std::collections::{BTreeMap, BTreeSet};

use crate::figure::shown;
use crate::format::{grouped, joined, significant};
use crate::study::{Decision, Fact, Mark, Question, Tone, Verdict};
use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::shown::{Finding, Kind, Shown};
use pinwheel_compare::{
    Assessment, Comparison, SharedModel, Status, Verdict as Judged, quantities,
};
use pinwheel_engines::{Form, info, known, lacking, remedies, remedy};
use pinwheel_studies::Provenance;
use pinwheel_studies::band::declined;
use pinwheel_studies::comparison::{Largest, MatchedContactRun, Outcome};

use super::figures::{best, figures, numerical};
use super::stages;
use super::twins::{self, percent};
use super::words;
use crate::pages::{self, band};

/// Format of shares for a page or a terminal.
pub(super) type Number = fn(f64) -> String;

/// Answers of a comparison.
pub(super) struct Answer<'a> {
    pub(super) outcome: &'a Outcome,
    number: Number,
}

impl<'a> Answer<'a> {
    pub(super) fn new(outcome: &'a Outcome, number: Number) -> Self {
        Self { outcome, number }
    }

    pub(super) fn comparison(&self) -> &'a Comparison {
        &self.outcome.comparison
    }

    /// Returns the verdict with the main figure, and the counts of all verdicts.
    pub(super) fn verdict(&self) -> Verdict {
        let (tone, word, main) = self.judged();
        Verdict {
            tone,
            headline: match main.as_str() {
                "" => word,
                main => format!("{word}: {main}"),
            },
            detail: words::counts(self.comparison()),
        }
    }

    /// Returns the evidence for each input of the user, or for the engines together, a line each. Limits that are met are
    /// part of their record's line.
    pub(super) fn shown(&self) -> Vec<Fact> {
        let findings = self.outcome.comparison.findings.iter();
        let findings = findings.filter(|one| one.kind != Kind::Limit || one.shown != Shown::Agrees);
        let fact = |one: &Finding| {
            let mark = match (one.shown, one.status) {
                (_, 1) => Mark::Bad,
                (Shown::Agrees, 0) if self.scope().is_none() => Mark::Good,
                _ => Mark::Warn,
            };
            match one.line.strip_prefix(&format!("{}: ", one.name)) {
                Some(words) if one.kind != Kind::Limit => Fact::new(one.name.as_str(), mark, words),
                _ => Fact::new("limit", mark, one.line.as_str()),
            }
        };
        let stages = stages::facts(self.outcome);
        findings.map(fact).chain(stages).collect()
    }

    /// Returns a limitation of an agreement: only native engines agree, or all share the contact law.
    fn scope(&self) -> Option<&'static str> {
        let agreeing = self.entries(|_| true);
        let agreeing = agreeing.filter(|(_, entry)| entry.result.verdict == Judged::Agree);
        let tracks: BTreeSet<SharedModel> = agreeing.map(|(pair, _)| pair.track).collect();
        let independent = [SharedModel::OwnContact, SharedModel::Measured];
        let mut twins = self.outcome.twins.iter();
        if twins.any(|twin| twin.verdict == Judged::Agree)
            || independent.iter().any(|track| tracks.contains(track))
        {
            return None;
        }
        Some(match tracks.contains(&SharedModel::SharedLaw) {
            true => "one contact law, shared by all engines that agree",
            false => "our own engines alone",
        })
    }

    /// Returns the tone, the verdict in a word or two, and its figure or difference. The tone is good only if engines
    /// beyond one shared contact law agree, and no difference is unexplained.
    pub(super) fn judged(&self) -> (Tone, String, String) {
        let outcome = self.outcome;
        let mut twins = outcome.twins.iter();
        if let Some(twin) = twins.find(|twin| twin.verdict == Judged::Differ) {
            let off = twin.worst().map(|worst| percent(worst.difference()));
            let (engine, off) = (words::short(&twin.engine), off.unwrap_or_default());
            let detail = format!("{engine} is {off} from a native run with the same contacts");
            return (Tone::Bad, "Differs".to_owned(), detail);
        }
        let (tone, word) = self.of_engines();
        if tone == Tone::Good && outcome.is_unexplained() {
            let largest = outcome.largest().map(|largest| self.apart(&largest));
            let detail = largest.unwrap_or_default();
            return (Tone::Open, "Not confirmed".to_owned(), detail);
        }
        let detail = self.worst(Judged::Differ, |_| true);
        let detail = detail.or_else(|| self.unbalanced());
        let detail = detail.unwrap_or_else(|| self.first_figure());
        if let (Tone::Good, Some(scope)) = (tone, self.scope()) {
            return (Tone::Open, format!("{word}, {scope}"), detail);
        }
        (tone, word, detail)
    }

    /// Returns the verdict of the engines, without limitations. An engine excluded beforehand does not count as broken.
    fn of_engines(&self) -> (Tone, String) {
        let comparison = &self.outcome.comparison;
        let engines = || comparison.engines.iter();
        let broken = engines().filter(|e| e.status.is_broken()).count();
        let finished = engines().any(|e| e.status.is_finished());
        let (tone, word) = match (comparison.exit_status(), broken) {
            _ if !finished => (Tone::Open, "No engine could run this scene"),
            (1, _) => (Tone::Bad, "Differs"),
            (_, 1) => (Tone::Bad, "1 engine did not finish"),
            (_, 2..) => return (Tone::Bad, format!("{broken} engines did not finish")),
            (0, _) => (Tone::Good, "Pass"),
            _ => (Tone::Open, "Not confirmed"),
        };
        (tone, word.to_owned())
    }

    fn first_figure(&self) -> String {
        let figures = figures(self.outcome);
        let forces = figures.iter().filter(|figure| figure.def.unit == "N");
        let forces: Vec<String> = forces.map(|figure| shown(figure).0).collect();
        match forces.as_slice() {
            [external, internal] => {
                format!("largest pin force {external} N external, {internal} N internal")
            }
            _ => String::new(),
        }
    }

    /// Returns the number of engines that agree with another one on the scene's law, and of their programs.
    fn agreeing(&self) -> (usize, usize) {
        let agree = self.entries(SHARES);
        let agree = agree.filter(|(_, entry)| entry.result.verdict == Judged::Agree);
        let engines = agree.flat_map(|(pair, _)| [pair.a.as_str(), pair.b.as_str()]);
        let engines: BTreeSet<&str> = engines.collect();
        let programs = engines.iter().map(|name| pinwheel_engines::family(name));
        let programs = programs.collect::<BTreeSet<&str>>().len();
        (engines.len(), programs)
    }

    /// Returns e.g. `ring pin force 479 N here, 303 N by rapier-colliders`.
    fn apart(&self, most: &Largest<'_>) -> String {
        let (label, unit) = quantities::label_and_unit(most.quantity);
        let [here, there] = [most.here, most.there].map(|value| significant(value, 3));
        let by = words::short(most.engine);
        let label = label.to_lowercase();
        format!("{label} {here} {unit} here, {there} by {by}")
    }

    /// Returns the tiles of the decision; `origin`: command of this page, which the next command follows.
    pub(super) fn decision(&self, origin: &Provenance) -> Decision {
        let (tone, ..) = self.judged();
        let mark = match tone {
            Tone::Good => Mark::Good,
            Tone::Bad => Mark::Bad,
            Tone::Neutral | Tone::Open => Mark::Warn,
        };
        let answer = self.equations().text;
        let (answer, why) = answer.split_once([';', ':']).unwrap_or((&answer, ""));
        let right = Question::Right.answered(mark, answer, why.trim_start());
        let next = match self.open().first() {
            None => pages::next(origin, "design", "stiffness, lost motion, pressure"),
            Some(first) => Question::Next.answered(Mark::Warn, "settle this first", first),
        };
        let bears = self.outcome.limits.as_ref().map(pages::design::bears);
        let sure = pages::sure(&figures(self.outcome));
        [Some(right), bears, sure, Some(next)]
    }

    /// Returns the facts on trust: equations, integration, contacts, law, fit, measurement and changes to the measured
    /// data.
    pub(super) fn trust(&self) -> Vec<Fact> {
        let mut facts = vec![self.equations()];
        let unbalanced = self.unbalanced();
        facts.extend(unbalanced.map(|text| Fact::new("balance", Mark::Bad, text)));
        facts.extend(self.integration());
        facts.push(self.contacts());
        facts.extend(self.difference());
        facts.extend(self.law());
        facts.extend(self.measured());
        let notes = words::of_measured(&self.outcome.comparison);
        facts.extend(notes.map(|note| Fact::new(DATA, Mark::None, note)));
        facts
    }

    /// Returns the entries of the pairs that `of` accepts.
    fn entries(
        &self,
        of: impl Fn(&Pair) -> bool,
    ) -> impl Iterator<Item = (&'a Pair, &'a PairEntry)> {
        let pairs = self.outcome.comparison.pairs.iter();
        words::entries(pairs.filter(move |pair| of(pair)))
    }

    /// Returns the pair of a verdict with the largest difference: `reduced and exudyn-constrained, output pin force: D =
    /// 2e-4, U = 4e-3`.
    fn worst(&self, verdict: Judged, of: impl Fn(&Pair) -> bool) -> Option<String> {
        let entries = self.entries(of);
        let entries = entries.filter(|(_, entry)| entry.result.verdict == verdict);
        let worst = entries.max_by(|(_, a), (_, b)| size(&a.result).total_cmp(&size(&b.result)));
        let (pair, entry) = worst?;
        let result = &entry.result;
        let [a, b] = [&pair.a, &pair.b].map(|name| words::short(name));
        let label = self.label(entry);
        let bound = match (result.combined(), result.bound) {
            (Some(u), _) => format!(", U = {}", (self.number)(u)),
            (None, Some(limit)) => format!(", limit {}", (self.number)(limit)),
            _ => String::new(),
        };
        let d = (self.number)(size(result));
        Some(format!("{a} and {b}, {label}: D = {d}{bound}"))
    }

    /// Returns an entry's quantity for a sentence.
    fn label(&self, entry: &PairEntry) -> String {
        words::label(&self.outcome.comparison, &entry.quantity).to_lowercase()
    }

    fn equations(&self) -> Fact {
        let fact = |mark, text| Fact::new(EQUATIONS, mark, text);
        if let Some(worst) = self.worst(Judged::Differ, SHARES) {
            return fact(Mark::Bad, format!("they differ: {worst}"));
        }
        let Some(worst) = self.worst(Judged::Agree, SHARES) else {
            let text = "no agreement yet: no two engines with the scene's law were compared";
            return fact(Mark::Warn, text.to_owned());
        };
        let (engines, programs) = self.agreeing();
        let agree = match programs {
            1 => format!("{engines} solvers of our own agree; no other program. At"),
            n => format!("{engines} engines of {n} programs agree; at"),
        };
        fact(Mark::good(programs != 1), format!("{agree} most {worst}"))
    }

    /// Returns engines whose output torque and load do not match the output's acceleration.
    fn unbalanced(&self) -> Option<String> {
        let engines = self.outcome.comparison.engines.iter();
        let alone = engines.flat_map(|e| e.judged.iter().map(move |entry| (e, &entry.result)));
        let off = alone.filter(|(_, result)| result.verdict == Judged::Differ);
        let worst = off.clone().map(|(_, result)| result);
        let worst = worst.max_by(|a, b| size(a).total_cmp(&size(b)))?;
        let names: BTreeSet<&str> = off.map(|(e, _)| words::short(&e.name)).collect();
        Some(format!(
            "{}: output torque and load do not give the output its acceleration, by {} (limit {})",
            joined(", ", names),
            (self.number)(size(worst)),
            (self.number)(worst.bound.unwrap_or_default())
        ))
    }

    fn integration(&self) -> Option<Fact> {
        let comparison = &self.outcome.comparison;
        let (best, window) = best(comparison)?;
        let off = |engine: &EngineSummary| numerical(comparison, engine, window);
        let fact = |mark, text: &str| Some(Fact::new("integration", mark, text));
        let Some(own) = off(best) else {
            let unknown = "how far the runs are from the exact solution is not known";
            return fact(Mark::Warn, unknown);
        };
        let (name, within) = (&best.name, (self.number)(own));
        let mut text =
            format!("{name} is within {within} of the exact solution, by its coarser runs");
        // The scene's method and step.
        let form = |e: &&EngineSummary| info(&e.name).and_then(|info| info.form);
        let mut scene = comparison.engines.iter();
        let scene = scene.find(|e| matches!(form(e), Some(Form::Reduced | Form::Lagrange)));
        let scene = scene.filter(|e| e.name != best.name);
        if let Some((engine, off)) = scene.and_then(|e| Some((&e.name, off(e)?))) {
            let off = (self.number)(off);
            text += &format!("; the scene's own step ({engine}) {off}");
        }
        fact(Mark::good(own <= comparison.resolution), &text)
    }

    fn contacts(&self) -> Fact {
        let fact = |mark, text| Fact::new("contacts", mark, text);
        let differ = |twin: &&MatchedContactRun| twin.verdict == Judged::Differ;
        let mut twins = self.outcome.twins.iter();
        if let Some(line) = twins.find(differ).and_then(twins::line) {
            return fact(Mark::Bad, line);
        }
        let mut parts = Vec::new();
        let twins = self.outcome.twins.iter();
        let twins = twins.filter(|twin| twin.verdict == Judged::Agree);
        let twins = twins.filter_map(|twin| {
            let off = percent(twin.worst()?.difference());
            Some(format!("{} {off}", words::short(&twin.engine)))
        });
        let twins = joined(", ", twins);
        if !twins.is_empty() {
            parts.push(format!("{twins} from native runs with the same contacts"));
        }
        let without_twin = |pair: &Pair| {
            let mut twins = self.outcome.twins.iter();
            !twins.any(|twin| twin.engine == pair.a || twin.engine == pair.b)
        };
        let alike = self.worst(Judged::Agree, |pair| {
            pair.track == SharedModel::OwnContact && without_twin(pair)
        });
        parts.extend(alike.map(|worst| format!("agree: {worst}")));
        if !parts.is_empty() {
            return fact(Mark::Good, parts.join("; "));
        }
        let mut engines = self.outcome.comparison.engines.iter();
        let has_own = engines.any(|e| e.track == SharedModel::OwnContact && e.status.is_finished());
        let text = match has_own {
            true => START_UP,
            false => "not checked: no engine with contacts of its own took part",
        };
        fact(Mark::Warn, text.to_owned())
    }

    /// Returns the largest difference, judged or not.
    fn difference(&self) -> Option<Fact> {
        let most = self.outcome.largest()?;
        let why = match most.twin {
            _ if most.share() < SEEN || most.verdict == Some(Judged::Agree) => String::new(),
            Some(twin) if most.is_explained() => {
                format!(": {}, a difference of models", twin.contacts)
            }
            Some(_) => ": its own contacts do not explain it".to_owned(),
            None if most.verdict == Some(Judged::Inconclusive) => {
                ": unexplained and not resolved".to_owned()
            }
            None => ": unexplained".to_owned(),
        };
        let mark = Mark::warn(!(most.is_explained() || most.share() < SEEN));
        let share = (self.number)(most.share());
        let text = format!("{} ({share}){why}", self.apart(&most));
        Some(Fact::new("differs most", mark, text))
    }

    fn law(&self) -> Vec<Fact> {
        let scene = &self.outcome.gearbox.scene;
        let Some(bands) = &self.outcome.bands else {
            let why = declined(scene);
            let why = why.unwrap_or("the gear cannot be balanced, or has no load");
            let text = format!("no band: {why}");
            return vec![Fact::new("contact law", Mark::Muted, text)];
        };
        let outside = band::outside(bands);
        let mark = Mark::warn(outside.is_some());
        let within = "is within its band: a spread of models, not validated";
        let text = outside.unwrap_or_else(|| match bands.declined {
            Some(_) => band::about(bands),
            None => format!("{} {within}", bands.own),
        });
        let law = Fact::new("contact law", mark, text);
        let gear = &scene.gear;
        let stated = bands.tolerances.is_some()
            || gear.modification.equidistant_m != 0.0
            || gear.backlash_m != 0.0;
        let fit = band::fit(bands).map(|text| match stated {
            true => Fact::new("fit", Mark::None, text),
            false => Fact::new("fit", Mark::Warn, format!("none given: {text}")),
        });
        [law].into_iter().chain(fit).collect()
    }

    fn measured(&self) -> Option<Fact> {
        let pairs = || self.entries(|pair| pair.track == SharedModel::Measured);
        let (mut pair, mut entry) = Assessment::gravest(pairs(), |(_, entry)| &entry.result)?;
        let mut verdict = words::verdict(&entry.result, self.number);
        // Without an uncertainty the distance is still available.
        let apart = |entry: &PairEntry| entry.metrics.as_ref()?.relative_l2;
        if entry.result.verdict == Judged::NotCompared {
            let pairs = pairs().filter_map(|(pair, entry)| Some((pair, entry, apart(entry)?)));
            if let Some((of, farthest, l2)) = pairs.max_by(|a, b| a.2.total_cmp(&b.2)) {
                (pair, entry) = (of, farthest);
                let place = self.label(entry);
                let apart = (self.number)(l2);
                verdict = format!("{verdict}; at most {apart} apart (relative L2, {place})");
            }
        }
        let [a, b] = [&pair.a, &pair.b].map(|name| words::short(name));
        let mark = Mark::good(entry.result.verdict == Judged::Agree);
        let text = format!("{a} and {b}: {verdict}");
        Some(Fact::new("measurement", mark, text))
    }

    /// Returns facts on parts that were not checked, with the way to check them. At most `listed` reasons of engines without
    /// figures are listed one by one.
    pub(super) fn unchecked(&self, listed: usize) -> Vec<Fact> {
        let comparison = &self.outcome.comparison;
        let here = |name: &str| comparison.engines.iter().any(|engine| engine.name == name);
        let lacks: Vec<&str> = lacking().map(|info| info.name).collect();
        let mut absent: BTreeMap<String, Vec<&str>> = BTreeMap::new();
        for info in known().filter(|info| !here(info.name)) {
            let remedy = remedy(info).filter(|_| lacks.contains(&info.name));
            let why = match remedy {
                None => "not asked for; run it without `--engines`".to_owned(),
                Some(remedy) => format!("not here; {remedy}"),
            };
            absent.entry(why).or_default().push(info.name);
        }
        let mut facts = Vec::new();
        if self.measured().is_none() {
            let text = "nothing here is measured; `--against rig.csv --map rig.toml` would";
            facts.push(Fact::new("measurement", Mark::None, text));
        }
        for (why, names) in absent.into_iter().rev() {
            let text = format!("{}: {why}", families(&names));
            facts.push(Fact::new("engines", Mark::None, text));
        }
        let mut left_out = left_out(comparison);
        let more = left_out.split_off(listed.min(left_out.len()));
        if !more.is_empty() {
            let names = more.into_iter().flat_map(|(_, names)| names).collect();
            let why = "`--verbose` says why, or Engines on the page";
            left_out.push((why.to_owned(), names));
        }
        facts.extend(left_out_facts(&left_out));
        let recorded = comparison.engines.iter();
        let recorded = recorded.filter(|engine| engine.cost.recorded.is_some());
        let recorded: Vec<&str> = recorded.map(|engine| engine.name.as_str()).collect();
        if !recorded.is_empty() {
            let live = remedies().into_iter().rev().map(|(remedy, mut families)| {
                let all = recorded.iter().map(|name| pinwheel_engines::family(name));
                families.retain(|family| all.clone().any(|of| of == *family));
                match families.is_empty() {
                    true => String::new(),
                    false => format!("; {} live: {remedy}", joined(", ", families)),
                }
            });
            let text = format!(
                "{}: not run here but recorded before{}; Engines on the page says when and why",
                joined(", ", recorded.iter().map(|name| words::short(name))),
                live.collect::<String>()
            );
            facts.push(Fact::new("recorded", Mark::None, text));
        }
        facts.extend(kept(comparison));
        let counts = comparison.counts;
        if counts.inconclusive > counts.inconclusive_actionable {
            let groups = words::groups(comparison).join(", ");
            let (open, all) = (counts.inconclusive, counts.compared());
            let text = format!("{open} of {all} comparisons: {groups}");
            facts.push(Fact::new(UNRESOLVED, Mark::None, text));
        }
        facts
    }

    /// Returns facts on the next steps.
    pub(super) fn next(&self) -> Vec<Fact> {
        let mut next = self.open();
        if next.is_empty() {
            let design = "`pinwheel design` of this scene: stiffness, lost motion, pressure";
            next.push(design.to_owned());
        }
        let fact = |text| Fact::new("next", Mark::None, text);
        next.into_iter().map(fact).collect()
    }

    /// Returns the open questions of a comparison, each with a way to settle it.
    pub(super) fn open(&self) -> Vec<String> {
        let open = words::inconclusive(&self.outcome.comparison).into_iter();
        let open = open.map(|(who, why)| format!("{who}: {why}"));
        let mut next: Vec<String> = open.take(3).collect();
        let largest = self.outcome.largest();
        if let Some(most) = largest.filter(|_| self.outcome.is_unexplained()) {
            next.push(match most.twin {
                _ if most.measured && most.verdict == Some(Judged::Differ) => format!(
                    "find what the model leaves out of `{}`, or what is wrong with it: it differs by more than its tolerance",
                    most.engine
                ),
                _ if most.measured => format!(
                    "state in its map how far `{}` may be off (`uncertainty`): then it is judged",
                    most.engine
                ),
                Some(_) => format!(
                    "ask for more of `{}`: --longest 300; or leave it out",
                    most.engine
                ),
                None if stages::names(self.outcome, most.engine) => {
                    format!("correct that stage of `{}`; Stages on the page shows where", most.engine)
                }
                None => format!("refine `{}` or leave it out: --engines", most.engine),
            });
        }
        next
    }
}

/// Returns the programs of some engines, and the number of these.
fn families(names: &[&str]) -> String {
    let families = names.iter().map(|name| pinwheel_engines::family(name));
    let families = joined(", ", families.collect::<BTreeSet<&str>>());
    format!("{families} ({} engines)", names.len())
}

/// Returns the fact that runs come from an earlier command, with their engines and dates.
fn kept(comparison: &Comparison) -> Option<Fact> {
    let kept = comparison.engines.iter();
    let kept = kept.filter_map(|engine| Some((&*engine.name, engine.cost.kept.as_ref()?)));
    let kept: Vec<(&str, &String)> = kept.collect();
    let days = kept.iter().filter_map(|(_, of)| of.split(' ').next());
    let days: BTreeSet<&str> = days.collect();
    let days = match (days.first()?, days.last()?) {
        (first, last) if first == last => (*first).to_owned(),
        (first, last) => format!("{first} to {last}"),
    };
    let names: Vec<&str> = kept.iter().map(|(name, _)| *name).collect();
    let text = format!(
        "{}: not run now but kept, of {days}; Engines on the page names each; `--fresh` runs them",
        families(&names)
    );
    Some(Fact::new("kept", Mark::None, text))
}

/// Returns the reasons of engines without figures, with the engines of each.
pub(super) fn left_out(comparison: &Comparison) -> Vec<(String, Vec<&str>)> {
    let is_late = |engine: &&EngineSummary| matches!(engine.status, Status::TimedOut { .. });
    let late = comparison.engines.iter().filter(is_late).count();
    // Each needs another time, listed in its row of the page.
    let time = "timed out; Engines on the page says what each needs (`--longest SECONDS`)";
    let reasons = comparison.engines.iter().filter_map(|engine| {
        let reason = engine.status.reason()?;
        let reason = match late > 1 && is_late(&engine) {
            true => time.to_owned(),
            false => reason,
        };
        Some((reason, words::short(&engine.name)))
    });
    grouped(reasons)
}

/// Returns the reasons of excluded engines as facts.
pub(super) fn left_out_facts(left_out: &[(String, Vec<&str>)]) -> Vec<Fact> {
    let facts = left_out.iter().map(|(reason, names)| {
        // The label already contains this.
        let reason = reason.strip_prefix("left out: ").unwrap_or(reason);
        let text = format!("{}: {reason}", names.join(", "));
        Fact::new("left out", Mark::None, text)
    });
    facts.collect()
}

/// Label of the fact on engines that solve the scene's own law.
pub(super) const EQUATIONS: &str = "equations";
const START_UP: &str = "not checked: the run is all start-up, in which engines with contacts of their own damp otherwise";
/// Label of facts on changes to measured data.
pub(super) const DATA: &str = "data";
/// Selects pairs that solve the scene's law.
const SHARES: fn(&Pair) -> bool =
    |pair| matches!(pair.track, SharedModel::Native | SharedModel::SharedLaw);
/// Label of inconclusive verdicts without a possible action.
pub(super) const UNRESOLVED: &str = "not resolved";
/// Number of reasons listed one by one, if there is room.
pub(super) const MOST: usize = 2;
/// Least difference of models that the verdict names.
const SEEN: f64 = 0.03;

fn size(result: &Assessment) -> f64 {
    let off = |d: f64| (d - result.predicted).abs();
    result.difference.map_or(0.0, off)
}
