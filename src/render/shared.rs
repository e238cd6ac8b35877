//! Path reuse among neighbouring pixels: the paths of a block share their secondary vertices.
//!
//! A secondary vertex also lights the primary vertices of the neighbours, and one more ray per neighbour tests its
//! visibility. The secondary vertex is weighed as if it were sampled from the mean of the pdfs of all primary vertices
//! that see it (the balance heuristic of Veach and Guibas 1995; Bekaert, Sbert and Halton 2002, "Accelerating path
//! tracing by re-using paths"). Estimates remain unbiased, and a pixel gets the indirect light of as many vertices as
//! the block has pixels, for little more than one ray each. In return, the errors of these pixels are correlated.
//!
//! Primary and secondary vertices must be non-specular: a mirror reflects something else to each pixel. Paths with
//! other vertices are traced alone.

use super::bsdf::{Bsdf, Lobes, ScatterKind};
use super::light::{LightSample, Receiver};
use super::path::{self, Leg, Observer, PathLength, PrimaryHit, Strategy};
use super::sampler::Sampler;
use super::vertex::{Surface, Vertex};
use super::world::{Pane, World};
use crate::scene::accel::Ray;
use glam::Vec3;

/// Largest number of paths that share vertices. [origin not recorded]
pub const MAX_SHARED: usize = 8;

/// An observer of several paths that have the same first segment.
pub trait ReplayObserver: Observer {
    type Tape: Tape;

    /// Returns to the eye, to leave it along another path. Contributions so far are kept.
    fn restart(&mut self);

    /// Receives the panes between a vertex and its light sample.
    fn take_panes(&mut self, _panes: &[Pane]) {}

    /// Continues the path along a recorded subpath, with this importance at its start.
    fn replay(&mut self, tape: &Self::Tape, importance: Vec3);

    /// Returns to the eye, scatters at the primary vertex (of a mesh, with these lobes), and continues along a
    /// recorded subpath with this importance at its start.
    fn replay_from(&mut self, mesh: u32, lobes: Lobes, tape: &Self::Tape, importance: Vec3);
}

/// Records a subpath from a vertex on, to replay it to several observers.
pub trait Tape: Observer {
    /// Announces the primary vertices whose observers will replay the tape: the mesh of each, and whether its BSDF has
    /// layers besides the diffuse one.
    fn expect(&mut self, _viewers: impl Iterator<Item = (u32, bool)>) {}

    /// Starts a new recording at a secondary vertex.
    fn begin(&mut self);

    /// Starts a new recording that begins after the path has scattered at a secondary vertex of a mesh.
    fn begin_behind(&mut self, _mesh: u32) {
        self.begin();
    }

    /// Ends the recording; returns whether it has any light.
    fn end(&mut self) -> bool;
}

/// Scratch memory for the recording of a secondary vertex.
#[derive(Default)]
pub struct Scratch<T> {
    /// The subpath that begins at the vertex. If the light of the vertex depends on the viewer, the subpath begins
    /// after the path has scattered there.
    tape: T,
    /// The panes between the vertex and its light sample.
    panes: Vec<Pane>,
}

impl<T> Scratch<T> {
    pub fn new(tape: T) -> Self {
        Self { tape, panes: Vec::new() }
    }
}

/// A path before it leaves the eye.
pub struct Start {
    /// The camera ray; its direction has unit length.
    pub ray: Ray,
    /// Uniform in the unit square: selects the light sample at the primary vertex.
    pub light_u: (f64, f32),
    pub length: PathLength,
    pub sampler: Sampler,
}

/// The primary vertex of a path that takes part in sharing.
struct PrimaryVertex<'w> {
    vertex: Vertex,
    bsdf: Bsdf<'w>,
    /// Roulette weight of light from the secondary vertices: see [`PathLength::roulette_weight`].
    roulette_weight: Vec3,
    continuation: Option<Continuation>,
}

/// The BSDF sample at a primary vertex.
struct Continuation {
    direction: Vec3,
    lobes: Lobes,
    pdf: f32,
    leg: Leg,
}

/// A secondary vertex and its outgoing light, for every primary vertex that sees it.
struct SecondaryVertex<'w> {
    vertex: Vertex,
    light: SecondaryLight<'w>,
}

