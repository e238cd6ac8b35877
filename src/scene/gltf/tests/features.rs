//! Tests of valid files in unusual forms, of features that are read, and of reports on features that are not rendered.

use super::*;

/// Imports a file and returns the messages about its features that are not rendered.
fn unrendered(edit: impl FnOnce(&mut Value)) -> Vec<String> {
    import(&triangle_file(edit), None).unwrap().unrendered.iter().map(ToString::to_string).collect()
}

#[test]
fn only_gltf_2_is_read() {
    let with = |version: &str, least: Option<&str>| {
        import(
            &triangle_file(|f| {
                f["asset"]["version"] = version.into();
                f["asset"]["minVersion"] = least.map_or(Value::Null, Value::from);
            }),
            None,
        )
    };
    for (version, least) in [("2.0", None), ("2.1", None), ("2.0", Some("2.0")), ("2.9", Some("2.0"))] {
        assert!(with(version, least).is_ok(), "{version} {least:?}");
    }
    for (version, least) in [("1.0", None), ("3.0", None), ("2.1", Some("2.1")), ("2.0", Some("3.0"))] {
        let error = with(version, least).unwrap_err();
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains("only glTF 2.0"), "{error}");
    }
    for text in ["", "2", "two.zero"] {
        assert_eq!(with(text, None).unwrap_err().kind, ErrorKind::Format, "{text:?}");
    }
}

