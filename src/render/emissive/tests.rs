//! Tests that points on emitters are sampled in proportion to their emission and with the stated pdf.

use super::*;
use crate::image::Image;
use crate::render::tests::chi2::assert_follows;
use crate::rng::Rng;
use crate::scene::{Material, Mesh, Texture, TextureRef, Wrap};
use glam::Vec3;

/// A slanted triangle whose texture has bright and dark patches, and a parallel triangle without a texture.
fn scene(side: usize, uvs: [Vec2; 3], wrap: Wrap) -> Scene {
    let image = Image::from_fn(side, side / 2 + 1, |x, y| {
        let lit = if (x * 5 + y * 3) % 7 < 3 { (x + 2 * y + 1) as f32 } else { 0.0 };
        [lit, 0.5 * lit, 0.0]
    });
    let mut texture = Texture::new("patches", image.unwrap());
    texture.wrap = [wrap; 2];
    let mesh = |material, offset: Vec3| Mesh {
        material,
        positions: vec![offset, offset + Vec3::new(2.0, 0.3, 0.0), offset + Vec3::new(0.4, 1.0, 0.7)],
        uvs: [uvs.to_vec(), Vec::new()],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    let plain = Material { emission: Vec3::new(0.0, 0.0, 3.0), ..Material::default() };
    let lit = Material { emission_texture: Some(TextureRef::new(0)), emission: Vec3::splat(2.0), ..plain.clone() };
    Scene {
        meshes: vec![mesh(0, Vec3::ZERO), mesh(1, Vec3::Z)],
        materials: vec![lit, plain],
        textures: vec![texture],
        ..Scene::default()
    }
}

fn emitters(scene: &Scene) -> Emitters {
    let facet = |mesh: u32| {
        let m = &scene.meshes[mesh as usize];
        Facet::new(m.corners(0), mesh, m, 0)
    };
    Emitters::build(scene, &[facet(0), facet(1)], &[0, 1, 2]).unwrap().0
}

fn coordinates() -> Vec<[Vec2; 3]> {
    vec![
        [Vec2::ZERO, Vec2::X, Vec2::Y],
        [Vec2::new(-1.7, 0.2), Vec2::new(2.3, 1.9), Vec2::new(0.4, -2.2)],
        [Vec2::new(0.31, 0.4), Vec2::new(0.33, 0.41), Vec2::new(0.32, 0.45)],
    ]
}

/// The index of the emitter and the intensity of every piece.
fn pieces(emitters: &Emitters) -> Vec<(u32, f32)> {
    let uniform = emitters.uniform.iter().map(|e| (e.emitter, e.intensity));
    uniform.chain(emitters.tiles.iter().map(|t| (t.emitter, t.intensity))).collect()
}

fn brightness(emitters: &Emitters, scene: &Scene, emitter: usize, b: Vec2) -> f32 {
    mean_channel(emitters.emitters[emitter].emission(scene, b).0)
}

#[test]
fn points_are_as_dense_as_the_light_they_emit() {
    let mut rng = Rng::new(21, &[]);
    for wrap in [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror] {
        for uvs in coordinates() {
            let scene = scene(9, uvs, wrap);
            let emitters = emitters(&scene);
            let pieces = pieces(&emitters);
            let mut disagreed = 0;
            for i in 0..5000 {
                let piece = i % pieces.len();
                let (emitter, b) = emitters.sample(piece, (rng.next_f64(), rng.next_f32())).unwrap();
                assert!(b.min_element() >= 0.0 && b.element_sum() < 1.0 + 1e-5);
                let (emission, uv) = emitters.emitters[emitter].emission(&scene, b);
                // Emission / pdf equals the intensity of the piece, so a single sample has no variance.
                let estimate = mean_channel(emission) / emitters.area_pdf(piece, emitter, mean_channel(emission));
                let agrees = (estimate / pieces[piece].1 - 1.0).abs() < 1e-5;
                disagreed += usize::from(!agrees || emitters.piece_at(emitter, uv) != Some(piece));
            }
            // A point within rounding of a texel's border may be looked up in the neighbouring texel.
            assert!(disagreed <= 5, "{disagreed} of 5000, {wrap:?}, {uvs:?}");
        }
    }
}

#[test]
fn sampled_points_follow_the_stated_pdf() {
    // Count the samples in bins of barycentric coordinates; integrate the pdf over each bin by fine quadrature.
    let (bins, fine, samples) = (12, 40, 200_000);
    let mut rng = Rng::new(24, &[]);
    let cases: Vec<_> = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror]
        .into_iter()
        .flat_map(|wrap| coordinates().into_iter().map(move |uvs| (wrap, uvs)))
        .collect();
    for &(wrap, uvs) in &cases {
        let scene = scene(9, uvs, wrap);
        let emitters = emitters(&scene);
        let pieces = pieces(&emitters);
        let mut counts = vec![0.0; bins * bins];
        let mut expected = vec![0.0; bins * bins];
        let bin = |b: Vec2| {
            // Invert `uniform_in_triangle`, which maps the unit square to the triangle with a constant ratio of areas.
            let side = |x: f32| ((x * bins as f32) as usize).min(bins - 1);
            let along = b.x + b.y;
            side(along * along) * bins + side(b.y / along.max(1e-9))
        };
        // Select pieces of the first emitter in proportion to their intensity.
        let own: Vec<usize> = (0..pieces.len()).filter(|&p| pieces[p].0 == 0).collect();
        let weights = own.iter().map(|&p| f64::from(pieces[p].1));
        let table = crate::render::distribution::Distribution::new(weights.into_iter()).unwrap();
        for _ in 0..samples {
            let (choice, rest) = table.sample(rng.next_f64());
            let (emitter, b) = emitters.sample(own[choice], (rest, rng.next_f32())).unwrap();
            assert_eq!(emitter, 0);
            counts[bin(b)] += 1.0;
        }
        let area = emitters.emitters[0].area;
        let cells = bins * fine;
        for i in 0..cells * cells {
            let v = (Vec2::new((i % cells) as f32, (i / cells) as f32) + 0.5) / cells as f32;
            let b = uniform_in_triangle(v);
            let uv = emitters.emitters[0].emission(&scene, b).1;
            if let Some(piece) = emitters.piece_at(0, uv) {
                let chosen = own.iter().position(|&p| p == piece).map_or(0.0, |i| table.pmf(i));
                let pdf = chosen * f64::from(emitters.area_pdf(piece, 0, brightness(&emitters, &scene, 0, b)) * area);
                expected[bin(b)] += pdf * f64::from(samples) / (cells * cells) as f64;
            }
        }
        assert_follows(&expected, &counts, cases.len(), &format!("{wrap:?}, {uvs:?}"));
    }
}

