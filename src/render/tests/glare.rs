//! Tests of the unified glare rating, against cases computed by hand and against an independent implementation.

use super::*;
use crate::exec::Pool;
use crate::photometry::Luminaire;
use crate::photometry::glare::position_index;
use crate::render::glare::{Eye, Origin, Params, Rating, rate};
use crate::rng;
use std::f64::consts::PI;

fn luminaire(position: Vec3, axis: Vec3, c0: Vec3) -> PunctualLight {
    PunctualLight::Luminaire { position, axis, c0, colour: Vec3::ONE, distribution: 0, is_point: false }
}

/// A room of 6 × 3 × 8 m with a corner at the origin. Luminaires with the given distribution hang at the given
/// positions.
fn room(distribution: Luminaire, places: &[Vec3]) -> Scene {
    let (x, y, z) = (Vec3::X * 6.0, Vec3::Y * 3.0, Vec3::Z * 8.0);
    let corners = [(Vec3::ZERO, z, x), (y, x, z), (Vec3::ZERO, x, y), (z, y, x), (Vec3::ZERO, y, z), (x, z, y)];
    Scene {
        meshes: corners.map(|(corner, a, b)| Mesh::parallelogram(corner, a, b, 0)).into(),
        materials: vec![matt(0.5, 0.0)],
        lights: places.iter().map(|p| luminaire(*p, Vec3::NEG_Y, Vec3::X)).collect(),
        distributions: vec![Arc::new(distribution)],
        ..Scene::default()
    }
}

fn rated(scene: Scene, eye: Eye, samples: u32) -> Rating {
    let (world, params) = (world(scene), Params { samples, seed: 3 });
    let rate = || rate(&world, &[eye], &params, Monitor::default().job()).unwrap();
    Pool::new(1).unwrap().run(rate).remove(0)
}

fn panel() -> Luminaire {
    Luminaire::lambertian("panel", 3000.0, [1.2, 0.3, 0.0])
}

const EYE: Eye = Eye { position: Vec3::new(3.0, 1.2, 7.5), direction: Vec3::NEG_Z };

/// A Lambertian panel of 3000 lm and area A = 0.36 m² hangs 3 m ahead of the eye and 1.5 m above it, at a distance of
/// r = √11.25 m. By hand: the luminance is L = 3000 / π / A. The solid angle is ω = A cos γ / r², with cos γ = 1.5 / r
/// at the panel. Guth's position index p belongs to the angles τ = 0 (from the vertical) and σ = 26.565° (from the line
/// of sight).
#[test]
fn a_panel_rates_as_computed_by_hand() {
    let rating = rated(room(panel(), &[Vec3::new(3.0, 2.7, 4.5)]), EYE, 1024);
    let [source] = rating.sources[..] else { panic!("{rating:?}") };
    assert!((source.luminance / 2652.58 - 1.0).abs() < 2e-3, "{source:?}");
    // ω = 0.36 × 0.447214 / 11.25 sr; p = exp(33.98e-3 × 26.565 + 21e-5 × 705.70) = exp(0.90268 + 0.14820) = 2.8602.
    assert!(
        (source.solid_angle - 0.014311).abs() < 1e-6 && (source.position_index - 2.8602).abs() < 2e-4,
        "{source:?}"
    );
    let expected = 8.0 * (0.25 / rating.background * source.luminance.powi(2) * 0.014311 / 2.8602f64.powi(2)).log10();
    assert!((rating.ugr - expected).abs() < 2e-3 && rating.ugr > 5.0, "{} {expected}", rating.ugr);
    assert!(rating.unrated_lux == 0.0 && rating.outside_range() == 0, "{rating:?}");
    assert!(rating.background_error < 0.05 * rating.background);
}

