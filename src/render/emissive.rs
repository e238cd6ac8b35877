//! Light from emissive triangles, their textures sampled in proportion to what they emit.
//!
//! The texture space of each emissive triangle is cut into cells, blocks of texels; a cell is chosen by its area times
//! the mean emission of its block, and a point uniformly in the part of it that the triangle covers. So thousands of
//! small lamps in one texture cost what one lamp costs. Emissive textures are looked up without interpolation, so that a
//! cell of weight 0 emits nothing at all and sampling misses no light. Triangles whose texture coordinates span no area
//! (or too many texels to enumerate) are sampled uniformly.

use super::distribution::Distribution;
use super::facet::Facet;
use crate::error::Result;
use crate::image::try_vec;
use crate::scene::{Scene, Texture, Wrap};
use glam::{DVec2, Vec2, Vec3};

/// The most cells in all; blocks of texels double in size until there are no more.
const MAX_CELLS: usize = 1 << 17;
/// Beyond this many texels a triangle is sampled uniformly.
const MAX_TEXELS: f64 = (1 << 22) as f64;

/// A triangle that emits.
pub struct Emitter {
    pub mesh: u32,
    /// Index within its mesh, and among all triangles of the scene.
    pub triangle: u32,
    pub id: u32,
    pub corners: [Vec3; 3],
    /// Of the front face, unit.
    pub normal: Vec3,
    pub area: f32,
    pub double_sided: bool,
    factor: Vec3,
    texture: Option<usize>,
    /// Texture coordinates of the corners, transformed as the material says.
    uv: [Vec2; 3],
    cells: Cells,
}

/// The cells of a triangle: `columns * rows` entries from `first`.
struct Cells {
    first: usize,
    columns: usize,
    rows: usize,
    /// How texels map to columns and rows, and the first of each; none where the whole triangle is one cell.
    grid: Option<([Axis; 2], [i64; 2])>,
}

pub struct Emitters {
    pub emitters: Vec<Emitter>,
    cells: Distribution,
    /// Probability per m² of a point in each cell.
    density: Vec<f32>,
    /// Flux of all cells in lumens, one-sided.
    pub power: f64,
}

/// A point chosen on an emitter.
pub struct EmitterPoint {
    pub emitter: usize,
    pub barycentric: Vec2,
    /// Probability per m².
    pub density: f32,
}

impl Emitter {
    /// What a point emits in cd/m² per channel, and the texture coordinates it was looked up with.
    pub fn emission(&self, scene: &Scene, barycentric: Vec2) -> (Vec3, Vec2) {
        let uv = self.uv_at(barycentric);
        match self.texture {
            None => (self.factor, uv),
            Some(texture) => (self.factor * scene.textures[texture].nearest(uv).truncate().max(Vec3::ZERO), uv),
        }
    }

    fn uv_at(&self, b: Vec2) -> Vec2 {
        self.uv[0] * (1.0 - b.x - b.y) + self.uv[1] * b.x + self.uv[2] * b.y
    }

    pub fn point(&self, b: Vec2) -> Vec3 {
        self.corners[0] * (1.0 - b.x - b.y) + self.corners[1] * b.x + self.corners[2] * b.y
    }

    /// Whether the side seen along `direction` (towards the emitter) emits.
    pub fn faces(&self, direction: Vec3) -> bool {
        self.double_sided || self.normal.dot(direction) < 0.0
    }

    /// Corners in texels.
    fn texels(&self, texture: &Texture) -> [DVec2; 3] {
        let size = DVec2::new(texture.image.width as f64, texture.image.height as f64);
        self.uv.map(|uv| uv.as_dvec2() * size)
    }
}

