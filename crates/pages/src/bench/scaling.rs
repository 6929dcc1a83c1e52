//! Cost against the size of the gear and the number of points.

use pinwheel_report::format::{seconds, significant};
use pinwheel_report::study::{Axis, Block, Cell, Chart, Column, Section, Series, Style, Table};
use pinwheel_studies::precision::scaling::{Fit, Scaling, Size};

/// The section.
pub(super) fn section(found: &Scaling) -> Section {
    let pairs = |size: &Size| Some(size.pairs as f64);
    let points = |size: &Size| size.points.map(|n| n as f64);
    Section {
        id: "scaling".to_owned(),
        title: "Growth with the gear".to_owned(),
        blocks: vec![
            Block::Text(
                "Cost of one right-hand side, samples and energy account included, of gears from 1 wheel and 18 \
                 sleeves to 4 wheels and 240 sleeves: the paper's teeth on a larger circle, with loads that give every \
                 contact about the paper's force. All take 2000 steps of 1e-5 s by rk2. The fit is a least-squares line \
                 through the logarithms, for sizes over gears of more than 100 pairs."
                    .to_owned(),
            ),
            Block::List(
                [
                    ("reduced form", "wheels \u{d7} sleeves", found.reduced_fit),
                    ("saddle-point form", "wheels \u{d7} sleeves", found.lagrange_fit),
                    ("discrete points", "points on a wheel", found.points_fit),
                ]
                .into_iter()
                .filter_map(|(what, size, fit)| {
                    let fit = fit?;
                    Some(format!(
                        "{what}: cost of a call grows with ({size}) to the power {:.3}",
                        fit.exponent
                    ))
                })
                .collect(),
            ),
            Block::Charts(vec![
                chart(
                    "Cost against size",
                    "wheels \u{d7} sleeves",
                    [
                        ("reduced", &found.reduced, found.reduced_fit),
                        ("saddle-point", &found.lagrange, found.lagrange_fit),
                    ]
                    .into(),
                    pairs,
                ),
                chart(
                    "Cost against points",
                    "points on a wheel",
                    [("points detection", &found.points, found.points_fit)].into(),
                    points,
                ),
            ]),
            Block::Details {
                summary: "All sizes".to_owned(),
                blocks: vec![table(found)],
            },
        ],
    }
}

fn chart(
    title: &str,
    axis: &str,
    lists: Vec<(&str, &Vec<Size>, Option<Fit>)>,
    x: fn(&Size) -> Option<f64>,
) -> Chart {
    let mut series = Vec::new();
    for (k, (label, sizes, fit)) in lists.into_iter().enumerate() {
        let mut points: Vec<(f64, f64)> = sizes
            .iter()
            .filter_map(|size| Some((x(size)?, 1e6 * size.per_call_s)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        let xs: Vec<f64> = points.iter().map(|p| p.0).collect();
        if let Some(fit) = fit {
            series.push(Series {
                label: format!("{label}: power {:.2}", fit.exponent),
                style: Style::Dashed,
                y: xs
                    .iter()
                    .map(|x| 1e6 * fit.factor_s * x.powf(fit.exponent))
                    .collect(),
                x: xs.clone(),
                colour: Some(k),
                ..Series::default()
            });
        }
        series.push(Series {
            label: label.to_owned(),
            style: Style::Points,
            x: xs,
            y: points.iter().map(|p| p.1).collect(),
            colour: Some(k),
            ..Series::default()
        });
    }
    Chart {
        title: title.to_owned(),
        x: Axis::log(axis),
        y: Axis::log("CPU time a call (\u{b5}s)"),
        series,
        note: String::new(),
    }
}

fn table(found: &Scaling) -> Block {
    let all = found
        .reduced
        .iter()
        .map(|size| ("reduced", size))
        .chain(found.lagrange.iter().map(|size| ("saddle-point", size)))
        .chain(found.points.iter().map(|size| ("reduced", size)));
    Block::Table(Table {
        caption: "Cost of each gear".to_owned(),
        columns: vec![
            Column::text("Form"),
            Column::number("Wheels"),
            Column::number("External sleeves"),
            Column::number("Internal sleeves"),
            Column::number("Pairs"),
            Column::text("Detection"),
            Column::number("CPU, minimum"),
            Column::number("CPU, median"),
            Column::number("A call"),
            Column::number("A call and pair"),
        ],
        rows: all
            .map(|(form, size)| {
                let whole = |n: usize| Cell::number(n.to_string(), n as f64);
                let each = size.per_call_s / size.pairs as f64;
                vec![
                    Cell::text(form),
                    whole(size.wheels),
                    whole(size.external_sleeves),
                    whole(size.internal_sleeves),
                    whole(size.pairs),
                    size.points.map_or_else(
                        || Cell::text("exact"),
                        |n| Cell::number(format!("{n} points"), n as f64),
                    ),
                    Cell::number(seconds(size.cpu_min_s), size.cpu_min_s),
                    Cell::number(seconds(size.cpu_median_s), size.cpu_median_s),
                    Cell::number(seconds(size.per_call_s), size.per_call_s),
                    Cell::number(format!("{}\u{202f}ns", significant(1e9 * each, 3)), each),
                ]
            })
            .collect(),
    })
}
