//! Motion between two frames, against closed forms.

use crate::demo;
use crate::guides::{Motion, Surfaces, deviation, motion};
use crate::image::Image;
use crate::job::Monitor;
use crate::render::World;
use crate::scene::{Camera, Material, Mesh, Scene};
use glam::{Mat3, Vec3};
use std::sync::Arc;

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

/// A camera at the origin that looks along -z.
fn camera() -> Camera {
    Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 1.0)
}

/// Focal length of [`camera`] in pixels.
fn focal_length() -> f32 {
    HEIGHT as f32 / 2.0 / (camera().fov_y / 2.0).tan()
}

/// A square of side `2 * half` about `centre` that faces the camera.
fn square(name: &str, centre: Vec3, half: f32) -> Mesh {
    let corner = centre - Vec3::new(half, half, 0.0);
    let mesh = Mesh::parallelogram(corner, Vec3::X * 2.0 * half, Vec3::Y * 2.0 * half, 0);
    Mesh { name: name.into(), ..mesh }
}

fn traced(scene: Scene, camera: &Camera) -> Surfaces {
    let monitor = Monitor::default();
    let world = World::build(Arc::new(scene), monitor.job()).unwrap();
    Surfaces::trace(&world, camera, WIDTH, HEIGHT, monitor.job()).unwrap()
}

fn frame(meshes: Vec<Mesh>) -> Surfaces {
    traced(Scene { meshes, materials: vec![Material::default()], ..Scene::default() }, &camera())
}

fn between(now: &Surfaces, before: &Surfaces) -> Motion {
    motion(now, before, Monitor::default().job()).unwrap()
}

fn defined(image: &Image) -> usize {
    image.data.chunks_exact(2).filter(|p| p[0].is_finite()).count()
}

fn is_close(motion: &[f32], [x, y]: [f32; 2]) -> bool {
    (motion[0] - x).abs() < 2e-3 && (motion[1] - y).abs() < 2e-3
}

#[test]
fn a_plane_that_slides_parallel_to_the_image_moves_by_focal_length_over_depth() {
    let (depth, shift) = (2.0, Vec3::new(0.1, 0.05, 0.0));
    let at = |offset: Vec3| frame(vec![square("Plane", Vec3::NEG_Z * depth + offset, 5.0)]);
    let (before, now) = (at(Vec3::ZERO), at(shift));
    let image = between(&now, &before).image;
    // The object moves right and up, so its earlier positions lie left and below.
    let expected = [-shift.x, shift.y].map(|v| v * focal_length() / depth);
    let inside = |x: usize, y: usize| {
        let place = [x as f32 + 0.5 + expected[0], y as f32 + 0.5 + expected[1]];
        place[0] >= 0.0 && place[0] < WIDTH as f32 && place[1] >= 0.0 && place[1] < HEIGHT as f32
    };
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let motion = image.pixel(x, y);
            assert!(if inside(x, y) { is_close(motion, expected) } else { motion[0].is_nan() }, "{x} {y} {motion:?}");
        }
    }
}

#[test]
fn a_disc_that_turns_about_the_viewing_direction_moves_in_circles() {
    let turned = |angle: f32| {
        let mut mesh = square("Disc", Vec3::NEG_Z * 2.0, 0.6);
        mesh.positions.iter_mut().for_each(|p| *p = Mat3::from_rotation_z(angle) * *p);
        frame(vec![mesh])
    };
    let angle = 0.1f32;
    let image = between(&turned(angle), &turned(0.0)).image;
    let centre = [WIDTH as f32 / 2.0, HEIGHT as f32 / 2.0];
    let mut seen = 0;
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let [dx, dy] = [x as f32 + 0.5 - centre[0], y as f32 + 0.5 - centre[1]];
            if dx.hypot(dy) < 0.58 * focal_length() / 2.0 {
                // The object was turned by the angle, anticlockwise. Motion leads back, clockwise. In pixels, where y
                // points down, a clockwise rotation is one by the positive angle.
                let (s, c) = angle.sin_cos();
                let expected = [c * dx - s * dy - dx, s * dx + c * dy - dy];
                assert!(is_close(image.pixel(x, y), expected), "{x} {y}: {:?} {expected:?}", image.pixel(x, y));
                seen += 1;
            }
        }
    }
    assert!(seen > 2000);
}

