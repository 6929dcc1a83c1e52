//! Findings of a comparison: verdicts of pairs condensed to one line for each item that the user brought.

use std::collections::BTreeMap;

use crate::comparison::{EngineSummary, Pair, PairEntry};
use crate::judge::Judge;
use crate::limits::{StatedLimit, fits};
use crate::participant::SharedModel;
use crate::quantities::{INPUT_TORQUE, Quantity};
use crate::shown::{Finding, Kind, Named};
use crate::verdict::{Against, Assessment, Verdict};
use pinwheel_timeseries::columns::{EXTERNAL_FORCE, INTERNAL_FORCE};

/// Pair entries of one participant, each with the name of the other.
type Entries<'a> = Vec<(&'a str, &'a PairEntry)>;

/// Returns one finding for each participant of [`Rules::brought`] and each stated limit; without these, one for all engines.
pub(crate) fn of(engines: &[EngineSummary], pairs: &[Pair], judge: Judge<'_>) -> Vec<Finding> {
    let entries_of = |name: &str| -> Entries<'_> {
        let own = pairs.iter().filter_map(|pair| match name {
            _ if pair.a == name => Some((pair.b.as_str(), pair)),
            _ if pair.b == name => Some((pair.a.as_str(), pair)),
            _ => None,
        });
        own.flat_map(|(other, pair)| pair.entries.iter().map(move |entry| (other, entry)))
            .collect()
    };
    let Judge {
        rules, quantities, ..
    } = judge;
    let brought = engines.iter();
    let brought = brought.filter(|engine| rules.brought.contains(&engine.name.as_str()));
    let brought = brought.map(|one| participant(one, &entries_of(&one.name), quantities));
    let stated = rules.stated.iter();
    let stated = stated.map(|row| limit(row, &entries_of(&row.engine)));
    let mut findings: Vec<Finding> = brought.chain(stated).collect();
    if findings.is_empty() {
        findings.push(together(engines, pairs, judge));
    }
    findings
}

/// Evidence for a solver or a record.
fn participant(engine: &EngineSummary, entries: &Entries<'_>, quantities: &[Quantity]) -> Finding {
    let kind = match engine.track {
        SharedModel::Measured => Kind::Record,
        _ => Kind::Solver,
    };
    let of = |verdict| {
        let entries = entries.iter().copied();
        entries.filter(move |(_, entry)| entry.result.verdict == verdict)
    };
    let named = Named {
        name: &engine.name,
        kind,
    };
    let label = |name: &str| label(quantities, name);
    if let Some((other, entry)) = Assessment::gravest(of(Verdict::Differ), |one| &one.1.result) {
        let by = entry.result.difference.zip(entry.result.bound);
        let by = match (entry.result.against, by) {
            (Against::Limit, Some((d, limit))) => format!(": {d:.1e}, limit {limit:.1e}"),
            (_, Some((d, bound))) => {
                let off = (d - entry.result.predicted).abs() - bound;
                format!(" by at least {off:.1e}")
            }
            _ => String::new(),
        };
        let (quantity, window) = (label(&entry.quantity), entry.window.word());
        let what = format!("{quantity}, {window}, from {other}{by}");
        let status = u8::from(of(Verdict::Differ).any(|(_, entry)| entry.result.actionable));
        return named.differs(vec![entry.quantity.clone()], &what, status);
    }
    // Smallest bound of agreement of each quantity.
    let mut agree: BTreeMap<&str, f64> = BTreeMap::new();
    for (_, entry) in of(Verdict::Agree) {
        let bound = entry.result.bound.unwrap_or(f64::INFINITY);
        let known = agree.entry(&entry.quantity).or_insert(bound);
        *known = known.min(bound);
    }
    let mut open = of(Verdict::Inconclusive);
    let open = open.find(|(_, entry)| !agree.contains_key(entry.quantity.as_str()));
    if agree.is_empty() {
        let why = match engine.status.reason() {
            Some(reason) => format!("its run {reason}"),
            None => entries_reason(entries),
        };
        let own = format!("{}: ", engine.name);
        return named.nothing(why.strip_prefix(&own).unwrap_or(&why));
    }
    let names: Vec<String> = quantities
        .iter()
        .filter(|q| agree.contains_key(q.name.as_str()))
        .map(|q| q.name.clone())
        .collect();
    let bound = agree.values().copied().fold(0.0, f64::max);
    let labels: Vec<String> = names.iter().map(|name| label(name)).collect();
    let mut what = labels.join(", ");
    if let Some((_, entry)) = open {
        let (quantity, why) = (label(&entry.quantity), reason(&entry.result));
        what += &format!("; nothing shown of {quantity}: {why}");
    }
    named.agrees(names, bound, &what, if open.is_some() { 4 } else { 0 })
}

/// Evidence for one limit: it has to be judged at least once.
fn limit(row: &StatedLimit, entries: &Entries<'_>) -> Finding {
    let StatedLimit {
        engine,
        quantity,
        limit,
        ..
    } = row;
    let (window, metric) = (row.window.word(), row.metric.key());
    let name = format!("{engine}, limit {limit} on {quantity} ({window}, {metric})");
    let named = Named {
        name: &name,
        kind: Kind::Limit,
    };
    let about: Entries<'_> = entries
        .iter()
        .copied()
        .filter(|(_, entry)| entry.window == row.window && fits(&row.quantity, &entry.quantity))
        .collect();
    let judged = about.iter().flat_map(|(other, entry)| {
        let own = entry.assessments.iter().filter(|one| {
            one.against == Against::Limit
                && one.metric == Some(row.metric)
                && one.bound == Some(row.limit)
        });
        own.map(move |one| (*other, entry.quantity.as_str(), one))
    });
    match Assessment::gravest(judged, |(.., one)| one) {
        None => named.nothing(&entries_reason(&about)),
        Some((other, quantity, one)) => {
            let value = one.difference.map_or("not finite".to_owned(), |value| {
                format!("{value:.1e} from {other}")
            });
            let quantities = vec![quantity.to_owned()];
            match one.verdict {
                Verdict::Agree => named.agrees(quantities, row.limit, &value, 0),
                _ => named.differs(quantities, &value, 1),
            }
        }
    }
}

