//! A scene made ready for tracing.

use super::compiled_material::CompiledMaterial;
use super::emissive::Emitters;
use super::facet::{self, Facet};
use super::ggx::AlbedoTable;
use super::light::Lights;
use super::requirements::{self, Requirements};
use super::vertex::TextureContext;
use crate::error::{Error, Result};
use crate::image::try_vec;
use crate::job::Job;
use crate::rng;
use crate::scene::accel::{Accel, Hit, Ray};
use crate::scene::{AlphaMode, Environment, Material, Mesh, Scene, TextureRef};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A scene made ready for tracing: acceleration structure and light distributions. Triangles are numbered through the
/// meshes in order. Inside, all coordinates are relative to a centre, so that scenes far from the origin lose nothing.
pub struct World {
    scene: Arc<Scene>,
    accel: Accel,
    centre: DVec3,
    /// Number of the first triangle of each mesh, and of all triangles at the end.
    first: Vec<u32>,
    facets: Vec<Facet>,
    compiled_materials: Vec<CompiledMaterial>,
    lights: Lights,
    albedo_table: Option<AlbedoTable>,
    requirements: Requirements,
    /// Whether light passes through any material: only then do rays ask what they hit.
    any_see_through: bool,
}

/// A surface that lets light through in a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pane {
    /// Distance from the start of the ray in units of its direction.
    pub t: f32,
    pub triangle: u32,
    /// Share of light that finds nothing in its way.
    pub beside: f32,
    /// Share that passes through what is there, per channel.
    pub through: Vec3,
}

/// No triangle, no emitter.
pub const NONE: u32 = u32::MAX;

impl World {
    /// Checks the indices of a scene and builds what rendering it needs. An empty scene is allowed. To be called on the
    /// library's own pool.
    ///
    /// # Errors
    /// Indices, sizes or values of the scene that cannot be used, by name; too many triangles; no memory; cancelled.
    pub fn build(scene: Arc<Scene>, job: Job) -> Result<Self> {
        check(&scene)?;
        let count: usize = scene.meshes.iter().map(|m| m.triangles.len()).sum();
        if count >= 1 << 31 {
            return Err(Error::argument(format!("scene has {count} triangles; at most 2^31 - 1 are allowed")));
        }
        // Number the triangles through all meshes, and move them to the centre.
        let centre = facet::centre(&scene.meshes);
        let mut first = Vec::with_capacity(scene.meshes.len() + 1);
        let mut facets = try_vec(count, Facet::EMPTY)?;
        let mut triangles = try_vec(count, [Vec3::ZERO; 3])?;
        let mut next = 0;
        for (index, mesh) in scene.meshes.iter().enumerate() {
            job.check()?;
            first.push(next as u32);
            for triangle in 0..mesh.triangles.len() {
                triangles[next] = mesh.corners(triangle).map(|p| (p.as_dvec3() - centre).as_vec3());
                facets[next] = Facet::new(triangles[next], index as u32, mesh, triangle);
                next += 1;
            }
        }
        first.push(next as u32);
        let accel = Accel::build(&triangles, job.part(0.0, 0.8))?;
        // Gather the lights.
        let (emitters, pieces) = Emitters::build(&scene, &facets, &first)?;
        emitters.emitters.iter().enumerate().for_each(|(i, e)| facets[e.id as usize].emitter = i as u32);
        job.check()?;
        let (low, high) = accel.bounds();
        let lights = Lights::build(&scene, emitters, pieces, centre, (high - low).length() / 2.0)?;
        // Find out what can be left out.
        let has_top = |m: &Material| m.ior > 1.0 || m.metallic > 0.0;
        let albedo_table = scene.materials.iter().any(has_top).then(AlbedoTable::new);
        let (mut requirements, compiled_materials) = requirements::analyse(&scene, albedo_table.as_ref());
        requirements.flat_triangles = accel.dropped();
        let any_see_through = requirements.glass || requirements.alpha;
        job.report(1.0);
        Ok(Self {
            scene,
            accel,
            centre,
            first,
            facets,
            compiled_materials,
            lights,
            albedo_table,
            requirements,
            any_see_through,
        })
    }

