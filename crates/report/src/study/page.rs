//! A study's page as markup: blocks are rendered one by one, so that they can hold each other.

use askama::Template;

use super::chart::ChartJson;
use super::{Block, Cell, Chart, Grid, Mark, Study, Table, Tile, TimeSeries, Tone, Verdict};
use crate::ReportError;
use crate::assets::{ASSETS, Assets};
use crate::chart_data::json_for_script;
use crate::{packed, table};
use pinwheel_timeseries::table::{Column, Table as Data};
use serde::Serialize;

/// The whole page.
#[derive(Template)]
#[template(path = "study.html")]
struct Page<'a> {
    study: &'a Study,
    banner: Option<Banner<'a>>,
    top: String,
    tiles: &'a [Tile],
    below: String,
    aside: Option<String>,
    appendix: String,
    sections: Vec<SectionHtml<'a>>,
    chart_json: Option<String>,
    /// Whether a block lets the reader choose axes.
    grids: bool,
    /// Tables that are made when they are opened, packed.
    later: Option<String>,
    /// Time series, and what draws them.
    time_series_json: Option<String>,
    time_series_js: &'static str,
    lead: String,
    assets: Assets,
    page_js: &'static str,
    grid_js: &'static str,
}

#[derive(Template)]
#[template(path = "study/time_series.html")]
struct TimeSeriesHtml<'a> {
    chart_notes: &'a [String],
}

struct Banner<'a> {
    class: &'static str,
    sign: &'static str,
    headline: &'a str,
    detail: String,
}

struct SectionHtml<'a> {
    id: &'a str,
    title: &'a str,
    body: String,
    /// What stands beside the title of a section that is folded as a whole.
    folded: Option<String>,
}

#[derive(Template)]
#[template(path = "study/table.html")]
struct TableHtml<'a> {
    caption: &'a str,
    /// Words, and whether figures stand in the column.
    headings: Vec<(String, bool)>,
    rows: Vec<Vec<CellHtml>>,
}

/// What the page's scripts draw, in the order of its blocks.
#[derive(Default)]
struct Drawn<'a> {
    charts: Vec<&'a Chart>,
    later: Vec<Later<'a>>,
}

/// A table in words.
#[derive(Serialize)]
struct Later<'a> {
    caption: &'a str,
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

struct CellHtml {
    numeric: bool,
    class: &'static str,
    sign: &'static str,
    word: &'static str,
    body: String,
    key: String,
    style: String,
}

#[derive(Template)]
#[template(path = "study/charts.html")]
struct ChartsHtml<'a> {
    charts: Vec<ChartHtml<'a>>,
}

struct ChartHtml<'a> {
    index: usize,
    title: &'a str,
    note: String,
}

pub(super) fn render(study: &Study) -> Result<String, ReportError> {
    let mut drawn = Drawn::default();
    let sections = study
        .sections
        .iter()
        .map(|section| {
            let (inside, folded) = match section.blocks.as_slice() {
                [Block::Details { summary, blocks }] => (blocks.as_slice(), Some(inline(summary))),
                blocks => (blocks, None),
            };
            Ok(SectionHtml {
                id: &section.id,
                title: &section.title,
                body: blocks(inside, &mut drawn)?,
                folded,
            })
        })
        .collect::<Result<Vec<_>, ReportError>>()?;
    let top = blocks(&study.top, &mut drawn)?;
    let below = blocks(&study.below, &mut drawn)?;
    let aside = study.aside.as_ref().map(|list| blocks(list, &mut drawn));
    let aside = aside.transpose()?;
    let appendix = blocks(&study.appendix, &mut drawn)?;
    let later = (!drawn.later.is_empty()).then(|| serde_json::to_string(&drawn.later));
    let json: Vec<ChartJson<'_>> = drawn.charts.into_iter().map(ChartJson::of).collect();
    let page = Page {
        study,
        banner: study.verdict.as_ref().map(banner),
        top,
        tiles: &study.tiles,
        below,
        aside,
        appendix,
        sections,
        later: later.transpose()?.map(|text| packed::text(&text)),
        chart_json: if json.is_empty() {
            None
        } else {
            Some(json_for_script(&json)?)
        },
        grids: blocks_of(study).any(|block| matches!(block, Block::Grid(Grid { .. }))),
        time_series_json: blocks_of(study).find_map(time_series).transpose()?,
        time_series_js: include_str!("../../assets/time_series.js"),
        lead: inline(&study.lead),
        assets: ASSETS,
        page_js: include_str!("../../assets/study.js"),
        grid_js: include_str!("../../assets/grid.js"),
    };
    Ok(page.render()?)
}

