//! Tests of the layers (light path expressions and surface attributes), against closed forms, each other, and the main
//! image.

use super::*;
use crate::exec::Pool;
use crate::image::colour;
use crate::render::lpe::EmitterAs;

const FIVE: [(&str, &str); 5] =
    [("Full", "L.*E"), ("LDE", "LDE"), ("LSE", "LSE"), ("LDDE", "L.*DDE"), ("LD12E", "LD{1,2}E")];

fn outputs(expressions: &[(&str, &str)], aovs: &[Aov]) -> Outputs {
    let mut outputs = Outputs { aovs: aovs.to_vec(), ..Outputs::default() };
    expressions.iter().for_each(|(name, text)| outputs.add(name, text).unwrap());
    outputs
}

fn with(params: &Params, expressions: &[(&str, &str)], aovs: &[Aov]) -> Params {
    Params { outputs: outputs(expressions, aovs), ..params.clone() }
}

fn layer<'a>(film: &'a Film, name: &str) -> &'a Image {
    &film.layers.iter().find(|l| l.name == name).unwrap().image
}

/// A scene with a lamp, a point light and every kind of surface, under an open sky.
fn open() -> Scene {
    let mut scene = everything();
    let names = ["Floor", "Ceiling", "Gloss", "Mirror", "Window", "Leaf"];
    scene.meshes[0] = Mesh::parallelogram(Vec3::new(-3.0, -0.6, -3.0), Vec3::Z * 6.0, Vec3::X * 6.0, 0);
    scene.meshes.iter_mut().zip(names).for_each(|(mesh, name)| mesh.name = name.into());
    // Give the floor a diffuse and a glossy layer, and put a pane in front of the other objects and one below the
    // lamp.
    scene.materials[0] = Material { ior: 1.5, roughness: 0.4, ..scene.materials[0].clone() };
    scene.meshes.push(Mesh::parallelogram(Vec3::new(-0.4, -0.5, 0.2), Vec3::X, Vec3::Y * 0.5, 4));
    scene.meshes.push(Mesh::parallelogram(Vec3::new(-1.0, 0.9, -1.0), Vec3::X, Vec3::Z * 2.0, 4));
    scene
}

/// Returns the largest difference between the sum of all layers and the main image, relative to the value of the main
/// image at the same pixel.
fn sum_error(film: &Film) -> f32 {
    let n = film.beauty.data.len();
    (0..n)
        .map(|i| {
            let sum: f64 = film.layers.iter().map(|l| f64::from(l.image.data[i])).sum();
            let expected = f64::from(film.beauty.data[i]);
            ((sum - expected).abs() / expected.max(f64::MIN_POSITIVE)) as f32
        })
        .fold(0.0, f32::max)
}

#[test]
fn complete_sets_sum_to_the_image_and_leave_its_bits() {
    let world = world(open());
    let params = Params { width: 40, height: 30, samples: 32, ..Params::default() };
    let plain = render(&world, &viewer(), &params);
    let by_kind = [
        ("a", "emission"),
        ("b", "background"),
        ("c", "diffuse_direct"),
        ("d", "diffuse_indirect"),
        ("e", "specular_direct"),
        ("f", "specular_indirect"),
        ("g", "transmission"),
    ];
    let by_light = [("a", "C.*<L.'Ceiling'>"), ("b", "C.*'light0'"), ("c", "C.*'environment'")];
    let by_object = [("a", "C.*<..'Window'>.*"), ("b", "C[^'Window']*")];
    let by_length = [("a", "LE"), ("b", "L.E"), ("c", "L..E"), ("d", "L...+E")];
    let paper = [("a", "LE"), ("b", "LDE"), ("c", "LSE"), ("d", "L.*DDE"), ("e", "L.*SDE|L.*.SE")];
    for (number, set) in [&by_kind[..], &by_light, &by_object, &by_length, &paper].into_iter().enumerate() {
        let film = render(&world, &viewer(), &with(&params, set, &[]));
        assert!(film.beauty == plain.beauty && film.variance == plain.variance, "set {number}");
        let error = sum_error(&film);
        assert!(error <= 1e-5, "set {number}: {error}");
        // No layer is black.
        for layer in &film.layers {
            assert!(layer.image.data.iter().any(|&v| v > 0.0), "set {number}, {}", layer.name);
        }
    }
}

