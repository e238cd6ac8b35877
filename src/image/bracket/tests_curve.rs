//! Tests of recovered tone curves on brackets that were taken through known curves.

use super::tests::{CAMERA, merged, room, run, with_time};
use super::*;
use crate::error::ErrorKind;
use crate::image::colour::{linear_to_srgb, srgb_to_linear};
use crate::rng::Rng;

const SIZE: [usize; 2] = [200, 160];

/// A camera's code in `[0, 1]` for the light of a channel in `[0, 1]`.
type Response = fn(f64) -> f64;

fn srgb(light: f64) -> f64 {
    f64::from(linear_to_srgb(light as f32))
}

/// An S-shaped curve: shadows and highlights compressed.
fn s_shaped(light: f64) -> f64 {
    let code = srgb(light);
    code - 0.05 * (std::f64::consts::TAU * code).sin()
}

/// A curve with a soft shoulder: dark values brightened.
fn shoulder(light: f64) -> f64 {
    srgb(light * 1.8 / (1.0 + 0.8 * light))
}

fn power(light: f64) -> f64 {
    light.powf(1.0 / 1.8)
}

/// Photographs a scene through a curve; returns the values that a loader decodes as sRGB.
fn shoot(scene: &Image, exposure: f64, response: Response, seed: u64) -> Image {
    Image::from_fn(scene.width, scene.height, |x, y| {
        let mut rng = Rng::new(seed, &[x as u64, y as u64]);
        [0, 1, 2].map(|c| {
            let light = f64::from(scene.pixel(x, y)[c]) * exposure;
            let noise = (light / CAMERA.electrons + (CAMERA.readout / CAMERA.electrons).powi(2)).sqrt();
            let code = (response((light + noise * rng.normal()).clamp(0.0, 1.0)) * 255.0).round() / 255.0;
            srgb_to_linear(code as f32)
        })
    })
    .unwrap()
}

fn bracket(scene: &Image, exposures: &[f64], response: Response) -> Vec<Image> {
    exposures.iter().zip(40..).map(|(&exposure, seed)| shoot(scene, exposure, response, seed)).collect()
}

/// Returns the root mean square and the largest of the logarithmic errors of the light of all pixels that the photos
/// show well, after their common scale is taken off.
fn errors(image: &Image, scene: &Image) -> [f64; 2] {
    let shown = image.data.iter().zip(&scene.data).filter(|(_, s)| (0.05..8.0).contains(*s));
    let logs: Vec<f64> = shown.map(|(v, s)| f64::from(v / s).ln()).collect();
    let mean = logs.iter().sum::<f64>() / logs.len() as f64;
    let square = logs.iter().map(|l| (l - mean).powi(2)).sum::<f64>() / logs.len() as f64;
    [square.sqrt(), logs.iter().map(|l| (l - mean).abs()).fold(0.0, f64::max)]
}

fn given(exposures: &[f64], tone_curve: ToneCurve) -> Params {
    Params { exposures: exposures.to_vec(), reference: Some(0), tone_curve, ..Params::default() }
}

