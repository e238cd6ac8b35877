//! Benchmark of many lights: the error of irradiance at equal time against the number of lamps, once with separate
//! meshes as lamps and once with spots of one emission texture, at equal total flux. Also the time to prepare the
//! lights of a scene. One thread.
//!
//! The room is 30 × 30 × 4 m with grey walls. The error is the relative standard deviation of single paths, over
//! points of the whole floor. At equal time it is proportional to the square root of the variance times the time of a
//! path.

mod harness;

use glam::{Vec2, Vec3};
use harness::plot::Plot;
use harness::{Clock, Table, figure, time};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::render::{self, LightSource, PathSink, SurfacePoint, World};
use luxfer::rng::Rng;
use luxfer::scene::{Material, Mesh, Scene, Texture, TextureRef};
use std::sync::Arc;

const SIDE: f32 = 30.0;
const HEIGHT: f32 = 4.0;
/// Share of the ceiling's area that emits light.
const LIT: f32 = 0.01;
/// Number of texels along a side of the emission texture with lamps.
const TEXELS: usize = 2048;
const POINTS: u32 = 64;
const PATHS: u32 = 1024;
const ROUNDS: u64 = 3;

/// Sums the radiance of one path, in the green channel.
#[derive(Default)]
struct Path(f64);

impl PathSink for Path {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.0 += f64::from(importance.y * emission.y);
    }
}

struct Measured {
    seconds_per_path: f64,
    /// Variance of the radiance of a path, divided by the square of the mean.
    variance: f64,
}

impl Measured {
    /// Error of this measurement at equal time, divided by the error of `other`.
    fn error_over(&self, other: &Self) -> f64 {
        (self.variance * self.seconds_per_path / (other.variance * other.seconds_per_path)).sqrt()
    }
}

fn main() {
    let pool = Pool::new(1).expect("a thread");
    let mut plot =
        Plot::new("Irradiance in a hall under n lamps of the same total flux", "lamps", "error at equal time");
    for (kind, counts, scene) in [
        ("mesh", &[1usize, 10, 100, 1_000, 10_000, 100_000][..], mesh_lamps as fn(usize) -> Scene),
        ("texture", &[1, 10, 100, 1_000, 10_000][..], texture_lamps),
    ] {
        let mut table = Table::new(["lamps", "build ms", "us per path", "variance", "error at equal time"]);
        let worlds: Vec<(f64, World)> = counts.iter().map(|&n| build(scene(n))).collect();
        // Measure the scenes in turns, so that other work on the machine affects all of them equally.
        let mut measured: Vec<Vec<Measured>> = worlds.iter().map(|_| Vec::new()).collect();
        for round in 0..ROUNDS {
            for (world, results) in worlds.iter().zip(&mut measured) {
                results.push(pool.run(|| measure(&world.1, round)));
            }
        }
        let mut points = Vec::new();
        for (i, &count) in counts.iter().enumerate() {
            let median =
                |of: &dyn Fn(&Measured) -> f64| harness::median(&measured[i].iter().map(of).collect::<Vec<_>>());
            let ratios: Vec<f64> = measured[i].iter().zip(&measured[0]).map(|(m, one)| m.error_over(one)).collect();
            let error = harness::median(&ratios);
            table.row([
                count.to_string(),
                format!("{:.1}", worlds[i].0 * 1e3),
                format!("{:.2}", median(&|m| m.seconds_per_path) * 1e6),
                format!("{:.3}", median(&|m| m.variance)),
                format!("{error:.2}"),
            ]);
            points.push([count as f64, error]);
            if count == 10_000 || count == 100_000 {
                figure(&format!("lights.{kind}.{count}_over_1"), error, "ratio");
            }
        }
        table.print(&format!("lamps as {kind}"));
        plot.add(kind, points);
    }
    if let Err(error) = plot.write("lights") {
        println!("# no plot: {error}");
    }
    // Time the preparation of a large texture that is lit everywhere, with different values in neighbouring texels.
    let (seconds, _) = build(textured(
        Image::from_fn(4096, 4096, |x, y| [0.5 + ((x * 7 + y * 13) % 11) as f32 / 10.0]).expect("an image"),
        1.0,
    ));
    figure("lights.build.texture4k", seconds, "s");
}

fn build(scene: Scene) -> (f64, World) {
    let pool = Pool::new(0).expect("threads");
    let monitor = Monitor::default();
    let (seconds, world) = time(Clock::Wall, || pool.run(|| World::build(Arc::new(scene), monitor.job())));
    (seconds, world.expect("the scene is valid"))
}

