use super::*;
use crate::error::ErrorKind;
use crate::image::Image;
use crate::scene::{Camera, Material, Mesh};

/// A flat quadrilateral of two triangles.
fn quad(name: &str, corners: [[f32; 3]; 4]) -> Mesh {
    Mesh {
        name: name.into(),
        positions: corners.map(Vec3::from).into(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], Vec::new()],
        ..Mesh::default()
    }
}

fn shell() -> Scene {
    let materials = vec![Material::diffuse("Plaster", Vec3::splat(0.7)), Material::diffuse("Oak", Vec3::splat(0.4))];
    let walls = [
        [[0., 0., 0.], [6., 0., 0.], [6., 3., 0.], [0., 3., 0.]],
        [[0., 0., 4.], [6., 0., 4.], [6., 3., 4.], [0., 3., 4.]],
        [[0., 0., 0.], [0., 0., 4.], [0., 3., 4.], [0., 3., 0.]],
        [[6., 0., 0.], [6., 0., 4.], [6., 3., 4.], [6., 3., 0.]],
    ];
    let mut meshes: Vec<Mesh> = walls.into_iter().map(|w| quad("Wall", w)).collect();
    let floor = quad("Floor", [[0., 0., 0.], [6., 0., 0.], [6., 0., 4.], [0., 0., 4.]]);
    meshes.push(Mesh { material: 1, ..floor });
    Scene { meshes, materials, ..Scene::default() }
}

/// A closed box whose faces point outwards.
fn slab(name: &str, low: Vec3, high: Vec3) -> Mesh {
    let at = |i: usize| {
        let pick = |bit: usize, a: f32, b: f32| if i & bit != 0 { b } else { a };
        Vec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
    };
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = sides.iter().flat_map(|s| [[s[0], s[1], s[2]], [s[0], s[2], s[3]]]).collect();
    Mesh { name: name.into(), positions: (0..8).map(at).collect(), triangles, ..Mesh::default() }
}

fn assert_is_lid(surface: &Surface, y: f32) {
    assert!((surface.normal - Vec3::NEG_Y).length() < 1e-6, "{}", surface.normal);
    assert!((surface.u_axis - Vec3::X).length() < 1e-6 && (surface.v_axis - Vec3::NEG_Z).length() < 1e-6);
    assert!((surface.u_axis.cross(surface.v_axis) + surface.normal).length() < 1e-6);
    assert!((surface.size - Vec2::new(6.0, 4.0)).length() < 1e-4, "{}", surface.size);
    assert!((surface.origin - Vec3::new(0.0, y, 4.0)).length() < 1e-4, "{}", surface.origin);
    assert!((surface.area - 24.0).abs() < 1e-3);
    assert_eq!(surface.triangles.len(), 2);
}

#[test]
fn a_sheet_faces_the_room_however_it_is_wound() {
    for reversed in [false, true] {
        for mixed in [false, true] {
            let mut scene = shell();
            let mut lid = quad("Lid", [[0., 3., 0.], [6., 3., 0.], [6., 3., 4.], [0., 3., 4.]]);
            if reversed {
                lid.triangles.iter_mut().for_each(|t| t.swap(0, 1));
            }
            if mixed {
                lid.triangles[0].swap(0, 1);
            }
            scene.meshes.push(lid);
            assert_is_lid(&find(&scene, "Lid").unwrap(), 3.0);
        }
    }
}

#[test]
fn the_side_of_a_slab_that_faces_the_room_is_chosen() {
    for thickness in [0.02, 0.13, 0.6] {
        let mut scene = shell();
        scene.meshes.push(slab("Lid", Vec3::new(0., 3., 0.), Vec3::new(6., 3. + thickness, 4.)));
        assert_is_lid(&find(&scene, "lid").unwrap(), 3.0);
        // With the floor as a slab, its upper side faces the room.
        scene.meshes[4] = slab("Floor", Vec3::new(0., -thickness, 0.), Vec3::new(6., 0., 4.));
        let floor = find(&scene, "Floor").unwrap();
        assert!((floor.normal - Vec3::Y).length() < 1e-6 && floor.origin.y.abs() < 1e-6);
    }
}

