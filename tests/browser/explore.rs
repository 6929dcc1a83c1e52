//! `pinwheel explore` under a hand: every slider is dragged, and nothing is lost.

#![allow(clippy::print_stdout, reason = "measured figures")]

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Child, Stdio};

use pinwheel_scene::Scene;
use pinwheel_tests::{pinwheel, run_in, words};
use serde_json::{Value, json};

use crate::chromium::Chromium;
use crate::faults;
use crate::interact::{DESK, PHONE, click, place, text};

/// The running program and the address that it printed; dropped, it is killed.
struct Served(Child, String);

impl Served {
    fn start(dir: &Path, port: &str) -> Self {
        Self::of(dir, "gear.toml", port)
    }

    fn of(dir: &Path, scene: &str, port: &str) -> Self {
        Self::with(dir, scene, &["--print", "--port", port])
    }

    fn with(dir: &Path, scene: &str, flags: &[&str]) -> Self {
        Self::in_path(dir, scene, flags, None)
    }

    fn in_path(dir: &Path, scene: &str, flags: &[&str], path: Option<&str>) -> Self {
        let mut child = pinwheel()
            .envs(path.map(|path| ("PATH", path)))
            .current_dir(dir)
            .args(["explore", scene])
            .args(flags)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        let mut line = String::new();
        let stdout = child.stdout.take().unwrap();
        BufReader::new(stdout).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("page: ").unwrap().to_owned();
        Self(child, address)
    }

    fn port(&self) -> &str {
        self.1.split([':', '/']).nth(4).unwrap()
    }
}

impl Drop for Served {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Waits until all that was asked is answered and balanced; how many answers there were.
const SETTLED: &str = "(async () => { const rest = (ms) => new Promise((r) => setTimeout(r, ms)); while (document.body.dataset.explore === undefined) await rest(20); \
    for (let before = ''; ; before = document.body.dataset.answered) { await rest(250); if (document.body.dataset.busy === undefined && document.body.dataset.computing === undefined && document.body.dataset.answered === before) break; } return Number(document.body.dataset.answered || 0); })()";
const FIGURES: &str = "document.querySelector('#figures').textContent";

/// Drags the thumb of a slider to a share of its length.
fn drag(browser: &mut Chromium, slider: &str, to: f64) {
    let [x, y, wide, _] = place(browser, slider);
    let share = browser.evaluate(&format!(
        "(() => {{ const s = {slider}; return (s.value - s.min) / (s.max - s.min); }})()"
    ));
    // A thumb of 16 px stays within the bar.
    let at = |share: f64| x + (share - 0.5) * (wide - 16.0);
    let from = share.as_f64().unwrap();
    browser.mouse(&[("mousePressed", at(from), y)], 1);
    for k in 1..=8 {
        let share = from + (to - from) * f64::from(k) / 8.0;
        browser.mouse(&[("mouseMoved", at(share), y)], 1);
        browser.evaluate("new Promise((r) => setTimeout(r, 30))");
    }
    browser.mouse(&[("mouseReleased", at(to), y)], 1);
}

/// The 95th percentile of the times from a hand's move to the drawn answer, ms; they are printed.
fn late(browser: &mut Chromium, of: &str) -> f64 {
    let times = browser.evaluate("window.pinwheelLatencies");
    let times = times.as_array().unwrap().iter();
    let mut times: Vec<f64> = times.filter_map(Value::as_f64).collect();
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize];
    let [half, late] = [0.5, 0.95].map(at);
    println!(
        "{of}: {} moves, {half:.0} ms in the middle, {late:.0} ms at the 95th percentile",
        times.len()
    );
    late
}

