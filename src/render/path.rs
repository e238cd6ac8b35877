//! Path tracing from the eye, with next-event estimation and multiple importance sampling (MIS) at every vertex.
//!
//! Light that both a BSDF sample and a light sample can find is weighted by the power heuristic (Veach 1997, 9.2.4).
//! Clear panes are not vertices for MIS: they attenuate shadow rays without blocking them, and a path that passes a
//! pane keeps the pdf of the vertex before it. Contributions are not clamped, so the estimate is unbiased.
//!
//! The surface of a solid body refracts, so a shadow ray cannot pass it: the surface blocks light samples. Only BSDF
//! samples find light through it, with the weight 1. Light from points and from a single direction, which no BSDF
//! sample can find, therefore never passes a solid body.

use super::bounds::Receiver;
use super::bsdf::{Bsdf, BsdfSample, Lobes, ScatterKind};
use super::contribution::{LightSource, PathSink};
use super::environment;
use super::facet::NONE;
use super::immersion::media_at;
use super::light::{LightEnd, LightSample};
use super::medium::Media;
use super::sampler::Sampler;
use super::vertex::Vertex;
use super::world::{Pane, World};

use crate::accel::Ray;
use glam::{Vec2, Vec3};

/// First bounce at which Russian roulette may end a path. [convention]
const ROULETTE_START: u32 = 2;
/// A path survives with the largest probability, [`MAX_SURVIVAL`], if its expected contribution is at least about this
/// share of the pixel's estimate. In rooms, the measured product of time and variance is smallest near this value. With
/// a larger value, more paths end early and the variance grows; with a smaller one, the time grows. Roulette is
/// unbiased: any positive value gives the same expected image. [convention]
const CERTAIN_SHARE: f32 = 0.5;
/// Largest survival probability, so that a path between white walls ends eventually. For walls of albedo a, the
/// variance is infinite unless the survival probability is at least a². White standards of reflectance have a = 0.99
/// and need 0.98; the value here suffices up to a = 0.999. Any value from 0.996 to 0.999 serves. [convention]
const MAX_SURVIVAL: f32 = 0.998;

/// Largest number of bounces, as a guard against endless paths. With a survival probability of [`MAX_SURVIVAL`], one
/// path in ten million gets this far.
pub const MAX_BOUNCES: u32 = 8192;

/// Receives the events of a light path while it is traced. Many observers implement only [`Observer::add`]; the empty
/// defaults of the other methods cost nothing.
pub trait Observer {
    /// Receives a contribution with the arguments of [`PathSink::add`], and the sampling strategy that found the light.
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, strategy: Strategy);

    /// Receives the first surface that a camera path hits. `_seen` computes its attributes.
    fn primary_hit(&mut self, _seen: impl FnOnce() -> PrimaryHit) {}

    /// Receives a scattering event of the path: the mesh of the vertex, the kind of scattering, and the BSDF values of
    /// the sampled direction ([`Lobes`]).
    fn scatter(&mut self, _mesh: u32, _kind: ScatterKind, _lobes: Lobes) {}

    /// Returns a list to be filled with the panes between a vertex and its light sample; `None`, the default, if the
    /// observer does not need them.
    fn panes(&mut self) -> Option<&mut Vec<Pane>> {
        None
    }
}

/// Attributes of the first surface that a camera path hits.
#[derive(Clone, Copy)]
pub struct PrimaryHit {
    pub mesh: u32,
    pub position: Vec3,
    /// Shading normal (`normal`) and geometric normal, both facing the eye.
    pub normal: Vec3,
    pub geometric_normal: Vec3,
    /// Reflectance plus transmittance at normal incidence.
    pub colour: Vec3,
    pub distance: f32,
}

