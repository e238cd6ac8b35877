//! Tests of rectification as a whole, on rooms and planes seen by known cameras.

use super::sphere::STRAIGHTNESS;
use super::vanishing::from_segments;
use super::*;
use crate::error::ErrorKind;
use crate::exec::Pool;
use crate::geometry::{FocalSource, Homography};
use crate::job::Monitor;
use crate::rng::Rng;
use glam::{DMat3, DQuat, DVec3};

mod lens;
mod perpendicular;

const SIZE: (usize, usize) = (800, 600);

fn camera(yaw: f64, pitch: f64, roll: f64, focal: f64) -> Perspective {
    let turn = DQuat::from_rotation_z(roll) * DQuat::from_rotation_x(pitch) * DQuat::from_rotation_y(yaw);
    Perspective {
        focal,
        focal_source: FocalSource::Given,
        principal: DVec2::new(SIZE.0 as f64, SIZE.1 as f64) / 2.0,
        bend: 0.0,
        axes: DMat3::from_quat(turn),
    }
}

/// Segments along the three axes of a room, their end points moved by Gaussian noise.
fn room(camera: &Perspective, per_axis: [usize; 3], noise: f64, seed: u64) -> Vec<Segment> {
    let mut rng = Rng::new(seed, &[]);
    let mut out = Vec::new();
    for (axis, count) in per_axis.into_iter().enumerate() {
        let vanishing = camera.vanishing_point(axis);
        while out.len() < per_axis[..axis].iter().sum::<usize>() + count {
            let a = DVec2::new(rng.next_f64() * SIZE.0 as f64, rng.next_f64() * SIZE.1 as f64);
            let towards = (vanishing.truncate() - a * vanishing.z).normalize();
            let b = a + towards * (30.0 + 150.0 * rng.next_f64());
            let moved = |p: DVec2, rng: &mut Rng| p + DVec2::new(rng.normal(), rng.normal()) * noise;
            out.push(Segment { a: moved(a, &mut rng), b: moved(b, &mut rng) });
        }
    }
    out
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b).abs())
}

fn direction_of(camera: &Perspective, point: DVec3) -> DVec3 {
    (camera.intrinsics().inverse() * point).normalize()
}

fn view_of(segments: &[Segment], params: &Params) -> Result<View> {
    view_from_segments(segments, SIZE.0, SIZE.1, params, Monitor::default().job())
}

#[test]
fn exact_segments_give_exact_vanishing_points_and_the_camera() {
    for (i, (yaw, pitch, roll, focal)) in
        [(0.5, 0.3, 0.05, 700.0), (-0.7, -0.2, 0.0, 500.0), (0.3, 0.6, -0.1, 1200.0)].into_iter().enumerate()
    {
        let truth = camera(yaw, pitch, roll, focal);
        let view = view_of(&room(&truth, [30, 30, 30], 0.0, i as u64), &Params::default()).unwrap();
        for axis in 0..3 {
            let found = direction_of(&truth, view.vanishing_points[axis].point);
            let nearest = (0..3).map(|k| angle(found, truth.axes.col(k))).fold(9.0, f64::min);
            assert!(nearest < 1e-6, "{nearest}");
        }
        assert!((view.perspective.focal / focal - 1.0).abs() < 1e-3, "{}", view.perspective.focal);
        let axes = view.perspective.axes;
        assert!((axes.determinant() - 1.0).abs() < 1e-12 && axes.y_axis.y > 0.0 && axes.z_axis.z > 0.0);
        assert!((axes.transpose() * axes - DMat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < 1e-12));
    }
}

