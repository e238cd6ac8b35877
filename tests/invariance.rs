//! Tests that results depend neither on the unit of length, the position and the orientation of a scene, nor on the
//! exposure of a photo, nor on whether it is mirrored or turned.
//!
//! The tests scale by powers of two, which floating-point numbers represent without rounding. So results agree to the
//! bit if no formula contains an absolute length.

use glam::{DVec3, Mat3, Vec3, vec3};
use luxfer::demo::{self, photo};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight::{self, Solution};
use luxfer::render::{self, Film, World};
use luxfer::scene::{Camera, Material, Mesh, PunctualLight, Scene, surface};
use luxfer::segment::{Stroke, StrokeSet};
use luxfer::transfer::{Input, Params, Stage, Transfer};
use std::sync::Arc;

/// A closed room with a lamp in its ceiling, a lacquered box, a mirror and a point light; lengths are multiples of
/// 1/16 m.
fn room() -> (Scene, Camera) {
    let size = vec3(4.0, 2.5, 5.0);
    let [x, y, z] = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
    let matt = |name: &str, albedo: Vec3| Material { ior: 1.0, ..Material::diffuse(name, albedo) };
    let side = |name: &str, corner: Vec3, u: Vec3, v: Vec3, material| Mesh {
        name: name.into(),
        ..Mesh::parallelogram(corner, u, v, material)
    };
    let box_at = vec3(1.5, 0.0, 1.25);
    let mut scene = Scene {
        meshes: vec![
            side("Floor", Vec3::ZERO, z, x, 0),
            side("Ceiling", y, x, z, 1),
            side("Back", Vec3::ZERO, x, y, 1),
            side("Front", z, y, x, 1),
            side("Left", Vec3::ZERO, y, z, 2),
            side("Right", x, z, y, 3),
            side("Top", box_at + vec3(0.0, 0.75, 0.0), Vec3::Z, Vec3::X, 4),
            side("Face", box_at + vec3(0.0, 0.0, 1.0), Vec3::X, Vec3::Y * 0.75, 4),
        ],
        materials: vec![
            matt("Wood", vec3(0.45, 0.3, 0.2)),
            matt("White", Vec3::splat(0.75)),
            matt("Red", vec3(0.6, 0.1, 0.1)),
            Material { metallic: 1.0, roughness: 0.0, ..Material::diffuse("Mirror", Vec3::splat(0.9)) },
            Material { roughness: 0.3, ..Material::diffuse("Lacquer", vec3(0.2, 0.3, 0.5)) },
        ],
        lights: vec![PunctualLight::Point { position: vec3(0.5, 1.0, 4.0), intensity: vec3(9.0, 8.0, 7.0) }],
        ..Scene::default()
    };
    let lamps = Image::from_fn(16, 16, |x, y| [f32::from(u8::from(x % 5 == 2 && y % 6 == 3)); 3]).unwrap();
    let ceiling = surface::find(&scene, "Ceiling").unwrap();
    surface::place(&mut scene, &ceiling, lamps, vec3(4000.0, 3500.0, 3000.0)).unwrap();
    (scene, Camera::look_at(vec3(2.0, 1.25, 4.75), vec3(2.0, 1.0, 0.0), 1.0))
}

/// Rotates the scene and its camera by `turn`, scales them by `unit` and moves them by `to`.
fn mapped((scene, camera): &(Scene, Camera), turn: Mat3, unit: f32, to: Vec3) -> (Scene, Camera) {
    let point = |p: Vec3| turn * p * unit + to;
    let mut scene = scene.clone();
    for mesh in &mut scene.meshes {
        mesh.positions.iter_mut().for_each(|p| *p = point(*p));
        mesh.normals.iter_mut().for_each(|n| *n = turn * *n);
    }
    for light in &mut scene.lights {
        if let PunctualLight::Point { position, intensity } = light {
            // Intensity (luminance times area) scales as the square of length.
            (*position, *intensity) = (point(*position), *intensity * unit * unit);
        }
    }
    let camera = Camera {
        position: point(camera.position),
        forward: turn * camera.forward,
        up: turn * camera.up,
        ..camera.clone()
    };
    (scene, camera)
}

