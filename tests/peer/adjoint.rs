//! Compares derivatives of a room's light with those of Mitsuba 3, whose integrator `prb` computes them by another
//! method (adjoint differentiation): the importance of points on a lamp, and the gradient of the light with respect to
//! the placement of the lamp's texture.
//!
//! Each renderer runs with several seeds, whose scatter gives the variance of its mean. Welch's t-test then compares
//! each number, at a total error probability of 0.1 % for all numbers (Šidák). The seeds are fixed, so the outcome is
//! reproducible.
//!
//! `make setup` installs Mitsuba from PyPI into target/peers; its differentiation needs LLVM as a shared library.
//! If Mitsuba or LLVM is missing, the test is skipped with a message; in continuous integration (CI set) it fails.

use glam::{DVec2, DVec3, Vec2, Vec3};
use luxfer::exec::Pool;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight::{Aspect, Constraint, Goal, Importance, ImportanceParams, Params, Pose, Quantity, TargetGeometry};
use luxfer::scene::{Camera, Material, Mesh, Scene, Texture, TextureRef, gltf};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::Arc;

const CELLS: usize = 64;
/// Cells along the side of a block; the test compares means over blocks.
const BLOCK: usize = 8;
const SEEDS: usize = 16;
const OUR_PATHS: u32 = 1 << 16;
const THEIR_PATHS: u32 = 1 << 15;

/// Placement of the pattern on the ceiling; `mitsuba_adjoint.py` uses the same values.
const POSE: Pose = Pose { offset: DVec2::new(0.15, -0.2), scale: DVec2::ONE, rotation: 0.4 };

fn pattern(u: f64, v: f64) -> f64 {
    use std::f64::consts::TAU;
    1.0 + 0.6 * (TAU * u).sin() + 0.3 * (TAU * v).cos()
}

/// A room with a screen and walls of several colours. Its ceiling emits light, and some points of the ceiling are more
/// important for the light on the floor than others.
fn room() -> Scene {
    let (x, y, z) = (Vec3::X * 3.0, Vec3::Y * 1.5, Vec3::Z * 2.5);
    let matt = |name: &str, colour: [f32; 3]| Material::diffuse(name, Vec3::from_array(colour));
    let mut ceiling = Mesh::parallelogram(y, x, z, 1);
    ceiling.uvs[0] = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    let lamp = Material {
        emission: Vec3::ONE,
        emission_texture: Some(TextureRef::new(0)),
        double_sided: false,
        ..matt("Lamp", [0.6; 3])
    };
    Scene {
        meshes: vec![
            Mesh::parallelogram(Vec3::ZERO, z, x, 0),
            ceiling,
            Mesh::parallelogram(Vec3::ZERO, x, y, 2),
            Mesh::parallelogram(Vec3::ZERO, y, z, 3),
            Mesh::parallelogram(x, z, y, 2),
            Mesh::parallelogram(z, y, x, 4),
            Mesh::parallelogram(Vec3::new(0.8, 0.6, 0.0), Vec3::X * 1.2, Vec3::Z * 1.4, 4),
        ],
        materials: vec![
            matt("Target", [0.5, 0.4, 0.3]),
            lamp,
            matt("Grey", [0.5; 3]),
            matt("Red", [0.8, 0.2, 0.1]),
            matt("Blue", [0.1, 0.3, 0.7]),
        ],
        textures: vec![Texture::new("even", Image::from_fn(CELLS, CELLS, |_, _| [1.0; 3]).unwrap())],
        cameras: vec![Camera::look_at(Vec3::new(1.5, 0.7, 2.4), Vec3::new(1.5, 0.7, 0.0), 1.0)],
        ..Scene::default()
    }
}

/// Mean of each channel in each block of cells.
fn blocks(cells: &[f64]) -> Vec<f64> {
    let across = CELLS / BLOCK;
    let mut sums = vec![0.0; 3 * across * across];
    for (i, value) in cells.iter().enumerate() {
        let (x, y, channel) = (i / 3 % CELLS, i / 3 / CELLS, i % 3);
        sums[3 * (y / BLOCK * across + x / BLOCK) + channel] += value;
    }
    sums
}

