//! Pages in a real browser: no complaint in the console, every figure drawn, nothing wider than the screen, on a phone and
//! a desk, in both themes.
//!
//! Without Chromium these tests print that they are skipped; with `PINWHEEL_REQUIRE_BROWSER` they fail.

#![allow(clippy::unwrap_used, reason = "tests")]

mod access;
mod amber;
mod answers;
mod chromium;
mod explore;
mod hostile;
mod interact;
mod motion;
mod studies;

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use access::ACCESS;
use chromium::{Chromium, DESK, Look, PHONE, browse};
use pinwheel_tests::{repository, run_in, words};
use serde_json::Value;

/// A laptop in both themes, then a desk, a tablet and a phone.
const LOOKS: [Look; 5] = [
    DESK,
    Look { dark: true, ..DESK },
    Look {
        width: 1920,
        ..DESK
    },
    Look { width: 768, ..DESK },
    PHONE,
];

/// Waits until visible charts and gearboxes are drawn, at most a quarter of a second.
const LOADED: &str = "(async () => { \
    const waits = () => [...document.querySelectorAll('.gearboxes:not([data-ready]), [data-chart]:not(:has(.uplot))')].some((e) => e.checkVisibility()); \
    for (let k = 0; k < 25 && waits(); k += 1) await new Promise((r) => setTimeout(r, 10)); })()";

/// Script that returns faults of the drawn page, with every `details` open.
const LOOK_AT: &str = r#"(async () => {
  const rest = (ms) => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(r, ms))));
  document.querySelectorAll('details').forEach((d) => { d.open = true; });
  await rest(20);
  const probe = document.body.appendChild(document.createElement('i'));
  const rgb = (text) => {
    probe.style.color = text;
    const pen = new OffscreenCanvas(1, 1).getContext('2d');
    pen.fillStyle = getComputedStyle(probe).color;
    pen.fillRect(0, 0, 1, 1);
    return [...pen.getImageData(0, 0, 1, 1).data];
  };
  const lines = Array.from({ length: 16 }, (_, k) => rgb(`var(--line-${k})`));
  const near = (a, b) => Math.abs(a[0] - b[0]) + Math.abs(a[1] - b[1]) + Math.abs(a[2] - b[2]) < 24;
  const ground = rgb(getComputedStyle(document.body).backgroundColor);
  probe.remove();
  const canvases = () => [...document.querySelectorAll('main canvas')].filter((c) => c.offsetParent !== null);
  const blanks = () => canvases().filter((canvas) => {
    const { width, height } = canvas;
    if (!width || !height) return true;
    const data = canvas.getContext('2d').getImageData(0, 0, width, height).data;
    const curve = Boolean(canvas.closest('.uplot'));
    const colours = new Set();
    let hits = 0;
    for (let k = 0; k < data.length && (curve ? hits < 20 : colours.size < 5); k += 4) {
      if (data[k + 3] < 250) continue;
      const pixel = [data[k], data[k + 1], data[k + 2]];
      if (curve) hits += Number(lines.some((line) => near(line, pixel)));
      else colours.add(pixel.join());
    }
    return curve ? hits < 20 : colours.size < 5;
  }).map((canvas) => canvas.closest('figure, section, .panel')?.textContent.trim().slice(0, 60) || canvas.outerHTML);
  const waits = () => [...document.querySelectorAll('[data-chart]')].filter((h) => !h.querySelector('.uplot')).length;
  let blank = blanks();
  for (let k = 0; k < (window.patience ?? 120) && (waits() || blank.length); k += 1) {
    await rest(20);
    blank = blanks();
  }
  const room = document.documentElement.clientWidth;
  const wide = [...document.querySelectorAll('main *, header *, footer *')].filter((e) => {
    const box = e.getBoundingClientRect();
    return box.width > 0 && box.right > room + 1 && !e.closest('.scroll, pre, nav, .unseen, svg');
  }).slice(0, 5).map((e) => e.outerHTML.slice(0, 120));
  return {
    blank, wide, waiting: waits(),
    plots: document.querySelectorAll('main .uplot').length,
    gearboxes: document.querySelectorAll('.gearboxes[data-ready]').length,
    overflow: document.documentElement.scrollWidth - room,
    ground: (ground[0] + ground[1] + ground[2]) / 3,
  };
})()"#;