fn picture((scene, camera): &(Scene, Camera), samples: u32) -> Film {
    let (pool, monitor) = (Pool::new(2).unwrap(), Monitor::default());
    let params = render::Params { width: 32, height: 24, samples, ..render::Params::default() };
    let world = World::build(Arc::new(scene.clone()), monitor.job()).unwrap();
    pool.run(|| render::run(&world, camera, &params, monitor.job(), &mut |_| ()).unwrap())
}

/// Number of paths for comparisons in which both runs trace identical paths, so that noise does not matter.
const IDENTICAL_PATHS: u32 = 1 << 12;

/// Index of the ceiling's material, whose emission texture shows the lamps.
fn emitter(scene: &Scene) -> usize {
    scene.materials.iter().position(|m| m.emission_texture.is_some()).unwrap()
}

/// Solves for the factor by which the lamps' emission must be multiplied, for the ceiling to have 40 cd/m².
fn solution((scene, _): &(Scene, Camera), paths: u32) -> Solution {
    let (pool, monitor) = (Pool::new(2).unwrap(), Monitor::default());
    let world = World::build(Arc::new(scene.clone()), monitor.job()).unwrap();
    let emitter = emitter(scene);
    let ceiling = scene.meshes.iter().position(|m| m.material == emitter).unwrap();
    let triangles: Vec<_> = (0..scene.meshes[ceiling].triangles.len()).map(|t| (ceiling, t)).collect();
    let input = relight::Input { world: &world, emitter, target_triangles: &triangles, target: Vec3::splat(40.0) };
    let params = relight::Params { target_error: 0.0, paths, ..relight::Params::default() };
    pool.run(|| relight::run(&input, &params, monitor.job()).unwrap())
}

#[test]
fn the_unit_of_length_changes_nothing() {
    let metres = room();
    let (film, solved) = (picture(&metres, 8), solution(&metres, IDENTICAL_PATHS));
    for power in [-20, -10, 10, 20] {
        let scaled = mapped(&metres, Mat3::IDENTITY, 2f32.powi(power), Vec3::ZERO);
        assert_eq!(picture(&scaled, 8).beauty, film.beauty, "2^{power}");
        assert_eq!(solution(&scaled, IDENTICAL_PATHS).scale, solved.scale, "2^{power}");
    }
}

#[test]
fn the_place_changes_nothing() {
    let here = room();
    let (film, solved) = (picture(&here, 8), solution(&here, IDENTICAL_PATHS));
    // All lengths of the room are multiples of 1/16 m, so f32 represents its coordinates exactly even this far away.
    for place in [vec3(1e6, 0.0, 0.0), vec3(-1e6, 2e5, 1e6)] {
        let moved = mapped(&here, Mat3::IDENTITY, 1.0, place);
        assert_eq!(picture(&moved, 8).beauty, film.beauty, "{place}");
        assert_eq!(solution(&moved, IDENTICAL_PATHS).scale, solved.scale, "{place}");
    }
}

/// In a rotated scene the paths differ, so results agree only within their confidence intervals.
#[test]
fn the_orientation_changes_nothing_but_the_paths() {
    let upright = room();
    let (film, solved) = (picture(&upright, 64), solution(&upright, 1 << 16));
    for (axis, angle) in [(Vec3::Y, 1.0), (vec3(1.0, 2.0, -0.5).normalize(), 2.2)] {
        let turned = mapped(&upright, Mat3::from_axis_angle(axis, angle), 1.0, Vec3::ZERO);
        let again = solution(&turned, 1 << 16);
        let joint = (solved.half_width / solved.scale + again.half_width / again.scale) * 1.5;
        assert!((again.scale / solved.scale - 1.0).abs().cmple(joint).all(), "{solved:?} {again:?}");
        // The standard error of the mean takes the pixels' errors as independent; but pixels share samples, so allow
        // 4.5 standard errors.
        let other = picture(&turned, 64);
        let mean = |film: &Film| film.beauty.data.iter().map(|v| f64::from(*v)).sum::<f64>();
        let variance = |film: &Film| film.variance.data.iter().map(|v| f64::from(*v)).sum::<f64>();
        let sigma = (3.0 * (variance(&film) + variance(&other))).sqrt();
        assert!((mean(&film) - mean(&other)).abs() < 4.5 * sigma, "{} {} ± {sigma}", mean(&film), mean(&other));
    }
}

