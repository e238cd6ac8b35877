//! Photos by lenses with distortion: of printed sheets, and of drawings with straight edges.

use crate::harness::{figure, median, quantile};
use glam::{DMat2, DVec2};
use luxfer::geometry::Homography;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::rectify;
use luxfer::rng::Rng;
use luxfer::sheet::{Params, align, print};

/// Size of a photo, and of the printed picture, in pixels.
const PHOTO: [usize; 2] = [900, 700];
const PICTURE: [usize; 2] = [160, 120];
/// Distortions of the lenses: displacement in the corners of the photo, as a share of their distance from the centre.
const LENSES: [f64; 4] = [0.0, 0.02, -0.04, -0.08];
/// Number of photos per lens.
const PHOTOS: u64 = 4;
/// A sheet counts as aligned up to this error in pixels of the picture.
const ALIGNED: f64 = 3.0;

/// The place that an ideal lens shows where a lens with distortion shows `p`.
fn undistorted(p: DVec2, distortion: f64) -> DVec2 {
    let half = DVec2::new(PHOTO[0] as f64, PHOTO[1] as f64) / 2.0;
    let q = p - half;
    half + q * (1.0 - distortion * q.length_squared() / half.length_squared())
}

/// The place where a lens with distortion shows what an ideal lens shows at `p`.
fn distorted(p: DVec2, distortion: f64) -> DVec2 {
    let mut shown = p;
    for _ in 0..20 {
        shown += p - undistorted(shown, distortion);
    }
    shown
}

/// Prints the share of the photos of sheets that are aligned, and the error of these in pixels of the picture.
pub fn sheet() {
    let job = Monitor::default();
    let params = Params { dpi: 80.0, ..Params::default() };
    let picture = Image::from_fn(PICTURE[0], PICTURE[1], |x, y| {
        let v = 0.2 + 0.5 * f32::from(u8::from((x / 20 + y / 30) % 3 == 0));
        [v, 0.6 * v, 0.4 * v]
    });
    let printed = print(&picture.expect("a picture"), &params, job.job()).expect("a sheet");
    // Find the place of the picture on the sheet by the sheet itself.
    let on_sheet = align(&printed, PICTURE[0], PICTURE[1], &params, job.job()).expect("a sheet").map;
    let (mut errors, mut aligned, mut count) = (Vec::new(), 0, 0);
    for distortion in LENSES {
        for seed in 0..PHOTOS {
            let (photo, to_photo) = photograph(&printed, distortion, seed);
            count += 1;
            let Ok(found) = align(&photo, PICTURE[0], PICTURE[1], &params, job.job()) else { continue };
            let corners = [[0.0, 0.0], [160.0, 0.0], [160.0, 120.0], [0.0, 120.0], [80.0, 60.0]].map(DVec2::from);
            let off = |p: DVec2| {
                let seen = distorted(to_photo.apply(on_sheet.apply(p)), distortion);
                let [x, y] =
                    [DVec2::X, DVec2::Y].map(|step| found.map.apply(p + 0.5 * step) - found.map.apply(p - 0.5 * step));
                (DMat2::from_cols(x, y).inverse() * (seen - found.map.apply(p))).length()
            };
            let worst = corners.into_iter().map(off).fold(0.0, f64::max);
            if worst < ALIGNED {
                aligned += 1;
                errors.push(worst);
            }
        }
    }
    figure("constants.sheet.aligned", 100.0 * f64::from(aligned) / f64::from(count), "%");
    figure("constants.sheet.error", median(&errors), "pixels");
}

