//! Markup of a study's page: blocks are rendered one by one, so that they can be nested.

use pinwheel_files::output::escape;
use pinwheel_timeseries::table::{Column, Table};
use serde_json::{Value, json};

use super::{Block, Chart, Fact, Item, Mark, Section, Study, Tile, Tone, Verdict, chart};
use crate::format::joined;
use crate::{script, table};

/// Data for the page's scripts, in the order of its blocks.
#[derive(Default)]
struct Drawn<'a> {
    charts: Vec<&'a Chart>,
    /// Tables that the script builds when opened, as text.
    later: Vec<Value>,
    /// True if a block has selectable axes.
    grids: bool,
    /// Data and code of live parts.
    live: Vec<&'a str>,
    /// True if the page queries the program that serves it.
    asks: bool,
}

/// Renders a study's page. The page depends on the study alone: equal studies give equal bytes.
pub fn render(study: &Study) -> String {
    let mut drawn = Drawn::default();
    let sections = study.sections.iter().map(|one| section(one, &mut drawn));
    let sections: String = sections.collect();
    let [top, below, aside, appendix] = [&study.top, &study.below, &study.aside, &study.appendix]
        .map(|one| blocks(one, &mut drawn));
    let link = |one: &Section| {
        let (id, title) = (escape(&one.id), escape(&one.title));
        format!("<a href=\"#{id}\">{title}</a>")
    };
    format!(
        include_str!("../../templates/page.html"),
        title = escape(&study.title),
        eyebrow = escape(&study.eyebrow),
        plot_css = include_str!("../../assets/vendor/uplot/uPlot.min.css"),
        css = include_str!("../../assets/report.css"),
        links = each(&study.sections, link),
        beside = if aside.is_empty() { "" } else { " beside" },
        lead = inline(&study.lead),
        banner = study.verdict.as_ref().map_or_else(String::new, banner),
        top = top,
        decision = tile_list("tiles decision", study.decision.iter().flatten()),
        tiles = tiles(study),
        below = below,
        no_script = match drawn.charts.as_slice() {
            [] => "",
            _ => NO_SCRIPT,
        },
        aside = match aside.as_str() {
            "" => String::new(),
            aside => format!("<div class=\"motion\" id=\"motion\">{aside}</div>"),
        },
        sections = sections,
        command = escape(&study.command),
        versions = pairs("Versions", &study.versions),
        machine = pairs("Machine", &study.machine),
        appendix = appendix,
        date = escape(study.date.as_deref().unwrap_or_default()),
        connect = match drawn.asks {
            true => "; connect-src 'self'",
            false => "",
        },
        scripts = drawn.scripts(),
    )
}

/// Notice in place of charts.
const NO_SCRIPT: &str = "<noscript><p class=\"notice\">The charts need a script. Everything else on this page reads without it.</p></noscript>";

/// Joins the markup of all items.
fn each<T>(all: &[T], html: impl FnMut(&T) -> String) -> String {
    all.iter().map(html).collect()
}

impl Drawn<'_> {
    /// Returns the data of drawings, and the scripts that draw them.
    fn scripts(&self) -> String {
        let mut all = script::code(include_str!("../../assets/shell.js"));
        all += &script::code(include_str!("../../assets/packed.js"));
        if !self.later.is_empty() {
            let packed = script::packed(json!(self.later).to_string().as_bytes());
            all += &format!("<script type=\"text/plain\" id=\"later-data\">{packed}</script>\n");
        }
        if self.grids || !self.live.is_empty() || !self.charts.is_empty() {
            all += &script::code(include_str!("../../assets/vendor/uplot/uPlot.iife.min.js"));
            all += &script::code(include_str!("../../assets/export.js"));
            all += &script::code(include_str!("../../assets/charts.js"));
        }
        if self.grids {
            all += &script::code(include_str!("../../assets/grid.js"));
        }
        all.extend(self.live.iter().copied());
        if !self.charts.is_empty() {
            let charts: Vec<Value> = self.charts.iter().map(|one| chart::json(one)).collect();
            all += &script::data("study-data", &charts);
            all += &script::code(include_str!("../../assets/study.js"));
        }
        all
    }
}

