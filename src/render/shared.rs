//! Path reuse among neighbouring pixels: the paths of a block of pixels share their secondary vertices.
//!
//! A secondary vertex sends light not only to the primary vertex of its own path, but also to the primary vertices of
//! the neighbouring paths. One more ray per neighbour tests whether that neighbour's primary vertex sees the secondary
//! vertex. The secondary vertex is weighted as if it had been sampled from the mean of the pdfs of all primary vertices
//! that see it (the balance heuristic of Veach and Guibas 1995; Bekaert, Sbert and Halton 2002, "Accelerating path
//! tracing by re-using paths"). Estimates remain unbiased. Each pixel gets indirect light from as many secondary
//! vertices as the block has pixels; each further vertex costs the pixel little more than one ray. The disadvantage is
//! that the errors of the block's pixels are correlated.
//!
//! Primary and secondary vertices must be non-specular, since a mirror shows each pixel a different surface, and the
//! camera must not be inside a solid body. Other paths are traced alone.

use super::bounds::Receiver;
use super::bsdf::{Bsdf, Lobes, ScatterKind};
use super::light::LightSample;
use super::medium::Media;
use super::path::{self, Observer, PathLength, PathSegment, PrimaryHit, Strategy};
use super::sampler::Sampler;
use super::vertex::{Surface, Vertex};
use super::world::{Pane, World};
use crate::accel::Ray;
use glam::Vec3;

/// Largest number of paths that share vertices, and number of pixels in a block: 4 × 2 pixels, which fill a tile in
/// either orientation. Estimates are unbiased for any number, so the expected image stays the same. [convention]
pub const MAX_SHARED: usize = 8;

/// An observer that receives several paths with the same camera ray: its own path, and reused subpaths.
pub trait ReplayObserver: Observer {
    type Tape: Tape;

    /// Goes back to the eye to receive another path. The contributions so far are kept.
    fn restart(&mut self);

    /// Receives the panes between a vertex and its light sample.
    fn take_panes(&mut self, _panes: &[Pane]) {}

    /// Continues the current path along the recorded subpath `tape`, whose light is multiplied by `importance`.
    fn replay(&mut self, tape: &Self::Tape, importance: Vec3);

    /// Goes back to the eye, scatters at the primary vertex (on `mesh`, with the values `lobes`), and continues along
    /// the recorded subpath `tape`, whose light is multiplied by `importance`.
    fn replay_from(&mut self, mesh: u32, lobes: Lobes, tape: &Self::Tape, importance: Vec3);
}

/// Records the light of a subpath, so that several observers can replay it.
pub trait Tape: Observer {
    /// Announces the primary vertices whose observers will replay the tape: for each its mesh, and whether its BSDF
    /// has layers besides the diffuse one.
    fn expect(&mut self, _viewers: impl Iterator<Item = (u32, bool)>) {}

    /// Starts a new recording, which begins at a secondary vertex.
    fn begin(&mut self);

    /// Starts a new recording, which begins after the path has scattered at a secondary vertex on a mesh.
    fn begin_after_scattering(&mut self, _mesh: u32) {
        self.begin();
    }

    /// Ends the recording. Returns whether it contains any light.
    fn end(&mut self) -> bool;
}

/// Scratch memory for recording the light of a secondary vertex.
#[derive(Default)]
pub struct Scratch<T> {
    /// The recorded subpath. It begins at the secondary vertex, or, if the light of that vertex depends on the viewer,
    /// after the path has scattered there.
    tape: T,
    /// The panes between the secondary vertex and its light sample.
    panes: Vec<Pane>,
}

impl<T> Scratch<T> {
    pub fn new(tape: T) -> Self {
        Self { tape, panes: Vec::new() }
    }
}

/// A path that is about to leave the eye.
pub struct Start {
    /// The camera ray; its direction has unit length.
    pub ray: Ray,
    /// The media around the eye.
    pub media: Media,
    /// Uniform random numbers in `[0, 1)` that select the light sample at the primary vertex.
    pub light_u: (f64, f32),
    pub length: PathLength,
    pub sampler: Sampler,
}

