//! Rooms seen through lenses with radial distortion.

use super::*;
use crate::geometry::Radial;
use crate::image::Image;

const BENDS: [f64; 4] = [-0.3, -0.06, 0.02, 0.1];

/// A camera whose lens moves the corners of the photo by the share `corner`.
fn bent(corner: f64) -> Perspective {
    let ideal = camera(0.5, -0.35, 0.05, 600.0);
    let size = DVec2::new(SIZE.0 as f64, SIZE.1 as f64);
    Perspective { bend: Radial::new(corner, ideal.principal, size).unwrap().bend, ..ideal }
}

/// The segments of a room as the lens shows them: only their end points, since the lens bends the lines between them.
fn shown_room(camera: &Perspective, noise: f64, seed: u64) -> Vec<Segment> {
    let lens = camera.lens();
    let shown = |s: &Segment| Segment { a: lens.shown(s.a), b: lens.shown(s.b) };
    room(camera, [40, 40, 40], noise, seed).iter().map(shown).collect()
}

fn with_distortion(distortion: f64) -> Params {
    Params { distortion: Some(distortion), ..Params::default() }
}

/// Coordinates on the ceiling, along the horizontal axes, of the point that a pixel shows; the unit of length is the
/// distance between ceiling and camera. `None` if the pixel shows no ceiling.
fn on_ceiling(camera: &Perspective, pixel: DVec2) -> Option<DVec2> {
    Some(on_plane(camera, pixel)).filter(|q| q.length() < 4.0)
}

/// Like [`on_ceiling`], but on the unbounded plane of the ceiling. If the pixel does not show this plane, the result is
/// NaN, infinite or huge.
fn on_plane(camera: &Perspective, pixel: DVec2) -> DVec2 {
    let ray = camera.axes.transpose() * camera.ray(pixel);
    DVec2::new(ray.x, ray.z) / (-ray.y).max(0.0)
}

/// The photo of a ceiling with dark lines at every 0.2 units along both axes, above walls with upright lines, and the
/// mask of the ceiling. Each pixel is the mean of 16 samples.
fn ceiling(camera: &Perspective) -> (Image, Image) {
    let centre = |x: usize, y: usize| DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
    let is_line = |v: f64| (v - v.round()).abs() < 0.1;
    let sample = |p: DVec2| match on_ceiling(camera, p) {
        Some(q) if is_line(q.x / 0.2) || is_line(q.y / 0.2) => 0.1f32,
        Some(_) => 0.7,
        None => {
            let ray = camera.axes.transpose() * camera.ray(p);
            if is_line(3.0 * ray.x / ray.z) { 0.1 } else { 0.5 }
        }
    };
    let mean = |x: usize, y: usize| {
        let at = |k: usize| DVec2::new((k % 4) as f64 - 1.5, (k / 4) as f64 - 1.5) / 4.0;
        (0..16).map(|k| sample(centre(x, y) + at(k))).sum::<f32>() / 16.0
    };
    let photo = Image::from_fn(SIZE.0, SIZE.1, |x, y| [mean(x, y); 3]).unwrap();
    let mask = Image::from_fn(SIZE.0, SIZE.1, |x, y| [f32::from(on_ceiling(camera, centre(x, y)).is_some())]).unwrap();
    (photo, mask)
}

#[test]
fn ends_of_segments_on_a_lens_give_exact_vanishing_points() {
    for corner in BENDS {
        let truth = bent(corner);
        let segments = shown_room(&truth, 0.0, 7);
        let view = view_of(&segments, &with_distortion(corner)).unwrap();
        assert!((view.undone - corner).abs() < 1e-12 && view.perspective.bend == truth.bend);
        for axis in 0..3 {
            let error = angle(direction_of(&truth, view.vanishing_points[axis].point), truth.axes.col(axis));
            assert!(error < 1e-6, "{corner}: {error}");
        }
        assert!((view.perspective.focal / truth.focal - 1.0).abs() < 1e-3, "{}", view.perspective.focal);
        // Segments stay where the caller found them.
        assert!(view.segments.iter().zip(&segments).all(|(a, b)| a.0 == *b));
    }
    // Cross-check: without the correction, the directions are wrong.
    let truth = bent(-0.06);
    let view = view_of(&shown_room(&truth, 0.0, 7), &with_distortion(0.0)).unwrap();
    let error = |axis: usize| angle(direction_of(&truth, view.vanishing_points[axis].point), truth.axes.col(axis));
    assert!((0..3).map(error).fold(0.0, f64::max) > 5e-3 && view.undone == 0.0);
}

