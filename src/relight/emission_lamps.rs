//! The lamps of an emission: connected regions of its texture, connected pieces of its meshes, or punctual lights such
//! as luminaires.

use crate::error::{Error, Result};
use crate::image::regions::Regions;
use crate::image::{Image, try_vec};
use crate::scene::{PunctualLight, Scene};
use glam::{DVec2, DVec3, Vec2, Vec3};

/// The lamps of an emission, numbered from 0.
#[derive(Clone, Debug, PartialEq)]
pub struct EmissionLamps {
    count: usize,
    /// For each texel or triangle, the number of its lamp plus one; 0 outside the lamps.
    labels: Vec<u32>,
    division: Labelling,
    /// Centre of each lamp: texture coordinates (with z = 0) for regions of a texture, a position in metres otherwise.
    centres: Vec<Vec3>,
    /// Area of each lamp in texels or m²; for a punctual light, a number that identifies its kind.
    sizes: Vec<f32>,
}

/// Lamps are sorted by area; a new type begins where the area grows by more than this share from one lamp to the next.
/// [bench constants:types]
const TYPE_GAP: f32 = 0.25;

#[derive(Clone, Debug, PartialEq)]
enum Labelling {
    /// One label per texel. Texture coordinates outside the unit square repeat the texture.
    Texels { width: usize, height: usize },
    /// One label per triangle. For each mesh, `first` holds the index in `labels` of the mesh's first triangle.
    Triangles { first: Vec<usize> },
    /// The punctual lights of the scene; no labels.
    Lights,
}

impl EmissionLamps {
    /// Makes lamps from a label image: each texel holds the number of its lamp plus one, or 0 outside the lamps.
    ///
    /// # Errors
    /// `InvalidArgument` if the number of labels is not `width × height`, or no texel is labelled.
    pub fn of_labels(width: usize, height: usize, labels: Vec<u32>) -> Result<Self> {
        if width == 0 || height == 0 || labels.len() != width * height {
            return Err(Error::argument(format!(
                "there are {} labels for a texture of {width} x {height} texels",
                labels.len()
            )));
        }
        let count = labels.iter().copied().max().unwrap_or(0) as usize;
        if count > labels.len() {
            return Err(Error::argument(format!(
                "the labels go up to {count}, more than there are texels; number the lamps from 1 without gaps"
            )));
        }
        Self::numbered(width, height, labels, count)
    }

    /// Makes lamps from a texture: every 8-connected region of emissive texels is a lamp.
    pub fn of_texture(texture: &Image) -> Result<Self> {
        let Regions { labels, count } = Regions::of(texture)?;
        Self::numbered(texture.width, texture.height, labels, count)
    }

    /// Makes lamps from the labels of texels: 0 for texels without emission, and `1..=count` for the lamps.
    fn numbered(width: usize, height: usize, labels: Vec<u32>, count: usize) -> Result<Self> {
        let mut sums = try_vec(count, (DVec2::ZERO, 0.0f64))?;
        for (y, row) in labels.chunks_exact(width).enumerate() {
            for (x, &label) in row.iter().enumerate().filter(|(_, label)| **label > 0) {
                let (sum, texels) = &mut sums[label as usize - 1];
                *sum += DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                *texels += 1.0;
            }
        }
        let size = DVec2::new(width as f64, height as f64);
        let centres = sums.iter().map(|(sum, n)| (*sum / n.max(1.0) / size).as_vec2().extend(0.0)).collect();
        let sizes = sums.iter().map(|(_, n)| *n as f32).collect();
        Self { count, labels, division: Labelling::Texels { width, height }, centres, sizes }.checked()
    }

