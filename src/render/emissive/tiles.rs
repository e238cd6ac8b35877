//! Divides the part of an emission texture that a triangle covers into tiles of 8 × 8 texels. Each tile has a
//! cumulative distribution of the emission over its texels.
//!
//! The tile grid starts at the first texel of the triangle's bounding box. Tiles beyond the texture read the texels
//! that the texture's wrap mode puts there. At the edges of the triangle, only the covered part of a texel counts. The
//! table of a tile takes four cache lines; dark tiles are not stored.

use super::emitter::Emitter;
use super::polygon::{Overlap, Polygon, Rectangle};
use crate::render::bounds::Bounds;
use crate::scene::Texture;
use glam::{DMat2, DVec2, Vec2};

/// Side of a tile in texels.
pub const SIDE: usize = 8;

/// A triangle is divided into tiles only if its bounding box has at most `max(MAX_TEXELS, 4 t)` texels, where t is the
/// number of texels of the texture. The limit bounds memory. [convention]
const MAX_TEXELS: f64 = (1 << 26) as f64;
/// Bound on texture coordinates, in texels. Beyond it, single precision cannot separate neighbouring texels.
/// [rounding]
const MAX_TEXEL_COORDINATE: f64 = 8e6;

/// The division of a textured triangle into tiles.
pub struct Tiling {
    /// The triangle's corners in texel coordinates.
    triangle: [DVec2; 3],
    /// Converts an offset from the triangle's first corner, in texels, to barycentric coordinates.
    to_barycentric: DMat2,
    /// The first texel of the tile grid (`start`), and the number of tiles along u (`columns`) and v (`rows`).
    start: [i64; 2],
    pub columns: usize,
    pub rows: usize,
    /// Size of the texture in texels, in f32 because texture look-ups compute in f32.
    size: Vec2,
}

/// A tile that emits. Its distribution is stored inline and aligned to cache lines, so that sampling touches few cache
/// lines.
#[repr(align(64))]
pub struct EmissiveTile {
    pub emitter: u32,
    /// Emission × area, mean of the channels: the luminous intensity along the normal, in cd.
    pub intensity: f32,
    pub column: u32,
    pub row: u32,
    /// Whether the triangle covers the whole tile.
    whole: bool,
    /// Cumulative distribution of the tile's intensity over its texels, row by row; the last entry is 1.
    shares: [f32; SIDE * SIDE],
}

impl Tiling {
    /// Builds the tiling of an emitter; `None` if the emitter's texture coordinates have no area, lie within a single
    /// texel, span too many texels, or lie too far from 0.
    pub fn new(emitter: &Emitter, texture: &Texture) -> Option<Self> {
        let triangle = emitter.texels(texture);
        let [a, b, c] = triangle;
        let (low, high) = (a.min(b).min(c).floor(), a.max(b).max(c).floor());
        let span = high - low + 1.0;
        let area = (b - a).perp_dot(c - a).abs() / 2.0;
        let texels = texture.image.width as f64 * texture.image.height as f64;
        let texels_spanned = span.element_product();
        let countable = texels_spanned > 1.0 && texels_spanned <= MAX_TEXELS.max(4.0 * texels);
        if !(countable
            && low.abs().max(high.abs()).max_element() < MAX_TEXEL_COORDINATE
            && area > 1e-6 * texels_spanned)
        {
            return None;
        }
        let to_barycentric = DMat2::from_cols(b - a, c - a).inverse();
        let tiles = |texels: f64| (texels as usize).div_ceil(SIDE);
        to_barycentric.is_finite().then(|| Self {
            triangle,
            to_barycentric,
            start: [low.x as i64, low.y as i64],
            columns: tiles(span.x),
            rows: tiles(span.y),
            size: Vec2::new(texture.image.width as f32, texture.image.height as f32),
        })
    }

    /// Returns the index of the tile at texture coordinates `uv`; tiles are numbered row by row.
    pub fn tile_at(&self, uv: Vec2) -> usize {
        let texel = (uv * self.size).floor();
        let tile = |texel: f32, start: i64, count: usize| {
            // Clamp, because rounding can put a point on the border one texel outside.
            ((texel as i64 - start) / SIDE as i64).clamp(0, count as i64 - 1) as usize
        };
        tile(texel.y, self.start[1], self.rows) * self.columns + tile(texel.x, self.start[0], self.columns)
    }

    /// Whether the triangle overlaps the tile and the texels of the tile may emit. This cheap test rejects most tiles,
    /// because most tiles lie between the lamps.
    pub fn may_emit(&self, texture: &Texture, [column, row]: [usize; 2]) -> bool {
        let first = self.first_texel(column, row);
        rectangle(first, SIDE as f64).overlap(&self.triangle) != Overlap::None
            && !self.texel_inside(first).is_some_and(|texel| texture.is_black(texel, SIDE))
    }

    /// Returns column and row, in the texture, of the first texel of a tile; `None` if the tile extends beyond the
    /// texture. `first` holds the texel's coordinates before the wrap mode is applied.
    fn texel_inside(&self, first: DVec2) -> Option<[usize; 2]> {
        let last = first + (SIDE - 1) as f64;
        let is_inside =
            first.min_element() >= 0.0 && last.x < f64::from(self.size.x) && last.y < f64::from(self.size.y);
        is_inside.then_some([first.x as usize, first.y as usize])
    }