fn banner(verdict: &Verdict) -> String {
    let (class, sign) = match verdict.tone {
        Tone::Good => ("pass", "\u{2713}"),
        Tone::Bad => ("fail", "\u{2715}"),
        Tone::Neutral => ("finding", "\u{2192}"),
        Tone::Open => ("open", "\u{25cb}"),
    };
    let (headline, detail) = (escape(&verdict.headline), inline(&verdict.detail));
    format!(
        "<div class=\"banner {class}\" role=\"status\"><span class=\"sign\" aria-hidden=\"true\">{sign}</span><div>\
         <p class=\"headline\">{headline}</p><p class=\"counts\"><span>{detail}</span></p></div></div>"
    )
}

fn tiles(study: &Study) -> String {
    let title = match (study.tiles_title.as_str(), study.tiles.as_slice()) {
        ("", _) | (_, []) => String::new(),
        (title, _) => {
            let title = escape(title);
            format!("<h2 class=\"small\">Figures <span class=\"unit\">{title}</span></h2>")
        }
    };
    title + &tile_list("tiles", &study.tiles)
}

/// Tiles side by side; nothing without any.
fn tile_list<'a>(class: &str, list: impl IntoIterator<Item = &'a Tile>) -> String {
    let tile = |tile: &Tile| {
        let [label, unit] = [&tile.label, &tile.unit].map(|text| escape(text));
        let [value, detail] = [&tile.value, &tile.detail].map(|text| inline(text));
        let (mark, sign) = sign(tile.mark);
        format!(
            "<div class=\"tile {mark}\"><p class=\"label\">{label}</p><p class=\"value\">{sign}{value} <span class=\"unit\">{unit}</span></p>\
             <p class=\"detail\">{detail}</p></div>\n"
        )
    };
    match list.into_iter().map(tile).collect::<String>().as_str() {
        "" => String::new(),
        tiles => format!("<div class=\"{class}\">\n{tiles}</div>"),
    }
}

/// Returns names and values below a title; empty without any.
fn pairs(title: &str, list: &[(String, String)]) -> String {
    let pair = |(name, value): &(String, String)| {
        format!("<dt>{}</dt><dd>{}</dd>", escape(name), escape(value))
    };
    let pairs = each(list, pair);
    match pairs.as_str() {
        "" => pairs,
        pairs => format!("<div><h3>{title}</h3><dl class=\"pairs\">{pairs}</dl></div>"),
    }
}

fn section<'a>(section: &'a Section, drawn: &mut Drawn<'a>) -> String {
    let (id, title) = (escape(&section.id), escape(&section.title));
    let heading = format!("<h2 id=\"{id}-title\">{title}</h2>");
    let body = match section.blocks.as_slice() {
        [
            Block::Details {
                summary,
                blocks: inside,
            },
        ] => format!(
            "<details class=\"depth\"><summary>{heading} <span class=\"beside\">{}</span></summary>\n{}</details>",
            inline(summary),
            blocks(inside, drawn)
        ),
        inside => format!("{heading}\n{}", blocks(inside, drawn)),
    };
    format!("<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n{body}</section>\n")
}

/// Returns the blocks' markup; collects drawings for the page's scripts.
fn blocks<'a>(blocks: &'a [Block], drawn: &mut Drawn<'a>) -> String {
    let html = blocks.iter().map(|block| block_html(block, drawn) + "\n");
    html.collect()
}

