//! Compares warps with exact means over footprints, and tests extreme sizes and maps.

use super::warp;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::geometry::Homography;
use crate::image::Image;
use crate::job::Monitor;
use crate::rng::Rng;
use crate::simd::forced;
use glam::{DMat3, DVec2, DVec3};

#[test]
fn a_minified_checker_averages_and_the_identity_is_the_identity() {
    let checker = Image::from_fn(400, 400, |x, y| [f32::from((x + y) % 2 == 0)]).unwrap();
    let monitor = Monitor::default();
    let shrink = Homography(DMat3::from_scale(DVec2::splat(8.3)));
    let small = warp(&checker, &shrink, 48, 48, monitor.job()).unwrap();
    for y in 1..46 {
        for x in 1..46 {
            assert!((small.pixel(x, y)[0] - 0.5).abs() < 0.01, "{}", small.pixel(x, y)[0]);
        }
    }
    let same = warp(&checker, &Homography(DMat3::IDENTITY), 400, 400, monitor.job()).unwrap();
    assert!(same.data.iter().zip(&checker.data).all(|(a, b)| (a - b).abs() < 1e-6));
    // Pixels outside the source or behind the camera are 0.
    let away = Homography(DMat3::from_translation(DVec2::new(1e4, 0.0)));
    assert!(warp(&checker, &away, 8, 8, monitor.job()).unwrap().data.iter().all(|&v| v == 0.0));
    let white = Image::from_fn(50, 50, |_, _| [1.0f32]).unwrap();
    let tilted = DMat3::from_cols(DVec3::new(1.0, 0.0, 0.0), DVec3::new(0.0, 1.0, -0.025), DVec3::Z);
    let seen = warp(&white, &Homography(tilted), 50, 78, monitor.job()).unwrap();
    assert!((41..78).all(|y| seen.row(y).iter().all(|&v| v == 0.0)));
}

/// A pattern of bars and discs, as fine as the source can represent.
fn drawing(p: DVec2) -> f32 {
    let bar = p.x.rem_euclid(23.0) < 9.0;
    let disc = (p - (p / 31.0).floor() * 31.0 - DVec2::splat(15.5)).length() < 11.0;
    0.1 + 0.5 * f32::from(bar) + 0.3 * f32::from(disc)
}

/// Returns the mean of the drawing over the footprint of the pixel at (x, y), from `sub` × `sub` samples.
fn mean_of_drawing(map: &Homography, x: usize, y: usize, sub: usize) -> f32 {
    let at = |k: usize| DVec2::new((k % sub) as f64 + 0.5, (k / sub) as f64 + 0.5) / sub as f64;
    let sum: f32 = (0..sub * sub).map(|k| drawing(map.apply(DVec2::new(x as f64, y as f64) + at(k)))).sum();
    sum / (sub * sub) as f32
}

#[test]
fn warps_are_means_over_the_footprints_of_pixels() {
    let monitor = Monitor::default();
    let identity = Homography(DMat3::IDENTITY);
    let source = Image::from_fn(512, 512, |x, y| [mean_of_drawing(&identity, x, y, 6)]).unwrap();
    let centred = |turn: f64, scale: f64, tilt: DVec2| {
        let tilted = DMat3::from_cols(DVec3::new(1.0, 0.0, tilt.x), DVec3::new(0.0, 1.0, tilt.y), DVec3::Z);
        let map = DMat3::from_angle(turn) * DMat3::from_scale(DVec2::splat(scale)) * tilted;
        let [to, from] = [256.0, -32.0].map(|c| DMat3::from_translation(DVec2::splat(c)));
        Homography(to * map * from)
    };
    // The maps are the identity, a rotation, and tilts and reductions, for which the filter uses pyramid levels and
    // divides the footprint of a pixel into several parts. The last number is the minimum peak signal-to-noise ratio in
    // dB. The true signal is the mean of the drawing over the footprint, from 12 × 12 samples; in the first case, these
    // samples limit the ratio.
    for (turn, scale, tilt, min_decibels) in [
        (0.0, 1.0, DVec2::ZERO, 50.0),
        (0.4, 1.0, DVec2::ZERO, 38.0),
        (0.7, 2.2, DVec2::new(0.004, 0.006), 39.0),
        (0.0, 2.5, DVec2::new(0.0, 0.02), 37.0),
        (0.3, 5.0, DVec2::new(0.003, 0.0), 36.0),
        (1.0, 7.0, DVec2::ZERO, 29.0),
    ] {
        let map = centred(turn, scale, tilt);
        let found = warp(&source, &map, 64, 64, monitor.job()).unwrap();
        let (mut squares, mut count) = (0.0, 0.0);
        for (i, value) in found.data.iter().enumerate() {
            let (x, y) = (i % 64, i / 64);
            let corners =
                [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| map.apply(DVec2::new((x + a) as f64, (y + b) as f64)));
            if corners.iter().all(|q| q.min_element() > 4.0 && q.max_element() < 508.0) {
                squares += f64::from(value - mean_of_drawing(&map, x, y, 12)).powi(2);
                count += 1.0;
            }
        }
        let decibels = -10.0 * (squares / count + 1e-12).log10();
        println!("turned by {turn}, {scale} times, {tilt}: {decibels:.1} dB of {count} pixels");
        assert!(count > 500.0 && decibels > min_decibels, "turned by {turn}, {scale} times, {tilt}: {decibels}");
    }
}

