//! The pages of the studies, from small ones.

use std::path::{Path, PathBuf};

use pinwheel_tests::{repository, run_in};
use pinwheel_timeseries::TimeSeries;

use crate::chromium::{Chromium, Look};
use crate::flawless;

/// Runs a study in `dir` and returns its page.
fn page(dir: &Path, words: &[&str]) -> PathBuf {
    let done = run_in(dir, words.iter().chain(&["--out", "o"]));
    assert_eq!(done.code, Some(0), "{words:?} {done:?}");
    dir.join("o/index.html")
}

#[test]
fn browser_shows_the_bench() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let words = "bench paper --engines native,rapier-shared-law --methods rk4,dopri5 --repeats 1 \
                 --set solver.duration_s=0.005";
    let page = page(dir.path(), &words.split_whitespace().collect::<Vec<_>>());
    flawless(&mut browser, "bench", &page, 1, 0);
    let printed = sheets(&mut browser, &page);
    assert!(printed <= 4, "{printed} sheets");
    // The chart comes before any table, and what is depth is folded.
    let seen = browser.evaluate(
        "[document.querySelector('main .uplot').getBoundingClientRect().top + scrollY < 900, \
          document.querySelectorAll('details.depth:not([open])').length >= 3, document.querySelector('.banner').className]",
    );
    assert_eq!(seen, serde_json::json!([true, true, "banner finding"]));
}

#[test]
fn browser_shows_a_sweep() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let sweep = "name = \"small\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.01\n[vary]\n\
                 gear.backlash_m = [0.0, 2.0e-4, 4.0e-4]\ncontact.damping_n_s_m = [8.0, 64.0]\n";
    std::fs::write(dir.path().join("small.toml"), sweep).unwrap();
    let page = page(dir.path(), &["sweep", "small.toml"]);
    flawless(&mut browser, "sweep", &page, 0, 0);
    let printed = sheets(&mut browser, &page);
    assert!(printed <= 2, "{printed} sheets");
    let seen = browser.evaluate(
        "[document.querySelector('.heat-map').getBoundingClientRect().bottom < 900, document.querySelectorAll('details.depth:not([open])').length, \
          document.querySelector('.banner .headline').textContent.startsWith('Ring pin force, peak: '), document.body.textContent.includes('did not finish')]",
    );
    assert_eq!(seen, serde_json::json!([true, 2, true, false]));
    // Two axes are a map; lines, other axes and figures are a choice away.
    let seen = browser.evaluate(
        "(async () => {
          const rest = () => new Promise((r) => setTimeout(r, 200));
          const maps = () => document.querySelectorAll('.heat-map').length;
          const plots = () => document.querySelectorAll('.grid .uplot').length;
          const select = (k, value) => { const s = document.querySelectorAll('.grid select')[k]; s.value = value; s.dispatchEvent(new Event('change')); };
          const seen = [maps(), plots(), document.querySelectorAll('.heat-map td.map').length];
          document.querySelectorAll('.grid .buttons button')[0].click();
          await rest();
          seen.push(maps(), plots(), document.querySelectorAll('.grid .chip').length);
          select(1, '1');
          await rest();
          seen.push(document.querySelectorAll('.grid .chip').length);
          select(0, '1');
          await rest();
          seen.push(plots(), document.querySelectorAll('.grid select')[0].value);
          return seen;
        })()",
    );
    assert_eq!(seen, serde_json::json!([1, 0, 6, 0, 1, 2, 3, 1, "1"]));
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
}

/// A panel for each value of a third axis, named apart.
#[test]
fn browser_shows_a_sweep_over_three_axes() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let sweep = "name = \"three\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.005\n[vary]\n\
                 gear.backlash_m = [0.0, 2.0e-4]\ncontact.damping_n_s_m = [8.0, 64.0]\ndrive.output_torque_n_m = [11.0, 22.0, 33.0]\n";
    std::fs::write(dir.path().join("three.toml"), sweep).unwrap();
    let page = page(dir.path(), &["sweep", "three.toml"]);
    flawless(&mut browser, "sweep-three", &page, 0, 0);
    let seen = browser.evaluate(
        "(() => {
          const maps = [...document.querySelectorAll('.grid .scroll')];
          return [maps.length, new Set(maps.map((m) => m.getAttribute('aria-label'))).size, document.querySelectorAll('.heat-map td.map').length];
        })()",
    );
    // The axis with most values comes first, so that one of two values has the panels.
    assert_eq!(seen, serde_json::json!([2, 2, 12]));
}

