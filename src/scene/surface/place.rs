//! Maps a light texture onto a surface of the scene.

use super::{Surface, check_triangles};
use crate::error::{Error, Result};
use crate::image::{Image, try_collect};
use crate::scene::{Material, Mesh, Scene, Texture, TextureRef, Wrap};
use glam::{Vec2, Vec3, Vec4};

/// The emitting mesh and its material, as made by [`place`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Index of the new mesh that holds the patch.
    pub mesh: usize,
    /// Index of the material of that mesh. Its `emission` scales the texture.
    pub material: usize,
}

/// Maps an emissive texture onto the bounding rectangle of a surface. The triangles of the surface are moved to a new
/// mesh, with a second set of texture coordinates. The new mesh gets a copy of the surface's material. This copy emits
/// `strength × texture` in cd/m².
///
/// The front of the new mesh faces the room, and only the front emits. The original meshes keep their indices and their
/// other triangles. If the surface spans several meshes, its material comes from the mesh with the largest share of the
/// surface's area.
///
/// Errors: `InvalidArgument` if
///
/// - the surface belongs to another scene, or one of its sides is not positive;
/// - the texture is empty, does not have 1, 3 or 4 channels, or holds a negative or non-finite value;
/// - `strength` is negative or not finite.
pub fn place(scene: &mut Scene, surface: &Surface, texture: Image, strength: Vec3) -> Result<Placed> {
    let placed = place_all(scene, vec![(surface, texture, strength)])?;
    placed.first().copied().ok_or_else(|| Error::argument("surface has no triangles with an area; find it again"))
}

/// Like [`place`], for several surfaces of one scene, each with its texture and strength. The result is in the order of
/// the surfaces.
///
/// Errors: as for [`place`]; `InvalidArgument` if two surfaces share a triangle. The scene is then unchanged.
pub fn place_all(scene: &mut Scene, lights: Vec<(&Surface, Image, Vec3)>) -> Result<Vec<Placed>> {
    for (surface, texture, strength) in &lights {
        check_light(scene, surface, texture, *strength)?;
    }
    let of_surface = lights.iter().enumerate().flat_map(|(k, light)| light.0.triangles.iter().map(move |t| (*t, k)));
    let mut leaving: Vec<((usize, usize), usize)> = try_collect(of_surface)?;
    leaving.sort_unstable();
    leaving.dedup();
    if let Some(pair) = leaving.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        let ((mesh, triangle), first) = pair[0];
        let message = format!("surfaces {first} and {} share triangle {triangle} of mesh {mesh}", pair[1].1);
        return Err(Error::argument(message));
    }
    let leaving: Vec<(usize, usize)> = try_collect(leaving.iter().map(|(triangle, _)| *triangle))?;
    let mut patches = Vec::with_capacity(lights.len());
    for (surface, ..) in &lights {
        patches.push((main_source(scene, surface)?, patch_of(scene, surface)));
    }

    let mut placed = Vec::with_capacity(lights.len());
    for ((_, texture, strength), (source, mut patch)) in lights.into_iter().zip(patches) {
        let original = scene.meshes[source].material;
        scene.textures.push(Texture { name: "Lights".into(), image: texture, wrap: [Wrap::Clamp; 2] });
        scene.materials.push(Material {
            name: format!("{} (lights)", scene.materials[original].name),
            emission: strength,
            emission_texture: Some(TextureRef { uv_set: 1, ..TextureRef::new(scene.textures.len() - 1) }),
            double_sided: false,
            ..scene.materials[original].clone()
        });
        patch.name = format!("{} (lights)", scene.meshes[source].name);
        patch.material = scene.materials.len() - 1;
        scene.meshes.push(patch);
        placed.push(Placed { mesh: scene.meshes.len() - 1, material: scene.materials.len() - 1 });
    }
    remove(scene, &leaving);
    Ok(placed)
}

fn check_light(scene: &Scene, surface: &Surface, texture: &Image, strength: Vec3) -> Result<()> {
    check_triangles(scene, &surface.triangles)?;
    if !strength.is_finite() || strength.min_element() < 0.0 {
        return Err(Error::argument(format!("strength is {strength}; it must be finite and not negative")));
    }
    if !matches!(texture.channels, 1 | 3 | 4) || texture.data.is_empty() {
        return Err(Error::argument(format!("texture has {} channels; it must have 1, 3 or 4", texture.channels)));
    }
    if let Some(v) = texture.data.iter().find(|v| !v.is_finite() || **v < 0.0) {
        return Err(Error::argument(format!("texture holds {v}; light must be finite and not negative")));
    }
    if surface.size.is_nan() || surface.size.min_element() <= 0.0 {
        return Err(Error::argument(format!("surface.size is {}; both sides must be positive", surface.size)));
    }
    Ok(())
}

