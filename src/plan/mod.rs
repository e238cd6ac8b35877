//! Planning: chooses settings of the lighting stages and of a stylisation for a target error or time, before they run.
//!
//! The caller specifies the error (noise) that the picture may have, or the time that it may take ([`Goal`]). The plan
//! returns the settings of relighting and rendering, with the expected time and error of each.
//!
//! The cost of a path and the variance of paths depend on the machine and the scene. No formula predicts them, so they
//! are measured: a few tiles of the image are rendered ([`picture`], `render::pilot`), and a few paths of the solution
//! for the emission's strength are traced ([`strength`]). Along the resulting curves of error against time, the time is
//! allocated in small steps, each to the stage where it lowers the error of the picture most ([`curve`]). A stylisation
//! is tried with settings from quick to careful at reduced resolution (`stylisation`).
//!
//! Errors refer to the picture: root mean square over its pixels, relative to its mean, as in
//! [`crate::render::Film::error`]. An error of the emission's strength scales the emission's light in the picture by a
//! common factor. Its contribution is the relative standard error of the strength times the picture's contrast (root
//! mean square divided by mean). The error of a stylisation is the square root of its energy (StyLit, Eq. 3).
//!
//! Assumption: the machine later performs as it does now, with the same number of threads, and is otherwise idle while
//! the plan is made.
//!
//! Not modelled:
//!
//! - the stages before the lighting: they have no settings that trade error for time, and report their own errors;
//! - bright paths so rare that the tiles of the plan contain few or none of them, such as the paths to a small lamp
//!   seen in a polished surface: the picture's error may then be half or twice the expected error;
//! - the overshoot of a picture that stops at a target error: up to one pass;
//! - the layers that are rendered beside the main image ([`crate::render::Outputs`]), which take time of their own.

mod curve;
mod picture;
mod strength;
#[cfg(feature = "stylize")]
mod stylisation;
mod transfer;

pub use picture::{Rendering, rendering};
#[cfg(feature = "stylize")]
pub use stylisation::{Stylisation, stylisation};
pub use transfer::{Lighting, check, lighting};

use crate::error::{Result, check_range};
use std::time::{Duration, Instant};

/// The goal of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Error of the picture: root mean square over its pixels, relative to its mean, in `[1e-5, 1]`; or, for a
    /// stylisation, the square root of its energy (StyLit, Eq. 3).
    Error(f64),
    /// Total seconds of the planned stages, in `[1e-3, 1e6]`.
    Seconds(f64),
}

impl Goal {
    pub fn check(self) -> Result<()> {
        match self {
            // Compare in single precision: hosts pass 1e-5 as `f32`, which is slightly smaller than 1e-5 as `f64`.
            Self::Error(error) => check_range("target_error", error as f32, 1e-5, 1.0).map(drop),
            Self::Seconds(seconds) => check_range("seconds", seconds, 1e-3, 1e6).map(drop),
        }
    }
}

/// Expected time and error of a stage or of all stages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    pub seconds: f64,
    pub error: f64,
}

/// A clock: returns the time since an arbitrary origin.
pub type Clock<'a> = &'a (dyn Fn() -> Duration + Sync);

/// Returns a wall clock that reads 0 now.
pub fn wall() -> impl Fn() -> Duration + Sync {
    let start = Instant::now();
    move || start.elapsed()
}

/// Runs `work`. Returns how many seconds `work` took, measured with `clock`, and its result.
fn timed<T>(clock: Clock, work: impl FnOnce() -> T) -> (f64, T) {
    let start = clock();
    let value = work();
    (clock().saturating_sub(start).as_secs_f64(), value)
}

/// If a stage stops at a target error, the number of its paths is limited to this multiple of the expected number. The
/// error is proportional to 1 / √n after n paths. If the prediction of the error is within a factor of √2 of the truth,
/// at most twice the expected number of paths is needed, so any limit of at least 2 gives the same result.
/// `make bench ONLY=plan` prints the accuracy of the predictions. [convention]
const MAX_COST: f64 = 4.0;
/// A stage with a time budget may take at most this many times the expected time. The bench prints the share of stages
/// whose time is within a quarter of the prediction. [bench plan]
const MAX_OVERTIME: f64 = 1.25;

/// Returns the time budget in milliseconds that stops a stage if it takes much longer than expected.
fn overtime(expected: Expected) -> u32 {
    (1e3 * MAX_OVERTIME * expected.seconds).ceil().clamp(1.0, f64::from(u32::MAX)) as u32
}
