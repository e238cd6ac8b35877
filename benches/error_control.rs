//! Whether the renderer knows its own error, and what it does with it.
//!
//! Intervals and errors stated by single renders against a reference of 100 times as many paths; what a target saves and
//! how much it darkens; whether time budgets hold; what the preview filter gains and costs; what a path costs that meets
//! nothing.

mod harness;

use glam::Vec3;
use harness::scenes::{self, Absent, Setting};
use harness::{Clock, Table, absent, figure, interleaved, median, time};
use luxfer::exec::Pool;
use luxfer::image::{Image, colour};
use luxfer::job::Monitor;
use luxfer::render::denoise::{self, Input};
use luxfer::render::{self, Aov, Film, Outputs, Params, World};
use luxfer::scene::{Camera, Environment, Material, Mesh, Scene};
use std::hint::black_box;
use std::sync::Arc;

/// Renders per scene and number of paths.
const SEEDS: u64 = 64;

fn main() {
    let pool = Pool::new(2).expect("two threads");
    let settings: [(&str, Result<Setting, Absent>); 4] = [
        ("demo", scenes::demo_room()),
        ("cornell", scenes::cornell()),
        ("glossy", Ok(glossy())),
        ("kitchen", scenes::kitchen()),
    ];
    let mut ready = Vec::new();
    for (name, setting) in settings {
        match setting {
            Ok(setting) => {
                let scene = Arc::new(setting.scene.clone());
                let world = pool.run(|| World::build(scene, Monitor::default().job())).expect("a valid scene");
                ready.push((name, world, setting.camera));
            }
            Err(reason) => absent(&format!("render.interval_coverage.{name}"), &reason),
        }
    }
    pool.run(|| {
        coverage(&ready);
        targets(&ready);
        previews(&ready);
        budgets(&ready[0]);
    });
    drop(pool);
    empty();
}

