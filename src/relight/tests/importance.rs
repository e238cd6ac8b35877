//! Tests of the importance map against direct tracing, and of reciprocity.

use super::*;
use crate::image::Image;
use crate::rng::Rng;
use crate::scene::{Texture, TextureRef};
use glam::Mat3;

const FLOOR: &[(usize, usize)] = &[(0, 0), (0, 1)];
const SIZE: Vec3 = Vec3::new(4.0, 2.5, 3.0);

fn coloured_room() -> Scene {
    room(SIZE, Vec3::new(0.7, 0.5, 0.3), Vec3::splat(0.8), Vec3::ZERO)
}

fn floor(quantity: Quantity) -> Goal<'static> {
    Goal {
        geometry: TargetGeometry::Surface(FLOOR),
        quantity,
        target: Vec3::ONE,
        aspect: Aspect::Colour,
        constraint: EXACTLY,
        weight: 1.0,
    }
}

fn map(scene: &Scene, cells: usize, error: f32) -> Importance {
    let tracing = Params { target_error: error, ..Params::default() };
    let params = ImportanceParams { width: cells, height: cells, tracing };
    let (scene, monitor) = (Arc::new(scene.clone()), Monitor::default());
    let goal = floor(Quantity::Outgoing);
    Pool::new(2).unwrap().run(|| Importance::trace(&scene, 1, &goal, &params, monitor.job()).unwrap())
}

/// A texture with lamps of several colours and sizes.
fn lamps() -> Texture {
    let mut image = Image::new(64, 64, 3).unwrap();
    let mut rng = Rng::new(5, &[]);
    for _ in 0..12 {
        let (x, y, side) = (rng.below(56), rng.below(56), 2 + rng.below(6));
        let colour = Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) * 1000.0;
        for i in 0..side * side {
            colour.write_to_slice(image.pixel_mut(x + i % side, y + i / side));
        }
    }
    Texture::new("lamps", image)
}

/// The dot product of the map and a texture equals the result of tracing the textured room, within the errors of both,
/// for any placement of the texture.
#[test]
fn a_dot_product_with_the_map_equals_tracing() {
    let scene = coloured_room();
    let map = map(&scene, 32, 0.004);
    let turned =
        Mat3::from_translation(Vec2::new(0.3, 0.1)) * Mat3::from_angle(0.6) * Mat3::from_scale(Vec2::new(1.7, 0.8));
    for placement in [Mat3::IDENTITY, turned] {
        let texture = lamps();
        let response = map.respond(&texture, &placement, Monitor::default().job()).unwrap();
        let mut lit = scene.clone();
        lit.textures.push(texture);
        lit.materials[1].emission = Vec3::ONE;
        lit.materials[1].emission_texture = Some(TextureRef { transform: placement, ..TextureRef::new(0) });
        let direct = solve(&lit, Vec3::ONE, &Params { target_error: 0.004, ..Params::default() }).unwrap();
        for c in 0..3 {
            let direct_error = direct.half_width[c] / direct.scale[c] * direct.response[c] / 2.04;
            let sigma = response.light.standard_error[c].hypot(direct_error);
            let off = (response.light.mean[c] - direct.response[c]).abs();
            let allowed = 4.0 * sigma + response.resolution_difference[c].abs();
            assert!(off < allowed, "channel {c}: {response:?} {direct:?}");
            // The allowed difference must be small; otherwise the test could never fail.
            assert!(allowed < 0.1 * direct.response[c], "{allowed} {}", direct.response[c]);
        }
        // In the closed form, the scale for a target of 1 is the reciprocal of the response.
        let solution = map.solve(&response, Vec3::ONE).unwrap();
        assert!((solution.scale * response.light.mean - 1.0).abs().max_element() < 1e-2);
    }
}

/// Reciprocity: the light per area that the floor gets from a uniform ceiling equals the light per area that the
/// ceiling gets from a uniform floor, all reflections included.
#[test]
fn light_transport_is_reciprocal() {
    let mean = |emitter: usize, target: usize| {
        let mut scene = coloured_room();
        // Give the floor a material of its own, so that either surface can emit.
        scene.materials.push(Material { name: "floor".into(), ..scene.materials[0].clone() });
        scene.meshes[0].material = 2;
        scene.materials[emitter].emission = Vec3::ONE;
        let world = World::build(Arc::new(scene), Monitor::default().job()).unwrap();
        let triangles = [(target, 0), (target, 1)];
        let input = Input { world: &world, emitter, target_triangles: &triangles, target: Vec3::ONE };
        let params = Params { quantity: Quantity::Incident, target_error: 0.003, ..Params::default() };
        Pool::new(2).unwrap().run(|| run(&input, &params, Monitor::default().job()).unwrap())
    };
    // Floor and ceiling have equal area; they are meshes 0 and 1 and have the materials 2 and 1.
    let (down, up) = (mean(1, 0), mean(2, 1));
    for c in 0..3 {
        let relative = |s: &Solution| s.half_width[c] / s.scale[c] / 2.04;
        let sigma = relative(&down).hypot(relative(&up));
        assert!((down.response[c] / up.response[c] - 1.0).abs() < 4.0 * sigma, "{down:?} {up:?}");
        assert!(sigma < 0.003);
    }
}

/// Coarse and fine cells give the same result within their stated errors, and the stated error of the fine cells is
/// smaller.
#[test]
fn cells_limit_the_band() {
    let scene = coloured_room();
    let texture = lamps();
    let job = Monitor::default();
    let respond = |cells| map(&scene, cells, 0.005).respond(&texture, &Mat3::IDENTITY, job.job()).unwrap();
    let (coarse, fine) = (respond(4), respond(32));
    assert!(fine.resolution_difference.abs().max_element() < coarse.resolution_difference.abs().max_element());
    for c in 0..3 {
        let off = (coarse.light.mean[c] - fine.light.mean[c]).abs();
        let sigma = coarse.light.standard_error[c].hypot(fine.light.standard_error[c]);
        assert!(
            off < 4.0 * sigma + coarse.resolution_difference[c].abs() + fine.resolution_difference[c].abs(),
            "{coarse:?} {fine:?}"
        );
    }
}

#[test]
fn a_map_needs_texture_coordinates_and_has_the_same_bits() {
    let mut scene = coloured_room();
    let params = ImportanceParams {
        width: 8,
        height: 8,
        tracing: Params { paths: 1 << 12, target_error: 0.0, ..Params::default() },
    };
    let goal = floor(Quantity::Incident);
    let trace = |scene: &Scene, threads| {
        let (scene, monitor) = (Arc::new(scene.clone()), Monitor::default());
        Pool::new(threads).unwrap().run(|| Importance::trace(&scene, 1, &goal, &params, monitor.job()))
    };
    let image = trace(&scene, 1).unwrap().image().unwrap();
    assert_eq!(image.data, trace(&scene, 3).unwrap().image().unwrap().data);
    // The centre of the ceiling contributes more light to the floor than the corners of the ceiling do.
    assert!(image.rgb(4, 4).x > 1.2 * image.rgb(0, 0).x);
    scene.meshes[1].uvs[0].clear();
    let error = trace(&scene, 1).unwrap_err();
    assert!(error.message.contains("ceiling") && error.message.contains("texture coordinates"), "{error}");
}
