//! Tests on box rooms seen by a known camera, whose true depth is computed analytically.

mod strokes;

use super::box_room::faces;
use super::*;
use crate::exec::Pool;
use crate::geometry::perspective::VERTICAL;
use crate::geometry::{FocalSource, Perspective, Segment};
use crate::job::Monitor;
use crate::rng::Rng;
use glam::{DMat3, DVec2, DVec3, Vec3};

fn camera(yaw: f64, pitch: f64, roll: f64, width: usize, height: usize) -> Perspective {
    let to_room = DMat3::from_rotation_y(yaw) * DMat3::from_rotation_x(pitch) * DMat3::from_rotation_z(roll);
    Perspective {
        focal: 0.8 * width as f64,
        focal_source: FocalSource::Given,
        principal: DVec2::new(width as f64 / 2.0, height as f64 / 2.0),
        bend: 0.0,
        axes: to_room.transpose(),
    }
}

fn photo(width: usize, height: usize) -> Image {
    Image::from_fn(width, height, |x, y| [x as f32 / width as f32, 0.5, y as f32 / height as f32]).unwrap()
}

/// Returns the depth along z at a pixel that shows a box with the given sides, and the index of the face that it shows.
fn truth(camera: &Perspective, sides: &[f64; 4], x: usize, y: usize) -> (f64, usize) {
    let ray = camera.axes.transpose() * camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
    let (face, inverse) = faces(sides, ray)[0];
    (1.0 / inverse, face as usize)
}

/// Returns segments of a box room with their axes: seams, and lines drawn on its faces.
fn room_segments(camera: &Perspective, sides: &[f64; 4], width: usize, height: usize) -> Vec<(Segment, Option<usize>)> {
    let [l, r, t, b] = *sides;
    let project = |p: DVec3| {
        let c = camera.axes * p;
        (c.z > 0.05).then(|| camera.principal + c.truncate() * (camera.focal / c.z))
    };
    let mut lines = Vec::new();
    for x in [-l, r] {
        lines.push((DVec3::new(x, -t, 1.0), DVec3::new(x, b, 1.0), 1));
        for y in [-t, b] {
            lines.push((DVec3::new(x, y, 0.2), DVec3::new(x, y, 1.0), 2));
        }
        // Add a door in each side wall.
        lines.push((DVec3::new(x, b, 0.6), DVec3::new(x, b * 0.1, 0.6), 1));
        lines.push((DVec3::new(x, b * 0.1, 0.6), DVec3::new(x, b * 0.1, 0.75), 2));
    }
    for y in [-t, b] {
        lines.push((DVec3::new(-l, y, 1.0), DVec3::new(r, y, 1.0), 0));
        // Add tiles.
        for k in 1..4 {
            let x = -l + (r + l) * f64::from(k) / 4.0;
            lines.push((DVec3::new(x, y, 0.4), DVec3::new(x, y, 0.95), 2));
            lines.push((DVec3::new(-l, y, 0.2 + 0.2 * f64::from(k)), DVec3::new(r, y, 0.2 + 0.2 * f64::from(k)), 0));
        }
    }
    // Add a window in the back wall.
    lines.push((DVec3::new(0.0, -t * 0.6, 1.0), DVec3::new(0.0, b * 0.3, 1.0), 1));
    lines.push((DVec3::new(0.0, -t * 0.6, 1.0), DVec3::new(r * 0.6, -t * 0.6, 1.0), 0));
    let inside = |p: DVec2| p.x >= 0.0 && p.y >= 0.0 && p.x <= width as f64 && p.y <= height as f64;
    let pieces = lines.iter().flat_map(|&(p, q, axis)| {
        (0..6).map(move |i| (p.lerp(q, f64::from(i) / 6.0), p.lerp(q, f64::from(i + 1) / 6.0), axis))
    });
    pieces
        .filter_map(|(p, q, axis)| {
            let (a, b) = (project(p)?, project(q)?);
            (inside(a) && inside(b)).then_some((Segment { a, b }, Some(axis)))
        })
        .collect()
}

fn run_with(photo: &Image, depth: Option<DepthMap>, room: Option<RoomView>) -> Result<Features> {
    run(&Input { photo, depth, room }, &Params::default(), Monitor::default().job())
}