/// Script that returns invisible curves of a legend: lines and points one at a time with all others hidden, because equal
/// curves overlap.
const SERIES: &str = r#"(async () => {
  const rest = () => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)));
  const pen = new OffscreenCanvas(1, 1).getContext('2d');
  const rgb = (colour) => { pen.fillStyle = colour; pen.fillRect(0, 0, 1, 1); return pen.getImageData(0, 0, 1, 1).data; };
  const faults = [];
  let looked = 0;
  for (const legend of document.querySelectorAll('.legend')) {
    const chips = [...legend.querySelectorAll('.chip')];
    const panel = legend.closest('.panel') || document.getElementById('chart');
    const set = (chip, on) => { if ((chip.getAttribute('aria-pressed') === 'true') !== on) chip.click(); };
    for (const chip of chips) {
      chips.forEach((other) => set(other, other === chip));
      await rest();
      const wanted = rgb(getComputedStyle(chip.querySelector('path')).stroke);
      let hits = 0;
      for (const canvas of panel.querySelectorAll('.uplot canvas')) {
        const { data } = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        for (let k = 0; k < data.length && hits < 12; k += 4) {
          if (data[k + 3] > 100 && Math.abs(data[k] - wanted[0]) + Math.abs(data[k + 1] - wanted[1]) + Math.abs(data[k + 2] - wanted[2]) < 40) hits += 1;
        }
      }
      looked += 1;
      if (hits < 12) faults.push(`${panel.querySelector('h3')?.textContent}: ${chip.textContent}: ${hits} pixels`);
    }
    chips.forEach((chip) => set(chip, true));
  }
  return { looked, faults };
})()"#;

/// Returns faults of the open page in one look, and its layout.
fn faults(browser: &mut Chromium, look: Look) -> (Vec<String>, Value) {
    browser.look(look);
    let mut layout = browser.evaluate(LOOK_AT);
    // Widths between these two have the same elements.
    layout["access"] = serde_json::json!([]);
    if [DESK.width, PHONE.width].contains(&look.width) {
        layout["access"] = browser.evaluate(ACCESS);
    }
    let mut faults = browser.complaints.clone();
    for (what, key) in [
        ("not drawn", "blank"),
        ("too wide", "wide"),
        ("not for everyone", "access"),
    ] {
        let list = layout[key].as_array().unwrap();
        faults.extend(list.iter().map(|fault| format!("{what}: {fault}")));
    }
    for (key, what) in [
        ("overflow", "px wider than the screen"),
        ("waiting", "charts never drawn"),
    ] {
        if layout[key].as_i64().unwrap() > 0 {
            faults.push(format!("{} {what}", layout[key]));
        }
    }
    let ground = layout["ground"].as_f64().unwrap();
    if look.dark != (ground < 100.0) {
        faults.push(format!("ground of {ground}, dark: {}", look.dark));
    }
    (faults, layout)
}

/// Checks a page in every look, opened once. It has at least these numbers of plots and moving gearboxes, and takes at most
/// this number of printed sheets. Pictures of faults, or with `PINWHEEL_PICTURES` of all looks, are in
/// `target/screenshots`.
fn flawless(browser: &mut Chromium, page: &Path, [plots, gearboxes, sheets]: [usize; 3]) {
    let test = std::thread::current().name().unwrap().replace("::", "-");
    let folder = page.parent().and_then(Path::file_name).unwrap();
    let name = format!("{test}-{}", folder.display());
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("screenshots");
    browser.open(page, DESK);
    browser.evaluate(LOADED);
    let printed = browser.sheets();
    assert!(printed <= sheets, "{printed} sheets");
    let mut wrong = Vec::new();
    for look in LOOKS {
        let (mut faults, layout) = faults(browser, look);
        // Our own checks cover contrast in the dark and names on a phone.
        if look == DESK {
            faults.extend(access::findings(browser, look));
        }
        let count = |key: &str| layout[key].as_u64().unwrap() as usize;
        assert!(count("plots") >= plots, "{layout}");
        assert_eq!(count("gearboxes"), gearboxes, "{layout}");
        let theme = ["light", "dark"][usize::from(look.dark)];
        let shown = format!("{name}-{}-{theme}", look.width);
        if !faults.is_empty() || std::env::var_os("PINWHEEL_PICTURES").is_some() {
            browser.picture(&kept.join(format!("{shown}.png")), None);
        }
        if look == DESK {
            let series = browser.evaluate(SERIES);
            let missing = series["faults"].as_array().unwrap();
            faults.extend(missing.iter().map(|f| format!("a curve is not drawn: {f}")));
            assert!(
                series["looked"].as_u64().unwrap() as usize >= plots,
                "{series}"
            );
        }
        wrong.extend(faults.iter().map(|fault| format!("{shown}: {fault}")));
    }
    assert!(wrong.is_empty(), "{}: {wrong:#?}", page.display());
}

