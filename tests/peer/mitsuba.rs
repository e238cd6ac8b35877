//! Compares renderings of a Cornell box, once with bodies of glass, with those of Mitsuba 3, another unbiased path
//! tracer.
//!
//! Each renderer makes several images of the same GLB, which differ only in their seeds. The images are divided into
//! blocks. The scatter of a block's mean among the images gives the variance of its mean over all images, even though
//! samples inside an image are correlated. Welch's t-test compares each channel of each block, and of the whole image,
//! at a total error probability of 0.1 % (Šidák). The seeds are fixed, so the outcome is reproducible.
//!
//! `make setup` installs Mitsuba from PyPI into target/peers. If it is missing, the test is skipped with a message; in
//! continuous integration (CI set) it fails.

use glam::{Quat, Vec3};
use luxfer::exec::Pool;
use luxfer::job::Monitor;
use luxfer::render::{self, World};
use luxfer::scene::{Camera, Material, Mesh, Scene, gltf};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;

use crate::statistics::{Difference, statistics, welch};

const SIDE: usize = 24;
const BLOCK: usize = 4;
const IMAGES: u32 = 16;
/// Paths per pixel of each image.
const PATHS: u32 = 256;
const GLASS_PATHS: u32 = 24;

/// A block that stands on the floor, turned by `angle` (radians) about the vertical; `centre` is that of its base.
fn block(centre: Vec3, size: Vec3, angle: f32, material: usize) -> Vec<Mesh> {
    let turn = Quat::from_rotation_y(angle);
    let [x, y, z] = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z].map(|v| turn * v);
    let low = centre - (x + z) / 2.0;
    vec![
        Mesh::parallelogram(low + y, z, x, material),
        Mesh::parallelogram(low, x, y, material),
        Mesh::parallelogram(low, y, z, material),
        Mesh::parallelogram(low + x + z, -x, y, material),
        Mesh::parallelogram(low + x + z, y, -z, material),
    ]
}

/// The box of Goral et al. (1984) in metres, open to the camera.
fn cornell() -> Scene {
    let matt = |name: &str, colour: [f32; 3]| Material::diffuse(name, Vec3::from_array(colour));
    let (x, y, z) = (Vec3::X * 0.556, Vec3::Y * 0.549, Vec3::Z * 0.559);
    let mut meshes = vec![
        Mesh::parallelogram(Vec3::ZERO, z, x, 0),
        Mesh::parallelogram(y, x, z, 0),
        Mesh::parallelogram(Vec3::ZERO, x, y, 0),
        Mesh::parallelogram(Vec3::ZERO, y, z, 1),
        Mesh::parallelogram(x, z, y, 2),
        Mesh::parallelogram(Vec3::new(0.213, 0.548, 0.227), Vec3::X * 0.13, Vec3::Z * 0.105, 3),
    ];
    meshes.extend(block(Vec3::new(0.37, 0.0, 0.39), Vec3::new(0.165, 0.165, 0.165), -0.29, 0));
    meshes.extend(block(Vec3::new(0.185, 0.0, 0.2), Vec3::new(0.165, 0.33, 0.165), 0.31, 0));
    // The lamp emits downwards only, because light in the narrow gap above it would be noisy in both renderers.
    let emission = Vec3::new(18.4, 15.6, 8.0);
    let lamp = Material { emission, double_sided: false, ..matt("Lamp", [0.78; 3]) };
    let materials = vec![
        matt("White", [0.73, 0.71, 0.68]),
        matt("Red", [0.57, 0.04, 0.04]),
        matt("Green", [0.1, 0.38, 0.08]),
        lamp,
    ];
    let camera = Camera::look_at(Vec3::new(0.278, 0.273, 1.35), Vec3::new(0.278, 0.273, 0.0), 0.686);
    Scene { meshes, materials, cameras: vec![camera], ..Scene::default() }
}

/// A closed box with outward faces; `low` and `high` are its corners.
fn closed_box(low: Vec3, high: Vec3, material: usize) -> Mesh {
    let corner = |i: usize| Vec3::select(glam::BVec3::new(i & 1 > 0, i & 2 > 0, i & 4 > 0), high, low);
    let positions = (0..8).map(corner).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    Mesh { material, positions, triangles, ..Mesh::default() }
}

/// The Cornell box with a block of tinted, absorbing glass and a block of rough glass, under a lamp as large as most of
/// the ceiling, so that both renderers find it through the glass.
fn glass_box() -> Scene {
    let mut scene = cornell();
    scene.meshes.truncate(5);
    scene.meshes.push(Mesh::parallelogram(Vec3::new(0.05, 0.545, 0.05), Vec3::X * 0.456, Vec3::Z * 0.459, 3));
    scene.materials[3].emission = Vec3::new(1.5, 1.2, 1.0);
    let clear = Material {
        name: "Clear".into(),
        base_color: Vec3::new(0.9, 0.95, 1.0),
        metallic: 0.0,
        roughness: 0.0,
        transmission: 1.0,
        thickness: 1.0,
        attenuation_color: Vec3::new(0.3, 0.8, 0.6),
        attenuation_distance: 0.1,
        ..Material::default()
    };
    let rough = Material {
        name: "Rough".into(),
        base_color: Vec3::ONE,
        roughness: 0.2,
        ior: 1.7,
        attenuation_distance: f32::INFINITY,
        ..clear.clone()
    };
    scene.materials.extend([clear, rough]);
    scene.meshes.push(closed_box(Vec3::new(0.29, 0.01, 0.3), Vec3::new(0.45, 0.17, 0.46), 4));
    scene.meshes.push(closed_box(Vec3::new(0.1, 0.01, 0.12), Vec3::new(0.26, 0.34, 0.28), 5));
    scene
}