#[test]
fn errors_under_noise_are_as_stated() {
    // The noise ranges from values that hardly change the weights to values that the inlier limit largely truncates.
    for (noise, per_axis) in [(0.25, 14), (0.5, 40), (1.0, 14), (1.0, 40)] {
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..40 {
            let truth = camera(0.5, 0.3, 0.05, 700.0);
            let params = Params { focal: Some(700.0), seed, ..Params::default() };
            // Repeat each segment five times: the reported errors assume five segments per independent observation.
            let segments = room(&truth, [per_axis; 3], noise, seed).repeat(5);
            let view = view_of(&segments, &params).unwrap();
            for v in &view.vanishing_points {
                let found = direction_of(&truth, v.point);
                let error = (0..3).map(|k| angle(found, truth.axes.col(k))).fold(9.0, f64::min);
                // The generated edges are perfectly straight: subtract the allowance for crooked edges from the
                // reported variance.
                sum += error * error / (v.error * v.error - STRAIGHTNESS * STRAIGHTNESS);
                count += 1.0;
            }
        }
        // This is the mean of 120 squared ratios, each with 1 to 2 degrees of freedom; its standard deviation is 0.09
        // to 0.13.
        let ratio = sum / count;
        println!("noise of {noise} pixels, {per_axis} lines an axis: {ratio:.2}");
        assert!((0.6..1.4).contains(&ratio), "{noise}, {per_axis}: {ratio}");
    }
}

#[test]
fn points_at_the_centre_and_at_infinity_are_exact() {
    let truth = camera(0.0, 0.0, 0.0, 680.0);
    let view = view_of(&room(&truth, [20, 20, 20], 0.0, 3), &Params::default()).unwrap();
    for (axis, want) in [DVec3::X, DVec3::Y, truth.principal.extend(1.0)].into_iter().enumerate() {
        assert!(angle(direction_of(&truth, view.vanishing_points[axis].point), direction_of(&truth, want)) < 1e-9);
    }
    assert_eq!(view.vanishing_points[0].point.z, 0.0);
    assert_eq!(view.perspective.focal_source, FocalSource::Assumed);
    assert!((view.perspective.focal - 0.85 * 800.0).abs() < 1e-6);
}

#[test]
fn the_files_focal_length_decides_where_lines_do_not() {
    let expected = |focal: f64| Params { expected_focal: Some([focal, 0.05 * focal]), ..Params::default() };
    let mask = Image::from_fn(SIZE.0, SIZE.1, |_, y| [f32::from(y < 200)]).unwrap();
    // The camera looks straight along the room, so the lines determine neither the focal length nor the length of the
    // ceiling.
    let ahead = camera(0.0, 0.0, 0.0, 1000.0);
    let (photo, lines) = (ceiling(&ahead), room(&ahead, [20, 20, 20], 0.0, 3));
    let unwarped = |params: &Params| {
        let view = view_of(&lines, params).unwrap();
        let flat = unwarp(&photo, &view, &mask, &UnwarpParams::default(), Monitor::default().job()).unwrap();
        (view.perspective.focal, view.perspective.focal_source, flat.aspect_confidence)
    };
    let (focal, source, confidence) = unwarped(&Params::default());
    assert!(
        (focal - 680.0).abs() < 1e-6 && source == FocalSource::Assumed && confidence < 0.2,
        "{focal} {source:?} {confidence}"
    );
    let (focal, source, confidence) = unwarped(&expected(1000.0));
    assert!((focal - 1000.0).abs() < 1e-6 && source == FocalSource::Metadata && confidence > 0.7, "{confidence}");
    let (focal, source, _) = unwarped(&Params { focal: Some(900.0), ..expected(1000.0) });
    assert!(focal == 900.0 && source == FocalSource::Given);

    // For a camera that looks across the room, the lines determine the focal length better than the metadata of a
    // file.
    let across = camera(0.5, 0.3, 0.05, 700.0);
    let view = view_of(&room(&across, [40, 40, 40], 0.1, 8), &expected(1000.0)).unwrap();
    assert!((view.perspective.focal / 700.0 - 1.0).abs() < 0.01, "{}", view.perspective.focal);
    assert_eq!(view.perspective.focal_source, FocalSource::VanishingPoints);
    for bad in [[-1.0, 1.0], [700.0, 0.0], [f64::NAN, 1.0]] {
        let params = Params { expected_focal: Some(bad), ..Params::default() };
        assert_eq!(view_of(&lines, &params).unwrap_err().kind, ErrorKind::InvalidArgument);
    }
}

