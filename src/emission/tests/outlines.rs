//! Tests of outlines against shapes with known outlines, at sub-texel precision.

use super::*;
use crate::geometry::polygon;

/// The corners of a shape, rotated about the origin by `angle` in radians, scaled by `radius` and then moved by `at`.
fn turned(corners: &[[f64; 2]], angle: f64, radius: f64, at: DVec2) -> Vec<DVec2> {
    corners.iter().map(|&[x, y]| at + DVec2::from_angle(angle).rotate(DVec2::new(x, y)) * radius).collect()
}

/// A polygon that differs from a disc by less than a thousandth of the radius.
fn disc(radius: f64, at: DVec2) -> Vec<DVec2> {
    (0..96).map(|i| at + DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 96.0) * radius * 1.0003).collect()
}

const SQUARE: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
const ARROW: [[f64; 2]; 5] = [[-1.0, -1.0], [0.2, -1.0], [1.0, 0.1], [0.2, 1.2], [-1.0, 1.2]];
const ELL: [[f64; 2]; 6] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 0.1], [0.1, 0.1], [0.1, 1.0], [-1.0, 1.0]];

/// Whether a point lies inside a polygon, by the even-odd rule.
fn is_inside(shape: &[DVec2], p: DVec2) -> bool {
    let sides = shape.iter().zip(shape.iter().cycle().skip(1));
    sides.filter(|(a, b)| (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)).count() % 2
        == 1
}

/// An exemplar in which the light of each pixel is the share of the pixel that the shapes cover.
fn design(width: usize, height: usize, shapes: &[Vec<DVec2>]) -> Design {
    const N: usize = 8;
    let mut light = Image::new(width, height, 1).unwrap();
    for shape in shapes {
        let (low, high) = shape.iter().fold((shape[0], shape[0]), |(low, high), p| (low.min(*p), high.max(*p)));
        for y in low.y.max(0.0) as usize..(high.y.ceil() as usize).min(height) {
            for x in low.x.max(0.0) as usize..(high.x.ceil() as usize).min(width) {
                let inside = (0..N * N).filter(|i| {
                    let step = DVec2::new((i % N) as f64 + 0.5, (i / N) as f64 + 0.5) / N as f64;
                    is_inside(shape, DVec2::new(x as f64, y as f64) + step)
                });
                light.data[y * width + x] = inside.count() as f32 / (N * N) as f32;
            }
        }
    }
    let unwarped = Image::from_fn(width, height, |_, _| [0.8, 0.7, 0.6]).unwrap();
    let valid = Image::from_fn(width, height, |_, _| [1.0]).unwrap();
    Design { unwarped, light, valid }
}

/// The maximum distance from a point of the outline `from` to the outline `to` (one-sided Hausdorff distance). Ignores
/// points that are closer than `spared` to one of `corners`.
fn distance(from: &[DVec2], to: &[DVec2], corners: &[DVec2], spared: f64) -> f64 {
    let sides = || to.iter().copied().zip(to.iter().copied().cycle().skip(1));
    let nearest = |p: DVec2| {
        let of_side = |(a, b): (DVec2, DVec2)| {
            let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            p.distance(a + (b - a) * t)
        };
        sides().map(of_side).fold(f64::INFINITY, f64::min)
    };
    let points = from.iter().zip(from.iter().cycle().skip(1)).flat_map(|(a, b)| {
        let n = ((*b - *a).length() * 10.0).ceil().max(1.0) as usize;
        (0..n).map(move |i| a.lerp(*b, i as f64 / n as f64))
    });
    points.filter(|p| corners.iter().all(|c| c.distance(*p) >= spared)).map(nearest).fold(0.0, f64::max)
}

/// Three errors of a lamp, compared with its true shape: the maximum distance between the outlines apart from the
/// corners, in texels; the maximum distance including corners, in texels; and the relative error of the area.
fn off(lamp: &Luminaire, truth: &[DVec2], corners: &[DVec2]) -> [f64; 3] {
    let both = |corners: &[DVec2]| {
        distance(truth, &lamp.outline, corners, 1.5).max(distance(&lamp.outline, truth, corners, 1.5))
    };
    [both(corners), both(&[]), (lamp.area / polygon::area(truth) - 1.0).abs()]
}

