//! Photos of bent and crumpled sheets, and photos by lenses that distort: the error of the alignment against the stated
//! one.

use crate::harness::{figure, median, quantile};
use crate::paper::{Defects, NONE, Numbers, Profile, View};
use glam::DVec2;
use luxfer::image::{Image, pyramid};
use luxfer::job::Monitor;
use luxfer::rectify::{GridMap, warp_grid};
use luxfer::sheet::{Aligned, Params, align, print};
use std::f64::consts::FRAC_PI_2;

/// Size of a photo, and of the printed picture, in pixels.
const PHOTO: DVec2 = DVec2::new(1300.0, 1000.0);
const PICTURE: [usize; 2] = [160, 120];
/// Number of photos of each kind, and their greatest tilt in degrees. Their seeds are 0 and up; the constants of the
/// sheets were chosen by photos with the seeds from `CHOSEN_BY` on.
const PHOTOS: u64 = 12;
const CHOSEN_BY: u64 = 1000;
const TILT: f64 = 45.0;
/// Standard deviations of the blur, in pixels, and of the noise.
const BLUR: f32 = 0.7;
const NOISE: f32 = 0.01;
/// Factor of the stated error that the true one exceeds in one of twenty photos.
const CONFIDENCE: f64 = 1.96;

fn kinds() -> [(&'static str, Defects); 14] {
    let arc = |bow: f64, angle: f64| Defects { bow, angle, ..NONE };
    let barrel = |third: f64, paper: Defects| Defects { barrel: [third, 0.0], ..paper };
    let relief = |height: f64, length: f64| Defects { relief: [height, length], ..NONE };
    [
        ("flat", NONE),
        ("arc_0.5", arc(0.005, 0.0)),
        ("arc_1", arc(0.01, 0.0)),
        ("arc_1_other_axis", arc(0.01, FRAC_PI_2)),
        ("arc_2_oblique", arc(0.02, 0.4)),
        ("curl_2", Defects { profile: Profile::Curl, ..arc(0.02, 0.0) }),
        ("wave_1", Defects { profile: Profile::Wave, ..arc(0.01, FRAC_PI_2) }),
        ("barrel_1", barrel(0.01, NONE)),
        ("barrel_2", barrel(0.02, NONE)),
        ("barrel_4", barrel(0.04, NONE)),
        ("arc_1_barrel_2", barrel(0.02, arc(0.01, 0.0))),
        ("crumpled_0.1", relief(0.001, 0.3)),
        ("crumpled_0.3", relief(0.003, 0.2)),
        ("crumpled_1", relief(0.01, 0.3)),
    ]
}

/// Prints for each kind of photo the median of the true error, of the stated error and of the error of a homography, in
/// pixels of the picture, and the share of the photos whose true error is covered by the stated one.
pub fn bent() {
    let params = Params { dpi: 100.0, ..Params::default() };
    let picture = Image::from_fn(PICTURE[0], PICTURE[1], |x, y| {
        let v = 0.2 + 0.5 * f32::from(u8::from((x / 20 + y / 30) % 3 == 0));
        [v, 0.6 * v, 0.4 * v]
    });
    let job = Monitor::default();
    let sheet = print(&picture.expect("a picture"), &params, job.job()).expect("a sheet");
    // Find the place of the picture on the sheet by the sheet itself.
    let on_sheet = align(&sheet, PICTURE[0], PICTURE[1], &params, job.job()).expect("a sheet").map;
    let (mut all, mut all_covered) = (0, 0);
    for (name, defects) in kinds() {
        let (mut errors, mut stated, mut ratios, mut bends) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for seed in seeds() {
            let (photo, view) = photograph(&sheet, defects, seed);
            let Ok(found) = align(&photo, PICTURE[0], PICTURE[1], &params, job.job()) else { continue };
            let error = error(&found, &on_sheet, &view);
            errors.push(error);
            stated.push(found.error);
            ratios.push(error / found.error);
            bends.push(found.bend);
        }
        let share = |count: usize| 100.0 * count as f64 / PHOTOS as f64;
        let print = |what: &str, value: f64, unit: &str| figure(&format!("constants.bent.{name}.{what}"), value, unit);
        print("aligned", share(errors.len()), "%");
        print("homography", median(&bends), "pixels");
        print("error", median(&errors), "pixels");
        print("error_90", quantile(&errors, 0.9), "pixels");
        print("stated", median(&stated), "pixels");
        let covered = ratios.iter().filter(|ratio| **ratio < CONFIDENCE).count();
        print("covered", share(covered), "%");
        (all, all_covered) = (all + ratios.len(), all_covered + covered);
    }
    figure("constants.bent.covered", 100.0 * all_covered as f64 / all as f64, "%");
}

/// Returns the seeds of the printed photos. With the argument `--calibrate`, returns the seeds of other photos, by
/// which the constants were chosen.
fn seeds() -> std::ops::Range<u64> {
    let first = if std::env::args().any(|a| a == "--calibrate") { CHOSEN_BY } else { 0 };
    first..first + PHOTOS
}

fn photograph(sheet: &Image, defects: Defects, seed: u64) -> (Image, View) {
    let view = View::new(DVec2::new(sheet.width as f64, sheet.height as f64), PHOTO, defects, TILT, seed);
    let job = Monitor::default();
    let map = GridMap::sample(PHOTO.x as usize, PHOTO.y as usize, |p| view.page(p)).expect("a map");
    let sharp = warp_grid(sheet, &map, job.job()).expect("a photo");
    let mut photo = pyramid::blur(&sharp, BLUR, job.job()).expect("a photo");
    let mut numbers = Numbers(seed);
    for (i, pixel) in photo.data.chunks_exact_mut(3).enumerate() {
        let light = 0.9 - 0.45 * (i % PHOTO.x as usize) as f32 / PHOTO.x as f32;
        pixel.iter_mut().for_each(|v| *v = v.max(0.03) * light + NOISE * numbers.noise() as f32);
    }
    (photo, view)
}

/// The root mean square distance, over the picture and in pixels of it, between true and found positions.
fn error(found: &Aligned, on_sheet: &GridMap, view: &View) -> f64 {
    let size = DVec2::new(PICTURE[0] as f64, PICTURE[1] as f64);
    let per_pixel = (on_sheet.apply(DVec2::X) - on_sheet.apply(DVec2::ZERO)).length();
    const PLACES: u32 = 9;
    let squares = (0..PLACES * PLACES).map(|i| {
        let share = DVec2::new(f64::from(i % PLACES), f64::from(i / PLACES)) / f64::from(PLACES - 1);
        let on_page = on_sheet.apply(share * size);
        let off = found.map.apply(share * size) - view.photo(on_page);
        (view.derivative(on_page).inverse() * off / per_pixel).length_squared()
    });
    (squares.sum::<f64>() / f64::from(PLACES * PLACES)).sqrt()
}
