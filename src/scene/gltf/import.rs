//! Converts the nodes, meshes, cameras and lights of a parsed glTF file to a [`Scene`] in world space.

use super::container::{File, Folder, missing};
use super::features::{IES, IS_POINT, READ};
use super::instances::{instances, local_transform};
use super::material::Materials;
use super::nodes::roots;
use super::origin::origin;
use super::pose::{self, Skinning, mixed};
use super::vertices::Vertices;
use super::{Budget, Options, accessor};
use crate::error::{Error, ErrorKind, Result};
use crate::image::{try_collect, try_vec};
use crate::photometry::{Luminaire, ies};
use crate::scene::{Camera, Material, Mesh, PunctualLight, Scene};
use glam::{DMat3, DMat4, DVec3, Vec2, Vec3, Vec4};
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::skin::Skin;
use gltf::json::validation::Checked;
use gltf::json::{self, Index};
use serde_json::Value;
use std::f32::consts::FRAC_PI_2;
use std::path::Path;
use std::sync::Arc;

/// Maximum number of vertices, and of triangles, of all meshes together. Every instance of a mesh counts, and each
/// morph target counts as a further copy of the mesh's vertices.
const MAX_ELEMENTS: u64 = 1 << 26;

/// Maximum number of meshes of a scene. Each primitive of each instance of a node becomes a mesh.
const MAX_MESHES: usize = 1 << 20;

/// Reads a GLB or glTF file held in memory. External files are resolved relative to the folder `base`.
///
/// Errors: `Format` for broken, truncated or inconsistent files, `Unsupported` for features that this library lacks,
/// `Io` for unreadable external files, and any error that the budget returns.
pub fn import(bytes: &[u8], base: Option<&Path>, options: Options) -> Result<Scene> {
    let mut file = File::parse(bytes, Folder { path: base, is_open: options.is_open })?;
    if let Some(unknown) = file.root.extensions_required.iter().find(|e| !READ.contains(&e.as_str())) {
        let message = format!("the file requires the extension {unknown}; save it without that extension");
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    // Decode the compressed buffer views; the memory for them is needed only until the scene is converted.
    let mut scene = None;
    options.budget.lend(file.packed_bytes()?, &mut || {
        file.unpack()?;
        scene = Some(convert(&mut file, options)?);
        Ok(())
    })?;
    scene.ok_or_else(|| Error::new(ErrorKind::Internal, "the budget ran no work"))
}

fn convert(file: &mut File, Options { budget, unit, keep_origin, point_luminaires, .. }: Options) -> Result<Scene> {
    let mut scene = Scene { unrendered: std::mem::take(&mut file.unrendered), ..Scene::default() };
    let file = &*file;
    let mut materials = Materials::new(file, budget);
    for (i, json) in file.root.materials.iter().enumerate() {
        scene.materials.push(materials.read(i, json).map_err(|e| e.context(format_args!("material {i}")))?);
    }
    scene.textures = materials.textures;
    let mut importer = Importer {
        file,
        budget,
        scene,
        default_material: None,
        tinted: Vec::new(),
        profiles: Vec::new(),
        point_luminaires,
        nodes: Vec::new(),
        vertices: 0,
        triangles: 0,
    };
    let mut world = DMat4::from_scale(DVec3::splat(unit));
    if !keep_origin {
        let origin = origin(file, world)?;
        importer.scene.origin = origin;
        world = DMat4::from_translation(-origin) * world;
    }
    if !file.root.skins.is_empty() {
        importer.nodes = pose::node_transforms(file, world)?;
    }
    importer.nodes(world)?;
    let scene = importer.scene;
    scene.validate().map_err(|e| Error { kind: ErrorKind::Format, ..e })?;
    Ok(scene)
}

struct Importer<'a> {
    file: &'a File<'a>,
    budget: &'a dyn Budget,
    scene: Scene,
    /// Index of the default material, which is created for the first primitive without a material.
    default_material: Option<usize>,
    /// Copies of materials multiplied by a vertex colour: index of the original, the colour, and index of the copy.
    tinted: Vec<(usize, Vec4, usize)>,
    /// Indices in the file of the IES profiles read so far. Profile `profiles[i]` is distribution `i` of the scene.
    profiles: Vec<usize>,
    /// Whether `is_point` is set for all luminaires, even for luminaires whose files state a luminous size.
    point_luminaires: bool,
    /// The world transform of each node; `None` for a node in or below a cycle of nodes. The list is empty if the file
    /// has no skins, because only the joints of skins need it.
    nodes: Vec<Option<DMat4>>,
    vertices: u64,
    triangles: u64,
}

