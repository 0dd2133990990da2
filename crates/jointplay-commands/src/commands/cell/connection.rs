//! TCP connections of hosts to the simulated controller.

use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::{Duration, Instant};

use jointplay::cell::workcell::Cell;
use jointplay::interop::host::{HostLanguage, HostSession, MAX_LINE_BYTES};

use super::monitor::{HostPlace, Monitor};
use crate::console;
use crate::failure::Failure;

/// Largest number of hosts at a time; each has a robot of its own.
const MOST_HOSTS: usize = 16;
/// Number of lines that are received ahead of their answers; further lines wait in the connection.
const LINES_AHEAD: usize = 16;
/// Longest time for which a host may not read an answer; then its connection is closed.
const WRITE_TIME: Duration = Duration::from_secs(10);
/// Longest time until a host has sent the token.
const TOKEN_TIME: Duration = Duration::from_secs(10);
/// Largest number of connections at a time that have not sent the token; they take no place of a host.
const MOST_WAITING: usize = 64;
/// Longest time for which a motion is continued after its host sends no more lines.
const LAST_ANSWER_TIME: Duration = Duration::from_secs(60);
/// Longest wait for the next line, for motions of any length.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// Data common to all connections.
pub(super) struct Hosts {
    pub(super) cell: Cell,
    pub(super) language: HostLanguage,
    pub(super) speed: f64,
    /// Token that a host sends first.
    pub(super) token: Option<String>,
    /// Shows the robots of all hosts in the studio.
    pub(super) monitor: Option<Monitor>,
}

/// A controller that listens.
pub(super) struct Server {
    listener: TcpListener,
    hosts: Arc<Hosts>,
    connected: Places,
    waiting: Places,
}

/// Places for a limited number of connections.
#[derive(Clone)]
struct Places {
    taken: Arc<AtomicUsize>,
    most: usize,
}

/// A place, which is free again when it is dropped.
struct Place(Arc<AtomicUsize>);

impl Places {
    fn new(most: usize) -> Self {
        Self { taken: Arc::default(), most }
    }

    /// A place, if one is free.
    fn take(&self) -> Option<Place> {
        let place = Place(Arc::clone(&self.taken));
        // If none is free, the place is dropped at once.
        (self.taken.fetch_add(1, Ordering::SeqCst) < self.most).then_some(place)
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::SeqCst);
    }
}

/// A received line.
enum Received {
    Line(Vec<u8>),
    TooLong,
}

impl Server {
    pub(super) fn new(listener: TcpListener, hosts: Hosts) -> Self {
        let (connected, waiting) = (Places::new(MOST_HOSTS), Places::new(MOST_WAITING));
        Self { listener, hosts: Arc::new(hosts), connected, waiting }
    }

    /// Accepts connections until the process is interrupted; one without a free place is closed.
    pub(super) fn run(self) -> Result<(), Failure> {
        for stream in self.listener.incoming() {
            // An aborted connection concerns its host only; without file handles, a pause gives others time to end.
            let Ok(stream) = stream else {
                thread::sleep(Duration::from_millis(100));
                continue;
            };
            let Some(waiting) = self.waiting.take() else {
                note_closed(&stream, MOST_WAITING, "connections have not sent the token");
                let _ = stream.shutdown(Shutdown::Both);
                continue;
            };
            let (hosts, connected) = (Arc::clone(&self.hosts), self.connected.clone());
            thread::spawn(move || {
                // A failed connection ends its session, and nothing else.
                let _ = serve(&stream, &hosts, &connected, waiting);
                let _ = stream.shutdown(Shutdown::Both);
            });
        }
        Ok(())
    }
}

/// Names a connection that is closed because there is no place for it.
fn note_closed(stream: &TcpStream, most: usize, others: &str) {
    let peer = stream.peer_addr().map_or_else(|_| "a host".to_owned(), |peer| peer.to_string());
    console::note(&format!(
        "the connection of {peer} is closed: {most} {others}, which is the largest number"
    ));
}

/// The session of one host.
fn serve(stream: &TcpStream, hosts: &Hosts, connected: &Places, waiting: Place) -> io::Result<()> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(WRITE_TIME))?;
    if let Some(token) = &hosts.token
        && !sends_token(stream, token.as_bytes())?
    {
        return Ok(());
    }
    let Some(_place) = connected.take() else {
        note_closed(stream, MOST_HOSTS, "hosts are connected");
        return Ok(());
    };
    drop(waiting);
    let reader = BufReader::new(stream.try_clone()?);
    let session = HostSession::new(&hosts.language, hosts.cell.clone(), hosts.speed);
    let Ok(mut session) = session else { return Ok(()) };
    let (sender, lines) = sync_channel(LINES_AHEAD);
    thread::spawn(move || read(reader, &sender));
    let start = Instant::now();
    let place = hosts.monitor.as_ref().map(|monitor| {
        let peer = stream.peer_addr().map_or_else(|_| String::new(), |peer| peer.to_string());
        monitor.connect(peer, start, session.snapshot())
    });
    converse(stream, &mut Conversation { session: &mut session, start, place }, &lines)
}

