//! Guides of a scene: its light at each pixel, separated by light path (StyLit, section 3.2), and its geometry and
//! materials.
//!
//! [`run`] renders a camera's view once. Besides the full picture it keeps the light of five light path expressions,
//! the normals, the edges of shapes (`edges`), and a colour for each material. This colour is derived from the
//! material's name, so that equal names match across scenes. [`pairs`] brings the guides of two scenes to a common
//! exposure for `stylize`.
//!
//! The light is smoothed along surfaces (`smooth`), because `stylize` would match sampling noise as if it were
//! texture.
//!
//! For sequences, [`motion`] computes where the surface point that a pixel shows was in the previous frame, from the
//! surface points that the pixels of both frames show (`surfaces`).
//!
//! Not modelled: the motion of objects that are seen in a mirror or through a pane. Their pixels get the motion of the
//! mirror or of the pane itself.

mod edges;
mod motion;
mod smooth;
mod surfaces;
mod warnings;

#[cfg(test)]
mod tests;

pub use motion::{Motion, Unmatched, deviation, motion};
pub use surfaces::{Point, Shape, Surfaces};

use crate::error::{Result, check_range};
use crate::image::colour::luminance;
use crate::image::{Image, try_collect};
use crate::job::Job;
use crate::render::{self, Aov, Outputs, World};
use crate::rng::Rng;
use crate::scene::Camera;
use glam::Vec3;
use std::sync::Arc;

/// The light components, each with a name and its light path expression in Heckbert's notation:
///
/// - Full: all light.
/// - Direct: one diffuse reflection.
/// - Specular: one reflection or transmission at a glossy surface, mirror or clear pane.
/// - Indirect: the path ends with at least two diffuse reflections before the camera (colour bleeding).
/// - Two bounces: one or two diffuse reflections. Unlike direct light, it shows detail in shadows.
/// - Caustics: one or more glossy surfaces, mirrors or clear panes, then one diffuse reflection.
pub const LIGHT: [(&str, &str); 6] = [
    ("full", "L.*E"),
    ("direct", "LDE"),
    ("specular", "LSE"),
    ("indirect", "L.*DDE"),
    ("two bounces", "LD{1,2}E"),
    ("caustics", "LS+DE"),
];
/// Index in [`LIGHT`] of the caustics, which [`pairs`] includes only on request.
const CAUSTICS: usize = 5;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Size of the images in pixels, each in `[1, 32768]`.
    pub width: usize,
    pub height: usize,
    /// Paths per pixel, in `[1, 1 << 20]`.
    pub samples: u32,
    pub seed: u64,
    /// Whether to smooth the light along surfaces.
    pub smooth: bool,
}

impl Default for Params {
    fn default() -> Self {
        Self { width: 800, height: 608, samples: 64, seed: 1, smooth: true }
    }
}

#[derive(Clone, Debug)]
pub struct Guides {
    /// The light components in the order of [`LIGHT`]: linear RGB in cd/m².
    pub light: [Image; 6],
    /// Unit normals in camera axes: x right, y up, z towards the viewer; 0 where there is no surface. 3 channels.
    pub normals: Image,
    /// Strength of the edges of shapes: 1 on an edge, 0 away from edges; 1 channel.
    pub edges: Image,
    /// A colour for each material, derived from its name; black where there is no surface. 3 channels.
    pub materials: Image,
    /// The surface points that the pixels show, and the camera of the view.
    pub surfaces: Arc<Surfaces>,
}

/// Renders the guides of a view.
pub fn run(world: &World, camera: &Camera, params: &Params, job: Job) -> Result<Guides> {
    check_range("width", params.width, 1, 32_768)?;
    check_range("height", params.height, 1, 32_768)?;
    let mut outputs = Outputs { aovs: vec![Aov::Normal, Aov::Material, Aov::Depth], ..Outputs::default() };
    for (name, expression) in &LIGHT[1..] {
        outputs.add(name, expression)?;
    }
    let settings = render::Params {
        width: params.width,
        height: params.height,
        samples: params.samples,
        seed: params.seed,
        outputs,
        ..render::Params::default()
    };
    let film = render::run(world, camera, &settings, job.part(0.0, 0.95), &mut |_| {})?;
    let job = job.part(0.95, 1.0);

    // The layers are in the order in which they were requested.
    let mut layers = film.layers.into_iter().map(|l| l.image);
    let mut next = || layers.next().ok_or_else(|| crate::error::Error::degenerate("the rendering has no layers"));
    let mut light = [film.beauty, next()?, next()?, next()?, next()?, next()?];
    let (mut normals, material, depth) = (next()?, next()?, next()?);

    // Rotate normals to camera axes, because their orientation relative to the view matters.
    let right = camera.forward.cross(camera.up).normalize_or_zero();
    let axes = [right, right.cross(camera.forward).normalize_or_zero(), -camera.forward.normalize_or_zero()];
    for n in normals.data.chunks_exact_mut(3) {
        let world = Vec3::from_slice(n);
        n.copy_from_slice(&axes.map(|axis| axis.dot(world)));
    }
    if params.smooth {
        for image in &mut light {
            *image = smooth::along_surfaces(image, &normals, &material, job)?;
        }
    }
    let edges = edges::edges(&normals, &material, &depth, job)?;
    let materials = coded(&material, &world.scene().materials)?;
    let surfaces = Surfaces::trace(world, camera, params.width, params.height, job)?;
    job.report(1.0);
    Ok(Guides { light, normals, edges, materials, surfaces: Arc::new(surfaces) })
}

