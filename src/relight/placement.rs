//! Finds the best placement of a texture: its offset, scale and rotation on the surface, by gradient descent on the
//! importance map.
//!
//! The target's light under a placed texture is the dot product of the map and the texture, looked up at the centres of
//! the map's cells. To make this light differentiable in the placement, the look-ups are band-limited to the size of a
//! cell ([`super::band`]). As textures repeat, there are many local optima. The search has three steps:
//!
//! 1. Evaluate many evenly distributed starting points, and the current placement of the texture ([`Pose::IDENTITY`]).
//! 2. Descend from the best of them (projected BFGS: Nocedal and Wright 2006, chapters 6 and 16.7).
//! 3. Compare the results at full resolution ([`Importance::respond`]).
//!
//! The noise of the map favours some placements. The search therefore overestimates slightly how close the light of its
//! best placement comes to the aim (for [`Aim::Brightest`], how bright the light is), by a small part of the light's
//! confidence interval.

use super::band::Pyramid;
use super::descent::{self, Bounds};
use super::groups::LUMINANCE;
use super::importance::{Cells, Importance, Response};
use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::maths;
use crate::rng::Rng;
use crate::scene::Texture;
use glam::{DMat2, DMat3, DVec2, DVec3, Vec3};
use std::f64::consts::TAU;

/// The goal of the search for a placement.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Aim {
    /// Bring the mean radiance of the target, all other light included, as near as possible to this value, in cd/m²
    /// per channel, ≥ 0.
    Radiance(Vec3),
    /// Maximise the luminance of the target.
    Brightest,
    /// Minimise the luminance of the target.
    Darkest,
}

/// The placement of a texture. It maps the surface's texture coordinates to the coordinates of the texture: scales and
/// then rotates them about the centre `(½, ½)`, and adds the offset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    pub offset: DVec2,
    /// Number of repetitions of the texture along the surface's u and v.
    pub scale: DVec2,
    /// Rotation in radians.
    pub rotation: f64,
}

impl Pose {
    pub const IDENTITY: Self = Self { offset: DVec2::ZERO, scale: DVec2::ONE, rotation: 0.0 };

