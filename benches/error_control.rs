//! Benchmark of the renderer's own error estimates: their accuracy and their uses.
//!
//! Intervals and errors that single renders state are compared with a reference of many more paths. Further parts
//! measure the saving and the bias of an error target, the accuracy of time budgets, the gain, cost and bias of the
//! preview filter, and the cost of a path that hits nothing. Means over seeds are printed with the half-width of their
//! 95 % interval (Student's t). Takes about two minutes on two idle cores.

mod harness;

use glam::Vec3;
use harness::scenes::{self, Absent, Setting};
use harness::{Clock, Table, absent, figure, interleaved, median, time};
use luxfer::exec::Pool;
use luxfer::image::{Image, colour, io};
use luxfer::job::Monitor;
use luxfer::render::denoise::{self, Input};
use luxfer::render::{self, Aov, Film, Outputs, Params, World};
use luxfer::scene::{Camera, Environment, Material, Mesh, Scene};
use std::hint::black_box;
use std::sync::Arc;

/// Number of renders, per scene and number of paths, that measure the coverage of intervals.
const SEEDS: u64 = 32;
/// Number of renders, per scene and error target, that measure paths and bias.
const TARGETED: u64 = 10;
/// Number of renders, per scene and number of paths, that measure the bias of previews.
const PREVIEWS: u64 = 10;
/// Paths per pixel of the reference images.
const REFERENCE: u32 = 2048;

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

/// Mean over the pixels of the squared difference, relative to the true pixel, as the report's `relative_error`
/// defines it.
fn squared_relative_distance(image: &Image, truth: &Image) -> f64 {
    let least = 0.01 * mean(truth);
    let pixels = image.data.chunks_exact(3).zip(truth.data.chunks_exact(3));
    let of_pixel = |(image, truth): (&[f32], &[f32])| {
        let shown = truth.iter().map(|&v| f64::from(v)).sum::<f64>() / 3.0;
        let square = image.iter().zip(truth).map(|(&a, &b)| f64::from(a - b).powi(2)).sum::<f64>() / 3.0;
        square / shown.max(least).powi(2)
    };
    3.0 * pixels.map(of_pixel).sum::<f64>() / image.data.len() as f64
}

/// Mean of independent values, and the half-width of its 95 % interval.
fn mean_and_interval(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    // Compute the two-sided 5 % point of Student's t from the normal quantile, accurate to 1 % (Abramowitz and Stegun
    // 26.7.5).
    let (z, f) = (1.96f64, n - 1.0);
    let t = z + (z.powi(3) + z) / (4.0 * f) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * f * f);
    (mean, t * (variance / n).sqrt())
}

/// Measures coverage: the share of pixels with noise whose interval contains the true value.
fn coverage(ready: &[Ready]) {
    let mut table =
        Table::new(["scene", "paths", "in interval", "±", "least quarter", "own 1.96", "error stated / true"]);
    let (mut all, mut worst) = (Vec::new(), 0.0f64);
    for (name, world, camera) in ready.iter().filter(|r| r.0 != "kitchen") {
        let size = Params { width: 32, height: 20, ..Params::default() };
        let truth = shoot(world, camera, &Params { samples: REFERENCE, seed: 1 << 40, ..size.clone() }).beauty;
        for samples in [8, 16, 64] {
            let (mut squares, mut stated) = (0.0, 0.0);
            // For each pixel and channel, count the renders whose interval contains the true value, once for the
            // interval that the renderer states and once for 1.96 standard errors of the pixel. For each render,
            // compute the share of the pixels whose stated interval contains the true value.
            let mut inside = vec![[0u32; 2]; truth.data.len()];
            let mut random = vec![false; truth.data.len()];
            let mut renders = Vec::new();
            for seed in 0..SEEDS {
                let film = shoot(world, camera, &Params { samples, seed, ..size.clone() });
                let interval = film.interval(Monitor::default().job()).expect("an image");
                squares += squared_distance(&film.beauty, &truth);
                stated += (film.error * mean(&film.beauty)).powi(2);
                let (mut held, mut counted) = (0.0, 0.0);
                for i in 0..truth.data.len() {
                    let distance = (film.beauty.data[i] - truth.data[i]).abs();
                    let is_random = film.variance.data[i] > 1e-10 * truth.data[i].powi(2);
                    random[i] |= is_random;
                    inside[i][0] += u32::from(distance <= interval.data[i]);
                    inside[i][1] += u32::from(distance <= 1.96 * film.variance.data[i].sqrt());
                    counted += f64::from(u8::from(is_random));
                    held += f64::from(u8::from(is_random && distance <= interval.data[i]));
                }
                renders.push(100.0 * held / counted);
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
                format!("{:.1} %", mean_and_interval(&renders).1),
                format!("{:.1} %", average(&sorted[..sorted.len() / 4])),
                format!("{:.1} %", average(&own)),
                format!("{:.3}", (stated / squares).sqrt()),
            ]);
        }
    }
    table.print(&format!(
        "95 % intervals over {SEEDS} renders: pixels that hold the truth; a quarter of the pixels that do so least"
    ));
    figure("render.interval_coverage", all.iter().sum::<f64>() / all.len() as f64, "%");
    figure("render.interval_coverage.worst_distance", worst, "%");
}

