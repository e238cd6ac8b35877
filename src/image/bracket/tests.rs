use super::*;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::image::colour::{linear_to_srgb, srgb_to_linear};
use crate::job::Monitor;
use crate::rng::{Rng, hash};

/// A camera that counts electrons, adds readout noise, clips, and writes 8-bit sRGB.
#[derive(Clone, Copy)]
pub(super) struct Camera {
    /// Electrons at the value 1.
    pub electrons: f64,
    /// Standard deviation of the readout noise in electrons.
    pub readout: f64,
}

pub(super) const CAMERA: Camera = Camera { electrons: 20_000.0, readout: 4.0 };

impl Camera {
    /// Photographs a scene with an exposure. Pixel (0, 0) of the photo shows the scene's pixel `corner`.
    fn shoot(self, scene: &Image, exposure: f64, corner: [usize; 2], size: [usize; 2], seed: u64) -> Image {
        Image::from_fn(size[0], size[1], |x, y| {
            let mut rng = Rng::new(seed, &[x as u64, y as u64]);
            let of = scene.pixel(x + corner[0], y + corner[1]);
            [0, 1, 2].map(|c| {
                let photons = poisson(f64::from(of[c]) * exposure * self.electrons, &mut rng);
                let value = (photons + self.readout * rng.normal()) / self.electrons;
                let code = (linear_to_srgb(value.clamp(0.0, 1.0) as f32) * 255.0).round();
                srgb_to_linear(code / 255.0)
            })
        })
        .unwrap()
    }

    /// Variance of a value that is not clipped: photons, readout, and rounding to codes.
    fn variance(self, value: f64) -> f64 {
        let code = f64::from(linear_to_srgb(value as f32)) * 255.0;
        let step =
            f64::from(srgb_to_linear(((code + 0.5) / 255.0) as f32) - srgb_to_linear(((code - 0.5) / 255.0) as f32));
        value / self.electrons + (self.readout / self.electrons).powi(2) + step * step / 12.0
    }
}

/// A Poisson deviate; from a mean of 200 on, the normal approximation.
fn poisson(mean: f64, rng: &mut Rng) -> f64 {
    if mean > 200.0 {
        return (mean + mean.sqrt() * rng.normal()).round().max(0.0);
    }
    let (mut product, mut count) = (rng.next_f64(), 0.0);
    while product > (-mean).exp() {
        product *= rng.next_f64();
        count += 1.0;
    }
    count
}

/// A room: surfaces of many shades with a gradient, and four lamps of different colours.
pub(super) fn room(width: usize, height: usize, seed: u64) -> Image {
    Image::from_fn(width, height, |x, y| {
        let mut rng = Rng::new(seed, &[x as u64 / 7, y as u64 / 5]);
        let shade = 0.02 * 25f32.powf(rng.next_f32()) * (0.6 + 0.4 * x as f32 / width as f32);
        let colour = [0.8 + 0.4 * rng.next_f32(), 1.0, 0.8 + 0.4 * rng.next_f32()];
        let lamp = (0..4).find(|&k| {
            let centre = [(k * 2 + 1) * width / 8, height / 4];
            x.abs_diff(centre[0]) * 16 < width && y.abs_diff(centre[1]) * 16 < height
        });
        match lamp {
            Some(k) => [[6.0, 5.0, 3.0], [3.0, 3.5, 4.0], [9.0, 2.0, 1.5], [2.5, 2.5, 2.5]][k],
            None => colour.map(|c| c * shade),
        }
    })
    .unwrap()
}

pub(super) fn run(photos: &[&Image], metadata: &[PhotoMetadata], params: &Params) -> Result<(Image, Report)> {
    Pool::new(2).unwrap().run(|| merge(photos, metadata, params, Monitor::default().job()))
}

/// Merges photos without metadata.
pub(super) fn merged(photos: &[Image], params: &Params) -> Result<(Image, Report)> {
    run(&photos.iter().collect::<Vec<_>>(), &vec![PhotoMetadata::default(); photos.len()], params)
}

/// Returns a scene of a room, and three photos of it. Each exposure is a quarter of the exposure before it.
fn three(width: usize, height: usize, seed: u64) -> (Image, Vec<Image>) {
    let scene = room(width, height, seed);
    let shoot = |k: u64| CAMERA.shoot(&scene, 0.25f64.powi(k as i32), [0, 0], [width, height], hash(seed, &[k]));
    let photos = vec![shoot(0), shoot(1), shoot(2)];
    (scene, photos)
}

