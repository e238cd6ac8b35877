//! Tests of lamp detection on a synthetic photo with known lamps, a window and noise.

use super::regions::{self, Brightness};
use super::tree::Tree;
use crate::error::ErrorKind;
use crate::features::CHANNELS;
use crate::image::{Image, colour};
use crate::job::Monitor;
use crate::rng::Rng;
use crate::segment::{Input, Params, Segmentation, Stroke, StrokeSet, Subject, run};
use glam::{DVec2, Vec3};

const WIDTH: usize = 320;
const HEIGHT: usize = 200;

/// Rectangles [x0, y0, x1, y1) of lamps. They lie on a ceiling that fills the image rows 0 to 119.
const LAMPS: [[usize; 4]; 5] =
    [[20, 20, 60, 32], [120, 20, 160, 32], [220, 20, 260, 32], [60, 70, 90, 79], [160, 70, 190, 79]];
/// A window in the wall, as bright as the lamps.
const WINDOW: [usize; 4] = [200, 140, 240, 180];

fn is_in(r: [usize; 4], x: usize, y: usize) -> bool {
    (r[0]..r[2]).contains(&x) && (r[1]..r[3]).contains(&y)
}

/// Features of a photo with noise: a ceiling that grows brighter to the right, and dark walls below.
fn features() -> Image {
    features_with(&LAMPS)
}

/// Like [`features`], but with the given lamps. The ceiling faces the camera, so all its pixels show equal areas.
fn features_with(lamps: &[[usize; 4]]) -> Image {
    let mut image = Image::new(WIDTH, HEIGHT, CHANNELS).unwrap();
    for (i, pixel) in image.data.chunks_exact_mut(CHANNELS).enumerate() {
        let (x, y) = (i % WIDTH, i / WIDTH);
        let noise = 0.02 * (Rng::new(5, &[i as u64]).next_f32() - 0.5);
        let grey = match () {
            () if lamps.iter().any(|r| is_in(*r, x, y)) || is_in(WINDOW, x, y) => 1.0,
            () if y < 120 => 0.25 + 0.2 * x as f32 / WIDTH as f32,
            () => 0.1,
        };
        let lab = colour::linear_to_lab(Vec3::splat((grey + noise).clamp(0.0, 1.0)));
        pixel[..3].copy_from_slice(&lab.to_array());
        pixel[4..7].copy_from_slice(&[0.01 * x as f32, 2.0, 0.01 * y as f32]);
        pixel[7..].copy_from_slice(&if y < 120 { [0.0, 1.0, 0.0] } else { [0.0, 0.0, -1.0] });
    }
    image
}

fn ceiling() -> Image {
    Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 120)]).unwrap()
}

fn stroke(positive: bool, points: &[[f64; 2]]) -> Stroke {
    let points: Vec<DVec2> = points.iter().map(|p| DVec2::from_array(*p)).collect();
    Stroke::polyline(&points, 2.0, positive, WIDTH, HEIGHT).unwrap()
}

fn segment(strokes: &[Stroke], region: Option<&Image>) -> Segmentation {
    segment_in(&features(), strokes, region)
}

fn segment_in(features: &Image, strokes: &[Stroke], region: Option<&Image>) -> Segmentation {
    let input = Input { features, strokes, region };
    run(&input, &Params { subject: Subject::Lamps, ..Params::default() }, Monitor::default().job()).unwrap()
}

/// Returns for each rectangle of `LAMPS` whether most of its pixels are in the mask, and the number of mask pixels
/// away from all lamps.
fn found(mask: &Image) -> (Vec<bool>, usize) {
    let share = |r: &[usize; 4]| {
        let pixels = (r[1]..r[3]).flat_map(|y| (r[0]..r[2]).map(move |x| (x, y)));
        let lit = pixels.clone().filter(|(x, y)| mask.pixel(*x, *y)[0] > 0.5).count();
        lit as f64 / pixels.count() as f64
    };
    let near = |r: &[usize; 4], x: usize, y: usize| {
        is_in([r[0].saturating_sub(1), r[1].saturating_sub(1), r[2] + 1, r[3] + 1], x, y)
    };
    let elsewhere =
        (0..WIDTH * HEIGHT).filter(|i| mask.data[*i] > 0.5 && !LAMPS.iter().any(|r| near(r, i % WIDTH, i / WIDTH)));
    (LAMPS.iter().map(|r| share(r) > 0.8).collect(), elsewhere.count())
}

