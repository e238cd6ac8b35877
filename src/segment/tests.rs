//! Tests of segmentation on synthetic rooms with exact masks: accuracy, invariants, and degenerate inputs.

use super::*;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::image::Image;
use crate::job::Monitor;
use crate::rng::Rng;
use glam::{DVec2, Vec3};

const WIDTH: usize = 320;
const HEIGHT: usize = 240;

/// A box room seen along its axis. Returns ten features, with noise in colour, and the face of each pixel: 0 ceiling,
/// 1 floor, 2 left, 3 right, 4 back, 5 a lamp in the ceiling. Lamps have the highest lightness.
fn room() -> (Image, Vec<u8>) {
    let mut features = Image::new(WIDTH, HEIGHT, CHANNELS).unwrap();
    let mut faces = Vec::new();
    let colours =
        [[78.0, 0.0, 4.0], [45.0, 8.0, 18.0], [80.0, 1.0, 6.0], [70.0, -2.0, 2.0], [79.0, 0.0, 5.0], [100.0, 0.0, 0.0]];
    let normals = [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::NEG_X, Vec3::NEG_Z, Vec3::Y];
    for (i, out) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let ray = Vec3::new(x as f32 / 160.0 - 1.0, y as f32 / 160.0 - 0.75, 1.0);
        let distances = [-1.0 / ray.y, 1.2 / ray.y, -1.5 / ray.x, 1.4 / ray.x, 5.0];
        let hits = distances.iter().enumerate().filter(|(_, t)| **t > 0.0);
        let (mut face, &t) = hits.min_by(|a, b| a.1.total_cmp(b.1)).unwrap();
        let p = ray * t;
        if face == 0 && (p.x.abs() - 0.6).abs() < 0.15 && (p.z * 1.5).fract() < 0.5 {
            face = 5;
        }
        let mut rng = Rng::new(9, &[i as u64]);
        for c in 0..3 {
            out[c] = (colours[face][c] + 3.0 * rng.normal() as f32).min(if c == 0 { 100.0 } else { 200.0 });
        }
        out[3] = (1.0 - 1.0 / t) / 0.9;
        p.write_to_slice(&mut out[4..7]);
        normals[face].write_to_slice(&mut out[7..10]);
        faces.push(face as u8);
    }
    (features, faces)
}

fn line(positive: bool, points: &[[f64; 2]]) -> Stroke {
    let points: Vec<DVec2> = points.iter().map(|&p| p.into()).collect();
    Stroke::polyline(&points, 3.0, positive, WIDTH, HEIGHT).unwrap()
}

/// Two strokes on the ceiling, and one on each other face.
fn plane_strokes() -> Vec<Stroke> {
    vec![
        line(true, &[[60.0, 15.0], [260.0, 20.0]]),
        line(true, &[[130.0, 40.0], [190.0, 45.0]]),
        line(false, &[[60.0, 220.0], [260.0, 225.0]]),
        line(false, &[[20.0, 60.0], [25.0, 180.0]]),
        line(false, &[[300.0, 60.0], [295.0, 180.0]]),
        line(false, &[[130.0, 120.0], [190.0, 130.0]]),
    ]
}

fn segment(features: &Image, strokes: &[Stroke], region: Option<&Image>, params: &Params) -> Result<Segmentation> {
    run(&Input { features, strokes, region }, params, Monitor::default().job())
}

fn iou(mask: &Image, is_true: impl Fn(usize) -> bool) -> f64 {
    let (mut both, mut either) = (0, 0);
    for (i, &m) in mask.data.iter().enumerate() {
        both += usize::from(m > 0.5 && is_true(i));
        either += usize::from(m > 0.5 || is_true(i));
    }
    f64::from(both as u32) / f64::from(either.max(1) as u32)
}

