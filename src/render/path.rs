//! Paths from the eye to the light: next-event estimation and multiple importance sampling at every vertex.
//!
//! A path that scatters into a light and the same path made by choosing the light are weighed against each other by the
//! power heuristic (Veach 1997, 9.2.4). Clear panes are no vertices of a path in that sense: shadow rays pass through them
//! with their share, and paths keep the density of the vertex before. Nothing is clamped: the estimate is unbiased.

use super::bsdf::{Bsdf, BsdfSample, Lobes, ScatterKind};
use super::environment;
use super::light::{LightEnd, LightSample, Receiver};
use super::sampler::Sampler;
use super::vertex::Vertex;
use super::world::{NONE, Pane, World};
use super::{LightSource, PathSink};
use crate::scene::accel::Ray;
use glam::{Vec2, Vec3};

/// Bounce from which on a path may end by chance.
const ROULETTE_START: u32 = 2;
/// Paths go on for sure that promise this share of what the others bring. Ending them sooner would save less time than
/// its scatter costs: measured on rooms, the product of time and variance is least about here.
const CERTAIN_SHARE: f32 = 0.5;
/// The surest a path can be to go on: in a room of white walls it must end some time. Walls that give
/// back more than the root of this make the variance infinite.
const MAX_SURVIVAL: f32 = 0.998;

/// How often a path scatters at most: a guard that nothing meets, as at [`MAX_SURVIVAL`] a ten-millionth of paths would come so far.
pub const MAX_BOUNCES: u32 = 8192;

/// Takes what a path brings. All but [`Observer::add`] is for those that tell light apart by the way it came; the others
/// leave these steps empty, and pay nothing for them.
pub trait Observer {
    /// A contribution, as [`PathSink::add`] has it, and how its light was found.
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, strategy: Strategy);

    /// The first surface a path from the eye meets.
    fn primary_hit(&mut self, _seen: impl FnOnce() -> PrimaryHit) {}

    /// The path goes on from a vertex of a mesh.
    fn scatter(&mut self, _mesh: u32, _kind: ScatterKind, _lobes: Lobes) {}

    /// Where to list the panes between a vertex and a light chosen for it, if anyone wants to know.
    fn panes(&mut self) -> Option<&mut Vec<Pane>> {
        None
    }
}

/// A surface as the eye meets it.
#[derive(Clone, Copy)]
pub struct PrimaryHit {
    pub mesh: u32,
    pub position: Vec3,
    /// Shading normal and geometric normal on the side of the eye.
    pub normal: Vec3,
    pub geometric_normal: Vec3,
    /// Colour at normal incidence.
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

/// How a light was found.
#[derive(Clone, Copy)]
pub enum Strategy {
    /// By scattering into it.
    BsdfSample,
    /// It was chosen for a vertex of a mesh, whose lobes send this much of it on.
    LightSample { mesh: u32, lobes: Lobes },
}

/// An observer that only adds up.
pub struct Contributions<'a, S>(pub &'a mut S);

impl<S: PathSink> Observer for Contributions<'_, S> {
    #[inline]
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, _: Strategy) {
        self.0.add(source, importance, emission);
    }
}

/// A path about to leave a vertex or the eye.
pub(super) struct Leg {
    pub ray: Ray,
    /// The triangle it leaves.
    pub from: u32,
    pub throughput: Vec3,
    /// For what the light was last sampled, and the density of the direction then chosen; none if only scattering could
    /// find what lies ahead.
    pub mis: Option<(Receiver, f32)>,
    /// Uniform in the unit square: chooses the light for the next vertex.
    pub light_u: (f64, f32),
}

impl Leg {
    /// From the eye along a ray of unit direction.
    pub fn from_eye(ray: Ray, light_u: (f64, f32)) -> Self {
        Self { ray, from: NONE, throughput: Vec3::ONE, mis: None, light_u }
    }
}

/// What decides how long paths are.
#[derive(Clone, Copy)]
pub struct PathLength {
    /// They scatter so often at most.
    pub max_bounces: u32,
    /// What light of middling brightness means to the sum of all paths, relative to it. Without it the colour of the first
    /// surface is what counts.
    pub roulette_weight: Option<Vec3>,
}

/// Makes one estimate of the radiance that arrives along a ray (of unit direction). A point of the unit square chooses the
/// first light.
pub fn trace<O: Observer>(
    world: &World,
    ray: Ray,
    light_u: (f64, f32),
    length: PathLength,
    sampler: &mut Sampler,
    observer: &mut O,
) {
    walk(world, Leg::from_eye(ray, light_u), 0, length, sampler, observer);
}

