//! Pictures of cells: top view, timing diagram, taught stations.

mod gantt;
mod gantt_interval;
mod gantt_places;
mod outline;
mod posture;
mod station_label;
mod teach;
mod top;

pub use gantt::Gantt;
pub use gantt_interval::{Interval, IntervalKind};
pub use posture::ArmPosture;
pub use teach::Taught;
pub use top::{EffectorPath, TopView};

use crate::Colour;

/// Colours of effectors, by index.
const EFFECTORS: [Colour; 4] = [Colour::BLUE, Colour::VERMILLION, Colour::GREEN, Colour::PURPLE];

/// The colour of an effector.
fn effector_colour(index: usize) -> Colour {
    EFFECTORS[index % EFFECTORS.len()]
}
