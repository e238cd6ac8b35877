//! Tests of light sampling: sampled frequencies against stated probabilities, and estimates of irradiance against
//! closed forms.

use super::tree::LightTree;
use super::*;
use crate::exec::Pool;
use crate::image::Image;
use crate::job::Monitor;
use crate::photometry::Luminaire;
use crate::render::sampler::Sampler;
use crate::render::tests::chi2::assert_follows;
use crate::render::{PathSink, SurfacePoint, World, irradiance};
use crate::rng::Rng;
use crate::scene::{Environment, Material, Mesh, PunctualLight, Texture, TextureRef};
use glam::Vec3Swizzles;
use std::f32::consts::{FRAC_PI_2, TAU};
use std::sync::Arc;

fn direction(rng: &mut Rng) -> Vec3 {
    let (z, angle) = (1.0 - 2.0 * rng.next_f32(), TAU * rng.next_f32());
    let r = (1.0 - z * z).sqrt();
    Vec3::new(r * angle.cos(), r * angle.sin(), z)
}

fn within(rng: &mut Rng, side: f32) -> Vec3 {
    (Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32()) - 0.5) * side
}

/// Bounds and corners of random lights near `offset`: points, cones, and one-sided and two-sided triangles of all
/// sizes.
fn lights(count: usize, offset: Vec3, rng: &mut Rng) -> Vec<(Bounds, [Vec3; 3])> {
    let mut light = |i: usize| {
        let intensity = 10f32.powf(4.0 * rng.next_f32() - 2.0);
        let place = offset + within(rng, 10.0);
        match i % 8 {
            0 => (Bounds::of_point(place, intensity), [place; 3]),
            1 => (Bounds::of_cone(place, direction(rng), 0.1 + 1.4 * rng.next_f32(), intensity), [place; 3]),
            kind => {
                let size = 10f32.powf(3.0 * rng.next_f32() - 2.5);
                let corners = [place, place + direction(rng) * size, place + direction(rng) * size];
                let [a, b, c] = corners.map(|p| p.as_dvec3());
                let normal = (b - a).cross(c - a).normalize().as_vec3();
                (Bounds::of_surface(corners, normal, kind > 5, intensity), corners)
            }
        }
    };
    (0..count).map(&mut light).collect()
}

fn receivers(count: usize, offset: Vec3, rng: &mut Rng) -> Vec<Receiver> {
    (0..count).map(|_| Receiver { position: offset + within(rng, 12.0), normal: direction(rng) }).collect()
}

fn tree(lights: &[(Bounds, [Vec3; 3])]) -> LightTree {
    LightTree::build(&lights.iter().map(|l| l.0).collect::<Vec<_>>()).unwrap()
}

#[test]
fn sampled_lights_follow_the_pmf_of_the_tree() {
    let mut rng = Rng::new(41, &[]);
    let n = 40_000;
    for count in [1, 2, 8, 9, 300] {
        let lights = lights(count, Vec3::ZERO, &mut rng);
        let tree = tree(&lights);
        for receiver in receivers(8, Vec3::ZERO, &mut rng) {
            let stated: Vec<f64> = (0..count).map(|l| f64::from(tree.pmf(&receiver, l))).collect();
            let total: f64 = stated.iter().sum();
            assert!(total < 1.0 + 1e-5);
            let mut counts = vec![0.0; count + 1];
            for i in 0..n {
                // Stratify the samples. If the sampling is right, the stratification only lowers chi-squared.
                match tree.sample(&receiver, (f64::from(i) + rng.next_f64()) / f64::from(n)) {
                    None => counts[count] += 1.0,
                    Some((light, pmf, rest)) => {
                        counts[light] += 1.0;
                        assert!((0.0..1.0).contains(&rest));
                        // Allow for rounding: `sample` and `pmf` multiply the same factors, but in opposite order.
                        assert!((f64::from(pmf) / stated[light] - 1.0).abs() < 1e-5);
                    }
                }
            }
            let absent = (1.0 - total).max(0.0);
            let expected: Vec<f64> = stated.iter().chain([&absent]).map(|p| p * f64::from(n)).collect();
            assert_follows(&expected, &counts, 40, &format!("{count} lights, {receiver:?}"));
        }
    }
}

