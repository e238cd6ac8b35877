//! Restores the colour of lamps that the photo shows clipped.
//!
//! A lamp is brighter than the photo's white, so its core is white in the photo whatever its colour. At the rim, the
//! lens blurs the lamp into the dark surroundings. There, all channels are below white and show the lamp's colour. The
//! core gets the colour of the rim, scaled by the smallest factor at which no channel is darker than in the photo. The
//! photo does not tell how much brighter the core really is; relighting estimates this.
//!
//! Not modelled: colour that changes within a lamp's core.

use crate::emission::exemplar::components::Components;
use crate::image::Image;
use glam::{DVec3, Vec3};

/// If a channel of any lit pixel exceeds this value, the image has a high dynamic range and is not clipped. White is 1.
/// [convention]
const MAX_CLIPPED: f32 = 1.05;
/// A pixel belongs to a lamp's rim only if its strongest channel is at least this share of the level at which channels
/// clip. [bench constants:rims]
const MIN_BRIGHTNESS: f32 = 0.5;
/// A pixel belongs to a lamp's rim only if it is at most this many columns and rows away from a pixel of the lamp.
const RIM_WIDTH: usize = 2;
/// A colour is read from a rim only if the rim has at least this number of pixels. [bench constants:rims]
const MIN_RIM: f64 = 8.0;
/// Minimum ratio of a channel of a rim's colour to its strongest channel; a weaker channel is raised to this ratio. In
/// coloured light, it limits restored values to 16 times the level at which channels clip. White light has larger
/// ratios: the blue of a lamp of 2700 K, in linear sRGB, has 0.10. Any value up to 0.09 leaves such lamps unchanged.
/// [convention]
const MIN_CHANNEL: f64 = 1.0 / 16.0;

/// The colours of lamps as read from their rims. They replace the colours of clipped pixels.
pub struct RimColours {
    /// Channel values of at least this are clipped.
    level: f32,
    /// The colour of each component, scaled so that its strongest channel is 1. A component whose rim has fewer than
    /// `MIN_RIM` pixels gets the mean colour of all rims. `None` if all rims together have fewer than `MIN_RIM` pixels.
    colours: Vec<Option<Vec3>>,
}

impl RimColours {
    /// Reads the colour of each lamp from the pixels of its rim that `shown` marks. Channel values of at least `level`
    /// count as clipped. Returns `None` if nothing is clipped: if `level` is 0, if no lit pixel reaches `level`, or if
    /// a lit pixel exceeds `MAX_CLIPPED`.
    pub fn find(image: &Image, shown: &[bool], components: &Components, level: f32) -> Option<Self> {
        let colour = |i: usize| image.rgb(i % image.width, i / image.width);
        let lit = || components.labels.iter().enumerate().filter(|(_, label)| **label != 0);
        let max_value = lit().map(|(i, _)| colour(i).max_element()).fold(0.0, f32::max);
        if level <= 0.0 || max_value < level || max_value > MAX_CLIPPED {
            return None;
        }

        // Sum up the colours and count the pixels of each rim. Entry 0 is for all rims together; lamps whose own rim
        // has too few pixels use it.
        let mut sums = vec![(DVec3::ZERO, 0.0); components.list.len() + 1];
        for (i, _) in shown.iter().enumerate().filter(|(_, shown)| **shown) {
            let value = colour(i);
            let is_rim = value.max_element() < level && value.max_element() >= MIN_BRIGHTNESS * level;
            if let Some(label) = is_rim.then(|| label_near(components, i, image.width, image.height)).flatten() {
                for sum in [label as usize, 0] {
                    sums[sum].0 += value.max(Vec3::ZERO).as_dvec3();
                    sums[sum].1 += 1.0;
                }
            }
        }
        let of = |(sum, count): (DVec3, f64)| {
            let strongest = sum.max_element();
            (count >= MIN_RIM && strongest > 0.0).then(|| (sum / strongest).max(DVec3::splat(MIN_CHANNEL)).as_vec3())
        };
        let all = of(sums[0]);
        Some(Self { level, colours: sums[1..].iter().map(|&sum| of(sum).or(all)).collect() })
    }

    /// Replaces the clipped channels of `value`, a pixel of a component, by the channels of the rim's colour times a
    /// factor. The factor is the smallest for which no channel of the product is below `value`. Returns `value` if no
    /// channel is clipped, or if the component has no colour.
    pub fn undo(&self, component: usize, value: Vec3) -> Vec3 {
        let clipped = value.cmpge(Vec3::splat(self.level));
        match self.colours.get(component).copied().flatten() {
            Some(colour) if clipped.any() => {
                // Find the factor. The rim's colour reaches `value` in a channel if it is multiplied by at least the
                // channel's `strength`. Take the largest of all channels.
                let strength = value / colour;
                let min_factor = Vec3::select(clipped, strength, Vec3::ZERO).max_element();
                let open = Vec3::select(clipped, Vec3::ZERO, strength).max_element();
                Vec3::select(clipped, (colour * min_factor.max(open)).max(value), value)
            }
            _ => value,
        }
    }
}

