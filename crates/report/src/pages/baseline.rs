//! Check against a baseline: changes before and after, by size.

use std::collections::BTreeMap;

use crate::format::{grouped, joined, relative};
use crate::study::{self, Block, Decision, Question, Section, Study, Tile, Tone};
use crate::terminal::{self, QUIET, styled};
use pinwheel_studies::Provenance;
use pinwheel_studies::baseline::{
    Baseline, CaseCheck, Check, CostCheck, Made, QuantityCheck, Record, Verdict, limits,
};
use pinwheel_timeseries::table::{Mark, Shown, Table};

/// Quantity of a case.
type Moved<'a> = (&'a CaseCheck, &'a QuantityCheck);

/// Returns the page of a check against the baseline `name`.
pub fn page(name: &str, baseline: &Baseline, check: &Check, origin: &Provenance) -> String {
    let moved = moved(check);
    // Worse entries are unfolded, passed ones folded.
    let bad = |verdict: Verdict| verdict == Verdict::Worse;
    let passed = check.cases.iter().filter(|case| !bad(case.verdict)).count();
    let all = cases_table("Every scene by every solver", check.cases.iter());
    let mut cases = Section::new("cases", "All cases").with(all);
    if passed == check.cases.len() {
        cases = cases.folded(format!("{passed} cases, none worse"));
    }
    let mut costs = Section::new("costs", "Costs").with(costs_block(check));
    let mut counts = check.cases.iter().flat_map(|case| &case.costs);
    if !counts.any(|cost| bad(cost.verdict)) {
        costs = costs.folded("Counts of the program's work, none worse");
    }
    let study = Study {
        title: format!("baseline {name}"),
        eyebrow: "What moved since it was accepted".to_owned(),
        lead: format!(
            "{} cases run again and compared with the results accepted on {}: against the accepted result, and by the change \
             of their error against a converged run.",
            check.cases.len(),
            baseline.made.date,
        ),
        verdict: Some(study::Verdict {
            tone: match check.verdict {
                Verdict::Worse => Tone::Bad,
                Verdict::Changed | Verdict::New | Verdict::Traded => Tone::Neutral,
                Verdict::Same | Verdict::Better => Tone::Good,
            },
            headline: headline(check.verdict).to_owned(),
            detail: joined("; ", sentences(name, check)),
        }),
        decision: decision(name, check, origin),
        sections: vec![
            Section::new("moved", "What moved")
                .with(Block::List(stages(check).collect()))
                .with(moved_blocks(&moved)),
            cases,
            costs,
            Section::new("limits", "Limits")
                .with(limits::table())
                .folded("What a figure may move by, and why"),
            Section::new("history", "History")
                .with(history_blocks(baseline, check))
                .folded("What was accepted, when and why"),
        ],
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

/// Returns the text for a terminal, without the path of the page: a line for each solver, and the changed cases.
pub fn text(name: &str, check: &Check) -> String {
    let is_same = |case: &&CaseCheck| case.verdict == Verdict::Same;
    let (same, mut moved): (Vec<_>, Vec<_>) = check.cases.iter().partition(is_same);
    moved.sort_by_key(|case| std::cmp::Reverse(case.verdict));
    let lines = sentences(name, check).chain(stages(check));
    let mut text: Vec<String> = lines.map(|line| terminal::paragraph(&line)).collect();
    if !moved.is_empty() {
        let table = terminal::table(&cases_table("", moved.into_iter()));
        text.push(table.trim_end().to_owned());
    }
    let mut solvers: Vec<&str> = same.iter().map(|case| case.choice.as_str()).collect();
    solvers.sort_unstable();
    let groups = solvers.chunk_by(|a, b| a == b);
    let named = groups.map(|group| format!("{} {}", group[0], group.len()));
    if !solvers.is_empty() {
        let list = format!("same to rounding: {}", joined(", ", named));
        text.push(styled(QUIET, &terminal::paragraph(&list)));
    }
    text.join("\n")
}

/// Returns the text of a record for a terminal: errors of each solver, and omitted cases.
pub fn recorded(name: &str, record: &Record) -> String {
    let own = [name.to_owned()];
    let solvers = match record.baseline.solvers.as_slice() {
        [] => &own,
        solvers => solvers,
    };
    let of = |solver: &String| {
        let errors = record.errors().into_iter();
        let errors = errors.filter(|(_, case, ..)| case.choice == *solver || solvers == own);
        let errors: Vec<_> = errors.collect();
        let far_off = errors.iter().filter(|(.., error)| *error > limits::FAR_OFF);
        let far = far_off.count();
        let named = errors.iter().take(far.clamp(1, 3));
        let named = named.map(|(scene, case, quantity, error)| {
            let by = match &case.choice {
                own if own == solver => String::new(),
                other => format!(" by {other}"),
            };
            let off = match 100.0 * error {
                percent if percent < 0.1 => format!("{percent:.1e}"),
                percent => format!("{percent:.1}"),
            };
            format!("{}{by} {off} % in {}", scene.name, quantity.label())
        });
        let (cases, named) = (errors.len(), joined(", ", named));
        match far {
            _ if cases == 0 => format!("{solver}: nothing recorded"),
            0 => format!(
                "{solver}: {cases} cases recorded, none more than 1 % off a converged native run; farthest: {named}"
            ),
            far => format!(
                "{solver}: DIFFERS in {far} of {cases} cases recorded by more than 1 % from a converged native run: {named}"
            ),
        }
    };
    let lines = solvers.iter().map(of);
    // Each reason once, with all its scenes.
    let mut reasons: BTreeMap<(&str, &str), Vec<&str>> = BTreeMap::new();
    for out in &record.left_out {
        let scenes = reasons.entry((&out.choice, &out.reason)).or_default();
        scenes.push(&out.scene);
    }
    let left_out = reasons.into_iter().map(|((choice, reason), scenes)| {
        format!("not recorded by {choice}: {}: {reason}", scenes.join(", "))
    });
    let kept = record.baseline.scenes.len() - record.scenes.len();
    let kept = (kept > 0).then(|| format!("other scenes, kept as they were: {kept}"));
    joined("\n", lines.chain(left_out).chain(kept))
}

/// Returns every quantity with its case.
fn quantities(check: &Check) -> impl Iterator<Item = Moved<'_>> {
    let cases = check.cases.iter();
    cases.flat_map(|case| case.quantities.iter().map(move |quantity| (case, quantity)))
}

/// Returns the quantities changed by more than rounding, sorted by the change.
fn moved(check: &Check) -> Vec<Moved<'_>> {
    let is_moved = |(_, quantity): &Moved<'_>| quantity.verdict != Verdict::Same;
    let mut moved: Vec<Moved<'_>> = quantities(check).filter(is_moved).collect();
    moved.sort_by(|(_, a), (_, b)| b.change.total_cmp(&a.change));
    moved
}

