//! The sum of several distributions, for luminaires with several emitters.

use super::luminaire::Luminaire;
use super::text_lines::{MAX_ANGLES, MAX_VALUES};
use crate::error::{Error, Result};
use crate::image::try_vec;

/// Maximum number of distributions of a sum. [convention]
pub const MAX_PARTS: usize = 64;
/// A distribution is dark outside its own vertical angles. In the sum, its intensity falls to 0 within this many
/// degrees beyond its first and last angle. [convention]
const STEP: f64 = 1e-3;

/// Adds distributions up. The sum contains the angles of all parts, so that it is exact wherever the parts are
/// interpolated linearly. It has the name and the manufacturer of the first part, and the opening of the part with the
/// largest opening. Power is added up; colour temperature and colour rendering are kept only if all parts agree.
///
/// # Errors
/// `Format` if there are too many parts or too many angles.
pub fn sum(mut parts: Vec<Luminaire>) -> Result<Luminaire> {
    if parts.is_empty() || parts.len() > MAX_PARTS {
        let message = format!("the luminaire has {} light-emitting parts; it must have 1 to {MAX_PARTS}", parts.len());
        return Err(Error::format(message));
    }
    if parts.len() == 1 {
        return Ok(parts.remove(0));
    }
    let planes = merged(parts.iter().flat_map(|part| part.planes.iter().copied()).collect(), "C planes")?;
    let gammas = merged(parts.iter().flat_map(vertical).collect(), "vertical angles")?;
    if planes.len() * gammas.len() > MAX_VALUES {
        let (planes, gammas) = (planes.len(), gammas.len());
        let message = format!("the sum has {planes} x {gammas} intensities; at most {MAX_VALUES} are read");
        return Err(Error::format(message));
    }
    let mut candela = try_vec(planes.len() * gammas.len(), 0.0)?;
    for (row, c) in candela.chunks_mut(gammas.len()).zip(&planes) {
        for (value, gamma) in row.iter_mut().zip(&gammas) {
            *value = parts.iter().map(|part| part.intensity(*c, *gamma)).sum();
        }
    }
    let area = |part: &Luminaire| part.opening().map_or(0.0, |opening| opening.largest_area());
    let largest = parts.iter().rev().max_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or(&parts[0]);
    let total = |value: fn(&Luminaire) -> f64| parts.iter().map(value).sum();
    let common = |value: fn(&Luminaire) -> f64| {
        let first = value(&parts[0]);
        if parts.iter().all(|part| value(part) == first) { first } else { 0.0 }
    };
    let is_relative = parts.iter().all(|part| part.lamp_flux > 0.0);
    Ok(Luminaire {
        name: parts[0].name.clone(),
        manufacturer: parts[0].manufacturer.clone(),
        gammas,
        planes,
        candela,
        lamp_flux: if is_relative { total(|part| part.lamp_flux) } else { 0.0 },
        watts: total(|part| part.watts),
        temperature: common(|part| part.temperature),
        rendering: common(|part| part.rendering),
        size: largest.size,
        side_heights: largest.side_heights,
    })
}

/// The vertical angles of a part, and the angles [`STEP`] below the first and above the last, at which the part is
/// dark.
fn vertical(part: &Luminaire) -> impl Iterator<Item = f64> {
    let outside = [part.gammas[0] - STEP, part.gammas[part.gammas.len() - 1] + STEP];
    part.gammas.iter().copied().chain(outside.into_iter().filter(|gamma| (0.0..=180.0).contains(gamma)))
}

fn merged(mut angles: Vec<f64>, what: &str) -> Result<Vec<f64>> {
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    if angles.len() > MAX_ANGLES {
        return Err(Error::format(format!("the sum has {} {what}; at most {MAX_ANGLES} are read", angles.len())));
    }
    Ok(angles)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A direct part with rotational symmetry, and an indirect part with three planes at other angles.
    #[test]
    fn a_sum_has_the_intensities_and_the_flux_of_its_parts() {
        let down = Luminaire { watts: 10.0, ..Luminaire::lambertian("down", 1000.0, [0.3, 0.3, 0.0]) };
        let up = Luminaire {
            planes: vec![0.0, 70.0, 200.0],
            gammas: vec![95.0, 120.0, 180.0],
            candela: vec![10.0, 30.0, 50.0, 20.0, 40.0, 50.0, 0.0, 80.0, 50.0],
            watts: 5.0,
            ..Luminaire::lambertian("up", 0.0, [0.6, 0.3, 0.0])
        };
        let both = sum(vec![down.clone(), up.clone()]).unwrap();
        both.check().unwrap();
        for (c, gamma) in [(0.0, 0.0), (12.0, 33.3), (70.0, 89.0), (71.0, 100.0), (300.0, 150.0), (200.0, 180.0)] {
            let want = down.intensity(c, gamma) + up.intensity(c, gamma);
            assert!((both.intensity(c, gamma) - want).abs() < 1e-9, "{c} {gamma}");
        }
        let flux = down.flux() + up.flux();
        assert!((both.flux() / flux - 1.0).abs() < 1e-5, "{} {flux}", both.flux());
        assert_eq!((both.watts, both.lamp_flux, both.size), (15.0, 0.0, up.size));
        assert_eq!(sum(vec![up.clone()]).unwrap(), up);
        assert!(sum(Vec::new()).is_err() && sum(vec![up; MAX_PARTS + 1]).is_err());
    }
}
