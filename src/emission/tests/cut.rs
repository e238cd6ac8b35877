//! Tests of photos that show the pattern of lamps incompletely: the border cuts lamps, a single lamp shows no spacing,
//! or the pattern ends in view.

use super::*;
use crate::emission::lamps::designs::Designs;
use crate::emission::lamps::instance::Instance;
use crate::emission::lamps::spacing;
use crate::geometry::polygon;

/// The texture of 500 × 400 texels of an exemplar. The exemplar serves as the photo as well, so unwarping changes
/// nothing.
fn continued(exemplar: &Design) -> Emission {
    let photo = Some((&exemplar.unwarped, Homography(glam::DMat3::IDENTITY).into()));
    let params = Params { width: 500, height: 400, ..Params::default() };
    run(&Input { photo, ..exemplar.input() }, &params, Monitor::default().job()).unwrap()
}

/// An exemplar whose photo does not show everything: pixels to the right of the line x = 70 + 1.5 y are invalid.
fn slanted(lamp: impl Fn(f64, f64) -> bool) -> Design {
    let mut design = Design::new(160, 90, lamp);
    for (i, valid) in design.valid.data.iter_mut().enumerate() {
        *valid = f32::from((i % 160) as f64 - (i / 160) as f64 * 1.5 < 70.0);
    }
    design
}

#[test]
fn a_rectangle_that_a_slanted_border_cuts_is_whole_in_the_texture() {
    let design = slanted(|x, y| (60.0..100.0).contains(&x) && (10.0..40.0).contains(&y));
    let result = continued(&design);
    let lamps = inner(&result.luminaires, 500, 400);
    assert!(lamps.len() >= 4, "{}", lamps.len());
    for lamp in lamps {
        assert!((lamp.area - 1200.0).abs() < 40.0, "{}", lamp.area);
        // The upper right corner of the lamp is hidden in the photo. In the texture, it has the colour of the visible
        // part.
        let at = lamp.centre + DVec2::new(17.0, -12.0);
        let texel = result.texture.rgb(at.x as usize, at.y as usize);
        assert!(texel.distance(Vec3::new(0.85, 0.75, 0.65)) < 0.12, "{texel}");
    }
}

#[test]
fn a_lamp_in_a_corner_of_the_photo_does_not_run_through_it() {
    // Five dark pixels lie to the left of the lamp. The slanted border cuts its right end, and lies farther to the
    // right in lower rows. The visible part of the lamp is therefore as long as the visible part of the row of pixels
    // through its centre.
    let design = slanted(|x, y| (5.0..100.0).contains(&x) && y < 8.0);
    let result = continued(&design);
    let lamps = inner(&result.luminaires, 500, 400);
    assert!(lamps.len() >= 4, "{}", lamps.len());
    for lamp in lamps {
        assert!((lamp.size - DVec2::new(76.0, 8.0)).abs().max_element() < 2.0, "{}", lamp.size);
    }
}

#[test]
fn a_lamp_whose_visible_part_is_no_part_of_a_rectangle_keeps_its_outline() {
    // A triangle with its tip at the top and a horizontal base. The border of the photo cuts its right side off.
    let is_lamp = |x: f64, y: f64| (y - 10.0) * 2.0 > (x - 80.0).abs() && (10.0..45.0).contains(&y);
    let design = slanted(is_lamp);
    assert!(design.light.data.iter().zip(&design.valid.data).any(|(l, v)| *l >= 0.5 && *v < 0.5));
    let visible = design.light.data.iter().zip(&design.valid.data).filter(|(l, v)| **l >= 0.5 && **v > 0.5).count();
    let result = continued(&design);
    let lamps = inner(&result.luminaires, 500, 400);
    assert!(!lamps.is_empty());
    for lamp in lamps {
        let area = polygon::area(&lamp.outline).abs();
        assert!((area / visible as f64 - 1.0).abs() < 0.05, "{area} {visible}");
    }
}

#[test]
fn a_single_lamp_repeats_at_equal_distances_along_both_axes() {
    // A strip of 160 × 40 pixels with one lamp. The lamp repeats in squares with the area of the strip, so their sides
    // are 80 pixels.
    let design = Design::new(160, 40, |x, y| (x - 70.0).abs() < 9.0 && (y - 22.0).abs() < 8.0);
    let result = continued(&design);
    let centres: Vec<DVec2> = inner(&result.luminaires, 500, 400).iter().map(|lamp| lamp.centre).collect();
    let step = |axis: DVec2| {
        let along = |c: &DVec2| (*c - centres[0]).dot(axis);
        centres.iter().map(along).filter(|d| *d > 1.0).fold(f64::INFINITY, f64::min)
    };
    let (across, down) = (step(DVec2::X), step(DVec2::Y));
    assert!((across - 80.0).abs() < 1.0 && (down - 80.0).abs() < 1.0, "{across} {down}");
}