#[test]
fn the_ceiling_then_its_lamps() {
    let (features, faces) = room();
    let plane = segment(&features, &plane_strokes(), None, &Params::default()).unwrap();
    let agreement = iou(&plane.mask, |i| faces[i] == 0 || faces[i] == 5);
    assert!(agreement >= 0.97, "{agreement} {:?}", plane.model);
    // The expected error must be at least the true error. The expected error is larger, because most surfaces have only
    // one stroke: when cross-validation holds this stroke out, it trains without the surface. The error on such strokes
    // is assumed for all pixels whose features are unlike the features of the painted pixels.
    let is_wrong = |(i, m): (usize, &f32)| (*m > 0.5) != (faces[i] == 0 || faces[i] == 5);
    let wrong = plane.mask.data.iter().enumerate().filter(|&p| is_wrong(p)).count() as f64 / faces.len() as f64;
    assert!(wrong <= plane.error && plane.error < 0.1, "{wrong} {}", plane.error);

    // Only lamps in the top left part are painted. All lamps must be found, and no thing off the ceiling.
    let lamp_pixels: Vec<u32> =
        (0..faces.len() as u32).filter(|&i| faces[i as usize] == 5 && i % 320 < 110 && i < 320 * 40).collect();
    assert!(lamp_pixels.len() > 50);
    let strokes = [Stroke { pixels: lamp_pixels, positive: true }, line(false, &[[150.0, 10.0], [165.0, 60.0]])];
    let lights = segment(&features, &strokes, Some(&plane.mask), &Params::for_lights()).unwrap();
    let agreement = iou(&lights.mask, |i| faces[i] == 5);
    assert!(agreement >= 0.95, "{agreement}");
    // The blur before lamps are searched may move a contour by a pixel, so the farthest lamp may reach into the wall.
    let is_beside_lamp = |i: usize| [i - 1, i + 1, i - 320, i + 320].iter().any(|&n| faces[n] == 5);
    let outside = (0..faces.len()).filter(|&i| plane.mask.data[i] == 0.0 && lights.confidence.data[i] > 0.0);
    assert!(outside.into_iter().all(is_beside_lamp));
}

#[test]
fn probabilities_are_calibrated_on_overlapping_classes() {
    // One feature with normal distributions whose means differ by 1.5 between the classes: the posterior is known.
    let features = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        let class = y >= HEIGHT / 2;
        [Rng::new(4, &[x as u64, y as u64]).normal() as f32 + if class { 1.5 } else { 0.0 }]
    })
    .unwrap();
    let strokes: Vec<Stroke> = (0..8)
        .map(|k| {
            line(
                k % 2 == 1,
                &[
                    [20.0 + 35.0 * f64::from(k), 125.0 - 115.0 * f64::from(1 - k % 2)],
                    [25.0 + 35.0 * f64::from(k), 225.0 - 115.0 * f64::from(1 - k % 2)],
                ],
            )
        })
        .collect();
    let got = segment(&features, &strokes, None, &Params::default()).unwrap();
    let mut worst = 0.0f32;
    for (c, f) in got.confidence.data.iter().zip(&features.data) {
        let truth = 1.0 / (1.0 + (-(1.5 * f - 1.125)).exp());
        worst = worst.max((c - truth).abs());
    }
    assert!(worst < 0.12, "{worst}");
    // The Bayes error is Φ(-0.75) = 0.2266; 2,000 samples have a standard error of 0.01.
    assert!((got.error - 0.2266).abs() < 0.05, "{}", got.error);
}

