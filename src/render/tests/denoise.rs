//! Tests of the noise filter (`denoise`).

use super::*;
use crate::render::denoise::{self, Input};

/// Renders albedo, normal and position of the primary hits.
fn features(world: &World, camera: &Camera, width: usize, height: usize) -> [Image; 3] {
    let outputs = Outputs { aovs: vec![Aov::Albedo, Aov::Normal, Aov::Position], ..Outputs::default() };
    let film = render(world, camera, &Params { width, height, samples: 16, outputs, ..Params::default() });
    let images: Vec<Image> = film.layers.into_iter().map(|layer| layer.image).collect();
    images.try_into().unwrap()
}

/// Returns the mean over all values of (v - t)² / (t² + (0.01 m)²). t is the true value, and m is the mean of all true
/// values.
fn rel_mse(image: &Image, truth: &Image) -> f64 {
    let mean = truth.data.iter().map(|&v| f64::from(v)).sum::<f64>() / truth.data.len() as f64;
    let square = |(&v, &t): (&f32, &f32)| f64::from(v - t).powi(2) / (f64::from(t).powi(2) + (0.01 * mean).powi(2));
    image.data.iter().zip(&truth.data).map(square).sum::<f64>() / truth.data.len() as f64
}

/// A matt room with a lamp and a table, and a camera in it.
fn room() -> (World, Camera) {
    let corners = [Vec3::ZERO, Vec3::X * 4.0, Vec3::Y * 3.0, Vec3::Z * 4.0];
    let [o, x, y, z] = corners;
    let mut meshes = vec![
        Mesh::parallelogram(o, z, x, 0),
        Mesh::parallelogram(y, x, z, 0),
        Mesh::parallelogram(o, x, y, 0),
        Mesh::parallelogram(o, y, z, 2),
        Mesh::parallelogram(x, z, y, 3),
    ];
    meshes.push(Mesh::parallelogram(Vec3::new(1.5, 2.9, 1.5), Vec3::X, Vec3::Z, 1));
    meshes.push(Mesh::parallelogram(Vec3::new(1.0, 1.0, 0.5), Vec3::Z, Vec3::X * 2.0, 0));
    let mut red = matt(0.5, 0.0);
    red.base_color = Vec3::new(0.6, 0.1, 0.1);
    let scene =
        Scene { meshes, materials: vec![matt(0.7, 0.0), matt(0.0, 50.0), red, matt(0.3, 0.0)], ..Scene::default() };
    (world(scene), Camera::look_at(Vec3::new(2.0, 1.6, 5.5), Vec3::new(2.0, 1.4, 0.0), 0.8))
}

/// Two independent renders with half of the paths each, and their variances.
struct Halves {
    images: [Image; 2],
    variances: [Image; 2],
}

impl Halves {
    fn mean(&self) -> Image {
        let [one, other] = &self.images;
        Image { data: one.data.iter().zip(&other.data).map(|(a, b)| 0.5 * a + 0.5 * b).collect(), ..*one }
    }
}

fn halves(world: &World, camera: &Camera, params: &Params) -> Halves {
    let half = |seed: u64| render(world, camera, &Params { samples: params.samples / 2, seed, ..params.clone() });
    let [one, other] = [half(2 * params.seed), half(2 * params.seed + 1)];
    Halves { images: [one.beauty, other.beauty], variances: [one.variance, other.variance] }
}

fn smoothed(halves: &Halves, guide: &[Image; 3], strength: f32) -> denoise::Output {
    let [albedo, normal, position] = guide;
    let ([one, other], [first, second]) = (&halves.images, &halves.variances);
    let input = Input { halves: [one, other], variances: [first, second], albedo, normal, position };
    denoise::run(&input, &denoise::Params { strength }, Monitor::default().job()).unwrap()
}

/// A flat picture of `width` × `height` pixels as two halves. Column x has the radiance `light(x)`; each half has its
/// own Gaussian noise of standard deviation `sigma`.
fn flat(width: usize, height: usize, sigma: f32, light: impl Fn(usize) -> f32) -> Halves {
    let mut rng = crate::rng::Rng::new(3, &[]);
    let images = [0, 1].map(|_| {
        let noise: Vec<f32> = (0..width * height).map(|_| sigma * rng.normal() as f32).collect();
        Image::from_fn(width, height, |x, y| [light(x) + noise[y * width + x]; 3]).unwrap()
    });
    Halves { images, variances: [0, 1].map(|_| Image::from_fn(width, height, |_, _| [sigma * sigma; 3]).unwrap()) }
}

/// Guides of a grey plane whose normal depends on the column.
fn plane(width: usize, height: usize, normal: impl Fn(usize) -> Vec3) -> [Image; 3] {
    [
        Image::from_fn(width, height, |_, _| [0.5; 3]).unwrap(),
        Image::from_fn(width, height, |x, _| normal(x).to_array()).unwrap(),
        Image::from_fn(width, height, |x, y| [x as f32, y as f32, 0.0]).unwrap(),
    ]
}

