//! Files of all kinds, and what they describe: all tests in one program, which takes a fraction of the time to build.

#![allow(clippy::unwrap_used, reason = "a failed unwrap fails the test")]

mod arm_postures;
mod arms;
mod catalogue_robots;
mod cell;
mod cell_parts;
mod cell_shapes;
mod cell_study;
mod displacement;
mod entries;
mod example_program;
mod example_study;
mod generated_stations;
mod incremental_planning;
mod jog;
mod line_times;
mod mechanism_study;
mod message_words;
mod messages;
mod nearest_points;
mod pose_commands;
mod program;
mod program_in_cell;
mod program_language;
mod slide_arms;
mod small_cell;
mod study;
mod suggestions;
mod taught_stations;
mod validated_cells;