/// Each window consists of 2 × 2 panes. Bars of 4 pixels separate the panes of a window, and bars of 20 pixels separate
/// the windows. The lattice must have the period of the windows, not the period of the panes.
#[test]
fn windows_of_panes_keep_the_wide_bars_between_them() {
    let is_lit = |n: f64| {
        let n = (n - 6.0).rem_euclid(84.0);
        (0.0..30.0).contains(&n) || (34.0..64.0).contains(&n)
    };
    let design = Design::new(400, 380, |x, y| is_lit(x) && is_lit(y));
    let result = continued(&design);
    let Law::Lattice(basis) = result.law else { panic!("{:?}", result.law) };
    let periods = basis.map(|period| period.length());
    assert!(periods.iter().all(|period| (period - 84.0).abs() < 1.0), "{periods:?}");
    let share = |image: &Image| image.data.iter().filter(|l| **l >= 0.5).count() as f64 / image.data.len() as f64;
    assert!((share(&result.mask) / share(&design.light) - 1.0).abs() < 0.1);
}

/// Columns of wide windows, with two panes side by side, alternate with columns of narrow windows of one pane. A
/// lattice with one pane per cell would predict the centres of all panes to within 4 pixels, but it would give all
/// panes one width and all bars one width.
#[test]
fn windows_of_two_widths_keep_their_period() {
    let lies_in = |n: f64, panes: &[[f64; 2]]| panes.iter().any(|pane| (pane[0]..pane[1]).contains(&n));
    let across = |x: f64| lies_in((x - 8.0).rem_euclid(112.0), &[[0.0, 22.0], [38.0, 64.0], [68.0, 94.0]]);
    let down = |y: f64| lies_in((y - 8.0).rem_euclid(84.0), &[[0.0, 30.0], [34.0, 64.0]]);
    let result = continued(&Design::new(250, 380, |x, y| across(x) && down(y)));
    let Law::Lattice(basis) = result.law else { panic!("{:?}", result.law) };
    let [mut across, mut down] = basis.map(|period| period.length());
    if across < down {
        (across, down) = (down, across);
    }
    assert!((across - 112.0).abs() < 1.0 && (down - 84.0).abs() < 1.0, "{:?}", result.law);
}

/// Columns of windows at unequal distances have a period along y only. Along x, the texture repeats all columns,
/// without the dark margins beside them; the width of the widest bar keeps the repetitions apart.
#[test]
fn columns_of_windows_at_unequal_distances_repeat_as_one() {
    let along = |n: f64| {
        let n = (n - 6.0).rem_euclid(84.0);
        (0.0..30.0).contains(&n) || (34.0..64.0).contains(&n)
    };
    let cases: [(&[f64], usize, f64); 2] = [
        (&[40.0, 94.0, 128.0], 200, 142.0),
        // A single column has no bar beside it. It repeats along x after its width of 30 pixels plus 20 pixels, the
        // width of the widest bar along y.
        (&[5.0], 40, 50.0),
    ];
    for (columns, width, expected) in cases {
        let across = |n: f64| columns.iter().any(|left| (*left..left + 30.0).contains(&n));
        let result = continued(&Design::new(width, 380, |x, y| across(x) && along(y)));
        let Law::Row([period, repeat]) = result.law else { panic!("{width}: {:?}", result.law) };
        assert!((period.length() - 84.0).abs() < 1.0, "{width}: {period}");
        assert!((repeat.length() - expected).abs() < 2.0, "{width}: {repeat}");
    }
}

/// A skylight of three columns shows no period along x, but begins and ends with narrow windows. The last column of a
/// repetition is the first one of the next, so that narrow and wide windows alternate.
#[test]
fn a_skylight_that_begins_and_ends_with_like_columns_alternates() {
    let lies_in = |n: f64, panes: &[[f64; 2]]| panes.iter().any(|pane| (pane[0]..pane[1]).contains(&n));
    let across = |x: f64| lies_in(x, &[[28.0, 48.0], [64.0, 90.0], [94.0, 120.0], [136.0, 156.0]]);
    let down = |y: f64| lies_in((y - 8.0).rem_euclid(84.0), &[[0.0, 30.0], [34.0, 64.0]]);
    let result = continued(&Design::new(190, 380, |x, y| across(x) && down(y)));
    let Law::Row([period, repeat]) = result.law else { panic!("{:?}", result.law) };
    assert!((period.length() - 84.0).abs() < 1.0 && (repeat.length() - 108.0).abs() < 1.0, "{:?}", result.law);
    // Each pane keeps its width: no wide pane stands in a narrow column.
    let widths: Vec<f64> = inner(&result.luminaires, 500, 400).iter().map(|lamp| lamp.size.min_element()).collect();
    let narrow = widths.iter().filter(|width| **width < 23.0).count();
    assert!((narrow as f64 / widths.len() as f64 - 1.0 / 3.0).abs() < 0.1, "{narrow} of {}", widths.len());
}