/// The transform and the pose of a node's mesh.
#[derive(Clone, Copy)]
struct Placement<'a> {
    transform: DMat4,
    /// The skin; `None` for a mesh without a skin. The transforms of the skin's joints replace `transform`.
    skin: Option<Index<Skin>>,
    /// Weights of the mesh's morph targets.
    weights: &'a [f32],
}

/// The vertices of a primitive in world space, after morph targets and skinning.
struct Posed {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    is_mirrored: bool,
}

impl Importer<'_> {
    /// Imports every node of the default scene, parents before children, in file order. An error if a node is reached
    /// twice.
    fn nodes(&mut self, world: DMat4) -> Result<()> {
        let file = self.file;
        let mut visited = try_vec(file.root.nodes.len(), false)?;
        let mut stack: Vec<(usize, DMat4)> = roots(file)?.into_iter().rev().map(|root| (root, world)).collect();
        while let Some((index, parent)) = stack.pop() {
            let node = file.root.nodes.get(index).ok_or_else(|| missing("node", index, file.root.nodes.len()))?;
            if std::mem::replace(&mut visited[index], true) {
                return Err(Error::format(format!("node {index} is reached twice: the nodes must form a tree")));
            }
            let transform = parent * local_transform(file, index, node);
            if !transform.is_finite() {
                return Err(Error::format(format!("node {index} has a transform that is not finite")));
            }
            self.node(node, transform).map_err(|e| e.context(format_args!("node {index}")))?;
            for child in node.children.iter().flatten().rev() {
                stack.push((child.value(), transform));
            }
        }
        Ok(())
    }

    fn node(&mut self, node: &json::Node, transform: DMat4) -> Result<()> {
        let root = &self.file.root;
        let name = node.name.as_ref().filter(|n| !n.is_empty());
        if let Some(index) = node.mesh {
            let mesh = root.get(index).ok_or_else(|| missing("mesh", index.value(), root.meshes.len()))?;
            let own_name = mesh.name.as_ref().filter(|n| !n.is_empty());
            let name = name.or(own_name).cloned().unwrap_or_else(|| format!("Mesh {}", index.value()));
            let weights = node.weights.as_ref().or(mesh.weights.as_ref()).map_or(&[][..], Vec::as_slice);
            for transform in instances(self.file, node, transform)? {
                let placement = Placement { transform, skin: node.skin, weights };
                for primitive in &mesh.primitives {
                    self.primitive(&name, primitive, placement)
                        .map_err(|e| e.context(format_args!("mesh {name:?}")))?;
                }
            }
        }
        if let Some(index) = node.camera {
            let camera = root.get(index).ok_or_else(|| missing("camera", index.value(), root.cameras.len()))?;
            let name = name.or(camera.name.as_ref()).cloned().unwrap_or_else(|| format!("Camera {}", index.value()));
            self.camera(name, camera, transform)?;
        }
        if let Some(reference) = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) {
            let lights = root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
            let lights = lights.map_or(&[][..], |l| &l.lights);
            let at = reference.light.value();
            let light = lights.get(at).ok_or_else(|| missing("light", at, lights.len()))?;
            self.scene.lights.push(punctual(light, transform).map_err(|e| e.context(format_args!("light {at}")))?);
        }
        if let Some(reference) = node.extensions.as_ref().and_then(|e| e.others.get(IES)) {
            self.luminaire(reference, transform).map_err(|e| e.context(IES))?;
        }
        Ok(())
    }

    /// Adds a luminaire. In the coordinates of its node, the luminaire's axis is -z and its direction C = 0 is +x. Each
    /// IES profile is read only once.
    fn luminaire(&mut self, reference: &Value, transform: DMat4) -> Result<()> {
        let extensions = self.file.root.extensions.as_ref();
        let profiles =
            extensions.and_then(|e| e.others.get(IES)?.get("lights")?.as_array()).map_or(&[][..], Vec::as_slice);
        let number = |key: &str| reference.get(key).and_then(Value::as_u64).and_then(|n| usize::try_from(n).ok());
        let at = number("light").ok_or_else(|| Error::format("its node names no light"))?;
        let profile = profiles.get(at).ok_or_else(|| missing("light", at, profiles.len()))?;
        let distribution = match self.profiles.iter().position(|p| *p == at) {
            Some(known) => known,
            None => {
                let luminaire = self.profile(profile).map_err(|e| e.context(format_args!("light {at}")))?;
                self.scene.distributions.push(Arc::new(luminaire));
                self.profiles.push(at);
                self.profiles.len() - 1
            }
        };
        let multiplier = reference.get("multiplier").and_then(Value::as_f64).unwrap_or(1.0) as f32;
        let channel = |c: usize| reference.get("color").and_then(|v| v.get(c)?.as_f64()).unwrap_or(1.0) as f32;
        let axes = [DVec3::NEG_Z, DVec3::X].map(|axis| transform.transform_vector3(axis).normalize_or_zero());
        // Make `c0` perpendicular to the axis again: a node with shear destroys the right angle.
        let c0 = (axes[1] - axes[0] * axes[0].dot(axes[1])).normalize_or_zero();
        if axes[0] == DVec3::ZERO || c0 == DVec3::ZERO {
            return Err(Error::format("its node is scaled to zero"));
        }
        self.scene.lights.push(PunctualLight::Luminaire {
            position: transform.w_axis.truncate().as_vec3(),
            axis: axes[0].as_vec3(),
            c0: c0.as_vec3(),
            colour: multiplier * Vec3::from_array(std::array::from_fn(channel)),
            distribution,
            is_point: self.point_luminaires || reference.get(IS_POINT) == Some(&Value::Bool(true)),
        });
        Ok(())
    }

    fn profile(&self, profile: &Value) -> Result<Luminaire> {
        let view = profile.get("bufferView").and_then(Value::as_u64).and_then(|n| u32::try_from(n).ok());
        match (profile.get("uri").and_then(Value::as_str), view) {
            (Some(uri), _) => ies::read(&self.file.resolve(uri)?),
            (None, Some(view)) => ies::read(self.file.view(Index::new(view))?),
            (None, None) => Err(Error::format("it names no file")),
        }
    }

    fn primitive(&mut self, name: &str, primitive: &Primitive, placement: Placement) -> Result<()> {
        let Checked::Valid(mode) = primitive.mode else {
            return Err(Error::format("a primitive's mode is unknown"));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).copied();
        let positions = attribute(Semantic::Positions).ok_or_else(|| Error::format("a primitive has no POSITION"))?;
        let extras = [(Semantic::Normals, 12), (Semantic::TexCoords(0), 8), (Semantic::TexCoords(1), 8)];
        let extras = extras.into_iter().filter_map(|(semantic, bytes)| attribute(semantic).map(|_| bytes));
        let targets = mixed(primitive, placement.weights);
        self.reserve(positions, 12 + extras.sum::<u64>(), targets.count(), primitive.indices, mode)?;

        let vertices = Vertices::new(self.file, self.budget, primitive)?;
        let Posed { mut positions, mut normals, is_mirrored } = self.pose(&vertices, primitive, placement)?;
        let count = positions.len();
        let uvs = texture_coordinates(&vertices, count)?;
        let triangles = triangles(&vertices, mode, count, is_mirrored)?;
        if !normals.is_empty() {
            mend_normals(&positions, &mut normals, &triangles)?;
        }
        let material = match primitive.material {
            Some(index) if index.value() < self.file.root.materials.len() => index.value(),
            Some(index) => return Err(missing("material", index.value(), self.file.root.materials.len())),
            None => self.default_material(),
        };
        let (material, colours) = match vertices.colours(count)? {
            Some(colours) => self.tint(material, colours)?,
            None => (material, Vec::new()),
        };
        positions.shrink_to_fit();
        self.scene.meshes.push(Mesh { name: name.into(), material, positions, normals, uvs, colours, triangles });
        Ok(())
    }

    /// Reads positions and normals, applies morph targets and the skin, and transforms positions and normals to world
    /// space.
    fn pose(&self, vertices: &Vertices, primitive: &Primitive, placement: Placement) -> Result<Posed> {
        let targets = mixed(primitive, placement.weights);
        let mut positions = vertices.vectors(&Semantic::Positions)?.unwrap_or_default();
        let count = positions.len();
        pose::mix(self.file, targets.clone(), |target| target.positions, &mut positions)?;
        let skinning = match placement.skin {
            Some(skin) => Skinning::read(self.file, vertices, skin, &self.nodes, count)?,
            None => None,
        };
        let whole = placement.transform;
        let point = |transform: DMat4, p| transform.transform_point3(Vec3::from(p).as_dvec3()).as_vec3();
        let positions = match &skinning {
            Some(skinning) => map_indexed(positions, |i, p| point(skinning.transform(i), p))?,
            None => map_indexed(positions, |_, p| point(whole, p))?,
        };

        // A reflection reverses the winding of the triangles and negates the result of `cofactor`. The function
        // `triangles` restores the winding, and the factor `side` restores the sign.
        let is_mirrored =
            skinning.as_ref().map_or_else(|| whole.determinant() < 0.0, |skinning| skinning.is_mirrored(count));
        let side = if is_mirrored { -1.0 } else { 1.0 };
        let normal = |turn: DMat3, n| (turn * Vec3::from(n).as_dvec3() * side).normalize_or_zero().as_vec3();
        let normals = match vertices.checked(&Semantic::Normals, count)? {
            Some(mut normals) => {
                pose::mix(self.file, targets, |target| target.normals, &mut normals)?;
                let turn = cofactor(whole);
                match &skinning {
                    Some(skinning) => map_indexed(normals, |i, n| normal(cofactor(skinning.transform(i)), n))?,
                    None => map_indexed(normals, |_, n| normal(turn, n))?,
                }
            }
            None => Vec::new(),
        };
        Ok(Posed { positions, normals, is_mirrored })
    }

    /// Adds the vertices and triangles of a primitive, including its morph targets, to the totals of the scene. Returns
    /// an error if a total exceeds its limit. Call it before the primitive's memory is allocated: with instances, a
    /// small file can produce huge meshes.
    fn reserve(
        &mut self,
        positions: Index<json::Accessor>,
        vertex_bytes: u64,
        targets: usize,
        indices: Option<Index<json::Accessor>>,
        mode: Mode,
    ) -> Result<()> {
        let vertices = accessor::count(self.file, positions)?;
        let corners = indices.map_or(Ok(vertices), |index| accessor::count(self.file, index))?;
        let triangles = if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) };
        if self.scene.meshes.len() >= MAX_MESHES {
            let message = format!("the file has more than {MAX_MESHES} meshes, counting every instance");
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let read = vertices.saturating_mul(1 + targets as u64);
        self.vertices = self.vertices.saturating_add(read);
        self.triangles = self.triangles.saturating_add(triangles);
        if self.vertices.max(self.triangles) <= MAX_ELEMENTS {
            return self.budget.keep(vertices * vertex_bytes + 12 * triangles);
        }
        Err(Error::new(
            ErrorKind::Unsupported,
            format!(
                "the file has more than {MAX_ELEMENTS} vertices or triangles, counting every instance and morph target"
            ),
        ))
    }

    fn default_material(&mut self) -> usize {
        let materials = &mut self.scene.materials;
        *self.default_material.get_or_insert_with(|| {
            materials.push(Material { name: "Default".into(), ..Material::default() });
            materials.len() - 1
        })
    }

    /// Returns the material and the vertex colours of a primitive. If all vertices share one colour, there are no
    /// vertex colours, and the material is a copy multiplied by that colour (the original if the colour is white).
    /// Colours are clamped to `[0, 1]`.
    fn tint(&mut self, material: usize, colours: Vec<[f32; 4]>) -> Result<(usize, Vec<Vec4>)> {
        let clamped = |colour: [f32; 4]| Vec4::from(colour).clamp(Vec4::ZERO, Vec4::ONE);
        let Some((&first, rest)) = colours.split_first() else { return Ok((material, Vec::new())) };
        let colour = clamped(first);
        if rest.iter().any(|other| clamped(*other) != colour) {
            self.budget.keep(size_of_val(&colours[..]) as u64)?;
            return Ok((material, map_indexed(colours, |_, colour| clamped(colour))?));
        }
        if colour == Vec4::ONE {
            return Ok((material, Vec::new()));
        }
        if let Some((.., known)) = self.tinted.iter().find(|(of, tint, _)| (*of, *tint) == (material, colour)) {
            return Ok((*known, Vec::new()));
        }
        let plain = &self.scene.materials[material];
        let product = Material {
            base_color: plain.base_color * colour.truncate(),
            alpha: plain.alpha * colour.w,
            ..plain.clone()
        };
        self.scene.materials.push(product);
        let index = self.scene.materials.len() - 1;
        self.tinted.push((material, colour, index));
        Ok((index, Vec::new()))
    }

    fn camera(&mut self, name: String, camera: &json::Camera, transform: DMat4) -> Result<()> {
        let Some(perspective) = &camera.perspective else { return Ok(()) };
        let axis = |v: DVec3| {
            let axis = transform.transform_vector3(v).try_normalize();
            axis.ok_or_else(|| Error::format(format!("camera {name:?} is scaled to zero")))
        };
        let forward = axis(DVec3::NEG_Z)?;
        // Make `up` perpendicular to `forward` again: non-uniform scaling shears the axes.
        let up = axis(DVec3::Y)?;
        let up = (up - forward * forward.dot(up)).try_normalize();
        let up = up.ok_or_else(|| Error::format(format!("camera {name:?} has parallel axes")))?;
        self.scene.cameras.push(Camera {
            position: transform.w_axis.truncate().as_vec3(),
            forward: forward.as_vec3(),
            up: up.as_vec3(),
            fov_y: perspective.yfov,
            name,
        });
        Ok(())
    }
}