#[test]
fn browser_explores_under_a_hand() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let browser = &mut browser;
    let dir = tempfile::tempdir().unwrap();
    let init =
        "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    assert_eq!(run_in(dir.path(), words(init)).code, Some(0));
    let served = Served::start(dir.path(), "0");
    browser.go(&served.1, DESK);
    browser.evaluate(SETTLED);

    let changes =
        "[...document.querySelectorAll('#figures td:last-child')].map((c) => c.textContent).join()";
    assert_eq!(text(browser, changes), "equal,equal,equal,equal,equal");

    // Every slider, a little to the right of where it stands.
    let count = browser.evaluate("document.querySelectorAll('.slider input').length");
    let count = count.as_u64().unwrap();
    assert_eq!(count, 9);
    for k in 0..count {
        // From here on a bearing is elastic.
        if k == 7 {
            let late = late(browser, "rigid");
            // Asked for where nothing else runs, of the program as users have it.
            let most = std::env::var("PINWHEEL_LATENCY_MS");
            if let Some(most) = most.ok().and_then(|ms| ms.parse::<f64>().ok()) {
                assert!(late <= most, "{late} ms");
            }
        }
        let slider = format!("document.querySelectorAll('.slider input')[{k}]");
        let share = browser.evaluate(&format!(
            "(() => {{ const s = {slider}; return (s.value - s.min) / (s.max - s.min); }})()"
        ));
        let before = text(browser, FIGURES);
        let moved = "[...document.querySelectorAll('.panel .uplot canvas')].map((c) => c.toDataURL().length).join()";
        let drawn = text(browser, moved);
        // The profile is undercut soon with a larger eccentricity or pin.
        // A rigid bearing's slider stands at its end, and its clearance is one of the bearing that is elastic by then.
        let by = if k < 2 || k == 7 { -0.04 } else { 0.12 };
        drag(browser, &slider, share.as_f64().unwrap() + by);
        browser.evaluate(SETTLED);
        let reasons = text(
            browser,
            "[...document.querySelectorAll('.reason')].map((r) => r.textContent).join('')",
        );
        assert_eq!(reasons, "", "slider {k}");
        let same = text(browser, FIGURES) == before && text(browser, moved) == drawn;
        assert!(!same, "slider {k} changes nothing");
    }
    // What cannot be says why at its slider, and the last good state stays.
    drag(
        browser,
        "document.querySelector('#gear-eccentricity_m')",
        1.0,
    );
    browser.evaluate(SETTLED);
    let reason = text(
        browser,
        "document.querySelector('#gear-eccentricity_m ~ .reason').textContent",
    );
    assert!(reason.contains("undercut"), "{reason}");
    let stale = "document.querySelector('.seen').matches('.stale')";
    assert_eq!(browser.evaluate(stale), json!(true));
    click(browser, "document.querySelector('#save')");
    browser.evaluate(SETTLED);
    assert!(
        !dir.path().join("gear-explored.toml").exists(),
        "a scene that is none was saved"
    );
    drag(
        browser,
        "document.querySelector('#gear-eccentricity_m')",
        0.4,
    );
    browser.evaluate(SETTLED);
    assert_eq!(browser.evaluate(stale), json!(false));

    // Saved it is the state: a valid scene with the values shown.
    click(browser, "document.querySelector('#save')");
    browser.evaluate(SETTLED);
    let said = text(browser, "document.querySelector('#said').textContent");
    assert_eq!(said, "State B is in gear-explored.toml");
    let place = dir.path().join("gear-explored.toml");
    let saved = Scene::load(place.to_str().unwrap(), &[]).unwrap();
    let shown = browser.evaluate("Number(document.querySelector('#gear-eccentricity_m + .reason, #gear-eccentricity_m').value)");
    let off = 1e3 * saved.gear.eccentricity_m - shown.as_f64().unwrap();
    assert!(off.abs() < 0.02, "{off} mm");

    // Loaded again it shows the same two states; so it does after the program was killed and started again.
    let kept = text(browser, FIGURES);
    let hash = text(browser, "location.hash");
    let reload = |browser: &mut Chromium, address: &str| {
        browser.go("about:blank", DESK);
        browser.go(address, DESK);
        browser.evaluate(SETTLED);
        text(browser, FIGURES)
    };
    let port = served.port().to_owned();
    let again = reload(browser, &format!("http://127.0.0.1:{port}/{hash}"));
    assert_eq!(again, kept, "lost when loaded again");
    drop(served);
    let served = Served::start(dir.path(), &port);
    // The address that is printed anew has no states: the browser kept them.
    let again = reload(browser, &served.1);
    assert_eq!(again, kept, "lost with the program");
    assert_eq!(text(browser, "location.hash"), hash);

    // The page follows the file.
    let file = dir.path().join("gear.toml");
    let scene = std::fs::read_to_string(&file).unwrap();
    let heavier = scene.replace("output_torque_n_m = 200", "output_torque_n_m = 150");
    assert_ne!(heavier, scene);
    std::thread::sleep(std::time::Duration::from_millis(1500));
    std::fs::write(&file, heavier).unwrap();
    std::thread::sleep(std::time::Duration::from_millis(2500));
    browser.evaluate(SETTLED);
    assert_ne!(text(browser, FIGURES), kept, "the file is not followed");
    // Saved with a fault it says so, and shows what it showed.
    let shown = text(browser, FIGURES);
    let good = std::fs::read_to_string(&file).unwrap();
    std::fs::write(
        &file,
        good.replace("eccentricity_m = ", "eccentricity_m = -"),
    )
    .unwrap();
    std::thread::sleep(std::time::Duration::from_millis(2500));
    browser.evaluate(SETTLED);
    let said = text(browser, "document.querySelector('#said').textContent");
    assert!(said.contains("eccentricity_m"), "{said}");
    assert_eq!(text(browser, FIGURES), shown);
    std::fs::write(&file, good).unwrap();
    std::thread::sleep(std::time::Duration::from_millis(2500));
    browser.evaluate(SETTLED);

    // Nothing is wrong with it at either width; here of states whose forces are no straight lines, which look like nothing.
    let hash = "#%7B%22now%22:%22b%22,%22a%22:%5B%5D,%22b%22:%5B%5B%22gear.backlash_m%22,%2236e-6%22%5D%5D,%22moved%22:%7B%7D%7D";
    let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("screenshots");
    for look in [DESK, PHONE] {
        browser.theme(look);
        browser.go("about:blank", look);
        browser.go(&format!("http://127.0.0.1:{port}/{hash}"), look);
        browser.evaluate(SETTLED);
        browser.picture(&kept.join(format!("explore-{}.png", look.width)));
        // The picture was taken at another height: everything is drawn anew.
        browser.evaluate(SETTLED);
        let (wrong, seen) = faults(browser, look);
        assert!(wrong.is_empty(), "{}: {wrong:#?}", look.width);
        assert_eq!(seen["gearboxes"], json!(1));
    }

    // Another page, another browser and a second use of the address get nothing.
    let address = served.1.clone();
    let other = browser.evaluate(&format!(
        "fetch('{}').then((answer) => answer.status)",
        address
            .split_once("//")
            .map_or("", |(_, rest)| rest
                .split_once('/')
                .map_or("", |(_, path)| path))
            .replacen("?", "/?", 1)
    ));
    assert_eq!(other, json!(403), "the address worked twice");
}

