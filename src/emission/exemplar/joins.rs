//! Joins the parts of a lamp that the light mask separates: a pipe, a cable or a beam hides a strip of the lamp, or a
//! narrow bar divides it.
//!
//! Two lights side by side may also be two lamps. The other lights of the photo decide. The two lights count as parts
//! of one lamp in two cases:
//!
//! - Another lamp, in one piece, is as large as both lights together.
//! - Two other lights form a pair that is as large as this pair, and a narrow bar divides each of the two pairs.
//!   Besides, no other lamp that is as large as one of the two lights lies alone or in a row of three or more.

use super::bars::LitPlane;
use super::components::{self, Component, Components};
use super::measured_lamp::{MAX_SIDE_DIFFERENCE, MeasuredLamp};
use super::panes::MAX_LEADING_SHARE;
use super::roles::{self, Role};
use crate::error::Result;
use crate::image::{Image, try_collect};
use crate::job::Job;

/// The dark strip between two parts of a lamp is at most this share of the lamp's side across the strip.
/// [bench photos:real] (docs/notes/photos.md, "Lamps that protrude, and lamps in parts").
const MAX_STRIP: f64 = 0.2;
/// A light counts as rectangular if it covers at least this share of its bounding box. For two parts of a lamp, this is
/// the box around both, without the strip between them. A disc covers only π/4 = 0.79 of its box; a rectangle with
/// frayed edges covers more than this share. Lights that are not rectangular are not joined, because they could be
/// parts of anything. [convention]
const MIN_COVERED: f64 = 0.85;
/// Images with more lights than this are left as they are. The search compares all pairs of lights, so its time grows
/// with the square of their number. Among this many lamps, enough are in one piece to show the pattern. [convention]
const MAX_LIGHTS: usize = 400;

/// Returns the light mask with the strips inside lamps filled. `None` if no lamp consists of two parts, or if there are
/// more than [`MAX_LIGHTS`] lights.
pub fn join(plane: &LitPlane, job: Job) -> Result<Option<Image>> {
    let (width, height) = (plane.light.width, plane.light.height);
    let found = components::find(width, height, |i| plane.is_lit(i))?;
    if found.list.len() > MAX_LIGHTS {
        return Ok(None);
    }
    job.check()?;
    let lights = LightPairs::new(plane, &found)?;
    let mut joined = None;
    for pair in lights.pairs.iter().filter(|pair| lights.are_one_lamp(pair)) {
        let light = match &mut joined {
            Some(light) => light,
            None => joined.insert(plane.light.try_clone()?),
        };
        fill(light, pair.strip);
    }
    Ok(joined)
}

/// Two lights that lie side by side like two parts of a lamp.
struct Pair {
    /// The indices of the lights.
    parts: [usize; 2],
    /// Both lights together, measured as one lamp.
    both: MeasuredLamp,
    /// The dark strip between the lights: `[first column, first row]` and `[last column, last row]`.
    strip: [[usize; 2]; 2],
    /// Whether the strip is a narrow bar: at most the share [`MAX_LEADING_SHARE`] of the pair's side across the strip.
    is_bar: bool,
}

struct LightPairs {
    sizes: Vec<MeasuredLamp>,
    /// Whether each light is rectangular ([`MIN_COVERED`]) and counts as whole, that is, the border does not cut it.
    is_lamp: Vec<bool>,
    pairs: Vec<Pair>,
    /// Number of pairs to which each light belongs.
    pairs_of: Vec<usize>,
}

