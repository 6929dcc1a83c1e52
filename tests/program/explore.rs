//! Server of `pinwheel explore`: access, saved files, and independence of clients.

#![allow(clippy::print_stdout, reason = "measured figures")]

use std::path::Path;

use pinwheel_tests::served::Served;
use pinwheel_tests::{names_in, repository, run_in, words};

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

/// Requests `path` at the page's own host, with more headers and a body; returns the status and the complete answer.
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
    // Headers are bytes, one for each character.
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

/// Returns the headers of the page that used the address: its cookie, and the key and origin for a POST.
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
    // Two servers and 160 states: every state is saved in its own file.
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

/// Returns the processor time of a program, in ticks of the system.
#[cfg(target_os = "linux")]
fn ticks(served: &Served) -> u64 {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", served.0.id())).unwrap();
    stat.split_whitespace().nth(13).unwrap().parse().unwrap()
}

/// A run of many seconds delays no other request, and ends with its client.
#[cfg(target_os = "linux")]
#[test]
fn hard_explore_answers_500_mutated_questions_while_a_slow_run_goes_on() {
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
        write!(slow, "POST /motion HTTP/1.1\r\nHost: {host}\r\n{cookie}{more}Content-Length: {length}\r\n\r\n{body}").unwrap();
        slow.set_nonblocking(true).unwrap();
        slow
    };
    let mut slow = run();

    let folder = repository("fuzz/corpus/requests");
    let value = |header: &str| {
        let (_, value) = header.lines().next().unwrap().split_once(": ").unwrap();
        value.to_owned()
    };
    let replace = |bytes: Vec<u8>, name: &str, value: &str| -> Vec<u8> {
        let text: String = bytes.iter().map(|byte| *byte as char).collect();
        text.replace(name, value).chars().map(|c| c as u8).collect()
    };
    let seeds = names_in(&folder).into_iter().map(|name| {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        let bytes = replace(bytes, "HOST", &host);
        let bytes = replace(bytes, "COOKIE", &value(&cookie));
        replace(bytes, "KEY", &value(&more))
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
    for k in 0..500 {
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
        // The server may close an early refusal before all is sent.
        let _ = socket
            .write_all(&bytes)
            .and_then(|()| socket.shutdown(std::net::Shutdown::Write));
        let mut answer = Vec::new();
        let _ = socket.read_to_end(&mut answer);
        assert!(answer.is_empty() || answer.starts_with(b"HTTP/1.1 "), "{k}");
        answered += usize::from(answer.starts_with(b"HTTP/1.1 200"));
        slowest = slowest.max(begun.elapsed());
    }
    println!("500 questions, {answered} answered with 200, slowest {slowest:?}");
    assert!(
        answered > 30 && slowest.as_secs_f64() < 5.0,
        "{answered} {slowest:?}"
    );
    assert_eq!(asked(&served, "GET /status", &cookie, "").0, "200");
    // A run continues only as long as its page exists.
    slow = run();
    std::thread::sleep(std::time::Duration::from_millis(200));
    let still = slow.read(&mut [0]).unwrap_err();
    assert_eq!(still.kind(), std::io::ErrorKind::WouldBlock);
    drop(slow);
    std::thread::sleep(std::time::Duration::from_millis(500));
    let before = ticks(&served);
    std::thread::sleep(std::time::Duration::from_millis(500));
    let taken = ticks(&served) - before;
    assert!(taken < 10, "{taken} ticks after its page was closed");
}

/// All users can read arguments of a process: the browser's contain no token, and only the user can read the file that they
/// name.
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
    assert_eq!(served.interrupt().0, Some(0));
    assert!(!Path::new(args.trim()).exists(), "{args}");
}

/// Refused clients that continue to send, a byte at a time, do not occupy connections for long.
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
    let init = "init gear.toml --ratio 39 --pin-circle-diameter-mm 104 --torque-n-m 200 --speed-rpm 1500 --ideal";
    assert_eq!(run_in(dir.path(), words(init)).code, Some(0));
    let served = Served::of(dir.path(), "gear.toml", "0");
    let host = format!("127.0.0.1:{}", served.port());
    let ask = |request: &str, more: &str, body: &str| asked(&served, request, more, body);
    assert_eq!(ask("GET /", "", "").0, "403", "without a token");
    assert_eq!(ask("GET /?token=00", "", "").0, "403", "a wrong token");
    let (cookie, key) = entered(&served);
    // Other servers of this machine set many cookies too, of any bytes.
    let others = "y".repeat(100_000);
    let cookie = format!(
        "Cookie: other=\u{e9}; {}; more={others}\r\n",
        &cookie[8..].trim_end()
    );
    // Every browser of the user is admitted by the address, with the same cookie and key. An admitted browser may follow a link
    // of an earlier start.
    assert_eq!(entered(&served).1, key, "a second browser");
    let old = format!("GET /?token={}", "0".repeat(32));
    assert_eq!(ask(&old, "", "").0, "403", "an old link");
    assert_eq!(ask(&old, &cookie, "").0, "200", "an old link");
    assert_eq!(ask("GET /status", &cookie, "").0, "200");
    let rebound = format!("Host: evil.example\r\n{cookie}");
    assert_eq!(ask("GET /status", &rebound, "").0, "403", "another host");
    // Another server on this machine has the cookie, but not the key.
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
    // No value causes a failure; an invalid scene gives a reason.
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
    // Clients that announce more than they send, or too much, or nothing, delay no other.
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
    // Idle clients of any number exclude no other, nor do refused ones that send single bytes.
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
    // Without a file on the server, the state is returned for the client to save.
    let (_, body) = ask("POST /file", &own, r#"[["gear.backlash_m","1e-5"]]"#);
    let file = body.contains(r#""name":"gear-explored.toml""#);
    assert!(file && body.contains("backlash_m = 1e-5"), "{body}");
    assert!(!dir.path().join("gear-explored.toml").exists());
    // Faults use the words and units of the slider.
    let (_, body) = ask("POST /run", &own, r#"[["gear.backlash_m","5e-3"]]"#);
    let both = body.contains("Backlash is 5000 \u{b5}m") && body.contains("backlash = 420 \u{b5}m");
    assert!(
        both && !body.contains("--set") && !body.contains("0.005 m"),
        "{body}"
    );
    // Only keys with a slider can be set.
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
