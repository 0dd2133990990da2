//! Virtualizations of the three-rod robot by their codes.

use jointplay::virtualization::{Virtualization, built_in};

use crate::catch::Failure;

/// Radial virtual joints, three.
pub const JP_RADIAL: i32 = 0;
/// Polar virtual joints, six.
pub const JP_POLAR: i32 = 1;
/// Offset virtual joints, six.
pub const JP_OFFSET: i32 = 2;
/// Planar virtual joints, six.
pub const JP_PLANAR: i32 = 3;
/// Largest number of virtual joints of a virtualization.
pub const JP_MAX_VIRTUAL_JOINTS: usize = 6;

/// Evaluates an expression with the chosen virtualization as its type, so that loops are compiled for each.
macro_rules! with_virtualization {
    ($chosen:expr, $name:ident => $body:expr) => {
        match $chosen {
            $crate::virtualization::JP_RADIAL => {
                let $name = &jointplay::virtualization::Radial;
                $body
            }
            $crate::virtualization::JP_POLAR => {
                let $name = &jointplay::virtualization::Polar;
                $body
            }
            $crate::virtualization::JP_OFFSET => {
                let $name = &jointplay::virtualization::Offset;
                $body
            }
            $crate::virtualization::JP_PLANAR => {
                let $name = &jointplay::virtualization::Planar;
                $body
            }
            other => Err($crate::virtualization::unknown(other)),
        }
    };
}
pub(crate) use with_virtualization;

#[cold]
pub(crate) fn unknown(virtualization: i32) -> Failure {
    Failure::input(format!(
        "virtualization {virtualization} is not known; known: {JP_RADIAL} radial, {JP_POLAR} polar, {JP_OFFSET} offset, {JP_PLANAR} planar"
    ))
}

/// A virtualization of the library by its name; planar without one.
pub(crate) fn named(name: Option<&str>) -> Result<&'static dyn Virtualization, Failure> {
    let Some(name) = name else { return Ok(&jointplay::virtualization::Planar) };
    let found = built_in().iter().copied().find(|model| model.name() == name);
    found.ok_or_else(|| {
        let known: Vec<&str> = built_in().iter().map(|model| model.name()).collect();
        Failure::input(format!("virtualization {name:?} is not known; known: {}", known.join(", ")))
    })
}

/// Number of virtual joints of a virtualization; 0 for an unknown one.
#[unsafe(no_mangle)]
pub extern "C" fn jp_virtual_joint_count(virtualization: i32) -> usize {
    let count: Result<usize, Failure> =
        with_virtualization!(virtualization, chosen => Ok(chosen.joints().len()));
    count.unwrap_or(0)
}
