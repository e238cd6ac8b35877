//! Tests that scenes by other authors load quickly and that their surfaces are found.

use crate::truth::data;
use glam::Vec3;
use luxfer::image::Image;
use luxfer::scene::{Scene, gltf, surface};
use std::time::{Duration, Instant};

/// Maximum time to load a scene in a debug build on two busy cores; a release build takes a fraction of it.
const TIME_LIMIT: Duration = Duration::from_secs(20);

fn load(name: &str) -> Option<Scene> {
    let path = data(name)?;
    let start = Instant::now();
    let scene = gltf::load(&path, gltf::Options::default()).unwrap();
    let (elapsed, triangles) = (start.elapsed(), scene.meshes.iter().map(|m| m.triangles.len()).sum::<usize>());
    println!("{name}: {triangles} triangles, {} textures in {elapsed:.2?}", scene.textures.len());
    assert!(elapsed < TIME_LIMIT, "{name} took {elapsed:?}");
    assert_eq!(scene.validate(), Ok(()));
    Some(scene)
}

fn bounds(scene: &Scene) -> (Vec3, Vec3) {
    let points = scene.meshes.iter().flat_map(|m| &m.positions);
    points.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(*p), high.max(*p)))
}

#[test]
fn kitchen() {
    let Some(mut scene) = load("scenes/kitchen/country_kitchen.glb") else { return };
    assert_eq!((scene.meshes.len(), scene.materials.len()), (82, 82));

    // The ceiling is a slab at heights from 3.23 to 3.36 m; the surface to find is its lower side.
    let start = Instant::now();
    let ceiling = surface::find(&scene, "Ceiling").unwrap();
    println!("Ceiling found in {:.2?}: {ceiling:?}", start.elapsed());
    assert!((ceiling.normal - Vec3::NEG_Y).length() < 1e-3, "{}", ceiling.normal);
    assert!((ceiling.origin.y - 3.23).abs() < 0.02, "{}", ceiling.origin);
    assert!((ceiling.u_axis - Vec3::X).length() < 1e-3);
    assert!((ceiling.size.x - 6.92).abs() < 0.02 && (ceiling.size.y - 8.65).abs() < 0.02, "{}", ceiling.size);
    let floor = surface::find(&scene, "floor").unwrap();
    assert!((floor.normal - Vec3::Y).length() < 1e-3 && (floor.origin.y + 0.02).abs() < 0.01);

    // Light the scene, write it and read it again.
    let lights = Image::from_fn(8, 8, |x, y| [if x % 2 == 0 && y % 2 == 0 { 1.0 } else { 0.0 }; 3]).unwrap();
    let placed = surface::place(&mut scene, &ceiling, lights, Vec3::splat(3000.0)).unwrap();
    let again = gltf::import(&gltf::export(&scene).unwrap(), None, gltf::Options::default()).unwrap();
    let patch = again.meshes.iter().find(|m| m.name == "Ceiling (lights)").unwrap();
    assert_eq!(patch.uvs[1], scene.meshes[placed.mesh].uvs[1]);
    assert_eq!(again.materials[patch.material].emission, Vec3::splat(3000.0));
}

#[test]
fn sponza() {
    let Some(scene) = load("scenes/sponza/sponza_dabrovic.glb") else { return };
    assert_eq!(scene.meshes.len(), 37);
    // The found side of the courtyard's floor must be the upper one.
    let floor = surface::find(&scene, "sp_00_pod_12").unwrap();
    println!("{floor:?}");
    assert!((floor.normal - Vec3::Y).length() < 1e-2, "{}", floor.normal);
}

#[test]
fn apartment_gets_a_cover() {
    let Some(mut scene) = load("scenes/apartment/dream_apartment.glb") else { return };
    let (low, high) = bounds(&scene);
    surface::cover(&mut scene, "Light plane").unwrap();
    let start = Instant::now();
    let lid = surface::find(&scene, "Light plane").unwrap();
    println!("Light plane found in {:.2?}: {lid:?}", start.elapsed());
    assert!((lid.normal - Vec3::NEG_Y).length() < 1e-5);
    assert!((lid.size.x - (high.x - low.x)).abs() < 1e-3 && (lid.size.y - (high.z - low.z)).abs() < 1e-3);
    let floor = surface::find(&scene, "Wood_Floor_Light").unwrap();
    println!("{floor:?}");
    assert!((floor.normal - Vec3::Y).length() < 1e-2, "{}", floor.normal);
}
