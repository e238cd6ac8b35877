//! A goniophotometer: the luminous intensity distribution of emissive bodies, far away from them, in C planes (CIE
//! 121).
//!
//! The intensity in a direction is the integral, over a plane perpendicular to the direction, of the luminance that the
//! bodies have towards it. Parallel rays estimate the integral. Each ray starts at a random point of the box around the
//! bodies, as seen from the direction, and path tracing estimates the luminance that the ray meets. The intensity
//! therefore includes light that the bodies reflect and transmit, and excludes light that they block. The rest of the
//! scene counts as absent.
//!
//! The luminous opening of the result is the box around the parts that emit, or a cylinder or an ellipsoid that fills
//! this box. The shape is chosen whose projected areas agree best with the luminous areas that the rays meet. The
//! opening affects only light near the body, glare and pictures.
//!
//! Not modelled: the opening of a body whose light leaves through a translucent shade or from a reflector (the result
//! has the opening of the parts that emit); punctual lights and luminaires of the scene; differences of colour between
//! directions; the errors of linear interpolation between the angles, which the stated errors leave out.

use super::bsdf::{Lobes, ScatterKind};
use super::contribution::LightSource;
use super::medium::Media;
use super::path::{self, MAX_BOUNCES, Observer, PathLength, Strategy};
use super::sampler::Sampler;
use super::world::World;
use crate::accel::Ray;
use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::{Image, check_memory, colour, try_collect, try_vec};
use crate::job::Job;
use crate::maths;
use crate::photometry::Luminaire;
use crate::photometry::opening::Opening;
use crate::rng;
use crate::scene::{Mesh, Scene, Texture, c90};
use glam::{DVec3, Vec3};
use std::sync::Arc;

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Number of C planes, in `[1, 360]`. They divide the circle evenly.
    pub planes: u32,
    /// Number of vertical angles γ, in `[2, 361]`. They divide `[0°, 180°]` evenly, both ends included.
    pub angles: u32,
    /// Paths per direction, in `[16, 1 << 24]`; rounded up to a multiple of 16.
    pub samples: u32,
    pub seed: u64,
    /// Direction of γ = 0°: a unit vector in scene coordinates.
    pub axis: Vec3,
    /// Direction of C = 0° at γ = 90°: a unit vector in scene coordinates, perpendicular to `axis`.
    pub c0: Vec3,
}

impl Default for Params {
    fn default() -> Self {
        Self { planes: 24, angles: 73, samples: 1024, seed: 1, axis: Vec3::NEG_Y, c0: Vec3::X }
    }
}

/// The distribution of the bodies, with standard errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    pub luminaire: Luminaire,
    /// Centre of the luminous opening, in the coordinates of the scene.
    pub position: Vec3,
    /// Standard error of the luminous flux, in lumens.
    pub flux_error: f64,
    /// Largest of the standard errors of all intensities, in candela.
    pub intensity_error: f64,
}

/// Number of independent estimates of each intensity; their variance gives the standard errors. With any number from 8
/// to 32 the mean has the same expected value. [convention]
const BATCHES: usize = 16;
/// The shape of the luminous opening is chosen from the directions in which the rays meet at least this share of the
/// largest luminous area. In other directions, a shade or the back of a flat lamp hides parts that emit. [convention]
const MIN_LUMINOUS_SHARE: f64 = 0.9;
/// Sides of the box around the emitting parts that are shorter than this share of its longest side count as 0.
/// [rounding]
const FLAT: f64 = 1e-5;

/// Measures the distribution of some meshes of a scene; of all its meshes if the list is empty. Call it on the
/// library's own thread pool.
///
/// # Errors
/// Parameters out of range; a mesh that does not exist; an invalid scene. `Degenerate` if no light leaves the meshes.
/// No memory; cancelled.
pub fn measure(scene: &Scene, meshes: &[u32], params: &Params, job: Job) -> Result<Output> {
    check_range("planes", params.planes, 1, 360)?;
    check_range("angles", params.angles, 2, 361)?;
    check_range("samples", params.samples, BATCHES as u32, 1 << 24)?;
    let bodies = bodies(scene, meshes)?;
    let name = bodies.meshes.iter().map(|mesh| mesh.name.clone()).find(|name| !name.is_empty()).unwrap_or_default();
    let goniometer = Goniometer::new(World::build(Arc::new(bodies), job.part(0.0, 0.05))?, params)?;
    let directions = directions(params);
    let measured = exec::map(directions.len(), job.part(0.05, 1.0), |i| {
        goniometer.intensity(local(directions[i]), rng::hash(params.seed, &[i as u64]), job)
    })?;
    job.check()?;
    goniometer.output(&name, &measured)
}

