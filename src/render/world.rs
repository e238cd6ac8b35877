//! A scene prepared for path tracing, with ray queries that respect opacity and transmission.

use super::compiled_material::CompiledMaterial;
use super::emissive::Emitters;
use super::facet::{self, Facet, NONE};
use super::ggx::AlbedoTable;
use super::light::{LampVisibility, Lights};
use super::luminaires::{FaceLuminaire, Luminaires};
use super::medium::{self, Media, Medium};
use super::requirements::{self, Requirements};
use super::texture_context::TextureContext;
use super::vicinity::Vicinity;
use crate::accel::{Accel, Hit, Ray};
use crate::error::{Error, Result};
use crate::image::try_vec;
use crate::job::Job;
use crate::rng;
use crate::scene::{AlphaMode, Environment, Material, Mesh, Scene, TextureRef};
use glam::{DVec3, Vec2, Vec3};
use std::ops::Range;
use std::sync::Arc;

/// A scene prepared for path tracing: acceleration structure, triangle data and light distributions. Triangles have
/// scene-wide numbers (ids), mesh after mesh. World coordinates are relative to a centre, so that scenes far from the
/// origin keep their precision. A clone is cheap, because clones share all data, except for what a render learns about
/// the lights.
#[derive(Clone)]
pub struct World {
    scene: Arc<Scene>,
    accel: Arc<Accel>,
    /// Acceleration structure of the triangles around the path vertices (see `vicinity`). `None` until a render has
    /// recorded where its vertices lie. Also `None` if such a structure would save little time.
    vicinity: Option<Arc<Vicinity>>,
    /// Whether renders may build the structure `vicinity`.
    may_build_vicinity: bool,
    centre: DVec3,
    /// Id of the first triangle of each mesh, followed by the total number of triangles. If a luminaire has faces, the
    /// meshes of the scene are followed by one mesh per light ([`Luminaires::meshes`]).
    first: Arc<Vec<u32>>,
    /// The faces of the scene's lights; empty if no light has faces.
    faces: Arc<Vec<Mesh>>,
    facets: Arc<Vec<Facet>>,
    compiled_materials: Arc<Vec<CompiledMaterial>>,
    /// The media of air and of solid glass, by their numbers.
    media: Arc<Vec<Medium>>,
    lights: Lights,
    albedo_table: Option<Arc<AlbedoTable>>,
    requirements: Arc<Requirements>,
    /// Whether any material lets light through. If not, rays do not test the opacity of their hits.
    any_see_through: bool,
}

/// The structure `vicinity` is built only if its number of triangles, times this number, is at most the number of light
/// samples so far. Building it then takes a small part of the time spent so far. [convention]
const SAMPLES_PER_TRIANGLE: usize = 4;

/// A surface on a shadow ray through which light passes in a straight line: a clear pane, or a surface of partial
/// opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pane {
    /// Ray parameter of the hit, as a multiple of the ray's direction vector.
    pub t: f32,
    pub triangle: u32,
    /// Share of the light that misses the surface: 1 - opacity.
    pub uncovered: f32,
    /// Share of all arriving light that the covered part of the surface transmits, per channel: opacity × transmittance
    /// of the material.
    pub through: Vec3,
}

