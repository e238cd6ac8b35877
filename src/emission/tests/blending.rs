//! Tests of blending two exemplars: the shares of lamps and light follow the weights, and with a weight of 0 or 1 the
//! texture equals, to the bit, the texture of one exemplar alone.

use super::*;

/// An exemplar of square lamps with sides of 14 pixels, or of round lamps with a radius of 11. The period is 40, and
/// the first period begins at `start`.
fn exemplar(is_round: bool, start: f64) -> Design {
    Design::new(280, 280, move |x, y| {
        let (u, v) = ((x - start).rem_euclid(40.0) - 20.0, (y - start).rem_euclid(40.0) - 20.0);
        if is_round { u.hypot(v) < 11.0 } else { u.abs().max(v.abs()) < 7.0 }
    })
}

/// A map with the same weight everywhere.
fn even(weight: f32) -> Image {
    Image::from_fn(1, 1, |_, _| [weight]).unwrap()
}

fn blended(first: &Design, second: &Design, weights: &Image, params: &Params) -> Emission {
    let styles = [Style { input: second.input(), scale: params.scale, weights }];
    blend(&first.input(), &styles, params, Monitor::default().job()).unwrap()
}

#[test]
fn a_weight_of_one_is_the_exemplar_alone_bit_by_bit() {
    let (first, second) = (exemplar(false, 0.0), exemplar(true, 7.0));
    let lines = Design::new(200, 200, |_, y| (y - 5.0).rem_euclid(24.0) < 6.0);
    for scale in [1.0, 1.3] {
        let params = Params { width: 400, height: 360, scale, ..Params::default() };
        for (a, b) in [(&first, &second), (&second, &lines), (&lines, &first)] {
            for (weight, alone) in [(0.0, a), (1.0, b)] {
                let (both, alone) = (blended(a, b, &even(weight), &params), alone.run(&params).unwrap());
                assert_eq!((both.texture, both.mask), (alone.texture, alone.mask), "{weight} {scale}");
                assert_eq!(both.luminaires, alone.luminaires);
            }
        }
    }
}

#[test]
fn lamps_and_light_follow_the_weights() {
    // At a start of 0, the lamps of both exemplars have the same centres. At other starts, the second exemplar's lamps
    // are shifted, and lamps of both exemplars would overlap if all were drawn.
    let first = exemplar(false, 0.0);
    let params = Params { width: 1200, height: 1200, working_side: 128, ..Params::default() };
    let (square, round) = (196.0, std::f64::consts::PI * 121.0);
    for (start, weight) in [(0.0, 0.25), (5.0, 0.6), (20.0, 0.6)] {
        let second = exemplar(true, start);
        let result = blended(&first, &second, &even(weight), &params);
        let lamps = inner(&result.luminaires, 1200, 1200);
        let rounds = lamps.iter().filter(|l| l.area > 300.0).count() as f64;
        // Each lamp must be a complete square or a complete disc.
        let is_whole = |l: &&Luminaire| (l.area - square).abs() < 20.0 || (l.area - round).abs() < 20.0;
        assert!(lamps.iter().all(is_whole), "{start} {weight}");
        // The shapes must be listed as two kinds; the kind with more lamps has number 1.
        let of_rounds = if rounds > 0.5 * lamps.len() as f64 { 1 } else { 2 };
        assert!(lamps.iter().all(|l| (l.kind == of_rounds) == (l.area > 300.0) && (1..=2).contains(&l.kind)));
        // At each of the 30 × 30 = 900 places, a lamp is round with probability `weight`, independently of the others.
        // Allow three standard deviations of the share of round lamps.
        let weight = f64::from(weight);
        let places = 900.0;
        let deviation = (weight * (1.0 - weight) / places).sqrt();
        assert!((rounds / lamps.len() as f64 - weight).abs() < 3.0 * deviation, "{start} {weight} {rounds}");
        let lit = result.mask.data.iter().map(|&m| f64::from(m)).sum::<f64>() / 1.44e6;
        let expected = ((1.0 - weight) * square + weight * round) / 1600.0;
        let spread = 3.0 * deviation * (square + round) / 1600.0;
        assert!((lit - expected).abs() < spread, "{start} {weight}: {lit} for {expected}");
        assert!(result.error < 0.1, "{}", result.error);
    }
}