/// An independent implementation of the rating. Areas come from the shoelace formula on the plane perpendicular to the
/// line to the eye, and angles from their cosines.
fn independent(eye: Eye, lights: &[PunctualLight], background: f64) -> f64 {
    let ahead = eye.direction.as_dvec3().normalize();
    let mut sum = 0.0;
    for light in lights {
        let PunctualLight::Luminaire { position, axis, c0, .. } = *light else { continue };
        let (axis, c0) = (axis.as_dvec3(), c0.as_dvec3());
        let (half_c0, half_c90) = (c0 * 0.6, c0.cross(axis) * 0.15);
        let to_lamp = position.as_dvec3() - eye.position.as_dvec3();
        let (r, towards) = (to_lamp.length(), to_lamp.normalize());
        let (a, b) = towards.any_orthonormal_pair();
        let corners = [half_c0 + half_c90, half_c0 - half_c90, -half_c0 - half_c90, half_c90 - half_c0];
        let flat = corners.map(|c| [c.dot(a), c.dot(b)]);
        let area = (0..4).map(|i| (flat[i], flat[(i + 1) % 4])).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>();
        let area = area.abs() / 2.0;
        let gamma = (-towards.dot(axis)).clamp(-1.0, 1.0).acos();
        let candela = panel().intensity(0.0, gamma.to_degrees());
        if candela == 0.0 || towards.dot(ahead) <= 0.0 {
            continue;
        }
        let sigma = towards.dot(ahead).acos().to_degrees();
        let upright = (DVec3::Y - ahead * ahead.y).normalize();
        let tau = (towards - ahead * towards.dot(ahead)).normalize().dot(upright).acos().to_degrees();
        assert!(tau <= 90.0, "all lamps are above the eye");
        let p = ((35.2 - 0.31889 * tau - 1.22 * (-2.0 * tau / 9.0).exp()) * 1e-3 * sigma
            + (21.0 + 0.26667 * tau - 0.002963 * tau * tau) * 1e-5 * sigma * sigma)
            .exp();
        sum += (candela / area).powi(2) * area / (r * r) / (p * p);
    }
    8.0 * (0.25 / background * sum).log10()
}

#[test]
fn twenty_rooms_agree_with_independent_geometry() {
    let mut worst = 0.0f64;
    for seed in 0..20 {
        let random = |k: u64| (rng::hash(seed, &[k]) >> 40) as f32 / (1u64 << 24) as f32;
        let mut scene = room(panel(), &[]);
        for lamp in 0..2 + seed % 4 {
            let at = |k: u64| random(10 * lamp + k);
            let position = Vec3::new(1.0 + 4.0 * at(0), 2.2 + 0.6 * at(1), 1.0 + 6.0 * at(2));
            let axis = Vec3::new(0.6 * at(3) - 0.3, -1.0, 0.6 * at(4) - 0.3).normalize();
            let c0 = axis.cross(Vec3::new(at(5) - 0.5, 0.0, 1.0)).normalize();
            scene.lights.push(luminaire(position, axis, c0));
        }
        let direction = Vec3::new(random(91) - 0.5, 0.0, random(92) - 0.5);
        let eye = Eye { position: Vec3::new(1.0 + 4.0 * random(93), 1.2, 1.0 + 6.0 * random(94)), direction };
        // Treat the luminaires as points, which do not hide each other, because `independent` does not model hiding.
        for light in &mut scene.lights {
            if let PunctualLight::Luminaire { is_point, .. } = light {
                *is_point = true;
            }
        }
        let lights = scene.lights.clone();
        let rating = rated(scene, eye, 64);
        let expected = independent(eye, &lights, rating.background);
        assert_eq!(rating.ugr.is_finite(), expected.is_finite(), "{seed}: {rating:?}");
        if expected.is_finite() {
            worst = worst.max((rating.ugr - expected).abs());
        }
    }
    assert!(worst < 1e-3, "{worst}");
}