#[test]
fn one_stroke_finds_the_lamps_like_it_and_neither_bright_ceiling_nor_window() {
    let ceiling = ceiling();
    let segmented = segment(&[stroke(true, &[[30.0, 26.0], [50.0, 26.0]])], Some(&ceiling));
    assert_eq!(found(&segmented.mask), (vec![true; 5], 0));
    assert!(segmented.error > 0.0 && segmented.error < 0.05, "{}", segmented.error);
}

#[test]
fn a_stroke_outside_the_plane_marks_its_thing_all_the_same() {
    let ceiling = ceiling();
    let segmented = segment(&[stroke(true, &[[210.0, 160.0], [230.0, 160.0]])], Some(&ceiling));
    assert_eq!(segmented.mask.pixel(220, 160)[0], 1.0);
}

#[test]
fn a_negative_stroke_takes_a_lamp_out() {
    let ceiling = ceiling();
    let strokes = [stroke(true, &[[30.0, 26.0], [50.0, 26.0]]), stroke(false, &[[230.0, 26.0], [250.0, 26.0]])];
    let (lamps, elsewhere) = found(&segment(&strokes, Some(&ceiling)).mask);
    assert_eq!((lamps, elsewhere), (vec![true, true, false, true, true], 0));
}

#[test]
fn a_few_negative_pixels_do_not_take_out_a_lamp_like_the_painted_one() {
    let ceiling = ceiling();
    // The third lamp has 480 pixels, of which 0.5 % (2.4) may lie under negative strokes.
    for (count, is_found) in [(2, true), (4, false)] {
        let pixels = (0..count).map(|x| (26 * WIDTH + 238 + x) as u32).collect();
        let strokes = [stroke(true, &[[30.0, 26.0], [50.0, 26.0]]), Stroke { pixels, positive: false }];
        let (lamps, elsewhere) = found(&segment(&strokes, Some(&ceiling)).mask);
        assert_eq!((lamps, elsewhere), (vec![true, true, is_found, true, true], 0), "{count} pixels");
    }
}

#[test]
fn a_lamp_that_the_border_cuts_may_be_of_any_size_and_a_thing_inside_may_not() {
    let ceiling = ceiling();
    let strokes = [stroke(true, &[[30.0, 26.0], [50.0, 26.0]])];
    for (x, is_found) in [(WIDTH - 10, true), (WIDTH - 20, false)] {
        let part = [x, 90, x + 10, 96];
        let features = features_with(&[&LAMPS[..], &[part]].concat());
        let mask = segment_in(&features, &strokes, Some(&ceiling)).mask;
        assert_eq!(mask.pixel(x + 5, 93)[0] > 0.5, is_found, "a piece of 10 x 6 pixels at {x}");
    }
}

#[test]
fn a_bright_wall_that_touches_a_painted_lamp_is_cut_off_if_another_painted_lamp_shows_its_size() {
    let ceiling = ceiling();
    let mut features = features();
    // The wall is nearly as bright as the second lamp, and touches its lower edge.
    let wall = [120, 32, 132, 50];
    let lab = colour::linear_to_lab(Vec3::splat(0.87)).to_array();
    for i in (0..WIDTH * HEIGHT).filter(|i| is_in(wall, i % WIDTH, i / WIDTH)) {
        features.data[i * CHANNELS..][..3].copy_from_slice(&lab);
    }
    let second = stroke(true, &[[130.0, 26.0], [150.0, 26.0]]);
    let first = stroke(true, &[[30.0, 26.0], [50.0, 26.0]]);
    for (strokes, leaks) in [(vec![second.clone()], true), (vec![second, first], false)] {
        let mask = segment_in(&features, &strokes, Some(&ceiling)).mask;
        assert_eq!(mask.pixel(126, 44)[0] > 0.5, leaks, "{} strokes", strokes.len());
        assert_eq!(mask.pixel(140, 26)[0], 1.0);
    }
}

