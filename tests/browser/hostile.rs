//! Names of scenes, files, columns and sweeps with markup, scripts or direction marks, in a live browser.

use std::fs;

use pinwheel_tests::run_in;

use crate::chromium::{DESK, browse};

const SCRIPT: &str = "<script>document.title='owned'</script>\\\"'`";
const IMAGE: &str = "a \\\"><img src=x onerror=\\\"document.title='owned'\\\"> <b id=owned>b</b> ${1} {{x}} \\u202Egpj";

/// Script that returns effects of a hostile name: an overwritten title, injected elements, direction marks, and the
/// presence of the name as text.
const LOOK: &str = "[document.title, document.querySelectorAll('[onerror], [src=x], #owned').length, \
    document.documentElement.outerHTML.includes('\\u202E'), document.body.textContent.includes(\"<script>document.title='owned'\")]";

#[test]
fn browser_shows_hostile_names_as_names() {
    browse(|browser, dir| {
        let write = |name: &str, text: &str| fs::write(dir.join(name), text).unwrap();
        let scene = format!(
            "base = \"paper\"\nname = \"{SCRIPT}\"\ndescription = \"{IMAGE}\"\n[solver]\nduration_s = 0.004\n"
        );
        write("h.toml", &scene);
        let data = "x\"><img src=x onerror=document.title='owned'>\u{202e}.csv";
        let mut rows = "time_s,<script>document.title='owned'</script>\n".to_owned();
        (0..41).for_each(|k| rows.push_str(&format!("{},{}\n", 1e-4 * f64::from(k), 1 + k % 3)));
        write(data, &rows);
        write(
            "m.toml",
            "[columns]\ninput_torque_n_m = \"<script>document.title='owned'</script>\"\n",
        );
        let sweep = format!(
            "name = \"{SCRIPT}\"\nscene = \"h.toml\"\nengines = [\"native-reduced\"]\n[vary]\ngear.backlash_m = [0.0, 1e-4]\n"
        );
        write("s.toml", &sweep);
        let compare = [
            "compare",
            "h.toml",
            "--engines",
            "native-reduced",
            "--against",
            data,
            "--map",
            "m.toml",
        ];
        let asked: [&[&str]; 3] = [
            &compare,
            &["design", "h.toml", "--statics"],
            &["sweep", "s.toml"],
        ];
        for words in asked {
            let done = run_in(dir, words.iter().chain(&["--out", "o", "--force"]));
            let code = done.code;
            assert!(
                code.is_some_and(|code| code < 2 || code == 4),
                "{words:?}: {done:?}"
            );
            browser.open(&dir.join("o/index.html"), DESK);
            browser.evaluate("document.querySelectorAll('details').forEach((d) => d.open = true)");
            browser.evaluate("new Promise((r) => setTimeout(r, 100))");
            let effects = browser.evaluate(LOOK);
            let title = effects[0].as_str().unwrap();
            assert!(
                title != "owned" && title.contains("script"),
                "{words:?}: {effects}"
            );
            assert_eq!(effects[1], 0, "{words:?}: {effects}");
            assert_eq!(effects[2], false, "{words:?}: {effects}");
            assert_eq!(effects[3], true, "{words:?}: {effects}");
            browser.assert_quiet();
        }
    });
}
