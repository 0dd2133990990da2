//! Figures: all tests in one program, which takes a fraction of the time to build.

mod cell;
mod figures;
mod gallery;
mod mechanism;
