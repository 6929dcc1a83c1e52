//! Headless Chromium, driven over its DevTools protocol through two pipes: one page at a time.

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::{Path, PathBuf};
use std::process::{ChildStdin, Command, Stdio};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};

/// Longest wait for one message on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Names of the program, and its path on a Mac.
const NAMES: [&str; 7] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
];
/// Chromium reads commands from file 3 and writes answers to file 4. It ends with the first, and its profile is removed.
const START: &str = "P=$(mktemp -d) && \"$0\" \"$@\" --user-data-dir=\"$P\" 3<&0 4>&1 </dev/null >/dev/null 2>&1; rm -rf \"$P\"";
/// Browsers without a test.
static IDLE: Mutex<Vec<Chromium>> = Mutex::new(Vec::new());
const FLAGS: [&str; 10] = [
    "--headless=new",
    "--remote-debugging-pipe",
    "--no-first-run",
    // Its first page would take a quarter of its start.
    "--no-startup-window",
    "--no-default-browser-check",
    "--disable-gpu",
    "--disable-dev-shm-usage",
    "--disable-background-networking",
    "--hide-scrollbars",
    // The pages are this project's, and containers seldom allow its sandbox.
    "--no-sandbox",
];

/// Width of the screen, theme, and preference for less motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Look {
    pub(crate) width: u32,
    pub(crate) dark: bool,
    pub(crate) still: bool,
}

pub(crate) const DESK: Look = Look {
    width: 1280,
    dark: false,
    still: true,
};
/// Width of A4 between its margins, pixels.
const SHEET: u32 = 718;
pub(crate) const PHONE: Look = Look { width: 390, ..DESK };

/// Running browser, ended on drop.
pub(crate) struct Chromium {
    commands: ChildStdin,
    answers: Receiver<Value>,
    next: u64,
    session: Option<String>,
    /// Browser context of the open page, created with the first one.
    context: Option<Value>,
    /// Current look, to send changes alone.
    look: Option<Look>,
    /// Errors and warnings of the console, and exceptions, since the page was opened.
    pub(crate) complaints: Vec<String>,
    loaded: bool,
}

/// Returns the browser's program: `PINWHEEL_CHROMIUM`, or the first installed one.
fn program() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("PINWHEEL_CHROMIUM") {
        return Some(path.into());
    }
    let path = std::env::var_os("PATH").unwrap_or_default();
    let places: Vec<PathBuf> = std::env::split_paths(&path).collect();
    // Joining an absolute path gives the path itself.
    let mut all = NAMES
        .iter()
        .flat_map(|name| places.iter().map(move |place| place.join(name)));
    all.find(|program| program.is_file())
}