fn banner(verdict: &Verdict) -> Banner<'_> {
    let (class, sign) = match verdict.tone {
        Tone::Good => ("pass", "\u{2713}"),
        Tone::Bad => ("fail", "\u{2715}"),
        Tone::Neutral => ("finding", "\u{2192}"),
        Tone::Open => ("open", "\u{25cb}"),
    };
    Banner {
        class,
        sign,
        headline: &verdict.headline,
        detail: inline(&verdict.detail),
    }
}

/// Blocks of sections themselves: grids and time series are not folded.
fn blocks_of(study: &Study) -> impl Iterator<Item = &Block> {
    study.sections.iter().flat_map(|section| &section.blocks)
}

fn time_series(block: &Block) -> Option<Result<String, serde_json::Error>> {
    match block {
        Block::TimeSeries(TimeSeries(data)) => Some(json_for_script(data)),
        _ => None,
    }
}

/// The blocks' markup; charts are collected for the page's script.
fn blocks<'a>(blocks: &'a [Block], drawn: &mut Drawn<'a>) -> Result<String, ReportError> {
    let mut html = String::new();
    for block in blocks {
        html.push_str(&one(block, drawn)?);
        html.push('\n');
    }
    Ok(html)
}

fn one<'a>(block: &'a Block, drawn: &mut Drawn<'a>) -> Result<String, ReportError> {
    Ok(match block {
        Block::Heading(text) => format!("<h3>{}</h3>", inline(text)),
        Block::Text(text) => format!("<p class=\"about\">{}</p>", inline(text)),
        Block::List(points) => {
            let points: Vec<String> = points
                .iter()
                .map(|p| format!("<li>{}</li>", inline(p)))
                .collect();
            format!("<ul class=\"points\">{}</ul>", points.join(""))
        }
        Block::Table(table) => TableHtml {
            caption: &table.caption,
            headings: table
                .columns
                .iter()
                .map(|column| (column.label.clone(), column.numeric))
                .collect(),
            rows: rows(table),
        }
        .render()?,
        Block::Data(table) => data(table).render()?,
        Block::Charts(list) => {
            let first = drawn.charts.len();
            drawn.charts.extend(list);
            ChartsHtml {
                charts: list
                    .iter()
                    .enumerate()
                    .map(|(k, chart)| ChartHtml {
                        index: first + k,
                        title: &chart.title,
                        note: inline(&chart.note),
                    })
                    .collect(),
            }
            .render()?
        }
        Block::Details {
            summary,
            blocks: inner,
        } => format!(
            "<details><summary>{}</summary><div class=\"inside\">{}</div></details>",
            inline(summary),
            blocks(inner, drawn)?
        ),
        Block::Item(item) => {
            let (class, sign) = match item.mark {
                Mark::Good => ("within", "\u{2713}"),
                Mark::Bad => ("exceeded", "\u{2715}"),
                Mark::None | Mark::Warn | Mark::Muted => ("unjudged", "\u{25cb}"),
            };
            format!(
                "<details class=\"item {class}\" id=\"{}\"{}><summary><b>{}</b> <span class=\"badge {class}\">{sign} {}</span> \
                 <span class=\"of\">{}</span></summary>{}</details>",
                escape(&item.id),
                if item.open { " open" } else { "" },
                escape(&item.name),
                escape(&item.said),
                escape(&item.beside),
                blocks(&item.blocks, drawn)?
            )
        }
        Block::Later { summary, table } => {
            let place = drawn.later.len();
            drawn.later.push(later(table));
            format!(
                "<details class=\"later\" data-table=\"{place}\" hidden><summary>{}</summary></details>",
                inline(summary)
            )
        }
        Block::Code(text) => {
            format!(
                "<pre class=\"code\" tabindex=\"0\"><code>{}</code></pre>",
                escape(text)
            )
        }
        Block::Html(markup) => markup.clone(),
        Block::TimeSeries(TimeSeries(data)) => TimeSeriesHtml {
            chart_notes: &data.notes,
        }
        .render()?,
        Block::Grid(grid) => format!(
            "<div class=\"grid\"><noscript><p class=\"notice\">Charts and maps need a script; the table of runs has all figures.</p></noscript><script type=\"application/json\">{}</script></div>",
            json_for_script(grid)?
        ),
    })
}