#[test]
fn a_stroke_on_a_wrong_region_mends_it() {
    let (features, faces) = room();
    let strokes = plane_strokes();
    let is_ceiling = |i: usize| faces[i] == 0 || faces[i] == 5;
    let few = segment(&features, &strokes[..3], None, &Params::default()).unwrap();
    let all = segment(&features, &strokes, None, &Params::default()).unwrap();
    assert!(iou(&all.mask, is_ceiling) >= iou(&few.mask, is_ceiling));
    // Test each stroke that only the second segmentation (`all`) uses: less than 5 % of its pixels may lie in the mask,
    // and the mean of `unseen` over its pixels must be below 0.1 and not higher than in the first segmentation (`few`).
    for stroke in &strokes[3..] {
        let inside = stroke.pixels.iter().filter(|&&p| all.mask.data[p as usize] > 0.5).count();
        assert!(inside * 20 < stroke.pixels.len());
        let unseen =
            |s: &Segmentation| stroke.pixels.iter().map(|&p| f64::from(s.unseen.data[p as usize])).sum::<f64>();
        assert!(unseen(&all) < 0.1 * stroke.pixels.len() as f64);
        assert!(unseen(&all) <= unseen(&few));
    }
}

/// A banner below the ceiling has a colour that no stroke has touched: `unseen` must mark it, whichever class it is
/// assigned to.
#[test]
fn regions_unlike_all_strokes_are_reported() {
    let (mut features, faces) = room();
    let is_banner = |i: usize| (100..220).contains(&(i % WIDTH)) && (100..116).contains(&(i / WIDTH));
    for i in (0..faces.len()).filter(|&i| is_banner(i)) {
        features.data[i * CHANNELS..i * CHANNELS + 3].copy_from_slice(&[50.0, -70.0, 60.0]);
    }
    let got = segment(&features, &plane_strokes(), None, &Params::default()).unwrap();
    let mean = |of: &dyn Fn(usize) -> bool| {
        let values: Vec<f32> = (0..faces.len()).filter(|&i| of(i)).map(|i| got.unseen.data[i]).collect();
        values.iter().sum::<f32>() / values.len() as f32
    };
    // On the other surfaces `unseen` is above 0 too, because strokes of a few pixels do not cover all features of these
    // surfaces.
    let known = mean(&|i| faces[i] != 5 && !is_banner(i));
    assert!(mean(&is_banner) > 0.99 && known < 0.33, "{} {known}", mean(&is_banner));
}

#[test]
fn one_class_or_none_is_an_error_that_says_what_to_paint() {
    // With two channels only, no mask can be proposed.
    let (features, _) = room();
    let features = Image::from_fn(WIDTH, HEIGHT, |x, y| [features.pixel(x, y)[0], features.pixel(x, y)[1]]).unwrap();
    let strokes = plane_strokes();
    for (strokes, word) in [(&strokes[..2], "negative"), (&strokes[2..], "positive"), (&strokes[..0], "negative")] {
        let error = segment(&features, strokes, None, &Params::default()).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.message.contains(&format!("no {word} stroke")), "{error}");
    }
    // A positive stroke entirely off the image, and a positive stroke that a negative one covers entirely.
    let off = Stroke { pixels: vec![(WIDTH * HEIGHT) as u32, u32::MAX], positive: true };
    let error = segment(&features, &[off.clone(), strokes[2].clone()], None, &Params::default()).unwrap_err();
    assert!(error.message.contains("2 of their pixels off"), "{error}");
    let over = Stroke { positive: false, ..strokes[0].clone() };
    let error = segment(&features, &[strokes[0].clone(), over], None, &Params::default()).unwrap_err();
    assert!(error.message.contains("painted over"), "{error}");
}

#[test]
fn without_strokes_the_ceiling_is_proposed_and_strokes_correct_it() {
    let (features, faces) = room();
    let propose = |strokes: &[Stroke]| segment(&features, strokes, None, &Params::default());
    let strokes = plane_strokes();
    // Without strokes, or with positive strokes only, the proposal is a whole face including its lamps.
    for strokes in [&strokes[..0], &strokes[..1]] {
        let ceiling = propose(strokes).unwrap();
        assert!(ceiling.is_proposed && ceiling.error > 0.0);
        assert_eq!(iou(&ceiling.mask, |i| matches!(faces[i], 0 | 5)), 1.0);
    }
    let wall = propose(&[Stroke { positive: true, ..strokes[3].clone() }]).unwrap();
    assert_eq!(iou(&wall.mask, |i| faces[i] == 2), 1.0);
    // A negative stroke alone, here on the ceiling, also gives a proposal.
    let without_lamps = propose(&[line(false, &[[60.0, 6.0], [60.0, 10.0]])]).unwrap();
    assert!(without_lamps.is_proposed);
    let off = Stroke { pixels: vec![(WIDTH * HEIGHT) as u32], positive: true };
    assert_eq!(propose(&[off]).unwrap().off_image, 1);
    // With strokes of both classes, the mask is not a proposal.
    assert!(!propose(&strokes).unwrap().is_proposed);
}

