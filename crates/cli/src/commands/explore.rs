//! `pinwheel explore`: a live page, served to this machine alone.
//!
//! Other pages in the browser must not drive it: the address holds a token that works once and is exchanged for a cookie; the
//! host that is asked must be ours, and what changes anything must come from our own page.

use std::io::Read as _;
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

use pinwheel::gearbox::Gearbox;
use pinwheel::pages::{self, explore as live};
use pinwheel::scene::{CheckedScene, Override, SceneError};
use pinwheel::studies::comparison::{self, Effort, Input};
use pinwheel::studies::output::file_name;
use pinwheel::studies::{Control, Progress, Provenance, choice};
use serde_json::{Value, json};
use tiny_http::{Header, Method, Request, Response, Server};

use crate::args::{self, ExploreArgs};
use crate::failure::Failure;
use crate::folder::{Folder, replace};
use crate::{interrupt, screen};

/// Bytes of a question at most.
const LONGEST: u64 = 16_384;
/// How often an interrupt is looked for.
const TICK: Duration = Duration::from_millis(200);

/// How a comparison stands: told while it runs, then its page.
#[derive(Default)]
struct Compared {
    running: bool,
    told: String,
    page: Option<String>,
    place: String,
}

struct Explorer {
    spec: String,
    /// Of the user, for what is saved and compared.
    sets: Vec<Override>,
    /// With a start in balance, for what is looked at.
    settled: Vec<Override>,
    span_s: f64,
    /// `127.0.0.1:PORT`.
    host: String,
    /// Opens the page, once.
    token: Option<String>,
    cookie: String,
    compared: Arc<Mutex<Compared>>,
}

type Answer = Response<std::io::Cursor<Vec<u8>>>;

pub(crate) fn explore(args: &ExploreArgs) -> Result<(), Failure> {
    let spec = args.scene.scene.clone();
    let sets = args::overrides(&args.scene.set)?;
    let scene = live::scene(&spec, &sets, &[])?;
    let server = Server::http(("127.0.0.1", args.port)).map_err(|error| {
        Failure::input(format!(
            "port {} cannot be used: {error}; name another",
            args.port
        ))
    })?;
    let host = server.server_addr().to_string();
    let token = secret()?;
    let mut explorer = Explorer {
        settled: live::settled(&spec, &sets),
        span_s: live::span_s(&scene),
        spec,
        sets,
        cookie: format!("{}={}", cookie_name(&host), secret()?),
        token: Some(token.clone()),
        compared: Arc::default(),
        host,
    };
    let address = format!("http://{}/?token={token}", explorer.host);
    screen::show(&format!("page: {address}"))?;
    if !args.print && open::that_detached(&address).is_err() {
        screen::complain("no browser could be started; open the address yourself");
    }
    interrupt::watched();
    while interrupt::check().is_ok() {
        if let Ok(Some(request)) = server.recv_timeout(TICK) {
            explorer.serve(request);
        }
    }
    Ok(())
}

/// 128 bits that nobody can guess.
fn secret() -> Result<String, Failure> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes).map_err(|error| {
        Failure::engine(format!("this system gives no random numbers: {error}"))
    })?;
    Ok(bytes.iter().map(|byte| format!("{byte:02x}")).collect())
}

/// Cookies know no ports: two of these programs share none.
fn cookie_name(host: &str) -> String {
    format!("pinwheel-{}", host.rsplit(':').next().unwrap_or_default())
}

fn header(name: &str, value: &str) -> Option<Header> {
    Header::from_bytes(name, value).ok()
}

fn sent<'a>(request: &'a Request, name: &'static str) -> Option<&'a str> {
    let mut headers = request.headers().iter();
    let found = headers.find(|header| header.field.equiv(name))?;
    Some(found.value.as_str())
}

