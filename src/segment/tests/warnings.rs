//! Tests that each warning about masks is raised for a bad mask, and that a good mask raises none.

use super::*;
use crate::job::Monitor;
use crate::rng::Rng;
use crate::segment::{Input, Params, run};

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

/// A photo with one feature: about 1 in the upper left (x < 100), about `strange` in the upper right, and about 0 in
/// the lower half.
fn photo(strange: f32) -> Image {
    Image::from_fn(WIDTH, HEIGHT, |x, y| {
        let noise = 0.05 * Rng::new(3, &[x as u64, y as u64]).normal() as f32;
        [noise
            + if y >= HEIGHT / 2 {
                0.0
            } else if x < 100 {
                1.0
            } else {
                strange
            }]
    })
    .unwrap()
}

fn stroke(positive: bool, from: [f64; 2], to: [f64; 2]) -> Stroke {
    Stroke::polyline(&[from.into(), to.into()], 3.0, positive, WIDTH, HEIGHT).unwrap()
}

fn strokes() -> Vec<Stroke> {
    vec![
        stroke(true, [10.0, 15.0], [90.0, 20.0]),
        stroke(true, [20.0, 40.0], [80.0, 45.0]),
        stroke(false, [10.0, 75.0], [150.0, 80.0]),
        stroke(false, [10.0, 100.0], [150.0, 110.0]),
    ]
}

fn segmented(features: &Image, strokes: &[Stroke]) -> Segmentation {
    run(&Input { features, strokes, region: None }, &Params::default(), Monitor::default().job()).unwrap()
}

fn codes(list: impl IntoIterator<Item = Warning>) -> Vec<Code> {
    list.into_iter().map(|warning| warning.code).collect()
}

#[test]
fn a_mask_that_strokes_have_shown_raises_nothing() {
    let mask = segmented(&photo(1.0), &strokes());
    assert_eq!(codes(mask.warnings()), []);
    assert_eq!(codes(mask.missed(strokes().iter())), []);
}

#[test]
fn a_face_unlike_every_stroke_raises_a_warning_with_a_place_on_it() {
    let mask = segmented(&photo(6.0), &strokes());
    let warnings = mask.warnings();
    assert!(codes(warnings.clone()).contains(&Code::Unseen), "{warnings:?}");
    let unseen = warnings.into_iter().find(|w| w.code == Code::Unseen).unwrap();
    // The strange area covers three eighths of the mask.
    assert!((unseen.severity - 0.375).abs() < 0.02, "{unseen:?}");
    let place = unseen.place.unwrap();
    assert!(place.x > 100.0 && place.y < 60.0, "{place}");

    // Another stroke at the suggested place removes the warning.
    let more = [strokes(), vec![stroke(true, place.to_array(), (place + DVec2::splat(1.0)).to_array())]].concat();
    assert!(!codes(segmented(&photo(6.0), &more).warnings()).contains(&Code::Unseen));
}

#[test]
fn strokes_that_contradict_each_other_or_miss_the_photo_raise_warnings() {
    let mut painted = strokes();
    painted.push(stroke(false, [10.0, 15.0], [60.0, 20.0]));
    assert!(codes(segmented(&photo(1.0), &painted).warnings()).contains(&Code::ContradictoryStrokes));
    let mut painted = strokes();
    painted.push(Stroke { pixels: (0..400).map(|i| (WIDTH * HEIGHT + i) as u32).collect(), positive: true });
    assert_eq!(codes(segmented(&photo(1.0), &painted).warnings()), [Code::OffImageStrokes]);
}

#[test]
fn classes_that_look_alike_raise_warnings() {
    let alike = Image::from_fn(WIDTH, HEIGHT, |x, y| [Rng::new(4, &[x as u64, y as u64]).normal() as f32]).unwrap();
    let mask = segmented(&alike, &strokes());
    assert!(codes(mask.warnings()).contains(&Code::UncertainMask), "{:?}", mask.warnings());
    let missed = mask.missed(strokes().iter()).unwrap();
    assert_eq!(missed.code, Code::MissedStrokes);
    // The suggested place is a pixel of a stroke that the mask assigns to the wrong class.
    let place = missed.place.unwrap();
    let pixel = place.y as usize * WIDTH + place.x as usize;
    let is_there = |s: &Stroke| s.pixels.contains(&(pixel as u32)) && s.positive != (mask.mask.data[pixel] > 0.5);
    assert!(strokes().iter().any(is_there), "{place}");
}

#[test]
fn a_mask_of_the_callers_is_believed_unless_it_is_empty() {
    let half = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 60)]).unwrap();
    let given = Segmentation::from_confidence(&half).unwrap();
    assert_eq!(codes(given.warnings()), []);
    assert_eq!(given.missed([stroke(false, [10.0, 10.0], [150.0, 10.0])].iter()), None);
    let empty = Segmentation::from_confidence(&Image::new(WIDTH, HEIGHT, 1).unwrap()).unwrap();
    assert_eq!(codes(empty.warnings()), [Code::EmptyMask]);
}

