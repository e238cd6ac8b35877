//! Emissive surfaces as glare sources: the connected luminous parts of meshes that an observer sees.
//!
//! A raster whose cells have equal solid angles covers the hemisphere of directions ahead of the eye. Several rays at
//! random places in a cell find the luminous surfaces in the cell. These rays ignore all other surfaces, so an object
//! in front of a lamp does not divide the lamp into two sources.
//!
//! The search begins in the cells in whose centre a surface is luminous, and in the cells along the edges of the
//! emissive triangles, so that it finds narrow profiles, too. From each cell with a luminous surface, the search goes
//! on to the neighbouring cells. Touching cells in which the same connected surface is luminous form a source. The rays
//! in these cells give the mean luminance and the solid angle of the source, without the parts that other objects hide.
//! As only 16 rays look into a cell, the solid angle of a source of few cells is noisy; the rating states no error for
//! this noise.
//!
//! Not modelled: lamps in emission textures that are narrower than a cell (0.32°). The search may miss them.

use crate::accel::{Accel, Hit, Ray};
use crate::error::Result;
use crate::image::{colour, try_collect, try_push, try_vec, try_with_capacity};
use crate::job::Job;
use crate::render::light::connected;
use crate::render::world::World;
use crate::rng::Rng;
use crate::scene::{Material, Scene};
use glam::{DVec2, DVec3, Vec2, Vec3};

/// Number of cells along each side of the raster; a cell has 3.1e-5 sr, or 0.32° across.
const SIDE: usize = 512;
/// Rays in each cell that is looked into: `RAYS` × `RAYS`.
const RAYS: usize = 4;
/// A surface point is luminous if its luminance is at least this share of the largest luminance that its material
/// emits. In an emission texture, this excludes the glow around lamps. [convention]
const MIN_SHARE: f32 = 0.1;
/// Visibility rays end at this share of the distance to the surface, so that they do not hit that surface itself.
/// [rounding]
const NEARLY: f32 = 0.9999;
/// The search tests points along the edges of emissive triangles. Seen from the eye, neighbouring points are at most
/// this far apart, in radians: half the width of a cell. [convention]
const EDGE_STEP: f32 = 0.0028;
/// Largest number of steps from point to point along an edge. An edge that passes close by the eye would need more
/// steps; the search from cell to cell then finds the cells that were left out. [convention]
const MAX_EDGE_STEPS: f32 = 2048.0;
/// Label of a piece (a [`CellSurface`]) that does not have the number of a source yet.
const NONE: u32 = u32::MAX;

/// The emissive meshes of a scene.
pub struct EmissiveSurfaces {
    /// The triangles that emit, in the order of the world's emitters.
    accel: Accel,
    /// For each of these triangles, the first triangle of its connected surface.
    surface_of: Vec<u32>,
    /// For each material of these triangles, the least luminance in cd/m² of a luminous point.
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

/// Sums over the rays that have seen a source, or a piece of it in one cell: `rays` is the number of these rays,
/// `luminance` the sum of the luminances, `squared_share` the sum of the squared transmittances of the panes in front,
/// and `towards` the sum of the directions.
#[derive(Clone, Copy, Default)]
struct RaySums {
    mesh: usize,
    /// Number of rays that have seen the source or the piece.
    rays: f64,
    luminance: f64,
    squared_share: f64,
    towards: DVec3,
}

/// A piece: the part of one connected luminous surface that lies in one cell.
struct CellSurface {
    cell: u32,
    surface: u32,
    sums: RaySums,
}

/// The cells that the search has yet to look into (`open`), and for each cell, whether it has ever been added to them
/// (`is_known`). Each cell is added only once.
struct OpenCells {
    is_known: Vec<bool>,
    open: Vec<u32>,
}

impl OpenCells {
    fn new() -> Result<Self> {
        Ok(Self { is_known: try_vec(SIDE * SIDE, false)?, open: try_with_capacity(SIDE * SIDE)? })
    }

    fn add(&mut self, cell: usize) {
        if !std::mem::replace(&mut self.is_known[cell], true) {
            self.open.push(cell as u32);
        }
    }
}

impl EmissiveSurfaces {
    pub fn new(world: &World, job: Job) -> Result<Self> {
        let emitters = &world.lights().emitters;
        // The emitters of meshes come first; the faces of luminaires follow them.
        let of_meshes = emitters.emitters.iter().take_while(|emitter| world.is_of_scene(emitter.id));
        let corners = try_collect(of_meshes.map(|emitter| emitter.corners))?;
        let surface_of = if corners.is_empty() { Vec::new() } else { connected(emitters)? };
        let scene = world.scene();
        let mut min_luminance = try_vec(scene.materials.len(), f32::INFINITY)?;
        for emitter in &emitters.emitters[..corners.len()] {
            let material = world.mesh(emitter.mesh).material;
            if min_luminance[material].is_infinite() {
                min_luminance[material] = MIN_SHARE * largest_luminance(scene, &scene.materials[material], job)?;
            }
        }
        Ok(Self { accel: Accel::build(&corners, job)?, surface_of, min_luminance })
    }

