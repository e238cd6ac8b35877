//! Tests rectification on real data: photos with known cameras, and labelled segments of the data sets York Urban and
//! NYU.
//!
//! Data are read from `LUXFER_TEST_DATA` (default `../shared/data`). Without data the tests are skipped; in CI they
//! fail.

use crate::truth::{area, data, errors, given_set, labelled_photos, numbers, read_json};
use glam::{DMat3, DVec2, DVec3};
use luxfer::image::Image;
use luxfer::image::io::{self, Encoding};
use luxfer::job::Monitor;
use luxfer::rectify::{self, Params, UnwarpParams};
use std::path::PathBuf;
use std::time::Instant;

#[test]
fn vanishing_points_of_photos_meet_their_truth() {
    let monitor = Monitor::default();
    let (mut all, mut shares) = (Vec::new(), Vec::new());
    println!("{:22} {:>5} {:>6} {:>7}  errors in degrees", "photo", "lines", "ms", "focal");
    for l in labelled_photos() {
        let start = Instant::now();
        let view = match rectify::find_view(&l.photo, &Params::default(), monitor.job()) {
            Ok(view) => view,
            Err(e) => panic!("{}: {e}", l.name),
        };
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let points: Vec<DVec3> = view.vanishing_points.iter().filter(|v| v.support > 0).map(|v| v.point).collect();
        let e = errors(&l.directions, &points, l.intrinsics);
        println!(
            "{:22} {:5} {:6.0} {:5.2}x  {}   stated {}",
            l.name,
            view.segments.len(),
            ms,
            view.perspective.focal / l.intrinsics.x_axis.x,
            e.iter().map(|e| format!("{e:6.2}")).collect::<String>(),
            view.vanishing_points
                .iter()
                .map(|v| format!("{:6.2}/{}", v.error.to_degrees(), v.support))
                .collect::<String>(),
        );
        // Two directions are clearly visible in every one of these photos.
        let mut sorted = e.clone();
        sorted.sort_by(f64::total_cmp);
        assert!(sorted[1] < 5.0, "{}: {sorted:?}", l.name);
        for (direction, e) in l.directions.iter().zip(&e) {
            let nearest = |v: &rectify::VanishingPoint| errors(&[*direction], &[v.point], l.intrinsics)[0];
            let stated =
                view.vanishing_points.iter().filter(|v| v.support > 0).min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
            shares.push(e / stated.map_or(f64::NAN, |v| v.error.to_degrees()));
        }
        all.extend(e);
    }
    if all.is_empty() {
        return;
    }
    all.sort_by(f64::total_cmp);
    let median = all[all.len() / 2];
    let failures = all.iter().filter(|&&e| e > 5.0).count();
    println!("median {median:.2} degrees, {failures} of {} beyond 5", all.len());
    assert!(median <= 0.5 && failures == 0, "{median}, {failures}");
    // Check that the stated errors are calibrated. If errors are normally distributed in the image plane, half of them
    // lie below 0.7 to 0.8 stated errors, and 95 % below 2.
    shares.sort_by(f64::total_cmp);
    let at = |p: f64| shares[(p * shares.len() as f64) as usize];
    println!("error / stated: half below {:.2}, 68 % below {:.2}, 90 % below {:.2}", at(0.5), at(0.68), at(0.9));
    assert!((0.4..1.1).contains(&at(0.5)) && at(0.9) < 2.5);
}

/// Views cut out of panoramas have no distortion, so their estimates stay near 0, relative to the stated error. York
/// Urban's camera has barrel distortion, which must be found.
#[test]
fn distortion_is_reported_for_lenses_that_have_some() {
    let measured = |name: &str, photo: &Image| {
        let view = rectify::find_view(photo, &Params::default(), Monitor::default().job()).unwrap();
        let share = view.distortion.map(|found| found.corner / found.error);
        println!("{name:22} {:?}", view.distortion);
        share
    };
    let shares: Vec<f64> = labelled_photos().iter().filter_map(|l| measured(&l.name, &l.photo)).map(f64::abs).collect();
    let Some(folder) = data("photos") else { return };
    check_calibration("distortion", shares);

    let york = ["008", "009", "034", "037", "047", "049", "059", "076"].map(|number| {
        let name = format!("yud_{number}");
        let photo = io::load(&folder.join(format!("{name}.jpg")), Encoding::Srgb).unwrap().to_rgb().unwrap();
        measured(&name, &photo).unwrap_or(0.0)
    });
    let barrels = york.iter().filter(|share| **share < -2.0).count();
    assert!(barrels >= 4 && york.iter().all(|share| *share < 1.0), "{york:.1?}");
}