#[test]
fn a_stroke_that_slips_off_a_lamp_does_not_mark_the_light_on_the_ceiling_beside_it() {
    let ceiling = ceiling();
    let mut features = features();
    // A dark housing above the second lamp, and the lamp's light on the ceiling above the housing.
    for (x, y) in (80..200).flat_map(|x| (0..20).map(move |y| (x, y))) {
        let [across, up] = [(x as f32 - 140.0) / 30.0, (15.0 - y as f32) / 10.0];
        let light = 0.35 + 0.65 * (-across * across - up * up).exp();
        let grey = if y >= 15 && (118..162).contains(&x) { 0.05 } else { light };
        let lab = colour::linear_to_lab(Vec3::splat(grey)).to_array();
        features.data[(y * WIDTH + x) * CHANNELS..][..3].copy_from_slice(&lab);
    }
    let slips = stroke(true, &[[125.0, 26.0], [150.0, 26.0], [152.0, 12.0]]);
    let mask = segment_in(&features, &[slips], Some(&ceiling)).mask;
    assert_eq!((mask.pixel(140, 26)[0], mask.pixel(150, 12)[0]), (1.0, 0.0));
}

#[test]
fn things_of_another_shape_are_no_lamps() {
    let ceiling = ceiling();
    // A bright strip with the area of a lamp, but 30 times as long as wide.
    let strip = [60, 100, 180, 104];
    let features = features_with(&[&LAMPS[..], &[strip]].concat());
    let mask = segment_in(&features, &[stroke(true, &[[30.0, 26.0], [50.0, 26.0]])], Some(&ceiling)).mask;
    assert_eq!(mask.pixel(120, 102)[0], 0.0);
}

#[test]
fn unpainted_lamps_of_another_kind_are_found_if_they_form_a_lattice_or_stand_out() {
    let strokes = [stroke(true, &[[30.0, 26.0], [50.0, 26.0]])];
    let are_found = |further: &[[usize; 4]]| {
        let features = features_with(&[&[[20, 20, 60, 32], [220, 20, 260, 32]], further].concat());
        let mask = segment_in(&features, &strokes, Some(&ceiling())).mask;
        let is_found = |r: &[usize; 4]| mask.pixel(r[0] + 3, r[1] + 3)[0] > 0.5;
        assert!(is_found(&[20, 20, 60, 32]) && is_found(&[220, 20, 260, 32]));
        let hits = further.iter().filter(|r| is_found(r)).count();
        assert!(hits == 0 || hits == further.len(), "{hits} of {}", further.len());
        hits > 0
    };
    let square = |x: usize, y: usize, side: usize| [x, y, x + side, y + side];
    let lattice: Vec<[usize; 4]> = (0..12).map(|i| square(20 + 40 * (i % 6), 46 + 50 * (i / 6), 6)).collect();
    assert!(are_found(&lattice), "small lamps on a lattice");
    assert!(!are_found(&lattice[..2]), "two small regions");
    assert!(!are_found(&[square(130, 80, 9)]), "a small region");
    assert!(are_found(&[square(110, 66, 46)]), "a single lamp that stands out");
    assert!(!are_found(&[square(64, 36, 46)]), "a region close to a lamp");
}