#[test]
fn normals_and_positions_of_an_exact_room_are_exact_away_from_its_seams() {
    let (width, height) = (320, 240);
    let camera = camera(0.3, -0.2, 0.05, width, height);
    let sides = [0.5, 0.7, 0.3, 0.35];
    for kind in [DepthKind::AlongZ, DepthKind::AlongRay] {
        let depth = Image::from_fn(width, height, |x, y| {
            let length = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)).length();
            let per_z = if kind == DepthKind::AlongRay { length } else { 1.0 };
            [(4.0 * per_z * truth(&camera, &sides, x, y).0) as f32]
        })
        .unwrap();
        let room = RoomView { perspective: &camera, segments: &[], strokes: &[], layout: None };
        let photo = photo(width, height);
        let features = run_with(&photo, Some(DepthMap { image: &depth, kind }), Some(room)).unwrap();
        assert_eq!(features.depth_source, DepthSource::Caller);
        assert!(features.depth_confidence.data.iter().all(|&c| c == 1.0));
        let normals = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::NEG_Z];
        let mut scale = None;
        let (mut exact, mut all) = (0, 0);
        for y in 0..height {
            for x in 0..width {
                let p = features.image.pixel(x, y);
                let (z, face) = truth(&camera, &sides, x, y);
                // Check pixels at creases too, where the fit uses a window on one side of the crease.
                let off = Vec3::from_slice(&p[7..10]).angle_between(normals[face]);
                all += 1;
                exact += usize::from(off < 1e-3);
                // Positions equal the true ones up to one global scale.
                let want = camera.axes.transpose() * camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)) * z;
                let got = Vec3::from_slice(&p[4..7]).as_dvec3();
                let s = *scale.get_or_insert(got.length() / want.length());
                assert!((got - want * s).length() < 1e-4 * want.length() * s, "{x} {y}");
            }
        }
        assert!(exact as f64 / all as f64 > 0.99, "{exact} of {all}");
    }
}

#[test]
fn noise_depth_edges_and_holes_leave_normals_robust() {
    let (width, height) = (320, 240);
    let camera = camera(0.0, 0.0, 0.0, width, height);
    // A nearby slanted board stands in front of the back wall. The depth has 0.2 % noise, and the board has a hole.
    let noise = |x: usize, y: usize| 1.0 + 0.002 * Rng::new(5, &[x as u64, y as u64]).normal();
    let board = |x: usize| x > 100 && x < 220;
    let depth = Image::from_fn(width, height, |x, y| {
        let ray = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5));
        let z = if board(x) { 2.0 / (1.0 + 0.4 * ray.x) } else { 5.0 };
        let hole = (150..170).contains(&x) && (100..120).contains(&y);
        [if hole { f32::NAN } else { (z * noise(x, y)) as f32 }]
    })
    .unwrap();
    let room = RoomView { perspective: &camera, segments: &[], strokes: &[], layout: None };
    let params = Params { normal_radius: 5, ..Params::default() };
    let photo = photo(width, height);
    let depth = DepthMap { image: &depth, kind: DepthKind::AlongZ };
    let features =
        run(&Input { photo: &photo, depth: Some(depth), room: Some(room) }, &params, Monitor::default().job()).unwrap();
    let slanted = Vec3::new(-0.4, 0.0, -1.0).normalize();
    let mut errors: Vec<f32> = Vec::new();
    for y in 5..height - 5 {
        for x in 5..width - 5 {
            let want = if board(x) { slanted } else { Vec3::NEG_Z };
            errors.push(Vec3::from_slice(&features.image.pixel(x, y)[7..10]).angle_between(want).to_degrees());
        }
    }
    errors.sort_by(f32::total_cmp);
    let (median, p95) = (errors[errors.len() / 2], errors[errors.len() * 95 / 100]);
    assert!(median < 2.5 && p95 < 8.0, "median {median}, 95 % {p95} degrees");
    assert_eq!(features.depth_confidence.pixel(160, 110)[0], 0.0);
    // The hole is filled with the board's depth.
    let inside = features.image.pixel(160, 110)[3];
    let beside = features.image.pixel(140, 110)[3];
    assert!((inside - beside).abs() < 0.05, "{inside} {beside}");
}

