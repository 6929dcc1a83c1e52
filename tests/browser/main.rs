//! The pages in a real browser: no complaint in the console, every figure drawn, nothing wider than the
//! screen, on a phone and a desk, in the light and in the dark.
//!
//! Without Chromium these tests say that they were skipped; with `PINWHEEL_REQUIRE_BROWSER` set they fail.

#![allow(clippy::unwrap_used, reason = "tests")]

mod access;
mod amber;
mod chromium;
mod explore;
mod hostile;
mod interact;
mod motion;
mod studies;

use std::path::{Path, PathBuf};

use access::ACCESS;
use chromium::{Chromium, Look};
use interact::{DESK, PHONE, text};
use pinwheel_tests::{run_in, words};
use serde_json::Value;

/// A phone, a tablet, a laptop and a desk.
const WIDTHS: [u32; 4] = [PHONE.width, 768, DESK.width, 1920];

/// Whether this width is pictured and shown to axe-core: the rules that depend on a width are the tests' own, looked at in all.
fn closely(width: u32) -> bool {
    [PHONE.width, DESK.width].contains(&width)
}

/// What a page looks like from inside, once all that can be opened is open.
const LOOK_AT: &str = r#"(async () => {
  const rest = () => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(r, 100))));
  document.querySelectorAll('details').forEach((d) => { d.open = true; });
  await rest();
  await rest();
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
  const canvases = [...document.querySelectorAll('main canvas')].filter((c) => c.offsetParent !== null);
  const blank = canvases.filter((canvas) => {
    const { width, height } = canvas;
    if (!width || !height) return true;
    const data = canvas.getContext('2d').getImageData(0, 0, width, height).data;
    const curve = Boolean(canvas.closest('.uplot'));
    const colours = new Set();
    let hits = 0;
    for (let k = 0; k < data.length; k += 4) {
      if (data[k + 3] < 250) continue;
      const pixel = [data[k], data[k + 1], data[k + 2]];
      if (curve ? lines.some((line) => near(line, pixel)) : true) hits += 1;
      if (colours.size < 50) colours.add(pixel.join());
    }
    return curve ? hits < 20 : colours.size < 5;
  }).map((canvas) => canvas.closest('figure, section, .panel')?.textContent.trim().slice(0, 60) || canvas.outerHTML);
  const room = document.documentElement.clientWidth;
  const wide = [...document.querySelectorAll('main *, header *, footer *')].filter((e) => {
    const box = e.getBoundingClientRect();
    return box.width > 0 && box.right > room + 1 && !e.closest('.scroll, pre, nav, .shared_error, svg');
  }).slice(0, 5).map((e) => e.outerHTML.slice(0, 120));
  return {
    canvases: canvases.length, blank, wide,
    plots: document.querySelectorAll('main .uplot').length,
    waiting: [...document.querySelectorAll('[data-chart]')].filter((h) => !h.querySelector('.uplot')).length,
    gearboxes: document.querySelectorAll('.gearboxes[data-ready]').length,
    overflow: document.documentElement.scrollWidth - room,
    ground: (ground[0] + ground[1] + ground[2]) / 3,
  };
})()"#;

