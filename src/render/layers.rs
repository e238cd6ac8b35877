//! Images beside the main one: light that came by certain ways (`lpe`), and what the camera sees of surfaces (`aov`).
//!
//! They are made of the very paths the main image is made of, and never change a bit of it. Sums of a pass are in f64 and
//! are added to those kept of a pixel, in f32, pass by pass.

use super::LightSource;
use super::aov::{Aov, Surfaces};
use super::bsdf::{Bsdf, Lobes, Scattered};
use super::light::LightSample;
use super::lpe::{EmitterAs, Expression, Table, Trail};
use super::path::Observer;
use super::vertex::Vertex;
use super::world::{Pane, World};
use crate::error::{Error, Result};
use crate::image::{Image, colour, try_vec};
use crate::scene::Camera;
use glam::{DVec3, Vec3};
use std::sync::{Mutex, PoisonError};

/// Longest name of a layer, and the most layers.
const LONGEST_NAME: usize = 64;
const MOST_LAYERS: usize = 1024;

/// What to render beside the main image; nothing by default.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outputs {
    /// Images of light, each a name and an expression.
    pub expressions: Vec<(String, Expression)>,
    pub emitter_as: EmitterAs,
    /// Images of surfaces.
    pub aovs: Vec<Aov>,
}

impl Outputs {
    /// Adds an image of light.
    ///
    /// # Errors
    /// A name that is empty, too long, taken, or contains what file formats give a meaning: dots, quotes, control
    /// characters; an expression that is none.
    pub fn add(&mut self, name: &str, expression: &str) -> Result<()> {
        let unfit = |c: char| c == '.' || c == '"' || c.is_control();
        if name.is_empty() || name.len() > LONGEST_NAME || name.contains(unfit) {
            return Err(Error::argument(format!(
                "the layer's name is {name:?}; it must have 1 to {LONGEST_NAME} bytes, without dots, quotes or control \
                 characters"
            )));
        }
        let taken = self.expressions.iter().map(|(n, _)| n.as_str()).chain(Aov::ALL.map(Aov::name));
        if taken.chain(["Combined", "Variance"]).any(|n| n == name) {
            return Err(Error::argument(format!("there is a layer called {name:?} already; choose another name")));
        }
        if self.expressions.len() >= MOST_LAYERS {
            return Err(Error::argument(format!("there are {MOST_LAYERS} layers already; no more are possible")));
        }
        self.expressions.push((name.to_string(), Expression::parse(expression)?));
        Ok(())
    }
}

/// An image beside the main one.
#[derive(Clone, Debug)]
pub struct Layer {
    pub name: String,
    /// Letters of its channels, as files have them.
    pub channels: &'static [&'static str],
    /// The expression it was made by, if by one.
    pub expression: Option<String>,
    pub image: Image,
}

/// The sums of all layers so far, tile by tile as those of the main image.
pub struct Layers<'a> {
    outputs: &'a Outputs,
    camera: &'a Camera,
    table: Table,
    /// Numbers kept of a pixel.
    width: usize,
    /// Each tile is in the hands of one worker at a time; the locks never wait.
    tiles: Vec<Mutex<Vec<f32>>>,
}

impl<'a> Layers<'a> {
    /// None where there is nothing to render but the main image.
    pub fn new(
        world: &World,
        camera: &'a Camera,
        outputs: &'a Outputs,
        tiles: usize,
        tile_pixels: usize,
    ) -> Result<Option<Self>> {
        if outputs.expressions.is_empty() && outputs.aovs.is_empty() {
            return Ok(None);
        }
        let expressions: Vec<&Expression> = outputs.expressions.iter().map(|(_, e)| e).collect();
        let table = Table::new(world.scene(), &expressions, outputs.emitter_as)?;
        let surfaces = 1 + outputs.aovs.iter().map(|a| a.kept()).sum::<usize>();
        let width = 3 * expressions.len() + if outputs.aovs.is_empty() { 0 } else { surfaces };
        let tiles = (0..tiles).map(|_| Ok(Mutex::new(try_vec(width * tile_pixels, 0.0)?))).collect::<Result<_>>()?;
        Ok(Some(Self { outputs, camera, table, width, tiles }))
    }

    pub fn recorder<'b>(&'b self, world: &'b World) -> Recorder<'b> {
        Recorder {
            world,
            layers: self,
            beauty: Vec3::ZERO,
            trail: Trail::new(&self.table),
            path: vec![Vec3::ZERO; self.outputs.expressions.len()],
            sums: vec![DVec3::ZERO; self.outputs.expressions.len()],
            surfaces: Surfaces::default(),
        }
    }