#[test]
fn a_single_photo_and_what_only_the_reference_shows_keep_their_bits() {
    let (_, photos) = three(64, 48, 1);
    let (image, report) = merged(&photos[..1], &Params::default()).unwrap();
    assert_eq!(image, photos[0]);
    assert_eq!((report.reference, report.moved, report.photos[0].exposure), (0, 0.0, 1.0));
    let clipped = photos[0].data.chunks(3).filter(|p| p.iter().any(|&v| v >= 0.95)).count();
    assert_eq!(report.clipped, clipped as f64 / (64.0 * 48.0));
    // A second photo that is clipped everywhere adds nothing.
    let white = Image { data: vec![1.0; photos[2].data.len()], ..photos[2].clone() };
    let params = Params { exposures: vec![1.0, 1e6], ..Params::default() };
    let (image, report) = merged(&[photos[2].clone(), white], &params).unwrap();
    assert_eq!(image, photos[2]);
    assert_eq!(report.reference, 0);
}

#[test]
fn the_merged_noise_is_that_of_the_theory() {
    // Grey patches from black to far beyond the range of the longest exposure, 32 x 32 pixels each.
    let levels: Vec<f64> = (0..16).map(|k| 0.003 * 1.8f64.powi(k)).collect();
    let scene = Image::from_fn(512, 32, |x, _| [levels[x / 32] as f32; 3]).unwrap();
    let exposures = [1.0, 0.25, 0.0625];
    let photos: Vec<Image> =
        (0..3).map(|k| CAMERA.shoot(&scene, exposures[k], [0, 0], [512, 32], 77 + k as u64)).collect();
    let params = Params { exposures: exposures.to_vec(), reference: Some(0), ..Params::default() };
    let (image, report) = merged(&photos, &params).unwrap();
    assert_eq!(report.moved, 0.0, "nothing moves");
    for (k, &level) in levels.iter().enumerate() {
        let values: Vec<f64> =
            (0..32 * 32).flat_map(|i| image.pixel(32 * k + i % 32, i / 32).iter().map(|&v| f64::from(v))).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let error = (values.iter().map(|v| (v - level).powi(2)).sum::<f64>() / values.len() as f64).sqrt();
        // The Cramér-Rao bound from all exposures that are not faded: an exposure e has the Fisher information e² /
        // variance.
        let information = |e: f64| if e * level < 0.72 { e * e / CAMERA.variance(e * level) } else { 0.0 };
        let total: f64 = exposures.iter().map(|&e| information(e)).sum();
        if total == 0.0 {
            continue;
        }
        let bound = total.powf(-0.5);
        // There are 3072 values, so the standard error of their standard deviation is 1.3 % of it, and the standard
        // error of their mean is 1.8 % of it. The limit of the mean is wider, because the error that rounding to codes
        // adds to one patch is not random.
        assert!(error < 1.12 * bound, "level {level}: error {error}, bound {bound}");
        assert!((mean - level).abs() < 0.25 * bound, "level {level}: mean {mean}, bound {bound}");
    }
}

#[test]
fn ratios_lie_in_their_intervals() {
    let (trials, mut inside, mut sum, mut squares) = (300, 0, 0.0, 0.0);
    for seed in 0..trials {
        let scene = room(96, 80, seed);
        let exact = [2.0, 4.0, 7.3][seed as usize % 3];
        let shoot = |exposure: f64, k: u64| CAMERA.shoot(&scene, exposure, [0, 0], [96, 80], hash(seed, &[k]));
        let (long, short) = (shoot(0.8, 1), shoot(0.8 / exact, 2));
        let frames = [Frame::new(&short, 0.95), Frame::new(&long, 0.95)];
        let samples = ratio::samples(&frames[0], &frames[1], [96, 80], Monitor::default().job()).unwrap();
        let found = ratio::measure(&samples, 0.95).unwrap().unwrap();
        let off = (found.log - exact.ln()) / found.error;
        inside += usize::from(off.abs() < 1.96);
        sum += off;
        squares += off * off;
        assert!(found.error < 0.003, "{found:?}");
    }
    // Three quantities are tested: the share of the 95 % intervals that hold the true ratio, and the mean and the mean
    // square of the errors in units of their standard errors. Each limit is three and a half standard deviations of its
    // quantity.
    let n = trials as f64;
    let share = inside as f64 / n;
    assert!(
        (share - 0.95).abs() < 3.5 * (0.95 * 0.05 / n).sqrt(),
        "{share} inside, mean {}, square {}",
        sum / n,
        squares / n
    );
    assert!((sum / n).abs() < 3.5 / n.sqrt(), "mean {}", sum / n);
    assert!((squares / n - 1.0).abs() < 3.5 * (2.0 / n).sqrt(), "mean square {}", squares / n);
}