/// Our results, one row per seed: the importance of all blocks and the gradient with respect to the pattern's
/// placement, both as changes of the floor's mean irradiance.
fn ours(scene: &Scene) -> Vec<Vec<f64>> {
    let (scene, monitor) = (Arc::new(scene.clone()), Monitor::default());
    let target = [(0, 0), (0, 1)];
    let goal = Goal {
        geometry: TargetGeometry::Surface(&target),
        quantity: Quantity::Incident,
        target: Vec3::ONE,
        aspect: Aspect::Colour,
        constraint: [Constraint::Exactly; 3],
        weight: 1.0,
    };
    // Use one texel per cell, because the map would blur finer texels to the size of its cells.
    let texture = Image::from_fn(CELLS, CELLS, |x, y| {
        let at = |i: usize| (i as f64 + 0.5) / CELLS as f64;
        [pattern(at(x), at(y)) as f32]
    });
    let texture = texture.unwrap();
    let irradiance = |radiance: DVec3| (radiance * std::f64::consts::PI).to_array();
    let row = |seed: u64| {
        let tracing = Params { paths: OUR_PATHS, target_error: 0.0, seed, ..Params::default() };
        let params = ImportanceParams { width: CELLS, height: CELLS, tracing };
        let map = Importance::trace(&scene, 1, &goal, &params, monitor.job()).unwrap();
        let image = map.image().unwrap();
        let cells: Vec<f64> = image.data.iter().map(|v| f64::from(*v) * std::f64::consts::PI).collect();
        let mut row = blocks(&cells);
        let (_, derivatives) = map.value_and_gradient(&texture, &POSE, monitor.job()).unwrap();
        row.extend(derivatives.into_iter().flat_map(irradiance));
        row
    };
    Pool::new(2).unwrap().run(|| (1..=SEEDS as u64).map(row).collect())
}

fn theirs(python: &Path, scene: &Scene) -> Result<Vec<Vec<f64>>, String> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (glb, out) = (folder.join("adjoint.glb"), folder.join("adjoint.mitsuba"));
    std::fs::write(&glb, gltf::export(scene).unwrap()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers/mitsuba_adjoint.py");
    let result = Command::new(python)
        .arg(script)
        .arg("llvm_ad_rgb")
        .arg(&glb)
        .args(["8", "8"])
        .arg(&out)
        .args(["0".to_string(), THEIR_PATHS.to_string(), SEEDS.to_string()])
        .output()
        .unwrap();
    if !result.status.success() {
        return Err(String::from_utf8_lossy(&result.stderr).into_owned());
    }
    let bytes = std::fs::read(&out).unwrap();
    let numbers: Vec<f64> =
        bytes.chunks_exact(4).map(|b| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]))).collect();
    let cells = 3 * CELLS * CELLS;
    assert_eq!(numbers.len(), SEEDS * (cells + 15));
    let row = |row: &[f64]| [blocks(&row[..cells]), row[cells..].to_vec()].concat();
    Ok(numbers.chunks_exact(cells + 15).map(row).collect())
}

#[test]
fn importance_and_slopes_are_mitsubas_adjoint_within_the_joint_confidence_interval() {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join("target/peers/mitsuba/bin/python");
    if !python.exists() {
        assert!(std::env::var_os("CI").is_none(), "{} is not there: run `make setup`", python.display());
        println!("skipped: Mitsuba is not installed; `make setup` installs it");
        return;
    }
    let scene = room();
    let theirs = match theirs(&python, &scene) {
        Err(reason) if reason.contains("LLVM") => {
            assert!(std::env::var_os("CI").is_none(), "{reason}");
            println!("skipped: Mitsuba finds no LLVM to differentiate with");
            return;
        }
        theirs => theirs.unwrap(),
    };
    let ours = ours(&scene);
    let tests = ours[0].len();
    let texels = tests - 15;
    assert_eq!(tests, theirs[0].len());
    let (mut widest, mut worst, mut total) = (0.0f64, 0.0f64, [0.0; 2]);
    for number in 0..tests {
        let difference = crate::statistics::welch(&ours, &theirs, number, tests);
        // Allow 0.4 % for the discretisation of the gradient: the spline that interpolates the pattern loses 1/600 of
        // it, and the cells of the map lose about as much.
        let size = if number < texels { difference.first } else { slope_size(&ours, number, texels) };
        let model = if number < texels { 1e-5 } else { 0.004 } * size;
        assert!(difference.off <= difference.interval + model, "number {number}: {difference:?}");
        widest = widest.max(difference.interval / size);
        worst = worst.max(difference.off / size);
        if number < texels {
            total[0] += difference.first;
            total[1] += difference.second;
        }
    }
    println!(
        "{texels} blocks and {} derivatives differ by up to {:.2} %, the widest interval is {:.2} %; all blocks {:.4} \
         and {:.4}",
        tests - texels,
        100.0 * worst,
        100.0 * widest,
        total[0],
        total[1]
    );
    // The intervals must be narrow, or they would hide errors.
    assert!(widest < 0.3 && (total[0] / total[1] - 1.0).abs() < 0.005, "{widest} {total:?}");
}

/// Size of a channel's gradient: its largest component, because single components may be 0.
fn slope_size(rows: &[Vec<f64>], number: usize, texels: usize) -> f64 {
    let channel = (number - texels) % 3;
    (0..5).map(|i| crate::statistics::statistics(rows, texels + 3 * i + channel).0.abs()).fold(0.0, f64::max)
}
