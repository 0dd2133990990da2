//! The instructions with which columns are computed.

use pulp::Arch;

/// The instruction set that this processor computes with: `"AVX-512"`, `"AVX2"`, `"NEON"`, or `"baseline"` for that which all processors of its kind have.
///
/// Columns have the same bits with each of them.
#[must_use]
pub fn instruction_set() -> &'static str {
    match Arch::new() {
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