enum SecondaryLight<'w> {
    /// The same radiance in all directions.
    ViewIndependent,
    /// Radiance that depends on the direction of the viewer.
    ViewDependent {
        surface: Surface<'w>,
        /// A light sample and its weight without the BSDF ([`path::connection_weight`]).
        light_sample: Option<(LightSample, Vec3)>,
        /// Direction and solid-angle pdf of the BSDF sample at the vertex.
        continuation: Option<(Vec3, f32)>,
    },
}

/// A primary vertex that sees a secondary vertex.
#[derive(Clone, Copy)]
struct Viewer {
    number: usize,
    /// Towards the secondary vertex.
    direction: Vec3,
    lobes: Lobes,
    /// Solid-angle pdf with which the BSDF of the primary vertex samples `direction`.
    pdf: f32,
    /// Factor from a solid-angle pdf to an area pdf at the secondary vertex: cosine / squared distance.
    solid_angle_per_area: f32,
}

/// Estimates the radiance along several rays with one path each. Each observer receives the light of its own ray.
pub fn trace<W: ReplayObserver>(
    world: &World,
    starts: &mut [Start],
    observers: &mut [W],
    scratch: &mut Scratch<W::Tape>,
) {
    let mut primaries: [Option<PrimaryVertex>; MAX_SHARED] = [const { None }; MAX_SHARED];
    for ((primary, start), observer) in primaries.iter_mut().zip(&mut *starts).zip(&mut *observers) {
        *primary = trace_primary(world, start, observer);
    }
    // Use the largest roulette weight of the block: light that matters to any of its pixels must survive.
    let roulette_weight = primaries.iter().flatten().map(|s| s.roulette_weight).fold(Vec3::ZERO, Vec3::max);
    scratch.tape.expect(primaries.iter().flatten().map(|s| (s.vertex.mesh, !s.bsdf.is_diffuse())));
    for number in 0..starts.len() {
        let continuation = primaries[number].as_mut().and_then(|s| s.continuation.take());
        if let (Some(primary), Some(continuation)) = (&primaries[number], &continuation)
            && let Some(secondary) = trace_secondary(
                world,
                primary,
                continuation,
                roulette_weight,
                &mut starts[number],
                &mut observers[number],
                scratch,
            )
        {
            let viewers = Viewers::of(world, &secondary, number, continuation, &primaries);
            viewers.replay(&secondary, &primaries, observers, scratch);
        }
    }
}

/// Traces a path to its primary vertex, or to its end if that vertex cannot share.
fn trace_primary<'w, W: ReplayObserver>(
    world: &'w World,
    start: &mut Start,
    observer: &mut W,
) -> Option<PrimaryVertex<'w>> {
    let Start { ray, light_u, length, sampler } = start;
    let leg = Leg::from_eye(*ray, *light_u);
    let (vertex, distance) = path::intersect(world, &leg, sampler, observer)?;
    if length.max_bounces == 0 {
        return None;
    }
    let bsdf = vertex.bsdf(world, -leg.ray.direction);
    if !bsdf.is_shareable() {
        if let Some(next) = path::continue_path(world, &leg, &vertex, distance, 0, length, sampler, observer) {
            path::walk(world, next, 1, *length, sampler, observer);
        }
        return None;
    }
    observer.primary_hit(|| PrimaryHit::new(&vertex, &bsdf, distance));
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    if let Some(light) = path::sample_light(world, &receiver, &bsdf, leg.light_u) {
        path::add_direct_light(world, &vertex, &bsdf, Vec3::ONE, &light, observer);
    }
    let continuation = path::sample_direction(&bsdf, sampler).and_then(|(scattered, light_u)| {
        let ScatterKind::NonSpecular(pdf) = scattered.kind else { return None };
        let (direction, throughput) = (scattered.direction, scattered.weight);
        let mis = Some((receiver, pdf));
        let leg = Leg { ray: vertex.ray(direction), from: vertex.id, throughput, mis, light_u };
        let brings = throughput.is_finite() && throughput != Vec3::ZERO;
        brings.then_some(Continuation { direction, lobes: scattered.lobes, pdf, leg })
    });
    let colour = bsdf.colour();
    let roulette_weight = colour * *length.roulette_weight.get_or_insert_with(|| path::reciprocal(colour));
    Some(PrimaryVertex { vertex, bsdf, roulette_weight, continuation })
}

