//! Whether a studio answers.

use std::io::{self, Read as _, Write as _};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::time::Duration;

/// Longest wait for the connection and for each part of the answer.
const TIMEOUT: Duration = Duration::from_secs(2);

/// Longest read part of an answer, its headers (byte).
const LONGEST: u64 = 8192;

/// Start of the header by which a studio of any version is recognised, in lower case.
const SERVER: &str = "server: jointplay/";

/// Sends a request to the studio on a port of the loopback interface, and returns its address.
///
/// # Errors
/// If nothing listens on the port, or the answer is not that of a studio.
pub fn ping(port: u16) -> io::Result<String> {
    let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port));
    let mut stream = TcpStream::connect_timeout(&address, TIMEOUT)?;
    stream.set_read_timeout(Some(TIMEOUT))?;
    stream.set_write_timeout(Some(TIMEOUT))?;
    // In one piece: another program may hang up after the first.
    let host = format!("Host: {address}\r\nConnection: close\r\n\r\n");
    stream.write_all(format!("GET /api/v1/robot HTTP/1.1\r\n{host}").as_bytes())?;
    let mut answer = Vec::new();
    stream.take(LONGEST).read_to_end(&mut answer)?;
    if is_studio(&answer) {
        Ok(format!("http://{address}/"))
    } else {
        let line = String::from_utf8_lossy(&answer);
        let line = line.lines().next().unwrap_or_default();
        Err(io::Error::other(format!("the answer is not that of a studio: \"{line}\"")))
    }
}

/// Whether an answer is that of a studio.
fn is_studio(answer: &[u8]) -> bool {
    let answer = String::from_utf8_lossy(answer);
    let head = answer.split("\r\n\r\n").next().unwrap_or_default();
    head.starts_with("HTTP/1.1 200 ")
        && head.lines().any(|line| line.to_ascii_lowercase().starts_with(SERVER))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn servers_of_other_programs_are_no_studio() {
        let server = crate::guard::SERVER;
        let own = format!(
            "HTTP/1.1 200 OK\r\ncontent-type: application/json\r\nServer: {server}\r\n\r\n{{}}"
        );
        assert!(is_studio(own.as_bytes()));
        for other in [
            "HTTP/1.1 200 OK\r\nServer: nginx\r\n\r\n{}",
            "HTTP/1.1 200 OK\r\n\r\nserver: jointplay/1.0.0\r\n",
            "HTTP/1.1 404 Not Found\r\nserver: jointplay/1.0.0\r\n\r\n",
            "",
        ] {
            assert!(!is_studio(other.as_bytes()), "{other}");
        }
    }
}
