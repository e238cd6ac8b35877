//! Lists the lamps of a texture for lighting software: centre, size, colour, flux share, outline and kind.

use super::coverage::{Coverage, LampCoverage};
use super::kinds;
use super::luminaire::Luminaire;
use super::outline::Ring;
use crate::emission::exemplar::components::{self, Component, Components};
use crate::error::Result;
use crate::image::Image;
use crate::image::colour::luminance;
use crate::job::Job;
use crate::maths;
use glam::{DVec2, DVec3};

/// The 8-connected components of the texels at which `mask` is at least 0.5.
pub fn components(mask: &Image) -> Result<Components> {
    components::find(mask.width, mask.height, |i| mask.data[i] >= 0.5)
}

/// Measures each component in `found`, the connected lights of `texture`, and returns it as a luminaire. The luminaires
/// have the order of `found`.
pub fn find(texture: &Image, found: &Components, coverage: Coverage, job: Job) -> Result<Vec<Luminaire>> {
    let lights = LampCoverage::new(found, coverage, texture.width, texture.height)?;
    let lamps: Result<Vec<Luminaire>> = (1..)
        .zip(&found.list)
        .map(|(label, lamp)| {
            job.check()?;
            Ok(measure(label, lamp, texture, &lights))
        })
        .collect();
    let mut lamps = lamps?;
    let total: f64 = lamps.iter().map(|lamp| lamp.flux_share).sum();
    lamps.iter_mut().for_each(|lamp| lamp.flux_share = if total > 0.0 { lamp.flux_share / total } else { 0.0 });
    number_kinds(&mut lamps, texture);
    Ok(lamps)
}

/// Groups the lamps of a texture into kinds. Lamps that the border cuts get kind 0.
pub fn number_kinds(lamps: &mut [Luminaire], texture: &Image) {
    let size = DVec2::new(texture.width as f64, texture.height as f64);
    kinds::number(lamps.iter_mut().map(|lamp| {
        let count = usize::from(lamp.is_within(size));
        (lamp, count)
    }));
}

/// Measures the lamp with number `label`. Its `flux_share` is provisional: the mean luminance times the number of
/// texels. The caller divides this product by its sum over all lamps.
fn measure(label: u32, lamp: &Component, texture: &Image, lights: &LampCoverage) -> Luminaire {
    let [low, high] = [lamp.min, lamp.max].map(|p| p.map(|v| v as isize));
    let is_in = |at: [isize; 2]| lights.label(at) == Some(label);

    // Sum up the area and the first and second moments of the light, including partly lit texels at its edge.
    // Positions are relative to the corner of the lamp's bounding box, so that equal lamps get bit-identical results
    // anywhere in the texture.
    let (mut area, mut sum, mut squares, mut colour) = (0.0, DVec2::ZERO, DVec3::ZERO, DVec3::ZERO);
    for y in low[1]..=high[1] {
        for x in (low[0]..=high[0]).filter(|&x| is_in([x, y])) {
            lights.parts([x, y], |[u, v], part| {
                let p = DVec2::new((x + u - low[0]) as f64, (y + v - low[1]) as f64) + 0.5;
                area += part;
                sum += p * part;
                squares += DVec3::new(p.x * p.x, p.x * p.y, p.y * p.y) * part;
            });
            colour += texture.rgb(x as usize, y as usize).as_dvec3();
        }
    }
    let centre = sum / area;
    let moments = squares - DVec3::new(centre.x * centre.x, centre.x * centre.y, centre.y * centre.y) * area;
    let orientation = orientation(moments.to_array());
    colour /= lamp.area as f64;

    let ring = Ring::walk(lamp, &is_in, &|at| lights.coverage(at));
    let (outline, size) =
        ring.outline(maths::direction_at(orientation), DVec2::new(texture.width as f64, texture.height as f64));
    Luminaire {
        centre: DVec2::new(low[0] as f64, low[1] as f64) + centre,
        size,
        orientation,
        area,
        colour: colour.as_vec3(),
        flux_share: f64::from(luminance(colour.as_vec3())) * lamp.area as f64,
        outline,
        kind: 0,
    }
}