fn block_html<'a>(block: &'a Block, drawn: &mut Drawn<'a>) -> String {
    match block {
        Block::Heading(text) => format!("<h3>{}</h3>", inline(text)),
        Block::Text(text) => format!("<p class=\"about\">{}</p>", inline(text)),
        Block::List(points) => {
            let points = each(points, |point| format!("<li>{}</li>", inline(point)));
            format!("<ul class=\"points\">{points}</ul>")
        }
        Block::Facts(facts) => {
            let facts = each(facts, |fact| fact_html(fact, "<dt>", "</dt><dd", "</dd>"));
            format!("<dl class=\"facts\">{facts}</dl>")
        }
        Block::Columns(facts) => {
            let columns = each(facts, |fact| {
                fact_html(fact, "<div><h3>", "</h3><p", "</p></div>")
            });
            format!("<div class=\"columns facing\">{columns}</div>")
        }
        Block::Table(table) => table_html(table),
        Block::Charts(list) => {
            let mut index = drawn.charts.len()..;
            drawn.charts.extend(list);
            let charts = each(list, |chart| {
                let (title, note) = (escape(&chart.title), inline(&chart.note));
                let index = index.next().unwrap_or_default();
                format!(
                    "<article class=\"panel\"><div class=\"panel-head\"><h3>{title}</h3></div><div class=\"legend\" data-legend=\"{index}\"></div>\
                     <div class=\"plot\" data-chart=\"{index}\"></div><p class=\"chart-note\">{note}</p></article>\n"
                )
            });
            format!("<div class=\"charts\">\n{charts}</div>")
        }
        Block::Details {
            summary,
            blocks: inside,
        } => format!(
            "<details><summary>{}</summary><div class=\"inside\">{}</div></details>",
            inline(summary),
            blocks(inside, drawn)
        ),
        Block::Item(item) => item_html(item, &blocks(&item.blocks, drawn)),
        Block::Later { summary, table } => {
            let words = |row| table::shown(table).map(move |column| table::words(column, row));
            drawn.later.push(json!({
                "caption": table.caption,
                "headings": table::shown(table).map(table::heading).collect::<Vec<_>>(),
                "rows": (0..table.len()).map(|row| words(row).collect()).collect::<Vec<Vec<_>>>(),
            }));
            format!(
                "<details class=\"later\" data-table=\"{}\" hidden><summary>{}</summary></details>",
                drawn.later.len() - 1,
                inline(summary)
            )
        }
        Block::Code(text) => {
            let text = escape(text);
            format!("<pre class=\"code\" tabindex=\"0\"><code>{text}</code></pre>")
        }
        Block::Html(markup) => markup.clone(),
        Block::Live {
            markup,
            scripts,
            asks,
        } => {
            drawn.live.push(scripts);
            drawn.asks |= asks;
            markup.clone()
        }
        Block::Grid(grid) => {
            drawn.grids = true;
            format!(
                "<div class=\"grid\"><noscript><p class=\"notice\">Charts and maps need a script; the table of runs has all figures.</p></noscript><script type=\"application/json\">{}</script></div>",
                script::json_text(grid)
            )
        }
    }
}

fn item_html(item: &Item, inside: &str) -> String {
    let (class, sign) = match item.mark {
        Mark::Good => ("within", "\u{2713}"),
        Mark::Bad => ("exceeded", "\u{2715}"),
        Mark::None | Mark::Warn | Mark::Muted => ("unjudged", "\u{25cb}"),
    };
    let [id, name, badge, beside] =
        [&item.id, &item.name, &item.badge, &item.beside].map(|text| escape(text));
    format!(
        "<details class=\"item {class}\" id=\"{id}\"{}><summary><b>{name}</b> <span class=\"badge {class}\">{sign} {badge}</span> \
         <span class=\"of\">{beside}</span></summary>{inside}</details>",
        if item.open { " open" } else { "" }
    )
}