#[test]
fn sampling_the_tree_can_be_inverted() {
    // The values of `u` that select a light form an interval whose length is the light's pmf; `rest` is the relative
    // position of `u` in this interval.
    let mut rng = Rng::new(44, &[]);
    for count in [2, 9, 300] {
        let tree = tree(&lights(count, Vec3::ZERO, &mut rng));
        for receiver in receivers(8, Vec3::ZERO, &mut rng) {
            let mut starts = vec![None; count];
            for _ in 0..5000 {
                let u = rng.next_f64();
                let Some((light, pmf, rest)) = tree.sample(&receiver, u) else { continue };
                let start = u - rest * f64::from(pmf);
                let first = *starts[light].get_or_insert(start);
                assert!((start - first).abs() < 1e-6, "light {light} of {count}: {start} and {first}");
            }
        }
    }
}

/// A floor under an emissive square, with six punctual lights of all kinds and an environment.
fn every_light() -> Scene {
    let mut scene =
        over_floor(vec![Mesh::parallelogram(Vec3::new(-0.5, 2.0, -0.5), Vec3::X, Vec3::Z, 1)], vec![matt(0.0, 3.0)]);
    let intensity = |i: usize| Vec3::splat(1.0 + i as f32);
    let place = |i: usize| Vec3::new(i as f32 - 2.0, 1.5, 0.3);
    scene.lights = (0..6)
        .map(|i| match i % 3 {
            0 if i > 0 => {
                let (position, axis, c0, colour) = (place(i), Vec3::NEG_Y, Vec3::X, intensity(i));
                PunctualLight::Luminaire { position, axis, c0, colour, distribution: 0, is_point: false }
            }
            0 => PunctualLight::Point { position: place(i), intensity: intensity(i) },
            1 => PunctualLight::Spot {
                position: place(i),
                direction: -place(i).normalize(),
                intensity: intensity(i),
                inner_angle: 0.1,
                outer_angle: 0.6,
            },
            _ => PunctualLight::parallel(-place(i).normalize(), intensity(i)),
        })
        .collect();
    scene.distributions = vec![Arc::new(Luminaire::lambertian("panel", 4.0, [0.0; 3]))];
    scene.environment = Some(Environment::Constant(Vec3::splat(0.5)));
    scene
}

#[test]
fn every_kind_of_light_is_sampled_with_the_stated_pdf() {
    let world = world(every_light());
    let receiver = Receiver { position: Vec3::new(0.1, 0.0, 0.0), normal: Vec3::Y };
    // Count the samples of the six punctual lights, of the surface and of the environment, and the samples without a
    // light.
    let (mut counts, mut stated) = ([0.0; 9], [0.0; 9]);
    let (mut surface, n) = (0.0, 100_000);
    let mut rng = Rng::new(45, &[]);
    for _ in 0..n {
        let point = (rng.next_f64(), rng.next_f32());
        let Some(sample) = world.lights().sample(world.scene(), &receiver, point) else {
            counts[8] += 1.0;
            continue;
        };
        match sample.source {
            LightSource::Punctual(index) => {
                // For a punctual light at a finite distance, `pdf` is the pmf × the squared distance.
                let distance2 = match sample.end {
                    Some(LightEnd::Point(p)) => p.distance_squared(receiver.position),
                    _ => 1.0,
                };
                counts[index as usize] += 1.0;
                stated[index as usize] = f64::from(sample.pdf / distance2) * f64::from(n);
            }
            LightSource::Surface { .. } => {
                counts[6] += 1.0;
                // With 1 / pdf for a sample on the lamp and 0 for others, the mean estimates the lamp's solid angle.
                surface += f64::from(1.0 / sample.pdf) / f64::from(n);
            }
            LightSource::Environment => {
                counts[7] += 1.0;
                stated[7] = f64::from(sample.pdf * 4.0 * std::f32::consts::PI) * f64::from(n);
            }
        }
    }
    assert!(counts[..8].iter().all(|&c| c > 100.0), "{counts:?}");
    // The probability with which the lamp is selected is not known in advance: take what remains after the other
    // lights and the samples without a light.
    stated[8] = counts[8];
    stated[6] = f64::from(n) - stated.iter().sum::<f64>();
    assert_follows(&stated, &counts, 1, "kinds of lights");
    // The lamp is a square of 1 m² at a height of 2 m, slightly off centre. A sample hits the lamp with the probability
    // `share` (a Bernoulli trial), from which the standard error follows.
    let (expected, share) = (solid_angle_of_lamp(), counts[6] / f64::from(n));
    let error = expected * ((1.0 - share) / (share * f64::from(n))).sqrt();
    assert!((surface - expected).abs() < 4.0 * error + 1e-3 * expected, "{surface} ± {error}, expected {expected}");
}

