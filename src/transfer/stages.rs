//! The stages of the transfer. Each stage takes its input from earlier results, runs, and stores its result.

use super::check::{missing, need};
use super::{LitScene, Results, Transfer, texel_zones};
use crate::emission::{CameraDistance, Emission, Sizing, TexelGrid};
use crate::error::{Error, ErrorKind, Result};
use crate::job::Job;
use crate::render::World;
use crate::scene::surface::{self, Placed, Surface};
use crate::scene::{Camera, Scene};
use crate::schedule::{self, Fixture};
use crate::{emission, features, rectify, relight, render, segment};
use glam::{UVec2, Vec3};
use std::sync::Arc;

/// Maximum number of corrections of the view. The second correction uses the lamps that were found after the first
/// one. [bench photos:tune]
pub(super) const LAMP_ROUNDS: i32 = 2;
/// Maximum number of times that the room is enlarged if its plane is a proposal. Each time, further rows of lamps may
/// be found. [bench photos:nostrokes]
pub(super) const ENLARGEMENTS: i32 = 2;

/// An emissive texture for a surface of the scene, before it is placed there.
pub(super) struct MadeTexture {
    pub surface: Surface,
    pub emission: Emission,
    pub distance: Option<CameraDistance>,
}

impl Transfer {
    pub(super) fn find_view(&mut self, job: Job) -> Result<()> {
        let photo = need(&self.input.photo, "set the photo")?;
        let settings = &self.params.rectify;
        let expected_focal = settings.expected_focal.or(self.input.photo_focal);
        let settings = rectify::Params { expected_focal, ..settings.clone() };
        self.results.view = Some(Arc::new(rectify::find_view(photo, &settings, job)?));
        (self.results.view_by_lines, self.results.view_is_given) = (None, false);
        Ok(())
    }

    /// Computes the features. If `layout` is given, it is used as the layout of the room; otherwise the layout is
    /// estimated.
    pub(super) fn compute_features(&mut self, layout: Option<features::Layout>, job: Job) -> Result<()> {
        let photo = need(&self.input.photo, "set the photo")?;
        let depth = self.input.depth.as_ref().map(|(image, kind)| features::DepthMap { image, kind: *kind });
        let strokes = self.plane_evidence();
        let room = self.room(&strokes, layout);
        let input = features::Input { photo, depth, room };
        self.results.features = Some(Arc::new(features::run(&input, &self.params.features, job)?));
        Ok(())
    }