/// Lets `pinwheel` have an interrupt; its exit status, and how long it took to end.
#[cfg(unix)]
fn interrupt(served: &mut Served) -> (Option<i32>, std::time::Duration) {
    let begin = std::time::Instant::now();
    let kill = std::process::Command::new("kill")
        .args(["-INT", &served.0.id().to_string()])
        .status();
    assert!(kill.unwrap().success());
    (served.0.wait().unwrap().code(), begin.elapsed())
}

/// Balances of a gear on elastic bearings take longer than its run: they are said to be computed, and never another state's.
#[test]
fn browser_says_what_is_still_computed() {
    let Some(mut browser) = Chromium::start() else {
        return;
    };
    let browser = &mut browser;
    let dir = tempfile::tempdir().unwrap();
    assert_eq!(run_in(dir.path(), words("init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500")).code, Some(0));
    let file = dir.path().join("gear.toml");
    let bearings = "\n[bearings.eccentric]\nstiffness_n_m = 3e8\nclearance_m = 5e-6\n";
    let scene = std::fs::read_to_string(&file).unwrap() + bearings;
    std::fs::write(&file, scene).unwrap();
    #[cfg_attr(not(unix), expect(unused_mut, reason = "interrupted on Unix alone"))]
    let mut served = Served::start(dir.path(), "0");
    browser.go(&served.1, DESK);
    browser.evaluate(SETTLED);
    // Balances late enough to be seen on any machine.
    browser.evaluate(
        "const ask = window.fetch; window.fetch = async (path, ...how) => { \
         if (String(path).includes('balances')) await new Promise((r) => setTimeout(r, 2500)); \
         const answer = await ask(path, ...how); \
         return String(path).includes('run?') ? new Response(JSON.stringify({ ...await answer.json(), balanced: null })) : answer; }; 0",
    );
    // All that the table ever showed while the load went up.
    browser.evaluate(
        "window.seen = []; new MutationObserver(() => { const cell = document.querySelectorAll('#figures td')[1]; \
         if (cell) window.seen.push(cell.textContent); }).observe(document.querySelector('#figures'), { childList: true }); 0",
    );
    for slider in [
        "bearings-eccentric-stiffness_n_m",
        "bearings-eccentric-clearance_m",
        "drive-output_torque_n_m",
    ] {
        let slider = format!("document.querySelector('#{slider}')");
        let before = text(browser, FIGURES);
        drag(browser, &slider, 0.7);
        browser.evaluate(SETTLED);
        assert_ne!(text(browser, FIGURES), before, "{slider}");
    }
    late(browser, "on elastic bearings, the run");
    let seen = browser.evaluate("window.seen");
    let seen: Vec<&str> = seen
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert!(seen.contains(&"computing"), "{seen:?}");
    assert!(!text(browser, FIGURES).contains("computing"));

    // A comparison tells how far it is; an interrupt ends it and leaves nothing.
    click(browser, "document.querySelector('#compare')");
    let told = text(
        browser,
        "(async () => { for (let k = 0; k < 100; k += 1) { await new Promise((r) => setTimeout(r, 100)); \
        const said = document.querySelector('#said').textContent; if (said.includes(' of ')) return said; } return 'nothing'; })()",
    );
    assert!(told.starts_with("Compares: "), "{told}");
    #[cfg(unix)]
    {
        let (status, took) = interrupt(&mut served);
        assert_eq!(status, Some(0));
        assert!(took.as_secs_f64() < 5.0, "{took:?}");
        let left: Vec<_> = std::fs::read_dir(dir.path())
            .unwrap()
            .map(|one| one.unwrap().file_name())
            .collect();
        let left = |name: &str| left.iter().any(|one| one == name);
        assert!(left("gear.toml"));
        assert_eq!(
            std::fs::read_dir(dir.path().join("out")).map_or(0, Iterator::count),
            0
        );
    }
}

