//! Pages describe the comparison, load nothing, and cannot be broken by any scene.

use pinwheel_compare::uncertainty::Source;
use pinwheel_compare::{
    Comparison, Context, Cost, Evidence, Participant, Rules, SharedModel, Status, compare,
};
use pinwheel_gearbox::{Gearbox, explain};
use pinwheel_scene::Scene;
use pinwheel_studies::comparison::Outcome;
use pinwheel_studies::motion::Motion;
use pinwheel_studies::stability::{Atlas, Cell, Method, Options, SceneRow};
use pinwheel_studies::{Control, Provenance};
use pinwheel_timeseries::TimeSeries;

/// Text of a hostile scene that tries to end an element, an attribute, a script.
const HOSTILE: &str = "x</script><script>alert(1)</script><img src=x onerror=\"a\">'\"--><!--";

fn time_series(scale: f64, channels: usize, samples: u32) -> TimeSeries {
    let time: Vec<f64> = (0..samples).map(|k| f64::from(k) * 1e-3).collect();
    let mut time_series = TimeSeries::new(time.clone()).unwrap();
    let wave = |k: usize| {
        let of = |t: &f64| scale * (2.0 + (90.0 * t + k as f64).sin());
        time.iter().map(of).collect::<Vec<f64>>()
    };
    time_series.push("input_torque_n_m", wave(0)).unwrap();
    time_series
        .push("output_torque_n_m", vec![-22.0; time.len()])
        .unwrap();
    for k in 0..channels {
        time_series
            .push(format!("external_sleeve_force_n_{k}"), wave(k))
            .unwrap();
    }
    time_series
}

/// Returns time series that no prediction shortens.
fn rough(channels: usize, samples: u32) -> TimeSeries {
    let mut rough = time_series(1.0, 0, samples);
    let mut state = 1u64;
    for k in 0..channels {
        let noise = (0..samples).map(|_| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64
        });
        let values = noise.collect();
        rough
            .push(format!("external_sleeve_force_n_{k}"), values)
            .unwrap();
    }
    rough
}

fn participant(name: &str, track: SharedModel, scale: f64) -> Participant {
    Participant {
        name: name.to_owned(),
        track,
        version: "1.2.3".to_owned(),
        summary: "A summary.".to_owned(),
        differences: "A difference.".to_owned(),
        time_series: time_series(scale, 3, 601),
        cost: Cost {
            wall_s: 1.5,
            steps: 60_000,
            step_s: 1e-5,
            ..Cost::default()
        },
        status: Status::Finished,
    }
}

fn context(scene: &str) -> Context {
    let load_n_m = Some(22.0);
    Context {
        scene: scene.to_owned(),
        duration_s: 0.6,
        load_n_m,
        ..Context::default()
    }
}

fn page_of(comparison: &Comparison, participants: &[Participant]) -> String {
    let mut scene = Scene::paper();
    scene.name = HOSTILE.to_owned();
    scene.solver.duration_s = 0.002;
    let gearbox = Gearbox::new(&scene.check().unwrap()).unwrap();
    let outcome = Outcome {
        stages: Vec::new(),
        model: explain(&gearbox),
        comparison: comparison.clone(),
        participants: participants.to_vec(),
        assumptions: Vec::new(),
        bands: None,
        limits: None,
        motion: Motion::of(&gearbox, &Control::quiet()).unwrap(),
        twins: Vec::new(),
        gearbox,
    };
    let mut made = Provenance::here(format!("pinwheel compare {HOSTILE}"));
    made.machine.processor = HOSTILE.to_owned();
    pinwheel_report::pages::comparison::page(&outcome, &made)
}