/// Focal length of York Urban's camera in pixels, by its calibration.
const YORK_FOCAL: f64 = 674.858;

/// Undoing the barrel distortion of York Urban's camera brings the focal lengths closer to its calibration.
#[test]
fn an_undone_distortion_improves_the_focal_length() {
    let Some(folder) = data("photos") else { return };
    let mut sums = [0.0; 3];
    for number in ["008", "009", "034", "037", "047", "049", "059", "076"] {
        let photo = io::load(&folder.join(format!("yud_{number}.jpg")), Encoding::Srgb).unwrap().to_rgb().unwrap();
        for (sum, distortion) in sums.iter_mut().zip([Some(0.0), None, Some(-0.03)]) {
            let params = Params { distortion, ..Params::default() };
            let view = rectify::find_view(&photo, &params, Monitor::default().job()).unwrap();
            let error = (view.perspective.focal / YORK_FOCAL).ln();
            println!("yud_{number}: undone {:5.1} %, focal length {:5.1} %", 100.0 * view.undone, 100.0 * error);
            *sum += error.abs() / 8.0;
        }
    }
    let [off, measured, common] = sums;
    println!("mean error: off {off:.3}, as measured {measured:.3}, -3 % in all {common:.3}");
    assert!(measured < off && common < 0.75 * off, "{sums:?}");
}

/// Checks estimates whose true value is 0: their sizes, each divided by its stated error, may be hardly larger than
/// those of a normal distribution.
fn check_calibration(what: &str, mut shares: Vec<f64>) {
    shares.sort_by(f64::total_cmp);
    let at = |p: f64| shares[(p * shares.len() as f64) as usize];
    let [half, most, nearly_all] = [0.5, 0.68, 0.9].map(at);
    println!("{what} / stated error: half below {half:.2}, 68 % below {most:.2}, 90 % below {nearly_all:.2}");
    assert!(half < 1.1 && nearly_all < 2.5);
}

/// The squareness of rooms with right angles is 0 within its stated error, with and without a known focal length.
#[test]
fn rooms_of_photos_stand_at_right_angles() {
    for knows_focal in [true, false] {
        let mut shares = Vec::new();
        for l in labelled_photos() {
            let focal = knows_focal.then_some(l.intrinsics.x_axis.x);
            let view =
                rectify::find_view(&l.photo, &Params { focal, ..Params::default() }, Monitor::default().job()).unwrap();
            println!("{:22} {:.3?}", l.name, view.squareness.map(|s| s.map(|s| (s.angle, s.error))));
            shares.extend(view.squareness.into_iter().flatten().map(|s| (s.angle / s.error).abs()));
        }
        if shares.is_empty() {
            return;
        }
        check_calibration(&format!("focal length known {knows_focal}: angle"), shares);
    }
}

#[test]
fn vanishing_points_of_labelled_segments_meet_the_published_protocol() {
    for (name, least) in [("yud_dev", 0.885), ("nyu_dev", 0.76)] {
        let Some(set) = given_set(name) else { continue };
        let all = set.angles(&Params::default());
        println!(
            "{name}: AUC@10 {:.1} @5 {:.1} @3 {:.1} median {:.2}",
            100.0 * area(&all, 10.0),
            100.0 * area(&all, 5.0),
            100.0 * area(&all, 3.0),
            all[all.len() / 2]
        );
        assert!(area(&all, 10.0) >= least);
    }
}