#[test]
fn a_mask_has_the_normal_of_the_face_that_it_covers_and_none_over_two_faces() {
    let (features, faces) = room();
    let normal = |has: &dyn Fn(u8) -> bool| {
        let mask = Image::from_fn(WIDTH, HEIGHT, |x, y| [f32::from(has(faces[y * WIDTH + x]))]).unwrap();
        super::face::laid_out_under(&features, &mask)
    };
    assert!(normal(&|face| face == 2).is_some_and(|n| n.distance(Vec3::X) < 1e-5));
    assert!(normal(&|face| face == 0).is_some_and(|n| n.distance(Vec3::Y) < 1e-5));
    assert_eq!(normal(&|face| face == 2 || face == 3), None);
    assert_eq!(normal(&|_| false), None);
}

#[test]
fn without_strokes_and_without_a_ceiling_the_error_asks_for_strokes() {
    let wall = Image::from_fn(WIDTH, HEIGHT, |_, _| [50.0, 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, 0.0, -1.0]).unwrap();
    // The normals of the neutral room that is assumed for photos without lines differ from row to row.
    let prior = Image::from_fn(WIDTH, HEIGHT, |_, y| {
        let (sin, cos) = (y as f32 / HEIGHT as f32).sin_cos();
        [50.0, 0.0, 0.0, 0.5, 0.0, 0.0, 1.0, 0.0, cos, -sin]
    });
    let strokes = [line(false, &[[20.0, 60.0], [25.0, 180.0]])];
    for (features, strokes) in [(&wall, &[][..]), (&wall, &strokes), (&prior.unwrap(), &[])] {
        let error = segment(features, strokes, None, &Params::default()).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.message.contains("no ceiling") && error.message.contains("paint"), "{error}");
    }
}

#[test]
fn the_last_of_contradicting_strokes_wins() {
    let (features, _) = room();
    let mut strokes = plane_strokes();
    strokes.insert(0, Stroke { positive: false, ..strokes[0].clone() });
    let got = segment(&features, &strokes, None, &Params::default()).unwrap();
    assert_eq!(got.contradictory, strokes[0].pixels.len());
    let without = segment(&features, &strokes[1..], None, &Params::default()).unwrap();
    assert_eq!(got.confidence, without.confidence);
}

#[test]
fn useless_features_do_no_harm() {
    let (features, faces) = room();
    // Add duplicates of four features, a constant channel, and a channel of zeros.
    let mut wide = Image::new(WIDTH, HEIGHT, 16).unwrap();
    for (o, f) in wide.data.chunks_exact_mut(16).zip(features.data.chunks_exact(CHANNELS)) {
        o[..10].copy_from_slice(f);
        o[10..14].copy_from_slice(&f[6..10]);
        o[14] = 1e9;
    }
    let params = Params::default();
    let got = segment(&wide, &plane_strokes(), None, &params).unwrap();
    assert_eq!(got.confidence.count_non_finite(), 0);
    assert!(iou(&got.mask, |i| faces[i] == 0 || faces[i] == 5) >= 0.97);

    // With constant features only, no pixel differs from another.
    let flat = Image::from_fn(WIDTH, HEIGHT, |_, _| [3.0, 0.0]).unwrap();
    let got = segment(&flat, &plane_strokes(), None, &params).unwrap();
    assert!(got.confidence.data.iter().all(|c| (c - 0.5).abs() < 1e-3));
    assert!(got.error >= 0.49, "{}", got.error);
}