    /// Returns the placement as a matrix for [`Importance::respond`].
    pub fn matrix(&self) -> DMat3 {
        let turned = maths::rotation_2d(self.rotation) * DMat2::from_diagonal(self.scale);
        let centre = DVec2::splat(0.5);
        DMat3::from_mat2(turned)
            + DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, (centre + self.offset - turned * centre).extend(0.0))
    }

    fn numbers(&self) -> [f64; 5] {
        [self.offset.x, self.offset.y, self.scale.x, self.scale.y, self.rotation]
    }

    fn of([u, v, su, sv, rotation]: [f64; 5]) -> Self {
        Self { offset: DVec2::new(u, v), scale: DVec2::new(su, sv), rotation }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct PlacementParams {
    pub aim: Aim,
    /// Bounds: offsets in `[-16, 16]`, scales in `[1/64, 64]`, rotations in `[-2π, 2π]`. Parameters with equal bounds
    /// are fixed. An offset whose range covers a period of the texture is unbounded, and so is a rotation whose range
    /// covers a full turn.
    pub min: Pose,
    pub max: Pose,
    /// Number of starting points, in `[1, 4096]`.
    pub starts: usize,
    pub seed: u64,
}

impl Default for PlacementParams {
    /// Searches for the brightest target over all offsets, with scale 1 and without rotation.
    fn default() -> Self {
        let shifted = |by: f64| Pose { offset: DVec2::splat(by), ..Pose::IDENTITY };
        Self { aim: Aim::Brightest, min: shifted(-0.5), max: shifted(0.5), starts: 64, seed: 1 }
    }
}

/// The best placement.
#[derive(Clone, Debug)]
pub struct Placement {
    pub pose: Pose,
    /// The response of the target to the placed texture.
    pub response: Response,
}

/// Maximum number of cells along each side of the importance map in the search; larger maps are reduced. The bench
/// prints the time of the search and the light that the search gains. [bench relight]
const MAX_CELLS: usize = 64;
/// The search descends from this number of the best starting points, and always from the current placement. The bench
/// prints the time of the search and the light that the search gains.
/// [bench relight]
const MAX_DESCENTS: usize = 8;

impl Importance {
    /// Returns the mean radiance that a placed texture alone causes on the target. Also returns the derivatives of
    /// this light with respect to the offset along u and v, the scale along u and v, and the rotation. The texture is
    /// band-limited as in the search.
    ///
    /// # Errors
    /// Cancelled.
    pub fn value_and_gradient(&self, texture: &Image, pose: &Pose, job: Job) -> Result<(DVec3, [DVec3; 5])> {
        Ok(self.search(texture, Aim::Brightest, job)?.light(pose.numbers()))
    }

    fn search(&self, texture: &Image, aim: Aim, job: Job) -> Result<Search> {
        Ok(Search {
            pyramid: Pyramid::new(texture, job)?,
            cells: self.cells(MAX_CELLS),
            texels: DVec2::new(texture.width as f64, texture.height as f64),
            background: self.background(),
            aim,
        })
    }

    /// Finds the best placement of a repeating texture with values in cd/m².
    ///
    /// # Errors
    /// Parameters out of range; cancelled.
    pub fn place(&self, texture: &Image, params: &PlacementParams, job: Job) -> Result<Placement> {
        let bounds = params.bounds()?;
        let search = self.search(texture, params.aim, job.part(0.0, 0.1))?;
        // Start from the current placement (the identity), clamped to the bounds, and from points of a low-discrepancy
        // sequence within the bounds.
        let mut rng = Rng::new(params.seed, &[]);
        let shift: [f64; 5] = std::array::from_fn(|_| rng.next_f64());
        let start = |index: usize| match index {
            0 => bounds.nearest(Pose::IDENTITY.numbers()),
            _ => bounds.between(std::array::from_fn(|i| (shift[i] + index as f64 * KRONECKER[i]).fract())),
        };
        let values = exec::map(params.starts, job.part(0.1, 0.3), |i| search.value(start(i)))?;
        let mut order: Vec<usize> = (0..params.starts).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b)));
        order.truncate(MAX_DESCENTS);
        if !order.contains(&0) {
            order.push(0);
        }
        let found = exec::map(order.len(), job.part(0.3, 0.8), |i| {
            descent::run(&bounds, start(order[i]), |at| search.value_and_gradient(at), job)
        })?;

        // Select the best result at full resolution, because the search used a blurred texture.
        let texture = Texture::new("placed", texture.clone());
        let mut best: Option<(f64, Placement)> = None;
        for (i, numbers) in found.into_iter().enumerate() {
            let pose = Pose::of(bounds.wrapped(numbers));
            let part =
                job.part(0.8 + 0.2 * i as f64 / order.len() as f64, 0.8 + 0.2 * (i + 1) as f64 / order.len() as f64);
            let response = self.respond(&texture, &pose.matrix().as_mat3(), part)?;
            let value = search.judge(response.light.mean).0;
            if best.as_ref().is_none_or(|(min, _)| value < *min) {
                best = Some((value, Placement { pose, response }));
            }
        }
        best.map(|(_, placement)| placement).ok_or_else(|| Error::argument("starts is 0; it must be in [1, 4096]"))
    }
}

/// Powers of 1/x, where x is the positive root of `x⁶ = x + 1`. Their multiples modulo 1 are a low-discrepancy
/// sequence in five dimensions (Roberts 2018). [convention]
const KRONECKER: [f64; 5] = [
    0.881_271_462_333_504_6,
    0.776_639_390_326_789_7,
    0.684_430_131_085_082_9,
    0.603_168_743_496_617_1,
    0.531_555_401_119_246_3,
];

