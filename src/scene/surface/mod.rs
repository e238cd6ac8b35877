//! Finds target surfaces, planar patches selected by name, and maps emissive textures onto them.
//!
//! The method of the paper ("Single-Exemplar Lighting Style Transfer", section 7) maps the light texture onto a
//! surface that the user picks. Real ceilings are rarely single rectangles: they are slabs with two sides and edges,
//! or single sheets wound either way. [`find`] collects the triangles of the named object, groups them into planes,
//! selects the plane and the side from which most of the room is visible, and fits a rectangle in that plane.
//! [`place`] makes the patch a separate mesh and maps a texture onto the rectangle.
//!
//! Not modelled: curved surfaces. A vault is reduced to its largest planar part; [`Surface::sloped_area`] reports the
//! area of the remaining, sloped triangles.

mod bounding_rectangle;
mod candidates;
mod ceiling_name;
mod coverage;
mod facing;
mod name;
mod patch;
mod place;
#[cfg(test)]
mod tests;

pub use candidates::{Candidate, Kind, candidates};
pub use place::{Placed, cover, place, place_all};

use super::Scene;
use crate::error::{Error, Result};
use crate::image::try_collect;
use crate::maths;
use glam::{DVec3, Vec2, Vec3};

/// A planar patch of the scene, with the frame of its bounding rectangle.
///
/// Seen from the room, u runs right and v runs down, like texture coordinates, so that a texture is not mirrored:
/// `u × v = -normal`. On walls, v points down as far as possible. On floors and ceilings, u points along +x as far as
/// possible. A person who faces -z and looks up thus sees a ceiling's texture upright.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// (mesh, triangle) indices of every triangle of the patch, in ascending order.
    pub triangles: Vec<(usize, usize)>,
    /// The corner of the bounding rectangle with u = v = 0.
    pub origin: Vec3,
    /// Unit directions of u and v; `u × v` points away from the room.
    pub u_axis: Vec3,
    pub v_axis: Vec3,
    /// Unit normal into the room. The side of the patch that faces the room will emit.
    pub normal: Vec3,
    /// Extent of the bounding rectangle along u and v in metres.
    pub size: Vec2,
    /// Area of the triangles in m².
    pub area: f32,
    /// Area in m² of the triangles of the same object that are inclined to this plane by 5 to 75 degrees, as in a
    /// vault. They do not belong to the patch and get no light texture.
    pub sloped_area: f32,
}

impl Surface {
    /// Returns the patch with its axes rotated by `angle` in radians from u towards v, and with the bounding rectangle
    /// along these axes.
    pub fn turned(&self, scene: &Scene, angle: f64) -> Result<Self> {
        let turn = maths::direction_at(angle);
        let u = self.u_axis.as_dvec3() * turn.x + self.v_axis.as_dvec3() * turn.y;
        let rectangle = bounding_rectangle::bound(
            &corners(scene, &self.triangles)?,
            self.origin.as_dvec3(),
            u,
            self.normal.as_dvec3(),
        );
        Ok(Self {
            origin: rectangle.origin.as_vec3(),
            u_axis: rectangle.u.as_vec3(),
            v_axis: rectangle.v.as_vec3(),
            size: rectangle.size.as_vec2(),
            ..self.clone()
        })
    }
}

fn corners(scene: &Scene, triangles: &[(usize, usize)]) -> Result<Vec<DVec3>> {
    try_collect(triangles.iter().flat_map(|&(m, t)| scene.meshes[m].corners(t).map(|p| p.as_dvec3())))
}

/// Finds the planar patch that faces the room, among the triangles of the object or material with the given name.
///
/// The names are searched in three steps, and in each step first the objects, then the materials:
///
/// 1. a name equal to the given name,
/// 2. a name equal to the given name if upper and lower case are ignored,
/// 3. a name that contains the given name if upper and lower case are ignored; several such names are an error.
///
/// The scene must be valid. Errors: `NotFound`, listing the existing names; `Degenerate` if the object has no area.
pub fn find(scene: &Scene, name: &str) -> Result<Surface> {
    let meshes = name::find(scene, name)?;
    let triangles =
        try_collect(meshes.iter().flat_map(|&mesh| (0..scene.meshes[mesh].triangles.len()).map(move |t| (mesh, t))))?;
    from_list(scene, &triangles).map_err(|e| e.context(format_args!("surface {name:?}")))
}

/// Finds the planar patch that faces the room among the given (mesh, triangle) pairs. The patch need not contain all
/// of these triangles.
///
/// Errors: `InvalidArgument` if a pair is not in the scene; `Degenerate` if the triangles have no area.
pub fn from_triangles(scene: &Scene, triangles: &[(usize, usize)]) -> Result<Surface> {
    check_triangles(scene, triangles)?;
    let mut triangles = try_collect(triangles.iter().copied())?;
    triangles.sort_unstable();
    triangles.dedup();
    from_list(scene, &triangles)
}

fn check_triangles(scene: &Scene, triangles: &[(usize, usize)]) -> Result<()> {
    let known =
        |&(mesh, triangle): &(usize, usize)| scene.meshes.get(mesh).is_some_and(|m| triangle < m.triangles.len());
    match triangles.iter().find(|t| !known(t)) {
        Some((mesh, triangle)) => Err(Error::argument(format!(
            "triangle {triangle} of mesh {mesh} is not in the scene; find the surface again"
        ))),
        None => Ok(()),
    }
}

fn from_list(scene: &Scene, triangles: &[(usize, usize)]) -> Result<Surface> {
    // Group the triangles into planes. Choose the plane, and the side of it, from which most of the room is visible.
    let patches = patch::planes(scene, triangles)?;
    let (chosen, normal) = facing::facing(scene, &patches)?;
    let chosen = &patches[chosen];
    let sloped_area = patch::sloped_area(scene, triangles, normal);
    let mut triangles = chosen.triangles.clone();
    triangles.sort_unstable();

    // Fit the bounding rectangle in the plane.
    let rectangle = bounding_rectangle::fit(&corners(scene, &triangles)?, chosen.centre, normal);
    if rectangle.size.min_element() <= 0.0 || !rectangle.size.is_finite() {
        return Err(Error::degenerate("the surface has no extent in one direction; it must have an area"));
    }
    Ok(Surface {
        triangles,
        origin: rectangle.origin.as_vec3(),
        u_axis: rectangle.u.as_vec3(),
        v_axis: rectangle.v.as_vec3(),
        normal: normal.as_vec3(),
        size: rectangle.size.as_vec2(),
        area: chosen.area as f32,
        sloped_area: sloped_area as f32,
    })
}