#[test]
fn confidence_is_one_half_on_the_contour() {
    let ceiling = ceiling();
    let segmented = segment(&[stroke(true, &[[30.0, 26.0], [50.0, 26.0]])], Some(&ceiling));
    for (confidence, mask) in segmented.confidence.data.iter().zip(&segmented.mask.data) {
        assert_eq!(*mask > 0.5, *confidence > 0.5);
        assert!((0.0..=1.0).contains(confidence));
    }
    // The confidence must cross 0.5 within half a pixel of the lamp's left side, which lies at x = 20.
    let row = |x: usize| segmented.confidence.pixel(x, 26)[0];
    let x = (15..25).find(|&x| row(x) <= 0.5 && row(x + 1) > 0.5).unwrap();
    let crossing = x as f32 + 0.5 + (0.5 - row(x)) / (row(x + 1) - row(x));
    assert!((crossing - 20.0).abs() < 0.5, "{crossing}");
}

#[test]
fn a_stroke_over_two_lamps_marks_both_and_not_what_lies_between() {
    let segmented = segment(&[stroke(true, &[[40.0, 26.0], [140.0, 26.0]])], None);
    let (lamps, _) = found(&segmented.mask);
    assert!(lamps[0] && lamps[1]);
    assert_eq!(segmented.mask.pixel(90, 26)[0], 0.0);
}

#[test]
fn strokes_without_a_lamp_are_an_error_and_dark_ones_mark_nothing_large() {
    let features = features();
    let input = Input { features: &features, strokes: &[stroke(false, &[[30.0, 26.0]])], region: None };
    let params = Params { subject: Subject::Lamps, ..Params::default() };
    let error = run(&input, &params, Monitor::default().job()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Degenerate);
    assert!(error.message.contains("no positive stroke"), "{}", error.message);
    // A stroke on the dark wall marks no large region.
    let mask = segment(&[stroke(true, &[[40.0, 170.0], [60.0, 170.0]])], None).mask;
    assert!(mask.data.iter().sum::<f32>() < 0.1 * mask.data.len() as f32);
}

#[test]
fn features_that_are_not_finite_are_refused() {
    let mut features = features();
    features.data[0] = f32::NAN;
    let input = Input { features: &features, strokes: &[stroke(true, &[[30.0, 26.0]])], region: None };
    let params = Params { subject: Subject::Lamps, ..Params::default() };
    let error = run(&input, &params, Monitor::default().job()).unwrap_err();
    assert!(error.message.contains("finite"), "{}", error.message);
}

#[test]
fn whole_images_of_one_brightness_and_of_noise_end_well() {
    for noise in [0.0, 60.0] {
        let mut features = Image::new(64, 48, CHANNELS).unwrap();
        for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
            pixel[0] = 40.0 + noise * Rng::new(3, &[i as u64]).next_f32();
        }
        let strokes = [Stroke::polyline(&[DVec2::splat(20.0)], 3.0, true, 64, 48).unwrap()];
        let input = Input { features: &features, strokes: &strokes, region: None };
        let params = Params { subject: Subject::Lamps, ..Params::default() };
        let segmented = run(&input, &params, Monitor::default().job()).unwrap();
        assert!(segmented.confidence.data.iter().all(|c| (0.0..=1.0).contains(c)));
    }
}

#[test]
fn panes_side_by_side_are_found_and_a_stroke_of_the_plane_across_them_does_no_harm() {
    // Panes of 15 x 15 pixels, separated by bars of 2 pixels.
    let is_pane = |x: usize, y: usize| {
        (60..196).contains(&x) && (20..88).contains(&y) && (x - 60) % 17 < 15 && (y - 20) % 17 < 15
    };
    let mut features = features();
    for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate().filter(|(i, _)| i / WIDTH < 120) {
        pixel[0] = if is_pane(i % WIDTH, i / WIDTH) { 99.0 } else { 40.0 };
    }
    let painted = StrokeSet {
        plane: vec![stroke(true, &[[20.0, 60.0], [300.0, 60.0]])],
        lights: vec![stroke(true, &[[66.0, 27.0], [69.0, 27.0]])],
    };
    let ceiling = ceiling();
    let strokes = painted.light_examples(&features).unwrap();
    let input = Input { features: &features, strokes: &strokes, region: Some(&ceiling) };
    let params = Params { subject: Subject::Lamps, ..Params::default() };
    let mask = run(&input, &params, Monitor::default().job()).unwrap().mask;
    // The blur before the tree is built removes the four corner pixels of each of the 32 panes, and changes no other
    // pixel.
    let wrong = (0..WIDTH * 120).filter(|i| (mask.data[*i] > 0.5) != is_pane(i % WIDTH, i / WIDTH)).count();
    assert!(wrong <= 4 * 32, "{wrong}");
}