/// Divides the true error of the focal length by its stated error, and measures the mean square of this ratio over many
/// rooms.
#[test]
fn the_stated_error_of_a_focal_length_from_lines_is_its_true_error() {
    let truth = camera(0.5, 0.3, 0.05, 700.0);
    for per_axis in [14, 40] {
        let ratio = |seed: u64| {
            // Repeat each segment five times: the stated errors assume five segments per independent observation. With
            // a pixel of noise, the allowance for crooked edges, which these edges do not need, hardly counts.
            let segments = room(&truth, [per_axis; 3], 1.0, seed).repeat(5);
            let view = view_of(&segments, &Params { seed, ..Params::default() }).unwrap();
            assert_eq!(view.perspective.focal_source, FocalSource::VanishingPoints);
            assert!(view.focal_error() > 0.0, "{}", view.focal_error());
            (view.perspective.focal - 700.0) / view.focal_error()
        };
        // The mean of 60 squared ratios, each with one degree of freedom, has a standard deviation of 0.18.
        let mean = (0..60).map(|seed| ratio(seed).powi(2)).sum::<f64>() / 60.0;
        println!("{per_axis} lines an axis: {mean:.2}");
        assert!((0.5..1.6).contains(&mean), "{per_axis}: {mean}");
    }
    // The error of an assumed focal length is the error of the prior. A given focal length has no error.
    let ahead = room(&camera(0.0, 0.0, 0.0, 1000.0), [20, 20, 20], 0.0, 3);
    let stated = |params: &Params| view_of(&ahead, params).unwrap().focal_error();
    assert!((stated(&Params::default()) - 0.35 * 680.0).abs() < 1.0, "{}", stated(&Params::default()));
    let metadata = Params { expected_focal: Some([1000.0, 50.0]), ..Params::default() };
    assert!((stated(&metadata) - 50.0).abs() < 0.1, "{}", stated(&metadata));
    assert_eq!(stated(&Params { focal: Some(900.0), ..metadata }), 0.0);
}

#[test]
fn one_family_gives_its_point_wherever_it_is() {
    // Put the vanishing point inside the image, on its border, and ever farther outside.
    let border = 400.0 / 0.4f64.cos();
    for far in [300.0, border, 5e3, 1e6, 1e12, f64::INFINITY] {
        let along = DVec2::from_angle(0.4);
        let centre = DVec2::new(400.0, 300.0);
        let point = if far.is_finite() { (centre + along * far).extend(1.0) } else { along.extend(0.0) };
        let segments: Vec<Segment> = (0..24)
            .map(|i| {
                let a = DVec2::new(50.0 + 31.0 * i as f64, (i * i * 37 % 500) as f64);
                let towards = (point.truncate() - a * point.z).normalize();
                Segment { a, b: a + towards * 60.0 }
            })
            .collect();
        let found = from_segments(&segments, 800, 600, 3, &Params::default(), Monitor::default().job()).unwrap();
        let ray = |p: DVec3| (p.truncate() - centre * p.z).extend(p.z * 680.0).normalize();
        let error = angle(ray(found.points[0].point), ray(point));
        assert!(error < 1e-6 && found.points[0].support == 24, "{far}: {error}");
    }
}

#[test]
fn two_families_give_the_third() {
    let truth = camera(0.5, 0.3, 0.05, 700.0);
    let view = view_of(&room(&truth, [40, 0, 40], 0.1, 8), &Params::default()).unwrap();
    assert_eq!(view.vanishing_points[1].support, 0);
    assert!(angle(view.perspective.axes.y_axis, truth.axes.y_axis) < 0.01);
    assert!((view.perspective.focal / 700.0 - 1.0).abs() < 0.02);
    assert_eq!(view.perspective.focal_source, FocalSource::VanishingPoints);
}

#[test]
fn families_that_no_camera_could_see_at_right_angles_still_give_orthogonal_axes() {
    // Both vanishing points lie on one side of the centre: for any focal length their rays meet at less than a right
    // angle.
    let points = [DVec2::new(1500.0, 320.0), DVec2::new(2500.0, 350.0)];
    let segments: Vec<Segment> = (0..80)
        .map(|i| {
            let a = DVec2::new((i * 97 % 700) as f64, (i * i * 31 % 590) as f64);
            Segment { a, b: a + (points[i % 2] - a).normalize() * 70.0 }
        })
        .collect();
    let view = view_of(&segments, &Params::default()).unwrap();
    let axes = view.perspective.axes;
    assert!((axes.transpose() * axes - DMat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < 1e-9), "{axes}");
    assert!(view.perspective.focal.is_finite() && view.perspective.focal > 0.0);
}

