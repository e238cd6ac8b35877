//! Illuminance in lux on a calculation grid or over a surface, with the standard error of every point. Lighting
//! standards set requirements for illuminance (EN 12464-1: mean and uniformity on task areas, walls and ceilings).
//!
//! The points of a grid may lie in free space. A surface is sampled by its texture coordinates: each texel of the
//! result stands for the surface point at its centre.
//!
//! Not modelled: maintenance factors, cylindrical illuminance.

use super::contribution::{LightSource, PathSink};
use super::path::{self, Contributions};
use super::sampler::Sampler;
use super::vertex::Vertex;
use super::world::World;
use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::{Image, MAX_SIDE, colour, try_vec};
use crate::job::Job;
use crate::maths;
use crate::rng;
use glam::{DVec3, Vec2, Vec3};

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Number of points across (`columns`) and down (`rows`), each in `[1, 65536]`.
    pub columns: usize,
    pub rows: usize,
    /// Paths per point, in `[16, 1 << 24]`; rounded up to a multiple of 16.
    pub samples: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { columns: 32, rows: 32, samples: 1024, seed: 1 }
    }
}

/// The points at which to compute illuminance.
#[derive(Clone, Debug, PartialEq)]
pub enum CalculationPoints {
    /// A parallelogram, given by a corner and two edges, which is divided into `columns × rows` cells: columns along
    /// `across` and rows along `down`. The points are the centres of the cells. They receive light on the side of
    /// `normal`, which need not be perpendicular to the edges.
    Grid { origin: Vec3, across: Vec3, down: Vec3, normal: Vec3 },
    /// The surface of a mesh, mapped to the result by the mesh's first set of texture coordinates; `(0, 0)` is the
    /// outer corner of the first texel. If `front` is true, light counts on the side from which the triangles wind
    /// counter-clockwise, otherwise on the opposite side.
    Mesh { mesh: usize, front: bool },
}

/// The illuminance of each point, with statistics over all points.
#[derive(Clone, Debug)]
pub struct Output {
    /// Illuminance in lux; NaN for texels without a surface point.
    pub lux: Image,
    /// Standard error of each value in lux; NaN for texels without a surface point.
    pub error: Image,
    /// Number of points with a value.
    pub points: usize,
    /// Smallest, mean and largest illuminance in lux; all 0 if there are no points. Lighting
    /// standards define uniformity as `min / mean`.
    pub min: f64,
    pub mean: f64,
    pub max: f64,
    /// Standard error of the mean in lux, from the errors of the points, which are sampled independently of each other.
    pub mean_error: f64,
}

/// Number of independent estimates of each point; their variance gives the point's standard error, to within 1 / √30 =
/// 18 %. With any number from 8 to 32 the mean has the same expected value, and the error is known to within 27 to 13
/// %. [convention]
const BATCHES: u32 = 16;

/// To learn which lights reach its points, a calculation first traces `LEARNING_PATHS` paths from each of up to
/// `MAX_LEARNING_POINTS` of its points. [convention]
const MAX_LEARNING_POINTS: usize = 1024;
const LEARNING_PATHS: u32 = 4;
/// A calculation skips the learning if it traces fewer than this many times the paths that the learning would trace.
/// [convention]
const MIN_RATIO: usize = 50;
/// A calculation learns from paths whose seeds are derived from its own seed XOR `SALT`. These paths and the paths of
/// the calculation itself then use different random numbers.
const SALT: u64 = 0x6c65_6172_6e69_6e67;

