//! What reaches the camera: the room's light, rendered, and for each pixel what it shows.

use super::room::{Class, Room};
use super::viewpoint::{Shot, Surfaces};
use glam::{DVec2, Vec2, Vec3};
use luxfer::exec;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::render::{self, Aov, Film, Outputs, World, denoise};
use std::sync::Arc;

/// Paths per pixel of each of the two pictures that the noise filter works from.
const PATHS: u32 = 2;
/// Share of the light after which paths end: rooms come out a little darker than they would be.
const MAX_LOST: f32 = 0.15;
/// How strongly noise is smoothed.
const SMOOTHING: f32 = 1.5;
/// Rays across and down a pixel that shows more than one thing. [convention]
const FINE: usize = 5;

/// No lamp.
pub const NO_LAMP: u16 = u16::MAX;

/// The light that reaches the camera's lens, in cd/m², and what each pixel shows most of.
pub struct Exposure {
    pub light: Image,
    pub classes: Vec<u8>,
    /// Number of the fitting, or [`NO_LAMP`].
    pub lamps: Vec<u16>,
}

impl Exposure {
    pub fn of(room: &Room, surfaces: &Surfaces, shot: &Shot, seed: u64) -> Self {
        let mut light = scattered(room, shot, seed);
        let whole = shown(room, surfaces, shot);
        for (pixel, shown) in light.data.chunks_exact_mut(3).zip(&whole) {
            (Vec3::from_slice(pixel) + shown.emission).write_to_slice(pixel);
        }
        let classes = whole.iter().map(|shown| shown.class).collect();
        Self { light, classes, lamps: whole.iter().map(|shown| shown.lamp).collect() }
    }
}

/// Light that surfaces send on: all but what comes straight from lamps, whose edges few paths would fray.
fn scattered(room: &Room, shot: &Shot, seed: u64) -> Image {
    let monitor = Monitor::default();
    let world = World::build(Arc::new(room.scene.clone()), monitor.job()).expect("a world");
    let film = |half: u64| {
        let mut outputs = Outputs::default();
        outputs.add("scattered", "C.+L").expect("an expression");
        outputs.aovs = vec![Aov::Position, Aov::Normal, Aov::Albedo];
        let params = render::Params {
            width: shot.width,
            height: shot.height,
            samples: PATHS,
            bounce_error: MAX_LOST,
            seed: 2 * seed + half,
            outputs,
            ..render::Params::default()
        };
        render::run(&world, &shot.camera, &params, monitor.job(), &mut |_| {}).expect("a picture")
    };
    let (one, other) = (film(0), film(1));
    let light = |film: &Film, layer: usize| film.layers[layer].image.clone();
    let halves = [light(&one, 0), light(&other, 0)];
    // Half the squared difference of two estimates is the variance of one, a quarter that of their mean.
    let mut variance = halves[0].clone();
    variance.data.iter_mut().zip(&halves[1].data).for_each(|(a, b)| *a = (*a - b).powi(2) / 4.0);
    let mean = |layer: usize| {
        let mut mean = light(&one, layer);
        mean.data.iter_mut().zip(&other.layers[layer].image.data).for_each(|(a, b)| *a = (*a + b) / 2.0);
        mean
    };
    let (position, normal, albedo) = (mean(1), mean(2), mean(3));
    let input = denoise::Input {
        halves: [&halves[0], &halves[1]],
        variance: &variance,
        albedo: &albedo,
        normal: &normal,
        position: &position,
    };
    denoise::run(&input, &denoise::Params { strength: SMOOTHING }, monitor.job()).expect("a smooth picture").image
}

/// What a pixel shows.
#[derive(Clone, Copy)]
struct Shown {
    /// Of surfaces that shine, the mean over the pixel.
    emission: Vec3,
    class: u8,
    lamp: u16,
}

fn shown(room: &Room, surfaces: &Surfaces, shot: &Shot) -> Vec<Shown> {
    let (width, height) = (shot.width, shot.height);
    let job = Monitor::default();
    let centre = |i: usize| DVec2::new((i % width) as f64 + 0.5, (i / width) as f64 + 0.5);
    let meshes: Vec<u32> =
        exec::map(width * height, job.job(), |i| mesh_at(surfaces, shot, centre(i))).expect("the meshes seen");
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let neighbours = [(x.saturating_sub(1), y), (x + 1, y), (x, y.saturating_sub(1)), (x, y + 1)];
        let differs = |&(x, y): &(usize, usize)| meshes[y.min(height - 1) * width + x.min(width - 1)] != meshes[i];
        let shines = |mesh: u32| room.scene.materials[room.scene.meshes[mesh as usize].material].emission != Vec3::ZERO;
        let fine = if neighbours.iter().any(differs) || shines(meshes[i]) { FINE } else { 1 };
        let at = |k: usize| {
            let step = DVec2::new((k % fine) as f64 + 0.5, (k / fine) as f64 + 0.5) / fine as f64;
            sample(room, surfaces, shot, DVec2::new(x as f64, y as f64) + step)
        };
        let samples: Vec<Shown> = (0..fine * fine).map(at).collect();
        let emission = samples.iter().map(|s| s.emission).sum::<Vec3>() / samples.len() as f32;
        let most = |of: &dyn Fn(&Shown) -> (u8, u16)| {
            let count = |value: (u8, u16)| samples.iter().filter(|s| of(s) == value).count();
            samples.iter().map(of).max_by_key(|value| (count(*value), *value)).expect("a sample")
        };
        // A pixel is a lamp's where lamps cover half of it.
        let lit = samples.iter().filter(|s| s.lamp != NO_LAMP).count() * 2 >= samples.len();
        let (class, lamp) = most(&|s| if (s.lamp != NO_LAMP) == lit { (s.class, s.lamp) } else { (0, 0) });
        let (class, lamp) = if class == 0 { (samples[0].class, samples[0].lamp) } else { (class, lamp) };
        Shown { emission, class, lamp }
    };
    exec::map(width * height, job.job(), pixel).expect("what is seen")
}

fn mesh_at(surfaces: &Surfaces, shot: &Shot, at: DVec2) -> u32 {
    surfaces.seen(shot.camera.position, shot.direction(at)).map_or(0, |seen| seen.mesh as u32)
}

fn sample(room: &Room, surfaces: &Surfaces, shot: &Shot, at: DVec2) -> Shown {
    let direction = shot.direction(at);
    let Some(seen) = surfaces.seen(shot.camera.position, direction) else {
        return Shown { emission: Vec3::ZERO, class: Class::Wall as u8, lamp: NO_LAMP };
    };
    let mesh = &room.scene.meshes[seen.mesh];
    let (class, number) = room.classes[seen.mesh];
    let material = &room.scene.materials[mesh.material];
    let [a, b, c] = mesh.corners(seen.triangle);
    let faces = (b - a).cross(c - a).dot(direction) < 0.0;
    let mut emission = if faces || material.double_sided { material.emission } else { Vec3::ZERO };
    if let Some(map) = material.emission_texture {
        let [p, q, r] = mesh.triangles[seen.triangle].map(|i| mesh.uvs[0][i as usize]);
        let uv: Vec2 = p + (q - p) * seen.barycentric.x + (r - p) * seen.barycentric.y;
        emission *= room.scene.textures[map.texture].sample(uv).truncate();
    }
    Shown { emission, class: class as u8, lamp: if class == Class::Lamp { number as u16 } else { NO_LAMP } }
}