impl World {
    /// Validates a scene, which may be empty, and prepares it for rendering. Call it on the library's own thread pool.
    ///
    /// # Errors
    /// Invalid indices, sizes or values of the scene, which the message names; too many triangles; no memory;
    /// cancelled.
    pub fn build(scene: Arc<Scene>, job: Job) -> Result<Self> {
        check(&scene)?;
        let centre = facet::centre(&scene.meshes);
        let Luminaires { meshes: faces, sources } = Luminaires::new(&scene, centre, scene.materials.len())?;
        let Triangles { first, mut facets, corners } = Triangles::number(&scene, &faces, &sources, centre, job)?;
        let accel = Accel::build(&corners, job.part(0.0, 0.8))?;
        // Build the light distributions.
        let own = first[scene.meshes.len()] as usize;
        let (mut emitters, mut pieces) = Emitters::build(&scene, &facets[..own], &first)?;
        emitters.add_luminaires(sources, &facets, scene.meshes.len(), &first, &mut pieces)?;
        emitters.emitters.iter().enumerate().for_each(|(i, e)| facets[e.id as usize].emitter = i as u32);
        job.check()?;
        let (low, high) = accel.bounds();
        let lights = Lights::build(&scene, emitters, pieces, centre, (high - low).length() / 2.0)?;
        // Find out which shading features the scene requires.
        let has_top = |m: &Material| m.ior > 1.0 || m.metallic > 0.0 || m.coat.strength > 0.0;
        let albedo_table = scene.materials.iter().any(has_top).then(AlbedoTable::new);
        let (mut requirements, mut compiled_materials) = requirements::analyse(&scene, albedo_table.as_ref());
        let (media, numbers) = medium::number(&scene.materials)?;
        compiled_materials.iter_mut().zip(numbers).for_each(|(compiled, number)| compiled.medium = number);
        compiled_materials.push(CompiledMaterial::BLACK);
        requirements.flat_triangles = accel.dropped();
        requirements.keep_surfaces_that_emit(lights.pieces());
        let any_see_through = requirements.glass || requirements.alpha;
        job.report(1.0);
        Ok(Self {
            scene,
            accel: Arc::new(accel),
            vicinity: None,
            may_build_vicinity: true,
            centre,
            first: Arc::new(first),
            faces: Arc::new(faces),
            facets: Arc::new(facets),
            compiled_materials: Arc::new(compiled_materials),
            media: Arc::new(media),
            lights,
            albedo_table: albedo_table.map(Arc::new),
            requirements: Arc::new(requirements),
            any_see_through,
        })
    }

    /// Returns the shading features that the scene requires; tracing omits all others.
    pub fn requirements(&self) -> &Requirements {
        &self.requirements
    }

    /// Discards the scene analysis, so that every hit evaluates every shading feature. This changes estimates only by
    /// rounding. Benchmarks use this function to measure how much time the analysis saves.
    pub fn discard_analysis(&mut self) {
        // Leave the faces of luminaires as they are, because they have neither textures nor vertex normals.
        let own = [self.scene.materials.len(), self.first[self.scene.meshes.len()] as usize];
        let mut general: Vec<_> = self.compiled_materials.iter().map(CompiledMaterial::without_analysis).collect();
        general[own[0]..].copy_from_slice(&self.compiled_materials[own[0]..]);
        self.compiled_materials = Arc::new(general);
        let mut general: Vec<_> = self.facets.iter().map(Facet::without_analysis).collect();
        general[own[1]..].copy_from_slice(&self.facets[own[1]..]);
        self.facets = Arc::new(general);
        self.any_see_through = true;
    }

    /// Makes renders treat all lights alike, whether or not the lights reach the surfaces in view.
    #[cfg(test)]
    pub(super) fn disable_learning(&mut self) {
        self.lights.learns = false;
    }

    /// Makes renders trace all rays through the structure of the whole scene, which changes no result.
    #[cfg(test)]
    pub(super) fn disable_vicinity(&mut self) {
        self.may_build_vicinity = false;
    }

    /// Returns a copy that learns, from the paths traced in it, which lights reach the surfaces in view.
    pub(super) fn learning(&self) -> Result<Self> {
        Ok(Self { lights: self.lights.learning()?, ..self.clone() })
    }

    /// Returns a copy for the next pass. The copy seldom samples the lights that, by the light samples so far, are
    /// unlikely to reach the surfaces in view. `None` if the next pass is to use `self` again (see
    /// [`Lights::learned`]).
    pub(super) fn learned(&self) -> Result<Option<Self>> {
        self.lights.learned()?.map(|lights| Self { lights, ..self.clone() }.with_vicinity()).transpose()
    }

    /// Ends the learning: returns a copy that keeps what `self` has learned, and learns no more.
    pub(super) fn settled(&self) -> Result<Self> {
        let learned = self.lights.learned()?.unwrap_or_else(|| self.lights.clone());
        let world = Self { lights: learned, ..self.clone() }.with_vicinity()?;
        Ok(Self { lights: world.lights.clone().settled(), ..world })
    }

    /// Builds the structure `vicinity` from the vertices recorded so far. Keeps the present structure if it still fits
    /// these vertices, if no vertices are recorded, or if `may_build_vicinity` is false. The result has no structure if
    /// [`Vicinity::new`] builds none.
    fn with_vicinity(self) -> Result<Self> {
        let Some((positions, counted)) = self.lights.positions()?.filter(|_| self.may_build_vicinity) else {
            return Ok(self);
        };
        if let Some(vicinity) = &self.vicinity
            && vicinity.fits(positions)?
        {
            return Ok(self);
        }
        let max = counted as usize / SAMPLES_PER_TRIANGLE;
        let vicinity = Vicinity::new(&self.accel, self.facets.len(), positions, max)?;
        Ok(Self { vicinity: vicinity.map(Arc::new), ..self })
    }