#[test]
fn outlines_lie_within_a_quarter_of_a_texel() {
    // The outlines may differ by a quarter of a texel. If texels are smaller than unwarped pixels (`scale` < 1), they
    // may differ by a quarter of an unwarped pixel instead.
    for scale in [0.5, 1.0, 1.25, 1.5, 2.0, 3.0, 4.0] {
        let side = (112.0 * scale) as usize;
        let mut worst = [0.0f64; 3];
        for k in 0..5 {
            // Four shapes with sides or diameters of 11 to 17 texels. From case to case, they are rotated, enlarged,
            // and moved by fractions of a texel.
            let aside = |n: f64| DVec2::new((n * 0.618).fract(), (n * 0.755).fract());
            let centre = |n: usize| {
                (DVec2::new((n % 2) as f64 + 0.5, (n / 2) as f64 + 0.5) * 56.0 + aside((4 * k + n) as f64)) * scale
            };
            let (angle, larger) = (k as f64 * 0.18, 1.0 + 0.05 * k as f64);
            let shapes = [
                disc(5.5 * larger * scale, centre(0)),
                turned(&SQUARE, angle, 5.5 * larger * scale, centre(1)),
                turned(&ARROW, angle, 6.3 * larger * scale, centre(2)),
                turned(&ELL, -angle, 7.1 * larger * scale, centre(3)),
            ];
            let params = Params { width: 112, height: 112, scale, ..Params::default() };
            let result = design(side, side, &shapes).run(&params).unwrap();
            assert_eq!((result.law, result.luminaires.len()), (Law::Copy, 4));
            for (n, shape) in shapes.iter().enumerate() {
                let truth: Vec<DVec2> = shape.iter().map(|p| *p / scale).collect();
                let apart = |l: &&Luminaire| l.centre.distance(centre(n) / scale);
                let lamp = result.luminaires.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).unwrap();
                let off = off(lamp, &truth, if n == 0 { &[] } else { &truth });
                worst = std::array::from_fn(|i| worst[i].max(off[i]));
                assert!(lamp.outline.len() < 40, "{}", lamp.outline.len());
            }
        }
        let [sides, all, area] = worst;
        // An outline may cut off a corner of 90° or more, at up to one texel from its tip on both sides. The tip is
        // then at most half the diagonal of a texel, √2/2, from the outline.
        let quarter = if scale < 1.0 { 0.25 / scale } else { 0.25 };
        assert!(sides < quarter, "{scale}: {sides}");
        assert!(all < 2.0 * quarter * 2f64.sqrt(), "{scale}: {all}");
        assert!(area < 0.01 || scale < 1.0, "{scale}: {area}");
    }
}

#[test]
fn a_mirrored_exemplar_has_the_mirrored_outline() {
    let (width, height) = (60usize, 50usize);
    let shape = turned(&ELL, 0.37, 13.0, DVec2::new(27.3, 22.8));
    let mirror = |p: &DVec2| DVec2::new(width as f64 - p.x, p.y);
    let mirrored: Vec<DVec2> = shape.iter().map(mirror).collect();
    let params = Params { width, height, ..Params::default() };
    let outline = |shape: &[DVec2]| {
        let result = design(width, height, &[shape.to_vec()]).run(&params).unwrap();
        result.luminaires[0].outline.clone()
    };
    let (one, other) = (outline(&shape), outline(&mirrored));
    assert_eq!(one.len(), other.len());
    for p in &one {
        assert!(other.iter().any(|q| q.distance(mirror(p)) < 1e-9), "{p} {other:?}");
    }
    // Both outlines must run in the direction from x towards y, in which the signed area is positive.
    assert!(polygon::area(&one) > 0.0 && polygon::area(&other) > 0.0);
}