/// Unusual but valid forms of a file: the name of each form, and an edit that gives the file this form without
/// changing the picture.
fn unusual_forms() -> [(&'static str, fn(&mut Value)); 10] {
    [
        ("extras of any type", |f| {
            f["extras"] = json!(7);
            f["nodes"][0]["extras"] = json!("a text");
            f["meshes"][0]["extras"] = json!([1, null, { "extras": true }]);
            f["meshes"][0]["primitives"][0]["extras"] = Value::Null;
            f["asset"]["extras"] = json!(false);
        }),
        ("integers as floats", |f| {
            f["nodes"][0]["mesh"] = json!(0.0);
            f["scenes"][0]["nodes"] = json!([0.0]);
            f["accessors"][0]["count"] = json!(3.0);
            f["accessors"][0]["componentType"] = json!(5126.0);
            f["bufferViews"][1]["byteOffset"] = json!(36.0);
            f["nodes"][0]["translation"] = json!([0.0, -0.0, 0]);
        }),
        ("a channel without node", |f| {
            let target = json!({ "path": "translation" });
            f["animations"] = json!([{ "channels": [{ "sampler": 0, "target": target }], "samplers": [{ "input": 0, "output": 0 }] }]);
        }),
        ("variants as required", |f| {
            f["extensionsRequired"] = json!(["KHR_materials_variants"]);
            f["extensions"] = json!({ "KHR_materials_variants": { "variants": [{ "name": "Red" }] } });
            f["meshes"][0]["primitives"][0]["extensions"] =
                json!({ "KHR_materials_variants": { "mappings": [{ "material": 0, "variants": [0] }] } });
        }),
        ("white vertices", |f| {
            f["accessors"].as_array_mut().unwrap().push(json!({
                "bufferView": 2, "componentType": 5121, "normalized": true, "count": 3, "type": "VEC4"
            }));
            f["buffers"].as_array_mut().unwrap().push(json!({
                "byteLength": 12, "uri": "data:application/octet-stream;base64,////////////////"
            }));
            f["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 1, "byteLength": 12 }));
            f["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(2);
        }),
        ("a clear coat without effect", |f| {
            f["materials"] = json!([{ "name": "Default", "extensions": { "KHR_materials_clearcoat": { "clearcoatRoughnessFactor": 0.5 } } }]);
        }),
        ("a specular layer without effect", |f| {
            f["materials"] = json!([{ "name": "Default", "extensions": { "KHR_materials_specular": { "specularColorFactor": [1, 1.0, 1] } } }]);
        }),
        ("a texture without source", |f| {
            f["textures"] = json!([{}]);
            f["materials"] =
                json!([{ "name": "Default", "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
            f["meshes"][0]["primitives"][0]["material"] = json!(0);
        }),
        ("a buffer without data that nothing uses", |f| {
            f["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": 1 }));
            f["bufferViews"].as_array_mut().unwrap().push(json!({ "buffer": 1, "byteLength": 1 }));
        }),
        ("metadata", |f| f["extensionsUsed"] = json!(["KHR_xmp_json_ld"])),
    ]
}

#[test]
fn valid_files_in_unusual_forms_are_read() {
    let plain = import(&triangle_file(|_| ()), None).unwrap();
    for (name, edit) in unusual_forms() {
        let scene = import(&triangle_file(edit), None).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert_eq!(scene.meshes[0].positions, plain.meshes[0].positions, "{name}");
        assert_eq!(scene.materials[scene.meshes[0].material], plain.materials[0], "{name}");
        let expected = usize::from(name == "a channel without node");
        assert_eq!(scene.unrendered.len(), expected, "{name}: {:?}", scene.unrendered);
    }
    // A scene without nodes gives an empty scene.
    let empty = import(&triangle_file(|f| f["scenes"] = json!([{ "name": "Empty" }])), None).unwrap();
    assert!(empty.meshes.is_empty());
}

/// The material extensions that are not rendered.
const UNRENDERED_MATERIALS: [&str; 5] = [
    "KHR_materials_anisotropy",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_iridescence",
    "KHR_materials_sheen",
];

#[test]
fn each_feature_that_is_not_rendered_is_named() {
    let settings = [
        json!({ "anisotropyStrength": 0.5 }),
        json!({ "diffuseTransmissionFactor": 0.25 }),
        json!({ "dispersion": 0.1 }),
        json!({ "iridescenceFactor": 1.0 }),
        json!({ "sheenColorFactor": [0, 0, 0.5] }),
    ];
    for (name, settings) in UNRENDERED_MATERIALS.into_iter().zip(settings) {
        let texts = unrendered(|f| {
            f["textures"] = json!([{}]);
            f["materials"] = json!([{ "name": "Paint", "extensions": { name: settings } }]);
        });
        assert_eq!(texts.len(), 1, "{name}");
        assert!(texts[0].starts_with(name) && texts[0].contains("material \"Paint\""), "{}", texts[0]);
    }
    type Edit = fn(&mut Value);
    let others: [(&str, &str, Edit); 6] = [
        ("KHR_texture_basisu", "texture 0", |f| {
            f["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
        }),
        ("morph targets of colours", "mesh 0", |f| {
            f["meshes"][0]["primitives"][0]["targets"] = json!([{ "POSITION": 0, "COLOR_0": 0 }]);
            f["meshes"][0]["weights"] = json!([0.5]);
        }),
        ("animations", "animation \"Walk\"", |f| {
            f["animations"] = json!([{ "name": "Walk", "channels": [], "samplers": [] }])
        }),
        ("points and lines", "mesh 0", |f| f["meshes"][0]["primitives"][0]["mode"] = json!(1)),
        ("orthographic cameras", "camera 0", |f| {
            let orthographic = json!({ "xmag": 1, "ymag": 1, "zfar": 10, "znear": 0.1 });
            f["cameras"] = json!([{ "type": "orthographic", "orthographic": orthographic }]);
        }),
        ("VENDOR_glow", "node \"Tri\"", |f| f["nodes"][0]["extensions"] = json!({ "VENDOR_glow": {} })),
    ];
    for (name, place, edit) in others {
        let texts = unrendered(edit);
        assert_eq!(texts.len(), 1, "{name}: {texts:?}");
        assert!(texts[0].starts_with(name) && texts[0].contains(place), "{}", texts[0]);
    }
    assert!(unrendered(|_| ()).is_empty());
}

/// Imports a triangle whose material has the extensions `extensions`. Texture 0 has one texel of the colour (0, 0, 0).
fn with_extensions(extensions: &Value) -> Result<Scene> {
    let file = triangle_file(|f| {
        let uri = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNgYGAAAAAEAAH2FzhVAAAAAElFTkSuQmCC";
        f["images"] = json!([{ "uri": uri }]);
        f["textures"] = json!([{ "source": 0 }]);
        f["extensionsRequired"] = json!(extensions.as_object().unwrap().keys().collect::<Vec<_>>());
        f["materials"] = json!([{ "name": "Paint", "extensions": extensions }]);
        f["meshes"][0]["primitives"][0]["material"] = json!(0);
    });
    import(&file, None)
}

/// Imports a material with one extension, all of whose settings must be rendered.
fn with_extension(name: &str, settings: &Value) -> Material {
    let scene = with_extensions(&json!({ name: settings })).unwrap();
    assert!(scene.unrendered.is_empty() && scene.validate().is_ok(), "{settings}");
    scene.materials[0].clone()
}

#[test]
fn specular_reflection_is_read_and_brought_into_range() {
    let read = |settings: Value| with_extension("KHR_materials_specular", &settings).specular;
    assert_eq!(read(json!({})), Specular::default());
    let found = read(json!({ "specularFactor": 0.25, "specularColorFactor": [2, 0.5, 1.0] }));
    assert_eq!(found, Specular { strength: 0.25, color: Vec3::new(2.0, 0.5, 1.0), ..Specular::default() });
    let found = read(json!({ "specularFactor": 7, "specularColorFactor": [-1, 1e30, 0] }));
    assert_eq!((found.strength, found.color.to_array()), (1.0, [0.0, crate::scene::MAX_LIGHT, 0.0]));
    let transform = json!({ "KHR_texture_transform": { "scale": [2, 2] } });
    let found = read(json!({
        "specularTexture": { "index": 0, "texCoord": 1 },
        "specularColorTexture": { "index": 0, "extensions": transform }
    }));
    assert_eq!(found.texture, Some(TextureRef { uv_set: 1, ..TextureRef::new(0) }));
    assert_eq!(found.color_texture.map(|t| (t.texture, t.transform.x_axis.x)), Some((0, 2.0)));
    for settings in [
        json!({ "specularFactor": "much" }),
        json!({ "specularColorFactor": [1, 2] }),
        json!({ "specularTexture": 3 }),
        json!({ "specularTexture": { "index": 1 } }),
    ] {
        let error = with_extensions(&json!({ "KHR_materials_specular": settings })).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains("aterial"), "{settings}: {error}");
    }
}

#[test]
fn clear_coats_are_read_and_brought_into_range() {
    let read = |settings: Value| with_extension("KHR_materials_clearcoat", &settings).coat;
    let unused = json!({ "clearcoatRoughnessFactor": 1, "clearcoatTexture": { "index": 0 } });
    assert_eq!((read(json!({})), read(unused)), (ClearCoat::default(), ClearCoat::default()));
    let found = read(json!({ "clearcoatFactor": 7, "clearcoatRoughnessFactor": -1 }));
    assert_eq!(found, ClearCoat { strength: 1.0, ..ClearCoat::default() });
    let found = read(json!({
        "clearcoatFactor": 0.5,
        "clearcoatTexture": { "index": 0 },
        "clearcoatRoughnessFactor": 0.25,
        "clearcoatRoughnessTexture": { "index": 0, "texCoord": 1 }
    }));
    let texture = Some(TextureRef::new(0));
    let roughness_texture = Some(TextureRef { uv_set: 1, ..TextureRef::new(0) });
    assert_eq!(found, ClearCoat { strength: 0.5, texture, roughness: 0.25, roughness_texture });
    let broken = json!({ "KHR_materials_clearcoat": { "clearcoatFactor": [1] } });
    assert_eq!(with_extensions(&broken).unwrap_err().kind, ErrorKind::Format);
}

/// A coat has the normals of the material below. If the file states others, the difference is named.
#[test]
fn normals_of_a_coat_that_differ_from_the_material_are_named() {
    let named = |strength: f32, normals: Value, coat_normals: Value| {
        let texts = unrendered(|f| {
            f["textures"] = json!([{}, {}]);
            let coat = json!({ "clearcoatFactor": strength, "clearcoatNormalTexture": coat_normals });
            f["materials"] = json!([{ "name": "Car", "extensions": { "KHR_materials_clearcoat": coat } }]);
            f["materials"][0]["normalTexture"] = normals;
            let drop_nulls = |object: &mut Value| object.as_object_mut().unwrap().retain(|_, value| !value.is_null());
            drop_nulls(&mut f["materials"][0]["extensions"]["KHR_materials_clearcoat"]);
            drop_nulls(&mut f["materials"][0]);
        });
        assert!(texts.iter().all(|text| text.contains("\"Car\"") && text.contains("has the normals of")));
        texts.len()
    };
    let (flakes, bumps) = (json!({ "index": 0 }), json!({ "index": 1 }));
    assert_eq!(named(1.0, Value::Null, Value::Null), 0);
    assert_eq!(named(1.0, flakes.clone(), flakes.clone()), 0);
    assert_eq!(named(1.0, flakes.clone(), Value::Null), 1);
    assert_eq!(named(1.0, Value::Null, bumps.clone()), 1);
    assert_eq!(named(1.0, flakes.clone(), bumps.clone()), 1);
    assert_eq!(named(0.0, flakes, bumps), 0);
}

/// The extensions of the layers of a material are rendered, but not on solid glass, where they are named.
#[test]
fn layers_of_solid_glass_are_named() {
    for (name, settings, neutral) in [
        ("KHR_materials_specular", json!({ "specularColorTexture": { "index": 0 } }), json!({ "specularFactor": 1 })),
        ("KHR_materials_clearcoat", json!({ "clearcoatFactor": 1 }), json!({ "clearcoatRoughnessFactor": 1 })),
    ] {
        let named = |thickness: f32, settings: &Value| {
            let scene = with_extensions(&json!({
                name: settings,
                "KHR_materials_volume": { "thicknessFactor": thickness },
                "KHR_materials_transmission": { "transmissionFactor": 1 }
            }));
            scene.unwrap().unrendered.iter().map(ToString::to_string).collect::<Vec<_>>()
        };
        let texts = named(0.5, &settings);
        assert!(texts.len() == 1 && texts[0].starts_with(name) && texts[0].contains("\"Paint\""), "{texts:?}");
        assert!(named(0.0, &settings).is_empty() && named(0.5, &neutral).is_empty());
    }
}

#[test]
fn volumes_are_read_and_brought_into_range() {
    let read = |settings: Value| {
        let file = triangle_file(|f| {
            f["extensionsRequired"] = json!(["KHR_materials_volume"]);
            f["materials"] = json!([{ "extensions": { "KHR_materials_volume": settings } }]);
            f["meshes"][0]["primitives"][0]["material"] = json!(0);
        });
        let scene = import(&file, None).unwrap();
        assert!(scene.unrendered.is_empty() && scene.validate().is_ok());
        let material = &scene.materials[0];
        (material.thickness, material.attenuation_color.to_array(), material.attenuation_distance)
    };
    assert_eq!(read(json!({})), (0.0, [1.0; 3], f32::INFINITY));
    let settings = json!({ "thicknessFactor": 0.5, "attenuationColor": [0.25, 0, 1], "attenuationDistance": 2 });
    assert_eq!(read(settings), (0.5, [0.25, 0.0, 1.0], 2.0));
    let wild = json!({ "thicknessFactor": -1, "attenuationColor": [2, -1, 0.5], "attenuationDistance": 0 });
    assert_eq!(read(wild), (0.0, [1.0, 0.0, 0.5], f32::MIN_POSITIVE));
}

#[test]
fn specular_and_glossiness_become_metallic_and_rough() {
    let with = |edit: &dyn Fn(&mut Value)| {
        let file = triangle_file(|f| {
            f["extensionsRequired"] = json!(["KHR_materials_pbrSpecularGlossiness"]);
            // A PNG of one pixel of the colour (0, 0, 0).
            let uri = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGNgYGAAAAAEAAH2FzhVAAAAAElFTkSuQmCC";
            f["images"] = json!([{ "uri": uri }]);
            f["textures"] = json!([{ "source": 0 }]);
            let settings =
                json!({ "diffuseFactor": [0, 0, 0, 0.5], "specularFactor": [0.9, 0.5, 0.3], "glossinessFactor": 0.75 });
            f["materials"] = json!([{ "extensions": { "KHR_materials_pbrSpecularGlossiness": settings } }]);
            f["meshes"][0]["primitives"][0]["material"] = json!(0);
            edit(&mut f["materials"][0]["extensions"]["KHR_materials_pbrSpecularGlossiness"]);
        });
        import(&file, None).unwrap()
    };
    let scene = with(&|_| ());
    let metal = &scene.materials[0];
    assert!((metal.base_color - Vec3::new(0.9, 0.5, 0.3)).abs().max_element() < 0.01, "{metal:?}");
    assert!(metal.metallic > 0.99 && metal.roughness == 0.25 && metal.alpha == 0.5, "{metal:?}");
    assert!(scene.unrendered.is_empty() && scene.textures.is_empty());

    // If the material has a texture, its base colour and its roughness with metalness become two textures. Both survive
    // an export and import.
    let scene = with(&|settings| settings["diffuseTexture"] = json!({ "index": 0, "texCoord": 1 }));
    let metal = &scene.materials[0];
    assert_eq!((metal.base_color, metal.metallic, metal.roughness, metal.alpha), (Vec3::ONE, 1.0, 1.0, 1.0));
    assert_eq!(metal.base_color_texture.map(|t| (t.texture, t.uv_set)), Some((0, 1)));
    assert_eq!(metal.metallic_roughness_texture.map(|t| t.texture), Some(1));
    assert!((scene.textures[0].image.data[0] - 0.9).abs() < 0.01 && scene.textures[0].image.data[3] == 0.5);
    assert_eq!(scene.textures[1].image.data[1], 0.25);
    assert_eq!(import(&export(&scene).unwrap(), None).unwrap().textures.len(), 2);

    // A material whose two textures have different coordinates is not converted.
    let scene = with(&|settings| {
        settings["diffuseTexture"] = json!({ "index": 0, "texCoord": 1 });
        settings["specularGlossinessTexture"] = json!({ "index": 0 });
    });
    assert!(scene.textures.is_empty() && scene.unrendered.len() == 1, "{:?}", scene.unrendered);
}

#[test]
fn extensions_that_are_required_are_rendered_or_refused_by_name() {
    let rendered = [
        "EXT_mesh_gpu_instancing",
        "EXT_meshopt_compression",
        "EXT_texture_webp",
        "KHR_draco_mesh_compression",
        "KHR_materials_clearcoat",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_specular",
        "KHR_materials_variants",
        "KHR_mesh_quantization",
        "KHR_meshopt_compression",
    ];
    for name in rendered {
        let scene = import(&triangle_file(|f| f["extensionsRequired"] = json!([name])), None).unwrap();
        assert!(scene.unrendered.is_empty(), "{name}");
    }
    for name in UNRENDERED_MATERIALS.into_iter().chain(["KHR_texture_basisu", "VENDOR_glow"]) {
        let error = import(&triangle_file(|f| f["extensionsRequired"] = json!([name])), None).unwrap_err();
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains(name), "{name}: {error}");
    }
}

/// Adds an accessor of floats in a buffer of its own; returns the index of the accessor.
pub fn add_floats(file: &mut Value, kind: &str, count: usize, numbers: &[f32]) -> usize {
    let raw: Vec<u8> = numbers.iter().flat_map(|v| v.to_le_bytes()).collect();
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::new();
    for chunk in raw.chunks(3) {
        let word = chunk.iter().fold(0u32, |w, &b| w << 8 | u32::from(b)) << (8 * (3 - chunk.len()));
        for digit in 0..=chunk.len() {
            text.push(char::from(DIGITS[(word >> (18 - 6 * digit)) as usize & 63]));
        }
    }
    let add = |list: &mut Value, item: Value| {
        let list = list.as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    };
    let uri = format!("data:application/octet-stream;base64,{text}");
    let buffer = add(&mut file["buffers"], json!({ "uri": uri, "byteLength": raw.len() }));
    let view = add(&mut file["bufferViews"], json!({ "buffer": buffer, "byteLength": raw.len() }));
    let accessor = json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind });
    add(&mut file["accessors"], accessor)
}

#[test]
fn instances_are_meshes_of_their_own() {
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let file = |short: bool| {
        triangle_file(|f| {
            let translations = add_floats(f, "VEC3", 2, &[1.0, 2.0, 3.0, -1.0, 0.0, 0.0]);
            let rotations = add_floats(f, "VEC4", 2 - usize::from(short), &[0.0, 0.0, 0.0, 1.0, 0.0, 0.0, half, half]);
            let scales = add_floats(f, "VEC3", 2, &[2.0, 2.0, 2.0, 1.0, 1.0, 1.0]);
            let attributes = json!({ "TRANSLATION": translations, "ROTATION": rotations, "SCALE": scales });
            f["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
            f["nodes"][0]["extensions"] = json!({ "EXT_mesh_gpu_instancing": { "attributes": attributes } });
            f["nodes"][0]["translation"] = json!([0, 0, 10]);
        })
    };
    let scene = import(&file(false), None).unwrap();
    assert_eq!((scene.meshes.len(), scene.unrendered.len()), (2, 0));
    let corners = scene.meshes.iter().map(|mesh| mesh.corners(0)).collect::<Vec<_>>();
    let expected = [
        [Vec3::new(1.0, 2.0, 13.0), Vec3::new(3.0, 2.0, 13.0), Vec3::new(1.0, 4.0, 13.0)],
        [Vec3::new(-1.0, 0.0, 10.0), Vec3::new(-1.0, 1.0, 10.0), Vec3::new(-2.0, 0.0, 10.0)],
    ];
    for (found, wanted) in corners.iter().flatten().zip(expected.iter().flatten()) {
        assert!(near(*found, *wanted), "{found} instead of {wanted}");
    }
    let error = import(&file(true), None).unwrap_err();
    assert!(error.message.contains("different counts"), "{error}");
    // A small file may ask for millions of instances, since its accessor needs no data.
    let bomb = triangle_file(|f| {
        let accessor = json!({ "componentType": 5126, "count": 1 << 20, "type": "VEC3" });
        f["accessors"].as_array_mut().unwrap().push(accessor);
        f["meshes"][0]["primitives"][0]["indices"] = Value::Null;
        f["accessors"][0]["count"] = json!(1);
        let instances = json!({ "EXT_mesh_gpu_instancing": { "attributes": { "TRANSLATION": 2 } } });
        f["nodes"] = json!([{ "mesh": 0, "extensions": instances }, { "mesh": 0, "extensions": instances }]);
        f["scenes"][0]["nodes"] = json!([0, 1]);
    });
    let error = import(&bomb, None).unwrap_err();
    assert!(error.kind == ErrorKind::Unsupported && error.message.contains("1048576 meshes"), "{error}");
}

/// The joints of the skin are nodes 1 and 2. Node 1 moves the first corner of a triangle, node 2 the second, and both
/// with equal weights the third.
#[test]
fn a_skin_is_bent_by_its_joints_at_rest() {
    let file = |joint: f32, matrices: usize| {
        triangle_file(|f| {
            let joints = add_floats(f, "VEC4", 3, &[0.0, 0.0, 0.0, 0.0, joint, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0]);
            let weights = add_floats(f, "VEC4", 3, &[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
            let normals = add_floats(f, "VEC3", 3, &[0.0, 0.0, 1.0].repeat(3));
            // In the bind pose, node 1 is at the origin and node 2 at (1, 0, 0).
            let unit = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
            let moved = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 1.0];
            let inverse = add_floats(f, "MAT4", matrices, &[unit, moved].concat()[..16 * matrices]);
            let attributes = &mut f["meshes"][0]["primitives"][0]["attributes"];
            attributes["JOINTS_0"] = joints.into();
            attributes["WEIGHTS_0"] = weights.into();
            attributes["NORMAL"] = normals.into();
            f["skins"] = json!([{ "joints": [1, 2], "inverseBindMatrices": inverse }]);
            // The joints place the mesh; the transform of its own node has no effect.
            let half = std::f32::consts::FRAC_1_SQRT_2;
            f["nodes"] = json!([
                { "mesh": 0, "skin": 0, "translation": [100, 0, 0] },
                { "translation": [0, 0, 5], "children": [2] },
                { "translation": [1, 0, 0], "rotation": [0, half, 0, half] },
            ]);
            f["scenes"][0]["nodes"] = json!([0, 1]);
        })
    };
    let scene = import(&file(1.0, 2), None).unwrap();
    assert!(scene.unrendered.is_empty(), "{:?}", scene.unrendered);
    let mesh = &scene.meshes[0];
    // Node 2 moves from (1, 0, 0) in the bind pose to (1, 0, 5), and rotates by 90 degrees about y.
    let bent = Vec3::new(1.0 + 0.0, 1.0, 5.0 - (0.0 - 1.0));
    let expected = [Vec3::new(0.0, 0.0, 5.0), Vec3::new(1.0, 0.0, 5.0), (Vec3::new(0.0, 1.0, 5.0) + bent) / 2.0];
    for (found, wanted) in mesh.corners(0).into_iter().zip(expected) {
        assert!(near(found, wanted), "{found} instead of {wanted}");
    }
    assert!(near(mesh.normals[0], Vec3::Z) && near(mesh.normals[1], Vec3::X), "{:?}", mesh.normals);
    // If the joints mirror the mesh, its front still faces along the normals.
    let mut mirrored: Value = serde_json::from_slice(&file(1.0, 2)).unwrap();
    mirrored["nodes"][1]["scale"] = json!([-1, 1, 1]);
    let mesh = &import(mirrored.to_string().as_bytes(), None).unwrap().meshes[0];
    let [a, b, c] = mesh.corners(0);
    assert!((b - a).cross(c - a).dot(mesh.normals[0]) > 0.0, "{:?} {:?}", mesh.triangles, mesh.normals);
    // Read the file with the millimetre as its unit.
    let scaled = super::super::import(&file(1.0, 2), None, Options { unit: 0.001, ..Options::default() }).unwrap();
    assert!(near(scaled.meshes[0].corners(0)[1] * 1000.0, expected[1]));
    for (joint, matrices, message) in [(2.0, 2, "joint 2"), (1.0, 1, "1 inverse bind matrices")] {
        let error = import(&file(joint, matrices), None).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains(message), "{error}");
    }
}

#[test]
fn morph_targets_are_mixed_by_their_weights() {
    let file = |node: Value, mesh: Value, count: usize| {
        triangle_file(|f| {
            let up = add_floats(f, "VEC3", count, &[0.0, 0.0, 2.0].repeat(count));
            let right = add_floats(f, "VEC3", 3, &[4.0, 0.0, 0.0].repeat(3));
            let normals = add_floats(f, "VEC3", 3, &[0.0, 0.0, 1.0].repeat(3));
            let primitive = &mut f["meshes"][0]["primitives"][0];
            primitive["attributes"]["NORMAL"] = normals.into();
            primitive["targets"] = json!([{ "POSITION": up }, { "POSITION": right, "NORMAL": right }]);
            f["nodes"][0]["weights"] = node;
            f["meshes"][0]["weights"] = mesh;
        })
    };
    let read = |node: Value, mesh: Value| {
        let scene = import(&file(node, mesh, 3), None).unwrap();
        assert!(scene.unrendered.is_empty());
        (scene.meshes[0].positions[0], scene.meshes[0].normals[0])
    };
    assert_eq!(read(Value::Null, Value::Null), (Vec3::ZERO, Vec3::Z));
    assert_eq!(read(Value::Null, json!([0.5, 0])), (Vec3::Z, Vec3::Z));
    // The weights of a node override the weights of its mesh.
    let (position, normal) = read(json!([0, 0.25]), json!([0.5, 0]));
    assert!(near(position, Vec3::X) && near(normal, Vec3::new(1.0, 0.0, 1.0).normalize()), "{position} {normal}");
    let error = import(&file(json!([1, 0]), Value::Null, 2), None).unwrap_err();
    assert!(error.message.contains("2 values for 3 vertices"), "{error}");
    // A small file may ask for many morph targets of one large array.
    let bomb = triangle_file(|f| {
        let accessor = json!({ "componentType": 5126, "count": 1 << 20, "type": "VEC3" });
        f["accessors"].as_array_mut().unwrap().push(accessor);
        f["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(2);
        f["meshes"][0]["primitives"][0]["targets"] = json!(vec![json!({ "POSITION": 2 }); 64]);
        f["meshes"][0]["weights"] = json!(vec![1; 64]);
    });
    let error = import(&bomb, None).unwrap_err();
    assert!(error.kind == ErrorKind::Unsupported && error.message.contains("morph target"), "{error}");
}

#[test]
fn one_colour_of_all_vertices_becomes_part_of_the_material() {
    let with = |colours: &[f32], kind: &str| {
        let file = triangle_file(|f| {
            f["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorFactor": [0.5, 1, 1, 1] } }]);
            f["meshes"][0]["primitives"][0]["material"] = json!(0);
            let accessor = add_floats(f, kind, 3, colours);
            f["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor.into();
            // A second node shows the same mesh: both must share the material that includes the vertex colour.
            f["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0 }]);
            f["scenes"][0]["nodes"] = json!([0, 1]);
        });
        import(&file, None).unwrap()
    };
    let scene = with(&[0.5, 0.25, 1.0, 0.5].repeat(3), "VEC4");
    assert_eq!((scene.materials.len(), scene.meshes[0].material, scene.meshes[1].material), (2, 1, 1));
    assert_eq!((scene.materials[1].base_color, scene.materials[1].alpha), (Vec3::new(0.25, 0.25, 1.0), 0.5));
    assert_eq!(scene.materials[0].base_color, Vec3::new(0.5, 1.0, 1.0));
    assert!(scene.unrendered.is_empty());
    assert!(scene.meshes[0].colours.is_empty());
    // Colours above white are white, which changes no material.
    let scene = with(&[2.0, 1.0, 1.5, 1.0, 1.0, 1.0, 3.0, 1.0, 2.0], "VEC3");
    assert_eq!((scene.materials.len(), scene.meshes[0].material), (1, 0));
    assert!(scene.meshes[0].colours.is_empty());
    // Colours that differ between vertices stay with the vertices, and survive an export and import.
    let scene = with(&[1.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 1.0], "VEC3");
    assert_eq!((scene.materials.len(), scene.meshes[0].material, scene.unrendered.len()), (1, 0, 0));
    let colours = [[1.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 1.0], [0.0, 0.0, 1.0, 1.0]].map(glam::Vec4::from);
    assert_eq!(scene.meshes[1].colours, colours);
    assert_eq!(import(&export(&scene).unwrap(), None).unwrap().meshes[1].colours, colours);
}

#[test]
fn a_webp_texture_is_read() {
    // A lossless WebP of one pixel of the colour (255, 0, 0).
    let mut file = Vec::new();
    let encoder = image::codecs::webp::WebPEncoder::new_lossless(&mut file);
    encoder.encode(&[255, 0, 0], 1, 1, image::ExtendedColorType::Rgb8).unwrap();
    let folder = std::env::temp_dir().join(format!("luxfer-webp-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("red.webp"), file).unwrap();
    let gltf = triangle_file(|f| {
        f["extensionsRequired"] = json!(["EXT_texture_webp"]);
        f["images"] = json!([{ "uri": "absent.png" }, { "uri": "red.webp" }]);
        f["textures"] = json!([{ "source": 0, "extensions": { "EXT_texture_webp": { "source": 1 } } }]);
        f["materials"] = json!([{ "pbrMetallicRoughness": { "baseColorTexture": { "index": 0 } } }]);
    });
    let scene = import(&gltf, Some(&folder)).unwrap();
    std::fs::remove_dir_all(&folder).unwrap();
    assert_eq!((scene.textures.len(), scene.unrendered.len()), (1, 0));
    assert_eq!(scene.textures[0].image.data, [1.0, 0.0, 0.0]);
}

#[test]
fn files_outside_the_folder_need_leave() {
    let folder = std::env::temp_dir().join(format!("luxfer-outside-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("scene")).unwrap();
    let bytes: Vec<u8> = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    std::fs::write(folder.join("mesh.bin"), [&bytes[..], &[0, 1, 2, 0]].concat()).unwrap();
    let read = |uri: &str, is_open: bool| {
        let file = triangle_file(|f| f["buffers"][0]["uri"] = uri.into());
        super::super::import(&file, Some(&folder.join("scene")), Options { is_open, ..Options::default() })
    };
    let absolute = folder.join("mesh.bin").to_str().unwrap().to_string();
    for uri in ["../mesh.bin", "a/../../mesh.bin", absolute.as_str()] {
        let error = read(uri, false).unwrap_err();
        assert!(error.kind == ErrorKind::Unsupported && error.message.contains("outside the folder"), "{error}");
    }
    for uri in ["../mesh.bin", absolute.as_str()] {
        assert_eq!(read(uri, true).unwrap().meshes[0].corners(0), [Vec3::ZERO, Vec3::X, Vec3::Y], "{uri}");
    }
    // URIs with a scheme, even `file:`, and paths with backslashes are refused.
    for uri in ["https://example.org/mesh.bin", "file:///mesh.bin", "..\\mesh.bin"] {
        assert_eq!(read(uri, true).unwrap_err().kind, ErrorKind::Unsupported, "{uri}");
    }
    assert_eq!(read("../absent.bin", true).unwrap_err().kind, ErrorKind::Io);
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn lengths_are_converted_to_metres() {
    let file = triangle_file(|f| {
        f["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 1, "znear": 0.1 } }]);
        f["nodes"] = json!([{ "mesh": 0, "translation": [1000, 0, 0], "camera": 0 }]);
    });
    let scene = super::super::import(&file, None, Options { unit: 0.001, ..Options::default() }).unwrap();
    assert!(near(scene.meshes[0].positions[1], Vec3::new(1.001, 0.0, 0.0)));
    assert!(near(scene.cameras[0].position, Vec3::X) && near(scene.cameras[0].forward, Vec3::NEG_Z));
}