/// Returns a comparison in which every participant has an uncertainty of 2e-5.
fn judged(context: &Context, participants: &[Participant]) -> Comparison {
    let known = |participant: &Participant| Evidence {
        engine: participant.name.clone(),
        source: Source::Exact(2e-5),
        is_final: None,
    };
    let evidence: Vec<Evidence> = participants.iter().map(known).collect();
    let rules = Rules {
        evidence: &evidence,
        ..Rules::default()
    };
    compare(context, participants, &rules).unwrap()
}

fn page(participants: &[Participant]) -> String {
    let comparison = judged(&context("paper"), participants);
    page_of(&comparison, participants)
}

fn two(scale: f64) -> [Participant; 2] {
    [
        participant("native-reduced", SharedModel::Native, 1.0),
        participant("rapier-shared-law", SharedModel::SharedLaw, scale),
    ]
}

#[test]
fn says_what_was_compared() {
    let page = page(&two(1.0 + 3e-5));
    for wanted in [
        "<p class=\"headline\">Pass, one contact law, shared by all engines that agree",
        "<h1 id=\"study-title\">paper</h1>",
        "native-reduced \u{2194} rapier-shared-law",
        "3.0\u{b7}10\u{207b}\u{2075}",
        "<caption>What was modelled</caption>",
        "<caption>What was left out, and why</caption>",
        "A difference.",
        "60\u{202f}000",
        "<noscript>",
    ] {
        assert!(page.contains(wanted), "no `{wanted}`");
    }
}

#[test]
fn banner_follows_the_verdict() {
    assert!(page(&two(1.001)).contains("<p class=\"headline\">Differs"));
    let mut broken = two(1.0);
    broken[1].status = Status::Diverged {
        time_s: 0.25,
        quantity: "disc angle".to_owned(),
    };
    broken[1].time_series = time_series(1.0, 3, 250);
    let page = page(&broken);
    assert!(page.contains("1 engine did not finish"));
    assert!(page.contains("diverged at t = 0.250000 s: disc angle"));
}

/// An engine excluded beforehand is no finding, as the terminal states too.
#[test]
fn who_is_left_out_breaks_nothing() {
    let [one, other] = two(1.0);
    let mut out = participant("slow", SharedModel::OwnContact, 1.0);
    out.status = Status::Unsupported {
        reason: "give it more time".to_owned(),
    };
    out.time_series = TimeSeries::default();
    let page = page(&[one, other, out]);
    assert!(!page.contains("did not finish") && !page.contains("banner fail"));
    assert!(page.contains("give it more time") && page.contains("<dt>left out</dt>"));
}

/// Results of a diverged engine never appear in a headline.
#[test]
fn a_diverged_engine_feeds_no_headline() {
    let mut broken = two(1.0);
    broken[1].status = Status::Diverged {
        time_s: 0.25,
        quantity: "disc angle".to_owned(),
    };
    let mut comparison = judged(&context("paper"), &broken);
    let mut figures = comparison.engines[0].figures.clone();
    figures[0].efficiency = Some(-3.5e12);
    for statistics in figures[0].quantities.values_mut() {
        statistics.mean = -7.125e9;
        statistics.max = -7.125e9;
    }
    comparison.engines[0].figures[0].efficiency = Some(0.925);
    comparison.engines[1].figures = figures;
    let page = page_of(&comparison, &broken);
    let start = page.find("<div class=\"tiles\">").unwrap();
    let tiles = &page[start..start + page[start..].find("</section>").unwrap()];
    assert!(tiles.contains("92.500"), "{tiles}");
    assert!(
        !tiles.contains("3.5") && !tiles.contains("7.125"),
        "{tiles}"
    );
}

#[test]
fn loads_nothing() {
    let page = page(&two(1.0));
    // The only addresses are the names of XML spaces and the plotting library's own.
    let strange: Vec<&str> = page
        .match_indices("://")
        .map(|(at, _)| &page[at.saturating_sub(6)..(at + 40).min(page.len())])
        .filter(|text| {
            !text.contains("www.w3.org/2000/svg") && !text.contains("github.com/leeoniya/uPlot")
        })
        .collect();
    assert!(strange.is_empty(), "{strange:?}");
    let banned = "<link rel=\"stylesheet\"| src=\"|@import|url(|fetch(|XMLHttp";
    // A chart's own clip path is no address.
    let page = page.replace("url(#area)", "");
    for banned in banned.split('|') {
        assert!(!page.contains(banned), "{banned}");
    }
    assert!(page.contains("default-src 'none'"));
}

