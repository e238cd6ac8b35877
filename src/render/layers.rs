//! Layers: images that are rendered beside the main image, by light path expressions (`lpe`) or from surface
//! attributes (`aov`).
//!
//! Layers use the paths of the main image and do not change the main image by a single bit. A recorder sums the paths
//! of a pass in f64. The totals of a pixel are in f32 and grow from pass to pass.

use super::aov::{Aov, SurfaceSums};
use super::bsdf::{Lobes, ScatterKind};
use super::contribution::LightSource;
use super::lpe::{Automaton, EmitterAs, Expression, PathTracker};
use super::path::{Observer, PrimaryHit, Strategy};
use super::shared::MAX_SHARED;
use super::world::{Pane, World};
use crate::error::{Error, Result};
use crate::exec;
use crate::image::{Image, colour, try_collect, try_vec, try_with_capacity};
use crate::job::Job;
use crate::scene::Camera;
use glam::{DVec3, Vec3};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The sums of all layers over the paths of a tile (the totals), pixel after pixel, locked for one worker.
pub type TileTotals<'a> = MutexGuard<'a, Vec<f32>>;

/// Longest name of a layer in bytes (`MAX_NAME_BYTES`), and largest number of light path expressions (`MAX_LAYERS`).
/// [convention]
const MAX_NAME_BYTES: usize = 64;
const MAX_LAYERS: usize = 1024;

/// The layers to render beside the main image; none by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Light path expressions, each with the name of its layer.
    pub expressions: Vec<(String, Expression)>,
    pub emitter_as: EmitterAs,
    /// Surface attributes, each of which becomes a layer.
    pub aovs: Vec<Aov>,
}

impl Outputs {
    /// Adds a light path expression as a layer.
    ///
    /// # Errors
    /// A name that is empty, too long, taken, or contains characters that file formats interpret (dots, quotes,
    /// control characters); an invalid expression.
    pub fn add(&mut self, name: &str, expression: &str) -> Result<()> {
        let unfit = |c: char| c == '.' || c == '"' || c.is_control();
        if name.is_empty() || name.len() > MAX_NAME_BYTES || name.contains(unfit) {
            return Err(Error::argument(format!(
                "the layer's name is {name:?}; it must have 1 to {MAX_NAME_BYTES} bytes, without dots, quotes or control \
                 characters"
            )));
        }
        let taken = self.expressions.iter().map(|(n, _)| n.as_str()).chain(Aov::ALL.map(Aov::name));
        if taken.chain(["Combined", "Variance"]).any(|n| n == name) {
            return Err(Error::argument(format!("there is a layer called {name:?} already; choose another name")));
        }
        if self.expressions.len() >= MAX_LAYERS {
            return Err(Error::argument(format!("there are {MAX_LAYERS} layers already; no more are possible")));
        }
        self.expressions.push((name.to_string(), Expression::parse(expression)?));
        Ok(())
    }
}

/// A layer: an image that was rendered beside the main image.
#[derive(Clone, Debug)]
pub struct Layer {
    pub name: String,
    /// Names of the image's channels in files.
    pub channels: &'static [&'static str],
    /// Text of the layer's light path expression; `None` for a surface attribute.
    pub expression: Option<String>,
    pub image: Image,
}

/// The totals of all layers so far, stored tile by tile like the pixels of the main image.
pub struct Layers<'a> {
    pub(super) world: &'a World,
    outputs: &'a Outputs,
    /// Position of the camera in world coordinates (`eye`), and its unit viewing direction (`forward`).
    eye: Vec3,
    forward: Vec3,
    pub(super) automaton: Automaton,
    /// How many totals are stored per pixel.
    width: usize,
    /// Totals of each tile. Only one worker at a time processes a tile, so no lock ever waits.
    tiles: Vec<Mutex<Vec<f32>>>,
}

impl<'a> Layers<'a> {
    /// Returns `None` if only the main image is to be rendered.
    pub fn new(
        world: &'a World,
        camera: &Camera,
        outputs: &'a Outputs,
        tiles: usize,
        tile_pixels: usize,
    ) -> Result<Option<Self>> {
        if outputs.expressions.is_empty() && outputs.aovs.is_empty() {
            return Ok(None);
        }
        let expressions: Vec<&Expression> = outputs.expressions.iter().map(|(_, e)| e).collect();
        let automaton = Automaton::new(world.scene(), &expressions, outputs.emitter_as)?;
        let surfaces = 1 + outputs.aovs.iter().map(|a| a.total_count()).sum::<usize>();
        let width = 3 * expressions.len() + if outputs.aovs.is_empty() { 0 } else { surfaces };
        let mut totals = try_with_capacity(tiles)?;
        for _ in 0..tiles {
            totals.push(Mutex::new(try_vec(width * tile_pixels, 0.0)?));
        }
        let (eye, forward) = (world.from_scene(camera.position), camera.forward.normalize_or_zero());
        Ok(Some(Self { world, outputs, eye, forward, automaton, width, tiles: totals }))
    }

