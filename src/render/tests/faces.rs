//! Tests of luminaires that shine from faces: the illuminance near the faces and far from them, the flux, and the
//! luminance in pictures.

use super::*;
use crate::exec::Pool;
use crate::photometry::Luminaire;
use crate::render::illuminance::{self, CalculationPoints};
use crate::render::sampler::Sampler;
use std::f64::consts::{FRAC_PI_4, PI};

/// A scene with a luminaire at the origin that shines down, with C = 0 along x. Its only mesh is a black square far
/// away.
fn hung(luminaire: Luminaire) -> Scene {
    Scene {
        meshes: vec![Mesh::parallelogram(Vec3::splat(-90.0), Vec3::X, Vec3::Z, 0)],
        materials: vec![matt(0.0, 0.0)],
        lights: vec![light_at(Vec3::ZERO)],
        distributions: vec![Arc::new(luminaire)],
        ..Scene::default()
    }
}

fn light_at(position: Vec3) -> PunctualLight {
    let (axis, c0, colour) = (Vec3::NEG_Y, Vec3::X, Vec3::ONE);
    PunctualLight::Luminaire { position, axis, c0, colour, distribution: 0, is_point: false }
}

/// Returns the direction in the scene for the angles C (`c`) and γ (`gamma`) of the luminaire, in degrees.
fn direction(c: f64, gamma: f64) -> Vec3 {
    let (c, gamma) = (c.to_radians(), gamma.to_radians());
    DVec3::new(gamma.sin() * c.cos(), -gamma.cos(), -gamma.sin() * c.sin()).as_vec3()
}

/// Returns the illuminance in lux at a point in the air, on a plane with the given normal, and its standard error.
fn lux(world: &World, position: Vec3, normal: Vec3, per_batch: u32) -> (f64, f64) {
    let batches = 32;
    let means: Vec<f64> = (0..batches)
        .map(|batch| {
            let mut sum = ContributionSum(DVec3::ZERO);
            (0..per_batch).for_each(|i| irradiance_in_air(world, position, normal, 70 + batch, i, &mut sum));
            sum.0.x / f64::from(per_batch)
        })
        .collect();
    let n = batches as f64;
    let mean = means.iter().sum::<f64>() / n;
    (mean, (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n * (n - 1.0))).sqrt())
}

/// A luminaire whose intensity depends only on γ: `candela` maps γ in radians to the intensity. A negative `size` is
/// the diameter of a round opening.
fn round(size: [f64; 3], candela: impl Fn(f64) -> f64) -> Luminaire {
    Luminaire {
        gammas: (0..=180).map(f64::from).collect(),
        candela: (0..=180).map(|gamma| candela(f64::from(gamma).to_radians())).collect(),
        ..Luminaire::lambertian("", 0.0, size)
    }
}

/// Returns the form factor from a small facet to a cylinder of radius 1 and the given height. The facet's normal meets
/// the middle of the cylinder's axis at a right angle, at `distance` from the facet. The result is the sum of two equal
/// halves of the cylinder (Howell, "A catalog of radiation heat transfer configuration factors", B-30).
fn cylinder_form_factor(distance: f64, height: f64) -> f64 {
    let (d, l) = (distance, height / 2.0);
    let (a, b) = ((d + 1.0).powi(2) + l * l, (d - 1.0).powi(2) + l * l);
    let side = (a - 2.0 * d) / (d * (a * b).sqrt()) * (a * (d - 1.0) / (b * (d + 1.0))).sqrt().atan();
    let whole = (l / (d * d - 1.0).sqrt()).atan() / d + l * (side - ((d - 1.0) / (d + 1.0)).sqrt().atan() / d);
    2.0 * whole / PI
}