    /// Whether a point of a mesh is luminous if it emits with `luminance`, in cd/m² ([`MIN_SHARE`]).
    pub fn is_luminous(&self, world: &World, mesh: u32, luminance: f32) -> bool {
        luminance > 0.0 && luminance >= self.min_luminance[world.mesh(mesh).material]
    }

    /// Returns the sources that an eye sees, in the order of their first cells, row by row of the raster.
    pub fn seen_from(&self, view: &View, seed: u64, job: Job) -> Result<Vec<LuminousPart>> {
        if self.surface_of.is_empty() {
            return Ok(Vec::new());
        }
        let mut cells = OpenCells::new()?;
        self.add_centres(&mut cells, view, job)?;
        self.add_edges(&mut cells, view, job)?;
        let mut pieces = Vec::new();
        for n in 0.. {
            let Some(cell) = cells.open.pop().map(|cell| cell as usize) else { break };
            if n % SIDE == 0 {
                job.check()?;
            }
            let before = pieces.len();
            self.look_into(cell, view, &mut Rng::new(seed, &[cell as u64]), &mut pieces)?;
            if pieces.len() > before {
                neighbours(cell).for_each(|near| cells.add(near));
            }
        }
        pieces.sort_unstable_by_key(|piece| (piece.cell, piece.surface));
        let (labels, count) = label(&pieces)?;
        let mut sums = try_vec(count, RaySums::default())?;
        pieces.iter().zip(&labels).for_each(|(piece, label)| sums[*label as usize].add(&piece.sums));
        Ok(sums.iter().filter(|sum| sum.rays > 0.0).map(RaySums::part).collect())
    }

    /// Adds the cells in whose centre a surface is luminous.
    fn add_centres(&self, cells: &mut OpenCells, view: &View, job: Job) -> Result<()> {
        for cell in 0..SIDE * SIDE {
            if cell % SIDE == 0 {
                job.check()?;
            }
            let ray = view.ray(cell, DVec2::splat(0.5));
            if ray.is_some_and(|(_, ray)| self.nearest(view.world, &ray).is_some()) {
                cells.add(cell);
            }
        }
        Ok(())
    }

    /// Adds the cells along the edges of the triangles that face the eye.
    fn add_edges(&self, cells: &mut OpenCells, view: &View, job: Job) -> Result<()> {
        let eye = view.world.from_scene(view.eye);
        let triangles = &view.world.lights().emitters.emitters[..self.surface_of.len()];
        for (n, triangle) in triangles.iter().enumerate() {
            if n % SIDE == 0 {
                job.check()?;
            }
            let corners = triangle.corners.map(|corner| corner - eye);
            if !triangle.faces(corners[0]) {
                continue;
            }
            for (a, b) in [(corners[0], corners[1]), (corners[1], corners[2]), (corners[2], corners[0])] {
                let edge = b - a;
                let nearest = a + edge * (-a.dot(edge) / edge.length_squared()).clamp(0.0, 1.0);
                let steps = (edge.length() / (nearest.length() * EDGE_STEP)).ceil().clamp(1.0, MAX_EDGE_STEPS);
                let points = (0..=steps as usize).map(|step| a + edge * (step as f32 / steps));
                points.filter_map(|point| view.cell(point.as_dvec3())).for_each(|cell| cells.add(cell));
            }
        }
        Ok(())
    }

    /// Traces the rays of a cell. For each connected luminous surface that the rays meet, adds a piece to `pieces`; its
    /// sums are 0 if other objects hide the surface from all rays.
    fn look_into(&self, cell: usize, view: &View, rng: &mut Rng, pieces: &mut Vec<CellSurface>) -> Result<()> {
        let emitters = &view.world.lights().emitters.emitters;
        let first = pieces.len();
        for i in 0..RAYS * RAYS {
            let place = DVec2::new((i % RAYS) as f64 + rng.next_f64(), (i / RAYS) as f64 + rng.next_f64());
            let Some((towards, ray)) = view.ray(cell, place / RAYS as f64) else { continue };
            let Some(met) = self.nearest(view.world, &ray) else { continue };
            let surface = self.surface_of[met.emitter];
            let known = pieces[first..].iter().position(|piece| piece.surface == surface);
            let index = match known {
                Some(index) => first + index,
                None => {
                    try_push(pieces, CellSurface { cell: cell as u32, surface, sums: RaySums::default() })?;
                    pieces.len() - 1
                }
            };
            let emitter = &emitters[met.emitter];
            let path = Ray { t_max: met.distance * NEARLY, ..ray };
            let light = view.world.transmittance_without(&path, |triangle| triangle == emitter.id, None);
            let share = f64::from(colour::luminance(light));
            if share > 0.0 {
                pieces[index].sums.add(&RaySums {
                    mesh: emitter.mesh as usize,
                    rays: 1.0,
                    luminance: f64::from(met.luminance),
                    squared_share: share * share,
                    towards,
                });
            }
        }
        Ok(())
    }

