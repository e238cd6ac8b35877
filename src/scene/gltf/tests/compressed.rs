//! Tests of compressed geometry: primitives in Draco streams, and buffer views of meshoptimizer.

use super::features::add_floats;
use super::*;
use draco_core::{
    DataType, EncoderBuffer, EncoderOptions, GeometryAttributeType, MeshEncoder, PointAttribute, PointIndex,
};
use meshoptimizer_rs::Workspace;
use meshoptimizer_rs::codec::{
    IndexEncoding, VertexEncoding, encode_index_buffer, encode_index_sequence, encode_vertex_buffer,
};

/// Number of vertices along each side of the test grid.
const SIDE: usize = 12;

/// Positions, texture coordinates and triangles of a wavy grid. All numbers are multiples of 1/128, so that no codec
/// rounds them.
fn grid() -> (Vec<[f32; 3]>, Vec<[f32; 2]>, Vec<[u32; 3]>) {
    let vertex = |i: usize| (i % SIDE, i / SIDE);
    let positions = (0..SIDE * SIDE).map(|i| {
        let (x, y) = vertex(i);
        [x as f32 / 4.0, (x * x + 3 * y) as f32 / 128.0, y as f32 / 2.0]
    });
    let uvs = (0..SIDE * SIDE).map(|i| [vertex(i).0 as f32 / 16.0, vertex(i).1 as f32 / 16.0]);
    let cells = (0..(SIDE - 1) * SIDE).filter(|i| i % SIDE < SIDE - 1);
    let triangles = cells.flat_map(|i| {
        let (i, below) = (i as u32, (i + SIDE) as u32);
        [[i, i + 1, below], [i + 1, below + 1, below]]
    });
    (positions.collect(), uvs.collect(), triangles.collect())
}

fn flat<const N: usize>(values: &[[f32; N]]) -> Vec<f32> {
    values.iter().flatten().copied().collect()
}

/// A Draco stream of the grid without quantisation: positions as attribute 0, texture coordinates as attribute 1.
fn draco(method: i32) -> Vec<u8> {
    let (positions, uvs, triangles) = grid();
    let mut mesh = draco_core::Mesh::new();
    for (kind, components, values) in
        [(GeometryAttributeType::Position, 3, flat(&positions)), (GeometryAttributeType::TexCoord, 2, flat(&uvs))]
    {
        let mut attribute = PointAttribute::new();
        attribute.init(kind, components, DataType::Float32, false, positions.len());
        attribute.buffer_mut().update_f32s_le(0, &values);
        mesh.add_attribute(attribute);
    }
    mesh.set_num_points(positions.len());
    triangles.iter().for_each(|t| mesh.add_face(t.map(PointIndex)));
    let mut options = EncoderOptions::new();
    options.set_encoding_method(method);
    let (mut encoder, mut out) = (MeshEncoder::new(), EncoderBuffer::new());
    encoder.set_mesh(mesh);
    encoder.encode(&options, &mut out).unwrap();
    out.data().to_vec()
}

