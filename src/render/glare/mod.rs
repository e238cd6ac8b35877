//! Unified glare rating (UGR) that a scene's luminaires and emissive surfaces cause for observers (CIE 117:1995):
//! `UGR = 8 log10(0.25 / Lb · Σ L² ω / p²)`, with background luminance Lb, and luminance L, solid angle ω and position
//! index p of each source.
//!
//! As in CIE 117, the luminance of a luminaire towards the eye is its intensity divided by the projected area of its
//! luminous opening, and its solid angle is this projected area divided by the squared distance. Hidden parts of an
//! opening do not count; rays from the eye to a grid of points on the opening find the visible parts. An opening that
//! is seen edge-on has no projected area and causes no glare. The background luminance is
//! `E / π`, where E is the indirect illuminance at the eye on a plane perpendicular to the line of sight.
//!
//! Each connected luminous part of an emissive mesh is a source, too. Rays from the eye find the mean luminance and the
//! solid angle of its visible part (`surfaces`).
//!
//! Not modelled: the environment and lights without area as glare sources; the glow around lamps in an emission
//! texture, where the texture is darker than a tenth of its largest luminance. The rating leaves this light out, but
//! reports its direct illuminance at the eye.

mod surfaces;

use super::bsdf::{Lobes, ScatterKind};
use super::contribution::LightSource;
use super::facet::NONE;
use super::path::{self, Observer, Strategy};
use super::sampler::Sampler;
use super::vertex::Vertex;
use super::world::World;
use crate::accel::Ray;
use crate::error::{Error, Result, check_range};
use crate::exec;
use crate::image::colour;
use crate::job::Job;
use crate::maths;
use crate::photometry::glare::position_index;
use crate::photometry::opening::Opening;
use crate::rng;
use crate::scene::{PunctualLight, c90};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;
use surfaces::{EmissiveSurfaces, LuminousPart, View};

/// The position of an observer's eye and the direction in which it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    pub position: Vec3,
    /// Line of sight, of any length except 0; it must not be vertical.
    pub direction: Vec3,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Params {
    /// Paths per observer that estimate the background luminance, in `[16, 1 << 24]`; rounded up to a multiple of 16.
    pub samples: u32,
    pub seed: u64,
}

impl Default for Params {
    fn default() -> Self {
        Self { samples: 4096, seed: 1 }
    }
}

/// The glare that an observer experiences.
#[derive(Clone, Debug, PartialEq)]
pub struct Rating {
    /// The rating; `-∞` if no glare source is in view, `∞` if one is in view but the background is black.
    pub ugr: f64,
    /// Background luminance in cd/m², and its standard error.
    pub background: f64,
    pub background_error: f64,
    /// Direct illuminance at the eye, in lux, from the light that the rating ignores: from the environment, from lights
    /// without a luminous opening, and from the glow of emissive surfaces.
    pub unrated_lux: f64,
    pub sources: Vec<GlareSource>,
}

/// A luminaire, or a connected luminous part of a mesh, that an observer sees, and that causes glare.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlareSource {
    pub origin: Origin,
    /// Luminance of the source's visible part in cd/m², times the root mean square transmittance of the panes in front
    /// of it.
    pub luminance: f64,
    /// Solid angle of the source's visible part in steradians.
    pub solid_angle: f64,
    pub position_index: f64,
}

/// The object of the scene that a glare source belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Origin {
    /// A luminaire, by its index among the lights of the scene.
    Light(usize),
    /// A mesh, by its index.
    Mesh(usize),
}

impl Rating {
    /// Returns the number of sources whose solid angle lies outside the range for which CIE 117 is valid.
    pub fn outside_range(&self) -> usize {
        let is_valid = |s: &&GlareSource| (MIN_SOLID_ANGLE..=MAX_SOLID_ANGLE).contains(&s.solid_angle);
        self.sources.len() - self.sources.iter().filter(is_valid).count()
    }
}