#[test]
fn weights_differ_from_place_to_place() {
    let (first, second) = (exemplar(false, 0.0), exemplar(true, 0.0));
    let ramp = Image::from_fn(2, 1, |x, _| [x as f32]).unwrap();
    let params = Params { width: 1600, height: 600, working_side: 128, ..Params::default() };
    let result = blended(&first, &second, &ramp, &params);
    // The weight is 0 up to 1/4 of the width, the centre of the map's first pixel, and rises linearly to 1 at 3/4, the
    // centre of its second pixel. In each quarter of the texture, the share of round lamps must be the mean weight.
    for (strip, expected) in [(0, 0.0f64), (1, 0.25), (2, 0.75), (3, 1.0)] {
        let range = f64::from(strip) * 400.0..f64::from(strip + 1) * 400.0;
        let lamps: Vec<&Luminaire> =
            (inner(&result.luminaires, 1600, 600).into_iter()).filter(|l| range.contains(&l.centre.x)).collect();
        let share = lamps.iter().filter(|l| l.area > 300.0).count() as f64 / lamps.len() as f64;
        let allowed = if expected == expected.round() { 0.0 } else { 3.0 * (0.25 / lamps.len() as f64).sqrt() };
        assert!((share - expected).abs() <= allowed, "{strip}: {share}");
    }
}

#[test]
fn panes_side_by_side_change_from_patch_to_patch() {
    // The panes of both exemplars cover most of the plane, and their periods differ. So a pane of one exemplar hardly
    // ever fits between panes of the other. The exemplar must be chosen for a whole square of the texture, not pane by
    // pane.
    let pane = |period: f64, side: f64| {
        Design::new(280, 280, move |x, y| x.rem_euclid(period) > period - side && y.rem_euclid(period) > period - side)
    };
    // In place, no pane happens to touch a pane of the other exemplar.
    let params = Params { width: 1500, height: 1500, centring: Centring::Never, ..Params::default() };
    let result = blended(&pane(40.0, 34.0), &pane(31.0, 25.0), &even(0.5), &params);
    let lit = result.mask.data.iter().map(|&m| f64::from(m)).sum::<f64>() / 2.25e6;
    let expected = 0.5 * (34.0f64 / 40.0).powi(2) + 0.5 * (25.0f64 / 31.0).powi(2);
    assert!(lit > 0.7 * expected && lit < 1.05 * expected, "{lit} {expected}");
    let lamps = inner(&result.luminaires, 1500, 1500);
    let is_whole = |l: &&Luminaire| (l.area - 1156.0).abs() < 80.0 || (l.area - 625.0).abs() < 60.0;
    assert!(lamps.iter().all(is_whole));
}

#[test]
fn weights_out_of_range_are_named() {
    let (first, second) = (exemplar(false, 0.0), exemplar(true, 0.0));
    let fails = |weights: &[&Image]| {
        let styles: Vec<Style> =
            weights.iter().map(|weights| Style { input: second.input(), scale: 1.0, weights }).collect();
        blend(&first.input(), &styles, &Params::default(), Monitor::default().job()).unwrap_err().message
    };
    assert!(fails(&[&even(1.5)]).contains("weights holds 1.5"));
    assert!(fails(&[&even(f32::NAN)]).contains("weights holds NaN"));
    assert!(fails(&[&even(0.75), &even(0.5)]).contains("add up to 1.25"));
    assert!(fails(&[&even(0.5), &Image::new(2, 1, 1).unwrap()]).contains("2 x 1"));
    assert!(fails(&[&Image::new(1, 1, 3).unwrap()]).contains("3 channels"));
}
