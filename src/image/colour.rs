//! Colour conversions: the sRGB transfer curve (IEC 61966-2-1), Rec.709 primaries, CIELAB with a D65 white (CIE
//! 15:2018), and the CIEDE2000 difference (Sharma, Wu and Dalal 2005).

use crate::maths;
use crate::simd::widest;
use glam::{DMat3, DVec3, Vec3};

/// Matrix from linear Rec.709 RGB to CIE XYZ, computed from the chromaticities of Rec.709 and D65 = (0.3127, 0.3290).
/// White has Y = 1. [convention: ITU-R BT.709]
const RGB_TO_XYZ: DMat3 = DMat3::from_cols(
    DVec3::new(0.412_390_799_265_959_5, 0.212_639_005_871_510_36, 0.019_330_818_715_591_85),
    DVec3::new(0.357_584_339_383_877_96, 0.715_168_678_767_755_9, 0.119_194_779_794_625_99),
    DVec3::new(0.180_480_788_401_834_3, 0.072_192_315_360_733_7, 0.950_532_152_249_660_5),
);

/// Decodes one sRGB value `v` to a linear value `f(v)`. The curve continues above 1, and `f(-v) = -f(v)`.
pub fn srgb_to_linear(v: f32) -> f32 {
    let a = v.abs();
    let linear = if a <= 0.04045 { a / 12.92 } else { maths::powf((a + 0.055) / 1.055, 2.4) };
    linear.copysign(v)
}

pub fn linear_to_srgb(v: f32) -> f32 {
    let a = v.abs();
    let encoded = if a <= 0.003_130_8 { a * 12.92 } else { 1.055 * maths::powf(a, 1.0 / 2.4) - 0.055 };
    encoded.copysign(v)
}

/// Returns the linear value of each 8-bit sRGB code.
pub fn srgb8_table() -> [f32; 256] {
    std::array::from_fn(|code| srgb_to_linear(code as f32 / 255.0))
}

/// Luminance of a linear Rec.709 colour, in cd/m² for photometric colours.
pub fn luminance(rgb: Vec3) -> f32 {
    rgb.dot(Vec3::new(0.212_639, 0.715_168_7, 0.072_192_3))
}

pub fn linear_to_xyz(rgb: Vec3) -> DVec3 {
    RGB_TO_XYZ * rgb.as_dvec3()
}

/// Converts linear RGB with diffuse white at 1 to CIELAB. L* lies in `[0, 100]` for colours inside the gamut.
#[inline(always)]
pub fn linear_to_lab(rgb: Vec3) -> Vec3 {
    // Rows of the matrix from linear RGB to CIE XYZ, divided by the white point. [convention: IEC 61966-2-1]
    const X: [f64; 3] = relative_row(0);
    const Y: [f64; 3] = relative_row(1);
    const Z: [f64; 3] = relative_row(2);
    let of = |row: [f64; 3]| {
        let t = row[0] * f64::from(rgb.x) + row[1] * f64::from(rgb.y) + row[2] * f64::from(rgb.z);
        // Above DELTA³ CIELAB applies a cube root, below it a straight line. [convention: CIE 15, CIELAB]
        const DELTA: f64 = 6.0 / 29.0;
        let straight = t * (1.0 / (3.0 * DELTA * DELTA)) + 4.0 / 29.0;
        let root = cube_root(t);
        if t > DELTA * DELTA * DELTA { root } else { straight }
    };
    let (fx, fy, fz) = (of(X), of(Y), of(Z));
    Vec3::new((116.0 * fy - 16.0) as f32, (500.0 * (fx - fy)) as f32, (200.0 * (fy - fz)) as f32)
}

/// Returns a row of the matrix from linear RGB to CIE XYZ, divided by the white point.
const fn relative_row(row: usize) -> [f64; 3] {
    let m = RGB_TO_XYZ.to_cols_array();
    let white = m[row] + m[row + 3] + m[row + 6];
    [m[row] / white, m[row + 3] / white, m[row + 6] / white]
}

