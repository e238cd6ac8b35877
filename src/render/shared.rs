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

use super::bsdf::{Bsdf, Kind, Lobes};
use super::light::{LightSample, Receiver};
use super::path::{self, Found, Leg, Length, Observer, Seen};
use super::sampler::Sampler;
use super::vertex::{Surface, Vertex};
use super::world::{Pane, World};
use crate::scene::accel::Ray;
use glam::Vec3;

/// Most paths that share.
pub const MOST: usize = 8;

/// An observer of several paths that begin with the same first leg.
pub trait Witness: Observer {
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
    pub lighting: (f64, f32),
    pub length: Length,
    pub sampler: Sampler,
}

/// The first surface a path meets, where it takes part.
struct Sight<'w> {
    vertex: Vertex,
    bsdf: Bsdf<'w>,
    /// What light from the surfaces it sees is worth, as [`Length::worth`] has it.
    worth: Vec3,
    departure: Option<Departure>,
}

/// Where a path goes from there.
struct Departure {
    direction: Vec3,
    lobes: Lobes,
    density: f32,
    leg: Leg,
}

/// A point that a path has come to from there, and the light it has for all that see it.
struct Find<'w> {
    vertex: Vertex,
    light: Light<'w>,
}

enum Light<'w> {
    /// It sends the same to all.
    Alike,
    /// What it sends depends on who sees it.
    Turned {
        surface: Surface<'w>,
        /// A light, and what its emission counts for before it is scattered.
        chosen: Option<(LightSample, Vec3)>,
        /// Direction and density with which the path goes on.
        beyond: Option<(Vec3, f32)>,
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
    density: f32,
    /// Steradians it has of a square metre there.
    angle: f32,
}

/// Makes one estimate of the radiance along each of some rays. Each witness is told of its own.
pub fn trace<W: Witness>(world: &World, starts: &mut [Start], witnesses: &mut [W], scratch: &mut Scratch<W::Tape>) {
    let mut sights: [Option<Sight>; MOST] = [const { None }; MOST];
    for ((sight, start), witness) in sights.iter_mut().zip(&mut *starts).zip(&mut *witnesses) {
        *sight = look(world, start, witness);
    }
    // Light that any of them may see must not be given up because it means little to one.
    let worth = sights.iter().flatten().map(|s| s.worth).fold(Vec3::ZERO, Vec3::max);
    scratch.tape.expect(sights.iter().flatten().map(|s| (s.vertex.mesh, !s.bsdf.is_diffuse())));
    for number in 0..starts.len() {
        let departure = sights[number].as_mut().and_then(|s| s.departure.take());
        if let (Some(sight), Some(departure)) = (&sights[number], &departure)
            && let Some(find) =
                find(world, sight, departure, worth, &mut starts[number], &mut witnesses[number], scratch)
        {
            let viewers = Viewers::of(world, &find, number, departure, &sights);
            viewers.tell(&find, &sights, witnesses, scratch);
        }
    }
}

/// Follows a path to the first surface; one that takes no part to its end.
fn look<'w, W: Witness>(world: &'w World, start: &mut Start, witness: &mut W) -> Option<Sight<'w>> {
    let Start { ray, lighting, length, sampler } = start;
    let leg = Leg::from_eye(*ray, *lighting);
    let (vertex, distance) = path::arrive(world, &leg, sampler, witness)?;
    if length.most == 0 {
        return None;
    }
    let bsdf = vertex.bsdf(world, -leg.ray.direction);
    if !bsdf.is_shareable() {
        if let Some(next) = path::go_on(world, &leg, &vertex, distance, 0, length, sampler, witness) {
            path::walk(world, next, 1, *length, sampler, witness);
        }
        return None;
    }
    witness.meet(|| Seen::new(&vertex, &bsdf, distance));
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    if let Some(light) = path::choose_light(world, &receiver, &bsdf, leg.lighting) {
        path::add_light(world, &vertex, &bsdf, Vec3::ONE, &light, witness);
    }
    let departure = path::choose_direction(&bsdf, sampler).and_then(|(scattered, lighting)| {
        let Kind::Spread(density) = scattered.kind else { return None };
        let (direction, throughput) = (scattered.direction, scattered.weight);
        let rival = Some((receiver, density));
        let leg = Leg { ray: vertex.ray(direction), from: vertex.id, throughput, rival, lighting };
        let brings = throughput.is_finite() && throughput != Vec3::ZERO;
        brings.then_some(Departure { direction, lobes: scattered.lobes, density, leg })
    });
    let colour = bsdf.colour();
    let worth = colour * *length.worth.get_or_insert_with(|| path::reciprocal(colour));
    Some(Sight { vertex, bsdf, worth, departure })
}

