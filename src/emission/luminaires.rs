//! The lamps of the texture as a list: what lighting software wants besides pixels.

use super::components::{self, Component, Components};
use super::{Luminaire, kinds};
use crate::error::Result;
use crate::image::Image;
use crate::image::colour::luminance;
use crate::job::Job;
use glam::{DVec2, DVec3, Vec3};

/// Largest distance in texels between an outline and the corners of its texels: a staircase becomes one line.
const OUTLINE_TOLERANCE: f64 = 1.0;

/// How long a piece of light may be, in texels, to be a crumb of that area.
pub fn reach(crumb: f64) -> usize {
    (2.0 * crumb.sqrt()).ceil() as usize
}

/// Takes out every connected piece of light smaller than `crumb` texels, and compact: no longer than the [`reach`] of one. Those
/// that `is_cut` says of by their first and last texel are the rest of something larger.
pub fn sweep(
    texture: &mut Image,
    mask: &mut Image,
    found: &mut Components,
    crumb: f64,
    is_cut: impl Fn([usize; 2], [usize; 2]) -> bool,
) {
    let reach = reach(crumb);
    let is_crumb = |piece: &Component| {
        let is_small = (piece.area as f64) < crumb && piece.size().into_iter().all(|s| s <= reach);
        is_small && !is_cut(piece.min, piece.max)
    };
    let crumbs: Vec<bool> = found.list.iter().map(is_crumb).collect();
    if crumbs.contains(&true) {
        take_out(texture, mask, found, |k, _| crumbs[k]);
        found.remove(|k| crumbs[k]);
    }
}

/// Takes out the texels of lamps that `goes` names by lamp and texel, and rims whose lamps all go: texels less than half of
/// which is light, which the mask leaves out.
pub fn take_out(texture: &mut Image, mask: &mut Image, found: &Components, goes: impl Fn(usize, usize) -> bool) {
    let (width, height) = (mask.width, mask.height);
    let lamp = |i: usize| (found.labels[i] as usize).checked_sub(1);
    for i in 0..width * height {
        let is_out = match lamp(i) {
            Some(k) => goes(k, i),
            None if texture.data[3 * i..3 * i + 3] == [0.0; 3] => false,
            None => {
                let (x, y) = (i % width, i / width);
                let columns = x.saturating_sub(1)..(x + 2).min(width);
                let rows = y.saturating_sub(1)..(y + 2).min(height);
                let mut near =
                    rows.flat_map(|v| columns.clone().map(move |u| v * width + u)).filter_map(|j| Some((lamp(j)?, j)));
                let first = near.next();
                first.into_iter().chain(near).all(|(k, j)| goes(k, j)) && first.is_some()
            }
        };
        if is_out {
            texture.data[3 * i..3 * i + 3].fill(0.0);
            mask.data[i] = 0.0;
        }
    }
}

/// The connected components of a mask.
pub fn components(mask: &Image) -> Result<Components> {
    components::find(mask.width, mask.height, |i| mask.data[i] > 0.5)
}

/// One luminaire for each connected component of the lights, in the order of their first texel.
pub fn find(texture: &Image, found: &Components, job: Job) -> Result<Vec<Luminaire>> {
    let (width, height) = (texture.width, texture.height);
    let total = texture.data.chunks_exact(3).map(|p| f64::from(luminance(Vec3::from_slice(p)))).sum::<f64>();
    let lamps: Result<Vec<Luminaire>> = found
        .list
        .iter()
        .enumerate()
        .map(|(k, lamp)| {
            job.check()?;
            let is_in = |x: isize, y: isize| {
                let inside = x >= 0 && y >= 0 && x < width as isize && y < height as isize;
                inside && found.labels[y as usize * width + x as usize] == k as u32 + 1
            };
            Ok(measure(lamp, texture, total, &is_in))
        })
        .collect();
    let (mut lamps, size) = (lamps?, DVec2::new(width as f64, height as f64));
    kinds::tell(lamps.iter_mut().map(|lamp| {
        let count = usize::from(lamp.is_within(size));
        (lamp, count)
    }));
    Ok(lamps)
}

fn measure(lamp: &Component, texture: &Image, total: f64, is_in: &dyn Fn(isize, isize) -> bool) -> Luminaire {
    // Mean colour and second moments.
    let pixels = || {
        let columns = lamp.min[0]..=lamp.max[0];
        (lamp.min[1]..=lamp.max[1])
            .flat_map(move |y| columns.clone().map(move |x| (x, y)))
            .filter(|&(x, y)| is_in(x as isize, y as isize))
            .map(|(x, y)| (x, y, DVec2::new(x as f64 + 0.5, y as f64 + 0.5) - lamp.centre))
    };
    let (mut colour, mut xx, mut xy, mut yy) = (DVec3::ZERO, 0.0, 0.0, 0.0);
    for (x, y, d) in pixels() {
        colour += texture.rgb(x, y).as_dvec3();
        (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
    }
    colour /= lamp.area as f64;

    let orientation = orientation([xx, xy, yy]);

    // Extent along both axes, texels being squares of side 1.
    let axis = DVec2::from_angle(orientation);
    let extent = |axis: DVec2| {
        let (low, high) = pixels().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (.., d)| {
            (low.min(d.dot(axis)), high.max(d.dot(axis)))
        });
        high - low + axis.x.abs().max(axis.y.abs())
    };
    let flux = f64::from(luminance(colour.as_vec3())) * lamp.area as f64;
    Luminaire {
        centre: lamp.centre,
        size: DVec2::new(extent(axis), extent(axis.perp())),
        orientation,
        area: lamp.area as f64,
        colour: colour.as_vec3(),
        flux_share: if total > 0.0 { flux / total } else { 0.0 },
        outline: outline(lamp, is_in),
        kind: 0,
    }
}

