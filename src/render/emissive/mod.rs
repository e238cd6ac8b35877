//! Emissive triangles. Points on textured emitters are sampled in proportion to the emission of the texels.
//!
//! Every emitter is divided into pieces, and [`super::light`] selects a piece. A triangle of uniform emission is one
//! piece. A textured triangle is divided into tiles of 8 × 8 texels, and every tile that emits is a piece. Within a
//! piece, points are sampled in proportion to the emission of their texel; the area pdf is the emission at the point
//! divided by the intensity of the piece. So thousands of small lamps in one texture cost as much as one lamp, and no
//! sample falls on a dark texel. Emission textures are looked up without interpolation, because interpolated light
//! would spread to dark texels. A textured triangle is one piece and is sampled uniformly if its texture coordinates
//! have no area, lie within a single texel, span too many texels, or lie too far from 0.
//!
//! The faces of luminaires ([`super::luminaires`]) are emitters, too. A patch of a face is one piece. Each triangle of
//! the patch is selected with the same probability, and points on it are sampled uniformly. The emission of faces
//! depends on the direction.

mod emitter;
mod face_patches;
mod polygon;
mod tiles;

pub use emitter::Emitter;

use super::bounds::Bounds;
use super::contribution::{LightSource, mean_channel};
use super::facet::Facet;
use super::luminaires::FaceLuminaire;
use crate::error::Result;
use crate::image::{reserve_capacity, try_collect, try_vec, try_with_capacity};
use crate::scene::Scene;
use face_patches::FacePatches;
use glam::{Vec2, Vec3};
use polygon::uniform_in_triangle;
use rayon::prelude::*;
use tiles::{EmissiveTile, Tiling};

/// Index that stands for "no piece".
const NONE: u32 = u32::MAX;

pub struct Emitters {
    pub emitters: Vec<Emitter>,
    /// How each emitter is divided into pieces.
    divisions: Vec<Division>,
    tilings: Vec<Tiling>,
    /// For each tile of each tiling, the index of the tile's piece; `NONE` for dark tiles.
    piece_of_tile: Vec<u32>,
    /// The undivided triangles (`uniform`) and the emissive tiles. Piece indices count the triangles first, then the
    /// tiles.
    uniform: Vec<UniformTriangle>,
    tiles: Vec<EmissiveTile>,
    /// The patches of luminaires' faces. Their piece indices follow the indices of the tiles.
    patches: FacePatches,
    /// Flux of all emitters in lumens; for a double-sided emitter, only one side counts.
    pub power: f64,
}

#[derive(Clone, Copy)]
enum Division {
    /// A single piece, by its index; `NONE` for a dark triangle.
    Uniform(u32),
    /// A tiling, by its index; its tiles are listed in `piece_of_tile` from index `first` on.
    Tiled { tiling: u32, first: usize },
    /// The triangle belongs to a patch of a luminaire, given by its index.
    Patch(u32),
}