/// A calculation grid at the eye measures the direct plus the indirect illuminance. The background must be the
/// indirect part.
#[test]
fn the_background_is_the_indirect_illuminance() {
    use crate::render::illuminance::{self, CalculationPoints};
    let at = Vec3::new(3.0, 2.7, 4.5);
    let rating = rated(room(panel(), &[at]), EYE, 1 << 15);
    let world = world(room(panel(), &[at]));
    let (across, down) = (Vec3::X * 1e-4, Vec3::Y * 1e-4);
    let place = CalculationPoints::Grid { origin: EYE.position, across, down, normal: EYE.direction };
    let params = illuminance::Params { columns: 1, rows: 1, samples: 1 << 15, seed: 9 };
    let total = illuminance::run(&world, &place, &params, Monitor::default().job()).unwrap();
    // The panel of area A has the luminance L = 3000 / π / A. Sum up E = Σ L dA cos θ₁ cos θ₂ / r² over its 120 × 30
    // cells, with the cosine 1.5 / r at the panel and z / r at the eye.
    let of_cell = |i: usize| {
        let (x, z) = ((i % 120) as f64 / 100.0 - 0.595, 3.0 - (i / 120) as f64 / 100.0 + 0.145);
        3000.0 / PI / 3600.0 * 1.5 * z / (x * x + z * z + 1.5 * 1.5).powi(2)
    };
    let direct: f64 = (0..120 * 30).map(of_cell).sum();
    let error = (PI * rating.background_error).hypot(total.mean_error);
    let off = total.mean - direct - PI * rating.background;
    assert!(off.abs() < 4.0 * error + 2e-3 * direct && error < 0.02 * total.mean, "{off} ± {error}");
}

/// A room far from the origin gets the rating that it gets at the origin. All coordinates are multiples of 1/8 m, which
/// f32 represents exactly in both rooms.
#[test]
fn a_room_in_map_coordinates_rates_as_at_the_origin() {
    let shift = Vec3::new(524_288.0, 0.0, -1_048_576.0);
    let (at, eye) = (Vec3::new(3.0, 2.75, 4.5), Eye { position: Vec3::new(3.0, 1.25, 7.5), ..EYE });
    let home = rated(room(panel(), &[at]), eye, 256);
    let mut scene = room(panel(), &[at + shift]);
    scene.meshes.iter_mut().flat_map(|mesh| &mut mesh.positions).for_each(|p| *p += shift);
    let away = rated(scene, Eye { position: eye.position + shift, ..eye }, 256);
    assert!((away.background / home.background - 1.0).abs() < 1e-3, "{away:?} {home:?}");
    assert!((away.ugr - home.ugr).abs() < 1e-2, "{} {}", away.ugr, home.ugr);
}

#[test]
fn hidden_parts_do_not_glare() {
    let at = Vec3::new(3.0, 2.7, 4.5);
    let whole = rated(room(panel(), &[at]), EYE, 16).sources[0];
    // Place a screen between the eye and the panel, from x to x + `width` in metres. From x = 1, a width of 2 hides the
    // left half of the panel, and a width of 4 hides the whole panel.
    let screened = |x: f32, width: f32| {
        let mut scene = room(panel(), &[at]);
        let screen = Mesh::parallelogram(Vec3::new(x, 1.0, 5.5), Vec3::X * width, Vec3::Y * 1.9, 0);
        scene.meshes.push(screen);
        rated(scene, EYE, 16)
    };
    let half = screened(1.0, 2.0).sources[0];
    assert!((half.solid_angle / whole.solid_angle - 0.5).abs() < 1e-9, "{half:?} {whole:?}");
    assert_eq!(half.luminance, whole.luminance);
    let none = screened(1.0, 4.0);
    assert!(none.sources.is_empty() && none.ugr == f64::NEG_INFINITY, "{none:?}");
    // A luminaire may hide another one.
    let cube = Luminaire::lambertian("cube", 10.0, [0.3; 3]);
    let mut hiding = room(panel(), &[at, Vec3::new(3.0, 1.95, 6.0)]);
    hiding.distributions.push(Arc::new(cube));
    if let PunctualLight::Luminaire { distribution, .. } = &mut hiding.lights[1] {
        *distribution = 1;
    }
    let partly = rated(hiding, EYE, 16).sources[0];
    assert!(partly.origin == Origin::Light(0) && partly.solid_angle < 0.8 * whole.solid_angle, "{partly:?} {whole:?}");
    // A panel in the plane of the ceiling is visible as a whole.
    let flush = rated(room(panel(), &[Vec3::new(3.0, 3.0, 4.5)]), EYE, 16).sources[0];
    let distance_squared = 9.0 + 1.8f64 * 1.8;
    assert!((flush.solid_angle - 0.36 * 1.8 / distance_squared.powf(1.5)).abs() < 1e-7, "{flush:?}");
}