impl PrimaryHit {
    #[inline]
    pub(super) fn new(vertex: &Vertex, bsdf: &Bsdf, distance: f32) -> Self {
        Self {
            mesh: vertex.mesh,
            position: vertex.position,
            normal: bsdf.normal(),
            geometric_normal: bsdf.geometric_normal(),
            colour: bsdf.colour(),
            distance,
        }
    }
}

/// The sampling strategy that found a light.
#[derive(Clone, Copy)]
pub enum Strategy {
    /// A BSDF sample hit the light.
    BsdfSample,
    /// A light sample was drawn at a vertex of the mesh; `lobes` are the BSDF values times the cosine towards the
    /// light.
    LightSample { mesh: u32, lobes: Lobes },
}

/// An observer that passes contributions on to a sink and ignores all other events.
pub struct Contributions<'a, S>(pub &'a mut S);

impl<S: PathSink> Observer for Contributions<'_, S> {
    #[inline]
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, _: Strategy) {
        self.0.add(source, importance, emission);
    }
}

/// The next segment of a path, as it leaves a vertex or the eye.
pub(super) struct PathSegment {
    pub ray: Ray,
    /// Id of the triangle from which the ray starts, or `NONE`.
    pub from: u32,
    pub throughput: Vec3,
    /// For MIS: the point at which a light was last sampled, and the solid-angle pdf of the BSDF sample drawn there.
    /// `None` after the eye, a mirror or a refraction, where no light sample could find the same light.
    pub mis: Option<(Receiver, f32)>,
    /// The media that the segment runs through.
    pub media: Media,
    /// Uniform random numbers in `[0, 1)` that select the light sample at the next vertex.
    pub light_u: (f64, f32),
}

impl PathSegment {
    /// Returns the segment that leaves the eye, which is among `media`, along a ray of unit direction.
    pub fn from_eye(ray: Ray, media: Media, light_u: (f64, f32)) -> Self {
        Self { ray, from: NONE, throughput: Vec3::ONE, mis: None, media, light_u }
    }
}

/// Limits the length of paths.
#[derive(Clone, Copy)]
pub struct PathLength {
    /// Largest number of bounces of a path.
    pub max_bounces: u32,
    /// Factor for Russian roulette: the product of this factor and the throughput of a path is the path's expected
    /// contribution, as a share of the pixel's estimate. If the factor is `None` at the start of a path, it becomes the
    /// reciprocal of the throughput after the first bounce.
    pub roulette_weight: Option<Vec3>,
}

/// Estimates the radiance that arrives along a ray of unit direction, with one path. `media` are the media around the
/// ray's origin; `light_u` are uniform random numbers that select the first light sample.
pub fn trace<O: Observer>(
    world: &World,
    ray: Ray,
    media: Media,
    light_u: (f64, f32),
    length: PathLength,
    sampler: &mut Sampler,
    observer: &mut O,
) {
    walk(world, PathSegment::from_eye(ray, media, light_u), 0, length, sampler, observer);
}

/// Estimates the irradiance at a point, on its front or back side, with one path.
pub fn gather<O: Observer>(world: &World, vertex: &Vertex, front: bool, sampler: &mut Sampler, observer: &mut O) {
    let normal = if front { vertex.normal } else { -vertex.normal };
    let receiver = Bsdf::receiver(normal);
    let block = sampler.next();
    let light_u = (block.fine(0), block.get(1));
    let media = media_at(world, vertex.off_surface(normal));
    if let Some(segment) = scatter(world, vertex, &receiver, Vec3::ONE, None, media, light_u, sampler, observer) {
        let roulette_weight = Some(reciprocal(segment.throughput * radiance_scale(world, segment.media)));
        let length = PathLength { max_bounces: MAX_BOUNCES, roulette_weight };
        walk(world, segment, 0, length, sampler, observer);
    }
}