fn rows(table: &Table) -> Vec<Vec<CellHtml>> {
    let empty = Cell::default();
    table
        .rows
        .iter()
        .map(|row| {
            table
                .columns
                .iter()
                .enumerate()
                .map(|(k, column)| cell(row.get(k).unwrap_or(&empty), column.numeric))
                .collect()
        })
        .collect()
}

fn later(table: &Data) -> Later<'_> {
    let words = |row| table::shown(table).map(move |column| table::words(column, row));
    Later {
        caption: &table.caption,
        headings: table::shown(table).map(table::heading).collect(),
        rows: (0..table.len()).map(|row| words(row).collect()).collect(),
    }
}

fn data(table: &Data) -> TableHtml<'_> {
    let columns = table::shown(table);
    let cell_of = |column: &Column, row: usize| {
        let said = Cell {
            text: table::words(column, row),
            mark: table::mark(column, row),
            heat: column.shades.get(row).copied().flatten(),
            key: column.values.number(row),
        };
        let mut html = cell(&said, column.values.is_numeric());
        if let Some(anchor) = column.links.get(row).cloned().flatten() {
            html.body = format!("<a href=\"#{}\">{}</a>", escape(&anchor), html.body);
        }
        if let Some(colour) = column.colours.get(row).copied().flatten() {
            let swatch = format!("<span class=\"swatch\" data-style=\"{colour}\"></span>");
            html.body.insert_str(0, &swatch);
        }
        html
    };
    let row = |row| columns.clone().map(|column| cell_of(column, row)).collect();
    TableHtml {
        caption: &table.caption,
        headings: columns
            .clone()
            .map(|column| (table::heading(column), column.values.is_numeric()))
            .collect(),
        rows: (0..table.len()).map(row).collect(),
    }
}

fn cell(cell: &Cell, numeric: bool) -> CellHtml {
    let (class, sign, word) = match cell.mark {
        Mark::None => ("", "", ""),
        Mark::Good => ("good", "\u{2713}", "holds: "),
        Mark::Bad => ("bad", "\u{2715}", "does not hold: "),
        Mark::Warn => ("warn", "!", "note: "),
        Mark::Muted => ("muted", "", ""),
    };
    CellHtml {
        numeric,
        class,
        sign,
        word,
        body: inline(&cell.text),
        key: cell
            .key
            .filter(|k| k.is_finite())
            .map(|k| format!("{k:e}"))
            .unwrap_or_default(),
        style: cell
            .heat
            .filter(|h| h.is_finite())
            .map(|h| format!("--heat:{:.3}", h.clamp(0.0, 1.0)))
            .unwrap_or_default(),
    }
}

/// Escaped text in which `` `these` `` are code.
fn inline(text: &str) -> String {
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return escape(text); // a lone backtick is itself
    }
    parts
        .iter()
        .enumerate()
        .map(|(k, part)| match k % 2 {
            0 => escape(part),
            _ => format!("<code>{}</code>", escape(part)),
        })
        .collect()
}

fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn backticks_are_code_and_all_is_escaped() {
        assert_eq!(
            inline("a < `b & c` > d"),
            "a &lt; <code>b &amp; c</code> &gt; d"
        );
        assert_eq!(inline("one ` alone"), "one ` alone");
    }
}