/// Returns the cube root of a value in `[1e-37, 3e38]` with a relative error of 1e-13, by operations that vectorise.
/// Any other value gives a finite number or NaN.
#[inline(always)]
fn cube_root(t: f64) -> f64 {
    // Approximate r = t^(-1/3) by steps without division; then t^(1/3) = t r². With e = 1 - t r³, the exact value is
    //
    // r (1 - e)^(-1/3) = r (1 + e/3 + 2e²/9 + 14e³/81 + …).
    //
    // The first r comes from dividing the bits of the float (exponent and mantissa) by three: |e| < 0.11. A step in
    // `f32` with terms up to e³ gives |e| < 6e-5. A step in `f64` with terms up to e² gives the result.
    let single = t as f32;
    let third = (single.to_bits() as i32 as f32 * (1.0 / 3.0)) as i32;
    let r = f32::from_bits(1_419_900_000u32.wrapping_sub(third as u32));
    let e = 1.0 - single * r * r * r;
    let r = f64::from(r + r * e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0))));
    let e = 1.0 - t * r * r * r;
    let r = r + r * e * (1.0 / 3.0 + e * (2.0 / 9.0));
    t * r * r
}

/// CIEDE2000 difference between the linear colours `light` and `wanted`. Both are first scaled by the factor that
/// gives `wanted` the luminance 0.18 (middle grey). The difference is 0 if `wanted` is black.
pub fn delta_e_from(wanted: DVec3, light: DVec3) -> f64 {
    let luminance = f64::from(luminance(wanted.as_vec3()));
    if !(luminance > 0.0) {
        return 0.0;
    }
    let seen = |light: DVec3| linear_to_lab((light * (0.18 / luminance)).as_vec3());
    delta_e_2000(seen(wanted), seen(light))
}

/// CIEDE2000 difference between two CIELAB colours.
pub fn delta_e_2000(a: Vec3, b: Vec3) -> f64 {
    let (a, b) = (a.as_dvec3(), b.as_dvec3());
    let chroma = |v: DVec3| maths::hypot(v.y, v.z);
    let pow7 = |v: f64| maths::powi(v, 7);
    let g = {
        let c = pow7((chroma(a) + chroma(b)) / 2.0);
        0.5 * (1.0 - (c / (c + pow7(25.0))).sqrt())
    };
    let adjust = |v: DVec3| DVec3::new(v.x, v.y * (1.0 + g), v.z);
    let (a, b) = (adjust(a), adjust(b));
    let (ca, cb) = (chroma(a), chroma(b));
    let hue = |v: DVec3| maths::atan2(v.z, v.y).to_degrees().rem_euclid(360.0);
    let (ha, hb) = (hue(a), hue(b));

    // Differences of lightness, chroma and hue. A colour without chroma has no hue.
    let grey = ca * cb == 0.0;
    let dh = if grey { 0.0 } else { (hb - ha + 540.0).rem_euclid(360.0) - 180.0 };
    let (dl, dc) = (b.x - a.x, cb - ca);
    let dh_term = 2.0 * (ca * cb).sqrt() * maths::sin((dh / 2.0).to_radians());

    // Means of lightness, chroma and hue. The hue is averaged along the shorter arc.
    let (l, c) = ((a.x + b.x) / 2.0, (ca + cb) / 2.0);
    let h = match () {
        () if grey => ha + hb,
        () if (ha - hb).abs() <= 180.0 => (ha + hb) / 2.0,
        () if ha + hb < 360.0 => (ha + hb + 360.0) / 2.0,
        () => (ha + hb - 360.0) / 2.0,
    };

    // Weights of the three differences, and the rotation term between chroma and hue.
    let cos = |degrees: f64| maths::cos(degrees.to_radians());
    let t = 1.0 - 0.17 * cos(h - 30.0) + 0.24 * cos(2.0 * h) + 0.32 * cos(3.0 * h + 6.0) - 0.20 * cos(4.0 * h - 63.0);
    let l50 = (l - 50.0) * (l - 50.0);
    let sl = 1.0 + 0.015 * l50 / (20.0 + l50).sqrt();
    let (sc, sh) = (1.0 + 0.045 * c, 1.0 + 0.015 * c * t);
    let rotation = 60.0 * maths::exp(-maths::powi((h - 275.0) / 25.0, 2));
    let rt = -2.0 * (pow7(c) / (pow7(c) + pow7(25.0))).sqrt() * maths::sin(rotation.to_radians());
    let (x, y, z) = (dl / sl, dc / sc, dh_term / sh);
    (x * x + y * y + z * z + rt * y * z).max(0.0).sqrt()
}