    /// What the scene requires, and what tracing leaves out.
    pub fn requirements(&self) -> &Requirements {
        &self.requirements
    }

    /// Forgets what the scene does not require: every hit then asks every question. Estimates stay the same but for
    /// rounding; this is to measure what the analysis saves.
    pub fn generalise(&mut self) {
        self.compiled_materials.iter_mut().for_each(|f| *f = f.without_analysis());
        self.facets.iter_mut().for_each(|f| *f = f.without_analysis());
        self.any_see_through = true;
    }

    pub fn scene(&self) -> &Arc<Scene> {
        &self.scene
    }

    /// Takes rays made by [`World::ray`]: its coordinates are relative to the centre.
    pub fn accel(&self) -> &Accel {
        &self.accel
    }

    /// A ray of the scene's coordinates, for tracing.
    pub fn ray(&self, origin: Vec3, direction: Vec3) -> Ray {
        Ray::new(self.from_scene(origin), direction)
    }

    /// A point of the scene's coordinates, for tracing.
    pub fn from_scene(&self, position: Vec3) -> Vec3 {
        (position.as_dvec3() - self.centre).as_vec3()
    }

    /// A point of tracing in the scene's coordinates.
    pub fn in_scene(&self, position: Vec3) -> Vec3 {
        (position.as_dvec3() + self.centre).as_vec3()
    }

    /// Number of the triangle of a mesh among all triangles.
    pub fn id(&self, mesh: u32, triangle: u32) -> u32 {
        self.first[mesh as usize] + triangle
    }

    /// The mesh and the triangle in it of a number.
    pub fn locate(&self, id: u32) -> (u32, u32) {
        let mesh = self.facets[id as usize].mesh;
        (mesh, id - self.first(mesh))
    }

    /// Number of the first triangle of a mesh.
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

    /// The light around the scene, if there is any.
    #[inline]
    pub(super) fn environment(&self) -> Option<&Environment> {
        self.scene.environment.as_ref().filter(|_| self.requirements.environment)
    }

    #[inline]
    pub(super) fn albedo_table(&self) -> Option<&AlbedoTable> {
        self.albedo_table.as_ref()
    }

    /// The emitter that a triangle is.
    #[inline]
    pub(super) fn emitter_of(&self, id: u32) -> Option<usize> {
        let emitter = self.facet(id).emitter;
        (emitter != NONE).then_some(emitter as usize)
    }

    /// The nearest hit of a ray that leaves triangle `from`; `seed` decides whether it meets what is only partly there.
    #[inline]
    pub(super) fn closest(&self, ray: &Ray, from: u32, seed: impl Fn() -> u64) -> Option<Hit> {
        if !self.any_see_through {
            return self.accel.closest(ray, |hit| hit.triangle != from);
        }
        self.accel.closest(ray, |hit| hit.triangle != from && self.is_there(hit, &seed))
    }