/// A photo of a sheet on a dark table, beside a chequered cloth, and the map from the sheet to the undistorted photo.
fn photograph(printed: &Image, distortion: f64, seed: u64) -> (Image, Homography) {
    let (w, h) = (printed.width as f64, printed.height as f64);
    let page = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(DVec2::from);
    let mut rng = Rng::new(41, &[seed]);
    // The sheet is upright if it is taller than wide, so it lies on its side in a wide photo.
    let seen = [[110.0, 60.0], [800.0, 60.0], [800.0, 640.0], [110.0, 640.0]].map(DVec2::from);
    let jittered = seen.map(|p| p + 50.0 * DVec2::new(rng.next_f64() - 0.5, rng.next_f64() - 0.5));
    let turn = usize::from(h > w);
    let corners = std::array::from_fn(|i| jittered[(i + turn) % 4]);
    let to_photo = Homography::from_corners(page, corners).expect("a map");
    let to_page = to_photo.inverse();
    let photo = Image::from_fn(PHOTO[0], PHOTO[1], |x, y| {
        const SAMPLES: usize = 2;
        let mut sum = 0.0;
        for i in 0..SAMPLES * SAMPLES {
            let step = DVec2::new((i % SAMPLES) as f64 + 0.5, (i / SAMPLES) as f64 + 0.5) / SAMPLES as f64;
            let p = undistorted(DVec2::new(x as f64, y as f64) + step, distortion);
            let at = to_page.apply(p);
            let is_on_page = at.cmpge(DVec2::ZERO).all() && at.x < w && at.y < h;
            let is_light = (p.x / 24.0).floor() as i64 % 2 == (p.y / 24.0).floor() as i64 % 2;
            sum += match is_on_page {
                true => printed.rgb(at.x as usize, at.y as usize).y,
                false if p.x < 70.0 && p.y < 70.0 && is_light => 0.6,
                false => 0.08,
            };
        }
        let noise = 0.01 * Rng::new(43, &[seed, x as u64, y as u64]).normal() as f32;
        let light = 0.9 - 0.4 * x as f32 / PHOTO[0] as f32;
        [sum / (SAMPLES * SAMPLES) as f32 * light + noise; 3]
    });
    (photo.expect("a photo"), to_photo)
}

/// Prints the error of the distortion that is measured in drawings of turned rectangles, and the error relative to the
/// stated one. Half of the drawings also show arcs, which are curved by themselves.
pub fn lens() {
    let (mut errors, mut ratios, mut count) = (Vec::new(), Vec::new(), 0);
    for distortion in LENSES {
        for seed in 0..PHOTOS {
            let photo = drawing(distortion, seed, seed % 2 == 1);
            count += 1;
            let view = rectify::find_view(&photo, &rectify::Params::default(), Monitor::default().job());
            let Some(found) = view.ok().and_then(|view| view.distortion) else { continue };
            errors.push(100.0 * (found.corner - distortion).abs());
            ratios.push((found.corner - distortion).abs() / found.error);
        }
    }
    figure("constants.lens.found", 100.0 * errors.len() as f64 / f64::from(count), "%");
    figure("constants.lens.error", errors.iter().sum::<f64>() / errors.len().max(1) as f64, "% of the corner");
    figure("constants.lens.error_90", quantile(&errors, 0.9), "% of the corner");
    figure("constants.lens.of_stated", quantile(&ratios, 0.9), "of the stated error");
}

fn drawing(distortion: f64, seed: u64, has_arcs: bool) -> Image {
    let mut rng = Rng::new(47, &[seed]);
    let axis = DVec2::from_angle(0.3 * (rng.next_f64() - 0.5));
    let tilt = 0.0006 * (rng.next_f64() - 0.5);
    let photo = Image::from_fn(PHOTO[0], PHOTO[1], |x, y| {
        const SAMPLES: usize = 2;
        let lit = (0..SAMPLES * SAMPLES).filter(|i| {
            let step = DVec2::new((i % SAMPLES) as f64 + 0.5, (i / SAMPLES) as f64 + 0.5) / SAMPLES as f64;
            let p = undistorted(DVec2::new(x as f64, y as f64) + step, distortion);
            let q = axis.rotate(p) / (1.0 + tilt * p.x);
            let is_tile = q.x.rem_euclid(180.0) < 120.0 && q.y.rem_euclid(150.0) < 90.0;
            let is_disc = has_arcs && (p - DVec2::new(450.0, 350.0)).length().rem_euclid(160.0) < 70.0;
            is_tile != is_disc
        });
        let noise = 0.01 * Rng::new(53, &[seed, x as u64, y as u64]).normal() as f32;
        [0.15 + 0.5 * lit.count() as f32 / (SAMPLES * SAMPLES) as f32 + noise; 3]
    });
    photo.expect("a drawing")
}