#[test]
fn the_layout_of_a_synthetic_room_is_recovered() {
    let (width, height) = (640, 480);
    for (yaw, pitch, sides) in
        [(0.0, 0.0, [0.5, 0.6, 0.25, 0.3]), (0.2, -0.15, [0.4, 0.9, 0.3, 0.35]), (-0.3, 0.3, [0.8, 0.5, 0.4, 0.3])]
    {
        let camera = camera(yaw, pitch, 0.02, width, height);
        let segments = room_segments(&camera, &sides, width, height);
        let room = RoomView { perspective: &camera, segments: &segments, strokes: &[], layout: None };
        let features = run_with(&photo(width, height), None, Some(room)).unwrap();
        let layout = features.layout.unwrap();
        // Nearly every visible pixel lies on the correct face, at nearly the correct depth.
        let (mut right, mut all, mut worst) = (0, 0, 0.0f64);
        let mut scale = Vec::new();
        for y in (0..height).step_by(5) {
            for x in (0..width).step_by(5) {
                let (z, face) = truth(&camera, &sides, x, y);
                let (z_got, face_got) = truth(&camera, &layout.sides, x, y);
                all += 1;
                right += usize::from(face == face_got);
                scale.push((z_got / z).ln());
            }
        }
        scale.sort_by(f64::total_cmp);
        let middle = scale[scale.len() / 2];
        scale.iter().for_each(|s| worst = worst.max((s - middle).abs()));
        assert!(right as f64 > 0.97 * all as f64, "{yaw}: {right} of {all} {layout:?}, {sides:?}");
        assert!(scale[scale.len() / 20] > middle - 0.1 && scale[scale.len() * 19 / 20] < middle + 0.1, "{layout:?}");
        assert!(features.depth_confidence.data.iter().all(|c| (0.0..=1.0).contains(c)));
        assert!(layout.trust > 0.2, "{layout:?}");
    }
}

#[test]
fn without_segments_the_layout_is_the_prior_room_with_low_confidence() {
    let camera = camera(0.0, 0.0, 0.0, 64, 48);
    let room = RoomView { perspective: &camera, segments: &[], strokes: &[], layout: None };
    let features = run_with(&photo(64, 48), None, Some(room)).unwrap();
    assert_eq!(features.depth_source, DepthSource::Layout);
    assert!(features.depth_confidence.data.iter().all(|&c| c <= 0.05));
    // Segments of zero length or of unknown axis are no evidence either.
    let point = Segment { a: DVec2::ONE, b: DVec2::ONE };
    let segments = [(point, Some(1)), (point, None), (point, Some(9))];
    let room = RoomView { perspective: &camera, segments: &segments, strokes: &[], layout: None };
    assert_eq!(run_with(&photo(64, 48), None, Some(room)).unwrap().image, features.image);
}

#[test]
fn degenerate_depth_has_a_right_answer_or_a_clear_error() {
    let photo = photo(40, 30);
    let constant = |v: f32| Image::from_fn(40, 30, |_, _| [v]).unwrap();
    let with = |image: &Image| run_with(&photo, Some(DepthMap { image, kind: DepthKind::AlongZ }), None);
    for v in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(with(&constant(v)).unwrap_err().kind, crate::error::ErrorKind::Degenerate);
    }
    for v in [1e-30, 1.0, 1e30] {
        let features = with(&constant(v)).unwrap();
        assert!(features.image.data.chunks_exact(CHANNELS).all(|p| p[3].abs() < 1e-6 && p[9] == -1.0), "{v}");
    }
    let wrong_size = Image::new(41, 30, 1).unwrap();
    assert!(with(&wrong_size).unwrap_err().message.contains("41 x 30"));
    assert!(with(&Image::new(40, 30, 3).unwrap()).is_err());
    // In a map with measured values, zeros, infinities and NaN are holes.
    let mixed = |x: usize, y: usize| [[2.0, 0.0, f32::INFINITY, -0.0, f32::NAN, f32::NEG_INFINITY][(x + y) % 6]];
    let features = with(&Image::from_fn(40, 30, mixed).unwrap()).unwrap();
    assert!(features.image.data.chunks_exact(CHANNELS).all(|p| p[3].abs() < 1e-6));
    assert_eq!(features.depth_confidence.data.iter().filter(|&&c| c == 1.0).count(), 40 * 30 / 6);
    // From a single measured pixel, all others are filled.
    let mut one = constant(0.0);
    one.pixel_mut(7, 9)[0] = 3.0;
    let features = with(&one).unwrap();
    assert!(features.image.data.chunks_exact(CHANNELS).all(|p| p[3].abs() < 1e-6));
    assert_eq!(features.depth_confidence.data.iter().filter(|&&c| c > 0.0).count(), 1);
}

