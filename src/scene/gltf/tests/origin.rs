//! Tests of scenes far from the origin of their file, as on a national grid.

use super::*;
use crate::scene::gltf::origin::GRID;
use glam::DVec3;

/// A file with a triangle, a point light and a camera, whose nodes are translated in f64 by `at`.
fn placed(at: DVec3) -> Vec<u8> {
    triangle_file(|file| {
        file["accessors"][0]["min"] = json!([0, 0, 0]);
        file["accessors"][0]["max"] = json!([1, 1, 0]);
        file["extensions"] = json!({ "KHR_lights_punctual": { "lights": [{ "type": "point" }] } });
        file["extensionsUsed"] = json!(["KHR_lights_punctual"]);
        file["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }]);
        let mut matrix = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
        matrix[12..15].copy_from_slice(&(at + DVec3::new(0.1, 2.1, 0.3)).to_array());
        file["nodes"] = json!([
            { "mesh": 0, "translation": (at + DVec3::new(0.25, 0.001, 0.3)).to_array() },
            { "translation": (at + DVec3::splat(0.7)).to_array(),
              "extensions": { "KHR_lights_punctual": { "light": 0 } } },
            { "camera": 0, "matrix": matrix },
        ]);
        file["scenes"] = json!([{ "nodes": [0, 1, 2] }]);
    })
}

fn position(scene: &Scene) -> [Vec3; 3] {
    let PunctualLight::Point { position, .. } = scene.lights[0] else { panic!("a point") };
    [scene.meshes[0].positions[1], position, scene.cameras[0].position]
}

#[test]
fn a_file_is_read_to_a_hair_at_ten_thousand_kilometres() {
    let home = import(&placed(DVec3::ZERO), None).unwrap();
    assert_eq!(home.origin, DVec3::ZERO);
    for at in [DVec3::new(1e5, 0.0, -3e5), DVec3::new(1e7, -1e7, 1e7), DVec3::new(1003.0, 0.0, 0.0)] {
        let away = import(&placed(at), None).unwrap();
        assert_eq!(away.origin % GRID, DVec3::ZERO);
        let left = at - away.origin;
        assert!(left.abs().max_element() <= GRID && away.origin.y == if at.y == 0.0 { 0.0 } else { away.origin.y });
        for (p, q) in position(&home).into_iter().zip(position(&away)) {
            let off = (q.as_dvec3() - left - p.as_dvec3()).abs().max_element();
            assert!(off < 2e-5, "{at}: {q} is off by {off}");
        }
    }
    // A scene near the origin keeps its coordinates, and so does a distant one with `keep_origin`.
    assert_eq!(import(&placed(DVec3::splat(200.0)), None).unwrap().origin, DVec3::ZERO);
    let kept =
        super::super::import(&placed(DVec3::splat(1e5)), None, Options { keep_origin: true, ..Options::default() });
    let kept = kept.unwrap();
    assert_eq!((kept.origin, kept.meshes[0].positions[1].x), (DVec3::ZERO, 100_001.25));
}

#[test]
fn an_origin_survives_an_export() {
    let away = import(&placed(DVec3::new(1e7, 0.0, -1e7)), None).unwrap();
    assert_ne!(away.origin, DVec3::ZERO);
    let again = import(&export(&away).unwrap(), None).unwrap();
    assert_eq!((again.origin, position(&again)), (away.origin, position(&away)));
    // The origin is part of the fingerprint.
    let mut moved = away.clone();
    moved.origin.x += 1.0;
    assert_ne!(moved.fingerprint(), away.fingerprint());
}