/// Curves that are in a legend and not to be seen when all others are hidden: lines as well as points, one at a time, for
/// curves that agree lie on each other.
const SERIES: &str = r#"(async () => {
  const rest = () => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(r, 30))));
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
        for (let k = 0; k < data.length; k += 4) {
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

/// Everything that is wrong with the open page in one look.
fn faults(browser: &mut Chromium, look: Look) -> (Vec<String>, Value) {
    browser.theme(look);
    let mut seen = browser.evaluate(LOOK_AT);
    seen["access"] = browser.evaluate(ACCESS);
    let mut faults: Vec<String> = browser.complaints().to_vec();
    let mut list = |what: &str, key: &str| {
        let found = seen[key].as_array().unwrap();
        faults.extend(found.iter().map(|v| format!("{what}: {v}")));
    };
    list("not drawn", "blank");
    list("too wide", "wide");
    list("not for everyone", "access");
    if closely(look.width) {
        faults.extend(access::findings(browser));
    }
    if seen["overflow"].as_i64().unwrap() > 0 {
        faults.push(format!("{} px wider than the screen", seen["overflow"]));
    }
    if seen["waiting"].as_i64().unwrap() > 0 {
        faults.push(format!("{} charts never drawn", seen["waiting"]));
    }
    let ground = seen["ground"].as_f64().unwrap();
    if look.dark != (ground < 100.0) {
        faults.push(format!(
            "ground of {ground} in the {}",
            if look.dark { "dark" } else { "light" }
        ));
    }
    (faults, seen)
}

/// A page at all widths in both themes, with at least so many plots and moving gearboxes; pictures of it are kept in
/// `target/screenshots`.
fn flawless(browser: &mut Chromium, name: &str, page: &Path, plots: u64, gearboxes: u64) {
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("screenshots");
    let mut wrong = Vec::new();
    for width in WIDTHS {
        for dark in [false, true] {
            let still = true;
            let look = Look { width, dark, still };
            let theme = if dark { "dark" } else { "light" };
            // The theme is changed as a reader does: with the page open.
            if dark {
                browser.theme(look);
            } else {
                browser.open(page, look);
            }
            browser.evaluate("new Promise((r) => setTimeout(r, 250))");
            if closely(width) {
                browser.picture(&kept.join(format!("{name}-{width}-{theme}.png")));
            }
            let (faults, seen) = faults(browser, look);
            wrong.extend(faults.iter().map(|f| format!("{width} {theme}: {f}")));
            assert!(seen["plots"].as_u64().unwrap() >= plots, "{seen}");
            if width == 1280 && !dark {
                let series = browser.evaluate(SERIES);
                let missing = series["faults"].as_array().unwrap();
                wrong.extend(missing.iter().map(|f| format!("a curve is not drawn: {f}")));
                assert!(series["looked"].as_u64().unwrap() >= plots, "{series}");
            }
            assert_eq!(seen["gearboxes"].as_u64().unwrap(), gearboxes, "{seen}");
        }
    }
    assert!(wrong.is_empty(), "{}: {wrong:#?}", page.display());
}

#[test]
fn browser_sees_what_is_wrong() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let page = dir.path().join("bad.html");
    std::fs::write(
        &page,
        "<!doctype html><title>x</title><body style='background:#fff'><main><canvas width=40 height=40></canvas>\
         <div style='width:3000px'>wide</div><p style='color:#e08a00'>pale</p><button></button></main><header></header>\
         <script>absent()</script>",
    )
    .unwrap();
    let look = Look {
        width: 1280,
        dark: true,
        still: true,
    };
    browser.open(&page, look);
    let (found, _) = faults(&mut browser, look);
    if std::env::var_os("PINWHEEL_AXE").is_some() {
        for rule in ["axe: color-contrast", "axe: button-name"] {
            assert!(found.iter().any(|f| f.starts_with(rule)), "{found:#?}");
        }
    }
    for part in [
        "contrast 2.6",
        "no name: <button>",
        "not one h1",
        "no nav",
        "exception",
        "not drawn",
        "too wide",
        "wider than the screen",
        "ground of",
    ] {
        assert!(
            found.iter().any(|f| f.contains(part)),
            "{part} is not in {found:#?}"
        );
    }
}

/// It happened: points without a width were never seen, and the chart looked like one with fewer curves.
#[test]
fn browser_misses_curves_that_are_not_drawn() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let done = run_in(dir.path(), ["design", "paper", "--statics", "--out", "d"]);
    assert_eq!(done.code, Some(0), "{done:?}");
    let page = dir.path().join("d/index.html");
    let text = std::fs::read_to_string(&page).unwrap();
    let look = Look {
        width: 1280,
        dark: false,
        still: true,
    };
    let mut missing = |broken: &[(&str, &str)]| {
        let mut text = text.clone();
        for (sound, fault) in broken {
            assert!(text.contains(sound), "{sound} is not in the page");
            text = text.replace(sound, fault);
        }
        std::fs::write(&page, text).unwrap();
        browser.open(&page, look);
        browser.evaluate(SERIES)["faults"].as_array().unwrap().len()
    };
    assert_eq!(missing(&[]), 0);
    // Points of the chart of orders.
    let width = "...(series.marks ? { width: 0 } : {})";
    assert!(missing(&[(width, "width: undefined")]) > 0);
    // Every line.
    assert!(missing(&[("series.thin ? 1 : 1.6", "series.thin ? 1 : 0")]) > 0);
}

/// The page of a short comparison, in `dir`.
fn comparison(dir: &Path) -> PathBuf {
    let args = words(
        "compare paper --engines native-reduced,native-lagrange --set \
         solver.duration_s=0.02 --out r",
    );
    let done = run_in(dir, args);
    assert_eq!(done.code, Some(0), "{done:?}");
    dir.join("r/index.html")
}

#[test]
fn browser_shows_the_comparison() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let page = comparison(dir.path());
    flawless(&mut browser, "compare", &page, 2, 1);
    assert!(std::fs::metadata(&page).unwrap().len() < 2_000_000);
}