impl Emitters {
    /// `facets` are the triangles of a scene whose indices have been checked, `first` the number of each mesh's first.
    pub fn build(scene: &Scene, facets: &[Facet], first: &[u32]) -> Result<Self> {
        let numbered = facets.iter().zip(0..);
        let mut emitters: Vec<Emitter> = numbered.filter_map(|(f, id)| emitter(scene, f, id, first)).collect();
        let block = lay_out_cells(scene, &mut emitters);
        let count = emitters.last().map_or(0, |e| e.cells.first + e.cells.columns * e.cells.rows);
        let means = block_means(scene, &emitters, block)?;
        // Weight of each cell: its area times its mean emission. Its area is kept to turn weights into densities.
        let mut weights = try_vec(count, 0.0f64)?;
        let mut areas = try_vec(count, 0.0f32)?;
        for emitter in &emitters {
            emitter.weigh(scene, &means, &mut weights, &mut areas);
        }
        let power = std::f64::consts::PI * weights.iter().sum::<f64>();
        let cells = Distribution::new(weights.into_iter())?;
        let density = (0..count)
            .map(|i| if areas[i] > 0.0 { (cells.probability(i) / f64::from(areas[i])) as f32 } else { 0.0 })
            .collect();
        Ok(Self { emitters, cells, density, power })
    }

    /// A point by the emission of its cell; `u` chooses the cell, `v` the point.
    pub fn sample(&self, scene: &Scene, u: f64, v: Vec2) -> Option<EmitterPoint> {
        let (cell, rest) = self.cells.sample(u);
        let index = self.emitters.partition_point(|e| e.cells.first <= cell) - 1;
        let emitter = &self.emitters[index];
        let barycentric = match (&emitter.cells.grid, emitter.texture) {
            (Some((axes, start)), Some(texture)) => {
                let place = cell - emitter.cells.first;
                let column = start[0] + (place % emitter.cells.columns) as i64;
                let row = start[1] + (place / emitter.cells.columns) as i64;
                let corners = emitter.texels(&scene.textures[texture]);
                let polygon = Polygon::of_cell(&corners, axes[0].span(column), axes[1].span(row));
                barycentric_in(&corners, polygon.sample(rest, v)?)
            }
            _ => uniform_in_triangle(v),
        };
        Some(EmitterPoint { emitter: index, barycentric, density: self.density[cell] })
    }

    /// The density with which [`Emitters::sample`] chooses a point.
    pub fn density(&self, scene: &Scene, emitter: usize, barycentric: Vec2) -> f32 {
        let emitter = &self.emitters[emitter];
        let cells = &emitter.cells;
        let (Some((axes, start)), Some(texture)) = (&cells.grid, emitter.texture) else {
            return self.density[cells.first];
        };
        let image = &scene.textures[texture].image;
        let uv = emitter.uv_at(barycentric);
        let column = axes[0].column((uv.x * image.width as f32).floor()) - start[0];
        let row = axes[1].column((uv.y * image.height as f32).floor()) - start[1];
        // Rounding can put a point of the border one texel outside the triangle's cells.
        let column = column.clamp(0, cells.columns as i64 - 1) as usize;
        let row = row.clamp(0, cells.rows as i64 - 1) as usize;
        self.density[cells.first + row * cells.columns + column]
    }
}