/// Returns the scene of some meshes alone, without lights and environment; of all meshes if the list is empty.
fn bodies(scene: &Scene, meshes: &[u32]) -> Result<Scene> {
    let count = scene.meshes.len();
    if let Some(mesh) = meshes.iter().find(|mesh| **mesh as usize >= count) {
        return Err(Error::argument(format!("mesh is {mesh}; the scene has {count} meshes")));
    }
    let mut chosen = try_vec(count, meshes.is_empty())?;
    meshes.iter().for_each(|mesh| chosen[*mesh as usize] = true);
    let kept = || scene.meshes.iter().zip(&chosen).filter(|(_, chosen)| **chosen).map(|(mesh, _)| mesh);
    // Replace each texture that the chosen meshes do not use by a single texel: the indices of all textures stay the
    // same.
    let mut used = try_vec(scene.textures.len(), false)?;
    for material in kept().filter_map(|mesh| scene.materials.get(mesh.material)) {
        for reference in material.textures() {
            used.get_mut(reference.texture).into_iter().for_each(|used| *used = true);
        }
    }
    let textures = || scene.textures.iter().zip(&used);
    let texels = textures().filter(|(_, used)| **used).map(|(texture, _)| size_of_val(&texture.image.data[..]));
    check_memory(kept().map(Mesh::bytes).chain(texels).sum())?;
    let black = Texture::new("", Image::new(1, 1, 3)?);
    Ok(Scene {
        meshes: kept().cloned().collect(),
        materials: scene.materials.clone(),
        textures: textures().map(|(texture, used)| if *used { texture } else { &black }.clone()).collect(),
        ..Scene::default()
    })
}

/// Returns the angles C and γ, in degrees, of all directions to measure: γ = 0, which all planes share; the angles in
/// between, plane by plane; and γ = 180.
fn directions(params: &Params) -> Vec<[f64; 2]> {
    let c = |plane: u32| 360.0 * f64::from(plane) / f64::from(params.planes);
    let gamma = |angle: u32| 180.0 * f64::from(angle) / f64::from(params.angles - 1);
    let between = (0..params.planes).flat_map(|p| (1..params.angles - 1).map(move |a| [c(p), gamma(a)]));
    std::iter::once([0.0, 0.0]).chain(between).chain([[0.0, 180.0]]).collect()
}

/// Returns the unit vector of a direction in the coordinates of the luminaire.
fn local([c, gamma]: [f64; 2]) -> DVec3 {
    let ((sin_c, cos_c), (sin_gamma, cos_gamma)) = (maths::sin_cos(c.to_radians()), maths::sin_cos(gamma.to_radians()));
    DVec3::new(sin_gamma * cos_c, sin_gamma * sin_c, cos_gamma)
}

/// A box in the coordinates of the luminaire: along C = 0, C = 90 and the axis, from the origin of the world.
#[derive(Clone, Copy)]
struct LuminaireBox {
    low: DVec3,
    high: DVec3,
}

impl LuminaireBox {
    fn of(points: impl Iterator<Item = DVec3>) -> Self {
        let none = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        points.fold(none, |e, p| Self { low: e.low.min(p), high: e.high.max(p) })
    }

    fn centre(&self) -> DVec3 {
        (self.low + self.high) / 2.0
    }

    fn size(&self) -> DVec3 {
        self.high - self.low
    }
}

/// The bodies to measure, with the boxes around them.
struct Goniometer<'a> {
    world: World,
    params: &'a Params,
    /// Unit directions in the scene: of C = 0°, of C = 90° and of the axis (γ = 0°).
    frame: [DVec3; 3],
    extent: LuminaireBox,
    opening: Opening,
    /// The box around the parts that emit.
    emitting: LuminaireBox,
}

