//! Tests of emission as a whole: patterns with known statistics, exact copies, and extreme inputs.

mod blending;
mod cut;
mod extremes;
mod lines;
mod outlines;
mod placing;
mod second_law;
mod tiles;
mod variety;

use super::*;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::geometry::Homography;
use crate::job::Monitor;
use crate::rng::Rng;
use exemplar::{Exemplar, components};
use glam::{DMat2, DVec2, Vec3};

struct Design {
    unwarped: Image,
    light: Image,
    valid: Image,
}

impl Design {
    /// An exemplar with lamps where `lamp` is true. Colours vary from pixel to pixel, so that every source pixel can
    /// be identified.
    fn new(width: usize, height: usize, lamp: impl Fn(f64, f64) -> bool) -> Self {
        let on = |x: usize, y: usize| lamp(x as f64 + 0.5, y as f64 + 0.5);
        let noise = |x: usize, y: usize, c: u64| 0.1 * Rng::new(9, &[x as u64, y as u64, c]).next_f32();
        let unwarped = Image::from_fn(width, height, |x, y| {
            let base = if on(x, y) { [0.8, 0.7, 0.6] } else { [0.1, 0.1, 0.12] };
            std::array::from_fn::<f32, 3, _>(|c| base[c] + noise(x, y, c as u64))
        });
        let light = Image::from_fn(width, height, |x, y| {
            [(f32::from(on(x, y)) + noise(x, y, 3) - noise(x, y, 4)).clamp(0.0, 1.0)]
        });
        let valid = Image::from_fn(width, height, |_, _| [1.0]);
        Self { unwarped: unwarped.unwrap(), light: light.unwrap(), valid: valid.unwrap() }
    }

    /// Marks the two upper corners as invalid, as in a typical unwarped photo.
    fn with_corners_cut(mut self) -> Self {
        let (w, h) = (self.valid.width as f64, self.valid.height as f64);
        for i in 0..self.valid.data.len() {
            let (x, y) = ((i % self.valid.width) as f64 / w, (i / self.valid.width) as f64 / h);
            if x + 0.7 * y < 0.25 || (1.0 - x) + 0.9 * y < 0.3 {
                self.valid.data[i] = 0.0;
            }
        }
        self
    }

    fn input(&self) -> Input<'_> {
        Input { unwarped: &self.unwarped, light: &self.light, valid: &self.valid, photo: None }
    }

    fn run(&self, params: &Params) -> Result<Emission> {
        run(&self.input(), params, Monitor::default().job())
    }
}

/// The statistics of a texture, compared with its exemplar.
#[derive(Debug)]
struct Score {
    /// Two ratios of texture to exemplar. `count_ratio`: number of lamps per area. `area`: mean area of a lamp.
    count_ratio: f64,
    area: f64,
    /// `cut`: number of lamps inside the texture that are smaller than 70 % of the exemplar's smallest lamp. `merged`:
    /// number of lamps inside the texture that are larger than 130 % of the exemplar's largest lamp.
    cut: usize,
    merged: usize,
    /// Root mean square distance of the lamps from the best-fitting lattice, in cell coordinates: a step of each period
    /// has length 1.
    phase: f64,
}

fn inner(lamps: &[Luminaire], width: usize, height: usize) -> Vec<&Luminaire> {
    let size = DVec2::new(width as f64, height as f64);
    let off_border =
        |l: &&Luminaire| l.outline.iter().all(|p| p.min_element() > 0.0 && (size - *p).min_element() > 0.0);
    lamps.iter().filter(off_border).collect()
}

