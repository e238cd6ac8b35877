//! Warnings about doubtful masks, and the place where another stroke would help most.

use super::segmentation::Segmentation;
use super::strokes::Stroke;
use crate::image::Image;
use crate::warning::{Code, Warning, percent};
use glam::DVec2;

/// A warning is given if the features of more than this share of the mask are unlike the features under every stroke.
/// For lamps: if doubtful regions make up more than this share of the lamps and doubtful regions together.
/// [judged on 38 photos]
const MAX_UNSEEN: f64 = 0.2;
/// Value of `unseen` above which a pixel counts as unlike every stroke. [convention]
const UNSEEN: f32 = 0.5;
/// A warning is given if the number of pixels under strokes of both classes, divided by the number of samples, exceeds
/// this value. [judged on 38 photos]
const MAX_CONTRADICTORY: f64 = 0.05;
/// A warning is given if the number of stroke pixels outside the photo, divided by the number of samples, exceeds this
/// value. [judged on 38 photos]
const MAX_OFF_IMAGE: f64 = 0.05;
/// A warning is given if the expected share of wrong pixels exceeds this value. [judged on 38 photos]
const MAX_ERROR: f64 = 0.1;
/// A warning is given if the mask assigns more than this share of the painted pixels to the wrong class.
/// [judged on 38 photos]
const MAX_MISSED: f64 = 0.1;
/// A warning is given if a random pixel painted as light is brighter than a random pixel of the plane with a
/// probability below this. Of 44 photos, the probability is below 0.83 on the three whose lamps are off or shine away
/// from the camera, and above 0.85 on the others. [judged on 44 photos]
const MIN_BRIGHTER: f64 = 0.85;
/// A warning is given if lamps cover more than this share of the plane. [judged on 38 photos]
const MAX_LIT: f64 = 0.4;

/// Number of grid cells along the longer side of the photo. [`Segmentation::warnings`] suggests the next stroke in the
/// cell with the most doubt, summed over the cell and its neighbours.
const CELLS: usize = 64;

impl Segmentation {
    /// Returns warnings about the mask. A mask that the caller supplied is trusted unless it is empty.
    pub fn warnings(&self) -> Vec<Warning> {
        let all = [
            self.is_empty(),
            self.proposed(),
            self.is_unseen(),
            self.contradictory_strokes(),
            self.off_image_strokes(),
            self.uncertain(),
        ];
        all.into_iter().flatten().collect()
    }

    /// Whether the mask was computed from samples of the strokes. False for a mask that the caller supplied, and for
    /// proposals without any stroke: a whole face of the room, or lamps.
    fn is_learnt(&self) -> bool {
        self.samples != [0, 0]
    }

    /// How doubtful a pixel is, from 0 to 1. If the mask is of a surface: `unseen` for the pixels in the mask, 0 for
    /// the others. If the mask is of lamps: `unseen` for all pixels, because `unseen` then marks regions outside the
    /// mask that may be lamps.
    fn doubt(&self, pixel: usize) -> f32 {
        if self.is_of_lamps || self.mask.data[pixel] > 0.5 { self.unseen.data[pixel] } else { 0.0 }
    }

    fn is_empty(&self) -> Option<Warning> {
        let count = self.mask.data.iter().filter(|m| **m > 0.5).count();
        Warning::below(
            Code::EmptyMask,
            count as f64,
            1.0,
            || "the mask has no pixel".into(),
            "paint more positive strokes, and fewer or other negative ones",
        )
    }

    fn proposed(&self) -> Option<Warning> {
        let message = "strokes are missing, and the mask is a proposal".to_string();
        let advice = "look at the mask; paint positive and negative strokes to correct it";
        self.is_proposed.then(|| Warning::new(Code::Proposed, self.error, 0.0, message, advice))
    }

    fn is_unseen(&self) -> Option<Warning> {
        let pixels = || 0..self.mask.data.len();
        let doubtful = pixels().filter(|&p| self.doubt(p) > UNSEEN).count();
        let all = pixels().filter(|&p| self.mask.data[p] > 0.5 || self.doubt(p) > UNSEEN).count();
        let share = doubtful as f64 / all.max(1) as f64;
        let message = || {
            let share = percent(share);
            match (self.is_of_lamps, self.is_proposed) {
                (true, false) => {
                    format!("{share} of what may be lamps is left out: it resembles the painted lamps in part")
                }
                (true, true) => {
                    format!("{share} of what may be lamps is left out: it resembles the proposed lamps in part")
                }
                (false, _) => format!("{share} of the mask is unlike every stroke"),
            }
        };
        let advice = "paint one more stroke at this place, of the class that it belongs to";
        Warning::above(Code::Unseen, share, MAX_UNSEEN, message, advice).map(|warning| warning.at(self.next_stroke()))
    }