#[test]
fn explore_says_that_a_port_is_taken() {
    let dir = tempfile::tempdir().unwrap();
    let taken = std::net::TcpListener::bind("127.0.0.1:0").unwrap();
    let port = taken.local_addr().unwrap().port();
    let answer = run_in(
        dir.path(),
        words(&format!("explore paper --print --port {port}")),
    );
    assert_eq!(answer.code, Some(2), "{}", answer.stderr);
    assert!(answer.stderr.contains("--port"), "{}", answer.stderr);
}

/// Asks for `path` at the page's own host, with more headers and a body; the status and the whole answer.
fn asked(served: &Served, request: &str, more: &str, body: &str) -> (String, String) {
    use std::io::{Read as _, Write as _};
    let host = format!("127.0.0.1:{}", served.port());
    let mut socket = std::net::TcpStream::connect(&host).unwrap();
    let own = match more.contains("Host:") {
        true => String::new(),
        false => format!("Host: {host}\r\n"),
    };
    let length = body.len();
    let question = format!(
        "{request} HTTP/1.1\r\n{own}{more}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}"
    );
    // Headers are bytes, a character each.
    let bytes: Vec<u8> = question.chars().map(|c| c as u8).collect();
    socket.write_all(&bytes).unwrap();
    let mut answer = String::new();
    socket.read_to_string(&mut answer).unwrap();
    (answer[9..12].to_owned(), answer)
}

#[test]
fn explore_in_a_frame_answers_who_has_its_address_until_its_input_ends() {
    let dir = tempfile::tempdir().unwrap();
    let mut served = Served::with(dir.path(), "paper", &["--embed"]);
    let path = served.1.splitn(4, '/').nth(3).unwrap().to_owned();
    assert_eq!(path.len(), 33, "128 bits and a slash: {path}");
    for _ in 0..2 {
        let (status, answer) = asked(&served, &format!("GET /{path}"), "", "");
        assert_eq!(status, "200", "as often as it is asked for");
        assert!(!answer.contains("X-Frame-Options"), "it stands in a frame");
    }
    assert_eq!(
        asked(&served, &format!("GET /{path}status"), "", "").0,
        "200"
    );
    let last = if path.ends_with("0/") { 1 } else { 0 };
    for other in [
        "",
        "status",
        "?token=0",
        &path[..32],
        &format!("{}{last}/", &path[..31]),
    ] {
        assert_eq!(
            asked(&served, &format!("GET /{other}"), "", "").0,
            "403",
            "{other}"
        );
    }
    let run = format!("POST /{path}run");
    let origin = |name: &str| format!("Origin: {name}\r\n");
    let own = origin(&format!("http://127.0.0.1:{}", served.port()));
    assert_eq!(asked(&served, &run, &own, "[]").0, "200");
    let rebound = format!("Host: evil.example\r\n{own}");
    for foreign in [
        "",
        &origin("http://evil.example"),
        &origin("null"),
        &rebound,
    ] {
        assert_eq!(asked(&served, &run, foreign, "[]").0, "403", "{foreign}");
    }
    drop(served.0.stdin.take());
    let ended = served.0.wait().unwrap();
    assert!(ended.success(), "{ended}");
}