/// Faces of uniform luminance 1000 cd/m² light a point, at a distance of 0.5 to 10 times their size, as the closed
/// forms demand: within four standard errors, and within 1 %.
#[test]
fn the_near_field_meets_closed_forms() {
    let luminance = 1000.0;
    let (radius, height) = (0.15, 0.6);
    let disc = round([-0.3, -0.3, 0.0], |g| luminance * PI * radius * radius * g.cos().max(0.0));
    let panel = round([0.6, 0.3, 0.0], |g| luminance * 0.18 * g.cos().max(0.0));
    let ball = round([-0.3; 3], |_| luminance * PI * radius * radius);
    let tube = round([-0.3, -0.3, height], |g| {
        luminance * (2.0 * radius * height * g.sin() + PI * radius * radius * g.cos().abs())
    });
    let under = |h: f64| (Vec3::NEG_Y * h as f32, Vec3::Y);
    let beside = |d: f64| (Vec3::X * d as f32, Vec3::NEG_X);
    for times in [0.5, 1.0, 2.0, 5.0, 10.0] {
        let h = 0.6 * times;
        for (name, luminaire, (position, normal), form_factor) in [
            ("disc", &disc, under(0.5 * h), radius * radius / (radius * radius + 0.25 * h * h)),
            ("panel", &panel, under(h), 4.0 * parallel_form_factor(0.3, 0.15, h)),
            ("ball", &ball, under(radius + 0.5 * h), (radius / (radius + 0.5 * h)).powi(2)),
            ("tube", &tube, beside(radius + h), cylinder_form_factor((radius + h) / radius, height / radius)),
        ] {
            let expected = PI * luminance * form_factor;
            let (mean, error) = lux(&world(hung(luminaire.clone())), position, normal, 1024);
            let off = (mean - expected).abs();
            assert!(off < 4.0 * error + 1e-3 * expected, "{name} at {times}: {mean} ± {error} lx, expected {expected}");
            assert!(off < 0.01 * expected && error < 0.002 * expected, "{name} at {times}: {mean} ± {error} lx");
        }
    }
}

/// A distribution of 50 to 450 cd without any symmetry.
fn uneven(size: [f64; 3]) -> Luminaire {
    Luminaire {
        gammas: (0..=18).map(|i| f64::from(i) * 10.0).collect(),
        planes: (0..8).map(|i| f64::from(i) * 45.0).collect(),
        candela: (0..19 * 8).map(|i| 50.0 + 40.0 * f64::from(i * 7 % 11)).collect(),
        ..Luminaire::lambertian("", 0.0, size)
    }
}

const SHAPES: [[f64; 3]; 8] = [
    [0.6, 0.6, 0.0],
    [1.2, 0.3, 0.1],
    [-0.4, -0.4, 0.0],
    [-0.4, -0.2, 0.3],
    [1.2, -0.03, -0.03],
    [0.0, -0.4, -0.4],
    [-0.3, -0.3, -0.3],
    [-0.3, -0.2, -0.5],
];

/// Far away, the illuminance is I / r² with the measured intensity I, in all directions and for all shapes of faces.
#[test]
fn the_far_field_is_the_measured_one() {
    for size in SHAPES {
        let luminaire = uneven(size);
        let world = world(hung(luminaire.clone()));
        for (c, gamma) in [(20.0, 5.0), (110.0, 35.0), (200.0, 65.0), (335.0, 75.0), (70.0, 115.0), (250.0, 155.0)] {
            let (towards, distance) = (direction(c, gamma), 80.0f32);
            let (mean, error) = lux(&world, towards * distance, -towards, 128);
            let (candela, expected) = (mean * f64::from(distance).powi(2), luminaire.intensity(c, gamma));
            let error = error * f64::from(distance).powi(2);
            let what = format!("{size:?} at ({c}, {gamma}): {candela} ± {error} cd, expected {expected}");
            assert!((candela - expected).abs() < 4.0 * error + 1.5e-3 * expected, "{what}");
            assert!(error < 0.02 * expected, "{what}");
        }
    }
}