    fn contradictory_strokes(&self) -> Option<Warning> {
        let share = self.per_sample(self.contradictory);
        Warning::above(
            Code::ContradictoryStrokes,
            share,
            MAX_CONTRADICTORY,
            || {
                format!(
                    "strokes of both classes cover the same {} pixels, where the later ones count",
                    self.contradictory
                )
            },
            "erase the wrong strokes and paint them again",
        )
    }

    fn off_image_strokes(&self) -> Option<Warning> {
        let share = self.per_sample(self.off_image);
        Warning::above(
            Code::OffImageStrokes,
            share,
            MAX_OFF_IMAGE,
            || format!("{} pixels of the strokes lie outside the photo and are ignored", self.off_image),
            "check that the strokes were painted on this photo and at its size",
        )
    }

    fn uncertain(&self) -> Option<Warning> {
        Warning::above(
            Code::UncertainMask,
            self.error,
            MAX_ERROR,
            || format!("{} of the pixels of the mask are expected to be wrong", percent(self.error)),
            "look at the mask, and paint a stroke on each surface that it takes for another",
        )
    }

    fn per_sample(&self, pixels: usize) -> f64 {
        pixels as f64 / (self.samples[0] + self.samples[1]).max(1) as f64
    }

    /// Warns if the mask contradicts many pixels of the strokes from which it was made.
    pub fn missed<'a>(&self, strokes: impl Iterator<Item = &'a Stroke>) -> Option<Warning> {
        let is_missed = |stroke: &Stroke, p: u32| {
            self.mask.data.get(p as usize).is_some_and(|mask| (*mask > 0.5) != stroke.positive)
        };
        let (mut painted, mut missed) = (0, 0);
        let mut largest: (usize, Option<u32>) = (0, None);
        for stroke in strokes {
            let wrong = || stroke.pixels.iter().copied().filter(|&p| is_missed(stroke, p));
            let count = wrong().count();
            painted += stroke.pixels.len();
            missed += count;
            // The warning points to the stroke with the most wrong pixels, at the middle one in the list of these
            // pixels.
            if count > largest.0 {
                largest = (count, wrong().nth(count / 2));
            }
        }
        let share = missed as f64 / painted.max(1) as f64;
        let message = || format!("the mask contradicts {} of the painted pixels", percent(share));
        let advice = "run the segmentation again if strokes have changed since; otherwise the classes look alike: paint \
                      more strokes on both, or give a mask of your own";
        let place = largest.1.map(|p| self.mask.centre_of(p as usize));
        let raised = self.is_learnt().then(|| Warning::above(Code::MissedStrokes, share, MAX_MISSED, message, advice));
        raised.flatten().map(|warning| warning.at(place))
    }

    /// Finds the place where another stroke helps most: the most doubtful pixel of the grid cell with the most doubt,
    /// summed over the cell and its neighbours. `None` if no pixel is doubtful.
    fn next_stroke(&self) -> Option<DVec2> {
        let (width, height) = (self.mask.width, self.mask.height);
        let side = width.max(height).div_ceil(CELLS).max(1);
        let (columns, rows) = (width.div_ceil(side), height.div_ceil(side));
        // Sum the doubt over each cell. The function `around` then adds the sums of a cell and its neighbours.
        let mut cells = vec![0.0f64; columns * rows];
        for y in 0..height {
            for x in 0..width {
                cells[y / side * columns + x / side] += f64::from(self.doubt(y * width + x));
            }
        }
        let around = |cell: usize| {
            let (x, y) = (cell % columns, cell / columns);
            let near = |v: usize, size: usize| v.saturating_sub(1)..(v + 2).min(size);
            near(y, rows)
                .flat_map(|v| near(x, columns).map(move |u| (u, v)))
                .map(|(u, v)| cells[v * columns + u])
                .sum::<f64>()
        };
        let strange = (0..cells.len()).filter(|&c| cells[c] > 0.0);
        let cell = strange.max_by(|&a, &b| around(a).total_cmp(&around(b)))?;

        let (left, top) = (cell % columns * side, cell / columns * side);
        let pixels =
            (top..(top + side).min(height)).flat_map(|y| (left..(left + side).min(width)).map(move |x| y * width + x));
        let strangest = pixels.max_by(|&p, &q| self.doubt(p).total_cmp(&self.doubt(q)))?;
        Some(self.mask.centre_of(strangest))
    }
}

