//! A luminaire's luminous intensity distribution in C planes: the content of luminaire files.

use super::opening::Opening;
use crate::error::{Error, Result};
use crate::maths;

/// A luminous intensity distribution in C planes (CIE 121). `γ` runs from 0° (straight down) to 180° (straight up),
/// and `C` turns around the vertical axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Luminaire {
    pub name: String,
    pub manufacturer: String,
    /// Vertical angles γ in degrees, ascending, within `[0, 180]`.
    pub gammas: Vec<f64>,
    /// Angles C of the planes in degrees, ascending from 0 to below 360. They cover the full circle, without implied
    /// symmetry; a single plane holds for all angles C.
    pub planes: Vec<f64>,
    /// Intensities in candela: for each plane in turn, one per vertical angle.
    pub candela: Vec<f64>,
    /// Rated flux of the lamps in lumens; 0 if the intensities are absolute (absolute photometry).
    pub lamp_flux: f64,
    /// Electric power in watts, including the ballast; 0 if unknown.
    pub watts: f64,
    /// Correlated colour temperature in kelvin; 0 if unknown.
    pub temperature: f64,
    /// General colour rendering index Ra; 0 if unknown.
    pub rendering: f64,
    /// Size of the luminous opening in metres along C = 0, along C = 90 and along the axis. As in IES, a negative
    /// value is the diameter of a round opening.
    pub size: [f64; 3],
    /// Heights in metres of the luminous sides of a box that face towards C = 0, 90, 180 and 270; `None` if all sides
    /// are luminous up to the full height.
    pub side_heights: Option<[f64; 4]>,
}

/// A luminaire file that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    pub luminaire: Luminaire,
    /// Number of variants of the product in the file. It is 1 for all formats but GLDF.
    pub variants: usize,
    /// Number of light emitters whose distributions were added up. It is 1 for IES and EULUMDAT.
    pub emitters: usize,
}

impl Luminaire {
    /// A Lambertian disc or panel that emits `flux` lumens downwards: `I = flux / π · cos γ`.
    pub fn lambertian(name: &str, flux: f64, size: [f64; 3]) -> Self {
        let gammas: Vec<f64> = (0..=36).map(|i| f64::from(i) * 2.5).collect();
        let top = flux / std::f64::consts::PI;
        let candela = gammas.iter().map(|g| if *g < 90.0 { top * maths::cos(g.to_radians()) } else { 0.0 }).collect();
        Self {
            name: name.into(),
            manufacturer: String::new(),
            gammas,
            planes: vec![0.0],
            candela,
            lamp_flux: flux,
            watts: 0.0,
            temperature: 0.0,
            rendering: 0.0,
            size,
            side_heights: None,
        }
    }

    /// Returns the luminous opening; `None` if the luminaire states no size and therefore is a point.
    pub fn opening(&self) -> Option<Opening> {
        Opening::new(self.size, self.side_heights)
    }

    /// Returns the sides in metres of the box around the opening, along C = 0, along C = 90 and along the axis.
    pub fn bounds(&self) -> [f64; 3] {
        match self.opening() {
            Some(Opening::Box { size, .. } | Opening::Ellipsoid(size)) => size.to_array(),
            Some(Opening::Cylinder { axis, length, diameters }) => {
                let mut sides = [length; 3];
                sides[(axis + 1) % 3] = diameters[0];
                sides[(axis + 2) % 3] = diameters[1];
                sides
            }
            None => [0.0; 3],
        }
    }