/// The measurement in one direction.
struct Intensity {
    /// Independent estimates of the intensity in candela.
    batches: [f64; BATCHES],
    /// Projected area in m² of the visible parts that emit.
    luminous_area: f64,
}

impl<'a> Goniometer<'a> {
    fn new(world: World, params: &'a Params) -> Result<Self> {
        let frame = [params.c0, c90(params.axis, params.c0), params.axis].map(|v| v.as_dvec3());
        let in_frame = |p: Vec3| DVec3::from_array(frame.map(|axis| axis.dot(p.as_dvec3())));
        let meshes = &world.scene().meshes;
        let corners =
            meshes.iter().flat_map(|mesh| mesh.triangles.iter().flatten().map(|&i| mesh.positions[i as usize]));
        let extent = LuminaireBox::of(corners.map(|p| in_frame(world.from_scene(p))));
        // The box around the corners of the emitters has the axes of the luminaire, but includes dark texels. The boxes
        // around the emitters' pieces leave out dark texels, but have the axes of the world. Intersect both.
        let lights = world.lights();
        let of_corners = LuminaireBox::of(lights.emitters.emitters.iter().flat_map(|e| e.corners).map(in_frame));
        let of_pieces = LuminaireBox::of(lights.piece_corners().map(in_frame));
        let emitting =
            LuminaireBox { low: of_corners.low.max(of_pieces.low), high: of_corners.high.min(of_pieces.high) };
        match Opening::new(extent.size().to_array(), None) {
            Some(opening) if lights.pieces() > 0 => Ok(Self { world, params, frame, extent, opening, emitting }),
            _ => Err(Error::degenerate("none of the meshes emits light; choose the meshes of a lamp")),
        }
    }

    /// Converts a point or a direction from the coordinates of the luminaire to the world's.
    fn in_world(&self, p: DVec3) -> DVec3 {
        self.frame[0] * p.x + self.frame[1] * p.y + self.frame[2] * p.z
    }

    /// Measures the intensity in a direction, a unit vector in the coordinates of the luminaire.
    fn intensity(&self, direction: DVec3, seed: u64, job: Job) -> Intensity {
        let faces = self.opening.faces(direction);
        let areas: Vec<f64> = faces.iter().map(|face| face.projected_area(direction)).collect();
        let area: f64 = areas.iter().sum();
        let offset = direction * self.extent.size().length();
        let per_batch = self.params.samples.div_ceil(BATCHES as u32);
        let (mut batches, mut luminous) = ([0.0; BATCHES], 0u64);
        for (batch, estimate) in batches.iter_mut().enumerate().filter(|_| area > 0.0) {
            let seed = rng::hash(seed, &[batch as u64]);
            let mut observer = Meter::default();
            for index in 0..per_batch {
                if job.is_cancelled() {
                    break;
                }
                let mut sampler = Sampler::new(seed, index);
                let (place, light) = (sampler.next(), sampler.next());
                // Choose a face of the box by its projected area.
                let mut target = place.fine(2) * area;
                let face = areas.iter().position(|area| {
                    target -= area;
                    target < 0.0
                });
                let face = &faces[face.unwrap_or(faces.len() - 1)];
                let start = face.point([0, 1].map(|k| place.fine(k))) + self.extent.centre() + offset;
                let ray = Ray::new(self.in_world(start).as_vec3(), -self.in_world(direction).as_vec3());
                let length = PathLength { max_bounces: MAX_BOUNCES, roulette_weight: None };
                observer.scattered = false;
                let light_u = (light.fine(0), light.get(1));
                path::trace(&self.world, ray, Media::NONE, light_u, length, &mut sampler, &mut observer);
            }
            let mean = observer.light / f64::from(per_batch);
            *estimate = f64::from(colour::luminance(mean.as_vec3())).max(0.0) * area;
            luminous += observer.luminous;
        }
        let share = luminous as f64 / (f64::from(per_batch) * BATCHES as f64);
        Intensity { batches, luminous_area: share * area }
    }