    /// Makes lamps from the emissive meshes: triangles that are connected by shared vertices form one lamp.
    pub fn of_meshes(scene: &Scene, emitter: usize) -> Result<Self> {
        let triangles = scene.meshes.iter().map(|m| m.triangles.len()).sum();
        let mut labels = try_vec(triangles, 0u32)?;
        let (mut first, mut next) = (Vec::with_capacity(scene.meshes.len()), 0);
        let (mut centres, mut sizes) = (Vec::new(), Vec::new());
        for mesh in &scene.meshes {
            first.push(next);
            if mesh.material == emitter {
                let mut pieces = Pieces::new(mesh.positions.len())?;
                mesh.triangles.iter().for_each(|t| pieces.join(t));
                // Number the pieces in the order of their first triangle.
                let mut number = try_vec(mesh.positions.len(), 0u32)?;
                let from = centres.len();
                let mut weights = Vec::new();
                for (i, t) in mesh.triangles.iter().enumerate() {
                    let root = pieces.root(t[0]) as usize;
                    if number[root] == 0 {
                        centres.push(Vec3::ZERO);
                        weights.push(0.0);
                        number[root] = centres.len() as u32;
                    }
                    labels[next + i] = number[root];
                    let lamp = number[root] as usize - 1;
                    let [a, b, c] = mesh.corners(i);
                    let area = (b - a).cross(c - a).length();
                    centres[lamp] += (a + b + c) / 3.0 * area;
                    weights[lamp - from] += area;
                }
                sizes.extend(weights.iter().map(|w| w / 2.0));
                centres[from..].iter_mut().zip(&weights).for_each(|(c, w)| *c /= f32::max(*w, f32::MIN_POSITIVE));
            }
            next += mesh.triangles.len();
        }
        Self { count: centres.len(), labels, division: Labelling::Triangles { first }, centres, sizes }.checked()
    }

    /// Makes each punctual light of the scene a lamp; surfaces do not count as lamps.
    pub fn of_lights(scene: &Scene) -> Result<Self> {
        let place = |light: &PunctualLight| match *light {
            PunctualLight::Point { position, .. }
            | PunctualLight::Spot { position, .. }
            | PunctualLight::Luminaire { position, .. } => position,
            PunctualLight::Directional { .. } => Vec3::ZERO,
        };
        let centres: Vec<Vec3> = scene.lights.iter().map(place).collect();
        let kind = |light: &PunctualLight| match *light {
            PunctualLight::Point { .. } => 0.0,
            PunctualLight::Spot { .. } => 1.0,
            PunctualLight::Directional { .. } => 2.0,
            PunctualLight::Luminaire { distribution, .. } => 3.0 + distribution as f32,
        };
        let sizes = scene.lights.iter().map(kind).collect();
        Self { count: centres.len(), labels: Vec::new(), division: Labelling::Lights, centres, sizes }.checked()
    }

    fn checked(self) -> Result<Self> {
        if self.count == 0 {
            return Err(Error::argument("the emission has no lamp: nothing of it emits, or nothing is labelled"));
        }
        Ok(self)
    }

    pub fn count(&self) -> usize {
        self.count
    }

    /// Centre of each lamp: texture coordinates for regions of a texture, metres for pieces of meshes and punctual
    /// lights, 0 for directional lights.
    pub fn centres(&self) -> &[Vec3] {
        &self.centres
    }

    /// Puts all lamps into a single group. Returns the group of each lamp and the number of groups.
    pub fn together(&self) -> (Vec<u32>, usize) {
        (vec![0; self.count], 1)
    }

    /// Puts each lamp into a group of its own. Returns the group of each lamp and the number of groups.
    pub fn each(&self) -> (Vec<u32>, usize) {
        ((0..self.count as u32).collect(), self.count)
    }

