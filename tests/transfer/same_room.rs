//! Tests the whole pipeline against a known truth. A room is rendered with known lamps; the transfer from this picture
//! onto the *same* room must reproduce the room's light: the colour within the stated interval, and the intensity up
//! to the exposure.
//!
//! The camera is ideal and sees the whole ceiling from below. Lamps are clipped, as in any photo, but glow, noise and
//! white balance are left to `demo.rs`.

use glam::{Vec3, vec3};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::render::{self, World};
use luxfer::scene::{Camera, Material, Mesh, Scene, surface};
use luxfer::segment::Segmentation;
use luxfer::transfer::{Input, Params, Stage, TargetColour, Transfer};
use std::sync::Arc;

const WIDE: f32 = 4.0;
const HIGH: f32 = 2.6;
/// Width and height of the picture in pixels.
const SIDE: usize = 160;
/// Warm emission of the lamps in cd/m².
const EMISSION: Vec3 = vec3(3000.0, 2300.0, 1500.0);

/// A room with a wooden floor, a red curtain and dark furniture.
fn room() -> Scene {
    let (x, y, z) = (Vec3::X * WIDE, Vec3::Y * HIGH, Vec3::Z * WIDE);
    // Materials have no gloss, because the mean of a target ignores gloss.
    let matt = |name: &str, albedo: Vec3| Material { ior: 1.0, double_sided: false, ..Material::diffuse(name, albedo) };
    let side =
        |name: &str, corner, u, v, material| Mesh { name: name.into(), ..Mesh::parallelogram(corner, u, v, material) };
    Scene {
        meshes: vec![
            side("Ceiling", y, x, z, 0),
            side("Floor", Vec3::ZERO, z, x, 1),
            side("Curtain", Vec3::ZERO, x, y, 2),
            side("Left", Vec3::ZERO, y, z, 3),
            side("Right", x, z, y, 3),
            side("Front", z, y, x, 3),
            side("Table", vec3(2.4, 0.7, 0.6), Vec3::Z * 1.2, Vec3::X * 0.9, 1),
        ],
        materials: vec![
            matt("Plaster", Vec3::splat(0.8)),
            matt("Wood", vec3(0.45, 0.3, 0.18)),
            matt("Red", vec3(0.6, 0.1, 0.08)),
            matt("Paint", Vec3::splat(0.6)),
        ],
        ..Scene::default()
    }
}

/// Emission texture with nine white square lamps.
fn lamps() -> Image {
    let lit = |i: usize| i % 20 >= 7 && i % 20 < 13;
    Image::from_fn(60, 60, |x, y| [f32::from(u8::from(lit(x) && lit(y))); 3]).unwrap()
}

#[test]
fn a_room_gets_its_own_light_back() {
    let (pool, monitor) = (Pool::new(2).unwrap(), Monitor::default());
    let mut truth = room();
    let ceiling = surface::find(&truth, "Ceiling").unwrap();
    surface::place(&mut truth, &ceiling, lamps(), EMISSION).unwrap();
    let eye = vec3(WIDE / 2.0, 0.2, WIDE / 2.0);
    let fov = 2.0 * (WIDE / 2.0 / (HIGH - eye.y)).atan();
    let camera = Camera { up: Vec3::Z, ..Camera::look_at(eye, eye + Vec3::Y, fov) };
    let params = render::Params { width: SIDE, height: SIDE, samples: 48, seed: 5, ..render::Params::default() };
    let world = World::build(Arc::new(truth), monitor.job()).unwrap();
    let film = pool.run(|| render::run(&world, &camera, &params, monitor.job(), &mut |_| ()).unwrap());

    // Expose the picture so that the ceiling is grey and the lamps are clipped.
    let mut sorted = film.beauty.data.clone();
    sorted.sort_by(f32::total_cmp);
    let white = 4.0 * sorted[sorted.len() / 2];
    let mut photo = film.beauty.clone();
    photo.data.iter_mut().for_each(|v| *v = (*v / white).min(1.0));
    let mask = |of: &dyn Fn(&[f32]) -> bool| {
        let value = |x: usize, y: usize| [f32::from(u8::from(of(film.beauty.pixel(x, y))))];
        let image = Image::from_fn(SIDE, SIDE, value).unwrap();
        Some(Arc::new(Segmentation::from_confidence(&image).unwrap()))
    };
    let mut transfer = Transfer::default();
    transfer.results.plane = mask(&|_| true);
    transfer.results.lights = mask(&|pixel| pixel[2] > 0.5 * EMISSION.z);
    transfer.input = Input {
        photo: Some(Arc::new(photo)),
        texture: Some(Arc::new(lamps())),
        scene: Some(Arc::new(room())),
        surface: "Ceiling".into(),
        ..Input::default()
    };
    transfer.params = Params { target: TargetColour::Surface, white_luminance: white, ..Params::default() };
    transfer.params.relight.target_error = 0.005;

    let mut run = |first: Stage, white_luminance: f32| {
        transfer.params.white_luminance = white_luminance;
        pool.run(|| transfer.run(first, Stage::Relight, monitor.job(), |_| {})).unwrap();
        let lit = transfer.results.lit.clone().unwrap();
        let solution = transfer.results.solution.clone().unwrap();
        (lit.scene.materials[lit.placed.material].emission, solution)
    };
    let (found, solution) = run(Stage::Emission, white);
    let off = (found / EMISSION - 1.0).as_dvec3();
    let interval = solution.half_width / solution.scale;
    println!("recovered {found} of {EMISSION}: off by {off}, stated ± {interval}, ΔE2000 {}", solution.delta_e);
    assert!(interval.max_element() <= 0.005, "{solution:?}");
    // Allow 0.004 more than the stated interval: for the noise of the picture itself, and because the mean leaves out
    // the pixels beside lamps.
    assert!(off.abs().cmple(interval + 0.004).all(), "off by {off}, stated ± {interval}");
    let colour = off - (off.x + off.y + off.z) / 3.0;
    assert!(colour.abs().cmple(interval).all(), "the colour is off by {colour}, stated ± {interval}");

    // If the photo's white is stated to be twice as bright, only the intensity changes, also if the texture was placed
    // with the earlier white.
    for first in [Stage::Relight, Stage::Emission] {
        let (brighter, _) = run(first, 2.0 * white);
        assert!((brighter / found - 2.0).abs().max_element() < 1e-3, "from {first:?}: {brighter} {found}");
    }
}