    /// Assembles the distribution from the intensities measured in all [`directions`].
    fn output(&self, name: &str, measured: &[Intensity]) -> Result<Output> {
        let (planes, angles) = (self.params.planes as usize, self.params.angles as usize);
        let directions = directions(self.params);
        let index = |plane: usize, angle: usize| match angle {
            0 => 0,
            _ if angle == angles - 1 => measured.len() - 1,
            _ => plane * (angles - 2) + angle,
        };
        let form = Luminaire {
            gammas: (0..angles).map(|angle| directions[index(0, angle)][1]).collect(),
            planes: (0..planes).map(|plane| 360.0 * plane as f64 / planes as f64).collect(),
            ..Luminaire::lambertian(name, 0.0, self.size(&directions, measured))
        };
        let luminaire = |value: &dyn Fn(&Intensity) -> f64| -> Result<Luminaire> {
            let values = (0..planes * angles).map(|i| value(&measured[index(i / angles, i % angles)]));
            Ok(Luminaire { candela: try_collect(values)?, ..form.clone() })
        };
        let mut fluxes = [0.0; BATCHES];
        for (batch, flux) in fluxes.iter_mut().enumerate() {
            *flux = luminaire(&|intensity| intensity.batches[batch])?.flux();
        }
        let luminaire = luminaire(&|intensity| mean_and_error(&intensity.batches).0)?;
        if luminaire.candela.iter().all(|v| *v == 0.0) {
            return Err(Error::degenerate("no light leaves the meshes; choose the meshes of a lamp without its room"));
        }
        Ok(Output {
            luminaire,
            position: self.world.in_scene(self.in_world(self.emitting.centre()).as_vec3()),
            flux_error: mean_and_error(&fluxes).1,
            intensity_error: measured.iter().map(|i| mean_and_error(&i.batches).1).fold(0.0, f64::max),
        })
    }

    /// Returns the size of the luminous opening as in [`Luminaire::size`], where a minus sign stands for a round shape.
    /// Of the shapes that fill the box around the emitting parts, chooses the shape whose projected areas are nearest
    /// to the measured luminous areas.
    fn size(&self, directions: &[[f64; 2]], measured: &[Intensity]) -> [f64; 3] {
        let size = self.emitting.size();
        let least = size.max_element() * FLAT;
        let [x, y, z] = size.to_array().map(|side| if side > least { side } else { 0.0 });
        let mut shapes = vec![[x, y, z]];
        if x > 0.0 && y > 0.0 {
            shapes.push([-x, -y, z]);
            shapes.extend((z > 0.0).then_some([-x, -y, -z]));
        }
        let largest = measured.iter().map(|found| found.luminous_area).fold(0.0, f64::max);
        let misfit = |shape: &[f64; 3]| -> f64 {
            let Some(opening) = Opening::new(*shape, None) else { return f64::INFINITY };
            let seen = directions
                .iter()
                .zip(measured)
                .filter(|(_, found)| found.luminous_area >= MIN_LUMINOUS_SHARE * largest);
            seen.map(|(angles, found)| maths::powi(opening.projected_area(local(*angles)) - found.luminous_area, 2))
                .sum()
        };
        let best = shapes.iter().min_by(|a, b| misfit(a).total_cmp(&misfit(b)));
        best.copied().unwrap_or([x, y, z])
    }
}

/// Returns the mean of independent estimates, and its standard error.
fn mean_and_error(estimates: &[f64; BATCHES]) -> (f64, f64) {
    let n = BATCHES as f64;
    let mean = estimates.iter().sum::<f64>() / n;
    let variance = estimates.iter().map(|e| maths::powi(e - mean, 2)).sum::<f64>() / (n * (n - 1.0));
    (mean, variance.sqrt())
}

/// Adds up the light that rays carry, and counts the rays that meet a part that emits.
#[derive(Default)]
struct Meter {
    light: DVec3,
    luminous: u64,
    /// Whether the path has scattered so far at a surface other than a clear pane.
    scattered: bool,
}

impl Observer for Meter {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3, strategy: Strategy) {
        self.light += (importance * emission).as_dvec3();
        self.luminous += u64::from(!self.scattered && matches!(strategy, Strategy::BsdfSample));
    }

    fn scatter(&mut self, _: u32, kind: ScatterKind, _: Lobes) {
        self.scattered |= !matches!(kind, ScatterKind::Pane);
    }
}
