//! Finds the dots between the marks, where the map through the marks predicts them. A dot is a small black disk. Its
//! place is its centre of gravity: the centre of its outline lies elsewhere in a perspective view, but for a disk that
//! is so small the distance is below a hundredth of a pixel.

use super::model::PageMap;
use super::page::Page;
use crate::image::Image;
use crate::maths;
use glam::{DMat2, DVec2};

/// A dot is searched for within this distance of its predicted place, in steps of this length, in units of its radius.
/// [convention: less than the distance to the next dot; half a radius]
const REACH: f64 = 3.0;
const SEARCH_STEP: f64 = 0.5;
/// Radii of the circle inside a dot and of the circle on the paper around it, in units of the dot's radius.
/// [convention: between the outline blurred by half a radius and the nearest mark]
const INSIDE: f64 = 0.5;
const OUTSIDE: f64 = 1.9;
/// Smallest radius of a dot in pixels of the photo. [convention: smaller disks are as large as the blur of a photo]
const MIN_RADIUS: f64 = 1.5;
/// Minimum difference, in encoded brightness, between paper and dot; as for marks. [convention]
const MIN_CONTRAST: f64 = 0.12;
/// Range of the area of a dot, measured by its darkness, as a share of the area of the printed disk. [convention: blur
/// does not change it; paint that touches the dot or covers half of it does]
const AREA: std::ops::Range<f64> = 0.6..1.5;

/// Returns the place of a dot in the photo. `None` if nothing near its predicted place looks like a dot.
pub fn find(grey: &Image, page: &Page, dot: DVec2, model: &PageMap) -> Option<DVec2> {
    let at = model.apply(dot);
    let step = 0.5 * page.dot_radius;
    let [x, y] = [DVec2::X, DVec2::Y].map(|axis| model.apply(dot + step * axis) - model.apply(dot - step * axis));
    // Maps the unit disk to the dot in the photo.
    let shape = DMat2::from_cols(x, y);
    let smallest = (shape.determinant().abs() / x.length().max(y.length())).min(x.length().min(y.length()));
    let size = DVec2::new(grey.width as f64, grey.height as f64);
    let margin = (OUTSIDE + 1.0) * x.length().max(y.length());
    if !(smallest >= MIN_RADIUS && at.cmpgt(DVec2::splat(margin)).all() && at.cmplt(size - margin).all()) {
        return None;
    }
    let steps = (REACH / SEARCH_STEP) as i32;
    let shifts = (-steps..=steps).flat_map(|j| (-steps..=steps).map(move |i| DVec2::new(f64::from(i), f64::from(j))));
    let place = |shift: DVec2| at + shape * (SEARCH_STEP * shift);
    let circles = [INSIDE, OUTSIDE].map(|radius| circle(shape, radius));
    let mut best = None;
    for shift in shifts {
        let least = best.map_or(MIN_CONTRAST, |(contrast, _)| contrast);
        if let Some(contrast) = contrast(grey, place(shift), &circles, least) {
            best = Some((contrast, shift));
        }
    }
    let (_, shift) = best?;
    let mut found = place(shift);
    for _ in 0..4 {
        found = centre(grey, found, shape)?;
    }
    (found.distance(at) < (REACH + 1.0) * x.length().max(y.length())).then_some(found)
}

/// Number of places on a circle around a dot.
const STEPS: usize = 12;

/// Returns places on a circle of the given radius around the dot, relative to its centre in the photo.
fn circle(shape: DMat2, radius: f64) -> [DVec2; STEPS] {
    std::array::from_fn(|i| shape * (radius * maths::direction_at(std::f64::consts::TAU * i as f64 / STEPS as f64)))
}

/// Returns how much darker the darkest paper on the circle around a place is than the brightest point on the circle
/// inside it; `None` if this is not more than `least`.
fn contrast(grey: &Image, at: DVec2, [inside, outside]: &[[DVec2; STEPS]; 2], least: f64) -> Option<f64> {
    let value = |p: DVec2| f64::from(grey.sample(p.x, p.y, 0));
    let (mut paper, mut ink) = (f64::INFINITY, f64::NEG_INFINITY);
    for (inside, outside) in inside.iter().zip(outside) {
        ink = ink.max(value(at + *inside));
        paper = paper.min(value(at + *outside));
        if paper - ink <= least {
            return None;
        }
    }
    Some(paper - ink)
}

/// Returns the centre of gravity of the darkness around a place. The paper around the dot is a plane of brightness.
/// `None` if the darkness has not the area of a dot.
fn centre(grey: &Image, at: DVec2, shape: DMat2) -> Option<DVec2> {
    let inverse = shape.inverse();
    // On a circle, the mean and the first harmonics are the plane that fits best.
    let mut plane = [0.0; 3];
    for offset in circle(shape, OUTSIDE) {
        let (p, local) = (at + offset, inverse * offset);
        let v = f64::from(grey.sample(p.x, p.y, 0)) / STEPS as f64;
        plane[0] += v;
        plane[1] += 2.0 * v * local.x / (OUTSIDE * OUTSIDE);
        plane[2] += 2.0 * v * local.y / (OUTSIDE * OUTSIDE);
    }
    let reach = (OUTSIDE * DVec2::new(shape.row(0).length(), shape.row(1).length())).ceil();
    let (first, last) = ((at - reach).floor(), (at + reach).ceil());
    let (mut sum, mut area, mut darkest) = (DVec2::ZERO, 0.0, 0.0f64);
    for y in first.y as usize..=last.y as usize {
        for x in first.x as usize..=last.x as usize {
            if x >= grey.width || y >= grey.height {
                return None;
            }
            let offset = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - at;
            let local = inverse * offset;
            // The weight falls from 1 on the dot to 0 on the circle, so that no pixel enters or leaves at once.
            let weight = (2.0 * (OUTSIDE - local.length())).clamp(0.0, 1.0);
            let paper = plane[0] + plane[1] * local.x + plane[2] * local.y;
            let dark = weight * (paper - f64::from(grey.pixel(x, y)[0]));
            sum += dark * offset;
            area += dark;
            darkest = darkest.max(dark);
        }
    }
    let printed = std::f64::consts::PI * shape.determinant().abs();
    (darkest >= MIN_CONTRAST && AREA.contains(&(area / (darkest * printed)))).then(|| at + sum / area)
}