/// Mean of each channel in each block of an image; the last three values are the means of the whole image.
fn blocks(pixels: &[f32]) -> Vec<f64> {
    let across = SIDE / BLOCK;
    let mut means = vec![0.0; 3 * (across * across + 1)];
    for (i, v) in pixels.iter().enumerate() {
        let (x, y, channel) = (i / 3 % SIDE, i / 3 / SIDE, i % 3);
        means[3 * (y / BLOCK * across + x / BLOCK) + channel] += f64::from(*v) / (BLOCK * BLOCK) as f64;
        means[3 * across * across + channel] += f64::from(*v) / (SIDE * SIDE) as f64;
    }
    means
}

fn ours(scene: &Scene, paths: u32) -> Vec<Vec<f64>> {
    let monitor = Monitor::default();
    Pool::new(2).unwrap().run(|| {
        let world = World::build(Arc::new(scene.clone()), monitor.job()).unwrap();
        let image = |seed: u32| {
            let params = render::Params {
                width: SIDE,
                height: SIDE,
                samples: paths,
                seed: u64::from(seed),
                ..render::Params::default()
            };
            let film = render::run(&world, &scene.cameras[0], &params, monitor.job(), &mut |_| ()).unwrap();
            blocks(&film.beauty.data)
        };
        (1..=IMAGES).map(image).collect()
    })
}

/// Block means of Mitsuba's images, one row per image. Its scalar back end needs no other software.
fn theirs(python: &Path, scene: &Scene, name: &str, paths: u32) -> Vec<Vec<f64>> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let glb = folder.join(format!("{name}.glb"));
    std::fs::write(&glb, gltf::export(scene).unwrap()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers/mitsuba_render.py");
    let out = folder.join(format!("{name}.mitsuba"));
    let log = folder.join(format!("{name}.mitsuba.log"));
    let mut mitsuba: Child = Command::new(python)
        .arg(script)
        .arg("scalar_rgb")
        .arg(&glb)
        .args([SIDE.to_string(), SIDE.to_string()])
        .arg(&out)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(std::fs::File::create(&log).unwrap())
        .spawn()
        .unwrap();
    let mut jobs = mitsuba.stdin.take().unwrap();
    let mut answers = BufReader::new(mitsuba.stdout.take().unwrap()).lines();
    let mut answer = || {
        let line = answers.find(|line| line.as_ref().is_ok_and(|l| l.starts_with('{')));
        assert!(line.is_some(), "Mitsuba gave up: {}", std::fs::read_to_string(&log).unwrap());
    };
    answer();
    let image = |seed: u32| {
        writeln!(jobs, "{paths} {seed}").unwrap();
        answer();
        let bytes = std::fs::read(&out).unwrap();
        let pixels: Vec<f32> = bytes.chunks_exact(4).map(|b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])).collect();
        assert_eq!(pixels.len(), 3 * SIDE * SIDE);
        blocks(&pixels)
    };
    let images = (1..=IMAGES).map(image).collect();
    drop(jobs);
    mitsuba.wait().unwrap();
    images
}

/// Compares all means of a scene. Returns the number of lit means, the widest interval relative to the mean, and the
/// standard error of the difference of the images' means, relative to the mean; `None` without Mitsuba.
fn compare(scene: &Scene, name: &str, paths: u32) -> Option<(usize, f64, f64)> {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers/mitsuba/bin/python");
    if !python.exists() {
        assert!(std::env::var_os("CI").is_none(), "{} is not there: run `make setup`", python.display());
        println!("skipped: Mitsuba is not installed; `make setup` installs it");
        return None;
    }
    let (ours, theirs) = (ours(scene, paths), theirs(&python, scene, name, paths));
    let tests = ours[0].len();
    // Count the lit blocks: the corners of the image lie outside the box and are black.
    let (mut widest, mut worst, mut lit) = (0.0f64, 0.0f64, 0);
    for number in 0..tests {
        let Difference { first: a, second: b, off, interval } = welch(&ours, &theirs, number, tests);
        assert!(off <= interval + 1e-5 * a, "number {number}: {a} and {b} differ by more than {interval}");
        if a > 0.0 {
            widest = widest.max(interval / a);
            worst = worst.max(off / a);
            lit += 1;
        }
    }
    let (mean, variance) = statistics(&ours, tests - 2);
    let (other, other_variance) = statistics(&theirs, tests - 2);
    println!(
        "{lit} of {tests} means lit; they differ by up to {:.2} %, the widest interval is {:.2} %; image {mean:.4} ± {:.4} and \
         {other:.4} ± {:.4}",
        100.0 * worst,
        100.0 * widest,
        variance.sqrt(),
        other_variance.sqrt()
    );
    Some((lit, widest, (variance + other_variance).sqrt() / mean))
}

#[test]
fn a_cornell_box_is_mitsubas_within_the_joint_confidence_interval() {
    let Some((lit, widest, error)) = compare(&cornell(), "cornell", PATHS) else { return };
    // The intervals must be narrow, or they would hide errors.
    assert!(lit > 90 && widest < 0.15, "{lit} lit, widest interval {widest}");
    assert!(error < 0.004, "the image's mean is not known well enough");
}

#[test]
fn bodies_of_glass_are_mitsubas_within_the_joint_confidence_interval() {
    let Some((lit, widest, error)) = compare(&glass_box(), "glass", GLASS_PATHS) else { return };
    assert!(lit > 90 && widest < 0.4, "{lit} lit, widest interval {widest}");
    assert!(error < 0.004, "the image's mean is not known well enough");
}
