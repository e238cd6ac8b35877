//! The two scenes of a stylisation. The exemplar is a sphere on a table as an artist paints it (StyLit, section 3.1).
//! The target is a still life of other shapes on the same table under the same lamp.
//!
//! Both scenes show the effects of light that artists paint differently: a highlight, a core shadow, the red light that
//! the object reflects onto the table, and the object's cast shadow with a soft edge.

use super::Builder;
use super::shapes::{ball, lathe, mesh_of, moved, sheet};
use crate::error::Result;
use crate::maths;
use crate::scene::{Camera, Environment, Mesh, Scene};
use glam::{Vec2, Vec3};

/// Two opposite corners of the rectangular lamp, which faces the table.
const LAMP: [Vec3; 2] = [Vec3::new(0.12, 0.62, -0.12), Vec3::new(0.34, 0.56, 0.06)];
/// Luminance of the lamp in cd/m². [convention]
const LAMP_LUMINANCE: f32 = 12_000.0;
/// Luminance of the dim surroundings in cd/m², per channel.
const SURROUNDINGS: Vec3 = Vec3::new(120.0, 125.0, 135.0);

/// Builds the exemplar: a glossy red ball on a white table before a white wall. Its objects are named `Ball`, `Table`
/// and `Wall`.
pub fn sphere_on_table() -> Result<Scene> {
    let mut b = stage();
    let red = paint(&mut b);
    let mut sphere = Mesh::default();
    ball(&mut sphere, Vec3::new(0.0, 0.1, 0.0), Vec2::splat(0.1), 96);
    b.add("Ball", red, sphere);
    b.build()
}

/// Builds the target: a vase, a ring and two balls. Its objects are named `Vase`, `Ring`, `Balls`, `Table` and `Wall`.
pub fn still_life() -> Result<Scene> {
    let mut b = stage();
    let red = paint(&mut b);
    let mut vase = Mesh::default();
    lathe(&mut vase, Vec3::new(-0.09, 0.0, -0.06), &vase_profile(), 96);
    b.add("Vase", red, vase);
    let mut ring = Mesh::default();
    torus(&mut ring, 0.062, 0.023);
    let tilt = maths::rotation_3d(Vec3::Z, -0.16) * maths::rotation_3d(Vec3::X, 1.25);
    ring.positions.iter_mut().for_each(|p| *p = tilt * *p);
    ring.normals.iter_mut().for_each(|n| *n = tilt * *n);
    let lowest = ring.positions.iter().fold(f32::MAX, |low, p| low.min(p.y));
    b.add("Ring", red, moved(ring, 18.0, Vec3::new(0.085, -lowest, -0.045)));
    let mut balls = Mesh::default();
    ball(&mut balls, Vec3::new(0.075, 0.042, 0.085), Vec2::splat(0.042), 64);
    ball(&mut balls, Vec3::new(-0.02, 0.024, 0.115), Vec2::splat(0.024), 64);
    b.add("Balls", red, balls);
    b.build()
}

/// Builds the parts that both scenes share: table, wall, lamp, surroundings and camera.
fn stage() -> Builder {
    let mut b = Builder::default();
    let white = b.paint("White", Vec3::splat(0.75), 1.0);
    b.scene.materials[white].ior = 1.0;
    let side = Vec2::new(2.2, 1.9);
    let corner = Vec3::new(-side.x / 2.0, 0.0, 0.95);
    b.add("Table", white, mesh_of(|m| sheet(m, corner, Vec3::X * side.x, Vec3::NEG_Z * side.y, [4, 4])));
    let back = Vec3::new(-1.1, 0.0, -0.48);
    let along = Vec3::new(2.2, 0.0, -0.16);
    b.add("Wall", white, mesh_of(|m| sheet(m, back, along, Vec3::Y * 1.2, [4, 4])));

    let lamp = b.paint("Lamp", Vec3::ZERO, 1.0);
    b.scene.materials[lamp].emission = Vec3::new(1.0, 0.97, 0.9) * LAMP_LUMINANCE;
    b.scene.materials[lamp].double_sided = false;
    let [low, high] = LAMP;
    // Tilt the lamp towards the object on the table.
    let (u, v) = (Vec3::new(high.x - low.x, high.y - low.y, 0.0), Vec3::Z * (high.z - low.z));
    b.add("Lamp", lamp, mesh_of(|m| sheet(m, low, u, v, [1, 1])));
    b.scene.environment = Some(Environment::Constant(SURROUNDINGS));
    b.scene.cameras.push(Camera {
        name: "Camera".into(),
        ..Camera::look_at(Vec3::new(0.0, 0.3, 0.78), Vec3::new(0.0, 0.085, 0.0), 27f32.to_radians())
    });
    b
}

/// Adds the glossy red paint of the objects and returns its index.
fn paint(b: &mut Builder) -> usize {
    let red = b.paint("Red", Vec3::new(0.62, 0.035, 0.03), 0.22);
    b.scene.materials[red].ior = 1.6;
    red
}

/// Returns (radius, height) of the vase along its outside, from the foot to the rim and a little into the neck.
fn vase_profile() -> Vec<Vec2> {
    let corners = [
        (0.034, 0.0),
        (0.036, 0.005),
        (0.058, 0.036),
        (0.073, 0.072),
        (0.067, 0.106),
        (0.044, 0.136),
        (0.028, 0.156),
        (0.027, 0.170),
        (0.040, 0.196),
        (0.037, 0.198),
        (0.023, 0.168),
    ];
    // Interpolate the corners by a Catmull-Rom spline.
    let at = |i: isize| Vec2::from(corners[i.clamp(0, corners.len() as isize - 1) as usize]);
    let steps = 10;
    let mut profile = vec![Vec2::new(0.0, 0.0)];
    for i in 0..corners.len() as isize - 1 {
        let (a, b, c, d) = (at(i - 1), at(i), at(i + 1), at(i + 2));
        for s in 0..steps {
            let t = s as f32 / steps as f32;
            let cubic = (3.0 * b - 3.0 * c + d - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d);
            profile.push((2.0 * b + ((c - a) + cubic * t) * t) / 2.0);
        }
    }
    profile.push(at(corners.len() as isize - 1));
    profile
}

/// Adds a ring about the vertical through the origin. `radius` is the radius of its centre line, `tube` the radius of
/// its cross section.
fn torus(mesh: &mut Mesh, radius: f32, tube: f32) {
    let (around, across) = (128u32, 48u32);
    let first = mesh.positions.len() as u32;
    for i in 0..=around {
        let (s, c) = maths::sin_cos(std::f32::consts::TAU * i as f32 / around as f32);
        for j in 0..=across {
            let (t, r) = maths::sin_cos(std::f32::consts::TAU * j as f32 / across as f32);
            let normal = Vec3::new(r * c, t, -r * s);
            mesh.positions.push(Vec3::new(c, 0.0, -s) * radius + normal * tube);
            mesh.normals.push(normal);
            mesh.uvs[0].push(Vec2::new(i as f32 / around as f32, j as f32 / across as f32));
        }
    }
    for i in 0..around {
        for j in 0..across {
            let at = first + i * (across + 1) + j;
            let next = at + across + 1;
            mesh.triangles.extend([[at, next, next + 1], [at, next + 1, at + 1]]);
        }
    }
}