    /// The strokes on the plane and beside it, which are also evidence for the layout of the room.
    pub(super) fn plane_evidence(&self) -> Vec<features::PlaneStroke<'_>> {
        let painted = self.input.strokes.plane_strokes();
        painted.map(|s| features::PlaneStroke { pixels: &s.pixels, positive: s.positive }).collect()
    }

    /// The room as the features need it; `None` without a view.
    pub(super) fn room<'a>(
        &'a self,
        strokes: &'a [features::PlaneStroke<'a>],
        layout: Option<features::Layout>,
    ) -> Option<features::RoomView<'a>> {
        let view = self.results.view.as_ref()?;
        Some(features::RoomView { perspective: &view.perspective, segments: &view.segments, strokes, layout })
    }

    pub(super) fn segment_plane(&mut self, job: Job) -> Result<()> {
        let features = need(&self.results.features, "run stage Features")?;
        let mut strokes = self.input.strokes.plane_examples();
        if !strokes.is_empty() {
            strokes.extend(self.results.beyond.iter().cloned());
        }
        let input = segment::Input { features: &features.image, strokes: &strokes, region: None };
        let mut plane = segment::run(&input, &self.params.plane, job).map_err(|e| e.context("strokes of the plane"))?;
        if let Some(surfaces) = &features.surfaces {
            let size = [plane.mask.width, plane.mask.height];
            plane.remove_off_plane(|pixel| surfaces.is_off_plane(pixel, size), self.input.strokes.plane_strokes());
        }
        self.results.plane = Some(Arc::new(plane));
        Ok(())
    }

    pub(super) fn segment_lights(&mut self, job: Job) -> Result<()> {
        let features = need(&self.results.features, "run stage Features")?;
        let plane = need(&self.results.plane, "run stage Plane")?;
        let strokes = self.input.strokes.light_examples(&features.image)?;
        let input = segment::Input { features: &features.image, strokes: &strokes, region: Some(&plane.mask) };
        let lights = segment::run(&input, &self.params.lights, job).map_err(|e| e.context("strokes of the lights"))?;
        self.results.lights = Some(Arc::new(lights));
        Ok(())
    }

    /// Corrects the view if the lamps contradict it, and enlarges the room if lamps lie beyond the plane of its
    /// layout. After each of these changes, finds the plane and the lights again.
    pub(super) fn look_again(&mut self, job: Job) -> Result<()> {
        for round in 0..LAMP_ROUNDS {
            let part = job.part(0.3 * f64::from(round), 0.3 * f64::from(round + 1));
            if !self.correct_view(part)? {
                break;
            }
        }
        for round in 0..ENLARGEMENTS {
            let step = 0.4 / f64::from(ENLARGEMENTS);
            let part = job.part(0.6 + step * f64::from(round), 0.6 + step * f64::from(round + 1));
            if !self.enlarge_room(part)? {
                break;
            }
        }
        Ok(())
    }

    /// Returns a view in which all lamps, once unwarped, have the same size and shape or lie on a lattice; `None` if
    /// the caller has set the view, or if the lamps do not fit another view clearly better.
    pub(super) fn corrected_view(&self, job: Job) -> Result<Option<rectify::View>> {
        let Results { view: Some(view), plane: Some(plane), lights: Some(lights), .. } = &self.results else {
            return Ok(None);
        };
        if self.results.view_is_given {
            return Ok(None);
        }
        let by_lines = self.results.view_by_lines.as_ref().unwrap_or(view);
        // A lattice that was found before outranks lamps that show no lattice or a smaller one.
        let corrected = by_lines.corrected_by_lamps(&plane.mask, &lights.mask, job)?;
        Ok(corrected.filter(|corrected| corrected.lattice_lamps >= view.lattice_lamps))
    }

    /// Replaces the view by the corrected one, if there is one. Returns whether the view was replaced.
    fn correct_view(&mut self, job: Job) -> Result<bool> {
        let Some(view) = self.corrected_view(job.part(0.0, 0.1))? else { return Ok(false) };
        self.results.correct_view(Arc::new(view));
        self.compute_features(None, job.part(0.1, 0.5))?;
        self.segment_plane(job.part(0.5, 0.75))?;
        self.segment_lights(job.part(0.75, 1.0))?;
        Ok(true)
    }

    /// If lamps lie beyond the plane of the room's layout, and a larger room that contains them is plausible, enlarges
    /// the room. Then finds the plane and the lights again in the larger room. Returns true if the room may have to be
    /// enlarged once more: the room was enlarged, and its plane is a proposal without any plane stroke.
    pub(super) fn enlarge_room(&mut self, job: Job) -> Result<bool> {
        let Results { view: Some(view), features: Some(features), plane: Some(plane), lights: Some(lights), .. } =
            &self.results
        else {
            return Ok(false);
        };
        let Some(layout) = features.layout else { return Ok(false) };
        let is_proposed = plane.is_proposed && self.input.strokes.plane.is_empty();
        let beyond = lights.beyond.iter();
        let beyond = beyond.map(|lamp| features::RegionBeyond {
            pixels: &lamp.region.pixels,
            is_in_regular_row: lamp.is_in_regular_row,
        });
        let beyond: Vec<features::RegionBeyond> = beyond.collect();
        let lamps = features::LampsBeyond {
            mask: &lights.mask,
            beyond: &beyond,
            is_uncertain: plane.is_proposed || self.results.view_by_lines.is_some(),
            may_leave_out: is_proposed || lights.is_proposed,
        };
        let Some((layout, regions)) = layout.enlarged_for(&view.perspective, &lamps) else { return Ok(false) };
        self.results.beyond = regions.into_iter().map(|k| lights.beyond[k].region.clone()).collect();
        self.compute_features(Some(layout), job.part(0.0, 0.5))?;
        self.segment_plane(job.part(0.5, 0.75))?;
        self.segment_lights(job.part(0.75, 1.0))?;
        Ok(is_proposed)
    }

    pub(super) fn unwarp(&mut self, job: Job) -> Result<()> {
        let photo = need(&self.input.photo, "set the photo")?;
        let view = need(&self.results.view, "run stage View")?;
        let plane = need(&self.results.plane, "run stage Plane")?;
        let layout = self.results.features.as_ref().and_then(|features| features.layout);
        let laid_out = || layout?.axes_along(&view.perspective, &plane.mask);
        let axes = self.params.unwarp.axes.or_else(laid_out);
        let params = rectify::UnwarpParams { axes, ..self.params.unwarp.clone() };
        let unwarped = rectify::unwarp(photo, view, &plane.mask, &params, job)?;
        self.results.unwarped = Some(Arc::new(unwarped));
        Ok(())
    }

    /// Makes the emissive texture, and places it on the surface, with the luminance that the lamps have in the photo.
    pub(super) fn synthesise(&mut self, job: Job) -> Result<()> {
        let scene = need(&self.input.scene, "set the scene")?;
        let made = self.make_texture(scene, job)?;
        let mut lit = (**scene).clone();
        let strength = Vec3::splat(self.params.white_luminance);
        let placed = surface::place(&mut lit, &made.surface, made.emission.texture.clone(), strength)?;
        self.results.keep(made, Arc::new(lit), placed, Vec::new());
        Ok(())
    }

    /// Makes the emissive texture for the surface of the scene.
    pub(super) fn make_texture(&self, scene: &Scene, job: Job) -> Result<MadeTexture> {
        let found = self.find_surface(scene)?;
        let pattern = &self.params.pattern;
        let surface = if pattern.rotation == 0.0 { found.clone() } else { found.turned(scene, pattern.rotation)? };
        let (mut emission, distance) = match &self.input.texture {
            Some(texture) => (emission::from_texture(texture, job.part(0.0, 0.9))?, None),
            None => {
                let (emission, distance) = self.texture_from_photo(&surface, job.part(0.0, 0.9))?;
                (emission, Some(distance))
            }
        };

        // Remove lamps where the surface has a hole, or where no lamp may be.
        let size = UVec2::new(emission.texture.width as u32, emission.texture.height as u32);
        if let Some(zones) =
            texel_zones::find(scene, (&surface, &found), pattern.margin, &self.input.zones, size, job.part(0.9, 0.93))?
        {
            emission.restrict(&zones, job.part(0.93, 0.95))?;
        }

        Ok(MadeTexture { surface, emission, distance })
    }

    /// Synthesises the texture from the unwarped lights, with the number of texels that the surface needs.
    fn texture_from_photo(&self, surface: &Surface, job: Job) -> Result<(Emission, CameraDistance)> {
        let photo = need(&self.input.photo, "set the photo")?;
        let lights = need(&self.results.lights, "run stage Lights")?;
        let unwarped = need(&self.results.unwarped, "run stage Unwarp")?;

        // Unwarp the smoothed confidence of the lights with the same map as the photo.
        let (width, height) = (unwarped.image.width, unwarped.image.height);
        let smooth = segment::smooth_edges(&lights.confidence, job.part(0.0, 0.05))?;
        let light = rectify::warp_photo(&smooth, &unwarped.to_photo, width, height, job.part(0.05, 0.08))?;
        let shown = match &self.results.plane {
            Some(plane) => {
                let rims = segment::lamp_rims(&plane.mask, &lights.mask, photo, job.part(0.08, 0.085))?;
                unwarped.valid_with(&rims, job.part(0.085, 0.09))?
            }
            None => unwarped.valid.try_clone()?,
        };
        let light = emission::complete_lights(&unwarped.image, light, &shown, unwarped.to_photo, job.part(0.09, 0.1))?;
        let input = emission::Input {
            unwarped: &unwarped.image,
            light: &light,
            valid: &shown,
            photo: Some((photo, unwarped.to_photo)),
        };
        let pattern = &self.params.pattern;
        let at = (unwarped.pixel_size, self.params.plane_distance);
        let exemplar = (&input, &self.params.emission);
        let Sizing { pixel, distance, measured } =
            Sizing::new(pattern.scale, at, exemplar, surface.size.x.into(), job.part(0.1, 0.15))?;
        let grid = TexelGrid::new(
            surface.size.as_dvec2(),
            (width.max(height), pixel),
            pattern.texel_size,
            self.params.max_texels,
        )?;
        let params = emission::Params {
            width: grid.width,
            height: grid.height,
            scale: grid.scale,
            offset: pattern.offset * grid.texels_per_metre,
            ..self.params.emission.clone()
        };
        let job = job.part(0.15, 1.0);
        let emission = match measured {
            Some(measured) => emission::blend_measured(measured, &input, &[], &params, job),
            None => emission::run(&input, &params, job),
        };
        Ok((emission?, distance))
    }

    pub(super) fn relight(&mut self, job: Job) -> Result<()> {
        let target = self.target(job.part(0.0, 0.02))?;
        let unsolved = need(&self.results.unsolved, "run stage Emission")?;
        if !unsolved.others.is_empty() {
            return Err(missing("run stage Relight together with the transfers whose textures lie in the same scene"));
        }
        let world = World::build(unsolved.scene.clone(), job.part(0.02, 0.1))?;
        let triangles = unsolved.triangles();
        let input = relight::Input {
            world: &world,
            emitter: unsolved.placed.material,
            target_triangles: &triangles,
            target: target.colour * self.params.white_luminance,
        };
        let params = relight::Params { constraint: target.constraint, ..self.params.relight.clone() };
        let solution = relight::run(&input, &params, job.part(0.1, 1.0))?;

        // The solution is a factor of the strength with which the stage Emission placed the texture. Take this strength
        // from the scene, because `white_luminance` may have changed since.
        let placed = unsolved.scene.materials[unsolved.placed.material].emission;
        let mut lit = unsolved.with_strength(placed * solution.scale.as_vec3());
        if lit.scene.cameras.is_empty() {
            Arc::make_mut(&mut lit.scene).cameras.push(render::overview_camera(&world, &lit.surface));
        }
        self.results.lit = Some(Arc::new(lit));
        self.results.target = Some(target.colour);
        self.results.solution = Some(solution);
        Ok(())
    }

    /// Returns the colour that the surface should have, from the photo.
    pub(super) fn target(&self, job: Job) -> Result<relight::PhotoColour> {
        let photo = need(&self.input.photo, "set the photo")?;
        let plane = need(&self.results.plane, "run stage Plane")?;
        let lights = need(&self.results.lights, "run stage Lights")?;
        relight::photo_colour(self.params.target, photo, &plane.mask, &lights.mask, job)
    }

    /// The camera from which a lit scene is rendered: the camera of the input, else the scene's first camera, else the
    /// camera that [`render::overview_camera`] returns.
    pub(crate) fn viewpoint(&self, world: &World, lit: &LitScene) -> Camera {
        let own = self.input.camera.as_ref().or(lit.scene.cameras.first());
        own.cloned().unwrap_or_else(|| render::overview_camera(world, &lit.surface))
    }

    pub(super) fn render(&mut self, job: Job, publish: &mut dyn FnMut(&Results)) -> Result<()> {
        let lit = need(&self.results.lit, "run stage Relight")?;
        let camera = self.input.camera.as_ref().or(lit.scene.cameras.first()).ok_or_else(|| {
            Error::new(ErrorKind::NotFound, "the scene has no camera: set one to render from".to_string())
        })?;
        let world = World::build(lit.scene.clone(), job.part(0.0, 0.05))?;
        let mut results = self.results.clone();
        let film = render::run(&world, camera, &self.params.render, job.part(0.05, 1.0), &mut |film| {
            results.film = Some(Arc::new(film.clone()));
            publish(&results);
        });
        // Keep the unfinished picture if the rendering is cancelled or fails.
        self.results.film = results.film;
        self.results.film = Some(Arc::new(film?));
        Ok(())
    }
}

