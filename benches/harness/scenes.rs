//! The scenes of the benches. Each has a camera and at least one light.
//!
//! Generated scenes: [`planes`], a room of tessellated sheets, and the demonstration rooms of the library. Scenes by
//! others, read from the folder `LUXFER_TEST_DATA` (default `../shared/data`): [`cornell`], [`kitchen`],
//! [`apartment`], [`sponza`].

use glam::{Mat4, Vec2, Vec3};
use luxfer::demo;
use luxfer::image::Image;
use luxfer::job::Monitor;
use luxfer::relight::{Aspect, Constraint, Goal, Quantity, TargetGeometry};
use luxfer::scene::{Camera, Material, Mesh, Scene, gltf};
use luxfer::segment::StrokeSet;
use luxfer::transfer::Input;
use serde_json::Value;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene with its camera.
pub struct Setting {
    pub name: &'static str,
    pub scene: Scene,
    pub camera: Camera,
    /// Width and height in pixels of an image that suits the scene.
    pub size: [usize; 2],
}

impl Setting {
    pub fn triangle_count(&self) -> usize {
        self.scene.meshes.iter().map(|m| m.triangles.len()).sum()
    }

    /// All triangles, in the order of the meshes, as the library numbers them.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let meshes = &self.scene.meshes;
        meshes.iter().flat_map(|mesh| (0..mesh.triangles.len()).map(|t| mesh.corners(t))).collect()
    }

    /// Aspect ratio of the image: width over height.
    pub fn aspect(&self) -> f32 {
        self.size[0] as f32 / self.size[1] as f32
    }

    /// Centres of all emissive triangles.
    pub fn light_points(&self) -> Vec<Vec3> {
        let emits = |mesh: &&Mesh| self.scene.materials[mesh.material].emission != Vec3::ZERO;
        let lights = self.scene.meshes.iter().filter(emits);
        lights.flat_map(|m| (0..m.triangles.len()).map(|t| m.corners(t).iter().sum::<Vec3>() / 3.0)).collect()
    }
}

/// The reason why a scene cannot be loaded.
pub type Absent = String;

/// A closed room of ten tessellated sheets (six walls along the axes and four bumpy spheres) with about `triangles`
/// triangles, and a lamp under its ceiling. Regular grids in axis-aligned planes are the hardest input for builders of
/// bounding volume hierarchies that merge boxes greedily.
pub fn planes(name: &'static str, triangles: usize) -> Setting {
    let n = ((triangles as f64 / 20.0).sqrt().round() as u32).max(1);
    let mut scene = Scene::default();
    let paints = [Vec3::splat(0.75), Vec3::new(0.6, 0.2, 0.15), Vec3::new(0.2, 0.45, 0.25)];
    for (i, colour) in paints.into_iter().enumerate() {
        scene.materials.push(Material::diffuse(&format!("Paint {i}"), colour));
    }
    // Add the walls, with their front faces inwards.
    let size = Vec3::new(6.0, 3.0, 4.0);
    for axis in 0..3 {
        for far in [false, true] {
            let (mut u, mut v, mut corner) = (Vec3::ZERO, Vec3::ZERO, Vec3::ZERO);
            u[(axis + 1) % 3] = size[(axis + 1) % 3];
            v[(axis + 2) % 3] = size[(axis + 2) % 3];
            if far {
                corner[axis] = size[axis];
                (u, v) = (v, u);
            }
            let material = if axis == 0 { 1 + usize::from(far) } else { 0 };
            scene.meshes.push(sheet("Wall", material, n, |s, t| corner + u * s + v * t));
        }
    }
    // Add spheres with bumps of a tenth of their radius.
    for (i, (x, y, z)) in [(1.2, 0.7, 1.1), (4.6, 0.8, 1.3), (3.1, 1.9, 2.2), (2.0, 0.6, 3.1)].into_iter().enumerate() {
        let (centre, radius) = (Vec3::new(x, y, z), 0.4 + 0.05 * i as f32);
        scene.meshes.push(sheet("Bumpy sphere", 0, n, |s, t| {
            let (phi, theta) = (std::f32::consts::TAU * s, std::f32::consts::PI * t);
            let bump = 1.0 + 0.1 * (9.0 * phi).sin() * (7.0 * theta).sin();
            let ring = theta.sin();
            centre + Vec3::new(ring * phi.cos(), theta.cos(), -ring * phi.sin()) * radius * bump
        }));
    }
    lamp(&mut scene, Vec3::new(2.5, 2.98, 1.5), Vec2::new(1.0, 1.0), 4000.0);
    let camera = Camera::look_at(Vec3::new(0.3, 1.7, 3.7), Vec3::new(4.0, 1.0, 1.2), 1.1);
    Setting { name, scene, camera, size: [640, 480] }
}