/// Makes one estimate of the irradiance at a point.
pub fn gather<O: Observer>(world: &World, vertex: &Vertex, front: bool, sampler: &mut Sampler, observer: &mut O) {
    let normal = if front { vertex.normal } else { -vertex.normal };
    let receiver = Bsdf::receiver(normal);
    let block = sampler.next();
    let light_u = (block.fine(0), block.get(1));
    if let Some(leg) = scatter(world, vertex, &receiver, Vec3::ONE, None, light_u, sampler, observer) {
        let length = PathLength { max_bounces: MAX_BOUNCES, roulette_weight: Some(reciprocal(leg.throughput)) };
        walk(world, leg, 0, length, sampler, observer);
    }
}

/// Follows a path that has scattered so often to its end.
pub(super) fn walk<O: Observer>(
    world: &World,
    mut leg: Leg,
    scattered: u32,
    mut length: PathLength,
    sampler: &mut Sampler,
    observer: &mut O,
) {
    for bounce in scattered.. {
        let Some((vertex, distance)) = intersect(world, &leg, sampler, observer) else { return };
        match continue_path(world, &leg, &vertex, distance, bounce, &mut length, sampler, observer) {
            Some(next) => leg = next,
            None => return,
        }
    }
}

/// Where a path comes to a surface, and how far that is. Adds the light that comes from there, or from around the scene.
#[inline(always)]
pub(super) fn intersect<O: Observer>(
    world: &World,
    leg: &Leg,
    sampler: &Sampler,
    observer: &mut O,
) -> Option<(Vertex, f32)> {
    let Some(hit) = world.closest(&leg.ray, leg.from, || sampler.ray_seed()) else {
        add_environment(world, leg, observer);
        return None;
    };
    let vertex = Vertex::of_hit(world, &hit);
    add_emission(world, leg, &vertex, observer);
    Some((vertex, hit.t))
}

/// How a path that has scattered so often leaves a vertex, if it does. Adds the light chosen for it.
#[inline(always)]
pub(super) fn continue_path<O: Observer>(
    world: &World,
    leg: &Leg,
    vertex: &Vertex,
    distance: f32,
    bounce: u32,
    length: &mut PathLength,
    sampler: &mut Sampler,
    observer: &mut O,
) -> Option<Leg> {
    if bounce == length.max_bounces {
        return None;
    }
    // End by chance what can no longer add much (Vorba and Křivánek 2016, "Adjoint-driven Russian roulette and
    // splitting in light transport simulation", with a single value for the light that may still be found).
    let mut throughput = leg.throughput;
    if bounce >= ROULETTE_START
        && let Some(roulette_weight) = length.roulette_weight
    {
        // Of little promise, more go on than it says: where bright light is rare, it says too little.
        let expected_share = (throughput * roulette_weight).max_element();
        let survival = (expected_share / CERTAIN_SHARE).max(expected_share.sqrt()).min(MAX_SURVIVAL);
        if !(sampler.chance() < survival) {
            return None;
        }
        throughput /= survival;
    }
    let bsdf = vertex.bsdf(world, -leg.ray.direction);
    if bounce == 0 && leg.from == NONE {
        observer.primary_hit(|| PrimaryHit::new(vertex, &bsdf, distance));
    }
    let next = scatter(world, vertex, &bsdf, throughput, leg.mis, leg.light_u, sampler, observer)?;
    length.roulette_weight.get_or_insert_with(|| reciprocal(next.throughput));
    Some(next)
}

/// Adds the light chosen for a vertex and chooses where the path goes on.
pub(super) fn scatter<O: Observer>(
    world: &World,
    vertex: &Vertex,
    bsdf: &Bsdf,
    throughput: Vec3,
    mis: Option<(Receiver, f32)>,
    light_u: (f64, f32),
    sampler: &mut Sampler,
    observer: &mut O,
) -> Option<Leg> {
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    if let Some(light) = sample_light(world, &receiver, bsdf, light_u) {
        add_direct_light(world, vertex, bsdf, throughput, &light, observer);
    }
    let (scattered, light_u) = sample_direction(bsdf, sampler)?;
    let throughput = throughput * scattered.weight;
    if throughput == Vec3::ZERO || !throughput.is_finite() {
        return None;
    }
    observer.scatter(vertex.mesh, scattered.kind, scattered.lobes);
    let mis = match scattered.kind {
        ScatterKind::NonSpecular(pdf) => Some((receiver, pdf)),
        ScatterKind::Mirror => None,
        ScatterKind::Pane => mis,
    };
    Some(Leg { ray: vertex.ray(scattered.direction), from: vertex.id, throughput, mis, light_u })
}

