//! Tests of half-painted pictures, whose unpainted part is synthesised from the painted part.

use super::*;

/// Synthesises the right half of a picture from its left half, which is painted.
fn completed(art: &Image, scene: &Image) -> Output {
    let half =
        |left: f32| Image::from_fn(art.width, art.height, |x, _| [if 2 * x < art.width { left } else { 1.0 - left }]);
    let (painted, rest) = (half(1.0).unwrap(), half(0.0).unwrap());
    let guides = [guide(scene, scene)];
    let masks = Input { source_mask: Some(&painted), target_mask: Some(&rest), ..input(art, &guides) };
    stylise(&Input { known: Some(art), ..masks }, &Params { levels: 3, ..Params::default() }).unwrap()
}

/// Mean difference of the second channel between the columns `x` and `x + 1`.
fn step(picture: &Image, x: usize) -> f32 {
    let rows = (0..picture.height).map(|y| (picture.pixel(x, y)[1] - picture.pixel(x + 1, y)[1]).abs());
    rows.sum::<f32>() / picture.height as f32
}

#[test]
fn new_paint_joins_the_painted_part_and_leaves_it_as_it_is() {
    // The light does not change from left to right: only the strokes decide which piece of the artwork continues the
    // painted part.
    let scene = Image::from_fn(120, 96, |_, y| [0.3 + 0.2 * y as f32 / 96.0]).unwrap();
    let art = Image::from_fn(120, 96, |x, y| {
        let stroke = ((x + 2 * y) % 7) as f32 / 7.0;
        [0.3 + 0.3 * stroke + 0.1 * Rng::new(8, &[x as u64, y as u64]).next_f32(); 3]
    })
    .unwrap();
    let output = completed(&art, &scene);
    for y in 0..96 {
        assert!((0..60).all(|x| output.image.pixel(x, y) == art.pixel(x, y)), "painted pixels stay");
    }
    // Each step is the mean of 96 differences, with a standard error of about 7 %. Allow two standard errors.
    let beside = (50..70).filter(|x| !(57..62).contains(x)).map(|x| step(&output.image, x)).sum::<f32>() / 15.0;
    let across = step(&output.image, 59);
    assert!(across < 1.14 * beside, "{across} {beside}");
    assert_eq!(output.report.lack.share, 0.0);
    assert_eq!(output.report.warnings(true), []);
}

#[test]
fn light_that_the_painted_part_lacks_uses_no_patch_too_often_and_is_named_with_its_place() {
    // A lamp lights the bottom of the right half, which is not painted yet.
    let lit = |x: usize, y: usize| x >= 60 && y >= 48;
    let scene =
        Image::from_fn(120, 96, |x, y| [if lit(x, y) { 0.9 } else { 0.1 + 0.1 * (y % 48) as f32 / 48.0 }]).unwrap();
    let art = artwork(&Image::from_fn(120, 96, |x, y| [scene.pixel(x, y)[0], 0.0, 0.0]).unwrap());
    let output = completed(&art, &scene);
    // There are 60 × 92 patches to paint and 56 × 92 exemplar patches, so the mean number of uses is 1.07. The maximum
    // is 100 times the mean (`border::MAX_USES`), 107; the test allows slightly more.
    assert!(output.report.usage.max_uses <= 115, "{}", output.report.usage.max_uses);
    let lack = output.report.lack;
    assert!((lack.share - 0.5).abs() < 0.03, "{lack:?}");
    assert!(lack.place.is_some_and(|[x, y]| lit(x, y)), "{lack:?}");
    let message = |is_half_painted| output.report.warnings(is_half_painted)[0].to_string();
    assert!(message(true).contains("painted part") && message(false).contains("exemplar"), "{}", message(true));
    let error = &output.report.guide_error;
    assert!(error.pixel(90, 72)[0] > 0.3 && error.pixel(90, 24)[0] < 0.1);
}
