//! The lighting transfer: takes a photo, a few strokes and a 3D scene, and lights the scene as in the photo
//! ("Single-Exemplar Lighting Style Transfer via Emissive Texture Synthesis and Optimization").
//!
//! A transfer runs the stages in order and passes data between them; the stages do not depend on each other's code.
//! The caller can read and replace every intermediate result, and resume the run at any stage. A better depth map, a
//! hand-drawn mask or known vanishing points can thus replace the result of a stage.
//!
//! A photo may show lights on several planes, such as a ceiling and a wall. Each plane has a transfer of its own;
//! [`run_together`] runs them in one job, with one camera and one layout of the room, and solves for the light of all
//! planes together.

mod check;
mod pattern;
mod stages;
mod texel_zones;
mod together;
mod warnings;

pub use crate::emission::{CameraDistance, Scale};
pub use crate::relight::TargetColour;
pub use check::check_zones;
pub use pattern::Pattern;
pub use together::{MAX_PLANES, check_together, run_together};

use crate::emission::{self, Emission};
use crate::error::{Error, ErrorKind, Result};
use crate::features::{self, DepthKind, Features};
use crate::image::Image;
use crate::job::Job;
use crate::rectify::{self, Unwarped, View};
use crate::relight::{self, Solution};
use crate::render::{self, Film};
use crate::scene::surface::{Placed, Surface};
use crate::scene::{Camera, Scene};
use crate::segment::{self, Segmentation, Stroke, StrokeSet};
use glam::{DVec4, Vec3};
use std::sync::Arc;
use std::time::Instant;

/// The stages of the transfer, in the order in which they run.
#[repr(u32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Finds lines, vanishing points and the photo's camera.
    View = 0,
    /// Computes ten feature channels per pixel.
    Features = 1,
    /// Finds the mask of the plane that carries the lights.
    Plane = 2,
    /// Finds the mask of the lights on this plane.
    Lights = 3,
    /// Unwarps the plane to a fronto-parallel image.
    Unwarp = 4,
    /// Synthesises the emissive texture, and places it on the scene's surface.
    Emission = 5,
    /// Solves for the colour and the intensity of the emission.
    Relight = 6,
    /// Renders the picture.
    Render = 7,
}

pub const STAGES: [Stage; 8] = [
    Stage::View,
    Stage::Features,
    Stage::Plane,
    Stage::Lights,
    Stage::Unwarp,
    Stage::Emission,
    Stage::Relight,
    Stage::Render,
];

/// Expected share of each stage in the time of a whole run, for the progress bar only. [convention]
const WEIGHTS: [f64; 8] = [0.06, 0.06, 0.03, 0.03, 0.06, 0.12, 0.14, 0.5];

#[derive(Clone, Debug, Default)]
pub struct Input {
    /// Linear RGB, 1 = display white.
    pub photo: Option<Arc<Image>>,
    /// Focal length in pixels from the metadata of the photo's file, and its standard deviation.
    pub photo_focal: Option<[f64; 2]>,
    /// Depth map of the photo, if the caller has one.
    pub depth: Option<(Arc<Image>, DepthKind)>,
    pub strokes: StrokeSet,
    /// An emissive texture to stretch over the surface as it is, instead of one synthesised from the photo.
    pub texture: Option<Arc<Image>>,
    pub scene: Option<Arc<Scene>>,
    /// Name of the object or material of the scene that receives the lights.
    pub surface: String,
    /// The triangles of the scene that receive the lights, as pairs of indices (mesh, triangle). If the list is not
    /// empty, it is used instead of `surface`.
    pub triangles: Vec<(usize, usize)>,
    /// Rectangles of the surface that must stay free of lamps: `(u0, v0, u1, v1)`, in metres along the surface's axes
    /// from the corner [`Surface::origin`].
    pub zones: Vec<DVec4>,
    /// The camera of the picture. If absent, the scene's first camera is used; if the scene has no camera, one is
    /// chosen.
    pub camera: Option<Camera>,
}

#[derive(Clone, Debug)]
pub struct Params {
    pub rectify: rectify::Params,
    /// Settings of the unwarping. If `axes` is `None` and the plane lies on one face of the room's layout, the transfer
    /// sets `axes` to the two room axes along this face.
    pub unwarp: rectify::UnwarpParams,
    pub features: features::Params,
    /// Settings of the first phase of segmentation, which finds the plane.
    pub plane: segment::Params,
    /// Settings of the second phase of segmentation, which finds the lights on this plane.
    pub lights: segment::Params,
    /// Settings of the texture's synthesis. The transfer replaces `width`, `height`, `scale` and `offset` by values
    /// that follow from the surface's size, `pattern`, `plane_distance` and `max_texels`.
    pub emission: emission::Params,
    /// Size, rotation, offset and margin of the pattern on the surface.
    pub pattern: Pattern,
    /// Distance of the photo's camera from the lit plane in metres, in `[0.01, 1e4]`. With [`Scale::Distance`], it
    /// determines the size of the pattern. 0: estimated from the size of the lamps.
    pub plane_distance: f64,
    /// Longest side of the emissive texture in texels, in `[1, 16384]`.
    pub max_texels: usize,
    pub target: TargetColour,
    /// Luminance of the photo's white in cd/m², in `[1e-6, 1e9]`.
    pub white_luminance: f32,
    pub relight: relight::Params,
    pub render: render::Params,
}