/// Smallest and largest solid angle, in steradians, for which CIE 117 is valid. [convention]
const MIN_SOLID_ANGLE: f64 = 3e-4;
const MAX_SOLID_ANGLE: f64 = 0.1;
/// Smallest length of the horizontal component of the unit line of sight. Steeper lines of sight are refused, because
/// the position index needs to know which way is up in the field of view. [convention]
const MIN_HORIZONTAL: f64 = 0.02;
/// An opening counts as seen edge-on if its projected area towards the eye is at most this multiple of its largest
/// projected area along one of its own axes. [rounding]
const EDGE_ON: f64 = 1e-6;
/// Visibility rays go to a grid of `RAYS` × `RAYS` points on each face of a luminous opening.
const RAYS: usize = 16;
/// Visibility rays end at this share of the distance to the face, so that they do not hit a ceiling that lies in the
/// plane of the face. [rounding]
const NEARLY: f64 = 0.999;
/// Number of independent estimates of the background luminance; their variance gives its standard error.
const BATCHES: u32 = 16;

/// Rates the glare for each observer. Call it on the library's own thread pool.
///
/// # Errors
/// Parameters out of range; an observer that is not finite, looks straight up or down, or is inside a luminaire;
/// cancelled.
pub fn rate(world: &World, eyes: &[Eye], params: &Params, job: Job) -> Result<Vec<Rating>> {
    check_range("samples", params.samples, BATCHES, 1 << 24)?;
    let lamps = lamps(world);
    let surfaces = EmissiveSurfaces::new(world, job.part(0.0, 0.0))?;
    for (i, eye) in eyes.iter().enumerate() {
        check(eye, &lamps).map_err(|e| e.context(format_args!("observer {i}")))?;
    }
    let rated = Rated { lamps: &lamps, surfaces: &surfaces };
    let ratings = exec::map(eyes.len(), job, |i| rate_one(world, &eyes[i], &rated, params, i as u64, job))?;
    job.check()?;
    ratings.into_iter().collect()
}

fn check(eye: &Eye, lamps: &[Lamp]) -> Result<()> {
    let direction = eye.direction.as_dvec3().normalize_or_zero();
    if !eye.position.is_finite() || maths::hypot(direction.x, direction.z) < MIN_HORIZONTAL {
        return Err(Error::argument(format!(
            "position is {} and direction {}; both must be finite, and the direction neither 0 nor vertical",
            eye.position, eye.direction
        )));
    }
    match lamps.iter().find(|lamp| lamp.opening.contains(lamp.local(eye.position.as_dvec3() - lamp.position))) {
        None => Ok(()),
        Some(lamp) => Err(Error::argument(format!(
            "position is {}; it lies in the luminous opening of light {}, and must be outside",
            eye.position, lamp.light
        ))),
    }
}

/// A luminaire that the rating takes into account, because it has a luminous opening.
struct Lamp {
    light: usize,
    position: DVec3,
    /// Unit directions in the scene: of C = 0°, of C = 90° and of the luminaire's axis (γ = 0°).
    frame: [DVec3; 3],
    opening: Opening,
    distribution: usize,
    /// Luminance of the light's RGB colour (without unit), by which the intensity distribution is multiplied.
    factor: f64,
}

/// A luminaire as seen from an eye, without occlusion.
struct ApparentLamp {
    towards: DVec3,
    distance: f64,
    area: f64,
    candela: f64,
}

impl Lamp {
    fn local(&self, v: DVec3) -> DVec3 {
        DVec3::from_array(self.frame.map(|axis| axis.dot(v)))
    }

    fn in_scene(&self, p: DVec3) -> DVec3 {
        self.position + self.frame[0] * p.x + self.frame[1] * p.y + self.frame[2] * p.z
    }

    /// Returns direction, distance, projected area (m²) and intensity (cd) of the luminaire as seen from `eye`; `None`
    /// if the eye sees the opening edge-on.
    fn seen_from(&self, world: &World, eye: DVec3) -> Option<ApparentLamp> {
        let (towards, distance) = (self.position - eye).normalize_and_length();
        let u = self.local(-towards);
        let area = self.opening.projected_area(u);
        let largest = DVec3::AXES.map(|axis| self.opening.projected_area(axis)).into_iter().fold(0.0, f64::max);
        let (c, gamma) = (maths::atan2(u.y, u.x).to_degrees(), maths::atan2(maths::hypot(u.x, u.y), u.z).to_degrees());
        let candela = world.scene().distributions[self.distribution].intensity(c, gamma) * self.factor;
        (area > largest * EDGE_ON).then_some(ApparentLamp { towards, distance, area, candela })
    }

