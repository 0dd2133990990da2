//! Texts for callers: the version, the last error, answers.

use std::ffi::{CString, c_char};

use crate::catch::{last_error, value};

/// Version of the library, such as `0.1.0`. The text is never freed.
#[unsafe(no_mangle)]
pub extern "C" fn jp_version() -> *const c_char {
    const { concat!(env!("CARGO_PKG_VERSION"), "\0") }.as_ptr().cast()
}

/// Copies the text of the last error of the calling thread, UTF-8 and ended by NUL; empty before the first error.
///
/// A text that does not fit is cut between characters. Calls that succeed leave it unchanged.
/// Returns the bytes of the whole text with its NUL; with `size` 0, `text` may be NULL.
///
/// # Safety
/// `text` is NULL or has room for `size` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_last_error(text: *mut c_char, size: usize) -> usize {
    value(0, || {
        last_error(|message| {
            if !text.is_null() && size > 0 {
                let mut end = message.len().min(size - 1);
                while !message.is_char_boundary(end) {
                    end -= 1;
                }
                // SAFETY: the caller promises `size` bytes, and `end` is less; the message is ours and does not overlap.
                unsafe { std::ptr::copy_nonoverlapping(message.as_ptr(), text.cast::<u8>(), end) };
                // SAFETY: `end` is less than `size`.
                let last = unsafe { text.add(end) };
                // SAFETY: as above.
                unsafe { last.write(0) };
            }
            message.len() + 1
        })
    })
}

/// Frees an answer of `jp_robot_json` or `jp_mechanism_json`; NULL does nothing.
///
/// # Safety
/// `text` is NULL, or an answer of this library that is not used after this call.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn jp_text_free(text: *mut c_char) {
    if !text.is_null() {
        // SAFETY: the caller's promise.
        drop(unsafe { CString::from_raw(text) });
    }
}