#[test]
fn a_channel_without_variance_under_the_strokes_decides_nothing() {
    let (features, faces) = room();
    let strokes = plane_strokes();
    // The added channel is constant under all strokes and varies strongly elsewhere, so it carries no information.
    let mut wide = Image::new(WIDTH, HEIGHT, CHANNELS + 1).unwrap();
    for (i, (o, f)) in wide.data.chunks_exact_mut(CHANNELS + 1).zip(features.data.chunks_exact(CHANNELS)).enumerate() {
        o[..CHANNELS].copy_from_slice(f);
        o[CHANNELS] = if i % 3 == 0 { 1e6 } else { -4e5 };
    }
    for &p in strokes.iter().flat_map(|s| &s.pixels) {
        wide.data[p as usize * (CHANNELS + 1) + CHANNELS] = 7.0;
    }
    let got = segment(&wide, &strokes, None, &Params::default()).unwrap();
    assert_eq!(got.confidence.count_non_finite() + got.unseen.count_non_finite(), 0);
    assert!(iou(&got.mask, |i| faces[i] == 0 || faces[i] == 5) >= 0.97);
}

#[test]
fn features_twice_over_make_the_same_mask() {
    let (features, faces) = room();
    let geometry = |x: usize, y: usize| <[f32; 6]>::try_from(&features.pixel(x, y)[4..]).unwrap();
    let once = Image::from_fn(WIDTH, HEIGHT, geometry).unwrap();
    let twice = Image::from_fn(WIDTH, HEIGHT, |x, y| -> [f32; 12] {
        let values = geometry(x, y);
        std::array::from_fn(|c| values[c % 6])
    });
    let [once, twice] =
        [once, twice.unwrap()].map(|f| segment(&f, &plane_strokes(), None, &Params::default()).unwrap());
    assert_eq!(twice.confidence.count_non_finite(), 0);
    let shared = iou(&twice.mask, |i| once.mask.data[i] > 0.5);
    let right = iou(&twice.mask, |i| faces[i] == 0 || faces[i] == 5);
    assert!(shared > 0.98 && right > 0.97, "{shared} {right}");
}

#[test]
fn strokes_half_off_the_photo_and_painted_twice_are_as_their_part_on_it() {
    let (features, _) = room();
    let strokes = plane_strokes();
    let plain = segment(&features, &strokes, None, &Params::default()).unwrap();
    // Extend every stroke by pixels off the photo.
    let mut beyond = strokes.clone();
    beyond.iter_mut().for_each(|s| s.pixels.extend((0..1000).map(|i| (WIDTH * HEIGHT) as u32 + 77 * i)));
    let got = segment(&features, &beyond, None, &Params::default()).unwrap();
    assert_eq!((got.confidence, got.samples), (plain.confidence, plain.samples));
    // A polyline that enters the photo from the left and leaves it at the bottom has only pixels of the photo.
    let ends = [DVec2::new(-50.0, 100.0), DVec2::new(60.0, HEIGHT as f64 + 90.0)];
    let across = Stroke::polyline(&ends, 4.0, true, WIDTH, HEIGHT).unwrap();
    assert!(!across.pixels.is_empty() && across.pixels.iter().all(|&p| (p as usize) < WIDTH * HEIGHT));
    // Painting the same strokes again changes nothing.
    let again = [&strokes[..], &strokes[..]].concat();
    let got = segment(&features, &again, None, &Params::default()).unwrap();
    assert_eq!((got.contradictory, got.samples), (0, plain.samples));
}

