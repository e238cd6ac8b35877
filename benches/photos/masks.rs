//! Masks of whole pixels: filled from polygons, dilated, compared, and split into connected parts.

use glam::DVec2;
use luxfer::image::Image;

/// A mask with one flag per pixel, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Mask {
    pub width: usize,
    pub height: usize,
    pub on: Vec<bool>,
}

impl Mask {
    pub fn new(width: usize, height: usize) -> Self {
        Self { width, height, on: vec![false; width * height] }
    }

    /// Mask of the pixels whose first channel is above one half.
    pub fn of(image: &Image) -> Self {
        let on = image.data.chunks_exact(image.channels).map(|pixel| pixel[0] > 0.5).collect();
        Self { width: image.width, height: image.height, on }
    }

    pub fn count(&self) -> usize {
        self.on.iter().filter(|on| **on).count()
    }

    /// Number of pixels that are set in both masks.
    pub fn common(&self, other: &Self) -> usize {
        self.on.iter().zip(&other.on).filter(|(a, b)| **a && **b).count()
    }

    /// Intersection over union with another mask; 1 for two empty masks.
    pub fn iou(&self, other: &Self) -> f64 {
        let common = self.common(other);
        let union = self.count() + other.count() - common;
        if union == 0 { 1.0 } else { common as f64 / union as f64 }
    }

    /// Whether the pixel that contains a point is set; a point outside the image is moved to the nearest pixel.
    pub fn holds(&self, point: DVec2) -> bool {
        let clip = |v: f64, size: usize| (v.max(0.0) as usize).min(size - 1);
        self.on[clip(point.y, self.height) * self.width + clip(point.x, self.width)]
    }

    /// Sets the pixels whose centres lie inside a polygon, by the even-odd rule.
    pub fn fill(&mut self, polygon: &[DVec2]) {
        let (low, high) = polygon.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p.y), high.max(p.y)));
        let first = (low - 0.5).ceil().max(0.0) as usize;
        let end = ((high + 0.5).floor().max(0.0) as usize).min(self.height);
        for y in first..end {
            let level = y as f64 + 0.5;
            let mut cuts: Vec<f64> = (0..polygon.len())
                .map(|i| (polygon[i], polygon[(i + 1) % polygon.len()]))
                .filter(|(a, b)| (a.y <= level) != (b.y <= level))
                .map(|(a, b)| a.x + (level - a.y) / (b.y - a.y) * (b.x - a.x))
                .collect();
            cuts.sort_by(f64::total_cmp);
            for pair in cuts.chunks_exact(2) {
                let from = ((pair[0] - 0.5).ceil().max(0.0) as usize).min(self.width);
                let to = ((pair[1] + 0.5).floor().max(0.0) as usize).clamp(from, self.width);
                self.on[y * self.width + from..y * self.width + to].fill(true);
            }
        }
    }

    /// Mask of the pixels that are at most `steps` horizontal or vertical steps away from this mask.
    pub fn dilated(&self, steps: u32) -> Self {
        let (w, h) = (self.width, self.height);
        let mut distance: Vec<u32> = self.on.iter().map(|&on| if on { 0 } else { u32::MAX / 2 }).collect();
        // Compute distances along rows and columns in two passes: from the top left, then from the bottom right.
        for i in 0..w * h {
            let left = if i % w > 0 { distance[i - 1] } else { u32::MAX / 2 };
            let up = if i >= w { distance[i - w] } else { u32::MAX / 2 };
            distance[i] = distance[i].min(left + 1).min(up + 1);
        }
        for i in (0..w * h).rev() {
            let right = if i % w + 1 < w { distance[i + 1] } else { u32::MAX / 2 };
            let down = if i + w < w * h { distance[i + w] } else { u32::MAX / 2 };
            distance[i] = distance[i].min(right + 1).min(down + 1);
        }
        Self { on: distance.into_iter().map(|d| d <= steps).collect(), ..*self }
    }

    /// Lists the pixels of each 4-connected part.
    pub fn parts(&self) -> Vec<Vec<usize>> {
        let (w, h) = (self.width, self.height);
        let mut open = self.on.clone();
        let mut parts = Vec::new();
        for start in 0..w * h {
            if !std::mem::take(&mut open[start]) {
                continue;
            }
            let mut part = vec![start];
            let mut next = 0;
            while let Some(&i) = part.get(next) {
                next += 1;
                let beside = [(i % w > 0, i.wrapping_sub(1)), (i % w + 1 < w, i + 1)];
                let above = [(i >= w, i.wrapping_sub(w)), (i + w < w * h, i + w)];
                for (_, j) in beside.into_iter().chain(above).filter(|(is_inside, _)| *is_inside) {
                    if std::mem::take(&mut open[j]) {
                        part.push(j);
                    }
                }
            }
            parts.push(part);
        }
        parts
    }
}
