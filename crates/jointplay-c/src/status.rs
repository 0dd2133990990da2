//! Codes of results, and the text of the last error.

use std::ffi::c_char;

use crate::catch::last_error;

/// Done.
pub const JP_OK: i32 = 0;
/// Valid input, but no answer: beyond limits, loops that do not close, no convergence.
pub const JP_NO_ANSWER: i32 = 1;
/// Bad input: a null pointer, a number that is not finite, an unknown name, an error in a text.
pub const JP_BAD_INPUT: i32 = 2;
/// An error of the library itself.
pub const JP_INTERNAL: i32 = 3;

/// Copies the text of this thread's last error, UTF-8 and ended by NUL; empty before the first error.
///
/// A text that does not fit is cut between characters. Calls that succeed leave it as it is.
/// Returns the bytes of the whole text with its NUL; with `size` 0, `text` may be NULL.
///
/// # Safety
/// `text` points to `size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_last_error(text: *mut c_char, size: usize) -> usize {
    last_error(|message| {
        if !text.is_null() && size > 0 {
            let mut end = message.len().min(size - 1);
            while !message.is_char_boundary(end) {
                end -= 1;
            }
            // SAFETY: the caller promises `size` bytes, and `end` is less; the two do not overlap, since the message is ours.
            unsafe { std::ptr::copy_nonoverlapping(message.as_ptr(), text.cast::<u8>(), end) };
            // SAFETY: `end` is less than `size`.
            let last = unsafe { text.add(end) };
            // SAFETY: as above.
            unsafe { last.write(0) };
        }
        message.len() + 1
    })
}