/// Reads both sets of texture coordinates of a primitive. A set that the primitive lacks is empty.
fn texture_coordinates(vertices: &Vertices, count: usize) -> Result<[Vec<Vec2>; 2]> {
    let mut uvs = [Vec::new(), Vec::new()];
    for (set, uv) in uvs.iter_mut().enumerate() {
        if let Some(read) = vertices.checked(&Semantic::TexCoords(set as u32), count)? {
            *uv = map_indexed(read, |_, uv: [f32; 2]| Vec2::from(uv))?;
        }
    }
    Ok(uvs)
}

/// Returns the triangles of a primitive: a list, strip or fan of triangles. If `is_mirrored`, their winding is
/// reversed.
fn triangles(vertices: &Vertices, mode: Mode, count: usize, is_mirrored: bool) -> Result<Vec<[u32; 3]>> {
    let (mode, indices) = vertices.indices(mode, count)?;
    if let Some(beyond) = indices.iter().find(|&&i| i as usize >= count) {
        return Err(Error::format(format!("an index is {beyond}, but there are {count} vertices")));
    }
    let mut triangles = triangulate(mode, &indices)?;
    if is_mirrored {
        triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    Ok(triangles)
}

/// Maps each value and its index to a new value; returns an error if memory is short.
fn map_indexed<T, U: Clone + Default>(values: Vec<T>, change: impl Fn(usize, T) -> U) -> Result<Vec<U>> {
    let mut out = try_vec(values.len(), U::default())?;
    out.iter_mut().zip(values).enumerate().for_each(|(i, (o, v))| *o = change(i, v));
    Ok(out)
}

/// Returns the matrix that transforms normals: the inverse transpose times the determinant. Unlike the inverse
/// transpose, this matrix stays finite if the transform scales an axis to 0.
fn cofactor(transform: DMat4) -> DMat3 {
    let linear = DMat3::from_mat4(transform);
    DMat3::from_cols(
        linear.y_axis.cross(linear.z_axis),
        linear.z_axis.cross(linear.x_axis),
        linear.x_axis.cross(linear.y_axis),
    )
}

fn triangulate(mode: Mode, indices: &[u32]) -> Result<Vec<[u32; 3]>> {
    let count = if mode == Mode::Triangles { indices.len() / 3 } else { indices.len().saturating_sub(2) };
    let mut triangles = try_vec(count, [0; 3])?;
    for (i, t) in triangles.iter_mut().enumerate() {
        *t = match mode {
            Mode::TriangleStrip => [indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]],
            Mode::TriangleFan => [indices[i + 1], indices[i + 2], indices[0]],
            _ => [indices[3 * i], indices[3 * i + 1], indices[3 * i + 2]],
        };
    }
    // Drop the degenerate triangles with which strips connect their parts.
    if mode != Mode::Triangles {
        triangles.retain(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]);
    }
    Ok(triangles)
}