/// Traces a path from its primary to its secondary vertex. The observer receives the emission of the secondary
/// surface, and all light of a secondary vertex that cannot be shared.
fn trace_secondary<'w, W: ReplayObserver>(
    world: &'w World,
    primary: &PrimaryVertex,
    continuation: &Continuation,
    roulette_weight: Vec3,
    start: &mut Start,
    observer: &mut W,
    scratch: &mut Scratch<W::Tape>,
) -> Option<SecondaryVertex<'w>> {
    let Continuation { direction, lobes, pdf, leg } = continuation;
    let Start { length, sampler, .. } = start;
    observer.restart();
    observer.scatter(primary.vertex.mesh, ScatterKind::NonSpecular(*pdf), *lobes);
    let (vertex, distance) = path::intersect(world, leg, sampler, observer)?;
    if length.max_bounces == 1 {
        return None;
    }
    let surface = vertex.surface(world);
    let bsdf = surface.seen_from(-*direction);
    if !bsdf.is_shareable() || !is_surely_visible(world, primary, &vertex) {
        if let Some(next) = path::continue_path(world, leg, &vertex, distance, 1, length, sampler, observer) {
            path::walk(world, next, 2, *length, sampler, observer);
        }
        return None;
    }
    // Record the subpath as if it began at the secondary vertex.
    let length = PathLength { max_bounces: length.max_bounces, roulette_weight: Some(roulette_weight) };
    let light = if bsdf.is_view_independent() {
        record_view_independent(world, &vertex, &bsdf, leg.light_u, length, sampler, &mut scratch.tape)
    } else {
        record_view_dependent(world, &vertex, surface, &bsdf, leg.light_u, length, sampler, scratch)
    };
    light.map(|light| SecondaryVertex { vertex, light })
}

/// Records the light of a secondary vertex that sends the same radiance to all viewers.
fn record_view_independent<'w, T: Tape>(
    world: &World,
    vertex: &Vertex,
    bsdf: &Bsdf,
    light_u: (f64, f32),
    length: PathLength,
    sampler: &mut Sampler,
    tape: &mut T,
) -> Option<SecondaryLight<'w>> {
    tape.begin();
    if let Some(next) = path::scatter(world, vertex, bsdf, Vec3::ONE, None, light_u, sampler, tape) {
        path::walk(world, next, 2, length, sampler, tape);
    }
    tape.end().then_some(SecondaryLight::ViewIndependent)
}

/// Records the light of a secondary vertex whose radiance depends on the viewer.
fn record_view_dependent<'w, T: Tape>(
    world: &World,
    vertex: &Vertex,
    surface: Surface<'w>,
    bsdf: &Bsdf,
    light_u: (f64, f32),
    length: PathLength,
    sampler: &mut Sampler,
    scratch: &mut Scratch<T>,
) -> Option<SecondaryLight<'w>> {
    let Scratch { tape, panes } = scratch;
    tape.begin_behind(vertex.mesh);
    panes.clear();
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    let light = path::sample_light(world, &receiver, bsdf, light_u).filter(|l| l.emission != Vec3::ZERO);
    let light_sample = light.and_then(|light| {
        let (lobes, pdf) = bsdf.eval(light.direction);
        if lobes.sum() == Vec3::ZERO {
            return None;
        }
        let importance = path::connection_weight(world, vertex, &light, pdf, Some(panes));
        (importance != Vec3::ZERO).then_some((light, importance))
    });
    let continuation = path::sample_direction(bsdf, sampler).and_then(|(scattered, light_u)| {
        let ScatterKind::NonSpecular(pdf) = scattered.kind else { return None };
        let leg = Leg {
            ray: vertex.ray(scattered.direction),
            from: vertex.id,
            throughput: Vec3::ONE,
            mis: Some((receiver, pdf)),
            light_u,
        };
        let length = PathLength {
            roulette_weight: length.roulette_weight.map(|roulette_weight| roulette_weight * scattered.weight),
            ..length
        };
        path::walk(world, leg, 2, length, sampler, tape);
        tape.end().then_some((scattered.direction, pdf))
    });
    let has_light = light_sample.is_some() || continuation.is_some();
    has_light.then_some(SecondaryLight::ViewDependent { surface, light_sample, continuation })
}

/// Whether no surface lies between two vertices, not even a transparent one: a path passes a partly transparent surface
/// only by chance, and scatters at a clear pane.
fn is_visible(world: &World, from: &Vertex, to: &Vertex, direction: Vec3) -> bool {
    let origin = from.off_surface(direction);
    let target = to.off_surface(-direction);
    world.is_clear(&Ray { origin, direction: target - origin, t_max: 1.0 }, [from.id, to.id])
}