#[test]
fn a_vertex_that_moves_deforms_the_motion_of_its_triangles_only() {
    let before = square("Cloth", Vec3::NEG_Z * 2.0, 0.9);
    let mut now = before.clone();
    // Move vertex 3, the top-left corner. Only the upper triangle contains it: its corners are low = (-0.9, -0.9),
    // high = (0.9, 0.9) and the moved corner, (-0.9, 0.9).
    let shift = Vec3::new(-0.06, 0.09, 0.0);
    now.positions[3] += shift;
    let image = between(&frame(vec![now]), &frame(vec![before])).image;
    let scale = focal_length() / 2.0;
    for y in 0..HEIGHT {
        for x in 0..WIDTH {
            let [px, py] =
                [(x as f32 + 0.5 - WIDTH as f32 / 2.0) / scale, (HEIGHT as f32 / 2.0 - y as f32 - 0.5) / scale];
            if px.abs().max(py.abs()) > 0.89 {
                continue;
            }
            // The lower triangle does not move. On the upper triangle, a point moved by w times the shift, where w is
            // the barycentric weight of the moved corner; the motion leads back, by -w times the shift. Solve
            // p = low + w (moved corner - low) + v (high - low) for w.
            let (a, b) = (Vec3::new(-0.06, 1.8 + 0.09, 0.0), Vec3::new(1.8, 1.8, 0.0));
            let (rx, ry) = (px + 0.9, py + 0.9);
            let w = ((rx * b.y - ry * b.x) / (a.x * b.y - a.y * b.x)).max(0.0);
            let expected = [-w * shift.x * scale, w * shift.y * scale];
            assert!(is_close(image.pixel(x, y), expected), "{x} {y}: {:?} {expected:?}", image.pixel(x, y));
        }
    }
}

#[test]
fn a_place_that_another_object_hid_is_uncovered() {
    let at =
        |x: f32| frame(vec![square("Wall", Vec3::NEG_Z * 2.0, 5.0), square("Card", Vec3::new(x, 0.0, -1.99), 0.3)]);
    // The card lies closer to the wall than the tolerance of depth: only the identity of the objects tells them apart.
    let shift = 0.2;
    let (now, before) = (at(shift), at(0.0));
    let image = between(&now, &before).image;
    let card = focal_length() / 1.99;
    let column = |x: f32| image.pixel((WIDTH as f32 / 2.0 + x * card) as usize, HEIGHT / 2);
    assert!(is_close(column(0.1), [-shift * card, 0.0]), "the card: {:?}", column(0.1));
    assert!(column(-0.2)[0].is_nan(), "the wall that the card hid: {:?}", column(-0.2));
    assert!(is_close(column(-0.4), [0.0, 0.0]) && is_close(column(0.7), [0.0, 0.0]), "the wall");
    let strip = shift * card * 0.6 * card;
    let hidden = WIDTH * HEIGHT - defined(&image);
    assert!((hidden as f32 - strip).abs() < 0.1 * strip, "{hidden} {strip}");
}

#[test]
fn the_back_of_a_sheet_was_not_seen_while_its_front_was() {
    let mut turned = square("Sheet", Vec3::NEG_Z * 2.0, 0.5);
    turned.positions.iter_mut().for_each(|p| p.x = -p.x);
    let front = frame(vec![square("Sheet", Vec3::NEG_Z * 2.0, 0.5)]);
    let back = between(&frame(vec![turned]), &front).image;
    assert!(back.pixel(WIDTH / 2, HEIGHT / 2)[0].is_nan());
    assert!(back.pixel(1, 1)[0].abs() < 1e-3, "the background stays");
}

#[test]
fn the_background_moves_with_the_rotation_of_the_camera_alone() {
    let empty = |camera: &Camera| traced(Scene::default(), camera);
    let mut moved = camera();
    moved.position += Vec3::new(3.0, 1.0, -2.0);
    assert!(between(&empty(&moved), &empty(&camera())).image.data.iter().all(|v| v.abs() < 1e-3));
    let mut turned = camera();
    let angle = 0.05f32;
    turned.forward = Mat3::from_rotation_y(-angle) * turned.forward;
    let motion = between(&empty(&turned), &empty(&camera())).image;
    let [u, v] = [motion.pixel(WIDTH / 2, HEIGHT / 2)[0], motion.pixel(WIDTH / 2, HEIGHT / 2)[1]];
    // The camera turns right. A direction that is now x pixels right of the centre was f tan(angle + atan(x / f))
    // pixels right of it before.
    let f = focal_length();
    let expected = f * (angle + (0.5 / f).atan()).tan() - 0.5;
    assert!((u - expected).abs() < 0.01 && v.abs() < 0.01, "{u} {v} {expected}");
}