    fn is_there(&self, hit: &Hit, seed: &impl Fn() -> u64) -> bool {
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

    /// Share of light, per channel, that goes straight from the start of a ray to its end, neither of the two triangles
    /// counted. Partly transparent surfaces and clear panes let their share through; `panes` receives those met, in no
    /// particular order.
    pub(super) fn transmittance(&self, ray: &Ray, ends: [u32; 2], mut panes: Option<&mut Vec<Pane>>) -> Vec3 {
        if let Some(panes) = &mut panes {
            panes.clear();
        }
        if !self.any_see_through {
            let blocked = self.accel.occluded(ray, |hit| !ends.contains(&hit.triangle));
            return if blocked { Vec3::ZERO } else { Vec3::ONE };
        }
        // In f64, so that the order in which surfaces are met does not show after rounding.
        let mut share = DVec3::ONE;
        let blocked = self.accel.occluded(ray, |hit| {
            if ends.contains(&hit.triangle) {
                return false;
            }
            let pane = self.pane(hit, ray.direction);
            share *= (Vec3::splat(pane.beside) + pane.through).as_dvec3();
            if let Some(panes) = &mut panes {
                panes.push(pane);
            }
            share == DVec3::ZERO
        });
        if blocked { Vec3::ZERO } else { share.as_vec3() }
    }

    /// Whether light passes through any surface.
    #[inline]
    pub(super) fn is_see_through(&self) -> bool {
        self.any_see_through
    }

    /// Whether nothing at all stands between the start of a ray and its end, neither of the two triangles counted: nothing
    /// that a path could meet.
    #[inline]
    pub(super) fn is_clear(&self, ray: &Ray, ends: [u32; 2]) -> bool {
        let is_met = |hit: &Hit| !self.any_see_through || self.pane(hit, ray.direction).beside < 1.0;
        !self.accel.occluded(ray, |hit| !ends.contains(&hit.triangle) && is_met(hit))
    }

    fn pane(&self, hit: &Hit, direction: Vec3) -> Pane {
        let facet = self.facet(hit.triangle);
        let compiled = self.compiled_material(facet);
        if !compiled.lets_light_through {
            return Pane { t: hit.t, triangle: hit.triangle, beside: 0.0, through: Vec3::ZERO };
        }
        let context = self.context(facet, hit);
        let there = match context.material.alpha_mode {
            AlphaMode::Opaque => 1.0,
            AlphaMode::Mask(cutoff) => f32::from(u8::from(context.opacity() >= cutoff)),
            AlphaMode::Blend => context.opacity().clamp(0.0, 1.0),
        };
        let through = if context.material.transmission > 0.0 && there > 0.0 {
            context.substance(compiled).through(facet.normal.dot(direction.normalize_or_zero()))
        } else {
            Vec3::ZERO
        };
        Pane { t: hit.t, triangle: hit.triangle, beside: 1.0 - there, through: through * there }
    }

    fn context(&self, facet: &Facet, hit: &Hit) -> TextureContext<'_> {
        TextureContext::new(self, facet, hit.triangle - self.first(facet.mesh), Vec2::new(hit.u, hit.v))
    }
}

/// Checks everything that tracing takes for granted.
fn check(scene: &Scene) -> Result<()> {
    for (i, mesh) in scene.meshes.iter().enumerate() {
        check_mesh(scene, mesh).map_err(|e| e.within(format!("mesh {i} ({:?})", mesh.name)))?;
    }
    for (i, material) in scene.materials.iter().enumerate() {
        check_material(scene, material).map_err(|e| e.within(format!("material {i} ({:?})", material.name)))?;
    }
    for (i, texture) in scene.textures.iter().enumerate() {
        check_image(&texture.image).map_err(|e| e.within(format!("texture {i} ({:?})", texture.name)))?;
    }
    match &scene.environment {
        Some(Environment::Image(image)) => check_image(image).map_err(|e| e.within("environment")),
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
    for (name, len) in [("normals", mesh.normals.len()), ("uvs[0]", mesh.uvs[0].len()), ("uvs[1]", mesh.uvs[1].len())] {
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
    let refs = [
        &material.base_color_texture,
        &material.metallic_roughness_texture,
        &material.normal_texture,
        &material.emission_texture,
    ];
    for TextureRef { texture, uv_set, .. } in refs.into_iter().flatten() {
        if *texture >= scene.textures.len() || *uv_set > 1 {
            return Err(Error::argument(format!(
                "texture {texture} with texture coordinates {uv_set}; there are {} textures and sets 0 and 1",
                scene.textures.len()
            )));
        }
    }
    let numbers = [material.alpha, material.metallic, material.roughness, material.transmission, material.ior];
    let finite = material.base_color.is_finite() && material.emission.is_finite();
    if !finite || numbers.iter().any(|v| !v.is_finite()) || material.ior < 1.0 {
        return Err(Error::argument("its numbers must be finite and its index of refraction at least 1"));
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