/// The light, lamps beyond the range of the longest photo included, is right within a few percent, and several times
/// better than with the curve of sRGB. The stated error covers the curve's true error.
#[test]
fn known_exposures_recover_the_curve() {
    let scene = room(SIZE[0], SIZE[1], 3);
    let exposures = [1.0, 0.25, 0.0625];
    for (name, response) in [("S", s_shaped as Response), ("shoulder", shoulder), ("power", power)] {
        let photos = bracket(&scene, &exposures, response);
        let (image, report) = merged(&photos, &given(&exposures, ToneCurve::Recovered)).unwrap();
        let curve = report.curve.expect(name);
        let (plain, of_plain) = merged(&photos, &given(&exposures, ToneCurve::Srgb)).unwrap();
        let (ours, before) = (errors(&image, &scene), errors(&plain, &scene));
        println!("{name}: {ours:?}, sRGB {before:?}; stated {}", curve.error);
        assert!(ours[0] < 0.04 && ours[0] < 0.4 * before[0], "{name}: {ours:?} {before:?}");
        assert!(!report.contradicts_srgb && of_plain.contradicts_srgb && of_plain.curve.is_none(), "{name}");

        // The curve itself, relative to its brightest code: its inverse at the codes 3/16 to 12/16, which the photos
        // show.
        let light = |code: f64| (0..200_001).map(|i| f64::from(i) / 200_000.0).find(|&l| response(l) >= code).unwrap();
        let truth: Vec<f64> = (3..13).map(|k| light(f64::from(k) / 16.0).ln()).collect();
        let off: Vec<f64> = truth.iter().enumerate().map(|(i, t)| curve.light[i + 3].ln() - t).collect();
        let worst = off.iter().map(|o| (o - off[9]).abs()).fold(0.0, f64::max);
        println!("{name}: curve off by at most {worst}: {off:?}");
        assert!(worst < 3.0 * curve.error && curve.error < 0.3, "{name}: off by {worst}, stated {}", curve.error);
        assert!(curve.light.windows(2).all(|pair| pair[0] < pair[1]), "{name}: {:?}", curve.light);
    }
}

/// Metadata round exposures. The curve is then found with a larger stated error, and the exposures stay within it.
#[test]
fn metadata_recover_the_curve_too() {
    let scene = room(SIZE[0], SIZE[1], 4);
    let photos = bracket(&scene, &[1.0, 0.25, 0.0625], s_shaped);
    let all: Vec<&Image> = photos.iter().collect();
    let params = Params { reference: Some(0), ..Params::default() };
    // 1/4 s and 1/15 s, as cameras write them.
    let (image, report) = run(&all, &[1.0, 0.25, 1.0 / 15.0].map(with_time), &params).unwrap();
    let (curve, ours) = (report.curve.unwrap(), errors(&image, &scene));
    println!("{ours:?}, stated {}; exposures {:?}", curve.error, report.photos);
    assert!(ours[0] < 0.06 && curve.error < 0.4, "{ours:?} {}", curve.error);
    assert!((report.photos[2].exposure / 0.0625).ln().abs() < 0.1, "{report:?}");

    // The pixels cannot tell the exponent of the curve: none is recovered, but the report says that sRGB is wrong.
    let (_, report) = run(&all, &[PhotoMetadata::default(); 3], &params).unwrap();
    assert!(report.curve.is_none() && report.contradicts_srgb);
    let by_pixels = Params { source: Source::Pixels, ..params.clone() };
    let (_, report) = run(&all, &[1.0, 0.25, 0.0625].map(with_time), &by_pixels).unwrap();
    assert!(report.curve.is_none() && report.contradicts_srgb);
}

/// With the curve taken for that of sRGB, metadata and pixels contradict each other.
#[test]
fn a_tone_curve_of_the_camera_contradicts_the_metadata() {
    let scene = room(SIZE[0], SIZE[1], 12);
    let stronger = |light: f64| srgb(light) - 0.08 * (std::f64::consts::TAU * srgb(light)).sin();
    let photos = bracket(&scene, &[1.0, 0.25, 0.0625], stronger);
    let all: Vec<&Image> = photos.iter().collect();
    let times = [1.0, 0.25, 0.0625].map(with_time);
    let params = Params { tone_curve: ToneCurve::Srgb, ..Params::default() };
    let error = run(&all, &times, &params).unwrap_err();
    assert_eq!(error.kind, ErrorKind::InvalidArgument);
    assert!(error.message.contains("not linear"), "{error}");
    for source in [Source::Metadata, Source::Pixels] {
        // The exposures differ, so the result keeps the reference's values where the reference is not clipped.
        let params = Params { source, reference: Some(0), ..params.clone() };
        let (image, _) = run(&all, &times, &params).unwrap();
        let shown = image.data.iter().zip(&photos[0].data).filter(|(_, p)| (0.05..0.7).contains(*p));
        let worst = shown.map(|(v, p)| (v / p - 1.0).abs()).fold(0.0, f32::max);
        assert!(worst < 0.2, "{source:?}: {worst}");
    }
    // Recovered, they agree.
    let (_, report) = run(&all, &times, &Params::default()).unwrap();
    assert!(report.curve.is_some());
}