/// Scores a texture. `per_area` is the exemplar's number of lamps per area. `areas` holds the exemplar's smallest, mean
/// and largest lamp area. `basis` is the lattice for `phase`; without a lattice, `phase` is 0.
fn score(result: &Emission, per_area: f64, areas: (f64, f64, f64), basis: Option<[DVec2; 2]>) -> Score {
    let (width, height) = (result.mask.width, result.mask.height);
    let lamps = inner(&result.luminaires, width, height);
    let mean = lamps.iter().map(|l| l.area).sum::<f64>() / lamps.len() as f64;
    // The number of lamps is the lit area divided by the mean lamp area, so that lamps at the border count with their
    // visible part.
    let lit = result.mask.data.iter().sum::<f32>() as f64;
    let centres: Vec<DVec2> = lamps.iter().map(|l| l.centre).collect();
    let phase = basis.map_or(0.0, |basis| statistics::phase(&centres, basis));
    Score {
        count_ratio: lit / mean / (width * height) as f64 / per_area,
        area: mean / areas.1,
        cut: lamps.iter().filter(|l| l.area < 0.7 * areas.0).count(),
        merged: lamps.iter().filter(|l| l.area > 1.3 * areas.2).count(),
        phase,
    }
}

fn grid(px: f64, py: f64, w: f64, h: f64) -> impl Fn(f64, f64) -> bool {
    move |x, y| (x - 9.0).rem_euclid(px) < w && (y - 7.0).rem_euclid(py) < h
}

fn check(name: &str, s: &Score) {
    let fine = (s.count_ratio - 1.0).abs() < 0.05 && (s.area - 1.0).abs() < 0.05 && s.cut == 0 && s.merged == 0;
    assert!(fine && s.phase < 0.02, "{name}: {s:?}");
}

#[test]
fn grids_go_on_in_phase() {
    let params = Params { width: 700, height: 640, ..Params::default() };
    for (name, px, py, w, h) in
        [("square", 40.0, 40.0, 14.0, 14.0), ("rectangular", 48.0, 40.0, 20.0, 10.0), ("odd", 37.3, 51.7, 11.0, 23.0)]
    {
        for cut in [false, true] {
            let mut exemplar = Design::new(300, 280, grid(px, py, w, h));
            if cut {
                exemplar = exemplar.with_corners_cut();
            }
            let result = exemplar.run(&params).unwrap();
            assert!(matches!(result.law, Law::Lattice(_)), "{name}: {:?}", result.law);
            let basis = [DVec2::new(px, 0.0), DVec2::new(0.0, py)];
            let area = if px == px.round() { w * h } else { (w * h).round() };
            check(name, &score(&result, 1.0 / (px * py), (0.9 * area, area, area * 1.1), Some(basis)));
        }
    }
}

#[test]
fn hexagonal_skewed_and_mixed_lattices_go_on_in_phase() {
    let params = Params { width: 700, height: 640, centring: Centring::Never, ..Params::default() };
    let patterns: [(&str, DVec2, DVec2, f64); 3] = [
        ("hexagonal", DVec2::new(44.0, 0.0), DVec2::new(22.0, 38.0), 8.0),
        ("skewed", DVec2::new(40.0, 6.0), DVec2::new(-8.0, 46.0), 9.0),
        ("tilted", DVec2::new(36.0, 20.0), DVec2::new(-20.0, 36.0), 9.0),
    ];
    for (name, a, b, radius) in patterns {
        let inverse = DMat2::from_cols(a, b).inverse();
        let exemplar = Design::new(320, 300, |x, y| {
            let p = DVec2::new(x - 17.5, y - 11.5);
            let base = (inverse * p).floor();
            (0..4).any(|i| {
                let cell = base + DVec2::new(f64::from(i % 2), f64::from(i / 2));
                (p - a * cell.x - b * cell.y).length() < radius
            })
        });
        let result = exemplar.run(&params).unwrap();
        assert!(matches!(result.law, Law::Lattice(_)), "{name}: {:?}", result.law);
        let area = std::f64::consts::PI * radius * radius;
        check(name, &score(&result, 1.0 / a.perp_dot(b), (0.9 * area, area, 1.1 * area), Some([a, b])));
    }

    // Square and round lamps in alternate columns: both kinds must stay in their own columns.
    let exemplar = Design::new(360, 300, |x, y| {
        let (u, v) = ((x - 10.0).rem_euclid(100.0) - 25.0, (y - 6.0).rem_euclid(50.0) - 25.0);
        (u.abs() < 12.0 && v.abs() < 12.0) || (u - 50.0).hypot(v) < 8.0
    });
    let result = exemplar.run(&Params { width: 800, height: 600, ..params }).unwrap();
    let basis = [DVec2::new(50.0, 0.0), DVec2::new(0.0, 50.0)];
    let (square, round) = (576.0, 201.0);
    let mean = (square + round) / 2.0;
    let s = score(&result, 1.0 / 2500.0, (0.9 * round, mean, square), Some(basis));
    check("two kinds", &s);
    for lamp in inner(&result.luminaires, 800, 600) {
        let column = ((lamp.centre.x - 35.0) / 50.0).round() as i64;
        assert_eq!(lamp.area > 400.0, column % 2 == 0, "{:?}", lamp.centre);
    }
}

