//! Which vector instructions to use, and loops compiled for each kind of them.
//!
//! [`Level::widest`] is the one place that asks the processor; whoever has code for more than one level asks it. No level
//! changes a bit: none contracts a product and a sum into one rounding where that would show, and loops are written so
//! that no sum changes its order.

/// Sets of instructions, each with those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What every processor of its kind has: SSE2 on x86-64, NEON on aarch64.
    Baseline,
    /// AVX2, FMA, BMI1, BMI2, LZCNT and POPCNT.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 F, BW, CD, DQ and VL.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

impl Level {
    /// The widest that this processor has.
    pub fn widest() -> Self {
        let level = Self::of_processor();
        #[cfg(test)]
        let level = level.min(forced::most());
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

/// Defines a function whose loops use the widest instructions the processor has. Plain arguments only, no generics.
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
                // SAFETY: the processor has the instructions of its level.
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

/// Narrower levels than the processor's, for tests alone: what the library is shipped with asks nothing but the processor.
#[cfg(test)]
pub mod forced {
    use super::Level;
    use std::sync::Mutex;
    use std::sync::atomic::{AtomicU8, Ordering};

    #[cfg(target_arch = "x86_64")]
    const ALL: [Level; 3] = [Level::Baseline, Level::Avx2, Level::Avx512];
    #[cfg(not(target_arch = "x86_64"))]
    const ALL: [Level; 1] = [Level::Baseline];

    static MOST: AtomicU8 = AtomicU8::new(ALL.len() as u8 - 1);
    static TURN: Mutex<()> = Mutex::new(());

    pub(super) fn most() -> Level {
        ALL[usize::from(MOST.load(Ordering::Relaxed))]
    }

    /// The levels of this processor, the narrowest first.
    pub fn levels() -> impl Iterator<Item = Level> {
        ALL.into_iter().filter(|level| *level <= Level::of_processor())
    }

    /// What `work` gives at a level. One at a time; other tests may meet it meanwhile, which changes nothing for them.
    pub fn at<T>(level: Level, work: impl FnOnce() -> T) -> T {
        struct Widest;
        impl Drop for Widest {
            fn drop(&mut self) {
                MOST.store(ALL.len() as u8 - 1, Ordering::Relaxed);
            }
        }
        let _turn = TURN.lock().unwrap_or_else(|e| e.into_inner());
        let _widest = Widest;
        MOST.store(level as u8, Ordering::Relaxed);
        work()
    }
}

#[cfg(test)]
mod tests;
