//! Bodies of lamps from outlines and masks of known bodies: kinds, sizes, intervals, meshes and bad input.

#[path = "../benches/pendants/bodies.rs"]
#[allow(dead_code)]
mod bodies;

use bodies::{BODIES, Body, Case, Shot};
use glam::{DMat3, DVec2, DVec3, Vec3};
use luxfer::error::{ErrorKind, Result};
use luxfer::geometry::Perspective;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::pendant::{self, Input, Known, Params, Pendants, Placing};
use luxfer::rng::Rng;
use luxfer::scene::Scene;
use std::f64::consts::PI;
use std::slice::from_ref;

fn body(name: &str) -> &'static Body {
    BODIES.iter().find(|b| b.name == name).unwrap()
}

fn fit(shot: &Shot, outlines: &[Vec<DVec2>], hooks: &[DVec2], known: Known, params: Params) -> Result<Vec<Pendants>> {
    let input = Input { camera: &shot.camera, shifted: &[], suspensions: hooks, known };
    pendant::from_outlines(outlines, &input, &params, Monitor::default().job())
}

/// Whether a value agrees with the truth within a share of it.
fn near(value: f64, truth: f64, share: f64) -> bool {
    (value / truth - 1.0).abs() < share
}

/// Without noise, every simple body comes out exactly, with the drop that its suspension implies.
#[test]
fn simple_bodies_are_exact() {
    let shot = Shot::new(20.0, 2.0, 35.0);
    let centre = 3.0 * shot.ray(DVec2::new(1000.0, 300.0)).normalize();
    for body in BODIES.iter().take(9) {
        let outline = shot.outline(body, centre, 240, 0.0, &mut Rng::new(1, &[]));
        let ceiling = centre.z + 1.0;
        let hook = shot.pixel(centre.truncate().extend(ceiling));
        let params = Params { distance: ceiling, ..Params::default() };
        let found = &fit(&shot, &[outline], &[hook], Known::NoLength, params).unwrap()[0];
        let diameter = 2.0 * body.profile().iter().map(|v| v.x).fold(0.0, f64::max);
        assert_eq!(found.kind, body.kind, "{}", body.name);
        assert!(near(found.aspect.value, body.height / diameter, 0.005), "{}: {:?}", body.name, found.aspect);
        assert!(near(found.diameter.value, diameter, 0.005), "{}: {:?}", body.name, found.diameter);
        let drop = 1.0 - 0.5 * body.height;
        assert!(near(found.lamps[0].drop.value, drop, 0.005), "{}: {:?}", body.name, found.lamps[0].drop);
        assert!(found.is_metric && found.lamps[0].residual < 0.02, "{}: {}", body.name, found.lamps[0].residual);
    }
}

/// Enlarging the world about the camera moves no outline, so outlines alone give bounds, and each known length gives
/// the size, whatever it is.
#[test]
fn the_size_needs_a_known_length() {
    let shot = Shot::new(15.0, 0.0, 30.0);
    let body = body("drum");
    let height = 0.8;
    let at = |pixel: DVec2| {
        let ray = shot.ray(pixel);
        ray * (height / ray.z)
    };
    let centres = [at(DVec2::new(500.0, 260.0)), at(DVec2::new(1100.0, 330.0))];
    let outlines = centres.map(|c| shot.outline(body, c, 240, 0.0, &mut Rng::new(1, &[])));
    let (ceiling, top) = (1.5, height + 0.5 * body.height);
    let spacing = centres[0].truncate().distance(centres[1].truncate());
    let hook = shot.pixel(centres[1].truncate().extend(ceiling));
    let params = Params { distance: ceiling, level: true, ..Params::default() };
    let run = |hooks: &[DVec2], known| fit(&shot, &outlines, hooks, known, params).unwrap().remove(0);

    let open = run(&[], Known::NoLength);
    let drop = open.lamps[0].drop;
    assert!(!open.is_metric && drop.value.is_nan() && drop.low == 0.0 && drop.high == ceiling, "{drop:?}");
    let lengths = [Known::Drop(ceiling - top), Known::Diameter(0.4), Known::Spacing(spacing)];
    let known = lengths.into_iter().map(|known| run(&[], known)).chain([run(&[hook], Known::NoLength)]);
    for found in known {
        assert!(near(found.diameter.value, 0.4, 0.005), "{:?}", found.diameter);
        for (lamp, centre) in found.lamps.iter().zip(centres) {
            assert!(near(lamp.drop.value, ceiling - top, 0.01), "{:?}", lamp.drop);
            let off = DVec3::from_array(lamp.centre.map(|c| c.value)).distance(centre);
            assert!(off < 0.01 * centre.length(), "{:?} instead of {centre}", lamp.centre);
        }
    }
}

