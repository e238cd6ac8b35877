//! Computes the coverage of each texel: the share of the texel that light covers. The areas and outlines of lamps are
//! computed from the coverage.

use crate::emission::exemplar::components::Components;
use crate::error::Result;
use crate::image::try_vec;

/// Steps from a texel to the eight texels around it.
const AROUND: [[isize; 2]; 8] = [[-1, -1], [0, -1], [1, -1], [-1, 0], [1, 0], [-1, 1], [0, 1], [1, 1]];

/// Function from a texel's index to its coverage, the share of the texel that light covers. Coverage is at least 0.5
/// for texels of a lamp and less for all other texels.
pub type Coverage<'a> = &'a dyn Fn(usize) -> f32;

/// The lamps of a texture, with the coverage of each texel.
pub struct LampCoverage<'a> {
    width: usize,
    height: usize,
    /// For each texel, the number of its lamp, or 0.
    labels: &'a [u32],
    coverage: Coverage<'a>,
    /// For each lamp number, the largest coverage of the lamp's texels. This value counts as full coverage, because the
    /// light mask may be below 1 even in the middle of a lamp.
    full: Vec<f32>,
}

impl<'a> LampCoverage<'a> {
    pub fn new(found: &'a Components, coverage: Coverage<'a>, width: usize, height: usize) -> Result<Self> {
        let mut full = try_vec(found.list.len() + 1, 0f32)?;
        for (i, &label) in found.labels.iter().enumerate().filter(|(_, label)| **label != 0) {
            full[label as usize] = full[label as usize].max(coverage(i));
        }
        Ok(Self { width, height, labels: &found.labels, coverage, full })
    }

    fn index(&self, [x, y]: [isize; 2]) -> Option<usize> {
        let inside = x >= 0 && y >= 0 && x < self.width as isize && y < self.height as isize;
        inside.then(|| y as usize * self.width + x as usize)
    }

    /// The number of a texel's lamp, or 0; `None` outside the texture.
    pub fn label(&self, at: [isize; 2]) -> Option<u32> {
        self.index(at).map(|i| self.labels[i])
    }

    /// The coverage of a texel, divided by full coverage. The full coverage of a lamp is the largest coverage of its
    /// texels. A texel of a lamp is divided by the full coverage of this lamp, and the result is at least 0.5. Any
    /// other texel is divided by the largest full coverage of the adjacent lamps, or by 1 if no lamp is adjacent, and
    /// the result is at most 0.5. `None` outside the texture.
    pub fn coverage(&self, at: [isize; 2]) -> Option<f64> {
        let i = self.index(at)?;
        let around = AROUND.iter().filter_map(|[u, v]| self.label([at[0] + u, at[1] + v]));
        let full = match self.labels[i] {
            0 => around.map(|label| self.full[label as usize]).fold(0.0, f32::max),
            label => self.full[label as usize],
        };
        let share = f64::from((self.coverage)(i)) / f64::from(if full > 0.0 { full } else { 1.0 });
        Some(if self.labels[i] != 0 { share.clamp(0.5, 1.0) } else { share.clamp(0.0, 0.5) })
    }

    /// Calls `add` for each lit area that is attributed to the lamp texel `at`. A texel is dark if light covers less
    /// than half of it.
    ///
    /// - If none of the eight texels around `at` is dark, `add` gets the whole texel `at`.
    /// - Otherwise `add` gets the lit part of `at`, and a share of the lit part of each dark texel around `at`. The lit
    ///   part of a dark texel is divided equally among all lamp texels around that texel.
    ///
    /// The arguments of `add` are the step from `at` to the texel that holds the area, and the area in texels.
    pub fn parts(&self, at: [isize; 2], mut add: impl FnMut([isize; 2], f64)) {
        let is_dark = |at: [isize; 2]| self.label(at) == Some(0);
        let step = |by: [isize; 2], from: [isize; 2]| [from[0] + by[0], from[1] + by[1]];
        if !AROUND.iter().any(|&by| is_dark(step(by, at))) {
            return add([0; 2], 1.0);
        }
        add([0; 2], self.sharpened(at));
        for by in AROUND {
            let rim = step(by, at);
            let share = if is_dark(rim) { self.sharpened(rim) } else { 0.0 };
            if share > 0.0 {
                let lit = AROUND.iter().filter(|&&by| self.label(step(by, rim)).is_some_and(|l| l != 0)).count();
                add(by, share / lit as f64);
            }
        }
    }

    /// The share of the edge texel `at` that light would cover if the lamp's edge were sharp. Let c be the coverage of
    /// the texel, and d the largest difference between c and the coverage of an adjacent texel across the edge.
    ///
    /// - d ≥ 0.5: the edge is sharp, and the share is c.
    /// - d < 0.5: the edge is blurred. It lies (c - 0.5) / d texels from the texel's centre, so the share is
    ///   0.5 + (c - 0.5) / d, clamped to `[0, 1]`.
    fn sharpened(&self, at: [isize; 2]) -> f64 {
        let coverage = self.coverage(at).unwrap_or(0.0);
        let is_lit = self.label(at) != Some(0);
        let beside = [[-1, 0], [1, 0], [0, -1], [0, 1]].map(|[u, v]| [at[0] + u, at[1] + v]);
        let across = beside.into_iter().filter(|&to| (self.label(to) != Some(0)) != is_lit);
        let steps = across.filter_map(|to| self.coverage(to)).map(|other| (coverage - other).abs());
        match steps.fold(0.0, f64::max) {
            step if step > 0.0 && step < 0.5 => (0.5 + (coverage - 0.5) / step).clamp(0.0, 1.0),
            _ => coverage,
        }
    }
}