/// Traces the rest of a path, from `segment` on; `scattered` is the number of bounces before this segment.
pub(super) fn walk<O: Observer>(
    world: &World,
    mut segment: PathSegment,
    scattered: u32,
    mut length: PathLength,
    sampler: &mut Sampler,
    observer: &mut O,
) {
    for bounce in scattered.. {
        let Some((vertex, distance)) = intersect(world, &mut segment, sampler, observer) else { return };
        match continue_path(world, &segment, &vertex, distance, bounce, &mut length, sampler, observer) {
            Some(next) => segment = next,
            None => return,
        }
    }
}

/// Intersects a segment with the scene, and multiplies its throughput by the transmittance of the medium that it runs
/// through. Adds the emission of the hit or, without a hit, of the environment. Returns the vertex and its distance;
/// `None` without a hit.
#[inline(always)]
pub(super) fn intersect<O: Observer>(
    world: &World,
    segment: &mut PathSegment,
    sampler: &Sampler,
    observer: &mut O,
) -> Option<(Vertex, f32)> {
    let hit = world.closest(&segment.ray, segment.from, || sampler.ray_seed());
    if !segment.media.is_none() {
        segment.throughput *= world.medium(segment.media).transmittance(hit.map_or(f32::INFINITY, |hit| hit.t));
    }
    let Some(hit) = hit else {
        add_environment(world, segment, observer);
        add_discs(world, segment, observer);
        return None;
    };
    let vertex = Vertex::of_hit(world, &hit);
    add_emission(world, segment, &vertex, observer);
    Some((vertex, hit.t))
}

/// Continues a path of `bounce` bounces at a vertex: plays Russian roulette, samples a light, and samples the BSDF.
/// Returns the next segment; `None` if the path ends.
#[inline(always)]
pub(super) fn continue_path<O: Observer>(
    world: &World,
    segment: &PathSegment,
    vertex: &Vertex,
    distance: f32,
    bounce: u32,
    length: &mut PathLength,
    sampler: &mut Sampler,
    observer: &mut O,
) -> Option<PathSegment> {
    if bounce == length.max_bounces {
        return None;
    }
    // Play Russian roulette on the expected contribution (Vorba and Křivánek 2016, "Adjoint-driven Russian roulette
    // and splitting in light transport simulation"). The paper estimates the radiance that arrives at each vertex; here
    // one `roulette_weight` per path takes the place of these estimates.
    let mut throughput = segment.throughput;
    if bounce >= ROULETTE_START
        && let Some(roulette_weight) = length.roulette_weight
    {
        // If the expected share is below 1/4, the path survives with the probability √share instead of the smaller
        // share / `CERTAIN_SHARE`, because the expected share underestimates rare bright light.
        let scale = radiance_scale(world, segment.media);
        let expected_share = (throughput * roulette_weight).max_element() * scale;
        let survival = (expected_share / CERTAIN_SHARE).max(expected_share.sqrt()).min(MAX_SURVIVAL);
        if !(sampler.chance() < survival) {
            return None;
        }
        throughput /= survival;
    }
    let bsdf = vertex.bsdf(world, segment.media, || sampler.ray_seed(), -segment.ray.direction);
    if bounce == 0 && segment.from == NONE {
        observer.primary_hit(|| PrimaryHit::new(vertex, &bsdf, distance));
    }
    let PathSegment { mis, media, light_u, .. } = *segment;
    let next = scatter(world, vertex, &bsdf, throughput, mis, media, light_u, sampler, observer)?;
    length.roulette_weight.get_or_insert_with(|| reciprocal(next.throughput * radiance_scale(world, next.media)));
    Some(next)
}

/// Returns the factor by which radiance grows in the medium of a point, compared with air: the square of the index of
/// refraction. The light that a path still brings is expected to grow by this factor, as its throughput has shrunk.
#[inline]
fn radiance_scale(world: &World, media: Media) -> f32 {
    if media.is_none() {
        return 1.0;
    }
    let ior = world.medium(media).ior;
    ior * ior
}

