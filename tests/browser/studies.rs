//! Pages of small studies.

use std::fs;
use std::path::{Path, PathBuf};

use pinwheel_tests::{repository, run_in, words};
use pinwheel_timeseries::TimeSeries;
use serde_json::{Value, json};

use crate::chromium::{Chromium, DESK, PHONE, browse};
use crate::interact::DRAWN;
use crate::{faults, flawless};

/// Runs a study in `dir` and returns its page, in a folder named after the command.
fn page(dir: &Path, typed: &str) -> PathBuf {
    let words = words(typed);
    let out = ["--force", "--out", words[0]];
    let done = run_in(dir, words.iter().chain(&out));
    assert_eq!(done.code, Some(0), "{typed} {done:?}");
    dir.join(words[0]).join("index.html")
}

fn summary(page: &Path) -> Value {
    let file = page.with_file_name("summary.json");
    serde_json::from_str(&fs::read_to_string(file).unwrap()).unwrap()
}

fn the_bench_and_the_stability() {
    browse(|browser, dir| {
        let typed = "bench paper --engines native,rapier-shared-law --methods rk4,dopri5 --repeats 1 \
                     --set solver.duration_s=0.005";
        flawless(browser, &page(dir, typed), [1, 0, 4]);
        // The chart comes before any table.
        let layout = browser.evaluate(
            "[document.querySelector('main .uplot').getBoundingClientRect().top + scrollY < 900, \
              document.querySelectorAll('details.depth').length >= 3, document.querySelector('.banner').className]",
        );
        assert_eq!(layout, json!([true, true, "banner finding"]));
        for (name, stiffness) in [("soft", 0.01), ("stiff", 4.0)] {
            let scene = format!(
                "base = \"paper\"\nname = \"{name}\"\n[contact]\nstiffness_multiplier = {stiffness}\n[solver]\nduration_s = 0.001\n"
            );
            fs::write(dir.join(format!("{name}.toml")), scene).unwrap();
        }
        let page = page(dir, "stability soft.toml stiff.toml --quick");
        flawless(browser, &page, [0, 0, 4]);
    });
}

/// A map of two axes; of three, a panel, with its value, for each value of the third.
fn sweeps() {
    browse(|browser, dir| {
        let sweep = "name = \"small\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.01\n[vary]\n\
                     gear.backlash_m = [0.0, 2.0e-4, 4.0e-4]\ncontact.damping_n_s_m = [8.0, 64.0]\n";
        fs::write(dir.join("small.toml"), sweep).unwrap();
        let small = page(dir, "sweep small.toml");
        flawless(browser, &small, [0, 0, 2]);
        browser.open(&small, DESK);
        let layout = browser.evaluate(
            "[document.querySelector('.heat-map').getBoundingClientRect().bottom < 900, document.querySelectorAll('details.depth:not([open])').length, \
              document.querySelector('.banner .headline').textContent.startsWith('Ring pin force, peak: '), document.body.textContent.includes('did not finish')]",
        );
        assert_eq!(layout, json!([true, 2, true, false]));
        // Two axes give a map; lines, other axes and figures are selectable.
        let counts = browser.evaluate(
            "(async () => {
              const rest = () => new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(r)));
              const maps = () => document.querySelectorAll('.heat-map').length;
              const plots = () => document.querySelectorAll('.grid .uplot').length;
              const select = (k, value) => { const s = document.querySelectorAll('.grid select')[k]; s.value = value; s.dispatchEvent(new Event('change')); };
              const counts = [maps(), plots(), document.querySelectorAll('.heat-map td.map').length];
              document.querySelectorAll('.grid .buttons button')[0].click();
              await rest();
              counts.push(maps(), plots(), document.querySelectorAll('.grid .chip').length);
              select(1, '1');
              await rest();
              counts.push(document.querySelectorAll('.grid .chip').length);
              select(0, '1');
              await rest();
              counts.push(plots(), document.querySelectorAll('.grid select')[0].value);
              return counts;
            })()",
        );
        assert_eq!(counts, json!([1, 0, 6, 0, 1, 2, 3, 1, "1"]));
        browser.assert_quiet();
        let sweep = "name = \"three\"\nscene = \"paper\"\nengines = [\"native-reduced\"]\n[set]\nsolver.duration_s = 0.005\n[vary]\n\
                     gear.backlash_m = [0.0, 2.0e-4]\ncontact.damping_n_s_m = [8.0, 64.0]\ndrive.output_torque_n_m = [11.0, 22.0, 33.0]\n";
        fs::write(dir.join("three.toml"), sweep).unwrap();
        browser.open(&page(dir, "sweep three.toml"), PHONE);
        assert!(browser.sheets() <= 3);
        let (complaints, _) = faults(browser, PHONE);
        assert!(complaints.is_empty(), "{complaints:#?}");
        let counts = browser.evaluate(
            "(() => {
              const maps = [...document.querySelectorAll('.grid .scroll')];
              return [maps.length, new Set(maps.map((m) => m.getAttribute('aria-label'))).size, document.querySelectorAll('.heat-map td.map').length];
            })()",
        );
        // The axis with most values comes first, so the one with two values has the panels.
        assert_eq!(counts, json!([2, 2, 12]));
    });
}