#[test]
fn missing_lamps_stay_missing_in_proportion() {
    let (px, py) = (40.0, 36.0);
    let exemplar = Design::new(400, 396, |x, y| {
        let cell = [((x - 9.0) / px).floor() as i64 as u64, ((y - 7.0) / py).floor() as i64 as u64];
        grid(px, py, 16.0, 12.0)(x, y) && Rng::new(77, &cell).next_f64() < 0.9
    });
    let lit = exemplar.light.data.iter().filter(|&&v| v >= 0.5).count() as f64;
    let result = exemplar.run(&Params { width: 1000, height: 900, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Lattice(_)), "{:?} {}", result.law, result.regularity);
    let per_area = lit / 192.0 / (400.0 * 396.0);
    check(
        "missing",
        &score(&result, per_area, (192.0, 192.0, 192.0), Some([DVec2::new(px, 0.0), DVec2::new(0.0, py)])),
    );
}

#[test]
fn every_block_size_serves() {
    let exemplar = Design::new(512, 480, grid(48.0, 40.0, 20.0, 10.0)).with_corners_cut();
    for block in (25..=200).step_by(25) {
        let params = Params { width: 640, height: 600, block, ..Params::default() };
        let result = exemplar.run(&params).unwrap();
        let basis = [DVec2::new(48.0, 0.0), DVec2::new(0.0, 40.0)];
        check(&format!("block {block}"), &score(&result, 1.0 / 1920.0, (200.0, 200.0, 200.0), Some(basis)));
    }
}

/// Returns round lamps at random positions, whose centres are more than `gap` apart, and the number of lamps.
fn blobs(width: usize, height: usize, gap: f64) -> (Design, usize) {
    let mut rng = Rng::new(21, &[]);
    let mut centres: Vec<(DVec2, f64)> = Vec::new();
    for _ in 0..4000 {
        let p = DVec2::new(rng.next_f64() * width as f64, rng.next_f64() * height as f64);
        if centres.iter().all(|c| c.0.distance(p) > gap) {
            centres.push((p, 4.0 + 3.0 * rng.next_f64()));
        }
    }
    let count = centres.len();
    (Design::new(width, height, |x, y| centres.iter().any(|c| c.0.distance(DVec2::new(x, y)) < c.1)), count)
}

#[test]
fn scattered_lamps_stay_whole_and_as_many() {
    let (exemplar, _) = blobs(256, 256, 26.0);
    let whole = exemplar.run(&Params { width: 256, height: 256, ..Params::default() }).unwrap();
    assert_eq!(whole.law, Law::Copy);
    let lamps = inner(&whole.luminaires, 256, 256);
    let areas: Vec<f64> = lamps.iter().map(|l| l.area).collect();
    let mean = areas.iter().sum::<f64>() / areas.len() as f64;
    let (least, most) = (areas.iter().copied().fold(f64::MAX, f64::min), areas.iter().copied().fold(0.0, f64::max));
    let per_area = whole.mask.data.iter().sum::<f32>() as f64 / mean / 65_536.0;
    let result = exemplar.run(&Params { width: 700, height: 700, ..Params::default() }).unwrap();
    assert_eq!(result.law, Law::Free);
    let s = score(&result, per_area, (least, mean, most), None);
    // Patches repeat contiguous parts of the exemplar, so the texture's mean lamp area is no more precise than a mean
    // over the n lamps of the exemplar. Allow three standard errors of such a mean, 3 σ / √n, with the standard
    // deviation σ of the lamp areas. The number of lamps per area is the lit share divided by the mean lamp area. Allow
    // the same error for it, because the error of the lit share is smaller.
    let deviation = (areas.iter().map(|a| (a / mean - 1.0).powi(2)).sum::<f64>() / areas.len() as f64).sqrt();
    let allowed = 3.0 * deviation / (areas.len() as f64).sqrt();
    assert!(s.cut == 0 && s.merged == 0, "{s:?}");
    assert!((s.count_ratio - 1.0).abs() < allowed && (s.area - 1.0).abs() < allowed, "{s:?} {allowed}");
    assert!(result.error < 0.1, "{}", result.error);
}

