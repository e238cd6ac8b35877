//! Tests of half-painted pictures, whose unpainted part is synthesised from the painted part.

use super::*;
use crate::warning::Code;

/// Synthesises the right half of a picture from its left half, which is painted.
fn completed(art: &Image, scene: &Image) -> Output {
    completed_by(art, &[guide(scene, scene)], &Params { levels: 3, ..Params::default() })
}

fn completed_by(art: &Image, guides: &[Guide], params: &Params) -> Output {
    let (painted, rest) = (half(art, 1.0), half(art, 0.0));
    let masks = Input { source_mask: Some(&painted), target_mask: Some(&rest), ..input(art, guides) };
    stylise(&Input { known: Some(art), ..masks }, params).unwrap()
}

/// A mask of the size of `art`: `left` in the left half, `1 - left` in the right half.
fn half(art: &Image, left: f32) -> Image {
    Image::from_fn(art.width, art.height, |x, _| [if 2 * x < art.width { left } else { 1.0 - left }]).unwrap()
}

/// Mean absolute difference of the second channel between the columns `x` and `x + 1`.
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

    // A preview compresses the six channels to a few components. It must still report the light of the lamp as lacking
    // in the same share of the pixels. The data channels add nothing to this share.
    let data = Image::from_fn(120, 96, |x, _| std::array::from_fn::<f32, 5, _>(|c| (x * (c + 1) % 60) as f32 / 60.0));
    let data = data.unwrap();
    let guides = [Guide { name: "data", range: Range::Data, ..guide(&data, &data) }, guide(&scene, &scene)];
    let preview = completed_by(&art, &guides, &Params { levels: 2, ..Params::preview() });
    assert!(
        preview.report.halvings == 1 && (preview.report.lack.share - 0.5).abs() < 0.05,
        "{:?}",
        preview.report.lack
    );
    let warnings = preview.report.warnings(true);
    let place = warnings[0].place.unwrap();
    assert!(warnings[0].code == Code::LightNotPainted && lit(place.x as usize, place.y as usize), "{place}");
}

#[test]
fn an_update_fades_the_step_at_the_border_as_the_first_run_does() {
    let of = |v: f32| Image::from_fn(80, 60, |_, _| [v; 3]).unwrap();
    let (scene, known, painted) = (of(0.5), of(0.2), of(0.6));
    let (rest, everywhere) = (half(&known, 0.0), Image::from_fn(80, 60, |_, _| [1.0]).unwrap());
    let guides = [guide(&scene, &scene)];
    let params = Params { levels: 2, ..Params::fast() };
    let input = |art| Input { target_mask: Some(&rest), known: Some(&known), ..Input::new(art, &guides) };
    let first = stylise(&input(&painted), &params).unwrap().image;
    let [near, far] = [40, 70].map(|x| first.pixel(x, 30)[0]);
    assert!(near < 0.4 && (far - 0.6).abs() < 1e-4, "{near} {far}");

    let (mut updater, _) = Updater::new(&input(&of(0.9)), &params, &|_| (), Monitor::default().job()).unwrap();
    let updated = updater.repaint(&painted, &everywhere, Monitor::default().job()).unwrap();
    let differs = updated.data.iter().zip(&first.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(differs < 1e-5, "{differs}");
}
