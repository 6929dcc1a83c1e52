//! HTTP/1.1 server for a page on this machine: one request a connection, and a limit on every received size.

use std::collections::BTreeMap;
use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Longest head of a request, bytes: it has the cookies of every other server on this machine.
const LONGEST_HEAD: usize = 262_144;
/// Longest body of a request, bytes.
const LONGEST: usize = 16_384;
const HEADERS: usize = 64;
/// Largest number of connections at a time; a browser opens six.
const MOST: usize = 32;
/// Time limit for sending a request.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time for a refused client to read the reason, before the connection closes.
const LINGER: Duration = Duration::from_millis(200);
/// Interval between two checks of a connection whose request is being answered.
const LOOK: Duration = Duration::from_millis(50);

/// Request of a client.
#[derive(Debug, Default)]
pub(crate) struct Question {
    pub(crate) method: String,
    /// Path of the request, with the part after a question mark.
    pub(crate) path: String,
    headers: Vec<(String, Vec<u8>)>,
    pub(crate) body: Vec<u8>,
    /// Set once the client has closed the connection.
    pub(crate) gone: Arc<AtomicBool>,
}

impl Question {
    /// Values of a header, in the order in which they were sent.
    pub(crate) fn headers(&self, name: &str) -> impl Iterator<Item = &[u8]> {
        let of_name = move |own: &&(String, Vec<u8>)| own.0.eq_ignore_ascii_case(name);
        let of_name = self.headers.iter().filter(of_name);
        of_name.map(|(_, value)| value.as_slice())
    }

    /// Returns the value of a header; `None` if it is absent, repeated or not text.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let mut values = self.headers(name);
        let value = values.next()?;
        match values.next() {
            None => std::str::from_utf8(value).ok(),
            Some(_) => None,
        }
    }

    /// Parses a request from all bytes so far; `None` if it is incomplete. Only `Content-Length` sets the length: chunked
    /// bodies and heads with two lengths are refused.
    ///
    /// # Errors
    /// The status of a refusal.
    pub(crate) fn read(bytes: &[u8]) -> Result<Option<Self>, u16> {
        let mut headers = [httparse::EMPTY_HEADER; HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        let head = match request.parse(bytes) {
            Ok(httparse::Status::Complete(head)) if head <= LONGEST_HEAD => head,
            Ok(httparse::Status::Partial) if bytes.len() < LONGEST_HEAD => return Ok(None),
            Ok(_) | Err(httparse::Error::TooManyHeaders) => return Err(431),
            Err(_) => return Err(400),
        };
        let owned = |text: Option<&str>| text.unwrap_or_default().to_owned();
        let headers = request.headers.iter();
        let headers = headers.map(|h| (h.name.to_owned(), h.value.to_vec()));
        let mut question = Self {
            method: owned(request.method),
            path: owned(request.path),
            headers: headers.collect(),
            ..Self::default()
        };
        if question.headers("Transfer-Encoding").next().is_some() {
            return Err(411);
        }
        let length = match question.header("Content-Length") {
            None if question.headers("Content-Length").next().is_some() => return Err(400),
            None => 0,
            // Digits only, no sign.
            Some(length) if !length.bytes().all(|byte| byte.is_ascii_digit()) => return Err(400),
            Some(length) => match length.parse::<usize>() {
                Ok(length) if length <= LONGEST => length,
                _ => return Err(413),
            },
        };
        let body = bytes.get(head..head + length);
        Ok(body.map(|body| {
            question.body = body.to_vec();
            question
        }))
    }
}

pub(crate) struct Answer {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Answer {
    /// Creates an answer; `kind` is the content type of the text.
    pub(crate) fn new(status: u16, kind: &str, text: impl Into<String>) -> Self {
        Self {
            status,
            headers: vec![("Content-Type", format!("{kind}; charset=utf-8"))],
            body: text.into().into_bytes(),
        }
    }

    pub(crate) fn with(mut self, name: &'static str, value: impl Into<String>) -> Self {
        self.headers.push((name, value.into()));
        self
    }

