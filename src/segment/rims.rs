//! The rims of lamps: pixels that bloom brightens so much that the classifier does not take them for the plane.

use crate::error::Result;
use crate::image::{Image, colour, dilate, try_collect};
use crate::job::Job;

/// Width of a rim in photo pixels. The edges of lamps are blurred by about a pixel before they are unwarped, and the
/// unwarping interpolates between two pixels. [convention]
const RIM: f32 = 3.0;

/// Mask of the lamps and their rims: the pixels of `lights`, and the pixels close to them that are at least as bright
/// as the median of the plane without its lamps. A rim belongs to the plane even if the mask of the plane leaves it
/// out. Without the rim, the lamp would count as partly hidden. An object that hides a part of a lamp is darker than
/// the plane, or brighter far beyond the rim. Pixels at which the photo is not finite are NaN, so that resampling
/// spreads no validity from them. If the plane shows no pixel beside lamps, no pixel is marked.
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
            () if lights.data[i] <= 0.5 && luminance < *median => *rim = 0.0,
            () => {}
        }
    }
    Ok(rims)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn rims_hold_bloom_but_neither_what_hides_a_lamp_nor_the_plane_further_away() {
        // A lamp at columns 20 to 29, with bloom around it that the mask of the plane leaves out. A dark pipe hides the
        // lamp's right end.
        let is_lamp = |x: usize, y: usize| (20..30).contains(&x) && (10..20).contains(&y);
        let is_pipe = |x: usize, _: usize| (30..34).contains(&x);
        let is_bloom = |x: usize, y: usize| (12..38).contains(&x) && (2..28).contains(&y) && !is_lamp(x, y);
        let lights = Image::from_fn(50, 40, |x, y| [f32::from(is_lamp(x, y))]).unwrap();
        let plane = Image::from_fn(50, 40, |x, y| [f32::from(!is_bloom(x, y) && !is_pipe(x, y))]).unwrap();
        let photo = Image::from_fn(50, 40, |x, y| {
            [match () {
                () if is_lamp(x, y) => 1.0,
                () if is_pipe(x, y) => 0.05,
                () if is_bloom(x, y) => 0.6,
                () => 0.3,
            }; 3]
        });
        let photo = photo.unwrap();
        let monitor = Monitor::default();
        let rims = lamp_rims(&plane, &lights, &photo, monitor.job()).unwrap();
        for y in 0..40 {
            for x in 0..50 {
                let away = |at: usize, low: usize| low.saturating_sub(at).max(at.saturating_sub(low + 9));
                let is_near = away(x, 20).pow(2) + away(y, 10).pow(2) <= 9;
                let expected = is_near && !is_pipe(x, y);
                assert_eq!(rims.pixel(x, y)[0] > 0.5, expected, "{x}, {y}");
            }
        }
        let small = Image::new(25, 20, 1).unwrap();
        assert!(lamp_rims(&plane, &small, &photo, monitor.job()).is_err());
        // Without a plane beside the lamps there is nothing to compare with.
        let none = lamp_rims(&lights, &lights, &photo, monitor.job()).unwrap();
        assert!(none.data.iter().all(|v| *v == 0.0));
    }
}
