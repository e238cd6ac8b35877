//! Tests the target colour of clipped photos against the colour before clipping.

use super::*;
use crate::exec::Pool;
use crate::job::Monitor;
use crate::relight;
use crate::render::{self, World};
use crate::scene::{Camera, Material, Mesh, Scene};
use std::sync::Arc;

const EXACTLY: [Constraint; 3] = [Constraint::Exactly; 3];

fn whole(photo: &Image) -> PhotoColour {
    let mask = |v: f32| Image::from_fn(photo.width, photo.height, |_, _| [v]).unwrap();
    photo_colour(TargetColour::Surface, photo, &mask(1.0), &mask(0.0), Monitor::default().job()).unwrap()
}

fn mean(photo: &Image) -> Vec3 {
    photo.data.chunks_exact(3).map(Vec3::from_slice).sum::<Vec3>() / (photo.width * photo.height) as f32
}

fn clip(photo: &Image) -> Image {
    let mut clipped = photo.clone();
    clipped.data.iter_mut().for_each(|v| *v = v.min(1.0));
    clipped
}

#[test]
fn a_clipped_channel_follows_from_the_others() {
    // A warm plane that grows brighter to one side, and a dark, cool stripe.
    let plane = Image::from_fn(100, 20, |x, y| {
        let light = 0.2 + 0.016 * x as f32;
        if y == 7 { [0.02, 0.02, 0.03] } else { [light, 0.7 * light, 0.4 * light] }
    });
    let truth = plane.unwrap();
    let photo = clip(&truth);
    let found = whole(&photo);
    assert_eq!(found.constraint, EXACTLY);
    let off = |colour: Vec3| (colour / mean(&truth) - 1.0).abs();
    assert!(off(found.colour).max_element() < 0.02, "{found:?} {}", mean(&truth));
    assert!(off(mean(&photo)).x > 0.1);
    // A photo with values above white is not clipped, so its mean is exact.
    assert!((whole(&truth).colour - mean(&truth)).abs().max_element() < 1e-5);
    // The red channel has the clipping value 1 in every pixel, so its target is a lower bound.
    let bright = Image::from_fn(8, 8, |x, _| [1.0, 0.5 + 0.01 * x as f32, 0.3]).unwrap();
    let found = whole(&bright);
    assert_eq!(found.constraint, [Constraint::AtLeast, Constraint::Exactly, Constraint::Exactly]);
    assert!((found.colour - mean(&bright)).abs().max_element() < 1e-6);
    // In a photo that is entirely white, all targets are lower bounds. If only a few pixels are white, the targets are
    // exact.
    let white = Image::from_fn(8, 8, |_, _| [1.0; 3]).unwrap();
    assert_eq!(whole(&white), PhotoColour { colour: Vec3::ONE, constraint: [Constraint::AtLeast; 3] });
    let spark = Image::from_fn(8, 8, |x, y| [if x + y == 0 { 1.0 } else { 0.5 }; 3]).unwrap();
    assert_eq!(whole(&spark).constraint, EXACTLY);
}

/// Recovers the known warm light of a room from a photo in which red and green are clipped on parts of the ceiling.
/// Without estimates for the clipped pixels, the error must be more than three times as large.
#[test]
fn known_light_is_recovered_from_a_clipped_photo() {
    let (size, high) = (4.0, 2.5);
    let (x, y, z) = (Vec3::X * size, Vec3::Y * high, Vec3::Z * size);
    // Use materials without gloss, because the solver leaves gloss out of the mean colour of a target.
    let matt = |albedo: Vec3| Material { ior: 1.0, double_sided: false, ..Material::diffuse("matt", albedo) };
    let lamp = Material { emission: Vec3::new(1000.0, 900.0, 700.0), ..matt(Vec3::ZERO) };
    let side = |corner, u, v, material| Mesh::parallelogram(corner, u, v, material);
    let scene = Scene {
        meshes: vec![
            side(y, x, z, 1),
            side(Vec3::ZERO, z, x, 0),
            side(Vec3::ZERO, x, y, 0),
            side(Vec3::ZERO, y, z, 0),
            side(x, z, y, 0),
            side(z, y, x, 0),
            side(Vec3::new(0.6, 0.2, 1.0), Vec3::Z * 0.8, Vec3::X * 0.8, 2),
        ],
        materials: vec![matt(Vec3::new(0.6, 0.5, 0.4)), matt(Vec3::splat(0.8)), lamp],
        ..Scene::default()
    };
    let (pool, monitor) = (Pool::new(2).unwrap(), Monitor::default());
    let world = World::build(Arc::new(scene), monitor.job()).unwrap();
    // A camera near the floor looks straight up. Its picture shows the whole ceiling and nothing else.
    const SIDE: usize = 80;
    let eye = Vec3::new(size / 2.0, 0.3, size / 2.0);
    let fov = 2.0 * (size / 2.0 / (high - eye.y)).atan();
    let camera = Camera { up: Vec3::Z, ..Camera::look_at(eye, eye + Vec3::Y, fov) };
    let params = render::Params { width: SIDE, height: SIDE, samples: 100, ..render::Params::default() };
    let film = pool.run(|| render::run(&world, &camera, &params, monitor.job(), &mut |_| ()).unwrap());
    // Expose the photo so that the brightest blue, the weakest channel, stays just below white. Then no pixel is
    // clipped in all channels, and every clipped value can be estimated.
    let of_channel = |c: usize| film.beauty.data.iter().skip(c).step_by(3).copied();
    let white = 1.02 * of_channel(2).fold(0.0, f32::max);
    let clipped = of_channel(0).filter(|v| *v > white).count();
    assert!(clipped * 10 > SIDE * SIDE, "{clipped} pixels are clipped");
    let mut photo = film.beauty.clone();
    photo.data.iter_mut().for_each(|v| *v = (*v / white).min(1.0));

    let solve = |colour: Vec3, white: f32, constraint: [Constraint; 3]| {
        let target_triangles = &[(0, 0), (0, 1)];
        let input = relight::Input { world: &world, emitter: 2, target_triangles, target: colour * white };
        let params = relight::Params { constraint, target_error: 0.005, ..relight::Params::default() };
        pool.run(|| relight::run(&input, &params, monitor.job()).unwrap())
    };
    let found = whole(&photo);
    let recovered = solve(found.colour, white, found.constraint);
    let as_it_is = solve(mean(&photo), white, EXACTLY);
    let off = |s: &relight::Solution| (s.scale - 1.0).abs().max_element();
    assert!(off(&recovered) < 0.02 && off(&as_it_is) > 3.0 * off(&recovered), "{recovered:?} {as_it_is:?}");

    // Expose the photo so that red is clipped everywhere. With a lower bound as target for red, the lamp must keep its
    // colour; with an exact target, the lamp must lose red.
    let white = 0.9 * of_channel(0).fold(f32::INFINITY, f32::min);
    let colour = (mean(&film.beauty) / white).with_x(1.0);
    let least = solve(colour, white, [Constraint::AtLeast, Constraint::Exactly, Constraint::Exactly]);
    assert!((least.scale.x - 1.0).abs() < 0.03, "{least:?}");
    assert!(solve(colour, white, EXACTLY).scale.x < 0.9);
}