#[test]
fn nothing_breaks_out() {
    let mut participants = two(1.0);
    participants[1].name = HOSTILE.to_owned();
    participants[1].version = HOSTILE.to_owned();
    participants[1].differences = HOSTILE.to_owned();
    participants[1].summary = HOSTILE.to_owned();
    participants[1].cost.settings = HOSTILE.to_owned();
    participants[1].cost.notes = vec![HOSTILE.to_owned()];
    let mut lost = participant("lost", SharedModel::SharedLaw, 1.0);
    lost.status = Status::Failed {
        reason: HOSTILE.to_owned(),
    };
    let mut other = participant("other", SharedModel::OwnContact, 1.0);
    other.time_series.push(HOSTILE, vec![1.0; 601]).unwrap();
    let participants = [participants.to_vec(), vec![lost, other]].concat();
    let mut context = context(HOSTILE);
    context.description = HOSTILE.to_owned();
    let comparison = judged(&context, &participants);
    let page = page_of(&comparison, &participants);
    assert!(!page.contains("<script>alert"), "a script got in");
    assert!(!page.contains("<img"), "an element got in");
    let count = |text: &str| page.matches(text).count();
    // Frame, unpacking, packed tables, plotting library, charts, menu, time series (base64) and their page, motion and its data.
    assert_eq!((count("<script"), count("</script>")), (10, 10));
    assert!(!page.contains("onerror=\""), "an attribute got in");
}

#[test]
fn many_sleeves_stay_below_two_megabytes() {
    let mut participants = two(1.0);
    for participant in &mut participants {
        participant.time_series = rough(200, 6001);
    }
    let page = page(&participants);
    assert!(page.len() < 2_000_000, "{}", page.len());
    assert!(page.contains("evenly spaced channels of larger groups are drawn."));
}

#[test]
fn nobody_finished() {
    let mut lost = participant("lost", SharedModel::Native, 1.0);
    lost.status = Status::Unsupported {
        reason: "no friction".to_owned(),
    };
    lost.time_series = TimeSeries::default();
    let page = page(&[lost]);
    assert!(page.contains("No engine could run this scene") && page.contains("no friction"));
    assert!(!page.contains("chart-data\">"));
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    assert_eq!(page(&two(1.1)), page(&two(1.1)));
}

/// A run that was ended as too dear has words of its own on page and terminal.
#[test]
fn a_run_that_was_ended_is_no_failure() {
    let mut options = Options::quick();
    (options.scenes, options.methods) = (vec!["x".to_owned()], vec![Method::default()]);
    let mut atlas = Atlas::new(options);
    let cell = Cell {
        dearer_than: atlas.options.most_evaluations,
        ..Cell::default()
    };
    atlas.rows[0] = Some(SceneRow {
        scene: "x".to_owned(),
        why: String::new(),
        auto: String::new(),
        reference: None,
        refused: None,
        cells: vec![cell],
    });
    let page = pinwheel_report::pages::stability::page(
        &atlas,
        &Provenance::here("pinwheel stability --quick".to_owned()),
    );
    let text = pinwheel_report::pages::stability::text(&atlas);
    for shown in [&page, &text] {
        assert!(shown.contains("dearer than 200000 evaluations"), "{shown}");
    }
    let cells = page.matches(">not run to the end<").count();
    assert_eq!(cells, 4, "one in each map");
    assert!(!text.contains("fails in"), "{text}");
    assert!(text.contains("0 of 1"), "{text}");
}
