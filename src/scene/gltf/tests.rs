use super::*;
use crate::error::{Error, ErrorKind};
use crate::image::Image;
use crate::photometry::Luminaire;
use crate::rng::Rng;
use crate::scene::{AlphaMode, Camera, ClearCoat, Material, Mesh, PunctualLight, Specular, Texture, TextureRef, Wrap};
use glam::{Mat3, Vec2, Vec3};
use serde_json::{Value, json};
use std::cell::Cell;
use std::sync::Arc;

mod compressed;
mod features;
mod origin;

fn import(bytes: &[u8], base: Option<&Path>) -> Result<Scene> {
    super::import(bytes, base, Options::default())
}

/// Three materials: one opaque with textures, one for a lamp with a cut-out texture, and one of glass.
fn materials() -> Vec<Material> {
    let turned = Mat3::from_cols(Vec3::new(0.0, -2.0, 0.0), Vec3::new(3.0, 0.0, 0.0), Vec3::new(0.1, 0.2, 1.0));
    let oak = Material {
        base_color: Vec3::new(0.5, 0.4, 0.3),
        base_color_texture: Some(TextureRef { transform: turned, ..TextureRef::new(0) }),
        normal_texture: Some(TextureRef::new(2)),
        normal_scale: 0.75,
        metallic_roughness_texture: Some(TextureRef::new(2)),
        roughness: 0.25,
        specular: Specular {
            strength: 0.75,
            texture: Some(TextureRef { uv_set: 1, ..TextureRef::new(0) }),
            color: Vec3::new(2.0, 1.0, 0.5),
            color_texture: Some(TextureRef { transform: turned, ..TextureRef::new(0) }),
        },
        ..Material::diffuse("Oak", Vec3::ONE)
    };
    let coat = ClearCoat {
        strength: 0.5,
        texture: Some(TextureRef::new(2)),
        roughness: 0.25,
        roughness_texture: Some(TextureRef { uv_set: 1, ..TextureRef::new(2) }),
    };
    let oak = Material { coat, ..oak };
    let lamp = Material {
        emission: Vec3::new(100.0, 50.0, 25.0),
        emission_texture: Some(TextureRef { uv_set: 1, ..TextureRef::new(1) }),
        alpha_mode: AlphaMode::Mask(0.3),
        double_sided: false,
        ..Material::diffuse("Lamp", Vec3::ONE)
    };
    let glass = Material {
        transmission: 0.9,
        ior: 1.33,
        thickness: 0.02,
        attenuation_color: Vec3::new(0.5, 0.75, 1.0),
        attenuation_distance: 0.25,
        alpha: 0.5,
        alpha_mode: AlphaMode::Blend,
        ..Material::diffuse("Glass", Vec3::ONE)
    };
    vec![oak, lamp, glass]
}

/// A point, a spot and a directional light.
fn lights() -> Vec<PunctualLight> {
    let direction = Vec3::new(0.6, -0.8, 0.0);
    vec![
        PunctualLight::Point { position: Vec3::ONE, intensity: Vec3::new(300.0, 200.0, 100.0) },
        PunctualLight::Spot { position: Vec3::Y, direction, intensity: Vec3::ONE, inner_angle: 0.2, outer_angle: 0.5 },
        PunctualLight::Directional { direction: -direction, illuminance: Vec3::splat(1000.0), half_angle: 0.0 },
    ]
}