/// Runs a test in an empty browser, which the next one uses too, and an empty folder. Without a browser it prints a note and skips the test, or fails if
/// `PINWHEEL_REQUIRE_BROWSER` is set.
pub(crate) fn browse(test: impl FnOnce(&mut Chromium, &Path)) {
    let Some(program) = program() else {
        assert!(
            std::env::var_os("PINWHEEL_REQUIRE_BROWSER").is_none(),
            "PINWHEEL_REQUIRE_BROWSER is set and there is no Chromium: install it, or name it in PINWHEEL_CHROMIUM"
        );
        // Straight to the stream: output of a passing test is not shown.
        let _ = std::io::stderr().write_all(
            b"SKIPPED: no Chromium, so the pages were not looked at; install it (Debian: apt-get install chromium) \
              or name it in PINWHEEL_CHROMIUM\n",
        );
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    let idle = IDLE.lock().unwrap().pop();
    let mut browser = idle.unwrap_or_else(|| Chromium::start(&program));
    test(&mut browser, dir.path());
    // Removes everything that the test stored.
    browser.session = None;
    if let Some(context) = browser.context.take() {
        browser.call("Target.disposeBrowserContext", context);
    }
    IDLE.lock().unwrap().push(browser);
}

impl Chromium {
    fn start(program: &Path) -> Self {
        let mut child = Command::new("sh")
            .args(["-c", START])
            .arg(program)
            .args(FLAGS)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null()) // held by nobody when the test has ended
            .spawn()
            .unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        let (sender, answers) = channel();
        let commands = child.stdin.take().unwrap();
        let mut stream = BufReader::new(child.stdout.take().unwrap());
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while stream.read_until(0, &mut message).is_ok_and(|n| n > 0) {
                message.pop();
                if sender
                    .send(serde_json::from_slice(&message).unwrap())
                    .is_err()
                {
                    break;
                }
                message.clear();
            }
            let _ = child.wait();
        });
        Self {
            commands,
            answers,
            next: 0,
            session: None,
            context: None,
            look: None,
            complaints: Vec::new(),
            loaded: false,
        }
    }

    /// Opens an empty page in a context of its own if there is none. It is called late: the browser starts while pages are made.
    fn begin(&mut self) {
        if self.context.is_some() {
            return;
        }
        let context = self.call("Target.createBrowserContext", json!({}));
        let options =
            json!({"url": "about:blank", "browserContextId": context["browserContextId"]});
        let target = self.call("Target.createTarget", options);
        let options = json!({"targetId": target["targetId"], "flatten": true});
        let attached = self.call("Target.attachToTarget", options);
        self.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in [
            "Page.enable",
            "Runtime.enable",
            "Log.enable",
            "Performance.enable",
        ] {
            self.call(domain, json!({}));
        }
        self.context = Some(context);
        self.look = None;
    }

    /// Opens a file and waits until it is loaded.
    pub(crate) fn open(&mut self, page: &Path, look: Look) {
        let page = page.canonicalize().unwrap();
        self.go(&format!("file://{}", page.display()), look);
    }

    /// Removes everything that pages stored, as for a new user.
    pub(crate) fn forget(&mut self) {
        self.evaluate("localStorage.clear()");
        self.call("Network.clearBrowserCookies", json!({}));
    }

    /// Opens an address and waits until it is loaded.
    pub(crate) fn go(&mut self, address: &str, look: Look) {
        self.begin();
        self.look(look);
        self.complaints.clear();
        self.loaded = false;
        let went = self.call("Page.navigate", json!({"url": address}));
        assert!(went.get("errorText").is_none(), "{went}");
        while !self.loaded {
            self.read();
        }
    }

    /// Changes width and theme of the open page.
    pub(crate) fn look(&mut self, look: Look) {
        let before = self.look.replace(look);
        if before.is_none_or(|before| before.width != look.width) {
            self.call(
                "Emulation.setDeviceMetricsOverride",
                json!({"width": look.width, "height": 900, "deviceScaleFactor": 1, "mobile": look.width < 600}),
            );
        }
        if before.is_some_and(|before| (before.dark, before.still) == (look.dark, look.still)) {
            return;
        }
        let scheme = ["light", "dark"][usize::from(look.dark)];
        let motion = ["no-preference", "reduce"][usize::from(look.still)];
        self.call(
            "Emulation.setEmulatedMedia",
            json!({"features": [{"name": "prefers-color-scheme", "value": scheme}, {"name": "prefers-reduced-motion", "value": motion}]}),
        );
    }

    /// Selects the medium `print`, or the screen for an empty name.
    pub(crate) fn media(&mut self, media: &str) {
        self.call("Emulation.setEmulatedMedia", json!({"media": media}));
        self.look = None; // removed with it
    }

    /// Sends events of the mouse with their places; `clicks`: 0 without a button, 2 for a double click.
    pub(crate) fn mouse(&mut self, events: &[(&str, f64, f64)], clicks: u32) {
        for (kind, x, y) in events {
            let button = if clicks > 0 { "left" } else { "none" };
            let held = u32::from(clicks > 0 && *kind != "mouseReleased");
            self.call(
                "Input.dispatchMouseEvent",
                json!({"type": kind, "x": x, "y": y, "button": button, "buttons": held, "clickCount": clicks}),
            );
        }
        self.rest();
    }

    /// Presses and releases a key on the element that has the focus.
    pub(crate) fn key(&mut self, key: &str) {
        let (code, text) = match key {
            "ArrowRight" => (39, ""),
            "Enter" => (13, "\r"),
            "Escape" => (27, ""),
            "+" => (187, "+"),
            other => (48, other),
        };
        let name = if key.len() == 1 { "" } else { key };
        for kind in ["keyDown", "keyUp"] {
            let mut event =
                json!({"type": kind, "key": key, "code": name, "windowsVirtualKeyCode": code});
            if kind == "keyDown" && !text.is_empty() {
                event["text"] = json!(text);
            }
            self.call("Input.dispatchKeyEvent", event);
        }
        self.rest();
    }

    /// Waits for the tasks that follow from an event.
    fn rest(&mut self) {
        self.evaluate(
            "new Promise((r) => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(r))))",
        );
    }

    /// Adds a script that every page opened from now on runs first.
    pub(crate) fn before_pages(&mut self, script: &str) {
        let source = json!({"source": script});
        self.call("Page.addScriptToEvaluateOnNewDocument", source);
    }

    /// Returns the number of printed A4 sheets of the page. Content wider than a sheet would shrink the page with its letters.
    pub(crate) fn sheets(&mut self) -> usize {
        self.look(Look {
            width: SHEET,
            ..DESK
        });
        self.media("print");
        self.rest();
        let wide = self.evaluate("document.documentElement.scrollWidth");
        assert!(wide.as_u64() <= Some(SHEET.into()), "{wide} px in print");
        self.media("");
        self.look(DESK);
        let options = json!({"printBackground": true, "paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": true});
        let printed = self.call("Page.printToPDF", options);
        let pdf = STANDARD.decode(printed["data"].as_str().unwrap()).unwrap();
        let pdf = String::from_utf8_lossy(&pdf);
        pdf.matches("/Type /Page").count() - pdf.matches("/Type /Pages").count()
    }

    /// Writes a picture of the page, or of its first 1280 by `high` pixels, to `file`.
    pub(crate) fn picture(&mut self, file: &Path, high: Option<u32>) {
        let mut options = json!({"format": "png", "captureBeyondViewport": true});
        if let Some(high) = high {
            options["clip"] = json!({"x": 0, "y": 0, "width": 1280, "height": high, "scale": 1});
        }
        let taken = self.call("Page.captureScreenshot", options);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        let bytes = STANDARD.decode(taken["data"].as_str().unwrap()).unwrap();
        std::fs::write(file, bytes).unwrap();
    }

    /// Returns the value of a script, with promises awaited.
    pub(crate) fn evaluate(&mut self, script: &str) -> Value {
        self.begin();
        let got = self.call(
            "Runtime.evaluate",
            json!({"expression": script, "awaitPromise": true, "returnByValue": true}),
        );
        assert!(got.get("exceptionDetails").is_none(), "{got:#}");
        got["result"]["value"].clone()
    }

    /// Returns the text of a script's value.
    pub(crate) fn text(&mut self, script: &str) -> String {
        let value = self.evaluate(script);
        value.as_str().unwrap_or_default().to_owned()
    }

    /// Returns `LayoutCount` and other counts of the page's main thread.
    pub(crate) fn metrics(&mut self) -> BTreeMap<String, f64> {
        let got = self.call("Performance.getMetrics", json!({}));
        let list = got["metrics"].as_array().unwrap();
        let pair = |m: &Value| Some((m["name"].as_str()?.to_owned(), m["value"].as_f64()?));
        list.iter().filter_map(pair).collect()
    }

    /// Fails if the console has complaints since the page was opened.
    pub(crate) fn assert_quiet(&self) {
        assert!(self.complaints.is_empty(), "{:?}", self.complaints);
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        let mut message = json!({"id": id, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        write!(self.commands, "{message}\0").unwrap();
        self.commands.flush().unwrap();
        loop {
            let answer = self.read();
            if answer["id"] == id {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// Returns the next message; stores events.
    fn read(&mut self) -> Value {
        let answer = self.answers.recv_timeout(PATIENCE);
        let message = answer.expect("the browser answers");
        let params = &message["params"];
        let complaint = match message["method"].as_str() {
            Some("Page.loadEventFired") => {
                self.loaded = true;
                None
            }
            Some("Runtime.exceptionThrown") => {
                let details = &params["exceptionDetails"];
                let (text, what) = (&details["text"], &details["exception"]["description"]);
                Some(format!("exception: {text} {what}"))
            }
            Some("Runtime.consoleAPICalled") => {
                let kind = params["type"].as_str();
                let bad = matches!(kind, Some("error" | "warning" | "assert"));
                bad.then(|| format!("console: {}", params["args"]))
            }
            Some("Log.entryAdded") => {
                let (level, text) = (&params["entry"]["level"], &params["entry"]["text"]);
                // Only tests read pixels back.
                let bad = matches!(level.as_str(), Some("error" | "warning"))
                    && !text.to_string().contains("willReadFrequently");
                bad.then(|| format!("log: {text}"))
            }
            _ => None,
        };
        self.complaints.extend(complaint);
        message
    }
}