    /// Returns the answer in one piece, because a second piece would wait for an acknowledgement.
    fn bytes(&self) -> Vec<u8> {
        let mut head = format!(
            "HTTP/1.1 {} -\r\nContent-Length: {}\r\nConnection: close\r\nCache-Control: no-store\r\nReferrer-Policy: no-referrer\r\n\
             X-Content-Type-Options: nosniff\r\n",
            self.status,
            self.body.len()
        );
        for (name, value) in &self.headers {
            head += &format!("{name}: {value}\r\n");
        }
        [head.as_bytes(), b"\r\n", &self.body].concat()
    }
}

/// Opens a listener on loopback; port 0 is any port.
pub(crate) fn bind(port: u16) -> io::Result<TcpListener> {
    TcpListener::bind((Ipv4Addr::LOCALHOST, port))
}

/// Connections without a request, by number.
type Idle = Arc<Mutex<BTreeMap<u64, TcpStream>>>;

/// Serves requests, each by its own thread, so that slow or incomplete ones delay no others. With too many connections the
/// oldest one without a request is closed.
pub(crate) fn serve(
    listener: TcpListener,
    reply: impl Fn(&Question) -> Answer + Send + Sync + 'static,
) -> io::Result<SocketAddr> {
    let address = listener.local_addr()?;
    let reply = Arc::new(reply);
    let here = Arc::new(());
    let idle = Idle::default();
    std::thread::spawn(move || {
        for (number, stream) in (0..).zip(listener.incoming()) {
            let Ok((stream, other)) = stream.and_then(|one| Ok((one.try_clone()?, one))) else {
                // The limit of open files is reached.
                std::thread::sleep(LINGER);
                continue;
            };
            if Arc::strong_count(&here) > MOST {
                match locked(&idle).pop_first() {
                    Some((_, oldest)) => drop(oldest.shutdown(Shutdown::Both)),
                    None => continue,
                }
            }
            locked(&idle).insert(number, other);
            let (place, reply, waiting) = (here.clone(), Arc::clone(&reply), Arc::clone(&idle));
            let begun = std::thread::Builder::new().spawn(move || {
                let _place = place;
                let asked = || drop(locked(&waiting).remove(&number));
                // The client may be gone.
                let _ = answer(stream, reply.as_ref(), &asked);
            });
            if begun.is_err() {
                // Without a thread the connection is closed.
                locked(&idle).remove(&number);
            }
        }
    });
    Ok(address)
}

pub(crate) fn locked<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Reads and answers a connection's request; calls `asked` in between.
fn answer(
    mut stream: TcpStream,
    reply: &dyn Fn(&Question) -> Answer,
    asked: &dyn Fn(),
) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let question = question(&mut stream);
    asked();
    let question = question?;
    let answer = match &question {
        Ok(question) => {
            let (stream, gone) = (stream.try_clone()?, Arc::clone(&question.gone));
            std::thread::spawn(move || watch(&stream, &gone));
            let answer = reply(question);
            // A set flag ends the watch.
            question.gone.store(true, Ordering::Relaxed);
            answer
        }
        Err(status) => Answer::new(*status, "text/plain", "no question that is answered here"),
    };
    stream.write_all(&answer.bytes())?;
    stream.shutdown(Shutdown::Write)?;
    if question.is_err() {
        // Unread bytes would reset the connection and lose the answer.
        let (begun, mut rest) = (Instant::now(), Vec::new());
        while rest.len() < 1 << 20 {
            more(&mut stream, &mut rest, begun, LINGER)?;
        }
    }
    Ok(())
}

/// Errors of reading an open connection for a limited time.
const STILL_OPEN: [io::ErrorKind; 2] = [io::ErrorKind::WouldBlock, io::ErrorKind::TimedOut];

/// Sets `gone` when the client closes the connection. The watch ends then, or at a byte beyond the request.
fn watch(mut stream: &TcpStream, gone: &AtomicBool) {
    while !gone.load(Ordering::Relaxed) && stream.set_read_timeout(Some(LOOK)).is_ok() {
        match stream.read(&mut [0]) {
            Err(error) if STILL_OPEN.contains(&error.kind()) => {}
            Ok(1..) => return,
            Ok(0) | Err(_) => gone.store(true, Ordering::Relaxed),
        }
    }
}

/// Reads the request of a connection; an inner error is the status of the refusal.
fn question(stream: &mut TcpStream) -> io::Result<Result<Question, u16>> {
    let begun = Instant::now();
    let mut bytes = Vec::new();
    loop {
        match Question::read(&bytes) {
            Ok(Some(question)) => return Ok(Ok(question)),
            Ok(None) => more(stream, &mut bytes, begun, PATIENCE)?,
            Err(status) => return Ok(Err(status)),
        }
    }
}

/// Reads the next bytes of a request that began at `begun` and has the time limit `most`.
fn more(
    stream: &mut TcpStream,
    bytes: &mut Vec<u8>,
    begun: Instant,
    most: Duration,
) -> io::Result<()> {
    let left = most.checked_sub(begun.elapsed());
    let left = left.filter(|left| !left.is_zero());
    stream.set_read_timeout(Some(left.ok_or(io::ErrorKind::TimedOut)?))?;
    let mut piece = [0; 16_384];
    match stream.read(&mut piece)? {
        0 => Err(io::ErrorKind::UnexpectedEof.into()),
        read => {
            bytes.extend_from_slice(&piece[..read]);
            Ok(())
        }
    }
}