/// The library's furnished room, with a lamp under its ceiling.
pub fn demo_room() -> Result<Setting, Absent> {
    let mut scene = demo::target_room().map_err(|e| e.to_string())?;
    lamp(&mut scene, Vec3::new(2.2, 2.79, 1.2), Vec2::new(1.6, 1.6), 3000.0);
    with_own_camera("demo", scene, [640, 360])
}

/// The library's demonstration office under its grid of luminaires.
pub fn demo_office() -> Result<Setting, Absent> {
    let exemplar = demo::exemplar_room().map_err(|e| e.to_string())?;
    with_own_camera("office", exemplar.scene, [640, 360])
}

/// Takes a photo of the library's demonstration office with the camera of its scene.
pub fn office_photo(params: &demo::photo::Params) -> Image {
    let room = demo::exemplar_room().expect("a room");
    let camera = room.scene.cameras[room.camera].clone();
    demo::photo::photograph(Arc::new(room.scene), &camera, params, Monitor::default().job()).expect("a photo").0
}

/// The input of a transfer from a photo to the ceiling of a scene.
pub fn transfer_input(photo: Arc<Image>, strokes: StrokeSet, scene: Arc<Scene>) -> Input {
    Input { photo: Some(photo), strokes, scene: Some(scene), surface: "Ceiling".into(), ..Input::default() }
}

/// The Cornell box, 0 to 555 units wide, 38 triangles. Its lamp is raised to the ceiling, because some renderers let
/// its back emit too, and that light would come out of the gap.
pub fn cornell() -> Result<Setting, Absent> {
    let mut scene = wavefront::load(&data("scenes/cbox/cbox.obj")?)?;
    for mesh in &mut scene.meshes {
        let material = &mut scene.materials[mesh.material];
        if material.emission != Vec3::ZERO {
            material.double_sided = false;
            mesh.positions.iter_mut().for_each(|p| p.y = 548.79);
        }
    }
    let view = view("cbox")?;
    let fov = number(&view["fov_deg"])?;
    let camera = Camera::look_at(point(&view["origin"])?, point(&view["target"])?, fov.to_radians());
    Ok(Setting { name: "cornell", scene, camera, size: [512, 512] })
}

/// Country Kitchen by Jay-Artist: 261 k triangles, closed, glossy and textured; a lamp is added under its ceiling.
pub fn kitchen() -> Result<Setting, Absent> {
    let mut scene = glb("scenes/kitchen/country_kitchen.glb")?;
    let view = view("kitchen")?;
    let rows = view["mitsuba_to_world_row_major"].as_array().ok_or("camera.json has no matrix")?;
    let numbers: Vec<f32> =
        rows.iter().filter_map(Value::as_array).flatten().filter_map(Value::as_f64).map(|v| v as f32).collect();
    let numbers: [f32; 16] = numbers.try_into().map_err(|_| "the matrix of camera.json is not 4 by 4")?;
    let to_world = Mat4::from_cols_array(&numbers).transpose();
    let (origin, forward) = (to_world.w_axis.truncate(), to_world.z_axis.truncate());
    let size = [700, 400];
    let camera = Camera::look_at(origin, origin + forward, fov_y(number(&view["fov_x_deg"])?, size));
    lamp(&mut scene, Vec3::new(-0.7, 3.2, 0.0), Vec2::new(2.0, 2.0), 3000.0);
    Ok(Setting { name: "kitchen", scene, camera, size })
}

