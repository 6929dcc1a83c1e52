//! Page of the study of the paper.

use crate::format::joined;
use crate::study::{
    self, Axis, Block, Chart, Fact, Question, Section, Series, Study, Style, Tile, Tone,
};
use pinwheel_studies::Provenance;
use pinwheel_studies::paper::{ClaimVerdict, Cost, PaperFigure, PaperResult, Plot};
use pinwheel_timeseries::table::{Mark, Shown, Table};

use crate::pages::animation;
use crate::terminal::{self, titled};

/// Returns the page.
pub fn page(result: &PaperResult, origin: &Provenance) -> String {
    // All rows of the two tables below.
    let figures = result.figures.iter().map(|figure| figure.verdict);
    let verdicts = figures.chain(result.claims.iter().map(|judged| judged.verdict));
    let all = verdicts.clone().count();
    let count = |wanted| {
        verdicts
            .clone()
            .filter(|verdict| *verdict == wanted)
            .count()
    };
    let [holds, sometimes, not, meaningless] = [
        ClaimVerdict::Holds,
        ClaimVerdict::Conditional,
        ClaimVerdict::DoesNotHold,
        ClaimVerdict::Meaningless,
    ]
    .map(count);
    let failed = result.claims.iter();
    let failed = failed.filter(|of| of.verdict == ClaimVerdict::DoesNotHold);
    let failed = joined("; ", failed.map(|of| of.claim.claim.as_str()));
    let mut sections = vec![overview(result)];
    if !result.claims.is_empty() {
        sections.push(claims(result));
    }
    sections.extend(motion(result));
    sections.extend(result.figures.iter().map(section));
    sections.push(costs(result));
    let study = Study {
        title: "The paper, computed again".into(),
        eyebrow: "Figures and claims of Król's multibody model of a cycloidal gearbox".into(),
        lead: "Each figure from our own runs in the paper's axes and units: what the paper says it shows, whether ours \
               shows it, and by which number. Figures of the paper are not reproduced here; the words are a summary."
            .into(),
        decision: [
            Some(Question::Right.answered(Mark::Warn, "one program", "our solver alone")),
            None,
            None,
            Some(Tile::next("pinwheel compare paper", "whether other engines agree on its gear")),
        ],
        tiles: vec![Tile::new("Do not hold", not.to_string(), failed)],
        // A claim that does not hold is a finding, not a failure.
        verdict: Some(study::Verdict {
            tone: Tone::Neutral,
            headline: format!("{holds} of {all} figures and claims hold when computed again"),
            detail: format!(
                "{sometimes} hold under a condition, {not} do not, {meaningless} cannot be computed; by {} runs.",
                result.runs
            ),
        }),
        sections,
        ..Study::default()
    };
    crate::pages::render(study, origin)
}

/// Returns the verdicts for a terminal, without the path of the page.
pub fn text(result: &PaperResult) -> String {
    let figures = result.figures.iter();
    let figures = figures.map(|figure| (figure.name.as_str(), figure.verdict, &figure.title));
    let claims = result.claims.iter();
    let claims = claims.map(|judged| ("claim", judged.verdict, &judged.claim.claim));
    let list = Table::of("", figures.chain(claims))
        .text("", "Figure", |row| row.0)
        .text("", "By our runs", |row| row.1.words())
        .marked(|row| mark(row.1))
        .text("", "What", |row| row.2);
    let table = terminal::table(&list.done());
    let cost = format!("\n{} runs in {:.0} s", result.runs, result.wall_s);
    titled("the paper, computed again", [table, cost])
}

/// Returns the motion of the gearbox without and with backlash, over the input turn of most figures.
fn motion(result: &PaperResult) -> Option<Section> {
    let about = "One turn of the input, from 0.24 to 0.36 s, as our solver computes it: with backlash fewer ring pins carry \
                 the same load, each with a higher force.";
    let motion = animation::beside(&result.motion)?;
    Some(Section::new("motion", "Motion").with(about).with(motion))
}