#[test]
fn a_texture_inside_the_exemplar_is_copied_bit_by_bit() {
    let exemplar = Design::new(120, 90, grid(30.0, 30.0, 10.0, 12.0));
    let result = exemplar.run(&Params { width: 120, height: 90, ..Params::default() }).unwrap();
    assert_eq!(result.law, Law::Copy);
    assert_eq!(result.error, 0.0);
    for (i, texel) in result.texture.data.chunks_exact(3).enumerate() {
        let lit = exemplar.light.data[i] >= 0.5;
        assert_eq!(result.mask.data[i], f32::from(lit));
        assert_eq!(texel, if lit { &exemplar.unwarped.data[3 * i..3 * i + 3] } else { &[0.0; 3] });
    }
}

#[test]
fn copied_lamps_are_those_of_the_exemplar_and_a_photo_adds_detail() {
    let exemplar = Design::new(200, 200, grid(40.0, 40.0, 14.0, 14.0));
    let params = Params { width: 500, height: 500, working_side: 100, ..Params::default() };
    let result = exemplar.run(&params).unwrap();
    let key = |c: &[f32]| [c[0].to_bits(), c[1].to_bits(), c[2].to_bits()];
    let known: std::collections::HashSet<_> = exemplar.unwarped.data.chunks_exact(3).map(key).collect();
    for (texel, &mask) in result.texture.data.chunks_exact(3).zip(&result.mask.data) {
        assert!(if mask > 0.0 { known.contains(&key(texel)) } else { texel == [0.0; 3] });
    }

    // With a photo of twice the resolution, and two texels per unwarped pixel, the texture must show the photo's
    // pixels.
    let photo = Image::from_fn(400, 400, |x, y| [(x % 7) as f32, (y % 5) as f32, (x * y % 3) as f32]).unwrap();
    let to_photo = Homography(glam::DMat3::from_scale(DVec2::splat(2.0)));
    let input = Input { photo: Some((&photo, to_photo.into())), ..exemplar.input() };
    let params = Params { width: 400, height: 400, scale: 0.5, ..Params::default() };
    let result = run(&input, &params, Monitor::default().job()).unwrap();
    let mut lit = 0;
    for (i, texel) in result.texture.data.chunks_exact(3).enumerate().filter(|(i, _)| result.mask.data[*i] > 0.0) {
        assert_eq!(texel, photo.pixel(i % 400, i / 400));
        lit += 1;
    }
    assert!((f64::from(lit) / 4.0 / (25.0 * 196.0) - 1.0).abs() < 0.05, "{lit}");
}

