//! Benchmark of path tracing: error against time, compared with Mitsuba 3 (`llvm_ad_rgb`, `scalar_rgb`) and Cycles.
//!
//! All renderers get the same GLB file and image size and two threads, and render in turns. The error needs no
//! reference, because it is measured from several images that differ only in the seed. The relative error is the
//! square root of the mean, over the pixels, of the variance divided by the square of the pixel's value; 1 % of the
//! mean pixel is added to the value for pixels near black. The bench also checks that all renderers converge to the
//! same picture: it prints their mean values, and the differences between the means of blocks of pixels.
//!
//! "luxfer" distributes a given mean number of paths per pixel so that the relative error is smallest
//! (`relative_error`); "luxfer, even" traces this number of paths in every pixel, as Mitsuba does. Loading the scene,
//! building acceleration structures and compiling kernels are not timed.

mod harness;

use glam::Vec3;
use harness::plot::{Plot, Series};
use harness::scenes::{self, Absent, Setting};
use harness::{Table, absent, figure};
use luxfer::exec::Pool;
use luxfer::job::Monitor;
use luxfer::render::{self, World};
use luxfer::scene::gltf;
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Arc;
use std::time::Instant;

/// Paths per pixel at the points of a curve.
const LADDER: [u32; 4] = [16, 64, 256, 1024];
/// Target error that no number of paths in the ladder reaches.
const UNREACHED_ERROR: f32 = 1e-6;
/// Number of images for each point.
const SEEDS: u32 = 4;
/// Maximum seconds per image: from the third point on, a renderer gets no more points if four times as many paths
/// would take longer.
const MAX_SECONDS: f64 = 10.0;

fn main() {
    let names = ["mitsuba_llvm", "mitsuba_scalar", "cycles"];
    // `cargo bench --bench render -- kitchen` runs on the kitchen only.
    let chosen: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    for (scene, key) in [(small(scenes::cornell(), 128), "cornell"), (small(scenes::kitchen(), 160), "kitchen")] {
        if !chosen.is_empty() && !chosen.iter().any(|c| c == key) {
            continue;
        }
        // Leave out Mitsuba's scalar variant for the kitchen, where it would take most of the time of the bench.
        let names = if key == "kitchen" { &["mitsuba_llvm", "cycles"][..] } else { &names };
        match scene {
            Ok(setting) => compare(&setting, key, names),
            Err(reason) => {
                names.iter().for_each(|name| absent(&format!("render.time_to_1pct.{key}.vs_{name}"), &reason));
            }
        }
    }
}

/// Returns the scene with a smaller image, so that an error of 1 % is reached within minutes.
fn small(setting: Result<Setting, Absent>, width: usize) -> Result<Setting, Absent> {
    setting.map(|s| Setting { size: [width, width * s.size[1] / s.size[0]], ..s })
}

fn compare(setting: &Setting, key: &str, names: &[&str]) {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    let path = folder.join(format!("{key}.glb"));
    let mut scene = setting.scene.clone();
    scene.cameras = vec![setting.camera.clone()];
    std::fs::create_dir_all(&folder).expect("out/bench can be made");
    let bytes = gltf::export(&scene).expect("the scene is written");
    std::fs::write(&path, bytes).expect("out/bench can be written to");
    let mut renderers: Vec<Renderer> =
        vec![ours(setting, "luxfer", UNREACHED_ERROR), ours(setting, "luxfer_even", 0.0)];
    for name in names {
        match peer(name, &path, setting.size) {
            Ok(renderer) => renderers.push(renderer),
            Err(reason) => absent(&format!("render.time_to_1pct.{key}.vs_{name}"), &reason),
        }
    }
    // Render in turns: each renderer makes one image before the next seed.
    let mut curves: Vec<Curve> = renderers.iter().map(|_| Curve::default()).collect();
    for spp in LADDER {
        for curve in &mut curves {
            curve.done |= curve.points.len() > 1 && curve.points.last().is_some_and(|p| 4.0 * p.seconds > MAX_SECONDS);
            if !curve.done {
                curve.points.push(Point::default());
            }
        }
        for seed in 1..=SEEDS {
            for (renderer, curve) in renderers.iter_mut().zip(&mut curves) {
                if curve.done {
                    continue;
                }
                let (seconds, image, paths) = (renderer.render)(spp, seed);
                let point = curve.points.last_mut().expect("a point was begun");
                point.seconds += seconds / f64::from(SEEDS);
                point.paths += paths / f64::from(SEEDS);
                point.images.push(image);
            }
        }
    }
    report(setting, key, &renderers, &mut curves);
}

/// Renders an image; takes the maximum number of paths per pixel and a seed, and returns the seconds, the pixels, and
/// the mean number of paths per pixel.
type Render = Box<dyn FnMut(u32, u32) -> (f64, Vec<Vec3>, f64)>;

struct Renderer {
    name: String,
    render: Render,
}

