//! The page of a check: before and after, overlaid, by what moved most.

use pinwheel_report::study::{
    self, Axis, Block, Cell, Chart, Column, Mark, Section, Series, Study, Style, Table, Tile, Tone,
};
use pinwheel_studies::baseline::{
    CaseCheck, Check, Head, Overlay, QuantityCheck, Verdict, limits, table,
};

use pinwheel_studies::Provenance;

use crate::PageError;

mod text;

pub use text::{list, text};

/// Quantities that get charts.
const SHOWN: usize = 8;

/// One quantity of one case.
type Moved<'a> = (&'a CaseCheck, &'a QuantityCheck);

/// The page of the check `found` against the baseline `name`, which begins with `head`.
///
/// # Errors
/// The page cannot be made.
pub fn page(
    name: &str,
    head: &Head,
    found: &Check,
    made: &Provenance,
) -> Result<String, PageError> {
    let mut moved: Vec<Moved<'_>> = found
        .cases
        .iter()
        .flat_map(|case| case.quantities.iter().map(move |quantity| (case, quantity)))
        .filter(|(_, quantity)| quantity.verdict != Verdict::Same)
        .collect();
    moved.sort_by(|(_, a), (_, b)| b.change.total_cmp(&a.change));
    // What is worse is read, what passed is folded.
    let bad = |verdict: Verdict| verdict == Verdict::Worse;
    let passed = found.cases.iter().filter(|case| !bad(case.verdict)).count();
    let mut cases = cases_section(found);
    if passed == found.cases.len() {
        cases = cases.folded(format!("{passed} cases, none worse"));
    }
    let mut costs = costs_section(found);
    let counts = || found.cases.iter().flat_map(|case| &case.costs);
    if !counts().any(|cost| bad(cost.verdict)) {
        costs = costs.folded("Counts of the program's work, none worse");
    }
    let study = Study {
        title: format!("baseline {name}"),
        eyebrow: "What moved since it was accepted".to_owned(),
        lead: format!(
            "{} cases run again and compared with the results accepted on {} (commit {}): against the accepted result, \
             and by the change of their error against a converged run.",
            found.cases.len(),
            head.made.date,
            head.made.commit
        ),
        verdict: Some(study::Verdict {
            tone: match found.verdict {
                Verdict::Worse => Tone::Bad,
                Verdict::Changed | Verdict::New => Tone::Neutral,
                Verdict::Same | Verdict::Better => Tone::Good,
            },
            headline: headline(found.verdict).to_owned(),
            detail: table::sentence(found),
        }),
        tiles: tiles(found, &moved),
        sections: vec![
            moved_section(&moved),
            cases,
            costs,
            limits_section().folded("What a figure may move by, and why"),
            history_section(head, found).folded("What was accepted, when and why"),
        ],
        command: made.command.clone(),
        versions: made.versions(),
        machine: made.machine.rows(),
    };
    Ok(study::render(&study)?)
}

fn headline(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Same => "Nothing moved but roundings",
        Verdict::Changed => "Results moved, within their limits",
        Verdict::New => "Some results are not in the baseline",
        Verdict::Better => "Something is better, nothing is worse",
        Verdict::Worse => "Something is worse",
    }
}

fn mark(verdict: Verdict) -> Mark {
    match verdict {
        Verdict::Same => Mark::Muted,
        Verdict::Changed | Verdict::New => Mark::Warn,
        Verdict::Better => Mark::Good,
        Verdict::Worse => Mark::Bad,
    }
}

fn share(value: f64) -> Cell {
    Cell::number(format!("{value:.1e}"), value)
}

