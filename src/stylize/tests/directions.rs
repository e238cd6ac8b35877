//! Tests of the decision whether the normals guide a run.

use super::*;
use glam::Vec3;

/// Light and normals of a ball of some radius before a wall.
fn ball(radius: f32) -> [Image; 2] {
    let normal = |x: usize, y: usize| {
        let (dx, dy) = ((x as f32 - 120.0) / radius, (90.0 - y as f32) / radius);
        let inside = 1.0 - dx * dx - dy * dy;
        if inside > 0.0 { Vec3::new(dx, dy, inside.sqrt()) } else { Vec3::Z }
    };
    let lit = |x: usize, y: usize| [normal(x, y).dot(Vec3::new(0.3, 0.5, 0.81)).max(0.05)];
    let image = Image::from_fn(240, 180, lit).unwrap();
    [image, Image::from_fn(240, 180, |x, y| normal(x, y).to_array()).unwrap()]
}

/// Strokes with grain: `phase` grows across them.
fn drawn(light: &Image, phase: impl Fn(f32, f32) -> f32) -> Image {
    Image::from_fn(light.width, light.height, |x, y| {
        let grain = 0.1 * Rng::new(6, &[x as u64, y as u64]).next_f32();
        [0.4 * light.pixel(x, y)[0] + 0.1 * (1.0 + phase(x as f32, y as f32).sin()) + grain]
    })
    .unwrap()
}

#[test]
fn the_normals_guide_strokes_that_follow_the_shapes_and_no_others() {
    let [light, normals] = ball(84.0);
    let [target_light, target_normals] = ball(60.0);
    let guides = [guide(&light, &target_light)];
    let slopes = Guide { name: "normals", source: &normals, target: &target_normals, weight: 0.5, range: Range::Data };
    let params = Params { levels: 2, ..Params::preview() };
    let decided = |art: &Image, guide_record: Option<&GuideRecord>| {
        let input = Input { normals: Some(slopes), guide_record, ..input(art, &guides) };
        (stylise(&input, &params).unwrap(), stylise(&Input { normals: None, ..input }, &params).unwrap())
    };
    // Rings around the middle of the ball follow its shape.
    let rings = drawn(&light, |x, y| 1.4 * (x - 120.0).hypot(y - 90.0));
    let (with, without) = decided(&rings, None);
    assert_eq!((with.report.normals_weight, without.report.normals_weight), (0.5, 0.0));
    assert!(with.field.at != without.field.at);
    // Slanted strokes do not follow the shape, and grain has no strokes: in both cases the normals are not used.
    let slanted = drawn(&light, |x, y| 0.9 * x + 1.1 * y);
    for art in [&slanted, &drawn(&light, |_, _| 0.0)] {
        let (with, without) = decided(art, None);
        assert_eq!(with.report.normals_weight, 0.0);
        assert!(with.image == without.image && with.field.at == without.field.at);
    }
    // Later frames of a sequence take over the decision of the first frame from its record.
    let (first, _) = decided(&slanted, None);
    assert_eq!(decided(&rings, Some(&first.guide_record)).0.report.normals_weight, 0.0);
    assert_eq!(decided(&slanted, Some(&with.guide_record)).0.report.normals_weight, 0.5);
}

#[test]
fn only_the_pixels_that_may_be_used_decide() {
    let [light, normals] = ball(84.0);
    let rings = drawn(&light, |x, y| 1.4 * (x - 120.0).hypot(y - 90.0));
    let wall = Image::from_fn(240, 180, |x, _| [f32::from(x < 30)]).unwrap();
    let guides = [guide(&light, &light)];
    let slopes = Guide { name: "normals", source: &normals, target: &normals, weight: 0.5, range: Range::Data };
    let masked = Input { normals: Some(slopes), source_mask: Some(&wall), ..input(&rings, &guides) };
    assert_eq!(stylise(&masked, &Params::preview()).unwrap().report.normals_weight, 0.0);
    // An artwork smaller than a block has no directions.
    let thin = Image::from_fn(6, 600, |_, y| [y as f32 / 600.0]).unwrap();
    let slopes = Guide { source: &thin, target: &thin, ..slopes };
    let output = stylise(&Input { normals: Some(slopes), ..input(&thin, &[guide(&thin, &thin)]) }, &Params::preview());
    assert_eq!(output.unwrap().report.normals_weight, 0.0);
    // Normals of a wrong size are an error, even if the artwork is too small for the decision.
    let small = Image::new(24, 18, 3).unwrap();
    let wrong = Guide { source: &small, target: &normals, ..slopes };
    assert!(stylise(&Input { normals: Some(wrong), ..masked }, &Params::preview()).is_err());
}