#[test]
fn shifts_of_whole_pixels_are_found_exactly() {
    for seed in 0..24 {
        let scene = room(200, 160, 900 + seed);
        let mut rng = Rng::new(seed, &[5]);
        let corners: Vec<[usize; 2]> = (0..3).map(|_| [rng.below(17), rng.below(17)]).collect();
        let photos: Vec<Image> = (0..3)
            .map(|k| CAMERA.shoot(&scene, 0.25f64.powi(k as i32), corners[k], [180, 140], hash(seed, &[k as u64])))
            .collect();
        let params = Params { max_shift: 0.1, ..Params::default() };
        let (image, report) = merged(&photos, &params).unwrap();
        let from = corners[report.reference];
        for (k, photo) in report.photos.iter().enumerate() {
            let expected = [0, 1].map(|axis| from[axis] as isize - corners[k][axis] as isize);
            assert_eq!(photo.shift, expected, "seed {seed}, photo {k}");
        }
        // The result has the pixel grid of the reference photo.
        let scale = f64::from(0.25f32.powi(report.reference as i32));
        let errors = (20..120).map(|y| {
            let exact = f64::from(scene.pixel(90 + from[0], y + from[1])[1]) * scale;
            (f64::from(image.pixel(90, y)[1]) / exact - 1.0).abs()
        });
        assert!(errors.fold(0.0, f64::max) < 0.2, "seed {seed}");
    }
}

#[test]
fn lamps_get_their_colours_and_luminances() {
    let (scene, photos) = three(160, 120, 3);
    let (image, report) = merged(&photos, &Params { reference: Some(0), ..Params::default() }).unwrap();
    for (k, exact) in [1.0, 0.25, 0.0625].into_iter().enumerate() {
        let photo = report.photos[k];
        assert!((photo.exposure / exact).ln().abs() <= 4.0 * photo.error, "{photo:?}");
        assert!(photo.error < 0.003 && photo.shift == [0, 0] && photo.stated == 0.0, "{photo:?}");
    }
    for k in 0..4 {
        let centre = [(k * 2 + 1) * 20, 30];
        for c in 0..3 {
            let window = || (0..25).map(|i| (centre[0] + i % 5 - 2, centre[1] + i / 5 - 2));
            let mean = window().map(|(x, y)| image.pixel(x, y)[c]).sum::<f32>() / 25.0;
            let exact = scene.pixel(centre[0], centre[1])[c];
            assert!((mean / exact - 1.0).abs() < 0.01, "lamp {k}: {mean} for {exact}");
        }
    }
    assert_eq!(report.clipped, 0.0);
    // With another reference photo, the result has the scale of that photo.
    let (scaled, _) = merged(&photos, &Params { reference: Some(1), ..Params::default() }).unwrap();
    let mean = |image: &Image| image.data.iter().map(|&v| f64::from(v)).sum::<f64>();
    assert!((4.0 * mean(&scaled) / mean(&image) - 1.0).abs() < 0.003);
}

#[test]
fn what_moves_is_taken_from_the_reference() {
    let (scene, mut photos) = three(160, 120, 4);
    assert!(merged(&photos, &Params::default()).unwrap().1.moved < 2e-4, "nothing moves");
    // A dark figure stands at another place in each photo.
    let figures = [20, 60, 100];
    for (k, &left) in figures.iter().enumerate() {
        let mut with = scene.clone();
        for y in 60..110 {
            (left..left + 20).for_each(|x| with.pixel_mut(x, y).copy_from_slice(&[0.004, 0.005, 0.006]));
        }
        photos[k] = CAMERA.shoot(&with, 0.25f64.powi(k as i32), [0, 0], [160, 120], 50 + k as u64);
    }
    let params = Params { reference: Some(0), ..Params::default() };
    let (image, report) = merged(&photos, &params).unwrap();
    // Three figures of 20 x 50 pixels, with fringes of up to three pixels.
    let area = 3.0 * 20.0 * 50.0 / (160.0 * 120.0);
    assert!(report.moved > 0.95 * area && report.moved < 3.0 * 26.0 * 56.0 / (160.0 * 120.0), "{}", report.moved);
    for y in 60..110 {
        for x in 0..160 {
            let (found, shown) = (image.pixel(x, y), photos[0].pixel(x, y));
            for c in 0..3 {
                let sigma = CAMERA.variance(f64::from(shown[c])).sqrt() as f32;
                assert!((found[c] - shown[c]).abs() < 6.0 * sigma, "({x}, {y}): {} for {}", found[c], shown[c]);
            }
        }
    }
    // Without the rejection, the figures of the other photos shine through.
    let (ghosts, report) = merged(&photos, &Params { keep_moving: true, ..params }).unwrap();
    assert_eq!(report.moved, 0.0);
    assert!(ghosts.data.iter().zip(&image.data).any(|(a, b)| (a - b).abs() > 0.02));
}

