//! The instructions with which columns are computed.

use pulp::Arch;

/// The instruction set that this processor computes with: `"AVX-512"`, `"AVX2"`, `"NEON"`, or `"baseline"` for that which all processors of its kind have.
///
/// Columns have the same bits with each of them.
#[must_use]
pub fn instruction_set() -> &'static str {
    name(Arch::new())
}

fn name(arch: Arch) -> &'static str {
    match arch {
        Arch::Scalar => "baseline",
        #[cfg(target_arch = "x86_64")]
        Arch::V3(_) => "AVX2",
        #[cfg(target_arch = "x86_64")]
        Arch::V4(_) => "AVX-512",
        #[cfg(target_arch = "aarch64")]
        Arch::Neon(_) => "NEON",
        _ => "another",
    }
}

/// All instruction sets of this processor that are compared with its baseline, with their names.
#[cfg(test)]
pub(super) fn instruction_sets() -> Vec<(&'static str, Arch)> {
    let mut found = vec![Arch::new()];
    #[cfg(target_arch = "x86_64")]
    found.extend(pulp::x86::V3::try_new().map(Arch::V3));
    found.into_iter().map(|arch| (name(arch), arch)).collect()
}