#[test]
fn channels_are_warped_equally_for_any_number_and_at_the_border() {
    let monitor = Monitor::default();
    let value = |x: usize, y: usize, c: u64| Rng::new(4, &[x as u64, y as u64, c]).next_f32();
    let [one, two, three, six] = [1usize, 2, 3, 6].map(|n| {
        let mut image = Image::new(90, 70, n).unwrap();
        for (i, pixel) in image.data.chunks_exact_mut(n).enumerate() {
            pixel.iter_mut().enumerate().for_each(|(c, v)| *v = value(i % 90, i / 90, c as u64 % 3));
        }
        image
    });
    let tilted =
        DMat3::from_cols(DVec3::new(1.1, 0.3, 0.004), DVec3::new(-0.4, 0.8, 0.009), DVec3::new(20.0, -9.0, 1.0));
    for scale in [0.4, 1.0, 3.0] {
        let map = Homography(tilted * DMat3::from_scale(DVec2::splat(scale)));
        let warped = [&one, &two, &three, &six].map(|image| warp(image, &map, 80, 60, monitor.job()).unwrap());
        let same = |a: &Image, b: &Image, c: usize, d: usize| {
            let each = a.data.chunks_exact(a.channels).zip(b.data.chunks_exact(b.channels));
            assert!(each.clone().all(|(a, b)| (a[c] - b[d]).abs() < 1e-5));
            assert!(each.filter(|(a, _)| a[c] != 0.0).count() > 500);
        };
        same(&warped[0], &warped[2], 0, 0);
        same(&warped[1], &warped[2], 1, 1);
        (0..6).for_each(|c| same(&warped[3], &warped[2], c, c % 3));
    }
    // A constant image stays constant up to its border.
    let grey = Image::from_fn(37, 23, |_, _| [0.7f32]).unwrap();
    for scale in [0.3, 1.0, 2.0, 5.0, 40.0] {
        let map = Homography(DMat3::from_scale(DVec2::splat(scale)));
        let (width, height) = ((37.0 / scale).ceil() as usize, (23.0 / scale).ceil() as usize);
        let warped = warp(&grey, &map, width, height, monitor.job()).unwrap();
        let inside =
            |i: usize| ((i % width) as f64 + 0.5) * scale <= 37.0 && ((i / width) as f64 + 0.5) * scale <= 23.0;
        assert!(warped.data.iter().enumerate().all(|(i, v)| !inside(i) || (v - 0.7).abs() < 1e-5), "{scale}");
    }
}

#[test]
fn warps_are_the_same_to_the_bit_at_every_level_of_instructions_and_on_any_number_of_threads() {
    let monitor = Monitor::default();
    let sources = [1usize, 3, 4].map(|n| {
        let mut image = Image::new(331, 257, n).unwrap();
        image.data.iter_mut().enumerate().for_each(|(i, v)| *v = Rng::new(6, &[i as u64]).next_f32());
        image
    });
    // The scales cover interpolation, the transition to averaging, and averages over few and many parts; the maps
    // cross every border, with and without tilt.
    let tilted =
        DMat3::from_cols(DVec3::new(1.0, 0.25, 0.001), DVec3::new(-0.3, 0.9, 0.002), DVec3::new(30.0, -20.0, 1.0));
    let straight = DMat3::from_translation(DVec2::splat(-3.3));
    for map in [0.3, 1.1, 1.9, 7.0]
        .into_iter()
        .flat_map(|s| [tilted, straight].map(|m| m * DMat3::from_scale(DVec2::splat(s))))
    {
        for source in &sources {
            let bits = || -> Vec<u32> {
                let warped = warp(source, &Homography(map), 300, 200, monitor.job()).unwrap();
                warped.data.iter().map(|v| v.to_bits()).collect()
            };
            let mut made = forced::levels().map(|level| forced::at(level, bits));
            let lowest = made.next().unwrap();
            assert!(lowest.iter().filter(|v| **v != 0).count() > 1000);
            assert!(made.all(|other| other == lowest));
            assert!([1, 3].into_iter().all(|threads| Pool::new(threads).unwrap().run(bits) == lowest));
        }
    }
}