fn answer(status: u16, kind: &str, text: impl Into<String>) -> Answer {
    let answer = Response::from_data(text.into().into_bytes()).with_status_code(status);
    let headers = [
        ("Content-Type", kind),
        ("Cache-Control", "no-store"),
        ("Referrer-Policy", "no-referrer"),
        ("X-Content-Type-Options", "nosniff"),
        ("X-Frame-Options", "DENY"),
    ];
    let headers = headers
        .into_iter()
        .filter_map(|(name, value)| header(name, value));
    headers.fold(answer, Response::with_header)
}

fn page(text: impl Into<String>) -> Answer {
    answer(200, "text/html; charset=utf-8", text)
}

fn told(value: &Value) -> Answer {
    answer(200, "application/json", value.to_string())
}

fn refused(why: &str) -> Answer {
    answer(403, "text/plain; charset=utf-8", why)
}

/// Why there is no scene.
fn reason(error: &SceneError) -> Value {
    json!({"reason": error.to_string()})
}

impl Explorer {
    fn serve(&mut self, mut request: Request) {
        let answer = self.admit(&mut request).unwrap_or_else(|answer| answer);
        // Who asked may be gone.
        let _ = request.respond(answer);
    }

    /// The answer to who may ask; or why not.
    fn admit(&mut self, request: &mut Request) -> Result<Answer, Answer> {
        if sent(request, "Host") != Some(self.host.as_str()) {
            return Err(refused("another host was asked for"));
        }
        let url = request.url().to_owned();
        if let Some(token) = url.strip_prefix("/?token=") {
            if self.token.as_deref() != Some(token) {
                return Err(refused(
                    "this address was used before: start `pinwheel explore` again",
                ));
            }
            self.token = None;
            let cookie = format!("{}; HttpOnly; SameSite=Strict; Path=/", self.cookie);
            let there = [("Location", "/"), ("Set-Cookie", cookie.as_str())];
            let there = there
                .into_iter()
                .filter_map(|(name, value)| header(name, value));
            return Ok(there.fold(answer(303, "text/plain", ""), Response::with_header));
        }
        let cookies = sent(request, "Cookie").unwrap_or_default();
        if !cookies.split("; ").any(|cookie| cookie == self.cookie) {
            return Err(refused("open the address that the program printed"));
        }
        let values = match request.method() {
            Method::Get => Vec::new(),
            Method::Post => {
                if sent(request, "Origin") != Some(format!("http://{}", self.host).as_str()) {
                    return Err(refused("another page asked"));
                }
                let mut text = String::new();
                let read = request.as_reader().take(LONGEST).read_to_string(&mut text);
                let values = read.ok().and_then(|_| serde_json::from_str(&text).ok());
                values.ok_or_else(|| answer(400, "text/plain", "not a list of keys and values"))?
            }
            _ => return Err(answer(405, "text/plain", "only GET and POST")),
        };
        let posted = *request.method() == Method::Post;
        let found = match (posted, url.as_str()) {
            (false, "/") => self.page(),
            (false, "/status") => Ok(told(&self.status())),
            (false, "/comparison") => Ok(self.comparison()),
            (true, "/run") => self.run(&values),
            (true, "/save") => self.save(&values),
            (true, "/compare") => Ok(self.compare(&values)),
            _ => Ok(answer(404, "text/plain", "there is nothing here")),
        };
        found.map_err(|failure| answer(500, "text/plain; charset=utf-8", failure.message))
    }

    fn page(&self) -> Result<Answer, Failure> {
        let scene = live::scene(&self.spec, &self.settled, &[])?;
        let made = Provenance::here(args::typed());
        Ok(match live::page(&scene, &made, interrupt::flag())? {
            Ok(text) => page(text),
            Err(why) => answer(422, "text/plain; charset=utf-8", why),
        })
    }

    fn run(&self, values: &live::Values) -> Result<Answer, Failure> {
        let scene = match live::scene(&self.spec, &self.settled, values) {
            Ok(scene) => scene,
            Err(error) => return Ok(told(&reason(&error))),
        };
        let found = live::answer(&scene, self.span_s, interrupt::flag())?;
        Ok(told(&found.unwrap_or_else(|why| json!({"reason": why}))))
    }