    /// Returns the texture with each lamp multiplied by its own scale; texels outside the lamps stay unchanged.
    ///
    /// # Errors
    /// `InvalidArgument` unless the lamps are regions of a texture of this size and there is a scale for each of them.
    pub fn scaled(&self, texture: &Image, scale: &[DVec3]) -> Result<Image> {
        let fits = match &self.division {
            Labelling::Texels { width, height } => (*width, *height) == (texture.width, texture.height),
            Labelling::Triangles { .. } | Labelling::Lights => false,
        };
        if !fits || scale.len() != self.count {
            return Err(Error::argument("the lamps are not those of this texture"));
        }
        let mut scaled = Image::new(texture.width, texture.height, 3)?;
        for (i, pixel) in scaled.data.chunks_exact_mut(3).enumerate() {
            let colour = match *texture.pixel(i % texture.width, i / texture.width) {
                [r, g, b, ..] => Vec3::new(r, g, b),
                [v, ..] => Vec3::splat(v),
                [] => Vec3::ZERO,
            };
            let scale = (self.labels[i] as usize).checked_sub(1).map_or(Vec3::ONE, |lamp| scale[lamp].as_vec3());
            (colour * scale).write_to_slice(pixel);
        }
        Ok(scaled)
    }

    /// Groups lamps in rows: successive centres along an axis that differ by at most `tolerance`, in the unit of the
    /// centres, belong to one row. Returns the group of each lamp and the number of groups, numbered along the axis.
    pub fn rows(&self, axis: usize, tolerance: f32) -> (Vec<u32>, usize) {
        self.chained(|i| self.centres[i][axis.min(2)], |a, b| b - a > tolerance)
    }

    /// Sorts the lamps by the value of `number` and groups them. A new group begins between two successive lamps if
    /// `leaps` returns true for their values.
    fn chained(&self, number: impl Fn(usize) -> f32, leaps: impl Fn(f32, f32) -> bool) -> (Vec<u32>, usize) {
        let mut order: Vec<usize> = (0..self.count).collect();
        order.sort_by(|&a, &b| number(a).total_cmp(&number(b)).then(a.cmp(&b)));
        let (mut groups, mut group) = (vec![0; self.count], 0);
        for pair in order.windows(2) {
            group += u32::from(leaps(number(pair[0]), number(pair[1])));
            groups[pair[1]] = group;
        }
        (groups, group as usize + 1)
    }

    /// Groups lamps by type: surfaces of about equal area, punctual lights of one kind, and luminaires of one
    /// distribution. The groups are numbered by increasing area or kind.
    pub fn types(&self) -> (Vec<u32>, usize) {
        let gap = if self.division == Labelling::Lights { 0.0 } else { TYPE_GAP };
        self.chained(|i| self.sizes[i], |a, b| b > a * (1.0 + gap))
    }

    /// Returns the lamp of a punctual light; `None` if the lamps are surfaces.
    #[inline]
    pub(super) fn find_light(&self, index: u32) -> Option<usize> {
        (self.division == Labelling::Lights).then_some(index as usize)
    }

    #[inline]
    pub(super) fn find(&self, mesh: u32, triangle: u32, uv: Vec2) -> Option<usize> {
        let label = match &self.division {
            Labelling::Texels { width, height } => {
                // Look up texels as the texture itself does (`scene::texture`).
                let at = |t: f32, n: usize| ((t * n as f32).floor() as i64).rem_euclid(n as i64) as usize;
                self.labels[at(uv.y, *height) * width + at(uv.x, *width)]
            }
            Labelling::Triangles { first } => self.labels[first[mesh as usize] + triangle as usize],
            Labelling::Lights => 0,
        };
        (label as usize).checked_sub(1)
    }
}

/// The connected pieces of a mesh: a union-find forest over its vertices (Tarjan 1975, with path halving).
struct Pieces(Vec<u32>);

