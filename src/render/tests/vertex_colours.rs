//! Tests of vertex colours: interpolation, opacity, and the bounds of the scene analysis.

use super::*;
use glam::Vec4;

/// A matt sheet under a sky of radiance 1, with vertex colours at its corners (0, 0), (1, 0), (1, 1) and (0, 1).
fn sheet(colours: &[Vec4], alpha_mode: AlphaMode) -> Scene {
    let sheet = Mesh::parallelogram(Vec3::ZERO, Vec3::X, Vec3::NEG_Z, 0);
    Scene {
        meshes: vec![Mesh { colours: colours.to_vec(), ..sheet }],
        materials: vec![Material { alpha_mode, ..matt(0.8, 0.0) }],
        environment: Some(Environment::Constant(Vec3::ONE)),
        ..Scene::default()
    }
}

/// Returns the mean radiance of a small part of the sheet at (`x`, `y`), seen from straight above.
fn seen(scene: Scene, x: f32, y: f32) -> DVec3 {
    let at = Vec3::new(x, 0.0, -y);
    let camera = Camera { up: Vec3::NEG_Z, forward: Vec3::NEG_Y, ..Camera::look_at(at + Vec3::Y, at, 0.001) };
    let film = render(&world(scene), &camera, &Params { width: 1, height: 1, samples: 4096, ..Params::default() });
    Vec3::from_slice(film.beauty.pixel(0, 0)).as_dvec3()
}

#[test]
fn colours_between_vertices_are_interpolated() {
    let corners =
        [Vec4::new(1.0, 0.0, 0.0, 1.0), Vec4::new(0.0, 1.0, 0.0, 1.0), Vec4::ONE, Vec4::new(0.0, 0.0, 1.0, 1.0)];
    // In the triangle of corners 0, 1 and 2, the barycentric weights are 1 - x, x - y and y.
    for (x, y) in [(0.75, 0.25), (0.5, 0.125), (0.9, 0.8)] {
        let wanted = corners[0] * (1.0 - x) + corners[1] * (x - y) + corners[2] * y;
        let found = seen(sheet(&corners, AlphaMode::Opaque), x, y);
        assert!((found - 0.8 * wanted.truncate().as_dvec3()).length() < 0.005, "({x}, {y}): {found} for {wanted}");
    }
}

#[test]
fn alpha_of_vertices_lets_the_sky_through() {
    let corners = [0.0, 1.0, 1.0, 0.0].map(|alpha| Vec4::new(0.5, 0.5, 0.5, alpha));
    // At x = 0.75, the opacity of the sheet is 0.75 and its radiance 0.8 × 0.5 = 0.4. The share 0.25 shows the sky of
    // radiance 1.
    let found = seen(sheet(&corners, AlphaMode::Blend), 0.75, 0.25);
    assert!((found - DVec3::splat(0.75 * 0.4 + 0.25)).length() < 0.02, "{found}");
    // With a cutoff of one half, the sheet ends at its middle.
    for (x, wanted) in [(0.7, 0.4), (0.3, 1.0)] {
        let found = seen(sheet(&corners, AlphaMode::Mask(0.5)), x, 0.25);
        assert!((found - DVec3::splat(wanted)).length() < 0.005, "{x}: {found}");
    }
}

#[test]
fn requirements_include_the_colours_of_vertices() {
    let half = [0.5; 4].map(|v| Vec4::new(v, 0.25, 1.0, 1.0));
    let found = world(sheet(&half, AlphaMode::Opaque)).requirements().clone();
    assert!((found.albedo - Vec3::new(0.4, 0.2, 0.8)).length() < 1e-6, "{}", found.albedo);
    // Another mesh has the same material but no vertex colours, so that the material keeps its full albedo.
    let mut both = sheet(&half, AlphaMode::Blend);
    both.meshes.push(Mesh::parallelogram(Vec3::Y, Vec3::X, Vec3::NEG_Z, 0));
    let found = world(both).requirements().clone();
    assert!((found.albedo - Vec3::splat(0.8)).length() < 1e-6 && !found.alpha, "{}", found.albedo);
    let clear = [1.0, 1.0, 0.5, 1.0].map(|alpha| Vec4::ONE.with_w(alpha));
    assert!(world(sheet(&clear, AlphaMode::Blend)).requirements().alpha);
    assert!(!world(sheet(&clear, AlphaMode::Opaque)).requirements().alpha);
}
