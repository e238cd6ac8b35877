//! Colour mixing: finds the drives of a luminaire's LEDs (RGB, RGBW, tunable white, …) for a given colour.
//!
//! Light is additive and non-negative, so the reachable colours form a cone, or a bounded part of it if the drives are
//! bounded. The nearest reachable colour is a least squares problem of three equations in linear light
//! ([`super::bounded`]). Among mixtures of equal colour, the regularisation selects the mixture with the smallest sum
//! of squared drives, which spreads the load.

use super::bounded::BoundedLeastSquares;
use crate::error::{Error, Result, check_range};
use crate::image::colour;
use glam::DVec3;

/// Maximum number of primaries of a luminaire. \[convention\]
pub const MAX_PRIMARIES: usize = 64;

/// Weight of the squared drives relative to the colour error: only large enough to select among mixtures of equal
/// colour. It lies far above the rounding of f64 (2e-16) and far below `MAX_RELATIVE_MISS`. [rounding]
const REGULARISATION: f64 = 1e-9;
/// A colour counts as reached if its error, relative to the norm of the wanted RGB colour, is at most this. [rounding]
const MAX_RELATIVE_MISS: f64 = 1e-6;

#[derive(Clone, Debug, PartialEq)]
pub struct Mixture {
    /// Drive of each primary, in `[0, max_drive]`.
    pub drives: Vec<f64>,
    /// The linear RGB colour of the mixture.
    pub colour: DVec3,
    /// Whether the mixture has the requested colour; otherwise it has the nearest reachable colour.
    pub reached: bool,
    /// CIEDE2000 difference from the requested colour, at the exposure that shows the requested colour as a middle
    /// grey.
    pub delta_e: f64,
}

