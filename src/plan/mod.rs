//! Planning: settings of the stages that make light, and of a stylisation, for an error or a time, before they run.
//!
//! A caller says how much noise the picture may have, or how long it may take ([`Goal`]); the plan says with which settings
//! relighting and rendering come to it, how long each is expected to take, and what error it is expected to leave.
//!
//! What a path costs and how much paths scatter depends on the machine and on the scene, and nothing that could be counted
//! before tells it. So it is measured: a few tiles of the very image are rendered ([`picture`], `render::pilot`), and a few
//! paths of the very solution are traced ([`strength`]). Along the curves of error against time that follow, the time is
//! given out in small steps, each to the stage where it lowers the error of the picture most ([`curve`]). A stylisation is tried
//! with settings from quick to careful, at a part of its resolution (`stylisation`).
//!
//! Errors are those of the picture: root mean square over its pixels, relative to its mean, as [`crate::render::Film::error`]
//! states it. The solution of the emission makes all light of the picture too bright or too dark by a common factor; what
//! that adds is its own relative standard error times the picture's contrast, its root mean square over its mean. That of a
//! stylisation is the root of its energy.
//!
//! Assumed: the machine does then what it does now, with as many threads; while a plan is made nothing else keeps them busy.
//!
//! Not modelled: the stages before the light, which no setting trades error for time in, and whose errors they state
//! themselves; bright paths so rare that a plan meets one by chance or none, such as of a small lamp in polish: the picture's
//! error may then be twice or half of what is expected; that a picture that stops at an error may fall below it by as much as its last
//! pass brings; layers beside the picture, which take time of their own.

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

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Error of the picture: root mean square over its pixels, relative to its mean, in `[1e-5, 1]`; or root of the energy of a
    /// stylisation.
    Error(f64),
    /// Seconds for all that is planned, in `[1e-3, 1e6]`.
    Seconds(f64),
}

impl Goal {
    pub fn check(self) -> Result<()> {
        match self {
            // In single precision, as hosts give it: their 1e-5 is a little less.
            Self::Error(error) => check_range("target_error", error as f32, 1e-5, 1.0).map(drop),
            Self::Seconds(seconds) => check_range("seconds", seconds, 1e-3, 1e6).map(drop),
        }
    }
}

/// What a stage, or all of them, should take and leave.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Expected {
    pub seconds: f64,
    pub error: f64,
}

/// Tells the time from any start.
pub type Clock<'a> = &'a (dyn Fn() -> Duration + Sync);

/// The time on the wall.
pub fn wall() -> impl Fn() -> Duration + Sync {
    let start = Instant::now();
    move || start.elapsed()
}

/// Seconds that `work` takes by a clock, and what it gives.
fn timed<T>(clock: Clock, work: impl FnOnce() -> T) -> (f64, T) {
    let start = clock();
    let value = work();
    (clock().saturating_sub(start).as_secs_f64(), value)
}

/// What a stage that stops at a target may take at most, in times of what is expected.
const PATIENCE: f64 = 4.0;
/// What a stage may take of the time it is expected to, before it stops.
const OVERTIME: f64 = 1.25;

/// Milliseconds after which a stage stops that takes longer than expected.
fn overtime(expected: Expected) -> u32 {
    (1e3 * OVERTIME * expected.seconds).ceil().clamp(1.0, f64::from(u32::MAX)) as u32
}
