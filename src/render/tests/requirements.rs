//! Tests of the static scene analysis: it finds the features that a scene requires, omitting all others changes no
//! image, and its bounds hold.

use super::*;

/// Renders with and without the scene analysis. Returns the largest difference between corresponding values of the two
/// images, relative to the mean of the image.
pub fn difference(scene: Scene, camera: &Camera, samples: u32) -> f32 {
    let params = Params { width: 48, height: 32, samples, ..Params::default() };
    let mut world = world(scene);
    let analysed = render(&world, camera, &params).beauty;
    world.discard_analysis();
    let general = render(&world, camera, &params).beauty;
    let mean = general.data.iter().sum::<f32>() / general.data.len() as f32;
    assert!(mean > 0.0);
    analysed.data.iter().zip(&general.data).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) / mean
}

#[test]
fn omitting_features_that_a_scene_does_not_require_changes_nothing() {
    let rooms = || {
        let mut room = inward_sphere(2.0, 0);
        room.normals = room.positions.iter().map(|p| -p.normalize()).collect();
        let lamp = Mesh::parallelogram(Vec3::new(-0.5, 1.2, -0.5), Vec3::X, Vec3::Z, 1);
        let mut shelf = Mesh::parallelogram(Vec3::new(-0.8, -0.5, -0.8), Vec3::Z, Vec3::X, 0);
        shelf.normals = vec![Vec3::Y; 4];
        Scene { meshes: vec![room, lamp, shelf], materials: vec![matt(0.7, 0.0), matt(0.0, 30.0)], ..Scene::default() }
    };
    let matt_room = difference(rooms(), &viewer(), 16);
    assert!(matt_room < 1e-5, "matt: {matt_room}");
    let all = difference(everything(), &viewer(), 16);
    assert!(all < 1e-5, "everything: {all}");
    let office = crate::demo::exemplar_room().unwrap().scene;
    let camera = office.cameras[0].clone();
    let office = difference(office, &camera, 4);
    assert!(office < 1e-5, "office: {office}");
}

#[test]
fn required_features_are_found_and_unsupported_ones_are_named() {
    let all = world(everything());
    let r = all.requirements();
    assert!(r.diffuse && r.glossy && r.mirror && r.glass && r.alpha && r.normal_maps);
    assert!(r.surfaces && r.textured_surfaces && r.points && r.environment);
    assert!(!r.spots && !r.directional && r.textures == 1);
    // The triangles at the poles of the sphere are degenerate. The pane (material 4) has a roughness of 0.1, so it is
    // no clear glass.
    let frosted = "Material 4 is transparent and rough: light goes straight on through, and is not scattered.";
    assert_eq!(r.left_out(), ["48 triangles have no area: no ray meets them.", frosted]);

    let plain = Scene { meshes: vec![inward_sphere(2.0, 0)], materials: vec![matt(0.5, 1.0)], ..Scene::default() };
    let found = |change: &dyn Fn(&mut Scene)| {
        let mut scene = plain.clone();
        change(&mut scene);
        world(scene).requirements().clone()
    };
    let matt_only = Requirements {
        diffuse: true,
        surfaces: true,
        albedo: Vec3::splat(0.5),
        brightest: Some(0),
        flat_triangles: 48,
        ..Requirements::default()
    };
    assert_eq!(found(&|_| ()), matt_only);
    assert_eq!(matt_only.left_out().len(), 9, "{:?}", matt_only.left_out());
    // The analysis ignores materials that no mesh uses and lights that do not emit.
    assert_eq!(
        found(&|s| s.materials.extend(everything().materials.into_iter().map(|m| Material {
            base_color_texture: None,
            normal_texture: None,
            emission_texture: None,
            ..m
        }))),
        matt_only
    );
    assert_eq!(found(&|s| s.environment = Some(Environment::Constant(Vec3::ZERO))), matt_only);
    let unlit = PunctualLight::Point { position: Vec3::ZERO, intensity: Vec3::ZERO };
    assert_eq!(found(&|s| s.lights.push(unlit)), matt_only);
    // The alpha mode matters only if the opacity may be below 1.
    assert!(!found(&|s| s.materials[0].alpha_mode = AlphaMode::Blend).alpha);
    assert!(!found(&|s| s.materials[0].alpha_mode = AlphaMode::Mask(0.9)).alpha);
    assert!(!found(&|s| (s.materials[0].transmission, s.materials[0].metallic) = (1.0, 1.0)).glass);
    assert!(found(&|s| (s.materials[0].alpha_mode, s.materials[0].alpha) = (AlphaMode::Blend, 0.9)).alpha);
    // A texture of a single colour is a constant factor; a texture of two colours varies the material.
    let textured = |second: f32| {
        found(&|s: &mut Scene| {
            let image = Image::from_fn(2, 1, |x, _| [if x == 0 { 0.5f32 } else { second }; 3]).unwrap();
            s.textures.push(Texture::new("paint", image));
            s.materials[0].base_color_texture = Some(TextureRef::new(0));
        })
    };
    assert_eq!((textured(0.5).textures, textured(0.5).albedo), (0, Vec3::splat(0.25)));
    assert_eq!((textured(0.75).textures, textured(0.75).albedo), (1, Vec3::splat(0.375)));
}

