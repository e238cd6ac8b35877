//! Bands of rows, each with a list of the lamps that may touch it, so that rendering a texel tests few lamps.

use super::layer::Layer;
use crate::emission::lamps::instance::Instance;
use glam::DVec2;

/// Number of rows of texels that share one list of lamps. [bench emission:seconds]
const BAND: usize = 16;

/// For each band of rows, the lamps that may touch it. An entry holds the index of a lamp in `Layer::instances`, and
/// the rectangle of texels `[x0, y0, x1, y1)` that the lamp may touch.
#[derive(Default)]
pub struct Bands(Vec<Vec<(u32, [u32; 4])>>);

impl Bands {
    pub fn new(layer: &Layer, width: usize, height: usize) -> Self {
        let mut bands = vec![Vec::new(); height.div_ceil(BAND)];
        for (i, instance) in layer.instances.iter().enumerate() {
            if let Some(range) = texels(layer, instance, width, height) {
                let rows = range[1] / BAND..=(range[3] - 1) / BAND;
                bands[rows].iter_mut().for_each(|b: &mut Vec<_>| b.push((i as u32, range.map(|r| r as u32))));
            }
        }
        Self(bands)
    }

    /// The lamps that may touch a row, each with the texels that it may touch.
    pub fn of_row(&self, y: usize) -> &[(u32, [u32; 4])] {
        &self.0[y / BAND]
    }
}

/// The rectangle of texels `[x0, y0, x1, y1)` that a lamp may touch; `None` if the lamp lies outside the texture.
fn texels(layer: &Layer, instance: &Instance, width: usize, height: usize) -> Option<[usize; 4]> {
    let shift = layer.rounded(instance.shift);
    let (first, last) = match layer.designs.of(instance.component) {
        Some((design, fitted)) => (fitted.centre - design.half_box(), fitted.centre + design.half_box()),
        None => layer.exemplar.components.list[instance.component].bounds(),
    };
    let low = ((first + shift) / layer.scale).floor() - 1.0;
    let high = ((last + shift) / layer.scale).ceil() + 1.0;
    let low = low.max(DVec2::ZERO);
    let high = high.min(DVec2::new(width as f64, height as f64));
    (low.x < high.x && low.y < high.y).then_some([low.x as usize, low.y as usize, high.x as usize, high.y as usize])
}