#[test]
fn lamps_much_smaller_on_the_plane_than_the_painted_ones_are_not_like_them() {
    // Lamps on the right have the painted lamps' size in the photo, but the plane is ten times as near there.
    let mut features = features();
    for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
        let (x, y) = ((i % WIDTH) as f32, (i / WIDTH) as f32);
        let scale = if x < 170.0 { 1.0 } else { 0.1 };
        (pixel[4], pixel[5], pixel[6]) = (170.0 + scale * (x - 170.0), 2.0, scale * y);
    }
    let ceiling = ceiling();
    let strokes = [stroke(true, &[[30.0, 26.0], [50.0, 26.0]])];
    let input = Input { features: &features, strokes: &strokes, region: Some(&ceiling) };
    let segmented = run(&input, &Params { subject: Subject::Lamps, ..Params::default() }, Monitor::default().job());
    assert_eq!(found(&segmented.unwrap().mask).0[..4], [true, true, false, true]);
}

#[test]
fn without_strokes_the_brightest_compact_regions_of_the_plane_are_lamps() {
    let ceiling = ceiling();
    let lamps = segment(&[], Some(&ceiling));
    assert!(lamps.is_proposed && lamps.is_of_lamps);
    assert_eq!(found(&lamps.mask), (vec![true; LAMPS.len()], 0));
    // A negative stroke removes one proposed lamp.
    let not = stroke(false, &[[40.0, 22.0], [40.0, 30.0]]);
    let corrected = segment(std::slice::from_ref(&not), Some(&ceiling));
    assert_eq!(found(&corrected.mask), (vec![false, true, true, true, true], 0));
    // With a positive stroke on a lamp, the mask is not a proposal.
    assert!(!segment(&[stroke(true, &[[25.0, 26.0], [55.0, 26.0]])], Some(&ceiling)).is_proposed);
}

#[test]
fn without_strokes_a_lamp_above_the_camera_may_fill_much_of_the_photo() {
    // A horizontal ceiling; lower rows of the photo show its more distant parts. The lamp covers 31 % of the ceiling's
    // pixels, but only 0.4 % of its area.
    let mut features = features_with(&[[60, 0, 260, 60]]);
    for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
        let depth = 200.0 / (125.0 - (i / WIDTH).min(119) as f32);
        pixel[4..7].copy_from_slice(&[0.01 * depth * (i % WIDTH) as f32, 2.0, depth]);
    }
    let lamps = segment_in(&features, &[], Some(&ceiling()));
    assert!(lamps.is_proposed && lamps.mask.data[30 * WIDTH + 160] > 0.5);
    assert!((lamps.mask.data.iter().sum::<f32>() - 12_000.0).abs() < 600.0);
}

#[test]
fn without_strokes_and_without_lamps_the_error_asks_for_strokes() {
    let refused = |features: &Image, plane: &Image| {
        let input = Input { features, strokes: &[], region: Some(plane) };
        run(&input, &Params::for_lights(), Monitor::default().job()).unwrap_err()
    };
    for (features, plane) in [(features_with(&[]), ceiling()), (features(), Image::new(WIDTH, HEIGHT, 1).unwrap())] {
        let error = refused(&features, &plane);
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.to_string().contains("paint"), "{error}");
    }
}