/// Computes the illuminance at the points of `place`. Call it on the library's own thread pool.
///
/// # Errors
/// Parameters out of range; a grid with a zero normal; a mesh that does not exist or has no texture coordinates;
/// cancelled.
pub fn run(world: &World, place: &CalculationPoints, params: &Params, job: Job) -> Result<Output> {
    check_range("columns", params.columns, 1, MAX_SIDE)?;
    check_range("rows", params.rows, 1, MAX_SIDE)?;
    check_range("samples", params.samples, BATCHES, 1 << 24)?;
    let receivers = receivers(world, place, params)?;
    let learning = world.learning()?;
    let world = &learn(&learning, &receivers, params, job.part(0.0, 0.0))?;
    let per_batch = params.samples.div_ceil(BATCHES);
    let estimates = exec::map(params.columns * params.rows, job, |i| {
        let (vertex, front) = receivers.at(world, i)?;
        let mut luxes = [0.0; BATCHES as usize];
        for (batch, lux) in luxes.iter_mut().enumerate() {
            let mut sum = ContributionSum(DVec3::ZERO);
            let seed = rng::hash(params.seed, &[i as u64, batch as u64]);
            for index in 0..per_batch {
                if job.is_cancelled() {
                    return None;
                }
                path::gather(world, &vertex, front, &mut Sampler::new(seed, index), &mut Contributions(&mut sum));
            }
            *lux = f64::from(colour::luminance((sum.0 / f64::from(per_batch)).as_vec3()));
        }
        let n = f64::from(BATCHES);
        let mean = luxes.iter().sum::<f64>() / n;
        let variance = luxes.iter().map(|l| maths::powi(l - mean, 2)).sum::<f64>() / (n * (n - 1.0));
        Some((mean, variance))
    })?;
    job.check()?;
    summary(params, &estimates)
}

/// Learns from a few paths which lights reach the points. Skips the learning if the calculation itself traces fewer
/// than `MIN_RATIO` times as many paths as the learning would trace. Returns the world in which the calculation traces
/// its paths.
fn learn(learning: &World, receivers: &Receivers, params: &Params, job: Job) -> Result<World> {
    let points = params.columns * params.rows;
    let stride = points.div_ceil(MAX_LEARNING_POINTS);
    let count = points.div_ceil(stride);
    if count * LEARNING_PATHS as usize * MIN_RATIO <= points * params.samples as usize {
        exec::map(count, job, |i| {
            let Some((vertex, front)) = receivers.at(learning, i * stride) else { return };
            let seed = rng::hash(params.seed ^ SALT, &[i as u64]);
            let mut sum = ContributionSum(DVec3::ZERO);
            for index in 0..LEARNING_PATHS {
                path::gather(learning, &vertex, front, &mut Sampler::new(seed, index), &mut Contributions(&mut sum));
            }
        })?;
    }
    learning.settled()
}

fn summary(params: &Params, estimates: &[Option<(f64, f64)>]) -> Result<Output> {
    let mut lux = Image::new(params.columns, params.rows, 1)?;
    let mut error = Image::new(params.columns, params.rows, 1)?;
    let (mut points, mut sum, mut variances) = (0, 0.0, 0.0);
    let (mut min, mut max) = (f64::INFINITY, 0.0f64);
    for (i, estimate) in estimates.iter().enumerate() {
        let Some((mean, variance)) = *estimate else {
            (lux.data[i], error.data[i]) = (f32::NAN, f32::NAN);
            continue;
        };
        (lux.data[i], error.data[i]) = (mean as f32, variance.sqrt() as f32);
        points += 1;
        sum += mean;
        variances += variance;
        (min, max) = (min.min(mean), max.max(mean));
    }
    let n = f64::max(points as f64, 1.0);
    let min = if points == 0 { 0.0 } else { min };
    Ok(Output { lux, error, points, min, mean: sum / n, max, mean_error: variances.sqrt() / n })
}

/// The calculation points, in the form from which [`Receivers::at`] makes the vertices of paths.
enum Receivers {
    /// A grid in world coordinates. The origin of these coordinates suits the scene (`facet::centre`), so neighbouring
    /// points remain distinct in f32 even if the scene's own coordinates are large. `across` and `down` are the steps
    /// between neighbouring points.
    Grid {
        origin: Vec3,
        across: Vec3,
        down: Vec3,
        normal: Vec3,
        columns: usize,
    },
    Texels {
        mesh: u32,
        front: bool,
        texels: Vec<Option<(u32, Vec2)>>,
    },
}