/// A scene with one of each kind of object that glTF can represent.
fn scene() -> Scene {
    let colour = Image::from_fn(4, 2, |x, y| [x as f32 / 3.0, y as f32, 0.5, 1.0 - x as f32 / 6.0]).unwrap();
    let emission = Image::from_fn(4, 4, |x, y| [if (x + y) % 3 == 0 { 8.0 } else { 0.0 }, 2.0, 0.5]).unwrap();
    let normals = Image::from_fn(2, 2, |x, _| [0.5, 0.25 + 0.5 * x as f32, 1.0]).unwrap();
    let triangle = Mesh {
        name: "Desk".into(),
        positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z],
        normals: vec![Vec3::Z; 4],
        uvs: [vec![Vec2::new(0.5, 0.25); 4], Vec::new()],
        triangles: vec![[0, 1, 2], [1, 2, 3]],
        ..Mesh::default()
    };
    let sheet = Mesh {
        name: "Sheet".into(),
        material: 1,
        normals: Vec::new(),
        uvs: [vec![Vec2::ZERO; 4], vec![Vec2::X; 4]],
        ..triangle.clone()
    };
    let pane = Mesh { name: "Pane".into(), material: 2, uvs: [Vec::new(), Vec::new()], ..triangle.clone() };
    let camera = Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, 0.0), 0.8);
    Scene {
        origin: glam::DVec3::ZERO,
        meshes: vec![triangle, sheet, pane],
        materials: materials(),
        textures: vec![
            Texture { wrap: [Wrap::Mirror, Wrap::Repeat], ..Texture::new("Colour", colour) },
            Texture { wrap: [Wrap::Clamp; 2], ..Texture::new("Lights", emission) },
            Texture::new("Data", normals),
        ],
        lights: lights(),
        distributions: Vec::new(),
        environment: None,
        sun: None,
        cameras: vec![Camera { name: "View".into(), ..camera }],
        unrendered: Vec::new(),
    }
}

fn near(a: Vec3, b: Vec3) -> bool {
    (a - b).length() <= 1e-5 * (1.0 + a.length())
}

#[test]
fn a_scene_is_unchanged_by_export_and_import() {
    let (before, glb) = (scene(), export(&scene()).unwrap());
    let after = import(&glb, None).unwrap();
    assert_eq!(after.meshes, before.meshes);
    assert!(after.unrendered.is_empty(), "{:?}", after.unrendered);
    assert_eq!(after.cameras.len(), 1);
    let (c, d) = (&after.cameras[0], &before.cameras[0]);
    assert!(c.name == "View" && near(c.position, d.position) && near(c.forward, d.forward) && near(c.up, d.up));
    assert_eq!(c.fov_y, d.fov_y);
    let debug =
        |scene: &Scene| scene.lights.iter().map(|l| format!("{l:.3?}").replace("-0.000", "0.000")).collect::<Vec<_>>();
    assert_eq!(debug(&after), debug(&before));

    for (a, b) in after.materials.iter().zip(&before.materials) {
        assert_eq!((&a.name, a.alpha_mode, a.double_sided), (&b.name, b.alpha_mode, b.double_sided));
        let numbers = |m: &Material| [m.alpha, m.metallic, m.roughness, m.normal_scale, m.transmission, m.ior];
        assert_eq!((a.base_color, numbers(a)), (b.base_color, numbers(b)));
        let specular = |m: &Material| (m.specular.strength, m.specular.color, m.specular.texture.map(|t| t.uv_set));
        assert_eq!(specular(a), specular(b));
        let coat = |m: &Material| (m.coat.strength, m.coat.roughness, m.coat.roughness_texture.map(|t| t.uv_set));
        assert_eq!(coat(a), coat(b));
        let volume = |m: &Material| (m.thickness, m.attenuation_color, m.attenuation_distance);
        assert_eq!(volume(a), volume(b));
        // Compare products of texture and factor, because the export may divide a texture by its peak and multiply the
        // factor by this peak. Steps of 8-bit sRGB are smaller than 1 % of the peak.
        for v in 0..8 {
            let uv = Vec2::new(v as f32 / 8.0, 0.6);
            let look = |scene: &Scene, reference: Option<TextureRef>| {
                let r = reference.unwrap();
                scene.textures[r.texture].sample((r.transform * uv.extend(1.0)).truncate()).truncate()
            };
            if b.emission_texture.is_some() {
                let light = |s: &Scene, m: &Material| look(s, m.emission_texture) * m.emission;
                let peak = light(&before, b).max_element().max(800.0);
                assert!((light(&after, a) - light(&before, b)).length() < 0.01 * peak);
                assert_eq!(a.emission_texture.unwrap().uv_set, 1);
            }
            for pick in [
                |m: &Material| m.base_color_texture,
                |m: &Material| m.normal_texture,
                |m: &Material| m.metallic_roughness_texture,
                |m: &Material| m.specular.texture,
                |m: &Material| m.specular.color_texture,
                |m: &Material| m.coat.texture,
                |m: &Material| m.coat.roughness_texture,
            ] {
                if pick(b).is_some() {
                    assert!((look(&after, pick(a)) - look(&before, pick(b))).length() < 0.01);
                }
            }
        }
    }
    let wraps = |s: &Scene| s.textures.iter().map(|t| (t.name.clone(), t.wrap)).collect::<Vec<_>>();
    let mut sorted = [wraps(&after), wraps(&before)];
    sorted.iter_mut().for_each(|w| w.sort_by(|a, b| a.0.cmp(&b.0)));
    assert_eq!(sorted[0], sorted[1]);
    assert!(import(&export(&Scene::default()).unwrap(), None).unwrap().meshes.is_empty());
}

