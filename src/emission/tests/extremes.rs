//! Tests of extreme patterns of lights, for which the correct texture is known texel by texel.

use super::*;

/// Whether a texture repeats its exemplar as a whole, beginning at the texture's corner.
fn repeats(exemplar: &Design, result: &Emission) -> bool {
    let (width, height) = (exemplar.light.width, exemplar.light.height);
    let is_same = |(i, &mask): (usize, &f32)| {
        let (x, y) = (i % result.mask.width % width, i / result.mask.width % height);
        (mask > 0.5) == (exemplar.light.data[y * width + x] >= 0.5)
    };
    result.mask.data.iter().enumerate().all(is_same)
}

#[test]
fn one_lamp_that_touches_every_border_goes_on_as_it_meets_itself() {
    // A diamond whose corners touch the border, a frame, and a cross whose arms run through the exemplar.
    let from_middle = |x: f64, y: f64| DVec2::new(x - 32.0, y - 32.0).abs();
    let diamond = Design::new(64, 64, |x, y| from_middle(x, y).element_sum() < 32.5);
    let frame = Design::new(64, 64, |x, y| from_middle(x, y).max_element() > 26.0);
    let cross = Design::new(64, 64, |x, y| from_middle(x, y).min_element() < 5.0);
    for (name, exemplar) in [("diamond", diamond), ("frame", frame), ("cross", cross)] {
        let result =
            exemplar.run(&Params { width: 200, height: 180, centring: Centring::Never, ..Params::default() }).unwrap();
        assert!(repeats(&exemplar, &result), "{name}: {:?}", result.law);
    }
}

#[test]
fn an_exemplar_of_one_row_or_column_of_pixels_goes_on_at_its_period() {
    let lit = |along: f64| (along as usize).is_multiple_of(5);
    for (width, height) in [(60, 1), (1, 60)] {
        let exemplar = Design::new(width, height, |x, y| lit(if height == 1 { x } else { y }));
        let result =
            exemplar.run(&Params { width: 90, height: 70, centring: Centring::Never, ..Params::default() }).unwrap();
        for (i, &mask) in result.mask.data.iter().enumerate() {
            let along = if height == 1 { i % 90 } else { i / 90 };
            assert_eq!(mask > 0.5, lit(along as f64), "{width} x {height}: {} {}", i % 90, i / 90);
        }
    }
    let point = Design::new(1, 1, |_, _| true);
    let result = point.run(&Params { width: 9, height: 7, centring: Centring::Never, ..Params::default() }).unwrap();
    assert!(result.mask.data.iter().all(|&m| m == 1.0));
}

#[test]
fn textures_of_one_row_or_column_of_texels_show_a_line_of_the_pattern() {
    let exemplar = Design::new(100, 80, grid(25.0, 20.0, 9.0, 7.0));
    for (width, height, share) in [(400, 1, 9.0 / 25.0), (1, 400, 7.0 / 20.0)] {
        for centring in [Centring::Never, Centring::Always] {
            let result = exemplar.run(&Params { width, height, centring, ..Params::default() }).unwrap();
            let lit = result.mask.data.iter().map(|&m| f64::from(m)).sum::<f64>() / 400.0;
            // The texture is a single line of texels. If it runs between lamps, none of its texels is lit. If it runs
            // through lamps, the lit share is `share`, the side of a lamp divided by the period.
            assert!(lit == 0.0 || (lit - share).abs() < 0.02, "{width} x {height}: {lit}");
        }
    }
}

#[test]
fn a_period_longer_than_the_exemplar_is_its_extent() {
    let exemplar = Design::new(100, 80, grid(140.0, 110.0, 30.0, 20.0));
    let result =
        exemplar.run(&Params { width: 400, height: 300, centring: Centring::Never, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Whole(_)), "{:?}", result.law);
    assert_eq!(result.luminaires.len(), 16);
    assert!(result.luminaires.iter().all(|l| (l.area / 600.0 - 1.0).abs() < 0.01));
    assert!(repeats(&exemplar, &result));
}

/// Rows that fan out, as on a curved ceiling, form no lattice. The regularity must be lower, and the error of the
/// texture larger, than with straight rows.
#[test]
fn a_pattern_that_bends_is_no_lattice() {
    let straight = Design::new(420, 320, |x, y| x.rem_euclid(30.0) < 10.0 && y.rem_euclid(30.0) < 10.0);
    let bent = Design::new(420, 320, |x, y| {
        let turned = DVec2::from_angle(0.0035 * x).rotate(DVec2::new(0.0, y));
        (x + turned.x).rem_euclid(30.0) < 10.0 && turned.y.rem_euclid(30.0) < 10.0
    });
    let [straight, bent] =
        [straight, bent].map(|d| d.run(&Params { width: 500, height: 400, ..Params::default() }).unwrap());
    println!("{} {}, {} {}", straight.regularity, straight.error, bent.regularity, bent.error);
    assert!(
        straight.regularity > 0.8 && bent.regularity < 0.7 * straight.regularity,
        "{} {}",
        straight.regularity,
        bent.regularity
    );
    assert!(bent.error > 2.0 * straight.error, "{} {}", straight.error, bent.error);
}