/// What a reader asks, and how the first screen answers.
const ASKED: [(&str, &str); 11] = [
    (
        "which force may I use",
        r"largest pin force [\d.]+ N external",
    ),
    ("how exact is it numerically", r"\u00b1.* numerical"),
    (
        "what would another contact law give",
        r"\d+ to \d+ by (contact )?law",
    ),
    ("who agrees", r"\d engines of \d programs agree"),
    ("by how much", r"D = .*U = "),
    ("is the step short enough", r"of the exact solution"),
    (
        "were the contacts checked",
        r"contacts\s*(✓|!|not checked|agree)",
    ),
    ("who differs most", r"differs most\s.* here, .* by rapier"),
    ("what does the fit do", r"profile cut by 5"),
    ("what was not checked", r"--features crossval|--engines"),
    (
        "was anything measured, and what next",
        r"nothing here is measured[^]*pinwheel design|pinwheel design[^]*nothing here is measured",
    ),
];

/// Ten questions and one more, each answered above the fold of a laptop.
#[test]
fn browser_answers_on_the_first_screen() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let init =
        "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    assert_eq!(run_in(dir.path(), words(init)).code, Some(0));
    let compare =
        "compare gear.toml --engines native-reduced,native-lagrange,rapier-shared-law --out r";
    let done = run_in(dir.path(), words(compare));
    assert_eq!(done.code, Some(0), "{done:?}");
    assert!(done.stdout.lines().count() <= 30, "{}", done.stdout);
    let widest = done.stdout.lines().map(|line| line.chars().count()).max();
    assert!(widest <= Some(80), "{}", done.stdout);
    let page = dir.path().join("r/index.html");
    let look = |width| Look {
        width,
        dark: false,
        still: true,
    };
    browser.open(&page, look(1280));
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("screenshots");
    browser.top(&kept.join("first-1280.png"), 800);
    let screen = first_screen(&mut browser, 800);
    answered(&mut browser, "page", &screen, &ASKED);
    answered(&mut browser, "terminal", &done.stdout, &on_terminal());
    // On a phone the verdict, the force and its bounds.
    browser.open(&page, look(390));
    browser.top(&kept.join("first-390.png"), 844);
    let phone = first_screen(&mut browser, 844);
    answered(&mut browser, "phone", &phone, &ASKED[..4]);
}

/// Text of a page's answer above that height.
fn first_screen(browser: &mut Chromium, height: u32) -> String {
    text(
        browser,
        &format!(
            "[...document.querySelectorAll('.answer *')].filter((e) => e.getBoundingClientRect().bottom < {height}).filter((e) => ![...e.children].some((c) => c.matches('p, dt, dd, div, dl'))).map((e) => e.textContent).join(' ')"
        ),
    )
}

/// The same questions of the terminal.
fn on_terminal() -> [(&'static str, &'static str); 11] {
    let mut asked = ASKED;
    asked[0].1 = r"External force, largest [\d.]+ N";
    asked
}

/// Every question finds its answer, a regular expression of the browser.
fn answered(browser: &mut Chromium, place: &str, text: &str, asked: &[(&str, &str)]) {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = Value::String(text);
    let missing = asked.iter().find(|(_, answer)| {
        browser.evaluate(&format!("/{answer}/.test({text})")) != Value::Bool(true)
    });
    assert_eq!(missing, None, "{place}: {text}");
}

/// The same of an RV gear and of a gear with errors.
#[test]
fn browser_answers_of_other_gears() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    // Engines that have two reasons not to run make the terminal's answer longest.
    let left_out = match cfg!(feature = "crossval") {
        true => {
            ",rapier-own-contact-hook,rapier-own-contact-colliders,mujoco-own-contact,exudyn-own-contact"
        }
        false => "",
    };
    for (preset, more) in [("rv-40e-like", ""), ("toleranced", left_out)] {
        let compare = format!(
            "compare {preset} --engines native-reduced,native-lagrange,rapier-shared-law{more} --set solver.duration_s=0.004 --out {preset}"
        );
        let done = run_in(dir.path(), words(&compare));
        // What was asked for and left out is an error.
        let code = if more.is_empty() { 0 } else { 3 };
        assert_eq!(done.code, Some(code), "{done:?}");
        assert!(done.stdout.lines().count() <= 30, "{}", done.stdout);
        browser.open(&dir.path().join(preset).join("index.html"), interact::DESK);
        let screen = first_screen(&mut browser, 900);
        answered(&mut browser, preset, &screen, &ASKED);
        answered(&mut browser, preset, &done.stdout, &on_terminal());
    }
}

