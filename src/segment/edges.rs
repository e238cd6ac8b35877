//! Blurs the confidence image of the lamps before it is resampled, so that the contour on which the confidence is 0.5
//! becomes a smooth line.

use crate::error::Result;
use crate::image::{Image, pyramid};
use crate::job::Job;

/// Standard deviation of the blur in photo pixels. The edge of a clipped lamp is a staircase of whole pixels; after a
/// blur of about a pixel, the 0.5 level of a straight edge is straight again. [convention]
const EDGE_BLUR: f32 = 0.9;
/// Dark gaps of at most this width between two lamps are kept open; the width is in photo pixels. The blur would close
/// some of these gaps, but closes no wider gap. [convention]
const GAP: usize = 2;
/// The directions in which a gap is crossed: along a row, a column and the two diagonals.
const ACROSS: [[isize; 2]; 4] = [[1, 0], [0, 1], [1, 1], [1, -1]];

/// Blurs the confidence of lamps, so that their edges are smooth after resampling. Narrow gaps between lamps stay
/// open, such as the bars between panes of one window.
pub fn smooth_edges(confidence: &Image, job: Job) -> Result<Image> {
    let mut smooth = pyramid::blur(confidence, EDGE_BLUR, job)?;
    for y in 0..smooth.height {
        for x in 0..smooth.width {
            let i = y * smooth.width + x;
            if smooth.data[i] > 0.5 && confidence.data[i] <= 0.5 && is_gap(confidence, x, y) {
                smooth.data[i] = confidence.data[i];
            }
        }
    }
    Ok(smooth)
}

/// Whether a dark pixel lies in a gap at most [`GAP`] pixels wide: on two opposite sides of the pixel, the nearest lit
/// pixels are at most `GAP + 1` steps apart.
fn is_gap(confidence: &Image, x: usize, y: usize) -> bool {
    let is_lit = |[dx, dy]: [isize; 2], steps: isize| {
        let (u, v) = (x as isize + dx * steps, y as isize + dy * steps);
        let inside = u >= 0 && v >= 0 && u < confidence.width as isize && v < confidence.height as isize;
        inside && confidence.data[v as usize * confidence.width + u as usize] > 0.5
    };
    let max_steps = GAP as isize;
    ACROSS.iter().any(|&step| {
        let first = |sign: isize| (1..=max_steps).find(|&n| is_lit(step, sign * n));
        first(1).zip(first(-1)).is_some_and(|(ahead, behind)| ahead + behind <= max_steps + 1)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    fn smooth(is_lit: impl Fn(usize, usize) -> bool) -> Image {
        let confidence = Image::from_fn(24, 16, |x, y| [f32::from(is_lit(x, y))]).unwrap();
        smooth_edges(&confidence, Monitor::default().job()).unwrap()
    }

    #[test]
    fn bars_between_panes_stay_dark() {
        for bar in 1..=GAP {
            let smooth = smooth(|x, _| !(11..11 + bar).contains(&x));
            let lit: Vec<usize> = (0..24).filter(|&x| smooth.pixel(x, 8)[0] > 0.5).collect();
            let expected: Vec<usize> = (0..24).filter(|x| !(11..11 + bar).contains(x)).collect();
            assert_eq!(lit, expected, "a bar of {bar} pixels");
        }
    }

    #[test]
    fn the_staircase_of_an_oblique_edge_becomes_a_line() {
        // On each row, the blurred value must cross 0.5 close to the ideal edge, x = (40 - y) / 4 + 3/8. The 3/8 is the
        // mean distance by which the staircase of whole pixels exceeds (40 - y) / 4.
        let smooth = smooth(|x, y| 4 * x + y < 40);
        for y in 4..12 {
            let row = |x: usize| smooth.pixel(x, y)[0];
            let x = (0..23).find(|&x| row(x) > 0.5 && row(x + 1) <= 0.5).unwrap();
            let crossing = x as f32 + 0.5 + (row(x) - 0.5) / (row(x) - row(x + 1));
            let line = (40 - y) as f32 / 4.0 + 0.375;
            assert!((crossing - line).abs() < 0.2, "row {y}: {crossing} for {line}");
        }
    }
}