fn mean(values: &[f32]) -> f64 {
    values.iter().map(|&v| f64::from(v)).sum::<f64>() / values.len() as f64
}

/// Returns the mean luminance of each square of 8 × 8 pixels.
fn squares(image: &Image) -> Vec<f64> {
    let mut means = Vec::new();
    for top in (0..image.height).step_by(8) {
        for left in (0..image.width).step_by(8) {
            let pixels = (0..64).map(|i| image.rgb(left + i % 8, top + i / 8));
            means.push(pixels.map(|p| f64::from(crate::image::colour::luminance(p))).sum::<f64>() / 64.0);
        }
    }
    means
}

#[test]
fn a_preview_has_a_fraction_of_the_error_and_states_its_bias() {
    const RENDERS: usize = 24;
    let (world, camera) = room();
    let size = Params { width: 72, height: 48, ..Params::default() };
    let reference = render(&world, &camera, &Params { samples: 512, seed: 9, ..size.clone() });
    let truth = reference.beauty;
    let guide = features(&world, &camera, 72, 48);
    let shoot = |seed: usize| halves(&world, &camera, &Params { samples: 8, seed: seed as u64, ..size.clone() });
    let renders: Vec<(Halves, denoise::Output)> = (0..RENDERS)
        .map(|seed| {
            let halves = shoot(seed);
            let output = smoothed(&halves, &guide, 1.0);
            (halves, output)
        })
        .collect();
    let (halves, output) = &renders[0];
    let both = halves.mean();
    let (before, after) = (rel_mse(&both, &truth), rel_mse(&output.image, &truth));
    assert!(after < before / 5.0, "from {before} to {after}");
    // On average over the renders, the stated error agrees with the measured error.
    let unit = mean(&truth.data);
    let square =
        |image: &Image| image.data.iter().zip(&truth.data).map(|(a, t)| (a - t) * (a - t)).collect::<Vec<f32>>();
    let n = RENDERS as f64;
    let error = (renders.iter().map(|(_, output)| mean(&square(&output.image))).sum::<f64>() / n).sqrt() / unit;
    let stated = (renders.iter().map(|(_, output)| output.error.powi(2)).sum::<f64>() / n).sqrt();
    assert!(stated > 0.7 * error && stated < 1.4 * error, "error {stated} stated, {error} measured");
    // The intervals contain the truth for the nominal 95 % of the values. The reference itself is noisy, so its error
    // is added to the half-widths of the intervals.
    let inside = |output: &denoise::Output| {
        let half_widths = output.interval.data.iter().zip(&reference.variance.data);
        let half_widths = half_widths.map(|(&own, variance)| own.hypot(1.96 * variance.sqrt()));
        let pixels = output.image.data.iter().zip(&truth.data).zip(half_widths);
        pixels.filter(|((v, t), half_width)| (**v - **t).abs() <= *half_width).count() as f64 / truth.data.len() as f64
    };
    let covered = renders.iter().map(|(_, output)| inside(output)).sum::<f64>() / n;
    assert!(covered > 0.93 && covered < 0.97, "{covered}");
    // Compute the squared bias of each square of 8 × 8 pixels: the squared error of the mean preview minus the variance
    // of this mean.
    let truth = squares(&truth);
    let off: Vec<Vec<f64>> = renders
        .iter()
        .map(|(_, output)| squares(&output.image).iter().zip(&truth).map(|(a, b)| a - b).collect())
        .collect();
    let of_square = |i: usize| {
        let mean = off.iter().map(|o| o[i]).sum::<f64>() / n;
        mean * mean - off.iter().map(|o| (o[i] - mean).powi(2)).sum::<f64>() / (n - 1.0) / n
    };
    let light = truth.iter().sum::<f64>() / truth.len() as f64;
    let bias = ((0..truth.len()).map(of_square).sum::<f64>() / truth.len() as f64).sqrt() / light;
    let stated = (renders.iter().map(|(_, output)| output.bias.powi(2)).sum::<f64>() / n).sqrt();
    assert!(stated > 0.7 * bias && stated < 1.6 * bias, "{stated} stated, {bias} measured");
    // At strength 0, the image stays the same.
    let same = smoothed(halves, &guide, 0.0);
    assert!(same.image == both && same.bias == 0.0);
}

