//! `pinwheel explore`: a live page for this machine only.
//!
//! Other pages in the browser must not control the program. The address contains a secret token, which a browser exchanges
//! for a cookie and a key. Every request must name this host, and a request with an effect must come from this page.
//! Browsers send a cookie to every port of the machine, so a server on another port may learn it. Every POST therefore has
//! the key in a header too, from the browser's store, which separates ports. The browser is started with a file that only
//! its user may read, because other users can read arguments. A page in a frame of another site gets no cookie: a secret
//! begins each of its paths, and anyone with the secret may show the page.

use std::fs::File;
use std::io::Write as _;
use std::net::TcpListener;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::thread::JoinHandle;
use std::time::{Duration, Instant, SystemTime};

use pinwheel::gearbox::Gearbox;
use pinwheel::pages::{self, explore as live};
use pinwheel::scene::{CheckedScene, Override, Scene};
use pinwheel::studies::comparison::{self, Effort, Input};
use pinwheel::studies::output::file_name;
use pinwheel::studies::{Control, Progress, Provenance, StudyError, choice, explore as states};
use serde_json::{Value, json};

use crate::args::{self, ExploreArgs};
use crate::failure::Failure;
use crate::folder::{Folder, Request};
use crate::loopback::{self, Answer, Question, locked};
use crate::{interrupt, screen};

/// Port of the page, unless another program uses it.
const PORT: u16 = 7347;
/// Header with the key that the page received for its token.
const KEY: &str = "X-Pinwheel-Key";
/// Interval between two checks for an interrupt.
const TICK: Duration = Duration::from_millis(200);
/// Longest wait of an answer for its balances, because a longer delay is noticeable at the sliders. After late balances some runs
/// omit them.
const PATIENCE: Duration = Duration::from_millis(36);
/// Longest duration of a state's run; the page requests an unfinished run again.
const RUN: Duration = Duration::from_millis(30);
/// Number of next runs that omit balances, and the number after the next late balances.
#[derive(Clone, Copy)]
struct Without {
    left: u32,
    next: u32,
}

impl Without {
    const NONE: Self = Self { left: 0, next: 1 };
    const MOST: Self = Self { left: 16, next: 16 };

    fn after(self, figures: Option<&Result<Value, StudyError>>) -> Self {
        let Self { left, next } = self;
        match (left, figures) {
            (0, Some(_)) => Self::NONE,
            (0, None) => Self {
                left: next,
                next: Self::MOST.next.min(2 * next),
            },
            _ => Self {
                left: left - 1,
                next,
            },
        }
    }
}

/// Answer for late balances.
const LATE: Value = Value::Null;

/// State of a comparison: its progress while it runs, then its page.
#[derive(Default)]
struct Compared {
    running: bool,
    state: String,
    page: Option<String>,
    place: String,
    work: Option<JoinHandle<()>>,
}

/// Client that gets answers.
enum Entry {
    /// Browsers that used the token, by the cookie.
    Browser {
        token: String,
        cookie: String,
        key: String,
    },
    /// Any client whose paths begin with this secret.
    Frame(String),
}

impl Entry {
    /// Returns the requested path of an authorised client, or a refusal.
    fn admit<'q>(&self, question: &'q Question) -> Result<&'q str, Answer> {
        let path = question.path.as_str();
        let unknown = "open the address that the program printed";
        match self {
            Self::Frame(secret) => {
                let inside = path.strip_prefix(secret.as_str());
                let inside = inside.filter(|inside| inside.starts_with('/'));
                inside.ok_or_else(|| refused(unknown))
            }
            Self::Browser { token, cookie, key } => {
                let sent = path.strip_prefix("/?token=");
                if sent == Some(token.as_str()) {
                    let cookie = format!("{cookie}; HttpOnly; SameSite=Strict; Path=/");
                    let key = format!(include_str!("../../templates/entered.html"), key = key);
                    return Err(page(key).with("Set-Cookie", cookie));
                }
                // Cookies of other servers may have any bytes.
                let mut cookies = question.headers("Cookie");
                let known = cookies.any(|all| {
                    let mut each = all.split(|byte| *byte == b';');
                    each.any(|one| one.trim_ascii() == cookie.as_bytes())
                });
                let has_key = question.method != "POST" || question.header(KEY) == Some(key);
                match (known, has_key) {
                    // A link of an earlier start.
                    (true, true) if sent.is_some() => Ok("/"),
                    (true, true) => Ok(path),
                    (true, false) => Err(refused(
                        "this page lacks the key of the address: open that address again",
                    )),
                    _ => Err(refused(unknown)),
                }
            }
        }
    }
}