    /// Builds one tile of the emitter `emitter`, whose index is `index`, and the bounds of the tile's light. The
    /// intensity of a dark tile is 0.
    pub fn tile(
        &self,
        index: u32,
        emitter: &Emitter,
        texture: &Texture,
        [column, row]: [usize; 2],
    ) -> (EmissiveTile, Bounds) {
        let first = self.first_texel(column, row);
        let overlap = rectangle(first, SIDE as f64).overlap(&self.triangle);
        let first_texel = self.texel_inside(first);
        // Compute the area of a texel on the triangle in m² (`scale`).
        let doubled = (self.triangle[1] - self.triangle[0]).perp_dot(self.triangle[2] - self.triangle[0]).abs();
        let scale = 2.0 * f64::from(emitter.area) / doubled;
        let mut sums = [0.0f64; SIDE * SIDE];
        let mut sum = 0.0;
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (i, running) in sums.iter_mut().enumerate() {
            let texel = first + DVec2::new((i % SIDE) as f64, (i / SIDE) as f64);
            let colour = match first_texel {
                Some([x, y]) => texture.texel(x + i % SIDE, y + i / SIDE),
                None => texture.continued(texel.as_vec2()),
            };
            let emission = emitter.emission_of_texel(colour);
            if emission > 0.0 {
                let area = if overlap == Overlap::Whole { 1.0 } else { self.covered(&rectangle(texel, 1.0)) };
                if area > 0.0 {
                    sum += f64::from(emission) * area * scale;
                    (low, high) = (low.min(texel), high.max(texel + 1.0));
                }
            }
            *running = sum;
        }
        let intensity = if (sum as f32).is_finite() { sum as f32 } else { 0.0 };
        // Compute the bounds of the part of the triangle that lies in the rectangle around the emissive texels.
        let lit = Polygon::clipped(&self.triangle, &Rectangle { low, high });
        let corners = lit.corners().iter().map(|&p| emitter.point(self.barycentric(p)));
        let bounds = Bounds::of_surface(corners, emitter.normal, emitter.double_sided, intensity);
        let shares = sums.map(|s| (s / sum) as f32);
        let whole = overlap == Overlap::Whole;
        (EmissiveTile { emitter: index, intensity, column: column as u32, row: row as u32, whole, shares }, bounds)
    }

    /// Returns the area, in texels, of the part of a rectangle that the triangle covers.
    fn covered(&self, rectangle: &Rectangle) -> f64 {
        match rectangle.overlap(&self.triangle) {
            Overlap::None => 0.0,
            Overlap::Whole => rectangle.area(),
            Overlap::Part => Polygon::clipped(&self.triangle, rectangle).area(),
        }
    }

    /// Samples a point of a tile in proportion to its emission: `u` selects the texel. The remainder of `u`, rescaled
    /// to `[0, 1]`, and `v` select the point within the texel. Returns barycentric coordinates; `None` if rounding
    /// selected a texel outside the triangle.
    pub fn sample(&self, tile: &EmissiveTile, (u, v): (f64, f32)) -> Option<Vec2> {
        let (shares, target) = (&tile.shares, (u as f32).min(1.0 - f32::EPSILON));
        // Count the entries up to the target instead of bisecting: the table is in the cache, and the count has no
        // branch that could be mispredicted.
        let before = shares.iter().map(|&share| u32::from(share <= target)).sum::<u32>() as usize;
        let index = before.min(SIDE * SIDE - 1);
        let texel = self.first_texel(tile.column as usize, tile.row as usize)
            + DVec2::new((index % SIDE) as f64, (index / SIDE) as f64);
        let low = if index == 0 { 0.0 } else { f64::from(shares[index - 1]) };
        let remainder = ((u - low) / (f64::from(shares[index]) - low)).clamp(0.0, 1.0);
        let inside = texel + DVec2::new(remainder, f64::from(v));
        let point = if tile.whole {
            inside
        } else {
            let texel = rectangle(texel, 1.0);
            match texel.overlap(&self.triangle) {
                Overlap::Whole => inside,
                _ => Polygon::clipped(&self.triangle, &texel).sample((remainder, v))?,
            }
        };
        Some(self.barycentric(point))
    }

    fn first_texel(&self, column: usize, row: usize) -> DVec2 {
        let texel = |start: i64, tile: usize| (start + (tile * SIDE) as i64) as f64;
        DVec2::new(texel(self.start[0], column), texel(self.start[1], row))
    }

    fn barycentric(&self, texel: DVec2) -> Vec2 {
        let b = (self.to_barycentric * (texel - self.triangle[0])).max(DVec2::ZERO);
        (b / b.element_sum().max(1.0)).as_vec2()
    }

    /// Returns the mean emission of the texels in the bounding box of the triangle's texture coordinates, in cd/m²,
    /// averaged over the channels. The mean is positive if any part of the triangle emits.
    pub fn mean_around(emitter: &Emitter, texture: &Texture) -> f64 {
        let [a, b, c] = emitter.texels(texture);
        let (low, high) = (a.min(b).min(c).floor(), a.max(b).max(c).floor());
        let (width, height) = (texture.image.width, texture.image.height);
        let span = high - low + 1.0;
        // Average the whole texture if the triangle spans more texels than the texture has, or lies too far from the
        // origin of texture coordinates.
        let fits = span.x <= width as f64 && span.y <= height as f64 && low.abs().max_element() < MAX_TEXEL_COORDINATE;
        let (low, columns, rows) =
            if fits { (low, span.x as usize, span.y as usize) } else { (DVec2::ZERO, width, height) };
        let mut sum = 0.0;
        for y in 0..rows {
            for x in 0..columns {
                let texel = low + DVec2::new(x as f64, y as f64);
                sum += f64::from(emitter.emission_of_texel(texture.continued(texel.as_vec2())));
            }
        }
        sum / (columns * rows) as f64
    }
}

fn rectangle(low: DVec2, side: f64) -> Rectangle {
    Rectangle { low, high: low + side }
}