#[test]
fn browser_sees_what_is_wrong() {
    browse(|browser, dir| {
        let page = dir.join("bad.html");
        std::fs::write(
            &page,
            "<!doctype html><title>x</title><body style='background:#fff'><main><canvas width=40 height=40></canvas>\
             <div style='width:3000px'>wide</div><p style='color:#e08a00'>pale</p><button></button></main><header></header>\
             <script>patience = 2; absent()</script>",
        )
        .unwrap();
        let look = Look { dark: true, ..DESK };
        browser.open(&page, look);
        let mut complaints = faults(browser, look).0;
        complaints.extend(faults(browser, DESK).0);
        complaints.extend(access::findings(browser, DESK));
        let mut parts = vec![
            "contrast 2.6",
            "no name: <button>",
            "not one h1",
            "no nav",
            "exception",
            "not drawn",
            "too wide",
            "wider than the screen",
            "ground of",
        ];
        if std::env::var_os("PINWHEEL_AXE").is_some() {
            parts.extend(["axe: color-contrast", "axe: button-name"]);
        }
        for part in parts {
            let is_listed = complaints.iter().any(|fault| fault.contains(part));
            assert!(is_listed, "{part} is not in {complaints:#?}");
        }
    });
    // Points without a width are invisible, and the chart looks like one with fewer curves.
    browse(|browser, dir| {
        let done = run_in(dir, ["design", "paper", "--statics", "--out", "d"]);
        assert_eq!(done.code, Some(0), "{done:?}");
        let page = dir.join("d/index.html");
        let text = std::fs::read_to_string(&page).unwrap();
        let mut missing = |sound: &str, fault: &str| {
            assert!(text.contains(sound), "{sound} is not in the page");
            std::fs::write(&page, text.replace(sound, fault)).unwrap();
            browser.open(&page, DESK);
            browser.evaluate(SERIES)["faults"].as_array().unwrap().len()
        };
        // The valid page, points of the chart of orders, every line.
        assert_eq!(missing("", ""), 0);
        assert!(missing("...(series.marks ? { width: 0 } : {})", "width: undefined") > 0);
        assert!(missing("series.thin ? 1 : 1.6", "series.thin ? 1 : 0") > 0);
    });
}

/// Page of a short comparison, written once.
static COMPARISON: LazyLock<PathBuf> = LazyLock::new(|| {
    let args = "compare paper --engines native-reduced,native-lagrange --set solver.duration_s=0.02 --force --out";
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("comparison");
    let done = run_in(
        Path::new("."),
        words(args).iter().map(OsStr::new).chain([dir.as_os_str()]),
    );
    assert_eq!(done.code, Some(0), "{done:?}");
    dir.join("index.html")
});

#[test]
fn browser_shows_the_comparison_and_does_what_is_asked() {
    browse(|browser, _| {
        flawless(browser, &COMPARISON, [2, 1, 4]);
        for look in [LOOKS[1], PHONE] {
            browser.look(look);
            assert_eq!(access::findings(browser, look), [""; 0]);
        }
        assert!(std::fs::metadata(&*COMPARISON).unwrap().len() < 2_000_000);
        for question in [
            motion::moves,
            motion::frames_cost_little,
            motion::nothing_is_drawn_unseen,
            motion::late_frames_cost_sharpness,
            interact::charts_answer,
            interact::charts_are_saved,
            interact::keys_do_it_all,
            interact::mice_scrub,
            interact::phones_are_served,
            interact::the_dark_reaches_the_charts,
            interact::paper_is_spared,
            interact::old_browsers_read_it,
        ] {
            question(browser, &COMPARISON);
        }
    });
}

