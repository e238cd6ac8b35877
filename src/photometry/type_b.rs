//! Converts type B photometry, in which floodlights are measured, to type C (CIE 121; IES LM-75).
//!
//! The polar axis of type B lies across the beam. The vertical angle V turns about this axis. The horizontal angle H is
//! the angle between the direction and the plane perpendicular to this axis. The beam's direction, V = H = 0, becomes
//! γ = 0. As seen from behind the floodlight, V goes up and H to the right; "up" becomes C = 0, and so "right" becomes
//! C = 270. The program Radiance uses the same axes. A direction with the components x, y and z along C = 0, along
//! C = 90 and along the beam has `V = atan2(x, z)` and `H = -asin(y)`.
//!
//! Intensities are interpolated linearly in V and H, and 0 outside the measured angles.

use crate::error::{Error, Result};
use crate::image::try_vec;
use crate::maths;

/// Minimum and maximum of the step of γ and C, in degrees. Within this range, the step is the smallest step of the
/// file's angles. [convention]
const STEPS: [f64; 2] = [0.5, 2.5];
/// Minimum distance between neighbouring angles γ, in degrees. [convention]
const MIN_GAP: f64 = 0.1;
/// Angles that exceed the measured range by at most this many degrees count as the end of the range. [rounding]
const ROUNDING: f64 = 1e-9;

/// A distribution in type C: the angles γ, the angles C, and the intensities plane by plane.
pub type TypeC = (Vec<f64>, Vec<f64>, Vec<f64>);

/// Resamples a distribution of type B at angles of type C. `candela` holds, for each horizontal angle in turn, one
/// intensity per vertical angle. Angles are in degrees. If `vertical` or `horizontal` starts at 0, the distribution is
/// symmetric about 0 in this angle.
///
/// # Errors
/// `Format` if angles do not ascend or are out of range, or if an intensity is negative.
pub fn to_type_c(vertical: &[f64], horizontal: &[f64], candela: &[f64]) -> Result<TypeC> {
    check(vertical, "vertical", 180.0)?;
    check(horizontal, "horizontal", 90.0)?;
    // Check the intensities before the interpolation, which would hide a negative intensity beside larger ones.
    if let Some(negative) = candela.iter().find(|v| **v < 0.0) {
        return Err(Error::format(format!("an intensity is {negative}; it must be at least 0")));
    }
    let [low, high] = STEPS;
    let gap = |angles: &[f64]| angles.windows(2).map(|w| w[1] - w[0]).fold(high, f64::min);
    let step = gap(vertical).min(gap(horizontal)).max(low);
    let quarter = (90.0 / step).ceil();
    let at = |i: usize| 90.0 * i as f64 / quarter;
    let is_behind = vertical.iter().any(|v| v.abs() > 90.0);
    let count = quarter as usize * if is_behind { 2 } else { 1 };

    // Add the angles of the file to the angles γ, because narrow beams are measured in small steps.
    let end = at(count);
    let own = vertical.iter().chain(horizontal).map(|a| a.abs()).filter(|a| *a < end - MIN_GAP);
    let mut gammas: Vec<f64> = (0..count).map(at).chain(own).collect();
    gammas.sort_by(f64::total_cmp);
    gammas.dedup_by(|next, kept| *next - *kept < MIN_GAP);
    gammas.push(end);
    let planes: Vec<f64> = (0..4 * quarter as usize).map(at).collect();

    let mut values = try_vec(gammas.len() * planes.len(), 0.0)?;
    for (row, c) in values.chunks_exact_mut(gammas.len()).zip(&planes) {
        for (value, gamma) in row.iter_mut().zip(&gammas) {
            let [v, h] = angles(*c, *gamma);
            *value = interpolate(vertical, horizontal, candela, [v, h]);
        }
    }
    Ok((gammas, planes, values))
}

fn check(angles: &[f64], name: &str, most: f64) -> Result<()> {
    if angles.len() < 2 || angles.windows(2).any(|w| w[0] >= w[1]) {
        return Err(Error::format(format!("the {name} angles of type B must be at least two and ascend")));
    }
    let (first, last) = (angles[0], angles[angles.len() - 1]);
    if first > 0.0 || last <= 0.0 || first < -most || last > most {
        return Err(Error::format(format!(
            "the {name} angles of type B go from {first} to {last}; they must go from 0 or a negative angle to a \
             positive angle, within [-{most}, {most}]"
        )));
    }
    Ok(())
}

/// Returns V and H in degrees of a direction of type C.
fn angles(c: f64, gamma: f64) -> [f64; 2] {
    let ((sin_c, cos_c), (sine, cosine)) = (maths::sin_cos(c.to_radians()), maths::sin_cos(gamma.to_radians()));
    [maths::atan2(sine * cos_c, cosine).to_degrees(), -maths::asin((sine * sin_c).clamp(-1.0, 1.0)).to_degrees()]
}