/// The flux through the sides of a box is the flux of the luminaire inside it.
#[test]
fn flux_is_conserved() {
    for size in SHAPES {
        let luminaire = uneven(size);
        let wanted = luminaire.flux();
        let world = world(hung(luminaire));
        let (mut flux, mut variance) = (0.0, 0.0);
        for axis in 0..3 {
            for far in [false, true] {
                let [normal, across, down] = [axis, axis + 1, axis + 2].map(|i| Vec3::AXES[i % 3]);
                let origin = -Vec3::ONE + if far { 2.0 * normal } else { Vec3::ZERO };
                let normal = if far { -normal } else { normal };
                let place = CalculationPoints::Grid { origin, across: 2.0 * across, down: 2.0 * down, normal };
                let params = illuminance::Params { columns: 48, rows: 48, samples: 16, seed: 1 };
                let run = || illuminance::run(&world, &place, &params, Monitor::default().job()).unwrap();
                let side = Pool::new(2).unwrap().run(run);
                flux += 4.0 * side.mean;
                variance += (4.0 * side.mean_error).powi(2);
            }
        }
        let error = variance.sqrt();
        assert!((flux - wanted).abs() < 4.0 * error + 2e-3 * wanted, "{size:?}: {flux} ± {error} lm of {wanted}");
        assert!(error < 5e-3 * wanted, "{size:?}: {error} lm");
    }
}

/// A camera sees the faces with the luminance I / A, without noise. I is the intensity towards the camera, and A is
/// the area of the faces projected in this direction.
#[test]
fn pictures_show_the_luminance() {
    for size in SHAPES {
        let luminaire = uneven(size);
        let opening = luminaire.opening().unwrap();
        let world = world(hung(luminaire.clone()));
        for (c, gamma) in [(20.0, 25.0), (110.0, 55.0), (200.0, 125.0)] {
            let towards = direction(c, gamma);
            let camera = Camera::look_at(towards * 10.0, Vec3::ZERO, 2e-4);
            let film = render(&world, &camera, &Params { width: 2, height: 2, samples: 4, ..Params::default() });
            let local = DVec3::new(towards.x.into(), (-towards.z).into(), (-towards.y).into());
            let expected = luminaire.intensity(c, gamma) / opening.projected_area(local);
            for &seen in &film.beauty.data {
                let what = format!("{size:?} at ({c}, {gamma}): {seen} cd/m², expected {expected}");
                assert!((f64::from(seen) / expected - 1.0).abs() < 1e-3, "{what}");
            }
            assert_eq!(film.unseen_lights, 0);
        }
    }
}

/// Samples of a ball's patches cover the solid angle of the ball: the mean of 1 / pdf is its solid angle.
#[test]
fn samples_cover_the_solid_angle() {
    let (radius, distance) = (0.15f64, 0.4f64);
    let world = world(hung(round([-0.3; 3], |_| 100.0)));
    let receiver = bounds::Receiver { position: world.from_scene(Vec3::NEG_Y * distance as f32), normal: Vec3::Y };
    let (batches, per_batch) = (16, 4096);
    let means: Vec<f64> = (0..batches)
        .map(|batch| {
            let sample = |i| {
                let block = Sampler::new(batch, i).next();
                world.lights().sample(world.scene(), &receiver, (block.fine(0), block.get(1)))
            };
            let sum: f64 = (0..per_batch).filter_map(sample).map(|sample| f64::from(1.0 / sample.pdf)).sum();
            sum / f64::from(per_batch)
        })
        .collect();
    let mean = means.iter().sum::<f64>() / batches as f64;
    let error = (means.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (batches * (batches - 1)) as f64).sqrt();
    let expected = 2.0 * PI * (1.0 - (1.0 - (radius / distance).powi(2)).sqrt());
    assert!((mean - expected).abs() < 4.0 * error + 2e-3 * expected, "{mean} ± {error}, expected {expected}");
    assert!(error < 0.01 * expected);
}

