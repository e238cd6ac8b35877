//! Paths of neighbouring pixels, which share what they find behind the first surfaces they meet.
//!
//! What a path comes to from there sends light to the neighbours as well, and one more ray tells whether they see it. Each
//! such point is weighed as if it had been drawn from the mean of the densities with which all that see it could have drawn
//! it (the balance heuristic of Veach and Guibas 1995; Bekaert, Sbert and Halton 2002, "Accelerating path tracing by
//! re-using paths"). So no estimate is biased, and a pixel has the indirect light of as many points as there are pixels, for
//! little more than a ray each. What it costs is that the errors of those pixels are alike.
//!
//! Only surfaces that spread light take part, at both ends: a mirror sends to each pixel something else. All others'
//! paths go on alone.

use super::bsdf::{Bsdf, Lobes, ScatterKind};
use super::light::{LightSample, Receiver};
use super::path::{self, Leg, Observer, PathLength, PrimaryHit, Strategy};
use super::sampler::Sampler;
use super::vertex::{Surface, Vertex};
use super::world::{Pane, World};
use crate::scene::accel::Ray;
use glam::Vec3;

/// Most paths that share.
pub const MAX_SHARED: usize = 8;

/// An observer of several paths that begin with the same first leg.
pub trait ReplayObserver: Observer {
    type Tape: Tape;

    /// Goes back to the eye, from where the path leaves on another way. What it has brought stays.
    fn restart(&mut self);

    /// Before the light chosen for a vertex stand these panes.
    fn take_panes(&mut self, _panes: &[Pane]) {}

    /// The path goes on as the one on a tape, with this importance when it sets out on it.
    fn replay(&mut self, tape: &Self::Tape, importance: Vec3);

    /// The same after going back to the eye and on from the first surface, of a mesh, whose lobes send this much on.
    fn replay_from(&mut self, mesh: u32, lobes: Lobes, tape: &Self::Tape, importance: Vec3);
}

/// What happens to a path from some vertex on, to be told to several witnesses.
pub trait Tape: Observer {
    /// Those who will be told come off surfaces of these meshes, which have a layer on the diffuse one or not.
    fn expect(&mut self, _viewers: impl Iterator<Item = (u32, bool)>) {}

    /// Begins anew, at a point that they see.
    fn begin(&mut self);

    /// Begins anew behind such a point, which is of a mesh.
    fn begin_behind(&mut self, _mesh: u32) {
        self.begin();
    }

    /// Ends; whether there is light to tell of.
    fn end(&mut self) -> bool;
}

/// Scratch memory for what there is to tell of a point.
#[derive(Default)]
pub struct Scratch<T> {
    /// The path from there on; where it sends to each what is theirs, the path beyond it.
    tape: T,
    /// The panes before the light chosen for it.
    panes: Vec<Pane>,
}

impl<T> Scratch<T> {
    pub fn new(tape: T) -> Self {
        Self { tape, panes: Vec::new() }
    }
}

/// A path before it leaves the eye.
pub struct Start {
    /// Of unit direction.
    pub ray: Ray,
    /// Chooses the light for the first surface, as a point of the unit square.
    pub light_u: (f64, f32),
    pub length: PathLength,
    pub sampler: Sampler,
}

/// The first surface a path meets, where it takes part.
struct PrimaryVertex<'w> {
    vertex: Vertex,
    bsdf: Bsdf<'w>,
    /// What light from the surfaces it sees is worth, as [`PathLength::roulette_weight`] has it.
    roulette_weight: Vec3,
    continuation: Option<Continuation>,
}

/// Where a path goes from there.
struct Continuation {
    direction: Vec3,
    lobes: Lobes,
    pdf: f32,
    leg: Leg,
}

/// A point that a path has come to from there, and the light it has for all that see it.
struct SecondaryVertex<'w> {
    vertex: Vertex,
    light: SecondaryLight<'w>,
}

enum SecondaryLight<'w> {
    /// It sends the same to all.
    ViewIndependent,
    /// What it sends depends on who sees it.
    ViewDependent {
        surface: Surface<'w>,
        /// A light, and what its emission counts for before it is scattered.
        light_sample: Option<(LightSample, Vec3)>,
        /// Direction and density with which the path goes on.
        continuation: Option<(Vec3, f32)>,
    },
}

/// One who sees it.
#[derive(Clone, Copy)]
struct Viewer {
    number: usize,
    /// Towards the find.
    direction: Vec3,
    lobes: Lobes,
    /// Density per steradian with which it could have found it.
    pdf: f32,
    /// Steradians it has of a square metre there.
    solid_angle_per_area: f32,
}

/// Makes one estimate of the radiance along each of some rays. Each witness is told of its own.
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
    // Light that any of them may see must not be given up because it means little to one.
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

/// Follows a path to the first surface; one that takes no part to its end.
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

/// Follows a path on to what it finds next. What is its own alone the witness is told of: light it meets there, and all
/// that comes of a point that takes no part.
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
    // The path from there on is told of as if it began there.
    let length = PathLength { max_bounces: length.max_bounces, roulette_weight: Some(roulette_weight) };
    let light = if bsdf.is_view_independent() {
        record_view_independent(world, &vertex, &bsdf, leg.light_u, length, sampler, &mut scratch.tape)
    } else {
        record_view_dependent(world, &vertex, surface, &bsdf, leg.light_u, length, sampler, scratch)
    };
    light.map(|light| SecondaryVertex { vertex, light })
}

/// The light of a find that sends the same to all.
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

/// The light of a find that sends to each what is theirs.
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

/// Whether nothing stands between, not even what lets light pass: a path that came that way came by chance, or met it.
fn is_visible(world: &World, from: &Vertex, to: &Vertex, direction: Vec3) -> bool {
    let origin = from.off_surface(direction);
    let target = to.off_surface(-direction);
    world.is_clear(&Ray { origin, direction: target - origin, t_max: 1.0 }, [from.id, to.id])
}

/// The same of a point that was found from there: nothing is to be asked where all surfaces are solid.
fn is_surely_visible(world: &World, primary: &PrimaryVertex, secondary: &Vertex) -> bool {
    let direction = secondary.position - primary.vertex.position;
    !world.is_see_through() || is_visible(world, &primary.vertex, secondary, direction)
}

/// All that see a find.
struct Viewers {
    list: [Option<Viewer>; MAX_SHARED],
    /// Sum of their densities per square metre.
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
            // They must be on the same side of it.
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
        // Points of surfaces that touch are the finder's own.
        if !(area_pdf.is_finite() && area_pdf > 0.0) {
            viewers.list.iter_mut().flatten().for_each(|v| v.solid_angle_per_area = f32::from(v.number == owner));
            viewers.area_pdf = continuation.pdf;
        }
        viewers
    }

    /// Tells the witnesses what light they get from it.
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