/// What is asked of a run, and of a design.
const ASKED_OF_A_RUN: [(&str, &str); 10] = [
    ("which force may I use", r"external forces peak [\d.]+"),
    ("which force inside", r"internal forces peak [\d.]+"),
    ("which torque drives it", r"driver torque mean [\d.]+"),
    ("what would another law give", r"\d+ to \d+ by contact law"),
    ("how exact is it", r"\u00b1 .*numerical"),
    ("is the law validated", "not validated by measurement"),
    ("what does the fit do", "profile cut by 5"),
    ("how efficient, or why not", "no loss modelled"),
    ("which engine, and how", "engine native.* settings "),
    ("where are the data", r"courses \S+courses\.csv"),
];
const ASKED_OF_A_DESIGN: [(&str, &str); 11] = [
    ("how stiff", r"torsional stiffness [\d.]+"),
    ("how much is lost", r"lost motion [\d.]+"),
    ("how uneven", r"transmission error, rated load [\d.]+"),
    ("which force", r"largest pin force, external [\d.]+"),
    ("which pressure", r"largest pressure(, external)? [\d.]+"),
    ("what would another law give", r"310 to 322"),
    ("is the law validated", "not validated by measurement"),
    ("what is rigid", "pins, discs and housing are rigid here"),
    ("what does the fit do", "profile cut by 5"),
    ("how efficient, or why not", "no loss modelled"),
    ("what next", "pinwheel compare"),
];

#[test]
fn browser_answers_of_run_and_design() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let init =
        "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    assert_eq!(run_in(dir.path(), words(init)).code, Some(0));
    let run = run_in(
        dir.path(),
        words("run gear.toml --set solver.duration_s=0.004"),
    );
    answered(&mut browser, "run", &run.stdout, &ASKED_OF_A_RUN);
    let design = run_in(dir.path(), words("design gear.toml --out d"));
    let lines = design.stdout.lines().count();
    assert!(lines <= 50, "{lines} lines: {}", design.stdout);
    browser.open(&dir.path().join("d/index.html"), interact::DESK);
    let screen = first_screen(&mut browser, 900);
    answered(&mut browser, "page of design", &screen, &ASKED_OF_A_DESIGN);
    // A table says a figure's name over several lines; there they are found by what they are of.
    for (_, answer) in ASKED_OF_A_DESIGN.iter().skip(5) {
        answered(&mut browser, "design", &design.stdout, &[("", answer)]);
    }
}

#[test]
fn browser_does_what_is_asked() {
    let questions = [
        interact::charts_answer,
        interact::keys_do_it_all,
        interact::mice_scrub,
        interact::phones_are_served,
        interact::the_dark_reaches_the_charts,
        interact::paper_is_spared,
        interact::old_browsers_read_it,
    ];
    let dir = tempfile::tempdir().unwrap();
    let page = comparison(dir.path());
    for question in questions {
        if let Some(mut browser) = Chromium::start() {
            question(&mut browser, &page);
        }
    }
}

/// Every question can be answered with no: a page with one fault in its script fails the one that is about it.
#[test]
#[ignore = "a minute; run it after a change of these tests or of the page's scripts"]
fn browser_questions_see_broken_pages() {
    type Question = fn(&mut Chromium, &Path);
    let faults: [(&str, &str, &str, Question); 13] = [
        (
            "zoom by a drag",
            "drag: { x: true,",
            "drag: { x: false,",
            interact::charts_answer,
        ),
        (
            "zoom by a button",
            "in: [0.25, -0.25]",
            "in: [0, 0]",
            interact::charts_answer,
        ),
        (
            "toggle",
            "state.visible[e] = on;",
            "",
            interact::charts_answer,
        ),
        (
            "values at the cursor",
            "box.hidden = false;",
            "",
            interact::charts_answer,
        ),
        (
            "select a channel",
            "state.channel = Number(channelSelect.value);",
            "",
            interact::charts_answer,
        ),
        (
            "select another base",
            "state.base = Number(baseSelect.value);",
            "",
            interact::charts_answer,
        ),
        (
            "keys of a chart",
            "ArrowRight: () => cursor(current + step)",
            "ArrowRight: () => 0",
            interact::keys_do_it_all,
        ),
        (
            "fold",
            "if (e.tagName === 'DETAILS') e.open = true;",
            "",
            interact::keys_do_it_all,
        ),
        (
            "sort",
            "rising ? order : -order",
            "order",
            interact::keys_do_it_all,
        ),
        (
            "scrub",
            "slider.addEventListener('input'",
            "slider.addEventListener('nothing'",
            interact::mice_scrub,
        ),
        (
            "fingers",
            "if (event.pointerType !== 'touch') return;",
            "return;",
            interact::phones_are_served,
        ),
        (
            "dark",
            "redraw() { known = new Map(); build(); }",
            "redraw() { build(); }",
            interact::the_dark_reaches_the_charts,
        ),
        (
            "print",
            ".topbar, .chart-controls, .chart-help, .skip, #copy,",
            ".skip, #copy,",
            interact::paper_is_spared,
        ),
    ];
    let dir = tempfile::tempdir().unwrap();
    let page = comparison(dir.path());
    let text = std::fs::read_to_string(&page).unwrap();
    let broken = dir.path().join("broken.html");
    for (what, sound, fault, question) in faults {
        let Some(mut browser) = Chromium::start() else {
            return;
        };
        assert!(text.contains(sound), "{what}: {sound} is not in the page");
        std::fs::write(&broken, text.replace(sound, fault)).unwrap();
        let asked = || question(&mut browser, &broken);
        let answer = std::panic::catch_unwind(std::panic::AssertUnwindSafe(asked));
        assert!(answer.is_err(), "{what}: nobody saw that it is broken");
    }
}