    /// Returns the nearest luminous point on a ray, even if other objects hide it; `None` if the ray meets no luminous
    /// point.
    fn nearest(&self, world: &World, ray: &Ray) -> Option<Luminous> {
        let hit = self.accel.closest(ray, |hit| self.luminance(world, ray, hit) > 0.0)?;
        let luminance = self.luminance(world, ray, &hit);
        Some(Luminous { emitter: hit.triangle as usize, distance: hit.t, luminance })
    }

    /// Returns the luminance of an emissive surface at a hit, towards the eye, times the opacity of the surface; 0 if
    /// the surface is not luminous there.
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
    /// Returns the direction and the ray from the eye through a point of a cell; `None` if the direction does not lead
    /// ahead of the eye. `place` is the position of the point in the cell, in `[0, 1]²`. The map from directions to the
    /// raster preserves areas (Lambert's azimuthal projection): it maps the hemisphere ahead of the eye to the circle
    /// inscribed in the raster.
    fn ray(&self, cell: usize, place: DVec2) -> Option<(DVec3, Ray)> {
        let at = (DVec2::new((cell % SIDE) as f64, (cell / SIDE) as f64) + place) * (2.0 / SIDE as f64) - 1.0;
        let squared = at.length_squared();
        if squared >= 1.0 {
            return None;
        }
        let [right, up, ahead] = self.frame;
        let across = at * (2.0 - squared).sqrt();
        let towards = right * across.x + up * across.y + ahead * (1.0 - squared);
        Some((towards, self.world.ray(self.eye, towards.as_vec3())))
    }

    /// Returns the cell in which a direction of any length lies, by the inverse of the map of [`Self::ray`]; `None` if
    /// the direction does not lead ahead of the eye.
    fn cell(&self, direction: DVec3) -> Option<usize> {
        let [right, up, ahead] = self.frame;
        let towards = direction.normalize_or_zero();
        let forward = ahead.dot(towards);
        if forward <= 0.0 {
            return None;
        }
        let at = DVec2::new(right.dot(towards), up.dot(towards)) / (1.0 + forward).sqrt();
        let [x, y] = ((at + 1.0) * (SIDE as f64 / 2.0)).to_array().map(|v| (v as usize).min(SIDE - 1));
        Some(y * SIDE + x)
    }
}

impl RaySums {
    fn add(&mut self, other: &Self) {
        if other.rays > 0.0 {
            self.mesh = other.mesh;
        }
        self.rays += other.rays;
        self.luminance += other.luminance;
        self.squared_share += other.squared_share;
        self.towards += other.towards;
    }

    fn part(&self) -> LuminousPart {
        // Take half the side of the raster as the unit of length. The inscribed circle then has the area π and stands
        // for 2π steradians, so the raster, of area 4, stands for 8 steradians.
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
fn largest_luminance(scene: &Scene, material: &Material, job: Job) -> Result<f32> {
    let Some(reference) = material.emission_texture.filter(|_| material.emission != Vec3::ZERO) else {
        return Ok(colour::luminance(material.emission));
    };
    let texture = &scene.textures[reference.texture];
    let mut largest = 0.0f32;
    for y in 0..texture.image.height {
        job.check()?;
        let texels = (0..texture.image.width).map(|x| material.emission * texture.texel(x, y).truncate());
        largest = texels.map(colour::luminance).fold(largest, f32::max);
    }
    Ok(largest)
}

/// Returns the indices of a cell and of the cells that touch it.
fn neighbours(cell: usize) -> impl Iterator<Item = usize> {
    let beside = |at: usize| at.saturating_sub(1)..=(at + 1).min(SIDE - 1);
    let (x, y) = (cell % SIDE, cell / SIDE);
    beside(y).flat_map(move |y| beside(x).map(move |x| y * SIDE + x))
}

/// Numbers the sources: pieces of one surface in touching cells belong to one source. `pieces` must be sorted by cell,
/// and within a cell by surface. Returns the number of each piece's source, and the number of sources.
fn label(pieces: &[CellSurface]) -> Result<(Vec<u32>, usize)> {
    let at = |cell: usize, surface: u32| {
        pieces.binary_search_by_key(&(cell as u32, surface), |piece| (piece.cell, piece.surface)).ok()
    };
    let mut labels = try_vec(pieces.len(), NONE)?;
    let mut open = try_with_capacity(pieces.len())?;
    let mut count = 0;
    for start in 0..pieces.len() {
        if labels[start] != NONE {
            continue;
        }
        labels[start] = count as u32;
        open.push(start);
        while let Some(piece) = open.pop() {
            let CellSurface { cell, surface, .. } = pieces[piece];
            for next in neighbours(cell as usize).filter_map(|near| at(near, surface)) {
                if labels[next] == NONE {
                    labels[next] = count as u32;
                    open.push(next);
                }
            }
        }
        count += 1;
    }
    Ok((labels, count))
}