#[test]
fn any_order_and_any_number_of_threads_give_the_same_bits() {
    let (_, photos) = three(150, 90, 5);
    let params = Params { exposures: vec![1.0, 0.25, 0.0625], ..Params::default() };
    let (image, report) = merged(&photos, &params).unwrap();
    for order in [[2, 1, 0], [1, 2, 0], [0, 2, 1]] {
        let shuffled: Vec<&Image> = order.iter().map(|&k| &photos[k]).collect();
        let exposures = order.iter().map(|&k: &usize| params.exposures[k]).collect();
        let params = Params { exposures, ..params.clone() };
        let (other, found) = run(&shuffled, &[PhotoMetadata::default(); 3], &params).unwrap();
        assert_eq!(order[found.reference], report.reference);
        assert!(other == image, "{order:?}");
    }
    let all: Vec<&Image> = photos.iter().collect();
    let with = |threads: usize| {
        let pool = Pool::new(threads).unwrap();
        pool.run(|| merge(&all, &[PhotoMetadata::default(); 3], &Params::default(), Monitor::default().job())).unwrap()
    };
    let one = with(1);
    assert!(with(2) == one && with(7) == one);
}

/// Metadata of an exposure time.
pub(super) fn with_time(seconds: f64) -> PhotoMetadata {
    PhotoMetadata { exposure_time: Some(seconds), ..PhotoMetadata::default() }
}

#[test]
fn metadata_are_checked_against_the_pixels() {
    let (_, photos) = three(96, 80, 6);
    let all: Vec<&Image> = photos.iter().collect();
    // Rounded times, as cameras write them: 1/15, 1/60, 1/250.
    let rounded = [15.0, 60.0, 250.0].map(|t: f64| with_time(1.0 / t));
    let (_, report) = run(&all, &rounded, &Params { reference: Some(0), ..Params::default() }).unwrap();
    assert!((report.photos[1].exposure / 0.25 - 1.0).abs() < 0.005, "{report:?}");
    assert!((report.photos[2].stated - 15.0 / 250.0).abs() < 1e-12, "{report:?}");
    let trusting = Params { source: Source::Metadata, reference: Some(0), ..Params::default() };
    let (_, report) = run(&all, &rounded, &trusting).unwrap();
    assert!((report.photos[2].exposure - 0.06).abs() < 1e-12 && report.photos[2].error > 0.05);

    let wrong = [15.0, 30.0, 125.0].map(|t: f64| with_time(1.0 / t));
    let error = run(&all, &wrong, &Params::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::InvalidArgument);
    assert!(error.message.contains("photos[1] and photos[0]") && error.message.contains("ratio 2.0000"), "{error}");
    let (_, report) =
        run(&all, &wrong, &Params { source: Source::Pixels, reference: Some(0), ..Params::default() }).unwrap();
    assert!((report.photos[1].exposure / 0.25 - 1.0).abs() < 0.005);
    let error = run(&all, &[PhotoMetadata::default(); 3], &trusting).unwrap_err();
    assert_eq!(error.kind, ErrorKind::InvalidArgument);
    assert!(error.message.contains("LUXFER_EXPOSURE_SOURCE_METADATA"), "{error}");
}

#[test]
fn photos_without_noise_that_are_multiples_of_each_other_have_the_stated_ratio() {
    let long = Image::from_fn(64, 48, |x, y| [(1 + (7 * x + 13 * y) % 50) as f32 / 64.0; 3]).unwrap();
    let short = Image { data: long.data.iter().map(|v| v / 64.0).collect(), ..long.clone() };
    let times = [with_time(1.0), with_time(1.0 / 64.0)];
    let (image, report) = run(&[&long, &short], &times, &Params { reference: Some(0), ..Params::default() }).unwrap();
    assert!((64.0 * report.photos[1].exposure - 1.0).abs() < 1e-5, "{}", report.photos[1].exposure);
    assert_eq!(image.count_non_finite(), 0);
}

