//! Tests of the goniophotometer: bodies whose distributions have closed forms, and energy balance.

use super::*;
use crate::exec::Pool;
use crate::photometry::{Format, Luminaire};
use crate::render::gonio::{Output, Params, measure};
use crate::render::illuminance::{self, CalculationPoints};
use std::f64::consts::{FRAC_PI_4, PI};

/// A scene of meshes with materials of their own, each with an albedo and a luminance of the front side.
fn scene(bodies: Vec<(Mesh, f32, f32)>) -> Scene {
    let mut scene = Scene::default();
    for (material, (mesh, albedo, luminance)) in bodies.into_iter().enumerate() {
        scene.materials.push(Material { double_sided: false, ..matt(albedo, luminance) });
        scene.meshes.push(Mesh { material, ..mesh });
    }
    scene
}

fn run(scene: &Scene, params: &Params) -> Result<Output> {
    Pool::new(2).unwrap().run(|| measure(scene, &[], params, Monitor::default().job()))
}

fn few(samples: u32) -> Params {
    Params { planes: 8, angles: 19, samples, ..Params::default() }
}

/// A square that faces down; `side` is the length of its sides.
fn panel(centre: Vec3, side: f32) -> Mesh {
    Mesh::parallelogram(centre - Vec3::new(side, 0.0, side) / 2.0, Vec3::X * side, Vec3::Z * side, 0)
}

/// A horizontal disc that faces down: a polygon with the area of the circle.
fn disc(centre: Vec3, diameter: f64) -> Mesh {
    let opening = Opening::Cylinder { axis: 2, length: 0.0, diameters: [diameter; 2] };
    let faces = Faces::new(&opening, Emits { forwards: true, backwards: false }, 0.0);
    // Turn z, the direction of the normal, down.
    let positions = faces.points.iter().map(|p| centre + Vec3::new(p.x as f32, -p.z as f32, p.y as f32)).collect();
    Mesh { positions, triangles: faces.triangles, ..Mesh::default() }
}

/// A box that is open below: four walls over a square of width `side`, with the height `height`, and a top. The top
/// lies a little above the upper edges of the walls.
fn shade(centre: Vec3, side: f32, height: f32) -> Mesh {
    let (low, x, y, z) =
        (centre - Vec3::new(side, 2.0 * height, side) / 2.0, Vec3::X * side, Vec3::Y * height, Vec3::Z * side);
    let top = low + y + Vec3::Y * 1e-4;
    let mut mesh = Mesh::default();
    for (corner, u, v) in [(low, x, y), (low + z, x, y), (low, y, z), (low + x, y, z), (top, x, z)] {
        let first = mesh.positions.len() as u32;
        let wall = Mesh::parallelogram(corner, u, v, 0);
        mesh.positions.extend(wall.positions);
        mesh.triangles.extend(wall.triangles.iter().map(|triangle| triangle.map(|i| i + first)));
    }
    mesh
}

/// A panel fills its box, so every ray meets it: `I = L A cos γ` has no noise.
#[test]
fn a_panel_is_exact() {
    let centre = Vec3::new(1.0, 2.5, -3.0);
    let output = run(&scene(vec![(panel(centre, 0.5), 0.3, 2000.0)]), &few(16)).unwrap();
    let l = &output.luminaire;
    for (i, value) in l.candela.iter().enumerate() {
        let cosine = l.gammas[i % 19].to_radians().cos().max(0.0);
        assert!((value - 500.0 * cosine).abs() < 1e-2, "{value} cd at {} degrees", l.gammas[i % 19]);
    }
    assert!(output.intensity_error < 1e-2 && output.position.distance(centre) < 1e-6, "{output:?}");
    assert!((l.size[0] - 0.5).abs() < 1e-6 && (l.size[1] - 0.5).abs() < 1e-6 && l.size[2] == 0.0, "{:?}", l.size);
    assert_eq!((l.planes.len(), l.gammas[18], l.planes[1], l.lamp_flux), (8, 180.0, 45.0, 0.0));
}