/// A lamp below the horizon hangs lower than the camera, however far it is.
#[test]
fn a_lamp_below_the_horizon_has_an_unbounded_drop() {
    let shot = Shot::new(-10.0, 0.0, 35.0);
    let centre = 3.0 * shot.ray(DVec2::new(800.0, 700.0)).normalize();
    let outline = shot.outline(body("globe"), centre, 120, 0.0, &mut Rng::new(1, &[]));
    let found = &fit(&shot, &[outline], &[], Known::NoLength, Params::default()).unwrap()[0];
    let drop = found.lamps[0].drop;
    assert!(drop.value.is_nan() && drop.low == 1.0 && drop.high == f64::INFINITY, "{drop:?}");
    assert_eq!(found.diameter.high, f64::INFINITY);
}

/// Of 60 intervals of 95 %, fewer than 51 hold the truth with a probability of 0.1 %.
#[test]
fn intervals_hold_the_truth() {
    let (mut held, mut all, mut right) = (0, 0, 0);
    for number in 0.. {
        let body = &BODIES[number % 8];
        let case = Case::new(body, number, 11, 0.4);
        let Some(hook) = case.suspension else { continue };
        let params = Params { distance: case.ceiling, ..Params::default() };
        let found = fit(&case.shot, from_ref(&case.outline), &[hook], Known::NoLength, params).unwrap().remove(0);
        let drop = found.lamps[0].drop;
        right += usize::from(found.kind == body.kind);
        held += usize::from(drop.low < case.drop(body) && case.drop(body) < drop.high);
        all += 1;
        if all == 60 {
            break;
        }
    }
    assert!(held >= 51, "{held} of {all} intervals hold the true drop");
    assert!(right >= 50, "{right} of {all} kinds are right");
}

/// Standard deviations of an estimated camera: of its pitch and roll in radians, and of the logarithm of its focal
/// length.
const TILT: f64 = 0.01;
const STRETCH: f64 = 0.02;

/// Returns an estimate of a camera, and the cameras that differ from the estimate by one standard deviation.
fn estimated(camera: &Perspective, rng: &mut Rng) -> (Perspective, Vec<Perspective>) {
    let changed = |camera: &Perspective, pitch: f64, roll: f64, stretch: f64| {
        let turn = DMat3::from_rotation_x(TILT * pitch) * DMat3::from_rotation_z(TILT * roll);
        Perspective { focal: camera.focal * (STRETCH * stretch).exp(), axes: turn * camera.axes, ..*camera }
    };
    let estimate = changed(camera, rng.normal(), rng.normal(), rng.normal());
    let shifted = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    (estimate, shifted.map(|[pitch, roll, stretch]| changed(&estimate, pitch, roll, stretch)).to_vec())
}

/// The camera has errors of 0.6° and of 2 % of its focal length. That fewer than 51 of 60 intervals of 95 % hold the
/// truth has a probability of 0.1 %. Intervals that ignore the errors hold it in fewer than half of the cases.
#[test]
fn intervals_hold_errors_of_the_camera() {
    let (mut held, mut all) = ([0; 2], 0);
    for number in 0.. {
        let body = &BODIES[number % 8];
        let case = Case::new(body, number, 11, 0.3);
        let Some(hook) = case.suspension else { continue };
        let (camera, cameras) = estimated(&case.shot.camera, &mut Rng::new(5, &[number as u64]));
        let params = Params { distance: case.ceiling, ..Params::default() };
        for (held, shifted) in held.iter_mut().zip([&[][..], &cameras[..]]) {
            let input = Input { camera: &camera, shifted, suspensions: &[hook], known: Known::NoLength };
            let outlines = [case.outline.clone()];
            let found = pendant::from_outlines(&outlines, &input, &params, Monitor::default().job()).unwrap();
            let drop = found[0].lamps[0].drop;
            *held += usize::from(drop.low < case.drop(body) && case.drop(body) < drop.high);
        }
        all += 1;
        if all == 60 {
            break;
        }
    }
    assert!(held[1] >= 51 && held[0] < 30, "{held:?} of {all} intervals hold the true drop");
}

/// Outlines with a gap, and with a suspension cord in the mask, still give the body.
#[test]
fn occluded_parts_do_not_bend_the_body() {
    let shot = Shot::new(10.0, 0.0, 35.0);
    let centre = 3.0 * shot.ray(DVec2::new(900.0, 300.0)).normalize();
    let mut outline = shot.outline(body("globe"), centre, 240, 0.3, &mut Rng::new(3, &[]));
    let middle = shot.pixel(centre);
    // A cord above the lamp, and an occluder that cuts off a sixth of the outline.
    outline.iter_mut().for_each(|p| {
        let direction = (*p - middle).to_angle().to_degrees();
        if (direction + 90.0).abs() < 4.0 {
            p.y -= 25.0;
        }
        if (20.0..80.0).contains(&direction) {
            *p = middle + 0.8 * (*p - middle);
        }
    });
    let found = &fit(&shot, &[outline], &[], Known::Diameter(0.4), Params::default()).unwrap()[0];
    let off = DVec3::from_array(found.lamps[0].centre.map(|c| c.value)).distance(centre);
    assert!(off < 0.02 * centre.length(), "{off}");
}