#[test]
fn sets_without_a_vanishing_point_are_refused() {
    let s = |ax: f64, ay: f64, bx: f64, by: f64| Segment { a: DVec2::new(ax, ay), b: DVec2::new(bx, by) };
    let one = s(10.0, 10.0, 200.0, 50.0);
    for bad in [
        vec![],
        vec![one],
        vec![one; 50],
        vec![s(5.0, 5.0, 5.0, 5.0); 10],
        vec![s(f64::NAN, 0.0, 1.0, 1.0), s(0.0, f64::INFINITY, 1.0, 1.0)],
    ] {
        let error = view_of(&bad, &Params::default()).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.message.contains("no lines found"));
    }
    let two = [one, s(10.0, 500.0, 300.0, 400.0)];
    assert!(view_of(&two, &Params::default()).is_ok());
    for bad in [Params { focal: Some(-1.0), ..Params::default() }, Params { hough_band: f64::NAN, ..Params::default() }]
    {
        assert_eq!(view_of(&two, &bad).unwrap_err().kind, ErrorKind::InvalidArgument);
    }
}

#[test]
fn segments_through_the_point_repeated_or_degenerate_segments_are_harmless() {
    // All segments pass through one point; a third of them have their midpoint there.
    let point = DVec2::new(310.0, 240.0);
    let through = |i: usize| {
        let d = DVec2::from_angle(0.13 * i as f64);
        Segment { a: point - d * 40.0, b: point + d * (40.0 + 7.0 * (i % 3) as f64) }
    };
    let star: Vec<Segment> = (0..24).map(through).collect();
    let found = from_segments(&star, SIZE.0, SIZE.1, 1, &Params::default(), Monitor::default().job()).unwrap();
    let at = found.points[0].point;
    assert!((at.truncate() / at.z).distance(point) < 1e-6 && found.points[0].support == 24, "{at}");

    let truth = camera(0.5, 0.3, 0.05, 700.0);
    let exact = room(&truth, [30, 30, 30], 0.0, 1);
    let twice = view_of(&exact.repeat(2), &Params::default()).unwrap();
    for v in &twice.vanishing_points {
        let found = direction_of(&truth, v.point);
        assert!((0..3).map(|k| angle(found, truth.axes.col(k))).fold(9.0, f64::min) < 1e-6);
    }
    let s = |ax: f64, ay: f64, bx: f64, by: f64| Segment { a: DVec2::new(ax, ay), b: DVec2::new(bx, by) };
    let worthless = [s(5.0, 5.0, 5.0, 5.0), s(f64::NAN, 0.0, 1.0, 1.0), s(0.0, f64::INFINITY, 1.0, 1.0)];
    let plain = view_of(&exact, &Params::default()).unwrap();
    let mixed: Vec<Segment> = worthless.iter().chain(&exact).chain(&worthless).copied().collect();
    let mixed = view_of(&mixed, &Params::default()).unwrap();
    assert_eq!(mixed.perspective, plain.perspective);
    assert_eq!(mixed.segments[3..93], plain.segments[..]);
    assert!(mixed.segments[..3].iter().chain(&mixed.segments[93..]).all(|(_, axis)| axis.is_none()));
}

#[test]
fn a_hundred_thousand_segments_take_their_time_but_not_more() {
    let truth = camera(0.5, 0.3, 0.05, 700.0);
    let segments = room(&truth, [40_000, 30_000, 30_000], 0.3, 2);
    let start = std::time::Instant::now();
    let view = view_of(&segments, &Params::default()).unwrap();
    assert!(start.elapsed().as_secs_f64() < 10.0);
    assert!((view.perspective.focal / 700.0 - 1.0).abs() < 0.02);
}