    /// Adds what a recorder has gathered to a pixel's sums, and leaves it empty.
    pub fn keep(&self, recorder: &mut Recorder, tile: usize, pixel: usize) {
        let mut tile = self.tiles[tile].lock().unwrap_or_else(PoisonError::into_inner);
        let (colours, surfaces) = tile[pixel * self.width..][..self.width].split_at_mut(3 * recorder.sums.len());
        for (kept, sum) in colours.chunks_exact_mut(3).zip(&mut recorder.sums) {
            kept.iter_mut().zip(sum.as_vec3().to_array()).for_each(|(k, s)| *k += s);
            *sum = DVec3::ZERO;
        }
        if let Some((hits, mut rest)) = surfaces.split_first_mut() {
            *hits += recorder.surfaces.hits as f32;
            for aov in &self.outputs.aovs {
                let kept;
                (kept, rest) = rest.split_at_mut(aov.kept());
                recorder.surfaces.keep(*aov, kept);
            }
            recorder.surfaces = Surfaces::default();
        }
    }

    /// The images so far. `pixels` yields, row by row, the tile of each pixel, its place there, and its samples.
    pub fn images(&self, beauty: &Image, place: impl Fn(usize, usize) -> (usize, usize, f64)) -> Result<Vec<Layer>> {
        let mut layers = Vec::new();
        let rgb: &[&str] = &["R", "G", "B"];
        for (name, expression) in &self.outputs.expressions {
            let image = Image::new(beauty.width, beauty.height, 3)?;
            layers.push(Layer { name: name.clone(), channels: rgb, expression: Some(expression.text().into()), image });
        }
        for aov in &self.outputs.aovs {
            let image = Image::new(beauty.width, beauty.height, aov.channels().len())?;
            layers.push(Layer { name: aov.name().into(), channels: aov.channels(), expression: None, image });
        }
        let expressions = self.outputs.expressions.len();
        for y in 0..beauty.height {
            for x in 0..beauty.width {
                let (tile, pixel, samples) = place(x, y);
                let tile = self.tiles[tile].lock().unwrap_or_else(PoisonError::into_inner);
                let (colours, surfaces) = tile[pixel * self.width..][..self.width].split_at(3 * expressions);
                let samples = samples.max(1.0);
                for (layer, sum) in layers.iter_mut().zip(colours.chunks_exact(3)) {
                    let out = layer.image.pixel_mut(x, y);
                    out.iter_mut().zip(sum).for_each(|(o, s)| *o = (f64::from(*s) / samples) as f32);
                }
                let Some((&hits, mut rest)) = surfaces.split_first() else { continue };
                for (layer, aov) in layers[expressions..].iter_mut().zip(&self.outputs.aovs) {
                    let kept;
                    (kept, rest) = rest.split_at(aov.kept());
                    let out = layer.image.pixel_mut(x, y);
                    aov.value(kept, f64::from(hits), samples, out);
                    if *aov == Aov::Luminance {
                        out[0] = colour::luminance(beauty.rgb(x, y));
                    }
                }
            }
        }
        Ok(layers)
    }
}

/// Follows the paths of a pixel.
pub struct Recorder<'a> {
    world: &'a World,
    layers: &'a Layers<'a>,
    /// Sum of the contributions of one path, as the main image has it.
    beauty: Vec3,
    trail: Trail<'a>,
    /// The same for each expression.
    path: Vec<Vec3>,
    /// Sums over the paths.
    sums: Vec<DVec3>,
    surfaces: Surfaces,
}

impl Recorder<'_> {
    /// A new path begins.
    pub fn start(&mut self) {
        self.beauty = Vec3::ZERO;
        self.path.fill(Vec3::ZERO);
        self.trail.start();
    }

    /// Ends the path; returns what it has brought to the main image. One that is no finite number counts nowhere.
    pub fn finish(&mut self) -> Vec3 {
        if self.beauty.is_finite() {
            self.sums.iter_mut().zip(&self.path).for_each(|(sum, path)| *sum += path.as_dvec3());
        }
        self.beauty
    }
}

impl Observer for Recorder<'_> {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.beauty += importance * emission;
    }

    fn meet(&mut self, vertex: &Vertex, bsdf: &Bsdf, distance: f32) {
        if self.layers.outputs.aovs.is_empty() {
            return;
        }
        let camera = self.layers.camera;
        let depth = (vertex.position - camera.position).dot(camera.forward.normalize_or_zero());
        self.surfaces.meet(self.world, vertex, bsdf, distance, depth);
    }

    fn survive(&mut self, chance: f32) {
        self.trail.survive(chance);
    }

    fn scatter(&mut self, mesh: u32, scattered: &Scattered) {
        self.trail.scatter(mesh, scattered);
    }

    fn panes(&mut self) -> Option<&mut Vec<Pane>> {
        Some(&mut self.trail.panes)
    }

    fn connect(&mut self, mesh: u32, lobes: Lobes, factor: f32, light: &LightSample) {
        self.trail.connect(self.world, mesh, lobes, light.emission * factor, light.source, &mut self.path);
    }

    fn arrive(&mut self, source: LightSource, weight: f32, emission: Vec3) {
        self.trail.arrive(source, emission * weight, &mut self.path);
    }
}