/// Luminaires keep their orientation and their distribution, and each distribution is written only once.
#[test]
fn luminaires_are_unchanged_by_export_and_import() {
    let measured = |planes: usize| Luminaire {
        planes: (0..planes).map(|i| i as f64 * 90.0).collect(),
        gammas: vec![0.0, 30.0, 90.0],
        candela: (0..3 * planes).map(|i| 10.5 + i as f64).collect(),
        ..Luminaire::lambertian("Spot 7", 800.0, [0.1, -0.1, 0.0])
    };
    let hang = |axis: Vec3, distribution: usize| PunctualLight::Luminaire {
        position: Vec3::new(1.0, 2.5, -3.0),
        axis,
        c0: axis.any_orthonormal_vector(),
        colour: Vec3::new(2.0, 1.5, 1.0),
        distribution,
        is_point: axis == Vec3::Z,
    };
    let before = Scene {
        lights: vec![hang(Vec3::NEG_Y, 1), hang(Vec3::new(0.6, -0.8, 0.0), 0), hang(Vec3::Z, 1)],
        distributions: vec![Arc::new(measured(4)), Arc::new(measured(1))],
        ..Scene::default()
    };
    let glb = export(&before).unwrap();
    assert_eq!(glb.windows(9).filter(|w| w == b"TILT=NONE").count(), 2);
    let after = import(&glb, None).unwrap();
    assert_eq!(after.lights.len(), 3);
    for (a, b) in after.lights.iter().zip(&before.lights) {
        let parts = |light: &PunctualLight, scene: &Scene| match *light {
            PunctualLight::Luminaire { position, axis, c0, colour, distribution, is_point } => {
                ([position, axis, c0, colour], (scene.distributions[distribution].clone(), is_point))
            }
            _ => unreachable!(),
        };
        let ((a, measured_a), (b, measured_b)) = (parts(a, &after), parts(b, &before));
        assert!(a.iter().zip(b).all(|(a, b)| near(*a, b)), "{a:?} {b:?}");
        assert_eq!(measured_a, measured_b);
    }
    // With `point_luminaires`, all luminaires shine from points.
    let options = super::Options { point_luminaires: true, ..super::Options::default() };
    let points = super::import(&glb, None, options).unwrap().lights;
    assert!(points.iter().all(|light| matches!(light, PunctualLight::Luminaire { is_point: true, .. })));
    // Inconsistent files give an error.
    let broken = |from: &str, to: &str| {
        let at = glb.windows(from.len()).position(|w| w == from.as_bytes()).unwrap();
        let mut bytes = glb.clone();
        bytes[at..at + to.len()].copy_from_slice(to.as_bytes());
        import(&bytes, None).unwrap_err()
    };
    assert!(broken("\"light\":0", "\"light\":9").message.contains("EXT_lights_ies"));
    assert!(broken("TILT=NONE", "TINT=NONE").message.contains("TILT"));
    assert!(broken("\"bufferView\"", "\"bufferWiew\"").message.contains("no file"));
}