/// Overlay for inspection: the dimmed photo, its line segments in the colours of their room axes (grey: no axis), and
/// a quadrilateral in white.
fn drawn(photo: &Image, view: &rectify::View, quad: [DVec2; 4]) -> Image {
    let mut picture = photo.to_rgb().unwrap();
    picture.data.iter_mut().for_each(|v| *v *= 0.3);
    let [width, height] = [photo.width as f64, photo.height as f64];
    let mut line = |a: DVec2, b: DVec2, colour: [f32; 3]| {
        let steps = (b - a).abs().max_element().ceil().clamp(1.0, 1e5) as usize;
        for p in (0..=steps).map(|k| a.lerp(b, k as f64 / steps as f64)) {
            if p.x >= 0.0 && p.y >= 0.0 && p.x < width && p.y < height {
                picture.pixel_mut(p.x as usize, p.y as usize).copy_from_slice(&colour);
            }
        }
    };
    const COLOURS: [[f32; 3]; 3] = [[1.0, 0.1, 0.1], [0.1, 1.0, 0.1], [0.2, 0.4, 1.0]];
    for (segment, axis) in &view.segments {
        line(segment.a, segment.b, axis.map_or([0.3; 3], |k| COLOURS[k]));
    }
    for k in 0..4 {
        line(quad[k], quad[(k + 1) % 4], [1.0; 3]);
    }
    picture
}

/// Unwarps ceilings whose homographies are known; pictures go to the folder named by `LUXFER_TEST_OUTPUT`, if any.
#[test]
fn ceilings_unwarp_to_their_true_shape() {
    let monitor = Monitor::default();
    for (name, u, v) in [
        ("photos/alma_corridor", 1.6, 4.5),
        ("photos/alma_racks", 1.6, 3.0),
        ("photos/peabody_atrium_up", 1.0, 1.5),
        ("photos/peabody_gallery", 2.0, 3.0),
        ("photos/chester_chandelier", 1.5, 3.0),
        ("photos/hdri/warehouse_a", 3.0, 3.0),
        ("photos/hdri/autoshop", 3.0, 3.0),
    ] {
        let Some(json) = data(&format!("{name}.json")) else { continue };
        let Some(file) = ["jpg", "hdr"].iter().map(|e| json.with_extension(e)).find(|p| p.exists()) else { continue };
        let rows: Vec<Vec<f64>> = match read_json(&json)["H_image_from_ceiling"].as_array() {
            Some(rows) => rows.iter().map(numbers).collect(),
            None => continue,
        };
        let from_ceiling = DMat3::from_cols_array_2d(&[0, 1, 2].map(|c| [0, 1, 2].map(|r| rows[r][c])));
        let to_ceiling = from_ceiling.inverse();
        let on_ceiling = |p: DVec2| {
            let q = to_ceiling * p.extend(1.0);
            q.truncate() / q.z
        };
        let photo = io::load(&file, Encoding::Srgb).unwrap();
        let mask = Image::from_fn(photo.width, photo.height, |x, y| {
            let q = on_ceiling(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            let in_front = (from_ceiling * q.extend(1.0)).z > 0.0;
            [f32::from(in_front && q.x.abs() < u && q.y.abs() < v)]
        })
        .unwrap();
        let view = rectify::find_view(&photo, &Params::default(), monitor.job()).unwrap();
        let start = Instant::now();
        let flat = rectify::unwarp(&photo, &view, &mask, &UnwarpParams::default(), monitor.job()).unwrap();
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let corner = flat.corners.map(on_ceiling);
        let (across, down) = (corner[1] - corner[0], corner[3] - corner[0]);
        let (w, h) = (flat.image.width as f64, flat.image.height as f64);
        let aspect = across.length() / down.length() * h / w;
        let skew = across.angle_to(down).abs().to_degrees() - 90.0;
        let scale = across.length() / (w * flat.pixel_size);
        println!(
            "{name}: {w} x {h} in {ms:.0} ms, aspect {aspect:.4}, skew {skew:.2} deg, scale {scale:.4}, aspect confidence \
             {:.2}, corner error {:.1?} px",
            flat.aspect_confidence, flat.corner_error,
        );
        if let Some(folder) = std::env::var_os("LUXFER_TEST_OUTPUT") {
            let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
            let write = |suffix: &str, image: &Image| {
                let path = PathBuf::from(&folder).join(format!("{stem}{suffix}.png"));
                io::write_file(&path, &io::encode_png(image, 1.0).unwrap()).unwrap();
            };
            write("_unwarped", &flat.image);
            write("_valid", &flat.valid);
            write("_mask", &mask);
            write("_lines", &drawn(&photo, &view, flat.corners));
        }
        assert!((aspect - 1.0).abs() < 0.05, "{name}: {aspect}");
    }
}