/// How crooked the dark lines along the columns of an image are. Measures the root mean square distance, in pixels, of
/// each line from the straight line that fits it best, and returns the largest one.
fn crookedness(flat: &Unwarped) -> f64 {
    let (width, height) = (flat.image.width, flat.image.height);
    let value = |x: usize, y: usize| f64::from(flat.image.pixel(x, y)[0]);
    let is_valid = |x: usize, y: usize| flat.valid.pixel(x, y)[0] > 0.5;
    let mut worst = 0.0f64;
    let period = 0.2 / flat.pixel_size;
    let first = (0..width).find(|&x| value(x, height / 2) > 0.6).unwrap() as f64;
    let mut left = first;
    while left + period < width as f64 {
        // The centroid of the darkness between the middles of two bright bands, row by row.
        let (from, to) = (left as usize, (left + period) as usize);
        let mut centres = Vec::new();
        for y in 0..height {
            let dark = |x: usize| (0.6 - value(x, y)).max(0.0);
            let sum: f64 = (from..to).map(dark).sum();
            let is_line = (from..to).all(|x| is_valid(x, y)) && value(from, y) > 0.6 && value(to - 1, y) > 0.6;
            if is_line && sum > 0.0 {
                let centre = (from..to).map(|x| (x as f64 + 0.5) * dark(x)).sum::<f64>() / sum;
                centres.push(DVec2::new(y as f64, centre));
            }
        }
        if centres.len() > height / 4 {
            let mean = centres.iter().sum::<DVec2>() / centres.len() as f64;
            let sums = centres.iter().map(|c| c - mean).fold((0.0, 0.0), |s, c| (s.0 + c.x * c.x, s.1 + c.x * c.y));
            let square = |c: &DVec2| (c.y - mean.y - sums.1 / sums.0 * (c.x - mean.x)).powi(2);
            worst = worst.max((centres.iter().map(square).sum::<f64>() / centres.len() as f64).sqrt());
        }
        left += period;
    }
    worst
}

#[test]
fn a_grid_on_the_ceiling_comes_back_straight() {
    for corner in BENDS {
        let truth = bent(corner);
        let (photo, mask) = ceiling(&truth);
        let unwarped = |distortion: f64| {
            let params = Params { focal: Some(600.0), ..with_distortion(distortion) };
            let view = view_of(&shown_room(&truth, 0.0, 7), &params).unwrap();
            let params = UnwarpParams { axes: Some([0, 2]), max_side: 600, ..UnwarpParams::default() };
            unwarp(&photo, &view, &mask, &params, Monitor::default().job()).unwrap()
        };
        let flat = unwarped(corner);
        // The map is exact: pixels of the unwarped image, on the ceiling, form a square grid.
        let at = |x: f64, y: f64| on_plane(&truth, flat.to_photo.apply(DVec2::new(x, y)));
        let (w, h) = (flat.image.width as f64, flat.image.height as f64);
        let [origin, right, down] = [at(0.3 * w, 0.5 * h), at(0.7 * w, 0.5 * h), at(0.3 * w, 0.8 * h)];
        let (right, down) = ((right - origin) / (0.4 * w), (down - origin) / (0.3 * h));
        assert!(
            (right.length() / flat.pixel_size - 1.0).abs() < 1e-3
                && right.dot(down).abs() < 1e-3 * down.length_squared()
        );
        let expected = origin + right * (0.3 * w) + down * (0.1 * h);
        let off = at(0.6 * w, 0.6 * h).distance(expected) / flat.pixel_size;
        assert!(off < 0.01, "{corner}: {off} pixels");
        // The corners are pixels of the photo.
        let corner_pixel = flat.to_photo.apply(DVec2::new(w, h));
        assert_eq!(flat.corners[2], corner_pixel);
        // The dark lines must be straight in the unwarped image as well.
        let (straight, crooked) = (crookedness(&flat), crookedness(&unwarped(0.0)));
        println!("{corner}: {straight:.3} px, not undone {crooked:.3} px");
        assert!(straight < 0.3, "{corner}: {straight}");
        assert!(corner.abs() < 0.05 || crooked > 2.0 * straight, "{corner}: {crooked}");
    }
}