widest! {
    /// Converts linear RGB planes to CIELAB in place, like [`linear_to_lab`] for each pixel.
    pub fn planes_to_lab(r: &mut [f32], g: &mut [f32], b: &mut [f32]) {
        let n = r.len();
        let (r, g, b) = (&mut r[..n], &mut g[..n], &mut b[..n]);
        for k in 0..n {
            let lab = linear_to_lab(Vec3::new(r[k], g[k], b[k]));
            (r[k], g[k], b[k]) = (lab.x, lab.y, lab.z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_srgb_curve_meets_its_reference_and_inverts() {
        assert!((srgb_to_linear(0.5) - 0.214_041_14).abs() < 1e-7);
        assert_eq!(srgb_to_linear(1.0), 1.0);
        for code in 0..256 {
            let v = code as f32 / 255.0;
            assert!((linear_to_srgb(srgb_to_linear(v)) - v).abs() < 1e-6);
        }
    }

    /// The reference values come from exact arithmetic with the chromaticities of Rec.709 and D65 = (0.3127, 0.3290).
    #[test]
    fn lab_meets_reference_values() {
        let near = |rgb: [f32; 3], lab: [f32; 3]| {
            let got = linear_to_lab(Vec3::from(rgb));
            assert!((got - Vec3::from(lab)).abs().max_element() < 1e-4, "{rgb:?}: {got}");
        };
        near([1.0, 1.0, 1.0], [100.0, 0.0, 0.0]);
        near([0.0, 0.0, 0.0], [0.0, 0.0, 0.0]);
        near([0.18, 0.18, 0.18], [49.496_11, 0.0, 0.0]);
        near([1.0, 0.0, 0.0], [53.237_116, 80.090_11, 67.203_26]);
        near([0.0, 1.0, 0.0], [87.735_52, -86.181_6, 83.186_62]);
        near([0.0, 0.0, 1.0], [32.300_873, 79.195_27, -107.855_46]);
        near([0.001, 0.5, 0.25], [67.713_26, -51.837_82, 14.599_296]);
    }

    #[test]
    fn the_cube_root_is_the_cube_root() {
        for i in -3600..3800 {
            let t = 10f64.powf(f64::from(i) / 100.0);
            assert!((cube_root(t) / t.cbrt() - 1.0).abs() < 1e-13, "{t}");
        }
    }

    #[test]
    fn many_colours_at_once_are_the_same_to_the_bit() {
        let colour = |k: usize| Vec3::new((k % 7) as f32 / 6.0, (k % 31) as f32 / 5.0, (k % 101) as f32 * 1e-4);
        let [mut r, mut g, mut b]: [Vec<f32>; 3] = std::array::from_fn(|c| (0..203).map(|k| colour(k)[c]).collect());
        planes_to_lab(&mut r, &mut g, &mut b);
        assert!((0..203).all(|k| Vec3::new(r[k], g[k], b[k]) == linear_to_lab(colour(k))));
    }

    /// Compares with pairs 1, 4, 7, 13, 17 and 25 of the test data of Sharma, Wu and Dalal (2005).
    #[test]
    fn ciede2000_meets_the_published_pairs() {
        for (a, b, want) in [
            ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
            ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0000),
            ([50.0, 0.0, 0.0], [50.0, -1.0, 2.0], 2.3669),
            ([50.0, -0.0010, 2.4900], [50.0, 0.0009, -2.4900], 4.8045),
            ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
            ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ] {
            let got = delta_e_2000(Vec3::from(a), Vec3::from(b));
            assert!((got - want).abs() < 1e-4, "{a:?} {b:?}: {got}");
        }
    }
}
