//! Sines, exponentials, logarithms and their kin, with the same bits on every platform.
//!
//! The standard library passes these functions on to the platform's C library, and C libraries round the last bit
//! differently. This module computes them by additions, multiplications, divisions and square roots alone, which
//! IEEE 754 rounds in one way everywhere: by polynomials of its own (`single`) for the frequent functions of `f32`, and
//! by the crate `libm` for the rest. Clippy forbids the functions of the standard library within the library, and those
//! of glam that call them (clippy.toml); `rotation` has what the library needs of the latter.
//!
//! `sqrt`, `floor`, `round`, `%` and the like have only one correct result, so the standard library's are used.

mod rotation;
mod single;

pub use rotation::{angle_of, direction_at, rotation_2d, rotation_3d, rotation_about, rotation_by};

/// A number type whose functions this module computes. The names are those of the standard library.
pub trait Real: Copy {
    /// Glam's vector of two numbers of this type.
    type Vec2: From<[Self; 2]>;

    fn sin(self) -> Self;
    fn cos(self) -> Self;
    fn sin_cos(self) -> (Self, Self);
    fn tan(self) -> Self;
    fn asin(self) -> Self;
    fn acos(self) -> Self;
    fn atan(self) -> Self;
    fn atan2(self, x: Self) -> Self;
    fn tanh(self) -> Self;
    fn exp(self) -> Self;
    fn exp2(self) -> Self;
    fn exp_m1(self) -> Self;
    fn ln(self) -> Self;
    fn ln_1p(self) -> Self;
    fn log2(self) -> Self;
    fn log10(self) -> Self;
    fn powf(self, exponent: Self) -> Self;
    fn powi(self, exponent: i32) -> Self;
    fn hypot(self, y: Self) -> Self;
    fn cbrt(self) -> Self;
}

/// Defines methods of [`Real`] by functions of one or two numbers, and `powi`.
macro_rules! by {
    ($($name:ident($first:ident $(, $second:ident)?) = $function:path;)*) => {$(
        #[inline]
        fn $name(self $(, $second: Self)?) -> Self {
            $function(self $(, $second)?)
        }
    )*

        /// Multiplies in the order of the binary digits of the exponent. The compiler unrolls the loop for a constant
        /// exponent. The standard library's `powi` leaves the order to the compiler, which may also compute the power
        /// of a constant by the C library of the machine on which it runs.
        #[inline(always)]
        fn powi(self, exponent: i32) -> Self {
            let (mut power, mut base, mut digits) = (1.0, self, exponent.unsigned_abs());
            loop {
                if digits & 1 == 1 {
                    power *= base;
                }
                digits >>= 1;
                if digits == 0 {
                    return if exponent < 0 { 1.0 / power } else { power };
                }
                base *= base;
            }
        }
    };
}

impl Real for f32 {
    type Vec2 = glam::Vec2;

    by! {
        sin(x) = single::sin;
        cos(x) = single::cos;
        tan(x) = single::tan;
        exp(x) = single::exp;
        exp2(x) = single::exp2;
        ln(x) = single::ln;
        log2(x) = single::log2;
        powf(base, exponent) = single::powf;
        asin(x) = libm::asinf;
        acos(x) = libm::acosf;
        atan(x) = libm::atanf;
        atan2(y, x) = libm::atan2f;
        tanh(x) = libm::tanhf;
        exp_m1(x) = libm::expm1f;
        ln_1p(x) = libm::log1pf;
        log10(x) = libm::log10f;
        hypot(x, y) = libm::hypotf;
        cbrt(x) = libm::cbrtf;
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        single::sin_cos(self)
    }
}

impl Real for f64 {
    type Vec2 = glam::DVec2;

    by! {
        sin(x) = libm::sin;
        cos(x) = libm::cos;
        tan(x) = libm::tan;
        exp(x) = libm::exp;
        exp2(x) = libm::exp2;
        ln(x) = libm::log;
        log2(x) = libm::log2;
        powf(base, exponent) = libm::pow;
        asin(x) = libm::asin;
        acos(x) = libm::acos;
        atan(x) = libm::atan;
        atan2(y, x) = libm::atan2;
        tanh(x) = libm::tanh;
        exp_m1(x) = libm::expm1;
        ln_1p(x) = libm::log1p;
        log10(x) = libm::log10;
        hypot(x, y) = libm::hypot;
        cbrt(x) = libm::cbrt;
    }

    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        libm::sincos(self)
    }
}

/// Defines a function for each method of [`Real`], so that formulas read `sin(x)`.
macro_rules! functions {
    ($($name:ident($first:ident $(, $second:ident: $type:ty)?) -> $out:ty;)*) => {$(
        #[inline(always)]
        pub fn $name<R: Real>($first: R $(, $second: $type)?) -> $out {
            R::$name($first $(, $second)?)
        }
    )*};
}

functions! {
    sin(x) -> R;
    cos(x) -> R;
    sin_cos(x) -> (R, R);
    tan(x) -> R;
    asin(x) -> R;
    acos(x) -> R;
    atan(x) -> R;
    atan2(y, x: R) -> R;
    tanh(x) -> R;
    exp(x) -> R;
    exp2(x) -> R;
    exp_m1(x) -> R;
    ln(x) -> R;
    ln_1p(x) -> R;
    log2(x) -> R;
    log10(x) -> R;
    powf(base, exponent: R) -> R;
    powi(base, exponent: i32) -> R;
    hypot(x, y: R) -> R;
    cbrt(x) -> R;
}

#[cfg(test)]
mod tests;
