//! `pinwheel explore` in use: every slider is dragged, and no state is lost.

use std::path::Path;

use pinwheel_scene::Scene;
use pinwheel_tests::served::Served;
use pinwheel_tests::{run_in, words};
use serde_json::json;

use crate::access::findings;
use crate::chromium::{Chromium, DESK, PHONE, browse};
use crate::faults;
use crate::interact::{click, place};

/// Waits until all requests are answered with balances and bands by contact law.
const SETTLED: &str = "(async () => { const rest = (ms) => new Promise((r) => setTimeout(r, ms)); while (document.body.dataset.explore === undefined) await rest(20); \
    for (let before = ''; ; before = document.body.dataset.answered) { await rest(60); if (document.body.dataset.busy === undefined && document.body.dataset.computing === undefined && document.body.dataset.answered === before) return; } })()";
/// Waits until all requests are answered with balances.
const BALANCED: &str = "(async () => { do { await new Promise((r) => setTimeout(r, 20)); } while (document.body.dataset.busy !== undefined || /^(Balances|The motion)/.test(document.querySelector('#why').textContent)); })()";
const FIGURES: &str = "document.querySelector('#figures')?.textContent || ''";
const MESSAGE: &str = "document.querySelector('#said')?.textContent || ''";
const STALE: &str = "document.querySelector('.explore').matches('.stale')";
const INIT: &str = "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500 --ideal";

/// Writes `gear.toml`, with a run of a quarter of a turn, without bands by contact law, and with `more`.
fn init(dir: &Path, more: &str) {
    assert_eq!(run_in(dir, words(INIT)).code, Some(0));
    let file = dir.join("gear.toml");
    let scene = std::fs::read_to_string(&file).unwrap();
    let scene = scene.replace(
        "[contact]",
        "[solver]\nduration_s = 0.01\n[contact]\nband_laws = []",
    ) + more;
    std::fs::write(file, scene).unwrap();
}

/// Returns the relative position of a slider's thumb.
fn share(browser: &mut Chromium, slider: &str) -> f64 {
    let script =
        format!("(() => {{ const s = {slider}; return (s.value - s.min) / (s.max - s.min); }})()");
    browser.evaluate(&script).as_f64().unwrap()
}

/// Drags the thumb of a slider to a share of its length.
fn drag(browser: &mut Chromium, slider: &str, to: f64) {
    let [x, y, wide, _] = place(browser, slider);
    let from = share(browser, slider);
    // A thumb of 16 px stays within the bar.
    let at = |share: f64| x + (share - 0.5) * (wide - 16.0);
    let half = ("mouseMoved", at(0.5 * (from + to)), y);
    browser.mouse(&[("mousePressed", at(from), y), half], 1);
    let end = ["mouseMoved", "mouseReleased"].map(|kind| (kind, at(to), y));
    browser.mouse(&end, 1);
}