/// Gear for balances, the flag that stops them, and the receiver of the result.
type Beside = (
    Arc<Gearbox>,
    Arc<AtomicBool>,
    mpsc::Sender<Result<Value, StudyError>>,
);

/// Solves balances one after the other in a waiting thread. A new thread would start on its parent's processor and share it
/// with the run.
fn balances_beside() -> mpsc::Sender<Beside> {
    let (asks, asked) = mpsc::channel::<Beside>();
    std::thread::spawn(move || {
        for (gearbox, stop, tells) in asked {
            // The receiver may be gone.
            let _ = tells.send(balances(&gearbox, "/balances", &stop));
        }
    });
    asks
}

/// Returns the figures of a state for the page: those of balances, with bands for `/bands`, or the yield for `/sample`.
fn balances(gearbox: &Gearbox, path: &str, stop: &AtomicBool) -> Result<Value, StudyError> {
    if path == "/sample" {
        return Ok(live::sample(states::sample(gearbox, stop)?));
    }
    let (figures, limits) = states::figures(gearbox, path == "/bands", stop)?;
    Ok(live::balances(&figures, limits.as_ref(), &gearbox.scene))
}

struct Explorer {
    spec: String,
    /// Overrides of the user, for scenes that are saved and compared.
    sets: Vec<Override>,
    /// Overrides of the user and a start in balance, for the scene that the page shows.
    settled: Vec<Override>,
    /// Time span of the motion on the scene's page, s.
    span_s: Mutex<f64>,
    /// Host and port, `127.0.0.1:PORT`.
    host: String,
    entry: Entry,
    /// Page whose balances are computed, and the flag that stops them when it requests newer ones.
    balancing: Mutex<(String, Arc<AtomicBool>)>,
    /// Channel to the thread for balances.
    beside: mpsc::Sender<Beside>,
    without: Mutex<Without>,
    compared: Mutex<Compared>,
}

pub(crate) fn explore(args: &ExploreArgs) -> Result<(), Failure> {
    let spec = args.scene.scene.clone();
    let sets = args::overrides(&args.scene.set)?;
    let scene = Scene::load(&spec, &sets)?;
    let port = args.embed.then_some(0);
    let listener = listen(args.port.or(port))?;
    let unknown = |error: std::io::Error| Failure::engine(format!("loopback: {error}"));
    let host = listener.local_addr().map_err(unknown)?.to_string();
    let token = secret()?;
    let (path, entry) = if args.embed {
        (format!("/{token}/"), Entry::Frame(format!("/{token}")))
    } else {
        let path = format!("/?token={token}");
        let cookie = format!("{}={}", cookie_name(&host), secret()?);
        let key = secret()?;
        (path, Entry::Browser { token, cookie, key })
    };
    let address = format!("http://{host}{path}");
    let explorer = Arc::new(Explorer {
        settled: states::settled(&spec, &sets),
        span_s: Mutex::new(states::span_s(&scene)),
        spec,
        sets,
        entry,
        balancing: Mutex::default(),
        beside: balances_beside(),
        without: Mutex::new(Without::NONE),
        compared: Mutex::default(),
        host,
    });
    let answering = Arc::clone(&explorer);
    loopback::serve(listener, move |question| {
        let answer = answering.admit(question).unwrap_or_else(|answer| answer);
        match answering.entry {
            Entry::Browser { .. } => answer.with("X-Frame-Options", "DENY"),
            Entry::Frame(_) => answer,
        }
    })
    .map_err(unknown)?;
    screen::show(&format!("page: {address}"))?;
    let mut opened = None;
    if args.embed {
        std::thread::spawn(|| {
            // The client with the page has the other end.
            let _ = std::io::copy(&mut std::io::stdin().lock(), &mut std::io::sink());
            interrupt::flag().store(true, Ordering::Relaxed);
        });
    } else if !args.print {
        opened = entrance(&address).ok();
        let started = opened.as_ref().map(|file| open::that_detached(file.path()));
        if !matches!(started, Some(Ok(()))) {
            screen::complain("no browser could be started; open the address yourself");
        }
    }
    interrupt::watched();
    while interrupt::check().is_ok() {
        std::thread::sleep(TICK);
    }
    drop(opened);
    // A comparison stops at the interrupt and removes its draft.
    let work = locked(&explorer.compared).work.take();
    if let Some(work) = work {
        let _ = work.join();
    }
    Ok(())
}

