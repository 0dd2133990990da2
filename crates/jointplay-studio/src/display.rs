//! Units of lengths in the messages of the response to a request.

use jointplay::format::display_units::DisplayUnits;

tokio::task_local! {
    /// The units of the request that this task or thread serves.
    static UNITS: DisplayUnits;
}

/// Units of the messages of the present request; metric without the header.
pub(crate) fn display_units() -> DisplayUnits {
    UNITS.try_with(|units| *units).unwrap_or_default()
}

/// Runs a part of a request on another thread, with the units of the request.
pub(crate) fn with_units<T>(units: DisplayUnits, compute: impl FnOnce() -> T) -> T {
    UNITS.sync_scope(units, compute)
}

/// Serves a request with these units.
pub(crate) async fn scope<T>(units: DisplayUnits, serving: impl Future<Output = T>) -> T {
    UNITS.scope(units, serving).await
}
