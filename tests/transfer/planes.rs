//! Tests transfers of several planes of one photo that run together: the ceiling of a room and a wall with sconces.
//!
//! In the first room, the photo shows for each plane the mean light that the plane has under lamps of known strength.
//! The second photo is rendered, so that camera, masks and unwarped planes are found from pixels and strokes.

use glam::{DVec2, Vec2, Vec3, vec3};
use luxfer::error::ErrorKind;
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight;
use luxfer::render::{self, World};
use luxfer::scene::surface::{self, Placed};
use luxfer::scene::{Camera, Material, Mesh, Scene};
use luxfer::segment::{Segmentation, Stroke, StrokeSet};
use luxfer::transfer::{Input, Scale, Stage, Transfer, run_together};
use std::sync::{Arc, OnceLock};

const WIDE: f32 = 4.0;
const HIGH: f32 = 2.6;
const DEEP: f32 = 5.0;
/// Emission in cd/m² of the lamps of the ceiling and of the sconces.
const EMISSION: [Vec3; 2] = [vec3(3000.0, 2700.0, 2200.0), vec3(9000.0, 6000.0, 3000.0)];
/// Luminance of the photos' white in cd/m².
const WHITE: f32 = 400.0;

/// A room whose back wall, at z = 0, is seen from positive z.
fn room() -> Scene {
    let (x, y, z) = (Vec3::X * WIDE, Vec3::Y * HIGH, Vec3::Z * DEEP);
    let matt = |name: &str, albedo: Vec3| Material { ior: 1.0, double_sided: false, ..Material::diffuse(name, albedo) };
    let side =
        |name: &str, corner, u, v, material| Mesh { name: name.into(), ..Mesh::parallelogram(corner, u, v, material) };
    Scene {
        meshes: vec![
            side("Ceiling", y, x, z, 0),
            side("Floor", Vec3::ZERO, z, x, 1),
            side("Back", Vec3::ZERO, x, y, 2),
            side("Left", Vec3::ZERO, y, z, 3),
            side("Right", x, z, y, 3),
            side("Front", z, y, x, 3),
        ],
        materials: vec![
            matt("Plaster", Vec3::splat(0.8)),
            matt("Wood", vec3(0.45, 0.3, 0.18)),
            matt("Paper", vec3(0.5, 0.55, 0.6)),
            matt("Paint", Vec3::splat(0.6)),
        ],
        ..Scene::default()
    }
}

/// The emissive textures: 3 × 4 square lamps on the ceiling, and four sconces in a row on the wall.
fn textures() -> [Image; 2] {
    let square = |v: usize, period: usize| v % period * 5 / period == 2;
    let white = |lit: bool| [f32::from(u8::from(lit)); 3];
    let ceiling = Image::from_fn(60, 60, |x, y| white(square(x, 20) && square(y, 15))).unwrap();
    let wall = Image::from_fn(80, 52, |x, y| white(square(x, 20) && (16..22).contains(&y))).unwrap();
    [ceiling, wall]
}

const SURFACES: [&str; 2] = ["Ceiling", "Back"];

/// The room under its true lamps.
fn truth() -> (Arc<Scene>, Vec<Placed>) {
    let mut scene = room();
    let surfaces = SURFACES.map(|name| surface::find(&scene, name).unwrap());
    let lights = surfaces.iter().zip(textures()).zip(EMISSION).map(|((s, t), e)| (s, t, e)).collect();
    let placed = surface::place_all(&mut scene, lights).unwrap();
    (Arc::new(scene), placed)
}

/// The mean radiance of both planes beside their lamps, under the true lamps.
fn light_of_planes() -> &'static [Vec3; 2] {
    static LIGHT: OnceLock<[Vec3; 2]> = OnceLock::new();
    LIGHT.get_or_init(|| {
        let (scene, placed) = truth();
        let monitor = Monitor::default();
        let world = World::build(scene, monitor.job()).unwrap();
        [0, 1].map(|k| {
            let triangles = [(placed[k].mesh, 0), (placed[k].mesh, 1)];
            let emitter = placed[k].material;
            let input =
                relight::Input { world: &world, emitter, target_triangles: &triangles, target: Vec3::splat(1e6) };
            let params = relight::Params { target_error: 0.002, seed: 99, ..relight::Params::default() };
            let solution = Pool::new(2).unwrap().run(|| relight::run(&input, &params, monitor.job()).unwrap());
            (solution.response + solution.background).as_vec3()
        })
    })
}