/// Adds a buffer and a buffer view that covers it; returns the index of the view.
fn add_view(file: &mut Value, bytes: &[u8]) -> usize {
    let padded =
        bytes.iter().copied().chain(std::iter::repeat_n(0, bytes.len().wrapping_neg() % 4)).collect::<Vec<_>>();
    let words = padded.chunks_exact(4).map(|b| f32::from_le_bytes(b.try_into().unwrap())).collect::<Vec<_>>();
    let accessor = add_floats(file, "SCALAR", words.len(), &words);
    let view = file["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
    file["bufferViews"][view]["byteLength"] = bytes.len().into();
    view
}

/// A file whose primitive is in a Draco stream, changed by `edit`.
fn draco_file(stream: &[u8], edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let (positions, _, triangles) = grid();
    triangle_file(|f| {
        let view = add_view(f, stream);
        let accessor =
            |kind: &str, code: u32, count: usize| json!({ "componentType": code, "count": count, "type": kind });
        f["accessors"] = json!([
            accessor("VEC3", 5126, positions.len()),
            accessor("SCALAR", 5123, 3 * triangles.len()),
            accessor("VEC2", 5126, positions.len()),
        ]);
        let settings = json!({ "bufferView": view, "attributes": { "POSITION": 0, "TEXCOORD_0": 1 } });
        f["meshes"][0]["primitives"][0] = json!({
            "attributes": { "POSITION": 0, "TEXCOORD_0": 2 }, "indices": 1,
            "extensions": { "KHR_draco_mesh_compression": settings },
        });
        f["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
        edit(f);
    })
}

/// Describes each triangle by the positions and texture coordinates of its corners, and sorts the descriptions. Two
/// meshes have equal results if they differ only in the order of triangles, or in the corner with which each triangle
/// begins.
fn soup(mesh: &Mesh) -> Vec<String> {
    let corner = |&i: &u32| format!("{:?} {:?}", mesh.positions[i as usize], mesh.uvs[0][i as usize]);
    let triangle = |t: &[u32; 3]| {
        let corners = t.iter().map(corner).collect::<Vec<_>>();
        let first = (0..3).min_by_key(|&i| corners[i].clone()).unwrap();
        (0..3).map(|i| corners[(first + i) % 3].clone()).collect::<Vec<_>>().join("; ")
    };
    let mut all = mesh.triangles.iter().map(triangle).collect::<Vec<_>>();
    all.sort();
    all
}

fn expected() -> Vec<String> {
    let (positions, uvs, triangles) = grid();
    let positions = positions.into_iter().map(Vec3::from).collect();
    soup(&Mesh {
        positions,
        uvs: [uvs.into_iter().map(Vec2::from).collect(), Vec::new()],
        triangles,
        ..Mesh::default()
    })
}

#[test]
fn draco_streams_are_decoded() {
    for method in [0, 1] {
        let scene = import(&draco_file(&draco(method), |_| ()), None).unwrap();
        assert!(scene.unrendered.is_empty(), "{:?}", scene.unrendered);
        assert_eq!(soup(&scene.meshes[0]), expected(), "method {method}");
    }
}

#[test]
fn defects_of_draco_streams_are_errors() {
    let stream = draco(1);
    type Edit = fn(&mut Value);
    let settings = "/meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
    let cases: [(&str, Edit); 6] = [
        ("KHR_draco_mesh_compression", |f| f["accessors"][0]["count"] = json!(5)),
        ("vertices", |f| f["accessors"][0]["count"] = json!(SIDE * SIDE + 1)),
        ("KHR_draco_mesh_compression", |f| f["accessors"][1]["count"] = json!(3)),
        ("names no buffer view", |f| {
            f["meshes"][0]["primitives"][0]["extensions"] = json!({ "KHR_draco_mesh_compression": {} })
        }),
        ("components", |f| {
            let swapped = json!({ "POSITION": 1, "TEXCOORD_0": 0 });
            f["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"] = swapped;
        }),
        ("attribute 7", |f| {
            f["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]["POSITION"] =
                json!(7);
        }),
    ];
    for (message, edit) in cases {
        let error = import(&draco_file(&stream, edit), None).map(|_| ()).expect_err(message);
        assert!(error.kind == ErrorKind::Format && error.message.contains(message), "{message}: {error}");
    }
    // If the accessors also hold the data uncompressed, the stream is not decoded.
    let plain = draco_file(&stream[..8], |f| {
        let (positions, uvs, triangles) = grid();
        *f.pointer_mut(settings).unwrap() = json!({ "bufferView": 0, "attributes": {} });
        let positions = add_floats(f, "VEC3", positions.len(), &flat(&positions));
        let uvs = add_floats(f, "VEC2", SIDE * SIDE, &flat(&uvs));
        let indices = triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect::<Vec<_>>();
        let view = add_view(f, &indices);
        f["accessors"][1] =
            json!({ "bufferView": view, "componentType": 5125, "count": 3 * triangles.len(), "type": "SCALAR" });
        f["meshes"][0]["primitives"][0]["attributes"] = json!({ "POSITION": positions, "TEXCOORD_0": uvs });
    });
    assert_eq!(soup(&import(&plain, None).unwrap().meshes[0]), expected());
    // A corrupt stream gives a valid scene or an error.
    for round in 0..3000u64 {
        let mut rng = Rng::new(7, &[round]);
        let mut broken = stream.clone();
        for _ in 0..=rng.below(4) {
            let at = rng.below(broken.len());
            broken[at] = rng.next_u32() as u8;
        }
        broken.truncate(if rng.below(4) == 0 { rng.below(broken.len()) } else { broken.len() });
        if let Ok(scene) = import(&draco_file(&broken, |_| ()), None) {
            assert_eq!(scene.validate(), Ok(()));
        }
    }
}

/// A file whose vertex attributes and indices are in compressed buffer views of meshoptimizer.
fn meshopt_file(sequence: bool, edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let (positions, uvs, triangles) = grid();
    let (version, mut workspace) = (VertexEncoding::new(0, 2).unwrap(), Workspace::default());
    let mut pack = |values: Vec<f32>, stride: usize| {
        let bytes = values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<_>>();
        encode_vertex_buffer(&bytes, SIDE * SIDE, stride, version, &mut workspace).unwrap()
    };
    let (positions, uvs) = (pack(flat(&positions), 12), pack(flat(&uvs), 8));
    let indices = triangles.iter().flatten().copied().collect::<Vec<_>>();
    let packed = if sequence {
        encode_index_sequence(&indices, IndexEncoding::DEFAULT, &mut workspace).unwrap()
    } else {
        encode_index_buffer(&indices, IndexEncoding::DEFAULT, &mut workspace).unwrap()
    };
    triangle_file(|f| {
        let mut add = |stream: &[u8], mode: &str, count: usize, stride: usize| {
            let stored = add_view(f, stream);
            let buffer = f["bufferViews"][stored]["buffer"].clone();
            let settings = json!({
                "buffer": buffer, "byteLength": stream.len(), "byteStride": stride, "count": count, "mode": mode,
            });
            // Buffer 1 does not exist yet: the fallback buffer is added below, and its index replaces the 1.
            let view = json!({ "buffer": 1, "byteLength": count * stride, "extensions": { "EXT_meshopt_compression": settings } });
            let views = f["bufferViews"].as_array_mut().unwrap();
            views.push(view);
            views.len() - 1
        };
        let mode = if sequence { "INDICES" } else { "TRIANGLES" };
        let (positions, uvs) =
            (add(&positions, "ATTRIBUTES", SIDE * SIDE, 12), add(&uvs, "ATTRIBUTES", SIDE * SIDE, 8));
        let indices_view = add(&packed, mode, indices.len(), 4);
        // Add the fallback buffer, which has no data, and let the compressed views refer to it.
        let length = SIDE * SIDE * 20 + 4 * indices.len();
        let fallback =
            json!({ "byteLength": length, "extensions": { "EXT_meshopt_compression": { "fallback": true } } });
        let buffers = f["buffers"].as_array_mut().unwrap();
        buffers.push(fallback);
        let last = buffers.len() - 1;
        for view in [positions, uvs, indices_view] {
            f["bufferViews"][view]["buffer"] = last.into();
        }
        f["accessors"] = json!([
            { "bufferView": positions, "componentType": 5126, "count": SIDE * SIDE, "type": "VEC3" },
            { "bufferView": indices_view, "componentType": 5125, "count": indices.len(), "type": "SCALAR" },
            { "bufferView": uvs, "componentType": 5126, "count": SIDE * SIDE, "type": "VEC2" },
        ]);
        f["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = json!(2);
        f["extensionsRequired"] = json!(["EXT_meshopt_compression"]);
        edit(f);
    })
}

#[test]
fn buffer_views_of_meshoptimizer_are_decoded() {
    for sequence in [false, true] {
        let scene = import(&meshopt_file(sequence, |_| ()), None).unwrap();
        assert!(scene.unrendered.is_empty(), "{:?}", scene.unrendered);
        assert_eq!(soup(&scene.meshes[0]), expected(), "sequence {sequence}");
        // Read the same file with the name of the Khronos extension.
        let file = String::from_utf8(meshopt_file(sequence, |_| ())).unwrap();
        let scene = import(file.replace("EXT_meshopt", "KHR_meshopt").as_bytes(), None).unwrap();
        assert!(scene.unrendered.is_empty(), "{:?}", scene.unrendered);
        assert_eq!(soup(&scene.meshes[0]), expected(), "sequence {sequence}");
    }
}

#[test]
fn defects_of_meshoptimizer_views_are_errors() {
    /// Returns the compression settings of the buffer view of the positions.
    fn settings(file: &mut Value) -> &mut Value {
        let view = file["accessors"][0]["bufferView"].as_u64().unwrap() as usize;
        &mut file["bufferViews"][view]["extensions"]["EXT_meshopt_compression"]
    }
    type Edit = fn(&mut Value);
    let cases: [(&str, Edit); 7] = [
        ("its mode is \"ZIP\"", |f| settings(f)["mode"] = json!("ZIP")),
        ("its filter is \"BLUR\"", |f| settings(f)["filter"] = json!("BLUR")),
        ("layout", |f| settings(f)["byteStride"] = json!(10)),
        ("buffer view", |f| settings(f)["count"] = json!(5)),
        ("has no byteLength", |f| {
            settings(f).as_object_mut().unwrap().remove("byteLength");
        }),
        ("covers", |f| settings(f)["byteOffset"] = json!(1_000_000)),
        ("cannot be in a stream", |f| {
            settings(f)["count"] = json!(1 << 24);
            let view = f["accessors"][0]["bufferView"].as_u64().unwrap() as usize;
            f["bufferViews"][view]["byteLength"] = json!(12 << 24);
        }),
    ];
    for (message, edit) in cases {
        let error = import(&meshopt_file(false, edit), None).unwrap_err();
        assert!(error.kind == ErrorKind::Format && error.message.contains(message), "{message}: {error}");
        assert!(error.message.contains("buffer view"), "{error}");
    }
}