/// A Lambertian disc has `I = I₀ cos γ` with `I₀ = L A`.
#[test]
fn a_lambertian_disc_has_its_cosine() {
    let output = run(&scene(vec![(disc(Vec3::Y, 0.4), 0.0, 3000.0)]), &few(4096)).unwrap();
    let l = &output.luminaire;
    let peak = 3000.0 * FRAC_PI_4 * 0.16;
    for (i, value) in l.candela.iter().enumerate() {
        let off = value - peak * l.gammas[i % 19].to_radians().cos().max(0.0);
        assert!(off.abs() < 4.0 * output.intensity_error + 1e-3, "{off} of {value} at {}", l.gammas[i % 19]);
    }
    // The flux equals the flux of the cosine distribution, interpolated between the angles γ.
    let cosine = Luminaire {
        candela: l.gammas.iter().map(|g| peak * g.to_radians().cos().max(0.0)).collect(),
        planes: vec![0.0],
        ..l.clone()
    };
    assert!(
        (l.flux() - cosine.flux()).abs() < 4.0 * output.flux_error,
        "{} {} ± {}",
        l.flux(),
        cosine.flux(),
        output.flux_error
    );
    assert!(output.intensity_error < 0.01 * peak && output.flux_error < 2e-3 * cosine.flux(), "{output:?}");
    assert!(l.size[0] < 0.0 && l.size[1] < 0.0 && l.size[2] == 0.0 && (l.size[0] + 0.4).abs() < 1e-3, "{:?}", l.size);
}

/// A sphere of uniform luminance has the intensity `L π R²` in all directions, and the flux `4 π² L R²`.
#[test]
fn a_uniform_sphere_is_constant() {
    let output = run(&scene(vec![(ball(Vec3::new(0.0, 2.0, 0.0), 0.3), 0.0, 1000.0)]), &few(1 << 14)).unwrap();
    let (l, exact) = (&output.luminaire, 1000.0 * FRAC_PI_4 * 0.09);
    let error = 4.0 * output.intensity_error + 8.1e-4 * exact;
    assert!(l.candela.iter().all(|value| (value - exact).abs() < error) && error < 0.03 * exact, "{error} of {exact}");
    let off = l.flux() - 4.0 * PI * exact;
    assert!(off.abs() < 4.0 * output.flux_error + 8.1e-4 * 4.0 * PI * exact, "{off} ± {}", output.flux_error);
    assert!(l.size.iter().all(|side| (side + 0.3).abs() < 1e-3), "{:?}", l.size);
}

/// Returns the form factor between two equal, parallel squares that face each other, from one to the other. `distance`
/// is the distance between them, as a multiple of their side.
fn opposite_squares(distance: f64) -> f64 {
    let x = 1.0 / distance;
    let root = (1.0 + x * x).sqrt();
    let logarithm = ((1.0 + x * x).powi(2) / (1.0 + 2.0 * x * x)).sqrt().ln();
    2.0 / (PI * x * x) * (logarithm + 2.0 * x * root * (x / root).atan() - 2.0 * x * x.atan())
}

/// A panel at the upper end of a shade, whose lower end is open. A black shade lets out the share of the flux that
/// the form factor between panel and open end states. White surfaces absorb nothing, so all flux leaves.
#[test]
fn the_flux_of_a_shaded_lamp_balances() {
    let (side, centre) = (0.2f32, Vec3::new(0.5, 1.0, 0.5));
    let emitted = PI * 5000.0 * f64::from(side * side);
    for (height, albedo, expected) in [
        (0.2f32, 0.0, emitted * opposite_squares(1.0)),
        (0.1, 0.0, emitted * opposite_squares(0.5)),
        (0.2, 1.0, emitted),
    ] {
        let bodies = vec![(panel(centre, side), albedo, 5000.0), (shade(centre, side, height), albedo, 0.0)];
        let output = run(&scene(bodies), &Params { planes: 72, angles: 73, ..few(128) }).unwrap();
        let off = output.luminaire.flux() / expected - 1.0;
        let error = output.flux_error / expected;
        assert!(off.abs() < 4.0 * error + 2e-3 && error < 5e-3, "{height} {albedo}: {off} ± {error}");
        // The shade does not change the shape of the opening: it is the square panel.
        assert!(output.luminaire.size[0] > 0.0 && output.luminaire.size[2] == 0.0, "{:?}", output.luminaire.size);
        // Above the horizon no light leaves.
        assert!(output.luminaire.intensity(77.0, 95.0) < 1e-9 * expected);
    }
    assert!((opposite_squares(1.0) - 0.1998).abs() < 1e-4);
}