    /// Returns the structure of the surroundings of the paths, if this copy has one.
    #[cfg(test)]
    pub(super) fn vicinity(&self) -> Option<&Vicinity> {
        self.vicinity.as_deref()
    }

    /// Counts the lamps that do not reach the surfaces in view (see [`Lights::lamp_visibility`]).
    pub(super) fn lamp_visibility(&self) -> Result<Option<LampVisibility>> {
        self.lights.lamp_visibility()
    }

    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Returns the acceleration structure, which is in world coordinates; [`World::ray`] makes rays for it.
    pub fn accel(&self) -> &Accel {
        &self.accel
    }

    /// Returns a ray in world coordinates for an origin in scene coordinates.
    pub fn ray(&self, origin: Vec3, direction: Vec3) -> Ray {
        Ray::new(self.from_scene(origin), direction)
    }

    /// Converts a point from scene coordinates to world coordinates.
    pub fn from_scene(&self, position: Vec3) -> Vec3 {
        (position.as_dvec3() - self.centre).as_vec3()
    }

    /// Converts a point from world coordinates to scene coordinates.
    pub fn in_scene(&self, position: Vec3) -> Vec3 {
        (position.as_dvec3() + self.centre).as_vec3()
    }

    /// Returns the meshes of the scene, followed by the faces of its lights. There is one mesh of faces per light; it
    /// has no triangles if the light shines from a point. If no light of the scene has faces, only the meshes of the
    /// scene are returned.
    pub fn meshes(&self) -> impl Iterator<Item = &Mesh> {
        self.scene.meshes.iter().chain(&*self.faces)
    }

    /// Returns a mesh by its number in [`World::meshes`].
    pub fn mesh(&self, number: u32) -> &Mesh {
        let number = number as usize;
        self.scene.meshes.get(number).unwrap_or_else(|| &self.faces[number - self.scene.meshes.len()])
    }

    /// Whether a triangle belongs to a mesh of the scene, and not to the faces of a luminaire.
    #[inline]
    pub fn is_of_scene(&self, id: u32) -> bool {
        id < self.first[self.scene.meshes.len()]
    }

    /// Returns the ids of the triangles of a light's faces.
    pub(super) fn faces_of(&self, light: usize) -> Range<u32> {
        let mesh = self.scene.meshes.len() + light;
        if self.faces.is_empty() { 0..0 } else { self.first[mesh]..self.first[mesh + 1] }
    }

    /// Returns the id of a triangle, from its index in the mesh.
    pub fn id(&self, mesh: u32, triangle: u32) -> u32 {
        self.first[mesh as usize] + triangle
    }

    /// Returns the number of a triangle's mesh in [`World::meshes`], and the index of the triangle in the mesh.
    pub fn locate(&self, id: u32) -> (u32, u32) {
        let mesh = self.facets[id as usize].mesh;
        (mesh, id - self.first(mesh))
    }

    /// Returns the id of the first triangle of a mesh.
    #[inline]
    pub(super) fn first(&self, mesh: u32) -> u32 {
        self.first[mesh as usize]
    }

    #[inline]
    pub(super) fn facet(&self, id: u32) -> &Facet {
        &self.facets[id as usize]
    }

    #[inline]
    pub(super) fn compiled_material(&self, facet: &Facet) -> &CompiledMaterial {
        &self.compiled_materials[facet.material()]
    }

    #[inline]
    pub(super) fn lights(&self) -> &Lights {
        &self.lights
    }

    /// Returns the environment, if it emits.
    #[inline]
    pub(super) fn environment(&self) -> Option<&Environment> {
        self.scene.environment.as_ref().filter(|_| self.requirements.environment)
    }

    #[inline]
    pub(super) fn albedo_table(&self) -> Option<&AlbedoTable> {
        self.albedo_table.as_deref()
    }