fn overview(result: &PaperResult) -> Section {
    let caption = "What the paper's figures say, and what ours show";
    let table = Table::of(caption, &result.figures)
        .text("", "Figure", |figure| &figure.name)
        .text("", "The paper says", |figure| &figure.says)
        .text("", "Our runs show", |figure| &figure.found)
        .text("", "So it", |figure| figure.verdict.words())
        .marked(|figure| mark(figure.verdict));
    Section::new("figures", "Overview").with(table)
}

fn section(figure: &PaperFigure) -> Section {
    let numbers = Table::of(format!("Numbers of {}", figure.name), &figure.numbers)
        .text("", "Number", |n| n.def.label.clone())
        .number("", "Value", |n| n.value)
        .text("", "Unit", |n| n.def.unit.clone());
    let (words, mark) = (figure.verdict.words(), mark(figure.verdict));
    Section::new(&figure.id, &figure.name)
        .with(Block::Columns(vec![
            Fact::new("The paper", Mark::None, &figure.says),
            Fact::new(format!("Ours: {words}"), mark, &figure.found),
        ]))
        .with(format!("Why: {}", figure.why))
        .with(figure.plots.iter().map(chart).collect::<Vec<_>>())
        .with(Block::folded("Numbers", numbers))
        .folded(format!("{}: {words}", figure.title))
}

fn chart(plot: &Plot) -> Chart {
    let series = plot.curves.iter().map(|curve| {
        // Each curve has its own abscissae; missing values must not be joined.
        let there = plot.x.iter().zip(&curve.y).filter(|(_, y)| y.is_finite());
        let (x, y): (Vec<f64>, Vec<f64>) = there.unzip();
        Series::line(&curve.label, x, y).styled(match curve.points {
            true => Style::Points,
            false => Style::Line,
        })
    });
    let y = Axis {
        label: plot.y_label.clone(),
        log: plot.y_log,
    };
    let x = Axis::linear(&plot.x_label);
    Chart {
        note: plot.note.clone(),
        ..Chart::new(&plot.title, x, y, series.collect())
    }
}

fn claims(result: &PaperResult) -> Section {
    let caption = "What the paper says in words, each judged by the numbers of a figure";
    let judged = Table::of(caption, &result.claims)
        .text("", "Claim", |judged| &judged.claim.claim)
        .text("", "Verdict", |judged| judged.verdict.words())
        .marked(|judged| mark(judged.verdict))
        .text("", "Our figure", |judged| &judged.figure);
    let caption = "Why, by which computation, and where in the paper";
    let reasons = Table::of(caption, &result.claims)
        .text("", "Claim", |judged| &judged.claim.claim)
        .text("", "Why", |judged| &judged.claim.remark)
        .text("", "Judged by", |judged| &judged.claim.judged_by)
        .text("", "Where", |judged| &judged.claim.place);
    Section::new("claims", "Claims")
        .with(judged)
        .with(Block::folded(caption, reasons))
}

fn costs(result: &PaperResult) -> Section {
    let study = Cost {
        what: format!("this whole study, {} runs", result.runs),
        paper_s: None,
        ours_s: result.wall_s,
    };
    let table = Table::of("Cost of a run", result.costs.iter().chain([&study]))
        .text("", "Analysis", |cost| &cost.what)
        .number("", "The paper", |cost| cost.paper_s)
        .shown(Shown::Seconds)
        .number("", "Ours", |cost| cost.ours_s)
        .shown(Shown::Seconds)
        .number("", "Ratio", |cost| cost.paper_s.map(|s| s / cost.ours_s))
        .shown(Shown::Decimals(0));
    Section::new("cost", "Cost")
        .with(
            "Wall time of 0.6 s of the gearbox, 60 000 steps of 1e-5 s by Heun's method, on one core. The paper's machine is not \
             named, so the ratio compares program and machine together. The paper scans all points for every pin; only points \
             near the ideal mesh can touch, so their number need not cost time. Adams took over an hour.",
        )
        .with(table)
        .folded("time of a run, beside the paper's")
}

/// Returns the mark of a verdict.
fn mark(verdict: ClaimVerdict) -> Mark {
    match verdict {
        ClaimVerdict::Holds => Mark::Good,
        ClaimVerdict::DoesNotHold => Mark::Bad,
        ClaimVerdict::Conditional => Mark::Warn,
        ClaimVerdict::Meaningless => Mark::Muted,
    }
}