#[test]
fn wholly_contradictory_strokes_are_an_error_and_nearly_so_are_learned_from() {
    let (features, _) = room();
    let strokes = plane_strokes();
    let not = |s: &Stroke| Stroke { positive: !s.positive, ..s.clone() };
    // Paint everything again with the opposite class: only the later strokes count.
    let turned: Vec<Stroke> = strokes.iter().chain(&strokes.iter().map(not).collect::<Vec<_>>()).cloned().collect();
    let got = segment(&features, &turned, None, &Params::default()).unwrap();
    let opposite = segment(&features, &strokes.iter().map(not).collect::<Vec<_>>(), None, &Params::default()).unwrap();
    assert!(iou(&got.mask, |i| opposite.mask.data[i] > 0.5) > 0.99);
    assert_eq!(got.contradictory, strokes.iter().map(|s| s.pixels.len()).sum::<usize>());
    // Paint one surface in alternating rows of both classes. The classes are alike, so the expected error must be
    // large.
    let row = |y: u32, positive: bool| Stroke {
        pixels: (0..60).map(|x| (20 + y) * WIDTH as u32 + 130 + x).collect(),
        positive,
    };
    let mixed: Vec<Stroke> = (0..8).map(|y| row(y, y % 2 == 0)).collect();
    let colours = Params { channels: 0b111, ..Params::default() };
    let got = segment(&features, &mixed, None, &colours).unwrap();
    assert!(got.error > 0.3, "{}", got.error);
    assert_eq!(got.confidence.count_non_finite(), 0);
}

#[test]
fn channels_are_chosen_unless_they_are_given() {
    let (features, faces) = room();
    let is_ceiling = |i: usize| faces[i] == 0 || faces[i] == 5;
    let chosen = segment(&features, &plane_strokes(), None, &Params::default()).unwrap();
    assert!(SUBSETS.contains(&chosen.channels), "{:#b}", chosen.channels);
    // No subset that the caller gives does much better than the chosen one. Bits beyond the last channel are ignored.
    for subset in SUBSETS {
        let params = Params { channels: subset | 1 << 20, ..Params::default() };
        let given = segment(&features, &plane_strokes(), None, &params).unwrap();
        assert_eq!(given.channels, subset);
        assert!(iou(&chosen.mask, is_ceiling) >= iou(&given.mask, is_ceiling) - 0.01, "{subset:#b}");
    }
    // If colour alone separates the classes under all strokes, the simplest subset must be chosen, which is colour.
    let painted = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        let hash = Rng::new(3, &[x as u64, y as u64]).next_f32();
        let lightness = if is_ceiling(y * WIDTH + x) { 80.0 } else { 20.0 };
        [lightness + hash, hash, 0.0, 0.5, x as f32, y as f32, hash, 0.0, 0.0, -1.0]
    })
    .unwrap();
    let got = segment(&painted, &plane_strokes(), None, &Params::default()).unwrap();
    assert_eq!(got.channels, 0b111);
    assert!(iou(&got.mask, is_ceiling) > 0.999);
}

/// Images of ten channels are deinterleaved by a separate code path; its results must equal the results of the general
/// path.
#[test]
fn a_channel_that_is_not_looked_at_changes_no_bit() {
    let (features, _) = room();
    let mut wider = Image::new(WIDTH, HEIGHT, CHANNELS + 1).unwrap();
    for (to, from) in wider.data.chunks_exact_mut(CHANNELS + 1).zip(features.data.chunks_exact(CHANNELS)) {
        to[..CHANNELS].copy_from_slice(from);
        to[CHANNELS] = from[0] * 7.0;
    }
    let params = Params { channels: (1 << CHANNELS) - 1, ..Params::default() };
    let [a, b] = [&features, &wider].map(|image| segment(image, &plane_strokes(), None, &params).unwrap());
    assert!((a.mask, a.confidence, a.unseen) == (b.mask, b.confidence, b.unseen));
}