#[test]
fn the_strength_of_the_lamps_changes_nothing_but_the_answer() {
    let (mut scene, camera) = room();
    scene.lights.clear();
    let emitter = emitter(&scene);
    let emission = scene.materials[emitter].emission;
    let mut scale = |power: i32| {
        scene.materials[emitter].emission = emission * 2f32.powi(power);
        solution(&(scene.clone(), camera.clone()), IDENTICAL_PATHS).scale * 2f64.powi(power)
    };
    let solved = scale(0);
    for power in [-30, -10, 10, 30] {
        assert_eq!(scale(power), solved, "2^{power}");
    }
}

/// Results of the stages for a photo: room axes, and masks of the plane and of its lights.
struct Reading {
    /// Directions of the room's axes in camera space.
    axes: [DVec3; 3],
    plane: Image,
    lights: Image,
}

fn read(photo: Image, strokes: StrokeSet) -> Reading {
    read_with(photo, strokes, Params::default())
}

fn read_with(photo: Image, strokes: StrokeSet, params: Params) -> Reading {
    let (pool, monitor) = (Pool::new(2).unwrap(), Monitor::default());
    let input = Input { photo: Some(Arc::new(photo)), strokes, ..Input::default() };
    let mut transfer = Transfer { input, params, ..Transfer::default() };
    pool.run(|| transfer.run(Stage::View, Stage::Lights, monitor.job(), |_| {})).unwrap();
    let axes = &transfer.results.view.as_ref().unwrap().perspective.axes;
    let mask = |s: &Option<Arc<luxfer::segment::Segmentation>>| s.as_ref().unwrap().mask.clone();
    Reading {
        axes: [axes.x_axis, axes.y_axis, axes.z_axis],
        plane: mask(&transfer.results.plane),
        lights: mask(&transfer.results.lights),
    }
}

/// The largest angle in degrees between an axis of `a` and the nearest axis of `b`; `back` maps the axes of `b` to the
/// camera space of `a`.
fn angle(a: &Reading, b: &Reading, back: impl Fn(DVec3) -> DVec3) -> f64 {
    let nearest = |axis: &DVec3| b.axes.iter().map(|other| back(*other).dot(*axis).abs().min(1.0)).fold(0.0, f64::max);
    a.axes.iter().map(|axis| nearest(axis).acos().to_degrees()).fold(0.0, f64::max)
}

/// Intersection over union of two masks.
fn overlap(a: &Image, b: &Image) -> f64 {
    let both = a.data.iter().zip(&b.data).filter(|(a, b)| **a > 0.5 && **b > 0.5).count();
    let either = a.data.iter().zip(&b.data).filter(|(a, b)| **a > 0.5 || **b > 0.5).count();
    both as f64 / either as f64
}

fn photograph() -> (Image, StrokeSet) {
    let room = demo::exemplar_room().unwrap();
    let camera = room.scene.cameras[room.camera].clone();
    let size = photo::Params { width: 360, height: 240, samples: 16, seed: 2 };
    let (pool, monitor) = (Pool::new(2).unwrap(), Monitor::default());
    let scene = Arc::new(room.scene.clone());
    let (picture, _) = pool.run(|| photo::photograph(scene, &camera, &size, monitor.job())).unwrap();
    (picture, demo::strokes(&room, size.width, size.height).unwrap())
}