#[test]
fn planes_are_exact_beside_holes_and_on_narrow_images() {
    // A slanted plane with random holes in a third of the pixels: the fit is still exact.
    let (width, height) = (90, 70);
    let camera = camera(0.0, 0.0, 0.0, width, height);
    let slanted = Vec3::new(-0.4, 0.2, -1.0).normalize();
    let depth = Image::from_fn(width, height, |x, y| {
        let ray = camera.ray(DVec2::new(x as f64 + 0.5, y as f64 + 0.5)).as_vec3();
        let hole = Rng::new(3, &[x as u64, y as u64]).below(3) == 0;
        [if hole { 0.0 } else { -2.0 / slanted.dot(ray) }]
    })
    .unwrap();
    let room = RoomView { perspective: &camera, segments: &[], strokes: &[], layout: None };
    let map = Some(DepthMap { image: &depth, kind: DepthKind::AlongZ });
    let features = run_with(&photo(width, height), map, Some(room)).unwrap();
    for p in features.image.data.chunks_exact(CHANNELS) {
        assert!(Vec3::from_slice(&p[7..10]).angle_between(slanted) < 2e-3, "{p:?}");
    }
    // Pixels of a single row or column span no plane: their normals face the camera.
    for (w, h) in [(40, 1), (1, 40), (1, 1)] {
        let depth = Image::from_fn(w, h, |x, y| [1.0 + (x + y) as f32]).unwrap();
        let map = Some(DepthMap { image: &depth, kind: DepthKind::AlongZ });
        let features = run_with(&photo(w, h), map, None).unwrap();
        assert!(features.image.data.chunks_exact(CHANNELS).all(|p| p[7..10] == [0.0, 0.0, -1.0]));
    }
}

#[test]
fn saturated_and_grey_photos_have_their_lab() {
    for (channels, value, lab) in [(3, 1.0, [100.0, 0.0, 0.0]), (1, 0.18, [49.496_11, 0.0, 0.0]), (4, 0.0, [0.0; 3])] {
        let mut photo = Image::new(70, 3, channels).unwrap();
        photo.data.fill(value);
        // A fourth channel, such as alpha, is ignored.
        if channels == 4 {
            photo.data.chunks_exact_mut(4).for_each(|p| p[3] = f32::NAN);
        }
        let features = run_with(&photo, None, None).unwrap();
        assert_eq!(features.non_finite, 0);
        for p in features.image.data.chunks_exact(CHANNELS) {
            assert!(p.iter().zip(lab).all(|(a, b)| (a - b).abs() < 1e-4), "{p:?}");
        }
    }
}

#[test]
fn any_photo_has_finite_features() {
    for (w, h) in [(1, 1), (1, 7), (7, 1), (33, 2)] {
        let mut photo = photo(w, h);
        photo.data[0] = f32::NAN;
        let features = run_with(&photo, None, None).unwrap();
        assert_eq!(features.non_finite, 1);
        assert_eq!(features.image.count_non_finite(), 0);
        assert_eq!(features.depth_source, DepthSource::Neutral);
        let depth = Image::from_fn(w, h, |x, y| [(1 + x + y) as f32]).unwrap();
        let features = run_with(&photo, Some(DepthMap { image: &depth, kind: DepthKind::AlongRay }), None).unwrap();
        assert_eq!(features.image.count_non_finite(), 0);
    }
    // The CIELAB values of an image of zeros and ones are exact.
    let bit = |x: usize, y: usize| f32::from(Rng::new(6, &[x as u64, y as u64]).next_f32() < 0.5);
    let features = run_with(&Image::from_fn(31, 23, |x, y| [bit(x, y)]).unwrap(), None, None).unwrap();
    for (i, p) in features.image.data.chunks_exact(CHANNELS).enumerate() {
        assert!((p[0] - 100.0 * bit(i % 31, i / 31)).abs() < 1e-3 && p[1].abs() < 1e-3 && p[2].abs() < 1e-3, "{p:?}");
    }
    let bright = Image::from_fn(4, 4, |_, _| [3e38; 3]).unwrap();
    assert_eq!(run_with(&bright, None, None).unwrap().non_finite, 16);
}