fn table_html(table: &Table) -> String {
    let caption = escape(&table.caption);
    let columns: Vec<&Column> = table::shown(table).collect();
    let headings = each(&columns, |column| {
        let heading = escape(&table::heading(column));
        let class = match column.values.is_numeric() {
            true => " class=\"num\"",
            false => "",
        };
        format!("<th scope=\"col\"{class}>{heading}</th>")
    });
    let rows = (0..table.len()).map(|row| {
        let cells = columns.iter().enumerate();
        let cells = cells.map(|(k, column)| cell(column, row, k == 0));
        format!("<tr>{}</tr>\n", cells.collect::<String>())
    });
    format!(
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{caption}\">\n<table class=\"data sortable study-table\">\n\
         <caption>{}</caption>\n<thead><tr class=\"keys\">{headings}</tr></thead>\n<tbody>\n{}</tbody>\n</table>\n</div>",
        inline(&table.caption),
        rows.collect::<String>()
    )
}

/// Returns the label of a fact and its text with the sign of its mark, in these elements.
fn fact_html(fact: &Fact, before: &str, between: &str, behind: &str) -> String {
    let (label, (class, sign), text) = (escape(&fact.label), sign(fact.mark), inline(&fact.text));
    format!("{before}{label}{between} class=\"{class}\">{sign}{text}{behind}")
}

/// Returns a cell; the `first` is the row's heading.
fn cell(column: &Column, row: usize, first: bool) -> String {
    let (mark, sign) = sign(table::mark(column, row));
    let mut body = inline(&table::words(column, row));
    if let Some(anchor) = table::of_row(&column.links, row) {
        body = format!("<a href=\"#{}\">{body}</a>", escape(&anchor));
    }
    if let Some(colour) = table::of_row(&column.colours, row) {
        body = format!("<span class=\"swatch\" data-style=\"{colour}\"></span>{body}");
    }
    let shade = table::of_row(&column.shades, row).filter(|shade| shade.is_finite());
    let classes = [
        (column.values.is_numeric(), "num"),
        (first && body.len() <= 30, "name"),
        (!first && body.len() > 70, "why"),
        (!first && shade.is_some(), "map"),
        (true, mark),
    ];
    let classes = classes.into_iter().filter(|(there, _)| *there);
    let classes = joined(" ", classes.map(|(_, class)| class));
    let tag = if first { "th" } else { "td" };
    let mut attributes = format!(" class=\"{}\"", classes);
    if first {
        attributes += " scope=\"row\"";
    } else {
        attributes += &format!(" data-of=\"{}\"", escape(&table::heading(column)));
    }
    if let Some(key) = column.values.number(row).filter(|key| key.is_finite()) {
        attributes += &format!(" data-key=\"{key:e}\"");
    }
    if let Some(shade) = shade.filter(|_| !first) {
        attributes += &format!(" style=\"--heat:{:.3}\"", shade.clamp(0.0, 1.0));
    }
    format!("<{tag}{attributes}>{sign}{body}</{tag}>")
}

/// Returns the class of a mark, and its sign.
fn sign(mark: Mark) -> (&'static str, String) {
    let (class, sign, words) = match mark {
        Mark::None => return ("", String::new()),
        Mark::Good => ("good", "\u{2713}", "holds"),
        Mark::Bad => ("bad", "\u{2715}", "does not hold"),
        Mark::Warn => ("warn", "!", "note"),
        Mark::Muted => return ("muted", String::new()),
    };
    let sign = format!("<i class=\"sign\" aria-hidden=\"true\">{sign}</i>");
    let sign = format!("{sign}<span class=\"unseen\">{words}: </span> ");
    (class, sign)
}

/// Returns escaped text in which `` `these` `` are code.
fn inline(text: &str) -> String {
    let text = escape(text);
    let parts: Vec<&str> = text.split('`').collect();
    if parts.len().is_multiple_of(2) {
        return text; // a lone backtick stays
    }
    let part = |(k, part): (usize, &&str)| match k % 2 {
        0 => (*part).to_owned(),
        _ => format!("<code>{part}</code>"),
    };
    parts.iter().enumerate().map(part).collect()
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