/// Whether a secondary vertex is visible from its own primary vertex with certainty, not by chance. This is always true
/// if all surfaces of the scene are opaque.
fn is_surely_visible(world: &World, primary: &PrimaryVertex, secondary: &Vertex) -> bool {
    let direction = secondary.position - primary.vertex.position;
    !world.is_see_through() || is_visible(world, &primary.vertex, secondary, direction)
}

/// All primary vertices that see a secondary vertex.
struct Viewers {
    list: [Option<Viewer>; MAX_SHARED],
    /// Sum of their area pdfs at the secondary vertex.
    area_pdf: f32,
}

impl Viewers {
    fn of(
        world: &World,
        secondary: &SecondaryVertex,
        owner: usize,
        continuation: &Continuation,
        primaries: &[Option<PrimaryVertex>; MAX_SHARED],
    ) -> Self {
        let surface = &secondary.vertex;
        let solid_angle_per_area =
            |from: &Vertex, cosine: f32| cosine.abs() / from.position.distance_squared(surface.position);
        let cosine = surface.normal.dot(continuation.direction);
        let list = std::array::from_fn(|number| {
            let primary = primaries[number].as_ref()?;
            if number == owner {
                let Continuation { direction, lobes, pdf, .. } = *continuation;
                return Some(Viewer {
                    number,
                    direction,
                    lobes,
                    pdf,
                    solid_angle_per_area: solid_angle_per_area(&primary.vertex, cosine),
                });
            }
            let direction = (surface.position - primary.vertex.position).normalize_or_zero();
            let theirs = surface.normal.dot(direction);
            // Both primary vertices must be on the same side of the surface.
            if !(theirs * cosine > 0.0) {
                return None;
            }
            let (lobes, pdf) = primary.bsdf.eval(direction);
            let is_visible = pdf > 0.0 && is_visible(world, &primary.vertex, surface, direction);
            is_visible.then_some(Viewer {
                number,
                direction,
                lobes,
                pdf,
                solid_angle_per_area: solid_angle_per_area(&primary.vertex, theirs),
            })
        });
        let area_pdf = list.iter().flatten().map(|v: &Viewer| v.pdf * v.solid_angle_per_area).sum();
        let mut viewers = Self { list, area_pdf };
        // Where surfaces touch, the pdfs are not finite: only the path's own pixel uses the vertex.
        if !(area_pdf.is_finite() && area_pdf > 0.0) {
            viewers.list.iter_mut().flatten().for_each(|v| v.solid_angle_per_area = f32::from(v.number == owner));
            viewers.area_pdf = continuation.pdf;
        }
        viewers
    }

    /// Replays the light of the secondary vertex to the observers of all its viewers.
    fn replay<W: ReplayObserver>(
        &self,
        secondary: &SecondaryVertex,
        primaries: &[Option<PrimaryVertex>; MAX_SHARED],
        observers: &mut [W],
        scratch: &Scratch<W::Tape>,
    ) {
        let mesh = secondary.vertex.mesh;
        for viewer in self.list.iter().flatten() {
            let (Some(primary), observer) = (&primaries[viewer.number], &mut observers[viewer.number]) else {
                continue;
            };
            let importance = viewer.lobes.sum() * (viewer.solid_angle_per_area / self.area_pdf);
            let SecondaryLight::ViewDependent { surface, light_sample, continuation } = &secondary.light else {
                observer.replay_from(primary.vertex.mesh, viewer.lobes, &scratch.tape, importance);
                continue;
            };
            observer.restart();
            observer.scatter(primary.vertex.mesh, ScatterKind::NonSpecular(viewer.pdf), viewer.lobes);
            let bsdf = surface.seen_from(-viewer.direction);
            if let Some((light, weight)) = light_sample {
                let (lobes, _) = bsdf.eval(light.direction);
                observer.take_panes(&scratch.panes);
                let importance = importance * lobes.sum() * *weight;
                observer.add(light.source, importance, light.emission, Strategy::LightSample { mesh, lobes });
            }
            if let Some((direction, pdf)) = continuation {
                let (lobes, _) = bsdf.eval(*direction);
                observer.scatter(mesh, ScatterKind::NonSpecular(*pdf), lobes);
                observer.replay(&scratch.tape, importance * lobes.sum() / *pdf);
            }
        }
    }
}