/// A light for what scatters any.
#[inline(always)]
pub(super) fn sample_light(
    world: &World,
    receiver: &Receiver,
    bsdf: &Bsdf,
    light_u: (f64, f32),
) -> Option<LightSample> {
    if bsdf.has_non_specular() { world.lights().sample(world.scene(), receiver, light_u) } else { None }
}

/// Where a path goes on, and the point of the unit square that chooses the light where that leads.
#[inline(always)]
pub(super) fn sample_direction(bsdf: &Bsdf, sampler: &mut Sampler) -> Option<(BsdfSample, (f64, f32))> {
    let block = sampler.next();
    let scattered = bsdf.sample(Vec2::new(block.get(0), block.get(1)))?;
    Some((scattered, (block.fine(2), block.get(3))))
}

/// Adds the light chosen for a vertex.
#[inline(always)]
pub(super) fn add_direct_light<O: Observer>(
    world: &World,
    vertex: &Vertex,
    bsdf: &Bsdf,
    throughput: Vec3,
    light: &LightSample,
    observer: &mut O,
) {
    let (lobes, pdf) = bsdf.eval(light.direction);
    let value = lobes.sum();
    if value == Vec3::ZERO || light.emission == Vec3::ZERO {
        return;
    }
    let importance = throughput * value * connection_weight(world, vertex, light, pdf, observer.panes());
    if importance != Vec3::ZERO {
        observer.add(light.source, importance, light.emission, Strategy::LightSample { mesh: vertex.mesh, lobes });
    }
}

/// What a chosen light's emission counts for at a vertex, before it scatters: as much of it as nothing stands in the way of,
/// weighed against meeting the light by scattering with a density, over the probability of its choice.
#[inline(always)]
pub(super) fn connection_weight(
    world: &World,
    vertex: &Vertex,
    light: &LightSample,
    pdf: f32,
    panes: Option<&mut Vec<Pane>>,
) -> Vec3 {
    let weight = light.mis_pdf.map_or(1.0, |d| power_heuristic(d, pdf));
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
    world.transmittance(&ray, [vertex.id, end], panes) * (weight / light.pdf)
}

/// What a path meets by scattering, weighed against having chosen it as a light.
fn add_emission<O: Observer>(world: &World, leg: &Leg, vertex: &Vertex, observer: &mut O) {
    let Some(index) = world.emitter_of(vertex.id) else { return };
    let lights = world.lights();
    let emitter = &lights.emitters.emitters[index];
    let direction = leg.ray.direction;
    if !emitter.faces(direction) {
        return;
    }
    let (emission, uv) = emitter.emission(world.scene(), vertex.barycentric);
    if emission == Vec3::ZERO {
        return;
    }
    let weight = leg.mis.map_or(1.0, |(receiver, pdf)| {
        let distance = vertex.position.distance(receiver.position);
        let light_pdf = lights.surface_pdf(&receiver, index, (emission, uv), direction, distance);
        power_heuristic(pdf, light_pdf)
    });
    let source = LightSource::Surface { mesh: vertex.mesh, triangle: vertex.triangle, uv };
    observer.add(source, leg.throughput * weight, emission, Strategy::BsdfSample);
}

fn add_environment<O: Observer>(world: &World, leg: &Leg, observer: &mut O) {
    let Some(environment) = world.environment() else { return };
    let emission = environment::radiance(environment, leg.ray.direction);
    if emission == Vec3::ZERO {
        return;
    }
    let weight =
        leg.mis.map_or(1.0, |(_, pdf)| power_heuristic(pdf, world.lights().environment_pdf(leg.ray.direction)));
    observer.add(LightSource::Environment, leg.throughput * weight, emission, Strategy::BsdfSample);
}

/// Of each channel; 0 where there is nothing.
pub(super) fn reciprocal(v: Vec3) -> Vec3 {
    Vec3::select(v.cmpgt(Vec3::ZERO), v.recip(), Vec3::ZERO)
}

/// The weight of a strategy of density `own` against another of density `other`.
fn power_heuristic(own: f32, other: f32) -> f32 {
    // As a ratio, so that neither square overflows.
    if own <= 0.0 {
        return 0.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}