/// The pdf of a light sample on a face equals the pdf that [`light::Lights::surface_pdf`] returns for the sampled
/// point. If a BSDF sample hits the face, the MIS weight is computed from `surface_pdf`.
#[test]
fn samples_state_the_pdf_of_scattering_into_them() {
    let world = world(bright_room());
    let mut rng = crate::rng::Rng::new(54, &[]);
    let (mut samples, mut disagreed) = (0, 0);
    for i in 0..20_000 {
        let mut random = || Vec3::new(rng.next_f32(), rng.next_f32(), rng.next_f32());
        let (position, normal) = (random() * Vec3::new(6.0, 3.0, 8.0), (random() - 0.5).normalize());
        let (receiver, block) = (bounds::Receiver { position, normal }, Sampler::new(7, i).next());
        let lights = world.lights();
        let Some(sample) = lights.sample(world.scene(), &receiver, (block.fine(0), block.get(1))) else { continue };
        let Some(light::LightEnd::Emitter(index, b)) = sample.end else { panic!("all lights have faces") };
        let distance = lights.emitters.emitters[index].point(b).distance(position);
        let emission = lights.emitters.emission(world.scene(), index, b, -sample.direction);
        assert!(emission.0 == sample.emission && sample.source == lights.emitters.source(index, Vec2::ZERO));
        let stated = lights.surface_pdf(&receiver, index, emission, sample.direction, distance);
        disagreed += usize::from((stated / sample.pdf - 1.0).abs() > 1e-4);
        samples += 1;
    }
    // Allow one disagreement in 1000, for receivers within millimetres of a face: there f32 rounds the distance, and
    // thus the pdf, by more than the tolerance of 1e-4.
    assert!(samples > 8000 && disagreed <= samples / 1000, "{disagreed} of {samples}");
}

/// A panel in the plane of the ceiling counts as in front of it: the ceiling hides neither the panel nor its light.
#[test]
fn a_panel_in_the_plane_of_the_ceiling_is_in_front_of_it() {
    let luminaire = round([0.6, 0.6, 0.0], |g| 1000.0 * 0.36 * g.cos().max(0.0));
    for offset in [Vec3::ZERO, Vec3::new(4000.0, 120.0, -900.0)] {
        let mut scene = hung(luminaire.clone());
        scene.lights[0] = light_at(offset + Vec3::Y * 3.0);
        let corner = offset + Vec3::new(-3.0, 3.0, -3.0);
        scene.meshes = vec![Mesh::parallelogram(corner, Vec3::X * 6.0, Vec3::Z * 6.0, 0)];
        let world = world(scene);
        let expected = 4.0 * PI * 1000.0 * parallel_form_factor(0.3, 0.3, 3.0);
        let (mean, error) = lux(&world, offset, Vec3::Y, 512);
        assert!((mean - expected).abs() < 4.0 * error + 1e-3 * expected, "{mean} ± {error}, expected {expected}");
        // The picture shows the panel with its luminance of 1000 cd/m², and the black ceiling around it.
        let camera = Camera::look_at(offset + Vec3::new(1.5, 0.0, 0.5), offset + Vec3::Y * 3.0, 0.6);
        let film = render(&world, &camera, &Params { width: 48, height: 48, samples: 16, ..Params::default() });
        let data = &film.beauty.data;
        let whole = data.iter().filter(|v| (**v / 1000.0 - 1.0).abs() < 1e-3).count();
        let dark = data.iter().filter(|v| **v == 0.0).count();
        assert!(whole > 3 * 120 && dark > 3 * 1000, "{whole} {dark}");
        // All other pixels lie on the outline of the panel.
        assert!(data.len() - whole - dark < 3 * 4 * 48, "{whole} {dark}");
        assert!(data.iter().all(|v| *v < 1001.0));
    }
}

