//! Tests that invalid scenes and parameters are refused with a message that names the culprit.

use super::*;

#[test]
fn invalid_scenes_and_parameters_are_refused_by_name() {
    let valid = everything();
    let refused = |change: &dyn Fn(&mut Scene), word: &str| {
        let mut scene = valid.clone();
        change(&mut scene);
        let error = World::build(Arc::new(scene), Monitor::default().job()).err().expect(word);
        assert!(error.message.contains(word), "{}", error.message);
    };
    refused(&|s| s.meshes[1].material = 99, "99");
    refused(&|s| s.meshes[2].positions[1].y = f32::NAN, "position");
    refused(&|s| s.meshes[2].triangles[1] = [0, 1, 4], "position 4");
    refused(&|s| s.meshes[2].uvs[0].truncate(2), "uvs[0]");
    refused(&|s| s.materials[1].emission_texture = Some(TextureRef::new(7)), "texture 7");
    refused(&|s| s.textures[0].image.data[5] = f32::INFINITY, "texture 0");
    refused(&|s| s.materials[3].roughness = f32::NAN, "material 3");
    refused(&|s| s.environment = Some(Environment::Constant(Vec3::NAN)), "environment");

    let world = world(valid.clone());
    let run_with =
        |camera: &Camera, params: &Params| run(&world, camera, params, Monitor::default().job(), &mut |_| ());
    for bad in [
        Params { width: 0, ..Params::default() },
        Params { samples: 0, ..Params::default() },
        Params { samples: (1 << 20) + 1, ..Params::default() },
        Params { target_error: f32::NAN, ..Params::default() },
        Params { preview: 10.5, ..Params::default() },
    ] {
        assert!(run_with(&viewer(), &bad).is_err());
    }
    assert!(run_with(&Camera { fov_y: 0.0, ..viewer() }, &Params::default()).is_err());
    assert!(run_with(&Camera { position: Vec3::NAN, ..viewer() }, &Params::default()).is_err());
}
