//! Tests of the reports on defects of the exemplar: blemishes, and two paints for one light.

use super::*;
use crate::warning::Code;

/// Light with a slow vertical gradient, and an artwork that follows this light, with grain.
fn exemplar() -> (Image, Image) {
    let light = Image::from_fn(192, 144, |_, y| [0.2 + 0.5 * y as f32 / 144.0]).unwrap();
    let art = Image::from_fn(192, 144, |x, y| {
        let grain = 0.1 * Rng::new(9, &[x as u64, y as u64]).next_f32();
        let v = 0.6 * light.pixel(x, y)[0] + grain;
        [v, 0.8 * v, 0.5 * v]
    });
    (light, art.unwrap())
}

fn codes_and_places(art: &Image, light: &Image) -> Vec<(Code, Option<[usize; 2]>)> {
    let params = Params { levels: 2, ..Params::fast() };
    let warnings = stylise(&input(art, &[guide(light, light)]), &params).unwrap().report.warnings(false);
    warnings.iter().map(|w| (w.code, w.place.map(|p| [p.x as usize, p.y as usize]))).collect()
}

#[test]
fn stains_and_two_paints_for_one_light_are_named_with_their_places_and_clean_artworks_are_not() {
    let (light, art) = exemplar();
    assert_eq!(codes_and_places(&art, &light), []);

    let mut stained = art.clone();
    for (x, y) in (60..74).flat_map(|x| (40..54).map(move |y| (x, y))) {
        stained.pixel_mut(x, y).copy_from_slice(&[0.0, 0.6, 0.1]);
    }
    let [(Code::Blemish, Some([x, y]))] = codes_and_places(&stained, &light)[..] else { panic!("one stain") };
    assert!((60..74).contains(&x) && (40..54).contains(&y), "{x} {y}");

    let mut halves = art.clone();
    for (x, y) in (96..192).flat_map(|x| (0..144).map(move |y| (x, y))) {
        halves.pixel_mut(x, y).reverse();
    }
    let found = codes_and_places(&halves, &light);
    assert!(matches!(found[..], [(Code::AmbiguousPaint, Some(_))]), "{found:?}");
    // A guide that distinguishes the left half from the right half resolves the doubt: each half then has one paint.
    let side = Image::from_fn(192, 144, |x, _| [f32::from(x < 96)]).unwrap();
    let guides = [guide(&light, &light), Guide { name: "side", range: Range::Data, ..guide(&side, &side) }];
    let params = Params { levels: 2, ..Params::fast() };
    assert_eq!(stylise(&input(&halves, &guides), &params).unwrap().report.warnings(false), []);
}