/// Draws a picture of a lamp whose radiance falls from 1 at the top to 0.5 at the bottom, and its mask.
fn picture(shot: &Shot, body: &Body, centre: DVec3) -> [Image; 2] {
    let [width, height] = shot.size.to_array().map(|v| v as usize);
    let mut mask = Image::new(width, height, 1).unwrap();
    let mut photo = Image::new(width, height, 3).unwrap();
    let (middle, far) = (shot.pixel(centre), 0.5 * shot.camera.focal / centre.length());
    for y in 0..height {
        for x in 0..width {
            let pixel = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
            let grid = (0..16).map(|k| pixel + DVec2::new(f64::from(k % 4), f64::from(k / 4)) / 4.0 - 0.375);
            let is_near = pixel.distance(middle) < far;
            let seen = if is_near { grid.filter(|p| shot.sees(*p, centre, body)).count() } else { 0 };
            // The height at which the ray enters a drum, as a share of its height above the middle.
            let (ray, radius) = (shot.ray(pixel), (body.radius)(0.5));
            let [a, b] = [ray.truncate().length_squared(), ray.truncate().dot(centre.truncate())];
            let gap = (b * b - a * (centre.truncate().length_squared() - radius * radius)).max(0.0).sqrt();
            let level = ((b - gap) / a * ray.z - centre.z) / body.height;
            let radiance = 0.75 + 0.5 * level.clamp(-0.5, 0.5) as f32;
            let share = seen as f32 / 16.0;
            mask.pixel_mut(x, y)[0] = f32::from(share >= 0.5);
            photo.pixel_mut(x, y).fill(0.05 + share * (radiance - 0.05));
        }
    }
    [photo, mask]
}

#[test]
fn a_mask_gives_the_body_and_its_radiance() {
    let shot = Shot::new(5.0, 1.0, 35.0);
    let centre = 4.0 * shot.ray(DVec2::new(700.0, 400.0)).normalize();
    let body = body("drum");
    let [photo, mask] = picture(&shot, body, centre);
    let input = Input { camera: &shot.camera, shifted: &[], suspensions: &[], known: Known::Diameter(0.4) };
    let run = |refine| {
        let params = Params { refine, ..Params::default() };
        pendant::run(&photo, &mask, &input, &params, Monitor::default().job()).unwrap().remove(0)
    };
    let [rough, fine] = [false, true].map(run);
    for found in [&rough, &fine] {
        assert_eq!(found.kind, body.kind);
        assert!(near(found.aspect.value, 0.7, 0.02), "{:?}", found.aspect);
    }
    // The photo's half level is more precise than the pixels of the mask.
    assert!(fine.lamps[0].residual < 0.5 * rough.lamps[0].residual);
    let radiance = &fine.lamps[0].radiance;
    for (band, value) in radiance.bands.iter().enumerate().take(15).skip(1) {
        let truth = 0.5 + 0.5 * (band as f32 + 0.5) / 16.0;
        assert!((value.x - truth).abs() < 0.03, "band {band}: {value} instead of {truth}");
    }
    assert!(radiance.clipped[2] == 0.0 && radiance.clipped[15] > 0.0, "{:?}", radiance.clipped);
}

