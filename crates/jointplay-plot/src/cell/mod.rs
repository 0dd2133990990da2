//! Pictures of cells and of what happens in them: from above, and over time.

mod gantt;
mod outline;
mod station_label;
mod teach;
mod top;

pub use gantt::{Gantt, Span, SpanKind};
pub use teach::Taught;
pub use top::{TopView, Track};

use crate::Colour;

/// Colours of effectors, in their order.
const EFFECTORS: [Colour; 4] = [Colour::BLUE, Colour::VERMILLION, Colour::GREEN, Colour::PURPLE];

/// The colour of an effector.
fn effector_colour(index: usize) -> Colour {
    EFFECTORS[index % EFFECTORS.len()]
}