impl Emitter {
    fn weigh(&self, scene: &Scene, means: &[Vec<Vec3>], weights: &mut [f64], areas: &mut [f32]) {
        let first = self.cells.first;
        let Some(texture) = self.texture else {
            areas[first] = self.area;
            weights[first] = f64::from(self.area * mean_channel(self.factor));
            return;
        };
        let means = &means[texture];
        let Some((axes, start)) = &self.cells.grid else {
            let mean = means.iter().map(|m| m.as_dvec3()).sum::<glam::DVec3>() / means.len().max(1) as f64;
            areas[first] = self.area;
            weights[first] = f64::from(self.area) * f64::from(mean_channel(self.factor * mean.as_vec3()));
            return;
        };
        let corners = self.texels(&scene.textures[texture]);
        let scale = f64::from(self.area) / ((corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs() / 2.0);
        let table_columns = axes[0].blocks() as usize;
        for row in 0..self.cells.rows {
            for column in 0..self.cells.columns {
                let (c, r) = (start[0] + column as i64, start[1] + row as i64);
                let mean = means[axes[1].table(r) as usize * table_columns + axes[0].table(c) as usize];
                let emission = mean_channel(self.factor * mean);
                if emission > 0.0 {
                    let area = Polygon::of_cell(&corners, axes[0].span(c), axes[1].span(r)).area() * scale;
                    // Slivers too thin to be sampled reliably still count with a sound density.
                    let i = first + row * self.cells.columns + column;
                    areas[i] = area as f32;
                    weights[i] = if areas[i] > 0.0 { area * f64::from(emission) } else { 0.0 };
                }
            }
        }
    }
}

/// Brightness by which light is shared out: no channel that emits is overlooked.
pub fn mean_channel(v: Vec3) -> f32 {
    v.element_sum() / 3.0
}

fn emitter(scene: &Scene, facet: &Facet, id: u32, first: &[u32]) -> Option<Emitter> {
    let (mesh, triangle) = (facet.mesh, id - first[facet.mesh as usize]);
    let m = &scene.meshes[mesh as usize];
    let material = &scene.materials[m.material];
    if material.emission.max_element() <= 0.0 {
        return None;
    }
    let corners = facet.corners();
    let doubled = (corners[1].as_dvec3() - corners[0].as_dvec3()).cross(corners[2].as_dvec3() - corners[0].as_dvec3());
    let area = (doubled.length() / 2.0) as f32;
    if !(area.is_finite() && area > 0.0) {
        return None;
    }
    let mut uv = [Vec2::ZERO; 3];
    if let Some(t) = &material.emission_texture
        && !m.uvs[t.uv_set].is_empty()
    {
        uv = m.triangles[triangle as usize].map(|i| t.transform.transform_point2(m.uvs[t.uv_set][i as usize]));
    }
    Some(Emitter {
        mesh,
        triangle,
        id,
        corners,
        normal: doubled.normalize().as_vec3(),
        area,
        double_sided: material.double_sided,
        factor: material.emission.max(Vec3::ZERO),
        texture: material.emission_texture.as_ref().map(|t| t.texture),
        uv,
        cells: Cells { first: 0, columns: 1, rows: 1, grid: None },
    })
}

/// Gives every emitter its cells and returns the side of a block in texels.
fn lay_out_cells(scene: &Scene, emitters: &mut [Emitter]) -> i64 {
    let mut block = 1;
    loop {
        let mut count = 0;
        for emitter in emitters.iter_mut() {
            emitter.cells = cells_of(scene, emitter, block);
            emitter.cells.first = count;
            count += emitter.cells.columns * emitter.cells.rows;
        }
        if count <= MAX_CELLS || block >= 1 << 16 {
            return block;
        }
        block *= 2;
    }
}

fn cells_of(scene: &Scene, emitter: &Emitter, block: i64) -> Cells {
    let whole = Cells { first: 0, columns: 1, rows: 1, grid: None };
    let Some(texture) = emitter.texture.map(|t| &scene.textures[t]) else { return whole };
    let corners = emitter.texels(texture);
    let low = corners[0].min(corners[1]).min(corners[2]);
    let high = corners[0].max(corners[1]).max(corners[2]);
    let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs() / 2.0;
    let span = high - low;
    let countable = (span.x + 2.0) * (span.y + 2.0) <= MAX_TEXELS.max(16.0 * texture_texels(texture));
    if !(countable && low.abs().max(high.abs()).max_element() < 8e6 && area > 1e-6 * span.x * span.y && area > 1e-12) {
        return whole;
    }
    let axes = [
        Axis { texels: texture.image.width as i64, block, wrap: texture.wrap[0] },
        Axis { texels: texture.image.height as i64, block, wrap: texture.wrap[1] },
    ];
    let start = [axes[0].column(low.x as f32), axes[1].column(low.y as f32)];
    let end = [axes[0].column(high.x as f32), axes[1].column(high.y as f32)];
    Cells {
        first: 0,
        columns: (end[0] - start[0] + 1) as usize,
        rows: (end[1] - start[1] + 1) as usize,
        grid: Some((axes, start)),
    }
}

fn texture_texels(texture: &Texture) -> f64 {
    texture.image.width as f64 * texture.image.height as f64
}

/// Mean colour of every block of the textures that emitters use.
fn block_means(scene: &Scene, emitters: &[Emitter], block: i64) -> Result<Vec<Vec<Vec3>>> {
    let mut means = vec![Vec::new(); scene.textures.len()];
    for index in emitters.iter().filter_map(|e| e.texture) {
        if !means[index].is_empty() {
            continue;
        }
        let image = &scene.textures[index].image;
        let (columns, rows) = (image.width.div_ceil(block as usize), image.height.div_ceil(block as usize));
        let mut sums = try_vec(columns * rows, (glam::DVec3::ZERO, 0u32))?;
        for y in 0..image.height {
            for x in 0..image.width {
                let entry = &mut sums[(y / block as usize) * columns + x / block as usize];
                entry.0 += image.rgb(x, y).max(Vec3::ZERO).as_dvec3();
                entry.1 += 1;
            }
        }
        means[index] = sums.into_iter().map(|(sum, n)| (sum / f64::from(n)).as_vec3()).collect();
    }
    Ok(means)
}

/// One axis of a texture cut into blocks. Columns count blocks through all repetitions of the texture.
#[derive(Clone, Copy)]
struct Axis {
    texels: i64,
    block: i64,
    wrap: Wrap,
}

impl Axis {
    fn blocks(&self) -> i64 {
        (self.texels + self.block - 1) / self.block
    }