/// Listens on the requested port, else on the default one, which keeps the browser's store, else on any.
fn listen(port: Option<u16>) -> Result<TcpListener, Failure> {
    let listener = match port {
        Some(port) => loopback::bind(port),
        None => loopback::bind(PORT).or_else(|_| loopback::bind(0)),
    };
    let port = port.unwrap_or_default();
    let remedy = "name another with --port";
    listener
        .map_err(|error| Failure::input(format!("port {port} cannot be used: {error}; {remedy}")))
}

/// Writes a temporary file with a link to `address` that only the user may read.
fn entrance(address: &str) -> std::io::Result<tempfile::NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    let mut file = builder.prefix("pinwheel-").suffix(".html").tempfile()?;
    let link = format!(
        include_str!("../../templates/entrance.html"),
        address = address
    );
    file.write_all(link.as_bytes())?;
    file.flush()?;
    Ok(file)
}

/// Returns 128 secret random bits.
fn secret() -> Result<String, Failure> {
    let mut bytes = [0; 16];
    let none = "this system gives no random numbers";
    getrandom::fill(&mut bytes).map_err(|error| Failure::engine(format!("{none}: {error}")))?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Returns the cookie's name with the port: cookies ignore ports, and two of these programs must not share one.
fn cookie_name(host: &str) -> String {
    format!("pinwheel-{}", host.rsplit(':').next().unwrap_or_default())
}

fn page(text: impl Into<String>) -> Answer {
    Answer::new(200, "text/html", text)
}

fn json_of(value: &Value) -> Answer {
    Answer::new(200, "application/json", value.to_string())
}

fn plain(status: u16, why: impl Into<String>) -> Answer {
    Answer::new(status, "text/plain", why)
}

/// Answers a valid request without a result.
fn reason(why: impl Into<Value>) -> Answer {
    json_of(&json!({ "reason": why.into() }))
}

impl From<Failure> for Answer {
    fn from(failure: Failure) -> Self {
        plain(500, failure.message)
    }
}

/// Returns balances for the page's script; null if they were stopped.
fn balanced(balances: Result<Value, StudyError>) -> Value {
    match balances {
        Ok(balances) => balances,
        Err(StudyError::Cancelled) => LATE,
        Err(why) => json!({"reason": why.to_string()}),
    }
}

fn refused(why: &str) -> Answer {
    plain(403, why)
}

impl Explorer {
    /// Returns the answer to an authorised client, or a refusal.
    fn admit(self: &Arc<Self>, question: &Question) -> Result<Answer, Answer> {
        if question.header("Host") != Some(self.host.as_str()) {
            return Err(refused("another host was asked for"));
        }
        let path = self.entry.admit(question)?;
        // A request for balances names its page.
        let (path, tab) = path.split_once('?').unwrap_or((path, ""));
        match question.method.as_str() {
            "GET" => match path {
                "/" => self.page(&question.gone),
                "/status" => Ok(json_of(&self.status())),
                "/comparison" => Ok(self.comparison()),
                _ => Ok(plain(404, "there is nothing here")),
            },
            "POST" => {
                if question.header("Origin") != Some(format!("http://{}", self.host).as_str()) {
                    return Err(refused("another page asked"));
                }
                let values: Vec<(String, String)> = serde_json::from_slice(&question.body)
                    .map_err(|_| plain(400, "not a list of keys and values"))?;
                match path {
                    "/run" => self.run(tab, &values, &question.gone),
                    "/save" => self.save(&values),
                    "/compare" => self.compare(&values),
                    "/file" => self.file(&values),
                    "/balances" | "/bands" | "/sample" | "/motion" => {
                        self.balances(tab, path, &values, &question.gone)
                    }
                    _ => Ok(plain(404, "there is nothing here")),
                }
            }
            _ => Err(plain(405, "only GET and POST")),
        }
    }

    fn page(&self, gone: &AtomicBool) -> Result<Answer, Answer> {
        let mend = |why| format!("{why}\n\nMend the file and load this page again.");
        let scene = states::scene(&self.spec, &self.settled, &[]);
        let scene = scene.map_err(|why| plain(422, mend(why)))?;
        *locked(&self.span_s) = states::span_s(&scene);
        let origin = Provenance::here(args::typed());
        let gearbox = states::quick(&scene).map_err(|why| plain(422, why))?;
        let motion = states::motion(&gearbox, states::span_s(&scene), &Control::silent(gone));
        let motion = motion.map_err(Failure::from)?;
        let text = live::page(&scene, motion.as_ref(), &origin);
        text.map(page).map_err(|why| plain(422, why))
    }

    /// Answers with the run of a state and its balances, each if ready in time; stops when its page is `gone`.
    fn run(&self, tab: &str, values: &states::Values, gone: &AtomicBool) -> Result<Answer, Answer> {
        let begun = Instant::now();
        let stop = Arc::default();
        self.newest(tab, &stop);
        let gearbox = states::gearbox(&self.spec, &self.settled, values);
        let gearbox = Arc::new(gearbox.map_err(reason)?);
        let without = *locked(&self.without);
        let hears = (without.left == 0).then(|| {
            let (tells, hears) = mpsc::channel();
            // If the thread has ended, the balances count as late.
            let asked = (Arc::clone(&gearbox), Arc::clone(&stop), tells);
            let _ = self.beside.send(asked);
            hears
        });
        // Unlocked during the run, so that other requests are answered.
        let span_s = *locked(&self.span_s);
        let late = AtomicBool::new(false);
        let watch = |_: Progress<'_>| {
            if begun.elapsed() > RUN || gone.load(Ordering::Relaxed) {
                late.store(true, Ordering::Relaxed);
            }
        };
        let reply = match states::motion(&gearbox, span_s, &Control::new(&late, &watch)) {
            Ok(motion) => live::run(motion.as_ref()),
            Err(_) => Ok(json!({})),
        };
        let patience = match reply {
            Ok(_) => PATIENCE.saturating_sub(begun.elapsed()),
            Err(_) => Duration::ZERO,
        };
        let figures = hears.and_then(|hears| hears.recv_timeout(patience).ok());
        *locked(&self.without) = without.after(figures.as_ref());
        stop.store(true, Ordering::Relaxed);
        let mut run = reply.map_err(reason)?;
        run["balanced"] = figures.map_or(LATE, balanced);
        Ok(json_of(&run))
    }

    /// Answers a request for motion, balances, bands or a sample of the newest state; `stop` cancels the computation.
    fn balances(
        &self,
        tab: &str,
        path: &str,
        values: &states::Values,
        stop: &Arc<AtomicBool>,
    ) -> Result<Answer, Answer> {
        self.newest(tab, stop);
        let gearbox = states::gearbox(&self.spec, &self.settled, values).map_err(reason)?;
        if path == "/motion" {
            let span_s = *locked(&self.span_s);
            return match states::motion(&gearbox, span_s, &Control::silent(stop)) {
                Ok(motion) => Ok(json_of(&live::run(motion.as_ref()).map_err(reason)?)),
                Err(_) => Ok(json_of(&LATE)),
            };
        }
        let begun = Instant::now();
        let reply = balances(&gearbox, path, stop);
        if path == "/balances" && reply.is_ok() {
            let late = begun.elapsed() > PATIENCE;
            *locked(&self.without) = if late { Without::MOST } else { Without::NONE };
        }
        Ok(json_of(&balanced(reply)))
    }

    /// Cancels the running balances of a page; `stop` cancels the new ones.
    fn newest(&self, tab: &str, stop: &Arc<AtomicBool>) {
        let own = (tab.to_owned(), Arc::clone(stop));
        let (before, running) = std::mem::replace(&mut *locked(&self.balancing), own);
        if before == tab {
            running.store(true, Ordering::Relaxed);
        }
    }

    /// Returns the scene's file with the changed values as a download.
    fn file(&self, values: &states::Values) -> Result<Answer, Answer> {
        let (name, text) = states::file(&self.spec, &self.sets, values).map_err(reason)?;
        let name = format!("{}-explored.toml", file_name(&name));
        Ok(json_of(&json!({"name": name, "text": text})))
    }

    /// Writes the scene's file with the changed values into the working folder; never replaces a file.
    fn save(&self, values: &states::Values) -> Result<Answer, Answer> {
        let (name, text) = states::file(&self.spec, &self.sets, values).map_err(reason)?;
        let stem = file_name(&name);
        let stem = stem.split("-explored").next().unwrap_or_default();
        let mut number = 1;
        let (name, mut file) = loop {
            let name = match number {
                1 => format!("{stem}-explored.toml"),
                number => format!("{stem}-explored-{number}.toml"),
            };
            match File::create_new(&name) {
                Ok(file) => break (name, file),
                // Another program may have just taken the name.
                Err(error) if error.kind() == std::io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(plain(500, format!("{name}: {error}"))),
            }
        };
        file.write_all(text.as_bytes()).map_err(|error| {
            // The incomplete file is this program's.
            let _ = std::fs::remove_file(&name);
            plain(500, format!("{name}: {error}"))
        })?;
        Ok(json_of(&json!({"file": name})))
    }

    /// Starts a comparison of all engines, unless one is running.
    fn compare(self: &Arc<Self>, values: &states::Values) -> Result<Answer, Answer> {
        let scene = states::scene(&self.spec, &self.sets, values).map_err(reason)?;
        let mut compared = locked(&self.compared);
        if compared.running {
            return Err(reason("a comparison is under way"));
        }
        *compared = Compared {
            running: true,
            state: "Compares".to_owned(),
            ..Compared::default()
        };
        let explorer = Arc::clone(self);
        compared.work = Some(std::thread::spawn(move || {
            let done = explorer.compared(&scene);
            let mut compared = locked(&explorer.compared);
            compared.running = false;
            match done {
                Ok((text, place)) => (compared.page, compared.place) = (Some(text), place),
                Err(failure) => compared.state = failure.message,
            }
        }));
        Ok(json_of(&json!({})))
    }

    /// Returns the time of the scene's file and the state of the comparison.
    fn status(&self) -> Value {
        let written = std::fs::metadata(&self.spec).and_then(|file| file.modified());
        let since = written
            .ok()
            .and_then(|time| time.duration_since(SystemTime::UNIX_EPOCH).ok());
        let compared = locked(&self.compared);
        json!({
            "stamp": since.unwrap_or_default().as_secs_f64(),
            "compares": compared.state,
            "page": compared.page.as_ref().map(|_| "comparison"),
            "place": compared.place,
        })
    }

    fn comparison(&self) -> Answer {
        match &locked(&self.compared).page {
            Some(text) => page(text.clone()),
            None => plain(404, "nothing was compared yet"),
        }
    }

    /// Computes a comparison; returns its page and its folder.
    fn compared(&self, scene: &CheckedScene) -> Result<(String, String), Failure> {
        let gearbox = Gearbox::new(scene).map_err(Failure::input)?;
        let engines = choice::engines(&[] as &[&str], scene)?;
        // The name differs from that of `compare`, whose results for the file must stay.
        let name = format!("{}-explored-compare", args::label(&self.spec));
        let out = Path::new("out").join(name);
        let folder = Folder::asked(&out, Request::default())?;
        let input = Input {
            gearbox: &gearbox,
            engines: &engines,
            data: &[],
        };
        let report = |progress: Progress<'_>| {
            let Progress {
                done, total, piece, ..
            } = progress;
            locked(&self.compared).state = format!("Compares: {done} of {total}, {piece}");
        };
        let control = Control::new(interrupt::flag(), &report);
        let effort = Effort {
            obey: Effort::asked(scene, &self.spec, &self.sets, 1.0, 1.0)?.obey,
            ..Effort::of(scene)
        };
        let outcome = comparison::run_with(&input, effort, &control)?;
        let origin = folder.write(|dir, origin| outcome.write(dir, origin))?;
        let page = pages::comparison::page(&outcome, &origin);
        folder.write_page(&page)?;
        let place = folder.publish()?;
        Ok((page, place.display().to_string()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After late balances 1, 2, 4 ... runs omit them, and after balances in time none.
    #[test]
    fn late_balances_are_asked_for_again() {
        let mut without = Without::NONE;
        let mut asked = Vec::new();
        for run in 0..40 {
            if without.left == 0 {
                asked.push(run);
            }
            without = without.after(None);
        }
        assert_eq!(asked, [0, 2, 5, 10, 19, 36]);
        without.left = 0;
        let again = without.after(Some(&Ok(LATE)));
        assert_eq!((again.left, again.next), (0, 1));
    }
}
