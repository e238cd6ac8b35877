//! Keeps the host's floating-point mode (rounding, flush-to-zero, traps) away from the library. Some hosts change it:
//! audio and game engines flush denormals to zero, which would change the library's results. So every call sets the
//! mode for which Rust defines its arithmetic, and restores the mode of the host on return. A thread inherits the mode
//! of the thread that starts it, so the worker threads have the standard mode too.

/// Stores the floating-point mode of the host during a call, and restores it when dropped.
pub(super) struct FloatMode {
    host: Mode,
}

impl FloatMode {
    #[inline]
    pub fn enter() -> Self {
        let host = read();
        // Write only if needed: writing is slow.
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
    /// Round to nearest, keep denormals, no traps.
    pub const DEFAULT: Mode = 0x1f80;
    /// The status bits: exception flags that arithmetic sets.
    pub const STATUS: Mode = 0x3f;

    #[inline]
    pub fn read() -> Mode {
        let mut mode = 0u32;
        // SAFETY: the instruction only stores the control register into the local variable `mode`.
        unsafe { asm!("stmxcsr [{}]", in(reg) &mut mode, options(nostack, preserves_flags)) };
        mode
    }

    #[inline]
    pub fn write(mode: Mode) {
        // SAFETY: `mode` is the default that Rust assumes, or the mode of the host that `read` returned.
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
        // SAFETY: the instruction only reads the control register.
        unsafe { asm!("mrs {}, fpcr", out(reg) mode, options(nomem, nostack, preserves_flags)) };
        mode
    }

    #[inline]
    pub fn write(mode: Mode) {
        // SAFETY: `mode` is the default that Rust assumes, or the mode of the host that `read` returned.
        unsafe { asm!("msr fpcr, {}", in(reg) mode, options(nomem, nostack, preserves_flags)) };
    }
}

/// On other processors, and under Miri, which does not support the registers, the mode stays as it is.
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
