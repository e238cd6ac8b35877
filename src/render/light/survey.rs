//! Counts how many light samples of each light arrived at their receivers.
//!
//! The counts are sums of integers, which do not depend on the order of the threads.

use crate::error::Result;
use crate::image::{try_collect, try_with_capacity};
use std::sync::atomic::{AtomicU32, Ordering};

/// Marks a light sample that is not counted.
pub const UNCOUNTED: u32 = u32::MAX;

/// After this number of samples, the samples of likely lights are no longer counted. [convention]
pub const ENOUGH: u64 = 1 << 17;

/// The samples of each light, counted by all threads of a render.
pub struct Survey {
    /// For each light the number of its samples, and the number of those that were not occluded.
    counts: Vec<[AtomicU32; 2]>,
}

/// The counts of a light or of a cluster of lights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Evidence {
    pub drawn: u64,
    pub arrived: u64,
}

impl std::ops::AddAssign for Evidence {
    fn add_assign(&mut self, other: Self) {
        self.drawn += other.drawn;
        self.arrived += other.arrived;
    }
}

impl Survey {
    pub fn new(lights: usize) -> Result<Self> {
        let mut counts = try_with_capacity(lights)?;
        counts.resize_with(lights, Default::default);
        Ok(Self { counts })
    }

    /// Counts a sample of a light.
    #[inline]
    pub fn count_drawn(&self, light: usize) {
        self.counts[light][0].fetch_add(1, Ordering::Relaxed);
    }

    /// Counts a sample of a light that was not occluded.
    #[inline]
    pub fn count_arrived(&self, light: u32) {
        if let Some(counts) = self.counts.get(light as usize) {
            counts[1].fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The counts of all lights so far.
    pub fn evidence(&self) -> Result<Vec<Evidence>> {
        let count = |n: &AtomicU32| u64::from(n.load(Ordering::Relaxed));
        try_collect(
            self.counts.iter().map(|[drawn, arrived]| Evidence { drawn: count(drawn), arrived: count(arrived) }),
        )
    }
}

/// How far a render has learned.
#[derive(Clone, Copy, Default)]
pub struct Progress {
    /// Samples counted so far, and at the next decision.
    pub counted: u64,
    pub next: u64,
}

impl Progress {
    /// Whether samples of likely lights are still counted.
    #[inline]
    pub fn counts_likely(&self) -> bool {
        self.counted < ENOUGH
    }
}
