//! Draws strokes as a person in a hurry would: few, short and wobbly, and sometimes slightly over the edge.

use super::dice::Dice;
use super::exposure::NO_LAMP;
use super::room::Class;
use glam::DVec2;
use std::fmt::Write;

/// Number of attempts to place a stroke before it is given up.
const TRIES: usize = 120;
/// Minimum share of a stroke's pixels that must lie on the intended surface.
const MIN_INSIDE: f64 = 0.97;
/// That minimum for a careless stroke, and the probability that a stroke is careless.
const CARELESS: (f64, f32) = (0.9, 0.06);

/// The contents of a photo's pixels, as the person who draws sees them.
pub struct Scenery<'a> {
    pub width: usize,
    pub height: usize,
    pub classes: &'a [u8],
    pub lamps: &'a [u16],
}

/// Numbers of strokes: on the plane, off the plane, on lamps, beside lamps.
pub type Counts = [usize; 4];

/// Ten strokes in all.
pub const TEN: Counts = [3, 3, 2, 2];

/// Draws the numbers of strokes, eight to eighteen in all.
pub fn counts(dice: &mut Dice) -> Counts {
    [dice.whole(2, 4), dice.whole(3, 6), dice.whole(2, 5), dice.whole(1, 3)]
}

/// Draws strokes on a photo; returns them as the text that the library reads.
pub fn draw(scenery: &Scenery, counts: Counts, dice: &mut Dice) -> String {
    let mut hand = Hand { scenery, dice, text: String::new() };
    let brush = 0.006 * scenery.height as f64;
    let is = |class: Class| move |s: &Scenery, i: usize| s.classes[i] == class as u8;
    let is_other = |s: &Scenery, i: usize| !matches!(s.classes[i], 1 | 2 | 7);
    (0..counts[0]).for_each(|_| hand.anywhere("plane", brush, &is(Class::Ceiling)));
    (0..counts[1]).for_each(|k| match k {
        // In half of the photos, one stroke lies on an object that hangs before the ceiling.
        2 if hand.dice.chance(0.5) => hand.anywhere("not-plane", brush, &is(Class::Hanging)),
        _ => hand.anywhere("not-plane", brush, &is_other),
    });
    hand.lamps(counts[2]);
    (0..counts[3]).for_each(|k| match k {
        1 if hand.dice.chance(0.3) => hand.anywhere("not-light", 0.7 * brush, &is(Class::Window)),
        _ => hand.beside_lamps(0.7 * brush),
    });
    hand.text
}

struct Hand<'a> {
    scenery: &'a Scenery<'a>,
    dice: &'a mut Dice,
    text: String,
}

type Test<'a> = &'a dyn Fn(&Scenery, usize) -> bool;