/// A piece, the unit that light sampling selects.
enum Piece<'a> {
    Uniform(&'a UniformTriangle),
    Tile(&'a EmissiveTile),
    /// A patch of a luminaire, by its index.
    Patch(usize),
}

/// A triangle that is not divided, but sampled uniformly as one piece.
struct UniformTriangle {
    emitter: u32,
    /// Emission × area, mean of the channels: the luminous intensity along the normal, in cd.
    intensity: f32,
}

impl Emitters {
    /// Finds the emitters among `facets`, the triangles of a validated scene, and divides them into pieces. `first`
    /// holds the id of each mesh's first triangle. Also returns the bounds of every piece.
    pub fn build(scene: &Scene, facets: &[Facet], first: &[u32]) -> Result<(Self, Vec<Bounds>)> {
        let numbered = facets.iter().zip(0..);
        let emitters = try_collect(numbered.filter_map(|(f, id)| Emitter::new(scene, f, id, first)))?;
        let mut this = Self {
            divisions: try_vec(emitters.len(), Division::Uniform(NONE))?,
            emitters,
            tilings: Vec::new(),
            piece_of_tile: Vec::new(),
            uniform: Vec::new(),
            tiles: Vec::new(),
            patches: FacePatches::default(),
            power: 0.0,
        };
        let mut bounds = Vec::new();
        this.add_uniform(scene, &mut bounds);
        this.add_tiled(scene, &mut bounds)?;
        let intensities = this.uniform.iter().map(|e| e.intensity).chain(this.tiles.iter().map(|t| t.intensity));
        this.power = std::f64::consts::PI * intensities.map(f64::from).sum::<f64>();
        Ok((this, bounds))
    }

    /// Adds one piece for each emitter that is not divided into tiles, and stores the tilings of the other emitters.
    fn add_uniform(&mut self, scene: &Scene, bounds: &mut Vec<Bounds>) {
        for (index, emitter) in self.emitters.iter().enumerate() {
            let texture = emitter.texture.map(|t| &scene.textures[t]);
            if let Some(tiling) = texture.and_then(|t| Tiling::new(emitter, t)) {
                self.divisions[index] = Division::Tiled { tiling: self.tilings.len() as u32, first: 0 };
                self.tilings.push(tiling);
                continue;
            }
            let mean = texture.map_or(f64::from(mean_channel(emitter.factor)), |t| Tiling::mean_around(emitter, t));
            let intensity = (mean * f64::from(emitter.area)) as f32;
            if intensity > 0.0 && intensity.is_finite() {
                self.divisions[index] = Division::Uniform(self.uniform.len() as u32);
                self.uniform.push(UniformTriangle { emitter: index as u32, intensity });
                bounds.push(Bounds::of_surface(emitter.corners, emitter.normal, emitter.double_sided, intensity));
            }
        }
    }

    /// Adds one piece for every tile that emits.
    fn add_tiled(&mut self, scene: &Scene, bounds: &mut Vec<Bounds>) -> Result<()> {
        // Collect rows of tiles, in the order of their emitters, to process them in parallel.
        let mut rows = Vec::new();
        let mut count = 0;
        for (index, division) in self.divisions.iter_mut().enumerate() {
            if let Division::Tiled { tiling, first } = division
                && let Some(texture) = self.emitters[index].texture
            {
                *first = count;
                let tiling = &self.tilings[*tiling as usize];
                rows.extend((0..tiling.rows).map(|row| (index, &scene.textures[texture], tiling, row)));
                count += tiling.rows * tiling.columns;
            }
        }
        self.piece_of_tile = try_vec(count, NONE)?;
        let columns: Vec<Vec<usize>> = rows
            .par_iter()
            .map(|&(_, texture, tiling, row)| {
                (0..tiling.columns).filter(|&column| tiling.may_emit(texture, [column, row])).collect()
            })
            .collect();
        let mut work = try_with_capacity(columns.iter().map(Vec::len).sum())?;
        for (&(index, texture, tiling, row), columns) in rows.iter().zip(&columns) {
            work.extend(columns.iter().map(|&column| (index, texture, tiling, [column, row])));
        }
        let (mut tiles, mut light) = (try_with_capacity(work.len())?, try_with_capacity(work.len())?);
        work.par_iter()
            .map(|&(index, texture, tiling, place)| tiling.tile(index as u32, &self.emitters[index], texture, place))
            .unzip_into_vecs(&mut tiles, &mut light);

        // Drop tiles whose emissive texels all lie outside their triangle.
        tiles.retain(|tile| tile.intensity > 0.0);
        light.retain(|bounds| bounds.intensity > 0.0);
        for (tile, piece) in tiles.iter().zip(self.uniform.len() as u32..) {
            if let Division::Tiled { tiling, first } = self.divisions[tile.emitter as usize] {
                let columns = self.tilings[tiling as usize].columns;
                self.piece_of_tile[first + tile.row as usize * columns + tile.column as usize] = piece;
            }
        }
        self.tiles = tiles;
        reserve_capacity(bounds, light.len())?;
        bounds.append(&mut light);
        Ok(())
    }

    /// Adds the faces of luminaires. `meshes` is the number of the scene's own meshes; the meshes of its lights follow
    /// them. `first` holds the id of each mesh's first triangle. Appends the bounds of every patch to `bounds`.
    pub fn add_luminaires(
        &mut self,
        sources: Vec<FaceLuminaire>,
        facets: &[Facet],
        meshes: usize,
        first: &[u32],
        bounds: &mut Vec<Bounds>,
    ) -> Result<()> {
        for source in sources {
            let mesh = meshes + source.light;
            for (triangles, bound) in source.patches(mean_channel(source.emission.colour())) {
                let (patch, start) = (self.patches.count(), self.emitters.len());
                reserve_capacity(&mut self.emitters, triangles.len())?;
                reserve_capacity(&mut self.divisions, triangles.len())?;
                for triangle in triangles {
                    let id = first[mesh] + triangle as u32;
                    let numbers = [mesh as u32, triangle as u32, id];
                    self.emitters.extend(Emitter::of_patch(&facets[id as usize], numbers, patch));
                }
                if self.emitters.len() > start {
                    self.divisions.resize(self.emitters.len(), Division::Patch(patch));
                    self.patches.add_patch(start..self.emitters.len());
                    bounds.push(bound);
                }
            }
            self.power += source.flux();
            self.patches.add_luminaire(source.light, source.emission);
        }
        Ok(())
    }

    /// Samples a point of a piece (an undivided triangle, a tile of a textured triangle, or a patch of a luminaire).
    /// Points of a tile are sampled in proportion to the emission at the point, all others uniformly on their triangle.
    /// Returns the index of the emitter and the barycentric coordinates of the point; `None` if rounding
    /// selected a texel of a tile outside the triangle.
    #[inline]
    pub fn sample(&self, piece: usize, (u, v): (f64, f32)) -> Option<(usize, Vec2)> {
        match self.piece(piece) {
            Piece::Uniform(triangle) => Some((triangle.emitter as usize, uniform_in_triangle(Vec2::new(u as f32, v)))),
            Piece::Tile(tile) => {
                let emitter = tile.emitter as usize;
                let Division::Tiled { tiling, .. } = self.divisions[emitter] else { return None };
                Some((emitter, self.tilings[tiling as usize].sample(tile, (u, v))?))
            }
            Piece::Patch(patch) => Some(self.patches.sample(patch, (u, v))),
        }
    }

    /// Returns a piece by its index.
    #[inline]
    fn piece(&self, index: usize) -> Piece<'_> {
        let Some(tile) = index.checked_sub(self.uniform.len()) else { return Piece::Uniform(&self.uniform[index]) };
        self.tiles.get(tile).map_or_else(|| Piece::Patch(tile - self.tiles.len()), Piece::Tile)
    }

    /// Returns the emission of an emitter at a point towards a viewer in a unit direction, in cd/m² per channel. Also
    /// returns the texture coordinates of the look-up, or 0 for a luminaire.
    #[inline]
    pub fn emission(&self, scene: &Scene, emitter: usize, barycentric: Vec2, direction: Vec3) -> (Vec3, Vec2) {
        let emitter = &self.emitters[emitter];
        match emitter.patch {
            NONE => emitter.emission(scene, barycentric),
            patch => (self.patches.radiance(patch, direction), Vec2::ZERO),
        }
    }

    /// Returns the light source that an emitter belongs to; `uv` are the texture coordinates of the look-up of its
    /// emission.
    #[inline]
    pub fn source(&self, emitter: usize, uv: Vec2) -> LightSource {
        let emitter = &self.emitters[emitter];
        match emitter.patch {
            NONE => LightSource::Surface { mesh: emitter.mesh, triangle: emitter.triangle, uv },
            patch => LightSource::Punctual(self.patches.light(patch)),
        }
    }

    /// Whether two emitters belong to the faces of the same luminaire.
    pub fn are_of_one_luminaire(&self, pair: [usize; 2]) -> bool {
        let [a, b] = pair.map(|emitter| self.emitters[emitter].patch);
        a != NONE && b != NONE && self.patches.light(a) == self.patches.light(b)
    }

    /// Returns the index of the first emitter of a piece.
    pub fn emitter_of(&self, piece: usize) -> usize {
        match self.piece(piece) {
            Piece::Uniform(triangle) => triangle.emitter as usize,
            Piece::Tile(tile) => tile.emitter as usize,
            Piece::Patch(patch) => self.patches.first_emitter(patch),
        }
    }

    /// Returns the piece of an emitter at the texture coordinates `uv`; `None` if the tile or the triangle there is
    /// dark.
    pub fn piece_at(&self, emitter: usize, uv: Vec2) -> Option<usize> {
        let piece = match self.divisions[emitter] {
            Division::Uniform(piece) => piece,
            Division::Tiled { tiling, first } => self.piece_of_tile[first + self.tilings[tiling as usize].tile_at(uv)],
            Division::Patch(patch) => (self.uniform.len() + self.tiles.len()) as u32 + patch,
        };
        (piece != NONE).then_some(piece as usize)
    }

    /// Returns the area pdf (per m²) with which [`Emitters::sample`] draws a point of the given piece. It does not
    /// include the probability of choosing the piece. `emitter` is the emitter at the point, and `brightness` the
    /// emission there, mean of the channels.
    pub fn area_pdf(&self, piece: usize, emitter: usize, brightness: f32) -> f32 {
        match self.piece(piece) {
            Piece::Uniform(triangle) => 1.0 / self.emitters[triangle.emitter as usize].area,
            Piece::Tile(tile) => brightness / tile.intensity,
            Piece::Patch(patch) => self.patches.share(patch) / self.emitters[emitter].area,
        }
    }
}

#[cfg(test)]
mod tests;