#[test]
fn a_lamp_in_a_row_with_others_beyond_the_plane_is_distinguished_from_a_window() {
    // The plane's mask ends at y = 50, as if the layout had placed a wall too near. Two bright regions of the
    // ceiling lie outside the mask: a lamp below the first lamp, and a tall window.
    let cut = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 50)]).unwrap();
    let rows = [[20, 20, 60, 32], [120, 20, 160, 32], [22, 70, 60, 81], [200, 66, 206, 106]];
    let lamps = segment_in(&features_with(&rows), &[stroke(true, &[[25.0, 26.0], [55.0, 26.0]])], Some(&cut));
    let columns = |s: &Stroke| s.pixels.iter().map(|p| *p as usize % WIDTH).collect::<Vec<_>>();
    assert_eq!(lamps.beyond.len(), 1, "{:?}", lamps.beyond.iter().map(|b| columns(&b.region)).collect::<Vec<_>>());
    assert!(columns(&lamps.beyond[0].region).iter().all(|x| (20..63).contains(x)));
    // If the mask covers the whole ceiling, no lamp lies beyond it.
    assert!(
        segment_in(&features_with(&rows), &[stroke(true, &[[25.0, 26.0], [55.0, 26.0]])], Some(&ceiling()))
            .beyond
            .is_empty()
    );
}

#[test]
fn a_lamp_beyond_the_plane_continues_a_regular_row_if_it_keeps_the_distances() {
    let cut = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 52)]).unwrap();
    let is_regular = |top: usize| {
        let row = [[20, 10, 60, 20], [20, 35, 60, 45], [20, top, 60, top + 10]];
        let lamps = segment_in(&features_with(&row), &[stroke(true, &[[25.0, 15.0], [55.0, 15.0]])], Some(&cut));
        lamps.beyond.iter().map(|beyond| beyond.is_in_regular_row).collect::<Vec<bool>>()
    };
    assert_eq!([60, 85, 72].map(is_regular), [[true], [true], [false]]);
}

#[test]
fn a_lamp_whose_coloured_glow_leaves_a_hole_in_the_mask_of_the_plane_is_found() {
    // Below the first lamp lies a lamp with a glow of another colour; neither the lamp nor the glow is in the mask.
    let glow = [10, 60, 70, 92];
    let mut features = features_with(&[[20, 20, 60, 32], [120, 20, 160, 32], [20, 70, 60, 82]]);
    for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
        if is_in(glow, i % WIDTH, i / WIDTH) && pixel[0] < 90.0 {
            pixel[0] += 10.0;
            pixel[1] += 12.0;
        }
    }
    let holed = Image::from_fn(WIDTH, HEIGHT, |x, y| [f32::from(y < 120 && !is_in(glow, x, y))]).unwrap();
    let lamps = segment_in(&features, &[stroke(true, &[[25.0, 26.0], [55.0, 26.0]])], Some(&holed));
    assert!(lamps.mask.pixel(40, 76)[0] > 0.5);
}

#[test]
fn a_dim_lamp_counts_on_a_free_site_of_the_lattice_of_the_others_and_not_beside_it() {
    // Lamps at every 60 pixels across and every 30 down; the last one is so dim that it is doubtful.
    let dim_lamp_counts = |dim: [usize; 4]| {
        let sites = (0..3).flat_map(|row| (0..4).map(move |column| [20 + 60 * column, 14 + 30 * row]));
        let mut lamps: Vec<[usize; 4]> = sites.map(|[x, y]| [x, y, x + 20, y + 10]).collect();
        *lamps.last_mut().unwrap() = dim;
        let mut features = features_with(&lamps);
        for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
            if is_in(dim, i % WIDTH, i / WIDTH) {
                pixel[0] -= 6.0;
            }
        }
        let mask = segment_in(&features, &[stroke(true, &[[24.0, 19.0], [36.0, 19.0]])], Some(&ceiling())).mask;
        assert!(lamps[..11].iter().all(|r| mask.pixel(r[0] + 10, r[1] + 5)[0] > 0.5));
        mask.pixel(dim[0] + 10, dim[1] + 5)[0] > 0.5
    };
    assert!(dim_lamp_counts([200, 74, 220, 84]));
    assert!(!dim_lamp_counts([228, 74, 248, 84]), "off the lattice");
    assert!(!dim_lamp_counts([200, 76, 220, 80]), "smaller than the lamps");
}