    /// Returns the index of the emitter that belongs to a triangle, if the triangle emits.
    #[inline]
    pub(super) fn emitter_of(&self, id: u32) -> Option<usize> {
        let emitter = self.facet(id).emitter;
        (emitter != NONE).then_some(emitter as usize)
    }

    /// Finds the nearest hit of a ray that leaves triangle `from`. With alpha blending, a random decision tells whether
    /// the ray hits or passes a surface of partial opacity; `seed` returns the seed of that decision.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray, from: u32, seed: impl Fn() -> u64) -> Option<Hit> {
        if !self.any_see_through {
            return self.nearest(ray, |hit| hit.triangle != from);
        }
        self.nearest(ray, |hit| hit.triangle != from && self.is_present(hit, &seed))
    }

    /// Returns the nearest hit that `accept` accepts.
    #[inline]
    fn nearest(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> Option<Hit> {
        let near = self.vicinity.as_deref().and_then(|vicinity| vicinity.closest(ray, &accept));
        near.or_else(|| self.accel.closest(ray, accept))
    }

    /// Whether a hit that `accept` accepts lies between the ends of a ray.
    #[inline]
    fn is_blocked(&self, ray: &Ray, accept: impl Fn(&Hit) -> bool) -> bool {
        match self.vicinity.as_deref() {
            // The triangles of the vicinity belong to the scene, so a hit among them blocks the ray wherever the ray
            // ends. Without such a hit, the rest of the scene can block the ray only if the ray ends outside the
            // vicinity.
            Some(near) if near.contains(ray.origin) => {
                near.accel().occluded(ray, &accept)
                    || !near.contains(ray.at(ray.t_max)) && self.accel.occluded(ray, accept)
            }
            _ => self.accel.occluded(ray, accept),
        }
    }

    /// Returns the structure that holds all triangles which may lie between the ends of a ray.
    #[inline]
    fn accel_between(&self, ray: &Ray) -> &Accel {
        match self.vicinity.as_deref() {
            Some(vicinity) if vicinity.contains_segment(ray) => vicinity.accel(),
            _ => &self.accel,
        }
    }

    /// Finds the surface that a ray from the camera sees. A triangle of partial opacity gets one random number, the
    /// same for all rays: where its opacity is larger than this number, all rays hit it; elsewhere, all rays pass it.
    pub fn visible(&self, ray: &Ray) -> Option<Hit> {
        self.closest(ray, NONE, || 0)
    }

    /// Whether the surface is present at a hit, according to its opacity. With alpha blending, the decision is random.
    fn is_present(&self, hit: &Hit, seed: &impl Fn() -> u64) -> bool {
        let facet = self.facet(hit.triangle);
        if !self.compiled_material(facet).has_alpha {
            return true;
        }
        let context = self.context(facet, hit);
        match context.material.alpha_mode {
            AlphaMode::Opaque => true,
            AlphaMode::Mask(cutoff) => context.opacity() >= cutoff,
            AlphaMode::Blend => {
                let u = (rng::hash(seed(), &[u64::from(hit.triangle)]) >> 40) as f32 / (1 << 24) as f32;
                u < context.opacity()
            }
        }
    }

    /// Returns the transmittance per channel between the ends of a ray. Partly transparent surfaces and clear panes
    /// attenuate the light; `panes` receives them in arbitrary order, and may be incomplete if the result is 0. The
    /// triangles in `ends`, at the two ends of the ray, do not count.
    pub(super) fn transmittance(&self, ray: &Ray, ends: [u32; 2], panes: Option<&mut Vec<Pane>>) -> Vec3 {
        self.transmittance_without(ray, |triangle| ends.contains(&triangle), panes)
    }

    /// Returns the transmittance like [`World::transmittance`]; triangles for which `is_end` is true do not count.
    #[inline]
    pub(super) fn transmittance_without(
        &self,
        ray: &Ray,
        is_end: impl Fn(u32) -> bool,
        mut panes: Option<&mut Vec<Pane>>,
    ) -> Vec3 {
        if let Some(panes) = &mut panes {
            panes.clear();
        }
        if !self.any_see_through {
            let blocked = self.is_blocked(ray, |hit| !is_end(hit.triangle));
            return if blocked { Vec3::ZERO } else { Vec3::ONE };
        }
        // Multiply in f64, so that the order of the hits does not affect the rounded result.
        let mut share = DVec3::ONE;
        let blocked = self.accel_between(ray).occluded(ray, |hit| {
            if is_end(hit.triangle) {
                return false;
            }
            let pane = self.pane(hit, ray.direction);
            share *= (Vec3::splat(pane.uncovered) + pane.through).as_dvec3();
            if let Some(panes) = &mut panes {
                panes.push(pane);
            }
            share == DVec3::ZERO
        });
        if blocked { Vec3::ZERO } else { share.as_vec3() }
    }

    /// Returns the media of air and of solid glass, by their numbers.
    #[inline]
    pub(super) fn media(&self) -> &[Medium] {
        &self.media
    }

    /// Returns the medium that fills a point among `media`.
    #[inline]
    pub(super) fn medium(&self, media: Media) -> &Medium {
        &self.media[usize::from(media.innermost())]
    }

    /// Whether any surface of the scene lets light through.
    #[inline]
    pub(super) fn is_see_through(&self) -> bool {
        self.any_see_through
    }

    /// Whether no surface lies between the ends of a ray. Clear panes and partly transparent surfaces count as
    /// surfaces, except where the opacity is 0. The triangles in `ends`, at the two ends of the ray, do not count.
    #[inline]
    pub(super) fn is_clear(&self, ray: &Ray, ends: [u32; 2]) -> bool {
        let is_met = |hit: &Hit| !self.any_see_through || self.pane(hit, ray.direction).uncovered < 1.0;
        !self.is_blocked(ray, |hit| !ends.contains(&hit.triangle) && is_met(hit))
    }

    /// Returns the share of light that passes a surface at a hit, for a ray in `direction`.
    pub(super) fn pane(&self, hit: &Hit, direction: Vec3) -> Pane {
        let facet = self.facet(hit.triangle);
        let compiled = self.compiled_material(facet);
        if !compiled.lets_light_through {
            return Pane { t: hit.t, triangle: hit.triangle, uncovered: 0.0, through: Vec3::ZERO };
        }
        let context = self.context(facet, hit);
        let coverage = match context.material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(u8::from(context.opacity() >= cutoff)),
            AlphaMode::Blend => context.opacity().clamp(0.0, 1.0),
        };
        // No straight path leads through the surface of a solid.
        let through = if context.material.transmission > 0.0 && compiled.medium == medium::AIR && coverage > 0.0 {
            context.bsdf_params(compiled).through(facet.normal.dot(direction.normalize_or_zero()))
        } else {
            Vec3::ZERO
        };
        Pane { t: hit.t, triangle: hit.triangle, uncovered: 1.0 - coverage, through: through * coverage }
    }

    fn context(&self, facet: &Facet, hit: &Hit) -> TextureContext<'_> {
        TextureContext::new(&self.scene, facet, hit.triangle - self.first(facet.mesh), Vec2::new(hit.u, hit.v))
    }
}