/// Linear photos keep their values: no curve is recovered from noise.
#[test]
fn linear_photos_keep_the_curve_of_srgb() {
    for seed in 0..12 {
        let scene = room(SIZE[0], SIZE[1], seed);
        let exposures = [1.0, 0.25, 0.0625];
        let photos = bracket(&scene, &exposures, srgb);
        let (image, report) = merged(&photos, &given(&exposures, ToneCurve::Recovered)).unwrap();
        assert!(report.curve.is_none() && !report.contradicts_srgb, "{seed}: {report:?}");
        let (plain, _) = merged(&photos, &given(&exposures, ToneCurve::Srgb)).unwrap();
        assert_eq!(image, plain);
    }
}

/// Two photos, equal exposures, photos that clip everything, and photos of nothing but noise.
#[test]
fn what_does_not_determine_a_curve_leaves_that_of_srgb() {
    let scene = room(SIZE[0], SIZE[1], 6);
    // Two photos suffice if their ranges overlap.
    let photos = bracket(&scene, &[1.0, 0.3], shoulder);
    let (image, report) = merged(&photos, &given(&[1.0, 0.3], ToneCurve::Recovered)).unwrap();
    let ours = errors(&image, &scene);
    println!("two photos: {ours:?}, stated {}", report.curve.unwrap().error);
    assert!(report.curve.unwrap().error > 0.0);
    // Equal exposures say nothing about the curve, and do not contradict it.
    let photos = bracket(&scene, &[0.5, 0.5], shoulder);
    let (_, report) = merged(&photos, &given(&[1.0, 1.0], ToneCurve::Recovered)).unwrap();
    assert!(report.curve.is_none() && !report.contradicts_srgb, "{report:?}");
    // All pixels are clipped: no curve, and the report states it.
    let white = Image::from_fn(SIZE[0], SIZE[1], |_, _| [1.0; 3]).unwrap();
    let (_, report) = merged(&[white.clone(), white.clone()], &given(&[1.0, 0.25], ToneCurve::Recovered)).unwrap();
    assert!(report.curve.is_none() && report.clipped == 1.0);
    let error = merged(&[white.clone(), white], &Params::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Degenerate);
    // Photos without a common view.
    let noise = |seed: u64| {
        Image::from_fn(SIZE[0], SIZE[1], |x, y| {
            let mut rng = Rng::new(seed, &[x as u64, y as u64]);
            [0; 3].map(|_| srgb_to_linear(rng.next_f32()))
        })
        .unwrap()
    };
    let (_, report) = merged(&[noise(1), noise(2)], &given(&[1.0, 0.25], ToneCurve::Recovered)).unwrap();
    assert!(report.curve.is_none_or(|curve| curve.error.is_finite()), "{report:?}");
    // A photo of one value has too few levels.
    let grey = |v: f32| Image::from_fn(SIZE[0], SIZE[1], |_, _| [v; 3]).unwrap();
    let (_, report) = merged(&[grey(0.5), grey(0.2)], &given(&[1.0, 0.25], ToneCurve::Recovered)).unwrap();
    assert!(report.curve.is_none());
}

/// The order of the photos and alpha do not matter to the curve.
#[test]
fn permuted_photos_give_one_curve() {
    let scene = room(SIZE[0], SIZE[1], 7);
    let exposures = [1.0, 0.25, 0.0625];
    let photos = bracket(&scene, &exposures, s_shaped);
    let (image, report) = merged(&photos, &given(&exposures, ToneCurve::Recovered)).unwrap();
    let turned = [photos[2].clone(), photos[0].clone(), photos[1].clone()];
    let params = Params { reference: Some(1), ..given(&[0.0625, 1.0, 0.25], ToneCurve::Recovered) };
    let (other, of_other) = merged(&turned, &params).unwrap();
    assert!(image == other && report.curve == of_other.curve);
}
