//! Pairs of a comparison, a line each, with verdicts and metrics folded behind it.

use crate::format::{self, NONE, distinct, grouped, relative, relative_or_none, significant};
use crate::study::{Block, Item};
use pinwheel_compare::comparison::{EngineSummary, Pair, PairEntry};
use pinwheel_compare::metrics::PairMetrics;
use pinwheel_compare::{Against, Assessment, Metric, Quantity, SharedModel, Verdict, WindowKind};
use pinwheel_timeseries::table::{Mark, Shown, Table};

use super::common::{Page, mark};
use super::words;

/// Largest number of unfolded pairs of one verdict.
const FEW: usize = 3;

/// Returns the anchor of a pair's details.
pub(super) fn id(pair: usize) -> String {
    format!("pair-{pair}")
}

/// Verdict with its quantity and window.
type Judged<'a> = (&'a str, WindowKind, &'a Assessment);

/// Item of a pair with its sort keys: rank (see [`Assessment::rank`]) and share of its bound.
type Ranked = (u8, f64, Item);

impl Page<'_> {
    /// Returns the track's pairs and the verdicts on single engines, the gravest first. Differing ones are unfolded; of the
    /// others more than a few are folded.
    pub(super) fn pairs(&self, track: SharedModel, explains: bool) -> Vec<Block> {
        let pairs = self.comparison.pairs.iter().enumerate();
        let pairs = pairs.filter(|(_, pair)| pair.track == track);
        let engines = self.comparison.engines.iter().filter(|e| e.track == track);
        let alone = engines.filter_map(|engine| self.alone(engine));
        let mut ranked: Vec<Ranked> = pairs.map(|(k, pair)| self.pair(k, pair)).collect();
        ranked.extend(alone);
        ranked.sort_by(|a, b| b.0.cmp(&a.0).then(b.1.total_cmp(&a.1)));
        if ranked.is_empty() {
            return Vec::new();
        }
        let mut blocks = vec![Block::heading("Pair by pair")];
        if explains {
            blocks.push(
                "What differs is unfolded. D is the relative distance of two runs, U the sum of how far each may be from the \
                 exact solution of its own equations, by its own runs at coarser settings. D at most U: they agree, to U."
                    .into(),
            );
        }
        for group in ranked.chunk_by(|a, b| a.0 == b.0) {
            // For unresolvable verdicts a sentence each suffices.
            if group[0].0 == 2 && track != SharedModel::Measured {
                let sentences = group.iter().map(|(.., item)| {
                    let why = item.blocks.iter().find_map(|block| match block {
                        Block::Text(text) => text.strip_prefix("Inconclusive: "),
                        _ => None,
                    });
                    let why = why.unwrap_or_default();
                    format!("{}, {}: {}. {why}", item.name, item.beside, item.badge)
                });
                let summary = format!("{} not resolved", group.len());
                blocks.push(Block::folded(summary, Block::List(sentences.collect())));
                continue;
            }
            let items = group.iter().map(|(.., item)| Block::Item(item.clone()));
            let items: Vec<Block> = items.collect();
            let words = match group[0].0 {
                0 => "not compared",
                1 => "that agree",
                3 => "inconclusive",
                _ => "",
            };
            let listed = items.len() <= FEW || words.is_empty() || track == SharedModel::Measured;
            match listed {
                true => blocks.extend(items),
                false => blocks.push(Block::folded(format!("{} {words}", items.len()), items)),
            }
        }
        let reasons = self.reasons(track);
        if !reasons.is_empty() {
            let count = reasons.len();
            let summary = format!("Why limits and tolerances are what they are ({count})");
            blocks.push(Block::folded(summary, Block::List(reasons)));
        }
        blocks
    }

    fn pair(&self, place: usize, pair: &Pair) -> Ranked {
        let gravest = words::gravest(pair);
        let all = || pair.entries.iter();
        let deciding = all().flat_map(|entry| {
            let deciding = entry.assessments.iter();
            let deciding = deciding.filter(|one| one.decides && one.metric.is_some());
            deciding.map(move |one| (entry.quantity.as_str(), entry.window, one))
        });
        let name = format!("{} \u{2194} {}", pair.a, pair.b);
        let mut blocks = self.judged(&name, deciding.collect());
        blocks.extend(self.not_compared(all()));
        if pair.entries.iter().any(|entry| entry.metrics.is_some()) {
            blocks.push(Block::Later {
                summary: "All metrics".to_owned(),
                table: self.metrics(&name, &pair.entries),
            });
        }
        let rank = gravest.map_or(0, |entry| entry.result.rank());
        let item = Item {
            id: id(place),
            name,
            mark: gravest.map_or(Mark::Muted, |entry| mark(&entry.result)),
            badge: match gravest {
                Some(entry) => words::verdict(&entry.result, relative),
                None => Verdict::NotCompared.word().to_owned(),
            },
            beside: gravest.map_or_else(String::new, |e| self.place(&e.quantity, e.window)),
            open: rank == 4 || pair.track == SharedModel::Measured,
            blocks,
        };
        (rank, gravest.map_or(-1.0, |e| e.result.share()), item)
    }

    /// Returns an item on the verdicts about a single engine.
    fn alone(&self, engine: &EngineSummary) -> Option<Ranked> {
        let compared = engine.judged.iter().filter(|entry| entry.result.rank() > 0);
        let rows = compared.map(|e| (e.quantity.as_str(), e.window, &e.result));
        let rows: Vec<Judged<'_>> = rows.collect();
        let (quantity, window, worst) = *Assessment::gravest(&rows, |(.., one)| one)?;
        let beside = self.place(quantity, window);
        let name = format!("{} \u{2194} load", engine.name);
        let item = Item {
            id: format!("alone-{}", engine.name),
            mark: mark(worst),
            badge: words::verdict(worst, relative),
            beside,
            open: worst.rank() == 4,
            blocks: self.judged(&name, rows),
            name,
        };
        Some((worst.rank(), 1.0, item))
    }

    /// Returns blocks on verdicts, the gravest first, then by share of the bound; reasons of inconclusive ones come before
    /// them.
    fn judged(&self, name: &str, mut rows: Vec<Judged<'_>>) -> Vec<Block> {
        rows.sort_by(|(.., a), (.., b)| b.graver(a));
        let reasons = rows.iter().filter_map(|(.., one)| words::why(one));
        let reasons = reasons.map(|(who, why)| format!("Inconclusive: {who}: {why}"));
        let reasons = distinct(reasons).into_iter();
        let mut blocks: Vec<Block> = reasons.map(Block::Text).collect();
        let table = Table::of(format!("Compared of {name}"), rows)
            .text("", "Quantity", |(quantity, ..)| self.quantity(quantity))
            .text("", "Window", |(_, window, _)| window.word())
            .text("", "Metric", |(.., one)| {
                one.metric.map_or("", Metric::label)
            })
            .number("", "D", |(.., one)| one.difference)
            .display(|(.., one)| relative_or_none(one.difference))
            .text("", "Against", |(.., one)| against(one))
            .text("", "Verdict", |(.., one)| words::verdict(one, relative))
            .marked(|(.., one)| mark(one))
            .done();
        if !table.is_empty() {
            blocks.push(table.into());
        }
        blocks
    }

    /// Returns comparisons without a verdict, grouped by reason.
    fn not_compared<'b>(&self, entries: impl Iterator<Item = &'b PairEntry>) -> Vec<Block> {
        let entries = entries.filter(|e| e.result.verdict == Verdict::NotCompared);
        let reason = |e: &'b PairEntry| (&*e.result.reason, self.place(&e.quantity, e.window));
        let reasons = grouped(entries.map(reason)).into_iter();
        let text = |(reason, places): (&str, Vec<String>)| {
            format!("Not compared: {}. {reason}", places.join("; ")).into()
        };
        reasons.map(text).collect()
    }

    /// Returns the distinct reasons of a track's limits and tolerances.
    fn reasons(&self, track: SharedModel) -> Vec<String> {
        let pairs = self.comparison.pairs.iter().filter(|p| p.track == track);
        let of_pairs = pairs.flat_map(|p| &p.entries).flat_map(|e| &e.assessments);
        let engines = self.comparison.engines.iter().filter(|e| e.track == track);
        let alone = engines.flat_map(|e| &e.judged).map(|e| &e.result);
        let compared = |one: &&Assessment| matches!(one.verdict, Verdict::Agree | Verdict::Differ);
        let all = of_pairs.chain(alone).filter(compared);
        let reasons = all.map(|one| one.reason.clone());
        distinct(reasons.filter(|reason| !reason.is_empty()))
    }

    /// Returns every metric of every quantity and window.
    fn metrics(&self, name: &str, entries: &[PairEntry]) -> Table {
        const RELATIVE: [(&str, fn(&PairMetrics) -> Option<f64>); 9] = [
            ("L2", |m| m.relative_l2),
            ("L\u{221e}", |m| m.relative_linf),
            ("end", |m| m.end_value),
            ("mean", |m| m.mean_difference),
            ("peak", |m| m.peak_difference),
            ("rms", |m| m.rms_difference),
            ("M", |m| m.sprague_geers.map(|e| e.magnitude)),
            ("P", |m| m.sprague_geers.map(|e| e.phase)),
            ("C", |m| m.sprague_geers_c),
        ];
        const RATIOS: &[(&str, fn(&PairMetrics) -> Option<f64>)] = &[
            ("mean a/b", |m| m.mean_ratio),
            ("peak a/b", |m| m.peak_ratio),
            ("rms a/b", |m| m.rms_ratio),
        ];
        let mut table = Table::of(format!("All metrics of {name}"), entries)
            .text("", "Quantity", |entry| self.quantity(&entry.quantity))
            .text("", "Window", |entry| entry.window.word());
        for (list, shown) in [(&RELATIVE[..], Shown::Relative), (RATIOS, Shown::Digits(6))] {
            for (label, of) in list {
                table = table
                    .number("", label, |entry| entry.metrics.as_ref().and_then(of))
                    .shown(shown);
            }
        }
        table
            .text("", "largest difference", |entry| {
                let quantity = words::quantity(self.comparison, &entry.quantity);
                let metrics = entry.metrics.as_ref();
                let worst = metrics.and_then(|metrics| largest(metrics, quantity));
                worst.unwrap_or_else(|| NONE.to_owned())
            })
            .done()
    }
}

