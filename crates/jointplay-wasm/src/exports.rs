//! Functions that JavaScript calls.
#![allow(unreachable_pub, reason = "called from outside")]

use core::cell::UnsafeCell;

use crate::Robot;

/// The robot of this instance.
struct Instance(UnsafeCell<Robot>);

// SAFETY: the module has no threads: its memory is not shared.
unsafe impl Sync for Instance {}

static INSTANCE: Instance = Instance(UnsafeCell::new(Robot::NONE));

fn with<T>(call: impl FnOnce(&mut Robot) -> T) -> T {
    // SAFETY: exported functions do not call each other, so that there is one reference at a time.
    call(unsafe { &mut *INSTANCE.0.get() })
}

macro_rules! export {
    ($($(#[$doc:meta])* $name:ident($($argument:ident),*);)*) => {$(
        $(#[$doc])*
                #[unsafe(no_mangle)]
        pub extern "C" fn $name($($argument: u32),*) -> u32 {
            with(|robot| robot.$name($($argument),*)) as u32
        }
    )*};
}

export! {
    /// See [`Robot::set`].
    set();
    /// See [`Robot::inverse`].
    inverse();
    /// See [`Robot::broken_limits`].
    broken_limits();
    /// See [`Robot::clamp`].
    clamp();
    /// See [`Robot::forward`].
    forward(model, solver, by_center);
    /// See [`Robot::approximate`].
    approximate();
}

/// Address of the numbers.
#[unsafe(no_mangle)]
pub extern "C" fn numbers() -> *mut f64 {
    with(|robot| robot.numbers().as_mut_ptr())
}

/// Address of the message.
#[unsafe(no_mangle)]
pub extern "C" fn message() -> *const u8 {
    with(|robot| robot.message().as_ptr())
}

/// Bytes of the message.
#[unsafe(no_mangle)]
pub extern "C" fn message_length() -> usize {
    with(|robot| robot.message().len())
}

/// A bug: the caller gets a trap.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
