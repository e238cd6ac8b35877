//! Compares pixels with a tolerance: counts the wrong pixels, and finds the pixel with the largest error.

use crate::error::Result;
use crate::exec;
use crate::job::Job;

/// The outcome of a comparison of pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Number of pixels that were compared.
    pub compared: usize,
    /// Number of these pixels whose error exceeds the tolerance.
    pub wrong: usize,
    /// Column and row of the pixel with the largest error; `None` if no pixel is wrong.
    pub place: Option<[usize; 2]>,
}

impl Comparison {
    /// Compares the pixels of an image of `width × height` pixels. `error(x, y)` is the error of a pixel, or `None` if
    /// the pixel cannot be compared.
    pub fn of(
        [width, height]: [usize; 2],
        tolerance: f32,
        job: Job,
        error: impl Fn(usize, usize) -> Option<f32> + Sync,
    ) -> Result<Self> {
        let rows = exec::map(height, job, |y| {
            let mut row = Worst { found: Self::default(), largest: tolerance };
            for (x, error) in (0..width).filter_map(|x| Some((x, error(x, y)?))) {
                let is_wrong = error > tolerance;
                let place = is_wrong.then_some([x, y]);
                row.add(&Worst { found: Self { compared: 1, wrong: usize::from(is_wrong), place }, largest: error });
            }
            row
        })?;
        let mut all = Worst { found: Self::default(), largest: tolerance };
        rows.into_iter().for_each(|row| all.add(&row));
        Ok(all.found)
    }
}

/// A comparison of some pixels, and their largest error. A comparison of no pixels has the tolerance as its largest
/// error, so that `place` is set only by errors above the tolerance.
struct Worst {
    found: Comparison,
    largest: f32,
}

impl Worst {
    /// Adds the comparison of other pixels.
    fn add(&mut self, other: &Self) {
        self.found.compared += other.found.compared;
        self.found.wrong += other.found.wrong;
        if other.largest > self.largest {
            (self.found.place, self.largest) = (other.found.place, other.largest);
        }
    }
}

/// Returns a pixel and its neighbours, up to eight, in an image of `width × height` pixels.
pub fn neighbourhood([x, y]: [usize; 2], [width, height]: [usize; 2]) -> impl Iterator<Item = (usize, usize)> {
    let near = |v: usize, size: usize| v.saturating_sub(1)..(v + 2).min(size);
    near(y, height).flat_map(move |y| near(x, width).map(move |x| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    #[test]
    fn wrong_pixels_are_counted_and_the_worst_is_named() {
        // The errors rise from 0 to 11; two pixels cannot be compared.
        let error = |x: usize, y: usize| Some((4 * y + x) as f32).filter(|e| *e != 11.0 && *e != 2.0);
        let compare = |tolerance| Comparison::of([4, 3], tolerance, Monitor::default().job(), error).unwrap();
        assert_eq!(compare(7.0), Comparison { compared: 10, wrong: 3, place: Some([2, 2]) });
        assert_eq!(compare(10.0), Comparison { compared: 10, wrong: 0, place: None });
    }

    #[test]
    fn neighbourhoods_end_at_the_border() {
        let around = |x, y| neighbourhood([x, y], [3, 2]).collect::<Vec<_>>();
        assert_eq!(around(1, 1), [(0, 0), (1, 0), (2, 0), (0, 1), (1, 1), (2, 1)]);
        assert_eq!(around(2, 0), [(1, 0), (2, 0), (1, 1), (2, 1)]);
    }
}