/// Returns the solid angle of a square of 1 × 1 m, seen from a point 2 m below and 10 cm off its centre, as the sum of
/// four rectangles with a corner above the point (Khadjavi 1968).
fn solid_angle_of_lamp() -> f64 {
    let corner = |a: f64, b: f64, d: f64| (a * b / (d * (a * a + b * b + d * d).sqrt())).atan();
    2.0 * (corner(0.4, 0.5, 2.0) + corner(0.6, 0.5, 2.0))
}

#[test]
fn no_light_that_can_arrive_has_probability_0() {
    let mut rng = Rng::new(42, &[]);
    for offset in [Vec3::ZERO, Vec3::new(1e6, -3e5, 2e5)] {
        let lights = lights(200, offset, &mut rng);
        let tree = tree(&lights);
        let mut arriving = 0;
        for receiver in receivers(100, offset, &mut rng) {
            for (index, (bounds, [a, b, c])) in lights.iter().enumerate() {
                let (u, v) = (rng.next_f32(), rng.next_f32());
                let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                let towards = a + (b - a) * u + (c - a) * v - receiver.position;
                let off_axis = bounds.axis.angle_between(-towards);
                let shines = bounds.axis == Vec3::ZERO
                    || off_axis < bounds.cone_angle
                    || (bounds.two_sided && std::f32::consts::PI - off_axis < bounds.cone_angle);
                if shines && towards.dot(receiver.normal) > 0.0 {
                    arriving += 1;
                    assert!(tree.pmf(&receiver, index) > 0.0, "{bounds:?} to {receiver:?}");
                }
            }
        }
        assert!(arriving > 4000, "{arriving}");
    }
}

#[test]
fn near_lamps_are_preferred_to_far_ones_and_those_behind_are_left_out() {
    // Build a ceiling of 40 × 40 lamps at a height of 3 m.
    let lamp = |i: usize| {
        let corner = Vec3::new((i % 40) as f32, 3.0, (i / 40) as f32);
        Bounds::of_surface([corner, corner + Vec3::new(0.1, 0.0, 0.1)], Vec3::NEG_Y, false, 1.0)
    };
    let bounds: Vec<Bounds> = (0..1600).map(lamp).collect();
    let tree = LightTree::build(&bounds).unwrap();
    let position = Vec3::new(10.0, 0.0, 20.0);
    let near = |normal: Vec3| -> f32 {
        let receiver = Receiver { position, normal };
        let around = (0..1600).filter(|&i| (bounds[i].low - position).length() < 9.0);
        around.map(|i| tree.pmf(&receiver, i)).sum()
    };
    // A large ceiling at a height of h gives E ∝ ∫ h² / (h² + r²)² dA. The share r² / (h² + r²) of E comes from within
    // the radius r: 72 / 81 for h = 3 m and r = √72 m.
    assert!((near(Vec3::Y) - 72.0 / 81.0).abs() < 0.05, "{}", near(Vec3::Y));
    assert_eq!(near(Vec3::NEG_Y), 0.0);
    let from_above = Receiver { position: position + Vec3::Y * 4.0, normal: Vec3::NEG_Y };
    assert!(tree.sample(&from_above, 0.5).is_none());
}

