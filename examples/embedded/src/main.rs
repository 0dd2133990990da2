//! Kinematics of a three-rod robot on a microcontroller: prints poses to the debugger, or to QEMU.
//!
//! There is no standard library, no operating system and no heap.
#![no_std]
#![no_main]

mod poses;

#[cfg(target_os = "none")]
mod board {
    use cortex_m_semihosting::{debug, hio};

    #[cortex_m_rt::entry]
    fn main() -> ! {
        let done = hio::hstdout()
            .is_ok_and(|mut output| super::poses::write_poses(&mut output).is_ok());
        debug::exit(if done { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
        loop {}
    }
}

#[cfg(not(target_os = "none"))]
const _: fn(&mut Nothing) -> core::fmt::Result = poses::write_poses;

/// Where there is no board, the program is only checked.
#[cfg(not(target_os = "none"))]
struct Nothing;

#[cfg(not(target_os = "none"))]
impl core::fmt::Write for Nothing {
    fn write_str(&mut self, _: &str) -> core::fmt::Result {
        Ok(())
    }
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo) -> ! {
    #[cfg(target_os = "none")]
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    loop {}
}
