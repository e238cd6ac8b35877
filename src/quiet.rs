//! Defects (Rust's panics) become statuses, and their messages never reach the stderr of the host.
//!
//! Rust writes the message of a panic before anything can catch it, unless a hook of its runtime does otherwise. The
//! hook here is silent on threads that are inside the library: in a call of the host, or started by one. Elsewhere it
//! hands the message on to the hook that it found. The shared library and the static archive contain a Rust runtime of
//! their own, so their hook never sees a panic of the host; a host in Rust that links the crate shares it.

use std::cell::Cell;
use std::panic;
use std::sync::Once;
use std::thread;

// Without a destructor, so that nothing of it outlives the library when a host unloads it.
thread_local! {
    static IS_QUIET: Cell<bool> = const { Cell::new(false) };
}

/// Messages of panics are suppressed on this thread while this lives.
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

/// Whether messages of panics are suppressed on this thread.
pub fn is_on() -> bool {
    IS_QUIET.get()
}

/// Calls a function of the host, whose panics are its own affair.
pub fn outside<T>(call: impl FnOnce() -> T) -> T {
    let _restored = Quiet { before: IS_QUIET.replace(false) };
    call()
}

/// Installs the hook, once in a process. A thread that is panicking must not; the next call does it then.
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