    /// Checks the distribution for consistency.
    ///
    /// # Errors
    /// `Format` if angles are not ascending or out of range, or if values are negative, not finite or of the wrong
    /// number.
    pub fn check(&self) -> Result<()> {
        let ascending = |angles: &[f64]| angles.windows(2).all(|w| w[0] < w[1]) && angles.iter().all(|a| a.is_finite());
        let (gammas, planes) = (&self.gammas, &self.planes);
        if gammas.is_empty() || !ascending(gammas) || gammas[0] < 0.0 || gammas[gammas.len() - 1] > 180.0 {
            return Err(Error::format("the vertical angles must ascend within [0, 180] degrees"));
        }
        if planes.is_empty() || !ascending(planes) || planes[0] != 0.0 || planes[planes.len() - 1] >= 360.0 {
            return Err(Error::format("the C planes must ascend from 0 to below 360 degrees"));
        }
        if self.candela.len() != gammas.len() * planes.len() {
            return Err(Error::format(format!(
                "there are {} intensities for {} planes of {} angles",
                self.candela.len(),
                planes.len(),
                gammas.len()
            )));
        }
        match self.candela.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
            Some(v) => Err(Error::format(format!("an intensity is {v} cd; it must be finite and not negative"))),
            None => Ok(()),
        }
    }

    /// Returns the intensity in candela for the angles `c` and `gamma` in degrees. It is interpolated linearly between
    /// vertical angles and between planes, and 0 outside the measured vertical angles.
    pub fn intensity(&self, c: f64, gamma: f64) -> f64 {
        let n = self.gammas.len();
        let last = self.gammas[n - 1];
        if !(gamma >= self.gammas[0] && gamma <= last) {
            return 0.0;
        }
        let upper = self.gammas.partition_point(|g| *g < gamma).clamp(1.min(n - 1), n - 1);
        let lower = upper.saturating_sub(1);
        let span = self.gammas[upper] - self.gammas[lower];
        let t = if span > 0.0 { (gamma - self.gammas[lower]) / span } else { 0.0 };
        let in_plane = |plane: usize| {
            let values = &self.candela[plane * n..][..n];
            values[lower] + (values[upper] - values[lower]) * t
        };
        // Find the planes on both sides of `c`; the last plane is followed by the first.
        let m = self.planes.len();
        let c = c.rem_euclid(360.0);
        let before = self.planes.partition_point(|p| *p <= c).clamp(1, m) - 1;
        let after = (before + 1) % m;
        let gap = (self.planes[after] - self.planes[before]).rem_euclid(360.0);
        let s = if gap > 0.0 { (c - self.planes[before]).rem_euclid(360.0) / gap } else { 0.0 };
        in_plane(before) + (in_plane(after) - in_plane(before)) * s
    }

    /// Returns the angle γ in degrees beyond which the luminaire emits no light.
    pub fn max_gamma(&self) -> f64 {
        let n = self.gammas.len();
        let first_dark = (0..n).rev().take_while(|i| self.is_dark_at(*i)).last().unwrap_or(n);
        self.gammas[first_dark.min(n - 1)]
    }

    /// Returns the angle γ in degrees below which the luminaire emits no light.
    pub fn min_gamma(&self) -> f64 {
        let dark = (0..self.gammas.len()).take_while(|i| self.is_dark_at(*i)).last();
        self.gammas[dark.unwrap_or(0)]
    }

    /// Whether the intensity at a vertical angle, given by its index, is 0 in all planes.
    fn is_dark_at(&self, gamma: usize) -> bool {
        self.candela.iter().skip(gamma).step_by(self.gammas.len()).all(|v| *v == 0.0)
    }

    /// Luminous flux in lumens: the integral of the intensity over the sphere. It is exact if the intensity is linear
    /// between the vertical angles and between the planes.
    pub fn flux(&self) -> f64 {
        let (n, m) = (self.gammas.len(), self.planes.len());
        // Share of the circle that each plane represents: half the gaps to its neighbours.
        let share = |plane: usize| {
            let gap = |from: usize, to: usize| match (self.planes[to] - self.planes[from]).rem_euclid(360.0) {
                0.0 => 360.0,
                gap => gap,
            };
            (gap((plane + m - 1) % m, plane) + gap(plane, (plane + 1) % m)) / 2.0 / 360.0
        };
        let mut total = 0.0;
        for plane in 0..m {
            let values = &self.candela[plane * n..][..n];
            let zones = values.windows(2).zip(self.gammas.windows(2));
            let around: f64 = zones.map(|(i, g)| zone(i, [g[0].to_radians(), g[1].to_radians()])).sum();
            total += around * share(plane);
        }
        2.0 * std::f64::consts::PI * total
    }
}

/// Computes `∫ I(γ) sin γ dγ` between two angles in radians, for `I` linear between them.
fn zone(intensity: &[f64], [a, b]: [f64; 2]) -> f64 {
    let slope = (intensity[1] - intensity[0]) / (b - a);
    let at = |g: f64, i: f64| slope * maths::sin(g) - i * maths::cos(g);
    at(b, intensity[1]) - at(a, intensity[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    #[test]
    fn flux_meets_closed_forms() {
        // An intensity of 1 cd in all directions gives 4π lm, for any sampling angles.
        let even = Luminaire {
            gammas: vec![0.0, 17.0, 90.0, 180.0],
            planes: vec![0.0, 10.0, 200.0],
            candela: vec![1.0; 12],
            ..Luminaire::lambertian("", 0.0, [0.0; 3])
        };
        assert!((even.flux() / (4.0 * PI) - 1.0).abs() < 1e-12);
        // A Lambertian disc sampled every 2.5 degrees.
        let disc = Luminaire::lambertian("disc", 1000.0, [0.0; 3]);
        assert!((disc.flux() / 1000.0 - 1.0).abs() < 1e-3, "{}", disc.flux());
        assert_eq!((disc.max_gamma(), even.max_gamma()), (90.0, 180.0));
        assert_eq!((disc.min_gamma(), even.min_gamma()), (0.0, 0.0));
        let upwards = Luminaire {
            gammas: vec![0.0, 60.0, 95.0, 180.0],
            candela: vec![0.0, 0.0, 1.0, 0.0],
            ..Luminaire::lambertian("", 0.0, [0.0; 3])
        };
        assert_eq!((upwards.min_gamma(), upwards.max_gamma()), (60.0, 180.0));
        assert!((disc.intensity(123.0, 60.0) - 500.0 / PI).abs() < 1e-6);
        assert_eq!(disc.intensity(0.0, 120.0), 0.0);
    }

    #[test]
    fn planes_are_interpolated_around_the_circle() {
        let planes = Luminaire {
            gammas: vec![0.0, 90.0],
            planes: vec![0.0, 90.0, 180.0, 270.0],
            candela: vec![5.0, 1.0, 5.0, 2.0, 5.0, 3.0, 5.0, 4.0],
            ..Luminaire::lambertian("", 0.0, [0.0; 3])
        };
        planes.check().unwrap();
        assert!((planes.intensity(45.0, 90.0) - 1.5).abs() < 1e-12);
        assert!((planes.intensity(315.0, 90.0) - 2.5).abs() < 1e-12);
        assert!((planes.intensity(-45.0, 45.0) - 3.75).abs() < 1e-12);
        assert!(Luminaire { planes: vec![0.0, 0.0, 1.0, 2.0], ..planes.clone() }.check().is_err());
        assert!(Luminaire { candela: vec![1.0; 7], ..planes.clone() }.check().is_err());
        assert!(Luminaire { candela: vec![-1.0; 8], ..planes }.check().is_err());
    }
}