#[test]
fn refinement_smooths_what_is_of_one_colour_and_keeps_to_where_it_looks() {
    let (features, faces) = room();
    let is_ceiling = |i: usize| faces[i] == 0 || faces[i] == 5;
    let by_colour = Params { channels: 0b111, ..Params::default() };
    let plain = segment(&features, &plane_strokes(), None, &by_colour).unwrap();
    let refined = Params { refine_radius: 4, refine_tolerance: 8.0, ..by_colour.clone() };
    let got = segment(&features, &plane_strokes(), None, &refined).unwrap();
    // With colour alone, the mask shows the noise of single pixels; the filter removes it.
    let (before, after) = (iou(&plain.mask, is_ceiling), iou(&got.mask, is_ceiling));
    assert!(after > before + 0.005, "{before} {after}");
    assert!(got.mask.data.iter().zip(&got.confidence.data).all(|(m, c)| (*m > 0.5) == (*c > 0.5)));
    let region = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 100)]).unwrap();
    let refined = Params { subject: Subject::Surface, ..refined };
    let got = segment(&features, &plane_strokes(), Some(&region), &refined).unwrap();
    assert!(got.confidence.data[100 * WIDTH..].iter().all(|c| *c == 0.0));
    for (radius, tolerance) in [(1025, 1.0), (1, 0.0), (1, f64::NAN)] {
        let params = Params { refine_radius: radius, refine_tolerance: tolerance, ..Params::default() };
        assert!(segment(&features, &plane_strokes(), None, &params).unwrap_err().message.contains("refine_"));
    }
}

#[test]
fn the_largest_strokes_and_many_of_them_are_as_the_few() {
    let (features, faces) = room();
    // Paint the whole photo: one stroke for each row and face.
    let mut strokes = Vec::new();
    for y in 0..HEIGHT {
        for face in 0..6 {
            let row = (0..WIDTH).map(|x| y * WIDTH + x).filter(|&i| faces[i] == face);
            let pixels: Vec<u32> = row.map(|i| i as u32).collect();
            strokes.push(Stroke { pixels, positive: face == 0 || face == 5 });
        }
    }
    let got = segment(&features, &strokes, None, &Params::default()).unwrap();
    assert_eq!(got.samples, [1000, 1000]);
    assert!(iou(&got.mask, |i| faces[i] == 0 || faces[i] == 5) > 0.98);
}

#[test]
fn features_of_one_bit_are_distinguished() {
    let (features, faces) = room();
    let is_ceiling = |i: usize| faces[i] == 0 || faces[i] == 5;
    // One feature is the class itself; the others are a lightness threshold and a checkerboard.
    let bits = Image::from_fn(WIDTH, HEIGHT, |x, y| {
        [f32::from(is_ceiling(y * WIDTH + x)), f32::from(features.pixel(x, y)[0] > 75.0), f32::from((x + y) % 2 == 0)]
    });
    let got = segment(&bits.unwrap(), &plane_strokes(), None, &Params::default()).unwrap();
    assert!(iou(&got.mask, is_ceiling) == 1.0 && got.error < 0.01, "{}", got.error);
}

#[test]
fn infinite_and_saturated_features_are_refused_or_used() {
    let (features, faces) = room();
    // All pixels are saturated white: colour carries no information, but geometry does.
    let mut white = features.clone();
    white.data.chunks_exact_mut(CHANNELS).for_each(|p| p[..3].copy_from_slice(&[100.0, 0.0, 0.0]));
    let got = segment(&white, &plane_strokes(), None, &Params::default()).unwrap();
    assert!(iou(&got.mask, |i| faces[i] == 0 || faces[i] == 5) > 0.95);
    // One value that is not finite, first where no stroke lies, then under a stroke.
    for at in [(WIDTH * HEIGHT - 1) * CHANNELS, plane_strokes()[0].pixels[9] as usize * CHANNELS + 2] {
        for v in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let mut bad = features.clone();
            bad.data[at] = v;
            let error = segment(&bad, &plane_strokes(), None, &Params::default()).unwrap_err();
            assert!(error.message.contains("1 values"), "{error}");
        }
    }
}