#[test]
fn a_render_adds_a_preview_and_only_the_requested_layers() {
    let (world, camera) = room();
    let outputs = Outputs { aovs: vec![Aov::Normal, Aov::Depth], ..Outputs::default() };
    let params = Params { width: 40, height: 30, samples: 8, preview: 1.0, outputs, ..Params::default() };
    let film = render(&world, &camera, &params);
    let names: Vec<&str> = film.layers.iter().map(|l| l.name.as_str()).collect();
    assert_eq!(names, ["Normal", "Depth"]);
    let preview = film.preview.unwrap();
    // The preview leaves the main image unchanged, and has a smaller error than the main image.
    let plain = render(&world, &camera, &Params { preview: 0.0, ..params.clone() });
    assert!(plain.preview.is_none() && plain.beauty == film.beauty);
    let truth = render(&world, &camera, &Params { preview: 0.0, samples: 256, seed: 9, ..params.clone() }).beauty;
    let (before, after) = (rel_mse(&film.beauty, &truth), rel_mse(&preview.image, &truth));
    // Path sharing makes the errors of neighbours small but correlated, and averaging neighbours removes correlated
    // errors less well. So the filter need only halve the error here.
    assert!(after < before / 2.0, "from {before} to {after}");
    // At a tiny strength, the filter only averages the two halves.
    let weak = render(&world, &camera, &Params { preview: 1e-12, ..params.clone() }).preview.unwrap().image;
    assert!(weak.data.iter().zip(&film.beauty.data).all(|(a, b)| (a - b).abs() <= 1e-4 * b.abs()));
    // Even the first film, which is published after the coarse pass, has a preview.
    let monitor = Monitor::default();
    let mut published = 0;
    let all = run(&world, &camera, &params, monitor.job(), &mut |film| {
        published += usize::from(film.preview.as_ref().is_some_and(|p| p.image.count_non_finite() == 0));
        monitor.cancel();
    });
    assert!(all.is_err() && published > 0, "{published}");
}

#[test]
fn without_noise_the_image_is_unchanged() {
    let (world, camera) = room();
    let params = Params { width: 40, height: 30, samples: 8, ..Params::default() };
    let noisy = halves(&world, &camera, &params);
    let guide = features(&world, &camera, 40, 30);
    let plain = noisy.mean();
    let mut last = f64::INFINITY;
    for share in [1.0, 1e-1, 1e-2, 0.0] {
        // Keep a share of the noise: pull both halves towards their mean.
        let pull = |(half, mean): (&f32, &f32)| mean + share * (half - mean);
        let images = [0, 1].map(|i| {
            let data = noisy.images[i].data.iter().zip(&plain.data).map(pull).collect();
            Image { data, ..plain }
        });
        let variances = [0, 1].map(|i| {
            let data = noisy.variances[i].data.iter().map(|v| share * share * v).collect();
            Image { data, ..plain }
        });
        let output = smoothed(&Halves { images, variances }, &guide, 1.0);
        let moved = rel_mse(&output.image, &plain);
        assert!(moved < last || moved == 0.0, "{share}: {moved} after {last}");
        last = moved;
        if share == 0.0 {
            assert!(output.image == plain && output.error == 0.0 && output.interval.data.iter().all(|&v| v == 0.0));
        }
    }
}

#[test]
fn on_an_even_wall_noise_goes_and_the_mean_stays() {
    let wall = plane(64, 64, |_| Vec3::Z);
    let output = smoothed(&flat(64, 64, 0.0, |_| 2.0), &wall, 1.0);
    assert!(output.image.data.iter().all(|&v| v == 2.0) && output.bias == 0.0);
    let noisy = flat(64, 64, 0.5, |_| 2.0);
    let output = smoothed(&noisy, &wall, 1.0);
    // Before the filter, the mean of both halves has a variance of 0.5² / 2 = 0.125 in each pixel.
    let square = mean(&output.image.data.iter().map(|v| (v - 2.0) * (v - 2.0)).collect::<Vec<f32>>());
    assert!(square < 0.125 / 40.0, "{square}");
    // The filter moves the mean of the picture by less than the standard error of this mean, √(0.125 / 64²) = 0.0055.
    let moved = mean(&output.image.data) - mean(&noisy.mean().data);
    assert!(moved.abs() < 0.0055, "{moved}");
    assert!(output.bias < 0.02, "{}", output.bias);
}

#[test]
fn an_edge_in_the_guides_stays_sharp() {
    let half = |x: usize| if x < 32 { Vec3::Z } else { Vec3::X };
    let step = |x: usize| if x < 32 { 1.0 } else { 3.0 };
    let output = smoothed(&flat(64, 64, 0.5, step), &plane(64, 64, half), 1.0);
    for x in [31, 32] {
        let column: Vec<f32> = (0..64).map(|y| output.image.pixel(x, y)[0]).collect();
        // Unfiltered, the mean of a column has a standard error of 0.044.
        assert!((mean(&column) - f64::from(step(x))).abs() < 3.0 * 0.044, "column {x}: {}", mean(&column));
    }
}

