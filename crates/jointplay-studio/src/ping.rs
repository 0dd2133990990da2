//! Whether a studio answers.

use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::Duration;

/// Longest wait for the connection and for each part of the answer.
const TIMEOUT: Duration = Duration::from_secs(2);

/// Longest first line of an answer (byte).
const LONGEST: u64 = 256;

/// Sends a request to the studio on a port of the loopback interface, and returns its address.
///
/// # Errors
/// If nothing listens on the port, or the answer is not that of a studio.
pub fn ping(port: u16) -> io::Result<String> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let mut stream = TcpStream::connect_timeout(&address, TIMEOUT)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    write!(stream, "GET /api/v1/robot HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n")?;
    let mut answer = Vec::new();
    stream.take(LONGEST).read_to_end(&mut answer)?;
    if answer.starts_with(b"HTTP/1.1 200 ") {
        Ok(format!("http://{address}/"))
    } else {
        let line = String::from_utf8_lossy(&answer);
        let line = line.lines().next().unwrap_or_default();
        Err(io::Error::other(format!("the answer is not that of a studio: \"{line}\"")))
    }
}