/// The primary vertex of a path that shares secondary vertices.
struct PrimaryVertex<'w> {
    vertex: Vertex,
    bsdf: Bsdf<'w>,
    /// Weight for Russian roulette of light that arrives from the secondary vertices; see
    /// [`PathLength::roulette_weight`].
    roulette_weight: Vec3,
    scattered: Option<ScatteredSegment>,
}

/// The BSDF sample at a primary vertex, with the segment that follows it.
struct ScatteredSegment {
    direction: Vec3,
    lobes: Lobes,
    pdf: f32,
    segment: PathSegment,
}

/// A secondary vertex, and the light that it sends to every primary vertex that sees it.
struct SecondaryVertex<'w> {
    vertex: Vertex,
    light: SecondaryLight<'w>,
}

enum SecondaryLight<'w> {
    /// The radiance is the same in all directions.
    ViewIndependent,
    /// The radiance depends on the direction of the viewer.
    ViewDependent {
        surface: Surface<'w>,
        /// A light sample, and its weight without the BSDF ([`path::connection_weight`]).
        light_sample: Option<(LightSample, Vec3)>,
        /// Direction of the BSDF sample at the secondary vertex, and its solid-angle pdf.
        bsdf_sample: Option<(Vec3, f32)>,
    },
}

/// A primary vertex that sees the secondary vertex.
#[derive(Clone, Copy)]
struct Viewer {
    number: usize,
    /// Unit direction to the secondary vertex.
    direction: Vec3,
    lobes: Lobes,
    /// Solid-angle pdf with which the BSDF of the primary vertex samples `direction`.
    pdf: f32,
    /// Factor that converts `pdf` to an area pdf at the secondary vertex: cosine / squared distance.
    solid_angle_per_area: f32,
}

/// Estimates the radiance along several camera rays, with one path each and shared secondary vertices. Each observer
/// receives the light of its own ray.
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
    // Use the largest roulette weight of the block, so that a path survives if its light matters to any pixel of the
    // block.
    let roulette_weight = primaries.iter().flatten().map(|s| s.roulette_weight).fold(Vec3::ZERO, Vec3::max);
    scratch.tape.expect(primaries.iter().flatten().map(|s| (s.vertex.mesh, !s.bsdf.is_diffuse())));
    for number in 0..starts.len() {
        let mut scattered = primaries[number].as_mut().and_then(|s| s.scattered.take());
        if let (Some(primary), Some(scattered)) = (&primaries[number], &mut scattered)
            && let Some(secondary) = trace_secondary(
                world,
                primary,
                scattered,
                roulette_weight,
                &mut starts[number],
                &mut observers[number],
                scratch,
            )
        {
            let viewers = Viewers::of(world, &secondary, number, scattered, &primaries);
            viewers.replay(world, &secondary, &primaries, observers, scratch);
        }
    }
}

/// Traces a path to its primary vertex. Returns `None` if there is no primary vertex, or if the primary vertex cannot
/// take part in sharing; the path is then traced to its end.
fn trace_primary<'w, W: ReplayObserver>(
    world: &'w World,
    start: &mut Start,
    observer: &mut W,
) -> Option<PrimaryVertex<'w>> {
    let Start { ray, media, light_u, length, sampler } = start;
    let mut segment = PathSegment::from_eye(*ray, *media, *light_u);
    let (vertex, distance) = path::intersect(world, &mut segment, sampler, observer)?;
    if length.max_bounces == 0 {
        return None;
    }
    let bsdf = vertex.bsdf(world, *media, || sampler.ray_seed(), -segment.ray.direction);
    if !bsdf.is_shareable() || !media.is_none() {
        if let Some(next) = path::continue_path(world, &segment, &vertex, distance, 0, length, sampler, observer) {
            path::walk(world, next, 1, *length, sampler, observer);
        }
        return None;
    }
    observer.primary_hit(|| PrimaryHit::new(&vertex, &bsdf, distance));
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    if let Some(light) = path::sample_light(world, &receiver, &bsdf, segment.light_u) {
        path::add_direct_light(world, &vertex, &bsdf, Vec3::ONE, Media::NONE, &light, observer);
    }
    let scattered = path::sample_direction(&bsdf, sampler).and_then(|(sample, light_u)| {
        let ScatterKind::NonSpecular(pdf) = sample.kind else { return None };
        let (direction, throughput) = (sample.direction, sample.weight);
        let mis = Some((receiver, pdf));
        let (ray, from) = (vertex.ray(direction), vertex.id);
        let segment = PathSegment { ray, from, throughput, mis, media: Media::NONE, light_u };
        let brings = throughput.is_finite() && throughput != Vec3::ZERO;
        brings.then_some(ScatteredSegment { direction, lobes: sample.lobes, pdf, segment })
    });
    let colour = bsdf.colour();
    let roulette_weight = colour * *length.roulette_weight.get_or_insert_with(|| path::reciprocal(colour));
    Some(PrimaryVertex { vertex, bsdf, roulette_weight, scattered })
}