impl Receivers {
    fn at(&self, world: &World, i: usize) -> Option<(Vertex, bool)> {
        match self {
            Self::Grid { origin, across, down, normal, columns } => {
                let (x, y) = ((i % columns) as f32 + 0.5, (i / columns) as f32 + 0.5);
                Some((Vertex::free(world, *origin + *across * x + *down * y, *normal), true))
            }
            Self::Texels { mesh, front, texels } => {
                let (triangle, barycentric) = texels[i]?;
                let vertex = Vertex::new(world, world.id(*mesh, triangle), barycentric);
                (vertex.normal != Vec3::ZERO).then_some((vertex, *front))
            }
        }
    }
}

fn receivers(world: &World, place: &CalculationPoints, params: &Params) -> Result<Receivers> {
    match place {
        CalculationPoints::Grid { origin, across, down, normal } => {
            let unit = normal.normalize_or_zero();
            let finite = [origin, across, down, normal].iter().all(|v| v.is_finite());
            if !finite || unit == Vec3::ZERO {
                return Err(Error::argument(format!(
                    "the grid's origin is {origin}, its edges are {across} and {down}, its normal is {normal}; all must \
                     be finite and the normal not 0"
                )));
            }
            let (columns, rows) = (params.columns, params.rows);
            let (across, down) = (*across / columns as f32, *down / rows as f32);
            Ok(Receivers::Grid { origin: world.from_scene(*origin), across, down, normal: unit, columns })
        }
        CalculationPoints::Mesh { mesh, front } => {
            let texels = texels(world, *mesh, params)?;
            Ok(Receivers::Texels { mesh: *mesh as u32, front: *front, texels })
        }
    }
}

/// Finds for each texel the triangle that covers the texel's centre, and the barycentric coordinates of the centre;
/// `None` if no triangle covers the centre. If several triangles do, the triangle with the smallest index is used.
fn texels(world: &World, mesh: usize, params: &Params) -> Result<Vec<Option<(u32, Vec2)>>> {
    let meshes = &world.scene().meshes;
    let found = meshes
        .get(mesh)
        .ok_or_else(|| Error::argument(format!("mesh is {mesh}; the scene has {} meshes", meshes.len())))?;
    let uvs = &found.uvs[0];
    if uvs.is_empty() {
        return Err(Error::argument(format!(
            "mesh {mesh} ({:?}) has no texture coordinates to map it by; use a grid",
            found.name
        )));
    }
    let size = Vec2::new(params.columns as f32, params.rows as f32);
    let mut texels = try_vec(params.columns * params.rows, None)?;
    for (triangle, corners) in found.triangles.iter().enumerate() {
        let [a, b, c] = corners.map(|i| uvs[i as usize] * size - 0.5);
        let (e, f) = (b - a, c - a);
        let area = e.perp_dot(f);
        // Find the texels whose centres lie in the triangle's bounding box.
        let low = a.min(b).min(c).ceil().max(Vec2::ZERO);
        let high = a.max(b).max(c).floor().min(size - 1.0);
        if !(area != 0.0 && area.is_finite() && low.cmple(high).all()) {
            continue;
        }
        for y in low.y as usize..=high.y as usize {
            for x in low.x as usize..=high.x as usize {
                let p = Vec2::new(x as f32, y as f32) - a;
                let at = Vec2::new(p.perp_dot(f), e.perp_dot(p)) / area;
                let texel = &mut texels[y * params.columns + x];
                if texel.is_none() && at.min_element() >= 0.0 && at.element_sum() <= 1.0 {
                    *texel = Some((triangle as u32, at));
                }
            }
        }
    }
    Ok(texels)
}

/// Adds up the contributions of paths.
struct ContributionSum(DVec3);

impl PathSink for ContributionSum {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.0 += (importance * emission).as_dvec3();
    }
}