/// Dream apartment by Mad_Huron: 178 k triangles, open above, seen from above; a lamp is added above the camera.
pub fn apartment() -> Result<Setting, Absent> {
    let mut scene = glb("scenes/apartment/dream_apartment.glb")?;
    let view = view("apartment")?;
    let size = [640, 480];
    let camera = aimed(&view, size)?;
    lamp(&mut scene, Vec3::new(0.44, 12.0, -11.4), Vec2::new(12.4, 11.3), 1500.0);
    Ok(Setting { name: "apartment", scene, camera, size })
}

/// Sponza by Marko Dabrovic: 66 k triangles; a lamp is added over the open court.
pub fn sponza() -> Result<Setting, Absent> {
    let mut scene = glb("scenes/sponza/sponza_dabrovic.glb")?;
    let view = view("sponza")?;
    let size = [640, 480];
    let camera = aimed(&view, size)?;
    lamp(&mut scene, Vec3::new(-10.0, 16.5, -3.5), Vec2::new(20.0, 7.0), 6000.0);
    Ok(Setting { name: "sponza", scene, camera, size })
}

/// A mesh of `n` by `n` quadrilaterals, each of two triangles, through the points `at(s, t)` with s and t in `[0, 1]`.
/// Its front faces look along `d/ds × d/dt`.
pub fn sheet(name: &str, material: usize, n: u32, at: impl Fn(f32, f32) -> Vec3) -> Mesh {
    let mut mesh = Mesh { name: name.into(), material, ..Mesh::default() };
    let part = |i: u32| i as f32 / n as f32;
    mesh.positions.extend((0..=n).flat_map(|j| (0..=n).map(move |i| (i, j))).map(|(i, j)| at(part(i), part(j))));
    for j in 0..n {
        for i in 0..n {
            let a = j * (n + 1) + i;
            let b = a + n + 1;
            mesh.triangles.extend([[a, a + 1, b + 1], [a, b + 1, b]]);
        }
    }
    mesh
}

/// Adds a rectangular lamp that faces down. `corner` is its corner of minimum x and z, with the texture coordinates
/// (0, 0); `luminance` is in cd/m².
pub fn lamp(scene: &mut Scene, corner: Vec3, size: Vec2, luminance: f32) {
    let black = Material::diffuse("Lamp", Vec3::ZERO);
    scene.materials.push(Material { emission: Vec3::splat(luminance), ..black });
    let material = scene.materials.len() - 1;
    let mut mesh = sheet("Lamp", material, 1, |s, t| corner + Vec3::new(size.x * s, 0.0, size.y * t));
    mesh.uvs[0] = vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE];
    scene.meshes.push(mesh);
}

/// The goal that a surface has the radiance or, as incident light, the illuminance divided by π, `target` per channel.
pub fn exact_goal(triangles: &[(usize, usize)], quantity: Quantity, target: Vec3) -> Goal<'_> {
    Goal {
        geometry: TargetGeometry::Surface(triangles),
        quantity,
        target,
        aspect: Aspect::Colour,
        constraint: [Constraint::Exactly; 3],
        weight: 1.0,
    }
}

fn with_own_camera(name: &'static str, scene: Scene, size: [usize; 2]) -> Result<Setting, Absent> {
    let camera = scene.cameras.first().cloned().ok_or("the scene has no camera")?;
    Ok(Setting { name, scene, camera, size })
}

/// Path of a file of the test data; an error if it is missing.
pub fn data(name: &str) -> Result<PathBuf, Absent> {
    let root = std::env::var_os("LUXFER_TEST_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let path = root.join(name);
    if path.exists() { Ok(path) } else { Err(format!("{} is missing", path.display())) }
}

fn glb(name: &str) -> Result<Scene, Absent> {
    gltf::load(&data(name)?, gltf::Options::default()).map_err(|e| e.to_string())
}

/// Reads the `camera.json` of a scene.
fn view(folder: &str) -> Result<Value, Absent> {
    let path = data(&format!("scenes/{folder}/camera.json"))?;
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))
}