/// Measured data come first: drawn, with residual and budget, and with what was done to their times.
#[test]
fn browser_shows_measured_data() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let scene = "base = \"paper\"\nname = \"rigged\"\n[solver]\nduration_s = 0.02\nstep_s = 1e-5\n[uncertain]\n\
                 contact.stiffness_multiplier = { plus_minus = 5e-4 }\n";
    std::fs::write(dir.path().join("rigged.toml"), scene).unwrap();
    let ran = run_in(dir.path(), ["run", "rigged.toml", "--out", "ours"]);
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let ours = TimeSeries::load_csv(&dir.path().join("ours/courses.csv")).unwrap();
    let [torque, force] =
        ["input_torque_n_m", "external_sleeve_force_n_3"].map(|n| ours.channel(n).unwrap());
    let mut text = "t;torque;F_3\n".to_owned();
    for (k, time) in ours.time_s().iter().enumerate().skip(20) {
        text.push_str(&format!(
            "{};{};{}\n",
            time - 0.0021,
            1.004 * torque[k],
            force[k]
        ));
    }
    std::fs::write(dir.path().join("rig.csv"), text).unwrap();
    let map = "name = \"rig\"\n[file]\nseparator = \";\"\n[time]\ncolumn = \"t\"\noffset_s = \"align\"\n[columns]\n\
               input_torque_n_m = { column = \"torque\", uncertainty = { of_reading = 0.005 } }\n\
               external_sleeve_force_n_3 = { column = \"F_3\" }\n";
    std::fs::write(dir.path().join("rig.toml"), map).unwrap();
    let words = "compare rigged.toml --engines native-reduced --against rig.csv --map rig.toml";
    let page = page(dir.path(), &words.split(' ').collect::<Vec<_>>());
    flawless(&mut browser, "measured", &page, 2, 1);
    browser.open(
        &page,
        Look {
            width: 1280,
            dark: false,
            still: true,
        },
    );
    browser.evaluate("new Promise((r) => setTimeout(r, 600))");
    let seen = browser.evaluate(
        "({
          first: document.querySelector('[id^=track] h2').textContent,
          unfolded: document.querySelector('[id^=track] .item').open,
          told: /0\\.00(21|209)\\d* s were added to its times/.test(document.querySelector('[id^=track]').textContent),
          residual: document.querySelector('.plot-title').textContent,
          base: document.getElementById('base').selectedOptions[0].textContent,
          drawn: document.body.dataset.drawn,
          long: /\\d\\.\\d{12}/.exec(document.querySelector('main').innerText)?.[0] || '',
        })",
    );
    let residual =
        "Difference to rig: the residual, and its budget of uncertainty as a strip (about 95 %)";
    assert_eq!(
        seen,
        serde_json::json!({"first": "Measured", "unfolded": true, "told": true, "residual": residual, "base": "rig",
                           "drawn": "Driver torque", "long": ""})
    );
    let printed = sheets(&mut browser, &page);
    assert!(printed <= 3, "{printed} sheets");
}

/// Sheets in print, with everything folded as it opens.
fn sheets(browser: &mut Chromium, page: &Path) -> usize {
    let look = Look {
        width: 1280,
        dark: false,
        still: true,
    };
    browser.open(page, look);
    browser.evaluate("new Promise((r) => setTimeout(r, 400))");
    browser.sheets()
}

#[test]
fn browser_shows_a_design() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let page = page(dir.path(), &["design", "paper-friction"]);
    flawless(&mut browser, "design", &page, 7, 1);
    // Names in backticks are code, in the lead too.
    let lead = browser.evaluate("document.querySelector('.lead').innerHTML");
    let lead = lead.as_str().unwrap();
    assert!(lead.contains("<code>") && !lead.contains('`'), "{lead}");
    let printed = sheets(&mut browser, &page);
    assert!(printed <= 2, "{printed} sheets");
}