/// Follows a path on to what it finds next. What is its own alone the witness is told of: light it meets there, and all
/// that comes of a point that takes no part.
fn find<'w, W: Witness>(
    world: &'w World,
    sight: &Sight,
    departure: &Departure,
    worth: Vec3,
    start: &mut Start,
    witness: &mut W,
    scratch: &mut Scratch<W::Tape>,
) -> Option<Find<'w>> {
    let Departure { direction, lobes, density, leg } = departure;
    let Start { length, sampler, .. } = start;
    witness.restart();
    witness.scatter(sight.vertex.mesh, Kind::Spread(*density), *lobes);
    let (vertex, distance) = path::arrive(world, leg, sampler, witness)?;
    if length.most == 1 {
        return None;
    }
    let surface = vertex.surface(world);
    let bsdf = surface.seen_from(-*direction);
    if !bsdf.is_shareable() || !sees_for_sure(world, sight, &vertex) {
        if let Some(next) = path::go_on(world, leg, &vertex, distance, 1, length, sampler, witness) {
            path::walk(world, next, 2, *length, sampler, witness);
        }
        return None;
    }
    // The path from there on is told of as if it began there.
    let length = Length { most: length.most, worth: Some(worth) };
    let light = if bsdf.looks_alike() {
        send_to_all(world, &vertex, &bsdf, leg.lighting, length, sampler, &mut scratch.tape)
    } else {
        send_to_each(world, &vertex, surface, &bsdf, leg.lighting, length, sampler, scratch)
    };
    light.map(|light| Find { vertex, light })
}

/// The light of a find that sends the same to all.
fn send_to_all<'w, T: Tape>(
    world: &World,
    vertex: &Vertex,
    bsdf: &Bsdf,
    lighting: (f64, f32),
    length: Length,
    sampler: &mut Sampler,
    tape: &mut T,
) -> Option<Light<'w>> {
    tape.begin();
    if let Some(next) = path::scatter(world, vertex, bsdf, Vec3::ONE, None, lighting, sampler, tape) {
        path::walk(world, next, 2, length, sampler, tape);
    }
    tape.end().then_some(Light::Alike)
}

/// The light of a find that sends to each what is theirs.
fn send_to_each<'w, T: Tape>(
    world: &World,
    vertex: &Vertex,
    surface: Surface<'w>,
    bsdf: &Bsdf,
    lighting: (f64, f32),
    length: Length,
    sampler: &mut Sampler,
    scratch: &mut Scratch<T>,
) -> Option<Light<'w>> {
    let Scratch { tape, panes } = scratch;
    tape.begin_behind(vertex.mesh);
    panes.clear();
    let receiver = Receiver { position: vertex.position, normal: bsdf.normal() };
    let light = path::choose_light(world, &receiver, bsdf, lighting).filter(|l| l.emission != Vec3::ZERO);
    let chosen = light.and_then(|light| {
        let (lobes, density) = bsdf.eval(light.direction);
        if lobes.sum() == Vec3::ZERO {
            return None;
        }
        let importance = path::reach(world, vertex, &light, density, Some(panes));
        (importance != Vec3::ZERO).then_some((light, importance))
    });
    let beyond = path::choose_direction(bsdf, sampler).and_then(|(scattered, lighting)| {
        let Kind::Spread(density) = scattered.kind else { return None };
        let leg = Leg {
            ray: vertex.ray(scattered.direction),
            from: vertex.id,
            throughput: Vec3::ONE,
            rival: Some((receiver, density)),
            lighting,
        };
        let length = Length { worth: length.worth.map(|worth| worth * scattered.weight), ..length };
        path::walk(world, leg, 2, length, sampler, tape);
        tape.end().then_some((scattered.direction, density))
    });
    let has_light = chosen.is_some() || beyond.is_some();
    has_light.then_some(Light::Turned { surface, chosen, beyond })
}