/// Refraction is not modelled: the report names solid glass, which refracts, but not thin panes, which do not.
#[test]
fn glass_that_refracts_is_reported() {
    let glass = Material { transmission: 1.0, metallic: 0.0, roughness: 0.0, ..Material::default() };
    let mut pane = Mesh::parallelogram(Vec3::ZERO, Vec3::X, Vec3::Y, 1);
    let named = |glass: &Material, meshes: &[&Mesh]| {
        let mut scene = everything();
        scene.materials.truncate(1);
        scene.meshes = [inward_sphere(2.0, 0)].into_iter().chain(meshes.iter().map(|&m| m.clone())).collect();
        scene.materials.push(glass.clone());
        scene.textures.clear();
        let text = world(scene).requirements().left_out().join(" ");
        (text.contains("is not bent"), text.contains("is not scattered"), text)
    };
    let ball = inward_sphere(0.4, 1);
    let (bent, scattered, text) = named(&glass, &[&pane, &ball]);
    assert!(bent && !scattered && text.contains("Mesh 2 is closed"), "{text}");
    let (bent, _, text) = named(&glass, &[&ball, &pane, &ball]);
    assert!(bent && text.contains("2 meshes, the first of them mesh 1, are closed"), "{text}");
    assert!(!named(&glass, &[&pane]).0);
    assert!(!named(&Material { transmission: 0.0, ..glass.clone() }, &[&ball]).0);
    let (bent, scattered, text) = named(&Material { roughness: 0.5, ..glass.clone() }, &[&pane]);
    assert!(!bent && scattered && text.contains("Material 1 is"), "{text}");
    // The report ignores a material that no mesh uses.
    pane.material = 0;
    assert!(!named(&Material { roughness: 0.5, ..glass }, &[&pane]).1);
}

#[test]
fn a_lamp_without_area_is_no_light() {
    let with = |lamp: Mesh| {
        let materials = vec![matt(0.5, 0.0), matt(0.0, 30.0)];
        let scene = Scene { meshes: vec![inward_sphere(2.0, 0), lamp], materials, ..Scene::default() };
        world(scene).requirements().clone()
    };
    let lamp = |width: f32| Mesh::parallelogram(Vec3::Y, Vec3::X * width, Vec3::Z, 1);
    assert!(with(lamp(1e-3)).surfaces);
    for flat in [lamp(0.0), Mesh { triangles: vec![[0, 1, 1], [2, 2, 2]], ..lamp(1.0) }] {
        let found = with(flat);
        assert!(!found.surfaces && found.left_out().contains(&"No surface emits.".to_string()));
    }
    // A single triangle with an area is enough.
    assert!(with(Mesh { triangles: vec![[0, 1, 1], [0, 1, 2]], ..lamp(1.0) }).surfaces);
}

#[test]
fn bounces_follow_from_the_albedo() {
    let of = |albedo: f32| Requirements { albedo: Vec3::new(0.0, albedo, 0.1), ..Requirements::default() };
    assert_eq!(of(0.5).bounces(0.1), Some(4));
    assert_eq!(of(0.5).bounces(0.125), Some(3));
    assert_eq!(of(0.9).bounces(0.01), Some(44));
    assert_eq!(Requirements::default().bounces(0.01), Some(1));
    assert_eq!((of(1.0).bounces(0.5), of(0.5).bounces(0.0), of(0.5).bounces(f32::NAN)), (None, None, None));
}

/// In a closed room whose surfaces all have the albedo a, the share of the scattered light that comes after n bounces
/// equals its upper bound a^n.
#[test]
fn the_bound_on_bounces_is_reached_by_a_room_of_one_albedo() {
    let scene = Scene { meshes: vec![inward_sphere(2.0, 0)], materials: vec![matt(0.5, 3.0)], ..Scene::default() };
    let world = world(scene);
    assert_eq!(world.requirements().bounces(0.1), Some(4));
    // The scattered light is 3 / (1 - 0.5) - 3. The first four bounces carry all of it except the share 0.5^4.
    let scattered = |bounces: i32| (1..=bounces).map(|n| 3.0 * 0.5f64.powi(n)).sum::<f64>();
    let left = 1.0 - scattered(4) / scattered(200);
    assert!((left - 0.5f64.powi(4)).abs() < 1e-12 && left < 0.1 && 1.0 - scattered(3) / scattered(200) > 0.1);
    // A render includes all bounces.
    let camera = Camera::look_at(Vec3::new(0.3, 0.1, 0.2), Vec3::X, 1.0);
    let film = render(&world, &camera, &Params { width: 16, height: 16, samples: 64, ..Params::default() });
    let mean = film.beauty.data.iter().map(|&v| f64::from(v)).sum::<f64>() / film.beauty.data.len() as f64;
    let error = film.variance.data.iter().step_by(3).map(|&v| f64::from(v)).sum::<f64>().sqrt() / 256.0;
    assert!((mean - 6.0).abs() < 4.0 * error + 6e-4, "{mean} ± {error}, expected 6");
}