#[test]
fn a_significant_distortion_is_undone_and_another_changes_no_bit() {
    let job = Monitor::default();
    let view = |photo: &Image, params: &Params| find_view(photo, params, job.job()).unwrap();
    let (photo, mask) = ceiling(&bent(-0.08));
    let (by_default, off) = (view(&photo, &Params::default()), view(&photo, &with_distortion(0.0)));
    let measured = by_default.distortion.unwrap();
    assert!((by_default.undone + 0.08).abs() < 0.02, "{measured:?}");
    assert!(
        (by_default.undone - measured.corner).abs() < 1e-12 && off.undone == 0.0 && off.distortion == Some(measured)
    );
    assert!(!by_default.warnings().iter().any(|w| w.code == crate::warning::Code::LensDistortion));
    assert!(off.warnings().iter().any(|w| w.code == crate::warning::Code::LensDistortion));
    let flat = |view: &View| {
        let params = UnwarpParams { axes: Some([0, 2]), max_side: 600, ..UnwarpParams::default() };
        unwarp(&photo, view, &mask, &params, job.job()).unwrap()
    };
    assert!(crookedness(&flat(&off)) > 2.0 * crookedness(&flat(&by_default)));

    let (photo, mask) = ceiling(&bent(0.0));
    let (by_default, off) = (view(&photo, &Params::default()), view(&photo, &with_distortion(0.0)));
    assert_eq!(format!("{by_default:?}"), format!("{off:?}"));
    let params = UnwarpParams { axes: Some([0, 2]), max_side: 600, ..UnwarpParams::default() };
    let [a, b] = [&by_default, &off].map(|view| unwarp(&photo, view, &mask, &params, job.job()).unwrap());
    assert!(a.image.data == b.image.data && a.to_photo.lens.is_none());
}

#[test]
fn an_undistorted_photo_is_that_of_an_ideal_lens() {
    let job = Monitor::default();
    for corner in BENDS {
        let truth = bent(corner);
        let (photo, _) = ceiling(&truth);
        let (ideal, _) = ceiling(&Perspective { bend: 0.0, ..truth });
        let made = undistort(&photo, &truth.lens(), job.job()).unwrap();
        let seen = |x: usize, y: usize| {
            let p = truth.lens().shown(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            p.cmpge(DVec2::splat(3.0)).all() && p.x < SIZE.0 as f64 - 3.0 && p.y < SIZE.1 as f64 - 3.0
        };
        let pixels = (0..SIZE.0 * SIZE.1).map(|i| [i % SIZE.0, i / SIZE.0]).filter(|&[x, y]| seen(x, y));
        let errors: Vec<f64> = pixels.map(|[x, y]| f64::from(made.pixel(x, y)[0] - ideal.pixel(x, y)[0])).collect();
        let rms = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
        let unchanged = photo.data.iter().zip(&ideal.data).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>();
        let unchanged = (unchanged / photo.data.len() as f64).sqrt();
        println!("{corner}: rms {rms:.4}, before {unchanged:.4}");
        assert!(rms < 0.03 && (unchanged > 4.0 * rms || corner.abs() < 0.05), "{corner}: {rms} {unchanged}");
        assert_eq!(undistort(&photo, &Radial::NONE, job.job()).unwrap(), photo);
    }
    let dot = Image::from_fn(1, 1, |_, _| [0.5]).unwrap();
    let lens = Radial::new(-0.3, DVec2::splat(0.5), DVec2::ONE).unwrap();
    assert!((undistort(&dot, &lens, job.job()).unwrap().data[0] - 0.5).abs() < 1e-6);
}

#[test]
fn distortions_out_of_range_are_errors_and_tiny_photos_have_no_lines() {
    let job = Monitor::default();
    let (photo, _) = ceiling(&bent(0.0));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e9, -1e9, 0.21] {
        let e = find_view(&photo, &with_distortion(bad), job.job()).unwrap_err();
        assert_eq!(e.kind, ErrorKind::InvalidArgument);
        assert!(e.message.contains(&format!("distortion is {bad}; it must lie in [-1, 0.2]")), "{}", e.message);
    }
    let far = Params { principal: Some(DVec2::new(-1e4, 0.0)), ..with_distortion(-0.1) };
    let e = find_view(&photo, &far, job.job()).unwrap_err();
    assert!(e.message.contains("about the principal point"), "{}", e.message);
    for size in [1, 2, 5] {
        let tiny = Image::from_fn(size, size, |_, _| [0.5; 3]).unwrap();
        let e = find_view(&tiny, &with_distortion(-0.05), job.job()).unwrap_err();
        assert_eq!(e.kind, ErrorKind::Degenerate, "{}", e.message);
    }
}