/// The filter would blur a bright column that the guides do not show. The halves differ by d = √0.5 at all pixels, so a
/// half has the standard error d / √2 = 0.5 everywhere.
#[test]
fn no_half_moves_by_more_than_two_standard_errors() {
    let light = |x: usize| if x == 32 { 6.0 } else { 1.0 };
    let mut rng = crate::rng::Rng::new(5, &[]);
    let signs: Vec<f32> = (0..64 * 64).map(|_| if rng.normal() > 0.0 { 1.0 } else { -1.0 }).collect();
    let images = [0.5, -0.5].map(|share| {
        let noise = |x: usize, y: usize| share * 0.5f32.sqrt() * signs[y * 64 + x];
        Image::from_fn(64, 64, |x, y| [light(x) + noise(x, y); 3]).unwrap()
    });
    let halves = Halves { images, variances: [0, 1].map(|_| Image::from_fn(64, 64, |_, _| [0.25; 3]).unwrap()) };
    let output = smoothed(&halves, &plane(64, 64, |_| Vec3::Z), 1.0);
    let moved = |(a, b): (&f32, &f32)| (a - b).abs();
    let farthest = output.image.data.iter().zip(&halves.mean().data).map(moved).fold(0.0, f32::max);
    assert!(farthest > 0.99 && farthest < 1.0001, "{farthest}");
}

#[test]
fn narrow_pictures_and_any_number_of_threads_work() {
    for (width, height) in [(1, 1), (1, 40), (40, 1), (3, 2)] {
        let output = smoothed(&flat(width, height, 0.5, |_| 2.0), &plane(width, height, |_| Vec3::Z), 1.0);
        assert!(output.image.count_non_finite() + output.interval.count_non_finite() == 0, "{width} x {height}");
    }
    let (noisy, wall) = (flat(50, 30, 0.5, |x| x as f32), plane(50, 30, |_| Vec3::Z));
    let run = |threads| crate::exec::Pool::new(threads).unwrap().run(|| smoothed(&noisy, &wall, 1.0));
    let (one, three) = (run(1), run(3));
    assert!(one.image == three.image && one.interval == three.interval);
    assert!(one.bias == three.bias && one.error == three.error);
}

#[test]
fn a_picture_of_unknown_noise_is_filtered_and_states_no_error() {
    let wall = plane(64, 64, |_| Vec3::Z);
    let Halves { images: [one, _], .. } = flat(64, 64, 0.5, |_| 2.0);
    let unknown = || Image::from_fn(64, 64, |_, _| [f32::INFINITY; 3]).unwrap();
    let output = smoothed(&Halves { images: [one.clone(), one], variances: [unknown(), unknown()] }, &wall, 1.0);
    let square = mean(&output.image.data.iter().map(|v| (v - 2.0) * (v - 2.0)).collect::<Vec<f32>>());
    assert!(square < 0.25 / 40.0, "{square}");
    assert!(output.error == f64::INFINITY && output.interval.data.iter().all(|&v| v == f32::INFINITY));
}

#[test]
fn degenerate_images_give_numbers_or_an_error() {
    let monitor = Monitor::default();
    let image = |v: f32| Image::from_fn(5, 3, |_, _| [v; 3]).unwrap();
    let run = |values: [f32; 5]| {
        let [beauty, variance, albedo, normal, position] = values.map(image);
        let halves = [&beauty, &beauty];
        let variances = [&variance, &variance];
        let input = Input { halves, variances, albedo: &albedo, normal: &normal, position: &position };
        denoise::run(&input, &denoise::Params::default(), monitor.job())
    };
    for values in [
        [0.0; 5],
        [1.0, f32::INFINITY, 0.0, 0.0, f32::INFINITY],
        [1.0, f32::MAX, 1.0, 1.0, f32::MAX],
        [1e9, 1e18, 1e-30, f32::NAN, f32::NAN],
        [1e-9, 1e-18, f32::NAN, 0.5, 1e-30],
    ] {
        let output = run(values).unwrap();
        assert!(output.image.count_non_finite() == 0 && output.bias.is_finite(), "{values:?}: {:?}", output.image);
    }
    assert!(run([f32::NAN, 0.0, 0.0, 0.0, 0.0]).unwrap_err().message.contains("first half"));
    assert!(run([0.0, -1.0, 0.0, 0.0, 0.0]).unwrap_err().message.contains("variance is -1"));
    assert!(run([0.0, f32::NAN, 0.0, 0.0, 0.0]).is_err());
    let (small, other) = (image(0.0), Image::new(4, 3, 3).unwrap());
    let input = Input {
        halves: [&small, &small],
        variances: [&small, &small],
        albedo: &other,
        normal: &small,
        position: &small,
    };
    assert!(denoise::run(&input, &denoise::Params::default(), monitor.job()).unwrap_err().message.contains("albedo"));
}