/// Waits until a text of the page meets a condition; the page may reload meanwhile.
fn until(browser: &mut Chromium, script: &str, holds: impl Fn(&str) -> bool) -> String {
    for _ in 0..400 {
        let text = browser.text(script);
        if holds(&text) {
            return text;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    panic!("{script} stays {}", browser.text(script));
}

#[test]
fn browser_explores_under_a_hand() {
    browse(|browser, dir| {
        init(dir, "");
        let served = Served::of(dir, "gear.toml", "0");
        browser.go(&served.1, DESK);
        browser.evaluate(SETTLED);
        let changes = "[...document.querySelectorAll('#figures td:last-child')].map((c) => c.textContent).join()";
        assert_eq!(browser.text(changes), "equal,equal,equal,equal,equal,equal");

        // Every slider, a little to the right of where it stands.
        let count = browser.evaluate("document.querySelectorAll('.slider [type=range]').length");
        assert_eq!(count, json!(15));
        for k in 0..15 {
            let slider = format!("document.querySelectorAll('.slider [type=range]')[{k}]");
            let drawn = "[...document.querySelectorAll('.panel .uplot canvas')].map((c) => new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer).reduce((h, v) => (h * 31 + v) | 0, 0)).join()";
            let before = [FIGURES, drawn].map(|script| browser.text(script));
            // The profile is undercut soon with a larger eccentricity or pin. A rigid bearing's slider stands at its end.
            // Numbers of pins and discs are integers.
            let by = match k {
                0 | 1 | 7 => -0.04,
                11 | 12 => -0.15,
                13 | 14 => 0.34,
                _ => 0.12,
            };
            let to = share(browser, &slider) + by;
            drag(browser, &slider, to);
            browser.evaluate(BALANCED);
            let reasons = browser.text(
                "[...document.querySelectorAll('.reason')].map((r) => r.textContent).join('')",
            );
            assert_eq!(reasons, "", "slider {k}");
            let now = [FIGURES, drawn].map(|script| browser.text(script));
            assert_ne!(now, before, "slider {k} changes nothing");
        }
        // Late figures of one slider may hide that the next one is dead, so the state must have all of them.
        let moved = "(() => { const { a, b, now } = JSON.parse(decodeURIComponent(location.hash.slice(1))); return (now === 'a' ? a : b).length; })()";
        until(browser, &format!("String({moved})"), |count| count == "15");
        // An invalid state gives the reason at its slider, and the last valid state stays.
        let slider = "document.querySelector('#gear-eccentricity_m')";
        drag(browser, slider, 1.0);
        browser.evaluate(BALANCED);
        let reason =
            browser.text("document.querySelector('#gear-eccentricity_m ~ .reason').textContent");
        let limit = "mm, smaller than output pin + eccentricity = 10.26 mm";
        assert!(
            reason.starts_with("Hole radius is ") && reason.contains(limit),
            "{reason}"
        );
        assert_eq!(browser.evaluate(STALE), json!(true));
        click(browser, "document.querySelector('#save')");
        until(browser, MESSAGE, |text| !text.is_empty());
        let place = dir.join("gear-explored.toml");
        assert!(!place.exists(), "a scene that is none was saved");
        drag(browser, slider, 0.4);
        browser.evaluate(BALANCED);
        assert_eq!(browser.evaluate(STALE), json!(false));

        // The saved file is the state: a valid scene with the displayed values.
        click(browser, "document.querySelector('#save')");
        until(browser, MESSAGE, |text| {
            text.starts_with("State B is in gear-explored.toml; next: pinwheel design")
        });
        let saved = Scene::load(place.to_str().unwrap(), &[]).unwrap();
        let shown = browser.evaluate(&format!("Number({slider}.value)"));
        let off = 1e3 * saved.gear.eccentricity_m - shown.as_f64().unwrap();
        assert!(off.abs() < 0.02, "{off} mm");

        // Reloading shows the same two states, also after the program was killed and restarted.
        browser.evaluate(SETTLED);
        let kept = browser.text(FIGURES);
        let hash = browser.text("location.hash");
        let reload = |browser: &mut Chromium, address: &str| {
            browser.go("about:blank", DESK);
            browser.go(address, DESK);
            browser.evaluate(SETTLED);
            browser.text(FIGURES)
        };
        let port = served.port().to_owned();
        let again = reload(browser, &format!("http://127.0.0.1:{port}/{hash}"));
        assert_eq!(again, kept, "lost when loaded again");
        drop(served);
        let served = Served::of(dir, "gear.toml", &port);
        // A newly printed address has no states: the browser stored them.
        let again = reload(browser, &served.1);
        assert_eq!(again, kept, "lost with the program");
        assert_eq!(browser.text("location.hash"), hash);

        // The page follows changes of the file.
        let file = dir.join("gear.toml");
        let scene = std::fs::read_to_string(&file).unwrap();
        let lighter = scene.replace("output_torque_n_m = 200", "output_torque_n_m = 150");
        assert_ne!(lighter, scene);
        browser.evaluate("window.old = true");
        std::fs::write(&file, &lighter).unwrap();
        until(browser, "String(window.old)", |text| text == "undefined");
        browser.evaluate(SETTLED);
        let shown = browser.text(FIGURES);
        assert_ne!(shown, kept, "the file is not followed");
        // A file saved with a fault gives a message, and the display stays.
        let faulty = lighter.replace("eccentricity_m = ", "eccentricity_m = -");
        std::fs::write(&file, faulty).unwrap();
        until(browser, MESSAGE, |text| text.contains("eccentricity_m"));
        assert_eq!(browser.text(FIGURES), shown);
        browser.evaluate("window.old = true");
        std::fs::write(&file, lighter).unwrap();
        until(browser, "String(window.old)", |text| text == "undefined");

        // Figures stand beside the gear, on a phone directly under it.
        for (look, fold) in [(DESK, 900.0), (PHONE, 844.0)] {
            browser.look(look);
            let edges = browser.evaluate(
                "(async () => { await new Promise((r) => setTimeout(r, 100)); scrollTo(0, 0); const at = (s) => document.querySelector(s).getBoundingClientRect(); \
                 return [at('#figures').top, at('#figures').bottom, at('.gearboxes').bottom, at('.hand').top]; })()",
            );
            let [top, bottom, gear, hand] = [0, 1, 2, 3].map(|k| edges[k].as_f64().unwrap());
            assert!(top < fold && (look.width < 500 || bottom < fold), "{edges}");
            assert!(look.width > 500 || (gear < top && bottom < hand), "{edges}");
        }

        // The page has no faults at either width. Force curves of these states bend: straight ones would count as not drawn.
        let hash = "#%7B%22now%22:%22b%22,%22a%22:%5B%5D,%22b%22:%5B%5B%22gear.backlash_m%22,%2236e-6%22%5D%5D,%22moved%22:%7B%7D%7D";
        browser.go("about:blank", DESK);
        browser.go(&format!("http://127.0.0.1:{port}/{hash}"), DESK);
        for look in [DESK, PHONE] {
            browser.evaluate(SETTLED);
            let (mut wrong, layout) = faults(browser, look);
            wrong.extend(findings(browser, look));
            assert!(wrong.is_empty(), "{}: {wrong:#?}", look.width);
            assert_eq!(layout["gearboxes"], json!(1));
        }
    });
}

/// Types a number at a slider and waits for the answer.
fn type_at(browser: &mut Chromium, slider: &str, text: &str) {
    browser.evaluate(&format!(
        "(() => {{ const i = document.querySelector('#{slider}').parentElement.querySelector('[type=text]'); i.value = '{text}'; i.dispatchEvent(new Event('change')); }})()"
    ));
    browser.evaluate(BALANCED);
}

/// Returns the text at a slider.
fn typed(browser: &mut Chromium, slider: &str) -> String {
    browser.text(&format!(
        "document.querySelector('#{slider}').parentElement.querySelector('[type=text]').value"
    ))
}

/// Keys, undo, links, files, and the effect of stated tolerances.
fn by_numbers_steps_and_links() {
    browse(|browser, dir| {
        assert_eq!(run_in(dir, words(INIT)).code, Some(0));
        let file = dir.join("gear.toml");
        let scene = std::fs::read_to_string(&file).unwrap();
        let uncertain = "\n[uncertain]\ngear.backlash_m = { plus_minus = 5e-6 }\n";
        std::fs::write(&file, scene + uncertain).unwrap();
        let flags = ["--print", "--port", "0", "--set", "gear.backlash_m=1e-5"];
        let served = Served::with(dir, "gear.toml", &flags);
        browser.go(&served.1, DESK);
        browser.evaluate(SETTLED);
        // Margin and yield of the tolerances, the yield with its confidence.
        let figures = browser.text(FIGURES);
        for part in [
            "least margin of a limit",
            "yield (%)",
            "40 gears within",
            "95 % confidence",
        ] {
            assert!(figures.contains(part), "{part}: {figures}");
        }
        let begun = browser.text(FIGURES);

        // A typed number in the slider's unit; the state as a downloaded file.
        type_at(browser, "gear-backlash_m", "12,5");
        browser.evaluate(SETTLED);
        let moved = browser.text(FIGURES);
        assert_ne!(moved, begun);
        browser.evaluate("window.files = []; URL.createObjectURL = (blob) => { files.push(blob); return '#'; }; HTMLAnchorElement.prototype.click = () => {}; 0");
        type_at(browser, "drive-input_speed_rad_s", "3000");
        click(browser, "document.querySelector('#file')");
        let text = "(async () => { while (!files.length) await new Promise((r) => setTimeout(r, 50)); return files[0].text(); })()";
        let text = browser.text(text);
        assert!(text.contains("backlash_m = 0.0000125"), "{text}");
        assert!(text.contains("input_speed_rad_s = 314.159265"), "{text}");

        // Undo and redo by keys and by the browser's history; no step leaves the page.
        let key = |shift: bool| {
            format!(
                "document.dispatchEvent(new KeyboardEvent('keydown', {{ key: 'z', ctrlKey: true, shiftKey: {shift} }}))"
            )
        };
        let mut stepped = |script: &str, wanted: [&str; 2]| {
            browser.evaluate(script);
            browser.evaluate(BALANCED);
            let now =
                ["gear-backlash_m", "drive-input_speed_rad_s"].map(|slider| typed(browser, slider));
            assert_eq!(now, wanted, "{script}");
        };
        stepped(&key(false), ["12.5", "1500"]);
        stepped("history.back()", ["10", "1500"]);
        stepped(&key(false), ["10", "1500"]);
        stepped(&key(true), ["12.5", "1500"]);
        stepped("history.forward()", ["12.5", "3000"]);
        stepped("document.querySelector('#undo').click()", ["12.5", "1500"]);
        browser.evaluate(SETTLED);
        assert_eq!(browser.text(FIGURES), moved);

        // An impossible value and a text that is no number are refused in the words and unit of the slider.
        let reason = "document.querySelector('#gear-backlash_m ~ .reason').textContent";
        type_at(browser, "gear-backlash_m", "5000");
        let message = browser.text(reason);
        assert!(
            message.starts_with("Backlash is 5000 \u{b5}m") && !message.contains("--set"),
            "{message}"
        );
        type_at(browser, "gear-backlash_m", "much");
        assert!(browser.text(reason).contains("is no number"));
        type_at(browser, "gear-backlash_m", "12.5");
        assert_eq!(browser.text(reason), "");

        // The link lets a second browser of the user in, which shows the same states.
        browser.evaluate("window.link = ''; Object.defineProperty(navigator, 'clipboard', { value: { writeText: async (text) => { link = text; } } }); 0");
        click(browser, "document.querySelector('#link')");
        let link = until(browser, "window.link", |text| !text.is_empty());
        browser.forget();
        browser.go("about:blank", DESK);
        browser.go(&link, DESK);
        browser.evaluate(SETTLED);
        assert_eq!(typed(browser, "gear-backlash_m"), "12.5");
        assert_eq!(browser.text(FIGURES), moved);
        assert!(!browser.text("location.href").contains("token"));
        browser.assert_quiet();
    });
}

/// Balances of a gear on elastic bearings take longer than its run: the page shows that they are being computed, and never
/// another state's.
fn says_what_is_still_computed() {
    browse(|browser, dir| {
        init(
            dir,
            "\n[bearings.eccentric]\nstiffness_n_m = 3e8\nclearance_m = 5e-6\n",
        );
        #[cfg_attr(not(unix), expect(unused_mut, reason = "interrupted on Unix alone"))]
        let mut served = Served::of(dir, "gear.toml", "0");
        browser.go(&served.1, DESK);
        browser.evaluate(SETTLED);
        // Balances late enough on any machine, with a record of all that the table shows meanwhile.
        browser.evaluate(
            "const ask = window.fetch; window.fetch = async (path, ...how) => { \
             if (String(path).includes('balances')) await new Promise((r) => setTimeout(r, 200)); \
             const answer = await ask(path, ...how); \
             return String(path).includes('run?') ? new Response(JSON.stringify({ ...await answer.json(), balanced: null })) : answer; }; \
             window.shown = []; new MutationObserver(() => { const cell = document.querySelectorAll('#figures td')[1]; \
             if (cell) window.shown.push(cell.textContent); }).observe(document.querySelector('#figures'), { childList: true }); 0",
        );
        for slider in [
            "bearings-eccentric-stiffness_n_m",
            "bearings-eccentric-clearance_m",
            "drive-output_torque_n_m",
        ] {
            let before = browser.text(FIGURES);
            drag(
                browser,
                &format!("document.querySelector('#{slider}')"),
                0.7,
            );
            browser.evaluate(BALANCED);
            assert_ne!(browser.text(FIGURES), before, "{slider}");
        }
        let shown = browser.evaluate("window.shown");
        let shown = shown.as_array().unwrap();
        assert!(shown.contains(&json!("computing")), "{shown:?}");
        assert!(!browser.text(FIGURES).contains("computing"));

        // A comparison shows its progress; an interrupt ends it without leftovers.
        click(browser, "document.querySelector('#compare')");
        let progress = until(browser, MESSAGE, |text| text.contains(" of "));
        assert!(progress.starts_with("Compares: "), "{progress}");
        #[cfg(unix)]
        {
            let (status, took) = served.interrupt();
            assert_eq!(status, Some(0));
            assert!(took.as_secs_f64() < 5.0, "{took:?}");
            let left = std::fs::read_dir(dir.join("out"));
            assert_eq!(left.map_or(0, Iterator::count), 0);
            assert!(dir.join("gear.toml").exists());
        }
    });
}

#[test]
fn browser_explores_by_numbers_while_it_computes() {
    by_numbers_steps_and_links();
    says_what_is_still_computed();
}