#[test]
fn exposures_that_f32_cannot_divide_by_are_refused() {
    let (_, photos) = three(64, 48, 1);
    let metadata: Vec<PhotoMetadata> = [1.0, 1e-12, 1e8].map(with_time).into();
    let photos: Vec<&Image> = photos.iter().collect();
    let params = Params { source: Source::Metadata, reference: Some(1), ..Params::default() };
    let error = run(&photos, &metadata, &params).unwrap_err();
    assert!(error.message.contains("1.00e20") && error.message.contains("[1e-18, 1e18]"), "{error}");
}

#[test]
fn stated_ratios_follow_time_speed_and_aperture() {
    let all = |t, n, s| PhotoMetadata { f_number: Some(n), iso: Some(s), ..with_time(t) };
    let ratio = exposures::stated_ratio(&all(0.01, 4.0, 100.0), &all(0.02, 2.8, 200.0)).unwrap();
    assert!((ratio - 2.0 * 2.0 * (4.0f64 / 2.8).powi(2)).abs() < 1e-12);
    assert_eq!(exposures::stated_ratio(&with_time(0.01), &with_time(0.03)), Some(3.0));
    assert_eq!(exposures::stated_ratio(&with_time(0.01), &all(0.03, 4.0, 100.0)), None);
    assert_eq!(exposures::stated_ratio(&PhotoMetadata::default(), &with_time(0.03)), None);
}

#[test]
fn bad_brackets_are_refused_with_the_parameter_and_its_value() {
    let (_, photos) = three(64, 48, 7);
    let refused = |photos: &[Image], params: Params, words: &[&str]| {
        let error = merged(photos, &params).unwrap_err();
        assert_eq!(error.kind, ErrorKind::InvalidArgument, "{error}");
        assert!(words.iter().all(|word| error.message.contains(word)), "{error}");
    };
    let usual = Params::default;
    refused(&[], usual(), &["count is 0", "1 to 16"]);
    refused(&vec![photos[0].clone(); 17], usual(), &["count is 17", "1 to 16"]);
    let small = Image::new(32, 48, 3).unwrap();
    refused(&[photos[0].clone(), small], usual(), &["photos[1] is 32 x 48", "64 x 48"]);
    let grey = photos[1].channel(0).unwrap();
    refused(&[photos[0].clone(), grey], usual(), &["photos[1] has 1 channels", "photos[0] has 3"]);
    refused(&[Image::new(9, 9, 2).unwrap()], usual(), &["photos[0] has 2 channels", "1, 3 or 4"]);
    for value in [f32::NAN, f32::INFINITY] {
        let mut broken = photos.clone();
        broken[2].data[100] = value;
        refused(&broken, usual(), &["photos[2] has 1 samples", "NaN or infinite"]);
        refused(&broken[2..], usual(), &["photos[0] has 1 samples"]);
    }
    refused(&photos, Params { exposures: vec![1.0, 2.0], ..usual() }, &["2 values for 3 photos"]);
    for value in [0.0, -1.0, 1e-40, 2e9, f64::NAN, f64::INFINITY] {
        refused(&photos, Params { exposures: vec![1.0, value, 2.0], ..usual() }, &["exposures[1] is", "[1e-9, 1e9]"]);
    }
    refused(&photos, Params { reference: Some(3), ..usual() }, &["reference is 3"]);
    refused(&photos, Params { max_shift: 0.3, ..usual() }, &["max_shift is 0.3", "[0, 0.25]"]);
    refused(&photos, Params { saturation: f64::NAN, ..usual() }, &["saturation is NaN", "[0.1, 1]"]);
}

#[test]
fn brackets_without_common_pixels_need_stated_exposures() {
    let of = |value: f32| Image { data: vec![value; 64 * 48 * 3], ..Image::new(64, 48, 3).unwrap() };
    for values in [[1.0, 1.0], [0.0, 0.0], [0.0, 1.0]] {
        let photos = values.map(of);
        let error = merged(&photos, &Params::default()).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.message.contains("set params.exposures"), "{error}");
        // With stated exposures, a clipped pixel gets the lower bound that the shortest exposure gives.
        let params = Params { exposures: vec![0.5, 1.0], reference: Some(1), ..Params::default() };
        let (image, report) = merged(&photos, &params).unwrap();
        let expected = if values[0] == 1.0 { 2.0 } else { 0.0 };
        assert!(image.data.iter().all(|&v| v == expected), "{values:?}: {}", image.data[0]);
        assert_eq!(report.clipped, f64::from(u8::from(values[0] == 1.0)));
    }
}