impl LightPairs {
    fn new(plane: &LitPlane, found: &Components) -> Result<Self> {
        let measured = |k: usize, lamp: &Component| MeasuredLamp::new(k, lamp, lamp.area as f64, plane.to_photo);
        let mut pairs = Vec::new();
        for (i, a) in found.list.iter().enumerate() {
            for (j, b) in found.list.iter().enumerate().skip(i + 1) {
                let Some((strip, share)) = strip_between(a, b) else { continue };
                let both = united(a, b);
                let strip_area: usize = (0..2).map(|k| strip[1][k] + 1 - strip[0][k]).product();
                if is_rectangle(&both, strip_area) {
                    pairs.push(Pair {
                        parts: [i, j],
                        both: measured(i, &both),
                        strip,
                        is_bar: share <= MAX_LEADING_SHARE,
                    });
                }
            }
        }
        let shown = try_collect((0..plane.light.data.len()).map(|i| plane.is_valid(i)))?;
        let roles: Vec<Role> = roles::classify(found, &shown, plane.light.width, plane.light.height);
        let lamps = || found.list.iter().enumerate();
        let pairs_of = |k: usize| pairs.iter().filter(|pair| pair.parts.contains(&k)).count();
        Ok(Self {
            sizes: lamps().map(|(k, lamp)| measured(k, lamp)).collect(),
            is_lamp: lamps().map(|(k, lamp)| roles[k].is_whole() && is_rectangle(lamp, 0)).collect(),
            pairs_of: lamps().map(|(k, _)| pairs_of(k)).collect(),
            pairs,
        })
    }

    /// Whether the two lights of a pair are parts of one lamp, by the two cases at the beginning of this file.
    fn are_one_lamp(&self, pair: &Pair) -> bool {
        let lamps = || (0..self.sizes.len()).filter(|k| self.is_lamp[*k] && !pair.parts.contains(k));
        if lamps().any(|k| self.sizes[k].is_as_large(&pair.both)) {
            return true;
        }
        let part = &self.sizes[pair.parts[0]];
        let is_alone = |pair: &Pair| pair.is_bar && pair.parts.iter().all(|k| self.pairs_of[*k] == 1);
        let is_twin = |other: &Pair| other.parts != pair.parts && is_alone(other) && other.both.is_as_large(&pair.both);
        let are_panels = lamps().any(|k| self.pairs_of[k] != 1 && self.sizes[k].is_as_large(part));
        is_alone(pair) && !are_panels && self.pairs.iter().any(is_twin)
    }
}

/// Whether a light is rectangular ([`MIN_COVERED`]); `strip` pixels of its bounding box do not count.
fn is_rectangle(light: &Component, strip: usize) -> bool {
    let box_area: usize = light.size().iter().product();
    light.area as f64 >= MIN_COVERED * (box_area - strip) as f64
}

/// Two lights as one component.
fn united(a: &Component, b: &Component) -> Component {
    let each = |pick: fn(usize, usize) -> usize, a: [usize; 2], b: [usize; 2]| [pick(a[0], b[0]), pick(a[1], b[1])];
    let (min, max) = (each(usize::min, a.min, b.min), each(usize::max, a.max, b.max));
    let area = a.area + b.area;
    Component { area, centre: (a.centre * a.area as f64 + b.centre * b.area as f64) / area as f64, min, max }
}

/// The strip between two lights ([`Pair::strip`]), and its width as a share of the pair's side across the strip. `None`
/// if there is no strip, if it is wider than [`MAX_STRIP`], or if the lights do not begin and end at about the same
/// positions along the strip.
fn strip_between(a: &Component, b: &Component) -> Option<([[usize; 2]; 2], f64)> {
    (0..2).find_map(|across| {
        let along = 1 - across;
        let (first, second) = if a.min[across] <= b.min[across] { (a, b) } else { (b, a) };
        let gap = second.min[across].checked_sub(first.max[across] + 1).filter(|gap| *gap > 0)?;
        let share = gap as f64 / (second.max[across] + 1 - first.min[across]) as f64;
        let (low, high) = (a.min[along].max(b.min[along]), a.max[along].min(b.max[along]));
        let length = a.max[along].max(b.max[along]) + 1 - a.min[along].min(b.min[along]);
        let has_equal_ends = low <= high && (length - (high + 1 - low)) as f64 <= MAX_SIDE_DIFFERENCE * length as f64;
        let mut strip = [[low; 2], [high; 2]];
        (strip[0][across], strip[1][across]) = (first.max[across] + 1, second.min[across] - 1);
        (has_equal_ends && share <= MAX_STRIP).then_some((strip, share))
    })
}