/// Replaces each zero normal by the area-weighted mean normal of the faces at its vertex, or by +y if that mean is 0.
fn mend_normals(positions: &[Vec3], normals: &mut [Vec3], triangles: &[[u32; 3]]) -> Result<()> {
    if !normals.contains(&Vec3::ZERO) {
        return Ok(());
    }
    let broken = try_collect(normals.iter().map(|n| *n == Vec3::ZERO))?;
    for t in triangles {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        for &i in t.iter().filter(|&&i| broken[i as usize]) {
            normals[i as usize] += (b - a).cross(c - a);
        }
    }
    for (normal, _) in normals.iter_mut().zip(&broken).filter(|(_, broken)| **broken) {
        *normal = normal.normalize_or(Vec3::Y);
    }
    Ok(())
}

fn punctual(light: &Light, transform: DMat4) -> Result<PunctualLight> {
    let position = transform.w_axis.truncate().as_vec3();
    let strength = Vec3::from(light.color) * light.intensity;
    let direction = || {
        let direction = transform.transform_vector3(DVec3::NEG_Z).try_normalize();
        direction.map(|d| d.as_vec3()).ok_or_else(|| Error::format("its node is scaled to zero"))
    };
    match light.type_ {
        Checked::Valid(Type::Point) => Ok(PunctualLight::Point { position, intensity: strength }),
        Checked::Valid(Type::Directional) => Ok(PunctualLight::parallel(direction()?, strength)),
        Checked::Valid(Type::Spot) => {
            let spot = light.spot.as_ref().ok_or_else(|| Error::format("a spot light without cone angles"))?;
            Ok(PunctualLight::Spot {
                position,
                direction: direction()?,
                intensity: strength,
                inner_angle: spot.inner_cone_angle.min(spot.outer_cone_angle).min(FRAC_PI_2),
                outer_angle: spot.outer_cone_angle.min(FRAC_PI_2),
            })
        }
        Checked::Invalid => Err(Error::format("its type is unknown")),
    }
}