#[test]
fn lights_over_most_of_the_plane_raise_a_warning() {
    let plane = Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < 60)]).unwrap();
    let lights = |below: usize| Image::from_fn(WIDTH, HEIGHT, |_, y| [f32::from(y < below)]).unwrap();
    assert_eq!(almost_all_lit(&lights(20), &plane), None);
    let raised = almost_all_lit(&lights(45), &plane).unwrap();
    assert_eq!((raised.code, raised.severity), (Code::AlmostAllLit, 0.75));
    // Masks of different sizes are not compared, and a plane without pixels raises no warning.
    assert_eq!(almost_all_lit(&Image::from_fn(9, 9, |_, _| [1.0]).unwrap(), &plane), None);
    assert_eq!(almost_all_lit(&lights(45), &Image::new(WIDTH, HEIGHT, 1).unwrap()), None);
}

#[test]
fn painted_lamps_no_brighter_than_the_plane_raise_a_warning_with_a_place_on_the_darkest() {
    // Lightness rises from left to right.
    let ramp = Image::from_fn(WIDTH, HEIGHT, |x, _| [x as f32]).unwrap();
    let plane = [stroke(true, [20.0, 60.0], [60.0, 60.0]), stroke(false, [150.0, 90.0], [150.0, 99.0])];
    let lamp = |x: f64| stroke(true, [x, 10.0], [x, 20.0]);
    assert_eq!(dim_lamps(&ramp, &plane, &[lamp(100.0), lamp(120.0)]), None);
    let dim = dim_lamps(&ramp, &plane, &[lamp(100.0), lamp(40.0)]).unwrap();
    assert_eq!(dim.code, Code::DimLamps);
    // The whole plane is darker than one lamp, and half of the plane is darker than the other.
    assert!((dim.severity - 0.75).abs() < 0.01, "{dim:?}");
    assert!((dim.place.unwrap().x - 40.0).abs() < 4.0, "{dim:?}");
    // If a lamp and the plane have equal lightness, the severity is one half.
    let flat = Image::from_fn(WIDTH, HEIGHT, |_, _| [7.0]).unwrap();
    assert_eq!(dim_lamps(&flat, &plane, &[lamp(100.0)]).unwrap().severity, 0.5);
    // Strokes marked "not light" count as plane. If plane strokes run over lamps, the comparison with the "not light"
    // strokes alone decides.
    let beside = |x: f64| stroke(false, [x, 5.0], [x, 9.0]);
    assert!(dim_lamps(&ramp, &[], &[lamp(100.0), beside(140.0)]).is_some());
    let over = [stroke(true, [80.0, 15.0], [140.0, 15.0])];
    assert!(dim_lamps(&ramp, &over, &[lamp(100.0)]).is_some());
    assert_eq!(dim_lamps(&ramp, &over, &[lamp(100.0), beside(60.0)]), None);
    // Without plane pixels there is no comparison.
    assert_eq!(dim_lamps(&ramp, &[], &[lamp(100.0)]), None);
}

#[test]
fn regions_that_may_be_lamps_raise_a_warning_with_a_place_on_one() {
    let square = |x: usize, y: usize, left: usize| (left..left + 10).contains(&x) && (20..30).contains(&y);
    let mask = Image::from_fn(WIDTH, HEIGHT, |x, y| [f32::from(square(x, y, 20) || square(x, y, 60))]).unwrap();
    let lamps = |unseen: Image| Segmentation {
        unseen,
        samples: [10, 10],
        is_of_lamps: true,
        ..Segmentation::from_confidence(&mask).unwrap()
    };
    assert_eq!(codes(lamps(Image::new(WIDTH, HEIGHT, 1).unwrap()).warnings()), []);
    let third = Image::from_fn(WIDTH, HEIGHT, |x, y| [f32::from(square(x, y, 100))]).unwrap();
    let warnings = lamps(third.clone()).warnings();
    assert_eq!(codes(warnings.clone()), [Code::Unseen]);
    assert!((warnings[0].severity - 1.0 / 3.0).abs() < 1e-9);
    let place = warnings[0].place.unwrap();
    assert!(square(place.x as usize, place.y as usize, 100), "{place}");
    // Lamps proposed without any stroke raise the same warning, with a different text.
    let proposed = Segmentation { samples: [0, 0], is_proposed: true, ..lamps(third) };
    assert_eq!(codes(proposed.warnings()), [Code::Proposed, Code::Unseen]);
    assert!(proposed.warnings()[1].message.contains("proposed lamps"), "{:?}", proposed.warnings());
}