/// A linear photo of a ceiling in the plane `y = -1`. The ceiling extends 6 units from the camera in each direction.
/// It has lamps of 0.3 × 0.15 units at a spacing of 0.6 × 0.4 units.
fn ceiling(camera: &Perspective) -> Image {
    const SUB: usize = 3;
    let lamp = |p: DVec2| {
        let q = DVec2::new(p.x.rem_euclid(0.6), p.y.rem_euclid(0.4));
        if q.x < 0.3 && q.y < 0.15 { 0.9f32 } else { 0.2 }
    };
    Image::from_fn(SIZE.0, SIZE.1, |x, y| {
        let mut sum = 0.0;
        for i in 0..SUB * SUB {
            let sub = DVec2::new((i % SUB) as f64 + 0.5, (i / SUB) as f64 + 0.5) / SUB as f64;
            let ray = camera.axes.transpose() * camera.ray(DVec2::new(x as f64, y as f64) + sub);
            sum += {
                let at = DVec2::new(ray.x, ray.z) / -ray.y;
                let wall = ray.y >= 0.0 || at.abs().max_element() > 6.0;
                if wall { 0.1 } else { lamp(at) }
            };
        }
        [sum / (SUB * SUB) as f32; 3]
    })
    .unwrap()
}

/// Returns the true coordinates of a photo point on the plane of [`ceiling`].
fn on_ceiling(camera: &Perspective, p: DVec2) -> DVec2 {
    let ray = camera.axes.transpose() * camera.ray(p);
    DVec2::new(ray.x, ray.z) / -ray.y
}

#[test]
fn a_lamp_grid_unwarps_to_right_angles_true_aspect_and_nothing_mirrored() {
    let truth = camera(0.4, -0.55, 0.03, 560.0);
    let photo = ceiling(&truth);
    let mask = Image::from_fn(SIZE.0, SIZE.1, |_, _| [1.0f32]).unwrap();
    let monitor = Monitor::default();
    // Use exact segments: this test concerns the unwarping alone, not the line detection.
    let view = view_of(&room(&truth, [30, 30, 30], 0.0, 4), &Params::default()).unwrap();
    assert!((view.perspective.focal / 560.0 - 1.0).abs() < 0.02, "{}", view.perspective.focal);
    let flat = unwarp(&photo, &view, &mask, &UnwarpParams::default(), monitor.job()).unwrap();
    // Compare the sides of the rectangle in true units. The plane's distance is 1, so the pixel size is known too.
    let corner = flat.corners.map(|c| on_ceiling(&truth, c));
    let (across, down) = (corner[1] - corner[0], corner[3] - corner[0]);
    let (w, h) = (flat.image.width as f64, flat.image.height as f64);
    assert!((across.length() / (w * flat.pixel_size) - 1.0).abs() < 0.01);
    assert!((down.length() / (h * flat.pixel_size) - 1.0).abs() < 0.01);
    assert!((across.length() / down.length() * h / w - 1.0).abs() < 0.01);
    assert!(across.normalize().dot(down.normalize()).abs() < 0.01);
    assert!(flat.aspect_confidence > 0.8);
    // Valid texels lie on the camera's side of the horizon and show the lamps at their true positions. Weight each
    // texel by the photo area it shows, since many distant texels share a photo pixel.
    let mut agree = (0.0, 0.0);
    for y in 0..flat.image.height {
        for x in 0..flat.image.width {
            let p = flat.to_photo.apply(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
            let ray = truth.axes.transpose() * truth.ray(p);
            if flat.valid.pixel(x, y)[0] > 0.0 {
                assert!(ray.y < 0.0);
                let q = on_ceiling(&truth, p);
                let lamp = q.x.rem_euclid(0.6) < 0.3 && q.y.rem_euclid(0.4) < 0.15;
                let [right, below] = [DVec2::new(1.5, 0.5), DVec2::new(0.5, 1.5)]
                    .map(|d| flat.to_photo.apply(DVec2::new(x as f64, y as f64) + d) - p);
                let area = right.perp_dot(below).abs();
                agree.0 += if (flat.image.pixel(x, y)[0] > 0.55) == lamp { area } else { 0.0 };
                agree.1 += area;
            }
        }
    }
    assert!(agree.1 > 10_000.0 && agree.0 > 0.95 * agree.1, "{agree:?}");
    // The paper computes the homography from the four corners, which yields the same map.
    let rectangle = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)];
    let paper = Homography::from_corners(rectangle, flat.corners).unwrap();
    let p = DVec2::new(0.3 * w, 0.7 * h);
    assert!(paper.apply(p).distance(flat.to_photo.apply(p)) < 1e-6);
}