#[test]
fn without_strokes_lamps_beyond_the_plane_may_have_other_surroundings() {
    // As in the test above, but the ceiling beyond the mask is darker by 15 units of L*.
    let cut = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 50)]).unwrap();
    let rows = [[20, 20, 60, 32], [120, 20, 160, 32], [22, 70, 60, 81], [200, 66, 206, 106]];
    let mut features = features_with(&rows);
    for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
        if i / WIDTH > 52 && pixel[0] < 90.0 {
            pixel[0] -= 15.0;
        }
    }
    let beyond = |strokes: &[Stroke]| segment_in(&features, strokes, Some(&cut)).beyond.len();
    assert_eq!(beyond(&[stroke(true, &[[25.0, 26.0], [55.0, 26.0]])]), 0);
    assert_eq!(beyond(&[]), 1);
}

#[test]
fn without_strokes_both_kinds_of_lamps_are_proposed_but_no_thing_unlike_them() {
    let spots = [[40, 100, 48, 108], [140, 100, 148, 108], [240, 100, 248, 108]];
    let (streak, square) = ([20, 50, 140, 54], [280, 50, 312, 82]);
    let features = features_with(&[&LAMPS[..], &spots, &[streak, square]].concat());
    let mask = segment_in(&features, &[], Some(&ceiling())).mask;
    let is_lit = |r: [usize; 4]| mask.pixel((r[0] + r[2]) / 2, (r[1] + r[3]) / 2)[0] > 0.5;
    assert_eq!(LAMPS.map(is_lit), [true; 5]);
    assert_eq!(spots.map(is_lit), [true; 3]);
    assert_eq!([streak, square].map(is_lit), [false; 2]);
}

#[test]
fn without_strokes_regions_that_are_all_unlike_are_no_proposal() {
    let all = [
        [10, 10, 34, 34],
        [60, 10, 180, 14],
        [200, 10, 260, 70],
        [20, 60, 150, 80],
        [280, 10, 290, 20],
        [280, 40, 288, 90],
    ];
    let (features, plane) = (features_with(&all), ceiling());
    let input = Input { features: &features, strokes: &[], region: Some(&plane) };
    let error = run(&input, &Params::for_lights(), Monitor::default().job()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Degenerate);
}

#[test]
fn light_with_one_soft_side_has_a_soft_contour() {
    // A region as bright as a lamp. Its lower side is soft: L* falls by `slope` per pixel from row 72 on. The other
    // sides are sharp. Measures the contour of the region at an L* of about 90.
    let soft_share = |slope: f32| {
        let mut features = features_with(&[]);
        for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
            let (x, y) = (i % WIDTH, i / WIDTH);
            if is_in([95, 62, 145, 118], x, y) {
                pixel[0] = pixel[0].max(100.0 - slope * (y as f32 - 72.0).max(0.0));
            }
        }
        let monitor = Monitor::default();
        let photo = Brightness::new(&features, 100.0, monitor.job()).unwrap();
        let tree = Tree::new(&photo.levels, regions::level(90.0) as u16, WIDTH, monitor.job()).unwrap();
        // Of the nodes that hold the region's brightest part, the largest is the region.
        let holds = |node: &u32| tree.pixels(*node).contains(&(68 * WIDTH as u32 + 120));
        let node = (1..tree.len() as u32).filter(holds).max_by_key(|&node| tree.pixels(node).len()).unwrap();
        regions::soft_share(node, &tree, &photo, 3.0)
    };
    assert_eq!(soft_share(40.0), 0.0);
    assert!((0.3..0.5).contains(&soft_share(1.8)), "{}", soft_share(1.8));
}

