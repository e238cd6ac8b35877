//! Tests of the whole renderer: closed forms, invariants and statistics. This file has the helpers that several tests
//! share.

pub(super) mod chi2;
mod denoise;
mod energy;
mod extremes;
mod faces;
mod far;
mod film;
mod glare;
mod gonio;
mod illuminance;
mod irradiance;
mod lamp_visibility;
mod layers;
mod luminaires;
mod materials;
mod parts;
mod place;
mod refusal;
mod requirements;
mod shared;
mod solids;
mod vertex_colours;

use super::*;
use crate::error::Error;
use crate::image::Image;
use crate::job::Monitor;
use crate::photometry::faces::{Emits, Faces};
use crate::photometry::opening::Opening;
use crate::scene::{AlphaMode, Environment, Material, Mesh, PunctualLight, Scene, Texture, TextureRef};
use glam::DVec3;
use std::sync::Arc;

/// A diffuse material without a reflecting top layer.
fn matt(albedo: f32, emission: f32) -> Material {
    Material { ior: 1.0, emission: Vec3::splat(emission), ..Material::diffuse("matt", Vec3::splat(albedo)) }
}

/// A ball of 1280 triangles. Its projected area is the projected area of the sphere within 0.08 %.
fn ball(centre: Vec3, diameter: f64) -> Mesh {
    let opening = Opening::Ellipsoid(DVec3::splat(diameter));
    let faces = Faces::new(&opening, Emits { forwards: true, backwards: true }, 0.0);
    let positions = faces.points.iter().map(|p| centre + p.as_vec3()).collect();
    Mesh { positions, triangles: faces.triangles, ..Mesh::default() }
}

/// A closed sphere whose triangles face its centre.
fn inward_sphere(radius: f32, material: usize) -> Mesh {
    let (rows, columns) = (12, 24);
    let mut mesh = Mesh { material, ..Mesh::default() };
    for i in 0..=rows {
        for j in 0..=columns {
            let polar = std::f32::consts::PI * i as f32 / rows as f32;
            let angle = std::f32::consts::TAU * (j % columns) as f32 / columns as f32;
            let sine = if i == rows { 0.0 } else { polar.sin() };
            mesh.positions.push(Vec3::new(sine * angle.cos(), polar.cos(), sine * angle.sin()) * radius);
        }
    }
    for i in 0..rows {
        for j in 0..columns {
            let a = i * (columns + 1) + j;
            let b = a + columns + 1;
            mesh.triangles.extend([[a, b, a + 1], [a + 1, b, b + 1]]);
        }
    }
    mesh
}

fn world(scene: Scene) -> World {
    World::build(Arc::new(scene), Monitor::default().job()).unwrap()
}

fn render(world: &World, camera: &Camera, params: &Params) -> Film {
    run(world, camera, params, Monitor::default().job(), &mut |_| ()).unwrap()
}

struct ContributionSum(DVec3);

impl PathSink for ContributionSum {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.0 += (importance * emission).as_dvec3();
    }
}

/// Returns the mean irradiance at a point (red channel) and its standard error, from independently scrambled
/// sequences.
fn measure(world: &World, point: &SurfacePoint) -> (f64, f64) {
    let (batches, per_batch) = (64, 256);
    let means: Vec<f64> = (0..batches)
        .map(|batch| {
            let mut sum = ContributionSum(DVec3::ZERO);
            (0..per_batch).for_each(|i| irradiance(world, point, 1000 + batch, i, &mut sum));
            sum.0.x / f64::from(per_batch)
        })
        .collect();
    let mean = means.iter().sum::<f64>() / batches as f64;
    let variance = means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (batches * (batches - 1)) as f64;
    (mean, variance.sqrt())
}

fn assert_close(world: &World, point: &SurfacePoint, expected: f64) {
    let (mean, error) = measure(world, point);
    // The second term allows for the rounding of coordinates to f32.
    assert!((mean - expected).abs() < 4.0 * error + 1e-5 * expected, "{mean} ± {error}, expected {expected}");
}

/// The midpoint between corners 0 and 2 of a mesh's first triangle, on its front side. This is the centre of a
/// parallelogram.
fn centre_of(mesh: u32) -> SurfacePoint {
    SurfacePoint { mesh, triangle: 0, barycentric: Vec2::new(0.0, 0.5), front: true }
}

/// Returns the form factor from a small facet to a parallel rectangle `a × b` at distance `c`, one of whose corners
/// lies on the facet's normal.
fn parallel_form_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / p * (y / p).atan() + y / q * (x / q).atan()) / std::f64::consts::TAU
}

/// Returns the form factor from a small facet to a rectangle of width `a` and height `b`, which stands upright on the
/// plane of the facet. The rectangle's plane is at the distance `c` from the facet, and one of the lower corners of the
/// rectangle is the point of that plane nearest to the facet.
fn perpendicular_form_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let r = 1.0 / (1.0 + y * y).sqrt();
    (x.atan() - r * (x * r).atan()) / std::f64::consts::TAU
}

/// A small room with most features of scenes: textures, mirror, glass, gloss, alpha, lamp, punctual light and sky.
fn everything() -> Scene {
    let image = Image::from_fn(16, 16, |x, y| {
        let lit = x % 4 == 1 && y % 4 == 2;
        [f32::from(u8::from(lit)), 0.5 * f32::from(u8::from(lit)), 0.1, if x < 8 { 1.0 } else { 0.3 }]
    });
    let mut meshes = vec![inward_sphere(2.0, 0)];
    meshes.push(Mesh::parallelogram(Vec3::new(-1.0, 1.2, -1.0), Vec3::X * 2.0, Vec3::Z * 2.0, 1));
    for (i, x) in [-1.2, -0.6, 0.0, 0.6].into_iter().enumerate() {
        meshes.push(Mesh::parallelogram(Vec3::new(x, -0.5, -0.8), Vec3::X * 0.5, Vec3::new(0.0, 0.6, -0.2), 2 + i));
    }
    let gloss = Material { base_color: Vec3::new(0.9, 0.6, 0.3), roughness: 0.3, ..Material::default() };
    Scene {
        meshes,
        materials: vec![
            matt(0.7, 0.0),
            Material { emission_texture: Some(TextureRef::new(0)), ..matt(0.0, 300.0) },
            gloss.clone(),
            Material { roughness: 0.0, ..gloss.clone() },
            Material { metallic: 0.0, roughness: 0.1, transmission: 0.9, ..gloss.clone() },
            Material {
                alpha_mode: AlphaMode::Blend,
                base_color_texture: Some(TextureRef::new(0)),
                normal_texture: Some(TextureRef::new(0)),
                metallic: 0.0,
                ..gloss
            },
        ],
        textures: vec![Texture::new("all", image.unwrap())],
        lights: vec![PunctualLight::Point { position: Vec3::new(0.5, 0.5, 1.0), intensity: Vec3::splat(20.0) }],
        environment: Some(Environment::Constant(Vec3::ONE)),
        ..Scene::default()
    }
}

fn viewer() -> Camera {
    Camera::look_at(Vec3::new(0.0, 0.2, 1.5), Vec3::new(0.0, -0.2, -0.8), 1.2)
}