/// Measures paths and bias of renders with an error target, against renders with the same mean number of paths in
/// every pixel.
fn targets(ready: &[Ready]) {
    let mut table = Table::new(["scene", "target", "paths", "true error", "even", "saved", "bias", "±"]);
    let (mut gains, mut most) = ([Vec::new(), Vec::new()], 0.0f64);
    for (name, world, camera) in ready.iter().filter(|r| r.0 != "kitchen") {
        let size = Params { width: 48, height: 32, samples: 1 << 12, ..Params::default() };
        let truth = shoot(world, camera, &Params { samples: REFERENCE, seed: 1 << 40, ..size.clone() }).beauty;
        for (target_error, relative_error, pixel_error) in [(0.2, 0.0, 0.0), (0.0, 0.2, 0.0), (0.0, 0.0, 0.5)] {
            let targets = Params { target_error, relative_error, pixel_error, ..size.clone() };
            let distance = |film: &Film| match relative_error {
                0.0 => squared_distance(&film.beauty, &truth) / mean(&truth).powi(2),
                _ => squared_relative_distance(&film.beauty, &truth),
            };
            let (mut paths, mut squares) = (0.0, 0.0);
            let mut shifts = Vec::new();
            for seed in 0..TARGETED {
                let film = shoot(world, camera, &Params { seed, ..targets.clone() });
                paths += f64::from(film.samples) / TARGETED as f64;
                squares += distance(&film) / TARGETED as f64;
                shifts.push(100.0 * (mean(&film.beauty) / mean(&truth) - 1.0));
            }
            let even = even_error((world, camera), &size, paths, &distance);
            let (bias, interval) = mean_and_interval(&shifts);
            // A target for every pixel does not reduce the error of the whole image, because it optimises another
            // error.
            let saved = even / squares;
            if pixel_error == 0.0 {
                gains[usize::from(relative_error > 0.0)].push(saved);
            }
            most = if bias.abs() > most.abs() { bias } else { most };
            table.row([
                name.to_string(),
                match (target_error, relative_error) {
                    (0.0, 0.0) => format!("pixel {pixel_error}"),
                    (0.0, error) => format!("relative {error}"),
                    (error, _) => format!("image {error}"),
                },
                format!("{paths:.0}"),
                format!("{:.4}", squares.sqrt()),
                format!("{:.4}", even.sqrt()),
                if pixel_error == 0.0 { format!("{saved:.2} x") } else { "-".into() },
                format!("{bias:+.2} %"),
                format!("{interval:.2} %"),
            ]);
        }
    }
    table.print(&format!(
        "targets, {TARGETED} renders each: error of as many paths in equal numbers, what they would need more, change of the \
         image's mean"
    ));
    figure("render.adaptive.saved", median(&gains[0]), "x");
    figure("render.adaptive.relative.saved", median(&gains[1]), "x");
    figure("render.adaptive.bias", most, "%");
}

/// Squared error of renders with `paths` paths in every pixel. Between powers of two the error is interpolated in
/// logarithms, because points are stratified best at powers of two.
fn even_error((world, camera): (&World, &Camera), size: &Params, paths: f64, distance: &dyn Fn(&Film) -> f64) -> f64 {
    let below = 1u32 << (paths as u32).max(1).ilog2();
    let [low, high] = [below, 2 * below].map(|samples| {
        let seeds = TARGETED / 2;
        let film = |seed| shoot(world, camera, &Params { samples, seed, ..size.clone() });
        (0..seeds).map(|seed| distance(&film(seed)) / seeds as f64).sum::<f64>()
    });
    low * (high / low).powf((paths / f64::from(below)).log2())
}