/// Returns an image in which each pixel has the colour that stands for its material.
fn coded(index: &Image, materials: &[crate::scene::Material]) -> Result<Image> {
    let code = |name: &str| {
        let letters: Vec<u64> = name.bytes().map(u64::from).collect();
        let mut rng = Rng::new(1, &letters);
        [0; 3].map(|_| 0.2 + 0.8 * rng.next_f32())
    };
    let codes: Vec<[f32; 3]> = materials.iter().map(|m| code(&m.name)).collect();
    let mut out = Image::new(index.width, index.height, 3)?;
    for (pixel, &i) in out.data.chunks_exact_mut(3).zip(&index.data) {
        if let Some(code) = codes.get((i as usize).wrapping_sub(1)) {
            pixel.copy_from_slice(code);
        }
    }
    Ok(out)
}

/// Selects the guides that [`pairs`] adds only on request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    pub normals: bool,
    /// The edges of shapes, for shapes finer than the strokes (StyLit, Fig. 16).
    pub edges: bool,
    /// The colours of the materials, for artworks that paint each material in a style of its own.
    pub materials: bool,
    /// The caustics, for scenes that have them.
    pub caustics: bool,
}

/// A guide: one image that shows the exemplar's scene (`source`), and one that shows the target scene (`target`).
#[derive(Clone, Debug)]
pub struct Pair {
    pub name: &'static str,
    pub source: Image,
    pub target: Image,
    /// True if the guide is an image of light, with values in `[0, 1]`; false if it holds other data, such as
    /// normals.
    pub is_light: bool,
    /// Whether the guide was requested in [`Extras`].
    pub is_extra: bool,
}

/// Returns the guides of an exemplar and a target at a common exposure: the 90th percentile of luminance, over the
/// pixels of both full pictures together, becomes [`BRIGHT`].
pub fn pairs(source: &Guides, target: &Guides, extras: Extras) -> Result<Vec<Pair>> {
    let exposure = exposure(&source.light[0], &target.light[0])?;
    let mut pairs = Vec::new();
    for (i, (name, _)) in LIGHT.iter().enumerate().filter(|(i, _)| *i != CAUSTICS || extras.caustics) {
        // Clip at white, as a display does.
        let expose = |image: &Image| -> Result<Image> {
            let mut exposed = image.try_clone()?;
            exposed.data.iter_mut().for_each(|v| *v = (*v * exposure).min(1.0));
            Ok(exposed)
        };
        let (source, target) = (expose(&source.light[i])?, expose(&target.light[i])?);
        pairs.push(Pair { name, source, target, is_light: true, is_extra: i == CAUSTICS });
    }
    let more: [(bool, &'static str, fn(&Guides) -> &Image); 3] = [
        (extras.normals, "normals", |g| &g.normals),
        (extras.edges, "edges", |g| &g.edges),
        (extras.materials, "materials", |g| &g.materials),
    ];
    for (_, name, pick) in more.into_iter().filter(|m| m.0) {
        pairs.push(Pair {
            name,
            source: pick(source).try_clone()?,
            target: pick(target).try_clone()?,
            is_light: false,
            is_extra: true,
        });
    }
    Ok(pairs)
}

/// The value that the 90th percentile of luminance gets at the common exposure. [convention]
const BRIGHT: f32 = 0.8;

/// Returns the factor that converts luminance in cd/m² to values at the common exposure; 1 if the 90th percentile of
/// luminance is 0, or if no luminance is finite.
pub fn exposure(source: &Image, target: &Image) -> Result<f32> {
    let pixels = source.data.chunks_exact(3).chain(target.data.chunks_exact(3));
    let mut luminances = try_collect(pixels.map(|p| luminance(Vec3::from_slice(p))).filter(|l| l.is_finite()))?;
    if luminances.is_empty() {
        return Ok(1.0);
    }
    let rank = (luminances.len() - 1) * 9 / 10;
    let bright = *luminances.select_nth_unstable_by(rank, f32::total_cmp).1;
    Ok(if bright > 0.0 { BRIGHT / bright } else { 1.0 })
}