/// Traces paths from random points of the floor; each point has a variance and a mean of its own.
fn measure(world: &World, round: u64) -> Measured {
    let (seconds, relative) = time(Clock::Thread, || {
        let mut relative = 0.0;
        for point in 0..POINTS {
            let mut rng = Rng::new(round, &[u64::from(point)]);
            let (u, v) = (rng.next_f32(), rng.next_f32());
            let barycentric = if u + v > 1.0 { Vec2::new(1.0 - u, 1.0 - v) } else { Vec2::new(u, v) };
            let at = SurfacePoint { mesh: 0, triangle: point % 2, barycentric, front: true };
            let (mut sum, mut square) = (0.0, 0.0);
            for path in 0..PATHS {
                let mut light = Path::default();
                let seed = (round << 32) + u64::from(point * PATHS + path);
                render::irradiance(world, &at, seed, 0, &mut light);
                sum += light.0;
                square += light.0 * light.0;
            }
            let mean = sum / f64::from(PATHS);
            relative += (square / f64::from(PATHS) / (mean * mean) - 1.0) / f64::from(POINTS);
        }
        relative
    });
    Measured { seconds_per_path: seconds / f64::from(POINTS * PATHS), variance: relative }
}

/// The empty room. The floor is the first mesh, the ceiling the last; material 1 emits light.
fn room() -> Scene {
    let (x, y, z) = (Vec3::X * SIDE, Vec3::Y * HEIGHT, Vec3::Z * SIDE);
    let sides = [(Vec3::ZERO, z, x), (Vec3::ZERO, x, y), (z, y, x), (Vec3::ZERO, y, z), (x, z, y), (y, x, z)];
    let shining = Material { emission: Vec3::splat(1e4), double_sided: false, ..Material::diffuse("lamp", Vec3::ZERO) };
    Scene {
        meshes: sides.into_iter().map(|(corner, u, v)| Mesh::parallelogram(corner, u, v, 0)).collect(),
        materials: vec![Material::diffuse("grey", Vec3::splat(0.5)), shining],
        ..Scene::default()
    }
}

/// Positions of `count` lamps in `[0, 1]²`: cells of the smallest square grid with at least `count` cells.
fn places(count: usize) -> impl Iterator<Item = Vec2> {
    let grid = (count as f64).sqrt().ceil() as usize;
    (0..count).map(move |i| {
        // Spread the lamps evenly over the cells of the grid.
        let cell = i * grid * grid / count;
        (Vec2::new((cell % grid) as f32, (cell / grid) as f32) + 0.5) / grid as f32
    })
}

/// The room with `count` square lamps that are meshes under the ceiling.
fn mesh_lamps(count: usize) -> Scene {
    let mut scene = room();
    let side = SIDE * (LIT / count as f32).sqrt();
    let mut lamps = Mesh { material: 1, ..Mesh::default() };
    for place in places(count) {
        let corner = place * SIDE - side / 2.0;
        let lamp = Mesh::parallelogram(Vec3::new(corner.x, HEIGHT - 0.01, corner.y), Vec3::X * side, Vec3::Z * side, 1);
        let first = lamps.positions.len() as u32;
        lamps.positions.extend(lamp.positions);
        lamps.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    scene.meshes.push(lamps);
    scene
}

/// The room with `count` square lamps in the emission texture of the ceiling.
fn texture_lamps(count: usize) -> Scene {
    let side = ((TEXELS as f32) * (LIT / count as f32).sqrt()).round().max(1.0) as usize;
    let mut image = Image::new(TEXELS, TEXELS, 1).expect("an image");
    for place in places(count) {
        let corner = place * TEXELS as f32 - side as f32 / 2.0;
        for i in 0..side * side {
            let (x, y) = (corner.x as usize + i % side, corner.y as usize + i / side);
            image.pixel_mut(x.min(TEXELS - 1), y.min(TEXELS - 1))[0] = 1.0;
        }
    }
    // Rounding the sides of lamps to texels changes the flux; scale the emission to compensate.
    let lit = image.data.iter().sum::<f32>() / (TEXELS * TEXELS) as f32;
    textured(image, LIT / lit)
}

fn textured(image: Image, strength: f32) -> Scene {
    let mut scene = room();
    scene.materials[1].emission *= strength;
    scene.materials[1].emission_texture = Some(TextureRef::new(0));
    scene.textures.push(Texture::new("lamps", image));
    if let Some(ceiling) = scene.meshes.last_mut() {
        ceiling.material = 1;
    }
    scene
}