/// Measures the error of previews against a reference, their bias, and their time.
fn previews(ready: &[Ready]) {
    let mut table = Table::new([
        "scene",
        "paths",
        "relMSE",
        "strength 0.3",
        "1",
        "3",
        "less by",
        "error",
        "bias stated",
        "bias of squares",
        "of pixels",
    ]);
    for (name, world, camera) in ready.iter().filter(|r| ["demo", "kitchen"].contains(&r.0)) {
        let size = Params { width: 128, height: 72, ..Params::default() };
        let truth = shoot(world, camera, &Params { samples: REFERENCE / 2, seed: 1 << 40, ..size.clone() }).beauty;
        let mut gains = Vec::new();
        for samples in [8, 16] {
            let PreviewErrors { before, after, left, stated, smoothed } =
                preview_errors(name, (world, camera), &Params { samples, ..size.clone() }, &truth);
            gains.push(before / after[1]);
            table.row([
                name.to_string(),
                samples.to_string(),
                format!("{before:.4}"),
                format!("{:.4}", after[0]),
                format!("{:.4}", after[1]),
                format!("{:.4}", after[2]),
                format!("{:.1} x", before / after[1]),
                format!("{:.4}", left.sqrt() / mean(&truth)),
                format!("{:.4}", stated.sqrt()),
                format!("{:.4}", bias(&smoothed, &truth, 8)),
                format!("{:.4}", bias(&smoothed, &truth, 1)),
            ]);
            if samples == 8 {
                figure(&format!("render.preview.bias.{name}"), 100.0 * bias(&smoothed, &truth, 8), "%");
            }
        }
        figure(&format!("render.preview.gain.{name}"), median(&gains), "x");
    }
    table.print(&format!(
        "previews, {PREVIEWS} renders each: mean squared error relative to the reference, before and after; at strength 1, \
         error and bias relative to the mean of the image"
    ));
    time_preview(&ready[0]);
}

/// Means over the renders of a scene with preview.
#[derive(Default)]
struct PreviewErrors {
    /// Mean squared error relative to the truth, before the filter, and after the filter at strengths 0.3, 1 and 3.
    before: f64,
    after: [f64; 3],
    /// Mean squared error of the filtered image at strength 1, and the square of the bias that the preview states.
    left: f64,
    stated: f64,
    /// The filtered images at strength 1.
    smoothed: Vec<Image>,
}

/// Compares previews with the true image; saves the first render with 8 paths per pixel.
fn preview_errors(name: &str, (world, camera): (&World, &Camera), params: &Params, truth: &Image) -> PreviewErrors {
    let mut errors = PreviewErrors::default();
    for seed in 0..PREVIEWS {
        let films = [0.3, 1.0, 3.0].map(|preview| shoot(world, camera, &Params { seed, preview, ..params.clone() }));
        let beauty = films[0].beauty.clone();
        let outputs = films.map(|film| film.preview.expect("a preview was asked for"));
        let share = 1.0 / PREVIEWS as f64;
        errors.before += share * relative_error(&beauty, truth);
        errors.after.iter_mut().zip(&outputs).for_each(|(a, o)| *a += share * relative_error(&o.image, truth));
        let [_, usual, _] = outputs;
        errors.left += share * squared_distance(&usual.image, truth);
        errors.stated += share * usual.bias.powi(2);
        if params.samples == 8 && seed == 0 {
            save(name, &beauty, &usual.image, truth);
        }
        errors.smoothed.push(usual.image);
    }
    errors
}

/// Times the preview filter alone.
fn time_preview((_, world, camera): &Ready) {
    let outputs = Outputs { aovs: vec![Aov::Albedo, Aov::Normal, Aov::Position], ..Outputs::default() };
    let film = |seed| shoot(world, camera, &Params { samples: 4, seed, outputs: outputs.clone(), ..Params::default() });
    let (one, other) = (film(1), film(2));
    let times: Vec<f64> = (0..5).map(|_| time(Clock::Wall, || black_box(smooth(&one, &other))).0).collect();
    figure("render.preview.ms", 1e3 * times.iter().copied().fold(f64::INFINITY, f64::min), "ms");
}

/// Bias of the mean of several images: the root mean square of its error over squares of `side` pixels, relative to
/// the mean of the truth. The part that comes from the scatter between the images is subtracted.
fn bias(images: &[Image], truth: &Image, side: usize) -> f64 {
    let (mut squares, mut count) = (0.0, 0.0);
    for top in (0..truth.height).step_by(side) {
        for left in (0..truth.width).step_by(side) {
            let sum = |image: &Image| -> f64 {
                let rows = top..(top + side).min(truth.height);
                let columns = left..(left + side).min(truth.width);
                rows.flat_map(|y| columns.clone().map(move |x| (x, y)))
                    .map(|(x, y)| f64::from(colour::luminance(image.rgb(x, y))))
                    .sum()
            };
            let area = (side.min(truth.height - top) * side.min(truth.width - left)) as f64;
            let off: Vec<f64> = images.iter().map(|i| (sum(i) - sum(truth)) / area).collect();
            let n = off.len() as f64;
            let centre = off.iter().sum::<f64>() / n;
            let scatter = off.iter().map(|o| (o - centre).powi(2)).sum::<f64>() / (n - 1.0) / n;
            squares += (centre * centre - scatter) * area;
            count += area;
        }
    }
    f64::max(squares / count, 0.0).sqrt() / mean(truth)
}