/// Outside a closed box around a luminaire it is dark; inside the box it is lit. Inside the luminaire itself it is
/// dark.
#[test]
fn hidden_faces_do_not_shine() {
    let mut scene = hung(uneven([1.2, 0.3, 0.1]));
    let [x, y, z] = Vec3::AXES.map(|axis| axis * 2.0);
    let (low, high) = (-Vec3::ONE, Vec3::ONE);
    let sides = [(low, x, y), (low, y, z), (low, z, x), (high, -x, -y), (high, -y, -z), (high, -z, -x)];
    scene.meshes.extend(sides.map(|(corner, u, v)| Mesh::parallelogram(corner, u, v, 0)));
    let boxed = world(scene);
    for (c, gamma) in [(0.0, 0.0), (30.0, 60.0), (200.0, 130.0)] {
        let towards = direction(c, gamma);
        assert_eq!(lux(&boxed, towards * 5.0, -towards, 16).0, 0.0);
        assert!(lux(&boxed, towards * 0.9, -towards, 16).0 > 10.0);
    }
    for size in [[1.2, 0.3, 0.1], [-0.3; 3], [-0.4, -0.4, 0.3]] {
        let open = world(hung(uneven(size)));
        for normal in [Vec3::X, Vec3::Y, Vec3::NEG_Y] {
            assert_eq!(lux(&open, Vec3::new(0.01, 0.02, 0.005), normal, 64).0, 0.0, "{size:?}");
        }
    }
}

/// Luminaires without size, or smaller than a millimetre, shine as points. Luminaires of 10 km light a surface like a
/// sky.
#[test]
fn sizes_may_be_extreme() {
    let lambertian = |size: [f64; 3], flux: f64| Luminaire::lambertian("", flux, size);
    for size in [[0.0; 3], [1e-4; 3], [-5e-4, -5e-4, 0.0]] {
        let scene = hung(lambertian(size, 1000.0 * PI));
        assert_eq!(scene.unseen_lights(), 1);
        let (mean, _) = lux(&world(scene), Vec3::NEG_Y, Vec3::Y, 16);
        assert!((mean / 1000.0 - 1.0).abs() < 1e-3, "{size:?}: {mean}");
    }
    // A luminaire of 2 mm has faces, but its light is nearly the light of a point.
    let small = world(hung(lambertian([2e-3, 2e-3, 0.0], 1000.0 * PI)));
    assert!((lux(&small, Vec3::NEG_Y, Vec3::Y, 16).0 / 1000.0 - 1.0).abs() < 1e-3);
    // A panel of 10 km × 10 km with 100 lm/m² gives 100 lx everywhere below its middle.
    for size in [[1e4, 1e4, 0.0], [-1e4, -1e4, 0.0]] {
        let area = if size[0] > 0.0 { 1e8 } else { FRAC_PI_4 * 1e8 };
        let huge = world(hung(lambertian(size, 100.0 * area)));
        let (mean, error) = lux(&huge, Vec3::new(3.0, -2.0, 5.0), Vec3::Y, 512);
        assert!((mean - 100.0).abs() < 4.0 * error + 0.2 && error < 0.5, "{size:?}: {mean} ± {error}");
    }
    // A luminance that would overflow is refused.
    let bright = hung(lambertian([2e-3, 2e-3, 0.0], 1e12));
    let error = World::build(Arc::new(bright), Monitor::default().job()).err().unwrap();
    assert!(error.message.contains("light 0") && error.message.contains("luminance"), "{error}");
}

/// A luminaire that emits no light still blocks light with its faces, unless it is treated as a point.
#[test]
fn dark_faces_block_light() {
    let behind = |change: &dyn Fn(&mut PunctualLight)| {
        let mut scene = hung(uneven([0.6, 0.6, 0.1]));
        change(&mut scene.lights[0]);
        scene.lights.push(PunctualLight::Point { position: Vec3::Y, intensity: Vec3::splat(100.0) });
        lux(&world(scene), Vec3::NEG_Y, Vec3::Y, 16).0
    };
    let dark = |light: &mut PunctualLight| {
        if let PunctualLight::Luminaire { colour, .. } = light {
            *colour = Vec3::ZERO;
        }
    };
    assert_eq!(behind(&dark), 0.0);
    let point = behind(&|light| {
        dark(light);
        if let PunctualLight::Luminaire { is_point, .. } = light {
            *is_point = true;
        }
    });
    assert!((point - 25.0).abs() < 1e-3, "{point}");
}