    /// The column that holds a texel, found with the same rounding as the texture's own look-up.
    fn column(&self, texel: f32) -> i64 {
        let texel = texel.floor() as i64;
        if self.wrap == Wrap::Clamp {
            return texel.clamp(0, self.texels - 1) / self.block;
        }
        let (tile, local) = (texel.div_euclid(self.texels), texel.rem_euclid(self.texels));
        let in_tile = if self.is_mirrored(tile) {
            self.blocks() - 1 - (self.texels - 1 - local) / self.block
        } else {
            local / self.block
        };
        tile * self.blocks() + in_tile
    }

    /// Which block of the texture a column shows.
    fn table(&self, column: i64) -> i64 {
        let (tile, in_tile) = (column.div_euclid(self.blocks()), column.rem_euclid(self.blocks()));
        if self.is_mirrored(tile) { self.blocks() - 1 - in_tile } else { in_tile }
    }

    /// The texels from and to which a column runs.
    fn span(&self, column: i64) -> (f64, f64) {
        let tile = column.div_euclid(self.blocks());
        let block = self.table(column);
        let (mut low, mut high) = (block * self.block, ((block + 1) * self.block).min(self.texels));
        if self.is_mirrored(tile) {
            (low, high) = (self.texels - high, self.texels - low);
        }
        let (mut from, mut to) = ((low + tile * self.texels) as f64, (high + tile * self.texels) as f64);
        if self.wrap == Wrap::Clamp {
            // The outermost texels continue for ever.
            from = if block == 0 { -1e9 } else { from };
            to = if block == self.blocks() - 1 { 1e9 } else { to };
        }
        (from, to)
    }

    fn is_mirrored(&self, tile: i64) -> bool {
        self.wrap == Wrap::Mirror && tile.rem_euclid(2) == 1
    }
}

/// The part of a cell inside a triangle: at most seven corners.
struct Polygon {
    corners: [DVec2; 8],
    len: usize,
}

impl Polygon {
    fn of_cell(triangle: &[DVec2; 3], (left, right): (f64, f64), (top, bottom): (f64, f64)) -> Self {
        let mut polygon = Self { corners: [DVec2::ZERO; 8], len: 3 };
        polygon.corners[..3].copy_from_slice(triangle);
        polygon.clip(|p| p.x - left);
        polygon.clip(|p| right - p.x);
        polygon.clip(|p| p.y - top);
        polygon.clip(|p| bottom - p.y);
        polygon
    }