fn smooth(one: &Film, other: &Film) -> denoise::Output {
    let [albedo, normal, position] = [0, 1, 2].map(|i| &one.layers[i].image);
    let (halves, variances) = ([&one.beauty, &other.beauty], [&one.variance, &other.variance]);
    let input = Input { halves, variances, albedo, normal, position };
    denoise::run(&input, &denoise::Params::default(), Monitor::default().job()).expect("a preview")
}

fn relative_error(image: &Image, truth: &Image) -> f64 {
    let floor = (0.01 * mean(truth)).powi(2);
    let square = |(&v, &t): (&f32, &f32)| f64::from(v - t).powi(2) / (f64::from(t).powi(2) + floor);
    image.data.iter().zip(&truth.data).map(square).sum::<f64>() / truth.data.len() as f64
}

/// Number of picture pixels that show one pixel along each side in saved previews.
const ZOOM: usize = 4;

/// Saves three images in `out/bench`, one above the other: before the filter, after the filter, and the truth.
fn save(name: &str, before: &Image, after: &Image, truth: &Image) {
    let (width, height) = (truth.width, truth.height);
    let exposure = (0.3 / mean(truth)) as f32;
    // Enlarge each pixel to a square, for inspection by eye.
    let all = Image::from_fn(ZOOM * width, 3 * ZOOM * height, |x, y| {
        [before, after, truth][y / ZOOM / height].rgb(x / ZOOM, y / ZOOM % height).to_array()
    });
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("out/bench");
    std::fs::create_dir_all(&folder).expect("out/bench can be made");
    let bytes = all.and_then(|image| io::encode_png(&image, exposure)).expect("a picture");
    std::fs::write(folder.join(format!("preview_{name}.png")), bytes).expect("out/bench can be written to");
}

/// Measures the time that a render takes against its time budget. The shortest render traces one path for a few of the
/// pixels and makes an image from them.
fn budgets((_, world, camera): &Ready) {
    let mut table = Table::new(["image", "budget", "least", "taken", "paths per pixel", "over"]);
    let (mut ratios, mut over) = (Vec::new(), 0.0f64);
    for (width, height) in [(320, 180), (1280, 720), (2048, 512), (16_384, 128)] {
        let shoot_for = |time_budget_ms: u32| {
            let params = Params { width, height, samples: 1 << 20, time_budget_ms, ..Params::default() };
            time(Clock::Wall, || shoot(world, camera, &params))
        };
        let least = (0..3).map(|_| shoot_for(1).0).fold(f64::INFINITY, f64::min);
        for budget in [20, 40, 100, 500] {
            let (seconds, film) = shoot_for(budget);
            let given = f64::from(budget) / 1e3;
            // Count only budgets that are clearly above the time of the shortest render.
            if given > 1.5 * least {
                ratios.push(seconds / given);
                over = over.max(seconds - given);
            }
            table.row([
                format!("{width} x {height}"),
                format!("{budget} ms"),
                format!("{:.1} ms", 1e3 * least),
                format!("{:.1} ms", 1e3 * seconds),
                format!("{:.3}", mean(&film.paths)),
                format!("{:+.1} ms", 1e3 * (seconds - given)),
            ]);
        }
    }
    table.print("time budgets");
    figure("render.budget.taken", median(&ratios), "x");
    figure("render.budget.over_most", 1e3 * over, "ms");
}

/// Measures the cost of a path that hits nothing: random numbers, camera and sums.
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

/// A box with a metal block and a polished floor under a small lamp, in which some light arrives over glossy
/// reflections.
fn glossy() -> Setting {
    let (x, y, z) = (Vec3::X, Vec3::Y, Vec3::Z);
    let mut meshes: Vec<Mesh> = vec![
        Mesh::parallelogram(Vec3::ZERO, z, x, 3),
        Mesh::parallelogram(y, x, z, 0),
        Mesh::parallelogram(Vec3::ZERO, x, y, 0),
        Mesh::parallelogram(Vec3::ZERO, y, z, 1),
        Mesh::parallelogram(x, z, y, 2),
    ];
    let (base, a, b, up) =
        (Vec3::new(0.15, 0.0, 0.25), Vec3::new(0.29, 0.0, 0.08), Vec3::new(-0.08, 0.0, 0.29), y * 0.6);
    meshes.extend([
        Mesh::parallelogram(base + up, a, b, 4),
        Mesh::parallelogram(base, up, a, 4),
        Mesh::parallelogram(base + a, up, b, 4),
        Mesh::parallelogram(base + a + b, up, -a, 4),
        Mesh::parallelogram(base + b, up, -b, 4),
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