/// The lamps of an emission texture are separate lights: their images and the image of all other light add up to the
/// main image. The image of one lamp equals a render with the other lamp off.
#[test]
fn lamps_of_a_texture_are_light_groups() {
    let texture = |lit: [f32; 2]| {
        let value = |x: usize, y: usize| if (y / 2) == 1 && (x == 1 || x == 6) { lit[x / 4] } else { 0.0 };
        Image::from_fn(8, 6, |x, y| [value(x, y)]).unwrap()
    };
    let room = |lit: [f32; 2]| {
        let mut scene = open();
        scene.meshes[1].uvs[0] = vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        scene.textures.push(crate::scene::Texture::new("lamps", texture(lit)));
        let material = scene.meshes[1].material;
        scene.materials[material].name = "Lamps".into();
        scene.materials[material].emission_texture = Some(crate::scene::TextureRef::new(scene.textures.len() - 1));
        world(scene)
    };
    let params = Params { width: 40, height: 30, samples: 256, ..Params::default() };
    let set = [("a", "C.*<L.'Lamps#0'>"), ("b", "C.*<L.'Lamps#1'>"), ("rest", "C.*<L.[^'Lamps']>")];
    let film = render(&room([1.0, 3.0]), &viewer(), &with(&params, &set, &[]));
    assert_eq!(film.beauty, render(&room([1.0, 3.0]), &viewer(), &params).beauty);
    let error = sum_error(&film);
    assert!(error <= 1e-5, "{error}");
    // An expression may name both the material and one of its lamps.
    let both = [("a", "C.*<L.'Lamps'>"), ("b", "C.*<L.[^'Lamps']>"), ("c", "C.*<L.'Lamps''Lamps#1'>")];
    let named = render(&room([1.0, 3.0]), &viewer(), &with(&params, &both, &[]));
    assert_eq!(layer(&named, "c"), layer(&film, "b"));
    assert!((mean(layer(&film, "a")) + mean(layer(&film, "b")) - mean(layer(&named, "a"))).abs() < 1e-4);
    // With the second lamp off, the light of the first lamp is the same. The two renders trace different paths, so
    // they agree only up to noise.
    let alone = render(&room([1.0, 0.0]), &viewer(), &with(&params, &set[..1], &[]));
    let (mixed, direct) = (mean(layer(&film, "a")), mean(layer(&alone, "a")));
    assert!(mixed > 0.0 && mean(layer(&film, "b")) > 1.5 * mixed);
    assert!((mixed / direct - 1.0).abs() < 0.05, "{mixed} {direct}");
    // If an expression names a lamp that does not exist, the error names the label.
    let missing = with(&params, &[("x", "C.*<L.'Lamps#2'>")], &[]);
    let error =
        crate::render::run(&room([1.0, 1.0]), &viewer(), &missing, Monitor::default().job(), &mut |_| ()).unwrap_err();
    assert!(error.message.contains("'Lamps#2'"), "{error}");
}

#[test]
fn layers_have_the_same_bits_on_any_number_of_threads() {
    let params = Params { width: 70, height: 40, samples: 8, ..Params::default() };
    let params = with(&params, &FIVE, &Aov::ALL);
    let film = |threads| Pool::new(threads).unwrap().run(|| render(&world(open()), &viewer(), &params));
    let (one, three) = (film(1), film(3));
    assert_eq!(one.layers.len(), FIVE.len() + Aov::ALL.len());
    for (a, b) in one.layers.iter().zip(&three.layers) {
        assert!(a.image == b.image && a.image.data.iter().all(|v| !v.is_nan()), "{}", a.name);
    }
}

/// Returns the mean of the first channel.
fn mean(image: &Image) -> f64 {
    image.data.iter().step_by(image.channels).map(|&v| f64::from(v)).sum::<f64>() / (image.width * image.height) as f64
}

