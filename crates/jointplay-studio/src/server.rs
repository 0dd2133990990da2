//! Start and shutdown of the server.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::server::graceful::GracefulShutdown;
use hyper_util::service::TowerToHyperService;
use jointplay::format::robot::{self, Robot};
use tokio::runtime::{Builder, Runtime};
use tokio::task::JoinHandle;

use crate::cell_files::CellFiles;
use crate::controller::ControllerMonitor;
use crate::mechanism_file::{MechanismFileOnDisk, MechanismSession};
use crate::meshes::MeshFolder;
use crate::robot_file::RobotFileOnDisk;
use crate::router;
use crate::session::WorkcellSession;
use crate::state::AppState;
use crate::work::Deadlines;

/// The default port.
pub const DEFAULT_PORT: u16 = 4816;

/// Longest time until the headers of a request have arrived: connections that stay without one are closed.
const HEADER_TIME: Duration = Duration::from_secs(30);

/// Time until the next connection is accepted after the operating system refused one, for instance for too many open files.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Longest time for pending requests after Ctrl-C.
const SHUTDOWN_TIME: Duration = Duration::from_secs(3);

/// Why the server cannot start or run.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The requested port is in use or not permitted.
    #[error(
        "cannot serve on port {port} of 127.0.0.1: {source}; choose another --port, or omit it to use a free port"
    )]
    Port {
        /// The requested port.
        port: u16,
        /// The error of the operating system.
        source: io::Error,
    },
    /// A mesh file of the robot cannot be read.
    #[error(transparent)]
    Mesh(#[from] robot::Error),
    /// An error of the operating system.
    #[error("cannot serve: {0}")]
    System(#[from] io::Error),
}

/// A server bound to its port, ready to run.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    runtime: Runtime,
    interrupted: JoinHandle<io::Result<()>>,
    state: AppState,
}

impl Server {
    /// Binds a port on the loopback interface.
    ///
    /// # Arguments
    /// * `folder` – the folder of the robot file, with the mesh files that it names
    /// * `port` – the port; default: [`DEFAULT_PORT`], or any free port if that is in use
    ///
    /// # Errors
    /// [`Error::Mesh`] for a missing mesh file, [`Error::Port`] if the requested port cannot be bound, [`Error::System`] if no port can.
    pub fn bind(robot: Robot, folder: Option<&Path>, port: Option<u16>) -> Result<Self, Error> {
        let folder = MeshFolder::of(folder, &robot)?;
        let bind = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        let listener = match port {
            Some(port) => bind(port).map_err(|source| Error::Port { port, source })?,
            None => bind(DEFAULT_PORT).or_else(|_| bind(0))?,
        };
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        let runtime = Builder::new_current_thread().enable_all().build()?;
        // Ctrl-C is handled from here on: users may press it as soon as they see the address.
        let interrupted = runtime.spawn(tokio::signal::ctrl_c());
        runtime.block_on(tokio::task::yield_now());
        let state = AppState::new(robot, folder, Deadlines::default());
        Ok(Self { listener, address, runtime, interrupted, state })
    }

    /// States the file that the robot was read from, which the page edits.
    #[must_use]
    pub fn with_robot_file(mut self, file: RobotFileOnDisk) -> Self {
        self.state.robot = self.state.robot.with_file(file);
        self
    }

    /// Adds a work cell.
    #[must_use]
    pub fn with_cell(mut self, files: CellFiles) -> Self {
        self.state.cell = Some(WorkcellSession::new(files));
        self
    }

    /// Adds a simulated controller of the work cell, whose robots the page shows.
    #[must_use]
    pub fn with_controller(mut self, monitor: ControllerMonitor) -> Self {
        self.state.controller = Some(monitor);
        self
    }

    /// Adds a mechanism, which the page opens.
    #[must_use]
    pub fn with_mechanism(mut self, file: MechanismFileOnDisk) -> Self {
        self.state.mechanism = Some(MechanismSession::new(file));
        self
    }

    /// The address of the page.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Serves until Ctrl-C.
    ///
    /// # Errors
    /// [`Error::System`] if the port or Ctrl-C cannot be handled.
    pub fn run(self) -> Result<(), Error> {
        let Self { listener, address, runtime, interrupted, state } = self;
        let work = state.work.clone();
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            let router = router::router(state, address.port());
            let connections = Arc::new(GracefulShutdown::new());
            let accepting =
                tokio::spawn(accept(listener, router, HEADER_TIME, Arc::clone(&connections)));
            interrupted.await.map_err(io::Error::other)??;
            work.stop();
            accepting.abort();
            let _ = accepting.await;
            if let Some(connections) = Arc::into_inner(connections) {
                // Connections that are still open then are closed.
                let _ = tokio::time::timeout(SHUTDOWN_TIME, connections.shutdown()).await;
            }
            Ok(())
        });
        runtime.shutdown_timeout(SHUTDOWN_TIME);
        served
    }
}

/// Accepts connections and serves each, without end.
///
/// # Arguments
/// * `header_time` – longest time until the headers of a request have arrived, see [`HEADER_TIME`]
async fn accept(
    listener: tokio::net::TcpListener,
    router: Router,
    header_time: Duration,
    connections: Arc<GracefulShutdown>,
) {
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(header_time);
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(ACCEPT_PAUSE).await;
            continue;
        };
        let service = TowerToHyperService::new(router.clone());
        let connection = http.serve_connection(TokioIo::new(stream), service);
        let connection = connections.watch(connection);
        tokio::spawn(async move {
            // What ends a connection concerns its client alone.
            let _ = connection.await;
        });
    }
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
    use tokio::net::{TcpListener, TcpStream};

    use super::*;

    /// Bytes that a client receives until the server closes the connection.
    async fn received(address: SocketAddr, sent: &[&[u8]]) -> String {
        let mut stream = TcpStream::connect(address).await.unwrap();
        for part in sent {
            stream.write_all(part).await.unwrap();
        }
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes).await;
        String::from_utf8(bytes).unwrap()
    }

    #[tokio::test]
    async fn connections_without_a_whole_request_are_closed() {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).await.unwrap();
        let address = listener.local_addr().unwrap();
        let router = Router::new().route("/", axum::routing::get(async || "whole"));
        let connections = Arc::new(GracefulShutdown::new());
        let serving = accept(listener, router, Duration::from_millis(200), connections);
        let serving = tokio::spawn(serving);
        // Without end before: each of them would wait for ever.
        for sent in [&[][..], &[&b"GET / HTTP/1.1\r\nHost: a"[..]], &[&b"G"[..], b"ET"]] {
            assert!(!received(address, sent).await.contains("whole"));
        }
        let whole = received(address, &[b"GET / HTTP/1.1\r\nHost: a\r\n\r\n"]).await;
        assert!(whole.ends_with("whole"), "{whole}");
        serving.abort();
    }
}