fn tiles(found: &Check, moved: &[Moved<'_>]) -> Vec<Tile> {
    let tile = |label: &str, value: String, detail: String| Tile {
        label: label.to_owned(),
        value,
        unit: String::new(),
        detail,
    };
    let worse = found
        .cases
        .iter()
        .filter(|case| case.verdict == Verdict::Worse)
        .count();
    let mut tiles = vec![
        tile(
            "cases worse",
            worse.to_string(),
            format!("of {}", found.cases.len()),
        ),
        tile(
            "quantities moved",
            moved.len().to_string(),
            "beyond what roundings make".to_owned(),
        ),
    ];
    if let Some((case, quantity)) = moved.first() {
        tiles.push(tile(
            "largest change",
            format!("{:.1e}", quantity.change),
            format!("{}, {}, {}", quantity.label, case.scene, case.choice),
        ));
    }
    if let Some(time) = &found.time {
        tiles.push(tile(
            "time",
            format!("{:.2}", time.after / time.before),
            "of the accepted, over all cases, in yardsticks".to_owned(),
        ));
    }
    tiles
}

fn moved_section(moved: &[Moved<'_>]) -> Section {
    let mut blocks = Vec::new();
    if moved.is_empty() {
        blocks.push(Block::Text(
            "Every quantity of every case is the accepted one to rounding.".to_owned(),
        ));
    } else {
        blocks.push(Block::Text(format!(
            "The accepted course as points where it was kept, the new one as a line; beside it the errors of both against \
             the converged run. The {} that moved most are drawn, all that moved are in the table.",
            moved.len().min(SHOWN)
        )));
        let drawn = moved.iter().filter_map(|(case, quantity)| {
            let overlay = quantity.overlay.as_ref()?;
            Some(charts(case, quantity, overlay))
        });
        let mut drawn = drawn.take(SHOWN);
        blocks.push(Block::Charts(drawn.next().into_iter().flatten().collect()));
        let rest: Vec<Chart> = drawn.flatten().collect();
        if !rest.is_empty() {
            blocks.push(Block::Details {
                summary: "Charts of what moved less".to_owned(),
                blocks: vec![Block::Charts(rest)],
            });
        }
        blocks.push(Block::Table(moved_table(moved)));
    }
    Section {
        id: "moved".to_owned(),
        title: "What moved".to_owned(),
        blocks,
    }
}

/// The overlay, and the errors of both.
fn charts(case: &CaseCheck, quantity: &QuantityCheck, overlay: &Overlay) -> [Chart; 2] {
    let title = if quantity.label.ends_with('s') {
        format!("{} {}", quantity.label, overlay.channel)
    } else {
        quantity.label.to_owned()
    };
    let series = |label: &str, style, x: &[f64], y: Vec<f64>, colour| Series {
        label: label.to_owned(),
        style,
        x: x.to_vec(),
        y,
        tags: Vec::new(),
        colour: Some(colour),
    };
    let error = |course: &[f64]| -> Vec<f64> {
        course
            .iter()
            .zip(&overlay.converged)
            .map(|(a, c)| a - c)
            .collect()
    };
    let axis = |what: &str| Axis::linear(format!("{what} ({})", quantity.unit));
    let chart = |title: String, y: Axis, series: Vec<Series>, note: String| Chart {
        title,
        x: Axis::linear("Time (s)"),
        y,
        series,
        note,
    };
    [
        chart(
            format!("{}, {}: {title}", case.scene, case.choice),
            axis("Value"),
            vec![
                series(
                    "after",
                    Style::Line,
                    &overlay.time_s,
                    overlay.after.clone(),
                    0,
                ),
                series(
                    "before",
                    Style::Points,
                    &overlay.kept_s,
                    overlay.before.clone(),
                    1,
                ),
            ],
            format!(
                "{}; moved by {:.1e}.",
                quantity.verdict.label(),
                quantity.change
            ),
        ),
        chart(
            "error against the converged run".to_owned(),
            axis("Error"),
            vec![
                series(
                    "after",
                    Style::Both,
                    &overlay.kept_s,
                    error(&overlay.after_kept),
                    0,
                ),
                series(
                    "before",
                    Style::Both,
                    &overlay.kept_s,
                    error(&overlay.before),
                    1,
                ),
            ],
            format!(
                "Over all channels {:.2e} before, {:.2e} after.",
                quantity.error_before, quantity.error_after
            ),
        ),
    ]
}

fn moved_table(moved: &[Moved<'_>]) -> Table {
    let rows = moved.iter().map(|(case, quantity)| {
        vec![
            Cell::text(format!("{}, {}", case.scene, case.choice)),
            Cell::text(quantity.label),
            Cell::text(quantity.verdict.label()).marked(mark(quantity.verdict)),
            share(quantity.change),
            share(quantity.rounding_limit),
            share(quantity.error_before),
            share(quantity.error_after),
            share(quantity.error_limit),
            Cell::text(pair(quantity.mean, quantity.unit)),
            Cell::text(pair(quantity.peak, quantity.unit)),
        ]
    });
    Table {
        caption: "Quantities that moved, by how much; shares of the quantity's size".to_owned(),
        columns: vec![
            Column::text("Case"),
            Column::text("Quantity"),
            Column::text("Verdict"),
            Column::number("Change"),
            Column::number("Same up to"),
            Column::number("Error before"),
            Column::number("Error after"),
            Column::number("Error may move"),
            Column::text("Mean"),
            Column::text("Largest"),
        ],
        rows: rows.collect(),
    }
}

fn pair([before, after]: [f64; 2], unit: &str) -> String {
    let digits = |value: f64| pinwheel_report::format::significant(value, 6);
    format!("{} > {} {unit}", digits(before), digits(after))
}

fn cases_section(found: &Check) -> Section {
    let rows = table::rows(found).into_iter().map(|(verdict, row)| {
        row.into_iter()
            .enumerate()
            .map(|(column, text)| match column {
                2 => Cell::text(text).marked(mark(verdict)),
                _ => Cell::text(text),
            })
            .collect()
    });
    Section {
        id: "cases".to_owned(),
        title: "All cases".to_owned(),
        blocks: vec![Block::Table(Table {
            caption: "Every scene by every solver".to_owned(),
            columns: table::COLUMNS.map(Column::text).to_vec(),
            rows: rows.collect(),
        })],
    }
}

fn costs_section(found: &Check) -> Section {
    let mut rows = Vec::new();
    for case in &found.cases {
        for cost in case.costs.iter().filter(|cost| cost.before != cost.after) {
            rows.push(vec![
                Cell::text(format!("{}, {}", case.scene, case.choice)),
                Cell::text(cost.label),
                Cell::number(format!("{:.0}", cost.before), cost.before),
                Cell::number(format!("{:.0}", cost.after), cost.after),
                Cell::number(format!("{:.0}", cost.limit), cost.limit),
                Cell::text(cost.verdict.label()).marked(mark(cost.verdict)),
            ]);
        }
    }
    let mut blocks = Vec::new();
    if rows.is_empty() {
        blocks.push(Block::Text(
            "No count differs from the accepted one.".to_owned(),
        ));
    } else {
        blocks.push(Block::Table(Table {
            caption: "Counts that differ; they depend on the program alone, not on the machine"
                .to_owned(),
            columns: vec![
                Column::text("Case"),
                Column::text("Count"),
                Column::number("Before"),
                Column::number("After"),
                Column::number("May move"),
                Column::text("Verdict"),
            ],
            rows,
        }));
    }
    if !found.after.no_instructions.is_empty() {
        blocks.push(Block::Text(format!(
            "Instructions were not compared: {}.",
            found.after.no_instructions
        )));
    }
    let timed = found
        .cases
        .iter()
        .filter_map(|case| case.time_ratio.map(|ratio| (case, ratio)));
    let timed: Vec<Vec<Cell>> = timed
        .map(|(case, [before, after])| {
            vec![
                Cell::text(format!("{}, {}", case.scene, case.choice)),
                Cell::number(format!("{before:.1}"), before),
                Cell::number(format!("{after:.1}"), after),
                Cell::number(format!("{:.2}", after / before), after / before),
            ]
        })
        .collect();
    if !timed.is_empty() {
        blocks.push(Block::Details {
            summary:
                "CPU times in yardsticks: multiples of a fixed little workload in the same process"
                    .to_owned(),
            blocks: vec![Block::Table(Table {
                caption: "CPU time over the yardstick's".to_owned(),
                columns: vec![
                    Column::text("Case"),
                    Column::number("Before"),
                    Column::number("After"),
                    Column::number("Ratio"),
                ],
                rows: timed,
            })],
        });
    }
    Section {
        id: "costs".to_owned(),
        title: "Costs".to_owned(),
        blocks,
    }
}

fn limits_section() -> Section {
    let rows = limits::table()
        .into_iter()
        .map(|row| row.map(Cell::text).to_vec());
    Section {
        id: "limits".to_owned(),
        title: "Limits".to_owned(),
        blocks: vec![Block::Table(Table {
            caption: "What a figure may move by".to_owned(),
            columns: vec![
                Column::text("Figure"),
                Column::text("Limit"),
                Column::text("Reason"),
            ],
            rows: rows.collect(),
        })],
    }
}

fn history_section(head: &Head, found: &Check) -> Section {
    let rows = head.accepted.iter().map(|accepted| {
        vec![
            Cell::text(&accepted.date),
            Cell::text(&accepted.commit),
            Cell::text(&accepted.reason),
        ]
    });
    let made = |what: &str, made: &pinwheel_studies::baseline::Made| {
        format!(
            "{what}: {}, commit {}, {} build, contact loop on {}, {}",
            made.date, made.commit, made.build, made.vectors, made.processor
        )
    };
    Section {
        id: "history".to_owned(),
        title: "History".to_owned(),
        blocks: vec![
            Block::List(vec![
                made("Before", &found.before),
                made("After", &found.after),
            ]),
            Block::Table(Table {
                caption: "Why results were accepted".to_owned(),
                columns: vec![
                    Column::text("Date"),
                    Column::text("Commit"),
                    Column::text("Reason"),
                ],
                rows: rows.collect(),
            }),
        ],
    }
}