/// Headers of the page that used the address: its cookie, and the key and origin that a POST needs beside it.
fn entered(served: &Served) -> (String, String) {
    let path = served.1.rsplit('/').next().unwrap();
    let (status, answer) = asked(served, &format!("GET /{path}"), "", "");
    assert_eq!(status, "200", "{answer}");
    assert!(answer.contains("X-Frame-Options: DENY"), "{answer}");
    let cookie = answer.split("Set-Cookie: ").nth(1).unwrap();
    let (cookie, how) = cookie.lines().next().unwrap().split_once(';').unwrap();
    assert!(
        how.contains("HttpOnly") && how.contains("SameSite=Strict"),
        "{how}"
    );
    let key = &answer.split("'pinwheel key', '").nth(1).unwrap()[..32];
    let more = format!(
        "X-Pinwheel-Key: {key}\r\nOrigin: http://127.0.0.1:{}\r\n",
        served.port()
    );
    (format!("Cookie: {cookie}\r\n"), more)
}

#[test]
fn explore_saves_what_was_moved_and_nothing_of_anybody_s() {
    let dir = tempfile::tempdir().unwrap();
    let gears = dir.path().join("gears");
    std::fs::create_dir(&gears).unwrap();
    let own = "base = \"own.toml\" # ours\n# Measured in May.\n[gear]\neccentricity_m = 0.00075\nexternal_sleeves = 40\n\
               pin_circle_radius_m = 0.052 # as drawn\nexternal_sleeve_radius_m = 0.002\ninternal_sleeves = 10\n\
               internal_sleeve_radius_m = 0.004\ninternal_circle_radius_m = 0.032\nwheels = 2\nbacklash_m = 1e-5\n\
               [bearings.eccentric]\nrollers = 16\nroller_length_m = 9e-3\n";
    let drive = "[drive]\ninput_speed_rad_s = 100\noutput_torque_n_m = 200\n";
    std::fs::write(gears.join("own.toml"), drive).unwrap();
    std::fs::write(gears.join("gear.toml"), own).unwrap();
    let moved = r#"[["gear.backlash_m","2e-5"],["bearings.eccentric.stiffness_n_m","3e8"]]"#;
    let saved = |served: &Served, moved: &str| {
        let (cookie, more) = entered(served);
        let answer = asked(served, "POST /save", &(cookie + &more), moved).1;
        let file = answer
            .split(r#"{"file":""#)
            .nth(1)
            .unwrap_or_else(|| panic!("{answer}"));
        std::fs::read_to_string(dir.path().join(file.trim_end_matches("\"}"))).unwrap()
    };
    let on = |scene: &str, set: &str| {
        Served::with(dir.path(), scene, &["--print", "--port", "0", "--set", set])
    };
    let served = on("gears/gear.toml", "drive.output_torque_n_m=300");
    let lines = "\nbacklash_m = 2e-5\n[bearings.eccentric]\nexponent = 1.1111111111111112\nstiffness_n_m = 3e8\n";
    let expected = own
        .replace("own.toml\" # ours", "gears/own.toml\"")
        .split("\nbacklash")
        .next()
        .unwrap()
        .to_owned()
        + lines;
    let expected = expected.replace(
        "\n# Measured",
        "\ndrive.output_torque_n_m = 300\n# Measured",
    );
    assert_eq!(saved(&served, moved), expected);
    let served = on("paper", "contact.damping_n_s_m=9");
    let lines = "base = \"paper\"\ncontact.damping_n_s_m = 9\ngear.backlash_m = 1e-4\n";
    assert_eq!(saved(&served, r#"[["gear.backlash_m","1e-4"]]"#), lines);
    // Two of them, and 160 states: each is a file of its own.
    let both = [on("paper", "gear.wheels=2"), on("paper", "gear.wheels=2")];
    std::thread::scope(|scope| {
        for (number, served) in both.iter().enumerate() {
            let (cookie, more) = entered(served);
            scope.spawn(move || {
                for k in 0..80 {
                    let body = format!(r#"[["gear.backlash_m","{number}.{k:02}1e-5"]]"#);
                    asked(served, "POST /save", &format!("{cookie}{more}"), &body);
                }
            });
        }
    });
    let texts = std::fs::read_dir(dir.path())
        .unwrap()
        .filter_map(|file| std::fs::read_to_string(file.unwrap().path()).ok());
    let states: std::collections::BTreeSet<String> =
        texts.filter(|text| text.contains("1e-5")).collect();
    assert_eq!(states.len(), 160, "each once");
}

/// Processor time that a program has taken, in ticks of the system.
#[cfg(target_os = "linux")]
fn ticks(served: &Served) -> u64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", served.0.id())).unwrap();
    stat.split_whitespace().nth(13).unwrap().parse().unwrap()
}

/// A run that takes many seconds holds up no other question, whatever is asked, and ends with who asked for it.
#[cfg(target_os = "linux")]
#[test]
fn hard_explore_answers_3000_mutated_questions_while_a_slow_run_goes_on() {
    use std::io::{Read as _, Write as _};
    let dir = tempfile::tempdir().unwrap();
    let served = Served::of(dir.path(), "steel", "0");
    let (cookie, more) = entered(&served);
    let host = format!("127.0.0.1:{}", served.port());
    let connect = || std::net::TcpStream::connect(&host).unwrap();
    let body = r#"[["drive.input_speed_rad_s","1e6"]]"#;
    let length = body.len();
    let run = || {
        let mut slow = connect();
        write!(slow, "POST /run HTTP/1.1\r\nHost: {host}\r\n{cookie}{more}Content-Length: {length}\r\n\r\n{body}").unwrap();
        slow.set_nonblocking(true).unwrap();
        slow
    };
    let mut slow = run();

    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/requests");
    let mut paths: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|file| file.unwrap().path())
        .collect();
    paths.sort();
    let value = |header: &str| {
        header
            .split_once(": ")
            .unwrap()
            .1
            .lines()
            .next()
            .unwrap()
            .to_owned()
    };
    let replace = |bytes: Vec<u8>, name: &str, value: &str| -> Vec<u8> {
        let text: String = bytes.iter().map(|byte| *byte as char).collect();
        text.replace(name, value).chars().map(|c| c as u8).collect()
    };
    let seeds = paths.iter().map(|path| {
        let bytes = std::fs::read(path).unwrap();
        let bytes = replace(bytes, "HOST", &host);
        replace(
            replace(bytes, "COOKIE", &value(&cookie)),
            "KEY",
            &value(&more),
        )
    });
    let seeds: Vec<Vec<u8>> = seeds.collect();
    assert!(seeds.len() > 15);
    let mut state = 59_u64;
    let mut below = |most: usize| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 33) as usize % most.max(1)
    };
    let (mut slowest, mut answered) = (std::time::Duration::ZERO, 0);
    for k in 0..3000 {
        if slow.read(&mut [0]).is_ok() {
            slow = run();
        }
        let mut bytes = seeds[k % seeds.len()].clone();
        for _ in 0..below(4) {
            let at = below(bytes.len());
            match below(5) {
                0 => bytes.truncate(at),
                1 => bytes[at] = below(256) as u8,
                2 => drop(bytes.remove(at)),
                3 => bytes.insert(at, b"\r\n\0:9 "[below(6)]),
                _ => bytes
                    .splice(at..at, seeds[below(seeds.len())].clone())
                    .for_each(drop),
            }
            if bytes.is_empty() {
                bytes.push(b'G');
            }
        }
        let begun = std::time::Instant::now();
        let mut socket = connect();
        // Who is refused early may close before all is sent.
        let _ = socket
            .write_all(&bytes)
            .and_then(|()| socket.shutdown(std::net::Shutdown::Write));
        let mut answer = Vec::new();
        let _ = socket.read_to_end(&mut answer);
        assert!(answer.is_empty() || answer.starts_with(b"HTTP/1.1 "), "{k}");
        answered += usize::from(answer.starts_with(b"HTTP/1.1 200"));
        slowest = slowest.max(begun.elapsed());
    }
    println!("3000 questions, {answered} answered with 200, slowest {slowest:?}");
    assert!(
        answered > 100 && slowest.as_secs_f64() < 5.0,
        "{answered} {slowest:?}"
    );
    assert_eq!(asked(&served, "GET /status", &cookie, "").0, "200");
    // A run goes on as long as its page is there, and no longer.
    slow = run();
    std::thread::sleep(std::time::Duration::from_millis(500));
    let still = slow.read(&mut [0]).unwrap_err();
    assert_eq!(still.kind(), std::io::ErrorKind::WouldBlock);
    drop(slow);
    std::thread::sleep(std::time::Duration::from_secs(1));
    let before = ticks(&served);
    std::thread::sleep(std::time::Duration::from_secs(1));
    let taken = ticks(&served) - before;
    assert!(taken < 20, "{taken} ticks after its page was closed");
}