/// Returns a text on the bound of a difference.
fn against(one: &Assessment) -> String {
    match (&one.budget, one.against) {
        (Some(budget), _) => {
            let parts = [budget.numerical, budget.input, budget.data];
            let [numerical, input, data] = parts.map(relative);
            format!("u of numerics {numerical}, inputs {input}, data {data}")
        }
        (None, Against::Limit) => {
            let limit = one.bound.map_or_else(|| NONE.to_owned(), format::limit);
            format!("limit {limit}")
        }
        (None, _) => {
            let sum = one.combined();
            let sum = sum.map_or_else(String::new, |sum| format!(" = {}", relative(sum)));
            let [a, b] = [one.u_a, one.u_b].map(relative_or_none);
            format!("U = {a} + {b}{sum}")
        }
    }
}

/// Returns the largest difference with its unit, channel and time.
fn largest(metrics: &PairMetrics, quantity: Option<&Quantity>) -> Option<String> {
    let (value, worst) = metrics.difference_max.zip(metrics.worst.as_ref())?;
    let unit = quantity.map_or("", |q| q.unit.as_str());
    let channel = match quantity {
        Some(q) if q.channels.len() > 1 => format!(", no. {}", worst.channel),
        _ => String::new(),
    };
    let (value, time_s) = (significant(value, 2), format::plain(worst.time_s));
    Some(format!(
        "{value}\u{202f}{unit} at {time_s}\u{202f}s{channel}"
    ))
}