#[test]
fn parameters_out_of_range_are_refused() {
    let photo = photo(4, 4);
    let input = Input { photo: &photo, depth: None, room: None };
    for params in [
        Params { near: 0.0, ..Params::default() },
        Params { near: f32::NAN, ..Params::default() },
        Params { far: 1.0, ..Params::default() },
        Params { normal_radius: 65, ..Params::default() },
    ] {
        let error = run(&input, &params, Monitor::default().job()).unwrap_err();
        assert_eq!(error.kind, crate::error::ErrorKind::InvalidArgument);
    }
}

#[test]
fn the_bits_do_not_depend_on_the_number_of_threads() {
    let (width, height) = (160, 120);
    let camera = camera(0.2, -0.1, 0.0, width, height);
    let segments = room_segments(&camera, &[0.5, 0.6, 0.25, 0.3], width, height);
    let photo = photo(width, height);
    let depth =
        Image::from_fn(width, height, |x, y| [(Rng::new(2, &[x as u64, y as u64]).next_f32() * 3.0 - 0.5)]).unwrap();
    let map = DepthMap { image: &depth, kind: DepthKind::AlongRay };
    let both = |threads: usize| {
        Pool::new(threads).unwrap().run(|| {
            let strokes =
                [(0..4000, true), (9000..15000, false)].map(|(p, positive)| (p.collect::<Vec<u32>>(), positive));
            let strokes = strokes.each_ref().map(|(pixels, positive)| PlaneStroke { pixels, positive: *positive });
            let room = RoomView { perspective: &camera, segments: &segments, strokes: &strokes, layout: None };
            let layout = run_with(&photo, None, Some(room)).unwrap();
            let given = run_with(&photo, Some(map), None).unwrap();
            [layout.image, layout.depth_confidence, given.image, given.depth_confidence]
        })
    };
    assert_eq!(both(1), both(3));
}

#[test]
fn a_cancelled_job_ends_with_an_error() {
    let monitor = Monitor::default();
    monitor.cancel();
    let photo = photo(64, 64);
    let result = run(&Input { photo: &photo, depth: None, room: None }, &Params::default(), monitor.job());
    assert_eq!(result.unwrap_err(), Error::cancelled());
}

#[test]
fn a_room_is_enlarged_to_hold_what_lies_beyond_its_walls_and_no_further() {
    let camera = camera(0.2, -0.3, 0.05, 640, 480);
    let small = Layout { sides: [0.8, 0.7, 0.4, 0.5], score: 0.0, trust: 0.0 };
    let axes = super::box_room::facing_axes(&camera);
    // Both points lie in the plane of the ceiling: the first beyond the back wall, the second beyond the right wall.
    let points = [DVec3::new(0.3, -0.4, 1.6), DVec3::new(0.9, -0.4, 0.9)];
    let pixels = || points.iter().map(|p| axes * *p).map(|c| camera.principal + c.truncate() * (camera.focal / c.z));
    assert_eq!(small.face_of(&camera, pixels().take(1)), Face::Back);
    assert_eq!(small.face_of(&camera, pixels().skip(1)), Face::Right);
    assert_eq!(small.shared_face(&camera, pixels().take(1)), Some(Face::Back));
    assert_eq!(small.shared_face(&camera, pixels()), None);
    let (large, growth) = small.enlarged(Face::Ceiling, &camera, pixels());
    assert!(pixels().all(|p| large.face_of(&camera, std::iter::once(p)) == Face::Ceiling), "{large:?}");
    // Sides are in units of the distance to the back wall, which has moved. In the old unit, the ceiling, the floor and
    // the left wall have kept their places.
    let back = 0.4 / large.sides[2];
    assert!(back > 1.6 && back < 1.8 && (growth - back).abs() < 1e-9, "{back} {growth}");
    let moved = large.sides.map(|side| side * back);
    assert!(
        (moved[0] - 0.8).abs() < 1e-9 && (moved[3] - 0.5).abs() < 1e-9 && moved[1] > 0.9 && moved[1] < 1.0,
        "{moved:?}"
    );
    // Neither of two pixels enlarges the face: the ray of the first meets the ceiling within its present extent, and
    // the ray of the second points down, away from the ceiling.
    let inside = [DVec3::new(0.1, -0.4, 0.8), DVec3::new(0.1, 0.5, 0.8)];
    let pixels = inside.iter().map(|p| axes * *p).map(|c| camera.principal + c.truncate() * (camera.focal / c.z));
    assert_eq!(small.enlarged(Face::Ceiling, &camera, pixels), (small, 1.0));
}