/// A glTF file with one triangle under a node, changed by `edit`.
fn triangle_file(edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    // The buffer holds three positions, then the indices 0 1 2 as bytes.
    let uri = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAECAA==";
    let mut root = json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "Tri" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "uri": uri, "byteLength": 40 }],
        "bufferViews": [
            { "buffer": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 4 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" },
            { "bufferView": 1, "componentType": 5121, "count": 3, "type": "SCALAR" },
        ],
    });
    edit(&mut root);
    root.to_string().into_bytes()
}

#[test]
fn transforms_are_applied_and_reflections_keep_their_front() {
    let plain = import(&triangle_file(|_| ()), None).unwrap();
    assert_eq!(plain.meshes[0].corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!((plain.meshes[0].name.as_str(), plain.materials[0].name.as_str()), ("Tri", "Default"));

    // A child node mirrored in x, under a parent that is translated, rotated by 90° about z, and scaled.
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nested = triangle_file(|f| {
        f["nodes"] = json!([
            { "children": [1], "translation": [1, 2, 3], "rotation": [0, 0, half, half], "scale": [2, 2, 2] },
            { "mesh": 0, "scale": [-1, 1, 1] },
        ]);
        f["meshes"][0]["name"] = "Own".into();
    });
    let mesh = &import(&nested, None).unwrap().meshes[0];
    let [a, b, c] = mesh.corners(0);
    assert!(
        near(a, Vec3::new(1.0, 2.0, 3.0)) && near(b, Vec3::new(-1.0, 2.0, 3.0)) && near(c, Vec3::new(1.0, 0.0, 3.0))
    );
    assert!((b - a).cross(c - a).z > 0.0 && mesh.name == "Own");
}

#[test]
fn strips_fans_and_sparse_accessors() {
    let with_mode = |mode: u32| {
        let file = triangle_file(|f| {
            f["meshes"][0]["primitives"][0]["mode"] = mode.into();
            f["accessors"][1]["count"] = 4.into();
        });
        import(&file, None).unwrap().meshes.first().map(|m| m.triangles.clone())
    };
    // `with_mode` reads four index bytes instead of three. The fourth byte is 0, so the indices are 0 1 2 0.
    assert_eq!(with_mode(5).unwrap(), [[0, 1, 2], [1, 0, 2]]);
    assert_eq!(with_mode(6).unwrap(), [[1, 2, 0]]);
    assert_eq!(with_mode(4).unwrap(), [[0, 1, 2]]);
    assert_eq!(with_mode(1), None, "lines are passed over");

    // A sparse accessor replaces one position, once over a stored array and once over zeros.
    for base in [true, false] {
        let file = triangle_file(|f| {
            f["accessors"][0]["sparse"] = json!({
                "count": 1,
                "indices": { "bufferView": 1, "byteOffset": 1, "componentType": 5121 },
                "values": { "bufferView": 0, "byteOffset": 24 },
            });
            if !base {
                f["accessors"][0].as_object_mut().unwrap().remove("bufferView");
            }
        });
        let last = if base { Vec3::Y } else { Vec3::ZERO };
        assert_eq!(import(&file, None).unwrap().meshes[0].positions, [Vec3::ZERO, Vec3::Y, last]);
    }
}

#[test]
fn inconsistent_files_are_errors_that_give_the_reason() {
    type Edit = fn(&mut Value);
    let cases: [(&str, Edit); 26] = [
        ("buffer view 9", |f| f["accessors"][0]["bufferView"] = 9.into()),
        ("accessor 7", |f| f["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7.into()),
        ("do not fit", |f| f["accessors"][0]["count"] = 4.into()),
        ("do not fit", |f| f["accessors"][0]["count"] = 30_000_000.into()),
        ("counting every instance", |f| f["accessors"][0]["count"] = u64::MAX.into()),
        ("do not fit", |f| f["accessors"][0]["byteOffset"] = u64::MAX.into()),
        ("covers", |f| f["bufferViews"][0]["byteLength"] = 41.into()),
        ("covers", |f| f["bufferViews"][1]["byteOffset"] = u64::MAX.into()),
        ("byteLength is 60", |f| f["buffers"][0]["byteLength"] = 60.into()),
        ("buffer 0 has no URI", |f| {
            f["buffers"][0].as_object_mut().unwrap().remove("uri");
        }),
        ("stride", |f| f["bufferViews"][0]["byteStride"] = 0.into()),
        ("an index is", |f| f["bufferViews"][1]["byteOffset"] = 14.into()),
        ("reached twice", |f| f["nodes"][0]["children"] = json!([0])),
        ("reached twice", |f| f["scenes"][0]["nodes"] = json!([0, 0])),
        ("circle", |f| {
            f["nodes"][0]["children"] = json!([0]);
            f["scenes"] = json!([]);
        }),
        ("node 5", |f| f["nodes"][0]["children"] = json!([5])),
        ("mesh 3", |f| f["nodes"][0]["mesh"] = 3.into()),
        ("material 0", |f| f["meshes"][0]["primitives"][0]["material"] = 0.into()),
        ("not finite", |f| f["nodes"][0]["scale"] = json!([1e300, 1, 1])),
        ("vertex 1", |f| {
            f["nodes"] = json!([{ "children": [1], "scale": [1e30, 1, 1] }, { "mesh": 0, "scale": [1e30, 1, 1] }])
        }),
        ("components", |f| f["accessors"][0]["type"] = "VEC2".into()),
        ("unknown", |f| f["accessors"][0]["type"] = "VEC9".into()),
        ("KHR_texture_basisu", |f| f["extensionsRequired"] = json!(["KHR_texture_basisu"])),
        ("at most", |f| f["accessors"][0] = json!({ "componentType": 5126, "count": 60_000_000, "type": "VEC3" })),
        ("beside it", |f| f["buffers"][0]["uri"] = "mesh.bin".into()),
        ("outside the folder", |f| f["buffers"][0]["uri"] = "../mesh.bin".into()),
    ];
    for (i, (message, edit)) in cases.into_iter().enumerate() {
        let error = import(&triangle_file(edit), None).expect_err(&format!("case {i}: {message}"));
        assert!(error.message.contains(message), "case {i}: {error}");
    }
    // Two nodes share a mesh of 33 primitives of 2^20 vertices. The limit is 2^26 vertices: the mesh alone is below it,
    // and the scene, which has the mesh twice, is above it.
    let bomb = triangle_file(|f| {
        f["accessors"][0] = json!({ "componentType": 5126, "count": 1 << 20, "type": "VEC3" });
        f["meshes"][0]["primitives"] = json!(vec![json!({ "attributes": { "POSITION": 0 }, "indices": 1 }); 33]);
        f["nodes"] = json!([{ "children": [1, 2] }, { "mesh": 0 }, { "mesh": 0 }]);
    });
    assert_eq!(import(&bomb, None).unwrap_err().kind, ErrorKind::Unsupported);
    for (bytes, base) in [(&b""[..], None), (b"{}", None), (b"glTF", None), (b"glTF\x02\0\0\0\0\0\0\0", None)] {
        assert!(import(bytes, base).is_err());
    }
}

#[test]
fn a_budget_is_asked_for_all_that_will_be_made() {
    let glb = export(&scene()).unwrap();
    /// A budget that records the bytes of the scene and the largest temporary amount, and refuses a scene above
    /// `limit`.
    struct Limited {
        limit: u64,
        kept: Cell<u64>,
        lent: Cell<u64>,
    }
    impl Budget for Limited {
        fn keep(&self, bytes: u64) -> Result<()> {
            self.kept.set(self.kept.get() + bytes);
            if self.kept.get() <= self.limit { Ok(()) } else { Err(Error::new(ErrorKind::OutOfMemory, "enough")) }
        }

        fn lend(&self, bytes: u64, work: &mut dyn FnMut() -> Result<()>) -> Result<()> {
            self.lent.set(self.lent.get().max(bytes));
            work()
        }
    }
    let read = |limit: u64| {
        let budget = Limited { limit, kept: Cell::new(0), lent: Cell::new(0) };
        super::import(&glb, None, Options { budget: &budget, ..Options::default() })
            .map(|scene| (scene, budget.kept.get(), budget.lent.get()))
    };
    let (whole, kept, lent) = read(u64::MAX).unwrap();
    assert!(lent > 0, "decoding a texture takes memory");
    let meshes = whole.meshes.iter().map(|m| {
        let uvs: usize = m.uvs.iter().map(|uvs| size_of_val(&uvs[..])).sum();
        size_of_val(&m.positions[..]) + size_of_val(&m.normals[..]) + size_of_val(&m.triangles[..]) + uvs
    });
    let textures = whole.textures.iter().map(|t| size_of_val(&t.image.data[..]));
    let needed = meshes.chain(textures).sum::<usize>() as u64;
    assert_eq!(kept, needed);
    for limit in [0, needed / 2, needed - 1] {
        assert_eq!(read(limit).unwrap_err().kind, ErrorKind::OutOfMemory, "{limit} of {needed}");
    }
}

#[test]
fn a_vertex_that_is_no_number_is_named() {
    let mut glb = export(&scene()).unwrap();
    let json_length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    // Images are stored first, so take the offset of the positions from the JSON.
    let root: Value = serde_json::from_slice(&glb[20..20 + json_length]).unwrap();
    let view = &root["bufferViews"][root["accessors"][0]["bufferView"].as_u64().unwrap() as usize];
    let at = 28 + json_length + view["byteOffset"].as_u64().unwrap() as usize + 12;
    glb[at..at + 4].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = import(&glb, None).unwrap_err();
    assert!(error.kind == ErrorKind::Format && error.message.contains("\"Desk\""), "{error}");
    assert!(error.message.contains("vertex 1"), "{error}");
}

/// A corrupt file gives a valid scene or an error, whichever bytes are changed.
#[test]
fn broken_bytes_never_panic() {
    let glb = export(&scene()).unwrap();
    for cut in 0..glb.len() {
        assert!(import(&glb[..cut], None).is_err(), "cut at {cut}");
    }
    let json_length = u32::from_le_bytes([glb[12], glb[13], glb[14], glb[15]]) as usize;
    let mut survived = 0;
    for round in 0..6000u64 {
        let mut rng = Rng::new(42, &[round]);
        let mut broken = glb.clone();
        for _ in 0..=rng.below(4) {
            // Corrupt the JSON, which holds the structure, in at least three of four cases. A digit becomes another
            // random digit: the JSON stays readable, but its numbers may contradict each other.
            let at = if rng.below(4) == 0 { rng.below(glb.len()) } else { 20 + rng.below(json_length) };
            broken[at] = match rng.below(3) {
                _ if broken[at].is_ascii_digit() => b'0' + rng.below(10) as u8,
                0 => rng.next_u32() as u8,
                1 => broken[at] ^ (1 << rng.below(8)),
                _ => b"0123456789-e.,:[]{}\""[rng.below(20)],
            };
        }
        if let Ok(scene) = import(&broken, None) {
            assert_eq!(scene.validate(), Ok(()));
            survived += 1;
        }
    }
    assert!(survived > 100, "only {survived} mutations left a readable file: they are too coarse to test anything");
}
