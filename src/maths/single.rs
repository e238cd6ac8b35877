//! Functions of `f32`, computed in `f64` and rounded once, so that the error stays below 0.52 units of the last place.
//!
//! Each function reduces its argument to a short interval and evaluates a Taylor polynomial there. There are no tables
//! and hardly any branches, so the compiler can inline the functions into loops.

use std::f64::consts::{FRAC_1_PI, FRAC_2_PI, LN_2, LOG2_E, PI, SQRT_2};

/// Adding and subtracting this number rounds to an integer, because an `f64` of this size has no fraction. The lowest
/// bits of the sum hold the integer. [rounding]
const TO_INTEGER: f64 = 1.5 * (1u64 << 52) as f64;

/// The number of bits of the fraction of an `f64`.
const FRACTION_BITS: u32 = f64::MANTISSA_DIGITS - 1;

/// The leading 33 bits of π, so that its products with half-integers below 2¹⁹ are exact. [rounding]
const PI_HIGH: f64 = f64::from_bits(PI.to_bits() >> 20 << 20);

/// The rest of π. [rounding]
const PI_LOW: f64 = 1.215_420_101_301_238_5e-10;

/// Larger angles need more digits of π. The crate `libm` has them. [rounding]
const MAX_ANGLE: f32 = (1u32 << 20) as f32;

/// Outside these powers of two, every result is infinite or 0 in `f32`. [rounding]
const EXPONENTS: [f64; 2] = [-151.0, 129.0];

#[inline]
pub fn sin(x: f32) -> f32 {
    if x.abs() <= MAX_ANGLE { sin_within(f64::from(x)) as f32 } else { libm::sin(f64::from(x)) as f32 }
}

#[inline]
pub fn cos(x: f32) -> f32 {
    if x.abs() <= MAX_ANGLE { cos_within(f64::from(x)) as f32 } else { libm::cos(f64::from(x)) as f32 }
}

/// Both at once, at less cost than one after the other.
#[inline]
pub fn sin_cos(x: f32) -> (f32, f32) {
    if !(x.abs() <= MAX_ANGLE) {
        return (sin(x), cos(x));
    }
    // Subtract the nearest multiple of π/2. Odd multiples swap the functions.
    let x = f64::from(x);
    let shifted = x * FRAC_2_PI + TO_INTEGER;
    let quarter = shifted.to_bits();
    let r = remainder(x, 0.5 * (shifted - TO_INTEGER));
    let (sine, cosine) = (sin_of_remainder(r), cos_of_remainder(r));
    let (sine, cosine) = if quarter & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
    (negate_if_odd(sine, quarter >> 1) as f32, negate_if_odd(cosine, (quarter + 1) >> 1) as f32)
}

#[inline]
pub fn tan(x: f32) -> f32 {
    let wide = f64::from(x);
    if x.abs() <= MAX_ANGLE { (sin_within(wide) / cos_within(wide)) as f32 } else { libm::tan(wide) as f32 }
}

#[inline]
pub fn exp(x: f32) -> f32 {
    power_of_two(f64::from(x) * LOG2_E) as f32
}

#[inline]
pub fn exp2(x: f32) -> f32 {
    power_of_two(f64::from(x)) as f32
}

#[inline]
pub fn ln(x: f32) -> f32 {
    if !is_positive(x) {
        return libm::log(f64::from(x)) as f32;
    }
    let (exponent, ln) = logarithm(f64::from(x));
    (exponent * LN_2 + ln) as f32
}

#[inline]
pub fn log2(x: f32) -> f32 {
    if !is_positive(x) {
        return libm::log2(f64::from(x)) as f32;
    }
    let (exponent, ln) = logarithm(f64::from(x));
    (exponent + ln * LOG2_E) as f32
}

#[inline]
pub fn powf(base: f32, power: f32) -> f32 {
    if !is_positive(base) || !power.is_finite() {
        return libm::pow(f64::from(base), f64::from(power)) as f32;
    }
    let (exponent, ln) = logarithm(f64::from(base));
    power_of_two(f64::from(power) * (exponent + ln * LOG2_E)) as f32
}

/// Whether a number is positive and finite, which NaN is not.
#[inline]
fn is_positive(x: f32) -> bool {
    x > 0.0 && x < f32::INFINITY
}