/// The triangles of a scene and of the faces of its luminaires.
struct Triangles {
    /// Id of the first triangle of each mesh, followed by the total number of triangles.
    first: Vec<u32>,
    facets: Vec<Facet>,
    /// Corners in world coordinates.
    corners: Vec<[Vec3; 3]>,
}

impl Triangles {
    /// Numbers the triangles of all meshes, and makes their coordinates relative to the centre.
    fn number(scene: &Scene, faces: &[Mesh], sources: &[FaceLuminaire], centre: DVec3, job: Job) -> Result<Self> {
        let count: usize = scene.meshes.iter().chain(faces).map(|m| m.triangles.len()).sum();
        if count >= 1 << 31 {
            return Err(Error::argument(format!("scene has {count} triangles; at most 2^31 - 1 are allowed")));
        }
        let mut first = Vec::with_capacity(scene.meshes.len() + faces.len() + 1);
        let mut facets = try_vec(count, Facet::EMPTY)?;
        let mut corners = try_vec(count, [Vec3::ZERO; 3])?;
        let mut next = 0;
        for (index, mesh) in scene.meshes.iter().enumerate() {
            job.check()?;
            first.push(next as u32);
            for triangle in 0..mesh.triangles.len() {
                corners[next] = mesh.corners(triangle).map(|p| (p.as_dvec3() - centre).as_vec3());
                facets[next] = Facet::new(corners[next], index as u32, mesh, triangle);
                next += 1;
            }
        }
        let mut sources = sources.iter().peekable();
        for (light, mesh) in faces.iter().enumerate() {
            job.check()?;
            first.push(next as u32);
            let Some(source) = sources.next_if(|source| source.light == light) else { continue };
            let index = (scene.meshes.len() + light) as u32;
            for (triangle, placed) in source.triangles().enumerate() {
                corners[next] = placed;
                facets[next] = Facet::new(placed, index, mesh, triangle);
                next += 1;
            }
        }
        first.push(next as u32);
        Ok(Self { first, facets, corners })
    }
}