#[test]
fn lamps_that_the_border_cuts_show_a_period() {
    // Two whole lamps, and above them two lamps of which the photo shows only the lower half.
    let design = Design::new(160, 90, |x, y| {
        [40.0, 105.0].iter().any(|at| (x - at).abs() < 12.0) && ((y - 55.0).abs() < 8.0 || y < 8.0)
    });
    let law = continued(&design).law;
    let Law::Lattice([a, b]) = law else { panic!("{law:?}") };
    let [across, down] = if a.x.abs() > a.y.abs() { [a, b] } else { [b, a] };
    assert!((across.abs() - DVec2::new(65.0, 0.0)).length() < 1.0, "{law:?}");
    assert!((down.abs() - DVec2::new(0.0, 55.0)).length() < 1.0, "{law:?}");
}

#[test]
fn copies_stay_apart_as_the_lamps_of_the_photo_do() {
    let design =
        Design::new(160, 90, |x, y| [40.0, 105.0].iter().any(|at| (x - at).abs() < 12.0) && (y - 45.0).abs() < 8.0);
    let exemplar = Exemplar::new(&design.input(), 160.0, 0.0, Monitor::default().job()).unwrap();
    // The gap between the lamps of the exemplar is 41 pixels. Copies must keep at least half of it: a gap of 21 pixels
    // is allowed, and one of 20 is not.
    let copies = [0.0, 44.0, 45.0, 90.0, 0.5].map(|x| Instance { component: 0, shift: DVec2::new(x, 0.0) });
    let kept = |law: Law, copies: [Instance; 5]| -> Vec<f64> {
        let kept = spacing::keep_apart(&exemplar, &Designs::default(), law, copies.to_vec());
        kept.iter().map(|copy| copy.shift.x).collect()
    };
    assert_eq!(kept(Law::Free, copies), [0.0, 45.0, 90.0]);
    // On a lattice with a period of 34 pixels, lamps are 10 pixels apart, although the photo shows no such pair.
    let lattice = Law::Lattice([DVec2::new(34.0, 0.0), DVec2::new(0.0, 60.0)]);
    let copies = [0.0, 34.0, 36.0, 68.0, 0.5].map(|x| Instance { component: 0, shift: DVec2::new(x, 0.0) });
    assert_eq!(kept(lattice, copies), [0.0, 34.0, 68.0]);
}

#[test]
fn a_pattern_continues_where_the_photo_shows_its_end() {
    // The first three columns of lamps are missing, so the photo shows that the pattern ends at the left. The texture
    // must nevertheless have lamps everywhere.
    let lamp = grid(40.0, 36.0, 14.0, 10.0);
    let exemplar = Design::new(280, 180, |x, y| x > 110.0 && lamp(x, y));
    let photo = Some((&exemplar.unwarped, Homography(glam::DMat3::IDENTITY).into()));
    let params = Params { width: 500, height: 400, law: LawMode::Lattice, ..Params::default() };
    let result = run(&Input { photo, ..exemplar.input() }, &params, Monitor::default().job()).unwrap();
    let cells = (500.0 / 40.0) * (400.0 / 36.0);
    let lamps = result.luminaires.iter().map(|lamp| lamp.area).sum::<f64>() / 140.0;
    assert!((lamps / cells - 1.0).abs() < 0.1, "{lamps} lamps in {cells} cells, {:?}", result.law);
    assert!(result.error < 0.1, "{}", result.error);
}

#[test]
fn gaps_between_lamps_stay() {
    // Every second lamp of the middle row is missing.
    let lamp = grid(40.0, 36.0, 14.0, 10.0);
    let result = continued(&Design::new(240, 180, |x, y| {
        let [column, row] = [(x / 40.0).floor() as usize, (y / 36.0).floor() as usize];
        lamp(x, y) && !(row == 2 && column % 2 == 1)
    }));
    let cells = (500.0 / 40.0) * (400.0 / 36.0);
    let lamps = result.luminaires.iter().map(|lamp| lamp.area).sum::<f64>() / 140.0;
    assert!((0.8..0.97).contains(&(lamps / cells)), "{lamps} lamps in {cells} cells");
}

#[test]
fn a_small_lamp_among_large_ones_is_no_fragment_unless_it_lies_beside_one() {
    let is_panel = |x: f64, y: f64| {
        [(60.0, 60.0), (260.0, 60.0), (60.0, 200.0)].iter().any(|(u, v)| (x - u).abs() < 20.0 && (y - v).abs() < 20.0)
    };
    let small_lamps = |disc: DVec2| {
        let design = Design::new(360, 260, |x, y| is_panel(x, y) || disc.distance(DVec2::new(x, y)) < 8.0);
        let result = continued(&design);
        assert!(result.luminaires.iter().any(|lamp| lamp.area > 1500.0));
        inner(&result.luminaires, 500, 400).iter().filter(|lamp| lamp.area < 250.0).count()
    };
    assert!(small_lamps(DVec2::new(260.0, 200.0)) >= 1);
    assert_eq!(small_lamps(DVec2::new(90.0, 60.0)), 0);
}
