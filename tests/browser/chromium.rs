//! Headless Chromium, driven over its DevTools protocol: one page at a time.

use std::collections::BTreeMap;
use std::io::Write as _;
use std::net::TcpStream;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Message, WebSocket};

/// How long anything may take on a busy machine.
const PATIENCE: Duration = Duration::from_secs(120);
/// Names under which it is installed, and where it stands on a Mac.
const NAMES: [&str; 7] = [
    "chromium",
    "chromium-browser",
    "google-chrome",
    "google-chrome-stable",
    "chrome",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
];

/// How a page is looked at.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    pub(crate) width: u32,
    pub(crate) dark: bool,
    pub(crate) still: bool,
}

/// A running browser; dropped, it ends.
pub(crate) struct Chromium {
    child: Child,
    socket: WebSocket<TcpStream>,
    /// Profile; removed with the browser.
    _profile: TempDir,
    next: u64,
    session: Option<String>,
    /// What went wrong on the page since it was opened.
    complaints: Vec<String>,
    loaded: bool,
    /// The script that pages run first.
    first: Option<String>,
}

/// The browser's program: `PINWHEEL_CHROMIUM`, or the first installed one.
fn program() -> Option<PathBuf> {
    if let Some(path) = std::env::var_os("PINWHEEL_CHROMIUM") {
        return Some(path.into());
    }
    let places: Vec<PathBuf> = std::env::var_os("PATH")
        .map(|path| std::env::split_paths(&path).collect())
        .unwrap_or_default();
    // Joining an absolute path gives the path itself.
    let found = |name: &&str| {
        places
            .iter()
            .map(|place| place.join(name))
            .find(|p| p.is_file())
    };
    NAMES.iter().find_map(found)
}

