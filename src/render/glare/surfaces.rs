//! Emissive surfaces as glare sources: the connected luminous parts of meshes that an observer sees.
//!
//! Rays from the eye cover the half of space ahead of it with a raster whose cells have equal solid angles. They meet
//! luminous surfaces only, so a thing in front of a lamp does not divide the lamp. Neighbouring cells in which the same
//! connected surface is luminous form a source. Each of these cells, and each cell beside them, then gets several rays
//! at random places: they give the source's mean luminance and its solid angle. Parts of the source that other things
//! hide are left out.
//!
//! Not modelled: sources smaller than a cell, which may be missed. Their solid angle is a tenth of the smallest for
//! which CIE 117 is valid.

use crate::accel::{Accel, Hit, Ray};
use crate::error::Result;
use crate::image::{colour, try_collect, try_vec};
use crate::job::Job;
use crate::render::light::connected;
use crate::render::world::World;
use crate::rng::Rng;
use crate::scene::{Material, Scene};
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Number of cells along each side of the raster; a cell has 3.1e-5 sr, or 0.32° across.
const SIDE: usize = 512;
/// Rays in a cell of a source: `RAYS` × `RAYS`.
const RAYS: usize = 4;
/// A surface point is luminous if its luminance is at least this share of the largest that its material emits. The
/// glow around lamps in a texture is darker than this. [convention]
const MIN_SHARE: f32 = 0.1;
/// Visibility rays end at this share of the distance to the surface, so that they do not hit it. [rounding]
const NEARLY: f32 = 0.9999;
/// Label of cells without a luminous surface.
const NONE: u32 = u32::MAX;

/// The emissive meshes of a scene.
pub struct Surfaces {
    /// The triangles that emit, in the order of the world's emitters.
    accel: Accel,
    /// For each of these triangles, the first triangle of its connected surface.
    surface_of: Vec<u32>,
    /// For each material, the least luminance in cd/m² of a luminous point.
    min_luminance: Vec<f32>,
}

/// A luminous part of a connected surface, as an observer sees it.
#[derive(Clone, Copy)]
pub struct LuminousPart {
    pub mesh: usize,
    /// Mean luminance of the visible part in cd/m², times the root mean square transmittance of the panes in front of
    /// it.
    pub luminance: f64,
    /// Solid angle of the visible part in steradians.
    pub solid_angle: f64,
    /// Unit direction from the eye to the middle of the visible part.
    pub towards: DVec3,
}

/// An observer's eye in a scene.
pub struct View<'a> {
    pub world: &'a World,
    /// Position of the eye in scene coordinates.
    pub eye: Vec3,
    /// Unit directions to the right of the eye, above it and ahead of it.
    pub frame: [DVec3; 3],
}

/// A luminous point that a ray from the eye meets.
struct Luminous {
    emitter: usize,
    distance: f32,
    luminance: f32,
}

/// What rays have seen of a source.
#[derive(Clone, Copy, Default)]
struct Sums {
    mesh: usize,
    rays: f64,
    luminance: f64,
    squared_share: f64,
    towards: DVec3,
}

impl Surfaces {
    pub fn new(world: &World, job: Job) -> Result<Self> {
        let emitters = &world.lights().emitters;
        // The emitters of meshes come first; the faces of luminaires follow them.
        let of_meshes = emitters.emitters.iter().take_while(|emitter| world.is_of_scene(emitter.id));
        let corners = try_collect(of_meshes.map(|emitter| emitter.corners))?;
        let surface_of = if corners.is_empty() { Vec::new() } else { connected(emitters)? };
        let scene = world.scene();
        let min_luminance = scene.materials.iter().map(|material| MIN_SHARE * largest_luminance(scene, material));
        Ok(Self { accel: Accel::build(&corners, job)?, surface_of, min_luminance: try_collect(min_luminance)? })
    }

    /// Whether light of this luminance, from a mesh, comes from a luminous part.
    pub fn is_luminous(&self, world: &World, mesh: u32, luminance: f32) -> bool {
        luminance > 0.0 && luminance >= self.min_luminance[world.mesh(mesh).material]
    }

    /// Returns the sources that an eye sees, in the order in which the raster meets them.
    pub fn seen_from(&self, view: &View, seed: u64, job: Job) -> Result<Vec<LuminousPart>> {
        if self.surface_of.is_empty() {
            return Ok(Vec::new());
        }
        let mut cells = try_vec(SIDE * SIDE, NONE)?;
        for (y, row) in cells.chunks_exact_mut(SIDE).enumerate() {
            job.check()?;
            for (x, cell) in row.iter_mut().enumerate() {
                let ray = view.ray([x, y], DVec2::splat(0.5));
                let met = ray.and_then(|(_, ray)| self.nearest(view.world, &ray));
                *cell = met.map_or(NONE, |luminous| self.surface_of[luminous.emitter]);
            }
        }
        let (labels, count) = label(&cells)?;
        let mut sums = try_vec(count, Sums::default())?;
        for y in 0..SIDE {
            job.check()?;
            for x in 0..SIDE {
                let near = neighbours([x, y]).map(|i| (cells[i], labels[i])).filter(|(surface, _)| *surface != NONE);
                if near.clone().next().is_some() {
                    self.look_into([x, y], view, &near, &mut Rng::new(seed, &[x as u64, y as u64]), &mut sums);
                }
            }
        }
        Ok(sums.iter().filter(|sum| sum.rays > 0.0).map(Sums::part).collect())
    }