    /// Keeps the part where `inside` is not negative (Sutherland and Hodgman 1974).
    fn clip(&mut self, inside: impl Fn(DVec2) -> f64) {
        let from = self.corners;
        let mut len = 0;
        for i in 0..self.len {
            let (p, q) = (from[i], from[(i + 1) % self.len]);
            let (dp, dq) = (inside(p), inside(q));
            if dp >= 0.0 && len < 8 {
                self.corners[len] = p;
                len += 1;
            }
            if dp * dq < 0.0 && len < 8 {
                self.corners[len] = p + (q - p) * (dp / (dp - dq));
                len += 1;
            }
        }
        self.len = len;
    }

    /// Doubled areas of the triangles of a fan.
    fn fan(&self, i: usize) -> f64 {
        let [a, b, c] = [self.corners[0], self.corners[i], self.corners[i + 1]];
        (b - a).perp_dot(c - a).abs()
    }

    fn area(&self) -> f64 {
        (1..self.len.saturating_sub(1)).map(|i| self.fan(i)).sum::<f64>() / 2.0
    }

    /// A point uniform by area: `u` chooses the triangle of the fan, `v` the point in it.
    fn sample(&self, u: f64, v: Vec2) -> Option<DVec2> {
        let mut target = u * 2.0 * self.area();
        let last = self.len.checked_sub(2).filter(|&l| l > 0)?;
        let mut chosen = last;
        for i in 1..=last {
            let area = self.fan(i);
            if target < area {
                chosen = i;
                break;
            }
            target -= area;
        }
        let b = uniform_in_triangle(v).as_dvec2();
        let [p, q, r] = [self.corners[0], self.corners[chosen], self.corners[chosen + 1]];
        Some(p + (q - p) * b.x + (r - p) * b.y)
    }
}

/// Barycentric coordinates, uniform by area.
fn uniform_in_triangle(v: Vec2) -> Vec2 {
    let root = v.x.sqrt();
    Vec2::new(root * (1.0 - v.y), root * v.y)
}

fn barycentric_in(corners: &[DVec2; 3], p: DVec2) -> Vec2 {
    let (e, f, d) = (corners[1] - corners[0], corners[2] - corners[0], p - corners[0]);
    let determinant = e.perp_dot(f);
    let b = Vec2::new((d.perp_dot(f) / determinant) as f32, (e.perp_dot(d) / determinant) as f32);
    b.clamp(Vec2::ZERO, Vec2::ONE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::rng::Rng;
    use crate::scene::{Material, Mesh, TextureRef};

    /// A slanted triangle with a patchy texture, and one without any.
    fn scene(side: usize, uvs: [Vec2; 3], wrap: Wrap) -> Scene {
        let image = Image::from_fn(side, side / 2 + 1, |x, y| {
            let lit = if (x * 5 + y * 3) % 7 < 3 { (x + 2 * y + 1) as f32 } else { 0.0 };
            [lit, 0.5 * lit, 0.0]
        });
        let mut texture = Texture::new("patches", image.unwrap());
        texture.wrap = [wrap; 2];
        let mesh = |material, offset: Vec3| Mesh {
            material,
            positions: vec![offset, offset + Vec3::new(2.0, 0.3, 0.0), offset + Vec3::new(0.4, 1.0, 0.7)],
            uvs: [uvs.to_vec(), Vec::new()],
            triangles: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let plain = Material { emission: Vec3::new(0.0, 0.0, 3.0), ..Material::default() };
        let lit = Material { emission_texture: Some(TextureRef::new(0)), emission: Vec3::splat(2.0), ..plain.clone() };
        Scene {
            meshes: vec![mesh(0, Vec3::ZERO), mesh(1, Vec3::Z)],
            materials: vec![lit, plain],
            textures: vec![texture],
            ..Scene::default()
        }
    }

    fn emitters(scene: &Scene) -> Emitters {
        let facet = |mesh: u32| {
            let m = &scene.meshes[mesh as usize];
            Facet::new(m.corners(0), mesh, m, 0)
        };
        Emitters::build(scene, &[facet(0), facet(1)], &[0, 1, 2]).unwrap()
    }

    fn coordinates() -> Vec<[Vec2; 3]> {
        vec![
            [Vec2::ZERO, Vec2::X, Vec2::Y],
            [Vec2::new(-1.7, 0.2), Vec2::new(2.3, 1.9), Vec2::new(0.4, -2.2)],
            [Vec2::new(0.31, 0.4), Vec2::new(0.33, 0.41), Vec2::new(0.32, 0.45)],
        ]
    }

    #[test]
    fn points_are_as_dense_as_the_light_they_emit() {
        let mut rng = Rng::new(21, &[]);
        for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
            for uvs in coordinates() {
                let scene = scene(9, uvs, wrap);
                let emitters = emitters(&scene);
                let mut disagreed = 0;
                for _ in 0..5000 {
                    let v = Vec2::new(rng.next_f32(), rng.next_f32());
                    let point = emitters.sample(&scene, rng.next_f64(), v).unwrap();
                    let b = point.barycentric;
                    assert!(b.min_element() >= 0.0 && b.element_sum() < 1.0 + 1e-5);
                    // Emission over density is the flux over pi: with one texel to a cell sampling is perfect.
                    let emission = emitters.emitters[point.emitter].emission(&scene, b).0;
                    let estimate = f64::from(mean_channel(emission) / point.density) * std::f64::consts::PI;
                    let stated = emitters.density(&scene, point.emitter, b);
                    let agrees = (estimate / emitters.power - 1.0).abs() < 1e-3 && stated == point.density;
                    disagreed += usize::from(!agrees);
                }
                // Only points within rounding of a texel's border may be looked up as its neighbour.
                assert!(disagreed <= 5, "{disagreed} of 5000, {wrap:?}, {uvs:?}");
            }
        }
    }

    #[test]
    fn the_flux_is_the_integral_of_the_texture_and_large_textures_share_cells() {
        for (side, tolerance) in [(9, 0.01), (2200, 0.02)] {
            let scene = scene(side, [Vec2::ZERO, Vec2::X, Vec2::Y], Wrap::Clamp);
            let emitters = emitters(&scene);
            assert!(emitters.density.len() <= MAX_CELLS);
            let n = 200_000;
            let mut rng = Rng::new(22, &[]);
            let mut sum = 0.0;
            for emitter in &emitters.emitters {
                for _ in 0..n {
                    let b = uniform_in_triangle(Vec2::new(rng.next_f32(), rng.next_f32()));
                    sum += f64::from(mean_channel(emitter.emission(&scene, b).0) * emitter.area) / f64::from(n);
                }
            }
            let ratio = emitters.power / (sum * std::f64::consts::PI);
            assert!((ratio - 1.0).abs() < tolerance, "{ratio}");
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        let scene = scene(2200, coordinates()[1], Wrap::Repeat);
        let emitters = emitters(&scene);
        let n = 400_000;
        let mut rng = Rng::new(23, &[]);
        let mut sum = 0.0;
        for (index, emitter) in emitters.emitters.iter().enumerate() {
            for _ in 0..n {
                let b = uniform_in_triangle(Vec2::new(rng.next_f32(), rng.next_f32()));
                sum += f64::from(emitters.density(&scene, index, b) * emitter.area) / f64::from(n);
            }
        }
        assert!((sum - 1.0).abs() < 0.01, "{sum}");
    }
}