fn aimed(view: &Value, size: [usize; 2]) -> Result<Camera, Absent> {
    let fov = fov_y(number(&view["fov_x_deg"])?, size);
    Ok(Camera::look_at(point(&view["origin"])?, point(&view["target"])?, fov))
}

/// Converts the horizontal angle of view in degrees to the vertical angle in radians.
fn fov_y(fov_x_degrees: f32, [width, height]: [usize; 2]) -> f32 {
    2.0 * ((fov_x_degrees.to_radians() / 2.0).tan() * height as f32 / width as f32).atan()
}

fn number(value: &Value) -> Result<f32, Absent> {
    value.as_f64().map(|v| v as f32).ok_or_else(|| format!("camera.json: {value} is not a number"))
}

fn point(value: &Value) -> Result<Vec3, Absent> {
    Ok(Vec3::new(number(&value[0])?, number(&value[1])?, number(&value[2])?))
}

/// Reads the subset of Wavefront OBJ and MTL that the Cornell box uses: polygons without texture coordinates, `Kd` and
/// `Ke`.
mod wavefront {
    use super::*;
    use std::path::Path;

    pub fn load(path: &Path) -> Result<Scene, Absent> {
        let mut scene = Scene::default();
        let mut points = Vec::new();
        for line in read(path)?.lines() {
            let mut words = line.split_whitespace();
            match words.next() {
                Some("mtllib") => read_materials(&path.with_file_name(rest(words)), &mut scene)?,
                Some("o") => scene.meshes.push(Mesh { name: rest(words), ..Mesh::default() }),
                Some("usemtl") => {
                    let name = rest(words);
                    let found = scene.materials.iter().position(|m| m.name == name);
                    mesh(&mut scene)?.material = found.ok_or_else(|| format!("no material is called {name}"))?;
                }
                Some("v") => points.push(vector(words)?),
                Some("f") => {
                    let corners: Result<Vec<usize>, _> =
                        words.map(|w| w.split('/').next().unwrap_or_default().parse()).collect();
                    let corners = corners.map_err(|e| format!("{line}: {e}"))?;
                    let mesh = mesh(&mut scene)?;
                    let first = mesh.positions.len() as u32;
                    for &i in &corners {
                        mesh.positions.push(*points.get(i.wrapping_sub(1)).ok_or_else(|| format!("{line}: no {i}"))?);
                    }
                    mesh.triangles.extend((2..corners.len() as u32).map(|k| [first, first + k - 1, first + k]));
                }
                _ => {}
            }
        }
        scene.meshes.retain(|m| !m.triangles.is_empty());
        Ok(scene)
    }

    fn read_materials(path: &Path, scene: &mut Scene) -> Result<(), Absent> {
        for line in read(path)?.lines() {
            let mut words = line.split_whitespace();
            let key = words.next();
            match (key, scene.materials.last_mut()) {
                (Some("newmtl"), _) => scene.materials.push(Material::diffuse(&rest(words), Vec3::ZERO)),
                (Some("Kd"), Some(material)) => material.base_color = vector(words)?,
                (Some("Ke"), Some(material)) => material.emission = vector(words)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn read(path: &Path) -> Result<String, Absent> {
        std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
    }

    fn mesh(scene: &mut Scene) -> Result<&mut Mesh, Absent> {
        scene.meshes.last_mut().ok_or_else(|| "the file has a face before its first object".into())
    }

    fn rest<'a>(words: impl Iterator<Item = &'a str>) -> String {
        words.collect::<Vec<_>>().join(" ")
    }

    fn vector<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vec3, Absent> {
        let numbers: Result<Vec<f32>, _> = words.take(3).map(str::parse).collect();
        match numbers.as_deref() {
            Ok(&[x, y, z]) => Ok(Vec3::new(x, y, z)),
            _ => Err("three numbers were expected".into()),
        }
    }
}