    /// Writes the scene beside where the program was started; never over another one.
    fn save(&self, values: &live::Values) -> Result<Answer, Failure> {
        let scene = match live::scene(&self.spec, &self.sets, values) {
            Ok(scene) => scene,
            Err(error) => return Ok(told(&reason(&error))),
        };
        let stem = format!("{}-explored", file_name(&scene.name));
        let names = (2..).map(|number| format!("{stem}-{number}.toml"));
        let mut names = std::iter::once(format!("{stem}.toml")).chain(names);
        let free = names.find(|name| !std::path::Path::new(name).exists());
        let file = free.unwrap_or_default();
        replace(file.as_ref(), scene.to_toml().as_bytes())?;
        Ok(told(&json!({"file": file})))
    }

    /// Starts a comparison of all engines, unless one is under way.
    fn compare(&self, values: &live::Values) -> Answer {
        let scene = match live::scene(&self.spec, &self.sets, values) {
            Ok(scene) => scene,
            Err(error) => return told(&reason(&error)),
        };
        {
            let mut compared = lock(&self.compared);
            if compared.running {
                return told(&json!({"reason": "a comparison is under way"}));
            }
            *compared = Compared {
                running: true,
                told: "Compares".to_owned(),
                ..Compared::default()
            };
        }
        let (shared, spec, sets) = (
            Arc::clone(&self.compared),
            self.spec.clone(),
            self.sets.clone(),
        );
        std::thread::spawn(move || {
            let done = compared(&scene, &spec, &sets, &shared);
            let mut compared = lock(&shared);
            compared.running = false;
            match done {
                Ok((text, place)) => (compared.page, compared.place) = (Some(text), place),
                Err(failure) => compared.told = failure.message,
            }
        });
        told(&json!({}))
    }

    /// When the scene's file was written, and how a comparison stands.
    fn status(&self) -> Value {
        let written = std::fs::metadata(&self.spec).and_then(|file| file.modified());
        let since = written.map(|time| {
            time.duration_since(SystemTime::UNIX_EPOCH)
                .unwrap_or_default()
        });
        let compared = lock(&self.compared);
        json!({
            "stamp": since.map_or(0.0, |since| since.as_secs_f64()),
            "compares": compared.told,
            "page": compared.page.as_ref().map(|_| "comparison"),
            "place": compared.place,
        })
    }

    fn comparison(&self) -> Answer {
        match &lock(&self.compared).page {
            Some(text) => page(text.clone()),
            None => answer(404, "text/plain", "nothing was compared yet"),
        }
    }
}

fn lock(compared: &Mutex<Compared>) -> std::sync::MutexGuard<'_, Compared> {
    compared
        .lock()
        .unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// The page of a comparison, and its folder.
fn compared(
    scene: &CheckedScene,
    spec: &str,
    sets: &[Override],
    shared: &Mutex<Compared>,
) -> Result<(String, String), Failure> {
    let gearbox = Gearbox::new(scene).map_err(|error| Failure::input(error.to_string()))?;
    let engines = choice::engines(&[] as &[&str], scene)?;
    let out = std::path::Path::new("out").join(format!("{}-compare", file_name(&scene.name)));
    let folder = Folder::prepare(&out, false)?;
    let input = Input {
        gearbox: &gearbox,
        engines: &engines,
        data: &[],
    };
    let report = |progress: Progress<'_>| {
        lock(shared).told = format!(
            "Compares: {} of {}, {}",
            progress.done, progress.total, progress.piece
        );
    };
    let control = Control::new(interrupt::flag(), &report);
    let effort = Effort::asked(scene, spec, sets, 30.0, 0.01)?;
    let found = comparison::run_with(&input, effort, &control)?;
    let made = Provenance::here(args::typed());
    found.write(folder.path(), &made)?;
    let page = pages::comparison::page(&found, &made, interrupt::flag())?;
    folder.write_page(&page)?;
    let place = folder.publish()?;
    Ok((page, place.display().to_string()))
}