/// The transfers of both planes. The left half of the photo is the ceiling, the right half the wall; the bottom row of
/// pixels are lamps.
fn transfers(target_error: f32) -> [Transfer; 2] {
    let light = light_of_planes();
    let colour = |x: usize, y: usize| if y == 19 { Vec3::ONE } else { light[x / 20] / WHITE };
    let photo = Arc::new(Image::from_fn(40, 20, |x, y| colour(x, y).to_array()).unwrap());
    let scene = Arc::new(room());
    let mask = |of: &dyn Fn(usize, usize) -> bool| {
        let image = Image::from_fn(40, 20, |x, y| [f32::from(u8::from(of(x, y)))]).unwrap();
        Some(Arc::new(Segmentation::from_confidence(&image).unwrap()))
    };
    let mut textures = textures().into_iter();
    [0, 1].map(|k| {
        let mut transfer = Transfer::default();
        transfer.results.plane = mask(&|x, _| x / 20 == k);
        transfer.results.lights = mask(&|x, y| x / 20 == k && y == 19);
        transfer.input = Input {
            photo: Some(photo.clone()),
            texture: textures.next().map(Arc::new),
            scene: Some(scene.clone()),
            surface: SURFACES[k].into(),
            ..Input::default()
        };
        transfer.params.white_luminance = WHITE;
        transfer.params.relight.target_error = target_error;
        transfer
    })
}

fn run(transfers: &mut [Transfer], from: Stage, to: Stage) -> luxfer::error::Result<()> {
    let monitor = Monitor::default();
    Pool::new(2).unwrap().run(|| run_together(transfers, from, to, monitor.job(), &mut |_, _| ()))
}

fn emission(transfer: &Transfer) -> Vec3 {
    let lit = transfer.results.lit.as_ref().unwrap();
    lit.scene.materials[lit.placed.material].emission
}

/// Both strengths are recovered within their stated intervals. Two transfers that run apart take all light of a plane
/// for that of its own lamps, so that both are too bright.
#[test]
fn two_planes_are_both_recovered_and_apart_both_are_off() {
    let mut both = transfers(0.005);
    run(&mut both, Stage::Emission, Stage::Relight).unwrap();
    for (transfer, truth) in both.iter().zip(EMISSION) {
        let solution = transfer.results.solution.as_ref().unwrap();
        let (off, interval) = ((emission(transfer) / truth - 1.0).as_dvec3(), solution.half_width / solution.scale);
        println!("together: off by {off}, stated ± {interval}");
        // The targets are estimates too; an error of both grows by the condition of the two equations, which the
        // interval states.
        assert!(off.abs().cmple(1.5 * interval + 0.002).all(), "off by {off}, stated ± {interval}");
        assert!(interval.max_element() < 0.008, "{interval}");
    }
    // Both have one scene, with the light of both planes.
    let [a, b] = both.each_ref().map(|transfer| transfer.results.lit.clone().unwrap());
    assert!(Arc::ptr_eq(&a.scene, &b.scene) && a.placed != b.placed);
    assert_eq!((&a.others[..], &b.others[..]), (&[b.placed.material][..], &[a.placed.material][..]));

    for (k, mut apart) in transfers(0.01).into_iter().enumerate() {
        let monitor = Monitor::default();
        let job = || apart.run(Stage::Emission, Stage::Relight, monitor.job(), |_| ());
        Pool::new(2).unwrap().run(job).unwrap();
        let ratio = emission(&apart) / EMISSION[k];
        println!("{} apart: {ratio}", SURFACES[k]);
        assert!(ratio.min_element() > 1.15, "{} apart: {ratio}", SURFACES[k]);
    }
}

