//! `jointplay cell serve`: a simulated controller on TCP.

use std::net::{SocketAddr, TcpListener};
use std::path::PathBuf;

use clap::Args;
use jointplay::interop::host::{HostLanguage, HostSession, MAX_BYTES};
use serde::Serialize;

use super::connection::{Hosts, Server};
use super::input::CellArgs;
use super::monitor::{Monitor, Page, StudioArgs};
use crate::arguments::finite;
use crate::failure::Failure;
use crate::source::{label, read_text};

/// Longest accepted file of a token (bytes).
const MAX_TOKEN: u64 = 1_000;
/// Shortest accepted token (bytes).
const LEAST_TOKEN: usize = 16;

/// Simulate the controller of a cell for host software: commands and answers over TCP
///
/// Each connection has a robot of its own, at home at first. Each command is planned and checked before it is accepted, and completed after its planned time; a command with a violation is refused with its reason.
/// Serves this machine only, until Ctrl-C; another address needs --token-file, and each host then sends the token as its first line.
#[derive(Args)]
#[command(after_help = "\
Examples:
  jointplay cell serve
  jointplay cell serve tool.toml --listen 127.0.0.1:7000 --speed 10
  jointplay cell serve tool.toml --language my-controller.toml
  jointplay cell serve tool.toml --studio

  $ nc 127.0.0.1 7000
  READY Dual arm with shared T: q1 q2 q3 T RA RB
  GET LP1 3 A
  ACCEPTED 4.032 GET LP1 3 A
  COMPLETED 4.032 GET LP1 3 A

Exit codes: 0 done, 2 bad input, usage, or a port that is in use, 130 interrupted.")]
pub(super) struct Serve {
    #[command(flatten)]
    pub(super) cell: CellArgs,
    /// Address and port to listen on; port 0 is any free port
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:7000")]
    listen: SocketAddr,
    /// File with the language of the host (TOML) [default: the neutral language]
    #[arg(long, visible_alias = "dialect", value_name = "FILE")]
    language: Option<PathBuf>,
    /// Factor of the time of the robot: at 10, every motion takes a tenth of its planned time
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = speed)]
    speed: f64,
    /// File with the token that hosts send as their first line; required for addresses of other machines
    #[arg(long, value_name = "FILE")]
    token_file: Option<PathBuf>,
    #[command(flatten)]
    studio: StudioArgs,
}

fn speed(text: &str) -> Result<f64, String> {
    let value = finite(text)?;
    if (1e-3..=1e6).contains(&value) {
        return Ok(value);
    }
    Err(format!("must be from 0.001 to 1000000, got {value}"))
}

/// The address of a running controller.
#[derive(Serialize)]
struct Address {
    address: String,
    language: String,
    /// Address of the page that shows the robots of the hosts.
    #[serde(skip_serializing_if = "Option::is_none")]
    studio: Option<String>,
}

impl Serve {
    pub(super) fn run(&self) -> Result<(), Failure> {
        let source = self.cell.load()?;
        let language = self.language()?;
        // Invalid cells are reported here, and not to each host.
        HostSession::new(&language, source.cell.clone(), self.speed).map_err(|invalid| {
            let why = invalid.first().map_or_else(String::new, ToString::to_string);
            Failure::Robot(format!("{}: {why}", source.label))
        })?;
        let token = self.token()?;
        let listener = TcpListener::bind(self.listen).map_err(|error| {
            Failure::Usage(format!(
                "cannot listen on {}: {error}; choose another --listen",
                self.listen
            ))
        })?;
        let address = listener.local_addr()?.to_string();
        let monitor = || Monitor::new(address.clone(), language.name.clone(), self.speed);
        let page = self.studio.page(&self.cell, monitor)?;
        let studio = page.as_ref().map(Page::url);
        let shown = Address { address: address.clone(), language: language.name.clone(), studio };
        self.cell.format.print(&shown, |Address { address, language, studio }| {
            let studio = studio.as_ref().map_or_else(String::new, |url| format!("studio: {url}\n"));
            format!("controller: {address}, language {language}\n{studio}  press Ctrl-C to stop\n")
        })?;
        let monitor = page.as_ref().map(Page::monitor);
        let hosts = Hosts { cell: source.cell, language, speed: self.speed, token, monitor };
        let server = Server::new(listener, hosts);
        match page {
            Some(page) => page.run(move || server.run()),
            None => server.run(),
        }
    }

    fn language(&self) -> Result<HostLanguage, Failure> {
        let Some(path) = &self.language else { return Ok(HostLanguage::neutral()) };
        let text = read_text(path, MAX_BYTES as u64)?;
        HostLanguage::parse(&text).map_err(|errors| Failure::invalid(&errors, &label(path)))
    }

    fn token(&self) -> Result<Option<String>, Failure> {
        let Some(path) = &self.token_file else {
            if self.listen.ip().is_loopback() {
                return Ok(None);
            }
            return Err(Failure::Usage(format!(
                "{} is reachable from other machines: use --token-file, or listen on 127.0.0.1",
                self.listen.ip()
            )));
        };
        let text = read_text(path, MAX_TOKEN)?;
        let token = text.trim_end_matches(['\r', '\n']).to_owned();
        if token.len() < LEAST_TOKEN || token.chars().any(char::is_control) {
            return Err(Failure::Usage(format!(
                "{}: the token must be one line of at least {LEAST_TOKEN} characters",
                path.display()
            )));
        }
        Ok(Some(token))
    }
}
