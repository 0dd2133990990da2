//! The schedule of a trajectory: when which wafer is where, what the robot waits for, what limits the throughput, and which rules are violated.
//!
//! | file | contents |
//! | --- | --- |
//! | `stays` | stays of wafers in slots and on effectors, with their times |
//! | `critical_path` | the chain of motions and processes that determines a duration |
//! | `periodic` | parts in which hand-offs repeat, and their throughput |
//! | `utilization` | use of robot and stations |
//! | `summary` | all of these for a trajectory |
//! | `rule_violations` | violations of the rules for stays and visits |

mod critical_path;
mod periodic;
mod rule_violations;
mod stays;
mod summary;
mod utilization;

pub use critical_path::{CriticalPath, Resource};
pub use periodic::PeriodicPart;
pub(crate) use rule_violations::rule_violations;
pub use stays::{TimedStay, timed_stays};
pub use summary::{Schedule, schedule};
pub use utilization::{RobotUtilization, StationUtilization};