impl Pieces {
    fn new(vertices: usize) -> Result<Self> {
        let mut parents = try_vec(vertices, 0)?;
        parents.iter_mut().zip(0..).for_each(|(p, i)| *p = i);
        Ok(Self(parents))
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            let up = self.0[self.0[i as usize] as usize];
            self.0[i as usize] = up;
            i = up;
        }
        i
    }

    fn join(&mut self, triangle: &[u32; 3]) {
        let roots = triangle.map(|v| self.root(v));
        let lowest = roots.into_iter().min().unwrap_or(0);
        roots.into_iter().for_each(|r| self.0[r as usize] = lowest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;

    #[test]
    fn patches_of_texels_and_pieces_of_meshes_are_lamps() {
        // The picture has two regions. One of them consists of two texels that touch only at a corner.
        let rows = ["#....", ".#..#", "....#"];
        let image = Image::from_fn(5, 3, |x, y| [f32::from(u8::from(rows[y].as_bytes()[x] == b'#'))]).unwrap();
        let lamps = EmissionLamps::of_texture(&image).unwrap();
        assert_eq!(lamps.count(), 2);
        let at = |x: f32, y: f32| lamps.find(0, 0, Vec2::new(x / 5.0, y / 3.0));
        assert_eq!([at(0.5, 0.5), at(1.5, 1.5), at(4.5, 2.5), at(2.5, 0.5)], [Some(0), Some(0), Some(1), None]);
        // The texture repeats.
        assert_eq!([at(-0.5, 1.5), at(5.5, 0.5)], [Some(1), Some(0)]);
        assert!((lamps.centres()[1] - Vec3::new(0.9, 2.0 / 3.0, 0.0)).length() < 1e-6);
        assert!(EmissionLamps::of_texture(&Image::new(3, 3, 3).unwrap()).is_err());
        // Lamps of equal area are of one type. Areas of four and five texels are also of one type, but areas of two
        // and three texels are not.
        assert_eq!(lamps.types(), (vec![0, 0], 1));
        let labels = vec![1, 1, 0, 2, 2, 2, 0, 3, 3];
        assert_eq!(EmissionLamps::of_labels(9, 1, labels).unwrap().types(), (vec![0, 1, 0], 2));
        let labels = vec![1, 1, 1, 1, 0, 2, 2, 2, 2, 2, 0, 3, 3, 3, 3];
        assert_eq!(EmissionLamps::of_labels(15, 1, labels).unwrap().types(), (vec![0; 3], 1));
        // Each lamp is multiplied by its own scale.
        let scaled = lamps.scaled(&image, &[DVec3::splat(2.0), DVec3::new(1.0, 0.0, 3.0)]).unwrap();
        assert_eq!(
            [scaled.rgb(0, 0), scaled.rgb(4, 2), scaled.rgb(2, 0)],
            [Vec3::splat(2.0), Vec3::new(1.0, 0.0, 3.0), Vec3::ZERO]
        );
        assert!(lamps.scaled(&image, &[DVec3::ONE]).is_err());

        let strip = |x: f32| [Vec3::X * x, Vec3::X * (x + 1.0), Vec3::new(x, 1.0, 0.0)];
        let positions: Vec<Vec3> = [0.0, 10.0, 20.0].into_iter().flat_map(strip).collect();
        // The first and the third triangle share a vertex.
        let triangles = vec![[0, 1, 2], [3, 4, 5], [6, 7, 0]];
        let scene = Scene { meshes: vec![Mesh { positions, triangles, ..Mesh::default() }], ..Scene::default() };
        let lamps = EmissionLamps::of_meshes(&scene, 0).unwrap();
        assert_eq!([0, 1, 2].map(|t| lamps.find(0, t, Vec2::ZERO)), [Some(0), Some(1), Some(0)]);
        assert_eq!(lamps.rows(0, 1.0).1, 2);
        // Punctual lights are grouped by kind, not by intensity.
        let point = |intensity: f32| PunctualLight::Point { position: Vec3::X, intensity: Vec3::splat(intensity) };
        let sun = PunctualLight::Directional { direction: Vec3::X, illuminance: Vec3::ONE, half_angle: 0.0 };
        let lights = Scene { lights: vec![sun, point(1.0), point(9.0)], ..Scene::default() };
        assert_eq!(EmissionLamps::of_lights(&lights).unwrap().types(), (vec![1, 0, 0], 2));
        assert!(EmissionLamps::of_lights(&scene).is_err());
        assert!(EmissionLamps::of_meshes(&scene, 1).is_err());
    }
}
