//! The rims of lamps: pixels that bloom brightens so much that the classifier does not take them for the plane.

use crate::error::Result;
use crate::image::{Image, colour, dilate, try_collect};
use crate::job::Job;
use glam::IVec2;

/// Width of a rim in photo pixels. The edges of lamps are blurred by about a pixel before they are unwarped, and the
/// unwarping interpolates between two pixels. [convention]
const RIM: f32 = 3.0;

/// How far bloom can keep the plane out of its mask, as a share of the photo's diagonal. [bench photos:tune]
const REACH: f32 = 0.08;

/// Mask of the lamps and their rims: the pixels of `lights`, and the pixels close to them that are at least as bright
/// as the median of the plane without its lamps, and behind which the plane begins within [`REACH`]. A rim belongs to
/// the plane even if the mask of the plane leaves it out. Without the rim, the lamp would count as partly hidden. An
/// object that hides a part of a lamp is darker than the plane, or wider than bloom. Pixels at which the photo is not
/// finite are NaN, so that resampling spreads no validity from them. If the plane shows no pixel beside lamps, no pixel
/// is marked.
///
/// Errors: masks of another size than the photo.
pub fn lamp_rims(plane: &Image, lights: &Image, photo: &Image, job: Job) -> Result<Image> {
    photo.check_same_size("the photo", plane, "the mask of the plane")?;
    photo.check_same_size("the photo", lights, "the mask of the lights")?;
    let luminance = |i: usize| colour::luminance(photo.rgb(i % photo.width, i / photo.width));
    let is_plain = |i: &usize| plane.data[*i] > 0.5 && lights.data[*i] <= 0.5;
    let mut plain = try_collect((0..plane.data.len()).filter(is_plain).map(luminance).filter(|l| l.is_finite()))?;
    if plain.is_empty() {
        return Image::new(photo.width, photo.height, 1);
    }
    let middle = plain.len() / 2;
    let (_, median, _) = plain.select_nth_unstable_by(middle, f32::total_cmp);
    let mut rims = dilate(lights, RIM, job)?;
    for (i, rim) in rims.data.iter_mut().enumerate() {
        let luminance = luminance(i);
        match () {
            () if !luminance.is_finite() => *rim = f32::NAN,
            () if lights.data[i] > 0.5 || *rim <= 0.5 => {}
            () if luminance < *median || !ends_at_plane(plane, lights, i % photo.width, i / photo.width) => *rim = 0.0,
            () => {}
        }
    }
    Ok(rims)
}

/// Whether the way from the nearest lamp through the pixel at x, y reaches the plane, or the border of the photo,
/// within [`REACH`].
fn ends_at_plane(plane: &Image, lights: &Image, x: usize, y: usize) -> bool {
    let size = IVec2::new(plane.width as i32, plane.height as i32);
    let at = IVec2::new(x as i32, y as i32);
    let is_inside = |p: IVec2| p.cmpge(IVec2::ZERO).all() && p.cmplt(size).all();
    let is_lamp = |p: IVec2| is_inside(p) && lights.pixel(p.x as usize, p.y as usize)[0] > 0.5;
    let rim = RIM as i32;
    let around = (-rim..=rim).flat_map(|dy| (-rim..=rim).map(move |dx| IVec2::new(dx, dy)));
    let Some(to_lamp) = around.filter(|d| is_lamp(at + *d)).min_by_key(|d| d.length_squared()) else { return false };
    let away = -to_lamp.as_vec2().normalize();
    let reach = (REACH * size.as_vec2().length()) as i32;
    (0..=reach)
        .map(|step| at + (away * step as f32).round().as_ivec2())
        .any(|p| !is_inside(p) || plane.pixel(p.x as usize, p.y as usize)[0] > 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn rims_hold_bloom_but_neither_what_hides_a_lamp_nor_the_plane_further_away() {
        // A lamp at columns 80 to 89, with bloom around it that the mask of the plane leaves out. A dark pipe hides the
        // lamp's right end, a column as bright as the bloom its lower end.
        let is_lamp = |x: usize, y: usize| (80..90).contains(&x) && (20..30).contains(&y);
        let is_pipe = |x: usize, _: usize| (90..94).contains(&x);
        let is_column = |x: usize, y: usize| (72..98).contains(&x) && y >= 30;
        let is_bloom = |x: usize, y: usize| (72..98).contains(&x) && (12..38).contains(&y) && !is_lamp(x, y);
        let is_plane = |x: usize, y: usize| !is_bloom(x, y) && !is_pipe(x, y) && !is_column(x, y);
        let (width, height) = (200, 160);
        let lights = Image::from_fn(width, height, |x, y| [f32::from(is_lamp(x, y))]).unwrap();
        let plane = Image::from_fn(width, height, |x, y| [f32::from(is_plane(x, y))]).unwrap();
        let photo = Image::from_fn(width, height, |x, y| {
            [match () {
                () if is_lamp(x, y) => 1.0,
                () if is_pipe(x, y) => 0.05,
                () if is_bloom(x, y) || is_column(x, y) => 0.6,
                () => 0.3,
            }; 3]
        });
        let photo = photo.unwrap();
        let monitor = Monitor::default();
        let rims = lamp_rims(&plane, &lights, &photo, monitor.job()).unwrap();
        // Beside the lamp's lower corners, the way to the plane is short.
        for (x, y) in
            (0..width * height).map(|i| (i % width, i / width)).filter(|(x, y)| *y < 30 || (80..90).contains(x))
        {
            let away = |at: usize, low: usize| low.saturating_sub(at).max(at.saturating_sub(low + 9));
            let is_near = away(x, 80).pow(2) + away(y, 20).pow(2) <= 9;
            let expected = is_near && !is_pipe(x, y) && !is_column(x, y);
            assert_eq!(rims.pixel(x, y)[0] > 0.5, expected, "{x}, {y}");
        }
        let small = Image::new(25, 20, 1).unwrap();
        assert!(lamp_rims(&plane, &small, &photo, monitor.job()).is_err());
        // Without a plane beside the lamps there is nothing to compare with.
        let none = lamp_rims(&lights, &lights, &photo, monitor.job()).unwrap();
        assert!(none.data.iter().all(|v| *v == 0.0));
    }
}