#[test]
fn limits_have_clear_answers() {
    let at = Vec3::new(3.0, 2.7, 4.5);
    // No source is in view if the luminaire is behind the eye.
    let away = rated(room(panel(), &[at]), Eye { direction: Vec3::Z, ..EYE }, 64);
    assert!(away.ugr == f64::NEG_INFINITY && away.sources.is_empty() && away.background > 0.0);
    // A black room has a black background.
    let mut black = room(panel(), &[at]);
    black.materials[0] = matt(0.0, 0.0);
    let black = rated(black, EYE, 64);
    assert!(black.ugr == f64::INFINITY && black.background == 0.0, "{black:?}");
    // A luminaire without dimensions is not rated. Instead, the illuminance that it causes at the eye is reported.
    let direct = 3000.0 / PI * 1.5 * 3.0 / 11.25f64.powi(2);
    let point = rated(room(Luminaire { size: [0.0; 3], ..panel() }, &[at]), EYE, 64);
    assert!(point.sources.is_empty() && (point.unrated_lux / direct - 1.0).abs() < 2e-3, "{point:?}");
    // A panel seen edge-on has no projected area and is not among the sources. Its light does not count as unrated,
    // even if it shines towards the eye.
    let even = Luminaire { gammas: vec![0.0, 180.0], candela: vec![300.0; 2], ..panel() };
    let edge_on = rated(room(even, &[Vec3::new(3.0, EYE.position.y, 4.5)]), EYE, 1024);
    assert!(edge_on.sources.is_empty() && edge_on.unrated_lux == 0.0 && edge_on.background > 0.0, "{edge_on:?}");
    // Observers inside a luminous opening are refused with a message that names the observer. Observers that look
    // straight up, or whose direction is invalid, are refused too.
    let scene = Arc::new(room(panel(), &[at]));
    let world = World::build(scene, Monitor::default().job()).unwrap();
    let refused =
        |eye: Eye| rate(&world, &[EYE, eye], &Params::default(), Monitor::default().job()).unwrap_err().message;
    let inside = refused(Eye { position: at + Vec3::X * 0.5, ..EYE });
    assert!(inside.contains("observer 1") && inside.contains("opening of light 0"), "{inside}");
    for direction in [Vec3::Y, Vec3::ZERO, Vec3::splat(f32::NAN)] {
        assert!(refused(Eye { direction, ..EYE }).contains("direction"), "{direction}");
    }
}

/// Returns the solid angle of a rectangle `a × b` at distance `c` from a point on the normal of one of its corners.
fn corner_solid_angle(a: f64, b: f64, c: f64) -> f64 {
    (a * b / (c * (a * a + b * b + c * c).sqrt())).atan()
}

/// A room in which one mesh emits light and reflects none.
fn shining_room(mesh: Mesh, luminance: f32) -> Scene {
    let mut scene = room(panel(), &[]);
    scene.materials.push(Material { double_sided: false, ..matt(0.0, luminance) });
    scene.meshes.push(Mesh { material: 1, ..mesh });
    scene
}