#[test]
fn expected_corner_errors_hold_over_noisy_lines() {
    let truth = camera(0.4, -0.55, 0.03, 560.0);
    let photo = Image::from_fn(SIZE.0, SIZE.1, |_, _| [0.5f32; 3]).unwrap();
    let mask = Image::from_fn(SIZE.0, SIZE.1, |x, y| [f32::from((200..600).contains(&x) && y < 200)]).unwrap();
    let params = UnwarpParams { axes: Some([0, 2]), ..UnwarpParams::default() };
    for focal in [Some(560.0), None] {
        let mut shares = Vec::new();
        for seed in 0..60 {
            // Repeat each segment five times: the reported errors assume five segments per independent observation.
            let segments = room(&truth, [14, 14, 14], 1.0, seed).repeat(5);
            let view = view_of(&segments, &Params { focal, seed, ..Params::default() }).unwrap();
            let flat = unwarp(&photo, &view, &mask, &params, Monitor::default().job()).unwrap();
            let (w, h) = (flat.image.width as f64, flat.image.height as f64);
            let found = [DVec2::ZERO, DVec2::new(w, 0.0), DVec2::new(w, h), DVec2::new(0.0, h)];
            let (found, exact) =
                (centred(found), centred(flat.corners.map(|c| on_ceiling(&truth, c) / flat.pixel_size)));
            // The photo decides which axis runs right and which runs down, so compare with the nearest pair of true
            // axes.
            let turns = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y]
                .into_iter()
                .flat_map(|u| [(u, u.perp()), (u, -u.perp())])
                .map(|(u, v)| exact.map(|p| DVec2::new(u.dot(p), v.dot(p))));
            let squares = |p: &[DVec2; 4]| p.iter().zip(&found).map(|(a, b)| a.distance_squared(*b)).sum::<f64>();
            let exact = turns.min_by(|a, b| squares(a).total_cmp(&squares(b))).unwrap();
            shares.extend((0..4).map(|i| found[i].distance(exact[i]) / flat.corner_error[i]));
        }
        shares.sort_by(f64::total_cmp);
        let at = |p: f64| shares[(p * shares.len() as f64) as usize];
        let mean_square = shares.iter().map(|s| s * s).sum::<f64>() / shares.len() as f64;
        println!("{focal:?}: mean square {mean_square:.2}, half below {:.2}, 95 % below {:.2}", at(0.5), at(0.95));
        // Expected errors are root mean squares. The test averages over 60 views of four corners each, and the four
        // corners of one view are correlated: the standard deviation of the mean is 0.12.
        assert!((0.7..1.4).contains(&mean_square) && at(0.95) < 2.3);
    }
}

/// Returns the points relative to their mean.
fn centred(points: [DVec2; 4]) -> [DVec2; 4] {
    let mean = points.iter().sum::<DVec2>() / 4.0;
    points.map(|p| p - mean)
}

#[test]
fn the_printed_method_finds_the_same_room() {
    let truth = camera(0.4, -0.55, 0.03, 560.0);
    let photo = ceiling(&truth);
    for params in [
        Params::printed(),
        Params { metric: Metric::Segment, ..Params::printed() },
        Params { detector: LineDetector::Hough, ..Params::default() },
    ] {
        let view = find_view(&photo, &params, Monitor::default().job()).unwrap();
        for axis in [0, 2] {
            let nearest = view
                .vanishing_points
                .iter()
                .map(|v| angle(direction_of(&truth, v.point), truth.axes.col(axis)))
                .fold(9.0, f64::min);
            assert!(nearest < 0.05, "{params:?}: axis {axis} {nearest}");
        }
    }
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let truth = camera(0.4, -0.55, 0.03, 560.0);
    let photo = ceiling(&truth);
    let mask = Image::from_fn(SIZE.0, SIZE.1, |_, y| [f32::from(y < 200)]).unwrap();
    let monitor = Monitor::default();
    let run = |threads: usize| {
        Pool::new(threads).unwrap().run(|| {
            let view = find_view(&photo, &Params::default(), monitor.job()).unwrap();
            unwarp(&photo, &view, &mask, &UnwarpParams::default(), monitor.job()).unwrap()
        })
    };
    let (a, b) = (run(1), run(3));
    assert!(a.image == b.image && a.to_photo == b.to_photo && a.corner_error == b.corner_error);
}

