//! Loops compiled twice: for the registers every processor of its kind has, and for wider ones, chosen at run time.
//!
//! Neither version contracts a product and a sum into one rounding, and loops are written so that no sum changes its
//! order: both give the same bits.

/// Defines a function whose loops use AVX2 where the processor has it. Plain arguments only, no generics.
macro_rules! widest {
    ($(#[$meta:meta])* $vis:vis fn $name:ident($($arg:ident: $type:ty),* $(,)?) $(-> $out:ty)? $body:block) => {
        $(#[$meta])*
        #[allow(clippy::too_many_arguments)]
        $vis fn $name($($arg: $type),*) $(-> $out)? {
            #[inline(always)]
            #[allow(clippy::too_many_arguments)]
            fn portable($($arg: $type),*) $(-> $out)? $body

            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") {
                #[target_feature(enable = "avx2")]
                #[allow(clippy::too_many_arguments)]
                fn avx2($($arg: $type),*) $(-> $out)? {
                    portable($($arg),*)
                }
                // SAFETY: the processor has AVX2, as was just found, which is all that `avx2` needs.
                return unsafe { avx2($($arg),*) };
            }
            portable($($arg),*)
        }
    };
}

pub(crate) use widest;
