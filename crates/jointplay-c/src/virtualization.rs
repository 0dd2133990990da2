//! Virtualizations of the three-rod robot by their codes.

use jointplay::virtualization::{BuiltIn, Virtualization, built_in};

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

/// The virtualizations, each at the index that is its code.
pub(crate) const KNOWN: [BuiltIn; 4] =
    [BuiltIn::Radial, BuiltIn::Polar, BuiltIn::Offset, BuiltIn::Planar];

/// A virtualization by its code, with the index that it has.
#[inline]
pub(crate) fn known(code: i32) -> Result<(usize, BuiltIn), Failure> {
    let index = usize::try_from(code).unwrap_or(usize::MAX);
    KNOWN.get(index).map(|found| (index, *found)).ok_or_else(|| unknown(code))
}

#[cold]
fn unknown(virtualization: i32) -> Failure {
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
    known(virtualization).map_or(0, |(_, found)| found.model().joints().len())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_name_the_virtualizations() {
        for (code, name) in [
            (JP_RADIAL, "radial"),
            (JP_POLAR, "polar"),
            (JP_OFFSET, "offset"),
            (JP_PLANAR, "planar"),
        ] {
            assert_eq!(known(code).ok().map(|(_, found)| found.model().name()), Some(name));
        }
        for code in [-1, 4, i32::MIN, i32::MAX] {
            assert!(known(code).is_err() && jp_virtual_joint_count(code) == 0);
        }
    }
}