#[test]
fn any_number_of_threads_builds_the_same_tree() {
    let mut rng = Rng::new(43, &[]);
    let lights = lights(10_000, Vec3::ZERO, &mut rng);
    let receivers = receivers(200, Vec3::ZERO, &mut rng);
    let choices = |threads| {
        Pool::new(threads).unwrap().run(|| {
            let tree = tree(&lights);
            receivers.iter().map(|r| tree.sample(r, 0.37)).collect::<Vec<_>>()
        })
    };
    assert!(choices(1) == choices(3));
}

#[test]
fn regular_patterns_of_lamps_make_the_same_tree_at_any_scale() {
    // In a regular pattern, several splits have equal cost, and centres of lamps lie on borders of bins. The scale of
    // the scene changes the rounding of costs and centres, but must not change the choice of the split or of the bins.
    let receivers = receivers(4, Vec3::splat(2.0), &mut Rng::new(44, &[]));
    let pmfs = |scale: f32, side: usize| {
        let lamp = |i: usize| {
            let corner = Vec3::new((i % side) as f32 * 0.7, 3.0, (i / side) as f32 * 0.7) * scale;
            let corners = [corner, corner + Vec3::new(0.3, 0.0, 0.3) * scale];
            Bounds::of_surface(corners, Vec3::NEG_Y, false, 5.0 * scale * scale)
        };
        let tree = LightTree::build(&(0..side * side).map(lamp).collect::<Vec<_>>()).unwrap();
        let scaled = receivers.iter().map(|r| Receiver { position: r.position * scale, ..*r });
        scaled.flat_map(|r| (0..side * side).map(|i| tree.pmf(&r, i)).collect::<Vec<_>>()).collect::<Vec<_>>()
    };
    for (side, scale) in [3, 4, 8, 13, 15, 20].map(|side| [1e-4, 0.1, 7.0, 1e6].map(|s| (side, s))).concat() {
        // Allow for rounding, which may also move a tiny probability to 0.
        let differ = |&(a, b): &(f32, f32)| (a - b).abs() > 1e-3 * a.max(b) + 1e-6;
        let count = pmfs(1.0, side).into_iter().zip(pmfs(scale, side)).filter(differ).count();
        assert_eq!(count, 0, "{side} × {side} lamps, scale {scale}");
    }
}

#[test]
fn lights_all_in_one_place_or_of_all_sizes_make_a_tree() {
    let same = vec![Bounds::of_point(Vec3::ONE, 1.0); 1000];
    let growing: Vec<Bounds> =
        (0..600).map(|i| Bounds::of_point(Vec3::X * 1.05f32.powi(i - 300), 1.1f32.powi(300 - i))).collect();
    for lights in [same, growing] {
        let tree = LightTree::build(&lights).unwrap();
        let receiver = Receiver { position: Vec3::NEG_X, normal: Vec3::X };
        let sum: f32 = (0..lights.len()).map(|l| tree.pmf(&receiver, l)).sum();
        assert!((sum - 1.0).abs() < 1e-3, "{sum}");
    }
    let halves = [1.0, 3.0].map(|intensity| Bounds::of_point(Vec3::ONE, intensity));
    let tree = LightTree::build(&halves).unwrap();
    let receiver = Receiver { position: Vec3::NEG_X, normal: Vec3::X };
    assert_eq!([0, 1].map(|l| tree.pmf(&receiver, l)), [0.25, 0.75]);
    assert_eq!(tree.sample(&receiver, 0.5), Some((1, 0.75, 1.0 / 3.0)));
    let none = LightTree::build(&[]).unwrap();
    assert!(none.sample(&Receiver { position: Vec3::ZERO, normal: Vec3::X }, 0.5).is_none());
}

fn matt(albedo: f32, emission: f32) -> Material {
    Material { emission: Vec3::splat(emission), double_sided: false, ..Material::diffuse("", Vec3::splat(albedo)) }
}

/// A scene of the given meshes and a black floor of 2 × 2 mm around the origin, which faces up.
fn over_floor(meshes: Vec<Mesh>, materials: Vec<Material>) -> Scene {
    let floor = Mesh::parallelogram(Vec3::new(-1e-3, 0.0, -1e-3), Vec3::Z * 2e-3, Vec3::X * 2e-3, 0);
    let meshes = std::iter::once(floor).chain(meshes).collect();
    Scene { meshes, materials: std::iter::once(matt(0.0, 0.0)).chain(materials).collect(), ..Scene::default() }
}

