//! Messages to the simulator.

use std::ffi::{CStr, CString, c_char, c_int, c_void};

/// All as expected.
pub(super) const OK: c_int = 0;
/// A step without a solution; the instance is as before.
pub(super) const DISCARD: c_int = 2;
/// An invalid call or value; the instance is as before.
pub(super) const ERROR: c_int = 3;
/// An error of the library itself; the instance cannot be used any more.
pub(super) const FATAL: c_int = 4;

/// The logger of FMI 2.0: environment, instance name, status, category, message as a format of `printf`.
pub type Logger2 = Option<
    unsafe extern "C" fn(*mut c_void, *const c_char, c_int, *const c_char, *const c_char, ...),
>;

/// The logger of FMI 3.0: environment, status, category, message.
pub type Logger3 = Option<unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char)>;

/// The simulator's function for messages.
pub(super) enum Log {
    V2 { logger: Logger2, environment: *mut c_void, name: CString },
    V3 { logger: Logger3, environment: *mut c_void },
}

impl Log {
    /// Passes a message on.
    pub(super) fn write(&self, status: c_int, text: &str) {
        let category: &CStr = match status {
            DISCARD => c"logStatusDiscard",
            FATAL => c"logStatusFatal",
            _ => c"logStatusError",
        };
        match self {
            Self::V2 { logger: Some(logger), environment, name } => {
                let text = text_of(&text.replace('%', "%%"));
                // SAFETY: the environment promises a logger of this type; the texts are ended by NUL.
                unsafe {
                    logger(*environment, name.as_ptr(), status, category.as_ptr(), text.as_ptr());
                }
            }
            Self::V3 { logger: Some(logger), environment } => {
                let text = text_of(text);
                // SAFETY: as above.
                unsafe { logger(*environment, status, category.as_ptr(), text.as_ptr()) };
            }
            Self::V2 { logger: None, .. } | Self::V3 { logger: None, .. } => {}
        }
    }
}

/// A NUL would end the text early.
fn text_of(text: &str) -> CString {
    CString::new(text.replace('\0', "\u{fffd}")).unwrap_or_default()
}