/// The mesh is closed, its volume is that of the body, and normals point outwards.
#[test]
fn meshes_are_closed_and_stand_in_the_scene() {
    let shot = Shot::new(0.0, 0.0, 35.0);
    let centre = 3.0 * shot.ray(DVec2::new(800.0, 400.0)).normalize();
    for (name, volume) in [("globe", PI / 6.0), ("drum", 0.175 * PI), ("bowl", PI / 12.0)] {
        let outline = shot.outline(body(name), centre, 240, 0.0, &mut Rng::new(1, &[]));
        let found = &fit(&shot, &[outline], &[], Known::Diameter(0.4), Params::default()).unwrap()[0];
        let mesh = found.body().mesh();
        assert!(mesh.is_closed(), "{name}");
        let six: f32 = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).map(|[a, b, c]| a.dot(b.cross(c))).sum();
        assert!(near(f64::from(six) / 6.0, volume, 0.01), "{name}: {}", six / 6.0);
        for (t, triangle) in mesh.triangles.iter().enumerate() {
            let [a, b, c] = mesh.corners(t);
            let facing = (b - a).cross(c - a).normalize_or_zero();
            assert!(triangle.iter().all(|i| mesh.normals[*i as usize].dot(facing) > 0.7), "{name}: {triangle:?}");
        }
        let mut scene = Scene::default();
        let placing = Placing { diameter: 0.4, luminance: 2000.0 };
        let places = [Vec3::new(0.0, 2.0, 0.0), Vec3::new(1.0, 2.0, 0.0)];
        assert_eq!(found.body().add_to_scene(&mut scene, &places, &placing).unwrap(), 0);
        let tops = scene.meshes.iter().map(|m| m.positions.iter().map(|p| p.y).fold(0.0, f32::max));
        assert!(tops.into_iter().all(|top| (top - 2.0).abs() < 1e-4));
        let nowhere = [Vec3::new(f32::NAN, 0.0, 0.0)];
        assert_eq!(
            found.body().add_to_scene(&mut scene, &nowhere, &placing).unwrap_err().kind,
            ErrorKind::InvalidArgument
        );
    }
}

#[test]
fn bad_input_is_refused_with_advice() {
    let shot = Shot::new(0.0, 0.0, 35.0);
    let photo = Image::new(64, 64, 3).unwrap();
    let input = Input { camera: &shot.camera, shifted: &[], suspensions: &[], known: Known::NoLength };
    let run =
        |mask: &Image| pendant::run(&photo, mask, &input, &Params::default(), Monitor::default().job()).unwrap_err();
    let painted =
        |inside: &dyn Fn(usize, usize) -> bool| run(&Image::from_fn(64, 64, |x, y| [f32::from(inside(x, y))]).unwrap());
    let cases = [
        (painted(&|_, _| false), "empty"),
        (painted(&|x, y| x == 30 && y == 30), "1 x 1"),
        (painted(&|x, _| x < 20), "border"),
        (run(&Image::from_fn(64, 64, |_, _| [f32::NAN]).unwrap()), "empty"),
    ];
    for (error, word) in &cases {
        assert_eq!(error.kind, ErrorKind::Degenerate);
        assert!(error.message.contains(word) && error.message.contains("pa"), "{error}");
    }
    assert_eq!(run(&Image::new(32, 64, 1).unwrap()).kind, ErrorKind::InvalidArgument);

    // A level view of a drum is a square, but no view of a body of revolution is a star.
    let star = |k: usize| {
        let radius = if k % 20 < 10 { 200.0 } else { 60.0 };
        shot.camera.principal + radius * DVec2::from_angle(k as f64 * std::f64::consts::TAU / 200.0)
    };
    let star: Vec<DVec2> = (0..200).map(star).collect();
    let refused =
        |known, params, outline: &[DVec2]| fit(&shot, &[outline.to_vec()], &[], known, params).map(|_| ()).unwrap_err();
    assert_eq!(refused(Known::NoLength, Params::default(), &star).kind, ErrorKind::Degenerate);
    let wrong = [
        (Known::Drop(f64::NAN), Params::default()),
        (Known::Drop(1.0), Params::default()),
        (Known::Diameter(-1.0), Params::default()),
        (Known::NoLength, Params { distance: f64::NAN, ..Params::default() }),
        (Known::NoLength, Params { suspension_error: 0.0, ..Params::default() }),
    ];
    for (known, params) in wrong {
        assert_eq!(refused(known, params, &star).kind, ErrorKind::InvalidArgument);
    }
    let two = fit(&shot, from_ref(&star), &[star[0], star[50]], Known::NoLength, Params::default()).map(|_| ());
    assert!(two.unwrap_err().message.contains("suspensions 0 and 1 are both nearest to lamp 0"));
    assert_eq!(refused(Known::NoLength, Params::default(), &[DVec2::NAN; 30]).kind, ErrorKind::InvalidArgument);
    assert_eq!(refused(Known::NoLength, Params::default(), &star[..5]).kind, ErrorKind::InvalidArgument);
}

/// Straight below a lamp, its outline is a circle: the interval of its height says that it may be anything.
#[test]
fn a_lamp_seen_along_its_axis_has_an_open_height() {
    let shot = Shot::new(90.0, 0.0, 35.0);
    let centre = DVec3::new(0.0, 0.0, 2.0);
    let outline = shot.outline(body("drum"), centre, 240, 0.3, &mut Rng::new(1, &[]));
    let found = &fit(&shot, &[outline], &[], Known::Diameter(0.4), Params::default()).unwrap()[0];
    let widths = found.aspect.high / found.aspect.low;
    assert!(widths > 4.0 || found.probability < 0.95, "{:?} {:?} {}", found.kind, found.aspect, found.probability);
}