/// Whether nothing stands between, not even what lets light pass: a path that came that way came by chance, or met it.
fn sees(world: &World, from: &Vertex, to: &Vertex, direction: Vec3) -> bool {
    let origin = from.off_surface(direction);
    let target = to.off_surface(-direction);
    world.is_clear(&Ray { origin, direction: target - origin, t_max: 1.0 }, [from.id, to.id])
}

/// The same of a point that was found from there: nothing is to be asked where all surfaces are solid.
fn sees_for_sure(world: &World, sight: &Sight, found: &Vertex) -> bool {
    let direction = found.position - sight.vertex.position;
    !world.is_see_through() || sees(world, &sight.vertex, found, direction)
}

/// All that see a find.
struct Viewers {
    list: [Option<Viewer>; MOST],
    /// Sum of their densities per square metre.
    density: f32,
}

impl Viewers {
    fn of(world: &World, find: &Find, finder: usize, departure: &Departure, sights: &[Option<Sight>; MOST]) -> Self {
        let surface = &find.vertex;
        let angle = |from: &Vertex, cosine: f32| cosine.abs() / from.position.distance_squared(surface.position);
        let cosine = surface.normal.dot(departure.direction);
        let list = std::array::from_fn(|number| {
            let sight = sights[number].as_ref()?;
            if number == finder {
                let Departure { direction, lobes, density, .. } = *departure;
                return Some(Viewer { number, direction, lobes, density, angle: angle(&sight.vertex, cosine) });
            }
            let direction = (surface.position - sight.vertex.position).normalize_or_zero();
            let theirs = surface.normal.dot(direction);
            // They must be on the same side of it.
            if !(theirs * cosine > 0.0) {
                return None;
            }
            let (lobes, density) = sight.bsdf.eval(direction);
            let sees = density > 0.0 && sees(world, &sight.vertex, surface, direction);
            sees.then_some(Viewer { number, direction, lobes, density, angle: angle(&sight.vertex, theirs) })
        });
        let density = list.iter().flatten().map(|v: &Viewer| v.density * v.angle).sum();
        let mut viewers = Self { list, density };
        // Points of surfaces that touch are the finder's own.
        if !(density.is_finite() && density > 0.0) {
            viewers.list.iter_mut().flatten().for_each(|v| v.angle = f32::from(v.number == finder));
            viewers.density = departure.density;
        }
        viewers
    }

    /// Tells the witnesses what light they get from it.
    fn tell<W: Witness>(
        &self,
        find: &Find,
        sights: &[Option<Sight>; MOST],
        witnesses: &mut [W],
        scratch: &Scratch<W::Tape>,
    ) {
        let mesh = find.vertex.mesh;
        for viewer in self.list.iter().flatten() {
            let (Some(sight), witness) = (&sights[viewer.number], &mut witnesses[viewer.number]) else { continue };
            let importance = viewer.lobes.sum() * (viewer.angle / self.density);
            let Light::Turned { surface, chosen, beyond } = &find.light else {
                witness.replay_from(sight.vertex.mesh, viewer.lobes, &scratch.tape, importance);
                continue;
            };
            witness.restart();
            witness.scatter(sight.vertex.mesh, Kind::Spread(viewer.density), viewer.lobes);
            let bsdf = surface.seen_from(-viewer.direction);
            if let Some((light, reach)) = chosen {
                let (lobes, _) = bsdf.eval(light.direction);
                witness.take_panes(&scratch.panes);
                let importance = importance * lobes.sum() * *reach;
                witness.add(light.source, importance, light.emission, Found::Chosen { mesh, lobes });
            }
            if let Some((direction, density)) = beyond {
                let (lobes, _) = bsdf.eval(*direction);
                witness.scatter(mesh, Kind::Spread(*density), lobes);
                witness.replay(&scratch.tape, importance * lobes.sum() / *density);
            }
        }
    }
}