/// The sine of an angle of at most [`MAX_ANGLE`].
#[inline]
fn sin_within(x: f64) -> f64 {
    // Subtract the nearest multiple of π. Odd multiples change the sign.
    let shifted = x * FRAC_1_PI + TO_INTEGER;
    let sine = sin_of_remainder(remainder(x, shifted - TO_INTEGER));
    negate_if_odd(sine, shifted.to_bits())
}

/// The cosine of an angle of at most [`MAX_ANGLE`].
#[inline]
fn cos_within(x: f64) -> f64 {
    // Subtract the nearest odd multiple of π/2: cos(r + π/2) = -sin(r).
    let shifted = (x * FRAC_1_PI - 0.5) + TO_INTEGER;
    let sine = sin_of_remainder(remainder(x, (shifted - TO_INTEGER) + 0.5));
    negate_if_odd(sine, shifted.to_bits() + 1)
}

/// An angle less a multiple of π.
#[inline]
fn remainder(x: f64, times_pi: f64) -> f64 {
    (x - times_pi * PI_HIGH) - times_pi * PI_LOW
}

#[inline]
fn negate_if_odd(value: f64, integer: u64) -> f64 {
    f64::from_bits(value.to_bits() ^ (integer << 63))
}

/// The Taylor polynomial of the sine up to r¹³, for |r| ≤ π/2. The next term is at most 7e-10.
#[inline]
fn sin_of_remainder(r: f64) -> f64 {
    let w = r * r;
    let w2 = w * w;
    let low = (1.0 - w * (1.0 / 6.0)) + w2 * (1.0 / 120.0 - w * (1.0 / 5040.0));
    let high = (1.0 / 362_880.0 - w * (1.0 / 39_916_800.0)) + w2 * (1.0 / 6_227_020_800.0);
    r * (low + w2 * w2 * high)
}

/// The Taylor polynomial of the cosine up to r¹⁰, for |r| ≤ π/4. The next term is at most 2e-10 of the result.
#[inline]
fn cos_of_remainder(r: f64) -> f64 {
    let w = r * r;
    let w2 = w * w;
    let low = (1.0 - 0.5 * w) + w2 * (1.0 / 24.0 - w * (1.0 / 720.0));
    low + w2 * w2 * (1.0 / 40_320.0 - w * (1.0 / 3_628_800.0))
}

/// 2ˣ, for a result that is rounded to `f32`.
#[inline]
fn power_of_two(x: f64) -> f64 {
    // Both comparisons are false for NaN, which stays NaN.
    let x = if x < EXPONENTS[0] { EXPONENTS[0] } else { x };
    let x = if x > EXPONENTS[1] { EXPONENTS[1] } else { x };
    let shifted = x + TO_INTEGER;
    // The Taylor polynomial of eʳ up to r⁸, for |r| ≤ ln(2)/2. The next term is at most 3e-10.
    let r = (x - (shifted - TO_INTEGER)) * LN_2;
    let (r2, r4) = (r * r, r * r * r * r);
    let low = (1.0 + r) + r2 * (0.5 + r * (1.0 / 6.0));
    let high = (1.0 / 24.0 + r * (1.0 / 120.0)) + r2 * (1.0 / 720.0 + r * (1.0 / 5040.0));
    let power = low + r4 * (high + r4 * (1.0 / 40_320.0));
    power * f64::from_bits((shifted.to_bits() << FRACTION_BITS).wrapping_add(1f64.to_bits()))
}

/// Splits a positive number into 2ᵏ m with m between √½ and √2, and returns k and ln(m).
#[inline]
fn logarithm(x: f64) -> (f64, f64) {
    let bits = x.to_bits();
    let exponent = (bits as i64 - (SQRT_2 / 2.0).to_bits() as i64) >> FRACTION_BITS;
    let m = f64::from_bits((bits as i64 - (exponent << FRACTION_BITS)) as u64);
    // ln(m) = 2 artanh(s), by the Taylor polynomial up to s¹³. The next term is at most 2e-12 of the result.
    let s = (m - 1.0) / (m + 1.0);
    let w = s * s;
    let w2 = w * w;
    let low = (1.0 + w * (1.0 / 3.0)) + w2 * (1.0 / 5.0 + w * (1.0 / 7.0));
    let high = (1.0 / 9.0 + w * (1.0 / 11.0)) + w2 * (1.0 / 13.0);
    (exponent as i32 as f64, 2.0 * s * (low + w2 * w2 * high))
}