#[test]
fn the_order_of_the_planes_changes_nothing() {
    let mut there = transfers(0.02);
    let mut back = there.clone();
    back.reverse();
    run(&mut there, Stage::Emission, Stage::Relight).unwrap();
    run(&mut back, Stage::Emission, Stage::Relight).unwrap();
    for (a, b) in there.iter().zip(back.iter().rev()) {
        assert_eq!(a.results.solution, b.results.solution);
        let [a, b] = [a, b].map(|transfer| transfer.results.lit.clone().unwrap());
        assert_eq!((a.placed, &a.others, a.texel_size), (b.placed, &b.others, b.texel_size));
        assert_eq!(a.scene.materials, b.scene.materials);
    }
}

#[test]
fn transfers_that_do_not_fit_together_are_named() {
    let wrong = |change: &dyn Fn(&mut Transfer), from: Stage, to: Stage| {
        let mut both = transfers(0.05);
        change(&mut both[1]);
        let error = run(&mut both, from, to).unwrap_err();
        (error.kind, error.message)
    };
    let refused = |change: &dyn Fn(&mut Transfer), parts: &[&str]| {
        let (kind, message) = wrong(change, Stage::Emission, Stage::Relight);
        assert!(parts.iter().all(|part| message.contains(part)), "{message}");
        assert_eq!(kind, ErrorKind::InvalidArgument, "{message}");
    };
    let grey = || Some(Arc::new(Image::from_fn(40, 20, |_, _| [0.5; 3]).unwrap()));
    refused(&|t| t.input.photo = grey(), &["transfers[1]", "photo differs"]);
    refused(&|t| t.input.scene = Some(Arc::new(room())), &["transfers[1]", "scene differs"]);
    refused(&|t| t.params.white_luminance = 1.0, &["transfers[1]", "white_luminance is 1"]);
    refused(&|t| t.params.relight.seed = 2, &["transfers[1]", "relight differs"]);
    refused(&|t| t.input.surface = "Ceiling".into(), &["transfers[0] and transfers[1] light one surface"]);
    refused(&|t| t.params.max_texels = 0, &["transfers[1]: stage Emission: max_texels is 0"]);
    let (kind, message) = wrong(&|t| t.input.surface = "Roof".into(), Stage::Emission, Stage::Relight);
    assert!(kind == ErrorKind::NotFound && message.starts_with("transfers[1]: "), "{message}");
    let (_, message) = wrong(&|t| t.results.lights = None, Stage::Emission, Stage::Relight);
    assert!(message.starts_with("transfers[1]: stage Relight"), "{message}");
    // A photo with equal values is the same photo.
    let mut both = transfers(0.05);
    both[1].input.photo = both[0].input.photo.as_ref().map(|photo| Arc::new((**photo).clone()));
    run(&mut both, Stage::Emission, Stage::Relight).unwrap();
    // The light of planes that were placed together cannot be solved for one of them alone.
    let error = run(&mut both[..1], Stage::Relight, Stage::Relight).unwrap_err();
    assert_eq!(error.kind, ErrorKind::InvalidOperation, "{error}");
    // Textures that were placed apart cannot be solved for together.
    let mut apart = transfers(0.05);
    for transfer in &mut apart {
        run(std::slice::from_mut(transfer), Stage::Emission, Stage::Emission).unwrap();
    }
    let error = run(&mut apart, Stage::Relight, Stage::Relight).unwrap_err();
    assert_eq!(error.kind, ErrorKind::InvalidOperation);
    assert!(error.message.starts_with("transfers[1]: run stage Emission of all transfers in one job"), "{error}");
    assert_eq!(run(&mut [], Stage::View, Stage::View).unwrap_err().kind, ErrorKind::InvalidArgument);
}

/// Width and height of the rendered photo in pixels.
const SIZE: [usize; 2] = [360, 270];

fn camera() -> Camera {
    Camera::look_at(vec3(1.7, 1.3, 4.7), vec3(2.1, 1.75, 0.0), 1.15)
}

/// Pixel of the photo that shows a point of the room.
fn pixel(point: Vec3) -> Vec2 {
    let camera = camera();
    let (at, _) = camera.project(point - camera.position, SIZE[0] as f32 / SIZE[1] as f32).unwrap();
    Vec2::from(at) * Vec2::new(SIZE[0] as f32, SIZE[1] as f32)
}