/// Compares a square panel of 0.3 m as a mesh with the same panel as a luminaire from a file. The panel lies 3 m ahead
/// of the eye and 1.5 m above it. There, its extent changes the position index and the solid angle of CIE 117 by less
/// than 0.3 %.
#[test]
fn a_panel_as_a_mesh_rates_as_the_panel_of_a_file() {
    let side = 0.3f32;
    let file = Luminaire::lambertian("panel", 800.0, [f64::from(side), f64::from(side), 0.0]);
    let at = Vec3::new(3.0, 2.7, 4.5);
    let of_file = rated(room(file, &[at]), EYE, 1 << 14);
    let luminance = 800.0 / PI / f64::from(side * side);
    let corner = at - Vec3::new(side / 2.0, 0.0, side / 2.0);
    let mesh = Mesh::parallelogram(corner, Vec3::X * side, Vec3::Z * side, 0);
    let of_mesh = rated(shining_room(mesh, luminance as f32), EYE, 1 << 14);
    let ([a], [b]) = (&of_file.sources[..], &of_mesh.sources[..]) else { panic!("{of_file:?} {of_mesh:?}") };
    assert_eq!((a.origin, b.origin), (Origin::Light(0), Origin::Mesh(6)));
    assert!(
        (b.luminance / luminance - 1.0).abs() < 1e-5 && (b.luminance / a.luminance - 1.0).abs() < 2e-3,
        "{a:?} {b:?}"
    );
    // The middle of the panel's near edge lies 1.5 m above the eye and 2.85 m ahead of it.
    let half = f64::from(side) / 2.0;
    let exact = 2.0 * (corner_solid_angle(half, 3.0 + half, 1.5) - corner_solid_angle(half, 3.0 - half, 1.5));
    assert!((b.solid_angle / exact - 1.0).abs() < 0.01, "{b:?} {exact}");
    // The position index belongs to the middle of the solid angle, which lies a little nearer to the eye than the
    // middle of the panel. Add up the directions to 100 × 100 cells, weighted by their solid angles cos γ / r².
    let cell = |i: usize| half * ((i % 100) as f64 / 50.0 - 0.99);
    let cells = (0..10_000).map(|i| DVec3::new(cell(i), 1.5, cell(i / 100) - 3.0));
    let middle = cells.map(|d| d / d.length().powi(4)).sum::<DVec3>();
    let index = position_index(middle);
    assert!((b.position_index / index - 1.0).abs() < 1e-3, "{b:?} {index}");
    assert!((b.position_index / a.position_index - 1.0).abs() < 3e-3, "{a:?} {b:?}");
    let error = of_file.background_error.hypot(of_mesh.background_error);
    assert!((of_file.background - of_mesh.background).abs() < 4.0 * error, "{of_file:?} {of_mesh:?}");
    let noise = 8.0 / 10f64.ln() * (4.0 * error / of_mesh.background + 0.015);
    assert!((of_mesh.ugr - of_file.ugr).abs() < noise && noise < 0.4, "{} {} ± {noise}", of_mesh.ugr, of_file.ugr);
    assert_eq!((of_mesh.unrated_lux, of_mesh.outside_range()), (0.0, 0));
    // The back of the panel is dark.
    let mut turned = Mesh::parallelogram(corner, Vec3::X * side, Vec3::Z * side, 0);
    turned.triangles.iter_mut().for_each(|triangle| triangle.swap(0, 1));
    assert!(rated(shining_room(turned, 1000.0), EYE, 64).sources.is_empty());
}

