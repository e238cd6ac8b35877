//! Selects the instruction set at run time, and compiles loops for each instruction set.
//!
//! [`Level::widest`] is the only place that asks the processor which level to use; all code with variants for several
//! levels calls it. Results are equal bit by bit at every level: no variant fuses a multiplication and an addition
//! where the rounding would differ, and loops keep the order of their sums.

/// Instruction sets, from narrow to wide; each includes all narrower sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The baseline of the architecture: SSE2 on x86-64, NEON on aarch64.
    Baseline,
    /// AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 F, BW, CD, DQ and VL.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// Returns the widest level that this processor supports.
    pub fn widest() -> Self {
        let level = Self::of_processor();
        #[cfg(test)]
        let level = level.min(forced::max_level());
        level
    }

    fn of_processor() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            let bits = has!("bmi1") && has!("bmi2") && has!("lzcnt") && has!("popcnt");
            if !(has!("avx2") && has!("fma") && bits) {
                return Self::Baseline;
            }
            let masks = has!("avx512bw") && has!("avx512cd") && has!("avx512dq") && has!("avx512vl");
            if has!("avx512f") && masks { Self::Avx512 } else { Self::Avx2 }
        }
        #[cfg(not(target_arch = "x86_64"))]
        Self::Baseline
    }
}

/// Defines a function that is compiled for every level and dispatched at run time. Every argument must have the form
/// `name: type`; generics are not supported.
macro_rules! widest {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $vis fn $name($($arg: $type),*) $(-> $out)? {
            #[inline(always)]
            #[allow(clippy::too_many_arguments)]
            fn portable($($arg: $type),*) $(-> $out)? $body

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx2")]
            #[allow(clippy::too_many_arguments)]
            fn avx2($($arg: $type),*) $(-> $out)? {
                portable($($arg),*)
            }

            #[cfg(target_arch = "x86_64")]
            #[target_feature(enable = "avx512f,avx512bw,avx512dq,avx512vl")]
            #[allow(clippy::too_many_arguments)]
            fn avx512($($arg: $type),*) $(-> $out)? {
                portable($($arg),*)
            }

            match $crate::simd::Level::widest() {
                // SAFETY: `Level::widest` returns only levels that the processor supports.
                #[cfg(target_arch = "x86_64")]
                $crate::simd::Level::Avx512 => unsafe { avx512($($arg),*) },
                // SAFETY: as above.
                #[cfg(target_arch = "x86_64")]
                $crate::simd::Level::Avx2 => unsafe { avx2($($arg),*) },
                $crate::simd::Level::Baseline => portable($($arg),*),
            }
        }
    };
}

pub(crate) use widest;

/// For tests: forces a narrower level than the processor's widest. The shipped library always uses the widest level.
#[cfg(test)]
pub mod forced {
    use super::Level;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicU8, Ordering};

    #[cfg(target_arch = "x86_64")]
    const ALL: [Level; 3] = [Level::Baseline, Level::Avx2, Level::Avx512];
    #[cfg(not(target_arch = "x86_64"))]
    const ALL: [Level; 1] = [Level::Baseline];

    static MAX_LEVEL: AtomicU8 = AtomicU8::new(ALL.len() as u8 - 1);
    static TURN: Mutex<()> = Mutex::new(());

    pub(super) fn max_level() -> Level {
        ALL[usize::from(MAX_LEVEL.load(Ordering::Relaxed))]
    }

    /// Returns the levels that this processor supports, narrowest first.
    pub fn levels() -> impl Iterator<Item = Level> {
        ALL.into_iter().filter(|level| *level <= Level::of_processor())
    }

    /// Runs `work` at a level. Concurrent calls run one after the other. Other tests that run meanwhile use this level
    /// as well, which does not change their results.
    pub fn at<T>(level: Level, work: impl FnOnce() -> T) -> T {
        struct Widest;
        impl Drop for Widest {
            fn drop(&mut self) {
                MAX_LEVEL.store(ALL.len() as u8 - 1, Ordering::Relaxed);
            }
        }
        let _turn = TURN.lock().unwrap_or_else(|e| e.into_inner());
        let _widest = Widest;
        MAX_LEVEL.store(level as u8, Ordering::Relaxed);
        work()
    }
}

#[cfg(test)]
mod tests;