    /// Traces the rays of a cell and adds what they see to the sums of the sources. `near` holds surface and source of
    /// the cell and of the cells beside it, without those that have none.
    fn look_into(
        &self,
        cell: [usize; 2],
        view: &View,
        near: &(impl Iterator<Item = (u32, u32)> + Clone),
        rng: &mut Rng,
        sums: &mut [Sums],
    ) {
        let emitters = &view.world.lights().emitters.emitters;
        for i in 0..RAYS * RAYS {
            let place = DVec2::new((i % RAYS) as f64 + rng.next_f64(), (i / RAYS) as f64 + rng.next_f64());
            let Some((towards, ray)) = view.ray(cell, place / RAYS as f64) else { continue };
            let Some(met) = self.nearest(view.world, &ray) else { continue };
            let surface = self.surface_of[met.emitter];
            let Some((_, source)) = near.clone().find(|(other, _)| *other == surface) else { continue };
            let emitter = &emitters[met.emitter];
            let path = Ray { t_max: met.distance * NEARLY, ..ray };
            let light = view.world.transmittance_without(&path, |triangle| triangle == emitter.id, None);
            let share = f64::from(colour::luminance(light));
            if share > 0.0 {
                let sum = &mut sums[source as usize];
                sum.mesh = emitter.mesh as usize;
                sum.rays += 1.0;
                sum.luminance += f64::from(met.luminance);
                sum.squared_share += share * share;
                sum.towards += towards;
            }
        }
    }

    /// Returns the nearest luminous point on a ray.
    fn nearest(&self, world: &World, ray: &Ray) -> Option<Luminous> {
        let hit = self.accel.closest(ray, |hit| self.luminance(world, ray, hit) > 0.0)?;
        let luminance = self.luminance(world, ray, &hit);
        Some(Luminous { emitter: hit.triangle as usize, distance: hit.t, luminance })
    }

    /// Returns the luminance of a surface towards the eye; 0 if the surface is not luminous there.
    fn luminance(&self, world: &World, ray: &Ray, hit: &Hit) -> f32 {
        let emitter = &world.lights().emitters.emitters[hit.triangle as usize];
        if !emitter.faces(ray.direction) {
            return 0.0;
        }
        let luminance = colour::luminance(emitter.emission(world.scene(), Vec2::new(hit.u, hit.v)).0);
        if !self.is_luminous(world, emitter.mesh, luminance) {
            return 0.0;
        }
        luminance * (1.0 - world.pane(&Hit { triangle: emitter.id, ..*hit }, ray.direction).uncovered)
    }
}

impl View<'_> {
    /// Returns the direction and the ray to a point of a cell, which `place` gives in `[0, 1]²`; `None` if the point is
    /// not ahead of the eye. The map has equal areas (Lambert's azimuthal projection): the hemisphere ahead of the eye
    /// becomes the circle in the raster.
    fn ray(&self, cell: [usize; 2], place: DVec2) -> Option<(DVec3, Ray)> {
        let at = (DVec2::new(cell[0] as f64, cell[1] as f64) + place) * (2.0 / SIDE as f64) - 1.0;
        let squared = at.length_squared();
        if squared >= 1.0 {
            return None;
        }
        let [right, up, ahead] = self.frame;
        let across = at * (2.0 - squared).sqrt();
        let towards = right * across.x + up * across.y + ahead * (1.0 - squared);
        Some((towards, self.world.ray(self.eye, towards.as_vec3())))
    }
}

impl Sums {
    fn part(&self) -> LuminousPart {
        // The circle in the raster has the area π in units of half the raster's side, and stands for 2π steradians.
        let of_ray = 8.0 / (SIDE * SIDE * RAYS * RAYS) as f64;
        LuminousPart {
            mesh: self.mesh,
            luminance: self.luminance / self.rays * (self.squared_share / self.rays).sqrt(),
            solid_angle: self.rays * of_ray,
            towards: self.towards.normalize_or_zero(),
        }
    }
}

/// Returns the largest luminance that a material emits, in cd/m².
fn largest_luminance(scene: &Scene, material: &Material) -> f32 {
    let Some(reference) = material.emission_texture.filter(|_| material.emission != Vec3::ZERO) else {
        return colour::luminance(material.emission);
    };
    let texture = &scene.textures[reference.texture];
    let texels = (0..texture.image.width * texture.image.height)
        .map(|i| texture.texel(i % texture.image.width, i / texture.image.width).truncate());
    texels.map(|texel| colour::luminance(material.emission * texel)).fold(0.0, f32::max)
}

/// Returns the indices of a cell and of the cells that touch it, the cell itself first.
fn neighbours([x, y]: [usize; 2]) -> impl Iterator<Item = usize> + Clone {
    let beside = |at: usize| at.saturating_sub(1)..=(at + 1).min(SIDE - 1);
    let around = beside(y).flat_map(move |y| beside(x).map(move |x| y * SIDE + x));
    std::iter::once(y * SIDE + x).chain(around)
}

/// Divides the cells into connected regions of one surface. Returns the number of each cell's region, [`NONE`] for
/// cells without a surface, and the number of regions.
fn label(cells: &[u32]) -> Result<(Vec<u32>, usize)> {
    let mut labels = try_vec(cells.len(), NONE)?;
    let (mut open, mut count) = (Vec::new(), 0);
    for start in 0..cells.len() {
        if cells[start] == NONE || labels[start] != NONE {
            continue;
        }
        labels[start] = count as u32;
        open.push(start);
        while let Some(cell) = open.pop() {
            for next in neighbours([cell % SIDE, cell / SIDE]) {
                if cells[next] == cells[start] && labels[next] == NONE {
                    labels[next] = count as u32;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    Ok((labels, count))
}