#[test]
fn browser_shows_two_designs() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    // Other numbers of pins, and a name that is as long as it may be and holds what markup is made of.
    let name = format!("loose & <b>{}", "long-".repeat(17));
    let other = format!(
        "base = \"eleven-pins\"\nname = \"{name}\"\n[gear]\nbacklash_m = 1e-4\n[solver]\nduration_s = 0.02\n"
    );
    std::fs::write(dir.path().join("other.toml"), other).unwrap();
    let paper = "base = \"paper\"\nname = \"tight\"\n[drive]\ninput_speed_rad_s = 20.0\n[solver]\nduration_s = 0.01\n";
    std::fs::write(dir.path().join("paper.toml"), paper).unwrap();
    let page = page(dir.path(), &["compare", "paper.toml", "other.toml"]);
    flawless(&mut browser, "designs", &page, 8, 1);
    let text = std::fs::read_to_string(dir.path().join("o/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&text).unwrap();
    let windows = summary["courses"].as_object().unwrap().values();
    for row in windows.flat_map(|rows| rows.as_array().unwrap()) {
        let values = row["values"].as_array().unwrap();
        assert!(
            values.iter().all(|v| v.is_number()),
            "of each its own pins: {row}"
        );
    }
    // Nothing has passed or failed: what differs is said, by name and how much.
    let banner = browser.evaluate(
        "[document.querySelector('.banner').className, document.querySelector('.banner .headline').textContent]",
    );
    assert_eq!(banner[0], "banner finding");
    let said = banner[1].as_str().unwrap();
    assert!(
        said.contains("figures differ, most: ") && said.contains('%') || said.contains('\u{d7}'),
        "{said}"
    );
    // What only one of them has is drawn too: the twelfth pin.
    let drawn = browser.evaluate(
        "(async () => {
          const choose = (id, value) => { const s = document.getElementById(id); s.value = value; s.dispatchEvent(new Event('change')); };
          choose('quantity', [...document.querySelectorAll('#quantity option')].findIndex((o) => o.textContent === 'Ring pin force'));
          choose('channel', '13');
          await new Promise((r) => setTimeout(r, 500));
          return document.body.dataset.drawn;
        })()",
    );
    assert_eq!(drawn, "Ring pin force no. 13");
    assert!(
        browser.complaints().is_empty(),
        "{:?}",
        browser.complaints()
    );
    let printed = sheets(&mut browser, &page);
    assert!(printed <= 5, "{printed} sheets");
}

#[test]
fn browser_shows_the_stability() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    for (name, stiffness) in [("soft", 0.01), ("stiff", 4.0)] {
        let scene = format!(
            "base = \"paper\"\nname = \"{name}\"\n[contact]\nstiffness_multiplier = {stiffness}\n[solver]\nduration_s = 0.002\n"
        );
        std::fs::write(dir.path().join(format!("{name}.toml")), scene).unwrap();
    }
    let page = page(
        dir.path(),
        &["stability", "soft.toml", "stiff.toml", "--quick"],
    );
    flawless(&mut browser, "stability", &page, 0, 0);
}

#[test]
fn browser_shows_a_baseline() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let accepted = dir.path().join("baselines/accepted");
    std::fs::create_dir_all(&accepted).unwrap();
    for file in std::fs::read_dir(repository("reference/baselines/accepted")).unwrap() {
        let file = file.unwrap();
        std::fs::copy(file.path(), accepted.join(file.file_name())).unwrap();
    }
    // Another accepted count, so that something has moved and is shown.
    let file = accepted.join("baseline.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    let (before, after) = text.split_once("right_hand_sides = 4000").unwrap();
    std::fs::write(&file, format!("{before}right_hand_sides = 8000{after}")).unwrap();
    let words = ["baseline", "check", "--dir", "baselines", "--only", "paper"];
    let page = page(dir.path(), &words);
    flawless(&mut browser, "baseline", &page, 0, 0);
    let printed = sheets(&mut browser, &page);
    assert!(printed <= 4, "{printed} sheets");
}