impl PlacementParams {
    fn bounds(&self) -> Result<Bounds<5>> {
        check_range("starts", self.starts, 1, 4096)?;
        if let Aim::Radiance(target) = self.aim {
            for channel in target.to_array() {
                check_range("target", channel, 0.0, f32::MAX)?;
            }
        }
        let (min, max) = (self.min.numbers(), self.max.numbers());
        let (scale, offset) = (("scale", 1.0 / 64.0, 64.0), ("offset", -16.0, 16.0));
        for (i, (name, low, high)) in [offset, offset, scale, scale, ("rotation", -TAU, TAU)].into_iter().enumerate() {
            check_range(name, min[i], low, high)?;
            check_range(name, max[i], low, high)?;
            if min[i] > max[i] {
                return Err(Error::argument(format!(
                    "{name} is to be between {} and {}; the first must not be larger",
                    min[i], max[i]
                )));
            }
        }
        Ok(Bounds { min, max, period: [1.0, 1.0, f64::INFINITY, f64::INFINITY, TAU] })
    }
}

struct Search {
    pyramid: Pyramid,
    cells: Cells,
    texels: DVec2,
    background: DVec3,
    aim: Aim,
}

impl Search {
    fn value(&self, numbers: [f64; 5]) -> f64 {
        self.value_and_gradient(numbers).0
    }

    /// Returns the cost of a placement and its gradient.
    fn value_and_gradient(&self, numbers: [f64; 5]) -> (f64, [f64; 5]) {
        let (light, derivatives) = self.light(numbers);
        let (value, by_light) = self.judge(light);
        (value, derivatives.map(|derivative| derivative.dot(by_light)))
    }

    /// Returns the target's light under a placement, and the derivatives of this light with respect to the five numbers
    /// of the placement.
    fn light(&self, numbers: [f64; 5]) -> (DVec3, [DVec3; 5]) {
        let pose = Pose::of(numbers);
        let rotation = maths::rotation_2d(pose.rotation);
        let Cells { width, height, importance } = &self.cells;
        let cell = DVec2::new(1.0 / *width as f64, 1.0 / *height as f64);
        // Choose the pyramid level at which a cell covers the area of one texel.
        let texels = pose.scale.element_product() * (cell * self.texels).element_product();
        let level = 0.5 * maths::log2(texels);
        let by_scale = DVec2::splat(0.5 / std::f64::consts::LN_2) / pose.scale;
        let (mut light, mut derivatives) = (DVec3::ZERO, [DVec3::ZERO; 5]);
        for (i, importance) in importance.iter().enumerate().filter(|(_, i)| **i != DVec3::ZERO) {
            let from = DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5) * cell - 0.5;
            let scaled = from * pose.scale;
            let turned = rotation * scaled;
            let sample = self.pyramid.look_up(turned + pose.offset + 0.5, level);
            light += importance * sample.value;
            let along = |way: DVec2| sample.d_du * way.x + sample.d_dv * way.y;
            let changes = [
                sample.d_du,
                sample.d_dv,
                along(rotation.x_axis * from.x) + sample.d_dlevel * by_scale.x,
                along(rotation.y_axis * from.y) + sample.d_dlevel * by_scale.y,
                along(turned.perp()),
            ];
            derivatives.iter_mut().zip(changes).for_each(|(derivative, change)| *derivative += importance * change);
        }
        (light, derivatives)
    }

    /// Returns the cost of the target's light, and the gradient of the cost with respect to the light.
    fn judge(&self, light: DVec3) -> (f64, DVec3) {
        match self.aim {
            Aim::Brightest => (-light.dot(LUMINANCE), -LUMINANCE),
            Aim::Darkest => (light.dot(LUMINANCE), LUMINANCE),
            Aim::Radiance(target) => {
                let miss = light + self.background - target.as_dvec3();
                (0.5 * miss.length_squared(), miss)
            }
        }
    }
}

#[cfg(test)]
#[path = "tests/placement.rs"]
mod tests;