fn world(scene: Scene) -> World {
    World::build(Arc::new(scene), Monitor::default().job()).unwrap()
}

struct ContributionSum(f64);

impl PathSink for ContributionSum {
    fn add(&mut self, _: LightSource, importance: Vec3, emission: Vec3) {
        self.0 += f64::from(importance.x * emission.x);
    }
}

const ORIGIN: SurfacePoint = SurfacePoint { mesh: 0, triangle: 0, barycentric: Vec2::new(0.0, 0.5), front: true };

/// Returns the mean irradiance at the floor's centre, and its standard error.
fn measure(scene: Scene) -> (f64, f64) {
    let world = world(scene);
    let (batches, per_batch) = (32u32, 512);
    let means: Vec<f64> = (0..batches)
        .map(|batch| {
            let mut sum = ContributionSum(0.0);
            (0..per_batch).for_each(|i| irradiance(&world, &ORIGIN, u64::from(batch), i, &mut sum));
            sum.0 / f64::from(per_batch)
        })
        .collect();
    let n = f64::from(batches);
    let mean = means.iter().sum::<f64>() / n;
    (mean, (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt())
}

/// Asserts that a measured mean agrees with `expected`, the value of a closed form, to within four standard errors
/// (`error`) plus `slack` × `expected`. `slack` is the relative error of the closed form for the tested geometry.
fn assert_close((mean, error): (f64, f64), expected: f64, slack: f64, what: &str) {
    assert!((mean - expected).abs() < 4.0 * error + slack * expected, "{what}: {mean} ± {error}, expected {expected}");
}

/// Irradiance of an upward surface at the origin by a polygon of radiance 1 above the horizon (Lambert 1760).
fn lambert(corners: &[Vec3]) -> f64 {
    let edge = |i: usize| {
        let a = corners[i].as_dvec3().normalize();
        let b = corners[(i + 1) % corners.len()].as_dvec3().normalize();
        let across = a.cross(b);
        // Compute the angle between `a` and `b` from its tangent: the cosine of a small angle is too close to 1.
        across.length().atan2(a.dot(b)) * across.normalize_or_zero().y
    };
    (0..corners.len()).map(edge).sum::<f64>().abs() / 2.0
}

#[test]
fn many_triangles_light_as_their_closed_forms_add_up_to() {
    // Place one triangle in each of 16 × 8 solid angles, so that none occludes another. Distances, sizes and powers
    // vary widely.
    let mut rng = Rng::new(51, &[]);
    for (near, far) in [(1.0f32, 1.0f32), (0.5, 200.0)] {
        let (mut meshes, mut materials, mut expected) = (Vec::new(), Vec::new(), 0.0);
        for i in 0..128 {
            let mut place = || {
                let polar = FRAC_PI_2 * ((i / 16) as f32 + 0.05 + 0.9 * rng.next_f32()) / 8.0;
                let angle = TAU * ((i % 16) as f32 + 0.05 + 0.9 * rng.next_f32()) / 16.0;
                Vec3::new(polar.sin() * angle.cos(), polar.cos(), polar.sin() * angle.sin())
            };
            let mut corners = [place(), place(), place()];
            let distance = near * (far / near).powf(rng.next_f32());
            corners = corners.map(|c| c * distance * (0.9 + 0.2 * rng.next_f32()));
            let faces = (corners[1] - corners[0]).cross(corners[2] - corners[0]).dot(corners[0]) < 0.0;
            // Every third triangle is two-sided. The others light the floor only if they face it.
            let emission = 10f32.powf(2.0 * rng.next_f32());
            let double_sided = i % 3 == 0;
            expected += if faces || double_sided { lambert(&corners) * f64::from(emission) } else { 0.0 };
            let mesh =
                Mesh { material: i + 1, positions: corners.to_vec(), triangles: vec![[0, 1, 2]], ..Mesh::default() };
            meshes.push(mesh);
            materials.push(Material { double_sided, ..matt(0.0, emission) });
        }
        let measured = measure(over_floor(meshes, materials));
        assert_close(measured, expected, 1e-5, "triangles");
        // About a third of the lights face away from the floor, so some of the light samples carry no light. The
        // standard error is 1.5 % of the irradiance.
        assert!(measured.1 < 0.02 * expected, "{measured:?}");
    }
}

#[test]
fn discs_and_spheres_light_by_their_form_factors() {
    // A disc of radius r = 1 m, at a height of h = 2 m above the floor: E = π L r² / (r² + h²). The area of the polygon
    // with 720 corners is 1e-5 smaller.
    let rim = |i: usize| Vec3::new((TAU * i as f32 / 720.0).cos(), 2.0, (TAU * i as f32 / 720.0).sin());
    let mut disc = Mesh { material: 1, positions: (0..720).map(rim).collect(), ..Mesh::default() };
    disc.triangles = (1..719).map(|i| [0, i, i + 1]).collect();
    let measured = measure(over_floor(vec![disc], vec![matt(0.0, 1.0)]));
    assert_close(measured, PI / 5.0, 5e-5, "disc");

    // A sphere, r = 1 m, at a height of d = 3 m: E = π L r² / d². Its facets lie inside, so E is up to 1 % smaller.
    let (rows, columns, centre) = (24, 48, Vec3::Y * 3.0);
    let at = |i: usize, j: usize| {
        let (polar, angle) = (PI as f32 * i as f32 / rows as f32, TAU * (j % columns) as f32 / columns as f32);
        centre + Vec3::new(polar.sin() * angle.cos(), polar.cos(), polar.sin() * angle.sin())
    };
    let mut sphere = Mesh { material: 1, ..Mesh::default() };
    let mut exact = 0.0;
    for i in 0..rows {
        for j in 0..columns {
            for t in [[at(i, j), at(i, j + 1), at(i + 1, j)], [at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)]] {
                let normal = (t[1] - t[0]).cross(t[2] - t[0]);
                let first = sphere.positions.len() as u32;
                sphere.positions.extend(t);
                sphere.triangles.push([first, first + 1, first + 2]);
                // All triangles of a convex body that face the receiver are visible.
                exact += if normal.dot(t[0]) < 0.0 && normal.length() > 1e-6 { lambert(&t) } else { 0.0 };
            }
        }
    }
    let measured = measure(over_floor(vec![sphere], vec![matt(0.0, 1.0)]));
    assert_close(measured, exact, 1e-4, "sphere of facets");
    assert!((exact / (PI / 9.0) - 1.0).abs() < 0.01, "{exact}");
}

