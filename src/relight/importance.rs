//! The importance map: how much each point of the emissive surface contributes to the mean radiance of the target
//! surface.
//!
//! The mean radiance of the target is a linear functional of the emission, `J(e) = ∫ e(x) I(x) dx`, where `I` is the
//! importance. The texture space of the emissive surface is divided into cells. The integral of `I` over each cell is
//! estimated once, with paths that start at the target while the surface emits uniformly. After that, the response to
//! any texture at any scale, rotation and offset is a dot product, without tracing.
//!
//! Cells limit the resolution: within a cell, `I` is taken as constant. Among matt surfaces `I` is smooth, and the
//! error is proportional to the squared size of a cell; [`Importance::respond`] estimates this error.

use super::bins::{Bins, Partition};
use super::estimate::BATCHES;
use super::params::Params;
use super::responses::{Estimate, Goal};
use super::sided::Constraint;
use super::solution::Solution;
use super::solve::{self, BatchMeasurements};
use super::target::Sampler;
use super::transport::{Batches, Stop};
use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::Image;
use crate::job::Job;
use crate::render::World;
use crate::scene::{Scene, Texture, TextureRef};
use glam::{DVec3, Mat3, Vec2, Vec3};
use std::sync::Arc;

#[derive(Clone, Debug, PartialEq)]
pub struct ImportanceParams {
    /// Number of cells along u and v, each in `[1, 512]`.
    pub width: usize,
    pub height: usize,
    /// Stopping conditions of the tracing. The target error applies to the target's response to uniform emission.
    /// `quantity` is ignored.
    pub tracing: Params,
}

impl Default for ImportanceParams {
    fn default() -> Self {
        Self { width: 64, height: 64, tracing: Params::default() }
    }
}

impl ImportanceParams {
    /// Checks that every setting is in its range.
    pub fn check(&self) -> Result<()> {
        check_range("width", self.width, 1, MAX_CELLS)?;
        check_range("height", self.height, 1, MAX_CELLS)?;
        self.tracing.check()
    }
}

/// The importance map, estimated in independent batches.
#[derive(Clone, Debug)]
pub struct Importance {
    width: usize,
    height: usize,
    /// For each batch and each cell, row by row: the target's mean radiance if only this cell emits, with 1 cd/m².
    batches: Vec<Vec<DVec3>>,
    /// For each batch, the target's mean radiance under all light except the emission of the surface.
    background: Vec<DVec3>,
    /// Number of paths traced.
    pub paths: u32,
}

/// The response of the target to a texture.
#[derive(Clone, Debug)]
pub struct Response {
    /// Mean radiance of the target per channel, in the unit of the texture's values (usually cd/m²).
    pub light: Estimate,
    /// The response computed with cells of twice the side, minus `light.mean`. Where the importance is smooth, this
    /// difference is three times the error that the size of the cells causes, plus noise.
    pub resolution_difference: DVec3,
    measured: Vec<DVec3>,
}

/// The importance map, averaged over the batches.
pub(super) struct Cells {
    pub width: usize,
    pub height: usize,
    pub importance: Vec<DVec3>,
}

/// Maximum number of cells along each side; a map of this size takes 200 MB. [convention]
const MAX_CELLS: usize = 512;

/// The emission of a cell is the mean of a grid of texture look-ups. Along each side, the grid has about one look-up
/// per texel, at least `clamp(LOOK_UPS_ACROSS / cells, 4, MIN_LOOK_UPS)` and at most `MAX_LOOK_UPS`. Here `cells` is
/// the number of cells of the map along this side. With fewer look-ups, texels cut by cell borders would get wrong
/// weights, which biases periodic patterns. [bench constants:map]
const MIN_LOOK_UPS: usize = 16;
const LOOK_UPS_ACROSS: usize = 1024;
const MAX_LOOK_UPS: usize = 64;