/// Samples a light at a vertex among `media`, then samples the BSDF. Returns the next segment; `None` if the path ends.
pub(super) fn scatter<O: Observer>(
    world: &World,
    vertex: &Vertex,
    bsdf: &Bsdf,
    throughput: Vec3,
    mis: Option<(Receiver, f32)>,
    media: Media,
    light_u: (f64, f32),
    sampler: &mut Sampler,
    observer: &mut O,
) -> Option<PathSegment> {
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    if let Some(light) = sample_light(world, &receiver, bsdf, light_u) {
        add_direct_light(world, vertex, bsdf, throughput, media, &light, observer);
    }
    let (scattered, light_u) = sample_direction(bsdf, sampler)?;
    let throughput = throughput * scattered.weight;
    if throughput == Vec3::ZERO || !throughput.is_finite() {
        return None;
    }
    observer.scatter(vertex.mesh, scattered.kind, scattered.lobes);
    let (mis, media) = match scattered.kind {
        ScatterKind::NonSpecular(pdf) => (Some((receiver, pdf)), media),
        ScatterKind::Mirror => (None, media),
        ScatterKind::Pane => (mis, media),
        ScatterKind::Refraction { .. } => (None, bsdf.beyond().unwrap_or(media)),
    };
    Some(PathSegment { ray: vertex.ray(scattered.direction), from: vertex.id, throughput, mis, media, light_u })
}

/// Samples a light. `None` if no light can be sampled, or if the BSDF has no non-specular lobe (a mirror, a clear pane
/// or a black surface).
#[inline(always)]
pub(super) fn sample_light(
    world: &World,
    receiver: &Receiver,
    bsdf: &Bsdf,
    light_u: (f64, f32),
) -> Option<LightSample> {
    if bsdf.has_non_specular() { world.lights().sample(world.scene(), receiver, light_u) } else { None }
}

/// Samples the BSDF. Also returns the random numbers that select the light sample at the next vertex. `None` if the
/// sample carries no light.
#[inline(always)]
pub(super) fn sample_direction(bsdf: &Bsdf, sampler: &mut Sampler) -> Option<(BsdfSample, (f64, f32))> {
    let block = sampler.next();
    let scattered = bsdf.sample(Vec2::new(block.get(0), block.get(1)))?;
    Some((scattered, (block.fine(2), block.get(3))))
}

/// Adds the contribution of a light sample at a vertex, if the light is visible.
#[inline(always)]
pub(super) fn add_direct_light<O: Observer>(
    world: &World,
    vertex: &Vertex,
    bsdf: &Bsdf,
    throughput: Vec3,
    media: Media,
    light: &LightSample,
    observer: &mut O,
) {
    let (lobes, pdf) = bsdf.eval(light.direction);
    let value = lobes.sum();
    if value == Vec3::ZERO || light.emission == Vec3::ZERO {
        return;
    }
    let importance = throughput * value * connection_weight(world, vertex, media, light, pdf, observer.panes());
    if importance != Vec3::ZERO {
        observer.add(light.source, importance, light.emission, Strategy::LightSample { mesh: vertex.mesh, lobes });
    }
}

/// Returns the factor of a light sample's emission, without the BSDF: transmittance × MIS weight / `light.pdf`. The MIS
/// weight follows from `pdf`, the solid-angle pdf with which the BSDF would sample the direction of the light. The
/// vertex is among `media`; the surface of a solid body blocks light samples, so the light is among the same media.
#[inline(always)]
pub(super) fn connection_weight(
    world: &World,
    vertex: &Vertex,
    media: Media,
    light: &LightSample,
    pdf: f32,
    panes: Option<&mut Vec<Pane>>,
) -> Vec3 {
    let mis_weight = light.mis_pdf.map_or(1.0, |d| power_heuristic(d, pdf));
    let origin = vertex.off_surface(light.direction);
    let (ray, end) = match light.end {
        None => (Ray::new(origin, light.direction), NONE),
        Some(LightEnd::Point(p)) => (Ray { origin, direction: p - origin, t_max: 1.0 }, NONE),
        Some(LightEnd::Emitter(index, barycentric)) => {
            let emitter = &world.lights().emitters.emitters[index];
            let target = Vertex::new(world, emitter.id, barycentric);
            let p = target.off_surface(-light.direction);
            (Ray { origin, direction: p - origin, t_max: 1.0 }, emitter.id)
        }
    };
    let mut transmittance = world.transmittance(&ray, [vertex.id, end], panes);
    if !media.is_none() {
        let distance = if light.end.is_some() { ray.direction.length() } else { f32::INFINITY };
        transmittance *= world.medium(media).transmittance(distance);
    }
    if transmittance != Vec3::ZERO {
        world.lights().count_arrived(light);
    }
    transmittance * (mis_weight / light.pdf)
}

