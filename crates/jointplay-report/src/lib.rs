//! Results as documents: one serializable report for each command, and tables as CSV and Parquet.
//!
//! Lengths are in mm and angles in degrees; the unit is part of each key.
//!
//! | to… | use |
//! | --- | --- |
//! | report a result as JSON | a function named like the command, such as [`mobility`](fn@mobility), and `serde` |
//! | write samples as a table | [`table`] |
//! | write the table of a study chunk by chunk, and resume it | [`study_table`] |
//! | compute a study in parts, and gather them | [`study_parts`] |

mod assembly;
mod ball_clearance;
mod beyond;
mod cell;
mod cell_page;
mod cell_text;
mod compare;
mod displacement;
mod distance;
mod entity;
mod expected;
mod forward;
mod free_motions;
mod instructions;
mod jacobian;
mod limits;
mod mechanism;
mod mobility;
mod motion;
mod nearest;
mod poses;
mod redundancy;
mod relief;
mod schedule;
mod segment;
mod sensitivity;
mod sha256;
mod station;
mod study;
mod study_files;
pub mod study_parts;
pub mod study_table;
mod suggest;
pub mod table;
mod table_error;
mod totals;
mod violation;
mod violation_group;
mod virtual_joints;

pub use assembly::{AssemblyReport, BranchSearchReport, assembly};
pub use ball_clearance::{BallClearanceReport, ball_clearance};
pub use beyond::beyond_limits;
pub use cell::{
    AxisReport, CellReport, InstructionReport, ShareReport, ViolationReport, cell, excerpt,
};
pub use cell_page::{CellPage, KeyFigure, PagePicture, PageProgram, key_figures};
pub use cell_text::{Fact, TableColumn, TextTable, cell_facts, cell_tables};
pub use compare::{CompareReport, LeverReport, ModelReport, WaferOverPlatform, compare};
pub use displacement::{
    BoundReport, ContributionReport, DisplacementReport, ShiftReport, UnknownReport,
    WaferDisplacementReport, displacement,
};
pub use distance::DistanceReport;
pub use entity::{EntityKind, EntityReport};
pub use expected::{DisagreementReport, disagreements};
pub use forward::{ForwardReport, PlatformReport, forward};
pub use free_motions::{FreeMotionReport, FreeMotionsReport};
pub use jacobian::{
    CommandedRates, FrameReport, JacobianError, JacobianReport, ParameterReport, TwistReport,
    jacobian,
};
pub use limits::{LimitReport, limits};
pub use mechanism::{
    ByName, ConfigurationReport, CoordinateDisplacementReport, LinkMotionReport,
    MechanismMobilityReport, NearMissReport, NearReport, SparseMobilityReport, UnitsReport,
    by_name, configuration, largest_displacement, mechanism_mobility, near_miss_note, search_note,
    sparse_mobility,
};
pub use mobility::{FreedomsReport, MobilityReport, mobility};
pub use motion::{FirstBeyondReport, MotionParameter, MotionReport, SingularReport, motion};
pub use nearest::NearestReport;
pub use poses::{PoseSeries, PosesReport};
pub use redundancy::{
    CarriedReport, RedundancyBasisReport, RedundantConstraintReport, redundant_constraints,
};
pub use relief::{ReliefReport, VirtualJointReport, relief};
pub use schedule::{
    BottleneckReport, CriticalTimeReport, PeriodicPartReport, ProcessWaitReport, RobotUseReport,
    ScheduleReport, StationUseReport, StayReport, WaferStaysReport, schedule_report,
};
pub use segment::{LimitingReport, SegmentReport};
pub use sensitivity::{BoundsReport, SensitivityReport, sensitivity};
pub use sha256::sha256;
pub use station::{
    NextPointsReport, PlaneReport, ReferenceReport, SlotUncertaintyReport, StationReport,
    StationUncertaintyReport, TeachReport, UncertaintyReport, teach,
};
pub use study::{BoundsHeldReport, SeriesReport, StudyReport, study};
pub use suggest::{
    SetReport, SingleCommandReport, SuggestReport, SuggestedJoint, SuggestedTable, WrittenSet,
    add_single_commands, suggestions,
};
pub use table_error::TableError;
pub use totals::{ColumnReport, OutcomeReport, SHARES, TotalsReport, totals};
pub use violation::explain_violation;
pub use violation_group::{
    BodyInZoneReport, OccurrenceReport, RemedyReport, ViolationGroupReport, remedy_reports,
    violation_groups,
};
pub use virtual_joints::VirtualJointGroups;
