//! A server for a page on this machine alone: HTTP/1.1, one question a connection, and a bound on all that is sent.

use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Bytes of a question's head, and of its body, at most.
const LONGEST: usize = 16_384;
const HEADERS: usize = 64;
/// Connections at a time; a browser opens six.
const MOST: usize = 32;
/// Time to send a question.
const PATIENCE: Duration = Duration::from_secs(5);
/// Time for who was refused to read why, before what it still sends is cut off.
const LINGER: Duration = Duration::from_millis(200);

/// What was asked, as it was sent.
pub(crate) struct Question {
    pub(crate) method: String,
    /// With what follows a question mark.
    pub(crate) path: String,
    headers: Vec<(String, Vec<u8>)>,
    pub(crate) body: Vec<u8>,
}

impl Question {
    /// The value of a header; `None` where it is absent, given twice or no text.
    pub(crate) fn header(&self, name: &str) -> Option<&str> {
        let all = self.headers.iter();
        let mut of_name = all.filter(|(own, _)| own.eq_ignore_ascii_case(name));
        let (_, value) = of_name.next()?;
        match of_name.next() {
            None => std::str::from_utf8(value).ok(),
            Some(_) => None,
        }
    }
}

pub(crate) struct Answer {
    status: u16,
    headers: Vec<(&'static str, String)>,
    body: Vec<u8>,
}

impl Answer {
    /// `kind`: of the text, for a browser.
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

    /// In one piece: a second one would wait for the first to be acknowledged.
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

/// A place on loopback; port 0 is any.
pub(crate) fn bind(port: u16) -> io::Result<TcpListener> {
    TcpListener::bind((Ipv4Addr::LOCALHOST, port))
}

/// Answers from now on, each question by a thread of its own: one that is slow, or never sends all, holds up no other.
pub(crate) fn serve(
    listener: TcpListener,
    reply: impl Fn(&Question) -> Answer + Send + Sync + 'static,
) -> io::Result<SocketAddr> {
    let address = listener.local_addr()?;
    let reply = Arc::new(reply);
    let here = Arc::new(AtomicUsize::new(0));
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let Ok(stream) = stream else {
                // No more files can be opened, for now.
                std::thread::sleep(LINGER);
                continue;
            };
            let place = Place::taken(&here);
            if here.load(Ordering::Relaxed) > MOST {
                continue;
            }
            let reply = Arc::clone(&reply);
            let begun = std::thread::Builder::new().spawn(move || {
                let _place = place;
                // Who asked may be gone.
                let _ = answer(stream, reply.as_ref());
            });
            // Without a thread the connection is closed.
            drop(begun);
        }
    });
    Ok(address)
}

/// Counts a connection while it is there.
struct Place(Arc<AtomicUsize>);

impl Place {
    fn taken(here: &Arc<AtomicUsize>) -> Self {
        here.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(here))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

fn answer(mut stream: TcpStream, reply: &dyn Fn(&Question) -> Answer) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let asked = question(&mut stream)?;
    let answer = match &asked {
        Ok(question) => reply(question),
        Err(status) => Answer::new(*status, "text/plain", "no question that is answered here"),
    };
    stream.write_all(&answer.bytes())?;
    stream.shutdown(Shutdown::Write)?;
    if asked.is_err() {
        // What was sent and not read would take the answer with it.
        stream.set_read_timeout(Some(LINGER))?;
        let mut rest = stream.take(1 << 20);
        io::copy(&mut rest, &mut io::sink())?;
    }
    Ok(())
}

/// What a connection asks, or the status of why not.
fn question(stream: &mut TcpStream) -> io::Result<Result<Question, u16>> {
    let begun = Instant::now();
    let mut bytes = Vec::new();
    let (mut question, head) = loop {
        let mut headers = [httparse::EMPTY_HEADER; HEADERS];
        let mut request = httparse::Request::new(&mut headers);
        match request.parse(&bytes) {
            Ok(httparse::Status::Complete(head)) => {
                let headers = request.headers.iter();
                let owned = |text: Option<&str>| text.unwrap_or_default().to_owned();
                let question = Question {
                    method: owned(request.method),
                    path: owned(request.path),
                    headers: headers
                        .map(|h| (h.name.to_owned(), h.value.to_vec()))
                        .collect(),
                    body: Vec::new(),
                };
                break (question, head);
            }
            Ok(httparse::Status::Partial) if bytes.len() < LONGEST => {}
            Ok(_) => return Ok(Err(431)),
            Err(_) => return Ok(Err(400)),
        }
        more(stream, &mut bytes, begun)?;
    };
    let announced = |name: &str| {
        question
            .headers
            .iter()
            .any(|(own, _)| own.eq_ignore_ascii_case(name))
    };
    let length = match question.header("Content-Length") {
        None if announced("Content-Length") || announced("Transfer-Encoding") => {
            return Ok(Err(411));
        }
        None => 0,
        Some(length) => match length.parse::<usize>() {
            Ok(length) if length <= LONGEST => length,
            _ => return Ok(Err(413)),
        },
    };
    while bytes.len() < head + length {
        more(stream, &mut bytes, begun)?;
    }
    question.body = bytes[head..head + length].to_vec();
    Ok(Ok(question))
}

/// The next bytes of a question.
fn more(stream: &mut TcpStream, bytes: &mut Vec<u8>, begun: Instant) -> io::Result<()> {
    let left = PATIENCE.checked_sub(begun.elapsed());
    let left = left.filter(|left| !left.is_zero());
    stream.set_read_timeout(Some(left.ok_or(io::ErrorKind::TimedOut)?))?;
    let mut piece = [0; 4096];
    match stream.read(&mut piece)? {
        0 => Err(io::ErrorKind::UnexpectedEof.into()),
        read => {
            bytes.extend_from_slice(&piece[..read]);
            Ok(())
        }
    }
}
