//! The all-weather sky of Perez, Seals and Michalsky ("All-weather model for sky luminance distribution - preliminary
//! configuration and validation", 1993, with the erratum of the same year), and the luminous efficacies of Perez,
//! Ineichen, Seals, Michalsky and Stewart ("Modeling daylight availability and irradiance components from direct and
//! global irradiance", 1990, equations 6 to 8 and table 4).
//!
//! Both depend on the clearness ε and the brightness Δ of the sky, which follow from the direct normal irradiance, the
//! diffuse horizontal irradiance and the sun's altitude. ε selects one of eight bins of coefficients.

use super::shape::LuminanceShape;
use super::sun::SunPosition;
use crate::maths;
use std::f64::consts::FRAC_PI_2;

/// Solar irradiance at one astronomical unit in W/m², as in the papers. [convention]
const SOLAR_CONSTANT: f64 = 1367.0;
/// Factor of Z³ in ε, with the sun's zenith angle Z in radians. [paper: Perez et al. 1990, equation 1]
const CLEARNESS_FACTOR: f64 = 1.041;
/// Upper bounds of all bins of ε but the last. [paper: Perez et al. 1990, table 1]
const BINS: [f64; 7] = [1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2];
/// Range of ε and of Δ, to which skies outside the models' data are limited, as in Radiance's gendaylit; between a
/// largest ε of 8 and 20, the last bin is the same. [convention]
const CLEARNESS: [f64; 2] = [1.0, 12.0];
const BRIGHTNESS: [f64; 2] = [0.01, 0.6];
/// Smallest Δ in the luminance of skies of the bins 2 to 5, as in Radiance's gendaylit: with smaller values, parts of
/// these skies would be negative. [convention]
const INTERMEDIATE_BRIGHTNESS: f64 = 0.2;

/// For each bin, the coefficients a1 to a4, b1 to b4, and so on up to e4. [paper: Perez et al. 1993, table 1]
const LUMINANCE: [[[f64; 4]; 5]; 8] = [
    [
        [1.3525, -0.2576, -0.2690, -1.4366],
        [-0.7670, 0.0007, 1.2734, -0.1233],
        [2.8000, 0.6004, 1.2375, 1.0000],
        [1.8734, 0.6297, 0.9738, 0.2809],
        [0.0356, -0.1246, -0.5718, 0.9938],
    ],
    [
        [-1.2219, -0.7730, 1.4148, 1.1016],
        [-0.2054, 0.0367, -3.9128, 0.9156],
        [6.9750, 0.1774, 6.4477, -0.1239],
        [-1.5798, -0.5081, -1.7812, 0.1080],
        [0.2624, 0.0672, -0.2190, -0.4285],
    ],
    [
        [-1.1000, -0.2515, 0.8952, 0.0156],
        [0.2782, -0.1812, -4.5000, 1.1766],
        [24.7219, -13.0812, -37.7000, 34.8438],
        [-5.0000, 1.5218, 3.9229, -2.6204],
        [-0.0156, 0.1597, 0.4199, -0.5562],
    ],
    [
        [-0.5484, -0.6654, -0.2672, 0.7117],
        [0.7234, -0.6219, -5.6812, 2.6297],
        [33.3389, -18.3000, -62.2500, 52.0781],
        [-3.5000, 0.0016, 1.1477, 0.1062],
        [0.4659, -0.3296, -0.0876, -0.0329],
    ],
    [
        [-0.6000, -0.3566, -2.5000, 2.3250],
        [0.2937, 0.0496, -5.6812, 1.8415],
        [21.0000, -4.7656, -21.5906, 7.2492],
        [-3.5000, -0.1554, 1.4062, 0.3988],
        [0.0032, 0.0766, -0.0656, -0.1294],
    ],
    [
        [-1.0156, -0.3670, 1.0078, 1.4051],
        [0.2875, -0.5328, -3.8500, 3.3750],
        [14.0000, -0.9999, -7.1406, 7.5469],
        [-3.4000, -0.1078, -1.0750, 1.5702],
        [-0.0672, 0.4016, 0.3017, -0.4844],
    ],
    [
        [-1.0000, 0.0211, 0.5025, -0.5119],
        [-0.3000, 0.1922, 0.7023, -1.6317],
        [19.0000, -5.0000, 1.2438, -1.9094],
        [-4.0000, 0.0250, 0.3844, 0.2656],
        [1.0468, -0.3788, -2.4517, 1.4656],
    ],
    [
        [-1.0500, 0.0289, 0.4260, 0.3590],
        [-0.3250, 0.1156, 0.7781, 0.0025],
        [31.0625, -14.5000, -46.1148, 55.3750],
        [-7.2312, 0.4050, 13.3500, 0.6234],
        [1.5000, -0.6426, 1.8564, 0.5636],
    ],
];
/// For each bin, the coefficients of the efficacy of diffuse light. [paper: Perez et al. 1990, table 4]
const DIFFUSE_EFFICACY: [[f64; 4]; 8] = [
    [97.24, -0.46, 12.00, -8.91],
    [107.22, 1.15, 0.59, -3.95],
    [104.97, 2.96, -5.53, -8.77],
    [102.39, 5.59, -13.95, -13.90],
    [100.71, 5.94, -22.75, -23.74],
    [106.42, 3.83, -36.15, -28.83],
    [141.88, 1.90, -53.24, -14.03],
    [152.23, 0.35, -45.27, -7.98],
];
/// For each bin, the coefficients of the efficacy of direct light. [paper: Perez et al. 1990, table 4]
const DIRECT_EFFICACY: [[f64; 4]; 8] = [
    [57.20, -4.55, -2.98, 117.12],
    [98.99, -3.46, -1.21, 12.38],
    [109.83, -4.90, -1.71, -8.81],
    [110.34, -5.84, -1.99, -4.56],
    [106.36, -3.97, -1.75, -6.16],
    [107.19, -1.25, -1.51, -26.73],
    [105.75, 0.77, -1.26, -34.44],
    [101.18, 1.58, -1.10, -8.29],
];