/// Checks all indices, sizes and values on which tracing relies.
fn check(scene: &Scene) -> Result<()> {
    for (i, mesh) in scene.meshes.iter().enumerate() {
        check_mesh(scene, mesh).map_err(|e| e.context(format!("mesh {i} ({:?})", mesh.name)))?;
    }
    for (i, material) in scene.materials.iter().enumerate() {
        check_material(scene, material).map_err(|e| e.context(format!("material {i} ({:?})", material.name)))?;
    }
    for (i, texture) in scene.textures.iter().enumerate() {
        check_image(&texture.image).map_err(|e| e.context(format!("texture {i} ({:?})", texture.name)))?;
    }
    scene.check_brightness()?;
    match &scene.environment {
        Some(Environment::Image(image)) => check_image(image).map_err(|e| e.context("environment")),
        Some(Environment::Constant(c)) if !c.is_finite() => {
            Err(Error::argument(format!("environment is {c}; it must be finite")))
        }
        _ => Ok(()),
    }
}

fn check_mesh(scene: &Scene, mesh: &Mesh) -> Result<()> {
    let count = mesh.positions.len();
    if mesh.material >= scene.materials.len() {
        return Err(Error::argument(format!(
            "material index is {}; the scene has {} materials",
            mesh.material,
            scene.materials.len()
        )));
    }
    if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite()) {
        return Err(Error::argument(format!("a position is {p}; it must be finite")));
    }
    let [first, second] = [&mesh.uvs[0], &mesh.uvs[1]].map(Vec::len);
    let lengths =
        [("normals", mesh.normals.len()), ("uvs[0]", first), ("uvs[1]", second), ("colours", mesh.colours.len())];
    for (name, len) in lengths {
        if len != 0 && len != count {
            return Err(Error::argument(format!("{name} has {len} entries; it must have none or {count}")));
        }
    }
    if let Some(i) = mesh.triangles.iter().flatten().find(|&&i| i as usize >= count) {
        return Err(Error::argument(format!("a triangle refers to position {i}; there are {count}")));
    }
    Ok(())
}

fn check_material(scene: &Scene, material: &Material) -> Result<()> {
    for TextureRef { texture, uv_set, .. } in material.textures() {
        if texture >= scene.textures.len() || uv_set > 1 {
            return Err(Error::argument(format!(
                "texture {texture} with texture coordinates {uv_set}; there are {} textures and sets 0 and 1",
                scene.textures.len()
            )));
        }
    }
    let Material { alpha, metallic, roughness, transmission, ior, specular, coat, .. } = material;
    let numbers =
        [*alpha, *metallic, *roughness, *transmission, *ior, specular.strength, coat.strength, coat.roughness];
    let colours = [material.base_color, material.emission, specular.color];
    let finite = colours.into_iter().all(Vec3::is_finite);
    if !finite || numbers.iter().any(|v| !v.is_finite()) || material.ior < 1.0 {
        return Err(Error::argument("its numbers must be finite and its index of refraction at least 1"));
    }
    let is_share = |v: Vec3| v.cmpge(Vec3::ZERO).all() && v.cmple(Vec3::ONE).all();
    let is_volume = material.thickness >= 0.0 && material.attenuation_distance > 0.0;
    if !is_volume || !material.thickness.is_finite() || !is_share(material.attenuation_color) {
        let message = "its thickness must be finite and at least 0, its attenuation distance positive, and its \
                       attenuation colour in [0, 1]";
        return Err(Error::argument(message));
    }
    Ok(())
}

fn check_image(image: &crate::image::Image) -> Result<()> {
    if image.width == 0 || image.height == 0 || image.data.len() != image.width * image.height * image.channels {
        return Err(Error::argument("the image is empty or its size does not match its data"));
    }
    match image.count_non_finite() {
        0 => Ok(()),
        n => Err(Error::argument(format!("{n} samples of the image are NaN or infinite; replace them"))),
    }
}
