//! Compares a region of the photo with the ring of pixels around it.

use super::regions::Brightness;
use super::tree::Tree;
use crate::error::Result;
use crate::image::{Image, try_push, try_vec};

/// Width in pixels of the gap between the region and its ring. The gap holds the blurred edge of the region.
/// [convention]
const GAP: isize = 1;
/// Width of the ring in pixels. [convention]
const RING: isize = 3;

/// The result of comparing a region with the ring of pixels around it.
pub struct Surroundings {
    /// Mean L* of the region, minus the median L* of its ring.
    pub contrast: f64,
    /// Share of the ring that lies on the plane; 1 if no plane is given.
    pub on_plane: f64,
    /// The median L*, a* and b* of the ring, each computed separately.
    pub colour: [f64; 3],
}

/// Compares a node of the component tree with the ring of pixels around it. `None` if the ring has no pixels. The ring
/// leaves out
/// - the pixels that are set in `taken`;
/// - pixels at least as bright as the darkest pixel of the node: they belong to other regions, such as neighbouring
///   panes.
pub fn around(
    node: u32,
    tree: &Tree,
    photo: &Brightness,
    plane: Option<&Image>,
    taken: &[bool],
) -> Result<Option<Surroundings>> {
    let pixels = tree.pixels(node);
    let bounds = Bounds::of(pixels, photo, GAP + RING);
    let distance = bounds.distance(pixels, photo.width)?;

    let contour = pixels.iter().map(|&p| photo.levels[p as usize]).min().unwrap_or(0);
    let mut ring = Vec::new();
    let mut on_plane = 0usize;
    for (k, &d) in distance.iter().enumerate() {
        let i = bounds.pixel(k, photo.width);
        if d as isize > GAP && d as isize <= GAP + RING && !taken[i] && photo.levels[i] < contour {
            try_push(&mut ring, i)?;
            on_plane += usize::from(plane.is_none_or(|p| p.data[i] > 0.5));
        }
    }
    if ring.is_empty() {
        return Ok(None);
    }
    let mut values = try_vec(ring.len(), 0f32)?;
    let mut median = |of: &dyn Fn(usize) -> f32| {
        values.iter_mut().zip(&ring).for_each(|(value, &i)| *value = of(i));
        f64::from(*values.select_nth_unstable_by(ring.len() / 2, f32::total_cmp).1)
    };
    let [l, a, b] = [median(&|i| photo.smooth.data[i]), median(&|i| photo.lab[i][1]), median(&|i| photo.lab[i][2])];
    let mean = pixels.iter().map(|&p| f64::from(photo.smooth.data[p as usize])).sum::<f64>() / pixels.len() as f64;
    let on_plane = on_plane as f64 / ring.len() as f64;
    Ok(Some(Surroundings { contrast: mean - l, on_plane, colour: [l, a, b] }))
}

/// A rectangle of pixels, `[x0, x1) × [y0, y1)`.
pub struct Bounds {
    x0: usize,
    y0: usize,
    x1: usize,
    y1: usize,
}

impl Bounds {
    /// The bounding box of pixels, enlarged by `margin` on each side and clipped to the image.
    pub fn of(pixels: &[u32], photo: &Brightness, margin: isize) -> Self {
        let (mut x0, mut y0, mut x1, mut y1) = (photo.width, photo.height, 0, 0);
        for &p in pixels {
            let (x, y) = (p as usize % photo.width, p as usize / photo.width);
            (x0, y0, x1, y1) = (x0.min(x), y0.min(y), x1.max(x + 1), y1.max(y + 1));
        }
        let margin = margin as usize;
        Self {
            x0: x0.saturating_sub(margin),
            y0: y0.saturating_sub(margin),
            x1: (x1 + margin).min(photo.width),
            y1: (y1 + margin).min(photo.height),
        }
    }

    /// Whether the rectangle reaches the photo's border.
    pub fn touch_border(&self, photo: &Brightness) -> bool {
        self.x0 == 0 || self.y0 == 0 || self.x1 == photo.width || self.y1 == photo.height
    }

    /// Width and height of the rectangle in pixels.
    pub fn size(&self) -> [usize; 2] {
        [self.x1 - self.x0, self.y1 - self.y0]
    }

    /// Converts a pixel index of the image to an index within the rectangle; `width` is the image's width.
    pub fn index(&self, pixel: u32, width: usize) -> usize {
        (pixel as usize / width - self.y0) * (self.x1 - self.x0) + pixel as usize % width - self.x0
    }

    /// Converts the index `k` within the rectangle to a pixel index of the image; `width` is the image's width.
    pub fn pixel(&self, k: usize, width: usize) -> usize {
        let across = self.x1 - self.x0;
        (self.y0 + k / across) * width + self.x0 + k % across
    }

    /// Distance of each pixel of the rectangle from the nearest of the given pixels, in steps along rows and columns,
    /// up to 255 (two passes, Rosenfeld and Pfaltz 1966).
    pub fn distance(&self, pixels: &[u32], width: usize) -> Result<Vec<u8>> {
        let [across, down] = self.size();
        let mut distance = try_vec(across * down, u8::MAX)?;
        for &p in pixels {
            distance[self.index(p, width)] = 0;
        }
        for k in 0..distance.len() {
            let left = if k % across > 0 { distance[k - 1] } else { u8::MAX };
            let above = if k >= across { distance[k - across] } else { u8::MAX };
            distance[k] = distance[k].min(left.min(above).saturating_add(1));
        }
        for k in (0..distance.len()).rev() {
            let right = if k % across + 1 < across { distance[k + 1] } else { u8::MAX };
            let below = distance.get(k + across).copied().unwrap_or(u8::MAX);
            distance[k] = distance[k].min(right.min(below).saturating_add(1));
        }
        Ok(distance)
    }
}
