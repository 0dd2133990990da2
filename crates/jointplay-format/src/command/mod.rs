//! Commands to joints and links as text, on the command line and in Python: expressions of the parameters of a mechanism file, with units.
//!
//! | file | contents |
//! | --- | --- |
//! | `heading` | the coordinate of a column of a table |
//! | `pose` | commands to the pose of a link or frame |
//! | `value` | a value with an optional unit |
//! | `names` | values of the names in expressions: parameters of the file, and the variable of a curve |
//! | `problem` | errors |

mod heading;
mod names;
mod pose;
mod problem;
mod value;

pub use heading::Heading;
pub use names::Names;
pub use pose::{PoseCommand, PosePoint, frame_paths};
pub use problem::Error;
pub use value::CommandValue;