#[test]
fn images_without_lines_are_refused_and_never_crash() {
    let noise = |x: usize, y: usize| Rng::new(1, &[x as u64, y as u64]).next_f32();
    let images = [
        Image::from_fn(64, 64, |_, _| [0.5f32; 3]).unwrap(),
        Image::from_fn(1, 1, |_, _| [0.5f32; 3]).unwrap(),
        Image::from_fn(1, 300, |_, y| [y as f32; 3]).unwrap(),
        Image::from_fn(300, 2, |x, _| [x as f32; 3]).unwrap(),
        Image::from_fn(64, 64, |_, _| [f32::NAN; 3]).unwrap(),
        Image::from_fn(64, 64, |_, _| [f32::INFINITY; 3]).unwrap(),
        Image::from_fn(64, 64, |_, _| [-1.0f32; 3]).unwrap(),
    ];
    for detector in [LineDetector::Regions, LineDetector::Hough] {
        let params = Params { detector, ..Params::default() };
        for image in &images {
            let error = find_view(image, &params, Monitor::default().job()).unwrap_err();
            assert_eq!(error.kind, ErrorKind::Degenerate);
        }
        // Test four images: noise, noise rounded to 0 or 1, white with a black corner, and noise in which every third
        // pixel is not finite.
        let odd = |x: usize, y: usize| if (x + y).is_multiple_of(3) { f32::NAN } else { noise(x, y) };
        for image in [
            Image::from_fn(200, 150, |x, y| [noise(x, y); 3]).unwrap(),
            Image::from_fn(200, 150, |x, y| [noise(x, y).round(); 3]).unwrap(),
            Image::from_fn(200, 150, |x, y| [if x + y < 20 { 0.0 } else { 1.0 }; 3]).unwrap(),
            Image::from_fn(200, 150, |x, y| [odd(x, y); 3]).unwrap(),
        ] {
            let found = find_segments(&image, &params, Monitor::default().job()).unwrap();
            assert!(found.iter().all(|s| s.a.is_finite() && s.b.is_finite()));
        }
    }
}

#[test]
fn planes_that_cannot_be_unwarped_say_why() {
    let truth = camera(0.0, 0.0, 0.0, 700.0);
    let view =
        view_of(&room(&truth, [20, 20, 20], 0.0, 3), &Params { focal: Some(700.0), ..Params::default() }).unwrap();
    let photo = Image::from_fn(SIZE.0, SIZE.1, |_, _| [0.5f32; 3]).unwrap();
    let mask = |f: &dyn Fn(usize, usize) -> bool| Image::from_fn(SIZE.0, SIZE.1, |x, y| [f32::from(f(x, y))]).unwrap();
    let run = |mask: &Image, params: UnwarpParams| unwarp(&photo, &view, mask, &params, Monitor::default().job());
    let horizontal = UnwarpParams { axes: Some([0, 2]), ..UnwarpParams::default() };
    let empty = run(&mask(&|_, _| false), UnwarpParams::default()).unwrap_err();
    assert!(empty.kind == ErrorKind::Degenerate && empty.message.contains("mask is empty"));
    let edge = run(&mask(&|_, y| (297..303).contains(&y)), horizontal.clone()).unwrap_err();
    assert!(edge.kind == ErrorKind::Degenerate && edge.message.contains("edge-on"));
    for bad in [
        UnwarpParams { axes: Some([0, 0]), ..horizontal.clone() },
        UnwarpParams { axes: Some([0, 3]), ..horizontal.clone() },
        UnwarpParams { max_side: 15, ..horizontal.clone() },
        UnwarpParams { max_magnification: 0.0, ..horizontal.clone() },
    ] {
        assert_eq!(run(&mask(&|_, y| y < 200), bad).unwrap_err().kind, ErrorKind::InvalidArgument);
    }
    // A single marked pixel can be unwarped, and so can ceilings that touch the horizon or extend past it.
    assert!(run(&mask(&|x, y| x == 400 && y == 10), horizontal.clone()).is_ok());
    for lowest in [300, 400] {
        let across = run(&mask(&|_, y| y < lowest), horizontal.clone()).unwrap();
        assert!(across.corners.iter().all(|c| c.is_finite() && c.y < 300.0));
    }
}

