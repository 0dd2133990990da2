//! Codes of results.

/// Done.
pub const JP_OK: i32 = 0;
/// Valid input without a solution: beyond limits, loops that do not close, no convergence.
pub const JP_NO_ANSWER: i32 = 1;
/// Bad input: a null pointer, a number that is not finite, an unknown name, an error in a text.
pub const JP_BAD_INPUT: i32 = 2;
/// An error of the library itself.
pub const JP_INTERNAL: i32 = 3;