/// Arguments of a process are there for all users to read: the browser's hold no token, and the file that they name is its user's.
#[cfg(target_os = "linux")]
#[test]
fn explore_hands_the_browser_a_file_that_only_its_user_may_read() {
    use std::os::unix::fs::PermissionsExt as _;
    let dir = tempfile::tempdir().unwrap();
    let browser = dir.path().join("xdg-open");
    let script = "#!/bin/sh\necho \"$@\" >args.part\nstat -c %a \"$1\" >mode; cat \"$1\" >page; mv args.part args\n";
    std::fs::write(&browser, script).unwrap();
    std::fs::set_permissions(&browser, std::fs::Permissions::from_mode(0o755)).unwrap();
    let path = format!(
        "{}:{}",
        dir.path().display(),
        std::env::var("PATH").unwrap()
    );
    let mut served = Served::in_path(dir.path(), "paper", &["--port", "0"], Some(&path));
    let read = |name: &str| std::fs::read_to_string(dir.path().join(name));
    let args = (0..200).find_map(|_| {
        std::thread::sleep(std::time::Duration::from_millis(50));
        read("args").ok()
    });
    let args = args.unwrap();
    let token = served.1.split("token=").nth(1).unwrap();
    assert!(!args.contains(token) && !args.contains("http"), "{args}");
    assert_eq!(read("mode").unwrap().trim(), "600");
    assert!(read("page").unwrap().contains(&format!("url={}", served.1)));
    assert_eq!(interrupt(&mut served).0, Some(0));
    assert!(!Path::new(args.trim()).exists(), "{args}");
}