#[test]
fn the_smallest_inputs_work() {
    let features = Image { width: 2, height: 1, channels: 1, data: vec![0.0, 1.0] };
    let strokes = [Stroke { pixels: vec![0], positive: false }, Stroke { pixels: vec![1], positive: true }];
    let got = segment(&features, &strokes, None, &Params::default()).unwrap();
    assert_eq!(got.mask.data, [0.0, 1.0]);
    assert_eq!(got.samples, [1, 1]);
    let nothing = Image::new(2, 1, 1).unwrap();
    let got = segment(&features, &strokes, Some(&nothing), &Params::default()).unwrap();
    assert_eq!(got.mask.data, [0.0, 0.0]);
    let one = Params { samples_per_class: 1, ..Params::default() };
    let (features, _) = room();
    assert_eq!(segment(&features, &plane_strokes(), None, &one).unwrap().samples, [1, 1]);
}

#[test]
fn wrong_arguments_are_refused() {
    let (mut features, _) = room();
    let strokes = plane_strokes();
    let none = Params { channels: 1 << 10, ..Params::default() };
    assert!(segment(&features, &strokes, None, &none).unwrap_err().message.contains("channels"));
    let zero = Params { samples_per_class: 0, ..Params::default() };
    assert!(segment(&features, &strokes, None, &zero).unwrap_err().message.contains("samples_per_class is 0"));
    let ridge = Params { ridge: f64::NAN, ..Params::default() };
    assert!(segment(&features, &strokes, None, &ridge).unwrap_err().message.contains("ridge"));
    let small = Image::new(3, 3, 1).unwrap();
    assert!(segment(&features, &strokes, Some(&small), &Params::default()).unwrap_err().message.contains("3 x 3"));
    features.data[17] = f32::NAN;
    assert!(segment(&features, &strokes, None, &Params::default()).unwrap_err().message.contains("1 values"));
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let (features, _) = room();
    let strokes = plane_strokes();
    let with = |threads: usize| {
        let pool = Pool::new(threads).unwrap();
        let got = pool.run(|| segment(&features, &strokes, None, &Params::default())).unwrap();
        (got.mask, got.confidence, got.unseen, got.error.to_bits())
    };
    assert!(with(1) == with(3));
}

#[test]
fn samples_depend_on_the_seed_and_not_on_the_order_of_pixels() {
    let (features, _) = room();
    let strokes = plane_strokes();
    let few = Params { samples_per_class: 50, ..Params::default() };
    let mut turned = strokes.clone();
    turned.iter_mut().for_each(|s| s.pixels.reverse());
    let a = segment(&features, &strokes, None, &few).unwrap();
    assert_eq!(a.samples, [50, 50]);
    assert_eq!(a.confidence, segment(&features, &turned, None, &few).unwrap().confidence);
    let other = Params { seed: 2, ..few };
    assert_ne!(a.confidence, segment(&features, &strokes, None, &other).unwrap().confidence);
}

#[test]
fn a_cancelled_job_ends_with_an_error() {
    let (features, _) = room();
    let monitor = Monitor::default();
    monitor.cancel();
    let strokes = plane_strokes();
    let input = Input { features: &features, strokes: &strokes, region: None };
    assert_eq!(run(&input, &Params::default(), monitor.job()).unwrap_err(), Error::cancelled());
}

#[test]
fn removed_pixels_leave_the_mask_and_the_others_stay() {
    let (features, _) = room();
    let before = segment(&features, &plane_strokes(), None, &Params::default()).unwrap();
    let mut after = before.clone();
    after.remove(|pixel| pixel % 2 == 0);
    for i in 0..before.mask.data.len() {
        let kept = if i % 2 == 0 && before.mask.data[i] > 0.5 {
            [0.0; 2]
        } else {
            [before.mask.data[i], before.confidence.data[i]]
        };
        assert_eq!([after.mask.data[i], after.confidence.data[i]], kept);
    }
}