/// Adds the emission of the surface that `segment` has hit. If a light sample could also have found this light, the
/// emission has the MIS weight against light sampling; otherwise its weight is 1.
fn add_emission<O: Observer>(world: &World, segment: &PathSegment, vertex: &Vertex, observer: &mut O) {
    let Some(index) = world.emitter_of(vertex.id) else { return };
    let lights = world.lights();
    let emitter = &lights.emitters.emitters[index];
    let direction = segment.ray.direction;
    if !emitter.faces(direction) {
        return;
    }
    let (emission, uv) = lights.emitters.emission(world.scene(), index, vertex.barycentric, -direction);
    if emission == Vec3::ZERO {
        return;
    }
    let mis_weight = segment.mis.map_or(1.0, |(receiver, pdf)| {
        let distance = vertex.position.distance(receiver.position);
        let light_pdf = lights.surface_pdf(&receiver, index, (emission, uv), direction, distance);
        power_heuristic(pdf, light_pdf)
    });
    observer.add(lights.emitters.source(index, uv), segment.throughput * mis_weight, emission, Strategy::BsdfSample);
}

/// Adds the environment's radiance along a segment without a hit. The radiance has the MIS weight against light
/// sampling, or the weight 1 after the eye or a mirror.
fn add_environment<O: Observer>(world: &World, segment: &PathSegment, observer: &mut O) {
    let Some(environment) = world.environment() else { return };
    let emission = environment::radiance(environment, segment.ray.direction);
    if emission == Vec3::ZERO {
        return;
    }
    let mis_weight =
        segment.mis.map_or(1.0, |(_, pdf)| power_heuristic(pdf, world.lights().environment_pdf(segment.ray.direction)));
    observer.add(LightSource::Environment, segment.throughput * mis_weight, emission, Strategy::BsdfSample);
}

/// Adds the discs of directional lights that a segment without a hit meets. Only the eye and mirrors see them in this
/// way: at all other vertices, light samples find their light.
fn add_discs<O: Observer>(world: &World, segment: &PathSegment, observer: &mut O) {
    if segment.mis.is_some() {
        return;
    }
    for (index, disc) in world.lights().discs().filter(|(_, disc)| disc.contains(segment.ray.direction)) {
        let importance = segment.throughput * disc.luminance_factor();
        observer.add(LightSource::Punctual(index), importance, disc.illuminance, Strategy::BsdfSample);
    }
}

/// Returns the reciprocal of each channel; 0 for channels that are not positive.
pub(super) fn reciprocal(v: Vec3) -> Vec3 {
    Vec3::select(v.cmpgt(Vec3::ZERO), v.recip(), Vec3::ZERO)
}

/// Returns the MIS weight of a sample by the power heuristic with exponent 2. `own` is the pdf with which the sample
/// was drawn, `other` the pdf with which the other strategy would draw it.
fn power_heuristic(own: f32, other: f32) -> f32 {
    // Square the ratio of the pdfs, because the squares of the pdfs themselves might overflow.
    if own <= 0.0 {
        return 0.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