/// Any fault in a page's script fails the related question.
#[test]
#[ignore = "weekly: a minute; run it after a change of these tests or of the page's scripts"]
fn browser_questions_see_broken_pages() {
    type Question = fn(&mut Chromium, &Path);
    #[rustfmt::skip]
    let faults: [(&str, &str, &str, Question); 16] = [
        ("zoom by a drag", "drag: { x: true,", "drag: { x: false,", interact::charts_answer),
        ("zoom by a button", "in: [0.25, -0.25]", "in: [0, 0]", interact::charts_answer),
        ("toggle", "state.visible[e] = on;", "", interact::charts_answer),
        ("values at the cursor", "box.hidden = false;", "", interact::charts_answer),
        ("select a channel", "state.channel = Number(channelSelect.value);", "", interact::charts_answer),
        ("select another base", "state.base = Number(baseSelect.value);", "", interact::charts_answer),
        ("a curve in a file", "line += pen + place;", "", interact::charts_are_saved),
        ("values in a file", "values[k] ?? ''", "''", interact::charts_are_saved),
        ("nine points", "font-size: 9pt !important", "font-size: 8pt !important", interact::paper_is_spared),
        ("keys of a chart", "ArrowRight: () => cursor(current + step)", "ArrowRight: () => 0", interact::keys_do_it_all),
        ("fold", "if (e.tagName === 'DETAILS') e.open = true;", "", interact::keys_do_it_all),
        ("sort", "rising ? order : -order", "order", interact::keys_do_it_all),
        ("scrub", "slider.addEventListener('input'", "slider.addEventListener('nothing'", interact::mice_scrub),
        ("fingers", "if (event.pointerType !== 'touch') return;", "return;", interact::phones_are_served),
        ("dark", "redraw() { known = new Map(); build(); }", "redraw() { build(); }", interact::the_dark_reaches_the_charts),
        ("print", ".topbar, .chart-controls, .chart-help, .skip, #copy,", ".skip, #copy,", interact::paper_is_spared),
    ];
    for (what, sound, fault, question) in faults {
        browse(|browser, dir| {
            let page = dir.join("index.html");
            let text = std::fs::read_to_string(&*COMPARISON).unwrap();
            assert!(text.contains(sound), "{what}: {sound} is not in the page");
            std::fs::write(&page, text.replace(sound, fault)).unwrap();
            let asked = std::panic::AssertUnwindSafe(|| question(browser, &page));
            let answer = std::panic::catch_unwind(asked);
            assert!(answer.is_err(), "{what}: nobody saw that it is broken");
        });
    }
}

/// Takes the pictures of the documents, of pages in `PINWHEEL_PAGES` if available: `-- --ignored pictures`.
#[test]
#[ignore = "writes docs/report.png and docs/paper.png; minutes"]
fn pictures_of_the_documents() {
    browse(|browser, dir| {
        for (command, name, high) in [
            ("compare paper --out report", "report", 900),
            ("paper --out paper", "paper", 1000),
        ] {
            let made = std::env::var_os("PINWHEEL_PAGES").map(PathBuf::from);
            let place = made.unwrap_or_else(|| {
                let done = run_in(dir, words(command));
                assert_eq!(done.code, Some(0), "{done:?}");
                dir.to_owned()
            });
            browser.open(&place.join(name).join("index.html"), DESK);
            browser.evaluate("new Promise((r) => setTimeout(r, 1500))");
            let file = repository(&format!("docs/{name}.png"));
            browser.picture(&file, Some(high));
            let bytes = std::fs::metadata(&file).unwrap().len();
            assert!(bytes < 300_000, "{}: {bytes} bytes", file.display());
        }
    });
}