/// Segments of a room whose horizontal axes deviate from a right angle by `skew`, seen with non-square pixels (aspect
/// ratio `tall`).
fn skewed(truth: &Perspective, skew: f64, tall: f64, noise: f64, seed: u64) -> Vec<Segment> {
    let turned = Perspective { axes: truth.axes * DMat3::from_rotation_y(skew), ..*truth };
    let mut segments = room(truth, [0, 40, 40], noise, seed);
    segments.extend(room(&turned, [40, 0, 0], noise, seed + 1));
    for s in &mut segments {
        (s.a.y, s.b.y) = (300.0 + (s.a.y - 300.0) * tall, 300.0 + (s.b.y - 300.0) * tall);
    }
    segments
}

#[test]
fn right_angles_are_measured_within_the_stated_error() {
    // If no focal length is given, the reported errors are too large. An error of one direction affects both an angle
    // and the focal length at which the angle is evaluated. The estimate ignores that these two effects are correlated.
    for (focal, range) in [(Some(700.0), 0.6..1.4), (None, 0.2..1.4)] {
        let (mut sum, mut count) = (0.0, 0.0);
        for seed in 0..60 {
            let truth = camera(0.5, 0.3, 0.05, 700.0);
            // Repeat each segment five times: the reported errors assume five segments per independent observation.
            let segments = skewed(&truth, 0.0, 1.0, 0.5, 2 * seed).repeat(5);
            let view = view_of(&segments, &Params { focal, seed, ..Params::default() }).unwrap();
            for found in view.squareness {
                let found = found.unwrap();
                // The stated variance of an angle contains STRAIGHTNESS² for crooked edges: half of STRAIGHTNESS² for
                // each of the two directions that form the angle. The generated edges are straight, so subtract it.
                sum += found.angle * found.angle / (found.error * found.error - STRAIGHTNESS * STRAIGHTNESS);
                count += 1.0;
            }
        }
        // This is the mean of 180 squared ratios, three for each of 60 independent views; its standard deviation is
        // 0.11 to 0.18.
        let ratio = sum / count;
        println!("focal length {focal:?}: {ratio:.2}");
        assert!(range.contains(&ratio), "{focal:?}: {ratio}");
    }
}

#[test]
fn walls_at_other_angles_and_pixels_that_are_not_square_show() {
    let truth = camera(0.5, 0.3, 0.05, 700.0);
    let worst = |segments: &[Segment], focal: Option<f64>| {
        let view = view_of(segments, &Params { focal, ..Params::default() }).unwrap();
        let ratios = view.squareness.map(|s| s.map_or(0.0, |s| s.angle / s.error));
        println!("{:.4?} {ratios:.1?}", view.squareness.map(|s| s.map(|s| (s.angle, s.error))));
        (view, ratios)
    };
    // Entry 1, of the vertical axis, measures the angle between the two horizontal axes, which is not a right angle
    // here.
    let skew = 8f64.to_radians();
    for side in [-1.0, 1.0] {
        let (view, ratios) = worst(&skewed(&truth, side * skew, 1.0, 0.3, 7), Some(700.0));
        let found = view.squareness[1].unwrap();
        assert!((found.angle.abs() - skew).abs() < 3.0 * found.error, "{found:?}");
        assert!(ratios[1].abs() > 3.0 && ratios[0].abs() < 3.0 && ratios[2].abs() < 3.0, "{ratios:?}");
    }
    let (_, ratios) = worst(&skewed(&truth, 0.0, 1.25, 0.3, 9), Some(700.0));
    assert!(ratios.iter().any(|r| r.abs() > 3.0), "{ratios:?}");
    // With a single pair of axes, a deviation from a right angle is visible only if the focal length is given.
    let pair: Vec<Segment> = room(&truth, [0, 40, 40], 0.3, 5);
    let [unknown, given] = [None, Some(700.0)].map(|focal| worst(&pair, focal).0.squareness[0].unwrap());
    assert!(unknown.error > 5.0 * given.error && given.angle.abs() < 3.0 * given.error, "{unknown:?} {given:?}");
}