fn headline(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Same => "Nothing moved but roundings",
        Verdict::Changed => "Results moved, within their limits",
        Verdict::New => "Nothing is shown of some cases",
        Verdict::Better => "Some figures are better, none is worse",
        Verdict::Traded => "Something is more accurate and dearer",
        Verdict::Worse => "Something is worse",
    }
}

fn decision(name: &str, check: &Check, origin: &Provenance) -> Decision {
    let most = |size: fn(&QuantityCheck) -> f64| {
        let all = quantities(check);
        let (case, of) = all.max_by(|(_, a), (_, b)| size(a).total_cmp(&size(b)))?;
        Some((relative(size(of)), format!("{}, {}", of.label, place(case))))
    };
    let right = most(|of| of.error_after).map(|(off, at)| {
        let why = format!("of a converged run at most: {at}");
        Question::Right.answered(mark(check.verdict), format!("within {off}"), why)
    });
    let sure = most(|of| of.rounding_limit).map(|(off, at)| {
        let why = format!("larger changes are seen: of {at}");
        Question::Sure.answered(Mark::None, format!("to {off}"), why)
    });
    let words = crate::pages::words(origin);
    let with = |names: &[&str]| crate::pages::options(&words, names);
    let next = match check.verdict {
        Verdict::Same => {
            let why = "results are the accepted ones";
            Question::Next.answered(Mark::None, "nothing to accept", why)
        }
        Verdict::Worse => {
            let scene = check.cases.iter().max_by_key(|case| case.verdict);
            let scene = scene.map_or("", |of| &of.scene);
            let with = with(&["--dir", "--solver"]);
            let command = format!("pinwheel baseline check {name}{with} --only {scene}");
            Tile::next(&command, "the worst case alone, once it is mended")
        }
        _ => {
            let with = with(&["--dir", "--only", "--solver"]);
            let command = format!("pinwheel baseline record {name}{with} --accept \"why\"");
            Tile::next(&command, "if the change is meant")
        }
    };
    [right, None, sure, Some(next)]
}

/// Returns one line for each solver.
fn sentences(name: &str, check: &Check) -> impl Iterator<Item = String> {
    check.answers(name).into_iter().map(|answer| answer.text)
}