#[test]
fn bounces_in_a_furnace_are_a_geometric_series() {
    let (albedo, emission) = (0.6f32, 5.0f32);
    let scene =
        Scene { meshes: vec![inward_sphere(2.0, 0)], materials: vec![matt(albedo, emission)], ..Scene::default() };
    let camera = Camera::look_at(Vec3::new(0.3, 0.1, 0.2), Vec3::X, 1.0);
    let params = Params { width: 16, height: 16, samples: 256, ..Params::default() };
    let mut set = FIVE.to_vec();
    set.extend([("LE", "LE"), ("LDDDE", "LDDDE"), ("LS", "LS*DE|LS*E"), ("None", "L.*SDE")]);
    let film = render(&world(scene), &camera, &with(&params, &set, &[]));
    let (r, e) = (f64::from(albedo), f64::from(emission));
    for (name, expected) in [
        ("Full", e / (1.0 - r)),
        ("LE", e),
        ("LDE", e * r),
        ("LD12E", e * r + e * r * r),
        ("LDDDE", e * r.powi(3)),
        ("LDDE", e * r * r / (1.0 - r)),
        ("LS", e + e * r),
    ] {
        let value = mean(layer(&film, name));
        assert!((value / expected - 1.0).abs() < 0.01, "{name}: {value}, expected {expected}");
    }
    assert!(layer(&film, "LSE").data.iter().chain(&layer(&film, "None").data).all(|&v| v == 0.0));
}

#[test]
fn direct_diffuse_light_is_the_form_factor_whatever_the_walls_add() {
    // A lamp hangs over a floor in a room with white or black walls. In each pixel, LDE is albedo × luminance × form
    // factor.
    let room = |albedo: f32| Scene {
        meshes: vec![
            inward_sphere(2.0, 2),
            Mesh::parallelogram(Vec3::new(-1.0, 0.0, -1.0), Vec3::Z * 2.0, Vec3::X * 2.0, 0),
            Mesh::parallelogram(Vec3::new(-0.5, 1.5, -0.75), Vec3::X, Vec3::Z * 1.5, 1),
        ],
        materials: vec![matt(0.5, 0.0), Material { double_sided: false, ..matt(0.0, 100.0) }, matt(albedo, 0.0)],
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::new(0.9, 0.3, 0.0), Vec3::ZERO, 0.02);
    let params = Params { width: 8, height: 8, samples: 256, ..Params::default() };
    let film = |albedo| render(&world(room(albedo)), &camera, &with(&params, &FIVE, &[]));
    let (white, black) = (film(0.9), film(0.0));
    let expected = 0.5 * 100.0 * 4.0 * parallel_form_factor(0.5, 0.75, 1.5);
    for film in [&white, &black] {
        let value = mean(layer(film, "LDE"));
        assert!((value / expected - 1.0).abs() < 0.01, "{value}, expected {expected}");
    }
    // With black walls, all light is direct; with white walls, there is much more light.
    assert!((mean(&black.beauty) / expected - 1.0).abs() < 0.01);
    assert!(mean(&white.beauty) > 1.2 * expected && mean(layer(&white, "LDDE")) > 0.2 * expected);
}

#[test]
fn the_layers_of_a_paint_are_separated() {
    // With a single floor and a punctual light, the image is LDE + LSE, the two layers of the BSDF.
    let paint = Material { base_color: Vec3::new(0.6, 0.4, 0.2), metallic: 0.0, roughness: 0.5, ..Material::default() };
    let scene = Scene {
        meshes: vec![Mesh::parallelogram(Vec3::new(-5.0, 0.0, -5.0), Vec3::Z * 10.0, Vec3::X * 10.0, 0)],
        materials: vec![paint],
        lights: vec![PunctualLight::Point { position: Vec3::new(-1.0, 1.0, 0.0), intensity: Vec3::splat(30.0) }],
        ..Scene::default()
    };
    let world = world(scene);
    let camera = Camera::look_at(Vec3::new(1.5, 1.2, 0.0), Vec3::ZERO, 1e-3);
    let params = Params { width: 4, height: 4, samples: 4, ..Params::default() };
    let film = render(&world, &camera, &with(&params, &FIVE, &[]));
    let vertex = Vertex::new(&world, world.id(0, 0), Vec2::new(0.0, 0.5));
    let lobes = vertex
        .bsdf(&world, medium::Media::NONE, || 0, camera.position.normalize())
        .eval(Vec3::new(-1.0, 1.0, 0.0).normalize())
        .0;
    for (name, lobe) in [("LDE", lobes.diffuse), ("LSE", lobes.glossy)] {
        let expected = lobe * 30.0 / 2.0;
        let value = layer(&film, name).rgb(2, 2);
        assert!((value - expected).abs().max_element() < 0.01 * expected.max_element(), "{name}: {value}, {expected}");
    }
}

