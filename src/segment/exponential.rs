//! Exponentials and a logarithm from basic arithmetic, which compilers vectorise, and which gives the same bits on all
//! processors.

/// Computes `eˣ` to a relative error below 3e-7; `x` is clamped to `[-87, 88]`.
#[inline(always)]
pub fn exp_f32(x: f32) -> f32 {
    // ln 2 in two parts. The first has few bits, so its product with an integer is exact. [paper: Cody and Waite 1980]
    const LN_2: [f32; 2] = [0.693_359_4, -2.121_944_4e-4];
    // Adding 1.5 × 2²³ rounds to an integer, which then stands in the lowest bits of the mantissa. [rounding]
    const ROUND: f32 = 12_582_912.0;
    let x = x.clamp(-87.0, 88.0);
    let shifted = x * std::f32::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * LN_2[0] - n * LN_2[1];
    let p = [1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0, 1.0].into_iter().fold(1.0 / 720.0, |p, c| p * r + c);
    p * f32::from_bits(shifted.to_bits().wrapping_add(127) << 23)
}

/// Computes `eˣ` to a relative error below 1e-12; `x` is clamped to `[-708, 709]`.
#[inline(always)]
pub fn exp_f64(x: f64) -> f64 {
    // `LN_2` and `ROUND` serve as in `exp_f32`; `ROUND` is 1.5 × 2⁵². [paper: Cody and Waite 1980]
    const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
    const ROUND: f64 = 6_755_399_441_055_744.0;
    /// Taylor coefficients `1 / k!` for k from 10 down to 0; the next term is below 1e-12 of the sum. [rounding]
    const TAYLOR: [f64; 11] = [
        1.0 / 3_628_800.0,
        1.0 / 362_880.0,
        1.0 / 40_320.0,
        1.0 / 5040.0,
        1.0 / 720.0,
        1.0 / 120.0,
        1.0 / 24.0,
        1.0 / 6.0,
        0.5,
        1.0,
        1.0,
    ];
    let x = x.clamp(-708.0, 709.0);
    let shifted = x * std::f64::consts::LOG2_E + ROUND;
    let n = shifted - ROUND;
    let r = x - n * LN_2[0] - n * LN_2[1];
    let p = TAYLOR.into_iter().fold(0.0, |p, c| p * r + c);
    p * f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52)
}

/// Computes `ln y` for y in `[1, 2]` to an error below 1e-12, as `ln √2 + 2 artanh((y - √2) / (y + √2))` with the
/// power series of artanh.
#[inline(always)]
pub fn ln(y: f64) -> f64 {
    // Coefficients `1 / k` for odd k from 13 down to 1; the next term is below 1e-12. [rounding]
    const SERIES: [f64; 7] = [1.0 / 13.0, 1.0 / 11.0, 1.0 / 9.0, 1.0 / 7.0, 1.0 / 5.0, 1.0 / 3.0, 1.0];
    let s = (y - std::f64::consts::SQRT_2) / (y + std::f64::consts::SQRT_2);
    let square = s * s;
    0.5 * std::f64::consts::LN_2 + 2.0 * s * SERIES.into_iter().fold(0.0, |sum, c| sum * square + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exponential_is_the_exponential() {
        for i in -8700..=8800 {
            let x = i as f32 / 100.0;
            let relative = f64::from(exp_f32(x)) / f64::from(x).exp() - 1.0;
            assert!(relative.abs() < 3e-7, "{x}: {relative}");
            let x = f64::from(x) * 8.0;
            assert!((exp_f64(x) / x.exp() - 1.0).abs() < 1e-12, "{x}");
        }
        assert_eq!((exp_f32(0.0), exp_f64(0.0)), (1.0, 1.0));
        assert!(exp_f32(-1e30) < 1e-37 && exp_f32(1e30) > 1e38 && exp_f32(f32::NEG_INFINITY) >= 0.0);
        assert!(exp_f64(-1e300) < 1e-307 && exp_f64(1e300) > 1e307 && exp_f64(f64::NEG_INFINITY) >= 0.0);
    }

    #[test]
    fn the_logarithm_is_the_logarithm() {
        for i in 0..=1000 {
            let y = 1.0 + f64::from(i) / 1000.0;
            assert!((ln(y) - y.ln()).abs() < 1e-12, "{y}");
        }
    }
}
