//! Start and shutdown of the server.

use std::io;
use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::Path;
use std::time::Duration;

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
            let (shutdown, requested) = tokio::sync::oneshot::channel::<()>();
            let serve = axum::serve(listener, router).with_graceful_shutdown(async {
                let _ = requested.await;
            });
            let serving = tokio::spawn(serve.into_future());
            interrupted.await.map_err(io::Error::other)??;
            work.stop();
            let _ = shutdown.send(());
            // Connections that are still open are closed.
            let _ = tokio::time::timeout(SHUTDOWN_TIME, serving).await;
            Ok(())
        });
        runtime.shutdown_timeout(SHUTDOWN_TIME);
        served
    }
}
