//! From a robot to a running server.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::Path;
use std::time::Duration;

use jointplay::format::robot::{self, Robot};
use tokio::runtime::{Builder, Runtime};
use tokio::task::JoinHandle;

use crate::cell_files::CellFiles;
use crate::meshes::MeshFolder;
use crate::router;
use crate::session::WorkcellSession;
use crate::state::AppState;
use crate::work::Deadlines;

/// The port that is taken where none is asked for, if it is free.
pub const DEFAULT_PORT: u16 = 4816;

/// How long requests may go on after Ctrl-C.
const LONGEST_GOODBYE: Duration = Duration::from_secs(3);

/// Why there is no server.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The port asked for is taken, or may not be used.
    #[error(
        "cannot serve on port {port} of 127.0.0.1: {source}; choose another --port, or leave it out for a free one"
    )]
    Port {
        /// The port asked for.
        port: u16,
        /// What the system says.
        source: io::Error,
    },
    /// A shape that the robot file names cannot be served.
    #[error(transparent)]
    Mesh(#[from] robot::Error),
    /// The system refuses to serve at all.
    #[error("cannot serve: {0}")]
    System(#[from] io::Error),
}

/// A server that has its port, and waits to be run.
pub struct Server {
    listener: TcpListener,
    address: SocketAddr,
    runtime: Runtime,
    interrupted: JoinHandle<io::Result<()>>,
    state: AppState,
}

impl Server {
    /// Takes a port of this machine, reachable from this machine only.
    ///
    /// # Arguments
    /// * `folder` – of the robot file, if there is one: shapes that it names are served from there
    /// * `port` – the port to take; without it [`DEFAULT_PORT`], or any free one where that is taken
    ///
    /// # Errors
    /// [`Error::Mesh`] for a shape that is not there, [`Error::Port`] if the port asked for cannot be had, [`Error::System`] if none can.
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
        // Listened to from here on: whoever is told the address may press Ctrl-C at once.
        let interrupted = runtime.spawn(tokio::signal::ctrl_c());
        runtime.block_on(tokio::task::yield_now());
        let state = AppState::new(robot, folder, Deadlines::default());
        Ok(Self { listener, address, runtime, interrupted, state })
    }

    /// Shows a cell beside the robot.
    #[must_use]
    pub fn with_cell(mut self, files: CellFiles) -> Self {
        self.state.cell = Some(WorkcellSession::new(files));
        self
    }

    /// Where a browser finds the page.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/", self.address)
    }

    /// Serves until Ctrl-C.
    ///
    /// # Errors
    /// [`Error::System`] if the port or Ctrl-C cannot be listened to.
    pub fn run(self) -> Result<(), Error> {
        let Self { listener, address, runtime, interrupted, state } = self;
        let work = state.work.clone();
        let served = runtime.block_on(async {
            let listener = tokio::net::TcpListener::from_std(listener)?;
            let router = router::router(state, address.port());
            let (goodbye, asked) = tokio::sync::oneshot::channel::<()>();
            let serve = axum::serve(listener, router).with_graceful_shutdown(async {
                let _ = asked.await;
            });
            let serving = tokio::spawn(serve.into_future());
            interrupted.await.map_err(io::Error::other)??;
            work.stop();
            let _ = goodbye.send(());
            // Whoever keeps a connection open beyond that is cut off.
            let _ = tokio::time::timeout(LONGEST_GOODBYE, serving).await;
            Ok(())
        });
        runtime.shutdown_timeout(LONGEST_GOODBYE);
        served
    }
}