/// Returns the intensity at V and H.
fn interpolate(vertical: &[f64], horizontal: &[f64], candela: &[f64], [v, h]: [f64; 2]) -> f64 {
    let (Some((row, s)), Some((column, t))) = (place(vertical, v), place(horizontal, h)) else { return 0.0 };
    let at = |row: usize, column: usize| candela[column * vertical.len() + row];
    let mix = |column: usize| at(row, column) * (1.0 - s) + at(row + 1, column) * s;
    mix(column) * (1.0 - t) + mix(column + 1) * t
}

/// Returns the index of the interval of `list` that contains `angle`, and the position of `angle` in this interval,
/// from 0 to 1; `None` if `angle` lies outside the list. If the list starts at 0, uses the magnitude of `angle`.
fn place(list: &[f64], angle: f64) -> Option<(usize, f64)> {
    let (first, last) = (list[0], list[list.len() - 1]);
    let angle = if first == 0.0 { angle.abs() } else { angle };
    if !(angle >= first - ROUNDING && angle <= last + ROUNDING) {
        return None;
    }
    let index = list.partition_point(|a| *a <= angle).clamp(1, list.len() - 1) - 1;
    Some((index, ((angle - list[index]) / (list[index + 1] - list[index])).clamp(0.0, 1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::Luminaire;
    use std::f64::consts::PI;

    fn range(from: i32, to: i32, step: f64) -> Vec<f64> {
        (from..=to).map(|i| f64::from(i) * step).collect()
    }

    /// Samples an intensity, a function of the unit direction (x, y, z), at angles of type B, and converts it.
    fn converted(vertical: &[f64], horizontal: &[f64], intensity: impl Fn([f64; 3]) -> f64) -> Luminaire {
        let mut candela = Vec::new();
        for h in horizontal.iter().map(|h| h.to_radians()) {
            for v in vertical.iter().map(|v| v.to_radians()) {
                candela.push(intensity([h.cos() * v.sin(), -h.sin(), h.cos() * v.cos()]));
            }
        }
        let (gammas, planes, candela) = to_type_c(vertical, horizontal, &candela).unwrap();
        let luminaire = Luminaire { gammas, planes, candela, ..Luminaire::lambertian("", 0.0, [0.0; 3]) };
        luminaire.check().unwrap();
        luminaire
    }

    fn direction(c: f64, gamma: f64) -> [f64; 3] {
        let (c, gamma) = (c.to_radians(), gamma.to_radians());
        [gamma.sin() * c.cos(), gamma.sin() * c.sin(), gamma.cos()]
    }

    /// Powers of the cosine, `I = cos^n γ`, have the flux 2π / (n + 1).
    #[test]
    fn powers_of_the_cosine_keep_their_flux_and_shape() {
        for (n, step) in [(1, 5.0f64), (1, 2.5), (8, 2.5), (60, 1.0), (400, 0.5)] {
            // Linear interpolation of cos^n in steps of h is off by at most n h² / 8. There are three interpolations:
            // in V, in H and in γ.
            let tolerance = 3.0 * f64::from(n) * step.to_radians().powi(2) / 8.0;
            let list = range(-(90.0 / step) as i32, (90.0 / step) as i32, step);
            let found = converted(&list, &list, |[.., z]| z.max(0.0).powi(n));
            let flux = found.flux() * f64::from(n + 1) / (2.0 * PI);
            assert!((flux - 1.0).abs() < tolerance, "{n}: {flux}");
            for (c, gamma) in [(0.0, 0.0), (17.0, 3.0), (90.0, 12.0), (203.0, 33.3), (301.0, 71.0), (45.0, 89.0)] {
                let exact = direction(c, gamma)[2].powi(n);
                assert!((found.intensity(c, gamma) - exact).abs() < tolerance, "{n} {c} {gamma}");
            }
            assert_eq!(found.intensity(10.0, 95.0), 0.0);
        }
    }

    /// A fan beam: wide and shifted to the right in H, narrow and shifted upwards in V. Up is C = 0, right is C = 270.
    #[test]
    fn beams_point_where_the_file_says() {
        let beam = |[x, y, z]: [f64; 3]| {
            let (v, h) = (x.atan2(z).to_degrees(), (-y).asin().to_degrees());
            1000.0 * (-((v - 10.0) / 6.0).powi(2) - ((h - 20.0) / 25.0).powi(2)).exp()
        };
        let found = converted(&range(-90, 90, 1.0), &range(-36, 36, 2.5), beam);
        for c in (0..360).step_by(7) {
            for gamma in (0..90).step_by(4) {
                let (c, gamma) = (f64::from(c), f64::from(gamma));
                let (is, exact) = (found.intensity(c, gamma), beam(direction(c, gamma)));
                assert!((is - exact).abs() < 15.0, "{c} {gamma}: {is} {exact}");
            }
        }
        // The direction 10° upwards is (C, γ) = (0, 10); the direction 20° to the right is (270, 20).
        assert!(found.intensity(0.0, 10.0) > 500.0 && found.intensity(180.0, 10.0) < 10.0);
        assert!(found.intensity(270.0, 20.0) > 2.0 * found.intensity(90.0, 20.0));
    }

    /// A file whose angles start at 0 gives the same distribution as the symmetric file of the full range. A file with
    /// vertical angles beyond 90° also emits behind the floodlight.
    #[test]
    fn symmetric_and_backward_files() {
        let even = |[x, y, z]: [f64; 3]| 10.0 + 5.0 * z + x * x + 2.0 * y * y;
        let (full, half) = (range(-36, 36, 2.5), range(0, 36, 2.5));
        let want = converted(&full, &full, even);
        for (vertical, horizontal) in [(&half, &full), (&full, &half), (&half, &half)] {
            let found = converted(vertical, horizontal, even);
            assert_eq!((&found.gammas, &found.planes), (&want.gammas, &want.planes));
            assert!(found.candela.iter().zip(&want.candela).all(|(a, b)| (a - b).abs() < 1e-9));
        }
        let all = converted(&range(-72, 72, 2.5), &full, |_| 1.0);
        assert!((all.flux() / (4.0 * PI) - 1.0).abs() < 1e-9 && all.gammas.last() == Some(&180.0));
        let part = converted(&range(-8, 8, 2.5), &range(-8, 8, 2.5), |_| 1.0);
        // The range -20° to 20° of both angles covers (2 × 20° in radians) × 2 sin 20° steradians.
        let solid_angle = 40f64.to_radians() * 2.0 * 20f64.to_radians().sin();
        // Interpolation spreads the edge of the range over a step of γ and C, so allow 5 %.
        assert!((part.flux() / solid_angle - 1.0).abs() < 0.05, "{} {solid_angle}", part.flux());
        assert_eq!((part.intensity(0.0, 19.0), part.intensity(0.0, 24.0)), (1.0, 0.0));
    }

    #[test]
    fn impossible_angles_are_refused_and_large_files_stay_bounded() {
        let says = |vertical: &[f64], horizontal: &[f64], what: &str| {
            let candela = vec![1.0; vertical.len() * horizontal.len()];
            let error = to_type_c(vertical, horizontal, &candela).unwrap_err();
            assert!(error.message.contains(what), "{error}");
        };
        let good = [-90.0, 0.0, 90.0];
        says(&[0.0], &good, "the vertical angles of type B must be at least two");
        says(&good, &[0.0, 0.0], "the horizontal angles of type B must be at least two and ascend");
        says(
            &good,
            &[10.0, 90.0],
            "the horizontal angles of type B go from 10 to 90; they must go from 0 or a negative",
        );
        says(&good, &[-90.0, -10.0], "from -90 to -10");
        says(&good, &[-90.0, 91.0], "within [-90, 90]");
        says(&[-181.0, 90.0], &good, "within [-180, 180]");
        let fine: Vec<f64> = (0..4096).map(|i| f64::from(i) / 4095.0 * 180.0).collect();
        let narrow: Vec<f64> = (0..1024).map(|i| f64::from(i) / 1023.0 * 1e-3).collect();
        let (gammas, planes, candela) = to_type_c(&fine, &narrow, &vec![1.0; 4096 * 1024]).unwrap();
        assert!(gammas.len() * planes.len() == candela.len() && candela.len() < 1 << 21);
        assert!(gammas.windows(2).all(|w| w[1] - w[0] >= MIN_GAP - 1e-9));
    }

    #[test]
    fn the_angles_end_exactly_for_every_step() {
        for quarter in 36..=180 {
            let vertical = [-180.0, 0.0, 90.0 / f64::from(quarter), 180.0];
            let (gammas, planes, candela) = to_type_c(&vertical, &[-90.0, 0.0, 90.0], &[1.0; 12]).unwrap();
            assert_eq!(gammas[gammas.len() - 1], 180.0, "{quarter}");
            assert!(candela.iter().all(|v| (v - 1.0).abs() < 1e-9), "{quarter}");
            Luminaire { gammas, planes, candela, ..Luminaire::lambertian("", 0.0, [0.0; 3]) }.check().unwrap();
        }
    }

    #[test]
    fn negative_intensities_are_refused() {
        let error = to_type_c(&[-90.0, 0.0, 90.0], &[0.0, 90.0], &[100.0, 100.0, 100.0, 100.0, -5.0, 100.0]);
        assert!(error.unwrap_err().message.contains("an intensity is -5"));
    }
}