#[test]
fn equal_photos_give_their_mean_and_a_ratio_of_one() {
    let (_, photos) = three(96, 80, 8);
    let twice = vec![photos[1].clone(), photos[1].clone()];
    let (image, report) = merged(&twice, &Params::default()).unwrap();
    assert!(report.photos.iter().all(|p| (p.exposure - 1.0).abs() < 1e-6 && p.shift == [0, 0]), "{report:?}");
    assert!(image.data.iter().zip(&photos[1].data).all(|(a, b)| (a - b).abs() <= 1e-6 * b.max(1.0)));
    assert_eq!(report.moved, 0.0);
}

#[test]
fn a_photo_of_a_high_dynamic_range_is_never_clipped() {
    let (scene, photos) = three(96, 80, 9);
    let mixed = vec![photos[0].clone(), scene.clone()];
    let (image, report) = merged(&mixed, &Params { reference: Some(0), ..Params::default() }).unwrap();
    assert!((report.photos[1].exposure - 1.0).abs() < 0.003 && report.clipped == 0.0, "{report:?}");
    let worst = image.data.iter().zip(&scene.data).filter(|(_, s)| **s > 1.0).map(|(a, b)| (a / b - 1.0).abs());
    assert!(worst.fold(0.0, f32::max) < 0.005);
}

#[test]
fn alpha_is_that_of_the_reference() {
    let (_, photos) = three(64, 48, 10);
    let with_alpha = |photo: &Image, alpha: f32| {
        let data = photo.data.chunks(3).flat_map(|p| [p[0], p[1], p[2], alpha]).collect();
        Image { channels: 4, data, ..*photo }
    };
    let four: Vec<Image> = photos.iter().zip([0.3, 0.6, 0.9]).map(|(p, a)| with_alpha(p, a)).collect();
    let params = Params { exposures: vec![1.0, 0.25, 0.0625], reference: Some(1), ..Params::default() };
    let (image, _) = merged(&four, &params).unwrap();
    let (opaque, _) = merged(&photos, &params).unwrap();
    assert!(image == with_alpha(&opaque, 0.6));
}

#[test]
fn a_cancelled_merge_ends_with_an_error() {
    let (_, photos) = three(64, 48, 11);
    let monitor = Monitor::default();
    monitor.cancel();
    let all: Vec<&Image> = photos.iter().collect();
    let error = merge(&all, &[PhotoMetadata::default(); 3], &Params::default(), monitor.job()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Cancelled);
}

#[test]
fn shifts_by_parts_of_a_pixel_are_not_taken_for_motion() {
    // A pixel of a photo covers 4 × 4 pixels of the scene. The second photo is shifted by (1.5, 0.75) pixels, the third
    // by (-0.5, 0.25).
    let fine = room(800, 640, 13);
    let size = [180, 140];
    let photos: Vec<Image> = [[20, 20], [26, 23], [18, 21]]
        .iter()
        .enumerate()
        .map(|(k, corner)| {
            let scene = Image::from_fn(size[0], size[1], |x, y| {
                let quarters = (0..16).map(|i| fine.rgb(4 * x + corner[0] + i % 4, 4 * y + corner[1] + i / 4));
                (quarters.sum::<glam::Vec3>() / 16.0).to_array()
            })
            .unwrap();
            CAMERA.shoot(&scene, 0.25f64.powi(k as i32), [0, 0], size, 60 + k as u64)
        })
        .collect();
    let (_, report) = merged(&photos, &Params { reference: Some(0), ..Params::default() }).unwrap();
    assert!(report.moved < 0.01, "{report:?}");
    let [_, second, third] = report.photos[..] else { panic!("three photos") };
    assert!((second.exposure / 0.25).ln().abs() < 4.0 * second.error.max(0.003), "{report:?}");
    assert!((-2..=-1).contains(&second.shift[0]) && (-1..=0).contains(&second.shift[1]), "{report:?}");
    assert!((0..=1).contains(&third.shift[0]) && (-1..=0).contains(&third.shift[1]), "{report:?}");
}