#[test]
fn mirrors_and_panes_are_specular_however_their_light_is_found() {
    // Test a mirror floor that reflects a lamp: LSE is the lamp's radiance times the Fresnel reflectance at the angle
    // of reflection.
    let lamp = || Mesh::parallelogram(Vec3::new(-1.5, 1.0, -1.0), Vec3::X, Vec3::Z * 2.0, 1);
    let metal = Material { base_color: Vec3::new(0.9, 0.6, 0.3), roughness: 0.0, ..Material::default() };
    let scene = Scene {
        meshes: vec![Mesh::parallelogram(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0, 0), lamp()],
        materials: vec![metal.clone(), Material { double_sided: false, ..matt(0.0, 50.0) }],
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::new(1.0, 1.0, 0.0), Vec3::ZERO, 0.01);
    let params = Params { width: 4, height: 4, samples: 16, ..Params::default() };
    let film = render(&world(scene.clone()), &camera, &with(&params, &FIVE, &[]));
    let expected = 50.0 * ggx::schlick(metal.base_color, 1.0, 0.5f32.sqrt());
    let value = layer(&film, "LSE").rgb(1, 1);
    assert!((value - expected).abs().max_element() < 0.01 * expected.x, "{value}, {expected}");
    assert!(layer(&film, "LDE").data.iter().all(|&v| v == 0.0));

    // Test a matt floor that is lit by a lamp through a pane. LDE is zero, and LS*DE is all light: the light without
    // the pane times the transmittance. Light samples find the small lamp, BSDF samples the large one.
    for size in [0.1, 8.0] {
        let lamp = Mesh::parallelogram(Vec3::new(-size / 2.0, 1.0, -size / 2.0), Vec3::X * size, Vec3::Z * size, 1);
        let pane = Mesh::parallelogram(Vec3::new(-9.0, 0.5, -9.0), Vec3::X * 18.0, Vec3::Z * 18.0, 2);
        let mut scene = Scene { meshes: vec![scene.meshes[0].clone(), lamp, pane], ..scene.clone() };
        scene.meshes[2].name = "Pane".into();
        scene.materials[0] = matt(0.5, 0.0);
        // Glass with an index of refraction of 1 reflects nothing at any angle.
        let glass = Material { base_color: Vec3::new(0.5, 0.7, 0.9), ior: 1.0, transmission: 1.0, ..matt(0.0, 0.0) };
        scene.materials.push(glass.clone());
        let camera = Camera::look_at(Vec3::new(0.4, 0.3, 0.0), Vec3::ZERO, 0.01);
        let params = Params { samples: 1024, ..params.clone() };
        let set = [("LDE", "LDE"), ("Through", "LS*DE"), ("Named", "CD<TS'Pane'>L"), ("Straight", "C.*sL")];
        let covered = render(&world(scene.clone()), &camera, &with(&params, &set, &[]));
        scene.meshes.pop();
        let free = render(&world(scene), &camera, &with(&params, &set, &[]).clone_without("Named"));
        let expected = free.layers[0].image.rgb(1, 1) * glass.base_color;
        assert!(covered.layers[0].image.data.iter().all(|&v| v == 0.0), "size {size}");
        for layer in &covered.layers[1..] {
            let value = layer.image.rgb(1, 1);
            let error = (value - expected).abs().max_element();
            assert!(error < 0.05 * expected.z, "size {size}, {}: {value}, {expected}", layer.name);
        }
    }
}

impl Params {
    /// Returns the parameters without the expression of this name.
    fn clone_without(mut self, name: &str) -> Self {
        self.outputs.expressions.retain(|(n, _)| n != name);
        self
    }
}

#[test]
fn emissive_objects_match_the_requested_light_letters() {
    let world = world(open());
    let params = Params { width: 12, height: 8, samples: 8, ..Params::default() };
    let letters = [("L", "C.*L"), ("O", "C.*O"), ("B", "C.*B")];
    let film = |emitter_as| {
        let mut params = with(&params, &letters, &[]);
        params.outputs.emitter_as = emitter_as;
        render(&world, &viewer(), &params)
    };
    let (both, light, object) = (film(EmitterAs::Both), film(EmitterAs::Light), film(EmitterAs::Object));
    for i in 0..both.beauty.data.len() {
        let value = |film: &Film, layer: usize| film.layers[layer].image.data[i];
        let all = both.beauty.data[i];
        let near = |a: f32, b: f32| (a - b).abs() <= 1e-5 * all;
        assert!(near(value(&both, 0), all) && near(value(&light, 0), all));
        assert!(value(&light, 1) == 0.0 && value(&light, 2) == 0.0);
        assert!(near(value(&object, 0) + value(&object, 1) + value(&object, 2), all));
        assert!(value(&both, 1) == value(&object, 1) && value(&both, 2) == value(&object, 2));
    }
}