#[test]
fn a_mask_that_is_nowhere_sure_tells_nearly_the_same() {
    // Scale the light mask by 0.8, so that no pixel is fully light. This may only remove edge pixels whose value falls
    // below 0.5. The second case has no edge pixels with intermediate values, so nothing may change.
    let shapes = [turned(&SQUARE, 0.3, 7.2, DVec2::new(16.3, 14.9)), disc(7.7, DVec2::new(42.6, 16.2))];
    let whole = [turned(&SQUARE, 0.0, 6.0, DVec2::new(15.0, 16.0))];
    let params = Params { width: 60, height: 32, ..Params::default() };
    for (shapes, share, away) in [(&shapes[..], 0.03, 0.3), (&whole[..], 1e-6, 1e-6)] {
        let sure = design(60, 32, shapes);
        let mut unsure = design(60, 32, shapes);
        unsure.light.data.iter_mut().for_each(|c| *c *= 0.8);
        let (sure, unsure) = (sure.run(&params).unwrap(), unsure.run(&params).unwrap());
        assert_eq!(unsure.luminaires.len(), shapes.len());
        for (a, b) in sure.luminaires.iter().zip(&unsure.luminaires) {
            assert!(
                (b.area / a.area - 1.0).abs() < share && distance(&a.outline, &b.outline, &[], 0.0) < away,
                "{b:?}"
            );
        }
    }
}

#[test]
fn a_corner_that_the_border_cuts_stays_cut() {
    for k in 0..8 {
        // A square that stands on a corner. Its left corner reaches over the border by 0 to about 1 texel.
        let beyond = 0.15 * k as f64;
        let shape = turned(&SQUARE, std::f64::consts::FRAC_PI_4, 9.0, DVec2::new(9.0 * 2f64.sqrt() - beyond, 25.3));
        let result = design(40, 50, &[shape]).run(&Params { width: 40, height: 50, ..Params::default() }).unwrap();
        let outline = &result.luminaires[0].outline;
        assert!(outline.iter().all(|p| p.cmpge(DVec2::ZERO).all()), "{beyond}: {outline:?}");
        assert!((result.luminaires[0].area / (324.0 - beyond * beyond) - 1.0).abs() < 0.01);
    }
}

#[test]
fn what_the_border_cuts_ends_at_the_border() {
    let shape = turned(&SQUARE, 0.0, 10.0, DVec2::new(3.25, 30.375));
    let params = Params { width: 60, height: 60, ..Params::default() };
    let exemplar = design(60, 60, &[shape]);
    let lamp = &exemplar.run(&params).unwrap().luminaires[0];
    let truth = turned(&[[0.0, 20.375], [13.25, 20.375], [13.25, 40.375], [0.0, 40.375]], 0.0, 1.0, DVec2::ZERO);
    assert!(distance(&truth, &lamp.outline, &[], 0.0) < 0.05, "{:?}", lamp.outline);
    assert!(distance(&lamp.outline, &truth, &[], 0.0) < 0.05, "{:?}", lamp.outline);
    assert!((lamp.area / (13.25 * 20.0) - 1.0).abs() < 0.002 && lamp.kind == 0, "{}", lamp.area);
    assert!((lamp.size - DVec2::new(20.0, 13.25)).abs().max_element() < 0.1, "{}", lamp.size);
    // The lamp list of the composition must give an equal outline.
    let job = Monitor::default();
    let composition = Composition::new(&exemplar.input(), &[], &params, job.job()).unwrap();
    let list = LampList::new(&composition, &exemplar.input(), &[], job.job()).unwrap();
    assert_eq!((list.count(), list.get(&composition, 0).unwrap().outline), (1, lamp.outline.clone()));
}

#[test]
fn a_copied_part_shows_clean_lamps_where_the_photo_is_ragged() {
    // Two discs, too few for a lattice. A photo pixel is 4 x 4 unwarped pixels, so their outlines are staircases.
    let centres = [[52.3, 47.1], [205.8, 131.4]];
    let is_lit = |x: f64, y: f64| {
        let pixel = DVec2::new((x / 4.0).floor(), (y / 4.0).floor()) * 4.0 + 2.0;
        centres.iter().any(|c| pixel.distance(DVec2::from(*c)) < 13.0)
    };
    let exemplar = Design::new(264, 184, is_lit);
    let reduced =
        Image::from_fn(66, 46, |x, y| [f32::from(is_lit(4.0 * x as f64 + 2.0, 4.0 * y as f64 + 2.0)); 3]).unwrap();
    let to_photo = Homography(glam::DMat3::from_scale(DVec2::splat(0.25)));
    let input = Input { photo: Some((&reduced, to_photo.into())), ..exemplar.input() };
    let lamps = |clean_lamps: bool| {
        let params = Params { width: 264, height: 184, clean_lamps, ..Params::default() };
        let result = run(&input, &params, Monitor::default().job()).unwrap();
        assert_eq!(result.law, Law::Copy);
        result.luminaires
    };
    let (clean, ragged) = (lamps(true), lamps(false));
    assert_eq!((clean.len(), ragged.len()), (2, 2));
    for lamp in &clean {
        assert!((lamp.size.x / lamp.size.y - 1.0).abs() < 0.03, "{}", lamp.size);
        assert!((lamp.area / clean[0].area - 1.0).abs() < 0.03, "{}", lamp.area);
        assert!(centres.iter().any(|c| lamp.centre.distance(DVec2::from(*c)) < 2.0), "{}", lamp.centre);
    }
    assert!(ragged.iter().any(|lamp| (lamp.area / ragged[0].area - 1.0).abs() > 0.03));
}