#[test]
fn rays_around_a_small_lamp_are_left_out_and_corners_stay() {
    // `form` tells whether a position, relative to the centre of a lamp, is lit.
    let lit = |form: &dyn Fn(f32, f32) -> bool| {
        let mut features = features_with(&[]);
        for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
            if form((i % WIDTH) as f32 - 160.0, (i / WIDTH) as f32 - 60.0) {
                pixel[0] = 100.0;
            }
        }
        let found = segment_in(&features, &[stroke(true, &[[158.0, 60.0], [162.0, 60.0]])], Some(&ceiling()));
        move |x: f32, y: f32| found.mask.pixel((160.0 + x) as usize, (60.0 + y) as usize)[0] > 0.5
    };
    // A disc with four rays, 3 pixels wide.
    let star = lit(&|x, y| x.hypot(y) < 14.0 || (x.abs().min(y.abs()) < 1.6 && x.abs().max(y.abs()) < 34.0));
    assert!(star(0.0, 0.0) && star(9.0, 9.0) && star(12.0, 0.0));
    assert!(!star(25.0, 0.0) && !star(-25.0, 0.0) && !star(0.0, 25.0));
    // An equilateral triangle, and a cross of broad arms, keep their corners.
    let triangle = lit(&|x, y| y < 15.0 && 3f32.sqrt() * x.abs() < y + 30.0);
    assert!(triangle(0.0, -26.0) && triangle(21.0, 12.0) && triangle(-21.0, 12.0));
    let cross = lit(&|x, y| x.abs().min(y.abs()) < 6.0 && x.abs().max(y.abs()) < 25.0);
    assert!(cross(22.0, 4.0) && cross(-4.0, 22.0));
}

#[test]
fn without_strokes_light_with_soft_edges_on_the_ceiling_is_no_lamp() {
    let plane = ceiling();
    // The L* falls by 1.5 or by 25 per pixel, from 15 pixels around the centre on.
    for (slope, is_lamp) in [(1.5, false), (25.0, true)] {
        let mut features = features_with(&[]);
        for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
            let distance = (i % WIDTH) as f32 - 160.0;
            let distance = distance.hypot((i / WIDTH) as f32 - 60.0);
            pixel[0] = pixel[0].max((100.0 - slope * (distance - 15.0)).min(100.0));
        }
        let input = Input { features: &features, strokes: &[], region: Some(&plane) };
        let found = run(&input, &Params::for_lights(), Monitor::default().job());
        assert_eq!(found.is_ok(), is_lamp, "L* falls by {slope} per pixel");
    }
}

#[test]
fn without_strokes_a_dim_lamp_that_continues_a_row_is_found_and_other_dim_regions_are_not() {
    // Three lamps on a dark ceiling, and a region that is darker than the lamps by 22 units of L*. In the first case,
    // the region lies below the first lamp and continues a row. In the other cases, it lies beside this row, is wider
    // than the lamp, or lies beyond the plane.
    let row = [[20, 20, 60, 32], [120, 20, 160, 32], [220, 20, 260, 32]];
    let lamps = |dim: [usize; 4], strokes: &[Stroke], plane_end: usize| {
        let mut features = features_with(&[&row[..], &[dim]].concat());
        for (i, pixel) in features.data.chunks_exact_mut(CHANNELS).enumerate() {
            if is_in(dim, i % WIDTH, i / WIDTH) {
                pixel[0] -= 22.0;
            } else if pixel[0] < 90.0 {
                pixel[0] -= 15.0;
            }
        }
        let plane = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < plane_end)]).unwrap();
        let found = segment_in(&features, strokes, Some(&plane));
        (found.mask.pixel((dim[0] + dim[2]) / 2, (dim[1] + dim[3]) / 2)[0] > 0.5, found.beyond.len())
    };
    let in_row = [20, 80, 60, 92];
    assert_eq!(lamps(in_row, &[], 120), (true, 0));
    assert_eq!(lamps([75, 80, 105, 92], &[], 120), (false, 0));
    assert_eq!(lamps([14, 80, 66, 92], &[], 120), (false, 0));
    assert_eq!(lamps(in_row, &[], 50).1, 1);
    assert_eq!(lamps(in_row, &[stroke(true, &[[25.0, 26.0], [55.0, 26.0]])], 120), (false, 0));
}