#[test]
fn surfaces_seen_have_their_distance_place_and_name() {
    // A wall at a distance of 2 m with tilted vertex normals covers the left half of the image.
    let mut wall = Mesh::parallelogram(Vec3::new(-4.0, -4.0, -2.0), Vec3::X * 4.0, Vec3::Y * 8.0, 1);
    wall.normals = vec![Vec3::new(0.6, 0.0, 0.8); 4];
    let behind = Mesh::parallelogram(Vec3::new(-1.0, -1.0, -3.0), Vec3::X, Vec3::Y, 0);
    let scene = Scene {
        meshes: vec![behind, wall],
        materials: vec![matt(0.1, 0.0), Material { base_color: Vec3::new(0.2, 0.4, 0.8), ..matt(0.0, 3.0) }],
        environment: Some(Environment::Constant(Vec3::new(1.0, 2.0, 3.0))),
        ..Scene::default()
    };
    let camera = Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 1.0);
    let params = Params { width: 9, height: 5, samples: 64, ..Params::default() };
    let film = render(&world(scene), &camera, &with(&params, &[], &Aov::ALL));
    let at = |aov: Aov, x: usize, y: usize| layer(&film, aov.name()).pixel(x, y);
    for y in 0..5 {
        for x in 0..9 {
            // The middle column is half covered. The standard deviation of its alpha over 64 samples is at most 1/16.
            let alpha = at(Aov::Alpha, x, y)[0];
            let (expected, tolerance) = [(1.0, 0.0), (0.5, 0.25), (0.0, 0.0)][(x > 3) as usize + (x > 4) as usize];
            assert!((alpha - expected).abs() <= tolerance, "{x}, {y}: {alpha}");
            assert_eq!(at(Aov::Luminance, x, y)[0], colour::luminance(film.beauty.rgb(x, y)));
            if x > 4 {
                assert_eq!((at(Aov::Depth, x, y)[0], at(Aov::Object, x, y)[0]), (f32::INFINITY, 0.0));
                assert_eq!((at(Aov::Normal, x, y), at(Aov::Albedo, x, y)), (&[0.0; 3][..], &[0.0; 3][..]));
                continue;
            }
            assert!((at(Aov::Depth, x, y)[0] - 2.0).abs() < 1e-5);
            let position = Vec3::from_slice(at(Aov::Position, x, y));
            assert!((position.z + 2.0).abs() < 1e-5 && position.x < 0.0);
            // The mean of the distances is slightly larger than the distance of the mean position.
            let distance = at(Aov::Distance, x, y)[0] - position.length();
            assert!((-1e-5..0.01).contains(&distance), "{distance}");
            assert!(Vec3::from_slice(at(Aov::Normal, x, y)).abs_diff_eq(Vec3::new(0.6, 0.0, 0.8), 1e-5));
            assert_eq!(at(Aov::GeometricNormal, x, y), [0.0, 0.0, 1.0]);
            let albedo = Vec3::from_slice(at(Aov::Albedo, x, y));
            assert!(albedo.abs_diff_eq(Vec3::new(0.2, 0.4, 0.8) * alpha, 1e-5), "{albedo}");
            if x < 4 {
                assert_eq!((at(Aov::Object, x, y)[0], at(Aov::Material, x, y)[0]), (2.0, 2.0));
            }
        }
    }
}

#[test]
fn layers_that_cannot_be_are_refused_by_name() {
    let mut outputs = Outputs::default();
    outputs.add("LDE", "LDE").unwrap();
    for name in ["", "LDE", "a.b", "Depth", "Combined", "a\n", &"x".repeat(65)] {
        assert!(outputs.add(name, "LDE").is_err(), "{name:?}");
    }
    assert!(outputs.add("x", "LD").unwrap_err().message.contains("column 3"));
    assert_eq!(outputs.expressions.len(), 1);
    // A label that does not exist in the scene is refused only when the layer is rendered.
    outputs.add("y", "C<RD'Nowhere'>L").unwrap();
    let params = Params { width: 4, height: 4, samples: 1, outputs, ..Params::default() };
    let result = run(&world(open()), &viewer(), &params, Monitor::default().job(), &mut |_| ());
    assert!(result.unwrap_err().message.contains("'Nowhere'"));
}