#[derive(Default)]
struct Curve {
    points: Vec<Point>,
    done: bool,
}

#[derive(Default)]
struct Point {
    /// Mean number of paths per pixel.
    paths: f64,
    seconds: f64,
    images: Vec<Vec<Vec3>>,
    error: f64,
}

fn ours(setting: &Setting, name: &str, relative_error: f32) -> Renderer {
    let pool = Pool::new(2).expect("two threads");
    let monitor = Monitor::default();
    let world = pool.run(|| World::build(Arc::new(setting.scene.clone()), monitor.job())).expect("the scene is valid");
    let (camera, [width, height]) = (setting.camera.clone(), setting.size);
    let render = move |spp, seed: u32| {
        let seed = u64::from(seed);
        let params = render::Params { width, height, samples: spp, seed, relative_error, ..Default::default() };
        let start = Instant::now();
        let film = pool.run(|| render::run(&world, &camera, &params, monitor.job(), &mut |_| {}));
        let film = film.expect("the parameters are valid");
        let seconds = start.elapsed().as_secs_f64();
        let paths = film.paths.data.iter().map(|&n| f64::from(n)).sum::<f64>() / (width * height) as f64;
        (seconds, film.beauty.data.chunks_exact(3).map(Vec3::from_slice).collect(), paths)
    };
    Renderer { name: name.into(), render: Box::new(render) }
}

/// Another renderer, in a separate process that takes one job per line of its input.
struct Peer {
    process: Child,
    jobs: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
    out: PathBuf,
}

impl Drop for Peer {
    fn drop(&mut self) {
        self.jobs.take();
        let _ = self.process.wait();
    }
}

/// Starts another renderer, if `make peers` has installed it.
fn peer(name: &str, scene: &Path, [width, height]: [usize; 2]) -> Result<Renderer, Absent> {
    let root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    let (package, script, variant) = match name {
        "mitsuba_llvm" => ("mitsuba", "mitsuba_render.py", Some("llvm_ad_rgb")),
        "mitsuba_scalar" => ("mitsuba", "mitsuba_render.py", Some("scalar_rgb")),
        _ => ("bpy", "cycles_render.py", None),
    };
    let python = root.join(format!("target/peers/{package}/bin/python"));
    if !python.exists() {
        return Err(format!("{package} is not installed; `make peers` installs it"));
    }
    let out = scene.with_extension(name);
    let mut command = Command::new(python);
    command.arg(root.join("benches/peers").join(script)).args(variant).arg(scene);
    command.args([width.to_string(), height.to_string()]).arg(&out);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::null());
    let mut process = command.spawn().map_err(|e| e.to_string())?;
    let jobs = process.stdin.take();
    let answers = BufReader::new(process.stdout.take().ok_or("no standard output")?);
    let mut peer = Peer { process, jobs, answers, out };
    peer.answer().map_err(|e| format!("{package} did not start: {e}"))?;
    let render = move |spp, seed| {
        let (seconds, image) = peer.render(spp, seed).expect("the peer renders");
        (seconds, image, f64::from(spp))
    };
    Ok(Renderer { name: name.into(), render: Box::new(render) })
}

impl Peer {
    /// Reads the next line of JSON; skips other lines, which libraries print.
    fn answer(&mut self) -> Result<serde_json::Value, Absent> {
        let mut line = String::new();
        loop {
            line.clear();
            if self.answers.read_line(&mut line).map_err(|e| e.to_string())? == 0 {
                return Err("it ended".into());
            }
            if line.starts_with('{') {
                return serde_json::from_str(&line).map_err(|e| e.to_string());
            }
        }
    }

    fn render(&mut self, spp: u32, seed: u32) -> Result<(f64, Vec<Vec3>), Absent> {
        let jobs = self.jobs.as_mut().ok_or("it has ended")?;
        writeln!(jobs, "{spp} {seed}").and_then(|()| jobs.flush()).map_err(|e| e.to_string())?;
        let answer = self.answer()?;
        let bytes = std::fs::read(&self.out).map_err(|e| e.to_string())?;
        let values: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        let seconds = answer["seconds"].as_f64().ok_or("no seconds in the answer")?;
        Ok((seconds, values.chunks_exact(3).map(Vec3::from_slice).collect()))
    }
}