/// The stated errors agree with the scatter of independent runs.
#[test]
fn errors_are_standard_errors() {
    let shaded = scene(vec![(ball(Vec3::Y, 0.2), 0.5, 1000.0), (shade(Vec3::new(0.0, 1.2, 0.0), 0.3, 0.3), 0.5, 0.0)]);
    let runs: Vec<Output> = (0..24).map(|seed| run(&shaded, &Params { seed, ..few(64) }).unwrap()).collect();
    let mean = runs.iter().map(|o| o.luminaire.flux()).sum::<f64>() / 24.0;
    let spread = runs.iter().map(|o| (o.luminaire.flux() - mean).powi(2)).sum::<f64>() / 23.0;
    let stated = runs.iter().map(|o| o.flux_error.powi(2)).sum::<f64>() / 24.0;
    // With 23 degrees of freedom, the ratio lies between these bounds with a probability of 0.9998.
    assert!((0.25..2.6).contains(&(spread / stated)), "{spread} {stated}");
    let again = Pool::new(1)
        .unwrap()
        .run(|| measure(&shaded, &[0, 1], &Params { seed: 3, ..few(64) }, Monitor::default().job()));
    assert_eq!(again.unwrap(), runs[3]);
}

fn lux(scene: Scene, at: Vec3) -> (f64, f64) {
    let place = CalculationPoints::Grid { origin: at, across: Vec3::X * 1e-3, down: Vec3::Z * 1e-3, normal: Vec3::Y };
    let params = illuminance::Params { columns: 1, rows: 1, samples: 1 << 15, seed: 5 };
    let output = illuminance::run(&world(scene), &place, &params, Monitor::default().job()).unwrap();
    (output.mean, output.mean_error)
}

/// The distribution of a lamp with a black shade is written to a file and read back. Far away, a luminaire with this
/// distribution gives the same illuminance as the lamp. (From a white shade, light would reach the points by paths that
/// few rays from the points find.)
#[test]
fn a_written_distribution_lights_as_the_body() {
    let centre = Vec3::new(0.5, 12.0, -0.5);
    let bodies = vec![(panel(centre, 0.2), 0.0, 5000.0), (shade(centre, 0.2, 0.1), 0.0, 0.0)];
    let lamp = scene(bodies);
    let output = run(&lamp, &Params { planes: 24, angles: 73, ..few(1024) }).unwrap();
    for format in [Format::Ies, Format::Ldt, Format::Tm33, Format::Gldf] {
        let read = format.read(&format.write(&output.luminaire).unwrap(), None).unwrap().luminaire;
        assert!((read.flux() / output.luminaire.flux() - 1.0).abs() < 1e-6, "{format:?}");
        for at in [Vec3::new(0.5, 0.0, -0.5), Vec3::new(6.0, 0.0, 0.3), Vec3::new(-7.0, 0.0, 6.0)] {
            let (of_lamp, lamp_error) = lux(lamp.clone(), at);
            let light = PunctualLight::Luminaire {
                position: output.position,
                axis: Vec3::NEG_Y,
                c0: Vec3::X,
                colour: Vec3::ONE,
                distribution: 0,
                is_point: false,
            };
            let file = Scene { lights: vec![light], distributions: vec![Arc::new(read.clone())], ..Scene::default() };
            let (of_file, file_error) = lux(file, at);
            let offset = (at - output.position).as_dvec3();
            let error =
                lamp_error.hypot(file_error).hypot(output.intensity_error * -offset.y / offset.length().powi(3));
            // At a distance of 12 m, 60 times the size of the lamp, the far field holds: the part of the panel that the
            // shade hides differs by less than 1 % between the directions of the lamp's two edges.
            assert!(
                (of_file - of_lamp).abs() < 4.0 * error + 0.01 * of_lamp && error < 0.02 * of_lamp,
                "{format:?} at {at}: {of_file} {of_lamp} ± {error}"
            );
        }
    }
}