    /// Returns the visible share of the opening's projected area, and the mean, over the visible part, of the squared
    /// transmittance of the panes in front of it; both are 0 if the opening is hidden. The transmittance is squared
    /// because the rating sums L² ω.
    fn visibility(&self, world: &World, eye: DVec3, towards: DVec3) -> (f64, f64) {
        let u = self.local(-towards);
        let (mut visible, mut squares, mut total) = (0.0, 0.0, 0.0);
        // Ignore the luminaire's own faces: they do not hide the opening.
        let own = world.faces_of(self.light);
        for face in self.opening.faces(u) {
            let weight = face.projected_area(u);
            for i in 0..RAYS * RAYS {
                let uv = [i % RAYS, i / RAYS].map(|k| (k as f64 + 0.5) / RAYS as f64);
                let path = (self.in_scene(face.point(uv)) - eye) * NEARLY;
                let ray = Ray { t_max: 1.0, ..world.ray(eye.as_vec3(), path.as_vec3()) };
                let light = world.transmittance_without(&ray, |triangle| own.contains(&triangle), None);
                let share = f64::from(colour::luminance(light));
                total += weight;
                visible += if share > 0.0 { weight } else { 0.0 };
                squares += weight * share * share;
            }
        }
        if visible > 0.0 { (visible / total, squares / visible) } else { (0.0, 0.0) }
    }
}

/// Returns the luminaires that emit light and have a luminous opening.
fn lamps(world: &World) -> Vec<Lamp> {
    let scene = world.scene();
    let lamp = |(light, kind): (usize, &PunctualLight)| {
        let PunctualLight::Luminaire { position, axis, c0, colour, distribution, .. } = *kind else { return None };
        let opening = scene.distributions[distribution].opening()?;
        let factor = f64::from(colour::luminance(colour));
        let frame = [c0, c90(axis, c0), axis].map(|v| v.as_dvec3());
        let lamp = Lamp { light, position: position.as_dvec3(), frame, opening, distribution, factor };
        (factor > 0.0).then_some(lamp)
    };
    scene.lights.iter().enumerate().filter_map(lamp).collect()
}

/// The lights that the rating takes into account.
struct Rated<'a> {
    /// The luminaires with a luminous opening, in the order of the lights of the scene.
    lamps: &'a [Lamp],
    surfaces: &'a EmissiveSurfaces,
}

impl Rated<'_> {
    /// Whether the rating takes light of an origin into account; `emission` is its luminance per channel. A luminaire
    /// that is seen edge-on causes no glare, but counts as rated.
    fn contains(&self, world: &World, source: LightSource, emission: Vec3) -> bool {
        match source {
            LightSource::Punctual(i) => self.lamps.binary_search_by_key(&(i as usize), |lamp| lamp.light).is_ok(),
            LightSource::Surface { mesh, .. } => self.surfaces.is_luminous(world, mesh, colour::luminance(emission)),
            LightSource::Environment => false,
        }
    }
}