fn report(setting: &Setting, key: &str, renderers: &[Renderer], curves: &mut [Curve]) {
    let [width, height] = setting.size;
    let mut plot = Plot::new(&format!("{key}: error against time"), "seconds", "relative error");
    let mut table = Table::new(["renderer", "paths/pixel", "seconds", "error %", "Mpaths/s"]);
    for (renderer, curve) in renderers.iter().zip(curves.iter_mut()) {
        let mean = mean_image(curve);
        for point in &mut curve.points {
            point.error = relative_error(&point.images, &mean);
            let paths = point.paths * (width * height) as f64 / 1e6;
            let cells = [point.paths, point.seconds, 100.0 * point.error, paths / point.seconds];
            let cells = cells.map(|v| format!("{v:.3}"));
            table.row([renderer.name.clone()].into_iter().chain(cells));
        }
        let points = curve.points.iter().map(|p| [p.seconds, p.error]).collect();
        plot.series.push(Series { name: renderer.name.clone(), points });
    }
    table.print(&format!("{key}, {width} x {height}, 2 threads"));
    plot.write(&format!("render_{key}")).expect("out/bench can be written to");
    // Compare the mean images of the renderers.
    let reference = mean_image(&curves[0]);
    for (renderer, curve) in renderers.iter().zip(curves.iter()) {
        let image = mean_image(curve);
        let [ours, theirs] = [&reference, &image].map(|i| i.iter().sum::<Vec3>() / i.len() as f32);
        let blocks = block_difference(&reference, &image, setting.size);
        println!(
            "  {}: mean {theirs:.4} ({ours:.4}), blocks differ by {:.2} % (median)",
            renderer.name,
            100.0 * blocks
        );
    }
    // Compute the times that the renderers take to reach an error.
    for percent in [5, 1] {
        let error = f64::from(percent) / 100.0;
        let times: Vec<(f64, bool)> = curves.iter().map(|c| time_to(&c.points, error)).collect();
        for (renderer, &(time, measured)) in renderers.iter().zip(&times) {
            let how = if measured { "measured" } else { "extrapolated" };
            println!("  {} to {percent} %: {time:.2} s ({how})", renderer.name);
        }
        for (renderer, &(time, _)) in renderers.iter().zip(&times).skip(1) {
            figure(&format!("render.time_to_{percent}pct.{key}.vs_{}", renderer.name), time / times[0].0, "x");
        }
    }
}

/// Mean of all images of a curve, weighted by their numbers of paths.
fn mean_image(curve: &Curve) -> Vec<Vec3> {
    let images = || curve.points.iter().flat_map(|p| p.images.iter().map(|i| (p.paths as f32, i)));
    let total: f32 = images().map(|(weight, _)| weight).sum();
    let mut mean = vec![Vec3::ZERO; images().next().map_or(0, |(_, i)| i.len())];
    for (weight, image) in images() {
        mean.iter_mut().zip(image).for_each(|(m, v)| *m += *v * (weight / total));
    }
    mean
}

fn relative_error(images: &[Vec<Vec3>], mean: &[Vec3]) -> f64 {
    let floor = mean.iter().map(|v| v.element_sum() / 3.0).sum::<f32>() / mean.len() as f32 * 0.01;
    let n = images.len() as f32;
    let of_pixel = |i: usize| {
        let centre = images.iter().map(|image| image[i]).sum::<Vec3>() / n;
        let variance = images.iter().map(|image| (image[i] - centre).powf(2.0)).sum::<Vec3>() / (n - 1.0);
        f64::from((variance / (mean[i] + floor).powf(2.0)).element_sum()) / 3.0
    };
    ((0..mean.len()).map(of_pixel).sum::<f64>() / mean.len() as f64).sqrt()
}

/// Median, over blocks of 16 × 16 pixels, of the relative difference between the means of two images.
fn block_difference(a: &[Vec3], b: &[Vec3], [width, height]: [usize; 2]) -> f64 {
    const SIDE: usize = 16;
    let mut differences = Vec::new();
    for top in (0..height).step_by(SIDE) {
        for left in (0..width).step_by(SIDE) {
            let sum = |image: &[Vec3]| -> f32 {
                let rows = top..(top + SIDE).min(height);
                rows.flat_map(|y| &image[y * width + left..y * width + (left + SIDE).min(width)])
                    .map(|v| v.element_sum())
                    .sum()
            };
            let (p, q) = (sum(a), sum(b));
            differences.push(f64::from((p - q).abs() / p.abs().max(1e-9)));
        }
    }
    harness::median(&differences)
}

/// Time at which a curve reaches an error, and whether the time was measured or extrapolated. The number of paths is
/// interpolated against the error linearly in logarithms, and multiplied by the median time per path, because errors
/// scatter less than single times.
fn time_to(points: &[Point], error: f64) -> (f64, bool) {
    let logs: Vec<[f64; 2]> = points.iter().map(|p| [p.paths.ln(), p.error.ln()]).collect();
    let target = error.ln();
    let end = logs.iter().position(|p| p[1] <= target);
    let measured = end.is_some();
    let end = end.unwrap_or(logs.len() - 1).max(1);
    let Some(&[[n0, e0], [n1, e1]]) = logs.get(end - 1..=end).and_then(|p| <&[[f64; 2]; 2]>::try_from(p).ok()) else {
        return (f64::NAN, false);
    };
    let paths = (n0 + (target - e0) * (n1 - n0) / (e1 - e0)).exp();
    let per_path: Vec<f64> = points.iter().map(|p| p.seconds / p.paths).collect();
    (paths * harness::median(&per_path), measured)
}