#[test]
fn textured_lamps_light_as_the_polygons_of_their_texels() {
    let image =
        Image::from_fn(37, 23, |x, y| [if (x * 7 + y * 3) % 11 < 2 { (1 + x % 3) as f32 } else { 0.0 }]).unwrap();
    for (width, slack) in [(3.0f32, 1e-5), (1e-3, 1e-5), (1e-8, 1e-4)] {
        let corner = Vec3::new(-width / 2.0, 1.0, -width / 2.0);
        let lamp = Mesh::parallelogram(corner, Vec3::X * width, Vec3::Z * width, 1);
        let mut expected = 0.0;
        for (x, y) in (0..23).flat_map(|y| (0..37).map(move |x| (x, y))) {
            let texel = Vec2::new(width / 37.0, width / 23.0);
            let place = corner + Vec3::new(x as f32 * texel.x, 0.0, y as f32 * texel.y);
            let emission = f64::from(image.pixel(x, y)[0]) * 1e6;
            // For texels far smaller than their distance, the closed form suffers from cancellation. These texels lie
            // 1 m straight above the floor's centre, so each gives an irradiance of emission × area.
            expected += emission
                * if width < 0.1 {
                    f64::from(texel.x) * f64::from(texel.y)
                } else {
                    lambert(&[
                        place,
                        place + Vec3::X * texel.x,
                        place + texel.extend(0.0).xzy(),
                        place + Vec3::Z * texel.y,
                    ])
                };
        }
        let mut scene = over_floor(vec![lamp], vec![matt(0.0, 1e6)]);
        scene.materials[1].emission_texture = Some(TextureRef::new(0));
        scene.textures.push(Texture::new("", image.clone()));
        let measured = measure(scene);
        assert_close(measured, expected, slack, &format!("width {width}"));
    }
}