/// The state of the sky on which the model depends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SkyState {
    /// Zenith angle Z of the sun in radians, at most π / 2: a sun below the horizon counts as if it stood on it.
    zenith_angle: f64,
    /// Clearness ε, from 1 for an overcast sky to 12.
    pub clearness: f64,
    /// Brightness Δ, in `[0.01, 0.6]`.
    pub brightness: f64,
}

impl SkyState {
    /// Computes the state from the direct normal and the diffuse horizontal irradiance in W/m², neither negative.
    /// Without any irradiance, the sky counts as overcast.
    pub fn new(sun: &SunPosition, direct_normal: f64, diffuse_horizontal: f64) -> Self {
        let zenith_angle = (FRAC_PI_2 - sun.altitude).clamp(0.0, FRAC_PI_2);
        let cubed = CLEARNESS_FACTOR * maths::powi(zenith_angle, 3);
        let ratio = if direct_normal > 0.0 { direct_normal / diffuse_horizontal } else { 0.0 };
        let clearness = (1.0 + ratio + cubed) / (1.0 + cubed);
        // The optical air mass of Kasten (1966), as in the papers.
        let degrees = zenith_angle.to_degrees();
        let air_mass = 1.0 / (maths::cos(zenith_angle) + 0.15 * maths::powf(93.885 - degrees, -1.253));
        let brightness = diffuse_horizontal * air_mass * sun.distance * sun.distance / SOLAR_CONSTANT;
        Self {
            zenith_angle,
            clearness: clearness.clamp(CLEARNESS[0], CLEARNESS[1]),
            brightness: brightness.clamp(BRIGHTNESS[0], BRIGHTNESS[1]),
        }
    }

    fn bin(&self) -> usize {
        BINS.iter().take_while(|&&bound| self.clearness >= bound).count()
    }

    /// Returns the luminous efficacies of direct and of diffuse light in lm/W. `water` is the precipitable water in cm.
    pub fn efficacies(&self, water: f64) -> [f64; 2] {
        let z = self.zenith_angle;
        let [a, b, c, d] = DIRECT_EFFICACY[self.bin()];
        let direct = a + b * water + c * maths::exp(5.73 * z - 5.0) + d * self.brightness;
        let [a, b, c, d] = DIFFUSE_EFFICACY[self.bin()];
        let diffuse = a + b * water + c * maths::cos(z) + d * maths::ln(self.brightness);
        [direct.max(0.0), diffuse.max(0.0)]
    }

    /// Returns the relative luminance of the sky (equations 1 to 4 and tables 1 and 2 of the paper of 1993).
    pub fn shape(&self) -> LuminanceShape {
        let (bin, z) = (self.bin(), self.zenith_angle);
        let delta = if (1..5).contains(&bin) { self.brightness.max(INTERMEDIATE_BRIGHTNESS) } else { self.brightness };
        let rows = LUMINANCE[bin];
        let [a, b, c, d, e] = rows.map(|[p, q, r, s]| p + q * z + delta * (r + s * z));
        // Outside the models' data, b may be positive, which would make the horizon infinitely bright. As b approaches
        // 0, the gradation becomes constant: leave it out. The smallest a for which no part of the sky is negative is
        // -exp(-b), because exp(b / cos ζ) is largest at the zenith.
        let [a, b] = if b < 0.0 { [a.max(-maths::exp(-b)), b] } else { [0.0, 0.0] };
        let shape = LuminanceShape { a, b, c, d, e, offset: 0.0 };
        if bin > 0 {
            return shape;
        }
        let [[c1, c2, c3, c4], [d1, d2, d3, d4]] = [rows[2], rows[3]];
        LuminanceShape {
            c: maths::exp(maths::powf(delta * (c1 + c2 * z), c3)) - c4,
            d: -maths::exp(delta * (d1 + d2 * z)) + d3 + delta * d4,
            ..shape
        }
    }
}

/// Returns the precipitable water in cm from the dew point in °C at the ground. [paper: Perez et al. 1990, equation 3]
pub fn precipitable_water(dew_point: f64) -> f64 {
    maths::exp(0.07 * dew_point - 0.075)
}