#[test]
fn lamps_that_continue_regular_rows_may_enlarge_a_room_further_than_others() {
    let camera = camera(0.0, 0.0, 0.0, 640, 480);
    let small = Layout { sides: [0.8, 0.7, 0.4, 0.5], score: 0.0, trust: 0.0 };
    let axes = super::box_room::facing_axes(&camera);
    let pixel = |place: DVec3| {
        let ray = axes * place;
        let at = camera.principal + ray.truncate() * (camera.focal / ray.z);
        (at.y as u32) * 640 + at.x as u32
    };
    // A lamp on the ceiling, and two regions beyond the back wall at 1.4 times the depth of the room.
    let mut mask = Image::new(640, 480, 1).unwrap();
    mask.data[pixel(DVec3::new(0.1, -0.4, 0.95)) as usize] = 1.0;
    let regions = [[pixel(DVec3::new(0.1, -0.4, 1.4))], [pixel(DVec3::new(0.3, -0.4, 1.4))]];
    let enlarged = |regular: [bool; 2]| {
        let beyond = [0, 1].map(|k| RegionBeyond { pixels: &regions[k], is_in_regular_row: regular[k] });
        let lamps = LampsBeyond { mask: &mask, beyond: &beyond, is_uncertain: false, may_leave_out: false };
        small.enlarged_for(&camera, &lamps).map(|(_, held)| held)
    };
    assert_eq!(enlarged([true, true]), Some(vec![0, 1]));
    assert_eq!(enlarged([false, true]), Some(vec![1]));
    assert_eq!(enlarged([false, false]), None);
}

#[test]
fn the_plane_of_a_camera_that_looks_up_is_the_ceiling() {
    // Lines on the ceiling along both of its axes, such as the edges of beams. Two negative strokes lie on beams. If
    // the plane were the back wall, the upper one could lie on the ceiling.
    let (width, height) = (640, 480);
    let camera = camera(0.15, 0.7, 0.0, width, height);
    let project = |p: DVec3| {
        let c = camera.axes * p;
        camera.principal + c.truncate() * (camera.focal / c.z)
    };
    let mut segments = Vec::new();
    for k in 0..9 {
        let at = -1.0 + 0.25 * f64::from(k);
        segments.push((DVec3::new(at, -1.0, 0.6), DVec3::new(at, -1.0, 1.1), 2));
        segments.push((DVec3::new(at, -1.0, 1.1), DVec3::new(at, -1.0, 2.5), 2));
        segments.push((DVec3::new(-1.0, -1.0, 1.6 + at), DVec3::new(1.0, -1.0, 1.6 + at), 0));
    }
    let segments: Vec<(Segment, Option<usize>)> =
        segments.into_iter().map(|(a, b, axis)| (Segment { a: project(a), b: project(b) }, Some(axis))).collect();
    let stroke = |from: [usize; 2], to: [usize; 2]| -> Vec<u32> {
        let at = |t: usize, k: usize| (from[k] * (20 - t) + to[k] * t) / 20;
        (0..=20).map(|t| (at(t, 1) * width + at(t, 0)) as u32).collect()
    };
    let strokes = [
        (stroke([200, 200], [330, 240]), true),
        (stroke([150, 400], [260, 420]), true),
        (stroke([420, 300], [500, 340]), true),
        (stroke([210, 20], [230, 80]), false),
        (stroke([560, 380], [568, 384]), false),
    ];
    let strokes: Vec<PlaneStroke> =
        strokes.iter().map(|(pixels, positive)| PlaneStroke { pixels, positive: *positive }).collect();
    let room = RoomView { perspective: &camera, segments: &segments, strokes: &strokes, layout: None };
    let layout = run_with(&photo(width, height), None, Some(room)).unwrap().layout.unwrap();
    let plane = [DVec2::new(265.0, 220.0), DVec2::new(205.0, 410.0), DVec2::new(460.0, 320.0)];
    assert_eq!(layout.shared_face(&camera, plane.into_iter()), Some(Face::Ceiling), "{layout:?}");
}