/// Point of a plane, at texture coordinates.
fn point(k: usize, u: f32, v: f32) -> Vec3 {
    let surface = surface::find(&room(), SURFACES[k]).unwrap();
    surface.origin + surface.u_axis * (u * surface.size.x) + surface.v_axis * (v * surface.size.y)
}

fn stroke(points: &[Vec3], positive: bool) -> Stroke {
    let points: Vec<DVec2> = points.iter().map(|p| pixel(*p).as_dvec2()).collect();
    Stroke::polyline(&points, 2.0, positive, SIZE[0], SIZE[1]).unwrap()
}

/// A photo of the room.
fn photo() -> Arc<Image> {
    static PHOTO: OnceLock<Arc<Image>> = OnceLock::new();
    PHOTO.get_or_init(photograph).clone()
}

fn photograph() -> Arc<Image> {
    let (scene, _) = truth();
    let monitor = Monitor::default();
    let world = World::build(scene, monitor.job()).unwrap();
    let params = render::Params { width: SIZE[0], height: SIZE[1], samples: 24, seed: 5, ..render::Params::default() };
    let pool = Pool::new(2).unwrap();
    let film = pool.run(|| render::run(&world, &camera(), &params, monitor.job(), &mut |_| ()).unwrap());
    let mut photo = film.beauty;
    photo.data.iter_mut().for_each(|v| *v = (*v / WHITE).min(1.0));
    Arc::new(photo)
}

/// The transfers of both planes of the photo with their strokes.
fn photographed() -> [Transfer; 2] {
    let (photo, scene) = (photo(), Arc::new(room()));
    // A line beside the lamps of each plane, and a dot on two lamps.
    let beside = [0, 1].map(|k| [point(k, 0.17, [0.75, 0.2][k]), point(k, 0.83, [0.75, 0.2][k])]);
    let on_lamps = [[(0.5, 0.625), (0.5, 0.875)], [(0.125, 0.365), (0.875, 0.365)]];
    [0, 1].map(|k| {
        let other = &beside[1 - k];
        let strokes = StrokeSet {
            plane: vec![
                stroke(&[beside[k][0], point(k, 0.5, [0.75, 0.6][k]), beside[k][1]], true),
                stroke(other, false),
                stroke(&[vec3(1.0, 0.0, 1.5), vec3(3.0, 0.0, 1.5)], false),
                stroke(&[vec3(0.0, 0.8, 2.0), vec3(0.0, 1.8, 2.0)], false),
                stroke(&[vec3(WIDE, 0.8, 2.0), vec3(WIDE, 1.8, 2.0)], false),
            ],
            lights: on_lamps[k].map(|(u, v)| stroke(&[point(k, u, v)], true)).to_vec(),
        };
        let input = Input {
            photo: Some(photo.clone()),
            strokes,
            scene: Some(scene.clone()),
            surface: SURFACES[k].into(),
            ..Input::default()
        };
        let mut transfer = Transfer { input, ..Transfer::default() };
        // A view straight along the room does not determine the focal length, so it is given.
        transfer.params.rectify.focal = Some(0.5 * SIZE[1] as f64 / (0.5 * f64::from(camera().fov_y)).tan());
        transfer.params.pattern.scale = Scale::Across;
        transfer.params.white_luminance = WHITE;
        transfer.params.relight.target_error = 0.02;
        transfer
    })
}