#[test]
fn a_coarse_photo_does_not_give_its_steps_to_the_outlines() {
    // The left and right edges of a lamp are jagged: they jump every 5 unwarped pixels, the length of a photo pixel.
    // The jumps differ from lamp to lamp.
    let is_lamp = |x: f64, y: f64| {
        let (x, y) = (x as usize, y as usize);
        let step = [0, 2, 4, 1][(x / 50 + 3 * (y / 40) + y / 5) % 4];
        (14 + step..34 + step).contains(&(x % 50)) && (10..30).contains(&(y % 40))
    };
    let exemplar = Design::new(250, 200, is_lamp);
    let photo = Image::from_fn(50, 40, |_, _| [0.5; 3]).unwrap();
    let to_photo = Homography(glam::DMat3::from_scale(DVec2::splat(0.2)));
    let input = Input { photo: Some((&photo, to_photo.into())), ..exemplar.input() };
    let params = Params { width: 150, height: 120, ..Params::default() };
    let result = run(&input, &params, Monitor::default().job()).unwrap();
    assert!(matches!(result.law, Law::Lattice(_)), "{:?}", result.law);
    assert!(result.luminaires.len() >= 4, "{:?}", result.luminaires);
    for lamp in &result.luminaires {
        assert_eq!(lamp.outline.len(), 4, "{:?}", lamp.outline);
    }
    // With a photo, all lamps are drawn from their design, so the renderer needs no map of the lit blocks. Without a
    // photo, it needs the map.
    let has_map = |input: &Input| {
        let composition = Composition::new(input, &[], &params, Monitor::default().job()).unwrap();
        composition.layers[0].lit_blocks.is_some()
    };
    assert!(!has_map(&input) && has_map(&exemplar.input()));
}

#[test]
fn reduced_textures_keep_their_light() {
    let exemplar = Design::new(200, 200, grid(40.0, 40.0, 14.0, 14.0));
    let mean = |e: &Emission| e.texture.data.iter().map(|&v| f64::from(v)).sum::<f64>() / e.texture.data.len() as f64;
    let full = exemplar.run(&Params { width: 600, height: 600, ..Params::default() }).unwrap();
    for scale in [1.7, 4.0, 12.5] {
        let side = (600.0 / scale) as usize;
        let small = exemplar.run(&Params { width: side, height: side, scale, ..Params::default() }).unwrap();
        assert!((mean(&small) / mean(&full) - 1.0).abs() < 0.03, "{scale}: {} {}", mean(&small), mean(&full));
    }
}

#[test]
fn the_bits_do_not_depend_on_the_threads() {
    let lattice = Design::new(200, 180, grid(33.0, 29.0, 12.0, 9.0)).with_corners_cut();
    for exemplar in [lattice, blobs(200, 180, 22.0).0] {
        let params = Params { width: 300, height: 300, scale: 1.3, ..Params::default() };
        let with = |threads| Pool::new(threads).unwrap().run(|| exemplar.run(&params)).unwrap();
        let (one, three) = (with(1), with(3));
        assert_eq!(one.texture, three.texture);
        assert_eq!(one.metadata, three.metadata);
        assert_eq!(one.luminaires, three.luminaires);
    }
}

#[test]
fn one_lamp_is_repeated_at_the_size_of_the_exemplar() {
    let exemplar = Design::new(80, 60, |x, y| (x - 40.0).abs() < 10.0 && (y - 25.0).abs() < 8.0);
    let result = exemplar.run(&Params { width: 240, height: 180, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Whole(_)));
    assert_eq!(result.luminaires.len(), 9);
    // The confidence of edge pixels has noise of up to a tenth, which changes the areas slightly.
    assert!(result.luminaires.iter().all(|l| (l.area / 320.0 - 1.0).abs() < 0.01));
    assert!(result.error < 1e-6);
}

#[test]
fn lights_that_touch_every_border_go_on() {
    // An exemplar that is entirely light.
    let all = Design::new(64, 48, |_, _| true);
    let result = all.run(&Params { width: 200, height: 150, ..Params::default() }).unwrap();
    assert!(result.mask.data.iter().all(|&m| m == 1.0));
    assert_eq!(result.luminaires.len(), 1);

    // Lines that run through the whole exemplar keep their spacing.
    let lines = Design::new(200, 200, |_, y| (y - 5.0).rem_euclid(24.0) < 6.0);
    let result = lines.run(&Params { width: 500, height: 480, ..Params::default() }).unwrap();
    assert!(result.error < 0.05, "{}", result.error);
    assert_eq!(result.luminaires.len(), 20);
    // The confidence of edge pixels has noise of up to a tenth, which changes sizes and areas slightly.
    assert!(result.luminaires.iter().all(|l| (l.size - DVec2::new(500.0, 6.0)).abs().max_element() < 0.3));
    assert!(result.luminaires.iter().all(|l| (l.area / 3000.0 - 1.0).abs() < 0.01));
}

