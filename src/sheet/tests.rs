mod bent;
mod paper;

use super::*;
use crate::error::ErrorKind;
use crate::job::Monitor;
use crate::rng::Rng;

/// A picture of 160 × 120 pixels: a shaded disc on a plain ground.
fn picture() -> Image {
    Image::from_fn(160, 120, |x, y| {
        let r = (x as f32 - 80.0).hypot(y as f32 - 60.0) / 45.0;
        let v = if r < 1.0 { 0.2 + 0.5 * (1.0 - r * r) } else { 0.7 };
        [v, 0.6 * v, 0.4 * v]
    })
    .unwrap()
}

fn params() -> Params {
    Params { dpi: 100.0, ..Params::default() }
}

/// Returns a simulated photo of a sheet, 1300 × 1000 pixels, and the true map from the sheet to the photo. The sheet
/// lies on a dark table, with its corners at `corners`. The light falls off to one side, and the photo has noise with a
/// standard deviation of 0.01.
fn photograph(sheet: &Image, corners: [[f64; 2]; 4]) -> (Image, Homography) {
    let (w, h) = (sheet.width as f64, sheet.height as f64);
    let page = [[0.0, 0.0], [w, 0.0], [w, h], [0.0, h]].map(DVec2::from);
    let to_photo = Homography::from_corners(page, corners.map(DVec2::from)).unwrap();
    let to_page = to_photo.inverse();
    let mut photo = rectify::warp(sheet, &to_page, 1300, 1000, Monitor::default().job()).unwrap();
    for (i, pixel) in photo.data.chunks_exact_mut(3).enumerate() {
        let (x, y) = (i % 1300, i / 1300);
        let at = to_page.apply(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let on_page = at.cmpgt(DVec2::ZERO).all() && at.cmplt(DVec2::new(w, h)).all();
        let light = 0.9 - 0.45 * x as f32 / 1300.0 - 0.1 * y as f32 / 1000.0;
        let mut rng = Rng::new(9, &[x as u64, y as u64]);
        for (c, v) in pixel.iter_mut().enumerate() {
            let tint = [1.0, 0.93, 0.82][c];
            *v = (if on_page { *v } else { 0.08 }) * light * tint + 0.035 * (rng.next_f32() - 0.5);
        }
    }
    (photo, to_photo)
}

/// Returns the maximum distance, in pixels of the picture, between true and estimated positions of points of the
/// picture.
fn misalignment(aligned: &Aligned, page: &Page, to_photo: Homography) -> f64 {
    let truth = to_photo.after(page.from_picture(160, 120));
    let corners = [[0.0, 0.0], [160.0, 0.0], [160.0, 120.0], [0.0, 120.0], [80.0, 60.0]].map(DVec2::from);
    let off = |c: DVec2| truth.apply(c).distance(aligned.map.apply(c)) / scale(&aligned.map, c);
    corners.into_iter().map(off).fold(0.0, f64::max)
}

const CORNERS: [[f64; 2]; 4] = [[130.0, 95.0], [1195.0, 165.0], [1120.0, 905.0], [85.0, 800.0]];

#[test]
fn a_photo_of_the_sheet_is_aligned_whichever_way_up() {
    let (picture, params) = (picture(), params());
    let sheet = print(&picture, &params, Monitor::default().job()).unwrap();
    let page = Page::new(&params, 160, 120).unwrap();
    for turn in 0..4 {
        let corners = std::array::from_fn(|i| CORNERS[(i + turn) % 4]);
        let (photo, to_photo) = photograph(&sheet, corners);
        let aligned = align(&photo, 160, 120, &params, Monitor::default().job()).unwrap();
        assert_eq!(aligned.marks, 10);
        let off = misalignment(&aligned, &page, to_photo);
        assert!(off < 0.05 && aligned.residual < 0.3, "turned {turn}: {off} {}", aligned.residual);
        // After removal of uneven illumination, all corners of the picture have their printed values.
        let white = |x: usize, y: usize| aligned.image.rgb(x, y) - print_of(&picture, x, y, &params);
        for (x, y) in [(4, 4), (155, 4), (155, 115), (4, 115)] {
            assert!(white(x, y).abs().max_element() < 0.06, "{}", white(x, y));
        }
    }
}

/// Returns the printed value of a pixel of the picture.
fn print_of(picture: &Image, x: usize, y: usize, params: &Params) -> Vec3 {
    let faded = |v: f32| srgb_to_linear(1.0 - params.contrast * (1.0 - linear_to_srgb(v)));
    Vec3::from_array(picture.rgb(x, y).to_array().map(faded))
}

#[test]
fn any_one_mark_may_be_missing() {
    let params = params();
    let sheet = print(&picture(), &params, Monitor::default().job()).unwrap();
    let page = Page::new(&params, 160, 120).unwrap();
    for missing in 0..10 {
        let mut painted = sheet.clone();
        let centre = page.marks[missing];
        for y in 0..painted.height {
            for x in 0..painted.width {
                if centre.distance(DVec2::new(x as f64, y as f64)) < 1.3 * page.radius {
                    painted.pixel_mut(x, y).copy_from_slice(&[0.5, 0.2, 0.1]);
                }
            }
        }
        let (photo, to_photo) = photograph(&painted, CORNERS);
        let aligned = align(&photo, 160, 120, &params, Monitor::default().job()).unwrap();
        assert_eq!(aligned.marks, 9, "without mark {missing}");
        assert!(misalignment(&aligned, &page, to_photo) < 0.06, "without mark {missing}");
    }
}

#[test]
fn the_stated_error_is_about_the_true_one_and_a_scan_is_exact() {
    let params = Params { even_light: false, ..params() };
    let sheet = print(&picture(), &params, Monitor::default().job()).unwrap();
    let page = Page::new(&params, 160, 120).unwrap();
    let scan = align(&sheet, 160, 120, &params, Monitor::default().job()).unwrap();
    let identity = Homography(glam::DMat3::IDENTITY);
    let off = misalignment(&scan, &page, identity);
    assert!(off < 0.01, "{off} {}", scan.residual);
    let (photo, to_photo) = photograph(&sheet, CORNERS);
    let aligned = align(&photo, 160, 120, &params, Monitor::default().job()).unwrap();
    let off = misalignment(&aligned, &page, to_photo);
    assert!(off < 5.0 * aligned.error && aligned.error < 0.1, "{off} {}", aligned.error);
}

#[test]
fn photos_without_a_sheet_are_an_error() {
    let job = Monitor::default();
    let noise = Image::from_fn(300, 200, |x, y| [Rng::new(3, &[x as u64, y as u64]).next_f32(); 3]).unwrap();
    for photo in [noise, Image::new(300, 200, 3).unwrap(), Image::new(1, 1, 3).unwrap()] {
        let error = align(&photo, 160, 120, &params(), job.job()).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.message.contains("marks"), "{error}");
    }
    for bad in [
        Params { dpi: 0.0, ..params() },
        Params { dpi: f64::NAN, ..params() },
        Params { paper: DVec2::new(60.0, 60.0), margin: 25.0, ..params() },
        Params { paper: DVec2::new(2000.0, 2000.0), dpi: 1200.0, ..params() },
        Params { contrast: 2.0, ..params() },
    ] {
        assert_eq!(print(&picture(), &bad, job.job()).unwrap_err().kind, ErrorKind::InvalidArgument, "{bad:?}");
    }
}