/// The camera and the features are shared; the ceiling and the wall are each unwarped to their true proportions.
#[test]
fn a_ceiling_and_a_wall_of_one_photo_are_found_and_unwarped() {
    let mut both = photographed();
    run(&mut both, Stage::View, Stage::Relight).unwrap();
    let [a, b] = both.each_ref().map(|transfer| &transfer.results);
    assert!(Arc::ptr_eq(a.view.as_ref().unwrap(), b.view.as_ref().unwrap()));
    let layouts = [a, b].map(|results| results.features.as_ref().unwrap().layout.unwrap());
    println!("{layouts:?}");
    assert!(layouts[0] == layouts[1]);
    assert!(a.features.as_ref().unwrap().image == b.features.as_ref().unwrap().image);

    // Lengths on the plane, from unwarped pixels, against lengths in the room: along both axes, in one unit.
    for (k, results) in [a, b].into_iter().enumerate() {
        let unwarped = results.unwarped.as_ref().unwrap();
        let inverse = unwarped.to_photo.homography.inverse();
        let at = |u: f32, v: f32| inverse.apply(pixel(point(k, u, v)).as_dvec2());
        let size = surface::find(&room(), SURFACES[k]).unwrap().size.as_dvec2();
        let across = at(0.7, 0.75).distance(at(0.3, 0.75)) / (0.4 * size.x);
        let along = at(0.5, 0.6).distance(at(0.5, 0.9)) / (0.3 * size.y);
        println!("{}: {across} and {along} unwarped pixels per metre", SURFACES[k]);
        assert!((across / along).ln().abs() < 0.05, "{}: {across} and {along} pixels per metre", SURFACES[k]);
        // u runs right and v down in the texture, as on the surface.
        let (right, down) = (at(0.7, 0.75) - at(0.3, 0.75), at(0.5, 0.9) - at(0.5, 0.6));
        assert!(right.x > 10.0 * right.y.abs() && down.y > 10.0 * down.x.abs(), "{}: {right} {down}", SURFACES[k]);
        let found = results.emission.as_ref().unwrap().luminaires.len();
        println!("{}: {found} lamps, {:?}", SURFACES[k], results.emission.as_ref().unwrap().error);
        assert_eq!(found, [12, 4][k], "{}", SURFACES[k]);
        // Its mask shows the plane's own lamps, and not those of the other plane.
        let lights = results.lights.as_ref().unwrap();
        let is_lit = |k: usize, u: f32, v: f32| {
            let p = pixel(point(k, u, v));
            lights.mask.pixel(p.x as usize, p.y as usize)[0] > 0.5
        };
        let of_plane =
            [[(0.166, 0.875), (0.5, 0.875), (0.833, 0.875)], [(0.375, 0.365), (0.625, 0.365), (0.875, 0.365)]];
        let own = of_plane[k].iter().filter(|(u, v)| is_lit(k, *u, *v)).count();
        let foreign = of_plane[1 - k].iter().filter(|(u, v)| is_lit(1 - k, *u, *v)).count();
        assert!(own == 3 && foreign == 0, "{}: {own} own lamps, {foreign} of the other plane", SURFACES[k]);
    }
    // The features are computed once. Without the other plane, each has the same camera.
    let mut alone = photographed();
    run(&mut alone, Stage::View, Stage::Features).unwrap();
    let images = alone.each_ref().map(|transfer| transfer.results.features.as_ref().unwrap().image.clone());
    assert!(Arc::ptr_eq(&images[0], &images[1]));
    run(&mut alone[1..], Stage::View, Stage::View).unwrap();
    let view = |transfer: &Transfer| transfer.results.view.as_ref().unwrap().perspective;
    assert_eq!(view(&alone[1]).focal, view(&both[1]).focal);
}

/// A cancelled job and a job that fails at one plane keep what was finished.
#[test]
fn partial_results_stay() {
    let mut both = photographed();
    both[1].input.strokes = StrokeSet::default();

    let nothing = Image::new(SIZE[0], SIZE[1], 1).unwrap();
    run(&mut both, Stage::View, Stage::Lights).unwrap();
    both[1].results.plane = Some(Arc::new(Segmentation::from_confidence(&nothing).unwrap()));
    let error = run(&mut both, Stage::Unwarp, Stage::Relight).unwrap_err();
    assert!(error.message.starts_with("transfers[1]: stage Unwarp: the plane's mask is empty"), "{error}");
    assert!(both[0].results.unwarped.is_some() && both[1].results.unwarped.is_none());

    let monitor = Monitor::default();
    let mut seen = Vec::new();
    let mut both = photographed();
    let job = || {
        run_together(&mut both, Stage::View, Stage::Lights, monitor.job(), &mut |k, results| {
            seen.push(k);
            if results.plane.is_some() && k == 1 {
                monitor.cancel();
            }
        })
    };
    assert_eq!(Pool::new(2).unwrap().run(job).unwrap_err().kind, ErrorKind::Cancelled);
    assert!(both[1].results.plane.is_some() && both[1].results.lights.is_none());
    assert!(seen.contains(&0) && seen.contains(&1));
    assert!(monitor.progress() > 0.0 && monitor.progress() < 1.0);
}