#[test]
fn the_flux_is_the_integral_of_the_texture() {
    for (side, tolerance) in [(9, 0.01), (2200, 0.02)] {
        let scene = scene(side, [Vec2::ZERO, Vec2::X, Vec2::Y], Wrap::Clamp);
        let emitters = emitters(&scene);
        let n = 200_000;
        let mut rng = Rng::new(22, &[]);
        let mut sum = 0.0;
        for (index, emitter) in emitters.emitters.iter().enumerate() {
            for _ in 0..n {
                let b = uniform_in_triangle(Vec2::new(rng.next_f32(), rng.next_f32()));
                sum += f64::from(brightness(&emitters, &scene, index, b) * emitter.area) / f64::from(n);
            }
        }
        let ratio = emitters.power / (sum * std::f64::consts::PI);
        assert!((ratio - 1.0).abs() < tolerance, "{ratio}");
    }
}

#[test]
fn densities_of_a_piece_integrate_to_one() {
    let scene = scene(300, coordinates()[1], Wrap::Repeat);
    let emitters = emitters(&scene);
    let n = 400_000;
    let mut rng = Rng::new(23, &[]);
    let mut sums = vec![0.0; pieces(&emitters).len()];
    for (index, emitter) in emitters.emitters.iter().enumerate() {
        for _ in 0..n {
            let b = uniform_in_triangle(Vec2::new(rng.next_f32(), rng.next_f32()));
            let uv = emitter.emission(&scene, b).1;
            if let Some(piece) = emitters.piece_at(index, uv) {
                let pdf = emitters.area_pdf(piece, index, brightness(&emitters, &scene, index, b));
                sums[piece] += f64::from(pdf * emitter.area) / f64::from(n);
            }
        }
    }
    // Average over all pieces, since each piece is small and its estimate has a large variance.
    let mean = sums.iter().sum::<f64>() / sums.len() as f64;
    assert!((mean - 1.0).abs() < 0.01, "{mean}");
}

#[test]
fn triangles_on_one_texel_have_its_emission_and_dark_ones_are_no_lights() {
    let at = |x: f32, y: f32| [Vec2::new(x, y) / 9.0; 3].map(|uv| uv * Vec2::new(1.0, 9.0 / 5.0));
    for (uvs, lit) in [(at(0.5, 0.5), true), (at(2.5, 0.5), false)] {
        let scene = scene(9, uvs, Wrap::Repeat);
        let emitters = emitters(&scene);
        let own: Vec<(u32, f32)> = pieces(&emitters).into_iter().filter(|p| p.0 == 0).collect();
        assert_eq!(own.len(), usize::from(lit));
        let emission = brightness(&emitters, &scene, 0, Vec2::splat(0.3));
        assert_eq!(own.first().map_or(0.0, |p| p.1), emission * emitters.emitters[0].area);
    }
}