#[test]
fn odd_sizes_give_finite_results() {
    let exemplar = Design::new(100, 80, grid(25.0, 20.0, 9.0, 7.0));
    for (width, height) in [(1, 1), (1, 300), (300, 1), (3, 5), (101, 80)] {
        for scale in [0.01, 0.7, 1.0, 9.0] {
            let params = Params { width, height, scale, ..Params::default() };
            let result = exemplar.run(&params).unwrap();
            assert_eq!((result.texture.width, result.mask.height), (width, height));
            assert_eq!(result.texture.count_non_finite() + result.metadata.count_non_finite(), 0);
        }
    }
    // An exemplar with a single valid pixel.
    let mut point = Design::new(40, 40, |_, _| true);
    point.valid.data.fill(0.0);
    point.valid.data[40 * 7 + 9] = 1.0;
    let result = point.run(&Params { width: 50, height: 50, working_side: 16, ..Params::default() }).unwrap();
    assert!(result.mask.data.iter().all(|&m| m == 1.0));

    // An exemplar that is entirely light.
    let all = Design::new(60, 50, |_, _| true);
    for params in
        [Params { width: 150, height: 130, ..Params::default() }, Params { min_regularity: 1.0, ..Params::default() }]
    {
        let result = all.run(&params).unwrap();
        assert!(result.mask.data.iter().all(|&m| m == 1.0) && result.texture.count_non_finite() == 0);
    }

    // Patches larger than the exemplar.
    let params = Params { width: 400, height: 300, block: 5000, ..Params::default() };
    let result = exemplar.run(&params).unwrap();
    let basis = [DVec2::X * 25.0, DVec2::Y * 20.0];
    check("large patch", &score(&result, 1.0 / 500.0, (63.0, 63.0, 63.0), Some(basis)));
}

#[test]
fn pixels_that_are_not_numbers_are_left_out() {
    let mut exemplar = Design::new(160, 160, grid(32.0, 32.0, 12.0, 12.0));
    for i in 0..40 {
        let at = (70 + i / 8) * 160 + 60 + i % 8;
        exemplar.unwarped.data[3 * at] = f32::NAN;
        exemplar.light.data[at + 3200] = f32::INFINITY;
        exemplar.valid.data[at + 9] = f32::NAN;
    }
    let result =
        exemplar.run(&Params { width: 400, height: 400, centring: Centring::Never, ..Params::default() }).unwrap();
    assert_eq!(result.texture.count_non_finite(), 0);
    check(
        "not numbers",
        &score(&result, 1.0 / 1024.0, (144.0, 144.0, 144.0), Some([DVec2::X * 32.0, DVec2::Y * 32.0])),
    );
}

#[test]
fn what_has_no_answer_is_an_error_that_says_so() {
    let dark = Design::new(20, 20, |_, _| false);
    let error = dark.run(&Params::default()).unwrap_err();
    assert_eq!(error.kind, ErrorKind::Degenerate);
    assert!(error.message.contains("no light is marked"));

    let mut exemplar = Design::new(20, 20, |x, _| x < 5.0);
    for bad in [
        Params { width: 0, ..Params::default() },
        Params { height: 70_000, ..Params::default() },
        Params { scale: 0.0, ..Params::default() },
        Params { scale: f64::NAN, ..Params::default() },
        Params { working_side: 4, ..Params::default() },
        Params { guide_weight: -1.0, ..Params::default() },
    ] {
        assert_eq!(exemplar.run(&bad).unwrap_err().kind, ErrorKind::InvalidArgument, "{bad:?}");
    }
    let monitor = Monitor::default();
    monitor.cancel();
    assert_eq!(run(&exemplar.input(), &Params::default(), monitor.job()).unwrap_err().kind, ErrorKind::Cancelled);
    exemplar.valid.data.fill(0.0);
    assert_eq!(exemplar.run(&Params::default()).unwrap_err().kind, ErrorKind::Degenerate);
    exemplar.light = Image::new(20, 21, 1).unwrap();
    assert!(exemplar.run(&Params::default()).unwrap_err().message.contains("20 x 21"));
}

