//! Determines which of the room's three plane orientations a mask marks, and defines coordinates on that plane.

use super::View;
use crate::error::{Error, Result};
use crate::geometry::perspective::{HORIZONTAL_A, HORIZONTAL_B, VERTICAL};
use crate::geometry::{Homography, Perspective};
use crate::image::{Image, try_collect};
use crate::maths;
use glam::{DMat3, DVec2, DVec3};

/// Maximum number of mask pixels used; larger masks are subsampled evenly.
const MAX_PIXELS: usize = 1 << 18;

/// A plane is refused as seen edge-on if the median of `sin a` over the pixels of the mask is below this, where `a` is
/// the angle between the plane and the viewing ray. Any value from 0.004 to 0.05 serves. At 0.0035, the angle is as
/// small as the least error that directions are assumed to have, 0.2°, and the plane could face either way. At 0.05, a
/// ceiling 1 m above the camera is 20 m away. [convention]
const MIN_INCIDENCE: f64 = 0.02;
/// A plane is a ceiling if at most this share of its rays points down: a few wrong pixels of the mask. [convention]
const MAX_CEILING_SHARE: f64 = 0.02;
/// Factor that prefers a ceiling among planes that agree with the mask about equally well. [convention]
const CEILING_PREFERENCE: f64 = 1.5;

/// A plane at distance 1 from the camera, parallel to two room axes.
#[derive(Clone, Debug)]
pub struct Plane {
    /// Camera-space directions of the plane coordinates: right and down as they appear in the photo.
    pub right: DVec3,
    pub down: DVec3,
    /// Unit normal, pointing away from the camera.
    pub normal: DVec3,
    pub perspective: Perspective,
}

impl Plane {
    /// Maps plane coordinates to homogeneous pixels of the photo that an ideal lens would take. The third coordinate is
    /// positive in front of the camera.
    pub fn homography(&self) -> Homography {
        Homography(self.perspective.intrinsics() * DMat3::from_cols(self.right, self.down, self.normal))
    }

    /// Intersects the ray through a pixel with the plane. Returns plane coordinates; `None` at the plane's horizon and
    /// beyond.
    pub fn meet(&self, pixel: DVec2) -> Option<DVec2> {
        let ray = self.perspective.ray(pixel);
        let depth = self.normal.dot(ray);
        (depth > 1e-9).then(|| DVec2::new(self.right.dot(ray), self.down.dot(ray)) / depth)
    }

    /// Side, in plane units, of a square with the same area as the patch of the plane that a pixel covers. This is
    /// `√det J`, where J is the Jacobian from pixels to plane coordinates. For an ideal lens, det J is
    /// 1 / (f² (n · ray)³). `ray` has z = 1, n is the normal of the plane, and f the focal length in pixels.
    pub fn pixel_side(&self, pixel: DVec2) -> f64 {
        let side = maths::powf(self.normal.dot(self.perspective.ray(pixel)), -1.5) / self.perspective.focal;
        let lens = self.perspective.lens();
        if lens.is_none() { side } else { side * lens.derivative(pixel).determinant().sqrt() }
    }
}

/// Returns the centres of the pixels whose mask value is at least one half, evenly subsampled to [`MAX_PIXELS`].
pub fn marked_pixels(mask: &Image) -> Result<Vec<DVec2>> {
    let is_marked = |i: &usize| mask.data[i * mask.channels] >= 0.5;
    let marked = try_collect((0..mask.width * mask.height).filter(is_marked).map(|i| i as u32))?;
    if marked.is_empty() {
        return Err(Error::degenerate(
            "the plane's mask is empty: paint a stroke on the plane that carries the lights",
        ));
    }
    let step = marked.len().div_ceil(MAX_PIXELS);
    try_collect(marked.into_iter().step_by(step).map(|i| mask.centre_of(i as usize)))
}