/// Traces a path from its primary to its secondary vertex. The observer receives the emission of the secondary surface.
/// If the secondary vertex cannot be shared, the path is traced to its end for this observer alone, and the result is
/// `None`. The result is also `None` if there is no secondary vertex, if the path may have only one bounce, or if the
/// secondary vertex sends no other light.
fn trace_secondary<'w, W: ReplayObserver>(
    world: &'w World,
    primary: &PrimaryVertex,
    scattered: &mut ScatteredSegment,
    roulette_weight: Vec3,
    start: &mut Start,
    observer: &mut W,
    scratch: &mut Scratch<W::Tape>,
) -> Option<SecondaryVertex<'w>> {
    let ScatteredSegment { direction, lobes, pdf, segment } = scattered;
    let Start { length, sampler, .. } = start;
    observer.restart();
    observer.scatter(primary.vertex.mesh, ScatterKind::NonSpecular(*pdf), *lobes);
    let (vertex, distance) = path::intersect(world, segment, sampler, observer)?;
    if length.max_bounces == 1 {
        return None;
    }
    let surface = vertex.surface(world, Media::NONE, || sampler.ray_seed());
    let bsdf = surface.seen_from(world, -*direction);
    if !bsdf.is_shareable() || !is_surely_visible(world, primary, &vertex) {
        if let Some(next) = path::continue_path(world, segment, &vertex, distance, 1, length, sampler, observer) {
            path::walk(world, next, 2, *length, sampler, observer);
        }
        return None;
    }
    // Record the subpath with a throughput of 1 at the secondary vertex.
    let length = PathLength { max_bounces: length.max_bounces, roulette_weight: Some(roulette_weight) };
    let light = if bsdf.is_view_independent() {
        record_view_independent(world, &vertex, &bsdf, segment.light_u, length, sampler, &mut scratch.tape)
    } else {
        record_view_dependent(world, &vertex, surface, &bsdf, segment.light_u, length, sampler, scratch)
    };
    light.map(|light| SecondaryVertex { vertex, light })
}

/// Records the light of a secondary vertex that sends the same radiance in all directions; `None` if it sends none.
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
    if let Some(next) = path::scatter(world, vertex, bsdf, Vec3::ONE, None, Media::NONE, light_u, sampler, tape) {
        path::walk(world, next, 2, length, sampler, tape);
    }
    tape.end().then_some(SecondaryLight::ViewIndependent)
}

/// Records the light of a secondary vertex whose radiance depends on the viewer; `None` if the vertex sends no light.
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
    tape.begin_after_scattering(vertex.mesh);
    panes.clear();
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    let light = path::sample_light(world, &receiver, bsdf, light_u).filter(|l| l.emission != Vec3::ZERO);
    let light_sample = light.and_then(|light| {
        let (lobes, pdf) = bsdf.eval(light.direction);
        if lobes.sum() == Vec3::ZERO {
            return None;
        }
        let importance = path::connection_weight(world, vertex, Media::NONE, &light, pdf, Some(panes));
        (importance != Vec3::ZERO).then_some((light, importance))
    });
    let bsdf_sample = path::sample_direction(bsdf, sampler).and_then(|(scattered, light_u)| {
        let ScatterKind::NonSpecular(pdf) = scattered.kind else { return None };
        let segment = PathSegment {
            ray: vertex.ray(scattered.direction),
            from: vertex.id,
            throughput: Vec3::ONE,
            mis: Some((receiver, pdf)),
            media: Media::NONE,
            light_u,
        };
        let length = PathLength {
            roulette_weight: length.roulette_weight.map(|roulette_weight| roulette_weight * scattered.weight),
            ..length
        };
        path::walk(world, segment, 2, length, sampler, tape);
        tape.end().then_some((scattered.direction, pdf))
    });
    let has_light = light_sample.is_some() || bsdf_sample.is_some();
    has_light.then_some(SecondaryLight::ViewDependent { surface, light_sample, bsdf_sample })
}