/// Measured data come first: drawn, with residual and uncertainty budget, and with the changes of their times.
fn measured_data() {
    browse(|browser, dir| {
        let scene = "base = \"paper\"\nname = \"rigged\"\n[solver]\nduration_s = 0.02\nstep_s = 1e-5\n[uncertain]\n\
                     contact.stiffness_multiplier = { plus_minus = 5e-4 }\n";
        fs::write(dir.join("rigged.toml"), scene).unwrap();
        let ran = run_in(dir, ["run", "rigged.toml", "--out", "ours"]);
        assert_eq!(ran.code, Some(0), "{ran:?}");
        let ours = TimeSeries::load_csv(&dir.join("ours/courses.csv")).unwrap();
        let [torque, force] =
            ["input_torque_n_m", "external_sleeve_force_n_3"].map(|n| ours.channel(n).unwrap());
        let mut text = "t;torque;F_3\n".to_owned();
        for (k, time) in ours.time_s().iter().enumerate().skip(20) {
            let (time, torque) = (time - 0.0021, 1.004 * torque[k]);
            text.push_str(&format!("{time};{torque};{}\n", force[k]));
        }
        fs::write(dir.join("rig.csv"), text).unwrap();
        let map = "name = \"rig\"\n[file]\nseparator = \";\"\n[time]\ncolumn = \"t\"\noffset_s = \"align\"\n[columns]\n\
                   input_torque_n_m = { column = \"torque\", uncertainty = { of_reading = 0.005 } }\n\
                   external_sleeve_force_n_3 = { column = \"F_3\" }\n";
        fs::write(dir.join("rig.toml"), map).unwrap();
        let typed = "compare rigged.toml --engines native-reduced --against rig.csv --map rig.toml";
        let page = page(dir, typed);
        flawless(browser, &page, [2, 1, 5]);
        browser.open(&page, DESK);
        browser.evaluate(DRAWN);
        let content = browser.evaluate(
            "({
              first: document.querySelector('[id^=track] h2').textContent,
              unfolded: document.querySelector('[id^=track] .item').open,
              shift_noted: /0\\.00(21|209)\\d* s were added to its times/.test(document.querySelector('[id^=track]').textContent),
              residual: document.querySelector('.plot-title').textContent,
              base: document.getElementById('base').selectedOptions[0].textContent,
              drawn: document.body.dataset.drawn,
              long: /\\d\\.\\d{12}/.exec(document.querySelector('main').innerText)?.[0] || '',
            })",
        );
        let residual = "Difference to rig: the residual, and its budget of uncertainty as a strip (about 95 %)";
        let wanted = json!({"first": "Measured", "unfolded": true, "shift_noted": true, "residual": residual, "base": "rig",
                            "drawn": "Driver torque", "long": ""});
        assert_eq!(content, wanted);
    });
}

/// Answers of the first screen to the questions of a decision, the last a command.
fn decided(browser: &mut Chromium) -> Value {
    browser.evaluate("[...document.querySelectorAll('.decision .tile')].map((t) => (t.querySelector('code') || t.querySelector('.label')).textContent)")
}

/// The four questions of a decision, and curves of one engine, which differs from nothing.
fn a_run() {
    browse(|browser, dir| {
        let page = page(dir, "run paper --set solver.duration_s=0.02");
        flawless(browser, &page, [1, 1, 3]);
        browser.open(&page, DESK);
        browser.evaluate(DRAWN);
        let view = browser.evaluate(
            "(() => { const tiles = [...document.querySelectorAll('.decision .tile')]; \
             return { asked: tiles.map((t) => t.querySelector('.label').textContent), next: tiles.at(-1).querySelector('code').textContent, \
             fits: tiles.every((t) => t.getBoundingClientRect().bottom < 900), plots: document.querySelectorAll('#chart .uplot').length }; })()",
        );
        let asked = ["Is it right?", "Will it bear?", "How sure?", "What next?"];
        assert_eq!(view["asked"], json!(asked));
        assert_eq!(view["next"], "pinwheel compare paper");
        assert_eq!((&view["fits"], &view["plots"]), (&json!(true), &json!(1)));
    });
}

fn a_design() {
    browse(|browser, dir| {
        flawless(browser, &page(dir, "design printed-drive"), [7, 1, 6]);
        // Names in backticks are code, in the lead too.
        let lead = browser.text("document.querySelector('.lead').innerHTML");
        assert!(lead.contains("<code>") && !lead.contains('`'), "{lead}");
    });
}

