//! Reads strokes from a picture of the photo's size: green = plane, red = not plane, yellow = light, blue = not light.

use super::{Kind, Stroke, StrokeSet};
use crate::error::{Error, Result};
use crate::image::{Image, colour, try_collect, try_push, try_vec};

/// The colours of strokes in sRGB. [convention]
const COLOURS: [(Kind, [f32; 3]); 4] = [
    (Kind::Plane, [0.0, 1.0, 0.0]),
    (Kind::NotPlane, [1.0, 0.0, 0.0]),
    (Kind::Light, [1.0, 1.0, 0.0]),
    (Kind::NotLight, [0.0, 0.0, 1.0]),
];
/// Largest deviation from a stroke colour in any sRGB channel, in `[0, 1]`. It allows for JPEG artefacts and soft
/// brushes. Any two stroke colours differ by 1 in some channel, so with a tolerance below 0.5 no pixel matches two of
/// them. If the noise of the strokes is at most 0.2, any tolerance from 0.2 to 0.49 gives the same strokes.
/// [convention]
const TOLERANCE: f32 = 0.3;
/// Minimum number of pixels of a stroke; smaller components are compression artefacts.
const SPECK: usize = 4;

/// Reads strokes from an image by colour: (0, 255, 0) plane, (255, 0, 0) not plane, (255, 255, 0) light, (0, 0, 255)
/// not light. Pixels of other colours, and pixels that are more than half transparent, are unpainted. Connected pixels
/// of one colour form a stroke. The image holds linear values, as `image::io` decodes them.
pub fn from_image(image: &Image) -> Result<StrokeSet> {
    if image.channels < 3 {
        return Err(Error::argument(format!(
            "the strokes image has {} channels; it must be RGB or RGBA to tell its colours apart",
            image.channels
        )));
    }
    let kind_of = |pixel: &[f32]| {
        if pixel.get(3).is_some_and(|&alpha| alpha < 0.5) {
            return None;
        }
        let matches =
            |c: &[f32; 3]| (0..3).all(|i| (colour::linear_to_srgb(pixel[i].clamp(0.0, 1.0)) - c[i]).abs() <= TOLERANCE);
        COLOURS.iter().find(|(_, c)| matches(c)).map(|(kind, _)| *kind)
    };
    let kinds = try_collect(image.data.chunks_exact(image.channels).map(kind_of))?;

    // Collect the connected components of each kind; a pixel is connected to its eight neighbours.
    let (width, height) = (image.width, image.height);
    let mut is_taken = try_vec(kinds.len(), false)?;
    let mut set = StrokeSet::default();
    for start in 0..kinds.len() {
        let Some(kind) = kinds[start].filter(|_| !is_taken[start]) else { continue };
        is_taken[start] = true;
        let mut pixels = vec![start as u32];
        let mut next = 0;
        while let Some(&p) = pixels.get(next) {
            next += 1;
            let (x, y) = (p as usize % width, p as usize / width);
            for ny in y.saturating_sub(1)..(y + 2).min(height) {
                for nx in x.saturating_sub(1)..(x + 2).min(width) {
                    let n = ny * width + nx;
                    if !is_taken[n] && kinds[n] == Some(kind) {
                        is_taken[n] = true;
                        try_push(&mut pixels, n as u32)?;
                    }
                }
            }
        }
        if pixels.len() >= SPECK {
            pixels.sort_unstable();
            set.push(kind, Stroke { pixels, positive: kind.is_positive() });
        }
    }
    Ok(set)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::Rng;

    fn painted(noise: f32) -> Image {
        Image::from_fn(40, 20, |x, y| {
            let bar = |x0: usize, y0: usize| (x0..x0 + 8).contains(&x) && (y0..y0 + 3).contains(&y);
            let srgb = match () {
                () if bar(2, 2) || bar(2, 10) => [0.0, 1.0, 0.0],
                () if bar(12, 2) => [1.0, 0.0, 0.0],
                () if bar(22, 2) => [1.0, 1.0, 0.0],
                () if bar(30, 2) => [0.0, 0.0, 1.0],
                () => [0.5, 0.45, 0.4],
            };
            let mut rng = Rng::new(1, &[x as u64, y as u64]);
            srgb.map(|v: f32| colour::srgb_to_linear((v + noise * (2.0 * rng.next_f32() - 1.0)).clamp(0.0, 1.0)))
        })
        .unwrap()
    }

    #[test]
    fn colours_and_components_become_strokes() {
        for noise in [0.0, 0.2] {
            let set = from_image(&painted(noise)).unwrap();
            let summary = |s: &[Stroke]| s.iter().map(|s| (s.positive, s.pixels.len())).collect::<Vec<_>>();
            assert_eq!(summary(&set.plane), [(true, 24), (false, 24), (true, 24)]);
            assert_eq!(summary(&set.lights), [(true, 24), (false, 24)]);
        }
    }

    #[test]
    fn photos_and_transparent_paint_are_unpainted() {
        let grey = Image::from_fn(9, 9, |_, _| [0.4, 0.4, 0.4]).unwrap();
        assert_eq!(from_image(&grey).unwrap(), StrokeSet::default());
        let clear = Image::from_fn(9, 9, |_, _| [0.0, 1.0, 0.0, 0.0]).unwrap();
        assert_eq!(from_image(&clear).unwrap(), StrokeSet::default());
        assert!(from_image(&Image::new(9, 9, 1).unwrap()).is_err());
    }
}
