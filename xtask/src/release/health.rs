//! The server of the container image and its health check, as the Containerfile states them.

use std::net::TcpListener;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};
use std::{io, iter};

use crate::process;

/// Longest wait for a healthy server.
const TIMEOUT: Duration = Duration::from_secs(30);

/// Pause between health checks.
const PAUSE: Duration = Duration::from_millis(200);

/// What an image runs, each without the program.
#[derive(Debug, PartialEq, Eq)]
struct Image {
    /// Arguments of the server.
    server: Vec<String>,
    /// Arguments of the health check.
    health: Vec<String>,
    /// Port of both.
    port: String,
}

/// Starts the server of a Containerfile, and waits until its health check passes, which it must not before.
///
/// # Arguments
/// * `server`, `probe` – the program of the image without arguments, for the server and for health checks
///
/// # Errors
/// If the Containerfile has no health check of its server, or that passes without a server or fails with it.
pub(super) fn check(
    containerfile: &str,
    server: impl Fn() -> Command,
    probe: impl Fn() -> Command,
) -> io::Result<()> {
    let Image { server: arguments, health, port } = Image::parse(containerfile)?;
    // The one in the Containerfile may be in use here.
    let free = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port().to_string();
    let with_port =
        |words: &[String]| words.iter().map(|word| word.replace(&port, &free)).collect::<Vec<_>>();
    let is_healthy = || {
        let mut probe = probe();
        probe.args(with_port(&health)).stdout(Stdio::null()).stderr(Stdio::null());
        probe.status().map(|status| status.success())
    };
    if is_healthy()? {
        return Err(io::Error::other("the health check passes without a server"));
    }
    let start = Instant::now();
    let running = process::start(server().args(with_port(&arguments)).stdout(Stdio::null()))?;
    let healthy = iter::repeat_with(is_healthy)
        .inspect(|_| sleep(PAUSE))
        .take_while(|_| start.elapsed() < TIMEOUT)
        .find(|found| !matches!(found, Ok(false)));
    process::stop(running)?;
    match healthy.transpose()? {
        Some(_) => Ok(()),
        None => Err(io::Error::other("the server starts, but its health check does not pass")),
    }
}

impl Image {
    fn parse(containerfile: &str) -> io::Result<Self> {
        let words = |instruction: &str| {
            let line = containerfile.lines().find(|line| line.starts_with(instruction));
            let list = line.and_then(|line| line.split_once(" [")).map(|(_, list)| list);
            let list = list.and_then(|list| serde_json::from_str(&format!("[{list}")).ok());
            let missing = || format!("the Containerfile has no list of words after {instruction}");
            list.ok_or_else(|| io::Error::other(missing()))
        };
        let (entry, server): (Vec<String>, Vec<String>) = (words("ENTRYPOINT")?, words("CMD")?);
        let health: Vec<String> = words("HEALTHCHECK")?;
        let port = server.iter().skip_while(|word| *word != "--port").nth(1).cloned();
        let port = port.filter(|port| health.contains(port));
        match (health.strip_prefix(&entry[..]), port) {
            (Some(health), Some(port)) => Ok(Self { health: health.to_vec(), server, port }),
            _ => {
                let message = "the health check is not of the program and the port of the server";
                Err(io::Error::other(message))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_health_check_is_of_the_server_of_the_image() {
        let file = std::fs::read_to_string(crate::root::find().join("Containerfile")).unwrap();
        let image = Image::parse(&file).unwrap();
        assert_eq!(image.server.join(" "), format!("studio --no-open --port {}", image.port));
        assert_eq!(image.health.join(" "), format!("studio --ping --port {}", image.port));
        let refused = |from: &str, to: &str| Image::parse(&file.replace(from, to)).unwrap_err();
        assert!(refused("HEALTHCHECK", "# HEALTHCHECK").to_string().contains("HEALTHCHECK"));
        let other = refused("\"--ping\", \"--port\", \"4816\"", "\"--ping\", \"--port\", \"80\"");
        assert!(other.to_string().contains("not of the program and the port"), "{other}");
    }

    #[cfg(unix)]
    #[test]
    fn a_health_check_has_to_fail_without_a_server_and_pass_with_one() {
        let folder = std::env::temp_dir().join(format!("xtask-health-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let file =
            "ENTRYPOINT [\"/a\"]\nCMD [\"--port\", \"7\"]\nHEALTHCHECK CMD [\"/a\", \"7\"]\n";
        let shell = |script: &'static str| {
            let folder = folder.clone();
            move || {
                let mut shell = Command::new("sh");
                shell.args(["-c", script, "sh"]).current_dir(&folder);
                shell
            }
        };
        let server = || shell("echo \"$2\" > port; sleep 60");
        check(file, server(), shell("test \"$(cat port)\" = \"$1\"")).unwrap();
        let always = check(file, server(), shell("true")).unwrap_err().to_string();
        std::fs::remove_dir_all(&folder).unwrap();
        assert!(always.contains("without a server"), "{always}");
    }
}