impl Default for Params {
    fn default() -> Self {
        Self {
            rectify: rectify::Params::default(),
            unwarp: rectify::UnwarpParams::default(),
            features: features::Params::default(),
            plane: segment::Params::default(),
            lights: segment::Params::for_lights(),
            emission: emission::Params::default(),
            pattern: Pattern::default(),
            plane_distance: 0.0,
            max_texels: 2048,
            target: TargetColour::Surface,
            white_luminance: 100.0,
            relight: relight::Params::default(),
            render: render::Params::default(),
        }
    }
}

/// The scene with the emission on its surface.
#[derive(Clone, Debug)]
pub struct LitScene {
    pub scene: Arc<Scene>,
    pub surface: Surface,
    pub placed: Placed,
    /// Materials of the lamps that the other transfers of one job have placed in this scene ([`run_together`]).
    pub others: Vec<usize>,
    /// Metres per texel along the u axis of the surface.
    pub texel_size: f64,
}

/// The results of the stages; the caller may replace each of them.
#[derive(Clone, Debug, Default)]
pub struct Results {
    pub view: Option<Arc<View>>,
    /// The view found from the photo's lines, if the sizes of the lamps have led to a corrected view; `view` then holds
    /// the corrected view. `None` if the view has not been corrected.
    pub view_by_lines: Option<Arc<View>>,
    /// Whether the caller has set the view. Such a view is not corrected.
    pub view_is_given: bool,
    pub features: Option<Arc<Features>>,
    /// Lamps that lay beyond the plane of the lights in the first room layout. The room was enlarged until it contained
    /// them. When the plane is segmented again, their pixels are positive examples.
    pub beyond: Vec<Stroke>,
    pub plane: Option<Arc<Segmentation>>,
    pub lights: Option<Arc<Segmentation>>,
    pub unwarped: Option<Arc<Unwarped>>,
    pub emission: Option<Arc<Emission>>,
    /// The distance of the photo's camera from the lit plane. It gives the pattern its size on the surface. `None` if
    /// the caller supplies the texture.
    pub distance: Option<CameraDistance>,
    /// The scene before relighting. The texture is on the surface, and its values are multiplied by `white_luminance`.
    pub unsolved: Option<Arc<LitScene>>,
    /// Mean colour that the surface should have, relative to the photo's white.
    pub target: Option<Vec3>,
    pub solution: Option<Solution>,
    /// The scene with the solved emission. If the scene had no camera, one was added.
    pub lit: Option<Arc<LitScene>>,
    pub film: Option<Arc<Film>>,
    /// Seconds that each stage took in its latest run.
    pub seconds: [f64; STAGES.len()],
}

/// Inputs, settings and results of one transfer.
#[derive(Clone, Debug, Default)]
pub struct Transfer {
    pub input: Input,
    pub params: Params,
    pub results: Results,
}

impl Transfer {
    /// Runs the stages `from..=to`. The earlier results that these stages need must exist, from an earlier run or from
    /// the caller. If the run includes the stages Features to Lights, the lamps found may correct the view and enlarge
    /// the room; the stages up to Lights are then repeated in part.
    ///
    /// Calls `publish` with the results whenever a stage ends, and while the picture is being rendered. After a
    /// cancellation or an error, the results contain everything that was finished.
    pub fn run(&mut self, from: Stage, to: Stage, job: Job, mut publish: impl FnMut(&Results)) -> Result<()> {
        self.check(from, to)?;
        self.check_surface(from, to)?;

        let (first, last) = (from as usize, to as usize);
        let total: f64 = WEIGHTS[first..=last].iter().sum();
        let mut done = 0.0;
        for stage in &STAGES[first..=last] {
            let weight = WEIGHTS[*stage as usize] / total;
            let part = job.part(done, (done + weight).min(1.0));
            part.check()?;
            let clock = Instant::now();
            self.run_stage(*stage, part, &mut publish)?;
            if *stage == Stage::Lights && from <= Stage::Features {
                self.look_again(part).map_err(|e| e.context(format_args!("stage {stage:?}")))?;
            }
            self.results.seconds[*stage as usize] = clock.elapsed().as_secs_f64();
            done = (done + weight).min(1.0);
            job.report(done);
            publish(&self.results);
        }
        job.report(1.0);
        Ok(())
    }

    fn run_stage(&mut self, stage: Stage, job: Job, publish: &mut dyn FnMut(&Results)) -> Result<()> {
        match stage {
            Stage::View => self.find_view(job),
            Stage::Features => {
                self.results.forget_lamps();
                self.compute_features(None, job)
            }
            Stage::Plane => self.segment_plane(job),
            Stage::Lights => self.segment_lights(job),
            Stage::Unwarp => self.unwarp(job),
            Stage::Emission => self.synthesise(job),
            Stage::Relight => self.relight(job),
            Stage::Render => self.render(job, publish),
        }
        .map_err(|e| self.with_likely_unit(stage, e).context(format_args!("stage {stage:?}")))
    }

    /// Adds a hint to the error of a stage if the scene has an implausible size, because a wrong unit of length is the
    /// likely cause.
    fn with_likely_unit(&self, stage: Stage, error: Error) -> Error {
        let is_cause = stage >= Stage::Emission && error.kind != ErrorKind::Cancelled;
        match self.input.scene.as_ref().filter(|_| is_cause).and_then(|scene| scene.implausible_size()) {
            Some(warning) => Error { message: format!("{}; {}", error.message, warning.message), ..error },
            None => error,
        }
    }
}
