//! The simulated controller whose robots the page shows.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use jointplay::interop::host::HostSnapshot;

/// A simulated controller with the robots of its hosts, as the page shows them.
///
/// The server of the controller adds each host by [`Self::connect`]; requests read the robots from there.
#[derive(Clone)]
pub struct ControllerMonitor(Arc<Inner>);

struct Inner {
    address: String,
    language: String,
    speed: f64,
    hosts: Mutex<Hosts>,
}

#[derive(Default)]
struct Hosts {
    connected: BTreeMap<usize, ConnectedHost>,
    /// Number of the last host.
    last: usize,
}

/// A connected host.
#[derive(Clone)]
pub(crate) struct ConnectedHost {
    /// Number of the host, from 1.
    pub(crate) number: usize,
    /// Its address.
    pub(crate) peer: String,
    /// Zero of the clock of its session.
    start: Instant,
    snapshot: Arc<HostSnapshot>,
}

/// The place of a host in a [`ControllerMonitor`], until it is dropped.
pub struct HostPlace {
    monitor: ControllerMonitor,
    number: usize,
}

impl ControllerMonitor {
    /// A controller without hosts.
    ///
    /// # Arguments
    /// * `address` – where it listens
    /// * `language` – name of the language of its hosts
    /// * `speed` – factor of the time of the robot
    #[must_use]
    pub fn new(address: String, language: String, speed: f64) -> Self {
        Self(Arc::new(Inner { address, language, speed, hosts: Mutex::default() }))
    }

    /// Adds a host.
    ///
    /// # Arguments
    /// * `peer` – address of the host
    /// * `start` – zero of the clock of its session
    #[must_use]
    pub fn connect(&self, peer: String, start: Instant, snapshot: HostSnapshot) -> HostPlace {
        let mut hosts = self.hosts();
        hosts.last += 1;
        let number = hosts.last;
        let host = ConnectedHost { number, peer, start, snapshot: Arc::new(snapshot) };
        hosts.connected.insert(number, host);
        HostPlace { monitor: self.clone(), number }
    }

    fn hosts(&self) -> MutexGuard<'_, Hosts> {
        self.0.hosts.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn address(&self) -> &str {
        &self.0.address
    }

    pub(crate) fn language(&self) -> &str {
        &self.0.language
    }

    pub(crate) fn speed(&self) -> f64 {
        self.0.speed
    }

    /// All connected hosts, in the order of their numbers.
    pub(crate) fn connected(&self) -> Vec<ConnectedHost> {
        self.hosts().connected.values().cloned().collect()
    }

    /// The connected host with a number.
    pub(crate) fn host(&self, number: usize) -> Option<ConnectedHost> {
        self.hosts().connected.get(&number).cloned()
    }
}

impl ConnectedHost {
    pub(crate) fn snapshot(&self) -> &HostSnapshot {
        &self.snapshot
    }

    /// The time by the clock of its session (s).
    pub(crate) fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

impl HostPlace {
    /// Replaces what is shown, after an event of the session.
    pub fn update(&self, snapshot: HostSnapshot) {
        if let Some(host) = self.monitor.hosts().connected.get_mut(&self.number) {
            host.snapshot = Arc::new(snapshot);
        }
    }
}

impl Drop for HostPlace {
    fn drop(&mut self) {
        self.monitor.hosts().connected.remove(&self.number);
    }
}