/// The pictures in the documents, from the pages as they are: `-- --ignored pictures`.
#[test]
#[ignore = "writes docs/report.png and docs/paper.png; minutes"]
fn pictures_of_the_documents() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    for (words, name, high) in [
        (&["compare", "paper", "--out", "report"][..], "report", 900),
        (&["paper", "--out", "paper"][..], "paper", 1000),
    ] {
        // Pages that are there already, for example by a build with all engines.
        let made = std::env::var_os("PINWHEEL_PAGES").map(PathBuf::from);
        let place = made.unwrap_or_else(|| {
            let done = run_in(dir.path(), words);
            assert_eq!(done.code, Some(0), "{done:?}");
            dir.path().to_owned()
        });
        let look = Look {
            width: 1280,
            dark: false,
            still: true,
        };
        browser.open(&place.join(name).join("index.html"), look);
        browser.evaluate("new Promise((r) => setTimeout(r, 1500))");
        let file = pinwheel_tests::repository(&format!("docs/{name}.png"));
        browser.top(&file, high);
        let bytes = std::fs::metadata(&file).unwrap().len();
        assert!(bytes < 300_000, "{}: {bytes} bytes", file.display());
    }
}

/// Four questions side by side, each in a browser of its own: what they do most is wait for frames.
#[test]
fn browser_moves_the_gearbox() {
    let questions = [
        motion::moves,
        motion::frames_cost_little,
        motion::nothing_is_drawn_unseen,
        motion::late_frames_cost_sharpness,
    ];
    let dir = tempfile::tempdir().unwrap();
    let page = comparison(dir.path());
    std::thread::scope(|scope| {
        for question in questions {
            let page = &page;
            scope.spawn(move || {
                if let Some(mut browser) = Chromium::start() {
                    question(&mut browser, page);
                }
            });
        }
    });
}

#[test]
fn browser_shows_the_paper() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let done = run_in(dir.path(), ["paper", "--figures", "9", "--out", "p"]);
    assert_eq!(done.code, Some(0), "{done:?}");
    flawless(
        &mut browser,
        "paper",
        &dir.path().join("p/index.html"),
        2,
        1,
    );
    let summary: Value =
        serde_json::from_str(&std::fs::read_to_string(dir.path().join("p/summary.json")).unwrap())
            .unwrap();
    assert_eq!(summary["figures"][0]["verdict"], "holds");
    // The counts of the first screen are those of all rows.
    let banner = browser.evaluate("document.querySelector('.banner').innerText");
    let numbers = banner
        .as_str()
        .unwrap()
        .split(|c: char| !c.is_ascii_digit());
    let numbers: Vec<usize> = numbers.filter_map(|word| word.parse().ok()).collect();
    let rows = |key: &str| summary[key].as_array().unwrap().len();
    let [holds, all, sometimes, not, meaningless, _runs] = numbers[..] else {
        panic!("{banner}");
    };
    assert_eq!(holds + sometimes + not + meaningless, all, "{banner}");
    assert_eq!(all, rows("figures") + rows("claims"), "{banner}");
    // Two gearboxes took a sheet each in print.
    browser.media("print");
    let wide = browser.evaluate("document.querySelector('.gearbox-view canvas').clientWidth");
    assert!(wide.as_u64().unwrap() < 250, "{wide} px wide");
    browser.media("");
    let time_series = std::fs::read_to_string(dir.path().join("p/fig-09a/courses.csv")).unwrap();
    assert!(time_series.starts_with("time_s,") && time_series.lines().count() > 1000);
}
