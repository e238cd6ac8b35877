//! Replaces the invalid pixels of a photo: NaN, infinite and negative values.

use crate::error::Result;
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use std::borrow::Cow;

/// Values above this count as infinite, so that a sum of up to 300 squares of values does not overflow. [rounding]
const MAX_VALUE: f32 = 1e18;

/// Returns the photo with each invalid pixel replaced by the nearest valid one in its row (black if the whole photo is
/// invalid), and the number of replaced pixels. Rows without valid pixels copy the nearest row that has one. The
/// result is RGB if a pixel was replaced.
pub fn clean<'a>(photo: &'a Image, job: Job) -> Result<(Cow<'a, Image>, usize)> {
    let is_good = |p: &[f32]| p[..p.len().min(3)].iter().all(|v| (0.0..=MAX_VALUE).contains(v));
    let (width, channels) = (photo.width, if photo.channels < 3 { 1 } else { 3 });
    let bad_in_rows = exec::map(photo.height, job, |y| {
        let pixels = photo.row(y).chunks_exact(photo.channels);
        pixels.map(|p| usize::from(!is_good(&p[..channels]))).sum::<usize>()
    })?;
    let non_finite: usize = bad_in_rows.iter().sum();
    if non_finite == 0 {
        return Ok((Cow::Borrowed(photo), 0));
    }
    let mut rgb = photo.to_rgb()?;
    // Fill along rows first. Then copy rows without any valid pixel from the nearest row that has one.
    let good_rows: Vec<usize> = (0..rgb.height).filter(|&y| bad_in_rows[y] < width).collect();
    exec::for_rows(&mut rgb.data, width * 3, job, |y, row| {
        if bad_in_rows[y] == width {
            row.fill(0.0);
        } else if bad_in_rows[y] > 0 {
            let good: Vec<usize> = (0..width).filter(|&x| is_good(&row[3 * x..3 * x + 3])).collect();
            for x in 0..width {
                let from = nearest(&good, x);
                row.copy_within(3 * from..3 * from + 3, 3 * x);
            }
        }
    })?;
    if !good_rows.is_empty() {
        for y in (0..rgb.height).filter(|&y| bad_in_rows[y] == width) {
            let from = nearest(&good_rows, y) * 3 * width;
            rgb.data.copy_within(from..from + 3 * width, y * 3 * width);
        }
    }
    Ok((Cow::Owned(rgb), non_finite))
}

/// Returns the element of a sorted, non-empty list that is nearest to `x`.
fn nearest(sorted: &[usize], x: usize) -> usize {
    let after = sorted.partition_point(|&g| g < x).min(sorted.len() - 1);
    let before = after.saturating_sub(1);
    if sorted[after].abs_diff(x) <= sorted[before].abs_diff(x) { sorted[after] } else { sorted[before] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn bad_pixels_take_their_neighbours_value_and_are_counted() {
        let mut photo = Image::from_fn(5, 4, |x, y| [x as f32, y as f32, 1.0]).unwrap();
        photo.pixel_mut(2, 1)[0] = f32::NAN;
        photo.pixel_mut(3, 1)[2] = -1.0;
        photo.pixel_mut(0, 3).fill(f32::INFINITY);
        (0..5).for_each(|x| photo.pixel_mut(x, 2)[1] = f32::NEG_INFINITY);
        let (clean, count) = clean(&photo, Monitor::default().job()).unwrap();
        assert_eq!(count, 8);
        assert_eq!(clean.count_non_finite(), 0);
        assert_eq!(clean.pixel(2, 1), [1.0, 1.0, 1.0]);
        assert_eq!(clean.pixel(3, 1), [4.0, 1.0, 1.0]);
        assert_eq!(clean.pixel(0, 3), [1.0, 3.0, 1.0]);
        assert_eq!(clean.pixel(4, 2), [4.0, 3.0, 1.0]);
    }

    #[test]
    fn a_photo_without_any_good_pixel_becomes_black() {
        let photo = Image::from_fn(3, 3, |_, _| [f32::NAN]).unwrap();
        let (clean, count) = clean(&photo, Monitor::default().job()).unwrap();
        assert_eq!(count, 9);
        assert!(clean.data.iter().all(|&v| v == 0.0));
    }
}
