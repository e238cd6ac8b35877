//! Keeps the messages of panics (defects of this library) away from the host's stderr. The C boundary catches the
//! panics and returns a status instead.
//!
//! Rust writes the message of a panic before the panic can be caught, unless a panic hook prevents it. The hook of
//! this module is silent on threads that are inside the library: threads of the host during a call, and threads that
//! the library has started. On other threads it calls the previously installed hook. The shared library and the static
//! archive contain their own Rust runtime, so their hook never sees a panic of the host. A Rust host that links the
//! crate shares the hook with it.

use std::cell::Cell;
use std::panic;
use std::sync::Once;
use std::thread;

// `Cell<bool>` has no destructor. A thread-local variable with a destructor would keep the host from unloading the
// library.
thread_local! {
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Suppresses panic messages on this thread as long as this value lives.
pub struct Quiet {
    before: bool,
}

impl Quiet {
    pub fn enter() -> Self {
        install();
        Self { before: IS_QUIET.replace(true) }
    }
}

impl Drop for Quiet {
    fn drop(&mut self) {
        IS_QUIET.set(self.before);
    }
}

/// Whether panic messages are suppressed on this thread.
pub fn is_on() -> bool {
    IS_QUIET.get()
}

/// Calls a function of the host. During the call, panics on this thread print their messages as usual.
pub fn outside<T>(call: impl FnOnce() -> T) -> T {
    let _restored = Quiet { before: IS_QUIET.replace(false) };
    call()
}

/// Installs the hook once per process. A panicking thread cannot install a hook; in that case, the next call on
/// another thread installs it.
fn install() {
    static INSTALLED: Once = Once::new();
    if !INSTALLED.is_completed() && !thread::panicking() {
        INSTALLED.call_once(|| {
            let found = panic::take_hook();
            panic::set_hook(Box::new(move |info| {
                if !is_on() {
                    found(info);
                }
            }));
        });
    }
}