/// Mixes the linear RGB colour `wanted` from primaries such as LEDs, each with a drive from 0 to `max_drive`. A
/// primary is given by its linear RGB colour at a drive of 1. Colours outside the gamut of RGB, such as the colours of
/// most LEDs, have negative channels.
///
/// # Errors
/// Numbers that are not finite or out of range; no primaries or more than [`MAX_PRIMARIES`]; primaries that are all
/// black.
pub fn mix_primaries(primaries: &[DVec3], max_drive: f64, wanted: DVec3) -> Result<Mixture> {
    if primaries.is_empty() || primaries.len() > MAX_PRIMARIES {
        return Err(Error::argument(format!(
            "there are {} primaries; there must be 1 to {MAX_PRIMARIES}",
            primaries.len()
        )));
    }
    if let Some(i) = primaries.iter().position(|p| !p.is_finite()) {
        return Err(Error::argument(format!("primary {i} is {}; it must be finite", primaries[i])));
    }
    check_range("max_drive", max_drive, 0.0, f64::INFINITY)?;
    for channel in wanted.to_array() {
        check_range("colour", channel, 0.0, f64::from(f32::MAX))?;
    }
    let largest = primaries.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    if largest == 0.0 {
        return Err(Error::degenerate("all primaries are black: nothing can be mixed from them"));
    }
    let matrix: Vec<f64> = (0..3).flat_map(|c| primaries.iter().map(move |p| p[c])).collect();
    let squares: f64 = matrix.iter().map(|a| a * a).sum();
    let (preferred, upper) = (vec![0.0; primaries.len()], vec![max_drive; primaries.len()]);
    let problem = BoundedLeastSquares {
        matrix: &matrix,
        right: &wanted.to_array(),
        regularisation: REGULARISATION * squares / 3.0,
        preferred: &preferred,
        upper: &upper,
    };
    let drives = problem.solve()?;
    let mixed: DVec3 = primaries.iter().zip(&drives).map(|(p, d)| *p * *d).sum();
    let reached = (mixed - wanted).length() <= MAX_RELATIVE_MISS * wanted.length();
    Ok(Mixture { delta_e: colour::delta_e_from(wanted, mixed), drives, colour: mixed, reached })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::ErrorKind;
    use crate::rng::Rng;

    const FREE: f64 = f64::INFINITY;

    #[test]
    fn colours_within_the_cone_are_mixed_exactly() {
        // With three primaries, the linear system has a unique solution.
        let led = [DVec3::new(1.2, 0.1, 0.0), DVec3::new(-0.2, 0.9, 0.1), DVec3::new(0.0, -0.1, 0.8)];
        let drives = [0.5, 0.25, 2.0];
        let wanted: DVec3 = led.iter().zip(drives).map(|(p, d)| *p * d).sum();
        let mixture = mix_primaries(&led, FREE, wanted).unwrap();
        assert!(mixture.reached && mixture.delta_e < 1e-3, "{mixture:?}");
        assert!(mixture.drives.iter().zip(drives).all(|(a, b)| (a - b).abs() < 1e-6), "{mixture:?}");
        // RGBW for white: with r = g = b = 1 - w, the least squares solution is w = 3/4.
        let rgbw = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE];
        let mixture = mix_primaries(&rgbw, FREE, DVec3::ONE).unwrap();
        assert!(mixture.drives.iter().zip([0.25, 0.25, 0.25, 0.75]).all(|(a, b)| (a - b).abs() < 1e-6), "{mixture:?}");
        // Black needs no light.
        let dark = mix_primaries(&rgbw, 1.0, DVec3::ZERO).unwrap();
        assert_eq!((dark.drives, dark.reached, dark.delta_e), (vec![0.0; 4], true, 0.0));
    }

    #[test]
    fn unreachable_colours_return_the_nearest_colour() {
        // Warm and cold white span a plane: the error of the nearest colour to green is orthogonal to both.
        let (warm, cold) = (DVec3::new(1.0, 0.7, 0.4), DVec3::new(0.8, 1.0, 1.2));
        let mixture = mix_primaries(&[warm, cold], FREE, DVec3::Y).unwrap();
        let miss = mixture.colour - DVec3::Y;
        assert!(!mixture.reached && mixture.delta_e > 20.0, "{mixture:?}");
        assert!(miss.dot(warm).abs() < 1e-6 && miss.dot(cold).abs() < 1e-6, "{mixture:?}");
        // The nearest colour to blue is the cold white alone.
        let mixture = mix_primaries(&[warm, cold], FREE, DVec3::Z).unwrap();
        let alone = cold.z / cold.length_squared();
        assert!(mixture.drives[0] == 0.0 && (mixture.drives[1] - alone).abs() < 1e-6, "{mixture:?}, expected {alone}");
        // If a colour is too bright for the bounded drives, all drives are at their maximum.
        let bounded = mix_primaries(&[warm, cold], 1.0, (warm + cold) * 10.0).unwrap();
        assert_eq!((bounded.drives, bounded.reached), (vec![1.0; 2], false));
        // No mixture on a fine grid of drives is nearer to the wanted colour.
        let mut rng = Rng::new(5, &[]);
        for _ in 0..20 {
            let mut random = || DVec3::new(rng.next_f64(), rng.next_f64(), rng.next_f64());
            let (primaries, wanted) = ([random(), random(), random()], random() * 2.0);
            let mixture = mix_primaries(&primaries, 1.0, wanted).unwrap();
            let miss = (mixture.colour - wanted).length();
            const N: usize = 20;
            let nearest = (0..=N * (N + 1) * (N + 1) + N * (N + 1) + N)
                .map(|i| [i % (N + 1), i / (N + 1) % (N + 1), i / (N + 1) / (N + 1)].map(|d| d as f64 / N as f64))
                .map(|d| (primaries[0] * d[0] + primaries[1] * d[1] + primaries[2] * d[2] - wanted).length())
                .fold(f64::INFINITY, f64::min);
            assert!(miss <= nearest + 1e-9 && miss > nearest - 0.1, "{miss} {nearest}");
        }
    }

    #[test]
    fn bad_primaries_are_refused() {
        let refused =
            |primaries: &[DVec3], max_drive, wanted| mix_primaries(primaries, max_drive, wanted).unwrap_err().kind;
        assert_eq!(refused(&[], 1.0, DVec3::ONE), ErrorKind::InvalidArgument);
        assert_eq!(refused(&[DVec3::NAN], 1.0, DVec3::ONE), ErrorKind::InvalidArgument);
        assert_eq!(refused(&[DVec3::ONE], -1.0, DVec3::ONE), ErrorKind::InvalidArgument);
        assert_eq!(refused(&[DVec3::ONE], 1.0, -DVec3::ONE), ErrorKind::InvalidArgument);
        assert_eq!(refused(&[DVec3::ZERO; 3], 1.0, DVec3::ONE), ErrorKind::Degenerate);
    }
}