/// Returns the plane along the given axes, or along the two axes that fit the mask best. Fails if the camera sees the
/// plane edge-on.
pub fn choose(view: &View, mask: &Image, pixels: &[DVec2], axes: Option<[usize; 2]>) -> Result<Plane> {
    let pair = match axes {
        Some([a, b]) if a < 3 && b < 3 && a != b => [a, b],
        Some([a, b]) => {
            return Err(Error::argument(format!("axes are [{a}, {b}]; they must be two different ones of 0, 1 and 2")));
        }
        None => best_pair(view, mask, pixels),
    };
    let plane = facing(&view.perspective, pair, pixels);
    let mut incidence = try_collect(pixels.iter().map(|&p| plane.normal.dot(view.perspective.ray(p).normalize())))?;
    let half = incidence.len() / 2;
    let median = *incidence.select_nth_unstable_by(half, f64::total_cmp).1;
    if !(median >= MIN_INCIDENCE) {
        return Err(Error::degenerate(format!(
            "the camera sees the plane along axes {} and {} edge-on (half of the mask at less than {:.1} degrees): \
             choose other axes, or mark a plane that the photo shows less obliquely",
            pair[0],
            pair[1],
            maths::asin(MIN_INCIDENCE).to_degrees()
        )));
    }
    Ok(plane)
}

/// Returns the plane parallel to two axes that lies in front of the camera for most of the pixels. The plane's
/// coordinates are ordered and flipped so that they run right and down in the photo.
fn facing(perspective: &Perspective, [i, j]: [usize; 2], pixels: &[DVec2]) -> Plane {
    let normal = perspective.axes.col(3 - i - j);
    let ahead = pixels.iter().filter(|&&p| normal.dot(perspective.ray(p)) > 0.0).count();
    let normal = if 2 * ahead >= pixels.len() { normal } else { -normal };
    let seen = || pixels.iter().filter(|&&p| normal.dot(perspective.ray(p)) > 0.0);
    let centre = perspective.lens().ideal(seen().sum::<DVec2>() / seen().count().max(1) as f64);
    // The direction in which an axis runs in the photo at the centre of the mask.
    let runs = |axis: usize| {
        let v = perspective.vanishing_point(axis);
        (v.truncate() - centre * v.z).normalize_or_zero()
    };
    let i = if runs(i).x.abs() >= runs(j).x.abs() { i } else { j };
    let right = perspective.axes.col(i) * if runs(i).x < 0.0 { -1.0 } else { 1.0 };
    // Avoid a mirror image: right, down and away from the camera form a right-handed system.
    let down = normal.cross(right);
    Plane { right, down, normal, perspective: *perspective }
}

/// Finds the two axes whose plane fits the mask best: the mask lies on one side of the plane's horizon, and the lines
/// inside the mask run along both axes and not along the third axis. A mask of which more than 98 % lies above the
/// horizon counts as a ceiling, unless its lines favour another plane clearly.
fn best_pair(view: &View, mask: &Image, pixels: &[DVec2]) -> [usize; 2] {
    // Add up, for each axis, the lengths of its segments inside the mask. The part of a segment inside the mask is
    // estimated from the two end points and the midpoint.
    let inside = |p: DVec2| {
        p.x >= 0.0
            && p.y >= 0.0
            && p.x < mask.width as f64
            && p.y < mask.height as f64
            && mask.pixel(p.x as usize, p.y as usize)[0] >= 0.5
    };
    let mut lengths = [0.0; 3];
    for (segment, axis) in &view.segments {
        if let Some(axis) = axis {
            let hits = [segment.a, segment.midpoint(), segment.b].into_iter().filter(|&p| inside(p)).count();
            lengths[*axis] += segment.length() * hits as f64 / 3.0;
        }
    }
    let total: f64 = lengths.iter().sum();
    let share = lengths.map(|l| if total > 0.0 { l / total } else { 1.0 / 3.0 });
    let value = |[i, j]: [usize; 2]| {
        let third = 3 - i - j;
        let normal = view.perspective.axes.col(third);
        let ahead = pixels.iter().filter(|&&p| normal.dot(view.perspective.ray(p)) > 0.0).count() as f64;
        let share_ahead = ahead / pixels.len() as f64;
        let one_sided = (2.0 * share_ahead - 1.0).abs();
        let lines = 1.0 - share[third] + share[i].min(share[j]);
        // Favour a ceiling. The vertical axis points down, so the mask is on a ceiling if nearly all its rays point
        // against this axis.
        let ceiling = if third == VERTICAL && share_ahead < MAX_CEILING_SHARE { CEILING_PREFERENCE } else { 1.0 };
        maths::powi(one_sided, 4) * lines * ceiling
    };
    let pairs = [[HORIZONTAL_A, HORIZONTAL_B], [HORIZONTAL_A, VERTICAL], [VERTICAL, HORIZONTAL_B]];
    pairs.into_iter().rev().max_by(|&a, &b| value(a).total_cmp(&value(b))).unwrap_or(pairs[0])
}