/// Evidence where the user brought nothing: a pair of engines that agrees in each headline quantity.
fn together(engines: &[EngineSummary], pairs: &[Pair], judge: Judge<'_>) -> Finding {
    let named = Named {
        name: "engines",
        kind: Kind::Engines,
    };
    let largest = |quantity: &Quantity| {
        let figures = engines.iter().flat_map(|engine| &engine.figures);
        let of = figures.filter_map(|figures| figures.quantities.get(&quantity.name));
        of.fold(0.0_f64, |most, of| most.max(of.peak))
    };
    let is_rounding = |q: &Quantity| {
        judge
            .negligible
            .below(q)
            .is_some_and(|least| largest(q) < least)
    };
    let is_headline =
        |q: &&Quantity| [INPUT_TORQUE, EXTERNAL_FORCE, INTERNAL_FORCE].contains(&q.name.as_str());
    let quantities = judge.quantities.iter();
    let mut headline: Vec<&Quantity> = quantities.clone().filter(is_headline).collect();
    if headline.is_empty() {
        // Time series without gearbox quantities.
        headline = quantities.collect();
    }
    headline.retain(|q| !is_rounding(q));
    if headline.is_empty() {
        return named.nothing("no run has a force or torque above rounding");
    }
    let labels: Vec<String> = headline.iter().map(|q| q.label.to_lowercase()).collect();
    let labels = labels.join(", ");
    // Smallest bound of agreement of a pair in each headline quantity.
    let bound = |pair: &Pair| {
        let each = headline.iter().map(|quantity| {
            let entries = pair.entries.iter();
            let agree = entries.filter(|entry| {
                entry.quantity == quantity.name && entry.result.verdict == Verdict::Agree
            });
            let bounds = agree.filter_map(|entry| entry.result.bound);
            bounds.reduce(f64::min)
        });
        each.reduce(|a, b| Some(a?.max(b?))).flatten()
    };
    let is_of_engines = |pair: &&Pair| pair.track != SharedModel::Measured;
    let pairs_of_engines = || pairs.iter().filter(is_of_engines);
    let agreeing = pairs_of_engines().filter_map(|pair| Some((pair, bound(pair)?)));
    // Agreement of two native runs is the weakest evidence.
    let best = agreeing.min_by(|(a, to_a), (b, to_b)| {
        let own = |pair: &Pair| pair.track == SharedModel::Native;
        own(a).cmp(&own(b)).then(to_a.total_cmp(to_b))
    });
    if let Some((pair, bound)) = best {
        let names = headline.iter().map(|q| q.name.clone()).collect();
        let what = format!("{} and {}", pair.a, pair.b);
        return named.agrees(names, bound, &what, 0);
    }
    let what = format!("no pair of engines agrees in each of {labels}");
    let entries: Entries<'_> = pairs_of_engines()
        .flat_map(|pair| pair.entries.iter().map(|entry| (pair.b.as_str(), entry)))
        .collect();
    named.nothing(&match entries.is_empty() {
        true => {
            format!("{what}; run two that share a law, e.g. native-resolved and native-lagrange")
        }
        false => {
            let one_law = pairs_of_engines().any(|pair| pair.track != SharedModel::OwnContact);
            let remedy = match one_law {
                true => "",
                false => "; add a second engine with the scene's law, e.g. native-lagrange",
            };
            format!("{what}: {}{remedy}", entries_reason(&entries))
        }
    })
}

/// Name in lower case for a sentence.
fn label(quantities: &[Quantity], name: &str) -> String {
    let known = quantities.iter().find(|q| q.name == name);
    known.map_or_else(|| name.to_owned(), |q| q.label.to_lowercase())
}

/// Reason and remedy of an assessment.
fn reason(of: &Assessment) -> String {
    match (of.participant.as_deref(), of.remedy.as_str()) {
        (Some(who), "") => format!("{who}: {}", of.reason),
        (Some(who), remedy) => format!("{who}: {}; {remedy}", of.reason),
        (None, _) => of.reason.clone(),
    }
}

/// Most frequent reason for which entries show nothing, the gravest verdict first.
fn entries_reason(entries: &Entries<'_>) -> String {
    for verdict in [Verdict::Inconclusive, Verdict::NotCompared] {
        let mut counts: Vec<(String, usize)> = Vec::new();
        for (_, entry) in entries.iter().filter(|(_, e)| e.result.verdict == verdict) {
            let reason = reason(&entry.result);
            match counts.iter_mut().find(|(known, _)| *known == reason) {
                Some((_, count)) => *count += 1,
                None => counts.push((reason, 1)),
            }
        }
        // The first of equals.
        let most = counts.into_iter().rev().max_by_key(|(_, count)| *count);
        if let Some((reason, _)) = most {
            return reason;
        }
    }
    "nothing was compared with it; run it beside another engine, e.g. native-resolved".to_owned()
}
