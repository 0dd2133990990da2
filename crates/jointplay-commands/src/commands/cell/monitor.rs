//! The robots of hosts in the studio, for builds that include it.

#[cfg(feature = "studio")]
pub(super) use with_studio::{HostPlace, Monitor, Page, StudioArgs};
#[cfg(not(feature = "studio"))]
pub(super) use without_studio::{HostPlace, Monitor, Page, StudioArgs};

#[cfg(feature = "studio")]
mod with_studio {
    use std::thread;

    use clap::Args;
    use jointplay::format::robot;
    use jointplay_studio::{CellFiles, Server};
    pub(in super::super) use jointplay_studio::{ControllerMonitor as Monitor, HostPlace};

    use super::super::input::CellArgs;
    use crate::arguments::whole;
    use crate::failure::Failure;

    /// Whether to show the robots in the studio.
    #[derive(Args)]
    pub(in super::super) struct StudioArgs {
        /// Show the robots of all hosts on a page of this machine, as `jointplay studio` shows cells
        #[arg(long)]
        studio: bool,
        /// Port of 127.0.0.1 for this page [default: 4816, or a free port if it is taken]
        #[arg(long, value_name = "N", requires = "studio", value_parser = |text: &str| whole::<u16>(text, 0, 65_535))]
        studio_port: Option<u16>,
    }

    /// The page, ready to be served.
    pub(in super::super) struct Page {
        server: Server,
        monitor: Monitor,
    }

    impl StudioArgs {
        /// The page of a cell whose controller listens, if it is wanted.
        pub(in super::super) fn page(
            &self,
            cell: &CellArgs,
            monitor: impl FnOnce() -> Monitor,
        ) -> Result<Option<Page>, Failure> {
            if !self.studio {
                return Ok(None);
            }
            if cell.is_standard_input() {
                let text = "--studio shows a cell file: name it in place of standard input";
                return Err(Failure::Usage(text.to_owned()));
            }
            let files = match cell.path() {
                Some(path) => CellFiles::open(path).map_err(Failure::Robot)?,
                None => CellFiles::example(),
            };
            let monitor = monitor();
            let server = Server::bind(robot::paper(), None, self.studio_port)?
                .with_cell(files)
                .with_controller(monitor.clone());
            Ok(Some(Page { server, monitor }))
        }
    }

    impl Page {
        pub(in super::super) fn url(&self) -> String {
            self.server.url()
        }

        pub(in super::super) fn monitor(&self) -> Monitor {
            self.monitor.clone()
        }

        /// Serves the page, and hosts on another thread, until Ctrl-C.
        ///
        /// # Arguments
        /// * `hosts` – serves them
        pub(in super::super) fn run(
            self,
            hosts: impl FnOnce() -> Result<(), Failure> + Send + 'static,
        ) -> Result<(), Failure> {
            thread::spawn(move || drop(hosts()));
            Ok(self.server.run()?)
        }
    }
}

#[cfg(not(feature = "studio"))]
mod without_studio {
    use std::time::Instant;

    use clap::Args;
    use jointplay::interop::host::HostSnapshot;

    use super::super::input::CellArgs;
    use crate::failure::Failure;

    /// No options.
    #[derive(Args)]
    pub(in super::super) struct StudioArgs {}

    /// Never a page.
    pub(in super::super) enum Page {}

    /// Never a monitor.
    pub(in super::super) enum Monitor {}

    /// Never a place.
    pub(in super::super) enum HostPlace {}

    impl StudioArgs {
        pub(in super::super) fn page(
            &self,
            _: &CellArgs,
            _: impl FnOnce() -> Monitor,
        ) -> Result<Option<Page>, Failure> {
            Ok(None)
        }
    }

    impl Monitor {
        pub(in super::super) fn new(_: String, _: String, _: f64) -> Self {
            unreachable!("no page asks for it")
        }

        pub(in super::super) fn connect(
            &self,
            _: String,
            _: Instant,
            _: HostSnapshot,
        ) -> HostPlace {
            match *self {}
        }
    }

    impl HostPlace {
        pub(in super::super) fn update(&self, _: HostSnapshot) {
            match *self {}
        }
    }

    impl Page {
        pub(in super::super) fn url(&self) -> String {
            match *self {}
        }

        pub(in super::super) fn monitor(&self) -> Monitor {
            match *self {}
        }

        pub(in super::super) fn run(
            self,
            _: impl FnOnce() -> Result<(), Failure>,
        ) -> Result<(), Failure> {
            match self {}
        }
    }
}