impl Results {
    /// Lists the lamps of the lit scene. Errors: the emission or the solution is missing.
    pub fn fixtures(&self) -> Result<Vec<Fixture>> {
        let emission = need(&self.emission, "run stage Emission")?;
        let lit = need(&self.lit, "run stage Relight")?;
        Ok(schedule::fixtures(emission, &lit.surface, lit.scene.materials[lit.placed.material].emission))
    }

    /// Keeps the texture, and the scene in which it has been placed.
    pub(super) fn keep(&mut self, made: MadeTexture, scene: Arc<Scene>, placed: Placed, others: Vec<usize>) {
        let MadeTexture { surface, emission, distance } = made;
        let texel_size = f64::from(surface.size.x) / emission.texture.width as f64;
        self.distance = distance;
        self.unsolved = Some(Arc::new(LitScene { scene, surface, placed, others, texel_size }));
        self.emission = Some(Arc::new(emission));
    }

    /// Replaces the view by one that the lamps have corrected, and keeps the view by lines.
    pub(super) fn correct_view(&mut self, view: Arc<rectify::View>) {
        let before = self.view.replace(view);
        self.view_by_lines = self.view_by_lines.take().or(before);
    }

    /// Undoes the corrections that earlier runs made because of the lamps: restores the view found from the photo's
    /// lines, and clears the lamps found beyond the plane, for which the room was enlarged.
    pub(super) fn forget_lamps(&mut self) {
        self.beyond.clear();
        if let Some(view) = self.view_by_lines.take() {
            self.view = Some(view);
        }
    }
}

impl LitScene {
    /// The triangles of the surface that receives the lights, as pairs of indices (mesh, triangle).
    pub fn triangles(&self) -> Vec<(usize, usize)> {
        let mesh = self.placed.mesh;
        (0..self.scene.meshes[mesh].triangles.len()).map(|t| (mesh, t)).collect()
    }

    /// Returns a copy of the lit scene whose texture is multiplied by `strength` (cd/m² per channel).
    pub fn with_strength(&self, strength: Vec3) -> Self {
        let mut scene = (*self.scene).clone();
        scene.materials[self.placed.material].emission = strength;
        Self { scene: Arc::new(scene), ..self.clone() }
    }

    /// Returns a copy of the lit scene in which each lamp is white and keeps its luminance, for comparison with the
    /// coloured lamps.
    pub fn in_white(&self) -> Self {
        let mut scene = (*self.scene).clone();
        for material in [self.placed.material].iter().chain(&self.others) {
            scene.whiten_emission(*material);
        }
        Self { scene: Arc::new(scene), ..self.clone() }
    }
}