/// The angle from x of the axis along which an area has the largest variance, in radians, in (-π/2, π/2]; 0 if the
/// variance is equal in all directions. The argument holds the central second moments of the area.
pub fn orientation([xx, xy, yy]: [f64; 3]) -> f64 {
    let (difference, cross) = (xx - yy, 2.0 * xy);
    let anisotropy = maths::hypot(difference, cross);
    let angle = if anisotropy > 1e-6 * (xx + yy) { 0.5 * maths::atan2(cross, difference) } else { 0.0 };
    // -π/2 and π/2 are the same axis. Rounding may produce either, so return π/2 for both.
    if angle <= -std::f64::consts::FRAC_PI_2 + 1e-12 { angle + std::f64::consts::PI } else { angle }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::polygon;
    use crate::job::Monitor;
    use glam::Vec3;

    fn lamps(width: usize, height: usize, inside: impl Fn(f64, f64) -> bool) -> Vec<Luminaire> {
        let on = |x: usize, y: usize| inside(x as f64 + 0.5, y as f64 + 0.5);
        let mask = Image::from_fn(width, height, |x, y| [f32::from(on(x, y))]).unwrap();
        let texture = Image::from_fn(width, height, |x, y| [2.0, 1.0, 0.5].map(|v| v * f32::from(on(x, y)))).unwrap();
        find(&texture, &components(&mask).unwrap(), &|i| mask.data[i], Monitor::default().job()).unwrap()
    }

    #[test]
    fn a_rectangle_is_measured_exactly() {
        let found = lamps(40, 30, |x, y| (5.0..25.0).contains(&x) && (8.0..18.0).contains(&y));
        assert_eq!(found.len(), 1);
        let lamp = &found[0];
        assert_eq!((lamp.centre, lamp.size, lamp.orientation), (DVec2::new(15.0, 13.0), DVec2::new(20.0, 10.0), 0.0));
        assert_eq!((lamp.area, lamp.colour), (200.0, Vec3::new(2.0, 1.0, 0.5)));
        assert!((lamp.flux_share - 1.0).abs() < 1e-6);
        assert_eq!(lamp.outline.len(), 4);
        assert_eq!(polygon::area(&lamp.outline), 200.0);
        let upright = lamps(30, 40, |x, y| (5.0..8.0).contains(&x) && (8.0..38.0).contains(&y));
        assert!((upright[0].orientation - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
        assert!((upright[0].size - DVec2::new(30.0, 3.0)).length() < 1e-9);
    }

    #[test]
    fn a_turned_ellipse_keeps_its_angle_axes_and_area() {
        let (angle, a, b) = (0.5f64, 60.0, 25.0);
        let found = lamps(160, 160, |x, y| {
            let d = DVec2::from_angle(-angle).rotate(DVec2::new(x - 80.0, y - 80.0));
            (d.x / a).powi(2) + (d.y / b).powi(2) <= 1.0
        });
        let lamp = &found[0];
        assert!((lamp.orientation - angle).abs() < 0.01, "{}", lamp.orientation);
        assert!((lamp.size - DVec2::new(2.0 * a, 2.0 * b)).abs().max_element() < 1.5, "{}", lamp.size);
        let area = std::f64::consts::PI * a * b;
        assert!((lamp.area / area - 1.0).abs() < 0.01);
        assert!((polygon::area(&lamp.outline) / area - 1.0).abs() < 0.02);
        assert!(lamp.outline.len() < 60);
    }

    #[test]
    fn outlines_close_around_single_texels_holes_and_corner_contacts() {
        let dot = lamps(3, 3, |x, y| x == 1.5 && y == 1.5);
        assert_eq!(polygon::area(&dot[0].outline), 1.0);
        let ring = lamps(9, 9, |x, y| (x - 4.5).abs().max((y - 4.5).abs()) > 2.0);
        assert_eq!((ring.len(), polygon::area(&ring[0].outline)), (1, 81.0));
        let pair = lamps(4, 4, |x, y| (x < 2.0) == (y < 2.0));
        assert_eq!((pair.len(), polygon::area(&pair[0].outline)), (1, 8.0));
    }
}