/// The direction of largest variance, in (-π/2, π/2], of second moments; a lamp that has none lies along x.
pub fn orientation([xx, xy, yy]: [f64; 3]) -> f64 {
    let (difference, cross) = (xx - yy, 2.0 * xy);
    let anisotropy = difference.hypot(cross);
    let angle = if anisotropy > 1e-6 * (xx + yy) { 0.5 * cross.atan2(difference) } else { 0.0 };
    // Rounding may not choose between the two ends.
    if angle <= -std::f64::consts::FRAC_PI_2 + 1e-12 { angle + std::f64::consts::PI } else { angle }
}

/// The outer boundary along the edges of the texels, the lamp on the right, simplified (Douglas and Peucker 1973).
fn outline(lamp: &Component, is_in: &dyn Fn(isize, isize) -> bool) -> Vec<DVec2> {
    // The first texel in reading order has its upper left corner on the outer boundary.
    let y = lamp.min[1] as isize;
    let first = (lamp.min[0]..=lamp.max[0]).find(|&x| is_in(x as isize, y)).unwrap_or(lamp.min[0]) as isize;
    let start = [first, y];

    // Walk eastwards from there with the lamp at the right hand. Only one texel of the lamp meets the first corner, so the
    // walk is over when it is back. Where texels touch by a corner, turn left: the lamp holds both.
    let (mut at, mut heading) = (start, [1isize, 0isize]);
    let mut corners = vec![DVec2::new(at[0] as f64, at[1] as f64)];
    loop {
        at = [at[0] + heading[0], at[1] + heading[1]];
        if at == start {
            break;
        }
        let ahead = |side: isize| {
            let x = at[0] + (heading[0] - 1 - side * heading[1]).div_euclid(2);
            let y = at[1] + (heading[1] - 1 + side * heading[0]).div_euclid(2);
            is_in(x, y)
        };
        heading = match (ahead(-1), ahead(1)) {
            (true, _) => [heading[1], -heading[0]],
            (false, true) => continue,
            (false, false) => [-heading[1], heading[0]],
        };
        corners.push(DVec2::new(at[0] as f64, at[1] as f64));
    }
    simplified(corners, lamp.size()[0].min(lamp.size()[1]) as f64)
}

/// A ring of corners without those that tell little of a lamp so narrow.
pub fn simplified(mut corners: Vec<DVec2>, narrow: f64) -> Vec<DVec2> {
    // Split the ring at the corner farthest from the first, then simplify both halves.
    let far = (0..corners.len())
        .max_by(|&a, &b| corners[a].distance_squared(corners[0]).total_cmp(&corners[b].distance_squared(corners[0])))
        .unwrap_or(0);
    let mut kept = vec![false; corners.len() + 1];
    (kept[0], kept[far]) = (true, true);
    corners.push(corners[0]);
    // A lamp of a few texels keeps its corners.
    let tolerance = OUTLINE_TOLERANCE.min(0.3 * narrow);
    simplify(&corners, 0, far, tolerance, &mut kept);
    simplify(&corners, far, corners.len() - 1, tolerance, &mut kept);
    corners.iter().zip(&kept).take(corners.len() - 1).filter(|(_, k)| **k).map(|(c, _)| *c).collect()
}

/// Marks the corners between two kept ones that lie too far from the line between them.
fn simplify(corners: &[DVec2], first: usize, last: usize, tolerance: f64, kept: &mut [bool]) {
    let mut open = vec![(first, last)];
    while let Some((a, b)) = open.pop() {
        let along = (corners[b] - corners[a]).normalize_or_zero();
        let distance = |i: usize| {
            let d = corners[i] - corners[a];
            (d - along * d.dot(along)).length()
        };
        let worst = (a + 1..b).map(|i| (i, distance(i))).max_by(|p, q| p.1.total_cmp(&q.1));
        if let Some((i, _)) = worst.filter(|w| w.1 > tolerance) {
            kept[i] = true;
            open.extend([(a, i), (i, b)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::polygon;
    use crate::job::Monitor;

    fn lamps(width: usize, height: usize, inside: impl Fn(f64, f64) -> bool) -> Vec<Luminaire> {
        let on = |x: usize, y: usize| inside(x as f64 + 0.5, y as f64 + 0.5);
        let mask = Image::from_fn(width, height, |x, y| [f32::from(on(x, y))]).unwrap();
        let texture = Image::from_fn(width, height, |x, y| [2.0, 1.0, 0.5].map(|v| v * f32::from(on(x, y)))).unwrap();
        find(&texture, &components(&mask).unwrap(), Monitor::default().job()).unwrap()
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
