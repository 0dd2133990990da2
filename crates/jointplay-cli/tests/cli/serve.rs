//! The simulated controller: hosts on TCP, also such as send garbage, half a line, or never read.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, ChildStderr, Stdio};
use std::time::Duration;

use crate::sandbox::Sandbox;

/// A running controller.
struct Controller {
    child: Child,
    /// Its notes.
    notes: BufReader<ChildStderr>,
    address: String,
    /// Address of the page.
    studio: Option<String>,
}

impl Controller {
    fn start(sandbox: &Sandbox, flags: &str) -> Self {
        let line = format!("cell serve --listen 127.0.0.1:0 --format json {flags}");
        let mut command = sandbox.command(&line);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        let notes = BufReader::new(child.stderr.take().unwrap());
        let mut output = BufReader::new(child.stdout.take().unwrap());
        let mut text = String::new();
        while !text.contains('}') {
            assert!(output.read_line(&mut text).unwrap() > 0, "{text}");
        }
        let shown: serde_json::Value = serde_json::from_str(&text).unwrap();
        let text = |key: &str| shown[key].as_str().map(str::to_owned);
        Self { child, notes, address: text("address").unwrap(), studio: text("studio") }
    }

    fn connect(&self) -> Host {
        let stream = TcpStream::connect(&self.address).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        Host { reader: BufReader::new(stream.try_clone().unwrap()), stream }
    }
}

impl Drop for Controller {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

struct Host {
    stream: TcpStream,
    reader: BufReader<TcpStream>,
}

impl Host {
    fn send(&mut self, bytes: &[u8]) {
        self.stream.write_all(bytes).unwrap();
    }

    /// The next line; empty at the end of the connection.
    fn line(&mut self) -> String {
        let mut line = String::new();
        self.reader.read_line(&mut line).unwrap();
        line.trim_end().to_owned()
    }

    fn ask(&mut self, line: &str) -> String {
        self.send(format!("{line}\n").as_bytes());
        self.line()
    }
}

#[test]
fn hosts_have_a_robot_each_and_get_answers_in_order() {
    let sandbox = Sandbox::new();
    let controller = Controller::start(&sandbox, "--speed 1000");
    let (mut one, mut other) = (controller.connect(), controller.connect());
    assert!(one.line().starts_with("READY "));
    assert!(other.line().starts_with("READY "));
    // Both may pick the same wafer: each has its own.
    for host in [&mut one, &mut other] {
        assert!(host.ask("GET LP1 3 A").starts_with("ACCEPTED "));
        assert!(host.line().starts_with("COMPLETED "));
    }
    assert!(one.ask("PUT LP2 1 A").starts_with("ACCEPTED "));
    assert!(one.line().starts_with("COMPLETED "));
    assert!(one.ask("STATUS").ends_with("A=0 B=0"));
    assert!(other.ask("STATUS").ends_with("A=1 B=0"));
    // Lines end in any manner, and arrive in any parts.
    one.send(b"STA");
    one.send(b"TUS\r\n\n\rSTATUS\r");
    assert!(one.line().starts_with("STATUS idle"));
    assert!(one.line().starts_with("STATUS idle"));
}

#[test]
fn a_host_too_many_is_named_and_the_others_remain() {
    let sandbox = Sandbox::new();
    let mut controller = Controller::start(&sandbox, "--speed 1000");
    let mut hosts: Vec<_> = (0..16).map(|_| controller.connect()).collect();
    for host in &mut hosts {
        assert!(host.line().starts_with("READY "));
    }
    let mut refused = controller.connect();
    assert_eq!(refused.line(), "");
    let mut note = String::new();
    controller.notes.read_line(&mut note).unwrap();
    let peer = refused.stream.local_addr().unwrap();
    assert!(note.contains(&format!("the connection of {peer} is closed: 16 hosts")), "{note}");
    assert!(hosts[15].ask("STATUS").starts_with("STATUS idle"));
    // A place becomes free with its host.
    drop(hosts.remove(0));
    let mut answer = String::new();
    while answer.is_empty() {
        answer = controller.connect().line();
    }
    assert!(answer.starts_with("READY "), "{answer}");
}

/// The document that a page of this machine answers.
#[cfg(feature = "studio")]
fn fetch(url: &str, path: &str, body: &str) -> serde_json::Value {
    let host = url.trim_start_matches("http://").trim_end_matches('/');
    let method = if body.is_empty() { "GET" } else { "POST" };
    let mut stream = TcpStream::connect(host).unwrap();
    let length = body.len();
    let request = format!(
        "{method} /api/v1/{path} HTTP/1.0\r\nHost: {host}\r\nContent-Type: application/json\r\nContent-Length: {length}\r\n\r\n{body}"
    );
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    let (_, body) = answer.split_once("\r\n\r\n").unwrap();
    serde_json::from_str(body).unwrap()
}

#[cfg(feature = "studio")]
#[test]
fn the_studio_shows_each_robot_where_its_motion_is_planned() {
    let sandbox = Sandbox::new();
    // At this speed, the motion takes minutes.
    let controller = Controller::start(&sandbox, "--speed 0.01 --studio --studio-port 0");
    let page = controller.studio.clone().unwrap();
    let mut one = controller.connect();
    assert!(one.line().starts_with("READY "));
    let mut other = controller.connect();
    assert!(other.line().starts_with("READY "));
    assert!(one.ask("GET LP1 3 A").starts_with("ACCEPTED "));
    let moving = loop {
        let found = fetch(&page, "controller/hosts/1", "");
        if found["elapsed_s"].as_f64().unwrap() > 0.0 {
            break found;
        }
    };
    assert_eq!(moving["command"], "GET LP1 3 A");
    let elapsed = &moving["elapsed_s"];
    let asked = format!(r#"{{"program": "GET LP1 SLOT 3 WITH A", "time_s": {elapsed}}}"#);
    let planned = fetch(&page, "cell/jog", &asked);
    assert_eq!(moving["axes"], planned["axes"]);
    assert_eq!(fetch(&page, "controller/hosts/2", "")["command"], serde_json::Value::Null);
}

/// The lines that a text shows below `nc`.
fn shown_session<'t>(text: &'t str, end: &str) -> Vec<&'t str> {
    let (_, session) = text.split_once("$ nc 127.0.0.1 7000\n").unwrap();
    session.split_once(end).unwrap().0.lines().map(str::trim).collect()
}