#[test]
fn the_axes_and_the_lit_part_are_those_of_the_luminaire() {
    // Two of sixteen texels of a wall lamp that faces +x are lit: 0.2 m high and 0.125 m wide.
    let mut mesh = Mesh::parallelogram(Vec3::new(4.0, 1.0, 2.0), Vec3::Y * 0.4, Vec3::Z * 0.5, 0);
    mesh.name = "Wall lamp".into();
    let mut lamp = scene(vec![(mesh, 0.0, 1000.0)]);
    let lit = |x: usize, y: usize| [f32::from(u8::from(y == 1 && (x == 1 || x == 2)))];
    lamp.textures.push(Texture::new("lit", Image::from_fn(4, 4, lit).unwrap()));
    lamp.materials[0].emission_texture = Some(TextureRef::new(0));
    let params = Params { axis: Vec3::X, c0: Vec3::Y, ..few(2048) };
    let output = run(&lamp, &params).unwrap();
    let l = &output.luminaire;
    assert_eq!((l.name.as_str(), l.size[2]), ("Wall lamp", 0.0));
    assert!((l.size[0] - 0.2).abs() < 1e-5 && (l.size[1] - 0.125).abs() < 1e-5, "{:?}", l.size);
    assert!(output.position.distance(Vec3::new(4.0, 1.2, 2.1875)) < 1e-5, "{}", output.position);
    let off = (l.intensity(0.0, 0.0) - 25.0).abs().max((l.intensity(90.0, 60.0) - 12.5).abs());
    assert!(
        off < 1e-5 + 4.0 * output.intensity_error && output.intensity_error < 0.5,
        "{off} ± {}",
        output.intensity_error
    );
    // In the coordinates of a map, the lamp has the same flux as at the origin, up to rounding.
    let shift = Vec3::new(524_288.0, 0.0, -1_048_576.0);
    lamp.meshes[0].positions.iter_mut().for_each(|p| *p += shift);
    let away = run(&lamp, &params).unwrap();
    assert!((away.luminaire.flux() / l.flux() - 1.0).abs() < 0.05, "{} {}", away.luminaire.flux(), l.flux());
}

#[test]
fn meshes_are_chosen_and_bad_input_is_refused() {
    // A room with a lamp: only the chosen mesh counts, without lights and sky.
    let mut room = scene(vec![(panel(Vec3::Y, 0.5), 0.3, 2000.0), (inward_sphere(3.0, 0), 0.8, 0.0)]);
    room.lights.push(PunctualLight::Point { position: Vec3::ZERO, intensity: Vec3::splat(1e4) });
    room.environment = Some(Environment::Constant(Vec3::splat(500.0)));
    let run = |meshes: &[u32], params: &Params| {
        Pool::new(1).unwrap().run(|| measure(&room, meshes, params, Monitor::default().job()))
    };
    let alone = run(&[0, 0], &few(16)).unwrap();
    assert!((alone.luminaire.intensity(0.0, 0.0) - 500.0).abs() < 1e-2);
    for (meshes, params, word) in [
        (vec![], few(16), "leaves the meshes"),
        (vec![1], few(16), "emits light"),
        (vec![2], few(16), "mesh is 2"),
        (vec![0], Params { planes: 0, ..few(16) }, "planes"),
        (vec![0], Params { angles: 1, ..few(16) }, "angles"),
        (vec![0], Params { samples: 15, ..few(16) }, "samples"),
    ] {
        let refused = run(&meshes, &params).unwrap_err().message;
        assert!(refused.contains(word), "{refused}");
    }
    let cancelled = Monitor::default();
    cancelled.cancel();
    assert!(measure(&room, &[0], &few(16), cancelled.job()).is_err());
}
