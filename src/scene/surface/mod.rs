//! Target surfaces: a planar patch chosen by name, and emission laid onto it.
//!
//! The paper (section 7) lays the light texture over a surface the user picks. Real ceilings are rarely one rectangle:
//! they are slabs with two sides and edges, or single sheets wound either way. [`find`] gathers the triangles of the
//! named object, groups them into planes ([`patch`](self)), takes the plane and the side from which most of the room is
//! seen, and fits a rectangle in that plane. [`place`] splits the patch off and lays a texture over the rectangle.
//!
//! Not modelled: curved surfaces. A vault is cut down to its largest planar part; how much bends away from that is told
//! ([`Surface::bent`]).

mod frame;
mod name;
mod patch;
mod place;
mod room;
#[cfg(test)]
mod tests;

pub use place::{Placed, cover, place};

use super::Scene;
use crate::error::{Error, Result};
use crate::image::try_collect;
use glam::{DVec2, DVec3, Vec2, Vec3};

/// A planar patch of the scene with a frame of its own.
///
/// As seen from the room, u runs to the right and v runs down, as texture coordinates do, so that a texture is not
/// mirrored: `u × v = -normal`. On walls v points down as far as it can; on floors and ceilings u points along +x as
/// far as it can, so that a ceiling is seen as by someone who faces -z and looks up.
#[derive(Clone, Debug, PartialEq)]
pub struct Surface {
    /// (mesh, triangle) of every triangle of the patch, ascending.
    pub triangles: Vec<(usize, usize)>,
    /// Corner of the bounding rectangle where u = v = 0.
    pub origin: Vec3,
    /// Unit directions of u and v; `u × v` points away from the room.
    pub u_axis: Vec3,
    pub v_axis: Vec3,
    /// Unit normal into the room: the side that will emit.
    pub normal: Vec3,
    /// Extent along u and v in metres.
    pub size: Vec2,
    /// Area of the triangles in m².
    pub area: f32,
    /// Area of what was named besides and slopes from this plane by 5 to 75 degrees, in m²: as of a vault, which gets no light.
    pub bent: f32,
}

impl Surface {
    /// The same patch with its axes turned by an angle from u towards v, in the rectangle around it along these.
    pub fn turned(&self, scene: &Scene, angle: f64) -> Result<Self> {
        let turn = DVec2::from_angle(angle);
        let u = self.u_axis.as_dvec3() * turn.x + self.v_axis.as_dvec3() * turn.y;
        let frame = frame::bound(&corners(scene, &self.triangles)?, self.origin.as_dvec3(), u, self.normal.as_dvec3());
        Ok(Self {
            origin: frame.origin.as_vec3(),
            u_axis: frame.u.as_vec3(),
            v_axis: frame.v.as_vec3(),
            size: frame.size.as_vec2(),
            ..self.clone()
        })
    }
}

fn corners(scene: &Scene, triangles: &[(usize, usize)]) -> Result<Vec<DVec3>> {
    try_collect(triangles.iter().flat_map(|&(m, t)| scene.meshes[m].corners(t).map(|p| p.as_dvec3())))
}

/// Finds the planar patch of the object or material of that name which faces the room.
///
/// Object names are tried first, then material names: exactly, then without regard to case, then as part of one name
/// only. The scene must be valid. Errors: `NotFound` with the names there are; `Degenerate` if the object has no area.
pub fn find(scene: &Scene, name: &str) -> Result<Surface> {
    let meshes = name::find(scene, name)?;
    let triangles =
        try_collect(meshes.iter().flat_map(|&mesh| (0..scene.meshes[mesh].triangles.len()).map(move |t| (mesh, t))))?;
    from_list(scene, &triangles).map_err(|e| e.within(format_args!("surface {name:?}")))
}

/// The planar patch among the given (mesh, triangle) pairs which faces the room; the others are left out.
///
/// Errors: `InvalidArgument` if a pair is not in the scene; `Degenerate` if there is no area.
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
    // Planes of the object, largest first; of those, the one and the side of it that sees most of the room.
    let patches = patch::planes(scene, triangles)?;
    let (chosen, normal) = room::facing(scene, &patches)?;
    let chosen = &patches[chosen];
    let bent = patch::bent(scene, triangles, normal);
    let mut triangles = chosen.triangles.clone();
    triangles.sort_unstable();

    // The rectangle around it, in its plane.
    let frame = frame::fit(&corners(scene, &triangles)?, chosen.centre, normal);
    if frame.size.min_element() <= 0.0 || !frame.size.is_finite() {
        return Err(Error::degenerate("the surface has no extent in one direction; it must have an area"));
    }
    Ok(Surface {
        triangles,
        origin: frame.origin.as_vec3(),
        u_axis: frame.u.as_vec3(),
        v_axis: frame.v.as_vec3(),
        normal: normal.as_vec3(),
        size: frame.size.as_vec2(),
        area: chosen.area as f32,
        bent: bent as f32,
    })
}