/// Returns a line for each changed stage with its cases.
fn stages(check: &Check) -> impl Iterator<Item = String> {
    let of = check.cases.iter();
    let of = of.filter_map(|case| Some((case.stage.as_deref()?, place(case))));
    let line = |(stage, places): (&str, Vec<String>)| {
        let more = match places.len() - 1 {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        format!("stage {stage} [{}{more}]", places[0])
    };
    grouped(of).into_iter().map(line)
}

fn mark(verdict: Verdict) -> Mark {
    match verdict {
        Verdict::Same => Mark::Muted,
        Verdict::Changed | Verdict::New | Verdict::Traded => Mark::Warn,
        Verdict::Better => Mark::Good,
        Verdict::Worse => Mark::Bad,
    }
}

/// Returns `1e-5 > 2e-5`, or one figure if both are equal.
fn both<T: PartialEq>(before: T, after: T, words: impl Fn(T) -> String) -> String {
    match before == after {
        true => words(after),
        false => format!("{} > {}", words(before), words(after)),
    }
}

/// Returns a scene and its solver.
fn place(case: &CaseCheck) -> String {
    format!("{}, {}", case.scene, case.choice)
}

/// Returns the quantity with the largest change, if any.
fn most(case: &CaseCheck) -> Option<&QuantityCheck> {
    case.moved_most().filter(|moved| moved.change > 0.0)
}

/// Returns the count with the most urgent verdict, otherwise the first.
fn count(case: &CaseCheck) -> Option<&CostCheck> {
    let moved = case.costs.iter();
    let moved = moved.filter(|cost| cost.verdict != Verdict::Same);
    moved.max_by_key(|cost| cost.verdict).or(case.costs.first())
}

/// Returns a table with a row for each case: the quantity and the count that changed most.
fn cases_table<'a>(caption: &str, cases: impl Iterator<Item = &'a CaseCheck>) -> Table {
    Table::of(caption, cases)
        .text("", "Scene", |case| &case.scene)
        .text("", "Solver", |case| &case.choice)
        .text("", "Verdict", |case| case.verdict.label())
        .marked(|case| mark(case.verdict))
        .text("", "Moved most", |case| match &case.trouble {
            Some(trouble) => trouble.clone(),
            None => most(case).map_or("", |moved| moved.label).to_owned(),
        })
        .number("", "Change", |case| Some(most(case)?.change))
        .shown(Shown::Relative)
        .text("", "Error before > after", |case| {
            let error = |error: f64| format!("{error:.2e}");
            let errors = most(case).map(|of| both(of.error_before, of.error_after, error));
            errors.unwrap_or_default()
        })
        .text("", "Right-hand sides", |case| {
            let Some(cost) = count(case) else {
                return String::new();
            };
            let counts = both(cost.before, cost.after, |count| format!("{count:.0}"));
            match cost.label {
                "right-hand sides" => counts,
                label => format!("{label} {counts}"),
            }
        })
        .done()
}

fn moved_blocks(moved: &[Moved<'_>]) -> Vec<Block> {
    if moved.is_empty() {
        return vec!["Every quantity of every case is the accepted one to rounding.".into()];
    }
    let table = Table::of("Quantities beyond their rounding", moved)
        .text("", "Case", |(case, _)| place(case))
        .text("", "Quantity", |(_, of)| of.label)
        .number("", "Change", |(_, of)| of.change)
        .shown(Shown::Relative)
        .number("", "Rounding up to", |(_, of)| of.rounding_limit)
        .shown(Shown::Relative)
        .number("", "Error before", |(_, of)| of.error_before)
        .shown(Shown::Relative)
        .number("", "Error after", |(_, of)| of.error_after)
        .shown(Shown::Relative)
        .number("", "Mean before", |(_, of)| of.mean[0])
        .number("", "Mean after", |(_, of)| of.mean[1])
        .number("", "Peak before", |(_, of)| of.peak[0])
        .number("", "Peak after", |(_, of)| of.peak[1])
        .text("", "Verdict", |(_, of)| of.verdict.label())
        .marked(|(_, of)| mark(of.verdict));
    let text = "Change, rounding and errors are shares of the quantity's size; errors are against the converged run, which \
                was recorded with the accepted ones.";
    vec![text.into(), table.into()]
}

fn costs_block(check: &Check) -> Block {
    let costs = check.cases.iter();
    let costs = costs.flat_map(|case| case.costs.iter().map(move |cost| (case, cost)));
    let differ = costs.filter(|(_, cost)| cost.before != cost.after);
    let caption = "Counts that differ; they depend on the program alone, not on the machine";
    let table = Table::of(caption, differ)
        .text("", "Case", |(case, _)| place(case))
        .text("", "Count", |(_, cost)| cost.label)
        .number("", "Before", |(_, cost)| cost.before)
        .shown(Shown::Decimals(0))
        .number("", "After", |(_, cost)| cost.after)
        .shown(Shown::Decimals(0))
        .number("", "May move", |(_, cost)| cost.limit)
        .shown(Shown::Decimals(0))
        .text("", "Verdict", |(_, cost)| cost.verdict.label())
        .marked(|(_, cost)| mark(cost.verdict))
        .done();
    match table.is_empty() {
        true => "No count differs from the accepted one.".into(),
        false => table.into(),
    }
}

fn history_blocks(baseline: &Baseline, check: &Check) -> Vec<Block> {
    let made = |what: &str, made: &Made| {
        format!(
            "{what}: {}, version {}, {} build, contact loop on {}, {}",
            made.date, made.version, made.build, made.vectors, made.processor
        )
    };
    let table = Table::of("Why results were accepted", &baseline.accepted)
        .text("", "Date", |one| &one.date)
        .text("", "Reason", |one| &one.reason);
    let states = vec![made("Before", &check.before), made("After", &check.after)];
    vec![Block::List(states), table.into()]
}
