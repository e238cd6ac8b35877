//! Counts for each light how many light samples were drawn, and how many arrived at their receivers without occlusion.
//!
//! The counts are integers, so they do not depend on the order in which threads add to them.

use crate::error::Result;
use crate::image::{try_collect, try_with_capacity};
use crate::render::vicinity::PositionReservoir;
use std::sync::atomic::{AtomicU32, Ordering};

/// Value of `LightSample::surveyed` for a light sample that is not counted.
pub const UNCOUNTED: u32 = u32::MAX;

/// Once this number of samples is counted, samples of likely lights are no longer counted. If the render then still
/// has one selector for all lights, no samples are counted at all. [convention]
pub const ENOUGH: u64 = 1 << 17;

/// The counts of light samples, to which all threads of a render add.
pub struct Survey {
    /// For each light, the number of its samples, and the number of its samples that were not occluded.
    counts: Vec<[AtomicU32; 2]>,
    /// A random selection of the positions of receivers.
    pub positions: PositionReservoir,
}

/// The counts of a light or of a cluster of lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SampleCounts {
    /// Number of light samples.
    pub drawn: u64,
    /// Number of light samples that were not occluded.
    pub arrived: u64,
}

impl std::ops::AddAssign for SampleCounts {
    fn add_assign(&mut self, other: Self) {
        self.drawn += other.drawn;
        self.arrived += other.arrived;
    }
}

impl Survey {
    pub fn new(lights: usize) -> Result<Self> {
        let mut counts = try_with_capacity(lights)?;
        counts.resize_with(lights, Default::default);
        Ok(Self { counts, positions: PositionReservoir::new()? })
    }

    /// Counts a sample of the light with number `light`.
    #[inline]
    pub fn count_drawn(&self, light: usize) {
        self.counts[light][0].fetch_add(1, Ordering::Relaxed);
    }

    /// Counts that a sample of the light with number `light` was not occluded.
    #[inline]
    pub fn count_arrived(&self, light: u32) {
        if let Some(counts) = self.counts.get(light as usize) {
            counts[1].fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Returns the counts of all lights so far.
    pub fn sample_counts(&self) -> Result<Vec<SampleCounts>> {
        let count = |n: &AtomicU32| u64::from(n.load(Ordering::Relaxed));
        try_collect(
            self.counts.iter().map(|[drawn, arrived]| SampleCounts { drawn: count(drawn), arrived: count(arrived) }),
        )
    }
}

/// How far a render has come in learning which lights reach the surfaces in view.
#[derive(Clone, Copy, Default)]
pub struct Progress {
    /// Number of samples that had been counted at the last decision; 0 before the first decision.
    pub counted: u64,
    /// Number of counted samples at which the next decision is due.
    pub next: u64,
}

impl Progress {
    /// Whether the samples of all lights are still counted. If not, only the samples of lights that are unlikely to
    /// reach the surfaces in view are counted.
    #[inline]
    pub fn counts_likely(&self) -> bool {
        self.counted < ENOUGH
    }
}
