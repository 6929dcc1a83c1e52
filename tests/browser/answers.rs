//! A reader's questions, answered on the first screen of a page and on the terminal.

use serde_json::Value;

use crate::chromium::{Chromium, DESK, PHONE, browse};
use pinwheel_tests::{run_in, words};

/// Questions on a comparison, with a regular expression of the answer.
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

/// Returns the text of a page's answer above a height.
fn first_screen(browser: &mut Chromium, height: u32) -> String {
    browser.text(&format!(
        "[...document.querySelectorAll('.answer *')].filter((e) => e.getBoundingClientRect().bottom < {height}).filter((e) => ![...e.children].some((c) => c.matches('p, dt, dd, div, dl'))).map((e) => e.textContent).join(' ')"
    ))
}

/// Returns questions in their form for the terminal.
fn on_terminal() -> [(&'static str, &'static str); 11] {
    let mut asked = ASKED;
    asked[0].1 = r"Ring pin force, largest [\d.]+ N";
    asked
}

/// Checks that every question has its answer, a regular expression in the browser's syntax.
fn answered(browser: &mut Chromium, place: &str, text: &str, asked: &[(&str, &str)]) {
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = Value::String(text);
    let missing = asked.iter().find(|(_, answer)| {
        browser.evaluate(&format!("/{answer}/.test({text})")) != Value::Bool(true)
    });
    assert_eq!(missing, None, "{place}: {text}");
}

const INIT: &str = "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500 --ideal";

/// A gear of a catalogue's size, an RV gear and a gear with errors.
fn on_the_first_screen() {
    browse(|browser, dir| {
        assert_eq!(run_in(dir, words(INIT)).code, Some(0));
        // Engines with two reasons for omission make the terminal's answer longest.
        let left_out = match cfg!(feature = "crossval") {
            true => {
                ",rapier-own-contact-hook,rapier-own-contact-colliders,mujoco-own-contact,exudyn-own-contact"
            }
            false => "",
        };
        for (scene, more, fold) in [
            ("rv-40e-like", "", 900),
            ("toleranced", left_out, 900),
            ("gear.toml", "", 800),
        ] {
            let compare = format!(
                "compare {scene} --engines native-reduced,native-lagrange,rapier-shared-law{more} --set solver.duration_s=0.004 --out r --force"
            );
            let done = run_in(dir, words(&compare));
            // A missing named engine is an error.
            let code = if more.is_empty() { 0 } else { 3 };
            assert_eq!(done.code, Some(code), "{done:?}");
            assert!(done.stdout.lines().count() <= 30, "{}", done.stdout);
            browser.open(&dir.join("r/index.html"), DESK);
            let screen = first_screen(browser, fold);
            answered(browser, scene, &screen, &ASKED);
            answered(browser, scene, &done.stdout, &on_terminal());
            let widest = done.stdout.lines().map(|line| line.chars().count()).max();
            assert!(widest <= Some(80), "{}", done.stdout);
        }
        // On a phone the verdict, the force and its bounds.
        browser.look(PHONE);
        browser.evaluate("new Promise((r) => setTimeout(r, 100))");
        let phone = first_screen(browser, 844);
        answered(browser, "phone", &phone, &ASKED[..4]);
    });
}

/// Questions on a run, and on a design.
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

fn of_run_and_design() {
    browse(|browser, dir| {
        assert_eq!(run_in(dir, words(INIT)).code, Some(0));
        let run = run_in(dir, words("run gear.toml --set solver.duration_s=0.004"));
        answered(browser, "run", &run.stdout, &ASKED_OF_A_RUN);
        let design = run_in(dir, words("design gear.toml --out d"));
        let lines = design.stdout.lines().count();
        assert!(lines <= 50, "{lines} lines: {}", design.stdout);
        browser.open(&dir.join("d/index.html"), DESK);
        let screen = first_screen(browser, 900);
        answered(browser, "page of design", &screen, &ASKED_OF_A_DESIGN);
        // A table spreads a figure's name over several lines, so its parts are searched.
        let of_table: Vec<_> = ASKED_OF_A_DESIGN[5..]
            .iter()
            .map(|row| ("", row.1))
            .collect();
        answered(browser, "design", &design.stdout, &of_table);
    });
}

#[test]
fn browser_answers_questions() {
    on_the_first_screen();
    of_run_and_design();
}