/// A grey room with luminaires of all shapes.
fn bright_room() -> Scene {
    let (x, y, z) = (Vec3::X * 6.0, Vec3::Y * 3.0, Vec3::Z * 8.0);
    let corners = [(Vec3::ZERO, z, x), (y, x, z), (Vec3::ZERO, x, y), (z, y, x), (Vec3::ZERO, y, z), (x, z, y)];
    let place = |i: usize| Vec3::new(1.0 + 2.0 * (i % 3) as f32, 2.4, 1.0 + 2.0 * (i / 3) as f32);
    let light = |i: usize| match light_at(place(i)) {
        PunctualLight::Luminaire { position, axis, c0, colour, is_point, .. } => {
            PunctualLight::Luminaire { position, axis, c0, colour, distribution: i, is_point }
        }
        other => other,
    };
    Scene {
        meshes: corners.map(|(corner, a, b)| Mesh::parallelogram(corner, a, b, 0)).into(),
        materials: vec![matt(0.6, 0.0)],
        lights: (0..SHAPES.len()).map(light).collect(),
        distributions: SHAPES.map(|size| Arc::new(uneven(size))).into(),
        ..Scene::default()
    }
}

#[test]
fn any_number_of_threads_renders_the_same_bits() {
    let world = world(bright_room());
    let camera = Camera::look_at(Vec3::new(5.5, 1.5, 7.5), Vec3::new(2.0, 1.5, 2.0), 1.2);
    let params = Params { width: 64, height: 48, samples: 16, ..Params::default() };
    let film = |threads| Pool::new(threads).unwrap().run(|| render(&world, &camera, &params).beauty.data);
    let one = film(1);
    assert!(one.iter().any(|v| *v > 100.0));
    assert!(one == film(2) && one == film(3));
}

/// The layers of the single lights add up to the image, also in pixels that show the luminaires themselves. The object
/// and material layers have numbers for the faces of luminaires.
#[test]
fn layers_and_attributes_know_the_luminaires() {
    let world = world(bright_room());
    let camera = Camera::look_at(Vec3::new(3.0, 0.5, 1.0), Vec3::new(3.0, 2.4, 1.0), 1.4);
    let mut params = Params { width: 32, height: 32, samples: 16, ..Params::default() };
    for i in 0..SHAPES.len() {
        params.outputs.add(&format!("light{i}"), &format!("C.*<L.'light{i}'>")).unwrap();
    }
    params.outputs.aovs = vec![Aov::Object, Aov::Material];
    let film = render(&world, &camera, &params);
    let mut sums = vec![0.0f64; film.beauty.data.len()];
    for layer in &film.layers[..SHAPES.len()] {
        sums.iter_mut().zip(&layer.image.data).for_each(|(sum, v)| *sum += f64::from(*v));
    }
    for (sum, beauty) in sums.iter().zip(&film.beauty.data) {
        assert!((sum - f64::from(*beauty)).abs() < 1e-3 * (1.0 + f64::from(*beauty)), "{sum} {beauty}");
    }
    // The centre shows the faces of light 1. Numbers start at 1. Object numbers of lights follow the object numbers of
    // the six meshes; the material number of all faces follows the number of the only material.
    let attributes = film.layers[SHAPES.len()..].iter().map(|layer| layer.image.pixel(16, 16)[0]);
    assert_eq!(attributes.collect::<Vec<_>>(), [6.0 + 1.0 + 1.0, 2.0]);
}