type Ready = (&'static str, World, Camera);

fn shoot(world: &World, camera: &Camera, params: &Params) -> Film {
    render::run(world, camera, params, Monitor::default().job(), &mut |_| ()).expect("a film")
}

fn mean(image: &Image) -> f64 {
    image.data.iter().map(|&v| f64::from(v)).sum::<f64>() / image.data.len() as f64
}

fn squared_distance(a: &Image, b: &Image) -> f64 {
    a.data.iter().zip(&b.data).map(|(&a, &b)| f64::from(a - b).powi(2)).sum::<f64>() / a.data.len() as f64
}

/// The share of pixels whose interval holds the truth, where anything is random.
fn coverage(ready: &[Ready]) {
    let mut table = Table::new(["scene", "paths", "in interval", "least quarter", "own 1.96", "error stated / true"]);
    let (mut all, mut worst) = (Vec::new(), 0.0f64);
    for (name, world, camera) in ready.iter().filter(|r| r.0 != "kitchen") {
        let size = Params { width: 40, height: 24, ..Params::default() };
        let truth = shoot(world, camera, &Params { samples: 6400, seed: 1 << 40, ..size.clone() }).beauty;
        for samples in [8, 16, 64] {
            let (mut squares, mut stated) = (0.0, 0.0);
            // Per pixel and channel: how often inside, by the interval and by its own variance alone.
            let mut inside = vec![[0u32; 2]; truth.data.len()];
            let mut random = vec![false; truth.data.len()];
            for seed in 0..SEEDS {
                let film = shoot(world, camera, &Params { samples, seed, ..size.clone() });
                let interval = film.interval(Monitor::default().job()).expect("an image");
                squares += squared_distance(&film.beauty, &truth);
                stated += (film.error * mean(&film.beauty)).powi(2);
                for i in 0..truth.data.len() {
                    let distance = (film.beauty.data[i] - truth.data[i]).abs();
                    random[i] |= film.variance.data[i] > 1e-10 * truth.data[i].powi(2);
                    inside[i][0] += u32::from(distance <= interval.data[i]);
                    inside[i][1] += u32::from(distance <= 1.96 * film.variance.data[i].sqrt());
                }
            }
            let share = |which: usize| -> Vec<f64> {
                let of = inside.iter().zip(&random).filter(|(_, random)| **random);
                of.map(|(n, _)| 100.0 * f64::from(n[which]) / SEEDS as f64).collect()
            };
            let average = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
            let (pooled, own) = (share(0), share(1));
            let mut sorted = pooled.clone();
            sorted.sort_by(f64::total_cmp);
            let covered = average(&pooled);
            all.push(covered);
            worst = worst.max((covered - 95.0).abs());
            table.row([
                name.to_string(),
                samples.to_string(),
                format!("{covered:.1} %"),
                format!("{:.1} %", average(&sorted[..sorted.len() / 4])),
                format!("{:.1} %", average(&own)),
                format!("{:.3}", (stated / squares).sqrt()),
            ]);
        }
    }
    table.print("95 % intervals over 64 renders: pixels that hold the truth; a quarter of the pixels that do so least");
    figure("render.interval_coverage", all.iter().sum::<f64>() / all.len() as f64, "%");
    figure("render.interval_coverage.worst_distance", worst, "%");
}

/// Paths and bias of a target against as many paths everywhere.
fn targets(ready: &[Ready]) {
    let mut table = Table::new(["scene", "target", "paths", "true error", "even", "saved", "bias", "± its error"]);
    let (mut gains, mut most) = (Vec::new(), 0.0f64);
    for (name, world, camera) in ready.iter().filter(|r| r.0 != "kitchen") {
        let size = Params { width: 64, height: 40, samples: 1 << 12, ..Params::default() };
        let truth = shoot(world, camera, &Params { samples: 4096, seed: 1 << 40, ..size.clone() }).beauty;
        for (target_error, pixel_error) in [(0.15, 0.0), (0.0, 0.5)] {
            let renders = 12;
            let (mut paths, mut squares, mut even) = (0.0, 0.0, 0.0);
            let mut shifts = Vec::new();
            for seed in 0..renders {
                let film = shoot(world, camera, &Params { target_error, pixel_error, seed, ..size.clone() });
                paths += f64::from(film.samples) / f64::from(renders as u32);
                squares += squared_distance(&film.beauty, &truth) / f64::from(renders as u32);
                shifts.push(mean(&film.beauty) / mean(&truth) - 1.0);
                let same = shoot(world, camera, &Params { samples: film.samples, seed, ..size.clone() });
                even += squared_distance(&same.beauty, &truth) / f64::from(renders as u32);
            }
            let bias = shifts.iter().sum::<f64>() / shifts.len() as f64;
            let spread = shifts.iter().map(|s| (s - bias).powi(2)).sum::<f64>() / (shifts.len() - 1) as f64;
            gains.push(even / squares);
            most = most.max(bias.abs());
            table.row([
                name.to_string(),
                if target_error > 0.0 { format!("image {target_error}") } else { format!("pixel {pixel_error}") },
                format!("{paths:.0}"),
                format!("{:.4}", squares.sqrt() / mean(&truth)),
                format!("{:.4}", even.sqrt() / mean(&truth)),
                format!("{:.2} x", even / squares),
                format!("{:+.2} %", 100.0 * bias),
                format!("{:.2} %", 100.0 * (spread / shifts.len() as f64).sqrt()),
            ]);
        }
    }
    table.print(
        "targets: error of as many paths in equal numbers, what they would need more, change of the image's mean",
    );
    figure("render.adaptive.saved", median(&gains), "x");
    figure("render.adaptive.bias", 100.0 * most, "%");
}

/// Error of previews against a reference, and their time.
fn previews(ready: &[Ready]) {
    let mut table =
        Table::new(["scene", "paths", "relMSE", "strength 0.3", "1", "3", "less by", "bias stated", "error"]);
    for (name, world, camera) in ready.iter().filter(|r| ["demo", "kitchen"].contains(&r.0)) {
        let outputs = Outputs { aovs: vec![Aov::Albedo, Aov::Normal, Aov::Position], ..Outputs::default() };
        let size = Params { width: 160, height: 90, outputs, ..Params::default() };
        let truth = shoot(world, camera, &Params { samples: 1024, seed: 1 << 40, ..size.clone() }).beauty;
        let mut gains = Vec::new();
        for samples in [8, 16] {
            let film = shoot(world, camera, &Params { samples, ..size.clone() });
            let error = |image: &Image| relative_error(image, &truth);
            let outputs = [0.3, 1.0, 3.0].map(|strength| smooth(&film, strength));
            let before = error(&film.beauty);
            let after = outputs.each_ref().map(|o| error(&o.image));
            gains.push(before / after[1]);
            let left = squared_distance(&outputs[1].image, &truth).sqrt() / mean(&truth);
            table.row([
                name.to_string(),
                samples.to_string(),
                format!("{before:.4}"),
                format!("{:.4}", after[0]),
                format!("{:.4}", after[1]),
                format!("{:.4}", after[2]),
                format!("{:.1} x", before / after[1]),
                format!("{:.4}", outputs[1].bias),
                format!("{left:.4}"),
            ]);
            if samples == 8 {
                save(name, &film.beauty, &outputs[1].image, &truth);
            }
        }
        figure(&format!("render.preview.gain.{name}"), median(&gains), "x");
    }
    table.print("previews: mean squared error relative to the reference, before and after");
    let (_, world, camera) = &ready[0];
    let outputs = Outputs { aovs: vec![Aov::Albedo, Aov::Normal, Aov::Position], ..Outputs::default() };
    let film = shoot(world, camera, &Params { samples: 2, outputs, ..Params::default() });
    let times: Vec<f64> = (0..5).map(|_| time(Clock::Wall, || black_box(smooth(&film, 1.0))).0).collect();
    figure("render.preview.ms", 1e3 * times.iter().copied().fold(f64::INFINITY, f64::min), "ms");
}

fn smooth(film: &Film, strength: f32) -> denoise::Output {
    let [albedo, normal, position] = [0, 1, 2].map(|i| &film.layers[i].image);
    let input = Input { beauty: &film.beauty, variance: &film.variance, albedo, normal, position };
    denoise::run(&input, &denoise::Params { strength }, Monitor::default().job()).expect("a preview")
}

fn relative_error(image: &Image, truth: &Image) -> f64 {
    let floor = (0.01 * mean(truth)).powi(2);
    let square = |(&v, &t): (&f32, &f32)| f64::from(v - t).powi(2) / (f64::from(t).powi(2) + floor);
    image.data.iter().zip(&truth.data).map(square).sum::<f64>() / truth.data.len() as f64
}

/// Before, after and truth above each other in `out/bench`.
fn save(name: &str, before: &Image, after: &Image, truth: &Image) {
    let (width, height) = (truth.width, truth.height);
    let exposure = 0.3 / mean(truth) as f32;
    let all = Image::from_fn(width, 3 * height, |x, y| {
        let rgb = [before, after, truth][y / height].rgb(x, y % height) * exposure;
        rgb.to_array().map(|v| colour::linear_to_srgb(v.clamp(0.0, 1.0)))
    });
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    let _ = std::fs::create_dir_all(&folder);
    if let Ok(image) = all {
        let bytes: Vec<u8> = image.data.iter().map(|v| (v * 255.0).round() as u8).collect();
        let mut file = format!("P6 {width} {} 255\n", 3 * height).into_bytes();
        file.extend(bytes);
        let _ = std::fs::write(folder.join(format!("preview_{name}.ppm")), file);
    }
}

/// Time taken against time given.
fn budgets((_, world, camera): &Ready) {
    let mut table = Table::new(["image", "budget", "taken", "paths per pixel"]);
    let mut ratios = Vec::new();
    for (width, height) in [(320, 180), (1280, 720), (16_384, 128)] {
        for time_budget_ms in [20, 100, 500] {
            let params = Params { width, height, samples: 1 << 20, time_budget_ms, ..Params::default() };
            let (seconds, film) = time(Clock::Wall, || shoot(world, camera, &params));
            ratios.push(1e3 * seconds / f64::from(time_budget_ms));
            table.row([
                format!("{width} x {height}"),
                format!("{time_budget_ms} ms"),
                format!("{:.1} ms", 1e3 * seconds),
                format!("{:.2}", mean(&film.paths)),
            ]);
        }
    }
    table.print("time budgets");
    figure("render.budget.taken", median(&ratios), "x");
    figure("render.budget.taken_most", ratios.iter().copied().fold(0.0, f64::max), "x");
}

/// A path that meets nothing: what the numbers, the camera and the sums cost.
fn empty() {
    let pool = Pool::new(1).expect("a thread");
    let scene = Scene { environment: Some(Environment::Constant(Vec3::ONE)), ..Scene::default() };
    let params = Params { width: 256, height: 256, samples: 16, ..Params::default() };
    pool.run(|| {
        let world = World::build(Arc::new(scene), Monitor::default().job()).expect("an empty scene");
        let camera = Camera::look_at(Vec3::ZERO, Vec3::X, 1.0);
        let timings = interleaved(Clock::Thread, 7, &mut [&mut || drop(black_box(shoot(&world, &camera, &params)))]);
        figure("render.path.empty", timings.median(0) * 1e9 / f64::from(256 * 256 * 16), "ns");
    });
}

/// A box with a metal block and a polished floor under a small lamp: light comes over mirrors, too.
fn glossy() -> Setting {
    let quad =
        |corner: Vec3, u: Vec3, v: Vec3, material: usize| scenes::sheet("", material, 1, |s, t| corner + u * s + v * t);
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let mut meshes: Vec<Mesh> = vec![
        quad(Vec3::ZERO, z, x, 3),
        quad(y, x, z, 0),
        quad(Vec3::ZERO, x, y, 0),
        quad(Vec3::ZERO, y, z, 1),
        quad(x, z, y, 2),
    ];
    let (base, a, b, up) =
        (Vec3::new(0.15, 0.0, 0.25), Vec3::new(0.29, 0.0, 0.08), Vec3::new(-0.08, 0.0, 0.29), y * 0.6);
    meshes.extend([
        quad(base + up, a, b, 4),
        quad(base, up, a, 4),
        quad(base + a, up, b, 4),
        quad(base + a + b, up, -a, 4),
        quad(base + b, up, -b, 4),
    ]);
    let matt = |colour: Vec3| Material { ior: 1.0, ..Material::diffuse("Wall", colour) };
    let mut scene = Scene {
        meshes,
        materials: vec![
            matt(Vec3::splat(0.73)),
            matt(Vec3::new(0.57, 0.05, 0.05)),
            matt(Vec3::new(0.1, 0.38, 0.08)),
            Material { base_color: Vec3::new(0.3, 0.3, 0.4), metallic: 0.0, roughness: 0.15, ..Material::default() },
            Material { base_color: Vec3::new(0.9, 0.7, 0.4), metallic: 1.0, roughness: 0.25, ..Material::default() },
        ],
        ..Scene::default()
    };
    scenes::lamp(&mut scene, Vec3::new(0.38, 0.998, 0.4), glam::Vec2::new(0.24, 0.2), 15.0);
    let camera = Camera::look_at(Vec3::new(0.5, 0.5, 2.4), Vec3::new(0.5, 0.5, 0.0), 0.7);
    Setting { name: "glossy", scene, camera, size: [64, 40] }
}