    /// Locks the totals of a tile.
    pub fn totals(&self, tile: usize) -> TileTotals<'_> {
        self.tiles[tile].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sets the totals of a pixel from the f64 sums of [`Recorder::add_to`].
    pub fn set_totals(&self, tile: usize, pixel: usize, sums: &[f64]) {
        let mut totals = self.totals(tile);
        let (colours, surfaces) =
            totals[pixel * self.width..][..self.width].split_at_mut(3 * self.outputs.expressions.len());
        let (light, sums) = sums.split_at(colours.len());
        colours.iter_mut().zip(light).for_each(|(total, &sum)| *total = sum as f32);
        if let (Some((hits, mut totals)), Some((hit_count, mut sums))) =
            (surfaces.split_first_mut(), sums.split_first())
        {
            *hits = *hit_count as f32;
            for aov in &self.outputs.aovs {
                let (of_sums, of_totals);
                (of_totals, totals) = totals.split_at_mut(aov.total_count());
                (of_sums, sums) = sums.split_at(aov.sum_count());
                aov.set_totals(of_sums, of_totals);
            }
        }
    }

    /// Returns the number of f64 sums per pixel that [`Recorder::add_to`] writes.
    pub fn sum_count(&self) -> usize {
        let Outputs { expressions, aovs, .. } = self.outputs;
        3 * expressions.len() + if aovs.is_empty() { 0 } else { 1 + aovs.iter().map(|a| a.sum_count()).sum::<usize>() }
    }

    /// Adds `others`, the sums over other paths of the same pixel, to `sums`.
    pub fn join_sums(&self, sums: &mut [f64], others: &[f64]) {
        let plain = 3 * self.outputs.expressions.len() + usize::from(!self.outputs.aovs.is_empty());
        let (light, mut sums) = sums.split_at_mut(plain);
        let (other_light, mut others) = others.split_at(plain);
        light.iter_mut().zip(other_light).for_each(|(sum, other)| *sum += other);
        for aov in &self.outputs.aovs {
            let (into, from);
            (into, sums) = sums.split_at_mut(aov.sum_count());
            (from, others) = others.split_at(aov.sum_count());
            aov.join_sums(into, from);
        }
    }

    /// Returns a recorder, which records one path at a time.
    pub fn recorder(&self) -> Recorder<'_> {
        Recorder {
            layers: self,
            beauty: Vec3::ZERO,
            tracker: PathTracker::new(&self.automaton),
            sums: vec![DVec3::ZERO; self.automaton.lists().len()],
            surfaces: SurfaceSums::default(),
        }
    }

    /// Returns a recorder for each pixel of a block.
    pub fn recorders(&self) -> Vec<Recorder<'_>> {
        (0..MAX_SHARED).map(|_| self.recorder()).collect()
    }

    /// Computes the images of all layers from the totals so far. For each pixel of the image, `places` holds the
    /// rendered pixel to display there: its tile, its index within the tile, and its number of samples.
    pub fn images(&self, beauty: &Image, places: &[(u32, u32, u32)], job: Job) -> Result<Vec<Layer>> {
        let guards = try_collect(self.tiles.iter().map(|t| t.lock().unwrap_or_else(PoisonError::into_inner)))?;
        let tiles = try_collect(guards.iter().map(|guard| guard.as_slice()))?;
        let sums =
            |&(tile, pixel, _): &(u32, u32, u32)| &tiles[tile as usize][pixel as usize * self.width..][..self.width];
        let row = |y: usize| places[y * beauty.width..][..beauty.width].iter();
        let mut layers = Vec::new();
        for (number, (name, expression)) in self.outputs.expressions.iter().enumerate() {
            let mut image = Image::new(beauty.width, beauty.height, 3)?;
            exec::for_rows(&mut image.data, beauty.width * 3, job, |y, out| {
                for (out, place) in out.chunks_exact_mut(3).zip(row(y)) {
                    let sum = Vec3::from_slice(&sums(place)[3 * number..][..3]);
                    (sum / place.2.max(1) as f32).write_to_slice(out);
                }
            })?;
            let expression = Some(expression.text().to_string());
            layers.push(Layer { name: name.clone(), channels: &["R", "G", "B"], expression, image });
        }
        // In the totals of a pixel, the expressions come first, then the number of primary hits, then the attributes.
        let hits = 3 * self.outputs.expressions.len();
        let mut first = hits + 1;
        for &aov in &self.outputs.aovs {
            let channels = aov.channels().len();
            let mut image = Image::new(beauty.width, beauty.height, channels)?;
            exec::for_rows(&mut image.data, beauty.width * channels, job, |y, out| {
                for (x, (out, place)) in out.chunks_exact_mut(channels).zip(row(y)).enumerate() {
                    if aov == Aov::Luminance {
                        out[0] = colour::luminance(beauty.rgb(x, y));
                        continue;
                    }
                    let sums = sums(place);
                    let (samples, hit_count) = (f64::from(place.2.max(1)), f64::from(sums[hits]));
                    aov.value(&sums[first..][..aov.total_count()], hit_count, samples, out);
                    if aov == Aov::Position && hit_count > 0.0 {
                        self.world.in_scene(Vec3::from_slice(out)).write_to_slice(out);
                    }
                }
            })?;
            layers.push(Layer { name: aov.name().into(), channels: aov.channels(), expression: None, image });
            first += aov.total_count();
        }
        Ok(layers)
    }
}