/// The label of the component that contains pixel `i` or, if there is none, of a component within [`RIM_WIDTH`] columns
/// and rows. `None` if there is no such component either.
fn label_near(components: &Components, i: usize, width: usize, height: usize) -> Option<u32> {
    let (x, y) = (i % width, i / width);
    let rows = y.saturating_sub(RIM_WIDTH)..(y + RIM_WIDTH + 1).min(height);
    let columns = x.saturating_sub(RIM_WIDTH)..(x + RIM_WIDTH + 1).min(width);
    let own = components.labels[i];
    (own != 0).then_some(own).or_else(|| {
        rows.flat_map(|y| columns.clone().map(move |x| y * width + x))
            .map(|i| components.labels[i])
            .find(|&label| label != 0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emission::exemplar::components;

    /// A photo of round lamps, blurred by a lens and clipped at 1. Each lamp is given as (x, y, colour); the colours
    /// are brighter than white.
    fn photo(lamps: &[(f32, f32, Vec3)]) -> Image {
        Image::from_fn(160, 60, |x, y| {
            let light: Vec3 = lamps
                .iter()
                .map(|&(u, v, colour)| {
                    let distance = (x as f32 + 0.5 - u).hypot(y as f32 + 0.5 - v);
                    colour / (1.0 + ((distance - 12.0) / 1.5).exp())
                })
                .sum();
            (light + 0.05).min(Vec3::ONE).to_array()
        })
        .unwrap()
    }

    #[test]
    fn clipped_lamps_get_the_colour_of_their_rim() {
        let (warm, cool) = (Vec3::new(4.0, 2.8, 1.6), Vec3::new(2.0, 2.6, 3.6));
        let image = photo(&[(40.0, 30.0, warm), (110.0, 30.0, cool)]);
        let found = components::find(160, 60, |i| image.rgb(i % 160, i / 160).max_element() > 0.6).unwrap();
        let rim_colours = RimColours::find(&image, &[true; 160 * 60], &found, 0.95).unwrap();
        for (component, truth, x) in [(0, warm, 40), (1, cool, 110)] {
            assert_eq!(image.rgb(x, 30), Vec3::ONE);
            let light = rim_colours.undo(component, Vec3::ONE);
            // The photo shows the core as (1, 1, 1). The ratios between the lamp's channels must be restored. The
            // tolerance is needed because the surroundings contribute up to a tenth of the light in the rim.
            for (a, b) in [(0, 1), (1, 2), (0, 2)] {
                let (stated, true_ratio) = (light[a] / light[b], truth[a] / truth[b]);
                assert!((stated / true_ratio - 1.0).abs() < 0.12, "{light} for {truth}");
            }
            assert!(light.min_element() >= 0.95, "{light}: darker than the photo");
            // Unclipped channels stay unchanged.
            assert_eq!(rim_colours.undo(component, Vec3::splat(0.5)), Vec3::splat(0.5));
            assert_eq!(rim_colours.undo(component, Vec3::new(1.0, 0.5, 0.4)).yz(), glam::Vec2::new(0.5, 0.4));
        }
    }

    use glam::Vec3Swizzles;

    #[test]
    fn what_is_not_clipped_and_what_has_no_rim_stays() {
        let dim = photo(&[(40.0, 30.0, Vec3::splat(0.8))]);
        let found = components::find(160, 60, |i| dim.data[3 * i] > 0.4).unwrap();
        assert!(RimColours::find(&dim, &[true; 160 * 60], &found, 0.95).is_none());
        let hdr = Image::from_fn(20, 20, |x, _| [0.9 + x as f32 / 4.0; 3]).unwrap();
        let found = components::find(20, 20, |_| true).unwrap();
        assert!(RimColours::find(&hdr, &[true; 400], &found, 0.95).is_none());
        let hard = Image::from_fn(20, 20, |x, _| [f32::from(x > 9); 3]).unwrap();
        let found = components::find(20, 20, |i| hard.data[3 * i] > 0.5).unwrap();
        let rim_colours = RimColours::find(&hard, &[true; 400], &found, 0.95).unwrap();
        assert_eq!(rim_colours.undo(0, Vec3::ONE), Vec3::ONE);
    }
}