/// Whoever was refused and goes on to send, a byte at a time, keeps no place from others for long.
#[test]
fn explore_is_not_shut_by_those_it_refused() {
    use std::io::Write as _;
    let dir = tempfile::tempdir().unwrap();
    let served = Served::of(dir.path(), "paper", "0");
    let host = format!("127.0.0.1:{}", served.port());
    let mut refused: Vec<_> = (0..40)
        .map(|_| std::net::TcpStream::connect(&host).unwrap())
        .collect();
    for _ in 0..8 {
        refused
            .iter_mut()
            .for_each(|socket| drop(socket.write(b"\0")));
        std::thread::sleep(std::time::Duration::from_millis(100));
    }
    let (status, _) = asked(&served, "GET /status", "", "");
    assert_eq!(status, "403");
}

#[test]
fn explore_answers_its_own_page_alone() {
    let dir = tempfile::tempdir().unwrap();
    let init =
        "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500";
    assert_eq!(run_in(dir.path(), words(init)).code, Some(0));
    let served = Served::start(dir.path(), "0");
    let host = format!("127.0.0.1:{}", served.port());
    let path = served.1.rsplit('/').next().unwrap();
    let ask = |request: &str, more: &str, body: &str| asked(&served, request, more, body);
    assert_eq!(ask("GET /", "", "").0, "403", "without a token");
    assert_eq!(ask("GET /?token=00", "", "").0, "403", "a wrong token");
    let (cookie, key) = entered(&served);
    // Other servers of this machine set cookies too, of any bytes, and many.
    let others = "y".repeat(100_000);
    let cookie = format!(
        "Cookie: other=\u{e9}; {}; more={others}\r\n",
        &cookie[8..].trim_end()
    );
    assert_eq!(
        ask(&format!("GET /{path}"), "", "").0,
        "403",
        "a token twice"
    );
    assert_eq!(ask("GET /status", &cookie, "").0, "200");
    let rebound = format!("Host: evil.example\r\n{cookie}");
    assert_eq!(ask("GET /status", &rebound, "").0, "403", "another host");
    // Whoever serves another port of this machine has the cookie, and with it no key.
    let shown = ask("GET /", &cookie, "");
    assert_eq!(shown.0, "200");
    let (key, origin) = key.split_once('\n').unwrap();
    assert!(!shown.1.contains(&key[16..48]));
    let stolen = format!("{cookie}{origin}");
    let wrong = format!("{stolen}X-Pinwheel-Key: {}\r\n", "0".repeat(32));
    let alone = format!("{cookie}{key}\n");
    let own = format!("{alone}{origin}");
    let other = format!("{alone}Origin: http://evil.example\r\n");
    for foreign in [&alone, &other, &stolen, &wrong] {
        assert_eq!(ask("POST /run", foreign, "[]").0, "403", "another origin");
        assert_eq!(ask("POST /save", foreign, "[]").0, "403", "another origin");
    }
    assert_eq!(ask("POST /run", &own, "[]").0, "200");
    for nonsense in [
        "nonsense",
        "",
        "{}",
        "[[1, 2]]",
        "[[\"a\"]]",
        &"[".repeat(16_000),
    ] {
        assert_eq!(ask("POST /run", &own, nonsense).0, "400");
    }
    for long in [20_000, 1_000_000] {
        assert_eq!(ask("POST /run", &own, &" ".repeat(long)).0, "413");
    }
    let long = format!("{cookie}X: {}\r\n", "x".repeat(300_000));
    assert_eq!(ask("GET /status", &long, "").0, "431");
    let twice = format!("{own}{origin}");
    assert_eq!(ask("POST /run", &twice, "[]").0, "403");
    // No value makes it fail; what is no scene is a reason.
    let keys = [
        "gear.eccentricity_m",
        "gear.backlash_m",
        "contact.law",
        "bearings.eccentric.stiffness_n_m",
        "bearings.eccentric.clearance_m",
    ];
    for key in keys {
        for value in [
            "",
            "-1",
            "nan",
            "1e308",
            "-inf",
            "\\u0000",
            "[",
            "x = 1\\ny",
        ] {
            for path in ["run", "balances"] {
                let (status, answer) = ask(
                    &format!("POST /{path}"),
                    &own,
                    &format!(r#"[["{key}","{value}"]]"#),
                );
                assert_eq!(status, "200", "{key} {value}: {answer}");
                assert!(answer.contains(r#"{"reason":"#), "{key} {value}: {answer}");
            }
        }
    }
    // Those that announce more than they send, or too much, or nothing at all, hold up no other.
    let stalled = ["16000", "1000000000000", "99999999999999999999999", "-1"].map(|length| {
        use std::io::Write as _;
        let mut socket = std::net::TcpStream::connect(&host).unwrap();
        write!(
            socket,
            "POST /run HTTP/1.1\r\nHost: {host}\r\n{own}Content-Length: {length}\r\n\r\n["
        )
        .unwrap();
        [socket, std::net::TcpStream::connect(&host).unwrap()]
    });
    std::thread::sleep(std::time::Duration::from_millis(500));
    assert_eq!(ask("GET /status", &cookie, "").0, "200");
    drop(stalled);
    // Idle ones, however many, shut nobody out; nor do those that were refused and go on to send a byte now and then.
    let idle: Vec<_> = (0..80)
        .map(|_| std::net::TcpStream::connect(&host).unwrap())
        .collect();
    assert_eq!(ask("GET /status", &cookie, "").0, "200", "80 idle ones");
    drop(idle);
    let length = |value: &str| format!("{own}Content-Length: {value}\r\n");
    for (more, status) in [
        (format!("{own}Transfer-Encoding: chunked\r\n"), "411"),
        (length("2"), "400"),
    ] {
        assert_eq!(ask("POST /run", &more, "[]").0, status, "{more}");
    }
    // Only what sliders move can be set.
    let (_, saved) = ask(
        "POST /save",
        &own,
        r#"[["name","../x"],["gear.backlash_m","1e-5"]]"#,
    );
    assert!(
        saved.ends_with(r#"{"file":"gear-explored.toml"}"#),
        "{saved}"
    );
}