#[test]
fn even_lamps_have_one_colour_each_and_keep_their_light() {
    let exemplar = Design::new(200, 180, grid(40.0, 36.0, 14.0, 10.0));
    let params = Params { width: 300, height: 300, ..Params::default() };
    let (plain, even) = (exemplar.run(&params).unwrap(), exemplar.run(&Params { even_lamps: true, ..params }).unwrap());
    assert_eq!(plain.mask, even.mask);
    // Compare complete lamps only. In `even`, a lamp that the border cuts has the mean colour of the whole lamp; in
    // `plain`, it has the mean colour of its visible part.
    for (a, b) in inner(&plain.luminaires, 300, 300).into_iter().zip(inner(&even.luminaires, 300, 300)) {
        assert!((a.colour - b.colour).abs().max_element() < 1e-5 && (a.flux_share / b.flux_share - 1.0).abs() < 1e-3);
        let (x, y) = (b.centre.x as usize, b.centre.y as usize);
        assert!((even.texture.rgb(x, y) - b.colour).abs().max_element() < 1e-5);
    }
}

#[test]
fn clipped_lamps_of_two_colours_keep_them_in_the_texture() {
    // Warm lamps in even columns and cool lamps in odd columns; all are far brighter than white, with blurred edges.
    let (warm, cool) = (Vec3::new(4.0, 2.4, 1.2), Vec3::new(1.6, 2.4, 4.0));
    let lamp = |x: f64, y: f64| {
        let (u, v) = ((x - 20.0).rem_euclid(40.0) - 20.0, (y - 20.0).rem_euclid(40.0) - 20.0);
        let inside = 1.0 / (1.0 + (u.hypot(v) - 9.0).exp());
        (if ((x - 20.0) / 40.0).floor() as i64 % 2 == 0 { warm } else { cool }) * inside as f32
    };
    let mut exemplar = Design::new(240, 240, |x, y| lamp(x, y).max_element() > 0.6);
    for i in 0..240 * 240 {
        let light = lamp((i % 240) as f64 + 0.5, (i / 240) as f64 + 0.5).min(Vec3::ONE);
        exemplar.unwarped.data[3 * i..3 * i + 3].copy_from_slice(&light.to_array());
    }
    let params = Params { width: 480, height: 480, ..Params::default() };
    let of = |clip_level: f32| exemplar.run(&Params { clip_level, ..params.clone() }).unwrap();
    let (found, ignored) = (of(0.95), of(0.0));
    for (lamp, before) in found.luminaires.iter().zip(&ignored.luminaires).filter(|(l, _)| l.area > 300.0) {
        let ratio = |c: Vec3| c.x / c.z;
        let truth = ratio(if lamp.colour.x > lamp.colour.z { warm } else { cool });
        assert!((ratio(lamp.colour) / truth - 1.0).abs() < 0.1, "{} for {truth}", lamp.colour);
        // Without the correction, the photo shows the lamps almost white.
        assert!(ratio(before.colour).ln().abs() < 0.6 * truth.ln().abs(), "{}", before.colour);
    }
}

#[test]
fn an_exemplar_is_measured_in_its_own_pixels() {
    let exemplar = Design::new(200, 180, grid(40.0, 36.0, 14.0, 10.0));
    let of = |exemplar: &Design| measure(&exemplar.input(), &Params::default(), Monitor::default().job()).unwrap();
    let measured = of(&exemplar);
    assert_eq!((measured.lamp_sides, measured.width), ([14.0, 10.0], 200.0));
    assert_eq!(measured.lamp_fill, 1.0);
    assert!((measured.spacing - 36.0).abs() < 0.1, "{}", measured.spacing);
    // Without a lattice, the spacing is the median distance between nearest neighbours. `blobs` keeps all distances
    // between centres above 26 pixels; measured centres are less exact.
    let scattered = of(&blobs(256, 256, 26.0).0).spacing;
    assert!(scattered > 24.0 && scattered < 32.0, "{scattered}");
    let alone = of(&Design::new(80, 60, |x, y| (x - 40.0).abs() < 10.0 && (y - 25.0).abs() < 8.0));
    assert_eq!((alone.lamp_sides, alone.spacing), ([20.0, 16.0], 0.0));
}