#[test]
fn a_slab_without_its_walls_is_resolved_by_what_lies_below() {
    let mut scene = shell();
    scene.meshes.drain(..4);
    scene.meshes.push(slab("Lid", Vec3::new(0., 3., 0.), Vec3::new(6., 3.1, 4.)));
    assert_is_lid(&find(&scene, "Lid").unwrap(), 3.0);
}

#[test]
fn between_two_rooms_the_camera_decides() {
    for z in [2.0, -2.0] {
        let mut scene = shell();
        scene.meshes.push(quad("Far", [[0., 0., -4.], [6., 0., -4.], [6., 3., -4.], [0., 3., -4.]]));
        scene.meshes.push(quad("Between", [[0., 0., 0.5], [6., 0., 0.5], [6., 3., 0.5], [0., 3., 0.5]]));
        scene.meshes.swap_remove(0);
        scene.cameras.push(Camera::look_at(Vec3::new(3.0, 1.5, z), Vec3::new(3.0, 1.5, 0.5), 1.0));
        let surface = find(&scene, "Between").unwrap();
        assert!((surface.normal - Vec3::Z * z.signum()).length() < 1e-6, "{z}: {}", surface.normal);
        assert!((surface.v_axis - Vec3::NEG_Y).length() < 1e-6);
    }
}

#[test]
fn names_match_exactly_then_without_case_then_in_part() {
    let mut scene = shell();
    scene.meshes.push(quad("Lid", [[0., 3., 0.], [6., 3., 0.], [6., 3., 4.], [0., 3., 4.]]));
    scene.meshes.push(quad("Lid lamp", [[0., 2., 0.], [1., 2., 0.], [1., 2., 1.], [0., 2., 1.]]));
    assert_is_lid(&find(&scene, "LID").unwrap(), 3.0);
    assert!((find(&scene, "LAMP").unwrap().area - 1.0).abs() < 1e-5);
    assert!((find(&scene, "oak").unwrap().area - 24.0).abs() < 1e-4, "the floor's material");
    let ambiguous = find(&scene, "l").unwrap_err();
    assert!(ambiguous.kind == ErrorKind::NotFound && ambiguous.message.contains("\"Lid lamp\""), "{ambiguous}");
    let unknown = find(&scene, "Lit").unwrap_err();
    assert!(unknown.message.contains("there are \"Lid\""), "the nearest name comes first: {unknown}");
    assert_eq!(find(&Scene::default(), "Lid").unwrap_err().kind, ErrorKind::NotFound);
    assert_eq!(find(&scene, "").unwrap_err().kind, ErrorKind::NotFound);
}

#[test]
fn degenerate_and_foreign_input_is_an_error() {
    let mut scene = shell();
    scene.meshes.push(quad("Line", [[0., 0., 0.], [1., 0., 0.], [2., 0., 0.], [3., 0., 0.]]));
    assert_eq!(find(&scene, "Line").unwrap_err().kind, ErrorKind::Degenerate);
    assert_eq!(from_triangles(&scene, &[]).unwrap_err().kind, ErrorKind::Degenerate);
    for foreign in [(99, 0), (0, 2)] {
        assert_eq!(from_triangles(&scene, &[foreign]).unwrap_err().kind, ErrorKind::InvalidArgument);
    }
    assert_eq!(cover(&mut Scene::default(), "Lid").unwrap_err().kind, ErrorKind::Degenerate);

    let surface = find(&scene, "Floor").unwrap();
    let grey = Image::from_fn(2, 2, |_, _| [0.5]).unwrap();
    let mut nan = grey.clone();
    nan.data[1] = f32::NAN;
    assert!(place(&mut scene, &surface, nan, Vec3::ONE).is_err());
    assert!(place(&mut scene, &surface, grey.clone(), Vec3::NEG_ONE).is_err());
    assert!(place(&mut Scene::default(), &surface, grey.clone(), Vec3::ONE).is_err());
    assert!(place(&mut scene, &Surface { size: Vec2::ZERO, ..surface }, grey, Vec3::ONE).is_err());
}