impl Importance {
    /// Traces the importance map of the surfaces with the material `emitter`, which must have texture coordinates. The
    /// map is computed for the place where the goal measures light; the goal's target value and weight are ignored.
    /// Points of this place that emit light in `scene` are excluded.
    ///
    /// # Errors
    /// Parameters out of range; a material or a target that does not exist; surfaces without texture coordinates;
    /// cancelled.
    pub fn trace(scene: &Arc<Scene>, emitter: usize, goal: &Goal, params: &ImportanceParams, job: Job) -> Result<Self> {
        params.check()?;
        let tracing = &params.tracing;
        let even = evenly_lit(scene, emitter, params)?;
        let world = World::build(Arc::new(even), job.part(0.0, 0.1))?;
        let points = Sampler::new(scene, goal.geometry, goal.quantity)?;
        let bins = Bins::new(&world, emitter, Partition::Cells { width: params.width, height: params.height });
        let mut batches = Batches::new(&world, &points, bins, tracing.seed)?;
        let stop = Stop::new(tracing);
        let mut growth = f64::INFINITY;
        loop {
            batches.trace_round(growth, stop.max_paths, job.part(0.1, 1.0))?;
            let map = Self::of(&batches, params);
            let error = Estimate::of(|b| map.batches[b].iter().sum()).error();
            match stop.growth(error, batches.paths()) {
                Some(more) => growth = more,
                None => {
                    job.report(1.0);
                    return Ok(map);
                }
            }
        }
    }

    fn of(batches: &Batches, params: &ImportanceParams) -> Self {
        let means = batches.means();
        Self {
            width: params.width,
            height: params.height,
            background: means.iter().map(|m| m.others).collect(),
            batches: means.into_iter().map(|m| m.bins).collect(),
            paths: batches.paths(),
        }
    }

    /// Number of cells along u and v.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// Returns the mean map over all batches. If the map has more than `max_cells` cells along a side, neighbouring
    /// cells are added up.
    pub(super) fn cells(&self, max_cells: usize) -> Cells {
        let (width, height) = (self.width.min(max_cells), self.height.min(max_cells));
        let mut importance = vec![DVec3::ZERO; width * height];
        for batch in &self.batches {
            for (i, value) in batch.iter().enumerate() {
                let (x, y) = (i % self.width * width / self.width, i / self.width * height / self.height);
                importance[y * width + x] += value / BATCHES as f64;
            }
        }
        Cells { width, height, importance }
    }

    /// The target's mean radiance under all light except the emission of the surface.
    pub(super) fn background(&self) -> DVec3 {
        self.background.iter().sum::<DVec3>() / BATCHES as f64
    }

    /// A map of given values, for tests.
    #[cfg(test)]
    pub(super) fn even(width: usize, height: usize, cells: Vec<DVec3>, background: DVec3) -> Self {
        Self { width, height, batches: vec![cells; BATCHES], background: vec![background; BATCHES], paths: 0 }
    }

    /// The map as an image with one pixel per cell: the target's mean radiance if only this cell emits, with 1 cd/m².
    pub fn image(&self) -> Result<Image> {
        let mut image = Image::new(self.width, self.height, 3)?;
        for (i, pixel) in image.data.chunks_exact_mut(3).enumerate() {
            let sum: DVec3 = self.batches.iter().map(|b| b[i]).sum();
            (sum / BATCHES as f64).as_vec3().write_to_slice(pixel);
        }
        Ok(image)
    }

    /// Computes the response of the target to a texture on the surface, in the unit of the texture's values.
    /// `placement` transforms the surface's texture coordinates to the coordinates of the texture (as
    /// `KHR_texture_transform`). Outside the unit square, the texture's wrap mode applies.
    ///
    /// # Errors
    /// A placement that is not finite; cancelled.
    pub fn respond(&self, texture: &Texture, placement: &Mat3, job: Job) -> Result<Response> {
        let emission = self.emission(texture, placement, job)?;
        let products = |batch: &Vec<DVec3>| batch.iter().zip(&emission).map(|(i, e)| i * e).sum::<DVec3>();
        let measured: Vec<DVec3> = self.batches.iter().map(products).collect();
        let light = Estimate::of(|b| measured[b]);
        Ok(Response { light, resolution_difference: self.coarse(&emission) - light.mean, measured })
    }