fn fill(light: &mut Image, [min, max]: [[usize; 2]; 2]) {
    for y in min[1]..=max[1] {
        let row = y * light.width;
        light.data[row + min[0]..=row + max[0]].fill(1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::job::Monitor;

    /// The joined mask of a dark plane with the given lights, each `[left, top, width, height]`.
    fn joined(lights: &[[usize; 4]]) -> Option<Image> {
        let is_lit = |x: usize, y: usize| {
            lights.iter().any(|[left, top, w, h]| (*left..left + w).contains(&x) && (*top..top + h).contains(&y))
        };
        let light = Image::from_fn(200, 120, |x, y| [f32::from(is_lit(x, y))]).unwrap();
        let unwarped = Image::from_fn(200, 120, |x, y| [light.pixel(x, y)[0]; 3]).unwrap();
        let valid = Image::from_fn(200, 120, |_, _| [1.0]).unwrap();
        let plane = LitPlane { unwarped: &unwarped, light: &light, valid: &valid, to_photo: None };
        join(&plane, Monitor::default().job()).unwrap()
    }

    #[test]
    fn parts_are_joined_if_another_lamp_is_as_large_as_both() {
        let lamp = [20, 20, 100, 16];
        let light = joined(&[lamp, [20, 60, 44, 16], [78, 61, 42, 15]]).unwrap();
        for x in 20..120 {
            assert_eq!(light.pixel(x, 64)[0], 1.0, "column {x}");
        }
        assert_eq!(light.data.iter().filter(|v| **v == 1.0).count(), 1600 + 44 * 16 + 42 * 15 + 14 * 15);
        // Two panes, above and below a bar. Beside them is a lamp as large as both panes and the bar.
        assert!(joined(&[[20, 20, 30, 28], [20, 51, 30, 28], [100, 20, 30, 59]]).is_some());
    }

    #[test]
    fn equal_pairs_with_narrow_bars_are_lamps() {
        let pairs = [[20, 10, 30, 60], [52, 10, 30, 60], [120, 40, 30, 60], [152, 41, 31, 60]];
        let light = joined(&pairs).unwrap();
        assert_eq!((light.pixel(51, 30)[0], light.pixel(151, 70)[0]), (1.0, 1.0));
        // A single pair is no evidence that its lights are one lamp, and a wide gap is no bar.
        assert!(joined(&pairs[..2]).is_none());
        assert!(joined(&[[20, 10, 30, 60], [58, 10, 30, 60], [110, 40, 30, 60], [148, 40, 30, 60]]).is_none());
    }

    #[test]
    fn two_lamps_stay_two() {
        let lamp = [20, 20, 100, 16];
        // In turn: no lamp is as large as both lights; the strip is too wide; the lights are shifted against each
        // other.
        assert!(joined(&[[20, 60, 44, 16], [78, 60, 42, 16]]).is_none());
        assert!(joined(&[lamp, [20, 60, 30, 16], [90, 60, 30, 16]]).is_none());
        assert!(joined(&[lamp, [20, 60, 44, 16], [78, 68, 42, 16]]).is_none());
        // A small light beside a lamp. No third light is as large as both together.
        assert!(joined(&[lamp, [124, 20, 20, 16]]).is_none());
        // Two rows of three panels each, with narrow bars. The middle panel of a row forms pairs with both neighbours,
        // so no pair counts as a lamp.
        let row = |y: usize| [20, 52, 84].map(|x| [x, y, 30, 30]);
        assert!(joined(&[row(10), row(70)].concat()).is_none());
        // Two equal pairs with narrow bars are two lamps, unless a single panel elsewhere is as large as one part.
        let pair = |x: usize| [[x, 10, 30, 30], [x + 32, 10, 30, 30]];
        assert!(joined(&[pair(10), pair(100)].concat()).is_some());
        assert!(joined(&[pair(10).to_vec(), pair(100).to_vec(), vec![[60, 70, 30, 30]]].concat()).is_none());
    }
}