#[test]
fn one_plane_of_many_small_triangles_is_one_patch() {
    // A vault of 24 × 24 cells, with a flat crown between two curved flanks.
    let n = 24;
    let mut vault = Mesh { name: "Vault".into(), ..Mesh::default() };
    for j in 0..=n {
        for i in 0..=n {
            let (x, z) = (i as f32 * 0.25, j as f32 / n as f32 * 4.0);
            let flank = ((x - 3.0).abs() - 1.5).max(0.0);
            vault.positions.push(Vec3::new(x, 3.0 - 0.3 * flank * flank, z));
        }
    }
    for j in 0..n {
        for i in 0..n {
            let at = j * (n + 1) + i;
            vault.triangles.extend([[at, at + 1, at + n + 2], [at, at + n + 2, at + n + 1]]);
        }
    }
    let mut scene = shell();
    scene.meshes.push(vault);
    let surface = find(&scene, "Vault").unwrap();
    assert!((surface.normal - Vec3::NEG_Y).length() < 1e-3);
    assert!((surface.size.y - 4.0).abs() < 1e-3 && surface.size.x >= 3.0 && surface.size.x <= 3.6, "{}", surface.size);
    // Each flank has six strips with slopes 0.075, 0.225, ... The first is inclined by 4.3 degrees, less than the 5
    // degrees from which `sloped_area` counts triangles.
    let strip = |k: i32| 4.0 * 0.25 * f64::hypot(1.0, 0.075 * f64::from(2 * k + 1));
    let flanks: f64 = 2.0 * (1..6).map(strip).sum::<f64>();
    assert!((f64::from(surface.sloped_area) - flanks).abs() < 1e-3, "{} of {flanks}", surface.sloped_area);
}

#[test]
fn placing_splits_the_patch_off_and_lays_the_texture_over_it() {
    let mut scene = shell();
    scene.meshes.push(Mesh { material: 1, ..slab("Lid", Vec3::new(0., 3., 0.), Vec3::new(6., 3.2, 4.)) });
    let surface = find(&scene, "Lid").unwrap();
    assert_eq!(surface.sloped_area.to_bits(), 0);
    let image = Image::from_fn(3, 2, |x, y| [x as f32, y as f32, 1.0]).unwrap();
    let placed = place(&mut scene, &surface, image, Vec3::new(5.0, 6.0, 7.0)).unwrap();
    assert_eq!(scene.validate(), Ok(()));
    assert_eq!((scene.meshes[5].triangles.len(), placed.mesh), (10, 6));
    let (mesh, material) = (&scene.meshes[placed.mesh], &scene.materials[placed.material]);
    assert_eq!((mesh.name.as_str(), material.name.as_str()), ("Lid (lights)", "Oak (lights)"));
    assert_eq!(material.emission, Vec3::new(5.0, 6.0, 7.0));
    assert!(!material.double_sided && material.emission_texture.unwrap().uv_set == 1);
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        assert!((b - a).cross(c - a).dot(surface.normal) > 0.0);
        for i in mesh.triangles[t].map(|i| i as usize) {
            let uv = mesh.uvs[1][i];
            let back = surface.origin + surface.u_axis * uv.x * surface.size.x + surface.v_axis * uv.y * surface.size.y;
            assert!((back - mesh.positions[i]).length() < 1e-5);
        }
    }
    // The patch is found by its own name.
    assert_eq!(find(&scene, "Lid (lights)").unwrap().size, surface.size);

    // All triangles of a sheet move to the patch. The sheet's empty mesh keeps its index. The name "Lid" now finds the
    // patch "Lid (lights)", because meshes without triangles are ignored.
    let mut scene = shell();
    let index = cover(&mut scene, "Lid").unwrap();
    let surface = find(&scene, "Lid").unwrap();
    assert_is_lid(&surface, 3.0);
    let image = Image::from_fn(2, 2, |_, _| [1.0, 1.0, 1.0]).unwrap();
    let placed = place(&mut scene, &surface, image, Vec3::ONE).unwrap();
    assert!(scene.meshes[index].triangles.is_empty() && scene.meshes[placed.mesh].uvs[0].len() == 6);
    assert_is_lid(&find(&scene, "Lid").unwrap(), 3.0);
}