/// A session with its clock, and its place in the studio.
struct Conversation<'a, 'l> {
    session: &'a mut HostSession<'l>,
    start: Instant,
    place: Option<HostPlace>,
}

impl Conversation<'_, '_> {
    /// Time since the start of the session (s).
    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// Time until the next event of the session; without one, the longest wait.
    fn wait(&self) -> Duration {
        self.session.next_event().map_or(LONGEST_WAIT, |time| {
            let wait = (time - self.now()).clamp(0.0, LONGEST_WAIT.as_secs_f64());
            Duration::from_secs_f64(wait)
        })
    }

    /// Shows the robot after an event.
    fn show(&self) {
        if let Some(place) = &self.place {
            place.update(self.session.snapshot());
        }
    }
}

/// Whether the first line of a host is the token, sent in time.
fn sends_token(mut stream: &TcpStream, token: &[u8]) -> io::Result<bool> {
    let start = Instant::now();
    let mut line = Vec::new();
    while line.len() <= token.len() {
        let left = TOKEN_TIME.saturating_sub(start.elapsed());
        if left.is_zero() {
            return Ok(false);
        }
        stream.set_read_timeout(Some(left))?;
        let mut byte = [0];
        if stream.read(&mut byte)? == 0 {
            return Ok(false);
        }
        match byte[0] {
            b'\n' | b'\r' => {
                stream.set_read_timeout(None)?;
                return Ok(is_equal(&line, token));
            }
            byte => line.push(byte),
        }
    }
    Ok(false)
}

/// Passes lines on until the connection or the session ends.
fn read(mut reader: BufReader<TcpStream>, lines: &SyncSender<Received>) {
    while let Ok(Some(line)) = receive(&mut reader) {
        if lines.send(line).is_err() {
            return;
        }
    }
}

/// Answers lines, and reports completions when they are due.
fn converse(
    mut stream: &TcpStream,
    conversation: &mut Conversation<'_, '_>,
    lines: &Receiver<Received>,
) -> io::Result<()> {
    // A template without a value, such as a division by zero, ends the session.
    let text = conversation.session.welcome().map_err(io::Error::other)?;
    stream.write_all(text.as_bytes())?;
    loop {
        let received = lines.recv_timeout(conversation.wait());
        let now = conversation.now();
        let text = match received {
            Ok(Received::Line(line)) => conversation.session.receive(&line, now),
            Ok(Received::TooLong) => conversation.session.receive_too_long(now),
            Err(RecvTimeoutError::Timeout) => conversation.session.advance(now),
            Err(RecvTimeoutError::Disconnected) => return finish(stream, conversation),
        };
        conversation.show();
        stream.write_all(text.map_err(io::Error::other)?.as_bytes())?;
        stream.flush()?;
    }
}

/// Reports the completion of a motion to a host that sends no more lines, if it ends soon.
fn finish(mut stream: &TcpStream, conversation: &mut Conversation<'_, '_>) -> io::Result<()> {
    // A closed connection cannot be distinguished from one that only sends no more: the wait is limited.
    let last = conversation.now() + LAST_ANSWER_TIME.as_secs_f64();
    while conversation.session.next_event().is_some_and(|time| time <= last) {
        thread::sleep(conversation.wait());
        let now = conversation.now();
        let text = conversation.session.advance(now).map_err(io::Error::other)?;
        conversation.show();
        stream.write_all(text.as_bytes())?;
    }
    Ok(())
}

/// The next line that is not empty, without its end: `\n`, `\r` or both; `None` at the end, where an unfinished line is dropped.
fn receive(reader: &mut impl BufRead) -> io::Result<Option<Received>> {
    let (mut line, mut is_too_long) = (Vec::new(), false);
    loop {
        let buffer = reader.fill_buf()?;
        if buffer.is_empty() {
            return Ok(None);
        }
        let end = buffer.iter().position(|byte| matches!(byte, b'\n' | b'\r'));
        let part = &buffer[..end.unwrap_or(buffer.len())];
        is_too_long |= line.len() + part.len() > MAX_LINE_BYTES;
        if !is_too_long {
            line.extend_from_slice(part);
        }
        let used = end.map_or(buffer.len(), |end| end + 1);
        reader.consume(used);
        if end.is_some() {
            if is_too_long {
                return Ok(Some(Received::TooLong));
            }
            if !line.is_empty() {
                return Ok(Some(Received::Line(line)));
            }
        }
    }
}

/// Whether two texts are equal, in a time that does not depend on where they differ.
fn is_equal(found: &[u8], expected: &[u8]) -> bool {
    let difference =
        found.iter().zip(expected).fold(0, |difference, (one, other)| difference | (one ^ other));
    found.len() == expected.len() && difference == 0
}