/// Returns the mesh that holds the largest share of the surface's area.
fn main_source(scene: &Scene, surface: &Surface) -> Result<usize> {
    let mut areas = vec![0.0f64; scene.meshes.len()];
    for &(mesh, triangle) in &surface.triangles {
        let [a, b, c] = scene.meshes[mesh].corners(triangle).map(|p| p.as_dvec3());
        areas[mesh] += (b - a).cross(c - a).length();
    }
    let (mesh, area) = areas.into_iter().enumerate().fold((0, 0.0), |a, b| if b.1 > a.1 { b } else { a });
    if area > 0.0 { Ok(mesh) } else { Err(Error::argument("surface has no triangles with an area; find it again")) }
}

/// Returns a flat-shaded mesh of the surface's triangles.
fn patch_of(scene: &Scene, surface: &Surface) -> Mesh {
    let mut patch = Mesh::default();
    let has_uv = surface.triangles.iter().any(|&(mesh, _)| !scene.meshes[mesh].uvs[0].is_empty());
    let has_colours = surface.triangles.iter().any(|&(mesh, _)| !scene.meshes[mesh].colours.is_empty());
    for &(mesh, triangle) in &surface.triangles {
        let mesh = &scene.meshes[mesh];
        let mut corners = mesh.triangles[triangle].map(|i| i as usize);
        let [a, b, c] = corners.map(|i| mesh.positions[i]);
        if (b - a).cross(c - a).dot(surface.normal) < 0.0 {
            corners.swap(1, 2);
        }
        // Do not share vertices: the patch is flat-shaded, and a ceiling has few triangles.
        let first = patch.positions.len() as u32;
        patch.triangles.push([first, first + 1, first + 2]);
        for i in corners {
            let from_origin = mesh.positions[i] - surface.origin;
            let at = Vec2::new(from_origin.dot(surface.u_axis), from_origin.dot(surface.v_axis)) / surface.size;
            patch.positions.push(mesh.positions[i]);
            patch.uvs[1].push(at.clamp(Vec2::ZERO, Vec2::ONE));
            if has_uv {
                patch.uvs[0].push(mesh.uvs[0].get(i).copied().unwrap_or_default());
            }
            if has_colours {
                patch.colours.push(mesh.colours.get(i).copied().unwrap_or(Vec4::ONE));
            }
        }
    }
    patch
}

/// Removes triangles, given in ascending order, from their meshes.
fn remove(scene: &mut Scene, mut rest: &[(usize, usize)]) {
    while let Some(&(mesh, _)) = rest.first() {
        let (here, after) = rest.split_at(rest.partition_point(|t| t.0 == mesh));
        let mut index = 0;
        scene.meshes[mesh].triangles.retain(|_| {
            let stays = here.binary_search(&(mesh, index)).is_err();
            index += 1;
            stays
        });
        rest = after;
    }
}

/// Adds a horizontal sheet on top of the scene's bounding box, for models without a ceiling. The sheet is diffuse with
/// a reflectance of 0.8. Returns the index of its mesh. Errors: `Degenerate` if the scene has no triangles or no
/// horizontal extent.
pub fn cover(scene: &mut Scene, name: &str) -> Result<usize> {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for mesh in &scene.meshes {
        for corner in (0..mesh.triangles.len()).flat_map(|t| mesh.corners(t)) {
            low = low.min(corner);
            high = high.max(corner);
        }
    }
    if !(high.x > low.x && high.z > low.z) {
        return Err(Error::degenerate("the scene has no triangles to lay a cover over"));
    }
    let y = high.y;
    scene.materials.push(Material::diffuse(name, Vec3::splat(0.8)));
    scene.meshes.push(Mesh {
        name: name.into(),
        material: scene.materials.len() - 1,
        positions: vec![
            Vec3::new(low.x, y, low.z),
            Vec3::new(high.x, y, low.z),
            Vec3::new(high.x, y, high.z),
            Vec3::new(low.x, y, high.z),
        ],
        uvs: [vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y], Vec::new()],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    });
    Ok(scene.meshes.len() - 1)
}