/// Measures an exemplar of 240 x 180 pixels with lamps on a lattice of 60 pixels; `is_lit` describes a lamp around the
/// origin. The ceiling has half of the lamps' brightness. Returns the lamps of a texture of twice the resolution, and
/// its brightness at a place relative to the centre of a lamp, in unwarped pixels.
fn on_a_dim_ceiling(is_lit: impl Fn(DVec2) -> bool) -> (Vec<Luminaire>, impl Fn(DVec2) -> f32) {
    let centred = |v: f64| v.rem_euclid(60.0) - 30.0;
    let mut exemplar = Design::new(240, 180, |x, y| is_lit(DVec2::new(centred(x), centred(y))));
    for (pixel, light) in exemplar.unwarped.data.chunks_exact_mut(3).zip(&exemplar.light.data) {
        pixel.fill(0.5 + 0.5 * light);
    }
    let to_photo = Homography(glam::DMat3::IDENTITY);
    let input = Input { photo: Some((&exemplar.unwarped, to_photo.into())), ..exemplar.input() };
    let params = Params { width: 800, height: 640, scale: 0.5, ..Params::default() };
    let result = run(&input, &params, Monitor::default().job()).unwrap();
    assert!(matches!(result.law, Law::Lattice(_)), "{:?}", result.law);
    let first = result.luminaires.iter().find(|lamp| lamp.kind > 0).unwrap().centre;
    let texture = result.texture;
    let brightness = move |from_centre: DVec2| {
        let [x, y] = (first + from_centre * 2.0).to_array().map(|v| v as usize);
        texture.rgb(x, y).x
    };
    (result.luminaires, brightness)
}

#[test]
fn rings_and_frames_keep_their_dark_middle() {
    let disc = |p: DVec2| std::f64::consts::PI * p.x * p.x;
    let square = |p: DVec2| 4.0 * p.x * p.x;
    for (norm, area) in [
        ((|p: DVec2| p.length()) as fn(DVec2) -> f64, disc as fn(DVec2) -> f64),
        (|p: DVec2| p.abs().max_element(), square),
    ] {
        let (lamps, brightness) = on_a_dim_ceiling(|p| (11.0..18.0).contains(&norm(p)));
        let true_area = 4.0 * (area(DVec2::splat(18.0)) - area(DVec2::splat(11.0)));
        for lamp in lamps.iter().filter(|lamp| lamp.kind > 0) {
            assert!((lamp.area / true_area - 1.0).abs() < 0.06, "{} instead of {true_area}", lamp.area);
            assert!((lamp.size / 72.0 - 1.0).abs().max_element() < 0.03, "{}", lamp.size);
        }
        let along = |r: f64| [DVec2::X, DVec2::Y, DVec2::NEG_X].map(|axis| brightness(axis * r));
        assert_eq!([along(0.0), along(6.0), along(22.0)], [[0.0; 3]; 3]);
        along(14.5).into_iter().for_each(|b| assert!(b > 0.95, "{b}"));
    }
}

#[test]
fn a_dark_spot_beside_the_middle_makes_no_ring() {
    let spot = DVec2::new(9.0, 0.0);
    let (lamps, brightness) = on_a_dim_ceiling(|p| p.length() < 18.0 && p.distance(spot) > 6.0);
    let disc = 4.0 * std::f64::consts::PI * 18.0 * 18.0;
    for lamp in lamps.iter().filter(|lamp| lamp.kind > 0) {
        assert!((lamp.area / disc - 1.0).abs() < 0.06, "{}", lamp.area);
    }
    assert!(brightness(DVec2::ZERO) > 0.4);
}