#[test]
fn what_was_measured_is_not_read_again_and_gives_the_same_bits() {
    let exemplar = Design::new(200, 180, grid(40.0, 36.0, 14.0, 10.0)).with_corners_cut();
    let params = Params { width: 300, height: 280, ..Params::default() };
    let job = Monitor::default();
    // Measure the exemplar with the settings of the texture, and with other settings. If the other settings would
    // change the analysis, the exemplar must be analysed again. The texture must be the same in all cases.
    for read_with in [Params::default(), params.clone(), Params { working_side: 64, ..Params::default() }] {
        let measured = measure(&exemplar.input(), &read_with, job.job()).unwrap();
        let result = blend_measured(measured, &exemplar.input(), &[], &params, job.job()).unwrap();
        let fresh = exemplar.run(&params).unwrap();
        assert_eq!((result.texture, result.luminaires), (fresh.texture, fresh.luminaires));
    }
}

#[test]
fn a_chandelier_is_repeated_as_it_hangs() {
    // Twelve bulbs on a ring and three in its middle, at unequal distances, on a bare ceiling.
    let bulbs: Vec<DVec2> = (0..12)
        .map(|i| (DVec2::from_angle(std::f64::consts::TAU * (f64::from(i) + 0.15 * f64::from(i % 3)) / 12.0), i))
        .map(|(direction, i)| DVec2::new(150.0, 130.0) + direction * (44.0 + 5.0 * f64::from(i % 2)))
        .chain([DVec2::new(141.0, 127.0), DVec2::new(158.0, 122.0), DVec2::new(152.0, 141.0)])
        .collect();
    let exemplar = Design::new(300, 280, |x, y| bulbs.iter().any(|b| b.distance(DVec2::new(x, y)) < 5.0));
    let result =
        exemplar.run(&Params { width: 600, height: 560, centring: Centring::Never, ..Params::default() }).unwrap();
    assert!(matches!(result.law, Law::Whole(_)), "{:?}", result.law);
    assert_eq!(result.luminaires.len(), 4 * bulbs.len(), "{:?}", result.law);
    assert!(result.error < 1e-6, "{}", result.error);
    for bulb in &bulbs {
        for turn in [DVec2::ZERO, DVec2::X * 300.0, DVec2::Y * 280.0, DVec2::new(300.0, 280.0)] {
            let nearest = result.luminaires.iter().map(|l| l.centre.distance(*bulb + turn)).fold(f64::MAX, f64::min);
            assert!(nearest < 1.0, "{bulb} {turn} {nearest}");
        }
    }
}

#[test]
fn textures_smaller_than_a_patch_show_what_fits() {
    let exemplar = Design::new(200, 200, grid(40.0, 40.0, 14.0, 14.0));
    for (width, height) in [(1, 1), (30, 9), (59, 41), (41, 59)] {
        for (block, scale) in [(0, 1.0), (150, 1.0), (150, 0.25)] {
            // With `Centring::Always`, the texture is not a copied part of the exemplar.
            let params = Params { width, height, block, scale, centring: Centring::Always, ..Params::default() };
            let result = exemplar.run(&params).unwrap();
            assert!(matches!(result.law, Law::Lattice(_)));
            let lamps = inner(&result.luminaires, width, height);
            let area = 196.0 / (scale * scale);
            assert!(lamps.iter().all(|l| (l.area / area - 1.0).abs() < 0.15), "{width} x {height} {lamps:?}");
            // If exactly one lamp fits, it must lie at the centre.
            let size = DVec2::new(width as f64, height as f64);
            let side = 14.0 / scale;
            if size.min_element() > side + 2.0 && size.max_element() < 40.0 / scale {
                assert_eq!(lamps.len(), 1, "{width} x {height}");
                assert!(lamps[0].centre.distance(size / 2.0) < 1.0, "{}", lamps[0].centre);
            }
        }
    }
}