impl Hand<'_> {
    /// Draws a stroke somewhere on pixels that the test accepts.
    fn anywhere(&mut self, word: &str, brush: f64, accepts: Test) {
        let scenery = self.scenery;
        let starts: Vec<usize> = (0..scenery.classes.len()).filter(|i| accepts(scenery, *i)).collect();
        if starts.is_empty() {
            return;
        }
        for attempt in 0..TRIES {
            let start = starts[self.dice.below(starts.len())];
            // Try shorter and shorter strokes, in case there is little room.
            let reach = 1.0 - attempt as f64 / TRIES as f64;
            let diagonal = (scenery.width as f64).hypot(scenery.height as f64);
            let length = f64::from(self.dice.between(0.04, 0.16)) * diagonal * reach;
            let level = self.dice.chance(0.6);
            let angle = if level { 0.3 * self.dice.normal() } else { self.dice.between(0.0, 3.15) };
            let points = self.wobbly(self.point(start), DVec2::from_angle(angle.into()) * length);
            if self.keeps_within(&points, brush * reach.max(0.4), accepts) {
                self.write(word, brush * reach.max(0.4), &points);
                return;
            }
        }
    }

    /// Draws strokes on lamps, each on another lamp; larger lamps are more likely.
    fn lamps(&mut self, count: usize) {
        let mut seen: Vec<(u16, Vec<usize>)> = Vec::new();
        for (i, &lamp) in self.scenery.lamps.iter().enumerate().filter(|(_, lamp)| **lamp != NO_LAMP) {
            match seen.iter_mut().find(|(number, _)| *number == lamp) {
                Some((_, pixels)) => pixels.push(i),
                None => seen.push((lamp, vec![i])),
            }
        }
        for _ in 0..count {
            let weights: Vec<(usize, f32)> = seen
                .iter()
                .enumerate()
                .filter(|(_, s)| s.1.len() >= 9)
                .map(|(k, s)| (k, (s.1.len() as f32).sqrt()))
                .collect();
            if weights.is_empty() {
                return;
            }
            let (lamp, pixels) = seen.swap_remove(self.dice.weighted(&weights));
            self.lamp(lamp, &pixels);
        }
    }

    /// Draws a stroke along a lamp, or a dot on a small lamp.
    fn lamp(&mut self, lamp: u16, pixels: &[usize]) {
        let points: Vec<DVec2> = pixels.iter().map(|&i| self.point(i)).collect();
        let mean = points.iter().sum::<DVec2>() / points.len() as f64;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for d in points.iter().map(|p| *p - mean) {
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
        }
        // Compute the principal axis and the half-axes of the ellipse with these second moments.
        let count = points.len() as f64;
        let (middle, half) = ((xx + yy) / 2.0 / count, ((xx - yy) / 2.0 / count).hypot(xy / count));
        let axis = DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy));
        let (long, short) = (2.0 * (middle + half).sqrt(), 2.0 * (middle - half).max(0.0).sqrt());
        let accepts = move |s: &Scenery, i: usize| s.lamps[i] == lamp;
        for attempt in 0..TRIES {
            let reach = 1.0 - attempt as f64 / TRIES as f64;
            let brush = (0.45 * short * reach).clamp(1.0, 0.008 * self.scenery.height as f64);
            let length = 2.0 * long * f64::from(self.dice.between(0.35, 0.75)) * reach;
            let (start, along) = match length > 3.0 * brush && attempt < TRIES / 2 {
                true => (mean - axis * length / 2.0, axis * length),
                // Draw a dot or a dash on any pixel of the lamp: the centre of a ring, for example, is not on the
                // lamp.
                false => (points[self.dice.below(points.len())], axis * (0.3 * length)),
            };
            let points = if along.length() > 4.0 { self.wobbly(start, along) } else { vec![start] };
            if self.keeps_within(&points, brush, &accepts) {
                self.write("light", brush, &points);
                return;
            }
        }
    }

    /// Draws a stroke on the ceiling near a lamp.
    fn beside_lamps(&mut self, brush: f64) {
        let (width, height) = (self.scenery.width, self.scenery.height);
        let near = (0.03 * height as f64) as usize + 3;
        let is_near = move |s: &Scenery, i: usize| {
            let (x, y) = (i % width, i / width);
            let ring = [(x.wrapping_sub(near), y), (x + near, y), (x, y.wrapping_sub(near)), (x, y + near)];
            let is_lamp = |&(x, y): &(usize, usize)| x < width && y < height && s.lamps[y * width + x] != NO_LAMP;
            s.classes[i] == Class::Ceiling as u8 && ring.iter().any(is_lamp)
        };
        let before = self.text.len();
        let starts: Vec<usize> = (0..width * height).filter(|i| is_near(self.scenery, *i)).collect();
        let accepts = |s: &Scenery, i: usize| s.classes[i] == Class::Ceiling as u8;
        for attempt in 0..TRIES {
            if starts.is_empty() {
                break;
            }
            let start = starts[self.dice.below(starts.len())];
            let length =
                f64::from(self.dice.between(0.02, 0.1)) * height as f64 * (1.0 - attempt as f64 / TRIES as f64);
            let along = DVec2::from_angle(self.dice.between(0.0, 6.3).into()) * length;
            let points = self.wobbly(self.point(start), along);
            if self.keeps_within(&points, brush, &accepts) {
                self.write("not-light", brush, &points);
                return;
            }
        }
        if self.text.len() == before {
            self.anywhere("not-light", brush, &accepts);
        }
    }

    fn point(&self, pixel: usize) -> DVec2 {
        DVec2::new((pixel % self.scenery.width) as f64 + 0.5, (pixel / self.scenery.width) as f64 + 0.5)
    }

    /// A polyline along `along`, with random deviations.
    fn wobbly(&mut self, start: DVec2, along: DVec2) -> Vec<DVec2> {
        let pieces = self.dice.whole(1, 3);
        let wobble = 0.05 * along.length();
        let at = |dice: &mut Dice, i: usize| {
            let off = DVec2::new(dice.normal().into(), dice.normal().into()) * if i == 0 { 0.0 } else { wobble };
            start + along * (i as f64 / pieces as f64) + off
        };
        (0..=pieces).map(|i| at(self.dice, i)).collect()
    }

    fn keeps_within(&mut self, points: &[DVec2], brush: f64, accepts: Test) -> bool {
        let scenery = self.scenery;
        let size = DVec2::new(scenery.width as f64, scenery.height as f64);
        if points.iter().any(|p| p.min_element() < 1.0 || (size - *p).min_element() < 1.0) {
            return false;
        }
        let stroke = luxfer::segment::Stroke::polyline(points, brush, true, scenery.width, scenery.height);
        let pixels = stroke.map(|s| s.pixels).unwrap_or_default();
        let inside = pixels.iter().filter(|&&i| accepts(scenery, i as usize)).count();
        let least = if self.dice.chance(CARELESS.1) { CARELESS.0 } else { MIN_INSIDE };
        !pixels.is_empty() && inside as f64 >= least * pixels.len() as f64
    }

    fn write(&mut self, word: &str, brush: f64, points: &[DVec2]) {
        let _ = write!(self.text, "{word:10} {brush:.1}");
        for p in points {
            let _ = write!(self.text, "  {:.1} {:.1}", p.x, p.y);
        }
        self.text.push('\n');
    }
}