#[test]
fn sessions_in_the_page_and_the_help_are_real() {
    let sandbox = Sandbox::new();
    let controller = Controller::start(&sandbox, "--speed 1000");
    let page = include_str!("../../../../docs/how-to/simulate-a-controller.md");
    let help = sandbox.done("cell serve --help");
    for session in [shown_session(page, "```"), shown_session(&help, "\n\n")] {
        let mut host = controller.connect();
        let mut sent = 0;
        for line in session {
            let (word, rest) = line.split_once(' ').unwrap_or((line, ""));
            match word {
                "READY" | "ACCEPTED" | "COMPLETED" | "REFUSED" => assert_eq!(host.line(), line),
                "STATUS" if !rest.is_empty() => assert_eq!(host.line(), line),
                _ => {
                    host.send(format!("{line}\n").as_bytes());
                    sent += 1;
                }
            }
        }
        assert!(sent > 0);
    }
}

#[test]
fn hosts_that_send_garbage_half_a_line_or_nothing_affect_no_others() {
    let sandbox = Sandbox::new();
    let controller = Controller::start(&sandbox, "--speed 1000");
    let mut host = controller.connect();
    host.line();
    // A line of a megabyte is refused once, and never stored.
    let mut long = vec![b'x'; 1_000_000];
    long.push(b'\n');
    host.send(&long);
    assert!(host.line().starts_with("REFUSED 1 the line is longer than 1000 bytes"));
    host.send(b"\x00\xff\xfe\n");
    assert!(host.line().starts_with("REFUSED 1 "));
    assert!(host.ask("STATUS").starts_with("STATUS idle"));
    // A host that sends no more lines gets the answer at the end of the motion.
    let mut brief = controller.connect();
    brief.line();
    brief.send(b"GET LP1 3 A\n");
    brief.stream.shutdown(std::net::Shutdown::Write).unwrap();
    assert!(brief.line().starts_with("ACCEPTED "));
    assert!(brief.line().starts_with("COMPLETED "));
    assert_eq!(brief.line(), "");
    // Half a line before the end of a connection is not executed, and ends the session.
    let mut half = controller.connect();
    half.line();
    half.send(b"GET LP1 3");
    half.stream.shutdown(std::net::Shutdown::Write).unwrap();
    let mut rest = String::new();
    half.reader.read_to_string(&mut rest).unwrap();
    assert_eq!(rest, "");
    // A host that never reads does not keep others from their answers.
    let mut deaf = controller.connect();
    deaf.stream.set_write_timeout(Some(Duration::from_millis(300))).unwrap();
    while deaf.stream.write_all(&b"STATUS\n".repeat(10_000)).is_ok() {}
    assert!(host.ask("STATUS").starts_with("STATUS idle"));
}

#[test]
fn addresses_of_other_machines_need_a_token_that_hosts_send_first() {
    let sandbox = Sandbox::new();
    let refused = sandbox.run("cell serve --listen 0.0.0.0:0");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("--token-file"), "{}", refused.stderr);
    sandbox.write("short.txt", "secret\n");
    let refused = sandbox.run("cell serve --token-file short.txt");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("at least 16"), "{}", refused.stderr);
    sandbox.write("token.txt", "0123456789abcdef\n");
    let controller = Controller::start(&sandbox, "--token-file token.txt");
    let mut stranger = controller.connect();
    stranger.send(b"0123456789abcdeX\n");
    assert_eq!(stranger.line(), "");
    let mut host = controller.connect();
    host.send(b"0123456789abcdef\n");
    assert!(host.line().starts_with("READY "));
}

#[test]
fn errors_of_a_language_have_their_place() {
    let sandbox = Sandbox::new();
    sandbox.write("mine.toml", "name = \"mine\"\n[[command]]\npattern = \"GO {where}\"\n");
    let refused = sandbox.run("cell serve --language mine.toml");
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("mine.toml:3:"), "{}", refused.stderr);
    assert!(refused.stderr.contains("`{where}` is not a field of patterns"), "{}", refused.stderr);
}