/// Adds up the light and the surface attributes of the paths of a pixel, one path after the other.
pub struct Recorder<'a> {
    layers: &'a Layers<'a>,
    /// Radiance of the current path in the main image, so far.
    pub(super) beauty: Vec3,
    pub(super) tracker: PathTracker<'a>,
    /// Sums of the light of the pixel's paths. Each list in [`Automaton::lists`] has a sum: the light that matches
    /// exactly the expressions on the list.
    sums: Vec<DVec3>,
    surfaces: SurfaceSums,
}

impl Recorder<'_> {
    /// Begins a path.
    #[inline]
    pub fn start(&mut self) {
        self.beauty = Vec3::ZERO;
        self.tracker.start();
    }

    /// Ends the path, adds its light to the sums and returns its radiance in the main image. A path whose radiance is
    /// not finite adds no light.
    #[inline]
    pub fn end_path(&mut self) -> Vec3 {
        if self.beauty.is_finite() {
            self.tracker.end(|list, light| self.sums[list] += light.as_dvec3());
        }
        self.beauty
    }

    /// Adds the recorded sums to the totals of a pixel of the tile, and clears the recorded sums.
    pub fn add_to_totals(&mut self, totals: &mut TileTotals, pixel: usize) {
        let Self { layers, sums, .. } = self;
        let (colours, surfaces) =
            totals[pixel * layers.width..][..layers.width].split_at_mut(3 * layers.outputs.expressions.len());
        let (colours, _) = colours.as_chunks_mut::<3>();
        // A list names the expressions that share a sum. Add each sum to the totals of all expressions on its list.
        let lists = layers.automaton.lists().iter().zip(sums);
        for (list, sum) in lists.filter(|(_, sum)| **sum != DVec3::ZERO) {
            let light = sum.as_vec3();
            for &expression in list {
                let total = &mut colours[usize::from(expression)];
                *total = (Vec3::from(*total) + light).into();
            }
            *sum = DVec3::ZERO;
        }
        if let Some((hits, mut rest)) = surfaces.split_first_mut() {
            *hits += self.surfaces.hits as f32;
            for aov in &layers.outputs.aovs {
                let totals;
                (totals, rest) = rest.split_at_mut(aov.total_count());
                self.surfaces.add_to_totals(*aov, totals);
            }
            self.surfaces = SurfaceSums::default();
        }
    }

    /// Adds the recorded sums of a pixel to f64 totals, and clears the recorded sums. The totals have three numbers
    /// per expression, then the number of primary hits, then [`Aov::sum_count`] numbers per surface attribute.
    pub fn add_to(&mut self, totals: &mut [f64]) {
        let Self { layers, sums, .. } = self;
        let (colours, surfaces) = totals.split_at_mut(3 * layers.outputs.expressions.len());
        let (colours, _) = colours.as_chunks_mut::<3>();
        let lists = layers.automaton.lists().iter().zip(sums);
        for (list, sum) in lists.filter(|(_, sum)| **sum != DVec3::ZERO) {
            for &expression in list {
                let total = &mut colours[usize::from(expression)];
                *total = (DVec3::from(*total) + *sum).into();
            }
            *sum = DVec3::ZERO;
        }
        if let Some((hits, mut rest)) = surfaces.split_first_mut()
            && self.surfaces.hits > 0
        {
            *hits += f64::from(self.surfaces.hits);
            for aov in &layers.outputs.aovs {
                let total;
                (total, rest) = rest.split_at_mut(aov.sum_count());
                self.surfaces.add_to(*aov, total);
            }
            self.surfaces = SurfaceSums::default();
        }
    }
}

impl Observer for Recorder<'_> {
    #[inline(always)]
    fn add(&mut self, source: LightSource, importance: Vec3, emission: Vec3, strategy: Strategy) {
        let contribution = importance * emission;
        self.beauty += contribution;
        self.tracker.add(self.layers.world, contribution.into(), source, strategy);
    }

    #[inline]
    fn primary_hit(&mut self, seen: impl FnOnce() -> PrimaryHit) {
        if self.layers.outputs.aovs.is_empty() {
            return;
        }
        let seen = seen();
        let depth = (seen.position - self.layers.eye).dot(self.layers.forward);
        self.surfaces.add(self.layers.world, &seen, depth);
    }

    #[inline]
    fn scatter(&mut self, mesh: u32, kind: ScatterKind, lobes: Lobes) {
        self.tracker.scatter(mesh, kind, lobes);
    }

    #[inline]
    fn panes(&mut self) -> Option<&mut Vec<Pane>> {
        self.tracker.panes_wanted()
    }
}