impl Chromium {
    /// Starts it; `None`, said aloud, where there is none, unless `PINWHEEL_REQUIRE_BROWSER` is set.
    pub(crate) fn start() -> Option<Self> {
        let Some(program) = program() else {
            assert!(
                std::env::var_os("PINWHEEL_REQUIRE_BROWSER").is_none(),
                "PINWHEEL_REQUIRE_BROWSER is set and there is no Chromium: install it, or name it in PINWHEEL_CHROMIUM"
            );
            // LinearSignal to the stream: what a passing test prints is not shown.
            let _ = std::io::stderr().write_all(
                b"SKIPPED: no Chromium, so the pages were not looked at; install it (Debian: apt-get install chromium) \
                  or name it in PINWHEEL_CHROMIUM\n",
            );
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        let child = Command::new(&program)
            .args([
                "--headless=new",
                "--remote-debugging-port=0",
                "--no-first-run",
                "--no-default-browser-check",
                "--disable-gpu",
                "--disable-dev-shm-usage",
                "--disable-background-networking",
                "--hide-scrollbars",
                // The pages are our own, and containers seldom allow its sandbox.
                "--no-sandbox",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| panic!("{}: {error}", program.display()));
        let (port, path) = address(profile.path());
        let stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let url = format!("ws://127.0.0.1:{port}{path}");
        let (socket, _) = tungstenite::client(url, stream).unwrap();
        let mut browser = Self {
            child,
            socket,
            _profile: profile,
            next: 0,
            session: None,
            complaints: Vec::new(),
            loaded: false,
            first: None,
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let attached = browser.call(
            "Target.attachToTarget",
            json!({"targetId": target["targetId"], "flatten": true}),
        );
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page.enable", "Runtime.enable", "Log.enable"] {
            browser.call(domain, json!({}));
        }
        // Durations are processor time, so that they do not depend on what else the machine does.
        browser.call("Performance.enable", json!({"timeDomain": "threadTicks"}));
        Some(browser)
    }

    /// Opens a file and waits until it is loaded. Returns what the console complained of.
    pub(crate) fn open(&mut self, page: &Path, look: Look) {
        let page = page.canonicalize().unwrap();
        self.go(&format!("file://{}", page.display()), look);
    }

    /// The same of an address.
    pub(crate) fn go(&mut self, address: &str, look: Look) {
        self.call(
            "Emulation.setDeviceMetricsOverride",
            json!({"width": look.width, "height": 900, "deviceScaleFactor": 1, "mobile": look.width < 600}),
        );
        self.theme(look);
        self.complaints.clear();
        self.loaded = false;
        let went = self.call("Page.navigate", json!({"url": address}));
        assert!(went.get("errorText").is_none(), "{went}");
        while !self.loaded {
            self.read();
        }
    }

    /// The other theme, without opening the page anew.
    pub(crate) fn theme(&mut self, look: Look) {
        let scheme = if look.dark { "dark" } else { "light" };
        let motion = if look.still {
            "reduce"
        } else {
            "no-preference"
        };
        self.call(
            "Emulation.setEmulatedMedia",
            json!({"features": [{"name": "prefers-color-scheme", "value": scheme}, {"name": "prefers-reduced-motion", "value": motion}]}),
        );
    }

    /// `print`, or nothing for the screen.
    pub(crate) fn media(&mut self, media: &str) {
        self.call("Emulation.setEmulatedMedia", json!({"media": media}));
    }

    /// What the mouse does: kinds of events with their places; `clicks`: 0 without a button, 2 for a double click.
    pub(crate) fn mouse(&mut self, events: &[(&str, f64, f64)], clicks: u32) {
        for (kind, x, y) in events {
            let button = if clicks > 0 { "left" } else { "none" };
            let held = u32::from(clicks > 0 && *kind != "mouseReleased");
            self.call(
                "Input.dispatchMouseEvent",
                json!({"type": kind, "x": x, "y": y, "button": button, "buttons": held, "clickCount": clicks}),
            );
        }
        // What follows from it is done in tasks of their own.
        self.evaluate("new Promise((r) => setTimeout(r, 60))");
    }

    /// A key on what has the focus.
    pub(crate) fn key(&mut self, key: &str) {
        let code = match key {
            "ArrowRight" => 39,
            "Enter" => 13,
            "Escape" => 27,
            "+" => 187,
            _ => 48,
        };
        let text = match key {
            "Enter" => "\r",
            "ArrowRight" | "Escape" => "",
            other => other,
        };
        let name = if key.len() == 1 { "" } else { key };
        let mut down =
            json!({"type": "keyDown", "key": key, "code": name, "windowsVirtualKeyCode": code});
        if !text.is_empty() {
            down["text"] = json!(text);
        }
        self.call("Input.dispatchKeyEvent", down);
        self.call(
            "Input.dispatchKeyEvent",
            json!({"type": "keyUp", "key": key, "code": name, "windowsVirtualKeyCode": code}),
        );
        self.evaluate("new Promise((r) => setTimeout(r, 60))");
    }

    /// A script that every page opened from now on runs first, instead of the one before.
    pub(crate) fn before_pages(&mut self, script: &str) {
        if let Some(old) = self.first.take() {
            self.call(
                "Page.removeScriptToEvaluateOnNewDocument",
                json!({"identifier": old}),
            );
        }
        let set = self.call(
            "Page.addScriptToEvaluateOnNewDocument",
            json!({"source": script}),
        );
        self.first = set["identifier"].as_str().map(str::to_owned);
    }

    /// Sheets of A4 that the page takes in print.
    pub(crate) fn sheets(&mut self) -> usize {
        let options = json!({"printBackground": true, "paperWidth": 8.27, "paperHeight": 11.69, "preferCSSPageSize": true});
        let printed = self.call("Page.printToPDF", options);
        let pdf = STANDARD.decode(printed["data"].as_str().unwrap()).unwrap();
        let pdf = String::from_utf8_lossy(&pdf);
        pdf.matches("/Type /Page").count() - pdf.matches("/Type /Pages").count()
    }

    /// The whole page as a picture in `file`.
    pub(crate) fn picture(&mut self, file: &Path) {
        self.take(
            file,
            json!({"format": "png", "captureBeyondViewport": true}),
        );
    }

    /// The page's first 1280 by `high` pixels.
    pub(crate) fn top(&mut self, file: &Path, high: u32) {
        let clip = json!({"x": 0, "y": 0, "width": 1280, "height": high, "scale": 1});
        self.take(
            file,
            json!({"format": "png", "captureBeyondViewport": true, "clip": clip}),
        );
    }

    fn take(&mut self, file: &Path, how: Value) {
        let taken = self.call("Page.captureScreenshot", how);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        let bytes = STANDARD.decode(taken["data"].as_str().unwrap()).unwrap();
        std::fs::write(file, bytes).unwrap();
    }

    /// The value of a script, promises awaited.
    pub(crate) fn evaluate(&mut self, script: &str) -> Value {
        let got = self.call(
            "Runtime.evaluate",
            json!({"expression": script, "awaitPromise": true, "returnByValue": true}),
        );
        assert!(got.get("exceptionDetails").is_none(), "{got:#}");
        got["result"]["value"].clone()
    }

    /// What the page's main thread has done so far: `LayoutCount`, `ThreadTime` (processor seconds) and others.
    pub(crate) fn metrics(&mut self) -> BTreeMap<String, f64> {
        let got = self.call("Performance.getMetrics", json!({}));
        let list = got["metrics"].as_array().unwrap();
        let pair = |m: &Value| {
            (
                m["name"].as_str().unwrap().to_owned(),
                m["value"].as_f64().unwrap(),
            )
        };
        list.iter().map(pair).collect()
    }

    /// Errors and warnings of the console, and exceptions, since the page was opened.
    pub(crate) fn complaints(&self) -> &[String] {
        &self.complaints
    }

    fn call(&mut self, method: &str, params: Value) -> Value {
        self.next += 1;
        let id = self.next;
        let mut message = json!({"id": id, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.socket
            .send(Message::text(message.to_string()))
            .unwrap();
        loop {
            let answer = self.read();
            if answer["id"] == id {
                assert!(answer.get("error").is_none(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// The next message; events are noted.
    fn read(&mut self) -> Value {
        let message = self.socket.read().expect("the browser answers");
        let Message::Text(text) = message else {
            return Value::Null;
        };
        let message: Value = serde_json::from_str(&text).unwrap();
        let params = &message["params"];
        match message["method"].as_str() {
            Some("Page.loadEventFired") => self.loaded = true,
            Some("Runtime.exceptionThrown") => {
                let details = &params["exceptionDetails"];
                self.complaints.push(format!(
                    "exception: {} {}",
                    details["text"], details["exception"]["description"]
                ));
            }
            Some("Runtime.consoleAPICalled")
                if matches!(
                    params["type"].as_str(),
                    Some("error" | "warning" | "assert")
                ) =>
            {
                self.complaints.push(format!("console: {}", params["args"]));
            }
            Some("Log.entryAdded")
                if matches!(params["entry"]["level"].as_str(), Some("error" | "warning"))
                    // It is the tests that read pixels back.
                    && !params["entry"]["text"].to_string().contains("willReadFrequently") =>
            {
                self.complaints
                    .push(format!("log: {}", params["entry"]["text"]));
            }
            _ => {}
        }
        message
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Where it listens: it writes port and path into its profile.
fn address(profile: &Path) -> (u16, String) {
    let file = profile.join("DevToolsActivePort");
    let start = Instant::now();
    loop {
        let text = std::fs::read_to_string(&file).unwrap_or_default();
        let mut lines = text.lines();
        if let (Some(Ok(port)), Some(path)) = (lines.next().map(str::parse), lines.next()) {
            return (port, path.to_owned());
        }
        assert!(
            start.elapsed() < PATIENCE,
            "Chromium does not say where it listens"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
}