/// Rearranges an image and its strokes: pixel (x, y) of the result is pixel `from(x, y)` of `image`.
fn rearranged(
    (image, strokes): &(Image, StrokeSet),
    [width, height]: [usize; 2],
    from: impl Fn(usize, usize) -> [usize; 2],
) -> (Image, StrokeSet) {
    let picture = Image::from_fn(width, height, |x, y| {
        let [x, y] = from(x, y);
        <[f32; 3]>::try_from(image.pixel(x, y)).unwrap()
    });
    let mut to = vec![0; width * height];
    for y in 0..height {
        for x in 0..width {
            let [a, b] = from(x, y);
            to[b * image.width + a] = (y * width + x) as u32;
        }
    }
    let moved = |strokes: &[Stroke]| {
        let stroke = |s: &Stroke| Stroke { pixels: s.pixels.iter().map(|&p| to[p as usize]).collect(), ..*s };
        strokes.iter().map(stroke).collect()
    };
    (picture.unwrap(), StrokeSet { plane: moved(&strokes.plane), lights: moved(&strokes.lights) })
}

/// Difference of two readings: the largest angle between their axes, and the intersection over union of their masks.
struct Difference {
    degrees: f64,
    plane: f64,
    lights: f64,
}

impl Reading {
    /// Compares this reading with `other`, the reading of the rearranged photo. Pixel (x, y) of this photo is at
    /// `place(x, y)` in the rearranged photo, and `turn` maps the rearranged photo's axes back.
    fn differs(
        &self,
        other: &Self,
        place: impl Fn(usize, usize) -> [usize; 2],
        turn: impl Fn(DVec3) -> DVec3,
    ) -> Difference {
        let back = |mask: &Image| {
            let value = |x: usize, y: usize| {
                let [x, y] = place(x, y);
                [mask.pixel(x, y)[0]]
            };
            Image::from_fn(self.plane.width, self.plane.height, value).unwrap()
        };
        Difference {
            degrees: angle(self, other, turn),
            plane: overlap(&self.plane, &back(&other.plane)),
            lights: overlap(&self.lights, &back(&other.lights)),
        }
    }
}

/// The axes do not change, because line detection uses relative brightness. The masks may change at their edges,
/// because CIELAB is linear instead of a cube root for dark colours, which shifts the features of underexposed photos.
#[test]
fn the_exposure_changes_nothing() {
    let (photo, strokes) = photograph();
    let plain = read(photo.clone(), strokes.clone());
    for power in [-10, -3, 3, 10] {
        let mut exposed = photo.clone();
        exposed.data.iter_mut().for_each(|v| *v *= 2f32.powi(power));
        let Difference { degrees, plane, lights } =
            plain.differs(&read(exposed, strokes.clone()), |x, y| [x, y], |axis| axis);
        println!("2^{power}: axes {degrees:.3} degrees, plane {plane:.4}, lights {lights:.4}");
        assert!(degrees < 1e-3 && plane > 0.98 && lights > 0.97, "2^{power}");
    }
}

/// Segments by colour alone, and also with the depth and the normals of the room layout. If two boxes fit about
/// equally well, the layout of the mirrored photo must be the mirror image of the same box.
#[test]
fn a_photo_may_lie_any_way_round() {
    let shot = photograph();
    let (width, height) = (shot.0.width, shot.0.height);
    let mut colours = Params::default();
    colours.plane.channels = 0b111;
    for params in [colours, Params::default()] {
        let plain = read_with(shot.0.clone(), shot.1.clone(), params.clone());
        let check = |name: &str, Difference { degrees, plane, lights }: Difference| {
            println!("{name}: axes {degrees:.3} degrees, plane {plane:.4}, lights {lights:.4}");
            assert!(degrees < 0.2 && plane > 0.99 && lights > 0.99, "{name}");
        };
        let mirror = |x: usize, y: usize| [width - 1 - x, y];
        let (photo, strokes) = rearranged(&shot, [width, height], mirror);
        let mirrored = read_with(photo, strokes, params.clone());
        check("mirrored", plain.differs(&mirrored, mirror, |d| DVec3::new(-d.x, d.y, d.z)));
        let swap = |x: usize, y: usize| [y, x];
        let (photo, strokes) = rearranged(&shot, [height, width], swap);
        let transposed = read_with(photo, strokes, params);
        check("transposed", plain.differs(&transposed, swap, |d| DVec3::new(d.y, d.x, d.z)));
    }
}
