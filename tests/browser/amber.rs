//! Green requires an agreement, and no unexplained difference: the first screen of page and terminal names the differing
//! engines, the cause and the next step.

use std::path::Path;

use pinwheel_tests::{run_in, words};
use pinwheel_timeseries::TimeSeries;

use crate::chromium::{Chromium, DESK, Look, PHONE, browse};
use crate::faults;

/// Texts of a comparison: banner, first screen, and terminal.
struct Answer {
    banner: String,
    screen: String,
    terminal: String,
}

impl Answer {
    fn of(browser: &mut Chromium, dir: &Path, command: &str, code: i32) -> Self {
        let args = format!("compare {command} --out r --force");
        let done = run_in(dir, words(&args));
        assert_eq!(done.code, Some(code), "{command}: {done:?}");
        assert!(done.stdout.lines().count() <= 30, "{}", done.stdout);
        browser.open(&dir.join("r/index.html"), DESK);
        Self {
            banner: browser.text("document.querySelector('.banner').className"),
            screen: browser.text(
                "[...document.querySelectorAll('.answer *')].filter((e) => e.getBoundingClientRect().bottom < 1000).map((e) => e.textContent).join(' ')",
            ),
            terminal: done.stdout.split_whitespace().collect::<Vec<_>>().join(" "),
        }
    }

    /// Checks the tone, and all of `wanted` on the first screen and on the terminal.
    fn check(&self, tone: &str, verdict: &str, wanted: &[&str]) {
        assert_eq!(self.banner, format!("banner {tone}"), "{}", self.screen);
        let last = self.terminal.contains(&verdict.to_uppercase());
        assert!(last && self.screen.contains(verdict), "{}", self.terminal);
        for wanted in wanted {
            assert!(self.screen.contains(wanted), "{wanted}: {}", self.screen);
            let plain = wanted.replace('\u{202f}', " ");
            let terminal = self.terminal.replace('\u{202f}', " ");
            assert!(terminal.contains(&plain), "{wanted}: {terminal}");
        }
    }
}

/// Writes rig data of 120 % of the driver's torque.
fn rig(dir: &Path) {
    let ran = run_in(
        dir,
        words("run paper --set solver.duration_s=0.01 --out ours --force"),
    );
    assert_eq!(ran.code, Some(0), "{ran:?}");
    let ours = TimeSeries::load_csv(&dir.join("ours/courses.csv")).unwrap();
    let torque = ours.channel("input_torque_n_m").unwrap();
    let rows = ours.time_s().iter().zip(torque);
    let rows: String = rows
        .map(|(t, torque)| format!("{t},{}\n", 1.2 * torque))
        .collect();
    std::fs::write(dir.join("rig.csv"), format!("t,torque\n{rows}")).unwrap();
    map(dir, "");
}

/// Writes the map of rig data with or without an uncertainty.
fn map(dir: &Path, uncertainty: &str) {
    let map = format!(
        "name = \"rig\"\n[time]\ncolumn = \"t\"\n[columns]\ninput_torque_n_m = {{ column = \"torque\"{uncertainty} }}\n"
    );
    std::fs::write(dir.join("rig.toml"), map).unwrap();
}

fn nothing_confirms() {
    browse(|browser, dir| {
        let short = "--set solver.duration_s=0.005";
        // A single engine agrees with its load, and has no partner.
        let alone = Answer::of(browser, dir, &format!("paper --engines reduced {short}"), 4);
        alone.check("open", "Not confirmed", &["no agreement yet"]);

        // Data that are 20 % off without an uncertainty.
        let against =
            format!("paper --engines reduced,lagrange --against rig.csv --map rig.toml {short}");
        rig(dir);
        let off = Answer::of(browser, dir, &against, 4);
        off.check(
            "open",
            "Not confirmed",
            &["by rig", "nothing shown", "its map states neither"],
        );
        // With an uncertainty.
        map(dir, ", uncertainty = { of_reading = 0.005 }");
        let judged = Answer::of(browser, dir, &against, 0);
        judged.check(
            "open",
            "Not confirmed",
            &["by rig", ": unexplained", "what the model leaves out"],
        );

        // A solver with forces 20 % too large differs if its runs give an uncertainty, and confirms nothing without one.
        let made = run_in(dir, words("solver new --language python mine"));
        assert_eq!(made.code, Some(0), "{made:?}");
        let place = dir.join("mine/solver.py");
        let sound = std::fs::read_to_string(&place).unwrap();
        // First one that omits a part of the output torque, checked alone.
        let unbalanced = sound.replace("output = loads[5]", "output = 0.6 + loads[5]");
        assert_ne!(sound, unbalanced);
        std::fs::write(&place, unbalanced).unwrap();
        let of = format!("paper --engines mine --solver mine/solver.toml {short}");
        let cause = "mine: output torque and load do not give the output its acceleration";
        Answer::of(browser, dir, &of, 1).check("fail", "Differs", &[cause]);
        let faulty = sound.replace("[math.hypot(", "[1.2 * math.hypot(");
        assert_ne!(sound, faulty);
        std::fs::write(&place, faulty).unwrap();
        let of = format!("paper --engines reduced,lagrange --solver mine/solver.toml {short}");
        let differs = Answer::of(browser, dir, &of, 1);
        differs.check("fail", "Differs", &["mine", "law, likely force"]);
        // The stage is drawn in three ways, on a phone and in the dark too.
        for look in [PHONE, Look { dark: true, ..DESK }] {
            let (wrong, _) = faults(browser, look);
            assert!(wrong.is_empty(), "{wrong:#?}");
        }
        let drawn = "[...document.querySelectorAll('#stages .panel:has(.uplot) h3')].map((h) => h.textContent).join()";
        let drawn = browser.text(drawn);
        assert_eq!(drawn, "Over time: law,By pin: law,By place on a lobe: law");
        let manifest = dir.join("mine/solver.toml");
        let text = std::fs::read_to_string(&manifest).unwrap();
        let (kept, _) = text.split_once("[refine]").unwrap();
        std::fs::write(&manifest, kept).unwrap();
        let unknown = Answer::of(browser, dir, &of, 4);
        unknown.check(
            "open",
            "Not confirmed",
            &["by mine", "nothing shown", "state"],
        );
    });
}

/// The answer names the difference between an engine with its own contacts and the native solver, and the contacts that
/// explain it.
fn other_contacts_are_named() {
    browse(|browser, dir| {
        let command = "paper --engines reduced,rapier-colliders --set solver.duration_s=0.05 --set contact.law=hunt-crossley";
        // No engine confirms the scene's law.
        let answer = Answer::of(browser, dir, command, 4);
        let wanted = [
            "from native runs with the same contacts",
            "add a second engine",
        ];
        answer.check("open", "Not confirmed", &wanted);
    });
}

#[test]
fn browser_is_amber_where_nothing_confirms() {
    nothing_confirms();
    other_contacts_are_named();
}