/// Warns if lights cover more of their plane than lamps usually do. `None` if they do not, or if the masks differ in
/// size.
pub fn almost_all_lit(lights: &Image, plane: &Image) -> Option<Warning> {
    let shape = |mask: &Image| [mask.width, mask.height, mask.channels];
    if shape(lights) != shape(plane) {
        return None;
    }
    let on_plane = || plane.data.iter().zip(&lights.data).filter(|(plane, _)| **plane > 0.5);
    let share = on_plane().filter(|(_, light)| **light > 0.5).count() as f64 / on_plane().count().max(1) as f64;
    Warning::above(
        Code::AlmostAllLit,
        share,
        MAX_LIT,
        || format!("lights cover {} of the plane", percent(share)),
        "unless the whole plane shines: paint strokes on the plane beside the lamps, where the mask takes it for light",
    )
}

/// Warns if the painted lamps are hardly brighter than the plane. Compares the lamp strokes with two sets: the positive
/// plane strokes together with the strokes marked "not light", and the "not light" strokes alone. A plane stroke may
/// cross lamps, whereas "not light" strokes lie beside them. Of the two comparisons, the comparison in which lamps are
/// brighter with the greater probability counts (see `brighter`). The first channel of the features is L*.
pub fn dim_lamps(features: &Image, plane: &[Stroke], lights: &[Stroke]) -> Option<Warning> {
    let lamps: Vec<&Stroke> = lights.iter().filter(|s| s.positive).collect();
    let beside = || lights.iter().filter(|s| !s.positive);
    let planes = [plane.iter().filter(|s| s.positive).chain(beside()).collect(), beside().collect()];
    let compared = planes.map(|plane: Vec<&Stroke>| brighter(features, &lamps, &plane));
    let (share, darkest) = compared.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let message = || format!("{} of the plane is as bright as the pixels painted as light", percent(1.0 - share));
    let advice =
        "paint the lamps where they shine; lamps that are off, or shine away from the camera, give no light to copy";
    let warning = Warning::below(Code::DimLamps, share, MIN_BRIGHTER, message, advice);
    warning.map(|warning| warning.at(Some(features.centre_of(darkest as usize))))
}

/// Computes the probability that a random lamp pixel is brighter than a random plane pixel: the area under the receiver
/// operating characteristic of L* (Hanley and McNeil 1982). This probability is also computed for each lamp stroke
/// alone. The second result is a pixel of the stroke for which it is least. `None` if there is no lamp pixel or no
/// plane pixel.
fn brighter(features: &Image, lamps: &[&Stroke], plane: &[&Stroke]) -> Option<(f64, u32)> {
    let lightness = |&p: &u32| features.data.get(p as usize * features.channels).copied();
    let mut plane: Vec<f32> = plane.iter().flat_map(|s| &s.pixels).filter_map(lightness).collect();
    if plane.is_empty() {
        return None;
    }
    plane.sort_unstable_by(f32::total_cmp);
    // A plane pixel of equal lightness counts as half a darker pixel.
    let darker = |l: f32| (plane.partition_point(|p| *p < l) + plane.partition_point(|p| *p <= l)) as f64 / 2.0;
    let (mut count, mut sum) = (0, 0.0);
    let mut dimmest = (f64::INFINITY, 0);
    for stroke in lamps {
        let shares = stroke.pixels.iter().filter_map(lightness).map(|l| darker(l) / plane.len() as f64);
        let (pixels, own) = shares.fold((0, 0.0), |(pixels, own), share| (pixels + 1, own + share));
        (count, sum) = (count + pixels, sum + own);
        if pixels > 0 && own / f64::from(pixels) < dimmest.0 {
            dimmest = (own / f64::from(pixels), stroke.pixels[stroke.pixels.len() / 2]);
        }
    }
    (count > 0).then(|| (sum / f64::from(count), dimmest.1))
}

#[cfg(test)]
#[path = "tests/warnings.rs"]
mod tests;