/// A profile of 30 mm, 5 m ahead, is a third as wide as a cell of the raster. The rating still finds its whole solid
/// angle, whether the profile runs across the view or along it.
#[test]
fn a_narrow_profile_is_seen_as_a_whole() {
    let (narrow, long, above) = (0.03f32, 3.0f32, 1.5);
    let half = |length: f32| f64::from(length) / 2.0;
    let strip = |along_x: f32, along_z: f32| {
        let corner = Vec3::new(3.0 - along_x / 2.0, 2.7, 2.5 - along_z / 2.0);
        let mesh = Mesh::parallelogram(corner, Vec3::X * along_x, Vec3::Z * along_z, 0);
        let (near, far) = (5.0 - half(along_z), 5.0 + half(along_z));
        let [far, near] = [far, near].map(|z| corner_solid_angle(half(along_x), z, above));
        (rated(shining_room(mesh, 3000.0), EYE, 64), 2.0 * (far - near))
    };
    for (rating, exact) in [strip(long, narrow), strip(narrow, long)] {
        let found: f64 = rating.sources.iter().map(|source| source.solid_angle).sum();
        assert!((found / exact - 1.0).abs() < 0.1, "{found} {exact}");
        assert!(rating.sources.iter().all(|source| (source.luminance / 3000.0 - 1.0).abs() < 1e-5), "{rating:?}");
    }
}

/// A sphere of radius R at distance d has the solid angle 2π (1 - √(1 - R²/d²)) and its own luminance.
#[test]
fn a_sphere_of_uniform_radiance_has_its_closed_form() {
    let centre = Vec3::new(3.0, 2.2, 4.5);
    let squared = (centre - EYE.position).as_dvec3().length_squared();
    for diameter in [0.15, 0.4, 1.2] {
        let exact = 2.0 * PI * (1.0 - (1.0 - (diameter / 2.0f64).powi(2) / squared).sqrt());
        let scene = shining_room(ball(centre, diameter), 3000.0);
        let whole = rated(scene.clone(), EYE, 64);
        let [source] = whole.sources[..] else { panic!("{whole:?}") };
        assert!((source.luminance / 3000.0 - 1.0).abs() < 1e-5, "{source:?}");
        assert!((source.solid_angle / exact - 1.0).abs() < 0.015, "{diameter}: {source:?} {exact}");
        // The centre of the sphere is straight ahead and up, at the angle σ from the line of sight with tan σ = 1 / 3.
        let sigma = (1.0f64 / 3.0).atan().to_degrees();
        let index = (33.98e-3 * sigma + 21e-5 * sigma * sigma).exp();
        assert!((source.position_index / index - 1.0).abs() < 0.01, "{source:?} {index}");
        // A screen hides the half to the left of the middle.
        let mut screened = scene.clone();
        screened.meshes.push(Mesh::parallelogram(Vec3::new(1.0, 0.5, 6.5), Vec3::X * 2.0, Vec3::Y * 2.4, 0));
        let half = rated(screened, EYE, 64);
        let [left] = half.sources[..] else { panic!("{half:?}") };
        assert!((left.solid_angle / exact - 0.5).abs() < 0.015 && left.luminance == source.luminance, "{left:?}");
        // A thin bar in front of the ball does not make two sources of it.
        let mut barred = scene;
        barred.meshes.push(Mesh::parallelogram(Vec3::new(2.99, 0.5, 6.5), Vec3::X * 0.02, Vec3::Y * 2.4, 0));
        assert_eq!(rated(barred, EYE, 64).sources.len(), 1);
    }
}