    /// Solves for the scale of a texture at which the target is met. Needs no tracing, unlike [`super::run`].
    ///
    /// # Errors
    /// `Unreachable`, as in [`super::run`].
    pub fn solve(&self, response: &Response, target: Vec3) -> Result<Solution> {
        for channel in target.to_array() {
            check_range("target", channel, 0.0, f32::MAX)?;
        }
        let (response, background) = (response.measured.clone(), self.background.clone());
        let measured = BatchMeasurements { response, background, pairs: None, paths: self.paths };
        solve::run(&measured, target.as_dvec3(), [Constraint::Exactly; 3])
    }

    /// Computes the mean emission of each cell.
    fn emission(&self, texture: &Texture, placement: &Mat3, job: Job) -> Result<Vec<DVec3>> {
        if !placement.is_finite() {
            return Err(Error::argument(format!("placement is {placement}; it must be finite")));
        }
        // Choose the number of look-ups along each side of a cell: about one per texel that the side covers.
        let cell = Vec2::new(1.0 / self.width as f32, 1.0 / self.height as f32);
        let texels = Vec2::new(texture.image.width as f32, texture.image.height as f32);
        let along = |side: Vec2, cells: usize| {
            let length = (placement.transform_vector2(side) * texels).abs().max_element().ceil();
            let min = (LOOK_UPS_ACROSS / cells).clamp(4, MIN_LOOK_UPS);
            (length as usize).clamp(min, MAX_LOOK_UPS)
        };
        let (nu, nv) = (along(Vec2::X * cell.x, self.width), along(Vec2::Y * cell.y, self.height));
        let rows = exec::map(self.height, job, |y| {
            let mean = |x: usize| {
                let mut sum = DVec3::ZERO;
                for j in 0..nv {
                    for i in 0..nu {
                        let offset = Vec2::new((i as f32 + 0.5) / nu as f32, (j as f32 + 0.5) / nv as f32);
                        let uv = (Vec2::new(x as f32, y as f32) + offset) * cell;
                        let value = texture.nearest(placement.transform_point2(uv)).truncate();
                        sum += value.max(Vec3::ZERO).as_dvec3();
                    }
                }
                sum / (nu * nv) as f64
            };
            (0..self.width).map(mean).collect::<Vec<_>>()
        })?;
        Ok(rows.into_iter().flatten().collect())
    }

    /// Computes the response with 2 × 2 cells merged into one, to estimate the error that the size of the cells causes.
    fn coarse(&self, emission: &[DVec3]) -> DVec3 {
        let mut total = DVec3::ZERO;
        for y in (0..self.height).step_by(2) {
            for x in (0..self.width).step_by(2) {
                let (mut importance, mut mean, mut n) = (DVec3::ZERO, DVec3::ZERO, 0.0);
                for cy in y..(y + 2).min(self.height) {
                    for cx in x..(x + 2).min(self.width) {
                        let i = cy * self.width + cx;
                        importance += self.batches.iter().map(|b| b[i]).sum::<DVec3>() / BATCHES as f64;
                        mean += emission[i];
                        n += 1.0;
                    }
                }
                total += importance * mean / n;
            }
        }
        total
    }
}

/// Returns the scene with uniform emission on the emissive surfaces: a white texture with one texel per cell.
fn evenly_lit(scene: &Arc<Scene>, emitter: usize, params: &ImportanceParams) -> Result<Scene> {
    if emitter >= scene.materials.len() {
        return Err(Error::argument(format!(
            "the emitter is material {emitter}; the scene has {} materials",
            scene.materials.len()
        )));
    }
    let mut even = (**scene).clone();
    let white = Image::from_fn(params.width, params.height, |_, _| [1.0])?;
    even.textures.push(Texture::new("importance", white));
    let material = &mut even.materials[emitter];
    let texture = even.textures.len() - 1;
    let old = material.emission_texture.unwrap_or(TextureRef::new(texture));
    material.emission = Vec3::ONE;
    material.emission_texture = Some(TextureRef { texture, ..old });
    let bare = |m: &&crate::scene::Mesh| m.material == emitter && m.uvs.get(old.uv_set).is_none_or(|u| u.is_empty());
    if let Some(mesh) = even.meshes.iter().find(bare) {
        return Err(Error::argument(format!(
            "mesh {:?} has no texture coordinates, by which a map of its importance could be laid out",
            mesh.name
        )));
    }
    Ok(even)
}