#[test]
fn lamps_without_area_or_power_are_none_and_extreme_ones_are_exact() {
    let up =
        |size: f32| Mesh::parallelogram(Vec3::new(-size / 2.0, 1.0, -size / 2.0), Vec3::X * size, Vec3::Z * size, 1);
    let needle = Mesh::parallelogram(Vec3::new(0.0, 1.0, 0.0), Vec3::X, Vec3::X * 2.0, 1);
    for dark in [over_floor(vec![needle], vec![matt(0.0, 5.0)]), over_floor(vec![up(1.0)], vec![matt(0.0, 0.0)])] {
        assert_eq!(measure(dark), (0.0, 0.0));
    }
    let one = lambert(&up(1.0).positions);
    for emission in [1e-12, 1e12f32] {
        let measured = measure(over_floor(vec![up(1.0)], vec![matt(0.0, emission)]));
        assert_close(measured, one * f64::from(emission), 1e-5, "intensity");
    }
    // Test a dim lamp beside a lamp 1e12 times as bright that faces away from the floor.
    let away = Mesh::parallelogram(Vec3::new(-0.5, 2.0, -0.5), Vec3::Z, Vec3::X, 2);
    let measured = measure(over_floor(vec![up(1.0), away], vec![matt(0.0, 1.0), matt(0.0, 1e12)]));
    assert_close(measured, one, 1e-5, "beside");
    assert!(measured.1 < 0.01 * one, "what faces away is not chosen: {measured:?}");
}

#[test]
fn point_and_spot_lights_add_up() {
    let mut rng = Rng::new(52, &[]);
    let mut scene = over_floor(Vec::new(), Vec::new());
    let mut expected = 0.0;
    for i in 0..60 {
        let position = within(&mut rng, 8.0) + Vec3::Y * 3.0;
        let intensity = 10f32.powf(2.0 * rng.next_f32());
        let cosine = f64::from(position.normalize().y.max(0.0));
        let received = f64::from(intensity) * cosine / f64::from(position.length_squared());
        if i % 2 == 0 {
            scene.lights.push(PunctualLight::Point { position, intensity: Vec3::splat(intensity) });
            expected += received;
        } else {
            let direction = direction(&mut rng);
            let (inner_angle, outer_angle) = (0.3, 1.2f32);
            let off_axis = f64::from(direction.angle_between(-position));
            let (inner, outer) = (f64::from(inner_angle).cos(), f64::from(outer_angle).cos());
            expected += received * ((off_axis.cos() - outer) / (inner - outer)).clamp(0.0, 1.0).powi(2);
            let intensity = Vec3::splat(intensity);
            scene.lights.push(PunctualLight::Spot { position, direction, intensity, inner_angle, outer_angle });
        }
    }
    let measured = measure(scene);
    assert_close(measured, expected, 1e-5, "points");
    assert!(measured.1 < 0.01 * expected, "{measured:?}");
}

#[test]
fn a_sample_states_the_density_that_scattering_into_it_would() {
    let image = Image::from_fn(64, 64, |x, y| [((x / 3 + y / 5) % 4 / 3) as f32 * (1 + x % 2) as f32]).unwrap();
    let lamp = |i: usize| Mesh::parallelogram(Vec3::new(i as f32 * 1.5 - 7.0, 2.0, -1.0), Vec3::X, Vec3::Z, 1 + i % 2);
    let mut scene = over_floor((0..10).map(lamp).collect(), vec![matt(0.0, 3.0), matt(0.0, 9.0)]);
    scene.materials[1].emission_texture = Some(TextureRef::new(0));
    scene.textures.push(Texture::new("", image));
    scene.environment = Some(Environment::Constant(Vec3::splat(0.1)));
    let world = world(scene);
    let mut rng = Rng::new(53, &[]);
    let (mut surfaces, mut disagreed) = (0, 0);
    for i in 0..20_000 {
        let receiver =
            Receiver { position: within(&mut rng, 4.0), normal: (direction(&mut rng) + Vec3::Y).normalize() };
        let block = Sampler::new(7, i).next();
        let Some(sample) = world.lights().sample(world.scene(), &receiver, (block.fine(0), block.get(1))) else {
            continue;
        };
        let stated = match sample.end {
            Some(LightEnd::Emitter(index, b)) => {
                surfaces += 1;
                let emitter = &world.lights().emitters.emitters[index];
                let distance = emitter.point(b).distance(receiver.position);
                let emission = world.lights().emitters.emission(world.scene(), index, b, -sample.direction);
                world.lights().surface_pdf(&receiver, index, emission, sample.direction, distance)
            }
            _ => world.lights().environment_pdf(sample.direction),
        };
        disagreed += usize::from((stated / sample.pdf - 1.0).abs() > 1e-4);
    }
    // Rounding may place a sampled point in a neighbour of the tile from which the point was drawn. Only at such points
    // may the pdf of the sample differ from the result of `surface_pdf`.
    assert!(surfaces > 5000 && disagreed <= 5, "{disagreed} of {surfaces}");
}