#[test]
fn warps_of_tiny_sources_and_of_extreme_quadrilaterals_are_correct() {
    let monitor = Monitor::default();
    for (width, height) in [(1, 1), (1, 9), (9, 1), (3, 3), (4, 4), (5, 4), (6, 4), (2, 300)] {
        for channels in [1, 3, 4] {
            let mut grey = Image::new(width, height, channels).unwrap();
            grey.data.fill(0.7);
            // Map the output to a square around the centre of the source. The side of the square ranges from a
            // millionth of a pixel to a million pixels.
            for scale in [1e-6 / 40.0, 0.1, 1.0, 3.0, 1e6 / 40.0] {
                let middle = DVec2::new(width as f64, height as f64) / 2.0;
                let centred = DMat3::from_translation(middle) * DMat3::from_scale(DVec2::splat(scale));
                let map = Homography(centred * DMat3::from_translation(DVec2::splat(-20.0)));
                let warped = warp(&grey, &map, 40, 40, monitor.job()).unwrap();
                for (i, pixel) in warped.data.chunks_exact(channels).enumerate() {
                    let at = map.apply(DVec2::new((i % 40) as f64 + 0.5, (i / 40) as f64 + 0.5));
                    let inside = at.min_element() >= 0.0 && at.x <= width as f64 && at.y <= height as f64;
                    let want = if inside { 0.7 } else { 0.0 };
                    assert!(pixel.iter().all(|v| (v - want).abs() < 1e-5), "{width} x {height}, {scale}: {pixel:?}");
                }
            }
            // Test a zero matrix, a map of all pixels to a single point, and a map that is not finite.
            let nothing = warp(&grey, &Homography(DMat3::ZERO), 5, 5, monitor.job()).unwrap();
            assert!(nothing.data.iter().all(|&v| v == 0.0));
            let point = Homography(DMat3::from_cols(DVec3::ZERO, DVec3::ZERO, DVec3::new(0.5, 0.5, 1.0)));
            let point = warp(&grey, &point, 5, 5, monitor.job()).unwrap();
            assert!(point.data.iter().all(|v| (v - 0.7).abs() < 1e-5));
            let error = warp(&grey, &Homography(DMat3::NAN), 5, 5, monitor.job()).unwrap_err();
            assert_eq!(error.kind, ErrorKind::InvalidArgument);
        }
    }
}

#[test]
fn a_pixel_that_is_not_finite_spoils_those_it_is_part_of_and_no_others() {
    let mut source = Image::from_fn(200, 150, |x, y| [0.2 + 0.001 * (x + y) as f32, 0.5, 0.1]).unwrap();
    let map = |scale: f64| Homography(DMat3::from_scale(DVec2::splat(scale)));
    for scale in [0.5, 1.0, 2.0] {
        let clean = warp(&source, &map(scale), 80, 60, Monitor::default().job()).unwrap();
        for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let kept = source.pixel(20, 20)[1];
            source.pixel_mut(20, 20)[1] = bad;
            let spoilt = warp(&source, &map(scale), 80, 60, Monitor::default().job()).unwrap();
            source.pixel_mut(20, 20)[1] = kept;
            let mut hit = 0;
            for (i, (a, b)) in clean.data.chunks_exact(3).zip(spoilt.data.chunks_exact(3)).enumerate() {
                let at = DVec2::new((i % 80) as f64 + 0.5, (i / 80) as f64 + 0.5) * scale - 20.5;
                hit += usize::from(!b[1].is_finite());
                assert!(a[0] == b[0] && a[2] == b[2]);
                // An output pixel closer than 0.6 source pixels to the bad pixel depends on it; an output pixel whose
                // taps do not reach the bad pixel never does.
                assert!(!(at.abs().max_element() < 0.6) || !b[1].is_finite(), "{at} at {scale}");
                assert!(at.abs().max_element() <= 2.0 || a[1] == b[1], "{at} at {scale}");
            }
            assert!(hit > 0);
        }
    }
}