/// Whether no surface lies between two vertices, not even a transparent one. A path passes a partly transparent
/// surface only by chance, and scatters at a clear pane, so neither kind of surface may lie between shared vertices.
fn is_visible(world: &World, from: &Vertex, to: &Vertex, direction: Vec3) -> bool {
    let origin = from.off_surface(direction);
    let target = to.off_surface(-direction);
    world.is_clear(&Ray { origin, direction: target - origin, t_max: 1.0 }, [from.id, to.id])
}

/// Whether the secondary vertex is visible from its own primary vertex with certainty, not only by chance. This is
/// always true if all surfaces of the scene are opaque.
fn is_surely_visible(world: &World, primary: &PrimaryVertex, secondary: &Vertex) -> bool {
    let direction = secondary.position - primary.vertex.position;
    !world.is_see_through() || is_visible(world, &primary.vertex, secondary, direction)
}

/// All primary vertices that see the secondary vertex.
struct Viewers {
    list: [Option<Viewer>; MAX_SHARED],
    /// Sum of the viewers' area pdfs at the secondary vertex.
    area_pdf: f32,
}

impl Viewers {
    fn of(
        world: &World,
        secondary: &SecondaryVertex,
        owner: usize,
        scattered: &ScatteredSegment,
        primaries: &[Option<PrimaryVertex>; MAX_SHARED],
    ) -> Self {
        let surface = &secondary.vertex;
        let solid_angle_per_area =
            |from: &Vertex, cosine: f32| cosine.abs() / from.position.distance_squared(surface.position);
        let cosine = surface.normal.dot(scattered.direction);
        let list = std::array::from_fn(|number| {
            let primary = primaries[number].as_ref()?;
            if number == owner {
                let ScatteredSegment { direction, lobes, pdf, .. } = *scattered;
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
            // Skip primary vertices on the opposite side of the secondary surface from the path's own primary vertex.
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
        // Where surfaces touch, the area pdfs are not finite. If their sum is infinite or 0, let only the path's own
        // pixel use the vertex.
        if !(area_pdf.is_finite() && area_pdf > 0.0) {
            viewers.list.iter_mut().flatten().for_each(|v| v.solid_angle_per_area = f32::from(v.number == owner));
            viewers.area_pdf = scattered.pdf;
        }
        viewers
    }

    /// Passes the light of the secondary vertex on to the observers of all its viewers.
    fn replay<W: ReplayObserver>(
        &self,
        world: &World,
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
            let SecondaryLight::ViewDependent { surface, light_sample, bsdf_sample } = &secondary.light else {
                observer.replay_from(primary.vertex.mesh, viewer.lobes, &scratch.tape, importance);
                continue;
            };
            observer.restart();
            observer.scatter(primary.vertex.mesh, ScatterKind::NonSpecular(viewer.pdf), viewer.lobes);
            let bsdf = surface.seen_from(world, -viewer.direction);
            if let Some((light, weight)) = light_sample {
                let (lobes, _) = bsdf.eval(light.direction);
                observer.take_panes(&scratch.panes);
                let importance = importance * lobes.sum() * *weight;
                observer.add(light.source, importance, light.emission, Strategy::LightSample { mesh, lobes });
            }
            if let Some((direction, pdf)) = bsdf_sample {
                let (lobes, _) = bsdf.eval(*direction);
                observer.scatter(mesh, ScatterKind::NonSpecular(*pdf), lobes);
                observer.replay(&scratch.tape, importance * lobes.sum() / *pdf);
            }
        }
    }
}