#[test]
fn light_transport_between_two_surfaces_is_reciprocal() {
    // Test reciprocity, ⟨e₁, T e₂⟩ = ⟨e₂, T e₁⟩, between two matt quads. An obstacle blocks a part of the light, and a
    // wall reflects light from one quad to the other.
    let quads = || {
        vec![
            Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0),
            Mesh::parallelogram(Vec3::new(0.3, 1.5, -0.7), Vec3::new(0.8, -0.5, 0.0), Vec3::Z * 0.6, 1),
            Mesh::parallelogram(Vec3::new(0.2, 0.7, -0.5), Vec3::X * 0.4, Vec3::Z * 0.9, 2),
            Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::X * 3.0, Vec3::Y * 3.0, 2),
        ]
    };
    let albedos = [0.5, 0.3, 0.7];
    let transport = |from: usize, to: u32| {
        let materials = (0..3).map(|i| matt(albedos[i], f32::from(u8::from(i == from)))).collect();
        let world = world(Scene { meshes: quads(), materials, ..Scene::default() });
        let mut rng = Rng::new(54, &[u64::from(to)]);
        let n = 60_000u32;
        let (mut sum, mut square) = (0.0, 0.0);
        for i in 0..n {
            let (u, v) = (rng.next_f32(), rng.next_f32());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            let point = SurfacePoint { mesh: to, triangle: i % 2, barycentric: Vec2::new(u, v), front: true };
            let mut one = ContributionSum(0.0);
            irradiance(&world, &point, u64::from(i), 0, &mut one);
            sum += one.0;
            square += one.0 * one.0;
        }
        let [a, b, c] = world.scene().meshes[to as usize].corners(0);
        let area = f64::from((b - a).cross(c - a).length());
        let mean = sum / f64::from(n);
        (mean * area, area * ((square / f64::from(n) - mean * mean) / f64::from(n)).sqrt())
    };
    let (there, back) = (transport(0, 1), transport(1, 0));
    let error = there.1.hypot(back.1);
    assert!((there.0 - back.0).abs() < 4.0 * error && error < 0.02 * there.0, "{there:?} and {back:?}");
}

#[test]
fn the_floor_of_a_hall_with_thousands_of_lamps_sees_them_all() {
    let side = 48;
    let lamp = |i: usize| Vec3::new((i % side) as f32 - 23.5, 3.0, (i / side) as f32 - 23.5);
    let mut lamps = Mesh { material: 1, ..Mesh::default() };
    let mut expected = 0.0;
    for i in 0..side * side {
        let q = Mesh::parallelogram(lamp(i), Vec3::X * 0.1, Vec3::Z * 0.1, 1);
        expected += lambert(&q.positions) * 1000.0;
        let first = lamps.positions.len() as u32;
        lamps.positions.extend(q.positions);
        lamps.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    let measured = measure(over_floor(vec![lamps], vec![matt(0.0, 1000.0)]));
    assert_close(measured, expected, 1e-5, "hall");
    // If lights were selected by power alone, few of the samples would hit the lamps overhead, which give most of the
    // light.
    assert!(measured.1 < 0.005 * expected, "{measured:?}");
}