fn two_designs() {
    browse(|browser, dir| {
        // Other numbers of pins, and a name of maximal length with markup characters.
        let name = format!("loose & <b>{}", "long-".repeat(17));
        let other = format!(
            "base = \"eleven-pins\"\nname = \"{name}\"\n[gear]\nbacklash_m = 1e-4\n[solver]\nduration_s = 0.02\n"
        );
        fs::write(dir.join("other.toml"), other).unwrap();
        let paper = "base = \"paper\"\nname = \"tight\"\n[drive]\ninput_speed_rad_s = 20.0\n[solver]\nduration_s = 0.01\n";
        fs::write(dir.join("paper.toml"), paper).unwrap();
        let page = page(dir, "compare paper.toml other.toml");
        flawless(browser, &page, [8, 1, 7]);
        let tiles = [
            "Is it right?",
            "Will it bear?",
            "How sure?",
            "pinwheel compare other.toml",
        ];
        assert_eq!(decided(browser), json!(tiles));
        let summary = summary(&page);
        let windows = summary["courses"].as_object().unwrap().values();
        for row in windows.flat_map(|rows| rows.as_array().unwrap()) {
            let values = row["values"].as_array().unwrap();
            let numbers = values.iter().all(|v| v.is_number());
            assert!(numbers, "of each its own pins: {row}");
        }
        // Without pass or fail, differences have their name and size.
        let class = browser.text("document.querySelector('.banner').className");
        assert_eq!(class, "banner finding");
        let title = browser.text("document.querySelector('.banner .headline').textContent");
        let much = title.contains('%') || title.contains('\u{d7}');
        assert!(title.contains("figures differ, most: ") && much, "{title}");
        // Channels of only one design are drawn too: the twelfth pin.
        let drawn = browser.text(
            "(async () => {
              const choose = (id, value) => { const s = document.getElementById(id); s.value = value; s.dispatchEvent(new Event('change')); };
              choose('quantity', [...document.querySelectorAll('#quantity option')].findIndex((o) => o.textContent === 'Ring pin force'));
              delete document.body.dataset.drawn;
              choose('channel', '13');
              for (let k = 0; k < 100 && !document.body.dataset.drawn; k += 1) await new Promise((r) => setTimeout(r, 20));
              return document.body.dataset.drawn;
            })()",
        );
        assert_eq!(drawn, "Ring pin force no. 13");
        browser.assert_quiet();
    });
}

fn a_baseline() {
    browse(|browser, dir| {
        let accepted = dir.join("baselines/accepted");
        fs::create_dir_all(&accepted).unwrap();
        for file in fs::read_dir(repository("reference/baselines/accepted")).unwrap() {
            let file = file.unwrap();
            fs::copy(file.path(), accepted.join(file.file_name())).unwrap();
        }
        // Another accepted count, so that a change is shown.
        let file = accepted.join("baseline.toml");
        let text = fs::read_to_string(&file).unwrap();
        let (before, after) = text.split_once("right_hand_sides = 4000").unwrap();
        fs::write(&file, format!("{before}right_hand_sides = 8000{after}")).unwrap();
        let page = page(dir, "baseline check --dir baselines --only paper");
        flawless(browser, &page, [0, 0, 4]);
        let next =
            "pinwheel baseline record accepted --dir baselines --only paper --accept \"why\"";
        assert_eq!(decided(browser), json!(["Is it right?", "How sure?", next]));
    });
}

fn the_paper() {
    browse(|browser, dir| {
        let page = page(dir, "paper --figures 9");
        flawless(browser, &page, [2, 1, 9]);
        let summary = summary(&page);
        assert_eq!(summary["figures"][0]["verdict"], "holds");
        // The counts of the first screen include all rows.
        let banner = browser.text("document.querySelector('.banner').innerText");
        let numbers = banner.split(|c: char| !c.is_ascii_digit());
        let numbers: Vec<usize> = numbers.filter_map(|word| word.parse().ok()).collect();
        let rows = |key: &str| summary[key].as_array().unwrap().len();
        let [holds, all, sometimes, not, meaningless, _runs] = numbers[..] else {
            panic!("{banner}");
        };
        assert_eq!(holds + sometimes + not + meaningless, all, "{banner}");
        assert_eq!(all, rows("figures") + rows("claims"), "{banner}");
        // Wider gearboxes would take a printed sheet each.
        browser.look(DESK);
        browser.media("print");
        let wide = browser.evaluate("document.querySelector('.gearbox-view canvas').clientWidth");
        assert!(wide.as_u64().unwrap() < 250, "{wide} px wide");
        let time_series = fs::read_to_string(page.with_file_name("fig-09a/courses.csv")).unwrap();
        assert!(time_series.starts_with("time_s,") && time_series.lines().count() > 1000);
    });
}

#[test]
fn browser_shows_runs_and_designs() {
    a_run();
    a_design();
    two_designs();
}

#[test]
fn browser_shows_sweeps_benches_and_baselines() {
    sweeps();
    the_bench_and_the_stability();
    a_baseline();
}

#[test]
fn browser_shows_measured_data_and_the_paper() {
    measured_data();
    the_paper();
}