/// An emission texture on one mesh holds three lamps and a glow around them.
#[test]
fn lamps_of_a_texture_are_sources_of_their_own() {
    let texture = Image::from_fn(32, 32, |x, y| match (x / 4, y / 4) {
        (1 | 5, 1) => [1.0; 3],
        (3, 5) => [0.5; 3],
        _ => [0.01; 3],
    });
    let sheet = Mesh::parallelogram(Vec3::new(2.0, 2.9, 3.0), Vec3::X * 2.0, Vec3::Z * 2.0, 0);
    let mut scene = shining_room(sheet, 8000.0);
    scene.materials[1].emission_texture = Some(TextureRef::new(0));
    scene.textures.push(Texture::new("lamps", texture.unwrap()));
    let rating = rated(scene.clone(), EYE, 1024);
    let mut luminances: Vec<f64> = rating.sources.iter().map(|source| source.luminance).collect();
    luminances.sort_by(f64::total_cmp);
    assert_eq!(luminances.len(), 3, "{rating:?}");
    assert!(luminances.iter().zip([4000.0, 8000.0, 8000.0]).all(|(l, want)| (l / want - 1.0).abs() < 1e-5));
    // The lamps have 3/64 of the sheet. The rest emits 80 cd/m², which the rating leaves out: its illuminance at the
    // eye is at most 80 times the solid angle of the sheet.
    let projected = |light: f32| {
        let mut plain = scene.clone();
        (plain.materials[1].emission, plain.materials[1].emission_texture) = (Vec3::splat(light), None);
        rated(plain, EYE, 1024).sources[0].solid_angle
    };
    assert!(rating.unrated_lux > 0.5 * 80.0 * 0.4 * projected(1.0) && rating.unrated_lux < 80.0 * projected(1.0));
    // Two meshes that do not touch are two sources. A mesh behind the eye is no source.
    let mut two = shining_room(ball(Vec3::new(2.0, 2.2, 4.5), 0.3), 3000.0);
    two.meshes.push(Mesh { material: 1, ..ball(Vec3::new(3.0, 2.0, 7.9), 0.1) });
    let one = rated(two.clone(), EYE, 64).sources;
    two.meshes.push(Mesh { material: 1, ..ball(Vec3::new(4.0, 2.2, 4.5), 0.3) });
    let both = rated(two, EYE, 64).sources;
    assert_eq!((one.len(), both.len(), both[0].origin, both[1].origin), (1, 2, Origin::Mesh(6), Origin::Mesh(8)));
}

/// The picture of a room shows its luminaires, so the rating of the picture agrees with the rating computed from the
/// luminaires.
#[test]
fn pictures_rate_as_the_luminaires_in_them() {
    use crate::photometry::glare;
    let disc = Luminaire::lambertian("disc", 2500.0, [-0.5, -0.5, 0.0]);
    let globe = Luminaire {
        gammas: vec![0.0, 180.0],
        candela: vec![300.0; 2],
        ..Luminaire::lambertian("globe", 0.0, [-0.35, -0.35, -0.35])
    };
    let places = [[2.0, 2.8, 5.0], [4.0, 2.8, 5.0], [3.0, 2.6, 2.5]].map(Vec3::from);
    for (name, luminaire) in [("panel", panel()), ("disc", disc), ("globe", globe)] {
        let scene = room(luminaire, &places);
        let rating = rated(scene.clone(), EYE, 1 << 13);
        let camera = Camera { position: EYE.position, ..Camera::look_at(Vec3::ZERO, EYE.direction, 2.4) };
        // Trace one path per pixel, so that each pixel shows either a lamp or none. With several paths, pixels at the
        // edge of a lamp would show a mean luminance, whose square is too small.
        let params = crate::render::Params { width: 1000, height: 1000, samples: 1, ..Default::default() };
        let film = Pool::new(2).unwrap().run(|| render(&world(scene), &camera, &params));
        let seen =
            glare::rate(&film.beauty, &glare::Params { fov_y: 2.4, threshold: 1300.0, ..Default::default() }).unwrap();
        // Bright pixels of noise count as small sources, too. Count only the large sources, which are the luminaires.
        let large = seen.sources.iter().filter(|s| s.solid_angle > 1e-3).count();
        assert_eq!((large, rating.sources.len(), film.unseen_lights), (3, 3, 0), "{name}");
        assert!((seen.ugr - rating.ugr).abs() < 0.5, "{name}: {seen:?} {rating:?}");
        // Compare the sums over the sources alone, without the background luminance.
        let sums = [
            seen.sources.iter().map(|s| s.luminance.powi(2) * s.solid_angle / s.position.powi(2)).sum::<f64>(),
            rating.sources.iter().map(|s| s.luminance.powi(2) * s.solid_angle / s.position_index.powi(2)).sum(),
        ];
        assert!((8.0 * (sums[0] / sums[1]).log10()).abs() < 0.25, "{name}: {sums:?}");
    }
}