#[test]
fn objects_correspond_by_name_and_triangles() {
    let wall = || square("Wall", Vec3::NEG_Z * 3.0, 5.0);
    let chair = |x: f32| square("Chair", Vec3::new(x, 0.0, -2.0), 0.2);
    let two = frame(vec![wall(), chair(-0.5), chair(0.5)]);
    // The order of different objects does not matter, and copies correspond in their order.
    let swapped = between(&frame(vec![chair(-0.5), wall(), chair(0.5)]), &two);
    assert!(swapped.unmatched.is_empty() && swapped.warnings().is_empty());
    assert_eq!(defined(&swapped.image), WIDTH * HEIGHT);
    // A new object, and copies whose number differs, have no counterpart.
    let new = between(&frame(vec![wall(), chair(-0.5), square("Lamp", Vec3::NEG_Z * 2.0, 0.2)]), &two);
    let names: Vec<&str> = new.unmatched.iter().map(|u| u.name.as_str()).collect();
    assert_eq!(names, ["Chair", "Lamp"]);
    let warning = &new.warnings()[0];
    assert!(warning.message.contains("\"Lamp\"") && warning.message.contains("\"Chair\""), "{warning}");
    let pixels: usize = new.unmatched.iter().map(|u| u.pixels).sum();
    assert_eq!(warning.severity, pixels as f64 / (WIDTH * HEIGHT) as f64);
    let place = warning.place.unwrap();
    assert!(new.image.pixel(place.x as usize, place.y as usize)[0].is_nan());
    // A mesh that lists the same triangles in another order counts as another object.
    let mut renumbered = wall();
    renumbered.triangles.swap(0, 1);
    assert_eq!(between(&frame(vec![renumbered]), &frame(vec![wall()])).unmatched.len(), 1);
    assert!(motion(&two, &Surfaces { width: 7, ..two.clone() }, Monitor::default().job()).is_err());
}

#[test]
fn motion_follows_the_camera_and_marks_occlusions() {
    let at = |shift: f32| {
        let scene = demo::sphere_on_table().unwrap();
        let mut camera = scene.cameras[0].clone();
        camera.position += camera.forward.cross(camera.up) * shift;
        traced(scene, &camera)
    };
    let (before, now) = (at(0.0), at(0.06));
    let still = between(&before, &before).image;
    assert!(still.data.iter().all(|v| v.abs() < 1e-2));
    let moved = between(&now, &before).image;
    // If the camera moves right, the picture moves left, and the ball, which is nearer, moves farther than the wall.
    // The previous positions are therefore farther right.
    let row: Vec<f32> = (0..WIDTH).map(|x| moved.pixel(x, 60)[0]).collect();
    let (ball, wall) = (moved.pixel(70, 60)[0], moved.pixel(7, 13)[0]);
    assert!(ball > wall && wall > 0.0, "{ball} {wall} {row:?}");
    // Motion is undefined in the strip that the ball occluded and in the strip that was outside the picture.
    assert!(row.iter().any(|v| v.is_nan()) && defined(&moved) > WIDTH * HEIGHT * 80 / 100);
}

#[test]
fn a_given_motion_is_compared_with_the_true_one() {
    let at = |x: f32| frame(vec![square("Wall", Vec3::NEG_Z * 3.0, 9.0), square("Card", Vec3::new(x, 0.0, -2.0), 0.3)]);
    let (before, now) = (at(0.0), at(0.2));
    let check = |given: &Image| deviation(given, &now, &before, Monitor::default().job()).unwrap();
    let exact = between(&now, &before).image;
    let right = check(&exact);
    assert!(right.wrong == 0 && right.place.is_none() && right.compared == defined(&exact), "{right:?}");
    // A motion of zero everywhere is wrong on the card, except within about one pixel of its outline.
    let static_scene = Image::new(WIDTH, HEIGHT, 2).unwrap();
    let wrong = check(&static_scene);
    let side = 0.6 * focal_length() / 2.0;
    assert!((wrong.wrong as f32 - side * side).abs() < 6.0 * side, "{wrong:?} {side}");
    let [x, y] = wrong.place.unwrap();
    assert!(exact.pixel(x, y)[0] < -1.0);
    // Motion of the opposite sign, as if the vectors led from the previous frame to this one, is wrong.
    let mut opposite = exact.clone();
    opposite.data.iter_mut().for_each(|v| *v = -*v);
    assert!(check(&opposite).wrong > wrong.wrong / 2);
    for bad in [Image::new(3, 3, 2).unwrap(), Image::new(WIDTH, HEIGHT, 1).unwrap()] {
        assert!(deviation(&bad, &now, &before, Monitor::default().job()).is_err());
    }
}
