//! Tests of path sharing: shared paths bring the same light as separate paths, with less variance.

use super::*;
use crate::accel::Ray;
use crate::render::path::{self, PathLength};
use crate::render::sampler::Sampler;
use crate::render::shared::{self, MAX_SHARED, Scratch, Start};
use crate::render::tape::SumTape;

/// A room with every case that path sharing distinguishes: matt, glossy, metal, mirror and glass surfaces, a smooth
/// ball, leaves with alpha, a pane in front of a corner, and a pane outside the view.
fn room() -> Scene {
    let mut scene = everything();
    let materials = scene.materials.len();
    scene.materials.extend([
        Material { ior: 1.5, roughness: 0.5, ..Material::diffuse("paint", Vec3::new(0.7, 0.2, 0.0)) },
        Material { metallic: 1.0, roughness: 0.4, ..Material::diffuse("metal", Vec3::new(0.9, 0.7, 0.4)) },
        Material { transmission: 1.0, ior: 1.0, ..Material::diffuse("nothing", Vec3::ONE) },
        Material { ior: 1.0, ..Material::diffuse("blue", Vec3::new(0.0, 0.0, 0.8)) },
    ]);
    let sheet = Mesh::parallelogram;
    scene.meshes.extend([
        sheet(Vec3::new(-1.5, -0.6, -1.5), Vec3::X * 3.0, Vec3::Y * 2.0, materials),
        sheet(Vec3::new(-1.5, -0.6, -1.5), Vec3::Y * 2.0, Vec3::Z * 3.0, materials + 3),
        sheet(Vec3::new(0.9, -0.6, -0.9), Vec3::X * 0.5, Vec3::Y * 0.7, materials + 1),
        sheet(Vec3::new(-1.0, -0.6, -0.5), Vec3::X * 2.0, Vec3::Y * 0.6, materials + 2),
    ]);
    let ball = inward_sphere(0.3, materials);
    let positions = ball.positions.iter().map(|p| *p + Vec3::new(-0.6, -0.2, -0.6)).collect();
    scene.meshes.push(Mesh { normals: ball.positions.iter().map(|p| -p.normalize()).collect(), positions, ..ball });
    scene
}

/// For each ray, returns the mean of `count` estimates and the variance of one estimate. `make` computes an estimate
/// for each ray from 64 paths of one point sequence.
fn estimates(mut make: impl FnMut(u64) -> [Vec3; MAX_SHARED], count: u64) -> [[DVec3; 2]; MAX_SHARED] {
    let mut sums = [[DVec3::ZERO; 2]; MAX_SHARED];
    for trial in 0..count {
        for (sum, value) in sums.iter_mut().zip(make(trial)) {
            let value = value.as_dvec3();
            *sum = [sum[0] + value, sum[1] + value * value];
        }
    }
    let n = count as f64;
    sums.map(|[sum, squares]| [sum / n, ((squares - sum * sum / n) / (n - 1.0)).max(DVec3::ZERO)])
}

/// Returns neighbouring rays from the viewer's eye towards a point.
fn rays(world: &World, towards: Vec3) -> [Ray; MAX_SHARED] {
    let eye = viewer().position;
    std::array::from_fn(|i| {
        let aside = Vec3::new((i % 4) as f32, (i / 4) as f32, 0.0) * 0.03;
        world.ray(eye, (towards + aside - eye).normalize())
    })
}

fn apart(world: &World, rays: &[Ray; MAX_SHARED], length: PathLength, trial: u64) -> [Vec3; MAX_SHARED] {
    std::array::from_fn(|i| {
        let mut sum = SumTape::default();
        for index in 0..64 {
            let mut sampler = Sampler::new(crate::rng::hash(trial, &[1, i as u64]), index);
            let first = sampler.next();
            path::trace(
                world,
                rays[i],
                medium::Media::NONE,
                (first.fine(2), first.get(3)),
                length,
                &mut sampler,
                &mut sum,
            );
        }
        sum.0 / 64.0
    })
}

fn together(world: &World, rays: &[Ray; MAX_SHARED], length: PathLength, trial: u64) -> [Vec3; MAX_SHARED] {
    let mut sums = [SumTape::default(); MAX_SHARED];
    let mut scratch = Scratch::default();
    for index in 0..64 {
        let start = |i: usize| {
            let mut sampler = Sampler::new(crate::rng::hash(trial, &[2, i as u64]), index);
            let first = sampler.next();
            Start { ray: rays[i], media: medium::Media::NONE, light_u: (first.fine(2), first.get(3)), length, sampler }
        };
        let mut starts: [Start; MAX_SHARED] = std::array::from_fn(start);
        shared::trace(world, &mut starts, &mut sums, &mut scratch);
    }
    sums.map(|s| s.0 / 64.0)
}

#[test]
fn shared_paths_bring_the_same_light() {
    let world = world(room());
    // Look into corners, along edges, at the ball, and through panes and leaves, with few and with unlimited bounces.
    let targets = [
        Vec3::new(-1.4, -0.5, -1.4),
        Vec3::new(0.0, -0.6, -0.4),
        Vec3::new(-0.6, -0.2, -0.3),
        Vec3::new(1.1, -0.3, -0.9),
        Vec3::new(0.2, 0.1, -1.5),
        Vec3::new(-1.5, 0.3, -0.7),
    ];
    let (mut worst, mut tests) = (0f64, 0);
    for towards in targets {
        let rays = rays(&world, towards);
        for max_bounces in [0, 1, 2, 3, path::MAX_BOUNCES] {
            let count = if max_bounces > 3 { 96 } else { 32 };
            let length = PathLength { max_bounces, roulette_weight: Some(Vec3::splat(0.7)) };
            let own = estimates(|trial| apart(&world, &rays, length, trial), count);
            let shared = estimates(|trial| together(&world, &rays, length, trial), count);
            for ([a, va], [b, vb]) in own.into_iter().zip(shared) {
                for c in 0..3 {
                    let error = ((va[c] + vb[c]) / count as f64).sqrt();
                    let distance = (a[c] - b[c]).abs();
                    worst = worst.max(if distance < 1e-5 * a[c].max(1e-9) { 0.0 } else { distance / error });
                    tests += 1;
                }
            }
        }
    }
    // The 720 deviations, in standard errors, follow Student's t with at least 62 degrees of freedom. The probability
    // that any of them exceeds 6 is about 1e-4.
    assert!(tests == 720 && worst < 6.0, "{worst}");
}

#[test]
fn shared_paths_scatter_less() {
    let scene = Scene {
        meshes: vec![inward_sphere(3.0, 0), Mesh::parallelogram(Vec3::new(-0.5, 2.0, -0.5), Vec3::X, Vec3::Z, 1)],
        materials: vec![matt(0.6, 0.0), matt(0.0, 100.0)],
        ..Scene::default()
    };
    let world = world(scene);
    // The rays meet the wall of the sphere above the lamp.
    let rays = rays(&world, Vec3::new(0.0, 2.5, -1.5));
    let length = PathLength { max_bounces: 2, roulette_weight: None };
    let own = estimates(|trial| apart(&world, &rays, length, trial), 64);
    let shared = estimates(|trial| together(&world, &rays, length, trial), 64);
    for ([a, va], [b, vb]) in own.into_iter().zip(shared) {
        let (apart, together) = (va.x / (a.x * a.x), vb.x / (b.x * b.x));
        assert!(together > 0.0 && apart > 3.0 * together, "{apart} {together}");
    }
}
