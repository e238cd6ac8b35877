//! The host's floating-point mode: rounding, flush-to-zero, traps. Hosts change it for their own ends (audio and game
//! engines flush denormals to zero), and it would change our results; so every call works in the mode that Rust's
//! arithmetic is defined in, and hands the host's back. Threads inherit the mode of the thread that starts them, so ours
//! have the same.

/// Holds the host's mode while a call is under way.
pub(super) struct FloatMode {
    host: Mode,
}

impl FloatMode {
    #[inline]
    pub fn enter() -> Self {
        let host = read();
        // Writing is slow, and hardly ever needed.
        if host & !STATUS != DEFAULT {
            write(DEFAULT);
        }
        Self { host }
    }
}

impl Drop for FloatMode {
    #[inline]
    fn drop(&mut self) {
        if read() & !STATUS != self.host & !STATUS {
            write(self.host);
        }
    }
}

#[cfg(all(target_arch = "x86_64", not(miri)))]
mod register {
    use std::arch::asm;

    pub type Mode = u32;
    /// Rounding to nearest, denormals as they are, no traps.
    pub const DEFAULT: Mode = 0x1f80;
    /// What arithmetic leaves behind: flags of exceptions.
    pub const STATUS: Mode = 0x3f;

    #[inline]
    pub fn read() -> Mode {
        let mut mode = 0u32;
        // SAFETY: stores the control register into a word of ours.
        unsafe { asm!("stmxcsr [{}]", in(reg) &mut mode, options(nostack, preserves_flags)) };
        mode
    }

    #[inline]
    pub fn write(mode: Mode) {
        // SAFETY: the mode is the one that Rust assumes, or the one that was found and is handed back.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &mode, options(nostack, preserves_flags)) };
    }
}

#[cfg(all(target_arch = "aarch64", not(miri)))]
mod register {
    use std::arch::asm;

    pub type Mode = u64;
    pub const DEFAULT: Mode = 0;
    pub const STATUS: Mode = 0;

    #[inline]
    pub fn read() -> Mode {
        let mode: u64;
        // SAFETY: reads the control register.
        unsafe { asm!("mrs {}, fpcr", out(reg) mode, options(nomem, nostack, preserves_flags)) };
        mode
    }

    #[inline]
    pub fn write(mode: Mode) {
        // SAFETY: the mode is the one that Rust assumes, or the one that was found and is handed back.
        unsafe { asm!("msr fpcr, {}", in(reg) mode, options(nomem, nostack, preserves_flags)) };
    }
}

/// Elsewhere the mode is the host's to keep; Miri knows no registers.
#[cfg(any(miri, not(any(target_arch = "x86_64", target_arch = "aarch64"))))]
mod register {
    pub type Mode = u32;
    pub const DEFAULT: Mode = 0;
    pub const STATUS: Mode = 0;

    pub fn read() -> Mode {
        DEFAULT
    }

    pub fn write(_: Mode) {}
}

use register::{DEFAULT, Mode, STATUS, read, write};
