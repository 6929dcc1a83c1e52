//! A study's page: blocks in order, everything escaped, charts' data beside their hosts.

use pinwheel_report::study::*;
use pinwheel_timeseries::table::Table;

fn sample() -> Study {
    let steps = [1e-4, 3e-5, 1e-5, 3e-6, 1e-6];
    let curve = |label: &str, order: i32, scale: f64| Series {
        label: label.into(),
        style: Style::Both,
        x: steps.iter().map(|h| 0.6 / h * 2e-6).collect(),
        y: steps.iter().map(|h: &f64| scale * h.powi(order)).collect(),
        tags: steps.iter().map(|h| format!("{h:e} s")).collect(),
        ..Series::default()
    };
    Study {
        title: "paper <&>".into(),
        eyebrow: "Speed against error".into(),
        lead: "What a run costs & what it gives.".into(),
        verdict: Some(Verdict {
            tone: Tone::Good,
            headline: "Native wins".into(),
            detail: "by `factor` < 50".into(),
        }),
        tiles: vec![Tile {
            label: "Ratio".into(),
            value: "53".into(),
            unit: "times".into(),
            detail: "at 1e-4".into(),
            ..Tile::default()
        }],
        sections: vec![Section {
            id: "work".into(),
            title: "Work and precision".into(),
            blocks: vec![
                Block::Text("Errors in `forces`.".into()),
                Block::Charts(vec![Chart {
                    title: "Transient".into(),
                    x: Axis::log("CPU time (s)"),
                    y: Axis::log("Relative L2 error (1)"),
                    series: vec![curve("rk2", 2, 1e6), curve("</script>", 4, 1e14)],
                    note: "Lower left wins.".into(),
                }]),
                Table::of("Runs", [("native", Some(1.2e-4)), ("peer", None)])
                    .text("", "Engine", |row| row.0)
                    .number("", "Error", |row| row.1)
                    .unit("1")
                    .marked(|row| Mark::of(row.1.is_some()))
                    .shaded(|row| row.1.map(|_| 0.4))
                    .done()
                    .into(),
                Block::Details {
                    summary: "More".into(),
                    blocks: vec![Block::Code("a < b".into()), Block::List(vec!["x".into()])],
                },
            ],
        }],
        command: "pinwheel bench paper".into(),
        versions: vec![("pinwheel".into(), "0.1.0".into())],
        ..Study::default()
    }
}

#[test]
fn a_page_holds_its_blocks_escaped_and_in_order() {
    let page = render(&sample());
    for part in [
        "<h1 id=\"study-title\">paper &lt;&amp;&gt;</h1>",
        "by <code>factor</code> &lt; 50",
        "<code>forces</code>",
        "data-chart=\"0\"",
        "data-key=\"1.2e-4\"",
        "--heat:0.400",
        "a &lt; b",
        "<a href=\"#work\">Work and precision</a>",
    ] {
        assert!(page.contains(part), "{part} is missing");
    }
    let data = page.split("id=\"study-data\">").nth(1).unwrap();
    let data = &data[..data.find("</script>").unwrap()];
    let charts: serde_json::Value = serde_json::from_str(data).unwrap();
    assert_eq!(charts[0]["series"][1]["label"], "</script>");
    assert_eq!(page, render(&sample()), "the same bytes twice");
    assert!(!page.contains("http://") || !page.contains("src=\"http"));
}

#[test]
fn a_page_without_charts_carries_no_plotting_library() {
    let study = Study {
        title: "t".into(),
        ..Study::default()
    };
    let page = render(&study);
    assert!(!page.contains("uPlot="));
    if let Ok(path) = std::env::var("PINWHEEL_SAMPLE_STUDY") {
        std::fs::write(path, render(&sample())).unwrap();
    }
}