fn rate_one(world: &World, eye: &Eye, rated: &Rated, params: &Params, index: u64, job: Job) -> Result<Rating> {
    let position = eye.position.as_dvec3();
    let ahead = eye.direction.as_dvec3().normalize();
    let right = ahead.cross(DVec3::Y).normalize();
    let up = right.cross(ahead);
    let index_of = |towards: DVec3| position_index(DVec3::from_array([right, up, -ahead].map(|v| towards.dot(v))));
    let mut sources = Vec::new();
    for lamp in rated.lamps {
        let Some(seen) = lamp.seen_from(world, position) else { continue };
        // A luminaire behind the observer causes no glare.
        if seen.candela <= 0.0 || seen.towards.dot(ahead) <= 0.0 {
            continue;
        }
        let (visible, squared_share) = lamp.visibility(world, position, seen.towards);
        if visible > 0.0 {
            sources.push(GlareSource {
                origin: Origin::Light(lamp.light),
                luminance: seen.candela / seen.area * squared_share.sqrt(),
                solid_angle: seen.area / maths::powi(seen.distance, 2) * visible,
                position_index: index_of(seen.towards),
            });
        }
    }
    let view = View { world, eye: eye.position, frame: [right, up, ahead] };
    for part in rated.surfaces.seen_from(&view, rng::hash(params.seed, &[index]), job)? {
        let LuminousPart { mesh, luminance, solid_angle, towards } = part;
        sources.push(GlareSource {
            origin: Origin::Mesh(mesh),
            luminance,
            solid_angle,
            position_index: index_of(towards),
        });
    }
    let (background, background_error, unrated_lux) = background(world, eye, rated, params, index, job);
    let sum: f64 =
        sources.iter().map(|s| maths::powi(s.luminance, 2) * s.solid_angle / maths::powi(s.position_index, 2)).sum();
    let ugr = if sources.is_empty() { f64::NEG_INFINITY } else { 8.0 * maths::log10(0.25 / background * sum) };
    Ok(Rating { ugr, background, background_error, unrated_lux, sources })
}

/// Returns the background luminance, its standard error, and the direct illuminance from lights that the rating
/// ignores.
fn background(world: &World, eye: &Eye, rated: &Rated, params: &Params, index: u64, job: Job) -> (f64, f64, f64) {
    let vertex = Vertex::free(world, world.from_scene(eye.position), eye.direction.normalize());
    let per_batch = params.samples.div_ceil(BATCHES);
    let (mut means, mut unrated) = ([0.0; BATCHES as usize], DVec3::ZERO);
    for (batch, mean) in means.iter_mut().enumerate() {
        let seed = rng::hash(params.seed, &[index, batch as u64]);
        let mut indirect = DVec3::ZERO;
        for sample in 0..per_batch {
            if job.is_cancelled() {
                return (0.0, 0.0, 0.0);
            }
            let mut observer =
                GlareObserver { world, rated, scattered: false, indirect: DVec3::ZERO, unrated: DVec3::ZERO };
            path::gather(world, &vertex, true, &mut Sampler::new(seed, sample), &mut observer);
            indirect += observer.indirect;
            unrated += observer.unrated;
        }
        *mean = luminance(indirect) / f64::from(per_batch) / PI;
    }
    let n = f64::from(BATCHES);
    let mean = means.iter().sum::<f64>() / n;
    let variance = means.iter().map(|m| maths::powi(m - mean, 2)).sum::<f64>() / (n * (n - 1.0));
    (mean, variance.sqrt(), luminance(unrated) / f64::from(per_batch * BATCHES))
}

fn luminance(light: DVec3) -> f64 {
    f64::from(colour::luminance(light.as_vec3()))
}

/// Adds up the light that paths carry to an eye, in two sums: indirect light (`indirect`), and direct light from lights
/// that the rating ignores (`unrated`). Direct light from rated luminaires and surfaces belongs to neither sum.
struct GlareObserver<'a> {
    world: &'a World,
    rated: &'a Rated<'a>,
    /// Whether the path has scattered so far at a surface other than a clear pane.
    scattered: bool,
    indirect: DVec3,
    unrated: DVec3,
}

impl Observer for GlareObserver<'_> {
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, strategy: Strategy) {
        let light = (importance * emission).as_dvec3();
        // At each vertex, the light sample comes before the call of `scatter` for that vertex. A light sample at a
        // mesh is therefore indirect light even if `scattered` is still false. The eye itself belongs to no mesh.
        let is_at_mesh = matches!(strategy, Strategy::LightSample { mesh, .. } if mesh != NONE);
        match source {
            _ if self.scattered || is_at_mesh => self.indirect += light,
            _ if self.rated.contains(self.world, source, emission) => {}
            _ => self.unrated += light,
        }
    }

    fn scatter(&mut self, mesh: u32, kind: ScatterKind, _: Lobes) {
        self.scattered |= mesh != NONE && !matches!(kind, ScatterKind::Pane);
    }
}
